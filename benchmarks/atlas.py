"""Stability atlas: scenes over the whole parameter box, each a result within physical bounds or a named refusal.

    python benchmarks/atlas.py --scenes 500 --first 0 --records records.jsonl      # any number of times, from where it ended
    python benchmarks/atlas.py --records records.jsonl -o benchmarks/atlas.json    # what they say together
    python benchmarks/atlas.py --check benchmarks/atlas.json --scenes 1000
    python benchmarks/atlas.py --again benchmarks/atlas.json
    python benchmarks/atlas_figure.py benchmarks/atlas.json docs/images/atlas.png

A scene follows from (seed, index) alone (`atlas_scenes`). Each may take ten seconds; a hang, a crash, a NaN that no flag
explains, a value out of bounds or a warning of a library is a failure and is listed with its index. For every scene it is kept
where its numbers put it (the plan's: eps V', De, phi, V), which model holds there within 1e-2, which was taken, and how far the
plan says that it is off. The summary holds one letter a scene, counts, and maps; `--check` judges the first scenes again and
compares the letters.
"""

import argparse
import json
import multiprocessing
import re
import signal
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from atlas_scenes import MODELS, build, draw

LIMIT = 10.0  # s
RTOL = 1e-2  # within which a model holds, on the maps
AXES = {  # of the maps: name, low, high (decades of the number)
    "slip": (-8, 3),  # largest eps V'
    "deborah": (-5, 7),  # theta edot at the crossover
    "volume_fraction": (-5, 0),
    "stretch": (0, 8),  # V at the end
}
PLANES = (("deborah", "slip"), ("volume_fraction", "stretch"))
BINS = 24
HOLDS = ("affine", "manifold", "conformation", "neither", "unsteady", "unknown")
TAKEN = {
    "affine": "A",
    "manifold": "M",
    "conformation": "C",
    "two-fluid": "T",
}  # by auto; in small letters where asked for
ASKED = {"affine": "a", "manifold": "m", "conformation": "c", "chain": "h", "walk": "w", "two-fluid": "t"}
OFF = (-np.inf, -3, -2, -1, 0, np.inf)  # decades of what the plan says a result is off


def letter(asked, taken, kind):
    """One scene in one letter: the model of a result, a figure for a refusal, an exclamation mark for a failure."""
    if kind == "refused":
        return str(MODELS.index(asked))
    if kind != "result":
        return "!"
    return TAKEN[taken] if asked == "auto" else ASKED[taken]


def place_of(plan):
    """Numbers of a plan that put a scene on the maps, which model holds it within `RTOL`, and what is left out of it."""
    from spinline.plan import MARGIN
    from spinline.plan.estimates import UNSTEADY

    known = {effect["name"]: effect for effect in plan["effects_used"] + plan["effects_left_out"]}
    slip, relaxing = known["elastic coupling"], known["relaxation"]
    place = {
        "slip": slip["number"],
        "deborah": relaxing["number"],
        "inertia": known["inertia"]["number"],
        "dried": known["evaporation"]["number"],
        "peclet": known["radial gradients"]["number"],
    }
    if slip["estimated_error"] is None or relaxing["estimated_error"] is None:
        return place, "unknown", None
    slips, relaxes = (MARGIN * effect["estimated_error"] > RTOL for effect in (slip, relaxing))
    lost = slip["number"] > UNSTEADY
    holds = (
        "neither"
        if slips and relaxes
        else "unsteady"
        if lost
        else "manifold"
        if slips
        else "conformation"
        if relaxes
        else "affine"
    )
    out = [effect for effect in plan["effects_left_out"] if effect["name"] in ("elastic coupling", "relaxation")]
    return place, holds, max((effect["estimated_error"] for effect in out), default=0.0)


BOUNDS = {
    "radius": (0, 1),
    "velocity_ratio": (0, np.inf),
    "orientation": (-0.5, 1),
    "relative_extension": (0, 1 + 1e-9),
    "axial_stretch": (0, np.inf),
    "radial_contraction": (0, 1.5),
    "core_polymer_fraction": (0, 1),
    "core_polymer_fraction_eq40": (0, 1),
    "core_polymer_fraction_conservative": (0, 1),
    "mean_polymer_fraction": (0, 1),
    "network_radius": (0, 1),
    "network_velocity_ratio": (0, np.inf),
    "polymer_fraction": (0, 1 + 1e-9),
    "temperature": (120, 480),
    "evaporated_fraction": (-np.inf, 1),
}
EXPLAINED = ("strand_force", "residence_time", "weissenberg", "strain_rate")  # NaN has a meaning of its own there


