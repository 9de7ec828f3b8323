"""Sweeps: a million affine scenes in memory and into a store, scenes one by one, the Sobol' indices.

Run: ``python benchmarks/bench_sweep.py [rows of the one-by-one part]``. Wall and processor time of the best of three; memory
is the peak of the process. The first part takes under a minute.
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

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


def main() -> None:
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
