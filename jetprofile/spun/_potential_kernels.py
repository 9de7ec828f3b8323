"""Potential of the jet's charge at its elements, ``Psi = P q``, compiled: the same energy as the forces, ``U = q P q/2``.

P is kept in two parts: what nearby elements have as segments beyond their lumped halves (a band, `near_band`), and the
lumped halves of all, each pair of nodes once (a matrix for short chains, all pairs or the tree for long ones), with the mirror
charges behind an earthed plate where there is one.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AREA,
    COUPLING,
    EXACT,
    FEED_COUNT,
    FEED_FIRST,
    GAP,
    IMAGE,
    LENGTH,
    LOG_LENGTH,
    NEAR,
    RADIUS,
    REPULSION,
    SHARE,
    IntArray,
    X,
)
from spinline.jetprofile.spun._coulomb_kernels import beads
from spinline.jetprofile.spun._line_kernels import (
    far_rest,
    feed_field,
    point_pair,
    ripple,
    segment_pair,
    segment_self,
)
from spinline.jetprofile.spun._mirror_kernels import OPENING, middles, mirror_kernel, mirror_level
from spinline.jetprofile.spun._needle_kernels import needle_level, needle_matrix
from spinline.jetprofile.spun._tree_kernels import tree_sum

__all__ = ["bare_outer", "far_band", "level", "log_level", "near_band", "outer_level", "potential_matrix"]


@njit(cache=True, error_model="numpy")
def potential_matrix(
    n: int,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    matrix: FloatArray,
    outer: FloatArray,
) -> None:
    """P of the elements' charges, V/C, added to `matrix`, and the potential of the feed line, added to `outer`."""
    reach = n if k[REPULSION] == EXACT else k[NEAR]
    x, charge, a2 = np.empty((n + 1, 3)), np.empty(n + 1), np.empty(n + 1)
    beads(n, y, w, x, charge, a2)
    near = np.zeros((n, reach + 1))
    near_band(n, reach, 0, a2, p, k, w, near)
    for i in range(n):
        matrix[i, i] += near[i, 0]
        for d in range(1, min(reach, n - 1 - i) + 1):
            matrix[i, i + d] += near[i, d]
            matrix[i + d, i] += near[i, d]
    if k[REPULSION] != EXACT:
        _bead_matrix(n, x, a2, p, matrix)
        _mirror_matrix(n, y, p, k, w, matrix)
        needle_matrix(n, y, p, tables, w, matrix)
    for i in range(n):
        for j in range(n):
            matrix[i, j] *= w[SHARE, i] * w[SHARE, j]
        matrix[i, i] += local_level(i, p, w)
    outer_level(n, y, p, k, tables, w, a2, outer)


@njit(cache=True, error_model="numpy")
def local_level(i: int, p: FloatArray, w: FloatArray) -> float:
    """The local logarithm's part of an element's own potential, V/C; none beyond the cone."""
    rest: float = 1.0 - w[SHARE, i] ** 2
    if rest == 0.0:
        return rest
    value: float = rest * log_level(i, p, w)
    return value


@njit(cache=True, error_model="numpy")
def log_level(i: int, p: FloatArray, w: FloatArray) -> float:
    """An element's own potential by the local logarithm, V/C."""
    value: float = 2.0 * p[COUPLING] * math.log(p[LOG_LENGTH] / math.sqrt(w[AREA, i] / math.pi)) / w[LENGTH, i]
    return value


@njit(cache=True, error_model="numpy")
def near_band(
    n: int, reach: int, low: int, a2: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, near: FloatArray
) -> None:
    """Element i and element i + d as straight segments, less their lumped halves: `near[i, d]`, V/C, from `low` on."""
    exact = k[REPULSION] == EXACT
    for i in range(low, n):
        li, ai = w[LENGTH, i], w[AREA, i] / math.pi
        u, _, _ = segment_self(1.0, li, ai)
        if not exact:
            less, _, _ = point_pair(0.25, li, 0.5 * (a2[i] + a2[i + 1]))
            front, _ = far_rest(li, reach, i, ai)
            back, _ = far_rest(li, reach, n - 1 - i, ai)
            u += front + back - less
        near[i, 0] += 2.0 * p[COUPLING] * u
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
            if not exact and j == i + 1:
                stiff, _, _ = ripple(li, lj, 0.5 * (ai + aj))
                near[i, 0] += p[COUPLING] * stiff / (li * li)
                near[j, 0] += p[COUPLING] * stiff / (lj * lj)
                u -= stiff / (li * lj)
            near[i, j - i] = p[COUPLING] * u
            gap += lj


@njit(cache=True, error_model="numpy")
def _kernel(a: int, b: int, x: FloatArray, a2: FloatArray) -> float:
    """1/distance of two softened nodes; 0 for a node and itself."""
    if a == b:
        return 0.0
    dx, dy, dz = x[a, 0] - x[b, 0], x[a, 1] - x[b, 1], x[a, 2] - x[b, 2]
    value: float = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz + 0.5 * (a2[a] + a2[b]))
    return value


@njit(cache=True, error_model="numpy")
def _bead_matrix(n: int, x: FloatArray, a2: FloatArray, p: FloatArray, matrix: FloatArray) -> None:
    """Adds the lumped charges' part: half of each element's charge at each of its ends."""
    for a in range(n + 1):
        for b in range(a):
            one = 0.25 * p[COUPLING] * _kernel(a, b, x, a2)
            for i in (a - 1, a):
                for j in (b - 1, b):
                    if 0 <= i < n and 0 <= j < n:
                        matrix[i, j] += one
                        matrix[j, i] += one


