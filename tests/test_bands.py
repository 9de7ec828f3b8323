"""Bands of uncertain inputs: closed-form quantiles, places beyond the jet, figures, tables, overlays, fits."""

import json
import re
import warnings

import numpy as np
import pytest
from scipy import stats

from spinline.base.errors import SpinlineWarning
from spinline.report import html, words
from spinline.report.figures import figure
from spinline.scene import load_scene
from spinline.solve import run
from spinline.solve.bands import LEVELS, quantiles
from spinline.solve.uncertainty import certain, uncertain_inputs
from spinline.study.compare import compare
from spinline.study.trade import Trade


def quiet(*overrides, name="peo5-water"):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        return run(load_scene(name, overrides))


@pytest.mark.slow
def test_bands_of_one_input_are_the_curves_of_its_quantiles():
    """V grows with k everywhere: the quantile of every quantity is its value at the quantile of k."""
    result = quiet('jet.k="1.0 +/- 0.2"', "accuracy.draws=1024", "accuracy.points=60")
    assert result["quantile"].values.tolist() == list(LEVELS)
    for i, level in enumerate(LEVELS):
        there = quiet(f"jet.k={1 + 0.2 * stats.norm.ppf(level):.15g}", "accuracy.points=2000")
        for name, grows in (("radius", False), ("orientation", True), ("core_polymer_fraction", True)):
            row = i if grows else len(LEVELS) - 1 - i
            expected = np.interp(result["z"], there["z"], there[name])
            band = result[f"{name}_band"].values[row]
            np.testing.assert_allclose(band, expected, rtol=0.03, atol=2e-3 if grows else 0.0, err_msg=name)
    np.testing.assert_allclose(result["radius_band"][:, 0], 125e-6, rtol=1e-12)


def test_bands_are_not_straight_lines_where_the_model_is_not():
    """The orientation saturates at 1: the band is lopsided where +/- is not."""
    result = quiet('jet.k="1.0 +/- 0.2"')
    low, middle, high = result["end_orientation_band"].values[[0, 2, 4]]
    assert high <= 1
    assert middle - low > 3 * (high - middle)
    assert float(result["end_orientation"]) + 2 * float(result["end_orientation_std"]) > 1


def test_a_crossover_beyond_the_jet_counts():
    result = quiet('jet.k="0.95 +/- 0.1"')
    ends = result["crossover_position_band"].values
    reached = stats.norm.sf(((22.5095 * (5 / 0.125) ** (-0.94)) ** 0.5 - 0.95) / 0.1)
    said = float(re.search(r"reached in (\S+) %", result.attrs["warnings"])[1])
    assert said == pytest.approx(100 * reached, abs=2.5)
    assert np.isfinite(ends[:3]).all()
    assert np.isnan(ends[4])
    assert "above" in words(result)[-1]


def test_no_uncertainty_no_bands_and_none_if_none_are_wanted():
    for result in (quiet(), quiet('jet.k="1.0 +/- 0.1"', "accuracy.draws=0")):
        assert "quantile" not in result.dims
        assert not figure(result).axes[0].collections
    assert not uncertain_inputs(certain(load_scene("peo5-water", ['jet.k="1.0 +/- 0.1"'])))


def test_draws_that_make_no_scene_are_left_out_and_said():
    result = quiet('jet.beta="0.97 +/- 0.03"')
    assert "make no scene" in result.attrs["warnings"]
    assert np.isfinite(result["radius_band"]).all()


def test_bands_repeat_and_follow_the_seed():
    first, again, other = (quiet('jet.k="1.0 +/- 0.1"', f"accuracy.seed={seed}") for seed in (0, 0, 1))
    np.testing.assert_array_equal(first["radius_band"], again["radius_band"])
    assert (first["radius_band"] != other["radius_band"]).any()


