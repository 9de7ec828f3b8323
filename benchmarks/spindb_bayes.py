"""What one known experiment of a paper says by Bayes' rule itself: draws weighed by their likelihood, and no gain.

    python benchmarks/spindb_bayes.py ../shared/data/spindb/experiments.csv

The measure is that of `one known`, `rows`, of `spindb.py`, whose constants it takes. Shared with `spinline.recipe.measured`
are the forward model and what recipes have in common; the arithmetic is another: every unknown is drawn (Sobol), a draw
weighs what its fibre and the scatter of its laboratory make of the known diameter, and the others are at the weighed median.
Two sets of draws, for their chance. Three minutes.
"""

import json
import time
from pathlib import Path

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc
from spindb_calibrate import command, load

from spinline.recipe.believe import believe
from spinline.recipe.constants import Calibrated
from spinline.recipe.measured import shared
from spinline.recipe.model import OF_MATERIALS, SCATTERED, UNKNOWNS, spun

HERE = Path(__file__).parent
_NAMES = list(UNKNOWNS)


def fibres(recipes, constants, power, seed):
    """Ln d without scatter, (recipe, draw), the size of the scatter, (draw,), and a normal draw besides, (draw,)."""
    common = dict(zip(_NAMES, shared(recipes), strict=True))
    directions = common[OF_MATERIALS[0]].vectors
    width = len(_NAMES) + len(OF_MATERIALS) * directions.shape[1] + 1
    uniform = qmc.Sobol(width, seed=seed).random_base2(power)
    drawn = ndtri(np.clip(uniform, 1e-12, 1 - 1e-12))
    z, parts, beside = np.split(drawn, [len(_NAMES), width - 1], axis=1)
    z[:, [_NAMES.index(name) for name in SCATTERED]] = 0.0
    of = np.einsum("rd,ndm->rnm", directions, parts.reshape(len(z), directions.shape[1], len(OF_MATERIALS)))
    columns = [_NAMES.index(name) for name in OF_MATERIALS]
    core = np.empty((len(recipes), len(z)))
    for i, recipe in enumerate(recipes):
        z[:, columns] = of[i]
        core[i] = spun(believe(recipe, constants)[0], z, constants=constants, steps=16).log_diameter
    uneven = np.exp(constants.sd["unevenness"] * z[:, _NAMES.index("unevenness")])
    return core, uneven, beside[:, 0], common["setting"].correlations


def errors(recipes, setting, y, constants, power, seed):
    """Median over the known experiments of the median error of the others, ln d; and the least effective number of draws."""
    core, uneven, beside, alike = fibres(recipes, constants, power, seed)
    own, mat = (constants.sd[name] ** 2 for name in SCATTERED)
    scatter = uneven**2 * (own + mat)
    found, effective = [], []
    for k, s in enumerate(setting):
        off = y[k] - core[s]
        log_w = -0.5 * (off**2 / scatter + np.log(scatter))
        weight = np.exp(log_w - log_w.max())
        weight /= weight.sum()
        effective.append(1 / np.sum(weight**2))
        middle = {}
        for t in set(np.delete(setting, k)):
            share = alike[s, t] * own / (own + mat)  # of the known one's scatter that the other one has too
            x = core[t] + share * off + np.sqrt(scatter * (1 - share**2)) * beside
            order = np.argsort(x)
            middle[t] = x[order][np.searchsorted(np.cumsum(weight[order]), 0.5)]
        found.append(np.median([abs(middle[t] - y[j]) for j, t in enumerate(setting) if j != k]))
    return float(np.median(found)), float(min(effective))


def judge(path, power=15, seeds=(1, 2)):
    """Everything, as a dictionary."""
    began = time.process_time()
    kept = json.loads((HERE / "spindb.json").read_text(encoding="utf-8"))["folds"]
    data = load(path, twice=True)
    answer = {"draws": 2**power, "sets": []}
    for seed in seeds:
        each, effective = {}, []
        for paper in np.unique(data.paper):
            mats = np.flatnonzero(data.paper[data.setting] == paper)
            if len(mats) < 2:
                continue
            own, setting = np.unique(data.setting[mats], return_inverse=True)
            recipes = [data.recipes[i] for i in own]
            constants = Calibrated(**kept[paper])
            each[paper], least = errors(recipes, setting, data.log_d[mats], constants, power, seed)
            effective.append(least)
        values = np.array(list(each.values()))
        answer["sets"].append(
            {
                "papers": len(values),
                "factor": float(np.exp(np.median(values))),
                "mean": float(np.exp(values.mean())),
                "effective draws, least and median": [round(min(effective)), round(float(np.median(effective)))],
                "ln errors": {paper: round(value, 4) for paper, value in each.items()},
            }
        )
    return answer | {"cpu_seconds": round(time.process_time() - began, 1)}


if __name__ == "__main__":
    command(judge, __doc__, __file__)
