"""What is odd about a scene, before anything runs: every remark is a sentence with its number."""

from typing import TYPE_CHECKING

from spinline.base.errors import InputError
from spinline.jetprofile.power_law import PowerLaw
from spinline.jetprofile.straight import StraightJet
from spinline.network.concentration import compaction_velocity_ratio
from spinline.network.mesh import network_at_rest
from spinline.plan.effects import Effects, choose_effects
from spinline.rheology.solution import Solution
from spinline.scene.file import PowerLawJet, Scene
from spinline.setup.build import coupling

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.plan.choice import Plan

__all__ = ["SLIPPING", "examine"]

SLIPPING = ("manifold", "chain")  # rungs whose network does not move with the solution


def examine(
    scene: Scene,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    effects: Effects | None = None,
    plan: "Plan | None" = None,
) -> list[str]:
    """What is odd about a scene: every remark is a sentence with its number.

    Parameters
    ----------
    scene, solution, jet
        A scene and what `build_solution` and `build_jet` make of it.
    effects, plan
        If they are known already; what a choice of rung loses is not said where the effects are given and the plan is not.

    Raises
    ------
    InputError
        For what this version cannot do.
    """
    if plan is None and (effects is None or scene.network.model == "auto"):
        from spinline.plan.choice import plan_scene

        plan = plan_scene(scene, solution, jet)
    if plan is not None:
        from spinline.plan.choice import resolved

        scene = resolved(scene, plan)
    n = scene.network
    effects = (
        choose_effects(scene, solution, jet, None if plan is None else plan.numbers) if effects is None else effects
    )
    if n.model in SLIPPING and not isinstance(jet, StraightJet):
        raise InputError("network.model", "needs a straight jet", value=n.model, remedy='take "affine" for a bead jet')
    if n.model == "walk" and n.closure_used != "force":
        raise InputError("network.closure", "has no walk: strands are walked under a force", value=n.closure_used,
                         allowed='"force"', remedy="take one of those")  # fmt: skip
    if n.model not in SLIPPING and n.force_law != "lattice":
        raise InputError(
            "network.force_law", "is not used by the affine network", value=n.force_law, allowed='"lattice"',
            remedy='take model = "manifold" or "chain" for other laws',
        )  # fmt: skip
    phi = solution.volume_fraction
    rest = network_at_rest(phi, n.solvent_quality)
    remarks = []
    if n.model in SLIPPING and n.force_law != "linear" and n.closure == "force":
        remarks.append(
            'closure "force" holds the strands at 0.83 of their contour where the network is locked at it; "auto" '
            'takes "stretch" here, the extension that the force law itself has'
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
    if plan is not None:
        if "slip" in plan.numbers.missing and isinstance(jet, StraightJet):
            remarks.append(f"elastic slip is not estimated: {coupling(scene, solution, jet)[2]}")
        remarks += plan.remarks
    if scene.ambient is not None and not effects.evaporation:
        remarks.append(f"evaporation is left out: {effects.why['evaporation'][5:]}")
    return remarks
