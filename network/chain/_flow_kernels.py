"""Compiled look-ups in a flow table, for beads in order: each search goes on from the last.

`pack` turns the cubics of a span into one row of coefficients a cell, in powers of the distance from its anchor:

    0 anchor s, 1 its age, 2-4 reference slowness and half, third of its rise, 5-7 the same of the first profile,
    8-10 speed and the same of the inverse cubic, position by age (a first guess)

with a straight cell before and after the table.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["pack", "place", "reference", "search", "speed_now"]


def pack(nodes: FloatArray, age: FloatArray, slowness: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Edges of the cells in position and in reference age, and their coefficients, shape (cells, 11)."""
    cells = np.zeros((nodes.size + 1, 11))
    anchors = np.concatenate((nodes[:1], nodes))
    cells[:, 0] = anchors
    cells[:, 1] = np.concatenate((age[1, :1], age[1]))
    width, passed = np.diff(nodes), np.diff(age[1])
    for column, row in ((2, 1), (5, 0)):
        cells[:, column] = np.concatenate((slowness[row, :1], slowness[row]))
        cells[1:-1, column + 1 : column + 3] = _cubic(width, np.diff(age[row]), slowness[row])
    cells[:, 8] = 1 / cells[:, 2]
    cells[1:-1, 9:] = _cubic(passed, width, 1 / slowness[1])
    ends = np.array([np.inf])
    return np.concatenate((-ends, nodes, ends)), np.concatenate((-ends, age[1], ends)), cells


def _cubic(width: FloatArray, rise: FloatArray, slope: FloatArray) -> FloatArray:
    """Second and third coefficient of the cubic with these slopes at the nodes."""
    mean, first, last = rise / width, slope[:-1], slope[1:]
    return np.stack([(3 * mean - 2 * first - last) / width, (first + last - 2 * mean) / width**2], axis=1)


@njit(cache=True, error_model="numpy")
def search(edges: FloatArray, x: float, j: int) -> int:
    """Cell that holds x, walking from cell j: beads come in order."""
    while x >= edges[j + 1]:
        j += 1
    while x < edges[j]:
        j -= 1
    return j


@njit(cache=True, error_model="numpy")
def reference(cells: FloatArray, x: float, j: int) -> tuple[float, float, float]:
    """Age, slowness and its slope by the reference."""
    d = x - cells[j, 0]
    p, b, c = cells[j, 2], cells[j, 3], cells[j, 4]
    return cells[j, 1] + d * (p + d * (b + d * c)), p + d * (2 * b + 3 * d * c), 2 * b + 6 * d * c


@njit(cache=True, error_model="numpy")
def speed_now(cells: FloatArray, share: float, x: float, j: int, speed: float, slope: float) -> tuple[float, float]:
    """V and V' now, from those of the reference and of the first profile."""
    if share >= 1.0:
        return speed, slope
    d = x - cells[j, 0]
    b, c = cells[j, 6], cells[j, 7]
    v = 1 / (cells[j, 5] + d * (2 * b + 3 * d * c))
    dv = -(2 * b + 6 * d * c) * v * v
    return share * speed + (1 - share) * v, share * slope + (1 - share) * dv


@njit(cache=True, error_model="numpy")
def place(cells: FloatArray, age: float, j: int) -> float:
    """Position of a reference age in cell j, as good as the table."""
    d = age - cells[j, 1]
    x: float = cells[j, 0] + d * (cells[j, 8] + d * (cells[j, 9] + d * cells[j, 10]))
    return x
