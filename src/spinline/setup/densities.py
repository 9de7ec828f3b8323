"""Densities of a solvent at many temperatures: looked up, or interpolated where that is exact to rounding."""

from collections.abc import Mapping

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.rheology.materials import solvent_density

__all__ = ["densities"]

_EXACT_DENSITIES = 2048  # temperatures for which the density is looked up one by one


def densities(shares: Mapping[str, float], temperature: FloatArray) -> FloatArray:
    """Density of a solvent at many temperatures, NaN where it is no liquid."""
    distinct, back = np.unique(temperature, return_inverse=True)
    if distinct.size > _EXACT_DENSITIES:
        smooth = _interpolated(shares, distinct)
        if smooth is not None:
            return smooth[back]
    return np.array([_density(shares, float(t)) for t in distinct])[back]


def _density(shares: Mapping[str, float], temperature: float) -> float:
    try:
        volumes = [share / solvent_density(name, temperature) for name, share in shares.items()]
    except InputError:
        return float("nan")
    return float(1 / np.sum(volumes))


def _interpolated(shares: Mapping[str, float], temperature: FloatArray) -> FloatArray | None:
    """The same by Chebyshev interpolation, where that is exact to 1e-13; None where it is not."""
    low, high = float(temperature[0]), float(temperature[-1])
    series = np.polynomial.Chebyshev.interpolate(
        lambda t: np.array([_density(shares, float(x)) for x in t]), 48, domain=[low, high]
    )
    tests = temperature[:: max(1, temperature.size // 97)]
    exact = np.array([_density(shares, float(t)) for t in tests])
    if not np.all(np.abs(series(tests) / exact - 1) < 1e-13):
        return None
    value: FloatArray = series(temperature)
    return value
