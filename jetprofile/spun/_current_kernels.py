"""Node currents of a charge that every other sees, compiled: ``(R + g h B P B^T) I = right``, symmetric and positive.

Short chains: Cholesky. Longer ones: conjugate gradients, preconditioned by the same matrix with P cut to a band of `WIDTH`
whose weights fall as ``1 - |i - j|/(WIDTH + 1)``, which keeps it positive; P is a matrix up to `DENSE` elements and the tree's
sum above. The node currents run towards the front; ``q_i = known_i + g h (I_(i+1) - I_i)``.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import CURRENT, EXACT, NEAR, REPULSION, IntArray
from spinline.jetprofile.spun._coulomb_kernels import beads
from spinline.jetprofile.spun._potential_kernels import far_band, level, near_band, outer_level, potential_matrix

__all__ = ["currents"]

DIRECT = 48  # up to here the matrix is factored
DENSE = 1500  # up to here P is a matrix
WIDTH = 16
ITERATIONS = 200
CLOSE = 1e-9


@njit(cache=True, error_model="numpy")
def currents(
    n: int,
    gh: float,
    front: float,
    earthed: bool,
    given: bool,
    known: FloatArray,
    resist: FloatArray,
    drive: FloatArray,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
) -> FloatArray:
    """All n + 1 node currents; NaN where the iteration does not close.

    `front`: the current at the front where that is not `earthed`; `given`: the current at the nozzle is p[CURRENT].
    """
    first, last = (0 if earthed else 1), (n - 1 if given else n)
    out = np.zeros(n + 1)
    if not earthed:
        out[0] = front
    if given:
        out[n] = p[CURRENT]
    start = known.copy()
    for i in range(n):
        start[i] += gh * (out[i + 1] - out[i])
    dense = n <= DENSE or k[REPULSION] == EXACT
    reach = n if k[REPULSION] == EXACT else k[NEAR]
    x, charge, a2 = np.empty((n + 1, 3)), np.empty(n + 1), np.empty(n + 1)
    beads(n, y, w, x, charge, a2)
    size = n if dense else 0
    matrix, psi = np.zeros((size, size)), np.zeros(n)
    near = np.zeros((1, 1)) if dense else np.zeros((n, reach + 1))
    if dense:
        potential_matrix(n, y, p, k, tables, w, matrix, psi)
        psi += np.dot(matrix, start)
    else:
        near_band(n, reach, 0, a2, p, k, w, near)
        level(n, reach, start, y, x, a2, near, p, k, tables, w, psi)
        outer_level(n, y, p, k, tables, w, a2, psi)
    right = np.empty(last - first + 1)
    for j in range(first, last + 1):
        right[j - first] = drive[j] - (psi[j - 1] if j > 0 else 0.0) + (psi[j] if j < n else 0.0)
    if n <= DIRECT or k[REPULSION] == EXACT:
        solved = _direct(n, gh, first, last, resist, matrix, right)
        for j in range(first, last + 1):
            out[j] = solved[j - first]
        return out
    band = np.zeros((n, WIDTH + 1))
    if dense:
        for i in range(n):
            for d in range(min(WIDTH, n - 1 - i) + 1):
                band[i, d] = matrix[i, i + d]
    else:
        far_band(n, WIDTH, reach, y, x, a2, p, k, w, near, band)
    factor = _banded(n, gh, first, last, resist, band)
    solved = _gradients(
        n, gh, first, last, resist, factor, right, dense, matrix, reach, y, x, a2, near, p, k, tables, w
    )
    for j in range(first, last + 1):
        out[j] = solved[j - first]
    return out


@njit(cache=True, error_model="numpy")
def _entry(j: int, m: int, n: int, matrix: FloatArray) -> float:
    """(B P B^T) of nodes j and m."""
    value = 0.0
    if j > 0 and m > 0:
        value += matrix[j - 1, m - 1]
    if j < n and m > 0:
        value -= matrix[j, m - 1]
    if j > 0 and m < n:
        value -= matrix[j - 1, m]
    if j < n and m < n:
        value += matrix[j, m]
    return value


@njit(cache=True, error_model="numpy")
def _direct(
    n: int, gh: float, first: int, last: int, resist: FloatArray, matrix: FloatArray, right: FloatArray
) -> FloatArray:
    size = last - first + 1
    system = np.empty((size, size))
    for a in range(size):
        for b in range(size):
            system[a, b] = gh * _entry(a + first, b + first, n, matrix)
        system[a, a] += resist[a + first]
    for a in range(size):  # Cholesky, in place
        for b in range(a + 1):
            total = system[a, b]
            for c in range(b):
                total -= system[a, c] * system[b, c]
            system[a, b] = math.sqrt(total) if a == b else total / system[b, b]
    found = right.copy()
    for a in range(size):
        for c in range(a):
            found[a] -= system[a, c] * found[c]
        found[a] /= system[a, a]
    for a in range(size - 1, -1, -1):
        for c in range(a + 1, size):
            found[a] -= system[c, a] * found[c]
        found[a] /= system[a, a]
    return found


@njit(cache=True, error_model="numpy")
def _banded(n: int, gh: float, first: int, last: int, resist: FloatArray, band: FloatArray) -> FloatArray:
    """Cholesky factor of ``R + g h B P' B^T`` with P' the weighted band: `factor[a, d]` for row a and column a - d."""
    size, wide = last - first + 1, WIDTH + 1
    factor = np.zeros((size, wide + 1))
    for a in range(size):
        j = a + first
        for d in range(min(a, wide) + 1):
            m = j - d
            value = resist[j] if d == 0 else 0.0
            for u in range(2):
                for v in range(2):
                    i, o = j - u, m - v
                    apart = abs(i - o)
                    if i < 0 or o < 0 or i >= n or o >= n or apart > WIDTH:
                        continue
                    sign = 1.0 if u == v else -1.0
                    value += gh * sign * band[min(i, o), apart] * (1.0 - apart / (WIDTH + 1.0))
            factor[a, d] = value
    for a in range(size):
        for d in range(min(a, wide), -1, -1):
            b = a - d
            total = given = factor[a, d]
            for c in range(max(0, a - wide, b - wide), b):
                total -= factor[a, a - c] * factor[b, b - c]
            factor[a, d] = math.sqrt(max(total, 1e-3 * abs(given), 1e-300)) if d == 0 else total / factor[b, 0]
    return factor


@njit(cache=True, error_model="numpy")
def _divide(factor: FloatArray, right: FloatArray, out: FloatArray) -> None:
    """Solve with the banded factor."""
    size, wide = factor.shape[0], factor.shape[1] - 1
    for a in range(size):
        total = right[a]
        for d in range(1, min(a, wide) + 1):
            total -= factor[a, d] * out[a - d]
        out[a] = total / factor[a, 0]
    for a in range(size - 1, -1, -1):
        total = out[a]
        for d in range(1, min(size - 1 - a, wide) + 1):
            total -= factor[a + d, d] * out[a + d]
        out[a] = total / factor[a, 0]


@njit(cache=True, error_model="numpy")
def _gradients(
    n: int,
    gh: float,
    first: int,
    last: int,
    resist: FloatArray,
    factor: FloatArray,
    right: FloatArray,
    dense: bool,
    matrix: FloatArray,
    reach: int,
    y: FloatArray,
    x: FloatArray,
    a2: FloatArray,
    near: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
) -> FloatArray:
    """Conjugate gradients (Polak-Ribiere form: the tree's sum is symmetric only to its error)."""
    size = right.size
    found, rest, go, to, made = np.zeros(size), right.copy(), np.zeros(size), np.zeros(size), np.zeros(size)
    q, psi, before = np.zeros(n), np.zeros(n), np.zeros(size)
    _divide(factor, rest, go)
    product = np.dot(rest, go)
    least = CLOSE * CLOSE * product if dense else 1e-10 * product
    for a in range(size):
        to[a] = go[a]
    for _ in range(ITERATIONS):
        if not product > least or product == 0.0:
            return found
        for i in range(n):
            ahead, behind = i - first, i + 1 - first
            q[i] = gh * ((to[behind] if 0 <= behind < size else 0.0) - (to[ahead] if 0 <= ahead < size else 0.0))
        if dense:
            psi = np.dot(matrix, q)
        else:
            level(n, reach, q, y, x, a2, near, p, k, tables, w, psi)
        for a in range(size):
            j = a + first
            made[a] = resist[j] * to[a] + (psi[j - 1] if j > 0 else 0.0) - (psi[j] if j < n else 0.0)
        grip = np.dot(to, made)
        if not grip > 0.0:  # not positive: the elements are too short for their radius
            break
        step = product / grip
        for a in range(size):
            before[a] = rest[a]
            found[a] += step * to[a]
            rest[a] -= step * made[a]
        _divide(factor, rest, go)
        turn = (np.dot(rest, go) - np.dot(before, go)) / product
        product = np.dot(rest, go)
        for a in range(size):
            to[a] = go[a] + turn * to[a]
    found[:] = np.nan
    return found
