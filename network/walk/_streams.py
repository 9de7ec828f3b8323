"""Random streams from (seed, index): Philox4x32-10 opens a xoshiro128++ for every strand.

Philox is a bijection of its 128-bit counter: two (index, purpose) pairs never open the same stream under one
seed, and no strand's numbers depend on how many others are walked, in which order or by which thread.
xoshiro128++ then costs some ten 32-bit operations a number, all of which vectorise across strands; its period
is 2^128 - 1 and it passes BigCrush.

numba widens 32-bit sums to 64 bits, hence the casts: LLVM narrows them back.

References
----------
Salmon, Moraes, Dror, Shaw, SC'11 (2011): Philox. Blackman, Vigna, ACM Trans. Math. Softw. 47, 36 (2021).
"""

from typing import Any

import numpy as np

from spinline.base.kernels import njit

__all__ = ["MULTINOMIAL", "STEPS", "next_state", "open_stream", "open_streams", "uniform"]

STEPS, MULTINOMIAL = 0, 1  # purposes: streams that must not be shared

_M0, _M1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
_W0, _W1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
_LOW = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_ONE = np.uint32(1)


@njit(cache=True)
def open_stream(seed: Any, index: Any, purpose: Any) -> Any:
    """Four uint32 of state for (seed, index, purpose): one Philox4x32-10 block."""
    key = np.uint64(seed)
    k0, k1 = key & _LOW, key >> _HALF
    place = np.uint64(index)
    c0, c1, c2, c3 = place & _LOW, place >> _HALF, np.uint64(purpose), np.uint64(0)
    for _ in range(10):
        p0, p1 = _M0 * c0, _M1 * c2
        c0, c1, c2, c3 = (p1 >> _HALF) ^ c1 ^ k0, p1 & _LOW, (p0 >> _HALF) ^ c3 ^ k1, p0 & _LOW
        k0, k1 = (k0 + _W0) & _LOW, (k1 + _W1) & _LOW
    a, b, c, d = np.uint32(c0), np.uint32(c1), np.uint32(c2), np.uint32(c3)
    if a | b | c | d == 0:  # the one state that xoshiro cannot leave
        a = _ONE
    return a, b, c, d


@njit(cache=True, nogil=True)
def open_streams(seed: Any, first: Any, purpose: Any, work: Any, state: Any) -> None:
    """`open_stream` for the indices first, first + 1, ..., a round at a time so that it vectorises.

    `work` is uint64 of shape (4, n); word k of stream i goes to ``state[k n + i]``.
    """
    key = np.uint64(seed)
    k0, k1 = key & _LOW, key >> _HALF
    c0, c1, c2, c3 = work[0], work[1], work[2], work[3]
    n = c0.size
    for i in range(n):
        place = np.uint64(first) + np.uint64(i)
        c0[i], c1[i], c2[i], c3[i] = place & _LOW, place >> _HALF, np.uint64(purpose), np.uint64(0)
    for _ in range(10):
        for i in range(n):
            p0, p1 = _M0 * c0[i], _M1 * c2[i]
            c0[i] = (p1 >> _HALF) ^ c1[i] ^ k0
            c1[i] = p1 & _LOW
            c2[i] = (p0 >> _HALF) ^ c3[i] ^ k1
            c3[i] = p0 & _LOW
        k0, k1 = (k0 + _W0) & _LOW, (k1 + _W1) & _LOW
    for i in range(n):
        state[i], state[n + i] = np.uint32(c0[i]), np.uint32(c1[i])
        state[2 * n + i], state[3 * n + i] = np.uint32(c2[i]), np.uint32(c3[i])
        if c0[i] | c1[i] | c2[i] | c3[i] == 0:
            state[i] = _ONE


@njit(cache=True, inline="always")
def _rotate(x: Any, k: Any) -> Any:
    return np.uint32((np.uint32(x) << np.uint32(k)) | (np.uint32(x) >> np.uint32(32 - k)))


@njit(cache=True, inline="always")
def next_state(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Next 32-bit number of xoshiro128++, and the state after it."""
    total = np.uint32(a + d)
    number = np.uint32(_rotate(total, 7) + a)
    shifted = np.uint32(b << np.uint32(9))
    c = np.uint32(c ^ a)
    d = np.uint32(d ^ b)
    b = np.uint32(b ^ c)
    a = np.uint32(a ^ d)
    c = np.uint32(c ^ shifted)
    d = _rotate(d, 11)
    return number, a, b, c, d


@njit(cache=True)
def uniform(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Number in (0, 1) with 53 bits from two of 32, and the state after it."""
    high, a, b, c, d = next_state(a, b, c, d)
    low, a, b, c, d = next_state(a, b, c, d)
    bits = (np.uint64(high) >> np.uint64(5)) * np.uint64(67108864) + (np.uint64(low) >> np.uint64(6))
    return (np.float64(bits) + 0.5) / 9007199254740992.0, a, b, c, d
