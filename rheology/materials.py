"""Built-in polymers and solvents: each a function of nothing (or of temperature) that returns fresh, cited data.

Polymers are measured densities and repeat units, with Kuhn length, entanglement molar mass and glass transition where a source
was at hand; `polymer_property` says what is missing and how to give it. Solvent densities come from the `chemicals` library:
IAPWS-95 for water, DIPPR 105 (Perry's Handbook, 8th ed.) for the others, at the temperature asked for. A name that is not
here is not an obstacle: give the properties themselves.
"""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass

from spinline.checks import positive
from spinline.errors import InputError

__all__ = [
    "POLYMERS",
    "SOLVENTS",
    "Polymer",
    "polymer",
    "polymer_property",
    "solvent_density",
    "solvent_viscosity",
    "vitrification_fraction",
]


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


_HANDBOOK = "Brandrup, Immergut, Grulke (eds.), Polymer Handbook, 4th ed. (1999)"
_DATA_HANDBOOK = "Mark (ed.), Polymer Data Handbook (1999)"

# Kuhn lengths: Rubinstein, Colby, Polymer Physics (2003), Table 2.1. M_e at 413 K: Fetters et al., Macromolecules 27, 4639
# (1994). Glass transitions: Polymer Handbook (1999).
POLYMERS: Mapping[str, Polymer] = {
    p.name: p
    for p in (
        Polymer("PEO", 1130.0, "C2H4O", 0.04405256, 3, _HANDBOOK, 1.1e-9, 1.624, 206.0),
        Polymer("PMMA", 1190.0, "C5H8O2", 0.10011582, 2, _DATA_HANDBOOK, 1.7e-9, 10.01, 378.0),
        Polymer("PCL", 1145.0, "C6H10O2", 0.1141424, 7, _DATA_HANDBOOK, glass_transition=213.0),
        Polymer("PVP", 1200.0, "C6H9NO", 0.11114176, 2, _HANDBOOK),
        Polymer("PAN", 1184.0, "C3H3N", 0.0530626, 2, _HANDBOOK, glass_transition=370.0),
        Polymer("PS", 1050.0, "C8H8", 0.10414912, 2, _HANDBOOK, 1.8e-9, 13.31, 373.0),
        Polymer("PVA", 1269.0, "C2H4O", 0.04405256, 2, _HANDBOOK, glass_transition=358.0),
        Polymer("PLA", 1248.0, "C3H4O2", 0.07206266, 3, _DATA_HANDBOOK, glass_transition=330.0),
    )
}

_UNITS = {
    "density": "kg/m3",
    "repeat_unit_molar_mass": "kg/mol",
    "backbone_bonds": "bonds a repeat unit",
    "kuhn_length": "m",
    "entanglement_molar_mass": "kg/mol",
    "glass_transition": "K",
}

# name: (CAS number, range of the correlation in K)
SOLVENTS: Mapping[str, tuple[str, float, float]] = {
    "water": ("7732-18-5", 273.16, 640.0),
    "ethanol": ("64-17-5", 159.05, 513.0),
    "acetone": ("67-64-1", 178.45, 507.0),
    "DMF": ("68-12-2", 212.72, 649.0),
    "DCM": ("75-09-2", 178.01, 509.0),
    "chloroform": ("67-66-3", 209.63, 536.0),
    "THF": ("109-99-9", 164.65, 540.0),
    "formic acid": ("64-18-6", 281.45, 587.0),
}


def polymer(name: str, field: str = "polymer") -> Polymer:
    """Built-in polymer by name.

    Raises
    ------
    InputError
        For a name that is not built in, with the nearest ones.
    """
    return POLYMERS[_known(name, POLYMERS, field, "give its properties: {name = ..., density = ...}")]


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
    known = polymer(data) if isinstance(data, str) else data
    if name not in _UNITS:
        raise InputError("property", "is not one of a polymer", value=name, allowed=", ".join(_UNITS))
    value = float(getattr(known, name))
    if not value > 0:  # NaN, or 0 bonds
        raise InputError(
            f"{name} of {known.name}", "is not built in",
            remedy=f"give it ({_UNITS[name]}): dataclasses.replace(polymer, {name}=...)",
        )  # fmt: skip
    return value


