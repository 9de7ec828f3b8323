"""Frames of ``traj.dat`` and ``save.dat`` (JETSPIN 1.21): a parameter block, then one group of records each.

Sizes are taken from what the style and the dimension demand and compared with the markers in the file, so
that a damaged count can neither ask for memory nor send the reader astray.
"""

import math
import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spinline.errors import InputError
from spinline.jetprofile.jetspin.fortran import read_record, record_sizes, skip_records
from spinline.jetprofile.jetspin.frames import Block, Floats, FrameList, Integers
from spinline.jetprofile.jetspin.header import RunParameters
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.placeholder import drop_placeholders
from spinline.jetprofile.jetspin.units import CM, STATCOULOMB, STATVOLT
from spinline.jetprofile.jetspin.xyz import forget_pages, map_file

__all__ = ["BLOCK", "BinarySource", "parse_block"]

BLOCK = (4, 24, 16, 56, 56, 72, 32, 40, 4, 96, 12, 96, 96, 96, 48, 48, 48, 96)
_BLOCK_BYTES = sum(BLOCK) + 8 * len(BLOCK)
_MARK = b"\4\0\0\0"
_HEAD = struct.Struct("<iiidi")
_PASCAL = 0.1  # g cm^-1 s^-2
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
_SYSTEMS = (1, 2, 3, 4)


def parse_block(content: bytes, name: str, notes: Notes) -> RunParameters:
    """Read the parameter block at the beginning of ``traj.dat`` or ``save.dat``, and check it against itself.

    Raises
    ------
    InputError
        If it is not a block of version 1.21, or so damaged that its scales are in doubt.
    """
    bodies: list[bytes] = []
    at = damaged = 0
    for size in BLOCK:
        body = read_record(content, at, size)
        damaged += body is None
        if len(content) < at + size + 8 or damaged > 2:
            raise _not_jetspin(name, content)
        bodies.append(content[at + 4 : at + 4 + size])
        at += size + 8
    notes.add("{n} record markers in the parameter block are damaged", damaged)
    with np.errstate(all="ignore"):
        return _block_values(bodies, name, notes)


def _block_values(bodies: list[bytes], name: str, notes: Notes) -> RunParameters:
    step, initial, density, charge_density, radius, nozzle_stress, nozzle_velocity = _reals(bodies[3])
    frequency, amplitude = _reals(bodies[4])[:2]
    viscosity, modulus, yield_stress, collector, potential, tension, timestep = _reals(bodies[5])[:7]
    mass, charge, length, tau = _reals(bodies[6])
    systems = [int.from_bytes(bodies[1][8:12], "little"), int.from_bytes(bodies[2][4:8], "little")]
    system = next((value for value in systems if value in _SYSTEMS), None)
    if systems[0] != systems[1]:
        notes.add("the parameter block contradicts itself about the dimension")
    groups = _reals(bodies[9])
    area = math.pi * radius**2
    expected = {
        "mass": (mass, density * area * step),
        "charge": (charge, charge_density * area * step),
        "length": (length, abs(charge_density * area * step) / np.sqrt(area * modulus)),
        "time": (tau, np.float64(viscosity) / modulus),
        "collector distance": (groups[4] * length, collector),
        "resolution": (groups[5] * length, step),
    }
    wrong = [key for key, (given, value) in expected.items() if not abs(given - value) <= 1e-6 * abs(value)]
    if not all(0 < value < 1e30 for value in (mass, length, tau, modulus, radius, step, collector)):
        wrong.append("range")
    if wrong:
        raise InputError(
            name,
            f"its parameter block contradicts itself ({', '.join(wrong)}): it is damaged, or not in the CGS units of "
            "JETSPIN 1.21",
            remedy="read frame*.xyz or traj.xyz with the log.txt of the run instead",
        )
    settings, counters = _reals(bodies[17]), np.frombuffer(bodies[14], "<i4")
    return RunParameters(
        source=name,
        system=system,
        nozzle_radius=radius * CM,
        resolution=step * CM,
        initial_length=initial * CM,
        density=density * 1e3,
        charge_density=charge_density * STATCOULOMB / CM**3,
        viscosity=viscosity * _PASCAL,
        elastic_modulus=modulus * _PASCAL,
        collector_distance=collector * CM,
        potential=potential * STATVOLT,
        surface_tension=tension * 1e-3,
        nozzle_velocity=nozzle_velocity * CM,
        nozzle_stress=nozzle_stress * _PASCAL,
        yield_stress=yield_stress * _PASCAL,
        perturbation_amplitude=amplitude * CM,
        perturbation_frequency=frequency,
        timestep=timestep,
        inserting=bool(struct.unpack("<i", bodies[10][8:12])[0]),
        refinement=bool(counters[6] > 0 or settings[9] > 0 or settings[10] > 0),
        length_unit=length * CM,
        time_unit=tau,
        stress_unit=modulus * _PASCAL,
        mass_unit=mass * 1e-3,
        charge_unit=charge * STATCOULOMB,
    )


