"""From a scene to a result: solution, jet on a grid, network along it, crossover, one Dataset.

Data goes one way. What a scene needs is built by `build_solution` and `build_jet`; `examine` says what is odd about them
before anything runs; `run` puts the closed forms along the jet and names everything as the design does.
"""

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile.straight import StraightJet
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network_models.rungs import (
    BOND_STRENGTH,
    Crossover,
    SettledChain,
    lateral_fields,
    network_fields,
    settled_chain,
    slip_fields,
    slipping_crossover,
    steady_state,
    walk_fields,
)
from spinline.plan.choice import plan_scene, resolved
from spinline.plan.effects import choose_effects
from spinline.plan.remarks import SLIPPING, examine
from spinline.scene.file import Scene
from spinline.setup.build import bead_ages, build_jet, build_solution, jet_grid, jet_length
from spinline.solve.attributes import attributes_of, elsewhere

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.network.manifold import Manifold
    from spinline.solve.effects_along import Extra

__all__ = ["Crossover", "Solved", "build_jet", "build_solution", "crossover", "evaluate", "examine", "run"]


def crossover(scene: Scene, jet: "StraightJet | LagrangianJet", velocity_ratio: float) -> Crossover:
    """First place along the jet where V passes a value."""
    if not isinstance(jet, StraightJet) and jet.time is not None:
        raise InputError("jet.time", "holds many times", remedy="take one")
    predicted = float(jet.position_of(velocity_ratio)) if velocity_ratio > 0 else float("nan")
    if 0 < velocity_ratio <= 1:  # so at rest
        predicted = jet.start if isinstance(jet, StraightJet) else 0.0
    end = jet_length(scene, jet) if isinstance(jet, StraightJet) else float("inf")
    if not predicted <= end * (1 + 1e-12):
        nan = float("nan")
        return Crossover(velocity_ratio, nan, nan, nan, predicted)
    place = min(predicted, jet.end) if isinstance(jet, StraightJet) else predicted
    radius = float(jet.radius(place))
    return Crossover(velocity_ratio, predicted, radius, radius / jet.initial_radius, predicted)


def run(scene: Scene) -> "xr.Dataset":
    """Jet, network, concentration and crossover of a scene.

    Parameters
    ----------
    scene : Scene
        From `load_scene`.

    Returns
    -------
    xarray.Dataset
        Along `z`, or along `element` (and `time`) for bead jets; names, units and attributes as documented.

    Raises
    ------
    InputError
        For a scene that cannot be computed.

    Warns
    -----
    SpinlineWarning
        One for each remark of `examine`; they are in the attribute ``warnings`` too.

    Notes
    -----
    Closed forms: about 1 ms for 401 points. Errors against Eqs. (36)-(40) are of rounding; those of the affine model
    itself are estimated in the attribute ``model_reason``.
    """
    from spinline.solve import results
    from spinline.solve.bands import banded
    from spinline.solve.uncertainty import propagated, uncertain_inputs

    result, taken = _solved(scene)
    remarks = str(result.attrs["warnings"]).splitlines()
    uncertain = uncertain_inputs(scene)
    if uncertain and taken.network.model in SAMPLED:
        remarks.append(f'uncertain inputs are not followed through model = "{taken.network.model}": take another')
    elif uncertain:
        numbers, said = propagated(taken, result, lambda moved: _solved(moved)[0])
        bands, more = banded(taken, result, lambda drawn: evaluate(drawn, attributes=False))
        said += more
        result = results.with_bands(results.with_numbers(result, numbers), bands)
        if bands:
            result.attrs["bands"] = f"68 and 95 % of {taken.accuracy.draws} draws of the uncertain inputs"
        result.attrs["uncertain_inputs"] = ", ".join(f"{key} = {value.text}" for key, value in uncertain.items())
        remarks += said
    result.attrs["warnings"] = "\n".join(remarks)
    for remark in remarks:
        warnings.warn(remark, SpinlineWarning, stacklevel=2)
    return result


