"""Evaporation: closed forms, conservation, vapour properties, where drying ends, refusals."""

import time
import warnings

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile import Hyperbolic, LagrangianJet, PowerLaw, Table
from spinline.rheology import vapour
from spinline.rheology.element_path import bead_path, straight_path
from spinline.rheology.evaporation import evaporate, power_law_loss, sherwood
from spinline.rheology.volatile import Volatile

pytestmark = pytest.mark.filterwarnings("ignore::spinline.base.errors.SpinlineWarning")
R0, Q, D, NU, C = 125e-6, 3.2e-6 / 3600, 2.5e-5, 1.5e-5, 1.73e-5
JET = PowerLaw(radius=R0, flow_rate=Q, k=1.0, beta=0.47)
WATER = Volatile("water", C, D, ambient=0.4)
PHI = 0.0444


def rate(jet: PowerLaw, volatile: Volatile = WATER) -> float:
    first = 0.495 * np.cbrt(2 * jet.initial_radius * jet.initial_velocity / NU) * np.sqrt(NU / volatile.diffusivity)
    drop = volatile.saturation * (1 - volatile.ambient)
    return float(np.pi * volatile.diffusivity * first * drop * jet.initial_radius / jet.flow_rate)


@pytest.mark.parametrize("kept", ["velocity", "radius"])
def test_closed_form_to_1e_9(kept) -> None:
    z = np.linspace(1e-4, 0.01, 30)
    jet = evaporate(straight_path(JET, z, kept), PHI, [WATER], air_viscosity=NU, activity="unit")
    np.testing.assert_allclose(jet.lost, power_law_loss(z / R0, 1.0, 0.47, rate(JET), kept), rtol=1e-9)
    if kept == "velocity":
        assert 100 * jet.lost[-1] == pytest.approx(0.405433374, abs=5e-10)


def test_closed_form_under_strong_drying_and_with_every_solver() -> None:
    fast = Volatile("x", 2e-3, D)
    z = np.linspace(1e-4, 4e-3, 9)
    expected = power_law_loss(z / R0, 1.0, 0.47, rate(JET, fast))
    assert 0.2 < expected[-1] < 0.9
    separable = evaporate(straight_path(JET, z), PHI, [fast], air_viscosity=NU, activity="unit")
    np.testing.assert_allclose(separable.lost, expected, rtol=1e-9)
    general = evaporate(straight_path(JET, z), PHI, [fast], air_viscosity=NU, activity="unit", sherwood_floor=1e-9)
    np.testing.assert_allclose(general.lost, expected, rtol=1e-7)
    tiny = Volatile("x", 1e-14, D)
    slow = evaporate(straight_path(JET, z), PHI, [tiny], air_viscosity=NU, activity="unit")
    np.testing.assert_allclose(slow.lost, power_law_loss(z / R0, 1.0, 0.47, rate(JET, tiny)), rtol=1e-9)


def test_unit_activity_stops_when_the_solvent_is_gone() -> None:
    z = np.linspace(0, 0.05, 50)
    jet = evaporate(straight_path(JET, z), 0.1, [Volatile("x", 2e-3, D)], air_viscosity=NU, activity="unit")
    closed = power_law_loss(z / R0, 1.0, 0.47, rate(JET, Volatile("x", 2e-3, D)))
    wet = closed < 0.9 - 1e-6
    np.testing.assert_allclose(jet.lost[wet], closed[wet], rtol=1e-8)
    assert (jet.polymer_fraction[~wet] == 1.0).all()
    assert np.isnan(closed[-1])


