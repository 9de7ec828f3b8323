"""The units that scenes use, exact, and the grammar of a unit: bounded, so that no text can run away with the machine.

``unit = ["1"] { ["*" | "/" | " "] name [["^" | "**"] power] }``, one pair of round brackets behind a ``/``; a power is a
number of at most 9. What follows a ``/`` up to the next sign is below the line: ``J/mol/K``. Names that are not in this
table are left to pint (`spinline.base.units`), within the same grammar.
"""

import itertools
import math
import re
from fractions import Fraction
from functools import lru_cache

from spinline.base.constants import EPS0

__all__ = ["LONGEST", "Factor", "factors", "scale_and_dimension", "spelled_otherwise"]

LONGEST = 80  # characters of a unit
_MOST = 16  # names in one
_STEEPEST = 9

Dimension = tuple[Fraction, ...]  # powers of kg, m, s, A, K, mol
Factor = tuple[str, Fraction]

_AXES = ("kg", "m", "s", "A", "K", "mol")
_TOKEN = re.compile(
    r"\s*(?:(?P<name>[A-Za-z%°µμÅΩ_]+)\s*(?:(?:\^|\*\*)\s*)?(?P<power>\(?[-+]?\d{1,3}(?:\.\d{1,3}|/\d)?\)?)?"
    r"|(?P<sign>[*/.·])|(?P<open>\()|(?P<close>\))|(?P<one>1(?![\d.])))"
)


def factors(unit: str) -> list[Factor] | None:
    """Names of a unit with their powers; None for text that is no unit, or one beyond all bounds."""
    if len(unit) > LONGEST:
        return None
    found: list[Factor] = []
    at, below, inside, fresh = 0, False, False, True  # fresh: a name may follow, no sign
    text = unit.strip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            return None
        at = match.end()
        if match["sign"] or match["open"]:
            if match["open"]:
                if inside or not below or not fresh:
                    return None
                inside = True
                continue
            if fresh:
                return None
            below = (match["sign"] == "/") if not inside else below
            if inside and match["sign"] == "/":
                return None
            fresh = True
        elif match["close"]:
            if not inside or fresh:
                return None
            inside = below = False
        elif match["one"]:
            if found or not fresh:
                return None
            fresh = False
        else:
            power = _power(match["power"])
            if power is None:
                return None
            found.append((match["name"], -power if below else power))
            below = below and inside
            fresh = False
    return None if fresh or inside or len(found) > _MOST else found


def _power(text: str | None) -> Fraction | None:
    if text is None:
        return Fraction(1)
    bare = text.strip("()")
    if (text.startswith("(") != text.endswith(")")) or ("/" in bare and not text.startswith("(")):
        return None
    try:
        power = Fraction(bare.lstrip("+"))
    except (ValueError, ZeroDivisionError):
        return None
    return power if abs(power) <= _STEEPEST and power != 0 else None


def scale_and_dimension(found: list[Factor]) -> tuple[float, Dimension] | None:
    """Number of SI units in a unit, and its powers of kg, m, s, A, K, mol; None where a name is not in the table."""
    exact, rest = Fraction(1), 1.0
    powers = [Fraction(0)] * len(_AXES)
    for name, power in found:
        known = _known(name)
        if known is None:
            return None
        scale, dimension = known
        if isinstance(scale, Fraction) and power.denominator == 1:
            exact *= scale ** int(power)
        else:
            rest *= float(scale) ** float(power)
        powers = [p + power * d for p, d in zip(powers, dimension, strict=True)]
    try:
        return float(exact) * rest, tuple(powers)
    except OverflowError:
        return None


def _known(name: str) -> tuple[Fraction | float, Dimension] | None:
    if name in _UNITS:
        return _UNITS[name]
    for prefix, factor in _PREFIXES.items():
        bare = name.removeprefix(prefix)
        if bare != name and bare in (_LONG if len(prefix) > 2 else _SHORT):
            scale, dimension = _UNITS[bare]
            return scale * factor, dimension
    return None


def spelled_otherwise(unit: str) -> list[str]:
    """Units that differ from this text in capitals and small letters only, at most 64."""
    names = list(dict.fromkeys(re.findall(r"[A-Za-zµΩÅ]+", unit)))
    choices = [[name, *sorted(_by_letters().get(name.casefold(), ()))] for name in names]
    if not names or math.prod(map(len, choices)) > 64:
        return []
    found = []
    for taken in itertools.product(*choices):
        text = _swapped(unit, dict(zip(names, taken, strict=True)))
        if text != unit and text not in found:
            found.append(text)
    return found


def _swapped(unit: str, names: dict[str, str]) -> str:
    return re.sub(r"[A-Za-zµΩÅ]+", lambda match: names[match[0]], unit)


