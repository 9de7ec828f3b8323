"""Solvents that leave a thread side by side, each by its share of what is left, compiled."""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["leave"]


@njit(cache=True, error_model="numpy")
def leave(left: FloatArray, rates: FloatArray, volume: float) -> float:
    """Dry `volume` off a thread of ``A = 1``; how long it takes.

    ``ds_i/dt = -k_i s_i/(s A)``, s the sum. With ``d sigma = dt/(s A)`` each falls as ``exp(-k_i sigma)``, and the time is
    ``sum s_i (1 - exp(-k_i sigma))/k_i``. `left` (solvent,) is what is left of each, before and after.
    """
    if left.size == 1:
        left[0] -= volume
        alone: float = volume / rates[0]
        return alone
    some = volume < left.sum() * (1.0 - 1e-14)
    sigma = 0.0
    for _ in range(200 if some else 0):  # Newton on a curve that only rises and flattens: from the left, never past it
        gone, pace = 0.0, 0.0
        for i in range(left.size):
            gone -= left[i] * math.expm1(-rates[i] * sigma)
            pace += left[i] * rates[i] * math.exp(-rates[i] * sigma)
        further = (volume - gone) / pace
        sigma += further
        if further <= 1e-14 * sigma:
            break
    took = 0.0
    for i in range(left.size):
        part = left[i] * (-math.expm1(-rates[i] * sigma) if some else 1.0)
        took += part / rates[i]
        left[i] -= part
    return took
