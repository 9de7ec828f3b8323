"""Charge that moves in the liquid, compiled: the implicit balance of conducted current.

Unknowns are the node currents I (towards the front): ``R_j I_j + Psi_(j-1) - Psi_j = emf_j`` with ``R = d/(A K)`` between the
middles of neighbouring elements, and ``q_i = q_known + g h (I_(i+1) - I_i)``. ``Psi = P q`` is the potential of the same energy
that gives the forces, so the matrix ``R + g h B P B^T`` is symmetric and positive. The stiffness is the diffusion of line
charge, ``D = r^2 K ln(L/r)/(2 eps0)``; an L-stable stage makes long steps the quasi-steady balance.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AREA,
    BALANCE,
    CHARGE,
    CONDUCTIVITY,
    COUPLING,
    CURRENT,
    GIVEN_CURRENT,
    LENGTH,
    LOCAL,
    LOG_LENGTH,
    NO_REPULSION,
    POTENTIAL_IN,
    RADIUS,
    REPULSION,
    VX,
    IntArray,
    X,
    Y,
    Z,
)
from spinline.jetprofile.spun._current_kernels import currents
from spinline.jetprofile.spun._field_kernels import drop

__all__ = ["balance"]


@njit(cache=True, error_model="numpy")
def _electromotive(j: int, t: float, n: int, y: FloatArray, p: FloatArray, k: IntArray, tables: FloatArray) -> float:
    """Fall of the applied potential along the thread from the middle of element j to that of element j - 1, V."""
    total = 0.0
    for i in (j - 1, j):  # the halves of the two elements beside node j
        if 0 <= i < n:
            mx, my, mz = 0.5 * (y[i, X] + y[i + 1, X]), 0.5 * (y[i, Y] + y[i + 1, Y]), 0.5 * (y[i, Z] + y[i + 1, Z])
            if i < j:
                total += drop(t, y[j, X], y[j, Y], y[j, Z], mx, my, mz, p, k, tables)
            else:
                total += drop(t, mx, my, mz, y[j, X], y[j, Y], y[j, Z], p, k, tables)
    return total


@njit(cache=True, error_model="numpy")
def balance(
    t: float,
    n: int,
    gh: float,
    front: float,
    earthed: bool,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    rate: FloatArray,
) -> float:
    """Move the charge over a stage of weight `gh`; writes dq/dt to `rate`, the charges to `y`, returns the current in.

    `front` is the current that leaves at the front (0 for a free end); `earthed`: the front lies on the plate, whose
    potential is 0, and what leaves there comes out.
    """
    known = np.empty(n)
    for i in range(n):
        known[i] = y[i, CHARGE]
    resist, drive = np.empty(n + 1), np.empty(n + 1)
    for j in range(n + 1):
        d = 0.5 * w[LENGTH, j - 1] / w[AREA, j - 1] if j > 0 else 0.0
        if j < n:
            d += 0.5 * w[LENGTH, j] / w[AREA, j]
        resist[j] = d / p[CONDUCTIVITY]
        drive[j] = _electromotive(j, t, n, y, p, k, tables)
    if (
        n > 1
    ):  # what lands is a short heap that conducts well: half an element more, so that its charge stays determined
        resist[0] += 0.5 * w[LENGTH, 1] / w[AREA, 1] / p[CONDUCTIVITY]
    given = k[BALANCE] == GIVEN_CURRENT
    if not given:
        carried = p[POTENTIAL_IN] * _line_capacity(p, k) * y[n, VX]
        drive[n] += p[POTENTIAL_IN] + resist[n] * carried
    if k[REPULSION] == LOCAL or k[REPULSION] == NO_REPULSION:
        current = _tridiagonal(n, gh, front, given, known, resist, drive, p, k, w)
    else:
        current = currents(n, gh, front, earthed, given, known, resist, drive, y, p, k, tables, w)
    for i in range(n):
        rate[i] = current[i + 1] - current[i]
        y[i, CHARGE] = known[i] + gh * rate[i]
    value: float = current[n]
    return value


@njit(cache=True, error_model="numpy")
def _line_capacity(p: FloatArray, k: IntArray) -> float:
    """Line charge per potential where material enters, C/(m V)."""
    if k[REPULSION] == NO_REPULSION:
        return 0.0
    length = p[LOG_LENGTH] if p[LOG_LENGTH] > 0.0 else 100.0 * p[RADIUS]
    value: float = 1.0 / (2.0 * p[COUPLING] * math.log(length / p[RADIUS]))
    return value


@njit(cache=True, error_model="numpy")
def _tridiagonal(
    n: int,
    gh: float,
    front: float,
    given: bool,
    known: FloatArray,
    resist: FloatArray,
    drive: FloatArray,
    p: FloatArray,
    k: IntArray,
    w: FloatArray,
) -> FloatArray:
    """Currents with the local logarithm, ``Psi = 2 k lambda ln(L/r)``."""
    level = np.zeros(n)
    if k[REPULSION] == LOCAL:
        for i in range(n):
            radius = math.sqrt(w[AREA, i] / math.pi)
            level[i] = 2.0 * p[COUPLING] * math.log(p[LOG_LENGTH] / radius) / w[LENGTH, i]
    current = np.empty(n + 1)
    current[0] = front
    last = n - 1 if given else n
    if given:
        current[n] = p[CURRENT]
    upper, right = np.empty(n + 1), np.empty(n + 1)
    for j in range(1, last + 1):
        below = -level[j - 1] * gh
        above = -level[j] * gh if j < n else 0.0
        middle = resist[j] - below - above
        value = drive[j] - level[j - 1] * known[j - 1] + (level[j] * known[j] if j < n else 0.0)
        if j == 1:
            value -= below * front
            below = 0.0
        if j == last and given:
            value -= above * current[n]
            above = 0.0
        pivot = middle - (below * upper[j - 1] if j > 1 else 0.0)
        upper[j] = above / pivot
        right[j] = (value - (below * right[j - 1] if j > 1 else 0.0)) / pivot
    for j in range(last, 0, -1):
        current[j] = right[j] - (upper[j] * current[j + 1] if j < last else 0.0)
    return current
