"""What is odd about a scene, before anything runs: every remark is a sentence with its number."""

from typing import TYPE_CHECKING

from spinline.jetprofile.power_law import PowerLaw
from spinline.network.concentration import compaction_velocity_ratio
from spinline.network_models.registry import rung_in
from spinline.plan.choice import Plan, plan_of, resolved
from spinline.plan.plausible import implausible
from spinline.plan.switches import choose_effects
from spinline.rheology.solution import LEAST_STRANDS, Solution
from spinline.scene.file import PowerLawJet, Scene
from spinline.setup.air import assumed_interactions
from spinline.setup.build import estimate_of
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.jetprofile.jet import Jet

__all__ = ["examine", "remarks_of"]


BENDS = 0.05  # m; Reneker, Yarin, Polymer 49, 2387 (2008): straight segments of millimetres to centimetres


def examine(scene: Scene, solution: Solution, jet: "Jet") -> list[str]:
    """`remarks_of` a scene and what `build_solution` and `build_jet` make of it, its rung and effects chosen."""
    context = Context(scene, solution, jet)
    plan = plan_of(context)
    context = context.taking(resolved(scene, plan))
    return remarks_of(context.taking(effects=choose_effects(context, plan.numbers)), plan)


def remarks_of(context: Context, plan: "Plan | None" = None) -> list[str]:
    """What is odd about a scene: every remark is a sentence with its number.

    Parameters
    ----------
    context : Context
        Rung and effects chosen.
    plan : Plan, optional
        Where it was made; what a choice of rung loses is said of it alone.

    Raises
    ------
    InputError
        For what the rung cannot do.
    """
    scene, solution, rest = context.scene, context.solution, context.rest
    n, effects = scene.network, context.effects
    rung = rung_in(n)
    rung.check(context)
    phi = solution.volume_fraction
    remarks = [*implausible(context), *rung.remarks(context)]
    strands = solution.strands_per_chain(rest.segments)
    if strands < LEAST_STRANDS:
        remarks.append(
            f"no entangled network: a chain of {solution.molar_mass:g} kg/mol makes {strands:.2g} strands of "
            f"{rest.segments:.3g} Kuhn segments; two or more are needed. Raise the concentration or the molar mass"
        )
    if n.solvent_quality == "good":
        remarks += _blobs(rest.full_stretch, n.closure_used, rung.slips)
    jet = context.jet
    if isinstance(scene.jet, PowerLawJet) and scene.jet.k is None and isinstance(jet, PowerLaw):
        remarks.append(f"k = {jet.k:.4g} is estimated from the process, to a factor of order one")
    compact, full = float(compaction_velocity_ratio(phi, n.solvent_quality)), rest.full_stretch
    if compact < full:
        remarks.append(
            f"the core is compact (V = {compact:.4g}) before the network is fully stretched (V = {full:.4g})"
        )
    if plan is not None:
        if "slip" in plan.numbers.missing and context.straight:
            remarks.append(f"elastic slip is not estimated: {context.coupling.words}")
        remarks += plan.remarks
    if context.straight:
        remarks += context.line.remarks()
        if context.length > BENDS and not hasattr(jet, "bending"):
            remarks.append(
                f"the jet is straight for {1e3 * context.length:.3g} mm: electrospun jets bend after 10 to 50 mm (where, "
                'jet.profile = "needle" computes from voltage and charge), and the stretch that makes fibres of less than a '
                "micrometre is the bending jet's"
            )
    for key, unit in (("viscosity", "Pa s"), ("relaxation_time", "s")):
        if getattr(scene.solution, key) == "estimate":
            about = estimate_of(solution, key)
            low, high = about.band
            remarks.append(
                f"{key.replace('_', ' ')} {about.value:.3g} {unit} (95 %: {low:.2g} to {high:.2g}): {about.words}"
            )
    assumed = assumed_interactions(scene, solution) if effects.evaporation else []
    if assumed:
        taken = ", ".join(f"{chi:g} with {name} ({key})" for name, key, chi in assumed)
        remarks.append(f"chi of {solution.polymer.name} is not known, and taken to be {taken}")
    if scene.ambient is not None and not effects.evaporation:
        remarks.append(f"evaporation is left out: {effects.why['evaporation'][5:]}")
    return remarks


def _blobs(full_stretch: float, closure: str, slips: bool) -> list[str]:
    """What ideal strands get wrong in a good solvent, whose strands stretch as ``f^(2/3)`` from k_B T/xi_0 to k_B T/b."""
    said = []
    if closure == "force":
        said.append(f"the walk overstates their extension by up to {full_stretch ** (1 / 3):.2g}")
    if slips:
        said.append(
            f"the tension that lets the network slip, over its value at rest, is too small by up to {full_stretch**0.5:.2g}"
        )
    if not said:
        return []
    law = "the Pincus regime of a good solvent is not modelled: between k_B T/xi_0 and k_B T/b strands stretch as the force"
    return [f"{law} to the 2/3, and {', and '.join(said)}"]
