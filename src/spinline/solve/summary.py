"""The structure in numbers: what the network is at the crossover, at the end of the jet, and the fibre it would make.

Of the fibre only the radius can be said without a model of the rest of the flight. Where the jet becomes solid it is
that of the polymer in the section that did, ``r_0 (phi_0/Lambda_f)^(1/2)``; otherwise that of the last cross-section,
``r (phi_mean)^(1/2)``, if nothing were stretched any more.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.named_arrays import NamedArrays

__all__ = ["FIBRE", "SOLID", "SUMMARISED", "structure_summary", "summarised"]

SUMMARISED = ("axial_stretch", "relative_extension", "orientation", "core_polymer_fraction", "network_radius")

FIBRE = ("fibre_radius", "fibre_diameter")
SOLID = ("frozen_radius", "arrest_fraction", "arrest_slip")


def structure_summary(result: NamedArrays) -> dict[str, Any]:
    """Numbers of a result: `SUMMARISED` with ``crossover_`` and ``end_`` before them, and ``fibre_radius``.

    Parameters
    ----------
    result : NamedArrays
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
    names = (*SUMMARISED, "stretch_ratio", "radius", "mean_polymer_fraction")
    solid = {name: float(result[name]) for name in SOLID if name in result}
    return summarised(place, {name: result[name].values for name in names}, float(result["crossover_position"]), solid)


def summarised(
    place: FloatArray, fields: Mapping[str, FloatArray], crossover: float, solid: Mapping[str, Any] | None = None
) -> dict[str, float]:
    """`structure_summary` of arrays along the jet, at one time; `crossover` is its position, m.

    `solid` may have the numbers of `SOLID`: radius and fraction where the jet becomes solid, and the strands' stretch
    over the jet's.
    """
    known = np.flatnonzero(np.isfinite(fields["stretch_ratio"]) & np.isfinite(place))
    found: dict[str, float] = {}
    if not known.size:
        names = [*(f"{where}_{name}" for where in ("crossover", "end") for name in SUMMARISED), *FIBRE]
        return dict.fromkeys(names, float("nan"))
    x, end = place[known], known[-1]
    for name in SUMMARISED:
        there = float(np.interp(crossover, x, fields[name][known])) if np.isfinite(crossover) else float("nan")
        found[f"crossover_{name}"] = there
    found |= {f"end_{name}": float(fields[name][end]) for name in SUMMARISED}
    radius = float(fields["radius"][end] * np.sqrt(fields["mean_polymer_fraction"][end]))
    if solid and np.isfinite(solid.get(SOLID[0], np.nan)):
        radius = float(solid[SOLID[0]] * np.sqrt(solid[SOLID[1]] / solid[SOLID[2]]))
    return found | {"fibre_radius": radius, "fibre_diameter": 2 * radius}
