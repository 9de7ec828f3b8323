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


def reference(jet, power, chi=100.0, solid=1.0, mixture=((1.0,), (1.0,))):
    """ln A and each solvent's volume against time, by LSODA; shares no code with the march."""
    shares, ratios = np.array(mixture)
    lg = np.log(chi) - 1.5
    q, g, eta, k, phi = (
        jet[n] for n in ("charge_density", "surface_tension", "extensional_viscosity", "evaporation", "volume_fraction")
    )

    def slope(t, y):
        a, part = np.exp(y[0]), np.maximum(y[1:], 1e-300)
        u = phi + part.sum()
        w = a * u
        drive = max(q * q * lg / (4 * EPS0) * a * a / w - g / np.sqrt(w), 0.0)
        return [-drive / (eta * u**-power), *(-k * ratios * part / part.sum() / a)]

    done = lambda t, y: phi + np.sum(y[1:]) - phi / solid  # noqa: E731
    done.terminal = True
    found = solve_ivp(
        slope,
        (0, jet["flight_time"]),
        [2 * np.log(jet["start"]), *((1 - phi) * shares)],
        method="LSODA",
        rtol=1e-10,
        atol=1e-12,
        events=done,
    )
    return np.exp(0.5 * found.y[0, -1]), phi / (phi + found.y[1:, -1].sum()), found.t[-1]


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


MIXTURES = {
    "DMF and acetone": ((0.6, 0.4), (0.6, 7.0)),
    "DMSO and acetone": ((0.5, 0.5), (0.4, 30.0)),
    "a trace of a fast one": ((0.99, 0.01), (1.0, 12.0)),
    "a trace of a slow one": ((0.001, 0.999), (0.01, 5.0)),
    "three": ((0.2, 0.3, 0.5), (20.0, 1.0, 4.0)),
}


@pytest.mark.parametrize("name", MIXTURES)
@pytest.mark.parametrize(
    "change", [{}, {"flight_time": 0.02}, {"surface_tension": 1e-6}, {"charge_density": 30.0}, {"evaporation": 1e-9}]
)
def test_mixtures_against_an_independent_integration(change, name):
    jet = JET | change
    radius, fraction, time = reference(jet, 4.67, solid=0.7, mixture=MIXTURES[name])
    found = thinning(**jet, solid_fraction=0.7, steps=1000, mixture=MIXTURES[name])
    assert float(found.radius) == pytest.approx(radius, rel=1e-3)
    assert float(found.volume_fraction) == pytest.approx(fraction, rel=2e-3)
    assert float(found.time) == pytest.approx(time, rel=4e-3)
    assert bool(found.wet) == (time >= jet["flight_time"] * (1 - 1e-9))


@pytest.mark.parametrize("solid", [0.7, 1.0])
def test_a_mixture_of_one_is_that_one(solid):
    """Alone, beside nothing of another, and of two that are equally volatile."""
    pure = thinning(**JET, solid_fraction=solid)
    assert float(thinning(**JET, solid_fraction=solid, mixture=((1.0,), (1.0,))).radius) == float(pure.radius)
    for mixture in (((1.0, 0.0), (1.0, 9.0)), ((0.0, 1.0), (0.01, 1.0)), ((0.3, 0.7), (1.0, 1.0))):
        found = thinning(**JET, solid_fraction=solid, mixture=mixture)
        for name in ("radius", "time", "volume_fraction", "strain_rate"):
            assert float(getattr(found, name)) == pytest.approx(float(getattr(pure, name)), rel=1e-12)


def test_a_share_swept_goes_from_one_solvent_to_the_other():
    share = np.linspace(0, 1, 201)
    kept = {k: np.array([v]) for k, v in JET.items()}
    of = lambda x: thinning(**kept, mixture=(np.stack([1 - x, x], -1), (1.0, 15.0))).radius  # noqa: E731
    radius = of(share)
    assert radius[0] == pytest.approx(float(thinning(**JET).radius), rel=1e-12)
    assert radius[-1] == pytest.approx(float(thinning(**JET | {"evaporation": 15 * 3e-11}).radius), rel=1e-12)
    steps = np.diff(np.log(radius))
    assert (steps > 0).all()
    assert steps.max() < 0.02
    i = int(np.argmax(steps))
    assert np.diff(np.log(of(np.linspace(share[i], share[i + 1], 9)))).max() < 0.3 * steps.max()


def test_the_fast_solvent_rules_a_race():
    """The constant rate of the docstring's integral, by quadrature along the drying; what is left last hardly counts."""
    p, phi = 4.67, JET["volume_fraction"]
    (w, r), k = np.array(MIXTURES["DMF and acetone"]), JET["evaporation"]
    sigma = np.concatenate(([0.0], np.geomspace(1e-9, 300, 200_001)))
    part = (1 - phi) * w * np.exp(-r * sigma[:, np.newaxis])
    u = phi + part.sum(axis=1)
    slow = part.sum(axis=1) / (k * part @ r)  # 1/k
    integral = p * np.sum(0.5 * (u[1:] ** (p - 1) * slow[1:] + u[:-1] ** (p - 1) * slow[:-1]) * -np.diff(u))
    constant = (1 - phi**p) / integral
    race = race_radius(300.0, 30.0, constant, phi, p, JET["start"])
    jet = JET | {"surface_tension": 1e-12, "flight_time": 1e9}
    errors = [
        abs(float(thinning(**jet, steps=n, mixture=MIXTURES["DMF and acetone"]).radius / race) - 1)
        for n in (50, 100, 200)
    ]
    assert errors[0] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.3)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.3)
    until_gone = k / np.sum(w / r)
    assert constant > 2 * until_gone


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
        ({"mixture": ((0.5, 0.4), (1.0, 2.0))}, "shares = 0.9: do not sum to 1"),
        ({"mixture": ((0.5, 0.5), (1.0, 0.0))}, "ratios"),
    ],
)
def test_refusals(change, words):
    with pytest.raises(InputError, match=words):
        thinning(**JET | change)
