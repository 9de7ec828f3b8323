"""A core that is held at polymer alone."""

from typing import TYPE_CHECKING

from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate, saturation_effect
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.network_models.rung import Rung
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "Saturation"]


class Saturation(Effect):
    """How far the walk's fraction passes 1; in every rung."""

    name = "saturation"
    symbol = "unbounded core fraction"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """By the affine core fraction, unbounded."""
        if context.straight:
            return saturation_effect(context)
        return Estimate(self.name, "core fraction, held at 1", known.core_fraction, 0.0, "in every rung")

    def held(self, context: Context, rung: "Rung", automatic: bool) -> bool:
        """Always."""
        return True


EFFECT = Saturation()
