"""Which effects a run includes: what the scene asks for, and for "auto" what exceeds rtol and has its data.

Never in silence: every choice comes with a sentence, kept in the result's attributes.
"""

from typing import TYPE_CHECKING

import numpy as np

from spinline.base.errors import InputError
from spinline.network_models.registry import RUNGS, cheapest, rung_in, simplest
from spinline.plan.effects import EFFECTS, SWITCHED
from spinline.plan.estimates import MARGIN
from spinline.setup.context import Context
from spinline.setup.effects import Effects

if TYPE_CHECKING:
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["choose_effects"]


def choose_effects(context: Context, numbers: "EffectNumbers | None" = None) -> Effects:
    """Effects of a scene whose rung is chosen (`plan`); `numbers` if they are known.

    Raises
    ------
    InputError
        Where an effect is asked for and its data are missing, or the model cannot hold it.
    """
    scene, model = context.scene, context.scene.network.model
    rung = rung_in(scene.network) if model in RUNGS else None
    relaxes = rung is not None and rung.relaxes
    _refuse(context, relaxes)
    reasons = {effect.switch: effect.idle(context) for effect in SWITCHED}
    asked = {effect.switch: getattr(scene.effects, effect.switch) for effect in SWITCHED}
    if all(reasons.values()) and not relaxes and True not in asked.values():
        why = {key: "off: set so" if asked[key] is False else f"off: {reason}" for key, reason in reasons.items()}
        return Effects(why=why, left_out=_left_out({}))
    from spinline.plan.governing_numbers import numbers_of

    known = numbers_of(context) if numbers is None else numbers
    rtol, on, why = scene.accuracy.rtol, dict.fromkeys(asked, False), {}
    for effect in SWITCHED:
        error, missing = effect.error(context, known)
        on[effect.switch], why[effect.switch] = _decide(asked[effect.switch], error, missing, rtol)
    if relaxes:
        on["relaxation"], why["relaxation"] = True, f'on: network.model = "{model}"'
    elif on["relaxation"] and asked["relaxation"] == "auto" and rung is not None:
        on["relaxation"] = False
        why["relaxation"] = f'off: network.model = "{model}" has none; it would matter, {why["relaxation"][4:]}'
    for effect in SWITCHED:
        if not effect.after or not on[effect.switch] or on[effect.after]:
            continue
        if asked[effect.switch] is True and asked[effect.after] == "auto":
            on[effect.after], why[effect.after] = True, f"on: effects.{effect.switch} = true needs it"
        else:
            on[effect.switch], why[effect.switch] = False, f"off: there is no {effect.after}"
    if on["evaporation"] and scene.ambient is None:
        why["evaporation"] += "; air of the property library, at the temperature of the solution"
    for effect in SWITCHED:
        if on[effect.switch]:
            effect.check(context)
    if any(on.values()):
        _ = context.material
    return Effects(on, why, _left_out(on), known)


def _left_out(on: dict[str, bool]) -> tuple[str, ...]:
    return tuple(effect.name for effect in SWITCHED if not on.get(effect.switch, False))


def _decide(switch: object, error: float, missing: str, rtol: float) -> tuple[bool, str]:
    if switch is False:
        return False, "off: set so"
    size = "" if np.isnan(error) else f"leaving it out errs by about {error:.2g}, rtol = {rtol:g}"
    if switch is True:
        return True, f"on: set so{'; ' + size if size else ''}"
    if np.isnan(error):
        return False, f"off: {missing or 'no estimate'}"
    matters = MARGIN * error > rtol
    return matters, f"{'on' if matters else 'off'}: {size}"


def _refuse(context: Context, relaxes: bool) -> None:
    asked, model, solution = context.scene.effects, context.scene.network.model, context.solution
    if (asked.relaxation is True or relaxes) and solution.relaxation_time is None:
        field = "effects.relaxation = true" if asked.relaxation is True else f'network.model = "{model}"'
        raise InputError(
            "solution.relaxation_time",
            f"is missing: {field} needs it",
            remedy='give it, for example relaxation_time = "10 ms" in [solution]',
        )
    if asked.relaxation is False and relaxes:
        raise InputError(
            "effects.relaxation",
            f'is off, and network.model = "{model}" is relaxation',
            value=False,
            remedy=f'take model = "{simplest().name}", or drop it',
        )
    if asked.relaxation is True and not relaxes and model in RUNGS:
        able = cheapest(["relaxation"])
        other = "" if able is None else f'take model = "{able.name}" or "auto"'
        raise InputError(
            "effects.relaxation",
            f'is not in network.model = "{model}"',
            value=True,
            allowed='"auto", false',
            remedy=other,
        )
    for effect in EFFECTS:
        if effect.after and getattr(asked, effect.switch) is True and getattr(asked, effect.after) is False:
            raise InputError(
                f"effects.{effect.switch}",
                f"needs {effect.after}, which is off",
                value=True,
                remedy=f"set effects.{effect.after} = true",
            )