def faults(result):
    """What is out of bounds, or NaN without a flag, in a result."""
    said = []
    known = np.isfinite(result["stretch_ratio"].values)
    for name, (least, high) in BOUNDS.items():
        low = -1.0 if result.attrs["model"] == "walk" and least == 0 else least  # a mean of a hundred strands scatters
        if name not in result or not result[name].dims:
            continue
        values = result[name].values
        if values.shape[: known.ndim] == known.shape:
            values = values[known]
        if np.isnan(values).any():
            said.append(f"{name}: {int(np.isnan(values).sum())} NaN")
        elif not ((values >= low) & (values <= high)).all():
            said.append(f"{name}: {values.min():g} ... {values.max():g}")
    for name in ("crossover", "crossover_extension"):
        if np.isnan(float(result[f"{name}_position"])) and "reached" not in result.attrs[name]:
            said.append(f"{name}_position: NaN without a word")
    return said


class TooLongError(Exception):
    """The limit of time has passed."""


def _stop(*_):
    raise TooLongError


def judge(seed, index, wall=False):
    """Outcome of one scene: a dictionary with its kind, asked and taken model, words, seconds, place."""
    from spinline.base.errors import InputError, SpinlineWarning
    from spinline.solve import run

    data = draw(seed, index)
    clock = time.perf_counter if wall else time.process_time
    asked = data["network"]["model"]
    found = {
        "index": index,
        "kind": "result",
        "asked": asked,
        "taken": asked,
        "words": "",
        "said": Counter(),
        "plan": None,
    }
    stop = signal.SIGALRM if wall else signal.SIGPROF  # processor time: what else the machine does is no hang
    timer = signal.ITIMER_REAL if wall else signal.ITIMER_PROF
    signal.signal(stop, _stop)
    began = clock()
    signal.setitimer(timer, LIMIT)
    try:
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as remarks:
            warnings.simplefilter("error")
            warnings.simplefilter("always", SpinlineWarning)  # remarks on the scene, counted
            warnings.simplefilter("always", DeprecationWarning)  # of libraries, counted by their words
            scene = build(data, folder)
            try:
                result = run(scene)
                found["plan"] = json.loads(result.attrs["plan"])
                found["taken"] = result.attrs["model"]
                wrong = faults(result)
                if wrong:
                    found |= {"kind": "out of bounds", "words": "; ".join(wrong)}
            except InputError as error:
                found |= {"kind": "refused", "words": _words(error), "plan": _plan(scene)}
        found["said"] = Counter(
            "remarks" if issubclass(item.category, SpinlineWarning) else str(item.message) for item in remarks
        )
    except InputError as error:
        found |= {"kind": "refused", "words": _words(error)}
    except TooLongError:
        found["kind"] = "hang"
    except Warning as warning:
        found |= {"kind": "warning", "words": f"{type(warning).__name__}: {warning}"}
    except Exception as error:
        found |= {"kind": "crash", "words": f"{type(error).__name__}: {error}"}
    finally:
        signal.setitimer(timer, 0)
    found["seconds"] = clock() - began
    place, holds, off = ({}, "unknown", None) if found["plan"] is None else place_of(found.pop("plan"))
    jet = data["jet"]
    v = jet["samples"][1][-1] if "samples" in jet else stretch_at_end(jet)
    place |= {"volume_fraction": data["solution"]["volume_fraction"], "stretch": float(v)}
    found |= {"place": place, "holds": holds, "off": off, "letter": letter(asked, found["taken"], found["kind"])}
    return found


def stretch_at_end(jet):
    """V at the end of a drawn jet."""
    s = float(jet["length"].split()[0]) / float(jet["radius"].split()[0])
    return max(jet["k"] ** 2 * s ** (2 * jet["beta"]), 1.0) if "k" in jet else (1 + s / jet["p"]) ** 2


def _words(error):
    return re.sub(r"\d[\d.e+-]*", "#", f"{error.field}: {error.problem}")


def _plan(scene):
    """The plan of a scene that is refused, if it has one."""
    from spinline.base.errors import InputError
    from spinline.plan import plan_scene
    from spinline.setup.build import build_jet, build_solution

    try:
        solution = build_solution(scene)
        return plan_scene(scene, solution, build_jet(scene, solution)).plain()
    except InputError:
        return None


def warm():
    """Compile what will be used, so that no scene is charged for it."""
    from spinline.base.errors import SpinlineWarning
    from spinline.scene import load_scene
    from spinline.solve import run

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)  # of scenes made to compile, not to be read
        for model in MODELS[1:]:
            extra = ['network.closure="stretch"'] if model in ("manifold", "two-fluid", "conformation") else []
            small = [
                "accuracy.points=17",
                "accuracy.strands=10",
                "jet.length=1 mm",
                'solution.relaxation_time="1 s"',
            ]
            run(load_scene("peo5-water", [f'network.model="{model}"', *small, *extra]))
        run(load_scene("peo5-fig37"))


