"""What is odd about a scene, before anything runs: every remark is a sentence with its number."""

from typing import TYPE_CHECKING

import numpy as np

from spinline.build import coupling, coupling_error
from spinline.effects import Effects, choose_effects
from spinline.errors import InputError
from spinline.jetprofile.power_law import PowerLaw
from spinline.jetprofile.straight import StraightJet
from spinline.network.concentration import compaction_velocity_ratio
from spinline.network.mesh import network_at_rest
from spinline.rheology.solution import Solution
from spinline.scene import PowerLawJet, Scene

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["SLIPPING", "examine"]

SLIPPING = ("manifold", "chain")  # rungs whose network does not move with the solution


def examine(
    scene: Scene, solution: Solution, jet: "StraightJet | LagrangianJet", effects: Effects | None = None
) -> list[str]:
    """What is odd about a scene: every remark is a sentence with its number.

    Raises
    ------
    InputError
        For what this version cannot do.
    """
    if scene.network.model == "auto":
        from spinline.plan import plan_scene, resolved

        scene = resolved(scene, plan_scene(scene, solution, jet))
    n = scene.network
    effects = choose_effects(scene, solution, jet) if effects is None else effects
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
    if isinstance(jet, StraightJet):
        eps = coupling_error(scene, solution, jet)
        if np.isnan(eps):
            remarks.append(f"elastic slip is not estimated: {coupling(scene, solution, jet)[2]}")
        if eps > scene.accuracy.rtol and n.model not in SLIPPING:
            remarks.append(
                f"the affine network errs by about {eps:.2g} in its velocity (largest c V'/alpha_v), more than rtol = "
                f"{scene.accuracy.rtol:g}: see --model manifold"
            )
    if solution.relaxation_time is not None and not effects.relaxation:
        assert effects.numbers is not None  # they are made wherever a relaxation time is given
        relaxing = effects.numbers.relaxation
        if relaxing.error > scene.accuracy.rtol:
            remarks.append(
                f"relaxation is left out: De = {relaxing.number:.3g} at the crossover (or the end of the jet), so the "
                f"affine stretch errs by about {relaxing.error:.2g}"
            )
    if scene.ambient is not None and not effects.evaporation:
        remarks.append(f"evaporation is left out: {effects.why['evaporation'][5:]}")
    if effects.numbers is not None:
        slip, relaxation = effects.numbers.errors["slip"], effects.numbers.errors["relaxation"]
        if slip > scene.accuracy.rtol and relaxation > scene.accuracy.rtol:
            remarks.append(
                f"no model holds both elastic slip (error of about {slip:.2g}) and relaxation ({relaxation:.2g}): "
                f"compare manifold and conformation"
            )
    return remarks
