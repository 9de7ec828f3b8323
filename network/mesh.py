"""The entangled network at rest: mesh, strand and contour from the volume fraction.

=============================  ===================  =====================
quantity                       theta (ideal)        good (athermal)
=============================  ===================  =====================
mesh ``xi_0``                  ``b phi^-1``         ``b phi^-(3/4)``
segments ``N_s``               ``phi^-2``           ``phi^-(5/4)``
contour ``xi_max = b N_s``     ``b phi^-2``         ``b phi^-(5/4)``
``V_S = xi_max / xi_0``        ``phi^-1``           ``phi^-(1/2)``
rest force ``f_0 = 3 / V_S``   ``3 phi``            ``3 phi^(1/2)``
=============================  ===================  =====================

Scaling laws: prefactors of order one are left out, as in the review (text before Eq. 32).

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); de Gennes, Scaling Concepts in Polymer Physics (1979).
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.network import _twofold

__all__ = ["Mesh", "SolventQuality", "network_at_rest", "rest_force"]

SolventQuality = Literal["theta", "good"]


@dataclass(frozen=True)
class Mesh:
    """Network at rest, in units of the Kuhn length b where a length is meant.

    Attributes
    ----------
    size : ndarray
        Mesh ``xi_0 / b``.
    segments : ndarray
        Kuhn segments of a strand ``N_s = xi_max / b``.
    full_stretch : ndarray
        ``V_S = xi_max / xi_0``: the stretch at which a strand is its own contour, Eq. (38).
    """

    size: FloatArray
    segments: FloatArray
    full_stretch: FloatArray


def network_at_rest(volume_fraction: ArrayLike, solvent_quality: SolventQuality = "theta") -> Mesh:
    """Mesh, strand length and full stretch of the network at rest.

    Parameters
    ----------
    volume_fraction : array_like
        Polymer volume fraction phi, in (0, 1).
    solvent_quality : {"theta", "good"}
        Statistics of a strand inside the mesh.

    Returns
    -------
    Mesh
        Arrays of the shape of `volume_fraction`.

    Raises
    ------
    InputError
        If phi is outside (0, 1) or the quality unknown.
    """
    phi = real("volume_fraction", volume_fraction, least=1e-100, below=1.0)
    if check_quality(solvent_quality) == "theta":
        return Mesh(size=1 / phi, segments=phi**-2, full_stretch=1 / phi)
    return Mesh(size=phi**-0.75, segments=phi**-1.25, full_stretch=1 / np.sqrt(phi))


def rest_force(volume_fraction: ArrayLike, solvent_quality: SolventQuality = "theta") -> tuple[FloatArray, FloatArray]:
    """Rest force ``f_0 = 3 xi_0 / xi_max`` (Eq. 35b) and the rounding error it leaves.

    Parameters
    ----------
    volume_fraction, solvent_quality
        As for `network_at_rest`.

    Returns
    -------
    force, error : ndarray
        ``force + error`` is f_0 to twice the working precision.
    """
    phi = real("volume_fraction", volume_fraction, least=1e-100, below=1.0)
    if check_quality(solvent_quality) == "theta":
        return _twofold.product(phi, np.asarray(3.0))
    root = np.sqrt(phi)
    square, error = _twofold.product(root, root)
    residual = ((phi - square) - error) / (2 * root)
    force, rounding = _twofold.product(root, np.asarray(3.0))
    return force, rounding + 3 * residual


def check_quality(quality: str) -> str:
    """Return a known solvent quality, refuse any other."""
    if not isinstance(quality, str) or quality not in get_args(SolventQuality):
        raise InputError("solvent_quality", "is not known", value=quality, allowed='"theta", "good"')
    return quality
