"""Eq. (32b) in a moving jet: limits, order, conservation, the surface as a bound, bad input."""

import re
import warnings

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.jetprofile import PowerLaw
from spinline.network import affine_network, lateral_network, radial_mesh
from spinline.network.lateral import _march
from spinline.scene import load_scene

JET = PowerLaw(radius=125e-6, flow_rate=8.9e-10, k=1.0, beta=0.47)
Z = np.linspace(0.0, 10e-3, 401)
V = JET.velocity_ratio(Z)
TRANSIT = JET.residence_time(Z) * JET.initial_velocity / JET.initial_radius
WALK = affine_network(V, 0.05).conformation.radial_contraction
Q = WALK / WALK[0]


@pytest.mark.slow
def test_slow_network_is_eq_32b():
    """w -> 0 forgets its motion: the mesh at rest, in the limit of many beads."""
    eps, slope, pull, w = 0.03, 2.0, 0.8, 1e-3
    s = np.linspace(0.0, 60 * w / slope, 3001)
    moving = lateral_network(
        eps * s / w, 1 + slope * s, np.full_like(s, pull), 0.05, network_velocity_ratio=np.full_like(s, w), rtol=1e-5
    )
    beads = 200_000  # the mesh at rest differs from its limit by q/2 = 3 / beads
    still = radial_mesh(beads, slope / (2 * eps) / beads**2, pull / beads)
    assert moving.edges[-1, -1] == pytest.approx(still.radius, rel=1e-4)
    at = np.interp(moving.layer_edges, np.linspace(0, 1, beads + 1), still.position)
    np.testing.assert_allclose(moving.edges[-1], at, atol=2e-4 * still.radius)


def test_surface_layer_against_the_half_space():
    """A pull that falls as 1 - a F: the surface retreats by (4/3) a F^(3/2) / pi^(1/2)."""
    fourier, a = np.linspace(0.0, 1e-3, 101), 300.0
    network = lateral_network(fourier, np.ones_like(fourier), 1 - a * fourier, 0.05, rtol=1e-5)
    exact = 1 - a * 4 / 3 * fourier**1.5 / np.sqrt(np.pi)
    np.testing.assert_allclose(network.radius_ratio, exact, atol=5e-6)
    assert np.abs(network.radius_ratio - exact).max() < 3 * network.error


def test_second_order():
    """Halving layers and steps, a smooth pull."""
    fourier = np.linspace(0.0, 0.2, 11)
    pull = 1 - 2 * fourier**2
    fine = _march(fourier, pull, np.full_like(pull, 1.0), 640, 64)[0][-1, -1]
    errors = [
        abs(_march(fourier, pull, np.full_like(pull, 1.0), n, m)[0][-1, -1] - fine)
        for n, m in ((20, 2), (40, 4), (80, 8))
    ]
    assert min(np.log2(errors[0] / errors[1]), np.log2(errors[1] / errors[2])) > 1.9


@pytest.mark.parametrize("number", [1e-6, 1e-3, 1.0, 1e3])
def test_flux_is_carried(number):
    """Sum of fraction times area times velocity: the same everywhere, to rounding."""
    network = lateral_network(number * TRANSIT, V, Q, 0.05)
    flux = (np.diff(network.edges**2, axis=1) * network.polymer_fraction).sum(axis=1) * V
    np.testing.assert_allclose(flux, 0.05, rtol=1e-12)
    assert (np.diff(network.radius_ratio) < 1e-12).all()
    assert (network.mesh > 0).all()


def test_limits():
    """No time: with the solution. All the time: as wide as the strands are, the surface permitting."""
    still = lateral_network(np.zeros_like(V), V, Q, 0.05)
    np.testing.assert_allclose(still.radius_ratio, 1.0, rtol=1e-12)
    np.testing.assert_allclose(still.polymer_fraction, 0.05, rtol=1e-12)
    free = lateral_network(1e5 * TRANSIT, V, Q, 0.05, rtol=1e-3)
    np.testing.assert_allclose(free.radius_ratio, np.minimum(1, Q * np.sqrt(V)), atol=2e-3)
    wide = lateral_network(
        TRANSIT, V, np.full_like(V, 2.0), 0.05
    )  # strands wider than the flow: pressed to the surface
    np.testing.assert_allclose(wide.radius_ratio, 1.0, rtol=1e-12)
    assert not wide.detached.any()


def test_leaves_the_surface_where_strands_are_narrower_than_the_flow():
    network = lateral_network(TRANSIT, V, Q, 0.05)
    first = int(np.flatnonzero(network.detached)[0])
    assert (Q * np.sqrt(V))[first - 1 : first + 1] == pytest.approx([1, 1], abs=0.02)
    assert (Q * np.sqrt(V))[first] < 1


