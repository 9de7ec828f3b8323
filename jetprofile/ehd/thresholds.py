"""Voltage at which a needle begins to spin: a band, never one number.

Estimates of the same threshold differ threefold. `threshold_voltage` gives them all:

============================  ========================================================================================
``hyperboloid``               field against capillarity at the tip of a hyperboloid: ``xi_0 Lam sqrt(gamma r_c / eps_0)``
``taylor_cone``               the same times ``sqrt(cos 49.29 deg)``
``taylor_1969``               ``V^2 = 4 (H/l)^2 [ln(2 l / r) - 3/2] 0.117 pi r gamma`` (kV, cm, dyn/cm), l the needle's length
``capped_cylinder``           tip balance with the field of a cylinder with a hemispherical end
============================  ========================================================================================

`critical_hyperboloid_voltage` is another question: the greatest potential of a drop free to choose its tip radius over a
plate at distance d_0 (Eq. 1); its tip radius is then 0.44 d_0, so it is not a needle's threshold.

References
----------
Taylor, Proc. R. Soc. A 313, 453 (1969); Yarin, Koombhongse and Reneker, J. Appl. Phys. 90, 4836 (2001).
"""

import numpy as np

from spinline.base.checks import computable, positive, real
from spinline.base.constants import EPS0
from spinline.jetprofile.ehd.cones import HYPERBOLOID_POTENTIAL, TAYLOR_ANGLE
from spinline.jetprofile.ehd.fields import NeedleField

__all__ = ["critical_hyperboloid_voltage", "threshold_voltage"]


@computable
def critical_hyperboloid_voltage(surface_tension: float, distance: float) -> float:
    """Critical potential of a hyperboloidal drop at `distance` d_0 (m) from a plate, V.

    Examples
    --------
    >>> round(critical_hyperboloid_voltage(0.061, 0.1) / 1e3, 1)
    34.8
    """
    gamma = positive("surface_tension", surface_tension, "N/m")
    return float(HYPERBOLOID_POTENTIAL * np.sqrt(gamma * positive("distance", distance, "m") / EPS0))


def threshold_voltage(
    *, surface_tension: float, radius: float, gap: float, needle_length: float | None = None, closed: bool = False
) -> dict[str, float]:
    """Estimates of the voltage (V) at which a needle of this radius begins to spin over a plate at `gap`.

    Parameters
    ----------
    surface_tension, radius, gap : float
        gamma (N/m), r_c (m), H (m), all > 0.
    needle_length : float, optional
        Length l of the needle in m; Taylor's formula takes it (default: the gap), the capped cylinder too (default: 25.4
        mm).
    closed : bool
        Closed forms only, without the capped cylinder: microseconds instead of 50 ms.

    Returns
    -------
    dict
        Name of the estimate to V; see the module. Taylor's is left out where its logarithm is negative.
    """
    gamma = positive("surface_tension", surface_tension, "N/m")
    r, h = positive("radius", radius, "m"), positive("gap", gap, "m")
    real("radius", r / h, least=1e-6, most=1e3, remedy="the radius over the gap")
    share = r / h
    xi = 1 / np.sqrt(1 + share)
    tip = float(xi * np.log((1 + xi) ** 2 * (1 + share) / share) * np.sqrt(gamma * r / EPS0))
    found = {"hyperboloid": tip, "taylor_cone": tip * float(np.sqrt(np.cos(TAYLOR_ANGLE)))}
    length = h if needle_length is None else positive("needle_length", needle_length, "m")
    bracket = np.log(2 * length / r) - 1.5
    if bracket > 0:
        square = 4 * (h / length) ** 2 * bracket * 0.117 * np.pi * (r * 1e2) * (gamma * 1e3)
        found["taylor_1969"] = 1e3 * float(np.sqrt(square))
    needle = 25.4e-3 if needle_length is None else length
    if not closed and 3 <= needle / r <= 1e5 and h / r >= 0.1:
        per_volt = float(NeedleField(1.0, h, r, needle).axial(0.0))
        found["capped_cylinder"] = float(np.sqrt(4 * gamma / (EPS0 * r))) / per_volt
    return found
