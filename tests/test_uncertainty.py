"""Inputs with +/-: closed-form shares, one-sided inputs, numbers that are not reached, the summary of the structure."""

import warnings

import numpy as np
import pytest

from spinline.base.errors import SpinlineWarning
from spinline.report import words
from spinline.scene import load_scene
from spinline.solve import run
from spinline.solve.uncertainty import uncertain_inputs


def quiet(*overrides, name="peo5-water"):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        return run(load_scene(name, overrides))


@pytest.mark.parametrize(
    ("override", "power"),
    [
        ('jet.k="1.0 +/- 0.001"', -1 / 0.47),
        ('jet.radius="125 +/- 0.125 um"', 1.0),
        ('solution.volume_fraction="0.05 +/- 0.00005"', -1 / (2 * 0.47)),
    ],
)
def test_share_of_one_input_is_its_power(override, power):
    """z_S = r_0 (V_S / k^2)^(1 / 2 beta): one part in a thousand of an input, its power in the position."""
    drop = () if "volume" not in override else ("solution={polymer='PEO', solvent='water', volume_fraction=0.05}",)
    result = quiet(*drop, override)
    assert float(result["crossover_position_std"] / result["crossover_position"]) == pytest.approx(
        1e-3 * abs(power), rel=1e-4
    )


def test_independent_inputs_add_in_squares():
    each = ['jet.k="1.0 +/- 0.01"', 'jet.radius="125 +/- 1 um"', 'jet.beta="0.47 +/- 0.002"']
    alone = [float(quiet(one)["end_orientation_std"]) for one in each]
    together = quiet(*each)
    assert float(together["end_orientation_std"]) == pytest.approx(np.hypot(np.hypot(*alone[:2]), alone[2]), rel=1e-9)
    assert set(uncertain_inputs(load_scene("peo5-water", each))) == {"jet.k", "jet.radius", "jet.beta"}
    assert "±" in words(together)[-1]
    assert together["crossover_position_std"].attrs["units"] == "m"


def test_no_uncertainty_no_numbers():
    result = quiet()
    assert not [name for name in result.data_vars if str(name).endswith("_std")]
    assert "uncertain_inputs" not in result.attrs


def test_not_reached_and_not_movable():
    short = quiet("jet.length=1 mm", 'jet.k="1.0 +/- 0.01"')
    assert np.isnan(float(short["crossover_position_std"]))
    assert np.isfinite(float(short["end_orientation_std"]))
    one = quiet('jet.beta="0.999 +/- 0.01"')  # above 1 there is no power law
    assert float(one["crossover_position_std"]) > 0
    chain = quiet("network.model=walk", "accuracy.strands=10", "accuracy.points=5", 'jet.k="1.0 +/- 0.01"')
    assert "not followed" in chain.attrs["warnings"]
    assert "end_orientation_std" not in chain


def test_summary_of_the_structure():
    result = quiet()
    at = float(result["crossover_position"])
    assert float(result["crossover_orientation"]) == pytest.approx(float(result["orientation"].sel(z=at)), rel=1e-12)
    assert float(result["end_axial_stretch"]) == float(result["axial_stretch"][-1])
    fibre = float(result["radius"][-1]) * np.sqrt(float(result["mean_polymer_fraction"][-1]))
    assert float(result["fibre_radius"]) == pytest.approx(fibre, rel=1e-12)
    short = quiet("jet.length=1 mm")
    assert np.isnan(float(short["crossover_orientation"]))
    assert float(quiet(name="pvp-jetspin")["fibre_radius"]) > 0
