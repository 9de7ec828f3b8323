"""``spinline cite``: the papers behind a result."""

from pathlib import Path
from typing import Annotated

import typer

from spinline.cli.options import JsonOption
from spinline.cli.speech import say

__all__ = ["register"]


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("cite")(cite)


def cite(
    result: Annotated[
        Path, typer.Argument(metavar="RESULT", help="What a command wrote: .nc, a sweep's .zarr, or fibres (.h5).")
    ],
    json: JsonOption = False,
) -> None:
    """Print BibTeX of the papers whose models a result used."""
    from spinline.report.cite import bibtex, cited, described_by

    keys = cited(*described_by(result))
    if json:
        import json as json_

        say(json_.dumps({"keys": keys, "bibtex": bibtex(keys)}))
        return
    say(bibtex(keys))
