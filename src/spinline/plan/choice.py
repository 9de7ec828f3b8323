"""Which physics a scene needs, and the number that decides: the cheapest rung whose estimated error is within rtol.

Two branches leave the affine network: elastic slip (manifold; its finest is the chain) and relaxation (conformation); where
both would err by more than rtol they meet in the two-fluid network.
Evaporation and radial gradients go with any rung. Finite extensibility of the *network* is a reason to change the rung only
where the scene names a `force_law`; saturation is in every rung.

Estimates (`estimates`) lie within a factor of two of the error that the finer rung shows, nineteen times in twenty, and never
far below it (``benchmarks/estimates.py``); they are taken 1.2 times before they are compared with rtol.
"""

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.network_models.registry import RUNGS, cheapest, rung_in, simplest
from spinline.network_models.rung import Rung
from spinline.plan.effects import EFFECTS, SWITCHED
from spinline.plan.estimates import MARGIN, Estimate
from spinline.plan.governing_numbers import EffectNumbers, numbers_of
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.jetprofile.ehd import Verdict
    from spinline.jetprofile.jet import Jet

__all__ = ["MARGIN", "Plan", "plan_of", "plan_scene", "resolved", "with_rung"]

_MOVING = tuple(effect.name for effect in EFFECTS if effect.moves)


@dataclass(frozen=True)
class Plan:
    """What a run takes, what it leaves out, and why.

    Attributes
    ----------
    model : str
        Rung of the ladder.
    forced : bool
        The scene names it.
    effects : tuple of Estimate
        Every effect with its number and the error of leaving it out.
    used, left_out : tuple of str
        Names of effects.
    rtol : float
    numbers : EffectNumbers
        What the estimates are made from.
    reason : str
        A sentence.
    remarks : tuple of str
        What the choice loses, or cannot hold.
    verdicts : tuple
        The numbers that decide about the jet of a needle (`spinline.jetprofile.ehd.Verdict`); empty for other jets.
    """

    model: str
    forced: bool
    effects: tuple[Estimate, ...]
    used: tuple[str, ...]
    left_out: tuple[str, ...]
    rtol: float
    numbers: EffectNumbers
    reason: str
    remarks: tuple[str, ...]
    verdicts: "tuple[Verdict, ...]" = ()

    def effect(self, name: str) -> Estimate:
        """One effect by name."""
        return next(effect for effect in self.effects if effect.name == name)

    @property
    def missed(self) -> tuple[str, ...]:
        """What moves the network, is left out, and errs by more than rtol."""
        return tuple(name for name in _MOVING if name in self.left_out and MARGIN * self.effect(name).error > self.rtol)

    def plain(self) -> dict[str, Any]:
        """For JSON: `model`, `effects_used`, `effects_left_out`, each effect with number, estimated error and reason."""

        def listed(names: tuple[str, ...]) -> list[dict[str, Any]]:
            return [_plain(self.effect(name)) for name in names]

        return {
            "model": self.model,
            "model_forced": self.forced,
            "rtol": self.rtol,
            "reason": self.reason,
            "effects_used": listed(self.used),
            "effects_left_out": listed(self.left_out),
            "remarks": list(self.remarks),
            **({"jet_verdicts": [asdict(one) for one in self.verdicts]} if self.verdicts else {}),
        }

    def json(self) -> str:
        """`plain` as text, NaN as null."""
        return json.dumps(self.plain(), ensure_ascii=False, allow_nan=False)


def plan_scene(scene: Scene, solution: Solution, jet: "Jet", numbers: EffectNumbers | None = None) -> Plan:
    """`plan_of` a scene and what `build_solution` and `build_jet` make of it."""
    return plan_of(Context(scene, solution, jet), numbers)


def plan_of(context: Context, numbers: EffectNumbers | None = None) -> Plan:
    """Choose the rung of a scene.

    Parameters
    ----------
    context : Context
        Of a bead jet with many times the last is looked at.
    numbers : EffectNumbers, optional
        If they are known already.

    Returns
    -------
    Plan

    Notes
    -----
    A few milliseconds; about 10 where there is an ``[ambient]``.
    """
    context = context.frames[-1]
    scene = context.scene
    rtol, asked = scene.accuracy.rtol, scene.network.model
    if asked in RUNGS:
        rung_in(scene.network).require(context)
    known = numbers_of(context) if numbers is None else numbers
    effects = tuple(effect.estimate(context, known) for effect in EFFECTS)
    errors = {effect.name: effect.error for effect in effects}
    wanted = _choice(scene, errors, rtol)
    rung = wanted if asked == "auto" else rung_in(scene.network)
    on = _switched_on(scene, errors, rtol)
    used = {
        effect.name
        for effect in EFFECTS
        if (on[effect.switch] if effect.switch and not effect.moves else effect.held(context, rung, asked == "auto"))
    }
    left_out = tuple(effect.name for effect in effects if effect.name not in used)
    reason, remarks = _words(scene, rung, wanted, effects, left_out)
    return Plan(
        rung.name,
        asked != "auto",
        effects,
        tuple(e.name for e in effects if e.name in used),
        left_out,
        rtol,
        known,
        reason,
        remarks,
        getattr(context.jet, "verdicts", ()),
    )


