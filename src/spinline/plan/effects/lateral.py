"""Time that the network has to contract across the jet: what Eq. (39) takes for granted."""

from typing import TYPE_CHECKING

import numpy as np

from spinline.network.lateral import lateral_limit
from spinline.plan.effects.effect import Effect
from spinline.plan.estimates import Estimate
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.jetprofile.jet import Jet
    from spinline.network_models.rung import Rung
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["EFFECT", "LateralTime", "lateral_words"]


def lateral_words(scene: Scene, solution: Solution, jet: "Jet") -> str:
    """What Eq. (39) takes for granted in a scene, in words; empty where that is not known or does not matter."""
    context = Context(scene, solution, jet).frames[-1]
    found = EFFECT.estimate(context, None)
    return found.words if found.error > scene.accuracy.rtol else ""


class LateralTime(Effect):
    """``F = c k_B T t/(xi_eff mu r_0^2)`` at the crossover, or at the end of a jet that does not reach it."""

    name = "lateral time"
    symbol = "F at the crossover"

    def estimate(self, context: Context, known: "EffectNumbers | None") -> Estimate:
        """By r_P/r of Eq. (39) against that of the lateral equation: 1 where F << 1, `lateral_limit` where F >> 1."""
        from spinline.network.state import affine_network

        if not context.straight:
            return self._nothing("not estimated along bead jets")
        f = context.lateral_time
        if np.isnan(f):
            return self._nothing(f"alpha_v is {context.coupling.words}")
        n, jet = context.scene.network, context.line  # Eq. (39) is of the force closure, at V
        v = np.array([1.0, float(jet.velocity_ratio(context.lateral_place))])
        walk = affine_network(
            v, context.solution.volume_fraction, closure="force", solvent_quality=n.solvent_quality
        ).conformation.radial_contraction
        q = float(walk[1] / walk[0]) if walk[0] > 0 else float("nan")
        slow = 1.0 if f < 1 else float(lateral_limit(max(q, 1e-300), v[1]))
        if not q > 0:
            return Estimate(self.name, self.symbol, f, 1.0, "the strands are at their contour")
        words = (
            f"F = {f:.2g} with a drag of xi mu a bead ({f / (6 * np.pi):.2g} by Stokes): Eq. (39) has r_P/r = {q:.3g}, the "
            f"lateral equation {slow:.3g}; Eq. (39) needs a lateral tension beyond f_0"
        )
        return Estimate(self.name, self.symbol, f, abs(slow / q - 1), words)

    def held(self, context: Context, rung: "Rung", automatic: bool) -> bool:
        """Where the scene asks for the lateral equation."""
        return bool(context.scene.network.lateral) and context.straight


EFFECT = LateralTime()
