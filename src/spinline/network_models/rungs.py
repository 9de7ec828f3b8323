"""The rungs of the ladder along a scene's jet: what moves the network, and what that makes of it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.straight import StraightJet
from spinline.network.coupling import BOLTZMANN, strand_force
from spinline.network.mesh import network_at_rest
from spinline.network.state import dried_state, network_state
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene
from spinline.setup.build import coupling, jet_length

if TYPE_CHECKING:
    from spinline.network.chain.profile import ChainProfile
    from spinline.network.manifold import Manifold
    from spinline.solve.effects_along import Extra

__all__ = [
    "BOND_STRENGTH",
    "Crossover",
    "SettledChain",
    "lateral_fields",
    "network_fields",
    "network_stretch",
    "settled_chain",
    "slip_fields",
    "slipping_crossover",
    "steady_state",
    "walk_fields",
]

BOND_STRENGTH = 5e-9  # N, covalent bond
_FRONT_RTOL = 0.03
_MOST_BEADS = 3000  # of a chain that is free to join strands


@dataclass(frozen=True)
class Crossover:
    """Where the network is fully stretched.

    Attributes
    ----------
    velocity_ratio : float
        V of the criterion.
    position, radius : float
        m; NaN where the jet does not reach it. Along a bead jet the position is the arc length.
    radius_ratio : float
        r / r_0; NaN likewise.
    predicted : float
        Position if the profile went on beyond the jet's length; NaN where it cannot be said.
    words : str
        Why it is not reached, where the profile alone does not say.
    """

    velocity_ratio: float
    position: float
    radius: float
    radius_ratio: float
    predicted: float
    words: str = ""


def steady_state(scene: Scene, solution: Solution, jet: StraightJet) -> "Manifold":
    """Steady network of a scene at its finite coupling (rung ``manifold``)."""
    from spinline.network.manifold import steady_network
    from spinline.network.tension import Tension

    n, r0 = scene.network, jet.initial_radius
    alpha, _, _ = coupling(scene, solution, jet)
    full = float(network_at_rest(solution.volume_fraction, n.solvent_quality).full_stretch)
    length = jet_length(scene, jet) - jet.start
    return steady_network(
        lambda s: jet.velocity_ratio(np.minimum(jet.start + s * r0, jet.end)),
        length / r0,
        coupling=alpha,
        spring=n.spring.value,
        inertia=n.inertia.value,
        law=Tension.of(n.force_law, full),
        breaks=jet.kinks(),
        rtol=min(1e-8, 1e-3 * scene.accuracy.rtol),
    )


@dataclass(frozen=True, eq=False)
class SettledChain:
    """A bead chain followed in time until it is steady, with what a `Manifold` offers.

    Attributes
    ----------
    profile : ChainProfile
        Strands at the end of the run.
    length, inertia : float
        Far end in initial radii, and I.
    locked_from : float
        First place beyond 0.95 of the contour, initial radii; NaN if none.
    coarse_grain : float
        Strands joined into one.
    drift : float
        Largest relative change of w over the last tenth of the run: 0 when settled.
    """

    profile: "ChainProfile"
    length: float
    inertia: float
    locked_from: float
    coarse_grain: float
    drift: float

    def stretch(self, s: FloatArray) -> FloatArray:
        """Stretch w at s, held at the outermost beads."""
        beads = self.profile.beads
        return self.profile.stretch_at(np.clip(s, beads[0], beads[-1]))

    def tension(self, s: FloatArray) -> FloatArray:
        """Tension T at s, linear between the middles of the strands."""
        return np.interp(s, self.profile.position, self.profile.tension)

    def first_passage(self, stretch: float) -> float:
        """First s where w passes a value, linear between the middles of the strands; NaN where it never does."""
        above = np.flatnonzero(self.profile.stretch >= stretch)
        if not above.size:
            return float("nan")
        k = max(int(above[0]), 1)
        return float(np.interp(stretch, self.profile.stretch[k - 1 : k + 1], self.profile.position[k - 1 : k + 1]))


def settled_chain(scene: Scene, solution: Solution, jet: StraightJet) -> SettledChain:
    """Bead chain of a scene followed until it is steady: two or three residence times (rung ``chain``).

    Raises
    ------
    InputError
        Where the chain cannot be followed in time.
    """
    from spinline.network.chain.flow import Flow
    from spinline.network.chain.march import run_chain
    from spinline.network.chain.model import Chain, ChainError
    from spinline.network.chain.profile import profile as chain_profile

    n, r0 = scene.network, jet.initial_radius
    alpha, _, _ = coupling(scene, solution, jet)
    rest = network_at_rest(solution.volume_fraction, n.solvent_quality)
    length = jet_length(scene, jet) / r0
    transit = float(jet.residence_time(jet_length(scene, jet))) * jet.initial_velocity / r0
    spacing = float(rest.size) * solution.kuhn_length / r0
    if spacing > 1:
        raise InputError(
            "network.model", f"has no chain: a mesh of {spacing * r0:.3g} m is wider than the jet's radius", value="chain",
            allowed=f"a radius above {spacing * r0:.3g} m", remedy='raise the fraction, or take model = "affine"',
        )  # fmt: skip
    joined = max(1.0, transit / spacing / _MOST_BEADS) if n.coarse_grain is None else n.coarse_grain.value
    chain = Chain(
        flow=Flow.from_jet(jet, length),
        spacing=spacing,
        coupling=alpha,
        spring=n.spring.value,
        inertia=n.inertia.value,
        law=n.force_law,
        contour=float(rest.full_stretch),
        coarse_grain=joined,
    )
    # strands cannot start beyond their contour: there the chain fills the jet from the nozzle
    over = n.force_law != "linear" and float(jet.velocity_ratio(jet_length(scene, jet))) > 0.9 * float(
        rest.full_stretch
    )
    start, duration = ("empty", 4 * transit) if over else ("affine", 2 * transit)
    # a front of locking passes bead by bead: resolving it in time costs much and the settled state does not need it
    rtol = _FRONT_RTOL if over else float(np.clip(0.1 * scene.accuracy.rtol, 1e-8, 1e-3))
    try:
        run = run_chain(
            chain, duration, start=start, rtol=rtol, output_times=[0.9 * duration], most_steps=scene.accuracy.steps
        )
    except ChainError as error:
        raise InputError(
            "network.model", f"the chain cannot be followed ({error})", value="chain",
            remedy="raise accuracy.steps or accuracy.rtol, or join more strands (network.coarse_grain)",
        ) from None  # fmt: skip
    profile = run.profile
    if not profile.position.size:
        raise InputError(
            "network.model", f"leaves no strand in the jet: {joined:.3g} joined into one are longer than it", value="chain",
            remedy="join fewer (network.coarse_grain), or take a longer jet",
        )  # fmt: skip
    inner = np.linspace(0.02, 0.9, 200) * length
    earlier = chain_profile(chain, run.snapshots[0]).stretch_at(inner)
    bound = np.inf if n.force_law == "linear" else 0.95 * float(rest.full_stretch)
    locked = np.flatnonzero(profile.stretch >= bound)
    return SettledChain(
        profile=profile,
        length=length,
        inertia=n.inertia.value,
        locked_from=float(profile.position[locked[0]]) if locked.size else float("nan"),
        coarse_grain=joined,
        drift=_drift(profile.stretch_at(inner), earlier),
    )


def _drift(now: FloatArray, earlier: FloatArray) -> float:
    """Largest relative change where both are known; infinite where nothing is."""
    change = np.abs(now / earlier - 1)
    known = np.isfinite(change)
    return float(change[known].max()) if known.any() else float("inf")


def slipping_crossover(network: "Manifold | SettledChain", jet: StraightJet, target: float) -> Crossover:
    """First place where the network's own stretch passes a value."""
    nan = float("nan")
    s = network.first_passage(target)
    if np.isnan(s):
        return Crossover(nan, nan, nan, nan, nan)
    place = min(jet.start + s * jet.initial_radius, jet.end)
    radius = float(jet.radius(place))
    return Crossover(float(jet.velocity_ratio(place)), place, radius, radius / jet.initial_radius, place)


