"""The straight jet in the potential of its whole line of charge."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from peo_needle import peo_needle

from spinline.base.errors import InputError
from spinline.jetprofile.ehd import NeedleSettings, StraightEhdJet
from spinline.jetprofile.ehd.whole_line import own_potential

PEO = peo_needle()
AT = np.array([3e-3, 5e-3, 10e-3, 20e-3, 40e-3])


@pytest.fixture(scope="module")
def two() -> tuple[StraightEhdJet, StraightEhdJet]:
    return tuple(StraightEhdJet(replace(PEO, log=log), length=0.1) for log in ("local", "slender"))


def _table() -> NeedleSettings:
    """Between a needle that is not there and a plate far away."""
    from spinline.jetprofile.ehd import TableField

    z = np.array([0.0, 0.05, 1.0])
    return replace(PEO, field=TableField(z, np.full(3, 6e4)), gap=1.0)


def test_a_uniform_line_is_the_closed_form_and_its_logarithm_is_that_of_both_distances() -> None:
    s = np.concatenate(([0.0], np.geomspace(0.01, 7900, 300)))
    radius = np.full(s.size, 0.3)
    settings = _table()
    gap = settings.applied_field.gap / settings.radius  # 8000
    found = own_potential(settings, s, radius) @ np.ones(s.size)
    mirror = np.arcsinh((2 * gap - s) / 0.3) - np.arcsinh((2 * gap - s - gap) / 0.3)
    exact = 0.5 * (
        np.arcsinh(s / 0.3) + np.arcsinh((gap - s) / 0.3) - mirror
    )  # constant from the last node to the plate
    assert np.abs(found[:-1] / exact[:-1] - 1).max() < 1e-9
    j = np.searchsorted(s, 100.0)
    slender = 0.5 * (np.log(4 * s[j] * (gap - s[j]) / 0.3**2) - np.log((2 * gap - s[j]) / (gap - s[j])))
    assert found[j] == pytest.approx(slender, abs=1e-5)


def test_a_line_that_varies_against_quadrature() -> None:
    from scipy.integrate import quad

    settings = _table()
    s = np.concatenate(([0.0], np.geomspace(0.05, 8000, 1600)))
    radius = 1 / np.sqrt(1 + 0.05 * s)
    matrix = own_potential(settings, s, radius)
    gap = settings.applied_field.gap / settings.radius

    def line(x: float) -> float:
        return np.sqrt(x) * np.exp(-x / 900)

    found = matrix @ line(s)

    def pull(x: float, at: float, r: float) -> float:
        return line(x) * (1 / np.hypot(x - at, r) - 1 / np.hypot(2 * gap - at - x, r))

    for j in (300, 700, 1100):
        at, r = s[j], radius[j]
        parts = np.concatenate(
            ([0.0], at - np.geomspace(0.99 * at, 1e-3, 12), [at], at + np.geomspace(1e-3, gap - at, 16))
        )
        total = sum(quad(pull, a, b, args=(at, r), epsabs=1e-9)[0] for a, b in pairwise(parts))
        assert found[j] == pytest.approx(0.5 * total, rel=2e-4)


def test_the_needle_answers_with_a_charge_that_keeps_it_at_no_potential() -> None:
    s = np.concatenate(([0.0], np.geomspace(0.05, 800, 200)))
    radius = np.full(s.size, 0.3)
    charge = np.sqrt(s)
    bare = own_potential(replace(PEO, field=_table().field, gap=0.1), s, radius) @ charge
    for field in ("hyperboloid", "needle"):
        answered = own_potential(replace(PEO, field=field), s, radius) @ charge
        assert abs(answered[0]) < 0.12 * bare[0]
        far = np.searchsorted(s, 400)
        assert 0.6 * bare[far] < answered[far] < bare[far]


def test_near_the_needle_the_whole_line_carries_more_charge_and_the_radius_hardly_moves(two) -> None:
    local, whole = two
    ratio = whole.line_charge(AT) / local.line_charge(AT)
    assert ratio == pytest.approx([1.334, 1.256, 1.173, 1.096, 0.996], abs=5e-3)
    assert np.abs(whole.radius(AT) / local.radius(AT) - 1)[:3].max() < 0.02
    assert whole.current / local.current == pytest.approx(1.087, abs=5e-3)


def test_the_jet_has_the_plates_potential_where_it_ends(two) -> None:
    """Total potential from the needle to the plate is the voltage: so all is conducted there, and the whole jet is pulled more.

    That of the local logarithm ends in the applied field, with a potential of its own.
    """
    local, whole = two
    z = np.concatenate(([0.0], np.geomspace(1e-8, 0.1, 40000)))
    falls = []
    for jet in two:
        field = jet.field_inside(z)
        falls.append(float((0.5 * (field[1:] + field[:-1]) * np.diff(z)).sum()))
    assert falls[1] == pytest.approx(PEO.voltage, rel=1e-4)
    assert falls[0] < 0.75 * PEO.voltage
    assert abs(float(whole.line_charge(0.1))) < 1e-12 * float(whole.line_charge(0.05))
    assert whole.tension(AT[:3]) / local.tension(AT[:3]) == pytest.approx([1.201, 1.192, 1.179], abs=5e-3)


def test_the_charge_found_is_that_of_the_potential(two) -> None:
    """lambda = 2 pi eps0 F r0 E_s; the field it makes, with the applied one, drives the conducted current."""
    _, whole = two
    x = PEO
    s = whole.solved.discrete.s
    keep = s * x.radius < 0.06
    charge = whole.line_charge(s * x.radius)
    psi = own_potential(x, s, whole.radius(s * x.radius) / x.radius) @ charge / (2 * np.pi * 8.8541878128e-12)
    inside = x.applied_field.axial(s * x.radius) - np.gradient(psi, s * x.radius)
    there = keep & (s > 25)
    conducted = np.pi * whole.radius(s * x.radius) ** 2 * x.conductivity * inside
    total = conducted + charge * whole.velocity(s * x.radius)
    assert total[there] / whole.current == pytest.approx(1.0, abs=0.02)


def test_what_it_cannot_do_is_said() -> None:
    with pytest.raises(InputError, match="cuts the line"):
        replace(PEO, log="slender", end=0.02)
