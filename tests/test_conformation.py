"""Conformation along an element: closed forms, both limits with their rates, order, stiffness, refusals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from spinline.base.errors import InputError
from spinline.jetprofile import PowerLaw
from spinline.rheology.conformation import (
    FENEP,
    Giesekus,
    Maxwell,
    OldroydB,
    conformation,
    maxwell_startup,
    steady_fenep,
    tensile_force,
)

MODELS = [Maxwell(), OldroydB(0.1), Giesekus(0.2), FENEP(400.0)]


def test_reference_values() -> None:
    state = conformation([0.0, 3.0], np.exp([0.0, 2.25]), 1.0)
    assert state.axial[-1] == pytest.approx(11.445067211, abs=5e-10)
    assert state.radial[-1] == pytest.approx(0.573677507885, abs=5e-13)
    assert steady_fenep(1.0, 400.0) == pytest.approx((201.326195055, 0.332782349643), rel=3e-12)
    t = np.linspace(0, 60, 7)
    steady = conformation(t, np.exp(t), 1.0, FENEP(400.0))
    assert (steady.axial[-1], steady.radial[-1]) == pytest.approx((201.326195055, 0.332782349643), rel=1e-10)


@settings(deadline=None)
@given(st.floats(-8, 12), st.floats(0.01, 5.0), st.integers(1, 30))
def test_constant_rate_is_exact_at_any_theta(decades: float, strain: float, steps: int) -> None:
    theta = 10**decades
    t = np.linspace(0, strain, steps + 1)  # edot = 1
    state = conformation(t, np.exp(t), theta)
    axial, radial = maxwell_startup(theta, t / theta)
    np.testing.assert_allclose(state.axial, axial, rtol=1e-12)
    np.testing.assert_allclose(state.radial, radial, rtol=1e-12)


@pytest.mark.parametrize("de", [0.3, 0.5, 0.75, 3.0])
def test_giesekus_and_fenep_reduce_to_maxwell(de: float) -> None:
    t = np.linspace(0, 3, 4)
    exact = maxwell_startup(de, t)
    for model in (Giesekus(0.0), FENEP(1e12)):
        state = conformation(t, np.exp(de * t), 1.0, model)
        np.testing.assert_allclose(state.axial, exact[0], rtol=2e-6 if isinstance(model, FENEP) else 1e-10)
        np.testing.assert_allclose(state.radial, exact[1], rtol=2e-6 if isinstance(model, FENEP) else 1e-10)


def test_giesekus_steady() -> None:
    de, alpha = 2.0, 0.3
    t = np.linspace(0, 40, 5)
    state = conformation(t, np.exp(de * t), 1.0, Giesekus(alpha))
    for value, power in ((state.axial[-1], 2.0), (state.radial[-1], -1.0)):
        assert power * de * value == pytest.approx((value - 1) * (1 + alpha * (value - 1)), rel=1e-9)


def history(n: int, theta: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smooth element: Lambda = (1 + t)^2."""
    t = np.linspace(0, 4, n)
    return t, (1 + t) ** 2, 2 / (1 + t)


def exact(theta: float, end: float = 4.0) -> float:
    def integrand(s: float) -> float:
        return ((1 + end) / (1 + s)) ** 4 * np.exp(-(end - s) / theta) / theta

    far = max(0.0, end - 45 * theta)
    return (1 + end) ** 4 * np.exp(-end / theta) + quad(integrand, far, end, epsabs=0, epsrel=1e-13, limit=400)[0]


@pytest.mark.parametrize("theta", [1e-3, 0.3, 10.0, 1e6])
def test_order_four_with_rates_and_two_without(theta: float) -> None:
    for use, order in ((True, 3.8), (False, 1.9)):
        errors = []
        for n in (17, 33, 65) if use else (65, 129, 257):
            t, stretch, rate = history(n, theta)
            state = conformation(t, stretch, theta, strain_rate=rate if use else None)
            errors.append(abs(state.axial[-1] / exact(theta) - 1))
        if theta < 1e3:  # the affine limit has no error at all
            assert min(np.log2(np.divide(errors[:-1], errors[1:]))) > (order if theta > 0.01 else order / 2 - 0.05)
        else:
            assert max(errors) < 1e-6
    t, stretch, rate = history(1025, theta)
    assert conformation(t, stretch, theta, strain_rate=rate).axial[-1] == pytest.approx(exact(theta), rel=1e-10)


