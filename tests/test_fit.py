"""Inference: exact cases, what is open, what is refused, and whether the intervals cover."""

import dataclasses
import importlib.util
import json
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from spinline.base.errors import InputError, SpinlineWarning
from spinline.fit.diagnostics import compare_with_prior, curvature, open_directions, open_parameters, prior_dominated
from spinline.fit.fit_file import bundled_fits, load_fit, scene_priors
from spinline.fit.least_squares import fit, log_likelihood
from spinline.fit.model import ForwardModel
from spinline.fit.observations import Observation
from spinline.fit.output import fit_dataset, fit_json, fit_words
from spinline.fit.posterior import bands, gaussian_draws, sample
from spinline.fit.problem import FitProblem, Prior
from spinline.jetprofile.fit import fit_power_law
from spinline.scene import load_scene

ROOT = Path(__file__).parents[1]


def coverage_module():
    spec = importlib.util.spec_from_file_location("coverage_fit", ROOT / "benchmarks" / "coverage_fit.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


VALUES = coverage_module().VALUES
MODEL = ForwardModel("power-law", VALUES, 5e-3)
TRUTH = {"k": 0.9, "beta": 0.5, "volume_fraction": 0.045, "fraction_scale": 1.04, "origin": 4e-5}


def blank(kind, count, std, end=4.5e-3):
    z = np.linspace(1e-4, end, count)
    return Observation(kind, z, np.full(count, 1e-4 if kind == "radius" else 0.05), np.full(count, std))


def problem(free=None, data=None, model=MODEL, **options):
    free = free or {name: Prior(VALUES[name]) for name in TRUTH}
    data = data or (blank("radius", 60, 1e-6), blank("mean", 30, 2e-3), blank("core", 30, 5e-3, 3.5e-3))
    return FitProblem(model, data, free, **options)


def exact(asked, truth=TRUTH):
    """The data of a problem without noise."""
    shown = asked.model.measured(asked.data, truth)
    return replace(asked, data=tuple(replace(p, value=y) for p, y in zip(asked.data, shown, strict=True)))


def quiet(asked, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        return fit(asked, **options)


def test_exact_data_give_the_truth_back():
    found = quiet(exact(problem()))
    for name, value in TRUTH.items():
        assert found.values[name] == pytest.approx(value, rel=1e-6, abs=1e-10), name
    assert found.chi_squared < 1e-9


def test_truth_is_found_from_far_away():
    start = {
        "k": Prior(0.4),
        "beta": Prior(0.8),
        "volume_fraction": Prior(0.02),
        "fraction_scale": Prior(0.5),
        "origin": Prior(0.0),
    }
    found = quiet(exact(problem(start)))
    assert found.values["beta"] == pytest.approx(0.5, rel=1e-5)
    assert found.values["volume_fraction"] == pytest.approx(0.045, rel=1e-5)


def test_one_scale_is_the_weighted_mean():
    """Mean fractions alone, phi known: y = c phi; C of ln c is 1/sum (c phi/std)^2 + 1/prior^2."""
    asked = problem({"fraction_scale": Prior(1.0, 0.1)}, (blank("mean", 25, 3e-3),))
    rng = np.random.default_rng(2)
    asked = asked.simulate({"fraction_scale": 1.08}, rng)
    found = quiet(asked)
    c = found.values["fraction_scale"]
    assert found.covariance[0, 0] == pytest.approx(1 / (25 * (c * 0.05 / 3e-3) ** 2 + 100), rel=1e-6)
    y = asked.data[0].value.mean()
    # stationary: 25 phi c (phi c - y)/std^2 + ln c / 0.1^2 = 0
    assert 25 * 0.05 * c * (0.05 * c - y) / 9e-6 + np.log(c) / 0.01 == pytest.approx(0, abs=1e-4)


def test_radii_alone_agree_with_the_line_of_fit_jet():
    z = np.geomspace(5e-4, 5e-3, 80)
    asked = problem(
        {n: Prior(VALUES[n]) for n in ("k", "beta")}, (Observation("radius", z, 0 * z + 1e-4, 0 * z + 3e-7),)
    )
    drawn = asked.simulate({"k": 0.9, "beta": 0.5}, np.random.default_rng(4))
    found = quiet(drawn)
    line = fit_power_law(z, drawn.data[0].value, drawn.data[0].std, initial_radius=125e-6, tolerance=1e-6)
    assert found.values["k"] == pytest.approx(line.k, abs=0.1 * line.k_std)
    assert found.values["beta"] == pytest.approx(line.beta, abs=0.1 * line.beta_std)
    assert found.std["k"] == pytest.approx(line.k_std, rel=0.03)
    assert found.std["beta"] == pytest.approx(line.beta_std, rel=0.03)


def test_what_the_data_leave_open_is_named():
    asked = exact(
        problem({n: Prior(VALUES[n]) for n in ("volume_fraction", "fraction_scale")}, (blank("mean", 25, 3e-3),))
    )
    with pytest.warns(SpinlineWarning, match="not identified"):
        found = fit(asked)
    assert open_parameters(found) == ["volume_fraction", "fraction_scale"]
    (direction,) = open_directions(found)
    assert set(direction.weights) == {"volume_fraction", "fraction_scale"}
    first, second = direction.weights.values()
    assert first == pytest.approx(-second, rel=1e-3)  # only the product is seen
    with pytest.warns(SpinlineWarning):
        result = fit_dataset(fit(asked))
    assert np.isnan(result["best"].values).all()
    assert not result["identified"].values.any()
    data = json.loads(fit_json(result))
    assert data["parameters"]["volume_fraction"]["best"] is None
    assert data["checks"]["not_identified"] == ["volume_fraction", "fraction_scale"]
    assert "not identified" in fit_words(result)[0]
    with pytest.raises(InputError, match="volume_fraction"):
        gaussian_draws(found)


def test_a_prior_that_the_data_do_not_touch_comes_back():
    free = {"k": Prior(1.0), "beta": Prior(0.47), "volume_fraction": Prior(0.05, 0.004)}
    found = quiet(exact(problem(free, (blank("radius", 40, 1e-6),)), {}))
    assert found.values["volume_fraction"] == pytest.approx(0.05, rel=1e-9)
    assert found.std["volume_fraction"] == pytest.approx(0.004, rel=1e-9)
    assert prior_dominated(found) == ["volume_fraction"]
    assert compare_with_prior(found)["volume_fraction"]["shrinkage"] == pytest.approx(0, abs=1e-9)
    assert any("volume_fraction" in d.weights for d in open_directions(found))
    assert open_parameters(found) == []


def test_prior_far_from_the_data_is_said():
    free = {"k": Prior(1.0), "beta": Prior(0.47), "origin": Prior(0.0, 3e-6)}
    asked = exact(problem(free, (blank("radius", 60, 3e-7),)), {"origin": 2e-5})
    with pytest.warns(SpinlineWarning, match="prior standard deviations from its prior"):
        fit(asked)


def test_wrong_models_and_outliers_are_said():
    asked = problem({n: Prior(VALUES[n]) for n in ("k", "beta")}, (blank("radius", 60, 1e-6),)).simulate(
        VALUES, np.random.default_rng(0)
    )
    bent = replace(asked.data[0], value=asked.data[0].value + 4e-6 * np.sin(2e3 * asked.data[0].z))
    with pytest.warns(SpinlineWarning) as said:
        fit(replace(asked, data=(bent,)))
    words = " ".join(str(w.message) for w in said)
    assert "does not fit" in words
    assert "keep their sign" in words
    value = asked.data[0].value.copy()
    value[30] += 2e-5
    with pytest.warns(SpinlineWarning, match="outlier"):
        fit(replace(asked, data=(replace(asked.data[0], value=value),)))
    generous = replace(asked.data[0], std=10 * asked.data[0].std)
    with pytest.warns(SpinlineWarning, match="too good"):
        fit(replace(asked, data=(generous,)))


@pytest.mark.parametrize("loss", ["huber", "cauchy"])
def test_robust_losses_hold_against_outliers(loss):
    rng = np.random.default_rng(8)
    free = {n: Prior(VALUES[n]) for n in ("k", "beta")}
    asked = problem(free, (blank("radius", 80, 1e-6),)).simulate(VALUES, rng)
    value = asked.data[0].value.copy()
    value[[20, 40, 60]] += 5e-5
    dirty = replace(asked, data=(replace(asked.data[0], value=value),))
    plain, robust = quiet(dirty), quiet(replace(dirty, loss=loss))
    clean = quiet(asked)
    assert abs(robust.values["beta"] - 0.47) < 0.3 * abs(plain.values["beta"] - 0.47)
    assert robust.std["beta"] == pytest.approx(clean.std["beta"], rel=0.6)


def test_a_value_at_the_end_of_its_range_is_said():
    asked = exact(problem({"beta": Prior(0.47), "k": Prior(1.0)}, (blank("radius", 40, 1e-6),)), {"beta": 0.25})
    with pytest.warns(SpinlineWarning, match="beta is at the end of its range"):
        found = fit(asked)
    assert found.interval95["beta"][0] >= 0.25 - 1e-12


def test_likelihood_is_the_product_of_normals():
    asked = problem().simulate(TRUTH, np.random.default_rng(1))
    expected = sum(
        stats.norm.logpdf(part.value, y, part.std).sum()
        for part, y in zip(asked.data, MODEL.measured(asked.data, TRUTH), strict=True)
    )
    assert log_likelihood(MODEL, asked.data, TRUTH) == pytest.approx(expected, rel=1e-12)


def test_curvature_is_one_where_the_model_is_linear():
    asked = exact(problem({"fraction_offset": Prior(0.0)}, (blank("mean", 20, 2e-3),)), {"fraction_offset": 0.01})
    assert curvature(quiet(asked))["fraction_offset"] == pytest.approx(1, abs=1e-6)


@pytest.mark.slow
def test_intervals_cover_affine_jets():
    """Thirty of the campaign's thousand; counts within what a binomial allows once in 1e5."""
    module = coverage_module()
    rows = [module.experiment("affine", i) for i in range(30)]
    names = module.problem("affine").names
    for key, level in (("in68", 0.68), ("in95", 0.95)):
        inside = np.array([row[key] for row in rows]).sum(axis=0)
        law = stats.binom(30, level)
        for name, count in zip(names, inside, strict=True):
            assert law.ppf(1e-5) <= count <= law.ppf(1 - 1e-5), (key, name, count)
    z = np.array([row["z"] for row in rows])
    total = (z**2).sum(axis=0)
    assert (total < stats.chi2.ppf(1 - 1e-5, 30)).all()
    assert (total > stats.chi2.ppf(1e-5, 30)).all()
    chi2 = sum(row["chi2"] for row in rows)
    # residuals of the data at the best point: 220 values less what the parameters took
    assert stats.chi2.ppf(1e-5, 30 * 214) < chi2 < stats.chi2.ppf(1 - 1e-5, 30 * 220)


@pytest.mark.slow
@pytest.mark.parametrize("design", ["relaxing", "drying"])
def test_intervals_cover_relaxing_and_drying_jets(design):
    module = coverage_module()
    rows = [module.experiment(design, i) for i in range(2)]
    z = np.array([row["z"] for row in rows])
    assert (np.abs(z) < 4.5).all()
    assert (z**2).sum() < stats.chi2.ppf(1 - 1e-5, z.size)


@pytest.mark.parametrize("design", ["stretch", "fene-p", "manifold"])
def test_a_fit_by_any_rung_recovers_its_own_parameters(design):
    """The first of the campaign's experiments; and data without noise give the truth back."""
    module = coverage_module()
    row = module.experiment(design, 0)
    assert (np.abs(row["z"]) < 4.5).all()
    asked = module.problem(design)
    truth = {name: prior.value for name, prior in asked.free.items()}
    shown = asked.model.measured(asked.data, truth)
    clean = dataclasses.replace(
        asked, data=tuple(dataclasses.replace(part, value=y) for part, y in zip(asked.data, shown, strict=True))
    )
    found = quiet(clean)
    assert found.problem.model.model == {"stretch": "affine", "fene-p": "conformation", "manifold": "manifold"}[design]
    for name, value in truth.items():
        assert found.values[name] == pytest.approx(value, rel=2e-5, abs=1e-9), name


def test_the_campaign_of_the_rungs_covers_what_it_says():
    """Counts within what a binomial allows once in 1e4; benchmarks/coverage_fit.py makes the experiments again."""
    for one in json.loads((ROOT / "benchmarks" / "coverage_rungs.json").read_text(encoding="utf-8")):
        n = one["experiments"]
        for name, found in one["parameters"].items():
            for key, level in (("coverage68", 0.68), ("coverage95", 0.95)):
                law = stats.binom(n, level)
                assert law.ppf(1e-4) <= round(n * found[key]), (one["design"], name, key)


def test_the_campaign_met_its_target():
    """The committed summary of 1,000 experiments of a design; benchmarks/coverage_fit.py makes it again."""
    for one in json.loads((ROOT / "benchmarks" / "coverage_fit.json").read_text(encoding="utf-8")):
        assert one["experiments"] == 1000
        for name, p in one["parameters"].items():
            assert 0.63 <= p["coverage68"] <= 0.73, (one["design"], name)
            assert 0.92 <= p["coverage95"] <= 0.98, (one["design"], name)


def test_bands_hold_the_jet():
    asked = problem().simulate(TRUTH, np.random.default_rng(3))
    found = quiet(asked)
    draws = gaussian_draws(found, 200, seed=4)
    np.testing.assert_array_equal(draws, gaussian_draws(found, 200, seed=4))
    np.testing.assert_allclose(
        np.cov(draws.T), found.covariance, atol=4 * np.sqrt(2 / 200) * np.diag(found.covariance).max()
    )
    shown = bands(found, draws, np.array([1e-3, 3e-3]))
    assert shown["radius"].dims == ("quantile", "z")
    assert (np.diff(shown["radius"].values, axis=0) >= 0).all()
    # the width is that of the delta method
    k, beta = found.values["k"], found.values["beta"]
    slope = np.array([-1.0, -0.25 * np.log(3e-3 / 125e-6), 0, 0, 0])  # d ln r / d coordinates
    spread = np.sqrt(slope @ found.covariance @ slope) * 125e-6 / k * (3e-3 / 125e-6) ** -beta
    width = 0.5 * float(shown["radius"][3, 1] - shown["radius"][1, 1]) / 0.99446
    assert width == pytest.approx(spread, rel=0.2)


@pytest.mark.slow
def test_predictive_bands_hold_the_data_and_the_crossover(spinline, tmp_path):
    """95 % of the data within the predictive band; the crossover and the strands are those of a run with the best parameters."""
    import xarray as xr

    from spinline.report.fit_figure import fit_figure

    assert spinline("fit", "peo5-simulated").code == 0
    found = xr.open_dataset(tmp_path / "peo5-simulated.nc", engine="h5netcdf").load()
    low, high = found["datum_predictive"].values[[0, 4]]
    inside = ((found["datum_value"] > low) & (found["datum_value"] < high)).mean()
    assert 0.95 - 3 * 0.021 < float(inside) <= 1  # standard error of 110 data
    credible = found["datum_band"].values
    assert (credible[0] >= low).all()
    assert (credible[4] <= high).all()
    assert (high - low >= 2 * 1.9 * found["datum_std"].values).all()
    best = dict(zip(found["parameter"].values.tolist(), found["best"].values.tolist(), strict=True))
    z = (1 / best["volume_fraction"] / best["k"] ** 2) ** (0.5 / best["beta"]) * 125e-6
    assert float(found["crossover_position_best"]) == pytest.approx(z, rel=1e-3)
    assert float(found["crossover_radius_best"]) == pytest.approx(125e-6 * best["volume_fraction"] ** 0.5, rel=1e-3)
    ends = found["crossover_position"].values
    assert ends[0] < z < ends[4]
    assert float(found["crossover_reached"]) == 1
    at = np.interp(z, found["z"], found["orientation_best"])
    assert at == pytest.approx(0.749, abs=0.003)
    assert len(fit_figure(found).axes) == 6


@pytest.mark.slow
def test_sampler_agrees_with_least_squares_and_repeats_itself():
    pytest.importorskip("emcee")
    free = {"k": Prior(1.0), "beta": Prior(0.47)}
    found = quiet(problem(free, (blank("radius", 40, 2e-6),)).simulate(VALUES, np.random.default_rng(5)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        drawn = sample(found, seed=3, steps=400, check_every=200)
        again = sample(found, seed=3, steps=30)
        third = sample(found, seed=3, steps=30)
    np.testing.assert_array_equal(again.draws, third.draws)
    assert drawn.effective > 100
    spread = np.sqrt(np.diag(found.covariance))
    limit = 5 / np.sqrt(drawn.effective)
    assert (np.abs(drawn.draws.mean(axis=0) - found.coordinates) < limit * spread).all()
    assert (np.abs(drawn.draws.std(axis=0) / spread - 1) < limit).all()
    assert 0.2 < drawn.acceptance < 0.7
    result = fit_dataset(found, drawn)
    assert result.attrs["sampler"] == "emcee"
    assert json.loads(fit_json(result))["checks"]["sampler"]["steps"] == drawn.steps
    with pytest.warns(SpinlineWarning, match="the chain is short"):
        sample(found, seed=1, steps=20)


def test_sampler_without_emcee_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "emcee", None)
    found = quiet(exact(problem()))
    with pytest.raises(InputError, match=r"spinline\[fit\]"):
        sample(found)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"data": ()}, "data"),
        ({"free": {}}, "parameters"),
        ({"free": {"k": Prior(-1.0)}}, "parameters.k"),
        ({"free": {"k": Prior(1.0, 0.0)}}, "parameters.k"),
        ({"free": {"speed": Prior(1.0)}}, "speed"),
        ({"free": {"relaxation_time": Prior(1.0)}}, "parameters.relaxation_time"),
        ({"loss": "l1"}, "loss"),
    ],
)
def test_impossible_problems_are_refused(change, field):
    with pytest.raises(InputError) as caught:
        replace(problem(), **change)
    assert caught.value.field == field


