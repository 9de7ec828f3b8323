"""A jet that cools as it dries, and takes up water from its air."""

from typing import TYPE_CHECKING

from spinline.base.errors import InputError
from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate
from spinline.setup.context import Context
from spinline.setup.heat import heat_refusal

if TYPE_CHECKING:
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "EvaporativeCooling"]


class EvaporativeCooling(Effect):
    """Change of the reported dryness; the number is how far the wet bulb is below the air."""

    name = "evaporative cooling"
    symbol = "wet-bulb depression (K)"
    switch = "heat"
    after = "evaporation"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """By both balances along the jet, with heat and without."""
        number, error = known.wet_bulb_depression, known.errors["heat"]
        words = known.missing.get(
            "heat", f"the wet bulb is {number:.3g} K below the air; dryness changes by {error:.2g}"
        )
        return Estimate(self.name, self.symbol, number, error, words)

    def error(self, context: Context, known: "EffectNumbers") -> tuple[float, str]:
        """Estimated error, and what is missing for it."""
        return known.errors["heat"], known.missing.get("heat", "")

    def idle(self, context: Context) -> str:
        """Without air."""
        return "there is no evaporation" if context.scene.ambient is None else ""

    def check(self, context: Context) -> None:
        """Heats of every liquid, and laws that can have them."""
        why = heat_refusal(context.scene)
        if why:
            raise InputError("effects.heat", f"cannot be: {why}", value=True, remedy="set effects.heat = false")
        _ = context.heated_air


EFFECT = EvaporativeCooling()
