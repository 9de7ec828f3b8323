"""Evaporation, relaxation and radial drying along one jet: what they make of the profile and of the network's stretch.

One direction: jet -> volume left -> local fraction -> viscosity and relaxation time -> stretch of the strands -> glass.
Solved on a grid of its own, at least as fine as the result's, and read at the result's places.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.drying.along_jet import Dried, dry, element_path, first_passage, where_mean_reaches
from spinline.jetprofile.straight import StraightJet
from spinline.network.state import network_state
from spinline.plan.effects import Effects
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene
from spinline.setup.build import jet_grid
from spinline.setup.material import Material, build_material, constitutive_model, diffusion_law, glass_fraction
from spinline.solve.frozen_structure import Along, Frozen, freeze

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.setup.air import Air

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
    air : Air or None
    at : ndarray of int
        Samples at the places of the profile.
    known : ndarray of bool
        Places of the profile where anything is known.
    attributes : dict
    remarks : list of str
    """

    fields: dict[str, FloatArray]
    stretch: FloatArray
    remaining: FloatArray
    along: Along
    frozen: Frozen | None
    dried: Dried | None
    air: "Air | None"
    at: IntArray
    known: BoolArray
    attributes: dict[str, str] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)

    def passage(self, stretch: float) -> float:
        """First place where w passes a value, m; NaN where it never does."""
        return first_passage(self.along.position, np.log(self.along.stretch), float(np.log(stretch)))


def follow(
    scene: Scene,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    effects: Effects,
    profile: dict[str, FloatArray],
    slipping: FloatArray | None = None,
) -> Followed:
    """Follow the solution along a jet.

    Parameters
    ----------
    scene, solution, jet, effects
        Of the run; of a bead jet one moment.
    profile : dict
        Jet variables without the effects.
    slipping : ndarray, optional
        Stretch w of the network at the profile's places, of a rung that slips.

    Raises
    ------
    InputError
        For missing properties, or a jet that cannot be followed.
    """
    place = profile["z" if isinstance(jet, StraightJet) else "arc_length"]
    known = np.isfinite(profile["stretch_ratio"])
    straight = isinstance(jet, StraightJet)
    x = _samples(scene, jet, place[known]) if straight else place[known]
    at = np.searchsorted(x, place[known])
    material = build_material(scene, solution)
    phi = solution.volume_fraction
    glass, why = glass_fraction(scene, solution)
    air, dried = _dried(scene, solution, jet, effects, x, profile, known, glass)
    left = np.ones(x.size) if dried is None else dried.remaining
    fraction = np.minimum(phi / left, 1.0)  # rounding only
    time, stretch, radius, velocity, rate = _kinematics(jet, profile, known, x, dried, left)
    fields: dict[str, Any] = {
        "radius": radius, "velocity": velocity, "residence_time": time, "stretch_ratio": stretch,
    }  # fmt: skip
    attributes: dict[str, str] = {"concentration_laws": material.words}
    remarks: list[str] = []
    if rate is not None:
        fields["strain_rate"] = rate
    if dried is not None:
        assert air is not None
        fields |= {"evaporated_fraction": dried.lost, "reynolds_number": dried.reynolds,
                   "sherwood_number": dried.sherwood}  # fmt: skip
        attributes["evaporation"] = str(air)
        remarks += [f"evaporation: {note}" for note in dried.notes]
    fields |= _material_fields(material, fraction)
    w = stretch
    if slipping is not None:
        w = np.exp(np.interp(x, place[known], np.log(slipping)))
    if effects.relaxation:
        w, relaxed, attributes["constitutive_model"] = _relaxed(scene, material, time, stretch, fraction, radius, rate)
        fields |= relaxed
    along = Along(x, time, radius, w, stretch)
    frozen = None
    if dried is not None:
        assert air is not None
        frozen = _frozen(scene, solution, jet, along, dried, air, glass, why)
        attributes |= {f"{name}_structure": words for name, words in frozen.words.items()}
        if not np.isnan(frozen.position):
            beyond = x > frozen.position
            w = np.where(beyond, frozen.scalars["frozen_stretch"], w)
            for name in set(fields) & {"stress", "radial_stress", "tensile_force", "weissenberg_number"}:
                fields[name] = np.where(beyond, np.nan, fields[name])
            fields["frozen"] = beyond
            along = Along(x, time, radius, w, stretch)
    return Followed(
        fields={name: spread(values[at], known) for name, values in fields.items()},
        stretch=spread(w[at], known),
        remaining=spread(left[at], known),
        along=along,
        frozen=frozen,
        dried=dried,
        air=air,
        at=at,
        known=known,
        attributes=attributes,
        remarks=remarks,
    )


def spread(values: FloatArray, known: BoolArray) -> FloatArray:
    """Values at the known places, NaN (or False) elsewhere; further dimensions stay."""
    if known.all():
        return values
    full = np.full((*known.shape, *values.shape[1:]), False if values.dtype == bool else np.nan, dtype=values.dtype)
    full[known] = values
    return full


