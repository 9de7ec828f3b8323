"""What a row says of the jet, `RowFit`: errors, bound, goodness and warnings, for any model with RowModel's interface."""

from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.xray.row.chords import shell_weights
from spinline.xray.row.forward import RoundJet
from spinline.xray.row.limit import covariance_bound
from spinline.xray.row.model import RowModel

__all__ = ["FLAGS", "RowFit", "row_outcome", "turned_covariance"]

FLAGS = {
    "not_converged": "the fit did not converge: give radius and axis, or fit fewer unknowns",
    "noisy": "the error of the mean fraction exceeds the fraction: sum more rows or frames",
    "not_gaussian": (
        "too few photons to hold radius and fraction at once: errors are not Gaussian; give the radius, or sum rows"
    ),
    "impossible": "the mean fraction lies outside [0, 1] by more than its error: check energy, pixel size, flat, "
    "fringes, and that one jet with air on both sides is in view",
    "misfit": "the counts scatter more than Poisson about the model: blur or glare that is not given, fringes, an elliptic "
    "jet, or a wrong flat or gain; the errors are widened by it",
    "outlier": "a pixel lies 8 standard deviations off: mask it if it is bad",
    "narrow_shells": "the shells are narrower than 2 pixels: use fewer",
    "no_air": "the jet reaches the end of the row: without air there, beam level and fraction are hard to tell apart",
}

_FAR = 8.0  # standard deviations of a pixel that is named


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
    excess : float
        Pearson's chi-square over the degrees of freedom: 1 for a good fit.
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
    excess: float = 1.0


def row_outcome(
    model: RowModel,
    best: tuple[FloatArray, bool, int, float],
    free: list[int],
    data: FloatArray,
    lit: BoolArray,
    said: tuple[str, ...] = (),
    misfit: str = FLAGS["misfit"],
    shells: tuple[FloatArray, FloatArray] | None = None,
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
    misfit : str
        What to say where the counts scatter too much.
    shells : (ndarray, ndarray), optional
        Edges r/R and, shape (shells, model.shells), the means over them of the model's profile, where that is no staircase.
    """
    at, converged, iterations, deviance = best
    k = model.shells
    expected, jacobian = model.evaluate(at)
    mean, used = expected[lit], jacobian[lit]
    names = tuple(model.names[i] for i in free)
    known = model.known_before()
    covariance = covariance_bound(mean, used[:, free], names, None if known is None else known[free])
    alone = covariance_bound(mean, used[:, :k], names[:k])
    fraction, edges = at[:k], model.edges
    if shells is not None:
        edges, means = shells
        fraction = means @ fraction
        covariance, alone = turned_covariance(covariance, means), turned_covariance(alone, means)
        names = (*(f"fraction[{j}]" for j in range(fraction.size)), *names[k:])
    weights, count = shell_weights(edges), fraction.size
    sd = np.zeros(at.size)
    deviations = np.sqrt(np.diag(covariance))
    sd[[i for i in free if i >= k]] = deviations[count:]
    freedom = int(lit.sum()) - len(free)
    pearson = float(((data[lit] - mean) ** 2 / mean).sum()) / model.scatter
    fit = RowFit(
        jet=RoundJet(fraction, float(at[k]), float(at[k + 1]), edges),
        fraction_std=deviations[:count],
        mean_fraction=float(weights @ fraction),
        mean_fraction_std=float(np.sqrt(weights @ covariance[:count, :count] @ weights)),
        limit_std=float(np.sqrt(weights @ alone @ weights)),
        values=dict(zip(model.names[k:], at[k:].tolist(), strict=True)),
        std=dict(zip(model.names[k:], sd[k:].tolist(), strict=True)),
        names=names,
        covariance=covariance,
        expected=expected,
        deviance=deviance,
        degrees_of_freedom=freedom,
        misfit=float((pearson - freedom) / np.sqrt(2.0 * max(freedom, 1) + (1.0 / mean).sum())),
        excess=pearson / max(freedom, 1),
        converged=converged,
        iterations=iterations,
        warnings=(),
    )
    noise = np.sqrt(np.where(lit, expected, 1.0) * model.scatter)
    residual = np.where(lit, (data - expected) / noise, 0.0)
    flags = _flags(fit, model, residual)
    worst = int(np.argmax(np.abs(residual)))
    words = [FLAGS[name] for name in flags]
    if "outlier" in flags:
        words[flags.index("outlier")] = (
            f"pixel {worst} lies {residual[worst]:+.0f} standard deviations off: mask it if it is bad"
        )
    if "misfit" in flags:
        words[flags.index("misfit")] = misfit
    return replace(fit, flags=tuple(flags), warnings=(*said, *words))


def turned_covariance(covariance: FloatArray, means: FloatArray) -> FloatArray:
    """Covariance of the means of the first unknowns, and of the others."""
    shells, own = means.shape
    turn = np.zeros((covariance.shape[0] + shells - own, covariance.shape[0]))
    turn[:shells, :own] = means
    turn[shells:, own:] = np.eye(covariance.shape[0] - own)
    return np.asarray(turn @ covariance @ turn.T)


def _flags(fit: RowFit, model: RowModel, residual: FloatArray) -> list[str]:
    """What is odd about a fit."""
    half = 0.5 * model.pixel * model.flat.size
    rim, room = float(fit.jet.fraction[-1]), 1.0 + 5.0 * float(fit.fraction_std[-1])
    odd = {
        "not_converged": not fit.converged,
        "noisy": fit.mean_fraction_std > abs(fit.mean_fraction),
        "not_gaussian": fit.mean_fraction_std > 0.2 and fit.std["radius"] > 0,
        "impossible": not -3 * fit.mean_fraction_std <= fit.mean_fraction <= 1 + 3 * fit.mean_fraction_std
        or not -room <= rim <= 1.0 + room,
        "misfit": fit.misfit > 4,
        "outlier": bool(np.abs(residual).max() > _FAR),
        "narrow_shells": fit.jet.radius < 2 * fit.jet.fraction.size * model.pixel,
        "no_air": abs(fit.jet.axis) + fit.jet.radius > half - 3 * model.pixel,
    }
    return [name for name, true in odd.items() if true]
