"""The largest Poisson likelihood of a row's model, by Fisher scoring with Levenberg's damping.

A step solves ``(F + d diag F) step = J^T (c/lambda - 1)`` with ``F = J^T diag(1/lambda) J``; it is taken if the deviance falls,
else the damping d grows. Where the slope at the step's end points back, the step is cut to where a straight line through both
slopes vanishes: edges of the jet that cross pixels bend the likelihood of few counts much more than its expectation, and plain
scoring zigzags. The end is within about 1e-3 of a standard deviation.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.xray.row.model import RowModel

__all__ = ["largest_likelihood", "poisson_deviance"]

_STEPS = 60
_STALLED = 1e-4  # fall of the deviance over three steps
_LEAST_DAMPING = 1e-9  # keeps a singular matrix solvable
_HOPE = 10.0  # the deviance falls by no more than this times what a step promises
_SAME = 1e-2  # of the deviance, and of the squared distance of two maxima in standard deviations
_KINK = 1.0  # squared step, in standard deviations, that a kink may leave
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
    model: RowModel,
    start: FloatArray,
    free: list[int],
    counts: FloatArray,
    lit: BoolArray,
    known: tuple[FloatArray, bool, int, float] | None = None,
    prior: FloatArray | None = None,
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
    known : tuple, optional
        A maximum found from elsewhere, as returned: the search ends early where it comes to the same or to a lower one.
    prior : ndarray, optional
        1/variance that the parameters have about 0 beforehand, in the model's order.

    Returns
    -------
    parameters, converged, iterations, deviance
        Not converged: 60 steps were not enough, or the model has no meaning at the start.
    """
    from spinline.xray.row.kernel import damped_step, poisson_curvature  # loads the compiler

    which = np.array(free, dtype=np.int64)
    n = which.size
    diagonal = np.diag_indices(n)

    def look(at: FloatArray) -> _Point | None:
        if not model.allows(at):
            return None
        mean, jacobian = model.evaluate(at)
        fisher, gradient = np.empty((n, n)), np.empty(n)
        deviance = poisson_curvature(counts, lit, mean, np.asfortranarray(jacobian), which, fisher, gradient)
        if prior is not None:
            fisher[diagonal] += prior[which]
            gradient -= prior[which] * at[which]
            deviance += float(prior[which] @ at[which] ** 2)
        return _Point(at, deviance, fisher, gradient) if deviance < np.inf else None

    here = look(start)
    if here is None:
        return start.copy(), False, 0, np.inf
    damping, fallen = 1e-3, [np.inf]
    for turn in range(1, _STEPS + 1):
        while True:
            step = np.empty(n)
            gain = damped_step(here.fisher, here.gradient, damping, step)
            if gain < _TOLERANCE:
                return here.at, damping < 1.0 or _at_kink(here), turn, here.deviance
            if known is not None and _idle(here, gain, known, free):
                return here.at, True, turn, here.deviance
            there = look(_moved(here.at, which, step))
            if there is not None:
                slope = float(there.gradient @ step)
                if slope < -0.2 * gain:  # overshot: the noise bends the likelihood more than its expectation does
                    nearer = look(_moved(here.at, which, step * (gain / (gain - slope))))
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


def _at_kink(here: _Point) -> bool:
    """Whether what a whole step promises is too little to matter: where an edge of the jet lies on that of a pixel, the
    likelihood has a kink, and the nearer the slower steps fall.
    """
    from spinline.xray.row.kernel import damped_step  # loads the compiler

    return damped_step(here.fisher, here.gradient, _LEAST_DAMPING, np.empty(here.gradient.size)) < _KINK


def _idle(here: _Point, gain: float, known: tuple[FloatArray, bool, int, float], free: list[int]) -> bool:
    """Whether a search has come to the maximum that is known, or will end in a lower one."""
    if here.deviance - _HOPE * gain > known[3]:
        return True
    off = (here.at - known[0])[free]
    return here.deviance - known[3] < _SAME and float(off @ here.fisher @ off) < _SAME


def _moved(at: FloatArray, free: NDArray[np.int64], step: FloatArray) -> FloatArray:
    new = at.copy()
    new[free] += step
    return new
