"""Which photon energy tells polymer from solvent, and which one best.

The contrast D changes sign (PEO in water at 38.5 keV); near that energy absorption says nothing of the polymer fraction: a
density or a coefficient that is wrong by 1 % is an error in it of more than 1. The best energy for a uniform jet of radius R
and N photons per pixel of width p is that of the largest information on the mean fraction,

    1/sigma^2 = D^2 (N/p) integral over x of L(x)^2 exp(-mu L(x)),   L = 2 sqrt(R^2 - x^2),

which weighs contrast (low energies) against transmission (high energies). Poisson noise only: N scales sigma, not the energy.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray, computable, number, positive
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss
from spinline.rheology.materials import Polymer
from spinline.xray.matter.attenuation import (
    HIGHEST_KEV,
    LOWEST_KEV,
    Composition,
    Material,
    attenuation_contrast,
    mass_attenuation,
    material,
)

__all__ = ["SMALLEST_CONTRAST", "BestEnergy", "best_energy", "usable_contrast", "zero_contrast_energies"]

SMALLEST_CONTRAST = 0.01  # of the solvent's attenuation: what tables and densities are known to

_Kind = Composition | Polymer | Material


@dataclass(frozen=True)
class BestEnergy:
    """The best photon energy of a jet, and what it allows.

    Attributes
    ----------
    energy_kev : float
        keV.
    contrast : float
        D there, 1/m.
    transmission : float
        Of the centre chord.
    sigma : float
        Standard deviation of the mean polymer fraction, nothing else being unknown.
    """

    energy_kev: float
    contrast: float
    transmission: float
    sigma: float


def usable_contrast(
    polymer: _Kind,
    solvent: Composition | Material,
    energy_kev: float,
    *,
    coherent: bool = True,
    temperature: float = 293.15,
) -> float:
    """Contrast in 1/m at one energy, refused where it cannot tell polymer from solvent.

    Parameters
    ----------
    polymer, solvent, energy_kev, coherent, temperature
        As in `attenuation_contrast`; one energy.

    Returns
    -------
    float
        D in 1/m, of either sign.

    Raises
    ------
    InputError
        Where ``|D|`` is under 1 % of the solvent's attenuation, with the nearest energy at which it is over 5 % (or, where
        there is none, the energy of the largest share).
    """
    p, s = material(polymer, temperature=temperature), material(solvent, temperature=temperature)
    energy = positive("energy_kev", energy_kev, "keV")
    share = float(_share(p, s, np.array([energy]), coherent)[0])
    if abs(share) >= SMALLEST_CONTRAST:
        return float(attenuation_contrast(p, s, energy, coherent=coherent))
    grid = np.geomspace(3.0, 100.0, 176)
    shares = np.abs(_share(p, s, grid, coherent))
    good = grid[shares >= 5 * SMALLEST_CONTRAST]
    works = float(good[np.argmin(np.abs(good - energy))]) if good.size else float(grid[np.argmax(shares)])
    raise InputError(
        "energy_kev",
        f"polymer and solvent absorb alike here: the contrast is {100 * share:+.2g} % of the solvent's attenuation",
        value=energy,
        allowed=f"contrast of at least {100 * SMALLEST_CONTRAST:g} %",
        remedy=f"use {works:.3g} keV",
    )


def zero_contrast_energies(
    polymer: _Kind,
    solvent: Composition | Material,
    low_kev: float = 3.0,
    high_kev: float = 100.0,
    *,
    coherent: bool = True,
    temperature: float = 293.15,
) -> FloatArray:
    """Energies in keV, rising, at which the contrast changes sign between `low_kev` and `high_kev`; empty where there is none.

    Two sign changes nearer to each other than 1 % (a jump at an absorption edge and back) are not seen.
    """
    from scipy.optimize import brentq

    p, s = material(polymer, temperature=temperature), material(solvent, temperature=temperature)
    grid = _grid(low_kev, high_kev)
    signs = np.sign(attenuation_contrast(p, s, grid, coherent=coherent))
    roots = [
        float(
            brentq(lambda e: float(attenuation_contrast(p, s, e, coherent=coherent)), grid[i], grid[i + 1], xtol=1e-6)
        )
        for i in np.flatnonzero(signs[:-1] * signs[1:] < 0)
    ]
    return np.array(roots)


@computable
def best_energy(
    polymer: _Kind,
    solvent: Composition | Material,
    radius: float,
    photons: float,
    *,
    pixel: float,
    polymer_fraction: float = 0.05,
    low_kev: float = 3.0,
    high_kev: float = 60.0,
    coherent: bool = True,
    temperature: float = 293.15,
) -> BestEnergy:
    """Energy of the smallest error in the mean polymer fraction, and that error.

    Parameters
    ----------
    polymer, solvent, coherent, temperature
        As in `attenuation_contrast`.
    radius, pixel : float
        Radius of the jet and width of a pixel, m, > 0.
    photons : float
        Detected without a jet, per pixel in all (rows, frames, exposure), > 0, at every energy alike.
    polymer_fraction : float
        Volume fraction, [0, 1].
    low_kev, high_kev : float
        Energies the source offers, within [1, 200].

    Returns
    -------
    BestEnergy
        The energy to 1 % (the optimum is flat). Poisson noise alone: no air path, window or fringes.

    Raises
    ------
    InputError
        For a value out of range, or where the contrast is under 1 % at every energy offered.
    """
    r, n = positive("radius", radius, "m"), positive("photons", photons)
    p = positive("pixel", pixel, "m")
    phi = number("polymer_fraction", polymer_fraction, least=0.0, most=1.0)
    heavy, light = material(polymer, temperature=temperature), material(solvent, temperature=temperature)
    grid = _grid(low_kev, high_kev)
    base = light.attenuation(grid, coherent=coherent)
    contrast = heavy.attenuation(grid, coherent=coherent) - base
    usable = np.abs(contrast) >= SMALLEST_CONTRAST * base
    if not usable.any():
        raise InputError(
            "energy_kev",
            "polymer and solvent absorb alike at every energy offered",
            value=(low_kev, high_kev),
            allowed=f"contrast of at least {100 * SMALLEST_CONTRAST:g} % of the solvent's attenuation",
            remedy="widen low_kev, high_kev, or take another solvent",
        )
    mu = base + phi * contrast
    node, weight = gauss(48)  # x = R sin(t): smooth, so spectral
    t = 0.5 * np.pi * node
    chord = 2.0 * r * np.cos(t)
    measure = 0.5 * np.pi * weight * r * np.cos(t)
    kept = (measure * chord**2 * np.exp(-mu[:, None] * chord)).sum(axis=1)
    information = np.where(usable, contrast**2 * (n / p) * kept, 0.0)
    best = int(np.argmax(information))
    if 2.0 * r * mu[best] > 30.0:
        raise InputError("radius", "lets no photon through the centre at any energy", value=r, remedy="raise high_kev")
    return BestEnergy(
        float(grid[best]), float(contrast[best]), float(np.exp(-2 * r * mu[best])), float(information[best] ** -0.5)
    )


def _share(polymer: Material, solvent: Material, energies: FloatArray, coherent: bool) -> FloatArray:
    base = solvent.density * mass_attenuation(solvent.composition, energies, coherent=coherent)
    return attenuation_contrast(polymer, solvent, energies, coherent=coherent) / base


def _grid(low_kev: float, high_kev: float) -> FloatArray:
    low = number("low_kev", low_kev, least=LOWEST_KEV, below=HIGHEST_KEV, unit="keV")
    high = number("high_kev", high_kev, above=low, most=HIGHEST_KEV, unit="keV", remedy="above low_kev")
    grid: FloatArray = np.geomspace(low, high, max(int(np.ceil(np.log(high / low) / 0.01)), 1) + 1)
    grid[0], grid[-1] = low, high
    return grid
