"""Random two-fluid networks over the whole box: answered and right, or refused by name; the far end of random elastic jets.

    python benchmarks/draws_two_fluid.py [draws]

"Wrong" is checked on every answer by what it does not share with the solver: bounds, and the integrals of momentum and
relaxation over a piece of the jet by Gauss's rule, to 1e-3 of their terms. Writes draws_two_fluid.json.
"""

import json
import sys
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.network.tension import Tension
from spinline.network.two_fluid import two_fluid_network

LAWS = ("linear", "lattice", "langevin", "fene")


def draw(rng, realistic):
    """One network: real jets (alpha_v 10 to 1e8, th 1e-2 to 1e3), or anything."""
    if realistic:
        alpha, th, phi = 10 ** rng.uniform(1, 8), 10 ** rng.uniform(-2, 3), 10 ** rng.uniform(-2, np.log10(0.4))
        beta, length = rng.uniform(0.3, 0.7), 10 ** rng.uniform(1, 2.5)
    else:
        alpha, th, phi = 10 ** rng.uniform(-3, 15), 10 ** rng.uniform(-6, 8), 10 ** rng.uniform(-4, np.log10(0.9))
        beta, length = rng.uniform(0.25, 1), 10 ** rng.uniform(0.3, 4)
    return {
        "alpha": alpha,
        "th": th,
        "phi": phi,
        "beta": beta,
        "length": length,
        "law": str(rng.choice(LAWS)),
        "end": str(rng.choice(["free", "take-up", "extended"])),
        "known_to": float(rng.choice([length, np.inf])),
    }


def solve(one):
    def profile(s):
        return np.maximum(s, 1.0) ** (2 * one["beta"])

    return profile, two_fluid_network(
        profile,
        one["length"],
        coupling=one["alpha"],
        relaxation_time=one["th"],
        law=Tension.of(one["law"], 1 / one["phi"]),
        breaks=[1.0],
        end=one["end"],
        known_to=one["known_to"],
        rtol=1e-5,
    )


def faults(one, profile, network):
    """What is wrong with an answer; empty where nothing is."""
    s = np.linspace(0, one["length"], 101)
    w, lam = network.velocity_ratio(s), network.stretch(s)
    if not (np.isfinite(w).all() and (w > 0).all() and np.isfinite(lam).all() and (lam > 0).all()):
        return "not finite and positive"
    if (lam > network.law.full_stretch).any():
        return "beyond the contour"
    a, b = 0.4 * one["length"], 0.6 * one["length"]
    a, b = (a, b) if a > 1 else (min(1.0, 0.5 * one["length"]), one["length"] * 0.9)
    edges = np.unique(np.concatenate((np.linspace(a, b, 41), network.nodes[(network.nodes > a) & (network.nodes < b)])))
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    x, weight = np.polynomial.legendre.leggauss(4)
    at = (middle[:, None] + half[:, None] * x).ravel()
    sums = (half[:, None] * weight).ravel()
    w, lam, t = network.velocity_ratio(at), network.stretch(at), network.tension(at)
    eps = 3 / one["alpha"]
    line = [float(network.stretch(p) / network.velocity_ratio(p) * network.tension(p)) for p in (a, b)]
    pull, size = float(sums @ (1 - profile(at) / w)), float(sums @ np.abs(1 - profile(at) / w))
    if abs(eps * (line[1] - line[0]) - pull) > 1e-3 * (eps * max(line) + size) + 2e-5 * (b - a):
        return "momentum"
    given = [float(np.log(network.velocity_ratio(p) / network.stretch(p))) for p in (a, b)]
    slack = float(sums @ ((t - network.law.tension_at_rest / lam) / (2 * one["th"] * lam * w)))
    if abs(given[1] - given[0] - slack) > 2e-3 * (1 + abs(slack)):
        return "relaxation"
    return ""


def campaign(draws, realistic, seed):
    rng, outcomes, wrong, seconds = np.random.default_rng(seed), Counter(), [], []
    for _ in range(draws):
        one = draw(rng, realistic)
        begin = time.perf_counter()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                fault = faults(one, *solve(one))
        except InputError as error:
            outcomes[f"refused: {error.field}"] += 1
            continue
        except Warning as warning:
            outcomes["warned"] += 1
            wrong.append({**one, "known_to": str(one["known_to"]), "fault": str(warning)})
            continue
        seconds.append(time.perf_counter() - begin)
        outcomes["wrong" if fault else "answered"] += 1
        if fault:
            wrong.append({**one, "known_to": str(one["known_to"]), "fault": fault})
    return {
        "draws": draws,
        "outcomes": dict(sorted(outcomes.items())),
        "median_ms": round(1e3 * float(np.median(seconds)), 1),
        "percentile_95_ms": round(1e3 * float(np.percentile(seconds, 95)), 1),
        "wrong": wrong[:20],
    }


def main():
    draws = int(sys.argv[1]) if len(sys.argv) > 1 else 5000
    two_fluid_network(lambda s: 1 + s, 3.0, coupling=10.0, relaxation_time=1.0, law=Tension.of("fene", 9.0))  # compiles
    found = {name: campaign(draws, name == "real jets", seed) for seed, name in enumerate(("real jets", "anything"))}
    print(json.dumps(found, indent=1))
    Path(__file__).with_suffix(".json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
