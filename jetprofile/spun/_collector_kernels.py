"""Plate, belt and drum, compiled: distance, surface velocity, and where material points of the surface are.

The plate and the belt are the plane x = gap; the drum's nearest line is there, its axis along z. A belt or drum surface
moves along +y where the jet meets it.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    BELT,
    COLLECTOR,
    COLLECTOR_SPEED,
    DRUM,
    DRUM_RADIUS,
    GAP,
    NO_COLLECTOR,
    RADIUS,
    VX,
    IntArray,
    X,
    Y,
)

__all__ = ["distance", "first_touch", "material_frame", "place", "surface_velocity"]


@njit(cache=True, error_model="numpy")
def distance(x: float, y: float, p: FloatArray, k: IntArray) -> float:
    """Signed distance of a point from the surface; positive in flight."""
    if k[COLLECTOR] == DRUM:
        value: float = math.hypot(x - p[GAP] - p[DRUM_RADIUS], y) - p[DRUM_RADIUS]
        return value
    value = p[GAP] - x
    return value


@njit(cache=True, error_model="numpy")
def surface_velocity(x: float, y: float, p: FloatArray, k: IntArray) -> tuple[float, float]:
    """Velocity (x, y) of the surface at a point of it."""
    if k[COLLECTOR] == BELT:
        return 0.0, p[COLLECTOR_SPEED]
    if k[COLLECTOR] == DRUM:
        turn = p[COLLECTOR_SPEED] / p[DRUM_RADIUS]
        return turn * y, -turn * (x - p[GAP] - p[DRUM_RADIUS])
    return 0.0, 0.0


@njit(cache=True, error_model="numpy")
def place(i: int, y: FloatArray, p: FloatArray, k: IntArray) -> None:
    """Put node i on the surface, at rest with it."""
    if k[COLLECTOR] == DRUM:
        dx, dy = y[i, X] - p[GAP] - p[DRUM_RADIUS], y[i, Y]
        scale = p[DRUM_RADIUS] / math.hypot(dx, dy)
        y[i, X], y[i, Y] = p[GAP] + p[DRUM_RADIUS] + dx * scale, dy * scale
    else:
        y[i, X] = p[GAP]
    y[i, VX], y[i, VX + 1] = surface_velocity(y[i, X], y[i, Y], p, k)
    y[i, VX + 2] = 0.0


@njit(cache=True, error_model="numpy")
def material_frame(t: float, x: float, y: float, p: FloatArray, k: IntArray) -> float:
    """Coordinate along the surface of the material point that is at (x, y) at time t; where it was at t = 0."""
    if k[COLLECTOR] == BELT:
        value: float = y - p[COLLECTOR_SPEED] * t
        return value
    if k[COLLECTOR] == DRUM:
        angle = math.atan2(y, p[GAP] + p[DRUM_RADIUS] - x)
        value = p[DRUM_RADIUS] * angle - p[COLLECTOR_SPEED] * t
        return value
    return y


@njit(cache=True, error_model="numpy")
def first_touch(
    n: int, h: float, old: FloatArray, new: FloatArray, held: IntArray, p: FloatArray, k: IntArray
) -> tuple[int, float]:
    """First node that reaches the surface within a step and when (from its start): cubic through both states."""
    who, when = -1, h
    if k[COLLECTOR] == NO_COLLECTOR:
        return who, when
    for i in range(n):
        if held[i] == 1:
            continue
        after = distance(new[i, X], new[i, Y], p, k)
        if after > max(1e-9 * p[GAP], 1e-3 * p[RADIUS]):
            continue
        if after > 0.0:  # as good as there
            if who < 0:
                who, when = i, h
            continue
        low, high = 0.0, 1.0
        for _ in range(60):
            mid = 0.5 * (low + high)
            x = _hermite(mid, h, old[i, X], old[i, VX], new[i, X], new[i, VX])
            y = _hermite(mid, h, old[i, Y], old[i, VX + 1], new[i, Y], new[i, VX + 1])
            if distance(x, y, p, k) > 0.0:
                low = mid
            else:
                high = mid
        if who < 0 or high * h < when:
            who, when = i, high * h
    return who, when


@njit(cache=True, error_model="numpy")
def _hermite(s: float, h: float, x0: float, v0: float, x1: float, v1: float) -> float:
    r = 1.0 - s
    return (1 + 2 * s) * r * r * x0 + s * r * r * h * v0 + s * s * (3 - 2 * s) * x1 - s * s * r * h * v1
