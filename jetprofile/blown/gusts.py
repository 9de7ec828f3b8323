"""Gusts: one random velocity field that all beads share.

::

    u' = I U_c g(r) sum_m W_m(x) 6^(1/2) e_m cos(omega_m (t - T(x)) + kappa_m . (y, z)/l(x) + phi_m)     l = 0.14 x

T(x) = int dx/(U_c/2): the pattern is carried at half the centre velocity, frozen. Each mode has its frequency; W_m(x), with
sum of squares 1, picks those near ``U_c/(2 l)``, so that gusts are as long as the turbulence is wide, everywhere. g is the
mean profile: no gusts outside the air jet; in the potential core they grow from nothing. Components fluctuate by I U_c on the
axis. The field is not free of sources. Independent noise per bead would not converge with the mesh. From (seed, index) alone.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray, number
from spinline.jetprofile.blown.air import Air

__all__ = ["INTEGRAL_LENGTH", "GustField", "gust_field"]

INTEGRAL_LENGTH = 0.14  # of the distance from the gas nozzle
_BREADTH = 0.7  # of the weights, in ln omega


@dataclass(frozen=True, eq=False)
class GustField:
    """Modes (rows: omega, kappa_y, kappa_z, e (3), phi) and, at `x`, carried time T, length l and weights (x, mode)."""

    modes: FloatArray
    x: FloatArray
    carried: FloatArray
    length: FloatArray
    weights: FloatArray

    def shape(self, position: FloatArray, time: float) -> FloatArray:
        """``u'/(I U_c g)`` at positions (n, 3), m; (n, 3)."""
        px, m = np.asarray(position)[:, 0], self.modes
        t, length = np.interp(px, self.x, self.carried), np.interp(px, self.x, self.length)
        k = np.clip(np.searchsorted(self.x, px) - 1, 0, self.x.size - 1)
        angle = m[:, 0] * (time - t[:, None]) + m[:, 6]
        angle = angle + (m[:, 1] * position[:, 1:2] + m[:, 2] * position[:, 2:3]) / length[:, None]
        return np.asarray((self.weights[k] * np.cos(angle)) @ m[:, 3:6])


def gust_field(air: Air, x: FloatArray, *, modes: int = 32, seed: int = 0, index: int = 0) -> GustField:
    """Gusts of an air flow on evenly spaced places along the axis.

    Parameters
    ----------
    air : Air
    x : ndarray
        m, rising from above 0.
    modes : int
        32 or more for near-normal statistics.
    seed, index : int
    """
    m = int(number("modes", modes, least=1, most=4096))
    rng = np.random.default_rng([seed, index])
    speed = np.maximum(np.abs(air.velocity(x)), 1e-6) / 2
    length = INTEGRAL_LENGTH * x
    steps = 0.5 * (1 / speed[1:] + 1 / speed[:-1]) * np.diff(x)
    carried = np.concatenate([[0.0], np.cumsum(steps)])
    local = speed / length
    omega = np.exp(
        rng.permutation(np.linspace(np.log(local.min()), np.log(local.max()), m)) + 0.1 * rng.standard_normal(m)
    )
    e = rng.standard_normal((m, 3))
    e *= np.sqrt(6.0) / np.linalg.norm(e, axis=1)[:, None]
    kappa = rng.standard_normal((m, 2)) * np.sqrt(np.pi / 2)
    weights = np.exp(-0.5 * (np.log(omega[None] / local[:, None]) / _BREADTH) ** 2)
    weights /= np.sqrt(np.sum(weights**2, axis=1))[:, None]
    table = np.column_stack([omega, kappa, e, rng.uniform(0, 2 * np.pi, m)])
    return GustField(table, x, carried, length, weights)
