"""Diameters measured on images: reading what segmentation tools write.

A text table with a column of diameters (or radii): header words such as ``Diameter (nm)``, ``Fiber Radius [px]``,
``Length``, ``Count``; comma, semicolon, tab or blanks between, decimal commas where the columns are not parted by commas.
Units stand in the header or are given; pixels need the size of one. Several diameter columns are refused rather than guessed
at.
"""

import re
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray, positive
from spinline.base.errors import InputError
from spinline.base.files import readable

__all__ = ["MeasuredDiameters", "read_diameters"]

_UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6, "microns": 1e-6, "nm": 1e-9}
_PIXELS = ("px", "pixel", "pixels")
_WEIGHT = re.compile(r"\b(count|counts|frequency|number|weight|length)\b", re.I)
_SIZE = re.compile(r"\b(diameter|diameters|diam|radius|radii|width)\b", re.I)
_UNIT = re.compile(r"[(\[]\s*([^)\]]+?)\s*[)\]]")


@dataclass(frozen=True, eq=False)
class MeasuredDiameters:
    """Diameters in m, their weights (1 each where the file has none), and what they came from."""

    diameter: FloatArray
    weight: FloatArray
    weight_name: str
    source: str
    dropped: int


def read_diameters(
    path: str | Path, *, unit: str | None = None, pixel_size: float | None = None, column: str | None = None
) -> MeasuredDiameters:
    """Diameters of a table.

    Parameters
    ----------
    path : path
    unit : str, optional
        m, mm, um, nm or px, where the header has none; contradicting the header is an error.
    pixel_size : float, optional
        m per pixel.
    column : str, optional
        Header of the column, where several could be meant.

    Returns
    -------
    MeasuredDiameters
        Rows that are empty, zero or negative are dropped and counted.

    Raises
    ------
    InputError
        For a file that cannot be read as such a table, an unknown or missing unit, or pixels of unknown size.
    """
    name = str(path)
    try:
        text = readable(path).read_text(encoding="utf-8-sig", errors="replace")
    except OSError:
        raise InputError(name, "cannot be read", remedy="check the path") from None
    header, rows = _table(text, name)
    k = _column(header, column, name)
    scale = _scale(header[k] if header else "", unit, pixel_size, name)
    values = rows[:, k] * (2 if header and re.search(r"\bradi", header[k], re.I) else 1) * scale
    w = [j for j, word in enumerate(header) if j != k and _WEIGHT.search(word)]
    weight, weight_name = (rows[:, w[0]], header[w[0]]) if len(w) == 1 else (np.ones(len(rows)), "")
    good = np.isfinite(values) & (values > 0) & np.isfinite(weight) & (weight > 0)
    if not good.any():
        raise InputError(name, "has no diameter above 0", remedy="check the column and its unit")
    return MeasuredDiameters(values[good], weight[good], weight_name, Path(path).name, int((~good).sum()))


def _table(text: str, name: str) -> tuple[list[str], FloatArray]:
    import pandas as pd

    lines = [line for line in text.splitlines() if line.strip()]
    if not lines:
        raise InputError(name, "is empty")
    mark = next((mark for mark in ("\t", ";", ",") if mark in lines[0]), None)
    if mark is None and len(lines) > 1:
        mark = next((mark for mark in ("\t", ";") if mark in lines[1]), None)
    decimal = "," if mark != "," and any("," in line for line in lines[1:]) else "."
    first = [part.strip().strip('"') for part in (lines[0].split(mark) if mark else [lines[0]])]
    has_header = not all(_is_number(part, decimal) for part in first if part)
    try:
        frame = pd.read_csv(
            StringIO("\n".join(lines)),
            sep=mark if mark else r"\s+",
            decimal=decimal,
            skiprows=int(has_header),
            header=None,
            engine="python" if mark is None else "c",
            skipinitialspace=True,
        )
    except (ValueError, pd.errors.ParserError):
        raise InputError(name, "is not a table of numbers", value=lines[0]) from None
    rows = frame.apply(pd.to_numeric, errors="coerce").to_numpy(dtype=np.float64)
    header = first if has_header else []
    if header and rows.shape[1] != len(header):
        if mark is None and rows.shape[1] == 1:
            header = [lines[0].strip()]
        else:
            raise InputError(name, f"has {len(header)} headers over {rows.shape[1]} columns", value=lines[0])
    return header, rows


def _column(header: list[str], column: str | None, name: str) -> int:
    if column is not None:
        if column not in header:
            raise InputError(name, "has no such column", value=column, allowed=", ".join(header) or "no header")
        return header.index(column)
    if not header:
        return 0
    found = [k for k, word in enumerate(header) if _SIZE.search(word)]
    if len(found) != 1:
        what = "no column of diameters" if not found else f"{len(found)} columns of diameters"
        raise InputError(name, f"has {what}", value=", ".join(header), remedy="name the column")
    return found[0]


def _scale(header: str, unit: str | None, pixel_size: float | None, name: str) -> float:
    match = _UNIT.search(header)
    stated = match.group(1).lower() if match else None
    if stated is not None and stated not in _UNITS and stated not in _PIXELS:
        raise InputError(f"{name}: {header}", "has a unit that is not known", value=stated, allowed="m, mm, um, nm, px")
    given = unit.lower() if unit is not None else None
    if given is not None and given not in _UNITS and given not in _PIXELS:
        raise InputError("unit", "is not known", value=unit, allowed="m, mm, um, nm, px")
    if stated and given and _UNITS.get(stated) != _UNITS.get(given):
        raise InputError(f"{name}: {header}", f"contradicts the unit given, {unit}", remedy="give one of the two")
    word = stated or given
    if word is None:
        raise InputError(name, "does not say the unit of its diameters", remedy="give the unit: m, mm, um, nm or px")
    if word in _PIXELS:
        if pixel_size is None:
            raise InputError("pixel_size", "is needed: the diameters are in pixels", remedy="give m per pixel")
        return positive("pixel_size", pixel_size, "m")
    return _UNITS[word]


def _is_number(text: str, decimal: str) -> bool:
    try:
        float(text.replace(decimal, ".") if decimal == "," else text)
    except ValueError:
        return False
    return True
