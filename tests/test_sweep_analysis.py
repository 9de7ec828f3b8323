"""What is made of many results: Sobol' indices against known ones, the operating window, the comparison of two results."""

import warnings

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.jetprofile import estimate_k
from spinline.report.window_figure import save_window_figure, window_figure
from spinline.scene import load_scene
from spinline.study.compare import compare
from spinline.study.design import Axis, Design
from spinline.study.sensitivity import indices, sobol
from spinline.study.sweep import run_sweep, sweep_from_dict
from spinline.study.window import operating_window

# Sobol' indices


def test_indices_of_ishigami_are_the_published_ones():
    """Ishigami and Homma (1990), a = 7, b = 0.1: shares of the variance in closed form."""
    axes = [Axis(f"jet.{name}", np.array([-np.pi, np.pi]), "linear") for name in ("k", "beta", "p")]
    n = 2048
    design = Design("sensitivity", axes, n, seed=2)
    x = np.stack(list(design.rows(0, design.size).values()))
    y = (np.sin(x[0]) + 7 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0])).reshape(5, 1, n)
    found = indices(y[0], y[1], y[2:], resamples=200)
    v1, v2 = 0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2, 49 / 8
    v13 = 0.01 * np.pi**8 * (1 / 18 - 1 / 50)
    total = v1 + v2 + v13
    first = np.array([v1, v2, 0]) / total
    whole = np.array([v1 + v13, v2, v13]) / total
    np.testing.assert_allclose(found["first_order"][0], first, atol=0.02)
    np.testing.assert_allclose(found["total_order"][0], whole, atol=0.02)
    for name, exact in (("first_order", first), ("total_order", whole)):
        assert (found[f"{name}_low"][0] <= exact + 0.005).all()
        assert (exact - 0.005 <= found[f"{name}_high"][0]).all()
        width = found[f"{name}_high"] - found[f"{name}_low"]
        assert (width < 0.25).all()


def test_indices_of_the_crossover_radius_are_those_of_a_product():
    """r_S = r_0 phi^(1/2) with r_0 and phi uniform and independent: V = E[g^2] E[h^2] - (E[g] E[h])^2."""
    sweep = sweep_from_dict(
        {
            "scene": "peo5-water",
            "design": {"kind": "sensitivity", "samples": 4096, "seed": 1},
            "vary": {
                "solution.volume_fraction": {"uniform": [0.02, 0.2]},
                "jet.radius": {"uniform": ["100 um", "150 um"]},
                "jet.length": {"uniform": ["30 cm", "40 cm"]},
            },
        },
        ["network.model=affine"],
    )
    result = run_sweep(sweep)
    found = sobol(result, ["crossover_radius", "crossover_core_polymer_fraction"], resamples=100)
    a, b, c, d = 0.02, 0.2, 100e-6, 150e-6
    g1, g2 = (b**1.5 - a**1.5) / 1.5 / (b - a), (a + b) / 2
    h1, h2 = (c + d) / 2, (c * c + c * d + d * d) / 3
    variance = g2 * h2 - (g1 * h1) ** 2
    first = np.array([(g2 - g1**2) * h1**2, (h2 - h1**2) * g1**2, 0.0]) / variance
    total = np.array([1 - first[1], 1 - first[0], 0.0])
    radius = found.sel(output="crossover_radius")
    np.testing.assert_allclose(radius["first_order"], first, atol=0.01)
    np.testing.assert_allclose(radius["total_order"], total, atol=0.01)
    np.testing.assert_allclose(radius["mean"], g1 * h1, rtol=2e-3)
    np.testing.assert_allclose(radius["std"], np.sqrt(variance), rtol=1e-2)
    core = found.sel(output="crossover_core_polymer_fraction")  # a function of phi alone
    np.testing.assert_allclose(core["first_order"], [1, 0, 0], atol=0.02)
    np.testing.assert_allclose(core["total_order"], [1, 0, 0], atol=0.02)
    assert sobol(result, ["crossover_radius"], resamples=100).sel(output="crossover_radius").equals(radius)


def test_indices_refuse_what_has_none():
    data = {
        "scene": "peo5-water",
        "design": {"kind": "sensitivity", "samples": 8},
        "vary": {"jet.k": {"uniform": [0.01, 2]}, "jet.beta": {"uniform": [0.3, 0.5]}},
    }
    result = run_sweep(sweep_from_dict(data))
    with pytest.raises(InputError, match=r"is missing in \d+ of 32 scenes.*not reached"):
        sobol(result, ["crossover_radius"])
    with pytest.raises(InputError, match="is not a number of this sweep"):
        sobol(result, ["crossover_radus"])
    flat = sobol(result, ["volume_fraction"], resamples=5)
    assert flat["first_order"].isnull().all()
    data["design"] = {"kind": "sobol", "samples": 8}
    with pytest.raises(InputError, match="has no Sobol' indices"):
        sobol(run_sweep(sweep_from_dict(data)))


