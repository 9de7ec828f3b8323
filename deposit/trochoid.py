"""A whipping jet on a moving belt in closed form: a circle of speed u drawn out by a belt of speed V, q = V/u.

::

    length rate / u  = (2/pi) (1 + q) E(4 q/(1 + q)^2)                        E: complete elliptic integral, parameter m
    S2, length-weighted = <cos 2 theta ds> / <ds>     S2, time-weighted = max(0, 1 - q^-2)

The same holds wherever the footprint's directions are uniform (`surrogate`). Both weights are right answers to different
questions; an image of a mat shows length.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipe, ellipkm1

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError

__all__ = ["trochoid_length_rate", "trochoid_order"]

_SERIES = 0.1
_COEFFICIENTS = (0.0, 3 / 8, -1 / 16, 19 / 1024, -1.46484375e-3, 1.617431640625e-3, 4.425e-4)  # of q^2


def trochoid_length_rate(q: ArrayLike) -> FloatArray:
    """Laid length per time over the circle's speed; q = V/u >= 0.

    Examples
    --------
    >>> [round(float(trochoid_length_rate(q)), 8) for q in (0, 1, 4)]
    [1.0, 1.27323954, 4.06274805]
    """
    ratio = real("q", q, least=0.0, most=1e150)
    value: FloatArray = 2 / np.pi * (1 + ratio) * ellipe(4 * (ratio / (1 + ratio)) / (1 + ratio))
    return value


def trochoid_order(q: ArrayLike, weight: str = "length") -> FloatArray:
    """Order parameter S2 about the machine direction.

    Parameters
    ----------
    q : array_like
        V/u >= 0.
    weight : {"length", "time"}

    Returns
    -------
    ndarray, in [0, 1).

    Notes
    -----
    Length-weighted: ``<(w^2 - 2 s^2)/w>/<w>`` with c and s the cosine and sine of the circle's own motion and
    ``w^2 = 1 + q^2 + 2 q c`` the laid speed; ``<s^2/w> = (1 + q) [(1 + q^2) E - (1 - q)^2 K]/(3 pi q^2)``. Below q = 0.1, where
    that cancels, its series in q^2, exact to 1e-14.
    """
    ratio = real("q", q, least=0.0, most=1e7)
    if weight == "time":
        safe = np.maximum(ratio, 1.0)
        return np.asarray((1 - 1 / safe) * (1 + 1 / safe))
    if weight != "length":
        raise InputError("weight", "is not known", value=weight, allowed='"length", "time"')
    q2, outer, gap = ratio**2, 1 + ratio, (1 - ratio) ** 2
    first = ellipe(4 * ratio / outer**2)
    second = np.where(gap > 0, gap * ellipkm1(np.maximum(gap, 1e-300) / outer**2), 0.0)  # (1 - q)^2 K
    large = np.maximum(q2, _SERIES**2)
    across = outer * ((1 + q2) * first - second) / (3 * np.pi * large)
    series = np.polynomial.polynomial.polyval(np.minimum(q2, _SERIES**2), _COEFFICIENTS)
    return np.asarray(np.where(ratio < _SERIES, series, 1 - across * np.pi / (outer * first)))
