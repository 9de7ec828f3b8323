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
`walk_strand`          forces on the segments of a strand, uniform or not, Eq. (35a)
`walk_flow`            those forces self-consistent with the flow across the strand
`walk_exact`           exact moments of the random walk
`walk_law`             exact law of the end-to-end vector
`walk`                 Monte Carlo: the rung ``walk``
`walk_estimate`        estimates with their errors; control variates
`tension`              tension of the network for every force-extension law
`manifold`             Eqs. (32a), (33): the steady network at finite coupling
`two_fluid`            the same with strands that relax: the rung ``two-fluid``
`disentanglement`      entanglements that let go: Rolie-Poly and the fraction left
`far_end`              how much of the network's far end is felt upstream
`flow`                 V(s, t) as the chain sees it
`chain`                Eq. (32a) in full: every bead, in time (`chain_model`, `chain_state`, `chain_step`, ...)
`radial`               Eq. (32b): lateral mesh across the jet
`lateral`              the same in a jet that moves: network radius and concentration across it
=====================  ==============================================================

What compiles with numba or needs scipy (from `force_laws` on) loads when first asked for.
"""

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if __name__ != "spinline.network":
    raise ImportError("import spinline.network, not network")

from spinline.network.concentration import (
    compaction_velocity_ratio,
    conservative_radius_ratio,
    flux_fraction,
    flux_radius_ratio,
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
from spinline.network.state import NetworkState, affine_network, dried_state, network_state

if TYPE_CHECKING:
    from spinline.network import force_laws
    from spinline.network.chain.coarse import coarse_graining_error
    from spinline.network.chain.flow import Flow
    from spinline.network.chain.march import ChainResult, run_chain
    from spinline.network.chain.model import Chain, ChainError
    from spinline.network.chain.profile import ChainProfile
    from spinline.network.chain.state import ChainState, affine_start, empty_start, start_from
    from spinline.network.disentanglement import Disentangled, disentangle, rouse_time, strand_fraction
    from spinline.network.lateral import LateralNetwork, lateral_limit, lateral_network, lateral_time
    from spinline.network.manifold import Manifold, eq33, steady_network
    from spinline.network.radial import RadialMesh, radial_mesh, solve_radial_mesh
    from spinline.network.tension import Tension
    from spinline.network.two_fluid import TwoFluid, two_fluid_network
    from spinline.network.walk.estimate import (
        Average,
        Histogram,
        SampleMoments,
        sample_average,
        sample_histogram,
        sample_moments,
    )
    from spinline.network.walk.exact import WalkMoments, walk_moments
    from spinline.network.walk.flow import FlowStrand, flow_strand
    from spinline.network.walk.law import ExactLaw, exact_law
    from spinline.network.walk.sample import StrandSample, sample_paths, sample_strands
    from spinline.network.walk.strand import Strand, affine_strand, hydrodynamic_strand, uniform_strand, varying_strand

# name: module; loaded when first asked for, since the solvers are heavier than the closed forms
_NAMES = {
    "Average": "walk.estimate",
    "Chain": "chain.model",
    "ChainError": "chain.model",
    "ChainProfile": "chain.profile",
    "ChainResult": "chain.march",
    "ChainState": "chain.state",
    "Disentangled": "disentanglement",
    "ExactLaw": "walk.law",
    "Flow": "chain.flow",
    "FlowStrand": "walk.flow",
    "Histogram": "walk.estimate",
    "LateralNetwork": "lateral",
    "Manifold": "manifold",
    "RadialMesh": "radial",
    "SampleMoments": "walk.estimate",
    "Strand": "walk.strand",
    "StrandSample": "walk.sample",
    "Tension": "tension",
    "TwoFluid": "two_fluid",
    "WalkMoments": "walk.exact",
    "affine_start": "chain.state",
    "affine_strand": "walk.strand",
    "coarse_graining_error": "chain.coarse",
    "disentangle": "disentanglement",
    "empty_start": "chain.state",
    "eq33": "manifold",
    "exact_law": "walk.law",
    "flow_strand": "walk.flow",
    "force_laws": "force_laws:",
    "hydrodynamic_strand": "walk.strand",
    "lateral_limit": "lateral",
    "lateral_network": "lateral",
    "lateral_time": "lateral",
    "radial_mesh": "radial",
    "rouse_time": "disentanglement",
    "run_chain": "chain.march",
    "sample_average": "walk.estimate",
    "sample_histogram": "walk.estimate",
    "sample_moments": "walk.estimate",
    "sample_paths": "walk.sample",
    "sample_strands": "walk.sample",
    "solve_radial_mesh": "radial",
    "start_from": "chain.state",
    "steady_network": "manifold",
    "strand_fraction": "disentanglement",
    "two_fluid_network": "two_fluid",
    "uniform_strand": "walk.strand",
    "varying_strand": "walk.strand",
    "walk_moments": "walk.exact",
}

__all__ = [
    "Average",
    "Chain",
    "ChainError",
    "ChainProfile",
    "ChainResult",
    "ChainState",
    "Conformation",
    "Disentangled",
    "ExactLaw",
    "Flow",
    "FlowStrand",
    "Histogram",
    "LateralNetwork",
    "Manifold",
    "Mesh",
    "NetworkState",
    "RadialMesh",
    "SampleMoments",
    "Strand",
    "StrandSample",
    "Tension",
    "TwoFluid",
    "WalkMoments",
    "affine_force",
    "affine_network",
    "affine_start",
    "affine_strand",
    "affinity",
    "axial_force",
    "coarse_graining_error",
    "compaction_velocity_ratio",
    "conservative_radius_ratio",
    "crossover_velocity_ratio",
    "disentangle",
    "dried_state",
    "elastic_coupling",
    "empty_start",
    "eq33",
    "exact_law",
    "extension_velocity_ratio",
    "flow_strand",
    "flux_fraction",
    "flux_radius_ratio",
    "force_laws",
    "fraction_conservative",
    "fraction_eq40",
    "fraction_walk",
    "hydrodynamic_strand",
    "lateral_limit",
    "lateral_network",
    "lateral_time",
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
    "rouse_time",
    "run_chain",
    "sample_average",
    "sample_histogram",
    "sample_moments",
    "sample_paths",
    "sample_strands",
    "saturate",
    "segment_time",
    "solve_radial_mesh",
    "start_from",
    "steady_network",
    "strand_force",
    "strand_fraction",
    "stretched_walk",
    "two_fluid_network",
    "uniform_strand",
    "varying_strand",
    "walk_moments",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
