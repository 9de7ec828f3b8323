"""Rung ``two-fluid``: the steady network whose strands slip and relax, both at once."""

from typing import TYPE_CHECKING, Any

from spinline.network_models.rung import Network, Relaxed, Setting
from spinline.network_models.slipping import SlippingRung, force_law_of
from spinline.network_models.steady import Networks, course_of

if TYPE_CHECKING:
    from spinline.network.two_fluid import TwoFluid
    from spinline.setup.context import Context
    from spinline.setup.history import History

__all__ = ["RUNG", "TwoFluidNetwork"]

_FINER = 100.0


class TwoFluidNetwork(SlippingRung):
    """Momentum and relaxation of the strands together; see `spinline.network.two_fluid`."""

    name = "two-fluid"
    words = "steady network whose strands slip and relax: two equations at once"
    holds = ("elastic coupling", "relaxation", "finite extensibility")
    needs = ("alpha_v", "relaxation time")
    relaxes = True
    automatic = True
    cost = "20 to 60 ms"

    def solve(self, context: "Context") -> "TwoFluid | Networks":
        """Steady network of a scene at its coupling and relaxation time; of a bead jet, one a moment."""
        if context.straight:
            return _steady(context)
        return Networks([_steady(frame) for frame in context.frames])

    def relax(self, context: "Context", history: "History") -> Relaxed:
        """Nothing more: strands have relaxed where the network was solved."""
        theta = context.material.relaxation_time(history.fraction)
        found = {}
        if history.strain_rate is not None:
            found = {
                "weissenberg_number": theta * history.strain_rate,
                "deborah_number": float(context.solution.relaxation_time or 0.0) * history.strain_rate,
            }
        return Relaxed(
            history.stretch, found, f"{context.scene.network.strand_law} strands, {context.scene.network.force_law} law"
        )

    def solved_remarks(self, context: "Context", network: Network) -> list[str]:
        """The far end, and a relaxation time that drying changes."""
        remarks = super().solved_remarks(context, network)
        if context.effects.evaporation:
            remarks.append(
                "strands relax in the time of the solution at the nozzle, "
                f"{context.solution.relaxation_time:.3g} s: what drying makes of it is not in the two-fluid network"
            )
        return remarks

    def attributes(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """Its strands."""
        return super().attributes(context, network) | {"strand_law": context.scene.network.strand_law}

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """By the scene's force law."""
        if context.solution.relaxation_time is None:
            return []
        return [Setting("steady", {**force_law_of(context)})]


def _steady(context: "Context") -> "TwoFluid":
    from spinline.network.tension import Tension
    from spinline.network.two_fluid import two_fluid_network

    n, course = context.scene.network, course_of(context)
    assert context.solution.relaxation_time is not None
    return two_fluid_network(
        course.profile,
        course.length,
        coupling=course.coupling,
        relaxation_time=context.solution.relaxation_time * course.pace,
        spring=n.spring.value,
        law=Tension.of(n.force_law, context.rest.full_stretch),
        strand_law=n.strand_law,
        end=n.end,
        stations=course.stations,
        breaks=course.breaks,
        known_to=course.known_to,
        rtol=min(1e-6, 1e-3 * context.scene.accuracy.rtol),
    )


RUNG = TwoFluidNetwork()
