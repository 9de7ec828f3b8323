"""The jet of a scene with ``profile = "blown"``: gas, solution, straight part, and the beads from there to the collector."""

import math
import warnings
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.errors import InputError, SpinlineWarning
from spinline.network.mesh import network_at_rest
from spinline.setup.values import given

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.blown.air import AirJet
    from spinline.jetprofile.blown.bead_jet import BeadRun, BeadStart, BlownBeads
    from spinline.jetprofile.blown.straight_jet import BlownJet, BlownSettings
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.rheology.solution import Solution
    from spinline.scene.blown import BlownJetSection
    from spinline.scene.file import Scene

__all__ = [
    "bead_options",
    "blown_dataset",
    "blown_jet",
    "blown_run",
    "blown_settings",
    "build_blown",
    "gas_of",
    "rows_of_jets",
]

_ATMOSPHERE, _GAS = 101325.0, 287.05
_ELEMENTS = 40  # radii of an element at the start, by default; less where the jet is drawn out faster


def gas_of(section: "BlownJetSection", scene: "Scene") -> "tuple[AirJet, tuple[str, ...]]":
    """The gas, and what is to be said of it.

    Raises
    ------
    InputError
        For a velocity that no plain nozzle gives, or air that moves twice.
    """
    from spinline.jetprofile.blown.air import AirJet
    from spinline.jetprofile.blown.gas_nozzle import nozzle_exit, subsonic
    from spinline.rheology.vapour import air_kinematic_viscosity

    ambient = scene.ambient
    if ambient is not None and ambient.air_velocity is not None:
        raise InputError(
            "ambient.air_velocity",
            "is given, and the air of a blown jet moves by its nozzle",
            value=ambient.air_velocity.text,
            remedy="take it out: jet.air_velocity or jet.pressure_ratio says it",
        )
    room = given(None if ambient is None else ambient.temperature, scene.solution.temperature.value)
    pressure = given(None if ambient is None else ambient.pressure, _ATMOSPHERE)
    total = given(section.gas_temperature, room)
    notes: tuple[str, ...] = ()
    diameter = section.nozzle_diameter.value
    try:
        if section.pressure_ratio is not None:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", SpinlineWarning)
                out = nozzle_exit(section.pressure_ratio.value, total, pressure)
            notes = tuple(str(one.message) for one in caught)
            speed, density, diameter = out.velocity, out.density, diameter * out.expanded_diameter
        else:
            assert section.air_velocity is not None
            speed = subsonic(section.air_velocity.value, total)
            density = pressure / (_GAS * (total - speed**2 / (2 * 1004.675)))
        air_density = pressure / (_GAS * room)
        gas = AirJet(
            diameter,
            speed,
            spread=section.spread.value,
            profile=section.gas_profile,
            intensity=section.turbulence_intensity.value,
            density=air_density,
            kinematic_viscosity=given(None if ambient is None else ambient.air_viscosity)
            or air_kinematic_viscosity(room, pressure),
            exit_density=density,
        )
    except InputError as error:
        keys = {"reservoir_temperature": "gas_temperature"}
        raise _of_jet(error, keys) from None
    if abs(total - room) > 20:
        notes += (
            f"the gas leaves its reservoir {total - room:+.3g} K from the room: it is taken with the room's density and "
            "viscosity beside the jet, and evaporation with ambient.temperature",
        )
    return gas, notes


