"""What is wrong with a file, in words: one error from all that pydantic found."""

import difflib
from collections.abc import Mapping
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from spinline.base.errors import InputError
from spinline.base.units import Measured
from spinline.rheology.constitutive import LAWS
from spinline.scene.advice import instead, usual
from spinline.scene.air_and_rheology import AmbientSection, EffectsSection, RheologySection
from spinline.scene.mat_sections import CollectorSection, JetsSection, MatSection
from spinline.scene.sections import (
    JET_SECTIONS,
    AccuracySection,
    NetworkSection,
    PolymerData,
    Scene,
    SolutionSection,
    SolventData,
)

__all__ = ["explain"]


def explain(error: ValidationError, name: str, data: Mapping[str, Any], root: type[BaseModel]) -> InputError:
    """One InputError from all that pydantic found in a file whose top is `root`."""
    details = error.errors(include_url=False)
    lines = list(dict.fromkeys(str(_problem(detail, data, root)) for detail in _foremost(details)))
    first = _problem(_foremost(details)[0], data, root)
    if len(lines) == 1:
        return first
    return InputError(name, f"has {len(lines)} problems:\n  " + "\n  ".join(lines))


def _foremost(details: list[ErrorDetails]) -> list[ErrorDetails]:
    """Of the branches of a union keep the one that speaks of the value, not of its type."""
    best: dict[str, ErrorDetails] = {}
    for detail in details:
        key = _key(detail)
        if key not in best or best[key]["type"] in _TYPE_ERRORS:
            best[key] = detail
    kept = [d for k, d in best.items() if d["type"] not in _TYPE_ERRORS or not any(o.startswith(f"{k}.") for o in best)]
    return kept or list(best.values())


_TYPE_ERRORS = frozenset(
    {"string_type", "literal_error", "model_type", "dict_type", "list_type", "float_type", "bool_type"}
)


_FORMS = frozenset(
    {"name", "mixture", "properties", "str", "MeasuredOfRecipe"}
)  # branches of unions, as profiles are: no keys of the user's


def _key(detail: ErrorDetails) -> str:
    steps = [str(step) for step in detail["loc"]]
    kept = [
        step
        for i, step in enumerate(steps)
        if not (
            (step in _FORMS or step in JET_SECTIONS)
            and i == (2 if steps[0] == "solution" else 1)
            and not (detail["type"] == "extra_forbidden" and i == len(steps) - 1)  # a key of that name
        )
        and "[" not in step
    ]
    context = detail.get("ctx") or {}
    return ".".join([*kept, context["key"]] if "key" in context else kept) or "scene"


_NEEDLE = (
    'the needle\'s settings belong to profile = "needle" (voltage, gap, conductivity, surface_tension, permittivity, no k '
    "and beta); `spinline scenes --copy peo5-needle` gives one to start from"
)


_OF_A_NEEDLE = dict.fromkeys(
    (f"jet.{name}" for name in ("voltage", "gap", "distance", "surface_tension", "permittivity", "current")),
    _NEEDLE,
)


def _problem(detail: ErrorDetails, data: Mapping[str, Any], root: type[BaseModel]) -> InputError:
    key, kind, context = _key(detail), detail["type"], detail.get("ctx") or {}
    value = detail["input"]
    if isinstance(value, Measured):
        value = value.value
    if kind in ("quantity", "range", "refusal"):
        shown = None if kind == "refusal" else value
        remedy = context["remedy"] or ("" if kind == "refusal" else _change(key, root))
        return InputError(key, detail["msg"], value=shown, allowed=context["allowed"], remedy=remedy)
    if kind == "missing":
        return InputError(key, "is missing", remedy=usual(key, recipe="measured" in root.model_fields))
    if kind == "extra_forbidden":
        known = _known_keys(key, data, root)
        home, _, last = key.rpartition(".")
        near = _nearest(last, known)
        elsewhere = instead(last, value, known, _other_sections(home, data, root))
        if root is Scene and not elsewhere:
            elsewhere = _OF_A_NEEDLE.get(f"jet.{last}", "")
        hint = f"did you mean {near!r}?" if near else elsewhere or "take it out"
        return InputError(key, "is not a known key", value=value, allowed=", ".join(known), remedy=hint)
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        section = value if isinstance(value, Mapping) else {}
        problem = "is not known" if "profile" in section else "is missing"
        profiles = ", ".join(f'"{name}"' for name in JET_SECTIONS)
        return InputError(
            f"{key}.profile",
            problem,
            value=section.get("profile"),
            allowed=profiles,
            remedy=_change(f"{key}.profile", root),
        )
    allowed = str(context.get("expected", "")).replace("True", "true").replace("False", "false")
    if not allowed:
        words = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
        allowed = ", ".join(f"{words[k]} {v}" for k, v in context.items() if k in words)
    law = next((law for law in LAWS if law.lower() == str(value).lower()), "")
    if key == "network.model" and law:
        remedy = f'{law} is a law of the stress: [rheology] constitutive = "{law}", with network.model = "conformation"'
        return InputError(key, "is not known", value=value, allowed=allowed, remedy=remedy)
    message = "is not known" if kind == "literal_error" else detail["msg"].replace("Input should be", "should be")
    return InputError(key, message, value=value, allowed=allowed, remedy=_change(key, root))


