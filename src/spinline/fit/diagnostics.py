"""What a fit can be trusted with: what the data determine, whether it fits, whether its intervals are Gaussian.

Identification: the Fisher matrix of the data alone, ``J^T J`` in coordinates where one unit is a change of order one (a
factor e, 0.25 of beta, one initial radius of the origin), has eigenvectors with standard deviations
``1/sqrt(eigenvalue)``. Beyond one unit the data leave that combination of parameters open; it is named with its weights. What
a prior then says of it is the prior's word, not the data's.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError

if TYPE_CHECKING:
    from spinline.fit.fitted import Fit

__all__ = [
    "Direction",
    "Residuals",
    "curvature",
    "examine_fit",
    "open_directions",
    "open_parameters",
    "residual_checks",
]

OPEN = 1.0  # standard deviation, in changes of order one, beyond which the data leave a direction open
_UNLIKELY = 0.003  # of a check that fails though the model is right


@dataclass(frozen=True)
class Direction:
    """A combination of parameters that the data leave open.

    Attributes
    ----------
    weights : dict
        Parameter name to weight in the unit vector of coordinates; small ones left out.
    std : float
        Its standard deviation by the data alone, in changes of order one; inf if they say nothing of it.
    posterior_std : float
        The same with the priors.
    """

    weights: dict[str, float]
    std: float
    posterior_std: float

    def words(self) -> str:
        """The direction in a sentence."""
        from spinline.fit.model import PARAMETERS

        parts = [
            f"{weight:+.2f} {'ln ' if PARAMETERS[name].log else ''}{name}" for name, weight in self.weights.items()
        ]
        spread = "not at all" if not np.isfinite(self.std) else f"to {self.std:.2g} only"
        prior = "" if self.posterior_std > OPEN else f" (priors: {self.posterior_std:.2g})"
        return f"the data determine {' '.join(parts)} {spread}{prior}"


@dataclass(frozen=True)
class Residuals:
    """Residuals of one set of data.

    Attributes
    ----------
    source, kind : str
    count : int
    chi_squared : float
    largest : float
        Largest residual in standard deviations.
    runs_p : float
        Probability of as few or fewer changes of sign along z, if residuals were independent.
    """

    source: str
    kind: str
    count: int
    chi_squared: float
    largest: float
    runs_p: float


def open_directions(fit: "Fit") -> list[Direction]:
    """Combinations that the data leave open, the most open first."""
    size, vectors = np.linalg.eigh(fit.jacobian.T @ fit.jacobian)
    floor = max(float(size.max()), 1e-30) * 1e-12
    prior = np.where(np.isfinite(fit.problem.prior_std), fit.problem.prior_std, np.inf) ** -2.0
    found = []
    for eigenvalue, vector in zip(size, vectors.T, strict=True):
        std = float(1 / np.sqrt(eigenvalue)) if eigenvalue > floor else np.inf
        if std <= OPEN:
            break
        sign = np.sign(vector[np.argmax(np.abs(vector))])
        weights = {name: float(sign * w) for name, w in zip(fit.problem.free, vector, strict=True) if abs(w) > 0.1}
        held = float(max(eigenvalue, 0.0) + vector**2 @ prior)
        found.append(Direction(weights, std, float(1 / np.sqrt(held)) if held > floor else np.inf))
    return found


def open_parameters(fit: "Fit") -> list[str]:
    """Parameters that neither data nor priors determine to a change of order one."""
    spread = np.sqrt(np.diag(fit.covariance))
    return [name for name, s in zip(fit.problem.free, spread, strict=True) if not s <= OPEN]


def prior_dominated(fit: "Fit") -> list[str]:
    """Parameters whose interval is their prior's: the data narrow it by less than a tenth."""
    spread, before = np.sqrt(np.diag(fit.covariance)), fit.problem.prior_std
    return [name for name, s, b in zip(fit.problem.free, spread, before, strict=True) if np.isfinite(b) and s > 0.9 * b]


def residual_checks(fit: "Fit") -> list[Residuals]:
    """Chi-squared, largest residual and runs of sign of every set of data."""
    found, start = [], 0
    for part in fit.problem.data:
        r = fit.residuals[start : start + part.size]
        start += part.size
        runs = _runs_p(r) if part.kind != "shell" else float("nan")  # rings of a row are not along z
        found.append(Residuals(part.source, part.kind, part.size, float(r @ r), float(np.abs(r).max()), runs))
    return found


