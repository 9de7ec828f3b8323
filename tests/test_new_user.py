"""One mistake each of a new user at the command line: the message says what to type instead."""

from pathlib import Path

import pytest


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


@pytest.mark.parametrize(
    "given",
    [
        ["run", "peo5-water", "--no-figure"],
        ["window", "pan-dmf", "--voltage", "10 kV .. 20 kV", "--no-figure"],
        ["spin", "pvp-spun"],
        ["spin", "pan12-blown"],
        ["reduce", "peo5-images", "--no-figure"],
        ["import-jet", Path(__file__).parent / "data" / "jetspin" / "pvp3d"],
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


def test_fibres_are_not_named_as_a_table(spinline, tmp_path):
    """HDF5 had been written into a .csv without a word."""
    (tmp_path / "mat.toml").write_text(
        '[laydown]\nspeed = "5 m/s"\nspread = "60 um"\nturning_length = "100 um"\ndiameter = "600 nm"\n'
        '[collector]\ndistance = "20 cm"\ntime = "1 ms"\n'
    )
    ran = spinline("deposit", "mat.toml", "-o", "fibres.csv")
    assert ran.code == 2
    assert "is written as HDF5, and is named as .csv; allowed: .h5; name it fibres.h5" in ran.err
    assert spinline("deposit", "mat.toml", "-o", "fibres.h5").code == 0


@pytest.mark.parametrize(
    ("given", "form"),
    [
        (("run", "peo5-water", "--no-figure", "--csv", "a.xlsx"), "CSV"),
        (("run", "peo5-water", "--no-figure", "--report", "a.pdf"), "HTML"),
        (("trade", "peo5-water", "--report", "a.PDF"), "HTML"),
        (("jet", "peo5-needle", "--csv", "a.json"), "CSV"),
        (("reduce", "peo5-images", "--no-figure", "--csv", "a.nc"), "CSV"),
        (("window", "pan-dmf", "--no-figure", "--html", "a.png"), "HTML"),
        (("deposit", "mat.toml", "--csv", "a.xlsx"), "CSV"),
        (("mat", "f.h5", "--csv", "a.ods"), "CSV"),
        (("mat", "f.h5", "--report", "a.docx"), "HTML"),
        (("fibre", "--table", "t.csv", "-o", "a.xlsx"), "CSV"),
    ],
)
def test_tables_and_pages_are_not_named_as_another_format(spinline, tmp_path, given, form):
    """CSV had been written into a .xlsx, and HTML into a .pdf, which then no program opened."""
    ran = spinline(*given)
    assert ran.code == 2
    ending = {"CSV": ".csv", "HTML": ".html"}[form]
    assert f"is written as {form}, and is named as {Path(given[-1]).suffix}" in ran.err
    assert f"name it a{ending}" in ran.err
    assert list(tmp_path.iterdir()) == []


def test_keys_are_not_set_in_a_table(spinline, tmp_path):
    """--set beside --table had been passed over without a word."""
    (tmp_path / "t.csv").write_text(
        "polymer,solvent,concentration_wt_percent,voltage_kV,flow_rate_mL_per_h,distance_cm\nPAN,DMF,10,15,1,15\n"
    )
    ran = spinline("fibre", "--table", "t.csv", "--set", "jet.voltage=20 kV")
    assert ran.code == 2
    assert "--set = 'jet.voltage=20 kV': changes keys of a recipe, and this is a table" in ran.err
    assert spinline("fibre", "--table", "t.csv").code == 0


@pytest.mark.parametrize("command", ["run", "spin", "check", "crossover"])
def test_the_folder_of_a_jetspin_run_is_no_scene_and_is_told_where_it_goes(spinline, command):
    folder = Path(__file__).parent / "data" / "jetspin" / "ex2_1d_insert"
    ran = spinline(command, folder)
    assert ran.code == 2
    assert f"spinline import-jet {folder}" in ran.err
    assert f"spinline spin {folder / 'input.dat'}" in ran.err


def test_a_folder_of_two_words_is_written_so_that_a_shell_takes_it(spinline, tmp_path):
    (tmp_path / "my run").mkdir()
    (tmp_path / "my run" / "input.dat").touch()
    assert "`spinline import-jet 'my run'`" in spinline("run", "my run").err
