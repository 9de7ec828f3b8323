"""Numbers that say how well the network follows the flow: A, alpha_v, I, eps.

::

    tau_0   = mu b^3 / (k_B T)                       segment relaxation time
    A       = xi_0 v_0 tau_0 / (3 b^2)               Eq. (37); 1 is the affine closure
    alpha_v = xi_eff mu v_0 r_0 / (k_B T)            Eq. (33)
    I       = m v_0 / (xi_eff mu r_0)                inertia, text of Eq. (32a)
    eps     = c / alpha_v                            elastic coupling; the affine flow errs by eps dV/ds

With xi_eff = xi_0 and the same viscosity ``A = alpha_v b / (3 r_0)``: they are one number, and which viscosity
enters (solvent 1e-3 Pa s, solution 1 Pa s) decides it. Always report it.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.constants import BOLTZMANN

_USABLE: Any = {"least": 1e-40, "most": 1e40}  # keeps every product below within the range of a float

__all__ = ["BOLTZMANN", "affinity", "elastic_coupling", "segment_time", "strand_force"]


def segment_time(viscosity: ArrayLike, kuhn_length: ArrayLike, temperature: ArrayLike) -> FloatArray:
    """Relaxation time of one Kuhn segment, ``tau_0 = mu b^3 / (k_B T)``, in s (SI in)."""
    mu = real("viscosity", viscosity, **_USABLE, unit="Pa s")
    b = real("kuhn_length", kuhn_length, **_USABLE, unit="m")
    t = real("temperature", temperature, **_USABLE, unit="K")
    value: FloatArray = mu * b**3 / (BOLTZMANN * t)
    return value


def affinity(
    mesh_size: ArrayLike,
    velocity: ArrayLike,
    viscosity: ArrayLike,
    kuhn_length: ArrayLike,
    temperature: ArrayLike,
) -> FloatArray:
    """Prefactor A of Eq. (37), ``xi_0 v_0 tau_0 / (3 b^2)`` (SI in, dimensionless out).

    Examples
    --------
    >>> round(float(affinity(1e-9 / 0.05, 0.01, 1e-3, 1e-9, 293.15)), 10)
    0.0164715914
    """
    xi = real("mesh_size", mesh_size, **_USABLE, unit="m")
    v = real("velocity", velocity, **_USABLE, unit="m/s")
    mu = real("viscosity", viscosity, **_USABLE, unit="Pa s")
    b = real("kuhn_length", kuhn_length, **_USABLE, unit="m")
    t = real("temperature", temperature, **_USABLE, unit="K")
    value: FloatArray = xi * v * mu * b / (3 * BOLTZMANN * t)
    return value


def elastic_coupling(
    effective_size: ArrayLike,
    velocity: ArrayLike,
    viscosity: ArrayLike,
    radius: ArrayLike,
    temperature: ArrayLike,
) -> FloatArray:
    """Drag over elasticity, ``alpha_v = xi_eff mu v_0 r_0 / (k_B T)`` (SI in, dimensionless out)."""
    xi = real("effective_size", effective_size, **_USABLE, unit="m")
    v = real("velocity", velocity, **_USABLE, unit="m/s")
    mu = real("viscosity", viscosity, **_USABLE, unit="Pa s")
    r = real("radius", radius, **_USABLE, unit="m")
    t = real("temperature", temperature, **_USABLE, unit="K")
    value: FloatArray = xi * mu * v * r / (BOLTZMANN * t)
    return value


def strand_force(force: ArrayLike, kuhn_length: ArrayLike, temperature: ArrayLike) -> FloatArray:
    """Force at the ends of a strand in newton, ``F = f k_B T / b``.

    Parameters
    ----------
    force : array_like
        Normalised force f_z; inf (contour reached) becomes NaN.
    kuhn_length, temperature : array_like
        b in m, T in K.

    Returns
    -------
    ndarray, N. A covalent bond breaks near 5e-9.
    """
    raw = np.asarray(force)
    if raw.dtype.kind != "f":
        raw = real("force", force)
    endless = np.isposinf(raw)
    f = np.where(endless, np.nan, real("force", np.where(endless, 0.0, raw), least=-1e200, most=1e200))
    b = real("kuhn_length", kuhn_length, **_USABLE, unit="m")
    t = real("temperature", temperature, **_USABLE, unit="K")
    value: FloatArray = f * (BOLTZMANN * t / b)
    return value
