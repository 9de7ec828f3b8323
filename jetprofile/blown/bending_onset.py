"""Where the bending of a jet in fast air is well posed, and how fast it grows where it is not.

Air that slides along a jet at w_t lifts its bends: the tension is lowered by ``rho_g w_t^2 f`` across the jet. Transverse
waves::

    c_b^2 = (sigma_zz + sigma/a - rho_g w_t^2)/rho

The string equation is hyperbolic only where that is positive. Elsewhere a mesh of spacing h grows its shortest wave at
``(2/h) (-c_b^2)^(1/2)``: without a limit, so no mesh converges. A viscous bending moment 3 mu I kappa_t bounds it::

    g^2 + (3 mu a^2/(4 rho)) k^4 g + c_b^2 k^2 = 0      fastest at (k a)^6 = -(8/9) rho^2 a^2 c_b^2/mu^2

and g -> 0 for short waves. Remedies in order: begin the bending where c_b^2 > 0; the moment; no lift, and tension never below
0.
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, real

__all__ = ["bending_growth", "fastest_bend", "mesh_growth", "wave_speed_squared"]


@computable
def wave_speed_squared(
    axial_stress: ArrayLike,
    radius: ArrayLike,
    slip: ArrayLike,
    density: ArrayLike,
    surface_tension: ArrayLike,
    air_density: ArrayLike = 1.205,
) -> FloatArray:
    """c_b^2, m2/s2, of either sign; stress in Pa, slip w_t in m/s."""
    a, rho = real("radius", radius, above=0.0), real("density", density, above=0.0)
    lift = real("air_density", air_density, least=0.0) * real("slip", slip) ** 2
    return np.asarray((real("axial_stress", axial_stress) + real("surface_tension", surface_tension) / a - lift) / rho)


@computable
def mesh_growth(wave_speed_squared: ArrayLike, spacing: ArrayLike) -> FloatArray:
    """Growth rate of the shortest wave of a chain of beads, 1/s; 0 where waves travel.

    Examples
    --------
    >>> c2 = -1.205 * 200.0**2 / 970
    >>> [round(float(mesh_growth(c2, h))) for h in (1e-3, 5e-4, 2.5e-4)]
    [14098, 28197, 56393]
    """
    c2, h = real("wave_speed_squared", wave_speed_squared), real("spacing", spacing, above=0.0)
    return np.asarray(2 / h * np.sqrt(np.maximum(-c2, 0.0)))


@computable
def bending_growth(
    wave_number: ArrayLike, wave_speed_squared: ArrayLike, radius: ArrayLike, density: ArrayLike, viscosity: ArrayLike
) -> FloatArray:
    """Growth rate with the viscous bending moment, 1/s; the larger root, 0 or below where waves travel."""
    k, c2 = real("wave_number", wave_number, least=0.0), real("wave_speed_squared", wave_speed_squared)
    a, rho = real("radius", radius, above=0.0), real("density", density, above=0.0)
    b = 3 * real("viscosity", viscosity, least=0.0) * a**2 / (4 * rho) * k**4
    root = np.sqrt(np.maximum(b * b - 4 * c2 * k**2, 0.0))
    safe = np.where(b + root > 0, b + root, 1.0)
    return np.asarray(np.where(c2 < 0, -2 * c2 * k**2 / safe, -b / 2))


@computable
def fastest_bend(
    wave_speed_squared: ArrayLike, radius: ArrayLike, density: ArrayLike, viscosity: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Wave number (1/m) and rate (1/s) of the bend that grows fastest; NaN where none does."""
    c2 = real("wave_speed_squared", wave_speed_squared)
    a, rho = real("radius", radius, above=0.0), real("density", density, above=0.0)
    mu = real("viscosity", viscosity, above=0.0)
    with np.errstate(invalid="ignore"):
        k = np.where(c2 < 0, (-8 / 9 * rho**2 * a**2 * c2 / mu**2) ** (1 / 6) / a, np.nan)
        rate = np.where(c2 < 0, bending_growth(np.where(c2 < 0, k, 1.0), np.minimum(c2, 0.0), a, rho, mu), np.nan)
    return np.asarray(k), np.asarray(rate)
