"""Polymer fraction in the shells of a jet from one detector row, by the likelihood of its counts.

The counts are Poisson about the model of `forward`; fractions, radius, axis, level and slope of the beam (and the blur, if
asked for) are those of the largest likelihood, all at once. The logarithm of the counts is never taken: zero counts are data,
and least squares of logarithms is biased by -0.5 in the fraction at 100 photons per pixel. Steps are Fisher scoring, damped
after Levenberg; the covariance is the inverse Fisher matrix at the end, which the scatter of replicates bears out.

A fraction outside [0, 1] is not cut off: the mean of many noisy rows is unbiased only if none is. But an outermost shell that
is nearly as transparent as air is no part of the jet: such a maximum is a jet of fewer shells, and that within it is taken.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.xray.row.block import smoothed_outliers
from spinline.xray.row.forward import Absorber, Detector, row_model
from spinline.xray.row.limit import require_contrast
from spinline.xray.row.model import RowModel
from spinline.xray.row.outcome import RowFit
from spinline.xray.row.problem import row_problem
from spinline.xray.row.start import find_jet, jet_depth

__all__ = ["fit_row"]

_MANY_MAXIMA = (
    0.04  # error of the mean from which on edges that cross pixels make several maxima: start from other radii too
)
_SHARP = 0.5  # pixels: a fitted blur under this that does not settle may be none


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
        What is fitted beside the fractions: any of "radius", "axis", "amplitude", "slope", "blur", "tail_share",
        "tail_length", "shape2", "shape3", "shape4". Where the counts are likeliest with no blur, it is 0, and its standard
        deviation too. Shapes have a standard deviation of 1 % beforehand: where air is in view it does not matter, elsewhere
        it is in the error. One row says little of a tail: `shared.fit_detector` takes all blocks of a frame.
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
    1 ms for 400 pixels and 3 shells at 1e5 photons or more; 2 to 9 ms at 1e4 and fewer, where other starts are tried.
    Flat and dark are taken as exact: average enough of them.
    """
    require_contrast(absorber)
    problem = row_problem(
        counts, detector, shells, nuisances, good, saturation, lambda *more: row_model(absorber, detector, *more)
    )
    model, data, lit, _ = problem
    if data.sum() <= model.dark.sum():
        raise InputError(
            "dark",
            "exceeds the counts: no signal is left",
            value=float(model.dark.sum()),
            allowed=f"under the counts' sum, {data.sum():g}",
            remedy="give raw counts with the dark image of the same exposure",
        )
    start = _start(model, data, lit, nuisances, radius, axis, amplitude, slope, detector)
    best = problem.best(start)
    fit = problem.outcome(best)
    if "radius" in nuisances and _hollow(fit.jet.fraction, absorber):
        inner = start.copy()
        inner[model.shells] = fit.jet.radius * model.edges[-2]
        trial = problem.best(inner)
        if trial[1] and not _hollow(trial[0][: model.shells], absorber):
            best, fit = trial, problem.outcome(trial)
    if "radius" in nuisances and (fit.mean_fraction_std > _MANY_MAXIMA or not fit.converged):
        first = best
        for scale in (0.92, 1.08):
            other = start.copy()
            other[model.shells] = scale * fit.jet.radius
            trial = problem.best(other, known=best)
            if trial[3] < best[3] - 1e-3 and not _hollow(trial[0][: model.shells], absorber):
                best = trial
        if best is not first:
            fit = problem.outcome(best)
    if "blur" in nuisances and not fit.converged and fit.values["blur"] < _SHARP * detector.pixel:
        sharp = fit_row(
            counts,
            absorber,
            replace(detector, blur=0.0),
            shells=shells,
            nuisances=[n for n in nuisances if n != "blur"],
            radius=fit.jet.radius if "radius" in nuisances else radius,
            axis=fit.jet.axis if "axis" in nuisances else axis,
            amplitude=amplitude,
            slope=slope,
            good=good,
            saturation=saturation,
        )
        if sharp.converged and sharp.deviance < fit.deviance + 1.0:
            return sharp  # the likelihood is largest at no blur at all, where its slope does not vanish
    return fit


def _hollow(fraction: FloatArray, absorber: Absorber) -> bool:
    """Whether the outermost of several shells absorbs less than half of what any mixture would."""
    least = absorber.solvent - absorber.air + min(absorber.contrast, 0.0)
    outermost = absorber.solvent - absorber.air + absorber.contrast * float(fraction[-1])
    return fraction.size > 1 and least > 0.0 and outermost < 0.5 * least


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
    tail = {"tail_share": detector.tail_share, "tail_length": detector.tail_length}
    more = [tail.get(name, 0.0) for name in model.extras]
    start = np.array([*np.full(k, phi), found_r * p, found_a * p, *held, detector.blur, *more])
    outside = np.abs(model.u) > 0.9  # level and slope, against the air at the ends
    if "amplitude" in nuisances:
        level = float(np.median(ratio[outside & lit])) if (outside & lit).any() else 1.0
        start[k + 2] = level if level > 0 else max(float(ratio.mean()), 1e-6)
    return start
