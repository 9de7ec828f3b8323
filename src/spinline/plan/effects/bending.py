"""A jet that is not straight."""

from typing import TYPE_CHECKING

from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.network_models.rung import Rung
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "Bending"]


class Bending(Effect):
    """In a bead jet, and only there."""

    name = "bending"
    symbol = "bead jet"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """None, along a straight jet."""
        if context.straight:
            return Estimate(self.name, self.symbol, 0.0, float("nan"), "a straight profile: the first millimetres")
        words = "the material stretch of the beads drives the network, bent or not"
        return Estimate(self.name, self.symbol, 1.0, 0.0, words)

    def held(self, context: Context, rung: "Rung", automatic: bool) -> bool:
        """By the beads."""
        return not context.straight


EFFECT = Bending()
