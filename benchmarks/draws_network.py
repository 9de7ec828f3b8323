"""Random draws over the whole box: every network rung gives numbers within physical bounds, or an error by name.

Box, uniform in the logarithm: phi in [1e-6, 0.99], V in [1, 1e12], N_s in [1, 1e9], alpha_v in [1e-3, 1e15], I = 0 or in
[1e-12, 1e3]; the force laws in turn. Draw i of a seed does not depend on how many are drawn. Each takes:

* laws: the walk's closed forms and the force law at the extension V / V_S;
* walk: 16 strands of N_s segments under that force, and their exact moments;
* manifold: the steady network of a jet that reaches V;
* chain: every bead of the same jet, a few to some hundred of them, spacing from 1e-9 to 0.25, entering or fixed, for up to
  one and a half transits, at most so many steps and seconds.

Warnings are errors. What breaks a bound, or ends otherwise, is listed under "wrong" with its number.

    python benchmarks/draws_network.py [--draws 10000] [--first 0] [--seed 20261122] [--seconds 5] [--steps 400] [--out FILE]
"""

import argparse
import collections
import json
import time
import warnings
from pathlib import Path

import numpy as np

from spinline import network as net
from spinline.base.errors import InputError
from spinline.network import force_laws

LAWS = ("linear", "lattice", "langevin", "fene")
SEED = 20261122


class OutOfTimeError(Exception):
    """A draw that takes longer than allowed."""


def logarithmic(rng, least, most):
    return float(np.exp(rng.uniform(np.log(least), np.log(most))))


def scene(seed, i):
    """Parameters of draw i, and the rest of its stream."""
    rng = np.random.default_rng((seed, i))
    drawn = {
        "phi": logarithmic(rng, 1e-6, 0.99),
        "V": logarithmic(rng, 1.0, 1e12),
        "N_s": int(logarithmic(rng, 1.0, 1e9)),
        "alpha_v": logarithmic(rng, 1e-3, 1e15),
        "I": 0.0 if rng.random() < 0.3 else logarithmic(rng, 1e-12, 1e3),
        "law": LAWS[i % 4],
        "c": float(rng.choice([1.0, 3.0])),
    }
    # a jet that reaches V: the power law where that is not too far, else one that grows faster
    beta, onset = float(rng.uniform(0.25, 1.0)), float(rng.uniform(0.2, 3.0))
    length = onset * drawn["V"] ** (0.5 / beta)
    if length < 1e4 and drawn["V"] > 1.01:
        length = max(length, 1.5 * onset)
        drawn |= {"jet": "power", "length": length, "kinks": [onset]}
        return drawn, (lambda s: np.maximum(s / onset, 1.0) ** (2 * beta)), rng
    length, power = logarithmic(rng, 2.0, 1e3), float(rng.uniform(1.0, 4.0))
    top = np.log(drawn["V"])
    drawn |= {"jet": "exponential", "length": length, "kinks": []}
    return drawn, (lambda s: np.exp(top * (s / length) ** power)), rng


def bounded(value, low=-np.inf, high=np.inf):
    value = np.asarray(value, dtype=float)
    if not np.all(np.isfinite(value)):
        raise AssertionError("not finite")
    if not (np.all(value >= low) and np.all(value <= high)):
        raise AssertionError(f"outside [{low:g}, {high:g}]: {value.min():g} ... {value.max():g}")


def laws(drawn, profile, rng, *_):
    phi, v, rest = drawn["phi"], drawn["V"], 3 * drawn["phi"]
    for closure in ("force", "stretch"):
        state = net.affine_network(np.array([1.0, v]), phi, closure=closure)
        bounded(state.conformation.relative_extension, 0, 1)
        bounded(state.conformation.orientation, -0.5, 1)
        bounded(state.core_polymer_fraction, 0, 1)
        bounded(state.conformation.axial_stretch, 0)
    force = float(force_laws.force(phi * v, drawn["law"], rest))
    bounded(force, 0)
    bounded(force_laws.stiffness(phi * v, drawn["law"], rest), 0)
    # round trip, as far as double precision of x can tell
    back = float(force_laws.extension(force, drawn["law"], rest))
    bounded(back / (phi * v), 1 - 1e-9, 1 + 1e-9)


