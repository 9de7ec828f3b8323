"""Stability atlas: scenes over the whole parameter box, each a result within physical bounds or a named refusal.

    python benchmarks/atlas.py --scenes 100000 --seed 1 -o benchmarks/atlas.json

A scene follows from (seed, index) alone. Each may take ten seconds; a hang, a crash, a NaN that no flag explains, a value
out of bounds or a warning of a library is a failure and is listed with its index. The summary holds counts and a map.
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

LIMIT = 10.0  # s
MODELS = ("auto", "affine", "manifold", "conformation", "chain", "walk")
SHARES = (0.40, 0.20, 0.14, 0.20, 0.01, 0.05)
AXES = {  # of the map: name, low, high (decades of the number)
    "volume_fraction": (-5, 0),
    "coupling": (-3, 15),
    "deborah": (-6, 12),
    "velocity_ratio": (0, 8),
}
BINS = 18


def draw(seed, index):
    """Scene number `index`, as a dictionary, and its place on the map."""
    rng = np.random.default_rng([seed, index])
    u = rng.uniform
    phi = float(rng.choice([10 ** u(-5, -0.5), u(0.3, 0.99), 10 ** u(-2, -0.7)]))
    radius, flow = 10 ** u(-9, -2), 10 ** u(-18, -5)
    beta = float(rng.choice([0.25, 0.5, 1.0, u(0.25, 1.0)]))
    k, stretch = 10 ** u(-2, 2), 10 ** u(0, 8)
    length = min((stretch / k**2) ** (0.5 / beta), 1e7) * radius
    length = min(max(length, 1.001 * radius), 900.0)
    profile = str(rng.choice(["power-law", "hyperbolic", "table", "lagrangian"], p=[0.7, 0.1, 0.1, 0.1]))
    jet = {"profile": profile, "radius": f"{radius!r} m"}
    if profile == "power-law":
        jet |= {"flow_rate": f"{flow!r} m^3/s", "k": k, "beta": beta, "length": f"{length!r} m"}
    elif profile == "hyperbolic":
        jet |= {"flow_rate": f"{flow!r} m^3/s", "p": 10 ** u(-2, 3), "length": f"{length!r} m"}
    else:
        n = int(rng.integers(2, 40))
        z = np.cumsum(10 ** u(-1, 1, n)) * radius
        v = np.cumprod(np.concatenate(([1.0], 10 ** u(0, np.log10(stretch) / n + 1e-3, n - 1))))
        jet["samples"] = (z - z[0] * (profile == "lagrangian"), v, flow / (np.pi * radius**2))
        if profile == "table":
            jet["flow_rate"] = f"{flow!r} m^3/s"
    relaxation = 10 ** u(-8, 8) * radius * np.pi * radius**2 / flow
    relaxation = float(min(max(relaxation, 1e-12), 1e11))
    coupling = 10 ** u(-3, 15)
    scene = {
        "solution": {
            "polymer": str(rng.choice(["PEO", "PVP", "PCL"])),
            "solvent": str(rng.choice(["water", "ethanol", "acetone"])),
            "volume_fraction": phi,
            "relaxation_time": f"{relaxation!r} s",
            "viscosity": f"{10 ** u(-3, 4)!r} Pa s",
            "kuhn_length": f"{10 ** u(-9.5, -8)!r} m",
        },
        "jet": jet,
        "ambient": {"relative_humidity": float(rng.choice([0.0, 1.0, u(0, 1)]))},
        "effects": {
            name: rng.choice(["auto", True, False], p=[0.6, 0.2, 0.2])
            for name in ("evaporation", "relaxation", "radial")
        },
        "network": {
            "model": str(rng.choice(MODELS, p=SHARES)),
            "closure": str(rng.choice(["force", "stretch"])),
            "solvent_quality": str(rng.choice(["theta", "good"])),
            "coupling": coupling,
            "inertia": float(rng.choice([0.0, 10 ** u(-12, 3)])),
        },
        "accuracy": {"rtol": 10 ** u(-3, -1), "points": int(rng.choice([2, 17, 101])), "strands": 100, "steps": 700},
    }
    scene["effects"] = {name: value if value == "auto" else value == "True" for name, value in scene["effects"].items()}
    scene["rheology"] = {
        "diffusivity": f"{10 ** u(-16, -7)!r} m^2/s",
        "constitutive": str(rng.choice(["auto", "UCM", "Oldroyd-B", "FENE-P"])),
    }
    if scene["network"]["model"] in ("manifold", "chain"):
        scene["network"]["force_law"] = str(rng.choice(["lattice", "linear", "langevin", "fene"]))
    deborah = relaxation * flow / (np.pi * radius**3)
    return scene, {"volume_fraction": phi, "coupling": coupling, "deborah": deborah, "velocity_ratio": stretch}


def build(scene, folder):
    """The scene checked, its table written where it has one."""
    from spinline.scene import scene_from_dict

    jet = dict(scene["jet"])
    if "samples" in jet:
        z, v, v0 = jet.pop("samples")
        path = Path(folder) / "jet.csv"
        if jet["profile"] == "table":
            rows = ["z [m],velocity [m/s]", *(f"{a!r},{b * v0!r}" for a, b in zip(z.tolist(), v.tolist(), strict=True))]
            del jet["radius"]
        else:
            radius = float(jet["radius"].split()[0])
            rows = ["x [m],y [m],z [m],radius [m],velocity [m/s]"]
            beads = enumerate(zip(z.tolist(), v.tolist(), strict=True))
            rows += [
                f"{a!r},{0.1 * a * float(np.sin(i))!r},0.0,{radius / float(np.sqrt(b))!r},{b * v0!r}"
                for i, (a, b) in beads
            ]
            fields = rows[-1].split(",")
            rows[-1] = ",".join([*fields[:3], "", fields[4]])
        path.write_text("\n".join(rows) + "\n", encoding="utf-8")
        jet["path"] = path.name
    return scene_from_dict({**scene, "jet": jet}, folder=Path(folder))


BOUNDS = {
    "radius": (0, 1), "velocity_ratio": (0, np.inf), "orientation": (-0.5, 1), "relative_extension": (0, 1 + 1e-9),
    "axial_stretch": (0, np.inf), "radial_contraction": (0, 1.5), "core_polymer_fraction": (0, 1),
    "core_polymer_fraction_eq40": (0, 1), "core_polymer_fraction_conservative": (0, 1), "mean_polymer_fraction": (0, 1),
    "network_radius": (0, 1), "network_velocity_ratio": (0, np.inf), "polymer_fraction": (0, 1 + 1e-9),
}  # fmt: skip
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


def judge(seed, index):
    """Outcome of one scene: kind, model, words, seconds."""
    from spinline.errors import InputError, SpinlineWarning
    from spinline.solve import run

    data, place = draw(seed, index)
    began = time.process_time()
    model = data["network"]["model"]
    signal.signal(signal.SIGPROF, _stop)
    signal.setitimer(signal.ITIMER_PROF, LIMIT)  # processor time: what else the machine does is no hang
    kind, words, said = "result", "", Counter()
    try:
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as remarks:
            warnings.simplefilter("error")
            warnings.simplefilter("always", SpinlineWarning)  # remarks on the scene, counted
            warnings.simplefilter("always", DeprecationWarning)  # of libraries, counted by their words
            result = run(build(data, folder))
        said = Counter(
            "remarks" if issubclass(item.category, SpinlineWarning) else str(item.message) for item in remarks
        )
        model = f"{model}: {result.attrs['model']}" if model == "auto" else model
        found = faults(result)
        if found:
            kind, words = "out of bounds", "; ".join(found)
    except InputError as error:
        kind, words = "refused", re.sub(r"\d[\d.e+-]*", "#", f"{error.field}: {error.problem}")
    except TooLongError:
        kind = "hang"
    except Warning as warning:
        kind, words = "warning", f"{type(warning).__name__}: {warning}"
    except Exception as error:
        kind, words = "crash", f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return index, kind, model, words, time.process_time() - began, place, said


def warm():
    """Compile what will be used, so that no scene is charged for it."""
    from spinline.errors import SpinlineWarning
    from spinline.scene import load_scene
    from spinline.solve import run

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)  # of scenes made to compile, not to be read
        for model in MODELS[1:]:
            extra = ['network.closure="stretch"'] if model in ("manifold", "conformation") else []
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
    low, high = AXES[name]
    return int(np.clip((np.log10(value) - low) / (high - low) * BINS, 0, BINS - 1))


def replay(path):
    """Judge the failures of a summary again, and write what they are now into it."""
    summary = json.loads(path.read_text(encoding="utf-8"))
    warm()
    again = [judge(summary["seed"], item["index"]) for item in summary["failures"]]
    summary["failed_at_first"] = summary["failed"]
    summary["replayed"] = [
        {"index": index, "kind": kind, "model": model, "words": words[:200], "seconds": round(seconds, 2)}
        for index, kind, model, words, seconds, *_ in again
    ]
    summary["failed"] = sum(outcome[1] not in ("result", "refused") for outcome in again)
    path.write_text(json.dumps(summary) + "\n", encoding="utf-8")
    print(json.dumps(dict(Counter(outcome[1] for outcome in again))))


def main():
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=multiprocessing.cpu_count())
    parser.add_argument("-o", "--out", type=Path)
    parser.add_argument("--replay", type=Path, help="judge the failures of this summary again")
    asked = parser.parse_args()
    if asked.replay:
        replay(asked.replay)
        return
    outcomes, reasons, warned, bad, slowest = Counter(), Counter(), Counter(), [], (0.0, -1)
    maps = {
        pair: np.zeros((BINS, BINS, 2), int)
        for pair in (("volume_fraction", "velocity_ratio"), ("coupling", "deborah"))
    }
    tasks = ((asked.seed, i) for i in range(asked.first, asked.first + asked.scenes))
    began = time.perf_counter()
    context = multiprocessing.get_context("spawn")
    with context.Pool(asked.workers, warm) as pool:
        for done, (index, kind, model, words, seconds, place, said) in enumerate(
            pool.imap_unordered(_judge, tasks, chunksize=50), 1
        ):
            outcomes[f"{model} / {kind}"] += 1
            if kind == "refused":
                reasons[words] += 1
            elif kind != "result":
                bad.append({"index": index, "kind": kind, "model": model, "words": words[:300]})
            slowest = max(slowest, (seconds, index))
            warned += said
            for pair, counts in maps.items():
                x, y = (_bin(name, place[name]) for name in pair)
                counts[x, y] += (1, kind == "result")
            if done % 2000 == 0:
                print(f"{done} scenes, {len(bad)} failures, {time.perf_counter() - began:.0f} s", flush=True)
    summary = {
        "seed": asked.seed, "first": asked.first, "scenes": asked.scenes, "seconds": round(time.perf_counter() - began, 1),
        "slowest": {"seconds": round(slowest[0], 2), "index": slowest[1]},
        "outcomes": dict(sorted(outcomes.items())), "refusals": dict(reasons.most_common(60)), "warned": dict(warned),
        "failures": sorted(bad, key=lambda item: item["index"])[:500], "failed": len(bad), "axes": AXES, "bins": BINS,
        "maps": {" ".join(pair): counts.tolist() for pair, counts in maps.items()},
    }  # fmt: skip
    text = json.dumps(summary)
    if asked.out:
        asked.out.write_text(text + "\n", encoding="utf-8")
    print(json.dumps({key: summary[key] for key in ("seconds", "slowest", "outcomes", "failed")}, indent=1))
    for item in bad[:20]:
        print(item)


if __name__ == "__main__":
    main()
