"""Thinning of a bending jet: its three limits, an independent integration, and the extremes."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spinline.base.errors import InputError
from spinline.jetprofile.whipping import log_term, race_radius, terminal_radius, thinning

EPS0 = 8.8541878188e-12
JET = {
    "charge_density": 300.0,
    "surface_tension": 0.035,
    "extensional_viscosity": 30.0,
    "evaporation": 3e-11,
    "volume_fraction": 0.1,
    "flight_time": 10.0,
    "start": 2e-5,
}


def reference(jet, power, chi=100.0, solid=1.0):
    """ln A and the time against the undried volume, by LSODA; shares no code with the march."""
    lg = np.log(chi) - 1.5
    q, g, eta, k, phi = (
        jet[n] for n in ("charge_density", "surface_tension", "extensional_viscosity", "evaporation", "volume_fraction")
    )

    def slope(t, y):
        a, u = np.exp(y[0]), y[1]
        w = a * u
        drive = max(q * q * lg / (4 * EPS0) * a * a / w - g / np.sqrt(w), 0.0)
        return [-drive / (eta * u**-power), -k / a]

    done = lambda t, y: y[1] - phi / solid  # noqa: E731
    done.terminal = True
    found = solve_ivp(
        slope,
        (0, jet["flight_time"]),
        [2 * np.log(jet["start"]), 1.0],
        method="LSODA",
        rtol=1e-10,
        atol=1e-12,
        events=done,
    )
    return np.exp(0.5 * found.y[0, -1]), phi / found.y[1, -1], found.t[-1]


@pytest.mark.parametrize("power", [3.93, 4.67])
@pytest.mark.parametrize(
    "change",
    [
        {},
        {"flight_time": 0.02},
        {"flight_time": 1e-4},
        {"surface_tension": 1e-6},
        {"charge_density": 30.0},
        {"extensional_viscosity": 0.3},
        {"evaporation": 1e-9},
        {"charge_density": 5.0, "extensional_viscosity": 3.0},
    ],
)
def test_against_an_independent_integration(change, power):
    jet = JET | change
    radius, fraction, time = reference(jet, power)
    found = thinning(**jet, power=power, steps=400)
    assert float(found.radius) == pytest.approx(radius, rel=3e-3)
    assert float(found.volume_fraction) == pytest.approx(fraction, rel=2e-2)
    assert float(found.time) == pytest.approx(time, rel=3e-2)
    assert bool(found.wet) == (time >= jet["flight_time"] * (1 - 1e-9))


def test_order_in_the_steps_is_one():
    jet = JET | {"extensional_viscosity": 1.0}
    exact = float(thinning(**jet, steps=12800).radius)
    errors = [abs(float(thinning(**jet, steps=n).radius) / exact - 1) for n in (100, 200, 400)]
    assert errors[0] < 2e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(1, abs=0.2)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(1, abs=0.2)


def test_without_surface_tension_it_is_the_race_whatever_the_steps():
    jet = JET | {"surface_tension": 1e-12, "flight_time": 1e6}
    race = race_radius(
        jet["charge_density"],
        jet["extensional_viscosity"],
        jet["evaporation"],
        jet["volume_fraction"],
        4.67,
        jet["start"],
    )
    for steps in (8, 96):
        assert float(thinning(**jet, steps=steps).radius) == pytest.approx(float(race), rel=1e-6)


def test_a_thick_start_is_forgotten():
    q, eta, k = 300.0, 30.0, 3e-11
    a = race_radius(q, eta, k, 1e-6, 4.0)
    assert float(a) == pytest.approx((2 * 4 * EPS0 * eta * k / (q * q * log_term())) ** 0.25, rel=1e-12)


def test_without_drying_it_ends_at_the_terminal_radius():
    jet = JET | {"evaporation": 1e-18, "extensional_viscosity": 1e-3, "flight_time": 10.0}
    found = thinning(**jet)
    assert float(found.radius) == pytest.approx(float(terminal_radius(300.0, 0.035)), rel=2e-3)
    assert bool(found.wet)


def test_terminal_radius_is_fridrikhs():
    """8 eps0 gamma/(q^2 (2 ln chi - 3)), the same number as the Gaussian form of the paper."""
    a = (8 * EPS0 * 0.03 / (100.0**2 * (2 * np.log(100) - 3))) ** (1 / 3)
    assert float(terminal_radius(100.0, 0.03)) == pytest.approx(a, rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_extremes_are_finite_and_ordered(seed):
    rng = np.random.default_rng(seed)
    low = np.array([1e-6, 1e-4, 1e-6, 1e-18, 1e-4, 1e-9, 1e-8])
    high = np.array([1e6, 1.0, 1e6, 1e-4, 0.9, 1e6, 1e-2])
    draws = np.exp(rng.uniform(np.log(low), np.log(high), (5000, 7))).T
    found = thinning(*draws, power=rng.uniform(0.5, 8, 5000))
    start, phi, flight = draws[6], draws[4], draws[5]
    assert np.isfinite(found.radius).all()
    assert (found.radius <= start * (1 + 1e-12)).all()
    assert (found.volume_fraction >= phi * (1 - 1e-12)).all()
    assert (found.volume_fraction <= 1 + 1e-12).all()
    assert (found.time <= flight * (1 + 1e-9)).all()
    assert (found.radius >= np.minimum(terminal_radius(draws[0], draws[1]), start) * phi**0.4 * (1 - 1e-3)).all()


def test_monotone():
    n = np.geomspace(0.1, 10, 30)
    base = {k: np.full(30, v) for k, v in JET.items()}
    assert (np.diff(thinning(**base | {"charge_density": 300 * n}).radius) < 0).all()
    assert (np.diff(thinning(**base | {"extensional_viscosity": 30 * n}).radius) > 0).all()
    assert (np.diff(thinning(**base | {"flight_time": 0.01 * n}).radius) <= 0).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"charge_density": 0.0}, "charge_density"),
        ({"evaporation": -1.0}, "evaporation"),
        ({"volume_fraction": 1.0}, "solid already"),
        ({"start": np.nan}, "start"),
        ({"flight_time": np.inf}, "flight_time"),
    ],
)
def test_refusals(change, words):
    with pytest.raises(InputError, match=words):
        thinning(**JET | change)