def _reals(body: bytes) -> list[float]:
    return [float(value) for value in np.frombuffer(body, "<f8")]


def _not_jetspin(name: str, content: bytes) -> InputError:
    if content[:4] == b"\0\0\0\4":
        return InputError(
            name,
            "written on a big-endian machine, which is not read",
            remedy="convert its 4-byte words, or read the XYZ files of the run",
        )
    if len(content) < _BLOCK_BYTES:
        return InputError(
            name,
            f"ends after {len(content)} bytes, inside its parameter block",
            remedy="read the XYZ files of the run",
        )
    return InputError(
        name,
        "not the parameter block of a JETSPIN 1.21 traj.dat or save.dat (its records have other sizes)",
        remedy="read frame*.xyz or traj.xyz with log.txt instead",
    )


class BinarySource:
    """Frames of a ``traj.dat`` or ``save.dat``, SI.

    Parameters
    ----------
    path : Path
    notes : Notes
    """

    def __init__(self, path: Path, notes: Notes) -> None:
        self.name = self.files = path.name
        self.position_error = 0.0
        self.notes = notes
        self._content = map_file(path)
        self.parameters = parse_block(self._content[:_BLOCK_BYTES], path.name, notes)
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
        at = _BLOCK_BYTES
        while True:
            head = skip_records(self._content, at, (4, 24))
            if head is not None:
                _, style, own, _, _ = _HEAD.unpack(head[1])
                if 8 <= style <= 16:
                    raise InputError(
                        self.name,
                        f"binary style {style}, of JETSPIN 1.22 or later, which is not read",
                        remedy="read its frame*.xyz with log.txt, or write traj.dat with `print binary <dt> style 5`",
                    )
                if own in _SYSTEMS and style in _EXTRA and (system is None or own == system):
                    return style, 1 if own in (1, 2) else 3
            at = self._search(at + 1)
            if at < 0:
                raise InputError(
                    self.name,
                    "holds no whole frame",
                    remedy="read the XYZ files of the run, or let it run longer",
                )

    def _search(self, start: int) -> int:
        """Where the next group of records may begin, or -1."""
        while True:
            at = self._content.find(b"\4\0\0\0\x18\0\0\0", start)
            if at < 0:
                return -1
            if at >= 8 and self._content[at - 8 : at - 4] == _MARK:
                return at - 8
            start = at + 1

    def _scan(self) -> FrameList:
        """Find the whole frames: time, offset of the first bead, number of beads, the inserted flag."""
        found = FrameList()
        at, size = _BLOCK_BYTES, len(self._content)
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
            if behind < 0 and frame is not None:
                add("the last frame is cut off and left out", dropped=True)
            elif behind < 0 and size - at < 60:
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
        """Time, first bead, number of beads, inserted flag and end of the frame at `at`, if its head is sound."""
        content = self._content
        body = read_record(content, at + 12, 24)
        if body is None or content[at : at + 4] != _MARK or content[at + 8 : at + 12] != _MARK:
            return None
        rows, style, system, time, inserted = _HEAD.unpack(body)
        dimension = {1: 1, 2: 1, 3: 3, 4: 3}.get(system)
        if rows < 1 or style != self.style or dimension != self.dimension or inserted not in (0, 1, -1):
            return None
        first = at + 44
        if style >= 3:
            span = read_record(content, first, 12)
            if span is None:
                return None
            low, high = struct.unpack("<ii", span[4:])
            if style != 4 and high - low + 1 != rows:
                return None
            first += 20
        return time, first, rows, int(inserted != 0), first + rows * (self._size + 8)

    def load(self, frames: Integers, notes: Notes) -> Block:
        """Beads of the frames with these numbers, SI."""
        width = self._size + 8
        length = self.weight[frames]
        first = np.cumsum(length) - length
        words = np.empty((int(length.sum()), width // 4), dtype="<u4")
        for begin, rows, at in zip(
            first.tolist(), length.tolist(), self._offset[frames].tolist(), strict=True
        ):
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
        assert p.length_unit is not None and p.time_unit is not None
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
        for number, name in enumerate(self.columns):
            factor = scale.get(name)
            if factor is None:
                continue
            column = np.ascontiguousarray(words[:, number + 1])
            broken = (column & 0x7F800000) == 0x7F800000
            if broken.any():
                column[broken] = 0
                bad |= broken
            values[name] = column.view("<f4").astype(np.float64) * factor
            if broken.any():
                values[name][broken] = np.nan
        return values, bad


def first_sizes(path: Path) -> list[int]:
    """Sizes of the first records of a file, for telling what it is."""
    with path.open("rb") as file:
        return record_sizes(file.read(1 << 12), 4)
