"""Where the network is fully stretched: the first place where V, or the network's own stretch, passes a value."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network_models.rung import Network
from spinline.scene.file import Scene
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.jetprofile.jet import Jet

__all__ = ["Crossover", "crossover", "crossover_scalars", "passage", "slipping_passage", "targets"]


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


def passage(context: Context, velocity_ratio: float) -> Crossover:
    """First place along one moment of a jet where V passes a value."""
    jet, straight = context.jet, context.straight
    predicted = float(jet.position_of(velocity_ratio)) if velocity_ratio > 0 else float("nan")
    if 0 < velocity_ratio <= 1:  # so at rest
        predicted = jet.start
    end = context.length if straight else float("inf")
    if not predicted <= end * (1 + 1e-12):
        nan = float("nan")
        return Crossover(velocity_ratio, nan, nan, nan, predicted)
    place = min(predicted, jet.end) if straight else predicted
    radius = float(jet.radius(place))
    return Crossover(velocity_ratio, predicted, radius, radius / jet.initial_radius, predicted)


def slipping_passage(context: Context, network: Network, target: float) -> Crossover:
    """First place where the stretch of a network that slips passes a value."""
    nan, jet = float("nan"), context.line
    s = network.first_passage(target)
    if np.isnan(s):
        return Crossover(nan, nan, nan, nan, nan)
    place = min(jet.start + s * jet.initial_radius, jet.end)
    radius = float(jet.radius(place))
    return Crossover(float(jet.velocity_ratio(place)), place, radius, radius / jet.initial_radius, place)


def crossover_scalars(found: dict[str, list[Crossover]], *, single: bool) -> dict[str, float | FloatArray]:
    """Numbers of a result; arrays along time where there are many moments."""
    scalars: dict[str, float | FloatArray] = {}
    for name, places in found.items():
        for quantity in ("position", "radius", "radius_ratio", "velocity_ratio"):
            values = [getattr(place, quantity) for place in places]
            scalars[f"{name}_{quantity}"] = values[0] if single else np.array(values)
    return scalars
