"""From a scene to a result: solution, jet on a grid, network along it, crossover, one Dataset.

Data goes one way. What a scene needs is built by `build_solution` and `build_jet`; `examine` says what is odd about them
before anything runs; `run` puts the closed forms along the jet and names everything as the design does.
"""

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from spinline.build import build_jet, build_solution, coupling, coupling_error, jet_length
from spinline.checks import FloatArray
from spinline.errors import InputError, SpinlineWarning
from spinline.jetprofile.power_law import PowerLaw
from spinline.jetprofile.straight import StraightJet
from spinline.network.concentration import compaction_velocity_ratio
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network.mesh import network_at_rest
from spinline.rheology.solution import Solution
from spinline.rungs import (
    BOND_STRENGTH,
    Crossover,
    SettledChain,
    network_fields,
    settled_chain,
    slip_fields,
    slipping_crossover,
    steady_state,
    walk_fields,
)
from spinline.scene import PowerLawJet, Scene

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.network.manifold import Manifold

__all__ = ["Crossover", "Solved", "build_jet", "build_solution", "crossover", "evaluate", "examine", "run"]

_MODELS = ("auto", "affine", "manifold", "chain", "walk")
_SLIPPING = ("manifold", "chain")  # rungs whose network does not move with the solution


def examine(scene: Scene, solution: Solution, jet: "StraightJet | LagrangianJet") -> list[str]:
    """What is odd about a scene: every remark is a sentence with its number.

    Raises
    ------
    InputError
        For what this version cannot do.
    """
    n = scene.network
    if n.model not in _MODELS:
        allowed = ", ".join(f'"{name}"' for name in _MODELS)
        raise InputError("network.model", "is not available", value=n.model, allowed=allowed, remedy=_TAKE)
    if n.model in _SLIPPING and not isinstance(jet, StraightJet):
        raise InputError("network.model", "needs a straight jet", value=n.model, remedy='take "affine" for a bead jet')
    if n.model == "walk" and n.closure != "force":
        raise InputError("network.closure", "has no walk: strands are walked under a force", value=n.closure,
                         allowed='"force"', remedy=_TAKE)  # fmt: skip
    if n.model not in _SLIPPING and n.force_law != "lattice":
        raise InputError(
            "network.force_law", "is not used by the affine network", value=n.force_law, allowed='"lattice"',
            remedy='take model = "manifold" or "chain" for other laws',
        )  # fmt: skip
    for name, switch in scene.effects:
        if switch is True:
            raise InputError(f"effects.{name}", "is not available", value=True, allowed='"auto", false', remedy=_TAKE)
    phi = solution.volume_fraction
    rest = network_at_rest(phi, n.solvent_quality)
    remarks = []
    if n.model in _SLIPPING and n.force_law != "linear" and n.closure == "force":
        remarks.append(
            'closure "force" holds the strands at 0.83 of their contour where the network is locked at it; closure '
            '"stretch" gives the extension that the force law itself has'
        )
    strands = solution.strands_per_chain(float(rest.segments))
    if strands < 2:
        remarks.append(
            f"no network: a chain of {solution.molar_mass:g} kg/mol makes {strands:.2g} strands of {rest.segments:.3g} "
            "Kuhn segments; two or more are needed. Raise the concentration or the molar mass"
        )
    if isinstance(scene.jet, PowerLawJet) and scene.jet.k is None and isinstance(jet, PowerLaw):
        remarks.append(f"k = {jet.k:.4g} is estimated from the process, to a factor of order one")
    compact, full = float(compaction_velocity_ratio(phi, n.solvent_quality)), float(rest.full_stretch)
    if compact < full:
        remarks.append(
            f"the core is compact (V = {compact:.4g}) before the network is fully stretched (V = {full:.4g})"
        )
    if isinstance(jet, StraightJet):
        eps = coupling_error(scene, solution, jet)
        if np.isnan(eps):
            remarks.append(f"elastic slip is not estimated: {coupling(scene, solution, jet)[2]}")
        if eps > scene.accuracy.rtol and n.model not in _SLIPPING:
            remarks.append(
                f"the affine network errs by about {eps:.2g} in its velocity (largest c V'/alpha_v), more than rtol = "
                f"{scene.accuracy.rtol:g}: see --model manifold"
            )
        if solution.relaxation_time is not None:
            place = float(np.fmin(jet.position_of(full), jet_length(scene, jet)))
            deborah = solution.relaxation_time * float(jet.strain_rate(place))
            if deborah < 1 / scene.accuracy.rtol:
                remarks.append(
                    f"relaxation is left out: De = {deborah:.3g} at the crossover (or the end of the jet), so the affine "
                    f"stretch errs by about {min(1.0, 1 / deborah) if deborah else 1.0:.2g}"
                )
    for name in ("ambient", "rheology"):
        if getattr(scene, name) is not None:
            remarks.append(f"[{name}] is checked but not used: evaporation and relaxation are not modelled")
    return remarks


