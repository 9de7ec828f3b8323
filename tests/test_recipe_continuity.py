"""A fibre's diameter along one setting, 200 steps: what jumps is found by cutting the worst step in eight."""

from dataclasses import replace

import numpy as np
import pytest
from pan_recipe import PAN

from spinline.recipe import UNKNOWNS, Believed, spun
from spinline.recipe.believe import believe
from spinline.recipe.predict import normals

PEO = replace(PAN, polymer="PEO", solvent={"water": 1.0}, mass_fraction=0.04, usual_fraction=0.04)
SWEEPS = {
    "mass_fraction": np.geomspace(0.02, 0.4, 201),
    "voltage": np.geomspace(3e3, 6e4, 201),
    "flow_rate": np.geomspace(1e-11, 1e-8, 201),
    "gap": np.geomspace(2e-2, 0.5, 201),
    "relative_humidity": np.linspace(0, 1, 201),
    "molar_mass": np.geomspace(20, 3000, 201),
    "temperature": np.linspace(278, 330, 201),
    "share of ethanol": np.linspace(0, 1, 201),
}


def recipe_at(name, value):
    """PEO in water with one setting of its own; in water and ethanol with what the chain takes of the main solvent given."""
    if name != "share of ethanol":
        return replace(PEO, **{name: value})
    solvent = {n: share for n, share in (("water", 1 - value), ("ethanol", value)) if share > 0}
    return replace(PEO, solvent=solvent, viscosity=1.0, conductivity=1e-3, relative_humidity=0.45)


def log_diameters(name, values, rung, draws):
    """Ln d, (value, draw)."""
    recipes = [recipe_at(name, float(v)) for v in values]
    return spun(Believed.of([believe(r)[0] for r in recipes]), normals(draws), rung=rung).log_diameter


def worst_step(log_d):
    """Largest step between neighbours: its size, where, of which column."""
    steps = np.abs(np.diff(log_d, axis=0))
    i, k = np.unravel_index(np.argmax(steps), steps.shape)
    return float(steps[i, k]), int(i), int(k)


@pytest.mark.parametrize("rung", ["race", "terminal"])
@pytest.mark.parametrize("name", SWEEPS)
def test_no_draw_jumps_where_a_setting_sweeps(name, rung):
    """A smooth function's step over an eighth is an eighth; a jump's is all of it, however fine the steps."""
    values = SWEEPS[name]
    whole, i, draw = worst_step(log_diameters(name, values, rung, 8))
    if name == "relative_humidity" and rung == "terminal":
        assert whole == 0.0  # no drying in that law
        return
    fine = log_diameters(name, np.linspace(values[i], values[i + 1], 9), rung, 8)[:, draw]
    assert 0 < whole < 0.1
    assert np.abs(np.diff(fine)).max() < 0.3 * whole


@pytest.mark.parametrize("rung", ["race", "envelope"])
def test_a_trace_of_another_solvent_is_none(rung):
    """From either end; and the damp that holds water back is nothing to ethanol."""
    ends = log_diameters("share of ethanol", np.array([0.0, 1e-9, 1 - 1e-9, 1.0]), rung, 8)
    assert np.abs(ends[1] - ends[0]).max() < 1e-6
    assert np.abs(ends[3] - ends[2]).max() < 1e-6
    dry, damp = (
        spun(believe(replace(recipe_at("share of ethanol", 1.0), relative_humidity=h))[0], normals(8), rung=rung)
        for h in (0.1, 0.9)
    )
    assert (dry.log_diameter == damp.log_diameter).all()


@pytest.mark.parametrize("rung", ["race", "envelope"])
def test_a_little_water_that_damp_air_keeps_does_not_hold_up_the_rest(rung):
    """Until all is gone takes three times as long; the fibre is that of the ethanol."""
    pure, drop, soaked = (
        believe(replace(recipe_at("share of ethanol", x), relative_humidity=h, surface_tension=0.025))[0]
        for x, h in ((1.0, 0.97), (0.98, 0.97), (0.98, 1.0))
    )
    assert drop.evaporation < 0.4 * pure.evaporation
    logs = [float(spun(b, np.zeros((1, len(UNKNOWNS))), rung=rung).log_diameter[0]) for b in (pure, drop, soaked)]
    assert logs[1] == pytest.approx(logs[0], abs=0.02)
    assert logs[2] == logs[1]


def test_a_jump_would_be_found():
    values = SWEEPS["voltage"]
    jump = log_diameters("voltage", values, "race", 8) + 0.05 * (values > 15e3)[:, np.newaxis]
    whole, i, draw = worst_step(jump)
    fine = np.linspace(values[i], values[i + 1], 9)
    again = log_diameters("voltage", fine, "race", 8)[:, draw] + 0.05 * (fine > 15e3)
    assert np.abs(np.diff(again)).max() > 0.3 * whole


# draws: below 4 kV, where threads begin to be pulled straight, 128 leave gaps of a tenth at the edge, 512 of 0.03, 2048 of 0.017
DRAWS = {
    "mass_fraction": 128,
    "voltage": 512,
    "flow_rate": 128,
    "gap": 128,
    "relative_humidity": 128,
    "molar_mass": 128,
    "share of ethanol": 128,
}


@pytest.mark.parametrize("name", DRAWS)
def test_neither_median_nor_edges_of_the_envelope_jump(name):
    """Single threads may: one bends, its neighbour is pulled straight. What is printed moves as the share of them does."""
    found = log_diameters(name, SWEEPS[name], "envelope", DRAWS[name])
    edges = np.quantile(found, (0.16, 0.5, 0.84), axis=1).T
    assert 0 < worst_step(edges)[0] < 0.06
