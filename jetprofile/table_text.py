"""Rows and columns of a text table, whichever program wrote it: separators, decimal commas, header, unit row, exponents.

What is found out of the text itself, never guessed where two readings are possible: the header (first line that is no
comment, or the last comment line above the numbers), the separator (that of the header: tab, semicolon, comma or blanks), a
row of units below the header, decimal commas (only where something else separates), Fortran exponents ``1.0D-03``.
"""

import re
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.text import csv_rows, read_text
from spinline.base.workbook import WORKBOOKS, sheet_rows
from spinline.jetprofile.foreign import foreign_text

__all__ = ["Header", "TextTable", "read_table_text"]

_MARKS = ("#", "%", "!")
_UNIT = r"""(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]|/\s*(?P<over>[^\s,;"]+))?"?\s*"""
_CELL = re.compile(
    r"""\s*"?(?P<name>[^\W\d](?:[\w .:-]*\w)?)\s*""" + _UNIT
)  # where something else than blanks separates
_ERRORS = ("#n/a", "#div/0!", "#value!", "#num!", "#ref!", "#name?", "#null!")  # of spreadsheets: a cell's, no comments
_NOTHING = ("", "na", "n/a", "-", "--", "---", "null", "none", "?", *_ERRORS)
_TOKEN = re.compile(
    r"""\s*"?(?P<name>[^\W\d][\w]*)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]|/\s*(?P<over>[^\s,;"]+))?"?\s*"""
)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+|[-+]\d{3})?|[-+]?(?:inf|nan)", re.IGNORECASE)
_COMMA = re.compile(r"[-+]?\d+,\d+(?:[eEdD][-+]?\d+)?")
_PLACE = re.compile(r"(?:Points|Coordinates|coords)_([012])")
_COMSOL = re.compile(r"%\s*(Model|Version|Dimension)\b", re.IGNORECASE)
_LENGTH = re.compile(r"%\s*Length unit:?[\s,\"]*(\w+)", re.IGNORECASE)
_MOMENT = re.compile(r"\s*@\s*(?:\d+:\s*)?[\w()]+\s*=\s*[-+.\w]+")  # COMSOL: "r (um) @ t=0.1"
_PLACES = ("x", "y", "z", "r", "arc_length")
_NAMES = {",": "commas", ";": "semicolons", "\t": "tabs", None: "blanks"}


@dataclass(frozen=True)
class Header:
    """One column's name and unit, as written; the unit is "" where none stands."""

    name: str
    unit: str


@dataclass(frozen=True)
class TextTable:
    """A table as read.

    Attributes
    ----------
    headers : tuple of Header
    columns : tuple of ndarray
        float64; NaN where a field is empty.
    seen : str
        What the file was taken for, in words, for messages.
    """

    headers: tuple[Header, ...]
    columns: tuple[FloatArray, ...]
    seen: str


def read_table_text(path: str | Path, *, allowed: str) -> TextTable:
    """Read a text table.

    Parameters
    ----------
    path : path
        Text file, or an Excel workbook (its first sheet; needs ``pip install openpyxl``).
    allowed : str
        The columns that would be understood, for messages.

    Returns
    -------
    TextTable

    Raises
    ------
    InputError
        For a file that is no table, has no header, or holds rows that do not fit it; it names the format that was seen.
    """
    name = str(path)
    if not Path(path).exists():
        raise InputError(name, "cannot be read: there is no such file", allowed=allowed, remedy="check the path")
    if Path(path).suffix.lower() in WORKBOOKS:
        lines, kind = ["\t".join(row) for row in sheet_rows(path)], "Excel workbook, its first sheet"
    else:
        try:
            text, encoding = read_text(path)
        except InputError as error:
            raise InputError(
                name, f"is not a CSV table: it {error.problem}", allowed=allowed, remedy=error.remedy
            ) from None
        foreign_text(text, name)
        lines, kind = text.rstrip("\x1a").replace("\u2212", "-").splitlines(), f"text table, {encoding}"
    return _parse(lines, name, kind, allowed)


