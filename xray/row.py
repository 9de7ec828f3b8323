"""Polymer fraction in the shells of a jet from one detector row, by the likelihood of its counts.

The counts are Poisson about the model of `forward`; fractions, radius, axis, level and slope of the beam (and the blur, if
asked for) are those of the largest likelihood, all at once. The logarithm of the counts is never taken: zero counts are data,
and least squares of logarithms is biased by -0.5 in the fraction at 100 photons per pixel. Steps are Fisher scoring, damped
after Levenberg; the covariance is the inverse Fisher matrix at the end, which the scatter of replicates bears out.

A fraction outside [0, 1] is not cut off: the mean of many noisy rows is unbiased only if none is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from spinline.checks import BoolArray, FloatArray, positive, real
from spinline.errors import InputError
from spinline.xray.block import smoothed_outliers, summed_counts
from spinline.xray.chords import checked_edges, equal_shells, shell_weights
from spinline.xray.forward import Absorber, Detector, RoundJet, row_model
from spinline.xray.limit import covariance_bound, free_parameters, require_contrast
from spinline.xray.model import NUISANCES, RowModel
from spinline.xray.scoring import largest_likelihood
from spinline.xray.start import find_jet, jet_depth

__all__ = ["FLAGS", "RowFit", "fit_row"]

FLAGS = {
    "not_converged": "the fit did not converge: give radius and axis, or fit fewer unknowns",
    "noisy": "the error of the mean fraction exceeds the fraction: sum more rows or frames",
    "not_gaussian": (
        "too few photons to hold radius and fraction at once: errors are not Gaussian; give the radius, or sum rows"
    ),
    "impossible": ("the mean fraction lies outside [0, 1] by more than its error: check attenuation, flat and fringes"),
    "misfit": "the counts scatter more than Poisson about the model: fringes, an elliptic jet, or a wrong flat or gain",
    "outlier": "a pixel lies 8 standard deviations off: mask it if it is bad",
    "narrow_shells": "the shells are narrower than 2 pixels: use fewer",
    "no_air": "the jet reaches the end of the row: without air there, beam level and fraction are hard to tell apart",
}

_MANY_MAXIMA = (
    0.04  # error of the mean from which on edges that cross pixels make several maxima: start from other radii too
)


@dataclass(frozen=True, eq=False)
class RowFit:
    """What a row says of the jet.

    Attributes
    ----------
    jet : RoundJet
        The estimate: fraction of each shell, radius, axis, edges.
    fraction_std : ndarray, shape (shells,)
        Standard deviation of each shell's fraction.
    mean_fraction, mean_fraction_std : float
        Mean over the cross-section.
    limit_std : float
        Smallest standard deviation of the mean if nothing but the shells were unknown; the price of the other unknowns is
        ``mean_fraction_std / limit_std``.
    values, std : dict
        Radius, axis, blur in m, amplitude and slope, by name; 0 in `std` for those that were held.
    names, covariance : tuple of str, ndarray
        Covariance of all that was free.
    expected : ndarray, shape (pixels,)
        Mean counts of the fit.
    deviance, degrees_of_freedom : float, int
        Poisson deviance of the fit; near each other for a good fit where counts are large.
    misfit : float
        Pearson's chi-square less its expectation, in its standard deviations; good at low counts too. Over 4 is a wrong model.
    converged : bool
    iterations : int
    warnings : tuple of str
        What is odd.
    flags : tuple of str
        The same by name: keys of `FLAGS`.
    """

    jet: RoundJet
    fraction_std: FloatArray
    mean_fraction: float
    mean_fraction_std: float
    limit_std: float
    values: dict[str, float]
    std: dict[str, float]
    names: tuple[str, ...]
    covariance: FloatArray
    expected: FloatArray
    deviance: float
    degrees_of_freedom: int
    misfit: float
    converged: bool
    iterations: int
    warnings: tuple[str, ...]
    flags: tuple[str, ...] = ()


def fit_row(
    counts: ArrayLike,
    absorber: Absorber,
    detector: Detector,
    *,
    shells: int | ArrayLike = 3,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope"),
    radius: float | None = None,
    axis: float | None = None,
    amplitude: float = 1.0,
    slope: float = 0.0,
    good: ArrayLike | None = None,
    saturation: float = np.inf,
) -> RowFit:
    """Estimate the polymer fraction from one row of counts, or from a block of rows of the same jet.

    Parameters
    ----------
    counts : array_like, shape (pixels,) or (rows, pixels)
        Raw photon counts, dark included, >= 0. Rows (or frames) of a block share jet, flat and drift, and are summed.
    absorber, detector
        Attenuation, and flat, dark, veil and blur of one row.
    shells : int or array_like
        Number of shells of equal width, or their edges r/R from 0 to 1. Few: each more costs precision (see `error_limit`).
    nuisances : sequence of str
        What is fitted beside the fractions: any of "radius", "axis", "amplitude", "slope", "blur".
    radius, axis : float, optional
        m. The start where fitted (found where left out), the value where not (then needed).
    amplitude, slope : float
        Held at these where not fitted.
    good : array_like of bool, optional
        False for bad pixels; the shape of `counts`, or of one row.
    saturation : float
        Counts at or over this are refused unless masked.

    Returns
    -------
    RowFit

    Raises
    ------
    InputError
        For a contrast near 0, negative counts, dark counts over the counts, saturated pixels, other shapes than flat's, a
        radius or axis that is neither fitted nor given, or a row that cannot tell the unknowns apart.

    Notes
    -----
    About 2 ms for 400 pixels and 4 shells; three times that where the
    error of the mean is over 0.04 and the radius is fitted.
    Flat and dark are taken as exact: average enough of them.
    """
    require_contrast(absorber)
    edges = equal_shells(shells) if isinstance(shells, int) else checked_edges(shells)
    free = free_parameters(edges.size - 1, nuisances)
    data, rows = summed_counts(counts, detector, good, saturation)
    model = row_model(absorber, detector, edges, 3.0 * detector.blur if "blur" in nuisances else None)
    model.scale_exposure(rows)
    if data.sum() <= model.dark.sum():
        raise InputError(
            "dark", "exceeds the counts: no signal is left", value=float(model.dark.sum()),
            allowed=f"under the counts' sum, {data.sum():g}", remedy="give raw counts with the dark image of the same exposure",
        )  # fmt: skip
    lit = rows > 0
    start = _start(model, data, lit, nuisances, radius, axis, amplitude, slope, detector)
    best = largest_likelihood(model, start, free, data, lit)
    fit = _result(model, best, free, data, lit)
    if "radius" in nuisances and (fit.mean_fraction_std > _MANY_MAXIMA or not fit.converged):
        first = best
        for scale in (0.92, 1.08):
            other = start.copy()
            other[model.shells] = scale * fit.jet.radius
            trial = largest_likelihood(model, other, free, data, lit)
            if trial[3] < best[3] - 1e-3:
                best = trial
        if best is not first:
            fit = _result(model, best, free, data, lit)
    return fit


def _start(
    model: RowModel,
    data: FloatArray,
    lit: BoolArray,
    nuisances: Sequence[str],
    radius: float | None,
    axis: float | None,
    amplitude: float,
    slope: float,
    detector: Detector,
) -> FloatArray:
    """Parameters to start from."""
    p, k = detector.pixel, model.shells
    for name, value in (("radius", radius), ("axis", axis)):
        if value is None and name not in nuisances:
            raise InputError(name, "is neither fitted nor given", remedy=f"give {name}, or add it to nuisances")
    if "blur" in nuisances and detector.blur == 0.0:
        raise InputError("blur", "cannot be fitted from 0", value=0.0, remedy="give Detector a first guess of the blur")
    if lit.sum() < 4:
        raise InputError("good", "leaves fewer than 4 pixels", value=int(lit.sum()))
    held = (float(real("amplitude", amplitude, above=0.0)), float(real("slope", slope, above=-1.0, below=1.0)))
    r = None if radius is None else positive("radius", radius, "m") / p
    half = 0.5 * p * data.size
    a = None if axis is None else float(real("axis", axis, above=-half, below=half, unit="m")) / p
    at = np.arange(data.size)
    clean = smoothed_outliers(data[lit])
    ratio = np.interp(at, at[lit], (clean - model.dark[lit]) / model.flat[lit] - model.veil[lit])
    if r is not None and a is not None:
        found_r, found_a, depth = r, a, jet_depth(ratio, r, a)
    else:
        found_r, found_a, depth = find_jet(ratio, r, a)
        found_r, found_a = (found_r if r is None else r), (found_a if a is None else a)
    mu = -np.log1p(-min(max(depth, 1e-3), 0.99)) / (2.0 * found_r * p)
    phi = min(max((mu - model.base) / model.contrast, 0.0), 1.0)
    start = np.array([*np.full(k, phi), found_r * p, found_a * p, *held, detector.blur])
    outside = np.abs(model.u) > 0.9  # level and slope, against the air at the ends
    if "amplitude" in nuisances:
        level = float(np.median(ratio[outside & lit])) if (outside & lit).any() else 1.0
        start[k + 2] = level if level > 0 else max(float(ratio.mean()), 1e-6)
    return start


def _result(
    model: RowModel,
    best: tuple[FloatArray, bool, int, float],
    free: list[int],
    data: FloatArray,
    lit: BoolArray,
) -> RowFit:
    parameters, converged, iterations, deviance = best
    k = model.shells
    expected, jacobian = model.evaluate(parameters)
    mean, used = expected[lit], jacobian[lit]
    names = tuple(model.names[i] for i in free)
    covariance = covariance_bound(mean, used[:, free], names)
    alone = covariance_bound(mean, used[:, :k], names[:k])
    weights = shell_weights(model.edges)
    sd = np.zeros(parameters.size)
    sd[free] = np.sqrt(np.diag(covariance))
    pearson = float(((data[lit] - mean) ** 2 / mean).sum())
    freedom = int(lit.sum()) - len(free)
    spread = np.sqrt(2.0 * max(freedom, 1) + (1.0 / mean).sum())
    phi = parameters[:k]
    fit = RowFit(
        jet=RoundJet(phi, float(parameters[k]), float(parameters[k + 1]), model.edges),
        fraction_std=sd[:k],
        mean_fraction=float(weights @ phi),
        mean_fraction_std=float(np.sqrt(weights @ covariance[:k, :k] @ weights)),
        limit_std=float(np.sqrt(weights @ alone @ weights)),
        values=dict(zip(NUISANCES, parameters[k:].tolist(), strict=True)),
        std=dict(zip(NUISANCES, sd[k:].tolist(), strict=True)),
        names=names,
        covariance=covariance,
        expected=expected,
        deviance=deviance,
        degrees_of_freedom=freedom,
        misfit=float((pearson - freedom) / spread),
        converged=converged,
        iterations=iterations,
        warnings=(),
    )
    residual = np.where(lit, (data - expected) / np.sqrt(np.where(lit, expected, 1.0)), 0.0)
    found = _flags(fit, model, residual)
    worst = int(np.argmax(np.abs(residual)))
    words = [FLAGS[name] for name in found]
    if "outlier" in found:
        words[found.index("outlier")] = (
            f"pixel {worst} lies {residual[worst]:+.0f} standard deviations off: mask it if it is bad"
        )
    return replace(fit, flags=tuple(found), warnings=tuple(words))


def _flags(fit: RowFit, model: RowModel, residual: FloatArray) -> list[str]:
    """What is odd about a fit."""
    half = 0.5 * model.pixel * model.flat.size
    odd = {
        "not_converged": not fit.converged,
        "noisy": fit.mean_fraction_std > max(abs(fit.mean_fraction), 0.0),
        "not_gaussian": fit.mean_fraction_std > 0.2 and fit.std["radius"] > 0,
        "impossible": not -3 * fit.mean_fraction_std <= fit.mean_fraction <= 1 + 3 * fit.mean_fraction_std,
        "misfit": fit.misfit > 4,
        "outlier": bool(np.abs(residual).max() > 8),
        "narrow_shells": fit.jet.radius < 2 * model.shells * model.pixel,
        "no_air": abs(fit.jet.axis) + fit.jet.radius > half - 3 * model.pixel,
    }
    return [name for name, true in odd.items() if true]
