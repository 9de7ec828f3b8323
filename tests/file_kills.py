"""Commands ended at a moment, and started again: used by the attack tests and by ``benchmarks/attack.py``.

Each command runs in a folder of its own, in a child of this process, and is ended by a signal; then the same command is
started again. What must hold afterwards:

* every file is whole, bit for bit that of an undisturbed run, and there is no other;
* of SIGTERM and SIGINT besides: the status is 143 or 130, nothing is said of a fault, and nothing but whole files and
  what the work goes on from is left.
"""

import contextlib
import io
import os
import pickle
import shutil
import signal
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from file_damage import same
from file_victims import read_netcdf, read_store
from lay_text import lay_text

STATUS = {signal.SIGTERM: 143, signal.SIGINT: 130}
UNDER_WAY = (".partial", ".spin", ".zarr", "c.npz")  # what work goes on from
EHD = 'scene = "needle.toml"\nchunk = 1\n[vary]\njet.voltage = { values = ["5.5 kV", "6 kV", "6.5 kV"] }\n'


def prepared(folder: Path) -> dict[str, list[str]]:
    """Inputs in a folder, and the commands that use them."""
    from spinline.deposit import FibreWriter, Segments
    from spinline.recipe.recipe_file import bundled_recipes
    from spinline.scene.file import bundled_scenes

    data = Path(__file__).parent / "data"
    for name, source in (("scene", "peo5-water"), ("needle", "peo5-needle"), ("spun", "pvp-spun")):
        shutil.copyfile(bundled_scenes()[source], folder / f"{name}.toml")
    shutil.copyfile(bundled_recipes()["pan-dmf"], folder / "recipe.toml")
    (folder / "sweep.toml").write_text(
        'scene = "peo5-water"\nchunk = 60\nset = { network.model = "affine" }\n[vary]\njet.k = { uniform = [0.5, 2.0] }\n'
        '[design]\nkind = "latin-hypercube"\nsamples = 240\n',
        encoding="utf-8",
    )
    (folder / "needles.toml").write_text(EHD, encoding="utf-8")
    (folder / "lay.toml").write_text(lay_text("10 ms"), encoding="utf-8")
    sample = (data / "spindb" / "experiments-sample.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / "table.csv").write_text("".join(sample[:5]), encoding="utf-8")
    rng = np.random.default_rng(1)
    with FibreWriter(folder / "fibres.h5", {"title": "Laid", "seed": 3}) as file:
        file.write(Segments.from_paths([np.cumsum(rng.normal(scale=1e-5, size=(400, 2)), axis=0)], 3e-7))
    _images(folder)
    needle = ["--voltage", "5 kV .. 20 kV", "--gap", "15 cm", "--steps", "5", "--conductivity", "0.01 S/m"]
    return {
        "chain": ["chain"],
        "run": ["run", "scene.toml", "-o", "out.nc", "--force"],
        "sweep": ["sweep", "sweep.toml", "-o", "out.zarr", "--workers", "1"],
        "reduce": ["reduce", "images.toml", "-o", "out.nc", "--no-figure", "--noisy", "--force", "--workers", "1"],
        "fit": ["fit", "peo5-simulated", "-o", "out.nc", "--no-figure", "--force"],
        "sweep of needles": ["sweep", "needles.toml", "-o", "out.zarr", "--workers", "1"],
        "jet": ["jet", "needle.toml", "--figure", "out.png", "--csv", "out.csv", "--force"],
        "window": ["window", "scene.toml", *needle, "-o", "out.nc", "--html", "out.html", "--force"],
        "window of a recipe": ["window", "recipe.toml", *needle, "-o", "out.nc", "--html", "out.html", "--force"],
        "spin": ["spin", "spun.toml", "--quick", "--time", "2 ms", "--frames", "20", "--resume", "-o", "out.nc"],
        "spin of seeds": [*_SEEDS, "--resume", "-o", "out.nc"],
        "deposit": ["deposit", "lay.toml", "-o", "out.h5", "--csv", "out.csv", "--force"],
        "mat": [*_MAT, "--export", "a.vtp", "--export", "a.raw", "--force"],
        "fibre": ["fibre", "--table", "table.csv", "-o", "out.csv", "--force"],
    }


_SEEDS = ["spin", "spun.toml", "--quick", "--time", "0.5 ms", "--frames", "4", "--seeds", "3"]
_MAT = ["mat", "fibres.h5", "-o", "out.nc", "--realisations", "2", "--window", "20 um", "--csv", "out.csv"]


def _images(folder: Path) -> None:
    rng = np.random.default_rng(1)
    x = 0.67e-6 * (np.arange(90) - 44.5)
    inside = 2 * np.sqrt(np.clip(1 - (x / 22e-6) ** 2, 0, None)) * 22e-6
    beam = 4000.0
    counts = rng.poisson(beam * np.exp(-530.0 * inside), (4, 24, 90)).astype(np.uint16)
    np.savez(folder / "frames.npz", counts=counts, flat=rng.poisson(beam, (4, 24, 90)), dark=np.zeros((1, 24, 90)))
    (folder / "images.toml").write_text(
        'counts = "frames.npz"\nflat = "frames.npz"\ndark = "frames.npz"\ngain = 1.0\npixel_size = "0.67 um"\n'
        'energy = "10 keV"\nshells = 1\nframes = "each"\n'
        '[solution]\npolymer = "PEO"\nsolvent = "water"\nmass_fraction = 0.05\n',
        encoding="utf-8",
    )


def main_in(folder: Path, arguments: list[str], delay: float | None, number: int = signal.SIGKILL) -> "Ended":
    """The command line in a child of this process, which gets a signal after `delay`."""
    start = time.monotonic()
    reading, writing = os.pipe()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STATUS)  # until the child no longer stands in this program
    child = os.fork()
    if child == 0:
        status = 70
        try:
            os.close(reading)
            os.chdir(folder)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            os.dup2(writing, 2)
            os.close(writing)
            signal.signal(signal.SIGINT, signal.SIG_DFL)  # as before the command has looked at it
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            status = job(arguments)
        except SystemExit as end:
            status = int(end.code or 0)
        finally:
            os._exit(status)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    os.close(writing)
    killed = delay is not None
    while delay is not None and time.monotonic() - start < delay:
        if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None:
            killed = False
            break
        time.sleep(0.0005)
    if killed:
        os.kill(child, number)
    with os.fdopen(reading, "rb") as file:
        said = file.read().decode("utf-8", "backslashreplace")
    _, status = os.waitpid(child, 0)
    code = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
    return Ended(code, time.monotonic() - start, said, killed)


