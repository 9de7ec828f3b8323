"""Columns with units from a table: ``z [mm], radius [um]``.

Every header names its quantity and its unit: ``z [mm]``, ``z (mm)``, ``z/mm``, ``z_mm``, or a row of units below. Names that
people use for the same thing are known (`ALIASES`). A column without a unit is refused: a bare number is not a length.
"""

from collections.abc import Mapping
from pathlib import Path

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.units import parse_unit
from spinline.jetprofile.table_text import Header, TextTable, read_table_text

__all__ = ["ALIASES", "read_columns"]

# other name: (column, factor)
ALIASES = {
    "r": ("radius", 1.0),
    "jet_radius": ("radius", 1.0),
    "d": ("radius", 0.5),
    "diameter": ("radius", 0.5),
    "jet_diameter": ("radius", 0.5),
    "diameter_std": ("radius_std", 0.5),
    "r_std": ("radius_std", 1.0),
    "d_std": ("radius_std", 0.5),
    "x": ("z", 1.0),  # where the table's x is no coordinate of its own
    "distance": ("z", 1.0),
    "position": ("z", 1.0),
    "axial_position": ("z", 1.0),
    "v": ("velocity", 1.0),
    "speed": ("velocity", 1.0),
    "t": ("time", 1.0),
    "stretch": ("stretch_ratio", 1.0),
}


def read_columns(
    path: str | Path, kinds: Mapping[str, str], *, required: tuple[str, ...] = ()
) -> dict[str, FloatArray]:
    """Read the named columns of a table in SI units.

    Parameters
    ----------
    path : path
        Text table (CSV; columns between commas, semicolons, tabs or blanks; comments behind ``#``, ``%`` or ``!``) or an
        Excel workbook, with one header line.
    kinds : mapping
        Column name to the kind of quantity (a key of `spinline.base.units.QUANTITIES`).
    required : tuple of str
        Columns that must be there.

    Returns
    -------
    dict
        Column name to float64 array, SI; empty fields are NaN.

    Raises
    ------
    InputError
        For an unreadable file, an unknown or repeated column, a missing unit or text among the numbers; the format that was
        seen is named.
    """
    file = str(path)
    allowed = ", ".join(
        f"{name} [{_unit_example(kind)}]" if _unit_example(kind) else name for name, kind in kinds.items()
    )
    table = read_table_text(path, allowed=allowed)
    columns: dict[str, FloatArray] = {}
    for header, values in zip(table.headers, table.columns, strict=True):
        name, unit, factor = _meaning(header, kinds, file, table, allowed)
        if name in columns:
            raise InputError(file, f"has a column twice ({table.seen})", value=header.name)
        columns[name] = factor * _scaled(values, kinds[name], unit, f"{file}: {header.name}", table.seen)
    for name in required:
        if name not in columns:
            found = [header.name for header in table.headers]
            raise InputError(file, f"has no column {name} ({table.seen})", value=found, allowed=allowed)
    return columns


def _meaning(
    header: Header, kinds: Mapping[str, str], file: str, table: TextTable, allowed: str
) -> tuple[str, str, float]:
    """Column, unit and factor of a header."""
    for text, unit in ((header.name, header.unit), _split(header)):
        for name in (text, text.lower()):
            if name in kinds:
                return name, unit, 1.0
            column, factor = ALIASES.get(name, ("", 1.0))
            if column in kinds:
                return column, unit, factor
    raise InputError(file, f"has a column that is not known ({table.seen})", value=header.name, allowed=allowed)


def _split(header: Header) -> tuple[str, str]:
    """``x_mm`` is x in mm, where no other unit stands."""
    name, _, unit = header.name.rpartition("_")
    return (name, unit) if name and not header.unit else (header.name, header.unit)


def _scaled(values: FloatArray, kind: str, unit: str, field: str, seen: str) -> FloatArray:
    example = _unit_example(kind)
    if not example:
        if unit not in ("", "1", "-", "%"):
            raise InputError(field, "has a unit, but a pure number has none", value=unit, allowed="[%] or none")
        return values * 0.01 if unit == "%" else values
    if not unit:
        remedy = f'for example "{field.split()[-1]} [{example}]"'
        raise InputError(field, f"needs a unit in its header ({seen})", remedy=remedy)
    scale, offset = parse_unit(unit, kind, field)
    return values * scale + offset


def _unit_example(kind: str) -> str:
    units = {"length": "mm", "velocity": "m/s", "time": "s", "volume": "m3", "number": "", "pressure": "Pa"}
    return (units | {"electric field": "kV/m"})[kind]
