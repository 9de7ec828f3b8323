"""What measured fibres say of another one, against Bayes' rule by weighing draws, and normal quantities by least squares."""

from dataclasses import replace

import numpy as np
import pytest
from pan_recipe import PAN

from spinline.base.errors import InputError
from spinline.recipe import UNKNOWNS, Believed, Measurement, load_recipe
from spinline.recipe.believe import believe
from spinline.recipe.measured import Known, materials_in_common, shared, slopes
from spinline.recipe.model import OF_MATERIALS, normals, scatter, sensitivities, spun
from spinline.recipe.predict import predict

OTHER = replace(PAN, voltage=20e3, mass_fraction=1.2 * PAN.mass_fraction, usual_fraction=PAN.mass_fraction)
KNOWN = replace(PAN, usual_fraction=PAN.mass_fraction)
IN_TWO = [replace(KNOWN, solvent=solvent) for solvent in ({"DMF": 1.0}, {"DMF": 0.6, "DMSO": 0.4}, {"DMSO": 1.0})]
IN_TWO += [replace(IN_TWO[1], molar_mass=np.float64("nan"), spread={"current": 0.1}), replace(IN_TWO[1], polymer="PVP")]


def chances(recipe, measured, diameters, draws=80_000):
    """Of fibres thinner than some, by Bayes' rule: draws of everything, weighed by how likely the measured fibres are."""
    recipes = [recipe, *(one.recipe for one in measured)]
    rng, normal = np.random.default_rng(3), np.empty((len(recipes), draws, len(UNKNOWNS)))
    for i, part in enumerate(shared(recipes)):
        normal[:, :, i] = part.vectors @ rng.standard_normal((part.vectors.shape[1], draws))
    log_d = [spun(believe(one)[0], z, steps=12).log_diameter for one, z in zip(recipes, normal, strict=True)]
    log_p = sum(-0.5 * ((np.log(one.diameter) - y) / one.sd) ** 2 for one, y in zip(measured, log_d[1:], strict=True))
    weight = np.exp(log_p - log_p.max())
    assert weight.sum() ** 2 / (weight**2).sum() > 500
    return [float(weight[log_d[0] < np.log(d)].sum() / weight.sum()) for d in diameters]


@pytest.mark.parametrize(
    ("measured", "off"),
    [
        ([Measurement(KNOWN, 3e-7)], 0.035),
        ([Measurement(KNOWN, 1.2e-6)], 0.065),  # nearly three times what is expected, where ln d is less linear
        ([Measurement(KNOWN, 3e-7, 0.2), Measurement(IN_TWO[1], 3.5e-7, 0.2)], 0.035),
        ([Measurement(IN_TWO[2], 4e-7, 0.2), Measurement(IN_TWO[2], 4e-7, 0.2)], 0.035),
    ],
    ids=["one", "one that surprises", "two", "two in another solvent"],
)
def test_what_is_measured_is_weighed_as_by_bayes(measured, off):
    found = predict(OTHER, measured, shares=False)
    (low95, high95), (low, high) = found.fibre_diameter_95, found.fibre_diameter_68
    below = chances(OTHER, measured, (low95, low, found.fibre_diameter, high, high95))
    assert below == pytest.approx((0.025, 0.16, 0.5, 0.84, 0.975), abs=off)


def test_chance_of_the_draws_is_small():
    """The same answer, about, from other draws."""
    measured = [Measurement(KNOWN, 5e-7), Measurement(IN_TWO[2], 3e-7), Measurement(IN_TWO[2], 3.5e-7)]
    found = [np.log(predict(OTHER, measured, draws=n, shares=False).fibre_diameter) for n in range(2001, 2013)]
    assert np.std(found) < 0.02


@pytest.mark.parametrize("off", [0.0, 2.0, 7.0, 30.0])
@pytest.mark.parametrize("many", [1, 40])
def test_the_unevenness_is_that_of_bayes_however_far_the_fibres_are(off, many):
    """Beyond the last two hundredth of laboratories all had been alike: fibres off by a thousand missed by 0.1 in chance."""
    known, sd = Known(np.eye(many + 1), 0.1 * np.eye(many + 1), 0.7), 0.7
    u = np.linspace(-12, 12, 200_001)
    variance = 1.0 + 0.1 * np.exp(2 * sd * u)
    log_p = -0.5 * u**2 - 0.5 * many * (off**2 / variance + np.log(variance))
    chance = np.cumsum(np.exp(log_p - log_p.max()))
    z = normals(2048)[:, 0]
    found = known.uneven(z, np.full(many, off))
    levels = (0.025, 0.16, 0.5, 0.84, 0.975)
    below = np.interp(np.quantile(found, levels), u, chance / chance[-1])
    assert below == pytest.approx(levels, abs=0.004)