def test_quantiles_of_what_is_known():
    values = np.array([[1.0, np.nan], [2.0, np.nan], [3.0, 4.0]])
    found = quantiles(values)
    np.testing.assert_allclose(found[:, 0], np.quantile([1.0, 2.0, 3.0], LEVELS))
    assert np.isnan(found[:, 1]).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "override"),
    [
        ("pvp-jetspin", 'solution.mass_fraction="2.5 +/- 0.1 wt%"'),
        ("peo5-fig37", 'jet.beta="0.47 +/- 0.01"'),
    ],
)
def test_every_kind_of_jet_has_bands_in_figure_report_and_table(scene, override, tmp_path):
    from spinline.solve.results import open_result, save, to_csv

    result = quiet(override, "accuracy.draws=16", name=scene)
    sheet = figure(result)
    for axis in sheet.axes[:4]:
        assert axis.collections
    again = open_result(save(result, tmp_path / "a.nc"))
    np.testing.assert_array_equal(again["radius_band"], result["radius_band"])
    header, *rows = to_csv(again, tmp_path / "a.csv").read_text().splitlines()
    assert "orientation_low95" in header
    assert len(rows) == result.sizes["element" if scene == "pvp-jetspin" else "z"]
    page = html(again)
    assert "<th>95 %</th>" in page
    assert "_std</code>" not in page


def test_compare_takes_maps_and_says_standard_uncertainties():
    one = quiet("accuracy.points=40", name="peo5-fig37")
    assert compare(one, one).same
    other = quiet("accuracy.points=40", 'jet.beta="0.46 +/- 0.01"', "accuracy.draws=4", name="peo5-fig37")
    found = compare(one, other)
    assert any(p.name == "polymer_fraction" for p in found.profiles)
    assert found.only_b == ()
    one_number = next(s for s in found.scalars if np.isfinite(s.sigmas))
    assert np.isnan(one_number.a_std)
    assert one_number.sigmas == pytest.approx(abs(one_number.a - one_number.b) / float(other[f"{one_number.name}_std"]))
    coarse = quiet("accuracy.points=40", "accuracy.shells=40", name="peo5-fig37")
    assert "polymer_fraction" in compare(one, coarse).not_compared
    assert compare(one, other).to_dict()["scalars"][0]["a_std"] is None


@pytest.mark.slow
def test_a_trade_is_asked_for_and_goes_with_the_result(spinline, tmp_path):
    from spinline.solve.results import open_result

    ran = spinline("run", "peo5-water", "--trade", "--quick", "--report", "r.html", "--no-figure")
    assert ran.code == 0, ran.err
    assert "measuring manifold" in ran.err
    assert re.search(
        "Measured: (affine|manifold)", ran.out
    )  # the faster of two that take milliseconds, as this machine has it
    result = open_result(tmp_path / "peo5-water.nc")
    measured = Trade.from_json(result.attrs["trade"])
    assert json.loads(measured.json()) == json.loads(result.attrs["trade"])
    assert [rung.model for rung in measured.rungs] == ["affine", "manifold"]
    page = (tmp_path / "r.html").read_text()
    assert page.count("<img") == 2
    assert "Not measured" not in page
    assert "Not measured" in html(quiet())
    assert spinline("run", "peo5-water", "--quick").code == 2
    ran = spinline("trade", "peo5-water", "--quick", "--report", "t.html")
    assert ran.code == 0, ran.err
    assert (tmp_path / "t.html").read_text().count("<img") == 2
    assert spinline("trade", "peo5-water", "--quick", "--report", "t.html").code == 2


def test_a_trade_measures_one_run_whatever_the_uncertainties():
    from spinline.study.trade import trade

    plain = trade(load_scene("peo5-water"), quick=True)
    uncertain = trade(load_scene("peo5-water", ['jet.k="1.0 +/- 0.1"']), quick=True)
    assert uncertain.rungs[0].errors == plain.rungs[0].errors
    assert uncertain.rungs[0].seconds < 5 * plain.rungs[0].seconds
