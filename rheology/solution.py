"""The solution at the jet start: fractions by mass and by volume, densities, and how many strands a chain makes.

Volumes are taken as additive, polymer with solvent and solvents among themselves: within 1 % for the bundled pairs, and
within what the network model resolves. 5 wt% of PEO in water is ``phi = 0.0444``, not 0.05: the network knows volumes.

A network needs entanglements. With strands of ``N_s`` Kuhn segments a chain of contour ``L = n_bonds l_p M / M_0`` makes
``L / (b N_s)`` strands (l_p = 0.126 nm, the projection of a C-C bond on an all-trans chain); fewer than two make no network.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from spinline.checks import FloatArray, real
from spinline.errors import InputError
from spinline.rheology.materials import Polymer, polymer, solvent_density

__all__ = ["Solution", "mass_fraction", "volume_fraction"]

_BOND_PROJECTION = 0.126e-9  # m, C-C bond 0.154 nm times sin(109.5 deg / 2)


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
    w = real("mass_fraction", mass_fraction, least=0.0, most=1.0)
    rho_p = real("polymer_density", polymer_density, above=0.0, unit="kg/m3")
    rho_s = real("solvent_density", solvent_density, above=0.0, unit="kg/m3")
    return w * rho_s / (w * rho_s + (1 - w) * rho_p)


def mass_fraction(volume_fraction: ArrayLike, polymer_density: ArrayLike, solvent_density: ArrayLike) -> FloatArray:
    """Polymer mass fraction from its volume fraction: the inverse of `volume_fraction`."""
    phi = real("volume_fraction", volume_fraction, least=0.0, most=1.0)
    rho_p = real("polymer_density", polymer_density, above=0.0, unit="kg/m3")
    rho_s = real("solvent_density", solvent_density, above=0.0, unit="kg/m3")
    return phi * rho_p / (phi * rho_p + (1 - phi) * rho_s)


@dataclass(frozen=True)
class Solution:
    """A polymer solution at rest, SI units.

    Parameters
    ----------
    polymer : Polymer or str
        Data, or a built-in name.
    solvent : str or mapping
        Name, or names with mass fractions that sum to 1.
    volume_fraction : float
        phi in (0, 1); see `from_mass_fraction`.
    temperature : float
        K.
    solvent_density : float
        kg/m3.
    kuhn_length : float
        b in m; about 1 nm for flexible chains.
    molar_mass, viscosity, relaxation_time : float or None
        kg/mol, Pa s (zero shear), s, where known.
    """

    polymer: Polymer
    solvent: Mapping[str, float]
    volume_fraction: float
    temperature: float
    solvent_density: float
    kuhn_length: float = 1e-9
    molar_mass: float | None = None
    viscosity: float | None = None
    relaxation_time: float | None = None

    def __post_init__(self) -> None:
        real("volume_fraction", self.volume_fraction, above=0.0, below=1.0)
        for name, unit in (("temperature", "K"), ("solvent_density", "kg/m3"), ("kuhn_length", "m")):
            real(name, getattr(self, name), above=0.0, unit=unit)
        real("polymer_density", self.polymer.density, above=0.0, unit="kg/m3")
        for name, unit in (("molar_mass", "kg/mol"), ("viscosity", "Pa s"), ("relaxation_time", "s")):
            if getattr(self, name) is not None:
                real(name, getattr(self, name), above=0.0, unit=unit)

    @classmethod
    def build(
        cls,
        polymer_data: Polymer | str,
        solvent: str | Mapping[str, float],
        *,
        mass_fraction: float | None = None,
        volume_fraction: float | None = None,
        temperature: float = 293.15,
        polymer_density: float | None = None,
        solvent_density: float | None = None,
        kuhn_length: float = 1e-9,
        molar_mass: float | None = None,
        viscosity: float | None = None,
        relaxation_time: float | None = None,
        field: str = "",
    ) -> Self:
        """Solution from names and one of the two fractions; any built-in property can be overridden.

        Parameters
        ----------
        polymer_data : Polymer or str
            Data, or a built-in name.
        solvent : str or mapping
            Built-in name, or names with mass fractions. Any name will do when `solvent_density` is given.
        mass_fraction, volume_fraction : float
            Exactly one, in (0, 1).
        temperature : float, optional
            K.
        polymer_density, solvent_density : float, optional
            kg/m3, in place of the built-in ones.
        kuhn_length, molar_mass, viscosity, relaxation_time : float, optional
            As for the class.
        field : str, optional
            What goes before a name in errors, "solution." for a scene.

        Returns
        -------
        Solution

        Examples
        --------
        >>> solution = Solution.build("PEO", "water", mass_fraction=0.05)
        >>> round(solution.volume_fraction, 5)
        0.04443
        """
        known = polymer(polymer_data, f"{field}polymer") if isinstance(polymer_data, str) else polymer_data
        if polymer_density is not None:
            known = replace(known, density=polymer_density, source="density given by the user")
        parts = {solvent: 1.0} if isinstance(solvent, str) else dict(solvent)
        density = (
            _mixture_density(parts, temperature, f"{field}solvent") if solvent_density is None else solvent_density
        )
        if (mass_fraction is None) == (volume_fraction is None):
            raise InputError("solution", "needs one of mass_fraction and volume_fraction", remedy="give exactly one")
        if mass_fraction is not None:
            real("mass_fraction", mass_fraction, above=0.0, below=1.0)
            volume_fraction = float(_volume_fraction(mass_fraction, known.density, density))
        assert volume_fraction is not None
        return cls(
            polymer=known,
            solvent=parts,
            volume_fraction=volume_fraction,
            temperature=temperature,
            solvent_density=density,
            kuhn_length=kuhn_length,
            molar_mass=molar_mass,
            viscosity=viscosity,
            relaxation_time=relaxation_time,
        )

    @property
    def mass_fraction(self) -> float:
        """Polymer mass fraction."""
        return float(_mass_fraction(self.volume_fraction, self.polymer.density, self.solvent_density))

    @property
    def density(self) -> float:
        """Density of the solution, kg/m3, volumes additive."""
        phi = self.volume_fraction
        return phi * self.polymer.density + (1 - phi) * self.solvent_density

    @property
    def segments_per_chain(self) -> float:
        """Kuhn segments of a chain, ``n_bonds l_p M / (M_0 b)``; NaN where molar mass or repeat unit is not known."""
        if self.molar_mass is None or not self.polymer.backbone_bonds:
            return float("nan")
        repeats = self.molar_mass / self.polymer.repeat_unit_molar_mass
        return self.polymer.backbone_bonds * _BOND_PROJECTION * repeats / self.kuhn_length

    def strands_per_chain(self, segments_per_strand: float) -> float:
        """Network strands that one chain makes; below about 2 there is no network."""
        return self.segments_per_chain / segments_per_strand


_volume_fraction, _mass_fraction = volume_fraction, mass_fraction  # the names are also parameters above


def _mixture_density(parts: Mapping[str, float], temperature: float, field: str) -> float:
    shares = real(field, list(parts.values()), above=0.0, most=1.0)
    if abs(float(shares.sum()) - 1) > 1e-6:
        raise InputError(field, "mass fractions must sum to 1", value=dict(parts), remedy="scale them")
    volumes = [share / solvent_density(name, temperature, field) for name, share in parts.items()]
    return float(1 / np.sum(volumes))
