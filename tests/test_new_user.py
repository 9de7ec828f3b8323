"""One mistake each of a new user at the command line: the message says what to type instead."""

import pytest


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["run", "pan-dmf"], "it is a bundled recipe: `spinline fibre pan-dmf`"),
        (["check", "pan-dmf"], "`spinline fibre pan-dmf`"),
        (["spin", "pan-dmf"], "`spinline fibre pan-dmf`"),
        (["crossover", "pcl-dcm-dmf"], "`spinline fibre pcl-dcm-dmf`"),
        (["fibre", "peo5-water"], "it is a bundled scene: `spinline run peo5-water`"),
        (["fit", "peo5-water"], "`spinline run peo5-water`"),
        (["sweep", "peo5-simulated"], "it is a bundled fit: `spinline fit peo5-simulated`"),
        (["run", "peo-crossover"], "it is a bundled sweep: `spinline sweep peo-crossover`"),
        (["window", "peo5-images"], "it is a bundled file of images: `spinline reduce peo5-images`"),
        (["run", "peo5-watr"], "did you mean the bundled 'peo5-water'?"),
        (["run", "../../recipes/pan-dmf"], "lists the bundled ones"),
    ],
)
def test_a_name_of_another_command(spinline, given, words):
    ran = spinline(*given)
    assert ran.code == 2
    assert words in ran.err


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("5-25 kV", "5 .. 25 kV"),
        ("5 kV - 25 kV", "5 kV .. 25 kV"),
        ("5 to 25 kV", "5 .. 25 kV"),
        ("5 kV, 25 kV", "5 kV .. 25 kV"),
        ("15 +/- 2 kV", "13 .. 17 kV"),
        ("(15 ± 2) kV", "13 .. 17 kV"),
        ("15 kV +/- 20 %", "12 .. 18 kV"),
    ],
)
def test_a_window_says_how_a_range_is_written(spinline, tmp_path, given, meant):
    """A +/- had been dropped without a word: a window of one voltage."""
    out = ["--steps", "2", "--no-figure", "-o", tmp_path / "w.nc"]
    ran = spinline("window", "pan-dmf", "--voltage", given, *out)
    assert ran.code == 2
    assert f'write a range as "{meant}"' in ran.err
    assert spinline("window", "pan-dmf", "--voltage", meant, *out).code == 0


@pytest.mark.parametrize("scene", ["pvp-spun", "pan12-blown"])
def test_a_law_for_input_dat_is_refused_elsewhere(spinline, tmp_path, scene):
    """It had no effect, whatever it said."""
    ran = spinline("spin", scene, "--law", "oldroyd", "-o", tmp_path / "j.nc")
    assert ran.code == 2
    assert "--law" in ran.err
    assert "--set jet.law=" in ran.err


RECIPE = """[solution]
polymer = "PAN"
solvent = "DMF"
concentration = "10 wt%"
[jet]
voltage = "15 kV"
gap = "15 cm"
flow_rate = "1 mL/hour"
"""


@pytest.mark.parametrize("command", ["run", "check", "spin", "reduce", "fit", "sweep", "crossover"])
def test_a_recipe_given_to_another_command(spinline, tmp_path, command):
    (tmp_path / "mine.toml").write_text(RECIPE)
    ran = spinline(command, tmp_path / "mine.toml")
    assert ran.code == 2
    assert "is a recipe, not a" in ran.err
    assert "`spinline fibre` takes it" in ran.err


@pytest.mark.parametrize(
    ("command", "kind"), [("fibre", "recipe"), ("reduce", "file of images"), ("fit", "fit"), ("sweep", "sweep")]
)
def test_a_scene_given_to_another_command(spinline, tmp_path, command, kind):
    from spinline.scene.file import bundled_scenes

    (tmp_path / "mine.toml").write_text(bundled_scenes()["peo5-water"].read_text(encoding="utf-8"), encoding="utf-8")
    ran = spinline(command, tmp_path / "mine.toml")
    assert ran.code == 2
    assert f"is a scene, not a {kind}; `spinline run` takes it" in ran.err


def test_a_recipe_with_a_mistake_is_told_of_the_mistake(spinline, tmp_path):
    (tmp_path / "mine.toml").write_text(RECIPE.replace("15 kV", "15 KV"))
    assert "jet.voltage" in spinline("fibre", tmp_path / "mine.toml").err
    (tmp_path / "scene.toml").write_text(RECIPE.replace("[jet]", "[jet]\nbeta = 0.47"))  # no recipe any more
    assert "jet.profile: is missing" in spinline("run", tmp_path / "scene.toml").err


@pytest.mark.parametrize(
    "given",
    [
        ["run", "peo5-water", "--no-figure"],
        ["window", "pan-dmf", "--voltage", "10 kV .. 20 kV", "--no-figure"],
        ["spin", "pvp-spun"],
        ["spin", "pan12-blown"],
        ["reduce", "peo5-images", "--no-figure"],
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".png", ".XLSX"])
def test_a_result_is_not_named_as_another_format(spinline, tmp_path, given, suffix):
    """netCDF had been written into a .csv without a word."""
    ran = spinline(*given, "-o", tmp_path / f"out{suffix}")
    assert ran.code == 2
    assert "is written as netCDF" in ran.err
    assert "out.nc" in ran.err
    assert not (tmp_path / f"out{suffix}").exists()
