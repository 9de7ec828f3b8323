"""Built-in polymers: density, repeat unit, Kuhn length, entanglements and glass transition, each with its source.

`property_source` says where each comes from and how far off it may be; what is an estimate says so there: give your own
(``dataclasses.replace(polymer, kuhn_length=...)``) where it matters. They were entered from the works that are named,
and looked up a second time elsewhere: `docs/physics/second-sources.md` lists both values, and for which no second one
was found. `polymer_property` says what is missing and how to give it.
Solvents are in `solvents`. A name that is not here is not an obstacle: give the properties themselves.

Estimates of the entanglement molar mass follow from chain and density by the packing length p (Fetters et al., 1994)::

    p = M/(<R^2> rho N_A),   <R^2>/M = n_bonds l_p b/M_0,   M_e = (4/5) rho N_A n_t^2 p^3,   n_t = 21.3
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import positive
from spinline.base.errors import InputError
from spinline.rheology.solvents import SOLVENTS, known_name, solvent_density, solvent_viscosity

__all__ = [
    "BOND_PROJECTION",
    "POLYMERS",
    "SOLVENTS",
    "Polymer",
    "packing_entanglement_molar_mass",
    "polymer",
    "polymer_property",
    "property_source",
    "solvent_density",
    "solvent_viscosity",
    "vitrification_fraction",
]

BOND_PROJECTION = 0.126e-9  # m, l_p: C-C bond 0.154 nm times sin(109.5 deg / 2)
_TUBE_STRANDS = 21.3  # n_t
_AVOGADRO = 6.02214076e23
_UNITS = {
    "density": "kg/m3",
    "repeat_unit_molar_mass": "kg/mol",
    "backbone_bonds": "bonds a repeat unit",
    "kuhn_length": "m",
    "entanglement_molar_mass": "kg/mol",
    "glass_transition": "K",
    "melting_temperature": "K",
    "melting_enthalpy": "J/mol",
    "heat_capacity": "J/kg/K",
}


@dataclass(frozen=True)
class Polymer:
    """A polymer as the solution needs it.

    Attributes
    ----------
    name : str
        Short name.
    density : float
        kg/m3, amorphous, near room temperature.
    repeat_unit : str
        Chemical formula; empty where unknown.
    repeat_unit_molar_mass : float
        kg/mol; NaN where unknown.
    backbone_bonds : int
        Main-chain bonds of a repeat unit; 0 where unknown.
    source : str
        Where the numbers come from.
    kuhn_length : float
        b in m, unperturbed chain in the melt; NaN where unknown.
    entanglement_molar_mass : float
        M_e in kg/mol, ``(4/5) rho R T/G_N`` of the melt; NaN where unknown.
    glass_transition : float
        T_g in K, amorphous, high molar mass; NaN where unknown.
    melting_temperature, melting_enthalpy : float
        Equilibrium melting point of the crystals in K and heat of fusion in J per mole of repeat units; NaN where the
        polymer does not crystallise, or they are not known.
    heat_capacity : float
        J/kg/K; NaN where unknown.
    """

    name: str
    density: float
    repeat_unit: str = ""
    repeat_unit_molar_mass: float = float("nan")
    backbone_bonds: int = 0
    source: str = "given by the user"
    kuhn_length: float = float("nan")
    entanglement_molar_mass: float = float("nan")
    glass_transition: float = float("nan")
    melting_temperature: float = float("nan")
    melting_enthalpy: float = float("nan")
    heat_capacity: float = float("nan")

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise InputError("polymer.name", "is not a name", value=self.name)
        positive("polymer_density", self.density, "kg/m3")
        for name, unit in _UNITS.items():
            value = getattr(self, name)
            if np.ndim(value):
                raise InputError(f"polymer.{name}", "must be a single number", value=value)
            unknown = value == 0 if name == "backbone_bonds" else isinstance(value, float) and np.isnan(value)
            if name != "density" and not unknown:
                positive(name, value, unit)


def packing_entanglement_molar_mass(
    density: float, repeat_unit_molar_mass: float, backbone_bonds: int, kuhn_length: float
) -> float:
    """Entanglement molar mass of a melt from its packing length, kg/mol; within a factor of 2.

    Parameters
    ----------
    density : float
        Of the *melt*, kg/m3, > 0: M_e goes as its inverse square, and the density near room temperature is 5 to 8 %
        too high.
    repeat_unit_molar_mass : float
        kg/mol, > 0.
    backbone_bonds : int
        Main-chain bonds of a repeat unit, > 0.
    kuhn_length : float
        m, > 0.

    Returns
    -------
    float
        At the density of the melt (413 K) 0.1 % and 4 % off the measured M_e of PMMA and PS, a third low for PEO; at
        that of the glass or crystal at room temperature 10, 17 and 43 % low.

    References
    ----------
    Fetters, Lohse, Richter, Witten, Zirkel, Macromolecules 27, 4639 (1994).
    """
    rho, mass = (
        positive("density", density, "kg/m3"),
        positive("repeat_unit_molar_mass", repeat_unit_molar_mass, "kg/mol"),
    )
    kuhn, bonds = positive("kuhn_length", kuhn_length, "m"), positive("backbone_bonds", backbone_bonds)
    per_volume = np.log(rho) + np.log(_AVOGADRO)  # logarithms: the cubes of extreme inputs are no doubles
    packing = np.log(mass) - np.log(kuhn) - np.log(BOND_PROJECTION) - np.log(bonds) - per_volume
    with np.errstate(over="ignore", under="ignore"):  # inf or 0: refused
        found = np.exp(np.log(0.8 * _TUBE_STRANDS**2) + per_volume + 3 * packing)
    return positive("entanglement_molar_mass", found, "kg/mol")


_HANDBOOK = "Brandrup, Immergut, Grulke (eds.), Polymer Handbook, 4th ed. (1999)"
_DATA_HANDBOOK = "Mark (ed.), Polymer Data Handbook (1999)"
_FETTERS = "Fetters et al., Macromolecules 27, 4639 (1994), 413 K"
_COLBY = "Rubinstein, Colby, Polymer Physics (2003), Table 2.1"
_BICERANO = "Bicerano, Prediction of Polymer Properties, 3rd ed. (2002), measured values"
_TUBBS = "Tubbs, J. Polym. Sci. A 3, 4181 (1965)"
_COLLAGEN = (
    "Eastoe, Leach, in Ward, Courts, The Science and Technology of Gelatin (1977); density of the dry film, about"
)
_ATHAS = "Wunderlich, ATHAS data bank; Pure Appl. Chem. 67, 1019 (1995)"
_OWN = "give your own where it matters"


_MELT = 0.94  # density at 413 K over that near room temperature: 0.95, 0.92, 0.94 for PMMA, PS, PEO


def _polymer(
    name: str,
    density: float,
    unit: str,
    mass: float,
    bonds: int,
    source: str,
    kuhn: float,
    glass: float,
    entanglement: float | None = None,
    crystal: tuple[float, float] = (float("nan"),) * 2,
    heat: float = float("nan"),
) -> Polymer:
    packed = entanglement
    if packed is None:
        packed = packing_entanglement_molar_mass(_MELT * density, mass, bonds, kuhn)
    return Polymer(name, density, unit, mass, bonds, source, kuhn, packed, glass, *crystal, heat)


POLYMERS: Mapping[str, Polymer] = {
    p.name: p
    for p in (
        _polymer("PEO", 1130.0, "C2H4O", 0.04405256, 3, _HANDBOOK, 1.1e-9, 206.0, 1.624, (342.0, 8660.0), 2000.0),
        _polymer("PMMA", 1190.0, "C5H8O2", 0.10011582, 2, _DATA_HANDBOOK, 1.7e-9, 378.0, 10.01, heat=1380.0),
        _polymer("PCL", 1145.0, "C6H10O2", 0.1141424, 7, _DATA_HANDBOOK, 1.0e-9, 213.0, None, (342.0, 15900.0), 1800.0),
        _polymer("PVP", 1200.0, "C6H9NO", 0.11114176, 2, _HANDBOOK, 2.0e-9, 418.0),
        _polymer("PAN", 1184.0, "C3H3N", 0.0530626, 2, _HANDBOOK, 1.6e-9, 378.0, heat=1300.0),
        _polymer("PS", 1050.0, "C8H8", 0.10414912, 2, _HANDBOOK, 1.8e-9, 373.0, 13.31, heat=1220.0),
        _polymer("PVA", 1269.0, "C2H4O", 0.04405256, 2, _HANDBOOK, 1.5e-9, 358.0, None, (501.0, 6870.0)),
        _polymer("PLA", 1248.0, "C3H4O2", 0.07206266, 3, _DATA_HANDBOOK, 1.1e-9, 330.0, None, (480.0, 6700.0)),
        _polymer("PVDF", 1680.0, "C2H2F2", 0.0640340864, 2, _DATA_HANDBOOK, 1.1e-9, 233.0, None, (483.0, 6700.0)),
        _polymer(
            "nylon 6", 1084.0, "C6H11NO", 0.11315764, 7, _DATA_HANDBOOK, 1.0e-9, 323.0, None, (533.0, 26000.0), 1500.0
        ),
        _polymer(
            "PET", 1333.0, "C10H8O4", 0.19216812, 9, _DATA_HANDBOOK, 1.3e-9, 342.0, None, (553.0, 26900.0), 1180.0
        ),
        _polymer(
            "cellulose acetate", 1300.0, "C10.9H14.9O7.45", 0.265130466, 4, _DATA_HANDBOOK, 12e-9, 463.0, float("nan")
        ),
        _polymer("PVB", 1100.0, "C8H14O2", 0.14219556, 4, _HANDBOOK, 1.7e-9, 345.0),
        _polymer("gelatin", 1350.0, "C3.86H6.2N1.115O1.446", 0.0913631329, 3, _COLLAGEN, 4e-9, 473.0, float("nan")),
    )
}

_PACKED = f"estimate from the packing length, within a factor of 3: {_OWN}"
_RATIO = f"handbook value from the characteristic ratio, within a third: {_OWN}"
_SOURCES: Mapping[str, Mapping[str, str]] = {
    "density": {
        "PCL": f"{_DATA_HANDBOOK}, half crystalline; its melt at 333 K 1100 kg/m3, within 5 %",
        "PVA": f"{_HANDBOOK}; 1210 (commercial grades) to 1269 kg/m3 in print",
        "PVDF": f"{_DATA_HANDBOOK}; 1680 to 1740 kg/m3 in print",
    },
    "kuhn_length": {
        "PEO": f"{_COLBY}; 0.7 (in water) to 1.1 nm in print",
        "PMMA": _COLBY,
        "PS": _COLBY,
        "gelatin": "twice the persistence length of Pezron, Djabourov, Leblond, Polymer 32, 3201 (1991)",
        "cellulose acetate": f"twice a persistence length of 5 to 7 nm, an estimate: {_OWN}",
    },
    "entanglement_molar_mass": {
        "PEO": _FETTERS,
        "PMMA": _FETTERS,
        "PS": _FETTERS,
        "PLA": "packing length, as neutrons see the chain (Anderson, Hillmyer, Macromolecules 37, 1857 (2004)): 3.3 to 8.7 "
        f"kg/mol in print: {_OWN}",
    },
    "melting_temperature": {
        "PEO": "Buckley, Kovacs, Colloid Polym. Sci. 254, 695 (1976)",
        "PVA": _TUBBS,
        "PCL": f"equilibrium values in print range from 337 to 352 K: {_OWN}",
        "PLA": "Kalb, Pennings, Polymer 21, 607 (1980); 480 to 488 K in print",
        "PVDF": "Nakagawa, Ishida, J. Polym. Sci. B 11, 2153 (1973)",
        "nylon 6": _ATHAS,
        "PET": _ATHAS,
    },
    "melting_enthalpy": {
        "PEO": _ATHAS,
        "PVA": _TUBBS,
        "PCL": "Crescenzi et al., Eur. Polym. J. 8, 449 (1972); 15.4 to 17.9 kJ/mol in print",
        "PLA": "Fischer, Sterzel, Wegner, Kolloid Z. Z. Polym. 251, 980 (1973)",
        "PVDF": "Nakagawa, Ishida, J. Polym. Sci. B 11, 2153 (1973)",
        "nylon 6": _ATHAS,
        "PET": _ATHAS,
    },
    "glass_transition": {
        "PEO": _HANDBOOK,
        "PMMA": _BICERANO,
        "PVP": f"{_BICERANO}; up to 450 K when very dry and long",
        "PAN": _BICERANO,
        "PS": _BICERANO,
        "PVA": _BICERANO,
        "nylon 6": "dry and amorphous; 313 to 335 K in print",
        "cellulose acetate": "acetylated to 2.45 a ring; 463 to 473 K in print",
        "PVB": "commercial grades, a fifth vinyl alcohol: 335 to 351 K in print; the pure polymer 324 K",
    },
}
_OTHERWISE = {
    "melting_temperature": "not known",
    "melting_enthalpy": "not known",
    "heat_capacity": f"handbook value of the amorphous polymer, within a tenth: {_OWN}",
    "kuhn_length": _RATIO,
    "entanglement_molar_mass": _PACKED,
    "glass_transition": f"handbook value, within 10 K: {_OWN}",
    "repeat_unit_molar_mass": "the formula, IUPAC atomic masses",
    "backbone_bonds": "the formula",
}
_WITHIN = {
    "density": "2 %",
    "kuhn_length": "15 %",
    "entanglement_molar_mass": "15 %",
    "glass_transition": "5 K",
    "melting_temperature": "5 K",
    "melting_enthalpy": "15 %",
}  # what tables differ by; of what says nothing closer


def polymer(name: str, field: str = "polymer") -> Polymer:
    """Built-in polymer by name.

    Raises
    ------
    InputError
        For a name that is not built in, with the nearest ones.
    """
    return POLYMERS[known_name(name, POLYMERS, field, "give its properties: {name = ..., density = ...}")]


def polymer_property(data: Polymer | str, name: str) -> float:
    """A property that a law needs, or an error that says which is missing and how to give it.

    Parameters
    ----------
    data : Polymer or str
        Data, or a built-in name.
    name : str
        A numeric attribute of `Polymer`.

    Returns
    -------
    float
        In the unit of the attribute.

    Raises
    ------
    InputError
        Where it is not known.
    """
    known = data if isinstance(data, Polymer) else polymer(data)
    if not isinstance(name, str) or name not in _UNITS:
        raise InputError("property", "is not one of a polymer", value=name, allowed=", ".join(_UNITS))
    value = float(getattr(known, name))
    if not value > 0:  # NaN, or 0 bonds
        raise InputError(
            f"{name} of {known.name}",
            "is not built in",
            remedy=f"give it ({_UNITS[name]}): dataclasses.replace(polymer, {name}=...)",
        )
    return value


def property_source(data: Polymer | str, name: str) -> str:
    """Where a property of a polymer comes from, and within what it holds; parameters and errors are those of
    `polymer_property`.

    Examples
    --------
    >>> property_source("PS", "entanglement_molar_mass")
    'Fetters et al., Macromolecules 27, 4639 (1994), 413 K; within 15 %'
    """
    known = data if isinstance(data, Polymer) else polymer(data)
    polymer_property(known, name)
    built = POLYMERS.get(known.name)
    if built is None or getattr(built, name) != getattr(known, name):
        return "given by the user"
    otherwise = known.source if name == "density" else _OTHERWISE[name]
    words = _SOURCES.get(name, {}).get(known.name, otherwise)
    said = "within" in words or "in print" in words or "formula" in words
    return words if said else f"{words}; within {_WITHIN[name]}"


def vitrification_fraction(
    data: Polymer | str, solvent_glass_transition: float, temperature: float, solvent_density: float
) -> float:
    """Polymer volume fraction that turns to glass at a temperature, by Fox's equation, within about 0.05.

    Parameters
    ----------
    data : Polymer or str
        With its glass transition and density.
    solvent_glass_transition : float
        K; `solvents.solvent_glass_transition` has that of the built-in ones.
    temperature : float
        Of the jet, K, above the solvent's transition.
    solvent_density : float
        kg/m3.

    Returns
    -------
    float
        In (0, 1); from ``1/T = w/T_gp + (1 - w)/T_gs`` with w the mass fraction.

    Raises
    ------
    InputError
        Where the glass transition is not known, or the dry polymer is no glass at this temperature.
    """
    known = data if isinstance(data, Polymer) else polymer(data)
    glass = polymer_property(known, "glass_transition")
    low = positive("solvent_glass_transition", solvent_glass_transition, "K")
    kelvin = positive("temperature", temperature, "K")
    if not low < kelvin < glass:
        raise InputError(
            "temperature",
            f"makes dry {known.name} a melt, or its solvent a glass: no fraction between turns to glass",
            value=kelvin,
            allowed=f"({low:g}, {glass:g}) K",
        )
    mass = (1 - low / kelvin) / (1 - low / glass)
    volume = mass / known.density
    return volume / (volume + (1 - mass) / positive("solvent_density", solvent_density, "kg/m3"))
