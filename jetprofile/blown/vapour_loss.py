"""Solvent lost along a straight blown jet whose velocity is held, Eqs. (43a), (44).

``d(f v)/dz = -pi D_a b``, ``b = 0.495 Re_a^(1/3) Sc^(1/2) dC``, ``Re_a = 2 a |w|/nu`` with the slip w; with F the volume left,
``a = (Q F/(pi v))^(1/2)``, so F^(1/6) separates::

    F = (1 - (5/6) int K |w|^(1/3) (Q/(pi v))^(1/6) dz)^(6/5)      K = pi D_a 0.495 Sc^(1/2) dC (2/nu)^(1/3)/Q

C is the vapour's mass concentration over the *liquid's density* (1.25e-5 for DMF at 293 K), which makes both sides of (43a)
agree; with the mole ratio (311 times more) the reference jet is dry within 10 mm.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import cumulative_simpson

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError

__all__ = ["drying_constant", "remaining_volume"]


def drying_constant(diffusivity: float, kinematic_viscosity: float, concentration: float) -> float:
    """``pi D_a 0.495 Sc^(1/2) dC``, m2/s; the `drying` of a bead run."""
    d, nu = positive("diffusivity", diffusivity, "m2/s"), positive("kinematic_viscosity", kinematic_viscosity, "m2/s")
    return float(np.pi * d * 0.495 * np.sqrt(nu / d) * real("concentration", concentration, least=0.0))


def remaining_volume(
    z: ArrayLike,
    velocity: ArrayLike,
    air_velocity: ArrayLike,
    flow_rate: float,
    drying: float,
    kinematic_viscosity: float,
) -> FloatArray:
    """Volume left over volume at the first place.

    Parameters
    ----------
    z, velocity, air_velocity : array_like, (n,)
        m rising, m/s, m/s.
    flow_rate : float
        Q, m3/s.
    drying : float
        `drying_constant`, m2/s.
    kinematic_viscosity : float
        Of the air, m2/s.

    Returns
    -------
    ndarray, (n,); 0 from where nothing is left.
    """
    x, v, u = (real(name, value) for name, value in (("z", z), ("velocity", velocity), ("air_velocity", air_velocity)))
    if x.ndim != 1 or x.size < 3 or v.shape != x.shape or u.shape != x.shape or not (np.diff(x) > 0).all():
        raise InputError(
            "z", "must rise over three places or more, with both velocities there", value=f"shape {x.shape}"
        )
    q = positive("flow_rate", flow_rate, "m3/s")
    k = real("drying", drying, least=0.0) * (2 / positive("kinematic_viscosity", kinematic_viscosity)) ** (1 / 3) / q
    rate = k * np.cbrt(np.abs(u - v)) * (q / (np.pi * v)) ** (1 / 6)
    lost = np.concatenate([[0.0], cumulative_simpson(rate, x=x)])
    return np.asarray(np.maximum(1 - 5 / 6 * lost, 0.0) ** 1.2)
