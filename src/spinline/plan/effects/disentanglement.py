"""Entanglements that let go in the flow: strands grow, the network is lost where a chain has none left."""

from typing import TYPE_CHECKING

import numpy as np

from spinline.base.errors import InputError
from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.network_models.rung import Rung
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "Disentanglement"]


class Disentanglement(Effect):
    """Rolie-Poly strands and the part nu of the entanglements that is left; see `spinline.network.disentanglement`."""

    name = "disentanglement"
    symbol = "entanglements lost"
    switch = "disentanglement"
    after = "relaxation"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """``1 - nu`` at the crossover or the end, by its own equations; only where it is not switched off."""
        if context.scene.effects.disentanglement is False:
            return self._nothing("off: set effects.disentanglement = true")
        theta = context.solution.relaxation_time
        if theta is None or not context.straight:
            return self._nothing("needs a straight jet and solution.relaxation_time")
        from spinline.network.disentanglement import disentangle

        jet, strands = context.line, context.strands
        z = context.grid(201)
        z = z[z <= context.lateral_place * (1 + 1e-12)]
        state = disentangle(
            jet.residence_time(z),
            jet.stretch_ratio(z),
            theta,
            strands.rouse_time(theta),
            segments=context.rest.segments,
            release=strands.release,
            entanglement_release=strands.entanglement_release,
            strain_rate=jet.strain_rate(z),
            rtol=1e-6,
        )
        lost = 1 - float(state.entanglements_left[-1])
        words = f"{lost:.2g} of Z = {strands.entanglements:.3g} let go (beta_c = {strands.entanglement_release:g})"
        return Estimate(self.name, self.symbol, lost, float(1 / np.sqrt(1 - lost) - 1), words)

    def idle(self, context: Context) -> str:
        """Without a relaxation time."""
        if context.scene.effects.disentanglement is False:
            return "set so"
        return "solution.relaxation_time is not given" if context.solution.relaxation_time is None else ""

    def check(self, context: Context) -> None:
        """Only strands that move with the solution, and chains whose entanglements are known."""
        from spinline.network_models.registry import cheapest, rung_in

        rung, able = rung_in(context.scene.network), cheapest(["relaxation"])
        if not rung.relaxes or rung.slips:
            raise InputError(
                "effects.disentanglement",
                f'is not in network.model = "{rung.name}"',
                value=True,
                allowed="false",
                remedy="" if able is None else f'take model = "{able.name}"',
            )
        _ = context.strands

    def held(self, context: Context, rung: "Rung", automatic: bool) -> bool:
        """Where it is on."""
        return bool(context.effects[self.switch])


EFFECT = Disentanglement()
