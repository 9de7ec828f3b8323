"""Intrinsic viscosity of a polymer in a solvent: Mark and Houwink's ``[eta] = K M^a``.

Constants of the handbook near 25 to 30 degC, for the ranges of molar mass in it; a factor of 1.3 between samples is
usual (tacticity, polydispersity, which average M is). What is not in the table is estimated from the chain: Flory and
Fox, ``[eta] = Phi <R^2>^(3/2)/M``, unperturbed, times the swelling in a good solvent of coils larger than a thermal blob:

    [eta]/[eta]_theta = (N/N_T)^(3 nu - 3/2)      N > N_T, the Kuhn segments in a blob

``N_T = 18`` has the table's polymers right in the mean. Single ones depart from it by 0.5 (standard deviation of the
logarithm: stiffness, associations), solvents of one polymer among themselves by 0.25. So a polymer that the table has in
k other solvents is taken at their departure times ``1/(1 + 0.25/k)``, within a factor of 2; one that it has in none, within
a factor of 3. (Tests foretell each row from the others, and hold these numbers to the table.)
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import positive
from spinline.base.errors import InputError
from spinline.rheology.materials import BOND_PROJECTION, Polymer, polymer, polymer_property
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS, mass_shares, volume_shares

__all__ = ["MARK_HOUWINK", "Intrinsic", "intrinsic_viscosity", "mixture_intrinsic_viscosity"]

_HANDBOOK = "Brandrup, Immergut, Grulke (eds.), Polymer Handbook, 4th ed. (1999), VII/1"
_QUOTED = f"{_HANDBOOK}, quoted from memory"
_SCHINDLER = "Schindler, Hibionada, Pitt, J. Polym. Sci. Polym. Chem. Ed. 20, 319 (1982), quoted from memory"
# (polymer, solvent): K in mL/g for M in g/mol, a, source
MARK_HOUWINK: Mapping[tuple[str, str], tuple[float, float, str]] = {
    ("PEO", "water"): (12.5e-3, 0.78, f"{_HANDBOOK}; Bailey, Callard, J. Appl. Polym. Sci. 1, 56 (1959), 30 degC"),
    ("PVP", "water"): (39.3e-3, 0.59, f"{_HANDBOOK}; 30 degC"),
    ("PVP", "methanol"): (23.0e-3, 0.65, f"{_QUOTED}; 30 degC"),
    ("PVP", "chloroform"): (19.4e-3, 0.64, f"{_QUOTED}; 25 degC"),
    ("PVA", "water"): (20e-3, 0.76, "Flory, Leutner, J. Polym. Sci. 3, 880 (1948), 25 degC"),
    ("PCL", "DMF"): (19.1e-3, 0.73, "Koleske, Lundberg, J. Polym. Sci. A-2 7, 795 (1969), 30 degC"),
    ("PCL", "chloroform"): (12.98e-3, 0.828, f"{_SCHINDLER}; 30 degC"),
    ("PCL", "THF"): (13.95e-3, 0.786, f"{_SCHINDLER}; 30 degC"),
    ("PAN", "DMF"): (24.3e-3, 0.75, "Cleland, Stockmayer, J. Polym. Sci. 17, 473 (1955), 25 degC"),
    ("PAN", "DMSO"): (32.1e-3, 0.75, f"{_QUOTED}; 20 degC"),
    ("PAN", "DMAc"): (30.7e-3, 0.761, f"{_QUOTED}; 20 degC"),
    ("PMMA", "acetone"): (7.5e-3, 0.70, f"{_HANDBOOK}; 25 degC"),
    ("PMMA", "chloroform"): (4.8e-3, 0.80, f"{_HANDBOOK}; 25 degC"),
    ("PMMA", "THF"): (7.56e-3, 0.731, "Chen, Li, Hadjichristidis, Mays, Polym. Bull. 30, 575 (1993), 30 degC"),
    ("PS", "toluene"): (7.5e-3, 0.75, f"{_HANDBOOK}; 25 degC"),
    ("PS", "chloroform"): (7.16e-3, 0.76, f"{_QUOTED}; 25 degC"),
    ("PS", "THF"): (11e-3, 0.725, f"{_HANDBOOK}; 25 degC"),
    ("PS", "DMF"): (31.8e-3, 0.603, f"{_HANDBOOK}; 25 degC"),
    ("PLA", "chloroform"): (
        34.7e-3,
        0.75,
        "between poly(L-lactide), 54.5e-3 and 0.73, Schindler, Harper, J. Polym. Sci. Polym. Chem. Ed. 17, 2593 (1979), and"
        " poly(D,L-lactide), 22.1e-3 and 0.77, quoted from memory; 30 degC",
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
_SWELLING = 3 * 0.588 - 1.5
_BLOB = 18.0  # N_T
_CHAINS, _SOLVENTS = 0.5, 0.25  # standard deviations of ln [eta] about it: of polymers, and of the solvents of one


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
    chain, words = _of_chain(known, molar_mass, solvent_quality, kuhn_length), "Flory and Fox from the chain"
    if solvent_quality == "theta":
        return Intrinsic(
            positive("intrinsic_viscosity", chain, "m3/kg"), 2.0, f"{words}, theta solvent: within a factor of 2"
        )
    others = [
        np.log(k * np.float64(grams) ** a * 1e-3 / chain)
        for (of, _), (k, a, _) in MARK_HOUWINK.items()
        if of == known.name
    ]
    weight = len(others) * _CHAINS**2 / (len(others) * _CHAINS**2 + _SOLVENTS**2)
    departure = weight * float(np.mean(others)) if others else 0.0
    factor = float(np.exp(2 * np.sqrt((1 - weight) * _CHAINS**2 + _SOLVENTS**2)))
    seen = f" and from {len(others)} other solvent{'s' * (len(others) > 1)}" * bool(others)
    value = positive("intrinsic_viscosity", chain * np.exp(departure), "m3/kg")
    return Intrinsic(value, factor, f"{words}{seen}, good solvent: within a factor of {factor:.2g}")


def mixture_intrinsic_viscosity(
    data: Polymer | str,
    solvent: Mapping[str, float],
    molar_mass: float,
    solvent_quality: str = "good",
    *,
    temperature: float = 298.15,
) -> Intrinsic:
    """``[eta]`` of a polymer in a mixture: its logarithm and the variance of that lie between the solvents' by volume.

    What two solvents do together to a chain that each dissolves badly, or well, is left out (cosolvency, one that the coil
    prefers).

    Parameters and errors are those of `intrinsic_viscosity`, but for

    Parameters
    ----------
    solvent : mapping
        Mass fractions by name, > 0 of sum 1; where one is not in the library, by mass instead.
    temperature : float
        K, of the densities.

    Examples
    --------
    >>> round(1e3 * mixture_intrinsic_viscosity("PVP", {"water": 0.5, "methanol": 0.5}, 360.0).value)  # mL/g; 75, 94 alone
    85
    """
    by_mass = mass_shares(solvent, "solvent")
    if len(solvent) == 1:
        return intrinsic_viscosity(data, next(iter(solvent)), molar_mass, solvent_quality)
    found = [intrinsic_viscosity(data, name, molar_mass, solvent_quality) for name in solvent]
    listed = all(known_as(name, SOLVENTS) for name in solvent)
    shares = np.array(list(volume_shares(solvent, temperature).values())) if listed else by_mass
    mean = float(np.exp(shares @ np.log([one.value for one in found])))
    factor = float(np.exp(np.sqrt(shares @ np.square(np.log([one.factor for one in found])))))
    by = "volume" if listed else "mass"
    return Intrinsic(mean, factor, f"between {' and '.join(solvent)} by {by}, within a factor of {factor:.2g}")


def _of_chain(data: Polymer, molar_mass: float, solvent_quality: str, kuhn_length: float | None) -> float:
    """Flory and Fox with the swelling of a usual good solvent, m3/kg."""
    unit = polymer_property(data, "repeat_unit_molar_mass")
    bonds = polymer_property(data, "backbone_bonds")
    b = polymer_property(data, "kuhn_length") if kuhn_length is None else positive("kuhn_length", kuhn_length, "m")
    per_mass = bonds * BOND_PROJECTION / unit / b  # segments
    swelling = max(molar_mass * per_mass / _BLOB, 1.0) ** _SWELLING if solvent_quality == "good" else 1.0
    return float(_FLORY_FOX * (per_mass * b * b) ** 1.5 * np.sqrt(molar_mass) * swelling)
