"""Uncertain inputs through a run: the standard uncertainty of every number of the result.

Inputs written with ``+/-`` are taken as independent; each is moved by one standard uncertainty to both sides, the run repeated
by the same rung, and half the difference is its share: ``std^2 = sum (f(x + s) - f(x - s))^2 / 4``. First order: right where
numbers are straight lines over the uncertainty, which two runs cannot tell; a number not reached on one side has none.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr
from pydantic import BaseModel

from spinline.errors import InputError
from spinline.scene import Scene
from spinline.units import Measured

__all__ = ["propagated", "uncertain_inputs"]


def uncertain_inputs(scene: Scene) -> dict[str, Measured]:
    """Keys of a scene that carry ``+/-``, by their path in it."""
    return dict(_walk(scene, ""))


def propagated(
    scene: Scene, result: xr.Dataset, again: Callable[[Scene], xr.Dataset]
) -> tuple[dict[str, Any], list[str]]:
    """Standard uncertainties of the numbers of a result.

    Parameters
    ----------
    scene : Scene
        Its rung chosen, so that a repetition takes the same.
    result : xarray.Dataset
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
    names = [str(name) for name, variable in result.data_vars.items() if variable.ndim == 0]
    total, remarks = dict.fromkeys(names, 0.0), []
    for key, measured in uncertain_inputs(scene).items():
        sides: list[tuple[float, xr.Dataset]] = []
        for sign in (1.0, -1.0):
            try:
                sides.append((sign, again(_moved(scene, key, measured.value + sign * measured.std))))
            except InputError:
                continue
        if not sides:
            remarks.append(f"{key} cannot be moved by its uncertainty ({measured.text}): it is not in the errors")
            continue
        if len(sides) == 1:
            remarks.append(f"{key} can be moved by its uncertainty ({measured.text}) to one side only")
            sides.append((0.0, result))
        (high, one), (low, other) = sides
        for name in names:
            total[name] += ((float(one[name]) - float(other[name])) / (high - low)) ** 2
    return {f"{name}_std": float(np.sqrt(value)) for name, value in total.items()}, remarks


def _walk(section: BaseModel, path: str) -> Iterator[tuple[str, Measured]]:
    for name in type(section).model_fields:
        value = getattr(section, name)
        if isinstance(value, BaseModel):
            yield from _walk(value, f"{path}{name}.")
        elif isinstance(value, Measured) and value.std > 0:
            yield f"{path}{name}", value


def _moved(scene: Scene, key: str, value: float) -> Scene:
    """The scene with one quantity at another value, without its uncertainty."""

    def within(section: BaseModel, steps: list[str]) -> BaseModel:
        name, rest = steps[0], steps[1:]
        inner = getattr(section, name)
        return section.model_copy(update={name: within(inner, rest) if rest else Measured(value, 0.0, f"{value!r}")})

    moved = within(scene, key.split("."))
    assert isinstance(moved, Scene)
    if value <= 0:
        raise InputError(key, "is not positive once moved by its uncertainty", value=value)
    return moved
