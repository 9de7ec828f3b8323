"""What a chain looks like: stretch, tension and extension of its strands, each at its midpoint."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.network.chain.model import Chain
from spinline.network.chain.state import ChainState
from spinline.network.force_laws import extension

__all__ = ["ChainProfile", "profile"]

_POINTS = 6
_FARTHEST = 1e12  # initial radii


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
    beads : ndarray, shape (strands + 1,)
        Their ends.
    step : float
        Distance of the beads at rest.
    contour : float
        ``xi_max / xi_0`` of a bounded law, else infinite.
    """

    position: FloatArray
    stretch: FloatArray
    tension: FloatArray
    relative_extension: FloatArray
    network_velocity_ratio: FloatArray
    beads: FloatArray
    step: float
    contour: float = np.inf

    def stretch_at(self, position: ArrayLike) -> FloatArray:
        """Local stretch ``(dx/dn) / h`` at positions (initial radii); NaN outside the chain.

        Derivative of the polynomial through six beads: of fifth order in the spacing of the beads, where a spacing
        given to its midpoint is of second (4e-5 at h = 0.01 on the published jet). Where it leaves (0, contour], as it may by
        1e-4 at a front of locking, the straight line between the middles of the strands.
        """
        s = real("position", position, least=-_FARTHEST, most=_FARTHEST)
        x = self.beads
        if x.size < _POINTS:
            return np.full(s.shape, np.nan)
        first = np.clip(np.searchsorted(x, s) - _POINTS // 2, 0, x.size - _POINTS)
        p = [x[first + i] for i in range(_POINTS)]
        number = np.zeros(s.shape)  # dn/dx, by Lagrange's formula
        for i in range(_POINTS):
            others = [p[j] for j in range(_POINTS) if j != i]
            top = sum(_product([s - b for b in others if b is not a]) for a in others)
            number = number + i * top / _product([p[i] - a for a in others])
        inside = (s >= x[0]) & (s <= x[-1])
        value: FloatArray = 1 / np.where(inside & (number != 0), number, np.inf) / self.step
        rough = ~((value > 0) & (value <= self.contour))
        if rough.any():
            bounded = np.isfinite(self.contour)
            stretch = self.relative_extension * self.contour if bounded else self.stretch
            value = np.where(rough, np.interp(s, self.position, stretch), value)
        return np.where(inside, value, np.nan)


def _product(factors: list[FloatArray]) -> FloatArray:
    value: FloatArray = np.prod(np.stack(factors), axis=0)
    return value


def profile(chain: Chain, state: ChainState) -> ChainProfile:
    """Strands of a state that lie between the nozzle and the end of the jet."""
    x, v = state.positions, state.velocities
    inside = (x[1:] >= 0) & (x[:-1] <= chain.flow.length)
    order = np.flatnonzero(inside)[::-1]
    tension = state.tensions[order]
    ends = x[order[-1] : order[0] + 2][::-1] if order.size else x[:0]
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
        beads=ends,
        step=chain.step,
        contour=np.inf if chain.contour is None or chain.law == "linear" else float(chain.contour),
    )
