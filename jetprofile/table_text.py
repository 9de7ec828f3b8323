"""Rows and columns of a text table, whichever program wrote it: separators, decimal commas, header, unit row, exponents.

What is found out of the text itself, never guessed where two readings are possible: the header (first line that is no
comment, or the last comment line above the numbers), the separator (that of the header: tab, semicolon, comma or blanks), a
row of units below the header, decimal commas (only where something else separates), Fortran exponents ``1.0D-03``.
"""

import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.workbook import WORKBOOKS, sheet_rows, table_text
from spinline.jetprofile.foreign import foreign_text
from spinline.jetprofile.table_header import (
    NOTHING,
    NUMBER,
    Header,
    bare,
    comment,
    fields_of,
    find_header,
    headers_of,
    is_rule,
    is_units,
    of_programs,
    of_several_words,
    with_told_units,
)

__all__ = ["Header", "TextTable", "read_table_text"]

_COMMA = re.compile(r"[-+]?\d+,\d+(?:[eEdD][-+]?\d+)?")
_NAMES = {",": "commas", ";": "semicolons", "\t": "tabs", None: "blanks"}


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
            text, encoding = table_text(path)
        except InputError as error:
            raise InputError(
                name, f"is not a CSV table: it {error.problem}", allowed=allowed, remedy=error.remedy
            ) from None
        foreign_text(text, name)
        lines, kind = text.rstrip("\x1a").replace("\u2212", "-").splitlines(), f"text table, {encoding}"
    return _parse(lines, name, kind, allowed)


def _parse(lines: list[str], name: str, kind: str, allowed: str) -> TextTable:
    start, title, told = find_header(lines)
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
    headers, mark = headers_of(title, name, kind, allowed)
    headers, kind = of_programs(headers, lines[:start], kind)
    rows = [(i, line) for i, line in enumerate(lines[start:], start + 1) if not bare(line) and not comment(line)]
    headers = of_several_words(headers, mark, title, rows)
    if rows and title != lines[start - 1].strip().lstrip("\ufeff"):  # a comment
        mark = _mark_of_rows(rows[0][1], mark, len(headers))
    headers, body = _below(rows, headers, mark)
    if not any(header.unit for header in headers):
        headers, kind = with_told_units(headers, told, kind)
    seen = f"{kind}, {_NAMES[mark]} between {len(headers)} columns"
    if not body:
        book = "; the table stands on the first sheet, and formulas have numbers once Excel has saved them"
        remedy = f"give at least one row below the header{book if kind.startswith('Excel') else ''}"
        raise InputError(name, f"holds no numbers ({seen})", remedy=remedy)
    _one_block(lines, body, name, seen)
    columns = _numbers(body, mark, headers, name, seen)
    for i, (header, column) in enumerate(zip(headers, columns, strict=True), 1):
        if not header.name and not (np.diff(column) == 1.0).all():  # a column that counts the rows may have no name
            raise InputError(name, f"has no name over column {i} ({seen})", remedy="give every column a name")
    kept = [i for i, header in enumerate(headers) if header.name]
    return TextTable(tuple(headers[i] for i in kept), tuple(columns[i] for i in kept), seen)


def _mark_of_rows(row: str, mark: str | None, count: int) -> str | None:
    """What parts the columns below a comment that names them: a comment may have commas where its rows have blanks."""
    ways = (mark, "\t", ";", ",", None)
    return next((way for way in ways if len(fields_of(row, way)) == count), mark)


def _below(
    rows: list[tuple[int, str]], headers: tuple[Header, ...], mark: str | None
) -> tuple[tuple[Header, ...], list[tuple[int, str]]]:
    """Headers with the units of a row below them, and the rows of numbers; a line of dashes is no row."""
    body = rows[1:] if rows and is_rule(rows[0][1]) else rows
    if not body or not is_units(body[0][1], mark, len(headers)):
        return headers, body
    units = fields_of(body[0][1], mark)
    headers = tuple(Header(h.name, h.unit or u.strip(" []()\"'")) for h, u in zip(headers, units, strict=False))
    body = body[1:]
    if len(body) > 1 and (is_rule(body[0][1]) or is_units(body[0][1], mark, len(headers))):
        body = body[1:]  # dashes, or a third line of words, as Origin's comments
    return headers, body


