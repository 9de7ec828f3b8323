"""Equations of a map: a row touches four neighbouring splines along z, so the matrix is a narrow band of small blocks.

Blocks of as many splines as the degree make it block tridiagonal, with diagonal blocks D and lower ones O. Elimination
``D_(s+1) <- D_(s+1) - C_s O_s^T``, ``C_s = O_s D_s^-1`` solves it, and from the far end

    V_ss = D_s^-1 + C_s^T V_(s+1,s+1) C_s,   V_(s+1,s) = -V_(s+1,s+1) C_s

gives that part of the inverse which the band covers (Takahashi), all that variances at the rows need. Both cost time and
memory in proportion to the rows.

References
----------
Takahashi, Fagan and Chin, 8th PICA Conf. Proc., 63 (1973).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.xray.map.basis import AxialBasis

__all__ = ["Factor", "assembled", "factorised"]


@njit(cache=True, error_model="numpy", nogil=True)
def _assemble(
    first: NDArray[np.int64],
    values: FloatArray,
    fisher: FloatArray,
    gradient: FloatArray,
    matrix: FloatArray,
    right: FloatArray,
) -> None:
    rows, touched = values.shape
    width = fisher.shape[1]
    for i in range(rows):
        for a in range(touched):
            k = first[i] + a
            for p in range(gradient.shape[1]):
                right[k, p] += values[i, a] * gradient[i, p]
            for d in range(touched - a):
                w = values[i, a] * values[i, a + d]
                for p in range(width):
                    for q in range(width):
                        matrix[k, d, p, q] += w * fisher[i, p, q]


@njit(cache=True, error_model="numpy", nogil=True)
def _invert(a: FloatArray) -> float:
    """Invert a positive definite matrix in place by sweeps; return the logarithm of its determinant, NaN if it is not one."""
    n = a.shape[0]
    log_determinant = 0.0
    for k in range(n):
        pivot = a[k, k]
        if not pivot > 1e-14:
            return np.nan
        log_determinant += np.log(pivot)
        top = a[k]
        for j in range(n):
            top[j] /= pivot
        for i in range(n):
            if i != k:
                row = a[i]
                factor = row[k]
                for j in range(n):
                    row[j] -= factor * top[j]
                row[k] = -factor / pivot
        top[k] = 1.0 / pivot
    for i in range(n):
        for j in range(i):
            a[i, j] = a[j, i] = 0.5 * (a[i, j] + a[j, i])
    return log_determinant


@njit(cache=True, error_model="numpy", nogil=True)
def _eliminate(diagonal: FloatArray, lower: FloatArray, links: FloatArray) -> float:
    """Turn D_s into inverses and fill the links; return the logarithm of the determinant.

    By hand: libraries start threads for blocks of this size, which costs a hundred times what it saves.
    """
    total, less = 0.0, np.empty(diagonal.shape[1:])
    for s in range(diagonal.shape[0]):
        block = diagonal[s]
        if s:
            np.dot(links[s - 1], lower[s - 1].T, less)
            for i in range(block.shape[0]):
                for j in range(block.shape[1]):
                    block[i, j] -= less[i, j]
        total += _invert(block)
        if s + 1 < diagonal.shape[0]:
            np.dot(lower[s], block, links[s])
    return total


def assembled(basis: AxialBasis, fisher: FloatArray, gradient: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sum the rows' matrices, shape (rows, n, n), and slopes, (rows, n), over the splines along z.

    Returns
    -------
    matrix : ndarray, shape (splines, degree + 1, n, n)
        Element [k, d] is the block (k, k + d), itself symmetric.
    right : ndarray, shape (splines, n)
    """
    width = gradient.shape[1]
    matrix = np.zeros((basis.size, basis.degree + 1, width, width))
    right = np.zeros((basis.size, width))
    _assemble(basis.first, basis.values, fisher, np.ascontiguousarray(gradient), matrix, right)
    return matrix, right


