"""Conformation of a strand as a random walk on the cubic lattice, Eqs. (34)-(37).

Each Kuhn segment steps along one of six directions with the Boltzmann weight of the force on it,
``f = F b / (k_B T)``, uniform along the strand. With ``Z = cosh f_z + 2 cosh f_0``::

    xi_par / xi_max  = sinh(f_z) / Z
    xi_perp / xi_max = sinh(f_0) / Z
    O                = (3 cosh(f_z) / Z - 1) / 2 = (cosh f_z - cosh f_0) / Z

The axial force follows the jet velocity, ``f_z = f_0 [1 + A (V - 1)]``; ``A = 1`` is the affine closure of
Eq. (37). (The review prints Z as Q, which here is the flow rate.)

Valid for a force that varies little along one strand, and before entanglements are lost: the first
millimetres of the jet. Limits: f -> 0: extension f/3; f -> inf: extension 1, O = 1; V = 1:
``xi_par / xi_0 = tanh(f_0) / f_0``, O = 0.

References
----------
Greenfeld, Arinstein, Fezzaa, Rafailovich, Zussman, Phys. Rev. E 84, 041806 (2011).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.network import _twofold
from spinline.network.mesh import SolventQuality, network_at_rest, rest_force

__all__ = [
    "Conformation",
    "affine_force",
    "axial_force",
    "orientation",
    "random_walk",
    "relative_contraction",
    "relative_extension",
    "stretched_walk",
]


@dataclass(frozen=True)
class Conformation:
    """Mean conformation of the strands; every array has the broadcast shape of the inputs.

    Attributes
    ----------
    axial_stretch : ndarray
        ``xi_par / xi_0``.
    relative_extension : ndarray
        ``xi_par / xi_max``, at most 1.
    radial_contraction : ndarray
        ``xi_perp / xi_0``; underflows to 0 for forces beyond about 745.
    log_radial_contraction : ndarray
        Its natural logarithm, which does not.
    orientation : ndarray
        Hermans orientation O in [-1/2, 1].
    force : ndarray
        Axial force ``f_z``; inf where the strand is at its contour.
    """

    axial_stretch: FloatArray
    relative_extension: FloatArray
    radial_contraction: FloatArray
    log_radial_contraction: FloatArray
    orientation: FloatArray
    force: FloatArray

    def __getitem__(self, name: str) -> FloatArray:
        value: FloatArray = getattr(self, name)
        return value


def random_walk(
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    *,
    affinity: ArrayLike = 1.0,
    solvent_quality: SolventQuality = "theta",
) -> Conformation:
    """Conformation of the strands where the jet has been stretched by V, Eqs. (35)-(36).

    Parameters
    ----------
    velocity_ratio : array_like
        ``V = v / v_0``, or the material stretch ratio along a Lagrangian jet; > 0.
    volume_fraction : array_like
        Polymer volume fraction phi of the solution, in (0, 1).
    affinity : array_like, optional
        A of ``f_z = f_0 [1 + A (V - 1)]``, >= 0; 1 is the affine closure, Eq. (37).
    solvent_quality : {"theta", "good"}
        Sets f_0 and the contour (see `network_at_rest`).

    Returns
    -------
    Conformation

    Raises
    ------
    InputError
        For values out of range, or not finite.

    Notes
    -----
    Relative error below ``1e-13 max(1, f_z / 200)`` for phi in [1e-6, 0.9], V in [1, 1e9]; differences are
    in product form and the rounding of f_z is carried along. About 0.3 us per point.

    Examples
    --------
    >>> walk = random_walk(20.0, 0.05)
    >>> round(float(walk.relative_extension), 8), round(float(walk.orientation), 8)
    (0.82859435, 0.74906848)
    """
    rest, rest_error = rest_force(volume_fraction, solvent_quality)
    force, error, increment = _force(velocity_ratio, rest, rest_error, affinity)
    return _conformation(force, error, increment, rest, network_at_rest(volume_fraction, solvent_quality).full_stretch)


def stretched_walk(
    stretch: ArrayLike, volume_fraction: ArrayLike, *, solvent_quality: SolventQuality = "theta"
) -> Conformation:
    """Conformation of strands whose mean stretch is given: the ``"stretch"`` closure.

    Parameters
    ----------
    stretch : array_like
        ``w = xi_par / xi_0``, > 0. Beyond the contour ``xi_max / xi_0`` a strand cannot follow: it is held
        at its contour, with infinite `force` to say so.
    volume_fraction, solvent_quality
        As for `random_walk`.

    Returns
    -------
    Conformation
        Where w reaches the contour: extension 1, contraction 0, O = 1, force inf.
    """
    w = real("stretch", stretch, above=0.0)
    full = network_at_rest(volume_fraction, solvent_quality).full_stretch
    rest, _ = rest_force(volume_fraction, solvent_quality)
    w, full, rest = np.broadcast_arrays(w, full, rest)
    locked = w >= full
    extension = np.where(locked, 0.5, w / full)
    force = axial_force(extension, rest)
    free = _conformation(force, np.zeros_like(force), force - rest, rest, full)
    return Conformation(
        axial_stretch=np.where(locked, full, w),
        relative_extension=np.where(locked, 1.0, extension),
        radial_contraction=np.where(locked, 0.0, free.radial_contraction),
        log_radial_contraction=np.where(locked, -np.inf, free.log_radial_contraction),
        orientation=np.where(locked, 1.0, free.orientation),
        force=np.where(locked, np.inf, force),
    )


def affine_force(
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    *,
    affinity: ArrayLike = 1.0,
    solvent_quality: SolventQuality = "theta",
) -> FloatArray:
    """Axial force ``f_z = f_0 [1 + A (V - 1)]`` at the ends of a strand, Eqs. (35a) and (37)."""
    rest, rest_error = rest_force(volume_fraction, solvent_quality)
    return _force(velocity_ratio, rest, rest_error, affinity)[0]


def relative_extension(force: ArrayLike, rest_force: ArrayLike) -> FloatArray:
    """Axial extension ``xi_par / xi_max = sinh(f_z) / Z`` of a strand, Eq. (36a).

    Parameters
    ----------
    force : array_like
        Axial force f_z, dimensionless, any sign, at most 1e300 in size.
    rest_force : array_like
        Lateral force f_0 >= 0.

    Returns
    -------
    ndarray, in [-1, 1], broadcast shape of the inputs.

    Notes
    -----
    ``exp(-max(|f_z|, f_0))`` is factored out, so nothing overflows.
    """
    f, f0 = _forces(force, rest_force)
    shift = np.maximum(np.abs(f), f0)
    return _sinh(f, shift) / _partition(f, f0, shift)


def relative_contraction(force: ArrayLike, rest_force: ArrayLike) -> FloatArray:
    """Lateral extension ``xi_perp / xi_max = sinh(f_0) / Z``, Eq. (36b); see `relative_extension`."""
    f, f0 = _forces(force, rest_force)
    shift = np.maximum(np.abs(f), f0)
    return _sinh(f0, shift) / _partition(f, f0, shift)


def orientation(force: ArrayLike, rest_force: ArrayLike) -> FloatArray:
    """Hermans orientation ``O = (cosh f_z - cosh f_0) / Z``, in product form; see `relative_extension`."""
    f, f0 = _forces(force, rest_force)
    return _orientation(f, f0, np.abs(f) - f0)


def axial_force(extension: ArrayLike, rest_force: ArrayLike) -> FloatArray:
    """Force that holds a strand at a given extension: the inverse of `relative_extension`.

    Parameters
    ----------
    extension : array_like
        ``x = xi_par / xi_max``, in (-1, 1).
    rest_force : array_like
        Lateral force f_0, in [0, 700].

    Returns
    -------
    ndarray
        ``f_z = atanh(x) + asinh(2 cosh(f_0) x / sqrt(1 - x^2))``, exact to a few ulp.
    """
    x = real("extension", extension, above=-1.0, below=1.0)
    f0 = real("rest_force", rest_force, least=0.0, most=700.0)
    force: FloatArray = np.arctanh(x) + np.arcsinh(2 * np.cosh(f0) * (x / np.sqrt((1 - x) * (1 + x))))
    return force


def _force(
    velocity_ratio: ArrayLike, rest: FloatArray, rest_error: FloatArray, affinity: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Force f_z, the rounding error it leaves, and the increment ``f_z - f_0``."""
    v = real("velocity_ratio", velocity_ratio, least=1e-100, most=1e150)
    a = real("affinity", affinity, least=0.0, most=1e150)
    one = np.asarray(1.0)
    rise, rise_error = _twofold.total(v, -one)
    gain, gain_error = _twofold.product(a, rise)
    gain_error = gain_error + a * rise_error
    factor, factor_error = _twofold.total(one, gain)
    force, error = _twofold.product(rest, factor)
    error = error + rest * (factor_error + gain_error) + rest_error * factor
    force, error = _twofold.total(force, error)  # where 1 + A (V - 1) cancels, all of f_z is in the error
    increment = (rest + rest_error) * (gain + gain_error)
    return force, error, increment


