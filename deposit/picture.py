"""A mat from above as a scanning electron microscope shows it: grey levels from the height of the upper surface.

Secondary electrons leave a slope more easily than a flat (brightness rises with 1/cos of the tilt, bounded), and a pit less
easily: depth below the surroundings darkens. No noise, no charging. Grey levels only: a picture to compare by eye, and by
`orientation.image_orientation`.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError

__all__ = ["grey_levels", "scale_bar"]


def grey_levels(height: ArrayLike, pixel: float, depth: float) -> FloatArray:
    """Grey levels in [0, 1].

    Parameters
    ----------
    height : array_like, (x, y)
        Of the upper surface, m.
    pixel : float
        m.
    depth : float
        Over which a pit darkens, m; a few fibre diameters.
    """
    h = real("height", height, unit="m")
    if h.ndim != 2 or min(h.shape) < 3:
        raise InputError("height", "must be a map of 3 pixels or more", value=f"shape {h.shape}")
    p, d = positive("pixel", pixel, "m"), positive("depth", depth, "m")
    gx, gy = np.gradient(ndimage.gaussian_filter(h, 0.7), p)
    tilt = np.sqrt(1 + gx**2 + gy**2)
    edge = 0.55 + 0.45 * (1 - 1 / np.minimum(tilt, 4.0)) / 0.75
    around = ndimage.maximum_filter(h, size=max(3, round(2 * d / p)))
    pit = np.exp(-np.maximum(ndimage.gaussian_filter(around, max(1.0, d / p)) - h, 0.0) / (2 * d))
    below = np.exp(-(np.quantile(h, 0.99) - np.minimum(h, np.quantile(h, 0.99))) / (8 * d))
    return np.asarray(np.clip(edge * (0.25 + 0.75 * pit) * (0.35 + 0.65 * below), 0.0, 1.0))


def scale_bar(width: float) -> tuple[float, str]:
    """A round length (m) of about a fifth of a width, and its label."""
    target = positive("width", width, "m") / 5
    decade = 10.0 ** np.floor(np.log10(target))
    length = float(decade * max(step for step in (1, 2, 5) if step * decade <= target * 1.0001))
    for unit, scale in (("nm", 1e-9), ("µm", 1e-6), ("mm", 1e-3), ("m", 1.0)):
        if length < 999.5 * scale:
            return length, f"{length / scale:.3g} {unit}"
    return length, f"{length:.3g} m"
