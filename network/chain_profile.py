"""What a chain looks like: stretch, tension and extension of its strands, each at its midpoint."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.checks import FloatArray, real
from spinline.network.chain_model import Chain
from spinline.network.chain_state import ChainState
from spinline.network.force_laws import extension

__all__ = ["ChainProfile", "profile"]


@dataclass(frozen=True, eq=False)
class ChainProfile:
    """Strands of a chain from the nozzle to the far end; arrays of shape (strands,).

    Attributes
    ----------
    position : ndarray
        Midpoints x, in initial radii, increasing.
    stretch : ndarray
        ``w = xi_par / xi_0``.
    tension : ndarray
        ``f / f_0``.
    relative_extension : ndarray
        ``xi_par / xi_max`` by the tension; NaN where the contour is not given.
    network_velocity_ratio : ndarray
        Mean velocity of both ends over v_0.
    """

    position: FloatArray
    stretch: FloatArray
    tension: FloatArray
    relative_extension: FloatArray
    network_velocity_ratio: FloatArray

    def stretch_at(self, position: ArrayLike) -> FloatArray:
        """Stretch at positions (initial radii), cubic through four midpoints; NaN outside the chain."""
        s = real("position", position)
        x, w = self.position, self.stretch
        if x.size < 4:
            return np.interp(s, x, w, left=np.nan, right=np.nan) if x.size else np.full(s.shape, np.nan)
        first = np.clip(np.searchsorted(x, s) - 2, 0, x.size - 4)
        value = np.zeros(s.shape)
        for i in range(4):
            weight = np.ones(s.shape)
            for j in range(4):
                if i != j:
                    weight = weight * (s - x[first + j]) / (x[first + i] - x[first + j])
            value = value + weight * w[first + i]
        return np.where((s >= x[0]) & (s <= x[-1]), value, np.nan)


def profile(chain: Chain, state: ChainState) -> ChainProfile:
    """Strands of a state that lie between the nozzle and the end of the jet."""
    x, v = state.positions, state.velocities
    inside = (x[1:] >= 0) & (x[:-1] <= chain.flow.length)
    order = np.flatnonzero(inside)[::-1]
    tension = state.tensions[order]
    if chain.contour is None:
        relative = np.full(tension.shape, np.nan)
    else:
        relative = extension(tension * chain.rest_force, chain.law, chain.rest_force)
    return ChainProfile(
        position=(0.5 * (x[1:] + x[:-1]))[order],
        stretch=((x[:-1] - x[1:]) / chain.step)[order],
        tension=tension,
        relative_extension=relative,
        network_velocity_ratio=(0.5 * (v[1:] + v[:-1]))[order],
    )