def blown_settings(section: "BlownJetSection", scene: "Scene", solution: "Solution") -> "BlownSettings":
    """Settings of the straight part, in SI.

    Raises
    ------
    InputError
        For what the jet needs of the solution and was not given.
    """
    from spinline.jetprofile.blown.straight_jet import BlownSettings
    from spinline.jetprofile.blown.straight_results import BlownSolution

    if solution.viscosity is None:
        raise InputError("solution.viscosity", "is missing: a blown jet needs it", remedy="give it")
    theta = solution.relaxation_time
    law: Any = section.law
    if law == "auto":
        law = "newton" if theta is None else "fene-p"
    if theta is None and law != "newton":
        raise InputError(
            "solution.relaxation_time",
            f'is missing: jet.law = "{law}" needs it',
            remedy='give it, or jet.law = "newton" (which thins a polymer solution far too much)',
        )
    limit = 0.0
    if law == "fene-p":  # strands of Kuhn segments: (contour / mesh size)^2
        rest = network_at_rest(solution.volume_fraction, scene.network.solvent_quality)
        limit = given(section.extensibility) or float(rest.full_stretch) ** 2
    try:
        liquid = BlownSolution(
            section.flow_rate.value,
            section.radius.value,
            solution.density,
            solution.viscosity,
            section.surface_tension.value,
            relaxation_time=0.0 if law == "newton" or theta is None else theta,
            solvent_viscosity=0.0 if law in ("newton", "ucm") else section.solvent_share.value * solution.viscosity,
            extensibility=limit,
        )
    except InputError as error:
        raise _of_jet(error, {}) from None
    gas, _ = gas_of(section, scene)
    return BlownSettings(liquid, gas, section.length.value, law=law, drag=section.drag, gravity=section.gravity.value)


def blown_jet(section: "BlownJetSection", scene: "Scene", solution: "Solution") -> "BlownJet":
    """The straight part; kept, since a plan, a run and a trade of one scene ask for it in turn."""
    return _solved(blown_settings(section, scene, solution))


@lru_cache(maxsize=64)
def _solved(settings: "BlownSettings") -> "BlownJet":
    from spinline.jetprofile.blown.straight_jet import BlownJet

    return BlownJet(settings)


def bead_options(
    section: "BlownJetSection", jet: "BlownJet", *, index: int = 0, seed: int | None = None
) -> "tuple[BeadStart, BlownBeads]":
    """Where the beads begin, and what their run is asked for.

    Raises
    ------
    InputError
        Where bending waves have no place to travel, or the start lies before the only one.
    """
    from spinline.jetprofile.blown.bead_jet import BeadStart, BlownBeads

    z = jet.solved.bending_start if isinstance(section.start, str) else section.start.value
    if not math.isfinite(z):
        raise InputError(
            "jet.start",
            'is "auto", and c_b^2 < 0 along all of the straight part: nowhere may bending begin',
            remedy="give it a place, slower air, or a longer jet.length",
        )
    z = max(z, float(jet.solved.z[1]))
    there = jet.solved.at(z)
    start = BeadStart(z, there["radius"], there["axial_conformation"], there["radial_conformation"])
    stretching = there["velocity"] / max(float(jet.strain_rate(z)), 1e-300)
    element = given(section.element_length) or min(_ELEMENTS * there["radius"], 0.25 * stretching)
    return start, BlownBeads(
        element=element,
        longest=given(section.longest_element) or 2 * element,
        duration=section.time.value,
        cfl=section.cfl,
        drag=section.drag,
        lift=section.lift,
        gusts=section.turbulence_intensity.value > 0,
        seed=section.seed if seed is None else seed,
        index=index,
        amplitude=given(section.nozzle_amplitude) or 0.0,
        frequency=given(section.nozzle_frequency) or 0.0,
        gravity=section.gravity.value,
    )