def crossover(scene: Scene, jet: "StraightJet | LagrangianJet", velocity_ratio: float) -> Crossover:
    """First place along the jet where V passes a value."""
    if not isinstance(jet, StraightJet) and jet.time is not None:
        raise InputError("jet.time", "holds many times", remedy="take one")
    predicted = float(jet.position_of(velocity_ratio)) if velocity_ratio > 0 else float("nan")
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
    from spinline import results

    solved = evaluate(scene)
    for remark in solved.remarks:
        warnings.warn(remark, SpinlineWarning, stacklevel=2)
    return results.assemble(solved.fields, solved.scalars, solved.attributes, solved.jet)


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
    """

    fields: dict[str, FloatArray]
    scalars: dict[str, Any]
    attributes: dict[str, Any]
    remarks: list[str]
    jet: "StraightJet | LagrangianJet"


def evaluate(scene: Scene, jet: "StraightJet | LagrangianJet | None" = None) -> Solved:
    """`run` without Dataset and warnings, for many scenes in a row: half the cost for closed forms.

    Parameters
    ----------
    scene : Scene
        From `load_scene`.
    jet : StraightJet or LagrangianJet, optional
        Its jet, where it has been built before: saves reading files.

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
    remarks = examine(scene, solution, jet)
    phi, quality = solution.volume_fraction, scene.network.solvent_quality
    targets = {
        "crossover": float(crossover_velocity_ratio(phi, quality)),
        "crossover_extension": float(
            extension_velocity_ratio(
                scene.network.crossover_extension.value,
                phi,
                closure=scene.network.closure,
                solvent_quality=quality,
            )
        ),
    }
    frames = _frames(jet)
    found = {name: [crossover(scene, frame, target) for frame in frames] for name, target in targets.items()}
    network: Manifold | SettledChain | None = None
    if scene.network.model in _SLIPPING and isinstance(jet, StraightJet):
        solve = steady_state if scene.network.model == "manifold" else settled_chain
        network = solve(scene, solution, jet)
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
    fields = profile | network_fields(profile, scene, solution, network)
    if network is not None and isinstance(jet, StraightJet):
        fields |= slip_fields(fields, network, scene, solution, jet)
    if scene.network.model == "walk":
        fields |= walk_fields(fields, scene, solution)
    forces = fields["strand_force"]
    if np.nanmax(forces, initial=0.0) > BOND_STRENGTH:
        remarks.append(
            f"the strand force reaches {np.nanmax(forces):.2g} N, more than a covalent bond holds ({BOND_STRENGTH:g} N): "
            "chains break or slip before"
        )
    for name, places in found.items():
        if len(places) == 1 and np.isnan(places[0].position):
            remarks.append(f"{name.replace('_', ' by ')} is not reached: {_elsewhere(places[0])}")
    scalars = {"volume_fraction": phi, **_crossover_scalars(found, single=not _has_times(jet))}
    attributes = _attributes(scene, solution, jet, found, remarks, network)
    return Solved(fields, scalars, attributes, remarks, jet)


_TAKE = "take one of those"


def _has_times(jet: "StraightJet | LagrangianJet") -> bool:
    return not isinstance(jet, StraightJet) and jet.time is not None


def _frames(jet: "StraightJet | LagrangianJet") -> "list[StraightJet | LagrangianJet]":
    if isinstance(jet, StraightJet) or jet.time is None:
        return [jet]
    return [jet.at(float(t)) for t in jet.time]


