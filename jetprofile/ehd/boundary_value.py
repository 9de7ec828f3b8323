"""Newton's method for the difference equations of `equations`, on a mesh that follows the solution.

The linear systems are banded (LAPACK). A step is shortened until the next correction shrinks (natural monotonicity). The
sign of the determinant is kept: it changes where a branch of solutions folds.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator
from scipy.linalg import get_lapack_funcs

from spinline.base.checks import BoolArray, FloatArray
from spinline.jetprofile.ehd.equations import jacobian, rates, residual

__all__ = [
    "Discrete",
    "Linear",
    "OutOfWork",
    "Problem",
    "Work",
    "halved",
    "interpolate",
    "newton",
    "remesh",
    "scales",
    "spline",
]

_FACTOR: Any
_SOLVE: Any
_FACTOR, _SOLVE = get_lapack_funcs(("gbtrf", "gbtrs"), dtype=np.float64)  # type: ignore[misc]


class OutOfWork(Exception):
    """The work allowed is used up."""


class Work:
    """Work that may still be done: nodes times linear systems, about 5 us each. Counts the same on every machine."""

    def __init__(self, allowed: int) -> None:
        self.left = allowed

    def spend(self, nodes: int) -> None:
        """Take one linear system of so many nodes."""
        self.left -= nodes
        if self.left < 0:
            raise OutOfWork


@dataclass(frozen=True)
class Problem:
    """One boundary-value problem, dimensionless.

    Attributes
    ----------
    parameters : ndarray
        In the order of `equations.PARAMETERS`.
    field : callable
        s -> E_ext / E_s.
    left : ndarray of shape (conditions, 2)
        Index of an unknown and its value at the start.
    polymer, charge, local : bool
        Whether conformation and charge relaxation are carried; whether the logarithm is local.
    upwind : bool
        Order 1 in place of 4, for coarse meshes where the order-4 equations have no good solution.
    work : Work, optional
        Work still allowed; `OutOfWork` is raised where it ends.
    """

    parameters: FloatArray
    field: Callable[[FloatArray], FloatArray]
    end: float
    left: FloatArray
    polymer: bool
    charge: bool
    local: bool
    upwind: bool = False
    work: Work | None = None

    @property
    def flags(self) -> BoolArray:
        """The four switches as an array."""
        return np.array([self.polymer, self.charge, self.local, self.upwind])

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 4 + 2 * self.polymer + self.charge


@dataclass(frozen=True)
class Discrete:
    """A solution of the difference equations: unknowns y at the nodes s."""

    s: FloatArray
    y: FloatArray
    converged: bool = True
    sign: float = 0.0  # of the determinant


def scales(y: FloatArray) -> FloatArray:
    """Size of each unknown, for norms and difference quotients."""
    scale: FloatArray = np.maximum(np.ptp(y, axis=0), 1e-3 * np.abs(y).max(axis=0)) + 1e-12
    scale[0] = max(scale[0], 0.1)
    scale[3:] = np.maximum(scale[3:], 0.1)
    return scale


class Linear:
    """The system linearised about y, factored; `ok` is False where it cannot be. `near` is another one, on the same mesh."""

    def __init__(self, problem: Problem, s: FloatArray, y: FloatArray, near: "Linear | None" = None) -> None:
        n, m = y.shape
        if problem.work is not None:
            problem.work.spend(n)
        count = problem.left.shape[0]
        self._low, self._high = count + m - 1, 2 * m - 1 - count
        self._shape = (n, m)
        self._s, self._field = s, problem.field
        self._applied = near._applied_by(problem.field) if near is not None else _applied(problem.field, s)
        self._args = (*self._applied, problem.parameters, problem.flags, problem.left)
        self.value = self.residual(y)
        self.ok = bool(np.isfinite(self.value).all())
        if not self.ok:
            return
        band = np.empty((2 * self._low + self._high + 1, n * m), order="F")
        try:
            jacobian(s, y, *self._args, band)
            self.ok = bool(np.isfinite(band).all())
        except ZeroDivisionError:  # an unknown ran away and its exponential vanished
            self.ok = False
        if self.ok:
            self._lu, self._pivots, info = _FACTOR(band, self._low, self._high, overwrite_ab=True)
            self.ok = info == 0

    def residual(self, y: FloatArray) -> FloatArray:
        """Residual at another y."""
        out = np.empty(y.size)
        residual(self._s, y, *self._args, out)
        return out

    def residual_of(self, problem: Problem, y: FloatArray) -> FloatArray:
        """Residual alone, of another problem on the same mesh."""
        out = np.empty(y.size)
        applied = self._applied_by(problem.field)
        residual(self._s, y, *applied, problem.parameters, problem.flags, problem.left, out)
        return out

    def _applied_by(self, field: Callable[[FloatArray], FloatArray]) -> tuple[FloatArray, FloatArray]:
        return self._applied if field is self._field else _applied(field, self._s)

    def solve(self, right: FloatArray) -> FloatArray:
        """Solution for one right-hand side, in the shape of y."""
        value: FloatArray = _SOLVE(self._lu, self._low, self._high, right, self._pivots)[0].reshape(self._shape)
        return value

    @property
    def sign(self) -> float:
        """Sign of the determinant."""
        diagonal = self._lu[self._low + self._high]
        swaps = int(np.count_nonzero(self._pivots != np.arange(diagonal.size)))
        return float(np.prod(np.sign(diagonal)) * (-1) ** swaps)


def _applied(field: Callable[[FloatArray], FloatArray], s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Applied field at the nodes and half way between them."""
    return field(s), field(0.5 * (s[1:] + s[:-1]))


