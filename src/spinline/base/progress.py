"""What is being done, said to whoever listens: nobody in a script, the command line on standard error.

Work calls `report`; nothing is said of what takes less than two seconds. Whatever says nothing by itself is still seen to be
at work, for `telling` looks at the clock.
"""

import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

__all__ = ["announce", "report", "silent", "telling"]

PATIENCE = 2.0  # seconds that nobody minds
_EVERY = 10.0  # between two lines where lines stay; on a terminal one line changes every half second
_said: set[str] = set()


class _Teller:
    def __init__(self, stream: TextIO) -> None:
        self.stream = stream
        self.begun = time.monotonic()
        self.what, self.done, self.total = "working", 0, 0
        self.quiet = 0
        self.shown = False
        self.stop = threading.Event()
        self.lock = threading.Lock()

    def words(self) -> str:
        share = f", {self.done} of {self.total}" if self.total else ""
        return f"{self.what}{share} ({time.monotonic() - self.begun:.0f} s)"

    def line(self, text: str, *, stays: bool) -> None:
        with self.lock:
            try:
                if self.stream.isatty():
                    self.stream.write(f"\r\x1b[K{text}" + ("\n" if stays else ""))
                    self.shown = not stays
                else:
                    self.stream.write(text + "\n")
                self.stream.flush()
            except (OSError, ValueError):
                self.quiet = 1

    def wipe(self) -> None:
        if self.shown:
            self.line("", stays=False)
            self.shown = False

    def watch(self) -> None:
        if self.stop.wait(PATIENCE):
            return
        step = 0.5 if self.stream.isatty() else _EVERY
        while True:
            if not self.quiet:
                self.line(self.words(), stays=False)
            if self.stop.wait(step):
                return


_teller: _Teller | None = None


@contextmanager
def telling(stream: TextIO | None = None) -> Iterator[None]:
    """Within it, what goes on is told on standard error once it has taken two seconds; not if SPINLINE_QUIET is set."""
    global _teller
    if os.environ.get("SPINLINE_QUIET"):
        yield
        return
    before, _teller = _teller, _Teller(stream or sys.stderr)
    mine = _teller
    thread = threading.Thread(target=mine.watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        mine.stop.set()
        thread.join(1.0)
        mine.wipe()
        _teller = before


@contextmanager
def silent() -> Iterator[None]:
    """Within it, nothing is told: something else shows how far it is."""
    mine = _teller
    if mine is None:
        yield
        return
    mine.quiet += 1
    mine.wipe()
    try:
        yield
    finally:
        mine.quiet -= 1


def report(what: str, done: int = 0, total: int = 0) -> None:
    """Say what is being done now, and how much of it."""
    if _teller is not None:
        _teller.what, _teller.done, _teller.total = what, done, total


def announce(words: str) -> None:
    """Say something at once, and only once."""
    if _teller is not None and words not in _said:
        _said.add(words)
        _teller.line(words, stays=True)
