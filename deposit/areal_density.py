"""Mass per area of the collector: every segment cut at the edges of the cells, exactly.

A segment's volume is spread evenly along its chord; where the chord is nothing all of it goes to its place. What lies
outside the grid is returned, so that map and remainder sum to what was laid, to rounding.
"""

import math
from typing import NamedTuple

import numpy as np

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.base.kernels import njit
from spinline.deposit.segments import Segments

__all__ = ["DensityMap", "add_segments", "density_map"]


class DensityMap(NamedTuple):
    """Content of cells; `content` (x, y) in the unit of the weights, edges in m, and what fell outside."""

    x_edges: FloatArray
    y_edges: FloatArray
    content: FloatArray
    outside: float

    @property
    def per_area(self) -> FloatArray:
        """Content over the area of its cell."""
        return self.content / (np.diff(self.x_edges)[:, None] * np.diff(self.y_edges)[None, :])


def density_map(
    segments: Segments, x_edges: FloatArray, y_edges: FloatArray, *, density: float = 1.0, dry: bool = True
) -> DensityMap:
    """Mass of the segments in each cell of a regular grid.

    Parameters
    ----------
    segments : Segments
    x_edges, y_edges : ndarray
        Evenly spaced and rising, two or more, m.
    density : float
        kg/m3; 1 gives volumes in m3.
    dry : bool
        Polymer only, or what landed.

    Returns
    -------
    DensityMap
        In kg; ``per_area`` in kg/m2.

    Raises
    ------
    InputError
        For edges that do not rise evenly.
    """
    grid = [_even("x_edges", x_edges), _even("y_edges", y_edges)]
    rho = positive("density", density, "kg/m3")
    content = np.zeros((grid[0].size - 1, grid[1].size - 1))
    weight = rho * (segments.dry_volume if dry else segments.volume)
    outside = add_segments(content, segments, weight, grid[0], grid[1])
    return DensityMap(grid[0], grid[1], content, outside)


def add_segments(
    content: FloatArray, segments: Segments, weight: FloatArray, x_edges: FloatArray, y_edges: FloatArray
) -> float:
    """Add weights of segments to `content` in place, for maps built chunk by chunk; returns what fell outside."""
    sx, sy = x_edges[1] - x_edges[0], y_edges[1] - y_edges[0]
    value: float = _add(
        content,
        (segments.x - x_edges[0]) / sx,
        (segments.y - y_edges[0]) / sy,
        segments.dx / sx,
        segments.dy / sy,
        weight,
    )
    return value


@njit(cache=True, error_model="numpy")
def _add(
    content: FloatArray, x: FloatArray, y: FloatArray, dx: FloatArray, dy: FloatArray, weight: FloatArray
) -> float:
    nx, ny = content.shape
    outside = 0.0
    for k in range(x.size):
        at, total = 0.0, weight[k]
        i, j = math.floor(x[k]), math.floor(y[k])
        if dx[k] < 0 and i == x[k]:
            i -= 1  # on an edge and leaving to the left
        if dy[k] < 0 and j == y[k]:
            j -= 1
        left = total
        while True:
            to_x = ((i + 1 if dx[k] > 0 else i) - x[k]) / dx[k] if dx[k] != 0 else math.inf
            to_y = ((j + 1 if dy[k] > 0 else j) - y[k]) / dy[k] if dy[k] != 0 else math.inf
            end = min(to_x, to_y)
            last = end >= 1
            part = left if last else total * (end - at)
            left -= part
            if 0 <= i < nx and 0 <= j < ny:
                content[i, j] += part
            else:
                outside += part
            if last:
                break
            at = end
            if to_x <= to_y:
                i += 1 if dx[k] > 0 else -1
            if to_y <= to_x:
                j += 1 if dy[k] > 0 else -1
    return outside


def _even(name: str, edges: FloatArray) -> FloatArray:
    e = real(name, edges, unit="m")
    if e.ndim != 1 or e.size < 2:
        raise InputError(name, "needs two edges or more", value=f"shape {e.shape}")
    step = np.diff(e)
    if not (step > 0).all() or np.ptp(step) > 1e-9 * step.mean():
        raise InputError(name, "must rise evenly", value=f"steps from {step.min():g} to {step.max():g} m")
    return e
