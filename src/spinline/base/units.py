"""Quantities as people write them, turned into SI numbers: the only place that knows pint, and only for rare units.

A quantity is text with its unit: "125 um", "3.2 mL/hour", "25 degC", "5 wt%", "600 kDa", "125 +/- 3 um". Gaussian CGS is
understood where it means something else than SI: "270 1/s" as a conductivity, "44000 statC/cm3", "30 statV",
"2 statV/cm". A bare number where a unit is due is an error that says which unit.
"""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from spinline.base.constants import AVOGADRO, EPS0
from spinline.base.errors import InputError
from spinline.base.unit_table import factors, scale_and_dimension

__all__ = ["QUANTITIES", "Measured", "Quantity", "parse", "parse_unit"]

_4_PI_EPS0 = 4 * np.pi * EPS0  # F/m: Gaussian conductivity (1/s) to S/m


@dataclass(frozen=True)
class Quantity:
    """What a kind of quantity needs: its SI unit, examples of text, and words for the error."""

    name: str
    unit: str
    example: str
    article: str = "a"


@dataclass(frozen=True)
class Measured:
    """A number in SI units with its standard uncertainty (0 where none was given) and the text it came from."""

    value: float
    std: float = 0.0
    text: str = ""


QUANTITIES = {
    q.name: q
    for q in (
        Quantity("length", "m", "125 um"),
        Quantity("angle", "rad", "3 deg", "an"),
        Quantity("velocity", "m/s", "2 cm/s"),
        Quantity("flow rate", "m^3/s", "3.2 mL/hour"),
        Quantity("time", "s", "25 ms"),
        Quantity("rate", "1/s", "100 1/s"),
        Quantity("temperature", "K", "25 degC"),
        Quantity("density", "kg/m^3", "1.13 g/cm3"),
        Quantity("concentration", "kg/m^3", "50 g/L"),
        Quantity("molar mass", "kg/mol", "600 kDa"),
        Quantity("heat capacity", "J/(kg K)", "2.4 kJ/kg/K"),
        Quantity("heat of vaporisation", "J/kg", "0.52 MJ/kg"),
        Quantity("molar enthalpy", "J/mol", "8.66 kJ/mol"),
        Quantity("viscosity", "Pa*s", "2 Pa s"),
        Quantity("diffusivity", "m^2/s", "2.5e-5 m2/s"),
        Quantity("velocity diffusivity", "m^2/s^3", "10 m2/s3"),
        Quantity("intrinsic viscosity", "m^3/kg", "0.3 m3/kg", "an"),
        Quantity("pressure", "Pa", "1 atm"),
        Quantity("surface tension", "N/m", "21.1 dyn/cm"),
        Quantity("force", "N", "1 nN"),
        Quantity("energy", "J", "10 keV", "an"),
        Quantity("mass attenuation", "m^2/kg", "5.1 cm2/g"),
        Quantity("volume", "m^3", "1 pL"),
        Quantity("electric field", "V/m", "0.6 kV/cm", "an"),
        Quantity("magnetic field", "T", "50 mT"),
        Quantity("potential", "V", "9 kV"),
        Quantity("current", "A", "200 nA"),
        Quantity("acceleration", "m/s^2", "9.81 m/s2", "an"),
        Quantity("charge density", "C/m^3", "44000 statC/cm3"),
        Quantity("conductivity", "S/m", "0.01 S/m"),
        Quantity("mass fraction", "", "5 wt%"),
        Quantity("volume fraction", "", "4.4 vol%"),
        Quantity("fraction", "", "40 %"),
        Quantity("number", "", "1e3"),
    )
}
_FRACTIONS = {"mass fraction": "wt%", "volume fraction": "vol%", "fraction": "%", "number": ""}

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:inf(?:inity)?|nan)"
_TEXT = re.compile(
    rf"\s*(?P<value>{_NUMBER})\s*(?:(?:\+/-|\+-|±)\s*(?P<std>{_NUMBER}))?\s*(?P<unit>.*?)\s*", re.IGNORECASE
)
_WEIGHT_BY_VOLUME = re.compile(r"%\s*\(?wt?/vo?l?\)?|\(?wt?/vo?l?\)?\s*%", re.IGNORECASE)  # "% w/v", "w/v %"
_LONGEST = 200  # characters of a quantity
_SPELLED = {"°C": "degC", "℃": "degC", "°F": "degF", "℉": "degF", "μ": "µ", "·": "*", "⋅": "*", "⁻": "-", "−": "-"} | {
    raised: str(i) for i, raised in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")
}
_PRINTED = str.maketrans({"−": "-", "\u00a0": " ", "\u202f": " ", "\u2009": " "})
_TWICE = re.compile(
    rf"\s*(?P<value>{_NUMBER})\s*(?P<unit>[^\d\s+\-±]\S*)\s*(?:\+/-|\+-|±)\s*(?P<std>{_NUMBER})\s*(?P<again>\S+)\s*",
    re.IGNORECASE,
)
_OFFSET = {"degC": (1.0, 273.15), "celsius": (1.0, 273.15), "degF": (5 / 9, 459.67 * 5 / 9)}
_PER_SECOND: Any = (0, 0, -1, 0, 0, 0)  # powers of kg, m, s, A, K, mol
_MASS: Any = (1, 0, 0, 0, 0, 0)


