"""Kilometres of fibre from a fitted law of laydown, in place of kilometres of simulated jet.

The fibre's tip moves on the resting footprint by the stochastic model of Goetz, Klar, Marheineke and Wegener, per arc length
s::

    d xi = tau(alpha) ds        d alpha = -grad B(xi) . tau_perp ds + A dW

whose stationary density is exactly ``exp(-B)``, directions uniform, whatever the noise A. Here ``B = xi' C^-1 xi / 2``: a
normal footprint of covariance C. A small A gives loops, a large A a crumpled path. A collector that moves is added afterwards
(``X = xi - V t``, t = s/u), which is right while the fibre's laying does not feel it.

Step: kick, half the turn, straight piece, half the turn (weak order 2). 5e6 segments a second on one core.

References
----------
Goetz, Klar, Marheineke, Wegener, SIAM J. Appl. Math. 67, 1704 (2007).
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.base.kernels import njit
from spinline.deposit.segments import Segments

__all__ = ["Laydown", "laid_length", "surrogate_fibre"]


@dataclass(frozen=True)
class Laydown:
    """Fitted laydown of one jet.

    Attributes
    ----------
    speed : float
        Length laid per time on a resting collector, m/s.
    covariance : array_like, (2, 2) or scalar
        Of the footprint, m2; a scalar is the variance of a round one.
    noise : float
        A, rad/m^(1/2), >= 0. `turning_length` = 2/A^2 is the path over which a direction is forgotten.
    radius : float
        Median radius, m.
    radius_spread : float
        Standard deviation of ln radius along the fibre, >= 0.
    radius_length : float
        Path over which the radius is forgotten, m; 0: independent from segment to segment.
    polymer_fraction : float
    """

    speed: float
    covariance: ArrayLike
    noise: float
    radius: float
    radius_spread: float = 0.0
    radius_length: float = 0.0
    polymer_fraction: float = 1.0

    def __post_init__(self) -> None:
        positive("laydown.speed", self.speed, "m/s")
        positive("laydown.radius", self.radius, "m")
        number("laydown.noise", self.noise, least=0.0, unit="rad/m^(1/2)")
        number("laydown.radius_spread", self.radius_spread, least=0.0, most=5.0)
        number("laydown.radius_length", self.radius_length, least=0.0, unit="m")
        number("laydown.polymer_fraction", self.polymer_fraction, above=0.0, most=1.0)
        matrix = real("laydown.covariance", self.covariance, unit="m2")
        if matrix.ndim == 0:
            matrix = matrix * np.eye(2)
        if matrix.shape != (2, 2) or not np.allclose(matrix, matrix.T) or np.linalg.eigvalsh(matrix)[0] <= 0:
            raise InputError(
                "laydown.covariance",
                "is no covariance of a footprint",
                value=np.asarray(self.covariance).tolist(),
                allowed="a variance > 0 or a symmetric positive (2, 2) array",
            )
        object.__setattr__(self, "covariance", matrix)


def surrogate_fibre(
    laydown: Laydown,
    length: float,
    *,
    step: float | None = None,
    machine_speed: float = 0.0,
    centre: tuple[float, float] = (0.0, 0.0),
    start_time: float = 0.0,
    jet: int = 0,
    seed: int = 0,
    block: int = 262144,
) -> Iterator[Segments]:
    """Segments of one fibre, in blocks.

    Parameters
    ----------
    laydown : Laydown
    length : float
        To lay, m.
    step : float, optional
        Of the segments, m. Default: 1/20 of the smallest of the footprint's spread and the turning length.
    machine_speed : float
        Of the collector towards +x of its own frame's lab, m/s; a drum's is its surface speed.
    centre : tuple
        Of the footprint at the start, m.
    start_time : float
        s.
    jet, seed : int
        The stream of random numbers follows from (seed, jet).
    block : int
        Segments a block.

    Yields
    ------
    Segments

    Raises
    ------
    InputError
        For values out of range, or a step that is not well below the footprint.
    """
    covariance = np.asarray(laydown.covariance)
    spread = float(np.sqrt(np.linalg.eigvalsh(covariance)[0]))
    turning = 2 / laydown.noise**2 if laydown.noise > 0 else math.inf
    ds = min(spread, turning) / 20 if step is None else positive("step", step, "m")
    if ds > min(spread, turning) / 2:
        raise InputError(
            "step", "is too long for this footprint and noise", value=ds, allowed=f"(0, {min(spread, turning) / 2:g}] m"
        )
    total = max(round(positive("length", length, "m") / ds), 1)
    number("segments", total, most=1e10, remedy="lay a shorter fibre or use longer steps")
    v = number("machine_speed", machine_speed, unit="m/s")
    rng = np.random.default_rng([seed, jet])
    inverse = np.linalg.inv(covariance)
    root = np.linalg.cholesky(covariance)
    state = np.empty(4)  # xi, eta, alpha, ln radius
    state[:2] = root @ rng.standard_normal(2)
    state[2] = rng.uniform(0, 2 * np.pi)
    state[3] = rng.standard_normal()
    memory = math.exp(-ds / laydown.radius_length) if laydown.radius_length > 0 else 0.0
    done = 0
    while done < total:
        n = min(block, total - done)
        kicks = rng.standard_normal(n) * (laydown.noise * math.sqrt(ds))
        path, log_radius = np.empty((n + 1, 2)), np.empty(n)
        shakes = rng.standard_normal(n)
        _walk(path, log_radius, state, kicks, shakes, inverse, ds, memory)
        time = start_time + ds / laydown.speed * (done + np.arange(n + 1.0))
        path[:, 0] += centre[0] - v * time
        path[:, 1] += centre[1]
        move = np.diff(path, axis=0)
        yield Segments(
            path[:-1, 0],
            path[:-1, 1],
            move[:, 0],
            move[:, 1],
            time[1:],
            np.asarray(laydown.radius * np.exp(laydown.radius_spread * log_radius), dtype=np.float64),
            np.full(n, float(laydown.polymer_fraction)),
            np.full(n, ds),
            np.full(n, jet, dtype=np.int32),
            np.full(n, jet, dtype=np.int32),
        )
        done += n


def laid_length(laydown: Laydown, duration: float) -> float:
    """Length in m that is laid in `duration` (s), resting collector."""
    return laydown.speed * positive("duration", duration, "s")


@njit(cache=True, error_model="numpy")
def _walk(
    path: FloatArray,
    log_radius: FloatArray,
    state: FloatArray,
    kicks: FloatArray,
    shakes: FloatArray,
    inverse: FloatArray,
    ds: float,
    memory: float,
) -> None:
    x, y, alpha, r = state[0], state[1], state[2], state[3]
    a, b, d = inverse[0, 0], inverse[0, 1], inverse[1, 1]
    fresh = math.sqrt(1 - memory * memory)
    path[0, 0], path[0, 1] = x, y
    for k in range(kicks.size):
        alpha = _turn(alpha + kicks[k], a * x + b * y, b * x + d * y, 0.5 * ds)
        x += ds * math.cos(alpha)
        y += ds * math.sin(alpha)
        alpha = _turn(alpha, a * x + b * y, b * x + d * y, 0.5 * ds)
        r = memory * r + fresh * shakes[k]
        path[k + 1, 0], path[k + 1, 1] = x, y
        log_radius[k] = r
    state[0], state[1], state[2], state[3] = x, y, alpha, r


@njit(cache=True, error_model="numpy")
def _turn(alpha: float, gx: float, gy: float, ds: float) -> float:
    """Direction after a path ds in a held force: ``d alpha = (gx sin alpha - gy cos alpha) ds``, by the midpoint rule."""
    half = alpha + 0.5 * ds * (gx * math.sin(alpha) - gy * math.cos(alpha))
    return alpha + ds * (gx * math.sin(half) - gy * math.cos(half))
