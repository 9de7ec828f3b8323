"""What the frames themselves say of their noise: photons per count, whatever pixels share, and how many are averaged.

Two frames of the same beam differ by their noise alone, once they are brought to one brightness. If a photon's light falls on
several pixels, a pixel scatters less than its photons do, and its neighbours with it: the variance of one pixel then says too
many photons per count, by 8 to 18 times at a blur of 0.8 to 1.2 pixels. What counts for a jet many pixels wide is the noise
of sums of pixels, its power at frequency zero,

    S = sum_k C(k),    gain = mean/S,

C(k) being the covariance of pixels k apart. It is summed over the lags that blur reaches, less its level beyond them, which is
that of a beam that changes its shape. C(0)/S is how much less single pixels scatter (`along`: sums of rows, from C along
them). What a detector adds to the photons' own noise (swank) is in S, and so in the gain: photons that count.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.images.stacks import Stack

__all__ = ["PairNoise", "pair_noise"]

_PAIRS = 16
_REACH = 6  # pixels: farther, light is a tail, whose noise is little
_BEYOND = 10  # and as many more, for the level of a beam that changes its shape
_BENDS = 3  # order of a change of the beam's shape between two frames
_LEAST = 20  # rows or columns of a part whose neighbours can be compared
_SURE = 4.0  # standard deviations


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
    lags = np.zeros((2 * (_REACH + _BEYOND) + 1,) * 2)
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
        change, terms = _change_of_shape(d, 0.5 * (a + ratio * b), near)
        d -= change
        near = _near(d, good)
        d *= np.sqrt(near.sum() / max(int(near.sum()) - terms, 1))
        count = int(near.sum())
        scale = 1.0 + ratio  # var a + ratio^2 var b, with var b = var a / ratio
        variance += float((d[near] ** 2).sum()) / scale
        level += float(a[near].sum())
        samples += count
        used.append(i)
        if min(d.shape) >= _LEAST:
            _add_lags(np.where(near, d, 0.0) / np.sqrt(scale), near.astype(np.float64), lags, weight)
    if not samples:
        return PairNoise(0.0, still[0], 1, 0.0, np.nan) if still else None
    # squares of two differences that share a frame are correlated by 1/4
    repeated = 1.0 + 0.5 * float((np.diff(used) == 1).sum()) / len(used)
    power, std, along = _power(lags, weight, variance / samples, repeated)
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


def _change_of_shape(d: FloatArray, level: FloatArray, near: BoolArray) -> tuple[FloatArray, int]:
    """What of a difference is a smooth change of the beam, a polynomial times its level; and how many terms that took."""
    orders = [(i, j) for i in range(_BENDS + 1) for j in range(_BENDS + 1 - i)]
    enough = [n >= _LEAST for n in d.shape]
    orders = [(i, j) for i, j in orders if (i == 0 or enough[0]) and (j == 0 or enough[1])]
    if near.sum() < _LEAST * len(orders):
        return np.zeros_like(d), 0
    v, u = (np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, n), _BENDS) for n in d.shape)
    inside = np.where(near, level, 0.0)
    rows = [(inside * u[:, j]) for j in range(_BENDS + 1)]
    matrix = np.empty((len(orders),) * 2)
    right = np.empty(len(orders))
    for a, (i, j) in enumerate(orders):
        right[a] = v[:, i] @ (rows[j] * d).sum(axis=1)
        for b, (k, n) in enumerate(orders[: a + 1]):
            matrix[a, b] = matrix[b, a] = (v[:, i] * v[:, k]) @ (rows[j] * rows[n]).sum(axis=1)
    scale = np.sqrt(np.maximum(np.diagonal(matrix), 1e-300))
    found = np.linalg.lstsq(matrix / np.outer(scale, scale), right / scale, rcond=1e-10)[0] / scale
    shape = sum((c * np.outer(v[:, i], u[:, j]) for c, (i, j) in zip(found, orders, strict=True)), np.zeros(d.shape))
    return level * shape, len(orders)


def _add_lags(d: FloatArray, near: FloatArray, lags: FloatArray, weight: FloatArray) -> None:
    """Products of pixels at all lags within reach, and their numbers, by Fourier transform."""
    from scipy.fft import irfft2, next_fast_len, rfft2

    reach = lags.shape[0] // 2
    size = tuple(next_fast_len(n + reach, real=True) for n in d.shape)
    for array, into in ((d, lags), (near, weight)):
        spectrum = rfft2(array, size)
        product = irfft2(np.abs(spectrum) ** 2, size)
        at = np.arange(-reach, reach + 1)
        into += product[np.ix_(at, at)]


def _power(
    lags: FloatArray, weight: FloatArray, variance: float, repeated: float
) -> tuple[float, float, tuple[float, ...]]:
    """S, its relative standard deviation and the covariance along; the variance where neighbours are not seen to share.

    `repeated` is how often each independent product is in the sums.
    """
    if not weight.any() or not 0 < variance < np.inf:
        return variance, np.nan, (1.0,)
    reach = lags.shape[0] // 2
    covariance = lags / np.maximum(weight, 1.0)
    at = np.arange(-reach, reach + 1)
    far = np.maximum(np.abs(at[:, None]), np.abs(at))
    area = float(np.maximum((covariance / variance) ** 2, 0.0)[far <= _REACH].sum())  # pixels that go together
    independent = float(weight[reach, reach]) / repeated
    noise = variance * np.sqrt(max(area, 1.0) / independent)
    level = float(covariance[far > _REACH].mean())
    near = float(covariance[(far == 1)].mean()) - level
    if near < _SURE * noise / np.sqrt(4.0):  # of eight neighbours, four are independent
        return variance, np.sqrt(2.0 / max(independent, 1.0)), (1.0,)
    best = variance - level
    count = 1
    for width in range(1, _REACH + 1):
        ring = far == width
        number = int(ring.sum())
        added = float((covariance[ring] - level).sum())
        if added < noise * np.sqrt(2.0 * number) and width > 1:
            break
        best += added
        count += number
    power = best
    along = (covariance[reach : reach + _REACH + 1, reach] - level) / power
    patches = max(independent / count, 1.0)  # of the size that is summed over: each tells the power once
    return power, float(np.sqrt(2.0 / patches)), tuple(along.tolist())
