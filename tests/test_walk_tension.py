"""Strands walked under the tension of every rung, along straight jets and bead jets."""

import warnings

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.network import random_walk
from spinline.scene import load_scene

FEW = ["accuracy.points=9", "accuracy.strands=1500", "solution.relaxation_time=20 ms", "network.coupling=3000"]


def run(*overrides, name="peo5-water"):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        return sl.run(load_scene(name, [*FEW, *overrides]))


def walked(tension, *overrides, **more):
    return run("network.model=walk", f"network.walk_tension={tension}", *overrides, **more)


@pytest.mark.parametrize("tension", ["manifold", "two-fluid"])
@pytest.mark.parametrize("name", ["peo5-water", "pvp-jetspin"])
def test_lattice_strands_come_back_to_the_stretch_that_was_solved_for(tension, name):
    """An independent sample of the lattice walk under f_0 T has the mean that the rung's inverse of the same law says."""
    sampled, solved = walked(tension, name=name), run(f"network.model={tension}", name=name)
    assert sampled.attrs["model"] == "walk"
    assert sampled.attrs["walk_tension"] == tension
    assert sampled.attrs["closure"] == "stretch"
    for key in ("strand_stretch", "network_velocity_ratio", "slip_velocity", "strand_force", "far_end_effect"):
        np.testing.assert_allclose(sampled[key], solved[key], rtol=1e-12)
    known = np.isfinite(solved["stretch_ratio"].values)
    error, exact = sampled["axial_stretch_std_error"].values[known], solved["strand_stretch"].values[known]
    off = sampled["axial_stretch"].values[known] - exact
    assert (np.abs(off) < 5 * error + 3e-4 * exact).all()  # next to the contour one step in thousands counts
    inner = exact < 0.9 * exact.max()
    assert inner.any() or name == "pvp-jetspin"  # locked to the nozzle
    assert not inner.any() or 0.4 < np.std(off[inner] / np.maximum(error[inner], 1e-9)) < 2


def test_relaxed_strands_are_walked_under_what_they_have_kept():
    sampled, solved = walked("conformation"), run("network.model=conformation")
    for key in ("axial_stretch", "orientation"):
        off = (sampled[key] - solved[key]).values / np.maximum(sampled[f"{key}_std_error"].values, 1e-9)
        assert np.abs(off).max() < 5
    expected = random_walk(solved["strand_stretch"].values, float(solved["volume_fraction"]))
    np.testing.assert_allclose(solved["axial_stretch"], expected.axial_stretch, rtol=1e-9)
    assert float(sampled["end_axial_stretch"]) < 0.8 * float(run("network.model=walk")["end_axial_stretch"])


def test_another_law_is_judged_by_the_walk():
    """FENE bears more than the lattice at the same stretch: walks under its tension are longer, once they feel their contour."""
    sampled = walked("two-fluid", "network.force_law=fene")
    beyond = sampled["strand_stretch"].values > 8
    assert (sampled["axial_stretch"].values[beyond] > 1.1 * sampled["strand_stretch"].values[beyond]).all()


def test_joined_strands_are_walked_at_their_own_length():
    more = ["effects.disentanglement=true", "rheology.entanglement_release=1", "solution.relaxation_time=200 ms"]
    sampled, solved = walked("conformation", *more), run("network.model=conformation", *more)
    assert float(solved["entanglements_left"][-1]) < 0.7
    off = np.abs((sampled["axial_stretch"] - solved["axial_stretch"]).values)
    # five standard errors, and a segment of some hundred: their number is rounded
    assert (off < 5 * sampled["axial_stretch_std_error"].values + 2e-3 * solved["axial_stretch"].values).all()


def test_by_default_it_is_the_affine_force():
    plain, named = run("network.model=walk"), walked("affine")
    np.testing.assert_array_equal(plain["axial_stretch"], named["axial_stretch"])


def test_refusals_name_what_would_do():
    with pytest.raises(InputError, match=r"network\.walk_tension.*is of model = \"walk\""):
        load_scene("peo5-water", ["network.walk_tension=manifold"])
    with pytest.raises(InputError, match=r"network\.closure.*walk_tension"):
        walked("affine", "network.closure=stretch")
    with pytest.raises(InputError, match=r"network\.model.*straight"):
        walked("chain", name="pvp-jetspin")
    with pytest.raises(InputError, match=r"network\.walk_tension"):
        load_scene("peo5-water", ["network.model=walk", "network.walk_tension=walk"])
