"""Estimate of the power-law prefactor k from the process, text under Eq. (31): the k of a viscous jet, for beta = 1.

The review prints ``k = r_0^(2/3) v_0^(-2/3) sigma_e^(1/4) mu^(-5/12) E^(5/6)`` (Gaussian) without its prefactor. In SI::

    k = c_k A^(5/12) B^(1/4),   A = eps_0 E^2 r_0 / (mu v_0),   B = K r_0 / (eps_0 v_0)

It follows from a thread that viscosity holds back in a uniform field (``z_t^3 ~ mu Q / (eps_0 E^2)``, ``I^2 ~ eps_0
E^2 K Q z_t``), whose law is ``V = (1 + k s)^2``: **beta = 1**, not the 0.47 measured on polymer solutions. The full
equations of such a jet (`spinline.jetprofile.ehd`) give c_k = 0.435 to 0.66 over A = 1e-4 to 1, B = 1e3 to 1e5 and
gaps of 40 to 3000 radii: more at a large A or B, less in a long gap. Where the charge is still in the bulk half way
down the gap (small A, short gap) there is no such law, and c_k is larger. Read with the prefactor 1 and ``4 pi eps_0``
in place of ``eps_0`` (`printed_k`), the formula is 2.3 to 3.5 times too large.

It holds where the pull exceeds capillarity, ``4 A^(1/3) Ca > 0.5``, and the strain rate is below ``1 / (2 theta)``. The
PEO jet of Fig. 35 is on neither side of these: there take the boundary-value problem, or ``V = V1 + s / De``.

The other estimate printed there, from the tangential shear stress, keeps a unit (its velocity gradient should be
``v_0 k^2 / r_0``) and is not offered.

References
----------
Reznik and Zussman, Phys. Rev. E 81, 026313 (2010).
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.base.constants import EPS0
from spinline.base.errors import InputError

__all__ = ["K_PREFACTOR", "estimate_k", "printed_k"]

K_PREFACTOR = (0.435, 0.5, 0.66)  # least, taken, most


def estimate_k(
    *,
    radius: ArrayLike,
    flow_rate: ArrayLike,
    conductivity: ArrayLike,
    viscosity: ArrayLike,
    electric_field: ArrayLike,
    surface_tension: ArrayLike | None = None,
    relaxation_time: ArrayLike | None = None,
    prefactor: float = K_PREFACTOR[1],
) -> FloatArray:
    """Prefactor k of Eq. (31) of a viscous jet (beta = 1), within a third where it holds.

    Parameters
    ----------
    radius, flow_rate, conductivity, viscosity, electric_field : array_like
        r_0 (m), Q (m3/s), sigma_e (S/m), mu (Pa s), E (V/m), all > 0.
    surface_tension : array_like, optional
        gamma in N/m: refuses a jet that capillarity holds.
    relaxation_time : array_like, optional
        theta in s: refuses a jet that elasticity holds back.
    prefactor : float
        c_k, in [0.435, 0.66] by the full equations.

    Returns
    -------
    ndarray, dimensionless.

    Raises
    ------
    InputError
        Out of range; and outside the estimate's validity where `surface_tension` or `relaxation_time` say so.

    Examples
    --------
    >>> round(float(estimate_k(radius=125e-6, flow_rate=3.2e-6 / 3600, conductivity=0.01,
    ...                        viscosity=2.0, electric_field=6e4)), 8)
    0.59230667
    """
    r, velocity, sigma, mu, field = _checked(radius, flow_rate, conductivity, viscosity, electric_field)
    pull, conduction = EPS0 * field / mu * field * r / velocity, sigma * r / (EPS0 * velocity)
    k: FloatArray = positive("prefactor", prefactor) * pull ** (5 / 12) * conduction**0.25
    if surface_tension is not None:
        gamma = real("surface_tension", surface_tension, least=1e-40, most=1e40, unit="N/m")
        free = 4 * pull ** (1 / 3) * mu * velocity / gamma
        if np.any(free < 0.5):
            raise InputError(
                "surface_tension",
                "holds the jet: the viscous estimate of k does not apply; 4 A^(1/3) Ca",
                value=float(np.min(free)),
                allowed="[0.5, inf)",
                remedy='give k, or take profile = "needle"',
            )
    if relaxation_time is not None:
        elastic = real("relaxation_time", relaxation_time, least=0.0, unit="s") * velocity / r * pull ** (1 / 3)
        if np.any(elastic > 0.5):
            raise InputError(
                "relaxation_time",
                "is long: elasticity, not viscosity, holds the jet back; theta times its strain rate",
                value=float(np.max(elastic)),
                allowed="[0, 0.5]",
                remedy='give k, or take profile = "needle"',
            )
    return k


def printed_k(
    *,
    radius: ArrayLike,
    flow_rate: ArrayLike,
    conductivity: ArrayLike,
    viscosity: ArrayLike,
    electric_field: ArrayLike,
) -> FloatArray:
    """The review's formula as printed, prefactor 1 in Gaussian units: 2.3 to 3.5 times the k that it stands for.

    Examples
    --------
    >>> round(float(printed_k(radius=125e-6, flow_rate=3.2e-6 / 3600, conductivity=0.01,
    ...                       viscosity=2.0, electric_field=6e4)), 8)
    1.80625169
    """
    r, velocity, sigma, mu, field = _checked(radius, flow_rate, conductivity, viscosity, electric_field)
    k: FloatArray = (
        (4 * np.pi * EPS0) ** (1 / 6) * (r / velocity) ** (2 / 3) * sigma**0.25 * mu ** (-5 / 12) * field ** (5 / 6)
    )
    return k


def _checked(
    radius: ArrayLike, flow_rate: ArrayLike, conductivity: ArrayLike, viscosity: ArrayLike, electric_field: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    r = real("radius", radius, least=1e-40, most=1e40, unit="m")
    return (
        r,
        real("flow_rate", flow_rate, least=1e-40, most=1e40, unit="m3/s") / (np.pi * r**2),
        real("conductivity", conductivity, least=1e-40, most=1e40, unit="S/m"),
        real("viscosity", viscosity, least=1e-40, most=1e40, unit="Pa s"),
        real("electric_field", electric_field, least=1e-40, most=1e40, unit="V/m"),
    )
