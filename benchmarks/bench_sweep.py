"""Sweeps: a million affine scenes in memory and into a store, scenes one by one, the Sobol' indices; the default "auto".

Run: ``python benchmarks/bench_sweep.py [rows of the one-by-one part]``. Wall and processor time of the best of three; memory
is the peak of the process. The first part takes under a minute.

``python benchmarks/bench_sweep.py auto [scenes [rows to compare]]`` sweeps 100,000 scenes with ``model = "auto"`` and runs
1,000 of them by themselves, of every way of computing; writes ``bench_sweep.json``.
"""

import json
import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from spinline.study.rows import WAYS, Task, evaluate_rows
from spinline.study.sensitivity import sobol
from spinline.study.sweep import run_sweep, sweep_from_dict

VARY = {
    "jet.k": {"loguniform": [0.2, 3.0]},
    "jet.beta": {"uniform": [0.3, 0.9]},
    "jet.radius": {"loguniform": ["20 um", "500 um"]},
    "network.coupling": {"loguniform": [1e3, 1e7]},
    "solution.mass_fraction": {"uniform": ["1 wt%", "20 wt%"]},
}


def sweep(samples: int, kind: str = "latin-hypercube", **network: str):
    """A sweep of `samples` scenes."""
    overrides = [f"network.{key}={value}" for key, value in network.items()]
    return sweep_from_dict(
        {"scene": "peo5-water", "design": {"kind": kind, "samples": samples}, "vary": VARY}, overrides
    )


def best(function, repeats: int = 3):
    """Result, shortest wall and processor time, s."""
    wall = cpu = float("inf")
    for _ in range(repeats):
        start, used = time.perf_counter(), time.process_time()
        result = function()
        wall, cpu = min(wall, time.perf_counter() - start), min(cpu, time.process_time() - used)
    return result, wall, cpu


def peak() -> float:
    """Peak memory of this process, GB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def auto(scenes: int, compared: int) -> dict[str, object]:
    """The default sweep: cost of a scene, how rows were computed, and how far they are from single runs."""
    task = sweep(scenes)
    run_sweep(sweep(100))  # compiled code
    before = time.process_time()
    result = run_sweep(task, workers=1)
    cost = 1e6 * (time.process_time() - before) / scenes
    way = result["computed_by"].values
    ways = {WAYS[code]: int((way == code).sum()) for code in WAYS}
    print(f"{scenes} scenes by themselves choosing their rung: {cost:.1f} us a scene; {ways}")
    each = [np.flatnonzero(way == code) for code in WAYS]
    rows = np.concatenate([found[:: max(1, len(found) * len(WAYS) // compared)] for found in each])
    columns = task.design.rows(0, scenes)
    single = Task(base=task.base, folder=str(task.folder))
    before = time.process_time()
    block = evaluate_rows(single, {key: column[rows] for key, column in columns.items()})
    alone = 1e6 * (time.process_time() - before) / len(rows)
    worst = 0.0
    for name, column in block.numbers.items():
        here = result[name].values[rows]
        equal = (here == column) | (np.isnan(here) & np.isnan(column))
        apart = np.abs(here[~equal] / column[~equal] - 1)
        worst = max(worst, float(np.nan_to_num(apart, nan=np.inf).max(initial=0.0)))
    same = bool((block.status == result["status"].values[rows]).all())
    print(f"{len(rows)} of them run by themselves ({alone:.0f} us each): apart by {worst:.1e}, status the same: {same}")
    return {
        "scenes": scenes,
        "us_a_scene": round(cost, 2),
        "ways": ways,
        "compared": len(rows),
        "us_alone": round(alone, 1),
        "largest_relative_difference": worst,
        "same_status": same,
    }


def main() -> None:
    if sys.argv[1:2] == ["auto"]:
        numbers = [int(word) for word in sys.argv[2:]]
        found = auto(*(numbers + [100_000, 1000][len(numbers) :]))
        place = Path(__file__).with_suffix(".json")
        place.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        return
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    million = 1_000_000
    _, wall, cpu = best(lambda: run_sweep(sweep(million, model="affine")))
    print(f"{million} affine scenes in memory: {wall:.1f} s wall, {cpu:.1f} s processor, peak {peak():.2f} GB")
    with tempfile.TemporaryDirectory() as scratch:
        store = Path(scratch) / "s.zarr"
        _, wall, cpu = best(lambda: run_sweep(sweep(million, model="affine"), store, force=True))
        size = sum(file.stat().st_size for file in store.rglob("*") if file.is_file()) / 1e6
    print(f"the same into a store of {size:.0f} MB: {wall:.1f} s wall, {cpu:.1f} s processor, peak {peak():.2f} GB")
    design = {"kind": "sensitivity", "samples": 4096}
    overrides = ["jet.length=100 m", "network.model=affine"]
    many = sweep_from_dict({"scene": "peo5-water", "design": design, "vary": VARY}, overrides)
    result, _, cpu = best(lambda: run_sweep(many))
    _, _, used = best(lambda: sobol(result, ["crossover_radius", "crossover_position"]), 1)
    print(f"{result.sizes['scene']} scenes for indices: {cpu:.2f} s; indices and intervals: {used:.1f} s processor")
    for model, count in (("affine", 5 * rows), ("manifold", rows // 5)):
        task = sweep(count, model=model)
        _, wall, cpu = best(lambda t=task: run_sweep(t, workers=1, vectorise=False), 1)
        print(f"{model}, one by one: {1e3 * wall / count:.2f} ms wall, {1e3 * cpu / count:.2f} ms processor a scene")
        _, wall, _ = best(lambda t=task: run_sweep(t, workers=2, vectorise=False), 1)
        print(f"{model}, in two processes: {1e3 * wall / count:.2f} ms wall a scene (starting them included)")


if __name__ == "__main__":
    main()
