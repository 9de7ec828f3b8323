"""Lines of a VTK file: which cells they are, in what order they pass the points, and where their data stand.

VTK counts the data of cells through vertices, lines, polygons and strips, in this order, wherever a file puts them. Points of
cells that are no lines (a surface, a volume, a curved edge with its middle behind its ends) are in no order along a jet.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError

__all__ = ["LineCells", "cells_of_types", "grid_refused", "poly_cells"]

_ORDER = ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS")
_AREAS = {"POLYGONS": "polygons", "TRIANGLE_STRIPS": "triangle strips"}
_POINTS, _LINES = (1, 2), (3, 4)  # vtkCellType.h
_TYPES = {5: "triangles", 7: "polygons", 8: "pixels", 9: "quadrilaterals", 10: "tetrahedra", 11: "voxels"}
_TYPES |= {
    12: "hexahedra",
    13: "wedges",
    14: "pyramids",
    21: "quadratic edges",
    35: "cubic edges",
    68: "Lagrange curves",
}
_TAKE = "give the axis of the jet, a polyline with its radius at the points (in ParaView: the stream line or the line itself)"


@dataclass(frozen=True)
class LineCells:
    """Lines of a file.

    Attributes
    ----------
    lines : list of list
        Points of each.
    places : list of int
        Where each stands among the data of cells.
    """

    lines: list[list[int]]
    places: list[int]

    def order(self, count: int, name: str, kind: str) -> tuple[np.ndarray, np.ndarray | None]:
        """Order of `count` points along one line, and each element's place in the cell data, where it is a cell of its own.

        One polyline gives its own order; several are joined end to end, in whatever order they stand. Without lines the
        points stand in order.
        """
        if any(not 0 <= index < count for line in self.lines for index in line):
            raise InputError(
                name, f"has a line through points that are not there ({kind})", remedy="write the file again"
            )
        kept = [i for i, line in enumerate(self.lines) if len(line) > 1]
        if not kept:
            return np.arange(count), None
        chain = self._chain(kept, name, kind)
        order = list(self.lines[chain[0]])
        for i in chain[1:]:
            order += self.lines[i][1:]
        if len(set(order)) < len(order):
            raise InputError(name, f"has a closed line ({kind})", remedy="give a jet, from the nozzle to its far end")
        pairs = all(len(self.lines[i]) == 2 for i in chain)
        return np.array(order), np.array([self.places[i] for i in chain]) if pairs else None

    def _chain(self, kept: list[int], name: str, kind: str) -> list[int]:
        """Lines in such an order that each begins where the last ends."""
        begins = {self.lines[i][0]: i for i in kept}
        ends = {self.lines[i][-1] for i in kept}
        first = [i for i in kept if self.lines[i][0] not in ends] or kept[:1]
        chain, left = [first[0]], set(kept) - {first[0]}
        while (after := begins.get(self.lines[chain[-1]][-1])) in left:
            assert after is not None
            chain.append(after)
            left.remove(after)
        if left:
            remedy = "write one jet a file, every piece in the jet's direction"
            raise InputError(name, f"has several lines ({kind})", value=len(kept), remedy=remedy)
        return chain

    def data(self, cells: Mapping[str, FloatArray], places: np.ndarray | None) -> dict[str, FloatArray]:
        """Cell data of the elements."""
        if places is None:
            return {}
        return {key: values[places] for key, values in cells.items() if len(values) > places.max()}


def poly_cells(cells: Mapping[str, list[list[int]]], name: str, kind: str) -> LineCells:
    """Lines among the cells of PolyData, by the names of the legacy format.

    Raises
    ------
    InputError
        For a surface without a line.
    """
    lines = cells.get("LINES", [])
    area = next((key for key in _AREAS if cells.get(key)), None)
    if area is not None and not lines:
        problem = f"is a surface ({kind}, {len(cells[area])} {_AREAS[area]}): its points are in no order along a jet"
        raise InputError(name, problem, remedy=_TAKE)
    before = len(cells.get(_ORDER[0], []))
    return LineCells(lines, list(range(before, before + len(lines))))


def cells_of_types(cells: list[list[int]], types: list[int], name: str, kind: str) -> LineCells:
    """Lines among the cells of an unstructured grid.

    Raises
    ------
    InputError
        For cells that are no lines and no points.
    """
    other = next((one for one in types if one not in (*_POINTS, *_LINES)), None)
    if other is not None:
        what = _TYPES.get(other, f"cells of type {other}")
        raise InputError(name, f"is a mesh ({kind}, {what}): its points are in no order along a jet", remedy=_TAKE)
    places = [i for i, one in enumerate(types[: len(cells)]) if one in _LINES]
    return LineCells([cells[i] for i in places], places)


def grid_refused(shape: list[int], name: str, kind: str) -> None:
    """Refuse a structured grid that is more than one row of points.

    Raises
    ------
    InputError
        For such a grid.
    """
    if sum(n > 1 for n in shape) > 1:
        what = " x ".join(map(str, shape))
        problem = f"is a grid of {what} points ({kind}): they are in no order along a jet"
        raise InputError(name, problem, remedy=_TAKE)
