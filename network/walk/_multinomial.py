"""Exact multinomial steps of a strand under uniform force: five binomials instead of N_s steps.

Binomials: inversion where ``n p < 10``, else the transformed rejection BTRS, with Loader's saddle-point form
of the probability, so that 1e12 segments lose no digits. A probability and its complement are both given,
since ``1 - p`` would round away the last bent segments of a taut strand.

References
----------
Hoermann, J. Stat. Comput. Simul. 46, 101 (1993): BTRS. Loader, "Fast and accurate computation of binomial
probabilities" (2000).
"""

import math
from typing import Any

import numpy as np

from spinline.base.kernels import njit
from spinline.network.walk._streams import MULTINOMIAL, open_stream, uniform

__all__ = ["log_binomial", "sample_binomials", "sample_multinomial"]

_INVERSION = 10.0
_HALF_LOG_2PI = 0.9189385332046727


@njit(cache=True)
def _stirling_error(n: float) -> float:
    """``ln n! - [(n + 1/2) ln n - n + ln(2 pi)/2]`` for n >= 1."""
    if n < 16:
        return math.lgamma(n + 1) - (n + 0.5) * math.log(n) + n - _HALF_LOG_2PI
    s = n * n
    return (1 / 12 - (1 / 360 - (1 / 1260 - (1 / 1680 - 1 / 1188 / s) / s) / s) / s) / n


@njit(cache=True)
def _deviance(x: float, mean: float) -> float:
    """``x ln(x/mean) - x + mean``, from the relative deviation, so that nothing large cancels."""
    t = (x - mean) / mean
    if abs(t) < 1e-3:
        return mean * t * t * (0.5 - t * (1 / 6 - t * (1 / 12 - t * (0.05 - t / 30))))
    return mean * ((1 + t) * math.log1p(t) - t)


@njit(cache=True)
def log_binomial(k: float, n: float, p: float, q: float) -> float:
    """Logarithm of the probability of k successes in n, ``q = 1 - p``, both > 0."""
    if k == 0:
        return n * math.log1p(-p) if p < 0.5 else n * math.log(q)
    if k == n:
        return n * math.log1p(-q) if q < 0.5 else n * math.log(p)
    value = _stirling_error(n) - _stirling_error(k) - _stirling_error(n - k)
    value -= _deviance(k, n * p) + _deviance(n - k, n * q)
    return value + 0.5 * math.log(n / (k * (n - k))) - _HALF_LOG_2PI


@njit(cache=True)
def _by_inversion(n: Any, p: float, q: float, a: Any, b: Any, c: Any, d: Any) -> Any:
    none = math.exp(n * math.log1p(-p))
    odds = p / q
    while True:
        u, a, b, c, d = uniform(a, b, c, d)
        k = 0
        chance = none
        while u > chance and k < 200 and k < n:  # beyond 200 the chance is below 1e-180: only rounding gets there
            u -= chance
            k += 1
            chance *= odds * ((n - k + 1) / k)
        if u <= chance:
            return k, a, b, c, d


@njit(cache=True)
def _by_rejection(trials: Any, p: float, q: float, a: Any, b: Any, c: Any, d: Any) -> Any:
    n = float(trials)  # products of counts pass 2^63
    spread = math.sqrt(n * p * q)
    wide = 1.15 + 2.53 * spread
    tail = -0.0873 + 0.0248 * wide + 0.01 * p
    centre = n * p + 0.5
    squeeze = 0.92 - 4.2 / wide
    alpha = (2.83 + 5.1 / wide) * spread
    top = log_binomial(float(math.floor((n + 1) * p)), n, p, q)
    while True:
        u, a, b, c, d = uniform(a, b, c, d)
        v, a, b, c, d = uniform(a, b, c, d)
        u -= 0.5
        edge = 0.5 - abs(u)
        k = float(math.floor((2 * tail / edge + wide) * u + centre))
        if edge >= 0.07 and v <= squeeze:
            return np.int64(k), a, b, c, d
        if k < 0 or k > n:
            continue
        if math.log(v * alpha / (tail / (edge * edge) + wide)) <= log_binomial(k, n, p, q) - top:
            return np.int64(k), a, b, c, d


@njit(cache=True)
def _binomial(n: Any, p: float, q: float, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Successes in n trials of probability p, ``q = 1 - p``, and the state of the stream after it."""
    if n == 0 or p == 0.0:
        return 0, a, b, c, d
    if q == 0.0:
        return n, a, b, c, d
    least, most = min(p, q), max(p, q)
    if n * least < _INVERSION:
        k, a, b, c, d = _by_inversion(n, least, most, a, b, c, d)
    else:
        k, a, b, c, d = _by_rejection(n, least, most, a, b, c, d)
    return k if p <= q else n - k, a, b, c, d


@njit(cache=True, nogil=True)
def sample_binomials(seed: Any, first: Any, n: Any, p: float, q: float, out: Any) -> None:
    """One binomial of every stream first, first + 1, ...: what the tests look at."""
    for i in range(out.shape[0]):
        a, b, c, d = open_stream(seed, first + i, MULTINOMIAL)
        out[i], a, b, c, d = _binomial(np.int64(n), p, q, a, b, c, d)


@njit(cache=True, nogil=True)
def sample_multinomial(seed: Any, first: Any, n: Any, split: Any, ends: Any, axial: Any) -> None:
    """End-to-end vectors and axial steps of the strands first, first + 1, ...

    `split` holds five pairs (p, 1 - p): axial or not, x or y, and + or - for x, y, z.
    """
    for i in range(axial.size):
        a, b, c, d = open_stream(seed, first + i, MULTINOMIAL)
        along, a, b, c, d = _binomial(np.int64(n), split[0, 0], split[0, 1], a, b, c, d)
        x, a, b, c, d = _binomial(n - along, split[1, 0], split[1, 1], a, b, c, d)
        for axis, steps in ((0, x), (1, n - along - x), (2, along)):
            plus, a, b, c, d = _binomial(steps, split[2 + axis, 0], split[2 + axis, 1], a, b, c, d)
            ends[i, axis] = 2 * plus - steps
        axial[i] = along
