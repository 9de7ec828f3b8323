"""Every constant of the library's polymers and solvents against a second source: docs/physics/second-sources.csv.

    python benchmarks/second_sources.py docs/physics/second-sources.csv

Solvents at 298.15 K, computed from tables that the library does not take the value from (those of `chemicals`); what no
table has, and the polymers, entered by hand. `opened`: yes, the second source was opened for this table; no, its value is
quoted from memory of a published table, to be taken as such. `band`: what tables of such a property differ by, with room
for the difference seen, in percent (K for transitions and melting points); a test holds the library to it, so that no value
changes unseen. A value that nobody else was found to give has no second one.
"""

import csv
import math
import sys

import numpy as np

from spinline.rheology import POLYMERS, SOLVENTS, thermal, vapour
from spinline.rheology.materials import property_source
from spinline.rheology.solvents import solvent_density, solvent_surface_tension, solvent_viscosity

ROOM = 298.15
COLUMNS = ("material", "property", "unit", "library", "second", "difference", "band", "opened", "second source")
_BICERANO = "Bicerano (2002), as tabulated by Choi et al., Sci. Data 11, 363 (2024)"
_VDI = "VDI Heat Atlas"
_PERRY = "Perry's Handbook, 8th ed., Table 2-324: 273 K, carried to 298 K by T^1.75"
_LUGG = "Lugg, Anal. Chem. 40, 1072 (1968)"
_KREVELEN = "van Krevelen, te Nijenhuis, Properties of Polymers, 4th ed. (2009), amorphous"
_ATHAS = "Wunderlich, Thermal Analysis of Polymeric Materials (2005), ATHAS table"
_NETZSCH = "NETZSCH, Thermal Properties of Polymers"
_CHEMTEC = "Wypych, Handbook of Polymers, 2nd ed. (2016)"
_WIKIPEDIA = "Wikipedia (2023-24)"
_DANNER = (
    "Danner, High, Handbook of Polymer Solution Thermodynamics (1993), Tait equation at the glass, then 2.2e-4 1/K"
)
_CRC = "CRC Handbook of Chemistry and Physics, 97th ed."
_UNITS = {
    "density": "kg/m3",
    "kuhn_length": "nm",
    "entanglement_molar_mass": "kg/mol",
    "glass_transition": "K",
    "melting_temperature": "K",
    "melting_enthalpy": "kJ/mol",
    "heat_capacity": "J/kg/K",
}
_SCALE = {"kuhn_length": 1e9, "melting_enthalpy": 1e-3}
# (polymer, property): second value in the unit above, band (% or K), opened, source
_POLYMERS = {
    ("PEO", "density"): (1124.0, 2, True, f"{_CHEMTEC}: molar volume 39.2 cm3/mol"),
    ("PMMA", "density"): (1172.0, 2, True, _DANNER),
    ("PCL", "density"): (1100.0, 5, True, "Perstorp, safety data sheet of Capa 6800: the melt at 333 K"),
    ("PVP", "density"): (1200.0, 3, False, _WIKIPEDIA),
    ("PAN", "density"): (1184.0, 2, False, _WIKIPEDIA),
    ("PS", "density"): (1040.0, 2, True, _DANNER),
    ("PVA", "density"): (1210.0, 6, True, f"{_NETZSCH}: a commercial grade"),
    ("PLA", "density"): (1240.0, 2, False, "NatureWorks, data sheet of Ingeo 4032D"),
    ("PVDF", "density"): (1740.0, 4, False, _KREVELEN),
    ("nylon 6", "density"): (1080.0, 2, False, f"{_KREVELEN}; 1120 to 1150 half crystalline ({_NETZSCH})"),
    ("PET", "density"): (1330.0, 2, False, _KREVELEN),
    ("cellulose acetate", "density"): (1300.0, 3, False, _WIKIPEDIA),
    ("PVB", "density"): (1083.0, 3, False, "Solutia, Butvar properties and uses"),
    ("PEO", "kuhn_length"): (0.94, 20, False, "Fetters et al. (1994), <R2>/M = 0.805 A2 mol/g; 0.7 in print for water"),
    ("PMMA", "kuhn_length"): (1.69, 15, False, "Fetters et al. (1994), <R2>/M = 0.425 A2 mol/g"),
    ("PS", "kuhn_length"): (1.76, 15, True, "RepTate 1.3, materials database: 727 g/mol a Kuhn segment"),
    ("PVP", "kuhn_length"): (1.53, 34, True, "Guner, Ataman, Polym. Int. 44, 30 (1997): 16.1 to 16.8 nm at 78 kg/mol"),
    ("PLA", "kuhn_length"): (
        1.05,
        20,
        True,
        "Anderson, Hillmyer, Macromolecules 37, 1857 (2004): neutrons, 0.89 nm a C6 unit",
    ),
    ("PVA", "kuhn_length"): (1.56, 34, False, "characteristic ratio 8.3 in water, Polymer Handbook"),
    ("nylon 6", "kuhn_length"): (
        1.1,
        34,
        False,
        "characteristic ratio 6.1, Flory, Statistical Mechanics of Chain Molecules",
    ),
    ("PET", "kuhn_length"): (1.43, 34, False, "Fetters et al. (1994), <R2>/M = 0.845 A2 mol/g"),
    ("PS", "entanglement_molar_mass"): (13.2, 15, True, "RepTate 1.3, materials database: 4/5 of 16.5 kg/mol"),
    ("PLA", "entanglement_molar_mass"): (
        3.3,
        34,
        False,
        "Dorgan et al., J. Rheol. 49, 607 (2005): plateau modulus 1.0 MPa",
    ),
    ("PET", "entanglement_molar_mass"): (1.17, 200, False, "Fetters et al. (1994)"),
    ("PEO", "glass_transition"): (206.0, 5, True, _BICERANO),
    ("PMMA", "glass_transition"): (378.0, 5, False, _ATHAS),
    ("PCL", "glass_transition"): (213.0, 10, True, f"{_BICERANO}; Perstorp, Capa: 213 K"),
    ("PVP", "glass_transition"): (450.0, 35, False, "BASF, Buehler, Polyvinylpyrrolidone excipients (2005), K 90 dry"),
    ("PAN", "glass_transition"): (378.0, 5, False, _ATHAS),
    ("PS", "glass_transition"): (373.0, 5, False, _ATHAS),
    ("PVA", "glass_transition"): (358.0, 15, True, f"{_NETZSCH}: 343 to 373 K"),
    ("PLA", "glass_transition"): (331.0, 10, True, "Int. J. Polym. Sci. 2013, 315917: 328.7 to 332.1 K"),
    ("PVDF", "glass_transition"): (233.0, 10, True, _BICERANO),
    ("nylon 6", "glass_transition"): (335.0, 15, True, f"{_BICERANO}; 323 to 353 K ({_NETZSCH})"),
    ("PET", "glass_transition"): (345.0, 10, True, _BICERANO),
    ("cellulose acetate", "glass_transition"): (
        473.0,
        15,
        False,
        "Kamide, Saito, Polym. J. 17, 919 (1985): 523 - 20.3 DS",
    ),
    ("PVB", "glass_transition"): (324.0, 25, True, f"{_BICERANO}, the pure polymer; 318 to 336 K (CAMEO, MFA Boston)"),
    ("PEO", "melting_temperature"): (342.0, 5, False, _ATHAS),
    ("PCL", "melting_temperature"): (342.0, 5, False, _ATHAS),
    ("PVA", "melting_temperature"): (513.0, 20, True, f"{_NETZSCH}: observed, 493 to 533 K"),
    ("PLA", "melting_temperature"): (
        486.0,
        8,
        True,
        "Kricheldorf et al., Mater. Adv. 3, 1007 (2022): equilibrium, 486 +/- 2 K",
    ),
    ("PEO", "melting_enthalpy"): (8.66, 5, True, "TA Instruments, TN048 (after Wunderlich, 1990)"),
    ("PCL", "melting_enthalpy"): (15.7, 15, True, "Perstorp, Capa 6500: 76.9 J/g at 56 % crystalline"),
    ("PVA", "melting_enthalpy"): (6.87, 5, True, f"{_NETZSCH}: 156 J/g"),
    ("PLA", "melting_enthalpy"): (7.64, 15, True, "Kricheldorf et al., Mater. Adv. 3, 1007 (2022): 106 J/g"),
    ("PVDF", "melting_enthalpy"): (6.7, 15, False, "TA Instruments, TN048 (after Wunderlich, 1990)"),
    ("nylon 6", "melting_enthalpy"): (26.0, 5, True, "TA Instruments, TN048 (after Wunderlich, 1990)"),
    ("PET", "melting_enthalpy"): (26.9, 5, False, "TA Instruments, TN048 (after Wunderlich, 1990)"),
    ("nylon 6", "heat_capacity"): (1645.0, 12, True, f"{_NETZSCH}: 1590 to 1700 J/kg/K"),
}
# (solvent, property): second value, band in %, opened, source
_SOLVENTS = {
    ("DMF", "density"): (944.0, 0.5, False, "Riddick, Bunger, Sakano, Organic Solvents, 4th ed. (1986)"),
    ("THF", "density"): (883.3, 0.5, False, _CRC),
    ("DMSO", "density"): (1095.5, 0.5, False, "Riddick, Bunger, Sakano, Organic Solvents, 4th ed. (1986)"),
    ("DMAc", "density"): (937.0, 0.5, True, _WIKIPEDIA),
    ("TFA", "density"): (1477.5, 1.0, False, f"{_WIKIPEDIA}: 1489 at 293 K"),
    ("TFE", "density"): (1384.2, 1.0, False, f"{_CRC}: 293 K"),
    ("NMP", "density"): (1028.0, 0.5, False, _WIKIPEDIA),
    ("DMSO", "vapour_pressure"): (80.0, 10, False, "Gaylord Chemical, physical properties: 0.600 mmHg"),
    ("DMAc", "vapour_pressure"): (300.0, 20, True, _WIKIPEDIA),
    ("NMP", "vapour_pressure"): (46.0, 20, False, "0.345 mmHg, U.S. EPA"),
    ("TFE", "heat_of_vaporisation"): (44.0, 8, True, f"{_CRC}: enthalpies of formation of gas and liquid"),
    ("DMSO", "surface_tension"): (42.97, 3, True, f"{_WIKIPEDIA} after Adamson: 43.54 at 293 K, 0.1145 mN/m/K"),
    ("DMF", "surface_tension"): (36.4, 8, False, "surface-tension.de: 37.1 at 293 K"),
    ("THF", "surface_tension"): (27.4, 5, True, "Accu Dyne Test, surface tension components (2024)"),
    ("NMP", "surface_tension"): (40.2, 3, False, "surface-tension.de: 40.79 at 293 K"),
    ("acetone", "surface_tension"): (23.03, 5, True, _VDI),
    ("TFA", "surface_tension"): (13.53, 3, False, _CRC),
    ("DMAc", "viscosity"): (0.927, 15, False, "Riddick, Bunger, Sakano, Organic Solvents, 4th ed. (1986)"),
    ("NMP", "viscosity"): (1.65, 15, False, _WIKIPEDIA),
    ("methanol", "diffusivity"): (0.152, 8, False, _LUGG),
    ("isopropanol", "diffusivity"): (0.1013, 8, False, _LUGG),
    ("ethyl acetate", "diffusivity"): (0.0861, 8, False, _LUGG),
    ("MEK", "diffusivity"): (0.0903, 8, False, _LUGG),
    ("dioxane", "diffusivity"): (0.0922, 8, False, _LUGG),
    ("chlorobenzene", "diffusivity"): (0.0747, 8, False, _LUGG),
    ("DCE", "diffusivity"): (0.0907, 8, False, _LUGG),
    ("THF", "viscosity"): (0.456, 5, False, _CRC),
    ("water", "diffusivity"): (0.2564, 8, False, _PERRY),
    ("ethanol", "diffusivity"): (0.1189, 8, True, _PERRY),
    ("acetone", "diffusivity"): (0.1049, 8, False, f"{_LUGG}; 0.127 from {_PERRY}"),
    ("chloroform", "diffusivity"): (0.0888, 8, False, f"{_LUGG}; 0.106 from {_PERRY}"),
    ("acetic acid", "diffusivity"): (0.1240, 8, True, _PERRY),
    ("formic acid", "diffusivity"): (0.1530, 8, False, _LUGG),
    ("toluene", "diffusivity"): (0.0849, 8, False, _LUGG),
    ("DCM", "diffusivity"): (0.1037, 8, False, _LUGG),
    ("DMF", "diffusivity"): (0.0973, 8, False, _LUGG),
}  # fmt: skip


