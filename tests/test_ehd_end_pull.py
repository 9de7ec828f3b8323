"""Two threads at the same settings: one that field and weight draw, one that only its end winds up."""

from dataclasses import replace

import numpy as np
import pytest

from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet
from spinline.jetprofile.ehd.boundary_value import interpolate, newton, remesh
from spinline.jetprofile.ehd.end_pull import LIMIT, end_pull
from spinline.jetprofile.ehd.solver import raise_pull, thins

# number 144 of the random settings (benchmarks/ehd_settings.py): 134 V, De = 107
TWO = NeedleSettings(
    radius=0.2583e-3,
    flow_rate=3.027e-9,
    voltage=133.7,
    gap=0.11157,
    conductivity=2.587e-4,
    surface_tension=0.06555,
    viscosity=4.618,
    density=830.4,
    permittivity=12.07,
    relaxation_time=1.9157,
    extensibility=115.44,
    log="constant",
    end=0.022313,
)


def _wound(settings: NeedleSettings):
    """Straight up the path of rising pull, at the long relaxation time."""
    path, _ = raise_pull(settings, charge=False, predicted=True)
    assert path.arrived
    return settings.problem(charge=False, predicted=True), path.solution


def test_the_thread_that_its_end_winds_up_passes_the_three_tests_and_needs_no_field() -> None:
    problem, found = _wound(TWO)
    s = remesh(found.s, found.y, 321)
    once = newton(problem, s, interpolate(found.s, found.y, s))
    mesh = np.sort(np.concatenate((s, 0.5 * (s[1:] + s[:-1]))))
    twice = newton(problem, mesh, interpolate(s, once.y, mesh))
    assert once.converged
    assert twice.converged
    assert thins(problem, twice)
    assert np.abs(twice.y[::2, 0] - once.y[:, 0]).max() < 0.01
    assert end_pull(problem, twice).share > 0.95
    # 5 V in place of 134 V: the same tension at the needle to 0.1 %
    assert _wound(replace(TWO, voltage=5.0))[1].y[0, 1] == pytest.approx(found.y[0, 1], rel=2e-3)
    # half the strain rate at the end: all but gone from the needle
    half = replace(TWO, end_factor=0.5)
    assert StraightEhdJet(half, length=0.02).solved.discrete.y[0, 1] < 0.02 * found.y[0, 1]


def test_the_thread_that_its_weight_draws_is_returned_and_named_held() -> None:
    jet = StraightEhdJet(TWO, length=TWO.end_position)
    assert abs(jet.end_pull.share) < 1e-4
    assert jet.current == pytest.approx(15.9e-9, rel=0.01)
    found = {one.name: one for one in jet.verdicts}
    assert found["end"].good
    assert not found["held"].good
    for factor in (0.5, 2.0):
        other = StraightEhdJet(replace(TWO, end_factor=factor), length=TWO.end_position)
        assert float(other.tension(0.0)) == pytest.approx(float(jet.tension(0.0)), rel=1e-5)


def test_the_share_is_what_goes_without_the_end() -> None:
    at = replace(TWO, voltage=6e3)
    jet = StraightEhdJet(at, length=at.end_position)
    slow = StraightEhdJet(replace(at, end_factor=0.01), length=at.end_position)
    gone = 1 - float(slow.tension(0.0)) / float(jet.tension(0.0))
    assert jet.end_pull.share == pytest.approx(gone, rel=2e-3)
    assert jet.end_pull.share > LIMIT
    assert not {one.name: one for one in jet.verdicts}["end"].good


def test_near_a_fold_a_jet_that_its_field_draws_is_not_taken_for_one_wound_up() -> None:
    near = NeedleSettings(
        radius=125e-6,
        flow_rate=3.2e-6 / 3600,
        voltage=6e3,
        gap=0.1,
        conductivity=0.01,
        viscosity=2.0,
        surface_tension=0.061,
        density=1000.0,
        permittivity=80.0,
        relaxation_time=17e-3,  # the branch folds at 17.15 ms
        law="oldroyd-b",
        log="constant",
        end=0.02,
    )
    jet = StraightEhdJet(near, length=0.02)
    assert 0.5 < jet.end_pull.share < 0.75  # its linear share is 9


@pytest.mark.slow
def test_where_only_the_end_pulls_the_scene_is_refused_by_name() -> None:
    with pytest.raises(NoSteadyJet, match="wound up") as caught:
        StraightEhdJet(replace(TWO, voltage=4e3))
    assert caught.value.reason == "end"
    assert caught.value.search == ""


@pytest.mark.slow
def test_a_neighbour_that_is_wound_up_is_no_start() -> None:
    jet = StraightEhdJet(replace(TWO, voltage=6e3), length=TWO.end_position)
    assert jet.end_pull.share > LIMIT
    assert StraightEhdJet(replace(TWO, voltage=2e3), near=jet, length=TWO.end_position).end_pull.share < 1e-3