def vitrification_fraction(
    data: Polymer | str, solvent_glass_transition: float, temperature: float, solvent_density: float
) -> float:
    """Polymer volume fraction that turns to glass at a temperature, by Fox's equation, within about 0.05.

    Parameters
    ----------
    data : Polymer or str
        With its glass transition and density.
    solvent_glass_transition : float
        K: 136 for water (Johari et al., Nature 330, 552 (1987)), 97 for ethanol (Haida et al., J. Chem. Thermodyn. 9, 815
        (1977)).
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
    known = polymer(data) if isinstance(data, str) else data
    glass = polymer_property(known, "glass_transition")
    low = positive("solvent_glass_transition", solvent_glass_transition, "K")
    kelvin = positive("temperature", temperature, "K")
    if not low < kelvin < glass:
        raise InputError(
            "temperature", f"leaves dry {known.name} no glass, or its solvent one", value=kelvin,
            allowed=f"({low:g}, {glass:g}) K",
        )  # fmt: skip
    mass = (1 / low - 1 / kelvin) / (1 / low - 1 / glass)
    volume = mass / known.density
    return volume / (volume + (1 - mass) / positive("solvent_density", solvent_density, "kg/m3"))


def solvent_density(name: str, temperature: float, field: str = "solvent") -> float:
    """Density of a liquid solvent in kg/m3.

    Parameters
    ----------
    name : str
        A key of `SOLVENTS`.
    temperature : float
        K, within the range of the correlation (liquid).
    field : str
        Name shown in errors.

    Returns
    -------
    float
        Within 0.2 % of measured values near room temperature.

    Raises
    ------
    InputError
        For an unknown solvent, or a temperature at which it is not a liquid.
    """
    known = _known(name, SOLVENTS, field, "give its density: {name = ..., density = ...}")
    cas, low, high = SOLVENTS[known]
    if not low <= temperature <= high:
        raise InputError(
            "temperature",
            f"is outside the liquid range of {known}",
            value=temperature,
            allowed=f"[{low:g}, {high:g}] K",
        )
    if known == "water":
        from chemicals.iapws import iapws95_rhol_sat

        return float(iapws95_rhol_sat(temperature))
    from chemicals.dippr import EQ105
    from chemicals.identifiers import MW
    from chemicals.volume import rho_data_Perry_8E_105_l

    row = rho_data_Perry_8E_105_l.loc[cas]
    molar = float(EQ105(temperature, row["C1"], row["C2"], row["C3"], row["C4"]))  # mol/m3
    return molar * float(MW(cas)) * 1e-3  # MW in g/mol


def _known(name: str, table: Mapping[str, object], field: str, remedy: str) -> str:
    if not isinstance(name, str):
        raise InputError(field, "is not a name", value=name, allowed=", ".join(table), remedy=remedy)
    by_lower = {key.lower(): key for key in table}
    key = by_lower.get(name.strip().lower())
    if key is None:
        near = difflib.get_close_matches(name.lower(), by_lower, n=1)
        hint = f"did you mean {by_lower[near[0]]!r}? Otherwise {remedy}" if near else remedy
        raise InputError(field, "is not built in", value=name, allowed=", ".join(table), remedy=hint)
    return key


def solvent_viscosity(name: str, temperature: float, field: str = "solvent") -> float:
    """Viscosity of a liquid solvent in Pa s; IAPWS for water, DIPPR 101 (Perry's Handbook) for the others.

    Parameters and errors are those of `solvent_density`; a few percent near room temperature.
    """
    density = solvent_density(name, temperature, field)
    known = _known(name, SOLVENTS, field, "give solvent_viscosity")
    if known == "water":
        from chemicals.viscosity import mu_IAPWS

        return float(mu_IAPWS(temperature, density))
    from chemicals.dippr import EQ101
    from chemicals.viscosity import mu_data_Perrys_8E_2_313

    row = mu_data_Perrys_8E_2_313.loc[SOLVENTS[known][0]]
    return float(EQ101(temperature, row["C1"], row["C2"], row["C3"], row["C4"], row["C5"]))
