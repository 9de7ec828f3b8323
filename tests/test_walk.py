"""Random walk: streams, exact moments and law, sampling against them, estimates, refusals."""

import itertools
import math
import warnings
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from spinline import network as net
from spinline.errors import InputError
from spinline.network import _multinomial, _step_kernels, _streams, force_laws
from spinline.network.walk_strand import step_probabilities

MOVES = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])


def rising(segments: int) -> net.Strand:
    """Tension from 0.5 to 3 along the strand, lateral forces that differ and change sign."""
    forces = np.empty((segments, 3))
    forces[:, 0], forces[:, 1] = 0.15, np.linspace(-0.4, 0.2, segments)
    forces[:, 2] = np.linspace(0.5, 3.0, segments)
    return net.varying_strand(forces)


def by_enumeration(strand: net.Strand) -> dict[tuple[int, ...], float]:
    """Every walk there is."""
    p = np.repeat(step_probabilities(strand.forces), strand.repeats, axis=0)
    law: dict[tuple[int, ...], float] = {}
    for walk in itertools.product(range(6), repeat=strand.segments):
        end = tuple(int(v) for v in MOVES[list(walk)].sum(axis=0))
        law[end] = law.get(end, 0.0) + math.prod(p[j, d] for j, d in enumerate(walk))
    return law


def by_recursion(strand: net.Strand, axis: int) -> np.ndarray:
    """Law along one axis, segment by segment: only positive terms."""
    p = np.repeat(step_probabilities(strand.forces), strand.repeats, axis=0)
    law = np.zeros(2 * strand.segments + 3)
    law[strand.segments + 1] = 1.0
    for row in p:
        plus, minus = row[2 * axis], row[2 * axis + 1]
        stay = row.sum() - plus - minus
        law[1:-1] = stay * law[1:-1] + plus * law[:-2] + minus * law[2:]
    return law[1:-1]


def chi_squared(counts: np.ndarray, probability: np.ndarray) -> float:
    """p-value; tails merged until each bin expects ten."""
    expected = probability * counts.sum()
    good = expected >= 10
    low, high = int(good.argmax()), good.size - int(good[::-1].argmax())
    seen = np.concatenate([[counts[:low].sum()], counts[low:high], [counts[high:].sum()]])
    due = np.concatenate([[expected[:low].sum()], expected[low:high], [expected[high:].sum()]])
    keep = due > 1
    return float(stats.chi2.sf(((seen - due)[keep] ** 2 / due[keep]).sum(), keep.sum() - 1))


# streams


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


# exact moments and law


