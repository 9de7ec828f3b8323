"""`spinline deposit` and `spinline mat` as a user types them, with a mistake or two."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

SCENE = """
title = "One jet"
[laydown]
speed = "5 m/s"
spread = "60 um"
turning_length = "100 um"
diameter = "600 nm"
diameter_deviation = "120 nm"
[collector]
kind = "{kind}"
distance = "20 cm"
time = "40 ms"
{more}
[mat]
realisations = 2
window = "12 um"
"""


@pytest.fixture
def scene(tmp_path):
    def write(kind="plate", more="", name="one.toml"):
        path = tmp_path / name
        path.write_text(SCENE.format(kind=kind, more=more), encoding="utf-8")
        return path

    return write


@pytest.mark.slow
def test_from_a_scene_to_a_mat(spinline, scene, tmp_path):
    scene()
    made = spinline("deposit", "one.toml", "-o", "f.h5", "--json")
    assert made.code == 0, made.err
    assert made.json["length"] == pytest.approx(0.2, rel=1e-3)
    (tmp_path / "sem.csv").write_text(
        "Diameter (nm)\n" + "\n".join(str(d) for d in range(500, 720, 5)), encoding="utf-8"
    )
    seen = spinline(
        "mat",
        "f.h5",
        "-o",
        "m.nc",
        "--report",
        "m.html",
        "--picture",
        "top.png",
        "--measured",
        "sem.csv",
        "--export",
        "a.vtp",
        "--export",
        "a.tif",
        "--json",
    )
    assert seen.code == 0, seen.err
    numbers = seen.json
    assert 0.5 < numbers["porosity"] < 1
    assert numbers["permeability"]["davies"] > 0
    for name in ("m.nc", "m.png", "m.html", "top.png", "a.vtp", "a.tif"):
        assert (tmp_path / name).stat().st_size > 500
    with xr.open_dataset(tmp_path / "m.nc", engine="h5netcdf") as ds:
        assert {"thickness", "porosity", "order_parameter", "mean_thickness", "areal_density", "permeability"} <= set(
            ds.data_vars
        )
        assert float(ds["measured_mean_ratio"][0]) == pytest.approx(1.0, abs=0.1)
    again = spinline("mat", "f.h5", "-o", "m.nc")
    assert again.code == 2
    assert "--force" in again.err


def test_a_faster_belt_aligns(spinline, scene):
    scene("belt", 'speed = "0 m/s"', "slow.toml")
    scene("belt", 'speed = "20 m/s"', "fast.toml")
    for name in ("slow", "fast"):
        assert spinline("deposit", f"{name}.toml", "-o", f"{name}.h5").code == 0
    from spinline.deposit import FibreFile, order_of

    found = []
    for name in ("slow", "fast"):
        with FibreFile(f"{name}.h5") as file:
            s = file.read()
            found.append(order_of(s.angle, s.chord).order_parameter)
    assert found[0] < 0.1
    assert found[1] == pytest.approx(0.939, abs=0.01)  # the trochoid's, q = 4


def test_a_jetspin_run_on_a_drum(spinline, tmp_path):
    import spinline as sl

    run = tmp_path / "run"
    run.mkdir()
    bundled = Path(sl.__file__).parent / "data" / "scenes" / "pvp3d"
    for name in ("log.txt", "input.dat"):
        shutil.copy(bundled / name, run)
    shutil.copy(Path(__file__).parent / "data" / "jetspin" / "pvp3d" / "bead.dat", run)
    made = spinline("deposit", "run", "-o", "f.h5", "--json")
    assert made.code == 0, made.err
    assert made.json["segments"] > 50
    drum = spinline(
        "deposit", "run", "-o", "g.h5", "--collector", "drum", "--radius", "10 cm", "--speed", "2 m/s", "--csv", "g.csv"
    )
    assert drum.code == 0, drum.err
    belt = spinline("deposit", "run", "-o", "b.h5", "--collector", "belt", "--speed", "400 m/s", "--plan")
    assert (belt.code, "faster than the fibre is fed" in belt.err, "faster" in made.err) == (0, True, False)
    assert len((tmp_path / "g.csv").read_text().splitlines()) == made.json["segments"] + 1
    with xr.open_dataset(tmp_path / "g.h5", engine="h5netcdf") as ds:
        assert np.isfinite(ds["x"].values).all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("deposit", "absent.toml"), "absent.toml"),
        (("deposit", "absent"), "does not exist"),
        (("mat", "absent.h5"), "does not exist"),
        (("deposit", "one.toml", "--set", "collector.kind=mesh"), "collector.kind"),
        (("deposit", "one.toml", "--set", "collector.rotation=240 rpm"), "plate"),
        (("deposit", "one.toml", "--set", "laydown.sped=3 m/s"), "not a known key"),
        (("deposit", "one.toml", "--set", "laydown.speed=3"), "laydown.speed"),
        (("deposit", "one.toml", "--set", "laydown.step=1 mm"), "step"),
        (("deposit", "one.toml", "--set", 'mat.permeability=["davis"]'), "did you mean 'davies'?"),
        (("deposit", "one.toml", "--plan", "--set", 'mat.permeability=["davies", "darcy"]'), "'darcy' is no law"),
        (("deposit", "one.toml", "--plan", "--set", "mat.permeability=[]"), "names no law"),
        (("check", "peo5-spun", "--set", "mat.permeability=davis"), "did you mean 'davies'?"),
        (("run", "peo5-water", "--no-figure", "--set", 'mat.permeability=["davis"]'), "did you mean 'davies'?"),
        (("spin", "peo5-spun", "--set", 'mat.permeability=["davis"]'), "did you mean 'davies'?"),
    ],
)
def test_mistakes_are_named(spinline, scene, arguments, words):
    scene()
    ran = spinline(*arguments)
    assert ran.code == 2
    assert words in ran.err
    assert "Traceback" not in ran.err


def test_plan_runs_nothing(spinline, scene, tmp_path):
    scene()
    ran = spinline("deposit", "one.toml", "--plan")
    assert ran.code == 0
    assert "segments" in ran.out
    assert not list(tmp_path.glob("*.h5"))


def test_laws_out_of_range_are_null_in_json(spinline, scene):
    scene()
    assert spinline("deposit", "one.toml", "-o", "f.h5").code == 0
    ran = spinline(
        "mat", "f.h5", "-o", "m.nc", "--no-figure", "--law", "kozeny-carman", "--realisations", "1", "--json"
    )
    assert ran.code == 0, ran.err
    assert json.loads(ran.out)["permeability"]["kozeny-carman"] is None
    assert "outside the range" in ran.err


def test_a_jet_that_laid_its_own_fibre(spinline, tmp_path):
    """A file with the dimension `deposit`: both ends of each element, in the collector's frame."""
    n = 50
    turn = np.linspace(0, 20, n + 1)
    y, z = 1e-3 * np.cos(turn), 1e-3 * np.sin(turn)
    flight = np.full(n, 5e-4)
    volume = np.pi * (1e-6) ** 2 * flight
    names = {
        "time": np.arange(1.0, n + 1),
        "y0": y[:-1],
        "z0": z[:-1],
        "y1": y[1:],
        "z1": z[1:],
        "radius": np.full(n, 1e-6),
        "volume": volume,
        "polymer_volume": 0.2 * volume,
        "flight_length": flight,
    }
    xr.Dataset({f"deposit_{k}": ("deposit", v) for k, v in names.items()}).to_netcdf(
        tmp_path / "jet.nc", engine="h5netcdf"
    )
    made = spinline("deposit", "jet.nc", "-o", "f.h5", "--json")
    assert made.code == 0, made.err
    assert made.json["volume"] == pytest.approx(volume.sum(), rel=1e-12)
    assert made.json["polymer_volume"] == pytest.approx(0.2 * volume.sum(), rel=1e-12)
    refused = spinline("deposit", "jet.nc", "-o", "g.h5", "--speed", "1 m/s")
    assert refused.code == 2
    assert "collector of its own" in refused.err


