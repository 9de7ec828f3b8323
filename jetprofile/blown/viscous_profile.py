"""The two-point problem of a straight blown jet with a solvent viscosity (Oldroyd-B, FENE-P), by Newton's method.

Difference equations of order 4 (Lobatto) on a mesh that follows the solution; the drag is raised from a small share of
itself, first by implicit Euler, which has a good solution on any mesh. A step of Newton's method is shortened until the next
correction shrinks. Meshes are halved until the velocity changes by less than is asked for. 0.1 to 2 s.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator
from scipy.linalg import get_lapack_funcs

from spinline.base.checks import FloatArray
from spinline.jetprofile.blown._profile_kernels import jacobian, residual, slopes

__all__ = ["ViscousProblem", "ViscousProfile", "solve_viscous"]

_FACTOR: Any
_SOLVE: Any
_FACTOR, _SOLVE = get_lapack_funcs(("gbtrf", "gbtrs"), dtype=np.float64)  # type: ignore[misc]
_COARSE, _MOST = 240, 16_000
_MOST_STEPS = 150  # of one way of raising
_MODULUS, _TIME, _SOLVENT, _SHARE = 5, 6, 7, 13  # places among the constants; the last is the drag's share
_QUICK = 1e-3  # s


@dataclass(frozen=True, eq=False)
class ViscousProblem:
    """Constants in the order of `_profile_kernels.CONSTANTS`, the air along z, the length and kinks (m), the pull (N)."""

    constants: FloatArray
    air: Callable[[FloatArray], FloatArray]
    kinks: tuple[float, ...]
    pull: float

    @property
    def length(self) -> float:
        """Of the jet, m."""
        return self.kinks[-1]


@dataclass(frozen=True, eq=False)
class ViscousProfile:
    """Unknowns y (n, 4) at z, the estimated error of ln v, and how much of the drag was reached."""

    z: FloatArray
    y: FloatArray
    error: float
    reached: float

    def curve(self, problem: ViscousProblem) -> CubicHermiteSpline:
        """Cubics through the unknowns with their computed slopes."""
        rates = np.empty_like(self.y)
        air = problem.air(self.z)
        for j in range(self.z.size):
            slopes(self.y[j], air[j], problem.constants, rates[j])
        return CubicHermiteSpline(self.z, self.y, rates, axis=0)


def solve_viscous(problem: ViscousProblem, tolerance: float, near: ViscousProfile | None = None) -> ViscousProfile:
    """Profile with an error of ln v below the tolerance, or as far as it could be reached (`reached` < 1).

    `near`: the profile of a neighbouring problem. Without it the drag is raised at a short relaxation time, then that; where
    this fails, the drag alone.
    """
    constants = problem.constants
    if near is not None:
        return _refined(problem, constants, near.z, near.y, tolerance)
    quick = min(
        1.0, _QUICK / constants[_TIME]
    )  # a slack network cannot carry capillarity: relaxed it has none to carry
    routes = [[(1.0, quick), (1.0, 1.0)], [(0.1, quick), (0.1, 1.0), (1.0, 1.0)], [(1.0, 1.0)]]
    best = ViscousProfile(np.empty(0), np.empty((0, 4)), np.inf, 0.0)
    little = constants[_SOLVENT] < 0.05 * (constants[_MODULUS] * constants[_TIME] + constants[_SOLVENT])
    ways = routes[:1] if little else routes if quick < 1.0 else routes[2:]
    for nodes, tried in ((_COARSE, ways), (3 * _COARSE, [] if little else routes[:1])):
        for route in tried:
            z, y = _first_guess(problem, nodes)
            drag, time, far = 0.0, route[0][1], 0.0
            for goal, slowest in route:
                first, last = (drag, goal) if goal != drag else (time, slowest)
                z, y, reached = _raised(
                    problem, _varied(constants, time if goal != drag else None, drag), z, y, first, last, nodes
                )
                if reached < last:
                    far = reached if goal != drag else 0.5 * drag
                    break
                drag, time = goal, slowest
            else:
                return _refined(problem, constants, z, y, tolerance)
            if far >= best.reached:
                best = ViscousProfile(z, y, np.inf, far)
    return (_lowered(problem, tolerance) if little else None) or best


def _lowered(problem: ViscousProblem, tolerance: float) -> ViscousProfile | None:
    """From ten times the solvent's viscosity at the same viscosity down to it: little solvent follows from more."""
    p = problem.constants
    whole = p[_MODULUS] * p[_TIME] + p[_SOLVENT]

    def thicker(share: float) -> FloatArray:
        q = p.copy()
        q[_SOLVENT] = p[_SOLVENT] / share
        q[_MODULUS] = (whole - q[_SOLVENT]) / p[_TIME]
        return q

    first = max(p[_SOLVENT] / (0.1 * whole), 1e-6)
    more = solve_viscous(replace(problem, constants=thicker(first)), 1e-4)
    if more.reached < 1.0:
        return None
    z, y, reached = _raised(problem, thicker, *_moved(problem, more.z, more.y, _COARSE), first, 1.0, _COARSE)
    return _refined(problem, p, z, y, tolerance) if reached == 1.0 else None