def curvature(fit: "Fit") -> dict[str, float]:
    """How far each parameter's interval is from Gaussian: rise of -2 ln posterior two standard deviations out, over 4.

    Along the parameter's own conditional-mean direction, where a normal posterior gives 1 on both sides; the worse side is
    returned. NaN where the covariance is infinite, inf where the range ends before.
    """
    problem, u = fit.problem, fit.coordinates
    here = problem.log_posterior(u)
    found = {}
    for i, name in enumerate(problem.free):
        variance = float(fit.covariance[i, i])
        column = fit.covariance[:, i]
        if not (np.isfinite(variance) and np.isfinite(column).all()):
            found[name] = float("nan")
            continue
        step = 2 * column / np.sqrt(variance)
        rises = [2 * (here - problem.log_posterior(u + side * step)) / 4 for side in (1.0, -1.0)]
        found[name] = max(rises, key=lambda rise: abs(np.log(max(rise, 1e-3))))
    return found


def examine_fit(fit: "Fit") -> list[str]:
    """Warnings about a fit, in words."""
    from scipy.stats import chi2

    notes = [direction.words() for direction in open_directions(fit)]
    missing = open_parameters(fit)
    if missing:
        notes.append(f"not identified, neither by data nor by priors: {', '.join(missing)}; give a prior or fix them")
    if fit.degrees_of_freedom > 0 and fit.problem.loss == "gauss":
        priors = (fit.coordinates - fit.problem.prior_mean) / fit.problem.prior_std
        total = fit.chi_squared + float(priors @ priors)
        chance = float(chi2.sf(total, fit.degrees_of_freedom))
        if chance < _UNLIKELY:
            notes.append(
                f"the model does not fit: chi-squared = {total:.4g} for {fit.degrees_of_freedom} degrees of freedom "
                f"(p = {chance:.2g}); intervals are too narrow, or standard deviations too small"
            )
        elif float(chi2.cdf(total, fit.degrees_of_freedom)) < _UNLIKELY:
            notes.append(
                f"the fit is too good: chi-squared = {total:.4g} for {fit.degrees_of_freedom} degrees of freedom; the "
                "standard deviations are too large"
            )
    for part in residual_checks(fit):
        if part.runs_p < _UNLIKELY:
            notes.append(
                f"{part.source}: residuals of {part.kind} keep their sign along z (p = {part.runs_p:.2g}): the model "
                "misses a trend"
            )
        if part.largest > 5:
            notes.append(
                f"{part.source}: a {part.kind} value is {part.largest:.1f} standard deviations off: an outlier?"
            )
    for name, (pull, std) in _pulls(fit).items():
        if abs(pull) > 3:
            notes.append(f"{name} is {pull:+.1f} prior standard deviations from its prior (sd of that: {std:.2g})")
    bent = [name for name, ratio in curvature(fit).items() if not 0.5 < ratio < 2 and not np.isnan(ratio)]
    if bent:
        notes.append(f'intervals of {", ".join(bent)} are not Gaussian; use sampler = "emcee"')
    return notes


def compare_with_prior(fit: "Fit") -> dict[str, dict[str, float]]:
    """Pull in prior standard deviations, and share of the prior variance that the data took away, by parameter."""
    spread, before = np.diag(fit.covariance), fit.problem.prior_std**2
    pulls = _pulls(fit)
    return {
        name: {"pull": pulls[name][0], "shrinkage": float(1 - s / b)}
        for name, s, b in zip(fit.problem.free, spread, before, strict=True)
        if np.isfinite(b)
    }


def _pulls(fit: "Fit") -> dict[str, tuple[float, float]]:
    problem = fit.problem
    off, spread = fit.coordinates - problem.prior_mean, np.sqrt(np.diag(fit.covariance))
    rows = zip(problem.free, off, spread, problem.prior_std, strict=True)
    return {name: (float(d / b), float(s / b)) for name, d, s, b in rows if np.isfinite(b)}


def _runs_p(residuals: FloatArray) -> float:
    """Probability of as few runs of one sign, normal approximation (Wald and Wolfowitz); NaN for fewer than 20 values."""
    from scipy.stats import norm

    sign = residuals > 0
    n, up = sign.size, int(sign.sum())
    down = n - up
    if n < 20 or min(up, down) == 0:
        return float("nan")
    runs = 1 + int((sign[1:] != sign[:-1]).sum())
    mean = 1 + 2 * up * down / n
    variance = (mean - 1) * (mean - 2) / (n - 1)
    if variance <= 0:
        raise InputError("residuals", "are too few for a test of runs", value=n)
    return float(norm.cdf((runs + 0.5 - mean) / np.sqrt(variance)))
