"""The figure of a run: radius, stretch and orientation, concentration, with the crossover (S) and the glass (G) marked.

Readable in grey: every curve has its own line style. Colours are those of Okabe and Ito, told apart by the colour-blind.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from spinline.report.sentences import headline
from spinline.report.style import (
    BLUE,
    DPI,
    GREEN,
    GREY,
    LEGEND,
    ORANGE,
    PURPLE,
    QUICK,
    RED,
    SheetAxes,
    check_format,
    drawn,
    grid,
    save_sheet,
    shade,
    sheet_of,
    titled,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from spinline.base.named_arrays import NamedArrays

__all__ = ["check_format", "figure", "headline", "png", "save_figure", "shade"]


def figure(result: "xr.Dataset | NamedArrays", axes: SheetAxes = None) -> Figure:
    """Figure of a result; of its last time, if it has several.

    Parameters
    ----------
    result : xarray.Dataset
        From `spinline.run`.
    axes : array of matplotlib axes, optional
        Where to draw: 4, or 6 where the jet dries or relaxes, in reading order; a new sheet if left out.

    Returns
    -------
    matplotlib.figure.Figure
        The one that holds the axes.
    """
    if "time" in result.dims:
        result = result.isel(time=-1)
    rows = 3 if "evaporated_fraction" in result or "deborah_number" in result else 2
    height = 6.6 if rows == 2 else 9.4
    own = axes is None
    sheet, axes = sheet_of(axes, rows, 2, (9.0, height), sharex=True)
    if own:  # fixed margins: laying out by trial draws takes as long as the rest of a run
        below, above = 0.46 / height, 1 - 0.66 / height
        right = 0.95 if "temperature" in result else 0.985  # degrees stand at the right of the last panel
        sheet.subplots_adjust(left=0.075, right=right, bottom=below, top=above, wspace=0.2, hspace=0.05)
    beads = "element" in result.dims
    if beads:
        result = result.isel(element=np.flatnonzero(np.isfinite(result["stretch_ratio"].values)))
    place = 1e3 * result["arc_length" if beads else "z"].values
    _radii(axes[0, 0], place, result)
    _strands(axes[0, 1], place, result)
    _stretches(axes[1, 0], place, result)
    _fractions(axes[1, 1], place, result)
    if rows == 3:
        from spinline.report.drying_figure import across, along

        across(axes[2, 0], place, result)
        along(axes[2, 1], place, result)
    for axis in axes.flat if not own else axes[:1, 0]:
        if beads or _near_the_nozzle(result, place):
            axis.set_xscale("log")
        if not beads:
            axis.set_xlim(place[1] if axis.get_xscale() == "log" and place[0] <= 0 else place[0], place[-1])
    for i, axis in enumerate(axes.flat):
        dark = any(isinstance(drawn, QuadMesh) for drawn in axis.collections)
        _mark(axis, result, "white" if dark else "black", lettered=i < 2 or not own)
        grid(axis)
    for axis in axes[-1]:
        axis.set_xlabel("arc length from the nozzle (mm)" if beads else "distance from the nozzle z (mm)")
    said = f"; bands and bars: 68, 95 % of {result.attrs['uncertain_inputs']}" if "bands" in result.attrs else ""
    title = f"{result.attrs['title']}\n{headline(result)}{said}"
    titled(sheet, own, title, fontsize=10.5 if len(said) < 40 else 8.5, y=0.985)
    return sheet


def _near_the_nozzle(result: "xr.Dataset | NamedArrays", place: Any) -> bool:
    """Whether what matters happens in the first fortieth of the jet, where a linear axis shows nothing."""
    position = 1e3 * float(result["crossover_position"])
    return bool(np.isfinite(position) and place[0] < position < place[0] + (place[-1] - place[0]) / 40)


def png(result: "xr.Dataset | NamedArrays", dpi: int = DPI) -> bytes:
    """The figure as PNG bytes."""
    return drawn(figure(result), dpi=dpi, pil_kwargs=QUICK)


def save_figure(result: "xr.Dataset | NamedArrays", path: str | Path, *, force: bool = False) -> Path:
    """Write the figure; the file's ending says the format (.png, .pdf, .svg).

    Raises
    ------
    InputError
        For another ending, or a file that cannot be written.
    """
    check_format(path)
    return save_sheet(figure(result), path, force=force)


def _radii(axis: "Axes", place: Any, result: "xr.Dataset | NamedArrays") -> None:
    for name, colour in (("network_radius", BLUE), ("radius", GREY)):
        shade(axis, place, result, name, colour, 1e6)
    axis.plot(place, 1e6 * result["radius"], color=GREY, linewidth=2, label="jet $r$")
    axis.plot(place, 1e6 * result["network_radius"], color=BLUE, linestyle="--", label="network $r_P$, Eq. (39)")
    flux = np.asarray(1e6 * result["network_radius_conservative"])
    inside = np.where(flux <= 1e6 * np.asarray(result["radius"]) * (1 + 1e-9), flux, np.nan)  # a wider one is none
    axis.plot(place, inside, color=ORANGE, linestyle=":", label="network, flux conserved")
    axis.set_yscale("log")
    axis.yaxis.set_minor_formatter(NullFormatter())
    axis.set_ylabel("radius (µm)")
    axis.legend(**LEGEND)


def _strands(axis: "Axes", place: Any, result: "xr.Dataset | NamedArrays") -> None:
    for name, colour in (("relative_extension", BLUE), ("orientation", GREEN), ("radial_contraction", RED)):
        shade(axis, place, result, name, colour)
    axis.plot(place, result["relative_extension"], color=BLUE, label=r"extension $\xi_\parallel/\xi_{\max}$")
    axis.plot(place, result["orientation"], color=GREEN, linestyle="-.", label="orientation $O$")
    axis.plot(place, result["radial_contraction"], color=RED, linestyle="--", label=r"contraction $\xi_\perp/\xi_0$")
    axis.set_ylim(-0.05, 1.05)
    axis.set_ylabel("strands")
    axis.legend(**LEGEND, loc="best")


def _stretches(axis: "Axes", place: Any, result: "xr.Dataset | NamedArrays") -> None:
    shade(axis, place, result, "stretch_ratio", GREY)
    if "deborah_number" in result:
        shade(axis, place, result, "strand_stretch", GREEN)
    shade(axis, place, result, "axial_stretch", BLUE)
    axis.plot(place, result["stretch_ratio"], color=GREY, linewidth=2, label="solution, material stretch")
    if "deborah_number" in result:
        axis.plot(place, result["strand_stretch"], color=GREEN, linestyle="-.", label=r"strands, stretch $\lambda$")
    axis.plot(place, result["axial_stretch"], color=BLUE, linestyle="--", label=r"strands $\xi_\parallel/\xi_0$")
    contour = float(result["crossover_velocity_ratio"])
    if "crossover_velocity_ratio_band" in result:
        ends = result["crossover_velocity_ratio_band"].values
        for low, high, alpha in ((0, 4, 0.14), (1, 3, 0.24)):
            axis.axhspan(ends[low], ends[high], color=PURPLE, alpha=alpha, linewidth=0)
    axis.axhline(
        contour, color=PURPLE, linestyle=":", linewidth=1.2, label=rf"contour $\xi_{{\max}}/\xi_0$ = {contour:.3g}"
    )
    axis.set_yscale("log")
    axis.set_ylabel("stretch ratio")
    axis.legend(**LEGEND, loc="best")


def _fractions(axis: "Axes", place: Any, result: "xr.Dataset | NamedArrays") -> None:
    shade(axis, place, result, "core_polymer_fraction", BLUE)
    shade(axis, place, result, "mean_polymer_fraction", GREY)
    axis.plot(place, result["core_polymer_fraction"], color=BLUE, linestyle="--", label="core, exact walk")
    axis.plot(place, result["core_polymer_fraction_eq40"], color=RED, linestyle="-.", label="core, Eq. (40)")
    axis.plot(
        place, result["core_polymer_fraction_conservative"], color=ORANGE, linestyle=":", label="core, flux conserved"
    )
    axis.plot(place, result["mean_polymer_fraction"], color=GREY, linewidth=2, label="mean of the section")
    axis.set_yscale("log")
    axis.set_ylim(top=1.4)
    axis.set_ylabel("polymer volume fraction")
    axis.legend(**LEGEND, loc="best")


def _span(axis: "Axes", ends: Any, colour: str) -> None:
    """Where a mark may be, 68 and 95 %, as bars at the foot; to the end of the jet where the upper end lies beyond it."""
    edge = axis.get_xlim()[1]
    for low, high, width in ((0, 4, 2.0), (1, 3, 5.0)):
        if np.isfinite(ends[low]):
            high_end = ends[high] if np.isfinite(ends[high]) else edge
            axis.plot(
                (ends[low], high_end),
                (0.015, 0.015),
                color=colour,
                linewidth=width,
                alpha=0.55,
                solid_capstyle="butt",
                transform=axis.get_xaxis_transform(),
                zorder=5,
            )


def _mark(axis: "Axes", result: "xr.Dataset | NamedArrays", colour: str, *, lettered: bool) -> None:
    """Lines at the crossover and the glass, through every panel; their letters above the first row, over no curve."""
    for name, style, label in (
        ("crossover", "-", "S"),
        ("crossover_extension", (0, (1, 3)), ""),
        ("frozen", "--", "G"),
    ):
        position = 1e3 * float(result[f"{name}_position"]) if f"{name}_position" in result else np.nan
        if f"{name}_position_band" in result and label:
            _span(axis, 1e3 * result[f"{name}_position_band"].values, colour)
        if np.isfinite(position):
            axis.axvline(position, color=colour, linewidth=0.9, linestyle=style)
            if label and lettered:
                axis.annotate(
                    label,
                    (position, 1.0),
                    (0, 2),
                    xycoords=("data", "axes fraction"),
                    textcoords="offset points",
                    ha="center",
                    va="bottom",
                    fontsize=9,
                    fontweight="bold",
                    color="black",
                )
