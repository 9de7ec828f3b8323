"""Random two-fluid networks over the whole box: answered and right, or refused by name; the far end of random elastic jets.

    python benchmarks/draws_two_fluid.py [until] [workers] [minutes]      # default: 10,000 draws, one, an hour

Even draws are real jets, odd ones anything; draw i of the seed does not depend on how many are drawn. "Wrong" is checked on
every answer by what it does not share with the solver: bounds, strands that enter at rest, and the integrals of momentum and
relaxation over three pieces of the jet by Gauss's rule, to 1e-3 of their terms. Every fiftieth draw is solved again by scipy's
`solve_bvp`, from equations and force laws written down here, between the nozzle and the tension at the last station, and must
agree to 1e-4 where that converges. Goes on from where draws_two_fluid.json ends, and writes it every 100 draws.
"""

import itertools
import json
import multiprocessing
import sys
import time
import warnings
from collections import Counter
from contextlib import nullcontext
from pathlib import Path

import numpy as np
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from spinline.base.errors import InputError
from spinline.network.tension import Tension
from spinline.network.two_fluid import two_fluid_network

SEED = 20261129
EDGES = (25, 50, 100, 200, 500, 1000, 5000, 100_000)  # of processor time, ms
LAWS = ("linear", "lattice", "langevin", "fene")
AGAIN = 50  # draws for one that is solved again
AGREES = 1e-4
NODES = 20_000  # at most, of the second solution
PIECE = 100  # draws between two writes


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
    if abs(lam[0] / w[0] - 1) > 1e-9:
        return "strands do not enter at rest"
    cuts = [0.0, 0.4 * one["length"], 0.6 * one["length"], one["length"]]
    said = (unbalanced(one, profile, network, a, b) for a, b in itertools.pairwise(cuts))
    return next((words for words in said if words), "")


def unbalanced(one, profile, network, a, b):
    """Whether momentum or relaxation does not add up between two places."""
    inner = network.nodes[(network.nodes > a) & (network.nodes < b)]
    edges = np.unique(np.concatenate((np.linspace(a, b, 41), inner, [1.0] if a < 1 < b else [])))
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    x, weight = np.polynomial.legendre.leggauss(4)
    at = np.clip((middle[:, None] + half[:, None] * x).ravel(), a, b)
    sums = (half[:, None] * weight).ravel()
    w, lam, t = network.velocity_ratio(at), network.stretch(at), network.tension(at)
    eps = 3 / one["alpha"]
    line = [float(network.stretch(p) / network.velocity_ratio(p) * network.tension(p)) for p in (a, b)]
    pull, size = float(sums @ (1 - profile(at) / w)), float(sums @ np.abs(1 - profile(at) / w))
    if abs(eps * (line[1] - line[0]) - pull) > 1e-3 * (eps * max(line) + size) + 2e-5 * (b - a):
        return f"momentum between {a:g} and {b:g}"
    given = [float(np.log(network.velocity_ratio(p) / network.stretch(p))) for p in (a, b)]
    slack = float(sums @ ((t - network.law.tension_at_rest / lam) / (2 * one["th"] * lam * w)))
    if abs(given[1] - given[0] - slack) > 2e-3 * (1 + abs(slack)):
        return f"relaxation between {a:g} and {b:g}"
    return ""


def stretch_of(one, t):
    """Stretch of a strand that bears T, by the laws as they are in books."""
    if one["law"] == "linear":
        return t
    full = 1 / one["phi"]
    rest, f = 3 / full, t * 3 / full
    if one["law"] == "fene":
        return full * 2 * f / (3 + np.sqrt(9 + 4 * f**2))
    if one["law"] == "langevin":
        small = np.abs(f) < 1e-2
        g = np.where(small, 1.0, f)
        return full * np.where(small, f / 3 - f**3 / 45, 1 / np.tanh(np.clip(g, -300, 300)) - 1 / g)
    top = np.maximum(np.abs(f), rest)
    up, down, side = np.exp(f - top), np.exp(-f - top), np.exp(rest - top) + np.exp(-rest - top)
    return full * (up - down) / (up + down + 2 * side)


