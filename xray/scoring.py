"""The largest Poisson likelihood of a row's model, by Fisher scoring with Levenberg's damping.

A step solves ``(F + d diag F) step = J^T (c/lambda - 1)`` with ``F = J^T diag(1/lambda) J``; it is taken if the deviance falls,
else the damping d grows. Where the slope at the step's end points back, the step is cut to where a straight line through both
slopes vanishes: edges of the jet that cross pixels bend the likelihood of few counts much more than its expectation, and plain
scoring zigzags. The end is within about 1e-3 of a standard deviation.
"""

from typing import NamedTuple

import numpy as np

from spinline.checks import BoolArray, FloatArray
from spinline.xray.model import RowModel

__all__ = ["largest_likelihood", "poisson_deviance"]

_STEPS = 60
_STALLED = 1e-4  # fall of the deviance over three steps
_LEAST_DAMPING = 1e-9  # keeps a singular matrix solvable
_TOLERANCE = 1e-6  # of the squared step, in standard deviations


class _Point(NamedTuple):
    """Parameters, deviance, and the likelihood's expected curvature and gradient there."""

    at: FloatArray
    deviance: float
    fisher: FloatArray
    gradient: FloatArray


def poisson_deviance(counts: FloatArray, expected: FloatArray) -> float:
    """Deviance ``2 sum(c ln(c/lambda) - (c - lambda))`` of counts >= 0 about means > 0; 0 where they agree.

    Evaluated without cancellation, so that differences of 1e-6 show among 1e9 photons.
    """
    off = (counts - expected) / expected
    safe = np.maximum(off, -0.5)
    near = (1.0 + safe) * np.log1p(safe) - safe
    ratio = np.maximum(1.0 + off, 1e-300)
    far = (1.0 + off) * np.log(ratio) - off
    return float(2.0 * (expected * np.where(off > -0.5, near, far)).sum())


def largest_likelihood(
    model: RowModel, start: FloatArray, free: list[int], counts: FloatArray, lit: BoolArray
) -> tuple[FloatArray, bool, int, float]:
    """Parameters of the largest likelihood near a start.

    Parameters
    ----------
    model : RowModel
    start : ndarray
        All parameters, in the model's order.
    free : list of int
        Those that are fitted.
    counts, lit : ndarray, shape (pixels,)
        Counts, and which of them are used.

    Returns
    -------
    parameters, converged, iterations, deviance
        Not converged: 60 steps were not enough, or the model has no meaning at the start.
    """
    data = counts[lit]

    def look(at: FloatArray) -> _Point | None:
        if not model.allows(at):
            return None
        mean, jacobian = model.evaluate(at)
        mean = mean[lit]
        if mean.min() <= 0.0:
            return None
        used = jacobian[lit][:, free]
        weighted = used / mean[:, None]
        return _Point(at, poisson_deviance(data, mean), used.T @ weighted, (data - mean) @ weighted)

    here = look(start)
    if here is None:
        return start.copy(), False, 0, np.inf
    damping, fallen = 1e-3, [np.inf]
    for turn in range(1, _STEPS + 1):
        scale = np.sqrt(np.maximum(np.diag(here.fisher), 1e-300))
        scaled = here.fisher / np.outer(scale, scale)
        while True:
            step = np.linalg.solve(scaled + damping * np.eye(len(free)), here.gradient / scale) / scale
            gain = float(here.gradient @ step)
            if gain < _TOLERANCE:
                return here.at, damping < 1.0, turn, here.deviance
            there = look(_moved(here.at, free, step))
            if there is not None:
                slope = float(there.gradient @ step)
                if slope < -0.2 * gain:  # overshot: the noise bends the likelihood more than its expectation does
                    nearer = look(_moved(here.at, free, step * (gain / (gain - slope))))
                    if nearer is not None and nearer.deviance < there.deviance:
                        there = nearer
                if there.deviance < here.deviance:
                    break
            damping = max(10.0 * damping, 1e-3)
            if damping > 1e8:
                return here.at, True, turn, here.deviance  # a kink: no step lowers the deviance
        fallen = [*fallen[-2:], here.deviance - there.deviance]
        here = there
        if turn > 3 and sum(fallen) < _STALLED:
            return here.at, True, turn, here.deviance
        damping = max(0.1 * damping, _LEAST_DAMPING)
    return here.at, False, _STEPS, here.deviance


def _moved(at: FloatArray, free: list[int], step: FloatArray) -> FloatArray:
    new = at.copy()
    new[free] += step
    return new
