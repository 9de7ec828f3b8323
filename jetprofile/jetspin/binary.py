"""Frames of ``traj.dat`` and ``save.dat`` (JETSPIN 1.21): a parameter block, then one group of records each.

Sizes are taken from what the style and the dimension demand and compared with the markers in the file, so
that a damaged count can neither ask for memory nor send the reader astray.
"""

import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.block import BLOCK_BYTES, SYSTEMS, parse_block
from spinline.jetprofile.jetspin.content import Content, forget_pages
from spinline.jetprofile.jetspin.fortran import skip_records
from spinline.jetprofile.jetspin.frames import Block, Floats, FrameList, Integers
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.placeholder import drop_placeholders

__all__ = ["BinarySource"]

_MARK = b"\4\0\0\0"
_HEAD = struct.Struct("<iiidi")
_FRAME = struct.Struct("<iii" + "iiiidii" + "iiiii")  # records a, b and, for styles from 3, c
# what follows position, stress and velocity, by style
_EXTRA = {
    1: (),
    2: ("mass", "charge"),
    3: ("mass", "charge", "index"),
    4: ("mass", "charge", "label"),
    5: ("mass", "charge", "volume"),
    6: ("mass", "charge", "volume", "anchor"),
    7: ("mass", "charge", "volume", "anchor", "broken"),
}