def _one_block(lines: list[str], body: list[tuple[int, str]], name: str, seen: str) -> None:
    """Refuse rows in blocks that blank lines part, as gnuplot parts curves: they had been strung together as one jet."""
    if body[-1][0] - body[0][0] == len(body) - 1:
        return
    starts = [
        line
        for (before, _), (line, _) in pairwise(body)
        if line - before > 1 and any(bare(between) for between in lines[before : line - 1])
    ]
    if not starts or len(starts) == len(body) - 1:  # none, or one behind every row
        return
    shown = ", ".join(map(str, [body[0][0], *starts[:3]])) + (", ..." if len(starts) > 3 else "")
    problem = f"has its rows in {len(starts) + 1} blocks that blank lines part ({seen}): from lines {shown}"
    remedy = "give each block a file of its own if they are several jets or moments; else take the blank lines out"
    raise InputError(name, problem, remedy=remedy)


def _numbers(
    body: list[tuple[int, str]], mark: str | None, headers: tuple[Header, ...], name: str, seen: str
) -> tuple[FloatArray, ...]:
    count = len(headers)
    quick = _at_once([line for _, line in body], mark, count)
    if quick is not None:
        _no_thousands([(i, fields_of(line, mark)) for i, line in body[:_LOOKED_AT]], mark, headers, name, seen)
        return tuple(quick.T.copy())
    rows = _even([(i, fields_of(line, mark)) for i, line in body], mark, count, name, seen)
    _no_thousands(rows, mark, headers, name, seen)
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
            raise InputError(name, problem, value=text, remedy=_instead(text, header, headers)) from None
        columns.append(column)
    return tuple(columns)


_GROUPED = re.compile(r"[-+]?\d{1,3}(?:([,.' _\u00a0\u2009\u202f])\d{3})(?:\1\d{3})*(?:[.,]\d*)?")


def _instead(text: str, header: Header, headers: tuple[Header, ...]) -> str:
    """What to write for text that is no number."""
    if spread := re.search(r"±|\+/-|\+-", text):
        own = f"{header.name}_std" if header.name else "a column of its own"
        return f"put what stands behind the {spread[0]} into {own}"
    if _GROUPED.fullmatch(text):
        return "write no marks between thousands"
    if any(re.match(rf"{re.escape(one.name)}\b", text) for one in headers if one.name):
        return "a second header, of a second table? Give each jet a file of its own"
    return "write a number, leave the field empty, or take the column out"


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
        elif line == rows[0][0] and not re.match(r"\s*[-+.\d]", fields[0]):
            remedy = "the line above it is taken for the header: begin lines above the names of the columns with #"
        elif mark == ",":
            remedy = "if its decimals are commas, separate the columns by semicolons; else give every column a name"
        else:
            remedy = "give every column a name"
        raise InputError(name, f"{problem} ({count}; {seen})", value=(mark or " ").join(fields), remedy=remedy)
    return rows


_LOOKED_AT = 1000  # rows: marks of thousands show in the first


def _no_thousands(
    rows: list[tuple[int, list[str]]], mark: str | None, headers: tuple[Header, ...], name: str, seen: str
) -> None:
    """Refuse a column of whole numbers and of such as 1.550: no program writes a thousandth's nought so.

    Whole numbers have three digits, or stand beside 1.000; and ``"1,250"`` between commas needs none beside it.
    """
    for j, header in enumerate(headers):
        texts = [(line, fields[j]) for line, fields in rows[:_LOOKED_AT] if j < len(fields) and fields[j]]
        marked = [(line, text) for line, text in texts if re.search("[.,]", text)]
        grouped = [(line, text) for line, text in marked if re.fullmatch(r"[-+]?[1-9]\d{0,2}(?:[.,]\d{3})+", text)]
        if not grouped or len(grouped) < len(marked):
            continue
        thousand = any(text.endswith("000") for _, text in grouped)
        whole = any(re.fullmatch(r"[-+]?\d{1,3}" if thousand else r"[-+]?\d{3}", text) for _, text in texts)
        quoted = mark == "," and any("," in text for _, text in grouped)
        nought = next((pair for pair in grouped if pair[1].endswith("0")), grouped[0] if quoted else None)
        if (whole or quoted) and nought:
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
    if text.lower() in NOTHING:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        if not NUMBER.fullmatch(text):
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
