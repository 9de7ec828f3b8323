"""Fibres predicted against fibres published, leaving out one paper at a time: factor, coverage, elasticities, failures, floor.

    python benchmarks/spindb.py ../shared/data/spindb/experiments.csv

For every paper the chain is calibrated on the others (`spindb_calibrate.py`; twenty minutes in all), and every figure
is of papers that their constants have not seen. Beside it, on the same rows and leaving out the same papers: one number for
all, ridge regression in logarithms, and a random forest (where scikit-learn is installed). Factor:
``exp(median over papers of the paper's median |ln(predicted/measured)|)`` over distinct settings; `mean` is the same
with the mean over papers, which moves less from one choice of papers to the next.
"""

import argparse
import json
import time
from dataclasses import asdict
from pathlib import Path

import numpy as np
from spindb_calibrate import PRIORS, calibrate, load

from spinline.recipe.believe import believe
from spinline.recipe.constants import CONSTANTS, Calibrated
from spinline.recipe.measured import Known, moved, shared, slopes
from spinline.recipe.model import UNKNOWNS, Believed, normals, scatter, spun
from spinline.recipe.predict import shares_of
from spinline.recipe.regime import regime_of
from spinline.recipe.table import read_experiments, recipes_of

SETTINGS = {
    "concentration": "concentration_wt_percent",
    "flow rate": "flow_rate_mL_per_h",
    "voltage": "voltage_kV",
    "distance": "distance_cm",
}
QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)


def over_papers(errors, paper):
    """Factor over papers: of the median paper, and of the mean one."""
    each = [np.median(errors[paper == p]) for p in np.unique(paper)]
    return float(np.exp(np.median(each))), float(np.exp(np.mean(each)))


def baselines(rows, y, paper):
    """Predictions of plain statistics, leaving one paper out."""
    columns = [
        np.array([float(r[c]) if r[c] else np.nan for r in rows])
        for c in (*SETTINGS.values(), "relative_humidity_percent")
    ]
    x = np.column_stack([np.log(np.where(np.isnan(c), np.nanmedian(c), c)) for c in columns])
    for name in ("polymer", "solvent"):
        kinds = sorted({r[name] for r in rows})
        x = np.column_stack([x, *[np.array([r[name] == k for r in rows], float) for k in kinds]])
    found = {"one number": np.empty(len(y)), "ridge": np.empty(len(y))}
    try:
        from sklearn.ensemble import RandomForestRegressor
    except ImportError:
        forest = None
    else:
        forest = RandomForestRegressor(100, random_state=0, min_samples_leaf=2)
        found["random forest"] = np.empty(len(y))
    for p in np.unique(paper):
        out, rest = paper == p, paper != p
        weight = 1 / np.array([np.sum(paper == q) for q in paper[rest]])
        found["one number"][out] = np.median([np.median(y[paper == q]) for q in np.unique(paper[rest])])
        mean, scale = x[rest].mean(axis=0), x[rest].std(axis=0) + 1e-9
        a, b = (x[rest] - mean) / scale, np.average(y[rest], weights=weight)
        gram = (a * weight[:, None]).T @ a + np.eye(a.shape[1])
        found["ridge"][out] = b + (x[out] - mean) / scale @ np.linalg.solve(
            gram, (a * weight[:, None]).T @ (y[rest] - b)
        )
        if forest is not None:
            found["random forest"][out] = forest.fit(x[rest], y[rest], sample_weight=weight).predict(x[out])
    return found


def elasticities(rows, y, predicted, paper):
    """d ln d/d ln(setting) within papers where that setting alone changes: quartiles measured, median predicted."""
    found = {}
    for name, column in SETTINGS.items():
        measured, modelled = [], []
        for p in np.unique(paper):
            groups, xs, ys, ms = {}, [], [], []
            for i in np.flatnonzero(paper == p):
                rest = tuple(v for c, v in rows[i].items() if c != column and not c.startswith(("fibre", "stable")))
                groups.setdefault(rest, []).append(i)
            for g in groups.values():
                x = np.array([float(rows[i][column]) if rows[i][column] else np.nan for i in g])
                if len(g) > 1 and np.isfinite(x).all() and np.ptp(x) > 0:
                    xs += list(np.log(x) - np.log(x).mean())
                    ys += list(y[g] - y[g].mean())
                    ms += list(predicted[g] - predicted[g].mean())
            if xs:
                xs = np.array(xs)
                measured.append(xs @ np.array(ys) / (xs @ xs))
                modelled.append(xs @ np.array(ms) / (xs @ xs))
        found[name] = {
            "papers": len(measured),
            "measured": np.round(np.percentile(measured, (25, 50, 75)), 3).tolist(),
            "predicted": round(float(np.median(modelled)), 3),
        }
    return found


