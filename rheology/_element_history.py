"""Strain and reduced time along a material element, and the exact propagator of linear models between samples.

Between samples ln Lambda is a cubic with the strain rates given (a line where none are, or where a rate is not within 0 to 3
times the secant, as at a kink), and ln theta is a line. With ``dtau = dt/theta`` a linear model is ``dA = (c deps - dtau) A
+ dtau`` (c = 2 along the jet, -1 across it), and over a step, with ``x = (tau_1 - tau)/dtau`` and ``a = c deps - dtau``::

    A_1 = A_0 exp(a) + dtau int_0^1 exp(a x + c [eps_1 - eps(x) - x deps]) dx

exactly. The bracket is second order in the step and free of theta, so nothing is stiff: the integral is taken over the part
of [0, 1] that matters (forty e-foldings) with 40 Gauss points, to rounding.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss

__all__ = ["ElementHistory", "propagate"]

_EFOLDINGS, _POINTS = 40.0, 40
_BLOCK = 4096  # steps at a time: 40 points each fit the cache


@dataclass(frozen=True, eq=False)
class ElementHistory:
    """Samples (n,) and steps (n - 1,) of one element.

    Attributes
    ----------
    time, log_stretch, relaxation_time : ndarray, (n,)
        s, ln Lambda, s.
    first_rate, last_rate : ndarray, (n - 1,)
        Strain rate at both ends of each step, 1/s.
    """

    time: FloatArray
    log_stretch: FloatArray
    relaxation_time: FloatArray
    first_rate: FloatArray
    last_rate: FloatArray

    @classmethod
    def build(
        cls, time: ArrayLike, stretch_ratio: ArrayLike, relaxation_time: ArrayLike, strain_rate: ArrayLike | None
    ) -> "ElementHistory":
        """Check and complete samples; see `conformation`."""
        t = real("time", time, unit="s")
        if t.ndim != 1 or t.size < 2 or (np.diff(t) <= 0).any():
            raise InputError("time", "must be two samples or more that strictly increase", value=f"shape {t.shape}")
        level = np.log(_like("stretch_ratio", stretch_ratio, t, above=0.0, unit=""))
        theta = (
            np.broadcast_to(real("relaxation_time", relaxation_time, above=0.0, unit="s"), t.shape).copy()
            if np.ndim(relaxation_time) == 0
            else _like("relaxation_time", relaxation_time, t, above=0.0, unit="s")
        )
        secant = np.diff(level) / np.diff(t)
        first, last = secant, secant
        if strain_rate is not None:
            rate = _like("strain_rate", strain_rate, t, above=None, unit="1/s")
            good = np.ones(secant.shape, dtype=bool)
            for end in (rate[:-1], rate[1:]):
                good &= (end * np.sign(secant) >= 0) & (np.abs(end) <= 3 * np.abs(secant))
            first, last = np.where(good, rate[:-1], secant), np.where(good, rate[1:], secant)
        return cls(t, level, theta, first, last)

    def part(self, first: int, last: int) -> "ElementHistory":
        """Steps from `first` up to `last`, which is not among them."""
        samples, steps = slice(first, last + 1), slice(first, last)
        return ElementHistory(
            self.time[samples],
            self.log_stretch[samples],
            self.relaxation_time[samples],
            self.first_rate[steps],
            self.last_rate[steps],
        )

    @property
    def strain(self) -> FloatArray:
        """``ln(Lambda_1 / Lambda_0)`` of each step."""
        return np.diff(self.log_stretch)

    @property
    def reduced(self) -> FloatArray:
        """``int dt/theta`` of each step."""
        slow = -np.diff(np.log(self.relaxation_time))
        with np.errstate(over="ignore"):
            value = np.diff(self.time) / self.relaxation_time[:-1] * _mean_exp(slow)
        return real("time over relaxation_time", value, remedy="the relaxation time is too short for a double")

    def remaining_strain(self, x: FloatArray) -> FloatArray:
        """``eps_1 - eps`` where a share x of the step's reduced time is still to come; x (n - 1, points)."""
        slow = -np.diff(np.log(self.relaxation_time))[:, np.newaxis]  # tau' grows as exp(slow u)
        # share of time u to come, from x = (1 - exp(-slow u)) / (1 - exp(-slow))
        small = np.abs(slow) < 1e-9
        safe = np.where(small, 1.0, slow)
        u = np.where(small, x, -np.log1p(x * np.expm1(-safe)) / safe)
        h = np.diff(self.time)[:, np.newaxis]
        rise, last = self.strain[:, np.newaxis], self.last_rate[:, np.newaxis] * h
        bend = self.first_rate[:, np.newaxis] * h + last - 2 * rise
        value: FloatArray = u * (last + u * (rise - last - bend + u * bend))
        return value

    def rates(self, t: float) -> tuple[float, float]:
        """Strain rate and 1/theta at a time."""
        i = min(max(int(np.searchsorted(self.time, t, side="right")) - 1, 0), self.time.size - 2)
        h = float(self.time[i + 1] - self.time[i])
        u = (float(self.time[i + 1]) - t) / h
        rise, first, last = (
            float(self.log_stretch[i + 1] - self.log_stretch[i]) / h,
            self.first_rate[i],
            self.last_rate[i],
        )
        bend = first + last - 2 * rise
        rate = last + u * (2 * (rise - last - bend) + 3 * u * bend)
        theta = self.relaxation_time[i + 1] * (self.relaxation_time[i] / self.relaxation_time[i + 1]) ** u
        return float(rate), float(1 / theta)


