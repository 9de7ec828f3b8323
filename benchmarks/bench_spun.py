"""Spun jets: convergence, cost, the charge's sums, and what is left of a whipping jet's statistics under refinement.

    python benchmarks/bench_spun.py [PART ...] [-o benchmarks/bench_spun.json]

Parts: many, orders, published, sums, whipping, whole. Each is written to the JSON file by itself; times are processor time,
to be read as ratios within one run.
"""

import itertools
import json
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from spun_cases import material, pvp, radii, rotating, spun  # noqa: E402

from spinline.jetprofile.spun import _codes as c  # noqa: E402
from spinline.jetprofile.spun._tree_kernels import direct_sum, pair_sum, tree_sum  # noqa: E402
from spinline.jetprofile.spun.chain import start_cylinder  # noqa: E402
from spinline.jetprofile.spun.run import SpunRun  # noqa: E402
from spinline.jetprofile.spun.settings import Air, Collector  # noqa: E402

STATIONS = np.array([0.05, 0.1, 0.2, 0.5, 1, 2, 4]) * 1e-2
FAST = np.array([49.603603, 49.236240, 48.567133, 46.887374, 44.685253, 41.464606, 37.349450]) * 1e-6


def orders():
    """Radii of the uncharged jets and material points of the bent ones, grid by grid."""
    out = {}
    grids = (8e-4, 4e-4, 2e-4, 1e-4)
    worst = [float(np.abs(radii(spun(pvp(g, 6.0, stress="given"), 12e-3), STATIONS) / FAST - 1).max()) for g in grids]
    out["fast jet, worst radius against the exact one"] = dict(zip(map(str, grids), worst, strict=True))
    slow = {g: radii(spun(pvp(g), 20e-3), STATIONS) for g in (4e-4, 2e-4, 1e-4, 5e-5)}
    out["slow jet, settled: orders"] = np.log2(np.abs((slow[2e-4] - slow[1e-4]) / (slow[1e-4] - slow[5e-5]))).tolist()
    out["slow jet: 0.2 and 0.1 mm against 0.05 mm"] = [
        float(np.abs(slow[g] / slow[5e-5] - 1).max()) for g in (2e-4, 1e-4)
    ]
    for charge in (0.0, 4400.0, 8800.0):
        at = np.array([0.1, 0.25, 0.4, 0.6, 0.8, 0.9]) * (1.6e-2)
        found = []
        for g in (4e-4, 2e-4, 1e-4, 5e-5):
            kind = {"repulsion": "hybrid", "charge": charge} if charge else {"repulsion": "none"}
            s = rotating(pvp(g, tolerance=1e-7, **kind), 2000.0, load_ramp=2e-3 if charge else 0.0)
            found.append(material(spun(s, 8e-3), at))
        apart = [np.linalg.norm(a - b, axis=1) for a, b in itertools.pairwise(found)]
        out[f"bent jet, {charge:g} statC/cm3" if charge else "bent jet, field but no repulsion"] = {
            "x": found[-1][:, 0].tolist(),
            "off the axis": np.hypot(found[-1][:, 1], found[-1][:, 2]).tolist(),
            "between grids": [a.tolist() for a in apart],
            "last order": np.log2(apart[-2] / apart[-1]).tolist(),
        }
    return out


def published():
    """PVP with its whole charge and its flow rate given; and the cost of 10 ms of the bent jet."""
    at = np.array([0.1, 0.2, 0.5, 1.0]) * 1e-2
    rows = {}
    for g in (2e-4, 1e-4, 5e-5):
        rows[str(g)] = radii(spun(pvp(g, repulsion="hybrid", near=4, pressure=False), 4e-3), at).tolist()
    out = {"radii at 0.1, 0.2, 0.5, 1 cm after 4 ms, m": rows}
    s = rotating(pvp(2e-4, repulsion="hybrid", near=4, pressure=False), 1e4, ramp=5e-4)
    spun(s, 1e-4)
    begun = time.process_time()
    chain = spun(s, 10e-3)
    out["10 ms bent"] = {"elements": chain.n, "seconds": time.process_time() - begun, "steps": int(chain.clock[5])}
    return out


