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
from spinline.base.text import csv_rows
from spinline.base.words import cell
from spinline.base.workbook import WORKBOOKS, sheet_rows, table_text
from spinline.recipe.believe import Recipe, known_solvents
from spinline.recipe.mixture_text import parted
from spinline.recipe.outside import outside_remarks
from spinline.recipe.table_columns import COLUMNS, NOTHING, columns_of, number_in, spread_in
from spinline.rheology.materials import POLYMERS
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS
from spinline.scene.advice import GAUGES

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


def read_experiments(path: str | Path) -> list[dict[str, str]]:
    """Rows of a table of experiments, text or an Excel workbook, as text by column.

    Columns of other hands (``Distance (mm)``, ``voltage [kV]``, ``RH (%)``) get the names and units that are listed.

    Raises
    ------
    InputError
        If it is no such table, or a column that every prediction needs is missing.
    """
    head, cells, comma = _cells(path)
    columns = columns_of(head, str(path))
    names = [column.name for column in columns]
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise InputError(
            str(path),
            f"has no column {missing[0]}" if head else "is empty",
            value=[name.strip() for name in head] or None,
            allowed=", ".join(_NEEDED),
            remedy="a table, one row an experiment; `docs/howto/fibre.md` lists the columns and their units",
        )
    rows = [
        {
            column.name: column.cell(value, comma)
            for column, value in zip_longest(columns, row[: len(columns)])
            if column.name
        }
        for row in cells
        if any(value.strip() for value in row)
    ]
    if not rows:
        raise InputError(str(path), "has no rows under its header", remedy="one row an experiment")
    return rows


def _cells(path: str | Path) -> tuple[list[str], list[list[str]], bool]:
    """Header and rows of a table, and whether a comma in a number is a decimal one."""
    if Path(path).suffix.lower() in WORKBOOKS:
        rows = [row for row in sheet_rows(path) if any(value.strip() for value in row)]
        return (rows[0], rows[1:], True) if rows else ([], [], True)
    text, _ = table_text(path)
    lines = [line for line in io.StringIO(text, newline=None) if line.strip()]  # a line of a cell in quotes stays in it
    while lines and lines[0].lstrip().lower().startswith(("#", "sep=")):
        del lines[0]
    mark = max(",;\t", key=lines[0].count) if lines else ","
    head, *cells = csv_rows(lines, mark, str(path)) or [[]]
    return head, cells, mark != ","


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
        number = {key: number_in(row, key) for key in row if key in COLUMNS and COLUMNS[key].kind}
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
        if percent < _LEAST_PERCENT:
            return f"concentration_wt_percent = {percent:g} looks like a share: percent, 12 and not 0.12"
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
            needle_radius=_radius(gauge),
            temperature=celsius + 273.15,
            relative_humidity=wet / 100,
        )
    except InputError as error:
        return str(error)


_LEAST_PERCENT = 0.5  # of polymer: less holds no jet together
# what no needle has been run at, and what such a number usually is
_USUAL = {
    "voltage_kV": (0.1, 300.0, "kV, not V"),
    "flow_rate_mL_per_h": (1e-4, 1e4, "mL/h, not L/h or mL/min"),
    "distance_cm": (0.05, 500.0, "cm, not mm or m"),
}


def _radius(gauge: float) -> float:
    """Inner radius of a gauge, m; NaN for one that is not in the list."""
    return GAUGES.get(int(gauge), math.nan) if gauge == gauge and gauge == round(gauge) else math.nan


def _names(row: Mapping[str, str]) -> list[str]:
    return _solvents(row.get("solvent_parts") or row["solvent"])


def _solvents(text: str) -> list[str]:
    if not text or text.lower() in NOTHING:
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
    from spinline.recipe.predict import known_rung, predict

    known_rung(rung)
    out: list[dict[str, str | float]] = []
    recipes = recipes_of(rows)
    known: dict[str, Any] = {}  # experiments that differ in what no law has are predicted once
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
                found = known.get(repr(recipe)) or predict(recipe, rung=rung, shares=False)
                known[repr(recipe)] = found
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
    said = []
    gauge = number_in(row, "needle_gauge")
    if gauge == gauge and _radius(gauge) != _radius(gauge):
        between = f"{min(GAUGES)} to {max(GAUGES)}"
        said.append(f"needle_gauge = {gauge:g} is of no needle in the list of gauges ({between}): taken as not given")
    exact = [key for key in row if spread_in(row, key)]
    if exact:
        said.append(f"the +/- of {', '.join(exact)} is not in the interval")
    if row.get("solvent_parts") and row.get("solvent"):
        try:
            other = set(_solvents(row["solvent"])) != set(_names(row))
        except InputError:
            other = True
        if other:
            said.append(f"solvent says {row['solvent']}, solvent_parts {row['solvent_parts']}: the latter is taken")
    return said
