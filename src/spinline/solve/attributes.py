"""What a result says of itself: models and why, numbers behind the choice, inputs, the answer in words."""

from typing import Any

import numpy as np

from spinline.network_models.registry import rung_in, simplest
from spinline.network_models.rung import Network
from spinline.plan.choice import Plan
from spinline.plan.governing_numbers import coupling_error
from spinline.setup.context import Context
from spinline.solve.crossovers import Crossover

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
    context: Context,
    found: dict[str, list[Crossover]],
    remarks: list[str],
    network: Network | None,
    plan: Plan,
) -> dict[str, Any]:
    """Attributes of a run's Dataset."""
    from spinline.base.version import __version__

    scene, effects = context.scene, context.effects
    left_out = ("elastic slip", "inertia", *effects.left_out) if network is None else effects.left_out
    model = scene.network.model
    return {
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
        **{f"{key}_reason": why for key, why in effects.why.items()},
        **_solution(context),
        "initial_radius": context.jet.initial_radius,
        "lateral_contraction": next((effect.words for effect in plan.effects if effect.name == "lateral time"), ""),
        "warnings": "\n".join(remarks),
        "references": (
            "Greenfeld et al., Phys. Rev. E 84, 041806 (2011); Eqs. (31)-(40) of the review in the docs"
            f"; polymer data: {context.solution.polymer.source}"
        ),
        **rung_in(scene.network).attributes(context, network),
        **_jet(context, plan),
    }


def _solution(context: Context) -> dict[str, Any]:
    solution = context.solution
    return {
        "polymer": solution.polymer.name,
        "polymer_density": solution.polymer.density,
        "solvent": ", ".join(f"{name} {share:g}" for name, share in solution.solvent.items()),
        "solvent_density": solution.solvent_density,
        "solution_density": solution.density,
        "mass_fraction": solution.mass_fraction,
        "temperature": solution.temperature,
        "kuhn_length": solution.kuhn_length,
        "strands_per_chain": solution.strands_per_chain(context.rest.segments),
    }


def _jet(context: Context, plan: Plan) -> dict[str, Any]:
    """The jet, what couples the network to it, and why this rung."""
    scene, model = context.scene, context.scene.network.model
    why = f"{model}, asked for" if plan.forced and model != simplest().name else model
    if context.straight:
        jet, coupling = context.line, context.coupling
        eps = coupling_error(context)
        found: dict[str, Any] = {
            "jet": repr(jet) if len(repr(jet)) < 400 else type(jet).__name__,
            **jet.words(),
            "initial_velocity": jet.initial_velocity,
            "flow_rate": jet.flow_rate,
            "coupling": coupling.alpha,
            "affinity_of_solvent_drag": coupling.affinity,
            "drag_viscosity": coupling.words,
            "spring": scene.network.spring.value,
            "coupling_error": eps,
        }
        reason = (
            f"{why}: elastic slip changes the network velocity by about {eps:.2g} (largest c V'/alpha_v, "
            f"alpha_v = {coupling.alpha:.4g}; {coupling.words}), rtol = {scene.accuracy.rtol:g}"
        )
    else:
        beads, rate = context.beads, context.bead_flow_rate
        found = {"flow_rate": rate} if np.isfinite(rate) else {}
        found |= {
            "age_source": (
                "volume fed since, at the flow rate that the motion of the elements implies"
                if np.isfinite(rate)
                else "arc length at the speed of the beads"
            ),
            "jet": str(beads.attributes.get("title", beads.attributes.get("source", "bead jet"))),
            "jet_attributes": "\n".join(f"{key} = {value}" for key, value in beads.attributes.items()),
        }
        reason = f"{why}: the material stretch of each element drives the network; elastic slip not estimated"
    if context.effects.relaxation:
        reason = f"{reason}; relaxation {context.effects.why['relaxation']}"
    return {**found, "model_reason": reason}
