"""Current of a jet in closed form: orders of magnitude. Trust exponents, not levels; a measured current is worth more.

========================  ============================================================================================
`viscous_current`         ``i = (1.25 ... 2.44) A^(-1/6) B^(-1/2)``, a viscous jet in a uniform field, from the full
equations `cone_jet_current`        ``2.6 (gamma K Q)^(1/2)``, an electrospray's cone-jet, whatever the voltage
========================  ============================================================================================

Measured on polymer jets: about ``E Q^0.5 K^0.4`` (Bhattacharjee et al., J. Appl. Polym. Sci. 117, 1210, 2010; part of it
a secondary spray); the boundary-value problem gives ``V^1.0 Q^0.37 K^0.38`` for the PEO jet of Fig. 35, and at 61 published
settings ``V^0.95 Q^0.38 K^0.49 mu^-0.03`` (medians, Newtonian; ``benchmarks/current_exponents.py``).
The closed form's ``mu^(1/6)`` is neither measured nor of these jets: it wants a uniform field and no surface tension.
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, real
from spinline.base.constants import EPS0

__all__ = ["cone_jet_current", "viscous_current"]

_RANGE = (1.25, 2.44)


@computable
def viscous_current(
    *, radius: ArrayLike, flow_rate: ArrayLike, conductivity: ArrayLike, viscosity: ArrayLike, electric_field: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Lower and upper current in A of a viscous jet in a uniform field (V/m)."""
    r, field = (
        real("radius", radius, above=0.0, unit="m"),
        real("electric_field", electric_field, above=0.0, unit="V/m"),
    )
    velocity = real("flow_rate", flow_rate, above=0.0, unit="m3/s") / (np.pi * r**2)
    pull = EPS0 * field**2 * r / (real("viscosity", viscosity, above=0.0, unit="Pa s") * velocity)
    sigma = real("conductivity", conductivity, above=0.0, unit="S/m")
    conduction = sigma * r / (EPS0 * velocity)
    scale = np.pi * r**2 * sigma * field * pull ** (-1 / 6) * conduction**-0.5
    return _RANGE[0] * scale, _RANGE[1] * scale


@computable
def cone_jet_current(surface_tension: ArrayLike, conductivity: ArrayLike, flow_rate: ArrayLike) -> FloatArray:
    """Current in A of a cone-jet."""
    gamma, sigma = real("surface_tension", surface_tension, least=0.0), real("conductivity", conductivity, least=0.0)
    value: FloatArray = 2.6 * np.sqrt(gamma * sigma * real("flow_rate", flow_rate, least=0.0, unit="m3/s"))
    return value
