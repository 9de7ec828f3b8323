"""The command line as a user meets it: answers on standard output, one message and exit code 2 for bad input."""

import base64
import json
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from lay_text import lay_text

from spinline.scene import bundled_scenes


def test_the_main_job(spinline, tmp_path) -> None:
    ran = spinline("run", "peo5-water", "--report", "r.html", "--csv", "p.csv")
    assert ran.code == 0
    assert ran.err == ""
    assert "fully stretched at 3.43 mm, radius 26.3" in ran.out
    assert {file.name for file in tmp_path.iterdir()} == {"peo5-water.nc", "peo5-water.png", "r.html", "p.csv"}
    drawn = base64.b64encode(Path("peo5-water.png").read_bytes()).decode()
    assert f"base64,{drawn}" in Path("r.html").read_text()  # once drawn, twice used
    again = spinline("run", "peo5-water")
    assert again.code == 2
    assert again.err == "error: peo5-water.nc: exists; choose another name, or --force to overwrite\n"
    assert again.out == ""
    assert spinline("run", "peo5-water", "--force").code == 0


def test_crossover_through_the_command_line_to_1e_6(spinline) -> None:
    ran = spinline("crossover", "peo5-water", "--json")
    data = ran.json
    phi = data["volume_fraction"]
    assert data["crossover_radius_ratio"] == pytest.approx(np.sqrt(phi), rel=1e-9)
    assert data["crossover_position"] == pytest.approx(125e-6 * (1 / phi) ** (1 / 0.94), rel=1e-9)
    line = spinline("crossover", "peo5-water")
    assert line.out.count("\n") == 1
    assert "3.43 mm" in line.out


def test_json_and_no_figure(spinline, tmp_path) -> None:
    ran = spinline("run", "peo5-water", "--json", "--no-figure", "-o", "a.nc", "--set", "jet.length=1 mm")
    assert ran.code == 0
    assert ran.json["crossover_position"] is None
    assert "warning: " in ran.err
    assert [file.name for file in tmp_path.iterdir()] == ["a.nc"]


def test_a_scene_file_puts_its_result_beside_it(spinline, tmp_path) -> None:
    folder = tmp_path / "work"
    folder.mkdir()
    assert spinline("scenes", "--copy", "peo3-water", "--to", folder).code == 0
    assert spinline("run", folder / "peo3-water.toml", "--rtol", "0.1", "--model", "affine").code == 0
    assert (folder / "peo3-water.nc").exists()
    assert (folder / "peo3-water.png").exists()


def test_scenes_lists_and_copies_with_data(spinline, tmp_path) -> None:
    ran = spinline("scenes")
    assert all(name in ran.out for name in bundled_scenes())
    assert spinline("scenes", "--copy", "pvp-jetspin").code == 0
    assert (tmp_path / "pvp3d" / "traj.dat").exists()
    assert spinline("crossover", "pvp-jetspin.toml").code == 0
    twice = spinline("scenes", "--copy", "pvp-jetspin")
    assert (twice.code, "exists" in twice.err) == (2, True)
    assert "not a bundled scene" in spinline("scenes", "--copy", "nothing").err


def test_check(spinline) -> None:
    assert spinline("check", "peo5-water").out.endswith("nothing odd\n")
    odd = spinline("check", "pcl9-dcm")
    assert odd.code == 0
    assert "remark: k = " in odd.out
    assert spinline("check", "peo5-water", "--set", "jet.beta=3").code == 2


def test_schema(spinline, tmp_path) -> None:
    assert json.loads(spinline("schema").out)["title"] == "spinline scene"
    assert spinline("schema", "-o", "s.json").code == 0
    assert json.loads((tmp_path / "s.json").read_text())["properties"]


def test_fit_jet(spinline, tmp_path) -> None:
    z = np.geomspace(1, 10, 40)
    rows = "\n".join(f"{a},{125 * (a / 0.125) ** -0.47},{1.0}" for a in z)
    (tmp_path / "p.csv").write_text("z [mm],radius [um],radius_std [um]\n" + rows)
    ran = spinline("fit-jet", "p.csv", "--radius", "125 um")
    assert ran.code == 0
    assert ran.out.startswith("k = 1 +/- ")
    assert "beta = 0.47 " in ran.out
    data = spinline("fit-jet", "p.csv", "--radius", "125 um", "--json", "--from", "2 mm").json
    assert data["beta"] == pytest.approx(0.47, rel=1e-9)
    assert data["z_min"] >= 2e-3
    assert spinline("run", "peo5-water", "--no-figure").code == 0
    assert spinline("fit-jet", "peo5-water.nc", "--from", "0.2 mm").out.startswith("k = 1 +/- ")
    assert spinline("fit-jet", "p.csv", "--radius", "125").code == 2
    assert spinline("fit-jet", "none.csv").code == 2
    assert spinline("fit-jet", "p.csv", "--from", "1 m").code == 2


