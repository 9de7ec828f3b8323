"""Evaporation, relaxation and glass along one moment of a jet: what they make of the profile and of the strands' stretch.

One direction: jet -> volume left -> local fraction -> viscosity and relaxation time -> stretch of the strands -> glass.
Solved on a grid of its own, at least as fine as the result's, and read at the result's places.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.drying.along_jet import Dried, dry, dry_cooling, element_path, first_passage
from spinline.network_models.registry import rung_in
from spinline.network_models.variables import strand_conformation
from spinline.setup.context import Context
from spinline.setup.grid import jet_grid
from spinline.setup.history import History
from spinline.setup.material import Material
from spinline.solve.composition_path import composition_path
from spinline.solve.frozen_structure import Along, Frozen, freeze
from spinline.solve.solidify import Arrest, find_arrest, liquids_along, solid_of, stiffening

__all__ = ["Followed", "follow"]

IntArray = NDArray[np.intp]
_LEAST, _COARSE = 401, 1e-2  # samples along a jet, from this rtol on


@dataclass(frozen=True, eq=False)
class Followed:
    """What the effects make of a jet.

    Attributes
    ----------
    fields : dict
        Along the jet, in the shape of the profile; NaN where nothing is known.
    stretch, remaining : ndarray
        Stretch w of the network, as far as it is not frozen, and volume left; the shape of the profile.
    along : Along
        The samples behind them.
    frozen : Frozen or None
        What freezes; None without evaporation.
    dried : Dried or None
    at : ndarray of int
        Samples at the places of the profile.
    known : ndarray of bool
        Places of the profile where anything is known.
    entanglements_left : ndarray or float
        nu at the samples.
    attributes : dict
    remarks : list of str
    """

    fields: dict[str, FloatArray]
    stretch: FloatArray
    remaining: FloatArray
    along: Along
    frozen: Frozen | None
    dried: Dried | None
    at: IntArray
    known: BoolArray
    entanglements_left: FloatArray | float = 1.0
    attributes: dict[str, str] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)

    def passage(self, stretch: float) -> float:
        """First place where w passes a value, m; NaN where it never does."""
        level = np.log(self.along.stretch) + 0.5 * np.log(self.entanglements_left)  # the contour has grown as nu^(-1/2)
        return first_passage(self.along.position, level, float(np.log(stretch)))


def follow(
    context: Context,
    profile: dict[str, FloatArray],
    slipping: tuple[FloatArray, FloatArray] | None = None,
    *,
    bare: bool = False,
) -> Followed:
    """Follow the solution along one moment of a jet.

    Parameters
    ----------
    context : Context
        Rung and effects chosen.
    profile : dict
        Jet variables without the effects.
    slipping : tuple of ndarray, optional
        Stretch of the strands and velocity w of the network at the profile's places, of a rung that slips.
    bare : bool
        Do not look beyond the jet for where it would turn to glass.

    Raises
    ------
    InputError
        For missing properties, or a jet that cannot be followed.
    """
    place = profile["z" if context.straight else "arc_length"]
    known = np.isfinite(profile["stretch_ratio"])
    x = _samples(context, place[known])
    at = np.searchsorted(x, place[known])
    material, glass = context.material, context.glass[0]
    dried = _dried(context, x, profile, known, glass)
    history = _history(context, profile, known, x, dried)
    arrest: Arrest | None = None
    said: dict[str, str] = {}
    if dried is not None:
        history, arrest, said = _solidified(context, dried, history, beyond=not bare)
        if history.stiffening is not None:
            material = material.stiffened(history.stiffening)
    fields: dict[str, Any] = {
        "radius": history.radius,
        "velocity": history.velocity,
        "residence_time": history.time,
        "stretch_ratio": history.stretch,
    }
    attributes: dict[str, str] = {"concentration_laws": material.words} | said
    remarks: list[str] = []
    if history.strain_rate is not None:
        fields["strain_rate"] = history.strain_rate
    if dried is not None:
        fields |= {
            "evaporated_fraction": dried.lost,
            "reynolds_number": dried.reynolds,
            "sherwood_number": dried.sherwood,
        }
        attributes["evaporation"] = str(context.air if dried.temperature is None else context.heated_air)
        remarks += [f"evaporation: {note}" for note in dried.notes]
        if dried.temperature is not None:
            fields["temperature"] = dried.temperature
            remarks += _cold(context, dried)
    fields |= _material_fields(material, history.fraction)
    w = history.stretch
    slip = np.ones(x.size)  # velocity of the network over that of the jet
    if slipping is not None:
        w, moves = (np.exp(np.interp(x, place[known], np.log(values[known]))) for values in slipping)
        slip = moves / history.stretch
    if context.effects.relaxation:
        relaxed = rung_in(context.scene.network).relax(context, _held(history, arrest))
        attributes["constitutive_model"] = relaxed.words
        w = relaxed.stretch if slipping is None else w  # of a network that slips strands have relaxed already
        fields |= relaxed.fields
        remarks += relaxed.remarks
    along = Along(x, history.time, history.radius, w, history.stretch)
    frozen = None
    if dried is not None:
        assert arrest is not None
        frozen = _frozen(context, along, dried, arrest, slip)
        attributes |= {f"{name}_structure": words for name, words in frozen.words.items()}
        if not np.isnan(frozen.position):
            beyond = x > frozen.position
            w = np.where(beyond, frozen.scalars["frozen_stretch"], w)
            for name in set(fields) & {"stress", "radial_stress", "tensile_force", "weissenberg_number"}:
                fields[name] = np.where(beyond, np.nan, fields[name])
            fields["frozen"] = beyond
            along = Along(x, history.time, history.radius, w, history.stretch)
    return Followed(
        fields={name: spread(values[at], known) for name, values in fields.items()},
        stretch=spread(w[at], known),
        remaining=spread(history.remaining[at], known),
        along=along,
        frozen=frozen,
        dried=dried,
        at=at,
        known=known,
        entanglements_left=fields.get("entanglements_left", 1.0),
        attributes=attributes,
        remarks=remarks,
    )


def _solidified(
    context: Context, dried: Dried, history: History, *, beyond: bool
) -> tuple[History, Arrest, dict[str, str]]:
    """The history with what stiffens it, where the jet becomes solid, and what there is to say of laws and composition."""
    here, names = liquids_along(context, dried)
    solid = solid_of(context, here, names)
    said: dict[str, str] = {}
    if dried.temperature is not None:
        factor, words = stiffening(context, here, solid)
        history = replace(history, temperature=dried.temperature, stiffening=factor)
        said["concentration_laws"] = f"{context.material.words}; {words}"
    arrest = find_arrest(context, dried, history, solid, here, beyond=beyond)
    said["composition_path"] = composition_path(context, dried.position, here, names, arrest.position)
    return history, arrest, said


def _held(history: History, arrest: Arrest | None) -> History:
    """What relaxation acts on: along a jet that cools the stretch is held from the arrest on, as the glass to come holds it."""
    if arrest is None or history.temperature is None or np.isnan(arrest.position):
        return history
    beyond = history.position > arrest.position
    last = float(np.exp(np.interp(arrest.position, history.position, np.log(history.stretch))))
    rate = history.strain_rate
    return replace(
        history,
        stretch=np.where(beyond, last, history.stretch),
        strain_rate=None if rate is None else np.where(beyond, 0.0, rate),
    )


def spread(values: FloatArray, known: BoolArray) -> FloatArray:
    """Values at the known places, NaN (or False) elsewhere; further dimensions stay."""
    if known.all():
        return values
    full = np.full((*known.shape, *values.shape[1:]), False if values.dtype == bool else np.nan, dtype=values.dtype)
    full[known] = values
    return full


def _samples(context: Context, place: FloatArray) -> FloatArray:
    """The result's places, and more between them where they are few, along a straight jet."""
    least = int(_LEAST * max(1.0, (_COARSE / context.scene.accuracy.rtol) ** 0.5))  # second order in the spacing
    if not context.straight or place.size >= least:
        return place
    inner = jet_grid(context.line, float(place[-1]), least)[1:-1]
    # places of the result stay as they are; a sample closer than rounding to one of them is none
    near = place[np.clip(np.searchsorted(place, inner), 0, place.size - 1)]
    before = place[np.clip(np.searchsorted(place, inner) - 1, 0, place.size - 1)]
    gap = np.minimum(np.abs(near - inner), np.abs(inner - before))
    return np.union1d(place, inner[gap > 1e-6 * np.minimum(inner - place[0], context.jet.initial_radius)])


