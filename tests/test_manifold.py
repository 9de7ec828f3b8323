"""Steady network at finite coupling: exact solutions, series, an independent solver, the front, and locking."""

from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from spinline.base.errors import InputError
from spinline.network.manifold import eq33, steady_network
from spinline.network.radial import radial_mesh, solve_radial_mesh
from spinline.network.tension import Tension

LAWS = ("lattice", "langevin", "fene")


def power(beta: float = 0.47):
    return lambda s: np.maximum(s, 1.0) ** (2 * beta)


def test_closed_form_of_a_constant_gradient() -> None:
    """V = 1 + g s: w = a V with a = (1 - sqrt(1 - 4 eps g))/(2 eps g), wherever the far end is forgotten."""
    for g in (1e-4, 1e-3, 1e-2, 0.05):
        network = steady_network(lambda s, g=g: 1 + g * s, 2000.0, coupling=1.0, spring=1.0, rtol=1e-12)
        exact = (1 - np.sqrt(1 - 4 * g)) / (2 * g)
        s = np.array([0.0, 5.0, 20.0])
        np.testing.assert_allclose(network.stretch(s) / (1 + g * s), exact, rtol=1e-10)


@pytest.mark.parametrize("alpha", [20.0, 200.0, 2e3, 2e4, 1e6, 1e9, 1e12])
@pytest.mark.parametrize("beta", [0.25, 0.47, 0.5])
def test_against_an_independent_solver_or_series(alpha: float, beta: float) -> None:
    eps, s = 1 / alpha, 8.0
    network = steady_network(power(beta), 16.0, coupling=alpha, spring=1.0, breaks=[1.0], rtol=1e-12)
    if alpha < 1e4:  # another variable, another method: ln w marched upstream by scipy's Radau
        march = solve_ivp(
            lambda x, y: [(np.exp(-y[0]) - float(power(beta)(16.0 - x)) * np.exp(-2 * y[0])) / -eps],
            (0, 8.0),
            [0.0],
            method="Radau",
            rtol=1e-11,
            atol=1e-13,
        )
        reference = float(np.exp(march.y[0, -1]))
    else:  # formal series in eps to fourth order, 50 digits
        w = [mp.mpf(0)] * 5
        v = mp.taylor(lambda x: x ** (2 * mp.mpf(beta)), mp.mpf(s), 6)
        series = [v]
        for order in range(1, 5):  # w_n = sum_{j+k=n-1} w_j w_k' as Taylor coefficients about s
            total = [mp.mpf(0)] * 7
            for j in range(order):
                derivative = [(i + 1) * series[order - 1 - j][i + 1] for i in range(6)] + [mp.mpf(0)]
                for a in range(7):
                    for b in range(7 - a):
                        total[a + b] += series[j][a] * derivative[b]
            series.append(total)
        w = sum(mp.mpf(eps) ** n * series[n][0] for n in range(5))
        reference = float(w)
    assert float(network.stretch(s)) == pytest.approx(reference, rel=1e-8)


def test_reference_values_of_the_chain_at_small_mesh() -> None:
    """The design's chain values at h = 0.01 differ from the manifold by the O(h^2) term only."""
    for alpha, chain in ((20, 7.3806996), (200, 7.0911582), (2000, 7.0645560)):
        network = steady_network(power(), 16.0, coupling=alpha, spring=1.0, breaks=[1.0])
        assert float(network.stretch(8.0)) == pytest.approx(chain, abs=3e-6)
    assert float(eq33(8**0.94, 0.94 * 8**-0.06, 1 / 20)) == pytest.approx(7.36727, abs=1e-5)
    assert float(eq33(8**0.94, 0.94 * 8**-0.06, 1 / 200)) == pytest.approx(7.09104, abs=1e-5)


def test_observed_orders_in_the_coupling() -> None:
    alpha = np.array([1e3, 2e3, 4e3, 8e3])
    w = np.array(
        [
            float(steady_network(power(), 16.0, coupling=a, spring=1.0, breaks=[1.0], rtol=1e-12).stretch(8.0))
            for a in alpha
        ]
    )
    v, slope = 8**0.94, 0.94 * 8**-0.06
    affine = np.abs(w - v)
    first = np.abs(w - np.array([float(eq33(v, slope, 1 / a)) for a in alpha]))
    np.testing.assert_allclose(np.log2(affine[:-1] / affine[1:]), 1.0, atol=2e-3)
    np.testing.assert_allclose(np.log2(first[:-1] / first[1:]), 2.0, atol=2e-2)


