"""Landing: a node is clamped where it touches; an element leaves the chain when it is the first and both ends lie."""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    CHARGE,
    COLUMNS,
    D_CHARGE,
    D_FLIGHT,
    D_FRONT,
    D_LABEL,
    D_LABEL_VOLUME,
    D_TIME,
    D_VOLUME,
    D_VX,
    D_X0,
    D_X1,
    LABEL,
    OUTFLOW,
    VOLUME,
    VX,
    IntArray,
    X,
    Y,
    Z,
)
from spinline.jetprofile.spun._collector_kernels import material_frame, place

__all__ = ["leave", "remove_landed", "touch"]


@njit(cache=True, error_model="numpy")
def _length(i: int, y: FloatArray) -> float:
    return math.sqrt((y[i, X] - y[i + 1, X]) ** 2 + (y[i, Y] - y[i + 1, Y]) ** 2 + (y[i, Z] - y[i + 1, Z]) ** 2)


@njit(cache=True, error_model="numpy")
def touch(
    t: float, i: int, n: int, y: FloatArray, held: IntArray, marks: FloatArray, p: FloatArray, k: IntArray
) -> None:
    """Clamp node i. `marks`: time, x, material y, z of each touch; flight length of the element
    behind node i (5); velocity (6 to 8).
    """
    marks[i, 6], marks[i, 7], marks[i, 8] = y[i, VX], y[i, VX + 1], y[i, VX + 2]
    place(i, y, p, k)
    held[i] = 1
    marks[i, 0], marks[i, 1], marks[i, 3] = t, y[i, X], y[i, Z]
    marks[i, 2] = material_frame(t, y[i, X], y[i, Y], p, k)
    if held[i + 1] == 0:
        marks[i, 5] = _length(i, y)
    if i > 0 and held[i - 1] == 0:
        marks[i - 1, 5] = _length(i - 1, y)


@njit(cache=True, error_model="numpy")
def leave(t: float, n: int, y: FloatArray, held: IntArray, marks: FloatArray, p: FloatArray) -> None:
    """Mark the front elements of a cut jet that have passed its outflow as gone."""
    i = 0
    while i < n - 2 and y[i + 1, X] > p[OUTFLOW]:
        for j in (i, i + 1):
            if held[j] == 0:
                held[j] = 1
                marks[j, 0], marks[j, 1], marks[j, 2], marks[j, 3] = t, y[j, X], y[j, Y], y[j, Z]
                marks[j, 6], marks[j, 7], marks[j, 8] = y[j, VX], y[j, VX + 1], y[j, VX + 2]
        marks[i, 5] = _length(i, y)
        i += 1


@njit(cache=True, error_model="numpy")
def remove_landed(
    n: int,
    origin: float,
    y: FloatArray,
    held: IntArray,
    marks: FloatArray,
    landed: FloatArray,
    count: int,
    open_end: bool,
) -> tuple[int, float, int]:
    """Move landed elements from the chain's front to the record; number of elements, label of the front, rows."""
    gone = 0
    while gone < n - 1 and held[gone] == 1 and held[gone + 1] == 1 and count < landed.shape[0]:
        i = gone
        first, last = (i, i + 1) if marks[i, 0] <= marks[i + 1, 0] else (i + 1, i)
        origin += y[i, LABEL]
        landed[count, D_TIME], landed[count, D_FRONT] = marks[last, 0], marks[first, 0]
        for c in range(3):
            landed[count, D_X0 + c], landed[count, D_X1 + c] = marks[i, 1 + c], marks[i + 1, 1 + c]
        landed[count, D_FLIGHT], landed[count, D_VOLUME] = marks[i, 5], y[i, VOLUME]
        landed[count, D_LABEL_VOLUME], landed[count, D_CHARGE] = y[i, LABEL], y[i, CHARGE]
        landed[count, D_LABEL] = origin
        for c in range(3):
            landed[count, D_VX + c] = marks[last, 6 + c]
        count += 1
        gone += 1
    if gone > 0:
        if open_end:
            held[gone] = 0
        for i in range(n + 1 - gone):
            held[i] = held[i + gone]
            for c in range(COLUMNS):
                y[i, c] = y[i + gone, c]
            for c in range(9):
                marks[i, c] = marks[i + gone, c]
        for i in range(n + 1 - gone, n + 1):
            held[i] = 0
    return n - gone, origin, count
