"""Text files as people's programs write them: with or without a byte order mark, UTF-8, UTF-16, or a Windows code page."""

import os
import re
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError
from spinline.base.file_format import HDF5_HEAD
from spinline.base.files import note_input, readable
from spinline.base.naming import kind_of, reason_of

__all__ = ["LONGEST_TEXT", "csv_rows", "decoded", "known_binary", "parsed_toml", "read_text", "read_toml_text"]

_DEEPEST = 32
LONGEST_TEXT = 2**31  # bytes of a file that is read whole
_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
# the micro sign of µm there: no two letters that Western text has side by side
_EAST_ASIAN = ((b"\xa6\xccm", "gb18030", "GB 18030"), (b"\x83\xcam", "shift_jis", "Shift JIS"))
_BINARY = (
    (HDF5_HEAD, "an HDF5 file, as netCDF files are"),
    (b"CDF\x01", "a netCDF 3 file"),
    (b"CDF\x02", "a netCDF 3 file"),
    (b"CDF\x05", "a netCDF 3 file"),
    (b"PK\x03\x04", "a zip archive, as workbooks and npz files are"),
    (b"\x1f\x8b", "compressed by gzip"),
    (b"BZh91AY&SY", "compressed by bzip2"),
    (b"\xfd7zXZ\x00", "compressed by xz"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a document of older Office programs (.xls), or one with a password"),
    (b"\x93NUMPY", "an array of numpy.save"),
    (b"\x89PNG\r\n\x1a\n", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"II*\x00", "a TIFF picture"),
    (b"MM\x00*", "a TIFF picture"),
    (b"%PDF-", "a PDF document"),
    (b"MATLAB 5.0 MAT-file", "a MATLAB file (.mat)"),
    (b"MATLAB 7.3 MAT-file", "a MATLAB file (.mat, version 7.3)"),
    (b"\x28\xb5\x2f\xfd", "compressed by zstd"),
)


_PACKED = (
    (b"xl/", "an Excel workbook"),
    (b"opendocument.spreadsheet", "an OpenDocument workbook"),
    (b"word/", "a Word document"),
)  # what the archive of one names
_TEXT = "give a text file, or save it as text, UTF-8"
_SHEET = "save its sheet as CSV (UTF-8)"


def known_binary(head: bytes) -> str:
    """What a file of a well-known binary format is, by its first bytes (of zip archives some thousand); "" for any other."""
    if head.startswith(b"PK\x03\x04"):
        found = next((what for name, what in _PACKED if name in head), "")
        if found:
            return found
    return next((what for mark, what in _BINARY if head.startswith(mark)), "")


def decoded(data: bytes, name: str, binary: str = _TEXT) -> tuple[str, str]:
    """Text of a file's bytes, and the encoding it was written in.

    Parameters
    ----------
    data : bytes
        The whole file.
    name : str
        Of the file, for the error.
    binary : str
        Remedy where the file is of a well-known binary format.

    Returns
    -------
    text : str
        Line ends are those of the file; a byte order mark is gone.
    encoding : str
        "UTF-8", "UTF-16" or "Windows-1252" (taken where the bytes are no UTF-8: the micro sign of older spreadsheets).

    Raises
    ------
    InputError
        For bytes that are text in none of them.
    """
    if what := known_binary(data):
        sheet = what.endswith("workbook") or ".xls" in what
        raise InputError(name, f"is {what}, and no text", remedy=_SHEET if sheet and binary == _TEXT else binary)
    for mark, codec in _MARKS:
        if data.startswith(mark):
            return _as(data, codec, name), "UTF-8" if codec == "utf-8-sig" else "UTF-16"
    head = data[:400]
    if head.count(0) > len(head) // 4:  # Latin letters in UTF-16 without its mark
        codec = "utf-16-le" if head[1::2].count(0) > head[0::2].count(0) else "utf-16-be"
        return _as(data, codec, name), "UTF-16"
    if b"\0" in data:
        raise InputError(name, "is not text: it holds zero bytes", remedy="save it as text, UTF-8")
    try:
        return data.decode("utf-8"), "UTF-8"
    except UnicodeDecodeError:
        for micro, codec, encoding in _EAST_ASIAN:
            if micro in data:
                with suppress(UnicodeDecodeError):
                    return data.decode(codec), encoding
        text = _as(data, "cp1252", name)
        if any(ord(letter) < 32 and letter not in "\t\n\r\f\v" for letter in text):
            raise InputError(name, "is not text", remedy="save it as text, UTF-8") from None
        return text, "Windows-1252"


def _as(data: bytes, codec: str, name: str) -> str:
    try:
        text = data.decode(codec)
    except UnicodeDecodeError:
        raise InputError(
            name, f"is not text, in {codec.removesuffix('-sig').upper()}", remedy="save it as UTF-8"
        ) from None
    if "\0" in text:
        raise InputError(name, "is not text: it holds zero bytes", remedy="save it as text, UTF-8")
    if (
        text and codec.startswith("utf-16") and not any(letter.isascii() for letter in text)
    ):  # a table has digits or line ends
        raise InputError(name, "is not text, in UTF-16", remedy="save it as UTF-8")
    return text


def csv_rows(lines: Iterable[str], mark: str, name: str, **options: Any) -> list[list[str]]:
    """Cells of a table's lines, row by row, those without a cell left out.

    Parameters
    ----------
    lines : iterable of str
        With their ends: a cell in quotes may hold some.
    mark : str
        Between cells.
    name : str
        Of the file, for the error.
    **options
        Of `csv.reader`.

    Raises
    ------
    InputError
        For a quote that is not closed, or a cell that never ends.
    """
    import csv

    reader = csv.reader(lines, delimiter=mark, strict=True, **options)
    try:
        return [row for row in reader if row]
    except csv.Error as error:
        raise InputError(
            name, f"is no table from row {reader.line_num} on ({error})", remedy="close every quote, shorten that cell"
        ) from None


def read_text(path: str | Path, *, most: int = LONGEST_TEXT) -> tuple[str, str]:
    """Text of a file and its encoding, as `decoded`.

    Raises
    ------
    InputError
        If it cannot be read, is no regular file, is longer than `most` bytes, or is no text.
    """
    file, name = readable(path), str(path)
    try:
        size = file.stat().st_size
        if size > most:
            raise InputError(name, f"is {size} bytes long", allowed=f"up to {most}", remedy="give a shorter file")
        data = file.read_bytes()
    except OSError as error:
        raise InputError(name, f"cannot be read ({error.strerror})", remedy="check the path") from None
    return decoded(data, name)


_JETS = '; a jet is named in one: [jet] profile = "lagrangian", path = "..."'


def read_toml_text(
    path: str | Path, noun: str, longest: int, remedy: str = "check the path"
) -> tuple[dict[str, Any], str]:
    """Tables and text of a TOML file, or of the shell's ``/dev/stdin`` and ``<(...)``; what it names counts as input.

    Parameters
    ----------
    path : path
    noun : str
        What it should be, for errors: "scene".
    longest : int
        Characters.
    remedy : str
        For a file that cannot be read.

    Raises
    ------
    InputError
        If it cannot be read, is too long, or is no TOML.
    """
    name = str(path)
    from_shell = name.startswith(("/dev/stdin", "/dev/fd/", "/proc/self/fd/"))
    try:
        mode = os.stat(path).st_mode
        if not stat.S_ISREG(mode) and not (from_shell and stat.S_ISFIFO(mode)):
            raise InputError(name, f"cannot be read as a {noun} (it is {kind_of(mode)})", remedy=remedy)
        with Path(path).open("rb") as file:
            give = f"give a {noun}, a TOML text{_JETS if noun == 'scene' else ''}"
            text, _ = decoded(file.read(4 * longest + 1), name, give)
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(name, f"cannot be read as a {noun} ({reason_of(error)})", remedy=remedy) from None
    if len(text) > longest:
        raise InputError(name, f"is too long for a {noun}", allowed=f"up to {longest} characters")
    data = parsed_toml(text, name, noun)
    note_input(path)
    _note_named(data, Path(path).resolve().parent)
    return data, text


def parsed_toml(text: str, name: str, noun: str) -> dict[str, Any]:
    """Tables of TOML text.

    Raises
    ------
    InputError
        For text that is no TOML, or nested without end.
    """
    import tomllib

    try:
        data = tomllib.loads(text)
        if _depth(data) <= _DEEPEST:
            return data
        reason = f"nested deeper than {_DEEPEST} tables"
    except RecursionError:
        reason = "nested too deeply"
    except ValueError as error:  # TOMLDecodeError is one; numbers of thousands of digits are others
        reason = str(error)
    remedy = _toml_hint(text, reason) or "see `spinline scenes --copy`"
    if noun.startswith("scene") and name.lower().endswith((".csv", ".tsv", ".txt", ".dat")):
        remedy = f'a table is named in a scene, [jet] profile = "table", path = "{name}"; see `spinline scenes --copy`'
    raise InputError(name, f"is not a TOML {noun} ({reason})", remedy=remedy)


def _toml_hint(text: str, reason: str) -> str:
    """What to write in the line that TOML stops at, "" where that is not plain."""
    if "\r" in text.replace("\r\n", "") and "\n" not in text:
        return "its lines end as on old Macs: save it with line ends of Unix or Windows"
    first = next((line.strip() for line in text.splitlines() if line.strip()), "")
    if first.startswith("{") or re.fullmatch(r"\w+:", first):
        return "it looks like JSON or YAML: in TOML a section is [jet] and a line in it key = value"
    where = re.search(r"at line (\d+)", reason)
    lines = re.split(r"\r?\n", text)
    line = lines[int(where[1]) - 1].strip() if where and 0 < int(where[1]) <= len(lines) else ""
    if not line or len(line) > 200:
        return ""
    if re.search("[\u201c\u201d\u201e\u201f\u00ab\u00bb\u2018\u2019]", line):
        return f'write plain quotes, ", in {line}'
    key, equals, value = (part.strip() for part in line.partition("="))
    if not equals:
        colon = re.fullmatch(r"([\w.-]+)\s*:\s*(.+)", line)
        return (
            f'write "=" behind the key: {colon[1]} = {colon[2]}'
            if colon
            else f"a line is [section], or key = value: {line}"
        )
    strange = not re.fullmatch(r"[A-Za-z0-9_.\-\s\"']+", key) or re.search(r"[\w]\s+\w", key)
    if strange and value[:1] not in "{[":
        return f"a key is of letters, digits and _: {line}"
    if re.fullmatch(r"[-+]?\d+,\d+", value):
        return f"write a decimal point: {key} = {value.replace(',', '.')}"
    if value[:1] not in "\"'[{":
        return f'write it in quotes: {key} = "{value}"'
    if value[:1] == "{":
        return f"names of other than letters, digits, _ and - stand in quotes: {line}"
    return f"look at {line}"


def _depth(data: Any) -> int:
    """How deep tables and arrays are nested, without recursion."""
    deepest, todo = 0, [(data, 1)]
    while todo:
        one, depth = todo.pop()
        deepest = max(deepest, depth)
        if isinstance(one, dict | list) and depth <= _DEEPEST:
            todo += [(inner, depth + 1) for inner in (one.values() if isinstance(one, dict) else one)]
    return deepest


def _note_named(data: Any, folder: Path) -> None:
    """Files that a scene names are inputs of the command, whether they are read yet or not."""
    if isinstance(data, dict):
        for value in data.values():
            _note_named(value, folder)
    elif isinstance(data, list):
        for value in data[:1000]:
            _note_named(value, folder)
    elif isinstance(data, str) and 0 < len(data) < 4096:
        note_input(folder / data.partition(":/")[0])