@pytest.mark.parametrize("model", [Maxwell(), Giesekus(0.2), FENEP(1e6)])
def test_slow_relaxation_is_affine_at_rate_one(model) -> None:
    t, stretch, rate = history(65, 1.0)
    gaps = []
    for theta in (1e7, 1e8, 1e9):
        state = conformation(t, stretch, theta, model, strain_rate=rate)
        gaps.append(abs(state.axial[-1] / stretch[-1] ** 2 - 1))
    assert np.log10(gaps[0] / gaps[1]) == pytest.approx(1.0, abs=0.02)
    assert np.log10(gaps[1] / gaps[2]) == pytest.approx(1.0, abs=0.05)
    far = conformation(t, stretch, 1e12, model, strain_rate=rate)
    assert far.axial[-1] == pytest.approx(stretch[-1] ** 2, rel=1e-7)
    assert far.radial[-1] == pytest.approx(1 / stretch[-1], rel=1e-7)


@pytest.mark.parametrize("model", MODELS)
def test_fast_relaxation_is_rest_at_rate_one(model) -> None:
    t, stretch, rate = history(65, 1.0)
    for theta, tolerance in ((1e-4, 1e-3), (1e-6, 1e-5), (1e-8, 2e-5)):
        state = conformation(t, stretch, theta, model, strain_rate=rate)
        assert (state.axial[-1] - 1) / (2 * theta * rate[-1]) == pytest.approx(1.0, abs=tolerance)
        assert (state.radial[-1] - 1) / (-theta * rate[-1]) == pytest.approx(1.0, abs=tolerance)


@settings(max_examples=25, deadline=None)
@given(st.floats(-8, 12), st.sampled_from([4.0, 400.0, 1e5]))
def test_fenep_never_passes_its_contour(decades: float, limit: float) -> None:
    t = np.linspace(0, 6, 13)
    state = conformation(t, np.exp(t), 10**decades, FENEP(limit))
    assert (state.axial > 0).all()
    assert (state.radial > 0).all()
    assert (state.axial + 2 * state.radial < limit * (1 + 1e-12)).all()
    assert (np.diff(state.axial) > -1e-8).all()


def test_theta_and_modulus_may_vary() -> None:
    # theta grows exponentially: tau is known in closed form, rest decays as exp(-tau)
    t = np.linspace(0, 2, 9)
    theta = 0.5 * np.exp(0.7 * t)
    state = conformation(t, np.ones(9), theta, start=(5.0, 3.0))
    tau = (1 - np.exp(-0.7 * t)) / (0.7 * 0.5)
    np.testing.assert_allclose(state.axial - 1, 4 * np.exp(-tau), rtol=1e-12)
    np.testing.assert_allclose(state.radial - 1, 2 * np.exp(-tau), rtol=1e-12)
    nonlinear = conformation(t, np.ones(9), theta, Giesekus(0.0), start=(5.0, 3.0))
    np.testing.assert_allclose(nonlinear.axial, state.axial, rtol=1e-8)
    axial, radial = state.stress(np.linspace(1, 2, 9))  # conformation form: G enters only here
    np.testing.assert_allclose(axial, np.linspace(1, 2, 9) * (state.axial - 1), rtol=1e-14)
    np.testing.assert_allclose(tensile_force(axial, radial, 1e-3), np.pi * 1e-6 * (axial - radial), rtol=1e-14)


def test_stress_of_oldroyd_b_and_fenep() -> None:
    t = np.linspace(0, 20, 11)
    de = 0.25
    fluid = conformation(t, np.exp(de * t), 1.0, OldroydB(0.2))
    along, across = fluid.stress(3.0)
    # steady elongational viscosity: 3 mu_s + 3 mu_p / ((1 - 2 De)(1 + De))
    assert (along[-1] - across[-1]) / de == pytest.approx(3 * 0.2 + 9 / ((1 - 2 * de) * (1 + de)), rel=1e-4)
    spring = conformation(t, np.exp(t), 1.0, FENEP(400.0))
    f = (400 - 3) / (400 - spring.axial - 2 * spring.radial)
    np.testing.assert_allclose(spring.stiffening, f, rtol=1e-9)
    np.testing.assert_allclose(spring.stress(2.0)[0], 2 * (f * spring.axial - 1), rtol=1e-9)
    np.testing.assert_allclose(spring.weissenberg, 1.0, rtol=1e-12)
    np.testing.assert_allclose(spring.stretch, np.sqrt(spring.axial), rtol=1e-15)
    np.testing.assert_allclose(spring.contraction, np.sqrt(spring.radial), rtol=1e-15)


