"""The stretching crossover: at which velocity ratio is the network fully stretched, Eq. (38).

Two criteria. Eq. (38) takes the affine stretch equal to the contour, ``V_S = xi_max / xi_0`` (``1 / phi`` in a
theta solvent), at the jet radius ``r_S / r_0 = V_S^(-1/2)``; there f_z = 3 and the walk's extension is 0.83, not
"full". The other is an extension that one chooses, turned into V by the closure.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); review Eq. (38).
"""

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.network.lattice_walk import axial_force
from spinline.network.mesh import SolventQuality, network_at_rest, rest_force

__all__ = ["Closure", "crossover_velocity_ratio", "extension_velocity_ratio", "radius_ratio"]

Closure = Literal["force", "stretch"]


def crossover_velocity_ratio(volume_fraction: ArrayLike, solvent_quality: SolventQuality = "theta") -> FloatArray:
    """Velocity ratio of full stretch by Eq. (38), ``V_S = xi_max / xi_0``.

    Parameters
    ----------
    volume_fraction : array_like
        phi, in (0, 1).
    solvent_quality : {"theta", "good"}
        ``1 / phi`` or ``phi^(-1/2)``.

    Returns
    -------
    ndarray
    """
    return network_at_rest(volume_fraction, solvent_quality).full_stretch


def radius_ratio(velocity_ratio: ArrayLike) -> FloatArray:
    """Jet radius over initial radius, ``V^(-1/2)`` (volume conserved)."""
    value: FloatArray = 1 / np.sqrt(real("velocity_ratio", velocity_ratio, above=0.0))
    return value


def extension_velocity_ratio(
    extension: ArrayLike,
    volume_fraction: ArrayLike,
    *,
    closure: Closure = "force",
    affinity: ArrayLike = 1.0,
    solvent_quality: SolventQuality = "theta",
) -> FloatArray:
    """Velocity ratio at which the relative extension reaches a given value.

    Parameters
    ----------
    extension : array_like
        ``xi_par / xi_max``, in (0, 1).
    volume_fraction : array_like
        phi, in (0, 1).
    closure : {"force", "stretch"}
        Affine force (Eq. 37) or affine stretch.
    affinity : array_like, optional
        A of the force closure, > 0.
    solvent_quality : {"theta", "good"}
        Sets f_0 and the contour.

    Returns
    -------
    ndarray
        V, below 1 where the extension at rest already exceeds the criterion; NaN where no V > 0 gives it.

    Raises
    ------
    InputError
        For values out of range or an unknown closure.
    """
    x = real("extension", extension, above=0.0, below=1.0)
    full = network_at_rest(volume_fraction, solvent_quality).full_stretch
    if check_closure(closure) == "stretch":
        return x * full
    a = real("affinity", affinity, above=0.0)
    rest, _ = rest_force(volume_fraction, solvent_quality)
    v = 1 + (axial_force(x, rest) - rest) / (rest * a)
    return np.where(v > 0, v, np.nan)


def check_closure(closure: str) -> str:
    """Return a known closure, refuse any other."""
    if closure not in get_args(Closure):
        raise InputError("closure", "is not known", value=closure, allowed='"force", "stretch"')
    return closure
