"""Compiled loops: numba's ``njit``, with a cache that may fail, and a word while it compiles.

numba keeps compiled code on disk. Here that is a help and no need: without a place for it, on a full disk, or with a damaged
file, the loop is compiled again. Every cached piece is sealed, for damaged machine code would be run.

A loop that another one calls is compiled as a part of it: translated, but optimised and made machine code only with its caller,
and without the way in from Python. Called from Python it is compiled as a whole, as numba does in every case.
"""

import gc
import pickle
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from types import FunctionType
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numba
import numpy as np
from numba.core import caching, event, types

from spinline.base.compiling import AS_PART, AS_WHOLE
from spinline.base.progress import announce
from spinline.base.seals import sealed, unsealed

__all__ = ["njit", "plain"]


_P = ParamSpec("_P")
_T = TypeVar("_T")

if TYPE_CHECKING:  # the loops keep the types that numba's own decorator gives them
    from numba import njit
else:

    def njit(*, cache: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
        """Decorator as ``numba.njit``; see its documentation for the options."""

        def compiled(function: Callable[..., Any]) -> Any:
            made: Any = numba.njit(**options, **AS_WHOLE)(function)
            if not hasattr(made, "_cache"):  # numba is switched off
                return made
            if "inline" not in options:
                part = numba.njit(**options, **AS_PART)(function)
                made._compiling_counter = part._compiling_counter  # for loops that call themselves
                made.get_overload = part.get_overload
                made.get_call_template = partial(_call, part)
            if cache:
                with suppress(RuntimeError, OSError, AttributeError):  # no place for one
                    made._cache = _Cache(function)
            return made

        return compiled


def _call(part: Any, arguments: Any, keywords: Any) -> Any:
    """As ``Dispatcher.get_call_template``, but with one version of a loop for all numbers that are written in calls of it."""
    plain: Any = types.unliteral
    return part.get_call_template(tuple(map(plain, arguments)), {name: plain(a) for name, a in keywords.items()})


@cache
def plain(loop: Callable[_P, _T]) -> Callable[_P, _T]:
    """A loop as Python runs it, with all that it calls: for the few calls that cost less than compiling it."""
    if not hasattr(loop, "py_func"):  # numba is switched off
        return loop
    function = loop.py_func
    names = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    parts = {name: plain(part) for name, part in names.items() if hasattr(part, "py_func")}
    names_seen = {**function.__globals__, **parts}
    twin = FunctionType(function.__code__, names_seen, function.__name__, function.__defaults__, function.__closure__)

    def run(*given: _P.args, **named: _P.kwargs) -> _T:
        with np.errstate(all="ignore"):  # as compiled
            value: _T = twin(*given, **named)
        return value

    return run


class _CacheFile(caching.IndexDataCacheFile):
    """Index and data of one function, sealed."""

    def _dump(self, obj: Any) -> bytes:
        return sealed(super()._dump(obj))  # type: ignore[no-untyped-call]

    def _load_index(self) -> dict[Any, str]:
        try:
            with open(self._index_path, "rb") as file:
                version = pickle.load(file)
                body = unsealed(file.read())
        except FileNotFoundError:
            return {}
        if version != self._version or body is None:
            return {}
        stamp, overloads = pickle.loads(body)
        return overloads if stamp == self._source_stamp else {}

    def _load_data(self, name: str) -> Any:
        with open(self._data_path(name), "rb") as file:  # type: ignore[no-untyped-call]
            body = unsealed(file.read())
        if body is None:
            raise OSError("damaged")
        return pickle.loads(body)


class _Cache(caching.FunctionCache):
    """Cache of one function that never stands in the way."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        mine = self._cache_file
        self._cache_file = _CacheFile.__new__(_CacheFile)
        self._cache_file.__dict__.update(mine.__dict__)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Compiled code, or None."""
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except Exception:  # whatever a damaged cache makes of it
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep compiled code, where that is possible."""
        with suppress(OSError, pickle.PickleError, EOFError, ValueError, TypeError, AttributeError):
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]


class _Says(event.Listener):
    """Says that it takes a while; and keeps Python's collector, which finds nothing in compilers, from looking."""

    depth = 0
    collects = False

    def on_start(self, _: Any) -> None:
        announce("compiling, once: the next start is quicker")
        if not self.depth:
            self.collects = gc.isenabled()
            gc.disable()
        self.depth += 1

    def on_end(self, _: Any) -> None:
        self.depth -= 1
        if not self.depth and self.collects:
            gc.enable()


event.register("numba:compile", _Says())  # type: ignore[no-untyped-call]
