"""Published viscosities of aqueous polymer solutions against the estimates from molar mass and concentration alone.

Run: ``python benchmarks/published_viscosity.py`` writes ``published_viscosity.json``. Nothing is fitted: [eta] is Mark and
Houwink's, K is 0.4, the power is the scaling law's. The viscosities are the makers' (a range is taken at its geometric
mean), measured at shear rates of the order of 1 to 100 1/s: the thickest are thinned by it, and the estimate is then too
high. Beside it `c_e [eta]`, the overlap at which these solutions are entangled. The viscosities of PVA were held against a
second data sheet (Kuraray, Mowiol, DIN 53015: the same but for 4-98, 4.5 +/- 0.5 mPa s); those of PEO and PVP, and the
molar masses, were entered from the brochures named.
"""

import json
from pathlib import Path

import numpy as np

from spinline.rheology.intrinsic import intrinsic_viscosity
from spinline.rheology.prior import specific_viscosity

# polymer, source, viscosity of water (mPa s), density of the solution (kg/m3); grade, M (kg/mol), wt%, low and high (mPa s)
PUBLISHED = [
    (
        "PEO",
        "POLYOX Water-Soluble Resins, Dow (2002), viscosities at 25 degC",
        0.89,
        1005.0,
        [
            ("WSR N-10", 100, 5, 30, 50),
            ("WSR N-80", 200, 5, 55, 90),
            ("WSR N-750", 300, 5, 600, 1200),
            ("WSR N-3000", 400, 5, 2250, 4500),
            ("WSR-205", 600, 5, 4500, 8800),
            ("WSR-1105", 900, 5, 8800, 17600),
            ("WSR N-12K", 1000, 2, 400, 800),
            ("WSR N-60K", 2000, 2, 2000, 4000),
            ("WSR-301", 4000, 1, 1650, 5500),
            ("Coagulant", 5000, 1, 5500, 7500),
            ("WSR-303", 7000, 1, 7500, 10000),
        ],
    ),
    (
        "PVA",
        "Mowiol, Clariant (DIN 53015, 4 %, 20 degC); Mw as sold by Sigma-Aldrich",
        1.002,
        1010.0,
        [
            ("4-98", 27, 4, 4, 5),
            ("6-98", 47, 4, 6, 6),
            ("10-98", 61, 4, 10, 10),
            ("20-98", 125, 4, 20, 20),
            ("28-99", 145, 4, 28, 28),
            ("56-98", 195, 4, 56, 56),
            ("4-88", 31, 4, 4, 4),
            ("8-88", 67, 4, 8, 8),
            ("18-88", 130, 4, 18, 18),
            ("40-88", 205, 4, 40, 40),
        ],
    ),
    (
        "PVP",
        "Soluble Kollidon grades, BASF (2008), 10 % in water at 20 to 25 degC",
        0.95,
        1020.0,
        [
            ("12 PF", 2.5, 10, 1.3, 2.3),
            ("17 PF", 9, 10, 1.5, 3.5),
            ("25", 30, 10, 3.5, 5.5),
            ("30", 49, 10, 5.5, 8.5),
            ("90 F", 1250, 10, 300, 700),
        ],
    ),
]

# c_e, where the recipe's law of the viscosity has this specific viscosity and this power above (`spinline.recipe`)
ENTANGLED, POWER = 20.0, 5.0


def compare() -> dict[str, object]:
    """Rows, and bias and spread (factors) of each polymer and of all."""
    rows, logs = [], {}
    for polymer, source, water, density, grades in PUBLISHED:
        for grade, mass, percent, low, high in grades:
            measured = float(np.sqrt(low * high)) / water - 1
            overlap = percent / 100 * density * intrinsic_viscosity(polymer, "water", mass).value
            estimate = float(specific_viscosity(overlap))
            ratio = (1 + estimate) / (1 + measured)
            logs.setdefault(polymer, []).append(np.log(ratio))
            rows.append(
                {
                    "polymer": polymer,
                    "grade": grade,
                    "molar_mass": mass,
                    "mass_percent": percent,
                    "source": source,
                    "c_eta": round(overlap, 4),
                    "published_eta_sp": round(measured, 4),
                    "estimate_eta_sp": round(estimate, 4),
                    "viscosity_ratio": round(ratio, 4),
                }
            )
    every = np.concatenate(list(logs.values()))
    summary = {
        name: {
            "solutions": len(v),
            "bias": round(float(np.exp(np.mean(v))), 3),
            "spread": round(float(np.exp(np.std(v))), 3),
        }
        for name, v in {**logs, "all": every}.items()
    }
    onsets = {}
    for row in rows:
        if row["published_eta_sp"] > ENTANGLED:
            onset = row["c_eta"] * (ENTANGLED / row["published_eta_sp"]) ** (1 / POWER)
            onsets.setdefault(row["polymer"], []).append(np.log(onset))
    for name, v in onsets.items():
        summary[name]["c_e [eta]"] = round(float(np.exp(np.mean(v))), 2)
    summary["all"]["c_e [eta]"] = round(float(np.exp(np.mean([np.mean(v) for v in onsets.values()]))), 2)
    summary["all"]["rms_factor"] = round(float(np.exp(np.sqrt(np.mean(every**2)))), 3)
    summary["all"]["worst_factor"] = round(float(np.exp(np.abs(every).max())), 3)
    return {"summary": summary, "rows": rows}


if __name__ == "__main__":
    found = compare()
    Path(__file__).with_suffix(".json").write_text(json.dumps(found, indent=1) + "\n")
    print(json.dumps(found["summary"], indent=1))