def one_known(mats_only, everything, folds, draws=8192, overs=("rows", "mats", "settings")):
    """Errors of the others when one experiment of a paper is known, each in turn; beside it, the others said equal to it.

    Per paper the median over the known ones of the median error of the others (`factor`, the measure of the published
    comparison, over every row of the table as it stands), and the median over all pairs; also over rows that differ, and over
    distinct settings; `middle` where the known one is that in the middle of the paper's settings.
    """
    z = normals(draws)
    found = {}
    for over in overs:
        data = everything if over == "rows" else mats_only
        each = {
            name: []
            for name in (
                "chain",
                "equal",
                "chain, all pairs",
                "equal, all pairs",
                "68",
                "95",
                "middle",
                "middle, equal",
            )
        }
        for p in np.unique(data.paper):
            mats = np.flatnonzero(data.paper[data.setting] == p)
            settings = data.setting[mats]
            y = data.log_d[mats]
            if over == "settings":
                settings = np.unique(settings)
                y = np.array([data.log_d[data.setting == s].mean() for s in settings])
            if len(y) < 2:
                continue
            recipes = {s: data.recipes[s] for s in np.unique(settings)}
            believed = {s: believe(r, folds[p])[0] for s, r in recipes.items()}
            change = slopes(Believed.of(list(believed.values())), steps=16, constants=folds[p])
            change = dict(zip(recipes, change.T, strict=True))
            core = {s: cores(b, z, folds[p]) for s, b in believed.items()}
            errors, equal, hits = [], [], []
            for k, s in enumerate(settings):
                kinds, mine = {}, {}
                for j, t in enumerate(settings):
                    if j == k:
                        continue
                    if t not in kinds:
                        common = shared([recipes[t], recipes[s]])
                        alike = tuple(part.correlations[0, 1] for part in common)
                        if alike not in mine:  # the known mat by the draws that the other one shares
                            own = np.column_stack([part.drawn(z[:, i], i)[1] for i, part in enumerate(common)])
                            mine[alike] = own, cores(believed[s], own, folds[p])
                        own, seen = mine[alike]
                        known = Known.of(
                            np.column_stack([change[t], change[s]]), common, 0.0, folds[p].sd["unevenness"]
                        )
                        off = np.full((1, draws), y[k])
                        both = believed[t], believed[s]
                        log_d = moved(np.array([core[t], seen]), np.array([z, own]), both, off, known)
                        kinds[t] = np.quantile(log_d, QUANTILES)
                    low95, low, middle, high, high95 = kinds[t]
                    errors.append((k, abs(middle - y[j])))
                    equal.append((k, abs(y[k] - y[j])))
                    hits.append((low < y[j] < high, low95 < y[j] < high95))
            errors, equal = np.array(errors), np.array(equal)
            center = central(data, settings)
            for name, values in (("chain", errors), ("equal", equal)):
                by_known = [np.median(values[values[:, 0] == k, 1]) for k in range(len(y))]
                each[name].append(np.median(by_known))
                each[f"{name}, all pairs"].append(np.median(values[:, 1]))
                each["middle" if name == "chain" else "middle, equal"].append(by_known[center])
            for name, inside in zip(("68", "95"), np.mean(hits, axis=0), strict=True):
                each[name].append(inside)
        factor = {name: float(np.exp(np.median(values))) for name, values in each.items() if name not in ("68", "95")}
        found[over] = {
            "papers": len(each["68"]),
            **factor,
            **again(np.array(each["chain"])),
            "coverage_68": float(np.mean(each["68"])),
            "coverage_95": float(np.mean(each["95"])),
        }
    return found


def cores(believed, normal, constants):
    """Ln d without what settings and mats scatter by themselves."""
    return spun(believed, normal, constants=constants, steps=16).log_diameter - scatter(believed, normal)


def again(errors):
    """What other papers of the same kind would give: the factor over papers drawn anew."""
    rng = np.random.default_rng(0)
    drawn = np.exp([np.median(rng.choice(errors, errors.size)) for _ in range(4000)])
    return {
        "over papers, 68 and 95 %": np.quantile(drawn, (0.16, 0.84, 0.025, 0.975)).round(3).tolist(),
        "share of them at 1.30 or less": float(np.mean(drawn <= 1.30)),
    }


def central(data, settings):
    """Index of the experiment in the middle of a paper's settings."""
    x = np.column_stack([data.believed.away[name][settings, 0] for name in data.believed.away])
    x = x - x.mean(axis=0)
    x = x / np.where(x.std(axis=0) > 0, x.std(axis=0), 1.0)
    return int(np.argmin(np.sum(x * x, axis=1)))


