"""Electrified jets of random settings over the whole box: a jet, or a named verdict, and never the wrong branch.

Each jet that comes out is checked by the three tests (thins everywhere, under tension everywhere, twice the mesh moves u
by less than 1 %) and for what its end makes of it (`end_pull`), and reached again by other ways: the upwind equations
alone, on another mesh; and, where the relaxation time is long, the forces raised at a short one and the time then
lengthened. What passes every test must be the same jet by all of them. Settings 0 to 499 are drawn at random; 1000 to 1031
are the corners of the box of K, mu, V, Q and De.

    python benchmarks/ehd_settings.py [seconds]        # goes on where ehd_settings.json ends, for so long
"""

import json
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet
from spinline.jetprofile.ehd.boundary_value import OutOfWork, halved, interpolate, newton
from spinline.jetprofile.ehd.end_pull import LIMIT, NECK, end_pull
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
CORNERS = ("conductivity", "viscosity", "voltage", "flow_rate", "deborah")
INDICES = (*range(500), *range(1000, 1032))


def corner(index: int) -> NeedleSettings:
    value = {
        name: BOX[name][index >> k & 1] if name != "deborah" else (0.0, 1e3)[index >> k & 1]
        for k, name in enumerate(CORNERS)
    }
    de, radius = value.pop("deborah"), 125e-6
    velocity = value["flow_rate"] / (np.pi * radius**2)
    common = {"radius": radius, "gap": 0.1, "surface_tension": 0.061, "density": 1000.0, "permittivity": 80.0}
    return NeedleSettings(
        **value, **common, relaxation_time=de * radius / velocity, extensibility=507.0, field="needle"
    )


def drawn(index: int) -> NeedleSettings:
    if index >= 1000:
        return corner(index - 1000)
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


def other_ways(settings: NeedleSettings, charge: bool) -> dict[str, tuple[float, float]]:
    """Current and tension by the upwind equations, and by a short relaxation time first, where a jet passes every test."""
    found = {}
    for way in ("upwind", "time"):
        search = _Search(settings, 400_000)
        try:
            if way == "upwind":
                made = search.ascend(charge, True, True)
            elif settings.polymer and settings.deborah > 0.5:
                slack = 0.5 / settings.deborah
                loose = search.climb(charge, True, slack, False)
                made = None if loose is None else search.lengthen(loose, charge, True, slack)
            else:
                continue
            done = None if made is None else search.refined(made, charge, 1e-5)
        except OutOfWork:
            continue
        if done is None or done.why or not thins(done.problem, done.discrete):
            continue
        if not end_pull(done.problem, done.discrete).rules:
            y = done.discrete.y
            found[way] = float(settings.current_scale * np.exp(y[0, 3])), float(y[0, 1])
    return found


def row(index: int) -> dict[str, object]:
    settings = drawn(index)
    kept = {"index": index, "law": settings.law}
    began = time.process_time()
    try:
        jet = StraightEhdJet(settings, length=settings.end_position)
    except NoSteadyJet as refused:
        spent = time.process_time() - began
        told = {"verdict": refused.reason, "search": refused.search, "pull": refused.pull}
        return {**kept, **told, "seconds": round(spent, 2)}
    except InputError as error:
        return {**kept, "verdict": f"refused: {error.field}", "seconds": 0.0}
    spent = time.process_time() - began
    problem, found = jet.solved.problem, jet.solved.discrete
    s = halved(found.s)
    twice = newton(problem, s, interpolate(found.s, found.y, s))
    again = {
        way: max(abs(current / jet.current - 1), abs(pull / float(found.y[0, 1]) - 1))
        for way, (current, pull) in other_ways(settings, problem.charge).items()
    }
    return {
        **kept,
        "verdict": "jet",
        "seconds": round(spent, 2),
        "thins": thins(problem, found),
        "mesh_moves_u": float(np.abs(twice.y[::2, 0] - found.y[:, 0]).max()) if twice.converged else None,
        "error": jet.residual,
        "end": [jet.end_pull.share, jet.end_pull.neck],
        "again": again,
        "poor": [one.name for one in jet.verdicts if not one.good],
    }


def summary(rows: list[dict[str, object]]) -> dict[str, object]:
    seconds = np.array([one["seconds"] for one in rows])
    jets = [one for one in rows if one["verdict"] == "jet"]
    again = {one["index"]: max(one["again"].values()) for one in jets if one["again"]}
    tested = [one for one in jets if "thins" in one]  # the first rows were run without this column
    passed = [one for one in tested if one["thins"] and one["mesh_moves_u"] is not None and one["mesh_moves_u"] < 0.01]
    return {
        "number": len(rows),
        "run_before_the_second_of_the_other_ways": sum(one.get("earlier", False) for one in rows),
        "verdicts": dict(Counter(one["verdict"] for one in rows).most_common()),
        "searches_behind_the_verdicts": {
            name: dict(
                Counter(one["search"] for one in rows if one["verdict"] == name and "search" in one).most_common()
            )
            for name in sorted({one["verdict"] for one in rows if "search" in one})
        },
        "jets_that_pass_the_three_tests": f"{len(passed)} of {len(tested)}",
        "made_by_their_end": [one["index"] for one in jets if one["end"][0] > LIMIT or one["end"][1] > NECK],
        "reached_again": {way: sum(way in one["again"] for one in jets) for way in ("upwind", "time")},
        "furthest_apart": max(again.values(), default=None),
        "apart_by_more_than_1e-3": [index for index, told in again.items() if told > 1e-3],
        "cpu_seconds": dict(
            zip(("median", "p95", "most"), np.percentile(seconds, [50, 95, 100]).tolist(), strict=True)
        ),
        "rows": rows,
    }


def main() -> None:
    path = Path(__file__).with_suffix(".json")
    rows = {one["index"]: one for one in json.loads(path.read_text())["rows"]} if path.exists() else {}
    until = time.monotonic() + (float(sys.argv[1]) if len(sys.argv) > 1 else np.inf)
    # first what was never run, then what was run before the second of the other ways was there
    for index in sorted(INDICES, key=lambda index: index in rows):
        if time.monotonic() > until:
            break
        if not rows.get(index, {"earlier": True}).get("earlier"):
            continue
        rows[index] = row(index)
        print(rows[index], flush=True)
        path.write_text(json.dumps(summary([rows[one] for one in sorted(rows)]), indent=1) + "\n")


if __name__ == "__main__":
    main()
