"""Uncertainty of the inputs in the rows of a sweep, by closed forms and by runs alike."""

import tomllib
import warnings

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.scene import scene_from_dict
from spinline.scene.keys import placed
from spinline.study.rows import SCALARS
from spinline.study.sweep import run_sweep, sweep_from_dict

VARY = {
    "jet.k": {"loguniform": [0.3, 3.0]},
    "jet.beta": {"uniform": [0.25, 0.9]},
    "solution.mass_fraction": {"uniform": ["1 wt%", "30 wt%"]},
    "jet.length": {"loguniform": ["1 mm", "30 mm"]},
}


def test_rows_hold_the_structure_and_what_the_inputs_leave_of_it():
    uncertain = {"network.model": "affine", "jet.radius": "125 +/- 3 um", "solution.temperature": "293 +/- 2 K"}
    data = {
        "scene": "peo5-water",
        "set": uncertain,
        "design": {"kind": "latin-hypercube", "samples": 24, "seed": 3},
        "vary": VARY,
    }
    sweep = sweep_from_dict(data)
    fast, slow = run_sweep(sweep), run_sweep(sweep, vectorise=False, workers=1)
    assert fast.attrs["computed_by"].startswith("closed forms")
    assert set(fast.attrs["uncertain_inputs"].split(", ")) == {"jet.radius", "solution.temperature"}
    for name in SCALARS:
        room = 1e-9 * np.abs(slow[name])
        for suffix in ("", "_std"):
            gap = np.abs(fast[name + suffix] - slow[name + suffix])
            assert (np.isnan(gap) | (gap <= room)).all(), name + suffix
            np.testing.assert_array_equal(np.isnan(fast[name + suffix]), np.isnan(slow[name + suffix]))
    assert (fast["uncertainty"] == 0).all()
    base = tomllib.loads(sl.scene.bundled_scenes()["peo5-water"].read_text())
    base["network"], base["jet"]["radius"] = {"model": "affine"}, "125 +/- 3 um"
    base["solution"]["temperature"] = "293 +/- 2 K"
    i = int(np.flatnonzero(fast["status"] == 0)[0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        run = sl.run(
            scene_from_dict(
                placed(base, {key: fast[key].values.tolist()[i] for key in VARY}) | {"accuracy": {"draws": 0}}
            )
        )
    for name in ("crossover_position", "crossover_axial_stretch", "end_network_radius", "fibre_radius"):
        np.testing.assert_allclose(fast[name][i], run[name], rtol=1e-12)
        np.testing.assert_allclose(fast[f"{name}_std"][i], run[f"{name}_std"], rtol=1e-7, atol=1e-12 * float(run[name]))


def test_what_is_not_followed_has_a_flag_and_vitrification_is_a_column():
    walk = {"network.model": "walk", "accuracy.strands": 10, "accuracy.points": 5, "jet.radius": "125 +/- 3 um"}
    result = run_sweep(sweep_from_dict({"scene": "peo5-water", "set": walk, "vary": {"jet.k": [0.9, 1.1]}}), workers=1)
    assert (result["uncertainty"] == 2).all()
    assert np.isnan(result["fibre_radius_std"]).all()
    dry = {"scene": "pmma10-drying", "set": {"jet.radius": "50 +/- 1 um"}, "vary": {"jet.k": [0.5]}}
    result = run_sweep(sweep_from_dict(dry), workers=1)
    assert result["frozen_orientation"].notnull().all()
    assert (result["frozen_position_std"] > 0).all()
    assert "uncertainty" not in run_sweep(sweep_from_dict({"scene": "peo5-water", "vary": {"jet.k": [0.9, 1.1]}}))


def test_an_uncertainty_of_what_varies_is_refused():
    with pytest.raises(InputError, match="carries an uncertainty"):
        sweep_from_dict({"scene": "peo5-water", "vary": {"jet.radius": ["100 +/- 3 um", "120 um"]}})
