"""Fit of the power law ``r = (r_0 / k) (z / r_0)^(-beta)`` to a measured profile, and where it holds.

Weighted least squares of r against the power law, not of ln r: the mean of ln r is below the logarithm of the mean by half the
relative variance, and weights taken from the observed radius pull the law towards the samples that came out thin (at 10 %
noise k by -0.0150, and 5 % of the 95 % intervals hold it). Where the standard deviations given go with the observed
radius, they are referred to the fitted one. A power law is an asymptote: real jets leave it near the nozzle, where r
must meet the nozzle's, and where they bend. So the fit looks for the widest range of ln z over which the profile is a
power law but for noise: a cubic in ln z, fitted beside the line, stays within `tolerance` (relative radius) or three
standard errors of it; the scatter about the line is within `tolerance` or twice the noise; and beta is one of a jet, in
[1/4, 1] within three standard errors. Without `radius_std` the noise is taken from neighbouring samples.

Uncertainty: that of the noise, from `radius_std` where given, from the residuals otherwise; and that of the departure that is
let pass, for the part of it that is a line in ln z moves beta and is not seen. A departure is taken to be smooth (a Gaussian
process whose correlation length is three quarters of the range), there or not with the odds given below, of any size up to
`tolerance`; the parabola and the cubic beside the line, which are seen, weigh the sizes. Sizes that may be far apart are no
normal distribution: the errors are those of which 1.96 hold 95 % of it. Where the radius is a power law to far better than the
tolerance, they are too wide for it: whether a departure is a line in ln z no sample can tell, only a smaller `tolerance`.
Not in it: r_0, which moves k by 1 + beta times as much.

References
----------
Review Eq. (31), Fig. 35 (measured: beta = 0.47).
"""

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfc

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError, SpinlineWarning

__all__ = ["PowerLawFit", "fit_power_law"]

_BINS = 96  # the range is searched among so many groups of samples
_FEWEST = 6  # samples a range needs
_MOST_REWEIGHTED = 40
_CLEAR = 4.0  # standard errors from which the standard deviations given follow the observed radius
_SIZES = 40  # sizes of a departure that are weighed
_OUTSIDE, _TWO_SIDED = 0.05, 1.959963984540054  # of 95 %
_NONE = 0.25  # odds that there is none
_SMOOTH = np.array([0.87452, 0.34544, 0.04851, 0.00418])
"""Mean squares of the first four Legendre coefficients of exp(-(u - u')^2 / (2 x 1.5^2)) on [-1, 1], u of ln z."""
_LEAST, _MOST = 0.25, 1.0  # exponents of electrified jets, review after Eq. (31)


@dataclass(frozen=True)
class PowerLawFit:
    """A fitted power law.

    Attributes
    ----------
    k, beta : float
        Prefactor and exponent of ``V = k^2 s^(2 beta)``.
    covariance : ndarray, (2, 2)
        Of (k, beta): noise and tolerated misfit.
    misfit : float
        Relative departure of the radius (root mean square over the range) that the samples leave possible.
    initial_radius : float
        r_0 that k refers to, m.
    z_min, z_max : float
        Range fitted, m.
    samples : int
        Samples in that range, of `samples_given`.
    samples_given : int
        Samples with z > 0, within `z_range`.
    r_squared : float
        Of ln r against ln z in the range.
    reduced_chi_squared : float
        Residuals over their standard deviation, squared, per degree of freedom; NaN without `radius_std`.
    departure : float
        Largest relative departure of the radius from the line within the range, by the cubic.
    departure_outside : float
        Largest relative departure of a sample (group mean) outside the range; 0 if nothing is outside.
    message : str
        What was found, in words: empty where the power law holds over all samples.
    """

    k: float
    beta: float
    covariance: FloatArray
    misfit: float
    initial_radius: float
    z_min: float
    z_max: float
    samples: int
    samples_given: int
    r_squared: float
    reduced_chi_squared: float
    departure: float
    departure_outside: float
    message: str

    @property
    def k_std(self) -> float:
        """Standard deviation of k."""
        return float(np.sqrt(self.covariance[0, 0]))

    @property
    def beta_std(self) -> float:
        """Standard deviation of beta."""
        return float(np.sqrt(self.covariance[1, 1]))


