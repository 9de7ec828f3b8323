"""The PEO jets of the review's Figs. 34-35 from their settings: k and beta beside the measured ones. Nothing is fitted to them.

    python benchmarks/ehd_peo.py        # writes ehd_peo.json

Given in print: 5 wt% PEO 600 kDa in water, 0.6 kV/cm over 6.5 cm, 3.2 mL/h, r_0 125 um, 0.01 S/m, 2 Pa s (Fig. 34b,
Fig. 35); surface tension of 6 wt% (Fig. 13). Not given: relaxation time and solvent share, which carry most of the
spread. They are varied: theta 3, 7, 15 ms; field of a needle or hyperboloid; local or constant log; end strain rate x
0.5, 1, 2. Each jet is fitted by V = k^2 s^(2 beta) over 0.5 to 5 mm, as the figure is. Fig. 34c (3 wt%, 1.6 kV/cm, 2
mL/h) gives no viscosity and is left out.

A second test without a fit: the exponents of the predicted current beside those measured on many solutions, I ~ E Q^0.5
K^0.4 (Bhattacharjee et al., J. Appl. Phys. 107, 044306 (2010), abstract; part of their current is a secondary spray).
"""

import json
from itertools import product
from pathlib import Path

import numpy as np
from peo_needle_settings import peo_needle

from spinline.jetprofile.ehd import NeedleSettings, NoSteadyJet, StraightEhdJet

MEASURED = {"beta": 0.47, "k": 1.0, "radius_ratio": {"8": 0.376, "24": 0.2245, "40": 0.177}}
R0 = 125e-6


def settings(theta: float, field: str, log: str, factor: float) -> NeedleSettings:
    return peo_needle(voltage=3.9e3, gap=0.065, relaxation_time=theta, field=field, log=log, end_factor=factor)


def exponents(field: str, log: str) -> dict[str, float]:
    """Slopes of ln I in ln V, ln Q and ln K about the jet of Fig. 35, from 20 % to either side."""
    jet = StraightEhdJet(settings(7e-3, field, log, 1.0), length=0.0065)
    found = {}
    for name in ("voltage", "flow_rate", "conductivity"):
        own = getattr(jet.settings, name)
        sides = [jet.changed(**{name: own * factor}).current for factor in (1.2, 1 / 1.2)]
        found[name] = float(np.log(sides[0] / sides[1]) / (2 * np.log(1.2)))
    return found


def main() -> None:
    rows = []
    z = np.geomspace(0.5e-3, 5e-3, 60)
    for theta, field, log, factor in product(
        (3e-3, 7e-3, 15e-3), ("needle", "hyperboloid"), ("local", "constant"), (0.5, 1.0, 2.0)
    ):
        row: dict[str, object] = {"theta": theta, "field": field, "log": log, "end_factor": factor}
        try:
            jet = StraightEhdJet(settings(theta, field, log, factor), length=0.0065)
        except NoSteadyJet as refused:
            rows.append(row | {"verdict": refused.reason})
            continue
        slope, start = np.polyfit(np.log(z / R0), np.log(jet.velocity_ratio(z)), 1)
        ratio = {key: float(jet.radius(float(key) * R0) / R0) for key in ("8", "24", "40")}
        local = 0.5 * 5e-3 * float(jet.strain_rate(5e-3)) / float(jet.velocity(5e-3))
        rows.append(
            row
            | {
                "beta": slope / 2,
                "k": float(np.exp(start / 2)),
                "beta_at_5mm": local,
                "radius_ratio": ratio,
                "current_nA": jet.current * 1e9,
            }
        )
    solved = [row for row in rows if "beta" in row]
    spread = {
        name: [float(f([row[name] for row in solved])) for f in (np.min, np.median, np.max)]
        for name in ("beta", "k", "beta_at_5mm", "current_nA")
    }
    spread |= {
        f"r/r0 at s = {s}": [float(f([row["radius_ratio"][s] for row in solved])) for f in (np.min, np.median, np.max)]
        for s in ("8", "24", "40")
    }
    result = {
        "measured": MEASURED,
        "predicted_least_median_most": spread,
        "without_a_jet": len(rows) - len(solved),
        "current_exponents": {
            "measured": {"voltage": 1.0, "flow_rate": 0.5, "conductivity": 0.4},
            "predicted": [
                {"field": field, "log": log, **exponents(field, log)}
                for field, log in product(("needle", "hyperboloid"), ("local", "constant"))
            ],
        },
        "rows": rows,
    }
    Path(__file__).with_suffix(".json").write_text(json.dumps(result, indent=1) + "\n")
    print(
        json.dumps(
            {
                key: result[key]
                for key in ("measured", "predicted_least_median_most", "without_a_jet", "current_exponents")
            },
            indent=1,
        )
    )


if __name__ == "__main__":
    main()