def test_library_properties_and_the_other_convention() -> None:
    z = np.array([1e-9, 0.01])
    nu = vapour.air_kinematic_viscosity(293.15)
    mass = Volatile.build("water", 293.15, ambient=0.4)
    mole = Volatile.build("water", 293.15, ambient=0.4, convention="yarin2001")
    assert mass.saturation == pytest.approx(C, rel=2e-3)
    assert mole.saturation == pytest.approx(0.023, rel=0.01)
    slow, fast = (evaporate(straight_path(JET, z), PHI, [v], air_viscosity=nu) for v in (mass, mole))
    assert 0.36 < 100 * slow.lost[-1] < 0.45
    assert fast.polymer_fraction[-1] == pytest.approx(vapour.equilibrium_fraction(0.4), rel=1e-10)
    density = 0.01801528 / mass.molar_volume
    ratio = density * vapour.GAS_CONSTANT * 293.15 / (101325 * 0.01801528)
    assert 1300 < ratio < 1400
    assert fast.lost[0] / slow.lost[0] == pytest.approx(ratio, rel=1e-6)


def test_polymer_is_conserved_and_drying_is_monotone() -> None:
    z = np.linspace(1e-4, 0.05, 60)
    for volatile in (Volatile("x", 1e-3, D, 0.4, 0.45), Volatile("x", 2e-2, D), Volatile("x", 1e-6, D)):
        for kept in ("velocity", "radius"):
            jet = evaporate(straight_path(JET, z, kept), PHI, [volatile], air_viscosity=NU)
            flux = np.pi * jet.radius**2 * jet.velocity * jet.polymer_fraction
            np.testing.assert_allclose(flux, PHI * Q, rtol=1e-12)
            assert (np.diff(jet.polymer_fraction) >= -1e-13).all()
            assert (jet.solvent_volume >= 0).all()
            np.testing.assert_allclose(jet.lost + jet.remaining, 1.0, rtol=1e-14)


def test_given_is_what_is_kept() -> None:
    z = np.array([0.005, 0.02])
    x = [Volatile("x", 1e-3, D)]
    bubble = Hyperbolic(radius=R0, flow_rate=Q, p=23.1)
    measured = evaporate(straight_path(bubble, z), PHI, x, air_viscosity=NU)
    np.testing.assert_allclose(measured.radius, bubble.radius(z), rtol=1e-14)
    computed = evaporate(straight_path(JET, z), PHI, x, air_viscosity=NU)
    np.testing.assert_allclose(computed.velocity, JET.velocity(z), rtol=1e-14)
    assert computed.radius[1] < JET.radius(z)[1]
    table = {"z": [0.0, 0.02], "flow_rate": Q}
    assert straight_path(Table(radius=[R0, R0 / 4], **table), z).given == "radius"
    assert straight_path(Table(velocity=[0.02, 0.2], **table), z).given == "velocity"


def test_a_table_of_the_power_law_approaches_it() -> None:
    at = np.array([0.01])
    x = [Volatile("x", 1e-3, D)]
    exact = float(evaporate(straight_path(JET, at), PHI, x, air_viscosity=NU).lost[0])
    errors = []
    for n in (41, 81, 161, 321):
        nodes = np.linspace(1e-3, 0.01, n)
        table = Table(z=nodes, velocity=JET.velocity(nodes), flow_rate=Q)
        start = float(evaporate(straight_path(JET, nodes[:1]), PHI, x, air_viscosity=NU).lost[0])
        later = evaporate(straight_path(table, at), PHI / (1 - start), x, air_viscosity=NU)
        # the table's own r_0 is that of its first sample, undried; Re sees it, hence compare with the power law shifted
        errors.append(float(later.lost[0]))
    steps = np.abs(np.diff(errors))
    assert np.log2(steps[0] / steps[1]) > 1.8
    assert 0 < errors[-1] < 1.2 * exact


def beads(n: int) -> LagrangianJet:
    x = np.linspace(0, 0.01, n + 1)
    middle = 0.5 * (x[1:] + x[:-1])
    return LagrangianJet.from_arrays(
        x, initial_radius=R0, stretch_ratio=JET.stretch_ratio(middle), velocity=JET.velocity(x)
    )


