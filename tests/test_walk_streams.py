"""Streams of the walk: published vectors, independence of threads and chunks, stored numbers."""

import numpy as np
import pytest

from spinline import network as net
from spinline.network.walk import _streams


def rising(segments: int) -> net.Strand:
    """Tension from 0.5 to 3 along the strand, lateral forces that differ and change sign."""
    forces = np.empty((segments, 3))
    forces[:, 0], forces[:, 1] = 0.15, np.linspace(-0.4, 0.2, segments)
    forces[:, 2] = np.linspace(0.5, 3.0, segments)
    return net.varying_strand(forces)


def test_philox_published_vectors() -> None:
    """Random123 known answers of philox4x32-10; the last counter word is always 0 here, hence the two that fit."""
    state = _streams.open_stream(np.uint64(0), 0, 0)
    assert [hex(word) for word in state] == ["0x6627e8d5", "0xe169c58d", "0xbc57ac4c", "0x9b00dbd8"]

    def philox(counter: list[int], key: list[int]) -> list[int]:
        for _ in range(10):
            p0, p1 = 0xD2511F53 * counter[0], 0xCD9E8D57 * counter[2]
            counter = [
                (p1 >> 32) ^ counter[1] ^ key[0],
                p1 & 0xFFFFFFFF,
                (p0 >> 32) ^ counter[3] ^ key[1],
                p0 & 0xFFFFFFFF,
            ]
            key = [(key[0] + 0x9E3779B9) & 0xFFFFFFFF, (key[1] + 0xBB67AE85) & 0xFFFFFFFF]
        return counter

    known = [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1]  # the third published vector, for the reference itself
    assert philox([0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344], [0xA4093822, 0x299F31D0]) == known
    for seed, index, purpose in ((2**64 - 1, 2**63 - 1, 1), (0xDEADBEEF12345678, 12345678901234, 0)):
        words = philox([index & 0xFFFFFFFF, index >> 32, purpose, 0], [seed & 0xFFFFFFFF, seed >> 32])
        assert list(_streams.open_stream(np.uint64(seed), index, purpose)) == words
        state = np.empty(28, np.uint32)
        _streams.open_streams(np.uint64(seed), index - 3, purpose, np.empty((4, 7), np.uint64), state)
        assert list(state[3::7]) == words


def test_xoshiro_against_its_definition() -> None:
    def rotate(x: int, k: int) -> int:
        return ((x << k) | (x >> (32 - k))) & 0xFFFFFFFF

    s = [1, 2, 3, 4]
    state = tuple(np.uint32(v) for v in s)
    for _ in range(1000):
        expected = (rotate((s[0] + s[3]) & 0xFFFFFFFF, 7) + s[0]) & 0xFFFFFFFF
        t = (s[1] << 9) & 0xFFFFFFFF
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= t
        s[3] = rotate(s[3], 11)
        number, *state = _streams.next_state(*state)
        assert number == expected
    assert list(state) == s


@pytest.mark.parametrize("method", ["multinomial", "steps"])
def test_same_strands_for_any_number_of_threads_and_any_chunk(method: str) -> None:
    strand = net.affine_strand(20.0, 0.05)
    whole = net.sample_strands(strand, 5000, 42, method=method)
    for threads, chunk in ((1, 1000), (2, 65_536), (2, 77), (4, 256), (3, 1)):
        count = 200 if chunk == 1 else 5000
        other = net.sample_strands(strand, count, 42, method=method, threads=threads, chunk=chunk)
        np.testing.assert_array_equal(other.end_to_end, whole.end_to_end[:count])
        np.testing.assert_array_equal(other.axial_steps, whole.axial_steps[:count])
    late = net.sample_strands(strand, 1000, 42, method=method, first=3000)
    np.testing.assert_array_equal(late.end_to_end, whole.end_to_end[3000:4000])
    assert (net.sample_strands(strand, 100, 43, method=method).end_to_end != whole.end_to_end[:100]).any()


def test_neighbouring_strands_and_seeds_are_uncorrelated() -> None:
    strand = rising(100)
    z = net.sample_strands(strand, 200_000, 0).end_to_end[:, 2].astype(float)
    other = net.sample_strands(strand, 200_000, 1).end_to_end[:, 2].astype(float)
    for a, b in ((z[1:], z[:-1]), (z, other), (z[256:], z[:-256])):
        assert abs(np.corrcoef(a, b)[0, 1]) < 4 / np.sqrt(a.size)


def test_regression_of_the_numbers() -> None:
    """A result can be made again: computed with version 0.1.0; a change here is a change of every stored sample."""
    steps = net.sample_strands(rising(37), 3, 2026).end_to_end
    multinomial = net.sample_strands(net.affine_strand(20.0, 0.05), 3, 2026).end_to_end
    np.testing.assert_array_equal(steps, STEPS_2026)
    np.testing.assert_array_equal(multinomial, MULTINOMIAL_2026)


STEPS_2026 = [[4, -8, 23], [-2, -4, 21], [1, 2, 20]]
MULTINOMIAL_2026 = [[-1, -6, 331], [-4, -5, 333], [11, 0, 333]]
