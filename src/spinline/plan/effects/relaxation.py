"""Strands that give back some of their stretch on the way."""

from typing import TYPE_CHECKING

from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "Relaxation"]


class Relaxation(Effect):
    """``ln(w/V) = -int (1 - V^-2)/(2 theta) dt``; held by the rungs that relax."""

    name = "relaxation"
    symbol = "De"
    switch = "relaxation"
    moves = True

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """What the governing numbers hold already."""
        return known.relaxation

    def error(self, context: Context, known: "EffectNumbers") -> tuple[float, str]:
        """Estimated error, and what is missing for it."""
        return known.errors["relaxation"], known.missing.get("relaxation", "")

    def idle(self, context: Context) -> str:
        """Without a relaxation time."""
        return "solution.relaxation_time is not given" if context.solution.relaxation_time is None else ""


EFFECT = Relaxation()
