"""The two-fluid rung, its ends, disentanglement, lateral time and odd crossovers through a scene and the command line."""

import importlib.util
import json
import warnings
from pathlib import Path

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.scene import load_scene

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
THETA = "solution.relaxation_time=20 ms"


def run(*overrides, name="peo5-water"):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        return sl.run(load_scene(name, list(overrides)))


def campaign(name):
    spec = importlib.util.spec_from_file_location(name, BENCHMARKS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_window_no_longer_decides():
    """PEO 5 wt%, lattice: the elastic network is flagged at every length; with relaxation one answer within rtol."""
    answers = []
    for length in ("4 mm", "5 mm", "6 mm", "8 mm"):
        elastic = run("network.model=manifold", f"jet.length={length}")
        assert float(elastic["far_end_effect"]) > 0.01 or "leaves the nozzle at 22.5 v_0" in elastic.attrs["warnings"]
        assert "the far end decides" in elastic.attrs["warnings"] or "leaves the nozzle" in elastic.attrs["warnings"]
        relaxing = run("network.model=two-fluid", THETA, f"jet.length={length}")
        assert float(relaxing["far_end_effect"]) < 0.01
        assert "far end" not in relaxing.attrs["warnings"]
        answers.append(
            [
                np.interp(3.9e-3, relaxing["z"], relaxing[name])
                for name in ("strand_stretch", "network_velocity_ratio", "orientation", "core_polymer_fraction")
            ]
        )
    np.testing.assert_allclose(answers, [answers[-1]] * 4, rtol=2e-3)


def test_end_values_are_no_boundary_layer():
    """A softer network: with a free end the last value is rest; with the default it is the network's."""
    free = run("network.model=manifold", "network.force_law=linear", "network.coupling=300", "network.end=free")
    taken = run("network.model=manifold", "network.force_law=linear", "network.coupling=300")
    extended = run("network.model=manifold", "network.force_law=linear", "network.coupling=300", "network.end=extended")
    assert float(free["network_velocity_ratio"][-1]) == pytest.approx(1.0)
    assert float(free["end_relative_extension"]) < 0.06
    last = float(taken["network_velocity_ratio"][-1])
    assert last == pytest.approx(32.058 * (1 + 0.01 * 0.7534), rel=1e-3)  # V (1 + eps V')
    assert float(extended["network_velocity_ratio"][-1]) == pytest.approx(last, rel=1e-3)
    assert taken.attrs["network_end"] == "take-up"
    assert float(free["far_end_effect"]) > 1 > 0.01 > float(taken["far_end_effect"])
    with pytest.raises(InputError, match=r"network\.end"):
        load_scene("peo5-water", ["network.end=closed"])


def test_it_meets_both_rungs():
    linear = "network.force_law=linear"
    elastic = run("network.model=manifold", linear, "network.coupling=500")
    slow = run("network.model=two-fluid", "solution.relaxation_time=1e5 s", linear, "network.coupling=500")
    at = elastic["z"].values
    np.testing.assert_allclose(
        np.interp(at, slow["z"], slow["network_velocity_ratio"]), elastic["network_velocity_ratio"], rtol=1e-3
    )
    relaxed = run("network.model=conformation", THETA)
    stiff = run("network.model=two-fluid", THETA, linear, "network.coupling=1e9")
    np.testing.assert_allclose(
        np.interp(relaxed["z"], stiff["z"], stiff["strand_stretch"]), relaxed["strand_stretch"], rtol=2e-4
    )
    np.testing.assert_allclose(relaxed["network_velocity_ratio"], relaxed["velocity_ratio"], rtol=1e-12)


def test_the_flux_in_the_file():
    for overrides in (
        ["network.model=two-fluid", THETA],
        [],
        ["network.closure=stretch"],
        ["network.model=conformation", THETA],
    ):
        result = run(*overrides, "jet.length=3 mm")
        carried = (
            result["core_polymer_fraction_conservative"]
            * result["flux_velocity_ratio"]
            * (result["network_radius_conservative"] / result["radius"]) ** 2
        )
        expected = float(result["volume_fraction"]) * result["velocity_ratio"].values
        np.testing.assert_allclose(carried, expected, rtol=1e-10)


def test_along_a_bead_jet():
    for model in ("manifold", "two-fluid"):
        result = run(
            f"network.model={model}",
            "network.force_law=linear",
            "network.coupling=500",
            "solution.relaxation_time=5 ms",
            name="pvp-jetspin",
        )
        known = np.isfinite(result["stretch_ratio"].values)
        w = result["network_velocity_ratio"].values[known]
        assert np.isfinite(w).all()
        assert (w > 0).all()
        assert float(result["far_end_effect"]) < 0.01
    assert float(result["strand_stretch"].values[known][-1]) < 0.9 * float(w[-1])


def test_disentanglement():
    slow = ["solution.relaxation_time=200 ms", "network.model=conformation"]
    kept = run(*slow)
    off = run(*slow, "effects.disentanglement=true", "rheology.entanglement_release=0")
    on = run(*slow, "effects.disentanglement=true", "rheology.entanglement_release=1")
    assert "entanglements_left" not in kept
    np.testing.assert_array_equal(off["entanglements_left"], 1.0)
    nu = on["entanglements_left"].values
    assert (np.diff(nu) <= 0).all()
    assert 0 < nu[-1] < 0.5
    # the same strands on a longer contour: less extended, less oriented, a wider core
    ratio = on["axial_stretch"].values[-1] / off["axial_stretch"].values[-1]
    assert on["relative_extension"].values[-1] == pytest.approx(
        off["relative_extension"].values[-1] * ratio * np.sqrt(nu[-1]), rel=1e-6
    )
    assert on["orientation"].values[-1] < off["orientation"].values[-1]
    assert "Rolie-Poly" in on.attrs["constitutive_model"]
    lost = run(
        "solution.relaxation_time=2 s",
        "network.model=conformation",
        "effects.disentanglement=true",
        "rheology.entanglement_release=1",
        "solution.molar_mass=250 kg/mol",
    )
    assert ("the network is lost at" in lost.attrs["warnings"]) == bool(
        (lost["entanglements_left"].values * 2.4 < 1).any()
    )
    with pytest.raises(InputError, match=r"effects\.disentanglement"):
        run("effects.disentanglement=true", "network.model=manifold", THETA)


def test_time_to_contract_is_said():
    result = run()
    assert float(result["lateral_time"]) == pytest.approx(1.1e-3, rel=0.05)
    assert "Eq. (39) needs a lateral tension beyond f_0" in result.attrs["lateral_contraction"]
    plan = json.loads(result.attrs["plan"])
    (effect,) = [one for one in plan["effects_left_out"] if one["name"] == "lateral time"]
    assert effect["estimated_error"] == pytest.approx(3.0, abs=0.1)  # 1 against 0.25
    assert "drag of xi mu" in effect["reason"]


def test_check_says_what_eq_39_takes_for_granted(spinline):
    said = spinline("check", "peo5-water")
    assert said.out.startswith("note: F = 0.0011")
    assert said.out.endswith("nothing odd\n")


def test_crossovers_that_a_profile_does_not_hold():
    assert "radii from the nozzle" in run("jet.k=8").attrs["warnings"]
    assert "radii from the nozzle" not in run().attrs["warnings"]


def test_a_table_that_starts_beyond(tmp_path):
    z = np.linspace(1e-3, 5e-3, 60)
    radius = 125e-6 * (z / 125e-6) ** -0.47 / 2.5
    table = tmp_path / "jet.csv"
    table.write_text("z_m,radius_m\n" + "\n".join(f"{a:.9g},{b:.9g}" for a, b in zip(z, radius, strict=True)))
    text = load_scene("peo5-water").text
    head, jet = text.split("[jet]")
    rest = jet.split("[", 1)
    scene = tmp_path / "scene.toml"
    scene.write_text(
        f'{head}[jet]\nprofile = "table"\npath = "{table.name}"\nradius = "125 um"\nflow_rate = "3.2 mL/hour"\n'
        + (f"[{rest[1]}" if len(rest) > 1 else "")
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.SpinlineWarning)
        result = sl.run(load_scene(str(scene)))
    if np.isnan(float(result["crossover_position"])):
        assert "lies before the profile" in result.attrs["warnings"]


def test_no_number_jumps_where_auto_changes_the_rung():
    """A short replay of benchmarks/continuity.py, and its committed numbers: 3 rtol at most, everywhere."""
    rows = json.loads((BENCHMARKS / "continuity.json").read_text())
    assert rows["steps"] == 200
    assert sum(len(one["changes"]) for one in rows["sweeps"].values()) >= 15
    for one in rows["sweeps"].values():
        assert all(jump <= 3 for jump in one["largest_jump_over_rtol"].values())
    module = campaign("continuity")
    assert set(rows["sweeps"]) == set(module.SWEEPS)
    values, rungs = module.sweep("concentration, both", 14)
    assert set(rungs) == {"affine", "two-fluid", "conformation", "manifold"}
    over, _ = module.jumps("concentration, both", values, rungs)
    assert max(over.values()) <= 3


def test_blobs_of_a_good_solvent_are_refused_or_said(spinline):
    """The Pincus regime: no law of force by that name; where it matters a remark holds its numbers, and else there is none."""
    done = spinline("check", "peo5-water", "--set", "network.force_law=pincus")
    assert done.code
    assert "network.force_law: has no Pincus law" in done.err

    def said(*settings):
        return run("network.solvent_quality=good", *settings).attrs["warnings"]

    phi = float(run()["volume_fraction"])
    words = said()
    assert f"overstates their extension by up to {phi ** (-1 / 6):.2g}" in words
    assert "slip, over" not in words
    slipping = said("network.model=manifold", "network.force_law=linear")
    assert f"overstates their extension by up to {phi ** (-1 / 6):.2g}, and the tension" in slipping
    bounded = said("network.model=two-fluid", "solution.relaxation_time=20 ms")
    assert f"at rest, is too small by up to {phi**-0.25:.2g}" in bounded
    assert "overstates" not in bounded
    assert "Pincus" not in said("network.model=affine", "network.closure=stretch")
    assert "Pincus" not in run().attrs["warnings"]


def test_what_relaxes_without_drying_is_drawn_without_a_word():
    """No volume is lost and there is no stress of a solution: that panel is left out."""
    from matplotlib import pyplot as plt

    from spinline.report.figures import figure

    found = run("network.model=two-fluid", THETA)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sheet = figure(found)
    assert [axis.axison for axis in sheet.axes].count(False) == 1
    plt.close(sheet)
