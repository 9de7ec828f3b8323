"""One forward model: a run, a row of a sweep, a fit, a point of a window and an overlay say the same of one scene."""

import warnings

import numpy as np
import pytest
import xarray as xr

import spinline as sl
from spinline.fit.overlay import compare_theory
from spinline.fit.scene_model import forward_model
from spinline.network_models import RUNGS
from spinline.scene import load_scene
from spinline.setup import context as setup_context
from spinline.study.rows import PROFILES
from spinline.study.sweep import run_sweep, sweep_from_dict
from spinline.study.window import operating_window

POINTS = 41
BASE = {"accuracy.points": POINTS}
VARIANTS = {
    "affine": {"network.model": "affine"},
    "affine, stretch": {"network.model": "affine", "network.closure": "stretch"},
    "manifold, linear": {"network.model": "manifold", "network.force_law": "linear", "network.coupling": 200},
    "manifold, lattice": {"network.model": "manifold", "network.coupling": 2000},
    "chain": {
        "network.model": "chain",
        "network.force_law": "linear",
        "network.coarse_grain": 40,
        "network.coupling": 500,
    },
    "two-fluid": {"network.model": "two-fluid", "solution.relaxation_time": "10 ms", "network.coupling": 2000},
    "conformation": {"network.model": "conformation", "solution.relaxation_time": "10 ms"},
    "FENE-P": {"network.model": "conformation", "solution.relaxation_time": "10 ms", "network.closure": "stretch"},
    "drying": {
        "network.model": "conformation",
        "solution.relaxation_time": "10 ms",
        "effects.evaporation": True,
        "ambient.relative_humidity": 0.2,
    },
    "drying, manifold": {
        "network.model": "manifold",
        "network.force_law": "linear",
        "network.coupling": 300,
        "effects.evaporation": True,
        "ambient.relative_humidity": 0.2,
    },
    "auto": {"network.coupling": 200},
    "walk": {"network.model": "walk", "accuracy.strands": 50},
}


def scene_of(variant):
    """A scene and its run."""
    text = [
        f"{key}={str(value).lower() if isinstance(value, bool) else value}"
        for key, value in {**BASE, **VARIANTS[variant]}.items()
    ]
    scene = load_scene("peo5-water", text)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        return scene, sl.run(scene)


def same(one, other, rtol=1e-12):
    np.testing.assert_allclose(one, other, rtol=rtol, atol=1e-300)


def test_every_rung_is_among_the_variants():
    assert set(RUNGS) <= {values.get("network.model", "auto") for values in VARIANTS.values()}


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_row_of_a_sweep_is_a_run(variant):
    _, result = scene_of(variant)
    names = [name for name in PROFILES if name in result]
    fixed = {key: value for key, value in VARIANTS[variant].items() if key != "network.model"}
    data = {
        "scene": "peo5-water",
        "set": {**BASE, **fixed, "network.model": VARIANTS[variant].get("network.model", "auto")},
        "profiles": names,
        "points": POINTS,
        "vary": {"jet.k": [1.0, 1.1]},
    }
    row = run_sweep(sweep_from_dict(data), workers=1).isel(scene=0)
    assert int(row["status"]) in (0, 1), str(row["reason"].values)
    z, here = result["z"].values, row["profile_z"].values
    nearest = np.clip(np.searchsorted(z, here), 1, z.size - 1)
    nearest -= here - z[nearest - 1] < z[nearest] - here
    on = np.abs(z[nearest] - here) <= 1e-12 * z[-1]
    assert on.sum() >= POINTS - 3  # the crossovers lie between
    for name in names:
        same(
            row[f"profile_{name}"].values[on], result[name].values[nearest][on], 2e-12
        )  # a place may be a rounding apart
    for name in ("crossover_position", "crossover_radius", "end_orientation", "fibre_radius"):
        same(row[name], result[name])


@pytest.mark.parametrize("variant", [v for v in VARIANTS if v != "walk"])
def test_a_fit_is_held_against_what_a_run_shows(variant):
    scene, result = scene_of(variant)
    model = forward_model(scene)
    assert model.model == result.attrs["model"]
    seen = model.predict(result["z"].values)
    for name, field in (
        ("radius", "radius"),
        ("mean", "mean_polymer_fraction"),
        ("core", "core_polymer_fraction"),
        ("velocity_ratio", "velocity_ratio"),
        ("stretch", "strand_stretch"),
        ("relative_extension", "relative_extension"),
    ):
        same(getattr(seen, name), result[field].values)
    same(seen.orientation + 1, result["orientation"].values + 1)
    same(seen.core_radius_ratio, np.minimum(result["network_radius"] / result["radius"], 1.0))
    same(
        1 - seen.remaining,
        result["evaporated_fraction"] if "evaporated_fraction" in result else np.zeros(seen.radius.size),
        1e-9,
    )


