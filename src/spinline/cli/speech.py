"""What a command says: text from files and names with nothing in it that a terminal would obey."""

import typer

from spinline.base.words import clean

__all__ = ["say"]


def say(text: object, *, err: bool = False) -> None:
    """Print a line on standard output, or standard error."""
    try:
        typer.echo(clean(str(text)), err=err)
    except BrokenPipeError:
        raise
    except OSError as error:
        error.filename = "standard error" if err else "standard output"
        raise