@pytest.mark.parametrize("scene", ["peo5-water", "pvp-jetspin", "peo5-needle", "pan12-blown"])
def test_a_table_of_one_command_is_read_by_the_others(spinline, tmp_path, scene) -> None:
    maker = ["jet", scene] if scene in ("peo5-needle", "pan12-blown") else ["run", scene, "--no-figure"]
    assert spinline(*maker, "--csv", "made.csv").code == 0
    ran = spinline("fit-jet", "made.csv", "--json")
    assert ran.code == 0
    assert "made.csv: columns left out: " in ran.err
    assert ran.json["samples_given"] > 50
    if scene == "pvp-jetspin":
        again = spinline("fit-jet", "pvp-jetspin.nc", "--json").json  # the result beside the table
        assert again["beta"] == pytest.approx(ran.json["beta"], rel=1e-9)
    if scene in ("pvp-jetspin", "pan12-blown"):
        return  # beads in space are no straight jet; a blown jet thickens again before its end
    (tmp_path / "again.toml").write_text(
        '[solution]\npolymer = "PEO"\nmolar_mass = "600 kg/mol"\nsolvent = "water"\nmass_fraction = 0.05\n'
        'kuhn_length = "1 nm"\ntemperature = "293.15 K"\nviscosity = "2 Pa s"\n'
        '[jet]\nprofile = "table"\npath = "made.csv"\nflow_rate = "3.2 mL/hour"\n'
    )
    assert spinline("run", "again.toml", "--no-figure", "--csv", "again.csv").code == 0
    ours, theirs = (
        np.genfromtxt(tmp_path / name, delimiter=",", skip_header=1)[-1] for name in ("again.csv", "made.csv")
    )
    assert ours[1] == pytest.approx(theirs[1], rel=1e-9)  # the last radius
    wrong = spinline("run", "again.toml", "--no-figure", "--set", "jet.flow_rate=9 mL/hour", "--force")
    assert wrong.code == 2
    assert all(word in wrong.err for word in ("made.csv", "do not carry the flow rate", "set flow_rate"))


def test_columns_that_are_left_out_and_those_that_are_not(spinline, tmp_path) -> None:
    rows = "\n".join(f"{z},{100 * z**-0.3},1" for z in range(1, 20))
    for third, word in (("radius_err [um]", "radius_std"), ("t [s]", "rows of one time"), ("zz [mm]", "")):
        (tmp_path / "p.csv").write_text(f"z [mm],radius [um],{third}\n{rows}")
        ran = spinline("fit-jet", "p.csv")
        assert (ran.code, word in ran.err) == (2 if word else 0, True)
    (tmp_path / "p.csv").write_text(f"x_mm,z_mm,radius_um\n{rows}")
    ran = spinline("fit-jet", "p.csv")
    assert (ran.code, "two columns that mean z" in ran.err) == (2, True)


BAD = [
    (["run", "none"], ["none", "cannot be read", "spinline scenes"]),
    (["run", "peo5-watr"], ["did you mean the bundled 'peo5-water'"]),
    (["run", "peo5-water", "--set", "jet.radius=-1 um"], ["jet.radius", "'-1 um'", "(1e-12, 1000) m"]),
    (["run", "peo5-water", "--set", "jet.radius=5 s"], ["jet.radius", "not a length", "for example"]),
    (["run", "peo5-water", "--set", "solution.mass_fraction=1.0"], ["solution.mass_fraction", "(0, 1)"]),
    (["run", "peo5-water", "--set", "jet.beta=0.1"], ["jet.beta", "[0.25, 1]"]),
    (["run", "peo5-water", "--set", "jet.k=nan"], ["jet.k", "finite"]),
    (["run", "peo5-water", "--set", "jet.k=inf"], ["jet.k", "finite"]),
    (["run", "peo5-water", "--set", "solution.polymer=Nylon"], ["solution.polymer", "'Nylon'", "PEO, PMMA"]),
    (["run", "peo5-water", "--rtol", "7"], ["accuracy.rtol"]),
    (["run", "peo5-water", "--model", "conformation"], ["network.model", "solution.relaxation_time"]),
    (["run", "peo5-water", "-o", "none/a.nc"], ["none/a.nc", "folder does not exist"]),
    (["run", "peo5-water", "-o", "/proc/a.nc"], ["/proc/a.nc", "cannot be written"]),
    (["run", "peo5-water", "--figure", "a.bmp"], ["a.bmp", ".png"]),
    (["run", "peo5-water", "-o", "a.png", "--figure", "a.png"], ["two outputs"]),
    (["run", "binary.toml"], ["binary.toml", "not text"]),
    (["run", "a.csv"], ["a.csv", "not a TOML scene", 'profile = "table"']),
    (["run", "missing.toml"], ["jet", "is missing"]),
    (["run"], ["SCENE"]),
    (["run", "peo5-water", "--colour"], ["--colour"]),
    (["swim"], ["swim"]),
    (["fit-jet", "binary.toml"], ["binary.toml"]),
    (["import-jet", "none"], ["none"]),
    (["import-jet", "a.csv"], ["a.csv", 'profile = "table"']),
]