def walk(drawn, profile, rng, *_):
    phi, n, rest = drawn["phi"], drawn["N_s"], 3 * drawn["phi"]
    if rng.random() < 0.5:
        strand = net.affine_strand(drawn["V"], phi)
    else:
        x = min(phi * drawn["V"], 1 - 1e-15) if drawn["law"] != "linear" else phi * drawn["V"]
        strand = net.uniform_strand(n, float(force_laws.force(x, drawn["law"], rest)), rest)
    sample, exact = net.sample_strands(strand, 16, int(rng.integers(2**32))), net.walk_moments(strand)
    bounded(np.abs(sample.end_to_end).sum(axis=1) / strand.segments, 0, 1)
    bounded(exact.covariance)
    bounded(exact.relative_extension, -1e-12, 1 + 1e-12)
    bounded(exact.orientation, -0.5, 1 + 1e-12)
    spread = np.sqrt(np.diag(exact.covariance) / 16)
    off = np.abs(sample.end_to_end.mean(axis=0) - exact.mean)
    if np.any(off > 10 * spread + 2):  # ten standard errors, and a few strands where the law is Poisson-like
        raise AssertionError(f"mean off by {off} with standard errors {spread}")


def manifold(drawn, profile, rng, *_):
    tension = net.Tension.of(drawn["law"], 1 / drawn["phi"])
    found = net.steady_network(
        profile,
        drawn["length"],
        coupling=drawn["alpha_v"],
        spring=drawn["c"],
        inertia=drawn["I"],
        law=tension,
        breaks=drawn["kinks"],
        rtol=1e-7,
    )
    w = found.stretch(np.linspace(0, drawn["length"], 200))
    bounded(w, 1e-300, tension.full_stretch)
    bounded(found.tension(np.linspace(0, drawn["length"], 200)))


def chain(drawn, profile, rng, seconds, steps):
    flow = net.Flow.from_profiles([profile], [0.0], drawn["length"], rtol=1e-5, kinks=drawn["kinks"])
    transit = float(flow.residence_time(drawn["length"]))
    entry = bool(rng.random() < 0.7)
    spacing = transit / logarithmic(rng, 4, 300) if entry else logarithmic(rng, 1e-9, 0.1)
    contour = float(1 / drawn["phi"] if rng.random() < 0.5 else np.sqrt(drawn["N_s"]))
    made = net.Chain(
        flow=flow,
        spacing=min(spacing, 0.25 * drawn["length"], 1.0),
        coupling=drawn["alpha_v"],
        spring=drawn["c"],
        inertia=drawn["I"],
        law=drawn["law"],
        contour=contour,
        entry=entry,
    )
    if entry:
        start = "affine" if rng.random() < 0.3 else "empty"
    else:
        count = int(rng.integers(2, 60))
        stretch = float(rng.uniform(0.3, min(3.0, 0.9 * contour if drawn["law"] != "linear" else 3.0)))
        start = net.start_from(made, made.step * stretch * np.arange(count, 0, -1))
    begin = time.process_time()

    def late(state):
        if time.process_time() - begin > seconds:
            raise OutOfTimeError(f"step {state.steps} at time {state.time:g}")

    until = transit * float(rng.uniform(0.1, 1.5))
    result = net.run_chain(made, until, start=start, rtol=1e-3, most_steps=steps, progress=late)
    state, profile_ = result.state, result.profile
    bounded(state.positions, high=max(1e3, 1e3 * drawn["V"] * drawn["length"]))
    bounded(state.tensions)
    bounded(state.velocities)
    if drawn["I"] == 0:  # beads keep their order; heavy ones may overtake
        bounded(np.diff(state.positions), high=0)
    if drawn["law"] != "linear" and profile_.stretch.size:
        bounded(profile_.stretch, -contour * (1 + 1e-6), contour * (1 + 1e-6))
        bounded(profile_.relative_extension, -1, 1)
        if (np.diff(profile_.beads) > 0).all() and profile_.beads.size >= 6:
            between = np.linspace(profile_.beads[0], profile_.beads[-1], 50)
            bounded(profile_.stretch_at(between), high=contour)


