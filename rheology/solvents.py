"""Built-in solvents: density, viscosity, surface tension and glass transition against temperature, alone and mixed.

====================  ==================================================================================================
property              source
====================  ==================================================================================================
density               IAPWS-95 (water), DIPPR 105 (Perry's Handbook, 8th ed.); HFIP 1596 kg/m3 at 298 K (Sigma-Aldrich
                      specification), within 1.5 % over 288 to 308 K; DMAc, NMP, TFA and TFE lines through handbook values
                      near room temperature (CRC Handbook), within 0.5 % (TFE 1 %)
viscosity             IAPWS (water), DIPPR 101 (Perry's Handbook, 8th ed.); HFIP 1.619 mPa s at 298 K (Krumgalz, J. Chem. Soc.
                      Faraday Trans. 1 79, 571 (1983)), within 15 % over 293 to 303 K; NMP, TFA and DMAc handbook
                      values, TFE of Viswanath and Natarajan (1989), at 298 K, within 15 % over 293 to 303 K
surface tension       IAPWS (water); Mulero, Cachadina, Parra, J. Phys. Chem. Ref. Data 41, 043105 (2012) (ethanol, acetone);
                      Jasper, J. Phys. Chem. Ref. Data 1, 841 (1972) (DCM,
                      chloroform, formic acid, acetic acid, TFA, toluene, the alcohols but ethanol, esters, ketones, dioxane,
                      DCE, chlorobenzene); DMF, THF, DMSO and DMAc
                      at 298 K from the Minnesota solvent descriptors (2009), HFIP from a table of electrospinning
                      solvents, NMP, TFE and acetonitrile (CRC Handbook; Jasper's line is 7 % lower) handbook values, all
                      within 8 % over 288 to 308 K: give your own where it matters
glass transition      water 136 K (Johari et al., Nature 330, 552 (1987)), ethanol 97 K (Haida et al., J. Chem. Thermodyn.
                      9, 815 (1977)); the others 2/3 of the melting point (Boyer's rule), within a fifth
====================  ==================================================================================================

The CRC Handbook (97th ed.) prints 1460 kg/m3 for HFIP, and so does the `chemicals` library: that is 9 % under what the
molar volumes of ethanol, trifluoroethanol and isopropanol lead to (1611), and is not used here.

Mixtures: volumes add; ``ln mu`` is averaged by mass, good for like with like, too low where water meets alcohols,
amides or ethers (water-ethanol: up to 2.6 times); surface tensions by Winterfeld, Scriven and Davis, AIChE J. 24, 1010
(1978), too high where one liquid covers the surface of water. Measured values can be given instead everywhere.
"""

import difflib
from collections.abc import Mapping
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.rheology._liquid_rows import MELTING, row_of
from spinline.rheology._water import HIGHEST, water_density, water_viscosity
from spinline.rheology.atoms import ELEMENTS, VAPOURS
from spinline.rheology.names import known_as

__all__ = [
    "SOLVENTS",
    "mixture_density",
    "mixture_surface_tension",
    "mixture_viscosity",
    "solvent_density",
    "solvent_glass_transition",
    "solvent_molar_mass",
    "solvent_surface_tension",
    "solvent_viscosity",
]

