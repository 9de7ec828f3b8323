"""Steps of many strands at once, compiled: 32-bit thresholds, one monomer for a block of strands at a time.

A 32-bit number u picks the direction of a step by five thresholds, ``T_1 <= ... <= T_5``: as many counters as
thresholds count how often ``u < T_k``, and the number of steps in direction k is the difference of two
counters. No branch and no table, so that the loop over strands runs in the vector unit.

Thresholds are stored less 2^31, since vector units compare signed integers.
"""

from typing import Any

import numpy as np

from spinline.base.kernels import njit
from spinline.network.walk._streams import STEPS, next_state, open_stream, open_streams

__all__ = ["BLOCK", "UNROLL", "generator_alone", "thresholds", "walk_paths", "walk_strands"]

BLOCK = 256  # strands walked together: state and counters fit the first-level cache
UNROLL = 4  # monomers for which a strand's state stays in registers

_SIGN = np.uint32(0x80000000)
_WHOLE = 4294967296.0


@njit(cache=True)
def thresholds(probabilities: Any, order: Any, table: Any) -> None:
    """Cumulative 32-bit thresholds of every monomer, rounding carried from monomer to monomer.

    Direction ``order[k]`` has the weight ``floor(2^32 P + carry)``: along the strand the sum of the weights
    stays within one unit of 2^32 times the sum of the probabilities, so that no mean is biased by more than
    5 x 2^-32 steps however long the strand. The last direction of `order` (the likeliest) takes the rest.
    Rows of `table` beyond the monomers are left at "no step".
    """
    carry = np.zeros(5)
    weight = np.zeros(5, dtype=np.int64)
    for i in range(table.shape[0]):
        for k in range(5):
            table[i, k] = -2147483648
        if i >= probabilities.shape[0]:
            continue
        total = 0
        for k in range(5):
            wanted = _WHOLE * probabilities[i, order[k]] + carry[k]
            weight[k] = np.int64(np.floor(wanted))
            carry[k] = wanted - weight[k]
            total += weight[k]
        while total > 4294967295:  # a threshold of 2^32 does not fit: the largest weight gives way by a unit
            weight[np.argmax(weight)] -= 1
            total -= 1
        total = 0
        for k in range(5):
            total += weight[k]
            table[i, k] = np.int32(total - 2147483648)


@njit(cache=True, inline="always")
def _below(number: Any, threshold: Any) -> Any:
    return np.int32(np.int32(number ^ _SIGN) < threshold)


@njit(cache=True, nogil=True)
def walk_strands(seed: Any, first: Any, monomers: Any, table: Any, order: Any, ends: Any, axial: Any) -> None:
    """End-to-end vectors and axial steps of the strands first, first + 1, ...

    `table` has a multiple of UNROLL rows; a strand's numbers depend on (seed, its index) alone.
    """
    steps = np.empty(6, np.int64)
    state, n = np.empty(4 * BLOCK, np.uint32), np.empty(5 * BLOCK, np.int32)
    work = np.empty((4, BLOCK), np.uint64)
    for start in range(0, axial.size, BLOCK):
        count = min(BLOCK, axial.size - start)
        open_streams(seed, first + start, STEPS, work, state)
        n[:] = 0
        _walk_block(state, n, table)
        for i in range(count):
            below = 0
            for k in range(5):
                steps[order[k]] = n[k * BLOCK + i] - below
                below = n[k * BLOCK + i]
            steps[order[5]] = monomers - below
            for axis in range(3):
                ends[start + i, axis] = steps[2 * axis] - steps[2 * axis + 1]
            axial[start + i] = steps[4] + steps[5]