@pytest.mark.parametrize("strand", [rising(5), net.uniform_strand(5, 1.2, 0.3), net.uniform_strand(1, -2.0, 0.0)])
def test_law_and_moments_against_every_walk(strand: net.Strand) -> None:
    law = by_enumeration(strand)
    exact = net.exact_law(strand, "xyz")
    assert exact.probability.sum() == pytest.approx(1.0, abs=1e-14)
    found = {}
    for index in zip(*np.nonzero(exact.probability > 1e-14), strict=True):
        found[tuple(int(v[i]) for v, i in zip(exact.values, index, strict=True))] = exact.probability[index]
    assert set(found) == {end for end, p in law.items() if p > 1e-14}
    assert max(abs(found[end] - law[end]) for end in found) < 2e-15
    ends, p = np.array(list(law)), np.array(list(law.values()))
    mean = p @ ends
    away = ends - mean
    moments = net.walk_moments(strand)
    np.testing.assert_allclose(moments.mean, mean, rtol=1e-13, atol=1e-14)
    np.testing.assert_allclose(moments.covariance, (away.T * p) @ away, rtol=1e-12, atol=1e-14)
    spread = p @ away**2
    np.testing.assert_allclose(moments.skewness, p @ away**3 / spread**1.5, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(moments.excess_kurtosis, p @ away**4 / spread**2 - 3, rtol=1e-11, atol=1e-12)
    assert moments.mean_square == pytest.approx(p @ (ends**2).sum(axis=1), rel=1e-13)


@pytest.mark.parametrize("strand", [rising(300), net.affine_strand(20.0, 0.05), net.affine_strand(1.0, 0.05)])
@pytest.mark.parametrize("axis", ["x", "z"])
def test_law_against_the_recursion(strand: net.Strand, axis: str) -> None:
    column = "xyz".index(axis)
    law = net.exact_law(strand, axis)
    reference = by_recursion(strand, column)
    at = law.values[0] + strand.segments
    inside = (at >= 0) & (at < reference.size)
    assert np.abs(law.probability[inside] - reference[at[inside]]).max() < 1e-14
    assert np.delete(reference, at[inside]).sum() < 1e-16
    moments = net.walk_moments(strand)
    assert law.mean()[0] == pytest.approx(moments.mean[column], rel=1e-13)
    assert law.std()[0] ** 2 == pytest.approx(moments.covariance[column, column], rel=1e-11)
    assert law.cumulative()[-1] == pytest.approx(1.0, abs=1e-13)


def test_joint_law_has_the_marginals() -> None:
    strand = rising(60)
    joint = net.exact_law(strand, ("z", "x"))
    for i, axis in enumerate(("z", "x")):
        single = net.exact_law(strand, axis)
        np.testing.assert_array_equal(single.values[0], joint.values[i])
        np.testing.assert_allclose(joint.probability.sum(axis=1 - i), single.probability, atol=2e-15)
    z, x = np.meshgrid(*joint.values, indexing="ij")
    covariance = (joint.probability * (z - joint.mean()[0]) * (x - joint.mean()[1])).sum()
    assert covariance == pytest.approx(net.walk_moments(strand).covariance[0, 2], rel=1e-9)


def test_long_strands_keep_the_law() -> None:
    """N = 1e9, and a taut one whose bent segments are few: Poisson."""
    strand = net.uniform_strand(10**9, 0.5, 0.1)
    law, moments = net.exact_law(strand), net.walk_moments(strand)
    sigma = math.sqrt(moments.covariance[2, 2])
    assert law.mean()[0] == pytest.approx(moments.mean[2], abs=1e-4 * sigma)
    assert law.std()[0] == pytest.approx(sigma, rel=1e-8)
    normal = stats.norm.pdf(law.values[0], moments.mean[2], sigma)
    assert np.abs(law.probability - normal).max() < 3e-5 * normal.max()
    taut = net.uniform_strand(10**9, 10.0 + math.log(1e5), 0.0)
    bent = 4 * 10**9 * float(mp.exp(-(10 + mp.log(10**5))))
    few = net.exact_law(taut)
    lateral = stats.poisson.pmf(10**9 - few.values[0], bent)
    assert np.abs(few.probability - lateral).max() < 1e-6 * lateral.max()


def test_moments_are_those_of_the_closed_forms() -> None:
    for v in (1.0, 5.0, 20.0, 40.0):
        exact, form = net.walk_moments(net.affine_strand(v, 0.05)), net.random_walk(v, 0.05)
        assert exact.relative_extension[2] == pytest.approx(float(form.relative_extension), rel=1e-14)
        assert exact.mean[0] / 20 == pytest.approx(float(form.radial_contraction), rel=1e-13)
        assert exact.orientation == pytest.approx(float(form.orientation), rel=1e-13, abs=1e-15)
    # at rest: standard deviation xi_0/sqrt(3) on a mean of xi_0, the better the smaller phi
    rest = net.walk_moments(net.affine_strand(1.0, 1e-4))
    assert math.sqrt(rest.covariance[2, 2]) / 1e4 == pytest.approx(1 / math.sqrt(3), rel=1e-7)
    assert rest.mean[2] / 1e4 == pytest.approx(1.0, rel=1e-7)
    # full extension
    full = net.walk_moments(net.affine_strand(1e9, 0.05))
    assert full.relative_extension[2] == 1
    assert full.orientation == 1
    assert np.isnan(full.skewness).all()


def test_taut_variance_does_not_cancel() -> None:
    p = mp.exp(40) + mp.exp(-40) + 4 * mp.cosh(mp.mpf("0.5"))
    with mp.workdps(60):
        z = mp.exp(40) + mp.exp(-40) + 4 * mp.cosh(mp.mpf("0.5"))
        q, m = (mp.exp(40) + mp.exp(-40)) / z, (mp.exp(40) - mp.exp(-40)) / z
        exact = float(q - m * m)
    assert p > 0
    moments = net.walk_moments(net.uniform_strand(1, 40.0, 0.5))
    assert moments.covariance[2, 2] == pytest.approx(exact, rel=1e-13)


def test_force_laws_pull_the_walk_to_their_extension() -> None:
    """The lattice law inverts the mean of the walk; the others say what force another chain would need."""
    for x in (0.05, 0.5, 0.95, 0.9999):
        force = float(force_laws.force(x, "lattice", 0.15))
        mean = net.walk_moments(net.uniform_strand(400, force, 0.15)).relative_extension[2]
        assert mean == pytest.approx(x, rel=1e-14)


# sampling


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


# estimates


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


# random scenes and refusals


@pytest.mark.slow
def test_ten_thousand_random_scenes() -> None:
    """Finite and bounded, or a named InputError; never a warning."""
    rng = np.random.default_rng(20261122)
    refused = 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for i in range(10_000):
            phi = math.exp(rng.uniform(math.log(1e-6), math.log(0.99)))
            v, n = math.exp(rng.uniform(0, math.log(1e12))), int(math.exp(rng.uniform(0, math.log(1e9))))
            law = ("lattice", "langevin", "fene", "linear")[i % 4]
            rest = 3 * phi
            if i % 3 == 0:
                strand = net.affine_strand(v, phi)
            else:
                if phi * v >= 1 and law != "linear":
                    with pytest.raises(InputError, match="extension"):
                        force_laws.force(phi * v, law, rest)
                    refused += 1
                    pull = float(rest * v)
                else:
                    pull = float(force_laws.force(phi * v, law, rest))
                if law != "linear":
                    x, gap = (float(f(pull, law, rest)) for f in (force_laws.extension, force_laws.deficit))
                    assert 0 <= x <= 1
                    assert 0 <= gap <= 1
                strand = net.uniform_strand(n, pull, rest)
            if i % 10 == 9:
                strand = net.varying_strand(np.outer(rng.uniform(-1, 1, 1 + n % 50), [rest, rest, strand.forces[0, 2]]))
            segments = strand.segments
            sample, exact = net.sample_strands(strand, 100, i), net.walk_moments(strand)
            assert (np.abs(sample.end_to_end).sum(axis=1) <= segments).all()
            assert (sample.axial_steps >= np.abs(sample.end_to_end[:, 2])).all()
            assert (sample.axial_steps <= segments).all()
            assert np.isfinite(exact.mean).all()
            assert np.isfinite(exact.covariance).all()
            assert (np.abs(exact.relative_extension) <= 1 + 1e-12).all()
            assert -0.5 <= exact.orientation <= 1 + 1e-12
            moments = net.sample_moments(sample)
            spread = np.sqrt(np.diag(exact.covariance) / 100)
            # seven standard errors, and a few strands where the law is Poisson-like
            assert (np.abs(moments.mean - exact.mean) <= 7 * spread + 0.2).all()
            assert -0.5 <= moments.orientation <= 1
            average = net.sample_average(sample, lambda r: np.sqrt((r**2).sum(axis=1)))
            assert np.isfinite([average.value, average.error]).all()
            if i % 20 == 0 and segments < 10_000:
                total = net.exact_law(strand).probability.sum()
                assert total == pytest.approx(1.0, abs=1e-11)
    assert 0 < refused < 10_000


@given(st.integers(1, 60), st.floats(-50, 50), st.floats(0, 5), st.integers(0, 2**64 - 1))
@settings(max_examples=100, deadline=None)
def test_bounds_and_symmetry(segments: int, force: float, rest: float, seed: int) -> None:
    strand = net.uniform_strand(segments, force, rest)
    for method in ("multinomial", "steps"):
        sample = net.sample_strands(strand, 20, seed, method=method)
        assert (np.abs(sample.end_to_end).sum(axis=1) <= segments).all()
        assert ((sample.end_to_end.sum(axis=1) - segments) % 2 == 0).all()
        assert ((sample.orientation >= -0.5) & (sample.orientation <= 1)).all()
    up, down = net.walk_moments(strand), net.walk_moments(net.uniform_strand(segments, -force, rest))
    assert up.mean[2] == pytest.approx(-down.mean[2], rel=1e-14)
    assert up.covariance[2, 2] == pytest.approx(down.covariance[2, 2], rel=1e-14)
    law, mirrored = net.exact_law(strand), net.exact_law(net.uniform_strand(segments, -force, rest))
    assert law.mean()[0] == pytest.approx(-mirrored.mean()[0], abs=1e-11)


STRAND = net.uniform_strand(10, 1.0, 0.1)


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: net.uniform_strand(0, 1.0), "segments"),
        (lambda: net.uniform_strand(2.5, 1.0), "segments"),
        (lambda: net.uniform_strand(True, 1.0), "segments"),
        (lambda: net.uniform_strand(10**13, 1.0), "segments"),
        (lambda: net.uniform_strand(10, np.nan), "axial_force"),
        (lambda: net.uniform_strand(10, [1.0, 2.0]), "axial_force"),
        (lambda: net.uniform_strand(10, 1.0, np.inf), "lateral_force"),
        (lambda: net.affine_strand(5.0, 1e-7), "volume_fraction"),
        (lambda: net.affine_strand(5.0, [0.1, 0.2]), "volume_fraction"),
        (lambda: net.affine_strand([5.0, 6.0], 0.1), "velocity_ratio"),
        (lambda: net.affine_strand(-5.0, 0.1), "velocity_ratio"),
        (lambda: net.varying_strand(np.zeros((3, 2))), "forces"),
        (lambda: net.varying_strand(np.zeros((0, 3))), "forces"),
        (lambda: net.varying_strand([[0.0, 0.0, np.nan]]), "forces"),
        (lambda: net.hydrodynamic_strand(1.0, [[1.0]]), "hydrodynamic_force"),
        (lambda: net.hydrodynamic_strand(1.0, np.zeros(10_000_001)), "segments"),
        (lambda: net.sample_strands(STRAND, 0, 1), "strands"),
        (lambda: net.sample_strands(STRAND, 10**9, 1), "strands"),
        (lambda: net.sample_strands(STRAND, 10, -1), "seed"),
        (lambda: net.sample_strands(STRAND, 10, 2**64), "seed"),
        (lambda: net.sample_strands(STRAND, 10, 1.5), "seed"),
        (lambda: net.sample_strands(STRAND, 10, 1, first=-1), "first"),
        (lambda: net.sample_strands(STRAND, 10, 1, threads=0), "threads"),
        (lambda: net.sample_strands(STRAND, 10, 1, chunk=0), "chunk"),
        (lambda: net.sample_strands(STRAND, 10, 1, method="walk"), "method"),
        (lambda: net.sample_strands(rising(5), 10, 1, method="multinomial"), "method"),
        (lambda: net.sample_strands(net.uniform_strand(10**8, 1.0), 10, 1, method="steps"), "segments"),
        (lambda: net.sample_strands(net.uniform_strand(10**7, 1.0), 10**7, 1, method="steps"), "strands"),
        (lambda: net.sample_paths(net.uniform_strand(10**7, 1.0), 100, 1), "strands"),
        (lambda: net.exact_law(STRAND, "zz"), "axes"),
        (lambda: net.exact_law(STRAND, ()), "axes"),
        (lambda: net.exact_law(STRAND, ("r",)), "axes"),
        (lambda: net.exact_law(net.uniform_strand(10**6, 1.0), "xyz"), "axes"),
        (lambda: net.exact_law(STRAND, "xz").cumulative(), "axes"),
        (lambda: net.sample_moments(net.sample_strands(STRAND, 1, 1)), "strands"),
        (lambda: net.sample_average(net.sample_strands(STRAND, 50, 1), lambda r: r[:, 0]), "strands"),
        (lambda: net.sample_average(net.sample_strands(STRAND, 500, 1), lambda r: r), "function"),
        (lambda: net.sample_average(net.sample_strands(STRAND, 500, 1), lambda r: np.full(500, np.nan)), "function"),
        (lambda: net.sample_histogram(net.sample_strands(STRAND, 50, 1), "r"), "quantity"),
        (lambda: net.sample_histogram(net.sample_strands(STRAND, 50, 1), "z", bins=0), "bins"),
    ],
)
def test_refusals_name_the_field(call, field: str) -> None:
    with pytest.raises(InputError) as refusal:
        call()
    assert refusal.value.field == field
    assert field in str(refusal.value)
