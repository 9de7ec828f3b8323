"""Columns of a table of experiments: their names as other hands write them, their units, and the numbers in their cells."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from spinline.base.errors import InputError
from spinline.base.quantity_text import written
from spinline.base.units import parse

__all__ = ["COLUMNS", "NOTHING", "Column", "columns_of", "number_in", "spread_in"]


@dataclass(frozen=True)
class _Known:
    """A column: kind and unit of its numbers ("" for words), and what else it is called."""

    kind: str
    unit: str
    called: tuple[str, ...]


COLUMNS: Mapping[str, _Known] = {
    "polymer": _Known("", "", ("polymer_name",)),
    "solvent": _Known("", "", ("solvents", "solvent_system")),
    "concentration_wt_percent": _Known(
        "mass fraction",
        "%",
        ("concentration", "conc", "polymer_concentration", "solution_concentration", "mass_fraction"),
    ),
    "needle_gauge": _Known("gauge", "", ("gauge", "needle_gauge_g", "needle_size_gauge")),
    "voltage_kV": _Known("potential", "kV", ("voltage", "applied_voltage", "high_voltage", "v")),
    "flow_rate_mL_per_h": _Known(
        "flow rate", "mL/h", ("flow_rate", "flowrate", "feed_rate", "feedrate", "flow", "pump_rate", "q")
    ),
    "distance_cm": _Known(
        "length",
        "cm",
        (
            "distance",
            "gap",
            "tcd",
            "tip_to_collector_distance",
            "needle_to_collector_distance",
            "collector_distance",
            "working_distance",
        ),
    ),
    "temperature_degC": _Known("temperature", "degC", ("temperature", "temp", "air_temperature", "t")),
    "relative_humidity_percent": _Known("fraction", "%", ("relative_humidity", "humidity", "rh")),
}
_GAUGE = re.compile(r"(?:G\s*)?(\d\d?)(?:\.0*)?\s*-?\s*(?:G|ga|gauge)?", re.IGNORECASE)
NOTHING = frozenset(("na", "n/a", "n.a.", "nan", "n.d.", "nd", "n.r.", "nr", "none", "null", "unknown", "unspecified"))
NOTHING |= {"-", "--", "---", "–", "—", ".", "?", "#n/a", "#div/0!", "#value!"}
NOTHING |= {f"not {word}" for word in ("given", "reported", "specified", "stated", "known", "measured")}
_AS_IN_THE_ROOM = frozenset(("rt", "r.t.", "room temperature", "room temp", "room temp.", "room", "ambient", "lab"))


@dataclass(frozen=True)
class Column:
    """A column as it is kept: its name, and scale and offset that turn its numbers into the unit of that name."""

    name: str
    scale: float = 1.0
    offset: float = 0.0

    def cell(self, text: str | None, comma: bool) -> str:
        """Text of a cell: nothing for what means nothing, decimal commas as points, numbers in the column's own unit."""
        bare = (text or "").strip()
        if bare.lower() in NOTHING:
            return ""
        if self.name in ("temperature_degC", "relative_humidity_percent") and bare.lower() in _AS_IN_THE_ROOM:
            return ""
        if comma and (self.name in COLUMNS or self.name.endswith(("_nm", "drum_rpm"))) and _numeric(self.name):
            bare = re.sub(r"(?<=\d),(?=\d)", ".", bare)
        if (self.scale, self.offset) == (1.0, 0.0):
            return bare
        try:
            return f"{float(bare) * self.scale + self.offset:.12g}"
        except ValueError:
            return bare


def _numeric(name: str) -> bool:
    return name not in ("polymer", "solvent")


def columns_of(head: Sequence[str], file: str) -> list[Column]:
    """What the headers mean: ``distance (mm)`` is distance_cm with its numbers divided by ten.

    Raises
    ------
    InputError
        For two columns of one meaning, and a column of a recipe's that names no unit.
    """
    found = [_meaning(header.strip(), file) for header in head]
    names = [column.name for column in found]
    twice = next((name for name in COLUMNS if names.count(name) > 1), "")
    if twice:
        raise InputError(
            file,
            f"names a column twice ({twice})",
            value=", ".join(h.strip() for h, name in zip(head, names, strict=True) if name == twice),
            remedy="leave one of them out",
        )
    kept: list[Column] = []
    for column in found:
        name, again = column.name, 2
        while name and name in {one.name for one in kept}:  # what is not used may stand there twice
            name, again = f"{column.name} ({again})", again + 1
        kept.append(column if name == column.name else Column(name))
    return kept