def _tables():
    """Of every property of a solvent, tables (name, index, value of a row in the unit of the page), the first with it
    taken.
    """
    from chemicals import interface, phase_change, vapor_pressure, viscosity, volume
    from chemicals.dippr import EQ106

    def vdi_density(r):
        t = 1 - ROOM / r.Tc
        return r.rhoc + r.A * t**0.35 + r.B * t ** (2 / 3) + r.C * t + r.D * t ** (4 / 3)

    def antoine(base):
        return lambda r: (
            vapor_pressure.Antoine(ROOM, r.A, r.B, r.C, base=base) if r.Tmin - 10 < ROOM < r.Tmax else math.nan
        )

    # fmt: off
    return {
        "density": [(_VDI, volume.rho_data_VDI_PPDS_2, vdi_density)],
        "vapour_pressure": [
            (_VDI, vapor_pressure.Psat_data_VDI_PPDS_3,
             lambda r: vapor_pressure.Wagner(ROOM, r.Tc, r.Pc, r.A, r.B, r.C, r.D)),
            ("Poling, Prausnitz, O'Connell, 5th ed., Antoine", vapor_pressure.Psat_data_AntoinePoling, antoine(10.0)),
            ("Landolt-Boernstein IV/20, Antoine", vapor_pressure.Psat_data_Landolt_Antoine, antoine(math.e)),
        ],
        "heat_of_vaporisation": [
            (_CRC, phase_change.Hvap_data_CRC, lambda r: 1e-3 * r.Hvap298),
            ("Gharagheizi et al., Ind. Eng. Chem. Res. 52, 13217 (2013)", phase_change.Hvap_data_Gharagheizi,
             lambda r: 1e-3 * r.Hvap298),
        ],
        "surface_tension": [
            (_VDI, interface.sigma_data_VDI_PPDS_11,
             lambda r: 1e3 * EQ106(ROOM, r.Tc, r.A, r.B, r.C, r.D, r.E)),
        ],
        "viscosity": [
            (_VDI, viscosity.mu_data_VDI_PPDS_7,
             lambda r: 1e3 * viscosity.PPDS9(ROOM, r.A, r.B, r.C, r.D, r.E)),
            ("Viswanath, Natarajan, Data Book on the Viscosity of Liquids (1989)", viscosity.mu_data_VN3,
             lambda r: viscosity.Viswanath_Natarajan_3(ROOM, r.A, r.B, r.C)),
        ],
        "diffusivity": [],
    }
    # fmt: on


