"""Whether the 95 % intervals of `fit_power_law` hold the truth: noise of the radius, and departures that are let pass.

    python benchmarks/coverage_power_law.py [draws [more [case]]]

Writes coverage_power_law.json beside this file; 2,000 draws a case take some minutes. The truth is k = 1, beta = 0.47.
"""

import json
import sys
import warnings
from pathlib import Path

import numpy as np

from spinline.base.errors import SpinlineWarning
from spinline.jetprofile.fit import fit_power_law

R0, BETA, SAMPLES = 125e-6, 0.47, 60
Z = np.geomspace(1e-3, 1e-2, SAMPLES)
TRUE = R0 * (Z / R0) ** -BETA
U = 2 * np.log(Z / Z[0]) / np.log(Z[-1] / Z[0]) - 1
SMOOTH = np.linalg.cholesky(np.exp(-0.5 * ((U[:, None] - U) / 1.5) ** 2) + 1e-10 * np.eye(SAMPLES))


def noise(size, given):
    """Relative noise; standard deviations as the true radius, as the observed one, or not given."""

    def make(rng):
        r = TRUE * (1 + size * rng.standard_normal(SAMPLES))
        return r, {"true": size * TRUE, "observed": size * r, "none": None}[given]

    return make


def bent(size):
    """A smooth departure of random size up to 2 %, and noise."""

    def make(rng):
        departure = rng.uniform(0, 0.02) * SMOOTH @ rng.standard_normal(SAMPLES)
        return TRUE * np.exp(departure) * (1 + size * rng.standard_normal(SAMPLES)), size * TRUE

    return make


CASES = {
    **{f"noise {100 * s:g} %, std {g}": noise(s, g) for s in (0.05, 0.1) for g in ("true", "observed", "none")},
    **{f"departure to 2 %, noise {100 * s:g} %": bent(s) for s in (0.001, 0.005, 0.02, 0.05)},
    "noise 0.5 %, a law to far better than the tolerance": noise(0.005, "true"),
}


def judge(make, draws, seed=7):
    """Bias and coverage of k and beta."""
    rng = np.random.default_rng(seed)
    off, held = [], []
    for _ in range(draws):
        r, std = make(rng)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)
            fit = fit_power_law(Z, r, std, initial_radius=R0)
        off.append((fit.k - 1, fit.beta - BETA))
        held.append((abs(fit.k - 1) < 1.96 * fit.k_std, abs(fit.beta - BETA) < 1.96 * fit.beta_std))
    bias, coverage = np.mean(off, axis=0), np.mean(held, axis=0)
    return {
        "k_bias": round(float(bias[0]), 4),
        "beta_bias": round(float(bias[1]), 4),
        "k_std": round(float(np.std(off, axis=0)[0]), 4),
        "k_coverage": float(coverage[0]),
        "beta_coverage": float(coverage[1]),
    }


def main():
    """All cases, one after the other; those that the file has already with as many draws stay."""
    draws = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    path = Path(__file__).with_suffix(".json")
    before = json.loads(path.read_text()) if path.exists() else {}
    found = before["cases"] if before.get("draws") == draws and "more" in sys.argv else {}
    for name, make in CASES.items():
        if name not in found and (len(sys.argv) < 4 or name == sys.argv[3]):
            found[name] = judge(make, draws)
            print(name, found[name], flush=True)
            path.write_text(json.dumps({"draws": draws, "cases": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
