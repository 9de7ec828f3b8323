"""Affine scenes by the array: the closed forms of `network` on whole columns, no scene object a row.

Rows of straight power-law and hyperbolic jets with the affine network, whose varied keys are numbers, are computed here:
where the scene names it, and where "auto" is certain to take it (`spinline.plan.choice`, by a bound on its estimate).
Everything else, and every row near the edge of a range or beyond it, is left to `sweep_rows`, which also words the reasons.
Results are those of ``spinline run`` to 1e-12: the same formulas in the same order, on arrays.

Cost: about 2 us a scene for the numbers alone.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile import hyperbolic, power_law
from spinline.jetprofile.k_estimate import estimate_k
from spinline.network.concentration import compaction_velocity_ratio
from spinline.network.coupling import elastic_coupling, strand_force
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network.mesh import network_at_rest, rest_force
from spinline.network.state import NetworkState, network_state
from spinline.plan.choice import MARGIN
from spinline.rheology.solution import Solution
from spinline.rheology.solution import volume_fraction as fraction_by_volume
from spinline.scene.file import HyperbolicJet, PowerLawJet, Scene, SolventData
from spinline.scene.keys import reader
from spinline.scene.quantities import Read
from spinline.setup.build import build_solution
from spinline.setup.coupling import drag_of_solvent
from spinline.solve.uncertainty import uncertain_inputs
from spinline.study.densities import densities
from spinline.study.design import Column
from spinline.study.rows import AT_CROSSOVER, AT_END, BEYOND, BOTH, INCOMPLETE, OK, STD_FLAG, Block, Task, profile_grid

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
_MOST_STRETCH = 1e100
_MOST_SLIP = 0.05
_NEAR_REST = 1.5  # V of a crossover, below which its place is too sensitive for the bound


def why_not(scene: Scene, keys: tuple[str, ...]) -> str:
    """Why closed forms on arrays do not serve a sweep, in words; empty where they do."""
    if scene.network.model not in ("auto", "affine"):
        return f'model "{scene.network.model}" has no closed form'
    if not isinstance(scene.jet, PowerLawJet | HyperbolicJet):
        return f'profile "{scene.jet.profile}" is not a formula'
    if "force_law" in scene.network.model_fields_set:
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
        if why_not(scene, tuple(values)):
            return
        for key, sides in _sides(scene, task.uncertain).items():
            if key not in _PLAIN or not _well_inside(key, np.array(sides)).all():
                return
        solution = build_solution(scene)
    except InputError:
        return
    chosen = np.flatnonzero(good)
    _fill(task, block, np.arange(len(block.status))[rows][chosen], scene, solution,
          {key: column[chosen] for key, column in values.items()})  # fmt: skip


def _well_inside(key: str, column: FloatArray) -> BoolArray:
    low, high = _PLAIN[key]
    how = reader(key)
    good: BoolArray = (column >= low) & (column <= high)
    if isinstance(how, Read):
        good &= (column >= how.low) & (column <= how.high) if how.closed else (column > how.low) & (column < how.high)
    return good


class _Jets:
    """Jets of a group, one a row: V(s) and its inverse, s in initial radii; arrays (rows,) or (rows, points)."""

    def __init__(self, scene: Scene, viscosity: Any, of: Any) -> None:
        self.radius, self.flow_rate, self.length = of("jet.radius"), of("jet.flow_rate"), of("jet.length")
        self.velocity = self.flow_rate / (np.pi * self.radius**2)
        self._law: Any
        self._parameters: tuple[Any, ...]
        if isinstance(scene.jet, PowerLawJet):
            k, beta = of("jet.k"), of("jet.beta")
            if k is None:
                k = estimate_k(radius=self.radius, flow_rate=self.flow_rate, conductivity=of("jet.conductivity"),
                               viscosity=viscosity, electric_field=of("jet.electric_field"))  # fmt: skip
            onset = k ** (-1 / beta)
            self._law, self._parameters = power_law, (onset, beta)
            self.scale = np.minimum(onset, 1.0)
            self.usable = (k > 1e-9) & (k < 1e9)
        else:
            self._law, self._parameters = hyperbolic, (of("jet.p"),)
            self.scale = np.asarray(1.0)
            self.usable = np.asarray(True)

    def steepest(self) -> FloatArray:
        """Largest dV/ds along the jet: the slope of both laws is largest at an end of where they thin."""
        at_end = self.call("slope", np.atleast_1d(self.length / self.radius))
        if self._law is hyperbolic:
            return at_end
        onset = np.atleast_1d(self._parameters[0])
        return np.where(onset <= self.length / self.radius, np.maximum(at_end, self.call("slope", onset)), 0.0)

    def call(self, name: str, x: FloatArray) -> FloatArray:
        """``ratio``, ``slope``, ``time`` or ``inverse`` of the law."""
        parameters = self._parameters
        if x.ndim == 2:
            parameters = tuple(np.reshape(p, (-1, 1)) for p in parameters)
        value: FloatArray = getattr(self._law, name)(x, *parameters)
        return value


def _fill(
    task: Task, block: Block, rows: NDArray[np.int64], scene: Scene, solution: Solution, values: dict[str, FloatArray]
) -> None:
    columns = _Columns(scene, values)
    if isinstance(scene.jet, PowerLawJet) and scene.jet.k is None and columns("solution.viscosity") is None:
        return
    found, usable, jets, targets = _numbers(scene, solution, columns, rows.size)
    phi = found["volume_fraction"]
    if scene.network.model == "auto":
        usable = usable & _surely_affine(scene, solution, jets, phi, targets, columns)
    variance = {name: np.zeros(rows.size) for name in found} if task.uncertain else {}
    for key, sides in _sides(scene, task.uncertain).items():
        ends = []
        for value in sides:
            end, good, *_ = _numbers(
                scene, solution, _Columns(scene, {**values, key: np.full(rows.size, value)}), rows.size
            )
            usable = usable & good
            ends.append(end)
        for name in found:
            variance[name] += (0.5 * (ends[0][name] - ends[1][name])) ** 2
    chosen = rows[usable]
    for name, column in found.items():
        block.numbers[name][chosen] = np.broadcast_to(column, rows.shape)[usable]
    for name, column in variance.items():
        block.numbers[f"{name}_std"][chosen] = np.sqrt(column[usable])
    if variance:
        block.numbers[STD_FLAG][chosen] = 0.0
    for name, along in _along(task, jets, phi, usable, scene, columns).items():
        block.profiles[name][chosen] = along
    late = [np.isnan(np.broadcast_to(found[name], rows.shape)[usable]) for name in BEYOND]
    block.status[chosen] = np.where(late[0] | late[1], INCOMPLETE, OK)
    block.reason[chosen] = np.select([late[0] & late[1], *late], [BOTH, *BEYOND.values()], "").astype(object)


class _Columns:
    """Values of a key in every row: the column where it varies, the scene's own elsewhere, None where it has none."""

    def __init__(self, scene: Scene, values: dict[str, FloatArray]) -> None:
        self.scene, self.values = scene, values

    def __call__(self, key: str) -> Any:
        if key in self.values:
            return self.values[key]
        section, _, name = key.partition(".")
        measured = getattr(getattr(self.scene, section), name)
        return None if measured is None else np.asarray(getattr(measured, "value", measured))


