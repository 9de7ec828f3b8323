r"""Do the intervals of `spinline fit` hold what they say? Simulated experiments, truths drawn from the priors.

    python benchmarks/coverage_fit.py                       # 1,000 experiments of every design: about half an hour
    python benchmarks/coverage_fit.py --design drying -n 50 # a look
    python benchmarks/coverage_fit.py --design manifold -n 300 --records rows.jsonl --minutes 9    # again and again: it goes on
    python benchmarks/coverage_fit.py --design stretch --design fene-p --design manifold -n 300 --records rows.jsonl \
        --minutes 0 --out benchmarks/coverage_rungs.json

For each parameter: share of experiments whose 68 % and 95 % interval holds the truth (1,000 experiments: standard errors
1.5 % and 0.7 %), mean and standard deviation of the z-score in the coordinates of the fit, and how much the data narrow
the prior. Every experiment follows from (seed, index) alone.

Designs: radius at 100 places (std 1 um), mean and core fraction at 60 (std 0.002 and 0.004), as X-rays resolve them.

* ``affine``: PEO-like jet of 5 mm; k, beta, phi, both calibrations, origin.
* ``relaxing``: the same with a relaxation time near 10 ms, De about 1.
* ``drying``: the same in acetone, which loses 8 % of its volume in 5 mm by Eq. (44); everything free at once.
* ``manifold``: a network that slips at alpha_v near 300, itself free, linear springs.
* ``fene-p``: strands of finite length that relax in about 10 ms, closure "stretch".
* ``stretch``: the affine network by the closure "stretch".

Not identifiable, hence not in the campaign: r_0 beside the length scale (only their product is seen), the flow rate beside the
relaxation time (only Q theta is), evaporation of water (0.3 % of the volume: below what X-rays resolve), phi beside the
fraction scale from mean fractions alone.
"""

import argparse
import json
import time
import warnings
from pathlib import Path

import numpy as np

from spinline.base.errors import SpinlineWarning
from spinline.fit.least_squares import fit
from spinline.fit.model import ForwardModel
from spinline.fit.observations import Observation
from spinline.fit.problem import FitProblem, Prior
from spinline.fit.scene_model import forward_model
from spinline.scene import load_scene
from spinline.setup.air import Air

SEED = 20261122
DESIGNS = ("affine", "relaxing", "drying", "manifold", "fene-p", "stretch")
SCENES = {  # designs by a rung of a scene
    "manifold": ["network.model=manifold", "network.force_law=linear", "network.coupling=300"],
    "fene-p": ["network.model=conformation", "network.closure=stretch", "solution.relaxation_time=10 ms"],
    "stretch": ["network.model=affine", "network.closure=stretch"],
}

VALUES = {
    "k": 1.0,
    "beta": 0.47,
    "initial_radius": 125e-6,
    "flow_rate": 8.9e-10,
    "volume_fraction": 0.05,
    "relaxation_time": 0.01,
    "evaporation": 1.0,
    "fraction_scale": 1.0,
    "fraction_offset": 0.0,
    "length_scale": 1.0,
    "origin": 0.0,
}


def problem(design):
    """Model, places and standard deviations of a design; the values are filled in by `simulate`."""
    free = {
        "k": Prior(1.0, 0.2),
        "beta": Prior(0.47, 0.04),
        "volume_fraction": Prior(0.05, 0.005),
        "fraction_scale": Prior(1.0, 0.05),
        "length_scale": Prior(1.0, 0.02),
        "origin": Prior(0.0, 5e-5),
    }
    drying = None
    if design in ("relaxing", "drying", "fene-p"):
        free["relaxation_time"] = Prior(0.01, 0.005)
    if design == "drying":
        from spinline.rheology.vapour import air_kinematic_viscosity
        from spinline.rheology.volatile import Volatile

        free["evaporation"] = Prior(1.0, 0.3)
        drying = Air(
            (Volatile.build("acetone", 293.15),),
            np.ones(1),
            air_kinematic_viscosity(293.15),
            0.0,
            "flory-huggins",
            None,
            0.0,
            "mass",
        )
    if design == "manifold":
        free["coupling"] = Prior(300.0, 100.0)
    if design in SCENES:
        given = {name: prior.value for name, prior in free.items()}
        model = forward_model(load_scene("peo5-water", SCENES[design]), values=given)
    else:
        model = ForwardModel("power-law", VALUES, 5e-3, relaxation=design != "affine", drying=drying)
    far, near = np.linspace(5e-5, 4.9e-3, 100), np.linspace(1e-4, 4.5e-3, 60)

    def blank(kind, z, std):
        return Observation(kind, z, np.full(z.size, 1e-4 if kind == "radius" else 0.05), np.full(z.size, std))

    data = (blank("radius", far, 1e-6), blank("mean", near, 2e-3), blank("core", near, 4e-3))
    return FitProblem(model, data, free, title=design)


