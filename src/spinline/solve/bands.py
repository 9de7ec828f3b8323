"""Uncertain inputs through a run, by draws: bands of the profiles and of the numbers that need no straight line.

Inputs written with ``+/-`` are independent and normal; a draw that no scene can have (a negative radius, an exponent beyond
its range) is left out, so the normal law is cut there, and the share is said. Draws are scrambled Sobol' points: quantiles of
128 of them are as good as those of some thousand random ones where one or two inputs decide. The rung is that of the scene, in
every draw. Bands are quantiles at each place, not curves: no single draw need follow one.

A place that some draws do not reach (crossover, glass) lies beyond the end of the jet there: its quantiles count those draws,
and one that falls among them is NaN. Of other numbers that are not there in some draws (the state at that place) the quantiles
are those of the other draws, if they are half of all.
"""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.named_arrays import NamedArrays
from spinline.scene.file import Scene
from spinline.solve.uncertainty import moved, uncertain_inputs

if TYPE_CHECKING:
    from spinline.solve.solved import Solved

__all__ = ["BANDED", "LEVELS", "RATIOS", "banded", "draw_scenes", "quantiles"]

LEVELS = (0.025, 0.16, 0.5, 0.84, 0.975)
BANDED = (
    "radius",
    "network_radius",
    "network_radius_conservative",
    "relative_extension",
    "orientation",
    "radial_contraction",
    "stretch_ratio",
    "network_velocity_ratio",
    "strand_stretch",
    "axial_stretch",
    "core_polymer_fraction",
    "core_polymer_fraction_eq40",
    "core_polymer_fraction_conservative",
    "mean_polymer_fraction",
    "evaporated_fraction",
    "stress",
    "weissenberg_number",
    "surface_polymer_fraction",
    "axis_polymer_fraction",
)
RATIOS = ("viscosity", "relaxation_time")  # over what they are at the nozzle, as they are drawn
_FAR = 1e200
_LEFT_OUT = 0.01  # share of the draws that is worth a word


def banded(
    scene: Scene, result: NamedArrays, again: "Callable[[Scene], Solved]"
) -> tuple[dict[str, FloatArray], list[str]]:
    """Quantiles (`LEVELS`) of profiles and numbers over the uncertain inputs.

    Parameters
    ----------
    scene : Scene
        Its rung chosen; ``accuracy.draws`` and ``accuracy.seed`` say how many draws, and which.
    result : NamedArrays
        The run as it is: the places of the bands.
    again : callable
        Repeats the run for a scene.

    Returns
    -------
    bands : dict
        ``<name>_band`` to an array (5,) or (5, places), ``<name>_ratio_band`` for `RATIOS`; empty without draws.
    remarks : list of str
    """
    inputs = uncertain_inputs(scene)
    along = "arc_length" if "element" in result.dims else "z"
    if not inputs or not scene.accuracy.draws or "time" in result.dims:
        return {}, []
    place = result[along].values
    numbers = [str(name) for name, v in result.data_vars.items() if v.ndim == 0 and not str(name).endswith("_std")]
    rows: dict[str, list[Any]] = {}
    solvable = 0
    for drawn in draw_scenes(scene):
        try:
            solved = again(drawn)
        except InputError:
            continue
        solvable += 1
        for name, value in _taken(solved, along, place, numbers).items():
            rows.setdefault(name, []).append(value)
    kept, refused = solvable, scene.accuracy.draws - solvable
    if kept < 0.5 * scene.accuracy.draws or kept < 2:
        return {}, [f"no bands: {refused} of {scene.accuracy.draws} draws of the uncertain inputs make no scene"]
    remarks = []
    if refused > _LEFT_OUT * scene.accuracy.draws:
        remarks.append(
            f"{refused} of {scene.accuracy.draws} draws of the uncertain inputs make no scene and are not in the bands"
        )
    there = float(np.isfinite(rows["crossover_position"]).mean())
    if 0 < there < 1:
        remarks.append(f"the crossover is reached in {100 * there:.3g} % of the draws of the uncertain inputs only")
    return {f"{name}_band": _quantiles(name, np.array(found)) for name, found in rows.items()}, remarks


def draw_scenes(scene: Scene) -> Iterator[Scene]:
    """The scene with its uncertain inputs drawn, ``accuracy.draws`` times; fewer where inputs leave their ranges."""
    inputs = uncertain_inputs(scene)
    if not inputs or not scene.accuracy.draws:
        return
    for deviations in _normal(len(inputs), scene.accuracy.draws, scene.accuracy.seed):
        drawn = scene
        try:
            for (key, measured), deviation in zip(inputs.items(), deviations, strict=True):
                drawn = moved(drawn, key, measured.value + deviation * measured.std)
        except InputError:
            continue
        yield drawn


def _quantiles(name: str, values: FloatArray) -> FloatArray:
    """`quantiles`; a place that is not reached lies beyond the end, farther than all that are."""
    if not name.endswith("_position") or not np.isfinite(values).any():
        return quantiles(values)
    found = quantiles(np.where(np.isfinite(values), values, _FAR))
    return np.where(found > 0.01 * _FAR, np.nan, found)


def quantiles(values: FloatArray) -> FloatArray:
    """`LEVELS` over the first axis, of what is a number; NaN where less than half of the draws are.

    Parameters
    ----------
    values : ndarray, (draws, ...)

    Returns
    -------
    ndarray, (5, ...)
    """
    known = np.isfinite(values)
    if known.all():
        whole: FloatArray = np.quantile(values, LEVELS, axis=0)
        return whole
    flat, mask = values.reshape(len(values), -1), known.reshape(len(values), -1)
    found = np.full((len(LEVELS), flat.shape[1]), np.nan)
    for j in np.flatnonzero(mask.mean(axis=0) >= 0.5):
        found[:, j] = np.quantile(flat[mask[:, j], j], LEVELS)
    return found.reshape(len(LEVELS), *values.shape[1:])


def _normal(inputs: int, draws: int, seed: int) -> FloatArray:
    """Scrambled Sobol' points of the standard normal, (draws, inputs)."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    sampler = qmc.Sobol(inputs, seed=np.random.default_rng(seed))
    points: FloatArray = ndtri(sampler.random_base2(int(np.ceil(np.log2(max(draws, 2)))))[:draws])
    return points


def _taken(solved: "Solved", along: str, place: FloatArray, numbers: list[str]) -> dict[str, Any]:
    """Numbers of a draw, and its profiles at the places of the run, linear between its own."""
    from spinline.solve.summary import summarised

    fields, here = solved.fields, np.asarray(solved.fields[along])
    kept: dict[str, Any] = {name: np.asarray(fields[name], dtype=float) for name in BANDED if name in fields}
    for name in RATIOS:
        if name in fields:
            kept[f"{name}_ratio"] = np.asarray(fields[name]) / np.asarray(fields[name])[0]
    if here.shape != place.shape or not np.array_equal(here, place):
        known = np.isfinite(here)
        kept = {name: _at(place, here[known], values[known]) for name, values in kept.items()}
    scalars = solved.scalars | summarised(here, fields, float(solved.scalars["crossover_position"]), solved.scalars)
    return kept | {name: float(scalars[name]) for name in numbers if name in scalars}


def _at(place: FloatArray, here: FloatArray, values: FloatArray) -> FloatArray:
    """Values at other places, NaN beyond the jet."""
    beyond = place > here[-1] * (1 + 1e-12)
    found: FloatArray = np.where(beyond, np.nan, np.interp(place, here, values))
    return found
