"""What a compiled loop is made of besides its own file: loops of other files that it calls, and the numbers it names.

numba stamps what it keeps on disk with the loop's own file. A loop whose callee, or a constant from elsewhere, has changed
would be run as it was: after an upgrade, with the physics of the version before.
"""

import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy as np

__all__ = ["ingredients"]


def ingredients(function: Callable[..., Any]) -> str:
    """Digest of a loop's own constants, and of the files and constants of all loops that it calls, by any number of steps.

    Parameters
    ----------
    function : callable
        The loop in Python. What it names is looked up now, so its module must be whole.
    """
    digest, seen, waiting = hashlib.blake2b(digest_size=16), {function}, [function]
    while waiting:
        loop = waiting.pop()
        digest.update(_file(loop.__code__.co_filename))
        for name, value in sorted(_named(loop), key=lambda pair: pair[0]):
            digest.update(name.encode())
            called = getattr(value, "py_func", None)
            if called is not None and called not in seen:
                seen.add(called)
                waiting.append(called)
            digest.update(_content(value))
    return digest.hexdigest()


def _named(loop: Callable[..., Any]) -> Iterator[tuple[str, Any]]:
    """Names from outside that the loop's code uses, and what they stand for."""
    function: Any = loop
    codes: list[CodeType] = [function.__code__]
    for code in codes:
        codes += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
        yield from ((name, function.__globals__[name]) for name in code.co_names if name in function.__globals__)
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    yield from ((name, cell.cell_contents) for name, cell in cells)


def _content(value: Any) -> bytes:
    if isinstance(value, np.ndarray):
        return f"{value.dtype}{value.shape}".encode() + np.ascontiguousarray(value).tobytes()
    if isinstance(value, ModuleType):
        own = value.__name__.partition(".")[0] == __name__.partition(".")[0]
        return _file(value.__file__) if own and value.__file__ else value.__name__.encode()
    if isinstance(value, int | float | complex | str | bytes | np.generic | None):
        return repr(value).encode()
    if isinstance(value, tuple | list):
        return b"".join(map(_content, value)) + str(len(value)).encode()
    return b""


@cache
def _file(path: str) -> bytes:
    try:
        return hashlib.blake2b(Path(path).read_bytes(), digest_size=16).digest()
    except OSError:  # in an archive, or typed in
        return path.encode()