def test_the_command_prints_indices(spinline, tmp_path):
    (tmp_path / "s.toml").write_text(
        'scene = "peo5-water"\n[design]\nkind = "sobol"\nsamples = 64\n[vary]\njet.k = { uniform = [0.8, 1.2] }\n'
        'jet.length = { uniform = ["1 m", "2 m"] }\nsolution.mass_fraction = { uniform = [0.03, 0.06] }\n'
    )
    ran = spinline(
        "sweep", "s.toml", "--sobol", "--output", "crossover_radius", "--output", "end_core_polymer_fraction"
    )
    assert ran.code == 0, ran.err
    assert ran.out.startswith("320 scenes, 320 ok")
    assert "crossover_radius: 2." in ran.out
    assert "does not vary" in ran.out
    rows = spinline("sweep", "s.toml", "--sobol", "--output", "crossover_radius", "--json").json["indices"]
    shares = {row["parameter"]: row["first_order"] for row in rows}
    assert shares["solution.mass_fraction"] > 0.95
    assert abs(shares["jet.k"]) < 0.05


# operating window


def test_a_point_of_the_window_is_a_run_with_the_estimated_k():
    scene = load_scene("peo5-water")
    window = operating_window(scene, voltage=[4e3, 9e3], gap=0.15, conductivity=0.01, relative_humidity=0.4)
    k = float(window["k"].sel(k_factor=1, voltage=9e3).squeeze())
    np.testing.assert_allclose(k, 0.5923066736, rtol=1e-8)
    exact = estimate_k(radius=125e-6, flow_rate=3.2e-6 / 3600, conductivity=0.01, viscosity=2.0, electric_field=6e4)
    np.testing.assert_allclose(k, exact, rtol=1e-14)
    run = sl.run(load_scene("peo5-water", [f"jet.k={k!r}"]))
    point = window.sel(k_factor=1, voltage=9e3).squeeze()
    np.testing.assert_allclose(point["crossover_position"], run["crossover_position"], rtol=1e-12)
    np.testing.assert_allclose(point["orientation"], run["orientation"][-1], rtol=1e-12)
    np.testing.assert_allclose(point["core_polymer_fraction"], run["core_polymer_fraction"][-1], rtol=1e-12)
    np.testing.assert_allclose(
        point["full_stretch"], run["velocity_ratio"][-1] / run["crossover_velocity_ratio"], rtol=1e-12
    )
    strands = run.attrs["strands_per_chain"]
    np.testing.assert_allclose(point["strands_per_chain"], strands, rtol=1e-12)


def test_the_band_of_k_moves_the_crossover_as_its_power_law():
    scene = load_scene("peo5-water", ["jet.length=14 cm"])
    window = operating_window(scene, voltage=9e3, gap=0.15, conductivity=0.01, k_factor=(0.5, 3.0)).squeeze()
    np.testing.assert_allclose(window["k"] / window["k"].sel(k_factor=1), [0.5, 1, 3])
    z = window["crossover_position"].values
    np.testing.assert_allclose(z / z[1], np.array([0.5, 1, 3]) ** (-1 / 0.47), rtol=1e-12)
    np.testing.assert_allclose(window["crossover_radius"], window["crossover_radius"][1], rtol=1e-12)
    assert np.isnan(window["dryness"]).all()
    assert "relative_humidity: is missing" in window.attrs["air"]


def test_dryness_is_that_of_a_run(quiet):
    scene = load_scene("peo5-water", ["jet.length=10 mm"])
    window = operating_window(scene, voltage=9e3, gap=0.15, conductivity=0.01, relative_humidity=0.4).squeeze()
    for factor in window["k_factor"].values:
        k = float(window["k"].sel(k_factor=factor))
        asked = [
            "jet.length=10 mm",
            f"jet.k={k!r}",
            "network.model=affine",
            "effects.evaporation=true",
            "ambient.relative_humidity=0.4",
        ]
        run = sl.run(load_scene("peo5-water", asked))
        share = run["evaporated_fraction"].values[-1] / (1 - float(run["volume_fraction"]))
        np.testing.assert_allclose(window["dryness"].sel(k_factor=factor), share, rtol=1e-9)