def _straight_profile(scene: Scene, jet: StraightJet, special: list[float]) -> dict[str, FloatArray]:
    """Jet variables on a grid that is fine at the nozzle and holds the special places exactly."""
    length, r0 = jet_length(scene, jet), jet.initial_radius
    span = length - jet.start
    grid = jet.start + r0 * np.expm1(np.linspace(0.0, np.log1p(span / r0), scene.accuracy.points))
    grid[-1] = length
    extra = [
        place for place in (*special, *(jet.start + kink * r0 for kink in jet.kinks())) if jet.start <= place <= length
    ]
    z = np.unique(np.concatenate((np.clip(grid, jet.start, length), extra)))
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
    step = np.diff(jet.arc_length, axis=-1, prepend=0.0)
    return {
        "arc_length": jet.arc_length,
        "radius": jet.element_radius,
        "velocity": between,
        "velocity_ratio": jet.stretch,
        "strain_rate": jet.element_strain_rate,
        "residence_time": np.cumsum(step / np.where(between > 0, between, np.nan), axis=-1),
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


def _elsewhere(place: Crossover) -> str:
    if np.isnan(place.velocity_ratio):
        return "the network never stretches that far"
    if np.isnan(place.predicted):
        return f"the jet never stretches to V = {place.velocity_ratio:.6g}"
    return (
        f"the profile predicts it at z = {place.predicted:.9g} m (V = {place.velocity_ratio:.6g}), beyond the jet's end"
    )


def _sentence(name: str, places: list[Crossover]) -> str:
    if len(places) > 1:
        reached = sum(not np.isnan(place.position) for place in places)
        return f"reached at {reached} of {len(places)} times"
    place = places[0]
    if np.isnan(place.position):
        return f"not reached: {_elsewhere(place)}"
    return f"reached at {place.position:.9g} m, radius {place.radius:.9g} m, r/r0 = {place.radius_ratio:.9g}"


def _attributes(
    scene: Scene,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    found: dict[str, list[Crossover]],
    remarks: list[str],
    network: "Manifold | SettledChain | None",
) -> dict[str, Any]:
    from spinline import __version__

    slip = "" if network else "elastic slip, inertia, "
    why = "affine" if scene.network.model in ("auto", "affine") else f"{scene.network.model}, asked for"
    attributes: dict[str, Any] = {
        "title": scene.title or scene.name,
        "Conventions": "CF-1.11",
        "source": f"spinline {__version__}",
        "spinline_version": __version__,
        "scene": scene.text,
        "model": "affine" if scene.network.model == "auto" else scene.network.model,
        "model_requested": scene.network.model,
        "closure": scene.network.closure,
        "force_law": scene.network.force_law,
        "solvent_quality": scene.network.solvent_quality,
        "rtol": scene.accuracy.rtol,
        "crossover": _sentence("crossover", found["crossover"]),
        "crossover_extension": _sentence("crossover_extension", found["crossover_extension"]),
        "crossover_extension_criterion": scene.network.crossover_extension.value,
        "effects_left_out": slip + "relaxation, evaporation, radial gradients",
        "polymer": solution.polymer.name,
        "polymer_density": solution.polymer.density,
        "solvent": ", ".join(f"{name} {share:g}" for name, share in solution.solvent.items()),
        "solvent_density": solution.solvent_density,
        "solution_density": solution.density,
        "mass_fraction": solution.mass_fraction,
        "temperature": solution.temperature,
        "kuhn_length": solution.kuhn_length,
        "strands_per_chain": solution.strands_per_chain(
            float(network_at_rest(solution.volume_fraction, scene.network.solvent_quality).segments)
        ),
        "initial_radius": jet.initial_radius,
        "warnings": "\n".join(remarks),
        "references": (
            "Greenfeld et al., Phys. Rev. E 84, 041806 (2011); Eqs. (31)-(40) of the review in the docs"
            f"; polymer data: {solution.polymer.source}"
        ),
    }
    if scene.network.model == "walk":
        attributes |= {"strands": scene.accuracy.strands, "seed": scene.accuracy.seed}
    if network is not None:
        attributes |= {"locked_from": network.locked_from * jet.initial_radius, "inertia": network.inertia}
    if isinstance(network, SettledChain):
        attributes |= {
            "coarse_grain": network.coarse_grain,
            "drift": network.drift,
            "beads": network.profile.beads.size,
        }
    if isinstance(jet, StraightJet):
        alpha, a, viscosity = coupling(scene, solution, jet)
        eps = coupling_error(scene, solution, jet)
        attributes |= {
            "jet": repr(jet) if len(repr(jet)) < 400 else type(jet).__name__,
            "initial_velocity": jet.initial_velocity,
            "flow_rate": jet.flow_rate,
            "coupling": alpha,
            "affinity_of_solvent_drag": a,
            "drag_viscosity": viscosity,
            "spring": scene.network.spring.value,
            "coupling_error": eps,
            "model_reason": (
                f"{why}: elastic slip changes the network velocity by "
                f"about {eps:.2g} (largest c V'/alpha_v, alpha_v = {alpha:.4g}; {viscosity}), rtol = {scene.accuracy.rtol:g}"
            ),
        }
    else:
        attributes |= {
            "jet": str(jet.attributes.get("title", jet.attributes.get("source", "bead jet"))),
            "model_reason": "affine: the material stretch of each element drives the network; elastic slip not estimated",
            "jet_attributes": "\n".join(f"{key} = {value}" for key, value in jet.attributes.items()),
        }
    return attributes