@lru_cache(maxsize=1)
def _by_letters() -> dict[str, set[str]]:
    """Names with and without prefix, by their small letters."""
    every = set(_UNITS)
    for bases, long in ((_SHORT, False), (_LONG, True)):
        every |= {prefix + base for prefix in _PREFIXES if (len(prefix) > 2) == long for base in bases}
    found: dict[str, set[str]] = {}
    for name in every:
        found.setdefault(name.casefold(), set()).add(name)
    return found


def _of(**powers: int) -> Dimension:
    return tuple(Fraction(powers.get(axis, 0)) for axis in _AXES)


_PREFIXES = {
    name: Fraction(10) ** power
    for names, power in (
        (("giga", "G"), 9),
        (("mega", "M"), 6),
        (("kilo", "k"), 3),
        (("hecto", "h"), 2),
        (("deca", "da"), 1),
        (("deci", "d"), -1),
        (("centi", "c"), -2),
        (("milli", "m"), -3),
        (("micro", "u", "µ", "μ"), -6),
        (("nano", "n"), -9),
        (("pico", "p"), -12),
        (("femto", "f"), -15),
        (("atto", "a"), -18),
    )
    for name in names
}

_F = Fraction
_FORCE, _PRESSURE, _ENERGY = _of(kg=1, m=1, s=-2), _of(kg=1, m=-1, s=-2), _of(kg=1, m=2, s=-2)
_CHARGE, _VOLT = _of(A=1, s=1), _of(kg=1, m=2, s=-3, A=-1)
_STATC = math.sqrt(1e-9 * 4.0 * math.pi * EPS0)  # C: unit charges 1 cm apart repel with 1 dyn
_DALTON = 1.66053906892e-27  # kg, CODATA 2022

_UNITS: dict[str, tuple[Fraction | float, Dimension]] = {}
_SHORT: set[str] = set()  # take m, u, k
_LONG: set[str] = set()  # take milli, micro, kilo


def _add(names: str, scale: Fraction | float, dimension: Dimension, takes: str = "") -> None:
    for name in names.split():
        _UNITS[name] = (scale, dimension)
        if takes:
            (_LONG if len(name) > 3 and name not in ("statC", "statV") else _SHORT).add(name)


_add("m meter meters metre metres", _F(1), _of(m=1), "p")
_add("micron microns", _F(1, 10**6), _of(m=1))
_add("angstrom angstroms Å", _F(1, 10**10), _of(m=1))
_add("inch inches", _F(254, 10000), _of(m=1))
_add("g gram grams", _F(1, 1000), _of(kg=1), "p")
_add("t tonne tonnes", _F(1000), _of(kg=1))
_add("Da dalton daltons", _DALTON, _of(kg=1), "p")
_add("s sec second seconds", _F(1), _of(s=1), "p")
_add("min minute minutes", _F(60), _of(s=1))
_add("h hr hrs hour hours", _F(3600), _of(s=1))
_add("d day days", _F(86400), _of(s=1))
_add("Hz hertz", _F(1), _of(s=-1), "p")
_add("l L liter liters litre litres", _F(1, 1000), _of(m=3), "p")
_add("cc", _F(1, 10**6), _of(m=3))
_add("N newton newtons", _F(1), _FORCE, "p")
_add("dyn dyne dynes", _F(1, 10**5), _FORCE)
_add("Pa pascal pascals", _F(1), _PRESSURE, "p")
_add("bar bars", _F(10**5), _PRESSURE)
_add("mbar millibar", _F(100), _PRESSURE)
_add("atm atmosphere atmospheres", _F(101325), _PRESSURE)
_add("torr", _F(101325, 760), _PRESSURE)
_add("Torr", _F(101325, 760), _PRESSURE)
_add("J joule joules", _F(1), _ENERGY, "p")
_add("erg ergs", _F(1, 10**7), _ENERGY)
_add("eV", _F(1602176634, 10**28), _ENERGY, "p")
_add("W watt watts", _F(1), _of(kg=1, m=2, s=-3), "p")
_add("P poise", _F(1, 10), _of(kg=1, m=-1, s=-1), "p")
_add("St stokes", _F(1, 10**4), _of(m=2, s=-1), "p")
_add("V volt volts", _F(1), _VOLT, "p")
_add("statV statvolt", 1e-7 / _STATC, _VOLT)
_add("C coulomb coulombs", _F(1), _CHARGE, "p")
_add("statC statcoulomb esu franklin Fr", _STATC, _CHARGE)
_add("A ampere amperes", _F(1), _of(A=1), "p")
_add("S siemens", _F(1), _of(kg=-1, m=-2, s=3, A=2), "p")
_add("ohm ohms Ω", _F(1), _of(kg=1, m=2, s=-3, A=-2), "p")
_add("F farad farads", _F(1), _of(kg=-1, m=-2, s=4, A=2), "p")
_add("K kelvin", _F(1), _of(K=1), "p")
_add("mol mole moles", _F(1), _of(mol=1), "p")
