"""Viscosity, relaxation time and modulus as the solution becomes more concentrated, Eq. (45) and scaling laws.

::

    mu    = mu_0 10^(B (C^m - C_0^m))              Eq. (45a)
    theta = theta_0 (C / C_0)^n                    Eq. (45b), n = +1
    mu    = mu_s + (mu_0 - mu_s) (phi / phi_0)^x   scaling, x from `scaling_exponents`
    mu    = mu_s [1 + X exp(K X)], X = c [eta]     Martin
    G     = mu / theta

Which one: Eq. (45) with B and m fitted to the solution at hand, if there is a fit; the scaling laws if only the solvent
quality is known (one measured viscosity fixes them); Martin's equation if intrinsic viscosity and Huggins-like constant
are known. All are closed forms.

The review prints Eq. (45a) with J for B and "infinity" for m, and Eq. (45b) as ``theta_0 C_0 / C``. Its source, and the
simulators that follow it, have n = +1: a more concentrated solution relaxes more slowly. The printed form is there by name.

References
----------
Yarin, Koombhongse, Reneker, J. Appl. Phys. 89, 3018 (2001); review Eqs. (45a, b). Rubinstein, Colby, Polymer Physics
(2003), chapters 8 and 9; Colby, Rheol. Acta 49, 425 (2010). Martin, as in Rao, Rheology of Fluid and Semisolid Foods.
"""

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.rheology._finite import finite_result

__all__ = [
    "RelaxationConvention",
    "ScalingExponents",
    "martin_viscosity",
    "modulus",
    "relaxation_time",
    "scaled",
    "scaled_viscosity",
    "scaling_exponents",
    "viscosity",
]

RelaxationConvention = Literal["source", "print"]
_DECADES = 300.0  # what a double holds, with room for the prefactor
_FLORY = 0.588  # swelling exponent nu in a good solvent


class ScalingExponents(NamedTuple):
    """Powers of the polymer volume fraction in a semidilute solution; viscosity = relaxation + modulus."""

    viscosity: float
    relaxation: float
    modulus: float


@finite_result("viscosity", "Pa s", positive=True)
def viscosity(
    concentration: ArrayLike,
    initial_concentration: ArrayLike,
    initial_viscosity: ArrayLike,
    B: ArrayLike = 7.0,
    m: ArrayLike = 0.1,
) -> FloatArray:
    """Zero-shear viscosity by Eq. (45a), ``mu_0 10^(B (C^m - C_0^m))``.

    Parameters
    ----------
    concentration, initial_concentration : array_like
        C and C_0, polymer *mass fraction* as in the source, in (0, 1]. Other measures of concentration need other B and m.
    initial_viscosity : array_like
        mu_0 at C_0, Pa s, > 0.
    B : array_like
        Dimensionless, >= 0; 7 in the source's example.
    m : array_like
        Dimensionless, in (0, 10]; the source gives 0.1 to 1.

    Returns
    -------
    ndarray, Pa s, broadcast shape.

    Raises
    ------
    InputError
        For a value out of range, or parameters that change the viscosity by more than 300 decades.

    Notes
    -----
    ``C^m - C_0^m`` is taken as ``C_0^m expm1(m ln(C/C_0))``: no cancellation near C_0.

    Examples
    --------
    >>> round(float(viscosity(0.12, 0.06, 1.0)), 5)
    2.39446
    """
    c, c0 = _fraction("concentration", concentration), _fraction("initial_concentration", initial_concentration)
    mu0 = real("initial_viscosity", initial_viscosity, above=0.0, unit="Pa s")
    slope = real("B", B, least=0.0)
    power = real("m", m, above=0.0, most=10.0)
    decades = slope * c0**power * np.expm1(power * np.log(c / c0))
    return mu0 * _power_of_ten("B", decades, "check B and m against C as a mass fraction")


