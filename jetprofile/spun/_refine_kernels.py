"""Refinement, compiled: an element longer than wanted is split in two halves of its volume, the others stay (Eqs. 28-30).

The new node lies on the cubic through four nodes in the label; volume, charge and label are halved exactly, conformation is
linear in its logarithm with the mean kept. Nothing else is interpolated, so a jet that is split often does not smear.
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
    VOLUME,
    VX,
    IntArray,
    X,
)
from spinline.jetprofile.spun._nozzle_kernels import lagrange

__all__ = ["refine"]


@njit(cache=True, error_model="numpy")
def refine(n: int, y: FloatArray, held: IntArray, marks: FloatArray, p: FloatArray) -> int:
    """Split what is too long; the number of elements afterwards. The growing element and laid ones are left alone."""
    i = 0
    while i < n - 1 and n + 2 < y.shape[0]:
        length = math.sqrt(
            (y[i, X] - y[i + 1, X]) ** 2 + (y[i, X + 1] - y[i + 1, X + 1]) ** 2 + (y[i, X + 2] - y[i + 1, X + 2]) ** 2
        )
        if length <= p[LONGEST] or held[i] == 1 or held[i + 1] == 1:
            i += 1
            continue
        _halve(n, i, y, held, marks)
        n += 1
        i += 2
    return n


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
    for col in (VOLUME, LABEL, CHARGE):
        y[i + 1, col] = 0.5 * y[i, col]
        y[i, col] -= y[i + 1, col]
    if i > 0:
        reach = 0.5 * before + own + 0.5 * behind
        for col in (AZZ, ARR):
            rise = (
                math.log(y[i - 1, col] / y[i + 2, col]) / reach if y[i - 1, col] > 0.0 and y[i + 2, col] > 0.0 else 0.0
            )
            y[i, col] *= math.exp(0.25 * own * rise)
            y[i + 1, col] *= math.exp(-0.25 * own * rise)
