"""What varies in a sweep: ``[vary]`` of the sweep file turned into axes, every mistake by its key."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.scene.keys import full_key, is_section, read_value, reader
from spinline.study.design import Axis, Column

__all__ = ["axes_of", "column", "not_both"]

_FORMS = ("values", "linspace", "logspace", "uniform", "loguniform")
_MOST_STEPS = 10**7


def axes_of(vary: Mapping[str, Any]) -> list[Axis]:
    """Axes of a sweep file's ``[vary]``.

    Raises
    ------
    InputError
        For a key or a value that cannot be right.
    """
    axes = []
    for key, form in _flat(vary):
        field = f"vary.{key}"
        name = full_key(key, field)
        if len(form) != 1 or next(iter(form)) not in _FORMS:
            raise InputError(
                field,
                "needs one way to vary",
                value=form,
                allowed=", ".join(_FORMS),
                remedy='for example { linspace = ["3 wt%", "8 wt%", 6] }',
            )
        ((how, given),) = form.items()
        axes.append(_axis(name, how, given, f"{field}.{how}"))
    keys = [axis.key for axis in axes]
    for key in keys:
        if keys.count(key) > 1:
            raise InputError(f"vary.{key}", "is there twice", remedy="keep one")
    return axes


def _axis(key: str, how: str, given: Any, field: str) -> Axis:
    if not isinstance(given, list):
        raise InputError(field, "is not a list", value=given, remedy="put it in [ ]")
    if how == "values":
        if not given:
            raise InputError(field, "is empty", remedy="give at least one value")
        return Axis(key, column([read_value(key, value, field, exact=True) for value in given]))
    if reader(key) is None:
        raise InputError(field, f"needs a number, and {key} holds words", value=given, remedy="give values = [...]")
    steps = how in ("linspace", "logspace")
    if len(given) != (3 if steps else 2):
        allowed = "[from, to, number]" if steps else "[low, high]"
        raise InputError(field, "has the wrong length", value=given, allowed=allowed, remedy="write it so")
    low, high = (read_value(key, end, field, exact=True) for end in given[:2])
    if isinstance(low, str) or isinstance(high, str):
        raise InputError(field, "needs two numbers", value=given, remedy="give values = [...]")
    if how in ("logspace", "loguniform") and not (low > 0 and high > 0):
        raise InputError(
            field,
            "cannot be spaced by logarithms: an end is not positive",
            value=given,
            remedy=f"take {how.replace('log', 'lin' if steps else '')}",
        )
    if not steps:
        if not low < high:
            raise InputError(field, "does not rise", value=given, allowed="[low, high]", remedy="swap the ends")
        return Axis(key, np.array([low, high], dtype=np.float64), "log" if how == "loguniform" else "linear")
    number = given[2]
    if isinstance(number, bool) or not isinstance(number, int) or not 1 <= number <= _MOST_STEPS:
        raise InputError(
            field,
            "needs a whole number of steps",
            value=number,
            allowed=f"1 to {_MOST_STEPS}",
            remedy='for example ["3 wt%", "8 wt%", 6]',
        )
    space = np.linspace if how == "linspace" else np.geomspace
    return Axis(key, np.asarray(space(low, high, number), dtype=np.float64))


def column(values: Sequence[Any]) -> Column:
    """Values as floats, or as objects where any is a word or a table."""
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=np.float64)
    objects = np.empty(len(values), dtype=object)
    for i, value in enumerate(values):
        objects[i] = float(value) if isinstance(value, int) and not isinstance(value, bool) else value
    return objects


def _flat(vary: Mapping[str, Any], before: str = "") -> list[tuple[str, dict[str, Any]]]:
    """``jet.k = {...}`` with and without quotes is one key."""
    found = []
    for key, value in vary.items():
        name = f"{before}{key}"
        if isinstance(value, dict) and is_section(name):
            found += _flat(value, f"{name}.")
        elif isinstance(value, dict):
            found.append((name, value))
        elif isinstance(value, list):
            found.append((name, {"values": value}))
        else:
            raise InputError(
                f"vary.{name}",
                "is one value: nothing varies",
                value=value,
                allowed=", ".join(_FORMS),
                remedy=f"set it in the scene, or with --set {name}=VALUE",
            )
    return found


def not_both(keys: list[str]) -> None:
    """Refuse two keys of which one sets the other."""
    for one, other in (
        ("solution.mass_fraction", "solution.volume_fraction"),
        ("jet.k", "jet.electric_field"),
        ("jet.k", "jet.conductivity"),
    ):
        if one in keys and other in keys:
            raise InputError(f"vary.{one}", f"varies beside {other}: one sets the other", remedy="drop one of them")