def test_along_a_jet_with_its_kink() -> None:
    jet = PowerLaw(radius=125e-6, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
    onset = jet.onset * jet.initial_radius
    z = np.concatenate((np.linspace(0, onset, 5), np.geomspace(onset, 5e-3, 400)[1:]))
    t, stretch = jet.residence_time(z), jet.stretch_ratio(z)
    state = conformation(t, stretch, 0.02, strain_rate=jet.strain_rate(z))
    np.testing.assert_allclose(state.axial[:5], 1.0, rtol=1e-14)
    theta, end = 0.02, float(t[-1])

    def integrand(x: float) -> float:
        at = float(jet.residence_time(x))
        return (
            (stretch[-1] / float(jet.stretch_ratio(x))) ** 2
            * np.exp(-(end - at) / theta)
            / theta
            / float(jet.velocity(x))
        )

    total = stretch[-1] ** 2 * np.exp(-end / theta)
    total += sum(quad(integrand, a, b, epsrel=1e-12)[0] for a, b in ((0, onset), (onset, 1e-3), (1e-3, 5e-3)))
    assert state.axial[-1] == pytest.approx(total, rel=1e-8)
    assert 1 < state.stretch[-1] < stretch[-1]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: conformation([0.0], [1.0], 1.0), "time"),
        (lambda: conformation([1.0, 0.0], [1.0, 1.0], 1.0), "strictly increase"),
        (lambda: conformation([0.0, 1.0], [1.0], 1.0), "stretch_ratio"),
        (lambda: conformation([0.0, 1.0], [1.0, 0.0], 1.0), "stretch_ratio"),
        (lambda: conformation([0.0, 1.0], [1.0, 1.0], 0.0), "relaxation_time"),
        (lambda: conformation([0.0, 1.0], [1.0, 1.0], [1.0]), "relaxation_time"),
        (lambda: conformation([0.0, 1.0], [1.0, 1.0], 1.0, strain_rate=[np.nan, 0.0]), "strain_rate"),
        (lambda: conformation([0.0, 1.0], [1.0, 1.0], 1.0, start=(0.0, 1.0)), "start"),
        (lambda: FENEP(3.0), "extensibility"),
        (lambda: conformation([0.0, 1.0], [1.0, 1.0], 1.0, FENEP(9.0), start=(9.0, 1.0)), "contour"),
        (lambda: Giesekus(1.5), "mobility"),
        (lambda: OldroydB(-1.0), "solvent_viscosity"),
        (lambda: conformation([0.0, 1.0], [1.0, 1e300], 1e3), "strain of a step"),
        (lambda: conformation(np.arange(3.0), [1.0, 1e100, 1e200], 1e3), "FENE-P"),
        (lambda: conformation([0.0, 1.0], [1.0, 1.0], 1.0).stress([1.0]), "modulus"),
        (lambda: maxwell_startup(1e3, 1e3), "strain"),
        (lambda: steady_fenep(-1.0, 400.0), "weissenberg"),
        (lambda: tensile_force(1.0, 1.0, 0.0), "radius"),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(InputError, match=words):
        call()


@pytest.mark.parametrize("model", [Maxwell(), FENEP(400.0)])
def test_long_histories(model) -> None:
    """More samples than the steps that one hard span may take; linear models in blocks, so that memory stays small."""
    n = 300_001
    time = np.linspace(0.0, 1.0, n)
    fine = conformation(time, np.exp(2 * time), 0.1, model)
    coarse = conformation(time[::100], np.exp(2 * time[::100]), 0.1, model)
    np.testing.assert_allclose(fine.axial[::100], coarse.axial, rtol=1e-8)


def test_time_beyond_what_a_double_can_count() -> None:
    with pytest.raises(InputError, match="time over relaxation_time"):
        conformation([0.0, 1e300], [1.0, 2.0], 1e-300)
