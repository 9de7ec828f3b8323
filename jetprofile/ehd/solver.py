"""From settings to a steady jet: one branch of solutions, followed from a thread that nothing pulls.

1. A thread without forces is the start. Every force is then raised to its full value along one path, around which a fold would
   be seen (`continuation`). No other start is needed, and none hops to another branch. Where a long relaxation time folds the
   path at a weak pull, the pull is raised at a short one, and the time then lengthened.
2. Charge that relaxes at once is assumed first; where the relaxation length matters it is then resolved.
3. A measured current is approached from the predicted one.
4. The mesh is refined until its halving says that the radius is known to `tolerance`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.jetprofile.ehd.boundary_value import (
    Discrete,
    Linear,
    OutOfWork,
    Problem,
    Work,
    halved,
    interpolate,
    newton,
    remesh,
    scales,
    spline,
)
from spinline.jetprofile.ehd.continuation import Path, distance, follow
from spinline.jetprofile.ehd.end_pull import end_pull
from spinline.jetprofile.ehd.equations import rates
from spinline.jetprofile.ehd.settings import NeedleSettings

__all__ = ["Solved", "between", "errors_of", "raise_pull", "solve", "thins"]

_COARSE = 161
_UPWIND = 321
_FINEST = 5121
_LEAST_PULL = 0.01
_RELAXED = 1e-5  # share of the conducted current by which charge relaxation may be off before it is resolved
_SLACK = 0.5  # Deborah number at which the pull is raised where a longer relaxation time folds the path
PLATE = 0.8  # of the gap, from where a jet that ends at the plate's potential feels it
_FLAT = 1e-7  # slope of ln V below which a thread that thickens does so by rounding
_WORK = 1_000_000
_NEAR = 0.6  # change of a neighbour's solution, in its ranges, that is taken in one go
_EMPTY = (np.zeros(0), np.zeros((0, 4)), False)


@dataclass(frozen=True)
class Solved:
    """A solution with the problem it belongs to.

    Attributes
    ----------
    problem, discrete
        What was solved, and its finest solution; where there is none, the last one on the way (perhaps empty).
    error : dict
        Estimated errors, relative: radius (worst, between the nodes too), current, tension (of its maximum).
    why : str
        Empty, or why there is no solution: "fold" (the branch ends), "lost" (the path ended), "mesh" (the mesh moves it).
    pull : float
        Share of the pull that was reached.
    time_share : float
        Share of the relaxation time at which the branch folds under the full pull (NaN: not looked for, or no fold).
    direct : bool
        Reached in one go from the neighbour that was given.
    """

    problem: Problem
    discrete: Discrete
    error: dict[str, float]
    why: str = ""
    pull: float = 1.0
    time_share: float = np.nan
    direct: bool = False


class _Search:
    """One search for the jet of some settings: the work left, and how far it came."""

    def __init__(self, settings: NeedleSettings, work: int) -> None:
        self.settings = settings
        self.work = Work(work)
        self.pull, self.time_share = 0.0, np.nan
        self.folded = False
        self.last = Discrete(*_EMPTY)
        self.last_problem = settings.problem(charge=False, predicted=True)

    def problem(self, *, charge: bool, predicted: bool, slack: float = 1.0) -> Problem:
        return self.settings.problem(charge=charge, predicted=predicted, slack=slack, work=self.work)

    def primary(self) -> tuple[Discrete | None, bool]:
        """Coarse solution, and whether charge relaxation is in it; one that does not thin only where no way leads to another.

        A path may come out on a branch that retracts half way: the next way is then tried.
        """
        given = self.settings.current is not None
        ways = [(True, False, False), (True, True, False), (True, False, True), (True, True, True)]
        other: tuple[Discrete | None, bool] = (None, True)
        try:
            for predicted, charge, upwind in [*ways, (False, True, False)] if given else ways:
                found = self.ascend(charge, predicted, upwind)
                if found is not None and not charge:
                    found, charge = self.with_relaxation(found)
                if found is not None and predicted and given:
                    path = self.impose_current(charge, found)
                    found = path.solution if path.arrived else None
                    self.folded |= not np.isnan(path.fold)
                if found is None:
                    continue
                if thins(self.problem(charge=charge, predicted=False), found):
                    return found, charge
                other = other if other[0] is not None else (found, charge)
        except OutOfWork:
            if other[0] is None:
                raise
        return other

    def ascend(self, charge: bool, predicted: bool, upwind: bool) -> Discrete | None:
        """The top of the path of rising pull, by the order-4 equations or, those lost, by the upwind ones.

        A long relaxation time may put the thread that nothing pulls on the stretched side already, where its end makes it: the
        pull is then raised at a short time too.
        """
        found = self.climb(charge, predicted, 1.0, upwind)
        if not self.settings.polymer or self.settings.deborah <= _SLACK:
            return found
        problem = self.problem(charge=charge, predicted=predicted)
        if found is not None and not end_pull(problem, found).rules:
            return found
        slack, told = _SLACK / self.settings.deborah, (self.folded, self.time_share)
        try:
            loose = self.climb(charge, predicted, slack, upwind)
            longer = None if loose is None else self.lengthen(loose, charge, predicted, slack)
        except OutOfWork:
            if found is None:
                raise
            longer = None
        if found is not None and (longer is None or not thins(problem, longer) or end_pull(problem, longer).rules):
            self.folded, self.time_share = told
            return found
        return longer

    def lengthen(self, loose: Discrete, charge: bool, predicted: bool, slack: float) -> Discrete | None:
        """From a short relaxation time to its own at the full pull; a fold on the way is a limit of the relaxation time."""
        for upwind in (False, True):

            def at(t: float, upwind: bool = upwind) -> Problem:
                problem = self.problem(charge=charge, predicted=predicted, slack=slack ** (1 - t))
                return replace(problem, upwind=upwind)

            s = remesh(loose.s, loose.y, _UPWIND if upwind else _COARSE)
            start = newton(at(0.0), s, interpolate(loose.s, loose.y, s))
            if not start.converged:
                continue
            path = follow(at, start)
            if path.arrived:
                self.folded = False
                return self.sharpened(path.solution, charge, predicted, 1.0) if upwind else path.solution
            if not np.isnan(path.fold):
                self.folded, self.time_share = True, float(slack ** (1 - path.fold))
                return None
        return None

    def climb(self, charge: bool, predicted: bool, slack: float, only: bool) -> Discrete | None:
        """Raise the pull; the solution, None where the path folds or is lost."""
        for nodes, upwind in ((_COARSE, False), (_UPWIND, True))[only:]:
            options: Any = {"charge": charge, "predicted": predicted, "slack": slack}
            path, least = raise_pull(self.settings, work=self.work, nodes=nodes, upwind=upwind, **options)
            reached = float(least ** (1 - min(path.t, 1.0)))
            if reached > self.pull and path.solution.y.size:
                self.pull, self.last = reached, path.solution
                self.last_problem = self.settings.problem(pull=reached, **options)
            if path.arrived:
                return self.sharpened(path.solution, charge, predicted, slack) if upwind else path.solution
            if not np.isnan(path.fold):
                self.folded = True
                return None
        return None

    def sharpened(self, rough: Discrete, charge: bool, predicted: bool, slack: float) -> Discrete | None:
        """An order-4 solution from an upwind one, on a mesh fine enough for it."""
        problem, nodes = self.problem(charge=charge, predicted=predicted, slack=slack), _UPWIND
        while nodes < _FINEST:
            s = remesh(rough.s, rough.y, nodes)
            better = newton(replace(problem, upwind=True), s, interpolate(rough.s, rough.y, s))
            if not better.converged:
                break
            found = newton(problem, s, better.y)
            if found.converged:
                return found
            rough, nodes = better, 2 * nodes
        return None

    def with_relaxation(self, found: Discrete, predicted: bool = True) -> tuple[Discrete | None, bool]:
        """The solution with charge relaxation resolved where it matters; None where Newton's method does not go there."""
        quick = self.problem(charge=False, predicted=predicted)
        q = _conducted(quick, found)
        length = 0.5 * quick.parameters[5] * quick.parameters[3] * np.exp(found.y[:, 0])
        lag = float(np.max(np.abs(length * np.gradient(q, found.s))) / np.abs(q).max())
        if lag < _RELAXED:
            return found, False
        full = self.problem(charge=True, predicted=predicted)
        solved = newton(full, found.s, np.column_stack((found.y, _conducted(full, found))))
        return (solved if solved.converged else None), True

    def impose_current(self, charge: bool, found: Discrete) -> Path:
        """From the predicted current to the given one; the needle's potential then comes out."""
        target = self.problem(charge=charge, predicted=False)
        given = target.left[target.left[:, 0] == 3, 1][0]
        predicted = float(found.y[0, 3])

        def at(t: float) -> Problem:
            left = target.left.copy()
            left[left[:, 0] == 3, 1] = predicted + t * (given - predicted)
            return replace(target, left=left)

        return follow(at, found)

    def refined(self, found: Discrete, charge: bool, tolerance: float) -> Solved:
        """The solution on meshes fine enough, with its error from the last halving."""
        problem = self.problem(charge=charge, predicted=False)
        nodes, fine = 201, found
        result = Solved(problem, found, dict.fromkeys(("radius", "current", "tension"), np.inf), "mesh")
        while True:
            s = remesh(fine.s, fine.y, nodes)
            coarse = newton(problem, s, interpolate(fine.s, fine.y, s))
            fine = newton(problem, halved(s), interpolate(s, coarse.y, halved(s))) if coarse.converged else coarse
            if fine.converged:
                error = errors_of(problem, fine) or _moved(problem, coarse, fine)
                worst = max(error["radius"], error["current"])
                result = Solved(problem, fine, error, "mesh" if worst * 15 > 0.005 else "")
                if worst <= tolerance:
                    return result
                nodes = int(min(max(1.5, 1.3 * (worst / tolerance) ** 0.25), 4.0) * nodes)
            else:
                fine, nodes = (result.discrete if np.isfinite(result.error["radius"]) else found), 2 * nodes
            if 2 * nodes > _FINEST:
                return result


