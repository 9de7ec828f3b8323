"""Jets: reference values, derivatives, closed forms against quadrature and mpmath, extremes, refusals."""

from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile import Hyperbolic, Jet, LagrangianJet, PowerLaw, Table, fit_power_law
from spinline.jetprofile.k_estimate import printed_k

R0, Q = 125e-6, 3.2e-6 / 3600
PEO = PowerLaw(radius=R0, flow_rate=Q, k=1.0, beta=0.47)


def jets() -> list:
    hyperbola = Hyperbolic(radius=R0, flow_rate=Q, p=23.1)
    z = np.linspace(0, 1e-2, 201)
    return [
        PEO,
        PowerLaw(radius=R0, flow_rate=Q, k=0.48, beta=0.5),
        PowerLaw(radius=1e-9, flow_rate=1e-20, k=3.0, beta=1.0),
        hyperbola,
        Table(z=z, radius=hyperbola.radius(z), flow_rate=Q),
    ]


def test_reference_values_of_the_peo_jet() -> None:
    s = float(PEO.position_of(20.0)) / R0
    assert f"{s:.10f}" == "24.2144418829"
    assert f"{float(PEO.position_of(20.0)) * 1e3:.11f}" == "3.02680523536"
    assert f"{float(PEO.residence_time(5e-3)) * 1e3:.7f}" == "35.4048788"
    assert round(float(Hyperbolic(radius=R0, flow_rate=Q, p=23.1).velocity_ratio(40 * R0)), 2) == 7.46
    assert round(float(PEO.velocity_ratio(40 * R0)), 1) == 32.1
    k = printed_k(radius=R0, flow_rate=Q, conductivity=0.01, viscosity=2.0, electric_field=60e3)
    assert f"{float(k):.8f}" == "1.80625169"


def test_printed_k_is_the_gaussian_formula() -> None:
    r, v, mu = 125e-4, 100 * Q / (np.pi * R0**2), 20.0  # CGS
    sigma, field = 0.01 * 8.987551787e9, 60e3 / 29979.2458  # 1/s, statV/cm
    gaussian = r ** (2 / 3) * v ** (-2 / 3) * sigma**0.25 * mu ** (-5 / 12) * field ** (5 / 6)
    k = printed_k(radius=R0, flow_rate=Q, conductivity=0.01, viscosity=2.0, electric_field=60e3)
    assert float(k) == pytest.approx(gaussian, rel=1e-8)


def test_the_two_published_fits_meet_near_s_20_for_k_048() -> None:
    power = PowerLaw(radius=R0, flow_rate=Q, k=0.48, beta=0.47)
    hyperbola = Hyperbolic(radius=R0, flow_rate=Q, p=23.1)
    s = np.linspace(5, 40, 2000)
    gap = power.radius(s * R0) / hyperbola.radius(s * R0) - 1
    assert np.abs(gap[np.abs(s - 20) < 2]).max() < 0.06
    assert np.abs(gap).max() > 0.1


@pytest.mark.parametrize("jet", jets(), ids=lambda jet: type(jet).__name__)
def test_a_jet_is_consistent_with_itself(jet) -> None:
    assert isinstance(jet, Jet)
    r0, v0 = jet.initial_radius, jet.initial_velocity
    end = min(jet.end, 80 * r0)
    z = np.linspace(jet.start, end, 4001)
    v = jet.velocity(z)
    assert (np.diff(v) >= -1e-12 * v.max()).all()
    np.testing.assert_allclose(np.pi * jet.radius(z) ** 2 * v, jet.flow_rate, rtol=1e-13)
    np.testing.assert_allclose(jet.stretch_ratio(z), v / v0, rtol=1e-15)
    onset = getattr(jet, "onset", 0) * r0
    middle = 0.5 * (z[1:] + z[:-1])
    smooth = np.abs(middle - onset) > (z[1] - z[0])
    secant = np.diff(v) / np.diff(z)
    np.testing.assert_allclose(jet.strain_rate(middle)[smooth], secant[smooth], rtol=2e-2, atol=1e-6 * secant.max())
    time = jet.residence_time(z)
    for i in (1, 1000, 4000):
        knots = [*np.linspace(0, 1e-2, 201), onset] if isinstance(jet, Table) else [onset]
        edges = [jet.start, *sorted(p for p in knots if jet.start < p < z[i]), z[i]]
        exact = sum(quad(lambda x: 1 / float(jet.velocity(x)), a, b, epsrel=1e-12)[0] for a, b in pairwise(edges))
        assert float(time[i]) == pytest.approx(exact, rel=1e-9)
    ratios = np.geomspace(float(jet.velocity_ratio(z[1])) * 1.01, float(jet.velocity_ratio(end)), 50)
    np.testing.assert_allclose(jet.velocity_ratio(jet.position_of(ratios)), ratios, rtol=1e-9)
    assert np.isnan(jet.position_of(0.5))
    assert jet == eval(repr(jet))


