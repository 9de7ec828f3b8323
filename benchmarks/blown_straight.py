"""The straight blown jet over gas velocities, relaxation times and laws: verdict, balance, forces, cost.

PAN 12 % in DMF as in the tests (1 mL/h, 100 um, 3 Pa s, 1 mm gas nozzle, 10 mm to a free end), U0 = 50, 100, 200, 400 m/s,
theta 1e-5 ... 1 s; newton, ucm, oldroyd-b and fene-p with a tenth of the viscosity the solvent's. Kept in
``blown_straight.json``; rows that are there are not done again.

    python benchmarks/blown_straight.py [--json FILE]
"""

import argparse
import json
import time
import warnings
from dataclasses import replace
from pathlib import Path

import spinline.jetprofile.blown as blown
from spinline.base.errors import SpinlineWarning

PAN = blown.BlownSolution(1e-6 / 3600, 100e-6, 970.0, 3.0, 0.036)
SPEEDS = (50.0, 100.0, 200.0, 400.0)
TIMES = (1e-5, 1e-4, 1e-3, 5e-3, 1e-2, 1e-1, 1.0)
LAWS = {"newton": (0.0, 0.0), "oldroyd-b": (0.3, 0.0), "fene-p": (0.3, 500.0), "ucm": (0.0, 0.0)}


def row(law, theta, speed):
    solvent, limit = LAWS[law]
    solution = replace(PAN, relaxation_time=theta, solvent_viscosity=solvent, extensibility=limit)
    start = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        jet = blown.straight_blown_jet(solution, blown.AirJet(1e-3, speed), 10e-3, law=law)
    out = {"law": law, "theta_s": theta, "speed_m_s": speed, "verdict": jet.verdict, "message": jet.message}
    if jet.z.size:
        out |= {
            "balance": jet.force_balance,
            "force_uN": jet.tension[0] * 1e6,
            "end_m_s": jet.velocity[-1],
            "fastest_m_s": jet.velocity.max(),
        }
    return out | {"cpu_s": round(time.process_time() - start, 2)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, default=Path(__file__).with_suffix(".json"))
    arguments = parser.parse_args()
    rows = json.loads(arguments.json.read_text()) if arguments.json.exists() else []
    done = {(one["law"], one["theta_s"], one["speed_m_s"]) for one in rows}
    for law in LAWS:
        for theta in (0.0,) if law == "newton" else TIMES:
            for speed in SPEEDS:
                if (law, theta, speed) not in done:
                    rows.append(row(law, theta, speed))
                    print(rows[-1], flush=True)
                    arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
