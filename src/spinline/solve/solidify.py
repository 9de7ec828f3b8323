"""Where a jet becomes solid and stays as it is: glass or crystals, at the temperature and composition it has got to.

At the solution's own temperature the glass is a fraction, reached or not. Along a jet that cools it is where T_g of
what is left passes T; crystals are where their melting point does. What comes first arrests the jet: its stretch is
held from there on, and the fibre is what that section makes when the rest of the solvent has gone.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.drying.along_jet import FARTHEST, Dried, dry, dry_cooling, element_path, first_passage, where_mean_reaches
from spinline.rheology import solvents
from spinline.setup.context import Context
from spinline.setup.history import History
from spinline.setup.solid import DRY, GEL, Liquids, Solid, build_solid

__all__ = ["Arrest", "find_arrest", "liquids_along", "solid_of", "stiffening"]

_NAN = float("nan")


@dataclass(frozen=True)
class Arrest:
    """Where a jet becomes solid.

    Attributes
    ----------
    position, predicted : float
        m; within the jet, and if the profile went on; NaN where it does not or cannot be said.
    fraction, temperature : float
        Of the polymer there, and K; where it is not reached the fraction that would do at the solution's temperature.
    why : str
        What it is: a clause for the sentence.
    never : str
        What to say where it is not reached.
    skin, core : float
        Where surface and axis do, with radial drying, m.
    crystallinity : ndarray or None
        Degree of crystallinity at the samples, where its kinetics are given.
    """

    position: float
    predicted: float
    fraction: float
    temperature: float
    why: str
    never: str
    skin: float
    core: float
    crystallinity: FloatArray | None


def liquids_along(context: Context, dried: Dried, fraction: FloatArray | None = None) -> tuple[Liquids, list[str]]:
    """What is in the jet, at the drying's places, and the liquids' names; `fraction` of the polymer in place of the
    mean.
    """
    if dried.temperature is not None:
        liquids = context.heated_air.evaporants
        names, chi = [e.name for e in liquids], [e.chi for e in liquids]
        volumes = [e.molar_mass / e.density for e in liquids]
        kelvin = dried.temperature
    else:
        volatiles = context.air.volatiles
        names, chi = [v.name for v in volatiles], [v.chi for v in volatiles]
        volumes = [v.molar_volume for v in volatiles]
        kelvin = np.full(dried.remaining.shape, context.solution.temperature)
    phi = np.minimum(context.solution.volume_fraction / dried.remaining if fraction is None else fraction, 1.0)
    assert dried.liquid is not None
    parts = np.maximum(dried.liquid, 0.0)
    whole = parts.sum(axis=0)
    share = np.divide(parts, whole, out=np.full_like(parts, 1 / len(names)), where=whole > 1e-290)
    return Liquids(kelvin, phi, share * (1 - phi), np.array(volumes), np.array(chi)), names


def solid_of(context: Context, here: Liquids, names: list[str]) -> Solid:
    """How the solution solidifies."""
    solution = context.solution
    phi = solution.volume_fraction
    shares = solution.solvent_volume_fractions
    own = np.array([[shares.get(name, 0.0)] for name in names])
    if not own.sum() > 0:  # a name of one's own
        own[0] = 1.0
    first = Liquids(
        np.array([solution.temperature]), np.array([phi]), own / own.sum() * (1 - phi), here.molar_volume, here.chi
    )
    return build_solid(context.scene, solution, names, first)


def stiffening(context: Context, here: Liquids, solid: Solid) -> tuple[FloatArray, str]:
    """Factor on viscosity and relaxation time along a jet that cools, and how it was made."""
    activation, words = _solvent_activation(context)
    log = activation * (1 / here.temperature - 1 / context.solution.temperature) / np.log(10.0)
    if solid.glass is not None:
        phi = context.solution.volume_fraction
        first = float(solid.glass.transition(phi, _at_the_nozzle(context, here) * (1 - phi)))
        log = log + solid.glass.stiffening_decades(here.polymer, here.liquid, here.temperature, first)
        words = f"WLF towards T_g by Fox, {words}"
    value: FloatArray = 10.0 ** np.minimum(log, 200.0)  # a glass of more decades than that is no less solid
    return value, words


def _at_the_nozzle(context: Context, here: Liquids) -> FloatArray:
    if context.effects.heat:
        return context.heated_air.shares
    return context.air.shares


def _solvent_activation(context: Context) -> tuple[float, str]:
    """Activation temperature of the solvent's viscosity, K; 0 where it is not known."""
    s = context.solution
    try:
        low, high = (solvents.mixture_viscosity(s.solvent, s.temperature + d) for d in (0.0, 8.0))
    except InputError:
        return 0.0, "solvent's viscosity held"
    slope = np.log(low / high) / (1 / s.temperature - 1 / (s.temperature + 8.0))
    return float(slope), "solvent's viscosity by its activation energy"


