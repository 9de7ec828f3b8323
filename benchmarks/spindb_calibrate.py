"""Calibration of the fibre's chain on published fibres: the largest posterior density of a mixed model, in seconds.

    python benchmarks/spindb_calibrate.py ../shared/data/spindb/experiments.csv

prints the numbers of `src/spinline/recipe/constants.py`.

Model: ln d of an experiment is the chain's mean over its unknowns, plus normal departures whose covariance is

* within one laboratory (paper): the chain's own unknowns (`spinline.recipe.model.UNKNOWNS`, with the spreads of `believe`;
  those of the materials are shared where the polymer is the same, as far as the solvents are), a laboratory's offset, and
  its answers to concentration, voltage, flow rate and gap beyond the laws;
* within one setting: what the laws miss there; for each mat: the repeat; both larger in some laboratories than in others.

Looked for are four numbers of the chain (`PRIORS`: where their priors come from is said there) and the standard
deviations of the last two kinds (`SPREADS`), by turns: Gauss and Newton for the numbers, quasi-Newton on the marginal
likelihood for the spreads. The form of the chain is not part of it: variants of it were compared on the same papers before.
"""

import argparse
import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize
from scipy.special import ndtri
from scipy.stats import qmc

from spinline.recipe import Recipe
from spinline.recipe.believe import believe
from spinline.recipe.constants import Calibrated
from spinline.recipe.measured import materials_in_common
from spinline.recipe.model import OF_MATERIALS, RESPONSES, UNKNOWNS, Believed, sensitivities, spun
from spinline.recipe.table import read_experiments, recipes_of

# name: (whether its logarithm is normal, median, standard deviation); where each comes from
PRIORS = {
    # 3 for a liquid that is not stretched; measured in stretched entangled solutions tens to thousands
    "trouton": (True, 30.0, 1.5),
    # a cone-jet's closed form gives 2.6e-7 A at the reference, straight jets from a needle 2e-7 to 6e-7
    "current_level": (True, 3e-7, 0.8),
    # 14/3 in theta solvents; 3.9 in good ones; measured to 5.5 and more at high concentrations
    "viscosity_power": (False, 14 / 3, 0.7),
    # viscous jet 1/2; straight jets from a needle 0.46 to 0.49; measured 0.4
    "current_conductivity": (False, 0.5, 0.1),
}
SPREADS = ("laboratory", "setting", "repeat", *RESPONSES, "unevenness")
_SCATTER = [1, 2]  # of them a laboratory has a scale of its own
_SCALES = 5
SPREAD_PRIOR = (0.25, 1.0)  # log-normal, for all
_PHYSICAL = tuple(name for name in UNKNOWNS if name not in SPREADS and name != "relaxation_time")
_STEPS = 12


@dataclass(frozen=True, eq=False)
class Experiments:
    """Distinct settings with their recipes, and every mat with its setting."""

    rows: list[dict[str, str]]
    recipes: list[Recipe]
    believed: Believed  # of the settings, stacked
    paper: np.ndarray  # of the settings
    material: np.ndarray
    setting: np.ndarray  # of the mats
    log_d: np.ndarray  # of the mats

    def of(self, papers):
        """Of some papers only."""
        keep = np.isin(self.paper, papers)
        index = np.full(len(keep), -1)
        index[keep] = np.arange(keep.sum())
        mats = keep[self.setting]
        part = {
            f: getattr(self.believed, f)[keep] for f in self.believed.__dataclass_fields__ if f not in ("sd", "away")
        }
        for f in ("sd", "away"):
            part[f] = {name: value[keep] for name, value in getattr(self.believed, f).items()}
        return Experiments(
            [r for r, k in zip(self.rows, keep, strict=True) if k],
            [r for r, k in zip(self.recipes, keep, strict=True) if k],
            Believed(**part),
            self.paper[keep],
            self.material[keep],
            index[self.setting[mats]],
            self.log_d[mats],
        )


