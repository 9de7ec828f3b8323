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
    EXACT,
    FEED_CHARGE,
    FEED_LENGTH,
    GIVEN_CURRENT,
    LENGTH,
    LOCAL,
    LOG_LENGTH,
    NEAR,
    NO_REPULSION,
    POTENTIAL_IN,
    RADIUS,
    REPULSION,
    TX,
    VX,
    IntArray,
    X,
)
from spinline.jetprofile.spun._coulomb_kernels import beads, feed_field
from spinline.jetprofile.spun._field_kernels import applied_field
from spinline.jetprofile.spun._line_kernels import far_rest, point_pair, segment_pair, segment_self

__all__ = ["balance", "potential_matrix"]


@njit(cache=True, error_model="numpy")
def _electromotive(
    j: int, t: float, n: int, y: FloatArray, p: FloatArray, k: IntArray, tables: FloatArray, w: FloatArray
) -> float:
    """Applied field along the thread from the middle of element j to that of element j - 1, V."""
    ex, ey, ez = applied_field(t, y[j, X], y[j, X + 1], y[j, X + 2], p, k, tables)
    total = 0.0
    if j > 0:
        total += 0.5 * w[LENGTH, j - 1] * (ex * w[TX, j - 1] + ey * w[TX + 1, j - 1] + ez * w[TX + 2, j - 1])
    if j < n:
        total += 0.5 * w[LENGTH, j] * (ex * w[TX, j] + ey * w[TX + 1, j] + ez * w[TX + 2, j])
    return total


@njit(cache=True, error_model="numpy")
def balance(
    t: float,
    n: int,
    gh: float,
    front: float,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    rate: FloatArray,
) -> float:
    """Move the charge over a stage of weight `gh`; writes dq/dt to `rate`, the charges to `y`, returns the current in.

    `front` is the current that leaves at the front (0 for a free end).
    """
    known = np.empty(n)
    for i in range(n):
        known[i] = y[i, CHARGE]
    resist, drive = np.empty(n + 1), np.empty(n + 1)
    for j in range(1, n + 1):
        d = 0.5 * w[LENGTH, j - 1] / w[AREA, j - 1]
        if j < n:
            d += 0.5 * w[LENGTH, j] / w[AREA, j]
        resist[j] = d / p[CONDUCTIVITY]
        drive[j] = _electromotive(j, t, n, y, p, k, tables, w)
    given = k[BALANCE] == GIVEN_CURRENT
    if not given:
        carried = p[POTENTIAL_IN] * _line_capacity(p, k) * y[n, VX]
        drive[n] += p[POTENTIAL_IN] + resist[n] * carried
    if k[REPULSION] == LOCAL or k[REPULSION] == NO_REPULSION:
        current = _tridiagonal(n, gh, front, given, known, resist, drive, p, k, w)
    else:
        current = _dense(n, gh, front, given, known, resist, drive, y, p, k, w)
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


@njit(cache=True, error_model="numpy")
def _dense(
    n: int,
    gh: float,
    front: float,
    given: bool,
    known: FloatArray,
    resist: FloatArray,
    drive: FloatArray,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    w: FloatArray,
) -> FloatArray:
    """Currents with every charge seeing every other: Cholesky of ``R + g h B P B^T``."""
    matrix, outer = np.zeros((n, n)), np.zeros(n)
    potential_matrix(n, y, p, k, w, matrix, outer)
    last = n - 1 if given else n
    start = known.copy()
    start[0] -= gh * front
    if given:
        start[n - 1] += gh * p[CURRENT]
    psi = np.dot(matrix, start) + outer
    system, right = np.empty((last, last)), np.empty(last)
    for j in range(1, last + 1):
        right[j - 1] = drive[j] - psi[j - 1] + (psi[j] if j < n else 0.0)
        for m in range(1, last + 1):
            value = matrix[j - 1, m - 1]
            if j < n:
                value -= matrix[j, m - 1]
            if m < n:
                value -= matrix[j - 1, m]
                if j < n:
                    value += matrix[j, m]
            system[j - 1, m - 1] = gh * value
        system[j - 1, j - 1] += resist[j]
    current = np.empty(n + 1)
    current[0] = front
    if given:
        current[n] = p[CURRENT]
    current[1 : last + 1] = np.linalg.solve(system, right)
    return current


