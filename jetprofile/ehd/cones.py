"""Cones that a static drop leans to: Taylor's, the dielectric one, and the hyperboloid of critical potential.

* Conductor, Eqs. (3)-(4): the surface is an equipotential where ``P_1/2(cos t) = 0``; the half-angle is ``pi - t`` =
  49.29 deg.
* Dielectric of relative permittivity eps: ``eps = -P(c) P'(-c) / [P'(c) P(-c)]`` with ``P = P_1/2`` and c the cosine of the
  half-angle. It is at least 17.599, reached at 30 deg: below, no cone; above, two angles.
* Hyperboloid of revolution over a plate: balance of field and capillarity at the tip gives a critical potential
  ``(1 - xi^2) ln^2((1 + xi) / (1 - xi))``, greatest where ``xi ln((1 + xi) / (1 - xi)) = 2``: half-angle 33.53 deg.

References
----------
Taylor, Proc. R. Soc. A 280, 383 (1964); Ramos and Castellanos, Phys. Fluids 6, 3207 (1994); Yarin, Koombhongse and Reneker,
J. Appl. Phys. 90, 4836 (2001). Zubarev's limit 22.2 at 39.25 deg is one point of the dielectric curve; the criterion that
singles it out is his (JETP Lett. 73, 544, 2001), not derived here.
"""

from dataclasses import dataclass
from math import acos, pi

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipe, ellipkm1

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError

__all__ = [
    "HYPERBOLOID_POTENTIAL",
    "HYPERBOLOID_TIP_RADIUS",
    "HYPERBOLOID_XI",
    "LEAST_PERMITTIVITY",
    "TAYLOR_ANGLE",
    "DielectricCone",
    "cone_permittivity",
    "dielectric_cone",
    "hyperboloid_half_angle",
    "legendre_half",
    "taylor_half_angle",
]

# Roots and extrema to more digits than a double holds; tests find them again with mpmath.
TAYLOR_ANGLE = 0.8602743467491461920702  # rad; P_1/2(-cos) = 0
LEAST_PERMITTIVITY = 17.59863986772040502511  # of a dielectric cone, at 30 degrees
HYPERBOLOID_XI = 0.8335565596009646984361  # xi ln((1 + xi)/(1 - xi)) = 2
HYPERBOLOID_POTENTIAL = 1.325486838698363161949  # critical phi_0 over sqrt(gamma d_0 / eps_0), SI
HYPERBOLOID_TIP_RADIUS = 0.4392288398906451507760  # over d_0, there


def legendre_half(x: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """``P_1/2(x)`` and its derivative for -1 < x < 1, by complete elliptic integrals.

    Examples
    --------
    >>> value, slope = legendre_half(-0.652229531969940672)
    >>> abs(float(value)) < 1e-14
    True
    """
    at = real("x", x, above=-1.0, below=1.0)
    m = 0.5 * (1.0 - at)
    k, e = ellipkm1(0.5 * (1.0 + at)), ellipe(m)
    value: FloatArray = (2 / pi) * (2 * e - k)
    # dK/dm = (E - (1 - m) K) / (2 m (1 - m)), dE/dm = (E - K) / (2 m); dm/dx = -1/2
    slope: FloatArray = -(1 / pi) * ((e - k) / m - (e - 0.5 * (1.0 + at) * k) / (m * (1.0 + at)))
    return value, slope


def taylor_half_angle() -> float:
    """Half-angle of Taylor's cone in rad.

    Examples
    --------
    >>> from math import degrees
    >>> round(degrees(taylor_half_angle()), 9)
    49.290089292
    """
    return TAYLOR_ANGLE


def cone_permittivity(half_angle: ArrayLike) -> FloatArray:
    """Relative permittivity at which a dielectric cone of this half-angle (rad) stands; infinite at Taylor's angle.

    Defined below Taylor's angle, where the field inside points along the cone.
    """
    angle = real(
        "half_angle", half_angle, above=0.0, below=TAYLOR_ANGLE, unit="rad", remedy="cones lean below 49.29 deg"
    )
    c = np.cos(angle)
    inside, inside_slope = legendre_half(c)
    outside, outside_slope = legendre_half(-c)
    value: FloatArray = -inside * outside_slope / (inside_slope * outside)
    return value


@dataclass(frozen=True)
class DielectricCone:
    """The two half-angles (rad) at which a dielectric cone stands; the upper one is met on charging."""

    upper: float
    lower: float


def dielectric_cone(permittivity: float) -> DielectricCone:
    """Half-angles of the cones of a liquid of relative permittivity eps.

    Raises
    ------
    InputError
        Below 17.6: no cone stands.

    Examples
    --------
    >>> from math import degrees
    >>> cone = dielectric_cone(80.0)
    >>> round(degrees(cone.upper), 7), round(degrees(cone.lower), 7)
    (47.2235659, 7.201391)
    """
    eps = positive("permittivity", permittivity)
    if eps < LEAST_PERMITTIVITY:
        raise InputError(
            "permittivity",
            "is too low: no cone of a dielectric stands",
            value=eps,
            allowed=f"[{LEAST_PERMITTIVITY:.10g}, 1e15]",
            remedy="the drop keeps a rounded end",
        )
    real("permittivity", eps, most=1e15)

    from scipy.optimize import brentq

    def excess(angle: float) -> float:  # well-behaved at both ends, unlike eps(angle)
        c = np.cos(angle)
        inside, inside_slope = legendre_half(c)
        outside, outside_slope = legendre_half(-c)
        return float(outside_slope * inside + eps * inside_slope * outside)

    least = pi / 6
    if excess(least) * excess(TAYLOR_ANGLE - 1e-15) > 0:
        return DielectricCone(least, least)
    upper = brentq(excess, least, TAYLOR_ANGLE, xtol=1e-15)
    lower = brentq(excess, 1e-7, least, xtol=1e-15)
    return DielectricCone(upper, lower)


def hyperboloid_half_angle() -> float:
    """Half-angle in rad of the cone that the hyperboloid of critical potential leans to.

    Examples
    --------
    >>> from math import degrees
    >>> round(degrees(hyperboloid_half_angle()), 9)
    33.534164873
    """
    return acos(HYPERBOLOID_XI)