def _dried(
    context: Context, x: FloatArray, profile: dict[str, FloatArray], known: BoolArray, glass: float
) -> Dried | None:
    """The drying stage; None where nothing evaporates."""
    if not context.effects.evaporation:
        return None
    age = None if context.straight else profile["residence_time"][known]
    law = context.diffusion if context.effects.radial else None
    path = element_path(context.jet, x, age)
    if context.effects.heat:
        return dry_cooling(path, context.solution, context.heated_air, law, cells=context.scene.accuracy.shells)
    return dry(path, context.solution, context.air, law, glass=glass, cells=context.scene.accuracy.shells)


def _history(
    context: Context, profile: dict[str, FloatArray], known: BoolArray, x: FloatArray, dried: Dried | None
) -> History:
    """Age, material stretch, radius, velocity and strain rate (None along beads) of the jet as it dries."""
    left = np.ones(x.size) if dried is None else dried.remaining
    fraction = np.minimum(context.solution.volume_fraction / left, 1.0)  # rounding only
    if not context.straight:
        time = profile["residence_time"][known]
        if not np.isfinite(time).all():
            raise InputError(
                "jet",
                "has no velocities: the age of its elements is not known",
                remedy="give the velocity of the beads",
            )
        radius, stretch = profile["radius"][known] * np.sqrt(left), profile["stretch_ratio"][known]
        return History(x, time, stretch, radius, profile["velocity"][known], None, left, fraction)
    jet = context.line
    time, stretch, velocity = jet.residence_time(x), jet.stretch_ratio(x), jet.velocity(x)
    rate, radius = jet.strain_rate(x), jet.radius(x)
    if dried is None or dried.path.given == "velocity":
        return History(
            x, time, stretch, radius if dried is None else radius * np.sqrt(left), velocity, rate, left, fraction
        )
    slower = 0.5 * (1 / left[1:] + 1 / left[:-1])
    time = np.concatenate((time[:1], time[0] + np.cumsum(np.diff(time) * slower)))
    rate = np.gradient(velocity * left, x)
    return History(x, time, stretch * left, radius, velocity * left, rate, left, fraction)