def parse(text: Any, kind: str, field: str) -> Measured:
    """Read a quantity.

    Parameters
    ----------
    text : str, or number
        "125 +/- 3 um". A number only for fractions and pure numbers.
    kind : str
        A key of `QUANTITIES`.
    field : str
        Name shown in errors.

    Returns
    -------
    Measured
        In the SI unit of the kind.

    Raises
    ------
    InputError
        For a missing or wrong unit, or text that is no quantity.
    """
    quantity = QUANTITIES[kind]
    if isinstance(text, Measured):
        return text
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise InputError(field, f"is not {quantity.article} {kind}", value=text, remedy=_example(quantity))
    if not isinstance(text, str):
        if quantity.unit:
            raise InputError(
                field, f"needs a unit, as {quantity.article} {kind} has", value=text, remedy=_example(quantity)
            )
        if not np.isfinite(text):
            raise InputError(field, "is not finite", value=text, remedy=_example(quantity))
        return Measured(float(text), 0.0, str(text))
    match = _TEXT.fullmatch(_said_once(text.translate(_PRINTED))) if len(text) <= _LONGEST else None
    if match is None:
        raise InputError(field, "is not a number with a unit", value=text, remedy=_example(quantity))
    value, unit = float(match["value"]), match["unit"]
    std = float(match["std"]) if match["std"] else 0.0
    if not np.isfinite(value):
        raise InputError(field, "is not finite", value=text, remedy=_example(quantity))
    if unit[:1].isdigit() and not unit.startswith("1/"):
        raise InputError(field, "is not one number with a unit", value=text, remedy=_example(quantity))
    if not (0 <= std < np.inf):
        raise InputError(field, "has no usable uncertainty", value=text, remedy=_example(quantity))
    if kind == "concentration" and _WEIGHT_BY_VOLUME.fullmatch(unit):
        return Measured(10 * value, 10 * std, text)  # grams in 100 mL
    if not quantity.unit:
        scale = _fraction_scale(unit, kind, text, field)
        return Measured(value * scale, std * scale, text)
    if not unit:
        raise InputError(
            field, f"needs a unit, as {quantity.article} {kind} has", value=text, remedy=_example(quantity)
        )
    scale, offset = parse_unit(unit, kind, field, text)
    return Measured(value * scale + offset, std * abs(scale), text)


def parse_unit(unit: str, kind: str, field: str, text: str | None = None) -> tuple[float, float]:
    """Scale and offset that turn a number in a unit into SI.

    Parameters
    ----------
    unit : str
        Unit alone, "cm" or "degC".
    kind, field : str
        As for `parse`.
    text : str, optional
        What the user wrote, for the error.

    Returns
    -------
    scale, offset : float
        ``SI = scale * number + offset``; the offset is zero but for temperatures.
    """
    quantity = QUANTITIES[kind]
    found, problem = _converted(_spell(unit), kind)
    if problem:
        words = {
            "unit": f"is not {quantity.article} {kind}: its unit is not known ({unit})",
            "name": f"has a unit that is not known ({unit})",
        }
        raise InputError(
            field,
            words.get(problem, f"is not {quantity.article} {kind}"),
            value=unit if text is None else text,
            allowed=f"units of {quantity.unit}",
            remedy=_example(quantity),
        )
    return found


@lru_cache(maxsize=256)
def _converted(unit: str, kind: str) -> tuple[tuple[float, float], str]:
    """Scale and offset, and what is wrong: "", the text is no "unit", a "name" is not known, the unit is of an "other" kind."""
    nothing = (1.0, 0.0)
    parts = factors(unit)
    if parts is None:
        return nothing, "unit"
    if kind == "temperature" and unit.startswith("delta"):
        return nothing, "other"  # a difference is no temperature
    if kind == "temperature" and unit in _OFFSET:
        return _OFFSET[unit], ""
    known = scale_and_dimension(parts)
    if known is None:
        return _by_pint("*".join(f"{name}**({power})" for name, power in parts), kind)
    scale, dimension = known
    if not 0 < scale < np.inf:
        return nothing, "other"
    if kind == "conductivity" and dimension == _PER_SECOND:
        return (scale * _4_PI_EPS0, 0.0), ""
    if kind == "molar mass" and dimension == _MASS:
        return (scale * AVOGADRO, 0.0), ""
    return ((scale, 0.0), "") if dimension == _dimension(kind) else (nothing, "other")