def newton(problem: Problem, s: FloatArray, y: FloatArray, *, most: int = 40, tol: float = 1e-9) -> Discrete:
    """Solution near `y`; `converged` says whether it was found."""
    y, damping, system = y.copy(), 1.0, None
    for _ in range(most):
        scale = scales(y)
        system = Linear(problem, s, y, system)
        if not system.ok:
            break
        change = system.solve(-system.value)
        size = _size(change, scale)
        if not np.isfinite(size):
            break
        if size < tol:
            return Discrete(s, y + change, True, system.sign)
        # no step multiplies V by more than e^2, a conformation, the current or a share by more than e^3
        largest = max(float(np.abs(change[:, 0]).max()), float(np.abs(change[:, 3:]).max()) / 1.5)
        damping = min(1.0, 2 * damping, 2.0 / max(largest, 1e-300))
        while damping > 1e-5:
            trial = system.residual(y + damping * change)
            if np.isfinite(trial).all():
                again = _size(system.solve(trial), scale)
                if again <= (1 - damping / 4) * size or damping * size < 1e-7:
                    break
            damping *= 0.5
        else:
            break
        y = y + damping * change
    return Discrete(s, y, False)


def _size(change: FloatArray, scale: FloatArray) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(np.mean((change / scale) ** 2)))


def remesh(s: FloatArray, y: FloatArray, nodes: int) -> FloatArray:
    """Nodes between which the unknowns and the logarithm of the strain rate change by about equal amounts.

    A tenth is spread evenly; both ends, where there are layers, are graded.
    """
    end, h = s[-1], np.diff(s)
    span = np.ptp(y, axis=0)
    span = np.where(span > 1e-12 * (1 + np.abs(y).max(axis=0)), span, np.inf)
    density = np.sum((np.diff(y, axis=0) / h[:, np.newaxis] / span) ** 2, axis=1)
    middle = 0.5 * (s[1:] + s[:-1])
    rate = np.abs(np.diff(y[:, 0])) / h
    steepness = np.gradient(np.log(rate + 1e-6 * rate.max() + 1e-300), middle)
    density += (0.3 / end) ** 2 + (0.05 / (middle + 1e-5 * end)) ** 2
    density = np.sqrt(density + (0.05 / (end - middle + 1e-4 * end)) ** 2 + (0.08 * steepness) ** 2)
    for _ in range(6):  # neighbours differ little
        padded = np.concatenate(([density[0]], density, [density[-1]]))
        density = np.maximum(density, 0.25 * (padded[:-2] + 2 * density + padded[2:]))
    weight = density * h
    weight = weight / weight.sum() + 0.1 * h / end
    total = np.concatenate(([0.0], np.cumsum(weight)))
    new = np.interp(np.linspace(0.0, total[-1], nodes), total, s)
    new[0], new[-1] = 0.0, end
    return new


def halved(s: FloatArray) -> FloatArray:
    """The mesh with the middle of every interval added."""
    new = np.empty(2 * s.size - 1)
    new[::2], new[1::2] = s, 0.5 * (s[1:] + s[:-1])
    return new


def interpolate(s: FloatArray, y: FloatArray, new: FloatArray) -> FloatArray:
    """Unknowns on another mesh, monotone between nodes: a start for the next solution."""
    value: FloatArray = PchipInterpolator(s, y, axis=0)(new)
    return value


def spline(problem: Problem, found: Discrete) -> tuple[CubicHermiteSpline, FloatArray]:
    """Cubics through the unknowns with their computed slopes (order 4), and the slopes at the nodes."""
    rate, _ = rates(found.y, problem.field(found.s), problem.parameters, problem.flags)
    return CubicHermiteSpline(found.s, found.y, rate, axis=0), rate
