"""Effects, one file each: the number that decides, its estimate, its switch, what a run needs for it.

`EFFECTS` names them once, in the order of a plan. A new effect is one file that ends in ``EFFECT = MyEffect()``, its line here,
and its key in ``[effects]`` of the scene file.
"""

from spinline.plan.effects import (
    bending,
    disentanglement,
    elastic_coupling,
    evaporation,
    extensibility,
    heat,
    inertia,
    lateral,
    radial,
    relaxation,
    saturation,
)
from spinline.plan.effects.effect import Effect

__all__ = ["EFFECTS", "SWITCHED", "Effect", "effect_of"]

EFFECTS: tuple[Effect, ...] = (
    elastic_coupling.EFFECT,
    inertia.EFFECT,
    relaxation.EFFECT,
    disentanglement.EFFECT,
    evaporation.EFFECT,
    heat.EFFECT,
    radial.EFFECT,
    extensibility.EFFECT,
    saturation.EFFECT,
    lateral.EFFECT,
    bending.EFFECT,
)
SWITCHED: tuple[Effect, ...] = tuple(effect for effect in EFFECTS if effect.switch)


def effect_of(name: str) -> Effect:
    """An effect by its name in a plan."""
    return next(effect for effect in EFFECTS if effect.name == name)
