"""What a command says: text from files and names with nothing in it that a terminal would obey."""

import os
import sys
from contextlib import suppress

import typer

from spinline.base.words import clean

__all__ = ["say", "streams", "unheard"]


def say(text: object, *, err: bool = False) -> None:
    """Print a line on standard output, or standard error."""
    try:
        typer.echo(clean(str(text)), err=err)
    except BrokenPipeError:  # the reader has heard enough: no error, and what is still to be written is written
        unheard(err=err)
    except OSError as error:
        if err:  # remarks that nobody can be told are no reason to lose the work; the result has them
            unheard(err=True)
            return
        error.filename = "standard output"
        raise


def streams() -> None:
    """Standard streams that are closed (``>&-``) lead nowhere: what is said needs a place, no file may get their numbers."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8"))


def unheard(*, err: bool = False) -> None:
    """Nothing more goes to standard output (or standard error), not even at exit."""
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), (sys.stderr if err else sys.stdout).fileno())
