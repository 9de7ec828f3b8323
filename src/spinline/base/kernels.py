"""Compiled loops: numba's ``njit``, with a cache that may fail, and a word while it compiles.

numba keeps compiled code on disk. Here that is a help and no need: without a place for it, on a full disk, or with a damaged
file, the loop is compiled again. Every cached piece is sealed, for damaged machine code would be run.

A loop that another one calls is compiled as a part of it: translated, but optimised and made machine code only with its caller,
and without the way in from Python. Called from Python it is compiled as a whole, as numba does in every case.
"""

import pickle
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

import numba
from numba.core import caching, codegen, compiler, event, types

from spinline.base.progress import announce
from spinline.base.seals import sealed, unsealed

__all__ = ["njit"]


if TYPE_CHECKING:  # the loops keep the types that numba's own decorator gives them
    from numba import njit
else:

    def njit(*, cache: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
        """Decorator as ``numba.njit``; see its documentation for the options."""

        def compiled(function: Callable[..., Any]) -> Any:
            made: Any = numba.njit(**options, no_cfunc_wrapper=True)(function)
            if not hasattr(made, "_cache"):  # numba is switched off
                return made
            if "inline" not in options:
                part = numba.njit(**options, **_AS_PART)(function)
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


class _PartLibrary(codegen.JITCodeLibrary):
    """Translated code that waits to be linked into its caller's."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()  # type: ignore[no-untyped-call]
        self._verify_declare_only_symbols()  # type: ignore[no-untyped-call]
        self._finalized = True

    @property
    def codegen(self) -> Any:
        """Nothing: there is no machine code yet that would need its surroundings."""
        return _Nowhere


class _Nowhere:
    @staticmethod
    def set_env(name: str, environment: object) -> None:
        pass


class _PartCompiler(compiler.Compiler):
    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        made = _PartLibrary(target.codegen(), "part")  # type: ignore[no-untyped-call]
        super().__init__(typing, target, made, *rest)  # type: ignore[no-untyped-call]


_AS_PART = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True, "pipeline_class": _PartCompiler}


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
    def on_start(self, _: Any) -> None:
        announce("compiling, once: the next start is quicker")

    def on_end(self, _: Any) -> None:
        pass


event.register("numba:compile", _Says())  # type: ignore[no-untyped-call]
