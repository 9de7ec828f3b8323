"""Which physics a scene needs, and the number that decides: the cheapest rung whose estimated error is within rtol.

Two branches leave the affine network: elastic slip (manifold; its finest is the chain) and relaxation (conformation). A rung
holds one of them; where both would err by more than rtol the plan takes the larger and says that no model holds both.
Evaporation and radial gradients go with any rung. Finite extensibility of the *network* is a reason to change the rung only
where the scene names a `force_law`; saturation is in every rung.

Estimates (`estimates`) lie within a factor of two of the error that the finer rung shows, nineteen times in twenty, and never
far below it (``benchmarks/estimates.py``); they are taken 1.2 times before they are compared with rtol.
"""

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.jetprofile.straight import StraightJet
from spinline.plan.estimates import (
    MARGIN,
    UNSTEADY,
    Effect,
    elastic_coupling_effect,
    extensibility_effect,
    inertia_effect,
    saturation_effect,
)
from spinline.plan.governing_numbers import EffectNumbers, effect_numbers
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["MARGIN", "Plan", "plan_scene", "resolved"]

_HELD = {  # by each rung
    "affine": (),
    "manifold": ("elastic coupling", "inertia", "finite extensibility"),
    "chain": ("elastic coupling", "inertia", "finite extensibility"),
    "conformation": ("relaxation",),
    "walk": (),
}
_MOVING = ("elastic coupling", "relaxation")
_COSTS = {
    "affine": "a millisecond",
    "manifold": "10 to 60 ms",
    "conformation": "5 to 20 ms",
    "chain": "seconds",
    "walk": "0.1 ms a place and thousand strands",
}


@dataclass(frozen=True)
class Plan:
    """What a run takes, what it leaves out, and why.

    Attributes
    ----------
    model : str
        Rung of the ladder.
    forced : bool
        The scene names it.
    effects : tuple of Effect
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
    """

    model: str
    forced: bool
    effects: tuple[Effect, ...]
    used: tuple[str, ...]
    left_out: tuple[str, ...]
    rtol: float
    numbers: EffectNumbers
    reason: str
    remarks: tuple[str, ...]

    def effect(self, name: str) -> Effect:
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
        }

    def json(self) -> str:
        """`plain` as text, NaN as null."""
        return json.dumps(self.plain(), ensure_ascii=False, allow_nan=False)


def plan_scene(
    scene: Scene, solution: Solution, jet: "StraightJet | LagrangianJet", numbers: EffectNumbers | None = None
) -> Plan:
    """Choose the rung of a scene.

    Parameters
    ----------
    scene, solution, jet
        A scene and what `build_solution` and `build_jet` make of it; of a bead jet with many times the last is looked at.
    numbers : EffectNumbers, optional
        If they are known already.

    Returns
    -------
    Plan

    Notes
    -----
    A few milliseconds; about 10 where there is an ``[ambient]``.
    """
    if not isinstance(jet, StraightJet) and jet.time is not None:
        jet = jet.at()
    known = effect_numbers(scene, solution, jet) if numbers is None else numbers
    effects = _effects(scene, solution, jet, known)
    rtol, asked = scene.accuracy.rtol, scene.network.model
    errors = {effect.name: effect.error for effect in effects}
    wanted = _choice(scene, errors, rtol, effects[0].number)
    model = wanted if asked == "auto" else asked
    used = [*_HELD[model], "saturation"]
    if not isinstance(jet, StraightJet):
        used.append("bending")
    dries, uneven = _drying(scene, errors, rtol)
    used += [name for name, on in (("evaporation", dries), ("radial gradients", uneven)) if on]
    if model == "manifold" and not _names_a_law(scene) and asked == "auto":
        used.remove("finite extensibility")
    if not scene.network.inertia.value and "inertia" in used:
        used.remove("inertia")
    left_out = tuple(effect.name for effect in effects if effect.name not in used)
    reason, remarks = _words(scene, model, wanted, effects, left_out)
    return Plan(
        model,
        asked != "auto",
        effects,
        tuple(e.name for e in effects if e.name in used),
        left_out,
        rtol,
        known,
        reason,
        remarks,
    )


def resolved(scene: Scene, plan: Plan) -> Scene:
    """The scene with the rung of its plan in place of "auto"."""
    if scene.network.model == plan.model:
        return scene
    changes: dict[str, Any] = {"model": plan.model}
    if plan.model == "manifold" and not _names_a_law(scene):
        changes["force_law"] = "linear"
    return scene.model_copy(update={"network": scene.network.model_copy(update=changes)})


