"""Rows of a sweep by the array: which of them the stages can serve all at once, and where their numbers go.

Straight power-law and hyperbolic jets whose varied keys are numbers go through the stages with a leading axis
(`spinline.solve.many`), if their network is affine or of a rung that solves rows (`Rung.many`): where the scene names it, and
where "auto" is certain to take it, by a bound (`spinline.plan.bound`) or by the plan of many rows (`spinline.plan.many`).
Everything else, and every row near the edge of a range or beyond it, is left to `spinline.study.rows`, which also words the
reasons.

Cost: 2 us a scene for the numbers of an affine network, 30 us where the plan has to be made, 0.1 ms for a network that slips.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.network_models.registry import RUNGS, cheapest, simplest
from spinline.plan.bound import surely_simplest
from spinline.plan.choice import with_rung
from spinline.plan.many import slipping_rows
from spinline.rheology.solution import Solution
from spinline.scene.file import PowerLawJet, Scene
from spinline.scene.keys import reader
from spinline.scene.quantities import Read
from spinline.setup.batch import Batch, has_jets
from spinline.setup.build import build_solution
from spinline.solve.many import batch_numbers, batch_profiles, batch_targets
from spinline.solve.uncertainty import uncertain_inputs
from spinline.study.design import Column
from spinline.study.rows import (
    BEYOND,
    BOTH,
    CLOSED_FORMS,
    COMPILED,
    INCOMPLETE,
    OK,
    STD_FLAG,
    Block,
    Task,
    profile_grid,
)

__all__ = ["closed_forms", "why_not"]

_PLAIN = {  # keys that only move numbers, with what is far from every edge of the formulas
    "solution.mass_fraction": (1e-9, 1.0),
    "solution.volume_fraction": (1e-9, 1 - 1e-9),
    "solution.kuhn_length": (1e-11, 1e-6),
    "solution.temperature": (50.0, 1000.0),
    "solution.polymer_density": (1.0, 3e4),
    "solution.solvent_density": (1.0, 3e4),
    "solution.molar_mass": (1e-3, 1e6),
    "solution.viscosity": (1e-7, 1e15),
    "solution.solvent_viscosity": (1e-7, 1e15),
    "solution.relaxation_time": (0.0, 1e12),
    "jet.radius": (1e-12, 1e3),
    "jet.flow_rate": (1e-25, 1.0),
    "jet.length": (1e-12, 1e3),
    "jet.beta": (0.25, 1.0),
    "jet.k": (1e-9, 1e9),
    "jet.p": (1e-9, 1e9),
    "jet.electric_field": (1e-9, 1e10),
    "jet.conductivity": (1e-20, 1e8),
    "network.spring": (1e-9, 1e9),
    "network.coupling": (1e-9, 1e20),
    "network.crossover_extension": (1e-9, 1 - 1e-9),
    "accuracy.rtol": (1e-12, 0.999),
}


def why_not(scene: Scene, keys: tuple[str, ...]) -> str:
    """Why closed forms on arrays do not serve a sweep, in words; empty where they do."""
    named = RUNGS.get(scene.network.model)
    if named is not None and named is not simplest() and not named.many:
        return f'model "{named.name}" is not solved by the row'
    if not has_jets(scene):
        return f'profile "{scene.jet.profile}" is not a formula'
    if "force_law" in scene.network.model_fields_set and not (named is not None and named.many):
        return "a force law is named"
    if scene.network.model == "auto" and (scene.network.closure_used != "force" or "solution.temperature" in keys):
        return 'model "auto" chooses the rung scene by scene here'
    off = all(switch is False for _, switch in scene.effects)
    idle = scene.ambient is None and scene.solution.relaxation_time is None
    idle &= not any(switch is True for _, switch in scene.effects) and "solution.relaxation_time" not in keys
    if not (off or idle):
        return "relaxation or evaporation may matter"
    other = [key for key in keys if key not in _PLAIN]
    if other:
        return f"{other[0]} is more than a number"
    return ""


def closed_forms(task: Task, columns: Mapping[str, Column]) -> Block:
    """Rows that the closed forms serve; the status of the others stays 255.

    Parameters
    ----------
    task : Task
        Base scene and what to keep.
    columns : mapping
        Key to the values of every row; keys that hold words divide the rows into groups.

    Returns
    -------
    Block
    """
    block = Block.empty(task, len(next(iter(columns.values()))))
    for rows, values, words in _groups(columns):
        _group(task, block, rows, values, words)
    return block


def _groups(columns: Mapping[str, Column]) -> Iterator[tuple[Any, dict[str, FloatArray], dict[str, Any]]]:
    """Rows that share all their words: (rows, columns of numbers, words)."""
    numeric: dict[str, Any] = {key: values for key, values in columns.items() if values.dtype != object}
    worded = {key: values for key, values in columns.items() if values.dtype == object}
    if not worded:
        yield slice(None), numeric, {}
        return
    code = np.zeros(len(next(iter(columns.values()))), dtype=np.int64)
    for values in worded.values():
        seen: dict[str, int] = {}
        own = np.fromiter((seen.setdefault(repr(value), len(seen)) for value in values), np.int64, len(values))
        _, code = np.unique(code * len(seen) + own, return_inverse=True)
    for group in range(int(code.max()) + 1):
        rows = np.flatnonzero(code == group)
        yield rows, {key: v[rows] for key, v in numeric.items()}, {key: v[rows[0]] for key, v in worded.items()}


def _group(task: Task, block: Block, rows: Any, values: dict[str, FloatArray], words: dict[str, Any]) -> None:
    if any(key not in _PLAIN for key in values):
        return
    count = len(block.status[rows])
    good: BoolArray = np.ones(count, dtype=bool)
    for key, column in values.items():
        good &= _well_inside(key, column)
    if not good.any():
        return
    first = int(np.argmax(good))
    try:
        scene = task.scene({**words, **{key: float(column[first]) for key, column in values.items()}})
        if why_not(scene, tuple(values)) or (isinstance(scene.jet, PowerLawJet) and _no_estimate(scene, values)):
            return
        for key, sides in _sides(scene, task.uncertain).items():
            if key not in _PLAIN or not _well_inside(key, np.array(sides)).all():
                return
        solution = build_solution(scene)
    except InputError:
        return
    chosen = np.flatnonzero(good)
    _fill(
        task,
        block,
        np.arange(len(block.status))[rows][chosen],
        scene,
        solution,
        {key: column[chosen] for key, column in values.items()},
    )


def _no_estimate(scene: Scene, values: Mapping[str, FloatArray]) -> bool:
    """Whether k has to be estimated without a viscosity."""
    missing = scene.solution.viscosity is None and "solution.viscosity" not in values
    return getattr(scene.jet, "k", None) is None and "jet.k" not in values and missing


def _well_inside(key: str, column: FloatArray) -> BoolArray:
    low, high = _PLAIN[key]
    how = reader(key)
    good: BoolArray = (column >= low) & (column <= high)
    if isinstance(how, Read):
        good &= (column >= how.low) & (column <= how.high) if how.closed else (column > how.low) & (column < how.high)
    return good


def _fill(
    task: Task, block: Block, rows: NDArray[np.int64], scene: Scene, solution: Solution, values: dict[str, FloatArray]
) -> None:
    batch = Batch(scene, solution, values, rows.size)
    named = RUNGS.get(scene.network.model)
    if named is not None:
        _numbers(task, block, rows, batch, batch.usable)
        return
    targets = batch_targets(batch)
    simple = batch.usable & surely_simplest(batch, *targets)
    left = np.flatnonzero(batch.usable & ~simple)
    if left.size:
        slips, certain = slipping_rows(batch.taking(left), *(np.broadcast_to(t, rows.shape)[left] for t in targets))
        simple[left[certain & ~slips]] = True
        slipping, rung = left[certain & slips], cheapest(["elastic coupling"])
        if slipping.size and rung is not None and rung.many:
            part = batch.taking(slipping, with_rung(scene, rung))
            _numbers(task, block, rows[slipping], part, part.usable)
    _numbers(task, block, rows, batch, simple)


def _numbers(task: Task, block: Block, rows: NDArray[np.int64], batch: Batch, usable: BoolArray) -> None:
    """Numbers of the rows of a batch whose rung is known."""
    scene, values = batch.scene, batch.values
    found = batch_numbers(batch)
    usable = usable & np.isfinite(found["end_radius"])
    variance = {name: np.zeros(rows.size) for name in found} if task.uncertain else {}
    for key, sides in _sides(scene, task.uncertain).items():
        ends = []
        for value in sides:
            moved = Batch(scene, batch.solution, {**values, key: np.full(rows.size, value)}, rows.size)
            ends.append(batch_numbers(moved))
            usable = usable & moved.usable & np.isfinite(ends[-1]["end_radius"])
        for name in found:
            variance[name] += (0.5 * (ends[0][name] - ends[1][name])) ** 2
    chosen = rows[usable]
    for name, column in found.items():
        block.numbers[name][chosen] = column[usable]
    for name, column in variance.items():
        block.numbers[f"{name}_std"][chosen] = np.sqrt(column[usable])
    if variance:
        block.numbers[STD_FLAG][chosen] = 0.0
    for name, along in _along(task, batch).items():
        block.profiles[name][chosen] = along[usable]
    rung = RUNGS.get(scene.network.model)
    block.way[chosen] = COMPILED if rung is not None and rung.slips else CLOSED_FORMS
    late = [np.isnan(found[name][usable]) for name in BEYOND]
    block.status[chosen] = np.where(late[0] | late[1], INCOMPLETE, OK)
    block.reason[chosen] = np.select([late[0] & late[1], *late], [BOTH, *BEYOND.values()], "").astype(object)


def _sides(scene: Scene, keys: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """Every uncertain input, moved by its standard uncertainty to both sides."""
    inputs = uncertain_inputs(scene)
    return {key: (inputs[key].value + inputs[key].std, inputs[key].value - inputs[key].std) for key in keys}


def _along(task: Task, batch: Batch) -> dict[str, FloatArray]:
    """Profiles of the rows, (rows, points)."""
    if not task.profiles:
        return {}
    jets = batch.jets
    reduced = np.where(batch.usable, batch.length / jets.initial_radius, 1.0)
    s = profile_grid(reduced, np.broadcast_to(jets.scale, reduced.shape), task.points)
    z = np.reshape(jets.initial_radius, (-1, 1)) * s
    z[:, -1] = batch.length
    return batch_profiles(batch, task.profiles, z)
