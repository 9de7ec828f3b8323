"""Entanglements left along random histories of the flow over the whole box, reversals among them: nu in (0, 1], or refused.

    python benchmarks/entanglements_box.py [histories] [first]

Box, uniform in the logarithm: tau_d 1e-4 to 1e4 s, tau_R from tau_d to 1e-6 of it, N_s 4 to 1e7 or endless; rates of either
sign up to 1e4/tau_d, in 1 to 12 pieces with rests among them, over 0.01 to 100 tau_d, the material stretch within e^-12 and
e^25; beta in [0, 1], beta_c in [0, 1], one in ten up to 10; with and without strain rates given. History i of the seed does not
depend on how many are followed.

"Wrong" is: nu outside of (0, 1], strands beyond their contour, what is not finite, a warning. Every hundredth history is
followed a second time by the equations as printed (full tensor, Radau) and must agree to 1e-4. Writes
entanglements_box.json; a run that starts where the file ends is added to it.
"""

import json
import sys
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from spinline.base.errors import InputError
from spinline.network.disentanglement import disentangle

SEED = 20261129
AGREES = 1e-4


def history(i):
    """Arguments of history i."""
    rng = np.random.default_rng((SEED, i))
    slow = 10 ** rng.uniform(-4, 4)
    pieces, each = int(rng.integers(1, 13)), int(rng.integers(3, 20))
    over = slow * 10 ** rng.uniform(-2, 2)
    t = np.linspace(0, over, pieces * each + 1)
    rate = rng.choice([-1.0, 1.0], pieces, p=[0.35, 0.65]) * 10 ** rng.uniform(-2, 4, pieces) / slow
    rate[rng.random(pieces) < 0.15] = 0.0
    fine = np.repeat(rate, each)
    log = np.concatenate(([0.0], np.cumsum(fine * np.diff(t))))
    steep = max(log.max() / 25, -log.min() / 12, 1.0)
    log, rate = log / steep, rate / steep
    smooth = pieces == 1 or rng.random() < 0.5
    return {
        "time": t,
        "stretch_ratio": np.exp(log),
        "disengagement_time": slow,
        "rouse_time": slow * 10 ** rng.uniform(-6, 0),
        "segments": np.inf if rng.random() < 0.2 else float(10 ** rng.uniform(np.log10(4), 7)),
        "release": float(rng.uniform(0, 1)),
        "entanglement_release": float(rng.uniform(0, 10 if rng.random() < 0.1 else 1)),
        "strain_rate": np.gradient(log, t) if smooth else None,
        "rtol": float(rng.choice([1e-6, 1e-7, 1e-9])),
    }, bool((rate > 0).any() and (rate < 0).any())


def as_printed(one):
    """A_zz, A_rr and nu at the end by the equations of the full tensor, piece by piece, as the samples are read."""
    from spinline.rheology._element_history import ElementHistory

    read = ElementHistory.build(one["time"], one["stretch_ratio"], one["disengagement_time"], one["strain_rate"])
    t, slow, fast = read.time, one["disengagement_time"], one["rouse_time"]
    y, spots = np.append(np.eye(3).ravel(), 1.0), np.arange(t.size - 1)
    for i in spots:
        h = t[i + 1] - t[i]
        secant = np.log(one["stretch_ratio"][i + 1] / one["stretch_ratio"][i]) / h
        bend = read.first_rate[i] + read.last_rate[i] - 2 * secant

        def rates(at, y, i=i, h=h, bend=bend):
            u = (at - t[i]) / h
            rate = read.first_rate[i] + u * (read.last_rate[i] - read.first_rate[i] - 3 * bend + u * 3 * bend)
            a, nu = y[:9].reshape(3, 3), y[9]
            kappa, trace = rate * np.diag([1.0, -0.5, -0.5]), np.trace(a)
            lam = np.sqrt(trace / 3)
            most = one["segments"] / (3 * nu)
            stiff = 1.0 if np.isinf(most) else (most - 1) / (most - lam**2)
            back = 2 * stiff * (1 - 1 / lam) / fast
            da = kappa @ a + a @ kappa.T - (a - np.eye(3)) / slow - back * (a + one["release"] / lam * (a - np.eye(3)))
            grows = np.trace(da) / (6 * lam**2)
            pull = rate * (a[0, 0] - a[1, 1]) / trace - grows
            return np.append(da.ravel(), (1 - nu) / slow - one["entanglement_release"] * nu * max(pull, 0.0))

        found = solve_ivp(rates, (t[i], t[i + 1]), y, method="Radau", rtol=1e-8, atol=1e-13)
        if not found.success:
            return None
        y = found.y[:, -1]
    return y[[0, 4, 9]]


def follow(i):
    """Outcome of history i: "answered", "refused: field" or what is wrong."""
    one, turns = history(i)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            state = disentangle(**one)
        except InputError as error:
            return f"refused: {error.field}", turns, np.nan
        except Exception as error:  # everything else is what is looked for
            return f"wrong: {type(error).__name__}: {error}", turns, np.nan
    nu, trace = state.entanglements_left, state.axial + 2 * state.radial
    if not (
        np.isfinite(nu).all() and np.isfinite(trace).all() and (state.axial > 0).all() and (state.radial > 0).all()
    ):
        return "wrong: not finite and positive", turns, np.nan
    if not ((nu > 0).all() and (nu <= 1).all()):
        return f"wrong: nu in {nu.min():g} ... {nu.max():g}", turns, np.nan
    if not (trace * nu < one["segments"]).all():
        return "wrong: beyond the contour", turns, np.nan
    if i % 100 == 0:
        again = as_printed(one)
        if again is not None:
            off = np.abs(np.array([state.axial[-1], state.radial[-1], nu[-1]]) / again - 1).max()
            if off > max(AGREES, 1e3 * one["rtol"]):
                return f"wrong: {off:.2g} off the equations as printed", turns, np.nan
            return "answered, agrees with the equations as printed", turns, float(nu.min())
    return "answered", turns, float(nu.min())


def main():
    histories = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    path = Path(__file__).with_suffix(".json")
    before = json.loads(path.read_text()) if path.exists() else {}
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    add = before if first and before.get("histories") == first else {}
    counts, wrong = Counter(add.get("outcomes", {})), list(add.get("wrong", []))
    reversals, least = add.get("reversals", 0), add.get("least nu", 1.0)
    began = time.process_time()
    for i in range(first, first + histories):
        outcome, turns, nu = follow(i)
        counts[outcome.split(": ")[0] if outcome.startswith("wrong") else outcome] += 1
        reversals += turns
        least = min(least, nu) if np.isfinite(nu) else least
        if outcome.startswith("wrong"):
            wrong.append({"history": i, "outcome": outcome})
    found = {
        "seed": SEED,
        "histories": first + histories,
        "reversals": int(reversals),
        "outcomes": dict(sorted(counts.items())),
        "least nu": float(least),
        "cpu_seconds": round(add.get("cpu_seconds", 0.0) + time.process_time() - began, 1),
        "wrong": wrong,
    }
    print(json.dumps(found))
    path.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
