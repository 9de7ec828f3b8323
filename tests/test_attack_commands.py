"""Commands under attack: full disks, closed streams, unwritable places, signals, kills, two at once."""

import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest
from file_kills import Ended, campaign, judged, prepared, warm
from lay_text import lay_text

DATA = Path(__file__).parent / "data"


def _command(folder: Path, *arguments: str, before: str = "", **environment: str) -> "subprocess.CompletedProcess[str]":
    line = f"{before} {'' if '|' in arguments[-1] else 'exec'} {sys.executable} -m spinline {' '.join(arguments)}"
    return subprocess.run(
        ["bash", "-c", line],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def _python(code: str, folder: Path) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False, cwd=folder
    )


@pytest.mark.parametrize(
    "words", [("run", "peo5-water"), ("import-jet", str(DATA / "jetspin" / "ex2_1d_insert"), "-o j.nc")]
)
def test_a_full_disk_is_one_message(words, tmp_path) -> None:
    # byte code cut off by the limit would stay beside the sources: Python 3.11 does not look at how much was written
    ran = _command(tmp_path, *words, before="trap '' XFSZ; ulimit -f 3;", PYTHONDONTWRITEBYTECODE="1")
    assert ran.returncode == 2, ran.stderr
    assert ran.stderr.count("\n") == 1
    assert "cannot be written" in ran.stderr
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(("said", "code"), [("marshal data too short", 2), ("Ran out of input", 70)])
def test_byte_code_that_a_full_disk_cut_is_named(said, code, spinline, monkeypatch) -> None:
    def cut(*_: object) -> None:
        raise EOFError(said)

    monkeypatch.setattr("spinline.cli.commands.load", cut)
    ran = spinline("check", "peo5-water")
    assert (ran.code, "Aborted" in ran.err) == (code, False)
    assert ("__pycache__" in ran.err) == (code == 2)


def test_standard_output_that_is_full_is_one_message(tmp_path) -> None:
    ran = _command(tmp_path, "crossover", "peo5-water", ">/dev/full")
    assert (ran.returncode, ran.stderr.count("\n")) == (2, 1)
    assert ran.stderr.startswith("error: standard output: ")


@pytest.mark.slow
@pytest.mark.parametrize("closed", ["2>/dev/full", ">&- 2>&- <&-"])
def test_streams_that_take_nothing_cost_no_result(closed, tmp_path) -> None:
    """What is said on the way, and the answer itself where nobody asked for one."""
    noted = (
        "spin",
        "pvp-spun",
        "--quick",
        "--time 0.1ms",
        "--frames 2",
        "-o j.nc",
    )  # says on standard error that it is quick
    ran = _command(tmp_path, *noted, closed)
    assert (ran.returncode, os.listdir(tmp_path)) == (0, ["j.nc"]), ran.stderr
    assert "Traceback" not in ran.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "files"),
    [
        (("deposit", "lay.toml", "-o f.h5", "--csv f.csv"), {"f.h5", "f.csv"}),
        (("spin", "pvp-spun", "--quick --time 0.1ms --frames 1", "--seeds 2", "-o j.nc"), {"j-0.nc", "j-1.nc"}),
        (("plan", "peo5-water"), set()),
        (("fit", "peo5-simulated", "--no-figure -o f.nc"), {"f.nc", "f.json"}),
    ],
)
def test_a_reader_that_has_heard_enough_is_no_error(words, files, tmp_path) -> None:
    (tmp_path / "lay.toml").write_text(lay_text(), encoding="utf-8")
    ran = _command(tmp_path, *words, "| true", before="set -o pipefail;")
    assert (ran.returncode, "rror" in ran.stderr) == (0, False), ran.stderr
    assert set(os.listdir(tmp_path)) == {"lay.toml"} | files


@pytest.mark.slow
def test_homes_and_caches_are_no_need(tmp_path) -> None:
    nowhere = {
        "HOME": "/proc/none",
        "XDG_CACHE_HOME": "/proc/none",
        "MPLBACKEND": "bogus",
        "NUMBA_CACHE_DIR": "/proc/none",
    }
    for words in (["run", "peo5-water", "--set", "'jet.radius=0.07 furlong'"], ["run", "peo5-water"]):
        ran = _command(tmp_path, *words, "--no-figure", "--force", **nowhere)
        assert "Traceback" not in ran.stderr
        assert ran.returncode in (0, 2), ran.stderr
    walked = _command(tmp_path, "run", "peo5-water", "--no-figure --force --model manifold", **nowhere)
    assert walked.returncode == 0, walked.stderr


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_commands_that_are_ended_leave_whole_files(number, tmp_path) -> None:
    """A sample of ``benchmarks/attack.py kills`` and ``stops``."""
    (tmp_path / "source").mkdir()
    commands = {"deposit": prepared(tmp_path / "source")["deposit"]}
    warm(commands, tmp_path / "source")
    found = campaign("deposit", commands["deposit"], tmp_path / "source", [0.2, 0.5, 0.8], number)
    assert (found["bad"], found["left beside"]) == ([], 0)


