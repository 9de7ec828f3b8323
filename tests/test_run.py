"""The main job, from a scene to a result: reference values, every bundled scene, files, figure, report."""

import json
import warnings

import numpy as np
import pytest
import xarray as xr

import spinline as sl
from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile import PowerLaw
from spinline.scene import bundled_scenes, load_scene, scene_from_dict
from spinline.solve.results import VARIABLES, scalars


def quiet(name: str, *overrides: str) -> xr.Dataset:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        return sl.run(load_scene(name, overrides))


def test_crossover_of_peo_five_percent() -> None:
    result = sl.run(load_scene("peo5-water"))
    phi = float(result["volume_fraction"])
    assert float(result["crossover_radius_ratio"]) == pytest.approx(np.sqrt(phi), rel=1e-12)
    assert float(result["crossover_position"]) == pytest.approx(125e-6 * (1 / phi) ** (1 / 0.94), rel=1e-12)
    assert float(result["crossover_velocity_ratio"]) == pytest.approx(1 / phi, rel=1e-12)
    assert float(result["crossover_radius"]) == pytest.approx(125e-6 * np.sqrt(phi), rel=1e-12)
    assert round(phi, 4) == 0.0444
    # given as a volume fraction, the design's own case: s_S = 24.2144418829
    by_volume = sl.run(load_scene("peo5-water", ["solution={polymer='PEO', solvent='water', volume_fraction=0.05}"]))
    assert float(by_volume["crossover_position"]) == pytest.approx(3.02680523536e-3, rel=1e-11)


def test_result_holds_the_designed_names_with_units() -> None:
    result = sl.run(load_scene("peo5-water"))
    names = [
        "radius",
        "velocity",
        "velocity_ratio",
        "strain_rate",
        "residence_time",
        "stretch_ratio",
        "mean_polymer_fraction",
        "axial_stretch",
        "relative_extension",
        "radial_contraction",
        "orientation",
        "network_velocity_ratio",
        "network_radius",
        "core_polymer_fraction",
        "core_polymer_fraction_eq40",
        "core_polymer_fraction_conservative",
        "strand_force",
        "compacted",
    ]
    for name in names:
        assert result[name].dims == ("z",)
        assert result[name].attrs["long_name"]
        assert "units" in result[name].attrs or name == "compacted"
    assert result["compacted"].dtype == bool
    assert result["z"].attrs["units"] == "m"
    assert set(map(str, result.variables)) <= set(VARIABLES)
    z = result["z"].values
    assert z[0] == 0
    assert z[-1] == pytest.approx(5e-3, rel=1e-15)
    assert (np.diff(z) > 0).all()
    for place in ("crossover_position", "crossover_extension_position"):
        assert float(result[place]) in z
    assert result.attrs["scene"] == load_scene("peo5-water").text
    for name in ("model", "model_reason", "closure", "spinline_version", "references", "effects_left_out", "rtol"):
        assert name in result.attrs


def test_a_result_says_how_to_make_it_again(tmp_path) -> None:
    first = sl.run(load_scene("peo5-water", ["jet.k=0.9"]))
    again = tmp_path / "again.toml"
    again.write_text(first.attrs["scene"].replace("k = 1.0", "k = 0.9"), encoding="utf-8")
    assert sl.run(load_scene(again)).equals(first)


@pytest.mark.parametrize("name", bundled_scenes())
def test_bundled_scenes_run_within_physical_bounds(name: str) -> None:
    result = quiet(name)
    known = np.isfinite(result["stretch_ratio"].values)
    assert known.any()
    for variable in (
        "relative_extension",
        "radial_contraction",
        "core_polymer_fraction",
        "core_polymer_fraction_eq40",
        "core_polymer_fraction_conservative",
        "mean_polymer_fraction",
    ):
        values = result[variable].values[known]
        assert ((values >= 0) & (values <= 1)).all(), variable
    assert (result["network_radius"].values[known] <= result["radius"].values[known]).all()
    assert (np.abs(result["orientation"].values[known]) <= 1).all()
    assert (result["strand_force"].values[known] > 0).all()


def test_crossover_beyond_the_jet_is_nan_and_predicted() -> None:
    result = quiet("peo5-water", "jet.length=1 mm")
    assert np.isnan(float(result["crossover_position"]))
    assert np.isnan(float(result["crossover_radius"]))
    predicted = 125e-6 * (1 / float(result["volume_fraction"])) ** (1 / 0.94)
    assert f"{predicted:.9g}" in result.attrs["crossover"]
    assert "not reached" in result.attrs["crossover"]


