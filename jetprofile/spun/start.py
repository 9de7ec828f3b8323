"""A chain that starts as a straight jet: from the needle or from a place downstream, to the plate.

A chain with a free front needs to be told what pulls it; a whole jet has no front. So a jet whose charge moves starts as the
steady straight jet of its needle, its end on the plate, and bends (or not) from there.
"""

import math
from collections.abc import Callable

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun.chain import Chain
from spinline.jetprofile.spun.settings import SpunSettings
from spinline.jetprofile.spun.straight import StraightStart

__all__ = ["start_straight"]


def start_straight(settings: SpunSettings, straight: StraightStart, capacity: int = 512) -> Chain:
    """The chain on the straight jet, from the nozzle to the end of the samples (the plate, where its end is held).

    Elements have the volume of `element_length` at the inlet's radius, in halves where they would be longer than the grid's
    `longest`; the front one holds what is left over.
    """
    from scipy.interpolate import PchipInterpolator

    inlet, gap = settings.inlet, settings.loads.gap
    step = math.pi * inlet.radius**2 * settings.grid.element_length
    z = straight.axis
    label, place = _labels(straight)
    total = float(label(z[-1]))
    count = max(round(total / step), 1)
    cuts = step * np.arange(count + 1, dtype=np.float64)
    cuts[-1] = total
    if count < 3:
        raise InputError(
            "element_length",
            "is too long: the jet to the plate holds fewer than three elements",
            value=settings.grid.element_length,
            allowed=f"up to {total / step * settings.grid.element_length / 3:.3g} m",
        )
    longest = settings.grid.longest
    while longest > 0.0:
        long = np.diff(place(cuts)) > longest
        long[0] = False
        if not long.any():
            break
        cuts = np.sort(np.concatenate((cuts, 0.5 * (cuts[:-1] + cuts[1:])[long])))
    n = cuts.size - 1
    nodes = place(cuts)[::-1]
    nodes[0], nodes[-1] = z[-1], 0.0
    speed, area = PchipInterpolator(z, straight.velocity), math.pi * straight.radius**2
    volumes = label(z)
    # each element's mean tension, and of A_rr/A, which an affine stretch leaves alone: a first stretch within an element would
    # else be forgotten, and a step of the radius run down the jet
    pull = PchipInterpolator(volumes, (straight.axial - straight.radial) * area).antiderivative()
    radial = PchipInterpolator(volumes, straight.radial / area).antiderivative()
    charge = PchipInterpolator(z, straight.line_charge).antiderivative()
    rows = max(capacity, 2 * n + 8)
    state, held = np.zeros((rows, c.COLUMNS)), np.zeros(rows, dtype=np.int64)
    pieces = np.diff(cuts)[::-1]
    areas = pieces / -np.diff(nodes)
    state[: n + 1, c.X], state[: n + 1, c.VX] = nodes, speed(nodes)
    state[:n, c.ARR] = np.diff(radial(cuts))[::-1] / pieces * areas
    state[:n, c.AZZ] = state[:n, c.ARR] + np.diff(pull(cuts))[::-1] / pieces / areas
    state[:n, c.VOLUME] = state[:n, c.LABEL] = pieces
    state[:n, c.CHARGE] = np.diff(charge(nodes[::-1]))[::-1]
    state[:, c.TEMP] = settings.drying.temperature if settings.drying else 293.15
    marks = np.zeros((rows, 9))
    if settings.collector.kind != "none" and nodes[0] >= gap * (1 - 1e-12):
        state[0, c.X], state[0, c.VX] = gap, 0.0
        held[0] = 1
        marks[0, 1], marks[0, 6], marks[0, 5] = gap, straight.velocity[-1], nodes[0] - nodes[1]
    clock = np.zeros(c.CLOCK)
    clock[0] = step
    clock[2] = 0.5 * step / inlet.flow_rate
    return Chain(
        settings, 0.0, n, state, held, marks, clock, np.zeros((rows, c.DEPOSITS)), 0.01 * step / inlet.flow_rate
    )


def _labels(straight: StraightStart) -> tuple[Callable[[FloatArray], FloatArray], Callable[[FloatArray], FloatArray]]:
    """Volume from the nozzle as a function of z, and its inverse."""
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

    area = math.pi * straight.radius**2
    label = PchipInterpolator(straight.axis, area).antiderivative()
    volumes = label(straight.axis)
    place = CubicHermiteSpline(volumes, straight.axis, 1.0 / area)
    return label, place
