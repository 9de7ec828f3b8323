"""MRC (also CCP4 map): stacks of electron and X-ray microscopes, as MRC2014 defines them.

1024 bytes: columns, rows and sections as 32-bit numbers, mode (0 of 8 bits, 1 of 16, 2 floats, 6 of 16 bits without sign),
at 92 the size of a second header, at 208 "MAP ", at 212 the order of bytes (0x44 little, 0x11 big). The sections follow.
"""

import struct
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import FrameReader, PlacedFrames, not_cut_short

__all__ = ["FORMAT"]

_MODES = {0: "i1", 1: "i2", 2: "f4", 6: "u2"}
_HEADER = 1024


class _Mrc:
    name = "mrc"
    suffixes: tuple[str, ...] = (".mrc", ".mrcs", ".map", ".st", ".ali", ".rec")
    inside = False

    def owns(self, head: bytes) -> bool:
        """Never: what tells the format stands at byte 208."""
        return False

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open all sections of a file."""
        with path.open("rb") as file:
            head = file.read(_HEADER)
        if len(head) < _HEADER:
            raise InputError(key, "is cut short", value=path.name, remedy="copy it again")
        order = ">" if head[212] == 0x11 else "<"
        columns, rows, sections, mode = struct.unpack_from(f"{order}4i", head)
        (more,) = struct.unpack_from(f"{order}i", head, 92)
        if min(columns, rows, sections) < 1 or more < 0 or max(columns, rows) > 1 << 20:
            raise InputError(
                key,
                "does not begin as MRC does",
                value=f"{path.name}: {sections} sections of {rows} x {columns}",
                remedy="save it as TIFF",
            )
        if mode not in _MODES:
            raise InputError(
                key,
                "holds no counts",
                value=f"{path.name}: mode {mode}",
                allowed=", ".join(map(str, _MODES)),
                remedy="save it as TIFF",
            )
        kind = np.dtype(order + _MODES[mode])
        one = rows * columns * kind.itemsize
        not_cut_short(path, key, _HEADER + more + sections * one)
        places = range(_HEADER + more, _HEADER + more + sections * one, one)
        return PlacedFrames(path, key, places, (rows, columns), kind.str, "MRC")


FORMAT = _Mrc()
