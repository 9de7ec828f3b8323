"""The fibre of a network whose strands relax while it moves with the jet: no section holds more polymer than itself."""

import warnings

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import SpinlineWarning
from spinline.scene.file import scene_from_dict

SCENE = {
    "solution": {
        "polymer": "PCL",
        "molar_mass": "80 kDa",
        "solvent": "DCM",
        "mass_fraction": 0.05,
        "temperature": "25 degC",
        "viscosity": "2 Pa s",
        "relaxation_time": "5 ms",
    },
    "jet": {
        "profile": "power-law",
        "radius": "125 um",
        "flow_rate": "1 mL/hour",
        "k": 1.0,
        "beta": 0.47,
        "length": "5 cm",
    },
    "ambient": {"temperature": "400 K"},
    "network": {"model": "two-fluid"},
    "effects": {"evaporation": True, "heat": True, "relaxation": True},
    "accuracy": {"points": 101},
}


def test_the_fibre_is_no_wider_than_the_section_that_became_solid() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        result = sl.run(scene_from_dict(SCENE))
    radius, fraction, slip = (float(result[name]) for name in ("frozen_radius", "arrest_fraction", "arrest_slip"))
    assert float(result["fibre_radius"]) == pytest.approx(radius * np.sqrt(fraction / slip), rel=1e-12)
    assert float(result["fibre_radius"]) <= radius * (1 + 1e-12)
    # strands keep 1.2 of a stretch of 200; the network itself goes with the jet
    i = int(np.searchsorted(result["z"].values, float(result["arrest_position"])))
    assert result["strand_stretch"].values[i] < 0.02 * result["stretch_ratio"].values[i]
    assert slip == pytest.approx(
        result["network_velocity_ratio"].values[i] / result["velocity_ratio"].values[i], abs=1e-3
    )
    assert slip == pytest.approx(1.0, abs=1e-3)
