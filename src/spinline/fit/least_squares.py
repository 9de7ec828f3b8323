"""Parameters of a jet from what was measured along it: least squares, with covariance and priors, in one go.

Each prior is a row of its own beside the data, whitened by their standard deviations. The posterior is taken as normal in the
coordinates of `spinline.fit.problem`, ``C = (J^T J)^-1``; `spinline.fit.posterior` samples it where that is not good enough,
and a check (`spinline.fit.diagnostics.curvature`) says when.

Robust losses (``"huber"``, ``"cauchy"``, of scale 1.5 standard deviations) act on the data, not on the priors; the covariance
is then the sandwich ``H^-1 S H^-1``.

What to use when: least squares always, first: 60 ms for the affine jet, half a second with relaxation, two with evaporation.
The sampler when a parameter is flagged as not Gaussian.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError, SpinlineWarning
from spinline.fit.diagnostics import examine_fit
from spinline.fit.fitted import Fit
from spinline.fit.model import PARAMETERS, ForwardModel
from spinline.fit.observations import Observation
from spinline.fit.problem import FitProblem

__all__ = ["Fit", "fit", "inverse", "log_likelihood"]

_STEP = 1e-4  # of the coordinates, in differences: central, so the error is of the order 1e-8
_ROUNDS = 6  # looks around the best point: where the jet's onset passes a sample there are small minima
_DOUBT = 0.003  # probability of the chi-squared below which another start is tried
_Z68, _Z95 = 0.994457883209753, 1.959963984540054


def fit(problem: FitProblem, starts: Sequence[Mapping[str, float]] = ()) -> Fit:
    """Least-squares fit of a problem.

    Parameters
    ----------
    problem : FitProblem
    starts : sequence of mapping, optional
        Parameters (SI) to start from beside the priors' centres; the best end counts.

    Returns
    -------
    Fit

    Warns
    -----
    SpinlineWarning
        For what the data do not determine, a bad fit, values at the end of their range, intervals that are not Gaussian.
    """
    calls = 0

    def residuals(u: FloatArray) -> FloatArray:
        nonlocal calls
        calls += 1
        return problem.residuals(u)

    best = _best(problem, residuals, _starts(problem, starts))
    for _ in range(_ROUNDS):
        u = np.asarray(best.x, dtype=np.float64)
        jacobian = _jacobian(residuals, u, problem.bounds)[: problem.size]
        found = np.asarray(residuals(u)[: problem.size])
        covariance = _covariance(problem, jacobian, found)
        better = _better(problem, u, covariance)
        if better is None:
            break
        best = min(best, _solve(problem, residuals, better), key=lambda end: float(end.cost))
    low, high = problem.bounds
    spread = np.sqrt(np.diag(covariance))
    result = Fit(
        problem=problem,
        coordinates=u,
        covariance=covariance,
        values=problem.to_values(u),
        interval68=_interval(problem, u, _Z68 * spread),
        interval95=_interval(problem, u, _Z95 * spread),
        jacobian=jacobian,
        residuals=found,
        chi_squared=float(found @ found),
        degrees_of_freedom=problem.size + int(np.isfinite(problem.prior_std).sum()) - u.size,
        evaluations=calls,
    )
    notes = [*problem.model.notes, *(note for part in problem.data for note in part.notes)]
    if not best.success:
        notes.append(f"least squares stopped before the best point: {best.message}")
    at_end = [n for n, x, a, b in zip(problem.free, u, low, high, strict=True) if min(x - a, b - x) < 1e-6 * (b - a)]
    notes += [f"{name} is at the end of its range ({problem.to_values(u)[name]:g})" for name in at_end]
    notes += examine_fit(result)
    for note in notes:
        warnings.warn(note, SpinlineWarning, stacklevel=2)
    return replace(result, notes=tuple(notes))


def log_likelihood(
    model: ForwardModel, data: Sequence[Observation], values: Mapping[str, float] | None = None
) -> float:
    """Logarithm of the likelihood of a model given data, normal errors, constants included.

    Parameters
    ----------
    model : ForwardModel
    data : sequence of Observation
    values : mapping, optional
        Parameters in place of the model's own, SI.

    Returns
    -------
    float
    """
    shown = model.measured(data, values)
    total = 0.0
    for part, y in zip(data, shown, strict=True):
        residual = part.whiten(part.value - y)
        total += part.log_norm() - 0.5 * float(residual @ residual)
    return total


def _starts(problem: FitProblem, given: Sequence[Mapping[str, float]]) -> list[FloatArray]:
    """Priors' centres, what the caller gives, the power law through the radii; rates scanned where nothing is known."""
    base = {name: prior.value for name, prior in problem.free.items()}
    found = [base, *({**base, **{k: v for k, v in start.items() if k in base}} for start in given)]
    found += [{**base, **through} for through in _through_radii(problem)]
    for name in ("relaxation_time", "evaporation"):
        prior = problem.free.get(name)
        if prior is not None and not prior.std <= prior.value:
            nearest = found[-1]
            found += [{**nearest, name: prior.value * factor} for factor in (0.03, 0.3, 3.0, 30.0)]
    low, high = problem.bounds
    # a start on a bound has no room for differences
    inside = [np.clip(problem.to_coordinates(s), low + 1e-3 * (high - low), high - 1e-3 * (high - low)) for s in found]
    order = np.argsort([-problem.log_posterior(u) for u in inside], kind="stable")
    return [inside[i] for i in order[:3]]


