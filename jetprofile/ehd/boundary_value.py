"""Newton's method for the difference equations of `equations`, on a mesh that follows the solution.

The linear systems are banded (LAPACK). A step is shortened until the next correction shrinks (natural monotonicity);
the sign of the determinant is kept, since it changes where a branch of solutions folds.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import get_lapack_funcs

from spinline.checks import FloatArray
from spinline.jetprofile.ehd.equations import box_residual, box_system

__all__ = ["Discrete", "Problem", "interpolate", "newton", "remesh"]

_FACTOR, _SOLVE = get_lapack_funcs(("gbtrf", "gbtrs"), dtype=np.float64)


@dataclass(frozen=True)
class Problem:
    """One boundary-value problem, dimensionless: parameters, applied field, and which unknowns are carried."""

    parameters: FloatArray
    field: Any  # callable s -> E_ext / E_s
    end: float  # s where the end conditions hold
    left: FloatArray  # (index, value) rows
    polymer: bool
    charge: bool
    local: bool
    order: int = 4

    @property
    def flags(self) -> Any:
        return np.array([self.polymer, self.charge, self.local])

    @property
    def size(self) -> int:
        return 4 + 2 * self.polymer + self.charge


@dataclass(frozen=True)
class Discrete:
    """A solution of the difference equations."""

    s: FloatArray
    y: FloatArray
    converged: bool
    steps: int
    sign: float = 0.0  # of the determinant


def newton(problem: Problem, s: FloatArray, y: FloatArray, *, most: int = 40, tol: float = 1e-9) -> Discrete:
    nodes = np.asarray(problem.field(s), dtype=float)
    middles = np.asarray(problem.field(0.5 * (s[1:] + s[:-1])), dtype=float)
    n, m = y.shape
    count = problem.left.shape[0]
    low, high = count + m - 1, 2 * m - 1 - count
    band = np.empty((2 * low + high + 1, n * m), order="F")
    out, trial = np.empty(n * m), np.empty(n * m)
    args = (nodes, middles, problem.parameters, problem.flags, problem.left)
    y = y.copy()
    sign = 0.0
    damping = 1.0
    for step in range(most):
        scale = np.maximum(np.ptp(y, axis=0), 1e-3 * np.abs(y).max(axis=0)) + 1e-12
        scale[0] = max(scale[0], 0.1)
        scale[3:] = np.maximum(scale[3:], 0.1)
        box_system(s, y, *args, scale, problem.order, band, out)
        if not np.isfinite(out).all() or not np.isfinite(band).all():
            return Discrete(s, y, False, step)
        lu, pivots, info = _FACTOR(band, low, high)
        if info:
            return Discrete(s, y, False, step)
        diagonal = lu[low + high]
        sign = float(np.prod(np.sign(diagonal)) * (-1) ** int(np.count_nonzero(pivots != np.arange(n * m))))
        change = -_SOLVE(lu, low, high, out, pivots)[0].reshape(n, m)
        size = np.sqrt(np.mean((change / scale) ** 2))
        if not np.isfinite(size):
            return Discrete(s, y, False, step)
        if size < tol:
            return Discrete(s, y + change, True, step + 1, sign)
        damping = min(1.0, 2 * damping)
        # no step multiplies V or a conformation by more than e^2
        damping = min(damping, 2.0 / max(np.abs(change[:, 0]).max(), np.abs(change[:, 3:]).max() / 1.5, 1e-300))
        while True:
            new = y + damping * change
            box_residual(s, new, *args, problem.order, trial)
            if np.isfinite(trial).all():
                again = -_SOLVE(lu, low, high, trial, pivots)[0].reshape(n, m)
                if np.sqrt(np.mean((again / scale) ** 2)) <= (1 - damping / 4) * size or damping * size < 1e-7:
                    break
            damping *= 0.5
            if damping < 1e-5:
                return Discrete(s, y, False, step)
        y = new
    return Discrete(s, y, False, most)


def remesh(s: FloatArray, y: FloatArray, nodes: int) -> FloatArray:
    """Nodes at which the solution changes by equal amounts."""
    end = s[-1]
    h = np.diff(s)
    span = np.ptp(y, axis=0)
    span = np.where(span > 1e-12 * (1 + np.abs(y).max(axis=0)), span, np.inf)
    density = np.sum((np.diff(y, axis=0) / h[:, None] / span) ** 2, axis=1)
    middle = 0.5 * (s[1:] + s[:-1])
    density += (0.3 / end) ** 2 + (0.05 / (middle + 1e-5 * end)) ** 2
    density = np.sqrt(density)
    for _ in range(4):  # smooth: neighbours differ little
        padded = np.concatenate(([density[0]], density, [density[-1]]))
        density = np.maximum(density, 0.25 * (padded[:-2] + 2 * density + padded[2:]))
    weight = density * h
    weight = weight / weight.sum() + 0.1 * h / end
    total = np.concatenate(([0.0], np.cumsum(weight)))
    new = np.interp(np.linspace(0.0, total[-1], nodes), total, s)
    new[0], new[-1] = 0.0, end
    return new


def interpolate(s: FloatArray, y: FloatArray, new: FloatArray) -> FloatArray:
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(s, y, axis=0)(new)