def test_bead_jets_meet_the_straight_jet() -> None:
    x = [Volatile("x", 2e-4, D)]
    for how in ({"flow_rate": Q}, {}):
        errors = []
        for n in (400, 800, 1600):
            jet = beads(n)
            path = bead_path(jet, **how)
            exact = evaporate(straight_path(JET, path.position), PHI, x, air_viscosity=NU).lost
            errors.append(abs(evaporate(path, PHI, x, air_viscosity=NU).lost[-1] / exact[-1] - 1))
        assert errors[-1] < 5e-6
        assert np.log2(errors[0] / errors[2]) / 2 > 1.9
    jet = beads(400)
    ages = JET.residence_time(jet.arc_length)
    lost = evaporate(bead_path(jet, residence_time=ages), PHI, x, air_viscosity=NU).lost
    np.testing.assert_allclose(lost[5:], evaporate(bead_path(jet), PHI, x, air_viscosity=NU).lost[5:], rtol=5e-3)


def test_bead_jet_needs_to_know_its_age() -> None:
    jet = LagrangianJet.from_arrays([0, 1e-3, 2e-3], initial_radius=R0, stretch_ratio=[1.0, 2.0])
    with pytest.raises(InputError, match="flow_rate or residence_time"):
        bead_path(jet)
    with pytest.raises(InputError, match="strictly increase"):
        bead_path(jet, residence_time=[2.0, 1.0])
    with pytest.raises(InputError, match="not both"):
        bead_path(jet, residence_time=[1.0, 2.0], flow_rate=Q)


@pytest.mark.parametrize(("chi", "expected"), [(0.0, 0.824643499), (0.45, 0.883674284)])
def test_drying_in_vapour_ends_where_activity_is_humidity(chi: float, expected: float) -> None:
    assert vapour.equilibrium_fraction(0.4, chi) == pytest.approx(expected, abs=5e-10)
    x = Volatile("x", 1e-2, D, ambient=0.4, chi=chi)
    jet = evaporate(straight_path(JET, np.linspace(0, 0.05, 200)), PHI, [x], air_viscosity=NU)
    assert jet.polymer_fraction[-1] == pytest.approx(expected, abs=5e-10)
    again = evaporate(straight_path(JET, [0.05]), 0.95, [x], air_viscosity=NU)  # too dry: it swells back
    assert again.polymer_fraction[0] == pytest.approx(expected, abs=5e-10)
    assert again.lost[0] < 0
    # smoothly: the approach is exponential
    gap = expected - jet.polymer_fraction
    late = (gap < 1e-3) & (gap > 1e-6)
    assert late.sum() > 0
    assert (np.diff(np.log(gap[late])) < 0).all()


@given(st.floats(1e-6, 1 - 1e-6), st.floats(-2, 3))
def test_equilibrium_is_a_root(humidity: float, chi: float) -> None:
    phi = vapour.equilibrium_fraction(humidity, chi)
    assert 0 < phi < 1
    # 1 - phi loses digits as phi approaches 1
    assert float(vapour.solvent_activity(phi, chi)) == pytest.approx(humidity, rel=1e-12 + 1e-15 / (1 - phi))


def test_activities_of_mixtures() -> None:
    v, chi = np.array([7e-5, 7e-5]), np.array([0.3, 0.3])
    for phi in (0.05, 0.5, 0.95):  # two equal halves are one solvent
        halves = np.full(2, (1 - phi) / 2)
        whole = float(vapour.solvent_activity(phi, 0.3))
        np.testing.assert_allclose(vapour.flory_huggins_coefficient(halves, v, chi) * (1 - phi), whole, rtol=1e-13)
    # Gibbs-Duhem at constant temperature, unequal solvents: sum n_i d ln a_i = -n_p d ln a_p; checked as symmetry of d mu
    v, chi, u = np.array([2e-5, 9e-5]), np.array([1.2, 0.2]), np.array([0.4, 0.5])

    def potential(moles: np.ndarray) -> np.ndarray:
        phi = moles * v / (moles @ v + 0.1)
        return np.log(phi * vapour.flory_huggins_coefficient(phi, v, chi))

    n, h = u / v, 1e-3
    cross = [(potential(n + d)[1 - i] - potential(n - d)[1 - i]) / (2 * h) for i, d in enumerate(np.eye(2) * h)]
    assert cross[0] == pytest.approx(cross[1], rel=1e-6)
    # Raoult: mole fractions
    np.testing.assert_allclose(
        vapour.raoult_coefficient(np.array([0.9]), np.array([1e-5]), 1e-5) * 0.9, 0.9, rtol=1e-14
    )


