"""Estimated error of a straight electrified jet beside the true one, 100 random settings that have a jet.

Truth is the same problem on a mesh eight times as fine; its own error is told by the truth of a mesh four times as fine. Judged
are the radius at all nodes of the finest mesh, seven between any two of the jet's own, and the current, wherever the true error
is above 1e-10, where it is not rounding.

    python benchmarks/ehd_errors.py [seconds]        # goes on where ehd_errors.json ends, for so long
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile.ehd import NeedleSettings
from spinline.jetprofile.ehd.boundary_value import halved, interpolate, newton, spline
from spinline.jetprofile.ehd.solver import solve, thins

LAWS = ("fene-p", "newtonian", "giesekus", "oldroyd-b")
FIELDS = ("hyperboloid", "needle", "uniform")
WANTED = 100


def drawn(index: int) -> NeedleSettings:
    rng = np.random.default_rng([16, index])

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    radius, flow = between(8e-5, 5e-4), between(1e-10, 3e-9)
    return NeedleSettings(
        radius=radius,
        flow_rate=flow,
        voltage=between(4e3, 2e4),
        gap=between(0.05, 0.2),
        conductivity=between(1e-6, 1),
        viscosity=between(0.2, 20),
        surface_tension=between(0.025, 0.073),
        density=between(800, 1300),
        permittivity=between(5, 80),
        relaxation_time=between(0.1, 5) * np.pi * radius**3 / flow,
        extensibility=between(100, 2000),
        law=LAWS[index % 4],
        mobility=0.01,
        field=FIELDS[int(rng.integers(3))],
        log=("local", "constant")[int(rng.integers(2))],
        end=0.02,
    )


def row(index: int) -> dict[str, object]:
    settings = drawn(index)
    tolerance = (1e-4, 1e-5, 1e-6)[index % 3]
    try:
        found = solve(settings, tolerance=tolerance)
    except InputError as error:
        return {"index": index, "verdict": f"refused: {error.field}"}
    if found.why or not thins(found.problem, found.discrete):
        return {"index": index, "verdict": found.why or "swells"}
    s, y = found.discrete.s, found.discrete.y
    fine, levels = found.discrete, []
    for _ in range(3):
        mesh = halved(fine.s)
        fine = newton(found.problem, mesh, interpolate(fine.s, fine.y, mesh), tol=1e-12)
        levels.append(fine)
    if not fine.converged:
        return {"index": index, "verdict": "no truth"}
    at = fine.s
    mine, true = spline(found.problem, found.discrete)[0](at)[:, 0], fine.y[:, 0]
    radius, current = 0.5 * float(np.abs(mine - true).max()), abs(float(y[0, 3] - fine.y[0, 3]))
    less = 0.5 * float(np.abs(mine - spline(found.problem, levels[1])[0](at)[:, 0]).max())
    nodes = 0.5 * float(np.abs(fine.y[::8, 0] - y[:, 0]).max())
    made = {"index": index, "verdict": "jet", "law": settings.law, "tolerance": tolerance, "nodes": s.size}
    return made | {
        "radius": [found.error["radius"], radius],
        "radius_at_nodes": nodes,
        "radius_by_four_times_the_mesh": less,
        "current": [found.error["current"], current],
    }


def summary(rows: list[dict[str, object]]) -> dict[str, object]:
    jets = [one for one in rows if one["verdict"] == "jet"]
    result: dict[str, object] = {"settings": len(rows), "jets": len(jets)}
    for name in ("radius", "current"):
        ratio = np.array([one[name][0] / one[name][1] for one in jets if one[name][1] > 1e-10])
        result[f"{name}: estimate over true"] = {
            "number": ratio.size,
            "least": float(ratio.min()),
            "median": float(np.median(ratio)),
            "most": float(ratio.max()),
            "beyond a factor of 2": int(np.sum((ratio < 0.5) | (ratio > 2))),
        }
    moved = [
        abs(one["radius_by_four_times_the_mesh"] / one["radius"][1] - 1) for one in jets if one["radius"][1] > 1e-10
    ]
    return result | {"radius: true error by a mesh half as fine, off by at most": max(moved), "rows": rows}


def main() -> None:
    path = Path(__file__).with_suffix(".json")
    rows = json.loads(path.read_text())["rows"] if path.exists() else []
    until = time.monotonic() + (float(sys.argv[1]) if len(sys.argv) > 1 else np.inf)
    while time.monotonic() < until and sum(one["verdict"] == "jet" for one in rows) < WANTED:
        rows.append(row(len(rows)))
        print(rows[-1], flush=True)
    path.write_text(json.dumps(summary(rows), indent=1) + "\n")
    print(json.dumps({name: value for name, value in summary(rows).items() if name != "rows"}, indent=1))


if __name__ == "__main__":
    main()
