"""What each effect would change in a scene's answer, from the scene's own numbers, before anything is solved.

An estimate is the change of the reported quantities (`difference`) along the whole jet, by the first term that the effect
adds:

* elastic coupling: ``w = V + eps V V' + eps^2 (2 V V'^2 + V^2 V'')``, ``eps = c / alpha_v``
* inertia: the same with -I for eps
* finite extensibility: the place from which a stiff network locks, ``int (V_S - V) ds = 0`` from there to the end
* relaxation: ``ln(w/V) = -int (1 - V^-2) / (2 theta) dt``, what a strand stretched with the flow gives back
* saturation: how far the walk's fraction passes 1

Each costs a few evaluations of the closed forms.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network.crossover import extension_velocity_ratio
from spinline.network.state import NetworkState, affine_network, network_state
from spinline.network_models.registry import cheapest
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.rheology.conformation import Model

__all__ = [
    "MARGIN",
    "UNSTEADY",
    "Estimate",
    "elastic_coupling_effect",
    "extensibility_effect",
    "inertia_effect",
    "relaxation_effect",
    "saturation_effect",
]

MARGIN = 1.2  # on every estimate, before it is compared with rtol
_LOCKED = 0.9  # of the jet: what locks beyond is its end
_POINTS = 201
UNSTEADY = 0.25  # eps V' from which the series of the slip says nothing


@dataclass(frozen=True)
class Estimate:
    """One effect in one scene: its number, and the error of an answer without it.

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


def elastic_coupling_effect(context: Context) -> Estimate:
    """Slip of the network against the solution at finite alpha_v."""
    alpha, viscosity = context.coupling.alpha, context.coupling.words
    eps = context.scene.network.spring.value / alpha
    number, error = _slip(context, eps)
    if np.isnan(alpha):
        words = f"alpha_v is {viscosity}"
    elif number > UNSTEADY:
        words = f"c V'/alpha_v passes 1/4 (alpha_v = {alpha:.4g}): the far end of the jet may decide"
    else:
        words = f"the network slips by {number:.2g} of its velocity at most (alpha_v = {alpha:.4g}; {viscosity})"
    return Estimate("elastic coupling", "c V'/alpha_v", number, error, words)


def inertia_effect(context: Context, inertia: float) -> Estimate:
    """Mass of the strands; `inertia` is I, NaN where not known."""
    number, error = _slip(context, -inertia)
    words = "I is not known" if np.isnan(inertia) else f"I = {inertia:.3g}"
    return Estimate("inertia", "I V'", abs(number), error, words)


def extensibility_effect(context: Context) -> Estimate:
    """Contour length of the strands, as the network as a whole feels it."""
    full, jet = context.rest.full_stretch, context.line
    z = _grid(context)
    v = jet.velocity_ratio(z)
    number = float(v.max()) / full
    name, symbol = "finite extensibility", "V/V_S at the end"
    if number < 1:
        return Estimate(name, symbol, number, _stiffer(context, full), f"the jet ends at {number:.2g} of full stretch")
    step = np.diff(z) * (full - 0.5 * (v[1:] + v[:-1]))
    room = np.append(np.cumsum(step[::-1])[::-1], 0.0)  # of the contour, from z to the end
    first = int(np.flatnonzero(room <= 0)[0])
    passes = _passage(z - jet.start, v, full)  # where a network that overstretches does
    later = passes / (z[max(first, 1)] - jet.start) - 1
    error = float(max(full / v[first] - 1, later)) if z[first] < _LOCKED * z[-1] else 0.0
    held = cheapest([name])
    finer = "" if held is None else f': see model = "{held.name}" with a force_law'
    words = (
        f"a steady network that cannot overstretch is locked from {1e3 * z[first]:.3g} mm (V = {v[first]:.3g}) to its free "
        f"end, if its strands hold{finer}"
    )
    return Estimate(name, symbol, number, error, words)


def _stiffer(context: Context, full: float) -> float:
    """Slip that a law with a contour adds to the linear spring's, short of the contour: ``eps V' (T' - 1)``."""
    from spinline.network.tension import Tension

    scene, jet, alpha = context.scene, context.line, context.coupling.alpha
    law = "lattice" if scene.network.force_law == "linear" else scene.network.force_law
    z = _grid(context)
    spring = Tension.of(law, full)
    v = jet.velocity_ratio(z)
    _, compliance = spring.state(spring.tension(v))
    slope = jet.strain_rate(z) * jet.initial_radius / jet.initial_velocity
    with np.errstate(divide="ignore"):
        added = np.minimum(scene.network.spring.value / alpha * slope * np.abs(1 / compliance - 1), 1.0)
    if np.isnan(alpha):
        return 0.0
    return _moved(context, z, v, np.minimum(v * (1 + added), (1 - 1e-6) * full))


