"""Sums over softened charges, compiled: all pairs, or a binary tree over the order along the thread.

Beside the field, the sum ``sum_j Q_j/(d^2 + a^2)^(3/2)`` is returned: the derivative of the energy with the beads' radii.
A cluster is taken as a monopole and a quadrupole about its centre of charge where ``radius < opening * distance``.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["direct_sum", "pair_sum", "tree_sum"]

_LEAF = 32


@njit(cache=True, error_model="numpy")
def pair_sum(
    x: FloatArray, charge: FloatArray, a2: FloatArray, field: FloatArray, inverse: FloatArray, potential: FloatArray
) -> None:
    """All pairs of one set, each once: `field` (m, 3), `inverse` and `potential` (m,) are added to."""
    m = charge.size
    for i in range(m):
        xi, yi, zi, qi, ai = x[i, 0], x[i, 1], x[i, 2], charge[i], a2[i]
        fx = fy = fz = wi = ui = 0.0
        for j in range(i):
            dx, dy, dz = xi - x[j, 0], yi - x[j, 1], zi - x[j, 2]
            one = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz + 0.5 * (ai + a2[j]))
            cube = one * one * one
            qj = charge[j]
            sj, si = qj * cube, qi * cube
            fx += dx * sj
            fy += dy * sj
            fz += dz * sj
            wi += sj
            ui += qj * one
            field[j, 0] -= dx * si
            field[j, 1] -= dy * si
            field[j, 2] -= dz * si
            inverse[j] += si
            potential[j] += qi * one
        field[i, 0] += fx
        field[i, 1] += fy
        field[i, 2] += fz
        inverse[i] += wi
        potential[i] += ui


@njit(cache=True, error_model="numpy")
def direct_sum(
    target: FloatArray, target_a2: FloatArray, x: FloatArray, charge: FloatArray, a2: FloatArray, field: FloatArray
) -> None:
    """Field of one set of charges at the points of another (images)."""
    for i in range(target_a2.size):
        fx = fy = fz = 0.0
        for j in range(charge.size):
            dx, dy, dz = target[i, 0] - x[j, 0], target[i, 1] - x[j, 1], target[i, 2] - x[j, 2]
            one = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz + 0.5 * (target_a2[i] + a2[j]))
            s = charge[j] * one * one * one
            fx += dx * s
            fy += dy * s
            fz += dz * s
        field[i, 0] += fx
        field[i, 1] += fy
        field[i, 2] += fz


@njit(cache=True, error_model="numpy")
def _build(x: FloatArray, charge: FloatArray, a2: FloatArray, bounds: np.ndarray, node: FloatArray) -> int:
    """Tree nodes, children at 2k + 1 and 2k + 2: charge, centre (3), radius, a^2, traceless quadrupole (6)."""
    m = charge.size
    bounds[0, 0], bounds[0, 1] = 0, m
    last = 0
    for k in range(bounds.shape[0]):
        low, high = bounds[k, 0], bounds[k, 1]
        if high <= low:
            continue
        last = k
        q = cx = cy = cz = soft = 0.0
        for j in range(low, high):
            s = abs(charge[j])
            q += s
            cx += s * x[j, 0]
            cy += s * x[j, 1]
            cz += s * x[j, 2]
            soft += s * a2[j]
        if q > 0.0:
            cx, cy, cz, soft = cx / q, cy / q, cz / q, soft / q
        node[k, 0:12] = 0.0
        node[k, 1], node[k, 2], node[k, 3], node[k, 5] = cx, cy, cz, soft
        far = 0.0
        for j in range(low, high):
            dx, dy, dz, s = x[j, 0] - cx, x[j, 1] - cy, x[j, 2] - cz, charge[j]
            d2 = dx * dx + dy * dy + dz * dz
            far = max(far, d2)
            node[k, 0] += s
            node[k, 6] += s * (3 * dx * dx - d2)
            node[k, 7] += s * (3 * dy * dy - d2)
            node[k, 8] += s * (3 * dz * dz - d2)
            node[k, 9] += s * 3 * dx * dy
            node[k, 10] += s * 3 * dx * dz
            node[k, 11] += s * 3 * dy * dz
        node[k, 4] = math.sqrt(far)
        if high - low > _LEAF and 2 * k + 2 < bounds.shape[0]:
            mid = (low + high) // 2
            bounds[2 * k + 1, 0], bounds[2 * k + 1, 1] = low, mid
            bounds[2 * k + 2, 0], bounds[2 * k + 2, 1] = mid, high
    return last


@njit(cache=True, error_model="numpy")
def tree_sum(
    target: FloatArray,
    target_a2: FloatArray,
    x: FloatArray,
    charge: FloatArray,
    a2: FloatArray,
    opening: float,
    field: FloatArray,
    inverse: FloatArray,
    potential: FloatArray,
) -> None:
    """Field, inverse cubes and potential at `target` of the charges at `x`; a charge does not act on its own place."""
    m = charge.size
    depth = 1
    while m > _LEAF * (1 << (depth - 1)):
        depth += 1
    size = (1 << (depth + 1)) - 1
    bounds = np.zeros((size, 2), dtype=np.int64)
    node = np.zeros((size, 12))
    _build(x, charge, a2, bounds, node)
    stack = np.empty(4 * depth + 8, dtype=np.int64)
    out = np.empty(5)
    for i in range(target_a2.size):
        _visit(target[i, 0], target[i, 1], target[i, 2], target_a2[i], x, charge, a2, opening, bounds, node, stack, out)
        field[i, 0] += out[0]
        field[i, 1] += out[1]
        field[i, 2] += out[2]
        inverse[i] += out[3]
        potential[i] += out[4]


@njit(cache=True, error_model="numpy")
def _visit(
    px: float,
    py: float,
    pz: float,
    soft: float,
    x: FloatArray,
    charge: FloatArray,
    a2: FloatArray,
    opening: float,
    bounds: np.ndarray,
    node: FloatArray,
    stack: np.ndarray,
    out: FloatArray,
) -> None:
    """Walk the tree for one point."""
    fx = fy = fz = cubes = level = 0.0
    stack[0], top = 0, 1
    while top > 0:
        top -= 1
        k = stack[top]
        low, high = bounds[k, 0], bounds[k, 1]
        dx, dy, dz = px - node[k, 1], py - node[k, 2], pz - node[k, 3]
        d2 = dx * dx + dy * dy + dz * dz
        leaf = high - low <= _LEAF or 2 * k + 2 >= bounds.shape[0]
        if not leaf and node[k, 4] * node[k, 4] >= opening * opening * d2:
            stack[top], stack[top + 1] = 2 * k + 1, 2 * k + 2
            top += 2
            continue
        if (leaf and node[k, 4] * node[k, 4] >= opening * opening * d2) or high - low <= 8:
            for j in range(low, high):
                ex, ey, ez = px - x[j, 0], py - x[j, 1], pz - x[j, 2]
                e2 = ex * ex + ey * ey + ez * ez
                if e2 == 0.0:
                    continue
                one = 1.0 / math.sqrt(e2 + 0.5 * (soft + a2[j]))
                s = charge[j] * one * one * one
                fx += ex * s
                fy += ey * s
                fz += ez * s
                cubes += s
                level += charge[j] * one
            continue
        one = 1.0 / math.sqrt(d2 + 0.5 * (soft + node[k, 5]))
        one2 = one * one
        one3 = one * one2
        q = node[k, 0]
        qx = node[k, 6] * dx + node[k, 9] * dy + node[k, 10] * dz
        qy = node[k, 9] * dx + node[k, 7] * dy + node[k, 11] * dz
        qz = node[k, 10] * dx + node[k, 11] * dy + node[k, 8] * dz
        dqd = dx * qx + dy * qy + dz * qz
        one5 = one3 * one2
        s = q * one3 + 2.5 * dqd * one5 * one2
        fx += dx * s - qx * one5
        fy += dy * s - qy * one5
        fz += dz * s - qz * one5
        cubes += q * one3
        level += q * one + 0.5 * dqd * one5
    out[0], out[1], out[2], out[3], out[4] = fx, fy, fz, cubes, level
