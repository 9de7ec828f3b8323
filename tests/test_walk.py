"""Sampling of the walk against its exact law: chi-squared, binomials, thresholds, paths."""

import math
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from scipy import stats

from spinline import network as net
from spinline.network.walk import _multinomial, _step_kernels
from spinline.network.walk.strand import step_probabilities


def rising(segments: int) -> net.Strand:
    """Tension from 0.5 to 3 along the strand, lateral forces that differ and change sign."""
    forces = np.empty((segments, 3))
    forces[:, 0], forces[:, 1] = 0.15, np.linspace(-0.4, 0.2, segments)
    forces[:, 2] = np.linspace(0.5, 3.0, segments)
    return net.varying_strand(forces)


def chi_squared(counts: np.ndarray, probability: np.ndarray) -> float:
    """p-value; tails merged until each bin expects ten."""
    expected = probability * counts.sum()
    good = expected >= 10
    low, high = int(good.argmax()), good.size - int(good[::-1].argmax())
    seen = np.concatenate([[counts[:low].sum()], counts[low:high], [counts[high:].sum()]])
    due = np.concatenate([[expected[:low].sum()], expected[low:high], [expected[high:].sum()]])
    keep = due > 1
    return float(stats.chi2.sf(((seen - due)[keep] ** 2 / due[keep]).sum(), keep.sum() - 1))


