"""What the rungs have in common whose network slips against the solution: forces, the end that is reached, words."""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.network.coupling import BOLTZMANN, strand_force
from spinline.network_models.rung import Network, Rung
from spinline.network_models.steady import course_of, solved_on, velocity_of

if TYPE_CHECKING:
    from spinline.setup.context import Context

__all__ = ["BOND_STRENGTH", "SlippingRung", "along", "force_law_of"]

BOND_STRENGTH = 5e-9  # N, covalent bond


def force_law_of(context: "Context") -> dict[str, str]:
    """The force law that a scene names, for a trade; the linear spring where it names none."""
    n = context.scene.network
    return {"force_law": n.force_law if "force_law" in n.model_fields_set else "linear"}


def along(context: "Context", network: Network, place: FloatArray) -> FloatArray:
    """Places along a straight jet (m) in initial radii from its start, within the network."""
    start = context.line.start
    value: FloatArray = np.clip((place - start) * (network.length / (context.length - start)), 0.0, network.length)
    return value


class SlippingRung(Rung):
    """A rung with a network of its own velocity."""

    slips = True
    holds = ("elastic coupling", "inertia", "finite extensibility")
    needs: tuple[str, ...] = ("straight jet", "alpha_v")

    def remarks(self, context: "Context") -> list[str]:
        """A closure that does not know the force law."""
        n = context.scene.network
        if n.force_law == "linear" or n.closure != "force":
            return []
        return [
            'closure "force" holds the strands at 0.83 of their contour where the network is locked at it; "auto" '
            'takes "stretch" here, the extension that the force law itself has'
        ]

    def fields(
        self, context: "Context", fields: dict[str, FloatArray], network: Network | None
    ) -> dict[str, FloatArray]:
        """What slips and pulls where the network does not move with the solution."""
        assert network is not None
        solution, course = context.solution, course_of(context.frames[-1])
        tension = _tension(context, fields, network)
        r0 = context.jet.initial_radius
        slip = fields["velocity_ratio"] - fields["network_velocity_ratio"]
        # c = 3 is the Gaussian strand, f_0 = 3 / V_S
        pull = context.scene.network.spring.value / context.rest.full_stretch * tension
        known = np.isfinite(pull)
        force = np.full(pull.shape, np.nan)
        force[known] = strand_force(pull[known], solution.kuhn_length, solution.temperature)
        drag = course.coupling * BOLTZMANN * solution.temperature / r0 * slip
        found: dict[str, Any] = {
            "slip_velocity": slip * course.pace * r0,
            "drag_force": drag,
            "strand_force": force,
            "scission": force > BOND_STRENGTH,
        }
        return found

    def strand_tension(self, context: "Context", fields: dict[str, FloatArray], network: Network | None) -> FloatArray:
        """``f_0 T``, T by the scene's force law."""
        assert network is not None
        return 3 / context.rest.full_stretch * _tension(context, fields, network)

    def scalars(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """How much the far end decides."""
        effect = getattr(network, "far_end_effect", None)
        return {} if effect is None else {"far_end_effect": float(effect)}

    def solved_remarks(self, context: "Context", network: Network) -> list[str]:
        """A far end that is felt, a network faster than the jet that feeds it."""
        rtol, r0, remarks = context.scene.accuracy.rtol, context.jet.initial_radius, []
        effect, full = float(getattr(network, "far_end_effect", 0.0)), context.rest.full_stretch
        if effect > rtol:
            at = float(getattr(network, "moves_most", float("nan"))) * r0
            where = "" if np.isnan(at) else f", most at {1e3 * at:.3g} mm"
            locked = network.locked_from
            why = (
                f"; strands are at their contour from {1e3 * locked * r0:.3g} mm on and are pulled by whatever lies beyond"
                if locked < network.length
                else ""
            )
            remarks.append(
                f"the far end decides: what lies beyond the end of the jet moves the network by up to {effect:.2g}{where} "
                f"(rtol = {rtol:g}){why}. These numbers belong to this length of the jet"
            )
        inlet = float(velocity_of(network, np.array([0.0]))[0])
        if inlet > 1 + max(rtol, 0.01) and np.isfinite(full):
            remarks.append(
                f"the network leaves the nozzle at {inlet:.3g} v_0, faster than the jet that feeds it: it would have to be "
                f"pulled out, and its fraction there would be {context.solution.volume_fraction / inlet:.3g}"
            )
        return remarks

    def attributes(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """Where the network is locked, and its inertia."""
        assert network is not None
        held = {"network_end": context.scene.network.end} if hasattr(network, "far_end_effect") else {}
        return held | {"locked_from": network.locked_from * context.jet.initial_radius, "inertia": network.inertia}


def _tension(context: "Context", fields: dict[str, FloatArray], network: Network) -> FloatArray:
    """T along the jet, over that at rest."""
    if context.straight:
        return network.tension(along(context, network, fields["z"]))
    return solved_on(context, network, lambda one, s: one.tension(s))