class BinarySource:
    """Frames of a ``traj.dat`` or ``save.dat``, SI.

    Parameters
    ----------
    path : Path
    content : bytes or mmap
        What is in it.
    notes : Notes
    """

    def __init__(self, path: Path, content: Content, notes: Notes) -> None:
        self.name = self.files = path.name
        self.position_error = 0.0
        self.notes = notes
        self._content = content
        self.parameters = parse_block(self._content[:BLOCK_BYTES], path.name, notes)
        system = self.parameters.system
        self.style, self.dimension = self._first_style(system)
        vector = ("x", "y", "z") if self.dimension == 3 else ("x",)
        speed = tuple(f"velocity_{axis}" for axis in vector)
        self.columns = (*vector, "stress", *speed, *_EXTRA[self.style])
        self._size = 4 * len(self.columns)
        self._bead_mark = self._size.to_bytes(4, "little")
        frames = self._scan()
        self.time: Floats = np.array(frames.time, dtype=np.float64)
        self.weight: Integers = np.array(frames.rows, dtype=np.int64)
        self._offset = np.array(frames.offset, dtype=np.int64)
        self._inserted = np.array(frames.extra, dtype=np.int64)

    def _first_style(self, system: int | None) -> tuple[int, int]:
        """Style and dimension, by the first whole frame whose header makes sense."""
        at = BLOCK_BYTES
        while True:
            head = skip_records(self._content, at, (4, 24))
            if head is not None:
                _, style, own, _, _ = _HEAD.unpack(head[1])
                if 8 <= style <= 16:
                    raise InputError(
                        self.name,
                        f"binary style {style}, of JETSPIN 1.22 or later, which is not read",
                        remedy="read its frame*.xyz with log.txt, or write a traj.dat of style 5",
                    )
                if own in SYSTEMS and style in _EXTRA and (system is None or own == system):
                    return style, 1 if own in (1, 2) else 3
            at = self._search(at + 1)
            if at < 0:
                raise InputError(
                    self.name,
                    "holds no whole frame",
                    remedy="read the XYZ files of the run, or let it run longer",
                )

    def _search(self, start: int) -> int:
        """Where the next group of records may begin, at or after `start`, or -1."""
        while True:
            at = self._content.find(b"\4\0\0\0\x18\0\0\0", start + 8) - 8
            if at < start:
                return -1
            if self._content[at : at + 4] == _MARK:
                return at
            start = at + 1

    def _scan(self) -> FrameList:
        """Find the whole frames: time, offset of the first bead, number of beads, the inserted flag."""
        found = FrameList()
        at, size = BLOCK_BYTES, len(self._content)
        add = self.notes.add
        released = 0
        while 0 <= at < size:
            frame = self._frame(at)
            if frame is not None:
                time, first, rows, inserted, stop = frame
                if stop <= size and self._content[stop : stop + 4] != self._bead_mark:
                    found.add(time, first, rows, inserted)
                    at = stop
                    if at - released > 64 << 20:
                        forget_pages(self._content)
                        released = at
                    continue
            behind = self._search(at + 1)
            if behind < 0 and (frame is not None or size - at < 60):
                add("the last frame is cut off and left out", dropped=True)
            else:
                add("{n} damaged frames left out", dropped=True)
            at = behind
        if not found.time:
            raise InputError(
                self.name,
                "holds no whole frame",
                remedy="read the XYZ files of the run, or let it run longer",
            )
        return found

    def _frame(self, at: int) -> tuple[float, int, int, int, int] | None:
        """Time, first bead, number of beads, inserted flag and end of a frame, if its head is sound."""
        content = self._content
        if at + 64 > len(content):
            return None
        words = _FRAME.unpack_from(content, at)
        marks, span = (words[0], words[2], words[3], words[9]), words[10:]
        rows, style, system, time, inserted = words[4:9]
        if marks != (4, 4, 24, 24) or rows < 1 or style != self.style or inserted not in (0, 1, -1):
            return None
        if {1: 1, 2: 1, 3: 3, 4: 3}.get(system) != self.dimension:
            return None
        first = at + 44
        if style >= 3:
            if span[0] != 12 or span[4] != 12 or (style != 4 and span[3] - span[2] + 1 != rows):
                return None
            first += 20
        return time, first, rows, int(inserted != 0), first + rows * (self._size + 8)

    def load(self, frames: Integers, notes: Notes) -> Block:
        """Beads of the frames with these numbers, SI."""
        width = self._size + 8
        length = self.weight[frames]
        first = np.cumsum(length) - length
        words = np.empty((int(length.sum()), width // 4), dtype="<u4")
        for begin, rows, at in zip(first.tolist(), length.tolist(), self._offset[frames].tolist(), strict=True):
            part = np.frombuffer(self._content, dtype="<u4", count=rows * width // 4, offset=at)
            words[begin : begin + rows] = part.reshape(rows, -1)
            del part
        forget_pages(self._content)
        marks = (words[:, 0] != self._size) | (words[:, -1] != self._size)
        notes.add("{n} bead records with damaged markers", int(marks.sum()))
        values, bad = self._values(words)
        notes.add("{n} beads hold numbers that are not finite, now NaN", int(bad.sum()))
        bad |= marks
        block = Block(
            time=self.time[frames],
            first=first,
            length=length.copy(),
            values=values,
            bad=bad,
            reaches_nozzle=np.ones(len(frames), dtype=np.bool_),
            inserted=self._inserted[frames] != 0,
        )
        drop_placeholders(block, self.parameters, notes)
        return block

    def _values(self, words: NDArray[np.uint32]) -> tuple[dict[str, Floats], NDArray[np.bool_]]:
        """Columns in SI, and the rows with numbers that are not finite."""
        p = self.parameters
        assert p.length_unit is not None
        assert p.time_unit is not None
        scale = {
            **dict.fromkeys("xyz", p.length_unit),
            **{f"velocity_{axis}": p.length_unit / p.time_unit for axis in "xyz"},
            "stress": p.stress_unit,
            "mass": p.mass_unit,
            "charge": p.charge_unit,
            "volume": p.length_unit**3,
        }
        bad = np.zeros(len(words), dtype=np.bool_)
        values: dict[str, Floats] = {}
        numbers = words.view("<f4")
        for number, name in enumerate(self.columns, 1):
            factor = scale.get(name)
            if factor is None:
                continue
            broken = (words[:, number] & 0x7F800000) == 0x7F800000
            some = bool(broken.any())
            if some:
                words[broken, number] = 0
                bad |= broken
            column = numbers[:, number].astype(np.float64)
            column *= factor
            if some:
                column[broken] = np.nan
            values[name] = column
        return values, bad
