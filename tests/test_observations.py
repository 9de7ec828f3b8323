"""Reading measurements: what is right is read, what is wrong is named."""

import numpy as np
import pytest
import xarray as xr

from spinline.base.errors import InputError, SpinlineWarning
from spinline.fit.observations import Observation, read_table
from spinline.fit.observed_map import read_map

RADII = "z [mm], radius [um], std [um]\n0.5, 60, 1\n1, 45, 1\n2, 33, 0.5\n"


def reduced(rows=6, shells=4, **extra):
    z = np.linspace(2e-4, 3e-3, rows)
    edges = np.linspace(0, 1, shells + 1)
    data = {
        "polymer_fraction": (("row", "shell"), 0.05 + 0.001 * np.arange(rows * shells).reshape(rows, shells)),
        "polymer_fraction_std": (("row", "shell"), np.full((rows, shells), 0.01)),
        "mean_polymer_fraction": ("row", np.full(rows, 0.05)),
        "mean_polymer_fraction_std": ("row", np.full(rows, 0.005)),
        "jet_radius": ("row", np.linspace(90, 30, rows), {"units": "um"}),
        "jet_radius_std": ("row", np.full(rows, 0.5)),
    }
    return xr.Dataset(data | extra, {"z": ("row", z, {"units": "m"}), "shell": 0.5 * (edges[1:] + edges[:-1])})


def test_table_in_units(tmp_path):
    file = tmp_path / "r.csv"
    file.write_text(RADII, encoding="utf-8")
    read = read_table(file, "radius")
    np.testing.assert_allclose(read.z, [5e-4, 1e-3, 2e-3])
    np.testing.assert_allclose(read.value, [60e-6, 45e-6, 33e-6])
    np.testing.assert_allclose(read.std, [1e-6, 1e-6, 5e-7])


def test_percent_and_default_std(tmp_path):
    file = tmp_path / "f.csv"
    file.write_text("z [mm], mean_fraction [%]\n1, 5\n2, 6\n", encoding="utf-8")
    read = read_table(file, "mean", std="2 %")
    np.testing.assert_allclose(read.value, [0.05, 0.06])
    np.testing.assert_allclose(read.std, [0.001, 0.0012])
    np.testing.assert_allclose(read_table(file, "mean", std="0.003").std, 0.003)


def test_rows_out_of_order_are_sorted_and_said(tmp_path):
    file = tmp_path / "r.csv"
    file.write_text("z [mm], radius [um], std [um]\n1, 45, 1\n0.5, 60, 2\n", encoding="utf-8")
    with pytest.warns(SpinlineWarning, match=r"r\.csv: z does not increase at row 2"):
        read = read_table(file, "radius")
    np.testing.assert_allclose(read.std, [2e-6, 1e-6])
    assert read.notes


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        ("z [mm], radius [um], std [um]\n", "radius", ["no numbers"]),
        ("z [mm], radius [um], std [um]\n1,,1\n", "radius", ["radius", "row 1", "not finite"]),
        ("z [mm], radius [um], std [um]\n1, 30, 1\n2, 0, 1\n", "radius", ["radius", "row 2", "(0, inf) m"]),
        ("z [mm], radius [um], std [um]\n1, -3, 1\n", "radius", ["radius", "(0, inf) m"]),
        ("z [mm], radius [um], std [um]\n1, 30, -1\n", "radius", ["std", "row 1", "(0, inf) m"]),
        ("z [mm], radius [um], std [um]\n1, 30, 0\n2, 20, 0\n", "radius", ["std", "and 1 more"]),
        ("z [mm], radius [um], std [um]\n1,30,\n", "radius", ["std", "not finite"]),
        ("z [mm], radius [um]\n1, 30\n", "radius", ["no standard deviations", "std = "]),
        ("z [mm], radius\n1, 30\n", "radius", ["radius", "unit"]),
        ("z [mm], speed [m/s]\n1, 30\n", "radius", ["speed", "no column radius"]),
        ("z [mm], mean_fraction, std\n1, 5, 0.1\n2, 60, 1\n", "mean", ["60", "percent"]),
        ("z [mm], mean_fraction [um], std\n1, 5, 0.1\n", "mean", ["unit", "um"]),
        ("z [mm], mean_fraction, mean_fraction_std, std\n1, 0.05, 0.1, 0.1\n", "mean", ["two columns"]),
        ("z [mm], std [um]\n1, 1\n", "radius", ["no column radius"]),
        ("z [mm], radius [um], std [um]\n1, x, 1\n", "radius", ["radius", "text"]),
        ("radius [um], std [um]\n30, 1\n", "radius", ["no column z"]),
        ("", "radius", ["not a CSV"]),
    ],
)
def test_bad_tables_are_named(tmp_path, text, kind, words):
    file = tmp_path / "bad.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_table(file, kind)
    message = str(caught.value)
    assert "bad.csv" in message
    for word in words:
        assert word in message


def test_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"not-there\.csv"):
        read_table(tmp_path / "not-there.csv", "radius")


