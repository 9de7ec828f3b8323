"""Forces that vary along a strand: accumulation, the self-consistent strand in a flow gradient, real jets."""

import subprocess
import sys

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spinline import jetprofile
from spinline import network as net
from spinline.base.errors import InputError


def test_tension_accumulates_from_monomer_to_monomer() -> None:
    drag = np.array([0.1, -0.2, 0.4, 0.05])
    f = net.hydrodynamic_strand(2.0, drag, 0.15).forces
    assert (f[:, :2] == 0.15).all()
    axial = f[:, 2]
    np.testing.assert_allclose(axial[:-1] - axial[1:], (drag[:-1] + drag[1:]) / 2, rtol=1e-13)
    up, down = axial[0] + drag[0] / 2, axial[-1] - drag[-1] / 2
    assert up - down == pytest.approx(drag.sum(), rel=1e-13)  # the ends hold the whole drag
    assert (up + down) / 2 == pytest.approx(2.0, rel=1e-14)


def test_no_flow_is_the_uniform_strand() -> None:
    flow = net.flow_strand(400, 3.0, 0.15, 0.0)
    assert flow.excess == 0
    assert flow.iterations == 1
    uniform, varying = net.walk_moments(net.uniform_strand(400, 3.0, 0.15)), net.walk_moments(flow.strand)
    np.testing.assert_allclose(varying.mean, uniform.mean, rtol=1e-13)
    np.testing.assert_allclose(varying.covariance, uniform.covariance, rtol=1e-12)


def test_walk_converges_to_the_uniform_one_in_proportion_to_the_gradient() -> None:
    uniform = net.walk_moments(net.uniform_strand(400, 1.0, 0.15)).mean[2]
    gradients = np.array([1e-7, 1e-8, 1e-9, 1e-10])
    off = [net.walk_moments(net.flow_strand(400, 1.0, 0.15, w).strand).mean[2] / uniform - 1 for w in gradients]
    order = np.diff(np.log(off)) / np.diff(np.log(gradients))
    np.testing.assert_allclose(order, 1.0, atol=2e-3)


@pytest.mark.parametrize("fraction", [0.01, 0.3, 0.8])
def test_small_forces_are_a_cosine(fraction: float) -> None:
    """f = f_e cos[q (j - (N+1)/2)]/cos(q N/2), up to O(1/N^2) of the segments, below the coil-stretch transition."""
    n, rest, end = 2000, 0.15, 1e-5
    slope = 1 / (1 + 2 * np.cosh(rest))
    w = fraction * (np.pi / n) ** 2 / slope
    flow = net.flow_strand(n, end, rest, w, tolerance=1e-14)
    q, j = np.sqrt(w * slope), np.arange(1, n + 1)
    expected = end * np.cos(q * (j - (n + 1) / 2)) / np.cos(q * n / 2)
    np.testing.assert_allclose(flow.strand.forces[:, 2], expected, rtol=2e-5)


def test_order_in_the_number_of_segments() -> None:
    """Same chain cut into more segments: the cosine is met at second order."""
    errors = []
    for n in (25, 50, 100, 200):
        w = 0.5 * 3 * (np.pi / n) ** 2
        f = net.flow_strand(n, 1e-6, 0.0, w, tolerance=1e-14).strand.forces[:, 2]
        q, j = np.sqrt(w / 3), np.arange(1, n + 1)
        errors.append(np.abs(f / (1e-6 * np.cos(q * (j - (n + 1) / 2)) / np.cos(q * n / 2)) - 1).max())
    order = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(order, 2.0, atol=0.1)


def test_taut_strand_is_a_parabola() -> None:
    """Fully extended: z = j - 1/2, so the tension is a parabola, w N^2/8 above the ends in the middle."""
    n, w = 401, 1e-3
    flow = net.flow_strand(n, 60.0, 0.15, w)
    j = np.arange(1, n + 1)
    np.testing.assert_allclose(flow.position, j - 0.5, rtol=1e-15)
    exact = 60 + w * ((n / 2) ** 2 - (j - (n + 1) / 2) ** 2) / 2 - w / 8
    np.testing.assert_allclose(flow.strand.forces[:, 2], exact, rtol=1e-12)
    assert flow.excess == pytest.approx(w * n**2 / 8, rel=1e-4)


def test_fixed_point_against_fifty_digits() -> None:
    n, end, rest, w = 30, 0.8, mp.mpf("0.2"), mp.mpf("0.004")
    with mp.workdps(50):
        force = [mp.mpf(end)] * n
        for _ in range(200):
            step = [mp.sinh(f) / (mp.cosh(f) + 2 * mp.cosh(rest)) for f in force]
            z = [sum(step[:j]) + step[j] / 2 for j in range(n)]
            centre = sum(z) / n
            h = [w * (v - centre) for v in z]
            force = [mp.mpf(end) + sum(h[j + 1 :]) + h[j] / 2 - sum(h) / 2 for j in range(n)]
    flow = net.flow_strand(n, end, float(rest), float(w))
    np.testing.assert_allclose(flow.strand.forces[:, 2], [float(f) for f in force], rtol=1e-12)
    assert flow.change <= 1e-13


