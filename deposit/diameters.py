"""Diameters of fibres: four weights, the lognormal law, and the comparison with measured ones.

A distribution of diameters means nothing without its weight: per `length` (what medial-axis tools on SEM images give, for
visible fibres), per `surface` or per `volume`; per fibre is a length weight with all lengths the same. From a length-weighted
sample the others follow by weights d and d^2. Lognormal with mean M and standard deviation S: ``s^2 = ln(1 + S^2/M^2)``, ``mu
= ln M - s^2/2``.

Two samples are compared by means, spreads and the largest distance of their distributions, each with a bootstrap interval: an
interval that holds 0 says that the difference is not shown, not that there is none.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.errors import InputError

__all__ = ["WEIGHTS", "Comparison", "Lognormal", "compare_diameters", "diameter_density", "lognormal", "moments"]

WEIGHTS: Mapping[str, int] = {"length": 0, "surface": 1, "volume": 2}  # powers of d beside the length


class Lognormal(NamedTuple):
    """A lognormal law of diameters; lengths in the unit of its mean."""

    mu: float
    s: float
    median: float
    rms: float
    d32: float  # <d^3>/<d^2>, the volume-weighted mean


@computable
def lognormal(mean: float, deviation: float) -> Lognormal:
    """Lognormal law of mean and standard deviation.

    Returns
    -------
    Lognormal
        The law is that of the length-weighted diameters.

    Examples
    --------
    >>> law = lognormal(300.0, 90.0)
    >>> round(law.mu, 6), round(law.s, 6), round(law.median, 3), round(law.rms, 3), round(law.d32, 3)
    (5.660694, 0.29356, 287.348, 313.209, 356.43)
    """
    m, sd = positive("mean", mean), number("deviation", deviation, least=0.0)
    s2 = float(np.log1p((sd / m) ** 2))
    mu = float(np.log(m)) - s2 / 2
    return Lognormal(mu, s2**0.5, float(np.exp(mu)), m * float(np.exp(s2 / 2)), m * float(np.exp(2 * s2)))


def moments(diameter: ArrayLike, length: ArrayLike | None = None, weight: str = "length") -> tuple[float, float]:
    """Mean and standard deviation of diameters under a weight.

    Parameters
    ----------
    diameter : array_like
        > 0.
    length : array_like, optional
        Of each piece; default all the same.
    weight : {"length", "surface", "volume"}
        The pieces' lengths, times d, times d^2.
    """
    d, w = _sample(diameter, length, weight)
    mean = float(np.average(d, weights=w))
    return mean, float(np.sqrt(np.average((d - mean) ** 2, weights=w)))


def diameter_density(
    diameter: ArrayLike, length: ArrayLike | None = None, *, edges: ArrayLike | None = None, weight: str = "length"
) -> tuple[FloatArray, FloatArray]:
    """Edges and probability density of the diameters, one over their unit.

    Parameters
    ----------
    diameter, length, weight
        As for `moments`.
    edges : array_like, optional
        Rising. Default: 50 bins over the sample.
    """
    d, w = _sample(diameter, length, weight)
    if edges is None:
        low, high = float(d.min()), float(d.max())
        pad = 0.01 * high if low == high else 0.0
        bins = np.linspace(low - pad, high + pad, 51)
    else:
        bins = real("edges", edges)
        if bins.ndim != 1 or bins.size < 2 or not (np.diff(bins) > 0).all():
            raise InputError("edges", "must rise", value=f"shape {bins.shape}")
    counts, _ = np.histogram(d, bins, weights=w)
    total = w.sum() if counts.sum() else 1.0
    return bins, counts / (total * np.diff(bins))


@dataclass(frozen=True)
class Comparison:
    """Two samples of diameters beside each other; intervals are 95 % bootstrap.

    Attributes
    ----------
    mean, deviation : tuple of float
        Of the first and second sample.
    mean_ratio, deviation_ratio, distance : tuple of float
        Second over first, and the largest distance of the cumulative distributions: value, low, high.
    counts : tuple of int
    """

    mean: tuple[float, float]
    deviation: tuple[float, float]
    mean_ratio: tuple[float, float, float]
    deviation_ratio: tuple[float, float, float]
    distance: tuple[float, float, float]
    counts: tuple[int, int]

    @property
    def mean_differs(self) -> bool:
        """The interval of the ratio of the means leaves out 1."""
        return not self.mean_ratio[1] <= 1 <= self.mean_ratio[2]


def compare_diameters(
    first: ArrayLike,
    second: ArrayLike,
    *,
    first_length: ArrayLike | None = None,
    second_length: ArrayLike | None = None,
    resamples: int = 400,
    seed: int = 0,
    most: int = 20000,
) -> Comparison:
    """Compare two samples of diameters, such as a laid mat and a measured one.

    Parameters
    ----------
    first, second : array_like
        Diameters in one unit, two or more each.
    first_length, second_length : array_like, optional
        Weights.
    resamples, seed : int
        Of the bootstrap.
    most : int
        A larger sample is thinned to this many by its weights; its interval is then that of the thinned sample.

    Raises
    ------
    InputError
        For fewer than two diameters.
    """
    rng = np.random.default_rng(int(number("seed", seed, least=0, most=2.0**53)))
    (d1, w1), (d2, w2) = _sample(first, first_length, "length"), _sample(second, second_length, "length")
    if min(d1.size, d2.size) < 2:
        raise InputError("diameters", "need two or more in each sample", value=(d1.size, d2.size))
    counts = (d1.size, d2.size)
    (d1, w1), (d2, w2) = _thin(d1, w1, most, rng), _thin(d2, w2, most, rng)
    value = _measures(d1, w1, d2, w2)
    drawn = np.empty((int(number("resamples", resamples, least=2, most=1e5)), 3))
    for row in drawn:
        i, j = rng.integers(0, d1.size, d1.size), rng.integers(0, d2.size, d2.size)
        row[:] = _measures(d1[i], w1[i], d2[j], w2[j])
    low, high = np.nanquantile(drawn, [0.025, 0.975], axis=0)
    triple = [(float(v), float(a), float(b)) for v, a, b in zip(value, low, high, strict=True)]
    (m1, s1), (m2, s2) = moments(d1, w1), moments(d2, w2)
    return Comparison((m1, m2), (s1, s2), triple[0], triple[1], triple[2], counts)


def _measures(d1: FloatArray, w1: FloatArray, d2: FloatArray, w2: FloatArray) -> tuple[float, float, float]:
    (m1, s1), (m2, s2) = moments(d1, w1), moments(d2, w2)
    at = np.sort(np.concatenate([d1, d2]))
    gap = float(np.max(np.abs(_cumulative(d1, w1, at) - _cumulative(d2, w2, at))))
    return m2 / m1, s2 / s1 if s1 > 0 else np.nan, gap


def _cumulative(d: FloatArray, w: FloatArray, at: FloatArray) -> FloatArray:
    order = np.argsort(d)
    total = np.r_[0.0, np.cumsum(w[order])]
    return np.asarray(total[np.searchsorted(d[order], at, side="right")] / total[-1])


def _thin(d: FloatArray, w: FloatArray, most: int, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    if d.size <= most:
        return d, w
    return d[rng.choice(d.size, most, p=w / w.sum())], np.ones(most)


def _sample(diameter: ArrayLike, length: ArrayLike | None, weight: str) -> tuple[FloatArray, FloatArray]:
    if weight not in WEIGHTS:
        raise InputError("weight", "is not known", value=weight, allowed=", ".join(WEIGHTS))
    d = np.ravel(real("diameter", diameter, above=0.0))
    w = np.ones(d.size) if length is None else np.ravel(real("length", length, least=0.0))
    if not d.size or w.shape != d.shape or not w.sum() > 0:
        raise InputError("diameter", "needs diameters, and a length each, not all zero", value=f"{d.size}, {w.size}")
    return d, w * d ** WEIGHTS[weight]
