"""What names the columns of a text table: a header line or a comment above the numbers, and where units stand.

Units stand beside the names, in a row of their own below them, or in a comment above: ``# z [mm]  r [um]`` over ``z r``,
``# mm um`` under ``# z r``.
"""

import re
from contextlib import suppress
from dataclasses import dataclass

from spinline.base.errors import InputError
from spinline.base.text import csv_rows
from spinline.base.units import parse_unit

__all__ = [
    "NOTHING",
    "NUMBER",
    "Header",
    "bare",
    "comment",
    "fields_of",
    "find_header",
    "headers_of",
    "is_rule",
    "is_units",
    "of_programs",
    "of_several_words",
    "with_told_units",
]

_MARKS = ("#", "%", "!")
_UNIT = r"""(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]|/\s*(?P<over>[^\s,;"]+))?"?\s*"""
_CELL = re.compile(
    r"""\s*"?(?P<name>[^\W\d](?:[\w .:-]*\w)?)\s*""" + _UNIT
)  # where something else than blanks separates
_ERRORS = ("#n/a", "#div/0!", "#value!", "#num!", "#ref!", "#name?", "#null!")  # of spreadsheets: a cell's, no comments
NOTHING = ("", "na", "n/a", "-", "--", "---", "null", "none", "?", *_ERRORS)
_TOKEN = re.compile(
    r"""\s*"?(?P<name>[^\W\d][\w]*)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]|/\s*(?P<over>[^\s,;"]+))?"?\s*"""
)
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+|[-+]\d{3})?|[-+]?(?:inf|nan)", re.IGNORECASE)
_PLACE = re.compile(r"(?:Points|Coordinates|coords)_([012])")
_COMSOL = re.compile(r"%\s*(Model|Version|Dimension)\b", re.IGNORECASE)
_LENGTH = re.compile(r"%\s*Length unit:?[\s,\"]*(\w+)", re.IGNORECASE)
_MOMENT = re.compile(r"\s*@\s*(?:\d+:\s*)?[\w()]+\s*=\s*[-+.\w]+")  # COMSOL: "r (um) @ t=0.1"
_PLACES = ("x", "y", "z", "r", "arc_length")
_RULE = re.compile(r"[\s,;|+]*(?:[-=_]{2,}[\s,;|+]*)+")
_IN = re.compile(r"(?<=\w)\s+in\s+(?=[^\W\d])")  # "z in mm"
_UNITS = re.compile(r"^\s*units?\s*[:=]?\s*", re.IGNORECASE)


@dataclass(frozen=True)
class Header:
    """One column's name and unit, as written; the unit is "" where none stands."""

    name: str
    unit: str


def comment(line: str) -> bool:
    """Whether a line is a comment, and no cell of a spreadsheet's error."""
    bare = line.lstrip()
    return bare.startswith(_MARKS) and not bare.lower().startswith(_ERRORS)


def bare(line: str) -> bool:
    """Whether a line holds nothing, or nothing between separators, as spreadsheets leave below a table."""
    return not line.strip(' ,;\t\r"')


def of_programs(headers: tuple[Header, ...], above: list[str], kind: str) -> tuple[tuple[Header, ...], str]:
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


def find_header(lines: list[str]) -> tuple[int | None, str | None, list[str]]:
    """Where the numbers begin, the line that names their columns, and the comments above the numbers, without their marks.

    A workbook's ``sep=;`` is no line of the table.
    """
    told: list[str] = []
    named: tuple[int, str] | None = None
    for i, line in enumerate(lines):
        if bare(line) or line.strip().lower().startswith("sep="):
            continue
        if comment(line):
            words = _MOMENT.sub("", line.lstrip().lstrip("".join(_MARKS))).strip()
            told += [words] if words else []
        elif named is not None:
            return (*named, told)
        elif _numeric(line):
            return i, _named_by(told, len(_parts(line))), told
        else:
            named = i + 1, line.strip().lstrip("\ufeff")
    return (*named, told) if named is not None else (None, None, told)