PARTS = {"laws": laws, "walk": walk, "manifold": manifold, "chain": chain}


def outcome(part, drawn, profile, rng, seconds, steps):
    """ "answered", or what it ended with: "refused: field", "chain stopped: why", "wrong: ..."."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            PARTS[part](drawn, profile, rng, seconds, steps)
    except InputError as error:
        return f"refused: {error.field}"
    except net.ChainError as error:
        kinds = {"most_steps": f"more than {steps} steps", "step below": "step too small", "rounding": "step too small"}
        return "stopped: " + next((kind for word, kind in kinds.items() if word in str(error)), str(error))
    except OutOfTimeError:
        return f"out of time: {seconds:g} s"
    except Exception as error:  # everything else is what the campaign looks for
        return f"wrong: {type(error).__name__}: {error}"
    return "answered"


def campaign(seed, numbers, seconds, steps, parts=tuple(PARTS)):
    """Outcomes counted by part and law, and the draws that went wrong."""
    counts = {part: {law: collections.Counter() for law in LAWS} for part in parts}
    cost = dict.fromkeys(parts, 0.0)
    wrong = []
    for i in numbers:
        drawn, profile, rng = scene(seed, i)
        streams = rng.spawn(len(PARTS))
        for part, stream in zip(PARTS, streams, strict=True):
            if part not in parts:
                continue
            begin = time.process_time()
            end = outcome(part, drawn, profile, stream, seconds, steps)
            cost[part] += time.process_time() - begin
            counts[part][drawn["law"]][end.split(": ")[0] if end.startswith("wrong") else end] += 1
            if end.startswith("wrong"):
                wrong.append({"draw": i, "part": part, "end": end, **drawn})
    return counts, cost, wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--draws", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--steps", type=int, default=400)
    parser.add_argument("--parts", nargs="*", default=list(PARTS))
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    campaign(given.seed, range(4), 600.0, 100, tuple(given.parts))  # compiles
    total, costs, wrong = None, collections.Counter(), []
    for low in range(given.first, given.first + given.draws, 250):
        numbers = range(low, min(low + 250, given.first + given.draws))
        counts, cost, bad = campaign(given.seed, numbers, given.seconds, given.steps, tuple(given.parts))
        costs.update(cost)
        wrong += bad
        total = counts if total is None else total
        if total is not counts:
            for part, by_law in counts.items():
                for law, counter in by_law.items():
                    total[part][law].update(counter)
        summary = {
            "seed": given.seed,
            "first": given.first,
            "draws": numbers[-1] + 1 - given.first,
            "steps": given.steps,
            "seconds": given.seconds,
            "outcomes": {p: {law: dict(sorted(c.items())) for law, c in by.items()} for p, by in total.items()},
            "cpu_seconds": {part: round(value, 1) for part, value in costs.items()},
            "wrong": wrong,
        }
        print(f"{summary['draws']} draws, {sum(costs.values()):.0f} s, {len(wrong)} wrong", flush=True)
        if given.out:
            given.out.write_text(json.dumps(summary, indent=1) + "\n")
    for part, by_law in total.items():
        for law, counter in by_law.items():
            print(f"  {part:9s} {law:9s} " + ", ".join(f"{n} {end}" for end, n in counter.most_common()))
    for bad in wrong[:20]:
        print(f"  {bad}")
    raise SystemExit(bool(wrong))


if __name__ == "__main__":
    main()