def test_a_scene_with_a_bead_jet_names_its_collector(spinline, tmp_path):
    """The bundled JETSPIN scene with [collector] and [mat]: its run's landings on a belt; what is missing is named."""
    import spinline as sl

    bundled = Path(sl.__file__).parent / "data" / "scenes"
    shutil.copytree(bundled / "pvp3d", tmp_path / "pvp3d")
    shutil.copy(Path(__file__).parent / "data" / "jetspin" / "pvp3d" / "bead.dat", tmp_path / "pvp3d")
    text = (bundled / "pvp-jetspin.toml").read_text(encoding="utf-8")
    (tmp_path / "bare.toml").write_text(text, encoding="utf-8")
    bare = spinline("deposit", "bare.toml")
    assert bare.code == 2
    assert "collector" in bare.err
    more = '\n[collector]\nkind = "belt"\ndistance = "16 cm"\nspeed = "2 m/s"\n[mat]\nslope = 0.3\n'
    (tmp_path / "belt.toml").write_text(text + more, encoding="utf-8")
    made = spinline("deposit", "belt.toml", "-o", "f.h5", "--json")
    assert made.code == 0, made.err
    assert made.json["segments"] > 50
    from spinline.deposit import FibreFile

    with FibreFile("f.h5") as file:
        assert file.attributes["collector_kind"] == "belt"
        assert json.loads(file.attributes["mat"])["slope"] == 0.3
    analytic = spinline("deposit", "belt.toml", "--set", "jet.profile=hyperbolic")
    assert analytic.code == 2


