"""Where one jet lays its fibre: centre, spread and their errors.

Laid points are correlated over metres of fibre, so errors come from a bootstrap of *blocks* of consecutive segments; fewer than
8 blocks give NaN rather than an error that means nothing.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from spinline.base.checks import FloatArray, number
from spinline.base.errors import InputError
from spinline.deposit.segments import Segments

__all__ = ["Footprint", "footprint_of"]

_LEAST_BLOCKS = 8


@dataclass(frozen=True)
class Footprint:
    """Length-weighted moments of where a fibre lies, and their bootstrap errors.

    Attributes
    ----------
    centre, centre_std : ndarray, (2,)
        m.
    covariance, covariance_std : ndarray, (2, 2)
        m2.
    semi_axes : ndarray, (2,)
        Of the ellipse that holds 95 % of a normal footprint, m, the longer first.
    tilt : float
        Direction of the longer axis against the machine, rad in (-pi/2, pi/2].
    blocks : int
        How many blocks the errors rest on.
    """

    centre: FloatArray
    centre_std: FloatArray
    covariance: FloatArray
    covariance_std: FloatArray
    semi_axes: FloatArray
    tilt: float
    blocks: int


def footprint_of(segments: Segments, *, blocks: int = 20, resamples: int = 400, seed: int = 0) -> Footprint:
    """Footprint of the segments of one jet, in order of landing.

    Parameters
    ----------
    segments : Segments
        From a resting collector (or less its motion).
    blocks : int
        Of equal length of fibre, >= 2.
    resamples : int
        Of the blocks, >= 2.
    seed : int

    Returns
    -------
    Footprint

    Raises
    ------
    InputError
        For no fibre.
    """
    if not len(segments):
        raise InputError("fibres", "is empty: nothing has landed")
    count = int(number("blocks", blocks, least=2, most=1e6))
    w = segments.length
    x, y = segments.x + 0.5 * segments.dx, segments.y + 0.5 * segments.dy
    origin = np.array([x.mean(), y.mean()])  # moments about a near point: nothing cancels far from the origin
    u, v = x - origin[0], y - origin[1]
    rows = np.stack(
        [
            w,
            w * u,
            w * v,
            w * (u * u + segments.dx**2 / 12),
            w * (v * v + segments.dy**2 / 12),
            w * (u * v + segments.dx * segments.dy / 12),
        ]
    )
    label = np.minimum((np.cumsum(w) - 0.5 * w) / w.sum() * count, count - 1).astype(int)
    sums = np.stack([np.bincount(label, row, minlength=count) for row in rows])
    used = int((sums[0] > 0).sum())
    centre, covariance = _moments(sums.sum(axis=1))
    if used >= _LEAST_BLOCKS:
        rng = np.random.default_rng(seed)
        draws = rng.integers(0, count, (int(number("resamples", resamples, least=2, most=1e6)), count))
        drawn = [_moments(sums[:, row].sum(axis=1)) for row in draws]
        centre_std = np.std([c for c, _ in drawn], axis=0, ddof=1)
        covariance_std = np.std([c for _, c in drawn], axis=0, ddof=1)
    else:
        centre_std, covariance_std = np.full(2, np.nan), np.full((2, 2), np.nan)
    values, vectors = np.linalg.eigh(covariance)
    long = vectors[:, 1]
    tilt = float(np.arctan(long[1] / long[0])) if long[0] != 0 else np.pi / 2
    axes = np.sqrt(np.maximum(values[::-1], 0.0) * stats.chi2.ppf(0.95, 2))
    return Footprint(centre + origin, centre_std, covariance, covariance_std, axes, tilt, used)


def _moments(sums: FloatArray) -> tuple[FloatArray, FloatArray]:
    total, mx, my, xx, yy, xy = sums
    cx, cy = mx / total, my / total
    return np.array([cx, cy]), np.array(
        [[xx / total - cx * cx, xy / total - cx * cy], [xy / total - cx * cy, yy / total - cy * cy]]
    )
