"""The parameter block at the beginning of ``traj.dat`` and ``save.dat`` (JETSPIN 1.21, CGS)."""

import math
import struct

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.fortran import read_record
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters
from spinline.jetprofile.jetspin.units import CM, STATCOULOMB, STATVOLT

__all__ = ["BLOCK_BYTES", "SYSTEMS", "parse_block"]

_BLOCK = (4, 24, 16, 56, 56, 72, 32, 40, 4, 96, 12, 96, 96, 96, 48, 48, 48, 96)
BLOCK_BYTES = sum(_BLOCK) + 8 * len(_BLOCK)
SYSTEMS = (1, 2, 3, 4)
_PASCAL = 0.1  # g cm^-1 s^-2


def parse_block(content: bytes, name: str, notes: Notes) -> RunParameters:
    """Read the parameter block at the beginning of ``traj.dat`` or ``save.dat``, and check it against itself.

    Raises
    ------
    InputError
        If it is not a block of version 1.21, or so damaged that its scales are in doubt.
    """
    bodies: list[bytes] = []
    at = damaged = 0
    for size in _BLOCK:
        body = read_record(content, at, size)
        damaged += body is None
        if len(content) < at + size + 8 or damaged > 2:
            raise _not_jetspin(name, content)
        bodies.append(content[at + 4 : at + 4 + size])
        at += size + 8
    notes.add("{n} record markers in the parameter block are damaged", damaged)
    # damaged numbers overflow here; what they give is compared with the block's own scales and refused
    with np.errstate(over="ignore", divide="ignore", invalid="ignore", under="ignore"):
        return _block_values(bodies, name, notes)


def _block_values(bodies: list[bytes], name: str, notes: Notes) -> RunParameters:
    step, initial, density, charge_density, radius, nozzle_stress, nozzle_velocity = _reals(bodies[3])
    frequency, amplitude = _reals(bodies[4])[:2]
    viscosity, modulus, yield_stress, collector, potential, tension, timestep = _reals(bodies[5])[:7]
    mass, charge, length, tau = _reals(bodies[6])
    systems = [int.from_bytes(bodies[1][8:12], "little"), int.from_bytes(bodies[2][4:8], "little")]
    system = next((value for value in systems if value in SYSTEMS), None)
    if systems[0] != systems[1]:
        notes.add("the parameter block contradicts itself about the dimension")
    groups = _reals(bodies[9])
    area = math.pi * radius**2
    expected = {
        "mass": (mass, density * area * step),
        "charge": (charge, charge_density * area * step),
        "length": (length, abs(charge_density * area * step) / np.sqrt(area * modulus)),
        "time": (tau, np.float64(viscosity) / modulus),
        "collector distance": (groups[4] * length, collector),
        "resolution": (groups[5] * length, step),
    }
    wrong = [key for key, (given, value) in expected.items() if not abs(given - value) <= 1e-6 * abs(value)]
    if not all(0 < value < 1e30 for value in (mass, length, tau, modulus, radius, step, collector)):
        wrong.append("range")
    if wrong:
        raise InputError(
            name,
            f"its parameter block contradicts itself ({', '.join(wrong)}): it is damaged, or not in the CGS "
            "units of JETSPIN 1.21",
            remedy="read frame*.xyz or traj.xyz with the log.txt of the run instead",
        )
    settings, counters = _reals(bodies[17]), np.frombuffer(bodies[14], "<i4")
    return RunParameters(
        source=name,
        system=system,
        nozzle_radius=radius * CM,
        resolution=step * CM,
        initial_length=initial * CM,
        density=density * 1e3,
        charge_density=charge_density * STATCOULOMB / CM**3,
        viscosity=viscosity * _PASCAL,
        elastic_modulus=modulus * _PASCAL,
        collector_distance=collector * CM,
        potential=potential * STATVOLT,
        surface_tension=tension * 1e-3,
        nozzle_velocity=nozzle_velocity * CM,
        nozzle_stress=nozzle_stress * _PASCAL,
        yield_stress=yield_stress * _PASCAL,
        perturbation_amplitude=amplitude * CM,
        perturbation_frequency=frequency,
        timestep=timestep,
        inserting=bool(struct.unpack("<i", bodies[10][8:12])[0]),
        refinement=True if counters[6] > 0 or settings[9] > 0 or settings[10] > 0 else None,
        length_unit=length * CM,
        time_unit=tau,
        stress_unit=modulus * _PASCAL,
        mass_unit=mass * 1e-3,
        charge_unit=charge * STATCOULOMB,
    )


def _reals(body: bytes) -> list[float]:
    return [float(value) for value in np.frombuffer(body, "<f8")]


def _not_jetspin(name: str, content: bytes) -> InputError:
    if content[:4] == b"\0\0\0\4":
        return InputError(
            name,
            "written on a big-endian machine, which is not read",
            remedy="convert its 4-byte words, or read the XYZ files of the run",
        )
    if len(content) < BLOCK_BYTES:
        return InputError(
            name,
            f"ends after {len(content)} bytes, inside its parameter block",
            remedy="read the XYZ files of the run",
        )
    return InputError(
        name,
        "not the parameter block of a JETSPIN 1.21 traj.dat or save.dat (its records have other sizes)",
        remedy="read frame*.xyz or traj.xyz with log.txt instead",
    )
