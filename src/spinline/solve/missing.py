"""Why a number of a result is missing, and what sampling leaves of one: nothing is NaN, or beyond its range, without a word."""

import re
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from spinline.base.named_arrays import NamedArrays

__all__ = ["explain"]

_BANDS_OF = {"relative_extension": (0.0, 1.0), "radial_contraction": (0.0, 1.0), "orientation": (-0.5, 1.0)}
_REASONS = (
    (r"crossover_extension.*", "the extension does not pass the criterion within this jet"),
    (r"crossover.*", "full stretch is not reached within this jet"),
    (r"(frozen|skin|core)_(position|time|radius|stretch|extension|orientation|relaxed)", "not glass in this jet"),
    (r"arrest_.*", "the jet does not become solid within its length"),
    (r"crystallinity", "crystallisation is not followed in time: it is at equilibrium, or not considered"),
    (r"bending_start", "bending waves cannot travel anywhere on the straight part"),
    (r"bending_onset.*", "bending waves have not grown so far within the gap"),
    (r"vitrification_fraction", "the polymer does not turn to glass at this temperature"),
    (r"strand_force", "the contour is reached: the force of an ideal strand has no bound there"),
    (r"stress|radial_stress|tensile_force", "glass there: the stress of a liquid says nothing"),
    (
        r"viscosity|relaxation_time|weissenberg_number",
        "glass there, or beyond what the concentration law was measured for",
    ),
)


def explain(result: "NamedArrays", *, sampled: bool = False) -> list[str]:
    """Give every variable with NaN the attribute ``missing``, and say what has none, or lies beyond its range by sampling.

    Parameters
    ----------
    result : NamedArrays
        Changed in place.
    sampled : bool
        Whether strands were sampled.

    Returns
    -------
    list of str
        Remarks.
    """
    remarks = []
    beads = "element" in result.dims
    for name, variable in result.variables.items():
        if variable.dtype.kind != "f":
            continue
        gone = np.isnan(variable.values)
        if gone.any():
            reason = _reason(name, beads)
            variable.attrs["missing"] = reason or "not known"
            if not reason:
                remarks.append(f"{name} is not a number at {int(gone.sum())} of {gone.size} places")
        if sampled and name in _BANDS_OF:
            remarks += _noise(result, name)
    return remarks


def _reason(name: str, beads: bool) -> str:
    plain = re.sub(r"_(band|std)$", "", name)
    for pattern, words in _REASONS:
        if re.fullmatch(pattern, plain) or re.fullmatch(pattern, plain.removesuffix("_ratio")):
            return words
    if plain != name:
        return "the number itself, or that of a draw, does not exist"
    return "no jet there at this time, or its material has no history" if beads else ""


def _noise(result: "NamedArrays", name: str) -> list[str]:
    low, high = _BANDS_OF[name]
    values = result[name].values
    beyond = np.fmax(low - values, values - high)
    worst = float(np.nanmax(beyond, initial=0.0))
    if worst <= 0:
        return []
    error = f"{name}_std_error"
    said = ""
    if error in result:
        at = int(np.nanargmax(beyond))
        said = f", where its standard error is {float(result[error].values.ravel()[at]):.2g}"
    return [
        f"sampled: {name} lies up to {worst:.2g} outside [{low:g}, {high:g}]{said}; take more strands (accuracy.strands)"
    ]
