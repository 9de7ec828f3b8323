"""What the solution is: fractions, densities, built-in materials."""

if __name__ != "spinline.rheology":
    raise ImportError("import spinline.rheology, not rheology")

from spinline.rheology.materials import POLYMERS, SOLVENTS, Polymer, polymer, solvent_density, solvent_viscosity
from spinline.rheology.solution import Solution, mass_fraction, volume_fraction

__all__ = [
    "POLYMERS",
    "SOLVENTS",
    "Polymer",
    "Solution",
    "mass_fraction",
    "polymer",
    "solvent_density",
    "solvent_viscosity",
    "volume_fraction",
]
