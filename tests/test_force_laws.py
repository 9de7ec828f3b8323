"""Force-extension laws against 50-digit arithmetic, their limits, inverses and refusals."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spinline.base.errors import InputError
from spinline.network import _force_kernels as kernels
from spinline.network import force_laws as laws
from spinline.network.lattice_walk import axial_force, relative_extension

BOUNDED = ("lattice", "langevin", "fene")
ALL = ("linear", *BOUNDED)
CASES = [("linear", 0.0), ("langevin", 0.0), ("fene", 0.0), *(("lattice", f0) for f0 in (0.0, 0.15, 3.0, 300.0))]
BOUND = 1e-14  # documented relative error


def exact_force(x: mp.mpf, law: str, rest: float) -> mp.mpf:
    if law == "linear":
        return 3 * x
    if law == "fene":
        return 3 * x / (1 - x**2)
    if law == "lattice":
        return mp.atanh(x) + mp.asinh(2 * mp.cosh(mp.mpf(rest)) * x / mp.sqrt(1 - x**2))
    with mp.workdps(80):
        size = abs(x)
        f = 3 * size if size < 0.3 else size * (3 - size**2) / (1 - size**2)
        for _ in range(80):
            value = exact_langevin(f)
            step = (value - size) / exact_langevin_slope(f)
            f = f - step if f > step else f / 2
            if abs(step) < mp.mpf("1e-60") * f:
                break
        return mp.sign(x) * f


def exact_langevin(f: mp.mpf) -> mp.mpf:
    with mp.workdps(80 + 3 * max(0, -int(mp.log10(abs(f))))):
        return mp.coth(f) - 1 / f


def exact_langevin_slope(f: mp.mpf) -> mp.mpf:
    with mp.workdps(80 + 5 * max(0, -int(mp.log10(abs(f))))):
        return 1 / f**2 - 1 / mp.sinh(f) ** 2 if f < 1e8 else 1 / f**2


def exact_extension(f: mp.mpf, law: str, rest: float) -> mp.mpf:
    if law == "linear":
        return f / 3
    if law == "fene":
        return 2 * f / (3 + mp.sqrt(9 + 4 * f**2))
    if law == "lattice":
        return mp.sinh(f) / (mp.cosh(f) + 2 * mp.cosh(mp.mpf(rest)))
    return exact_langevin(f)


def exact_stiffness(x: mp.mpf, law: str, rest: float) -> mp.mpf:
    if law == "linear":
        return mp.mpf(3)
    if law == "fene":
        return 3 * (1 + x**2) / (1 - x**2) ** 2
    if law == "lattice":
        a = 2 * mp.cosh(mp.mpf(rest))
        return (1 + a / mp.sqrt(1 - x**2 + (a * x) ** 2)) / (1 - x**2)
    return 1 / exact_langevin_slope(abs(exact_force(x, law, rest)))


def extensions(n: int, seed: int) -> np.ndarray:
    """Both signs; a third tiny, a third within 1e-16...1 of full extension."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-1, 1, n)
    x[::3] = rng.choice([-1, 1], x[::3].size) * 10 ** rng.uniform(-30, 0, x[::3].size)
    x[1::3] = 1 - 10 ** rng.uniform(-15.9, 0, x[1::3].size)
    edges = [1e-3 * (1 - 1e-15), 1e-3, 1e-3 * (1 + 1e-15), 1 - 2**-53, -1 + 2**-53, 0.537314720727548, 1e-300]
    return np.concatenate([x, edges])


def relative(got: float, exact: mp.mpf) -> float:
    return float(abs(mp.mpf(float(got)) / exact - 1))


@pytest.mark.parametrize(("law", "rest"), CASES)
def test_force_and_stiffness_against_fifty_digits(law: str, rest: float) -> None:
    x = extensions(400, 1)
    force, stiffness = laws.force(x, law, rest), laws.stiffness(x, law, rest)
    worst = max(relative(f, exact_force(mp.mpf(v), law, rest)) for v, f in zip(x, force, strict=True))
    worst_slope = max(relative(k, exact_stiffness(mp.mpf(v), law, rest)) for v, k in zip(x, stiffness, strict=True))
    assert worst < BOUND
    assert worst_slope < BOUND


