"""Compiled loops: numba's ``njit``, with a cache that may fail, and a word while it compiles.

numba keeps compiled code on disk. Here that is a help and no need: without a place for it, on a full disk, or with a damaged
file, the loop is compiled again. Every cached piece is sealed, for damaged machine code would be run, and stamped with all that
went into it (`spinline.base.kernel_stamp`), for numba looks at the loop's own file alone.

A loop that another one calls is compiled as a part of it (`spinline.base.kernel_parts`), without the way in from Python. Called
from Python it is compiled as a whole, as numba does in every case.

The parts, the seals and the word reach into numba, which may be another one tomorrow. Each is left out where it no longer fits:
numba then seals nothing, or compiles wholes. Of wholes none is kept on disk: numba 0.68 crashes on one that calls another that
calls itself (`tests/test_kernels.py`).
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
from numba.core.errors import NumbaError

from spinline.base.kernel_parts import AS_PART, AS_WHOLE, CHANGED
from spinline.base.kernel_stamp import ingredients
from spinline.base.progress import announce
from spinline.base.seals import sealed, unsealed
from spinline.base.taking_turns import one_at_a_time

__all__ = ["njit", "plain"]

_P = ParamSpec("_P")
_T = TypeVar("_T")

if TYPE_CHECKING:  # the loops keep the types that numba's own decorator gives them
    from numba import njit
else:

    def njit(*, cache: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
        """Decorator as ``numba.njit``; see its documentation for the options."""

        def compiled(function: Callable[..., Any]) -> Any:
            inlined = "inline" in options
            try:
                made: Any = numba.njit(**options, **({} if inlined else AS_WHOLE))(function)
            except (TypeError, KeyError, NumbaError):  # no such option any more
                made = numba.njit(**options)(function)
            if not hasattr(made, "_cache"):  # numba is switched off
                return made
            if AS_PART is None:
                return made
            if not inlined:
                with suppress(*CHANGED):
                    _in_parts(made, numba.njit(**options, **AS_PART)(function))
            if cache:
                _kept(made, function)
            return made

        return compiled


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


_PATIENCE = 60.0  # s, with another process that compiles the same file
_parted: list[tuple[Any, dict[str, Any]]] = []  # loops with parts, and what was theirs before


def _in_parts(made: Any, part: Any) -> None:
    """Let callers take `part` of a loop, and Python the whole."""
    own = {
        "_compiling_counter": part._compiling_counter,  # for loops that call themselves
        "get_overload": part.get_overload,
        "get_call_template": partial(_call, part),
        "compile": partial(_compile, made),
    }
    before = {name: getattr(made, name) for name in (*own, "_cache")}
    for name, value in own.items():
        setattr(made, name, value)
    _parted.append((made, before))


def _call(part: Any, arguments: Any, keywords: Any) -> Any:
    """As ``Dispatcher.get_call_template``, but with one version of a loop for all numbers that are written in calls of it."""
    plain: Any = numba.types.unliteral
    return part.get_call_template(tuple(map(plain, arguments)), {name: plain(a) for name, a in keywords.items()})


def _compile(made: Any, signature: Any) -> Any:
    """As ``Dispatcher.compile``; where parts do not fit into this numba, of wholes from then on, which are not kept."""
    try:
        with one_at_a_time(made.py_func.__code__.co_filename, _PATIENCE):  # whoever waits finds it on disk
            return type(made).compile(made, signature)
    except NumbaError:  # of the loop, not of how it is compiled
        raise
    except Exception:
        if not _parted:
            raise
        while _parted:
            loop, before = _parted.pop()
            for name, value in before.items():
                setattr(loop, name, value)
            loop._compiler.pipeline_class = numba.core.compiler.Compiler
        return type(made).compile(made, signature)


def _kept(made: Any, function: Any) -> None:
    """Keep what is compiled on disk: sealed, or as numba keeps it; or not at all, where there is no place."""
    with suppress(OSError, RuntimeError):
        try:
            made._cache = _sealed_cache(function)
        except CHANGED:
            with suppress(*CHANGED):
                made.enable_caching()


def _cache_file_class(base: Any) -> Any:
    for name in ("_dump", "_load_index", "_load_data", "_data_path"):
        getattr(base, name)

    class CacheFile(base):  # type: ignore[misc]
        """Index and data of one function, sealed and stamped with all that went into it."""

        function: Any

        @property
        def _source_stamp(self) -> Any:
            if "stamp" not in self.__dict__:  # at the first call: the module is whole by then
                self.__dict__["stamp"] = self.__dict__["_source_stamp"], ingredients(self.function)
            return self.__dict__["stamp"]

        def _dump(self, obj: Any) -> bytes:
            return sealed(super()._dump(obj))

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
            with open(self._data_path(name), "rb") as file:
                body = unsealed(file.read())
            if body is None:
                raise OSError("damaged")
            return pickle.loads(body)

    return CacheFile


def _cache_class() -> Any:
    """Class of a sealed cache of one function that never stands in the way; None where this numba's caches are other ones."""
    try:
        from numba.core import caching

        for name in ("load_overload", "save_overload"):
            getattr(caching.FunctionCache, name)
        cache_file = _cache_file_class(caching.IndexDataCacheFile)

        class Cache(caching.FunctionCache):
            def __init__(self, function: Any) -> None:
                super().__init__(function)  # type: ignore[no-untyped-call]
                mine: Any = self._cache_file
                self._cache_file = cache_file.__new__(cache_file)
                self._cache_file.__dict__.update(mine.__dict__, function=function)
                for name in ("_index_path", "_version", "_source_stamp"):
                    getattr(mine, name)

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

    except CHANGED:
        return None
    return Cache


_CACHE = _cache_class()


def _sealed_cache(function: Any) -> Any:
    if _CACHE is None:
        raise AttributeError("numba's cache is another one")
    return _CACHE(function)


def _say_when_compiling() -> None:
    from numba.core import event

    class Says(event.Listener):
        """Says that it takes a while; and keeps Python's collector, which finds nothing in compilers, from looking."""

        depth, collects = 0, False

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

    event.register("numba:compile", Says())  # type: ignore[no-untyped-call]


with suppress(*CHANGED):
    _say_when_compiling()
