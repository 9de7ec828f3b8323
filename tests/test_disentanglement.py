"""Entanglements that let go: printed values, the tensor by another integrator, limits, bounds under any flow, bad input."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spinline.base.errors import InputError
from spinline.network.disentanglement import disentangle, rouse_time, strand_fraction
from spinline.rheology.conformation import conformation


@pytest.mark.parametrize(
    ("rouse", "release", "axial", "radial"),
    [
        (0.1, 0.0, 3.95858922, 0.15993351),
        (0.1, 1.0, 2.92168214, 0.41259472),
        (1e-5, 0.0, 2.68624101, 0.15693008),
        (1e-5, 1.0, 2.13285493, 0.43360652),
    ],
)
def test_printed_values(rouse, release, axial, radial) -> None:
    state = disentangle(
        [0.0, 3.0], np.exp([0.0, 6.0]), 1.0, rouse, release=release, entanglement_release=0.0, rtol=1e-11
    )
    assert float(state.axial[-1]) == pytest.approx(axial, abs=1e-7)
    assert float(state.radial[-1]) == pytest.approx(radial, abs=1e-7)
    if rouse == 1e-5:
        assert float(state.axial[-1] + 2 * state.radial[-1]) == pytest.approx(3.0, abs=2e-4)


def test_the_whole_system_by_another_integrator() -> None:
    """The equations as printed, full tensor, nu and the contour that grows with it, by scipy's implicit Runge-Kutta."""
    tau_d, tau_r, segments, beta, loss, rate = 1.0, 0.05, 300.0, 0.7, 0.4, 3.0

    def rates(t, y):
        a, nu = y[:9].reshape(3, 3), y[9]
        kappa = rate * np.diag([1.0, -0.5, -0.5])
        trace = np.trace(a)
        lam_c, m2 = np.sqrt(trace / 3), segments / (3 * nu)
        k = (m2 - 1) / (m2 - lam_c**2)
        back = 2 * k * (1 - np.sqrt(3 / trace)) / tau_r
        da = (
            kappa @ a
            + a @ kappa.T
            - (a - np.eye(3)) / tau_d
            - back * (a + beta * (trace / 3) ** -0.5 * (a - np.eye(3)))
        )
        dlam = np.trace(da) / (6 * lam_c)
        s = (a[0, 0] - a[1, 1]) / trace
        return np.append(da.ravel(), (1 - nu) / tau_d - loss * nu * max(rate * s - dlam / lam_c, 0))

    out = solve_ivp(rates, (0, 2), np.append(np.eye(3).ravel(), 1.0), method="Radau", rtol=1e-10, atol=1e-12)
    t = np.linspace(0, 2, 50)
    state = disentangle(
        t, np.exp(rate * t), tau_d, tau_r, segments=segments, release=beta, entanglement_release=loss, rtol=1e-11
    )
    assert float(state.axial[-1]) == pytest.approx(out.y[0, -1], rel=1e-7)
    assert float(state.radial[-1]) == pytest.approx(out.y[4, -1], rel=1e-7)
    assert float(state.entanglements_left[-1]) == pytest.approx(out.y[9, -1], rel=1e-7)
    assert state.entanglements_left[-1] < 0.8


def test_maxwell_is_its_limit() -> None:
    t = np.linspace(0, 3, 60)
    state = disentangle(t, np.exp(0.75 * t), 1.0, 1e50, release=0.0, entanglement_release=0.0)
    tensor = conformation(t, np.exp(0.75 * t), 1.0)
    np.testing.assert_allclose(state.axial, tensor.axial, rtol=1e-7)
    np.testing.assert_allclose(state.radial, tensor.radial, rtol=1e-7)
    np.testing.assert_array_equal(state.entanglements_left, 1.0)


def test_a_flow_that_follows_a_rest_is_seen() -> None:
    """At rest nothing changes, and an integrator's steps grow: they once passed over all of the flow that came later."""
    t, flow = np.linspace(0, 10, 101), np.linspace(0, 0.5, 21)
    late = np.concatenate((t, 10 + flow[1:]))
    stretch = np.exp(np.concatenate((np.zeros(101), 8 * flow[1:])))
    rested = disentangle(late, stretch, 1.0, 0.05, segments=400.0)
    at_once = disentangle(flow, np.exp(8 * flow), 1.0, 0.05, segments=400.0)
    assert at_once.axial[-1] > 4
    np.testing.assert_allclose(
        rested.axial[-21:], at_once.axial, rtol=2e-3
    )  # the corner between two samples is rounded
    np.testing.assert_allclose(rested.entanglements_left[-1], at_once.entanglements_left[-1], rtol=2e-3)


