"""How strongly the hot pixels of a dark stand out of an image: once where it is raw, not at all where the dark is taken off.

A pixel's excess over the median of its neighbours is, in a raw image, what it is in a dark of the same exposure, beside what
its own sensitivity makes of the light. Over many hot pixels the slope of one with the other is the dark's share in the image;
its error is the scatter about that line.
"""

import numpy as np

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["dark_share"]

_HOT, _LEAST = 10.0, 12  # standard deviations of the dark's pixels; pixels
_AROUND = 5  # pixels


def dark_share(image: FloatArray, dark: FloatArray, good: BoolArray) -> tuple[float, float] | None:
    """Share of the dark that an image holds and its standard deviation; None where too few pixels are hot.

    Parameters
    ----------
    image, dark : ndarray, shape (rows, columns)
        Counts of one exposure.
    good : ndarray of bool, shape (rows, columns)
    """
    from scipy.ndimage import median_filter

    over, light = (a - median_filter(a, _AROUND, mode="mirror") for a in (dark, image))
    seen = good & np.isfinite(over) & np.isfinite(light)
    if not seen.any():
        return None
    usual, spread = (1.4826 * float(np.median(np.abs(a[seen]))) for a in (over, light))
    hot = seen & (over > _HOT * usual)
    if hot.sum() < _LEAST:
        return None
    d, f = over[hot], light[hot]
    square = float(d @ d)
    share = float(d @ f) / square
    return share, float(np.sqrt(max(float(((f - share * d) * d) @ ((f - share * d) * d)), spread**2 * square))) / square
