"""Statistics of spun jets past bending: 16 noisy seeds, and the same with elements and tolerance halved.

    python benchmarks/spun_statistics.py [--minutes 10] [-o benchmarks/spun_statistics.json]

Bundled scene `pvp-spun` (circling nozzle, impulses of the air by seed, label and time), with its published charge and with
a part of it. A row per run is written as it is done, so that the campaign goes on where it stopped; the summary is of
the rows there are. A statistic is stable where halving moves it by less than its own interval (95 %, Student's t over seeds).
"""

import json
import math
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun.run import SpunRun
from spinline.jetprofile.spun.settings import Air, SpunSettings
from spinline.scene.file import load_scene
from spinline.setup.build import build_solution
from spinline.setup.spun import spun_settings

ROOT = Path(__file__).resolve().parents[1]
SEEDS = 16
NOISE = Air(xi=0.0, lift=False, noise=1e-9, interval=2e-5, grain=1e-13)
NAMES = ("landing radius m", "2 atan(R/h) deg", "radius at the collector m", "turns per s")
CASES: dict[str, dict[str, Any]] = {
    "published charge": {"change": (), "elements": (4e-4, 2e-4), "time": 24e-3, "from": 16e-3},
    "six tenths of it": {
        "change": ('jet.charge_density="26400 statC/cm3"',),
        "elements": (2e-4, 1e-4),
        "time": 24e-3,
        "from": 18e-3,
    },
}


def settings_of(case: str, element: float, seed: int) -> SpunSettings:
    """The scene with noise, a seed, and a tolerance that goes with the elements."""
    about = CASES[case]
    scene = load_scene("pvp-spun", [*about["change"], f'jet.element_length="{element} m"'])
    made = spun_settings(scene.jet, build_solution(scene), seed=seed)
    grid = replace(made.grid, tolerance=1e-5 * element / 4e-4)
    return replace(made, grid=grid, air=NOISE)


def measured(case: str, element: float, seed: int) -> list[float]:
    """Means of what has landed late in one run, in the order of `NAMES`."""
    s = settings_of(case, element, seed)
    run = SpunRun.start(s)
    run.advance(CASES[case]["time"])
    d = run.chain.deposited
    d = d[d[:, c.D_TIME] > CASES[case]["from"]]
    y, z = d[:, c.D_Y1], d[:, c.D_Z1]
    off = float(np.hypot(y, z).mean())
    thin = np.sqrt(d[:, c.D_VOLUME] / (np.pi * d[:, c.D_FLIGHT]))
    turns = np.polyfit(d[:, c.D_TIME], np.unwrap(np.arctan2(z, y)), 1)[0] / (2 * np.pi)
    return [off, math.degrees(2 * math.atan(off / s.loads.gap)), float(thin.mean()), abs(float(turns))]


def summary(rows: dict[str, list[float]]) -> dict[str, Any]:
    """Mean and half interval per grid, how far halving moves each, and whether that is stable."""
    from scipy.stats import t as student

    out: dict[str, Any] = {}
    for case, about in CASES.items():
        grids = []
        for element in about["elements"]:
            known = [rows[key] for seed in range(SEEDS) if (key := f"{case}|{element}|{seed}") in rows]
            if len(known) < 2:
                break
            values = np.array(known)
            half = student.ppf(0.975, len(values) - 1) * values.std(axis=0, ddof=1) / math.sqrt(len(values))
            grids.append((values.mean(axis=0), half, len(values)))
        if len(grids) < 2:
            continue
        (coarse, wide, few), (fine, half, many) = grids
        out[case] = {"seeds": min(few, many)}
        for i, name in enumerate(NAMES):
            moves = abs(float(coarse[i] - fine[i]))
            out[case][name] = {
                "coarse": [float(coarse[i]), float(wide[i])],
                "fine": [float(fine[i]), float(half[i])],
                "moves by, of itself": moves / abs(float(fine[i])),
                "moves by, of the interval": moves / max(float(half[i]), 1e-300),
                "stable": bool(moves <= max(float(half[i]), float(wide[i]))),
            }
    return out


def main(arguments: list[str]) -> None:
    """Run what is missing, for so many minutes of processor time."""
    target = ROOT / "benchmarks" / "spun_statistics.json"
    if "-o" in arguments:
        target = Path(arguments[arguments.index("-o") + 1])
    minutes = float(arguments[arguments.index("--minutes") + 1]) if "--minutes" in arguments else math.inf
    known = json.loads(target.read_text()) if target.exists() else {"rows": {}}
    begun = time.process_time()
    for seed in range(SEEDS):
        for case, about in CASES.items():
            for element in about["elements"]:
                key = f"{case}|{element}|{seed}"
                if key in known["rows"] or time.process_time() - begun > 60 * minutes:
                    continue
                known["rows"][key] = measured(case, element, seed)
                known["summary"] = summary(known["rows"])
                target.write_text(json.dumps(known, indent=1) + "\n")
                print(key, known["rows"][key], f"{time.process_time() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