def _parse(lines: list[str], name: str, kind: str, allowed: str) -> TextTable:
    start, title = _first_row(lines)
    if start is None:
        raise InputError(
            name,
            f"is not a CSV table ({f'{kind}: no line but comments' if any(map(str.strip, lines)) else 'it is empty'})",
            allowed=allowed,
            remedy="give columns with units in the header",
        )
    if title is None:
        raise InputError(
            name,
            f"has no header ({kind}): line {start + 1} is numbers already, and no comment above names them",
            value=lines[start].strip(),
            allowed=allowed,
            remedy=f'put a first line above it, for example "{_example(allowed)}"',
        )
    headers, mark = _headers(title, name, kind, allowed)
    headers, kind = _of_programs(headers, lines[:start], kind)
    body = [(i, line) for i, line in enumerate(lines[start:], start + 1) if not _bare(line) and not _comment(line)]
    headers = _of_several_words(headers, mark, title, body)
    if body and _is_units(body[0][1], mark, len(headers)):
        units = _fields(body[0][1], mark)
        headers = tuple(Header(h.name, h.unit or u.strip(" []()\"'")) for h, u in zip(headers, units, strict=False))
        body = body[1:]
        if len(body) > 1 and _is_units(body[0][1], mark, len(headers)):  # a third line of words, as Origin's comments
            body = body[1:]
    seen = f"{kind}, {_NAMES[mark]} between {len(headers)} columns"
    if not body:
        book = "; the table stands on the first sheet, and formulas have numbers once Excel has saved them"
        remedy = f"give at least one row below the header{book if kind.startswith('Excel') else ''}"
        raise InputError(name, f"holds no numbers ({seen})", remedy=remedy)
    columns = _numbers(body, mark, headers, name, seen)
    for i, (header, column) in enumerate(zip(headers, columns, strict=True), 1):
        if not header.name and not (np.diff(column) == 1.0).all():  # a column that counts the rows may have no name
            raise InputError(name, f"has no name over column {i} ({seen})", remedy="give every column a name")
    kept = [i for i, header in enumerate(headers) if header.name]
    return TextTable(tuple(headers[i] for i in kept), tuple(columns[i] for i in kept), seen)


def _comment(line: str) -> bool:
    bare = line.lstrip()
    return bare.startswith(_MARKS) and not bare.lower().startswith(_ERRORS)


def _bare(line: str) -> bool:
    """Whether a line holds nothing, or nothing between separators, as spreadsheets leave below a table."""
    return not line.strip(' ,;\t\r"')


def _of_programs(headers: tuple[Header, ...], above: list[str], kind: str) -> tuple[tuple[Header, ...], str]:
    """What ParaView calls places, and the unit that COMSOL gives once above the table."""
    if any(_PLACE.fullmatch(header.name) for header in headers):
        places = (_PLACE.fullmatch(header.name) for header in headers)
        named = (Header("xyz"[int(p[1])], h.unit) if p else h for p, h in zip(places, headers, strict=True))
        return tuple(named), f"{kind}, ParaView, whose Points:0, 1, 2 are x, y, z"
    if not any(_COMSOL.match(line) for line in above):
        return headers, kind
    unit = next((found[1] for line in above if (found := _LENGTH.match(line))), "")
    given = (Header(h.name, h.unit or (unit if h.name.lower() in _PLACES else "")) for h in headers)
    return tuple(given), f"{kind}, COMSOL"


def _first_row(lines: list[str]) -> tuple[int | None, str | None]:
    """Where the numbers begin, and the line that names their columns; a workbook's ``sep=;`` is no line of the table."""
    above = None
    for i, line in enumerate(lines):
        if _bare(line) or line.strip().lower().startswith("sep="):
            continue
        if _comment(line):
            words = _MOMENT.sub("", line.lstrip().lstrip("".join(_MARKS))).strip()
            above = words if words else above
            continue
        if _numeric(line):
            return i, above if above is not None and _looks_like_header(above) else None
        return i + 1, line.strip().lstrip("﻿")
    return None, None


def _numeric(line: str) -> bool:
    parts = [part for part in re.split(r"[,;\s]+", line.strip()) if part]
    return bool(parts) and all(_NUMBER.fullmatch(part.strip('"')) for part in parts)


def _looks_like_header(text: str) -> bool:
    return _tokens(text) is not None


