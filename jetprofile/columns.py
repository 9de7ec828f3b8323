"""Columns with units from a table: ``z [mm], radius [um]``.

Every header names its quantity and its unit: ``z [mm]``, ``z (mm)``, ``z/mm``, ``z_mm``, or a row of units below. Names that
people use for the same thing are known (`ALIASES`). A column without a unit is refused: a bare number is not a length.
"""

import difflib
import re
import warnings
from collections.abc import Mapping
from pathlib import Path

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.units import parse_unit
from spinline.jetprofile.table_text import Header, read_table_text

__all__ = ["ALIASES", "read_columns"]

_SPREAD = re.compile(r"std|sd|err|sigma|unc|dev")
_SPATIAL = (
    'of beads in space a scene takes the file as it is: [jet] profile = "lagrangian", path; else leave one of them out'
)
_STRAIGHT = 'a straight jet of z and radius is named by [jet] profile = "table", path'
# other name: (column, factor)
ALIASES = {
    "r": ("radius", 1.0),
    "jet_radius": ("radius", 1.0),
    "d": ("radius", 0.5),
    "diameter": ("radius", 0.5),
    "jet_diameter": ("radius", 0.5),
    "dia": ("radius", 0.5),
    "diam": ("radius", 0.5),
    "ø": ("radius", 0.5),
    "diameter_std": ("radius_std", 0.5),
    "r_std": ("radius_std", 1.0),
    "d_std": ("radius_std", 0.5),
    "x": ("z", 1.0),  # where the table's x is no coordinate of its own
    "distance": ("z", 1.0),
    "distance_from_nozzle": ("z", 1.0),
    "distance_from_the_nozzle": ("z", 1.0),
    "distance_from_needle": ("z", 1.0),
    "position": ("z", 1.0),
    "axial_position": ("z", 1.0),
    "arc_length": ("z", 1.0),
    "v": ("velocity", 1.0),
    "speed": ("velocity", 1.0),
    "t": ("time", 1.0),
    "stretch": ("stretch_ratio", 1.0),
}


def read_columns(
    path: str | Path,
    kinds: Mapping[str, str],
    *,
    required: tuple[str | tuple[str, ...], ...] = (),
    others: bool = False,
) -> dict[str, FloatArray]:
    """Read the named columns of a table in SI units.

    Parameters
    ----------
    path : path
        Text table (CSV; columns between commas, semicolons, tabs or blanks; comments behind ``#``, ``%`` or ``!``) or an
        Excel workbook, with one header line.
    kinds : mapping
        Column name to the kind of quantity (a key of `spinline.base.units.QUANTITIES`).
    required : tuple
        Columns that must be there; of some in a tuple, one.
    others : bool
        Leave out columns of other names, with a warning that names them (a table of results holds many); not those that look
        like a wanted one misspelt, nor a time.

    Returns
    -------
    dict
        Column name to float64 array, SI; empty fields are NaN.

    Raises
    ------
    InputError
        For an unreadable file, an unknown or repeated column, a missing unit or text among the numbers; the format that was
        seen is named.

    Warns
    -----
    SpinlineWarning
        Of `others`.
    """
    file = str(path)
    allowed = ", ".join(
        f"{name} [{_unit_example(kind)}]" if _unit_example(kind) else name for name, kind in kinds.items()
    )
    table = read_table_text(path, allowed=allowed)
    columns: dict[str, FloatArray] = {}
    told: dict[str, str] = {}
    unused = []
    for header, values in zip(table.headers, table.columns, strict=True):
        found = _meaning(header, kinds)
        if found is None:
            remedy = _mistaken(header.name, kinds)
            if not others or remedy:
                problem = f"has a column that is not known ({table.seen})"
                raise InputError(file, problem, value=header.name, allowed=allowed, remedy=remedy or "leave it out")
            unused.append(header.name)
            continue
        name, unit, factor = found
        if name in columns:
            problem = f"has two columns that mean {name} ({table.seen})"
            spatial = "x" not in kinds and {told[name].lower(), header.name.lower()} == {"x", "z"}
            remedy = _SPATIAL if spatial else "leave one of them out"
            raise InputError(file, problem, value=f"{told[name]}, {header.name}", remedy=remedy)
        told[name] = header.name
        columns[name] = factor * _scaled(values, kinds[name], unit, f"{file}: {header.name}", table.seen)
    for each in required:
        either = (each,) if isinstance(each, str) else each
        if not any(one in columns for one in either):
            names = ", ".join(header.name for header in table.headers)
            problem = f"has no column {' or '.join(either)} ({table.seen})"
            remedy = _STRAIGHT if each == "x" and "z" in columns else ""
            raise InputError(file, problem, value=names, allowed=allowed, remedy=remedy)
    if unused:
        shown = ", ".join(unused[:4]) + (f" and {len(unused) - 4} more" if len(unused) > 4 else "")
        warnings.warn(f"{file}: columns left out: {shown}", SpinlineWarning, stacklevel=3)
    return columns


def _meaning(header: Header, kinds: Mapping[str, str]) -> tuple[str, str, float] | None:
    """Column, unit and factor of a header, None where it is none of these."""
    for text, unit in ((header.name, header.unit), _split(header)):
        for name in (text, text.lower()):
            column, factor = (name, 1.0) if name in kinds else ALIASES.get(name, ("", 1.0))
            if column == "z" != name and "x" in kinds:
                continue  # of beads in space, z is across the axis and no distance
            if column in kinds and (text == header.name or _is_unit(unit, kinds[column])):
                return column, unit, factor
    return None


def _is_unit(text: str, kind: str) -> bool:
    """Whether what stands behind a name is a unit of it: velocity_ratio is no velocity in "ratio"."""
    if not _unit_example(kind):
        return text in ("1", "-", "%")
    try:
        parse_unit(text, kind, text)
    except InputError:
        return False
    return True


def _mistaken(name: str, kinds: Mapping[str, str]) -> str:
    """What to do about a name that cannot be left out: one that is nearly a wanted one, or a time; else nothing."""
    if ALIASES.get(name.lower(), (name.lower(), 1.0))[0] == "time":
        return "give the rows of one time, without this column"
    known = [*kinds, *(alias for alias, (column, _) in ALIASES.items() if column in kinds)]
    near = difflib.get_close_matches(name.lower(), known, 1, 0.82)
    if not near and _SPREAD.search(name.lower()):
        near = [f"{one}_std" for one in kinds if name.lower().startswith(f"{one}_") and f"{one}_std" in kinds]
    return f"call it {near[0]} if that is meant, else leave it out" if near else ""


def _split(header: Header) -> tuple[str, str]:
    """``x_mm`` is x in mm, and so is ``x in mm``, where no other unit stands."""
    name, _, unit = header.name.rpartition("_")
    return (name.removesuffix("_in"), unit) if name and not header.unit else (header.name, header.unit)


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
