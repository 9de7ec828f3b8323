"""What the strands' stretch makes of the network: every variable of a result that all rungs have, on arrays of any shape.

The network stage of the spine. A run calls it with the places of one jet, a sweep with those of thousands of scenes at once:
the same formulas in the same order.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network.coupling import strand_force
from spinline.network.crossover import Closure
from spinline.network.mesh import SolventQuality
from spinline.network.state import dried_state, network_state
from spinline.network_models.rung import Network, Rung
from spinline.network_models.slipping import along
from spinline.network_models.steady import solved_on, velocity_of

if TYPE_CHECKING:
    from spinline.setup.context import Context

__all__ = ["lateral_variables", "network_motion", "network_variables", "strand_conformation"]


def network_variables(
    stretch: FloatArray,
    flow: FloatArray,
    radius: FloatArray,
    volume_fraction: ArrayLike,
    *,
    closure: Closure,
    solvent_quality: SolventQuality,
    kuhn_length: ArrayLike,
    temperature: ArrayLike,
    remaining: FloatArray | None = None,
    velocity: FloatArray | None = None,
    entanglements_left: FloatArray | None = None,
) -> dict[str, Any]:
    """Network variables from the stretch of the strands and that of the solution.

    Parameters
    ----------
    stretch, flow : ndarray
        Of the strands, and of the solution at the same places.
    radius : ndarray
        Of the jet, m.
    volume_fraction, kuhn_length, temperature : array_like
        Of the solution at the nozzle (1, m, K); broadcast with the others.
    closure, solvent_quality
        As for `spinline.network.network_state`.
    remaining : ndarray, optional
        Volume left over that at the nozzle, where the jet dries: strands are those at the nozzle, fractions over what is left.

    velocity : ndarray, optional
        w of the network; that of the solution where strands relax in it, their stretch otherwise (the default).
    entanglements_left : ndarray, optional
        nu, where entanglements let go.

    Returns
    -------
    dict of str to ndarray
        By their names in a result.
    """
    net = network_state(
        stretch if velocity is None else velocity,
        flow,
        volume_fraction,
        strand_stretch=None if velocity is None else stretch,
        entanglements_left=entanglements_left,
        closure=closure,
        solvent_quality=solvent_quality,
    )
    if remaining is not None:
        net = dried_state(net, flow, float(np.asarray(volume_fraction)), remaining, solvent_quality)
    walk = net.conformation
    return {
        "mean_polymer_fraction": net.mean_polymer_fraction,
        "network_velocity_ratio": net.network_velocity_ratio,
        "strand_stretch": net.strand_stretch,
        "flux_velocity_ratio": net.flux_velocity_ratio,
        "axial_stretch": walk.axial_stretch,
        "relative_extension": walk.relative_extension,
        "radial_contraction": walk.radial_contraction,
        "orientation": walk.orientation,
        "network_radius": radius * net.network_radius_ratio,
        "network_radius_conservative": radius * net.network_radius_ratio_conservative,
        "core_polymer_fraction": net.core_polymer_fraction,
        "core_polymer_fraction_eq40": net.core_polymer_fraction_eq40,
        "core_polymer_fraction_conservative": net.core_polymer_fraction_conservative,
        "strand_force": strand_force(walk.force, kuhn_length, temperature),
        "compacted": net.compacted,
        "compacted_eq40": net.compacted_eq40,
        "compacted_conservative": net.compacted_conservative,
        "flux_exceeded": net.flux_exceeded,
        "contour_reached": net.contour_reached,
    }


def strand_conformation(context: "Context", stretch: float) -> tuple[float, float]:
    """Extension over the contour and orientation of strands stretched by w, by the closure of a scene."""
    n = context.scene.network
    walk = network_state(
        stretch, stretch, context.solution.volume_fraction, closure=n.closure_used, solvent_quality=n.solvent_quality
    ).conformation
    return float(walk.relative_extension), float(walk.orientation)


def network_motion(
    context: "Context", rung: Rung, network: Network, profile: dict[str, FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Stretch of the strands and velocity w of a network that slips, at the places of a profile."""
    if context.straight:
        s = along(context, network, profile["z"])
        stretch, velocity = network.stretch(s), velocity_of(network, s)
    else:
        stretch = solved_on(context, network, lambda one, s: one.stretch(s))
        velocity = solved_on(context, network, velocity_of)
    if not (stretch[np.isfinite(stretch)] > 0).all():
        joined = getattr(network, "coarse_grain", 1.0)
        raise InputError(
            "network.model",
            f"has beads that passed each other ({joined:.3g} strands joined into one): too few beads in this jet",
            value=rung.name,
            remedy="join fewer (network.coarse_grain), take a longer jet, or a higher coupling",
        )
    return stretch, velocity


def lateral_variables(context: "Context", fields: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Network across the jet, Eq. (32b) in motion: its radius, and the polymer fraction of its layers.

    Raises
    ------
    InputError
        Where alpha_v is not known, or the jet is not straight.
    """
    from spinline.network.lateral import lateral_network

    if not context.straight:
        raise InputError("network.lateral", "needs a straight jet", value=True, remedy="leave it out")
    scene, jet, coupling = context.scene, context.line, context.coupling
    if np.isnan(coupling.alpha):
        raise InputError("network.lateral", f"needs alpha_v, which is {coupling.words}", remedy="give network.coupling")
    pace = scene.network.spring.value / coupling.alpha * jet.initial_velocity / jet.initial_radius
    contraction = fields["radial_contraction"]
    if not contraction[0] > 0:
        raise InputError(
            "network.lateral",
            "needs strands of some width at the nozzle",
            value=float(contraction[0]),
            allowed="radial_contraction > 0",
            remedy="leave network.lateral out",
        )
    gone = np.flatnonzero(~(contraction > 0))
    if gone.size:
        end = 1e3 * float(fields["z"][gone[0] - 1])
        raise InputError(
            "network.lateral",
            f"needs strands of some width, and they are at their contour from {end:.4g} mm on",
            value=0.0,
            allowed="radial_contraction > 0",
            remedy=f'take jet.length = "{0.999 * end:.4g} mm" or less, or leave network.lateral out',
        )
    try:
        across = lateral_network(
            pace * fields["residence_time"],
            fields["velocity_ratio"],
            contraction / contraction[0],
            context.solution.volume_fraction,
            network_velocity_ratio=fields["network_velocity_ratio"],
            rtol=max(1e-5, min(1e-3, 0.1 * scene.accuracy.rtol)),
        )
    except InputError as error:  # in the words of the scene
        remedy = "raise accuracy.points or accuracy.rtol, or" if error.field == "rtol" else "raise network.coupling, or"
        raise InputError(
            "network.lateral",
            f"{error.field} {error.problem}",
            value=error.value,
            allowed=error.allowed,
            remedy=f"{remedy} leave network.lateral out",
        ) from None
    return {
        "layer": 0.5 * (across.layer_edges[1:] + across.layer_edges[:-1]),
        "lateral_network_radius": across.radius_ratio * fields["radius"],
        "lateral_polymer_fraction": across.polymer_fraction,
    }
