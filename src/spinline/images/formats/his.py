"""HIS, two kinds of one name: sequences of Hamamatsu's HiPic and ORCA software, and frames of flat panels by PerkinElmer.

Hamamatsu: every frame has 64 bytes of its own, "IM", then 16-bit numbers: length of a comment, columns, rows, two offsets, type
(0 of 8, 2 of 16, 3 of 32 bits), the comment and the pixels.

PerkinElmer: 0x7000, then the size of this header (68), its version, the file's size (32 bits), the size of a second header,
the corners left, top, right, bottom, and the number of frames; at 32 the type (2 of 8 bits, 4 of 16, 32 of 32, 64 doubles, 128
floats). The frames follow both headers. All numbers are little-endian.
"""

import struct
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import FrameReader, PlacedFrames, not_cut_short

__all__ = ["FORMAT"]

_HAMAMATSU = {0: "u1", 2: "<u2", 3: "<u4"}
_PERKIN_ELMER = {2: "u1", 4: "<u2", 32: "<u4", 64: "<f8", 128: "<f4"}
_OWN = 64  # bytes before a frame of Hamamatsu's
_FLAT_PANEL = struct.pack("<H", 0x7000)


def _kind(types: dict[int, str], number: int, key: str, path: Path) -> str:
    if number not in types:
        raise InputError(
            key,
            "holds pixels of a type that is not read",
            value=f"{path.name}: type {number}",
            remedy="save it as TIFF",
        )
    return types[number]


def _hamamatsu(path: Path, key: str) -> FrameReader:
    places: list[int] = []
    size, at = path.stat().st_size, 0
    first: tuple[int, int, int] | None = None
    with path.open("rb") as file:
        while at + _OWN <= size:
            file.seek(at)
            head = file.read(_OWN)
            if head[:2] != b"IM":
                break
            comment, columns, rows, _, _, number = struct.unpack_from("<6H", head, 2)
            first = first or (rows, columns, number)
            if (rows, columns, number) != first:
                raise InputError(
                    key,
                    "has frames of different sizes",
                    value=path.name,
                    remedy="split the file into frames of one size",
                )
            kind = np.dtype(_kind(_HAMAMATSU, number, key, path))
            if at + _OWN + comment + rows * columns * kind.itemsize > size:
                raise InputError(
                    key, "is cut short", value=f"{path.name}: in frame {len(places)}", remedy="copy it again"
                )
            places.append(at + _OWN + comment)
            at += _OWN + comment + rows * columns * kind.itemsize
    if first is None:
        raise InputError(key, "holds no frame", value=path.name, remedy="copy it again")
    return PlacedFrames(path, key, places, first[:2], _HAMAMATSU[first[2]], "Hamamatsu HIS")


def _perkin_elmer(path: Path, key: str, head: bytes) -> FrameReader:
    own, _, _, more, left, top, right, bottom, frames = struct.unpack_from("<HHIHHHHHH", head, 2)
    kind = np.dtype(_kind(_PERKIN_ELMER, struct.unpack_from("<H", head, 32)[0], key, path))
    rows, columns = bottom - top + 1, right - left + 1
    if rows < 1 or columns < 1 or frames < 1:
        raise InputError(
            key, "holds no frame", value=f"{path.name}: {frames} of {rows} x {columns}", remedy="copy it again"
        )
    one = rows * columns * kind.itemsize
    not_cut_short(path, key, own + more + frames * one)
    places = [own + more + i * one for i in range(frames)]
    return PlacedFrames(path, key, places, (rows, columns), kind.str, "PerkinElmer HIS")


class _His:
    name = "his"
    suffixes: tuple[str, ...] = (".his",)
    inside = False

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as one of the two does."""
        return head.startswith(_FLAT_PANEL) or (head.startswith(b"IM") and len(head) >= 14 and head[12] in _HAMAMATSU)

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open all frames of a file."""
        with path.open("rb") as file:
            head: Any = file.read(68)
        if head.startswith(_FLAT_PANEL) and len(head) == 68:
            return _perkin_elmer(path, key, head)
        if head.startswith(b"IM"):
            return _hamamatsu(path, key)
        raise InputError(
            key, "begins as neither of the two kinds of HIS does", value=path.name, remedy="save it as TIFF"
        )


FORMAT = _His()
