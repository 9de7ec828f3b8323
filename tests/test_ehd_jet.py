"""The straight electrified jet: printed references, order and error of the scheme, folds, verdicts, asymptotes."""

from dataclasses import replace

import numpy as np
import pytest
from peo_needle import PEO as BENCH
from scipy.integrate import solve_bvp

from spinline.base.constants import EPS0
from spinline.base.errors import InputError
from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet
from spinline.jetprofile.ehd.asymptotes import (
    ElasticJet,
    InertialJet,
    ViscousJet,
    elastic_velocity_ratio,
    initial_jump,
    viscous_prefactor,
)
from spinline.jetprofile.ehd.boundary_value import halved, interpolate, newton, remesh, spline
from spinline.jetprofile.ehd.continuation import follow
from spinline.jetprofile.ehd.fields import UniformField
from spinline.jetprofile.ehd.solver import raise_pull, solve

PEO = BENCH | {"end": 0.02}
GLYCEROL = {
    "radius": 0.8e-3,
    "flow_rate": 1e-6 / 60,
    "voltage": 4e4,
    "gap": 0.08,
    "conductivity": 1e-6,
    "viscosity": 14.9e-4 * 1260,
    "surface_tension": 0.063,
    "density": 1260.0,
    "permittivity": 46.5,
    "law": "newtonian",
    "field": "uniform",
    "end": 0.06,
}


def jet(**settings) -> StraightEhdJet:
    length = settings.pop("length", None)
    made = NeedleSettings(**settings)
    return StraightEhdJet(made, length=made.end_position if length is None else length)


@pytest.fixture(scope="module")
def case_c() -> dict[str, StraightEhdJet]:
    return {log: jet(**PEO, log=log) for log in ("constant", "local")}


# section A: glycerol


@pytest.mark.parametrize(
    ("log", "radii", "tension", "potential"),
    [
        ("constant", (0.70573719, 0.08151155, 0.0360283219, 0.02626908, 0.0192209355), 23.0433636, 11021.54),
        ("local", (0.68227417, 0.07149277, 0.03344971, 0.02542549, 0.01898730), 27.1273770, 15192.27),
    ],
)
def test_glycerol_with_the_measured_current(log, radii, tension, potential) -> None:
    it = jet(**GLYCEROL, log=log, current=170e-9)
    s = np.array([0.1, 1, 5, 20, 75]) * 0.8e-3
    np.testing.assert_allclose(it.radius(s) / 0.8e-3, radii, rtol=1e-5)
    assert float(it.tension(0.0)) / it.settings.force_scale == pytest.approx(tension, rel=1e-5)
    assert it.needle_potential == pytest.approx(potential, rel=1e-5)
    assert it.solved.problem.charge
    if log == "constant":
        inside = it.field_inside(s[:4]) / (170e-9 / (np.pi * 0.8e-3**2 * 1e-6))
        np.testing.assert_allclose(inside, [1.981234, 82.860153, 8.841333, 6.284717], rtol=2e-5)
        beta = 0.5 * it.strain_rate(s[:4]) * s[:4] / it.velocity(s[:4])
        np.testing.assert_allclose(beta, [0.342293, 1.064268, 0.234771, 0.230133], rtol=2e-5)
        numbers = it.settings.numbers
        for name, value in (("reynolds", 4.451e-3), ("weber", 1.099e-3), ("peclet", 1.835e-4), ("slenderness", 75)):
            assert numbers[name] == pytest.approx(value, rel=5e-4)


def test_glycerol_with_its_own_current() -> None:
    it = jet(**GLYCEROL, log="constant")
    assert it.current == pytest.approx(37.9324e-9, rel=1e-5)
    assert float(it.tension(0.0)) / it.settings.force_scale == pytest.approx(0.73865, rel=1e-5)
    assert float(it.radius(20 * 0.8e-3)) / 0.8e-3 == pytest.approx(0.052380, rel=1e-5)
    free = jet(**{**GLYCEROL, "surface_tension": 0.063e-3, "gravity": 0.0}, log="constant")
    assert free.current == pytest.approx(30.2272e-9, rel=1e-5)
    assert float(free.tension(0.0)) / free.settings.force_scale == pytest.approx(1.79273, rel=1e-5)
    assert float(free.radius(20 * 0.8e-3)) / 0.8e-3 == pytest.approx(0.052784, rel=1e-5)
    assert free.needle_potential == 0