def _meaning(header: str, file: str) -> Column:
    if header in COLUMNS or not header:
        return Column(header)
    lower = {name.lower(): name for name in (*COLUMNS, "paper", "solvent_parts")}
    if header.lower() in lower:
        return Column(lower[header.lower()])
    for name, unit in _parted(header):
        for own, known in COLUMNS.items():
            if name not in (*known.called, own.lower(), own.lower().removesuffix(f"_{known.unit.lower()}")):
                continue
            if not known.unit:
                if unit.lower() in ("", "g"):
                    return Column(own)
                continue
            scale = _scale(unit, known)
            if scale is not None:
                return Column(own, *scale)
            if len(name) > 2 and name in known.called and (not unit or header[-1:] in ")]"):
                raise InputError(
                    file,
                    f"has a column {header} {'in an unknown unit' if unit else 'without a unit'}",
                    allowed=known.kind,
                    remedy=f"name it {own}, or {header.split('(')[0].split('[')[0].strip()} [{known.unit}]",
                )
    return Column(header)


def _parted(header: str) -> list[tuple[str, str]]:
    """A header as name and unit, each way that it may be parted."""

    def plain(name: str) -> str:
        return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")

    bracketed = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]", header)
    if bracketed:
        return [(plain(bracketed[1]), bracketed[2])]
    ways = [(plain(header), "")]
    for mark in ("/", "_", " "):
        name, found, unit = header.partition(mark) if mark == "/" else header.rpartition(mark)
        if found:
            ways.append((plain(name), unit.strip()))
    return ways


def _scale(unit: str, known: _Known) -> tuple[float, float] | None:
    """Scale and offset from a unit to the column's own, None where it is none of the kind."""
    if not unit:
        return None
    unit = "%" if unit.lower() in ("percent", "pct") else unit
    try:
        (zero, one), (own_zero, own_one) = (
            (parse(f"0 {u}", known.kind, "").value, parse(f"1 {u}", known.kind, "").value) for u in (unit, known.unit)
        )
    except InputError:
        return None
    own = own_one - own_zero
    scale, offset = (one - zero) / own, (zero - own_zero) / own
    return (1.0, 0.0) if math.isclose(scale, 1.0, rel_tol=1e-12) and abs(offset) < 1e-9 else (scale, offset)


def number_in(row: Mapping[str, str], key: str) -> float:
    """Number of a cell in the column's unit, NaN for an empty one; a unit may stand with it: "15 kV", "10 wt%", "22 G".

    Raises
    ------
    InputError
        For text that is no such quantity.
    """
    text = row.get(key, "")
    if not text:
        return math.nan
    known = COLUMNS[key]
    try:
        value = float(text)
    except ValueError:
        value = _quantity(text, key, known)
    if not math.isfinite(value):
        raise InputError(key, "is not finite", value=text)
    return value


def _quantity(text: str, key: str, known: _Known) -> float:
    if known.kind == "gauge":
        named = _GAUGE.fullmatch(text.strip())
        if named is None:
            raise InputError(key, "is not a number", value=text, remedy="a gauge, 22; or leave it empty")
        return float(named[1])
    found = written(text)
    if found is not None and not found.unit and not found.std_unit:
        return found.value
    zero, one = (parse(f"{n} {known.unit}", known.kind, key).value for n in (0, 1))
    return (parse(text, known.kind, key).value - zero) / (one - zero)


def spread_in(row: Mapping[str, str], key: str) -> bool:
    """Whether a cell carries a ``+/-``."""
    found = written(row.get(key, "")) if key in COLUMNS and COLUMNS[key].kind not in ("", "gauge") else None
    return found is not None and found.std > 0
