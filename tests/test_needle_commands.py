"""Every command along the jet of a needle: fit, window, sweep, plan, drying, X-ray prediction, and their mistakes."""

import json
import warnings

import numpy as np
import pytest
import xarray as xr
from peo_needle import peo_needle

import spinline as sl
from spinline.base.errors import InputError, SpinlineWarning
from spinline.fit.least_squares import fit
from spinline.fit.observations import Observation
from spinline.fit.overlay import compare_theory
from spinline.fit.problem import FitProblem, Prior
from spinline.fit.scene_model import forward_model
from spinline.jetprofile.ehd import NoSteadyJet, StraightEhdJet
from spinline.scene.file import load_scene
from spinline.setup.build import build_jet, build_solution
from spinline.study.sweep import run_sweep, sweep_from_dict
from spinline.study.window import operating_window

QUICK = ["jet.field=hyperboloid", "jet.end=20 mm"]
PEO = peo_needle(end=0.02)


def scene_of(*changes):
    return load_scene("peo5-needle", [*QUICK, *changes])


@pytest.fixture(scope="module")
def peo():
    return StraightEhdJet(PEO, length=0.02)


@pytest.mark.parametrize("change", [{"voltage": 12e3}, {"relaxation_time": 20e-3}, {"viscosity": 6.0}, {"gap": 0.12}])
def test_a_far_neighbour_leads_to_the_jet_that_is_found_from_nothing(peo, change) -> None:
    far = peo.changed(**change)
    alone = StraightEhdJet(far.settings)
    assert far.current == pytest.approx(alone.current, rel=1e-6)
    np.testing.assert_allclose(far.tension(1e-3), alone.tension(1e-3), rtol=1e-6)


def test_a_neighbour_is_no_way_around_a_verdict(peo) -> None:
    with pytest.raises(NoSteadyJet) as caught:
        peo.changed(conductivity=1e-10)
    assert caught.value.reason == "swells"


# fit


def radii(scene, places=24, spread=0.01, seed=1):
    jet = build_jet(scene, build_solution(scene))
    z = np.geomspace(2e-4, 4.5e-3, places)
    r = jet.radius(z)
    noise = spread * np.random.default_rng(seed).standard_normal(places)
    return Observation("radius", z, r * (1 + noise), spread * r)