# the library's own source is one of these tables: no second look
_SAME = {("HFIP", "vapour_pressure"), ("TFA", "vapour_pressure"), ("NMP", "vapour_pressure"), ("TFE", "viscosity")}
_BAND = {
    "density": 0.5,
    "vapour_pressure": 5.0,
    "heat_of_vaporisation": 3.0,
    "surface_tension": 3.0,
    "viscosity": 5.0,
}
_LOOSE = {("DMAc", "heat_of_vaporisation"): 8.0, ("NMP", "heat_of_vaporisation"): 12.0}


def _own(name):
    return {
        "density": ("kg/m3", solvent_density(name, ROOM)),
        "vapour_pressure": ("Pa", float(thermal.saturation_pressure(name, ROOM))),
        "heat_of_vaporisation": (
            "kJ/mol",
            1e-3 * float(thermal.vaporisation_heat(name, ROOM)) * vapour.molar_mass(name),
        ),
        "surface_tension": ("mN/m", 1e3 * solvent_surface_tension(name, ROOM)),
        "viscosity": ("mPa s", 1e3 * solvent_viscosity(name, ROOM)),
        "diffusivity": ("cm2/s in air", 1e4 * vapour.vapour_diffusivity(name, ROOM)),
    }


def _row(material, what, unit, own, found, kelvin=False):
    if found is None:
        return (material, what, unit, f"{own:.4g}", "", "", "", "", "no second source found")
    second, band, opened, source = found
    difference = own - second if kelvin else 100 * (own / second - 1)
    sign = f"{difference:+.1f}" + (" K" if kelvin else " %")
    return (
        material,
        what,
        unit,
        f"{own:.4g}",
        f"{second:.4g}",
        sign,
        f"{band:g}" + (" K" if kelvin else " %"),
        "yes" if opened else "no",
        source,
    )


def rows():
    """Of every constant, as text."""
    found = []
    for name, data in POLYMERS.items():
        for what, unit in _UNITS.items():
            own = getattr(data, what) * _SCALE.get(what, 1.0)
            if own > 0 and "packing" not in property_source(name, what):
                kelvin = what in ("glass_transition", "melting_temperature")
                found.append(_row(name, what, unit, own, _POLYMERS.get((name, what)), kelvin))
            elif own > 0 and (name, what) in _POLYMERS:
                found.append(_row(name, what, unit, own, _POLYMERS[name, what]))
    tables = _tables()
    for name, (cas, _, _) in SOLVENTS.items():
        for what, (unit, own) in _own(name).items():
            second = _SOLVENTS.get((name, what))
            for source, table, value in tables[what] if (name, what) not in _SAME else ():
                if second is None and cas in table.index and np.isfinite(value(table.loc[cas])):
                    band = _LOOSE.get((name, what), _BAND[what])
                    second = (float(value(table.loc[cas])), band, True, source)
            found.append(_row(name, what, unit, own, second))
    return found


def main():
    """Write the table."""
    with open(sys.argv[1], "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(rows())


if __name__ == "__main__":
    main()
