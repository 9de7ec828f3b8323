"""Figs. 36 and 37 of the review: a reduced X-ray map beside a scene's prediction."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from spinline.fit.overlay import compare_theory, theory_words
from spinline.report.style import (
    BANDS,
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
    shade_between,
    sheet_of,
    titled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["compare_theory", "overlay_figure", "save_overlay", "theory_words"]


def overlay_figure(result: xr.Dataset, axes: SheetAxes = None) -> "Figure":
    """Figs. 36 and 37 with measurement and theory.

    Parameters
    ----------
    result : xarray.Dataset
        From `compare_theory`.
    axes : two matplotlib axes, optional
        Where to draw; a new sheet if left out.

    Returns
    -------
    matplotlib.figure.Figure
    """
    own = axes is None
    sheet, panels = sheet_of(axes, 1, 2, (10.5, 4.6), layout="constrained")
    left, right = panels[0]
    _figure36(left, result)
    _figure37(right, result)
    for axis in (left, right):
        grid(axis)
    of = result.attrs["bands"]
    said = "" if of.startswith("none") else f"\nbands: {of}"
    titled(
        sheet, own, f"{result.attrs['title']}; log-likelihood {result.attrs['log_likelihood']:.5g}{said}", fontsize=10.5
    )
    return sheet


def save_overlay(result: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write the figure (.png, .pdf, .svg)."""
    check_format(path)
    return save_sheet(overlay_figure(result), path, force=force)


def _shade(axis: "Axes", x: Any, result: xr.Dataset, name: str, colour: str) -> None:
    if name in result:
        shade_between(axis, x, result[name].values, colour)


def _figure36(axis: "Axes", result: xr.Dataset) -> None:
    axis.errorbar(
        result["radius_ratio"].values,
        result["core_measured"].values,
        result["core_measured_std"].values,
        result["radius_ratio_std"].values,
        fmt="o",
        color=GREY,
        markersize=3,
        linewidth=0.7,
        alpha=0.8,
        label="measured",
    )
    _shade(axis, result["curve_radius_ratio"].values, result, "curve_core_band", BLUE)
    if "crossover_radius_ratio_band" in result:
        ends = result["crossover_radius_ratio_band"].values
        for left, right, alpha in BANDS:
            axis.axvspan(ends[left], ends[right], color=PURPLE, alpha=alpha, linewidth=0)
    axis.plot(
        result["curve_radius_ratio"],
        result["curve_core"],
        color=BLUE,
        linewidth=1.6,
        label=r"Eq. (40), $V = (r_0/r)^2$, seen over the core's rings",
    )
    axis.plot(
        result["curve_radius_ratio"],
        result["curve_local"],
        color=BLUE,
        linewidth=0.8,
        linestyle="-.",
        label="the network itself",
    )
    order = np.argsort(result["radius_ratio_predicted"].values)
    ordered = result.isel(row=order)
    _shade(axis, ordered["radius_ratio_predicted"].values, ordered, "core_predicted_band", RED)
    axis.plot(
        result["radius_ratio_predicted"].values[order],
        result["core_predicted"].values[order],
        color=RED,
        linestyle="--",
        linewidth=1.2,
        label="the scene at the rows' z",
    )
    crossing = result.attrs["crossover_radius_ratio"]
    axis.axvline(crossing, color=PURPLE, linestyle=":", linewidth=1.4, label=f"crossover, Eq. (38): {crossing:.3g}")
    axis.set_xscale("log")
    low = float(min(result["curve_radius_ratio"].min(), result["radius_ratio"].min()))
    ticks = [tick for tick in (0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0) if tick >= 0.9 * low]
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.set_xticks([], minor=True)
    axis.set_xlabel("relative jet radius $r/r_0$")
    top = float((result["core_measured"] + 2 * result["core_measured_std"]).max())
    axis.set_ylim(top=1.15 * max(top, float(result["curve_core"].max())))
    axis.set_ylabel("polymer fraction of the core, as measured")
    axis.set_title("Fig. 36", fontsize=9.5)
    axis.legend(**LEGEND)


def _figure37(axis: "Axes", result: xr.Dataset) -> None:
    centre, edges = result["shell_centre"].values, np.append(0.0, result["shell_outer"].values)
    marks = ("o", "s", "^", "v", "D", "P")
    for i in range(result.sizes["place"]):
        colour, one = (BLUE, ORANGE, GREEN, RED, PURPLE)[i % 5], result.isel(place=i)
        size = float(one["place_radius_ratio"])
        change, error = one["relative_change"].values, one["relative_change_std"].values
        axis.errorbar(
            size * centre,
            change,
            error,
            fmt=marks[i % 6],
            color=colour,
            markersize=3.5,
            linewidth=0.8,
            label=f"z = {1e3 * float(one['place_z']):.2g} mm",
        )
        if "relative_change_band" in one:
            rows = one["relative_change_band"].values
            for low, high, alpha in BANDS:
                axis.stairs(
                    rows[high], size * edges, baseline=rows[low], fill=True, color=colour, alpha=alpha, linewidth=0
                )
        axis.stairs(one["relative_change_predicted"].values, size * edges, color=colour, linewidth=1.1, baseline=None)
    axis.axhline(0, color="0.4", linewidth=0.8)
    axis.set_xlabel("distance from the axis $r/r_0$")
    axis.set_ylabel("relative change of the polymer fraction")
    axis.set_title("Fig. 37; lines: theory over the same rings", fontsize=9.5)
    axis.legend(**LEGEND)
