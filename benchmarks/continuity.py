"""Whether reported numbers jump where "auto" changes the rung: sweeps of the field, the concentration, the relaxation time
and the coupling.

    python benchmarks/continuity.py [steps] [sweep ...]

Each sweep takes a scene through every change of rung that "auto" makes on the way, in equal steps of the logarithm. At every
change the scenes on its two sides are solved by both rungs. Looked at is every number of a result that both report, and the
last value of every variable along the jet: a jump is what the rung changes of it in the same scene, relative to the number
(absolute where it is bounded by one and may be next to nothing: orientation, radial contraction, far_end_effect), over rtol;
inf where one rung alone has it. Writes continuity.json.
"""

import json
import sys
import warnings
from pathlib import Path

import numpy as np

import spinline as sl
from spinline.base.errors import SpinlineWarning

SLOW, SOFT, SHORT = "solution.relaxation_time=60 ms", "network.coupling=800", "jet.length=3 mm"
SWEEPS = {  # key, low, high, unit, further settings
    "field": ("jet.k", 0.1, 3.0, "", ["solution.relaxation_time=1 s", "network.coupling=3000"]),
    "field, soft": ("jet.k", 0.1, 3.0, "", [SLOW, SOFT]),
    "field, elastic": ("jet.k", 0.1, 3.0, "", [SOFT]),
    "concentration": ("solution.mass_fraction", 0.01, 0.3, "", ["solution.relaxation_time=2 s"]),
    "concentration, elastic": ("solution.mass_fraction", 0.01, 0.3, "", [SOFT]),
    "concentration, both": ("solution.mass_fraction", 0.01, 0.3, "", ["solution.relaxation_time=2 s", SOFT]),
    "relaxation time": ("solution.relaxation_time", 1e-3, 30.0, " s", [SHORT]),
    "relaxation time, soft": ("solution.relaxation_time", 1e-3, 30.0, " s", ["network.coupling=400", SHORT]),
    "coupling": ("network.coupling", 30.0, 1e5, "", [SHORT]),
    "coupling, relaxing": ("network.coupling", 30.0, 1e5, "", ["solution.relaxation_time=20 ms", SHORT]),
}
RTOL = 1e-2
BOUNDED = ("orientation", "radial_contraction", "far_end_effect")


def numbers(result):
    """Every number of a result, and the last of every variable along the jet."""
    found = {}
    for name, value in result.data_vars.items():
        if value.dtype.kind == "f" and not name.endswith("_std"):
            if value.ndim == 0:
                found[name] = float(value)
            elif value.dims == ("z",):
                found[f"last {name}"] = float(value.values[-1])
    return found


def scene(name, value, *more):
    """A scene of a sweep."""
    key, _, _, unit, given = SWEEPS[name]
    return sl.load_scene("peo5-water", [f"{key}={value:.12g}{unit}", f"accuracy.rtol={RTOL}", *given, *more])


def solved(one):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        return sl.run(one)


def sweep(name, steps):
    """Values of a sweep, and the rung of each."""
    _, low, high, _, _ = SWEEPS[name]
    values = np.geomspace(low, high, steps)
    return values, [solved(scene(name, value)).attrs["model"] for value in values]


def jumps(name, values, rungs):
    """Largest jump of every number at a change of rung, over rtol, and the changes."""
    found, changes = {}, []
    for i in range(1, len(rungs)):
        if rungs[i] == rungs[i - 1]:
            continue
        changes.append(f"{rungs[i - 1]} -> {rungs[i]} at {values[i]:.4g}")
        for value in values[i - 1 : i + 1]:
            both = []
            for rung in rungs[i - 1 : i + 1]:  # as "auto" takes it
                law = ["network.force_law=linear"] if rung in ("manifold", "two-fluid", "chain") else []
                both.append(numbers(solved(scene(name, value, f"network.model={rung}", *law))))
            for one in both[0].keys() & both[1].keys():
                a, b = (each[one] for each in both)
                if np.isnan(a) and np.isnan(b):
                    continue
                scale = 1.0 if one.endswith(BOUNDED) else max(abs(a), 1e-300)
                jump = abs(b - a) / scale / RTOL
                found[one] = max(found.get(one, 0.0), float(jump) if np.isfinite(jump) else np.inf)
    return found, changes


def main():
    """All sweeps, or those named; the others stay as they are in the file where they have as many steps."""
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    path = Path(__file__).with_suffix(".json")
    before = json.loads(path.read_text()) if path.exists() else {}
    found = before.get("sweeps", {}) if before.get("steps") == steps and len(sys.argv) > 2 else {}
    for name in sys.argv[2:] or SWEEPS:
        values, rungs = sweep(name, steps)
        over, changes = jumps(name, values, rungs)
        found[name] = {"changes": changes, "largest_jump_over_rtol": {k: round(v, 3) for k, v in sorted(over.items())}}
        worst = max(over, key=over.get, default="nothing")
        print(f"{name}: {changes}, {len(over)} numbers, most {worst} {over.get(worst, 0.0):.3g} rtol", flush=True)
        path.write_text(json.dumps({"steps": steps, "rtol": RTOL, "sweeps": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
