"""The numbers that say which physics a jet needs, and by how much an answer errs that leaves it out.

Nothing is run: closed forms, and the flat balance of evaporation where the air is known (about 10 ms). What cannot be said for
want of data is NaN, with the reason.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.drying.along_jet import (
    Dried,
    biot_number,
    check_radial,
    dry,
    dry_cooling,
    element_path,
    fourier_number,
    peclet_number,
)
from spinline.network.coupling import strand_force
from spinline.network.state import network_state
from spinline.plan.estimates import MARGIN, Estimate, relaxation_effect
from spinline.rheology.solution import Solution
from spinline.rheology.vapour import equilibrium_fraction
from spinline.scene.file import Scene
from spinline.setup.context import Context
from spinline.setup.coupling import drag_of_solvent
from spinline.setup.heat import heat_refusal

if TYPE_CHECKING:
    from spinline.jetprofile.jet import Jet

__all__ = ["EffectNumbers", "coupling_error", "deborah_number", "effect_numbers", "numbers_of"]

_NAN = float("nan")
_PLACES = 401  # as many as a run has: dryness of a thin jet changes within the first of them


@dataclass(frozen=True)
class EffectNumbers:
    """Numbers that decide; NaN where data are missing.

    Attributes
    ----------
    stretch : float
        Largest material stretch.
    deborah : float
        ``theta edot`` at the crossover, or at the end of a jet that does not reach it.
    slip : float
        Largest ``eps V'``, the relative error of w = V against elastic slip.
    inertia : float
        I of the network: the scene's, or that of the polymer of a mesh.
    evaporated_fraction : float
        Volume lost by the end of the jet.
    drying_biot, drying_peclet, fourier : float
        At the end of the jet; Peclet the largest along it.
    force : float
        Affine end force f_z of a strand at the end.
    core_fraction : float
        Polymer fraction of the core there, exact walk, held at 1.
    slip_ratio : float
        ``V/(xi_par/xi_0)`` there: how far an affine force falls behind an affine stretch.
    strand_force : float
        Force on a strand there, N.
    errors : dict
        Estimate of the relative error of leaving out "slip", "inertia", "relaxation", "evaporation", "radial", "heat".
    missing : dict
        Why an effect has no estimate.
    relaxation : Estimate
        The estimate of relaxation.
    wet_bulb_depression : float
        Air's temperature less that of a wet thread of the first solvent, K.
    """

    stretch: float
    deborah: float
    slip: float
    inertia: float
    evaporated_fraction: float
    drying_biot: float
    drying_peclet: float
    fourier: float
    force: float
    core_fraction: float
    slip_ratio: float
    strand_force: float
    relaxation: Estimate
    errors: dict[str, float] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)
    wet_bulb_depression: float = _NAN


def effect_numbers(scene: Scene, solution: Solution, jet: "Jet") -> EffectNumbers:
    """`numbers_of` a scene and what `build_solution` and `build_jet` make of it."""
    return numbers_of(Context(scene, solution, jet))


def numbers_of(context: Context) -> EffectNumbers:
    """Numbers of a scene; of a bead jet with many times, those of the last.

    Parameters
    ----------
    context : Context

    Returns
    -------
    EffectNumbers

    Raises
    ------
    InputError
        For a scene that cannot be right; not for one that leaves something out.

    Notes
    -----
    Errors: slip and inertia ``eps V'`` and ``I V'``; relaxation what a strand gives back on the way (`estimates`), along
    bead jets ``1/De``, at most 1; evaporation the relative change of the mean fraction; radial the difference between surface
    and mean over the mean, ``Pe (a - a_inf)/2`` once diffusion has crossed the jet, ``4 (Fo/pi)^(1/2)`` of that before, at most
    what a surface in equilibrium with the air has.
    """
    context = context.frames[-1]
    scene, solution = context.scene, context.solution
    phi, quality = solution.volume_fraction, scene.network.solvent_quality
    missing: dict[str, str] = {}
    stretch = _largest_stretch(context)
    state = network_state(stretch, stretch, phi, closure=scene.network.closure_used, solvent_quality=quality)
    walk = state.conformation
    de = _NAN
    if solution.relaxation_time is None:
        missing["relaxation"] = "solution.relaxation_time is not given"
    else:
        de = deborah_number(context)
    if context.straight:
        relaxing = relaxation_effect(context, de)
    else:
        about = _NAN if np.isnan(de) else min(1.0, 1 / de) if de > 0 else 1.0
        relaxing = Estimate("relaxation", "De", de, about, missing.get("relaxation", "about 1/De"))
    slip, inertia, steepest = _slip(context, missing)
    lost, biot, peclet, fourier, uneven, colder, depression = _drying(context, missing)
    return EffectNumbers(
        stretch=stretch,
        deborah=de,
        slip=slip,
        inertia=inertia,
        evaporated_fraction=lost,
        drying_biot=biot,
        drying_peclet=peclet,
        fourier=fourier,
        force=float(walk.force),
        core_fraction=float(state.core_polymer_fraction),
        slip_ratio=stretch / float(walk.axial_stretch),
        strand_force=float(strand_force(walk.force, solution.kuhn_length, solution.temperature)),
        relaxation=relaxing,
        errors={
            "slip": slip,
            "inertia": inertia * steepest,
            "relaxation": relaxing.error,
            "evaporation": abs(lost / (1 - lost)) if lost < 1 else np.inf if lost >= 1 else _NAN,
            "radial": uneven,
            "heat": colder,
        },
        missing=missing,
        wet_bulb_depression=depression,
    )


def deborah_number(context: Context) -> float:
    """``theta edot`` where the network is fully stretched, or at the end; in bead jets edot is the mean rate to there.

    Raises
    ------
    InputError
        Where the relaxation time, or the time along a bead jet, is not known.
    """
    theta, full = context.solution.relaxation_time, context.rest.full_stretch
    if theta is None:
        raise InputError("solution.relaxation_time", "is missing", remedy="give it")
    if context.straight:
        jet = context.line
        place = float(np.fmin(jet.position_of(full), context.length))
        return theta * float(jet.strain_rate(place))
    beads = context.beads
    time, stretch = context.ages[beads.usable], beads.stretch[beads.usable]
    if not np.isfinite(time).all():
        return _NAN
    reached = np.flatnonzero(stretch >= full)
    i = int(reached[0]) if reached.size else int(np.argmax(stretch))
    return theta * float(np.log(stretch[i]) / time[i])


def coupling_error(context: Context) -> float:
    """Largest relative error of w = V along the jet, ``c V' / alpha_v`` (first term of the series of Eq. 33)."""
    jet = context.line
    slope = jet.strain_rate(context.grid(257)) * jet.initial_radius / jet.initial_velocity
    return float(context.scene.network.spring.value * slope.max() / context.coupling.alpha)


