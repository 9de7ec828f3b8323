"""Recipes from a table of experiments, one row an experiment, as the published collections have them."""

import csv
import io
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError
from spinline.base.text import csv_rows, read_text
from spinline.base.words import cell
from spinline.recipe.believe import Recipe, known_solvents
from spinline.recipe.mixture_text import parted
from spinline.recipe.outside import outside_remarks
from spinline.rheology.materials import POLYMERS
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS

__all__ = ["predict_table", "read_experiments", "recipes_of"]

# what the published tables write for what the library has; the last two by their context
_ALSO = {
    "DISTILLED_WATER": "water",
    "DEIONIZED_WATER": "water",
    "AC": "acetone",
    "DSM": "DCM",
    "PDLLA": "PLA",
    "PLLA": "PLA",
}
_NEEDED = ("polymer", "solvent", "voltage_kV", "flow_rate_mL_per_h", "distance_cm")
# inner radius of a needle by its gauge, m: half the nominal inner diameter of regular walls in suppliers' charts (0.413 mm of
# 22 G; 0.00525, 0.00425, 0.00425 and 0.00325 inch of 31 to 34 G); ISO 9626 has the least inner diameters of metric tubes
GAUGES = {
    14: 0.80e-3,
    15: 0.69e-3,
    16: 0.60e-3,
    17: 0.54e-3,
    18: 0.42e-3,
    19: 0.34e-3,
    20: 0.30e-3,
    21: 0.26e-3,
    22: 0.21e-3,
    23: 0.17e-3,
    24: 0.155e-3,
    25: 0.13e-3,
    26: 0.13e-3,
    27: 0.105e-3,
    28: 0.09e-3,
    29: 0.09e-3,
    30: 0.08e-3,
    31: 0.0665e-3,
    32: 0.054e-3,
    33: 0.054e-3,
    34: 0.0413e-3,
}


def read_experiments(path: str | Path) -> list[dict[str, str]]:
    """Rows of a CSV file of experiments, as text by column.

    Raises
    ------
    InputError
        If it is no such table, or a column that every prediction needs is missing.
    """
    text, _ = read_text(path)
    lines = [line for line in io.StringIO(text, newline=None) if line.strip()]  # a line of a cell in quotes stays in it
    mark = max(",;\t", key=lines[0].count) if lines else ","
    head, *cells = csv_rows(lines, mark, str(path)) or [[]]
    names = [name.strip() for name in head]
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise InputError(
            str(path),
            f"has no column {missing[0]}",
            value=names,
            allowed=", ".join(_NEEDED),
            remedy="a CSV table, one row an experiment; `docs/howto/fibre.md` lists the columns and their units",
        )
    if len(set(names)) < len(names):
        raise InputError(str(path), "names a column twice", value=next(n for n in names if names.count(n) > 1))
    rows = [
        {key: _cell(value, key, mark) for key, value in zip_longest(names, row[: len(names)]) if key} for row in cells
    ]
    if not rows:
        raise InputError(str(path), "has no rows under its header", remedy="one row an experiment")
    return rows


def _cell(value: str | None, key: str, mark: str) -> str:
    """Text of a cell: nothing for what means nothing; a decimal comma is a point where commas do not part cells."""
    text = (value or "").strip()
    if text.lower() in _NOTHING:
        return ""
    return text.replace(",", ".") if mark != "," and key.endswith((*_UNITS, "_nm")) else text


def recipes_of(rows: Sequence[Mapping[str, str]]) -> list[Recipe | str]:
    """A recipe for each row, or why there is none. Rows of one paper, polymer and solvent are one laboratory's."""
    found = [_recipe(row) for row in rows]
    about: dict[tuple[str, ...], list[float]] = {}
    keys = [tuple(row.get(name, "") for name in ("paper", "polymer", "solvent")) for row in rows]
    for key, recipe in zip(keys, found, strict=True):
        if isinstance(recipe, Recipe) and recipe.mass_fraction == recipe.mass_fraction:
            about.setdefault(key, []).append(math.log(recipe.mass_fraction))
    means = {key: math.exp(sum(values) / len(values)) for key, values in about.items()}
    return [
        recipe if isinstance(recipe, str) else replace(recipe, usual_fraction=means.get(key, math.nan))
        for key, recipe in zip(keys, found, strict=True)
    ]


def _recipe(row: Mapping[str, str]) -> Recipe | str:
    try:
        names = _names(row)
        number = {key: _number(row, key) for key in row if key.endswith(_UNITS)}
        for key, (low, high, hint) in _USUAL.items():
            if not number[key] > 0:
                return f"{key} is missing or not above zero"
            if not low <= number[key] <= high:
                return f"{key} = {number[key]:g} is out of range [{low:g}, {high:g}]: {hint}"
        if not row["polymer"]:
            return "polymer is missing"
        percent = number.get("concentration_wt_percent", math.nan)
        if percent == percent and not 0.05 < percent < 95:
            return f"concentration_wt_percent = {percent:g} is out of range (0.05, 95)"
        gauge = number.get("needle_gauge", math.nan)  # below 14 they are mistyped: no needle of 2 mm spins 20 wt%
        celsius = number.get("temperature_degC", math.nan)
        wet = number.get("relative_humidity_percent", math.nan)
        for key, value, low, high in (("temperature_degC", celsius, 0, 70), ("relative_humidity_percent", wet, 0, 100)):
            if value == value and not low <= value <= high:
                return f"{key} = {value:g} is out of range [{low}, {high}]"
        if 0 < wet < 1:
            return f"relative_humidity_percent = {wet:g} looks like a share: percent, 45 and not 0.45"
        return Recipe(
            polymer=_polymer(row["polymer"]),
            solvent=known_solvents(names),
            ratio_known=len(names) == 1,
            voltage=1e3 * number["voltage_kV"],
            gap=1e-2 * number["distance_cm"],
            flow_rate=number["flow_rate_mL_per_h"] * 1e-6 / 3600,
            mass_fraction=percent / 100,
            needle_radius=GAUGES.get(round(gauge), math.nan) if gauge == gauge else math.nan,
            temperature=celsius + 273.15,
            relative_humidity=wet / 100,
        )
    except InputError as error:
        return str(error)


