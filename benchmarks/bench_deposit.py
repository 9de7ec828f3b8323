"""Mats at scale, and what their laws are worth.

Four parts, each kept in ``bench_deposit.json``:

scale       1e6 and 1e7 segments laid, written, read and analysed on one core: CPU seconds, peak memory, exponent of the cost
beds        Stokes flow through random overlapping beds (24 radii wide, three seeds, 2, 3, 4 voxels a radius) against the laws
drum        porosity by every envelope, order parameter and thickness against the speed of the collector, at the same time
pixel       mean height and solidity against the pixel of the stack, with the observed order

    python benchmarks/bench_deposit.py [scale] [beds] [drum] [pixel] [--json FILE]
"""

import argparse
import json
import resource
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import spinline.deposit as dep
from spinline.base.errors import SpinlineWarning
from spinline.deposit.stokes import GROWN


def lay(path, segments, jets=20, speed=0.0):
    law = dep.Laydown(
        speed=4.4, covariance=(2e-3) ** 2, noise=20.0, radius=1e-6, radius_spread=0.25, radius_length=1e-3
    )
    per_jet = segments // jets
    with dep.FibreWriter(path) as file:
        for k in range(jets):
            for block in dep.surrogate_fibre(
                law, per_jet * 1e-4, step=1e-4, machine_speed=speed, centre=(0.0, 2e-3 * k), jet=k
            ):
                file.write(block)


def scale():
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "f.h5"
        lay(path, 400_000)  # compile
        with dep.FibreFile(path) as file:
            dep.analyse_mat(file, dep.MatOptions(realisations=2))
        for n in (1_000_000, 10_000_000):
            start, wall = time.process_time(), time.perf_counter()
            lay(path, n)
            laid = time.process_time() - start
            with dep.FibreFile(path) as file:
                result = dep.analyse_mat(file, dep.MatOptions(realisations=2))
            total = time.process_time() - start
            rows.append(
                {
                    "segments": n,
                    "cpu_lay_s": laid,
                    "cpu_total_s": total,
                    "wall_s": time.perf_counter() - wall,
                    "peak_memory_GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
                    "file_MB": path.stat().st_size / 1e6,
                    "porosity": float(result.porosity),
                }
            )
            print(rows[-1], flush=True)
    exponent = np.log(rows[-1]["cpu_total_s"] / rows[0]["cpu_total_s"]) / np.log(10)
    return {"rows": rows, "exponent": float(exponent)}


SIDE = 24.0  # of a bed, in radii
GRIDS = (2, 3, 4)  # voxels a radius


def bed(solidity, seed, layered):
    """Axes of overlapping fibres in radii: ends, as many as their mean needs."""
    rng = np.random.default_rng([seed, layered])
    count = round(-np.log1p(-solidity) / np.pi * SIDE**2)
    angle = rng.uniform(0, np.pi, count)
    along = (
        np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], -1) if layered else rng.standard_normal((count, 3))
    )
    along /= np.linalg.norm(along, axis=1)[:, None]
    middle = rng.uniform(0, SIDE, (count, 3))
    return middle - SIDE / 2 * along, middle + SIDE / 2 * along


def solidity_of(ends):
    return float(dep.stamp(ends[0] * 4, ends[1] * 4, 4.0, (round(SIDE * 4),) * 3, (True, True, True)).mean())


def flow_through(ends, voxels, grown):
    box = dep.stamp(ends[0] * voxels, ends[1] * voxels, voxels + grown, (round(SIDE * voxels),) * 3, (True, True, True))
    return dep.stokes_permeability(box, 2, tolerance=1e-3).permeability / voxels**2


def beds():
    out = []
    for layered in (True, False):
        for solidity in (0.05, 0.1, 0.2):
            seeds = [bed(solidity, seed, layered) for seed in range(3)]
            phi = float(np.mean([solidity_of(ends) for ends in seeds]))
            grown = [
                [flow_through(ends, n, GROWN) for n in GRIDS[: 3 if k == 0 else 2]] for k, ends in enumerate(seeds)
            ]
            ratio = np.array([row[1] for row in grown])  # at 3 voxels
            laws = {}
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", SpinlineWarning)
                for law in dep.LAWS:
                    laws[law] = float(dep.permeability_of(law, phi, 1.0))
            row = {
                "bed": "layered, through" if layered else "random",
                "solidity": phi,
                "k_over_a2": float(ratio.mean()),
                "lowest": float(ratio.min()),
                "highest": float(ratio.max()),
                "grids": list(GRIDS),
                "first_bed_by_grid": grown[0],
                "first_bed_as_stamped": [flow_through(seeds[0], n, 0.0) for n in GRIDS[:2]],
                "laws": laws,
            }
            inside = [value for value in laws.values() if np.isfinite(value)]
            row["within_the_laws"] = bool(min(inside) <= ratio.mean() <= max(inside))
            out.append(row)
            print({key: value for key, value in row.items() if key != "laws"}, flush=True)
    return out


def drum():
    out = []
    for speed in (0.0, 2.0, 8.0, 30.0):
        law = dep.Laydown(speed=4.4, covariance=(1e-4) ** 2, noise=60.0, radius=1e-6)
        turn = 4e-4
        s = dep.Segments.join(list(dep.surrogate_fibre(law, 0.4, step=5e-6, machine_speed=speed, seed=1)))
        rolled = dep.Segments.join(list(_rolled(s, turn))) if speed else s
        window = dep.Window(8e-5, 8e-5, 1.6e-4 if speed else -4e-5, -4e-5)
        laid = dep.lay_stack(rolled, window, slope=0.3)
        row = {
            "collector_speed": speed,
            "order_parameter": dep.order_of(s.angle, s.chord).order_parameter,
            "coverage": laid.coverage,
            "thickness_m": laid.mean_thickness,
            "porosity": {e: laid.porosity(e) for e in ("mean-top", "max-top", "percentile")},
            "slope": 0.3,
        }
        out.append(row)
        print(row, flush=True)
    return out


def _rolled(s, turn):
    from spinline.deposit.whole import Rolled

    return Rolled(s, turn).chunks()


def pixel():
    rng = np.random.default_rng(1)
    theta, middle = rng.uniform(0, np.pi, 2000), rng.uniform(0, 200, (2000, 2))
    half = 100 * np.stack([np.cos(theta), np.sin(theta)], -1)
    s = dep.Segments.from_paths(list(np.stack([middle - half, middle + half], 1)), 1.0)
    out = []
    for slope in (0.1, 1.0):
        found = [
            dep.lay_stack(s, dep.Window(200, 200, periodic=True), pixel=p, slope=slope) for p in (1.0, 0.5, 0.25, 0.125)
        ]
        height = [one.mean_thickness for one in found]
        steps = np.abs(np.diff(height))
        row = {"slope": slope, "pixel_over_radius": [1.0, 0.5, 0.25, 0.125], "mean_height": height}
        orders = np.log2(steps[:-1] / steps[1:]).tolist()
        out.append(row | {"solidity": [one.solidity() for one in found], "orders": orders})
        print(out[-1], flush=True)
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", default=["scale", "beds", "drum", "pixel"])
    parser.add_argument("--json", type=Path, default=Path(__file__).with_suffix(".json"))
    arguments = parser.parse_args()
    kept = json.loads(arguments.json.read_text()) if arguments.json.exists() else {}
    for part in arguments.parts:
        kept[part] = {"scale": scale, "beds": beds, "drum": drum, "pixel": pixel}[part]()
        arguments.json.write_text(json.dumps(kept, indent=1) + "\n")


if __name__ == "__main__":
    main()