def experiment(design, index, seed=SEED):
    """One experiment: truth, z-scores in coordinates, what each interval holds, narrowing, chi-squared."""
    rng = np.random.default_rng([seed, DESIGNS.index(design), index])
    asked = problem(design)
    truth = asked.draw_prior(rng)
    drawn = asked.simulate(truth, rng)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("error")
        warnings.simplefilter("always", SpinlineWarning)
        found = fit(drawn)
    assert [str(item.message) for item in said] == list(found.notes)  # counted in the summary
    spread = np.sqrt(np.diag(found.covariance))
    return {
        "truth": truth,
        "z": ((found.coordinates - drawn.to_coordinates(truth)) / spread).tolist(),
        "in68": [lo <= truth[name] <= hi for name, (lo, hi) in found.interval68.items()],
        "in95": [lo <= truth[name] <= hi for name, (lo, hi) in found.interval95.items()],
        "narrowed": (spread / drawn.prior_std).tolist(),
        "chi2": found.chi_squared,
        "notes": list(found.notes),
    }


def recorded(design, count, seed, path, minutes):
    """Rows of the first experiments of a design, made until the time is up; with a file, written one a line as they come."""
    rows = []
    if path is not None and path.exists():
        lines = map(json.loads, path.read_text(encoding="utf-8").splitlines())
        rows = [row for row in lines if (row["design"], row["seed"]) == (design, seed)][:count]
    began = time.monotonic()
    while len(rows) < count and time.monotonic() - began < 60 * minutes:
        cpu, wall = time.process_time(), time.perf_counter()
        row = {"design": design, "seed": seed, "index": len(rows), **experiment(design, len(rows), seed)}
        row |= {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}
        rows.append(row)
        if path is not None:
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
    return rows


def campaign(design, count, seed=SEED, path=None, minutes=1e9):
    """Coverage of one design, as a dictionary ready for JSON; None where no experiment was made."""
    rows = recorded(design, count, seed, path, minutes)
    if not rows:
        return None
    names = problem(design).names
    pick = lambda key: np.array([row[key] for row in rows])  # noqa: E731
    z, in68, in95, narrow = pick("z"), pick("in68"), pick("in95"), pick("narrowed")
    return {
        "design": design,
        "experiments": len(rows),
        "seed": seed,
        "cpu_seconds_per_experiment": sum(row["cpu"] for row in rows) / len(rows),
        "wall_seconds": sum(row["wall"] for row in rows),
        "experiments_with_a_note": sum(bool(row["notes"]) for row in rows),
        "parameters": {
            name: {
                "coverage68": float(in68[:, i].mean()),
                "coverage95": float(in95[:, i].mean()),
                "z_mean": float(z[:, i].mean()),
                "z_std": float(z[:, i].std()),
                "posterior_over_prior_std": float(np.median(narrow[:, i])),
            }
            for i, name in enumerate(names)
        },
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=1000, help="experiments of each design")
    parser.add_argument("--design", choices=DESIGNS, action="append", help="default: all")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument(
        "--records", type=Path, help="experiments, one a line: added to, and what the summary is made of"
    )
    parser.add_argument("--minutes", type=float, default=1e9, help="for each design")
    parser.add_argument("--out", type=Path, help="JSON summary, default: print only")
    options = parser.parse_args()
    found = []
    for design in options.design or DESIGNS:
        one = campaign(design, options.n, options.seed, options.records, options.minutes)
        if one is None:
            continue
        found.append(one)
        print(
            f"{design}: {one['experiments']} experiments, {one['cpu_seconds_per_experiment']:.3g} s CPU each, "
            f"{one['experiments_with_a_note']} with a note"
        )
        for name, p in one["parameters"].items():
            narrowed = f"std over prior's {p['posterior_over_prior_std']:.3f}"
            print(
                f"  {name:16s} 68 %: {100 * p['coverage68']:5.1f}   95 %: {100 * p['coverage95']:5.1f}   "
                f"z {p['z_mean']:+.3f} sd {p['z_std']:.3f}   {narrowed}",
                flush=True,
            )
    if options.out is not None:
        options.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
