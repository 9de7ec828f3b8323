"""A reduced map against a scene: Figs. 36 and 37, and the likelihood."""

import json

import numpy as np
import pytest
import xarray as xr
from scipy import stats

from spinline.base.errors import InputError, SpinlineWarning
from spinline.fit.observations import Observation
from spinline.fit.overlay import compare_theory, theory_words
from spinline.fit.scene_model import forward_model
from spinline.report.overlay_figure import overlay_figure
from spinline.scene import load_scene

pytestmark = pytest.mark.filterwarnings("ignore:map. mean and core of a row:spinline.SpinlineWarning")

SHELLS = 8
EDGES = np.linspace(0, 1, SHELLS + 1)


def simulated(noise=1.0, rows=60, scene="peo5-water"):
    """A map of a scene, rings averaged by brute force."""
    model = forward_model(load_scene(scene))
    z = np.linspace(1e-4, 4.2e-3, rows)
    seen = model.predict(z)
    fine = np.sqrt((np.arange(4000) + 0.5) / 4000)  # equal areas
    local = np.where(fine < seen.core_radius_ratio[:, None], seen.core[:, None], 0.0)
    ring = np.digitize(fine, EDGES) - 1
    fraction = np.stack([local[:, ring == i].mean(axis=1) for i in range(SHELLS)], axis=1)
    rng = np.random.default_rng(6)
    std = 0.02
    data = {
        "polymer_fraction": (("row", "shell"), fraction + noise * std * rng.standard_normal(fraction.shape)),
        "polymer_fraction_std": (("row", "shell"), np.full(fraction.shape, std)),
        "mean_polymer_fraction": ("row", seen.mean + noise * 0.004 * rng.standard_normal(rows)),
        "mean_polymer_fraction_std": ("row", np.full(rows, 0.004)),
        "jet_radius": ("row", seen.radius + noise * 5e-7 * rng.standard_normal(rows), {"units": "m"}),
        "jet_radius_std": ("row", np.full(rows, 5e-7)),
    }
    return xr.Dataset(data, {"z": ("row", z, {"units": "m"}), "shell": 0.5 * (EDGES[1:] + EDGES[:-1])})


def test_theory_meets_a_map_made_by_brute_force():
    result = compare_theory(load_scene("peo5-water"), simulated(noise=0.0))
    np.testing.assert_allclose(result["core_measured"], result["core_predicted"], rtol=0.02, atol=1e-3)
    np.testing.assert_allclose(result["relative_change"], result["relative_change_predicted"], atol=0.15)
    assert result.attrs["crossover_radius_ratio"] == pytest.approx(np.sqrt(0.0444256), rel=1e-5)


def test_figure_36_does_not_need_the_profile():
    """Against r/r_0 the affine curve is one and the same for any k and beta."""
    one = compare_theory(load_scene("peo5-water"), simulated())
    with pytest.warns(SpinlineWarning):
        other = compare_theory(load_scene("peo5-water", ["jet.k=0.8", "jet.beta=0.55"]), simulated())
    np.testing.assert_array_equal(one["curve_core"], other["curve_core"])
    at = 0.3
    phi = 0.0444256103
    v = at**-2
    core = phi * ((np.cosh(3 * phi * v) + 2 * np.cosh(3 * phi)) / np.sinh(3 * phi) * phi) ** 2
    assert np.interp(-at, -one["curve_radius_ratio"], one["curve_local"]) == pytest.approx(core, rel=1e-3)


def test_likelihood_prefers_the_truth_by_what_chi_squared_says():
    data = simulated()
    right = compare_theory(load_scene("peo5-water"), data)
    with pytest.warns(SpinlineWarning, match="does not describe the map"):
        wrong = compare_theory(load_scene("peo5-water", ["jet.k=0.93"]), data)
    gain = right.attrs["log_likelihood"] - wrong.attrs["log_likelihood"]
    assert gain > 50
    difference = float(wrong["chi_squared"].sum() - right["chi_squared"].sum())
    assert gain == pytest.approx(difference / 2, rel=1e-9)
    for i in range(3):
        chi2, count = float(right["chi_squared"][i]), int(right["count"][i])
        assert stats.chi2.ppf(1e-4, count) < chi2 < stats.chi2.ppf(1 - 1e-4, count)
    assert abs(float(right["mean_residual"][2])) < 4
    assert "log-likelihood" in theory_words(right)[-1]