def load(path, twice=False):
    """Every fibre of a table whose recipe can be read; a row that stands twice counts once, or as often as it stands."""
    rows = read_experiments(path)
    if not twice:
        rows = [dict(row) for row in dict.fromkeys(tuple(row.items()) for row in rows)]
    settings, mats = {}, []
    for row, recipe in zip(rows, recipes_of(rows), strict=True):
        if isinstance(recipe, str) or not row["fibre_diameter_nm"]:
            continue
        key = tuple(value for name, value in row.items() if not name.startswith("fibre_diameter"))
        settings.setdefault(key, (len(settings), row, recipe))
        mats.append((settings[key][0], np.log(1e-9 * float(row["fibre_diameter_nm"]))))
    kept = [row for _, row, _ in settings.values()]
    recipes = [recipe for *_, recipe in settings.values()]
    return Experiments(
        kept,
        recipes,
        Believed.of([believe(recipe)[0] for recipe in recipes]),
        np.array([row["paper"] for row in kept]),
        np.array([f"{recipe.polymer} in {sorted(recipe.solvent)}" for recipe in recipes]),
        np.array([m[0] for m in mats]),
        np.array([m[1] for m in mats]),
    )


#: Where every search starts: the medians of the priors.
NEUTRAL = Calibrated(
    **{name: median for name, (_, median, _) in PRIORS.items()}, sd=dict.fromkeys(SPREADS, SPREAD_PRIOR[0])
)


def _draws(count=16, seed=5):
    """Normal draws of what the chain does not know; the departures are left at zero."""
    z = np.zeros((count, len(UNKNOWNS)))
    columns = [i for i, name in enumerate(UNKNOWNS) if name in _PHYSICAL]
    z[:, columns] = ndtri(qmc.Sobol(len(columns), seed=seed).random(count))
    return z


def _mean(data, constants, z, rung):
    return spun(data.believed, z, rung=rung, steps=_STEPS, constants=constants).log_diameter.mean(axis=1)


def changes(data, constants, rung):
    """Change of ln d of every setting for one standard deviation of each unknown of the chain, (unknown, setting)."""
    every = sensitivities(data.believed, rung=rung, steps=_STEPS, constants=constants)
    return every[[list(UNKNOWNS).index(name) for name in _PHYSICAL]]


def _blocks(data, constants, rung):
    """For each laboratory: its mats, their fixed covariance, and the seven that `SPREADS` scale."""
    g = changes(data, constants, rung)
    found = []
    for paper in np.unique(data.paper):
        mats = np.flatnonzero(data.paper[data.setting] == paper)
        s = data.setting[mats]
        own, which = np.unique(s, return_inverse=True)
        recipes = [data.recipes[i] for i in own]
        common = materials_in_common(recipes)[which][:, which]
        fixed = np.zeros((len(mats),) * 2)
        for name, row in zip(_PHYSICAL, g, strict=True):
            fixed += np.outer(row[s], row[s]) * (common if name in OF_MATERIALS else 1.0)
        away = [data.believed.away[name][s, 0] for name in RESPONSES]
        kinds = [np.ones_like(fixed), s[:, None] == s[None, :], np.eye(len(mats)), *[np.outer(a, a) for a in away]]
        found.append((mats, fixed, np.array(kinds, dtype=float)))
    return found


def _nodes(unevenness):
    """Scales of a laboratory's scatter, their weights, and the slopes of their logarithms in that of `unevenness`."""
    x, w = np.polynomial.hermite_e.hermegauss(_SCALES)
    return np.exp(unevenness * x), np.log(w / w.sum()), unevenness * x


