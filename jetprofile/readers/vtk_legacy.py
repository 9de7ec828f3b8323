"""Polylines in VTK's legacy format, text or binary: points, one line through them, and what belongs to the points.

VTK, "File formats", legacy format 3.0 and 5.1 (``POLYDATA`` or ``UNSTRUCTURED_GRID``).
"""

from itertools import pairwise
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.readers.polyline import jet_of_points, length_scale

__all__ = ["VtkLegacy", "line_order"]

_TYPES = {
    "float": "f4",
    "double": "f8",
    "int": "i4",
    "unsigned_int": "u4",
    "long": "i8",
    "unsigned_long": "u8",
    "short": "i2",
    "unsigned_short": "u2",
    "char": "i1",
    "unsigned_char": "u1",
    "vtktypeint64": "i8",
    "vtktypeint32": "i4",
    "vtkidtype": "i8",
}
_LARGEST = 50_000_000  # values of one array


class VtkLegacy:
    """Reader of legacy VTK files."""

    name = "VTK legacy polyline"

    def claims(self, path: Path, head: bytes) -> bool:
        """By its first line."""
        return head.startswith(b"# vtk DataFile")

    def read(self, path: Path, *, unit: str | None = None, initial_radius: float | None = None) -> LagrangianJet:
        """VTK files carry no units: `unit` says that of places and radius alike."""
        scale = length_scale(unit, str(path), self.name)
        file = _Legacy(path.read_bytes(), str(path), self.name)
        try:
            points, data, cells = file.parse()
        except (IndexError, ValueError, TypeError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(
                str(path), f"is damaged, or no {self.name} ({error})", remedy="write the file again"
            ) from None
        order, elements = line_order(file.lines, len(points), str(path), self.name)
        return jet_of_points(
            points[order],
            {key: values[order] for key, values in data.items()},
            {
                key: values[elements]
                for key, values in cells.items()
                if elements is not None and len(values) > elements.max()
            },
            name=str(path),
            kind=self.name,
            scale=scale,
            initial_radius=initial_radius,
        )


def line_order(lines: list[list[int]], count: int, name: str, kind: str) -> tuple[np.ndarray, np.ndarray | None]:
    """Order of the points along one line, and which cell each element is, where every element is a cell of its own.

    One polyline gives its own order; two-point cells are joined end to end. Without cells the points stand in order.
    """
    if any(not 0 <= index < count for line in lines for index in line):
        raise InputError(name, f"has a line through points that are not there ({kind})", remedy="write the file again")
    lines = [line for line in lines if len(line) > 1]
    if not lines:
        return np.arange(count), None
    if len(lines) == 1:
        if len(set(lines[0])) < len(lines[0]):
            raise InputError(name, f"has a closed line ({kind})", remedy="give a jet, from the nozzle to its far end")
        return np.array(lines[0]), np.zeros(1, dtype=int) if len(lines[0]) == 2 else None
    order = list(lines[0])
    for line in lines[1:]:
        if line[0] != order[-1]:
            raise InputError(
                name, f"has several lines ({kind})", value=len(lines), remedy="write one jet a file, its cells in order"
            )
        order += line[1:]
    if len(set(order)) < len(order):
        raise InputError(name, f"has a closed line ({kind})", remedy="give a jet, from the nozzle to its far end")
    return np.array(order), np.arange(len(lines)) if all(len(line) == 2 for line in lines) else None


class _Legacy:
    """A cursor over the bytes of a legacy file."""

    def __init__(self, data: bytes, name: str, kind: str) -> None:
        self.data, self.name, self.kind, self.at = data, name, kind, 0
        self.lines: list[list[int]] = []

    def parse(self) -> tuple[FloatArray, dict[str, FloatArray], dict[str, FloatArray]]:
        """Points, point data and cell data."""
        self._line()
        self._line()
        coding = self._line().upper()
        if coding not in ("ASCII", "BINARY"):
            raise self._damaged(f"its third line is {coding[:20]!r}, not ASCII or BINARY")
        self.binary = coding == "BINARY"
        points: FloatArray = np.empty((0, 3))
        tables: dict[str, dict[str, FloatArray]] = {"POINT_DATA": {}, "CELL_DATA": {}}
        target, count, offsets = None, 0, None
        while (words := self._words()) is not None:
            key = words[0].upper()
            if key == "POINTS":
                points = self._array(3 * self._count(words, 1), words[2]).reshape(-1, 3).astype(np.float64)
            elif key in ("LINES", "CELLS"):
                if len(words) > 2 and self._peek().upper().startswith("OFFSETS"):
                    offsets = self._array(self._count(words, 1), self._line().split()[1]).astype(int)
                    heading = self._words() or ["", ""]
                    joined = self._array(self._count(words, 2), heading[-1]).astype(int).tolist()
                    self.lines += [joined[a:b] for a, b in pairwise(offsets.tolist())]
                else:
                    self.lines += self._cells(self._array(self._count(words, 2), "int").astype(int).tolist())
            elif key in ("VERTICES", "POLYGONS", "TRIANGLE_STRIPS"):
                self._array(self._count(words, 2), "int")
            elif key == "CELL_TYPES":
                self._array(self._count(words, 1), "int")
            elif key in tables:
                target, count = tables[key], self._count(words, 1)
            elif target is not None:
                self._attribute(key, words, target, count)
        if not len(points):
            raise self._damaged("it has no POINTS")
        return points, tables["POINT_DATA"], tables["CELL_DATA"]

    def _attribute(self, key: str, words: list[str], target: dict[str, FloatArray], count: int) -> None:
        if key == "SCALARS":
            parts = int(words[3]) if len(words) > 3 else 1
            if self._peek().upper().startswith("LOOKUP_TABLE"):
                self._line()
            values = self._array(count * parts, words[2]).astype(np.float64)
            target[words[1]] = values if parts == 1 else values.reshape(count, parts)
        elif key in ("VECTORS", "NORMALS"):
            target[words[1]] = self._array(3 * count, words[2]).reshape(count, 3).astype(np.float64)
        elif key == "FIELD":
            for _ in range(self._count(words, 2)):
                field = self._words()
                if field is None or len(field) < 4:
                    raise self._damaged("a FIELD ends early")
                parts, rows = self._count(field, 1), self._count(field, 2)
                values = self._array(parts * rows, field[3]).astype(np.float64)
                target[field[0]] = values if parts == 1 else values.reshape(rows, parts)

    def _cells(self, flat: list[int]) -> list[list[int]]:
        cells, at = [], 0
        while at < len(flat):
            size = flat[at]
            if size < 0 or at + 1 + size > len(flat):
                raise self._damaged("a cell reaches beyond the list of cells")
            cells.append(flat[at + 1 : at + 1 + size])
            at += 1 + size
        return cells

    def _count(self, words: list[str], place: int) -> int:
        try:
            count = int(words[place])
        except (IndexError, ValueError):
            raise self._damaged(f"no count in {' '.join(words)[:40]!r}") from None
        if not 0 <= count <= _LARGEST:
            raise self._damaged(f"a count of {count}")
        return count

    def _array(self, count: int, kind: str) -> np.ndarray:
        code = _TYPES.get(kind.lower())
        if code is None:
            raise self._damaged(f"an array of type {kind[:20]!r}")
        if self.binary:
            dtype = np.dtype(">" + code)
            end = self.at + count * dtype.itemsize
            if end > len(self.data):
                raise self._damaged("it is cut short")
            values = np.frombuffer(self.data, dtype, count, self.at)
            self.at = end
            return values
        found: list[bytes] = []
        while len(found) < count:
            if self.at >= len(self.data):
                raise self._damaged("it is cut short")
            found += self._raw().split()
        try:
            return np.array(found[:count], dtype=np.float64)
        except ValueError:
            raise self._damaged("text among its numbers") from None

    def _raw(self) -> bytes:
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        line, self.at = self.data[self.at : end], end + 1
        return line

    def _line(self) -> str:
        return self._raw().decode("ascii", "replace").strip()

    def _peek(self) -> str:
        at = self.at
        line = self._line()
        self.at = at
        return line

    def _words(self) -> list[str] | None:
        while self.at < len(self.data):
            words = self._line().split()
            if words:
                return words
        return None

    def _damaged(self, why: str) -> InputError:
        return InputError(self.name, f"is damaged, or no {self.kind}: {why}", remedy="write the file again")
