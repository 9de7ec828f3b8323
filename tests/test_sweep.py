"""Sweeps: designs, closed forms against single runs, bad rows, the store after a kill, processes, clusters."""

import os
import signal
import subprocess
import sys
import textwrap
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import qmc

import spinline as sl
from spinline.base.errors import InputError
from spinline.plan import plan_scene
from spinline.scene import scene_from_dict
from spinline.scene.keys import placed
from spinline.study.closed_forms import closed_forms
from spinline.study.design import Axis, Design
from spinline.study.rows import CLOSED_FORMS, COMPILED, PROFILES, SCALARS, SINGLE, Task
from spinline.study.sweep import as_grid, open_sweep, run_sweep, sweep_from_dict

ROOT = Path(__file__).parents[1]
SCRIPT_ENV = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}


def spec(kind="latin-hypercube", samples=64, **more):
    vary = {
        "jet.k": {"loguniform": [0.3, 3.0]},
        "jet.beta": {"uniform": [0.25, 0.9]},
        "solution.mass_fraction": {"uniform": ["1 wt%", "30 wt%"]},
        "jet.length": {"loguniform": ["1 mm", "30 mm"]},
    }
    base = {
        "scene": "peo5-water",
        "set": {"network.model": "affine"},
        "design": {"kind": kind, "samples": samples, "seed": 3},
        "vary": vary,
    }
    return {**base, **more}


def same(a, b):
    assert set(a.variables) == set(b.variables)
    for name in a.variables:
        if a[name].dtype.kind == "f":
            np.testing.assert_array_equal(a[name].values, b[name].values, err_msg=str(name))
        else:
            assert list(map(str, a[name].values.ravel())) == list(map(str, b[name].values.ravel())), name


def values_of(result, i):
    return {key: result[key].values.tolist()[i] for key in result.attrs["keys"].split()}


# designs


def test_a_grid_has_every_combination_last_key_fastest():
    sweep = sweep_from_dict(
        {
            "scene": "peo5-water",
            "vary": {"jet": {"k": {"linspace": [1, 2, 3]}, "radius": {"logspace": ["50 um", "200 um", 2]}}},
        }
    )
    rows = sweep.design.rows(0, sweep.design.size)
    assert sweep.design.shape == (3, 2)
    np.testing.assert_allclose(rows["jet.k"], [1, 1, 1.5, 1.5, 2, 2])
    np.testing.assert_allclose(rows["jet.radius"], [50e-6, 200e-6] * 3)


@pytest.mark.parametrize("kind", ["grid", "latin-hypercube", "sobol", "sensitivity"])
def test_rows_do_not_depend_on_how_they_are_cut(kind):
    if kind == "grid":
        axes = [Axis("jet.k", np.linspace(1, 2, 5)), Axis("jet.beta", np.linspace(0.3, 0.6, 7))]
    else:
        axes = [Axis("jet.k", np.array([0.5, 2.0]), "log"), Axis("jet.beta", np.array([0.3, 0.6]), "linear")]
    design = Design(kind, axes, 16, seed=5)
    again = Design(kind, axes, 16, seed=5)
    whole = design.rows(0, design.size)
    for start in range(0, design.size, 5):
        part = again.rows(start, min(start + 5, design.size))
        for key in design.keys:
            np.testing.assert_array_equal(part[key], whole[key][start : start + 5])
    assert design.digest() == again.digest()
    if kind != "grid":
        assert design.digest() != Design(kind, axes, 16, seed=6).digest()


def test_latin_hypercube_has_one_point_a_stratum_and_logarithms_are_uniform():
    design = Design("latin-hypercube", [Axis("jet.k", np.array([0.01, 100.0]), "log")], 50)
    k = design.rows(0, 50)["jet.k"]
    strata = np.floor((np.log(k) - np.log(0.01)) / np.log(1e4) * 50).astype(int)
    assert sorted(strata) == list(range(50))


def test_sobol_points_are_those_of_scipy():
    axes = [Axis("jet.k", np.array([1.0, 3.0]), "linear"), Axis("jet.beta", np.array([0.3, 0.5]), "linear")]
    rows = Design("sobol", axes, 32, seed=9).rows(0, 32)
    unit = qmc.Sobol(2, seed=np.random.default_rng(9), bits=62).random(32)
    np.testing.assert_allclose(rows["jet.k"], 1 + 2 * unit[:, 0], rtol=1e-15)
    np.testing.assert_allclose(rows["jet.beta"], 0.3 + 0.2 * unit[:, 1], rtol=1e-15)