def _tokens(text: str) -> tuple[list[Header], str] | None:
    """Names and units of a header line, and what stands between the first two; None if it is no header."""
    found, at, marks = [], 0, []
    text = text.rstrip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None or match.end() == at:
            return None
        found.append(Header(match["name"], match["unit"] or match["over"] or ""))
        at = match.end()
        if at < len(text):
            if text[at] in ",;\t":
                marks.append(text[at])
                at += 1
                while at < len(text) and text[at] == marks[-1] and not text[at + 1 :].strip(marks[-1]).strip():
                    at += 1  # separators behind the last name
            elif text[at - 1].isspace():
                marks.append("\t" if "\t" in match[0] else " ")
            else:
                return None
    return (found, marks[0] if marks else " ") if len(set(marks)) <= 1 else None


def _headers(title: str, name: str, kind: str, allowed: str) -> tuple[tuple[Header, ...], str | None]:
    mark = next((m for m in ("\t", ";", ",") if m in re.sub(r"[\[(].*?[\])]", "", title)), None)
    headers = []
    for part in _fields(title.rstrip(mark + " "), mark) if mark else []:
        match = _CELL.fullmatch(part)
        if part.strip() and match is None:
            raise InputError(
                name,
                f"has a column that is not known ({kind})",
                value=part.strip(),
                allowed=allowed,
                remedy="a header is a name and its unit, z [mm]; begin lines above it with #",
            )
        headers.append(_header(match) if match else Header("", ""))
    if mark is None:
        tokens = _tokens(title)
        if tokens is None:
            raise InputError(
                name,
                f"is not a CSV table ({kind}): its first line is no header",
                value=title,
                allowed=allowed,
                remedy="give columns with units in the header, between commas, semicolons, tabs or blanks; begin others with #",
            )
        headers = tokens[0]
    return tuple(headers), mark


def _header(match: re.Match[str]) -> Header:
    return Header(re.sub(r"[\s.:-]+", "_", match["name"]), match["unit"] or match["over"] or "")


def _of_several_words(
    headers: tuple[Header, ...], mark: str | None, title: str, body: list[tuple[int, str]]
) -> tuple[Header, ...]:
    """Headers that several blanks part, where the columns between blanks are as many: "Arc length (mm)   radius (um)"."""
    parts = re.split(r"\s{2,}", title.strip())
    if mark is not None or not body or len(parts) == len(headers) or len(parts) != len(body[0][1].split()):
        return headers
    found = [_CELL.fullmatch(part) for part in parts]
    return tuple(_header(match) for match in found if match) if all(found) else headers


def _fields(line: str, mark: str | None) -> list[str]:
    if mark is None:
        return line.split()
    if '"' in line:
        with suppress(InputError):
            rows = csv_rows([line], mark, "", skipinitialspace=True)
            return [part.strip() for part in rows[0]] if rows else []
    return [part.strip().strip('"') for part in line.split(mark)]


def _is_units(line: str, mark: str | None, count: int) -> bool:
    fields = [field.strip(" []()") for field in _fields(line, mark)]
    return (
        len(fields) == count
        and any(fields)
        and not any(
            re.match(r"[-+]?[.\d](?!/)", f) or _NUMBER.fullmatch(f) for f in fields
        )  # 1/s is a unit, 0.55 mm is none
        and not any(f.lower() in _NOTHING and f not in ("", "-") for f in fields)
    )


def _numbers(
    body: list[tuple[int, str]], mark: str | None, headers: tuple[Header, ...], name: str, seen: str
) -> tuple[FloatArray, ...]:
    count = len(headers)
    quick = _at_once([line for _, line in body], mark, count)
    if quick is not None:
        _no_thousands([(i, _fields(line, mark)) for i, line in body[:_LOOKED_AT]], headers, name, seen)
        return tuple(quick.T.copy())
    rows = _even([(i, _fields(line, mark)) for i, line in body], mark, count, name, seen)
    _no_thousands(rows, headers, name, seen)
    commas = any(_COMMA.fullmatch(field) for _, fields in rows for field in fields)  # between commas: in quotes
    if commas and any("." in field for _, fields in rows for field in fields):
        line = next(i for i, fields in rows if any("." in field for field in fields))
        raise InputError(
            name,
            f"has both points and commas in its numbers ({seen}), line {line}: which is the decimal?",
            remedy="write decimals one way, and no marks between thousands",
        )
    columns = []
    for j, header in enumerate(headers):
        texts = [fields[j].replace(",", ".") if commas else fields[j] for _, fields in rows]
        try:
            column = _floats(texts)
        except ValueError:
            line, text = next((rows[i][0], text) for i, text in enumerate(texts) if not _readable(text))
            problem = f"holds text among its numbers ({seen}): line {line}, column {header.name}"
            spread = re.search(r"±|\+/-|\+-", text)
            own = f"{header.name}_std" if header.name else "a column of its own"
            remedy = (
                f"put what stands behind the {spread[0]} into {own}"
                if spread
                else "write a number, or leave the field empty"
            )
            raise InputError(name, problem, value=text, remedy=remedy) from None
        columns.append(column)
    return tuple(columns)