def test_mixture_loses_the_volatile_one_first_and_takes_up_water() -> None:
    dmf, acetone = (Volatile.build(n, 298.15) for n in ("DMF", "acetone"))
    humid = Volatile.build("water", 298.15, ambient=0.5, chi=1.0)
    z = np.linspace(1e-3, 0.3, 100)
    jet = evaporate(straight_path(JET, z), 0.1, [dmf, acetone, humid], [0.5, 0.5, 0.0], air_viscosity=NU)
    gone = 1 - jet.solvent_volume[:2] / 0.45
    assert gone[1, 10] > 20 * gone[0, 10] > 0
    assert jet.solvent_volume[2, 10] > 0
    np.testing.assert_allclose(np.pi * jet.radius**2 * jet.velocity * jet.polymer_fraction, 0.1 * Q, rtol=1e-12)
    one = evaporate(straight_path(JET, z), 0.1, [acetone], air_viscosity=NU)
    two = evaporate(straight_path(JET, z), 0.1, [acetone, acetone], [0.3, 0.7], air_viscosity=NU)
    np.testing.assert_allclose(two.lost, one.lost, rtol=1e-9)


def test_raoult_ends_smoothly_too() -> None:
    x = Volatile("x", 1e-2, D, ambient=0.4, molar_volume=1.8e-5)
    jet = evaporate(
        straight_path(JET, [0.05]), PHI, [x], air_viscosity=NU, activity="raoult", polymer_molar_volume=3.9e-5
    )
    phi = float(jet.polymer_fraction[0])
    moles = (1 - phi) / 1.8e-5
    assert moles / (moles + phi / 3.9e-5) == pytest.approx(0.4, rel=1e-9)


