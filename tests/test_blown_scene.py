"""Scenes of blown jets: run, jet, spin, deposit, mat, drying along them, several nozzles, and what is refused."""

import json

import numpy as np
import pytest

import spinline as sl
import spinline.jetprofile.blown as blown
from spinline.base.errors import InputError
from spinline.base.units import Measured
from spinline.jetprofile.blown.straight_jet import BlownJet
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.rheology.element_path import bead_path, straight_path
from spinline.scene.file import load_scene
from spinline.setup.build import build_jet, build_solution
from spinline.study.sweep import run_sweep, sweep_from_dict

SHORT = ("--set", "collector.distance=8 mm", "--set", "jet.time=4 ms")


@pytest.fixture(scope="module")
def scene():
    return load_scene("pan12-blown")


def test_the_scenes_jet_is_that_of_its_settings(scene):
    jet = build_jet(scene, build_solution(scene))
    assert isinstance(jet, BlownJet)
    x = jet.settings
    assert (x.air.diameter, x.air.exit_velocity, x.air.intensity, x.law) == (1e-3, 200.0, 0.2, "oldroyd-b")
    assert x.air.core_constant == pytest.approx(6.2628 * np.sqrt(1 / (1 - 200**2 / (2 * 1004.675 * 293.15))), rel=1e-4)
    own = blown.straight_blown_jet(x.solution, x.air, 10e-3, law="oldroyd-b")
    np.testing.assert_allclose(jet.velocity(own.z), own.velocity, rtol=1e-7)
    np.testing.assert_allclose(jet.slip(own.z), own.velocity - own.air_velocity, rtol=1e-6, atol=1e-6)
    z = np.linspace(1e-4, 9.9e-3, 50)
    np.testing.assert_allclose(jet.strain_rate(z), np.gradient(jet.velocity(z), z, edge_order=2), rtol=0.2, atol=30)
    late = np.array([2e-3, 5e-3])
    fine = np.linspace(0, 5e-3, 200_001)
    taken = np.interp(
        late, fine, np.concatenate(([0], np.cumsum(np.diff(fine) / jet.velocity(0.5 * (fine[1:] + fine[:-1])))))
    )
    np.testing.assert_allclose(jet.residence_time(late), taken, rtol=1e-4)
    assert float(jet.position_of(10.0)) == pytest.approx(
        np.interp(10 * jet.initial_velocity, own.velocity[:500], own.z[:500]), rel=0.02
    )


def test_a_run_along_it_dries_by_the_slip(scene):
    wet = load_scene("pan12-blown", ["effects.evaporation=true", "network.model=affine"])
    result = sl.run(wet)
    assert {"air_velocity", "tension", "axial_stress", "wave_speed_squared"} <= set(result)
    assert result.attrs["verdicts"] == "converged"
    jet = build_jet(wet, build_solution(wet))
    path = straight_path(jet, np.linspace(1e-4, 10e-3, 9))
    np.testing.assert_allclose(path.axial(path.position), jet.slip(path.position))
    loss = float(result["evaporated_fraction"][-1])
    slow = sl.run(load_scene("pan12-blown", ["effects.evaporation=true", "network.model=affine", "jet.drag=matsui"]))
    assert 1e-3 < loss < 0.5
    assert float(slow["evaporated_fraction"][-1]) != loss
    still = load_scene("pan12-blown", ["ambient.air_velocity=1 m/s"])
    with pytest.raises(InputError, match=r"ambient\.air_velocity"):
        build_jet(still, build_solution(still))


def test_a_newtonian_scene_is_the_reference_case():
    loaded = load_scene("pan12-blown", ["jet.law=newton"])
    jet = build_jet(loaded, build_solution(loaded))
    assert jet.solved.verdict == "converged"
    assert jet.settings.solution.relaxation_time == 0
    assert jet.solved.bending_start == pytest.approx(1.1e-3, rel=0.05)
    pressed = load_scene("pan12-blown", ["jet.law=newton"])
    made = pressed.jet.model_copy(update={"air_velocity": None, "pressure_ratio": Measured(1.2, 0.0, "1.2")})
    gas = build_jet(pressed.model_copy(update={"jet": made}), build_solution(pressed)).settings.air
    assert gas.exit_velocity == pytest.approx(172.9125, abs=1e-3)


