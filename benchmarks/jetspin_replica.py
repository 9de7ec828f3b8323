"""What JETSPIN's equations cost with its own schemes and with located releases, and what a spun jet of as many elements costs.

    python benchmarks/jetspin_replica.py [-o benchmarks/jetspin_replica.json]

The equations are those of `tests/jetspin_replica.py` (published PVP jet, to 10 ms, 89 beads); seconds are processor
time, to be read as ratios within one run. Errors are distances from a run of tolerance 1e-11: of the first bead over its path
(every 0.25 ms), and of the worst bead at the end.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from jetspin_replica import Beads, parameters  # noqa: E402
from spun_cases import pvp, rotating, spun  # noqa: E402

TIMES = np.arange(1, 41) * 2.5e-4
SCHEMES = {
    "Heun 1e-6": lambda jet, end: jet.fixed(end, 1e-6, heun=True),
    "Heun 1e-7": lambda jet, end: jet.fixed(end, 1e-7, heun=True),
    "Runge-Kutta 1e-6": lambda jet, end: jet.fixed(end, 1e-6),
    "Runge-Kutta 1e-7": lambda jet, end: jet.fixed(end, 1e-7),
    "Dormand-Prince 1e-4": lambda jet, end: jet.adaptive(end, 1e-4),
    "Dormand-Prince 1e-5": lambda jet, end: jet.adaptive(end, 1e-5),
    "Dormand-Prince 1e-6": lambda jet, end: jet.adaptive(end, 1e-6),
    "Dormand-Prince 1e-8": lambda jet, end: jet.adaptive(end, 1e-8),
}


def paths(march):
    """First bead every 0.25 ms, and all at the end."""
    jet, rows = Beads.start(parameters()), []
    for end in TIMES:
        march(jet, end)
        rows.append(jet.y[0, :3].copy())
    return np.array(rows), jet.y[: jet.n, :3].copy(), jet


def cost(march):
    """Processor time of one run to 10 ms, the least of three, and its evaluations."""
    took = []
    for _ in range(3):
        jet, begun = Beads.start(parameters()), time.process_time()
        march(jet, 1e-2)
        took.append(time.process_time() - begun)
    return min(took), jet.calls


def measure():
    true, last, best = paths(lambda jet, end: jet.adaptive(end, 1e-11))
    out = {"first bead at 10 ms: x cm, off the axis cm, stress g/cm/s2": [float(v) for v in best.front], "schemes": {}}
    for name, march in SCHEMES.items():
        path, end, jet = paths(march)
        seconds, calls = cost(march)
        out["schemes"][name] = {
            "seconds": seconds,
            "evaluations": calls,
            "path error of the first bead, cm": float(np.linalg.norm(path - true, axis=1).max()),
            "worst bead at 10 ms, cm": float(np.linalg.norm(end - last, axis=1).max()),
            "beads": jet.n,
        }
    rows = out["schemes"]
    out["times cheaper than Heun 1e-7"] = rows["Heun 1e-7"]["seconds"] / rows["Dormand-Prince 1e-6"]["seconds"]
    settings = rotating(pvp(2e-4, repulsion="hybrid", near=4, pressure=False), 1e4, ramp=5e-4)
    spun(settings, 1e-4)
    begun = time.process_time()
    chain = spun(settings, 10e-3)
    out["spun jet, 10 ms"] = {"elements": chain.n, "seconds": time.process_time() - begun}
    return out


if __name__ == "__main__":
    target = sys.argv[sys.argv.index("-o") + 1] if "-o" in sys.argv else ROOT / "benchmarks" / "jetspin_replica.json"
    found = measure()
    Path(target).write_text(json.dumps(found, indent=1) + "\n")
    print(json.dumps(found, indent=1))
