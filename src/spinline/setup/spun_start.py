"""A spun jet whose charge moves: it starts as the steady straight jet of its needle, whole, its end on the plate.

The straight jet gives position, speed, conformation and charge of every element. From the needle (``start = "needle"``) the
chain begins at rest in itself, with the needle's potential; from a place downstream (``start = "straight-jet"``) with what the
straight jet has there: radius (yielding to the pull as the jet upstream does), conformation, potential, and the charge upstream
as a feed.
"""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.spun.settings import SpunSettings
from spinline.jetprofile.spun.straight import StraightStart

if TYPE_CHECKING:
    from spinline.jetprofile.ehd import NeedleSettings, StraightEhdJet

__all__ = ["CONE", "conducting"]

CONE = 10.0
"""Radii of the needle over which the charge's own potential goes from the local logarithm to the whole thread's."""
SETTLE = 20e-3
FEEDS = 8
SAMPLES = 4000
LATERAL = 1e-3


def conducting(settings: SpunSettings, needle: "NeedleSettings", position: float | None) -> SpunSettings:
    """`settings` with charge that moves, started on the straight jet of `needle`.

    Parameters
    ----------
    settings : SpunSettings
        Those of the same jet, charge left out.
    needle : NeedleSettings
        Bench and solution of the straight jet; its end is the plate.
    position : float, optional
        z in m where the chain starts; None: at the needle.

    Raises
    ------
    InputError
        Where the needle has no steady straight jet, or the position is not on it.
    """
    from spinline.jetprofile.ehd import NoSteadyJet, StraightEhdJet

    try:
        jet = StraightEhdJet(needle, length=needle.end_position)
    except NoSteadyJet as error:
        raise InputError(
            "jet.charge",
            f"is conducting, so the jet starts as its needle's steady straight one, and there is none: {error.text}",
            value="conducting",
            remedy=f'{error.remedy}; or charge = "frozen" by name, with charge_density or current',
        ) from None
    if position is None:
        axis = _axis(needle.end_position, needle.radius)
        start = _samples(jet, axis, 0.0)
        grid = replace(
            settings.grid, repulsion="hybrid", pressure=True, cone=CONE * needle.radius, settle=_settle(needle)
        )
        loads = replace(settings.loads, image=True, metal=settings.loads.kind != "uniform")
        return replace(
            settings, grid=grid, loads=loads, start=start, conductivity=needle.conductivity, current=needle.current
        )
    return _downstream(settings, jet, position)


def _settle(needle: "NeedleSettings") -> float:
    """A straight jet of the local logarithm needs time to become one of the whole line; one of the whole line does not."""
    return 0.0 if needle.log == "slender" else SETTLE


def _axis(end: float, radius: float) -> FloatArray:
    """Positions dense at the start."""
    axis = np.concatenate(([0.0], np.geomspace(1e-3 * min(radius, end), end, SAMPLES)))
    axis[-1] = end
    return axis


def _samples(jet: "StraightEhdJet", axis: FloatArray, from_: float) -> StraightStart:
    at = np.minimum(from_ + axis, jet.end)
    axial, radial = jet.conformation(at)
    return StraightStart(axis, jet.radius(at), jet.velocity(at), axial, radial, jet.line_charge(at))


def _downstream(settings: SpunSettings, jet: "StraightEhdJet", position: float) -> SpunSettings:
    """Hand-over at `position`."""
    needle = jet.settings
    gap = needle.end_position - position
    least = CONE * needle.radius
    if not least <= position <= 0.5 * needle.end_position:
        raise InputError(
            "jet.start_position",
            "is no place to hand over: in the cone, or too near the plate",
            value=position,
            allowed=f"{least:.3g} to {0.5 * needle.end_position:.3g} m",
        )
    start = _samples(jet, _axis(gap, needle.radius), position)
    radius, tension = float(start.radius[0]), _pull(jet, position)
    potential = float(start.line_charge[0]) * math.log(needle.end_position / radius) / (2 * math.pi * 8.8541878128e-12)
    inlet = replace(
        settings.inlet,
        radius=radius,
        axial=float(start.axial[0]),
        radial=float(start.radial[0]),
        stress="free",
        compliance=_compliance(jet, position),
        tension=tension,
    )
    cuts = position * np.linspace(0.0, 1.0, FEEDS + 1)
    there = jet.line_charge(position - 0.5 * (cuts[1:] + cuts[:-1]))
    steps = there - np.append(there[1:], 0.0)
    element = settings.grid.element_length * (needle.radius / radius) ** 2
    grid = replace(
        settings.grid,
        element_length=element,
        repulsion="hybrid",
        pressure=True,
        feed_lines=tuple(zip(cuts[1:].tolist(), steps.tolist(), strict=True)),
        settle=_settle(needle),
    )
    loads = replace(settings.loads, gap=gap, needle_at=-position, image=True, metal=settings.loads.kind != "uniform")
    if loads.kind == "table":
        loads = replace(loads, axis=tuple(np.asarray(loads.axis) - position))
    return replace(
        settings,
        inlet=inlet,
        grid=grid,
        loads=loads,
        start=start,
        potential=potential,
        conductivity=needle.conductivity,
        current=needle.current,
    )


def _pull(jet: "StraightEhdJet", position: float) -> float:
    """The polymer's tension at a place, N: all of it but the solvent's."""
    needle = jet.settings
    z = position * (1 + np.array([-LATERAL, 0.0, LATERAL]))
    rate = float(np.gradient(jet.velocity(z), z)[1])
    area = math.pi * float(jet.radius(position)) ** 2
    share = needle.solvent_share if needle.polymer else 1.0
    return float(jet.tension(position)) - 3 * share * needle.viscosity * rate * area


def _compliance(jet: "StraightEhdJet", position: float) -> float:
    """``-d ln r/d ln P`` of the straight jet at a place, from a second one with another pull at its far end."""
    from spinline.jetprofile.ehd import NoSteadyJet, StraightEhdJet

    try:
        other = StraightEhdJet(replace(jet.settings, end_factor=2.0), length=jet.end, near=jet)
    except NoSteadyJet:
        return 0.0
    change = math.log(_pull(other, position) / _pull(jet, position))
    if abs(change) < 1e-6:
        return 0.0
    return max(-math.log(float(other.radius(position)) / float(jet.radius(position))) / change, 0.0)