def test_power_law_has_no_value_before_its_onset() -> None:
    jet = PowerLaw(radius=R0, flow_rate=Q, k=0.5, beta=0.5)
    assert jet.onset == pytest.approx(4.0)
    assert (jet.velocity_ratio([0.0, 1e-30, 3.999 * R0]) == 1).all()
    assert (jet.strain_rate([0.0, 3.999 * R0]) == 0).all()
    at = float(jet.strain_rate(jet.onset * R0))
    assert at == pytest.approx(2 * 0.5 / jet.onset * jet.initial_velocity / R0)
    assert float(jet.position_of(1.0)) == 0.0


@given(st.floats(0.25, 1.0), st.floats(1e-3, 1e3), st.floats(1e-3, 1e6))
def test_residence_time_against_fifty_digits(beta: float, k: float, s: float) -> None:
    jet = PowerLaw(radius=R0, flow_rate=Q, k=k, beta=beta)
    s0 = mp.mpf(jet.onset)
    if s <= jet.onset:
        exact = mp.mpf(s)
    else:
        a = 1 - 2 * mp.mpf(beta)
        log = mp.log(mp.mpf(s) / s0)
        exact = s0 + s0 * (mp.expm1(a * log) / a if a else log)
    got = mp.mpf(float(jet.residence_time(s * R0)) * jet.initial_velocity / R0)
    assert abs(got / exact - 1) < 1e-13 * max(1, abs(float((1 - 2 * beta) * np.log(s / jet.onset))) * 2)


@pytest.mark.parametrize("beta", [0.5 - 1e-12, 0.5, 0.5 + 1e-12])
def test_residence_time_near_the_logarithm(beta: float) -> None:
    jet = PowerLaw(radius=R0, flow_rate=Q, k=1.0, beta=beta)
    assert float(jet.residence_time(1e3 * R0)) * jet.initial_velocity / R0 == pytest.approx(1 + np.log(1e3), rel=1e-10)


def test_extremes() -> None:
    for radius in (1e-9, 1e-2):
        for beta in (0.25, 1.0):
            for k in (1e-20, 1e20):
                jet = PowerLaw(radius=radius, flow_rate=1e-12, k=k, beta=beta)
                z = np.array([0.0, 1e-300, 1e-12, 1.0, 1e6])
                for values in (jet.velocity_ratio(z), jet.radius(z), jet.strain_rate(z), jet.residence_time(z)):
                    assert np.isfinite(values).all()
    assert PEO.velocity_ratio(np.float32(5e-3)).dtype == np.float64
    assert PEO.velocity_ratio([]).shape == (0,)
    assert PEO.velocity_ratio(np.linspace(0, 1, 1_000_000)).shape == (1_000_000,)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"radius": 0.0}, "radius"),
        ({"radius": -1.0}, "radius"),
        ({"radius": np.nan}, "radius"),
        ({"radius": 1e-30}, "radius"),
        ({"flow_rate": np.inf}, "flow_rate"),
        ({"flow_rate": 0}, "flow_rate"),
        ({"k": 0}, "k"),
        ({"k": -1}, "k"),
        ({"k": 1e300}, "k"),
        ({"beta": 0.2}, "beta"),
        ({"beta": 1.01}, "beta"),
        ({"beta": np.nan}, "beta"),
        ({"radius": [1e-4, 2e-4]}, "radius"),
    ],
)
def test_refusals(change: dict, field: str) -> None:
    arguments = {"radius": R0, "flow_rate": Q, "k": 1.0, "beta": 0.47}
    with pytest.raises(InputError, match=field):
        PowerLaw(**(arguments | change))


@pytest.mark.parametrize("z", [-1e-9, np.nan, np.inf, "x", [0.0, np.nan]])
def test_positions_out_of_range_are_refused(z) -> None:
    with pytest.raises(InputError, match="z"):
        PEO.velocity_ratio(z)


# ---- tables


def test_table_order_of_convergence_and_bound() -> None:
    exact = Hyperbolic(radius=R0, flow_rate=Q, p=23.1)
    errors = []
    for n in (21, 41, 81, 161):
        z = np.linspace(0, 1e-2, n)
        table = Table(z=z, radius=exact.radius(z), flow_rate=Q)
        fine = np.linspace(0, 1e-2, 5003)
        errors.append(np.abs(table.velocity_ratio(fine) / exact.velocity_ratio(fine) - 1).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.9).all(), orders