# section B: Feng's dimensionless set, given current


def feng(**law) -> dict[str, object]:
    """Re 2.5e-3, We 0.1, Fr 0.1, Pe 0.1, El 1, E_inf 0.7, beta_e 40, chi 75 as a bench in SI."""
    r, g, rho = 1e-3, 9.81, 1000.0
    v = np.sqrt(0.1 * g * r)
    k = 2 * EPS0 * v / (0.1 * r)
    e0 = np.sqrt(rho * v**2 / EPS0)
    de = law.pop("de", 0.0)
    return {
        "radius": r,
        "flow_rate": np.pi * r**2 * v,
        "voltage": 0.7 * e0 * 0.1,
        "gap": 0.1,
        "conductivity": k,
        "density": rho,
        "viscosity": rho * v * r / 2.5e-3,
        "surface_tension": rho * v**2 * r / 0.1,
        "permittivity": 41.0,
        "end": 75 * r,
        "field": "uniform",
        "log": "constant",
        "current": np.pi * r**2 * k * e0,
        "relaxation_time": de * r / v,
        **law,
    }


FENG = {
    "newtonian": ({"law": "newtonian"}, (0.91820808, 0.68554742, 0.36370545, 0.18667845), 0.52503896, 3.55990507),
    "oldroyd-b": (
        {"law": "oldroyd-b", "de": 1.0},
        (0.83527738, 0.63630821, 0.36579715, 0.20003386),
        0.5858059,
        3.6640010,
    ),
    "giesekus": (
        {"law": "giesekus", "de": 10.0, "mobility": 0.015},
        (0.40993639, 0.33106199, 0.29737172, 0.23185518),
        0.9949036,
        5.2749886,
    ),
    "fene-p": (
        {"law": "fene-p", "de": 10.0, "extensibility": 100.0},
        (0.40209214, 0.37725868, 0.34324904, 0.27008304),
        1.2120392,
        5.1605954,
    ),
}


@pytest.mark.parametrize("name", FENG)
def test_fengs_set(name) -> None:
    law, radii, tension, charge = FENG[name]
    settings = NeedleSettings(**feng(**law))
    it = StraightEhdJet(settings, length=settings.end_position, tolerance=1e-8)
    np.testing.assert_allclose(it.radius(np.array([1, 5, 20, 75]) * 1e-3) / 1e-3, radii, rtol=1e-6)
    assert float(it.tension(0.0)) / settings.force_scale == pytest.approx(tension, rel=1e-6)
    e0 = settings.current / settings.current_scale * settings.field_scale
    assert it.needle_potential / (e0 * 1e-3) / np.log(75) == pytest.approx(charge, rel=1e-6)