def warm(commands: dict[str, list[str]], source: Path) -> None:
    """Run the commands here once: what they import and compile is there for the children. Not those of zarr, which has threads."""
    place, here = source.parent / "warm", Path.cwd()
    for name, arguments in commands.items():
        if arguments[0] in ("sweep", "chain"):
            continue
        shutil.copytree(source, place)
        os.chdir(place)
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                job(arguments)
        except SystemExit as end:
            if end.code:
                raise RuntimeError(f"{name} ended with {end.code}") from None
        finally:
            os.chdir(here)
            shutil.rmtree(place)


class Ended:
    """How a command ended: its status (or minus the signal), seconds, what it said, whether it was still at work."""

    def __init__(self, code: int, seconds: float, said: str, stopped: bool) -> None:
        self.code, self.seconds, self.said, self.stopped = code, seconds, said, stopped


def job(arguments: list[str]) -> int:
    """A command, or a chain with its checkpoint."""
    if arguments[0] != "chain":
        from spinline.cli.commands import main

        sys.argv = ["spinline", *arguments]
        main()
        return 0
    from spinline import network
    from spinline.base.files import write_bytes
    from spinline.jetprofile import PowerLaw

    jet = PowerLaw(radius=1e-4, flow_rate=1e-9, k=1.0, beta=0.47)
    chain = network.Chain(flow=network.Flow.from_jet(jet, 12.0), spacing=0.02, coupling=50)
    result = network.run_chain(chain, 4.0, checkpoint="c.npz", checkpoint_seconds=0.0)
    write_bytes("done.bin", np.ascontiguousarray(result.state.positions).tobytes(), force=True)
    return 0


