"""The figure of a fit: data and bands, residuals, parameters against their priors."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from spinline.report.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    SheetAxes,
    check_format,
    grid,
    save_sheet,
    sheet_of,
    titled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["fit_figure", "save_fit_figure"]

_MARKS: dict[str, tuple[str, str, str]] = {
    "radius": (GREY, "o", "radius"),
    "mean": (ORANGE, "s", "mean of the section"),
    "core": (BLUE, "^", "core"),
    "chord": (GREEN, "D", "chord through the axis"),
    "shell": (BLUE, "v", "innermost ring"),
}


def fit_figure(result: xr.Dataset, axes: SheetAxes = None) -> Figure:
    """Figure of a fit.

    Parameters
    ----------
    result : xarray.Dataset
        From `spinline.fit.output.fit_dataset`.
    axes : array of matplotlib axes, optional
        Where to draw: radius, fraction, strands, residuals of the radius, residuals of the fractions, parameters; a new
        sheet if left out.

    Returns
    -------
    matplotlib.figure.Figure
    """
    own = axes is None
    sheet, panels = sheet_of(_panels() if own else axes, 1, 6, (16.0, 6.8))
    radius, fraction, strands, left, right, priors = panels[0]
    _radius(radius, result)
    _fraction(fraction, result)
    _strands(strands, result)
    _residuals(left, result, ("radius",))
    _residuals(right, result, ("mean", "core", "chord", "shell"))
    _against_prior(priors, result)
    for axis in (radius, fraction):
        axis.tick_params(labelbottom=False)
    for axis in (left, right, strands):
        axis.set_xlabel("distance from the nozzle z (mm)")
    for axis in (radius, fraction, left, right, strands):
        grid(axis)
    for axis in (radius, fraction, strands):
        _crossover(axis, result)
    count = int(result.attrs["values"])
    fitted = f"χ² = {result.attrs['chi_squared']:.4g} for {count} values; data drawn with the best calibration"
    said = "bands: 68, 95 % of the posterior, at the residuals with the noise of a new measurement"
    titled(sheet, own, f"{result.attrs['title']}\n{fitted}; {said}", fontsize=10.5, y=0.985)
    return sheet


def _panels() -> "list[Axes]":
    """The six panels of a sheet of its own."""
    sheet = Figure(figsize=(16.0, 6.8))
    FigureCanvasAgg(sheet)
    cells = sheet.add_gridspec(
        2,
        4,
        width_ratios=(1, 1, 0.95, 0.82),
        height_ratios=(2.3, 1),
        left=0.045,
        right=0.985,
        bottom=0.08,
        top=0.88,
        wspace=0.24,
        hspace=0.08,
    )
    radius, fraction, strands = (sheet.add_subplot(cells[place]) for place in ((0, 0), (0, 1), (slice(None), 2)))
    left, right = sheet.add_subplot(cells[1, 0], sharex=radius), sheet.add_subplot(cells[1, 1], sharex=fraction)
    return [radius, fraction, strands, left, right, sheet.add_subplot(cells[:, 3])]


def save_fit_figure(result: xr.Dataset, path: str | Path, *, force: bool = False) -> Path:
    """Write the figure of a fit (.png, .pdf, .svg)."""
    check_format(path)
    return save_sheet(fit_figure(result), path, force=force)


def _calibration(result: xr.Dataset) -> dict[str, float]:
    """Best calibration; 1 and 0 where it was not fitted (or not identified)."""
    import json

    found: dict[str, float] = {
        "length_scale": 1.0,
        "fraction_scale": 1.0,
        "fraction_offset": 0.0,
        "origin": 0.0,
    } | json.loads(result.attrs["fixed"])
    for name in result["parameter"].values.tolist():
        best = float(result["best"].sel(parameter=name))
        if np.isfinite(best):
            found[name] = best
    return found


def _points(axis: "Axes", result: xr.Dataset, kind: str, scale: float, factor: float) -> None:
    fixed = _calibration(result)
    offset = 0.0 if kind == "radius" else fixed["fraction_offset"]
    pick = result["datum_kind"].values == kind
    pick = _first_rings(result, pick)
    if not pick.any():
        return
    colour, mark, words = _MARKS[kind]
    z = 1e3 * (result["datum_z"].values[pick] - fixed["origin"]) / fixed["length_scale"]
    axis.errorbar(
        z,
        factor * (result["datum_value"].values[pick] - offset) / scale,
        factor * result["datum_std"].values[pick] / scale,
        fmt=mark,
        color=colour,
        markersize=3,
        linewidth=0.8,
        alpha=0.75,
        label=f"{words}, measured",
    )


def _band(axis: "Axes", result: xr.Dataset, name: str, colour: str, factor: float, label: str) -> None:
    if name not in result:
        return
    z, rows = 1e3 * result["z"].values, factor * result[name].values
    for low, high, shade in ((0, 4, 0.18), (1, 3, 0.32)):
        axis.fill_between(z, rows[low], rows[high], color=colour, alpha=shade, linewidth=0)
    axis.plot(z, factor * result[f"{name}_best"].values, color=colour, linewidth=1.4, label=label)


def _strands(axis: "Axes", result: xr.Dataset) -> None:
    """Predicted extension and orientation of the strands."""
    _band(axis, result, "relative_extension", BLUE, 1.0, r"extension $\xi_\parallel/\xi_{\max}$")
    _band(axis, result, "orientation", GREEN, 1.0, "orientation $O$")
    axis.set_ylim(-0.02, 1.02)
    axis.set_title("strands, predicted", fontsize=9)
    if axis.lines:
        axis.legend(fontsize=8, framealpha=0.9, edgecolor="none", loc="upper left")


def _crossover(axis: "Axes", result: xr.Dataset) -> None:
    """Full stretch at the best parameters, and where it may be: bars of 68 and 95 % at the foot."""
    if "crossover_position" not in result:
        return
    ends, best = 1e3 * result["crossover_position"].values, 1e3 * float(result["crossover_position_best"])
    edge = axis.get_xlim()
    for low, high, width in ((0, 4, 2.0), (1, 3, 5.0)):
        if np.isfinite(ends[low]):
            top = ends[high] if np.isfinite(ends[high]) else 1e3 * float(result["z"][-1])
            axis.plot(
                (ends[low], top),
                (0.012, 0.012),
                color="black",
                alpha=0.55,
                linewidth=width,
                solid_capstyle="butt",
                transform=axis.get_xaxis_transform(),
                zorder=5,
            )
    if np.isfinite(best):
        axis.axvline(best, color="black", linewidth=0.9)
        axis.annotate(
            "S",
            (best, 1.0),
            (3, -3),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            va="top",
            fontsize=9,
            fontweight="bold",
        )
    axis.set_xlim(edge)


def _as_measured(axis: "Axes", result: xr.Dataset, kind: str) -> None:
    """Band of what the instrument shows where that is no field of the jet: a chord's mean, a ring, a disc of rings."""
    pick = _first_rings(result, result["datum_kind"].values == kind)
    if "datum_band" not in result or not pick.any():
        return
    fixed = _calibration(result)
    z = 1e3 * (result["datum_z"].values[pick] - fixed["origin"]) / fixed["length_scale"]
    order = np.argsort(z, kind="stable")
    rows = (result["datum_band"].values[:, pick][:, order] - fixed["fraction_offset"]) / fixed["fraction_scale"]
    colour, _, words = _MARKS[kind]
    for low, high, alpha in ((0, 4, 0.18), (1, 3, 0.32)):
        axis.fill_between(
            z[order],
            rows[low],
            rows[high],
            color=colour,
            alpha=alpha,
            linewidth=0,
            label=f"{words}, fitted, as measured" if low else None,
        )