def solved_again(one, profile, network):
    """Largest relative difference of w and lam from `solve_bvp` at 101 stations; NaN where that does not converge."""
    eps, th, far = 3 / one["alpha"], one["th"], one["length"]
    loose = at_rest(one)

    def rates(s, y):
        t = y[0] * np.exp(-y[1])
        lam, share = stretch_of(one, t), np.exp(y[1])
        slack = t - loose / lam
        return np.stack(((1 - profile(s) * share / lam) / eps, -slack * share / (2 * th * lam**2)))

    nodes = np.unique(np.append(network.nodes[network.nodes < far], [min(1.0, far), far]))
    w, lam, t = network.velocity_ratio(nodes), network.stretch(nodes), network.tension(nodes)
    end = float(t[-1] * lam[-1] / w[-1])
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):  # of its trials, whose stretch may be anything
        found = solve_bvp(
            rates,
            lambda a, b: np.array([a[1], b[0] / end - 1]),
            nodes,
            np.stack((t * lam / w, np.log(lam / w))),
            tol=1e-6,
            max_nodes=NODES,
        )
    if not found.success:
        return np.nan
    s = np.linspace(0, far, 101)
    force, q = found.sol(s)
    there = stretch_of(one, force * np.exp(-q))
    off = np.abs(there / network.stretch(s) - 1), np.abs(there * np.exp(-q) / network.velocity_ratio(s) - 1)
    return float(np.max(off))


def at_rest(one):
    """T(1) by the laws here."""
    return brentq(lambda t: float(stretch_of(one, np.asarray(t))) - 1, 1e-3, 1e3, xtol=1e-14, rtol=1e-14)


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
            off = solved_again(one, *solution) if i % AGAIN == 0 and not fault else 0.0
    except InputError as error:
        return f"refused: {error.field}", np.nan, None
    except Warning as warning:
        return "warned", np.nan, bad | {"fault": str(warning)}
    except Exception as error:  # everything else is what the campaign looks for
        return "failed", np.nan, bad | {"fault": f"{type(error).__name__}: {error}"}
    if off > AGREES:
        fault = f"{off:.2g} off the second solution"
    if fault:
        return "wrong", spent, bad | {"fault": fault}
    return "answered" + ("" if i % AGAIN else ", no second solution" if np.isnan(off) else ", twice"), spent, None


def warm():
    """Compile."""
    two_fluid_network(lambda s: 1 + s, 3.0, coupling=10.0, relaxation_time=1.0, law=Tension.of("fene", 9.0))


def main():
    until, workers, minutes = (float(x) for x in [*sys.argv[1:], *("10000", "1", "60")[len(sys.argv) - 1 :]])
    path = Path(__file__).with_suffix(".json")
    found = json.loads(path.read_text()) if path.exists() else {"seed": SEED, "draws": 0}
    names = ("real jets", "anything")
    counts = [Counter(found.get(name, {}).get("outcomes", {})) for name in names]
    cost = [Counter({int(k): v for k, v in found.get(name, {}).get("ms_below", {}).items()}) for name in names]
    wrong, first, began = list(found.get("wrong", [])), found["draws"], time.monotonic()
    warm()
    with multiprocessing.get_context("spawn").Pool(int(workers), warm) if workers > 1 else nullcontext() as pool:
        for start in range(first, int(until), PIECE):
            if time.monotonic() - began > 60 * minutes:
                break
            these = range(start, min(start + PIECE, int(until)))
            for i, (what, spent, bad) in zip(
                these, pool.imap(outcome, these, chunksize=10) if pool else map(outcome, these), strict=True
            ):
                counts[i % 2][what] += 1
                if np.isfinite(spent):
                    cost[i % 2][int(min(edge for edge in EDGES if spent <= edge))] += 1
                if bad is not None:
                    wrong.append(bad)
                    print(bad, flush=True)
            found = {"seed": SEED, "draws": these[-1] + 1}
            for name, count, spent in zip(names, counts, cost, strict=True):
                found[name] = {
                    "outcomes": dict(sorted(count.items())),
                    "ms_below": {str(k): spent[k] for k in sorted(spent)},
                }
            found["wrong"] = wrong
            path.write_text(json.dumps(found, indent=1) + "\n")
    print(json.dumps(found))


if __name__ == "__main__":
    main()
