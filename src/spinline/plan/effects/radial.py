"""A skin: drier at the surface than on the axis."""

from typing import TYPE_CHECKING

from spinline.drying.along_jet import check_radial
from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "RadialGradients"]


class RadialGradients(Effect):
    """Difference between surface and mean over the mean."""

    name = "radial gradients"
    symbol = "drying Peclet"
    switch = "radial"
    after = "evaporation"

    def estimate(self, context: Context, known: "EffectNumbers") -> Estimate:
        """By the drying Peclet and Fourier numbers."""
        uneven = known.errors["radial"]
        words = known.missing.get("radial", f"surface and mean differ by {uneven:.2g} of the mean")
        return Estimate(self.name, self.symbol, known.drying_peclet, uneven, words)

    def error(self, context: Context, known: "EffectNumbers") -> tuple[float, str]:
        """Estimated error, and what is missing for it."""
        return known.errors["radial"], known.missing.get("radial", "")

    def idle(self, context: Context) -> str:
        """Without air."""
        return "there is no evaporation" if context.scene.ambient is None else ""

    def check(self, context: Context) -> None:
        """A diffusivity, one solvent, and an activity that it can take."""
        _ = context.diffusion
        check_radial(context.air)


EFFECT = RadialGradients()