# what people call a key that no spelling would find
_ALSO_CALLED = {
    **dict.fromkeys(
        (
            "distance",
            "collector_distance",
            "working_distance",
            "tip_to_collector_distance",
            "needle_to_collector_distance",
            "tip_collector_distance",
            "tcd",
        ),
        "gap",
    ),
    **dict.fromkeys(("v", "potential", "applied_voltage", "high_voltage", "hv"), "voltage"),
    **dict.fromkeys(("conc", "mass_fraction", "wt", "weight_fraction", "weight_percent", "c"), "concentration"),
    **dict.fromkeys(("t", "temp", "air_temperature"), "temperature"),
    **dict.fromkeys(("mw", "molecular_weight", "molecular_mass"), "molar_mass"),
    **dict.fromkeys(("rh", "humidity"), "relative_humidity"),
    **dict.fromkeys(("needle", "needle_gauge"), "gauge"),
    **dict.fromkeys(("type", "collector_type"), "kind"),
    **dict.fromkeys(("process", "spinning", "parameters"), "jet"),
    **dict.fromkeys(("environment", "air", "atmosphere"), "ambient"),
    **dict.fromkeys(("material", "materials"), "solution"),
    **dict.fromkeys(("feed_rate", "flow", "q", "feed", "pump_rate", "pumping_rate", "injection_rate"), "flow_rate"),
}


def _nearest(name: str, known: list[str]) -> str:
    """The known key that was meant, or nothing."""
    called = _ALSO_CALLED.get(name.lower(), "")
    if called in known:
        return called
    return next(iter(difflib.get_close_matches(name, known, n=1)), "")


def _other_sections(section: str, data: Mapping[str, Any], root: type[BaseModel]) -> dict[str, list[str]]:
    """Keys of the other sections of a file, by section."""
    names = [name for name in root.model_fields if name not in ("title", section)]
    if root is Scene and "profile" not in (data["jet"] if isinstance(data.get("jet"), Mapping) else {}):
        names = [name for name in names if name != "jet"]
    return {name: keys for name in names if (keys := _known_keys(f"{name}.", data, root)) != list(root.model_fields)}


def _change(key: str, root: type[BaseModel]) -> str:
    return f"change it in the {'scene' if root is Scene else 'file'}, or with --set {key}=VALUE"


def _known_keys(key: str, data: Mapping[str, Any], root: type[BaseModel]) -> list[str]:
    models: dict[str, type[BaseModel]] = {
        "solution": SolutionSection,
        "solution.polymer": PolymerData,
        "solution.solvent": SolventData,
        **{f"jet {name}": section for name, section in JET_SECTIONS.items()},
        "ambient": AmbientSection,
        "rheology": RheologySection,
        "effects": EffectsSection,
        "network": NetworkSection,
        "accuracy": AccuracySection,
        "collector": CollectorSection,
        "jets": JetsSection,
        "mat": MatSection,
    }
    section = key.rpartition(".")[0]
    if root is not Scene and section in root.model_fields:  # another sheet: its own sections
        kinds = [root.model_fields[section].annotation, *get_args(root.model_fields[section].annotation)]
        return [
            name
            for kind in kinds
            if isinstance(kind, type) and issubclass(kind, BaseModel)
            for name in kind.model_fields
        ]
    if section == "jet":
        section = f"jet {data['jet'].get('profile')}"
    return list(models.get(section, root).model_fields)