def test_laws_of_permeability_by_one_name_or_twice(spinline, scene, tmp_path):
    scene()
    made = spinline("deposit", "one.toml", "-o", "f.h5", "--set", "mat.permeability=happel")
    assert made.code == 0, made.err
    from spinline.deposit.fibres import FibreFile
    from spinline.scene.mat_file import load_mat_scene

    with FibreFile(tmp_path / "f.h5") as file:
        assert json.loads(str(file.attributes["mat"]))["permeability"] == ["happel"]
    twice = load_mat_scene(tmp_path / "one.toml", ['mat.permeability=["happel", "davies", "happel"]'])
    assert twice.mat.permeability == ["happel", "davies"]


def test_a_spun_scene_hands_its_mat_on(spinline, tmp_path):
    """Its [mat] had been dropped without a word: the mat of a spin was analysed by the defaults."""
    spun = spinline(
        "spin",
        "pan12-blown",
        *("-o", "jet.nc", "--time", "1 ms", "--frames", "2"),
        *("--set", "mat.slope=0.3", "--set", 'mat.permeability=["happel", "kuwabara"]'),
    )
    assert spun.code == 0, spun.err
    kept = xr.open_dataset(tmp_path / "jet.nc", engine="h5netcdf").attrs["mat"]
    assert json.loads(kept) | {"slope": 0.3, "permeability": ["happel", "kuwabara"]} == json.loads(kept)


@pytest.mark.parametrize("kept", ["", '{"slope": 0.3, "permeability": ["happel"]}'])
def test_deposit_keeps_the_mat_of_a_jet_file(spinline, tmp_path, kept):
    numbers = np.arange(1.0, 4.0)
    names = ("time", "y0", "z0", "y1", "z1", "radius", "volume", "polymer_volume", "flight_length")
    values = (numbers, numbers, numbers, numbers + 1, numbers, numbers * 0 + 1e-6, numbers, 0.2 * numbers, numbers)
    jet = xr.Dataset({f"deposit_{k}": ("deposit", 1e-4 * v) for k, v in zip(names, values, strict=True)})
    jet.attrs |= {"mat": kept} if kept else {}
    jet.to_netcdf(tmp_path / "jet.nc", engine="h5netcdf")
    made = spinline("deposit", "jet.nc", "-o", "f.h5")
    assert made.code == 0, made.err
    from spinline.deposit.fibres import FibreFile

    with FibreFile(tmp_path / "f.h5") as file:
        assert str(file.attributes.get("mat", "")) == kept
