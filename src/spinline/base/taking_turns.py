"""One process at a time does what every one would do alike: the others wait, and find it done."""

import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

__all__ = ["one_at_a_time"]

_EVERY = 0.05  # s


@contextmanager
def one_at_a_time(file: str | Path, patience: float) -> Iterator[None]:
    """Hold a file, which is only read, while the body runs; nothing is left behind, and whoever dies lets go.

    A help and no need: after `patience` seconds, or on a system or for a file without locks, the body runs all the same.
    """
    with ExitStack() as held:
        with suppress(ImportError, OSError):
            import fcntl

            opened = held.enter_context(open(file, "rb"))
            end = time.monotonic() + patience
            while time.monotonic() < end:
                try:
                    fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    break
                except BlockingIOError:
                    time.sleep(_EVERY)
        yield