def test_fengs_set_by_scipys_collocation() -> None:
    """The same equations handed to another solver, from another guess."""
    settings = NeedleSettings(**feng(law="newtonian"))
    mine = StraightEhdJet(settings, length=settings.end_position, tolerance=1e-8)
    n = settings.numbers
    re, we, fr, pe, el, beta, chi = n["reynolds"], n["weber"], 1 / n["inverse_froude"], n["peclet"], 1.0, 40.0, 75.0

    def rate(s, y):  # u, T, q, Psi with i = 1, the tangential stress and pressure written out
        u, t, q, psi = y
        v, r = np.exp(u), np.exp(-u / 2)
        du = t / 3
        dq = 2 / beta * ((1 - q) / (pe * v) - psi / np.log(chi))
        e, sigma = q * v, (1 - q) * r / pe
        de, dr = v * (dq + q * du), -r * du / 2
        dsigma = ((1 - q) * dr - dq * r) / pe
        electric = sigma * dsigma * r**2 + beta * e * de * r**2 + 2 * sigma * e * r
        return np.array([du, re * (v * du - r**2 / fr - dr / we - el * electric), dq, 0.7 - e])

    def ends(a, b):
        return np.array([a[0], a[2] - 1, b[2] * np.exp(b[0]) - 0.7, b[1] / 3 - 1 / (2 * chi)])

    s = 75 * np.linspace(0, 1, 200) ** 2
    found = solve_bvp(
        rate,
        ends,
        s,
        np.array([2 * np.log1p(s / 5), 0.5 / (1 + s / 20), 1 / (1 + s / 5), 15 - s / 5]),
        tol=1e-8,
        max_nodes=20000,
    )
    assert found.success
    at = np.array([1, 5, 20, 75])
    np.testing.assert_allclose(np.exp(-found.sol(at)[0] / 2), mine.radius(at * 1e-3) / 1e-3, rtol=1e-7)


# section C: the PEO jet of Fig. 35


def test_peo_jet_with_the_constant_log(case_c) -> None:
    it = case_c["constant"]
    assert it.current == pytest.approx(251.1133e-9, rel=1e-6)
    assert float(it.tension(0.0)) == pytest.approx(4.368648e-5, rel=1e-6)
    z = np.array([0.1, 0.3, 1, 3, 5, 10]) * 1e-3
    radii = [0.43859147, 0.38407560, 0.28676655, 0.19158937, 0.15383552, 0.11234765]
    np.testing.assert_allclose(it.radius(z) / 125e-6, radii, rtol=1e-6)
    np.testing.assert_allclose(it.strain_rate(z), [146.532, 141.461, 137.819, 136.024, 135.813, 130.111], rtol=1e-5)
    np.testing.assert_allclose(it.tensile_stress(z), [6022.7, 7922.9, 14180.9, 30141.1, 43865.9, 67926.4], rtol=1e-5)
    share = [0.997080, 0.992995, 0.979758, 0.937958, 0.892121, 0.772601]
    np.testing.assert_allclose(it.conduction_share(z), share, rtol=2e-6)
    assert float(it.line_charge(5e-3)) == pytest.approx(3.540324e-8, rel=1e-6)
    assert float(it.residence_time(5e-3)) == pytest.approx(16.757e-3, rel=5e-5)
    assert float(it.position_of(22.5095)) == pytest.approx(2.3702e-3, rel=5e-5)
    a_zz, _ = it.conformation(5e-3)
    assert float(a_zz) == pytest.approx(128.1, abs=0.1)


def test_peo_jet_with_the_local_log(case_c) -> None:
    it = case_c["local"]
    assert it.current == pytest.approx(222.2837e-9, rel=1e-6)
    assert float(it.tension(0.0)) == pytest.approx(2.023782e-5, rel=1e-6)
    z = np.array([1, 3, 5]) * 1e-3
    np.testing.assert_allclose(it.radius(z) / 125e-6, [0.31255162, 0.19809042, 0.15735249], rtol=1e-6)
    np.testing.assert_allclose(it.tensile_stress(z), [7089.75, 17481.23, 26659.00], rtol=1e-6)


def test_peo_jet_over_the_whole_gap() -> None:
    settings = NeedleSettings(**{**PEO, "end": None})
    it = StraightEhdJet(settings)
    assert float(it.tension(0.0)) / settings.force_scale == pytest.approx(3.19, rel=1e-3)
    assert it.current == pytest.approx(208e-9, rel=1e-3)
    assert float(it.radius(1e-3)) / 125e-6 == pytest.approx(0.2821, rel=1e-3)
    assert it.end == 0.025


# the scheme