def test_closures_differ_as_the_design_says() -> None:
    force = quiet("peo5-water", "network.closure=force", "jet.length=1.5 mm")
    stretch = quiet("peo5-water", "network.closure=stretch", "jet.length=10 mm")
    place = int(np.argmin(np.abs(stretch["velocity_ratio"].values - 30)))
    assert bool(stretch["contour_reached"][place])
    assert float(stretch["relative_extension"][place]) == 1
    assert np.isnan(float(stretch["strand_force"][place]))
    assert not force["contour_reached"].any()


def test_a_solvent_of_unknown_viscosity_is_no_obstacle() -> None:
    own = "solution={polymer='PEO', solvent={name='mine', density='0.9 g/cm3'}, mass_fraction=0.05}"
    with pytest.warns(SpinlineWarning, match="elastic slip is not estimated"):
        result = sl.run(load_scene("peo5-water", [own]))
    assert np.isnan(result.attrs["coupling"])
    assert "solvent_viscosity" in result.attrs["warnings"]
    with pytest.raises(InputError, match="solvent_viscosity"):
        sl.run(load_scene("peo5-water", [own, "network.model=manifold"]))


def test_good_solvent_crosses_over_sooner() -> None:
    theta, good = sl.run(load_scene("peo5-water")), quiet("peo5-water", "network.solvent_quality=good")
    phi = float(theta["volume_fraction"])
    assert float(good["crossover_velocity_ratio"]) == pytest.approx(phi**-0.5)
    assert float(good["crossover_radius_ratio"]) == pytest.approx(phi**0.25)
    assert float(good["crossover_position"]) < float(theta["crossover_position"])


def test_coupling_is_reported_with_its_viscosity() -> None:
    solvent = sl.run(load_scene("peo5-water")).attrs
    assert 1e4 < solvent["coupling"] < 2e4
    assert "solvent" in solvent["drag_viscosity"]
    solution = sl.run(load_scene("peo5-water", ["network.drag_viscosity=solution"])).attrs
    assert solution["coupling"] / solvent["coupling"] == pytest.approx(2.0 / 1.0016e-3, rel=2e-3)
    assert solvent["affinity_of_solvent_drag"] == pytest.approx(solvent["coupling"] * 1e-9 / (3 * 125e-6), rel=1e-12)
    weak = quiet("peo5-water", "network.coupling=20")
    assert weak.attrs["coupling_error"] == pytest.approx(3 / 20 * 0.94, rel=1e-3)  # steepest where the jet starts
    assert weak.attrs["model"] == "manifold"
    forced = quiet("peo5-water", "network.coupling=20", "network.model=affine")
    assert "affine network errs" in forced.attrs["warnings"]


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["solution.molar_mass=5 kDa"], "no entangled network"),
        (["solution.relaxation_time=1 ms", "effects.relaxation=false"], "relaxation is left out: De"),
        (["ambient.relative_humidity=0.4"], "evaporation is left out: leaving it out errs by about 0.00"),
        (["solution.mass_fraction=0.3", "jet.length=2 mm"], "compact"),
    ],
)
def test_odd_scenes_are_warned_about(overrides: list[str], words: str) -> None:
    with pytest.warns(SpinlineWarning, match=words):
        result = sl.run(load_scene("peo5-water", overrides))
    assert result.attrs["warnings"]


@pytest.mark.parametrize(
    ("overrides", "field"),
    [
        (["network.model=conformation"], "solution.relaxation_time"),
        (["effects.evaporation=true"], "ambient.relative_humidity"),
        (["network.model=affine", "network.force_law=fene"], "network.force_law"),
        (["solution.polymer=PE0"], "solution.polymer"),
        (["solution.solvent=vodka"], "solution.solvent"),
        (["solution.temperature=900 K"], "temperature"),
        (["jet={profile='table', path='none.csv', flow_rate='1 mL/h'}"], "jet.path"),
        (["jet={profile='jetspin', path='none'}"], "jet.path"),
        (
            [
                "solution.viscosity=1 Pa s",
                "jet={profile='power-law', radius='1 um', flow_rate='1 mL/h', beta=0.5, length='1 mm'}",
            ],
            "jet.k",
        ),
        (["jet.k=1e28", "jet.beta=0.25"], "k"),
    ],
)
def test_what_cannot_be_computed_is_refused(overrides: list[str], field: str) -> None:
    with pytest.raises(InputError, match=field):
        sl.run(load_scene("peo5-water", overrides))


