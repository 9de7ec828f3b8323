"""Columns with units from a CSV file: ``z [mm], radius [um]``.

Every header names its quantity and, in square or round brackets, its unit; comment lines start with ``#``; comma,
semicolon, tab or blanks separate. A header without a unit is refused: a bare number is not a length.
"""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.units import parse_unit

__all__ = ["read_columns"]

_HEADER = re.compile(r"\s*(?P<name>[A-Za-z_]\w*)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?\s*")


def read_columns(
    path: str | Path, kinds: Mapping[str, str], *, required: tuple[str, ...] = ()
) -> dict[str, FloatArray]:
    """Read the named columns of a CSV file in SI units.

    Parameters
    ----------
    path : path
        CSV file with one header line.
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
        For an unreadable file, an unknown or repeated column, a missing unit or text among the numbers.
    """
    import pandas as pd

    file = str(path)
    allowed = ", ".join(f"{name} [{_unit_example(kind)}]" for name, kind in kinds.items())
    if Path(path).exists() and not Path(path).is_file():
        raise InputError(file, "is not a file", remedy="give a CSV file")
    try:
        with Path(path).open(encoding="utf-8-sig") as stream:
            first = next((line for line in stream if line.strip() and not line.startswith("#")), "")
        separator = next((mark for mark in (",", ";", "\t") if mark in first), r"\s{2,}|(?<=[\])])\s+")
        engine = "c" if len(separator) == 1 else "python"
        frame = pd.read_csv(path, sep=separator, engine=engine, comment="#", encoding="utf-8-sig")  # type: ignore[call-overload]
    except OSError as error:
        raise InputError(file, f"cannot be read ({error.strerror})", remedy="check the path") from None
    except (UnicodeDecodeError, pd.errors.ParserError, pd.errors.EmptyDataError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(
            file, f"is not a CSV table ({reason})", allowed=allowed, remedy="give columns with units in the header"
        ) from None
    columns: dict[str, FloatArray] = {}
    for header in frame.columns:
        match = _HEADER.fullmatch(str(header))
        name = match["name"] if match else str(header)
        if match is None or name not in kinds:
            raise InputError(file, "has a column that is not known", value=str(header), allowed=allowed)
        if name in columns:
            raise InputError(file, "has a column twice", value=name)
        columns[name] = _scaled(frame[header], kinds[name], match["unit"], f"{file}: {name}")
    for name in required:
        if name not in columns:
            raise InputError(file, f"has no column {name}", value=list(map(str, frame.columns)), allowed=allowed)
    return columns


def _scaled(values: object, kind: str, unit: str | None, field: str) -> FloatArray:
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except ValueError as error:
        raise InputError(field, f"holds text among its numbers ({error})") from None
    example = _unit_example(kind)
    if not example:
        if unit not in (None, "", "1", "%"):
            raise InputError(field, "has a unit, but a pure number has none", value=unit, allowed="[%] or none")
        return numbers * 0.01 if unit == "%" else numbers
    if not unit:
        raise InputError(field, "needs a unit in its header", remedy=f'for example "{field.split()[-1]} [{example}]"')
    scale, offset = parse_unit(unit, kind, field)
    return numbers * scale + offset


def _unit_example(kind: str) -> str:
    return {"length": "mm", "velocity": "m/s", "time": "s", "volume": "m3", "number": "", "pressure": "Pa"}[kind]