def test_range_is_warned_and_a_floor_helps() -> None:
    z = np.array([0.001, 0.01])
    with pytest.warns(SpinlineWarning, match="Re is 0.3"):
        low = evaporate(straight_path(JET, z), PHI, [WATER], air_viscosity=NU)
    assert "Sherwood" in low.notes[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert evaporate(straight_path(JET, [0.01]), PHI, [WATER], air_viscosity=NU / 3).notes == ()
    floored = evaporate(straight_path(JET, z), PHI, [WATER], air_viscosity=NU, sherwood_floor=5.0)
    exact = -np.expm1(-np.pi * D * 5.0 * C * 0.6 * z / Q)  # a constant Sh: linear, to first order in phi
    np.testing.assert_allclose(floored.lost, exact, rtol=0.1)
    unit = evaporate(straight_path(JET, z), PHI, [WATER], air_viscosity=NU, sherwood_floor=5.0, activity="unit")
    np.testing.assert_allclose(unit.lost, np.pi * D * 5.0 * C * 0.6 * z / Q, rtol=1e-8)
    assert sherwood(0.3018049, 0.6) == pytest.approx(0.25719129, rel=1e-7)


@pytest.mark.parametrize("kept", ["velocity", "radius"])
def test_wind(kept) -> None:
    """Air that flows against the jet dries it more, a calm gives what no wind gives, and a following wind less."""
    z = np.array([0.01])
    lost = [
        float(evaporate(straight_path(JET, z, kept), PHI, [WATER], air_viscosity=NU, air_velocity=w).lost[0])
        for w in (-0.1, -1e-12, 0.0, 0.1)
    ]
    assert lost[0] > lost[1]
    assert lost[1] == pytest.approx(lost[2], rel=1e-7)
    assert lost[2] > lost[3] > 0


@settings(max_examples=30, deadline=None)
@given(
    st.floats(-14, 3),
    st.floats(0.001, 0.9),
    st.floats(1e-12, 0.99) | st.just(0.0),
    st.floats(0, 1),
    st.floats(0.25, 1),
    st.floats(-1, 1),
)
def test_extremes(decades: float, phi: float, humidity: float, chi: float, beta: float, log_k: float) -> None:
    jet = PowerLaw(radius=R0, flow_rate=Q, k=10**log_k, beta=beta)
    x = Volatile("x", 10**decades, D, humidity, chi)
    dried = evaporate(straight_path(jet, np.linspace(1e-5, 0.02, 20)), phi, [x], air_viscosity=NU)
    end = vapour.equilibrium_fraction(humidity, chi)
    assert np.isfinite(dried.radius).all()
    low, high = min(phi, end), max(phi, end)
    assert ((dried.polymer_fraction >= low * (1 - 1e-9)) & (dried.polymer_fraction <= high * (1 + 1e-9))).all()


# kPa at 25 degC. CRC Handbook of Chemistry and Physics, 97th ed., laboratory solvents; DMF: Antoine constants 6.92796, 1400.869,
# 196.434 (mmHg, degC) of Gmehling and Onken, DECHEMA; HFIP: Murto et al. (1967), log10(p/bar) = 4.5449 - 1132.49/(T - 81.012)
@pytest.mark.parametrize(
    ("name", "kilopascal"),
    [
        ("water", 3.1699),
        ("ethanol", 7.87),
        ("acetone", 30.8),
        ("DMF", 0.5327),
        ("DCM", 58.2),
        ("chloroform", 26.2),
        ("THF", 21.6),
        ("HFIP", 21.35),
        ("formic acid", 5.75),
    ],
)
def test_vapour_pressures(name: str, kilopascal: float) -> None:
    assert vapour.vapour_pressure(name, 298.15) == pytest.approx(1e3 * kilopascal, rel=0.02)
    assert 5e-6 < vapour.vapour_diffusivity(name, 298.15) < 3e-5


def test_air() -> None:
    assert vapour.air_kinematic_viscosity(293.15) == pytest.approx(1.506e-5, rel=0.01)  # U.S. Standard Atmosphere
    assert vapour.vapour_diffusivity("water", 298.15) == pytest.approx(2.5e-5, rel=0.05)
    # Poling et al., Table 11-2: ethanol in air at 313 K, 1.45e-5 m2/s; water at 313 K, 2.88e-5
    assert vapour.vapour_diffusivity("ethanol", 313.0) == pytest.approx(1.45e-5, rel=0.1)
    assert vapour.vapour_diffusivity("water", 313.0) == pytest.approx(2.88e-5, rel=0.06)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: vapour.vapour_pressure("limonene", 298.0), "vapour_pressure"),
        (lambda: vapour.vapour_pressure("HFIP", 400.0), "range of the vapour pressure of HFIP"),
        (lambda: vapour.vapour_pressure("watr", 298.0), "did you mean 'water'"),
        (lambda: Volatile.build("HFIP", 320.0), "liquid range of HFIP"),
        (lambda: Volatile.build("water", 400.0), "boiling"),
        (lambda: Volatile.build("water", convention="mol"), "convention"),  # type: ignore[arg-type]
        (lambda: Volatile("x", 0.0, 1.0), "x.saturation"),
        (lambda: Volatile("x", 1.0, 1.0, ambient=1.0), "relative humidity"),
        (lambda: Volatile("x", 1.0, 1.0, chi=np.nan), "x.chi"),
        (lambda: vapour.equilibrium_fraction(1.0), "relative_humidity"),
        (lambda: evaporate(straight_path(JET, [0.01]), 1.0, [WATER], air_viscosity=NU), "volume_fraction"),
        (lambda: evaporate(straight_path(JET, [0.01]), 0.1, [], air_viscosity=NU), "volatiles"),
        (lambda: evaporate(straight_path(JET, [0.01]), 0.1, [WATER], [0.5], air_viscosity=NU), "sum to 1"),
        (lambda: evaporate(straight_path(JET, [0.01]), 0.1, [WATER], air_viscosity=0.0), "air_viscosity"),
        (lambda: evaporate(straight_path(JET, [0.01]), 0.1, [WATER], air_viscosity=NU, activity="ideal"), "activity"),  # type: ignore[arg-type]
        (
            lambda: evaporate(straight_path(JET, [0.01]), 0.1, [WATER], air_viscosity=NU, activity="raoult"),
            "polymer_molar_volume",
        ),
        (
            lambda: evaporate(
                straight_path(JET, [0.01]), 0.1, [WATER] * 2, [0.5, 0.5], air_viscosity=NU, activity="unit"
            ),
            "mixture",
        ),
        (
            lambda: evaporate(straight_path(JET, [0.01]), 0.1, [WATER], air_viscosity=NU, sherwood_floor=-1.0),
            "sherwood_floor",
        ),
        (lambda: straight_path(JET, [0.02, 0.01]), "strictly increase"),
        (lambda: straight_path(JET, [-1.0]), "z = -1"),
        (lambda: straight_path(JET, [0.01], "mass"), "given"),  # type: ignore[arg-type]
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(InputError, match=words):
        call()