def _first_rings(result: xr.Dataset, pick: Any) -> Any:
    """Of rings those that are the first of their row; anything else as it is."""
    place, kinds = result["datum_z"].values, result["datum_kind"].values
    first = np.append(True, place[1:] != place[:-1]) | np.append(True, kinds[:-1] != "shell")
    return pick & (first | (kinds != "shell"))


def _radius(axis: "Axes", result: xr.Dataset) -> None:
    _points(axis, result, "radius", _calibration(result)["length_scale"], 1e6)
    _band(axis, result, "radius", RED, 1e6, "radius, fitted")
    _band(axis, result, "network_radius", BLUE, 1e6, "network radius, predicted")
    axis.set_yscale("log")
    axis.set_ylabel("radius (µm)")
    axis.legend(fontsize=8, framealpha=0.9, edgecolor="none")


def _fraction(axis: "Axes", result: xr.Dataset) -> None:
    scale = _calibration(result)["fraction_scale"]
    for kind in ("mean", "core", "chord", "shell"):
        _points(axis, result, kind, scale, 1.0)
    _band(axis, result, "mean_polymer_fraction", RED, 1.0, "mean, fitted")
    _band(axis, result, "core_polymer_fraction", BLUE, 1.0, "core, fitted")
    for kind in ("core", "chord", "shell"):
        _as_measured(axis, result, kind)
    kinds = set(result["datum_kind"].values.tolist())
    if {"mean", "core", "chord", "shell"} & kinds:  # the data decide the range, not a band that runs to 1 beyond them
        pick = np.isin(result["datum_kind"].values, ("mean", "core", "chord", "shell"))
        shown = (result["datum_value"].values[pick] - _calibration(result)["fraction_offset"]) / scale
        noise = result["datum_std"].values[pick] / scale
        reach = max(float((shown + 2 * noise).max()), 1e-6)
        axis.set_ylim(min(0.0, float((shown - 2 * noise).min())), 1.15 * reach)
    axis.set_ylabel("polymer volume fraction")
    axis.legend(fontsize=8, framealpha=0.9, edgecolor="none", loc="upper left")


