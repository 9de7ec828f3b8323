"""Concentration laws: Eq. (45), scaling, Martin; over 12 decades and more."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spinline.base.errors import InputError
from spinline.rheology import concentration_laws as laws

PHI = np.logspace(-4, 0, 41)


def test_eq45a_against_mpmath_and_the_start() -> None:
    for c in (1e-4, 0.0599999999, 0.06, 0.0600000001, 0.2, 1.0):
        with mpmath.workdps(40):
            exact = 2 * mpmath.mpf(10) ** (7 * (mpmath.mpf(c) ** mpmath.mpf(0.1) - mpmath.mpf(0.06) ** mpmath.mpf(0.1)))
            exponent = abs(mpmath.log10(exact / 2)) + mpmath.mpf(1)
        assert float(laws.viscosity(c, 0.06, 2.0)) == pytest.approx(float(exact), rel=8e-16 * float(exponent) * 3)
    assert laws.viscosity(0.06, 0.06, 2.0) == 2.0
    # linear near the start without cancellation: d ln mu = ln(10) B m C^m dC/C
    step = 1e-12
    rise = float(laws.viscosity(0.06 * (1 + step), 0.06, 1.0, 1e3, 1.0)) - 1
    assert rise == pytest.approx(np.log(10) * 1e3 * 0.06 * ((0.06 * (1 + step)) / 0.06 - 1), rel=1e-4)


def test_eq45a_covers_twelve_decades() -> None:
    mu = laws.viscosity(PHI, 1e-4, 1e-3, 12.0, 1.0)
    assert np.log10(mu[-1] / mu[0]) == pytest.approx(12 * (1 - 1e-4), rel=1e-13)
    assert (np.diff(mu) > 0).all()


def test_eq45b_conventions() -> None:
    assert laws.relaxation_time(0.12, 0.06, 1e-2) == pytest.approx(2e-2, rel=1e-14)
    assert laws.relaxation_time(0.12, 0.06, 1e-2, convention="print") == pytest.approx(5e-3, rel=1e-14)
    assert laws.relaxation_time(0.12, 0.06, 1e-2, n=-1) == laws.relaxation_time(0.12, 0.06, 1e-2, convention="print")
    product = laws.relaxation_time(PHI, 0.05, 1.0) * laws.relaxation_time(PHI, 0.05, 1.0, convention="print")
    np.testing.assert_allclose(product, 1.0, rtol=1e-14)


@pytest.mark.parametrize("quality", ["theta", "good"])
@pytest.mark.parametrize("entangled", [True, False])
def test_scaling_is_self_consistent(quality: str, entangled: bool) -> None:
    x = laws.scaling_exponents(quality, entangled=entangled)
    assert x.viscosity == pytest.approx(x.relaxation + x.modulus, rel=1e-14)  # mu = G theta
    mu = laws.scaled_viscosity(PHI, 0.05, 2.0, 1e-3, x.viscosity) - 1e-3
    theta = laws.scaled(PHI, 0.05, 1e-2, x.relaxation)
    g = laws.scaled(PHI, 0.05, 1.999 / 1e-2, x.modulus)
    slope = np.diff(np.log(g * theta)) / np.diff(np.log(PHI))
    np.testing.assert_allclose(slope, x.viscosity, rtol=1e-10)
    np.testing.assert_allclose(mu[PHI > 1e-2], (g * theta)[PHI > 1e-2], rtol=1e-10)
    np.testing.assert_allclose(laws.modulus(g * theta, theta), g, rtol=1e-14)


def test_published_exponents() -> None:
    assert laws.scaling_exponents("theta") == (14 / 3, 7 / 3, 7 / 3)
    good = laws.scaling_exponents("good")
    assert good == pytest.approx((3.93, 1.62, 2.31), abs=5e-3)
    assert laws.scaling_exponents("good", entangled=False) == pytest.approx((1.31, 0.31, 1.0), abs=5e-3)


def test_martin_is_huggins_when_dilute() -> None:
    x = np.array([1e-4, 1e-3, 1e-2])
    excess = laws.martin_viscosity(x, 1.0, 0.4, 1.0) - (1 + x + 0.4 * x**2)
    np.testing.assert_allclose(excess, 0.4**2 * x**3 / 2, rtol=1e-2, atol=3e-16)
    assert laws.martin_viscosity(0.0, 1.0, 0.4, 1e-3) == 1e-3
    wide = laws.martin_viscosity(np.logspace(-4, np.log10(60), 50), 1.0, 0.4, 1e-3)
    assert (np.diff(wide) > 0).all()
    assert np.log10(wide[-1] / wide[0]) > 12


@given(st.floats(1e-4, 1), st.floats(1e-4, 1), st.floats(1e-4, 1), st.floats(0, 20), st.floats(0.05, 2))
def test_laws_compose(a: float, b: float, c: float, B: float, m: float) -> None:
    """Going from a to b and on to c is going from a to c."""
    there = laws.viscosity(b, a, 1.0, B, m)
    assert laws.viscosity(c, b, there, B, m) == pytest.approx(float(laws.viscosity(c, a, 1.0, B, m)), rel=1e-12)
    assert laws.relaxation_time(c, b, laws.relaxation_time(b, a, 1.0)) == pytest.approx(c / a, rel=1e-12)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: laws.viscosity(0.0, 0.1, 1.0), "concentration"),
        (lambda: laws.viscosity(1.1, 0.1, 1.0), "concentration"),
        (lambda: laws.viscosity(0.1, np.nan, 1.0), "initial_concentration"),
        (lambda: laws.viscosity(0.1, 0.1, -1.0), "initial_viscosity"),
        (lambda: laws.viscosity(1.0, 1e-4, 1.0, 400.0, 1.0), "decades"),
        (lambda: laws.viscosity(0.1, 0.1, 1.0, m=0.0), "m = 0"),
        (lambda: laws.viscosity(0.1, 0.1, 1.0, B=-1.0), "B = -1"),
        (lambda: laws.relaxation_time(0.1, 0.1, 0.0), "initial_relaxation_time"),
        (lambda: laws.relaxation_time(0.1, 0.1, 1.0, convention="printed"), "convention"),  # type: ignore[arg-type]
        (lambda: laws.relaxation_time(0.1, 0.1, 1.0, n=1.0, convention="print"), "one of the two"),
        (lambda: laws.scaling_exponents("bad"), "solvent_quality"),
        (lambda: laws.scaled_viscosity(0.1, 0.1, 1e-3, 1e-3, 2.0), "not above"),
        (lambda: laws.martin_viscosity(1e6, 1.0, 0.4, 1.0), "too large"),
        (lambda: laws.martin_viscosity(-1.0, 1.0, 0.4, 1.0), "concentration"),
        (lambda: laws.modulus(1.0, 0.0), "relaxation_time"),
        (lambda: laws.scaled(0.1, 0.1, 1.0, 99.0), "exponent"),
        (lambda: laws.viscosity("thick", 0.1, 1.0), "not a real number"),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(InputError, match=words):
        call()