def _spread_loss(log_sd, blocks, rest, want="loss"):
    """Negative log posterior of the spreads and its slope, or each laboratory's mean inverse covariance.

    A laboratory's scatter (setting and repeat) has a scale of its own, log-normal about 1: it is summed over.
    """
    loss = 0.5 * np.sum(((log_sd - np.log(SPREAD_PRIOR[0])) / SPREAD_PRIOR[1]) ** 2)
    slope = (log_sd - np.log(SPREAD_PRIOR[0])) / SPREAD_PRIOR[1] ** 2
    square = np.exp(2 * log_sd[:-1])
    scales, log_w, lever = _nodes(np.exp(log_sd[-1]))
    inverses = []
    for mats, fixed, kinds in blocks:
        r, eye = rest[mats], np.eye(len(mats))
        logs, slopes, own = np.empty(_SCALES), np.empty((_SCALES, len(log_sd))), []
        for k in range(_SCALES):
            part = square.copy()
            part[_SCATTER] *= scales[k] ** 2
            factor = cho_factor(fixed + np.tensordot(part, kinds, axes=1), lower=True, check_finite=False)
            inverse = cho_solve(factor, eye, check_finite=False)
            a = inverse @ r
            logs[k] = log_w[k] - 0.5 * r @ a - np.sum(np.log(np.diag(factor[0])))
            each = part * (np.tensordot(kinds, inverse, axes=2) - (kinds @ a) @ a)
            slopes[k] = np.append(each, lever[k] * each[_SCATTER].sum())
            own.append(inverse)
        top = logs.max()
        share = np.exp(logs - top)
        loss -= top + np.log(share.sum())
        share /= share.sum()
        slope = slope + share @ slopes
        if want == "inverses":
            inverses.append((mats, np.tensordot(share, np.array(own), axes=1)))
    return inverses if want == "inverses" else (loss, slope)


def _plain(name, value):
    return float(np.exp(value)) if PRIORS[name][0] else float(value)


def calibrate(data, turns=3, count=16, rung="race"):
    """The constants of largest posterior density, of a rung.

    Returns
    -------
    Calibrated, and the posterior standard deviations of the four (of the logarithm where that is normal)
    """
    names = list(PRIORS)
    middle = np.array([np.log(m) if log else m for log, m, _ in PRIORS.values()])
    width = np.array([sd for *_, sd in PRIORS.values()])
    here = NEUTRAL
    at = np.array([np.log(getattr(here, n)) if PRIORS[n][0] else getattr(here, n) for n in names])
    log_sd = np.log([here.sd[name] for name in SPREADS])
    z = _draws(count)

    def constants(at):
        return replace(here, **{n: _plain(n, v) for n, v in zip(names, at, strict=True)})

    for _ in range(turns):
        now = constants(at)
        blocks = _blocks(data, now, rung)
        f = _mean(data, now, z, rung)
        rest = data.log_d - f[data.setting]
        log_sd = minimize(
            _spread_loss, log_sd, (blocks, rest), jac=True, method="L-BFGS-B", bounds=[(-5, 1)] * len(log_sd)
        ).x
        inverses = _spread_loss(log_sd, blocks, rest, want="inverses")
        for _ in range(4):
            now = constants(at)
            f = _mean(data, now, z, rung)
            small = 0.1 * width
            jac = np.stack(
                [
                    (_mean(data, constants(at + small * (np.arange(len(at)) == j)), z, rung) - f) / small[j]
                    for j in range(len(at))
                ],
                axis=1,
            )
            rest, jac = data.log_d - f[data.setting], jac[data.setting]
            gram, pull = np.diag(width**-2.0), -(at - middle) / width**2
            for mats, inverse in inverses:
                gram += jac[mats].T @ inverse @ jac[mats]
                pull += jac[mats].T @ inverse @ rest[mats]
            step = np.linalg.solve(gram, pull)
            at = at + np.clip(step, -2 * width, 2 * width)
            if np.max(np.abs(step) / width) < 0.01:
                break
    found = replace(constants(at), sd=dict(zip(SPREADS, np.exp(log_sd).tolist(), strict=True)))
    return found, dict(zip(names, np.sqrt(np.diag(np.linalg.inv(gram))).tolist(), strict=True))


def command(judge, doc, script):
    """The command line of a judgement: a table in, the answer printed, and kept beside the script."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path)
    text = json.dumps(judge(parser.parse_args().table), indent=1)
    Path(script).with_suffix(".json").write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path)
    parser.add_argument("--rung", default="race", choices=("race", "envelope"))
    asked = parser.parse_args()
    found, width = calibrate(load(asked.table), rung=asked.rung)
    for name, (log, *_) in PRIORS.items():
        words = f"posterior sd {width[name]:.2g}{' of its logarithm' if log else ''}"
        print(f"    {name}: float = {getattr(found, name):.4g}  # {words}")
    for name, value in found.sd.items():
        print(f'            "{name}": {value:.4g},')