def _conformation(
    force: FloatArray, error: FloatArray, increment: FloatArray, rest: FloatArray, full: FloatArray
) -> Conformation:
    shift = np.maximum(force, rest)
    partition = _partition(force, rest, shift)
    extension = _sinh(force, shift) / partition
    # d ln Z/df is the extension: the carried error of f enters the contraction with that weight
    contraction = full * _sinh(rest, shift) / partition * (1 - extension * error)
    log_rest_sinh = rest + np.log(-np.expm1(-2 * rest) / 2)
    log_partition = shift + np.log(partition) + extension * error
    return Conformation(
        axial_stretch=full * extension,
        relative_extension=extension,
        radial_contraction=contraction,
        log_radial_contraction=np.log(full) + log_rest_sinh - log_partition,
        orientation=_orientation(force, rest, increment),
        force=np.broadcast_to(force, extension.shape).copy(),
    )


def _forces(force: ArrayLike, rest_force: ArrayLike) -> tuple[FloatArray, FloatArray]:
    f = real("force", force, least=-1e300, most=1e300)
    f0 = real("rest_force", rest_force, least=0.0, most=1e300)
    return f, f0


def _cosh(f: FloatArray, shift: FloatArray) -> FloatArray:
    """``cosh(f) exp(-shift)``, shift >= |f|."""
    size = np.abs(f)
    scaled: FloatArray = _exp_difference(size, shift) * (1 + np.exp(-2 * size)) / 2
    return scaled


def _sinh(f: FloatArray, shift: FloatArray) -> FloatArray:
    """``sinh(f) exp(-shift)``, shift >= |f|."""
    size = np.abs(f)
    scaled: FloatArray = np.sign(f) * _exp_difference(size, shift) * (-np.expm1(-2 * size) / 2)
    return scaled


def _partition(f: FloatArray, f0: FloatArray, shift: FloatArray) -> FloatArray:
    return _cosh(f, shift) + 2 * _cosh(f0, shift)


def _orientation(f: FloatArray, f0: FloatArray, increment: FloatArray) -> FloatArray:
    """O with ``increment = |f| - f_0`` given apart, so that it is exact close to rest."""
    size = np.abs(f)
    shift = np.maximum(size, f0)
    product = np.expm1(-(size + f0)) * np.expm1(-np.abs(increment)) / 2
    value: FloatArray = np.sign(increment) * product / _partition(f, f0, shift)
    return value


def _exp_difference(a: FloatArray, b: FloatArray) -> FloatArray:
    """``exp(a - b)`` for a <= b with the rounding of the difference put back."""
    difference, error = _twofold.total(a, -b)
    value: FloatArray = np.exp(difference) * (1 + error)
    return value