@finite_result("relaxation time", "s", positive=True)
def relaxation_time(
    concentration: ArrayLike,
    initial_concentration: ArrayLike,
    initial_relaxation_time: ArrayLike,
    n: ArrayLike | None = None,
    convention: RelaxationConvention = "source",
) -> FloatArray:
    """Relaxation time by Eq. (45b), ``theta_0 (C / C_0)^n``.

    Parameters
    ----------
    concentration, initial_concentration : array_like
        C and C_0 in (0, 1], mass or volume fraction, both the same.
    initial_relaxation_time : array_like
        theta_0 at C_0, s, > 0.
    n : array_like, optional
        Exponent in [-10, 10], in place of the convention's.
    convention : {"source", "print"}
        n = +1, as the 2001 source has it, or n = -1, as the review prints it.

    Returns
    -------
    ndarray, s, broadcast shape.

    Raises
    ------
    InputError
        For a value out of range, an unknown convention, or n together with the printed convention.
    """
    c, c0 = _fraction("concentration", concentration), _fraction("initial_concentration", initial_concentration)
    theta0 = real("initial_relaxation_time", initial_relaxation_time, above=0.0, unit="s")
    if not isinstance(convention, str) or convention not in get_args(RelaxationConvention):
        raise InputError("convention", "is not known", value=convention, allowed='"source", "print"')
    if n is not None and convention == "print":
        raise InputError("n", 'is given, and convention = "print" sets it to -1', value=n, remedy="give one of the two")
    power = real("n", (1.0 if convention == "source" else -1.0) if n is None else n, least=-10.0, most=10.0)
    return theta0 * _power_of_ten("n", power * np.log10(c / c0), "C and C_0 are too far apart")


def scaling_exponents(solvent_quality: str = "theta", *, entangled: bool = True) -> ScalingExponents:
    """Exponents of the polymer contribution in a semidilute solution.

    Parameters
    ----------
    solvent_quality : {"theta", "good"}
        Theta: entangled 14/3, 7/3, 7/3; unentangled 2, 1, 1. Good (nu = 0.588): entangled 3.93, 1.62, 2.31; unentangled
        1.31, 0.31, 1.
    entangled : bool
        Above the entanglement concentration or below.

    Returns
    -------
    ScalingExponents
        viscosity, relaxation, modulus.

    Raises
    ------
    InputError
        For an unknown solvent quality.

    References
    ----------
    Rubinstein and Colby (2003), Eqs. (8.89) ff. (unentangled) and section 9.3 (entangled; theta by the two-parameter scaling).
    """
    if not isinstance(solvent_quality, str) or solvent_quality not in ("theta", "good"):
        raise InputError("solvent_quality", "is not known", value=solvent_quality, allowed='"theta", "good"')
    if solvent_quality == "theta":
        return ScalingExponents(14 / 3, 7 / 3, 7 / 3) if entangled else ScalingExponents(2.0, 1.0, 1.0)
    below = 3 * _FLORY - 1
    if entangled:
        return ScalingExponents(3 / below, 3 * (1 - _FLORY) / below, 3 * _FLORY / below)
    return ScalingExponents(1 / below, (2 - 3 * _FLORY) / below, 1.0)


@finite_result("scaled value", positive=True)
def scaled(
    volume_fraction: ArrayLike, initial_volume_fraction: ArrayLike, initial_value: ArrayLike, exponent: ArrayLike
) -> FloatArray:
    """``initial_value (phi / phi_0)^exponent``: relaxation time or modulus by a scaling law, in the unit given.

    Parameters
    ----------
    volume_fraction, initial_volume_fraction : array_like
        phi and phi_0 in (0, 1].
    initial_value : array_like
        At phi_0, > 0.
    exponent : array_like
        From `scaling_exponents`, in [-20, 20].

    Returns
    -------
    ndarray, broadcast shape.
    """
    phi, phi0 = (
        _fraction("volume_fraction", volume_fraction),
        _fraction("initial_volume_fraction", initial_volume_fraction),
    )
    first = real("initial_value", initial_value, above=0.0)
    power = real("exponent", exponent, least=-20.0, most=20.0)
    return first * _power_of_ten("exponent", power * np.log10(phi / phi0), "phi and phi_0 are too far apart")


