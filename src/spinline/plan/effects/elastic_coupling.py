"""Slip of the network against the solution at finite alpha_v."""

from typing import TYPE_CHECKING

from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate, elastic_coupling_effect
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "ElasticCoupling"]


class ElasticCoupling(Effect):
    """``w = V + eps V V' + ...``, eps = c/alpha_v."""

    name = "elastic coupling"
    symbol = "c V'/alpha_v"
    moves = True

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """By the second order in eps V'."""
        return elastic_coupling_effect(context) if context.straight else self._nothing("not estimated along bead jets")


EFFECT = ElasticCoupling()
