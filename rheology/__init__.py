"""What the solution is, and what it becomes along the jet.

=======================  =========================================================================
module                   law
=======================  =========================================================================
`solution`               fractions, densities, strands per chain
`materials`              built-in polymers and solvents
`concentration_laws`     Eq. (45): viscosity, relaxation time and modulus against concentration
=======================  =========================================================================
"""

if __name__ != "spinline.rheology":
    raise ImportError("import spinline.rheology, not rheology")

from spinline.rheology.concentration_laws import (
    ScalingExponents,
    martin_viscosity,
    modulus,
    relaxation_time,
    scaled,
    scaled_viscosity,
    scaling_exponents,
    viscosity,
)
from spinline.rheology.materials import POLYMERS, SOLVENTS, Polymer, polymer, solvent_density, solvent_viscosity
from spinline.rheology.solution import Solution, mass_fraction, volume_fraction

__all__ = [
    "POLYMERS",
    "SOLVENTS",
    "Polymer",
    "ScalingExponents",
    "Solution",
    "martin_viscosity",
    "mass_fraction",
    "modulus",
    "polymer",
    "relaxation_time",
    "scaled",
    "scaled_viscosity",
    "scaling_exponents",
    "solvent_density",
    "solvent_viscosity",
    "viscosity",
    "volume_fraction",
]