def test_materials_in_common_are_the_cosine_of_the_solvents():
    pure, other = (replace(KNOWN, solvent={name: 1.0}) for name in ("DMF", "acetone"))
    half = replace(KNOWN, solvent={"acetone": 0.5, "DMF": 0.5})
    found = materials_in_common([half, half, other, pure, replace(half, polymer="PLA")])
    part = 0.5**0.5
    expected = [
        [1, 1, part, part, 0],
        [1, 1, part, part, 0],
        [part, part, 1, 0, 0],
        [part, part, 0, 1, 0],
        [0, 0, 0, 0, 1],
    ]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)


def test_recipes_of_a_laboratory_draw_what_they_share():
    """Every two of them, the measured ones among themselves too; a mat of the same setting shares all but the repeat."""
    z = normals(8192)
    for i, (name, part) in enumerate(zip(UNKNOWNS, shared(IN_TWO), strict=True)):
        drawn = part.drawn(z[:, i], i)
        np.testing.assert_array_equal(drawn[0], z[:, i])
        np.testing.assert_allclose(np.corrcoef(drawn), part.correlations, rtol=0, atol=0.04)
        np.testing.assert_allclose(drawn.std(axis=1), 1.0, rtol=0, atol=0.03)
        wanted = part.correlations[1, 2], part.correlations[1, 3], part.correlations[1, 4]
        if name in OF_MATERIALS:
            assert wanted == pytest.approx((0.4 / np.hypot(0.6, 0.4), 1.0, 0.0))
        else:
            assert wanted == pytest.approx({"repeat": (0, 0, 0), "setting": (0, 1, 0)}.get(name, (1, 1, 1)), abs=1e-15)


@pytest.mark.parametrize("uneven", [-1.0, 0.0, 2.0])
def test_the_gain_is_that_of_normal_quantities(uneven):
    """Against many draws by least squares."""
    common, error, n = shared(IN_TWO), np.array([0.0, 0.1, 0.2, 0.05]), 200_000
    change = sensitivities(Believed.of([believe(one)[0] for one in IN_TWO]))
    rng, drawn = np.random.default_rng(5), np.zeros((len(IN_TWO), n))
    for name, g, part in zip(UNKNOWNS, change, common, strict=True):
        size = np.exp(0.7 * uneven) if name in ("setting", "repeat") else 1.0
        drawn += size * g[:, np.newaxis] * (part.vectors @ rng.standard_normal((part.vectors.shape[1], n)))
    seen = drawn[1:] + error[:, np.newaxis] * rng.standard_normal((len(error), n))
    wanted = np.linalg.lstsq(seen.T, drawn[0], rcond=None)[0]
    found = Known.of(change, common, error, 0.7).gain(np.array([uneven]))[0]
    np.testing.assert_allclose(found, wanted, rtol=0, atol=0.01)


def test_mean_changes_are_covariances():
    """Of ln d with each unknown, by draws."""
    believed = believe(KNOWN)[0]
    z = normals(50_000).copy()
    z[:, list(UNKNOWNS).index("unevenness")] = 0.0
    log_d = spun(believed, z).log_diameter - scatter(believed, z)
    change = slopes(Believed.of([believed]))[:, 0]
    steady = [i for i, name in enumerate(UNKNOWNS) if name not in ("setting", "repeat", "unevenness")]
    np.testing.assert_allclose((z.T @ log_d / len(z))[steady], change[steady], rtol=0, atol=0.02)
    assert change[list(UNKNOWNS).index("unevenness")] == pytest.approx(0.0, abs=0.01)


def test_a_fibre_as_expected_says_that_the_laboratory_is_even_and_another_that_it_is_not():
    known = Known(np.array([[1.0, 0.6], [0.6, 1.0]]), 0.3 * np.eye(2), 0.7)
    z = normals(512)[:, 0]
    means = [known.uneven(z, np.array([off])).mean() for off in (0.0, 1.0, 3.0, 30.0)]
    assert means[0] < means[1] < means[2] < means[3]
    assert means[0] < 0
    np.testing.assert_allclose(Known(known.steady, 0 * known.scattered, 0.7).uneven(z, np.array([2.0])), z, atol=0.03)


def edges(recipe, measured):
    found = predict(recipe, measured, draws=256, shares=False)
    return np.log([*found.fibre_diameter_95, *found.fibre_diameter_68, found.fibre_diameter])


