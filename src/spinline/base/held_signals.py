"""Signals that wait while a library is at work which no exception may cross.

HDF5 calls the file it writes to, and ends the whole process where that call raises while it closes. A handler raises wherever
Python happens to be: Ctrl-C, or a request to end, in the middle of such a call.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["signals_held"]

_RAISING = [
    getattr(signal, name)
    for name in ("SIGTERM", "SIGHUP", "SIGBREAK", "SIGALRM", "SIGUSR1", "SIGUSR2", "SIGINT")
    if hasattr(signal, name)
]


@contextmanager
def signals_held() -> Iterator[None]:
    """Within it no handler that is written in Python runs; what came is raised again at the end. Of functions too.

    Only the main thread runs handlers: in others this does nothing.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {number: handler for number in _RAISING if callable(handler := signal.getsignal(number))}
    try:
        for number in before:
            signal.signal(number, lambda number, _: came.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)