def test_it_is_cheap() -> None:
    path = straight_path(JET, np.linspace(1e-4, 0.01, 100))
    evaporate(path, PHI, [WATER], air_viscosity=NU)
    began = time.process_time()
    evaporate(path, PHI, [WATER], air_viscosity=NU)
    assert time.process_time() - began < 1.0


@pytest.mark.parametrize("humidity", [0.999999, 1 - 1e-9, 1 - 2**-40])
@pytest.mark.parametrize("phi", [1e-12, 1e-4])
@pytest.mark.parametrize("solvents", [1, 2])
def test_nearly_saturated_air_against_quadrature(humidity, phi, solvents) -> None:
    """A plain ``activity - humidity`` is noise there: the solver never came back."""
    z, strength = np.geomspace(1e-3, 0.1, 4), 0.02
    one = Volatile("x", strength, D, ambient=humidity, chi=0.5)
    same = [one] if solvents == 1 else [one, Volatile("dry", 1e-9, D, chi=0.5)]
    share = [1.0] if solvents == 1 else [1.0, 0.0]
    jet = evaporate(straight_path(JET, z), phi, same, share, air_viscosity=NU)
    speed = rate(JET, Volatile("x", strength, D))
    power = 1 + 0.47 / 3
    with mpmath.workdps(40):
        dry = 1 - mpmath.mpf(humidity)

        def excess(lost: mpmath.mpf) -> mpmath.mpf:
            p = phi / (1 - lost)
            return dry + mpmath.expm1(mpmath.log1p(-p) + p + p * p / 2)

        for place, lost in zip(z / R0, jet.lost, strict=True):
            way = 1 + (mpmath.mpf(place) ** power - 1) / power
            found = mpmath.quad(lambda x: (1 - x) ** (-mpmath.mpf(1) / 6) / excess(x), [0, mpmath.mpf(float(lost))])
            rounding = 0.0 if solvents == 1 else 4e-16 * phi / float(dry)  # of ln(1 - phi) + phi, in mixtures no series
            assert float(found / (speed * way)) == pytest.approx(1, rel=1e-9 + rounding)


def test_activity_one_until_nothing_is_left() -> None:
    """In closed form in still air; by integration of the loss with a floor, and past dryness."""
    z, dry = np.linspace(1e-4, 0.1, 400), Volatile("x", 0.02, D)
    for phi in (1e-6, 0.5, 0.999999):
        for floor in (0.0, 2.0):
            jet = evaporate(straight_path(JET, z), phi, [dry], air_viscosity=NU, activity="unit", sherwood_floor=floor)
            assert jet.polymer_fraction[-1] == 1
            assert (np.diff(jet.polymer_fraction) >= 0).all()
            wet = jet.polymer_fraction < 1
            if not floor:
                lost = power_law_loss(z[wet] / R0, 1.0, 0.47, rate(JET, dry))
                np.testing.assert_allclose(jet.lost[wet], lost, rtol=1e-12)


def test_names_in_any_case() -> None:
    assert Volatile.build(" Water", 298.15) == Volatile.build("water", 298.15)
    with pytest.raises(InputError, match="not a name"):
        Volatile.build(3, 298.15)
