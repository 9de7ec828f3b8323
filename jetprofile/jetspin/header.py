"""What a run was set up with: ``log.txt`` (the terminal output) and ``input.dat``.

The XYZ files do not say which length unit they are in, nor the nozzle radius: both come from here.
"""

import re
from collections.abc import Callable
from functools import lru_cache
from os import PathLike
from pathlib import Path
from typing import Any

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.content import content_of
from spinline.jetprofile.jetspin.folder import Folder
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import (
    RunParameters,
    merge_parameters,
    tells_anything,
    with_internal_units,
)
from spinline.jetprofile.jetspin.units import si_unit, to_floats

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
_NUMBER = re.compile(r"(?:[^ ]* )*?([+-]?\.?\d[^ ]*)")  # the first word that begins as one
_VERSION = re.compile(r"Version\s+([0-9][^\s(]*)")
_RUN = "\nStart simulation"
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
_OFF = dict.fromkeys(_SWITCHES.values(), False)
_Values = dict[str, Any]


def parse_log(text: str, source: str, notes: Notes) -> RunParameters:
    """Read the set-up JETSPIN echoes to the terminal."""
    found: _Values = {}
    pairs: list[tuple[str, str]] = []
    version = _VERSION.search(text)
    if version is not None:
        found["version"] = version[1]
    inside = ended = False
    for line in text[: _end_of_setup(text)].splitlines():
        first = line[:1]
        if first in "*":  # empty, or of the banner
            continue
        if first in "SFT" and line.startswith(_MARKS):
            if line.startswith("Start simulation"):
                break
            if line.startswith("Start printing input"):
                inside = True
            elif line.startswith("Finish printing input"):
                inside, ended = False, True
            elif line.startswith("The 'resolution' value is equal to"):
                value = line[34:].split()
                if value and line[34].isspace():
                    pairs.append(("resolution", value[0]))
        elif not inside and " unit" not in line:  # as all internal units end
            continue
        name, equals, rest = line.partition("=")
        field = _printed(name, inside) if equals else None
        words = None if field is None else rest.split(None, 1)
        if field is not None and words:
            pairs.append((field, words[0]))
        elif inside and not rest.strip():
            _switch(found, line)
    return _finish(found, pairs, source, ended, notes)


def _end_of_setup(text: str) -> int:
    """Where the first line "Start simulation" begins, or the end; the table below it is long, and begins with a #."""
    table = text.find("#")
    run = text.rfind(_RUN, 0, table) if table >= 0 else -1
    if run < 0:
        run = text.find(_RUN)
    return run if run >= 0 else len(text)


def parse_input(text: str, source: str, notes: Notes) -> RunParameters:
    """Read the directives of an ``input.dat``."""
    found: _Values = {}
    pairs: list[tuple[str, str]] = []
    ended = False
    for raw in text.splitlines():
        line = " ".join(raw[:150].split("!")[0].split("#")[0].split()).lower()
        if line.startswith("finish"):
            ended = True
            break
        _switch(found, line)
        field = _named(line, 1)
        number = _NUMBER.match(line) if field is not None else None
        if field is not None and number is not None:
            pairs.append((field, number[1]))
    return _finish(found, pairs, source, ended, notes)


@lru_cache(maxsize=512)
def _named(name: str, column: int) -> str | None:
    """Field of a name in ``log.txt`` (column 0) or ``input.dat`` (1); runs of one program repeat them."""
    known = _NAMES[column].match(name)
    return None if known is None else known.lastgroup


@lru_cache(maxsize=512)
def _printed(name: str, inside: bool) -> str | None:
    """Field of what stands before a "=" in ``log.txt``; outside the echoed input only internal units."""
    name = name.strip()
    internal = _INTERNAL.get(name)
    return internal[0] if internal is not None else _named(name, 0) if inside else None


def _switch(found: _Values, line: str) -> None:
    if not line.startswith(_SWITCH_NAMES):
        return
    for name, field in _SWITCHES.items():
        words = line[len(name) :].split() if line.startswith(name) else []
        if words and words[0] in ("yes", "no"):
            found[field] = words[0] == "yes"


def _store(found: _Values, pairs: list[tuple[str, str]], notes: Notes) -> None:
    """The numbers of fields in SI; of a field given twice the later one, and none if that cannot be."""
    for (field, value), number in zip(pairs, to_floats([value for _, value in pairs]), strict=True):
        factor = _FACTORS[field]
        unusable = not abs(number) < 1e30 or (number <= 0 and field in _POSITIVE)
        if unusable or (factor is None and number != int(number)):
            notes.add(f"{field.replace('_', ' ')} = {value[:30]} cannot be right and is not used")
            found.pop(field, None)
        else:
            found[field] = int(number) if factor is None else number * factor


def _finish(found: _Values, pairs: list[tuple[str, str]], source: str, ended: bool, notes: Notes) -> RunParameters:
    _store(found, pairs, notes)
    if ended:  # the whole was seen: a switch not met is off
        found = {**_OFF, **found}
    if "resolution" not in found and "initial_length" in found and "points" in found:
        found["resolution"] = found["initial_length"] / found["points"]
    return with_internal_units(RunParameters(source=source, complete=ended, **found), notes)


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
    params = find_parameters(Folder(path, listed=False), notes) if path.is_dir() else parse_file(path, notes)
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
    return bytes(content_of(path)[:limit]).decode("utf-8", errors="replace")


def find_parameters(folder: Folder, notes: Notes) -> RunParameters | None:
    """Set-up of the run in `folder`, from ``log.txt`` and ``input.dat``."""
    there = (folder.file(name) for name in ("log.txt", "input.dat"))
    sets = [parse_file(path, notes) for path in there if path is not None]
    return merge_parameters([params for params in sets if tells_anything(params)], notes)