def find_arrest(
    context: Context, dried: Dried, history: History, solid: Solid, here: Liquids, *, beyond: bool = True
) -> Arrest:
    """Where the jet becomes solid first, by glass or by crystals; `beyond`: with a prediction beyond its end."""
    glass_place, glass_next, level, why, never = _glass(context, dried, solid, here, beyond)
    crystal_place, crystal_next, crystallinity = _crystals(context, dried, history, solid, here, beyond)
    by_crystals = _first(crystal_place, glass_place) or (np.isnan(glass_place) and _first(crystal_next, glass_next))
    undercooled = _least_crystalline(context, solid, here)
    by_crystals |= np.isnan(glass_place) and np.isnan(level) and not np.isnan(undercooled)  # no glass to speak of
    place, following = (crystal_place, crystal_next) if by_crystals else (glass_place, glass_next)
    if by_crystals:
        why = f"crystals: {solid.words}" if solid.kinetics is None else f"crystals, {GEL:g} of what there will be"
        never = never if np.isnan(level) else ""
    elif np.isnan(level) and solid.crystals is not None:
        why += f"; it crystallises below {solid.crystals.melting_temperature - solid.supercooling:g} K"
    fraction, kelvin = level, _NAN
    if not np.isnan(place):
        at = _value(place, dried.position, here.polymer)
        fraction = level if not by_crystals and not _follows(context, dried) else at
        kelvin = _value(place, dried.position, here.temperature)
    elif by_crystals:
        fraction = undercooled
    skin, core = _layers(context, dried, solid, level)
    return Arrest(place, following, fraction, kelvin, why, never, skin, core, crystallinity)


def _least_crystalline(context: Context, solid: Solid, here: Liquids) -> float:
    """Polymer fraction whose crystals do not melt at the solution's temperature; NaN where there are none."""
    if solid.when_dry:
        return DRY
    if solid.crystals is None:
        return _NAN
    return solid.crystals.crystallisation_fraction(
        context.solution.temperature + solid.supercooling, float(here.mean_volume[0]), float(here.mean_chi[0])
    )


def _value(place: float, position: FloatArray, samples: FloatArray) -> float:
    """Between samples as `first_passage` has found the place: by a monotone cubic."""
    from scipy.interpolate import PchipInterpolator

    i = int(np.searchsorted(position, place))
    lo, hi = max(i - 2, 0), min(i + 2, position.size)
    if hi - lo < 2:
        return float(samples[lo])
    return float(PchipInterpolator(position[lo:hi], samples[lo:hi])(place))


def _first(a: float, b: float) -> bool:
    return not np.isnan(a) and (np.isnan(b) or a < b)


def _follows(context: Context, dried: Dried) -> bool:
    """The glass follows the temperature: no fraction of it is given."""
    laws = context.scene.rheology
    return dried.temperature is not None and (laws is None or laws.vitrification_fraction is None)


def _glass(
    context: Context, dried: Dried, solid: Solid, here: Liquids, farther: bool
) -> tuple[float, float, float, str, str]:
    """Place, prediction, fraction, reason, and what to say where there is none."""
    level, why = context.glass
    end = context.heated_air.equilibrium if dried.temperature is not None else context.air.equilibrium
    never = f"drying ends at phi = {end:.4g}" if level >= end else "where it would is not known"
    if _follows(context, dried):
        if solid.glass is None:
            return _NAN, _NAN, level, why, never
        place = first_passage(dried.position, solid.glass_margin(here), 0.0)
        beyond = _NAN
        if np.isnan(place) and farther:
            beyond = _beyond(context, dried, solid.glass_margin)
        return place, beyond, level, why if np.isnan(place) else f"{why} at the jet's temperature", never
    if np.isnan(level):
        return _NAN, _NAN, level, why, never
    if dried.temperature is None:
        place, predicted = where_mean_reaches(dried, context.air, context.solution, context.jet, level, beyond=farther)
        return place, predicted, level, why, never
    place = first_passage(dried.position, here.polymer, level)
    return place, _NAN, level, why, never


def _crystals(
    context: Context, dried: Dried, history: History, solid: Solid, here: Liquids, farther: bool
) -> tuple[float, float, FloatArray | None]:
    """Place, prediction, and the degree of crystallinity where its kinetics are given."""
    if solid.crystals is None:
        return _NAN, _NAN, None
    margin = solid.crystal_margin(here)
    if solid.kinetics is not None:
        grown = solid.kinetics.crystallinity(history.time, margin > 0, history.stretch)
        return first_passage(dried.position, grown, GEL * solid.kinetics.maximum), _NAN, grown
    place = first_passage(dried.position, margin, 0.0)
    return (
        place,
        _NAN if not np.isnan(place) else _beyond(context, dried, lambda there: solid.crystal_margin(there)),
        None,
    )


def _beyond(context: Context, dried: Dried, margin: Callable[[Liquids], FloatArray]) -> float:
    """Where a margin would become positive if a straight jet of a law went on, dried flat across it."""
    if not context.straight or not np.isinf(context.line.end):
        return _NAN
    x = dried.position
    beyond = np.geomspace(x[-1], FARTHEST * x[-1], 401)
    try:
        path = element_path(context.jet, beyond)
        if dried.temperature is not None:
            flat = dry_cooling(path, context.solution, context.heated_air)
        else:
            flat = dry(path, context.solution, context.air)
        there, _ = liquids_along(context, flat)
        return first_passage(beyond, margin(there), 0.0)
    except InputError:
        return _NAN


def _layers(context: Context, dried: Dried, solid: Solid, level: float) -> tuple[float, float]:
    """Where surface and axis become glass, with radial drying."""
    radial = dried.radial
    if radial is None:
        return _NAN, _NAN
    if dried.temperature is None:
        return radial.vitrified_at if not np.isnan(level) else (_NAN, _NAN)
    found = []
    for fraction in (radial.polymer_fraction[:, -1], radial.polymer_fraction[:, 0]):
        here, _ = liquids_along(context, dried, fraction)
        if _follows(context, dried):
            found.append(first_passage(dried.position, solid.glass_margin(here), 0.0) if solid.glass else _NAN)
        else:
            found.append(_NAN if np.isnan(level) else first_passage(dried.position, fraction, level))
    return found[0], found[1]