def _at_once(lines: list[str], mark: str | None, count: int) -> FloatArray | None:
    """Numbers of a plain table, some million fields a second; None where a row is anything else."""
    if mark is None:
        if any(len(line.split()) != count for line in lines):
            return None
        fields = " ".join(lines).split()
    else:
        if any(line.count(mark) != count - 1 for line in lines):
            return None
        fields = mark.join(lines).split(mark)
    try:
        return np.array(fields, dtype=np.float64).reshape(-1, count)
    except ValueError:
        return None


def _even(
    rows: list[tuple[int, list[str]]], mark: str | None, count: int, name: str, seen: str
) -> list[tuple[int, list[str]]]:
    """Rows of as many fields as the header has names; empty fields behind the last column are dropped where all have them."""
    longest = max(len(fields) for _, fields in rows)
    if longest > count and all(not field for _, fields in rows for field in fields[count:]):
        rows, longest = [(i, fields[:count]) for i, fields in rows], count
    for line, fields in rows:
        if len(fields) == count:
            continue
        more = len(fields) > count
        problem = f"has {'more' if more else 'fewer'} fields in line {line} ({len(fields)}) than the header has names"
        if not more:
            other = len(fields) == 1 and re.search(r"[,;\t ]", fields[0])
            remedy = (
                f"part rows as the header, by {_NAMES[mark]}" if other else "leave a field empty between separators"
            )
        elif mark == ",":
            remedy = "if its decimals are commas, separate the columns by semicolons; else give every column a name"
        else:
            remedy = "give every column a name"
        raise InputError(name, f"{problem} ({count}; {seen})", value=(mark or " ").join(fields), remedy=remedy)
    return rows


_LOOKED_AT = 1000  # rows: marks of thousands show in the first


def _no_thousands(rows: list[tuple[int, list[str]]], headers: tuple[Header, ...], name: str, seen: str) -> None:
    """Refuse a column of whole numbers of three digits and of such as 1.550: no program writes a thousandth's nought so."""
    for j, header in enumerate(headers):
        texts = [(line, fields[j]) for line, fields in rows[:_LOOKED_AT] if j < len(fields) and fields[j]]
        marked = [(line, text) for line, text in texts if re.search("[.,]", text)]
        whole = [text for _, text in texts if re.fullmatch(r"[-+]?\d{3}", text)]
        grouped = [(line, text) for line, text in marked if re.fullmatch(r"[-+]?[1-9]\d{0,2}(?:[.,]\d{3})+", text)]
        nought = next((pair for pair in grouped if pair[1].endswith("0")), None)
        if whole and nought and len(grouped) == len(marked):
            raise InputError(
                name,
                f"has numbers that may have marks between their thousands ({seen}): line {nought[0]}, column {header.name}",
                value=nought[1],
                remedy="write no marks between thousands; if these are decimals, write all numbers of the column with them",
            )


def _floats(texts: list[str]) -> FloatArray:
    try:
        return np.array(texts, dtype=np.float64)  # some ten million fields a second
    except ValueError:
        return np.array([_number(text) for text in texts])


def _number(text: str) -> float:
    if text.lower() in _NOTHING:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        if not _NUMBER.fullmatch(text):
            raise
        text = re.sub("[dD]", "e", text)
        return float(
            re.sub(r"(?<=[\d.])([-+]\d{3})$", r"e\1", text)
        )  # Fortran drops the letter of three-digit exponents


def _readable(text: str) -> bool:
    try:
        _number(text)
    except ValueError:
        return False
    return True


def _example(allowed: str) -> str:
    return ", ".join(allowed.split(", ")[:2])
