"""Solutions followed from one set of parameters to another, around folds where there are any (pseudo-arclength).

The path is a function ``t -> Problem``, t from 0 to 1. Each step predicts along the secant, corrects with the bordered system
and moves the mesh. Where t turns back there is a fold: no solution beyond it on this branch.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_lapack_funcs

from spinline.checks import FloatArray
from spinline.jetprofile.ehd.boundary_value import Discrete, Problem, interpolate, newton, remesh
from spinline.jetprofile.ehd.equations import box_residual, box_system

__all__ = ["Path", "follow"]

_FACTOR, _SOLVE = get_lapack_funcs(("gbtrf", "gbtrs"), dtype=np.float64)


@dataclass(frozen=True)
class Path:
    """How a path ended: the last solution, the t it reached, and the fold that stopped it (NaN: none)."""

    solution: Discrete
    t: float
    fold: float
    steps: int
    why: str = ""


def _weights(y: FloatArray) -> FloatArray:
    scale = np.maximum(np.ptp(y, axis=0), 1e-3 * np.abs(y).max(axis=0)) + 1e-12
    scale[0] = max(scale[0], 0.1)
    scale[3:] = np.maximum(scale[3:], 0.1)
    return scale


def _correct(
    problem_at: Callable[[float], Problem], s: FloatArray, y: FloatArray, t: float, dy: FloatArray, dt: float, most: int
) -> tuple[FloatArray, float, int] | None:
    """Newton for (y, t) in the plane normal to (dy, dt); None where it fails."""
    n, m = y.shape
    y0, t0 = y.copy(), t
    y, scale = y.copy(), _weights(y)
    row = dy / scale**2 / (n * m)
    middle = 0.5 * (s[1:] + s[:-1])
    before = np.inf
    for step in range(most):
        problem = problem_at(t)
        count = problem.left.shape[0]
        low, high = count + m - 1, 2 * m - 1 - count
        band = np.empty((2 * low + high + 1, n * m), order="F")
        out, moved = np.empty(n * m), np.empty(n * m)
        box_system(
            s, y, problem.field(s), problem.field(middle), problem.parameters, problem.flags, problem.left, scale,
            problem.order, band, out,
        )  # fmt: skip
        delta = 1e-6 if t < 0.5 else -1e-6
        other = problem_at(t + delta)
        box_residual(
            s, y, other.field(s), other.field(middle), other.parameters, other.flags, other.left, other.order, moved
        )
        if not (np.isfinite(out).all() and np.isfinite(band).all() and np.isfinite(moved).all()):
            return None
        lu, pivots, info = _FACTOR(band, low, high)
        if info:
            return None
        both = _SOLVE(lu, low, high, np.stack((-out, (moved - out) / delta), axis=1), pivots)[0]
        first, second = both[:, 0].reshape(n, m), both[:, 1].reshape(n, m)
        gap = float(np.sum(row * (y - y0))) + dt * (t - t0)
        change_t = (-gap - float(np.sum(row * first))) / (dt - float(np.sum(row * second)))
        change = first - change_t * second
        size = float(np.sqrt(np.mean((change / scale) ** 2) + change_t**2))
        if not np.isfinite(size) or size > 2 or (size > 2 * before and size > 1e-6):
            return None
        before = size
        y, t = y + change, t + change_t
        if size < 1e-8:
            return y, t, step + 1
    return None


def follow(
    problem_at: Callable[[float], Problem],
    start: Discrete,
    *,
    first: float = 0.05,
    largest: float = 0.6,
    most: int = 400,
    stop_at_fold: bool = True,
    trace: list[tuple[float, float]] | None = None,
) -> Path:
    """Follow the solution `start` of ``problem_at(0)`` to t = 1.

    `largest` bounds the step in the scaled norm of the unknowns and t together, so that no step hops to another branch.
    """
    nodes = start.s.size
    s, y, t = start.s, start.y, 0.0
    dy, dt = np.zeros_like(y), 1.0
    length, fold = first, np.nan
    last_t = [0.0]
    for count in range(most):
        scale = _weights(y)
        norm = float(np.sqrt(np.mean((dy / scale) ** 2) + dt**2))
        dy, dt = dy / norm, dt / norm
        reach = length
        if dt > 0 and t + dt * reach > 1:
            reach = (1 - t) / dt
        found = _correct(problem_at, s, y + dy * reach, t + dt * reach, dy, dt, 9)
        if found is None:
            length *= 0.4
            if length < 1e-4:
                return Path(Discrete(s, y, True, count), t, fold, count, "step too small")
            continue
        new, new_t, used = found
        dy, dt = new - y, new_t - t
        last_t.append(new_t)
        if trace is not None:
            trace.append((new_t, float(new[0, 1])))
        if np.isnan(fold) and len(last_t) > 2 and new_t < last_t[-2] and last_t[-2] > last_t[-3]:
            fold = max(last_t[-3:])
            if stop_at_fold:
                return Path(Discrete(s, y, True, count), t, fold, count, "fold")
        y, t = new, new_t
        length = min(largest, length * (1.6 if used <= 4 else 1.0 if used <= 6 else 0.6))
        moved = remesh(s, y, nodes)
        y, dy, s = interpolate(s, y, moved), interpolate(s, dy, moved), moved
        if t >= 1 - 1e-9 and dt >= 0 or t > 1:
            end = newton(problem_at(1.0), s, y)
            return Path(end, 1.0, fold, count, "" if end.converged else "last step failed")
    return Path(Discrete(s, y, True, most), t, fold, most, "too many steps")