def _material_fields(material: Material, fraction: FloatArray) -> dict[str, FloatArray]:
    """Viscosity and relaxation time where they are known."""
    fields: dict[str, FloatArray] = {}
    if material.solution.viscosity is not None or material.laws.law == "martin":
        fields["viscosity"] = material.viscosity(fraction)
    if material.solution.relaxation_time is not None:
        fields["relaxation_time"] = material.relaxation_time(fraction)
    return fields


def _frozen(context: Context, along: Along, dried: Dried, arrest: Arrest, slip: FloatArray) -> Frozen:
    places = {"frozen": (arrest.position, arrest.predicted)}
    if dried.radial is not None:
        places |= {"skin": (arrest.skin, arrest.skin), "core": (arrest.core, arrest.core)}
    exact = None
    if not np.isnan(arrest.position):
        path = dried.path
        left = context.solution.volume_fraction / arrest.fraction
        stretch = float(path.stretch(np.asarray([arrest.position]))[0]) * (left if path.given == "radius" else 1.0)
        exact = {"stretch_ratio": stretch, "radius": path.initial_radius * float(np.sqrt(left / stretch))}
    found = freeze(
        along, places, arrest.fraction, arrest.why, lambda w: strand_conformation(context, w), arrest.never, exact
    )
    nan = float("nan")
    behind = nan if exact is None else float(np.interp(arrest.position, along.position, slip))
    grown = arrest.crystallinity
    solid = {
        "arrest_position": arrest.position,
        "arrest_fraction": nan if exact is None else arrest.fraction,
        "arrest_temperature": arrest.temperature,
        "arrest_slip": behind if exact is None else max(behind, arrest.fraction),  # no section holds more than itself
        "crystallinity": nan if grown is None else float(grown[-1]),
    }
    # the fraction of the glass at the solution's temperature keeps its name where the jet holds it
    level = context.glass[0] if dried.temperature is None else found.scalars["vitrification_fraction"]
    return Frozen(found.position, found.scalars | solid | {"vitrification_fraction": level}, found.words)


def _cold(context: Context, dried: Dried) -> list[str]:
    """Where the jet is colder than the dew point of its air."""
    dew, kelvin = context.heated_air.dew_point, dried.temperature
    assert kelvin is not None
    below = np.flatnonzero(kelvin < dew) if not np.isnan(dew) else np.zeros(0, dtype=int)
    if not below.size:
        return []
    place, least = dried.position[below[0]], float(kelvin.min())
    return [
        f"from {place:.3g} m on the jet is colder than the dew point of its air ({dew - 273.15:.3g} degC; {least - 273.15:.3g} "
        "degC at the least): water condenses on it"
    ]