def test_order_of_the_scheme() -> None:
    settings = NeedleSettings(**PEO)
    problem = settings.problem(charge=False, predicted=True)
    path, _ = raise_pull(settings, charge=False, predicted=True)
    s = remesh(path.solution.s, path.solution.y, 101)
    last, values = path.solution, []
    for _ in range(5):
        last = newton(problem, s, interpolate(last.s, last.y, s), tol=1e-12)
        values.append(np.array([last.y[0, 3], last.y[0, 1], last.y[-1, 0]]))
        s = halved(s)
    change = np.abs(np.diff(values, axis=0))
    orders = np.log2(change[:-1] / change[1:])
    assert (orders[1:3] > 3.8).all()
    assert (orders[1:3] < 4.3).all()


def random_settings(rng, law) -> NeedleSettings:
    def between(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    radius, flow = between(8e-5, 5e-4), between(1e-10, 3e-9)
    de = between(0.1, 5)
    return NeedleSettings(
        radius=radius,
        flow_rate=flow,
        voltage=between(4e3, 2e4),
        gap=between(0.05, 0.2),
        conductivity=between(1e-4, 1),
        viscosity=between(0.2, 20),
        surface_tension=between(0.025, 0.073),
        density=between(800, 1300),
        permittivity=between(5, 80),
        relaxation_time=de * np.pi * radius**3 / flow,
        extensibility=between(100, 2000),
        law=law,
        end=0.02,
    )


@pytest.mark.slow
def test_estimated_error_is_the_true_one_within_a_factor_of_two() -> None:
    """But for one of these 25, 0.46 of the true error: between nodes beside the needle, where the order is not reached yet."""
    rng = np.random.default_rng(15)
    ratios = []
    for k in range(25):
        settings = random_settings(rng, ("fene-p", "newtonian")[k % 2])
        found = solve(settings, tolerance=1e-4)
        if found.why or not 1e-9 < found.error["radius"] < 1e-4:
            continue
        s = halved(halved(found.discrete.s))
        true = newton(found.problem, s, interpolate(found.discrete.s, found.discrete.y, s), tol=1e-12)
        own, places = found.discrete.s, np.linspace(0, found.discrete.s[-1], 2001)
        at = np.minimum(np.unique(np.concatenate((own, places, np.geomspace(1e-5, 1, 2001) * own[-1]))), own[-1])
        mine, best = (spline(found.problem, one)[0](at)[:, 0] for one in (found.discrete, true))  # between nodes too
        error = 0.5 * np.abs(mine - best).max()
        ratios.append(found.error["radius"] / error)
    assert len(ratios) >= 20
    assert 0.4 < min(ratios) < max(ratios) < 2
    assert sum(ratio < 0.5 for ratio in ratios) <= 1


# existence


def test_oldroyd_b_has_no_steady_jet_beyond_a_deborah_number_of_5765() -> None:
    base = NeedleSettings(**feng(law="oldroyd-b", de=1.0))
    start = solve(base).discrete
    s = remesh(start.s, start.y, 401)
    problem = base.problem(charge=True, predicted=False)
    first = newton(problem, s, interpolate(start.s, start.y, s))

    def at(t):
        return base.problem(charge=True, predicted=False, slack=10**t)

    path = follow(at, first)
    assert not path.arrived
    assert 10**path.fold == pytest.approx(5.765, rel=1e-3)


@pytest.mark.slow
def test_glycerol_has_no_steady_jet_below_23_6_nanoampere() -> None:
    base = NeedleSettings(**GLYCEROL, log="constant", current=30e-9)
    start = solve(base).discrete
    s = remesh(start.s, start.y, 801)
    problem = base.problem(charge=True, predicted=False)
    first = newton(problem, s, interpolate(start.s, start.y, s))

    def at(t):
        left = problem.left.copy()
        left[left[:, 0] == 3, 1] += t * np.log(2 / 3)
        return replace(problem, left=left)

    path = follow(at, first, largest=0.2)
    assert not path.arrived
    assert 30 * (2 / 3) ** path.fold == pytest.approx(23.585, rel=2e-3)
    with pytest.raises(NoSteadyJet):
        jet(**GLYCEROL, log="constant", current=20e-9)


@pytest.mark.slow
def test_the_lower_of_two_oldroyd_b_jets_and_the_fold_beyond_it() -> None:
    oldroyd = {**PEO, "law": "oldroyd-b", "log": "constant"}
    it = jet(**{**oldroyd, "relaxation_time": 15e-3})
    assert float(it.tension(0.0)) / it.settings.force_scale == pytest.approx(6.085, rel=1e-3)  # the other has 20.8
    with pytest.raises(NoSteadyJet) as caught:
        jet(**{**oldroyd, "relaxation_time": 18e-3})
    assert caught.value.reason == "fold"
    assert "0.01715 s" in str(caught.value)


def test_a_bad_conductor_swells() -> None:
    poor = {**PEO, "law": "newtonian", "voltage": 9e3, "log": "constant"}
    it = jet(**{**poor, "conductivity": 1e-8})
    assert float(it.tension(0.0)) / it.settings.force_scale == pytest.approx(0.697, rel=2e-3)
    assert float(it.radius(1e-3)) / 125e-6 == pytest.approx(0.709, rel=2e-3)
    with pytest.raises(NoSteadyJet) as caught:
        jet(**{**poor, "conductivity": 1e-9})
    assert caught.value.reason == "swells"


@pytest.mark.parametrize(("voltage", "held", "radius"), [(4e3, 0.072, 0.15), (3e3, 0.028, 0.61), (500.0, 0.009, 0.91)])
def test_held_threads_come_out_and_are_named(voltage, held, radius) -> None:
    it = jet(**{**PEO, "law": "newtonian", "voltage": voltage, "conductivity": 1e-6, "log": "constant"})
    verdict = {one.name: one for one in it.verdicts}["held"]
    assert verdict.value == pytest.approx(held, abs=6e-4)
    assert not verdict.good
    assert float(it.radius(5e-3)) / 125e-6 == pytest.approx(radius, abs=6e-3)


def test_verdicts_of_the_peo_jet(case_c) -> None:
    found = {one.name: one for one in case_c["constant"].verdicts}
    assert found["elastic"].value > 0.5
    assert found["held"].good
    assert found["cone"].value == pytest.approx(4.368648e-5 / (np.pi * 125e-6**2 * 1.8 / 7e-3), rel=1e-5)
    assert not found["conducted"].good  # 20 mm is short for its current
    assert found["needle_tension"].good


# where it ends


def test_bending_sets_in_with_its_spread(case_c) -> None:
    onset = case_c["constant"].bending
    assert onset.position == pytest.approx(7.44e-3, rel=0.01)
    assert onset.earliest == pytest.approx(6.71e-3, rel=0.01)
    assert onset.latest == pytest.approx(8.12e-3, rel=0.01)


# asymptotes


def test_elastic_law_with_the_computed_tension(case_c) -> None:
    it = case_c["constant"]
    z = np.linspace(0, 0.015, 3001)
    x = it.settings
    law = elastic_velocity_ratio(
        z,
        it.tension(z),
        radius=x.radius,
        modulus=x.modulus,
        relaxation_time=x.relaxation_time,
        initial_velocity=x.initial_velocity,
    )
    oldroyd = jet(**{**PEO, "law": "oldroyd-b", "log": "constant"})
    far = z > 0.5e-3
    law = elastic_velocity_ratio(
        z,
        oldroyd.tension(z),
        radius=x.radius,
        modulus=x.modulus,
        relaxation_time=x.relaxation_time,
        initial_velocity=x.initial_velocity,
    )
    assert np.abs(law / oldroyd.velocity_ratio(z) - 1)[far].max() < 0.075
    jump = float(initial_jump(oldroyd.tension(0.0), x.radius, x.modulus))
    closed = ElasticJet(radius=x.radius, flow_rate=x.flow_rate, relaxation_time=x.relaxation_time, jump=jump)
    near = (z > 1e-3) & (z < 5e-3)
    assert np.abs(closed.velocity_ratio(z) / oldroyd.velocity_ratio(z) - 1)[near].max() < 0.10


def test_viscous_law_is_exact_for_its_own_pull() -> None:
    it = ViscousJet(radius=1e-4, flow_rate=1e-9, current=1e-7, electric_field=5e4, viscosity=3.0)
    z, h = np.linspace(1e-4, 1e-2, 7), 1e-7

    def stress(z):  # 3 mu v'/v = the force over the cross-section per volume flow
        return 3 * it.viscosity * it.strain_rate(z) / it.velocity(z)

    slope = (stress(z + h) - stress(z - h)) / (2 * h)
    np.testing.assert_allclose(slope, -it.current * it.electric_field / (it.flow_rate * it.velocity(z)), rtol=1e-6)


def viscous(pull: float, conduction: float, chi: float, log: str = "constant") -> StraightEhdJet:
    """Uniform field, no capillarity, weight or inertia."""
    r, v, mu = 1e-4, 1e-5, 30.0
    field = np.sqrt(pull * mu * v / (EPS0 * r))
    settings = NeedleSettings(
        radius=r,
        flow_rate=np.pi * r**2 * v,
        voltage=field * chi * r,
        gap=chi * r,
        conductivity=conduction * EPS0 * v / r,
        viscosity=mu,
        surface_tension=1e-8,
        density=0.1,
        permittivity=2.0,
        law="newtonian",
        field="uniform",
        gravity=0.0,
        log=log,
    )
    return StraightEhdJet(settings, length=chi * r)


def prefactor(it: StraightEhdJet, pull: float, conduction: float) -> tuple[float, float]:
    """c_k and k from the current: k^2 = i A B / 6."""
    k = np.sqrt(it.current / it.settings.current_scale * pull * conduction / 6)
    return float(k / (pull ** (5 / 12) * conduction**0.25)), float(k)


@pytest.mark.slow
@pytest.mark.parametrize(("pull", "conduction"), [(1e-4, 1e3), (1e-2, 1e4), (1.0, 1e3), (1.0, 1e5)])
def test_prefactor_of_the_viscous_k(pull, conduction) -> None:
    """V -> (1 + k s)^2 with k = c_k A^(5/12) B^(1/4); c_k falls with the slenderness by (ln chi)^(-1/6)."""
    slender = viscous(pull, conduction, 1e4)
    c, _ = prefactor(slender, pull, conduction)
    assert 0.435 < c < 0.574
    if pull < 1e-3:
        return  # z_t is 70 radii there: 100 are too short
    short = viscous(pull, conduction, 100.0)
    here, k = prefactor(short, pull, conduction)
    assert here / c == pytest.approx((np.log(1e4) / np.log(100)) ** (1 / 6), rel=0.035)
    assert here > 1.08 * c
    for it, found in ((slender, c), (short, here)):
        x = it.settings
        low, high = viscous_prefactor(
            radius=x.radius,
            initial_velocity=x.initial_velocity,
            conductivity=x.conductivity,
            viscosity=x.viscosity,
            electric_field=x.field_scale,
            slenderness=x.numbers["slenderness"],
        )
        scale = pull ** (5 / 12) * conduction**0.25
        assert low / scale < found < high / scale
    z = np.linspace(0.0, 0.5, 2001) * short.end
    slope = np.gradient(np.sqrt(short.velocity_ratio(z)), z / x.radius)
    convected = short.conduction_share(z) < 0.3
    assert 0.7 < slope[convected].max() / k < 1.15  # beta = 1 where the charge has left the bulk


def test_inertial_law_far_away() -> None:
    it = jet(**GLYCEROL, log="constant", current=170e-9)
    law = InertialJet(radius=0.8e-3, flow_rate=1e-6 / 60, current=170e-9, density=1260.0, field=UniformField(4e4, 0.08))
    s = np.array([20, 75]) * 0.8e-3
    np.testing.assert_allclose(it.velocity_ratio(s) / law.velocity_ratio(s), [1.05422, 1.01684], rtol=2e-5)
    z = np.array([1e-4, 1e-2, 0.05])
    np.testing.assert_allclose(law.position_of(law.velocity_ratio(z)), z, rtol=1e-9)
    h = 1e-7
    time = (law.residence_time(z + h) - law.residence_time(z - h)) / (2 * h)
    np.testing.assert_allclose(time * law.velocity(z), 1.0, rtol=1e-5)


# as a jet


def test_it_is_consistent_with_itself(case_c) -> None:
    it = case_c["local"]
    z, h = np.linspace(1e-4, 0.019, 50), 1e-8
    slope = (it.velocity(z + h) - it.velocity(z - h)) / (2 * h)
    np.testing.assert_allclose(slope, it.strain_rate(z), rtol=1e-4)
    time = (it.residence_time(z + h) - it.residence_time(z - h)) / (2 * h)
    np.testing.assert_allclose(time * it.velocity(z), 1.0, rtol=1e-5)
    np.testing.assert_allclose(it.position_of(it.velocity_ratio(z)), z, rtol=1e-9)
    charge = it.line_charge(z) * it.velocity(z) + np.pi * it.radius(z) ** 2 * 0.01 * it.field_inside(z)
    np.testing.assert_allclose(charge, it.current, rtol=1e-6)
    assert np.isnan(it.position_of(1e6))


def test_a_neighbour_is_quick_and_the_same(case_c) -> None:
    near = case_c["local"].changed(voltage=6.2e3)
    alone = StraightEhdJet(NeedleSettings(**{**PEO, "voltage": 6.2e3}))
    assert near.current == pytest.approx(alone.current, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"voltage": 0.0}, "voltage"),
        ({"voltage": np.nan}, "voltage"),
        ({"law": "maxwell"}, "law"),
        ({"extensibility": None}, "extensibility"),
        ({"extensibility": 2.0}, "coil"),
        ({"end": 0.3}, "plate"),
        ({"solvent_share": 0.0}, "solvent"),
        ({"field": "point"}, "field"),
        ({"end": 1e-4}, "slender"),
        ({"permittivity": 0.5}, "permittivity"),
        ({"log": "global"}, "log"),
    ],
)
def test_what_cannot_be_is_refused(change, words) -> None:
    with pytest.raises(InputError, match=words):
        NeedleSettings(**{**PEO, **change})


