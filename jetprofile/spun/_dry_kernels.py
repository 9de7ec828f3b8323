"""Material of an element and its drying, compiled: Eqs. (43a)-(45) along the beads, with heat.

``dV/dt = -pi l D_a Sh [C_eq(T) a(phi) - C_far]``, ``Sh = max(0.495 Re^(1/3) Sc^(1/2), Sh_least)``, a the solvent's activity by
Flory and Huggins, so that drying ends by itself; C is vapour concentration over the liquid's density. Heat:
``rho c V dT/dt = pi l k_a Nu (T_a - T) + rho L dV/dt`` with Nu from Sh by the Prandtl number. Viscosity and relaxation time
follow Eq. (45), ``mu = mu_0 10^(B (C^m - C_0^m))`` and ``theta = theta_0 (C/C_0)^n``, and an activation temperature.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    ACTIVATION,
    AIR_CONDUCTIVITY,
    AIR_TEMPERATURE,
    AIR_VISCOSITY,
    AIR_X,
    AREA,
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
    VAPOUR_DIFFUSION,
    VAPOUR_EQ,
    VAPOUR_FAR,
    VOLUME,
    VX,
    IntArray,
)

__all__ = ["drying_rates", "material"]


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
def drying_rates(n: int, y: FloatArray, p: FloatArray, w: FloatArray, dy: FloatArray) -> None:
    """Rates of volume and temperature."""
    for i in range(n):
        speed = 0.0
        for c in range(3):
            speed += (0.5 * (y[i, VX + c] + y[i + 1, VX + c]) - p[AIR_X + c]) ** 2
        radius = math.sqrt(w[AREA, i] / math.pi)
        reynolds = 2.0 * radius * math.sqrt(speed) / p[AIR_VISCOSITY]
        base = 0.495 * reynolds ** (1.0 / 3.0)
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
