"""Walks of ten thousand random scenes, bounds, symmetry, refusals."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spinline import network as net
from spinline.base.errors import InputError
from spinline.network import force_laws


def rising(segments: int) -> net.Strand:
    """Tension from 0.5 to 3 along the strand, lateral forces that differ and change sign."""
    forces = np.empty((segments, 3))
    forces[:, 0], forces[:, 1] = 0.15, np.linspace(-0.4, 0.2, segments)
    forces[:, 2] = np.linspace(0.5, 3.0, segments)
    return net.varying_strand(forces)


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
