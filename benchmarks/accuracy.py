"""Whether `--rtol` is kept: random scenes, the rung the plan takes against the finest of its branch, and what it cost.

    python benchmarks/accuracy.py --scenes 1000 --minutes 9 --records records.jsonl    # until all are in
    python benchmarks/accuracy.py --scenes 1000 --records records.jsonl -o benchmarks/accuracy.json

Scenes are the straight ones of the atlas (`atlas_scenes.draw`), air and radial drying left out. Met: the reported quantities
(`spinline.study.difference`) are within rtol of the reference of every branch that the rung claims to be good for. Cost:
processor time of the rung over that of the cheapest that would have met rtol.

Scenes where the plan says that an effect is left out which passes rtol (no model holds both, or none is steady) cannot meet it
and are judged by what is said: the run's own warnings must say so, the effect that the rung does hold must be within rtol of
the finest rung that has it ("held"), and the claim must be true ("rightly": each effect alone moves the affine network by more
than rtol, or has no steady network; "over-cautious": by less than half of it).

Where both effects pass rtol the plan takes `two-fluid`, the finest of both branches: its run is held against one of tolerance
1e-5 and eight times the places, and the claim that both are needed is judged as above.
"""

import argparse
import json
import time
import warnings
from collections import Counter
from pathlib import Path

import atlas_scenes
import numpy as np

TOLERANCES = (1e-1, 1e-2, 1e-3)


def scene_data(seed, index):
    """Scene number `index` without air, or None if its jet is not straight."""
    data = atlas_scenes.draw(seed, index)
    if data["jet"]["profile"] not in ("power-law", "hyperbolic"):
        return None
    network = {key: data["network"][key] for key in ("closure", "solvent_quality", "coupling")}
    return {
        "solution": data["solution"],
        "jet": data["jet"],
        "network": network,
        "effects": {"evaporation": False, "radial": False},
        "rheology": {"constitutive": data["rheology"]["constitutive"], "law": "constant"},
        "accuracy": {"points": 401},
    }


def timed(scene):
    """Result and processor time of a run, the best of two."""
    from spinline.solve import run

    spent = []
    for _ in range(2):
        began = time.process_time()
        result = run(scene)
        spent.append(time.process_time() - began)
    return result, min(spent)


def _held(model, holds):
    return [holds[model]] if model in holds else []


def _own(result, reference):
    """Error of a rung in what it does hold."""
    from spinline.study.difference import difference, largest

    return np.nan if isinstance(reference, str) else largest(difference(result, reference))


def _claim(shares):
    """Whether effects that are said to pass rtol do, from what each alone changes over rtol; NaN has no steady network."""
    least = min((share for share in shares if not np.isnan(share)), default=np.inf)
    return "rightly" if least > 1 else "within a factor of two" if least > 0.5 else "over-cautious"


def _both(scene, model, rtol, alone):
    """Of a rung that holds both effects: itself against its finer self, and whether both are needed."""
    from spinline.base.errors import InputError
    from spinline.study.difference import difference, largest
    from spinline.study.trade import variant

    try:
        fine, cost = timed(variant(scene, model, force_law="linear", rtol=1e-5, points=3201))
        taken, spent = timed(variant(scene, model, force_law="linear"))
    except InputError as error:
        return {"error": float("nan"), "kind": "refused", "words": str(error)[:80]}
    off = float(largest(difference(taken, fine)))
    return {
        "error": off,
        "kind": "met" if off <= rtol else "missed",
        "cost": min(spent / cost, 1.0) if off <= rtol else spent / cost,
        "claim": _claim([share / rtol for share in alone.values()]),
        "alone": {name: float(value) for name, value in alone.items()},
    }


