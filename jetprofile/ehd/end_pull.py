"""Whose pull it is: what of a jet the condition at its end makes.

At the end the strain rate is set, to ``v / (2 L)``, which is that of a jet whose own inertia thins it. A stiff thread (a
locked network, a viscous thread that hardly thins) answers a set rate with a tension of its own. That may pull the thread
out of the needle without any field, as if it were wound up; or draw a neck into a thread that reaches the end thick::

    share = 1 - T(0) at a hundredth of the strain rate / T(0)
    neck = max |du / d ln (strain rate)| ,   u = ln V

The jet is followed to the slow end only where ``d ln T(0) / d ln (strain rate)``, from one linear system and otherwise
taken for the share, is above 1/2: near a fold it is large for any jet, but what the field draws keeps its tension. Of 245
jets of random settings ten had a neck of 1.4 to 22, the others at most 0.55.
"""

from dataclasses import dataclass, replace

import numpy as np

from spinline.jetprofile.ehd.boundary_value import Discrete, Linear, Problem, interpolate, newton, remesh
from spinline.jetprofile.ehd.continuation import follow
from spinline.jetprofile.ehd.equations import PARAMETERS, rates

__all__ = ["LIMIT", "NECK", "SLACK", "EndPull", "end_pull"]

_NODES = 801
_SLOW = 0.01
LIMIT = 0.5  # share above which another jet is looked for, and the verdict is bad
NECK = 1.0  # the same for the neck
SLACK = 0.9  # share above which it is no jet of this needle


@dataclass(frozen=True)
class EndPull:
    """What the condition at the end makes of a jet.

    Attributes
    ----------
    share : float
        Of the tension at the needle: 0 for a jet that does not feel its end (of either sign where it hardly does), 1 where
        all is the end's. NaN where the branch folds just there.
    neck : float
        Greatest change of ln V along the jet by the logarithm of the strain rate at its end.
    """

    share: float
    neck: float

    @property
    def rules(self) -> bool:
        """Whether the end, more than field and weight, makes this jet."""
        return self.share > LIMIT or self.neck > NECK


def end_pull(problem: Problem, found: Discrete) -> EndPull:
    """What the end makes of a solution of a problem."""
    problem = replace(problem, work=None)
    system = Linear(problem, found.s, found.y)
    if not system.ok:
        return EndPull(float("nan"), float("nan"))
    right = np.zeros(found.y.size)
    right[-1] = problem.parameters[12]  # the last row of the residual is u' - end_slope
    change = system.solve(right)
    if not np.isfinite(change).all():
        return EndPull(float("nan"), float("nan"))
    step = 1e-6 / max(1.0, float(np.abs(change[0]).max()))
    above, below = (_tension(problem, replace(found, y=found.y[:1] + sign * step * change[:1])) for sign in (1, -1))
    share = (above - below) / (2 * step * _tension(problem, found))
    neck = float(np.abs(change[:, 0]).max())
    return EndPull(_followed(problem, found, share) if share > LIMIT else share, neck)


def _tension(problem: Problem, found: Discrete) -> float:
    """T at the needle."""
    first, field = np.ascontiguousarray(found.y[:1]), problem.field(found.s[:1])
    return float(rates(first, field, problem.parameters, problem.flags)[1][0, 2])


def _followed(problem: Problem, found: Discrete, share: float) -> float:
    """The share from a hundredth of the strain rate; the one given where the jet cannot be followed at all."""
    end = PARAMETERS.index("end_slope")

    def at(t: float) -> Problem:
        parameters = problem.parameters.copy()
        parameters[end] *= _SLOW**t
        return replace(problem, parameters=parameters)

    s = remesh(found.s, found.y, min(found.s.size, _NODES))
    start = newton(problem, s, interpolate(found.s, found.y, s))
    if not start.converged:
        return share
    path = follow(at, start, largest=0.3, most=80)
    if path.t < 0.05:
        return share
    return 1 - _tension(problem, path.solution) / _tension(problem, start)