@pytest.mark.parametrize(("law", "rest"), CASES)
def test_extension_and_deficit_against_fifty_digits(law: str, rest: float) -> None:
    rng = np.random.default_rng(2)
    f = rng.choice([-1, 1], 500) * 10 ** rng.uniform(-30, 2.8, 500)
    f = np.concatenate([f, rng.uniform(0, 10, 200), [2 * (1 - 1e-16), 2.0, 2 * (1 + 1e-15), 3.0, 17.0, 40.0]])
    if law != "lattice":
        f = np.concatenate([f, [1e4, 1e15, 1e17, 1e150, 1e300]])
    x, deficit = laws.extension(f, law, rest), laws.deficit(f, law, rest)
    for force, got, gap in zip(f, x, deficit, strict=True):
        with mp.workdps(700):
            exact = exact_extension(mp.mpf(force), law, rest)
            exact_gap = 1 - exact if force < 1e50 else {"fene": 1.5, "langevin": 1}.get(law, -force / 3) / mp.mpf(force)
            if law == "linear":
                exact_gap = 1 - mp.mpf(force) / 3
        assert relative(got, exact) < BOUND
        if exact_gap:
            assert relative(gap, exact_gap) < BOUND
        else:
            assert gap == 0


def test_limits_and_constants() -> None:
    # initial stiffness: 3, or 1 + 2 cosh f_0
    for law in ALL:
        assert float(laws.stiffness(0.0, law)) == 3.0
        assert float(laws.force(0.0, law)) == 0.0
        np.testing.assert_allclose(laws.extension([1e-300, 1e-12], law), np.array([1e-300, 1e-12]) / 3, rtol=1e-15)
    assert float(laws.stiffness(0.0, "lattice", 0.15)) == pytest.approx(1 + 2 * np.cosh(0.15), rel=1e-15)
    # near full extension: 1/(1-x), 3/(2(1-x)), ln(4 cosh f_0/(1-x))
    gap = 2.0**-40
    assert float(laws.force(1 - gap, "langevin")) == pytest.approx(1 / gap, rel=1e-14)
    assert float(laws.force(1 - gap, "fene")) == pytest.approx(1.5 / gap, rel=1e-12)
    assert float(laws.force(1 - gap, "lattice", 0.15)) == pytest.approx(np.log(4 * np.cosh(0.15) / gap), rel=1e-12)
    # the walk is not Langevin
    assert round(float(laws.extension(3.0, "lattice", 0.15)), 3) == 0.829
    assert round(float(laws.extension(3.0, "langevin")), 3) == 0.672
    # the module's own table at x = 0.9
    assert [round(float(laws.force(0.9, law)), 1) for law in ALL] == [2.7, 3.6, 10.0, 14.2]


def test_lattice_force_where_cosh_overflows() -> None:
    for x in (1 - 1e-15, -0.999, 1e-300):
        exact = mp.atanh(mp.mpf(x)) + mp.asinh(2 * mp.cosh(700) * mp.mpf(x) / mp.sqrt(1 - mp.mpf(x) ** 2))
        assert float(laws.force(x, "lattice", 700.0)) == pytest.approx(float(exact), rel=1e-14)


def test_lattice_is_the_closed_form_of_the_walk() -> None:
    x = extensions(1000, 3)
    np.testing.assert_allclose(laws.force(x, "lattice", 0.15), axial_force(x, 0.15), rtol=2e-15)
    f = laws.force(x, "lattice", 0.15)
    np.testing.assert_allclose(laws.extension(f, "lattice", 0.15), relative_extension(f, 0.15), rtol=2e-15)


def test_deficit_underflows_only_where_it_must() -> None:
    assert float(laws.deficit(740.0, "lattice", 0.0)) == pytest.approx(float(4 * mp.exp(-740)), rel=1e-2)
    assert float(laws.deficit(760.0, "lattice", 0.0)) == 0.0
    assert float(laws.deficit(1e300, "langevin")) == 1e-300
    assert float(laws.deficit(-5.0, "fene")) == 1 - float(laws.extension(-5.0, "fene"))