def test_the_forward_march_blows_up_and_this_one_does_not() -> None:
    """Downstream, an error of 1e-10 at the inlet grows by e^(s / (eps w)): lost within a radius."""
    network = steady_network(power(), 16.0, coupling=200.0, spring=1.0, breaks=[1.0])
    start = float(network.stretch(2.0)) * (1 + 1e-10)
    forward = solve_ivp(
        lambda s, w: (1 - power()(s) / w) * 200, (2.0, 4.0), [start], method="Radau", rtol=1e-10, atol=1e-12
    )
    assert not forward.success or abs(forward.y[0, -1] / float(network.stretch(4.0)) - 1) > 1
    assert abs(float(network.stretch(4.0)) / 4**0.94 - 1) < 0.01


def test_what_is_left_of_the_far_end_falls_as_a_power_of_the_length() -> None:
    def at(length: float, g: float) -> float:
        return float(steady_network(lambda s: 1 + g * s, length, coupling=1.0, spring=1.0).stretch(1.0))

    # as L^(-2 q / (1 - q)), q = sqrt(1 - 4 eps g): L^(-1/2) at 0.24
    exact = 1.24 * (1 - np.sqrt(1 - 0.96)) / 0.48
    left = [abs(at(length, 0.24) / exact - 1) for length in (1e4, 1e6, 1e8, 1e10)]
    np.testing.assert_allclose(np.array(left[:-1]) / left[1:], 10.0, rtol=0.03)
    assert at(1e4, 0.2) == pytest.approx(1.2 * (1 - np.sqrt(0.2)) / 0.4, rel=1e-5)
    for length in (1e3, 1e6, 1e12):  # eps V' = 1/4 itself still has one: double root, w / V = 2
        assert 1.25 < at(length, 0.25) < 2.5
    single = steady_network(lambda s: (1 + 0.01 * s).astype(np.float32), 10.0, coupling=10, rtol=1e-5)
    double = steady_network(lambda s: 1 + 0.01 * s, 10.0, coupling=10, rtol=1e-5)
    assert float(single.stretch(2.0)) == pytest.approx(float(double.stretch(2.0)), rel=1e-5)


@pytest.mark.parametrize("law", LAWS)
def test_locking_is_nonlocal_and_never_passes_the_contour(law: str) -> None:
    tension = Tension.of(law, 20.0)
    s1 = brentq(lambda x: 20 * (40 - x) - (40**1.94 - x**1.94) / 1.94, 1, 20)
    gaps = []
    for alpha in (1e4, 1e6, 1e8, 1e12):
        network = steady_network(power(), 40.0, coupling=alpha, law=tension, breaks=[1.0])
        s = np.linspace(0, 40, 2001)
        extension = network.relative_extension(s)
        assert (extension <= 1).all()
        assert (extension > 0).all()
        gaps.append(abs(network.locked_from - s1))
    assert gaps[-1] < 1e-6
    assert all(b < a for a, b in pairwise(gaps))
    assert s1 < 20 ** (1 / 0.94)  # far upstream of V_S
    # the balance of forces over the locked stretch: T(s1) is the integral of the slip, 1 - V/w, over eps
    s = np.linspace(12, 39, 200_001)
    slip = 1 - power()(s) / network.stretch(s)
    integral = float(np.sum(0.5 * (slip[1:] + slip[:-1]) * np.diff(s))) / network.eps
    assert float(network.tension(39.0) - network.tension(12.0)) == pytest.approx(integral, rel=1e-7)


@pytest.mark.parametrize("law", LAWS)
def test_tension_of_a_locked_network_is_as_good_as_its_stretch(law: str) -> None:
    """Where w rounds to the contour only T tells panels that are too long."""
    s = np.linspace(0.1, 39.9, 3000)
    for alpha in (1e4, 1e8, 1e12):
        loose, tight = (
            steady_network(power(), 40.0, coupling=alpha, law=Tension.of(law, 5.0), breaks=[1.0], rtol=rtol).tension(s)
            for rtol in (1e-10, 1e-13)
        )
        np.testing.assert_allclose(loose, tight, rtol=1e-10)


@pytest.mark.parametrize("law", LAWS)
def test_bounded_laws_are_the_linear_one_for_small_extension(law: str) -> None:
    loose = steady_network(power(), 10.0, coupling=100.0, law=Tension.of(law, 1e6), breaks=[1.0])
    linear = steady_network(power(), 10.0, coupling=100.0, breaks=[1.0])
    s = np.linspace(0, 10, 50)
    np.testing.assert_allclose(loose.stretch(s), linear.stretch(s), rtol=1e-9)


