"""What the solution is, and what it becomes along the jet.

=======================  =========================================================================
module                   law
=======================  =========================================================================
`fractions`              by mass, by volume, by number, and back
`solution`               a solution: fractions, properties, whether it is a network
`materials`              built-in polymers, glass of a solution (Fox)
`names`                  other names of polymers and solvents
`intrinsic`              intrinsic viscosities: Mark and Houwink
`prior`                  viscosity and relaxation time nobody has measured, with bands
`solvents`               built-in solvents and their mixtures
`entanglement`           overlap, entanglement, strands and mesh
`concentration_laws`     Eq. (45): viscosity, relaxation time and modulus against concentration
`vapour`                 vapour pressures, diffusion in air, activities, where drying ends
`volatile`               a solvent on its way into the air; conventions of Eq. (44)
`thermal`                heats, vapour pressures at any temperature, the air's conductivity
`transfer`               Sherwood and Nusselt numbers
`evaporant`              a liquid with its heat, against temperature
`heat`                   a drying jet that cools and takes up water
`wet_bulb`               where a wet jet's temperature settles
`element_path`           what a material element of a straight or bead jet goes through
`evaporation`            Eqs. (43a), (44): loss of solvent along the jet
`conformation`           stretch and stress of the polymer: Maxwell, Oldroyd-B, Giesekus, FENE-P
`diffusion_laws`         solvent in polymer: constant, exponential, free volume
`drying`                 radial drying, skin and glass of a stretching, shrinking jet
`cylinder`               the analytic series that checks it
=======================  =========================================================================
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

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
from spinline.rheology.entanglement import Entanglement, entanglement_fraction, overlap_fraction
from spinline.rheology.fractions import mass_fraction, mass_fraction_from_molar, molar_fraction, volume_fraction
from spinline.rheology.materials import (
    POLYMERS,
    Polymer,
    packing_entanglement_molar_mass,
    polymer,
    polymer_property,
    property_source,
    vitrification_fraction,
)
from spinline.rheology.solution import Solution
from spinline.rheology.solvents import (
    SOLVENTS,
    mixture_density,
    mixture_surface_tension,
    mixture_viscosity,
    solvent_density,
    solvent_glass_transition,
    solvent_molar_mass,
    solvent_surface_tension,
    solvent_viscosity,
)
from spinline.rheology.vapour import equilibrium_fraction, solvent_activity, vapour_diffusivity, vapour_pressure

if TYPE_CHECKING:
    from spinline.rheology.conformation import (
        FENEP,
        ElementConformation,
        Giesekus,
        Maxwell,
        OldroydB,
        maxwell_startup,
        steady_fenep,
        tensile_force,
    )
    from spinline.rheology.cylinder import cylinder_series
    from spinline.rheology.diffusion_laws import ConstantDiffusion, ExponentialDiffusion, FreeVolumeDiffusion
    from spinline.rheology.drying import RadialDrying, dry_radially, drying_peclet
    from spinline.rheology.element_path import ElementPath, bead_path, straight_path
    from spinline.rheology.evaporant import Evaporant
    from spinline.rheology.evaporation import Evaporation, evaporate, power_law_loss, sherwood
    from spinline.rheology.heat import HeatedJet, dry_with_heat
    from spinline.rheology.intrinsic import Intrinsic, intrinsic_viscosity, mixture_intrinsic_viscosity
    from spinline.rheology.prior import Estimate, estimated_relaxation_time, estimated_viscosity, specific_viscosity
    from spinline.rheology.transfer import transfer_number
    from spinline.rheology.volatile import Volatile
    from spinline.rheology.wet_bulb import WetBulb, adiabatic_saturation, wet_bulb

# name: module; loaded when first asked for, since the solvers are heavier than the closed forms
_NAMES = {
    "ConstantDiffusion": "diffusion_laws",
    "ElementConformation": "conformation",
    "Estimate": "prior",
    "Evaporant": "evaporant",
    "HeatedJet": "heat",
    "WetBulb": "wet_bulb",
    "adiabatic_saturation": "wet_bulb",
    "dry_with_heat": "heat",
    "transfer_number": "transfer",
    "wet_bulb": "wet_bulb",
    "Intrinsic": "intrinsic",
    "estimated_relaxation_time": "prior",
    "estimated_viscosity": "prior",
    "intrinsic_viscosity": "intrinsic",
    "mixture_intrinsic_viscosity": "intrinsic",
    "specific_viscosity": "prior",
    "ElementPath": "element_path",
    "Evaporation": "evaporation",
    "ExponentialDiffusion": "diffusion_laws",
    "FENEP": "conformation",
    "FreeVolumeDiffusion": "diffusion_laws",
    "Giesekus": "conformation",
    "Maxwell": "conformation",
    "OldroydB": "conformation",
    "RadialDrying": "drying",
    "Volatile": "volatile",
    "bead_path": "element_path",
    "cylinder_series": "cylinder",
    "dry_radially": "drying",
    "drying_peclet": "drying",
    "evaporate": "evaporation",
    "maxwell_startup": "conformation",
    "power_law_loss": "evaporation",
    "sherwood": "evaporation",
    "steady_fenep": "conformation",
    "straight_path": "element_path",
    "tensile_force": "conformation",
}

__all__ = [
    "FENEP",
    "POLYMERS",
    "SOLVENTS",
    "ConstantDiffusion",
    "ElementConformation",
    "ElementPath",
    "Entanglement",
    "Estimate",
    "Evaporant",
    "Evaporation",
    "ExponentialDiffusion",
    "FreeVolumeDiffusion",
    "Giesekus",
    "HeatedJet",
    "Intrinsic",
    "Maxwell",
    "OldroydB",
    "Polymer",
    "RadialDrying",
    "ScalingExponents",
    "Solution",
    "Volatile",
    "WetBulb",
    "adiabatic_saturation",
    "bead_path",
    "cylinder_series",
    "dry_radially",
    "dry_with_heat",
    "drying_peclet",
    "entanglement_fraction",
    "equilibrium_fraction",
    "estimated_relaxation_time",
    "estimated_viscosity",
    "evaporate",
    "intrinsic_viscosity",
    "martin_viscosity",
    "mass_fraction",
    "mass_fraction_from_molar",
    "maxwell_startup",
    "mixture_density",
    "mixture_intrinsic_viscosity",
    "mixture_surface_tension",
    "mixture_viscosity",
    "modulus",
    "molar_fraction",
    "overlap_fraction",
    "packing_entanglement_molar_mass",
    "polymer",
    "polymer_property",
    "power_law_loss",
    "property_source",
    "relaxation_time",
    "scaled",
    "scaled_viscosity",
    "scaling_exponents",
    "sherwood",
    "solvent_activity",
    "solvent_density",
    "solvent_glass_transition",
    "solvent_molar_mass",
    "solvent_surface_tension",
    "solvent_viscosity",
    "specific_viscosity",
    "steady_fenep",
    "straight_path",
    "tensile_force",
    "transfer_number",
    "vapour_diffusivity",
    "vapour_pressure",
    "viscosity",
    "vitrification_fraction",
    "volume_fraction",
    "wet_bulb",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
