"""How strongly the hot pixels of a dark stand out of an image: once where it is raw, not at all where the dark is taken off.

A pixel's excess over the median of its neighbours is, in a raw image, what it is in a dark of the same exposure, beside what
its own sensitivity makes of the light. Over many hot pixels the slope of one with the other is the dark's share in the image;
its error is the scatter about that line.
"""

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["dark_share"]

_HOT, _LEAST = 10.0, 12  # standard deviations of the dark's pixels; pixels
_AROUND, _MOST = 5, 20_000  # pixels


def dark_share(image: FloatArray, dark: FloatArray, good: BoolArray) -> tuple[float, float] | None:
    """Share of the dark that an image holds and its standard deviation; None where too few pixels are hot.

    Parameters
    ----------
    image, dark : ndarray, shape (rows, columns)
        Counts of one exposure.
    good : ndarray of bool, shape (rows, columns)
    """
    seen = good & np.isfinite(dark) & np.isfinite(image)
    if seen.sum() < _LEAST:
        return None
    some = _picked(np.flatnonzero(seen))
    usual, spread = (1.4826 * float(np.median(np.abs(_over(a, some)))) for a in (dark, image))
    high = seen & (dark > np.median(dark[seen]) + _HOT * usual)
    if high.sum() < _LEAST:
        return None
    at = _picked(np.flatnonzero(high))
    d, f = _over(dark, at), _over(image, at)
    hot = (d > _HOT * usual) & np.isfinite(f)
    if hot.sum() < _LEAST:
        return None
    d, f = d[hot], f[hot]
    square = float(d @ d)
    share = float(d @ f) / square
    off = (f - share * d) * d
    return share, float(np.sqrt(max(float(off @ off), spread**2 * square))) / square


def _picked(at: NDArray[np.int64]) -> NDArray[np.int64]:
    """Of many pixels as many as will do, evenly spread."""
    return at[:: -(-at.size // _MOST)]


def _over(a: FloatArray, at: NDArray[np.int64]) -> FloatArray:
    """What some pixels are over the median of the square around them."""
    half = _AROUND // 2
    rows, columns = np.unravel_index(at, a.shape)
    steps = np.arange(-half, half + 1)
    around_r = np.clip(rows[:, None] + steps, 0, a.shape[0] - 1)[:, :, None]
    around_c = np.clip(columns[:, None] + steps, 0, a.shape[1] - 1)[:, None, :]
    return np.asarray(a[rows, columns] - np.median(a[around_r, around_c], axis=(1, 2)))
