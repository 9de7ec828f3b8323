"""A row and a map today, with tail and lean in the model and without, against an older copy of the code, in one run.

    git worktree add --detach OLD 22c3ee8
    PYTHONPATH=src python benchmarks/bench_xray_before.py OLD

22c3ee8 is the last state of the code before tails, leans and tilts. Each tree is imported by a process of its own; the jobs of
both are run in turn, 300 rows of 220 pixels, and timed by processor time: what is said is the ratio of the least times. Result
in `xray_before.json`.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
OUT = HERE / "xray_before.json"
ROWS, PIXELS, PIXEL, PHOTONS = 300, 220, 0.67e-6, 1e6
TURNS = 7

WORKER = """
import json, sys, time
from dataclasses import replace
import numpy as np
from spinline import xray
data = np.load(sys.argv[1])
counts, glary, pixel, photons = data["counts"], data["glary"], float(data["pixel"]), float(data["photons"])
water = xray.Absorber(520.9, -136.9)
flat, zero, good = np.full(counts.shape, photons), np.zeros(counts.shape), np.ones(counts.shape, dtype=bool)
plain = xray.Frame(counts, flat, zero, good, pixel, blur=0.5 * pixel)
row = lambda seen, **more: xray.fit_frame(seen, water, shells=3, **more)
one = xray.Detector(flat[0], pixel, blur=0.5 * pixel)
jobs = {"row": lambda: row(plain), "map": lambda: xray.fit_map(counts, water, one)}
if hasattr(xray, "axis_lean"):
    tailed = replace(plain, counts=glary, tail_share=0.02, tail_length=10 * pixel)
    path = xray.track_jet(glary, flat, zero, good)
    slope = xray.axis_lean(path).slope
    two = replace(one, tail_share=0.02, tail_length=10 * pixel)
    jobs["row with tail, lean"] = lambda: row(tailed, lean=slope)
    jobs["map with tail, lean"] = lambda: xray.fit_map(glary, water, two, path=1 / np.hypot(1, slope))
for line in sys.stdin:
    job = jobs[line.strip()]
    start = time.process_time()
    fit = job()
    took = time.process_time() - start
    mean = fit.mean if hasattr(fit, "mean") else fit.mean_fraction
    print(json.dumps([took, float(np.mean(mean)), getattr(fit, "iterations", 0)]), flush=True)
"""


class Tree:
    """A process that runs jobs of one copy of the code."""

    def __init__(self, folder: Path, data: Path) -> None:
        alone = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "NUMBA")}
        environment = os.environ | alone | {"PYTHONPATH": str(folder / "src")}
        self.process = subprocess.Popen(
            [sys.executable, "-W", "ignore", "-c", WORKER, str(data)],
            env=environment,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, job: str) -> tuple[float, float, int]:
        """Processor seconds of a job, the mean fraction it found, and the turns that a map took."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(job + "\n")
        self.process.stdin.flush()
        took, mean, turns = json.loads(self.process.stdout.readline())
        return took, mean, turns


def main() -> None:
    """Time both trees in turn."""
    sys.path.insert(0, str(HERE.parent / "tests"))
    from beam_generator import Lab, transmissions

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("old", type=Path)
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("TMPDIR", "/tmp")) / "xray_before.npz")
    asked = parser.parse_args()
    radii = np.linspace(50e-6, 40e-6, ROWS)
    labs = Lab(blur=0.5 * PIXEL), Lab(blur=0.5 * PIXEL, tail=(0.02, 10 * PIXEL))
    seen = [transmissions(radii, PIXELS, lab, over=4, pad=200) for lab in labs]
    counts, glary = (np.random.default_rng(0).poisson(PHOTONS * s).astype(float) for s in seen)
    np.savez(asked.data, counts=counts, glary=glary, pixel=PIXEL, photons=PHOTONS)
    trees = {"before": Tree(asked.old.resolve(), asked.data), "now": Tree(HERE.parent.resolve(), asked.data)}
    jobs = [("before", "row"), ("now", "row"), ("now", "row with tail, lean")]
    jobs += [(tree, job.replace("row", "map")) for tree, job in jobs]
    took: dict[str, list[float]] = {}
    means: dict[str, float] = {}
    turns_of: dict[str, int] = {}
    for turn in range(TURNS + 1):
        for tree, job in jobs:
            name = f"{tree}: {job}"
            seconds, means[name], turns_of[name] = trees[tree].run(job)
            if turn:  # the first one compiles
                took.setdefault(name, []).append(seconds)
    best = {name: min(times) for name, times in took.items()}
    result = {
        "rows": ROWS,
        "pixels": PIXELS,
        "ms_a_row": {name: 1e3 * value / ROWS for name, value in best.items()},
        "mean_fraction": means,
        "turns": {name: turns for name, turns in turns_of.items() if turns},
        "over_before": {
            name: value / best["before: row" if "row" in name else "before: map"]
            for name, value in best.items()
            if name.startswith("now")
        },
    }
    OUT.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(result, indent=1))
    for tree in trees.values():
        tree.process.kill()


if __name__ == "__main__":
    main()
