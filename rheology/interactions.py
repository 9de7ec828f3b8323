"""Flory-Huggins parameters that are known: of polymers with solvents, with water, and of water with solvents.

Near 25 degC. Values in print for one pair differ by 0.05 to 0.1, and depend on the concentration; those with water are
from membranes, or follow from the water a polymer takes up in saturated air, ``chi = -[ln phi_1 + (1 - phi_1)]/(1 -
phi_1)^2``. A pair that is not here is not known: nothing is guessed for it.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.rheology.materials import POLYMERS
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS

__all__ = ["chi_from_uptake", "interaction", "water_interaction"]

_HANDBOOK = "Polymer Handbook, 4th ed. (1999), VII/247"
_ALTENA = "Altena, Smolders, Macromolecules 15, 1491 (1982)"
# (polymer, liquid): chi, source
_POLYMER: Mapping[tuple[str, str], tuple[float, str]] = {
    ("PEO", "water"): (0.45, f"{_HANDBOOK}; 0.4 to 0.5 in print"),
    ("PMMA", "acetone"): (0.48, _HANDBOOK),
    ("PMMA", "chloroform"): (0.38, _HANDBOOK),
    ("PS", "toluene"): (0.38, _HANDBOOK),
    ("PVA", "water"): (0.49, _HANDBOOK),
    ("cellulose acetate", "acetone"): (0.45, _ALTENA),
    ("cellulose acetate", "water"): (1.4, _ALTENA),
}
# mass of water in saturated air over the dry polymer's, near 25 degC
_UPTAKE: Mapping[str, tuple[float, str]] = {
    "PMMA": (0.021, "uptake of 2.1 %, Polymer Data Handbook (1999)"),
    "PS": (0.0005, "uptake of 0.05 %, Polymer Data Handbook (1999)"),
    "PET": (0.008, "uptake of 0.8 %, Polymer Data Handbook (1999)"),
    "PLA": (0.010, "uptake of about 1 %, within a half"),
    "PCL": (0.004, "uptake of about 0.4 %, within a factor of 2"),
    "PVDF": (0.0004, "uptake of 0.04 %, data sheets"),
}
# water with a solvent, by water's volume: Altena and Smolders' g(u) at u = 1/2
_WATER: Mapping[str, tuple[float, str]] = {
    "DMF": (0.62, f"{_ALTENA}, taken at half"),
    "acetone": (1.33, f"{_ALTENA}, taken at half"),
}


def interaction(polymer: str, liquid: str) -> tuple[float, str] | None:
    """Chi of a polymer with a liquid, by the liquid's molar volume, and its source; None where it is not known.

    Examples
    --------
    >>> interaction("PEO", "water")[0], interaction("PVP", "toluene")
    (0.45, None)
    """
    name = known_as(polymer, POLYMERS) or polymer
    other = known_as(liquid, SOLVENTS) or liquid
    found = _POLYMER.get((name, other))
    if found is None and other == "water" and name in _UPTAKE:
        mass, source = _UPTAKE[name]
        return float(chi_from_uptake(mass, POLYMERS[name].density)), source
    return found


def water_interaction(solvent: str) -> tuple[float, str] | None:
    """Chi of water with a solvent, by water's molar volume, and its source; None where it is not known."""
    return _WATER.get(known_as(solvent, SOLVENTS) or solvent)


def chi_from_uptake(mass_of_water: ArrayLike, polymer_density: ArrayLike, water_density: float = 997.0) -> FloatArray:
    """Chi from the water that a polymer holds in saturated air (mass over mass), activity 1."""
    w = real("mass_of_water", mass_of_water, above=0.0, most=100.0)
    rho = real("polymer_density", polymer_density, above=0.0, unit="kg/m3")
    ratio = w * rho / water_density
    phi = ratio / (1 + ratio)
    value: FloatArray = -(np.log(phi) + 1 - phi) / (1 - phi) ** 2
    return value
