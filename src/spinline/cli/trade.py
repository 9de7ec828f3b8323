"""Commands about which model to take: ``plan`` says, ``trade`` measures."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spinline.cli.options import ForceOption, JsonOption, ModelOption, RtolOption, SceneArgument, SetOption, load, page
from spinline.cli.speech import say

if TYPE_CHECKING:
    from spinline.plan.choice import Plan
    from spinline.study.trade import Trade

__all__ = ["plan", "trade"]


def plan(
    scene: SceneArgument,
    json: JsonOption = False,
    model: ModelOption = None,
    rtol: RtolOption = None,
    set_: SetOption = None,
) -> None:
    """Which physics this scene needs, and the number that decides."""
    loaded = load(scene, model, rtol, set_)
    from spinline.plan.choice import plan_scene
    from spinline.setup.build import build_jet, build_solution

    solution = build_solution(loaded)
    made = plan_scene(loaded, solution, build_jet(loaded, solution))
    if json:
        say(made.json())
        return
    say(made.reason)
    for line in _listed(made):
        say(line)
    for remark in made.remarks:
        say(f"warning: {remark}", err=True)


def trade(
    scene: SceneArgument,
    quick: Annotated[bool, typer.Option("--quick", help="Only the rung next to the affine network.")] = False,
    figure: Annotated[Path | None, typer.Option(help="Error against cost (.png, .pdf, .svg).")] = None,
    report: Annotated[
        Path | None,
        typer.Option(help="Report of a run of the scene with this trade in it, one HTML file.", callback=page),
    ] = None,
    json: JsonOption = False,
    force: ForceOption = False,
    rtol: RtolOption = None,
    set_: SetOption = None,
) -> None:
    """Error against cost of every model, measured on this scene."""
    from spinline.base.files import outputs

    loaded = load(scene, None, rtol, set_)
    if figure is not None:
        from spinline.report.figures import check_format

        check_format(figure)
    outputs(figure, report, force=force)
    from spinline.study.trade import trade as measure

    measured = measure(loaded, quick=quick, progress=lambda words: say(f"measuring {words}", err=True))
    if figure is not None:
        from spinline.report.trade_figure import save_trade_figure

        save_trade_figure(measured, figure, force=force)
    if report is not None:
        from spinline.report.page import save_report
        from spinline.solve.spine import run as solve

        save_report(solve(loaded).assign_attrs(trade=measured.json()), report, force=force)
    if json:
        say(measured.json())
        return
    say(_table(measured))
    say(measured.recommendation)
    files = [str(file) for file in (figure, report) if file is not None]
    if files:
        say("wrote " + ", ".join(files))


def _listed(made: "Plan") -> list[str]:
    lines = [f"{'':9s}{'effect':22s}{'number':>10s}  {'what it is':26s}{'error without':>14s}  why"]
    for effect in made.effects:
        state = "in" if effect.name in made.used else "left out"
        number = "-" if effect.number != effect.number else f"{effect.number:.3g}"
        error = "not known" if effect.error != effect.error else f"{effect.error:.2g}"
        lines.append(f"{state:9s}{effect.name:22s}{number:>10s}  {effect.symbol:26s}{error:>14s}  {effect.words}")
    for one in made.verdicts:
        state, limit = "jet" if one.good else "jet  !", f"limit {one.limit:.3g}"
        lines.append(f"{state:9s}{one.name:22s}{one.value:10.3g}  {limit:26s}{'':14s}  {one.text}")
    return lines


def _table(measured: "Trade") -> str:
    branches = list(measured.rungs[0].errors)
    lines = [f"{branch} reference: {words}" for branch, words in measured.references.items()]
    lines.append(
        f"{'model':14s}{'setting':16s}{'time':>10s}" + "".join(f"{branch:>14s}" for branch in branches) + "  worst"
    )
    for rung in measured.rungs:
        if rung.refused:
            lines.append(f"{rung.model:14s}{rung.setting:16s}   refused: {rung.refused}")
            continue
        errors = "".join(f"{rung.errors[branch]:14.2g}" for branch in branches)
        worst = ", ".join(dict.fromkeys(rung.worst.values()))
        lines.append(f"{rung.model:14s}{rung.setting:16s}{1e3 * rung.seconds:7.3g} ms{errors}  {worst}")
    return "\n".join(lines)
