"""Closed forms of sections 2-4 against 50-digit arithmetic, reference values and limits."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spinline import network as net
from spinline.base.errors import InputError


class Exact:
    """The same formulas, written once more, in 50 digits."""

    def __init__(self, phi: float, v: float, quality: str = "theta", affinity: float = 1.0) -> None:
        self.phi, self.v = mp.mpf(phi), mp.mpf(v)
        self.full = 1 / self.phi if quality == "theta" else 1 / mp.sqrt(self.phi)
        self.f0 = 3 / self.full
        self.f = self.f0 * (1 + mp.mpf(affinity) * (self.v - 1))
        self.z = mp.cosh(self.f) + 2 * mp.cosh(self.f0)
        self.extension = mp.sinh(self.f) / self.z
        self.contraction = self.full * mp.sinh(self.f0) / self.z
        self.orientation = (mp.cosh(self.f) - mp.cosh(self.f0)) / self.z
        self.walk = self.phi / self.contraction**2
        self.eq40 = self.phi / 9 * (mp.cosh(self.f0 * self.v) + 2) ** 2
        t = mp.tanh(self.f0) / self.f0
        self.conservative = self.phi * (t / self.contraction) ** 2 * self.v / (self.full * self.extension / t)


def draws(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    phi = np.exp(rng.uniform(np.log(1e-6), np.log(0.9), n))
    v = np.exp(rng.uniform(0, np.log(1e9), n))
    near = rng.random(n) < 0.25  # a quarter close to rest, where differences cancel
    v[near] = 1 + np.exp(rng.uniform(np.log(1e-14), 0, near.sum()))
    # and a fifth where the contraction has not yet underflowed
    mid = rng.random(n) < 0.2
    v[mid] = 1 + rng.uniform(0, 700, mid.sum()) / (3 * phi[mid])
    return phi, np.minimum(v, 1e9)


def relative(got: float, exact: mp.mpf) -> float:
    return float(abs((mp.mpf(got) - exact) / exact)) if exact else float(got != 0)


@pytest.mark.slow
def test_ten_thousand_random_points_against_fifty_digits() -> None:
    phi, v = draws(10_000, 20261122)
    walk = net.random_walk(v, phi)
    fractions = {
        "walk": (net.fraction_walk(walk, phi), net.log_fraction_walk(walk, phi)),
        "eq40": (net.fraction_eq40(v, phi), net.log_fraction_eq40(v, phi)),
        "conservative": (net.fraction_conservative(walk, v, phi), net.log_fraction_conservative(walk, v, phi)),
    }
    worst: dict[str, float] = {}
    for i in range(phi.size):
        e = Exact(phi[i], v[i])
        bound = 1e-13 * max(1.0, float(e.f) / 200)
        values = {
            "axial_stretch": (walk.axial_stretch[i], e.full * e.extension),
            "relative_extension": (walk.relative_extension[i], e.extension),
            "orientation": (walk.orientation[i], e.orientation),
            "force": (walk.force[i], e.f),
        }
        if e.contraction > mp.mpf("1e-300"):
            values["radial_contraction"] = (walk.radial_contraction[i], e.contraction)
        else:
            values["log_contraction"] = (walk.log_radial_contraction[i], mp.log(e.contraction))
        for name, (value, log) in fractions.items():
            exact = getattr(e, name)
            if exact < mp.mpf("1e300"):
                values[name] = (value[i], exact)
            else:
                values[f"log {name}"] = (log[i], mp.log(exact))
                assert value[i] > 1e299
        for name, (got, exact) in values.items():
            worst[name] = max(worst.get(name, 0.0), relative(got, exact) / bound)
    assert max(worst.values()) <= 1.0, worst


@pytest.mark.parametrize("quality", ["theta", "good"])
@pytest.mark.parametrize("affinity", [0.0, 0.0164715914, 1.0, 3.0])
def test_other_closures_against_fifty_digits(quality: str, affinity: float) -> None:
    phi, v = draws(300, 7)
    walk = net.random_walk(v, phi, affinity=affinity, solvent_quality=quality)
    for i in range(phi.size):
        e = Exact(phi[i], v[i], quality, affinity)
        bound = 1e-13 * max(1.0, float(e.f) / 200)
        assert relative(walk.axial_stretch[i], e.full * e.extension) <= bound
        assert relative(walk.orientation[i], e.orientation) <= bound
        if e.contraction > mp.mpf("1e-300"):
            assert relative(walk.radial_contraction[i], e.contraction) <= bound


TABLE = [
    # phi, V, xi_par/xi_max, xi_par/xi0, xi_perp/xi0, O: the design's reference values, recomputed twice there
    (0.03, 5, 0.14957593, 4.9858642, 0.96559904, 0.031795252),
    (0.05, 5, 0.24789292, 4.9578585, 0.90776544, 0.085436512),
    (0.05, 20, 0.82859435, 16.571887, 0.24906632, 0.74906848),
    (0.05, 40, 0.99006067, 19.801213, 0.014780061, 0.98510925),
    (0.10, 10, 0.82395094, 8.2395094, 0.25046208, 0.74206875),
]


@pytest.mark.parametrize(("phi", "v", "extension", "stretch", "contraction", "orientation"), TABLE)
def test_reference_table(phi, v, extension, stretch, contraction, orientation) -> None:
    walk = net.random_walk(v, phi)
    got = (walk.relative_extension, walk.axial_stretch, walk.radial_contraction, walk.orientation)
    for value, printed in zip(got, (extension, stretch, contraction, orientation), strict=True):
        assert float(f"{float(value):.8g}") == printed


def test_reference_concentrations() -> None:
    rest, five, twenty, forty = (net.affine_network(v, 0.05) for v in (1.0, 5.0, 20.0, 40.0))
    assert [round(float(x), 6) for x in (rest.core_polymer_fraction_eq40, rest.core_polymer_fraction)] == [
        0.050376,
        0.050752,
    ]
    assert rest.core_polymer_fraction_conservative == pytest.approx(0.05, rel=1e-15)
    assert float(f"{float(five.core_polymer_fraction_conservative):.9g}") == 0.0598381210
    assert float(f"{float(twenty.core_polymer_fraction_conservative):.9g}") == 0.951212137
    assert float(f"{float(five.core_polymer_fraction_eq40):.5g}") == 0.060305
    assert float(f"{float(twenty.core_polymer_fraction_eq40):.5g}") == 0.80905
    assert 225 < np.exp(net.log_fraction_eq40(40.0, 0.05)) < 235
    assert forty.core_polymer_fraction == 1.0
    assert forty.compacted
    v_c = net.compaction_velocity_ratio([0.03, 0.05, 0.1])
    np.testing.assert_allclose(v_c, [38.0141410527, 20.8418340113, 9.00600942256], rtol=2e-12)
    np.testing.assert_allclose(net.radius_ratio(v_c), [0.162191245583, 0.219044338950, 0.333222103429], rtol=3e-12)
    np.testing.assert_allclose(np.exp(net.log_fraction_eq40(v_c, [0.03, 0.05, 0.1])), 1.0, rtol=1e-13)


def test_affinity_of_the_solvent() -> None:
    a = net.affinity(1e-9 / 0.05, 0.01, 1e-3, 1e-9, 293.15)
    assert float(f"{float(a):.9g}") == 0.0164715914
    # one number in two forms: A = alpha_v b / (3 r0)
    alpha = net.elastic_coupling(1e-9 / 0.05, 0.01, 1e-3, 125e-6, 293.15)
    assert alpha * 1e-9 / (3 * 125e-6) == pytest.approx(float(a), rel=1e-14)


def test_limits() -> None:
    phi = np.array([1e-6, 0.01, 0.05, 0.5, 0.9])
    rest = net.random_walk(1.0, phi)
    np.testing.assert_allclose(rest.axial_stretch, np.tanh(3 * phi) / (3 * phi), rtol=2e-15)
    assert (rest.orientation == 0).all()
    np.testing.assert_allclose(rest.axial_stretch, rest.radial_contraction, rtol=1e-15)
    full = net.random_walk(1e12, phi)
    assert (full.relative_extension == 1).all()
    assert (full.orientation == 1).all()
    assert (full.radial_contraction == 0).all()
    assert np.isfinite(full.log_radial_contraction).all()
    tiny = np.array([1e-300, 1e-30, 1e-8])
    np.testing.assert_allclose(net.relative_extension(tiny, 0.0), tiny / 3, rtol=1e-15)
    assert round(float(net.relative_extension(3.0, 0.15)), 3) == 0.829  # Langevin gives 0.672
    assert net.relative_extension(-2.0, 0.1) == -net.relative_extension(2.0, 0.1)
    assert net.orientation(-2.0, 0.1) == net.orientation(2.0, 0.1)


def test_extension_at_the_crossover_is_not_full() -> None:
    assert float(net.random_walk(1e6, 1e-6).relative_extension) == pytest.approx(0.830, abs=1e-3)
    v = net.extension_velocity_ratio(0.83, 0.05)
    assert float(net.random_walk(v, 0.05).relative_extension) == pytest.approx(0.83, rel=1e-14)
    assert net.extension_velocity_ratio(0.83, 0.05, closure="stretch") == 0.83 / 0.05
    assert np.isnan(net.extension_velocity_ratio(0.01, 0.9, affinity=0.1))  # less than any V > 0 gives


def test_stretch_closure_against_the_force_closure() -> None:
    # at phi V = 1/2 the affine force gives 0.4867 of the contour (phi = 0.05), the affine stretch 0.5
    phi, v = 0.05, 10.0
    assert round(float(net.random_walk(v, phi).relative_extension), 4) == 0.4867
    assert float(net.stretched_walk(v, phi).relative_extension) == pytest.approx(0.5)
    held = net.stretched_walk([20.0, 25.0], 0.05)
    assert (held.axial_stretch == 20).all()
    assert np.isinf(held.force).all()
    assert (held.radial_contraction == 0).all()
    below = net.stretched_walk(np.linspace(0.5, 19.9999, 500), 0.05)
    forward = net.relative_extension(below.force, 0.15)
    np.testing.assert_allclose(forward, below.relative_extension, rtol=1e-13)


@given(st.floats(-1 + 1e-15, 1 - 1e-15, allow_subnormal=False), st.floats(0, 5))
def test_force_is_the_inverse_of_extension(x: float, f0: float) -> None:
    f = mp.mpf(float(net.axial_force(x, f0)))
    exact = mp.atanh(mp.mpf(x)) + mp.asinh(2 * mp.cosh(mp.mpf(f0)) * mp.mpf(x) / mp.sqrt(1 - mp.mpf(x) ** 2))
    assert abs(f - exact) <= 4e-16 * abs(exact) * 4
    assert abs(mp.sinh(exact) / (mp.cosh(exact) + 2 * mp.cosh(mp.mpf(f0))) - mp.mpf(x)) < mp.mpf("1e-45")


@given(st.floats(1e-6, 0.9), st.floats(1.0, 1e9), st.floats(1.0, 1.5))
def test_monotone_and_bounded(phi: float, v: float, step: float) -> None:
    a, b = net.random_walk(v, phi), net.random_walk(v * step, phi)
    last_bits = 1 + 1e-15  # the step may be one rounding
    assert 0 < a.relative_extension <= b.relative_extension * last_bits
    assert b.relative_extension <= 1
    assert 0 <= a.orientation <= b.orientation * last_bits
    assert b.orientation <= 1
    assert b.log_radial_contraction - a.log_radial_contraction <= 1e-15 * max(1, abs(a.log_radial_contraction))
    one = net.affine_network(v, phi)
    for name in ("core_polymer_fraction", "core_polymer_fraction_eq40", "core_polymer_fraction_conservative"):
        assert 0 < getattr(one, name) <= 1


def test_conservative_form_keeps_the_flux() -> None:
    """Polymer flux phi_p pi r_P^2 u with u = v0 xi_par/xi_par(1) is that of the nozzle, before and after compaction."""
    phi, v = 0.05, np.geomspace(1, 1e4, 400)
    n = net.affine_network(v, phi)
    stretch = n.conformation.axial_stretch
    u = stretch / (np.tanh(0.15) / 0.15)
    radius_squared = n.network_radius_ratio_conservative**2 / v  # (r_P/r0)^2
    flux = n.core_polymer_fraction_conservative * radius_squared * u
    np.testing.assert_allclose(flux, phi, rtol=2e-14)
    assert n.compacted_conservative.any()
    # a network at its contour cannot carry the flux of a jet that still accelerates: flagged exactly there
    np.testing.assert_array_equal(n.flux_exceeded, n.compacted_conservative & (n.network_radius_ratio_conservative > 1))
    assert n.flux_exceeded.any()


def test_network_radius_is_continuous_at_compaction() -> None:
    v = np.linspace(18, 25, 20_001)
    for ratio in (
        net.affine_network(v, 0.05).network_radius_ratio,
        net.affine_network(v, 0.05).network_radius_ratio_conservative,
    ):
        assert np.abs(np.diff(ratio)).max() < 1e-4


@pytest.mark.parametrize("shape", [(), (1,), (0,), (2, 3)])
def test_shapes_and_precisions(shape: tuple[int, ...]) -> None:
    v = np.full(shape, 5.0, dtype=np.float32)
    n = net.affine_network(v, np.float32(0.05))
    assert n.core_polymer_fraction.shape == shape
    assert n.core_polymer_fraction.dtype == np.float64


def test_a_million_points() -> None:
    n = net.affine_network(np.geomspace(1, 1e9, 1_000_000), 0.05)
    assert np.isfinite(n.core_polymer_fraction).all()
    assert np.isfinite(n.conformation.orientation).all()


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"velocity_ratio": np.nan, "volume_fraction": 0.05}, "velocity_ratio"),
        ({"velocity_ratio": np.inf, "volume_fraction": 0.05}, "velocity_ratio"),
        ({"velocity_ratio": 0.0, "volume_fraction": 0.05}, "velocity_ratio"),
        ({"velocity_ratio": -1.0, "volume_fraction": 0.05}, "velocity_ratio"),
        ({"velocity_ratio": [1.0, np.nan], "volume_fraction": 0.05}, "velocity_ratio"),
        ({"velocity_ratio": "a", "volume_fraction": 0.05}, "velocity_ratio"),
        ({"velocity_ratio": 1j, "volume_fraction": 0.05}, "velocity_ratio"),
        ({"velocity_ratio": 1.0, "volume_fraction": 0.0}, "volume_fraction"),
        ({"velocity_ratio": 1.0, "volume_fraction": 1.0}, "volume_fraction"),
        ({"velocity_ratio": 1.0, "volume_fraction": 0.1, "affinity": -1.0}, "affinity"),
        ({"velocity_ratio": 1.0, "volume_fraction": 0.1, "solvent_quality": "bad"}, "solvent_quality"),
    ],
)
def test_refusals_name_the_field(arguments: dict, field: str) -> None:
    with pytest.raises(InputError, match=field):
        net.random_walk(**arguments)


def test_general_forces_far_outside_the_jet() -> None:
    for f, f0 in ((1e300, 0.1), (0.1, 1e300), (1e300, 1e300), (800.0, 1000.0), (0.0, 0.0), (1e-300, 1e-300)):
        x, y, o = (float(fn(f, f0)) for fn in (net.relative_extension, net.relative_contraction, net.orientation))
        assert 0 <= x <= 1
        assert 0 <= y <= 1
        assert -0.5 <= o <= 1
    e = mp.sinh(1000) / (mp.cosh(800) + 2 * mp.cosh(1000))
    assert relative(float(net.relative_contraction(800.0, 1000.0)), e) < 1e-14


def test_strand_force_in_newton() -> None:
    assert float(net.strand_force(3.0, 1e-9, 293.15)) == pytest.approx(3 * 1.380649e-23 * 293.15 / 1e-9, rel=1e-15)
    assert np.isnan(net.strand_force(np.inf, 1e-9, 293.15))