@given(st.lists(st.floats(0.01, 100), min_size=2, max_size=12), st.lists(st.floats(0, 10), min_size=12, max_size=12))
def test_table_never_overshoots_and_its_strain_rate_is_bounded(steps: list[float], rises: list[float]) -> None:
    z = np.concatenate(([0.0], np.cumsum(steps))) * 1e-4
    v = 0.01 * (1 + np.concatenate(([0.0], np.cumsum(rises[: len(steps)]))))
    table = Table(z=z, velocity=v, flow_rate=Q)
    for i in range(len(steps)):
        inside = np.linspace(z[i], z[i + 1], 33)
        got = table.velocity(inside)
        assert (np.diff(got) >= -1e-12 * got.max()).all()
        assert got.min() >= v[i] * (1 - 1e-12)
        assert got.max() <= v[i + 1] * (1 + 1e-12)
        secant = (v[i + 1] - v[i]) / (z[i + 1] - z[i])
        # of the differences of two velocities and of two places
        rounding = 20 * np.finfo(float).eps * (v.max() + secant * z[-1]) / (z[i + 1] - z[i])
        assert table.strain_rate(inside[1:-1]).max() <= 1.5 * secant + rounding


def test_table_from_csv_and_its_refusals(tmp_path) -> None:
    file = tmp_path / "jet.csv"
    file.write_text("# measured\nz [mm], radius (um)\n0, 125\n1, 50\n2, 35\n")
    table = Table.from_csv(file, flow_rate=Q)
    assert float(table.radius(1e-3)) == pytest.approx(50e-6)
    assert table.end == pytest.approx(2e-3)
    with pytest.raises(InputError, match="z"):
        table.radius(3e-3)
    for text, words in {
        "z, radius\n0,1\n1,1\n": "unit",
        "z [mm], radius [s]\n0,1\n1,1\n": "not a length",
        "z [mm], radius [um]\n0,1\n": "two samples",
        "z [mm], radius [um]\n0,50\n1,60\n": "monotone",
        "z [mm], radius [um]\n1,50\n0,40\n2,30\n": "increase",
        "z [mm], radius [um]\n0,50\n1,x\n": "text",
        "z [mm], radius [um]\n0,50\n1,\n": "finite",
        "z [mm], radius [um]\n0,50\n1,-3\n": "range",
        "z [mm], velocity [m/s], radius [um]\n0,1,50\n1,2,40\n": "one of",
        "z [mm]\n0\n1\n": "no column radius or velocity",
        "z [mm], breadth [um]\n0,50\n1,40\n": "z, breadth.*no column radius or velocity",
        "": "CSV",
        "\x00\x01\x02": "not",
    }.items():
        file.write_text(text)
        with pytest.raises(InputError, match=words):
            Table.from_csv(file, flow_rate=Q)
    file.write_bytes(b"\xff\xfe\x00z\x00")
    with pytest.raises(InputError, match="CSV"):
        Table.from_csv(file, flow_rate=Q)
    with pytest.raises(InputError, match="cannot be read"):
        Table.from_csv(tmp_path / "none.csv", flow_rate=Q)


# ---- fit


def test_fit_recovers_exact_power_laws() -> None:
    z = np.geomspace(1e-3, 1e-2, 100)
    for k, beta in ((1.0, 0.47), (0.161, 0.591), (2.0, 0.25), (1.0, 1.0)):
        fit = fit_power_law(z, R0 / k * (z / R0) ** -beta, initial_radius=R0)
        assert (fit.k, fit.beta) == (pytest.approx(k, rel=1e-10), pytest.approx(beta, rel=1e-10))
        assert fit.message == ""


@pytest.mark.slow
def test_fit_covariance_covers() -> None:
    """68 % and 95 % intervals of k and beta over 400 noisy profiles of 60 samples; jets known to be power laws."""
    rng = np.random.default_rng(3)
    z = np.geomspace(1e-3, 1e-2, 60)
    r = R0 / 1.2 * (z / R0) ** -0.47
    for known in (True, False):
        scores = []
        for _ in range(400):
            noisy = r * np.exp(0.01 * rng.standard_normal(60))
            fit = fit_power_law(
                z,
                noisy,
                0.01 * r if known else None,
                initial_radius=R0,
                z_range=(1e-3 * 0.999, 1.001e-2),
                tolerance=1e-6,
            )
            scores.append([(fit.k - 1.2) / fit.k_std, (fit.beta - 0.47) / fit.beta_std])
        inside = np.abs(scores)
        assert (np.abs((inside < 1).mean(0) - 0.683) < 0.07).all()
        assert (np.abs((inside < 1.96).mean(0) - 0.95) < 0.033).all()