def thins(problem: Problem, found: Discrete) -> bool:
    """Whether a solution thins and is under tension everywhere, to rounding.

    A jet whose end has the plate's potential gives its charge up there and may thicken: it thins up to `PLATE`.
    """
    slope, told = rates(found.y, problem.field(found.s), problem.parameters, problem.flags)
    rate, tension = slope[:, 0], told[:, 2]
    if not problem.parameters[13] > 0:
        rate = rate[found.s < PLATE * problem.end]
    return bool(tension.min() > 0 and rate.min() > -_FLAT * max(1.0, float(rate.max())))


def errors_of(problem: Problem, fine: Discrete) -> dict[str, float] | None:
    """Errors at four places an interval, by two Newton steps on twice the mesh (one matrix); None where these lead nowhere.

    Halving the mesh once more, and no extrapolation of what the last halving changed: where the unknowns bend sharply the
    cubics between the nodes are not in their asymptotic range, and a fifteenth of the last change may be 0.4 of the error.
    """
    curve, _ = spline(problem, fine)
    s = halved(fine.s)
    y = curve(s)
    system = Linear(problem, s, y)
    if not system.ok:
        return None
    y = y + system.solve(-system.value)
    y = y + system.solve(-system.residual(y))
    # two steps may leave where the equations mean anything
    if not (
        np.isfinite(y).all() and np.isfinite(rates(y, problem.field(s), problem.parameters, problem.flags)[0]).all()
    ):
        return None
    at = halved(s)
    return _sizes(spline(problem, Discrete(s, y))[0](at) - curve(at), fine)


