"""Charge that the thread induces on its metal needle, compiled.

For the jet's charge the needle is a grounded hyperboloid (its own charge at its voltage is in the applied field), cut into
rings whose potentials of each other are known (`needle.rings`): ``Q = -A^-1 B q``, B the potential of the elements' charges at
the rings, mirrored in the plate. The thread's potential falls by ``B^T A^-1 B q``: a matrix that only takes energy away.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    CHARGE,
    COUPLING,
    FEED_COUNT,
    FEED_FIRST,
    GAP,
    RINGS,
    RINGS_FIRST,
    SHARE,
    IntArray,
    X,
)
from spinline.jetprofile.spun._line_kernels import feed_field
from spinline.jetprofile.spun._mirror_kernels import middles

__all__ = ["needle_forces", "needle_level", "needle_matrix"]


@njit(cache=True, error_model="numpy")
def _kernel(m: int, x: FloatArray, i: int, p: FloatArray, tables: FloatArray, g: FloatArray) -> float:
    """Potential at element i of unit charge on ring m, times 4 pi eps0, less its mirror's; minus its gradient to `g`."""
    soft = x[i, 1] ** 2 + x[i, 2] ** 2 + tables[RINGS_FIRST + 1, m] ** 2
    value = 0.0
    g[0] = g[1] = g[2] = 0.0
    for side in range(2):
        u = x[i, 0] - tables[RINGS_FIRST, m] - (2.0 * (p[GAP] - tables[RINGS_FIRST, m]) if side == 1 else 0.0)
        one = 1.0 / np.sqrt(u * u + soft)
        sign = 1.0 - 2.0 * side
        cube = sign * one * one * one
        value += sign * one
        g[0] += u * cube
        g[1] += x[i, 1] * cube
        g[2] += x[i, 2] * cube
    return value


@njit(cache=True, error_model="numpy")
def _answer(count: int, level: FloatArray, tables: FloatArray) -> FloatArray:
    """Charges on the rings that take a potential off them."""
    out = np.zeros(count)
    for a in range(count):
        for b in range(count):
            out[a] -= tables[RINGS_FIRST + 2 + a, b] * level[b]
    return out


@njit(cache=True, error_model="numpy")
def _of_feed(n: int, y: FloatArray, p: FloatArray, tables: FloatArray, level: FloatArray) -> None:
    """Adds the feed lines' potential at the rings."""
    for line in range(int(p[FEED_COUNT])):
        length, e = p[FEED_FIRST + 2 * line], p[FEED_FIRST + 2 * line + 1]
        for m in range(int(tables[0, RINGS])):
            at, wide2 = tables[RINGS_FIRST, m], tables[RINGS_FIRST + 1, m] ** 2
            _, _, _, near, _, _ = feed_field(at, y[n, X + 1], y[n, X + 2], wide2, length, 0.0)
            _, _, _, far, _, _ = feed_field(2.0 * p[GAP] - at, y[n, X + 1], y[n, X + 2], wide2, length, 0.0)
            level[m] += e * (near - far)


@njit(cache=True, error_model="numpy")
def needle_matrix(n: int, y: FloatArray, p: FloatArray, tables: FloatArray, w: FloatArray, matrix: FloatArray) -> None:
    """Takes the needle's part off P."""
    count = int(tables[0, RINGS])
    if count == 0:
        return
    x, a2, g = np.empty((n, 3)), np.empty(n), np.empty(3)
    middles(n, y, w, x, a2)
    to, back = np.empty((count, n)), np.zeros((count, n))
    for m in range(count):
        for i in range(n):
            to[m, i] = _kernel(m, x, i, p, tables, g)
    for a in range(count):
        for b in range(count):
            one = p[COUPLING] * tables[RINGS_FIRST + 2 + a, b]
            for i in range(n):
                back[a, i] += one * to[b, i]
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for m in range(count):
                total += to[m, i] * back[m, j]
            matrix[i, j] -= total
            if i != j:
                matrix[j, i] -= total


@njit(cache=True, error_model="numpy")
def needle_level(
    x: FloatArray,
    q: FloatArray,
    feed: bool,
    n: int,
    y: FloatArray,
    p: FloatArray,
    tables: FloatArray,
    level: FloatArray,
) -> None:
    """Potential of the rings' charges at the elements, times 4 pi eps0, added to `level`: what the elements' charges `q`
    induce, and with `feed` what the feed lines do.
    """
    count = int(tables[0, RINGS])
    if count == 0:
        return
    there, g = np.zeros(count), np.empty(3)
    for m in range(count):
        for i in range(n):
            there[m] += _kernel(m, x, i, p, tables, g) * q[i]
    if feed:
        _of_feed(n, y, p, tables, there)
    held = _answer(count, there, tables)
    for m in range(count):
        for i in range(n):
            level[i] += _kernel(m, x, i, p, tables, g) * held[m]


@njit(cache=True, error_model="numpy")
def needle_forces(
    n: int, y: FloatArray, p: FloatArray, k: IntArray, tables: FloatArray, w: FloatArray, f: FloatArray
) -> None:
    """Adds the forces of the rings' charges."""
    count = int(tables[0, RINGS])
    if count == 0:
        return
    x, a2, g, there = np.empty((n, 3)), np.empty(n), np.empty(3), np.zeros(count)
    middles(n, y, w, x, a2)
    for m in range(count):
        for i in range(n):
            there[m] += _kernel(m, x, i, p, tables, g) * y[i, CHARGE] * w[SHARE, i]
    _of_feed(n, y, p, tables, there)
    held = _answer(count, there, tables)
    for m in range(count):
        for i in range(n):
            _kernel(m, x, i, p, tables, g)
            half = 0.5 * p[COUPLING] * held[m] * y[i, CHARGE] * w[SHARE, i]
            for c in range(3):
                f[i, c] += half * g[c]
                f[i + 1, c] += half * g[c]
