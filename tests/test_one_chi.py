"""One set of interaction parameters: the jet's balance and the verdict on its composition's path take the same."""

import numpy as np
import pytest

from spinline.rheology._heat_kernels import activities
from spinline.rheology.interactions import interaction, water_interaction
from spinline.rheology.ternary import Ternary
from spinline.scene.file import scene_from_dict
from spinline.setup.air import known_interaction, water_with
from spinline.setup.build import build_solution
from spinline.setup.heat import build_heated_air

SCENE = {
    "solution": {
        "polymer": "PMMA",
        "molar_mass": "120 kDa",
        "solvent": "acetone",
        "mass_fraction": 0.1,
        "temperature": "25 degC",
    },
    "jet": {
        "profile": "power-law",
        "radius": "100 um",
        "flow_rate": "1 mL/hour",
        "k": 1.0,
        "beta": 0.47,
        "length": "1 cm",
    },
    "ambient": {"relative_humidity": 0.6},
}


def balance(rheology: dict, solvent="acetone"):
    scene = scene_from_dict(
        {**SCENE, "solution": {**SCENE["solution"], "solvent": solvent}, **({"rheology": rheology} if rheology else {})}
    )
    solution = build_solution(scene)
    return scene, solution, build_heated_air(scene, solution)


@pytest.mark.parametrize("rheology", [{}, {"chi": 0.3, "chi_water": 2.0, "chi_water_solvent": 0.7}])
def test_the_balance_has_the_free_energy_of_the_path(rheology: dict) -> None:
    """Activities of the liquids in the compiled balance are the potentials of the ternary's energy, to 1e-9."""
    scene, solution, air = balance(rheology)
    values = known_interaction(scene, solution, "acetone"), known_interaction(scene, solution, "water")
    mutual = water_with(scene, "acetone")
    if rheology:
        assert (*values, mutual) == (0.3, 2.0, 0.7)
    else:
        assert values == (interaction("PMMA", "acetone")[0], interaction("PMMA", "water")[0])
        assert mutual == water_interaction("acetone")[0]
    acetone, water = air.evaporants
    v1, v2 = (e.molar_mass / e.density for e in (water, acetone))
    path = Ternary(v1, v2, 1e5, mutual, values[1], values[0])  # a chain as long as the balance's
    sub = np.array([[0, 0, 0, 0, 0, e.chi, 0, 0, 0, e.molar_mass / e.density] for e in (acetone, water)], float)
    for two, one in ((0.6, 0.1), (0.2, 0.01), (0.05, 0.3)):
        found = np.empty(2)
        activities(np.array([two, one]), 1 - one - two, sub, np.ascontiguousarray(air.pairs), 0.0, found)
        expected = path.potentials(np.array(one), np.array(1 - one - two))
        np.testing.assert_allclose(np.log(found), [v2 * expected[1], v1 * expected[0]], rtol=1e-9, atol=1e-9)


def test_what_is_not_known_mixes_without_heat() -> None:
    scene, solution, air = balance({}, {"ethanol": 0.5, "acetone": 0.5})
    assert water_with(scene, "ethanol") is None
    assert known_interaction(scene, solution, "ethanol") is None
    names = [e.name for e in air.evaporants]
    w, ethanol, acetone = (names.index(n) for n in ("water", "ethanol", "acetone"))
    assert air.pairs[w, ethanol] == 0.0 == air.pairs[ethanol, acetone]
    assert air.pairs[w, acetone] == air.pairs[acetone, w] > 0
    assert balance({}, "toluene")[2].pairs is None
    # water as a solvent takes chi_water where it is given, else chi
    for rheology, value in (({"chi_water": 0.3, "chi": 0.4}, 0.3), ({"chi": 0.4}, 0.4)):
        scene, solution, air = balance(rheology, {"ethanol": 0.5, "water": 0.5})
        assert known_interaction(scene, solution, "water") == value
        assert next(e for e in air.evaporants if e.name == "water").chi == value
