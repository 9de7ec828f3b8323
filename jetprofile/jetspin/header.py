"""What a run was set up with: ``log.txt`` (the terminal output) and ``input.dat``.

The XYZ files do not say which length unit they are in, nor the nozzle radius: both come from here.
"""

import os
import re
from collections.abc import Callable
from dataclasses import fields, replace
from functools import lru_cache
from os import PathLike
from pathlib import Path

from spinline.base.errors import InputError
from spinline.base.files import readable
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import (
    RunParameters,
    merge_parameters,
    tells_anything,
    with_internal_units,
)
from spinline.jetprofile.jetspin.units import si_unit, to_float

__all__ = ["find_parameters", "parse_file", "parse_input", "parse_log", "read_parameters"]


# field: (beginning in log.txt, beginning in input.dat, unit)
_VALUES: dict[str, tuple[str, str, str]] = {
    "points": ("points of jet", "point", "n"),
    "system": ("system", "system", "n"),
    "nozzle_radius": ("nozzle cross", "nozzle cross", "cm"),
    "initial_length": ("initial length", "initial length", "cm"),
    "resolution": ("resolution", "resolution", "cm"),
    "density": ("density mass", "density mass", "g cm^-3"),
    "charge_density": ("density charge", "density charge", "statC cm^-3"),
    "viscosity": ("viscosity", "viscosity", "g cm^-1 s^-1"),
    "elastic_modulus": ("elastic modulus", "elastic modul", "g cm^-1 s^-2"),
    "collector_distance": ("collector dist", "collector dist", "cm"),
    "potential": ("external potential", "external potential", "statV"),
    "surface_tension": ("surface tension", "surface tension", "g s^-2"),
    "nozzle_velocity": ("nozzle velocity", "nozzle velocity", "cm s^-1"),
    "nozzle_stress": ("nozzle stress", "nozzle stress", "g cm^-1 s^-2"),
    "yield_stress": ("yield stress", "yield stress", "g cm^-1 s^-2"),
    "perturbation_frequency": ("nozzle perturbation freq", "perturbation freq", "s^-1"),
    "perturbation_amplitude": ("nozzle perturbation ampl", "perturbation ampl", "cm"),
    "air_velocity": ("airdrag airvelocity", "airdrag airvelocity", "cm s^-1"),
    "timestep": ("timestep", "timestep", "s"),
    "final_time": ("final time", "final time", "s"),
    "xyz_rescale": ("print xyz file rescaled", "print xyz rescalexyz", ""),
    "maxnumber": ("print xyz maxnumber", "print xyz maxnumber", "n"),
    "frame_interval": ("print a single xyz", "print xyz frame", "s"),
    "xyz_interval": ("print xyz file every", "print xyz", "s"),
}
_INTERNAL = {
    "Time unit": ("time_unit", "s"),
    "Length unit": ("length_unit", "cm"),
    "Stress unit": ("stress_unit", "g cm^-1 s^-2"),
    "Mass unit": ("mass_unit", "g"),
    "Charge unit": ("charge_unit", "statC"),
}
# field: factor to SI, None where it is a whole number
_FACTORS = {
    field: None if unit == "n" else si_unit(unit)[0]
    for field, unit in [*((field, rule[2]) for field, rule in _VALUES.items()), *_INTERNAL.values()]
}
_NAMES = [re.compile("|".join(f"(?P<{field}>{re.escape(rule[k])})" for field, rule in _VALUES.items())) for k in (0, 1)]
_MARKS = ("Start ", "Finish ", "The 'resolution'")
_SWITCHES = {"dynamic refinement": "refinement", "inserting": "inserting", "removing": "removing"}
_SWITCH_NAMES = tuple(_SWITCHES)
_POSITIVE = frozenset(
    [
        "points",
        "nozzle_radius",
        "initial_length",
        "resolution",
        "density",
        "viscosity",
        "elastic_modulus",
        "collector_distance",
        "timestep",
        "final_time",
        "xyz_interval",
        "frame_interval",
        "maxnumber",
        "length_unit",
        "time_unit",
        "stress_unit",
        "mass_unit",
        "charge_unit",
        "system",
    ]
)
_FIELDS = frozenset(field.name for field in fields(RunParameters))
_Values = dict[str, object]


def parse_log(text: str, source: str, notes: Notes) -> RunParameters:
    """Read the set-up JETSPIN echoes to the terminal."""
    found: _Values = {}
    version = re.search(r"Version\s+([0-9][^\s(]*)", text)
    if version is not None:
        found["version"] = version[1]
    inside = ended = False
    run = text.find("\nStart simulation")
    for line in (text if run < 0 else text[:run]).splitlines():
        if line[:1] in "*":  # empty, or of the banner
            continue
        if line.startswith(_MARKS):
            if line.startswith("Start simulation"):
                break
            if line.startswith("Start printing input"):
                inside = True
            elif line.startswith("Finish printing input"):
                inside, ended = False, True
            elif line.startswith("The 'resolution' value is equal to"):
                value = line[34:].split()
                if value and line[34].isspace():
                    _store(found, "resolution", value[0], notes)
        name, equals, rest = line.partition("=")
        words = rest.split(None, 1) if equals else []
        if words:
            name = name.strip()
            internal = _INTERNAL.get(name)
            if internal is not None:
                _store(found, internal[0], words[0], notes)
            elif inside:
                _lookup(found, name, words[0], 0, notes)
        elif inside:
            _switch(found, line)
    return _finish(found, source, ended, notes)