def sums():
    """All pairs against the tree on a widening helix; beyond 10^4 a sample of targets stands for all (a point's own term has no
    direction)."""
    out = {}
    small = np.zeros((40, 3))
    small[:, 0] = np.arange(40.0)
    for _ in range(2):  # compile
        pair_sum(small, np.ones(40), np.ones(40), np.zeros((40, 3)), np.zeros(40), np.zeros(40))
        tree_sum(
            small, np.ones(40), small, np.ones(40), np.ones(40), 0.3, np.zeros((40, 3)), np.zeros(40), np.zeros(40)
        )
        direct_sum(small, np.ones(40), small, np.ones(40), np.ones(40), np.zeros((40, 3)))
    for n in (300, 1000, 3000, 10000, 30000, 100000):
        turn, far, wide = np.linspace(0, 40 * np.pi, n), np.linspace(0, 0.16, n), np.linspace(1e-5, 0.04, n)
        x = np.stack([far, wide * np.cos(turn), wide * np.sin(turn)], axis=-1)
        q, a2 = np.full(n, 1e-12), np.full(n, 2.5e-11)
        pick = np.arange(n) if n <= 10000 else np.arange(0, n, n // 1000)
        exact = np.zeros((len(pick), 3))
        begun = time.process_time()
        if n <= 10000:
            pair_sum(x, q, a2, exact, np.zeros(n), np.zeros(n))
            direct = time.process_time() - begun
        else:
            direct_sum(x[pick], a2[pick], x, q, a2, exact)
            direct = (time.process_time() - begun) * n / len(pick) / 2  # each pair once
        field, spare, level = np.zeros((n, 3)), np.zeros(n), np.zeros(n)
        begun = time.process_time()
        tree_sum(x, a2, x, q, a2, 0.3, field, spare, level)
        took = time.process_time() - begun
        error = np.linalg.norm(field[pick] - exact, axis=1)
        size = np.linalg.norm(exact, axis=1)
        out[str(n)] = {
            "direct s": direct,
            "tree s": took,
            "ratio": direct / took,
            "rms error": float(np.sqrt((error**2).mean() / (size**2).mean())),
            "worst": float((error / size).max()),
        }
    took = [out[str(n)]["tree s"] for n in (10000, 100000)]
    out["cost exponent, 1e4 to 1e5"] = float(np.log10(took[1] / took[0]))
    return out


def whipping():
    """Landing of a noisy, circling jet: 16 seeds on two grids; a t-interval over seeds."""
    from scipy.stats import t as student

    out = {}
    for g in (4e-4, 2e-4):
        base = rotating(pvp(g, repulsion="hybrid", near=4, pressure=False), 1e4, ramp=5e-4)
        base = replace(
            base,
            collector=Collector("plate"),
            surface_tension=0.021133,
            air=Air(xi=0.0, lift=False, noise=1e-9, interval=2e-5, grain=1e-13),
        )
        rows = []
        for seed in range(16):
            run = SpunRun.start(replace(base, seed=seed))
            run.advance(24e-3)
            d = run.chain.deposited
            late = d[:, c.D_TIME] > 16e-3
            y, z = d[late, c.D_Y1], d[late, c.D_Z1]
            turn = np.unwrap(np.arctan2(z, y))
            at = d[late, c.D_TIME]
            thin = np.sqrt(d[late, c.D_VOLUME] / (np.pi * d[late, c.D_FLIGHT]))
            rows.append(
                [
                    np.hypot(y, z).mean(),
                    np.degrees(2 * np.arctan(np.hypot(y, z).mean() / 0.16)),
                    thin.mean(),
                    abs(np.polyfit(at, turn, 1)[0]) / (2 * np.pi),
                ]
            )
        rows = np.array(rows)
        half = student.ppf(0.975, 15) * rows.std(axis=0, ddof=1) / 4
        names = ("landing radius m", "2 atan(R/h) deg", "radius at the collector m", "turns per s")
        out[str(g)] = {k: [float(m), float(h)] for k, m, h in zip(names, rows.mean(axis=0), half, strict=True)}
    first, second = out.values()
    out["moves by (in intervals of the finer grid)"] = {
        k: abs(first[k][0] - second[k][0]) / max(second[k][1], 1e-300) for k in first
    }
    return out


def whole():
    """A whole jet whose charge moves, circled at the needle by 20 um and not: time means of the straight part, per cent."""
    from test_spun_whole import _needle, _spun

    from spinline.jetprofile.ehd import StraightEhdJet
    from spinline.jetprofile.spun._chain_kernels import geometry
    from spinline.jetprofile.spun.chain import parameters

    at = np.array([2, 5, 10, 15, 20]) * 1e-3
    needle = _needle(relaxation_time=2e-3, conductivity=0.1)
    straight = StraightEhdJet(needle, length=needle.gap)
    means, out = [], {"z": at.tolist()}
    for amplitude in (20e-6, 0.0):
        run = SpunRun.start(_spun(needle, amplitude, element_length=12e-6, longest=1e-3))
        rows = []
        for moment in np.arange(1, 31) * 0.2e-3:
            run.chain.march(moment)
            if moment < 3e-3:
                continue
            chain = run.chain
            n, y = chain.n, chain.nodes
            w = np.zeros((c.WORK, len(chain.state)))
            geometry(n, chain.state, *parameters(chain.settings), w)
            pull = w[c.POLYMER, :n] + 3 * w[c.SOLVENT_HERE, :n] * w[c.RATE, :n] * w[c.AREA, :n]
            there = (np.sqrt(w[c.AREA, :n] / np.pi), pull, y[:n, c.CHARGE] / w[c.LENGTH, :n])
            middle = (0.5 * (y[1:, c.X] + y[:-1, c.X]))[::-1]
            rows.append([np.interp(at, middle, v[::-1]) for v in there])
        means.append(np.mean(rows, axis=0))
        if amplitude:
            out["farthest off the axis, m"] = float(np.hypot(y[:, c.Y], y[:, c.Z]).max())
    steady = np.array([straight.radius(at), straight.tension(at), straight.line_charge(at)])
    names = ("radius", "tension", "line charge")
    against = {
        "bent against unbent": means[0] / means[1] - 1,
        "unbent against the needle's (local logarithm)": means[1] / steady - 1,
    }
    for title, off in against.items():
        out[title] = {name: (100 * row).round(3).tolist() for name, row in zip(names, off, strict=True)}
    return out


def many():
    """A few steps of charged straight jets of up to 1e5 elements: seconds a step, and the exponent of the cost."""
    out = {}
    for n in (1000, 10000, 100000):
        chain = start_cylinder(pvp(0.1 / n, charge=8800.0, repulsion="hybrid", start=0.1))
        chain.march(1e-12)
        begun, before = time.process_time(), chain.clock[5]
        chain.march(0.2 * 0.1 / n / 1.75)
        took = (time.process_time() - begun) / (chain.clock[5] - before)
        out[str(chain.n)] = {"seconds a step": took, "finite": bool(np.isfinite(chain.nodes).all())}
    first, last = (out[n]["seconds a step"] for n in ("10000", "100000"))
    out["cost exponent, 1e4 to 1e5"] = float(np.log10(last / first))
    return out


PARTS = {"many": many, "orders": orders, "published": published, "sums": sums, "whipping": whipping, "whole": whole}

if __name__ == "__main__":
    target = Path(sys.argv[sys.argv.index("-o") + 1]) if "-o" in sys.argv else ROOT / "benchmarks" / "bench_spun.json"
    wanted = [a for a in sys.argv[1:] if a in PARTS] or list(PARTS)
    known = json.loads(target.read_text()) if target.exists() else {}
    for name in wanted:
        begun = time.process_time()
        known[name] = PARTS[name]()
        target.write_text(json.dumps(known, indent=1) + "\n")
        print(name, round(time.process_time() - begun, 1), "s", json.dumps(known[name])[:400], flush=True)