def test_one_station_and_single_precision():
    one = lateral_network([0.0], [1.0], [1.0], 0.05)
    assert one.radius_ratio.tolist() == [1.0]
    single = lateral_network(TRANSIT.astype(np.float32), V.astype(np.float32), Q.astype(np.float32), 0.05)
    double = lateral_network(TRANSIT, V, Q, 0.05)
    np.testing.assert_allclose(single.radius_ratio, double.radius_ratio, rtol=1e-3)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"fourier": -TRANSIT}, "fourier"),
        ({"fourier": TRANSIT[::-1]}, "fourier"),
        ({"fourier": TRANSIT * np.nan}, "fourier"),
        ({"fourier": TRANSIT[:-1]}, "fourier"),
        ({"fourier": []}, "fourier"),
        ({"velocity_ratio": V * 0}, "velocity_ratio"),
        ({"velocity_ratio": V * np.inf}, "velocity_ratio"),
        ({"contraction": -Q}, "contraction"),
        ({"volume_fraction": 1.0}, "volume_fraction"),
        ({"volume_fraction": 0.0}, "volume_fraction"),
        ({"network_velocity_ratio": V * 1e-6}, "network_velocity_ratio"),
        ({"network_velocity_ratio": V * 0}, "network_velocity_ratio"),
        ({"layers": 3}, "layers"),
        ({"layers": 20.5}, "layers"),
        ({"rtol": 0.0}, "rtol"),
        ({"rtol": 1.0}, "rtol"),
    ],
)
def test_bad_input(change, named):
    arguments = {"fourier": TRANSIT, "velocity_ratio": V, "contraction": Q, "volume_fraction": 0.05} | change
    with pytest.raises(InputError, match=named):
        lateral_network(**arguments)


@pytest.mark.slow
def test_random_stations_end_in_numbers_or_a_named_error():
    """Over many decades of everything: 0 <= r_P <= r, fractions positive, flux carried."""
    rng = np.random.default_rng(8)
    answered = 0
    for _ in range(25):
        n = int(rng.integers(1, 30))
        v = np.cumprod(np.concatenate(([1.0], 10 ** rng.uniform(0, 0.6, n))))
        time = np.cumsum(np.concatenate(([0.0], 10 ** rng.uniform(-8, 3, n))))
        q = 10 ** rng.uniform(-3, 1, n + 1)
        w = v * 10 ** rng.uniform(-1, 0.3, n + 1)
        try:
            network = lateral_network(time, v, q, 0.1, network_velocity_ratio=w, rtol=1e-2)
        except InputError:
            continue
        answered += 1
        assert (network.radius_ratio > 0).all()
        assert (network.radius_ratio <= 1 + 1e-9).all()
        assert np.isfinite(network.edges).all()
        flux = (np.diff(network.edges**2, axis=1) * network.polymer_fraction).sum(axis=1) * w
        np.testing.assert_allclose(flux, 0.1, rtol=1e-9)
    assert answered > 8


def test_in_a_run():
    """`network.lateral`: one more radius, and the fraction across the network, its flux that of the polymer."""
    result = sl.run(load_scene("peo5-water", ["network.lateral=true", "accuracy.points=201"]))
    radius, jet = result["lateral_network_radius"].values, result["radius"].values
    assert (radius <= jet * (1 + 1e-12)).all()
    assert radius[-1] < jet[-1]
    assert (radius >= 0.9 * jet).all()  # F is 1e-3: no time to contract as Eq. (39) says
    assert result["lateral_polymer_fraction"].dims == ("z", "layer")
    still = result["lateral_polymer_fraction"].values[0]
    np.testing.assert_allclose(still, float(result["volume_fraction"]), rtol=1e-9)
    with pytest.raises(InputError, match="straight"):
        sl.run(load_scene("pvp-jetspin", ["network.lateral=true"]))


@pytest.mark.parametrize("changes", [["network.closure=stretch", "jet.length=20 mm"], ["jet.k=30", "jet.length=3 mm"]])
def test_strands_without_width_are_the_reason_and_the_remedy_works(changes):
    """A reason is the test that failed, a remedy is a key that exists: the length it names runs."""
    scene = ["network.lateral=true", "network.closure=stretch", "jet.length=20 mm"]
    with pytest.raises(InputError, match=r"at their contour from .* mm on") as refused:
        sl.run(load_scene("peo5-water", scene))
    length = re.search(r'jet\.length = "(.*?)"', refused.value.remedy)[1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        result = sl.run(load_scene("peo5-water", [*scene, f"jet.length={length}"]))
    assert (result["lateral_network_radius"].values > 0).all()


def test_a_crystallinity_that_is_not_there_has_its_reason():
    """A polymer that crystallises at equilibrium has no degree of it; the file says why, and where kinetics are given it has."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        result = sl.run(
            load_scene("peo5-water", ["ambient.relative_humidity=0.2", "jet.length=200 mm", "accuracy.points=51"])
        )
    assert np.isnan(result["crystallinity"])
    assert "crystallisation" in result["crystallinity"].attrs["missing"]