def parse_input(text: str, source: str, notes: Notes) -> RunParameters:
    """Read the directives of an ``input.dat``."""
    found: _Values = {}
    ended = False
    for raw in text.splitlines():
        line = " ".join(raw[:150].split("!")[0].split("#")[0].split()).lower()
        if line.startswith("finish"):
            ended = True
            break
        words = line.split()
        numbers = [word for word in words if re.match(r"[+-]?\.?\d", word)]
        _switch(found, line)
        if numbers:
            _lookup(found, line, numbers[0], 1, notes)
    return _finish(found, source, ended, notes)


def _lookup(found: _Values, name: str, value: str, column: int, notes: Notes) -> None:
    field = _named(name, column)
    if field is not None:
        _store(found, field, value, notes)


@lru_cache(maxsize=512)
def _named(name: str, column: int) -> str | None:
    """Field of a name in ``log.txt`` (column 0) or ``input.dat`` (1); runs of one program repeat them."""
    known = _NAMES[column].match(name)
    return None if known is None else known.lastgroup


def _switch(found: _Values, line: str) -> None:
    if not line.startswith(_SWITCH_NAMES):
        return
    for name, field in _SWITCHES.items():
        words = line[len(name) :].split() if line.startswith(name) else []
        if words and words[0] in ("yes", "no"):
            found[field] = words[0] == "yes"


def _store(found: _Values, field: str, value: str, notes: Notes) -> None:
    number, factor = to_float(value), _FACTORS[field]
    unusable = not abs(number) < 1e30 or (number <= 0 and field in _POSITIVE)
    if unusable or (factor is None and number != int(number)):
        notes.add(f"{field.replace('_', ' ')} = {value[:30]} cannot be right and is not used")
        found.pop(field, None)
        return
    found[field] = int(number) if factor is None else number * factor


def _finish(found: _Values, source: str, ended: bool, notes: Notes) -> RunParameters:
    told = {name: value for name, value in found.items() if name in _FIELDS}
    if ended:  # the whole was seen: a switch not met is off
        told = {**dict.fromkeys(_SWITCHES.values(), False), **told}
    params = RunParameters(source=source, complete=ended, **told)  # type: ignore[arg-type]
    if params.resolution is None and params.initial_length is not None and params.points is not None:
        params = replace(params, resolution=params.initial_length / params.points)
    return with_internal_units(params, notes)


def read_parameters(path: str | PathLike[str]) -> RunParameters:
    """Read the set-up of a run.

    Parameters
    ----------
    path : path
        ``log.txt``, ``input.dat``, or the run directory that holds one of them or both.

    Returns
    -------
    RunParameters

    Raises
    ------
    InputError
        If there is neither.
    """
    path = Path(path)
    notes = Notes(str(path))
    params = find_parameters(path, notes) if path.is_dir() else parse_file(path, notes)
    if params is None or not tells_anything(params):
        raise InputError(str(path), "no JETSPIN set-up found", remedy="give log.txt, input.dat or their directory")
    notes.emit()
    return params


def parse_file(path: Path, notes: Notes) -> RunParameters:
    """Read one set-up file, log or input by its content."""
    text = read_text(path)
    reader: Callable[[str, str, Notes], RunParameters] = parse_log if is_log(text) else parse_input
    return reader(text, path.name, notes)


def is_log(text: str) -> bool:
    """Whether a text is JETSPIN's terminal output rather than its input."""
    return any(mark in text for mark in ("Start printing input file", "JETSPIN:", "Internal units:"))


def read_text(path: Path, limit: int = 2_000_000) -> str:
    """Read the beginning of a text file, which holds the set-up, whatever its bytes."""
    try:
        with readable(path).open("rb") as file:
            size = os.fstat(file.fileno()).st_size  # asked for more, it would first make room for all of that
            return file.read(min(limit, size)).decode("utf-8", errors="replace")
    except OSError as error:
        raise InputError(
            str(path), f"cannot be opened ({error.strerror})", remedy="check the path and its permissions"
        ) from None


def find_parameters(folder: Path, notes: Notes) -> RunParameters | None:
    """Set-up of the run in `folder`, from ``log.txt`` and ``input.dat``."""
    there = (os.path.join(folder, name) for name in ("log.txt", "input.dat"))
    sets = [parse_file(Path(path), notes) for path in there if os.path.isfile(path)]
    return merge_parameters([params for params in sets if tells_anything(params)], notes)
