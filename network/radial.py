"""Lateral mesh across the jet, Eq. (32b): drag of the inward flow against the elasticity of the strands.

With ``v_r = -r V' v_0 / (2 r_0)`` (incompressible jet), lengths by r_0, ``h = xi_0 / r_0`` and
``kappa = alpha_v h^2 V' / (2 c)``, the beads at ``r_n``, n = 0 ... N from the axis, satisfy::

    r_{n+1} - (2 + kappa) r_n + r_{n-1} = 0,   r_0 = 0,   (1 + kappa) r_N - r_{N-1} = xi_perp

    r_n = xi_perp sinh(n q) / [2 sinh(q/2) cosh((N + 1/2) q)],   q = 2 asinh(kappa^(1/2) / 2)

so the mesh is finest on the axis and grows towards the surface over a depth of ``1 / q`` beads. It leaves out dr_n/dt: as a
network radius it is about 1 % of r_0. An estimate of how drag shares the contraction between core and skin, and a test
problem; not Eq. (39).

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); review Eq. (32b), with the sign of kappa put right.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError

__all__ = ["RadialMesh", "radial_mesh", "solve_radial_mesh"]

_MOST_BEADS = 10_000_000
_LARGEST_MESH = 1e100


@dataclass(frozen=True, eq=False)
class RadialMesh:
    """Beads across the jet, from the axis to the surface.

    Attributes
    ----------
    position : ndarray, (beads + 1,)
        ``r_n`` in the unit of the mesh given; ``position[0] = 0``.
    spacing : ndarray, (beads,)
        Lateral mesh between beads n - 1 and n, over the free mesh.
    polymer_fraction : ndarray, (beads,)
        Fraction between the beads over that of the free lateral mesh, ``(free area) / (area)`` of the annuli.
    """

    position: FloatArray
    spacing: FloatArray
    polymer_fraction: FloatArray

    @property
    def radius(self) -> float:
        """Position of the outermost bead."""
        return float(self.position[-1])


def radial_mesh(beads: int, kappa: float, mesh: float = 1.0) -> RadialMesh:
    """Closed form of Eq. (32b).

    Parameters
    ----------
    beads : int
        N, beads from the axis to the surface, 1 to 1e7.
    kappa : float
        ``alpha_v h^2 V' / (2 c)``, in [0, 1e300].
    mesh : float, optional
        Free lateral mesh xi_perp (the walk's contraction times xi_0), > 0, any unit of length.

    Returns
    -------
    RadialMesh

    Raises
    ------
    InputError
        For values out of range.

    Notes
    -----
    ``exp(-(N + 1/2) q)`` is factored out; kappa -> 0 gives ``r_n = n xi_perp``. Where drag wins, positions near the axis
    underflow to 0, and the fraction there is inf.
    """
    count, k, size = _arguments(beads, kappa, mesh)
    n = np.arange(count + 1, dtype=np.float64)
    if k == 0:
        return _profile(size * n, size)
    q = 2 * float(np.arcsinh(0.5 * np.sqrt(k)))
    # sinh(n q) / cosh((N + 1/2) q) with the growing exponentials divided out
    share = np.exp((n - count - 0.5) * q) * -np.expm1(-2 * n * q) / (1 + np.exp(-(2 * count + 1) * q))
    return _profile(size * share / (2 * np.sinh(0.5 * q)), size)


def solve_radial_mesh(beads: int, kappa: FloatArray | float, mesh: FloatArray | float = 1.0) -> RadialMesh:
    """Eq. (32b) solved as the tridiagonal system it is, for drag and free mesh that vary across the jet.

    Parameters
    ----------
    beads : int
        N, as for `radial_mesh`.
    kappa : float or ndarray, (beads,)
        Drag number of beads 1 ... N, >= 0.
    mesh : float or ndarray, (beads,)
        Free mesh of the springs that end at beads 1 ... N, > 0.

    Returns
    -------
    RadialMesh

    Notes
    -----
    ``r_{n+1} - xi_{n+1} - (2 + kappa_n) r_n + r_{n-1} + xi_n = 0``; O(N), about 0.1 us a bead.
    """
    count = _count(beads)
    k = _each("kappa", real("kappa", kappa, least=0.0, most=1e300), count)
    free = _each("mesh", real("mesh", mesh, above=0.0, most=_LARGEST_MESH), count)
    bands = np.zeros((3, count))
    bands[0, 1:] = -1.0
    bands[1] = 2 + k
    bands[1, -1] = 1 + k[-1]
    bands[2, :-1] = -1.0
    right = np.concatenate((free[:-1] - free[1:], free[-1:]))
    position = np.concatenate(([0.0], solve_banded((1, 1), bands, right)))
    return _profile(position, free)


def _profile(position: FloatArray, mesh: FloatArray | float) -> RadialMesh:
    spacing = np.diff(position) / mesh
    free = np.concatenate(([0.0], np.cumsum(np.broadcast_to(mesh, spacing.shape))))
    area, rest = np.diff(position**2), np.diff(free**2)
    fraction = np.divide(rest, area, out=np.full_like(area, np.inf), where=area > rest * 1e-300)
    return RadialMesh(position, spacing, fraction)


def _count(beads: int) -> int:
    if isinstance(beads, bool) or not isinstance(beads, int | np.integer) or not 1 <= beads <= _MOST_BEADS:
        raise InputError("beads", "is not a number of beads", value=beads, allowed=f"integers, [1, {_MOST_BEADS}]")
    return int(beads)


def _each(field: str, value: FloatArray, count: int) -> FloatArray:
    """One value a bead."""
    if value.shape not in ((), (1,), (count,)):
        raise InputError(field, "needs one value, or one for each bead", value=f"array of shape {value.shape}")
    return np.broadcast_to(value, (count,))


def _arguments(beads: int, kappa: float, mesh: float) -> tuple[int, float, float]:
    k = number("kappa", kappa, least=0.0, most=1e300)
    return _count(beads), k, number("mesh", mesh, above=0.0, most=_LARGEST_MESH)
