"""The plan's estimates against the truth: each effect switched on and off, one at a time, on random scenes.

    python benchmarks/estimates.py --scenes 100 --seed 3

Scenes are the straight ones of the atlas (`atlas_scenes.draw`). Printed, for every effect: how many of its errors lie between
1e-4 and 1, which both rungs can tell, and the ratio of the estimate to what leaving the effect out changes
(`spinline.study.difference`; evaporation and cooling: and of the mean fraction; radial gradients: surface against
mean). Errors that pass 1 are "no answer" by either, and agree if both say so.
"""

import argparse
import json
import warnings
from pathlib import Path

import atlas_scenes
import numpy as np

EFFECTS = (
    "elastic coupling",
    "inertia",
    "relaxation",
    "evaporation",
    "evaporative cooling",
    "radial gradients",
    "finite extensibility",
)
SMALL, LARGE = 1e-4, 1.0


def scene_data(seed, index):
    """Scene number `index` with everything left to be switched, or None if its jet is not straight."""
    data = atlas_scenes.draw(seed, index)
    if data["jet"]["profile"] not in ("power-law", "hyperbolic"):
        return None
    data["network"] = {key: data["network"][key] for key in ("solvent_quality", "coupling", "inertia")}
    data["effects"] = {"evaporation": False, "radial": False, "relaxation": False}
    data["ambient"] = {"relative_humidity": float(np.random.default_rng([seed, index, 1]).uniform(0, 0.9))}
    data["rheology"] |= {"constitutive": "auto", "law": "constant"}
    data["accuracy"] = {"points": 401}
    return data


def _pairs(data):
    """Network, effects and accuracy with and without each effect."""
    inertia = data["network"]["inertia"]
    linear = {"model": "manifold", "force_law": "linear", "closure": "force"}
    dry = {"evaporation": True}
    yield "elastic coupling", ({**linear, "inertia": 0.0}, {}), ({"model": "affine"}, {})
    if inertia:
        yield "inertia", (linear, {}), ({**linear, "inertia": 0.0}, {})
    yield "relaxation", ({"model": "conformation"}, {"relaxation": "auto"}), ({"model": "affine"}, {})
    yield "evaporation", ({"model": "affine"}, dry), ({"model": "affine"}, {})
    warm = {**dry, "heat": False}
    yield "evaporative cooling", ({"model": "affine"}, {**dry, "heat": True}), ({"model": "affine"}, warm)
    yield "radial gradients", ({"model": "affine"}, {**dry, "radial": True}), ({"model": "affine"}, dry)
    law = {"model": "manifold", "closure": "stretch"}
    yield "finite extensibility", ({**law, "force_law": "lattice"}, {}), ({**law, "force_law": "linear"}, {})


def true_error(name, data, on, off):
    """What leaving one effect out changes; NaN and why where a run is refused."""
    from spinline.base.errors import InputError
    from spinline.scene import scene_from_dict
    from spinline.solve import run
    from spinline.study.difference import difference, largest

    results = []
    for network, effects in (on, off):
        changed = {**data, "network": {**data["network"], **network}, "effects": {**data["effects"], **effects}}
        try:
            results.append(run(scene_from_dict(changed)))
        except InputError as error:
            return float("nan"), f"{error.field}: {error.problem}"[:60]
    with_it, without = results
    if name == "radial gradients":
        mean, surface = (with_it[key].values for key in ("mean_polymer_fraction", "surface_polymer_fraction"))
        return float(np.nanmax(np.abs(surface / mean - 1))), ""
    errors = difference(without, with_it)
    if name == "evaporation":  # the mean fraction too, over the whole jet
        lost = with_it["evaporated_fraction"].values
        errors["mean"] = float(np.nanmax(np.abs(lost / (1 - lost))))
    if name == "evaporative cooling":  # the dryness that is reported
        one, other = (r["mean_polymer_fraction"].values for r in results)
        errors["mean"] = float(np.nanmax(np.abs(other / one - 1)))
    return largest(errors), ""


def judge(seed, index):
    """For every effect of a scene: number, estimate, truth."""
    from spinline.plan import plan_scene
    from spinline.scene import scene_from_dict
    from spinline.setup.build import build_jet, build_solution

    data = scene_data(seed, index)
    if data is None:
        return None
    found = {}
    for name, on, off in _pairs(data):
        network = {**data["network"], **{key: off[0][key] for key in ("closure", "force_law") if key in off[0]}}
        effects = {**data["effects"], **on[1]}
        scene = scene_from_dict({**data, "network": network, "effects": effects})
        solution = build_solution(scene)
        effect = plan_scene(scene, solution, build_jet(scene, solution)).effect(name)
        truth, why = true_error(name, data, on, off)
        found[name] = {"number": effect.number, "estimate": effect.error, "truth": truth, "why": why}
    return found


def agreement(pairs):
    """Counts and quantiles of estimate over truth, of pairs (estimate, truth) that are known."""
    both = np.array(pairs, dtype=float).reshape(-1, 2)
    estimate, truth = np.clip(both, 1e-12, LARGE).T
    told = (truth > SMALL) | (estimate > SMALL)
    ratio = np.maximum(estimate, SMALL)[told] / np.maximum(truth, SMALL)[told]
    middle = (truth[told] > SMALL) & (truth[told] < LARGE)
    return {
        "known": len(both),
        "told": int(told.sum()),
        "between": int(middle.sum()),
        "quantiles of the ratio": {f"{q:g}": round(float(np.quantile(ratio, q)), 3) for q in (0, 0.05, 0.5, 0.95, 1)}
        if ratio.size
        else {},
        "below a tenth": int((ratio < 0.1).sum()),
        "above ten": int((ratio > 10).sum()),
    }


def main():
    """Run the comparison."""
    from spinline.base.errors import SpinlineWarning

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("-o", "--out", type=Path)
    parser.add_argument("--list", action="store_true", help="print the scenes that disagree")
    asked = parser.parse_args()
    pairs, refused, index, done = {name: [] for name in EFFECTS}, dict.fromkeys(EFFECTS, 0), 0, 0
    while done < asked.scenes:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)  # what a rung loses is what is measured
            found = judge(asked.seed, index)
        index += 1
        if found is None:
            continue
        done += 1
        for name, one in found.items():
            if np.isnan(one["truth"]) or np.isnan(one["estimate"]):
                refused[name] += 1
                continue
            pairs[name].append((one["estimate"], one["truth"]))
            ratio = np.clip(one["estimate"], SMALL, LARGE) / np.clip(one["truth"], SMALL, LARGE)
            if asked.list and not 0.3 < ratio < 3:
                print(index - 1, name, {k: v for k, v in one.items() if k != "why"}, flush=True)
    summary = {name: {**agreement(both), "refused": refused[name]} for name, both in pairs.items()}
    text = json.dumps({"seed": asked.seed, "scenes": done, "effects": summary}, indent=1)
    if asked.out:
        asked.out.write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