@lru_cache(maxsize=64)
def _dimension(kind: str) -> Any:
    parts = factors(QUANTITIES[kind].unit)
    known = None if parts is None else scale_and_dimension(parts)
    assert known is not None  # the units of QUANTITIES are all in the table
    return known[1]


def _by_pint(unit: str, kind: str) -> tuple[tuple[float, float], str]:
    """A unit whose names and powers are bounded, by pint."""
    import pint

    registry, nothing = _registry(), (1.0, 0.0)
    try:
        parsed = registry.parse_units(unit)
        dimension = registry.get_dimensionality(parsed)
    except Exception:  # pint raises what its parser happens to raise
        return nothing, "name"
    try:
        if kind == "conductivity" and dimension == {"[time]": -1}:
            return (_plain(registry, parsed, "1/s") * _4_PI_EPS0, 0.0), ""
        if kind == "molar mass" and dimension == {"[mass]": 1}:
            return (_plain(registry, parsed, "kg") * AVOGADRO, 0.0), ""
        if kind == "temperature":
            zero = float(registry.Quantity(0.0, parsed).to("K").magnitude)
            return (float(registry.Quantity(1.0, parsed).to("K").magnitude) - zero, zero), ""
        scale = _plain(registry, parsed, QUANTITIES[kind].unit)
    except (pint.PintError, ArithmeticError, KeyError, ValueError, TypeError):
        return nothing, "other"
    return ((scale, 0.0), "") if 0 < scale < np.inf else (nothing, "other")


def _plain(registry: Any, unit: Any, target: str) -> float:
    one = registry.Quantity(1.0, unit)
    if target == "C/m^3":  # the Gaussian context knows charges, not their densities
        one, target = one * registry.Quantity(1.0, "m^3"), "C"
    with registry.context("Gaussian"):
        return float(one.to(target).magnitude)


def _said_once(text: str) -> str:
    """Text such as "125 um +/- 3 um" as "125 +/- 3 um"; other text as it is."""
    match = _TWICE.fullmatch(text)
    if match is None or match["unit"] != match["again"]:
        return text
    return f"{match['value']} +/- {match['std']} {match['unit']}"


# how else people write them, without blanks, brackets and points
_ALSO_PERCENT = {
    **dict.fromkeys(("%w/w", "w/w%", "%wt", "%m/m", "m/m%", "wt/wt%", "%wt/wt"), "wt%"),
    **dict.fromkeys(("%v/v", "v/v%", "%vol"), "vol%"),
}


def _fraction_scale(unit: str, kind: str, text: str, field: str) -> float:
    own = _FRACTIONS[kind]
    unit = re.sub(r"^(wt|vol)\.\s*%$", r"\1%", unit)
    unit = _ALSO_PERCENT.get(re.sub(r"[\s().]", "", unit), unit)
    if not unit:
        return 1.0
    if own and unit in ("%", own, own.replace("%", " %")):
        return 0.01
    other = next((name for name, symbol in _FRACTIONS.items() if symbol == unit), None)
    if kind == "mass fraction" and re.search(r"[gwt]\s*/\s*(100\s*)?(v|m?l|d?l|cm|m\^?3)", unit.lower()):
        raise InputError(
            field,
            "is mass in a volume of solution, not a mass fraction",
            value=text,
            remedy='divide it by the density of the solution: of 0.95 g/mL, 12 % w/v (0.12 g/mL) are "12.6 wt%"',
        )
    problem = f"is {QUANTITIES[other].article} {other}, not a {kind}" if other else f"has a unit, but a {kind} has none"
    raise InputError(field, problem, value=text, remedy=_example(QUANTITIES[kind]))


def _spell(unit: str) -> str:
    for old, new in _SPELLED.items():
        unit = unit.replace(old, new)
    return re.sub(r"^([mkµu]?Pa)s$", r"\1*s", unit)  # mPas, as rheometers print it


def _example(quantity: Quantity) -> str:
    if not quantity.unit:
        return f"for example {quantity.example}" if quantity.name == "number" else f'for example "{quantity.example}"'
    return f'write it as text, for example "{quantity.example}"'


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    try:
        return pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=":auto:")
    except OSError:  # no place for a cache: 0.3 s slower
        return pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)