def fit_power_law(
    z: ArrayLike,
    radius: ArrayLike,
    radius_std: ArrayLike | None = None,
    *,
    initial_radius: float | None = None,
    z_range: tuple[float, float] | None = None,
    tolerance: float = 0.02,
) -> PowerLawFit:
    """Fit k and beta to a radius profile over the range where a power law holds.

    Parameters
    ----------
    z, radius : array_like, (n,)
        Distance from the nozzle and jet radius, m. Samples at z <= 0 are left out: an asymptote has no value there.
    radius_std : array_like, optional
        Standard deviation of each radius, m.
    initial_radius : float, optional
        r_0, m. Default: the largest radius.
    z_range : (float, float), optional
        Look at the samples between these places only, m.
    tolerance : float, optional
        Relative departure of the radius that is still a power law. It is part of the uncertainty: give a small one for a
        jet that is known to be a power law.

    Returns
    -------
    PowerLawFit

    Warns
    -----
    SpinlineWarning
        Where the power law holds over part of the samples only, or not even over the range returned.

    Raises
    ------
    InputError
        For values out of range, fewer than six samples, or samples that all lie at one place.

    Notes
    -----
    About 20 ms, whatever the number of samples up to 1e5.

    Examples
    --------
    >>> z = np.geomspace(1e-3, 1e-2, 50)
    >>> fit = fit_power_law(z, 125e-6 * (z / 125e-6) ** -0.47, initial_radius=125e-6)
    >>> round(fit.k, 6), round(fit.beta, 6)
    (1.0, 0.47)
    """
    x, y, sigma, r0 = _samples(z, radius, radius_std, initial_radius, z_range)
    scattered = radius_std is not None
    tol = positive("tolerance", tolerance)
    groups = _group(x, y, sigma)
    low, high, holds = _widest(*groups, tol)
    inside = (x >= low) & (x <= high)
    line, cov, chi2 = _radii(x[inside], y[inside], sigma[inside], scattered)
    if not scattered:  # sigma is only a guess from neighbours: let the residuals speak
        cov = cov * chi2
    noise = sigma[inside] * (1.0 if scattered else float(np.sqrt(chi2)))
    bend, _ = _departure(x[inside], y[inside], sigma[inside])
    left = y[inside] - np.polyval(line, x[inside])
    hidden, hides = _hidden(x[inside], left, noise, tol if holds else max(tol, bend), float(cov[0, 0]))
    cov = cov + hides
    chi2 = chi2 if scattered else float("nan")
    outside = (groups[0] < low) | (groups[0] > high)
    missed = np.abs(np.expm1(groups[1] - np.polyval(line, groups[0])))[outside]
    beta = -float(line[0])
    # ln r = -beta ln z + c  and  r = (r_0 / k)(z / r_0)^(-beta)  give  ln k = (1 + beta) ln r_0 - c
    k = float(np.exp((1 + beta) * np.log(r0) - line[1]))
    to_k = np.array([[-k * np.log(r0), -k], [-1.0, 0.0]])
    spread = float(np.sum((y[inside] - y[inside].mean()) ** 2))
    misfit = float(np.sum((y[inside] - np.polyval(line, x[inside])) ** 2))
    fit = PowerLawFit(
        k=k,
        beta=beta,
        covariance=to_k @ cov @ to_k.T,
        misfit=hidden,
        initial_radius=r0,
        z_min=float(np.exp(x[inside].min())),
        z_max=float(np.exp(x[inside].max())),
        samples=int(inside.sum()),
        samples_given=x.size,
        r_squared=1 - misfit / spread if spread else float("nan"),
        reduced_chi_squared=chi2,
        departure=bend,
        departure_outside=float(missed.max()) if missed.size else 0.0,
        message="",
    )
    message = _judge(fit, tol, holds, (float(np.exp(x.min())), float(np.exp(x.max()))))
    if message:
        warnings.warn(message, SpinlineWarning, stacklevel=2)
    return PowerLawFit(**{**fit.__dict__, "message": message})


