"""Pixels that lie off their neighbours, in a frame as it is and over the jet's own shadow."""

from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import BoolArray, FloatArray

if TYPE_CHECKING:
    from spinline.xray.frame.blocks import Frame
    from spinline.xray.frame.track import Track

__all__ = ["lone_outliers", "residual_outliers"]

_SMOOTH, _FAR = 0.003, 6.0  # beside the jet's own shadow


def residual_outliers(frame: "Frame", track: "Track") -> BoolArray:
    """Pixels that lie off the uniform jet of their row, and off their neighbours there.

    A jet's edge hides a pixel that is a little too bright from a look at neighbours alone; divided by the jet it shows.
    """
    rows, n = frame.counts.shape
    edges = np.arange(n + 1) - 0.5 * n
    s = np.clip((edges - track.axis[:, None]) / track.radius[:, None], -1.0, 1.0)
    chord = np.diff(s * np.sqrt((1.0 - s) * (1.0 + s)) + np.arcsin(s), axis=1) * track.radius[:, None] ** 2
    u = np.linspace(-1.0, 1.0, n)
    beam = frame.flat * (track.level[:, None] * (1.0 + track.slope[:, None] * u))
    expected = beam * np.exp(np.minimum(-track.attenuation[:, None] * chord, 30.0))
    safe = np.where(frame.good & (expected > 0.0), expected, 1.0)
    ratio = np.where(frame.good & (expected > 0.0), (frame.counts - frame.dark) / safe, np.nan)
    usable = np.isfinite(ratio).any(axis=1) & track.found
    if not usable.any():
        return np.zeros((rows, n), dtype=np.bool_)
    lone = lone_outliers(ratio, np.where(frame.good, safe + frame.dark, 0.0), floor=_SMOOTH, far=_FAR)
    return np.asarray(lone & frame.good & usable[:, None])


def lone_outliers(ratio: FloatArray, photons: FloatArray, floor: float = 0.02, far: float = 8.0) -> BoolArray:
    """Pixels 8 standard deviations off the median of their neighbours along the row and along the column; NaN is no neighbour.

    Parameters
    ----------
    ratio : ndarray, shape (rows, columns)
        Transmission.
    photons : ndarray, shape (rows, columns)
        Photons that a transmission of 1 stands for.
    floor, far : float
        Share of the beam by which neighbours may differ for other reasons than noise, and standard deviations beyond it.
    """
    from scipy.ndimage import median_filter

    level = np.nanmedian(ratio)
    filled = np.where(np.isfinite(ratio), ratio, level)
    lone = np.isfinite(ratio)
    for size in ((1, 5), (5, 1)):
        if ratio.shape[0] < 5 and size[0] > 1:
            continue
        middle = median_filter(filled, size=size, mode="mirror")
        noise = np.sqrt(np.maximum(middle, 0.02) * photons + 4.0)
        lone &= np.abs(filled - middle) * photons > far * noise + floor * photons
    return np.asarray(lone)
