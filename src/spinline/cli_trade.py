"""Commands about the trade of accuracy for time: ``trade``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spinline.cli_options import JsonOption, ForceOption, RtolOption, SceneArgument, SetOption, load

if TYPE_CHECKING:
    from spinline.trade import Trade

__all__ = ["trade"]


def trade(
    scene: SceneArgument,
    quick: Annotated[bool, typer.Option("--quick", help="Only the rung next to the affine network.")] = False,
    figure: Annotated[Path | None, typer.Option(help="Error against cost (.png, .pdf, .svg).")] = None,
    json: JsonOption = False,
    force: ForceOption = False,
    rtol: RtolOption = None,
    set_: SetOption = None,
) -> None:
    """Error against cost of every model, measured on this scene."""
    import json as json_

    from spinline.outputs import writable

    loaded = load(scene, None, rtol, set_)
    if figure is not None:
        from spinline.figures import check_format

        writable(check_format(figure), force=force)
    from spinline.results import plain
    from spinline.trade import trade as measure

    measured = measure(loaded, quick=quick, progress=lambda words: typer.echo(f"measuring {words}", err=True))
    if figure is not None:
        from spinline.trade_figure import save_trade_figure

        save_trade_figure(measured, figure, force=force)
    if json:
        typer.echo(json_.dumps(_nested(measured.plain(), plain)))
        return
    typer.echo(_table(measured))
    typer.echo(measured.recommendation)
    if figure is not None:
        typer.echo(f"wrote {figure}")


def _nested(value: object, leaf: object) -> object:
    if isinstance(value, dict):
        return {key: _nested(item, leaf) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_nested(item, leaf) for item in value]
    return leaf(value)  # type: ignore[operator]


def _table(measured: "Trade") -> str:
    branches = list(measured.rungs[0].errors)
    lines = [f"{branch} reference: {words}" for branch, words in measured.references.items()]
    lines.append(f"{'model':14s}{'setting':16s}{'time':>10s}" + "".join(f"{branch:>14s}" for branch in branches) + "  worst")
    for rung in measured.rungs:
        if rung.refused:
            lines.append(f"{rung.model:14s}{rung.setting:16s}   refused: {rung.refused}")
            continue
        errors = "".join(f"{rung.errors[branch]:14.2g}" for branch in branches)
        lines.append(f"{rung.model:14s}{rung.setting:16s}{1e3 * rung.seconds:7.3g} ms{errors}  {', '.join(dict.fromkeys(rung.worst.values()))}")
    return "\n".join(lines)
