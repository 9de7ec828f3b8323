"""Picture of an operating window: crossover, orientation, dryness; the estimate of k as a band, not as a line.

Two axes that vary make maps at the estimated k, with the line where the crossover leaves the jet drawn for k at both ends of
its factor: between them the estimate cannot say. One axis makes curves with bands. Of more axes the first two are drawn, the
others held at their middle value, named in the title.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from spinline.report.style import BLUE, GREY, LEGEND, SheetAxes, check_format, grid, save_sheet, sheet_of, titled
from spinline.report.window_axes import drawn_axes
from spinline.study.window import AXES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["save_window_figure", "window_figure"]

_LABELS = {
    "voltage": ("voltage (kV)", 1e-3),
    "gap": ("gap (cm)", 1e2),
    "flow_rate": ("flow rate (mL/hour)", 3.6e9),
    "mass_fraction": ("polymer mass fraction (%)", 1e2),
    "crossover_position": ("crossover from the nozzle (mm)", 1e3),
    "crossover_radius": ("jet radius at the crossover (µm)", 1e6),
    "orientation": ("orientation at the end of the jet", 1.0),
    "dryness": ("solvent lost at the end of the jet (%)", 1e2),
}
_PANELS = ("crossover_position", "crossover_radius", "orientation", "dryness")


def window_figure(window: xr.Dataset, axes: SheetAxes = None) -> Figure:
    """Figure of a window.

    Parameters
    ----------
    window : xarray.Dataset
        From `operating_window`.
    axes : four matplotlib axes, optional
        Where to draw; a new sheet if left out.

    Returns
    -------
    matplotlib.figure.Figure
    """
    shown, held = drawn_axes(window, AXES)
    cut = window.isel(held)
    own = axes is None
    sheet, axes = sheet_of(axes, 2, 2, (9.6, 7.2), layout="constrained")
    for axis, name in zip(axes.flat, _PANELS, strict=True):
        if len(shown) == 1:
            _curve(axis, cut, name, shown[0])
        else:
            _map(sheet, axis, cut, name, shown)
    fixed = ", ".join(
        f"{_LABELS[name][0].partition(' (')[0]} {_LABELS[name][1] * float(cut[name]):.3g} {_unit(name)}"
        for name in held
    )
    low, _, high = window["k_factor"].values
    lines = f"k as estimated (line), {low:g} k (dotted), {high:g} k (dashed)"
    if not np.isfinite(window["k"]).any():
        lines = "jets computed from their settings"
    meaning = lines if len(shown) == 1 else f"full stretch at the end of the jet for {lines}"
    titled(sheet, own, f"{window.attrs['title']}; {fixed}\n{meaning}", fontsize=9.5)
    return sheet


def save_window_figure(window: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write the figure; the file's ending says the format (.png, .pdf, .svg).

    Raises
    ------
    InputError
        For another ending, a window of one point, or a file that cannot be written.
    """
    check_format(path)
    return save_sheet(window_figure(window), path, force=force)


def _unit(name: str) -> str:
    return _LABELS[name][0].partition("(")[2].rstrip(")")


def _scaled(cut: xr.Dataset, name: str, *dims: str) -> Any:
    """Values of a variable in the unit of its label, (k_factor, *dims)."""
    return cut[name].transpose("k_factor", *dims).values * _LABELS[name][1]


def _curve(axis: "Axes", cut: xr.Dataset, name: str, along: str) -> None:
    x, y = cut[along].values * _LABELS[along][1], _scaled(cut, name, along)
    low, high = np.fmin(y[0], y[2]), np.fmax(y[0], y[2])
    if name == "crossover_position":  # beyond the end of the jet for one end of the band: up to that end at least
        end = float(cut.attrs["jet_length"]) * _LABELS[name][1]
        high = np.where(np.isnan(y).any(axis=0) & np.isfinite(low), end, high)
        axis.axhline(end, color=GREY, linewidth=1, label="end of the jet")
    axis.fill_between(x, low, high, color=BLUE, alpha=0.2, linewidth=0, label="k within its factor")
    axis.plot(x, y[1], color=BLUE, linewidth=2, label="k as estimated")
    axis.plot(x, y[0], color=GREY, linestyle=":", linewidth=1)
    axis.plot(x, y[2], color=GREY, linestyle="--", linewidth=1)
    axis.set_xlabel(_LABELS[along][0])
    axis.set_ylabel(_LABELS[name][0])
    grid(axis)
    if not np.isfinite(y).any():
        _nothing(axis)
    else:
        axis.legend(**LEGEND)


def _map(sheet: Figure, axis: "Axes", cut: xr.Dataset, name: str, shown: list[str]) -> None:
    x, y = (cut[along].values * _LABELS[along][1] for along in shown)
    values = _scaled(cut, name, *shown[::-1])
    axis.set_xlabel(_LABELS[shown[0]][0])
    axis.set_ylabel(_LABELS[shown[1]][0])
    axis.set_title(_LABELS[name][0], fontsize=9.5)
    if not np.isfinite(values[1]).any():
        _nothing(axis)
        return
    picture = axis.pcolormesh(x, y, np.ma.masked_invalid(values[1]), shading="nearest", cmap="viridis", rasterized=True)
    sheet.colorbar(picture, ax=axis)
    axis.set_facecolor("0.92")
    reached = np.isfinite(cut["crossover_position"].transpose("k_factor", *shown[::-1]).values)
    unsure = reached.any(axis=0) & ~reached.all(axis=0)
    if unsure.any() and name.startswith("crossover"):
        axis.contourf(x, y, unsure.astype(float), levels=[0.5, 1.5], colors="none", hatches=["///"])
    if name != "dryness":
        full = np.nan_to_num(cut["full_stretch"].transpose("k_factor", *shown[::-1]).values)
        for flags, stretch, style in zip(reached, full, (":", "-", "--"), strict=True):
            if flags.any() and not flags.all():
                axis.contour(x, y, stretch, levels=[1.0], colors="black", linewidths=1.0, linestyles=style)
    if name.startswith("crossover") and unsure.any():
        axis.text(
            0.02,
            0.02,
            "hatched: reached for some k of the band",
            transform=axis.transAxes,
            fontsize=7.5,
            bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none"},
        )


def _nothing(axis: "Axes") -> None:
    axis.text(0.5, 0.5, "not reached, or not estimated", transform=axis.transAxes, ha="center", va="center", fontsize=9)