@given(st.floats(-1 + 1e-15, 1 - 1e-15, allow_subnormal=False), st.floats(0, 5), st.sampled_from(BOUNDED))
@settings(max_examples=300, deadline=None)
def test_inverse_both_ways(x: float, rest: float, law: str) -> None:
    f = laws.force(x, law, rest)
    assert float(laws.extension(f, law, rest)) == pytest.approx(x, rel=1e-13)
    if x > 0.5:  # 1 - x is exact, and carries what x cannot
        gap = float(laws.deficit(f, law, rest))
        assert gap == pytest.approx(1 - x, rel=1e-14 * max(1.0, float(f) if law == "lattice" else 1.0) + 1e-14)


@given(st.floats(-0.999, 0.999), st.floats(1e-9, 1e-3), st.floats(0, 5), st.sampled_from(ALL))
@settings(max_examples=300, deadline=None)
def test_odd_monotone_and_convex(x: float, step: float, rest: float, law: str) -> None:
    y = min(x + step, 0.9999)
    assert float(laws.force(y, law, rest)) >= float(laws.force(x, law, rest))
    assert float(laws.force(-x, law, rest)) == -float(laws.force(x, law, rest))
    assert float(laws.stiffness(-x, law, rest)) == float(laws.stiffness(x, law, rest)) >= 2.9


@pytest.mark.parametrize("law", ALL)
def test_stiffness_is_the_slope_of_the_force(law: str) -> None:
    x, h = np.linspace(-0.99, 0.99, 397), 1e-5
    slope = (laws.force(x + h, law, 0.2) - laws.force(x - h, law, 0.2)) / (2 * h)
    np.testing.assert_allclose(laws.stiffness(x, law, 0.2), slope, rtol=5e-6)


@pytest.mark.parametrize("law", ALL)
def test_kernels_are_the_array_functions(law: str) -> None:
    code = laws.LAW_CODES[law]
    assert code == getattr(kernels, law.upper())
    x = extensions(100, 4)
    f = laws.force(x, law, 0.15)
    for i in range(x.size):
        assert kernels.force_kernel(code, x[i], 0.15) == f[i]
        assert kernels.stiffness_kernel(code, x[i], 0.15) == laws.stiffness(x, law, 0.15)[i]
        assert kernels.extension_kernel(code, f[i], 0.15) == laws.extension(f, law, 0.15)[i]
        assert kernels.deficit_kernel(code, f[i], 0.15) == laws.deficit(f, law, 0.15)[i]


def test_kernels_beyond_the_contour() -> None:
    for law in BOUNDED:
        code = laws.LAW_CODES[law]
        for x in (1.0, 1.5, -1.0, -1e300):
            assert kernels.force_kernel(code, x, 0.0) == np.copysign(np.inf, x)
            assert kernels.stiffness_kernel(code, x, 0.0) == np.inf
        assert np.isnan(kernels.force_kernel(code, np.nan, 0.0))
    assert kernels.force_kernel(kernels.LINEAR, 2.0, 0.0) == 6.0


def test_broadcast_and_precision() -> None:
    f = laws.force(np.zeros((3, 1), dtype=np.float32) + 0.5, "lattice", np.array([0.0, 0.1]))
    assert f.shape == (3, 2)
    assert f.dtype == np.float64
    assert laws.force(np.empty(0), "fene").shape == (0,)
    assert laws.force(0.5, "fene").shape == ()
    np.testing.assert_array_equal(
        laws.force(extensions(50, 5)[::2], "fene"), laws.force(extensions(50, 5), "fene")[::2]
    )


@pytest.mark.parametrize(
    ("function", "arguments", "field"),
    [
        (laws.force, (1.0, "fene"), "extension"),
        (laws.force, (-1.0, "lattice"), "extension"),
        (laws.stiffness, ([0.0, 1.5], "langevin"), "extension"),
        (laws.force, (np.nan, "linear"), "extension"),
        (laws.extension, (np.inf, "fene"), "force"),
        (laws.deficit, ("a", "fene"), "force"),
        (laws.force, (0.5, "spring"), "force_law"),
        (laws.force, (0.5, 1), "force_law"),
        (laws.force, (0.5, "lattice", -0.1), "rest_force"),
        (laws.force, (0.5, "lattice", 701.0), "rest_force"),
        (laws.force, ([0.1, 0.2], "lattice", [0.1, 0.2, 0.3]), "rest_force"),
    ],
)
def test_refusals_name_the_field(function, arguments: tuple, field: str) -> None:
    with pytest.raises(InputError, match=field):
        function(*arguments)