def test_parameters_of_a_fit_replace_the_scenes():
    data = simulated()
    moved = compare_theory(load_scene("peo5-water", ["jet.k=0.8"]), data, values={"k": 1.0})
    assert moved.attrs["log_likelihood"] == pytest.approx(
        compare_theory(load_scene("peo5-water"), data).attrs["log_likelihood"]
    )


def test_sections_where_they_are_asked_for():
    result = compare_theory(load_scene("peo5-water"), simulated(), places=[1e-3, 3e-3])
    assert result.sizes["place"] == 2
    assert result["place_z"].values == pytest.approx([1e-3, 3e-3], abs=1.1e-4)
    with pytest.raises(InputError, match="places"):
        compare_theory(load_scene("peo5-water"), simulated(), places=[1.0])


def test_a_map_longer_than_the_jet_is_refused():
    with pytest.raises(InputError, match="beyond the jet"):
        compare_theory(load_scene("peo5-water", ["jet.length=2 mm"]), simulated())


def test_figure_and_command(spinline, tmp_path):
    data = simulated()
    data.to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    ran = spinline("compare-theory", "peo5-water", "map.nc", "--at", "2 mm")
    assert ran.code == 0
    assert "log-likelihood" in ran.out
    assert (tmp_path / "map-theory.png").read_bytes().startswith(b"\x89PNG")
    assert spinline("compare-theory", "peo5-water", "map.nc").code == 2
    again = spinline("compare-theory", "peo5-water", "map.nc", "--force", "--json", "--no-figure")
    assert json.loads(again.out)["attributes"]["log_likelihood"] > 0
    sheet = overlay_figure(compare_theory(load_scene("peo5-water"), data))
    assert len(sheet.axes) == 2
    assert spinline("compare-theory", "peo5-water", "none.nc").code == 2


@pytest.mark.slow
def test_bands_are_of_the_inputs_or_of_the_fit(spinline, tmp_path):
    data = simulated()
    plain = compare_theory(load_scene("peo5-water"), data)
    assert "quantile" not in plain.dims
    scene = load_scene("peo5-water", ['solution.mass_fraction="5 +/- 0.2 wt%"'])
    result = compare_theory(scene, data)
    assert result.attrs["bands"].startswith("68 and 95 % of 128 draws of the scene")
    # r_S/r_0 = phi^(1/2): half the relative uncertainty of phi, a little more than that of the mass fraction
    ends = result["crossover_radius_ratio_band"].values
    assert (ends[3] - ends[1]) / 2 / ends[2] == pytest.approx(0.02, rel=0.05)
    for name in ("core_predicted", "curve_core", "relative_change_predicted"):
        band = result[f"{name.removesuffix('_predicted') if 'change' in name else name}_band"]
        assert (band.isel(quantile=0) <= result[name] + 1e-9).all()
        assert (band.isel(quantile=4) >= result[name] - 1e-9).all()
    overlay_figure(result)
    data.to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    assert spinline("fit", "peo5-simulated").code == 0
    ran = spinline("compare-theory", "peo5-water", "map.nc", "--fit", "peo5-simulated.nc", "--json")
    assert ran.code == 0, ran.err
    assert "draws of the fit" in ran.json["attributes"]["bands"]


def test_rings_of_a_map_can_be_fitted():
    from spinline.fit.least_squares import fit
    from spinline.fit.observed_map import read_map
    from spinline.fit.problem import FitProblem, Prior

    data = tuple(read_map(simulated(), ["radius", "shell"]))
    assert isinstance(data[1], Observation)
    model = forward_model(load_scene("peo5-water"))
    with pytest.warns(SpinlineWarning, match="independent"):
        found = fit(FitProblem(model, data, {"k": Prior(0.9), "beta": Prior(0.5), "volume_fraction": Prior(0.05)}))
    for name, truth in (("k", 1.0), ("beta", 0.47), ("volume_fraction", 0.0444256)):
        assert abs(found.values[name] - truth) < 4 * found.std[name], name