def test_a_sample_of_the_campaign_of_random_settings_replays() -> None:
    import importlib.util
    import json
    from pathlib import Path

    folder = Path(__file__).parents[1] / "benchmarks"
    spec = importlib.util.spec_from_file_location("ehd_settings", folder / "ehd_settings.py")
    campaign = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(campaign)
    kept = json.loads((folder / "ehd_settings.json").read_text())
    assert kept["number"] == 532
    assert max(one["seconds"] for one in kept["rows"]) < 10
    # by three ways the same jet: where a second one passed the three tests (15, 144), its end made it (test_ehd_end_pull.py)
    assert kept["apart_by_more_than_1e-3"] == []
    assert kept["furthest_apart"] < 1e-4
    assert min(kept["reached_again"].values()) > 0
    rows = [one for one in kept["rows"] if one["seconds"] < 0.4][:6]
    assert len(rows) == 6
    rows.append(
        next(one for one in kept["rows"] if one["index"] == 348)
    )  # its error estimate left where rates are finite
    for one in rows:
        settings = campaign.drawn(one["index"])
        try:
            StraightEhdJet(settings, length=settings.end_position)
            verdict = "jet"
        except NoSteadyJet as refused:
            verdict = refused.reason
        assert verdict == one["verdict"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "time", "remedy"), [("fene-p", 1e6, "a shorter relaxation time"), ("oldroyd-b", 25e-3, 'law = "fene-p"')]
)
def test_the_remedy_at_a_fold_is_another_law_only_where_there_is_one(law, time, remedy) -> None:
    with pytest.raises(NoSteadyJet) as refused:
        StraightEhdJet(NeedleSettings(**{**PEO, "law": law, "relaxation_time": time}))
    assert refused.value.reason == "fold"
    assert remedy in refused.value.remedy