def test_range_keeps_and_counts(tmp_path):
    file = tmp_path / "r.csv"
    file.write_text(RADII, encoding="utf-8")
    kept = read_table(file, "radius").within(0, 1.5e-3)
    assert kept.size == 2
    assert "1 of 3" in kept.notes[0]
    with pytest.raises(InputError, match="no value in the range"):
        kept.within(1.0, 2.0)


def test_map_is_read(tmp_path):
    reduced().to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    radius, mean, core = read_map(tmp_path / "map.nc")
    np.testing.assert_allclose(radius.value, np.linspace(90e-6, 30e-6, 6))
    assert mean.size == core.size == 6
    np.testing.assert_allclose(core.outer, 0.5)  # two of four shells have their centre within 0.4
    area = np.array([1, 3]) / 4
    np.testing.assert_allclose(core.value, reduced()["polymer_fraction"].values[:, :2] @ area)
    np.testing.assert_allclose(core.std, 0.01 * np.sqrt(area @ area))
    assert "same counts" in core.notes[-1]


def test_rings_with_a_covariance_are_whitened():
    rng = np.random.default_rng(1)
    half = rng.standard_normal((6, 4, 4))
    covariance = half @ half.transpose(0, 2, 1) + np.eye(4)
    (rings,) = read_map(reduced(polymer_fraction_covariance=(("row", "shell", "other_shell"), covariance)), ["shell"])
    residual = rng.standard_normal(24)
    white = rings.whiten(residual).reshape(6, 4)
    blocks = residual.reshape(6, 4)
    for i in range(6):
        assert white[i] @ white[i] == pytest.approx(blocks[i] @ np.linalg.solve(covariance[i], blocks[i]))
    expected = -0.5 * (24 * np.log(2 * np.pi) + np.log(np.linalg.det(covariance)).sum())
    assert rings.log_norm() == pytest.approx(expected)
    assert rings.within(0, 1e-3).covariance.shape[0] == 2


def test_rows_that_were_not_reduced_are_left_out():
    broken = reduced()
    broken["mean_polymer_fraction"][2] = np.nan
    broken["polymer_fraction"][3, 1] = np.nan
    _, mean, core = read_map(broken)
    assert mean.size == core.size == 5
    assert "1 of 6 rows" in mean.notes[0]


def test_maps_as_reduce_writes_them():
    given = reduced(calibration_std=("row", np.full(6, 0.003))).drop_vars("shell")
    given = given.assign_coords(relative_radius=("shell", [0.2, 0.5, 0.7, 0.9]))
    given["relative_radius_bounds"] = (("shell", "bound"), [[0, 0.4], [0.4, 0.6], [0.6, 0.8], [0.8, 1]])
    _, mean, core = read_map(given)
    np.testing.assert_allclose(mean.std, 0.004)  # 3-4-5
    assert "fraction_offset" in mean.notes[0]
    np.testing.assert_allclose(core.outer, 0.4)
    given.attrs["method"] = "chord"
    (chord,) = read_map(given, ["chord"])
    np.testing.assert_allclose(chord.value, given["polymer_fraction"].values[:, 0])
    with pytest.raises(InputError, match="chord"):
        read_map(given, ["core"])


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda d: d.drop_vars("jet_radius_std"), "jet_radius_std"),
        (lambda d: d.drop_vars("z"), "no coordinate z"),
        (lambda d: d.drop_vars("shell"), "no coordinate shell"),
        (lambda d: d.rename({"row": "line"}), "dimension row"),
        (lambda d: d.expand_dims(frame=3), "every frame"),
        (lambda d: d.assign_coords(shell=[0.1, 0.2, 0.3, 0.9]), "fill the jet"),
        (lambda d: d.assign(jet_radius=d["jet_radius"] * np.nan), "NaN in every row"),
        (lambda d: d.assign(jet_radius_std=d["jet_radius_std"] * 0), "std"),
        (lambda d: d.assign(jet_radius=-d["jet_radius"]), "out of range"),
        (lambda d: d.assign(polymer_fraction_covariance=(("row", "a", "b"), np.zeros((6, 4, 4)))), "positive definite"),
    ],
)
def test_bad_maps_are_named(change, word):
    with pytest.raises(InputError) as caught:
        read_map(change(reduced()))
    assert word in str(caught.value)


def test_not_a_map(tmp_path):
    (tmp_path / "x.nc").write_text("no", encoding="utf-8")
    with pytest.raises(InputError, match=r"x\.nc"):
        read_map(tmp_path / "x.nc")
    with pytest.raises(InputError, match="not known"):
        read_map(reduced(), ["speed"])


@pytest.mark.parametrize(
    "arguments",
    [
        {"kind": "speed"},
        {"kind": "shell"},
        {"z": np.array([])},
        {"value": np.array([1e-5])},
        {"z": np.array([np.nan, 1.0])},
    ],
)
def test_observations_by_hand_are_checked(arguments):
    two = np.array([1e-3, 2e-3])
    with pytest.raises(InputError):
        Observation(**({"kind": "radius", "z": two, "value": two, "std": two} | arguments))
