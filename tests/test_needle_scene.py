"""Scenes whose jet comes from the settings of the bench: run, plan, sweep, the jet command, and what is refused."""

import json

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.jetprofile.ehd import HyperboloidField, StraightEhdJet
from spinline.plan.choice import plan_scene
from spinline.scene.file import load_scene
from spinline.setup.build import build_jet, build_solution
from spinline.study.sweep import run_sweep, sweep_from_dict

QUICK = ["jet.field=hyperboloid", "jet.end=20 mm"]


@pytest.fixture(scope="module")
def scene():
    return load_scene("peo5-needle", QUICK)


def test_the_scenes_jet_is_that_of_its_settings(scene) -> None:
    jet = build_jet(scene, build_solution(scene))
    assert isinstance(jet, StraightEhdJet)
    x = jet.settings
    assert (x.voltage, x.gap, x.radius, x.conductivity) == (6e3, 0.1, 125e-6, 0.01)
    assert x.extensibility == pytest.approx(506.7, abs=0.5)  # phi^-2
    assert x.density == build_solution(scene).density
    assert jet.end == 5e-3
    # case C's local log with this solution's density and phi
    assert jet.current == pytest.approx(222.28e-9, rel=2e-3)


@pytest.mark.slow
def test_a_jet_that_a_coarser_way_to_it_loses() -> None:
    """With corrections to 1e-4 on the way the search ends at a fold that there is not."""
    settings = ["voltage=5.679 kV", "gap=23.70 cm", "flow_rate=0.02256 mL/hour"]
    asked = load_scene("peo5-needle", [*(f"jet.{key}" for key in settings), "solution.viscosity=0.6815 Pa s"])
    jet = build_jet(asked, build_solution(asked))
    assert float(jet.radius(5e-3)) == pytest.approx(1.6584e-7, rel=1e-4)


def test_a_run_along_it(scene) -> None:
    result = sl.run(scene)
    assert float(result["current"]) == pytest.approx(222.28e-9, rel=2e-3)
    assert float(result["bending_onset"]) == pytest.approx(11.2e-3, rel=0.02)
    assert {"tension", "tensile_stress", "line_charge", "conduction_share"} <= set(result)
    assert result["tension"].attrs["units"] == "N"
    assert "held" in result.attrs["verdicts"]
    assert result.attrs["jet_model"].startswith("fene-p")
    z = result["z"].values
    jet = build_jet(scene, build_solution(scene))
    np.testing.assert_allclose(result["radius"], jet.radius(z), rtol=1e-12)
    assert (np.diff(result["velocity"]) > 0).all()


@pytest.mark.slow
def test_the_plan_and_a_sweep_know_it(scene) -> None:
    assert plan_scene(scene, build_solution(scene), build_jet(scene, build_solution(scene))).model == "conformation"
    sweep = sweep_from_dict(
        {
            "scene": "peo5-needle",
            "set": {"jet.field": "hyperboloid", "jet.end": "20 mm"},
            "vary": {"jet.conductivity": ["0.01 S/m", "1e-10 S/m"]},
        }
    )
    rows = run_sweep(sweep, workers=1)
    assert float(rows["end_radius"][0]) == pytest.approx(125e-6 * 0.1573, rel=5e-3)
    assert float(rows["current"][0]) == pytest.approx(222.28e-9, rel=2e-3)
    assert int(rows["status"][1]) == 2
    assert "swells" in str(rows["reason"].values[1])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("jet.end=20 cm", "beyond the plate"),
        ("jet.length=20 cm", "beyond jet.end"),
        ("jet.field=point", "hyperboloid"),
        ("jet.permittivity=0.5", "permittivity"),
        ("jet.voltage=6", "needs a unit"),
        ("jet.law=maxwell", "law"),
        ("jet.solvent_share=0", "solvent_share"),
        ("jet.gap=0 m", "gap"),
    ],
)
def test_keys_that_cannot_be_right(change, words) -> None:
    with pytest.raises(InputError, match=words):
        load_scene("peo5-needle", [change])


def test_what_the_solution_must_say() -> None:
    scene = load_scene("peo5-needle")
    bare = scene.model_copy(update={"solution": scene.solution.model_copy(update={"relaxation_time": None})})
    with pytest.raises(InputError, match="relaxation_time"):
        build_jet(bare, build_solution(bare))
    bare = scene.model_copy(update={"solution": scene.solution.model_copy(update={"viscosity": None})})
    with pytest.raises(InputError, match="viscosity"):
        build_jet(bare, build_solution(bare))


def test_a_measured_field_from_a_table(tmp_path) -> None:
    z = np.concatenate(([0.0], np.geomspace(1e-6, 0.1, 300)))
    field = HyperboloidField(6e3, 0.1, 125e-6).axial(z)
    rows = "\n".join(f"{a * 1e3:.10g},{b / 1e3:.10g}" for a, b in zip(z, field, strict=True))
    (tmp_path / "field.csv").write_text(f"z [mm],field [kV/m]\n{rows}\n")
    loaded = load_scene("peo5-needle", ['jet.field={table="field.csv"}', "jet.end=20 mm"])
    loaded._folder = tmp_path
    jet = build_jet(loaded, build_solution(loaded))
    known = build_jet(load_scene("peo5-needle", QUICK), build_solution(loaded))
    assert jet.current == pytest.approx(known.current, rel=1e-3)
    loaded._folder = tmp_path / "none"
    with pytest.raises(InputError, match="does not exist"):
        build_jet(loaded, build_solution(loaded))


def test_the_jet_command(spinline, tmp_path) -> None:
    common = ("jet", "peo5-needle", "--set", "jet.field=hyperboloid", "--set", "jet.end=20 mm")
    ran = spinline(*common, "--figure", "jet.png", "--csv", "jet.csv")
    assert ran.code == 0, ran.err
    for words in ("current 222", "bending sets in", "held", "conducted"):
        assert words in ran.out
    assert (tmp_path / "jet.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "jet.csv").read_text().startswith("z [m],radius [m]")
    assert spinline(*common, "--csv", "jet.csv").code == 2  # exists
    told = json.loads(spinline(*common, "--json").out)
    assert {"current", "bending_onset", "verdicts", "profile"} <= set(told)
    refused = spinline(*common, "--set", "jet.conductivity=1e-10 S/m")
    assert refused.code == 2
    assert "swells" in refused.err
    assert spinline("jet", "peo5-water").code == 2


@pytest.mark.slow
def test_a_window_of_computed_jets(spinline, tmp_path) -> None:
    ran = spinline(
        "window",
        "peo5-needle",
        "--set",
        "jet.field=hyperboloid",
        "--set",
        "jet.length=10 mm",
        "--set",
        "network.model=affine",
        "--voltage",
        "5 kV .. 9 kV",
        "--gap",
        "10 cm",
        "--steps",
        "2",
    )
    assert ran.code == 0, ran.err
    assert "computed from their settings" in ran.out
    stored = sl.results.open_dataset(tmp_path / "peo5-needle-window.nc")
    reach = stored["crossover_position"].isel(k_factor=1).values.ravel()
    made = load_scene("peo5-needle", ["jet.field=hyperboloid", "jet.length=10 mm", "jet.voltage=9 kV"])
    jet = build_jet(made, build_solution(made))
    assert reach[-1] == pytest.approx(float(jet.position_of(1 / 0.0444258)), rel=1e-3)
    assert (tmp_path / "peo5-needle-window.png").exists()
