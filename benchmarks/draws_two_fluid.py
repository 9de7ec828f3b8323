"""Random two-fluid networks over the whole box: answered and right, or refused by name; the far end of random elastic jets.

    python benchmarks/draws_two_fluid.py [draws] [first]

Even draws are real jets, odd ones anything; draw i of the seed does not depend on how many are drawn. "Wrong" is checked on
every answer by what it does not share with the solver: bounds, and the integrals of momentum and relaxation over a piece of
the jet by Gauss's rule, to 1e-3 of their terms. Writes draws_two_fluid.json; a run that starts where the file ends is added to
it.
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

SEED = 20261129
EDGES = (25, 50, 100, 200, 500, 1000, 5000, 100_000)  # of processor time, ms
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


def outcome(i):
    """What became of draw i, its processor time in ms (NaN where it is refused), and the draw where it is wrong."""
    one = draw(np.random.default_rng((SEED, i)), i % 2 == 0)
    begin, bad = time.process_time(), {**one, "draw": i, "known_to": str(one["known_to"])}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            solution = solve(one)
            spent = 1e3 * (time.process_time() - begin)
            fault = faults(one, *solution)
    except InputError as error:
        return f"refused: {error.field}", np.nan, None
    except Warning as warning:
        return "warned", np.nan, bad | {"fault": str(warning)}
    except Exception as error:  # everything else is what the campaign looks for
        return "failed", np.nan, bad | {"fault": f"{type(error).__name__}: {error}"}
    return ("wrong", spent, bad | {"fault": fault}) if fault else ("answered", spent, None)


def main():
    draws = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    path = Path(__file__).with_suffix(".json")
    before = json.loads(path.read_text()) if path.exists() else {}
    before = before if first and before.get("draws") == first else {}
    two_fluid_network(lambda s: 1 + s, 3.0, coupling=10.0, relaxation_time=1.0, law=Tension.of("fene", 9.0))  # compiles
    names = ("real jets", "anything")
    counts = [Counter(before.get(name, {}).get("outcomes", {})) for name in names]
    cost = [Counter({int(k): v for k, v in before.get(name, {}).get("ms_below", {}).items()}) for name in names]
    wrong = list(before.get("wrong", []))
    for i in range(first, first + draws):
        what, spent, bad = outcome(i)
        counts[i % 2][what] += 1
        if np.isfinite(spent):
            cost[i % 2][int(min(edge for edge in EDGES if spent <= edge))] += 1
        if bad is not None:
            wrong.append(bad)
    found = {"seed": SEED, "draws": first + draws}
    for name, count, spent in zip(names, counts, cost, strict=True):
        found[name] = {"outcomes": dict(sorted(count.items())), "ms_below": {str(k): spent[k] for k in sorted(spent)}}
    found["wrong"] = wrong
    print(json.dumps(found))
    path.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
