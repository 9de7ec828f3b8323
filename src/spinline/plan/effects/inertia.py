"""Mass of the strands."""

from typing import TYPE_CHECKING

from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate, inertia_effect
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.network_models.rung import Rung
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "Inertia"]


class Inertia(Effect):
    """As elastic coupling, with -I for eps."""

    name = "inertia"
    symbol = "I V'"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """By the second order in I V'."""
        if not context.straight:
            return self._nothing("not estimated along bead jets")
        return inertia_effect(context, known.inertia)

    def held(self, context: Context, rung: "Rung", automatic: bool) -> bool:
        """Where the scene gives one."""
        return super().held(context, rung, automatic) and bool(context.scene.network.inertia.value)


EFFECT = Inertia()
