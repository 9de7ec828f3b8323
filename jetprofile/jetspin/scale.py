"""Which length unit an XYZ file is in. The file does not say, and two files of one run always differ.

``traj.xyz`` is in internal units, or in cm times the factor of ``print xyz rescalexyz``; ``frame*.xyz`` is in
cm, or in cm times factor times the internal unit (JETSPIN applies it twice).
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.frames import Block, Floats
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters
from spinline.jetprofile.jetspin.units import CM

__all__ = ["Scale", "check_scale", "length_scale"]

_REMEDY = 'put the log.txt or input.dat of the run beside it, or give unit="cm", "internal" or metres'


@dataclass(frozen=True)
class Scale:
    """Metres per unit of the file, and how that is known."""

    metres: float
    source: str


def length_scale(
    name: str,
    kind: str | None,
    parameters: RunParameters | None,
    unit: str | float | None,
    track: tuple[Floats, Floats] | None,
    first: tuple[Floats, Floats],
) -> Scale:
    """Length unit of an XYZ file.

    Parameters
    ----------
    name : str
        The file, for messages.
    kind : {"traj", "frame", None}
        Which of the two writers wrote it.
    parameters : RunParameters or None
        Set-up of the run.
    unit : "cm", "internal", float or None
        Unit the caller vouches for.
    track : (times, x) or None
        Position of the first bead in ``statout.dat`` in order of time, m.
    first : (times, x)
        The same from the file, in its unit.
    """
    internal = None if parameters is None else parameters.length_unit
    if unit is not None:
        return _given(name, unit, internal)
    if parameters is not None and kind is not None:
        factor = parameters.xyz_rescale
        known = parameters.complete or factor is not None
        told = f"according to {parameters.source}"
        if known and factor is None and kind == "frame":
            return Scale(CM, f"cm (frame*.xyz without rescalexyz), {told}")
        if known and factor is not None and factor != 0 and kind == "traj":
            return Scale(CM / factor, f"cm times {factor:g} (rescalexyz), {told}")
        if known and internal is not None and factor is None:
            return Scale(internal, f"internal length unit of {internal:.9g} m, {told}")
        if known and internal is not None and factor:
            metres = CM / (factor * internal / CM)
            return Scale(metres, f"cm times {factor:g} times the internal length unit in cm (rescalexyz), {told}")
    ratio = None if track is None else _ratio(track, first)
    if ratio is not None:
        return Scale(ratio, f"column x of statout.dat at the same times ({ratio:.6g} m)")
    raise InputError(
        name,
        "its length unit is not known: the file does not say, and it differs between files",
        remedy=_REMEDY,
    )


def _given(name: str, unit: str | float, internal: float | None) -> Scale:
    if unit == "cm":
        return Scale(CM, "cm, given by the caller")
    if unit == "internal":
        if internal is None:
            raise InputError(
                "unit",
                f"the internal length unit of {name} is not known",
                value=unit,
                remedy="put log.txt beside it",
            )
        return Scale(internal, f"internal length unit of {internal:.9g} m, chosen by the caller")
    try:
        metres = float(unit)
    except (TypeError, ValueError):
        metres = np.nan
    if isinstance(unit, str) or not 0 < metres < 1e6:
        raise InputError("unit", "not a length unit", value=unit, allowed='"cm", "internal" or a length in metres')
    return Scale(metres, f"{metres:.9g} m, given by the caller")


def _ratio(track: tuple[Floats, Floats], first: tuple[Floats, Floats]) -> float | None:
    """Metres per unit from positions of the same bead at the same times; `track` is in order of time."""
    times, positions = track
    own_times, own = first
    if len(times) == 0 or len(own_times) == 0:
        return None
    last = len(times) - 1
    near = np.minimum(np.maximum(times.searchsorted(own_times), 1), max(last, 1)) - 1
    following = np.minimum(near + 1, last)
    closer = np.abs(times[following] - own_times) < np.abs(times[near] - own_times)
    near[closer] = following[closer]
    there = positions[near]
    same = np.abs(times[near] - own_times) <= 1e-6 * np.abs(own_times)
    same &= np.isfinite(own) & (own > 1e-3) & np.isfinite(there) & (there > 0)
    ratios = np.sort(there[same] / own[same])
    count = len(ratios)
    if count == 0:
        return None
    middle = 0.5 * float(ratios[(count - 1) // 2] + ratios[count // 2])
    agree = np.abs(ratios - middle) < 1e-2 * middle
    return middle if np.count_nonzero(agree) > 0.5 * count else None


def check_scale(metres: float, track: tuple[Floats, Floats] | None, first: tuple[Floats, Floats], notes: Notes) -> str:
    """Compare a unit with ``statout.dat``; the finding in words."""
    ratio = None if track is None else _ratio(track, first)
    if ratio is None:
        return ""
    if abs(ratio / metres - 1) > 1e-2:
        notes.add(
            f"column x of statout.dat says that its length unit is {ratio:.6g} m, not {metres:.6g} m: "
            "lengths are in doubt"
        )
        return f"; contradicted by statout.dat ({ratio:.6g} m)"
    return "; agrees with statout.dat"


def first_beads(block: Block) -> tuple[Floats, Floats]:
    """Time and x of the farthest bead of every frame."""
    return block.time, block.values["x"][block.first]