def test_slip_tilts_the_tension() -> None:
    flow = net.flow_strand(100, 2.0, 0.15, 0.0, slip=1e-3)
    f = flow.strand.forces[:, 2]
    np.testing.assert_allclose(np.diff(f), -1e-3, rtol=1e-10)
    assert f.mean() == pytest.approx(2.0, rel=1e-13)


def test_beyond_coil_stretch_the_strand_is_taut() -> None:
    n = 400
    critical = (1 + 2 * np.cosh(0.15)) * (np.pi / n) ** 2
    below = net.walk_moments(net.flow_strand(n, 1e-6, 0.15, 0.5 * critical).strand).relative_extension[2]
    above = net.walk_moments(net.flow_strand(n, 1e-6, 0.15, 5 * critical).strand).relative_extension[2]
    assert below < 1e-5
    assert above > 0.8


def test_local_hydrodynamic_force_is_negligible_in_a_real_jet() -> None:
    """PEO 5 wt% in water, 125 um, 3.2 mL/h, k = 1, beta = 0.47: 2e-4 of the force at the ends, along the first 5 mm."""
    phi, b, temperature, viscosity = 0.05, 1e-9, 293.15, 1e-3
    jet = jetprofile.PowerLaw(radius=125e-6, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
    z = np.linspace(2e-4, 5e-3, 60)
    ratio, rate = jet.velocity_ratio(z), jet.strain_rate(z)
    gradient = net.segment_time(viscosity, b, temperature) * rate
    worst, shift = 0.0, 0.0
    for v, w in zip(ratio, gradient, strict=True):
        uniform = net.affine_strand(float(v), phi)
        flow = net.flow_strand(uniform.segments, float(uniform.forces[0, 2]), 3 * phi, float(w))
        worst = max(worst, flow.excess / float(uniform.forces[0, 2]))
        x = net.walk_moments(uniform).relative_extension[2]
        shift = max(shift, abs(net.walk_moments(flow.strand).relative_extension[2] / x - 1))
        assert flow.excess == pytest.approx(w * x * uniform.segments**2 / 8, rel=0.02)
    assert 1e-5 < worst < 3e-4
    assert shift < 3e-4
    assert gradient.max() < 5e-8


def test_the_number_that_decides() -> None:
    """w/(24 phi^4) of the end force below f = 1: from negligible to a seventh between phi = 0.05 and 0.01."""
    for phi, w, size in ((0.05, 3e-8, 2e-4), (0.02, 3e-8, 7.8e-3), (0.01, 3e-8, 0.139)):
        strand = net.affine_strand(1.5, phi)
        flow = net.flow_strand(strand.segments, float(strand.forces[0, 2]), 3 * phi, w)
        relative = flow.excess / float(strand.forces[0, 2])
        assert relative == pytest.approx(size, rel=0.02)
        assert relative == pytest.approx(w / (24 * phi**4), rel=0.12)


@given(st.integers(1, 300), st.floats(0, 20), st.floats(0, 5), st.floats(0, 0.5))
@settings(max_examples=100, deadline=None)
def test_symmetric_and_tauter_in_the_middle(n: int, end: float, rest: float, fraction: float) -> None:
    flow = net.flow_strand(n, end, rest, fraction * (np.pi / n) ** 2)
    f = flow.strand.forces[:, 2]
    np.testing.assert_allclose(f, f[::-1], rtol=1e-10, atol=1e-14)
    assert (f >= end * (1 - 1e-12)).all()
    assert abs(flow.hydrodynamic_force.sum()) <= 1e-10 * max(np.abs(flow.hydrodynamic_force).max(), 1e-300) * n


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ((0, 1.0, 0.1, 0.0), "segments"),
        ((10**8, 1.0, 0.1, 0.0), "segments"),
        ((10, np.nan, 0.1, 0.0), "end_force"),
        ((10, 1.0, -0.1, 0.0), "lateral_force"),
        ((10, 1.0, 0.1, np.inf), "flow_gradient"),
        ((10, 1.0, 0.1, [0.0, 1.0]), "flow_gradient"),
        ((10, 1.0, [0.1, 0.2], 0.0), "lateral_force"),
    ],
)
def test_refusals_name_the_field(arguments: tuple, field: str) -> None:
    with pytest.raises(InputError) as refusal:
        net.flow_strand(*arguments)
    assert refusal.value.field == field


def test_slow_convergence_is_refused_by_name() -> None:
    critical = (1 + 2 * np.cosh(0.15)) * (np.pi / 400) ** 2
    with pytest.raises(InputError, match="coil-stretch") as refusal:
        net.flow_strand(400, 1e-6, 0.15, 0.9999 * critical, most_iterations=50)
    assert refusal.value.field == "flow_gradient"


def test_network_imports_neither_numba_nor_scipy() -> None:
    code = "import sys, spinline.network; assert not {'numba', 'scipy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_every_exported_name_is_there_and_listed() -> None:
    for name in net.__all__:
        assert getattr(net, name) is not None
    assert dir(net) == sorted(net.__all__)
    assert callable(net.walk_moments)
    with pytest.raises(AttributeError, match="no attribute"):
        net.nothing  # noqa: B018