SAMPLED = ("chain", "walk")  # rungs that are too slow, or too noisy, to run for every uncertain input


def _solved(scene: Scene) -> "tuple[xr.Dataset, Scene]":
    """Result of a scene, its remarks in its attribute, and the scene with the rung and the effects that were taken."""
    from spinline.solve import results
    from spinline.solve.summary import structure_summary

    solved = evaluate(scene)
    result = results.assemble(solved.fields, solved.scalars, solved.attributes, solved.jet)
    return results.with_numbers(result, structure_summary(result)), solved.scene


class Solved(NamedTuple):
    """What `run` puts into a Dataset, as plain arrays.

    Attributes
    ----------
    fields : dict of str to ndarray
        Variables along the jet.
    scalars : dict of str to float
        Numbers (arrays along time for a bead jet of many times).
    attributes : dict
        Models, reasons, inputs.
    remarks : list of str
        What is odd about the scene.
    jet : StraightJet or LagrangianJet
    scene : Scene
        With the rung and the effects that were taken.
    """

    fields: dict[str, FloatArray]
    scalars: dict[str, Any]
    attributes: dict[str, Any]
    remarks: list[str]
    jet: "StraightJet | LagrangianJet"
    scene: Scene


def evaluate(scene: Scene, jet: "StraightJet | LagrangianJet | None" = None, *, attributes: bool = True) -> Solved:
    """`run` without Dataset and warnings, for many scenes in a row: half the cost for closed forms.

    Parameters
    ----------
    scene : Scene
        From `load_scene`.
    jet : StraightJet or LagrangianJet, optional
        Its jet, where it has been built before: saves reading files.
    attributes : bool
        False leaves the attributes empty, and the plan unmade where the scene names its model.

    Returns
    -------
    Solved

    Raises
    ------
    InputError
        For a scene that cannot be computed.
    """
    solution = build_solution(scene)
    jet = build_jet(scene, solution) if jet is None else jet
    plan = plan_scene(scene, solution, jet) if attributes or scene.network.model == "auto" else None
    scene = scene if plan is None else resolved(scene, plan)
    effects = choose_effects(scene, solution, jet, None if plan is None else plan.numbers)
    remarks = examine(scene, solution, jet, effects, plan)
    phi, quality = solution.volume_fraction, scene.network.solvent_quality
    targets = {
        "crossover": float(crossover_velocity_ratio(phi, quality)),
        "crossover_extension": float(
            extension_velocity_ratio(
                scene.network.crossover_extension.value,
                phi,
                closure=scene.network.closure_used,
                solvent_quality=quality,
            )
        ),
    }
    frames = _frames(jet)
    found = {name: [crossover(scene, frame, target) for frame in frames] for name, target in targets.items()}
    network: Manifold | SettledChain | None = None
    if scene.network.model in SLIPPING and isinstance(jet, StraightJet):
        solve = steady_state if scene.network.model == "manifold" else settled_chain
        try:
            network = solve(scene, solution, jet)
        except InputError as error:
            if plan is None or plan.forced:
                raise
            remedy = f"{error.remedy}; or" if error.remedy else "take"
            raise InputError(error.field, f"{error.problem} (the rung that rtol = {plan.rtol:g} needs)", value=error.value,
                             allowed=error.allowed, remedy=f'{remedy} model = "affine"') from None  # fmt: skip
        if isinstance(network, SettledChain) and network.drift > scene.accuracy.rtol:
            remarks.append(
                f"the chain has not settled: its stretch still changed by {network.drift:.2g} over the last tenth of "
                "the run (no steady state, or a longer time is needed)"
            )
        found["crossover_extension"] = [slipping_crossover(network, jet, targets["crossover_extension"])]
    if isinstance(jet, StraightJet):
        profile = _straight_profile(scene, jet, [c[0].position for c in found.values()])
    else:
        profile = _bead_profile(jet)
    extra: Extra | None = None
    if effects.any:
        from spinline.solve.effects_along import follow_frames

        extra = follow_frames(scene, solution, jet, frames, effects, profile, network, found)
        profile |= extra.profile
        remarks += extra.remarks
    fields = profile | network_fields(profile, scene, solution, network, extra)
    if network is not None and isinstance(jet, StraightJet):
        fields |= slip_fields(fields, network, scene, solution, jet)
    if scene.network.lateral:
        if not isinstance(jet, StraightJet):
            raise InputError("network.lateral", "needs a straight jet", value=True, remedy="leave it out")
        fields |= lateral_fields(fields, scene, solution, jet)
    if scene.network.model == "walk":
        fields |= walk_fields(fields, scene, solution)
    scalars: dict[str, Any] = {"volume_fraction": phi}
    if extra is not None:
        fields |= extra.across(fields["radial_contraction"])
        scalars |= extra.scalars
    forces = fields["strand_force"]
    if np.nanmax(forces, initial=0.0) > BOND_STRENGTH:
        remarks.append(
            f"the strand force reaches {np.nanmax(forces):.2g} N, more than a covalent bond holds ({BOND_STRENGTH:g} N): "
            "chains break or slip before"
        )
    for name, places in found.items():
        if len(places) == 1 and np.isnan(places[0].position):
            remarks.append(f"{name.replace('_', ' by ')} is not reached: {elsewhere(places[0])}")
    scalars |= _crossover_scalars(found, single=not _has_times(jet))
    described: dict[str, Any] = {}
    if attributes and plan is not None:
        described = attributes_of(scene, solution, jet, found, remarks, network, effects, plan)
        described |= {} if extra is None else extra.attributes
    switches = {"evaporation": effects.evaporation, "relaxation": effects.relaxation, "radial": effects.radial}
    taken = scene.model_copy(update={"effects": scene.effects.model_copy(update=switches)})
    return Solved(fields, scalars, described, remarks, jet, taken)


