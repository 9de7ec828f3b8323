"""What the flow does to the network: strands, concentration, crossover.

=====================  ==============================================================
module                 law
=====================  ==============================================================
`mesh`                 the network at rest (scaling laws)
`lattice_walk`         Eqs. (34)-(37): extension, contraction, orientation of a strand
`concentration`        Eqs. (39)-(40): network radius, polymer fraction in the core
`crossover`            Eq. (38): where the network is fully stretched
`coupling`             A, alpha_v: how well the network follows the flow
`affine`               the affine rung: all of the above at once
=====================  ==============================================================
"""

if __name__ != "spinline.network":
    raise ImportError("import spinline.network, not network")

from spinline.network.affine import AffineNetwork, affine_network
from spinline.network.concentration import (
    compaction_velocity_ratio,
    conservative_radius_ratio,
    fraction_conservative,
    fraction_eq40,
    fraction_walk,
    log_fraction_conservative,
    log_fraction_eq40,
    log_fraction_walk,
    saturate,
)
from spinline.network.coupling import affinity, elastic_coupling, segment_time, strand_force
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio, radius_ratio
from spinline.network.lattice_walk import (
    Conformation,
    affine_force,
    axial_force,
    orientation,
    random_walk,
    relative_contraction,
    relative_extension,
    stretched_walk,
)
from spinline.network.mesh import Mesh, network_at_rest, rest_force

__all__ = [
    "AffineNetwork",
    "Conformation",
    "Mesh",
    "affine_force",
    "affine_network",
    "affinity",
    "axial_force",
    "compaction_velocity_ratio",
    "conservative_radius_ratio",
    "crossover_velocity_ratio",
    "elastic_coupling",
    "extension_velocity_ratio",
    "fraction_conservative",
    "fraction_eq40",
    "fraction_walk",
    "log_fraction_conservative",
    "log_fraction_eq40",
    "log_fraction_walk",
    "network_at_rest",
    "orientation",
    "radius_ratio",
    "random_walk",
    "relative_contraction",
    "relative_extension",
    "rest_force",
    "saturate",
    "segment_time",
    "strand_force",
    "stretched_walk",
]
