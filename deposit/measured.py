"""Diameters measured on images: reading what segmentation tools write.

A text table with a column of diameters (or radii): header words such as ``Diameter (nm)``, ``Fiber Radius [px]``,
``Length``, ``Count``; comma, semicolon, tab or blanks between, decimal commas where the columns are not parted by commas.
Units stand in the header or are given; pixels need the size of one. Several diameter columns are refused rather than guessed
at.
"""

import re
import warnings
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray, positive
from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.words import label
from spinline.base.workbook import WORKBOOKS, sheet_rows, table_text
from spinline.jetprofile.table_header import comment, fields_of

__all__ = ["MeasuredDiameters", "read_diameters"]

_UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6, "microns": 1e-6, "nm": 1e-9}
_SHORT = ("m", "mm", "um", "nm", "px")
_SIZE_OF_ONE = '--pixel-size "0.1 um" (pixel_size, in m)'
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
    if Path(path).suffix.lower() in WORKBOOKS:
        lines = ["\t".join(row) for row in sheet_rows(path)]
    else:
        lines = table_text(path)[0].splitlines()
    header, cells, decimal = _table(lines, name)
    k = _column(header, column, name)
    _no_thousands(cells[:, k], header[k] if header else "", name)
    rows = _numbers(cells, decimal)
    scale = _scale(header[k] if header else "", unit, pixel_size, name)
    values = rows[:, k] * (2 if header and re.search(r"\bradi", header[k], re.I) else 1) * scale
    w = [j for j, word in enumerate(header) if j != k and _WEIGHT.search(word)]
    weight, weight_name = (rows[:, w[0]], header[w[0]]) if len(w) == 1 else (np.ones(len(rows)), "")
    good = np.isfinite(values) & (values > 0) & np.isfinite(weight) & (weight > 0)
    if not good.any():
        raise InputError(name, "has no diameter above 0", remedy="check the column and its unit")
    if not good.all():
        bad = int(np.argmin(good))
        warnings.warn(
            f"{name}: {(~good).sum()} of {good.size} rows are left out, for they have no diameter above 0: the first is row "
            f"{bad + 1}, {label(cells[bad, k])!r}",
            SpinlineWarning,
            stacklevel=2,
        )
    return MeasuredDiameters(values[good], weight[good], weight_name, Path(path).name, int((~good).sum()))


def _table(lines: list[str], name: str) -> tuple[list[str], NDArray[np.object_], str]:
    """Header (none where the first line is numbers), cells as text, and the mark of decimals."""
    import pandas as pd

    lines = [line for line in lines if line.strip() and not line.strip().lower().startswith("sep=")]
    lines = _without_comments(lines)
    if not lines:
        raise InputError(name, "is empty", remedy="give a column of diameters below its name")
    mark = next((mark for mark in ("\t", ";", ",") if mark in lines[0]), None)
    if mark is None and len(lines) > 1:
        mark = next((mark for mark in ("\t", ";") if mark in lines[1]), None)
    decimal = "," if mark != "," and any("," in line for line in lines[1:]) else "."
    first = [part.strip().strip('"') for part in (lines[0].split(mark) if mark else [lines[0]])]
    has_header = not all(_is_number(part, decimal) for part in first if part)
    below = [unit.strip('[]()" ') for unit in fields_of(lines[1], mark)] if has_header and len(lines) > 2 else []
    units = len(below) == len(first) and any(unit.lower() in (*_UNITS, *_PIXELS) for unit in below)
    try:
        frame = pd.read_csv(
            StringIO("\n".join(lines)),
            sep=mark if mark else r"\s+",
            skiprows=int(has_header) + int(units),
            header=None,
            dtype=str,
            keep_default_na=False,
            engine="python" if mark is None else "c",
            skipinitialspace=True,
        )
    except (ValueError, pd.errors.ParserError):
        raise InputError(name, "is not a table of numbers", value=lines[0], remedy=_NAMED) from None
    header = first if has_header else []
    if header and frame.shape[1] != len(header):
        if mark is None and frame.shape[1] == 1:
            header = [lines[0].strip()]
        else:
            problem = f"has {len(header)} headers over {frame.shape[1]} columns"
            raise InputError(name, problem, value=lines[0], remedy=_NAMED)
    if units:
        header = [f"{word} [{unit}]" if unit else word for word, unit in zip(header, below, strict=True)]
    cells = frame.fillna("").map(lambda cell: str(cell).strip(' "')).to_numpy(dtype=object)
    return header, cells, decimal


_NAMED = "one name over each column, parted as the rows are; begin lines above the names with #"


def _without_comments(lines: list[str]) -> list[str]:
    """Lines below the comments; the last comment is the header where numbers follow it."""
    first = next((i for i, line in enumerate(lines) if not comment(line)), len(lines))
    rows = [line for line in lines[first:] if not comment(line)]
    if first and rows and re.match(r"[\s\"]*[-+.\d]", rows[0]):
        return [lines[first - 1].lstrip("#%! "), *rows]
    return rows


def _numbers(cells: NDArray[np.object_], decimal: str) -> FloatArray:
    """Numbers of the cells, NaN for what is none."""
    import pandas as pd

    plain = [[str(cell).replace(",", ".") if decimal == "," else str(cell) for cell in row] for row in cells]
    found: FloatArray = pd.DataFrame(plain).apply(pd.to_numeric, errors="coerce").to_numpy(dtype=np.float64)
    return found


def _no_thousands(texts: NDArray[np.object_], header: str, name: str) -> None:
    """Refuse marks between thousands: 1,234.5 had been left out, and 1.234 beside 900 had been read as 1.234."""
    plain = [(i, str(text).strip()) for i, text in enumerate(texts, 1)]
    marked = [(i, text) for i, text in plain if re.search(r"[.,]", text)]
    sure = [pair for pair in plain if _TWICE.fullmatch(pair[1])]
    grouped = [pair for pair in marked if re.fullmatch(r"[1-9]\d{0,2}[.,]\d{3}", pair[1])]
    if grouped and len(grouped) == len(marked) and any(re.fullmatch(r"\d{3}", text) for _, text in plain):
        sure = sure or grouped
    if sure:
        raise InputError(
            name,
            f"has marks between thousands in row {sure[0][0]}" + (f", column {header}" if header else ""),
            value=sure[0][1],
            remedy="write no marks between thousands; if these are decimals, write all numbers of the column with them",
        )


# two marks, or one that is no point and no decimal comma
_TWICE = re.compile(
    r"\d{1,3}(?:,\d{3})+\.\d*|\d{1,3}(?:\.\d{3})+,\d*|\d{1,3}(?:[' \u00a0\u2009\u202f]\d{3})+(?:[.,]\d*)?"
)


_ONE = 'name it ("Diameter (nm)"), or say which one it is: --measured-column (column)'


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
        raise InputError(name, f"has {what}", value=", ".join(header), remedy=_ONE)
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
        raise InputError(
            name,
            "does not say the unit of its diameters",
            remedy="give the unit, m, mm, um, nm or px: --measured-unit (unit)",
        )
    if word in _PIXELS:
        if pixel_size is None:
            raise InputError(
                "pixel_size",
                "is needed: the diameters are in pixels",
                remedy='--pixel-size "0.1 um" (pixel_size, in m)',
            )
        return positive("pixel_size", pixel_size, "m")
    return _UNITS[word]


def _is_number(text: str, decimal: str) -> bool:
    try:
        float(text.replace(decimal, ".") if decimal == "," else text)
    except ValueError:
        return False
    return True