@njit(cache=True, nogil=True)
def _walk_block(state: Any, n: Any, table: Any) -> None:
    """Walk BLOCK strands; four rows of `state`, five of `n`.

    One flat array each, rows a constant apart: only so does every LLVM see that they do not overlap.
    """
    for m in range(0, table.shape[0], UNROLL):
        p0, p1, p2, p3, p4 = table[m, 0], table[m, 1], table[m, 2], table[m, 3], table[m, 4]
        q0, q1, q2, q3, q4 = table[m + 1, 0], table[m + 1, 1], table[m + 1, 2], table[m + 1, 3], table[m + 1, 4]
        r0, r1, r2, r3, r4 = table[m + 2, 0], table[m + 2, 1], table[m + 2, 2], table[m + 2, 3], table[m + 2, 4]
        s0, s1, s2, s3, s4 = table[m + 3, 0], table[m + 3, 1], table[m + 3, 2], table[m + 3, 3], table[m + 3, 4]
        for i in range(BLOCK):
            u, a, b, c, d = next_state(state[i], state[i + BLOCK], state[i + 2 * BLOCK], state[i + 3 * BLOCK])
            v, a, b, c, d = next_state(a, b, c, d)
            w, a, b, c, d = next_state(a, b, c, d)
            x, a, b, c, d = next_state(a, b, c, d)
            state[i], state[i + BLOCK], state[i + 2 * BLOCK], state[i + 3 * BLOCK] = a, b, c, d
            n[i] += _below(u, p0) + _below(v, q0) + _below(w, r0) + _below(x, s0)
            n[i + BLOCK] += _below(u, p1) + _below(v, q1) + _below(w, r1) + _below(x, s1)
            n[i + 2 * BLOCK] += _below(u, p2) + _below(v, q2) + _below(w, r2) + _below(x, s2)
            n[i + 3 * BLOCK] += _below(u, p3) + _below(v, q3) + _below(w, r3) + _below(x, s3)
            n[i + 4 * BLOCK] += _below(u, p4) + _below(v, q4) + _below(w, r4) + _below(x, s4)


@njit(cache=True, nogil=True)
def generator_alone(seed: Any, monomers: Any, out: Any) -> None:
    """As `walk_strands`, but only sums the numbers: the bare generator, for benchmarks."""
    state = np.empty(5 * BLOCK, np.uint32)
    work = np.empty((4, BLOCK), np.uint64)
    for start in range(0, out.shape[0], BLOCK):
        open_streams(seed, start, STEPS, work, state)
        state[4 * BLOCK :] = 0
        _sum_block(state, monomers)
        for i in range(min(BLOCK, out.shape[0] - start)):
            out[start + i] = state[i + 4 * BLOCK]


@njit(cache=True, nogil=True)
def _sum_block(state: Any, monomers: Any) -> None:
    for _ in range(0, monomers, UNROLL):
        for i in range(BLOCK):
            u, a, b, c, d = next_state(state[i], state[i + BLOCK], state[i + 2 * BLOCK], state[i + 3 * BLOCK])
            v, a, b, c, d = next_state(a, b, c, d)
            w, a, b, c, d = next_state(a, b, c, d)
            x, a, b, c, d = next_state(a, b, c, d)
            state[i], state[i + BLOCK], state[i + 2 * BLOCK], state[i + 3 * BLOCK] = a, b, c, d
            state[i + 4 * BLOCK] = np.uint32(state[i + 4 * BLOCK] + u + v + w + x)


@njit(cache=True, nogil=True)
def walk_paths(seed: Any, first: Any, monomers: Any, table: Any, order: Any, out: Any) -> None:
    """Positions (strand, monomer, axis) of the very walks that `walk_strands` counts."""
    place = np.zeros(3, np.int64)
    for i in range(out.shape[0]):
        a, b, c, d = open_stream(seed, first + i, STEPS)
        place[:] = 0
        out[i, 0, :] = 0
        for m in range(monomers):
            u, a, b, c, d = next_state(a, b, c, d)
            above = 0  # thresholds passed: no branch to mispredict
            for k in range(5):
                above += 1 - _below(u, table[m, k])
            direction = order[above]
            place[direction // 2] += 1 - 2 * (direction % 2)
            for axis in range(3):
                out[i, m + 1, axis] = place[axis]
