"""Frames of a trajectory: where they are, when they are, and their beads as flat arrays."""

from array import array
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.notes import Notes

__all__ = ["Block", "Floats", "FrameSource", "Integers", "Padder", "order_frames", "select_frames"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass
class Block:
    """Beads of some frames, as stored: farthest bead first, the nozzle point last.

    Frame i owns the rows ``first[i] : first[i] + length[i]`` of every array in `values` (SI). `bad` marks
    rows that could not be read. `reaches_nozzle` is False where the rows next to the nozzle are missing.
    `inserted` is None where the file does not say.
    """

    time: Floats
    first: Integers
    length: Integers
    values: dict[str, Floats]
    bad: NDArray[np.bool_]
    reaches_nozzle: NDArray[np.bool_]
    inserted: NDArray[np.bool_] | None = None


class Padder:
    """Columns of a block as arrays (frame, bead) with bead 0 at the nozzle, NaN where there is no bead."""

    def __init__(self, block: Block) -> None:
        number = np.arange(int(block.length.max(initial=1)))
        self.there: NDArray[np.bool_] = number < block.length[:, None]
        # a row beyond the last stands for no bead
        self._row = np.where(self.there, (block.first + block.length - 1)[:, None] - number, len(block.bad))
        self._block = block
        self._made: dict[str, Floats] = {}

    def __contains__(self, name: object) -> bool:
        return name in self._block.values

    def __call__(self, name: str) -> Floats:
        """Padded column; zero where the file has none (y and z of a straight jet)."""
        values = self._made.get(name)
        if values is None:
            self._made[name] = values = self._padded(name)[0]
        return values

    def positions(self) -> Floats:
        """x, y and z, one behind the other."""
        return self._padded(*"xyz")

    def _padded(self, *names: str) -> Floats:
        flat = np.zeros((len(names), len(self._block.bad) + 1))
        flat[:, -1] = np.nan
        for number, name in enumerate(names):
            if name in self:
                flat[number, :-1] = self._block.values[name]
        return flat.take(self._row, axis=1)

    def bad(self) -> NDArray[np.bool_]:
        """Padded marks of rows that could not be read."""
        bad = self._block.bad
        if not bad.any():
            return np.zeros(self.there.shape, dtype=np.bool_)
        return np.append(bad, False).take(self._row)


class FrameSource(Protocol):
    """A file, or set of files, of frames in time."""

    name: str  # of the file, or the pattern
    files: str
    time: Floats  # of every whole frame stored, s
    weight: Integers  # rows of every frame, padding included

    def load(self, frames: Integers, notes: Notes) -> Block:
        """Beads of the frames with these numbers, SI."""


@dataclass
class FrameList:
    """Place of every frame while a file is being scanned."""

    time: "array[float]" = field(default_factory=lambda: array("d"))
    offset: "array[int]" = field(default_factory=lambda: array("q"))
    rows: "array[int]" = field(default_factory=lambda: array("q"))
    extra: "array[int]" = field(default_factory=lambda: array("q"))

    def add(self, time: float, offset: int, rows: int, extra: int) -> None:
        """Append one frame."""
        self.time.append(time)
        self.offset.append(offset)
        self.rows.append(rows)
        self.extra.append(extra)

    def repeat(self, times: Floats, apart: int) -> None:
        """Append frames that are like the last one, at other times and so many bytes apart."""
        count, last = len(times), self.offset[-1]
        self.time.frombytes(times.tobytes())
        self.offset.extend(range(last + apart, last + apart * count + 1, apart))
        self.rows.extend(self.rows[-1:] * count)
        self.extra.extend(self.extra[-1:] * count)

    def join(self, other: "FrameList") -> None:
        """Append those of another file."""
        self.time += other.time
        self.offset += other.offset
        self.rows += other.rows
        self.extra += other.extra


def order_frames(time: Floats, notes: Notes) -> Integers:
    """Numbers of the frames to keep, in order of time.

    Of times stored twice (a restart appends to the files) the later record is kept; a single frame whose
    time stands out of the order of its neighbours has a damaged header and is left out.
    """
    count = len(time)
    steps = time[1:] - time[:-1]
    if count and time[0] >= 0 and time[-1] < 1e9 and (steps > 0).all():  # as it should be, and NaN is in no order
        _note_late(steps, notes)
        return np.arange(count)
    good = (time >= 0) & (time < 1e9)  # NaN is neither
    notes.add("{n} frames with an impossible time left out", int(count - np.count_nonzero(good)), dropped=True)
    numbers = np.flatnonzero(good)
    known = time[numbers]
    steps = known[1:] - known[:-1]
    _note_late(steps, notes)
    if (steps > 0).all():
        return numbers
    spacing = float(np.median(np.abs(steps)))
    tol = 1e-6 * spacing
    kept: list[int] = []
    odd = superseded = 0
    for position, number in enumerate(numbers):
        now = time[number]
        after = time[numbers[position + 1]] if position + 1 < len(numbers) else None
        before = time[kept[-1]] if kept else None
        if before is not None and now < before - tol and _stray(now, before, after, spacing, time[kept[0]]):
            odd += 1
            continue
        while kept and time[kept[-1]] >= now - tol:
            spike = len(kept) > 1 and time[kept[-2]] < now - tol and time[kept[-1]] > now + tol and after is not None
            odd += spike
            superseded += not spike
            kept.pop()
        kept.append(int(number))
    notes.add("{n} frames with a time out of the order of their neighbours left out", odd, dropped=True)
    notes.add(
        "{n} frames superseded by a restart left out (times stored twice keep the later record)",
        superseded,
        dropped=True,
    )
    return np.array(kept, dtype=np.int64)


def _note_late(steps: Floats, notes: Notes) -> None:
    """Say that the last step in time is far longer than the others."""
    if len(steps) > 3 and steps[-1] > 20 * np.abs(steps).min() and steps[-1] > 20 * np.median(np.abs(steps)):
        notes.add("the last frame is far later than those before; its time may be damaged")


def _stray(now: float, before: float, after: float | None, spacing: float, start: float) -> bool:
    """Whether an earlier time is a damaged one rather than the beginning of a restart."""
    if after is not None:
        return after > before + 0.5 * spacing
    return now < start - 0.5 * spacing


def select_frames(time: Floats, wanted: float | str | slice | None, name: str) -> Integers:
    """Positions in `time` (ascending) of the wanted frames."""
    everything = np.arange(len(time))
    if wanted is None:
        return everything
    shown = f"{time[0]:.9g} to {time[-1]:.9g} s"
    if isinstance(wanted, str):
        if wanted == "last":
            return everything[-1:]
        raise InputError("time", "not a time", value=wanted, allowed='None, "last", seconds or a slice of seconds')
    if isinstance(wanted, slice):
        return everything[_inside(time, wanted, name, shown)]
    try:
        seconds = float(wanted)
    except (TypeError, ValueError):
        raise InputError(
            "time", "not a time", value=wanted, allowed='None, "last", seconds or a slice of seconds'
        ) from None
    spacing = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    slack = max(0.01 * spacing, 1e-6 * abs(float(time[-1])))
    if not time[0] - slack <= seconds <= time[-1] + slack:
        raise InputError("time", f"outside what {name} holds", value=wanted, allowed=shown)
    return everything[[int(np.argmin(np.abs(time - seconds)))]]


def _inside(time: Floats, wanted: slice, name: str, shown: str) -> NDArray[np.bool_]:
    if wanted.step is not None:
        raise InputError("time", "a slice of times has no step", value=wanted, remedy="select every nth afterwards")
    try:
        low = -np.inf if wanted.start is None else float(wanted.start)
        high = np.inf if wanted.stop is None else float(wanted.stop)
    except (TypeError, ValueError):
        raise InputError("time", "not a slice of seconds", value=wanted) from None
    inside = (time >= low) & (time <= high)
    if not inside.any():
        raise InputError("time", f"{name} has no frame in it", value=wanted, allowed=shown)
    return np.asarray(inside)
