"""What each effect would change in a scene's answer, from the scene's own numbers, before anything is solved.

An estimate is the change of the reported quantities (`difference`) over the first nine tenths of the jet, by the first term
that the effect adds:

* elastic coupling: ``w = V + eps V V' + eps^2 (2 V V'^2 + V^2 V'')``, ``eps = c / alpha_v``; nothing steady beyond eps V' = 1/4
* inertia: the same with -I for eps
* finite extensibility: the place from which a stiff network locks, ``int (V_S - V) ds = 0`` from there to the end
* saturation: how far the walk's fraction passes 1

Each costs a few evaluations of the closed forms.
"""

from dataclasses import dataclass

import numpy as np

from spinline.build import coupling, jet_length
from spinline.checks import FloatArray
from spinline.jetprofile.straight import StraightJet
from spinline.network.crossover import extension_velocity_ratio
from spinline.network.mesh import network_at_rest
from spinline.network.state import NetworkState, affine_network, network_state
from spinline.rheology.solution import Solution
from spinline.scene import Scene

__all__ = ["Effect", "elastic_coupling_effect", "extensibility_effect", "inertia_effect", "saturation_effect"]

_KEPT = 0.9  # of the jet, as in `difference`
_POINTS = 201
_UNSTEADY = 0.25  # eps V' from which no steady network exists


@dataclass(frozen=True)
class Effect:
    """One effect: its number, and the error of an answer without it.

    Attributes
    ----------
    name : str
        As in `spinline plan`.
    symbol : str
        What the number is.
    number, error : float
        NaN where not known; an error of 1 or more is no answer.
    words : str
        The reason, a clause.
    """

    name: str
    symbol: str
    number: float
    error: float
    words: str


def elastic_coupling_effect(scene: Scene, solution: Solution, jet: StraightJet) -> Effect:
    """Slip of the network against the solution at finite alpha_v."""
    alpha, _, viscosity = coupling(scene, solution, jet)
    eps = scene.network.spring.value / alpha
    number, error = _slip(scene, solution, jet, eps)
    if np.isnan(alpha):
        words = f"alpha_v is {viscosity}"
    elif number > _UNSTEADY:
        words = f"c V'/alpha_v passes 1/4 (alpha_v = {alpha:.4g}): no steady network there, see the chain"
    else:
        words = f"the network slips by {number:.2g} of its velocity at most (alpha_v = {alpha:.4g}; {viscosity})"
    return Effect("elastic coupling", "c V'/alpha_v", number, error, words)


def inertia_effect(scene: Scene, solution: Solution, jet: StraightJet) -> Effect:
    """Mass of the strands."""
    number, error = _slip(scene, solution, jet, -scene.network.inertia.value)
    return Effect("inertia", "I V'", abs(number), error, f"I = {scene.network.inertia.value:g}")


def extensibility_effect(scene: Scene, solution: Solution, jet: StraightJet) -> Effect:
    """Contour length of the strands, as the network as a whole feels it."""
    full = float(network_at_rest(solution.volume_fraction, scene.network.solvent_quality).full_stretch)
    z = _grid(scene, jet, 1.0)
    v = jet.velocity_ratio(z)
    number = float(v.max()) / full
    name, symbol = "finite extensibility", "V/V_S at the end"
    if number < 1:
        return Effect(name, symbol, number, 0.0, f"the jet ends at {number:.2g} of full stretch")
    step = np.diff(z) * (full - 0.5 * (v[1:] + v[:-1]))
    room = np.append(np.cumsum(step[::-1])[::-1], 0.0)  # of the contour, from z to the end
    first = int(np.flatnonzero(room <= 0)[0])
    error = full / float(v[first]) - 1 if z[first] < _KEPT * z[-1] else 0.0
    words = (
        f"a steady network that cannot overstretch is locked from {1e3 * z[first]:.3g} mm (V = {v[first]:.3g}) to its free "
        'end, if its strands hold: see model = "manifold" with a force_law'
    )
    return Effect(name, symbol, number, error, words)


def saturation_effect(scene: Scene, solution: Solution, jet: StraightJet) -> Effect:
    """Polymer fraction of the core held at 1."""
    from spinline.network.concentration import log_fraction_walk

    v = jet.velocity_ratio(_grid(scene, jet, 1.0))
    passed = float(
        np.max(log_fraction_walk(v, solution.volume_fraction, solvent_quality=scene.network.solvent_quality))
    )
    number = float(np.exp(min(passed, 700.0)))
    words = "the core is compact polymer before the end" if number > 1 else "the core is not compact anywhere"
    return Effect("saturation", "unbounded core fraction", number, max(number - 1, 0.0), words)


def _slip(scene: Scene, solution: Solution, jet: StraightJet, eps: float) -> tuple[float, float]:
    """Largest eps V', and what w = V + eps V V' + ... changes."""
    if not eps:
        return 0.0, 0.0
    if np.isnan(eps):
        return eps, eps
    z = _grid(scene, jet, _KEPT)
    v = jet.velocity_ratio(z)
    slope = jet.strain_rate(z) * jet.initial_radius / jet.initial_velocity
    number = float(np.abs(eps) * slope.max())
    if number > _UNSTEADY:
        return number, max(1.0, number)
    first = eps * slope
    w = v * (1 + first + 2 * first**2)
    n = scene.network
    affine = affine_network(v, solution.volume_fraction, closure=n.closure, solvent_quality=n.solvent_quality)
    moved = network_state(w, v, solution.volume_fraction, closure=n.closure, solvent_quality=n.solvent_quality)
    place = float(
        extension_velocity_ratio(
            n.crossover_extension.value, solution.volume_fraction, closure=n.closure, solvent_quality=n.solvent_quality
        )
    )
    at = jet.position_of(place) if place <= v[-1] else float("nan")
    shift = (
        float(np.interp(place, v, first * v)) / float(jet.strain_rate(at)) * jet.initial_velocity / float(at)
        if at > 0
        else 0.0
    )
    return number, max(change(moved, affine), abs(shift))


def change(state: NetworkState, reference: NetworkState) -> float:
    """Largest change of stretch and core fraction (relative) and orientation (absolute)."""
    here, there = state.conformation, reference.conformation
    return float(
        max(
            np.max(np.abs(here.axial_stretch / there.axial_stretch - 1)),
            np.max(np.abs(here.orientation - there.orientation)),
            np.max(np.abs(state.core_polymer_fraction / reference.core_polymer_fraction - 1)),
        )
    )


def _grid(scene: Scene, jet: StraightJet, share: float) -> FloatArray:
    """Places along the jet, fine at the nozzle, its kinks among them."""
    r0, end = jet.initial_radius, jet.start + share * (jet_length(scene, jet) - jet.start)
    z = jet.start + r0 * np.expm1(np.linspace(0.0, np.log1p((end - jet.start) / r0), _POINTS))
    return np.unique(np.clip(np.append(z, [jet.start + kink * r0 for kink in jet.kinks()]), jet.start, end))
