"""Estimates from a sample: coverage of their intervals, control variates, histograms."""

import math

import numpy as np
import pytest

from spinline import network as net


def rising(segments: int) -> net.Strand:
    """Tension from 0.5 to 3 along the strand, lateral forces that differ and change sign."""
    forces = np.empty((segments, 3))
    forces[:, 0], forces[:, 1] = 0.15, np.linspace(-0.4, 0.2, segments)
    forces[:, 2] = np.linspace(0.5, 3.0, segments)
    return net.varying_strand(forces)


CASES = {
    "multinomial": (net.affine_strand(20.0, 0.05), "multinomial"),
    "multinomial at rest": (net.affine_strand(1.0, 0.05), "multinomial"),
    "steps": (net.affine_strand(20.0, 0.05), "steps"),
    "steps that vary": (rising(403), "steps"),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_stated_intervals_cover(case: str) -> None:
    """95 % intervals over 1,000 replicates of 2,000 strands hold the truth 93 to 97 times in a hundred."""
    strand, method = CASES[case]
    exact, size = net.walk_moments(strand), 2000
    everything = net.sample_strands(strand, 1000 * size, 123, method=method, threads=2)
    hits = np.zeros(5)
    for i in range(1000):
        rows = slice(i * size, (i + 1) * size)
        part = net.StrandSample(
            strand, everything.end_to_end[rows], everything.axial_steps[rows], method, 123, i * size
        )
        m = net.sample_moments(part)
        got = [m.mean[0], m.mean[2], m.covariance[0, 0], m.covariance[2, 2], m.orientation]
        error = [
            m.mean_error[0],
            m.mean_error[2],
            m.covariance_error[0, 0],
            m.covariance_error[2, 2],
            m.orientation_error,
        ]
        truth = [exact.mean[0], exact.mean[2], exact.covariance[0, 0], exact.covariance[2, 2], exact.orientation]
        hits += np.abs(np.subtract(got, truth)) <= 1.959964 * np.array(error)
    assert (hits >= 930).all(), hits
    assert (hits <= 970).all(), hits


def test_intervals_with_control_variates_cover_in_small_samples() -> None:
    """400 strands, 1,000 replicates; one variance for all residuals would cover 0.91 to 0.92."""
    strand, size = net.uniform_strand(204, 1.68, 0.21), 400

    def length(r: np.ndarray) -> np.ndarray:
        return np.sqrt((r**2).sum(axis=1))

    everything = net.sample_strands(strand, 1000 * size, 5)
    truth, hits = net.sample_average(everything, length).value, 0
    for i in range(1000):
        rows = slice(i * size, (i + 1) * size)
        part = net.StrandSample(
            strand, everything.end_to_end[rows], everything.axial_steps[rows], everything.method, 5, i * size
        )
        average = net.sample_average(part, length)
        hits += abs(average.value - truth) <= 1.959964 * average.error
    assert 930 <= hits <= 970, hits


def test_control_variates() -> None:
    strand = net.affine_strand(20.0, 0.05)
    sample, moments = net.sample_strands(strand, 100_000, 8), net.walk_moments(strand)
    # what is linear or quadratic comes out exact
    known = net.sample_average(sample, lambda r: r[:, 2] + r[:, 0] * r[:, 1])
    assert known.value == pytest.approx(moments.mean[2] + moments.covariance[0, 1] + moments.mean[0] ** 2, rel=1e-12)
    assert known.gain > 1e15
    # the length: against the law of (x, y, z) of a shorter strand, summed
    short = net.uniform_strand(40, 1.0, 0.2)
    law = net.exact_law(short, "xyz")
    radius = np.sqrt(sum(np.square(v.astype(float)) for v in np.meshgrid(*law.values, indexing="ij", sparse=True)))
    exact = float((law.probability * radius).sum())
    draws = [
        net.sample_average(net.sample_strands(short, 10_000, seed), lambda r: np.sqrt((r**2).sum(axis=1)))
        for seed in range(40)
    ]
    z = [(d.value - exact) / d.error for d in draws]
    assert abs(np.mean(z)) < 4 / math.sqrt(40)
    assert 0.7 < np.std(z) < 1.3
    assert min(d.gain for d in draws) > 50
    # a tail probability gains little, and loses nothing
    tail = net.sample_average(sample, lambda r: (r[:, 2] > 350).astype(float))
    assert 1.0 < tail.gain < 3
    plain = net.sample_average(sample, lambda r: r[:, 2], control=False)
    assert plain.gain == 1.0
    assert plain.error == pytest.approx(math.sqrt(moments.covariance[2, 2] / 100_000), rel=0.02)


def test_a_taut_sample_has_no_spread() -> None:
    sample = net.sample_strands(net.affine_strand(1e6, 0.05), 1000, 1)
    assert (sample.end_to_end == [0, 0, 400]).all()
    average = net.sample_average(sample, lambda r: r[:, 2])
    assert (average.value, average.error) == (400.0, 0.0)
    moments = net.sample_moments(sample)
    assert (moments.covariance == 0).all()
    assert moments.orientation == 1


def test_histograms() -> None:
    strand = net.affine_strand(20.0, 0.05)
    sample = net.sample_strands(strand, 200_000, 4)
    axial = net.sample_histogram(sample, "z")
    assert axial.counts.sum() == 200_000
    law = net.exact_law(strand)
    exact = law.probability[(axial.edges[:-1] + 0.5).astype(int) - law.values[0][0]]
    z = (axial.probability - exact) / axial.error
    assert np.abs(z[exact > 1e-4]).max() < 5
    assert (axial.error > 0).all()
    for quantity in ("length", "orientation", "x"):
        h = net.sample_histogram(sample, quantity, bins=30)
        assert (h.counts.sum(), h.counts.size, h.edges.size) == (200_000, 30, 31)
    taut = net.sample_histogram(net.sample_strands(net.affine_strand(1e6, 0.05), 10, 1), "length")
    assert taut.counts.sum() == 10