def _named_by(told: list[str], count: int) -> str | None:
    """The comment that names `count` columns: the last one with units, else the last that is not all units."""
    fitting = [
        (words, found[0]) for words in map(_bracketed, told) if (found := _tokens(words)) and len(found[0]) == count
    ]
    for words, headers in reversed(fitting):
        if any(header.unit for header in headers):
            return words
    for words, _ in reversed(fitting):
        if not _units_alone(words, count):
            return words
    return told[-1] if told and _tokens(told[-1]) is not None else None


def with_told_units(headers: tuple[Header, ...], told: list[str], kind: str) -> tuple[tuple[Header, ...], str]:
    """Headers with the units that a comment gives them, by their names or in their order; and what was seen."""
    names = [header.name.lower() for header in headers]
    for words in reversed(told):
        found = _tokens(_bracketed(words))
        if found and [h.name.lower() for h in found[0]] == names and any(h.unit for h in found[0]):
            given = (Header(h.name, h.unit or t.unit) for h, t in zip(headers, found[0], strict=True))
            return tuple(given), f"{kind}, units of a comment"
        units = _units_alone(words, len(headers))
        if units and not any(header.unit for header in headers):
            return tuple(Header(h.name, u) for h, u in zip(headers, units, strict=True)), f"{kind}, units of a comment"
    return headers, kind


def _bracketed(words: str) -> str:
    """Words such as "z in mm, r in um" as "z / mm, r / um"."""
    return _IN.sub(" / ", words)


def _units_alone(words: str, count: int) -> list[str]:
    """Units where a line is `count` of them and nothing else, in brackets or bare; else none."""
    parts = [part.strip("[]()\"'") for part in _parts(_UNITS.sub("", words, count=1))]
    return parts if len(parts) == count and all(map(_is_unit, parts)) else []


def _is_unit(text: str) -> bool:
    for kind in ("length", "velocity", "time"):
        with suppress(InputError):
            parse_unit(text, kind, text)
            return True
    return False


def is_rule(line: str) -> bool:
    """Whether a line is drawn below a header: dashes."""
    return bool(_RULE.fullmatch(line))


def _parts(line: str) -> list[str]:
    return [part for part in re.split(r"[,;\s]+", line.strip()) if part]


def _numeric(line: str) -> bool:
    parts = _parts(line)
    return bool(parts) and all(NUMBER.fullmatch(part.strip('"')) for part in parts)


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


def headers_of(title: str, name: str, kind: str, allowed: str) -> tuple[tuple[Header, ...], str | None]:
    """Headers of a line, and what stands between them: None for blanks."""
    mark = next((m for m in ("\t", ";", ",") if m in re.sub(r"[\[(].*?[\])]", "", title)), None)
    headers = []
    for part in fields_of(title.rstrip(mark + " "), mark) if mark else []:
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


def of_several_words(
    headers: tuple[Header, ...], mark: str | None, title: str, body: list[tuple[int, str]]
) -> tuple[Header, ...]:
    """Headers that several blanks part, where the columns between blanks are as many: "Arc length (mm)   radius (um)"."""
    parts = re.split(r"\s{2,}", title.strip())
    if mark is not None or not body or len(parts) == len(headers) or len(parts) != len(body[0][1].split()):
        return headers
    found = [_CELL.fullmatch(part) for part in parts]
    return tuple(_header(match) for match in found if match) if all(found) else headers


def fields_of(line: str, mark: str | None) -> list[str]:
    """Cells of a line."""
    if mark is None:
        return line.split()
    if '"' in line:
        with suppress(InputError):
            rows = csv_rows([line], mark, "", skipinitialspace=True)
            return [part.strip() for part in rows[0]] if rows else []
    return [part.strip().strip('"') for part in line.split(mark)]


def is_units(line: str, mark: str | None, count: int) -> bool:
    """Whether a line below the header is words: its units."""
    fields = [field.strip(" []()") for field in fields_of(line, mark)]
    return (
        len(fields) == count
        and any(fields)
        and not any(
            re.match(r"[-+]?[.\d](?!/)", f) or NUMBER.fullmatch(f) for f in fields
        )  # 1/s is a unit, 0.55 mm is none
        and not any(f.lower() in NOTHING and f not in ("", "-") for f in fields)
    )