_UNITS = ("_kV", "_mL_per_h", "_cm", "_percent", "_degC", "needle_gauge", "drum_rpm")


_NOTHING = {"nan", "na", "n/a", "none", "null", "-", "--", "?"}
# what no needle has been run at, and what such a number usually is
_USUAL = {
    "voltage_kV": (0.1, 300.0, "kV, not V"),
    "flow_rate_mL_per_h": (1e-4, 1e4, "mL/h, not L/h or mL/min"),
    "distance_cm": (0.05, 500.0, "cm, not mm or m"),
}


def _number(row: Mapping[str, str], key: str) -> float:
    text = row.get(key, "")
    if not text:
        return math.nan
    try:
        value = float(text)
    except ValueError:
        raise InputError(key, "is not a number", value=text) from None
    if not math.isfinite(value):
        raise InputError(key, "is not finite", value=text)
    return value


def _names(row: Mapping[str, str]) -> list[str]:
    text = row.get("solvent_parts") or row["solvent"]
    if not text or text.lower() in _NOTHING:
        raise InputError("solvent", "is missing", remedy="name it")
    found, unknown = parted(text, _solvent)
    if unknown:
        shares = (
            "name the parts alone: tables hold no shares, equal parts are taken"
            if re.search(r"\d\s*[:/%]", text)
            else ""
        )
        allowed = "" if shares else ", ".join(sorted(SOLVENTS))
        raise InputError("solvent", "is not in the library", value=unknown, allowed=allowed, remedy=shares)
    return list(dict.fromkeys(found))


def _solvent(name: str) -> str | None:
    return known_as(_ALSO.get(name.upper(), name), SOLVENTS)


def _polymer(name: str) -> str:
    """Name in the library; what is not there keeps its name, and gets the widest priors."""
    return known_as(_ALSO.get(name.upper(), name), POLYMERS) or name


def written(rows: Iterable[Mapping[str, Any]]) -> str:
    """CSV text of rows."""
    rows = [{cell(key): cell(value) if isinstance(value, str) else value for key, value in row.items()} for row in rows]
    stream = io.StringIO()
    writer = csv.DictWriter(stream, fieldnames=list(rows[0]) if rows else [], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def predict_table(
    rows: Sequence[Mapping[str, str]], *, rung: str = "race", progress: Any = None
) -> list[dict[str, str | float]]:
    """Every row with ``predicted_nm, low68_nm, high68_nm, low95_nm, high95_nm, regime, rung, remark`` added.

    A row that cannot be predicted has them empty, and the reason as its regime. The remarks are those of a recipe, one after
    the other; a column of that name that the table brings keeps its words before them.
    """
    from spinline.recipe.predict import predict

    out: list[dict[str, str | float]] = []
    recipes = recipes_of(rows)
    for i, (row, recipe) in enumerate(zip(rows, recipes, strict=True)):
        answer: dict[str, str | float] = dict.fromkeys(
            ("predicted_nm", "low68_nm", "high68_nm", "low95_nm", "high95_nm"), ""
        )
        said = [] if "predicted_nm" in row else [row.get("remark", "")]
        if isinstance(recipe, str):
            answer |= {"regime": f"not predicted: {recipe}", "rung": rung}
        else:
            said += _taken(row)
            try:
                found = predict(recipe, rung=rung, shares=False)
            except InputError as error:
                answer |= {"regime": f"not predicted: {error}", "rung": rung}
                said += outside_remarks(recipe)
            else:
                sizes = (found.fibre_diameter, *found.fibre_diameter_68, *found.fibre_diameter_95)
                answer = dict(zip(answer, (float(f"{1e9 * size:.5g}") for size in sizes), strict=True))
                answer |= {"regime": found.regime, "rung": found.rung}
                said += found.remarks
        out.append({**row, **answer, "remark": "; ".join(filter(None, said))})
        if progress is not None:
            progress(i + 1, len(rows))
    return out


def _taken(row: Mapping[str, str]) -> list[str]:
    """What of a row was not taken as it stands there."""
    gauge = _number(row, "needle_gauge")
    if gauge == gauge and round(gauge) not in GAUGES:
        between = f"{min(GAUGES)} to {max(GAUGES)}"
        return [f"needle_gauge = {gauge:g} is of no needle in the list of gauges ({between}): taken as not given"]
    return []
