"""Uncertain inputs through a run: the standard uncertainty of every number of the result.

Inputs written with ``+/-`` are taken as independent; each is moved by one standard uncertainty to both sides, the run repeated
by the same rung, and half the difference is its share: ``std^2 = sum (f(x + s) - f(x - s))^2 / 4``. First order: right where
numbers are straight lines over the uncertainty, which two runs cannot tell; a number not reached on one side has none.
`spinline.solve.bands` needs no straight line, and costs more runs.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from pydantic import BaseModel

from spinline.base.errors import InputError
from spinline.base.named_arrays import NamedArrays
from spinline.base.units import Measured
from spinline.scene.file import Scene
from spinline.scene.keys import reader
from spinline.scene.quantities import Read

__all__ = ["certain", "moved", "propagated", "shares", "uncertain_inputs"]


def uncertain_inputs(scene: Scene) -> dict[str, Measured]:
    """Keys of a scene that carry ``+/-``, by their path in it."""
    return dict(_walk(scene, ""))


def propagated(
    scene: Scene, result: NamedArrays, again: Callable[[Scene], NamedArrays]
) -> tuple[dict[str, Any], list[str]]:
    """Standard uncertainties of the numbers of a result.

    Parameters
    ----------
    scene : Scene
        Its rung chosen, so that a repetition takes the same.
    result : NamedArrays
        The run as it is.
    again : callable
        Repeats the run for a scene.

    Returns
    -------
    numbers : dict
        ``<name>_std`` to a number; NaN where it cannot be said.
    remarks : list of str
        Inputs that could be moved to one side only, or not at all.
    """

    def numbers(of: NamedArrays) -> dict[str, float]:
        return {str(name): float(variable) for name, variable in of.data_vars.items() if variable.ndim == 0}

    return shares(scene, numbers(result), lambda other: numbers(again(other)))


def shares(
    scene: Scene, values: Mapping[str, float], again: Callable[[Scene], Mapping[str, float]]
) -> tuple[dict[str, Any], list[str]]:
    """`propagated` of plain numbers: `values` as the scene is, `again` gives them for another."""
    total, remarks = dict.fromkeys(values, 0.0), []
    for key, measured in uncertain_inputs(scene).items():
        sides: list[tuple[float, Mapping[str, float]]] = []
        for sign in (1.0, -1.0):
            try:
                sides.append((sign, again(moved(scene, key, measured.value + sign * measured.std))))
            except InputError:
                continue
        if not sides:
            remarks.append(f"{key} cannot be moved by its uncertainty ({measured.text}): it is not in the errors")
            continue
        if len(sides) == 1:
            remarks.append(f"{key} can be moved by its uncertainty ({measured.text}) to one side only")
            sides.append((0.0, values))
        (high, one), (low, other) = sides
        for name in values:
            total[name] += ((one.get(name, np.nan) - other.get(name, np.nan)) / (high - low)) ** 2
    return {f"{name}_std": float(np.sqrt(value)) for name, value in total.items()}, remarks


def moved(scene: Scene, key: str, value: float) -> Scene:
    """The scene with one quantity at another value, without its uncertainty.

    Raises
    ------
    InputError
        If the value is out of the key's range.
    """
    how = reader(key)
    if isinstance(how, Read):
        inside = how.low <= value <= how.high if how.closed else how.low < value < how.high
        if not inside:
            raise InputError(key, "is out of range once moved by its uncertainty", value=value)
    return _with(scene, key, value)


def certain(scene: Scene) -> Scene:
    """The scene without its uncertainties."""
    for key, measured in uncertain_inputs(scene).items():
        scene = _with(scene, key, measured.value)
    return scene


def _with(scene: Scene, key: str, value: float) -> Scene:
    def within(section: BaseModel, steps: list[str]) -> BaseModel:
        name, rest = steps[0], steps[1:]
        inner = getattr(section, name)
        return section.model_copy(update={name: within(inner, rest) if rest else Measured(value, 0.0, f"{value!r}")})

    changed = within(scene, key.split("."))
    assert isinstance(changed, Scene)
    return changed


def _walk(section: BaseModel, path: str) -> Iterator[tuple[str, Measured]]:
    for name in type(section).model_fields:
        value = getattr(section, name)
        if isinstance(value, BaseModel):
            yield from _walk(value, f"{path}{name}.")
        elif isinstance(value, Measured) and value.std > 0:
            yield f"{path}{name}", value
