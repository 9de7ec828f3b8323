"""What a result says of itself: models and why, numbers behind the choice, inputs, the answer in words."""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.jetprofile.straight import StraightJet
from spinline.network.mesh import network_at_rest
from spinline.network_models.rungs import Crossover, SettledChain
from spinline.plan.choice import Plan
from spinline.plan.effects import NAMES, Effects
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene
from spinline.setup.build import bead_ages, coupling, coupling_error

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.network.manifold import Manifold

__all__ = ["attributes_of", "elsewhere"]


def elsewhere(place: Crossover) -> str:
    """Where a crossover is that the jet does not reach."""
    if place.words:
        return place.words
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
        return f"not reached: {elsewhere(place)}"
    return f"reached at {place.position:.9g} m, radius {place.radius:.9g} m, r/r0 = {place.radius_ratio:.9g}"


def attributes_of(
    scene: Scene,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    found: dict[str, list[Crossover]],
    remarks: list[str],
    network: "Manifold | SettledChain | None",
    effects: Effects,
    plan: Plan,
) -> dict[str, Any]:
    """Attributes of a run's Dataset."""
    from spinline.base.version import __version__

    left_out = ([] if network else ["elastic slip", "inertia"]) + effects.left_out
    model = scene.network.model
    why = f"{model}, asked for" if plan.forced and model != "affine" else model
    attributes: dict[str, Any] = {
        "title": scene.title or scene.name,
        "Conventions": "CF-1.11",
        "source": f"spinline {__version__}",
        "spinline_version": __version__,
        "scene": scene.text,
        "model": model,
        "model_requested": model if plan.forced else "auto",
        "plan": plan.json(),
        "closure": scene.network.closure_used,
        "force_law": scene.network.force_law,
        "solvent_quality": scene.network.solvent_quality,
        "rtol": scene.accuracy.rtol,
        "crossover": _sentence("crossover", found["crossover"]),
        "crossover_extension": _sentence("crossover_extension", found["crossover_extension"]),
        "crossover_extension_criterion": scene.network.crossover_extension.value,
        "effects_left_out": ", ".join(left_out),
        **{f"{name}_reason": effects.why[name] for name in NAMES},
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
        rate = bead_ages(jet)[1]
        if np.isfinite(rate):
            attributes["flow_rate"] = rate
        attributes |= {
            "age_source": (
                "volume fed since, at the flow rate that the motion of the elements implies"
                if np.isfinite(rate)
                else "arc length at the speed of the beads"
            ),
            "jet": str(jet.attributes.get("title", jet.attributes.get("source", "bead jet"))),
            "model_reason": f"{why}: the material stretch of each element drives the network; elastic slip not estimated",
            "jet_attributes": "\n".join(f"{key} = {value}" for key, value in jet.attributes.items()),
        }
    if effects.relaxation:
        attributes["model_reason"] = f"{attributes['model_reason']}; relaxation {effects.why['relaxation']}"
    return attributes
