"""The plan takes the jet's cooling where it matters, says by how much, and is right about it."""

import warnings

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import SpinlineWarning
from spinline.plan import plan_scene
from spinline.scene.file import scene_from_dict
from spinline.setup.build import build_jet, build_solution

BASE = {
    "solution": {"polymer": "PVP", "molar_mass": "1300 kDa", "solvent": "ethanol", "mass_fraction": 0.1},
    "jet": {"profile": "power-law", "radius": "100 um", "flow_rate": "1 mL/hour", "k": 1.0, "beta": 0.47, "length": "10 cm"},
    "ambient": {"relative_humidity": 0.4},
    "network": {"model": "affine"},
    "accuracy": {"points": 101},
}  # fmt: skip


def scene(length: str, humidity: float, solvent: str, **effects: bool):
    data = {**BASE, "jet": {**BASE["jet"], "length": length}, "ambient": {"relative_humidity": humidity}}
    data["solution"] = {**BASE["solution"], "solvent": solvent, "temperature": "25 degC"}
    return scene_from_dict({**data, "effects": effects})


def planned(one):
    solution = build_solution(one)
    return plan_scene(one, solution, build_jet(one, solution))


@pytest.mark.parametrize(("solvent", "humidity"), [("ethanol", 0.4), ("acetone", 0.0), ("DMF", 0.2)])
def test_the_estimate_of_cooling_is_the_change_of_dryness(solvent: str, humidity: float) -> None:
    plan = planned(scene("10 cm", humidity, solvent))
    heat = plan.effect("evaporative cooling")
    assert heat.name in plan.used
    assert "K below the air; dryness changes by" in heat.words
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        warm, cool = (
            sl.run(scene("10 cm", humidity, solvent, evaporation=True, heat=on))["mean_polymer_fraction"].values
            for on in (False, True)
        )
    truth = float(np.nanmax(np.abs(warm / cool - 1)))
    assert 0.5 < heat.error / truth < 1.5
    assert heat.error > plan.rtol


def test_where_nothing_dries_nothing_cools() -> None:
    plan = planned(scene("1 mm", 0.4, "DMF"))
    heat = plan.effect("evaporative cooling")
    assert heat.name in plan.left_out
    assert heat.error < plan.rtol