def _has_times(jet: "StraightJet | LagrangianJet") -> bool:
    return not isinstance(jet, StraightJet) and jet.time is not None


def _frames(jet: "StraightJet | LagrangianJet") -> "list[StraightJet | LagrangianJet]":
    if isinstance(jet, StraightJet) or jet.time is None:
        return [jet]
    return [jet.at(float(t)) for t in jet.time]


def _straight_profile(scene: Scene, jet: StraightJet, special: list[float]) -> dict[str, FloatArray]:
    """Jet variables on a grid that is fine at the nozzle and holds the special places exactly."""
    length = jet_length(scene, jet)
    extra = [place for place in special if jet.start <= place <= length]
    z = np.unique(np.concatenate((jet_grid(jet, length, scene.accuracy.points), extra)))
    return {
        "z": z,
        "radius": jet.radius(z),
        "velocity": jet.velocity(z),
        "velocity_ratio": jet.velocity_ratio(z),
        "strain_rate": jet.strain_rate(z),
        "residence_time": jet.residence_time(z),
        "stretch_ratio": jet.stretch_ratio(z),
    }


def _bead_profile(jet: "LagrangianJet") -> dict[str, FloatArray]:
    between = 0.5 * (jet.bead_velocity[..., 1:] + jet.bead_velocity[..., :-1])
    return {
        "arc_length": jet.arc_length,
        "radius": jet.element_radius,
        "velocity": between,
        "velocity_ratio": jet.stretch,
        "strain_rate": jet.element_strain_rate,
        "residence_time": bead_ages(jet)[0],
        "stretch_ratio": jet.stretch,
        "x": jet.x,
        "y": jet.y,
        "z": jet.z,
    }


def _crossover_scalars(found: dict[str, list[Crossover]], *, single: bool) -> dict[str, Any]:
    scalars: dict[str, Any] = {}
    for name, places in found.items():
        for quantity in ("position", "radius", "radius_ratio", "velocity_ratio"):
            values = [getattr(place, quantity) for place in places]
            scalars[f"{name}_{quantity}"] = values[0] if single else np.array(values)
    return scalars
