"""Every output of every command, wherever a tired user may send it: onto an input, a device, a folder, another output.

The commands and their options are read from the command line itself: one that is new fails here until it is listed with its
inputs, and is then attacked as the others are.
"""

import os
import shutil
import stat
import typing
from pathlib import Path

import pytest

from spinline.cli.commands import app

ROOT = Path(__file__).parent.parent
DATA = ROOT / "tests" / "data"
# words of each command that writes; files among them are its inputs
COMMANDS = {
    "run": ["scene.toml"],
    "trade": ["scene.toml", "--quick"],
    "schema": [],
    "import-jet": ["jetrun/traj.dat"],
    "deposit": ["jetrun/traj.dat"],
    "mat": ["fibres.h5"],
    "fibre": ["--table", "table.csv"],
    "fit": ["fit.toml"],
    "compare-theory": ["scene.toml", "result.nc"],
    "preview": ["images.toml"],
    "reduce": ["images.toml"],
    "jet": ["needle.toml"],
    "spin": ["spun.toml", "--time", "0.02 ms", "--frames", "2", "--quick"],
    "window": ["scene.toml", "--voltage", "15 kV", "--gap", "15 cm", "--steps", "2"],
    "simulate-image": ["result.nc"],
    "sweep": ["sweep.toml"],
}
INPUTS = {"table", "measured", "fitted", "profile", "to", "run_dir", "fibres", "reduced", "a", "b", "result"}
ENDINGS = {"figure": ".png", "picture": ".png", "report": ".html", "html": ".html", "csv": ".csv", "movie": ".gif"}
ENDINGS |= {"vtk": ".vtk", "xyz": ".xyz", "export": ".raw"}
OUTS = {"fibre": ".csv", "deposit": ".h5", "schema": ".json", "simulate-image": ".npz", "sweep": ".zarr"}


def written() -> dict[str, list[str]]:
    """Commands, and their options that name a file to write."""
    found = {}
    for command in app.registered_commands:
        name = command.name or command.callback.__name__.replace("_", "-")  # type: ignore[union-attr]
        hints = typing.get_type_hints(command.callback) or {}
        if name == "simulate-image":  # its options are those of the camera
            hints = {"out": Path | None}
        found[name] = [option for option, kind in hints.items() if "Path" in str(kind) and option not in INPUTS]
    return {name: options for name, options in found.items() if options}


WRITTEN = written()
OUTPUTS = [(name, option) for name, options in WRITTEN.items() for option in options]


def ending(command: str, option: str) -> str:
    return ENDINGS.get(option) or OUTS.get(command, ".nc")


@pytest.fixture(scope="module")
def inputs(tmp_path_factory) -> Path:
    """A folder with an input of every kind."""
    from spinline.deposit import FibreWriter, Segments
    from spinline.scene.file import bundled_scenes, load_scene
    from spinline.solve.results import save
    from spinline.solve.spine import solved

    folder = tmp_path_factory.mktemp("inputs")
    for name, scene in (("scene", "peo5-water"), ("needle", "peo5-needle"), ("spun", "pvp-spun")):
        shutil.copyfile(bundled_scenes()[scene], folder / f"{name}.toml")
    shutil.copytree(DATA / "jetspin" / "ex2_1d_insert", folder / "jetrun")
    (folder / "jetrun").chmod(0o755)
    save(solved(load_scene("peo5-water")), folder / "result.nc")
    (folder / "sweep.toml").write_text(
        'scene = "peo5-water"\n[vary]\njet.k = { uniform = [0.5, 2.0] }\n[design]\nkind = "latin-hypercube"\nsamples = 4\n'
    )
    fits = ROOT / "src" / "spinline" / "data" / "fits" / "peo5-simulated"
    for file in fits.iterdir():
        shutil.copyfile(file, folder / ("fitted.toml" if file.name == "scene.toml" else file.name))
    text = (folder / "fit.toml").read_text().replace("scene.toml", "fitted.toml")
    (folder / "fit.toml").write_text(text)
    shutil.copyfile(ROOT / "src" / "spinline" / "data" / "images" / "peo5-images.toml", folder / "images.toml")
    shutil.copyfile(ROOT / "src" / "spinline" / "data" / "images" / "peo5-images.npz", folder / "peo5-images.npz")
    (folder / "table.csv").write_text("polymer,solvent,mass_fraction\nPEO,water,0.05\n")
    import numpy as np

    with FibreWriter(folder / "fibres.h5") as file:
        file.write(Segments.from_paths([np.cumsum(np.full((40, 2), 1e-4), axis=0)], 3e-7))
    for path in folder.rglob("*"):
        if path.is_file():
            path.chmod(0o644)
    return folder


@pytest.fixture
def place(inputs, tmp_path, spinline) -> Path:
    """The inputs, and an empty place beside them in which the command runs."""
    shutil.copytree(inputs, tmp_path, dirs_exist_ok=True)
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.is_symlink()
    }


def test_every_command_that_writes_is_attacked_here() -> None:
    assert set(WRITTEN) == set(COMMANDS)
    assert {option for _, option in OUTPUTS} <= {*ENDINGS, "out"}


@pytest.mark.parametrize(("command", "option"), OUTPUTS)
def test_an_output_goes_nowhere_but_to_a_new_file(command, option, place, spinline) -> None:
    words, end = COMMANDS[command], ending(command, option)
    os.mkfifo(f"pipe{end}")
    os.symlink("/dev/full", f"device{end}")
    Path(f"folder{end}").mkdir()
    Path(f"folder{end}/mine").write_text("mine")
    Path(f"there{end}").write_text("of another")
    before = contents(place)
    inputs_ = [word for word in words if Path(word).is_file()]
    goals = [f"pipe{end}", f"device{end}", f"folder{end}", f"no/such{end}", "n" * 300 + end]
    for word in inputs_:
        os.symlink(word, f"link-{Path(word).name}{end}")
        os.link(word, f"hard-{Path(word).name}{end}")
        before[f"hard-{Path(word).name}{end}"] = before[word]
        if end != ".nc" or command not in ("fit", "compare-theory"):  # to other names these put .nc
            goals += [word, f"./{word}", str(place / word)]
        goals += [f"link-{Path(word).name}{end}", f"hard-{Path(word).name}{end}"]
    if option != WRITTEN[command][0]:
        goals = [goals[1], *goals[-2:]] if inputs_ else goals[1:2]
    for goal in goals:
        ran = spinline(command, *words, f"--{option}", goal, "--force")
        assert (ran.code, ran.out) == (2, ""), (goal, ran)
        assert len(ran.err.splitlines()) <= 3, (goal, ran.err)
        assert contents(place) == before, goal
    ran = spinline(command, *words, f"--{option}", f"there{end}")
    assert (ran.code, contents(place)) == (2, before), ran
    assert stat.S_ISFIFO(os.stat(f"pipe{end}").st_mode)


@pytest.mark.parametrize("command", [name for name, options in WRITTEN.items() if len(options) > 1])
def test_no_two_outputs_have_one_name(command, place, spinline) -> None:
    before = contents(place)
    first, *others = WRITTEN[command]
    for other in others:
        end = ending(command, other)
        for again in (f"same{end}", f"./same{end}", str(place / f"same{end}")):
            ran = spinline(command, *COMMANDS[command], f"--{first}", f"same{end}", f"--{other}", again, "--force")
            assert (ran.code, contents(place)) == (2, before), (other, ran)
            assert len(ran.err.splitlines()) <= 3
