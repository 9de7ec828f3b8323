"""The committed judgement of the recipe's chain on published fibres: what it says, and samples of it made again."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pan_recipe import PAN

from spinline.recipe import read_experiments, recipes_of
from spinline.recipe.predict import predict

DATA = Path(__file__).parent / "data" / "spindb" / "experiments-sample.csv"
COMMITTED = json.loads((Path(__file__).parents[1] / "benchmarks" / "spindb.json").read_text())


def test_the_judgement_on_published_fibres_holds():
    """What the committed result of benchmarks/spindb.py says, every paper left out of its own calibration."""
    race = COMMITTED["rungs"]["race"]
    assert race["factor"] < min(1.61, *(r["factor"] for r in COMMITTED["plain statistics"].values()))
    assert race["mean"] < min(r["mean"] for r in COMMITTED["plain statistics"].values())
    assert 0.58 <= race["coverage_68"] <= 0.78
    assert 0.90 <= race["coverage_95"] <= 0.99
    for found in COMMITTED["elasticities"].values():
        assert found["measured"][0] <= found["predicted"] <= found["measured"][2]
    assert COMMITTED["failures"]["area_68"][0] > 0.5
    known = COMMITTED["one known"]["rows"]
    assert known["equal"] == pytest.approx(1.37, abs=0.005)  # the published comparison, so the measure is the same
    assert known["chain"] < 1.305
    assert 0.58 <= known["coverage_68"] <= 0.78
    assert 0.90 <= known["coverage_95"] <= 0.99


def test_one_known_is_as_good_as_the_model_lets_expect():
    """`benchmarks/spindb_floor.py`: the same measure of papers drawn from the model, where all is right by construction."""
    floor = json.loads((Path(__file__).parents[1] / "benchmarks" / "spindb_floor.json").read_text(encoding="utf-8"))
    known, drawn = COMMITTED["one known"]["rows"], floor["drawn from the model"]
    assert floor["papers"] == known["papers"]
    assert drawn["as calibrated"]["2.5"] < known["chain"] < drawn["as calibrated"]["97.5"]
    mean = {name: one["mean"] for name, one in floor["measured"].items()}
    others = [value for name, value in mean.items() if name.startswith("changes between settings")]
    assert len(others) == 4
    assert mean["linear"] < min(others)
    assert floor["measured"]["linear"]["factor"] < drawn["as calibrated"]["84"]
    assert floor["measured"]["linear"]["factor"] == pytest.approx(known["chain"], rel=0.015)
    assert floor["measured"]["a fit of its own"]["factor"] < drawn["no answers of a laboratory beyond the laws"]["50"]


def test_bayes_rule_without_its_linear_gain_is_near(monkeypatch):
    """`benchmarks/spindb_bayes.py`: two papers again, and all of them against what the program's gain gives."""
    folder = Path(__file__).parents[1] / "benchmarks"
    monkeypatch.setattr(sys, "path", [*sys.path, str(folder)])
    import spindb_bayes
    from spindb_calibrate import load

    from spinline.recipe.constants import Calibrated

    committed = json.loads((folder / "spindb_bayes.json").read_text(encoding="utf-8"))
    first, second = committed["sets"]
    data = load(DATA, twice=True)
    for paper in ("10.3390/fib8100065", "10.1021/acsami.0c02578."):
        mats = np.flatnonzero(data.paper[data.setting] == paper)
        assert len(mats) == 2
        recipes = [data.recipes[s] for s in data.setting[mats]]
        constants = Calibrated(**COMMITTED["folds"][paper])
        value, _ = spindb_bayes.errors(recipes, np.arange(2), data.log_d[mats], constants, 15, 1)
        assert value == pytest.approx(first["ln errors"][paper], abs=1e-3)
    for found in (first, second):
        assert found["papers"] == COMMITTED["one known"]["rows"]["papers"]
        assert found["effective draws, least and median"][0] > 500
        assert found["factor"] == pytest.approx(COMMITTED["one known"]["rows"]["chain"], rel=0.015)


def test_the_floor_measures_what_is_left():
    sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
    import spindb_floor as sf

    # known: the others move with the gain c/v of the known one: of (0, 3) about 0, c/v = 1/2 and 1/8
    covariance = np.array([[1.0, 0.5], [0.5, 4.0]])
    assert sf.known(0.0, covariance, np.array([0.0, 3.0])) == pytest.approx(np.median([3.0, 3.0 / 8]))
    # drawn: two experiments that share all but a scatter of 0.1 leave some 0.1 sqrt 2 of it, median 0.6745 times that
    square = np.zeros(len(sf.SPREADS) - 1)
    square[sf.SPREADS.index("laboratory")], square[sf.SPREADS.index("repeat")] = 1.0, 0.01
    kinds = np.zeros((square.size, 2, 2))
    kinds[sf.SPREADS.index("laboratory")], kinds[sf.SPREADS.index("repeat")] = 1.0, np.eye(2)
    rows = (np.arange(2), np.arange(2))
    one = {"fixed": np.zeros((2, 2)), "kinds": kinds, "square": square, "unevenness": 0.0, "rows": rows}
    assert np.log(sf.drawn([one] * 200, {}, times=20)["50"]) == pytest.approx(0.6745 * 0.1 * 2**0.5, rel=0.05)


