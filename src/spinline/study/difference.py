"""How far two results of one scene are from each other, in what a run reports.

Reported are: the crossover (Eq. 38 and by extension; radius and position, relative), the strands' stretch (relative), their
orientation (absolute: it passes 0) and the core's polymer fraction (relative). Profiles are compared over the first nine tenths
of the jet, at the places both have: at its end a network free to slip relaxes, however stiff its coupling, and no other rung
has that end.

A crossover that one result reaches and the other does not counts as an error of 1, unless the place is in the last tenth.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError

__all__ = ["REPORTED", "difference", "largest"]

REPORTED = (
    "crossover_radius",
    "crossover_position",
    "crossover_extension_radius",
    "crossover_extension_position",
    "axial_stretch",
    "orientation",
    "core_polymer_fraction",
)
_ABSOLUTE = ("orientation",)
_KEPT = 0.9  # of the jet's length


def difference(result: xr.Dataset, reference: xr.Dataset) -> dict[str, float]:
    """Error of a result against a reference, by reported quantity.

    Parameters
    ----------
    result, reference : xarray.Dataset
        From `spinline.run`, of one scene by two models; along the same jet.

    Returns
    -------
    dict of str to float
        Of `REPORTED`; >= 0. NaN in both counts as agreement.

    Raises
    ------
    InputError
        If they are along different jets.
    """
    along = "arc_length" if "element" in reference.dims else "z"
    if along not in result.variables or "time" in result.dims or "time" in reference.dims:
        raise InputError("result", "is not along the reference's jet, at one time", remedy="take one scene, one time")
    here, there = result[along].values, reference[along].values
    end = float(np.nanmax(there))
    if abs(float(np.nanmax(here)) - end) > 1e-6 * end:
        raise InputError(
            "result", "is of another length than the reference", value=float(np.nanmax(here)), allowed=f"{end:g} m"
        )
    kept = there <= _KEPT * end
    errors: dict[str, float] = {}
    for name in REPORTED:
        if name not in reference or name not in result:
            continue
        if reference[name].ndim == 0:
            errors[name] = _of_numbers(name, result, reference, _KEPT * end)
        else:
            errors[name] = _of_profiles(name, here, result, there[kept], reference[name].values[kept])
    return errors


def largest(errors: Mapping[str, float]) -> float:
    """The largest of the errors; 0 of none."""
    return max(errors.values(), default=0.0)


def _of_numbers(name: str, result: xr.Dataset, reference: xr.Dataset, end: float) -> float:
    value, exact = float(result[name]), float(reference[name])
    if np.isnan(value) and np.isnan(exact):
        return 0.0
    if np.isnan(value) or np.isnan(exact):
        stem = name.rsplit("_", 1)[0]
        place = np.nanmax([float(result[f"{stem}_position"]), float(reference[f"{stem}_position"])])
        return 0.0 if place > end else 1.0
    return abs(value - exact) / abs(exact) if exact else abs(value)


def _of_profiles(name: str, here: FloatArray, result: xr.Dataset, there: FloatArray, exact: FloatArray) -> float:
    """At the places both have, if those are half of the reference's; interpolated if not."""
    values = result[name].values
    known = np.isfinite(here) & np.isfinite(values)
    if not known.any():
        return 0.0 if not np.isfinite(exact).any() else 1.0
    x, y = here[known], values[known]
    near = np.clip(np.searchsorted(x, there), 1, max(x.size - 1, 1))
    near = np.where(np.abs(x[near - 1] - there) < np.abs(x[np.minimum(near, x.size - 1)] - there), near - 1, near)
    near = np.minimum(near, x.size - 1)
    same = np.abs(x[near] - there) <= 1e-9 * np.abs(there)
    value = np.interp(there, x, y)
    if 2 * same.sum() >= min(there.size, x.size):
        value, exact = y[near][same], exact[same]
    gap = np.abs(value - exact) if name in _ABSOLUTE else np.abs(value - exact) / np.abs(exact)
    return float(np.nanmax(gap, initial=0.0))
