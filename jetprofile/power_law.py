"""The power-law jet, Eq. (31): ``V = k^2 s^(2 beta)``.

An asymptote far from the nozzle: it says V = 1 at ``s_0 = k^(-1/beta)``. Between the nozzle and s_0 the jet does not
contract (V = 1), and its slope jumps from 0 to ``2 beta / s_0`` there (the downstream value is returned at s_0).

Residence time from the nozzle, ``t v_0 / r_0 = s`` up to s_0 and ``s_0 [1 + ((s / s_0)^a - 1) / a]``, a = 1 - 2 beta,
beyond: a logarithm at beta = 1/2, taken with expm1 near it.

References
----------
Review Eq. (31); Reznik and Zussman, Phys. Rev. E 81, 026313 (2010), and measured beta = 0.47 (Fig. 35).
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.jetprofile.straight import StraightJet

__all__ = ["PowerLaw"]


class PowerLaw(StraightJet):
    """Jet that thins as ``r / r_0 = s^(-beta) / k`` beyond ``s_0 = k^(-1/beta)``.

    Parameters
    ----------
    radius : float
        Initial radius r_0, m, > 0.
    flow_rate : float
        Q, m3/s, > 0.
    k : float
        Prefactor k_V of Eq. (31), > 0; of order 1, or less.
    beta : float
        Exponent, in [1/4, 1].

    Raises
    ------
    InputError
        For values out of range.

    Examples
    --------
    >>> jet = PowerLaw(radius=125e-6, flow_rate=8.9e-10, k=1.0, beta=0.47)
    >>> round(float(jet.position_of(20.0)) * 1e3, 6)
    3.026805
    """

    def __init__(self, *, radius: float, flow_rate: float, k: float, beta: float) -> None:
        super().__init__(radius, flow_rate)
        self.k = positive("k", k)
        self.beta = float(real("beta", beta, least=0.25, most=1.0, remedy="measured jets give 0.4 to 0.6"))
        reach = 10.0 ** (100 * self.beta)  # keeps s_0 within 1e-100 and 1e100
        real("k", self.k, least=1 / reach, most=reach)
        self.onset = float(self.k ** (-1 / self.beta))  # s_0

    def kinks(self) -> tuple[float, ...]:
        """The onset s_0, where the slope jumps."""
        return (self.onset,)

    def formula(self) -> tuple[float, float, float]:
        """V as ``max(s/s_0, 1)^(2 beta)``."""
        return formula(self.onset, self.beta)

    def _parameters(self) -> dict[str, object]:
        return {"radius": self.initial_radius, "flow_rate": self.flow_rate, "k": self.k, "beta": self.beta}

    def _ratio(self, s: FloatArray) -> FloatArray:
        return ratio(s, self.onset, self.beta)

    def _slope(self, s: FloatArray) -> FloatArray:
        return slope(s, self.onset, self.beta)

    def _time(self, s: FloatArray) -> FloatArray:
        return time(s, self.onset, self.beta)

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        return inverse(ratio, self.onset, self.beta)


# The law itself, for arrays of jets too: s, the onset s_0 and beta broadcast. Ranges are checked by the callers.


def formula(onset: Any, beta: Any) -> tuple[Any, Any, Any]:
    """Offset, scale and exponent of `StraightJet.formula`."""
    return 0.0, onset, 2 * beta


def ratio(s: FloatArray, onset: ArrayLike, beta: ArrayLike) -> FloatArray:
    """``V(s)``."""
    value: FloatArray = np.maximum(s / np.asarray(onset), 1.0) ** (2 * np.asarray(beta))
    return value


def slope(s: FloatArray, onset: ArrayLike, beta: ArrayLike) -> FloatArray:
    """``dV/ds``; the downstream value at s_0."""
    start, power = np.asarray(onset), 2 * np.asarray(beta)
    rise = power / start * np.maximum(s / start, 1.0) ** (power - 1)
    return np.where(s >= start, rise, 0.0)


def time(s: FloatArray, onset: ArrayLike, beta: ArrayLike) -> FloatArray:
    """``int ds/V`` from the nozzle."""
    start, exponent = np.asarray(onset), 1 - 2 * np.asarray(beta)
    log_ratio = np.log(np.maximum(s / start, 1.0))
    even = exponent == 0
    growth = np.where(even, log_ratio, np.expm1(exponent * log_ratio) / np.where(even, 1.0, exponent))
    value: FloatArray = np.minimum(s, start) + start * growth
    return value


def inverse(ratio: FloatArray, onset: ArrayLike, beta: ArrayLike) -> FloatArray:
    """First s where V is reached: 0 for V = 1, NaN below."""
    beyond = np.asarray(onset) * np.maximum(ratio, 1.0) ** (1 / (2 * np.asarray(beta)))
    return np.where(ratio > 1, beyond, np.where(ratio == 1, 0.0, np.nan))