CASES = {
    "multinomial": (net.affine_strand(20.0, 0.05), "multinomial"),
    "multinomial at rest": (net.affine_strand(1.0, 0.05), "multinomial"),
    "steps": (net.affine_strand(20.0, 0.05), "steps"),
    "steps that vary": (rising(403), "steps"),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_chi_squared_against_the_exact_law(case: str) -> None:
    """Twenty seeds of 1e6 strands: smallest p > 1e-4, and the p-values themselves uniform."""
    strand, method = CASES[case]
    laws = [net.exact_law(strand, axis) for axis in ("x", "z")]
    p: list[list[float]] = [[], []]
    for seed in range(20):
        ends = net.sample_strands(strand, 1_000_000, seed, method=method, threads=2).end_to_end
        for i, (law, column) in enumerate(zip(laws, (0, 2), strict=True)):
            counts = np.bincount(ends[:, column] - law.values[0][0], minlength=law.probability.size)
            p[i].append(chi_squared(counts, law.probability))
    assert min(map(min, p)) > 1e-4
    for values in p:
        assert stats.kstest(values, "uniform").pvalue > 1e-3


def test_joint_law_of_a_sample() -> None:
    """All three components at once: correlations and parity."""
    strand = rising(8)
    law = net.exact_law(strand, "xyz")
    for sample in (
        net.sample_strands(strand, 1_000_000, 5),
        net.sample_strands(net.uniform_strand(8, 1.0, 0.2), 10**6, 5),
    ):
        law = net.exact_law(sample.strand, "xyz")
        at = [sample.end_to_end[:, i] - law.values[i][0] for i in range(3)]
        cells = np.ravel_multi_index(at, law.probability.shape)
        counts = np.bincount(cells, minlength=law.probability.size)
        probability = law.probability.reshape(-1)
        order = np.argsort(-probability)  # merge the rare ones at the end
        assert chi_squared(counts[order], probability[order]) > 1e-3
        assert ((sample.end_to_end.sum(axis=1) - 8) % 2 == 0).all()


def test_orientation_of_a_sample() -> None:
    for strand in (rising(50), net.uniform_strand(50, 1.0, 0.2)):
        sample, exact = net.sample_strands(strand, 500_000, 3), net.walk_moments(strand)
        z = (sample.axial_steps.mean() - exact.axial_steps) / math.sqrt(exact.axial_steps_variance / 500_000)
        assert abs(z) < 4
        assert sample.orientation.std() == pytest.approx(exact.orientation_std, rel=0.01)
        assert (np.abs(sample.end_to_end[:, 2]) <= sample.axial_steps).all()
        assert (np.abs(sample.end_to_end).sum(axis=1) <= 50).all()


@pytest.mark.parametrize(
    ("n", "p"),
    [
        (1, 0.3),
        (7, 0.5),
        (40, 0.3),
        (25, 0.5),
        (1000, 0.003),
        (1000, 0.6),
        (10**9, 0.3),
        (10**9, 1e-8),
        (10**9, 1 - 1e-8),
    ],
)
def test_binomials(n: int, p: float) -> None:
    out = np.empty(400_000, np.int64)
    _multinomial.sample_binomials(np.uint64(9), 0, n, p, 1 - p, out)
    assert out.min() >= 0
    assert out.max() <= n
    edges = np.unique(stats.binom.ppf(np.linspace(0, 1, 41)[1:-1], n, p))
    expected = np.diff(np.concatenate([[0.0], stats.binom.cdf(edges, n, p), [1.0]])) * out.size
    seen = np.bincount(np.searchsorted(edges, out), minlength=edges.size + 1)
    keep = expected > 1e-6
    assert stats.chi2.sf(((seen - expected)[keep] ** 2 / expected[keep]).sum(), max(keep.sum() - 1, 1)) > 1e-4


@pytest.mark.parametrize("n", [5, 40, 1000, 10**9, 10**12])
@pytest.mark.parametrize("p", [0.25, 0.5, 2.0**-20])
def test_binomial_probability_against_fifty_digits(n: int, p: float) -> None:
    for deviations in (-8, -1, 0, 1, 9):
        k = round(n * p + deviations * math.sqrt(n * p * (1 - p)))
        if 0 <= k <= n:
            with mp.workdps(50):
                choose = mp.loggamma(n + 1) - mp.loggamma(k + 1) - mp.loggamma(n - k + 1)
                exact = choose + k * mp.log(p) + (n - k) * mp.log(1 - mp.mpf(p))
            assert _multinomial.log_binomial(float(k), float(n), p, 1 - p) == pytest.approx(float(exact), abs=1e-9)


def test_thresholds_do_not_drift() -> None:
    """Summed along a strand the 32-bit weights stay within a unit of the probabilities; 16 bits would not do."""
    p = step_probabilities(rising(100_000).forces)
    order = np.argsort(p.sum(axis=0), kind="stable")
    table = np.empty((p.shape[0], 5), np.int32)
    _step_kernels.thresholds(p, order, table)
    weights = np.diff(table.astype(np.int64) + 2**31, axis=1, prepend=0)
    assert (weights >= 0).all()
    off = weights.sum(axis=0) - np.array([float(sum(map(Fraction, p[:, k].tolist())) * 2**32) for k in order[:5]])
    assert np.abs(off).max() <= 1.01
    # a force that turns round: the last direction of the order is nearly impossible on half of the strand
    turned = np.zeros((1000, 3))
    turned[:600, 2], turned[600:, 2] = 40.0, -40.0
    sample = net.sample_strands(net.varying_strand(turned), 1000, 1)
    np.testing.assert_array_equal(sample.end_to_end[:, 2], 200)


def test_paths_are_the_walks() -> None:
    for strand in (rising(37), net.affine_strand(20.0, 0.05)):
        paths = net.sample_paths(strand, 300, 11, first=5)
        ends = net.sample_strands(strand, 300, 11, first=5, method="steps")
        np.testing.assert_array_equal(paths[:, -1], ends.end_to_end)
        assert (paths[:, 0] == 0).all()
        moves = np.diff(paths, axis=1)
        assert (np.abs(moves).sum(axis=2) == 1).all()
        np.testing.assert_array_equal((moves[:, :, 2] != 0).sum(axis=1), ends.axial_steps)


def test_steps_and_multinomial_agree_where_both_apply() -> None:
    strand = net.affine_strand(10.0, 0.1)
    a = net.sample_moments(net.sample_strands(strand, 400_000, 1, method="multinomial"))
    b = net.sample_moments(net.sample_strands(strand, 400_000, 1, method="steps"))
    assert (np.abs(a.mean - b.mean) < 4 * np.hypot(a.mean_error, b.mean_error)).all()
    assert (np.abs(a.covariance - b.covariance) < 4 * np.hypot(a.covariance_error, b.covariance_error)).all()
