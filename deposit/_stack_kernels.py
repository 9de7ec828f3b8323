"""Loops of the stack: support under a fibre, the slope it takes, the new surface. Nothing is checked here."""

import math

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["drape_all"]


@njit(cache=True, error_model="numpy")
def drape_all(
    height: FloatArray,
    z: FloatArray,
    x: FloatArray,
    y: FloatArray,
    radius: FloatArray,
    offsets: "NDArray[np.int64]",
    spacing: FloatArray,
    pixel: float,
    slope: float,
    flatten: float,
    periodic: bool,
) -> None:
    """Lay all passages on `height` (x, y) in order; their axes go to `z`. Lengths in one unit."""
    for k in range(offsets.size - 1):
        start, stop = offsets[k], offsets[k + 1]
        for i in range(start, stop):
            cx, cy = _direction(x, y, i, start, stop)
            z[i] = _support(height, x[i], y[i], cx, cy, radius[i], 0.5 * spacing[k], pixel, flatten, periodic)
        fall = slope * spacing[k]
        if math.isfinite(fall):
            for i in range(start + 1, stop):
                z[i] = max(z[i], z[i - 1] - fall)
            for i in range(stop - 2, start - 1, -1):
                z[i] = max(z[i], z[i + 1] - fall)
        for i in range(start, stop):
            cx, cy = _direction(x, y, i, start, stop)
            _cover(height, x[i], y[i], cx, cy, z[i], radius[i], 0.5 * spacing[k], pixel, periodic)


@njit(cache=True, error_model="numpy")
def _direction(x: FloatArray, y: FloatArray, i: int, start: int, stop: int) -> tuple[float, float]:
    before, after = max(i - 1, start), min(i + 1, stop - 1)
    dx, dy = x[after] - x[before], y[after] - y[before]
    length = math.hypot(dx, dy)
    if length == 0:
        return 1.0, 0.0
    return dx / length, dy / length


@njit(cache=True, error_model="numpy")
def _support(
    height: FloatArray,
    x: float,
    y: float,
    cx: float,
    cy: float,
    a: float,
    half: float,
    pixel: float,
    flatten: float,
    periodic: bool,
) -> float:
    """Height of the axis that rests on what lies below this piece; the floor holds it at a."""
    nx, ny = height.shape
    reach = math.hypot(a, half)
    best = a
    for i in range(math.floor((x - reach) / pixel), math.floor((x + reach) / pixel) + 1):
        ii = i % nx if periodic else i
        if ii < 0 or ii >= nx:
            continue
        ux = (i + 0.5) * pixel - x
        for j in range(math.floor((y - reach) / pixel), math.floor((y + reach) / pixel) + 1):
            jj = j % ny if periodic else j
            if jj < 0 or jj >= ny:
                continue
            uy = (j + 0.5) * pixel - y
            across = uy * cx - ux * cy
            if abs(ux * cx + uy * cy) <= half and abs(across) < a and height[ii, jj] > 0:
                best = max(best, height[ii, jj] + math.sqrt(a * a - across * across) - flatten * 2 * a)
    return best


@njit(cache=True, error_model="numpy")
def _cover(
    height: FloatArray,
    x: float,
    y: float,
    cx: float,
    cy: float,
    z: float,
    a: float,
    half: float,
    pixel: float,
    periodic: bool,
) -> None:
    """Raise the surface to the top of this piece."""
    nx, ny = height.shape
    reach = math.hypot(a, half)
    for i in range(math.floor((x - reach) / pixel), math.floor((x + reach) / pixel) + 1):
        ii = i % nx if periodic else i
        if ii < 0 or ii >= nx:
            continue
        ux = (i + 0.5) * pixel - x
        for j in range(math.floor((y - reach) / pixel), math.floor((y + reach) / pixel) + 1):
            jj = j % ny if periodic else j
            if jj < 0 or jj >= ny:
                continue
            uy = (j + 0.5) * pixel - y
            across = uy * cx - ux * cy
            if abs(ux * cx + uy * cy) <= half and abs(across) < a:
                top = z + math.sqrt(a * a - across * across)
                if top > height[ii, jj]:
                    height[ii, jj] = top