def test_a_fit_along_a_needles_jet_gives_the_truth_back() -> None:
    truth = scene_of("network.model=affine")
    model = forward_model(scene_of("network.model=affine", "solution.viscosity=2.4 Pa s"))
    assert {"viscosity", "relaxation_time", "conductivity", "voltage"} <= set(model.names)
    assert not {"k", "beta", "current", "mobility"} & set(model.names)
    free = {"viscosity": Prior(2.4, 1.2), "relaxation_time": Prior(7e-3, 7e-3)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        found = fit(FitProblem(model, (radii(truth, spread=1e-4),), free))
    assert found.chi_squared < 50
    for name, true in (("viscosity", 2.0), ("relaxation_time", 7e-3)):
        assert abs(found.values[name] / true - 1) < 4 * found.std[name] / true
        assert found.std[name] / true < 0.01


def test_a_trial_without_a_jet_is_no_end_of_a_fit() -> None:
    """The start is 0.3 in ln K from where the jet swells; radii of a better conductor."""
    changes = ("network.model=affine", "jet.law=newtonian", "jet.voltage=9 kV", "jet.length=2 mm", "jet.log=constant")
    model = forward_model(scene_of(*changes, "jet.conductivity=8e-9 S/m"))
    with pytest.raises(NoSteadyJet):
        model.predict([1e-3], {"conductivity": 1e-9})
    truth = forward_model(scene_of(*changes, "jet.conductivity=2e-8 S/m"))
    z = np.linspace(1e-4, 1.9e-3, 12)
    r = truth.predict(z).radius
    problem = FitProblem(model, (Observation("radius", z, r, 1e-3 * r),), {"conductivity": Prior(8e-9, 8e-9)})
    assert problem.log_posterior(problem.to_coordinates({"conductivity": 1e-9})) == -np.inf
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        found = fit(problem)
    assert found.values["conductivity"] == pytest.approx(2e-8, rel=0.01)


FIT = """
scene = "scene.toml"
[[data]]
path = "radius.csv"
kind = "radius"
[parameters]
{}
"""


@pytest.fixture
def folder(tmp_path):
    scene = load_scene("peo5-needle").text.replace('field = "needle"', 'field = "hyperboloid"\nend = "20 mm"')
    (tmp_path / "scene.toml").write_text(scene)
    seen = radii(scene_of(), places=8)
    rows = "\n".join(f"{z * 1e3},{r * 1e6},{s * 1e6}" for z, r, s in zip(seen.z, seen.value, seen.std, strict=True))
    (tmp_path / "radius.csv").write_text(f"z [mm],radius [um],std [um]\n{rows}\n")
    return tmp_path


@pytest.mark.slow
def test_the_fit_command_along_a_needles_jet(spinline, folder) -> None:
    (folder / "fit.toml").write_text(FIT.format('surface_tension = "61 +/- 20 mN/m"\nrelaxation_time = "7 ms"'))
    ran = spinline("fit", "fit.toml", "--no-figure")
    assert ran.code == 0, ran.err
    assert "surface_tension" in ran.out
    assert "mN/m" in ran.out
    stored = json.loads((folder / "fit.json").read_text())["parameters"]["surface_tension"]
    assert stored["low95"] < 0.061 < stored["high95"]
    for line, words in (
        ('k = "free"', "changes nothing in this model"),
        ('mobility = "free"', "changes nothing in this model"),
        ('viscosity = "2"', "unit"),
    ):
        (folder / "fit.toml").write_text(FIT.format(line))
        refused = spinline("fit", "fit.toml", "--no-figure", "--force")
        assert refused.code == 2
        assert words in refused.err
    (folder / "scene.toml").write_text((folder / "scene.toml").read_text().replace("0.01 S/m", "1e-10 S/m"))
    (folder / "fit.toml").write_text(FIT.format('viscosity = "2 +/- 1 Pa s"'))
    refused = spinline("fit", "fit.toml", "--no-figure", "--force")
    assert refused.code == 2
    assert "swells" in refused.err


def test_what_a_fit_starts_from_where_the_scene_is_silent() -> None:
    from spinline.fit.scene_model import start_of

    scene = scene_of()
    jet = build_jet(scene, build_solution(scene))
    assert start_of(scene, "current") == jet.current
    assert start_of(scene, "extensibility") == jet.settings.extensibility
    assert start_of(scene, "viscosity") is None
    bare = scene.model_copy(update={"solution": scene.solution.model_copy(update={"relaxation_time": None})})
    assert start_of(bare, "relaxation_time") == pytest.approx(125e-6 / jet.initial_velocity)


# window, sweep, plan


def test_dryness_of_a_window_is_that_of_a_run() -> None:
    scene = scene_of("network.model=affine")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        window = operating_window(scene, voltage=[6e3], gap=[0.1], relative_humidity=0.3, workers=1)
        dry = sl.run(scene_of("network.model=affine", "effects.evaporation=true", "ambient.relative_humidity=0.3"))
    phi = float(dry["volume_fraction"])
    lost = (1 - phi) * window["dryness"].isel(k_factor=1, voltage=0).item()
    assert lost == pytest.approx(float(dry["evaporated_fraction"][-1]), rel=1e-4)
    assert 0 < window["dryness"].values.min() < 0.01


def test_a_straight_jet_is_no_incomplete_row() -> None:
    fixed = {"jet.field": "hyperboloid", "jet.length": "10 mm", "network.model": "affine"}
    rows = run_sweep(
        sweep_from_dict(
            {"scene": "peo5-needle", "set": fixed, "vary": {"jet.voltage": ["9 kV"]}},
        ),
        workers=1,
    )
    assert np.isnan(rows["bending_onset_late"].values).all()
    assert rows["status"].values.tolist() == [0]


def test_the_plan_shows_what_decides_about_the_jet(spinline) -> None:
    common = ("plan", "peo5-needle", "--set", "jet.field=hyperboloid", "--set", "jet.end=20 mm")
    ran = spinline(*common)
    assert ran.code == 0
    for name in ("elastic", "cone", "held", "needle_tension", "relaxation", "conducted", "inertia", "beads"):
        assert any(line.startswith("jet") and name in line for line in ran.out.splitlines()), name
    told = json.loads(spinline(*common, "--json").out)
    assert {"name", "value", "limit", "good", "text"} == set(told["jet_verdicts"][0])
    assert "jet_verdicts" not in json.loads(spinline("plan", "peo5-water", "--json").out)


# X-ray


@pytest.mark.slow
def test_x_ray_frames_of_a_needles_jet(spinline, tmp_path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        sl.results.save(sl.run(scene_of("network.model=affine")), tmp_path / "jet.nc")
    ran = spinline("simulate-image", "jet.nc", "--from", "0.2 mm", "--to", "0.6 mm")
    assert ran.code == 0, ran.err
    assert (tmp_path / "jet-frames.npz").exists()
    refused = spinline("simulate-image", "jet.nc", "--from", "0.2 mm", "--to", "9 mm", "--force")
    assert refused.code == 2
    assert "0.005" in refused.err


def test_a_map_against_a_needles_scene() -> None:
    scene = scene_of("network.model=affine")
    jet = build_jet(scene, build_solution(scene))
    z, edges = np.linspace(3e-4, 4e-3, 20), np.linspace(0, 1, 9)
    reduced = xr.Dataset(
        {
            "polymer_fraction": (("row", "shell"), np.full((20, 8), 0.05)),
            "polymer_fraction_std": (("row", "shell"), np.full((20, 8), 0.02)),
            "mean_polymer_fraction": ("row", np.full(20, 0.05)),
            "mean_polymer_fraction_std": ("row", np.full(20, 0.004)),
            "jet_radius": ("row", jet.radius(z), {"units": "m"}),
            "jet_radius_std": ("row", np.full(20, 5e-7)),
        },
        {"z": ("row", z, {"units": "m"}), "shell": 0.5 * (edges[1:] + edges[:-1])},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        found = compare_theory(scene, reduced, core_within=0.126)
    np.testing.assert_allclose(found["radius_ratio_predicted"].values, jet.radius(z) / 125e-6, rtol=1e-12)
    assert (np.diff(found["core_predicted"].values) >= 0).all()
    model = forward_model(scene)
    model.predict([0.015])  # beyond the scene's length, within jet.end
    with pytest.raises(InputError, match="straight part"):
        model.predict([0.03])