@pytest.mark.filterwarnings("ignore::spinline.SpinlineWarning")
@pytest.mark.parametrize("variant", ["affine", "manifold, linear", "FENE-P", "auto"])
def test_an_overlay_predicts_what_a_run_shows(variant):
    scene, result = scene_of(variant)
    edges = np.linspace(0, 1, 9)
    z = result["z"].values[1:]
    shape = (z.size, 8)
    reduced = xr.Dataset(
        {
            "polymer_fraction": (("row", "shell"), np.full(shape, 0.05)),
            "polymer_fraction_std": (("row", "shell"), np.full(shape, 0.02)),
            "mean_polymer_fraction": ("row", np.full(z.size, 0.05)),
            "mean_polymer_fraction_std": ("row", np.full(z.size, 0.004)),
            "jet_radius": ("row", result["radius"].values[1:], {"units": "m"}),
            "jet_radius_std": ("row", np.full(z.size, 5e-7)),
        },
        {"z": ("row", z, {"units": "m"}), "shell": 0.5 * (edges[1:] + edges[:-1])},
    )
    found = compare_theory(scene, reduced, core_within=0.126)  # the innermost ring, wholly within the core
    r0 = 125e-6
    same(found["radius_ratio_predicted"].values, result["radius"].values[1:] / r0)
    inside = np.minimum(result["network_radius"] / result["radius"], 1.0).values[1:] >= 0.125
    same(found["core_predicted"].values[inside], result["core_polymer_fraction"].values[1:][inside])


@pytest.mark.parametrize("model", ["affine", "manifold"])
def test_a_point_of_a_window_is_a_run(model):
    base = load_scene("pcl9-dcm", [f"network.model={model}", "jet.length=5 mm"])
    found = operating_window(base, voltage=[8e3], gap=[0.1], workers=1).isel(
        voltage=0, gap=0, flow_rate=0, mass_fraction=0
    )
    for i, factor in enumerate((0.5, 1.0, 2.0)):
        point = found.isel(k_factor=i)
        k = float(point["k"])
        scene = load_scene("pcl9-dcm", [f"network.model={model}", "jet.length=5 mm"])
        section = scene.jet.model_copy(
            update={"k": sl.units.parse(k, "number", ""), "electric_field": None, "conductivity": None}
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sl.SpinlineWarning)
            result = sl.run(scene.model_copy(update={"jet": section}))
        same(float(point["k_factor"]), factor)
        same(point["crossover_radius"], result["crossover_radius"])
        same(point["crossover_position"], result["crossover_position"])
        same(point["orientation"] + 1, result["end_orientation"] + 1)
        same(point["core_polymer_fraction"], result["end_core_polymer_fraction"])


@pytest.mark.parametrize("name", ["pmma10-drying", "peo5-fig37"])
def test_one_run_builds_everything_once(monkeypatch, name, quiet):
    counted = {}

    def count(what):
        real = getattr(setup_context, what)

        def counting(*args, **kwargs):
            counted[what] = counted.get(what, 0) + 1
            return real(*args, **kwargs)

        monkeypatch.setattr(setup_context, what, counting)

    built = (
        "build_solution",
        "build_jet",
        "build_air",
        "build_coupling",
        "build_material",
        "network_at_rest",
        "diffusion_law",
        "glass_fraction",
    )
    for what in built:
        count(what)
    sl.run(load_scene(name))
    assert counted == dict.fromkeys(built, 1)


def test_nothing_but_the_context_builds():
    """Neither the air, the coupling nor the network at rest is built anywhere else in the rooms of a run."""
    from pathlib import Path

    rooms = Path(sl.__file__).parent
    wrong = [
        f"{file.parent.name}/{file.name}: {call}"
        for room in ("plan", "solve", "network_models", "fit", "drying")
        for file in (rooms / room).rglob("*.py")
        for call in ("build_air(", "build_coupling(", "network_at_rest(", "build_material(")
        if call in file.read_text(encoding="utf-8")
    ]
    assert wrong == []