def _best(problem: FitProblem, residuals: Callable[[FloatArray], FloatArray], starts: list[FloatArray]) -> Any:
    """Least squares from the best start; from the others too where that does not fit, or a rate has no prior."""
    from scipy.stats import chi2

    best = _solve(problem, residuals, starts[0])
    open_rate = any(
        n in problem.free and not np.isfinite(problem.free[n].std) for n in ("relaxation_time", "evaporation")
    )
    if open_rate or chi2.sf(2 * float(best.cost), max(problem.size - len(problem.free), 1)) < _DOUBT:
        others = [u for u in starts[1:] if np.isfinite(problem.log_posterior(u))]
        best = min([best, *(_solve(problem, residuals, u) for u in others)], key=lambda end: float(end.cost))
    return best


def _better(problem: FitProblem, u: FloatArray, covariance: FloatArray) -> FloatArray | None:
    """Best of the points one and two standard deviations off in every parameter, if it beats the middle."""
    here = problem.log_posterior(u)
    points = [
        u + reach * covariance[:, i] / np.sqrt(covariance[i, i])
        for i in range(u.size)
        if np.isfinite(covariance[:, i]).all() and covariance[i, i] > 0
        for reach in (-2.0, -1.0, 1.0, 2.0)
    ]
    values = [problem.log_posterior(point) for point in points]
    if not values or max(values) <= here + 1e-3:
        return None
    best: FloatArray = points[int(np.argmax(values))]
    return best


def _through_radii(problem: FitProblem) -> list[dict[str, float]]:
    """K and beta of the power law through the measured radii, if they are wanted and one can be fitted."""
    from spinline.jetprofile.fit import fit_power_law

    wanted = {"k", "beta"} & set(problem.free)
    parts = [part for part in problem.data if part.kind == "radius"]
    if not wanted or not parts:
        return []
    z, r, std = (np.concatenate([getattr(part, name) for part in parts]) for name in ("z", "value", "std"))
    r0 = (
        problem.free["initial_radius"].value
        if "initial_radius" in problem.free
        else problem.model.values["initial_radius"]
    )
    beyond = (z > 0) & (r < 0.97 * r0)  # the plateau before the onset is no power law
    if beyond.sum() < 6 or np.ptp(z[beyond]) == 0:
        return []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        law = fit_power_law(z[beyond], r[beyond], std[beyond], initial_radius=r0)
    if not (0.25 <= law.beta <= 1 and PARAMETERS["k"].low < law.k < PARAMETERS["k"].high):
        return []
    return [{name: getattr(law, name) for name in wanted}]


