"""Force of the air on a thin jet, per length; w = air less jet.

::

    along   q_t = C_t pi a rho w |w|     C_t = 0.65 Re^-0.81 (Ziabicki, Kawai) or 0.37 Re^-0.61 (Matsui)     Re = 2 a |w|/nu
    across  q_n = C_n a rho |w_n| w_n    C_n = 1.18 + 6.8 Re^-0.89 + 1.96 Re^-0.5 - 0.0004 Re/(1 + 3.64e-7 Re^2)

The two tangential laws differ by up to 2.8 either way (Re 0.1: 4.20 and 1.51; Re 1000: 0.0024 and 0.0055). Both forces keep the
sign of w and are 0 with it: Eqs. (20), (22) as printed, a power of w, have no value where air is faster than the jet. Yarin's
C_n = 1 is for Re > 100: on a fibre of 1 um it is up to ten times too weak. For Re beyond 1e5 the laws are no longer measured.

References
----------
Ziabicki, Fundamentals of Fibre Formation (1976); Matsui, Trans. Soc. Rheol. 20, 465 (1976); Sucker, Brauer, Waerme-
Stoffuebertragung 8, 149 (1975) (across); Marheineke, Wegener, Int. J. Multiphase Flow 37, 136 (2011).
"""

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, real
from spinline.base.errors import InputError

__all__ = [
    "DRAG_LAWS",
    "TangentialLaw",
    "normal_coefficient",
    "normal_drag",
    "tangential_coefficient",
    "tangential_drag",
]

TangentialLaw = Literal["ziabicki-kawai", "matsui"]
DRAG_LAWS: dict[str, tuple[float, float]] = {"ziabicki-kawai": (0.65, 0.81), "matsui": (0.37, 0.61)}


def tangential_coefficient(reynolds: ArrayLike, law: TangentialLaw = "ziabicki-kawai") -> FloatArray:
    """C_t; Re > 0."""
    factor, power = _law(law)
    return np.asarray(factor * real("reynolds", reynolds, above=0.0) ** -power)


@computable
def tangential_drag(
    slip: ArrayLike,
    radius: ArrayLike,
    density: ArrayLike,
    kinematic_viscosity: ArrayLike,
    law: TangentialLaw = "ziabicki-kawai",
) -> FloatArray:
    """q_t in N/m, towards the air's motion; slip w in m/s of any sign, radius a in m.

    Notes
    -----
    Evaluated as ``|w|^(2 - p)``: 0, not 0/0, without slip.
    """
    factor, power = _law(law)
    w, a = real("slip", slip), real("radius", radius, above=0.0)
    rho, nu = real("density", density, above=0.0), real("kinematic_viscosity", kinematic_viscosity, above=0.0)
    return np.asarray(factor * np.pi * a * rho * (2 * a / nu) ** -power * np.abs(w) ** (2 - power) * np.sign(w))


@computable
def normal_coefficient(reynolds: ArrayLike) -> FloatArray:
    """C_n; Re > 0."""
    re = real("reynolds", reynolds, above=0.0)
    return np.asarray(1.18 + 6.8 * re**-0.89 + 1.96 * re**-0.5 - 0.0004 * re / (1 + 3.64e-7 * re**2))


@computable
def normal_drag(slip: ArrayLike, radius: ArrayLike, density: ArrayLike, kinematic_viscosity: ArrayLike) -> FloatArray:
    """q_n in N/m; slip across the jet in m/s, either sign."""
    w, a = real("slip", slip), real("radius", radius, above=0.0)
    rho, nu = real("density", density, above=0.0), real("kinematic_viscosity", kinematic_viscosity, above=0.0)
    re = 2 * a * np.abs(w) / nu
    safe = np.where(re > 0, re, 1.0)
    return np.asarray(np.where(re > 0, normal_coefficient(safe), 0.0) * a * rho * np.abs(w) * w)


def _law(law: str) -> tuple[float, float]:
    if law not in get_args(TangentialLaw):
        raise InputError("drag", "is not known", value=law, allowed='"ziabicki-kawai", "matsui"')
    return DRAG_LAWS[law]
