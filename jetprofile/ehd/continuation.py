"""Solutions followed from one set of parameters to another, around folds where there are any (pseudo-arclength).

The path is a function ``t -> Problem``, t from 0 to 1. Each step predicts along the secant, corrects with the bordered
system and moves the mesh. Where t turns back there is a fold: no solution beyond it on this branch. Steps are bounded by
the change of the solution, tension included, so that none hops to another branch.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.jetprofile.ehd.boundary_value import (
    Discrete,
    Linear,
    OutOfWork,
    Problem,
    interpolate,
    newton,
    remesh,
    scales,
)

__all__ = ["Path", "distance", "follow"]

_SHORTEST = 1e-4
_CLOSE = 0.05  # step in which a fold is located


@dataclass(frozen=True)
class Path:
    """How a path ended.

    Attributes
    ----------
    solution : Discrete
        The last solution; of ``t = 1`` where the path arrived.
    arrived : bool
        Whether it did.
    t : float
        Where the path is.
    fold : float
        t of the first fold (NaN: none).
    steps : int
        Steps taken.
    """

    solution: Discrete
    arrived: bool
    t: float
    fold: float
    steps: int


def follow(
    problem_at: Callable[[float], Problem],
    start: Discrete,
    *,
    first: float = 0.05,
    largest: float = 0.6,
    most: int = 200,
    beyond_folds: bool = False,
) -> Path:
    """Follow the solution `start` of ``problem_at(0)`` to t = 1.

    Where the work allowed ends, so does the path.

    Parameters
    ----------
    problem_at : callable
        t to `Problem`; called a little beyond 0 and 1.
    start : Discrete
        Solution at t = 0; its number of nodes is kept.
    first, largest : float
        First and largest step in the scaled norm of all unknowns and t together.
    most : int
        Number of steps, refused ones included, after which it gives up.
    beyond_folds : bool
        Go on where t turns back (t may turn again), rather than stop at the fold.
    """
    trail = [Path(start, False, 0.0, np.nan, 0)]
    try:
        return _follow(problem_at, start, first, largest, most, beyond_folds, trail)
    except OutOfWork:
        return trail[-1]


def _follow(
    problem_at: Callable[[float], Problem],
    start: Discrete,
    first: float,
    largest: float,
    most: int,
    beyond_folds: bool,
    trail: list[Path],
) -> Path:
    nodes = start.s.size
    s, y, t = start.s, start.y, 0.0
    dy, dt = np.zeros_like(y), 1.0
    length, fold = first, np.nan
    recent = [(0.0, 0.0)]  # (length of the path, t)
    for step in range(most):
        norm = float(np.hypot(distance(dy, scales(y)), dt))
        dy, dt = dy / norm, dt / norm
        if dt > 0 and t + dt * length >= 1:
            reach = (1 - t) / dt
            end = newton(problem_at(1.0), s, y + dy * reach, most=12)
            if end.converged and distance(end.y - y, scales(y)) < 2 * largest:
                return Path(end, True, 1.0, fold, step)
            length = 0.4 * reach
        found = _correct(problem_at, s, y, t, dy, dt, length)
        if found is None:
            length *= 0.4
            if length < _SHORTEST:
                return Path(Discrete(s, y), False, t, fold, step)
            continue
        new, new_t, used = found
        recent = [*recent[-2:], (recent[-1][0] + length, new_t)]
        if np.isnan(fold) and len(recent) == 3 and recent[2][1] < recent[1][1] >= recent[0][1]:
            if length > _CLOSE:  # look again, nearer
                length, recent = 0.3 * length, recent[:2]
                continue
            fold = _vertex(recent)
            if not beyond_folds:
                return Path(Discrete(s, y), False, t, fold, step)
        dy, dt, y, t = new - y, new_t - t, new, new_t
        if t < -0.01:  # gone back past the start, beyond a fold
            return Path(Discrete(s, y), False, t, fold, step)
        trail[:] = [Path(Discrete(s, y), False, t, fold, step)]
        length = min(largest, length * (1.6 if used <= 4 else 1.0 if used <= 6 else 0.6))
        moved = remesh(s, y, nodes)
        both, s = interpolate(s, np.concatenate((y, dy), axis=1), moved), moved
        y, dy = np.ascontiguousarray(both[:, : y.shape[1]]), np.ascontiguousarray(both[:, y.shape[1] :])
    return Path(Discrete(s, y), False, t, fold, most)


def distance(change: FloatArray, scale: FloatArray) -> float:
    """Root mean square of a change of the unknowns, each in its range."""
    return float(np.sqrt(np.mean((change / scale) ** 2)))


def _vertex(points: list[tuple[float, float]]) -> float:
    """Greatest value of the parabola through three points."""
    (a, fa), (b, fb), (c, fc) = points
    left, right = (fb - fa) / (b - a), (fc - fb) / (c - b)
    bend = (right - left) / (c - a)
    if bend >= 0:
        return fb
    middle = 0.5 * (a + b) - left / (2 * bend)
    return fa + left * (middle - a) + bend * (middle - a) * (middle - b)


def _correct(
    problem_at: Callable[[float], Problem],
    s: FloatArray,
    y: FloatArray,
    t: float,
    dy: FloatArray,
    dt: float,
    reach: float,
) -> tuple[FloatArray, float, int] | None:
    """Newton for (y, t) in the plane normal to the unit step (dy, dt), `reach` along it; None where it fails."""
    scale = scales(y)
    row = dy / scale**2 / y.size
    guess, guess_t = y + dy * reach, t + dt * reach
    y, t = guess, guess_t
    before, system = np.inf, None
    for step in range(9):
        system = Linear(problem_at(t), s, y, system)
        delta = 1e-6 if t < 0.5 else -1e-6
        if not system.ok:
            return None
        moved = system.residual_of(problem_at(t + delta), y)
        if not np.isfinite(moved).all():
            return None
        first, second = system.solve(-system.value), system.solve((moved - system.value) / delta)
        gap = float(np.sum(row * (y - guess))) + dt * (t - guess_t)
        change_t = (-gap - float(np.sum(row * first))) / (dt - float(np.sum(row * second)))
        change = first - change_t * second
        with np.errstate(over="ignore", invalid="ignore"):
            size = float(np.sqrt(np.mean((change / scale) ** 2) + change_t**2))
        if not np.isfinite(size) or size > 2 or (size > 2 * before and size > 1e-6):
            return None
        before = size
        y, t = y + change, t + change_t
        if size < 1e-8:
            return y, t, step + 1
    return None
