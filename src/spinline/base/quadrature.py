"""Gauss-Legendre rules, computed once each: finding 10 nodes takes longer than using them."""

from functools import lru_cache

import numpy as np

from spinline.base.checks import FloatArray

__all__ = ["gauss"]


@lru_cache(maxsize=64)
def gauss(points: int) -> tuple[FloatArray, FloatArray]:
    """Nodes in (-1, 1) and weights; both read-only."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes, weights
