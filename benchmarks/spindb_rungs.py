"""Rungs of the recipe's chain side by side on published fibres, with the constants of `spindb.py` that a paper has not seen.

    python benchmarks/spindb_rungs.py ../shared/data/spindb/experiments.csv

`terminal`, `race` and `envelope` on every setting, `lagrangian` beside them on those that `spindb_lagrangian.py` has spun; all
share the constants of `spindb.json`, which were calibrated with `race`. `offset`: the factor after one more number a rung, the
median of the other papers' biases. A minute or two.
"""

import json
import time
from pathlib import Path

import numpy as np
from spindb import QUANTILES, over_papers, scored
from spindb_calibrate import command, load

from spinline.recipe.believe import believe
from spinline.recipe.constants import Calibrated
from spinline.recipe.model import normals, spun

HERE = Path(__file__).parent


def quantiles(data, folds, draws=2048):
    """Quantiles of ln d of every setting by its paper's constants, (setting, 5), by rung."""
    z = normals(draws)
    found = {"terminal": [], "race": [], "envelope": []}
    for recipe, paper in zip(data.recipes, data.paper, strict=True):
        believed = believe(recipe, folds[paper])[0]
        for rung, of in found.items():
            of.append(np.quantile(spun(believed, z, constants=folds[paper], rung=rung).log_diameter, QUANTILES))
    return {rung: np.array(values) for rung, values in found.items()}


def by_beads(data, y, rungs):
    """The rungs side by side on the settings that were spun bead by bead, each shifted by the other papers' bias too."""
    path = HERE / "spindb_lagrangian.json"
    if not path.exists():
        return {}
    done = json.loads(path.read_text(encoding="utf-8"))["experiments"]
    spun_ = {int(key): one for key, one in done.items() if "fibre_diameter" in one}
    if not spun_:
        return {}
    index = np.array(sorted(spun_))
    logs = {"lagrangian": np.log([spun_[i]["fibre_diameter"] for i in index])}
    logs |= {rung: q[index, 2] for rung, q in rungs.items()}
    answer = {"experiments": len(done), "spun": len(index), "refused": len(done) - len(index)}
    answer["cpu_seconds_median"] = float(np.median([spun_[i]["cpu_seconds"] for i in index]))
    answer["charge_carried_median"] = float(np.median([spun_[i]["carried"] for i in index]))
    for rung, log_d in logs.items():
        middle, mean = over_papers(np.abs(log_d - y[index]), data.paper[index])
        answer[rung] = {
            "factor": middle,
            "mean": mean,
            "bias": float(np.exp(np.median(log_d - y[index]))),
            "offset": after_offset(log_d - y[index], data.paper[index]),
        }
    return answer


def after_offset(off, paper):
    """Factor when each paper's predictions are moved by the median of the other papers' biases."""
    bias = {p: np.median(off[paper == p]) for p in np.unique(paper)}
    each = []
    for p in bias:
        others = np.median([bias[q] for q in bias if q != p])
        each.append(np.median(np.abs(off[paper == p] - others)))
    return float(np.exp(np.median(each)))


def judge(path):
    """Everything, as a dictionary."""
    began = time.process_time()
    kept = json.loads((HERE / "spindb.json").read_text(encoding="utf-8"))["folds"]
    folds = {paper: Calibrated(**one) for paper, one in kept.items()}
    data = load(path)
    y = np.array([data.log_d[data.setting == s].mean() for s in range(len(data.rows))])
    found = quantiles(data, folds)
    apart = found["envelope"][:, 2] - found["race"][:, 2]
    return {
        "settings": len(y),
        "rungs": {
            rung: {**scored(q, y, data.paper), "offset": after_offset(q[:, 2] - y, data.paper)}
            for rung, q in found.items()
        },
        "envelope over race, 5 25 50 75 95 %": np.exp(np.quantile(apart, (0.05, 0.25, 0.5, 0.75, 0.95)))
        .round(3)
        .tolist(),
        "by beads": by_beads(data, y, found),
        "cpu_seconds": round(time.process_time() - began, 1),
    }


if __name__ == "__main__":
    command(judge, __doc__, __file__)