def _judge(task):
    return judge(*task)


def _bin(name, value):
    """Bin of a number, which may lie outside of 0 ... BINS - 1."""
    low, high = AXES[name]
    place = (np.log10(value) - low) / (high - low) * BINS if value > 0 else -1.0
    return int(np.clip(np.floor(place), -1, BINS))


def outcomes_of(seed, first, scenes, workers, wall=False):
    """Outcomes of a range of scenes, as they come."""
    tasks = ((seed, i, wall) for i in range(first, first + scenes))
    if workers == 1:
        warm()
        yield from map(_judge, tasks)
        return
    with multiprocessing.get_context("spawn").Pool(workers, warm) as pool:
        yield from pool.imap_unordered(_judge, tasks, chunksize=20)


def plain(one):
    """An outcome as a line of JSON."""
    return json.dumps(one | {"said": dict(one["said"])}) + "\n"


def summary_of(outcomes, seed, first, scenes, wall=False):
    """Summary of the outcomes of a range of scenes."""
    letters, spell = ["?"] * scenes, [0] * scenes
    counts, reasons, warned, off, bad, slowest = Counter(), Counter(), Counter(), {}, [], (0.0, -1)
    spent, holding = Counter(), Counter()
    held = {pair: np.zeros((BINS, BINS, len(HOLDS)), int) for pair in PLANES}
    came = {pair: np.zeros((BINS, BINS, len(MODELS), 2), int) for pair in PLANES}
    for one in outcomes:
        asked, kind = one["asked"], one["kind"]
        model = f"auto: {one['taken']}" if asked == "auto" and kind == "result" else asked
        letters[one["index"] - first] = one["letter"]
        spell[one["index"] - first] = round(1e3 * one["seconds"])
        counts[f"{model} / {kind}"] += 1
        spent[asked] += one["seconds"]
        holding[one["holds"]] += 1
        if kind == "refused":
            reasons[one["words"]] += 1
        elif kind != "result":
            bad.append({key: one[key] for key in ("index", "kind", "asked")} | {"words": one["words"][:300]})
        else:
            size = np.nan if one["off"] is None else np.log10(max(one["off"], 1e-300))
            row = off.setdefault(model, [0] * len(OFF))
            row[-1 if np.isnan(size) else int(np.searchsorted(OFF, size, side="right")) - 1] += 1
        slowest = max(slowest, (one["seconds"], one["index"]))
        warned += one["said"]
        for pair in PLANES:
            values = [one["place"].get(name) for name in pair]
            if None in values:
                continue
            x, y = (_bin(name, value) for name, value in zip(pair, values, strict=True))
            if not (0 <= x < BINS and 0 <= y < BINS):
                continue
            held[pair][x, y, HOLDS.index(one["holds"])] += 1
            came[pair][x, y, MODELS.index(asked)] += (1, kind == "result")
    return {
        "seed": seed,
        "first": first,
        "scenes": scenes,
        "seconds": round(sum(spent.values()), 1),
        "clock": "wall" if wall else "processor",
        "limit": LIMIT,
        "slowest": {"seconds": round(slowest[0], 2), "index": slowest[1]},
        "seconds_by_model": {model: round(value, 1) for model, value in spent.items()},
        "outcomes": dict(sorted(counts.items())),
        "refusals": dict(reasons.most_common(60)),
        "warned": dict(warned),
        "failed": len(bad),
        "failures": sorted(bad, key=lambda item: item["index"])[:500],
        "rtol_of_maps": RTOL,
        "holds": dict(holding),
        "off_decades": [str(edge) for edge in OFF[:-1]] + ["not known"],
        "off": dict(sorted(off.items())),
        "axes": AXES,
        "bins": BINS,
        "classes": HOLDS,
        "models": MODELS,
        "held": {" ".join(pair): counts.tolist() for pair, counts in held.items()},
        "came": {" ".join(pair): counts.tolist() for pair, counts in came.items()},
        "letters": "".join(letters),
        "milliseconds": spell,
    }


