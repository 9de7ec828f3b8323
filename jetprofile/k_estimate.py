"""Estimate of the power-law prefactor k from the process, text under Eq. (31).

::

    k = r_0^(2/3) v_0^(-2/3) sigma_e^(1/4) mu^(-5/12) E^(5/6)        (Gaussian CGS)

In SI, multiply by ``(4 pi eps_0)^(1/6)``. Its prefactor of order one is unknown: an estimate, not a measurement.
The other estimate printed there, from the tangential shear stress, keeps a unit (its velocity gradient should be
``v_0 k^2 / r_0``) and is not offered.

References
----------
Reznik and Zussman, Phys. Rev. E 81, 026313 (2010).
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.constants import EPS0

__all__ = ["estimate_k"]


def estimate_k(
    *,
    radius: ArrayLike,
    flow_rate: ArrayLike,
    conductivity: ArrayLike,
    viscosity: ArrayLike,
    electric_field: ArrayLike,
) -> FloatArray:
    """Prefactor k of Eq. (31) from the process conditions, to a factor of order one.

    Parameters
    ----------
    radius, flow_rate, conductivity, viscosity, electric_field : array_like
        r_0 (m), Q (m3/s), sigma_e (S/m), mu (Pa s), E (V/m), all > 0.

    Returns
    -------
    ndarray, dimensionless.

    Examples
    --------
    >>> round(float(estimate_k(radius=125e-6, flow_rate=3.2e-6 / 3600, conductivity=0.01,
    ...                        viscosity=2.0, electric_field=6e4)), 8)
    1.80625169
    """
    r = real("radius", radius, least=1e-40, most=1e40, unit="m")
    velocity = real("flow_rate", flow_rate, least=1e-40, most=1e40, unit="m3/s") / (np.pi * r**2)
    sigma = real("conductivity", conductivity, least=1e-40, most=1e40, unit="S/m")
    mu = real("viscosity", viscosity, least=1e-40, most=1e40, unit="Pa s")
    field = real("electric_field", electric_field, least=1e-40, most=1e40, unit="V/m")
    k: FloatArray = (
        (4 * np.pi * EPS0) ** (1 / 6) * (r / velocity) ** (2 / 3) * sigma**0.25 * mu ** (-5 / 12) * field ** (5 / 6)
    )
    return k
