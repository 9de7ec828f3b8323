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
`chain`                Eq. (32a): every bead of the network, in time (`flow`, `Chain`, `run_chain`)
=====================  ==============================================================
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    from spinline.network.chain import ChainResult, run_chain
    from spinline.network.chain_coarse import coarse_graining_error
    from spinline.network.chain_model import Chain, ChainError
    from spinline.network.chain_profile import ChainProfile
    from spinline.network.chain_state import ChainState, affine_start, empty_start, start_from
    from spinline.network.flow import Flow

# name: module; compiled laws load when first asked for
_NAMES = {
    "Chain": "chain_model",
    "ChainError": "chain_model",
    "ChainProfile": "chain_profile",
    "ChainResult": "chain",
    "ChainState": "chain_state",
    "Flow": "flow",
    "affine_start": "chain_state",
    "coarse_graining_error": "chain_coarse",
    "empty_start": "chain_state",
    "run_chain": "chain",
    "start_from": "chain_state",
}

__all__ = [
    "AffineNetwork",
    "Chain",
    "ChainError",
    "ChainProfile",
    "ChainResult",
    "ChainState",
    "Conformation",
    "Flow",
    "Mesh",
    "affine_force",
    "affine_network",
    "affine_start",
    "affinity",
    "axial_force",
    "coarse_graining_error",
    "compaction_velocity_ratio",
    "conservative_radius_ratio",
    "crossover_velocity_ratio",
    "elastic_coupling",
    "empty_start",
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
    "run_chain",
    "saturate",
    "segment_time",
    "start_from",
    "strand_force",
    "stretched_walk",
]


def __getattr__(name: str) -> Any:
    if name in _NAMES:
        return getattr(import_module(f"spinline.network.{_NAMES[name]}"), name)
    raise AttributeError(f"module 'spinline.network' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