def _largest_stretch(context: Context) -> float:
    if context.straight:
        return float(context.line.stretch_ratio(context.length))
    return float(context.beads.stretch[context.beads.usable].max())


def _slip(context: Context, missing: dict[str, str]) -> tuple[float, float, float]:
    """``eps V'``, I and V'."""
    if not context.straight:
        missing["slip"] = missing["inertia"] = "not estimated along bead jets"
        return _NAN, _NAN, _NAN
    scene, solution, jet = context.scene, context.solution, context.line
    slip = coupling_error(context)
    alpha, words = context.coupling.alpha, context.coupling.words
    if np.isnan(slip):
        missing["slip"] = missing["inertia"] = words
        return _NAN, _NAN, _NAN
    steepest = slip * alpha / scene.network.spring.value
    inertia = scene.network.inertia.value
    if inertia == 0:
        try:
            viscosity = drag_of_solvent(scene, solution, "the inertia of the network")[0]
        except InputError as error:
            missing["inertia"] = str(error)
            return slip, _NAN, steepest
        xi = context.rest.size * solution.kuhn_length
        mass = solution.volume_fraction * solution.polymer.density * xi**3
        inertia = mass * jet.initial_velocity / (xi * viscosity * jet.initial_radius)
    return slip, inertia, steepest


