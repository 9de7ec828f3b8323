"""Absorption of a polymer solution and what a change of it says, Eqs. (41)-(42).

With mass attenuation s and additive volumes ``mu = s_s rho_s + phi_p (s_p rho_p - s_s rho_s)``, so a change of mu is one of
the volume fraction, ``d phi_p = d mu / D`` with the contrast ``D = s_p rho_p - s_s rho_s``. Eq. (41) as printed gives the
mass concentration ``rho_p d phi_p``, in g/cm3, not the fraction. Along a chord d the measured transmissions give
``d mu = -ln(Tr_exp / Tr_sim) / d``: a chord mean, not a local value.

References
----------
Greenfeld et al., Macromolecules 45, 3616 (2012); review Eqs. (41)-(42).
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, real
from spinline.base.errors import InputError

__all__ = ["contrast", "fraction_change", "linear_attenuation"]


@computable
def contrast(
    polymer_attenuation: ArrayLike,
    polymer_density: ArrayLike,
    solvent_attenuation: ArrayLike,
    solvent_density: ArrayLike,
) -> FloatArray:
    """Contrast ``D = s_p rho_p - s_s rho_s`` in 1/m, of either sign.

    Parameters
    ----------
    polymer_attenuation, solvent_attenuation : array_like
        Mass attenuation coefficients, m2/kg, >= 0.
    polymer_density, solvent_density : array_like
        kg/m3, > 0.

    Returns
    -------
    ndarray
    """
    s_p = real("polymer_attenuation", polymer_attenuation, least=0.0, unit="m2/kg")
    s_s = real("solvent_attenuation", solvent_attenuation, least=0.0, unit="m2/kg")
    rho_p = real("polymer_density", polymer_density, above=0.0, unit="kg/m3")
    rho_s = real("solvent_density", solvent_density, above=0.0, unit="kg/m3")
    return s_p * rho_p - s_s * rho_s


def linear_attenuation(
    polymer_fraction: ArrayLike, solvent_linear_attenuation: ArrayLike, contrast: ArrayLike
) -> FloatArray:
    """Linear attenuation ``mu = s_s rho_s + phi_p D`` in 1/m of a solution of volume fraction phi_p in [0, 1]."""
    phi = real("polymer_fraction", polymer_fraction, least=0.0, most=1.0)
    solvent = real("solvent_linear_attenuation", solvent_linear_attenuation, least=0.0, unit="1/m")
    return solvent + phi * real("contrast", contrast, unit="1/m")


@computable
def fraction_change(transmission_ratio: ArrayLike, chord: ArrayLike, contrast: ArrayLike) -> FloatArray:
    """Chord mean of the change in polymer volume fraction, ``-ln(Tr_exp / Tr_sim) / (d D)``, Eqs. (41)-(42).

    Parameters
    ----------
    transmission_ratio : array_like
        ``Tr_exp / Tr_sim``, > 0.
    chord : array_like
        Path d through the jet, m, > 0.
    contrast : array_like
        D, 1/m; refused where it is 0, for there absorption does not tell polymer from solvent.

    Returns
    -------
    ndarray
    """
    ratio = real("transmission_ratio", transmission_ratio, above=0.0)
    d = real("chord", chord, above=0.0, unit="m")
    difference = real("contrast", contrast, unit="1/m")
    if (difference == 0).any():
        raise InputError(
            "contrast",
            "is zero: absorption does not tell polymer from solvent here",
            value=0.0,
            remedy="choose another photon energy",
        )
    value: FloatArray = -np.log(ratio) / (d * difference)
    return value