def _varied(constants: FloatArray, time: float | None, drag: float) -> Callable[[float], FloatArray]:
    """Constants by the share of the drag at a relaxation time, or (time None) by that time at a share of the drag."""

    def at(share: float) -> FloatArray:
        return _changed(constants, share, time) if time is not None else _changed(constants, drag, share)

    return at


def _changed(constants: FloatArray, drag: float, time: float) -> FloatArray:
    """The constants with a share of the drag, and of the relaxation time at the same viscosity."""
    p = constants.copy()
    p[_SHARE], p[_MODULUS], p[_TIME] = drag, p[_MODULUS] / time, p[_TIME] * time
    return p


def _raised(
    problem: ViscousProblem,
    constants: Callable[[float], FloatArray],
    z: FloatArray,
    y: FloatArray,
    reached: float,
    goal: float,
    nodes: int,
) -> tuple[FloatArray, FloatArray, float]:
    """Solutions from a share of something up to a goal; the last one found, and its share.

    Each starts from the last two, carried on in the logarithm of the share, or from the last alone.
    """
    factor, share = 8.0, min(8 * reached, goal) if reached else 1e-3
    before: tuple[float, FloatArray] | None = None
    for _ in range(_MOST_STEPS):
        p = constants(share)
        found = None
        if before is not None:
            along = np.log(share / reached) / np.log(reached / before[0])
            found = _newton(problem, p, z, y + along * (y - before[1]), True)
        if found is None:
            found = _newton(problem, p, z, y, True)
        if found is None:
            factor **= 0.5
            if factor < 1.005 or share < 1e-12:
                break
            share = min(reached * factor, goal) if reached else share * 0.1
            continue
        old, z0, y0 = reached, z, y
        reached = share
        z, y = _moved(problem, z, found, nodes)
        if reached >= goal:
            break
        before = (old, np.asarray(PchipInterpolator(z0, y0, axis=0)(z))) if old else None
        factor = min(factor**1.5, 30.0)
        share = min(share * factor, goal)
    return z, y, reached


