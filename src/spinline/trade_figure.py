"""Error against cost of every rung on one scene: the figure of `spinline trade`."""

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from spinline.figures import BLUE, GREEN, ORANGE, PURPLE, RED, check_format
from spinline.outputs import replacing
from spinline.trade import Trade

__all__ = ["save_trade_figure", "trade_figure"]

_MARKS = {
    "affine": ("o", BLUE),
    "manifold": ("s", ORANGE),
    "chain": ("^", RED),
    "conformation": ("D", GREEN),
    "walk": ("v", PURPLE),
}
_LEAST = 1e-12  # an error below this is drawn here


_HEIGHT = 200.0  # points, of a panel's marks
_SHIFTS = (8, -14, 18, -24)  # points, where a label may stand
_WIDE, _HIGH = 0.5, 10.0  # decades and points that a label covers


def _free(taken: list[tuple[float, float]], x: float, height: float) -> bool:
    """Whether a label fits between those there are."""
    return all(abs(x - other) > _WIDE or abs(height - high) > _HIGH for other, high in taken)


def trade_figure(measured: Trade) -> Figure:
    """One panel a branch: the largest error of the reported quantities against processor time."""
    branches = sorted({branch for rung in measured.rungs for branch in rung.errors}) or ["no reference"]
    sheet = Figure(figsize=(5.4 * len(branches), 4.4), layout="constrained")
    FigureCanvasAgg(sheet)
    for axis, branch in zip(sheet.subplots(1, len(branches), squeeze=False)[0], branches, strict=True):
        points = [
            (rung.seconds, rung.errors[branch], rung)
            for rung in measured.rungs
            if branch in rung.errors and not rung.refused
        ]
        drawn: set[str] = set()
        labels: list[tuple[float, float, str, tuple[float, float]]] = []
        for seconds, error, rung in points:
            mark, colour = _MARKS[rung.model]
            place = (1e3 * seconds, max(error, _LEAST))
            axis.plot(*place, mark, color=colour, markersize=8, label=None if rung.model in drawn else rung.model)
            drawn.add(rung.model)
            labels.append((np.log10(place[0]), np.log10(place[1]), rung.setting, place))
        span = max([4.0, *(abs(one[1] - other[1]) for one in labels for other in labels)])
        taken: list[tuple[float, float]] = []
        for x, y, words, place in labels:
            height = y / span * _HEIGHT
            shift = next((s for s in _SHIFTS if _free(taken, x, height + s)), None)
            if shift is None:
                continue  # the table has it
            taken.append((x, height + shift))
            axis.annotate(words, place, (0, shift), textcoords="offset points", fontsize=7, ha="center")
        front, best = [], float("inf")
        for seconds, error, _ in sorted(points, key=lambda point: point[:2]):
            if error < best:
                front.append((1e3 * seconds, max(error, _LEAST)))
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
        axis.set(
            xscale="log",
            yscale="log",
            xlabel="processor time (ms)",
            ylabel=f"largest error against the {branch} reference",
        )
        axis.legend(fontsize=8, framealpha=0.9, edgecolor="none")
        axis.margins(x=0.35, y=0.12)
        axis.grid(visible=True, which="major", color="0.9", linewidth=0.6)
    return sheet


def save_trade_figure(measured: Trade, path: str | Path, *, force: bool = False) -> Path:
    """Write the figure; the file's ending says the format (.png, .pdf, .svg)."""
    file = check_format(path)
    with replacing(file, force=force) as part:
        trade_figure(measured).savefig(part, dpi=130, format=file.suffix[1:].lower())
    return file
