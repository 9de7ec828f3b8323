"""Mistakes in a sweep file or its table, and where a sweep file is found."""

import json

import pytest

from spinline.base.errors import InputError
from spinline.study.sweep import load_sweep, run_sweep, sweep_from_dict

BAD = {
    "scene": ("scene = 3", "scene = 3: is neither a name nor a scene"),
    "missing scene": ("[vary]\njet.k = [1]", "scene: is missing"),
    "unknown scene": ('scene = "peo5-watr"', "did you mean 'peo5-water'"),
    "nothing varies": ('scene = "peo5-water"', "vary: is missing or empty"),
    "top": ('scene = "peo5-water"\nprofile = []', "did you mean 'profiles'"),
    "key": ('scene = "peo5-water"\n[vary]\nk = [1]', 'did you mean "jet.k"'),
    "one": ('scene = "peo5-water"\n[vary]\njet.k = 1', "nothing varies"),
    "form": ('scene = "peo5-water"\n[vary]\njet.k = { linspce = [1, 2, 3] }', "needs one way to vary"),
    "two forms": (
        'scene = "peo5-water"\n[vary]\njet.k = { values = [1], linspace = [1, 2, 3] }',
        "needs one way to vary",
    ),
    "unit": ('scene = "peo5-water"\n[vary]\njet.radius = [100]', "vary.jet.radius.values = 100: needs a unit"),
    "range": ('scene = "peo5-water"\n[vary]\njet.beta = [0.1]', "vary.jet.beta.values = 0.1: is out of range"),
    "word": ('scene = "peo5-water"\n[vary]\nmodel = ["afine"]', '= \'afine\': is not known; allowed: "auto", "affine"'),
    "words spaced": ('scene = "peo5-water"\n[vary]\nmodel = { linspace = [1, 2, 3] }', "holds words"),
    "steps": ('scene = "peo5-water"\n[vary]\njet.k = { linspace = [1, 2] }', "[from, to, number]"),
    "step count": ('scene = "peo5-water"\n[vary]\njet.k = { linspace = [1, 2, 2.5] }', "whole number of steps"),
    "log": (
        'scene = "peo5-water"\n[vary]\nambient.air_velocity = { logspace = ["-1 m/s", "1 m/s", 3] }',
        "take linspace",
    ),
    "swapped": (
        'scene = "peo5-water"\n[design]\nkind = "sobol"\nsamples = 4\n[vary]\njet.k = { uniform = [2, 1] }',
        "swap the ends",
    ),
    "kind": ('scene = "peo5-water"\n[design]\nkind = "lhs"\n[vary]\njet.k = [1]', "design.kind = 'lhs'"),
    "samples": ('scene = "peo5-water"\n[design]\nkind = "sobol"\n[vary]\njet.k = [1]', "design.samples: is missing"),
    "design key": ('scene = "peo5-water"\n[design]\nsample = 3\n[vary]\njet.k = [1]', "did you mean 'samples'"),
    "range in grid": ('scene = "peo5-water"\n[vary]\njet.k = { uniform = [1, 2] }', "a grid needs steps"),
    "both": ('scene = "peo5-water"\n[vary]\njet.k = [1]\njet.electric_field = ["1 kV/m"]', "one sets the other"),
    "too many": (
        'scene = "peo5-water"\n[vary]\njet.k = { linspace = [1, 2, 1000000] }\njet.beta = { linspace = [0.3, 0.5, 1000000] }',
        "makes 1e+12 scenes",
    ),
    "set": ('scene = "peo5-water"\nset = { jet.length = 3 }\n[vary]\njet.k = [1]', "set.jet.length = 3: needs a unit"),
    "no table": ('scene = "peo5-water"\n[design]\nkind = "table"\npath = "x.csv"', "is not a file"),
    "profile": ('scene = "peo5-water"\nprofiles = ["radus"]\n[vary]\njet.k = [1]', "did you mean 'radius'"),
    "points": ('scene = "peo5-water"\npoints = 1\n[vary]\njet.k = [1]', "points = 1: is not a whole number in range"),
    "bead profile": (
        'scene = "pvp-jetspin"\nprofiles = ["radius"]\n[vary]\nsolution.mass_fraction = [0.02]',
        "straight jet",
    ),
    "wrong base": (
        '[scene.solution]\npolymer = "PEOX"\nsolvent = "water"\nmass_fraction = 0.1\n[scene.jet]\nprofile = "power-law"\n'
        'radius = "1 um"\nflow_rate = "1 mL/h"\nlength = "1 mm"\nbeta = 0.5\n[vary]\njet.k = [1]',
        "error: scene.solution.polymer = 'PEOX': is not built in",
    ),
    "no such key there": ('scene = "pvp-jetspin"\n[vary]\njet.k = [1]', "error: jet.k = "),
    "one parameter": (
        'scene = "peo5-water"\n[design]\nkind = "sensitivity"\nsamples = 4\n[vary]\njet.k = { uniform = [1, 2] }',
        "one key",
    ),
    "power of two": (
        'scene = "peo5-water"\n[design]\nkind = "sensitivity"\nsamples = 5\n[vary]\njet.k = { uniform = [1, 2] }\n'
        "jet.beta = { uniform = [0.3, 0.5] }",
        "take 8",
    ),
    "not TOML": ("scene = ", "is not a TOML sweep"),
}


@pytest.mark.parametrize("what", BAD)
def test_a_mistake_in_the_file_is_one_message(what, spinline, tmp_path):
    text, words = BAD[what]
    (tmp_path / "s.toml").write_text(text)
    ran = spinline("sweep", "s.toml")
    assert ran.code == 2
    assert words in ran.err
    assert ran.err.startswith("error: ")
    assert ran.err.count("\n") == 1
    assert ";" in ran.err  # what is allowed, or what to do
    assert not (tmp_path / "s.zarr").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "holds no rows"),
        ("jet.k\n", "holds no rows"),
        ("jet.q\n1\n", 'did you mean "jet.'),
        ("jet.k,jet.k\n1,2\n", "is there twice"),
        ("jet.k\nx\n", "row 1, jet.k"),
        ("jet.radius\n100\n", "needs a unit"),
        ("jet.radius [kg]\n100\n", "is not a length"),
        ("jet.k [um]\n100\n", "has a unit"),
        ("jet.k,jet.beta\n1\n", "row 1, jet.beta: is empty"),
        ("model\nafine\n", "is not known"),
        ("jet.k,jet.beta\n0.5,0.5\n1,0,4\n", "row 2 = '1,0,4': has 3 cells under 2 keys; write decimals with points"),
    ],
)
def test_a_mistake_in_a_table_is_one_message(text, words, tmp_path):
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(InputError, match=None) as error:
        sweep_from_dict({"scene": "peo5-water", "design": {"kind": "table", "path": "t.csv"}}, folder=tmp_path)
    assert words in str(error.value)


def test_a_sweep_file_is_found_by_name_or_said_to_be_missing():
    with pytest.raises(InputError, match="cannot be read as a sweep"):
        load_sweep("nowhere.toml")


def test_json_of_the_base_scene_is_in_the_result():
    result = run_sweep(sweep_from_dict({"scene": "peo5-water", "vary": {"jet.k": [0.9, 1.1]}}))
    assert json.loads(result.attrs["base_scene"])["jet"]["beta"] == 0.47
