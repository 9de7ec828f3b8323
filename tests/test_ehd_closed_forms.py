"""Cones, thresholds, fields, bending, capillary waves and numbers of the electrified jet against mpmath and printed values."""

import itertools

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad

from spinline.base.constants import EPS0
from spinline.base.errors import InputError
from spinline.jetprofile.ehd import bending, capillary, cones, numbers
from spinline.jetprofile.ehd.fields import HyperboloidField, NeedleField, TableField, UniformField
from spinline.jetprofile.ehd.leaky_beads import FIG21, LeakyBeads, effective_charge
from spinline.jetprofile.ehd.thresholds import critical_hyperboloid_voltage, threshold_voltage


def half(x):
    return mp.hyp2f1(-mp.mpf(1) / 2, mp.mpf(3) / 2, 1, (1 - mp.mpf(x)) / 2)


def cone(angle):
    c = mp.cos(angle)
    return -half(c) * mp.diff(half, -c) / (mp.diff(half, c) * half(-c))


# cones


def test_taylors_cone_to_the_last_digit() -> None:
    with mp.workdps(30):  # with more, the series around its zero costs seconds
        cosine = mp.findroot(half, -0.652)
    assert abs(cosine - mp.mpf("-0.65222953196994067235")) < mp.mpf("5e-21")
    angle = mp.pi - mp.acos(cosine)
    assert cones.taylor_half_angle() == float(angle)
    assert float(np.degrees(cones.taylor_half_angle())) == pytest.approx(49.2900892921000070804, rel=1e-16)


@pytest.mark.parametrize("x", [-0.999999, -0.65, -0.1, 0.0, 0.3, 0.9, 0.999999])
def test_legendre_function_of_order_one_half(x) -> None:
    value, slope = cones.legendre_half(x)
    assert float(value) == pytest.approx(float(half(x)), rel=1e-13, abs=1e-14)
    assert float(slope) == pytest.approx(float(mp.diff(half, x)), rel=1e-9 if abs(x) > 0.99 else 1e-13)


def test_dielectric_cone() -> None:
    assert float(cone(mp.pi / 6)) == pytest.approx(cones.LEAST_PERMITTIVITY, rel=1e-15)
    assert abs(mp.diff(cone, mp.pi / 6)) < 1e-25
    printed = {20: (37.1158747, 22.2589895), 40: (44.7800665, 11.7429312), 80: (47.2235659, 7.20139100)}
    for eps, (upper, lower) in printed.items():
        found = cones.dielectric_cone(eps)
        assert f"{np.degrees(found.upper):.7f}" == f"{upper:.7f}"
        assert f"{np.degrees(found.lower):.7f}" == f"{lower:.7f}"
        for angle in (found.upper, found.lower):
            assert float(cone(angle)) == pytest.approx(eps, rel=1e-10)
    assert f"{float(cones.cone_permittivity(np.radians(39.25))):.7f}" == "22.2021124"
    assert f"{np.degrees(cones.dielectric_cone(22.2).upper):.7f}" == "39.2483929"
    with pytest.raises(InputError, match="no cone"):
        cones.dielectric_cone(17.59)
    least = cones.dielectric_cone(cones.LEAST_PERMITTIVITY)
    assert least.upper == pytest.approx(np.pi / 6, abs=1e-6)


def test_hyperboloid() -> None:
    xi = mp.findroot(lambda x: x * mp.log((1 + x) / (1 - x)) - 2, 0.83)
    assert float(mp.re(xi)) == cones.HYPERBOLOID_XI
    assert float(np.degrees(cones.hyperboloid_half_angle())) == pytest.approx(33.5341648725476519, rel=1e-15)
    gaussian = cones.HYPERBOLOID_POTENTIAL * np.sqrt(4 * np.pi)
    assert gaussian == pytest.approx(4.69872850315, rel=1e-12)
    assert pytest.approx(1.32548683870, rel=1e-11) == cones.HYPERBOLOID_POTENTIAL
    assert pytest.approx(0.439228839891, rel=1e-12) == cones.HYPERBOLOID_TIP_RADIUS
    share = np.linspace(0.01, 2, 4001)  # the greatest potential of all tip radii
    at = 1 / np.sqrt(1 + share)
    potential = np.sqrt(1 - at**2) * np.log((1 + at) / (1 - at))
    assert share[np.argmax(potential)] == pytest.approx(cones.HYPERBOLOID_TIP_RADIUS, abs=1e-3)