def _samples(
    z: ArrayLike,
    radius: ArrayLike,
    radius_std: ArrayLike | None,
    initial_radius: float | None,
    z_range: tuple[float, float] | None,
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Ln z, ln r and its standard deviation, sorted, of the samples looked at; and r_0."""
    position, r = real("z", z, unit="m"), real("radius", radius, above=0.0, unit="m")
    if position.ndim != 1 or position.shape != r.shape:
        raise InputError("radius", "must have one value for each z", value=f"{r.shape} against {position.shape}")
    use = position > 0
    if z_range is not None:
        low, high = real("z_range", z_range, unit="m")
        use &= (position >= low) & (position <= high)
    if use.sum() < _FEWEST:
        raise InputError(
            "z",
            f"has fewer than {_FEWEST} samples beyond the nozzle, or in the range asked for",
            value=int(use.sum()),
            remedy="measure at more places, or look farther: --from, --to",
        )
    order = np.argsort(position[use], kind="stable")
    x, y = np.log(position[use][order]), np.log(r[use][order])
    if not x[-1] > x[0]:
        raise InputError("z", "has all its samples at one place", value=float(np.exp(x[0])))
    if radius_std is None:
        sigma = np.full_like(x, _local_noise(x, y))
    else:
        std = np.broadcast_to(real("radius_std", radius_std, above=0.0, unit="m"), r.shape)
        sigma = (std / r)[use][order]
    r0 = float(r.max()) if initial_radius is None else positive("initial_radius", initial_radius, "m")
    return x, y, sigma, r0


def _group(x: FloatArray, y: FloatArray, sigma: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Weighted means over equal steps of ln z, with their standard deviations."""
    if x.size <= _BINS:
        return x, y, sigma
    edges = np.linspace(x[0], x[-1], _BINS + 1)
    cell = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, _BINS - 1)
    weight = sigma**-2
    total = np.bincount(cell, weight, _BINS)
    full = total > 0
    means = [np.bincount(cell, weight * a, _BINS)[full] / total[full] for a in (x, y)]
    return means[0], means[1], 1 / np.sqrt(total[full])


def _widest(x: FloatArray, y: FloatArray, sigma: FloatArray, tolerance: float) -> tuple[float, float, bool]:
    """Widest range of x that is a power law and True, or all of it and False."""
    n = x.size
    spans = [(x[j] - x[i], x[i], i, j) for i in range(n) for j in range(i + _FEWEST - 1, n)]
    for _, _, i, j in sorted(spans, reverse=True):
        if _is_power_law(x[i : j + 1], y[i : j + 1], sigma[i : j + 1], tolerance):
            return (
                -np.inf if i == 0 else 0.5 * float(x[i - 1] + x[i]),
                np.inf if j == n - 1 else 0.5 * float(x[j] + x[j + 1]),
                True,
            )
    return -np.inf, np.inf, False


def _is_power_law(x: FloatArray, y: FloatArray, sigma: FloatArray, tolerance: float) -> bool:
    """Whether samples lie on the line but for noise: exponent of a jet, no bend, no wiggle."""
    line, cov, chi2 = _line(x, y, sigma)
    slack = 3 * float(np.sqrt(cov[0, 0]))
    if not _LEAST - slack - 1e-9 <= -line[0] <= _MOST + slack + 1e-9:
        return False
    noise = float(np.sqrt(np.mean(sigma**2)))
    bend, error = _departure(x, y, sigma)
    return bend <= max(tolerance, 3 * error) and np.sqrt(chi2) * noise <= max(tolerance, 2 * noise)


