"""Network radius and polymer fraction in the jet's core, Eqs. (39)-(40), in three forms.

::

    r_P / r       = xi_perp / xi_0                                             Eq. (39)
    walk          phi_p = phi (xi_0 / xi_perp)^2                               Eq. (40), left
    eq40          phi_p = (phi / 9) [cosh(f_0 V) + 2]^2                        Eq. (40), right
    conservative  phi_p = phi (T xi_0 / xi_perp)^2 V / (xi_par / (T xi_0)),    T = tanh(f_0) / f_0

They differ at rest (0.050752, 0.050376 and 0.05 for phi = 0.05) because the walk's rest state is ``T xi_0``,
not ``xi_0``. The conservative form is normalised there and keeps the polymer flux exactly, with an affine network that
moves at ``v_0 xi_par / xi_par(V = 1)``; `flux_fraction` is the same for any closure and any velocity u of the flux,
``phi_p = phi (xi_perp(1)/xi_perp)^2 V/u``. All grow without bound (inf beyond 1e308; the ``log_`` functions go on),
which a volume fraction cannot: `saturate` holds them at 1 and says where. Past that point the network radius is
the one that carries the polymer, ``r_P / r = phi^(1/2)``, or ``[phi V / (xi_par / xi_par(1))]^(1/2)`` for the
conservative form.

The review's other expression, ``b^3 N_s / (xi_par xi_perp^2)``, equals the conservative form when xi_perp is the
lateral mesh of the contracted network, not the walk's xi_perp; it is not offered.

References
----------
Greenfeld et al., Phys. Rev. E 84, 041806 (2011); review Eqs. (39)-(40).
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, computable, real
from spinline.base.errors import InputError
from spinline.network import _twofold
from spinline.network.lattice_walk import Conformation
from spinline.network.mesh import SolventQuality, rest_force

__all__ = [
    "compaction_velocity_ratio",
    "conservative_radius_ratio",
    "flux_fraction",
    "flux_radius_ratio",
    "fraction_conservative",
    "fraction_eq40",
    "fraction_walk",
    "log_fraction_conservative",
    "log_fraction_eq40",
    "log_fraction_walk",
    "saturate",
]


def fraction_walk(conformation: Conformation, volume_fraction: ArrayLike) -> FloatArray:
    """Polymer fraction ``phi (xi_0 / xi_perp)^2``: Eq. (40), left, with the exact walk.

    Parameters
    ----------
    conformation : Conformation
        From `random_walk` or `stretched_walk`.
    volume_fraction : array_like
        phi of the solution, in (0, 1).

    Returns
    -------
    ndarray
        Unbounded; inf where the strand is at its contour (no lateral extension left) or past 1e308.
    """
    phi = _fraction(volume_fraction)
    with np.errstate(over="ignore", divide="ignore"):  # inf is the answer there
        value: FloatArray = phi / conformation.radial_contraction**2
    return value


def log_fraction_walk(conformation: Conformation, volume_fraction: ArrayLike) -> FloatArray:
    """Natural logarithm of `fraction_walk`, finite wherever the strand is short of its contour."""
    return np.log(_fraction(volume_fraction)) - 2 * conformation.log_radial_contraction


def fraction_eq40(
    velocity_ratio: ArrayLike, volume_fraction: ArrayLike, solvent_quality: SolventQuality = "theta"
) -> FloatArray:
    """Polymer fraction ``(phi / 9) [cosh(f_0 V) + 2]^2``: Eq. (40), right, as printed.

    Parameters
    ----------
    velocity_ratio : array_like
        V > 0. The form assumes the affine force ``f_z = f_0 V``.
    volume_fraction, solvent_quality
        As for `random_walk`; f_0 is ``3 phi`` in a theta solvent, the case printed.

    Returns
    -------
    ndarray
        Unbounded; inf past 1e308.
    """
    phi, force, error = _eq40_force(velocity_ratio, volume_fraction, solvent_quality)
    with np.errstate(over="ignore"):  # inf is the answer there
        held = np.minimum(force, 709.0)
        value: FloatArray = phi / 9 * (np.cosh(held) + np.sinh(held) * error + 2) ** 2
    return np.where(force > held, np.inf, value)


def log_fraction_eq40(
    velocity_ratio: ArrayLike, volume_fraction: ArrayLike, solvent_quality: SolventQuality = "theta"
) -> FloatArray:
    """Natural logarithm of `fraction_eq40`, finite everywhere."""
    phi, force, error = _eq40_force(velocity_ratio, volume_fraction, solvent_quality)
    bracket = force + np.log((1 + np.exp(-2 * force)) / 2 + 2 * np.exp(-force))
    value: FloatArray = np.log(phi / 9) + 2 * (bracket + error)
    return value


def fraction_conservative(
    conformation: Conformation,
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    solvent_quality: SolventQuality = "theta",
) -> FloatArray:
    """Polymer fraction that conserves the polymer flux (see the module's text).

    Parameters
    ----------
    conformation : Conformation
        Strands at the same points.
    velocity_ratio : array_like
        V > 0 of the solution.
    volume_fraction, solvent_quality
        As for `random_walk`.

    Returns
    -------
    ndarray
        phi at V = 1 with the affine force; unbounded; inf past 1e308.
    """
    slip = _slip(conformation, velocity_ratio, volume_fraction, solvent_quality)
    with np.errstate(over="ignore"):  # inf is the answer there
        value: FloatArray = fraction_walk(conformation, volume_fraction) * slip
    return value


@computable
def log_fraction_conservative(
    conformation: Conformation,
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    solvent_quality: SolventQuality = "theta",
) -> FloatArray:
    """Natural logarithm of `fraction_conservative`, finite wherever the strand is short of its contour."""
    slip = _slip(conformation, velocity_ratio, volume_fraction, solvent_quality)
    value: FloatArray = log_fraction_walk(conformation, volume_fraction) + np.log(slip)
    return value


def conservative_radius_ratio(
    conformation: Conformation,
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    solvent_quality: SolventQuality = "theta",
) -> tuple[FloatArray, FloatArray]:
    """Network radius over jet radius that carries the polymer flux, and its value when compacted.

    Parameters
    ----------
    conformation, velocity_ratio, volume_fraction, solvent_quality
        As for `log_fraction_conservative`.

    Returns
    -------
    ratio : ndarray
        ``xi_perp / (T xi_0)`` while the core is below phi_p = 1, the compacted value from there on.
    compacted : ndarray
        ``[phi V / (xi_par / xi_par(1))]^(1/2)``. Above 1 the steady network cannot carry the flux.
    """
    phi = _fraction(volume_fraction)
    v = real("velocity_ratio", velocity_ratio, above=0.0)
    rest, _ = rest_force(phi, solvent_quality)
    at_rest = np.tanh(rest) / rest
    compacted: FloatArray = np.sqrt(phi * v * at_rest / conformation.axial_stretch)
    return np.maximum(conformation.radial_contraction / at_rest, compacted), compacted


def flux_fraction(
    conformation: Conformation,
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    rest_contraction: ArrayLike,
    flux_velocity_ratio: ArrayLike,
) -> FloatArray:
    """Polymer fraction that carries the flux at a given velocity: ``phi (xi_perp(1)/xi_perp)^2 V/u``.

    Parameters
    ----------
    conformation : Conformation
        Strands at the same points.
    velocity_ratio : array_like
        V > 0 of the solution.
    volume_fraction : array_like
        phi, in (0, 1).
    rest_contraction : array_like
        ``xi_perp / xi_0`` of the closure at rest, > 0.
    flux_velocity_ratio : array_like
        u over v_0, > 0.

    Returns
    -------
    ndarray
        Unbounded; inf past 1e308.
    """
    v, u = (
        real("velocity_ratio", velocity_ratio, above=0.0),
        real("flux_velocity_ratio", flux_velocity_ratio, above=0.0),
    )
    rest = real("rest_contraction", rest_contraction, above=0.0)
    with np.errstate(over="ignore"):  # inf is the answer there
        value: FloatArray = fraction_walk(conformation, volume_fraction) * (rest**2 * (v / u))
    return value


@computable
def flux_radius_ratio(
    conformation: Conformation,
    velocity_ratio: ArrayLike,
    volume_fraction: ArrayLike,
    rest_contraction: ArrayLike,
    flux_velocity_ratio: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Network radius over jet radius that goes with `flux_fraction`, and its value when compacted, ``(phi V/u)^(1/2)``."""
    phi = _fraction(volume_fraction)
    v, u = (
        real("velocity_ratio", velocity_ratio, above=0.0),
        real("flux_velocity_ratio", flux_velocity_ratio, above=0.0),
    )
    compacted: FloatArray = np.sqrt(phi * (v / u))
    rest = real("rest_contraction", rest_contraction, above=0.0)
    return np.maximum(conformation.radial_contraction / rest, compacted), compacted


def saturate(unbounded: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Volume fraction held at 1, and the flag that says where it is held.

    Parameters
    ----------
    unbounded : ndarray
        From one of the ``fraction_`` functions.

    Returns
    -------
    fraction : ndarray
        ``min(phi_p, 1)``.
    compacted : ndarray of bool
        True where the formula is at or past 1.
    """
    fraction = np.asarray(unbounded)
    if fraction.dtype.kind not in "fiu":  # infinite is beyond 1, too
        raise InputError("unbounded", "is not a real number", value=unbounded)
    return np.minimum(fraction, 1.0), fraction >= 1


def compaction_velocity_ratio(volume_fraction: ArrayLike, solvent_quality: SolventQuality = "theta") -> FloatArray:
    """Velocity ratio at which Eq. (40) gives phi_p = 1: ``V_c = acosh(3 / phi^(1/2) - 2) / f_0``.

    Parameters
    ----------
    volume_fraction, solvent_quality
        As for `random_walk`.

    Returns
    -------
    ndarray
        9.00600942256 at phi = 0.1: there the core is compact *before* full stretch (V_S = 10).

    Notes
    -----
    ``acosh(1 + u) = log1p(u + sqrt(u (u + 2)))`` with ``u = 3 (1 - phi^(1/2)) / phi^(1/2)``, exact near phi = 1.
    """
    phi = _fraction(volume_fraction)
    root = np.sqrt(phi)
    u = 3 * ((1 - phi) / (1 + root)) / root
    value: FloatArray = np.log1p(u + np.sqrt(u * (u + 2))) / rest_force(phi, solvent_quality)[0]
    return value


def _fraction(volume_fraction: ArrayLike) -> FloatArray:
    return real("volume_fraction", volume_fraction, least=1e-100, below=1.0)


def _eq40_force(
    velocity_ratio: ArrayLike, volume_fraction: ArrayLike, solvent_quality: SolventQuality
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Volume fraction, ``f_0 V`` and the rounding error it leaves."""
    v = real("velocity_ratio", velocity_ratio, above=0.0, most=1e150)
    rest, rest_error = rest_force(volume_fraction, solvent_quality)
    force, error = _twofold.product(rest, v)
    return _fraction(volume_fraction), force, error + rest_error * v


def _slip(
    conformation: Conformation, velocity_ratio: ArrayLike, volume_fraction: ArrayLike, solvent_quality: SolventQuality
) -> FloatArray:
    """``T^2 V / (xi_par / (T xi_0))``: what the conservative form adds to the walk's."""
    v = real("velocity_ratio", velocity_ratio, above=0.0)
    rest, _ = rest_force(volume_fraction, solvent_quality)
    at_rest = np.tanh(rest) / rest
    value: FloatArray = at_rest**3 * (v / conformation.axial_stretch)
    return value