def _residuals(axis: "Axes", result: xr.Dataset, kinds: tuple[str, ...]) -> None:
    fixed = _calibration(result)
    for kind in kinds:
        pick = result["datum_kind"].values == kind
        colour, mark, words = _MARKS[kind]
        z = 1e3 * (result["datum_z"].values[pick] - fixed["origin"]) / fixed["length_scale"]
        axis.plot(z, result["datum_residual"].values[pick], mark, color=colour, markersize=3, alpha=0.75, label=words)
    _expected(axis, result, kinds)
    axis.axhline(0, color="0.3", linewidth=0.8)
    reach = float(np.abs(result["datum_residual"].values).max())
    axis.set_ylim(-max(3.5, 1.1 * reach), max(3.5, 1.1 * reach))
    axis.set_ylabel("residual (sd)")


def _expected(axis: "Axes", result: xr.Dataset, kinds: tuple[str, ...]) -> None:
    """Where 68 and 95 % of new measurements would fall, in standard deviations from the best prediction."""
    pick = np.isin(result["datum_kind"].values, kinds)
    if "datum_predictive" not in result or not pick.any():
        for level in (-2, 2):
            axis.axhline(level, color="0.6", linewidth=0.8, linestyle=":")
        return
    fixed = _calibration(result)
    z = 1e3 * (result["datum_z"].values[pick] - fixed["origin"]) / fixed["length_scale"]
    order = np.argsort(z, kind="stable")
    off = (result["datum_predictive"] - result["datum_predicted"]) / result["datum_std"]
    rows = off.transpose("quantile", "datum").values[:, pick][:, order]
    for low, high, shade in ((0, 4, "0.93"), (1, 3, "0.86")):
        axis.fill_between(z[order], rows[low], rows[high], color=shade, linewidth=0, zorder=0)


def _against_prior(axis: "Axes", result: xr.Dataset) -> None:
    """Posterior of each parameter, over its best value; grey, its prior."""
    names = result["parameter"].values.tolist()
    head = "sampled_" if result.attrs["sampler"] == "emcee" else ""
    for i, name in enumerate(names):
        one: Any = result.isel(parameter=i)
        row = len(names) - 1 - i
        if not bool(one["identified"]):
            axis.text(
                0.5,
                row,
                f"{name}: not identified",
                transform=axis.get_yaxis_transform(),
                ha="center",
                va="center",
                fontsize=8.5,
            )
            continue
        best, std, prior = (float(one[key]) for key in ("best", "std", "prior_std"))
        unit = prior if np.isfinite(prior) else 3 * std
        if not unit > 0:
            continue
        centre = float(one["prior_value"]) if np.isfinite(prior) else best
        if np.isfinite(prior):
            axis.barh(row, 2, left=-1, height=0.55, color="0.88")
            axis.barh(row, 4, left=-2, height=0.55, color="0.88", alpha=0.5)
        for percent, width in ((95, 1.6), (68, 4.0)):
            ends = [(float(one[f"{head}{word}{percent}"]) - centre) / unit for word in ("low", "high")]
            axis.plot(np.clip(ends, -3.4, 3.4), (row, row), color=BLUE, linewidth=width, solid_capstyle="butt")
        axis.plot(np.clip((best - centre) / unit, -3.4, 3.4), row, "o", color=RED, markersize=4)
        axis.text(
            -3.45,
            row + 0.36,
            f"{name} = {_short(name, best, std)}" + ("" if np.isfinite(prior) else "  (no prior)"),
            fontsize=8.5,
            va="bottom",
        )
    axis.set_xlim(-3.5, 3.5)
    axis.set_ylim(-0.6, len(names) - 0.2)
    axis.set_yticks([])
    axis.set_xlabel("prior standard deviations from the prior")
    axis.set_title("posterior (blue: 68, 95 %) and prior (grey)", fontsize=9)


def _short(name: str, value: float, std: float) -> str:
    """Value and standard deviation to two digits of the latter."""
    from spinline.fit.output import handy

    unit, factor = handy(name, value)
    digits = max(0, 1 - int(np.floor(np.log10(factor * std)))) if std > 0 and np.isfinite(std) else 3
    return f"{factor * value:.{min(digits, 12)}f} ± {factor * std:.{min(digits, 12)}f} {unit}".strip()
