"""How far a long command is: a bar on a terminal, elsewhere a line now and then on standard error; nothing in the first 2 s."""

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

from spinline.base.progress import silent
from spinline.cli.speech import say

__all__ = ["progress_of"]

_QUIET = 2.0  # s
_EVERY = 10.0  # s between lines


@contextlib.contextmanager
def progress_of(what: str) -> Iterator[Callable[[int, int], None]]:
    """A function of (done, total) to call as the work goes on.

    Parameters
    ----------
    what : str
        What is counted: "scenes", "draws".
    """
    if sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

        with (
            silent(),
            Progress(
                BarColumn(),
                MofNCompleteColumn(),
                what,
                TimeRemainingColumn(),
                console=Console(stderr=True),
                transient=True,
            ) as bar,
        ):
            job = bar.add_task(what, total=None)
            yield lambda done, total: bar.update(job, completed=done, total=total)
        return
    said = time.monotonic() + _QUIET - _EVERY

    def line(done: int, total: int) -> None:
        nonlocal said
        now = time.monotonic()
        if now - said > _EVERY and done < total:
            said = now
            say(f"{done} of {total} {what}", err=True)

    with silent():
        yield line
