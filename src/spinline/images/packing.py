"""Numbers that a file of frames keeps packed, by netCDF's attributes: what they stand for, and which stand for nothing.

    value = scale_factor raw + add_offset

`_FillValue`, `missing_value`, and what lies outside valid_min, valid_max or valid_range (all of them raw) are no
measurement. `_Unsigned` says that a signed type holds numbers without sign, which classic netCDF has no type for.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Array

__all__ = ["Packing", "packing_of"]

# other conventions' names, with the number at which they do nothing: which law they mean is not said, so they are not obeyed
_FOREIGN = {"scaling_factor": 1.0, "slope": 1.0, "bscale": 1.0, "intercept": 0.0, "offset": 0.0, "bzero": 0.0}
_NAMES = ("scale_factor", "add_offset", "_FillValue", "missing_value", "valid_min", "valid_max", "valid_range")


@dataclass(frozen=True)
class Packing:
    """How a variable is packed.

    Attributes
    ----------
    scale, offset : float
    fill : tuple of float
        Raw numbers that are no measurement.
    low, high : float
        Raw numbers outside are none either.
    unsigned : bool
        Whole numbers are without sign, whatever their type says.
    """

    scale: float = 1.0
    offset: float = 0.0
    fill: tuple[float, ...] = ()
    low: float = -np.inf
    high: float = np.inf
    unsigned: bool = False

    def unpacked(self, block: Array) -> Array:
        """Raw numbers as what they stand for; what is no measurement as NaN."""
        kind = block.dtype
        if self.unsigned and kind.kind == "i":
            block = block.view(kind.str.replace("i", "u"))
        out = block.astype(np.float64)
        empty = np.isin(block, [v for v in map(self._as(block.dtype), self.fill) if np.isfinite(v)])
        low, high = (self._as(block.dtype)(v) for v in (self.low, self.high))
        empty |= (out < low) | (out > high)
        out = out * self.scale + self.offset
        out[empty] = np.nan
        return out

    def _as(self, kind: np.dtype[Any]) -> Callable[[float], float]:
        """A raw number as a type holds it: rounded to a float of 32 bits, or without its sign."""
        if kind.kind == "f":
            return lambda value: (
                float(np.asarray(value).astype(kind)) if abs(value) < float(np.finfo(kind).max) else value
            )
        if self.unsigned and kind.kind == "u":
            return lambda value: value + 2.0 ** (8 * kind.itemsize) if -np.inf < value < 0.0 else value
        return lambda value: value


def packing_of(attribute: Callable[[str], Any], key: str, source: str) -> Packing | None:
    """How a variable is packed, from its attributes; None for a plain one.

    Parameters
    ----------
    attribute : callable
        The value of an attribute by name, None where there is none.
    key, source : str
        For errors.

    Raises
    ------
    InputError
        For an attribute that is no number, a scale of 0, or an attribute by which another convention packs.
    """
    _no_foreign(attribute, key, source)
    word = attribute("_Unsigned")
    word = word.decode() if isinstance(word, bytes) else word
    unsigned = str(word).strip().lower() in ("true", "1")
    numbers = {name: _numbers(name, value, key, source) for name in _NAMES if (value := attribute(name)) is not None}
    if not numbers and not unsigned:
        return None
    scale = numbers.get("scale_factor", [1.0])[0]
    if scale == 0.0:
        raise InputError(
            key, "has a scale_factor of 0", value=source, allowed="!= 0", remedy="mend or remove the attribute"
        )
    span = numbers.get("valid_range", [-np.inf, np.inf])
    fill = (*numbers.get("_FillValue", []), *numbers.get("missing_value", []))
    return Packing(
        scale,
        numbers.get("add_offset", [0.0])[0],
        fill,
        numbers.get("valid_min", span[:1])[0],
        numbers.get("valid_max", span[-1:])[0],
        unsigned,
    )


def _no_foreign(attribute: Callable[[str], Any], key: str, source: str) -> None:
    """Refuse numbers that another convention packs."""
    for name, idle in _FOREIGN.items():
        for spelled in (name, name.upper(), name.capitalize()):
            value = attribute(spelled)
            try:
                number = float(np.ravel(value)[0]) if value is not None and np.size(value) == 1 else idle
            except (TypeError, ValueError):
                number = idle
            if number != idle:
                raise InputError(
                    key,
                    f"has an attribute {spelled}, which may pack its numbers in a way that is not known here",
                    value=f"{source}: {number:g}",
                    allowed="scale_factor and add_offset, as in netCDF",
                    remedy="rename it to one of those, or write the unpacked numbers without it",
                )


def _numbers(name: str, value: Any, key: str, source: str) -> list[float]:
    """The numbers of an attribute; scale and offset finite."""
    try:
        numbers = [float(v) for v in np.ravel(np.asarray(value.decode() if isinstance(value, bytes) else value))]
    except (TypeError, ValueError, UnicodeDecodeError):
        numbers = []
    packs = name in ("scale_factor", "add_offset")
    if not numbers or (packs and not np.isfinite(numbers).all()) or (name == "valid_range" and len(numbers) != 2):
        raise InputError(
            key,
            f"has an attribute {name} that is no number",
            value=f"{source}: {value}",
            remedy="mend or remove the attribute",
        )
    return numbers