def test_dryness_between_the_nodes_is_that_of_the_stage(monkeypatch):
    from spinline.study import window as study

    scene = load_scene("pcl9-dcm", ["network.model=affine"])
    asked = {"voltage": np.linspace(2e3, 2e4, 8), "gap": np.array([0.1, 0.2]), "workers": 1}
    exact = operating_window(scene, **asked)["dryness"].values
    monkeypatch.setattr(study, "_NODES", 17)
    np.testing.assert_allclose(operating_window(scene, **asked)["dryness"].values, exact, rtol=2e-3)


def test_viscosity_follows_the_concentration_by_the_law_that_is_known():
    scene = load_scene("peo5-water")
    mass = np.array([0.03, 0.05, 0.08])
    window = operating_window(scene, voltage=9e3, gap=0.15, mass_fraction=mass, conductivity=0.01).squeeze()
    mu = window["viscosity"].sel(k_factor=1).values
    assert "scaling, theta" in window.attrs["viscosity_law"]
    np.testing.assert_allclose(mu[1], 2.0, rtol=1e-12)
    assert 2 * (8 / 5) ** 4.5 < mu[2] < 2 * (8 / 5) ** 4.9
    fitted = load_scene("peo5-water", ["rheology.B=7", "rheology.m=0.1"])
    window = operating_window(fitted, voltage=9e3, gap=0.15, mass_fraction=mass, conductivity=0.01).squeeze()
    np.testing.assert_allclose(window["viscosity"].sel(k_factor=1), 2 * 10 ** (7 * (mass**0.1 - 0.05**0.1)), rtol=1e-12)


def test_a_window_refuses_what_it_cannot_estimate():
    scene = load_scene("peo5-water")
    good = {"voltage": 9e3, "gap": 0.15, "conductivity": 0.01}
    for change, words in (
        ({"conductivity": None}, "conductivity: is missing"),
        ({"gap": 1e-3}, "shorter than the jet"),
        ({"voltage": [2e3, 1e3]}, "is not a rising list"),
        ({"voltage": -1.0}, "voltage = -1.0"),
        ({"k_factor": (2.0, 3.0)}, "does not hold 1"),
        ({"mass_fraction": 1.5}, "mass_fraction = 1.5"),
    ):
        with pytest.raises(InputError) as error:
            operating_window(scene, **(good | change))
        assert words in str(error.value)
    with pytest.raises(InputError, match="has no k to estimate"):
        operating_window(load_scene("pvp-jetspin"), **good)


@pytest.mark.slow
def test_the_window_command_and_its_figures(spinline, tmp_path):
    common = (
        "peo5-water",
        "--set",
        "network.model=affine",
        "--gap",
        "15 cm",
        "--conductivity",
        "0.01 S/m",
        "--steps",
        "7",
    )
    ran = spinline(
        "window", *common, "--voltage", "5 kV .. 25 kV", "--concentration", "3 wt% .. 10 wt%", "--humidity", "40 %"
    )
    assert ran.code == 0, ran.err
    assert "crossover within the jet in" in ran.out
    assert (tmp_path / "peo5-water-window.png").read_bytes().startswith(b"\x89PNG")
    stored = sl.results.open_dataset(tmp_path / "peo5-water-window.nc")
    assert stored["dryness"].shape == (3, 7, 1, 1, 7)
    figure = window_figure(stored)
    assert len([axis for axis in figure.axes if axis.get_title()]) == 4
    assert spinline("window", *common, "--voltage", "5 kV .. 25 kV").code == 2  # exists
    ran = spinline("window", *common, "--voltage", "10 kV .. 40 kV", "--force", "--json")
    assert ran.json["reached_low"] < 1 == ran.json["reached_high"]
    one = sl.results.open_dataset(tmp_path / "peo5-water-window.nc")
    assert len(window_figure(one).axes) == 4
    with pytest.raises(InputError, match="one point"):
        save_window_figure(one.isel(voltage=[0]), tmp_path / "w.png")
    for bad, words in (("5 kV .. 4 kV", "does not rise"), ("5", "needs a unit"), ("1 kV .. 2 kV .. 3 kV", "range")):
        ran = spinline("window", *common, "--voltage", bad, "--force")
        assert ran.code == 2
        assert words in ran.err


# comparison


def results(*overrides):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        return sl.run(load_scene("peo5-water", list(overrides)))


def test_a_result_differs_from_itself_in_nothing_and_units_do_not_matter():
    found = compare(results(), results("jet.radius=0.125 mm"))
    assert found.same
    assert not found.scene
    assert found.scalars == found.profiles == ()


