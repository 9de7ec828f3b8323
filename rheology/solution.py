"""The solution at the jet start: its fractions, its properties, and whether its chains make a network.

Volumes are taken as additive, polymer with solvent and solvents among themselves: within 1 % for the bundled pairs, and
within what the network model resolves. 5 wt% of PEO in water is ``phi = 0.0444``, not 0.05: the network knows volumes.

A network needs entanglements. With strands of ``N_s`` Kuhn segments a chain of contour ``L = n_bonds l_p M / M_0``
makes ``L / (b N_s)`` strands (l_p = 0.126 nm, the projection of a C-C bond on an all-trans chain); fewer than two make
no network. `Solution.entanglement` says so by overlap and by the entanglements of the melt.

What is measured on the solution itself (viscosity, relaxation time, surface tension, conductivity) is given, never
guessed: `Solution.require` returns it or says which is missing and how to give it. What belongs to the solvent comes
from `solvents` unless given.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

from spinline.base.checks import number
from spinline.base.errors import InputError
from spinline.rheology import fractions, solvents
from spinline.rheology.entanglement import Entanglement, Quality, entanglement
from spinline.rheology.fractions import mass_fraction, volume_fraction
from spinline.rheology.materials import (
    BOND_PROJECTION,
    Polymer,
    polymer,
    polymer_property,
    vitrification_fraction,
)
from spinline.rheology.names import known_as

__all__ = ["LEAST_STRANDS", "Solution", "mass_fraction", "volume_fraction"]

LEAST_STRANDS = 2.0
"""Strands a chain makes where chains are a network."""


_UNITS = {
    "molar_mass": "kg/mol",
    "viscosity": "Pa s",
    "relaxation_time": "s",
    "surface_tension": "N/m",
    "conductivity": "S/m",
    "solvent_viscosity": "Pa s",
    "solvent_surface_tension": "N/m",
    "solvent_molar_mass": "kg/mol",
}


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
        phi in (0, 1); see `build` for the other fractions.
    temperature : float
        K.
    solvent_density : float
        kg/m3.
    kuhn_length : float
        b in m; about 1 nm for flexible chains.
    molar_mass, viscosity, relaxation_time : float or None
        kg/mol, Pa s (zero shear), s, where known.
    surface_tension, conductivity : float or None
        N/m, S/m, where known.
    solvent_viscosity, solvent_surface_tension, solvent_molar_mass : float or None
        Pa s, N/m, kg/mol, in place of the built-in ones.
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
    surface_tension: float | None = None
    conductivity: float | None = None
    solvent_viscosity: float | None = None
    solvent_surface_tension: float | None = None
    solvent_molar_mass: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.polymer, Polymer):
            raise InputError("polymer", "is not a Polymer", value=self.polymer, remedy="Solution.build takes names")
        solvents.mass_shares(self.solvent, "solvent")
        number("volume_fraction", self.volume_fraction, above=0.0, below=1.0)
        for name, unit in (("temperature", "K"), ("solvent_density", "kg/m3"), ("kuhn_length", "m")):
            number(name, getattr(self, name), above=0.0, unit=unit)
        number("polymer_density", self.polymer.density, above=0.0, unit="kg/m3")
        for name, unit in _UNITS.items():
            if getattr(self, name) is not None:
                number(name, getattr(self, name), above=0.0, unit=unit)

    @classmethod
    def build(
        cls,
        polymer_data: Polymer | str,
        solvent: str | Mapping[str, float],
        *,
        mass_fraction: float | None = None,
        volume_fraction: float | None = None,
        molar_fraction: float | None = None,
        temperature: float = 293.15,
        polymer_density: float | None = None,
        solvent_density: float | None = None,
        kuhn_length: float = 1e-9,
        molar_mass: float | None = None,
        viscosity: float | None = None,
        relaxation_time: float | None = None,
        surface_tension: float | None = None,
        conductivity: float | None = None,
        solvent_viscosity: float | None = None,
        solvent_surface_tension: float | None = None,
        solvent_molar_mass: float | None = None,
        field: str = "",
    ) -> Self:
        """Solution from names and one of the three fractions; any built-in property can be overridden.

        Parameters
        ----------
        polymer_data : Polymer or str
            Data, or a built-in name.
        solvent : str or mapping
            Built-in name, or names with mass fractions. Any name will do when `solvent_density` is given.
        mass_fraction, volume_fraction, molar_fraction : float
            Exactly one, in (0, 1); the last is that of the chains and needs `molar_mass`.
        temperature : float, optional
            K.
        polymer_density, solvent_density : float, optional
            kg/m3, in place of the built-in ones.
        kuhn_length, molar_mass, viscosity, relaxation_time, surface_tension, conductivity : float, optional
            As for the class.
        solvent_viscosity, solvent_surface_tension, solvent_molar_mass : float, optional
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
        known = polymer_data if isinstance(polymer_data, Polymer) else polymer(polymer_data, f"{field}polymer")
        if polymer_density is not None:
            known = replace(known, density=polymer_density, source="density given by the user")
        if not isinstance(solvent, str | Mapping):
            raise InputError(f"{field}solvent", "is not a name or a mapping of names", value=solvent)
        parts = {
            _called(name): share for name, share in ({solvent: 1.0} if isinstance(solvent, str) else solvent).items()
        }
        density = (
            solvents.mixture_density(parts, temperature, f"{field}solvent")
            if solvent_density is None
            else solvent_density
        )
        if sum(part is not None for part in (mass_fraction, volume_fraction, molar_fraction)) != 1:
            raise InputError(
                "solution", "needs one of mass_fraction, volume_fraction and molar_fraction", remedy="give exactly one"
            )
        draft = cls(
            polymer=known,
            solvent=parts,
            volume_fraction=0.5 if volume_fraction is None else volume_fraction,
            temperature=temperature,
            solvent_density=density,
            kuhn_length=kuhn_length,
            molar_mass=molar_mass,
            viscosity=viscosity,
            relaxation_time=relaxation_time,
            surface_tension=surface_tension,
            conductivity=conductivity,
            solvent_viscosity=solvent_viscosity,
            solvent_surface_tension=solvent_surface_tension,
            solvent_molar_mass=solvent_molar_mass,
        )
        if molar_fraction is not None:
            x = number("molar_fraction", molar_fraction, above=0.0, below=1.0)
            chain, small = draft.require("molar_mass"), draft.require("solvent_molar_mass")
            mass_fraction = float(fractions.mass_fraction_from_molar(x, chain, small))
        if mass_fraction is None:
            return draft
        number("mass_fraction", mass_fraction, above=0.0, below=1.0)
        return replace(draft, volume_fraction=float(fractions.volume_fraction(mass_fraction, known.density, density)))

    @property
    def mass_fraction(self) -> float:
        """Polymer mass fraction."""
        return float(fractions.mass_fraction(self.volume_fraction, self.polymer.density, self.solvent_density))

    @property
    def molar_fraction(self) -> float:
        """Molar fraction of the chains; needs `molar_mass`."""
        return self._molar(self.require("molar_mass"))

    @property
    def repeat_unit_fraction(self) -> float:
        """Molar fraction of the polymer, counted in repeat units."""
        return self._molar(polymer_property(self.polymer, "repeat_unit_molar_mass"))

    @property
    def concentration(self) -> float:
        """Mass of polymer per volume of solution, kg/m3: the c of Martin's equation."""
        return self.volume_fraction * self.polymer.density

    @property
    def density(self) -> float:
        """Density of the solution, kg/m3, volumes additive."""
        phi = self.volume_fraction
        return phi * self.polymer.density + (1 - phi) * self.solvent_density

    @property
    def solvent_volume_fractions(self) -> dict[str, float]:
        """Volume fractions of the solvents among themselves, sum 1: the shares of `evaporate`."""
        if len(self.solvent) == 1:
            return dict.fromkeys(self.solvent, 1.0)
        shares = {name: w / solvents.solvent_density(name, self.temperature) for name, w in self.solvent.items()}
        return _normalised(shares)

    @property
    def solvent_molar_fractions(self) -> dict[str, float]:
        """Molar fractions of the solvents among themselves, sum 1."""
        if len(self.solvent) == 1:
            return dict.fromkeys(self.solvent, 1.0)
        return _normalised({name: w / solvents.solvent_molar_mass(name) for name, w in self.solvent.items()})

    @property
    def segments_per_chain(self) -> float:
        """Kuhn segments of a chain, ``n_bonds l_p M / (M_0 b)``; NaN where molar mass or repeat unit is not known."""
        if self.molar_mass is None or not self.polymer.backbone_bonds:
            return float("nan")
        repeats = self.molar_mass / self.polymer.repeat_unit_molar_mass
        return self.polymer.backbone_bonds * BOND_PROJECTION * repeats / self.kuhn_length

    def strands_per_chain(self, segments_per_strand: float) -> float:
        """Network strands that one chain makes; below `LEAST_STRANDS` or so there is no network."""
        return self.segments_per_chain / segments_per_strand

    def require(self, name: str) -> float:
        """A property that a law needs, in SI.

        Parameters
        ----------
        name : str
            "molar_mass", "viscosity", "relaxation_time", "surface_tension", "conductivity", "solvent_viscosity",
            "solvent_surface_tension" or "solvent_molar_mass". The last three come from the library where they are not
            given.

        Returns
        -------
        float

        Raises
        ------
        InputError
            Where it is not known: which, and how to give it.

        Examples
        --------
        >>> solution = Solution.build("PEO", "water", mass_fraction=0.05)
        >>> round(solution.require("solvent_viscosity"), 6)
        0.001002
        """
        if not isinstance(name, str) or name not in _UNITS:
            raise InputError("property", "is not one of a solution", value=name, allowed=", ".join(_UNITS))
        given: float | None = getattr(self, name)
        if given is not None:
            return given
        unknown = [part for part in self.solvent if part.strip().lower() not in _BUILT_IN]
        if name.startswith("solvent_") and not unknown:
            if name == "solvent_viscosity":
                return solvents.mixture_viscosity(self.solvent, self.temperature)
            if name == "solvent_surface_tension":
                return solvents.mixture_surface_tension(self.solvent, self.temperature)
            return 1 / sum(w / solvents.solvent_molar_mass(part) for part, w in self.solvent.items())
        where = f" of {', '.join(unknown)} is not built in" if name.startswith("solvent_") else " is not known"
        raise InputError(name, where.strip(), remedy=f"give {name} ({_UNITS[name]})")

    def entanglement(self, solvent_quality: Quality = "theta") -> Entanglement:
        """Overlap, entanglement, strands and mesh; needs `molar_mass` and the polymer's M_e and repeat unit.

        Raises
        ------
        InputError
            Where one of them is not known.
        """
        chain = self.require("molar_mass")
        for name in ("repeat_unit_molar_mass", "backbone_bonds"):
            polymer_property(self.polymer, name)
        melt = polymer_property(self.polymer, "entanglement_molar_mass")
        segments = self.segments_per_chain
        if segments < 1:
            raise InputError(
                "molar_mass", "is less than a Kuhn segment", value=chain, remedy="check molar_mass (kg/mol)"
            )
        return entanglement(self.volume_fraction, segments, self.kuhn_length, chain, melt, solvent_quality)

    def vitrification_fraction(self, solvent_glass_transition: float | None = None) -> float:
        """Polymer volume fraction that turns to glass at the solution's temperature, by Fox's equation, within about
        0.05.

        Parameters
        ----------
        solvent_glass_transition : float, optional
            K; default `solvents.solvent_glass_transition`, in mixtures averaged as Fox does.

        Raises
        ------
        InputError
            Where a glass transition is not known, or the dry polymer is no glass at this temperature (PEO, PCL).
        """
        low = solvent_glass_transition
        if low is None:
            low = 1 / sum(w / solvents.solvent_glass_transition(part) for part, w in self.solvent.items())
        return vitrification_fraction(self.polymer, low, self.temperature, self.solvent_density)

    def _molar(self, mass: float) -> float:
        w, small = self.mass_fraction, self.require("solvent_molar_mass")
        return float(fractions.molar_fraction(w, mass, small))


_BUILT_IN = frozenset(name.lower() for name in solvents.SOLVENTS)


def _called(name: str) -> str:
    """The library's name for another one ("dimethylformamide"); any other name as it is."""
    if not isinstance(name, str) or name.strip().lower() in _BUILT_IN:
        return name
    return known_as(name, solvents.SOLVENTS) or name


def _normalised(parts: dict[str, float]) -> dict[str, float]:
    total = sum(parts.values())
    return {name: part / total for name, part in parts.items()}
