"""Whether reported numbers jump where "auto" changes the rung: sweeps of the jet, the coupling and the relaxation time.

    python benchmarks/continuity.py [steps]

Each sweep takes a scene through every change of rung that "auto" makes on the way, in equal steps of the logarithm. What a
number changes from one step to the next is held against what it changes on both sides: a jump is the excess over the
larger neighbour, relative to the number, over rtol. Writes continuity.json.
"""

import json
import sys
import warnings
from pathlib import Path

import numpy as np

import spinline as sl

NUMBERS = (
    "crossover_position",
    "crossover_extension_position",
    "end_axial_stretch",
    "end_relative_extension",
    "end_orientation",
    "end_core_polymer_fraction",
    "end_network_radius",
    "fibre_radius",
)
AT_END = (
    "network_velocity_ratio",
    "strand_stretch",
    "flux_velocity_ratio",
    "core_polymer_fraction_conservative",
    "network_radius_conservative",
)
SWEEPS = {  # key, low, high, unit, further settings
    "k (the field)": ("jet.k", 0.3, 1.1, "", ["solution.relaxation_time=60 ms", "network.coupling=800"]),
    "concentration": (
        "solution.mass_fraction",
        0.03,
        0.09,
        "",
        ["solution.relaxation_time=60 ms", "network.coupling=800"],
    ),
    "relaxation time": ("solution.relaxation_time", 1e-3, 30.0, " s", ["jet.length=3 mm"]),
    "relaxation time, soft": (
        "solution.relaxation_time",
        1e-3,
        30.0,
        " s",
        ["network.coupling=400", "jet.length=3 mm"],
    ),
    "coupling": ("network.coupling", 30.0, 1e5, "", ["jet.length=3 mm"]),
    "coupling, relaxing": ("network.coupling", 30.0, 1e5, "", ["solution.relaxation_time=20 ms", "jet.length=3 mm"]),
}
RTOL = 1e-2


def sweep(name, steps):
    """Numbers of a sweep, (step, number), and the rungs."""
    key, low, high, unit, more = SWEEPS[name]
    rows, rungs = [], []
    for value in np.geomspace(low, high, steps):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = sl.run(sl.load_scene("peo5-water", [f"{key}={value:.12g}{unit}", f"accuracy.rtol={RTOL}", *more]))
        rows.append([float(result[n]) for n in NUMBERS] + [float(result[n].values[-1]) for n in AT_END])
        rungs.append(result.attrs["model"])
    return np.array(rows), rungs


def jumps(rows, rungs):
    """Largest jump of every number at a change of rung, over rtol, and the changes."""
    found, changes = {}, []
    for i in range(1, len(rungs)):
        if rungs[i] == rungs[i - 1]:
            continue
        changes.append(f"{rungs[i - 1]} -> {rungs[i]}")
        for j, name in enumerate((*NUMBERS, *AT_END)):
            here = rows[max(i - 2, 0) : i + 2, j]
            step = np.abs(np.diff(here))
            at = min(i, 2) - 1
            if not np.isfinite(here).all():
                continue
            beside = max((step[k] for k in range(step.size) if k != at), default=0.0)
            scale = 1.0 if "orientation" in name else abs(here[at])
            found[name] = max(found.get(name, 0.0), float(max(step[at] - beside, 0.0) / scale / RTOL))
    return found, changes


def main():
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    found = {}
    for name in SWEEPS:
        rows, rungs = sweep(name, steps)
        over, changes = jumps(rows, rungs)
        found[name] = {"changes": changes, "largest_jump_over_rtol": {k: round(v, 3) for k, v in over.items()}}
        print(name, changes, found[name]["largest_jump_over_rtol"], flush=True)
    Path(__file__).with_suffix(".json").write_text(
        json.dumps({"steps": steps, "rtol": RTOL, "sweeps": found}, indent=1) + "\n"
    )


if __name__ == "__main__":
    main()