def test_what_differs_is_found_where_it_is_largest():
    a, b = results("accuracy.points=801"), results("jet.k=0.5", "network.closure=stretch")
    found = compare(a, b)
    assert {(d.name, d.a, d.b) for d in found.scene} == {
        ("jet.k", 1.0, 0.5),
        ("network.closure", None, "stretch"),
        ("accuracy.points", 801, None),
    }
    assert ("closure", "force", "stretch") in {(d.name, d.a, d.b) for d in found.models}
    numbers = {d.name: d for d in found.scalars}
    position = numbers["crossover_position"]
    assert np.isnan(position.b)
    assert np.isnan(position.relative)
    radius = next(p for p in found.profiles if p.name == "velocity_ratio")
    exact = np.maximum(found.span[1] / 125e-6, 1) ** 0.94  # at the end: V and V / 4
    assert exact > 1
    np.testing.assert_allclose(radius.largest, 0.75, rtol=1e-3)
    assert radius.position > 125e-6 * 0.5 ** (-1 / 0.47) * 0.99
    np.testing.assert_allclose(radius.of_range, 0.75, rtol=1e-6)


def test_other_grids_are_compared_to_their_interpolation():
    found = compare(results("accuracy.points=4001"), results("accuracy.points=2001"), rtol=1e-4)
    smooth = {"radius", "velocity_ratio", "stretch_ratio", "residence_time", "relative_extension"}
    assert not smooth & {p.name for p in found.profiles}
    assert not found.scalars
    assert found.places > 4001


def test_jets_of_other_lengths_are_compared_where_both_are():
    found = compare(results(), results("jet.length=2 mm"))
    assert found.span == (0.0, 2e-3)
    assert {"crossover_position"} <= {s.name for s in found.scalars}


def test_a_flag_that_flips_and_a_variable_of_one_side_are_named():
    found = compare(results(), results("network.model=manifold"))
    assert set(found.only_b) == {"slip_velocity", "drag_force", "scission", "far_end_effect"}
    assert not found.same
    bead = sl.run(load_scene("pvp-jetspin"))
    assert compare(bead, bead).same
    assert not compare(bead, results()).same


@pytest.mark.slow
def test_the_command_compares_and_gives_json(spinline):
    for name, k in (("a", 1.0), ("b", 0.9)):
        assert spinline("run", "peo5-water", "--set", f"jet.k={k}", "-o", f"{name}.nc", "--no-figure").code == 0
    ran = spinline("compare", "a.nc", "b.nc")
    assert ran.code == 0
    assert "scene    jet.k: 1 | 0.9" in ran.out.replace("1.0 |", "1 |")
    assert "number   crossover_position: 0.0034324 | 0.00429491 m (20.1 %)" in ran.out
    found = spinline("compare", "a.nc", "b.nc", "--json").json
    assert found["same"] is False
    assert {"name": "jet.k", "a": 1.0, "b": 0.9} in found["scene"]
    assert spinline("compare", "a.nc", "a.nc").out.startswith("no number differs")
    assert spinline("compare", "a.nc", "b.nc", "--tolerance", "0.999").out.count("number ") == 0
    ran = spinline("compare", "a.nc", "nix.nc")
    assert ran.code == 2
    assert "nix.nc: is not a file" in ran.err


WINDOW = (
    "window",
    "peo5-water",
    "--voltage",
    "5 .. 25 kV",
    "--gap",
    "15 cm",
    "--conductivity",
    "0.01 S/m",
    "--humidity",
    "40 %",
    "--steps",
    "3",
    "--set",
    "network.model=affine",
    "--no-figure",
)


def test_a_concentration_in_bare_percent_is_told_its_unit(spinline):
    ran = spinline(*WINDOW, "--concentration", "6..14")
    assert ran.code == 2
    assert "--concentration" in ran.err
    assert '"6..14 wt%"' in ran.err


def test_a_range_has_the_unit_of_its_end(spinline):
    assert spinline(*WINDOW, "--concentration", "6 .. 14 wt%").code == 0
    import xarray as xr

    with xr.open_dataset("peo5-water-window.nc", engine="h5netcdf") as found:
        assert found["mass_fraction"].values == pytest.approx([0.06, 0.10, 0.14])
        assert found["voltage"].values == pytest.approx([5e3, 15e3, 25e3])


def test_a_long_command_is_not_silent(monkeypatch, capsys):
    from spinline.cli import progress

    monkeypatch.setattr(progress, "_QUIET", 0.0)
    monkeypatch.setattr(progress, "_EVERY", 0.0)
    with progress.progress_of("scenes") as said:
        said(1, 3)
        said(3, 3)
    assert capsys.readouterr().err == "1 of 3 scenes\n"
