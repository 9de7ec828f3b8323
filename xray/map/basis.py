"""Splines over the half-plane (r/R, z) of a round jet, and their chords.

The polymer fraction is ``phi(rho, z) = sum_jk c_jk b_j(rho) B_k(z)``, ``rho = r/R(z)``: cubic B-splines on evenly spaced knots,
in rho even about the axis, so that the fraction is smooth there. Roughness is the sum of squared differences of
neighbouring coefficients, of third order; across the jet they are those of the core and those of the rim, halves of
equal area, for a skin is rough where the core is not. What they let pass is ``a + b rho^2``, a and b parabolas along z.
The smoothest of n third differences is of relative size ``(5/n)^6``, lost in double precision from 150 splines on
(measured): with over 64 along z, 488 rows, the order there is two.

The chord of b_j at the distance s (in radii) from the axis is, piece by piece, that of a polynomial in rho, with
``y = sqrt(rho^2 - s^2)``::

    G_j(s) = 2 int b_j dy,   int rho^m dy = (y rho^m + m s^2 int rho^(m-2) dy)/(m+1),   int rho^(-1) dy = asinh(y/s),

and the chord averaged over a pixel from x1 to x2 ``R^2 (H_j(s2) - H_j(s1))/(x2 - x1)`` with ``H_j = int_0^s G_j ds``.
Radius and axis enter by ``s = (x - a)/R`` only, so one table of H serves all rows: cubics in ``t = sqrt(1 - |s|)``, in which
the square root at the jet's edge is smooth.

References
----------
Eilers and Marx, Statist. Sci. 11, 89 (1996).
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, CubicSpline
from scipy.linalg import eigvals_banded

from spinline.base.checks import FloatArray
from spinline.base.quadrature import gauss

__all__ = ["AxialBasis", "RadialBasis", "axial_basis", "radial_basis"]

_DEGREE = 3
_ORDER = 3  # of the differences
_MOST_OF_THIRD_ORDER = 64  # splines along z
_CELLS = 512  # of the table
_NODES, _SHARES = gauss(6)


@dataclass(frozen=True, eq=False)
class RadialBasis:
    """Even cubic B-splines in rho = r/R on [0, 1].

    Attributes
    ----------
    size : int
    table : ndarray, shape (cells, 4, size)
        H_j as cubics in ``t*cells - cell``, lowest power first.
    area : ndarray, shape (size,)
        Mean of each over the cross-section, ``int 2 rho b_j drho``.
    differences : ndarray, shape (n, size)
        D.
    shares : ndarray, shape (2, n)
        1 where a difference belongs to the core, or to the rim, and 0 elsewhere.
    penalties : ndarray, shape (2, size, size)
        ``D^T diag(share) D``.
    """

    size: int
    table: FloatArray
    area: FloatArray
    differences: FloatArray
    shares: FloatArray
    penalties: FloatArray

    def __call__(self, rho: FloatArray) -> FloatArray:
        """Values at rho in [0, 1], one more axis of length `size`."""
        full = _splines(self.size - 2)
        flat = np.ravel(rho)
        dense = BSpline.design_matrix(flat, full.t, _DEGREE).toarray()
        values: FloatArray = (dense @ _fold(self.size - 2)).reshape(*np.shape(rho), self.size)
        return values

    def shells(self, edges: FloatArray) -> FloatArray:
        """Means over shells with these edges r/R, shape (shells, size)."""
        at = np.union1d(edges, np.linspace(0.0, 1.0, self.size - 1))
        half = 0.5 * np.diff(at)[:, None]
        rho = at[:-1, None] + half * (1.0 + _NODES)
        parts = np.einsum("ig,igj->ij", 2.0 * half * rho * _SHARES, self(rho))
        total = np.add.reduceat(parts, np.searchsorted(at, edges[:-1]), axis=0)
        value: FloatArray = total / np.diff(edges**2)[:, None]
        return value


@dataclass(frozen=True, eq=False)
class AxialBasis:
    """B-splines along z at the rows' places.

    Attributes
    ----------
    size, degree : int
    first : ndarray of int, shape (rows,)
        The first of the ``degree + 1`` splines that a row touches.
    values : ndarray, shape (rows, degree + 1)
    order : int
        Of the differences: 3, 2 with over 64 splines.
    penalty : ndarray, shape (size, degree + 1)
        ``D^T D`` by diagonals: column d holds elements (k, k + d).
    roughness : ndarray, shape (size,)
        Eigenvalues; the first `order` are 0.
    """

    size: int
    degree: int
    first: NDArray[np.int64]
    values: FloatArray
    order: int
    penalty: FloatArray
    roughness: FloatArray

    def along(self, coefficients: FloatArray) -> FloatArray:
        """Curves at the rows, shape (rows, n), of coefficients of shape (size, n)."""
        out = self.values[:, :1] * coefficients[self.first]
        for d in range(1, self.degree + 1):
            out += self.values[:, d : d + 1] * coefficients[self.first + d]
        return out

    def quadratic(self, coefficients: FloatArray) -> FloatArray:
        """Roughness ``c^T D^T D c`` of each column."""
        return np.asarray((np.diff(coefficients, self.order, axis=0) ** 2).sum(axis=0))


@lru_cache(maxsize=8)
def radial_basis(size: int) -> RadialBasis:
    """Basis of `size` >= 4 splines; 10 ms the first time."""
    pieces, fold = size - 2, _fold(size - 2)
    differences = (
        np.sqrt(0.5) * np.diff(np.eye(2 * pieces + 3), _ORDER, axis=0) @ fold
    )  # both halves of the jet count once
    place = np.abs(np.arange(2 * pieces) - pieces + 0.5) / pieces
    rim = (place**2 > 0.5).astype(np.float64)
    shares = np.stack((1.0 - rim, rim))
    penalties = np.einsum("qd,di,dj->qij", shares, differences, differences)
    basis = RadialBasis(size, _table(pieces), np.zeros(size), differences, shares, penalties)
    object.__setattr__(basis, "area", basis.shells(np.array([0.0, 1.0]))[0])
    return basis


def axial_basis(z: FloatArray, size: int) -> AxialBasis:
    """Basis of `size` splines for rows at rising z; cubic where there are 4 or more."""
    degree = min(_DEGREE, size - 1)
    order = min(_ORDER if size <= _MOST_OF_THIRD_ORDER else 2, size - 1)
    low, high = (float(z[0]), float(z[-1])) if z.size > 1 else (float(z[0]), float(z[0]) + 1.0)
    knots = low + (high - low) * (np.arange(-degree, size + 1) / (size - degree))
    # at the last knot the rows' own end, to rounding
    inside = np.clip(z, knots[degree], knots[size])
    matrix = BSpline.design_matrix(inside, knots, degree)
    values = np.asarray(matrix.data).reshape(z.size, degree + 1)
    first = np.asarray(matrix.indices).reshape(z.size, degree + 1)[:, 0].astype(np.int64)
    penalty = np.zeros((size, degree + 1))
    if order:
        stencil = np.diff(np.eye(order + 1), order, axis=0)[0]
        for row in range(size - order):
            for i in range(order + 1):
                penalty[row + i, : order + 1 - i] += stencil[i] * stencil[i:]
        roughness = np.abs(eigvals_banded(penalty[:, : order + 1].T, lower=True))
        roughness[:order] = 0.0
    else:
        roughness = np.zeros(size)
    return AxialBasis(size, degree, first, values, order, penalty, roughness)


def _splines(pieces: int) -> BSpline:
    """All B-splines of `pieces` even intervals on [0, 1] and as many on [-1, 0]."""
    knots = np.arange(-pieces - _DEGREE, pieces + _DEGREE + 1) / pieces
    return BSpline(knots, np.eye(2 * pieces + _DEGREE), _DEGREE)


def _fold(pieces: int) -> FloatArray:
    """Sums of mirror images, shape (2 pieces + 3, pieces + 2)."""
    middle = pieces + 1
    fold = np.zeros((2 * pieces + 3, pieces + 2))
    at = np.arange(pieces + 2)
    fold[middle + at, at] = 1.0
    fold[middle - at, at] = 1.0
    return fold


def _table(pieces: int) -> FloatArray:
    start = np.arange(pieces) / pieces
    cubic = BSpline(_splines(pieces).t, _fold(pieces), _DEGREE)
    local = [cubic(start, nu=m) / math.factorial(m) for m in range(4)]  # powers of rho - start, lowest first
    k = start[:, None]
    power = np.stack(
        (
            local[0] - k * local[1] + k**2 * local[2] - k**3 * local[3],
            local[1] - 2 * k * local[2] + 3 * k**2 * local[3],
            local[2] - 3 * k * local[3],
            local[3],
        )
    )

    def chords(s: FloatArray) -> FloatArray:
        edges = np.arange(pieces + 1) / pieces
        rho = np.maximum(edges, s[:, None])
        y = np.sqrt((rho - s[:, None]) * (rho + s[:, None]))
        square = (s**2)[:, None]
        first = 0.5 * (y * rho + square * np.arcsinh(y / np.maximum(s, 1e-150)[:, None]))
        integrals = (y, first, (y * rho**2 + 2 * square * y) / 3, 0.25 * (y * rho**3 + 3 * square * first))
        total = sum(np.diff(part, axis=1) @ power[m] for m, part in enumerate(integrals))
        return np.asarray(2.0 * total)

    t = np.linspace(0.0, 1.0, _CELLS + 1)
    half = 0.5 / _CELLS
    nodes = (t[:-1, None] + half * (1.0 + _NODES)).ravel()
    cells = (chords(1.0 - nodes**2) * (2.0 * nodes)[:, None]).reshape(_CELLS, _NODES.size, -1)
    area = np.einsum("cgj,g->cj", cells, half * _SHARES)
    h = np.zeros((t.size, area.shape[1]))
    h[:-1] = np.cumsum(area[::-1], axis=0)[::-1]
    slope = -2.0 * chords(np.zeros(1))[0]
    spline = CubicSpline(t, h, bc_type=((1, np.zeros_like(slope)), (1, slope)))
    scale = (1.0 / _CELLS) ** np.arange(4)
    return np.ascontiguousarray((spline.c[::-1] * scale[:, None, None]).transpose(1, 0, 2))