def blown_run(
    scene: "Scene", solution: "Solution", *, frames: int = 40, index: int = 0, seed: int | None = None
) -> "tuple[BlownJet, BeadRun]":
    """Straight part and beads of one of a scene's jets; jet `index` has gusts of its own.

    Raises
    ------
    InputError
        For a scene without a collector, or a straight part that does not exist.
    """
    from spinline.jetprofile.blown.bead_jet import blown_beads
    from spinline.setup.collector import collector_of

    section: Any = scene.jet
    if scene.collector is None:
        raise InputError(
            "collector",
            "is missing: the beads of a blown jet fly to one",
            remedy='add [collector] with kind = "plate" and its distance',
        )
    jet = blown_jet(section, scene, solution)
    start, ask = bead_options(section, jet, index=index, seed=seed)
    liquid, air = jet.settings.solution, jet.settings.air
    try:
        with warnings.catch_warnings():  # the share of c_b^2 < 0 is in the result
            warnings.simplefilter("ignore", SpinlineWarning)
            run = blown_beads(liquid, air, start, collector_of(scene.collector), ask, frames=frames)
    except InputError as error:
        raise _of_jet(error, {"mesh": "element_length", "duration": "time", "longest": "longest_element"}) from None
    return jet, run


def rows_of_jets(scene: "Scene") -> list[float]:
    """Places of a scene's jets across the machine, m."""
    count, spacing = (1, 0.0) if scene.jets is None else (scene.jets.count, scene.jets.spacing.value)
    return [(k - (count - 1) / 2) * spacing for k in range(count)]


def blown_dataset(
    scene: "Scene",
    solution: "Solution",
    *,
    frames: int = 40,
    seed: int | None = None,
    about: dict[str, Any] | None = None,
) -> "xr.Dataset":
    """Beads of the first jet, and the landings of all of them side by side."""
    import xarray as xr

    from spinline.jetprofile.blown.bead_dataset import bead_frames

    records = []
    first: Any = None
    for index, place in enumerate(rows_of_jets(scene)):
        jet, run = blown_run(scene, solution, frames=frames if index == 0 else 0, index=index, seed=seed)
        landed = run.to_dataset()
        landed["z"] = landed["z"] + place
        records.append(landed)
        if first is None:
            first = bead_frames(jet, run)
    whole = records[0] if len(records) == 1 else _beside(records)
    whole = whole.rename_vars({name: f"landing_{name}" for name in whole.data_vars})
    below = float(np.mean([one.attrs["below_zero_wave_speed"] for one in records]))
    whole.attrs |= {"jets": len(records), "below_zero_wave_speed": below}
    return xr.merge([whole, first], combine_attrs="override").assign_attrs(
        whole.attrs | first.attrs | _collector_attributes(scene) | (about or {})
    )


def _collector_attributes(scene: "Scene") -> dict[str, Any]:
    from spinline.setup.collector import collector_of

    assert scene.collector is not None
    made = collector_of(scene.collector)
    found: dict[str, Any] = {"collector_kind": made.kind, "collector_distance": made.distance}
    if made.kind != "plate":
        found["collector_speed"] = made.surface_speed
    if made.kind == "drum":
        found["collector_radius"] = made.radius  # type: ignore[union-attr]
    return found


def _beside(records: "list[xr.Dataset]") -> "xr.Dataset":
    """Landings of several jets, each in the order of its fibre; what was fed and what flies added up."""
    import xarray as xr

    whole = xr.concat(records, "landing", combine_attrs="override")
    for name in ("volume_fed", "volume_in_flight", "volume_evaporated"):
        whole.attrs[name] = float(sum(one.attrs[name] for one in records))
    return whole


def build_blown(section: "BlownJetSection", scene: "Scene", solution: "Solution") -> "BlownJet | LagrangianJet":
    """The straight part, or with ``bending`` the last moment of the beads behind it."""
    if not section.bending:
        return blown_jet(section, scene, solution)
    from spinline.jetprofile.blown.bead_dataset import bead_frames
    from spinline.jetprofile.lagrangian import LagrangianJet

    jet, run = blown_run(scene, solution, frames=4)
    return LagrangianJet.from_dataset(bead_frames(jet, run)).at(None)


def _of_jet(error: InputError, keys: dict[str, str]) -> InputError:
    """The same error by the key of the scene."""
    name = error.field.split(".")[-1].replace(" ", "_")
    return InputError(
        f"jet.{keys.get(name, name)}", error.problem, value=error.value, allowed=error.allowed, remedy=error.remedy
    )
