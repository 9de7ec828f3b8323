"""One process at a time does what every one would do alike: the others wait, and find it done."""

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

__all__ = ["one_at_a_time"]

_EVERY = 0.05  # s


@contextmanager
def one_at_a_time(file: str | Path, patience: float) -> Iterator[None]:
    """Hold a file, which is only read, while the body runs; nothing is left behind, and whoever dies lets go.

    A help and no need: after `patience` seconds, or on a system or for a file without locks, the body runs all the same.
    """
    handle = -1
    with suppress(ImportError, OSError):
        import fcntl

        handle = os.open(file, os.O_RDONLY | os.O_CLOEXEC)
        end = time.monotonic() + patience
        while time.monotonic() < end:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                time.sleep(_EVERY)
    try:
        yield
    finally:
        if handle >= 0:
            os.close(handle)