def relaxation_effect(context: Context, deborah: float) -> Estimate:
    """Strands that give back some of their stretch on the way; `deborah` is theta edot at the crossover."""
    from spinline.rheology.conformation import Maxwell
    from spinline.setup.material import constitutive_model

    theta, jet = context.solution.relaxation_time, context.line
    name, symbol = "relaxation", "De"
    if theta is None:
        return Estimate(name, symbol, float("nan"), float("nan"), "solution.relaxation_time is not given")
    z = _grid(context)
    v, time = jet.velocity_ratio(z), jet.residence_time(z)
    try:
        model: Model = constitutive_model(context.scene, context.material, context.rest.full_stretch)
    except InputError as problem:  # a run by that rung is refused; whether one is needed can be said all the same
        if problem.field != "rheology.extensibility":
            raise
        model = Maxwell()
    faster, contour = model.stiffening(v)
    rate = (1 - v**-2.0) / 2 * faster
    given_back = np.concatenate(([0.0], np.cumsum(np.diff(time) * 0.5 * (rate[1:] + rate[:-1])))) / theta
    w = np.maximum(v * np.exp(-np.minimum(given_back, 700.0)), 1.0)
    if contour < v[-1]:  # never quite there
        w = np.minimum(w, (1 - 1e-6) * contour)
    error = _moved(context, z, v, w)
    return Estimate(
        name, symbol, deborah, error, f"a strand gives back {-np.expm1(-given_back[-1]):.2g} of its stretch on the way"
    )


def saturation_effect(context: Context) -> Estimate:
    """Polymer fraction of the core held at 1."""
    from spinline.network.concentration import log_fraction_walk

    n, v, phi = (
        context.scene.network,
        context.line.velocity_ratio(_grid(context)),
        context.solution.volume_fraction,
    )
    state = affine_network(v, phi, closure=n.closure_used, solvent_quality=n.solvent_quality)
    passed = float(np.max(log_fraction_walk(state.conformation, phi)))
    number = float(np.exp(min(passed, 700.0)))
    words = "the core is compact polymer before the end" if number > 1 else "the core is not compact anywhere"
    return Estimate("saturation", "unbounded core fraction", number, max(1 - 1 / number, 0.0), words)


def _slip(context: Context, eps: float) -> tuple[float, float]:
    """Largest eps V', and what w = V + eps V V' + ... changes."""
    if not eps:
        return 0.0, 0.0
    if np.isnan(eps):
        return eps, eps
    z, jet = _grid(context), context.line
    v = jet.velocity_ratio(z)
    slope = jet.strain_rate(z) * jet.initial_radius / jet.initial_velocity
    number = float(np.abs(eps) * slope.max())
    if number > UNSTEADY:
        return number, max(1.0, number)
    first = eps * slope
    return number, _moved(context, z, v, v * (1 + first + 2 * first**2))


def _moved(context: Context, z: FloatArray, v: FloatArray, w: FloatArray) -> float:
    """What a stretch w in place of V changes: the network's state, and where it passes both criteria."""
    n, phi = context.scene.network, context.solution.volume_fraction
    rules = {"closure": n.closure_used, "solvent_quality": n.solvent_quality}
    shift = change(network_state(w, v, phi, **rules), affine_network(v, phi, **rules))  # type: ignore[arg-type]
    reach = extension_velocity_ratio(
        n.crossover_extension.value, phi, closure=n.closure_used, solvent_quality=n.solvent_quality
    )
    for target in (context.rest.full_stretch, float(reach)):
        here, there = _passage(z, w, target), _passage(z, v, target)
        if np.isnan(here) != np.isnan(there):
            shift = max(shift, 1.0)
        elif there > 0:
            shift = max(shift, abs(here / there - 1))
    return shift


def _passage(z: FloatArray, stretch: FloatArray, target: float) -> float:
    """First place where a stretch passes a value, NaN where it never does."""
    above = np.flatnonzero(stretch >= target)
    if not above.size:
        return float("nan")
    k = max(int(above[0]), 1)
    return float(np.interp(np.log(target), np.log(stretch[k - 1 : k + 1]), z[k - 1 : k + 1]))


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


def _grid(context: Context) -> FloatArray:
    """Places along the jet, fine at the nozzle, its kinks among them."""
    return np.clip(context.grid(_POINTS), context.line.start, context.length)
