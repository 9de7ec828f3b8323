"""Solvent that leaves the jet."""

from typing import TYPE_CHECKING

from spinline.base.errors import InputError
from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "Evaporation"]


class Evaporation(Effect):
    """Relative change of the mean fraction."""

    name = "evaporation"
    symbol = "volume lost"
    switch = "evaporation"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """By the flat balance, to the end of the jet."""
        lost, error = known.evaporated_fraction, known.errors["evaporation"]
        words = known.missing.get("evaporation", f"{lost:.2g} of the volume")
        return Estimate(self.name, self.symbol, lost, error, words)

    def error(self, context: Context, known: "EffectNumbers") -> tuple[float, str]:
        """Estimated error, and what is missing for it."""
        return known.errors["evaporation"], known.missing.get("evaporation", "")

    def idle(self, context: Context) -> str:
        """Without air."""
        return "there is no [ambient]" if context.scene.ambient is None else ""

    def check(self, context: Context) -> None:
        """What the air needs, and a glass that can be."""
        _ = context.glass
        try:
            _ = context.air
        except InputError:  # a jet that cools may find air that another cannot dry in
            if context.scene.effects.heat is False:
                raise
            _ = context.heated_air


EFFECT = Evaporation()
