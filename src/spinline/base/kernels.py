"""Compiled loops: numba's ``njit``, with a cache that may fail, and a word while it compiles.

numba keeps compiled code on disk. Here that is a help and no need: without a place for it, on a full disk, or with a damaged
file, the loop is compiled again. Every cached piece is sealed, for damaged machine code would be run.
"""

import pickle
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numba
from numba.core import caching, event

from spinline.base.progress import announce
from spinline.base.seals import sealed, unsealed

__all__ = ["njit"]


if TYPE_CHECKING:  # the loops keep the types that numba's own decorator gives them
    from numba import njit
else:

    def njit(*, cache: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
        """Decorator as ``numba.njit``; see its documentation for the options."""

        def compiled(function: Callable[..., Any]) -> Any:
            made: Any = numba.njit(**options)(function)
            if cache and hasattr(made, "_cache"):  # not where numba is switched off
                with suppress(RuntimeError, OSError, AttributeError):  # no place for one
                    made._cache = _Cache(function)
            return made

        return compiled


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