def slip_fields(
    fields: dict[str, FloatArray],
    network: "Manifold | SettledChain",
    scene: Scene,
    solution: Solution,
    jet: StraightJet,
) -> dict[str, Any]:
    """What slips and pulls where the network does not move with the solution."""
    s = np.minimum((fields["z"] - jet.start) / jet.initial_radius, network.length)
    alpha, _, _ = coupling(scene, solution, jet)
    slip = fields["velocity_ratio"] - fields["network_velocity_ratio"]
    full = float(network_at_rest(solution.volume_fraction, scene.network.solvent_quality).full_stretch)
    pull = scene.network.spring.value / full * network.tension(s)  # c = 3 is the Gaussian strand, f_0 = 3 / V_S
    force = strand_force(pull, solution.kuhn_length, solution.temperature)
    return {
        "slip_velocity": slip * jet.initial_velocity,
        "drag_force": alpha * BOLTZMANN * solution.temperature / jet.initial_radius * slip,
        "strand_force": force,
        "scission": force > BOND_STRENGTH,
    }


def lateral_fields(
    fields: dict[str, FloatArray], scene: Scene, solution: Solution, jet: StraightJet
) -> dict[str, FloatArray]:
    """Network across the jet, Eq. (32b) in motion: its radius, and the polymer fraction of its layers.

    Raises
    ------
    InputError
        Where alpha_v is not known.
    """
    from spinline.network.lateral import lateral_network

    alpha, _, words = coupling(scene, solution, jet)
    if np.isnan(alpha):
        raise InputError("network.lateral", f"needs alpha_v, which is {words}", remedy="give network.coupling")
    pace = scene.network.spring.value / alpha * jet.initial_velocity / jet.initial_radius
    contraction = fields["radial_contraction"]
    across = lateral_network(
        pace * fields["residence_time"],
        fields["velocity_ratio"],
        contraction / contraction[0],
        solution.volume_fraction,
        network_velocity_ratio=fields["network_velocity_ratio"],
        rtol=max(1e-5, min(1e-3, 0.1 * scene.accuracy.rtol)),
    )
    return {
        "layer": 0.5 * (across.layer_edges[1:] + across.layer_edges[:-1]),
        "lateral_network_radius": across.radius_ratio * fields["radius"],
        "lateral_polymer_fraction": across.polymer_fraction,
    }


