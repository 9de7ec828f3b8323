"""A fit's parameters, turned into `RowFit`: errors, bound, goodness and warnings, for any model with RowModel's interface."""

from dataclasses import replace

import numpy as np

from spinline.checks import BoolArray, FloatArray
from spinline.xray.chords import shell_weights
from spinline.xray.forward import RoundJet
from spinline.xray.limit import covariance_bound
from spinline.xray.model import RowModel
from spinline.xray.row import RowFit

__all__ = ["row_outcome"]

_FAR = 8.0  # standard deviations of a pixel that is named


def row_outcome(
    model: RowModel,
    best: tuple[FloatArray, bool, int, float],
    free: list[int],
    data: FloatArray,
    lit: BoolArray,
    said: tuple[str, ...] = (),
) -> RowFit:
    """`RowFit` of what `scoring.largest_likelihood` returned.

    Parameters
    ----------
    model : RowModel
        Its `names` after the shells are the nuisances.
    best : tuple
        Parameters, converged, iterations, deviance.
    free : list of int
        Which parameters were fitted.
    data, lit : ndarray, shape (pixels,)
    said : tuple of str
        Warnings that come first.
    """
    at, converged, iterations, deviance = best
    k = model.shells
    expected, jacobian = model.evaluate(at)
    mean, used = expected[lit], jacobian[lit]
    names = tuple(model.names[i] for i in free)
    covariance = covariance_bound(mean, used[:, free], names)
    alone = covariance_bound(mean, used[:, :k], names[:k])
    weights = shell_weights(model.edges)
    sd = np.zeros(at.size)
    sd[free] = np.sqrt(np.diag(covariance))
    freedom = int(lit.sum()) - len(free)
    pearson = float(((data[lit] - mean) ** 2 / mean).sum())
    fit = RowFit(
        jet=RoundJet(at[:k], float(at[k]), float(at[k + 1]), model.edges),
        fraction_std=sd[:k],
        mean_fraction=float(weights @ at[:k]),
        mean_fraction_std=float(np.sqrt(weights @ covariance[:k, :k] @ weights)),
        limit_std=float(np.sqrt(weights @ alone @ weights)),
        values=dict(zip(model.names[k:], at[k:].tolist(), strict=True)),
        std=dict(zip(model.names[k:], sd[k:].tolist(), strict=True)),
        names=names,
        covariance=covariance,
        expected=expected,
        deviance=deviance,
        degrees_of_freedom=freedom,
        misfit=float((pearson - freedom) / np.sqrt(2.0 * max(freedom, 1) + (1.0 / mean).sum())),
        converged=converged,
        iterations=iterations,
        warnings=(),
    )
    residual = np.where(lit, (data - expected) / np.sqrt(np.where(lit, expected, 1.0)), 0.0)
    return replace(fit, warnings=(*said, *_remarks(fit, model, residual)))


def _remarks(fit: RowFit, model: RowModel, residual: FloatArray) -> list[str]:
    said = []
    if not fit.converged:
        said.append("the fit did not converge: give radius and axis, or fit fewer unknowns")
    if fit.mean_fraction_std > abs(fit.mean_fraction):
        said.append("the error of the mean fraction exceeds the fraction: sum more rows or frames")
    if not -3 * fit.mean_fraction_std <= fit.mean_fraction <= 1 + 3 * fit.mean_fraction_std:
        said.append("the mean fraction lies outside [0, 1] by more than its error: check medium, distance and flat")
    if fit.misfit > 4:
        said.append(
            "the counts scatter more than Poisson about the model: check distance, blur, spectrum, flat and gain"
        )
    worst = int(np.argmax(np.abs(residual)))
    if abs(residual[worst]) > _FAR:
        said.append(f"pixel {worst} lies {residual[worst]:+.0f} standard deviations off: mask it if it is bad")
    half = 0.5 * model.pixel * model.flat.size
    if abs(fit.jet.axis) + fit.jet.radius > half - 3 * model.pixel:
        said.append("the jet reaches the end of the row: without air there, level and fraction are hard to tell apart")
    return said
