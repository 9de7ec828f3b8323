"""The whole attack: damaged files, kills at random moments, random scenes. Its numbers stand in ``attack.json``.

    python benchmarks/attack.py damage 2000 | kills 200 | stops 100 | scenes 5000 | keys 1000  [--seed S]

``kills`` ends commands by SIGKILL, ``stops`` by SIGTERM and SIGINT in turn. ``keys`` makes every number of the files that
`deposit`, `window` and `spin` read wrong in eight ways; the count is at most of each command.

Each part writes its own entry of ``benchmarks/attack.json``; the scenes go on where their ``--log`` ends.
Tests run a sample of the same (``tests/test_attack*.py``).
"""

import argparse
import contextlib
import io
import json
import os
import random
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
os.environ["SPINLINE_QUIET"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import hostile_keys  # noqa: E402
from file_damage import GOOD, attack  # noqa: E402
from file_kills import campaign, prepared, warm  # noqa: E402
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


def kills(count: int, seed: int, only: list[str] | None = None, number: int = signal.SIGKILL) -> dict[str, Any]:
    """Commands ended at random moments, and the same commands again."""
    import zarr  # noqa: F401

    import spinline.study.sweep  # noqa: F401

    rng = random.Random(seed)
    report: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch) / "source"
        source.mkdir()
        commands = prepared(source)
        each = -(-count // len(commands))
        warm({name: words for name, words in commands.items() if not only or name in only}, source)
        for name, arguments in commands.items():
            moments = [rng.uniform(0.0, 1.05) for _ in range(each)]  # the last may lie behind the end
            if only and name not in only:
                continue
            report[name] = {"seed": seed, **campaign(name, arguments, source, moments, number)}
            print(name, report[name], flush=True)
    return report


# --- keys --------------------------------------------------------------------------------------------------------------


def keys(count: int) -> dict[str, Any]:
    """Every key of every command made wrong, the command run as from a shell."""
    from lay_text import lay_text

    from spinline.cli import main as command_line

    def run(*words: str) -> tuple[int, str]:
        sys.argv, said = ["spinline", *words], io.StringIO()
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):
            try:
                command_line()
            except SystemExit as ended:
                return int(ended.code or 0), said.getvalue()
        return 0, said.getvalue()

    report: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as scratch, contextlib.chdir(scratch):
        Path("lay.toml").write_text(lay_text(), encoding="utf-8")
        for name, command in hostile_keys.COMMANDS.items():
            verdicts: Counter[str] = Counter()
            bad = []
            for case in list(hostile_keys.hostile(command.sheet(), command.profile))[:count]:
                words = (*command.words, "--set", f"{case.key}={case.value}")
                try:
                    verdict = hostile_keys.judged(*hostile_keys.stopped_after(hostile_keys.PATIENCE, run, *words), case)
                except hostile_keys.Hang:
                    verdict = "hang"
                known = verdict in hostile_keys.CODES.values()
                verdicts[verdict if known else "bad"] += 1
                bad += [] if known else [f"{case}: {verdict}"]
            report[name] = {"cases": verdicts.total(), **verdicts, "bad": bad}
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


def scenes(count: int, seed: int, log: Path, longest: float = float("inf")) -> dict[str, Any]:
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
    arguments.add_argument("part", choices=("damage", "kills", "stops", "scenes", "keys"))
    arguments.add_argument("count", type=int)
    arguments.add_argument("--seed", type=int, default=0)
    arguments.add_argument("--log", type=Path, default=Path("attack-scenes.jsonl"), help="Verdicts, gone on with.")
    arguments.add_argument("--longest", type=float, default=float("inf"), help="Seconds after which scenes stop.")
    arguments.add_argument("--commands", nargs="*", help="Of the kills and stops; default all.")
    arguments.add_argument(
        "--victims", nargs="*", help="Of the damage: their names, of which the others' verdicts are kept; default all."
    )
    arguments.add_argument("--json", type=Path, default=HERE / "attack.json")
    asked = arguments.parse_args()
    if asked.part == "damage":
        found = damage(asked.count, asked.seed, asked.victims)
    elif asked.part == "kills":
        found = kills(asked.count, asked.seed, asked.commands)
    elif asked.part == "keys":
        found = keys(asked.count)
    elif asked.part == "stops":
        found = {}
        for number in (signal.SIGTERM, signal.SIGINT):
            stopped = kills(asked.count // 2, asked.seed, asked.commands, number)
            found |= {f"{name}, {number.name}": what for name, what in stopped.items()}
    else:
        found = scenes(asked.count, asked.seed, asked.log, asked.longest)
    kept = json.loads(asked.json.read_text(encoding="utf-8")) if asked.json.exists() else {}
    if asked.part == "damage":
        found = together(kept.get("damage", {}) if asked.victims else {}, found)
    kept[asked.part] = {**kept.get(asked.part, {}), **found} if asked.commands else found
    asked.json.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({key: value for key, value in found.items() if key != "bad"}, indent=1)[:3000])
    if asked.part == "damage" and not set(found["verdicts"]) <= GOOD:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
