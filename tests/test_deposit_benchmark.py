"""The committed results of the benchmarks of mats and blown beads: what they promise, and a sample computed again."""

import json
from pathlib import Path

import numpy as np
import pytest

import spinline.deposit as dep

FOLDER = Path(__file__).parent.parent / "benchmarks"
MAT = json.loads((FOLDER / "bench_deposit.json").read_text(encoding="utf-8"))
BEADS = json.loads((FOLDER / "blown_beads.json").read_text(encoding="utf-8"))


def test_ten_million_segments_fit_a_core():
    last = MAT["scale"]["rows"][-1]
    assert last["segments"] == 10_000_000
    assert last["cpu_total_s"] <= 120
    assert last["peak_memory_GB"] <= 2
    assert MAT["scale"]["exponent"] <= 1.1


def test_flow_through_random_beds_is_within_the_spread_of_the_laws_and_not_the_grids():
    for row in MAT["beds"]:
        inside = [value for value in row["laws"].values() if np.isfinite(value)]
        assert min(inside) < row["k_over_a2"] < max(inside)
        assert max(row["first_bed_by_grid"]) < 1.04 * min(row["first_bed_by_grid"])
    assert {row["bed"] for row in MAT["beds"]} == {"layered, through", "random"}
    assert len(MAT["beds"]) == 6


def test_heights_converge_and_a_sample_is_the_same():
    """Order 1.5 or better at the slope of dry fibres; half a radius computed again."""
    dry = next(row for row in MAT["pixel"] if row["slope"] == 0.1)
    assert min(dry["orders"]) > 1.5
    rng = np.random.default_rng(1)
    theta, middle = rng.uniform(0, np.pi, 2000), rng.uniform(0, 200, (2000, 2))
    half = 100 * np.stack([np.cos(theta), np.sin(theta)], -1)
    s = dep.Segments.from_paths(list(np.stack([middle - half, middle + half], 1)), 1.0)
    laid = dep.lay_stack(s, dep.Window(200, 200, periodic=True), pixel=0.5, slope=0.1)
    assert laid.mean_thickness == pytest.approx(dry["mean_height"][1], rel=1e-6)


def test_blown_beads_keep_their_volume_and_bend_where_they_may():
    for row in BEADS:
        assert abs(row["balance"]) < 1e-12
        assert row["below_zero_share"] < 0.01
    full, half = BEADS[0], BEADS[1]
    assert half["cfl"] == full["cfl"] / 2
    assert abs(half["median_radius_um"] / full["median_radius_um"] - 1) < 0.03


def test_twice_the_elements_of_a_blown_jet_give_its_radius_within_3_per_cent():
    mesh = json.loads((FOLDER / "blown_mesh.json").read_text(encoding="utf-8"))
    coarse, fine = mesh["means"][-2:]
    assert coarse["element_mm"] == 2 * fine["element_mm"]
    for size in (coarse["element_mm"], fine["element_mm"]):
        assert sum(row["element_mm"] == size for row in mesh["runs"]) >= 4
    for name in ("median_radius_um", "mean_radius_um", "air_radius_um"):
        assert abs(fine[name] / coarse[name] - 1) < 0.03