NEAR = {
    "voltage": lambda x: {"voltage": PAN.voltage * x},
    "gap": lambda x: {"gap": PAN.gap * x},
    "flow_rate": lambda x: {"flow_rate": PAN.flow_rate * x},
    "mass_fraction": lambda x: {"mass_fraction": PAN.mass_fraction * x},
    "relative_humidity": lambda x: {"relative_humidity": 0.4 * x},
    "temperature": lambda x: {"temperature": 296.0 * x},
    "a trace of a solvent": lambda x: {"solvent": {"DMF": 2 - x, "acetone": x - 1} if x > 1 else {"DMF": 1.0}},
}


@pytest.mark.parametrize("more", [0, 1], ids=["one", "two"])
@pytest.mark.parametrize("name", NEAR)
def test_nothing_jumps_where_a_setting_comes_upon_the_measured_one(name, more):
    """What one setting shares with itself had been lost at once beside it: up to a fifth of the edges."""
    here = replace(KNOWN, relative_humidity=0.4, temperature=296.0)
    measured = [Measurement(here, 6e-7), Measurement(replace(here, voltage=12e3, solvent={"DMSO": 1.0}), 3e-7)][
        : 1 + more
    ]
    own, beside, off = (edges(replace(here, **NEAR[name](x)), measured) for x in (1.0, 1.0 + 1e-6, 1.3))
    np.testing.assert_allclose(beside, own, rtol=0, atol=1e-4)
    assert np.abs(off - own).max() > 0.01


def test_a_measured_fibre_is_spun_about_the_fraction_that_the_recipe_says():
    """Where the recipe said one and the measured fibre none, they had stood apart as two laboratories' would."""
    said, silent = (Measurement(replace(KNOWN, usual_fraction=u), 3e-7) for u in (KNOWN.usual_fraction, np.nan))
    assert predict(OTHER, [silent], shares=False) == predict(OTHER, [said], shares=False)


def test_settings_share_less_the_farther_they_are():
    recipes = [replace(KNOWN, voltage=KNOWN.voltage * np.exp(x)) for x in (0.0, 0.0, 0.05, 0.1, 1.0)]
    recipes += [replace(KNOWN, polymer="PVP"), replace(KNOWN, molar_mass=150.0)]
    part = shared(recipes)[list(UNKNOWNS).index("setting")]
    expected = [1, 1, np.exp(-0.125), np.exp(-0.5), 0, 0, 0]
    np.testing.assert_allclose(part.correlations[0], expected, rtol=0, atol=1e-9)
    np.testing.assert_allclose(part.correlations[2, 3], np.exp(-0.125), rtol=0, atol=1e-9)
    np.testing.assert_allclose(np.diag(part.correlations), 1.0, rtol=0, atol=1e-9)


@pytest.mark.parametrize("shift", [0.5, 3.1])
def test_a_measured_fibre_outweighs_how_far_a_chain_of_beads_is_off(monkeypatch, shift):
    """Of a chain that lies 22 times too thick a fibre of 320 nm had been "4.3 standard deviations" off: 3288 nm."""
    from spinline.recipe import predict as module

    monkeypatch.setattr(module, "_spun_by_beads", lambda _: (("beads",), shift, np.log(22.0)))
    measured = [Measurement(KNOWN, 3.2e-7)]
    alone = predict(OTHER, shares=False)
    known = predict(OTHER, measured, shares=False)
    chain = predict(OTHER, rung="lagrangian", shares=False)
    assert chain.fibre_diameter == pytest.approx(np.exp(shift) * alone.fibre_diameter)
    found = predict(OTHER, measured, rung="lagrangian", shares=False)
    assert found.fibre_diameter == pytest.approx(known.fibre_diameter, rel=0.1)
    assert "measured" not in " ".join(found.remarks)


def remarks(measured, recipe=OTHER):
    return " ".join(predict(recipe, measured, shares=False).remarks)


def test_measured_fibres_that_contradict_one_another_are_said():
    assert "other measured ones" in remarks([Measurement(KNOWN, 1e-7), Measurement(KNOWN, 1.2e-6)])
    for alike in ([Measurement(KNOWN, 2.5e-7), Measurement(KNOWN, 4e-7)], [Measurement(KNOWN, 3e-7)] * 5):
        assert "measured" not in remarks(alike)
    assert "other measured ones" not in remarks([Measurement(KNOWN, 1e-4)])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"voltage": 12.0}, "12 V is out of"),
        ({"flow_rate": 3e-7}, "mL/hour is out of"),
        ({"gap": 15.0}, "a gap of"),
        ({"mass_fraction": 0.95}, "no solution that flows"),
        ({"mass_fraction": 1e-6}, "holds no jet together"),
    ],
)
def test_settings_of_a_measured_fibre_that_no_line_has_are_said(changes, words):
    said = remarks([Measurement(replace(KNOWN, **changes), 3e-7)])
    assert "a measured fibre's settings" in said
    assert words in said