def walk_fields(fields: dict[str, FloatArray], scene: Scene, solution: Solution) -> dict[str, FloatArray]:
    """Sampled conformation with its standard errors, strand by strand (rung ``walk``)."""
    from spinline.network.walk.estimate import sample_moments
    from spinline.network.walk.sample import sample_strands
    from spinline.network.walk.strand import affine_strand

    phi, quality, count = solution.volume_fraction, scene.network.solvent_quality, scene.accuracy.strands
    rest = network_at_rest(phi, quality)
    stretch = fields["stretch_ratio"]
    names = ("axial_stretch", "radial_contraction", "orientation")
    sampled = {name: np.full(stretch.shape, np.nan) for base in names for name in (base, f"{base}_std_error")}
    for number, place in enumerate(np.argwhere(np.isfinite(stretch))):
        at = tuple(place)
        strand = affine_strand(float(stretch[at]), phi, solvent_quality=quality)
        # every place has strands of its own: neighbouring places do not share their noise
        moments = sample_moments(sample_strands(strand, count, scene.accuracy.seed, first=number * count))
        size = strand.segments / float(rest.segments) * float(rest.size)  # N_s is a whole number
        sampled["axial_stretch"][at] = moments.mean[2] / size
        sampled["axial_stretch_std_error"][at] = moments.mean_error[2] / size
        sampled["radial_contraction"][at] = 0.5 * (moments.mean[0] + moments.mean[1]) / size
        sampled["radial_contraction_std_error"][at] = np.hypot(moments.mean_error[0], moments.mean_error[1]) / (
            2 * size
        )
        sampled["orientation"][at] = moments.orientation
        sampled["orientation_std_error"][at] = moments.orientation_error
    sampled["relative_extension"] = sampled["axial_stretch"] / float(rest.full_stretch)
    return sampled


