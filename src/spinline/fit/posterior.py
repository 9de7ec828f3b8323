"""The posterior of a fit: draws, sampling by emcee, and bands of what the jet looks like.

`gaussian_draws` takes the least-squares covariance at its word and costs nothing. `sample` runs the ensemble of emcee
(extra ``fit``), which needs no Gaussian, until the chain is `LENGTHS` autocorrelation times long or the steps are used up:
some 3e4 evaluations of the model, so ten seconds for the affine jet, minutes with relaxation. How many
independent draws that made is in the result, with a warning where they are too few. Everything follows from the seed.

References
----------
Goodman, Weare, Comm. App. Math. Comp. Sci. 5, 65 (2010); Foreman-Mackey, Hogg, Lang, Goodman, PASP 125, 306 (2013).
"""

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray, number
from spinline.base.errors import InputError, SpinlineWarning
from spinline.network.crossover import crossover_velocity_ratio
from spinline.network_models.registry import rung_of

if TYPE_CHECKING:
    import xarray as xr

    from spinline.fit.fitted import Fit
    from spinline.fit.model import Prediction

__all__ = ["LEVELS", "Posterior", "bands", "gaussian_draws", "predictive", "sample", "stored_draws"]

LENGTHS = 50  # autocorrelation times: what emcee's authors ask for
LEVELS = (0.025, 0.16, 0.5, 0.84, 0.975)
_BANDS = {
    "radius": ("m", "jet radius"),
    "mean_polymer_fraction": ("1", "polymer volume fraction, mean of the cross-section"),
    "core_polymer_fraction": ("1", "polymer volume fraction of the core, held at 1"),
    "network_radius": ("m", "radius of the polymer network, Eq. (39)"),
    "relative_extension": ("1", "extension of the strands over their contour"),
    "orientation": ("1", "Hermans orientation of the segments"),
}
_CROSSOVER = {
    "crossover_position": ("m", "where the strands are fully stretched, Eq. (38); NaN: beyond the end"),
    "crossover_radius": ("m", "jet radius there; of the draws that reach it"),
}
_FAR = 1e200
_DRAWS, _FEW_DRAWS = 400, 100  # of the posterior, for bands
_NOISES = 32  # quantiles of the noise that go with every draw
_AT_ONCE = 200  # data


@dataclass(frozen=True, eq=False)
class Posterior:
    """Draws from a posterior.

    Attributes
    ----------
    draws : ndarray, (n, p)
        Coordinates.
    autocorrelation : ndarray, (p,)
        Integrated autocorrelation times, steps.
    steps, discarded : int
        Steps of the chain, and those left out at its start.
    walkers : int
    acceptance : float
        Mean share of accepted moves; 0.2 to 0.5 is healthy.
    effective : float
        Independent draws, for the slowest parameter.
    converged : bool
        The chain is `LENGTHS` autocorrelation times long.
    seed : int
    notes : tuple of str
    """

    draws: FloatArray
    autocorrelation: FloatArray
    steps: int
    discarded: int
    walkers: int
    acceptance: float
    effective: float
    converged: bool
    seed: int
    notes: tuple[str, ...] = ()

    def interval(self, column: int, probability: float) -> tuple[float, float]:
        """Central interval of one coordinate."""
        low, high = np.quantile(self.draws[:, column], [0.5 - probability / 2, 0.5 + probability / 2])
        return float(low), float(high)


def gaussian_draws(fit: "Fit", count: int = 400, seed: int = 0) -> FloatArray:
    """Coordinates drawn from the normal posterior of least squares, those out of range drawn again.

    Parameters
    ----------
    fit : Fit
    count : int
    seed : int

    Returns
    -------
    ndarray, (count, p)

    Raises
    ------
    InputError
        Where the covariance is infinite, or nearly all draws are out of range.
    """
    if not np.isfinite(fit.covariance).all():
        open_ = [n for n, v in zip(fit.problem.free, np.diag(fit.covariance), strict=True) if not np.isfinite(v)]
        raise InputError(
            "parameters",
            "are not identified, so there is nothing to draw",
            value=", ".join(open_),
            remedy="give priors, or fix them",
        )
    rng = np.random.default_rng(seed)
    size, vectors = np.linalg.eigh(fit.covariance)
    factor = vectors * np.sqrt(np.maximum(size, 0.0))
    low, high = fit.problem.bounds
    kept: list[FloatArray] = []
    for _ in range(100 * count):
        u = fit.coordinates + factor @ rng.standard_normal(low.size)
        if ((u >= low) & (u <= high)).all():
            kept.append(u)
            if len(kept) == count:
                return np.array(kept)
    raise InputError("parameters", "have intervals that lie outside their ranges", remedy="give priors, or fix them")


