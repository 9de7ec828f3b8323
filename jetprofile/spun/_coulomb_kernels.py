"""Repulsion of the thread's charge, compiled: exact straight segments, or beads with near pairs put right (hybrid).

Every force is minus the gradient of one energy. `EXACT` (straight jets): all pairs of segments in closed form. `HYBRID`:
each segment's charge in halves at its ends, softened by the radius, over all pairs; and for segments up to `NEAR` apart
along the arc the exact straight energy less the lumped one, as tensions. A straight feed line stands upstream of the
nozzle. With `PRESSURE` the energy's change with the radii (at fixed volume) acts as a tension too.
"""

import math

import numpy as np
from numba import njit

from spinline.checks import FloatArray
from spinline.jetprofile.spun._codes import (
    AREA,
    CHARGE,
    COULOMB,
    EXACT,
    FEED_CHARGE,
    FEED_LENGTH,
    GAP,
    HYBRID,
    IMAGE,
    LENGTH,
    NEAR,
    PRESSURE,
    RADIUS,
    REPULSION,
    TENSION,
    TREE,
    X,
)
from spinline.jetprofile.spun._line_kernels import lumped_pair, lumped_self, segment_pair, segment_self
from spinline.jetprofile.spun._tree_kernels import direct_sum, pair_sum, tree_sum

__all__ = ["beads", "feed_field", "near_pairs", "repulsion"]

OPENING = 0.3


@njit(cache=True, error_model="numpy")
def repulsion(n: int, y: FloatArray, p: FloatArray, k: FloatArray, w: FloatArray, f: FloatArray) -> None:
    """Add the charge's forces on the nodes, and its tensions of the elements."""
    if k[REPULSION] == EXACT:
        near_pairs(n, n, False, y, p, k, w)
        _feed_pairs(n, n, False, y, p, k, w)
    elif k[REPULSION] == HYBRID:
        near_pairs(n, k[NEAR], True, y, p, k, w)
        _feed_pairs(n, k[NEAR], True, y, p, k, w)
        _bead_forces(n, y, p, k, w, f)


@njit(cache=True, error_model="numpy")
def near_pairs(n: int, reach: int, lumped: bool, y: FloatArray, p: FloatArray, k: FloatArray, w: FloatArray) -> None:
    """Tensions of all pairs of segments up to `reach` apart: exact, less the lumped where wanted."""
    gaps = np.zeros(n + 1)
    for i in range(n):
        qi, li, ai = y[i, CHARGE], w[LENGTH, i], w[AREA, i] / math.pi
        _, by_l, by_a = segment_self(qi, li, ai)
        if lumped:
            _, less_l, less_a = lumped_self(qi, li, ai)
            by_l -= less_l
            by_a -= less_a
        own = by_l - (by_a * ai / li if k[PRESSURE] == 1 else 0.0)
        gap = 0.0
        for j in range(i + 1, min(n, i + reach + 1)):
            qj, lj, aj = y[j, CHARGE], w[LENGTH, j], w[AREA, j] / math.pi
            a2 = 0.5 * (ai + aj)
            _, by_i, by_j, by_g, by_a = segment_pair(qi, qj, li, lj, gap, a2)
            if lumped:
                _, less_i, less_j, less_g, less_a = lumped_pair(qi, qj, li, lj, gap, a2)
                by_i -= less_i
                by_j -= less_j
                by_g -= less_g
                by_a -= less_a
            if k[PRESSURE] == 1:
                by_i -= 0.5 * by_a * ai / li
                by_j -= 0.5 * by_a * aj / lj
            own += by_i
            w[TENSION, j] += COULOMB * by_j
            gaps[i + 1] += by_g
            gaps[j] -= by_g
            gap += lj
        w[TENSION, i] += COULOMB * own
    run = 0.0
    for i in range(n):
        run += gaps[i]
        w[TENSION, i] += COULOMB * run


@njit(cache=True, error_model="numpy")
def _feed_pairs(n: int, reach: int, lumped: bool, y: FloatArray, p: FloatArray, k: FloatArray, w: FloatArray) -> None:
    """Tensions of the segments with the feed line, exact along the arc, less the lumped where wanted."""
    length, e = p[FEED_LENGTH], p[FEED_CHARGE]
    if e == 0.0 or length == 0.0:
        return
    foot = p[RADIUS] * p[RADIUS]
    gap = 0.0
    pull = 0.0
    for i in range(n - 1, max(-1, n - 1 - reach), -1):
        li, ai = w[LENGTH, i], w[AREA, i] / math.pi
        a2 = 0.5 * (ai + foot)
        _, by_i, _, by_g, by_a = segment_pair(y[i, CHARGE], e * length, li, length, gap, a2)
        if lumped:
            half = 0.5 * y[i, CHARGE] * e
            a = math.sqrt(a2)
            r0, r1 = math.sqrt(gap * gap + a2), math.sqrt((gap + li) ** 2 + a2)
            f0, f1 = math.sqrt((gap + length) ** 2 + a2), math.sqrt((gap + li + length) ** 2 + a2)
            by_i -= half * (1.0 / f1 - 1.0 / r1)
            by_g -= half * (1.0 / f1 - 1.0 / r1 + 1.0 / f0 - 1.0 / r0)
            # d asinh(u/a)/d(a^2) = -u/(2 a^2 sqrt(u^2 + a^2))
            slope = (gap + length) / f0 - gap / r0 + (gap + li + length) / f1 - (gap + li) / r1
            by_a += half * slope / (2.0 * a * a)
        if k[PRESSURE] == 1:
            by_i -= 0.5 * by_a * ai / li
        w[TENSION, i] += COULOMB * by_i
        gap += li
        gaps_from(i, n, by_g, w)
    return


