"""The whole attack: damaged files, kills at random moments, random scenes. Its numbers stand in ``attack.json``.

    python benchmarks/attack.py damage 2000 | kills 200 | scenes 5000  [--seed S]

Each part writes its own entry of ``benchmarks/attack.json``; the scenes go on where their ``--log`` ends.
Tests run a sample of the same (``tests/test_attack.py``).
"""

import argparse
import json
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
os.environ["SPINLINE_QUIET"] = "1"

from file_damage import GOOD, attack  # noqa: E402
from file_victims import make_victims  # noqa: E402
from random_scenes import scene  # noqa: E402

LONGEST = 30.0  # s for one scene
PATIENCE = 5.0


def damage(count: int, seed: int, only: list[str] | None = None) -> dict[str, Any]:
    """Damaged files of every kind."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        victims = make_victims(folder, HERE.parent / "tests" / "data")
        each = -(-count // len(victims))
        victims = [victim for victim in victims if not only or victim.name in only]
        (folder / "copies").mkdir()
        found, worst = {}, []
        for victim in victims:
            verdicts, bad = attack(victim, folder / "copies", range(seed, seed + each))
            found[victim.name] = dict(sorted(verdicts.items()))
            worst += bad
            print(victim.name, found[victim.name], bad[:2], flush=True)
    return {"by_kind": found, "bad": worst, "seed": seed}


def together(before: dict[str, Any], found: dict[str, Any]) -> dict[str, Any]:
    """Damage of some victims beside what is known of the others: the whole may be run in parts."""
    kinds = {**before.get("by_kind", {}), **found["by_kind"]}
    bad = [line for line in before.get("bad", []) if not any(line.startswith(f"{name} ") for name in found["by_kind"])]
    total: Counter[str] = Counter()
    for verdicts in kinds.values():
        total.update(verdicts)
    return {
        "files": sum(total.values()),
        "seed": found["seed"],
        "verdicts": dict(sorted(total.items())),
        "by_kind": kinds,
        "bad": bad + found["bad"],
    }


# --- kills -------------------------------------------------------------------------------------------------------------


def main_in(folder: Path, arguments: list[str], delay: float | None) -> tuple[int, float]:
    """The command line in a child of this process; killed after `delay`. Status (or minus the signal) and seconds."""
    start = time.monotonic()
    child = os.fork()
    if child == 0:
        os.chdir(folder)
        for stream in (1, 2):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
        status = 70
        try:
            status = job(arguments)
        except SystemExit as end:
            status = int(end.code or 0)
        finally:
            os._exit(status)
    if delay is not None:
        while time.monotonic() - start < delay:
            if os.waitpid(child, os.WNOHANG)[0]:
                return 0, time.monotonic() - start
            time.sleep(0.0005)
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    return (-os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)), time.monotonic() - start


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


def prepared(folder: Path) -> dict[str, list[str]]:
    """Inputs in a folder, and the commands that use them."""
    import numpy as np

    from spinline.scene.file import bundled_scenes

    (folder / "sweep.toml").write_text(
        'scene = "peo5-water"\nchunk = 60\nset = { network.model = "affine" }\n[vary]\njet.k = { uniform = [0.5, 2.0] }\n'
        '[design]\nkind = "latin-hypercube"\nsamples = 240\n',
        encoding="utf-8",
    )
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
    shutil.copyfile(bundled_scenes()["peo5-water"], folder / "scene.toml")
    return {
        "chain": ["chain"],
        "run": ["run", "scene.toml", "-o", "out.nc", "--force"],
        "sweep": ["sweep", "sweep.toml", "-o", "out.zarr", "--workers", "1"],
        "reduce": ["reduce", "images.toml", "-o", "out.nc", "--no-figure", "--noisy", "--force", "--workers", "1"],
        "fit": ["fit", "peo5-simulated", "-o", "out.nc", "--no-figure", "--force"],
    }


def content(folder: Path) -> dict[str, Any]:
    """Everything that is in a folder, results as numbers."""
    from file_victims import read_netcdf, read_store

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
    import pickle

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


def kills(count: int, seed: int, only: list[str] | None = None) -> dict[str, Any]:
    """Kills at random moments, and the same command again."""
    import h5netcdf  # noqa: F401
    import xarray  # noqa: F401
    import zarr  # noqa: F401
    from file_damage import same

    import spinline.fit.output
    import spinline.radiography.reduce
    import spinline.report.figures
    import spinline.solve.spine
    import spinline.study.sweep  # noqa: F401

    rng = random.Random(seed)
    report: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch) / "source"
        source.mkdir()
        commands = prepared(source)
        each = -(-count // len(commands))
        commands = {name: words for name, words in commands.items() if not only or name in only}
        for name, arguments in commands.items():
            whole = Path(scratch) / name
            shutil.copytree(source, whole)
            main_in(whole, arguments, None)  # caches
            shutil.rmtree(whole)
            shutil.copytree(source, whole)
            status, seconds = main_in(whole, arguments, None)
            if status:
                raise SystemExit(f"{name} ended with {status}")
            expected = content_by_child(whole)
            tally: Counter[str] = Counter()
            bad = []
            for i in range(each):
                folder = Path(scratch) / f"{name}-{i}"
                shutil.copytree(source, folder)
                delay = rng.uniform(0.0, 1.05 * seconds)
                killed, _ = main_in(folder, arguments, delay)
                tally["killed" if killed == -signal.SIGKILL else "ended before"] += 1
                after = content_by_child(folder) if name == "run" else {}
                if "unreadable" in after:
                    bad.append(f"{name} {i} at {delay:.3f} s: {after['unreadable']}")
                tally["left beside"] += sum(path.name.startswith(".spinline-") for path in folder.iterdir())
                again, _ = main_in(folder, arguments, None)
                found = content_by_child(folder)
                if again:
                    bad.append(f"{name} {i} at {delay:.3f} s: the second start ended with {again}")
                elif not same(found, expected):
                    odd = sorted(set(found) ^ set(expected)) or [
                        k for k in found if not same(found[k], expected.get(k))
                    ]
                    bad.append(f"{name} {i} at {delay:.3f} s: other than undisturbed in {odd}")
                shutil.rmtree(folder)
            report[name] = {"seconds": round(seconds, 3), **tally, "bad": bad}
            print(name, report[name], flush=True)
    return report


# --- scenes ------------------------------------------------------------------------------------------------------------

_RANGES = {
    "relative_extension": (0.0, 1.0),
    "radial_contraction": (0.0, 1.0),
    "orientation": (-0.5, 1.0),
    "mean_polymer_fraction": (0.0, 1.0),
    "core_polymer_fraction": (0.0, 1.0),
    "radius": (0.0, 1e3),
    "network_radius": (0.0, 1e3),
    "velocity_ratio": (0.0, 1e300),
    "stretch_ratio": (0.0, 1e300),
    "surface_polymer_fraction": (0.0, 1.0),
    "axis_polymer_fraction": (0.0, 1.0),
    "volume_fraction": (0.0, 1.0),
}


def judged(tables: dict[str, Any]) -> str:
    """What becomes of a scene, in a word and its reason."""
    import numpy as np

    from spinline.base.errors import InputError, SpinlineWarning
    from spinline.scene.file import scene_from_dict
    from spinline.solve.spine import solved

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)
            warnings.simplefilter("error", RuntimeWarning)
            result = solved(scene_from_dict(tables))
    except InputError as error:
        return f"refused {error.field}: {error.problem}"
    except Exception as error:
        return f"traceback {type(error).__name__} {str(error)[:200]}"
    said = str(result.attrs["warnings"])
    for name, variable in result.variables.items():
        values = np.asarray(variable.values)
        if values.dtype.kind != "f":
            continue
        if np.isinf(values).any():
            return f"infinite {name}"
        if np.isnan(values).any() and variable.attrs.get("missing", "not known") == "not known":
            return f"unexplained {name}"
        low, high = _RANGES.get(name, (-np.inf, np.inf))
        beyond = float(np.max(np.nan_to_num(np.fmax(low - values, values - high), nan=0.0), initial=0.0))
        if beyond > 1e-9 and f"sampled: {name} lies" not in said:
            return f"beyond {name} {beyond:.3g}"
    return "solved"


def scenes(count: int, seed: int, log: Path, longest: float = np.inf) -> dict[str, Any]:
    """Random scenes, each in its time; fewer where `longest` seconds have passed.

    Every verdict is a line of `log`: another start goes on with the scenes that have none.
    """
    until = time.monotonic() + longest
    with log.open("a+", encoding="utf-8") as lines:
        lines.seek(0)
        done = {int(line["scene"]): line for line in map(json.loads, lines)}
        for i in range(seed, seed + count):
            if time.monotonic() > until:
                break
            if i in done:
                continue
            verdict, used = judged_in_time(i)
            done[i] = {"scene": i, "seconds": round(used, 4), "verdict": verdict}
            lines.write(json.dumps(done[i]) + "\n")
            lines.flush()
            if used > PATIENCE or verdict.partition(" ")[0] not in ("refused", "solved"):
                print(f"{i}: {used:.1f} s {verdict} {scene(i)}"[:1500], flush=True)
    return summary([done[i] for i in sorted(done) if seed <= i < seed + count], seed)


def judged_in_time(i: int) -> tuple[str, float]:
    """What becomes of a scene, and its processor time, s: other work on the machine does not count."""
    start = time.process_time()
    signal.signal(signal.SIGPROF, _late)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        verdict = judged(scene(i))
    except Late:
        verdict = "late"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return verdict, time.process_time() - start


def summary(lines: list[dict[str, Any]], seed: int) -> dict[str, Any]:
    """Counts of the verdicts, times, and every scene that is neither solved nor refused."""
    reasons: Counter[str] = Counter()
    for line in lines:
        word, _, reason = line["verdict"].partition(" ")
        if word == "refused":
            reasons[reason.partition(" (")[0][:100]] += 1
    ordered = sorted(line["seconds"] for line in lines)
    return {
        "seed": seed,
        "scenes": len(lines),
        "verdicts": dict(Counter(line["verdict"].partition(" ")[0] for line in lines)),
        "within_5_s": sum(s <= PATIENCE for s in ordered) / len(ordered),
        "median_s": ordered[len(ordered) // 2],
        "longest_s": round(ordered[-1], 2),
        "commonest_refusals": dict(reasons.most_common(25)),
        "bad": [
            f"{line['scene']}: {line['verdict']}"
            for line in lines
            if line["verdict"].partition(" ")[0] not in ("refused", "solved")
        ],
    }


class Late(BaseException):
    """A scene took longer than `LONGEST`."""


def _late(*_: object) -> None:
    raise Late


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("part", choices=("damage", "kills", "scenes"))
    arguments.add_argument("count", type=int)
    arguments.add_argument("--seed", type=int, default=0)
    arguments.add_argument("--log", type=Path, default=Path("attack-scenes.jsonl"), help="Verdicts, gone on with.")
    arguments.add_argument("--longest", type=float, default=np.inf, help="Seconds after which scenes stop.")
    arguments.add_argument("--commands", nargs="*", help="Of the kills: run, sweep, reduce, chain, fit.")
    arguments.add_argument(
        "--victims", nargs="*", help="Of the damage: their names, of which the others' verdicts are kept; default all."
    )
    arguments.add_argument("--json", type=Path, default=HERE / "attack.json")
    asked = arguments.parse_args()
    if asked.part == "damage":
        found = damage(asked.count, asked.seed, asked.victims)
    elif asked.part == "kills":
        found = kills(asked.count, asked.seed, asked.commands)
    else:
        found = scenes(asked.count, asked.seed, asked.log, asked.longest)
    kept = json.loads(asked.json.read_text(encoding="utf-8")) if asked.json.exists() else {}
    if asked.part == "damage":
        found = together(kept.get("damage", {}) if asked.victims else {}, found)
    kept[asked.part] = {**kept.get(asked.part, {}), **found} if asked.part == "kills" else found
    asked.json.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({key: value for key, value in found.items() if key != "bad"}, indent=1)[:3000])
    if asked.part == "damage" and not set(found["verdicts"]) <= GOOD:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