def _refined(problem: ViscousProblem, p: FloatArray, z: FloatArray, y: FloatArray, tolerance: float) -> ViscousProfile:
    """Order 4 on meshes twice as fine each, until two agree."""
    before: Any = None
    error = np.inf
    nodes = 2 * max(_COARSE, z.size // 3)
    while nodes <= _MOST:
        z, y = _moved(problem, z, y, nodes)
        found, low = _newton(problem, p, z, y, False), None
        if found is None:
            low = _newton(problem, p, z, y, True)
            found = None if low is None else _newton(problem, p, z, low, False)
        if found is not None:
            y = found
            if before is not None:
                now = ViscousProfile(z, y, error, 1.0).curve(problem)
                places = before.x
                error = float(np.abs(now(places)[:, 0] - before(places)[:, 0]).max())
                if error < tolerance:
                    break
            before = ViscousProfile(z, y, error, 1.0).curve(problem)
        elif low is not None:
            y = low
        nodes *= 2
    return ViscousProfile(z, y, error, 0.0 if before is None else 1.0)


def _newton(problem: ViscousProblem, p: FloatArray, z: FloatArray, y: FloatArray, upwind: bool) -> FloatArray | None:
    """Solution near y, or None."""
    node, middle = problem.air(z), problem.air(0.5 * (z[1:] + z[:-1]))
    pull = problem.pull * p[_SHARE]
    y, damping = y.copy(), 1.0
    right, trial = np.empty(y.size), np.empty(y.size)
    band = np.empty((17, y.size), order="F")
    scale = np.maximum(np.ptp(y, axis=0), 0.1)
    for _ in range(50):
        residual(z, y, node, middle, p, pull, upwind, right)
        if not np.isfinite(right).all():
            return None
        jacobian(z, y, node, middle, p, pull, upwind, band)
        if not np.isfinite(band).all():
            return None
        lu, pivots, info = _FACTOR(band, 6, 4)
        if info != 0:
            return None
        change = _SOLVE(lu, 6, 4, -right, pivots)[0].reshape(y.shape)
        size = float(np.sqrt(np.mean((change / scale) ** 2)))
        if not np.isfinite(size):
            return None
        if size < 1e-10:
            done: FloatArray = y + change
            return done
        largest = float(np.abs(change[:, [0, 2, 3]]).max())
        damping = min(1.0, 2 * damping, 2.0 / max(largest, 1e-300))
        while damping > 1e-6:
            residual(z, y + damping * change, node, middle, p, pull, upwind, trial)
            if np.isfinite(trial).all():
                again = _SOLVE(lu, 6, 4, trial, pivots)[0].reshape(y.shape)
                if float(np.sqrt(np.mean((again / scale) ** 2))) <= (1 - damping / 4) * size or damping * size < 1e-8:
                    break
            damping *= 0.5
        else:
            return None
        y += damping * change
        scale = np.maximum(np.ptp(y, axis=0), 0.1)
    return None


def _first_guess(problem: ViscousProblem, nodes: int) -> tuple[FloatArray, FloatArray]:
    """A mesh graded at both ends, and the jet that nothing draws."""
    length, p = problem.length, problem.constants
    end = length - np.geomspace(1e-5, 0.1, nodes // 6) * length
    z = np.concatenate(
        [np.linspace(0, length, nodes // 2), np.geomspace(1e-7, 1, nodes // 3) * length, end, problem.kinks]
    )
    z = np.unique(z)
    y = np.zeros((z.size, 4))
    y[:, 1] = np.sqrt(np.pi * p[0] / p[1]) * p[4] / p[14]
    return z, y


def _moved(problem: ViscousProblem, z: FloatArray, y: FloatArray, nodes: int) -> tuple[FloatArray, FloatArray]:
    """A mesh on which the unknowns, and the logarithm of the strain rate, change by about equal amounts; and y there."""
    length, h = problem.length, np.diff(z)
    middle = 0.5 * (z[1:] + z[:-1])
    span = np.maximum(np.ptp(y, axis=0), 0.3)
    density = np.sum((np.diff(y, axis=0) / h[:, None] / span) ** 2, axis=1)
    rate = np.abs(np.diff(y[:, 0])) / h
    steep = np.gradient(np.log(rate + 1e-6 * rate.max() + 1e-300), middle)
    density += (0.3 / length) ** 2 + (0.03 / (middle + 1e-6 * length)) ** 2
    density = np.sqrt(density + (0.03 / (length - middle + 1e-5 * length)) ** 2 + (0.05 * steep) ** 2)
    for _ in range(4):
        padded = np.concatenate((density[:1], density, density[-1:]))
        density = np.maximum(density, 0.25 * (padded[:-2] + 2 * density + padded[2:]))
    weight = density * h
    weight = weight / weight.sum() + 0.1 * h / length
    total = np.concatenate(([0.0], np.cumsum(weight)))
    new = np.interp(np.linspace(0.0, total[-1], nodes), total, z)
    new[0], new[-1] = 0.0, length
    for kink in problem.kinks[1:-1]:
        new[int(np.argmin(np.abs(new[1:-1] - kink))) + 1] = kink
    new = np.unique(new)
    return new, np.asarray(PchipInterpolator(z, y, axis=0)(new))