def _local_noise(x: FloatArray, y: FloatArray) -> float:
    """Standard deviation of y from each sample's distance to the chord of its neighbours: blind to slow curvature."""
    share = (x[1:-1] - x[:-2]) / np.maximum(x[2:] - x[:-2], 1e-300)
    miss = y[1:-1] - (1 - share) * y[:-2] - share * y[2:]
    scaled = miss / np.sqrt(1 + share**2 + (1 - share) ** 2)
    return max(float(1.4826 * np.median(np.abs(scaled))), 1e-14)


def _line(x: FloatArray, y: FloatArray, sigma: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Coefficients (slope, intercept), their covariance for the given sigma, and the reduced chi-squared."""
    centre = float(np.average(x, weights=sigma**-2))
    design = np.stack([x - centre, np.ones_like(x)], axis=1) / sigma[:, np.newaxis]
    inverse = np.linalg.inv(design.T @ design)
    slope, level = inverse @ (design.T @ (y / sigma))
    residual = (y - level - slope * (x - centre)) / sigma
    shift = np.array([[1.0, 0.0], [-centre, 1.0]])
    chi2 = float(residual @ residual) / max(x.size - 2, 1)
    return np.array([slope, level - slope * centre]), shift @ inverse @ shift.T, chi2


def _radii(x: FloatArray, y: FloatArray, sigma: FloatArray, scattered: bool) -> tuple[FloatArray, FloatArray, float]:
    """The line of `_line` by least squares of r: coefficients, covariance, reduced chi-squared.

    `sigma` is relative to the observed radius; `scattered` where it came with the samples, not from their neighbours.
    """
    line = _line(x, y, sigma)[0]
    for _ in range(_MOST_REWEIGHTED):
        level = np.polyval(line, x)
        off = y - level
        # the standard deviation itself over the fitted radius, and how it goes with the residual: as the observed radius (1),
        # as the fitted one or not at all (0)
        std = np.log(sigma) + (off if scattered else 0.0)
        std = std - (_follows(x, std, off) * off if scattered else 0.0)
        residual, weight = np.expm1(off), np.exp(-2 * std)
        centre = float(np.average(x, weights=weight))
        design = np.stack([x - centre, np.ones_like(x)], axis=1)
        inverse = np.linalg.inv(design.T @ (design * weight[:, np.newaxis]))
        slope, rise = inverse @ (design.T @ (weight * residual))
        line = line + np.array([slope, rise - slope * centre])
        if max(abs(slope), abs(rise)) < 1e-12:
            break
    shift = np.array([[1.0, 0.0], [-centre, 1.0]])
    left = np.expm1(y - np.polyval(line, x))
    return line, shift @ inverse @ shift.T, float(left @ (weight * left)) / max(x.size - 2, 1)


def _follows(x: FloatArray, std: FloatArray, off: FloatArray) -> float:
    """How ln of the standard deviations goes with the residual beside its trend along the jet: 0 where it does not clearly."""
    u = (x - x.mean()) / np.ptp(x)
    basis = np.stack([np.ones_like(u), u, u**2, off], axis=1)
    if x.size <= basis.shape[1] + 1 or not np.ptp(std) > 1e-12 or not np.ptp(off) > 0:
        return 0.0
    fitted, _, rank, _ = np.linalg.lstsq(basis, std, rcond=None)
    if rank < basis.shape[1]:
        return 0.0
    scatter = float(np.sum((std - basis @ fitted) ** 2)) / (x.size - basis.shape[1])
    error = float(np.sqrt(scatter * np.linalg.inv(basis.T @ basis)[-1, -1]))
    return float(fitted[-1]) if abs(fitted[-1]) > _CLEAR * error else 0.0


def _hidden(
    x: FloatArray, residual: FloatArray, sigma: FloatArray, most: float, slope_variance: float
) -> tuple[float, FloatArray]:
    """Root mean square of a departure as likely as not to be there, up to `most`, and the covariance of (slope, intercept)
    that the part of it which is a line makes, beside `slope_variance` of the noise.

    What is seen of it, parabola and cubic beside the line, weighs how large it may be.
    """
    u = 2 * (x - x[0]) / (x[-1] - x[0]) - 1
    basis = np.stack([np.ones_like(u), u, 1.5 * u**2 - 0.5, 2.5 * u**3 - 1.5 * u], axis=1) / sigma[:, np.newaxis]
    inverse = np.linalg.inv(basis.T @ basis)
    seen, noise = (inverse @ (basis.T @ (residual / sigma)))[2:], inverse[2:, 2:]

    def log_likelihood(size: float) -> float:
        spread = noise + np.diag(_SMOOTH[2:]) * size**2
        return float(-0.5 * seen @ np.linalg.solve(spread, seen) - 0.5 * np.linalg.slogdet(spread)[1])

    sizes = most * (np.arange(_SIZES) + 0.5) / _SIZES
    logs = np.array([log_likelihood(0.0), *map(log_likelihood, sizes.tolist())])
    weights = np.exp(logs - logs.max()) * np.concatenate(([_NONE], np.full(_SIZES, (1 - _NONE) / _SIZES)))
    weights /= np.sum(weights)
    square = float(np.sum(weights[1:] * sizes**2))
    slope = 2 / (x[-1] - x[0])
    to_line = np.array([[0.0, slope], [1.0, -1 - slope * x[0]]])  # of the constant and of u
    shape = to_line @ np.diag(_SMOOTH[:2]) @ to_line.T
    spread = slope_variance + shape[0, 0] * np.concatenate(([0.0], sizes)) ** 2
    counted = max((_holding(weights, spread) - slope_variance) / float(shape[0, 0]), 0.0)
    return float(np.sqrt(square)), counted * shape


def _holding(weights: FloatArray, variances: FloatArray) -> float:
    """Variance of the normal distribution whose 95 % are those of a mixture of normal ones about the same mean."""
    low, high = (_TWO_SIDED * float(np.sqrt(v)) for v in (variances.min(), variances.max()))
    if not low > 0:  # no noise at all
        return float(np.sum(weights * variances))
    for _ in range(60):
        middle = 0.5 * (low + high)
        beyond = float(np.sum(weights * erfc(middle / np.sqrt(2 * variances))))
        low, high = (middle, high) if beyond > _OUTSIDE else (low, middle)
    return (low / _TWO_SIDED) ** 2


def _departure(x: FloatArray, y: FloatArray, sigma: FloatArray) -> tuple[float, float]:
    """Largest departure of the fitted cubic from the fitted line, and its standard error there."""
    u = 2 * (x - x[0]) / (x[-1] - x[0]) - 1
    basis = np.stack([np.ones_like(u), u, 1.5 * u**2 - 0.5, 2.5 * u**3 - 1.5 * u], axis=1)
    q, _ = np.linalg.qr(basis / sigma[:, np.newaxis])
    bend = (q[:, 2:] @ (q[:, 2:].T @ (y / sigma))) * sigma
    error = np.sqrt(np.sum(q[:, 2:] ** 2, axis=1)) * sigma
    worst = int(np.argmax(np.abs(bend)))
    return float(np.abs(np.expm1(bend[worst]))), float(error[worst])


def _judge(fit: PowerLawFit, tolerance: float, holds: bool, whole: tuple[float, float]) -> str:
    def mm(z: float) -> str:
        return f"{1e3 * z:.4g} mm"

    if not holds:
        return (
            f"no power law of a jet holds between {mm(fit.z_min)} and {mm(fit.z_max)}: beta = {fit.beta:.3g} (jets: "
            f"{_LEAST:g} to {_MOST:g}), R^2 = {fit.r_squared:.4f}, and the radius leaves the fitted one by "
            f"{100 * fit.departure:.2g} % (tolerance {100 * tolerance:g} %)"
        )
    if fit.z_min > whole[0] or fit.z_max < whole[1]:
        return (
            f"a power law holds between {mm(fit.z_min)} and {mm(fit.z_max)} only ({fit.samples} of {fit.samples_given} "
            f"samples, given from {mm(whole[0])} to {mm(whole[1])}); outside, the radius leaves it by up to "
            f"{100 * fit.departure_outside:.2g} %"
        )
    return ""
