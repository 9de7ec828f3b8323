"""Quantities as people write them, turned into SI numbers: the only place that knows pint, and only for rare units.

A quantity is text with its unit: "125 um", "3.2 mL/hour", "25 degC", "5 wt%", "600 kDa", "125 +/- 3 um". Gaussian CGS is
understood where it means something else than SI: "270 1/s" as a conductivity, "44000 statC/cm3", "30 statV",
"2 statV/cm". A bare number where a unit is due is an error that says which unit. How numbers, ``+/-`` and units stand in
the text: `spinline.base.quantity_text`.
"""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from spinline.base.constants import AVOGADRO, EPS0
from spinline.base.errors import InputError
from spinline.base.quantity_text import PERCENT, Written, trouble, written
from spinline.base.unit_table import factors, scale_and_dimension, spelled_otherwise

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

# "% w/v", "(w/v) %", "% m/v", "g/100 mL"
_WEIGHT_BY_VOLUME = re.compile(
    r"%\s*\(?(?:wt?|m)/vo?l?\)?|\(?(?:wt?|m)/vo?l?\)?\s*%|g\s*(?:/|per)\s*100\s*(?:ml|cm\^?3|cm³|cc)", re.IGNORECASE
)
_LONGEST = 200  # characters of a quantity
_SPELLED = {"℃": "degC", "℉": "degF", "μ": "µ", "ℓ": "l", "∕": "/", "⁄": "/"} | dict.fromkeys("·⋅∙•", "*")
_SPELLED |= dict.fromkeys("⁻−", "-") | {raised: str(i) for i, raised in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")}
_DEGREES = re.compile(r"(?:[°º˚]|deg(?:rees?)?)\s*(?P<scale>[CF])|(?P<name>celsius|fahrenheit)", re.IGNORECASE)
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
    found = written(text) if len(text) <= _LONGEST else None
    if found is None:
        problem, remedy = (trouble(text) if len(text) <= _LONGEST else None) or ("", "")
        starts = len(text) <= _LONGEST and text.strip().lstrip("(+-")[:1].isdigit()
        problem = problem or f"is not {'one' if starts else 'a'} number with a unit"
        raise InputError(field, problem, value=text, remedy=remedy or _example(quantity))
    if not np.isfinite(found.value):
        raise InputError(field, "is not finite", value=text, remedy=_example(quantity))
    if not (0 <= found.std < np.inf):
        raise InputError(field, "has no usable uncertainty", value=text, remedy=_example(quantity))
    if found.std_unit == "":
        both = f"{found.value:g} +/- {found.std:g} {found.unit}"
        raise InputError(
            field, "has an uncertainty without a unit", value=text, remedy=f'write "{both}", if that is meant'
        )
    share = quantity.unit == "" or (kind == "concentration" and PERCENT in found.unit)
    value, std = (_share if share else _dimensional)(found, kind, text, field)
    return Measured(value, std, text)


def _share(found: Written, kind: str, text: str, field: str) -> tuple[float, float]:
    """A pure number or a share, or a concentration in per cent: per cent behind ``+/-`` may be points or a part of it."""
    own = found.std_unit
    if kind == "number" and PERCENT in (found.unit, own) and found.std > 0:  # "1 +/- 5 %": a number has no points
        unit = "" if own is None else found.unit
        return found.value * _scale_of_share(unit, kind, text, field), 0.01 * found.std * abs(found.value)
    scale = _scale_of_share(found.unit, kind, text, field)
    if own is None and PERCENT in found.unit and 0 < found.value < 1 < found.std:
        shares, points = f"{100 * found.value:g} +/- {found.std:g} %", f"{found.value:g} % +/- {found.std:g} %"
        problem = "may be a share with per cent points, or below one per cent"
        raise InputError(field, problem, value=text, remedy=f'write "{shares}", or "{points}"')
    if own == PERCENT != found.unit:
        points, part = f"{found.std:g}", f"{0.01 * found.std * abs(found.value):.3g}"
        remedy = f'write "{found.value:g} +/- {points} {found.unit}", or "{found.value:g} +/- {part} {found.unit}"'
        raise InputError(field, "has an uncertainty of points or of a part of it", value=text, remedy=remedy)
    return found.value * scale, found.std * (scale if own is None else _scale_of_share(own, kind, text, field))


def _scale_of_share(unit: str, kind: str, text: str, field: str) -> float:
    if kind == "concentration":
        if _WEIGHT_BY_VOLUME.fullmatch(unit):
            return 10.0  # grams in 100 mL
        return parse_unit(unit, kind, field, text)[0]
    return _fraction_scale(unit, kind, text, field)


def _dimensional(found: Written, kind: str, text: str, field: str) -> tuple[float, float]:
    """What has a unit, in SI: ``+/-`` is in that unit, in another one of the kind, or per cent of the value."""
    quantity, own = QUANTITIES[kind], found.std_unit
    if own is None and found.unit == PERCENT and found.std > 0:
        unit = quantity.example.split(" ", 1)[1]
        remedy = f'write for example "{found.value:g} {unit} +/- {found.std:g} %"'
        raise InputError(
            field, f"needs a unit before its +/-, as {quantity.article} {kind} has", value=text, remedy=remedy
        )
    if not found.unit:
        problem = f"needs a unit, as {quantity.article} {kind} has"
        raise InputError(field, problem, value=text, remedy=_example(quantity))
    if kind == "concentration" and _WEIGHT_BY_VOLUME.fullmatch(found.unit):
        scale, offset = 10.0, 0.0
    else:
        scale, offset = parse_unit(found.unit, kind, field, text)
    if own == PERCENT:
        if offset:
            degrees = f'"{found.value:g} +/- {0.01 * found.std * abs(found.value):.2g} {found.unit}"'
            problem = "has per cent of a temperature that does not count from absolute zero"
            raise InputError(field, problem, value=text, remedy=f"write degrees, for example {degrees}")
        return found.value * scale, 0.01 * found.std * abs(found.value * scale)
    other = scale if own is None or own == found.unit else parse_unit(own, kind, field, text)[0]
    return found.value * scale + offset, found.std * abs(other)


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
            remedy=_meant(_spell(unit), kind) or _example(quantity),
        )
    return found


