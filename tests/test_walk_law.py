"""Exact moments and law of the walk: every walk enumerated, recursion, limits."""

import itertools
import math

import mpmath as mp
import numpy as np
import pytest
from scipy import stats

from spinline import network as net
from spinline.network import force_laws
from spinline.network.walk.strand import step_probabilities

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
