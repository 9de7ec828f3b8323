"""A fibre's diameter along one setting, 200 steps: what jumps is found by cutting the worst step in eight."""

from dataclasses import replace

import numpy as np
import pytest
from pan_recipe import PAN

from spinline.recipe import UNKNOWNS, Believed, Measurement, spun
from spinline.recipe.believe import believe
from spinline.recipe.library import CONDUCTIVITY
from spinline.recipe.model import normals
from spinline.recipe.predict import predict
from spinline.rheology.intrinsic import intrinsic_viscosity
from spinline.rheology.solvents import SOLVENTS, solvent_density

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
# polymer: two solvents; of the mixture nothing is given: neither viscosity nor conductivity, molar mass or humidity
MIXTURES = {"PCL": ("DCM", "DMF"), "PVP": ("water", "ethanol"), "PVDF": ("DMF", "acetone")}
EVEN = np.linspace(0, 1, 201)
_NEAR = np.append(0, np.geomspace(1e-9, 1e-2, 29))
#: 200 steps, and down to 1e-9 of a share at both ends and on both sides of equal parts.
SHARES = np.unique(np.concatenate([EVEN, _NEAR, 1 - _NEAR, 0.5 - _NEAR, 0.5 + _NEAR]))
STEEPEST = 3.0  # of ln d in a share: a factor of 20 from one pure solvent to the other, were it so all the way


def mixture_at(polymer, share, **given):
    """A recipe in two solvents, the second's share by mass."""
    both = zip(MIXTURES[polymer], (1 - share, share), strict=True)
    return replace(PAN, polymer=polymer, solvent={name: part for name, part in both if part > 0}, **given)


def of_mixtures(polymer, shares, rung, draws):
    """Ln d, (share, draw)."""
    believed = Believed.of([believe(mixture_at(polymer, x))[0] for x in shares])
    return spun(believed, normals(draws), rung=rung).log_diameter


def steepest(shares, log_d):
    """Largest slope between neighbours, over all columns."""
    return float((np.abs(np.diff(log_d, axis=0)).max(axis=1) / np.diff(shares)).max())


def recipe_at(name, value):
    """PEO in water with one setting of its own; in water and ethanol with viscosity, conductivity and humidity given."""
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
    if name in ("relative_humidity", "molar_mass") and rung == "terminal":
        assert whole == 0.0  # no drying in that law, and no viscosity
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


@pytest.mark.slow
@pytest.mark.parametrize("name", DRAWS)
def test_neither_median_nor_edges_of_the_envelope_jump(name):
    """Single threads may: one bends, its neighbour is pulled straight. What is printed moves as the share of them does."""
    found = log_diameters(name, SWEEPS[name], "envelope", DRAWS[name])
    edges = np.quantile(found, (0.16, 0.5, 0.84), axis=1).T
    assert 0 < worst_step(edges)[0] < 0.06


@pytest.mark.parametrize("polymer", MIXTURES)
def test_no_draw_median_or_edge_jumps_where_the_share_of_a_solvent_sweeps(polymer):
    log_d = of_mixtures(polymer, SHARES, "race", 128)
    edges = np.quantile(log_d, (0.16, 0.5, 0.84), axis=1).T
    assert 0.1 < steepest(SHARES, edges) <= steepest(SHARES, log_d) < STEEPEST
    # between the steps nothing hides: an eighth of the worst of them is an eighth of it
    whole, i, draw = worst_step(of_mixtures(polymer, EVEN, "race", 8))
    fine = of_mixtures(polymer, np.linspace(EVEN[i], EVEN[i + 1], 9), "race", 8)[:, draw]
    assert np.abs(np.diff(fine)).max() < 0.3 * whole


@pytest.mark.parametrize("where", [0.0, 0.5, 1 - 1e-9])
def test_a_jump_at_equal_parts_or_of_a_last_trace_would_be_found(where):
    log_d = of_mixtures("PCL", SHARES, "race", 8) + 1e-6 * (where < SHARES)[:, np.newaxis]
    assert steepest(SHARES, log_d) > STEEPEST
    assert steepest(SHARES, np.quantile(log_d, (0.16, 0.5, 0.84), axis=1).T) > STEEPEST


@pytest.mark.parametrize("polymer", MIXTURES)
def test_neither_median_nor_edges_of_the_envelope_jump_with_the_share(polymer):
    found = of_mixtures(polymer, EVEN, "envelope", 128)
    assert 0 < worst_step(np.quantile(found, (0.16, 0.5, 0.84), axis=1).T)[0] < 0.06


