"""Mirror charges behind an earthed plate at x = gap, compiled: of the elements' charges, each at its element's middle.

An element and its own mirror are as far apart as it is long, at least: it is a line, not a point, and less than its own
potential is taken from it, so that the matrix of potentials stays positive where the jet lands.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AREA,
    CHARGE,
    COUPLING,
    FEED_COUNT,
    FEED_FIRST,
    GAP,
    IMAGE,
    LENGTH,
    RADIUS,
    SHARE,
    TREE,
    IntArray,
    X,
)
from spinline.jetprofile.spun._line_kernels import feed_field
from spinline.jetprofile.spun._tree_kernels import direct_sum, tree_sum

__all__ = ["OPENING", "middles", "mirror_forces", "mirror_kernel", "mirror_level"]

OPENING = 0.3


@njit(cache=True, error_model="numpy")
def middles(n: int, y: FloatArray, w: FloatArray, x: FloatArray, a2: FloatArray) -> None:
    """Middles of the n elements and their squared radii."""
    for i in range(n):
        for c in range(3):
            x[i, c] = 0.5 * (y[i, X + c] + y[i + 1, X + c])
        a2[i] = w[AREA, i] / math.pi


@njit(cache=True, error_model="numpy")
def mirror_kernel(a: int, b: int, x: FloatArray, a2: FloatArray, p: FloatArray, w: FloatArray) -> float:
    """What the plate takes from the potential of element a per charge of element b, times 4 pi eps0."""
    dy, dz = x[a, 1] - x[b, 1], x[a, 2] - x[b, 2]
    far = 2.0 * p[GAP] - x[a, 0] - x[b, 0]
    soft = dy * dy + dz * dz + 0.5 * (a2[a] + a2[b]) + (w[LENGTH, a] ** 2 if a == b else 0.0)
    value: float = 1.0 / math.sqrt(far * far + soft)
    return value


@njit(cache=True, error_model="numpy")
def mirror_forces(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, f: FloatArray) -> None:
    """Add the forces of the mirror charges: the chain's and the feed's."""
    if k[IMAGE] == 0:
        return
    x, a2, q = np.empty((n, 3)), np.empty(n), np.empty(n)
    field, level = np.zeros((n, 3)), np.zeros(n)
    middles(n, y, w, x, a2)
    for i in range(n):
        q[i] = y[i, CHARGE] * w[SHARE, i]
    _answer(x, q, a2, n + 1 > k[TREE], p, w, field, level)
    for line in range(int(p[FEED_COUNT])):
        length, e = p[FEED_FIRST + 2 * line], p[FEED_FIRST + 2 * line + 1]
        for i in range(n):
            soft = 0.5 * (a2[i] + p[RADIUS] * p[RADIUS])
            dy, dz = x[i, 1] - y[n, X + 1], x[i, 2] - y[n, X + 2]
            ex, ey, ez, _, _, _ = feed_field(2.0 * p[GAP] - x[i, 0], dy, dz, soft, length, 0.0)
            field[i, 0] += e * ex
            field[i, 1] -= e * ey
            field[i, 2] -= e * ez
    for i in range(n):
        for c in range(3):
            half = 0.5 * p[COUPLING] * q[i] * field[i, c]
            f[i, c] += half
            f[i + 1, c] += half


@njit(cache=True, error_model="numpy")
def mirror_level(
    x: FloatArray, q: FloatArray, a2: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, level: FloatArray
) -> None:
    """Potential of the elements' mirror charges, times 4 pi eps0, added to `level`."""
    if k[IMAGE] == 1:
        _answer(x, q, a2, True, p, w, np.zeros((q.size, 3)), level)


@njit(cache=True, error_model="numpy")
def _answer(
    x: FloatArray,
    q: FloatArray,
    a2: FloatArray,
    tree: bool,
    p: FloatArray,
    w: FloatArray,
    field: FloatArray,
    level: FloatArray,
) -> None:
    m = q.size
    mirrored, opposite = x.copy(), -q
    for i in range(m):
        mirrored[i, 0] = 2.0 * p[GAP] - x[i, 0]
    if tree:
        tree_sum(x, a2, mirrored, opposite, a2, OPENING, field, np.zeros(m), level)
    else:  # the level is of no interest then
        direct_sum(x, a2, mirrored, opposite, a2, field)
    for i in range(m):
        far = 2.0 * (p[GAP] - x[i, 0])
        point = far * far + a2[i]
        long2 = point + w[LENGTH, i] ** 2
        field[i, 0] += q[i] * far * (1.0 / (long2 * math.sqrt(long2)) - 1.0 / (point * math.sqrt(point)))
        if far != 0.0:  # the tree leaves out what lies in the same place
            level[i] += q[i] / math.sqrt(point)
        level[i] -= q[i] / math.sqrt(long2)