def resolved(scene: Scene, plan: Plan) -> Scene:
    """The scene with the rung of its plan in place of "auto"."""
    return with_rung(scene, RUNGS[plan.model])


def with_rung(scene: Scene, rung: Rung) -> Scene:
    """The scene with a rung in place of "auto"."""
    if scene.network.model == rung.name:
        return scene
    changes: dict[str, Any] = {"model": rung.name}
    if rung.slips and not _names_a_law(scene):
        changes["force_law"] = "linear"
    return scene.model_copy(update={"network": scene.network.model_copy(update=changes)})


def _choice(scene: Scene, errors: dict[str, float], rtol: float) -> Rung:
    """Rung for a scene, by the errors of leaving effects out."""
    elastic, relaxing = errors["elastic coupling"], errors["relaxation"]
    simple = simplest()
    slips = MARGIN * elastic > rtol
    relaxes = MARGIN * relaxing > rtol and scene.effects.relaxation is not False
    slipping, relaxed = cheapest(["elastic coupling"]) or simple, cheapest(["relaxation"]) or simple
    if scene.effects.disentanglement is True:
        return relaxed
    if (slips or (_names_a_law(scene) and not np.isnan(elastic))) and (relaxes or scene.effects.relaxation is True):
        return cheapest(["elastic coupling", "relaxation"]) or slipping
    if scene.effects.relaxation is True:
        return relaxed
    if _names_a_law(scene) or slips:
        return slipping if not np.isnan(elastic) else simple
    # a solution that dries relaxes by other times than it set out with: the rung that can hold that, if the time is known
    dries = _switched(scene.effects.evaporation, errors["evaporation"], rtol) and MARGIN * errors["evaporation"] > rtol
    knows = not np.isnan(relaxing) and scene.effects.relaxation is not False
    return relaxed if relaxes or (dries and knows) else simple


def _names_a_law(scene: Scene) -> bool:
    return "force_law" in scene.network.model_fields_set


def _switched_on(scene: Scene, errors: dict[str, float], rtol: float) -> dict[str, bool]:
    """Effects with a switch, and what they need, as `choose_effects` takes them; those that a rung holds apart."""
    asked = {effect.switch: getattr(scene.effects, effect.switch) for effect in SWITCHED}
    on = {effect.switch: _switched(asked[effect.switch], errors[effect.name], rtol) for effect in SWITCHED}
    for effect in SWITCHED:
        if effect.after and on[effect.switch] and not on[effect.after]:
            needed = asked[effect.switch] is True and asked[effect.after] == "auto"
            on[effect.after if needed else effect.switch] = needed
    return on


def _switched(switch: object, error: float, rtol: float) -> bool:
    return bool(switch is True or (switch == "auto" and MARGIN * error > rtol))


def _words(
    scene: Scene, rung: Rung, wanted: Rung, effects: tuple[Estimate, ...], left_out: tuple[str, ...]
) -> tuple[str, tuple[str, ...]]:
    rtol, known = scene.accuracy.rtol, {effect.name: effect for effect in effects}
    errors = {name: known[name].error for name in _MOVING}
    missed = [name for name in _MOVING if name in left_out and MARGIN * errors[name] > rtol]
    said = ", ".join(
        f"{name} would change it by about {errors[name]:.2g}"
        if not np.isnan(errors[name])
        else f"{name} is not estimated"
        for name in _MOVING
    )
    reason = f"{rung.name}: {said}; rtol = {rtol:g}"
    if scene.network.model not in ("auto", rung.name, wanted.name):
        reason += f"; asked for, {wanted.name} would be taken"
    elif scene.network.model != "auto":
        reason += "; asked for" + ("" if wanted is rung else f" ({rung.cost}); {wanted.name} would do ({wanted.cost})")
    return reason, tuple(_remarks(rung, rtol, known, errors, missed))


def _remarks(
    rung: Rung, rtol: float, known: dict[str, Estimate], errors: dict[str, float], missed: list[str]
) -> list[str]:
    """What a choice loses."""
    remarks = []
    steady, both = cheapest(["elastic coupling"]), cheapest(["elastic coupling", "relaxation"])
    if "elastic coupling" in missed and not rung.relaxes:
        remarks.append(
            f"the affine network errs by about {errors['elastic coupling']:.2g} without elastic coupling, more than "
            f"rtol = {rtol:g}: see --model {'' if steady is None else steady.name}"
        )
    if "relaxation" in missed:
        remarks.append(
            f"relaxation is left out: De = {known['relaxation'].number:.3g} at the crossover (or the end of the jet), so the "
            f"stretch errs by about {errors['relaxation']:.2g}, more than rtol = {rtol:g}"
        )
    if len(missed) == 2 or (missed and set(_MOVING) & set(rung.holds)):
        remarks.append(
            f"elastic coupling (error of about {errors['elastic coupling']:.2g}) and relaxation "
            f"({errors['relaxation']:.2g}) both matter at rtol = {rtol:g}: see --model {'' if both is None else both.name}"
        )
    return remarks


def _plain(effect: Estimate) -> dict[str, Any]:
    data = asdict(effect)
    return {
        "name": data["name"],
        "symbol": data["symbol"],
        "number": _finite(data["number"]),
        "estimated_error": _finite(data["error"]),
        "reason": data["words"],
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
