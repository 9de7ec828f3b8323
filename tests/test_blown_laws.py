"""Straight blown jets with a solvent's viscosity: against a solver of its own, their limits, and the campaign over the range."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_bvp

import spinline.jetprofile.blown as blown
from spinline.base.errors import InputError

MM = 1e-3
PAN = blown.BlownSolution(1e-6 / 3600, 100e-6, 970.0, 3.0, 0.036)
AIR = blown.AirJet(MM, 200.0)
KEPT = Path(__file__).parents[1] / "benchmarks" / "blown_straight.json"


def plain(solution, air, jet):
    """The same jet by scipy, from the equations for A as they stand in the books, on a mesh of its own."""
    s, law = solution, solution.extensibility
    q, g = s.flow_rate, s.modulus

    def rates(z, y):
        v, force, azz, arr = y
        f = q / v
        a = np.sqrt(f / np.pi)
        h = (law - 3) / (law - azz - 2 * arr) if law else 1.0
        rate = (force - np.pi * a * s.surface_tension - f * g * h * (azz - arr)) / (3 * s.solvent_viscosity * f)
        slip = air.velocity(z) - v
        drag = blown.tangential_drag(slip, a, air.density, air.kinematic_viscosity)
        theta = s.relaxation_time
        return np.stack(
            [
                rate,
                s.density * q * rate - s.density * 9.81 * f - drag,
                (2 * rate * azz - (h * azz - 1) / theta) / v,
                (-rate * arr - (h * arr - 1) / theta) / v,
            ]
        )

    def scaled(z, y):
        return rates(z, y * size[:, None]) / size[:, None]

    size = np.array([1.0, 1e-6, 1.0, 1.0])

    def ends(first, last):
        v = last[0]
        return np.array(
            [
                first[0] / s.velocity - 1,
                first[2] - 1,
                first[3] - 1,
                last[1] - np.sqrt(np.pi * q / v) * s.surface_tension / 1e-6,
            ]
        )

    guess = np.stack([jet.velocity, jet.tension / 1e-6, jet.axial_conformation, jet.radial_conformation])
    rng = np.random.default_rng(1)
    z = np.unique(np.concatenate([jet.z, np.linspace(0, jet.z[-1], 301)]))
    start = np.stack([np.interp(z, jet.z, row) for row in guess]) * (1 + 0.005 * rng.standard_normal(z.size))
    with np.errstate(invalid="ignore"):  # its Newton steps may leave the range
        found = solve_bvp(scaled, ends, z, start, tol=1e-6, max_nodes=40_000)
    assert found.status == 0
    return found.sol


@pytest.mark.parametrize(("theta", "limit"), [(5e-3, 0.0), (1e-4, 60.0)])
def test_against_scipys_solver(theta, limit):
    solution = replace(PAN, relaxation_time=theta, solvent_viscosity=0.9, extensibility=limit)
    jet = blown.straight_blown_jet(solution, AIR, 10 * MM)
    assert jet.verdict == "converged"
    assert jet.force_balance < 1e-8
    other = plain(solution, AIR, jet)(jet.z)
    inside = jet.z > 1e-5
    np.testing.assert_allclose(jet.velocity[inside], other[0][inside], rtol=2e-5)
    np.testing.assert_allclose(jet.axial_conformation[inside], other[2][inside], rtol=2e-4)


def test_a_long_strand_is_oldroyds_and_a_short_one_is_drawn_no_further():
    base = replace(PAN, relaxation_time=5e-3, solvent_viscosity=0.3)
    endless = blown.straight_blown_jet(base, AIR, 10 * MM)
    errors = []
    for limit in (1e6, 1e7):
        jet = blown.straight_blown_jet(replace(base, extensibility=limit), AIR, 10 * MM)
        errors.append(abs(jet.at(5 * MM)["velocity"] / endless.at(5 * MM)["velocity"] - 1))
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.1)  # first order in 1/L^2
    short = blown.straight_blown_jet(replace(base, extensibility=50.0), AIR, 10 * MM)
    assert short.axial_conformation.max() < 50
    assert short.velocity.max() > 10 * endless.velocity.max()  # the bound v0 + z/theta holds no more


@pytest.mark.slow
def test_little_relaxation_is_newtons():
    newton = blown.straight_blown_jet(PAN, AIR, 10 * MM)
    fast = blown.straight_blown_jet(
        replace(PAN, relaxation_time=1e-8, solvent_viscosity=0.3), AIR, 10 * MM, law="oldroyd-b"
    )
    assert fast.at(5 * MM)["velocity"] == pytest.approx(newton.at(5 * MM)["velocity"], rel=1e-3)
    assert fast.tension[0] == pytest.approx(newton.tension[0], rel=1e-3)


def test_a_jet_that_outruns_its_waves_is_critical_without_solvent_and_smooth_with():
    """theta 1e-5 s, 200 m/s: from 3.1 mm on; with ever less solvent the profile tends to one with that place in it."""
    fast = replace(PAN, relaxation_time=1e-5)
    jet = blown.straight_blown_jet(fast, AIR, 10 * MM)
    assert jet.verdict == "critical"
    assert "from 3.0" in jet.message
    assert not jet.z.size
    at = []
    for share in (0.03, 0.01, 0.003):
        one = blown.straight_blown_jet(replace(fast, solvent_viscosity=3 * share), AIR, 10 * MM)
        assert one.verdict == "converged"
        at.append(one.at(5 * MM)["velocity"])
    steps = np.diff(at)
    assert steps[0] / steps[1] == pytest.approx(20 / 7, rel=0.15)  # in proportion to the solvent


def test_every_jet_of_the_campaign_has_a_profile_that_closes_or_a_verdict():
    rows = json.loads(KEPT.read_text())
    assert {row["speed_m_s"] for row in rows} >= {50.0, 400.0}
    assert {row["law"] for row in rows} >= {"newton", "oldroyd-b", "fene-p"}
    for row in rows:
        if row["verdict"] in ("converged", "compressed"):
            assert row["balance"] < 1e-6
        else:
            assert row["verdict"] in ("critical", "slack")
            assert row["message"]
    solved = {
        law: [r["verdict"] in ("converged", "compressed") for r in rows if r["law"] == law]
        for law in ("newton", "oldroyd-b")
    }
    assert all(solved["newton"])
    assert all(solved["oldroyd-b"])
    row = rows[[r["law"] for r in rows].index("fene-p") + 3]  # done again, once
    solution = replace(PAN, relaxation_time=row["theta_s"], solvent_viscosity=0.3, extensibility=500.0)
    jet = blown.straight_blown_jet(solution, blown.AirJet(MM, row["speed_m_s"]), 10 * MM)
    assert jet.tension[0] * 1e6 == pytest.approx(row["force_uN"], rel=1e-6)


@pytest.mark.parametrize(
    ("change", "law", "field"),
    [
        ({"extensibility": 2.0}, None, "extensibility"),
        ({"extensibility": np.nan}, None, "extensibility"),
        ({"relaxation_time": 1e-3, "solvent_viscosity": 0.3}, "fene-p", "extensibility"),
        ({"relaxation_time": 1e-3, "extensibility": 50.0}, "fene-p", "solvent_viscosity"),
    ],
)
def test_refusals_of_the_laws(change, law, field):
    with pytest.raises(InputError) as error:
        blown.straight_blown_jet(replace(PAN, **change), AIR, MM, law=law)
    assert error.value.field == field