def _moved(problem: Problem, coarse: Discrete, fine: Discrete) -> dict[str, float]:
    """Errors by what the last halving changed, order 4."""
    at = halved(fine.s)
    return _sizes((spline(problem, fine)[0](at) - spline(problem, coarse)[0](at)) / 15, fine)


def _sizes(change: FloatArray, fine: Discrete) -> dict[str, float]:
    change = np.abs(change)
    return {
        "radius": 0.5 * float(change[:, 0].max()),
        "current": float(change[0, 3]),
        "tension": float(change[:, 1].max() / np.abs(fine.y[:, 1]).max()),
    }


def solve(
    settings: NeedleSettings, *, tolerance: float = 1e-6, near: Solved | None = None, work: int = _WORK
) -> Solved:
    """Steady jet of the settings, or why there is none.

    Parameters
    ----------
    settings : NeedleSettings
        What is asked.
    tolerance : float
        Error of the radius (relative) and of the current to which the mesh is refined.
    near : Solved, optional
        Solution of a neighbouring setting: tried first (a sweep).
    work : int
        Nodes times linear systems allowed; 200,000 are about a second. With 400,000 jets are lost.
    """
    search = _Search(settings, work)
    found, charge, direct = None, True, False
    try:
        if near is not None:
            found, direct = _from_neighbour(settings, near, Work(work // 4))
            charge = near.problem.charge
            if found is not None and not charge:
                found, charge = search.with_relaxation(found, predicted=False)
            if found is not None and end_pull(search.problem(charge=charge, predicted=False), found).rules:
                found, direct = None, False  # its end makes it: perhaps another thread is there
    except OutOfWork:
        pass
    try:
        if found is None:
            found, charge = search.primary()
        if found is not None:
            # refinement has work of its own: the search may have used all
            search.work.left = max(search.work.left, work // 3)
            return replace(search.refined(found, charge, tolerance), time_share=search.time_share, direct=direct)
    except OutOfWork:
        pass
    why = "fold" if search.folded else "lost"
    return Solved(search.last_problem, search.last, {}, why, search.pull, search.time_share)


def raise_pull(
    settings: NeedleSettings,
    *,
    charge: bool,
    predicted: bool,
    slack: float = 1.0,
    nodes: int = _COARSE,
    upwind: bool = False,
    work: Work | None = None,
) -> tuple[Path, float]:
    """Follow the jet from a thread without forces to the settings; the path, and the pull it started from."""
    n, chi = settings.numbers, settings.numbers["slenderness"]
    electric = n["pull"] * (settings.gap / settings.radius) ** 2  # eps_0 V^2 over the unit of force
    forces = max(electric, 1 / n["capillary"], chi * n["reynolds"] * abs(n["inverse_froude"]))
    least = min(1.0, _LEAST_PULL / (chi * forces))

    def at(t: float) -> Problem:
        pull = float(least ** (1 - t))
        problem = settings.problem(charge=charge, predicted=predicted, pull=pull, slack=slack, work=work)
        return replace(problem, upwind=upwind)

    try:
        start = _unpulled(at(0.0), nodes)
    except OutOfWork:
        start = Discrete(*_EMPTY)
    if not start.converged:
        return Path(start, False, 0.0, np.nan, 0), least
    return follow(at, start, beyond_folds=True), least


def _unpulled(problem: Problem, nodes: int) -> Discrete:
    """The thread that nothing pulls: nearly a cylinder."""
    p, end = problem.parameters, problem.end
    s = end * np.expm1(np.linspace(0, np.log(1e5), nodes)) / np.expm1(np.log(1e5))
    y = np.zeros((nodes, problem.size))
    y[:, 0] = s * p[12]
    y[:, 1] = 3 * p[12]
    start = {int(index): value for index, value in problem.left}
    psi, log_current = _charge(problem, s, y[:, 0], start.get(3))
    y[:, 2], y[:, 3] = psi, log_current
    if problem.charge:
        y[:, -1] = _conducted(problem, Discrete(s, y))
    return newton(problem, s, y)


def _charge(problem: Problem, s: FloatArray, u: FloatArray, given: float | None) -> tuple[FloatArray, float]:
    """Psi and ln i on a given shape: ``Psi' = E_ext - i V + Pe V^2 Psi / l``, linear, marched back from the end."""
    p, field, v = problem.parameters, problem.field(s), np.exp(u)
    rate = p[3] * v**2 / (p[6] + (0.5 * u if problem.local else 0.0))
    free, carried = np.empty_like(s), np.empty_like(s)
    free[-1], carried[-1] = -p[13] / rate[-1], v[-1] / rate[-1]
    for j in range(s.size - 2, -1, -1):
        h = s[j + 1] - s[j]
        g = 0.5 * h * (rate[j] + rate[j + 1])
        decay, mean = np.exp(-g), -np.expm1(-g) / g if g > 1e-12 else 1.0
        free[j] = free[j + 1] * decay - 0.5 * h * (field[j] + field[j + 1]) * mean
        carried[j] = carried[j + 1] * decay + 0.5 * h * (v[j] + v[j + 1]) * mean
    current = max(-free[0] / carried[0], 1e-300) if given is None else float(np.exp(given))
    return free + current * carried, float(np.log(current))


def _from_neighbour(settings: NeedleSettings, near: Solved, work: Work) -> tuple[Discrete | None, bool]:
    """A coarse solution from a neighbour's, and whether Newton's method went straight there.

    Where it does not, or the solution changes so much that another branch may have been met, the path between the two
    settings is followed in bounded steps.
    """
    problem = settings.problem(charge=near.problem.charge, predicted=False, work=work)
    if problem.size != near.discrete.y.shape[1] or not near.discrete.converged:
        return None, False
    s = near.discrete.s * (problem.end / near.problem.end)
    mesh = remesh(s, near.discrete.y, _COARSE)
    start = interpolate(s, near.discrete.y, mesh)
    found = newton(problem, mesh, start, most=8)
    if found.converged and found.sign == near.discrete.sign and distance(found.y - start, scales(start)) < _NEAR:
        return found, True
    path = between(near.problem, problem)
    if path is None:
        return None, False
    first = newton(path(0.0), mesh, start)
    if not first.converged:
        return None, False
    followed = follow(path, first)
    return (followed.solution if followed.arrived else None), False


def _conducted(problem: Problem, found: Discrete) -> FloatArray:
    """Conducted share q where charge relaxes at once, or nearly so: the first term of the lag where the problem resolves it."""
    p, y = problem.parameters, found.y
    v = np.exp(y[:, 0])
    log = p[6] + (0.5 * y[:, 0] if problem.local else 0.0)
    q: FloatArray = 1 - p[3] * v * y[:, 2] / (log * np.exp(y[:, 3]))
    if problem.charge:
        q = q - 0.5 * p[5] * p[3] * v * np.gradient(q, found.s)
        q[0] = 1.0
    return q


def between(first: Problem, last: Problem) -> Callable[[float], Problem] | None:
    """Path between two problems: parameters and fields in their logarithms; None where laws or slenderness differ."""
    same = first.polymer == last.polymer and first.local == last.local and first.left.shape == last.left.shape
    if not same or not np.array_equal(first.left[:, 0], last.left[:, 0]) or abs(first.end / last.end - 1) > 1e-9:
        return None
    p, q = first.parameters, last.parameters
    both = (p > 0) & (q > 0)

    def at(t: float) -> Problem:
        mixed = np.where(both, 0.0, (1 - t) * p + t * q)
        mixed[both] = np.exp((1 - t) * np.log(p[both]) + t * np.log(q[both]))

        def field(s: FloatArray) -> FloatArray:
            mean: FloatArray = first.field(s) ** (1 - t) * last.field(s) ** t
            return mean

        return replace(last, parameters=mixed, field=field, left=(1 - t) * first.left + t * last.left)

    return at
