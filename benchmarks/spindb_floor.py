"""How well anybody could do with one experiment of a paper known: the floor under `one known` of `spindb.py`.

    python benchmarks/spindb_floor.py ../shared/data/spindb/experiments.csv

The measure of `spindb.py` (per paper the median over the known ones of the median error of the others; the median paper)

* of papers drawn from the calibrated model itself: its laws right, its spreads true, the arithmetic exact for normal
  quantities. What these give is what the laws with their unknowns can reach; then with one kind of unknown taken away;
* of the measured papers in that linear arithmetic, and where each paper is fitted with exponents of its own (least squares
  on every setting that changes in it, which no one has before the paper is measured);
* and where unknowns of the materials are shared by solvents of one polymer (a form that was tried);
* and with all that the laws say between settings made less or more: what the median paper gains so is chance where the mean
  paper does not gain.

Constants of a paper are those of `spindb.json` that have not seen it. A minute.
"""

import json
from pathlib import Path

import numpy as np
from spindb_calibrate import _PHYSICAL, SPREADS, _blocks, _draws, _mean, changes, command, load

from spinline.recipe.constants import Calibrated
from spinline.recipe.model import OF_MATERIALS, RESPONSES

HERE = Path(__file__).parent
_SCATTER = [SPREADS.index("setting"), SPREADS.index("repeat")]
_ANSWERS = [SPREADS.index(name) for name in RESPONSES]
#: What is taken away from the model that draws and from the one that predicts: factors of the variances of `SPREADS`.
WITHOUT = {
    "as calibrated": {},
    "half the scatter of mats and settings": dict.fromkeys(_SCATTER, 0.25),
    "no scatter of mats and settings": dict.fromkeys(_SCATTER, 1e-8),
    "no answers of a laboratory beyond the laws": dict.fromkeys(_ANSWERS, 0.0),
}
STEEPER = (0.7, 0.85, 1.15, 1.3)  # times what the laws say between settings
# what one polymer's unknowns share from solvent to solvent (correlation); conductivity: by the solvents in common
_SHARED = {
    "entanglement_concentration": 0.65,
    "viscosity": 0.5,
    "extensional_viscosity": 0.8,
    "evaporation": 0.5,
}


def known(expected, covariance, y):
    """Median error of the others when one is known, the median over the known ones."""
    n = len(y)
    gain = covariance / np.diag(covariance)[:, None]
    off = np.abs((y - expected)[None, :] - gain * (y - expected)[:, None])
    return np.median([np.median(np.delete(off[k], k)) for k in range(n)])


def drawn(papers, factors, times=200):
    """Factor over papers drawn from the model, quantiles, and the share of such collections at 1.30 or less."""
    rng = np.random.default_rng(0)
    medians = np.empty(times)
    for t in range(times):
        each = []
        for one in papers:
            square = one["square"].copy()
            for index, factor in factors.items():
                square[index] *= factor
            gives = one["fixed"] + np.tensordot(square, one["kinds"], axes=1)
            square[_SCATTER] *= np.exp(2 * one["unevenness"] * rng.standard_normal())
            true = one["fixed"] + np.tensordot(square, one["kinds"], axes=1)
            first, again = one["rows"]
            root = np.linalg.cholesky(true[np.ix_(first, first)] + 1e-10 * np.eye(len(first)))
            each.append(known(0.0, gives, (root @ rng.standard_normal(len(first)))[again]))
        medians[t] = np.median(each)
    names = ("2.5", "16", "50", "84", "97.5")
    found = dict(zip(names, np.exp(np.quantile(medians, (0.025, 0.16, 0.5, 0.84, 0.975))).round(3), strict=True))
    return {**found, "share at 1.30 or less": round(float(np.mean(np.exp(medians) <= 1.30)), 2)}


def own_fit(part, y):
    """What is left of a paper by least squares on every setting that changes in it."""
    rows = [part.rows[s] for s in part.setting]
    columns = [np.ones(len(rows))]
    for name in rows[0]:
        values = [row[name] for row in rows]
        if name in ("paper", "stable", "solvent_parts") or name.startswith("fibre") or len(set(values)) == 1:
            continue
        try:
            x = np.array([float(value or 0.0) for value in values])
        except ValueError:
            columns += [np.array([value == kind for value in values], float) for kind in sorted(set(values))[1:]]
        else:
            columns.append(np.log(x) if (x > 0).all() else x)
    design = np.column_stack(columns)
    return y - design @ np.linalg.lstsq(design, y, rcond=None)[0]


def shared(part, constants):
    """Covariance of a paper's materials where solvents of one polymer have part of its unknowns in common."""
    recipes = [part.recipes[s] for s in part.setting]
    same = part.material[part.setting][:, None] == part.material[part.setting][None, :]
    polymer = np.array([[a.polymer == b.polymer for b in recipes] for a in recipes], float)
    common = np.array(
        [[sum(np.sqrt(v * b.solvent.get(n, 0.0)) for n, v in a.solvent.items()) for b in recipes] for a in recipes]
    )
    found = np.zeros(same.shape)
    for name, row in zip(_PHYSICAL, changes(part, constants, "race"), strict=True):
        across = common if name == "conductivity" else _SHARED.get(name, 0.0) * polymer
        s = row[part.setting]
        found += np.outer(s, s) * (np.where(same, 1.0, across) if name in OF_MATERIALS else 1.0)
    return found


def judge(path):
    """Everything, as a dictionary."""
    kept = json.loads((HERE / "spindb.json").read_text(encoding="utf-8"))["folds"]
    data, z = load(path, twice=True), _draws()
    papers, errors = [], {"linear": [], "a fit of its own": [], "solvents of one polymer share": []}
    for paper in np.unique(data.paper):
        part, constants = data.of([paper]), Calibrated(**kept[paper])
        y = part.log_d
        if len(y) < 2:
            continue
        ((_, fixed, kinds),) = _blocks(part, constants, "race")
        square = np.array([constants.sd[name] for name in SPREADS[:-1]]) ** 2
        expected = _mean(part, constants, z, "race")[part.setting]
        scatter = np.tensordot(square, kinds, axes=1)
        errors["linear"].append(known(expected, fixed + scatter, y))
        errors["solvents of one polymer share"].append(known(expected, shared(part, constants) + scatter, y))
        for times in STEEPER:
            changed = expected.mean() + times * (expected - expected.mean())
            errors.setdefault(f"changes between settings times {times}", []).append(known(changed, fixed + scatter, y))
        rest = own_fit(part, y)
        errors["a fit of its own"].append(known(0.0, np.ones_like(fixed), rest))
        # rows that stand twice stand twice in what is drawn, too
        _, first, again = np.unique(np.column_stack([part.setting, y]), axis=0, return_index=True, return_inverse=True)
        papers.append(
            {
                "fixed": fixed,
                "kinds": kinds,
                "square": square,
                "unevenness": constants.sd["unevenness"],
                "rows": (first, again.ravel()),
            }
        )
    return {
        "papers": len(papers),
        "measured": {
            name: {"factor": round(float(np.exp(np.median(e))), 3), "mean": round(float(np.exp(np.mean(e))), 3)}
            for name, e in errors.items()
        },
        "drawn from the model": {name: drawn(papers, factors) for name, factors in WITHOUT.items()},
    }


if __name__ == "__main__":
    command(judge, __doc__, __file__)
