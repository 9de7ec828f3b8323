"""From points along a line, and what belongs to them, to a jet: what VTK and LAMMPS files have in common."""

from collections.abc import Mapping

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.units import parse_unit
from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["jet_of_points", "length_scale"]

_RADIUS = {"radius": 1.0, "jet_radius": 1.0, "r": 1.0, "diameter": 0.5, "d": 0.5}
_AGREE = 0.01  # numbers of three digits, at points or at elements, round to less
_VOLUME = ("volume", "bead_volume")
_STRETCH = ("stretch_ratio", "stretch")
_VELOCITY = ("velocity", "v", "u")


def length_scale(unit: str | None, name: str, kind: str) -> float:
    """Metres in the unit of length that the user says; these formats carry none."""
    if unit is None:
        raise InputError(
            name, f"has no unit of length ({kind})", remedy='say it: jet.unit = "cm" in a scene, --unit cm of a command'
        )
    return parse_unit(unit, "length", "unit")[0]


def jet_of_points(
    points: FloatArray,
    data: Mapping[str, FloatArray],
    cells: Mapping[str, FloatArray],
    *,
    name: str,
    kind: str,
    scale: float,
    speed: float = float("nan"),
    initial_radius: float | None = None,
    time: float | None = None,
) -> LagrangianJet:
    """Jet from the beads of one line, in order from the nozzle.

    Parameters
    ----------
    points : ndarray, (bead, 3)
    data, cells : mapping
        What belongs to beads (bead,) and to elements (bead - 1,), by name; ``velocity`` (bead, 3) too.
    name, kind : str
        Of the file and its format, for messages.
    scale, speed : float
        SI in one unit of length, and of velocity.
    initial_radius : float, optional
        r_0, m.
    """
    if len(points) < 2:
        raise InputError(name, f"holds fewer than two beads ({kind})", value=len(points))
    if not np.isfinite(points).all():
        raise InputError(name, f"holds a bead whose place is not finite ({kind})", remedy="drop it")
    found = _of_elements(data, cells, name, kind, scale)
    if initial_radius is None:
        if "radius" not in found:
            raise InputError(
                "initial_radius", f"is needed: {name} has no radius ({kind})", remedy="give r_0 (jet.radius)"
            )
        initial_radius = float(found["radius"][0])
    velocity = next((data[key] for key in _VELOCITY if key in data and data[key].ndim == 2), None)
    moved = None if velocity is None or not np.isfinite(speed) else velocity * speed
    x, y, z = (points - points[0]).T * scale
    attributes = {"source": name.rpartition("/")[2], "format": kind} | ({} if time is None else {"time": time})
    return LagrangianJet.from_arrays(
        x, y, z, initial_radius=initial_radius, velocity=moved, attributes=attributes, **found
    )


def _of_elements(
    data: Mapping[str, FloatArray], cells: Mapping[str, FloatArray], name: str, kind: str, scale: float
) -> dict[str, FloatArray]:
    """Radius, volume or stretch of the elements; what stands at beads is the mean of an element's two ends."""
    told: list[tuple[str, FloatArray]] = []
    for where, table in (("cells", cells), ("points", data)):
        for given, values in table.items():
            key, values = given.lower(), np.asarray(values, dtype=np.float64)
            if values.ndim != 1:
                continue
            per_element = values if where == "cells" else 0.5 * (values[1:] + values[:-1])
            if key in _RADIUS:
                told.append((given, per_element * _RADIUS[key] * scale))
            elif key in _STRETCH and not told:
                return {"stretch_ratio": per_element}
            elif key in _VOLUME and where == "cells" and not told:
                return {"volume": per_element * scale**3}
    for given, other in told[1:]:
        if other.shape == told[0][1].shape and not np.allclose(
            other, told[0][1], rtol=_AGREE, atol=0.0, equal_nan=True
        ):
            problem = f"has two radii of the jet that are not the same ({kind}; a diameter is halved)"
            raise InputError(name, problem, value=f"{told[0][0]}, {given}", remedy="leave one of them out")
    if told:
        return {"radius": told[0][1]}
    problem, known = f"has no radius of the jet ({kind})", ", ".join([*_RADIUS, *_STRETCH])
    raise InputError(
        name,
        problem,
        value=sorted([*data, *cells]),
        allowed=known,
        remedy="write the radius as point data of that name",
    )
