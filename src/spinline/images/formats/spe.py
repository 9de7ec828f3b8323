"""SPE: cameras of Princeton Instruments, by WinView (version 2) and LightField (3), which share the places that matter.

4100 bytes, little-endian: columns at 42, type at 108 (0 floats, 1 of 32 bits, 2 of 16, 3 of 16 without sign, 5 doubles, 6 of
8, 8 of 32 without sign), rows at 656, frames at 1446. The frames follow; a footer of version 3 after them is not read.
"""

import struct
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import FrameReader, PlacedFrames, not_cut_short

__all__ = ["FORMAT"]

_TYPES = {0: "<f4", 1: "<i4", 2: "<i2", 3: "<u2", 5: "<f8", 6: "u1", 8: "<u4"}
_HEADER = 4100


class _Spe:
    name = "spe"
    suffixes: tuple[str, ...] = (".spe",)
    inside = False

    def owns(self, head: bytes) -> bool:
        """Never: nothing in the first bytes tells it."""
        return False

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open all frames of a file."""
        with path.open("rb") as file:
            head = file.read(_HEADER)
        if len(head) < _HEADER:
            raise InputError(key, "is cut short", value=path.name, remedy="copy it again")
        (columns,), (number,), (rows,), (frames,) = (
            struct.unpack_from(kind, head, at) for kind, at in (("<H", 42), ("<h", 108), ("<H", 656), ("<i", 1446))
        )
        if min(columns, rows, frames) < 1 or number not in _TYPES:
            raise InputError(
                key,
                "does not begin as SPE does",
                value=f"{path.name}: {frames} frames of {rows} x {columns}, type {number}",
                remedy="save it as TIFF",
            )
        kind = np.dtype(_TYPES[number])
        one = rows * columns * kind.itemsize
        not_cut_short(path, key, _HEADER + frames * one)
        places = range(_HEADER, _HEADER + frames * one, one)
        return PlacedFrames(path, key, places, (rows, columns), kind.str, "SPE")


FORMAT = _Spe()