def _sides(scene: Scene, keys: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """Every uncertain input, moved by its standard uncertainty to both sides."""
    inputs = uncertain_inputs(scene)
    return {key: (inputs[key].value + inputs[key].std, inputs[key].value - inputs[key].std) for key in keys}


def _numbers(
    scene: Scene, solution: Solution, of: _Columns, rows: int
) -> tuple[dict[str, FloatArray], BoolArray, _Jets, tuple[FloatArray, FloatArray]]:
    """Numbers of the rows, which of them can be used, the jets, and V of both criteria."""
    quality, closure = scene.network.solvent_quality, scene.network.closure_used
    phi = _volume_fraction(scene, solution, of.values, of)
    jets = _Jets(scene, of("solution.viscosity"), of)
    reduced = jets.length / jets.radius
    stretch = jets.call("ratio", np.atleast_1d(reduced))
    usable = (phi > 1e-9) & (phi < 1 - 1e-9) & jets.usable & (stretch < _MOST_STRETCH) & np.isfinite(stretch)
    usable = np.broadcast_to(usable, (rows,))
    phi = np.where(usable, phi, 0.5)
    stretch = np.where(usable, np.broadcast_to(stretch, (rows,)), 1.0)
    full = crossover_velocity_ratio(phi, quality)
    target = extension_velocity_ratio(of("network.crossover_extension"), phi, closure=closure, solvent_quality=quality)
    found: dict[str, FloatArray] = {"volume_fraction": phi}
    found |= _crossover("crossover", full, jets)
    found |= _crossover("crossover_extension", np.broadcast_to(target, (rows,)), jets)
    place = found["crossover_position"]
    reached = np.isfinite(place)
    there = np.where(reached, jets.call("ratio", np.where(reached, place, 0.0) / jets.radius), 1.0)
    state = _state(there, phi, scene)
    state["network_radius"] = jets.radius / np.sqrt(there) * state["network_radius_ratio"]
    found |= {f"crossover_{name}": np.where(reached, state[name], np.nan) for name in AT_CROSSOVER}
    radius = jets.radius / np.sqrt(stretch)
    state = _state(stretch, phi, scene)
    state |= {"radius": radius, "velocity_ratio": stretch, "network_radius": radius * state["network_radius_ratio"]}
    found |= {f"end_{name}": state[name] for name in AT_END}
    found["fibre_radius"] = radius * np.sqrt(state["mean_polymer_fraction"])
    found["fibre_diameter"] = 2 * found["fibre_radius"]
    return {name: np.broadcast_to(column, (rows,)) for name, column in found.items()}, usable, jets, (full, target)


def _surely_affine(
    scene: Scene, solution: Solution, jets: _Jets, phi: FloatArray, targets: tuple[FloatArray, FloatArray], of: Any
) -> BoolArray:
    """Rows for which `spinline.plan.choice` takes the affine rung, by a bound on its estimate of the elastic slip.

    With ``d = eps V'`` at its largest the stretch changes by ``1.1 d`` at most, the core's fraction by ``2 f`` times that with
    f up to that of compaction, the orientation by 1.3 times, the place of a crossover by ``1/(2 beta)`` times. A crossover near
    the end of what the plan looks at, 0.9 of the jet, could come or go: such rows are left to the plan itself.
    """
    quality, network = scene.network.solvent_quality, scene.network
    alpha = of("network.coupling")
    if alpha is None:
        try:
            drag = network.drag_viscosity
            if drag == "solution":
                mu = of("solution.viscosity")
            else:
                given = of("solution.solvent_viscosity") if drag == "solvent" else np.asarray(drag.value)
                mu = drag_of_solvent(scene, solution, "alpha_v")[0] if given is None else given
            if mu is None:
                return np.zeros(phi.shape, dtype=bool)
        except InputError:
            return np.zeros(phi.shape, dtype=bool)
        xi = network_at_rest(phi, quality).size * of("solution.kuhn_length")
        alpha = elastic_coupling(xi, jets.velocity, mu, jets.radius, of("solution.temperature"))
    slip = of("network.spring") / alpha * jets.steepest()
    compact = compaction_velocity_ratio(phi, quality) * rest_force(phi, quality)[0]
    sure = (slip < _MOST_SLIP) & (MARGIN * (3.5 * compact + 5) * slip < of("accuracy.rtol"))
    end = jets.call("ratio", np.atleast_1d(0.9 * jets.length / jets.radius))
    for target in targets:
        v = np.maximum(target, 1e-300)
        sure = sure & (v > _NEAR_REST) & (np.abs(np.log(v / end)) > 3 * slip + 1e-6)
    return np.broadcast_to(sure, phi.shape)


def _volume_fraction(scene: Scene, solution: Solution, values: Mapping[str, FloatArray], of: Any) -> FloatArray:
    if scene.solution.mass_fraction is None:
        return np.asarray(of("solution.volume_fraction"))
    polymer = of("solution.polymer_density")
    solvent = of("solution.solvent_density")
    polymer = solution.polymer.density if polymer is None else polymer
    if solvent is None:
        solvent = np.asarray(solution.solvent_density)
        if "solution.temperature" in values and not isinstance(scene.solution.solvent, SolventData):
            solvent = densities(solution.solvent, values["solution.temperature"])
    known = np.isfinite(solvent)
    phi = fraction_by_volume(of("solution.mass_fraction"), polymer, np.where(known, solvent, 1.0))
    return np.where(known, phi, np.nan)


def _crossover(name: str, target: FloatArray, jets: _Jets) -> dict[str, FloatArray]:
    """`spinline.solve.spine.crossover` for every row."""
    place = np.where(target > 0, jets.radius * jets.call("inverse", np.maximum(target, 1.0)), np.nan)  # at rest: 0
    reached = place <= jets.length * (1 + 1e-12)
    place = np.where(reached, place, np.nan)
    radius = jets.radius / np.sqrt(jets.call("ratio", place / jets.radius))
    radius = np.where(reached, radius, np.nan)
    return {
        f"{name}_position": place,
        f"{name}_radius": radius,
        f"{name}_radius_ratio": radius / jets.radius,
        f"{name}_velocity_ratio": target,
    }


def _state(stretch: FloatArray, phi: FloatArray, scene: Scene) -> dict[str, FloatArray]:
    net: NetworkState = network_state(
        stretch, stretch, phi, closure=scene.network.closure_used, solvent_quality=scene.network.solvent_quality
    )
    walk = net.conformation
    return {
        "mean_polymer_fraction": net.mean_polymer_fraction,
        "network_velocity_ratio": net.network_velocity_ratio,
        "axial_stretch": walk.axial_stretch,
        "relative_extension": walk.relative_extension,
        "radial_contraction": walk.radial_contraction,
        "orientation": walk.orientation,
        "network_radius_ratio": net.network_radius_ratio,
        "network_radius_ratio_conservative": net.network_radius_ratio_conservative,
        "core_polymer_fraction": net.core_polymer_fraction,
        "core_polymer_fraction_eq40": net.core_polymer_fraction_eq40,
        "core_polymer_fraction_conservative": net.core_polymer_fraction_conservative,
        "force": walk.force,
    }


def _along(task: Task, jets: _Jets, phi: FloatArray, usable: BoolArray, scene: Scene, of: Any) -> dict[str, FloatArray]:
    """Profiles of the usable rows, (rows, points)."""
    if not task.profiles:
        return {}

    def tall(x: Any) -> FloatArray:
        return np.broadcast_to(x, usable.shape)[usable, np.newaxis]

    r0, v0 = tall(jets.radius), tall(jets.velocity)
    span, scale = np.broadcast_arrays(jets.length / jets.radius, jets.scale)
    s = np.broadcast_to(profile_grid(span, scale, task.points), (usable.size, task.points))
    ratio = jets.call("ratio", s)[usable]
    state = _state(ratio, tall(phi), scene)
    radius = r0 / np.sqrt(ratio)
    fields = state | {
        "z": r0 * s[usable],
        "radius": radius,
        "velocity": v0 * ratio,
        "velocity_ratio": ratio,
        "stretch_ratio": ratio,
        "network_radius": radius * state["network_radius_ratio"],
        "network_radius_conservative": radius * state["network_radius_ratio_conservative"],
    }
    if "strain_rate" in task.profiles:
        fields["strain_rate"] = v0 / r0 * jets.call("slope", s)[usable]
    if "residence_time" in task.profiles:
        fields["residence_time"] = r0 / v0 * jets.call("time", s)[usable]
    if "strand_force" in task.profiles:
        fields["strand_force"] = strand_force(
            state["force"], tall(of("solution.kuhn_length")), tall(of("solution.temperature"))
        )
    return {name: fields[name] for name in task.profiles}