@njit(cache=True, error_model="numpy")
def potential_matrix(
    n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, matrix: FloatArray, outer: FloatArray
) -> None:
    """P of the energy ``q P q/2`` of the elements' charges, V/C, and the potential of the feed line."""
    exact = k[REPULSION] == EXACT
    reach = n if exact else k[NEAR]
    length, e = p[FEED_LENGTH], p[FEED_CHARGE]
    foot = p[RADIUS] ** 2
    m = n + 1
    x, charge, a2 = np.empty((m, 3)), np.empty(m), np.empty(m)
    beads(n, y, w, x, charge, a2)
    for i in range(n):
        li, ai = w[LENGTH, i], w[AREA, i] / math.pi
        u, _, _ = segment_self(1.0, li, ai)
        if not exact:
            less, _, _ = point_pair(0.25, li, 0.5 * (a2[i] + a2[i + 1]))
            front, _ = far_rest(li, reach, i, ai)
            back, _ = far_rest(li, reach, n - 1 - i, ai)
            u += front + back - less
        matrix[i, i] += 2.0 * p[COUPLING] * u
        gap = 0.0
        for j in range(i + 1, min(n, i + reach + 1)):
            lj, aj = w[LENGTH, j], w[AREA, j] / math.pi
            u, _, _, _, _ = segment_pair(1.0, 1.0, li, lj, gap, 0.5 * (ai + aj))
            if not exact:
                for a in range(2):
                    for b in range(2):
                        if i + 1 - a != j + b:
                            apart = gap + a * li + b * lj
                            less, _, _ = point_pair(0.25, apart, 0.5 * (a2[i + 1 - a] + a2[j + b]))
                            u -= less
            matrix[i, j] += p[COUPLING] * u
            matrix[j, i] += p[COUPLING] * u
            gap += lj
    if not exact:
        _bead_matrix(n, x, a2, p, matrix)
    if e == 0.0 or length == 0.0:
        return
    gap = 0.0
    for i in range(n - 1, -1, -1):
        li = w[LENGTH, i]
        near = exact or n - 1 - i < reach
        u = 0.0
        if near:
            u, _, _, _, _ = segment_pair(1.0, e * length, li, length, gap, 0.5 * (w[AREA, i] / math.pi + foot))
        if not exact:
            for j in range(i, i + 2):
                soft = 0.5 * (a2[j] + foot)
                _, _, _, level, _, _ = feed_field(
                    y[j, X], y[j, X + 1] - y[n, X + 1], y[j, X + 2] - y[n, X + 2], soft, length, 0.0
                )
                if near:
                    _, _, _, flat, _, _ = feed_field(gap + (i + 1 - j) * li, 0.0, 0.0, soft, length, 0.0)
                    level -= flat
                u += 0.5 * e * level
        outer[i] = p[COUPLING] * u
        gap += li


@njit(cache=True, error_model="numpy")
def _bead_matrix(n: int, x: FloatArray, a2: FloatArray, p: FloatArray, matrix: FloatArray) -> None:
    """Adds the lumped charges' part: half of each element's charge at each of its ends."""
    for a in range(n + 1):
        for b in range(a):
            dx, dy, dz = x[a, 0] - x[b, 0], x[a, 1] - x[b, 1], x[a, 2] - x[b, 2]
            one = 0.25 * p[COUPLING] / math.sqrt(dx * dx + dy * dy + dz * dz + 0.5 * (a2[a] + a2[b]))
            for i in (a - 1, a):
                for j in (b - 1, b):
                    if 0 <= i < n and 0 <= j < n:
                        matrix[i, j] += one
                        matrix[j, i] += one
