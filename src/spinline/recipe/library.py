"""What is usual where a recipe does not say: molar mass, conductivity, current, humidity, each with its spread and its source.

Every entry is a prior: a median and the standard deviation of the logarithm. Anything that is given replaces it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["CONDUCTIVITY", "MOLAR_MASS", "Prior", "conductivity", "molar_mass"]

_GRADES = "grades usual in published spinning; suppliers' catalogues"


@dataclass(frozen=True)
class Prior:
    """What is believed of a quantity that nobody gave: `median` in SI, `sd` of its logarithm, and where from."""

    median: float
    sd: float
    source: str


# kg/mol, weight average
#: What is usual of a polymer, kg/mol.
MOLAR_MASS: Mapping[str, Prior] = {
    "PEO": Prior(600.0, 1.0, _GRADES),
    "PMMA": Prior(350.0, 1.0, _GRADES),
    "PCL": Prior(80.0, 0.45, _GRADES),
    "PVP": Prior(1300.0, 0.75, _GRADES),
    "PAN": Prior(150.0, 0.6, _GRADES),
    "PS": Prior(280.0, 0.75, _GRADES),
    "PVA": Prior(100.0, 0.75, _GRADES),
    "PLA": Prior(150.0, 0.75, _GRADES),
    "PVDF": Prior(350.0, 0.75, _GRADES),
    "nylon 6": Prior(30.0, 0.75, _GRADES),
    "PET": Prior(50.0, 0.75, _GRADES),
    "cellulose acetate": Prior(50.0, 0.6, _GRADES),
    "PVB": Prior(100.0, 0.75, _GRADES),
    "gelatin": Prior(60.0, 0.75, _GRADES),
}
_ANY = Prior(150.0, 0.9, "no entry for this polymer: a usual chain")

_SALTS = "usual for polymer solutions in it; traces of salts decide, an estimate"
# S/m, of the solution
#: What is usual of a solution in a solvent, S/m.
CONDUCTIVITY: Mapping[str, Prior] = {
    "water": Prior(3e-2, 1.0, _SALTS),
    "ethanol": Prior(1e-3, 1.0, _SALTS),
    "acetone": Prior(5e-4, 1.0, _SALTS),
    "DMF": Prior(1.5e-3, 0.9, _SALTS),
    "DMAc": Prior(1e-3, 0.9, _SALTS),
    "DMSO": Prior(5e-4, 1.0, _SALTS),
    "DCM": Prior(1e-5, 1.3, _SALTS),
    "chloroform": Prior(1e-5, 1.3, _SALTS),
    "THF": Prior(2e-5, 1.3, _SALTS),
    "formic acid": Prior(0.1, 1.0, _SALTS),
    "HFIP": Prior(1e-3, 1.0, _SALTS),
    "acetic acid": Prior(5e-3, 1.0, _SALTS),
    "TFA": Prior(1e-2, 1.0, _SALTS),
    "NMP": Prior(1e-3, 1.0, _SALTS),
    "toluene": Prior(1e-7, 1.5, _SALTS),
    "methanol": Prior(2e-3, 1.0, _SALTS),
    "isopropanol": Prior(3e-4, 1.0, _SALTS),
    "ethyl acetate": Prior(1e-5, 1.3, _SALTS),
    "DCE": Prior(2e-5, 1.3, _SALTS),
    "MEK": Prior(1e-4, 1.3, _SALTS),
    "acetonitrile": Prior(1e-3, 1.0, _SALTS),
    "dioxane": Prior(1e-7, 1.5, _SALTS),
    "chlorobenzene": Prior(1e-6, 1.5, _SALTS),
    "TFE": Prior(1e-3, 1.0, _SALTS),
}
_ANY_CONDUCTIVITY = Prior(1e-3, 1.5, "no entry for this solvent")


def molar_mass(polymer: str) -> Prior:
    """Molar mass of a polymer, kg/mol."""
    return MOLAR_MASS.get(polymer, _ANY)


def conductivity(solvent: Mapping[str, float]) -> Prior:
    """Conductivity of a solution in a solvent (mass fractions by name), S/m: logarithms and variances mixed by mass."""
    import math

    priors = [(share, CONDUCTIVITY.get(name, _ANY_CONDUCTIVITY)) for name, share in solvent.items()]
    median = math.exp(sum(share * math.log(prior.median) for share, prior in priors))
    sd = math.sqrt(sum(share * prior.sd**2 for share, prior in priors))
    return Prior(median, sd, "; ".join(sorted({prior.source for _, prior in priors})))