def test_beads_behind_it_are_a_jet_too():
    loaded = load_scene("pan12-blown", ["jet.bending=true", "collector.distance=8 mm", "jet.time=3 ms"])
    jet = build_jet(loaded, build_solution(loaded))
    assert isinstance(jet, LagrangianJet)
    arc = jet.arc_length[jet.usable]
    assert arc[0] < 1e-4  # the straight part is in it
    assert (np.diff(arc) > 0).all()
    radius = jet.radius(np.array([1e-5, 0.9e-3, 5e-3]))
    assert radius[0] > 5 * radius[1] > 5 * radius[2]
    path = bead_path(jet)
    assert np.abs(path.axial(path.position)).max() > 100  # against the air


@pytest.mark.slow
def test_the_commands(spinline, tmp_path):
    ran = spinline("jet", "pan12-blown", "--figure", "jet.png", "--csv", "jet.csv")
    assert ran.code == 0, ran.err
    assert "converged" in ran.out
    assert "bending may begin at" in ran.out
    assert (tmp_path / "jet.png").read_bytes().startswith(b"\x89PNG")
    told = json.loads(spinline("jet", "pan12-blown", "--json").out)
    assert told["verdict"] == "converged"
    assert told["force_balance"] < 1e-6
    ran = spinline(
        "spin",
        "pan12-blown",
        *SHORT,
        "-o",
        "j.nc",
        "--figure",
        "s.png",
        "--json",
        "--set",
        "jets.count=2",
        "--set",
        "jets.spacing=5 mm",
    )
    assert ran.code == 0, ran.err
    answer = json.loads(ran.out)
    assert answer["jets"] == 2
    assert answer["landed"] > 50
    assert abs(answer["volume_imbalance"]) < 1e-12
    assert 1e-7 < answer["flight_radius"] < 1e-5
    ran = spinline("deposit", "j.nc", "-o", "f.h5", "--json")
    assert ran.code == 0, ran.err
    laid = json.loads(ran.out)
    ran = spinline(
        "deposit", "pan12-blown", *SHORT, "--set", "jets.count=2", "--set", "jets.spacing=5 mm", "-o", "g.h5", "--json"
    )
    assert json.loads(ran.out)["length"] == pytest.approx(laid["length"], rel=1e-12)  # the same jets, run again
    with sl.deposit.FibreFile(tmp_path / "f.h5") as file:
        rows = sl.deposit.Segments.join(list(file.chunks()))
    assert set(rows.jet.tolist()) == {0, 1}
    apart = [rows.y[rows.jet == k].mean() for k in (0, 1)]
    assert apart[1] - apart[0] == pytest.approx(5e-3, abs=1.5e-3)
    ran = spinline("mat", "f.h5", "--no-figure", "--realisations", "2")
    assert ran.code == 0, ran.err


def test_a_sweep_of_its_air():
    sweep = sweep_from_dict(
        {
            "scene": "pan12-blown",
            "set": {"network.model": "affine"},
            "vary": {"jet.air_velocity": ["100 m/s", "300 m/s"]},
        }
    )
    rows = run_sweep(sweep, workers=1)
    assert (rows["status"].values == 0).all()
    assert float(rows["end_radius"][1]) != float(rows["end_radius"][0])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (["jet.pressure_ratio=1.2"], "one of air_velocity and pressure_ratio"),
        (["jet.air_velocity=200"], "needs a unit"),
        (["jet.spread=0.5"], "spread"),
        (["jet.start=2 cm"], r"beyond jet\.length"),
        (["jet.law=giesekus"], "law"),
        (["jet.nozzle_amplitude=1 um"], "nozzle_frequency"),
        (["jet.air_velocity=350 m/s"], "plain nozzle"),
        (["jet.nozzle_diamter=1 mm"], "nozzle_diameter"),
        (["jet.law=fene-p", "jet.extensibility=2"], "extensibility"),
        (["jet.law=ucm", "solution.relaxation_time=10 us"], "critical"),
    ],
)
def test_what_cannot_be_is_refused_by_name(change, words):
    def built():
        loaded = load_scene("pan12-blown", change)
        return build_jet(loaded, build_solution(loaded))

    with pytest.raises(InputError, match=words):
        built()


def test_what_the_commands_refuse(spinline):
    for arguments, words in (
        (("spin", "pan12-blown", "--xyz", "a.xyz"), "spun jets"),
        (("spin", "pan12-blown", "--quick"), "element_length"),
        (("spin", "pan12-blown", "--set", "collector.distance=0.5 mm"), "jet.start"),
        (("deposit", "pvp-spun"), "spinline spin"),
    ):
        ran = spinline(*arguments)
        assert ran.code == 2, arguments
        assert words in ran.err
    bare = load_scene("pan12-blown").model_copy(update={"collector": None})
    from spinline.setup.blown import blown_run

    with pytest.raises(InputError, match="collector"):
        blown_run(bare, build_solution(bare))
