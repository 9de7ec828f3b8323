"""Fractions of a solution by mass, by volume and by number, and back.

With amounts w of the polymer and 1 - w of the solvent, each divided by what turns the one measure into the other (densities,
or molar masses)::

    phi = (w/rho_p) / [w/rho_p + (1 - w)/rho_s]          volumes additive
    x   = (w/M_p) / [w/M_p + (1 - w)/M_s]                M_p of a chain, or of a repeat unit

Exact at both pure ends. Errors: 4 ulp. There and back the relative error is ``(1 - x)/(1 - w)`` ulp from x to w and the inverse
from w to x: nothing for densities, up to ``M_p/M_s`` for number fractions of long chains near 1.
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real

__all__ = ["mass_fraction", "mass_fraction_from_molar", "molar_fraction", "volume_fraction"]


def volume_fraction(mass_fraction: ArrayLike, polymer_density: ArrayLike, solvent_density: ArrayLike) -> FloatArray:
    """Polymer volume fraction from its mass fraction, volumes additive.

    Parameters
    ----------
    mass_fraction : array_like
        In [0, 1].
    polymer_density, solvent_density : array_like
        kg/m3, > 0.

    Returns
    -------
    ndarray, in [0, 1].
    """
    rho_p = real("polymer_density", polymer_density, above=0.0, unit="kg/m3")
    return _share(
        _fraction("mass_fraction", mass_fraction),
        real("solvent_density", solvent_density, above=0.0, unit="kg/m3"),
        rho_p,
    )


def mass_fraction(volume_fraction: ArrayLike, polymer_density: ArrayLike, solvent_density: ArrayLike) -> FloatArray:
    """Polymer mass fraction from its volume fraction: the inverse of `volume_fraction`."""
    rho_p = real("polymer_density", polymer_density, above=0.0, unit="kg/m3")
    rho_s = real("solvent_density", solvent_density, above=0.0, unit="kg/m3")
    return _share(_fraction("volume_fraction", volume_fraction), rho_p, rho_s)


def molar_fraction(mass_fraction: ArrayLike, molar_mass: ArrayLike, solvent_molar_mass: ArrayLike) -> FloatArray:
    """Molar fraction of the polymer from its mass fraction.

    Parameters
    ----------
    mass_fraction : array_like
        In [0, 1].
    molar_mass : array_like
        Of a chain (or of a repeat unit, for the fraction of repeat units), kg/mol, > 0.
    solvent_molar_mass : array_like
        Mean by number, ``1/sum(w_i/M_i)`` of a mixture, kg/mol, > 0.

    Returns
    -------
    ndarray, in [0, 1].
    """
    chain = real("molar_mass", molar_mass, above=0.0, unit="kg/mol")
    solvent = real("solvent_molar_mass", solvent_molar_mass, above=0.0, unit="kg/mol")
    return _share(_fraction("mass_fraction", mass_fraction), solvent, chain)


def mass_fraction_from_molar(
    molar_fraction: ArrayLike, molar_mass: ArrayLike, solvent_molar_mass: ArrayLike
) -> FloatArray:
    """Mass fraction of the polymer from its molar fraction: the inverse of `molar_fraction`."""
    chain = real("molar_mass", molar_mass, above=0.0, unit="kg/mol")
    solvent = real("solvent_molar_mass", solvent_molar_mass, above=0.0, unit="kg/mol")
    return _share(_fraction("molar_fraction", molar_fraction), chain, solvent)


def _fraction(field: str, value: ArrayLike) -> FloatArray:
    return real(field, value, least=0.0, most=1.0)


def _share(part: FloatArray, weight: FloatArray, other: FloatArray) -> FloatArray:
    """``part weight/(part weight + (1 - part) other)``, weights first scaled to 1 so that nothing overflows."""
    scale, least = np.maximum(weight, other), np.finfo(np.float64).tiny
    mine = part * np.maximum(weight / scale, least)
    value: FloatArray = mine / (mine + (1 - part) * np.maximum(other / scale, least))
    return value
