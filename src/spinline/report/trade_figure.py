"""Error against cost of every rung on one scene: the figure of `spinline trade`."""

from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from spinline.network_models.registry import RUNGS
from spinline.report.style import (
    BLUE,
    DPI,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    SheetAxes,
    check_format,
    drawn,
    grid,
    save_sheet,
    sheet_of,
)
from spinline.study.trade import Measured, Trade

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["save_trade_figure", "trade_figure", "trade_png"]

_LOOKS = (("o", BLUE), ("s", ORANGE), ("D", GREEN), ("^", RED), ("v", PURPLE), ("P", GREY), ("X", BLUE), ("*", ORANGE))
_LEAST = 1e-15  # an error of nothing is drawn at a tenth of the smallest other


def trade_figure(measured: Trade, axes: SheetAxes = None) -> Figure:
    """One panel a branch: the largest error of the reported quantities against processor time.

    Points carry the numbers of the legend; the grey steps join those that nothing cheaper beats (Pareto's front). A rung that
    gives the reference itself has no error to draw and stands at the foot, hollow. `axes`: one a branch, or a new sheet.
    """
    branches = sorted({branch for rung in measured.rungs for branch in rung.errors}) or ["no reference"]
    sheet, panels = sheet_of(axes, 1, len(branches), (4.6 * len(branches) + 2.4, 4.4), layout="constrained")
    run = [rung for rung in measured.rungs if not rung.refused]
    for axis, branch in zip(panels[0], branches, strict=True):
        _panel(axis, measured, [(i, rung) for i, rung in enumerate(run, 1) if branch in rung.errors], branch)
    keys = [
        Line2D(
            [],
            [],
            linestyle="",
            marker=_look(rung.model)[0],
            color=_look(rung.model)[1],
            markersize=7,
            label=f"{i}  {rung.model}, {rung.setting}",
        )
        for i, rung in enumerate(run, 1)
    ]
    sheet.legend(handles=keys, loc="outside right upper", fontsize=8, frameon=False)
    return sheet


def _look(model: str) -> tuple[str, str]:
    """Marker and colour of a rung: by its place in the ladder."""
    return _LOOKS[list(RUNGS).index(model) % len(_LOOKS)]


def _panel(axis: "Axes", measured: Trade, rungs: list[tuple[int, Measured]], branch: str) -> None:
    errors = [rung.errors[branch] for _, rung in rungs]
    floor = 0.1 * min([measured.rtol, *(error for error in errors if error > _LEAST)])
    points = sorted((rung.seconds, error, i, rung) for (i, rung), error in zip(rungs, errors, strict=True))
    for n, (seconds, error, i, rung) in enumerate(points):
        mark, colour = _look(rung.model)
        none = error <= _LEAST
        place = (1e3 * seconds, floor if none else error)
        axis.plot(*place, mark, color=colour, markersize=7, markerfacecolor="white" if none else colour)
        axis.annotate(
            f"{i}: none, it is the reference" if none else str(i),
            place,
            (0, 7 if n % 2 else -14),
            textcoords="offset points",
            fontsize=8,
            ha="center",
        )
    front, best = [], float("inf")
    for seconds, error, *_ in points:
        if error < best:
            front.append((1e3 * seconds, max(error, floor)))
            best = error
    if front:
        axis.plot(*zip(*front, strict=True), color="0.6", linewidth=1, zorder=0, drawstyle="steps-post")
    axis.axhline(measured.rtol, color="black", linestyle="--", linewidth=0.9)
    axis.annotate(
        f"rtol = {measured.rtol:g}",
        (0.01, measured.rtol),
        (0, 3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        fontsize=8,
    )
    what = f"largest error against the {branch} reference" if points else "no reference on this scene"
    axis.set(xscale="log", yscale="log", xlabel="processor time (ms)", ylabel=what)
    axis.margins(x=0.2, y=0.12)
    grid(axis)


def save_trade_figure(measured: Trade, path: str | Path, *, force: bool = False) -> Path:
    """Write the figure; the file's ending says the format (.png, .pdf, .svg)."""
    check_format(path)
    return save_sheet(trade_figure(measured), path, force=force)


def trade_png(measured: Trade, dpi: int = DPI) -> bytes:
    """The figure as PNG bytes."""
    return drawn(trade_figure(measured), dpi=dpi)
