"""Figures of images: what a preview shows, and a reduction with its error bars."""

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from spinline.radiography.reduction_dataset import plausible
from spinline.report.style import (
    BLUE,
    GREEN,
    GREY,
    LEGEND,
    ORANGE,
    PURPLE,
    RED,
    SheetAxes,
    grid,
    save_sheet,
    sheet_of,
    titled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from spinline.radiography.preview import Preview

__all__ = ["preview_sheet", "reduction_sheet", "save_sheet"]

_DOUBTFUL = ("not_converged", "misfit", "fringes", "smeared", "not_gaussian")

_STYLES = ((BLUE, "-", "o"), (ORANGE, "--", "s"), (GREEN, "-.", "^"))


def reduction_sheet(result: xr.Dataset, axes: SheetAxes = None) -> Figure:
    """Figure of a reduction: the map, the mean with its error, the radius, and profiles.

    Parameters
    ----------
    result : xarray.Dataset
        From `reduce`; of several frames, their weighted mean.
    axes : four matplotlib axes, optional
        Where to draw; a new sheet if left out.

    Returns
    -------
    matplotlib.figure.Figure
    """
    one = _shown(_one_frame(result), result)
    own = axes is None
    sheet, axes = sheet_of(axes, 2, 2, (9.6, 7.0), layout="constrained")
    along = 1e3 * one["z"].values
    _map(sheet, axes[0, 0], one, along)
    _mean(axes[0, 1], one, along)
    _radius(axes[1, 0], one, along)
    _profiles(axes[1, 1], one, along)
    for axis in axes.flat[1:]:
        grid(axis)
    method = result.attrs["method"]
    hidden = int((~plausible(result)).sum())
    note = f"; {hidden} whose fraction cannot be are not shown" if hidden else ""
    titled(
        sheet,
        own,
        f"{result.attrs['title']}\nmethod {method!r}, blocks of {result.attrs['block_rows']} rows{note}",
        fontsize=10.5,
    )
    return sheet


def preview_sheet(seen: "Preview", axes: SheetAxes = None) -> Figure:
    """Figure of a preview: the frame with the jet's edges and axis, one row, and the error to expect."""
    frame, track, experiment = seen.frame, seen.track, seen.experiment
    rows, columns = frame.counts.shape
    ratio = np.where(frame.good, (frame.counts - frame.dark) / np.where(frame.good, frame.flat, 1.0), np.nan)
    own = axes is None
    sheet, panels = sheet_of(axes, 1, 3, (9.6, 5.0), layout="constrained")
    left, middle, right = panels[0]
    step = max(1, rows // 1000), max(1, columns // 1000)
    low, high = np.nanpercentile(ratio, [0.5, 99.5])
    image = left.imshow(
        ratio[:: step[0], :: step[1]],
        extent=(0, columns, rows, 0),
        aspect="auto",
        cmap="gray",
        vmin=low,
        vmax=high,
        interpolation="nearest",
    )
    down = np.arange(rows) + 0.5
    half = 0.5 * columns
    for edge, style in ((-1, "-"), (0, ":"), (1, "-")):
        left.plot(half + track.axis + edge * track.radius, down, style, color=RED, linewidth=1)
    for span, colour in ((experiment.images.calibration_rows, GREEN), (experiment.images.nozzle_rows, ORANGE)):
        if span is not None:
            left.axhspan(*span, color=colour, alpha=0.25, linewidth=0)
    left.set(xlabel="pixel", ylabel="row", title="transmission, edges and axis")
    sheet.colorbar(image, ax=left, shrink=0.8)
    which = rows // 2
    middle.plot(np.arange(columns) + 0.5, ratio[which], color=BLUE, linewidth=0.8)
    for edge in (-1, 1):
        middle.axvline(half + track.axis[which] + edge * track.radius[which], color=RED, linewidth=1)
    middle.set(xlabel="pixel", ylabel="transmission", title=f"row {which}")
    phi = experiment.solution.volume_fraction
    right.plot(
        seen.row, seen.expected_std, "o-", color=BLUE, label=f"expected, {experiment.images.block_rows} rows a block"
    )
    right.axhline(phi, color=GREY, linestyle="--", label=f"solution's fraction {phi:.3g}")
    right.axhline(0.01, color=PURPLE, linestyle=":", label="0.01")
    right.set(xlabel="row", ylabel="standard deviation of the mean fraction", yscale="log", title="error to expect")
    right.legend(**LEGEND)
    titled(sheet, own, experiment.images.title or experiment.images.name, fontsize=10.5)
    return sheet


def _one_frame(result: xr.Dataset) -> xr.Dataset:
    """Weighted mean over frames, where there are several."""
    if "frame" not in result.dims:
        return result
    out = result.isel(frame=0).copy()
    for name in ("polymer_fraction", "mean_polymer_fraction", "jet_radius"):
        weight = 1.0 / result[f"{name}_std"] ** 2
        weight = weight.where(np.isfinite(weight) & np.isfinite(result[name]), 0.0)
        total = weight.sum("frame")
        shared = 0.0 if name == "jet_radius" else result["calibration_std"].max("frame")
        out[name] = (result[name].fillna(0.0) * weight).sum("frame") / total.where(total > 0)
        out[f"{name}_std"] = np.maximum(total.where(total > 0) ** -0.5, shared)
    return out


def _shown(one: xr.Dataset, result: xr.Dataset) -> xr.Dataset:
    """Without blocks that cannot be, whose numbers would set the scale of all others."""
    can = xr.DataArray(plausible(result), dims="row")
    names = [name for name in one.data_vars if one[name].dims[:1] == ("row",) and one[name].dtype.kind == "f"]
    return one.assign({name: one[name].where(can) for name in names})


def _map(sheet: Figure, axis: "Axes", one: xr.Dataset, along: Any) -> None:
    edges = np.append(one["relative_radius_bounds"].values[:, 0], one["relative_radius_bounds"].values[-1, 1])
    step = np.diff(along) if along.size > 1 else np.array([1.0])
    bounds = np.concatenate(
        ([along[0] - 0.5 * step[0]], along[:-1] + 0.5 * step if along.size > 1 else [], [along[-1] + 0.5 * step[-1]])
    )
    phi = one["polymer_fraction"].values
    high = float(np.nanpercentile(phi, 98)) if np.isfinite(phi).any() else 1.0
    mesh = axis.pcolormesh(bounds, edges, phi.T, cmap="viridis", vmin=min(0.0, float(np.nanmin(phi))), vmax=high)
    sheet.colorbar(mesh, ax=axis, label="polymer fraction")
    kind = "|x|/R" if one.attrs["method"] == "chord" else "r/R"
    axis.set(xlabel="z (mm)", ylabel=kind, title="chord means" if kind == "|x|/R" else "shells")


def _mean(axis: "Axes", one: xr.Dataset, along: Any) -> None:
    axis.errorbar(
        along,
        one["mean_polymer_fraction"],
        one["mean_polymer_fraction_std"],
        fmt="o",
        color=BLUE,
        markersize=3,
        linewidth=0.8,
        label="mean of the section",
    )
    odd = _marked(one)
    if odd.any():
        axis.plot(
            along[odd],
            one["mean_polymer_fraction"].values[odd],
            "x",
            color="black",
            markersize=6,
            zorder=4,
            label="flagged: not to be trusted",
        )
    phi, limit = float(one["volume_fraction"]), one["limit_std"].values
    axis.axhline(phi, color=GREY, linestyle="--", linewidth=1, label=f"solution {phi:.3g}")
    axis.fill_between(
        along, phi - limit, phi + limit, color=GREY, alpha=0.25, linewidth=0, label="Cramér–Rao, all else known"
    )
    axis.set(xlabel="z (mm)", ylabel="polymer fraction")
    axis.legend(**LEGEND)


def _marked(one: xr.Dataset) -> Any:
    """Blocks whose flags say that the model does not hold there."""
    flags = one.get("flags")
    if flags is None or flags.dims != ("row",):
        return np.zeros(one.sizes["row"], dtype=np.bool_)
    names = str(flags.attrs.get("flag_meanings", "")).split()
    bits = sum(1 << names.index(name) for name in _DOUBTFUL if name in names)
    return (flags.values.astype(np.int64) & bits) > 0


def _radius(axis: "Axes", one: xr.Dataset, along: Any) -> None:
    axis.errorbar(
        along, 1e6 * one["jet_radius"], 1e6 * one["jet_radius_std"], fmt="o", color=GREEN, markersize=3, linewidth=0.8
    )
    axis.set(xlabel="z (mm)", ylabel="jet radius (µm)", ylim=(0, None))


def _profiles(axis: "Axes", one: xr.Dataset, along: Any) -> None:
    """Profiles of the first, middle and last third of the rows, each the weighted mean of its blocks.

    What blocks share does not average out: the calibration, and in a map, whose rows are smoothed together, all of the error.
    """
    r = one["relative_radius"].values
    for part, (colour, line, mark) in zip(
        np.array_split(np.arange(along.size), min(3, along.size)), _STYLES, strict=False
    ):
        phi, std = one["polymer_fraction"].values[part], one["polymer_fraction_std"].values[part]
        weight = np.where(np.isfinite(phi) & (std > 0), 1.0 / np.where(std > 0, std, 1.0) ** 2, 0.0)
        total = weight.sum(axis=0)
        if not (total > 0).all():
            continue
        mean = (np.nan_to_num(phi) * weight).sum(axis=0) / total
        shared = np.full(part.size, np.nanmedian(one["calibration_std"].values[part]))[:, None]
        own = np.maximum(np.nan_to_num(std) ** 2 - shared**2, 0.0)
        error = np.sqrt((weight**2 * own).sum(axis=0) / total**2 + shared[0] ** 2)
        if one.attrs["method"] == "map":
            error = (np.nan_to_num(std) * weight).sum(axis=0) / total
        axis.errorbar(
            r,
            mean,
            error,
            color=colour,
            linestyle=line,
            marker=mark,
            markersize=4,
            capsize=2,
            linewidth=1,
            label=f"z = {along[part[0]]:.3g} to {along[part[-1]]:.3g} mm",
        )
    kind = "|x|/R" if one.attrs["method"] == "chord" else "r/R"
    axis.set(xlabel=kind, ylabel="polymer fraction", xlim=(0, 1))
    axis.legend(**LEGEND)
