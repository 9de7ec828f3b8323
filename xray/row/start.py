"""Where the jet is in a noisy row, before anything is fitted: its radius and axis to about a pixel.

A drift of the beam pulls every estimate of the radius unless it is taken out first, so a straight line is laid through the air
at both ends of the row. What is missing from it is then correlated with chords ``sqrt(1 - x^2/R^2)`` of many radii, at every
position; the pair of the largest share of the squares is the jet. The line is laid again through all pixels outside that jet,
and the search repeated. Steps in radius are 12 %, then 2 %.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["find_jet", "jet_depth"]

_Spectra = tuple[FloatArray, NDArray[np.complex128], FloatArray, BoolArray]


def find_jet(ratio: FloatArray, radius: float | None = None, axis: float | None = None) -> tuple[float, float, float]:
    """Radius, axis and depth of a jet in a row of transmissions.

    Parameters
    ----------
    ratio : ndarray, shape (pixels,)
        Counts less dark over flat, gaps filled; noise of any size.
    radius, axis : float, optional
        In pixels (axis from the middle of the row), where known.

    Returns
    -------
    radius, axis, depth : float
        Pixels, and the share of the beam that the centre chord takes (negative where there is no jet).

    Notes
    -----
    0.5 ms for 400 pixels. A jet that reaches the ends of the row, or less than about 5 standard deviations in all, is not found
    reliably: give its radius and axis.
    """
    n = ratio.size
    x = np.arange(n, dtype=np.float64) - 0.5 * (n - 1)
    end = max(3, n // 12)
    air = np.zeros(n, dtype=np.bool_)
    air[:end] = air[-end:] = True
    if radius is not None and axis is not None:
        air = _outside(x, radius, axis, air)
    coarse = (radius,) if radius is not None else _grid(1.5, 0.5 * n, 1.12)
    first = _best(_missing(ratio, x, air), _templates(n, coarse), axis)
    missing = _missing(ratio, x, _outside(x, first[0], first[1], air))
    found = _best(missing, _templates(n, coarse), axis)
    if radius is None:
        fine = _grid(max(found[0] / 1.12, 1.0), min(found[0] * 1.12, 0.5 * n), 1.02)
        found = _best(missing, _templates(n, fine), axis)
    return found


def jet_depth(ratio: FloatArray, radius: float, axis: float) -> float:
    """Share of the beam that the centre chord takes, for a jet whose radius and axis are known; arguments as in `find_jet`."""
    n = ratio.size
    x = np.arange(n, dtype=np.float64) - 0.5 * (n - 1)
    air = np.zeros(n, dtype=np.bool_)
    end = max(3, n // 12)
    air[:end] = air[-end:] = True
    chord = np.sqrt(np.maximum(1.0 - ((x - axis) / radius) ** 2, 0.0))
    return float(chord @ _missing(ratio, x, _outside(x, radius, axis, air)) / max(float(chord @ chord), 1e-300))


def _missing(ratio: FloatArray, x: FloatArray, air: BoolArray) -> FloatArray:
    at, seen = x[air], ratio[air]
    level = float(seen.mean() if seen.size > 2 else ratio.mean())
    off = at - at.mean() if seen.size > 2 else at
    slope = float(off @ seen / (off @ off)) if seen.size > 2 else 0.0
    level -= slope * float(at.mean()) if seen.size > 2 else 0.0
    line = level + slope * x
    if line.min() <= 0.1 * abs(level):  # too noisy for a slope
        line = np.full_like(x, max(float(np.mean(ratio[air])), 1e-12))
    value: FloatArray = 1.0 - ratio / line
    return value


def _outside(x: FloatArray, radius: float, axis: float, otherwise: BoolArray) -> BoolArray:
    outside: BoolArray = np.abs(x - axis) > 1.05 * radius + 3.0
    return outside if outside.sum() >= 6 else otherwise


def _grid(low: float, high: float, ratio: float) -> tuple[float, ...]:
    count = max(math.ceil(math.log(high / low) / math.log(ratio)), 1)
    return tuple(low * (high / low) ** (i / count) for i in range(count + 1))


@lru_cache(maxsize=64)
def _templates(n: int, radii: tuple[float, ...]) -> _Spectra:
    """Radii, spectra of the chords, their squares, and the positions at which the jet lies within the row."""
    size = 1 << (2 * n - 1).bit_length()
    r = np.array(radii)
    shift = np.arange(size)
    shift = np.where(shift > size // 2, shift - size, shift)
    chord = np.sqrt(np.maximum(1.0 - (shift / r[:, None]) ** 2, 0.0))
    x = np.arange(n, dtype=np.float64) - 0.5 * (n - 1)
    inside = np.abs(x) <= np.maximum(0.5 * n - r[:, None], 0.5)
    return r, np.fft.rfft(chord), (chord**2).sum(axis=1), inside


def _best(missing: FloatArray, spectra: _Spectra, axis: float | None) -> tuple[float, float, float]:
    radii, chords, squares, inside = spectra
    n = missing.size
    size = 2 * (chords.shape[1] - 1)
    product = np.fft.irfft(np.fft.rfft(missing, size) * chords, size)[:, :n]
    score = np.where(inside & (product > 0), product**2 / squares[:, None], -1.0)
    if axis is not None:
        position = int(np.clip(np.rint(axis + 0.5 * (n - 1)), 0, n - 1))
        i, j = int(np.argmax(score[:, position])), position
    else:
        i, j = divmod(int(np.argmax(score)), n)
    centre = j - 0.5 * (n - 1) if axis is None else axis
    return float(radii[i]), float(centre), float(product[i, j] / squares[i])