@dataclass(frozen=True, eq=False)
class Factor:
    """Elimination of a band.

    Attributes
    ----------
    inverses, links : ndarray, shapes (blocks, m, m) and (blocks - 1, m, m)
        ``D_s^-1`` and ``C_s`` of the matrix scaled to unit diagonal.
    scale : ndarray, shape (splines, n)
        Square roots of the diagonal.
    degree : int
    log_determinant : float
    """

    inverses: FloatArray
    links: FloatArray
    scale: FloatArray
    degree: int
    log_determinant: float

    def solve(self, right: FloatArray) -> FloatArray:
        """Solution for a right side of shape (splines, n)."""
        blocks = self.inverses.shape[0]
        x = self._cut(right / self.scale)
        for s in range(1, blocks):
            x[s] -= self.links[s - 1] @ x[s - 1]
        x = np.einsum("sij,sj->si", self.inverses, x)
        for s in range(blocks - 2, -1, -1):
            x[s] -= self.links[s].T @ x[s + 1]
        return self._joined(x) / self.scale

    def draw(self, generator: np.random.Generator) -> FloatArray:
        """A normal sample with the inverse as its covariance, shape (splines, n)."""
        x = np.einsum(
            "sij,sj->si", np.linalg.cholesky(self.inverses), generator.standard_normal(self.inverses.shape[:2])
        )
        for s in range(self.inverses.shape[0] - 2, -1, -1):
            x[s] -= self.links[s].T @ x[s + 1]
        return self._joined(x) / self.scale

    def covariance(self) -> FloatArray:
        """The inverse within the band, shape (splines, degree + 1, n, n): element [k, d] is the block (k, k + d)."""
        splines, n = self.scale.shape
        group = max(self.degree, 1)
        blocks, m = self.inverses.shape[:2]
        diagonal, lower = np.empty_like(self.inverses), np.zeros((blocks, m, m))
        diagonal[-1] = self.inverses[-1]
        for s in range(blocks - 2, -1, -1):
            lower[s] = -diagonal[s + 1] @ self.links[s]
            diagonal[s] = self.inverses[s] - self.links[s].T @ lower[s]
        here = diagonal.reshape(blocks, group, n, group, n)
        below = lower.reshape(blocks, group, n, group, n)
        out = np.zeros((blocks * group, self.degree + 1, n, n))
        for a in range(group):
            for d in range(self.degree + 1):
                b = a + d
                out[a::group, d] = here[:, a, :, b, :] if b < group else below[:, b - group, :, a, :].transpose(0, 2, 1)
        out = out[:splines]
        out /= self.scale[:, None, :, None]
        for d in range(self.degree + 1):
            out[: splines - d, d] /= self.scale[d:, None, :]
            out[splines - d :, d] = 0.0
        return out

    def _cut(self, array: FloatArray) -> FloatArray:
        blocks, m = self.inverses.shape[:2]
        padded = np.zeros(blocks * m)
        padded[: array.size] = array.ravel()
        return padded.reshape(blocks, m)

    def _joined(self, x: FloatArray) -> FloatArray:
        flat: FloatArray = x.ravel()[: self.scale.size].reshape(self.scale.shape)
        return flat


def factorised(matrix: FloatArray) -> Factor:
    """Eliminate a positive definite band, shape (splines, degree + 1, n, n).

    Raises
    ------
    numpy.linalg.LinAlgError
        Where it is not positive definite.
    """
    splines, touched, n = matrix.shape[:3]
    degree = touched - 1
    group = max(degree, 1)
    blocks = -(-splines // group)
    scale = np.sqrt(np.maximum(np.diagonal(matrix[:, 0], axis1=1, axis2=2), 0.0))
    if not (scale > 0.0).all():
        raise np.linalg.LinAlgError("a coefficient leaves no trace")
    diagonal = np.zeros((blocks, group, n, group, n))
    lower = np.zeros((blocks, group, n, group, n))
    one = np.arange(n)
    for k in range(splines, blocks * group):
        diagonal[-1, k % group, one, k % group, one] = 1.0
    for a in range(group):
        for d in range(degree + 1):
            piece = matrix[a::group, d] / scale[a::group, :, None]
            b = a + d
            count = min(piece.shape[0], len(range(a + d, splines, group)))
            piece = piece[:count] / scale[a + d :: group, None, :][:count]
            if b < group:
                diagonal[:count, a, :, b, :] = piece
                diagonal[:count, b, :, a, :] = piece.transpose(0, 2, 1)
            else:
                lower[:count, b - group, :, a, :] = piece.transpose(0, 2, 1)
    m = group * n
    inverses, links = diagonal.reshape(blocks, m, m), np.empty((blocks, m, m))
    log_determinant = _eliminate(inverses, lower.reshape(blocks, m, m), links)
    if not np.isfinite(log_determinant):
        raise np.linalg.LinAlgError("the band is not positive definite")
    return Factor(inverses, links[:-1], scale, degree, 2.0 * float(np.log(scale).sum()) + log_determinant)