def failures(path, folds, draws=512):
    """Chance of anything but fibres, of the experiments that failed and of the others; the area under the curve."""
    groups = {}
    rows = read_experiments(path)
    for row, recipe in zip(rows, recipes_of(rows), strict=True):
        key = tuple(value for name, value in row.items() if not name.startswith("fibre_diameter"))
        groups.setdefault(key, (row, recipe))
    scores, found = {True: [], False: []}, []
    for row, recipe in groups.values():
        if isinstance(recipe, str):
            continue
        constants = folds.get(row["paper"], CONSTANTS)
        believed = believe(recipe, constants)[0]
        regime = regime_of(believed, recipe, spun(believed, normals(draws), constants=constants))
        chance = 1 - regime.shares.get("jets", 0.0)
        scores[row["stable"] == "True"].append(chance)
        found.append((row["paper"], row["stable"], round(chance, 4)))
    bad, good = np.array(scores[False]), np.array(scores[True])
    mixed = {p for p, s, _ in found if s == "False"} & {p for p, s, _ in found if s == "True"}
    inside = [
        np.mean([b > g for p, s, g in found if p == q and s == "True"])
        + 0.5 * np.mean([b == g for p, s, g in found if p == q and s == "True"])
        for q in sorted(mixed)
        for _, s, b in [f for f in found if f[0] == q]
        if s == "False"
    ]
    return {
        "failed": bad.size,
        "others": good.size,
        "mean_chance_failed": float(bad.mean()),
        "mean_chance_others": float(good.mean()),
        "area": area(bad, good),
        "area_68": np.quantile(_resampled(bad, good), (0.16, 0.84)).round(3).tolist(),
        "area within papers that have both": float(np.mean(inside)) if inside else None,
    }


def area(bad, good):
    """Chance that a failure is given a higher chance of failing than a fibre."""
    return float(np.mean([np.mean((b > good) + 0.5 * (b == good)) for b in bad])) if bad.size else float("nan")


def _resampled(bad, good, times=400):
    rng = np.random.default_rng(0)
    return [area(rng.choice(bad, bad.size), rng.choice(good, good.size)) for _ in range(times)]


def floor(data):
    """How far nearly equal recipes of different papers lie apart, and mats of one setting within a paper."""
    x = np.column_stack(
        [
            np.log([r.mass_fraction for r in data.recipes]),
            *[data.believed.away[n][:, 0] for n in data.believed.away if n != "concentration_response"],
        ]
    )
    y = np.array([data.log_d[data.setting == s].mean() for s in range(len(data.rows))])
    near = {}
    for i in range(len(y)):
        for j in range(i):
            if data.paper[i] == data.paper[j] or data.material[i] != data.material[j]:
                continue
            apart = np.abs(x[i] - x[j])
            if np.all(apart <= np.log([1.16, 1.5, 2.0, 1.5])):
                near.setdefault(tuple(sorted((data.paper[i], data.paper[j]))), []).append(abs(y[i] - y[j]))
    pairs = np.array([np.median(v) for v in near.values()])
    repeats = []
    for p in np.unique(data.paper):
        if any(np.isnan(data.recipes[s].mass_fraction) for s in np.flatnonzero(data.paper == p)):
            continue  # what varies there is not in the table
        own = [data.log_d[data.setting == s] for s in np.flatnonzero(data.paper == p)]
        own = [v for v in own if len(v) > 1]
        if own:
            repeats.append(np.sqrt(sum(np.sum((v - v.mean()) ** 2) for v in own) / sum(len(v) - 1 for v in own)))
    # two papers, each with the same spread about the truth: the best prediction is the middle of many such
    return {
        "pairs of papers": len(pairs),
        "factor between them": float(np.exp(np.median(pairs))) if len(pairs) else None,
        "factor of the best prediction from these columns": float(np.exp(np.median(pairs) / 2**0.5))
        if len(pairs)
        else None,
        "repeat_sd": float(np.median(repeats)),
        "papers with repeats": len(repeats),
    }


def fold(data, papers):
    """Constants from the papers that are not among some."""
    return calibrate(data.of(np.setdiff1d(data.paper, papers)))[0]


