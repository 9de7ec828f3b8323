"""Force of the cone's own edge, compiled: what an element gains as it moves out of the local logarithm's reach.

Over the cone the charge's potential goes from the local logarithm to the whole thread's by a share S(x) of the element's
place: ``U = sum_(i<j) S_i S_j q_i q_j H_ij + sum_i q_i^2 [S_i^2 H_ii + (1 - S_i^2) L_i]/2``. So moving it costs
``dU/dS_i S'(x) = q_i (sum_j H_ij S_j q_j - S_i q_i L_i) S'(x)``: the pull of the field that drives the current there, without
which a straight jet from a needle lacks a twentieth of its tension.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    CHARGE,
    CONE,
    COUPLING,
    EXACT,
    IMAGE,
    NEAR,
    NEEDLE_AT,
    REPULSION,
    SETTLED,
    SHARE,
    IntArray,
    X,
)
from spinline.jetprofile.spun._coulomb_kernels import beads
from spinline.jetprofile.spun._mirror_kernels import middles, mirror_kernel
from spinline.jetprofile.spun._needle_kernels import needle_level
from spinline.jetprofile.spun._nozzle_kernels import smooth
from spinline.jetprofile.spun._potential_kernels import bare_outer, log_level, near_band

__all__ = ["cone_forces"]


@njit(cache=True, error_model="numpy")
def cone_forces(
    n: int, y: FloatArray, p: FloatArray, k: IntArray, tables: FloatArray, w: FloatArray, f: FloatArray
) -> None:
    """Adds the forces of the share's change with place, on both ends of an element alike."""
    if p[CONE] == 0.0:
        return
    slope, low = np.zeros(n), n
    for i in range(n):
        _, slope[i] = smooth(0.5 * (y[i, X] + y[i + 1, X]) - p[NEEDLE_AT], p[CONE])
        if slope[i] > 0.0:
            low = min(low, i)
    level = _whole_level(n, low, slope, y, p, k, tables, w)
    for i in range(low, n):
        if slope[i] > 0.0:
            rise = level[i] - w[SHARE, i] * y[i, CHARGE] * log_level(i, p, w)
            half = -0.5 * p[SETTLED] * slope[i] * y[i, CHARGE] * rise
            f[i, 0] += half
            f[i + 1, 0] += half


@njit(cache=True, error_model="numpy")
def _whole_level(
    n: int, low: int, slope: FloatArray, y: FloatArray, p: FloatArray, k: IntArray, tables: FloatArray, w: FloatArray
) -> FloatArray:
    """Potential of the whole thread's charge at the elements from `low` on that have a slope."""
    exact = k[REPULSION] == EXACT
    reach = n if exact else k[NEAR]
    x, charge, a2 = np.empty((n + 1, 3)), np.empty(n + 1), np.empty(n + 1)
    beads(n, y, w, x, charge, a2)
    near, level = np.zeros((n, reach + 1)), np.zeros(n)
    bare_outer(n, y, p, k, tables, w, a2, level)
    near_band(n, reach, max(low - reach, 0), a2, p, k, w, near)
    own = y[:n, CHARGE] * w[SHARE, :n]
    xm, am, answer = np.empty((n, 3)), np.empty(n), np.zeros(n)
    middles(n, y, w, xm, am)
    if not exact:
        needle_level(xm, own, False, n, y, p, tables, answer)
    for i in range(low, n):
        if slope[i] == 0.0:
            continue
        total = near[i, 0] * own[i] + p[COUPLING] * answer[i]
        for d in range(1, reach + 1):
            if i + d < n:
                total += near[i, d] * own[i + d]
            if i - d >= 0:
                total += near[i - d, d] * own[i - d]
        if not exact:
            for j in range(n + 1):
                total += 0.5 * p[COUPLING] * charge[j] * (_bead(i, j, x, a2) + _bead(i + 1, j, x, a2))
            if k[IMAGE] == 1:
                for j in range(n):
                    total -= p[COUPLING] * mirror_kernel(i, j, xm, am, p, w) * own[j]
        level[i] += total
    return level


@njit(cache=True, error_model="numpy")
def _bead(a: int, b: int, x: FloatArray, a2: FloatArray) -> float:
    """1/distance of two softened nodes; 0 for a node and itself."""
    if a == b:
        return 0.0
    dx, dy, dz = x[a, 0] - x[b, 0], x[a, 1] - x[b, 1], x[a, 2] - x[b, 2]
    value: float = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz + 0.5 * (a2[a] + a2[b]))
    return value
