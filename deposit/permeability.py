"""Permeability of a fibre mat from its solidity: laws, each with its range.

``k/a^2`` as a function of the solidity phi (volume of fibre per volume); **a is the fibre's radius** (papers mix radius and
diameter: a factor of 4). Outside its range a law gives NaN and says so. Mixed radii: put in the length-weighted *mean* radius
(direct calculations agree with it, not with the root mean square or the surface mean).

=======================  ==============================================  =====================
name                     for                                             range of phi
=======================  ==============================================  =====================
davies (default)         filters, flow through the layers (measured)     0.006 to 0.3
jackson-james            random in three dimensions                      0 to 0.25
drummond-tahir-square    regular square array, across                    0 to 0.4
drummond-tahir-along     regular square array, along                     0 to 0.4
drummond-tahir-hexagon   regular hexagonal array, across                 0 to 0.4
kuwabara, happel         cell models, across: bounds                     0 to 0.4
kozeny-carman            dense beds, K = 5                               0.2 to 0.7
tomadakis-through        random in planes, flow through them             0.1 to 0.85
tomadakis-in-plane       random in planes, flow along them               0.1 to 0.85
tomadakis-3d             random in three dimensions                      0.1 to 0.9
spielman-goren           random in planes, flow through them             0 to 0.3
spielman-goren-3d        random in three dimensions                      0 to 0.3
=======================  ==============================================  =====================

Thin fibres in air slip: `slip_permeability` (Kuwabara cell), with the Knudsen number Kn = (mean free path)/a.

References
----------
Davies, Proc. Inst. Mech. Eng. 167, 185 (1953); Jackson, James, Can. J. Chem. Eng. 64, 364 (1986); Drummond, Tahir, Int. J.
Multiphase Flow 10, 515 (1984); Kuwabara, J. Phys. Soc. Jpn 14, 527 (1959); Happel, AIChE J. 5, 174 (1959); Tomadakis,
Robertson, J. Compos. Mater. 39, 163 (2005); Spielman, Goren, Environ. Sci. Technol. 2, 279 (1968); Pich in Davies (ed.),
Aerosol Science (1966).
"""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import k0e, k1e

from spinline.base.checks import FloatArray, computable, number, real
from spinline.base.errors import InputError, SpinlineWarning

__all__ = ["LAWS", "PermeabilityLaw", "permeability_of", "pressure_drop", "quality_factor", "slip_permeability"]


@dataclass(frozen=True)
class PermeabilityLaw:
    """``k/a^2`` of a solidity, and where it holds: ``least <= phi <= most``."""

    name: str
    ratio: Callable[[FloatArray], FloatArray]
    least: float
    most: float
    use: str


def permeability_of(law: str, solidity: ArrayLike, radius: ArrayLike) -> FloatArray:
    """Permeability k in m2; NaN outside the law's range, with a warning.

    Parameters
    ----------
    law : str
        A key of `LAWS`.
    solidity : array_like
        phi in (0, 1).
    radius : array_like
        Length-weighted mean radius, m.

    Raises
    ------
    InputError
        For an unknown law or values out of range.

    Examples
    --------
    >>> round(float(permeability_of("davies", 0.1, 1.0)), 3)
    1.872
    """
    if law not in LAWS:
        raise InputError("mat.permeability", "is not known", value=law, allowed=", ".join(LAWS))
    phi = real("solidity", solidity, above=0.0, below=1.0)
    a = real("radius", radius, above=0.0, unit="m")
    rule = LAWS[law]
    inside = (phi >= rule.least) & (phi <= rule.most)
    if not inside.all():
        bad = float(phi[~inside].flat[0])
        warnings.warn(
            f"solidity {bad:.3g} is outside the range of the permeability law {law}, {rule.least:g} to {rule.most:g}: "
            "no value there",
            SpinlineWarning,
            stacklevel=2,
        )
    value = rule.ratio(np.where(inside, phi, 0.5 * (rule.least + rule.most)))
    return np.where(inside, value, np.nan) * a**2


@computable
def slip_permeability(solidity: ArrayLike, knudsen: ArrayLike) -> FloatArray:
    """``k/a^2`` across fibres in a gas that slips on them (Kuwabara cell, Pich).

    Parameters
    ----------
    solidity : array_like
        phi in (0, 0.4].
    knudsen : array_like
        Mean free path over the *radius*, in [0, 10]; beyond 0.25 extrapolated, with a warning.

    Examples
    --------
    >>> [round(float(slip_permeability(p, 0.44) / slip_permeability(p, 0.0)), 3) for p in (0.05, 0.1, 0.2)]
    [1.265, 1.38, 1.611]
    """
    phi, kn = real("solidity", solidity, above=0.0, most=0.4), real("knudsen", knudsen, least=0.0, most=10.0)
    if np.any(kn > 0.25):
        warnings.warn(
            "slip flow holds to Kn = 0.25; beyond, the permeability is extrapolated", SpinlineWarning, stacklevel=2
        )
    slip = 1.996 * kn
    return np.asarray((_kuwabara_number(phi) + slip * (-np.log(phi) / 2 - 0.25 + phi**2 / 4)) / (4 * phi * (1 + slip)))


