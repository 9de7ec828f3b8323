"""Contour length of the strands, as the network as a whole feels it."""

from typing import TYPE_CHECKING

from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate, extensibility_effect
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.network_models.rung import Rung
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "FiniteExtensibility"]


class FiniteExtensibility(Effect):
    """Where a stiff network locks."""

    name = "finite extensibility"
    symbol = "V/V_S at the end"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """By the place from which the network is locked."""
        return extensibility_effect(context) if context.straight else self._nothing("not estimated along bead jets")

    def held(self, context: Context, rung: "Rung", automatic: bool) -> bool:
        """Where the scene names a force law, or the rung."""
        named = "force_law" in context.scene.network.model_fields_set
        return super().held(context, rung, automatic) and (named or not automatic)


EFFECT = FiniteExtensibility()
