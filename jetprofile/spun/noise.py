"""Random pushes of the air, Eq. (23), that a finer grid sees as the same noise.

The published term gives every bead the same velocity diffusivity, so a jet cut twice as finely is shaken more. Here the
force belongs to the material: momentum arrives in impulses, one per cell of `grain` volume (counted from the front) and
`interval` of time, of variance ``2 noise m dt`` with m the mass of the cell; a piece of mass m then has ``D_v = noise/m``. Each
impulse follows from (seed, cell, moment) alone.
"""

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.jetprofile.spun import _codes as c

__all__ = ["impulses", "normals"]

_U = np.uint64


def _mix(x: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Splitmix64's finaliser: every bit of the result depends on every bit of the argument."""
    x = (x ^ (x >> _U(30))) * _U(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> _U(27))) * _U(0x94D049BB133111EB)
    return x ^ (x >> _U(31))


def normals(seed: int, moment: int, cells: NDArray[np.int64]) -> FloatArray:
    """Three standard normal numbers per cell, (cells, 3), from (seed, moment, cell) alone."""
    key = _mix(np.array([seed & 0xFFFFFFFFFFFFFFFF], dtype=_U) + _U(0x9E3779B97F4A7C15))
    key = _mix(key ^ _U(moment))
    base = _mix(cells.astype(_U) * _U(0xD1B54A32D192ED03) + key)
    words = np.stack([_mix(base + _U((0x9E3779B97F4A7C15 * (i + 1)) & 0xFFFFFFFFFFFFFFFF)) for i in range(4)], axis=-1)
    share = ((words >> _U(11)).astype(np.float64) + 0.5) * 2.0**-53
    radius = np.sqrt(-2.0 * np.log(share[:, :2]))
    turn = 2.0 * np.pi * share[:, 2:]
    out = np.empty((cells.size, 3))
    out[:, 0], out[:, 1] = radius[:, 0] * np.cos(turn[:, 0]), radius[:, 0] * np.sin(turn[:, 0])
    out[:, 2] = radius[:, 1] * np.cos(turn[:, 1])
    return out


def impulses(
    state: FloatArray,
    n: int,
    origin: float,
    density: float,
    noise: float,
    grain: float,
    interval: float,
    seed: int,
    moment: int,
) -> FloatArray:
    """Changes of velocity of the nodes 0 to n - 1, m/s, (n, 3).

    Parameters
    ----------
    state : ndarray
        State of the chain.
    n, origin
        Its number of elements, and the label of its front, m3.
    density, noise, grain, interval
        kg/m3, kg m2/s3, m3, s.
    seed, moment : int
        Which noise, and the number of the interval.
    """
    volume, label = state[:n, c.VOLUME], state[:n, c.LABEL]
    edges = origin + np.concatenate(([0.0], np.cumsum(label)))
    middle = 0.5 * (edges[1:] + edges[:-1])
    low = np.concatenate(([edges[0]], middle[:-1]))
    high = middle  # node i owns what lies between the middles of its elements
    first, last = int(edges[0] // grain), int(high[-1] // grain)
    cells = np.arange(first, last + 1, dtype=np.int64)
    push = np.sqrt(2.0 * noise * density * grain * interval) * normals(seed, moment, cells)
    summed = np.concatenate((np.zeros((1, 3)), np.cumsum(push, axis=0)))
    borders = grain * np.arange(first, last + 2)

    def before(at: FloatArray) -> FloatArray:
        return np.stack([np.interp(at, borders, summed[:, k]) for k in range(3)], axis=-1)

    mass = 0.5 * density * (volume + np.concatenate(([0.0], volume[:-1])))
    kick: FloatArray = (before(high) - before(low)) / mass[:, None]
    return kick
