"""Polylines in VTK's legacy format, text or binary: points, one line through them, and what belongs to the points.

VTK, "File formats", legacy format 3.0 and 5.1 (``POLYDATA`` or ``UNSTRUCTURED_GRID``).
"""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.readers.polyline import jet_of_points, length_scale
from spinline.jetprofile.readers.vtk_cells import LineCells, cells_of_types, grid_refused, poly_cells

__all__ = ["VtkLegacy"]

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
_BEYOND = 1e30  # no place in any unit: bytes in the other order
_CELLS = ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS")
_PASSED: dict[str, Callable[[list[str]], tuple[int, str]]] = {  # values a row, and their type
    "TENSORS": lambda words: (9, words[2]),
    "TENSORS6": lambda words: (6, words[2]),
    "TEXTURE_COORDINATES": lambda words: (int(words[2]), words[3]),
    "GLOBAL_IDS": lambda words: (1, words[2]),
    "PEDIGREE_IDS": lambda words: (1, words[2]),
    "COLOR_SCALARS": lambda words: (int(words[2]), "unsigned_char"),
    "LOOKUP_TABLE": lambda words: (4, "unsigned_char"),
}


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
        found = file.found()
        order, elements = found.order(len(points), str(path), self.name)
        return jet_of_points(
            points[order],
            {key: values[order] for key, values in data.items()},
            found.data(cells, elements),
            name=str(path),
            kind=self.name,
            scale=scale,
            initial_radius=initial_radius,
        )


class _Legacy:
    """A cursor over the bytes of a legacy file."""

    def __init__(self, data: bytes, name: str, kind: str) -> None:
        self.data, self.name, self.kind, self.at = data, name, kind, 0
        self.cells: dict[str, list[list[int]]] = {}
        self.types: list[int] = []

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
        target, count = None, 0
        while (words := self._words()) is not None:
            key = words[0].upper()
            if key == "POINTS":
                points = self._array(3 * self._count(words, 1), words[2]).reshape(-1, 3).astype(np.float64)
                if self.binary and not (np.abs(points) < _BEYOND).all():
                    raise self._damaged("its binary numbers are no places; the legacy format wants them big-endian")
            elif key == "DIMENSIONS":
                grid_refused([self._count(words, i) for i in (1, 2, 3)], self.name, self.kind)
            elif key in _CELLS:
                self.cells.setdefault(key, []).extend(self._cells(words))
            elif key == "CELL_TYPES":
                self.types += self._array(self._count(words, 1), "int").astype(int).tolist()
            elif key == "METADATA":
                self._metadata()
            elif key in tables:
                target, count = tables[key], self._count(words, 1)
            elif key == "FIELD":
                self._field(words, {} if target is None else target)  # before the points: of the whole file
            elif target is not None:
                self._attribute(key, words, target, count)
        if not len(points):
            raise self._damaged("it has no POINTS")
        return points, tables["POINT_DATA"], tables["CELL_DATA"]

    def found(self) -> LineCells:
        """The file's lines."""
        if "CELLS" in self.cells:
            return cells_of_types(self.cells["CELLS"], self.types, self.name, self.kind)
        return poly_cells(self.cells, self.name, self.kind)

    def _attribute(self, key: str, words: list[str], target: dict[str, FloatArray], count: int) -> None:
        if key == "SCALARS":
            parts = int(words[3]) if len(words) > 3 else 1
            if self._peek().upper().startswith("LOOKUP_TABLE"):
                self._line()
            values = self._array(count * parts, words[2]).astype(np.float64)
            target[words[1]] = values if parts == 1 else values.reshape(count, parts)
        elif key in ("VECTORS", "NORMALS"):
            target[words[1]] = self._array(3 * count, words[2]).reshape(count, 3).astype(np.float64)
        elif key in _PASSED:  # to be passed by, as binary numbers may look like anything
            parts, kind = _PASSED[key](words)
            table = self._count(words, 2) if key == "LOOKUP_TABLE" else count
            self._array(parts * table, kind if self.binary or kind != "unsigned_char" else "float")

    def _field(self, words: list[str], target: dict[str, FloatArray]) -> None:
        for _ in range(self._count(words, 2)):
            field = self._words()
            if field is not None and field[0].upper() == "METADATA":  # of the array before
                self._metadata()
                field = self._words()
            if field is None or len(field) < 4:
                raise self._damaged("a FIELD ends early")
            parts, rows = self._count(field, 1), self._count(field, 2)
            if field[3].lower() in ("string", "utf8_string") and not self.binary:  # one a line
                for _ in range(parts * rows):
                    self._line()
                continue
            values = self._array(parts * rows, field[3]).astype(np.float64)
            target[field[0]] = values if parts == 1 else values.reshape(rows, parts)

    def _metadata(self) -> None:
        """Pass by what VTK 9 and ParaView write behind an array; it ends with an empty line."""
        while self.at < len(self.data) and self._line():
            pass

    def _cells(self, words: list[str]) -> list[list[int]]:
        if self._peek().upper().startswith("OFFSETS"):  # 5.1
            ends = self._array(self._count(words, 1), self._line().split()[1]).astype(int).tolist()
            heading = self._words() or ["", ""]
            joined = self._array(self._count(words, 2), heading[-1]).astype(int).tolist()
            return [joined[a:b] for a, b in pairwise(ends)]
        flat = self._array(self._count(words, 2), "int").astype(int).tolist()
        cells, at = [], 0
        while at < len(flat):
            size = flat[at]
            if size < 0 or at + 1 + size > len(flat):
                hint = "; the legacy format wants binary numbers big-endian" if self.binary else ""
                raise self._damaged(f"a cell reaches beyond the list of cells{hint}")
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