def judge(seed, index, tolerances=TOLERANCES):
    """Outcomes of one scene: for every tolerance the rung, its error, whether it met, and its cost over the cheapest."""
    from spinline.base.errors import InputError
    from spinline.plan import plan_scene
    from spinline.scene import scene_from_dict
    from spinline.setup.build import build_jet, build_solution
    from spinline.solve import run
    from spinline.study.difference import difference, largest
    from spinline.study.trade import variant

    data = scene_data(seed, index)
    if data is None:
        return None
    try:
        scene = scene_from_dict(data)
        affine, cost = timed(variant(scene, "affine"))
    except InputError as error:
        return [{"kind": "refused", "words": f"{error.field}: {error.problem}"}]
    found = {"affine": (affine, cost)}
    for model, changes in (("manifold", {"force_law": "linear", "rtol": 1e-5}), ("conformation", {})):
        try:
            found[model] = timed(variant(scene, model, **changes))
        except InputError as error:
            found[model] = (str(error), np.nan)
    try:
        finest = {
            "elastic coupling": found["manifold"][0],
            "relaxation": timed(variant(scene, "conformation", points=3201))[0],
        }
    except InputError as error:
        finest = {"elastic coupling": found["manifold"][0], "relaxation": str(error)}
    holds = {"manifold": "elastic coupling", "conformation": "relaxation"}

    def error_of(model):
        """Of a rung, against its own branch; of the affine network, against both."""
        branches = [holds[model]] if model in holds else list(finest)
        others = [branch for branch in finest if branch not in branches]
        errors = []
        for branch, result in [(b, found[model][0]) for b in branches] + [(b, affine) for b in others]:
            if isinstance(finest[branch], str) or isinstance(result, str):
                return np.nan
            errors.append(largest(difference(result, finest[branch])))
        return max(errors)

    errors = {model: error_of(model) for model in found}
    alone = {
        branch: np.nan if isinstance(finest[branch], str) else largest(difference(affine, finest[branch]))
        for branch in finest
    }
    outcomes = []
    for rtol in tolerances:
        this = scene.model_copy(update={"accuracy": scene.accuracy.model_copy(update={"rtol": rtol})})
        solution = build_solution(this)
        plan = plan_scene(this, solution, build_jet(this, solution))
        model = plan.model
        if model not in errors:  # both effects at once
            outcomes.append({"rtol": rtol, "model": model, **_both(this, model, rtol, alone)})
            continue
        outcome = {"rtol": rtol, "model": model, "error": float(errors[model])}
        if isinstance(found[model][0], str):
            outcome |= {"kind": "refused", "words": found[model][0][:80]}
        elif plan.missed:
            result = run(this)
            outcome |= {
                "kind": "said not to hold",
                "left out": list(plan.missed),
                "told": all(remark in result.attrs["warnings"] for remark in plan.remarks) and bool(plan.remarks),
                "held": all(_own(found[model][0], finest[holds[model]]) <= rtol for model in [model] if model in holds),
                "claim": _claim([alone[name] / rtol for name in {*plan.missed, *_held(model, holds)}]),
                "alone": {name: float(value) for name, value in alone.items()},
            }
        elif np.isnan(errors[model]):
            outcome["kind"] = "no reference"
        else:
            good = [found[other][1] for other, error in errors.items() if error <= rtol]
            outcome |= {
                "kind": "met" if errors[model] <= rtol else "missed",
                "cost": found[model][1] / min(good) if good else 1.0,
            }
        outcomes.append(outcome)
    return outcomes


def recorded(seed, scenes, minutes, path):
    """Outcomes of the first straight scenes, judged until the time is up and written one scene a line."""
    from spinline.base.errors import SpinlineWarning

    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    rows = [json.loads(line) for line in lines]
    began = time.monotonic()
    while sum(row["outcomes"] is not None for row in rows) < scenes and time.monotonic() - began < 60 * minutes:
        before = time.process_time()
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            warnings.simplefilter("error", RuntimeWarning)
            outcomes = judge(seed, len(rows))
        row = {
            "index": len(rows),
            "outcomes": outcomes,
            "seconds": time.process_time() - before,
            "remarks": sum(issubclass(item.category, SpinlineWarning) for item in said),
            "others": [str(item.message) for item in said if not issubclass(item.category, SpinlineWarning)],
        }
        rows.append(row)
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
    return rows


def summary_of(seed, rows):
    """What the outcomes say together."""
    counts = {rtol: Counter() for rtol in TOLERANCES}
    costs = {rtol: [] for rtol in TOLERANCES}
    missed, doubted, refused = [], [], Counter()
    for row in rows:
        for outcome in row["outcomes"] or ():
            for rtol in [outcome["rtol"]] if "rtol" in outcome else TOLERANCES:
                counts[rtol][outcome["kind"]] += 1
                counts[rtol][f"took {outcome.get('model', 'nothing')}"] += 1
                if "cost" in outcome:
                    costs[rtol].append(outcome["cost"])
                for name in ("told", "held"):
                    counts[rtol][f"said: {name}"] += outcome.get(name) is True
                if "claim" in outcome:
                    counts[rtol][f"said: {outcome['claim']}"] += 1
                    doubtful = not (outcome.get("told", True) and outcome.get("held", True))
                    if outcome["claim"] == "over-cautious" or doubtful:
                        doubted.append({"index": row["index"], **outcome})
                if outcome["kind"] == "refused":
                    refused[outcome["words"].split(" =")[0].split(":")[0]] += 1
                if outcome["kind"] == "missed":
                    missed.append({"index": row["index"], **outcome})
    return {
        "seed": seed,
        "scenes": sum(row["outcomes"] is not None for row in rows),
        "drawn": len(rows),
        "seconds": round(sum(row["seconds"] for row in rows), 1),
        "rtol": {
            f"{rtol:g}": {
                **dict(sorted(counts[rtol].items())),
                "met of those judged": round(
                    counts[rtol]["met"] / max(counts[rtol]["met"] + counts[rtol]["missed"], 1), 4
                ),
                "within twice the cheapest": round(float(np.mean(np.array(costs[rtol]) <= 2)), 4)
                if costs[rtol]
                else None,
            }
            for rtol in TOLERANCES
        },
        "missed": missed,
        "said and doubted": doubted,
        "refused for": dict(refused),
        "remarks": sum(row["remarks"] for row in rows),
        "other warnings": dict(Counter(words for row in rows for words in row["others"])),
    }


def main():
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--records", type=Path, required=True, help="outcomes, one scene a line: added to")
    parser.add_argument("-o", "--out", type=Path)
    asked = parser.parse_args()
    rows = recorded(asked.seed, asked.scenes, asked.minutes, asked.records)
    summary = summary_of(asked.seed, rows)
    text = json.dumps(summary, indent=1)
    print(text)
    if asked.out:
        asked.out.write_text(text + "\n", encoding="utf-8")
    print("all are in" if summary["scenes"] >= asked.scenes else "run it again to go on")


if __name__ == "__main__":
    main()
