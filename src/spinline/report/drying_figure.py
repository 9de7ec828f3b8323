"""Two more panels where a jet dries or relaxes: the fraction across it, and what the solution becomes along it."""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.report.style import BLUE, GREEN, GREY, LEGEND, ORANGE, RED, shade, shade_between

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from spinline.base.named_arrays import NamedArrays

__all__ = ["across", "along"]

_HEADROOM = 0.6  # of the curves' height, for the legend over them


def across(axis: "Axes", place: Any, result: "xr.Dataset | NamedArrays") -> None:
    """Map of the polymer fraction; without radial drying, the volume that is left, or the stress."""
    if "polymer_fraction" in result:
        from matplotlib.colors import LogNorm

        values = np.asarray(result["polymer_fraction"].values)
        floor = max(1e-4, 0.2 * float(result["volume_fraction"]))
        picture = axis.pcolormesh(
            place,
            result["r"].values,
            np.maximum(values, floor).T,
            norm=LogNorm(floor, 1.0),
            cmap="cividis",
            shading="nearest",
            rasterized=True,
        )
        axis.set_ylim(0, 1)
        axis.set_ylabel("distance from the axis $r/R$")
        # the scale stands above the map, not on it: skin and core may be anywhere
        left, bottom, width, height = axis.get_position().bounds
        axis.set_position((left, bottom, width, 0.83 * height))
        strip = axis.figure.add_axes((left, bottom + 0.92 * height, width, 0.03 * height))
        bar = axis.figure.colorbar(picture, cax=strip, orientation="horizontal")
        bar.ax.tick_params(labelsize=7)
        bar.ax.set_title("polymer volume fraction", fontsize=7, pad=2)
        return
    if "evaporated_fraction" in result:
        if "evaporated_fraction_band" in result:
            left = 1 - result["evaporated_fraction_band"].values
            shade_between(axis, place, left, GREY)
        shade(axis, place, result, "mean_polymer_fraction", BLUE)
        axis.plot(place, 1 - result["evaporated_fraction"], color=GREY, linewidth=2, label="volume left")
        axis.plot(place, result["mean_polymer_fraction"], color=BLUE, linestyle="--", label="polymer, of the section")
        axis.set_ylim(0, 1.05)
        axis.set_ylabel("fraction of the volume")
    elif "stress" in result:
        shade(axis, place, result, "stress", RED, positive=True)
        axis.plot(place, result["stress"], color=RED, label=r"polymer stress $\tau_{zz}$")
        axis.set_yscale("log")
        axis.set_ylabel("stress (Pa)")
    else:  # nothing dries, and the strands are those of a network that slips
        axis.set_axis_off()
        return
    axis.legend(**LEGEND)


def along(axis: "Axes", place: Any, result: "xr.Dataset | NamedArrays") -> None:
    """Viscosity and relaxation time over what they were at the nozzle, and the Weissenberg number."""
    for name, colour, style, label in (
        ("viscosity", BLUE, "-", r"viscosity $\mu/\mu_0$"),
        ("relaxation_time", ORANGE, "--", r"relaxation time $\theta/\theta_0$"),
    ):
        if name in result:
            shade(axis, place, result, f"{name}_ratio", colour)
            axis.plot(place, result[name] / result[name].values[0], color=colour, linestyle=style, label=label)
    if "weissenberg_number" in result:
        shade(axis, place, result, "weissenberg_number", GREEN, positive=True)
        number = np.asarray(result["weissenberg_number"].values)
        values = np.where(number > 0, number, np.nan)
        axis.plot(place, values, color=GREEN, linestyle="-.", label=r"Weissenberg number $\theta\dot\varepsilon$")
        axis.axhline(0.5, color=GREY, linestyle=":", linewidth=1, label="1/2: strands stretch without end")
    handles = list(axis.get_lines())
    if handles:
        axis.set_yscale("log")
    if "temperature" in result:
        warm = axis.twinx()
        handles += warm.plot(
            place, result["temperature"] - 273.15, color=RED, linewidth=1.5, label="temperature (°C, right)"
        )
        warm.tick_params(axis="y", pad=2, labelsize=7, labelcolor=RED)
        warm.grid(False)
        # two scales: no place is free of both curves but above them
        if axis.get_yscale() == "log":
            low, high = (float(np.log10(v)) for v in axis.get_ylim())
            axis.set_ylim(10**low, 10 ** min(high + _HEADROOM * (high - low), 305.0))
        cold, hot = warm.get_ylim()
        warm.set_ylim(cold, hot + _HEADROOM * (hot - cold))
        warm.legend(handles=handles, **LEGEND, loc="upper right")
    elif handles:
        axis.legend(handles=handles, **LEGEND, loc="best")
    axis.set_ylabel("the solution along the jet")