def _drying(context: Context, missing: dict[str, str]) -> tuple[float, float, float, float, float, float, float]:
    """Evaporated fraction, Biot, Peclet and Fourier numbers, how uneven the jet is, what heat changes, wet-bulb depression."""
    scene, solution = context.scene, context.solution
    if scene.ambient is None and True not in (scene.effects.evaporation, scene.effects.radial, scene.effects.heat):
        missing["evaporation"] = missing["radial"] = missing["heat"] = "there is no [ambient]"
        return (_NAN,) * 7
    still, cold, colder, depression = _both_ways(context, missing)
    heated = cold is not None and (scene.effects.heat is True or MARGIN * colder > scene.accuracy.rtol)
    dried = cold if heated else still
    if dried is None:
        missing["radial"] = missing["evaporation"]
        return (_NAN,) * 5 + (colder, depression)
    lost = float(dried.lost[-1])
    try:
        diffusion, air = context.diffusion, context.air
        check_radial(air)
    except InputError as error:
        missing["radial"] = str(error)
        return lost, _NAN, _NAN, _NAN, _NAN, colder, depression
    phi = solution.volume_fraction
    peclet = peclet_number(dried, air, diffusion, phi)
    biot, fourier = biot_number(peclet, dried, air, phi), fourier_number(dried, diffusion, phi)
    only = air.volatiles[0]
    mean = np.minimum(phi / dried.remaining, 1.0)
    pull = np.abs((1 - mean) * np.exp(mean * (1 + only.chi * mean)) - only.ambient)  # below 0 a jet takes vapour up
    # what pulls at a place lasts to the next: a jet may dry out between two; no surface goes beyond equilibrium
    after = np.append(fourier[1:], fourier[-1])
    balanced = equilibrium_fraction(only.ambient, only.chi) if 0 < only.ambient < 1 else 1.0
    uneven = np.minimum(0.5 * peclet * pull * np.minimum(1.0, 4 * np.sqrt(after / np.pi)), np.abs(balanced / mean - 1))
    return lost, float(biot[-1]), float(peclet.max()), float(fourier[-1]), float(uneven.max()), colder, depression


def _both_ways(context: Context, missing: dict[str, str]) -> tuple[Dried | None, Dried | None, float, float]:
    """The flat balance at the jet's own temperature and with heat, what leaving that out changes, the wet-bulb depression."""
    age = None if context.straight else context.ages[context.beads.usable]
    still, cold, depression = None, None, _NAN
    try:
        path = element_path(context.jet, _places(context), age)
        still = dry(path, context.solution, context.air)
    except InputError as error:
        missing["evaporation"] = str(error)
    if context.scene.effects.heat is False:
        missing["heat"] = "set so"
        return still, None, _NAN, _NAN
    try:
        why = heat_refusal(context.scene)
        if why:
            missing["heat"] = why
            return still, None, _NAN, _NAN
        air = context.heated_air
        depression = air.air_temperature - air.wet_bulb
        cold = dry_cooling(element_path(context.jet, _places(context), age), context.solution, air)
    except InputError as error:
        missing["heat"] = str(error)
        return still, None, _NAN, depression
    if still is None:
        missing.pop("evaporation", None)
        return None, cold, np.inf, depression
    return still, cold, float(np.max(np.abs(cold.remaining / still.remaining - 1))), depression


def _places(context: Context) -> FloatArray:
    if not context.straight:
        return np.asarray(context.beads.arc_length[context.beads.usable])
    return context.grid(_PLACES)
