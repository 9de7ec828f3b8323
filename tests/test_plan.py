"""The plan: its estimates against the finer rungs, its choices and words; trade; the difference of two results."""

import importlib.util
import json
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import spinline as sl
from spinline.base.errors import InputError, SpinlineWarning
from spinline.base.units import parse
from spinline.cli import app
from spinline.plan import MARGIN, plan_scene, resolved
from spinline.plan.estimates import elastic_coupling_effect, extensibility_effect, relaxation_effect
from spinline.scene import load_scene
from spinline.setup.build import build_jet, build_solution
from spinline.setup.context import Context
from spinline.solve import run
from spinline.study.difference import REPORTED, difference, largest
from spinline.study.trade import trade, variant

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"
ATLAS_SCENES = 300  # at least, in benchmarks/atlas.json


def quiet(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        return run(scene)


def parts(*overrides, name="peo5-water"):
    scene = load_scene(name, overrides)
    solution = build_solution(scene)
    return scene, solution, build_jet(scene, solution)


def measured(text, kind="number"):
    return parse(text, kind, "")


def planned(*overrides, name="peo5-water"):
    return plan_scene(*parts(*overrides, name=name))


@pytest.mark.parametrize("coupling", [200.0, 3000.0, 1e5])
@pytest.mark.parametrize("beta", [0.3, 0.47, 0.8])
def test_estimate_of_slip_against_the_manifold(coupling, beta):
    overrides = (f"network.coupling={coupling}", f"jet.beta={beta}", "jet.length=1.5 mm")
    scene, solution, jet = parts(*overrides)
    effect = elastic_coupling_effect(Context(scene, solution, jet))
    error = largest(difference(quiet(variant(scene, "affine")), quiet(variant(scene, "manifold", force_law="linear"))))
    assert 0.85 < effect.error / error < 1.5
    slope = jet.strain_rate(np.linspace(jet.onset, 12.0, 500) * 125e-6) * jet.initial_radius / jet.initial_velocity
    assert effect.number == pytest.approx(3 / coupling * slope.max(), rel=1e-3)


@pytest.mark.parametrize("theta", [1.0, 10.0, 100.0])
def test_estimate_of_relaxation_against_the_conformation(theta):
    scene, solution, jet = parts(f"solution.relaxation_time={theta} s")
    effect = relaxation_effect(Context(scene, solution, jet), 1.0)
    error = largest(difference(quiet(variant(scene, "affine")), quiet(variant(scene, "conformation"))))
    assert 0.85 < effect.error / error < 1.1


def test_place_of_locking_against_the_manifold():
    scene, solution, jet = parts("network.coupling=1e9")
    locked = quiet(variant(scene, "manifold", force_law="lattice", closure="stretch"))
    words = extensibility_effect(Context(scene, solution, jet)).words
    place = float(words.split("locked from ")[1].split(" mm")[0])
    assert place == pytest.approx(1e3 * locked.attrs["locked_from"], rel=0.03)
    short, one, two = parts("jet.length=1 mm")
    assert 0 < extensibility_effect(Context(short, one, two)).error < 1e-5


def test_estimate_of_extensibility_short_of_the_contour():
    overrides = ("network.coupling=1000", "jet.length=2.6 mm", "network.closure=stretch")
    scene, solution, jet = parts(*overrides)
    linear, lattice = (quiet(variant(scene, "manifold", force_law=law)) for law in ("linear", "lattice"))
    effect = extensibility_effect(Context(scene, solution, jet))
    assert effect.number < 1
    assert 0.5 < effect.error / largest(difference(linear, lattice)) < 3


def test_strands_too_short_for_fenep_are_refused_only_where_that_rung_is_needed():
    scene = load_scene("peo5-water", ["network.closure=stretch", "solution.relaxation_time=1000 s"])
    solution = scene.solution.model_copy(update={"mass_fraction": None, "volume_fraction": measured("0.7")})
    slow = scene.model_copy(update={"solution": solution})
    assert quiet(slow).attrs["model"] == "affine"
    fast = slow.model_copy(
        update={"solution": solution.model_copy(update={"relaxation_time": measured("1 ms", "time")})}
    )
    with pytest.raises(InputError, match="too short for FENE-P"):
        quiet(fast)


def test_drying_is_planned_as_it_is_run():
    """Within the margin of rtol as well; radial gradients never without evaporation."""
    humid = "ambient.relative_humidity=0.4"
    for rtol in ("1.6e-3", "1.9e-3", "1e-2"):
        result = quiet(load_scene("peo5-water", [humid, "rheology.diffusivity=1e-9 m2/s", f"accuracy.rtol={rtol}"]))
        used = [effect["name"] for effect in json.loads(result.attrs["plan"])["effects_used"]]
        assert ("evaporation" in used) == result.attrs["evaporation_reason"].startswith("on")
        assert ("radial gradients" in used) == result.attrs["radial_reason"].startswith("on")


def test_choices():
    assert planned().model == "affine"
    assert planned("accuracy.rtol=5e-4").model == "manifold"
    assert planned("solution.relaxation_time=1 ms").model == "conformation"
    assert planned("solution.relaxation_time=1 ms", "effects.relaxation=false").model == "affine"
    assert planned("network.force_law=fene").model == "manifold"
    both = planned("solution.relaxation_time=1 ms", "network.coupling=100")
    assert both.model == "two-fluid"
    assert not both.remarks
    assert planned("network.coupling=5").model == "manifold"  # which says how much the far end decides
    apart = planned("network.model=conformation", "solution.relaxation_time=1 ms", "network.coupling=100")
    assert "see --model two-fluid" in apart.remarks[0]
    forced = planned("network.model=affine", "network.coupling=100")
    assert forced.forced
    assert "asked for" in forced.reason
    assert "manifold" in forced.reason
    assert "elastic coupling" in forced.remarks[0]
    assert planned(name="pvp-jetspin").model == "affine"
    assert "bending" in planned(name="pvp-jetspin").used


def test_a_change_of_rung_is_in_the_result():
    result = quiet(load_scene("pcl9-dcm"))
    assert result.attrs["model"] == "manifold"
    assert result.attrs["model_requested"] == "auto"
    assert result.attrs["force_law"] == "linear"
    plan = json.loads(result.attrs["plan"])
    assert plan["model"] == "manifold"
    assert {"elastic coupling"} <= {effect["name"] for effect in plan["effects_used"]}
    for effect in plan["effects_used"] + plan["effects_left_out"]:
        assert set(effect) == {"name", "symbol", "number", "estimated_error", "reason"}
    names = [effect["name"] for effect in plan["effects_used"] + plan["effects_left_out"]]
    assert sorted(names) == sorted(
        [
            "elastic coupling",
            "inertia",
            "relaxation",
            "evaporation",
            "radial gradients",
            "finite extensibility",
            "saturation",
            "lateral time",
            "disentanglement",
            "bending",
            "evaporative cooling",
        ]
    )
    scene, solution, jet = parts(name="pcl9-dcm")
    assert resolved(scene, plan_scene(scene, solution, jet)).network.model == "manifold"


def test_difference():
    scene = load_scene("peo5-water")
    one = quiet(scene)
    assert largest(difference(one, one)) == 0
    assert set(difference(one, one)) == set(REPORTED)
    moved = one.copy(deep=True)
    moved["axial_stretch"] = moved["axial_stretch"] * 1.01
    moved["crossover_extension_radius"] = moved["crossover_extension_radius"] * 0.98
    errors = difference(moved, one)
    assert errors["axial_stretch"] == pytest.approx(0.01, rel=1e-9)
    assert errors["crossover_extension_radius"] == pytest.approx(0.02, rel=1e-9)
    never = one.copy(deep=True)
    never["crossover_extension_position"] = np.nan
    assert difference(never, one)["crossover_extension_position"] == 1
    finer = quiet(variant(scene, "affine", points=1601))
    assert largest(difference(one, finer)) < 1e-9
    with pytest.raises(InputError, match="length"):
        difference(quiet(load_scene("peo5-water", ["jet.length=4 mm"])), one)


class Work:
    """A clock of the work that is done, Python's calls: two rungs that are a tenth apart in time come out by chance."""

    calls = 0

    def count(self, _frame, event, _what):
        self.calls += event in ("call", "c_call")

    def process_time(self):
        return 1e-6 * self.calls


def test_trade_measures_and_recommends(monkeypatch):
    measured = trade(load_scene("pcl9-dcm"), quick=True)
    by_model = {rung.model: rung for rung in measured.rungs}
    assert set(by_model) == {"affine", "manifold"}
    assert by_model["affine"].errors["elastic"] > measured.rtol > by_model["manifold"].errors["elastic"]
    assert by_model["manifold"].seconds > 0
    assert measured.recommendation.startswith("manifold")
    assert measured.references["relaxation"].startswith("none")
    clock = Work()
    monkeypatch.setattr("spinline.study.trade.time", clock)
    before = sys.getprofile()
    sys.setprofile(clock.count)
    try:
        measured = trade(load_scene("peo5-water"), quick=True)
    finally:
        sys.setprofile(before)
    affine, manifold = measured.rungs
    assert max(affine.errors["elastic"], manifold.errors["elastic"]) < measured.rtol
    assert 0 < affine.seconds < manifold.seconds  # both would do: the cheaper is the answer
    assert measured.recommendation.startswith("affine")


def test_commands(tmp_path):
    runner = CliRunner()
    text = runner.invoke(app, ["plan", "pcl9-dcm"])
    assert text.exit_code == 0
    assert text.stdout.startswith("manifold")
    data = json.loads(runner.invoke(app, ["plan", "peo5-water", "--json"]).stdout)
    assert data["model"] == "affine"
    assert {"effects_used", "effects_left_out"} <= set(data)
    picture = tmp_path / "trade.png"
    done = runner.invoke(app, ["trade", "pcl9-dcm", "--quick", "--json", "--figure", str(picture)])
    assert done.exit_code == 0
    assert json.loads(done.stdout[done.stdout.index("{") :])["recommendation"].startswith("manifold")
    assert picture.stat().st_size > 10_000
    assert isinstance(runner.invoke(app, ["trade", "peo5-water", "--figure", "trade.txt"]).exception, InputError)
    assert isinstance(runner.invoke(app, ["plan", "no-such-scene"]).exception, InputError)


def benchmark(name):
    spec = importlib.util.spec_from_file_location(name, BENCHMARKS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_fifty_random_scenes_keep_rtol(monkeypatch):
    """A replay of benchmarks/accuracy.py: scenes of another seed."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    accuracy = benchmark("accuracy")
    judged, kept, index = 0, 0, 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        while judged < 50:
            outcomes = accuracy.judge(7, index, tolerances=(1e-2,))
            index += 1
            for outcome in outcomes or ():
                if outcome["kind"] in ("met", "missed"):
                    judged += 1
                    kept += outcome["kind"] == "met"
    assert kept >= 49
    assert sl.__version__
    assert MARGIN > 1


@pytest.mark.slow
def test_scenes_of_the_atlas(monkeypatch):
    """Scenes of every outcome and one of the dear ones: results within bounds or named refusals, by the model that the summary says."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    atlas = benchmark("atlas")
    summary = json.loads((BENCHMARKS / "atlas.json").read_text(encoding="utf-8"))
    assert summary["failed"] == 0
    assert summary["scenes"] >= ATLAS_SCENES
    which = atlas.sample(summary, np.random.default_rng(20261129), seconds=6.0)
    assert len(which) >= 40
    assert {summary["letters"][i] for i in which} >= set("AMCTamct")
    failed, changed = atlas.check(summary, 0, which=which)
    assert failed == []
    assert len(changed) <= 1, changed  # of a budget or a limit that rounding decides


def test_the_check_of_the_atlas_can_fail(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    atlas = benchmark("atlas")
    monkeypatch.setattr(atlas, "warm", lambda: None)
    summary = json.loads((BENCHMARKS / "atlas.json").read_text(encoding="utf-8"))
    few = [int(i) for i in np.argsort(summary["milliseconds"])[:3]]
    assert atlas.check(summary, 0, which=few) == ([], [])
    wrong = summary | {"letters": "w" * summary["scenes"]}
    assert len(atlas.check(wrong, 0, which=few)[1]) == sum(summary["letters"][i] != "w" for i in few)
    results = [i for i in np.argsort(summary["milliseconds"]).tolist() if summary["letters"][i] in "Aa"][:1]
    monkeypatch.setattr(atlas, "BOUNDS", {"radius": (10.0, 11.0)})
    assert atlas.check(summary, 0, which=results)[0]


@pytest.mark.slow
def test_estimates_are_safe(monkeypatch):
    """A replay of benchmarks/estimates.py: no estimate below a tenth of what leaving the effect out changes."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    estimates = benchmark("estimates")
    pairs = {name: [] for name in estimates.EFFECTS}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        for index in (0, 1, 3, 4, 5):  # of the first dozen those that take under three seconds
            for name, one in (estimates.judge(5, index) or {}).items():
                if np.isfinite([one["truth"]]).all() and not np.isnan(one["estimate"]):
                    pairs[name].append((one["estimate"], one["truth"]))
    for name, both in pairs.items():
        assert both, name
        assert estimates.agreement(both)["below a tenth"] == 0, name
