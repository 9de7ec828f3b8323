"""Power of the noise in differences of two frames: what sums of pixels scatter, whatever pixels share.

If a photon's light falls on several pixels, a pixel scatters less than its photons do, and its neighbours with it: the variance
of one pixel then says too many photons per count, by 8 to 18 times at a blur of 0.8 to 1.2 pixels. What counts for a jet many
pixels wide is the noise of sums of pixels, its power at frequency zero,

    S = sum_k C(k),    gain = mean/S,

C(k) being the covariance of pixels k apart. It is summed over the lags that blur reaches, less its level beyond them, which is
that of a beam that changes its shape. C(0)/S is how much less single pixels scatter (`along`: sums of rows, from C along
them). What a detector adds to the photons' own noise (swank) is in S, and so in the gain: photons that count.
"""

import numpy as np

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["LAGS", "LEAST", "add_lags", "change_of_shape", "noise_power"]

LEAST = 20
"""Rows or columns of a part whose neighbours can be compared."""
_REACH = 6  # pixels: farther, light is a tail, whose noise is little
_BEYOND = 10  # and as many more, for the level of a beam that changes its shape
LAGS = 2 * (_REACH + _BEYOND) + 1
"""Lags that are looked at, along and across."""
_BENDS = 3  # order of a change of the beam's shape between two frames
_SURE = 4.0  # standard deviations


def change_of_shape(d: FloatArray, level: FloatArray, near: BoolArray) -> tuple[FloatArray, int]:
    """What of a difference is a smooth change of the beam, a polynomial times its level; and how many terms that took."""
    orders = [(i, j) for i in range(_BENDS + 1) for j in range(_BENDS + 1 - i)]
    enough = [n >= LEAST for n in d.shape]
    orders = [(i, j) for i, j in orders if (i == 0 or enough[0]) and (j == 0 or enough[1])]
    if near.sum() < LEAST * len(orders):
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


def add_lags(d: FloatArray, near: FloatArray, lags: FloatArray, weight: FloatArray) -> None:
    """Products of pixels at all lags within reach, and their numbers, by Fourier transform."""
    from scipy.fft import irfft2, next_fast_len, rfft2

    reach = lags.shape[0] // 2
    size = tuple(next_fast_len(n + reach, real=True) for n in d.shape)
    for array, into in ((d, lags), (near, weight)):
        spectrum = rfft2(array, size)
        product = irfft2(np.abs(spectrum) ** 2, size)
        at = np.arange(-reach, reach + 1)
        into += product[np.ix_(at, at)]


def noise_power(
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