def _samples(scene: Scene, jet: "StraightJet | LagrangianJet", place: FloatArray) -> FloatArray:
    """The result's places, and more between them where they are few."""
    least = int(_LEAST * max(1.0, (_COARSE / scene.accuracy.rtol) ** 0.5))  # second order in the spacing
    if not isinstance(jet, StraightJet) or place.size >= least:
        return place
    inner = jet_grid(jet, float(place[-1]), least)[1:-1]
    # places of the result stay as they are; a sample closer than rounding to one of them is none
    near = place[np.clip(np.searchsorted(place, inner), 0, place.size - 1)]
    before = place[np.clip(np.searchsorted(place, inner) - 1, 0, place.size - 1)]
    gap = np.minimum(np.abs(near - inner), np.abs(inner - before))
    return np.union1d(place, inner[gap > 1e-6 * np.minimum(inner - place[0], jet.initial_radius)])


def _dried(
    scene: Scene,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    effects: Effects,
    x: FloatArray,
    profile: dict[str, FloatArray],
    known: BoolArray,
    glass: float,
) -> "tuple[Air | None, Dried | None]":
    if not effects.evaporation:
        return None, None
    from spinline.setup.air import build_air

    air = build_air(scene, solution)
    age = None if isinstance(jet, StraightJet) else profile["residence_time"][known]
    law = diffusion_law(scene) if effects.radial else None
    path = element_path(jet, x, age)
    return air, dry(path, solution, air, law, glass=glass, cells=scene.accuracy.shells)


def _kinematics(
    jet: "StraightJet | LagrangianJet",
    profile: dict[str, FloatArray],
    known: BoolArray,
    x: FloatArray,
    dried: Dried | None,
    left: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray | None]:
    """Age, material stretch, radius, velocity and strain rate (None along beads) of the jet as it dries."""
    if not isinstance(jet, StraightJet):
        time = profile["residence_time"][known]
        if not np.isfinite(time).all():
            raise InputError(
                "jet",
                "has no velocities: the age of its elements is not known",
                remedy="give the velocity of the beads",
            )
        stretch = profile["stretch_ratio"][known]
        return time, stretch, profile["radius"][known] * np.sqrt(left), profile["velocity"][known], None
    time, stretch, velocity = jet.residence_time(x), jet.stretch_ratio(x), jet.velocity(x)
    rate = jet.strain_rate(x)
    radius = jet.radius(x)
    if dried is None:
        return time, stretch, radius, velocity, rate
    if dried.path.given == "velocity":
        return time, stretch, radius * np.sqrt(left), velocity, rate
    slower = 0.5 * (1 / left[1:] + 1 / left[:-1])
    time = np.concatenate((time[:1], time[0] + np.cumsum(np.diff(time) * slower)))
    return time, stretch * left, radius, velocity * left, np.gradient(velocity * left, x)


def _material_fields(material: Material, fraction: FloatArray) -> dict[str, FloatArray]:
    """Viscosity and relaxation time where they are known."""
    fields: dict[str, FloatArray] = {}
    if material.solution.viscosity is not None or material.laws.law == "martin":
        fields["viscosity"] = material.viscosity(fraction)
    if material.solution.relaxation_time is not None:
        fields["relaxation_time"] = material.relaxation_time(fraction)
    return fields


def _relaxed(
    scene: Scene,
    material: Material,
    time: FloatArray,
    stretch: FloatArray,
    fraction: FloatArray,
    radius: FloatArray,
    rate: FloatArray | None,
) -> tuple[FloatArray, dict[str, FloatArray], str]:
    """Stretch w, what goes with it, and the model."""
    from spinline.network_models.conformation import stretch_strands

    model = constitutive_model(scene, material)
    state = stretch_strands(material, model, time, stretch, fraction, radius, rate)
    assert material.solution.relaxation_time is not None
    found = {
        "weissenberg_number": state.weissenberg,
        "deborah_number": state.weissenberg / state.relaxation_time * material.solution.relaxation_time,
    }
    if state.stress is not None and state.radial_stress is not None and state.tensile_force is not None:
        found |= {"stress": state.stress, "radial_stress": state.radial_stress, "tensile_force": state.tensile_force}
    return state.stretch, found, repr(model)


def _frozen(
    scene: Scene,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    along: Along,
    dried: Dried,
    air: "Air",
    glass: float,
    why: str,
) -> Frozen:
    nan = float("nan")
    places = {"frozen": (nan, nan)}
    never = "where it would is not known"
    if not np.isnan(glass):
        if glass >= air.equilibrium:
            never = f"drying ends at phi = {air.equilibrium:.4g}"
        places["frozen"] = where_mean_reaches(dried, air, solution, jet, glass)
    if dried.radial is not None:
        surface, axis = dried.radial.vitrified_at if not np.isnan(glass) else (nan, nan)
        places |= {"skin": (surface, surface), "core": (axis, axis)}

    def conformation(w: float) -> tuple[float, float]:
        walk = network_state(
            w,
            w,
            solution.volume_fraction,
            closure=scene.network.closure_used,
            solvent_quality=scene.network.solvent_quality,
        ).conformation
        return float(walk.relative_extension), float(walk.orientation)

    return freeze(along, places, glass, why, conformation, never)
