"""Repulsion of the thread's charge, compiled: exact straight segments, or beads with near pairs put right (hybrid).

Every force is minus the gradient of one energy. `EXACT` (straight jets): all pairs of segments in closed form. `HYBRID`:
each segment's charge in halves at its ends, softened by the radius, over all pairs; and for segments up to `NEAR` apart
along the arc the exact straight energy less the lumped one, as tensions. A straight feed line stands upstream of the
nozzle and moves with it. With `PRESSURE` the energy's change with the radii (at fixed volume) acts as a tension too.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AREA,
    CHARGE,
    COUPLING,
    EXACT,
    FEED_COUNT,
    FEED_FIRST,
    HYBRID,
    LENGTH,
    NEAR,
    PRESSURE,
    RADIUS,
    REPULSION,
    SHARE,
    TENSION,
    TREE,
    IntArray,
    X,
)
from spinline.jetprofile.spun._line_kernels import (
    far_rest,
    feed_field,
    point_pair,
    ripple,
    segment_pair,
    segment_self,
)
from spinline.jetprofile.spun._mirror_kernels import OPENING, mirror_forces
from spinline.jetprofile.spun._tree_kernels import pair_sum, tree_sum

__all__ = ["beads", "near_pairs", "repulsion"]


@njit(cache=True, error_model="numpy")
def repulsion(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, f: FloatArray) -> None:
    """Add the charge's forces on the nodes, and its tensions of the elements."""
    if k[REPULSION] != EXACT and k[REPULSION] != HYBRID:
        return
    m = n + 1
    x, charge, a2, radial = np.empty((m, 3)), np.empty(m), np.empty(m), np.zeros(m)
    beads(n, y, w, x, charge, a2)
    lumped = k[REPULSION] == HYBRID
    reach = k[NEAR] if lumped else n
    near_pairs(n, reach, lumped, a2, radial, y, p, k, w)
    _feed_pairs(n, reach, lumped, a2, radial, y, p, k, w)
    if lumped:
        _bead_forces(n, x, charge, a2, radial, p, k, f)
        mirror_forces(n, y, p, k, w, f)
    if k[PRESSURE] == 1:
        # a_i^2 is the mean of the two elements beside a node (an end node has one)
        for i in range(n):
            share = radial[i] * (1.0 if i == 0 else 0.5) + radial[i + 1] * (1.0 if i == n - 1 else 0.5)
            w[TENSION, i] -= p[COUPLING] * share * w[AREA, i] / (math.pi * w[LENGTH, i])


@njit(cache=True, error_model="numpy")
def near_pairs(
    n: int,
    reach: int,
    lumped: bool,
    a2: FloatArray,
    radial: FloatArray,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    w: FloatArray,
) -> None:
    """Tensions of all pairs of segments up to `reach` apart: exact, less the lumped where wanted.

    `radial` takes the energy's derivatives with the nodes' squared radii.
    """
    gaps = np.zeros(n + 1)
    for i in range(n):
        qi, li, ai = y[i, CHARGE] * w[SHARE, i], w[LENGTH, i], w[AREA, i] / math.pi
        _, by_l, by_a = segment_self(qi, li, ai)
        own = by_l - (by_a * ai / li if k[PRESSURE] == 1 else 0.0)
        if lumped:
            _, slope, soft = point_pair(0.25 * qi * qi, li, 0.5 * (a2[i] + a2[i + 1]))
            _, front = far_rest(li, reach, i, ai)
            _, back = far_rest(li, reach, n - 1 - i, ai)
            own += qi * qi * (front + back) - slope
            radial[i] -= 0.5 * soft
            radial[i + 1] -= 0.5 * soft
        gap = 0.0
        for j in range(i + 1, min(n, i + reach + 1)):
            qj, lj, aj = y[j, CHARGE] * w[SHARE, j], w[LENGTH, j], w[AREA, j] / math.pi
            _, by_i, by_j, by_g, by_a = segment_pair(qi, qj, li, lj, gap, 0.5 * (ai + aj))
            if k[PRESSURE] == 1:
                by_i -= 0.5 * by_a * ai / li
                by_j -= 0.5 * by_a * aj / lj
            if lumped:
                less_i, less_j, less_g = _lumped_pair(i, j, 0.25 * qi * qj, li, lj, gap, a2, radial)
                by_i -= less_i
                by_j -= less_j
                by_g -= less_g
                if j == i + 1:
                    more_i, more_j = _ripple_slopes(qi, qj, li, lj, ai, aj, k)
                    by_i += more_i
                    by_j += more_j
            own += by_i
            w[TENSION, j] += p[COUPLING] * by_j
            gaps[i + 1] += by_g
            gaps[j] -= by_g
            gap += lj
        w[TENSION, i] += p[COUPLING] * own
    run = 0.0
    for i in range(n):
        run += gaps[i]
        w[TENSION, i] += p[COUPLING] * run


@njit(cache=True, error_model="numpy")
def _ripple_slopes(
    qi: float, qj: float, li: float, lj: float, ai: float, aj: float, k: IntArray
) -> tuple[float, float]:
    """Slopes with L_i and L_j of the energy of neighbours whose line charges differ."""
    c, by_l, by_a = ripple(li, lj, 0.5 * (ai + aj))
    ei, ej = qi / li, qj / lj
    apart = ei - ej
    own, rise = apart * apart * by_l / (li + lj) ** 2, c * apart
    less = 0.25 * apart * apart * by_a if k[PRESSURE] == 1 else 0.0
    return own * lj * lj - rise * ei / li - less * ai / li, own * li * li + rise * ej / lj - less * aj / lj