def predicted(data, folds, draws=2048):
    """Quantiles of ln d of every setting by its paper's constants, (setting, 5), by rung."""
    z = normals(draws)
    found = {"race": [], "terminal": []}
    for recipe, paper in zip(data.recipes, data.paper, strict=True):
        believed = believe(recipe, folds[paper])[0]
        spins = spun(believed, z, constants=folds[paper])
        race = spins.log_diameter
        alone = np.log(2 * np.sqrt(believed.volume_fraction) * spins.thinning.radius)
        found["race"].append(np.quantile(race, QUANTILES))
        found["terminal"].append(np.quantile(race - alone + np.log(spins.terminal), QUANTILES))
    return {rung: np.array(values) for rung, values in found.items()}


def scored(q, y, paper):
    """Factor, bias and coverage of quantiles."""
    middle, mean = over_papers(np.abs(q[:, 2] - y), paper)
    inside = {}
    for name, low, high in (("68", 1, 3), ("95", 0, 4)):
        hit = (y > q[:, low]) & (y < q[:, high])
        inside[f"coverage_{name}"] = float(np.mean([hit[paper == p].mean() for p in np.unique(paper)]))
    bias = float(np.exp(np.median([np.median((q[:, 2] - y)[paper == p]) for p in np.unique(paper)])))
    each = np.array([np.median(np.abs(q[:, 2] - y)[paper == p]) for p in np.unique(paper)])
    rng = np.random.default_rng(0)
    drawn = np.exp([np.median(rng.choice(each, each.size)) for _ in range(4000)])
    spread = np.quantile(drawn, (0.16, 0.84)).round(3).tolist()
    return {"factor": middle, "factor_68": spread, "mean": mean, "bias": bias, **inside}


def ten_folds(data, y):
    """The same with the papers left out by tenths."""
    folds = {}
    for part in np.array_split(np.random.default_rng(0).permutation(np.unique(data.paper)), 10):
        folds |= dict.fromkeys(part, fold(data, part))
    return scored(predicted(data, folds, 1024)["race"], y, data.paper)


def judge(path, known=None):
    """Everything, as a dictionary; `known` may hold the folds' constants of an earlier run."""
    began = time.process_time()
    data = load(path)
    papers = np.unique(data.paper)
    y = np.array([data.log_d[data.setting == s].mean() for s in range(len(data.rows))])
    folds = known or {p: fold(data, [p]) for p in papers}
    answer = {"settings": len(y), "mats": len(data.log_d), "papers": len(papers), "rungs": {}}
    for rung, q in predicted(data, folds).items():
        answer["rungs"][rung] = scored(q, y, data.paper)
        if rung == "race":
            answer["elasticities"] = elasticities(data.rows, y, q[:, 2], data.paper)
            answer["predicted"] = [
                [p, round(float(np.exp(v)), 11), *np.round(np.exp(five), 11).tolist()]
                for p, v, five in zip(data.paper, y, q, strict=True)
            ]
    answer["in sample"] = scored(predicted(data, dict.fromkeys(papers, CONSTANTS), 512)["race"], y, data.paper)
    answer["leaving out tenths"] = ten_folds(data, y)
    plain = baselines(data.rows, y, data.paper)
    answer["plain statistics"] = {
        name: dict(zip(("factor", "mean"), over_papers(np.abs(v - y), data.paper), strict=True))
        for name, v in plain.items()
    }
    answer["one known"] = one_known(data, load(path, twice=True), folds)
    answer["failures"] = failures(path, folds)
    answer["floor"] = floor(data)
    z = normals(2048)
    shares = []
    for i in range(0, len(y), max(1, len(y) // 80)):
        found = spun(believe(data.recipes[i], folds[data.paper[i]])[0], z, constants=folds[data.paper[i]])
        shares.append(shares_of(found.log_diameter, z))
    answer["variance shares"] = {
        k: round(float(np.mean([s.get(k, 0.0) for s in shares])), 3) for k in UNKNOWNS if any(k in s for s in shares)
    }
    answer["calibrated on all"] = asdict(calibrate(data)[0])
    answer["folds"] = {p: asdict(c) for p, c in folds.items()}
    answer["constants over folds"] = {
        name: [min(getattr(c, name) for c in folds.values()), max(getattr(c, name) for c in folds.values())]
        for name in PRIORS
    }
    answer["cpu_seconds"] = round(time.process_time() - began, 1)
    return answer


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(".json"))
    parser.add_argument("--keep-folds", action="store_true", help="constants of the folds as in the present result")
    asked = parser.parse_args()
    old = None
    if asked.keep_folds:
        old = {p: Calibrated(**c) for p, c in json.loads(asked.out.read_text(encoding="utf-8"))["folds"].items()}
    answer = judge(asked.table, old)
    asked.out.write_text(json.dumps(answer, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({k: v for k, v in answer.items() if k not in ("predicted", "folds")}, indent=1))
