"""Fibres predicted against fibres published: factor error, coverage, elasticities, failures, and what plain statistics give.

    python benchmarks/spindb.py ../shared/data/spindb/experiments.csv

Factor: ``exp(median over papers of the median |ln(predicted/measured)| of the paper)``, distinct settings. Nothing is
fitted here, but the chain's global constants (`spinline.recipe.constants`) were chosen on these very papers, none
left out. Beside it, on the same rows, and unlike it leaving one paper out: one number for all, ridge regression in
logarithms, and a random forest (where scikit-learn is installed).
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from spinline.recipe.believe import believe
from spinline.recipe.model import spun
from spinline.recipe.predict import Measurement, _conditioned, _normals, predict
from spinline.recipe.table import read_experiments, recipes_of

SETTINGS = {
    "concentration": "concentration_wt_percent",
    "flow rate": "flow_rate_mL_per_h",
    "voltage": "voltage_kV",
    "distance": "distance_cm",
}


def distinct(path):
    """Rows of distinct settings with their recipes; diameters of equal settings are averaged in logarithms."""
    rows = read_experiments(path)
    groups = {}
    for row, recipe in zip(rows, recipes_of(rows), strict=True):
        key = tuple(value for name, value in row.items() if not name.startswith("fibre_diameter"))
        groups.setdefault(key, []).append((row, recipe))
    return [
        (g[0][0], g[0][1], [float(r["fibre_diameter_nm"]) for r, _ in g if r["fibre_diameter_nm"]])
        for g in groups.values()
    ]


def over_papers(errors, paper):
    """exp of the median over papers of the papers' medians."""
    return float(np.exp(np.median([np.median(errors[paper == p]) for p in np.unique(paper)])))


def baselines(rows, y, paper):
    """Errors of plain statistics, leaving one paper out."""
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
        forest, found["random forest"] = (
            RandomForestRegressor(200, random_state=0, min_samples_leaf=2),
            np.empty(len(y)),
        )
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
    return {name: over_papers(np.abs(values - y), paper) for name, values in found.items()}


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


def with_one_measured(recipes, y, paper, draws=512):
    """Factor and coverage of the others when one experiment of a paper is known; each in turn (about 6 a paper)."""
    z, errors, inside68, inside95 = _normals(draws), [], [], []
    for p in np.unique(paper):
        here = np.flatnonzero(paper == p)
        if len(here) < 2:
            continue
        own = {i: spun(believe(recipes[i])[0], z).log_diameter for i in here}
        e, a, b = [], [], []
        for k in here[:: max(1, len(here) // 6)]:
            known = [Measurement(recipes[k], float(np.exp(y[k])))]
            for j in here[here != k]:
                sharpened = _conditioned(own[j], z, known, "race")[0]
                low95, low, middle, high, high95 = np.quantile(sharpened, (0.025, 0.16, 0.5, 0.84, 0.975))
                e.append(abs(middle - y[j]))
                a.append(low < y[j] < high)
                b.append(low95 < y[j] < high95)
        errors.append(np.median(e))
        inside68.append(np.mean(a))
        inside95.append(np.mean(b))
    coverage = {"coverage_68": float(np.mean(inside68)), "coverage_95": float(np.mean(inside95))}
    return {"factor": float(np.exp(np.median(errors))), **coverage, "papers": len(errors)}


def failures(table):
    """Chance of anything but fibres, of the experiments that failed and of the others; the area under the curve."""
    scores = {True: [], False: []}
    for row, recipe, _ in table:
        if not isinstance(recipe, str):
            found = predict(recipe, shares=False, draws=512)
            scores[row["stable"] == "True"].append(1 - found.regimes.get("jets", 0.0))
    bad, good = np.array(scores[False]), np.array(scores[True])
    above = np.mean([np.mean((b > good) + 0.5 * (b == good)) for b in bad]) if bad.size else float("nan")
    return {
        "failed": bad.size,
        "mean_chance_failed": float(bad.mean()),
        "mean_chance_others": float(good.mean()),
        "area": float(above),
    }


def judge(path):
    """Everything, as a dictionary."""
    began = time.perf_counter()
    table = distinct(path)
    used = [
        (row, recipe, float(np.mean(np.log(sizes))))
        for row, recipe, sizes in table
        if sizes and not isinstance(recipe, str)
    ]
    rows, recipes = [u[0] for u in used], [u[1] for u in used]
    y = np.array([u[2] for u in used]) - np.log(1e9)
    paper = np.array([row["paper"] for row in rows])
    answer = {"rows": len(used), "papers": len(np.unique(paper)), "rungs": {}}
    for rung in ("race", "terminal"):
        found = [predict(recipe, rung=rung, shares=False) for recipe in recipes]
        middle = np.log([f.fibre_diameter for f in found])
        inside = {}
        for name in ("68", "95"):
            ends = np.log([getattr(f, f"fibre_diameter_{name}") for f in found])
            hit = (y > ends[:, 0]) & (y < ends[:, 1])
            inside[f"coverage_{name}"] = float(np.mean([hit[paper == p].mean() for p in np.unique(paper)]))
        answer["rungs"][rung] = {
            "factor": over_papers(np.abs(middle - y), paper),
            "bias": float(np.exp(np.median(middle - y))),
            **inside,
        }
        if rung == "race":
            answer["elasticities"] = elasticities(rows, y, middle, paper)
            answer["predicted"] = [
                [row["paper"], round(float(np.exp(a)), 11), round(float(np.exp(b)), 11)]
                for row, a, b in zip(rows, y, middle, strict=True)
            ]
    answer["leaving one paper out"] = baselines(rows, y, paper)
    answer["one measured"] = with_one_measured(recipes, y, paper)
    answer["failures"] = failures(table)
    shares = [predict(recipe).variance_shares for recipe in recipes[:: max(1, len(recipes) // 40)]]
    answer["variance shares"] = {
        k: round(float(np.mean([s.get(k, 0.0) for s in shares])), 3) for k in sorted({k for s in shares for k in s})
    }
    answer["seconds"] = round(time.perf_counter() - began, 1)
    return answer


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(".json"))
    asked = parser.parse_args()
    answer = judge(asked.table)
    asked.out.write_text(json.dumps(answer, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({k: v for k, v in answer.items() if k != "predicted"}, indent=1))