def content(folder: Path) -> dict[str, Any]:
    """Everything that is in a folder, results as numbers."""
    found: dict[str, Any] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix == ".nc":
            found[path.name] = {key: value for key, value in read_netcdf(path).items() if "date" not in key}
        elif path.suffix == ".zarr":
            found[path.name] = read_store(path)
        elif path.name != "c.npz":  # the times of a chain's checkpoint are those of the clock
            found[path.name] = path.read_bytes() if path.is_file() else "folder"
    return found


def content_by_child(folder: Path) -> dict[str, Any]:
    """`content`, read in a child: zarr starts threads, and no process with threads should be forked."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            data = pickle.dumps(content(folder))
        except Exception as error:
            data = pickle.dumps({"unreadable": repr(error)})
        with os.fdopen(writing, "wb") as out:
            out.write(data)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as file:
        data = file.read()
    os.waitpid(child, 0)
    return pickle.loads(data)  # type: ignore[no-any-return]


def campaign(name: str, arguments: list[str], source: Path, moments: list[float], number: int) -> dict[str, Any]:
    """A command ended at so many moments (shares of its time), and started again each time.

    Parameters
    ----------
    name, arguments : str, list of str
        From `prepared`.
    source : Path
        The folder of the inputs; the others are made beside it.
    moments : list of float
        Shares of the undisturbed command's time.
    number : int
        The signal.
    """
    whole = source.parent / name
    for _ in range(2):  # caches of what is not warm, then the time
        shutil.rmtree(whole, ignore_errors=True)
        shutil.copytree(source, whole)
        undisturbed = main_in(whole, arguments, None)
    if undisturbed.code:
        raise SystemExit(f"{name} ended with {undisturbed.code}: {undisturbed.said}")
    expected = content_by_child(whole)
    tally: Counter[str] = Counter()
    bad: list[str] = []
    for i, moment in enumerate(moments):
        folder = source.parent / f"{name}-{i}"
        shutil.copytree(source, folder)
        ended = main_in(folder, arguments, moment * undisturbed.seconds, number)
        found = judged(folder, ended, number, expected)
        tally["stopped" if ended.stopped and ended.code else "ended before"] += 1
        tally["left beside"] += sum(path.name.startswith(".spinline-") for path in folder.iterdir())
        again = main_in(folder, arguments, None)
        if again.code:
            found.append(f"the second start ended with {again.code}: {again.said[-300:]}")
        elif not same(after := content_by_child(folder), expected):
            odd = set(after) ^ set(expected) or {key for key in after if not same(after[key], expected.get(key))}
            found.append(f"other than undisturbed in {sorted(odd)}")
        bad += [f"{name} {i} at {moment:.4f} of {undisturbed.seconds:.2f} s: {words}" for words in found]
        shutil.rmtree(folder)
    shutil.rmtree(whole)
    return {"seconds": round(undisturbed.seconds, 3), **dict(sorted(tally.items())), "bad": bad}


def judged(folder: Path, ended: Ended, number: int, expected: dict[str, Any]) -> list[str]:
    """What is wrong with a folder after a command was stopped in it, in words."""
    bad = []
    if "Traceback" in ended.said or "fault of this program" in ended.said:
        bad.append(f"said {ended.said[-500:]!r}")
    if ended.code not in (0, -number, STATUS.get(number)):
        bad.append(f"ended with {ended.code}")
    left = {path.name: path for path in folder.iterdir()}
    for file, path in left.items():
        if file in expected and not path.is_dir():
            found = content_by_child_of(path)
            if not same(found, expected[file]):
                bad.append(f"{file} is not whole")
        elif number != signal.SIGKILL and file not in expected and not file.endswith(UNDER_WAY):
            bad.append(f"left {file}")
    return bad


def content_by_child_of(path: Path) -> Any:
    """`content` of one file alone."""
    with_it = path.parent.parent / f"alone-{os.getpid()}"
    with_it.mkdir()
    try:
        shutil.copy(path, with_it)
        return content_by_child(with_it).get(path.name, "unreadable")
    finally:
        shutil.rmtree(with_it)
