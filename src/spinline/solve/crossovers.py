"""Where the network is fully stretched: the first place where V, or the network's own stretch, passes a value."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.power_law import PowerLaw
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network.tension import Tension
from spinline.network_models.rung import Network
from spinline.network_models.steady import Networks
from spinline.scene.file import Scene
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.jetprofile.jet import Jet
    from spinline.jetprofile.many import StraightJets
    from spinline.jetprofile.straight import StraightJet

__all__ = [
    "Crossover",
    "crossover",
    "crossover_scalars",
    "odd_places",
    "passage",
    "passages",
    "slipping_passages",
    "targets",
]


_ASYMPTOTE = 3.0  # onsets from which a power law counts as one


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


def targets(context: Context) -> dict[str, float]:
    """V of both criteria: full stretch, Eq. (38), and the extension that the scene names."""
    n, phi = context.scene.network, context.solution.volume_fraction
    reach = extension_velocity_ratio(
        n.crossover_extension.value, phi, closure=n.closure_used, solvent_quality=n.solvent_quality
    )
    return {
        "crossover": float(crossover_velocity_ratio(phi, n.solvent_quality)),
        "crossover_extension": float(reach),
    }


def crossover(scene: Scene, jet: "Jet", velocity_ratio: float) -> Crossover:
    """First place along the jet where V passes a value."""
    context = Context(scene, jet=jet)
    if context.jet.time is not None:
        raise InputError("jet.time", "holds many times", remedy="take one")
    return passage(context, velocity_ratio)


def passages(
    jet: "StraightJet | StraightJets", velocity_ratio: ArrayLike, length: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """First places within a length where V passes values, along one straight jet or along each of many.

    Returns
    -------
    position, radius, predicted : ndarray
        m; NaN where the length does not hold it; `predicted` is the place if the profile went on.
    """
    target = np.asarray(velocity_ratio, dtype=np.float64)
    beyond = np.where(target > 1, target, 1.0)
    predicted = np.where(
        target > 1, jet.position_of(beyond), np.where(target > 0, jet.start, np.nan)
    )  # at rest at the start
    reached = predicted <= np.asarray(length) * (1 + 1e-12)
    place = np.where(reached, np.minimum(predicted, jet.end), jet.start)
    position, radius = np.where(reached, predicted, np.nan), np.where(reached, jet.radius(place), np.nan)
    return position, radius, predicted


def passage(context: Context, velocity_ratio: float) -> Crossover:
    """First place along one moment of a jet where V passes a value."""
    if context.straight:
        jet = context.line
        found = passages(jet, velocity_ratio, context.length)
        position, radius, predicted = (float(value) for value in found)
        return Crossover(velocity_ratio, position, radius, radius / jet.initial_radius, predicted)
    beads = context.beads
    place = float(beads.position_of(velocity_ratio)) if velocity_ratio > 1 else beads.start
    if np.isnan(place) or not velocity_ratio > 0:
        nan = float("nan")
        return Crossover(velocity_ratio, nan, nan, nan, nan)
    radius = float(beads.radius(place))
    return Crossover(velocity_ratio, place, radius, radius / beads.initial_radius, place)


def slipping_passages(context: Context, network: Network, target: float) -> list[Crossover]:
    """First places, one a moment, where the strands of a network that slips are stretched by a value.

    Beyond the contour of strands that have one: where they bear the tension of the spring that is stretched so far.
    """
    moments = network.moments if isinstance(network, Networks) else [network]
    return [_slipping_passage(frame, one, target) for frame, one in zip(context.frames, moments, strict=True)]


def _slipping_passage(context: Context, network: Network, target: float) -> Crossover:
    nan, jet, full = float("nan"), context.jet, context.rest.full_stretch
    stretch = target
    if target >= full:  # strands with a contour do not pass it: they bear there what a spring of that stretch bears
        law = Tension.of(context.scene.network.force_law, full)
        stretch = float(law.stretch(target))
    s = network.first_passage(stretch)
    if np.isnan(s):
        most = float(network.stretch(np.linspace(0.0, network.length, 201)).max())
        words = f"the network, as it slips, is stretched w = {most:.6g} at most; it takes {stretch:.6g}"
        return Crossover(target, nan, nan, nan, nan, words)
    place = min(jet.start + s * jet.initial_radius, jet.end)
    radius = float(jet.radius(place))
    return Crossover(target, place, radius, radius / jet.initial_radius, place)


def odd_places(context: Context, found: dict[str, list[Crossover]]) -> list[str]:
    """Crossovers that a profile cannot be asked for: within a radius of the nozzle, before its first sample, at its onset."""
    if not context.straight:
        return []
    jet, remarks = context.line, []
    r0, first = jet.initial_radius, float(jet.velocity_ratio(jet.start))
    for name, places in found.items():
        words, place = name.replace("_", " by "), places[0]
        if np.isnan(place.position) or place.position == jet.start:
            if first > place.velocity_ratio > 1:
                remarks.append(
                    f"{words} lies before the profile: its first sample, at {1e3 * jet.start:.4g} mm, is past it "
                    f"(V = {first:.4g} against {place.velocity_ratio:.4g})"
                )
            continue
        along = (place.position - jet.start) / r0
        onset = max(jet.kinks(), default=0.0) if isinstance(jet, PowerLaw) else 0.0
        if 0 < along < 1:
            remarks.append(
                f"{words} is {along:.2g} radii from the nozzle ({1e3 * place.position:.3g} mm): there the jet is a meniscus "
                "and no profile of it holds"
            )
        elif 0 < along < _ASYMPTOTE * onset:
            remarks.append(
                f"{words} is {along / onset:.2g} times as far as the onset of the power law ({1e3 * onset * r0:.3g} mm): the "
                "law is an asymptote and holds farther downstream"
            )
    return remarks


def crossover_scalars(found: dict[str, list[Crossover]], *, single: bool) -> dict[str, float | FloatArray]:
    """Numbers of a result; arrays along time where there are many moments."""
    scalars: dict[str, float | FloatArray] = {}
    for name, places in found.items():
        for quantity in ("position", "radius", "radius_ratio", "velocity_ratio"):
            values = [getattr(place, quantity) for place in places]
            scalars[f"{name}_{quantity}"] = values[0] if single else np.array(values)
    return scalars