# thresholds: a band


def test_thresholds_of_the_peo_needle() -> None:
    found = threshold_voltage(surface_tension=0.061, radius=125e-6, gap=0.1)
    assert found["hyperboloid"] == pytest.approx(7485.7, abs=0.05)
    assert found["taylor_cone"] == pytest.approx(6045, abs=0.5)
    assert found["taylor_1969"] == pytest.approx(2567, abs=0.5)
    assert found["capped_cylinder"] == pytest.approx(3038, rel=1e-3)
    assert critical_hyperboloid_voltage(0.061, 0.1) == pytest.approx(34.8e3, rel=1e-3)


# fields


def test_hyperboloid_field() -> None:
    field = HyperboloidField(6e3, 0.1, 125e-6)
    values = field.axial([0.0, 1e-6, 1e-3])
    for value, printed in zip(values, (1.19011e7, 1.1714e7, 7.0337e5), strict=True):
        assert value == pytest.approx(printed, rel=5e-5)
    parts = [0, 1e-5, 1e-4, 1e-3, 1e-2, 0.1]
    total = sum(quad(lambda z: float(field.axial(z)), a, b)[0] for a, b in itertools.pairwise(parts))
    assert total == pytest.approx(6e3, rel=1e-12)
    tip = 2 * 6e3 / (125e-6 * np.log(4 * 0.1 / 125e-6))
    assert values[0] == pytest.approx(tip, rel=1e-3)


@pytest.mark.parametrize("make", [HyperboloidField, NeedleField, lambda v, h, r: UniformField(v, h)])
def test_field_is_the_slope_of_its_potential(make) -> None:
    field = make(6e3, 0.1, 250e-6)
    z, r, h = np.array([2e-4, 5e-3, 0.06]), np.array([1e-3, 2e-3, 0.04]), 1e-7
    along, across = field.vector(z, r)
    slope_z = (field.potential(z + h, r) - field.potential(z - h, r)) / (2 * h)
    slope_r = (field.potential(z, r + h) - field.potential(z, r - h)) / (2 * h)
    np.testing.assert_allclose(along, -slope_z, rtol=1e-7, atol=1e-3)
    np.testing.assert_allclose(across, -slope_r, rtol=1e-7, atol=1e-3)
    np.testing.assert_allclose(field.vector(z, 0 * r)[0], field.axial(z), rtol=1e-6)


def test_capped_cylinder_over_the_hyperboloid() -> None:
    z = np.array([1e-6, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2])
    ratio = NeedleField(6e3, 0.1, 125e-6).axial(z) / HyperboloidField(6e3, 0.1, 125e-6).axial(z)
    np.testing.assert_allclose(ratio, [2.464, 2.092, 1.599, 1.140, 0.862, 0.598, 0.342], atol=6e-4)
    for radius, share in ((125e-6, 0.611), (250e-6, 0.647), (450e-6, 0.683)):
        field = NeedleField(6e3, 0.1, radius)
        assert float(field.axial(0.0)) * radius / 6e3 == pytest.approx(share, abs=6e-4)
    parts = [0, 1e-5, 1e-4, 1e-3, 1e-2, 0.1]
    total = sum(quad(lambda z: float(field.axial(z)), a, b)[0] for a, b in itertools.pairwise(parts))
    assert total == pytest.approx(6e3, rel=1e-6)


