"""Parameters of a jet from what was measured along it: least squares, with covariance and priors, in one go.

Positive parameters are fitted as logarithms, beta and the origin as they are. A prior ``value +/- std`` is a row of its own: normal
in the coordinate, hence log-normal for what is positive, with relative width std/value. The posterior is taken as normal in
these coordinates, ``C = (J^T J)^-1`` with the data whitened by their standard deviations; `spinline.posterior` samples it where that is not
good enough, and a check (`curvature`) says when.

Robust losses (``"huber"``, ``"cauchy"``, of scale 1.5 standard deviations) act on the data, not on the priors; the covariance is then the
sandwich ``H^-1 S H^-1``.

What to use when: least squares always, first; 5 to 500 ms. The sampler when a parameter is flagged as not Gaussian.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from spinline.checks import FloatArray
from spinline.errors import InputError, SpinlineWarning
from spinline.fit_model import PARAMETERS, ForwardModel
from spinline.observations import Observation

__all__ = ["Fit", "FitProblem", "Loss", "Prior", "fit", "log_likelihood"]

Loss = Literal["gauss", "huber", "cauchy"]
_ROBUST = 1.5  # standard deviations, scale of the robust losses
_STEP = 1e-4  # of the coordinates, in differences: central, so the error is of the order 1e-8
_Z68, _Z95 = 0.994457883209753, 1.959963984540054


@dataclass(frozen=True)
class Prior:
    """What is known of a parameter beforehand, SI.

    Attributes
    ----------
    value : float
        Where to start, and the prior's centre.
    std : float
        Standard deviation; inf for a parameter of which nothing is known.
    """

    value: float
    std: float = np.inf


@dataclass(frozen=True, eq=False)
class FitProblem:
    """Model, data, and what is fitted.

    Attributes
    ----------
    model : ForwardModel
    data : tuple of Observation
    free : mapping
        Parameter name to `Prior`, in the order of the results.
    loss : {"gauss", "huber", "cauchy"}
    title : str
    """

    model: ForwardModel
    data: tuple[Observation, ...]
    free: Mapping[str, Prior]
    loss: Loss = "gauss"
    title: str = ""

    def __post_init__(self) -> None:
        if not self.data:
            raise InputError("data", "is empty", remedy="add a [[data]] table with path and kind")
        if not self.free:
            raise InputError("parameters", "has nothing to fit", remedy='for example k = "free" in [parameters]')
        if self.loss not in get_args(Loss):
            raise InputError("loss", "is not known", value=self.loss, allowed=", ".join(get_args(Loss)))
        for name, prior in self.free.items():
            if name not in PARAMETERS:
                raise InputError(name, "is not a parameter", allowed=", ".join(PARAMETERS))
            if name not in self.model.names:
                raise InputError(f"parameters.{name}", "changes nothing in this model", allowed=", ".join(self.model.names),
                                 remedy="take it out")  # fmt: skip
            kind = PARAMETERS[name]
            if not kind.low <= prior.value <= kind.high:
                raise InputError(f"parameters.{name}", "is out of range", value=prior.value,
                                 allowed=f"[{kind.low:g}, {kind.high:g}]")  # fmt: skip
            if not prior.std > 0:
                raise InputError(f"parameters.{name}", "has no usable uncertainty", value=prior.std, allowed="(0, inf)",
                                 remedy="leave +/- out to hold it fixed")  # fmt: skip
        known = sum(np.isfinite(prior.std) for prior in self.free.values())
        if self.size + known < len(self.free):
            raise InputError(
                "data", f"holds {self.size} value(s) and {known} prior(s) for {len(self.free)} free parameters",
                value=", ".join(self.free), remedy="fix parameters, give priors (value +/- std), or add data",
            )  # fmt: skip
        for part in self.data:
            _within_jet(part, self.model, self.free)

    @property
    def size(self) -> int:
        """Number of values."""
        return sum(part.size for part in self.data)

    @property
    def names(self) -> tuple[str, ...]:
        """Free parameters."""
        return tuple(self.free)

    @property
    def scale(self) -> FloatArray:
        """What is a change of order one of each coordinate."""
        r0 = self.model.values["initial_radius"]
        return np.array([r0 if name == "origin" else PARAMETERS[name].scale for name in self.free])

    def to_values(self, coordinates: FloatArray) -> dict[str, float]:
        """Parameters (SI) of coordinates."""
        pairs = zip(self.free, coordinates * self.scale, strict=True)
        return {name: float(np.exp(u)) if PARAMETERS[name].log else float(u) for name, u in pairs}

    def to_coordinates(self, values: Mapping[str, float]) -> FloatArray:
        """Coordinates, in units of `scale`, of parameters (SI)."""
        plain = [np.log(values[name]) if PARAMETERS[name].log else values[name] for name in self.free]
        return np.array(plain) / self.scale

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest coordinates."""
        return (
            self.to_coordinates({name: PARAMETERS[name].low for name in self.free}),
            self.to_coordinates({name: PARAMETERS[name].high for name in self.free}),
        )

    @property
    def prior_std(self) -> FloatArray:
        """Standard deviations of the priors in coordinates; inf where there is none."""
        widths = [p.std / p.value if PARAMETERS[name].log else p.std for name, p in self.free.items()]
        return np.array(widths) / self.scale

    @property
    def prior_mean(self) -> FloatArray:
        """Centres of the priors in coordinates."""
        return self.to_coordinates({name: prior.value for name, prior in self.free.items()})

    def data_residuals(self, coordinates: FloatArray) -> FloatArray:
        """Whitened residuals of the data, measured minus predicted."""
        shown = self.model.measured(self.data, self.to_values(coordinates))
        return np.concatenate([part.whiten(part.value - y) for part, y in zip(self.data, shown, strict=True)])

    def residuals(self, coordinates: FloatArray) -> FloatArray:
        """Those of the data, then one of each parameter's prior (0 where there is none)."""
        return np.concatenate((self.data_residuals(coordinates), (coordinates - self.prior_mean) / self.prior_std))

    def log_posterior(self, coordinates: FloatArray) -> float:
        """Unnormalised logarithm of the posterior density in coordinates; -inf out of range."""
        low, high = self.bounds
        if not ((coordinates >= low) & (coordinates <= high)).all():
            return -np.inf
        try:
            squares = self.residuals(coordinates) ** 2
        except InputError:  # a corner of the range that the model refuses has no probability
            return -np.inf
        return float(-0.5 * self._rho(squares)[0].sum())

    def simulate(self, values: Mapping[str, float], rng: np.random.Generator) -> "FitProblem":
        """The same problem with data drawn from the model at `values`, with the standard deviations of the data."""
        shown = self.model.measured(self.data, values)
        drawn = []
        for part, y in zip(self.data, shown, strict=True):
            noise = rng.standard_normal(part.size)
            if part.covariance is not None:
                factor = np.linalg.cholesky(part.covariance)
                noise = (factor @ noise.reshape(*factor.shape[:2], 1)).ravel()
            else:
                noise = noise * part.std
            drawn.append(replace(part, value=y + noise))
        return replace(self, data=tuple(drawn))

    def draw_prior(self, rng: np.random.Generator) -> dict[str, float]:
        """Parameters drawn from the priors, within their ranges; those without a prior at their start."""
        low, high = self.bounds
        width = np.where(np.isfinite(self.prior_std), self.prior_std, 0.0)
        for _ in range(10_000):
            u = self.prior_mean + width * rng.standard_normal(len(self.free))
            if ((u >= low) & (u <= high)).all():
                return self.to_values(u)
        raise InputError("parameters", "have priors that lie outside their ranges", remedy="check the priors")

    def _rho(self, squares: FloatArray) -> FloatArray:
        """Loss of squared residuals and its two derivatives, (3, n): the robust one for the data, none for priors."""
        rho = np.stack((squares, np.ones_like(squares), np.zeros_like(squares)))
        if self.loss == "gauss":
            return rho
        z = squares[: self.size] / _ROBUST**2
        if self.loss == "huber":
            root = np.sqrt(np.maximum(z, 1.0))
            rho[0, : self.size] = _ROBUST**2 * np.where(z > 1, 2 * root - 1, z)
            rho[1, : self.size] = 1 / root
            rho[2, : self.size] = np.where(z > 1, -0.5 * root**-3, 0.0) / _ROBUST**2
        else:
            rho[0, : self.size] = _ROBUST**2 * np.log1p(z)
            rho[1, : self.size] = 1 / (1 + z)
            rho[2, : self.size] = -((1 + z) ** -2) / _ROBUST**2
        return rho


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted problem; arrays over the free parameters (p,), in their order.

    Attributes
    ----------
    problem : FitProblem
    coordinates, covariance : ndarray, (p,) and (p, p)
        Best coordinates and their covariance (inf along directions that nothing determines).
    values : dict
        Best parameters, SI.
    interval68, interval95 : dict
        Parameter name to (low, high), SI.
    jacobian : ndarray, (n, p)
        Of the whitened data residuals.
    residuals : ndarray, (n,)
        Of the data, whitened.
    chi_squared : float
        Sum of their squares.
    degrees_of_freedom : int
        Values plus priors minus parameters.
    evaluations : int
        Of the model.
    notes : tuple of str
        Warnings, also given as such.
    """

    problem: FitProblem
    coordinates: FloatArray
    covariance: FloatArray
    values: dict[str, float]
    interval68: dict[str, tuple[float, float]]
    interval95: dict[str, tuple[float, float]]
    jacobian: FloatArray
    residuals: FloatArray
    chi_squared: float
    degrees_of_freedom: int
    evaluations: int
    notes: tuple[str, ...] = ()

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of each parameter, SI, to first order."""
        spread = np.sqrt(np.diag(self.covariance)) * self.problem.scale
        return {
            name: float(s * (self.values[name] if PARAMETERS[name].log else 1.0))
            for name, s in zip(self.problem.free, spread, strict=True)
        }

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the coordinates, (p, p); NaN where a variance is infinite."""
        sd = np.sqrt(np.diag(self.covariance))
        with np.errstate(invalid="ignore"):
            value: FloatArray = self.covariance / np.outer(sd, sd)
        return value


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
    from spinline.fit_checks import examine_fit

    calls = 0

    def residuals(u: FloatArray) -> FloatArray:
        nonlocal calls
        calls += 1
        return problem.residuals(u)

    best = min((_solve(problem, residuals, u) for u in _starts(problem, starts)), key=lambda end: float(end.cost))
    u = np.asarray(best.x, dtype=np.float64)
    jacobian = _jacobian(residuals, u, problem.bounds)[: problem.size]
    found = np.asarray(residuals(u)[: problem.size])
    covariance = _covariance(problem, jacobian, found)
    low, high = problem.bounds
    spread = np.sqrt(np.diag(covariance))
    result = Fit(
        problem=problem, coordinates=u, covariance=covariance, values=problem.to_values(u),
        interval68=_interval(problem, u, _Z68 * spread), interval95=_interval(problem, u, _Z95 * spread),
        jacobian=jacobian, residuals=found, chi_squared=float(found @ found),
        degrees_of_freedom=problem.size + int(np.isfinite(problem.prior_std).sum()) - u.size, evaluations=calls,
    )  # fmt: skip
    notes = [*problem.model.notes, *(note for part in problem.data for note in part.notes)]
    if not best.success:
        notes.append(f"least squares stopped before the best point: {best.message}")
    at_end = [n for n, x, a, b in zip(problem.free, u, low, high, strict=True) if min(x - a, b - x) < 1e-6 * (b - a)]
    notes += [f"{name} is at the end of its range ({problem.to_values(u)[name]:g})" for name in at_end]
    notes += examine_fit(result)
    for note in notes:
        warnings.warn(note, SpinlineWarning, stacklevel=2)
    return replace(result, notes=tuple(notes))


def log_likelihood(model: ForwardModel, data: Sequence[Observation], values: Mapping[str, float] | None = None) -> float:
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
    if len(inside) <= 3:
        return inside
    ranked = sorted(inside, key=lambda u: -problem.log_posterior(u))
    return ranked[:3]


def _through_radii(problem: FitProblem) -> list[dict[str, float]]:
    """K and beta of the power law through the measured radii, if they are wanted and one can be fitted."""
    from spinline.jetprofile.fit import fit_power_law

    wanted = {"k", "beta"} & set(problem.free)
    parts = [part for part in problem.data if part.kind == "radius"]
    if not wanted or not parts:
        return []
    z, r, std = (np.concatenate([getattr(part, name) for part in parts]) for name in ("z", "value", "std"))
    r0 = problem.free["initial_radius"].value if "initial_radius" in problem.free else problem.model.values["initial_radius"]
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
    loss: Any = "linear" if problem.loss == "gauss" else problem._rho
    return least_squares(
        residuals, start, jac=lambda u: _jacobian(residuals, u, bounds, central=False), bounds=bounds, loss=loss,
        xtol=1e-10, ftol=1e-12, gtol=1e-10, max_nfev=200,
    )  # fmt: skip


def _jacobian(
    residuals: Callable[[FloatArray], FloatArray], u: FloatArray, bounds: tuple[FloatArray, FloatArray], *,
    central: bool = True,
) -> FloatArray:  # fmt: skip
    """Differences of the residuals, central where there is room, one-sided at a bound (or if not `central`)."""
    here = None if central else residuals(u)
    columns = []
    for i in range(u.size):
        step = np.zeros_like(u)
        step[i] = _STEP if central else 1e-2 * _STEP
        room = u[i] + step[i] <= bounds[1][i], u[i] - step[i] >= bounds[0][i]
        if central and all(room):
            columns.append((residuals(u + step) - residuals(u - step)) / (2 * step[i]))
            continue
        here = residuals(u) if here is None else here
        side = 1.0 if room[0] else -1.0
        columns.append(side * (residuals(u + side * step) - here) / step[i])
    return np.stack(columns, axis=1)


def _covariance(problem: FitProblem, jacobian: FloatArray, residuals: FloatArray) -> FloatArray:
    """Covariance of the coordinates, inf along directions that neither data nor priors determine."""
    weight = problem._rho(residuals**2)[1]
    prior = np.diag(problem.prior_std**-2)
    if problem.loss == "gauss":
        return inverse(jacobian.T @ jacobian + prior)
    gained = jacobian * (weight * residuals)[:, np.newaxis]
    curvature = jacobian * np.maximum(weight + 2 * problem._rho(residuals**2)[2] * residuals**2, 0.0)[:, np.newaxis]
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


def _within_jet(data: Observation, model: ForwardModel, free: Mapping[str, Prior]) -> None:
    """Refuse values beyond the jet; before the nozzle only as far as the origin is uncertain."""
    scale, origin = model.values["length_scale"], model.values["origin"]
    shift = free["origin"] if "origin" in free else Prior(origin, 0.0)
    stretch = free["length_scale"] if "length_scale" in free else Prior(scale, 0.0)
    centre = shift.value
    slack = 3 * (shift.std if np.isfinite(shift.std) else model.values["initial_radius"] * 10)
    slack += 3 * (stretch.std / stretch.value if np.isfinite(stretch.std) else 1.0) * model.length
    low, high = centre - slack, centre + stretch.value * model.length * (1 + 1e-9) + slack
    bad = (data.z < low) | (data.z > high)
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        raise InputError(
            f"{data.source}: z", f"is beyond the jet at row {row + 1}" + (f", and {int(bad.sum()) - 1} more" if bad.sum() > 1 else ""),
            value=float(data.z[row]), allowed=f"[{low:.4g}, {high:.4g}] m",
            remedy="raise jet.length in the scene, give origin, or leave rows out with z_range",
        )  # fmt: skip
