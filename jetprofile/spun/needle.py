"""The metal needle behind a jet, as rings of charge: where they are, and the inverse of their potentials of each other."""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.quadrature import gauss

__all__ = ["rings"]

COUNT = 16
"""Rings; with 16 a line's charge is within 0.3 % of the boundary elements' from 2 mm on, with 40 within 0.2 %."""
FIRST = 0.25  # depth of the first ring, tip radii
DEEP = 3.0  # gaps


def rings(gap: float, tip: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rings on a hyperboloid of tip radius `tip` over a plate `gap` away.

    Parameters
    ----------
    gap, tip : float
        m.

    Returns
    -------
    depth, radius : ndarray, (COUNT,)
        Behind the tip, and from the axis, m.
    inverse : ndarray, (COUNT, COUNT)
        Charge (times 1/(4 pi eps0)) on the rings per potential of them, m; symmetric and positive.
    """
    from scipy.special import ellipkm1

    edges = np.concatenate(([0.0], np.geomspace(FIRST * tip, DEEP * gap, COUNT)))
    depth = 0.5 * (edges[1:] + edges[:-1])
    nodes, weights = gauss(8)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    cuts = 0.5 ** np.arange(30)

    def wide(s: FloatArray) -> FloatArray:
        """Radius of the hyperboloid: rho^2 = (2 s gap + s^2) tip/gap, its tip's radius of curvature being `tip`."""
        value: FloatArray = np.sqrt(s * (2.0 * gap + s) * tip) / math.sqrt(gap)
        return value

    def ring(up: FloatArray, at: float, other: FloatArray) -> FloatArray:
        total = (at + other) ** 2 + up**2
        return np.asarray(2 / np.pi * ellipkm1(((at - other) ** 2 + up**2) / total) / np.sqrt(total), dtype=np.float64)

    radius = wide(depth)
    level = np.empty((COUNT, COUNT))
    for j in range(COUNT):
        low, high = edges[j], edges[j + 1]
        for i in range(COUNT):
            u = min(max((depth[i] - low) / (high - low), 0.0), 1.0)
            parts = np.unique(np.concatenate((u - u * cuts, [u], u + (1 - u) * cuts)))
            width = np.diff(parts)
            s = low + (high - low) * (parts[:-1, None] + width[:, None] * nodes).ravel()
            share = (width[:, None] * weights).ravel()
            near, far = ring(depth[i] - s, radius[i], wide(s)), ring(2 * gap + depth[i] + s, radius[i], wide(s))
            level[i, j] = share @ (near - far)
    inverse = np.linalg.inv(0.5 * (level + level.T))
    return depth, radius, np.asarray(0.5 * (inverse + inverse.T), dtype=np.float64)
