"""What the flow does to the network: strands, concentration, crossover.

=====================  ==============================================================
module                 law
=====================  ==============================================================
`mesh`                 the network at rest (scaling laws)
`lattice_walk`         Eqs. (34)-(37): extension, contraction, orientation of a strand
`concentration`        Eqs. (39)-(40): network radius, polymer fraction in the core
`crossover`            Eq. (38): where the network is fully stretched
`coupling`             A, alpha_v: how well the network follows the flow
`state`                all of the above at once; the affine rung
`force_laws`           force-extension laws of a strand, and their inverses
`tension`              tension of the network for every force-extension law
`manifold`             Eqs. (32a), (33): the steady network at finite coupling
`radial`               Eq. (32b): lateral mesh across the jet
=====================  ==============================================================
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if __name__ != "spinline.network":
    raise ImportError("import spinline.network, not network")

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
from spinline.network.state import NetworkState, affine_network, network_state

if TYPE_CHECKING:
    from spinline.network.manifold import Manifold, eq33, steady_network
    from spinline.network.radial import RadialMesh, radial_mesh, solve_radial_mesh
    from spinline.network.tension import Tension

# name: module; loaded when first asked for, since the solvers are heavier than the closed forms
_NAMES = {
    "Manifold": "manifold",
    "RadialMesh": "radial",
    "Tension": "tension",
    "eq33": "manifold",
    "radial_mesh": "radial",
    "solve_radial_mesh": "radial",
    "steady_network": "manifold",
}

__all__ = [
    "Conformation",
    "Manifold",
    "Mesh",
    "NetworkState",
    "RadialMesh",
    "Tension",
    "affine_force",
    "affine_network",
    "affinity",
    "axial_force",
    "compaction_velocity_ratio",
    "conservative_radius_ratio",
    "crossover_velocity_ratio",
    "elastic_coupling",
    "eq33",
    "extension_velocity_ratio",
    "fraction_conservative",
    "fraction_eq40",
    "fraction_walk",
    "log_fraction_conservative",
    "log_fraction_eq40",
    "log_fraction_walk",
    "network_at_rest",
    "network_state",
    "orientation",
    "radial_mesh",
    "radius_ratio",
    "random_walk",
    "relative_contraction",
    "relative_extension",
    "rest_force",
    "saturate",
    "segment_time",
    "solve_radial_mesh",
    "steady_network",
    "strand_force",
    "stretched_walk",
]


def __getattr__(name: str) -> Any:
    if name in _NAMES:
        return getattr(import_module(f"spinline.network.{_NAMES[name]}"), name)
    raise AttributeError(f"module 'spinline.network' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