# name: (CAS number, range of the density in K)
SOLVENTS: Mapping[str, tuple[str, float, float]] = {
    "water": ("7732-18-5", 273.16, 640.0),
    "ethanol": ("64-17-5", 159.05, 513.0),
    "acetone": ("67-64-1", 178.45, 507.0),
    "DMF": ("68-12-2", 212.72, 649.0),
    "DCM": ("75-09-2", 178.01, 509.0),
    "chloroform": ("67-66-3", 209.63, 536.0),
    "THF": ("109-99-9", 164.65, 540.0),
    "formic acid": ("64-18-6", 281.45, 587.0),
    "HFIP": ("920-66-1", 288.15, 308.15),
    "DMSO": ("67-68-5", 291.67, 729.0),
    "DMAc": ("127-19-5", 253.15, 373.15),
    "acetic acid": ("64-19-7", 289.85, 591.9),
    "TFA": ("76-05-1", 258.15, 345.15),
    "NMP": ("872-50-4", 249.15, 373.15),
    "toluene": ("108-88-3", 178.18, 591.7),
    "methanol": ("67-56-1", 175.47, 512.0),
    "isopropanol": ("67-63-0", 185.26, 508.0),
    "ethyl acetate": ("141-78-6", 189.6, 523.0),
    "DCE": ("107-06-2", 237.49, 561.0),
    "MEK": ("78-93-3", 186.48, 535.0),
    "acetonitrile": ("75-05-8", 229.32, 545.0),
    "dioxane": ("123-91-1", 284.95, 586.0),
    "chlorobenzene": ("108-90-7", 227.95, 632.0),
    "TFE": ("75-89-8", 253.15, 347.0),
}
# lines near room temperature: kg/m3 at 298.15 K, and its fall, kg/m3/K
_LINES = {"DMAc": (936.6, 0.93), "NMP": (1027.9, 0.87), "TFA": (1478.5, 2.3), "TFE": (1382.0, 1.7)}
# Pa s at 298 K
_ONE_VISCOSITY = {"HFIP": 1.619e-3, "NMP": 1.666e-3, "TFA": 0.813e-3, "DMAc": 0.945e-3, "TFE": 1.75e-3}
_HFIP_DENSITY = 1596.0
_CAL_PER_MOL_A2 = 4.184 / 6.02214076e23 / 1e-20  # N/m
# N/m at 298 K
_NEAR_ROOM = {
    "DMF": 49.56 * _CAL_PER_MOL_A2,
    "THF": 39.44 * _CAL_PER_MOL_A2,
    "HFIP": 16.1e-3,
    "DMSO": 61.78 * _CAL_PER_MOL_A2,
    "DMAc": 47.62 * _CAL_PER_MOL_A2,
    "NMP": 40.7e-3,
    "TFE": 20.6e-3,
    "acetonitrile": 28.66e-3,
}
# mN/m/K; 0.1844 in the table is a slip of the pen: the surface would vanish at 85 degC, 130 K under the critical point
_TFA_SLOPE = 0.08444
_GLASS = {"water": 136.0, "ethanol": 97.0}


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
        Within 0.2 % of measured values near room temperature (methanol 0.4 %, TFE 1 %, HFIP 1.5 %).

    Raises
    ------
    InputError
        For an unknown solvent, or a temperature at which it is not a liquid.
    """
    known = known_name(name, SOLVENTS, field, "give its density: {name = ..., density = ...}")
    cas, low, high = SOLVENTS[known]
    kelvin = _within(f"liquid range of {known}", temperature, low, high)
    if known == "HFIP":
        return _HFIP_DENSITY
    if known in _LINES:
        at_room, fall = _LINES[known]
        return at_room - fall * (kelvin - 298.15)
    if known == "water":
        if kelvin <= HIGHEST:
            return water_density(kelvin)
        from chemicals.iapws import iapws95_rhol_sat

        return float(iapws95_rhol_sat(kelvin))
    from chemicals.dippr import EQ105

    row = row_of("rho_data_Perry_8E_105_l", cas)
    molar = float(EQ105(kelvin, row["C1"], row["C2"], row["C3"], row["C4"]))  # mol/m3
    return molar * solvent_molar_mass(known)


def solvent_viscosity(name: str, temperature: float, field: str = "solvent") -> float:
    """Viscosity of a liquid solvent in Pa s; parameters and errors are those of `solvent_density`.

    Within 5 % near room temperature. HFIP, NMP, TFA, DMAc, TFE: 293 to 303 K, within 15 %.
    """
    density = solvent_density(name, temperature, field)
    known = known_name(name, SOLVENTS, field, "give solvent_viscosity")
    if known in _ONE_VISCOSITY:
        _within(f"range of the viscosity of {known}", temperature, 293.15, 303.15, "give solvent_viscosity (Pa s)")
        return _ONE_VISCOSITY[known]
    if known == "water":
        if temperature <= HIGHEST:
            return water_viscosity(temperature)
        from chemicals.viscosity import mu_IAPWS

        return float(mu_IAPWS(temperature, density))
    from chemicals.dippr import EQ101

    row = row_of("mu_data_Perrys_8E_2_313", SOLVENTS[known][0])
    return float(EQ101(temperature, row["C1"], row["C2"], row["C3"], row["C4"], row["C5"]))


def solvent_surface_tension(name: str, temperature: float, field: str = "solvent") -> float:
    """Surface tension of a liquid solvent against air in N/m; parameters and errors are those of `solvent_density`.

    Within 3 % near room temperature; DMF, THF, HFIP, DMSO, DMAc, NMP, TFE and acetonitrile within 8 % from 288 to 308 K.
    """
    known = known_name(name, SOLVENTS, field, "give surface_tension (N/m)")
    what, remedy = f"range of the surface tension of {known}", "give surface_tension (N/m)"
    if known in _NEAR_ROOM:
        _within(what, temperature, 288.15, 308.15, remedy)
        return _NEAR_ROOM[known]
    cas, low, high = SOLVENTS[known]
    row: Any
    if known == "water":
        from chemicals.interface import sigma_IAPWS

        return float(sigma_IAPWS(_within(what, temperature, low, high, remedy)))
    if known in ("ethanol", "acetone"):
        from chemicals.interface import REFPROP_sigma, sigma_data_Mulero_Cachadina

        row = sigma_data_Mulero_Cachadina.loc[cas]
        kelvin = _within(what, temperature, float(row["Tmin"]), min(float(row["Tmax"]), high), remedy)
        terms = [float(row[key]) for key in ("Tc", "sigma0", "n0", "sigma1", "n1", "sigma2", "n2")]
        return float(REFPROP_sigma(kelvin, *terms))
    from chemicals.interface import Jasper, sigma_data_Jasper_Lange

    row = sigma_data_Jasper_Lange.loc[cas]
    kelvin = _within(what, temperature, float(row["Tmin"]), float(row["Tmax"]), remedy)
    slope = _TFA_SLOPE if known == "TFA" else row["b"]
    return float(Jasper(kelvin, row["a"], slope))


def solvent_glass_transition(name: str, field: str = "solvent") -> float:
    """Glass transition of a solvent in K: measured for water and ethanol, otherwise 2/3 of the melting point."""
    known = known_name(name, SOLVENTS, field, "give solvent_glass_transition (K)")
    if known in _GLASS:
        return _GLASS[known]
    return 2 / 3 * MELTING[SOLVENTS[known][0]]


def solvent_molar_mass(name: str, field: str = "solvent") -> float:
    """Molar mass of a solvent in kg/mol, from its atoms (`atoms.VAPOURS`, whose keys are those of `SOLVENTS`)."""
    from chemicals.elements import molecular_weight

    known = known_name(name, VAPOURS, field, "give molar_mass (kg/mol)")
    atoms = dict(zip(ELEMENTS, VAPOURS[known], strict=False))
    return float(molecular_weight(atoms)) * 1e-3


def volume_shares(shares: Mapping[str, float], temperature: float, field: str = "solvent") -> dict[str, float]:
    """Volume fractions of solvents given by mass fraction; parameters and errors as for `mixture_density`."""
    volumes = mass_shares(shares, field) / np.array([solvent_density(name, temperature, field) for name in shares])
    return dict(zip(shares, (volumes / volumes.sum()).tolist(), strict=True))


def mixture_density(shares: Mapping[str, float], temperature: float, field: str = "solvent") -> float:
    """Density of a solvent mixture in kg/m3, volumes additive: a few percent low where water meets another solvent.

    Parameters
    ----------
    shares : mapping
        Names to mass fractions > 0 of sum 1.
    temperature : float
        K.
    field : str
        Name shown in errors.

    Returns
    -------
    float

    Raises
    ------
    InputError
        As for `solvent_density`, and for fractions that do not sum to 1.
    """
    part = mass_shares(shares, field)
    return float(1 / np.sum(part / np.array([solvent_density(name, temperature, field) for name in shares])))


def mixture_viscosity(shares: Mapping[str, float], temperature: float, field: str = "solvent") -> float:
    """Viscosity of a solvent mixture in Pa s, ``exp(sum w_i ln mu_i)``; parameters and errors as for `mixture_density`.

    Water with ethanol is up to 2.6 times as viscous as this; give the viscosity where it matters.
    """
    part = mass_shares(shares, field)
    return float(np.exp(part @ np.log([solvent_viscosity(name, temperature, field) for name in shares])))


def mixture_surface_tension(shares: Mapping[str, float], temperature: float, field: str = "solvent") -> float:
    """Surface tension of a solvent mixture in N/m (Winterfeld, Scriven, Davis); parameters as for `mixture_density`.

    ``(sum_i V_i sqrt(sigma_i))^2`` with volume fractions V: too high by up to a half for a little of anything in water.
    """
    volume = np.array(list(volume_shares(shares, temperature, field).values()))
    roots = np.sqrt([solvent_surface_tension(name, temperature, field) for name in shares])
    return float((volume @ roots) ** 2)


def mass_shares(shares: Mapping[str, float], field: str) -> FloatArray:
    """Mass fractions of a mixture, checked: > 0, sum 1 to 1e-6."""
    if not isinstance(shares, Mapping):
        raise InputError(field, "is not a mapping of names to mass fractions", value=shares)
    names = [name.strip().lower() if isinstance(name, str) else None for name in shares]
    if None in names or len(set(names)) < len(names):
        raise InputError(field, "must have names, each once", value=list(shares))
    part = real(field, list(shares.values()), above=0.0, most=1.0)
    if abs(float(part.sum()) - 1) > 1e-6:
        raise InputError(field, "mass fractions must sum to 1", value=dict(shares), remedy="scale them")
    return part


def known_name(name: str, table: Mapping[str, object], field: str, remedy: str) -> str:
    """The key of a table that is meant, by its name or another (`names`); refuse others with the nearest."""
    if not isinstance(name, str):
        raise InputError(field, "is not a name", value=name, allowed=", ".join(table), remedy=remedy)
    by_lower = {key.lower(): key for key in table}
    key = known_as(name, table)
    if key is None:
        near = difflib.get_close_matches(name.lower().replace("0", "o"), by_lower, n=1)
        hint = f"did you mean {by_lower[near[0]]!r}? Otherwise {remedy}" if near else remedy
        raise InputError(field, "is not built in", value=name, allowed=", ".join(table), remedy=hint)
    return key


def _within(what: str, temperature: float, low: float, high: float, remedy: str = "") -> float:
    kelvin = positive("temperature", temperature, "K")
    if not low <= kelvin <= high:
        raise InputError(
            "temperature", f"is outside the {what}", value=kelvin, allowed=f"[{low:g}, {high:g}] K", remedy=remedy
        )
    return kelvin
