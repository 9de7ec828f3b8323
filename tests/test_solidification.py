"""Glass, crystals, phases: closed forms, limits, values in print."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, fsolve

from spinline.base.errors import InputError
from spinline.rheology import POLYMERS, vitrification_fraction
from spinline.rheology.crystal import Crystals, Nakamura
from spinline.rheology.glass import WLF_C1, WLF_C2, GlassLaw, wlf_decades
from spinline.rheology.interactions import chi_from_uptake, interaction, water_interaction
from spinline.rheology.ternary import Ternary

PMMA = GlassLaw(378.0, 1190.0, (118.9,), (784.6,))


def crystals(name: str) -> Crystals:
    p = POLYMERS[name]
    return Crystals(p.melting_temperature, p.melting_enthalpy, p.repeat_unit_molar_mass / p.density)


def test_glass_of_pmma_in_acetone_follows_the_temperature() -> None:
    assert PMMA.vitrification_fraction(298.15) == pytest.approx(0.825, abs=2e-3)
    assert PMMA.vitrification_fraction(273.15 - 11.5) == pytest.approx(0.72, abs=2e-3)
    for glass in (93.0, 100.0):
        assert 0.86 <= GlassLaw(378.0, 1190.0, (glass,), (784.6,)).vitrification_fraction(298.15) <= 0.875
    assert PMMA.vitrification_fraction(298.15) == pytest.approx(
        vitrification_fraction("PMMA", 118.9, 298.15, 784.6), rel=1e-13
    )
    assert np.isnan(PMMA.vitrification_fraction(380.0))
    assert PMMA.vitrification_fraction(100.0) == 0.0


@given(st.floats(0.01, 0.99), st.floats(0.0, 1.0))
def test_transition_is_between_its_parts_and_inverts(phi: float, share: float) -> None:
    law = GlassLaw(378.0, 1190.0, (118.9, 136.0), (784.6, 997.0))
    rest = np.array([share, 1 - share]) * (1 - phi)
    glass = float(law.transition(phi, rest))
    assert 118.9 < glass < 378.0
    assert law.vitrification_fraction(glass, [share, 1 - share]) == pytest.approx(phi, rel=1e-9)


def test_wlf() -> None:
    assert float(wlf_decades(0.0)) == 0.0
    x = np.array([1e-9, 50.0, 100.0, 900.0])
    np.testing.assert_allclose(wlf_decades(x), -WLF_C1 * x / (WLF_C2 + x), rtol=1e-15)
    step = 1e-6  # the slope goes on below
    below, above = (float(wlf_decades(s)) / s for s in (-step, step))
    assert below == pytest.approx(above, rel=1e-6)
    assert (np.diff(wlf_decades(np.linspace(-300, 300, 61))) < 0).all()
    with pytest.raises(InputError, match="glass transition"):
        wlf_decades(np.nan)


def test_stiffening_grows_by_decades_into_the_glass() -> None:
    phi = np.linspace(0.07, 0.82, 76)
    first = float(PMMA.transition(0.07, [0.93]))
    decades = PMMA.stiffening_decades(phi, (1 - phi)[np.newaxis], 298.15, first)
    assert decades[0] == 0.0
    assert (np.diff(decades) > 0).all()
    assert 12 < decades[-1] < 14  # at the glass, 17.44 x/(51.6 + x) of the solution's distance from its own
    cold = PMMA.stiffening_decades(0.6, [0.4], np.array([298.15, 262.0]), first)
    assert cold[0] > 0
    # at the solution's own fraction temperature does nothing here: it is the solvent's viscosity
    np.testing.assert_allclose(PMMA.stiffening_decades(0.07, [0.93], np.array([298.15]), first), 0.0, atol=1e-13)


def test_peo_crystallises_from_water_where_flory_says() -> None:
    peo = crystals("PEO")
    phi = peo.crystallisation_fraction(298.15, 18.07e-6, 0.45)
    assert phi == pytest.approx(0.768, abs=1e-3)
    assert float(peo.melting_point(phi, 18.07e-6, 0.45)) == pytest.approx(298.15, abs=1e-9)
    assert float(peo.melting_point(1.0, 18.07e-6, 0.45)) == pytest.approx(342.0, abs=1e-9)
    # other constants in print: 0.73 to 0.79
    for melting, heat, chi in (
        (339.0, 8660.0, 0.45),
        (349.0, 8660.0, 0.40),
        (342.0, 8000.0, 0.45),
        (345.0, 9100.0, 0.5),
    ):
        assert 0.70 < Crystals(melting, heat, peo.unit_volume).crystallisation_fraction(298.15, 18.07e-6, chi) < 0.81
    assert np.isnan(peo.crystallisation_fraction(343.0, 18.07e-6, 0.45))
    exact = mpmath.findroot(
        lambda s: (
            1 / mpmath.mpf(342)
            + mpmath.mpf("8.31446261815324") * peo.unit_volume / (8660 * 18.07e-6) * s * (1 - 0.45 * s)
            - 1 / mpmath.mpf(298.15)
        ),
        0.23,
    )
    assert phi == pytest.approx(float(1 - exact), rel=1e-12)
    # a solvent so poor that crystals melt in it at no temperature
    assert float(peo.inverse_melting_point(0.05, 18.07e-6, 5.0)) < 0
    with pytest.raises(InputError, match="1/T_m"):
        peo.melting_point(0.05, 18.07e-6, 5.0)
    # PVA dissolves in hot water alone: cold, its solutions are undercooled at every fraction
    assert crystals("PVA").crystallisation_fraction(298.15, 18.07e-6, 0.49) == 0.0


@pytest.mark.parametrize("name", ["PEO", "PCL", "PVDF", "nylon 6", "PVA", "PLA", "PET"])
def test_melting_points_rise_with_the_fraction(name: str) -> None:
    t = crystals(name).melting_point(np.linspace(0, 1, 50), 60e-6, 0.4)
    assert (np.diff(t) > 0).all()
    assert t[-1] == pytest.approx(POLYMERS[name].melting_temperature)


def test_nakamura_is_avrami_at_one_temperature_and_waits_for_undercooling() -> None:
    law = Nakamura(half_time=0.5, exponent=3.0, maximum=0.7)
    t = np.linspace(0, 2, 2001)
    x = law.crystallinity(t, True)
    np.testing.assert_allclose(x, 0.7 * (1 - np.exp(-np.log(2) * (t / 0.5) ** 3)), atol=1e-12)
    assert x[500] == pytest.approx(0.35, rel=1e-9)  # half of it at the half time
    late = law.crystallinity(t, t > 1.0)
    assert (late[t < 1.0] == 0).all()
    assert late[-1] < x[-1]
    drawn = Nakamura(0.5, 3.0, 0.1, 0.7).crystallinity(t, True, 10.0)
    np.testing.assert_allclose(drawn, law.crystallinity(t * (1 + 0.1 * 99), True), atol=1e-12)
    for key, value in (("half_time", 0.0), ("exponent", 5.0), ("flow_enhancement", -1.0), ("maximum", 1.1)):
        with pytest.raises(InputError):
            Nakamura(**{"half_time": 1.0, key: value})


def test_ternary_reduces_to_the_binary_solution() -> None:
    """No water: spinodal and critical point of Flory and Huggins in closed form."""
    v, chain = 75e-6, 75e-6 * 400
    critical = 0.5 * (1 + 400**-0.5) ** 2
    phi = np.linspace(0.001, 0.999, 1999)
    for chi in (critical - 1e-4, critical + 1e-2, 1.0):
        pair = Ternary(18e-6, v, chain, 0.0, 0.0, chi)
        closed = 1 / (1 - phi) + 1 / (400 * phi) - 2 * chi > 0
        assert ((pair.stability(np.zeros_like(phi), phi) > 0) == closed).all()
    pair = Ternary(18e-6, v, chain, 0.0, 0.0, 0.8)

    def potentials(p: float) -> tuple[float, float]:
        solvent = np.log(1 - p) + (1 - 1 / 400) * p + 0.8 * p**2
        polymer = np.log(p) / 400 - (1 - p) * (1 - 1 / 400) + 0.8 * (1 - p) ** 2
        return solvent, polymer

    def gap(x: np.ndarray) -> np.ndarray:
        low, high = np.exp(x[0]), x[1]
        return np.subtract(potentials(low), potentials(high))

    low, high = fsolve(gap, [np.log(1e-6), 0.7], xtol=1e-12)
    assert pair.tangent_distance(0.0, high + 0.01) > -1e-9
    assert pair.tangent_distance(0.0, high - 0.01) < -1e-7
    spinodal = brentq(lambda p: 1 / (1 - p) + 1 / (400 * p) - 1.6, 0.1, 0.9)
    assert high > spinodal
    path = np.linspace(0.9, 0.2, 701)
    verdict = pair.follow(np.zeros_like(path), path)
    assert path[verdict.spinodal] == pytest.approx(spinodal, abs=1.1e-3)
    assert path[verdict.binodal] == pytest.approx(high, abs=3e-3)
    assert np.exp(low) < 1e-3


@settings(deadline=None, max_examples=50)
@given(st.floats(0.01, 0.97), st.floats(0.01, 0.97), st.floats(-1, 3), st.floats(-1, 3), st.floats(-1, 3))
def test_potentials_are_derivatives_of_one_energy(a: float, b: float, c12: float, c13: float, c23: float) -> None:
    water, polymer = a, (1 - a) * b
    t = Ternary(18e-6, 74e-6, 74e-4, c12, c13, c23)
    g = (c12 / 18e-6, c13 / 18e-6, c23 / 74e-6)

    def energy(volumes: list[mpmath.mpf]) -> mpmath.mpf:
        total = sum(volumes)
        one, two, p = (x / total for x in volumes)
        f = one / 18e-6 * mpmath.log(one) + two / 74e-6 * mpmath.log(two) + p / 74e-4 * mpmath.log(p)
        return total * (f + g[0] * one * two + g[1] * one * p + g[2] * two * p)

    at = [mpmath.mpf(water), mpmath.mpf(1 - water - polymer), mpmath.mpf(polymer)]
    found = t.potentials(np.asarray(water), np.asarray(polymer))
    for i in range(3):
        exact = mpmath.diff(lambda x, i=i: energy([x if j == i else at[j] for j in range(3)]), at[i])
        assert float(found[i]) == pytest.approx(float(exact), rel=1e-7, abs=1e-3)
    # the spinodal's sign against the Hessian by differences
    h = mpmath.mpf("1e-12")
    f = lambda x, y: energy([x, 1 - x - y, y])  # noqa: E731
    x, y = at[0], at[2]
    with mpmath.workdps(50):
        xx = (f(x + h, y) - 2 * f(x, y) + f(x - h, y)) / h**2
        yy = (f(x, y + h) - 2 * f(x, y) + f(x, y - h)) / h**2
        xy = (f(x + h, y + h) - f(x + h, y - h) - f(x - h, y + h) + f(x - h, y - h)) / (4 * h**2)
        stable = xx > 0 and xx * yy - xy**2 > 0
    sign = float(t.stability(water, polymer))
    assert abs(sign) < 1e-6 or (sign > 0) == stable


def test_water_in_pmma_and_acetone_separates() -> None:
    chi, _ = interaction("PMMA", "water")
    assert chi == pytest.approx(2.87, abs=0.01)
    mutual, _ = water_interaction("acetone")
    t = Ternary(18.07e-6, 74e-6, 0.1, mutual, chi, 0.48)
    water = np.linspace(0, 0.3, 301)
    verdict = t.follow(water, np.full(301, 0.1) * (1 - water))
    assert 0 < verdict.binodal < verdict.spinodal
    assert t.follow(np.zeros(5), np.linspace(0.1, 0.9, 5)) == type(verdict)(-1, -1)
    for uptake in (1e-4, 0.02, 0.5):
        x = float(chi_from_uptake(uptake, 1190.0))
        phi = uptake * 1190 / 997 / (1 + uptake * 1190 / 997)
        assert np.log(phi) + 1 - phi + x * (1 - phi) ** 2 == pytest.approx(0.0, abs=1e-12)
    assert interaction("PVP", "toluene") is None
    assert water_interaction("toluene") is None
    with pytest.raises(InputError, match="more than the whole"):
        t.stability(0.7, 0.7)
