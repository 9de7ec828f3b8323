"""Distinct values in order, without what `numpy.unique` imports to look for masked arrays: a tenth of a start."""

import numpy as np

from spinline.base.checks import FloatArray

__all__ = ["ascending"]


def ascending(values: FloatArray) -> FloatArray:
    """The distinct values of an array, in order.

    Parameters
    ----------
    values : ndarray
        Any shape, no NaN.

    Returns
    -------
    ndarray, (n,)
    """
    ordered: FloatArray = np.sort(values, axis=None)
    return ordered[np.concatenate(([True], ordered[1:] != ordered[:-1]))] if ordered.size else ordered