def test_table_field_is_its_samples() -> None:
    true = HyperboloidField(6e3, 0.1, 125e-6)
    z = np.concatenate(([0.0], np.geomspace(1e-6, 0.1, 400)))
    table = TableField(z, true.axial(z))
    assert table.voltage == pytest.approx(6e3, rel=1e-5)
    np.testing.assert_allclose(table.axial([1e-5, 3e-3]), true.axial([1e-5, 3e-3]), rtol=1e-4)
    for bad in ([1e-3, 0.1], [0.0, 0.0]):
        with pytest.raises(InputError):
            TableField(bad, [1.0, 1.0])
    with pytest.raises(InputError, match="ends there"):
        table.axial(0.2)


# bending


def test_earnshaw() -> None:
    assert f"{float(bending.earnshaw_growth(1e-12, 1e-9, 1e-3)):.6f}" == "134.071263"


def test_bending_dispersion_with_printed_values() -> None:
    drive = float(bending.bending_drive(1e-4, 1e-7, 0.0, density=1000.0, surface_tension=0.06, logarithm=np.log(10)))
    x, growth = bending.fastest_bending(drive, radius=1e-4, viscosity=10.0, density=1000.0)
    assert x == pytest.approx(0.28467306, rel=1e-7)
    assert growth == pytest.approx(4925.45966, rel=1e-8)
    grid = np.linspace(0.01, 0.5, 200001)
    rates = bending.bending_growth(grid, drive, radius=1e-4, viscosity=10.0, density=1000.0)
    assert grid[np.argmax(rates)] == pytest.approx(x, abs=3e-6)
    # the root solves the quadratic, viscous or not
    for mu in (0.0, 10.0):
        g = float(bending.bending_growth(0.3, drive, radius=1e-4, viscosity=mu, density=1000.0))
        left = g**2 + 0.75 * mu * 0.3**4 / (1000.0 * 1e-8) * g - drive * 0.3**2
        assert abs(left) < 1e-9 * g**2
    critical = float(bending.critical_line_charge(1e-4, 0.0, surface_tension=0.06, logarithm=np.log(10)))
    assert critical == pytest.approx(3.01801931e-8, rel=1e-8)
    assert pytest.approx(2 * np.exp(0.5 - np.euler_gamma), abs=5e-4) == bending.LINE_CHARGE_LENGTH


def test_tension_stops_bending() -> None:
    held = bending.bending_drive(1e-4, 1e-7, 1.0, density=1000.0, surface_tension=0.06, logarithm=2.0)
    assert held < 0
    assert float(bending.bending_growth(0.2, held, radius=1e-4, viscosity=1.0, density=1000.0)) == 0
    with pytest.raises(InputError, match="does not bend"):
        bending.fastest_bending(float(held), radius=1e-4, viscosity=1.0, density=1000.0)


# capillary waves


def test_fastest_capillary_wave() -> None:
    x, growth = capillary.fastest_capillary(1.0)
    assert f"{float(x):.6f}" == "0.400236"
    assert f"{float(growth):.6f}" == "0.113270"
    inviscid, rate = capillary.fastest_capillary(0.0)
    assert float(inviscid) == pytest.approx(1 / np.sqrt(2), rel=1e-15)
    assert float(rate) == pytest.approx(1 / np.sqrt(8), rel=1e-15)


@pytest.mark.parametrize("x", [0.05, 0.4, 0.9])
def test_axisymmetric_waves_without_charge_are_rayleighs(x) -> None:
    for oh in (0.0, 0.3, 30.0):
        b = 3 * oh * x**2
        expected = 0.5 * (-b + np.sqrt(b**2 + 2 * x**2 * (1 - x**2)))
        assert capillary.axisymmetric_growth(x, oh=oh).real == pytest.approx(expected, rel=1e-10)


