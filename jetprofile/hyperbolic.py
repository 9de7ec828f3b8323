"""The hyperbolic jet of Fig. 35: ``r / r_0 = 1 / (1 + s / p)``, so ``V = (1 + s / p)^2``.

Smooth from the nozzle on, exponent beta = 1 far away; measured p = 23.1. It is not the k = 1 power law of the same
figure (V = 7.46 against 32.1 at s = 40): the two published fits meet near s = 20 only for k near 0.48.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive
from spinline.jetprofile.straight import StraightJet

__all__ = ["Hyperbolic"]


class Hyperbolic(StraightJet):
    """Jet that thins as ``r / r_0 = 1 / (1 + s / p)``.

    Parameters
    ----------
    radius : float
        Initial radius r_0, m, > 0.
    flow_rate : float
        Q, m3/s, > 0.
    p : float
        Distance, in initial radii, over which the radius halves; > 0.

    Examples
    --------
    >>> jet = Hyperbolic(radius=125e-6, flow_rate=8.9e-10, p=23.1)
    >>> round(float(jet.velocity_ratio(40 * 125e-6)), 2)
    7.46
    """

    given = "radius"

    def __init__(self, *, radius: float, flow_rate: float, p: float) -> None:
        super().__init__(radius, flow_rate)
        self.p = positive("p", p)

    def formula(self) -> tuple[float, float, float]:
        """V as ``(1 + s/p)^2``."""
        return formula(self.p)

    def _parameters(self) -> dict[str, object]:
        return {"radius": self.initial_radius, "flow_rate": self.flow_rate, "p": self.p}

    def _ratio(self, s: FloatArray) -> FloatArray:
        return ratio(s, self.p)

    def _slope(self, s: FloatArray) -> FloatArray:
        return slope(s, self.p)

    def _time(self, s: FloatArray) -> FloatArray:
        return time(s, self.p)

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        return inverse(ratio, self.p)


# The law itself, for arrays of jets too: s and p broadcast. Ranges are checked by the callers.


def formula(p: Any) -> tuple[Any, Any, Any]:
    """Offset, scale and exponent of `StraightJet.formula`."""
    return 1.0, p, 2.0


def ratio(s: FloatArray, p: ArrayLike) -> FloatArray:
    """``V(s)``."""
    value: FloatArray = (1 + s / np.asarray(p)) ** 2
    return value


def slope(s: FloatArray, p: ArrayLike) -> FloatArray:
    """``dV/ds``."""
    value: FloatArray = 2 / np.asarray(p) * (1 + s / np.asarray(p))
    return value


def time(s: FloatArray, p: ArrayLike) -> FloatArray:
    """``int ds/V`` from the nozzle."""
    value: FloatArray = s / (1 + s / np.asarray(p))
    return value


def inverse(ratio: FloatArray, p: ArrayLike) -> FloatArray:
    """First s where V is reached, NaN below V = 1."""
    # sqrt(V) - 1 without the difference of near numbers
    return np.where(ratio >= 1, np.asarray(p) * (ratio - 1) / (np.sqrt(ratio) + 1), np.nan)
