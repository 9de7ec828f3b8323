"""Rows of a sweep from a CSV file: one column a key, its unit in the header (``jet.radius [um]``) or in every cell."""

import io
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError
from spinline.base.text import csv_rows, read_text
from spinline.base.units import QUANTITIES, parse_unit
from spinline.scene.keys import full_key, read_value, reader
from spinline.scene.quantities import Read

__all__ = ["read_table"]

_HEADER = re.compile(r"\s*(?P<key>[\w.]+)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?\s*")


def read_table(path: Path) -> Mapping[str, list[Any]]:
    """Columns of a table of scenes.

    Parameters
    ----------
    path : Path
        CSV: a header of scene keys, then one row a scene. Lines that start with ``#`` are comments.

    Returns
    -------
    dict
        Key to values: floats in SI, or text where the key holds words. A value out of its range is kept: its row is refused
        when it is computed, not the table.

    Raises
    ------
    InputError
        For a file that cannot be read, an unknown key or unit, a cell that is no number.
    """
    name = str(path)
    try:
        text, _ = read_text(path)
    except InputError as error:
        raise InputError("design.path", error.problem, value=name, remedy=error.remedy) from None
    lines = [line for line in io.StringIO(text, newline="") if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) < 2:
        raise InputError("design.path", "holds no rows", value=name, remedy="give a header of scene keys, then rows")
    mark = next((mark for mark in (",", ";", "\t") if mark in lines[0]), ",")
    header, *rows = csv_rows(lines, mark, name, skipinitialspace=True)
    for i, row in enumerate(rows, 1):
        if any(cell.strip() for cell in row[len(header) :]):
            problem = f"has {len(row)} cells under {len(header)} keys"
            remedy = "write decimals with points and nothing between thousands, or give every column its key"
            raise InputError(f"{name}: row {i}", problem, value=mark.join(row), remedy=remedy)
    columns: dict[str, list[Any]] = {}
    for j, title in enumerate(header):
        match = _HEADER.fullmatch(title)
        key = full_key(match["key"] if match else title, f"{name}: column {j + 1}")
        if key in columns:
            raise InputError(f"{name}: column {j + 1}", "is there twice", value=title, remedy="keep one")
        unit = match["unit"] if match else None
        columns[key] = [_cell(row, j, key, unit, f"{name}: row {i + 1}, {key}") for i, row in enumerate(rows)]
    return columns


def _cell(row: list[str], j: int, key: str, unit: str | None, field: str) -> Any:
    text = row[j].strip() if j < len(row) else ""
    if not text:
        raise InputError(field, "is empty", remedy="give a value in every cell")
    how = reader(key)
    if how is None:
        return read_value(key, text, field)
    if not unit:
        bare = not isinstance(how, Read) or not QUANTITIES[how.kind].unit
        if bare and _plain(text):
            return _number(text, field)
        return read_value(key, text, field, ranged=False, exact=True)
    if not isinstance(how, Read) or not QUANTITIES[how.kind].unit:
        if isinstance(how, Read):
            return read_value(key, f"{text} {unit}", field, ranged=False, exact=True)
        raise InputError(
            field, "has a unit, and is a bare number", value=unit, remedy="take the unit out of the header"
        )
    scale, offset = parse_unit(unit, how.kind, field)
    return _number(text, field) * scale + offset


def _plain(text: str) -> bool:
    return re.fullmatch(r"[-+0-9.eE]+|[-+]?(nan|inf)", text, re.IGNORECASE) is not None


def _number(text: str, field: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(
            field, "is not a number", value=text, remedy="write a number; the unit goes into the header"
        ) from None
