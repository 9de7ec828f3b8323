"""Which effects a run includes: what the scene asks for, and for "auto" what exceeds rtol and has its data.

Never in silence: every choice comes with a sentence, kept in the result's attributes.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.errors import InputError
from spinline.plan.estimates import MARGIN
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.jetprofile.straight import StraightJet
    from spinline.plan.governing_numbers import EffectNumbers

__all__ = ["NAMES", "Effects", "choose_effects"]

NAMES = ("evaporation", "relaxation", "radial")
_FIXED = ("manifold", "chain", "walk")  # rungs without relaxation


@dataclass(frozen=True)
class Effects:
    """What is included, why, and the numbers behind it (None where nothing asked for them)."""

    evaporation: bool = False
    relaxation: bool = False
    radial: bool = False
    why: dict[str, str] = field(default_factory=dict)
    numbers: "EffectNumbers | None" = None

    @property
    def any(self) -> bool:
        """Something is included."""
        return self.evaporation or self.relaxation or self.radial

    @property
    def left_out(self) -> list[str]:
        """Names of what is not."""
        words = {"evaporation": "evaporation", "relaxation": "relaxation", "radial": "radial gradients"}
        return [words[name] for name in ("relaxation", "evaporation", "radial") if not getattr(self, name)]


def choose_effects(
    scene: Scene, solution: Solution, jet: "StraightJet | LagrangianJet", numbers: "EffectNumbers | None" = None
) -> Effects:
    """Effects of a scene whose rung is chosen (`plan`); `numbers` if they are known.

    Raises
    ------
    InputError
        Where an effect is asked for and its data are missing, or the model cannot hold it.
    """
    asked, model = scene.effects, scene.network.model
    _refuse(scene, solution)
    idle = scene.ambient is None and solution.relaxation_time is None and model != "conformation"
    if idle and not any(getattr(asked, name) is True for name in NAMES):
        reasons = {"evaporation": "there is no [ambient]", "relaxation": "solution.relaxation_time is not given",
                   "radial": "there is no evaporation"}  # fmt: skip
        why = {name: "off: set so" if getattr(asked, name) is False else f"off: {reasons[name]}" for name in NAMES}
        return Effects(why=why)
    from spinline.plan.governing_numbers import effect_numbers

    numbers = effect_numbers(scene, solution, jet) if numbers is None else numbers
    rtol, on, why = scene.accuracy.rtol, dict.fromkeys(NAMES, False), {}
    for name in NAMES:
        on[name], why[name] = _decide(getattr(asked, name), numbers.errors[name], numbers.missing.get(name, ""), rtol)
    if model == "conformation":
        on["relaxation"], why["relaxation"] = True, 'on: network.model = "conformation"'
    elif on["relaxation"] and asked.relaxation == "auto" and model != "auto":
        on["relaxation"] = False
        why["relaxation"] = f'off: network.model = "{model}" has none; it would matter, {why["relaxation"][4:]}'
    if on["radial"] and not on["evaporation"]:
        if asked.radial is True and asked.evaporation == "auto":
            on["evaporation"], why["evaporation"] = True, "on: effects.radial = true needs it"
        else:
            on["radial"], why["radial"] = False, "off: there is no evaporation"
    if on["evaporation"] and scene.ambient is None:
        why["evaporation"] += "; air of the property library, at the temperature of the solution"
    _check_data(scene, solution, on)
    return Effects(on["evaporation"], on["relaxation"], on["radial"], why, numbers)


def _check_data(scene: Scene, solution: Solution, on: dict[str, bool]) -> None:
    """Refuse what a run would refuse, before it runs."""
    from spinline.drying.along_jet import check_radial
    from spinline.setup.air import build_air
    from spinline.setup.material import build_material, diffusion_law, glass_fraction

    if on["evaporation"]:
        air = build_air(scene, solution)
        glass_fraction(scene, solution)
        if on["radial"]:
            diffusion_law(scene)
            check_radial(air)
    if any(on.values()):
        build_material(scene, solution)


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


def _refuse(scene: Scene, solution: Solution) -> None:
    asked, model = scene.effects, scene.network.model
    relaxing = asked.relaxation is True or model == "conformation"
    if relaxing and solution.relaxation_time is None:
        field = "effects.relaxation = true" if asked.relaxation is True else 'network.model = "conformation"'
        raise InputError(
            "solution.relaxation_time", f"is missing: {field} needs it",
            remedy='give it, for example relaxation_time = "10 ms" in [solution]',
        )  # fmt: skip
    if asked.relaxation is False and model == "conformation":
        raise InputError("effects.relaxation", 'is off, and network.model = "conformation" is relaxation', value=False,
                         remedy='take model = "affine", or drop it')  # fmt: skip
    if asked.relaxation is True and model in ("affine", *_FIXED):
        raise InputError("effects.relaxation", f'is not in network.model = "{model}"', value=True,
                         allowed='"auto", false', remedy='take model = "conformation" or "auto"')  # fmt: skip
    if asked.radial is True and asked.evaporation is False:
        raise InputError("effects.radial", "needs evaporation, which is off", value=True,
                         remedy="set effects.evaporation = true")  # fmt: skip
