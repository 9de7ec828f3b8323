"""``spinline spin`` as a user meets it."""

import json

import numpy as np
import pytest
import xarray as xr
from test_spun_run import PVP_INPUT

QUICK = ("--quick", "--time", "1 ms", "--frames", "4")


@pytest.mark.slow
def test_a_jet_file_that_a_scene_takes(spinline, tmp_path):
    ran = spinline(
        "spin",
        "pvp-spun",
        "-o",
        "jet.nc",
        *QUICK,
        "--json",
        "--figure",
        "jet.png",
        "--vtk",
        "jet.vtk",
        "--xyz",
        "jet.xyz",
        "--movie",
        "jet.gif",
    )
    assert ran.code == 0, ran.err
    answer = json.loads(ran.out)
    assert answer["elements"] > 2
    assert answer["current"] == pytest.approx(2.017e-7, rel=1e-3)
    with xr.open_dataset(tmp_path / "jet.nc") as jet:
        assert jet.sizes["time"] == 4
        assert float(jet["radius"][-1, 0]) < 50e-6
        assert "quick" in jet.attrs["notes"]
    for name in ("jet.png", "jet.vtk", "jet.xyz", "jet.gif"):
        assert (tmp_path / name).stat().st_size > 100
    assert not list(tmp_path.glob(".*.spin"))


def test_seeds_and_overrides(spinline, tmp_path):
    ran = spinline("spin", "pvp-spun", "-o", "a.nc", *QUICK, "--seeds", "2", "--set", 'jet.nozzle_amplitude="20 um"')
    assert ran.code == 0, ran.err
    assert sorted(p.name for p in tmp_path.glob("*.nc")) == ["a-0.nc", "a-1.nc"]


def test_an_input_file(spinline, tmp_path):
    (tmp_path / "input.dat").write_text(PVP_INPUT)
    ran = spinline("spin", "input.dat", "-o", "b.nc", "--flow-rate", "49.5 mL/hour", *QUICK)
    assert ran.code == 0, ran.err
    assert "flow rate: given here" in ran.err
    assert "breakdown" in ran.err
    with xr.open_dataset(tmp_path / "b.nc") as jet:
        assert jet.attrs["flow_rate"] == pytest.approx(1.375e-8, rel=1e-6)
        assert np.isfinite(jet["x"].values[-1, 0])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("peo5-water",), "not a jet to spin"),
        (("pvp-spun", "--seeds", "0"), "--seeds"),
        (("pvp-spun", "--time", "fast"), "--time"),
        (("pvp-spun", "--flow-rate", "1 mL/h"), "input.dat"),
        (("nothing.dat",), "nothing.dat"),
        (("pvp-spun", "--set", 'jet.charge="conducting"'), "no solvent's viscosity"),
        (("peo5-spun", "--set", 'jet.start="middle"'), "jet.start"),
        (("peo5-spun", "--set", 'jet.side_field="1 kV/cm"'), "side_frequency"),
        (("pvp-spun", "--frames", "0"), "frames"),
        (("pvp-spun", "--set", 'jet.law="rubber"'), "law"),
    ],
)
def test_mistakes_are_named(spinline, arguments, words):
    ran = spinline("spin", *arguments)
    assert ran.code == 2
    assert "error: " in ran.err
    assert any(word in ran.err for word in words.split("|")), ran.err
    assert "Traceback" not in ran.err


def test_check_does_not_spin(spinline):
    ran = spinline("check", "pvp-spun")
    assert ran.code == 0
    assert "e^2/(G A0) = 9.1" in ran.out
    assert "breakdown" in ran.out