def _meant(unit: str, kind: str) -> str:
    """What a unit of the kind is written like that differs in capitals only: KV."""
    if kind == "temperature" and unit.upper() in ("C", "F"):
        return f"write deg{unit.upper()}"
    if kind == "viscosity" and unit.lower() in ("cps", "cpoise"):
        return "write cP"
    if kind == "velocity" and unit in ("rpm", "1/min", "min^-1", "min-1", "rev/min"):
        return (
            "write m/s, pi times the diameter times the turns: a drum of 10 cm at 3000 rpm has 15.7 m/s at its surface"
        )
    others = [one for one in spelled_otherwise(unit) if not _converted(one, kind)[1]]
    return f"units keep capitals and small letters apart: write {' or '.join(others[:3])}" if others else ""


@lru_cache(maxsize=256)
def _converted(unit: str, kind: str) -> tuple[tuple[float, float], str]:
    """Scale and offset, and what is wrong: "", the text is no "unit", a "name" is not known, the unit is of an "other" kind."""
    nothing = (1.0, 0.0)
    parts = None if PERCENT in unit else factors(unit)
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


# how else people write them, in small letters without blanks, brackets, points and hyphens
_ALSO_PERCENT = {
    symbol: own
    for own, symbols in (
        ("wt%", "wt% w% w/w% m% m/m% wt/wt% mass% gew% ma% weight%"),
        ("wt%", "%wt %w %w/w %m %m/m %wt/wt %mass %byweight %bymass weightpercent wtpercent wtpct masspercent"),
        ("vol%", "vol% v% v/v% vol/vol% volume% %vol %v %v/v %vol/vol %byvolume volumepercent"),
        ("%", "% percent percents pct"),
    )
    for symbol in symbols.split()
}
_HUMID = ("%rh", "rh%", "%relativehumidity", "%humidity")


def _fraction_scale(unit: str, kind: str, text: str, field: str) -> float:
    own = _FRACTIONS[kind]
    short = re.sub(r"[\s().-]", "", unit).lower().replace("percentby", "%by")
    unit = _ALSO_PERCENT.get(short, unit)
    if not unit:
        return 1.0
    if own and (unit in (PERCENT, own) or (kind == "fraction" and short in _HUMID)):
        return 0.01
    other = next((name for name, symbol in _FRACTIONS.items() if symbol == unit), None)
    if kind == "mass fraction" and re.search(
        r"[gwt]\s*/\s*(100\s*)?(v|m?l|d?l|cm|m\^?3)", unit.lower().replace("m/v", "w/v")
    ):
        raise InputError(
            field,
            "is mass in a volume of solution, not a mass fraction",
            value=text,
            remedy='divide it by the density of the solution: of 0.95 g/mL, 12 % w/v (0.12 g/mL) are "12.6 wt%"',
        )
    problem = f"is {QUANTITIES[other].article} {other}, not a {kind}" if other else f"has a unit, but a {kind} has none"
    raise InputError(field, problem, value=text, remedy=_example(QUANTITIES[kind]))


@lru_cache(maxsize=256)
def _spell(unit: str) -> str:
    for old, new in _SPELLED.items():
        unit = unit.replace(old, new)
    degrees = _DEGREES.fullmatch(unit)
    if degrees:
        return f"deg{(degrees['scale'] or degrees['name'])[0].upper()}"
    unit = re.sub(r"^/", "1/", re.sub(r"\s+per\s+", "/", unit))
    return re.sub(r"^([mkµu]?Pa)-?s$", r"\1*s", unit)  # mPas, as rheometers print it


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
