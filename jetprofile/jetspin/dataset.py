"""Beads to a Dataset: numbered from the nozzle, padded, with radius, stretch ratio and flags.

Element i joins bead i and bead i + 1. What JETSPIN keeps with a bead but which belongs to the piece of jet
between it and the next bead towards the nozzle (its volume, its stress) lies on `element`.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.named_arrays import NamedArrays
from spinline.jetprofile.jetspin.checks import check_content, check_motion, check_positions, distance, find_strays
from spinline.jetprofile.jetspin.frames import Block, Floats, Padder
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters

__all__ = ["Meaning", "build_dataset"]

_MEANINGS: dict[str, tuple[str, str, str]] = {
    "x": ("bead", "m", "position along the spinning axis, nozzle at 0"),
    "y": ("bead", "m", "first lateral position"),
    "z": ("bead", "m", "second lateral position"),
    "arc_length": ("bead", "m", "distance from the nozzle along the jet"),
    "velocity_x": ("bead", "m s-1", "velocity along the spinning axis"),
    "velocity_y": ("bead", "m s-1", "first lateral velocity"),
    "velocity_z": ("bead", "m s-1", "second lateral velocity"),
    "velocity": ("bead", "m s-1", "speed"),
    "mass": ("bead", "kg", "mass of the bead"),
    "charge": ("bead", "C", "charge of the bead"),
    "deposited": ("bead", "", "bead has reached the collector"),
    "element_length": ("element", "m", "length of the element between bead i and bead i + 1"),
    "element_arc_length": ("element", "m", "distance of the element's middle from the nozzle along the jet"),
    "radius": ("element", "m", "radius of the jet"),
    "stretch_ratio": ("element", "1", "length of the element over its length at the nozzle radius"),
    "strain_rate": ("element", "s-1", "rate of elongation of the element, (dv . t)/l"),
    "stress": ("element", "Pa", "viscoelastic axial stress"),
    "volume": ("element", "m3", "volume of the element"),
    "valid_element": (
        "element",
        "",
        "element is whole: not laid down, not damaged, not beside a damaged bead",
    ),
    "n_bead": ("", "1", "number of beads stored"),
    "nozzle_missing": (
        "",
        "",
        "beads next to the nozzle are not in the file; bead 0 is the nearest one stored",
    ),
    "inserted": ("", "", "the bead nearest the nozzle has been inserted"),
}
_NAMED = {  # dimensions and attributes of every variable
    name: (("time", dim) if dim else ("time",), {"long_name": text} | ({"units": unit} if unit else {}))
    for name, (dim, unit, text) in _MEANINGS.items()
}
_TIME = {"units": "s", "long_name": "time"}


@dataclass
class Meaning:
    """What is known about a run beside its beads.

    `position_error` is half a unit in the last decimal of the file (m); `text` tells that the file holds only
    positions.
    """

    parameters: RunParameters
    position_error: float
    text: bool
    attrs: dict[str, Any]


def build_dataset(block: Block, meaning: Meaning, around: tuple[float, float], notes: Notes) -> NamedArrays:
    """Variables of the frames in `block`; `around` is the sharpest kink of the frames before and after them.

    Positions that cannot be are NaN; elements that touch them, deposited beads or damaged rows keep their
    values, where they have one, and `valid_element` is False. From a bead that is NaN outwards, `arc_length`
    is NaN.
    """
    pad = Padder(block)
    bead = pad.positions()
    bad = pad.bad()
    p = meaning.parameters
    deposited, odd = check_positions(bead, pad.there, meaning.position_error, p, notes)
    length = distance(bead, 1)
    bad |= odd | find_strays(bead, length, deposited, around, notes)
    coincident, safe = length <= 0, length
    if coincident.any():
        notes.add(
            "{n} elements of no length (coincident beads) have no radius",
            np.count_nonzero(coincident),
            warn=False,
            dropped=True,
        )
        away = np.count_nonzero(coincident > deposited[:, 1:])
        notes.add("{n} elements of no length away from the collector", away)
        safe = np.where(coincident, np.nan, length)
    volume = pad("volume")[:, 1:] if "volume" in pad else None
    if volume is not None:
        bad |= check_content(pad, p, notes)
    if "velocity_x" in pad:
        bad |= check_motion(pad, notes)
    at_rest = _rest_length(volume, meaning)
    bad |= deposited
    invalid = bad[:, 1:] | bad[:, :-1] | coincident
    out: dict[str, NDArray[Any]] = dict(zip("xyz", bead, strict=True))
    out["arc_length"] = arc = _arc_length(bead, length, block.reaches_nozzle)
    out["element_length"] = length
    out["element_arc_length"] = 0.5 * (arc[:, 1:] + arc[:, :-1])
    stretch = safe / at_rest
    radius_at_rest = math.nan if p.nozzle_radius is None else p.nozzle_radius
    out["stretch_ratio"] = stretch
    out["radius"] = radius_at_rest / np.sqrt(stretch)
    if "velocity_x" in pad:
        for axis in "xyz":
            out[f"velocity_{axis}"] = pad(f"velocity_{axis}")
        speeds = [out[f"velocity_{axis}"] for axis in "xyz"]
        out["velocity"] = np.sqrt(speeds[0] ** 2 + speeds[1] ** 2 + speeds[2] ** 2)
        rate = sum(np.diff(v, axis=1) * np.diff(x, axis=1) for v, x in zip(speeds, bead, strict=True))
        out["strain_rate"] = rate / safe**2
    if "stress" in pad:
        out["stress"] = pad("stress")[:, 1:]
    if volume is not None:
        out["volume"] = volume
    for name in ("mass", "charge"):
        if name in pad:
            out[name] = pad(name)
    out["deposited"] = deposited
    out["valid_element"] = np.isfinite(length) > invalid  # and of no other beads than are there
    out["n_bead"] = block.length.astype(np.int32)
    out["nozzle_missing"] = ~block.reaches_nozzle
    if block.inserted is not None:
        out["inserted"] = block.inserted
    variables = {name: (_NAMED[name][0], values, _NAMED[name][1]) for name, values in out.items()}
    return NamedArrays(variables, {"time": ("time", block.time, _TIME)}, meaning.attrs)


def _arc_length(bead: Floats, length: Floats, reaches_nozzle: NDArray[np.bool_]) -> Floats:
    """Distance of every bead from the nozzle along the jet, NaN where it cannot be known."""
    arc = np.zeros(bead[0].shape)
    length.cumsum(axis=1, out=arc[:, 1:])
    arc[~reaches_nozzle] = np.nan
    arc[np.isnan(bead[0])] = np.nan
    return arc


def _rest_length(volume: Floats | None, meaning: Meaning) -> Floats | float:
    """Length of an element at the radius of the nozzle, NaN where it cannot be known."""
    p = meaning.parameters
    if volume is not None and p.nozzle_radius is not None:
        return np.where(volume > 0, volume, np.nan) / (math.pi * p.nozzle_radius**2)
    if p.resolution is None or p.refinement:
        return math.nan
    return p.resolution