def test_the_constants_of_the_chain_are_those_of_the_calibration():
    from dataclasses import asdict

    from spinline.recipe.constants import CONSTANTS

    whole = COMMITTED["calibrated on all"]
    for name, value in asdict(CONSTANTS).items():
        assert value == pytest.approx(whole[name], rel=1e-3)
    for name, (low, high) in COMMITTED["constants over folds"].items():
        assert low <= whole[name] <= high


def test_a_sample_is_predicted_as_committed():
    """By the constants of the fold that left its paper out."""
    from spinline.recipe.believe import believe
    from spinline.recipe.constants import Calibrated
    from spinline.recipe.model import normals, spun

    rows = [row for row in read_experiments(DATA) if row["fibre_diameter_nm"] and row["paper"] in COMMITTED["folds"]]
    alone = [row for row in rows if sum(p == row["paper"] for p, *_ in COMMITTED["predicted"]) <= 2]
    assert len(alone) > 3
    recipes = {id(row): recipe for row, recipe in zip(rows, recipes_of(rows), strict=True)}
    for row in alone:  # papers whose settings are all in the sample: the others' mean concentration is another one
        constants = Calibrated(**COMMITTED["folds"][row["paper"]])
        log_d = spun(believe(recipes[id(row)], constants)[0], normals(2048), constants=constants).log_diameter
        near = [m for p, _, _, _, m, *_ in COMMITTED["predicted"] if p == row["paper"]]
        assert min(abs(np.log(np.exp(np.median(log_d)) / np.array(near)))) < 1e-3


def test_the_calibration_finds_what_made_the_fibres():
    """Fibres made by the model itself with other constants are told apart from the priors' medians."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
    import spindb_calibrate as sc

    from spinline.recipe.believe import believe
    from spinline.recipe.model import Believed, spun

    rng = np.random.default_rng(4)
    truth = replace(sc.NEUTRAL, viscosity_power=6.5, current_level=2e-6, sd=dict.fromkeys(sc.SPREADS, 0.1))
    recipes, paper = [], []
    for lab in range(12):
        base = replace(PAN, voltage=rng.uniform(8e3, 3e4), flow_rate=10 ** rng.uniform(-10.3, -8.8), usual_fraction=0.1)
        for c in (0.05, 0.08, 0.13, 0.2):
            recipes.append(replace(base, mass_fraction=c))
            paper.append(str(lab))
    believed = Believed.of([believe(recipe)[0] for recipe in recipes])
    data = sc.Experiments(
        [{} for _ in recipes], recipes, believed, np.array(paper), np.array(["a"] * 48), np.arange(48), np.zeros(48)
    )
    z = np.zeros((1, len(sc.UNKNOWNS)))
    made = spun(believed, z, constants=truth, steps=12).log_diameter[:, 0] + 0.05 * rng.standard_normal(48)
    found, width = sc.calibrate(replace(data, log_d=made), turns=2, count=4)
    for name in ("current_level", "viscosity_power"):
        value, true = (np.log(getattr(c, name)) if sc.PRIORS[name][0] else getattr(c, name) for c in (found, truth))
        middle = np.log(sc.PRIORS[name][1]) if sc.PRIORS[name][0] else sc.PRIORS[name][1]
        assert abs(value - true) < 2 * width[name]
        assert abs(middle - true) > 3 * width[name]


def test_the_current_of_a_needles_jet_does_not_follow_the_viscosity(monkeypatch):
    """`benchmarks/current_exponents.py`: a setting again, and what all of them say; a uniform field's 1/6 is far from it."""
    folder = Path(__file__).parents[1] / "benchmarks"
    monkeypatch.setattr(sys, "path", [*sys.path, str(folder)])
    import current_exponents

    committed = json.loads((folder / "current_exponents.json").read_text(encoding="utf-8"))
    (row,) = (row for row in read_experiments(DATA) if row["paper"] == "10.1063/1.4994968")
    made = current_exponents.exponents(recipes_of([row])[0])
    kept = min(
        committed["each"].values(),
        key=lambda one: abs(one["newtonian"].get("current", 1.0) - made["newtonian"]["current"]),
    )
    for liquid, numbers in made.items():
        assert numbers.pop("current") == pytest.approx(kept[liquid].pop("current"), rel=1e-4)
        assert numbers.pop("chain") == pytest.approx(kept[liquid].pop("chain"), rel=1e-4)
        assert numbers == pytest.approx(kept[liquid], abs=1e-3)
    for liquid in committed["liquids"].values():
        assert liquid["jets"] > 50
        assert -0.2 < liquid["viscosity"][1] < 0.02
        assert liquid["viscosity"][2] < 1 / 12
    thin, thick = (predict(replace(PAN, viscosity=mu), shares=False) for mu in (0.1, 10.0))
    assert thick.current == pytest.approx(thin.current)
    assert thick.fibre_diameter > 2 * thin.fibre_diameter