@njit(cache=True, error_model="numpy")
def gaps_from(i: int, n: int, by_g: float, w: FloatArray) -> None:
    """A gap's derivative as a tension of every element between i and the nozzle."""
    for j in range(i + 1, n):
        w[TENSION, j] += COULOMB * by_g


@njit(cache=True, error_model="numpy")
def beads(n: int, y: FloatArray, w: FloatArray, x: FloatArray, charge: FloatArray, a2: FloatArray) -> None:
    """Positions, lumped charges and squared radii of the n + 1 nodes."""
    for i in range(n + 1):
        x[i, 0], x[i, 1], x[i, 2] = y[i, X], y[i, X + 1], y[i, X + 2]
        low, high = max(i - 1, 0), min(i, n - 1)
        charge[i] = 0.5 * ((y[i, CHARGE] if i < n else 0.0) + (y[i - 1, CHARGE] if i > 0 else 0.0))
        a2[i] = 0.5 * (w[AREA, low] + w[AREA, high]) / math.pi


@njit(cache=True, error_model="numpy")
def feed_field(
    x: float, y: float, z: float, a2: float, length: float, start: float
) -> tuple[float, float, float, float, float, float]:
    """Field, potential and its derivative with a^2 of a uniform line from `start - length` to `start` on the axis."""
    u = x - start
    rho2 = y * y + z * z + a2
    near, far = math.sqrt(u * u + rho2), math.sqrt((u + length) ** 2 + rho2)
    ex = 1.0 / near - 1.0 / far
    # (u + L)/far - u/near over rho^2, without the difference where both are near 1
    if u > 0.0:
        across = ex * (1.0 / ((u + length) / far + u / near)) * (1.0 / near + 1.0 / far)
    else:
        across = ((u + length) / far - u / near) / rho2
    level = math.asinh((u + length) / math.sqrt(rho2)) - math.asinh(u / math.sqrt(rho2))
    return ex, across * y, across * z, level, -0.5 * across, across


@njit(cache=True, error_model="numpy")
def _bead_forces(n: int, y: FloatArray, p: FloatArray, k: FloatArray, w: FloatArray, f: FloatArray) -> None:
    """Forces of all pairs of lumped charges, of the feed line and of the images."""
    m = n + 1
    x, field = np.empty((m, 3)), np.zeros((m, 3))
    charge, a2, inverse, potential = np.empty(m), np.empty(m), np.zeros(m), np.zeros(m)
    beads(n, y, w, x, charge, a2)
    if m > k[TREE]:
        tree_sum(x, a2, x, charge, a2, OPENING, field, inverse, potential)
    else:
        pair_sum(x, charge, a2, field, inverse, potential)
    length, e = p[FEED_LENGTH], p[FEED_CHARGE]
    radial = np.empty(m)
    for i in range(m):
        radial[i] = -0.25 * charge[i] * inverse[i]  # dE/da_i^2
        if e != 0.0 and length > 0.0:
            soft = 0.5 * (a2[i] + p[RADIUS] * p[RADIUS])
            ex, ey, ez, _, by_a, _ = feed_field(x[i, 0], x[i, 1], x[i, 2], soft, length, 0.0)
            field[i, 0] += e * ex
            field[i, 1] += e * ey
            field[i, 2] += e * ez
            radial[i] += 0.5 * charge[i] * e * by_a
    if k[IMAGE] == 1:
        _images(x, charge, a2, p, k, field)
    for i in range(m):
        for c in range(3):
            f[i, c] += COULOMB * charge[i] * field[i, c]
    if k[PRESSURE] == 1:
        # a_i^2 is the mean of the two elements beside a node (the end node has one)
        for i in range(n):
            share = radial[i] * (1.0 if i == 0 else 0.5) + radial[i + 1] * (1.0 if i == n - 1 else 0.5)
            w[TENSION, i] -= COULOMB * share * w[AREA, i] / (math.pi * w[LENGTH, i])


@njit(cache=True, error_model="numpy")
def _images(x: FloatArray, charge: FloatArray, a2: FloatArray, p: FloatArray, k: FloatArray, field: FloatArray) -> None:
    """Field of the mirror charges behind an earthed plate at x = gap, and of the feed line's."""
    m = charge.size
    mirrored, opposite = np.empty((m, 3)), np.empty(m)
    for i in range(m):
        mirrored[i, 0], mirrored[i, 1], mirrored[i, 2] = 2.0 * p[GAP] - x[i, 0], x[i, 1], x[i, 2]
        opposite[i] = -charge[i]
    if m > k[TREE]:
        spare, level = np.zeros(m), np.zeros(m)
        tree_sum(x, a2, mirrored, opposite, a2, OPENING, field, spare, level)
    else:
        direct_sum(x, a2, mirrored, opposite, a2, field)
    length, e = p[FEED_LENGTH], p[FEED_CHARGE]
    if e != 0.0 and length > 0.0:
        for i in range(m):
            ex, ey, ez, _, _, _ = feed_field(2.0 * p[GAP] - x[i, 0], x[i, 1], x[i, 2], a2[i], length, 0.0)
            field[i, 0] += e * ex
            field[i, 1] -= e * ey
            field[i, 2] -= e * ez
