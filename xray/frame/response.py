"""Light from the counts of a detector whose response is not straight."""

import numpy as np

from spinline.base.checks import FloatArray

__all__ = ["linear"]


def linear(measured: FloatArray, nonlinearity: float, level: float) -> FloatArray:
    """Light t that a response ``m = t (1 - e t/F)`` shows as m; `level` is F (1 - e), the flat as it is measured.

    Parameters
    ----------
    measured : ndarray
        Mean counts of an exposure, above dark.
    nonlinearity, level : float
        e, within +-0.2, and the measured level.
    """
    if nonlinearity == 0.0:
        return measured
    full = level / (1.0 - nonlinearity)
    inside = np.maximum(1.0 - 4.0 * nonlinearity * measured / full, 0.0)
    return np.asarray(2.0 * measured / (1.0 + np.sqrt(inside)))
