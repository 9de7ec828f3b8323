"""What the frames themselves say of their noise: photons per count, whatever pixels share, and how many are averaged.

Two frames of the same beam differ by their noise alone, once they are brought to one brightness; what its power says is in
`spinline.xray.frame.noise_power`.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.images.stacks import Stack
from spinline.xray.frame.noise_power import LAGS, LEAST, add_lags, change_of_shape, noise_power

__all__ = ["PairNoise", "pair_noise"]

_PAIRS = 16


@dataclass(frozen=True)
class PairNoise:
    """Noise of a single frame.

    Attributes
    ----------
    variance, level : float
        Mean variance of a pixel, and mean level above dark, counts.
    samples : int
        Pairs of pixels, as many as would say as much if each frame were in one pair alone.
    power : float
        S: the variance of a sum of pixels, over their number.
    power_std : float
        Its relative standard deviation.
    along : tuple of float
        Covariance of pixels 0, 1, 2, ... rows apart, over S; (1,) where pixels do not share light.
    """

    variance: float
    level: float
    samples: int
    power: float
    power_std: float
    along: tuple[float, ...] = (1.0,)


def pair_noise(
    stack: Stack, part: tuple[slice, slice] = (slice(None), slice(None)), dark: FloatArray | float = 0.0
) -> PairNoise | None:
    """Noise of single frames, from differences of neighbours.

    Parameters
    ----------
    stack : Stack
    part : (slice, slice)
        Rows and columns to look at.
    dark : ndarray or float
        Level without a beam, taken off before frames are brought to one brightness.

    Returns
    -------
    PairNoise, or None for fewer than two frames.

    Notes
    -----
    Pairs are scaled to the same mean and bent to the same shape (a beam that flickers or moves is no noise), and pixels 6
    robust standard deviations off left out. Up to 16 pairs, spread over the stack. Neighbours are compared where the part has
    20 rows and columns.
    """
    if stack.frames < 2:
        return None
    pairs = np.unique(np.linspace(0, stack.frames - 2, _PAIRS).astype(int))
    variance = level = 0.0
    samples = 0
    used: list[int] = []
    still: list[float] = []
    lags = np.zeros((LAGS, LAGS))
    weight = np.zeros_like(lags)
    for i in pairs.tolist():
        first, second = np.asarray(stack.read(i, i + 2), dtype=np.float64)
        off = np.broadcast_to(np.asarray(dark, dtype=np.float64), first.shape)[part]
        seen = np.isfinite(first) & np.isfinite(second)
        first, second = np.where(seen, first, np.nan), np.where(seen, second, np.nan)
        a, b = first[part] - off, second[part] - off
        good = seen[part]
        good &= ~_stuck(first[part], second[part])
        if good.sum() < 16:
            continue
        raw_a, raw_b = first[part][good], second[part][good]
        if np.ptp(raw_a) == 0.0 or np.ptp(raw_b) == 0.0 or bool((raw_a == raw_b).all()):
            still.append(float(a[good].mean()))  # a frame was lost or copied, or all are alike
            continue
        mean_a, mean_b = float(a[good].mean()), float(b[good].mean())
        ratio = mean_a / mean_b if mean_a > 0 and mean_b > 0 and abs(mean_a / mean_b - 1) < 0.5 else 1.0
        d = np.where(good, a - ratio * b, 0.0)
        near = _near(d, good)
        change, terms = change_of_shape(d, 0.5 * (a + ratio * b), near)
        d -= change
        near = _near(d, good)
        d *= np.sqrt(near.sum() / max(int(near.sum()) - terms, 1))
        count = int(near.sum())
        scale = 1.0 + ratio  # var a + ratio^2 var b, with var b = var a / ratio
        variance += float((d[near] ** 2).sum()) / scale
        level += float(a[near].sum())
        samples += count
        used.append(i)
        if min(d.shape) >= LEAST:
            add_lags(np.where(near, d, 0.0) / np.sqrt(scale), near.astype(np.float64), lags, weight)
    if not samples:
        return PairNoise(0.0, still[0], 1, 0.0, np.nan) if still else None
    # squares of two differences that share a frame are correlated by 1/4
    repeated = 1.0 + 0.5 * float((np.diff(used) == 1).sum()) / len(used)
    power, std, along = noise_power(lags, weight, variance / samples, repeated)
    return PairNoise(variance / samples, level / samples, int(samples / repeated), power, std, along)


def _stuck(first: FloatArray, second: FloatArray) -> BoolArray:
    """Pixels that hold one number in both frames, far from the others': marks, and dead pixels."""
    level = float(np.nanmedian(first)) if np.isfinite(first).any() else 0.0
    same = (first == second) & ((first > 3.0 * level) | (first < level / 3.0)) if level > 5.0 else first != first
    return np.asarray(same if same.mean() < 0.5 else np.zeros_like(same))


def _near(d: FloatArray, good: BoolArray) -> BoolArray:
    """Good pixels within 6 robust standard deviations."""
    spread = 1.4826 * float(np.median(np.abs(d[good])))
    return good & (np.abs(d) <= 6.0 * spread) if spread > 0 else good
