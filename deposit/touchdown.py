"""Touch-down as an event: the root of the gap between two stored states.

Between the states of a step a bead moves on the cubic that has the positions and velocities of both (chord, where
velocities are not known). It lands at the first root of the collector's gap *within* the step. Backing up by gap over
present speed instead may leave the step without bound: a gust can turn the bead round, and one such bead once landed three
million seconds before it started.

A bead that dips below the surface and returns within one step lands at the first crossing; what has landed cannot land
again. The root is bracketed on 17 points of the step, then bisected to rounding.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, number, real
from spinline.base.errors import InputError
from spinline.deposit.collectors import Collector

__all__ = ["TouchDown", "touch_down"]

_SAMPLES = 16
_HALVINGS = 54  # to rounding of the step


class TouchDown(NamedTuple):
    """Beads of one step that landed; arrays over the *beads given*, NaN where they fly on."""

    landed: BoolArray
    time: FloatArray  # s
    position: FloatArray  # (bead, 3), m
    velocity: FloatArray  # (bead, 3), m/s, just before


def touch_down(
    collector: Collector,
    start_time: float,
    end_time: float,
    start: ArrayLike,
    end: ArrayLike,
    start_velocity: ArrayLike | None = None,
    end_velocity: ArrayLike | None = None,
) -> TouchDown:
    """First contact of each bead with the collector within a step.

    Parameters
    ----------
    collector : Collector
    start_time, end_time : float
        s, end after start.
    start, end : array_like, (bead, 3)
        Positions in m at both times, the same beads.
    start_velocity, end_velocity : array_like, (bead, 3), optional
        m/s; both or neither.

    Returns
    -------
    TouchDown

    Raises
    ------
    InputError
        For shapes that differ, a step of no length, or one velocity without the other.

    Notes
    -----
    A bead at or below the surface at the start of the step lands at once, at the start.
    """
    t0, t1 = number("start_time", start_time), number("end_time", end_time)
    if not t1 > t0:
        raise InputError("end_time", "is not after the start of the step", value=t1, allowed=f"({t0:g}, inf) s")
    p0, p1 = real("start", start, unit="m"), real("end", end, unit="m")
    if p0.ndim != 2 or p0.shape[-1] != 3 or p0.shape != p1.shape:
        raise InputError("end", "must be (bead, 3) like the start", value=f"shapes {p0.shape} and {p1.shape}")
    if (start_velocity is None) != (end_velocity is None):
        raise InputError("end_velocity", "and start_velocity go together", remedy="give both or neither")
    step = t1 - t0
    if start_velocity is None or end_velocity is None:
        v0 = v1 = (p1 - p0) / step
    else:
        v0, v1 = real("start_velocity", start_velocity, unit="m/s"), real("end_velocity", end_velocity, unit="m/s")
        if v0.shape != p0.shape or v1.shape != p0.shape:
            raise InputError("start_velocity", "must have the shape of the positions", value=f"{v0.shape}")

    def at(share: FloatArray, who: BoolArray | slice) -> FloatArray:
        return _hermite(share[..., None], step, p0[who], p1[who], v0[who], v1[who])

    everyone = slice(None)
    parts = np.linspace(0.0, 1.0, _SAMPLES + 1)
    below = np.stack([collector.gap(at(np.full(len(p0), share), everyone)) <= 0 for share in parts], axis=-1)
    landed: BoolArray = np.asarray(below.any(axis=-1))
    first = np.argmax(below, axis=-1)[landed]
    high = parts[first]
    low = parts[np.maximum(first - 1, 0)]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        inside = collector.gap(at(middle, landed)) <= 0
        high, low = np.where(inside, middle, high), np.where(inside, low, middle)
    time, position, velocity = np.full(len(p0), np.nan), np.full_like(p0, np.nan), np.full_like(p0, np.nan)
    time[landed] = t0 + high * step
    position[landed] = at(high, landed)
    velocity[landed] = _slope(high[:, None], step, p0[landed], p1[landed], v0[landed], v1[landed])
    return TouchDown(landed, time, position, velocity)


def _hermite(u: FloatArray, step: float, p0: FloatArray, p1: FloatArray, v0: FloatArray, v1: FloatArray) -> FloatArray:
    """Cubic through both states at the share u of the step; written so that u = 1 gives p1 itself."""
    w = 1 - u
    near = w * w * ((1 + 2 * u) * p0 + u * step * v0)
    far = u * u * ((1 + 2 * w) * p1 - w * step * v1)
    return near + far


def _slope(u: FloatArray, step: float, p0: FloatArray, p1: FloatArray, v0: FloatArray, v1: FloatArray) -> FloatArray:
    w = 1 - u
    return 6 * u * w * (p1 - p0) / step + w * (1 - 3 * u) * v0 + u * (3 * u - 2) * v1
