"""Constitutive laws of an element, compiled: rates of its conformation, its stress, its wave speed.

A law holds two numbers per element. For the conformation laws (Maxwell, Oldroyd-B, Giesekus, FENE-P) they are A_zz and
A_rr; the linear laws (Eq. 14 and its Herschel-Bulkley form) keep ``A_zz = 1 + sigma/G`` and ``A_rr = 1``.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    CONFORMATION,
    CONSISTENCY,
    EXTENT,
    INDEX,
    LINEAR_MAXWELL,
    MOBILITY,
    YIELD,
)

__all__ = ["inlet_stretch", "law_rates", "stiffness", "stress_ratio"]


@njit(cache=True, error_model="numpy")
def _spring(azz: float, arr: float, extent: float) -> float:
    """FENE-P's f; 1 where the chains have no end (extent infinite)."""
    if extent == math.inf:
        return 1.0
    return (extent - 3.0) / (extent - azz - 2.0 * arr)


@njit(cache=True, error_model="numpy")
def stress_ratio(law: int, azz: float, arr: float, p: FloatArray) -> float:
    """First normal stress difference over G."""
    if law != CONFORMATION:
        return azz - arr
    return _spring(azz, arr, p[EXTENT]) * (azz - arr)


@njit(cache=True, error_model="numpy")
def law_rates(
    law: int, rate: float, azz: float, arr: float, modulus: float, theta: float, p: FloatArray
) -> tuple[float, float]:
    """D A_zz/dt, d A_rr/dt at a strain rate."""
    if law == CONFORMATION:
        f = _spring(azz, arr, p[EXTENT])
        a = p[MOBILITY]
        zz = 2.0 * rate * azz - (f * azz - 1.0 + a * (azz - 1.0) ** 2) / theta
        rr = -rate * arr - (f * arr - 1.0 + a * (arr - 1.0) ** 2) / theta
        return zz, rr
    if law == LINEAR_MAXWELL:
        return rate - (azz - 1.0) / theta, 0.0
    size = abs(rate)
    plastic = p[YIELD] * math.tanh(size * theta * 100.0) + p[CONSISTENCY] * size ** p[INDEX]
    if rate < 0.0:
        plastic = -plastic
    return (plastic / modulus - (azz - 1.0)) / theta, 0.0


@njit(cache=True, error_model="numpy")
def stiffness(law: int, azz: float, arr: float, p: FloatArray) -> float:
    """``rho c^2/G`` of longitudinal waves: ``d(P l)/dl`` at fixed volume over ``A G``."""
    if law != CONFORMATION:
        return 1.0 - (azz - arr)
    f = _spring(azz, arr, p[EXTENT])
    value = f * (azz + 2.0 * arr)
    if p[EXTENT] != math.inf:
        value += 2.0 * f * f * (azz - arr) ** 2 / (p[EXTENT] - 3.0)
    return value


@njit(cache=True, error_model="numpy")
def inlet_stretch(law: int, ratio: float, arr: float, p: FloatArray) -> float:
    """A_zz that carries the stress difference `ratio` (over G) at a given A_rr."""
    if law != CONFORMATION or p[EXTENT] == math.inf:
        return arr + ratio
    room = p[EXTENT] - 3.0
    value: float = (ratio * (p[EXTENT] - 2.0 * arr) + room * arr) / (room + ratio)
    return value