@computable
def pressure_drop(
    thickness: ArrayLike, permeability: ArrayLike, face_velocity: ArrayLike, viscosity: ArrayLike = 1.81e-5
) -> FloatArray:
    """``mu U h/k``, Pa; thickness m, permeability m2, velocity m/s, viscosity of the gas Pa s (air)."""
    h, k = real("thickness", thickness, above=0.0), real("permeability", permeability, above=0.0)
    u, mu = real("face_velocity", face_velocity, least=0.0), real("viscosity", viscosity, above=0.0)
    return np.asarray(mu * u * h / k)


def quality_factor(efficiency: float, drop: float) -> float:
    """``-ln(1 - efficiency)/drop``, 1/Pa: of a filter that holds back `efficiency` in [0, 1) at `drop` (Pa)."""
    share = number("efficiency", efficiency, least=0.0, below=1.0)
    return float(-np.log1p(-share) / number("pressure_drop", drop, above=0.0, unit="Pa"))


def _davies(phi: FloatArray) -> FloatArray:
    return np.asarray(1 / (16 * phi**1.5 * (1 + 56 * phi**3)))


def _jackson_james(phi: FloatArray) -> FloatArray:
    return np.asarray(3 / (20 * phi) * (-np.log(phi) - 0.931))


def _square_across(phi: FloatArray) -> FloatArray:
    return np.asarray((-np.log(phi) - 1.476 + 2 * phi - 1.774 * phi**2 + 4.076 * phi**3) / (8 * phi))


def _square_along(phi: FloatArray) -> FloatArray:
    return np.asarray((-np.log(phi) - 1.476 + 2 * phi - phi**2 / 2 - 0.0509 * phi**4) / (4 * phi))


def _hexagon_across(phi: FloatArray) -> FloatArray:
    tail = -0.739 * phi**4 + 2.534 * phi**5 / (1 + 1.2758 * phi)
    return np.asarray((-np.log(phi) - 1.497 + 2 * phi - phi**2 / 2 + tail) / (8 * phi))


def _kuwabara_number(phi: FloatArray) -> FloatArray:
    return np.asarray(-np.log(phi) / 2 - 0.75 + phi - phi**2 / 4)


def _kuwabara(phi: FloatArray) -> FloatArray:
    return _kuwabara_number(phi) / (4 * phi)


def _happel(phi: FloatArray) -> FloatArray:
    return np.asarray((-np.log(phi) - (1 - phi**2) / (1 + phi**2)) / (8 * phi))


def _kozeny_carman(phi: FloatArray) -> FloatArray:
    return np.asarray((1 - phi) ** 3 / (4 * 5 * phi**2))


def _tomadakis(threshold: float, power: float) -> Callable[[FloatArray], FloatArray]:
    def ratio(phi: FloatArray) -> FloatArray:
        eps = 1 - phi
        lead = eps / (8 * np.log(eps) ** 2)
        below = (1 - threshold) ** power * ((power + 1) * eps - threshold) ** 2
        return np.asarray(lead * (eps - threshold) ** (power + 2) / below)

    return ratio


def _spielman_goren(constant: float, factor: float) -> Callable[[FloatArray], FloatArray]:
    """Root s = k^(1/2)/a of ``constant + factor s K1(1/s)/K0(1/s) = 1/(4 phi)``; scaled Bessel functions."""

    def balance(log_s: float, phi: float) -> float:
        s = np.exp(log_s)
        return float(constant + factor * s * k1e(1 / s) / k0e(1 / s) - 1 / (4 * phi))

    def ratio(phi: FloatArray) -> FloatArray:
        flat = [np.exp(2 * brentq(balance, -9.0, 60.0, args=(p,), xtol=1e-14)) for p in np.ravel(phi).tolist()]
        return np.reshape(np.array(flat), np.shape(phi))

    return ratio


_TINY = 1e-12
#: Every law of permeability by its name.
LAWS: Mapping[str, PermeabilityLaw] = {
    law.name: law
    for law in (
        PermeabilityLaw("davies", _davies, 0.006, 0.3, "filters, flow through the layers"),
        PermeabilityLaw("jackson-james", _jackson_james, _TINY, 0.25, "random in three dimensions"),
        PermeabilityLaw("drummond-tahir-square", _square_across, _TINY, 0.4, "square array, across"),
        PermeabilityLaw("drummond-tahir-along", _square_along, _TINY, 0.4, "square array, along"),
        PermeabilityLaw("drummond-tahir-hexagon", _hexagon_across, _TINY, 0.4, "hexagonal array, across"),
        PermeabilityLaw("kuwabara", _kuwabara, _TINY, 0.4, "cell model, across"),
        PermeabilityLaw("happel", _happel, _TINY, 0.4, "cell model, across"),
        PermeabilityLaw("kozeny-carman", _kozeny_carman, 0.2, 0.7, "dense beds"),
        PermeabilityLaw("tomadakis-through", _tomadakis(0.11, 0.785), 0.1, 0.85, "planes, through"),
        PermeabilityLaw("tomadakis-in-plane", _tomadakis(0.11, 0.521), 0.1, 0.85, "planes, along"),
        PermeabilityLaw("tomadakis-3d", _tomadakis(0.037, 0.661), 0.1, 0.9, "random in three dimensions"),
        PermeabilityLaw("spielman-goren", _spielman_goren(0.5, 1.0), 1e-3, 0.3, "planes, through"),
        PermeabilityLaw("spielman-goren-3d", _spielman_goren(1 / 3, 5 / 6), 1e-3, 0.3, "random, three dimensions"),
    )
}