def test_a_wide_spread_is_said_and_an_impossible_one_refused():
    assert "wider than itself" in remarks([Measurement(KNOWN, 3e-7, 1.5)])
    assert "wider than itself" not in remarks([Measurement(KNOWN, 3e-7, 0.3)])
    for sd in (float("nan"), -0.1, 1e200):
        with pytest.raises(InputError, match=r"measured\.fibre_diameter"):
            predict(OTHER, [Measurement(KNOWN, 3e-7, sd)], shares=False)


TRIAL = """
[solution]
polymer = "PAN"
solvent = "DMF"
concentration = "10 wt%"
viscosity = "0.9 +/- 0.1 Pa s"
[jet]
voltage = "15 kV"
gap = "15 cm"
flow_rate = "1 mL/hour"
current = "250 +/- 50 nA"
[measured]
fibre_diameter = "320 +/- 20 nm"
"""


def measurement(folder, text):
    file = folder / "trial.toml"
    file.write_text(TRIAL + text, "utf-8")
    return load_recipe(file).measurements()[0]


def test_what_was_given_at_the_recipes_settings_follows_the_laws_to_others(tmp_path):
    """A viscosity at 10 wt% is none at 8; half of the flow takes no whole current (fibres of 518 nm for 463)."""
    own = measurement(tmp_path, "").recipe
    assert (own.viscosity, own.current) == (0.9, pytest.approx(250e-9))
    thin = measurement(tmp_path, 'concentration = "8 wt%"').recipe
    believed = [believe(replace(own, viscosity=np.nan, mass_fraction=w, usual_fraction=0.1))[0] for w in (0.08, 0.1)]
    laws = [float(spun(b, np.zeros((1, len(UNKNOWNS)))).viscosity[0]) for b in believed]
    assert thin.viscosity == pytest.approx(0.9 * laws[0] / laws[1])
    assert 0.2 < thin.viscosity < 0.5
    assert thin.current == pytest.approx(250e-9)
    slow = measurement(tmp_path, 'flow_rate = "0.5 mL/h"').recipe
    assert (slow.viscosity, slow.current) == (pytest.approx(0.9), pytest.approx(250e-9 * 0.5 ** (2 / 3)))


def test_what_was_measured_beside_a_fibre_is_taken_as_it_is(tmp_path):
    said = 'concentration = "8 wt%"\nviscosity = "0.4 +/- 0.2 Pa s"\ncurrent = "100 nA"'
    found = measurement(tmp_path, said).recipe
    assert (found.viscosity, found.current) == (0.4, pytest.approx(100e-9))
    assert set(found.spread) == {"viscosity"}
    assert found.spread["viscosity"] == pytest.approx(np.sqrt(np.log(1.25)))


def test_a_spread_beyond_all_is_no_fault(tmp_path):
    """It had ended in an overflow."""
    assert measurement(tmp_path, "").sd == pytest.approx(np.sqrt(np.log1p((20 / 320) ** 2)))
    file = tmp_path / "wide.toml"
    for wide in ("1e8", "1e13", "1e300"):
        file.write_text(TRIAL.replace("320 +/- 20", f"320 +/- {wide}"), "utf-8")
        sd = load_recipe(file).measurements()[0].sd
        assert sd == pytest.approx(np.sqrt(np.logaddexp(0, 2 * np.log(float(wide) / 320))))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("voltage", -1e4),
        ("voltage", float("nan")),
        ("voltage", "15 kV"),
        ("gap", 0.0),
        ("flow_rate", float("inf")),
        ("mass_fraction", 0.0),
        ("mass_fraction", 12.0),
        ("usual_fraction", 1.5),
        ("relative_humidity", 45.0),
        ("viscosity", -1.0),
        ("needle_radius", 0.0),
        ("current", float("inf")),
    ],
)
def test_recipes_from_python_that_cannot_be_are_refused_by_their_field(name, value):
    """They had been a charge density that is not finite, or a division by zero."""
    wrong = replace(KNOWN, **{name: value})
    with pytest.raises(InputError, match=name):
        predict(wrong, shares=False)
    if name != "usual_fraction":  # that is the recipe's
        with pytest.raises(InputError, match=name):
            predict(KNOWN, [Measurement(wrong, 3e-7)], shares=False)


@pytest.mark.parametrize("draws", [-1, 0, 1, 99, float("nan")])
def test_draws_too_few_for_an_interval_are_refused(draws):
    with pytest.raises(InputError, match="draws"):
        predict(KNOWN, draws=draws)
