"""Rung ``chain``: every bead of the network followed in time until it is steady."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network_models.rung import Network, Setting, simplest
from spinline.network_models.slipping import SlippingRung, force_law_of

if TYPE_CHECKING:
    from spinline.network.chain.cycle import ChainCycle
    from spinline.network.chain.model import Chain
    from spinline.network.chain.profile import ChainProfile
    from spinline.setup.context import Context

__all__ = ["RUNG", "SettledChain", "TransientChain"]

_MORE = 30  # strands joined into one, where the chain of all is too stiff
_FRONT_RTOL = 0.03
_MOST_BEADS = 3000  # of a chain that is free to join strands
_AFFORDABLE = 3000  # steps of a chain in a trade


@dataclass(frozen=True, eq=False)
class SettledChain:
    """A bead chain followed in time until it is steady, with what a `Manifold` offers.

    Attributes
    ----------
    profile : ChainProfile
        Strands at the end of the run.
    length, inertia : float
        Far end in initial radii, and I.
    locked_from : float
        First place beyond 0.95 of the contour, initial radii; NaN if none.
    coarse_grain : float
        Strands joined into one.
    drift : float
        Largest relative change of w over the last tenth of the run: 0 when settled.
    cycle : ChainCycle or None
        Of a law with a contour: averages over the period between two entries, and the range within it.
    """

    profile: "ChainProfile"
    length: float
    inertia: float
    locked_from: float
    coarse_grain: float
    drift: float
    cycle: "ChainCycle | None" = None

    def stretch(self, s: FloatArray) -> FloatArray:
        """Stretch w at s, held at the outermost beads; over a period on average, where strands come to their contour."""
        beads = self.profile.beads
        if self.cycle is not None:
            known = np.isfinite(self.cycle.mean)
            if known.any():
                return np.interp(s, self.cycle.stations[known], self.cycle.mean[known])
        return self.profile.stretch_at(np.clip(s, beads[0], beads[-1]))

    def tension(self, s: FloatArray) -> FloatArray:
        """Tension T at s, linear between the middles of the strands."""
        return np.interp(s, self.profile.position, self.profile.tension)

    def first_passage(self, stretch: float) -> float:
        """First s where w passes a value, linear between the middles of the strands; NaN where it never does."""
        above = np.flatnonzero(self.profile.stretch >= stretch)
        if not above.size:
            return float("nan")
        k = max(int(above[0]), 1)
        return float(np.interp(stretch, self.profile.stretch[k - 1 : k + 1], self.profile.position[k - 1 : k + 1]))


class TransientChain(SlippingRung):
    """Bead chain followed for two or three residence times; see `spinline.network.chain`."""

    name = "chain"
    words = "every bead of the network in time, until it is steady"
    sampled = True
    lean = False
    cost = "seconds"

    def solve(self, context: "Context") -> SettledChain:
        """Bead chain of a scene followed until it is steady.

        Raises
        ------
        InputError
            Where the chain cannot be followed in time.
        """
        from spinline.network.chain import chain_cycle, run_chain
        from spinline.network.chain.model import ChainError
        from spinline.network.chain.profile import profile as chain_profile

        scene, jet, full = context.scene, context.line, context.rest.full_stretch
        n, length = scene.network, context.length / jet.initial_radius
        transit = float(jet.residence_time(context.length)) * jet.initial_velocity / jet.initial_radius
        chain, joined = self._chain(context, length, transit)
        # strands cannot start beyond their contour: there the chain fills the jet from the nozzle
        over = n.force_law != "linear" and float(jet.velocity_ratio(context.length)) > 0.9 * full
        start, duration = ("empty", 4 * transit) if over else ("affine", 2 * transit)
        # a front of locking passes bead by bead: resolving it in time costs much and the settled state does not need it
        rtol = _FRONT_RTOL if over else float(np.clip(0.1 * scene.accuracy.rtol, 1e-8, 1e-3))
        try:
            run = run_chain(
                chain, duration, start=start, rtol=rtol, output_times=[0.9 * duration], most_steps=scene.accuracy.steps
            )
        except ChainError as error:
            remedy = "raise accuracy.steps or accuracy.rtol, or join more strands (network.coarse_grain)"
            if over:  # rtol is that of the front there
                end = 1.2e3 * float(jet.position_of(full))
                remedy = (
                    f'follow the jet to a little beyond full stretch only, jet.length = "{end:.2g} mm", or join more strands, '
                    f"network.coarse_grain = {_MORE * max(joined, 1.0):.0f}"
                )
            raise InputError(
                "network.model", f"the chain cannot be followed ({error})", value=self.name, remedy=remedy
            ) from None
        profile = run.profile
        if not profile.position.size:
            raise InputError(
                "network.model",
                f"leaves no strand in the jet: {joined:.3g} joined into one are longer than it",
                value=self.name,
                remedy="join fewer (network.coarse_grain), or take a longer jet",
            )
        cycle = None
        if n.force_law != "linear":
            places = np.union1d(context.grid(801) / jet.initial_radius, np.linspace(0.0, length, 401))
            try:
                cycle = chain_cycle(
                    chain, run.state, np.clip(places, 0.0, length), rtol=rtol, most_steps=scene.accuracy.steps
                )
            except ChainError:
                cycle = None  # the snapshot is what there is
        inner = np.linspace(0.02, 0.9, 200) * length
        earlier = chain_profile(chain, run.snapshots[0]).stretch_at(inner)
        locked = np.flatnonzero(profile.stretch >= (np.inf if n.force_law == "linear" else 0.95 * full))
        return SettledChain(
            profile=profile,
            length=length,
            inertia=n.inertia.value,
            locked_from=float(profile.position[locked[0]]) if locked.size else float("nan"),
            coarse_grain=joined,
            drift=_drift(profile.stretch_at(inner), earlier),
            cycle=cycle,
        )

    def solved_remarks(self, context: "Context", network: Network) -> list[str]:
        """A chain that has not settled, or sticks and slips."""
        assert isinstance(network, SettledChain)
        rtol, remarks = context.scene.accuracy.rtol, []
        if network.cycle is not None and network.cycle.swing > rtol:
            remarks.append(
                "the chain sticks and slips: with every bead that enters its stretch ranges over "
                f"{network.cycle.swing:.2g} of its average at the place that swings most; averages are reported"
            )
        if not network.drift > rtol:
            return remarks
        return [
            *remarks,
            f"the chain has not settled: its stretch still changed by {network.drift:.2g} over the last tenth of "
            "the run (no steady state, or a longer time is needed)",
        ]

    def attributes(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """Its beads, and how far it has settled."""
        assert isinstance(network, SettledChain)
        return super().attributes(context, network) | {
            "coarse_grain": network.coarse_grain,
            "drift": network.drift,
            **({} if network.cycle is None else {"swing": network.cycle.swing}),
            "beads": network.profile.beads.size,
        }

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """As fine as the scene asks, and finer."""
        if quick or not context.straight:
            return []
        accuracy, law = context.scene.accuracy, force_law_of(context)
        rtol, steps = accuracy.rtol, min(accuracy.steps, _AFFORDABLE)
        tolerances = (max(rtol, 1e-3), 1e-3)[: 2 if rtol > 1e-3 else 1]
        return [Setting(f"rtol {r:.0e}", {"rtol": r, "steps": steps, **law}) for r in tolerances]

    def _chain(self, context: "Context", length: float, transit: float) -> "tuple[Chain, float]":
        """The chain at the start, and the strands joined into one of its links."""
        from spinline.network.chain.flow import Flow
        from spinline.network.chain.model import Chain

        n, jet, rest = context.scene.network, context.line, context.rest
        r0 = jet.initial_radius
        spacing = rest.size * context.solution.kuhn_length / r0
        if spacing > 1:
            raise InputError(
                "network.model",
                f"has no chain: a mesh of {spacing * r0:.3g} m is wider than the jet's radius",
                value=self.name,
                allowed=f"a radius above {spacing * r0:.3g} m",
                remedy=f'raise the fraction, or take model = "{simplest().name}"',
            )
        joined = max(1.0, transit / spacing / _MOST_BEADS) if n.coarse_grain is None else n.coarse_grain.value
        chain = Chain(
            flow=Flow.from_jet(jet, length),
            spacing=spacing,
            coupling=context.coupling.required(),
            spring=n.spring.value,
            inertia=n.inertia.value,
            law=n.force_law,
            contour=rest.full_stretch,
            coarse_grain=joined,
        )
        return chain, joined


def _drift(now: FloatArray, earlier: FloatArray) -> float:
    """Largest relative change where both are known; infinite where nothing is."""
    change = np.abs(now / earlier - 1)
    known = np.isfinite(change)
    return float(change[known].max()) if known.any() else float("inf")


RUNG = TransientChain()