@pytest.mark.parametrize("polymer", ["PEO", "PAN", "PCL", "PVDF"])
def test_of_a_pure_solvent_is_believed_what_is_its_own(polymer):
    """Alone, and with a last trace of another beside it."""
    known = {"molar_mass": 150.0, "mass_fraction": 0.1, "usual_fraction": 0.1}
    for name in SOLVENTS:
        eta = intrinsic_viscosity(polymer, name, 150.0)
        own = np.hypot(0.3, 0.5 * np.log(eta.factor))
        ce = np.log(7 / eta.value / solvent_density(name, 296.15))
        weights = np.array([own**-2, 0.4**-2])
        coil = 0.1 / np.exp(weights @ [ce, np.log(0.1 / 2.6)] / weights.sum())
        prior = CONDUCTIVITY.get(name)
        other = "DMSO" if name == "water" else "water"
        for solvent in ({name: 1.0}, {name: 1 - 1e-14, other: 1e-14}):
            believed = believe(replace(PAN, polymer=polymer, solvent=solvent, **known))[0]
            assert believed.coil == pytest.approx(coil, rel=1e-12)
            assert believed.sd["entanglement_concentration"] == pytest.approx(weights.sum() ** -0.5, rel=1e-12)
            damp = 0.3 if name == "water" else 0.05
            assert believed.sd["evaporation"] == pytest.approx(np.hypot(0.3, damp), rel=1e-12)
            if prior is not None:
                assert believed.conductivity == pytest.approx(prior.median, rel=1e-12)
                assert believed.sd["conductivity"] == pytest.approx(prior.sd, rel=1e-12)


@pytest.mark.parametrize("polymer", MIXTURES)
@pytest.mark.parametrize("share", [0.3, 0.5])
def test_the_order_of_the_solvents_does_not_matter(polymer, share):
    one = mixture_at(polymer, share)
    turned = replace(one, solvent=dict(reversed(one.solvent.items())))
    first, second = (spun(believe(recipe)[0], normals(64)).log_diameter for recipe in (one, turned))
    np.testing.assert_allclose(second, first, rtol=0, atol=1e-12)
    assert predict(turned, shares=False).remarks == predict(one, shares=False).remarks


@pytest.mark.slow
def test_what_a_measured_fibre_says_fades_as_the_solvents_part():
    """At another voltage: what the laws miss at one setting is shared by that one setting only."""
    measured = [Measurement(mixture_at("PCL", 0.5, voltage=14e3), 4e-7)]
    shares = np.unique(np.concatenate([np.linspace(0, 1, 41), 0.5 - _NEAR, 0.5 + _NEAR]))
    logs = [np.log(predict(mixture_at("PCL", x), measured, draws=256, shares=False).fibre_diameter) for x in shares]
    assert steepest(shares, np.array(logs)[:, np.newaxis]) < STEEPEST


@pytest.mark.parametrize("share", [0.0, 0.01, 0.2])
def test_a_trace_of_water_is_not_spoken_of(share):
    """Neither as what keeps a jet wet in damp air, nor as what keeps pores away."""
    solvent = {"acetone": 1.0} if share == 0 else {"acetone": 1 - share, "water": share}
    recipe = replace(PAN, solvent=solvent)
    assert ("water dries ever more slowly" in said(recipe, 0.98)) == (share > 0.05)
    assert ("pores" in said(recipe, 0.4)) == (share < 0.05)


def said(recipe, humidity):
    """The remarks, in one."""
    return " ".join(predict(replace(recipe, relative_humidity=humidity), shares=False).remarks)


@pytest.mark.parametrize(
    ("solvent", "humidity", "wet"),
    [
        ({"water": 0.5, "ethanol": 0.5}, 0.85, True),
        ({"water": 0.2, "acetone": 0.8}, 0.5, True),
        ({"water": 0.5, "ethanol": 0.5}, 0.4, False),
        ({"water": 0.8, "ethanol": 0.2}, 0.85, False),
        ({"water": 0.5, "DMF": 0.5}, 0.85, False),  # slower than water
        ({"water": 1.0}, 0.85, False),
        ({"ethanol": 1.0}, 0.85, False),
    ],
)
def test_damp_air_on_water_beside_a_faster_solvent_is_said(solvent, humidity, wet):
    assert ("wets a jet" in said(replace(PAN, polymer="PVP", solvent=solvent), humidity)) == wet
