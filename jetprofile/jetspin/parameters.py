"""Parameters of a run, and what several files say about them."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace

from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.units import CM, si_unit

__all__ = ["RunParameters", "merge_parameters", "tells_anything", "with_internal_units"]


@dataclass(frozen=True)
class RunParameters:
    """Parameters of a JETSPIN run, SI; None where the file does not say.

    `length_unit`, `time_unit`, `stress_unit`, `mass_unit` and `charge_unit` are JETSPIN's internal units.
    `complete` tells that the whole set-up was seen, so that a directive not met was not given.
    """

    source: str = ""
    complete: bool = False
    version: str | None = None
    system: int | None = None
    points: int | None = None
    nozzle_radius: float | None = None
    resolution: float | None = None
    initial_length: float | None = None
    density: float | None = None
    charge_density: float | None = None
    viscosity: float | None = None
    elastic_modulus: float | None = None
    collector_distance: float | None = None
    potential: float | None = None
    surface_tension: float | None = None
    nozzle_velocity: float | None = None
    nozzle_stress: float | None = None
    yield_stress: float | None = None
    perturbation_amplitude: float | None = None
    perturbation_frequency: float | None = None
    air_velocity: float | None = None
    timestep: float | None = None
    final_time: float | None = None
    xyz_interval: float | None = None
    frame_interval: float | None = None
    xyz_rescale: float | None = None
    maxnumber: int | None = None
    refinement: bool | None = None
    inserting: bool | None = None
    removing: bool | None = None
    length_unit: float | None = None
    time_unit: float | None = None
    stress_unit: float | None = None
    mass_unit: float | None = None
    charge_unit: float | None = None

    @property
    def dimension(self) -> int | None:
        """1 for a straight jet (systems 1 and 2), 3 otherwise."""
        if self.system is None:
            return None
        return 1 if self.system in (1, 2) else 3

    @property
    def element_volume(self) -> float | None:
        """Volume of an element as it leaves the nozzle, m3."""
        if self.nozzle_radius is None or self.resolution is None:
            return None
        return math.pi * self.nozzle_radius**2 * self.resolution


_FIELDS = [field.name for field in fields(RunParameters) if field.name not in ("source", "complete", "version")]


def with_internal_units(params: RunParameters, notes: Notes) -> RunParameters:
    """Fill in the internal units from the set-up, or compare them with it."""
    volume, charge_density = params.element_volume, params.charge_density
    expected: dict[str, float] = {}
    if params.elastic_modulus is not None:
        expected["stress_unit"] = params.elastic_modulus
        if params.viscosity is not None:
            expected["time_unit"] = params.viscosity / params.elastic_modulus
    if volume is not None and params.density is not None:
        expected["mass_unit"] = volume * params.density
    if volume is not None and charge_density is not None:
        expected["charge_unit"] = volume * charge_density
        if params.elastic_modulus is not None and params.nozzle_radius is not None:
            statc = expected["charge_unit"] / si_unit("statC")[0]
            r0, modulus = params.nozzle_radius / CM, params.elastic_modulus / si_unit("g cm^-1 s^-2")[0]
            expected["length_unit"] = abs(statc) / math.sqrt(math.pi * r0**2 * modulus) * CM
    missing: dict[str, float] = {}
    for name, value in expected.items():
        printed = getattr(params, name)
        if not 0 < value < 1e30:
            continue
        if printed is None:
            missing[name] = value
        elif abs(printed - value) > 1e-6 * value:
            label = name.replace("_", " ")
            notes.add(
                f"internal {label} in {params.source} ({printed:.9g}) contradicts the set-up there ({value:.9g}, SI)"
            )
    return replace(params, **missing) if missing else params  # type: ignore[arg-type]


def merge_parameters(sets: Iterable[RunParameters], notes: Notes) -> RunParameters | None:
    """Join what several files say; the first one wins, contradictions are noted."""
    merged: RunParameters | None = None
    for params in sets:
        if merged is None:
            merged = params
            continue
        taken: dict[str, object] = {
            "version": merged.version or params.version,
            "source": f"{merged.source}, {params.source}",
            "complete": merged.complete or params.complete,
        }
        for name in _FIELDS:
            mine, other = getattr(merged, name), getattr(params, name)
            if other is None or mine == other:
                continue
            if mine is None:
                differs = merged.complete and params.complete and name == "xyz_rescale"
                if not differs:
                    taken[name] = other
            else:
                differs = abs(float(mine) - float(other)) > 1e-6 * max(abs(float(mine)), abs(float(other)))
            if differs:
                notes.add(
                    f"{merged.source} and {params.source} disagree about {name.replace('_', ' ')} "
                    f"({mine} and {other}, SI); {merged.source} is believed"
                )
        merged = replace(merged, **taken)  # type: ignore[arg-type]
    return merged


def tells_anything(params: RunParameters) -> bool:
    """Whether a set of parameters holds any."""
    return any(getattr(params, name) not in (None, False) for name in _FIELDS)