def test_fit_says_where_a_power_law_stops() -> None:
    z = np.geomspace(1e-4, 3e-2, 300)
    r = R0 * (z / R0) ** -0.5
    r = np.where(z < 2e-3, r * (1 + 0.3 * np.log(2e-3 / z)), r)  # leaves it towards the nozzle
    with pytest.warns(SpinlineWarning, match="holds between"):
        fit = fit_power_law(z, r, initial_radius=R0)
    assert 1.2e-3 < fit.z_min < 2.5e-3
    assert fit.z_max == pytest.approx(3e-2)
    assert fit.beta == pytest.approx(0.5, abs=0.02)
    assert fit.departure_outside > 0.3
    with pytest.warns(SpinlineWarning, match="no power law"):
        fit_power_law(np.linspace(1e-3, 1e-2, 30), 1e-4 * (1 + 0.5 * np.sin(np.linspace(0, 20, 30))))
    with pytest.warns(SpinlineWarning, match="holds between"):
        part = fit_power_law(z, r, initial_radius=R0, z_range=(1e-4, 5e-3))
    assert part.z_max <= 5e-3
    assert fit_power_law(z, r, initial_radius=R0, z_range=(2.1e-3, 2e-2)).message == ""


def test_fit_extremes_and_refusals() -> None:
    z = np.geomspace(1e-3, 1e-2, 6)
    assert fit_power_law(z, 1e-4 * (z / 1e-3) ** -0.5).samples == 6
    big = np.geomspace(1e-3, 1e-2, 1_000_000)
    fit = fit_power_law(big, 1e-4 * (big / 1e-4) ** -0.5, initial_radius=1e-4)
    assert (fit.samples, fit.beta) == (1_000_000, pytest.approx(0.5, rel=1e-9))
    with_nozzle = np.concatenate(([0.0], z))
    assert fit_power_law(with_nozzle, np.concatenate(([1e-4], 1e-4 * (z / 1e-3) ** -0.5))).samples_given == 6
    for arguments, words in (
        ((z[:4], z[:4]), "fewer than"),
        ((z, -z), "range"),
        ((z, z[:3]), "one value"),
        ((z, np.full(6, np.nan)), "finite"),
        ((np.full(6, 1e-3), z), "one place"),
        ((z, z, np.zeros(6)), "radius_std"),
        (([], []), "fewer than"),
    ):
        with pytest.raises(InputError, match=words):
            fit_power_law(*arguments)
    with pytest.raises(InputError, match="in the range"):
        fit_power_law(z, 1e-4 * (z / 1e-3) ** -0.5, z_range=(1.0, 2.0))


# ---- bead jets


def spiral(n: int = 400) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    u = np.linspace(0, 1, n) ** 1.5
    return 0.1 * u, 0.02 * u * np.cos(30 * u), 0.02 * u * np.sin(30 * u)


def test_beads_of_a_straight_jet_are_that_jet() -> None:
    z = np.linspace(0, 5e-3, 5001)
    middle = 0.5 * (z[1:] + z[:-1])
    beads = LagrangianJet.from_arrays(z, initial_radius=R0, radius=PEO.radius(middle), velocity=PEO.velocity(z))
    np.testing.assert_allclose(beads.arc_length, middle, rtol=1e-12)
    np.testing.assert_allclose(beads.stretch_ratio(3e-3), PEO.velocity_ratio(3e-3), rtol=1e-6)
    np.testing.assert_allclose(beads.radius(3e-3), PEO.radius(3e-3), rtol=1e-6)
    np.testing.assert_allclose(beads.strain_rate(3e-3), PEO.strain_rate(3e-3), rtol=1e-4)
    assert float(beads.position_of(20.0)) == pytest.approx(float(PEO.position_of(20.0)), rel=1e-6)
    assert np.isnan(beads.position_of(1e6))


def test_volume_radius_and_stretch_say_the_same_of_a_bent_jet() -> None:
    x, y, z = spiral()
    length = np.sqrt(np.diff(x) ** 2 + np.diff(y) ** 2 + np.diff(z) ** 2)
    volume = np.full(length.shape, np.pi * R0**2 * length[0])
    a = LagrangianJet.from_arrays(x, y, z, initial_radius=R0, volume=volume)
    b = LagrangianJet.from_arrays(x, y, z, initial_radius=R0, stretch_ratio=length / length[0])
    c = LagrangianJet.from_arrays(x, y, z, initial_radius=R0, radius=a.element_radius)
    for other in (b, c):
        np.testing.assert_allclose(other.stretch, a.stretch, rtol=1e-12)
        np.testing.assert_allclose(other.element_radius, a.element_radius, rtol=1e-12)
    assert a.arc_length[-1] + length[-1] / 2 == pytest.approx(length.sum())


