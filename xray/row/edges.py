"""Edges of an opaque body, such as a nozzle in view, to a part of a pixel.

Between air (transmission a) and the body (b) the edge lies where the missing light would fill up to: at the position e with
``integral of (T - b)/(a - b) = e - x_0`` over a window about the half-way point. That is exact for pixels that average over
their width and for any symmetric blur, where linear interpolation of the half-way point is off by up to 0.1 pixel.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError

__all__ = ["opaque_edges"]

_WINDOW = 8


def opaque_edges(ratio: FloatArray, std: float = 0.0) -> tuple[float, float, float]:
    """Left and right edge of an opaque body in a row of transmissions.

    Parameters
    ----------
    ratio : ndarray, shape (pixels,)
        Transmission, noise small beside 1; NaN is filled from its neighbours.
    std : float
        Its noise.

    Returns
    -------
    left, right, width_std : float
        Pixels from the start of the row; standard deviation of their distance.

    Raises
    ------
    InputError
        Where there is no body with air on both sides, or where it lets over 20 % through.
    """
    ratio = np.asarray(ratio)
    if ratio.ndim != 1 or ratio.dtype.kind not in "fiu":
        raise InputError("ratio", "must be one row of pixels", value=f"shape {ratio.shape}")
    n = ratio.size
    seen = np.isfinite(ratio)
    if seen.sum() < 8:
        raise InputError(
            "nozzle_rows", "hold too few good pixels", value=int(seen.sum()), remedy="check bad pixels and flat"
        )
    t = np.interp(np.arange(n), np.flatnonzero(seen), ratio[seen])
    end = max(3, n // 20)
    air = 0.5 * (float(np.median(t[:end])) + float(np.median(t[-end:])))
    middle = np.flatnonzero(t < 0.5 * air)
    if middle.size < 3 or middle[0] < end or middle[-1] >= n - end:
        raise InputError(
            "nozzle_rows", "show no nozzle with air on both sides", remedy="check the rows, or give pixel_size instead"
        )
    first, last = int(middle[0]), int(middle[-1])
    window = min(_WINDOW, first, n - 1 - last, (last - first) // 3)
    body = float(np.median(t[first + window : last - window + 1]))
    if body > 0.2 * air:
        raise InputError(
            "nozzle_diameter",
            f"is of a nozzle that lets {100 * body / air:.0f} % through: its edge is not sharp",
            remedy="give pixel_size instead",
        )
    left_air, right_air = (
        float(np.median(t[s])) for s in (slice(0, max(first - window, 1)), slice(last + window + 1, n))
    )
    left_part = (t[first - window : first + window] - body) / (left_air - body)
    right_part = (t[last - window + 1 : last + window + 1] - body) / (right_air - body)
    left = first - window + float(left_part.sum())
    right = last + window + 1 - float(right_part.sum())
    return left, right, 2.0 * float(np.sqrt(window)) * std / (air - body)
