"""Dimensionless numbers of the review's Sections II and V.B.2, in SI, with what is misprinted there put right.

* Eq. in II: the charge relaxation time in Gaussian units is ``eps / (4 pi sigma_e)``: 0.35 to 3.5 ms for eps = 40 and
  1e-6 to 1e-7 S/m, not 4 to 45 ms.
* The electric Bond number ``Bo = r E^2 / alpha`` (Gaussian) is not the ratio of the pressures it is read as: that is ``Bo
  / (16 pi)``.
* V.B.2: ``omega_c^max`` is a wavenumber (`capillary.fastest_capillary`). "De ~ 680" follows with ``G theta = mu_e`` and a
  density of 0.85 g/cm3; with the fluid's own ``G theta / mu_s`` it is 10.7.
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray
from spinline.base.constants import EPS0

__all__ = [
    "charge_relaxation_time",
    "critical_stress",
    "electric_bond",
    "electric_over_capillary_pressure",
    "elongational_capillary",
    "hydrodynamic_time",
    "jian_deborah",
]


def charge_relaxation_time(permittivity: ArrayLike, conductivity: ArrayLike) -> FloatArray:
    """``eps eps_0 / K`` in s.

    Examples
    --------
    >>> round(float(charge_relaxation_time(40.0, 1e-7)) * 1e3, 2)
    3.54
    """
    value: FloatArray = np.asarray(permittivity) * EPS0 / np.asarray(conductivity)
    return value


def hydrodynamic_time(viscosity: ArrayLike, radius: ArrayLike, surface_tension: ArrayLike) -> FloatArray:
    """``mu r / gamma`` in s."""
    value: FloatArray = np.asarray(viscosity) * np.asarray(radius) / np.asarray(surface_tension)
    return value


def electric_bond(radius: ArrayLike, electric_field: ArrayLike, surface_tension: ArrayLike) -> FloatArray:
    """The review's ``Bo = r E^2 / alpha``, as it is in Gaussian units: ``4 pi eps_0 r E^2 / gamma``."""
    value: FloatArray = 4 * np.pi * EPS0 * np.asarray(radius) * np.asarray(electric_field) ** 2 / surface_tension
    return value


def electric_over_capillary_pressure(
    radius: ArrayLike, electric_field: ArrayLike, surface_tension: ArrayLike
) -> FloatArray:
    """``(eps_0 E^2 / 2) / (2 gamma / r) = Bo / (16 pi)``.

    Examples
    --------
    >>> round(float(electric_bond(1e-3, 3e5, 0.05)), 2), round(float(electric_over_capillary_pressure(1e-3, 3e5, 0.05)), 5)
    (0.2, 0.00398)
    """
    value: FloatArray = EPS0 * np.asarray(electric_field) ** 2 * np.asarray(radius) / (4 * np.asarray(surface_tension))
    return value


def elongational_capillary(
    elongational_viscosity: ArrayLike, velocity: ArrayLike, surface_tension: ArrayLike
) -> FloatArray:
    """``Ca = mu_e v / gamma``: above 1 the thread jets, below it drips."""
    value: FloatArray = np.asarray(elongational_viscosity) * np.asarray(velocity) / np.asarray(surface_tension)
    return value


def jian_deborah(
    *,
    relaxation_time: float,
    radius: float,
    density: float,
    elongational_viscosity: float,
    elastic_over_solvent: float,
    capillary: float,
) -> float:
    """Elastic time over the capillary growth time as V.B.2 builds it, ``theta x* / t*`` (Jian et al. 2006).

    Parameters
    ----------
    relaxation_time, radius, density : float
        theta (s), r_0 (m), rho (kg/m3).
    elongational_viscosity : float
        mu_e in Pa s.
    elastic_over_solvent : float
        ``G theta / mu_s``; ``S = 1 / (1 + G theta / mu_s)``.
    capillary : float
        Ca.
    """
    share = 1 / (1 + elastic_over_solvent)
    wavenumber = 1 / np.sqrt(2 * (1 + 3 * share * np.sqrt(capillary / 2)))
    return float(relaxation_time * wavenumber / (radius**2 * share * density / elongational_viscosity))


def critical_stress(radius_ratio: ArrayLike, capillary: ArrayLike) -> FloatArray:
    """Dimensionless tensile stress that suppresses capillary breakup: ``(r / r_0) / (2 Ca)``.

    Examples
    --------
    >>> round(float(critical_stress(0.1, 279.5)) * 1e4, 2)
    1.79
    """
    value: FloatArray = np.asarray(radius_ratio) / (2 * np.asarray(capillary))
    return value
