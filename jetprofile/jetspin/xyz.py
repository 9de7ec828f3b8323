"""Frames of ``traj.xyz`` and ``frame*.xyz``.

A first pass finds the frames (two header lines and so many rows; by jumping, or by search where the text is
damaged), a second one reads the rows of those that are wanted. Files are mapped, so that a trajectory may
be larger than memory.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spinline.jetprofile.jetspin.content import Content, content_of, forget_pages
from spinline.jetprofile.jetspin.frames import Block, Floats, FrameList, Integers, order_frames
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters
from spinline.jetprofile.jetspin.units import floats_of, to_float
from spinline.jetprofile.jetspin.xyz_rows import DAMAGED, OVERFLOW, UNREADABLE, parse_rows

__all__ = ["XyzSource", "scan_frames"]

_HEADER = re.compile(rb" {0,20}([0-9]{1,10})\r?\nframe at time([ 0-9.+\-EeDd*]{20})[ 0-9*]{10}\r?\n")
_TIME, _NUMBER = (np.isin(np.arange(256), list(known)) for known in (b" 0123456789.+-EeDd*", b" 0123456789*"))
_LINE = 38  # bytes of a row without its end
_LIKE, _MANY = 8, 32  # frames in a row alike, and frames that are left, for which others like them are looked for
_Read = tuple[Block, Floats, NDArray[np.uint8], Integers]
_KEEP = 64 << 20  # bytes of small files kept after the first pass


def scan_frames(content: Content, notes: Notes) -> FrameList:
    """Find the whole frames of an XYZ text: time, offset of the first row, number of rows, line length."""
    found = FrameList()
    size = len(content)
    at = _next_header(content, 0, notes)
    released = apart = alike = 0
    while at < size:
        head = _HEADER.match(content, at)
        count = int(head[1]) if head is not None else 0
        if head is None or count < 1:
            end = content.find(b"\n", at, at + 32) + 1
            if not content[at : at + 4096].strip():
                break
            notes.add("{n} frames with a damaged header left out", dropped=True)
            at = _next_header(content, max(at, end) + 1, notes, quiet=True)
            continue
        first = head.end()
        stride = 40 if content[first + 38 : first + 40] == b"\r\n" else 39
        after = first + count * stride
        whole = after <= size or (after - size <= stride - 38 and content[size - 1 :] not in (b"\n",))
        if whole and (after >= size or _ends_here(content, after)):
            stop = min(after, size)
        else:
            stop = _frame_end(content, first)
            lines = _count_lines(content, first, stop, count)
            if lines != count:
                _lost(notes, cut=stop >= size and lines < count)
                at = _next_header(content, stop, notes, quiet=True)
                continue
            stride = 0
        found.add(_time(head[2]), first, count, stride)
        alike = alike + 1 if stride == 39 and stop - at == apart else 0
        apart = stop - at
        if alike >= _LIKE and size - stop > _MANY * apart:  # they are looked at in one go
            times = _repeats(content, at, head, apart, 16 * alike)
            found.repeat(times, apart)
            alike = alike + len(times) if len(times) == 16 * alike else 0
            stop += len(times) * apart
        at = stop
        if at - released > _KEEP:
            forget_pages(content)
            released = at
    return found


def _repeats(content: Content, begin: int, head: "re.Match[bytes]", apart: int, limit: int) -> Floats:
    """Times of the frames behind one at `begin`, as long as they are like it and whole, and no more than so many."""
    first, after = head.end() - begin, begin + apart
    count = min(limit, (len(content) - after) // apart, _KEEP // apart)
    if count < 1 or content[begin + first + _LINE] != ord("\n"):
        return np.empty(0)
    own = np.frombuffer(content, np.uint8, apart, begin)
    frames = np.frombuffer(content, np.uint8, count * apart, after).reshape(count, apart)
    header = frames[:, :first]
    same = header == own[:first]
    middle = head.end(2) - begin
    time, number = slice(middle - 20, middle), slice(middle, middle + 10)
    same[:, time] = _TIME.take(header[:, time])
    same[:, number] = _NUMBER.take(header[:, number])
    for at in (first + _LINE, apart - 1):  # the ends of the first row and of the last
        same[:, 0] &= frames[:, at] == own[at]
    whole = same.all(axis=1)
    if not whole.all():
        count = int(whole.argmin())
    if not _ends_here(content, after + count * apart):
        count -= 1
    return floats_of(header[: max(count, 0), time])


def _time(text: bytes) -> float:
    try:
        return float(text)
    except ValueError:
        return to_float(text.decode())


def _lost(notes: Notes, *, cut: bool) -> None:
    if cut:
        notes.add("the last frame is cut off and left out", dropped=True)
    else:
        notes.add("{n} frames whose number of rows is not the one in their header left out", dropped=True)


def _ends_here(content: Content, at: int) -> bool:
    """Whether a line ends before `at` and no row follows; the next header may be damaged."""
    return content[at - 1 : at] == b"\n" and content[at : at + 1] != b"C"


def _frame_end(content: Content, first: int) -> int:
    """Where the line before the next header begins (a cut line may be glued to it), or the end."""
    mark = content.find(b"frame at time", first)
    if mark < 0:
        return len(content)
    return max(content.rfind(b"\n", first, mark - 1) + 1, first) if mark > first else first


def _next_header(content: Content, start: int, notes: Notes, *, quiet: bool = False) -> int:
    """Begin of the next pair of header lines at or after `start`, or the end of the text."""
    size = len(content)
    while True:
        mark = content.find(b"frame at time", start)
        if mark < 0:
            rest = content[start : start + 4096]
            if rest.strip() and not quiet:
                notes.add("text that belongs to no frame left out", dropped=True)
            return size
        line = content.rfind(b"\n", 0, max(mark - 1, 0)) + 1
        number = re.search(rb"[ 0-9]{1,10}\r?\n\Z", content[line:mark])
        if number is not None:
            begin = line + number.start()
            if begin > start and not quiet:
                notes.add("text that belongs to no frame left out", dropped=True)
            return begin
        notes.add("{n} frames with a damaged header left out", dropped=True)
        start, quiet = mark + 13, True


def _count_lines(content: Content, first: int, stop: int, enough: int) -> int:
    """Lines between two offsets, the last one possibly without its end; stops a little above `enough`."""
    lines = 0
    for at in range(first, stop, 1 << 20):
        lines += content[at : min(at + (1 << 20), stop)].count(b"\n")
        if lines > enough:
            return lines
    tail = content[max(stop - 64, first) : stop]
    unfinished = len(tail) - (tail.rfind(b"\n") + 1)
    return lines + (unfinished >= 38)


class XyzSource:
    """Frames of one ``traj.xyz`` or of many ``frame*.xyz``, lengths in the unit of the file times `scale`.

    Parameters
    ----------
    paths : sequence of Path
        One trajectory, or single frames in order of their number.
    first : bytes or mmap
        Content of the first of them.
    notes : Notes
    """

    def __init__(self, paths: Sequence[Path], first: Content, notes: Notes) -> None:
        self.paths = list(paths)
        self.notes = notes
        self.name = paths[0].name if len(paths) == 1 else "frame*.xyz"
        self.files = paths[0].name if len(paths) == 1 else f"{paths[0].name} to {paths[-1].name}"
        self.parameters: RunParameters | None = None
        self.scale = 1.0
        self._content: dict[int, Content] = {0: first}
        self._looked: tuple[Integers, _Read] | None = None
        self._order: tuple[Integers, Notes] | None = None
        frames = FrameList()
        owner: list[int] = []
        kept = 0
        for number in range(len(self.paths)):
            content = self._open(number)
            found = scan_frames(content, notes)
            owner += [number] * len(found.time)
            frames.join(found)
            kept += len(content)
            if len(self.paths) > 1 and kept > _KEEP:
                self._content.pop(number, None)
        self.time: Floats = np.array(frames.time, dtype=np.float64)
        self.weight: Integers = np.array(frames.rows, dtype=np.int64)
        self._offset = np.array(frames.offset, dtype=np.int64)
        self._stride = np.array(frames.extra, dtype=np.int64)
        self._owner = np.array(owner, dtype=np.int64)

    @property
    def position_error(self) -> float:
        """Half a unit in the last decimal, m."""
        return 0.5e-5 * self.scale

    def _open(self, number: int) -> Content:
        content = self._content.get(number)
        if content is None:
            self._content[number] = content = content_of(self.paths[number])
        return content

    def _gather(self, frames: Integers) -> tuple[NDArray[np.uint8], Integers]:
        """Bytes of the frames in one array, and the offsets of the frames in it."""
        if len(self.paths) == 1:
            return np.frombuffer(self._open(0), dtype=np.uint8), self._offset[frames]
        parts: list[NDArray[np.uint8]] = []
        shift: dict[int, int] = {}
        length = 0
        for number in np.unique(self._owner[frames]):
            known = int(number) in self._content
            content = self._open(int(number))
            parts.append(np.frombuffer(content, dtype=np.uint8))
            shift[int(number)] = length
            length += len(content)
            if not known:
                del self._content[int(number)]
        moved = np.array([shift[int(owner)] for owner in self._owner[frames]], dtype=np.int64)
        joined = np.concatenate(parts)
        joined.flags.writeable = False
        return joined, self._offset[frames] + moved

    def order(self, notes: Notes) -> Integers:
        """Numbers of the frames to keep (`order_frames`), found once."""
        if self._order is None:
            found = Notes("")
            self._order = order_frames(self.time, found), found
        notes.include(self._order[1])
        return self._order[0]

    def look(self, frames: Integers) -> Block:
        """Beads in the unit of the file, before its scale is known; what was read is kept for a `load` of the same frames."""
        self._looked = frames, self._read(frames)
        return self._looked[1][0]

    def load(self, frames: Integers, notes: Notes) -> Block:
        """Beads of the frames with these numbers, m."""
        looked, self._looked = self._looked, None
        if looked is None or looked[0].tobytes() != frames.tobytes():
            looked = frames, self._read(frames)
        block, positions, status, padding = looked[1]
        positions *= self.scale  # the block holds them by axis
        add = notes.add
        if status.any():
            wide = np.count_nonzero(status & OVERFLOW)
            add("{n} rows hold asterisks (numbers too wide for their field) and are NaN", wide)
            bad = np.count_nonzero(status & (UNREADABLE | OVERFLOW))
            add("{n} rows cannot be read and are NaN", bad - wide)
            add("{n} rows are damaged outside their numbers", np.count_nonzero(status == DAMAGED))
        add(
            "{n} rows behind the nozzle are not the padding they should be and are left out",
            int(padding.sum()),
        )
        return block

    def _read(self, frames: Integers) -> _Read:
        """Beads in the unit of the file, their positions and flags, and how many rows of each frame are no padding."""
        buffer, offset = self._gather(frames)
        rows = self.weight[frames]
        out = np.empty((3, int(rows.sum())))
        status = np.empty(out.shape[1], dtype=np.uint8)
        chains = np.empty((len(frames), 4), dtype=np.int64)
        used = parse_rows(buffer, offset, rows, self._stride[frames], out, status, chains)
        if len(self.paths) == 1:
            forget_pages(self._content[0])
        out, status = out[:, :used], status[:used]
        block = Block(
            time=self.time[frames],
            first=chains[:, 0].copy(),
            length=chains[:, 1].copy(),
            values={"x": out[0], "y": out[1], "z": out[2]},
            bad=(status & (UNREADABLE | OVERFLOW)) != 0,
            reaches_nozzle=chains[:, 2] == 1,
        )
        return block, out, status, chains[:, 3]