def test_a_table_of_the_power_law_gives_the_power_laws_answer(tmp_path) -> None:
    jet = PowerLaw(radius=125e-6, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
    z = np.concatenate(([0.0], np.linspace(125e-6, 6e-3, 400)))
    rows = "\n".join(f"{1e3 * a:.17g},{1e6 * float(jet.radius(a)):.17g}" for a in z)
    (tmp_path / "jet.csv").write_text("z [mm],radius [um]\n" + rows)
    text = load_scene("peo5-water").text.split("[jet]")[0]
    (tmp_path / "s.toml").write_text(
        text + '[jet]\nprofile="table"\npath="jet.csv"\nflow_rate="3.2 mL/h"\nlength="5 mm"\n'
    )
    result, exact = sl.run(load_scene(tmp_path / "s.toml")), sl.run(load_scene("peo5-water"))
    for name in ("crossover_position", "crossover_extension_position", "crossover_radius"):
        assert float(result[name]) == pytest.approx(float(exact[name]), rel=1e-5)
    for change, words in (('length="5 mm"', "beyond"), ('path="jet.csv"', "radius")):
        bad = (
            (tmp_path / "s.toml")
            .read_text()
            .replace(change, 'length="9 mm"' if "length" in change else 'path="jet.csv"\nradius="5"')
        )
        (tmp_path / "bad.toml").write_text(bad)
        with pytest.raises(InputError, match=words):
            sl.run(load_scene(tmp_path / "bad.toml"))


def test_beads_from_any_simulator(tmp_path) -> None:
    """Beads of the straight power-law jet, two times: crossover of each, and the same as the analytic jet's."""
    jet = PowerLaw(radius=125e-6, flow_rate=3.2e-6 / 3600, k=1.0, beta=0.47)
    x = np.linspace(0, 5e-3, 3001)
    lines = []
    for time, last in ((0.0, 1000), (1.0, 3001)):
        for i in range(last):
            r = float(jet.radius(0.5 * (x[i] + x[i + 1]))) if i + 1 < last else None
            lines.append(f"{time},{float(x[i])!r},{'' if r is None else repr(1e6 * r)}")
    (tmp_path / "beads.csv").write_text("time [s],x [m],radius [um]\n" + "\n".join(lines))
    text = load_scene("peo5-water").text.split("[jet]")[0] + '[jet]\nprofile="lagrangian"\npath="beads.csv"\n'
    (tmp_path / "s.toml").write_text(text + 'radius = "125 um"\n')
    last = sl.run(load_scene(tmp_path / "s.toml"))
    phi = float(last["volume_fraction"])
    assert float(last["crossover_position"]) == pytest.approx(125e-6 * (1 / phi) ** (1 / 0.94), rel=1e-5)
    assert last["core_polymer_fraction"].dims == ("element",)
    assert last["x"].dims == ("bead",)
    both = sl.run(load_scene(tmp_path / "s.toml", ["jet.time=all"]))
    assert both["core_polymer_fraction"].dims == ("time", "element")
    assert both["crossover_position"].dims == ("time",)
    assert np.isnan(both["crossover_position"].values[0])
    assert both["crossover_position"].values[1] == float(last["crossover_position"])
    assert np.isnan(both["orientation"].values[0, 1500])
    assert not both["compacted"].values[0, 1500]
    sl.results.save(both, tmp_path / "both.nc")
    assert sl.open_result(tmp_path / "both.nc").equals(both)
    sl.results.to_csv(both, tmp_path / "both.csv")
    assert "1 of 2 times" in both.attrs["crossover"]
    assert len(sl.figures.png(both)) > 10_000
    assert "the last" in sl.report.words(both)[0]


def test_files_round_trip(tmp_path) -> None:
    result = sl.run(load_scene("peo5-water"))
    path = sl.results.save(result, tmp_path / "out.nc")
    back = sl.open_result(path)
    assert back.identical(result)
    assert list(tmp_path.iterdir()) == [path]
    table = sl.results.to_csv(result, tmp_path / "out.csv").read_text().splitlines()
    assert table[0].startswith("z [m],radius [m],velocity [m s-1],velocity_ratio")
    assert len(table) == result.sizes["z"] + 1
    data = json.loads(sl.results.to_json(result))
    assert data["crossover_position"] == float(result["crossover_position"])
    assert len(data["radius"]) == result.sizes["z"]
    assert json.loads(sl.results.to_json(quiet("peo5-water", "jet.length=1 mm")))["crossover_position"] is None


def test_files_refused(tmp_path) -> None:
    result = sl.run(load_scene("peo5-water"))
    (tmp_path / "there.nc").write_text("x")
    (tmp_path / "file").write_text("x")
    for path, words in (
        (tmp_path / "there.nc", "exists"),
        (tmp_path, "is a folder"),
        (tmp_path / "none" / "a.nc", "does not exist"),
        (tmp_path / "file" / "a.nc", "folder"),
        ("/proc/none.nc", "cannot be written"),
    ):
        with pytest.raises(InputError, match=words):
            sl.results.save(result, path)
    assert sl.results.save(result, tmp_path / "there.nc", force=True).stat().st_size > 1000
    with pytest.raises(InputError, match="netCDF"):
        sl.open_result(tmp_path / "file")
    with pytest.raises(InputError, match="not a file"):
        sl.open_result(tmp_path / "none.nc")
    xr.Dataset({"a": 1}).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(InputError, match="not a result"):
        sl.open_result(tmp_path / "other.nc")
    with pytest.raises(InputError, match="picture format"):
        sl.figures.save_figure(result, tmp_path / "a.bmp")


@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_figure_files(tmp_path, suffix: str) -> None:
    path = sl.figures.save_figure(sl.run(load_scene("peo5-water")), tmp_path / f"a{suffix}")
    assert path.read_bytes()[:4] in (b"\x89PNG", b"%PDF", b"<?xm")


def test_report_opens_offline_and_answers_first() -> None:
    result = quiet("pcl9-dcm")
    text = sl.report.html(result)
    assert "http" not in text.replace("http-equiv", "")
    body = text[text.index("<body>") :]
    assert body.index("fully stretched at") < body.index("<img") < body.index("Models used") < body.index("Inputs")
    for word in ("estimated from the process", "alpha_v", "PCL", "crossover_radius", "data:image/png;base64,"):
        assert word in text
    title = sl.run(load_scene("peo5-water", ["title=<script>alert(1)</script>"]))
    assert "<script>" not in sl.report.html(title)


def test_scalars_are_numbers() -> None:
    values = scalars(sl.run(load_scene("peo5-water")))
    assert len(values) == 22
    assert all(isinstance(value, float) for value in values.values())


def test_manifold_rung_meets_the_affine_one_and_locks() -> None:
    affine = sl.run(load_scene("peo5-water"))
    linear = quiet("peo5-water", "network.model=manifold", "network.force_law=linear", "network.coupling=1e6")
    inner = linear["z"].values < 4.5e-3
    gap = linear["network_velocity_ratio"].values / linear["velocity_ratio"].values - 1
    assert np.abs(gap[inner]).max() < 4e-6  # c V'/alpha_v at the steepest place
    assert linear.attrs["model"] == "manifold"
    assert float(linear["crossover_extension_position"]) == pytest.approx(
        float(affine["crossover_extension_position"]), rel=1e-5
    )
    locked = quiet("peo5-water", "network.model=manifold")  # no warning: "auto" takes the stretch of the law solved for
    assert locked.attrs["closure"] == "stretch"
    assert linear.attrs["closure"] == "force"
    w, full = locked["network_velocity_ratio"].values, float(locked["crossover_velocity_ratio"])
    assert w.max() <= full
    # full stretch of strands with a contour: the tension of the spring that is stretched so far, 0.83 of the lattice's contour
    crossover = float(locked["crossover_position"])
    assert crossover < locked.attrs["locked_from"] < float(affine["crossover_position"])
    assert np.interp(crossover, locked["z"], locked["relative_extension"]) == pytest.approx(0.83, abs=2e-3)
    assert np.interp(crossover, linear["z"], linear["velocity_ratio"]) < 0.7 * full
    assert float(linear["crossover_position"]) == pytest.approx(float(affine["crossover_position"]), rel=1e-5)
    flux = locked["mean_polymer_fraction"].values * w / locked["velocity_ratio"].values
    free = locked["mean_polymer_fraction"].values < 1
    np.testing.assert_allclose(flux[free], float(locked["volume_fraction"]), rtol=1e-10)
    # bead by bead: what drags is what pulls; 5e-3 m of drag forces add up to the change of the strand force
    assert locked["scission"].any() == (locked["strand_force"].max() > 5e-9)
    for scene, overrides in (
        ("pvp-jetspin", ["network.model=chain"]),
        ("peo5-water", ["network.model=affine", "network.force_law=fene"]),
        ("peo5-water", ["network.model=walk", "network.closure=stretch"]),
    ):
        with pytest.raises(InputError, match="network"):
            sl.run(load_scene(scene, overrides))
    loose = quiet("peo5-water", "network.model=manifold", "network.force_law=linear", "network.coupling=5")
    assert float(loose["far_end_effect"]) > 0.01  # eps V' = 0.6: the far end decides, and the result says so
    assert "the far end decides" in loose.attrs["warnings"]


def test_walk_rung_samples_the_affine_one() -> None:
    overrides = ("accuracy.points=41", "accuracy.strands=4000")
    affine = sl.run(load_scene("peo5-water", overrides))
    walk = sl.run(load_scene("peo5-water", [*overrides, "network.model=walk"]))
    again = sl.run(load_scene("peo5-water", [*overrides, "network.model=walk"]))
    other = sl.run(load_scene("peo5-water", [*overrides, "network.model=walk", "accuracy.seed=1"]))
    assert walk.equals(again)
    assert not np.array_equal(walk["axial_stretch"], other["axial_stretch"])
    for name in ("axial_stretch", "radial_contraction", "orientation"):
        score = (walk[name] - affine[name]) / walk[f"{name}_std_error"]
        assert np.abs(score).max() < 4.5
        assert 0.7 < float(score.std()) < 1.35
    assert walk.attrs["model"] == "walk"


def test_chain_rung_settles_on_the_manifold() -> None:
    overrides = ("network.force_law=linear", "network.coupling=3000", "accuracy.rtol=1e-3", "accuracy.points=101")
    steady = quiet("peo5-water", "network.model=manifold", *overrides)
    chain = quiet("peo5-water", "network.model=chain", "network.coarse_grain=20", *overrides)
    inner = (steady["z"].values > 2e-4) & (steady["z"].values < 4.5e-3)
    gap = np.interp(steady["z"], chain["z"], chain["network_velocity_ratio"]) / steady["network_velocity_ratio"] - 1
    assert np.abs(gap.values[inner]).max() < 2e-3
    assert chain.attrs["drift"] < 1e-3
    assert chain.attrs["coarse_grain"] == 20
    locked = [
        quiet(
            "peo5-water",
            f"network.model={model}",
            "network.closure=stretch",
            "network.coupling=1e4",
            "network.coarse_grain=20",
        )
        for model in ("manifold", "chain")
    ]
    assert locked[1].attrs["locked_from"] == pytest.approx(locked[0].attrs["locked_from"], rel=0.05)
    assert (locked[1]["relative_extension"] <= 1).all()


def test_a_passage_within_a_panel_of_many_decades_is_found():
    """A jet of 10^7 radii: the panel that holds the passage is so long that halving it takes over a hundred steps."""
    scene = scene_from_dict(
        {
            "solution": {
                "polymer": "PVP",
                "solvent": "ethanol",
                "volume_fraction": 0.027910989502476998,
                "viscosity": "6180 Pa s",
                "kuhn_length": "4.680691543502936e-09 m",
            },
            "jet": {
                "profile": "power-law",
                "radius": "5.810148615721182e-06 m",
                "flow_rate": "2.5016367337692542e-12 m^3/s",
                "length": "58.101486157211816 m",
                "k": 0.10965966275812168,
                "beta": 0.5,
            },
            "network": {
                "model": "manifold",
                "solvent_quality": "good",
                "coupling": 4692445.023461631,
                "closure": "force",
                "inertia": 2.9542261079115328e-15,
                "force_law": "linear",
            },
            "accuracy": {"rtol": 0.0175657782237877, "points": 2},
        }
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        result = sl.run(scene)
    assert 0 < float(result["crossover_position"]) <= float(result["crossover_extension_position"]) < 58.1
