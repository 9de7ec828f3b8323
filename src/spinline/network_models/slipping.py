"""What the rungs have in common whose network slips against the solution: forces, the end that is reached, words."""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.network.coupling import BOLTZMANN, strand_force
from spinline.network_models.rung import Network, Rung

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
    needs = ("straight jet", "alpha_v")

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
        jet, solution = context.line, context.solution
        s = np.minimum((fields["z"] - jet.start) / jet.initial_radius, network.length)
        slip = fields["velocity_ratio"] - fields["network_velocity_ratio"]
        # c = 3 is the Gaussian strand, f_0 = 3 / V_S
        pull = context.scene.network.spring.value / context.rest.full_stretch * network.tension(s)
        force = strand_force(pull, solution.kuhn_length, solution.temperature)
        drag = context.coupling.alpha * BOLTZMANN * solution.temperature / jet.initial_radius * slip
        found: dict[str, Any] = {
            "slip_velocity": slip * jet.initial_velocity,
            "drag_force": drag,
            "strand_force": force,
            "scission": force > BOND_STRENGTH,
        }
        return found

    def attributes(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """Where the network is locked, and its inertia."""
        assert network is not None
        return {"locked_from": network.locked_from * context.jet.initial_radius, "inertia": network.inertia}