def network_fields(
    profile: dict[str, FloatArray],
    scene: Scene,
    solution: Solution,
    network: "Manifold | SettledChain | None",
    extra: "Extra | None" = None,
) -> dict[str, FloatArray]:
    """Network variables wherever the stretch is known, NaN (or False) elsewhere.

    Where the jet loses volume, the strands are those of the solution at the nozzle and every fraction is over what is left.
    What relaxes moves with the solution: the network then slips by what the closure says of its own stretch.
    """
    stretch = profile["stretch_ratio"]
    known = np.isfinite(stretch)
    moved = flow = stretch[known]
    if network is not None:
        moved = network_stretch(profile, network)
    left: FloatArray | float = 1.0
    if extra is not None:
        moved, left = extra.stretch[known], extra.remaining[known]
        flow = moved if network is None else flow
    net = network_state(
        moved,
        flow,
        solution.volume_fraction,
        closure=scene.network.closure_used,
        solvent_quality=scene.network.solvent_quality,
    )
    if extra is not None and extra.dries:
        net = dried_state(net, flow, solution.volume_fraction, left, scene.network.solvent_quality)
    radius = profile["radius"][known]
    walk = net.conformation
    flat: dict[str, Any] = {
        "mean_polymer_fraction": net.mean_polymer_fraction,
        "network_velocity_ratio": net.network_velocity_ratio,
        "axial_stretch": walk.axial_stretch,
        "relative_extension": walk.relative_extension,
        "radial_contraction": walk.radial_contraction,
        "orientation": walk.orientation,
        "network_radius": radius * net.network_radius_ratio,
        "network_radius_conservative": radius * net.network_radius_ratio_conservative,
        "core_polymer_fraction": net.core_polymer_fraction,
        "core_polymer_fraction_eq40": net.core_polymer_fraction_eq40,
        "core_polymer_fraction_conservative": net.core_polymer_fraction_conservative,
        "strand_force": strand_force(walk.force, solution.kuhn_length, solution.temperature),
        "compacted": net.compacted,
        "compacted_eq40": net.compacted_eq40,
        "compacted_conservative": net.compacted_conservative,
        "flux_exceeded": net.flux_exceeded,
        "contour_reached": net.contour_reached,
    }
    return {name: _spread(values, known) for name, values in flat.items()}


def network_stretch(profile: dict[str, FloatArray], network: "Manifold | SettledChain") -> FloatArray:
    """Stretch w of a network that slips, at the places of a straight jet's profile."""
    s = (profile["z"] - profile["z"][0]) * (network.length / (profile["z"][-1] - profile["z"][0]))
    stretch = network.stretch(np.clip(s, 0.0, network.length))
    if not (stretch > 0).all():
        joined = getattr(network, "coarse_grain", 1.0)
        raise InputError(
            "network.model", f"leaves strands turned over ({joined:.3g} joined into one): too few of them in this jet",
            value="chain", remedy="join fewer (network.coarse_grain), take a longer jet, or a higher coupling",
        )  # fmt: skip
    return stretch


def _spread(values: FloatArray, known: Any) -> FloatArray:
    if known.all():
        return values.reshape(known.shape)
    full = np.full(known.shape, False if values.dtype == bool else np.nan, dtype=values.dtype)
    full[known] = values
    return full