def test_blocks_of_the_sensitivity_design_share_all_columns_but_one():
    axes = [Axis(key, np.array([0.3, 0.9]), "linear") for key in ("jet.k", "jet.beta", "accuracy.rtol")]
    design = Design("sensitivity", axes, 8)
    a, b, *mixed = (design.rows(8 * i, 8 * i + 8) for i in range(5))
    assert design.size == 40
    for j, block in enumerate(mixed):
        for i, key in enumerate(design.keys):
            np.testing.assert_array_equal(block[key], (b if i == j else a)[key])


# closed forms against single runs


VARIANTS = {
    "force, theta": {},
    "stretch, good": {"network": {"closure": "stretch", "solvent_quality": "good", "crossover_extension": 0.6}},
    "hyperbola": {"jet": {"profile": "hyperbolic", "radius": "90 um", "flow_rate": "2 mL/hour", "length": "8 mm"}},
    "estimated k": {"jet": {"electric_field": "60 kV/m", "conductivity": "0.01 S/m"}},
    "volume fraction": {},
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_closed_forms_are_those_of_a_run(variant):
    data = spec(samples=48, profiles=list(PROFILES), points=13)
    base = {
        "solution": {"polymer": "PEO", "solvent": "water", "molar_mass": "600 kDa", "viscosity": "2 Pa s"},
        "jet": {"profile": "power-law", "radius": "125 um", "flow_rate": "3.2 mL/hour"},
    }
    extra = VARIANTS[variant]
    base["network"] = {"model": "affine", **extra.get("network", {})}
    base["jet"] = extra["jet"] if variant == "hyperbola" else base["jet"] | extra.get("jet", {})
    if variant == "hyperbola":
        del data["vary"]["jet.k"], data["vary"]["jet.beta"]
        data["vary"]["jet.p"] = {"loguniform": [2.0, 60.0]}
    if variant == "estimated k":
        del data["vary"]["jet.k"]
        data["vary"] |= {
            "solution.viscosity": {"loguniform": ["0.1 Pa s", "10 Pa s"]},
            "jet.flow_rate": {"loguniform": ["1 mL/hour", "9 mL/hour"]},
        }
    if variant == "volume fraction":
        del data["vary"]["solution.mass_fraction"]
        data["vary"]["solution.volume_fraction"] = {"loguniform": [1e-3, 0.5]}
    data["vary"]["solution.temperature"] = {"uniform": ["5 degC", "60 degC"]}
    data["scene"] = base
    sweep = sweep_from_dict(data)
    fast, slow = run_sweep(sweep), run_sweep(sweep, vectorise=False, workers=1)
    assert fast.attrs["computed_by"].startswith("closed forms")
    assert slow.attrs["computed_by"].startswith("one scene")
    np.testing.assert_array_equal(fast["status"], slow["status"])
    assert (fast["reason"] == slow["reason"]).all()
    assert (fast["status"] == 0).sum() > 0
    for name in (*SCALARS, *(f"profile_{name}" for name in PROFILES)):
        # exp(-f) of a strand near its contour: a rounding of f costs f times itself
        rtol = 1e-12 if name in SCALARS else 1e-11
        np.testing.assert_allclose(fast[name], slow[name], rtol=rtol, atol=1e-290, err_msg=name)


def test_rows_are_what_spinline_run_says():
    result = run_sweep(sweep_from_dict(spec(samples=12)))
    base = load_base("peo5-water") | {"network": {"model": "affine"}}
    for i in range(12):
        with pytest.warns(sl.SpinlineWarning):
            run = sl.run(scene_from_dict(placed(base, values_of(result, i)) | {"accuracy": {"rtol": 1e-9}}))
        for name in SCALARS:
            if name in run:
                np.testing.assert_allclose(result[name][i], run[name], rtol=1e-12, err_msg=name)
        if result["status"][i] == 0:
            here = int(np.argmin(np.abs(run["z"].values - float(run["crossover_position"]))))
            np.testing.assert_allclose(result["crossover_orientation"][i], run["orientation"][here], rtol=1e-12)
        np.testing.assert_allclose(result["end_network_radius"][i], run["network_radius"][-1], rtol=1e-12)


def load_base(name):
    import tomllib

    return tomllib.loads(sl.scene.bundled_scenes()[name].read_text())


def test_auto_takes_closed_forms_where_the_plan_is_certain_to_take_them():
    data = spec(samples=60, set={})
    data["vary"]["network.coupling"] = {"loguniform": [50, 1e6]}
    sweep = sweep_from_dict(data, ["accuracy.rtol=0.05"])
    fast, slow = run_sweep(sweep, workers=1), run_sweep(sweep, workers=1, vectorise=False)
    assert fast.attrs["computed_by"].startswith("closed forms")
    for name in SCALARS:
        np.testing.assert_allclose(fast[name], slow[name], rtol=1e-12, err_msg=name)
    task = Task(sweep.base, ".", vectorise=True)
    columns = sweep.design.rows(0, 60)
    way = closed_forms(task, columns).way
    assert (way != 255).all()
    np.testing.assert_array_equal(fast["computed_by"], way)
    assert (slow["computed_by"] == SINGLE).all()
    models = []
    for i in range(60):
        scene = sweep.scene({key: values.tolist()[i] for key, values in columns.items()})
        solution = sl.solve.build_solution(scene)
        models.append(plan_scene(scene, solution, sl.solve.build_jet(scene, solution)).model)
    assert models == [{CLOSED_FORMS: "affine", COMPILED: "manifold"}[code] for code in way]
    assert 0.05 < models.count("manifold") / 60 < 0.9


@pytest.mark.parametrize("profile", ["power-law", "hyperbolic"])
def test_closed_forms_are_taken_only_where_the_plan_takes_them_over_the_whole_box(profile):
    """The plan of many rows against `spinline.plan`; no warning of numpy's, though nothing silences them."""
    n, rng = 150, np.random.default_rng(20)

    def spread(low, high):
        return np.exp(rng.uniform(np.log(low), np.log(high), n))

    radius = spread(1e-9, 1e-2)
    columns = {
        "solution.volume_fraction": spread(1e-3, 0.6),
        "jet.radius": radius,
        "jet.flow_rate": spread(1e-20, 1e-6),
        "jet.length": radius * spread(1.0, 1e4),
        "network.coupling": spread(1.0, 1e9),
        "network.spring": spread(0.3, 3.0),
        "network.crossover_extension": rng.uniform(0.3, 0.95, n),
        "accuracy.rtol": spread(1e-4, 0.5),
    }
    shape = (
        {"k": spread(0.05, 20), "beta": rng.uniform(0.25, 1, n)} if profile == "power-law" else {"p": spread(0.5, 1e3)}
    )
    columns |= {f"jet.{key}": values for key, values in shape.items()}
    jet = {"profile": profile, "radius": "125 um", "flow_rate": "3.2 mL/hour", "length": "5 mm"}
    base = {
        "solution": {"polymer": "PEO", "solvent": "water", "volume_fraction": 0.05},
        "jet": jet | {key: float(values[0]) for key, values in shape.items()},
    }
    task = Task(base, ".", vectorise=True)
    way = closed_forms(task, columns).way
    assert (way != 255).mean() > 0.95
    for i in np.flatnonzero(way != 255):
        scene = task.scene({key: float(values[i]) for key, values in columns.items()})
        solution = sl.solve.build_solution(scene)
        model = plan_scene(scene, solution, sl.solve.build_jet(scene, solution)).model
        assert model == {CLOSED_FORMS: "affine", COMPILED: "manifold"}[way[i]], i


def test_words_divide_a_sweep_into_groups_of_closed_forms():
    data = {
        "scene": "peo5-water",
        "vary": {
            "solution.solvent": ["water", {"ethanol": 0.5, "water": 0.5}],
            "network.closure": ["force", "stretch"],
            "jet.k": {"linspace": [0.5, 2, 4]},
        },
        "set": {"network.model": "affine"},
    }
    fast = run_sweep(sweep_from_dict(data))
    slow = run_sweep(sweep_from_dict(data), vectorise=False, workers=1)
    assert fast.attrs["computed_by"].startswith("closed forms")
    assert (fast["status"] != 255).all()
    for name in SCALARS:
        np.testing.assert_allclose(fast[name], slow[name], rtol=1e-12, err_msg=name)


def test_many_temperatures_are_interpolated_to_rounding():
    from spinline.rheology import solvent_density
    from spinline.setup.densities import densities

    t = np.linspace(280.0, 340.0, 5000)
    for name in ("water", "ethanol"):
        found = densities({name: 1.0}, t)
        exact = [solvent_density(name, x) for x in t[::331]]
        np.testing.assert_allclose(found[::331], exact, rtol=2e-13)
    assert np.isnan(densities({"water": 1.0}, np.array([250.0, 300.0]))).tolist() == [True, False]


@pytest.mark.parametrize("end", ["take-up", "free", "extended"])
@pytest.mark.parametrize("profile", ["power-law", "hyperbolic"])
def test_networks_that_slip_are_those_of_a_run(profile, end):
    """Numbers and profiles of compiled rows, uncertain input and all, to 1e-12 of single runs."""
    data = spec(samples=24, profiles=["z", "network_velocity_ratio", "core_polymer_fraction"], points=7)
    data["vary"]["network.coupling"] = {"loguniform": [30, 1e4]}
    data["set"] = {"network.model": "manifold", "network.force_law": "linear", "network.end": end}
    data["set"]["jet.flow_rate"] = "3.2 +/- 0.1 mL/hour"
    if profile == "hyperbolic":
        del data["vary"]["jet.k"], data["vary"]["jet.beta"]
        data["scene"] = load_base("peo5-water")
        data["scene"]["jet"] = {"profile": "hyperbolic", "radius": "90 um", "flow_rate": "2 mL/hour", "length": "8 mm"}
        data["vary"]["jet.p"] = {"loguniform": [2.0, 60.0]}
    sweep = sweep_from_dict(data)
    fast, slow = run_sweep(sweep, workers=1), run_sweep(sweep, workers=1, vectorise=False)
    assert (fast["computed_by"] == COMPILED).all()
    assert (slow["computed_by"] == SINGLE).all()
    np.testing.assert_array_equal(fast["status"], slow["status"])
    assert (fast["reason"] == slow["reason"]).all()
    assert np.isfinite(fast["crossover_extension_position"]).any()
    for name in fast.data_vars:
        if fast[name].dtype.kind == "f":
            plain = name.removesuffix("_std")  # a difference of two runs is no better than they are
            room = 1e-10 * float(np.nan_to_num(np.abs(slow[plain])).max()) if plain != name else 1e-290
            np.testing.assert_allclose(fast[name], slow[name], rtol=1e-11, atol=room, err_msg=name)


def test_a_manifold_of_another_law_goes_one_by_one_and_equals_its_run():
    sweep = sweep_from_dict(
        {"scene": "peo5-water", "vary": {"jet.k": [0.9, 1.1], "network.coupling": [1e4]}}, ["network.model=manifold"]
    )
    result = run_sweep(sweep, workers=1)
    scene = scene_from_dict(placed(load_base("peo5-water") | {"network": {"model": "manifold"}}, values_of(result, 1)))
    with pytest.warns(sl.SpinlineWarning):
        run = sl.run(scene)
    np.testing.assert_allclose(result["crossover_position"][1], run["crossover_position"], rtol=1e-12)
    np.testing.assert_allclose(result["end_orientation"][1], run["orientation"][-1], rtol=1e-9)
    np.testing.assert_allclose(
        result["crossover_orientation"][1], run.sel(z=run["crossover_position"])["orientation"], rtol=1e-9
    )


def test_bead_jets_are_read_once_and_equal_their_run(monkeypatch):
    from spinline.setup import jet as built
    from spinline.study import rows as sweep_rows

    sweep_rows._built.cache_clear()
    reads = []
    real = built._jet_dataset
    monkeypatch.setattr(built, "_jet_dataset", lambda *a: reads.append(1) or real(*a))
    sweep = sweep_from_dict({"scene": "pvp-jetspin", "vary": {"solution.mass_fraction": {"linspace": [0.02, 0.04, 9]}}})
    result = run_sweep(sweep, workers=1)
    assert len(reads) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        run = sl.run(
            scene_from_dict(
                placed(load_base("pvp-jetspin"), {"solution.mass_fraction": 0.04}),
                folder=sl.scene.bundled_scenes()["pvp-jetspin"].parent,
            )
        )
    np.testing.assert_allclose(result["crossover_radius"][-1], run["crossover_radius"], rtol=1e-12)


# bad rows


def test_bad_points_are_rows_with_a_reason(tmp_path):
    (tmp_path / "t.csv").write_text(
        "# a table\njet.k, jet.radius [um], solution.solvent, jet.beta\n1, 100, water, 0.5\n-1, 100, water, 0.5\n"
        "1, 0, water, 0.5\nnan, 100, water, 0.5\n1e29, 100, water, 0.25\n1, 100, mud, 0.5\n0.01, 100, ethanol, 0.5\n"
    )
    data = {"scene": "peo5-water", "design": {"kind": "table", "path": "t.csv"}}
    result = run_sweep(sweep_from_dict(data, folder=tmp_path))
    assert result["status"].values.tolist() == [0, 2, 2, 2, 2, 2, 1]
    for i, words in enumerate(
        ["", "jet.k", "jet.radius", "jet.k", "k", "solution.solvent", "crossover is not reached"]
    ):
        assert words in str(result["reason"].values[i])
        for name in SCALARS:
            if result["status"][i] == 2:
                assert np.isnan(result[name][i])
    base = load_base("peo5-water")
    with pytest.raises(InputError) as error:
        sl.run(scene_from_dict(placed(base, {"jet.k": 1e29, "jet.radius": 1e-4, "jet.beta": 0.25})))
    assert str(error.value) == str(result["reason"].values[4])


def test_an_unforeseen_error_is_a_row_too(monkeypatch):
    from spinline.study import rows as sweep_rows

    def broken(scene, jet=None, **more):
        if scene.jet.k.value > 1.5:
            raise ZeroDivisionError("a bug")
        return real(scene, jet, **more)

    real = sweep_rows.evaluate
    monkeypatch.setattr(sweep_rows, "evaluate", broken)
    sweep = sweep_from_dict({"scene": "peo5-water", "vary": {"jet.k": [1.0, 2.0]}})
    result = run_sweep(sweep, vectorise=False, workers=1)
    assert result["status"].values.tolist() == [0, 3]
    assert str(result["reason"].values[1]) == "ZeroDivisionError: a bug"


def test_closed_forms_that_are_wrong_are_not_believed(monkeypatch):
    from spinline.solve import many

    real = many.crossover_velocity_ratio
    monkeypatch.setattr(many, "crossover_velocity_ratio", lambda phi, quality: 1.001 * real(phi, quality))
    sweep = sweep_from_dict({"scene": "peo5-water", "vary": {"jet.k": [1.0, 2.0]}})
    with pytest.warns(sl.SpinlineWarning, match="closed forms and single runs differ"):
        result = run_sweep(sweep, workers=1)
    assert result.attrs["computed_by"] == "one scene at a time"


# the store


def test_a_store_is_what_memory_holds_and_opens_as_a_grid(tmp_path):
    data = {
        "scene": "peo5-water",
        "profiles": ["radius", "orientation"],
        "points": 5,
        "chunk": 7,
        "vary": {"jet.k": {"linspace": [0.1, 2, 5]}, "network.closure": ["force", "stretch"], "jet.beta": [0.4, 0.5]},
    }
    sweep = sweep_from_dict(data)
    memory, stored = run_sweep(sweep), run_sweep(sweep, tmp_path / "s.zarr")
    same(memory, stored)
    grid = open_sweep(tmp_path / "s.zarr", grid=True)
    assert grid["crossover_radius"].dims == ("jet.k", "network.closure", "jet.beta")
    assert grid["profile_radius"].shape == (5, 2, 2, 5)
    assert grid["network.closure"].values.tolist() == ["force", "stretch"]
    assert grid["jet.k"].values.tolist() == np.linspace(0.1, 2, 5).tolist()
    np.testing.assert_array_equal(grid["crossover_position"].values.ravel(), memory["crossover_position"].values)
    same(grid, as_grid(memory))
    assert memory["jet.k"].attrs["units"] == "1"
    assert memory["crossover_radius"].attrs["units"] == "m"
    with pytest.raises(InputError, match="is not the design"):
        as_grid(run_sweep(sweep_from_dict(spec(samples=4))))


def test_a_signal_waits_for_a_store_that_is_being_made(tmp_path, monkeypatch):
    """zarr's threads wrote on into a folder that was being given up: "was made by another process meanwhile", status 2."""
    from spinline.study import store

    path, checksum = tmp_path / "s.zarr", store._checksum
    stopped = lambda *given: [signal.raise_signal(signal.SIGINT), checksum(*given)][1]  # noqa: E731
    monkeypatch.setattr(store, "_checksum", stopped)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background has none
    with pytest.raises(KeyboardInterrupt):
        run_sweep(sweep_from_dict(spec(samples=40, chunk=8)), path)
    signal.signal(signal.SIGINT, before)
    monkeypatch.undo()
    assert os.listdir(tmp_path) == ["s.zarr"]
    same(run_sweep(sweep_from_dict(spec(samples=40, chunk=8)), path), run_sweep(sweep_from_dict(spec(samples=40))))


@pytest.mark.slow
def test_a_store_goes_on_refuses_another_sweep_and_starts_anew_when_forced(tmp_path):
    path = tmp_path / "s.zarr"
    run_sweep(sweep_from_dict(spec(samples=40, chunk=8)), path)
    first = (path / "crossover_radius" / "c" / "0").stat().st_mtime_ns
    (path / "status" / "c" / "2").write_bytes(b"cut off")  # as a kill on another file system may leave it
    (path / "status" / "c" / "4").unlink()
    seen = []
    again = run_sweep(
        sweep_from_dict(spec(samples=40, chunk=3)), path, progress=lambda done, total: seen.append((done, total))
    )
    assert seen == [(24, 40), (32, 40), (40, 40)]
    same(again, run_sweep(sweep_from_dict(spec(samples=40))))
    assert (path / "crossover_radius" / "c" / "0").stat().st_mtime_ns == first
    with pytest.raises(InputError, match="holds another sweep"):
        run_sweep(sweep_from_dict(spec(samples=41)), path)
    run_sweep(sweep_from_dict(spec(samples=41)), path, force=True)
    assert open_sweep(path).sizes["scene"] == 41
    (tmp_path / "other").mkdir()
    for force in (False, True):
        with pytest.raises(InputError, match="is no sweep"):
            run_sweep(sweep_from_dict(spec(samples=4)), tmp_path / "other", force=force)
    with pytest.raises(InputError, match="is not a sweep"):
        open_sweep(tmp_path / "other")
    with pytest.raises(InputError, match="folder does not exist"):
        run_sweep(sweep_from_dict(spec(samples=4)), tmp_path / "nowhere" / "s.zarr")


def kill_when(process, path, chunks, limit=90.0):
    """Kill a process once so many chunks are in the store."""
    end = time.monotonic() + limit
    while time.monotonic() < end:
        done = len(list((path / "status" / "c").glob("*"))) if (path / "status" / "c").exists() else 0
        if done >= chunks:
            process.send_signal(signal.SIGKILL)
            process.wait()
            return done
        assert process.poll() is None, "it ended before it could be killed"
        time.sleep(0.01)
    raise AssertionError("it did not get that far")


@pytest.mark.slow
def test_a_sweep_killed_midway_goes_on_and_ends_the_same(tmp_path):
    path, data = tmp_path / "s.zarr", spec(samples=400, chunk=20)
    code = f"""
        from spinline.study.sweep import run_sweep, sweep_from_dict
        run_sweep(sweep_from_dict({data!r}), {str(path)!r}, workers=1, vectorise=False)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(code)], env=SCRIPT_ENV)
    kept = kill_when(process, path, 4)
    assert kept < 60
    times = {file.name: file.stat().st_mtime_ns for file in (path / "end_radius" / "c").glob("?")}
    partial = open_sweep(path)
    assert (partial["status"] == 255).any()
    seen = []
    resumed = run_sweep(
        sweep_from_dict(data), path, workers=1, vectorise=False, progress=lambda done, total: seen.append(done)
    )
    assert seen[0] >= 20 * (kept - 1)
    done = sorted(times, key=int)[:3]
    assert all((path / "end_radius" / "c" / name).stat().st_mtime_ns == times[name] for name in done)
    same(resumed, run_sweep(sweep_from_dict(data), workers=1, vectorise=False))


def test_what_a_kill_left_beside_a_store_is_gone_after_the_next_start(tmp_path):
    """Killed after the store had its place, before the scratch folder was removed: the next start makes no scratch."""
    from spinline.base.naming import scratch_name

    sweep = sweep_from_dict(spec(samples=8))
    run_sweep(sweep, tmp_path / "s.zarr")
    left = tmp_path / scratch_name(tmp_path).name.replace(f"-{os.getpid()}-", "-4194999-")  # beyond the largest pid
    left.mkdir()
    run_sweep(sweep, tmp_path / "s.zarr")
    assert [path.name for path in tmp_path.iterdir()] == ["s.zarr"]


def test_processes_give_the_same_and_survive_the_death_of_one():
    import multiprocessing

    sweep = sweep_from_dict(spec(samples=200, chunk=10))
    alone = run_sweep(sweep, workers=1, vectorise=False)
    killed = []

    def kill_one(done, total):
        children = multiprocessing.active_children()
        if done >= 48 and not killed and children:
            killed.append(children[0].pid)
            os.kill(children[0].pid, signal.SIGKILL)

    same(alone, run_sweep(sweep, workers=2, vectorise=False, progress=kill_one))
    assert killed


@pytest.mark.slow
def test_a_cluster_whose_worker_and_client_are_killed_gives_the_same(tmp_path):
    distributed = pytest.importorskip("distributed")
    path, data = tmp_path / "s.zarr", spec(samples=500, chunk=10)
    sweep = sweep_from_dict(data)
    undisturbed = run_sweep(sweep, workers=1, vectorise=False)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        code = f"""
            from spinline.study.sweep import run_sweep, sweep_from_dict
            run_sweep(sweep_from_dict({data!r}), {str(path)!r}, scheduler={cluster.scheduler_address!r}, vectorise=False)
        """
        client = subprocess.Popen([sys.executable, "-c", textwrap.dedent(code)], env=SCRIPT_ENV)
        kept = kill_when(client, path, 10)
        seen, killed = [], []

        def watch(done, total):
            seen.append(done)
            if len(seen) == 10:
                worker = next(iter(cluster.workers.values()))
                killed.append(worker.process.pid)
                os.kill(worker.process.pid, signal.SIGKILL)

        resumed = run_sweep(sweep, path, scheduler=cluster.scheduler_address, vectorise=False, progress=watch)
    assert killed
    assert seen[0] >= 10 * (kept - 1)
    assert seen[-1] == 500
    same(resumed, undisturbed)


def test_a_scheduler_that_is_not_there_is_named():
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match="--scheduler"):
        run_sweep(sweep_from_dict(spec(samples=4)), scheduler="nonsense://x")


# the command


def test_the_command_writes_goes_on_and_prints(spinline, tmp_path):
    (tmp_path / "s.toml").write_text(
        'scene = "peo5-water"\n[vary]\njet.k = { linspace = [0.1, 2, 9] }\nsolution.mass_fraction = ["5 wt%", "120 kg"]\n'
    )
    ran = spinline("sweep", "s.toml")
    assert ran.code == 2
    assert ran.err.startswith("error: vary.solution.mass_fraction.values = '120 kg'")
    (tmp_path / "s.toml").write_text('scene = "peo5-water"\n[vary]\njet.k = { linspace = [0.1, 2, 9] }\n')
    ran = spinline("sweep", "s.toml")
    assert ran.code == 0, ran.err
    assert ran.out.startswith("9 scenes, ")
    assert "the crossover is not reached within the jet" in ran.out
    assert (tmp_path / "s.zarr").is_dir()
    assert spinline("sweep", "s.toml", "--json").json["scenes"] == 9
    ran = spinline("sweep", "s.toml", "--set", "jet.beta=0.5")
    assert ran.code == 2
    assert "holds another sweep" in ran.err
    assert spinline("sweep", "s.toml", "--set", "jet.beta=0.5", "--force").code == 0


def test_the_bundled_sweep_runs(spinline):
    from spinline.study.sweep import bundled_sweeps

    for name in bundled_sweeps():
        ran = spinline("sweep", name, "--json")
        assert ran.code == 0, ran.err
        assert ran.json["ok"] == ran.json["scenes"]