def _effects(
    scene: Scene, solution: Solution, jet: "StraightJet | LagrangianJet", known: EffectNumbers
) -> tuple[Effect, ...]:
    dried, uneven, lost = known.errors["evaporation"], known.errors["radial"], known.evaporated_fraction
    drying = (
        Effect("evaporation", "volume lost", lost, dried, known.missing.get("evaporation", f"{lost:.2g} of the volume")),
        Effect("radial gradients", "drying Peclet", known.drying_peclet, uneven,
               known.missing.get("radial", f"surface and mean differ by {uneven:.2g} of the mean")),
    )  # fmt: skip
    if isinstance(jet, StraightJet):
        return (
            elastic_coupling_effect(scene, solution, jet),
            inertia_effect(scene, solution, jet, known.inertia),
            known.relaxation,
            *drying,
            extensibility_effect(scene, solution, jet),
            saturation_effect(scene, solution, jet),
            Effect("bending", "bead jet", 0.0, float("nan"), "a straight profile: the first millimetres"),
        )
    nan, words = float("nan"), "not estimated along bead jets"
    return (
        Effect("elastic coupling", "c V'/alpha_v", nan, nan, words),
        Effect("inertia", "I V'", nan, nan, words),
        known.relaxation,
        *drying,
        Effect("finite extensibility", "V/V_S at the end", nan, nan, words),
        Effect("saturation", "core fraction, held at 1", known.core_fraction, 0.0, "in every rung"),
        Effect("bending", "bead jet", 1.0, 0.0, "the material stretch of the beads drives the network, bent or not"),
    )


def _choice(scene: Scene, errors: dict[str, float], rtol: float, steepest: float) -> str:
    """Rung for a scene; `steepest` is the largest eps V', beyond 1/4 of which nothing is steady."""
    elastic, relaxing = errors["elastic coupling"], errors["relaxation"]
    slips = MARGIN * elastic > rtol and steepest <= UNSTEADY
    relaxes = MARGIN * relaxing > rtol and scene.effects.relaxation is not False
    if scene.effects.relaxation is True:
        return "conformation"
    if _names_a_law(scene) or (slips and not (relaxes and relaxing >= elastic)):
        return "manifold" if not np.isnan(elastic) else "affine"
    # a solution that dries relaxes by other times than it set out with: the rung that can hold that, if the time is known
    dries = _switched(scene.effects.evaporation, errors["evaporation"], rtol) and MARGIN * errors["evaporation"] > rtol
    knows = not np.isnan(relaxing) and scene.effects.relaxation is not False
    return "conformation" if relaxes or (dries and knows) else "affine"


def _names_a_law(scene: Scene) -> bool:
    return "force_law" in scene.network.model_fields_set


def _drying(scene: Scene, errors: dict[str, float], rtol: float) -> tuple[bool, bool]:
    """Evaporation and radial gradients, which need it, as `choose_effects` takes them."""
    asked = scene.effects
    dries, uneven = (
        _switched(switch, errors[name], rtol)
        for switch, name in ((asked.evaporation, "evaporation"), (asked.radial, "radial gradients"))
    )
    if uneven and not dries and asked.radial is True and asked.evaporation == "auto":
        dries = True
    return dries, uneven and dries


def _switched(switch: object, error: float, rtol: float) -> bool:
    return bool(switch is True or (switch == "auto" and MARGIN * error > rtol))


def _words(
    scene: Scene, model: str, wanted: str, effects: tuple[Effect, ...], left_out: tuple[str, ...]
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
    reason = f"{model}: {said}; rtol = {rtol:g}"
    if scene.network.model not in ("auto", model, wanted):
        reason += f"; asked for, {wanted} would be taken"
    elif scene.network.model != "auto":
        reason += "; asked for" + (
            "" if wanted == model else f" ({_COSTS[model]}); {wanted} would do ({_COSTS[wanted]})"
        )
    remarks = []
    if "elastic coupling" in missed and model != "conformation":
        finer = (
            "no steady network there, see --model chain"
            if known["elastic coupling"].number > UNSTEADY
            else ("see --model manifold")
        )
        remarks.append(
            f"the affine network errs by about {errors['elastic coupling']:.2g} without elastic coupling, more than "
            f"rtol = {rtol:g}: {finer}"
        )
    if "relaxation" in missed:
        remarks.append(
            f"relaxation is left out: De = {known['relaxation'].number:.3g} at the crossover (or the end of the jet), so the "
            f"stretch errs by about {errors['relaxation']:.2g}, more than rtol = {rtol:g}"
        )
    if len(missed) == 2 or (missed and model in ("manifold", "chain", "conformation")):
        remarks.append(
            f"no model holds both elastic coupling (error of about {errors['elastic coupling']:.2g}) and relaxation "
            f"({errors['relaxation']:.2g}) within rtol = {rtol:g}: compare manifold and conformation"
        )
    return reason, tuple(remarks)


def _plain(effect: Effect) -> dict[str, Any]:
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
