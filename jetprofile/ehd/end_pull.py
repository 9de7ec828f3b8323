"""Whose pull it is: the share of a jet's tension that the condition at its end makes.

At the end the strain rate is set, to ``v / (2 L)``, which is that of a jet whose own inertia thins it. A stiff thread (a
locked network, a viscous thread that hardly thins) answers a set rate with a tension of its own, which pulls it out of the
needle without any field: a thread that is wound up. The share is

    share = d ln T(0) / d ln (strain rate at the end)

from one linear system. A jet that field and weight draw has less than 0.3, nearly all less than 1e-3. At 1 and above all
of the tension at the needle is the end's, and below some strain rate at the end the jet lets go of the needle.
"""

from dataclasses import replace

import numpy as np

from spinline.jetprofile.ehd.boundary_value import Discrete, Linear, Problem
from spinline.jetprofile.ehd.equations import rates

__all__ = ["LIMIT", "end_share"]

LIMIT = 0.5  # share above which another jet is looked for, and the verdict is bad


def end_share(problem: Problem, found: Discrete) -> float:
    """The share of the tension at the needle that is the end's; NaN where the branch folds.

    Parameters
    ----------
    problem : Problem
        What was solved.
    found : Discrete
        Its solution, converged.

    Returns
    -------
    float
        d ln T(0) / d ln (strain rate at the end), of either sign; 0 for a jet that does not feel its end.
    """
    system = Linear(replace(problem, work=None), found.s, found.y)
    if not system.ok:
        return float("nan")
    right = np.zeros(found.y.size)
    right[-1] = problem.parameters[12]  # the last row of the residual is u' - end_slope
    change = system.solve(right)[:1]
    if not np.isfinite(change).all():
        return float("nan")
    step = 1e-6 / max(1.0, float(np.abs(change).max()))
    at = problem.field(found.s[:1])
    above, below = (
        rates(found.y[:1] + sign * step * change, at, problem.parameters, problem.flags)[1][0, 2] for sign in (1, -1)
    )
    tension = rates(found.y[:1].copy(), at, problem.parameters, problem.flags)[1][0, 2]
    return float((above - below) / (2 * step * tension))