@njit(cache=True, error_model="numpy")
def _mirror_matrix(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, matrix: FloatArray) -> None:
    """Takes off the mirror charges'."""
    if k[IMAGE] == 0:
        return
    x, a2 = np.empty((n, 3)), np.empty(n)
    middles(n, y, w, x, a2)
    for i in range(n):
        for j in range(i + 1):
            one = p[COUPLING] * mirror_kernel(i, j, x, a2, p, w)
            matrix[i, j] -= one
            if i != j:
                matrix[j, i] -= one


@njit(cache=True, error_model="numpy")
def far_band(
    n: int,
    width: int,
    reach: int,
    y: FloatArray,
    x: FloatArray,
    a2: FloatArray,
    p: FloatArray,
    k: IntArray,
    w: FloatArray,
    near: FloatArray,
    band: FloatArray,
) -> None:
    """P within `width` of its diagonal: `band[i, d]` for elements i and i + d."""
    xm, am = np.empty((n, 3)), np.empty(n)
    middles(n, y, w, xm, am)
    answered = k[IMAGE] == 1
    for i in range(n):
        for d in range(min(width, n - 1 - i) + 1):
            j = i + d
            value = near[i, d] if d <= reach else 0.0
            for a in range(i, i + 2):
                for b in range(j, j + 2):
                    value += 0.25 * p[COUPLING] * _kernel(a, b, x, a2)
            if answered:
                value -= p[COUPLING] * mirror_kernel(i, j, xm, am, p, w)
            band[i, d] = value * w[SHARE, i] * w[SHARE, j] + (local_level(i, p, w) if d == 0 else 0.0)


@njit(cache=True, error_model="numpy")
def level(
    n: int,
    reach: int,
    q: FloatArray,
    y: FloatArray,
    x: FloatArray,
    a2: FloatArray,
    near: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    psi: FloatArray,
) -> None:
    """``psi = P q`` for a long chain: the band, and the lumped halves by the tree."""
    m = n + 1
    charge, own = np.zeros(m), np.empty(n)
    for i in range(n):
        own[i] = q[i] * w[SHARE, i]
        charge[i] += 0.5 * own[i]
        charge[i + 1] += 0.5 * own[i]
    field, inverse, potential = np.zeros((m, 3)), np.zeros(m), np.zeros(m)
    tree_sum(x, a2, x, charge, a2, OPENING, field, inverse, potential)
    xm, am = np.empty((n, 3)), np.empty(n)
    middles(n, y, w, xm, am)
    for i in range(n):
        psi[i] = 0.0
    mirror_level(xm, own, am, p, k, w, psi)
    needle_level(xm, own, False, n, y, p, tables, psi)
    for i in range(n):
        psi[i] = p[COUPLING] * (psi[i] + 0.5 * (potential[i] + potential[i + 1])) + near[i, 0] * own[i]
    for i in range(n):
        for d in range(1, min(reach, n - 1 - i) + 1):
            psi[i] += near[i, d] * own[i + d]
            psi[i + d] += near[i, d] * own[i]
    for i in range(n):
        psi[i] = psi[i] * w[SHARE, i] + local_level(i, p, w) * q[i]


@njit(cache=True, error_model="numpy")
def outer_level(
    n: int,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    a2: FloatArray,
    outer: FloatArray,
) -> None:
    """Potential of the feed lines at the elements, and of what they induce on the needle, as the elements see it, added to
    `outer`.
    """
    whole = np.zeros(n)
    bare_outer(n, y, p, k, tables, w, a2, whole)
    for i in range(n):
        outer[i] += whole[i] * w[SHARE, i]


@njit(cache=True, error_model="numpy")
def bare_outer(
    n: int,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    a2: FloatArray,
    outer: FloatArray,
) -> None:
    """`outer_level` before the cone takes its share."""
    if p[FEED_COUNT] > 0.0 and k[REPULSION] != EXACT:
        x, soft2, answer = np.empty((n, 3)), np.empty(n), np.zeros(n)
        middles(n, y, w, x, soft2)
        needle_level(x, np.zeros(n), True, n, y, p, tables, answer)
        for i in range(n):
            outer[i] += p[COUPLING] * answer[i]
    exact = k[REPULSION] == EXACT
    reach = n if exact else k[NEAR]
    foot = p[RADIUS] ** 2
    for line in range(int(p[FEED_COUNT])):
        length, e = p[FEED_FIRST + 2 * line], p[FEED_FIRST + 2 * line + 1]
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
                    dy, dz = y[j, X + 1] - y[n, X + 1], y[j, X + 2] - y[n, X + 2]
                    _, _, _, one, _, _ = feed_field(y[j, X], dy, dz, soft, length, 0.0)
                    if near:
                        _, _, _, flat, _, _ = feed_field(gap + (i + 1 - j) * li, 0.0, 0.0, soft, length, 0.0)
                        one -= flat
                    if k[IMAGE] == 1:
                        _, _, _, far, _, _ = feed_field(2.0 * p[GAP] - y[j, X], dy, dz, soft, length, 0.0)
                        one -= far
                    u += 0.5 * e * one
            outer[i] += p[COUPLING] * u
            gap += li
