"""Rung ``manifold``: the steady network at its finite coupling, by one stiff equation marched the stable way."""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.network_models.rung import Setting
from spinline.network_models.slipping import SlippingRung, force_law_of
from spinline.network_models.steady import Networks, course_of

if TYPE_CHECKING:
    from spinline.network.manifold import Manifold
    from spinline.network.two_fluid import TwoFluid
    from spinline.setup.batch import Batch
    from spinline.setup.context import Context

__all__ = ["RUNG", "SteadyNetwork"]

_FINER = 100.0  # times below rtol, of a reference


class SteadyNetwork(SlippingRung):
    """``w = V + (eps T'(w) - I) w dw/ds``; see `spinline.network.manifold`."""

    name = "manifold"
    words = "steady network that slips at finite alpha_v: one stiff equation"
    needs = ("alpha_v",)
    automatic = True
    many = True
    branch = "elastic"
    cost = "1 to 20 ms"

    def solve(self, context: "Context") -> "Manifold | Networks":
        """Steady network of a scene at its finite coupling; of a bead jet, one a moment."""
        if context.straight:
            return _steady(context)
        return Networks([_along_beads(frame) for frame in context.frames])

    def rows(self, batch: "Batch", places: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Linear springs without inertia: compiled, the very march of a single run."""
        n, coupling = batch.scene.network, batch.coupling
        if n.force_law != "linear" or n.inertia.value or coupling is None:
            return None
        from spinline.network.manifold import steady_rows

        def every(values: Any) -> FloatArray:
            return np.broadcast_to(np.asarray(values, dtype=np.float64), (batch.rows,))

        jets = batch.jets
        length = every(batch.length)
        reduced = every(batch.length / jets.initial_radius)
        return steady_rows(
            np.stack([every(part) for part in jets.formula()], axis=1),
            reduced,
            every(jets.onset),
            every(batch.of("network.spring") / coupling),
            end=n.end,
            rtol=np.minimum(1e-8, 1e-3 * batch.all("accuracy.rtol")),
            targets=target,
            places=np.clip(places * (reduced / length)[:, None], 0.0, reduced[:, None]),
        )

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """By the scene's force law."""
        return [Setting("steady", {**force_law_of(context)})]

    def finest(self, context: "Context") -> Setting | None:
        """A hundred times finer than the scene's rtol."""
        rtol = float(f"{max(context.scene.accuracy.rtol / _FINER, 1e-9):.0e}")
        return Setting("", {"rtol": rtol, **force_law_of(context)})


def _steady(context: "Context") -> "Manifold":
    from spinline.network.manifold import steady_network
    from spinline.network.tension import Tension

    n, course = context.scene.network, course_of(context)
    return steady_network(
        course.profile,
        course.length,
        coupling=course.coupling,
        spring=n.spring.value,
        inertia=n.inertia.value,
        law=Tension.of(n.force_law, context.rest.full_stretch),
        breaks=course.breaks,
        end=n.end,
        stations=course.stations,
        known_to=course.known_to,
        rtol=min(1e-8 if context.straight else 1e-6, 1e-3 * context.scene.accuracy.rtol),
    )


def _along_beads(context: "Context") -> "TwoFluid | Manifold":
    """The same network where V has a kink at every element: by the box scheme, ten times faster; heavy beads, by `_steady`."""
    from spinline.network.tension import Tension
    from spinline.network.two_fluid import two_fluid_network

    n, course = context.scene.network, course_of(context)
    if n.inertia.value:
        return _steady(context)
    return two_fluid_network(
        course.profile,
        course.length,
        coupling=course.coupling,
        relaxation_time=np.inf,
        spring=n.spring.value,
        law=Tension.of(n.force_law, context.rest.full_stretch),
        end=n.end,
        stations=course.stations,
        breaks=course.breaks,
        known_to=course.known_to,
        rtol=min(1e-6, 1e-3 * context.scene.accuracy.rtol),
    )


RUNG = SteadyNetwork()