def test_rigid_rotation_strains_nothing_and_stretching_does() -> None:
    x, y, z = spiral()
    omega = np.array([3.0, -5.0, 7.0])
    position = np.stack([x, y, z], axis=-1)
    turning = np.cross(omega, position)
    growing = turning + 2.5 * position
    one = {"initial_radius": R0, "stretch_ratio": np.ones(x.size - 1)}
    rate = LagrangianJet.from_arrays(x, y, z, velocity=turning, **one).element_strain_rate
    assert np.abs(rate).max() < 1e-9
    rate = LagrangianJet.from_arrays(x, y, z, velocity=growing, **one).element_strain_rate
    np.testing.assert_allclose(rate, 2.5, rtol=1e-9)


def test_times_and_padding() -> None:
    x = np.array([[0, 1, 2, np.nan], [0, 1, 3, 6.0]]) * 1e-3
    stretch = np.array([[1, 1, np.nan], [1, 2, 3.0]])
    jet = LagrangianJet.from_arrays(x, initial_radius=R0, stretch_ratio=stretch, time=[0.0, 1.0])
    assert jet.at().usable.all()
    assert jet.at(0.2).usable.tolist() == [True, True, False]
    assert jet.at(0.0).radius(1e-3).shape == ()
    with pytest.raises(InputError, match="many times"):
        jet.radius(1e-3)
    with pytest.raises(InputError, match="time"):
        jet.at(2.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"x": [0.0]}, "two beads"),
        ({"x": []}, "two beads"),
        ({"x": [0.0, np.nan, 1.0]}, "gaps"),
        ({"x": [0.0, 0.0, 1.0]}, "one place"),
        ({"x": [0.0, 1.0, np.inf]}, "finite"),
        ({"x": [0.0, 1.0, 2.0], "y": [0.0, 1.0]}, "shape"),
        ({"x": [0.0, 1.0, 2.0], "radius": [1.0, 1.0]}, "one of"),
        ({"x": [0.0, 1.0, 2.0], "stretch_ratio": [1.0, -1.0]}, "range"),
        ({"x": [0.0, 1.0, 2.0], "stretch_ratio": [1.0, np.nan]}, "finite"),
        ({"x": [0.0, 1.0, 2.0], "stretch_ratio": [1.0]}, "per element"),
        ({"x": [0.0, 1.0, 2.0], "time": [1.0]}, "time"),
        ({"x": [[0.0, 1.0, 2.0]]}, "time"),
        ({"x": [0.0, 1.0, 2.0], "velocity": [1.0]}, "velocity"),
    ],
)
def test_bead_refusals(arguments: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        LagrangianJet.from_arrays(**({"initial_radius": R0, "stretch_ratio": [1.0, 1.0]} | arguments))


def test_beads_from_csv(tmp_path) -> None:
    file = tmp_path / "beads.csv"
    file.write_text(
        "time [ms],x [mm],y [mm],radius [um]\n0,0,0,100\n0,1,0,50\n0,2,0,\n1,0,0,100\n1,1,1,40\n1,2,2,30\n1,3,3,\n"
    )
    jet = LagrangianJet.from_csv(file)
    assert jet.x.shape == (2, 4)
    assert jet.initial_radius == pytest.approx(1e-4)
    np.testing.assert_allclose(jet.at().stretch, [1, 6.25, 100 / 9])
    np.testing.assert_allclose(jet.at(0.0).stretch[:2], [1, 4])
    file.write_text("x [mm],stretch_ratio\n0,1\n1,2\n2,\n")
    assert LagrangianJet.from_csv(file, initial_radius=1e-4).stretch.tolist() == [1, 2]
    with pytest.raises(InputError, match="initial_radius"):
        LagrangianJet.from_csv(file)


def test_a_crossover_before_the_middle_of_the_first_element() -> None:
    jet = LagrangianJet.from_arrays([0.0, 0.2, 0.5], initial_radius=1e-4, stretch_ratio=[np.e**2, np.e**3])
    assert float(jet.position_of(np.e)) == pytest.approx(0.05)  # halfway, in logarithms, to the first middle at 0.1
    assert float(jet.radius(0.05)) == pytest.approx(1e-4 * np.e**-0.5)
    assert float(jet.position_of(1.0)) == 0.0