def test_one_point_is_enough_only_with_priors():
    one = (Observation("radius", np.array([2e-3]), np.array([3e-5]), np.array([1e-6])),)
    with pytest.raises(InputError, match=r"1 value\(s\) and 0 prior"):
        problem({"k": Prior(1.0), "beta": Prior(0.47)}, one)
    found = quiet(problem({"k": Prior(1.0, 0.3), "beta": Prior(0.47, 0.02)}, one))
    assert found.std["k"] < 0.1


def test_points_beyond_the_jet_are_refused():
    far = Observation(
        "radius", np.array([1e-3, 6e-3, 7e-3]), np.full(3, 3e-5), np.full(3, 1e-6), source="far.csv: radius"
    )
    with pytest.raises(InputError, match=r"far\.csv") as caught:
        problem({"k": Prior(1.0)}, (far,))
    assert "row 2, and 1 more" in str(caught.value)
    assert "z_range" in str(caught.value)


@pytest.mark.slow
def test_bundled_fit_covers_its_truth(spinline, tmp_path):
    truth = {
        "k": 0.93,
        "beta": 0.485,
        "volume_fraction": 0.0455,
        "fraction_scale": 0.97,
        "length_scale": 1.004,
        "origin": 35e-6,
    }
    ran = spinline("fit", "peo5-simulated")
    assert ran.code == 0
    assert "chi-squared" in ran.out
    data = json.loads((tmp_path / "peo5-simulated.json").read_text())
    off = [(data["parameters"][n]["best"] - value) / data["parameters"][n]["std"] for n, value in truth.items()]
    assert max(map(abs, off)) < 3
    assert (tmp_path / "peo5-simulated.png").read_bytes().startswith(b"\x89PNG")
    from spinline.solve.results import open_dataset

    result = open_dataset(tmp_path / "peo5-simulated.nc")
    assert result["core_polymer_fraction"].dims == ("quantile", "z")
    assert result.attrs["scene"].startswith("#")
    assert spinline("fit", "peo5-simulated").code == 2
    again = spinline("fit", "peo5-simulated", "--force", "--json", "--no-figure")
    assert again.json["parameters"] == data["parameters"]


