"""The bending blown jet against its step and its mesh: median flight radius, envelope, path, balance.

The reference case: 1 mL/h, 200 m/s of air from a 1 mm nozzle, start 1 mm down at 10 um with A_zz = 120, theta 5 ms, G 600 Pa,
solvent 10 mPa s, plate at 30 mm. The first third of each run is left out. Kept in ``blown_beads.json``. One run scatters as
much as its mesh matters; `--mesh` therefore compares means over the same four seeds at 0.4, 0.2 and 0.1 mm, goes on where it
stopped, and keeps ``blown_mesh.json``.

    python benchmarks/blown_beads.py [--duration 0.06] [--json FILE]
    python benchmarks/blown_beads.py --mesh
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

import spinline.deposit as dep
import spinline.jetprofile.blown as blown

SOLUTION = blown.BlownSolution(1e-6 / 3600, 100e-6, 970.0, 3.01, 0.036, relaxation_time=5e-3, solvent_viscosity=0.01)


def in_the_air(out, since, low, high):
    """Radius of all that flies between two heights, from its volume and length, over the stored moments."""
    volume = length = 0.0
    for state in out.states:
        if state.time < since:
            continue
        place = state.beads[:, :3]
        middle = 0.5 * (place[1:, 0] + place[:-1, 0])
        here = (middle > low) & (middle < high) & ~(state.landed[1:] | state.landed[:-1])
        volume += state.elements[here, 0].sum()
        length += np.linalg.norm(np.diff(place, axis=0), axis=1)[here].sum()
    return float(np.sqrt(volume / (np.pi * length)))


def run(element, cfl, seed, duration, intensity=0.2):
    start = time.process_time()
    out = blown.blown_beads(
        SOLUTION,
        blown.AirJet(1e-3, 200.0, intensity=intensity),
        blown.BeadStart(1e-3, 10e-6, 120.0),
        dep.Plate(0.03),
        blown.BlownBeads(element=element, duration=duration, cfl=cfl, seed=seed),
        frames=300,
    )
    rows = out.landings[(out.landings[:, 7] > 0) & (out.landings[:, 0] > duration / 3)]
    radius = np.sqrt(rows[:, 7] / (np.pi * rows[:, 8])) * 1e6
    rng = np.random.default_rng(1)
    blocks = np.array_split(radius, 12)
    drawn = [np.median(np.concatenate([blocks[k] for k in rng.integers(0, 12, 12)])) for _ in range(400)]
    segments = dep.lay(dep.LandingRecord.from_dataset(out.to_dataset()), dep.Plate(0.03))
    spread = np.sqrt(np.diag(dep.footprint_of(segments).covariance)) * 1e3
    return {
        "element_mm": element * 1e3,
        "cfl": cfl,
        "seed": seed,
        "intensity": intensity,
        "duration_ms": duration * 1e3,
        "landed": int(radius.size),
        "median_radius_um": float(np.median(radius)),
        "median_error_um": float(np.std(drawn)),
        "mean_radius_um": float(np.sqrt(rows[:, 7].sum() / (np.pi * rows[:, 8].sum())) * 1e6),
        "air_radius_um": in_the_air(out, duration / 3, 0.024, 0.028) * 1e6,
        "off_plate_mm": float(np.abs(rows[:, 1] - 0.03).max() * 1e3),
        "radius_5_95_um": np.quantile(radius, [0.05, 0.95]).tolist(),
        "balance": out.imbalance(),
        "below_zero_share": out.below_zero,
        "envelope_10mm_mm": out.envelope(0.01, duration / 3) * 1e3,
        "envelope_28mm_mm": out.envelope(0.028, duration / 3) * 1e3,
        "footprint_sd_mm": spread.tolist(),
        "impact_m_s": float(np.median(np.linalg.norm(rows[:, 4:7], axis=1))),
        "cpu_s": time.process_time() - start,
    }


def mesh(path):
    """Means over four seeds at three meshes, and their standard errors."""
    rows = json.loads(path.read_text())["runs"] if path.exists() else []
    done = {(row["element_mm"], row["seed"]) for row in rows}
    for element in (4e-4, 2e-4, 1e-4):
        for seed in (1, 2, 3, 4):
            if (element * 1e3, seed) not in done:
                rows.append(run(element, 0.4, seed, 0.06))
            means = []
            for size in sorted({row["element_mm"] for row in rows}, reverse=True):
                one = {"element_mm": size}
                for name in ("median_radius_um", "mean_radius_um", "air_radius_um"):
                    found = np.array([row[name] for row in rows if row["element_mm"] == size])
                    error = float(found.std(ddof=1) / np.sqrt(found.size)) if found.size > 1 else None
                    one |= {name: float(found.mean()), name.replace("radius", "error"): error}
                means.append(one)
            path.write_text(json.dumps({"means": means, "runs": rows}, indent=1) + "\n")
        print(means, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", action="store_true")
    parser.add_argument("--duration", type=float, default=0.06)
    parser.add_argument("--json", type=Path, default=Path(__file__).with_suffix(".json"))
    arguments = parser.parse_args()
    if arguments.mesh:
        mesh(arguments.json.with_name("blown_mesh.json"))
        return
    rows = []
    for element, cfl, seed, intensity in (
        (2e-4, 0.4, 1, 0.2),
        (2e-4, 0.2, 1, 0.2),
        (1e-4, 0.4, 1, 0.2),
        (2e-4, 0.4, 2, 0.2),
        (2e-4, 0.4, 1, 0.1),
    ):
        rows.append(run(element, cfl, seed, arguments.duration, intensity))
        print(rows[-1], flush=True)
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
