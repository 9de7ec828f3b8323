"""What a signal does to a command: it ends as by an exception, and what is half written is removed."""

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["stopping"]


@contextmanager
def stopping(stopped: list[int]) -> Iterator[None]:
    """Within it SIGTERM ends the program as an exception does: what is half written is removed.

    The numbers of the signals that came are put into `stopped`. Where the exception was lost (Python drops what is raised in a
    destructor or a callback) it is raised again a little later.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, *_: object) -> None:
        stopped.append(number)
        again()

    def again(*_: object) -> None:
        if stopped[0] == signal.SIGINT:
            raise KeyboardInterrupt
        sys.exit(128 + stopped[0])

    def lost(what: Any) -> None:
        if stopped and issubclass(what.exc_type, KeyboardInterrupt | SystemExit):
            signal.setitimer(signal.ITIMER_REAL, 0.02)
        else:
            dropped(what)

    dropped, sys.unraisablehook = sys.unraisablehook, lost
    asked = {signal.SIGTERM: stop, signal.SIGINT: stop} | (
        {signal.SIGALRM: again} if hasattr(signal, "SIGALRM") else {}
    )
    before = {number: signal.signal(number, handler) for number, handler in asked.items()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        sys.unraisablehook = dropped