def test_charged_conductor() -> None:
    stable = capillary.axisymmetric_growth
    assert stable(0.85, oh=0.5, charge=0.5, log="constant").real > 0  # x^2 < 1 - S^2
    assert stable(0.88, oh=0.5, charge=0.5, log="constant").real <= 1e-12
    assert stable(0.3, oh=0.5, charge=1.0, log="constant").real <= 1e-12
    # Basset's conductor, long waves: w^2 = x^2/2 [1 - x^2 - S^2 (1 - x K1/K0)]
    from scipy.special import kv

    x, s = 0.2, 0.8
    basset = np.sqrt(x**2 / 2 * (1 - x**2 - s**2 * (1 - x * kv(1, x) / kv(0, x))))
    assert stable(x, oh=0.0, charge=s, permittivity=1.0).real == pytest.approx(float(basset), rel=1e-10)
    leaky = stable(0.4, oh=1.0, charge=0.5, permittivity=40.0, conductivity=1e9)
    assert leaky.real == pytest.approx(stable(0.4, oh=1.0, charge=0.5, permittivity=40.0).real, rel=1e-6)


# numbers of Sections II and V.B.2


def test_numbers_with_their_misprints_put_right() -> None:
    times = numbers.charge_relaxation_time(40.0, np.array([1e-7, 1e-6])) * 1e3
    np.testing.assert_allclose(times, [3.54, 0.354], rtol=1e-3)
    bo = float(numbers.electric_bond(1e-3, 10 * 29979.2458, 0.05))
    assert bo == pytest.approx(0.2, rel=1e-6)
    ratio = float(numbers.electric_over_capillary_pressure(1e-3, 10 * 29979.2458, 0.05))
    assert ratio == pytest.approx(bo / (16 * np.pi), rel=1e-12)
    ca = float(numbers.elongational_capillary(20 * 0.102, 2.0, 0.0146))
    assert f"{ca:.1f}" == "279.5"
    de = {"relaxation_time": 3.11e-3, "radius": 5e-4, "density": 850.0, "elongational_viscosity": 2.04, "capillary": ca}
    assert numbers.jian_deborah(elastic_over_solvent=20 / 0.471, **de) == pytest.approx(680.9, abs=0.05)
    assert numbers.jian_deborah(elastic_over_solvent=0.529 / 0.471, **de) == pytest.approx(10.7, abs=0.06)


# leaky beads


def test_effective_charge_of_fig_21_is_negative_above_2546_statvolts_per_cm() -> None:
    given = {"conductivity": FIG21["conductivity"], "current": FIG21["current"]}
    for field, positive in ((2.545, True), (2.547, False)):
        assert (float(effective_charge(5e-4, field * 29979.2458, **given)) > 0) is positive


def leaky(**changed):
    given = {name: value for name, value in FIG21.items() if name != "surface_tension"}
    given |= {"flow_rate": 1e-9, "electric_field": 5e4, "density": 850.0, "length": 2e-3}
    return LeakyBeads(**{**given, **changed})


def test_leaky_bead_falls_freely_without_charge_or_stress() -> None:
    jet = leaky(current=1e-18, conductivity=0.0, viscosity=1e-12)
    path = jet.path(0.05)
    start = jet.flow_rate / (np.pi * jet.radius**2)
    fall = np.sqrt(start**2 + 2 * 9.81 * (path["position"] - jet.length))
    np.testing.assert_allclose(path["velocity"], fall, rtol=1e-6)


def test_leaky_bead_thins_less_than_a_perfect_one_and_refuses_fig_21_in_a_strong_field() -> None:
    slow, fast = leaky().path(0.05), leaky(conductivity=0.0).path(0.05)
    assert slow["time"][-1] > fast["time"][-1]
    assert (np.diff(slow["charge_share"]) > 0).all()
    np.testing.assert_allclose(slow["radius"] ** 2 * slow["position"], 5e-4**2 * 2e-3, rtol=1e-12)
    with pytest.raises(InputError, match="whole current"):
        leaky(electric_field=8e4)


def test_vacuum_constant_is_codata() -> None:
    assert EPS0 == 8.8541878188e-12