def test_inertia() -> None:
    """Only eps - I enters for the linear spring; with I > eps the march turns round; in between it is refused."""
    a = steady_network(power(), 16.0, coupling=100.0, spring=1.0, inertia=0.005, breaks=[1.0])
    b = steady_network(power(), 16.0, coupling=200.0, spring=1.0, breaks=[1.0])
    np.testing.assert_allclose(a.stretch([2.0, 8.0, 15.0]), b.stretch([2.0, 8.0, 15.0]), rtol=1e-9)
    heavy = steady_network(power(), 16.0, coupling=1e6, spring=1.0, inertia=0.01, breaks=[1.0])
    assert float(heavy.stretch(8.0)) < 8**0.94  # lags
    assert float(heavy.stretch(0.0)) == pytest.approx(1.0)
    for inertia, law in ((0.01, None), (0.02, Tension.of("fene", 20.0))):
        with pytest.raises(InputError, match="inertia"):
            steady_network(power(), 16.0, coupling=100.0, spring=1.0, inertia=inertia, law=law, breaks=[1.0])


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"coupling": 0.0}, "coupling"),
        ({"coupling": np.nan}, "coupling"),
        ({"spring": -1.0}, "spring"),
        ({"inertia": -1.0}, "inertia"),
        ({"rtol": 0.0}, "rtol"),
        ({"length": 0.0}, "length"),
        ({"length": np.inf}, "length"),
    ],
)
def test_refusals(change: dict, field: str) -> None:
    arguments = {"velocity_ratio": power(), "length": 10.0, "coupling": 1e4, "breaks": [1.0]} | change
    with pytest.raises(InputError, match=field):
        steady_network(**arguments)


@pytest.mark.parametrize("returned", [np.nan, 0.0, -1.0, None, "fast", np.ones(3)])
def test_a_jet_that_is_no_function_of_place_is_refused(returned: object) -> None:
    with pytest.raises(InputError, match="velocity_ratio"):
        steady_network(lambda s: returned, 10.0, coupling=1e4)


def test_eq33_refuses_what_does_not_broadcast() -> None:
    with pytest.raises(InputError, match="slope"):
        eq33([2.0, 3.0], [0.1, 0.1, 0.1], 0.1)


def test_random_draws_are_finite_and_bounded_or_refused() -> None:
    rng = np.random.default_rng(11)
    answered = 0
    for _ in range(150):
        alpha, phi = 10 ** rng.uniform(-3, 15), 10 ** rng.uniform(-6, np.log10(0.9))
        beta, inertia = rng.uniform(0.25, 1.0), rng.choice([0.0, 10 ** rng.uniform(-12, 3)])
        law = rng.choice(["linear", *LAWS])
        length = 10 ** rng.uniform(0.5, 5)
        try:
            network = steady_network(
                power(beta),
                length,
                coupling=alpha,
                inertia=inertia,
                law=Tension.of(law, 1 / phi),
                breaks=[1.0],
                rtol=1e-8,
            )
        except InputError:
            continue
        answered += 1
        w = network.stretch(np.linspace(0, length, 100))
        assert np.isfinite(w).all()
        assert (w > 0).all()
        assert (w <= network.law.full_stretch).all()
    assert answered > 100


# ---- across the jet


def test_radial_closed_form_against_the_tridiagonal_system_and_mpmath() -> None:
    for beads in (1, 2, 7, 300):
        for kappa in (0.0, 1e-12, 1e-3, 0.5, 40.0):
            closed, solved = radial_mesh(beads, kappa, 0.3), solve_radial_mesh(beads, kappa, 0.3)
            np.testing.assert_allclose(closed.position, solved.position, rtol=1e-9, atol=1e-300)
    q = 2 * mp.asinh(mp.sqrt(mp.mpf("0.02")) / 2)
    exact = mp.sinh(30 * q) / (2 * mp.sinh(q / 2) * mp.cosh(mp.mpf("100.5") * q))
    assert float(radial_mesh(100, 0.02).position[30]) == pytest.approx(float(exact), rel=1e-13)


def test_radial_limits() -> None:
    np.testing.assert_allclose(radial_mesh(50, 0.0).position, np.arange(51))
    np.testing.assert_allclose(radial_mesh(50, 1e-300).spacing, 1.0)
    stiff = radial_mesh(1000, 1e4)
    assert stiff.radius == pytest.approx(1e-4, rel=1e-3)  # (1 + kappa) r_N = xi
    assert (stiff.position >= 0).all()
    assert (np.diff(radial_mesh(100, 0.1).spacing) > 0).all()
    assert np.isfinite(radial_mesh(1_000_000, 1e-6).position).all()
    for arguments in ((0, 1.0), (1.5, 1.0), (10, -1.0), (10, np.nan), (10, 1.0, 0.0)):
        with pytest.raises(InputError):
            radial_mesh(*arguments)