def sample(
    fit: "Fit", *, seed: int = 0, walkers: int | None = None, steps: int = 4000, check_every: int = 200
) -> Posterior:
    """Sample the posterior with emcee, started around the least-squares fit.

    Parameters
    ----------
    fit : Fit
    seed : int
        Of everything random.
    walkers : int, optional
        Default four for each parameter, at least 16.
    steps : int
        Most steps of every walker.
    check_every : int
        Steps between looks at the autocorrelation.

    Returns
    -------
    Posterior

    Raises
    ------
    InputError
        If emcee is not installed, or the numbers make no chain.

    Warns
    -----
    SpinlineWarning
        Where the chain is too short.
    """
    try:
        import emcee
    except ImportError:
        raise InputError(
            "sampler", "needs emcee, which is not installed", value="emcee", remedy='pip install "spinline[fit]"'
        ) from None
    problem = fit.problem
    p = len(problem.free)
    team = max(16, 4 * p) if walkers is None else int(number("walkers", walkers, least=2 * p))
    most, every = int(number("steps", steps, least=10)), int(number("check_every", check_every, least=1))
    rng = np.random.default_rng(seed)
    start = _start(fit, team, rng)
    moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]  # half the autocorrelation of the default
    sampler = emcee.EnsembleSampler(team, p, problem.log_posterior, moves=moves)
    sampler._random = np.random.RandomState(rng.integers(2**32))
    state: Any = start
    taken, converged = 0, False
    tau = np.full(p, np.nan)
    while taken < most and not converged:
        portion = min(every, most - taken)
        state = sampler.run_mcmc(state, portion, progress=False)
        taken += portion
        tau = np.asarray(sampler.get_autocorr_time(tol=0), dtype=np.float64)
        converged = bool(np.isfinite(tau).all() and taken > LENGTHS * tau.max())
    slowest = float(tau.max()) if np.isfinite(tau).all() else float(taken)
    burnt = min(int(5 * slowest) + 1, taken // 2)
    draws = np.asarray(sampler.get_chain(discard=burnt, flat=True), dtype=np.float64)
    effective = (taken - burnt) * team / max(slowest, 1.0)
    acceptance = float(np.mean(sampler.acceptance_fraction))
    notes = []
    if not converged:
        notes.append(
            f"the chain is short: {taken} steps for an autocorrelation time of {slowest:.3g} (want {LENGTHS} times as "
            f"many); about {effective:.3g} independent draws"
        )
    if not 0.1 < acceptance < 0.8:
        notes.append(f"the sampler accepts {acceptance:.2g} of its moves; 0.2 to 0.5 is healthy")
    for note in notes:
        warnings.warn(note, SpinlineWarning, stacklevel=2)
    return Posterior(draws, tau, taken, burnt, team, acceptance, effective, converged, seed, tuple(notes))


def bands(fit: "Fit", draws: FloatArray, z: FloatArray | None = None, points: int = 201) -> "xr.Dataset":
    """What the jet looks like, with the uncertainty of the parameters: quantiles along z.

    Parameters
    ----------
    fit : Fit
    draws : ndarray, (n, p)
        Coordinates, from `gaussian_draws` or `Posterior.draws`; 400 are taken, evenly, if there are more (100 of a rung that
        slips).
    z : ndarray, optional
        True distances from the nozzle, m. Default: from the nozzle to the farther of the last value and the jet's length.
    points : int
        Of the default z.

    Returns
    -------
    xarray.Dataset
        Dimensions ``quantile`` (2.5, 16, 50, 84, 97.5 %) and ``z``: true radius, fractions, extension and orientation,
        without calibration and without the noise of a new measurement; ``crossover_position`` and ``crossover_radius`` along
        ``quantile``; and ``_best``, at the best parameters.
    """
    import xarray as xr

    model, problem = fit.problem.model, fit.problem
    if z is None:
        r0 = model.values["initial_radius"]
        z = r0 * np.expm1(np.linspace(0.0, np.log1p(model.length / r0), points))
    taken = _possible(fit, _taken(fit, draws))
    rows: dict[str, list[Any]] = {name: [] for name in (*_BANDS, *_CROSSOVER)}
    for u in (fit.coordinates, *taken):
        p = problem.to_values(u)
        seen = model.predict(z, p)
        phi = p.get("volume_fraction", model.values["volume_fraction"])
        full = float(crossover_velocity_ratio(phi, model.solvent_quality))
        network = seen.radius * seen.core_radius_ratio
        found = (
            seen.radius,
            seen.mean,
            seen.core,
            network,
            seen.relative_extension,
            seen.orientation,
            *_crossing(z, seen, full),
        )
        for name, values in zip(rows, found, strict=True):
            rows[name].append(values)
    data: dict[str, Any] = {}
    for name, (unit, words) in _BANDS.items():
        data[name] = (
            ("quantile", "z"),
            np.quantile(rows[name][1:], LEVELS, axis=0),
            {"units": unit, "long_name": words},
        )
        data[f"{name}_best"] = ("z", rows[name][0], {"units": unit, "long_name": f"{words}, best parameters"})
    for name, (unit, words) in _CROSSOVER.items():
        attributes = {"units": unit, "long_name": words}
        data[name] = ("quantile", _of_crossover(name, np.array(rows[name][1:])), attributes)
        data[f"{name}_best"] = ((), rows[name][0], attributes)
    reached = float(np.isfinite(rows["crossover_position"][1:]).mean())
    data["crossover_reached"] = (
        (),
        reached,
        {"units": "1", "long_name": "share of the draws that reach the crossover"},
    )
    place = ("z", z, {"units": "m", "long_name": "distance from the nozzle"})
    return xr.Dataset(data, {"z": place, "quantile": list(LEVELS)}, {"draws": len(taken)})


def predictive(fit: "Fit", draws: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What the instruments would show at the places of the data, calibration included: quantiles (`LEVELS`).

    Parameters
    ----------
    fit : Fit
    draws : ndarray, (n, p)
        As for `bands`.

    Returns
    -------
    credible, predicted : ndarray, (5, data)
        Without and with the noise of a new measurement of the same standard deviation, the noise exactly normal.
    """
    from scipy.special import ndtri

    problem = fit.problem
    taken = _possible(fit, _taken(fit, draws))
    shown = np.array([np.concatenate(problem.model.measured(problem.data, problem.to_values(u))) for u in taken])
    std = np.concatenate([part.std for part in problem.data])
    noise = ndtri((np.arange(_NOISES) + 0.5) / _NOISES)
    predicted = np.empty((len(LEVELS), std.size))
    for start in range(0, std.size, _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        noisy = shown[:, np.newaxis, part] + noise[:, np.newaxis] * std[part]
        predicted[:, part] = np.quantile(noisy.reshape(-1, noisy.shape[-1]), LEVELS, axis=0)
    return np.quantile(shown, LEVELS, axis=0), predicted


def stored_draws(found: "xr.Dataset", count: int = 128, seed: int = 0) -> list[dict[str, float]]:
    """Draws of a stored fit (`spinline.fit.output.fit_dataset`), SI: the sampler's, evenly, or of the covariance.

    Parameters
    ----------
    found : xarray.Dataset
    count, seed : int

    Returns
    -------
    list of dict
        Parameter name to value; those out of a parameter's range left out; empty where the covariance is not finite.
    """
    from spinline.fit.model import PARAMETERS

    names = [str(name) for name in found["parameter"].values]
    if "draws" in found:
        rows = found["draws"].values[:: max(1, found.sizes["draw"] // count)]
    else:
        covariance, scale = found["covariance"].values, found["coordinate_scale"].values
        if not np.isfinite(covariance).all():
            return []
        size, vectors = np.linalg.eigh(covariance)
        normal = np.random.default_rng(seed).standard_normal((count, len(names)))
        moves = (normal * np.sqrt(np.maximum(size, 0.0))) @ vectors.T * scale
        best, logs = found["best"].values, found["logarithmic"].values.astype(bool)
        rows = np.where(logs, best * np.exp(np.where(logs, moves, 0.0)), best + moves)
    inside = [
        all(PARAMETERS[name].low <= value <= PARAMETERS[name].high for name, value in zip(names, row, strict=True))
        for row in rows
    ]
    return [dict(zip(names, map(float, row), strict=True)) for row, kept in zip(rows, inside, strict=True) if kept]


def _taken(fit: "Fit", draws: FloatArray) -> FloatArray:
    """Draws that the model is run for, evenly: fewer of a rung that takes tens of milliseconds."""
    model = fit.problem.model
    most = _FEW_DRAWS if model.solved_jet or rung_of(model.model).slips else _DRAWS
    return draws[:: max(1, len(draws) // most)]


def _possible(fit: "Fit", draws: FloatArray) -> FloatArray:
    """Draws that the model does not refuse (no steady jet there); the best parameters where it refuses all.

    Told by the posterior, whose density is zero there, for the jets that may be refused.
    """
    if not fit.problem.model.solved_jet:
        return draws
    kept = draws[[np.isfinite(fit.problem.log_posterior(u)) for u in draws]]
    return kept if len(kept) else fit.coordinates[np.newaxis]


def _crossing(z: FloatArray, seen: "Prediction", target: float) -> tuple[float, float]:
    """Where the strands' stretch first passes a value, logarithms linear between the places, and the radius there."""
    above = np.flatnonzero(seen.stretch >= target)
    if not above.size or above[0] == 0:
        return float("nan"), float("nan")
    ends = slice(above[0] - 1, above[0] + 1)
    log_w = np.log(seen.stretch[ends])
    share = float((np.log(target) - log_w[0]) / (log_w[1] - log_w[0]))
    log_r = np.log(seen.radius[ends])
    near = np.log(z[ends]) if z[ends][0] > 0 else None
    place = float(np.exp(near[0] + share * (near[1] - near[0]))) if near is not None else share * float(z[ends][1])
    return place, float(np.exp(log_r[0] + share * (log_r[1] - log_r[0])))


def _of_crossover(name: str, values: FloatArray) -> FloatArray:
    """Quantiles; a position that is not reached lies beyond the end, a radius there is of the others, if they are half."""
    known = np.isfinite(values)
    if name.endswith("position"):
        found: FloatArray = np.quantile(np.where(known, values, _FAR), LEVELS)
        return np.where(found > 0.01 * _FAR, np.nan, found)
    return np.quantile(values[known], LEVELS) if known.mean() >= 0.5 else np.full(len(LEVELS), np.nan)


def _start(fit: "Fit", team: int, rng: np.random.Generator) -> FloatArray:
    """Walkers around the fit: its covariance, at most a change of order one where it is infinite, within the ranges."""
    spread = fit.covariance
    if not np.isfinite(spread).all():
        spread = np.diag(np.minimum(np.diag(spread), 0.25))
    size, vectors = np.linalg.eigh(spread)
    factor = vectors * np.sqrt(np.maximum(size, 0.0))
    found: list[FloatArray] = []
    for attempt in range(1000 * team):
        shrink = 0.5 if attempt < 100 * team else 0.01
        u = fit.coordinates + shrink * (factor @ rng.standard_normal(len(fit.problem.free)))
        if np.isfinite(fit.problem.log_posterior(u)):
            found.append(u)
            if len(found) == team:
                return np.array(found)
    raise InputError("parameters", "leave the sampler no room: the fit lies at an end of a range", remedy="give priors")
