"""The structure in numbers: what the network is at the crossover, at the end of the jet, and the fibre it would make.

Of the fibre only the radius can be said without a model of the rest of the flight: that of the polymer in the last
cross-section, ``r (phi_mean)^(1/2)``, if nothing were stretched any more.
"""

from typing import Any

import numpy as np
import xarray as xr

__all__ = ["SUMMARISED", "structure_summary"]

SUMMARISED = ("axial_stretch", "relative_extension", "orientation", "core_polymer_fraction", "network_radius")


def structure_summary(result: xr.Dataset) -> dict[str, Any]:
    """Numbers of a result: `SUMMARISED` with ``crossover_`` and ``end_`` before them, and ``fibre_radius``.

    Parameters
    ----------
    result : xarray.Dataset
        Profiles along the jet, crossover among the numbers; may have times.

    Returns
    -------
    dict
        Name to number, or to an array along time; NaN where the crossover is not reached.
    """
    if "time" in result.dims:
        moments = [structure_summary(result.isel(time=i)) for i in range(result.sizes["time"])]
        return {name: np.array([moment[name] for moment in moments]) for name in moments[0]}
    place = result["arc_length" if "element" in result.dims else "z"].values
    known = np.flatnonzero(np.isfinite(result["stretch_ratio"].values) & np.isfinite(place))
    names = [*(f"{where}_{name}" for where in ("crossover", "end") for name in SUMMARISED), "fibre_radius"]
    if not known.size:
        return dict.fromkeys(names, float("nan"))
    x, crossover, end = place[known], float(result["crossover_position"]), known[-1]
    found: dict[str, float] = {}
    for name in SUMMARISED:
        values = result[name].values
        found[f"crossover_{name}"] = (
            float(np.interp(crossover, x, values[known])) if np.isfinite(crossover) else float("nan")
        )
        found[f"end_{name}"] = float(values[end])
    found["fibre_radius"] = float(result["radius"].values[end] * np.sqrt(result["mean_polymer_fraction"].values[end]))
    return {name: found[name] for name in names}