def sample(summary, rng, seconds, dearest=0.5):
    """Scenes to judge again: two of every letter, then any, as many as take so many seconds by the summary.

    Parameters
    ----------
    summary : dict
        Of `summary_of`.
    rng : numpy.random.Generator
    seconds : float
        Of processor time, in all.
    dearest : float
        Scenes that took longer are left out, but for one.
    """
    cost = np.array(summary["milliseconds"]) / 1e3
    dear = np.flatnonzero((cost > dearest) & (cost < 4 * dearest))
    taken = rng.permutation(dear)[:1].tolist()
    cheap = rng.permutation(np.flatnonzero(cost <= dearest))
    letters = Counter()
    order = []
    for i in cheap.tolist():
        letters[summary["letters"][i]] += 1
        order.append((letters[summary["letters"][i]] > 2, i))
    spent = cost[taken].sum()
    for _, i in sorted(order, key=lambda item: item[0]):
        spent += cost[i]
        if spent > seconds:
            break
        taken.append(i)
    return sorted(taken)


def check(summary, scenes, workers=1, skip=0, which=None):
    """Scenes of a summary judged again: those that fail, and those whose letter is another one now.

    Parameters
    ----------
    summary : dict
        Of `campaign`.
    scenes : int
        How many.
    skip : int
        How many of its first are left out.
    which : list of int, optional
        These instead.
    """
    failed, changed = [], []
    if which is None:
        count = min(scenes, summary["scenes"] - skip)
        ones = outcomes_of(summary["seed"], summary["first"] + skip, count, workers)
    else:
        warm()
        ones = (judge(summary["seed"], summary["first"] + i) for i in which)
    for one in ones:
        was = summary["letters"][one["index"] - summary["first"]]
        if one["letter"] == "!":
            failed.append({key: one[key] for key in ("index", "kind", "asked", "words")})
        if one["letter"] != was:
            changed.append(f"{one['index']}: {was} -> {one['letter']} ({one['words'][:80]})")
    return failed, changed


def judged_again(summary):
    """A summary whose failures are judged again; what they were is kept under ``mended``, the maps are left as they were."""
    letters, outcomes = list(summary["letters"]), Counter(summary["outcomes"])
    still, mended = [], list(summary.get("mended", []))
    warm()
    for item in summary["failures"]:
        one = judge(summary["seed"], item["index"])
        if one["kind"] not in ("result", "refused"):
            still.append(item)
            continue
        letters[item["index"] - summary["first"]] = one["letter"]
        outcomes[f"{item['asked']} / {item['kind']}"] -= 1
        taken = f"auto: {one['taken']}" if item["asked"] == "auto" and one["kind"] == "result" else item["asked"]
        outcomes[f"{taken} / {one['kind']}"] += 1
        mended.append(item | {"now": one["kind"]})
    new = {"failed": len(still), "failures": still, "mended": mended, "letters": "".join(letters)}
    return summary | new | {"outcomes": {name: count for name, count in sorted(outcomes.items()) if count}}


def main():
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=multiprocessing.cpu_count())
    parser.add_argument("--wall", action="store_true", help="limit by the wall clock, not by processor time")
    parser.add_argument("--records", type=Path, help="outcomes, one a line: added to, and what the summary is made of")
    parser.add_argument("-o", "--out", type=Path)
    parser.add_argument("--check", type=Path, help="judge the first scenes of this summary again, and compare")
    parser.add_argument("--again", type=Path, help="judge the failures of this summary again, after mending; in place")
    asked = parser.parse_args()
    if asked.again:
        summary = judged_again(json.loads(asked.again.read_text(encoding="utf-8")))
        asked.again.write_text(json.dumps(summary) + "\n", encoding="utf-8")
        print(json.dumps({"mended": summary["mended"], "failures": summary["failures"]}, indent=1))
        raise SystemExit(bool(summary["failures"]))
    if asked.check:
        failed, changed = check(json.loads(asked.check.read_text(encoding="utf-8")), asked.scenes, asked.workers)
        print(json.dumps({"failed": failed, "changed": changed}, indent=1))
        raise SystemExit(bool(failed or changed))
    if asked.scenes:
        with asked.records.open("a", encoding="utf-8") as file:
            for one in outcomes_of(asked.seed, asked.first, asked.scenes, asked.workers, asked.wall):
                file.write(plain(one))
                file.flush()
    if not asked.out:
        return
    lines = asked.records.read_text(encoding="utf-8").splitlines()
    known = {one["index"]: one for one in map(json.loads, lines)}
    scenes = next(i for i in range(len(known) + 1) if i not in known)  # from the first on, without a gap
    summary = summary_of((known[i] for i in range(scenes)), asked.seed, 0, scenes, asked.wall)
    asked.out.write_text(json.dumps(summary) + "\n", encoding="utf-8")
    keys = ("seconds", "slowest", "seconds_by_model", "outcomes", "refusals", "holds", "off", "warned", "failed")
    print(json.dumps({key: summary[key] for key in keys}, indent=1))
    for item in summary["failures"][:20]:
        print(item)


if __name__ == "__main__":
    main()