def test_what_kills_leave_is_seen(tmp_path) -> None:
    """The judge of the kills: files that are cut, strangers, a fault that is said, a wrong status."""
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "out.csv").write_text("cut")
    (tmp_path / "a" / ".spinline-x").write_text("left")
    found = judged(
        tmp_path / "a", Ended(70, 0.1, "error: a fault of this program", True), signal.SIGTERM, {"out.csv": b"whole"}
    )
    assert sorted(words.split()[0] for words in found) == ["ended", "left", "out.csv", "said"]


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_spun_jet_that_is_stopped_goes_on(number, status, spinline, tmp_path, monkeypatch) -> None:
    """In the middle of its moments, and while its straight jet is solved: status, what is left, and the same bytes in the end."""
    from spinline.jetprofile.spun import run
    from spinline.setup import spun

    words = ("spin", "pvp-spun", "--quick", "--time", "0.2 ms", "--frames", "4", "-o", "out.nc", "--resume")
    assert spinline(*words).code == 0
    whole = Path("out.nc").read_bytes()
    Path("out.nc").unlink()
    marched, solved_ = run.SpunRun.to, spun.spun_settings

    def ended(self, times):
        for index in marched(self, times):
            yield index
            if index == 1:
                os.kill(os.getpid(), number)
                time.sleep(0.01)

    def ended_before(*_, **__):
        os.kill(os.getpid(), number)
        time.sleep(0.01)

    monkeypatch.setattr(spun, "spun_settings", ended_before)
    ran = spinline(*words)
    assert (ran.code, os.listdir()) == (status, []), ran.err
    monkeypatch.setattr(spun, "spun_settings", solved_)
    monkeypatch.setattr(run.SpunRun, "to", ended)
    ran = spinline(*words)
    assert (ran.code, os.listdir()) == (status, [".out.nc.spin"]), ran.err
    assert "--resume goes on" in ran.err
    monkeypatch.setattr(run.SpunRun, "to", marched)
    assert spinline(*words).code == 0
    assert (os.listdir(), Path("out.nc").read_bytes()) == (["out.nc"], whole)


@pytest.mark.slow
def test_a_second_spin_onto_one_out_is_refused_at_once(tmp_path) -> None:
    """Before its straight jet is solved; and a command that is refused leaves no folder of its own."""
    from spinline.base.checkpoint import claimed

    code = (
        "import os, sys\nfrom spinline.setup import spun\nspun.spun_settings = lambda *_, **__: os._exit(99)\n"
        "from spinline.cli import main\nsys.argv = ['spinline', 'spin', 'pvp-spun', '-o', 'out.nc', *sys.argv[1:]]\nmain()"
    )

    def spin(*more: str) -> "subprocess.CompletedProcess[str]":
        run = [sys.executable, "-c", code, *more]
        return subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)

    with claimed(tmp_path / ".out.nc.spin"):
        ran = spin()
        assert (ran.returncode, "another process" in ran.stderr) == (2, True), ran.stderr
    assert spin("--time", "fast").returncode == 2
    assert os.listdir(tmp_path) == []
    (tmp_path / ".out.nc.spin").write_text("mine")
    ran = spin()
    assert (ran.returncode, "in the way" in ran.stderr) == (2, True), ran.stderr
    assert (tmp_path / ".out.nc.spin").read_text() == "mine"


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
@pytest.mark.parametrize("where", ["destructor", "class"])
def test_a_signal_is_not_lost(number, status, where, tmp_path) -> None:
    """What a handler raises in a destructor is dropped by Python, and in the making of a class comes out as another error."""
    kill = f"os.kill(os.getpid(), {int(number)})"
    lost = {
        "destructor": f"class Last:\n def __del__(self): {kill}; time.sleep(0.01)\nLast()",
        "class": f"class Named:\n def __set_name__(self, *_): {kill}; time.sleep(0.01)\nclass Has: name = Named()",
    }[where]
    code = (
        "import os, sys, time\nfrom spinline.cli import commands\n"
        f"def asked(words):\n def run(**_):\n  exec({lost!r}, globals())\n  time.sleep(5)\n  print('lost')\n return run\n"
        "commands._asked = asked\ncommands.main()"
    )
    ran = _python(code, tmp_path)
    assert ran.returncode in (status, -int(number)), ran.stderr
    assert "lost" not in ran.stdout
    assert "fault of this program" not in ran.stderr


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_before_the_command_itself_ends_without_a_traceback(number, status, tmp_path) -> None:
    code = (
        "import os, sys, time\nfrom spinline.cli import commands\n"
        f"def note(words):\n os.kill(os.getpid(), {int(number)}); time.sleep(5)\n"
        "commands._note_arguments = note\ncommands.main()"
    )
    ran = _python(code, tmp_path)
    assert (ran.returncode, ran.stderr) == (status, "")


# --- what is read ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("while_importing", ["spinline.cli.commands", "typer", "pydantic"])
def test_ctrl_c_while_modules_are_imported_is_no_traceback(while_importing, tmp_path) -> None:
    """Started as the installed command starts, and interrupted at the first search for a module."""
    place = Path(__file__).parent.parent / "pyproject.toml"
    entry, _, name = tomllib.loads(place.read_text(encoding="utf-8"))["project"]["scripts"]["spinline"].partition(":")
    script = f"""
import os, signal, sys
class Interrupting:
    def find_spec(name, path=None, target=None):
        if name == {while_importing!r}:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupting)
sys.argv = ["spinline", "run", "peo5-water", "--no-figure"]
from {entry} import {name}
sys.exit({name}())
"""
    ran = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout, ran.stderr) == (130, "", "")
    assert not list(tmp_path.iterdir())
