"""What `benchmarks/bench_spun.json` says still holds: a sample of it is computed again."""

import json
from pathlib import Path

import numpy as np
import pytest
from spun_cases import pvp, radii, spun

STORED = json.loads((Path(__file__).parents[1] / "benchmarks" / "bench_spun.json").read_text())


def test_published_radii_replayed():
    rows = STORED["published"]["radii at 0.1, 0.2, 0.5, 1 cm after 4 ms, m"]
    at = np.array([0.1, 0.2, 0.5, 1.0]) * 1e-2
    again = radii(spun(pvp(2e-4, repulsion="hybrid", near=4, pressure=False), 4e-3), at)
    assert again == pytest.approx(np.array(rows["0.0002"]), rel=1e-6)
    assert np.abs(np.array(rows["0.0002"]) / np.array(rows["5e-05"]) - 1)[:3].max() < 0.03


def test_stored_numbers_are_those_asked_for():
    assert STORED["orders"]["fast jet, worst radius against the exact one"]["0.0002"] < 1e-4
    assert min(STORED["orders"]["slow jet, settled: orders"]) > 1.9
    assert min(STORED["orders"]["bent jet, field but no repulsion"]["last order"][2:]) > 1.9
    assert min(STORED["orders"]["bent jet, 4400 statC/cm3"]["last order"][3:]) > 1.0
    assert STORED["sums"]["10000"]["rms error"] < 1e-3
    assert STORED["sums"]["cost exponent, 1e4 to 1e5"] < 1.2
    assert STORED["many"]["100000"]["finite"]
    assert STORED["many"]["cost exponent, 1e4 to 1e5"] < 1.2


def test_straight_part_of_a_bending_jet_stays():
    """Stored: time means of the straight part, per cent, bent against unbent."""
    for values in STORED["whole"]["bent against unbent"].values():
        assert max(map(abs, values)) < 2.0
