"""Electrified jets of random settings over the whole box: a jet, or a named verdict, and never the wrong branch.

Each jet that comes out is checked by the three tests (thins everywhere, under tension everywhere, the mesh does not move
it) and reached a second time by another way: the upwind equations alone, on another mesh. The two must agree.

    python benchmarks/ehd_settings.py [number] [first]        # writes ehd_settings.json
"""

import json
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet
from spinline.jetprofile.ehd.boundary_value import OutOfWork
from spinline.jetprofile.ehd.solver import _Search, thins

BOX = {
    "conductivity": (1e-12, 10.0),
    "viscosity": (1e-3, 100.0),
    "voltage": (100.0, 4e4),
    "flow_rate": (1e-12, 1e-8),
    "radius": (5e-5, 1e-3),
    "gap": (0.03, 0.3),
    "surface_tension": (0.02, 0.075),
    "density": (700.0, 1500.0),
    "permittivity": (2.0, 100.0),
    "extensibility": (50.0, 5000.0),
    "deborah": (1e-3, 1e3),
}
LAWS = ("fene-p", "newtonian", "oldroyd-b", "giesekus")
FIELDS = ("hyperboloid", "needle", "uniform")


def drawn(index: int) -> NeedleSettings:
    rng = np.random.default_rng([15, index])
    value = {name: float(np.exp(rng.uniform(np.log(low), np.log(high)))) for name, (low, high) in BOX.items()}
    de = value.pop("deborah") * (rng.random() > 0.05)  # a few without relaxation
    velocity = value["flow_rate"] / (np.pi * value["radius"] ** 2)
    return NeedleSettings(
        **value,
        relaxation_time=de * value["radius"] / velocity,
        law=LAWS[int(rng.integers(4))],
        mobility=0.01,
        log=("local", "constant")[int(rng.integers(2))],
        field=FIELDS[int(rng.integers(3))],
        end=None if rng.random() < 0.5 else 0.2 * value["gap"],
    )


def second_way(settings: NeedleSettings, charge: bool) -> tuple[float, float] | None:
    """Current and tension by the upwind equations from the unpulled thread."""
    search = _Search(settings, 1_500_000)
    try:
        found = search.ascend(charge, True, True)
        if found is None:
            return None
        done = search.refined(found, charge, 1e-5)
    except OutOfWork:
        return None
    if done.why or not thins(done.problem, done.discrete):
        return None
    y = done.discrete.y
    return float(settings.current_scale * np.exp(y[0, 3])), float(y[0, 1])


def row(index: int) -> dict[str, object]:
    settings = drawn(index)
    began = time.process_time()
    try:
        jet = StraightEhdJet(settings, length=settings.end_position)
    except NoSteadyJet as refused:
        spent = time.process_time() - began
        return {"index": index, "verdict": refused.reason, "pull": refused.pull, "seconds": round(spent, 2)}
    except InputError as error:
        return {"index": index, "verdict": f"refused: {error.field}", "seconds": 0.0}
    spent = time.process_time() - began
    charge = jet.solved.problem.charge
    again = second_way(settings, charge)
    y = jet.solved.discrete.y
    told = None
    if again is not None:
        told = max(abs(again[0] / jet.current - 1), abs(again[1] / float(y[0, 1]) - 1))
    poor = [one.name for one in jet.verdicts if not one.good]
    return {
        "index": index,
        "verdict": "jet",
        "seconds": round(spent, 2),
        "error": jet.residual,
        "again": told,
        "poor": poor,
        "law": settings.law,
    }


def main() -> None:
    number, first = (int(x) for x in (*sys.argv[1:], *("500", "0")[len(sys.argv) - 1 :]))
    rows = []
    for index in range(first, first + number):
        rows.append(row(index))
        print(rows[-1], flush=True)
    seconds = np.array([one["seconds"] for one in rows])
    again = [one["again"] for one in rows if one.get("again") is not None]
    result = {
        "number": number,
        "verdicts": dict(Counter(one["verdict"] for one in rows).most_common()),
        "reached_twice": len(again),
        "furthest_apart": max(again, default=None),
        "apart_by_more_than_1e-3": [one["index"] for one in rows if (one.get("again") or 0) > 1e-3],
        "cpu_seconds": dict(
            zip(("median", "p95", "most"), np.percentile(seconds, [50, 95, 100]).tolist(), strict=True)
        ),
        "rows": rows,
    }
    Path(__file__).with_suffix(".json").write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
