"""Bending moment of the thread, compiled: what cuts off waves shorter than a few radii.

``M = (pi r^4/4) [G m + 3 mu_s dkappa/dt]``: with `VISCOUS`, ``M = (3 mu pi r^4/4) dkappa/dt``; with `ELASTIC`, the moment of
a Maxwell thread under tension, ``dm/dt = (2 A_zz + A_rr) dkappa/dt + 2 edot m - m/theta``. The curvature of a node is
the turn of the tangent over half the two lengths beside it; forces are those of the virtual work ``M . d(turn)``, so they
sum to zero. The rate is that of the *vector* of curvature: a bent thread that only turns is resisted too (a rate
that turns with the thread would spare it).
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AREA,
    ARR,
    AZZ,
    BEND_VISCOSITY,
    BENDING,
    ELASTIC,
    G_HERE,
    LENGTH,
    MX,
    RATE,
    SOLVENT_HERE,
    THETA_HERE,
    TX,
    VX,
    IntArray,
)

__all__ = ["bending_forces", "bending_rates"]


@njit(cache=True, error_model="numpy")
def _turning(i: int, c: int, y: FloatArray, w: FloatArray) -> float:
    """Component c of the rate at which the tangent of element i turns."""
    slip = y[i, VX + c] - y[i + 1, VX + c]
    value: float = slip / w[LENGTH, i] - w[RATE, i] * w[TX + c, i]
    return value


@njit(cache=True, error_model="numpy")
def _moment(i: int, c: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray) -> float:
    """Component c of the moment at node i, as the force that resists a turn, N m."""
    area = 0.5 * (w[AREA, i] + w[AREA, i - 1])
    inertia = area * area / (4.0 * math.pi)
    bent = (_turning(i - 1, c, y, w) - _turning(i, c, y, w)) / (0.5 * (w[LENGTH, i] + w[LENGTH, i - 1]))
    if k[BENDING] == ELASTIC:
        modulus = 0.5 * (w[G_HERE, i] + w[G_HERE, i - 1])
        thin = 0.5 * (w[SOLVENT_HERE, i] + w[SOLVENT_HERE, i - 1])
        value: float = inertia * (modulus * y[i, MX + c] + 3.0 * thin * bent)
        return value
    value = 3.0 * p[BEND_VISCOSITY] * inertia * bent
    return value


@njit(cache=True, error_model="numpy")
def bending_forces(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, f: FloatArray) -> None:
    """Add the forces of the moments."""
    work = [0.0, 0.0, 0.0]
    for i in range(n):
        along = 0.0
        for c in range(3):
            front = _moment(i, c, y, p, k, w) if i > 0 else 0.0
            back = _moment(i + 1, c, y, p, k, w) if i < n - 1 else 0.0
            work[c] = (back - front) / w[LENGTH, i]
            along += work[c] * w[TX + c, i]
        for c in range(3):
            push = work[c] - along * w[TX + c, i]
            f[i, c] -= push
            f[i + 1, c] += push


@njit(cache=True, error_model="numpy")
def bending_rates(n: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, dy: FloatArray) -> None:
    """Rates of the elastic moments (zero for viscous ones)."""
    for c in range(3):
        dy[0, MX + c] = 0.0
    for i in range(1, n):
        spacing = 0.5 * (w[LENGTH, i] + w[LENGTH, i - 1])
        rate = 0.5 * (w[RATE, i] + w[RATE, i - 1])
        theta = 0.5 * (w[THETA_HERE, i] + w[THETA_HERE, i - 1])
        grip = 0.5 * (2.0 * (y[i, AZZ] + y[i - 1, AZZ]) + y[i, ARR] + y[i - 1, ARR])
        for c in range(3):
            if k[BENDING] == ELASTIC:
                bent = (_turning(i - 1, c, y, w) - _turning(i, c, y, w)) / spacing
                m = y[i, MX + c]
                dy[i, MX + c] = grip * bent + 2.0 * rate * m - m / theta
            else:
                dy[i, MX + c] = 0.0