def test_the_committed_campaign_of_entanglements() -> None:
    """Random histories of the whole box, reversals among them: nu in (0, 1] or refused, none wrong."""
    import json
    from pathlib import Path

    found = json.loads((Path(__file__).parents[1] / "benchmarks" / "entanglements_box.json").read_text())
    assert found["wrong"] == []
    assert found["histories"] >= 5000
    assert found["reversals"] > 0.5 * found["histories"]
    assert set(found["outcomes"]) <= {"answered", "answered, agrees with the equations as printed", "refused: time"}
    assert found["outcomes"].get("refused: time", 0) < 0.01 * found["histories"]


def test_entanglements_stay_within_0_and_1_whatever_the_flow() -> None:
    """Random histories, reversals of the flow among them; with the axial stretch in place of lam_c nu would pass 1."""
    rng = np.random.default_rng(3)
    axial_rule = 0.0
    for _ in range(40):
        t = np.linspace(0, 4, 81)
        rate = np.repeat(rng.uniform(-6, 6, 8), 10)
        stretch = np.exp(np.concatenate(([0.0], np.cumsum(rate * np.diff(t)))))
        state = disentangle(
            t,
            stretch,
            10 ** rng.uniform(-1, 1),
            10 ** rng.uniform(-4, 0),
            segments=10 ** rng.uniform(1, 4),
            release=rng.uniform(0, 1),
            entanglement_release=rng.uniform(0, 1),
            rtol=1e-7,
        )
        nu = state.entanglements_left
        assert (nu > 0).all()
        assert (nu <= 1).all()
        assert (state.axial + 2 * state.radial) @ np.ones(81) > 0
        growth = np.diff(np.log(state.stretch)) / np.diff(t)
        s = (state.axial - state.radial) / (state.axial + 2 * state.radial)
        axial_rule = min(axial_rule, float((rate * 0.5 * (s[1:] + s[:-1]) - growth).min()))
    assert axial_rule < -0.1  # what would drive it past 1


def test_more_entanglements_are_lost_in_a_faster_flow_and_with_a_larger_release() -> None:
    t = np.linspace(0, 1, 40)
    left = [
        float(
            disentangle(t, np.exp(rate * t), 1.0, 0.05, segments=400.0, entanglement_release=c).entanglements_left[-1]
        )
        for rate, c in ((1.0, 0.3), (4.0, 0.3), (4.0, 1.0))
    ]
    assert left[0] > left[1] > left[2]
    kept = disentangle(t, np.exp(4 * t), 1.0, 0.05, entanglement_release=0.0)
    assert kept.lost(1.5) is None
    state = disentangle(np.linspace(0, 3, 200), np.exp(4 * np.linspace(0, 3, 200)), 1.0, 0.05, entanglement_release=1.0)
    lost = state.lost(3.0)
    assert lost is not None
    assert state.entanglements_left[lost] * 3 < 1 <= state.entanglements_left[lost - 1] * 3
    stress = state.stress(100.0)[0]
    np.testing.assert_allclose(stress, 100 * state.entanglements_left * state.stiffening * (state.axial - 1))


def test_strands_that_have_joined() -> None:
    """V_S grows as nu^(-1/2): the fraction of the same contour."""
    phi, nu = 0.05, np.array([1.0, 0.5, 0.1])
    np.testing.assert_allclose(1 / strand_fraction(phi, nu), 1 / phi * nu**-0.5)
    np.testing.assert_allclose(strand_fraction(phi, nu, "good") ** -0.5, phi**-0.5 * nu**-0.5)
    assert float(rouse_time(0.3, 10.0)) == pytest.approx(0.01)


def test_never_beyond_the_contour() -> None:
    t = np.linspace(0, 2, 100)
    for loss in (0.0, 0.3):
        state = disentangle(t, np.exp(20 * t), 1.0, 0.2, segments=100.0, entanglement_release=loss)
        assert (state.axial + 2 * state.radial < 100 / state.entanglements_left).all()
        assert (state.stiffening >= 1 - 1e-9).all()


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"time": [0.0, 0.0]}, "time"),
        ({"time": [0.0, np.nan]}, "time"),
        ({"stretch_ratio": [1.0, -1.0]}, "stretch_ratio"),
        ({"disengagement_time": 0.0}, "relaxation_time"),
        ({"rouse_time": 0.0}, "rouse_time"),
        ({"rouse_time": np.inf}, "rouse_time"),
        ({"rouse_time": [0.1, 0.1, 0.1]}, "rouse_time"),
        ({"segments": 2.0}, "segments"),
        ({"release": 1.5}, "release"),
        ({"entanglement_release": -0.1}, "entanglement_release"),
        ({"rtol": 0.0}, "rtol"),
    ],
)
def test_refusals(change, field) -> None:
    arguments = {"time": [0.0, 1.0], "stretch_ratio": [1.0, 3.0], "disengagement_time": 1.0, "rouse_time": 0.1} | change
    with pytest.raises(InputError, match=field):
        disentangle(**arguments)