@pytest.mark.parametrize(("arguments", "words"), BAD, ids=[" ".join(a) for a, _ in BAD])
def test_bad_input(spinline, tmp_path, arguments: list[str], words: list[str]) -> None:
    (tmp_path / "binary.toml").write_bytes(bytes(range(256)))
    (tmp_path / "a.csv").write_text("z [mm],radius [um]\n1,2\n")
    (tmp_path / "missing.toml").write_text('[solution]\npolymer="PEO"\nsolvent="water"\nmass_fraction=0.05\n')
    ran = spinline(*arguments)
    assert ran.code == 2
    assert ran.out == ""
    for word in words:
        assert word in ran.err
    assert "Traceback" not in ran.err
    assert not list(tmp_path.glob(".spinline-*"))


def test_as_a_process() -> None:
    ran = subprocess.run([sys.executable, "-m", "spinline", "--version"], capture_output=True, text=True, check=True)
    assert ran.stdout.startswith("spinline 0.")
    ran = subprocess.run([sys.executable, "-m", "spinline", "--help"], capture_output=True, text=True, check=True)
    assert "crossover" in ran.stdout
    code = "import sys, spinline; print(sorted({'numpy','scipy','pandas','xarray','pint','matplotlib'} & set(sys.modules)))"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"


@pytest.mark.slow
def test_commands_without_a_figure_load_nothing_that_draws(tmp_path) -> None:
    (tmp_path / "lay.toml").write_text(lay_text("20 ms"), encoding="utf-8")
    lines = [  # in one process, which costs one start
        "run peo5-water --no-figure --csv r.csv",
        "jet peo5-needle --csv j.csv",
        "deposit lay.toml -o f.h5",
        "mat f.h5 --no-figure --csv m.csv",
        "window pan-dmf --voltage 15kV --gap 15cm --flow-rate 1mL/h --steps 2 --no-figure",
        "import-jet pvp3d -o b.nc",
    ]
    shutil.copytree(Path(str(files("spinline"))) / "data" / "scenes" / "pvp3d", tmp_path / "pvp3d")
    code = (
        "import sys\nfrom spinline.cli.commands import app\n"
        f"for line in {lines}:\n app(line.split(), standalone_mode=False)\n"
        " print('\\nLOADED', line, 'matplotlib' in sys.modules)"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    told = [line for line in ran.stdout.splitlines() if line.startswith("LOADED")]
    assert told == [f"LOADED {line} False" for line in lines]


def test_another_file_under_the_name_of_the_result_is_named(spinline, tmp_path) -> None:
    assert spinline("run", "peo5-water", "--no-figure").code == 0
    result = tmp_path / "peo5-water.nc"
    shutil.copy(result, tmp_path / "p.h5")
    before = result.read_bytes()
    for words, wanted in (
        (("mat", "peo5-water.nc"), "is not a file of fibres"),
        (("deposit", "p.h5"), "has no landings"),
        (("import-jet", "peo5-water.nc"), "not a file of a JETSPIN run"),
    ):
        ran = spinline(*words, "--force")
        assert (ran.code, wanted in ran.err, "this very command" in ran.err) == (2, True, False), ran.err
    assert result.read_bytes() == before


@pytest.mark.parametrize(
    "command", ["run", "check", "crossover", "plan", "fit", "sweep", "jet", "fibre", "reduce", "window"]
)
@pytest.mark.parametrize(
    ("head", "what"),
    [
        (b"\x89HDF\r\n\x1a\n\x00\x00\x00\x00\x00\x08\x08\x00\x04\x00\x10\x00", "an HDF5 file"),
        (b"PK\x03\x04\x14\x00", "a zip archive"),
        (b"\x1f\x8b\x08\x00", "compressed by gzip"),
        (b"\xff\xd8\xff\xe0\x00\x10JFIF", "a JPEG picture"),
        (b"\x93NUMPY\x01\x00v\x00", "an array of numpy.save"),
    ],
)
def test_another_programs_file_in_place_of_a_scene_is_named(spinline, tmp_path, command, head, what):
    (tmp_path / "given.nc").write_bytes(head + bytes(300))
    done = spinline(command, "given.nc")
    assert done.code == 2
    assert f"given.nc: is {what}" in done.err
    assert "a TOML text" in done.err
    assert ('[jet] profile = "lagrangian"' in done.err) == (command in ("run", "check", "crossover", "plan", "jet"))