def _solve(problem: FitProblem, residuals: Callable[[FloatArray], FloatArray], start: FloatArray) -> Any:
    from scipy.optimize import least_squares

    bounds = problem.bounds
    loss: Any = "linear" if problem.loss == "gauss" else problem.rho
    rows = residuals(start).size  # a start that the model refuses is refused

    def tried(u: FloatArray) -> FloatArray:
        try:
            return residuals(u)
        except InputError:  # such a step is made shorter
            return np.full(rows, np.inf)

    def slopes(u: FloatArray) -> FloatArray:
        return _jacobian(residuals, u, bounds, central=False)

    return least_squares(
        tried,
        start,
        jac=slopes,
        bounds=bounds,
        loss=loss,
        xtol=1e-7,
        ftol=1e-9,
        gtol=1e-9,
        max_nfev=200,
    )


def _jacobian(
    residuals: Callable[[FloatArray], FloatArray],
    u: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
    *,
    central: bool = True,
) -> FloatArray:
    """Differences of the residuals, central where there is room, one-sided at a bound (or if not `central`)."""
    here = None if central else residuals(u)
    columns = []
    for i in range(u.size):
        step = np.zeros_like(u)
        step[i] = _STEP if central else 1e-2 * _STEP
        room = u[i] + step[i] <= bounds[1][i], u[i] - step[i] >= bounds[0][i]
        if central and all(room):
            try:
                columns.append((residuals(u + step) - residuals(u - step)) / (2 * step[i]))
                continue
            except InputError:  # no jet on one side
                pass
        here = residuals(u) if here is None else here
        side = 1.0 if room[0] else -1.0
        try:
            columns.append(side * (residuals(u + side * step) - here) / step[i])
        except InputError:
            if not all(room):
                raise
            columns.append((here - residuals(u - side * step)) / (side * step[i]))
    return np.stack(columns, axis=1)


def _covariance(problem: FitProblem, jacobian: FloatArray, residuals: FloatArray) -> FloatArray:
    """Covariance of the coordinates, inf along directions that neither data nor priors determine."""
    weight = problem.rho(residuals**2)[1]
    prior = np.diag(problem.prior_std**-2)
    if problem.loss == "gauss":
        return inverse(jacobian.T @ jacobian + prior)
    gained = jacobian * (weight * residuals)[:, np.newaxis]
    curvature = jacobian * np.maximum(weight + 2 * problem.rho(residuals**2)[2] * residuals**2, 0.0)[:, np.newaxis]
    bread = inverse(jacobian.T @ curvature + prior)
    if not np.isfinite(bread).all():
        return bread
    value: FloatArray = bread @ (gained.T @ gained + prior) @ bread
    return value


def inverse(precision: FloatArray) -> FloatArray:
    """Inverse of a precision matrix; variances are inf where an eigenvalue vanishes to rounding."""
    size, vectors = np.linalg.eigh(precision)
    least = max(float(size.max()), 1e-30) * 1e-12
    lost = size <= least
    kept = vectors[:, ~lost]
    covariance: FloatArray = (kept / size[~lost]) @ kept.T
    touched = (np.abs(vectors[:, lost]) > 1e-4).any(axis=1)
    covariance[touched, touched] = np.inf
    return covariance


def _interval(problem: FitProblem, u: FloatArray, reach: FloatArray) -> dict[str, tuple[float, float]]:
    """Intervals in SI, cut at the ends of the ranges."""
    low, high = problem.bounds
    ends = problem.to_values(np.maximum(u - reach, low)), problem.to_values(np.minimum(u + reach, high))
    return {name: (ends[0][name], ends[1][name]) for name in problem.free}
