"""Picture of a recipe's window: fibre diameter, how well it is known, orientation, regime.

Two settings that vary make maps, one makes curves with the 68 % band; of more the first two are drawn, the others held at their
middle value, named in the title.
"""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogFormatter

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.report.style import (
    BLUE,
    GREEN,
    GREY,
    LEGEND,
    ORANGE,
    PURPLE,
    RED,
    SheetAxes,
    check_format,
    grid,
    save_sheet,
    sheet_of,
    titled,
)
from spinline.report.window_axes import drawn_axes
from spinline.report.window_page import AXES

__all__ = ["fibre_window_figure", "save_fibre_window_figure"]

_COLOURS = {"jets": BLUE, "beads": ORANGE, "sprays": RED, "drips": PURPLE, "wet deposit": GREEN, "clogs": GREY}


def fibre_window_figure(window: xr.Dataset, axes: SheetAxes = None) -> Figure:
    """Figure of a recipe's window.

    Parameters
    ----------
    window : xarray.Dataset
        From `fibre_window`.
    axes : four matplotlib axes, optional
        Where to draw; a new sheet if left out.

    Returns
    -------
    matplotlib.figure.Figure
    """
    shown, held = drawn_axes(window, AXES)
    cut = window.isel(held).transpose("interval", *shown[::-1])
    own = axes is None
    sheet, panels = sheet_of(axes, 2, 2, (9.6, 7.2), layout="constrained")
    size, orientation = cut["fibre_diameter"].values * 1e9, cut["orientation"].values
    if not np.isfinite(size).any():
        raise InputError("window", "has no numbers: no point could be computed", remedy="see its `reason`")
    drawn = (
        ("fibre diameter (nm)", size, True),
        ("68 % within a factor of", np.sqrt(size[2] / size[0])[np.newaxis].repeat(3, axis=0), False),
        ("orientation in the solid fibre", orientation, True),
    )
    for panel, (label, values, log) in zip(panels.flat, drawn, strict=False):
        if len(shown) == 1:
            _curve(panel, cut, shown[0], label, values)
        else:
            _map(sheet, panel, cut, shown, label, values[1], log)
    _regimes(panels.flat[3], cut, shown)
    fixed = ", ".join(f"{AXES[name][0]} {float(cut[name]) * AXES[name][2]:.3g} {AXES[name][1]}" for name in held)
    titled(sheet, own, f"{window.attrs['title']}; {fixed}\n{window.attrs['intervals']}", fontsize=9.5)
    return sheet


def save_fibre_window_figure(window: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write the figure; the file's ending says the format (.png, .pdf, .svg)."""
    check_format(path)
    return save_sheet(fibre_window_figure(window), path, force=force)


def _label(name: str) -> str:
    return f"{AXES[name][0]} ({AXES[name][1]})"


def _curve(axis: Any, cut: xr.Dataset, along: str, label: str, values: FloatArray) -> None:
    x = cut[along].values * AXES[along][2]
    axis.fill_between(x, values[0], values[2], color=BLUE, alpha=0.2, linewidth=0, label="68 %")
    axis.plot(x, values[1], color=BLUE, linewidth=2, label="median")
    axis.set(xlabel=_label(along), ylabel=label)
    axis.set_ylim(bottom=0)
    grid(axis)
    axis.legend(**LEGEND)


def _map(
    sheet: Figure,
    axis: Any,
    cut: xr.Dataset,
    shown: list[str],
    label: str,
    values: FloatArray,
    log: bool,
) -> None:
    x, y = (cut[name].values * AXES[name][2] for name in shown)
    axis.set(xlabel=_label(shown[0]), ylabel=_label(shown[1]))
    axis.set_title(label, fontsize=9.5)
    axis.set_facecolor("0.92")
    good = np.isfinite(values) & ((values > 0) | (not log))
    wide = log and good.any() and values[good].max() > 1.05 * values[good].min()
    picture = axis.pcolormesh(
        x,
        y,
        np.ma.masked_where(~good, values),
        shading="nearest",
        cmap="viridis",
        norm=LogNorm() if wide else None,
        rasterized=True,
    )
    bar = sheet.colorbar(picture, ax=axis)
    if wide and 1 <= values[good].min() <= values[good].max() < 1e5:  # nanometres: 200, not 2 x 10^2
        bar.ax.yaxis.set_major_formatter("{x:g}")
        bar.ax.yaxis.set_minor_formatter(LogFormatter(minor_thresholds=(2, 0.5)))


def _regimes(axis: Any, cut: xr.Dataset, shown: list[str]) -> None:
    names = [*_COLOURS, *sorted(set(cut["regime"].values.ravel().tolist()) - set(_COLOURS))]
    codes = np.vectorize(names.index)(cut["regime"].values[1])
    colours = ListedColormap([_COLOURS.get(name, "white") for name in names])
    x = cut[shown[0]].values * AXES[shown[0]][2]
    y = np.array([0.0]) if len(shown) == 1 else cut[shown[1]].values * AXES[shown[1]][2]
    axis.pcolormesh(
        x, y, np.atleast_2d(codes), shading="nearest", cmap=colours, vmin=-0.5, vmax=len(names) - 0.5, alpha=0.75
    )
    axis.set_xlabel(_label(shown[0]))
    axis.set_yticks([]) if len(shown) == 1 else axis.set_ylabel(_label(shown[1]))
    axis.set_title("likeliest regime", fontsize=9.5)
    seen = [name for i, name in enumerate(names) if np.any(codes == i)]
    axis.legend(handles=[Patch(color=_COLOURS.get(name, "white"), alpha=0.75, label=name) for name in seen], **LEGEND)