def propagate(history: ElementHistory, weight: float, start: float) -> FloatArray:
    """``A`` of ``dA/dt = weight edot A - (A - 1)/theta`` at every sample, from `start`."""
    reduced = history.reduced
    a = weight * history.strain - reduced
    peak = np.maximum(a, 0.0)
    real("strain of a step", peak, most=600.0, remedy="sample the history more finely")
    parts = range(0, a.size, _BLOCK)
    integral = np.concatenate([_integral(history.part(i, i + _BLOCK), weight, a[i : i + _BLOCK]) for i in parts])
    gain, source = np.exp(a), reduced * integral * np.exp(peak)
    value, values = start, [start]
    for g, b in zip(gain.tolist(), source.tolist(), strict=True):
        value = g * value + b
        values.append(value)
    return real("conformation", values, remedy="the strain is too large for a linear model: use FENE-P")


def _integral(history: ElementHistory, weight: float, a: FloatArray) -> FloatArray:
    """The integral over each step, times ``exp(-max(a, 0))``."""
    nodes, weights = _gauss()
    share = 0.5 * (1 + nodes)
    reach = np.minimum(1.0, _EFOLDINGS / np.maximum(np.abs(a), _EFOLDINGS))[:, np.newaxis]
    x = np.where((a <= 0)[:, np.newaxis], share * reach, 1 - share * reach)
    bend = weight * (history.remaining_strain(x) - x * history.strain[:, np.newaxis])
    grown = np.exp(a[:, np.newaxis] * x - np.maximum(a, 0.0)[:, np.newaxis] + bend)
    value: FloatArray = 0.5 * reach[:, 0] * np.sum(weights * grown, axis=1)
    return value


@lru_cache(maxsize=1)
def _gauss() -> tuple[FloatArray, FloatArray]:
    nodes, weights = gauss(_POINTS)
    return nodes, weights


def _like(field: str, value: ArrayLike, time: FloatArray, above: float | None, unit: str) -> FloatArray:
    array = real(field, value, above=above, unit=unit)
    if array.shape != time.shape:
        raise InputError(field, "must have one value per time", value=f"{array.shape} against {time.shape}")
    return array


def _mean_exp(x: FloatArray) -> FloatArray:
    """``(exp(x) - 1)/x``, 1 at 0."""
    small = np.abs(x) < 1e-9
    safe = np.where(small, 1.0, x)
    value: FloatArray = np.where(small, 1 + 0.5 * x, np.expm1(safe) / safe)
    return value
