"""Refinement, compiled: an element longer than wanted is split in two halves of its volume, the others stay (Eqs. 28-30).

Too long is what is longer than a given length, or what turns by more than a given angle to a neighbour that is no longer (k l,
k the curvature of the bend) and is longer than an element at the nozzle. The new node lies on the cubic through four nodes in
the label; volume and label are halved, charge over volume is linear with the lesser slope of the two sides, conformation
linear in its logarithm, each with the mean kept. Nothing else is interpolated, so a jet that is split often does not smear.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    ARR,
    AZZ,
    CHARGE,
    COLUMNS,
    LABEL,
    LONGEST,
    MX,
    RADIUS,
    TURN,
    VOLUME,
    VX,
    IntArray,
    X,
)
from spinline.jetprofile.spun._nozzle_kernels import lagrange

__all__ = ["refine"]


@njit(cache=True, error_model="numpy")
def refine(n: int, step: float, y: FloatArray, held: IntArray, marks: FloatArray, p: FloatArray) -> int:
    """Split what is too long; the number of elements afterwards. The growing element and laid ones are left alone.

    `step`: volume of an element that enters.
    """
    least = step / (math.pi * p[RADIUS] ** 2)
    i = 0
    while i < n - 1 and n + 2 < y.shape[0]:
        length = _length(i, y)
        long = p[LONGEST] > 0.0 and length > p[LONGEST]
        if not long and p[TURN] > 0.0 and length > least:
            long = _bends(i, n, length, y, p)
        if not long or held[i] == 1 or held[i + 1] == 1:
            i += 1
            continue
        _halve(n, i, y, held, marks)
        n += 1
        i += 2
    return n


@njit(cache=True, error_model="numpy")
def _length(i: int, y: FloatArray) -> float:
    return math.sqrt(
        (y[i, X] - y[i + 1, X]) ** 2 + (y[i, X + 1] - y[i + 1, X + 1]) ** 2 + (y[i, X + 2] - y[i + 1, X + 2]) ** 2
    )


@njit(cache=True, error_model="numpy")
def _bends(i: int, n: int, length: float, y: FloatArray, p: FloatArray) -> bool:
    """Whether element i turns too far from a neighbour, and is the longer of the two."""
    for j in (i - 1, i + 1):
        if j < 0 or j >= n:
            continue
        other = _length(j, y)
        if other > length:
            continue
        along = 0.0
        for c in range(3):
            along += (y[i, X + c] - y[i + 1, X + c]) * (y[j, X + c] - y[j + 1, X + c])
        if along < math.cos(p[TURN]) * length * other:
            return True
    return False


@njit(cache=True, error_model="numpy")
def _slope(front: float, own: float, behind: float) -> float:
    """The lesser of two slopes, none where they differ in sign."""
    if front * behind <= 0.0:
        return 0.0
    value: float = own * min(abs(front), abs(behind)) * (1.0 if front > 0.0 else -1.0)
    return value


@njit(cache=True, error_model="numpy")
def _halve(n: int, i: int, y: FloatArray, held: IntArray, marks: FloatArray) -> None:
    """Split element i; nodes behind it move up by one."""
    own, half = y[i, LABEL], 0.5 * y[i, LABEL]
    before = y[i - 1, LABEL] if i > 0 else 0.0
    behind = y[i + 1, LABEL] if i + 1 < n else 0.0
    between = (0.0, 0.0, 0.0, 0.0)
    inside = i > 0 and i + 2 <= n
    if inside:
        between = lagrange(half, -before, 0.0, own, own + behind)
    for j in range(n, i, -1):
        for c in range(COLUMNS):
            y[j + 1, c] = y[j, c]
        for c in range(marks.shape[1]):
            marks[j + 1, c] = marks[j, c]
        held[j + 1] = held[j]
    held[i + 1] = 0
    for c in range(COLUMNS):
        y[i + 1, c] = y[i, c]
    for c in range(3):
        for first in (X, VX):
            col = first + c
            if inside:
                y[i + 1, col] = (
                    between[0] * y[i - 1, col]
                    + between[1] * y[i, col]
                    + between[2] * y[i + 2, col]
                    + between[3] * y[i + 3, col]
                )
            else:
                y[i + 1, col] = 0.5 * (y[i, col] + y[i + 2, col])
        y[i + 1, MX + c] = 0.5 * (y[i, MX + c] + y[i + 2, MX + c])
    lean = 0.0
    if i > 0 and behind > 0.0:
        there, here, next_ = y[i - 1, CHARGE] / before, y[i, CHARGE] / own, y[i + 2, CHARGE] / behind
        lean = _slope((there - here) / (before + own), 0.25 * own * own, (here - next_) / (own + behind))
    for col in (VOLUME, LABEL, CHARGE):
        y[i + 1, col] = 0.5 * y[i, col] - (lean if col == CHARGE else 0.0)
        y[i, col] -= y[i + 1, col]
    if i > 0:
        reach = 0.5 * before + own + 0.5 * behind
        for col in (AZZ, ARR):
            rise = (
                math.log(y[i - 1, col] / y[i + 2, col]) / reach if y[i - 1, col] > 0.0 and y[i + 2, col] > 0.0 else 0.0
            )
            tilt = math.tanh(0.25 * own * rise)
            y[i, col] *= 1.0 + tilt
            y[i + 1, col] *= 1.0 - tilt