@njit(cache=True, error_model="numpy")
def _lumped_pair(
    i: int, j: int, e: float, li: float, lj: float, gap: float, a2: FloatArray, radial: FloatArray
) -> tuple[float, float, float]:
    """Slopes (L_i, L_j, gap) of the energy of two segments' halves at their ends, in line; a shared end does not count."""
    by_i = by_j = by_g = 0.0
    for a in range(2):
        for b in range(2):
            if i + 1 - a == j + b:
                continue
            u = gap + a * li + b * lj
            _, slope, soft = point_pair(e, u, 0.5 * (a2[i + 1 - a] + a2[j + b]))
            by_g += slope
            by_i += a * slope
            by_j += b * slope
            radial[i + 1 - a] -= 0.5 * soft
            radial[j + b] -= 0.5 * soft
    return by_i, by_j, by_g


@njit(cache=True, error_model="numpy")
def _feed_pairs(
    n: int,
    reach: int,
    lumped: bool,
    a2: FloatArray,
    radial: FloatArray,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    w: FloatArray,
) -> None:
    """Tensions of the segments with the feed line, exact along the arc, less the lumped where wanted."""
    foot = p[RADIUS] * p[RADIUS]
    for line in range(int(p[FEED_COUNT])):
        length, e = p[FEED_FIRST + 2 * line], p[FEED_FIRST + 2 * line + 1]
        gap = 0.0
        for i in range(n - 1, max(-1, n - 1 - reach), -1):
            li, ai = w[LENGTH, i], w[AREA, i] / math.pi
            _, by_i, _, by_g, by_a = segment_pair(
                y[i, CHARGE] * w[SHARE, i], e * length, li, length, gap, 0.5 * (ai + foot)
            )
            if k[PRESSURE] == 1:
                by_i -= 0.5 * by_a * ai / li
            if lumped:
                half = 0.5 * y[i, CHARGE] * w[SHARE, i] * e
                for b in range(2):
                    u = gap + b * li
                    ex, _, _, _, soft, _ = feed_field(u, 0.0, 0.0, 0.5 * (a2[i + 1 - b] + foot), length, 0.0)
                    by_g += half * ex
                    by_i += b * half * ex
                    radial[i + 1 - b] -= 0.5 * half * soft
            w[TENSION, i] += p[COUPLING] * by_i
            gap += li
            _spread(i, n, p[COUPLING] * by_g, w)


@njit(cache=True, error_model="numpy")
def _spread(i: int, n: int, pull: float, w: FloatArray) -> None:
    """A gap's derivative as a tension of every element between i and the nozzle."""
    for j in range(i + 1, n):
        w[TENSION, j] += pull


@njit(cache=True, error_model="numpy")
def beads(n: int, y: FloatArray, w: FloatArray, x: FloatArray, charge: FloatArray, a2: FloatArray) -> None:
    """Positions, lumped charges and squared radii of the n + 1 nodes."""
    for i in range(n + 1):
        x[i, 0], x[i, 1], x[i, 2] = y[i, X], y[i, X + 1], y[i, X + 2]
        low, high = max(i - 1, 0), min(i, n - 1)
        charge[i] = 0.5 * (
            (y[i, CHARGE] * w[SHARE, i] if i < n else 0.0) + (y[i - 1, CHARGE] * w[SHARE, i - 1] if i > 0 else 0.0)
        )
        a2[i] = 0.5 * (w[AREA, low] + w[AREA, high]) / math.pi


@njit(cache=True, error_model="numpy")
def _bead_forces(
    n: int,
    x: FloatArray,
    charge: FloatArray,
    a2: FloatArray,
    radial: FloatArray,
    p: FloatArray,
    k: IntArray,
    f: FloatArray,
) -> None:
    """Forces of all pairs of lumped charges, and of the feed lines; radii's share to `radial`."""
    m = n + 1
    field, inverse, potential = np.zeros((m, 3)), np.zeros(m), np.zeros(m)
    if m > k[TREE]:
        tree_sum(x, a2, x, charge, a2, OPENING, field, inverse, potential)
    else:
        pair_sum(x, charge, a2, field, inverse, potential)
    for i in range(m):
        radial[i] -= 0.25 * charge[i] * inverse[i]  # each pair's a^2 is the mean of its two
    for line in range(int(p[FEED_COUNT])):
        length, e = p[FEED_FIRST + 2 * line], p[FEED_FIRST + 2 * line + 1]
        for i in range(m):
            soft = 0.5 * (a2[i] + p[RADIUS] * p[RADIUS])
            ex, ey, ez, _, by_a, _ = feed_field(x[i, 0], x[i, 1] - x[n, 1], x[i, 2] - x[n, 2], soft, length, 0.0)
            field[i, 0] += e * ex
            field[i, 1] += e * ey
            field[i, 2] += e * ez
            radial[i] += 0.5 * charge[i] * e * by_a
    for i in range(m):
        for c in range(3):
            f[i, c] += p[COUPLING] * charge[i] * field[i, c]
