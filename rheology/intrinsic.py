"""Intrinsic viscosity of a polymer in a solvent: Mark and Houwink's ``[eta] = K M^a``.

Constants of the handbook near 25 to 30 degC, for the ranges of molar mass in it; a factor of 1.3 between samples is
usual (tacticity, polydispersity, which average M is). What is not in the table is estimated from the chain: Flory and
Fox, ``[eta] = Phi <R^2>^(3/2)/M``, unperturbed, times the swelling ``N^(3 nu - 3/2)`` in a good solvent; a factor of 2
either way.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import positive
from spinline.base.errors import InputError
from spinline.rheology.materials import BOND_PROJECTION, Polymer, polymer, polymer_property
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS

__all__ = ["MARK_HOUWINK", "Intrinsic", "intrinsic_viscosity"]

_HANDBOOK = "Brandrup, Immergut, Grulke (eds.), Polymer Handbook, 4th ed. (1999), VII/1"
# (polymer, solvent): K in mL/g for M in g/mol, a, source
MARK_HOUWINK: Mapping[tuple[str, str], tuple[float, float, str]] = {
    ("PEO", "water"): (12.5e-3, 0.78, f"{_HANDBOOK}; Bailey, Callard, J. Appl. Polym. Sci. 1, 56 (1959), 30 degC"),
    ("PVP", "water"): (39.3e-3, 0.59, f"{_HANDBOOK}; 30 degC"),
    ("PVA", "water"): (20e-3, 0.76, "Flory, Leutner, J. Polym. Sci. 3, 880 (1948), 25 degC"),
    ("PCL", "DMF"): (19.1e-3, 0.73, "Koleske, Lundberg, J. Polym. Sci. A-2 7, 795 (1969), 30 degC"),
    ("PAN", "DMF"): (24.3e-3, 0.75, "Cleland, Stockmayer, J. Polym. Sci. 17, 473 (1955), 25 degC"),
    ("PMMA", "acetone"): (7.5e-3, 0.70, f"{_HANDBOOK}; 25 degC"),
    ("PMMA", "chloroform"): (4.8e-3, 0.80, f"{_HANDBOOK}; 25 degC"),
    ("PS", "toluene"): (7.5e-3, 0.75, f"{_HANDBOOK}; 25 degC"),
    ("PS", "THF"): (11e-3, 0.725, f"{_HANDBOOK}; 25 degC"),
    ("PS", "DMF"): (31.8e-3, 0.603, f"{_HANDBOOK}; 25 degC"),
    ("PLA", "chloroform"): (
        54.5e-3,
        0.73,
        "Schindler, Harper, J. Polym. Sci. Polym. Chem. Ed. 17, 2593 (1979), 30 degC",
    ),
    ("PET", "TFA"): (43.3e-3, 0.68, f"{_HANDBOOK}; 30 degC"),
    ("nylon 6", "formic acid"): (22.6e-3, 0.82, f"{_HANDBOOK}; 85 % acid, 25 degC"),
    ("cellulose acetate", "acetone"): (
        133e-3,
        0.616,
        "Suzuki, Miyazaki, Kamide, Eur. Polym. J. 16, 703 (1980), 25 degC",
    ),
    ("cellulose acetate", "DMAc"): (26.4e-3, 0.75, "Suzuki, Miyazaki, Kamide, Eur. Polym. J. 16, 703 (1980), 25 degC"),
}
_FLORY_FOX = 2.5e23  # 1/mol, of random coils in SI
_SWELLING = 0.588


@dataclass(frozen=True)
class Intrinsic:
    """An intrinsic viscosity: `value` in m3/kg, within a factor of `factor`, from `source`."""

    value: float
    factor: float
    source: str


def intrinsic_viscosity(
    data: Polymer | str,
    solvent: str,
    molar_mass: float,
    solvent_quality: str = "good",
    kuhn_length: float | None = None,
) -> Intrinsic:
    """``[eta]`` of a polymer in a solvent.

    Parameters
    ----------
    data : Polymer or str
        Data, or a built-in name.
    solvent : str
        Name; one without constants in the table is taken by the solvent's quality alone.
    molar_mass : float
        kg/mol, > 0.
    solvent_quality : {"good", "theta"}
        Where the table has no constants.
    kuhn_length : float, optional
        m, in place of the polymer's.

    Returns
    -------
    Intrinsic

    Raises
    ------
    InputError
        For values out of range, or a chain that is not known.

    Examples
    --------
    >>> round(1e3 * intrinsic_viscosity("PEO", "water", 600.0).value)  # mL/g
    402
    """
    known = data if isinstance(data, Polymer) else polymer(data)
    if not isinstance(solvent, str):
        raise InputError("solvent", "is not a name", value=solvent)
    if solvent_quality not in ("good", "theta"):
        raise InputError("solvent_quality", "is not known", value=solvent_quality, allowed='"good", "theta"')
    grams = 1e3 * positive("molar_mass", molar_mass, "kg/mol")
    row = MARK_HOUWINK.get((known.name, known_as(solvent, SOLVENTS) or solvent))
    if row is not None:
        k, a, source = row
        return Intrinsic(positive("intrinsic_viscosity", k * np.float64(grams) ** a * 1e-3, "m3/kg"), 1.3, source)
    unit = polymer_property(known, "repeat_unit_molar_mass")
    bonds = polymer_property(known, "backbone_bonds")
    b = polymer_property(known, "kuhn_length") if kuhn_length is None else positive("kuhn_length", kuhn_length, "m")
    segments = bonds * BOND_PROJECTION * molar_mass / unit / b
    swelling = segments ** (3 * _SWELLING - 1.5) if solvent_quality == "good" and segments > 1 else 1.0
    value = _FLORY_FOX * (segments * b * b) ** 1.5 / molar_mass * swelling
    words = f"Flory and Fox from the chain, {solvent_quality} solvent: within a factor of 2"
    return Intrinsic(positive("intrinsic_viscosity", value, "m3/kg"), 2.0, words)
