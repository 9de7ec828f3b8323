"""The straight electrified jet against equations written anew for scipy's `solve_bvp`, and what the campaigns found."""

import importlib.util
import json
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "benchmarks"
pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="no benchmarks beside the tests")


def campaign(name):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module, json.loads((FOLDER / f"{name}.json").read_text())


def test_every_compared_jet_agrees_with_scipy() -> None:
    _, kept = campaign("ehd_independent")
    assert kept["compared"] >= 15
    assert {one["verdict"] for one in kept["not_compared"]} <= {
        "fold",
        "swells",
        "held",
        "cone",
        "scipy does not converge",
    }
    assert kept["largest radius_apart"] < 1e-5
    assert kept["largest current_apart"] < 1e-5


def test_a_sample_of_it_replays() -> None:
    again, kept = campaign("ehd_independent")
    quick = [one for one in kept["rows"] if one["verdict"] == "jet" and one["start_off_by"] == 1e-2]
    for law in again.LAWS:
        one = next(row for row in quick if row["law"] == law)
        found = again.row(one["index"])
        assert found["verdict"] == "jet"
        assert found["radius_apart"] < 1e-5
        assert found["current_apart"] < 1e-5


def test_estimated_errors_are_the_true_ones_within_a_factor_of_two() -> None:
    again, kept = campaign("ehd_errors")
    assert kept["jets"] == 100
    for name in ("radius", "current"):
        found = kept[f"{name}: estimate over true"]
        assert found["number"] > 70
        assert found["beyond a factor of 2"] == 0
    assert kept["radius: true error by a mesh half as fine, off by at most"] < 0.02  # the truth is one
    one = next(row for row in kept["rows"] if row["verdict"] == "jet" and row["radius"][1] > 1e-9)
    estimate, true = again.row(one["index"])["radius"]
    assert 0.5 < estimate / true < 2