@finite_result("viscosity", "Pa s", positive=True)
def scaled_viscosity(
    volume_fraction: ArrayLike,
    initial_volume_fraction: ArrayLike,
    initial_viscosity: ArrayLike,
    solvent_viscosity: ArrayLike,
    exponent: ArrayLike,
) -> FloatArray:
    """Viscosity by a scaling law of the polymer contribution, ``mu_s + (mu_0 - mu_s) (phi / phi_0)^x``, Pa s.

    Parameters
    ----------
    volume_fraction, initial_volume_fraction : array_like
        phi and phi_0 in (0, 1].
    initial_viscosity, solvent_viscosity : array_like
        mu_0 > mu_s > 0, Pa s.
    exponent : array_like
        x, from `scaling_exponents`.

    Returns
    -------
    ndarray, Pa s, broadcast shape.
    """
    mu_s = real("solvent_viscosity", solvent_viscosity, above=0.0, unit="Pa s")
    mu0 = real("initial_viscosity", initial_viscosity, above=0.0, unit="Pa s")
    if np.any(mu0 <= mu_s):
        raise InputError(
            "initial_viscosity", "is not above the solvent's", value=float(np.min(mu0)), allowed="(mu_s, inf) Pa s"
        )
    return mu_s + scaled(volume_fraction, initial_volume_fraction, mu0 - mu_s, exponent)


@finite_result("viscosity", "Pa s", positive=True)
def martin_viscosity(
    concentration: ArrayLike, intrinsic_viscosity: ArrayLike, martin_constant: ArrayLike, solvent_viscosity: ArrayLike
) -> FloatArray:
    """Viscosity by Martin's equation, ``mu_s [1 + X exp(K X)]`` with ``X = c [eta]``.

    Parameters
    ----------
    concentration : array_like
        c, polymer mass per volume of solution, kg/m3, >= 0.
    intrinsic_viscosity : array_like
        [eta], m3/kg, > 0.
    martin_constant : array_like
        K, dimensionless, >= 0; 0.1 to 0.5 for flexible chains.
    solvent_viscosity : array_like
        mu_s, Pa s, > 0.

    Returns
    -------
    ndarray, Pa s, broadcast shape. Small X: ``mu_s (1 + X + K X^2)``, Huggins' equation.

    Raises
    ------
    InputError
        For a value out of range, or ``K X`` beyond 300 decades.
    """
    c = real("concentration", concentration, least=0.0, unit="kg/m3")
    eta = real("intrinsic_viscosity", intrinsic_viscosity, above=0.0, unit="m3/kg")
    constant = real("martin_constant", martin_constant, least=0.0)
    mu_s = real("solvent_viscosity", solvent_viscosity, above=0.0, unit="Pa s")
    x = c * eta
    return mu_s * (1 + x * _power_of_ten("martin_constant", constant * x / np.log(10.0), "c [eta] is too large"))


@finite_result("modulus", "Pa", positive=True)
def modulus(viscosity: ArrayLike, relaxation_time: ArrayLike) -> FloatArray:
    """Elastic modulus ``G = mu / theta`` in Pa, of the *polymer* viscosity (Pa s) and its relaxation time (s)."""
    mu = real("viscosity", viscosity, above=0.0, unit="Pa s")
    theta = real("relaxation_time", relaxation_time, above=0.0, unit="s")
    return mu / theta


def _fraction(field: str, value: ArrayLike) -> FloatArray:
    return real(field, value, above=0.0, most=1.0)


def _power_of_ten(field: str, decades: FloatArray, remedy: str) -> FloatArray:
    real(f"decades of change ({field})", decades, least=-_DECADES, most=_DECADES, remedy=remedy)
    return np.power(10.0, decades)
