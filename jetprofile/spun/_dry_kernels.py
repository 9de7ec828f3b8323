"""Material of an element and its drying, compiled: Eqs. (43a)-(45) along the beads, with heat.

``dV/dt = -pi l D_a Sh [C_eq(T) a(phi) - C_far]``,
``Sh = max(0.495 (2 r/nu)^(1/3) (v^2 + c v_n^2)^(1/6) Sc^(1/2), Sh_least)``, v and v_n along and across the thread (c = 64: Kase
and Matsuo; 0: Yarin), a the solvent's activity by
Flory and Huggins, so that drying ends by itself; C is vapour concentration over the liquid's density. Heat:
``rho c V dT/dt = pi l k_a Nu (T_a - T) + rho L dV/dt`` with Nu from Sh by the Prandtl number. Viscosity and relaxation time
follow Eq. (45), ``mu = mu_0 10^(B (C^m - C_0^m))`` and ``theta = theta_0 (C/C_0)^n``, and an activation temperature.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._air_kernels import air_at
from spinline.jetprofile.spun._codes import (
    ACTIVATION,
    AIR_CONDUCTIVITY,
    AIR_TEMPERATURE,
    AIR_VISCOSITY,
    AREA,
    CROSS,
    DRY_B,
    DRY_M,
    DRY_N,
    DRYING,
    FRACTION,
    G_HERE,
    HEAT_CAPACITY,
    INTERACTION,
    LABEL,
    LATENT,
    LATENT_SLOPE,
    LENGTH,
    MODULUS,
    PRANDTL,
    RHO,
    SHERWOOD_LEAST,
    SOLVENT,
    SOLVENT_HERE,
    START_TEMPERATURE,
    TEMP,
    THETA,
    THETA_HERE,
    TX,
    VAPOUR_DIFFUSION,
    VAPOUR_EQ,
    VAPOUR_FAR,
    VOLUME,
    VX,
    IntArray,
    X,
)

__all__ = ["drying_pace", "drying_rates", "material"]


@njit(cache=True, error_model="numpy")
def material(i: int, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray) -> None:
    """Modulus, relaxation time and solvent viscosity of element i."""
    if k[DRYING] == 0:
        w[G_HERE, i], w[THETA_HERE, i], w[SOLVENT_HERE, i] = p[MODULUS], p[THETA], p[SOLVENT]
        return
    richer = y[i, LABEL] / y[i, VOLUME]
    before = p[FRACTION] ** p[DRY_M]
    thick = 10.0 ** (p[DRY_B] * before * (richer ** p[DRY_M] - 1.0))
    slow = richer ** p[DRY_N]
    if p[ACTIVATION] != 0.0:
        cold = math.exp(p[ACTIVATION] * (1.0 / y[i, TEMP] - 1.0 / p[START_TEMPERATURE]))
        thick *= cold
        slow *= cold
    w[THETA_HERE, i] = p[THETA] * slow
    w[G_HERE, i] = p[MODULUS] * thick / slow
    w[SOLVENT_HERE, i] = p[SOLVENT] * thick


@njit(cache=True, error_model="numpy")
def _transfer(i: int, y: FloatArray, p: FloatArray, tables: FloatArray, w: FloatArray) -> float:
    """``0.495 (2 r/nu)^(1/3) (v^2 + c v_n^2)^(1/6)`` of element i."""
    ax, ay, az = air_at(
        0.5 * (y[i, X] + y[i + 1, X]),
        0.5 * (y[i, X + 1] + y[i + 1, X + 1]),
        0.5 * (y[i, X + 2] + y[i + 1, X + 2]),
        p,
        tables,
    )
    ux = 0.5 * (y[i, VX] + y[i + 1, VX]) - ax
    uy = 0.5 * (y[i, VX + 1] + y[i + 1, VX + 1]) - ay
    uz = 0.5 * (y[i, VX + 2] + y[i + 1, VX + 2]) - az
    along = ux * w[TX, i] + uy * w[TX + 1, i] + uz * w[TX + 2, i]
    across = max(ux * ux + uy * uy + uz * uz - along * along, 0.0)
    radius = math.sqrt(w[AREA, i] / math.pi)
    speed = 0.495 * (2.0 * radius / p[AIR_VISCOSITY]) ** (1.0 / 3.0)
    value: float = speed * (along * along + p[CROSS] * across) ** (1.0 / 6.0)
    return value


@njit(cache=True, error_model="numpy")
def drying_pace(n: int, y: FloatArray, p: FloatArray, tables: FloatArray, w: FloatArray) -> float:
    """Shortest time in which an element's fraction or temperature settles, s."""
    best = math.inf
    for i in range(n):
        base = _transfer(i, y, p, tables, w)
        sherwood = max(base * math.sqrt(p[AIR_VISCOSITY] / p[VAPOUR_DIFFUSION]), p[SHERWOOD_LEAST])
        away = math.pi * w[LENGTH, i] / y[i, VOLUME]
        rate = away * p[VAPOUR_DIFFUSION] * sherwood * p[VAPOUR_EQ]
        if p[HEAT_CAPACITY] > 0.0:
            nusselt = max(base * math.sqrt(p[PRANDTL]), p[SHERWOOD_LEAST])
            held = p[RHO] * p[HEAT_CAPACITY]
            rate = max(rate, away * p[AIR_CONDUCTIVITY] * nusselt / held)
            slope = p[LATENT_SLOPE] / y[i, TEMP] ** 2
            rate = max(
                rate, away * p[VAPOUR_DIFFUSION] * sherwood * p[VAPOUR_EQ] * p[LATENT] * slope / p[HEAT_CAPACITY]
            )
        if rate > 0.0:
            best = min(best, 1.0 / rate)
    return best


@njit(cache=True, error_model="numpy")
def drying_rates(n: int, y: FloatArray, p: FloatArray, tables: FloatArray, w: FloatArray, dy: FloatArray) -> None:
    """Rates of volume and temperature."""
    for i in range(n):
        base = _transfer(i, y, p, tables, w)
        sherwood = max(base * math.sqrt(p[AIR_VISCOSITY] / p[VAPOUR_DIFFUSION]), p[SHERWOOD_LEAST])
        polymer = p[FRACTION] * y[i, LABEL] / y[i, VOLUME]
        activity = (1.0 - polymer) * math.exp(polymer + p[INTERACTION] * polymer * polymer)
        if p[FRACTION] == 0.0:
            activity = 1.0
        temperature = y[i, TEMP]
        vapour = p[VAPOUR_EQ] * math.exp(p[LATENT_SLOPE] * (1.0 / p[START_TEMPERATURE] - 1.0 / temperature))
        rate = -math.pi * w[LENGTH, i] * p[VAPOUR_DIFFUSION] * sherwood * (vapour * activity - p[VAPOUR_FAR])
        dy[i, VOLUME] += rate
        if p[HEAT_CAPACITY] > 0.0:
            nusselt = max(base * math.sqrt(p[PRANDTL]), p[SHERWOOD_LEAST])
            gained = math.pi * w[LENGTH, i] * p[AIR_CONDUCTIVITY] * nusselt * (p[AIR_TEMPERATURE] - temperature)
            heat = p[RHO] * p[HEAT_CAPACITY] * y[i, VOLUME]
            dy[i, TEMP] = (gained + p[RHO] * p[LATENT] * rate) / heat