def test_bundled_fit_is_copied_and_its_data_are_those_of_the_script(spinline, tmp_path):
    assert spinline("fit", "peo5-simulated", "--copy").code == 0
    made = {file.name: file.read_text() for file in (tmp_path / "peo5-simulated").iterdir()}
    spec = importlib.util.spec_from_file_location("simulate", ROOT / "benchmarks" / "simulate_fit_example.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.write(tmp_path)
    for name in ("radius.csv", "mean.csv", "core.csv"):
        assert (tmp_path / name).read_text() == made[name]


def test_scene_gives_priors():
    scene = load_scene(
        "peo5-water", ["jet.radius=125 +/- 3 um", "solution.mass_fraction=5 +/- 0.2 wt%", "jet.beta=0.47 +/- 0.02"]
    )
    priors = scene_priors(scene)
    assert set(priors) == {"initial_radius", "volume_fraction", "beta"}
    assert priors["initial_radius"].std == pytest.approx(3e-6)
    # phi = w/rho_p / (w/rho_p + (1 - w)/rho_s): d phi/dw at 5 wt%
    rho = 1.13 / 0.9982
    slope = rho / (0.05 + 0.95 * rho) ** 2
    assert priors["volume_fraction"].std == pytest.approx(slope * 0.002, rel=2e-3)


FIT = 'scene = "peo5-water"\n[[data]]\npath = "r.csv"\nkind = "radius"\n[parameters]\nk = "free"\nbeta = "free"\n'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (FIT.replace("scene =", "scen ="), ["scen", "did you mean 'scene'"]),
        (FIT.replace('"peo5-water"', "3"), ["scene", "not a file name"]),
        (FIT.replace("r.csv", "s.csv"), ["data 1.path", "s.csv", "does not exist"]),
        (FIT.replace('"radius"', '"speed"'), ["data 1.kind", "map"]),
        (FIT.replace("beta", "bta"), ["parameters.bta", "did you mean 'beta'"]),
        (FIT.replace('k = "free"', 'k = "-3 +/- 1"'), ["parameters.k", "out of range"]),
        (FIT.replace('k = "free"', 'k = "some"'), ["parameters.k", "not understood"]),
        (FIT.replace('k = "free"', 'origin = "3"'), ["parameters.origin", "needs a unit"]),
        (FIT + 'evaporation = "free"\n', ["ambient.relative_humidity"]),
        (FIT + '[fit]\nsampler = "nuts"\n', ["fit.sampler", "emcee"]),
        (FIT + "[fit]\nseed = -1\n", ["fit.seed"]),
        (FIT + '[fit]\nlosss = "huber"\n', ["did you mean 'loss'"]),
        (FIT.replace('kind = "radius"', 'kind = "radius"\nz_range = ["3 mm", "1 mm"]'), ["z_range", "empty"]),
        (FIT.replace('kind = "radius"', 'kind = "radius"\nuse = ["core"]'), ["data 1.use", "map"]),
        (FIT.replace('[[data]]\npath = "r.csv"\nkind = "radius"', ""), ["data", "empty"]),
        ("scene = [", ["not a TOML fit"]),
    ],
)
def test_bad_fit_files_are_refused(tmp_path, spinline, text, words):
    (tmp_path / "r.csv").write_text("z [mm], radius [um], std [um]\n1, 45, 1\n2, 33, 1\n3, 27, 1\n", encoding="utf-8")
    (tmp_path / "fit.toml").write_text(text, encoding="utf-8")
    ran = spinline("fit", "fit.toml")
    assert ran.code == 2
    for word in words:
        assert word in ran.err


def test_fit_file_options(tmp_path):
    (tmp_path / "r.csv").write_text("z [mm], radius [um]\n1, 45\n2, 33\n3, 27\n", encoding="utf-8")
    text = FIT.replace('kind = "radius"', 'kind = "radius"\nstd = "2 %"\nz_range = ["0 mm", "2.5 mm"]')
    text += 'relaxation_time = "free"\nlength_scale = 1.02\n[fit]\nloss = "huber"\nseed = 7\n'
    (tmp_path / "fit.toml").write_text(text.replace('k = "free"', 'k = "1 +/- 0.2"'), encoding="utf-8")
    asked = load_fit(tmp_path / "fit.toml")
    assert asked.problem.names == ("k", "beta", "relaxation_time")
    assert asked.problem.size == 2
    assert asked.problem.model.values["length_scale"] == 1.02
    assert asked.problem.model.relaxation
    assert asked.problem.loss == "huber"
    assert asked.seed == 7
    with pytest.raises(InputError, match="did you mean the bundled"):
        load_fit("peo5-simulatd")
    assert "peo5-simulated" in bundled_fits()
