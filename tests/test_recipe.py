"""From a recipe to the fibre: answers, intervals, what moves them, bad recipes, tables."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.recipe import Measurement, Recipe, load_recipe, predict_table, read_experiments, recipes_of
from spinline.recipe.believe import evaporation_rate
from spinline.recipe.mixture_text import parted
from spinline.recipe.predict import predict
from spinline.recipe.recipe_file import bundled_recipes
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS, mixture_density

DATA = Path(__file__).parent / "data" / "spindb" / "experiments-sample.csv"
PAN = Recipe(
    "PAN", {"DMF": 1.0}, 15e3, 0.15, 1e-6 / 3600, mass_fraction=0.10, temperature=296.15, relative_humidity=0.45
)


def of(**changes):
    return predict(replace(PAN, **changes), shares=False)


def test_the_bundled_recipe_is_a_usual_fibre():
    found = sl.fibre("pan-dmf")
    low95, high95 = found.fibre_diameter_95
    low68, high68 = found.fibre_diameter_68
    assert low95 < low68 < found.fibre_diameter < high68 < high95
    assert 1e-7 < found.fibre_diameter < 6e-7
    assert found.regime == "jets"
    assert sum(found.regimes.values()) == pytest.approx(1, abs=1e-9)
    assert 0.8 < sum(found.variance_shares.values()) < 1.05
    assert 0 <= found.orientation <= 1


def test_the_same_recipe_gives_the_same_answer():
    assert predict(PAN) == predict(PAN)


@pytest.mark.parametrize(
    ("name", "values", "sign"),
    [
        ("mass_fraction", (0.08, 0.10, 0.12, 0.14), 1),
        ("voltage", (8e3, 15e3, 25e3), -1),
        ("flow_rate", (1e-10, 3e-10, 9e-10), 1),
        ("current", (1e-7, 3e-7, 1e-6), -1),
    ],
)
def test_settings_move_it_the_way_experiments_say(name, values, sign):
    extra = {"usual_fraction": 0.1} if name == "mass_fraction" else {}
    sizes = [of(**{name: value}, **extra).fibre_diameter for value in values]
    assert (sign * np.diff(sizes) > 0).all()


@pytest.mark.slow
def test_no_jump_where_a_setting_sweeps():
    for name, values in (
        ("voltage", np.geomspace(5e3, 4e4, 24)),
        ("mass_fraction", np.linspace(0.04, 0.25, 24)),
        ("gap", np.geomspace(0.02, 0.5, 24)),
        ("flow_rate", np.geomspace(1e-11, 1e-8, 24)),
    ):
        logs = np.log([of(**{name: value}, usual_fraction=0.1).fibre_diameter for value in values])
        steps = np.abs(np.diff(logs))
        assert steps.max() < 0.35
        assert np.abs(np.diff(logs, 2)).max() < 0.08


def test_what_is_given_narrows_the_interval():
    from spinline.recipe import spun
    from spinline.recipe.believe import believe
    from spinline.recipe.model import normals

    def width(found):
        return np.log(found.fibre_diameter_68[1] / found.fibre_diameter_68[0])

    def spread(**changes):  # of the same draws: quantiles of 2048 are good to 1 %, and a molar mass is worth less
        return spun(believe(replace(PAN, **changes))[0], normals(2048)).log_diameter.std()

    assert spread(molar_mass=150.0) < spread()
    chain, current = of(molar_mass=150.0), of(molar_mass=150.0, current=2e-7)
    assert width(current) < 0.9 * width(chain)


def test_what_is_taken_on_the_way_has_its_own_interval():
    """A current and a viscosity that are measured lie within a tenth; laws' within the factors they are known to."""
    guessed, known = predict(PAN), predict(replace(PAN, viscosity=0.8, current=2e-7))
    for name in ("current", "viscosity"):
        middle, (low, high) = getattr(guessed, name), getattr(guessed, f"{name}_68")
        assert low < middle < high
        assert high / low > 4.0
        low, high = getattr(known, f"{name}_68")
        assert np.sqrt(low * high) == pytest.approx(getattr(known, name), rel=0.02)
        assert 1.15 < high / low < 1.3


def test_one_measured_fibre_calibrates_the_rest():
    before = of(mass_fraction=0.12, usual_fraction=0.1)
    after = predict(replace(PAN, mass_fraction=0.12, usual_fraction=0.1), [Measurement(PAN, 6e-7)], shares=False)
    own = predict(PAN, [Measurement(PAN, 6e-7, 0.02)], shares=False)
    assert after.fibre_diameter > before.fibre_diameter
    ratio = [f.fibre_diameter_68[1] / f.fibre_diameter_68[0] for f in (after, before)]
    assert ratio[0] < ratio[1]
    assert of().fibre_diameter < own.fibre_diameter < 6e-7
    several = predict(PAN, [Measurement(PAN, 6e-7, 0.02)] * 5, shares=False)
    assert abs(np.log(several.fibre_diameter / 6e-7)) < abs(np.log(own.fibre_diameter / 6e-7))


def test_rungs_stand_side_by_side():
    race, terminal = predict(PAN, shares=False), predict(PAN, rung="terminal", shares=False)
    assert race.trade["terminal"] == pytest.approx(terminal.fibre_diameter, rel=0.05)
    assert terminal.trade["race"] > 0
    with pytest.raises(InputError, match="rung"):
        predict(PAN, rung="magic")


def test_drying_is_what_the_wet_bulb_allows():
    assert evaporation_rate({"acetone": 1.0}, 296.15, 0.4) > 3 * evaporation_rate({"DMF": 1.0}, 296.15, 0.4)
    damp, dry = (evaporation_rate({"water": 1.0}, 296.15, h) for h in (0.8, 0.1))
    assert 0 < damp < 0.5 * dry
    both = evaporation_rate({"DMF": 0.5, "acetone": 0.5}, 296.15, 0.4)
    assert evaporation_rate({"DMF": 1.0}, 296.15, 0.4) < both < evaporation_rate({"acetone": 1.0}, 296.15, 0.4)


def test_regimes():
    assert of(voltage=500.0).regime == "drips"
    assert of(mass_fraction=0.012, usual_fraction=0.10, molar_mass=150.0).regime in ("sprays", "beads")


def test_the_command(spinline):
    ran = spinline("fibre", "pan-dmf")
    assert ran.code == 0
    assert "Fibre diameter" in ran.out
    assert "nm; 68 %" in ran.out
    answer = spinline("fibre", "pan-dmf", "--json").json
    for key in (
        "fibre_diameter",
        "fibre_diameter_68",
        "fibre_diameter_95",
        "orientation",
        "regime",
        "rung",
        "variance_shares",
    ):
        assert key in answer
    assert len(answer["fibre_diameter_68"]) == 2


def test_a_recipe_with_everything(spinline, tmp_path):
    (tmp_path / "r.toml").write_text(
        '[solution]\npolymer = "Poly(vinylidene fluoride)"\nsolvent = { DMF = 60, acetone = 40 }\nconcentration = "20 wt%"\n'
        'viscosity = "1.2 +/- 0.1 Pa s"\nconductivity = "12 uS/cm"\nsurface_tension = "30 mN/m"\n'
        '[jet]\nvoltage = "15 kV"\ngap = "15 cm"\nflow_rate = "1 mL/hour"\nradius = "0.25 mm"\ncurrent = "200 +/- 20 nA"\n'
        '[ambient]\ntemperature = "25 degC"\nrelative_humidity = "40 %"\n[collector]\nkind = "drum"\nspeed = "2 m/s"\n'
        '[[measured]]\nfibre_diameter = "500 nm"\n[[measured]]\nfibre_diameter = "700 +/- 50 nm"\nconcentration = "22 wt%"\n'
    )
    ran = spinline("fibre", "r.toml", "--json")
    assert ran.code == 0
    assert 2e-7 < ran.json["fibre_diameter"] < 1.2e-6
    assert ran.json["borrowed"].keys() <= {"solution.molar_mass"}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('polymer = "PAN"', 'polymer = "wood"'), "solution.polymer"),
        (('solvent = "DMF"', 'solvent = "milk"'), "solution.solvent"),
        (('solvent = "DMF"', "solvent = { DMF = 0.7, water = 0.7 }"), "do not add up"),
        (('"15 kV"', '"15"'), "needs a unit"),
        (('"15 kV"', '"-15 kV"'), "jet.voltage"),
        (('"10 wt%"', '"120 wt%"'), "solution.concentration"),
        (("gauge = 21", "gauge = 3"), "jet.gauge"),
        (('gap = "15 cm"', 'gapp = "15 cm"'), "gap"),
        (('flow_rate = "1 mL/hour"\n', ""), "jet.flow_rate"),
        (("[ambient]", '[measured]\nfibre_diameter = "0 nm"\n[ambient]'), "measured"),
    ],
)
def test_bad_recipes_are_told(spinline, tmp_path, change, words):
    text = bundled_recipes()["pan-dmf"].read_text().replace(*change)
    (tmp_path / "r.toml").write_text(text)
    ran = spinline("fibre", "r.toml")
    assert ran.code == 2
    assert words in ran.err
    assert "Traceback" not in ran.err


def test_the_command_needs_one_thing(spinline):
    assert spinline("fibre").code == 2
    assert spinline("fibre", "pan-dmf", "--table", DATA).code == 2
    assert "recipe" in spinline("fibre", "no-such").err


def test_a_measured_fibre_is_asked_for_where_there_is_none(spinline):
    file = Path("rig.toml")
    file.write_text(
        bundled_recipes()["pan-dmf"].read_text("utf-8") + '[measured]\nfibre_diameter = "320 nm"\n', "utf-8"
    )
    asked = "One measured fibre of this rig"
    assert asked in spinline("fibre", "pan-dmf").out
    assert asked not in spinline("fibre", str(file)).out


@pytest.mark.slow
def test_a_table(spinline, tmp_path):
    ran = spinline("fibre", "--table", DATA, "-o", "out.csv")
    assert ran.code == 0
    rows = list(csv.DictReader(io.StringIO(Path("out.csv").read_text())))
    assert len(rows) == len(read_experiments(DATA))
    for row in rows:
        size = [float(row[name]) for name in ("low95_nm", "low68_nm", "predicted_nm", "high68_nm", "high95_nm")]
        assert size == sorted(size)
        assert row["regime"]
        assert row["rung"] == "race"
    assert "is kept and not used" in ran.out
    first = {name: text for name, text in read_experiments(DATA)[0].items() if not name.startswith("fibre_diameter")}
    bare = [",".join(first), ",".join(first.values())]
    Path("bare.csv").write_text("\n".join(bare), "utf-8")
    assert "is kept and not used" not in spinline("fibre", "--table", "bare.csv").out
    assert spinline("fibre", "--table", DATA, "-o", "out.csv").code == 2  # not over a file without --force


def test_decimal_commas_of_measured_diameters_are_points_too(tmp_path):
    file = tmp_path / "t.csv"
    head = "polymer;solvent;voltage_kV;flow_rate_mL_per_h;distance_cm;fibre_diameter_nm"
    file.write_text(f"{head}\nPAN;DMF;15,5;1,0;15;320,5\n", "utf-8")
    row = read_experiments(file)[0]
    assert (row["voltage_kV"], row["fibre_diameter_nm"]) == ("15.5", "320.5")


@pytest.mark.parametrize(
    ("polymer", "solvent"),
    [
        ("PCL", "chloroform-methanol"),
        ("PCL", "trifluoroethanol"),
        ("PVP", "MeOH"),
        ("PVB", "2-propanol"),
        ("PS", "butanone"),
        ("PS", "1,2-dichloroethane"),
        ("PS", "chlorobenzene-DMF"),
        ("PLA", "1,4-dioxane"),
        ("PLGA", "acetonitrile"),
        ("PMMA", "ethyl acetate"),
        ("gelatin", "2,2,2-trifluoroethanol"),
    ],
)
def test_fibres_of_usual_solutions_are_usual(polymer, solvent):
    """Solvents that papers name often: fibres of a tenth to a few micrometres, with the interval of any other."""
    row = {"polymer": polymer, "solvent": solvent, "concentration_wt_percent": "10", "voltage_kV": "15"}
    (answer,) = predict_table([{**row, "flow_rate_mL_per_h": "1", "distance_cm": "15"}])
    assert answer["regime"] in ("jets", "beads")
    assert 100 < answer["predicted_nm"] < 3000
    assert 1.3 < answer["high68_nm"] / answer["predicted_nm"] < 4


@pytest.mark.parametrize(
    ("solvent", "same"),
    [
        ("N,N-DIMETHYLFORMAMIDE-ACETONE", "DMF-ACETONE"),
        ("DMF_ACETONE", "DMF-ACETONE"),
        ("DMF + acetone", "DMF-ACETONE"),
        ("DMF, acetone", "DMF-ACETONE"),
        ("dimethylformamide (DMF) and acetone", "DMF-ACETONE"),
        ("1,4-dioxane-acetone", "DIOXANE-ACETONE"),
        ("2-PROPANOL-WATER", "WATER-ISOPROPANOL"),
        ("ACETIC_ACID-FORMIC_ACID", "FORMIC ACID;ACETIC ACID"),
        ("AC-DMF", "ACETONE-DMF"),
    ],
)
def test_mixtures_as_tables_name_them(solvent, same):
    row = {"polymer": "PVDF", "concentration_wt_percent": "12", "voltage_kV": "15", "flow_rate_mL_per_h": "1"}
    one, other = predict_table([{**row, "distance_cm": "15", "solvent": text} for text in (solvent, same)])
    assert one["predicted_nm"] == pytest.approx(other["predicted_nm"], rel=0.01)


@pytest.mark.parametrize(
    ("solvent", "words"),
    [
        ("DMF-xylene", "solvent = 'xylene': is not in the library; allowed: DCE"),
        ("DMF/acetone (6:4)", "name the parts alone: tables hold no shares"),
        ("NaN", "solvent: is missing"),
    ],
)
def test_mixtures_that_are_none_say_why(solvent, words):
    row = {"polymer": "PVDF", "concentration_wt_percent": "12", "voltage_kV": "15", "flow_rate_mL_per_h": "1"}
    (answer,) = predict_table([{**row, "distance_cm": "15", "solvent": solvent}])
    assert words in answer["regime"]


def test_a_cell_of_thousands_of_parts_is_answered_at_once():
    """Every run of its words had been tried as a name: minutes for 2,000 of them."""
    known = []

    def unknown(name):
        known.append(name)

    found, rest = parted("-".join("abcd" for _ in range(2000)), unknown)
    assert (found, len(rest)) == ([], 9999)
    assert len(known) <= 13
    longest = "1,1,1,3,3,3-hexafluoro-2-propanol-DMF"
    assert parted(longest, lambda name: known_as(name, SOLVENTS)) == (["HFIP", "DMF"], "")


def test_a_polymer_that_is_not_in_the_library_is_said():
    row = {"solvent": "DMF", "concentration_wt_percent": "12", "voltage_kV": "15", "flow_rate_mL_per_h": "1"}
    names = ("polyacrylonitrile (PAN)", "PVFD", "PU")
    known, near, other = predict_table([{**row, "distance_cm": "15", "polymer": name} for name in names])
    assert "library" not in known["remark"]
    assert "PVFD is not in the library (did you mean PVDF?)" in near["remark"]
    assert "PU is not in the library: a usual chain is taken" in other["remark"]


def test_rows_that_cannot_be_say_why():
    rows = read_experiments(DATA)[:1]
    for key, value in (
        ("voltage_kV", ""),
        ("distance_cm", "-3"),
        ("solvent_parts", "milk"),
        ("flow_rate_mL_per_h", "fast"),
        ("temperature_degC", "900"),
        ("concentration_wt_percent", "150"),
        ("voltage_kV", "15000"),
        ("distance_cm", "1500"),
        ("relative_humidity_percent", "0.45"),
        ("polymer", ""),
    ):
        (found,) = predict_table([{**rows[0], key: value}])
        assert found["predicted_nm"] == ""
        assert str(found["regime"]).startswith("not predicted")


def test_rows_say_what_recipes_say():
    row = read_experiments(DATA)[0]
    rows = [
        row,
        {**row, "distance_cm": "2", "voltage_kV": "90"},
        {**row, "needle_gauge": "7"},
        {**row, "remark": "spun on a Monday", "flow_rate_mL_per_h": "900"},
        {**row, "temperature_degC": "900"},
    ]
    found = predict_table(rows)
    for one, recipe in zip(found[:4], recipes_of(rows), strict=False):
        for remark in predict(recipe, shares=False).remarks:
            assert remark in one["remark"]
    assert "breaks down" in found[1]["remark"]
    assert "breaks down" not in found[0]["remark"]
    assert found[2]["remark"].startswith("needle_gauge = 7 is of no needle")
    assert found[3]["remark"].startswith("spun on a Monday; a flow of 900 mL/hour")
    assert found[4]["remark"] == ""
    assert predict_table(found[1:3])[1]["remark"] == found[2]["remark"]  # a table of its own is not said twice
    assert list(found[0])[-3:] == ["regime", "rung", "remark"]


def test_a_table_that_is_none(tmp_path):
    (tmp_path / "t.csv").write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="no column polymer"):
        read_experiments(tmp_path / "t.csv")


def test_tables_as_people_keep_them(tmp_path):
    row = read_experiments(DATA)[0]
    names = ["polymer", "solvent", "concentration_wt_percent", "voltage_kV", "flow_rate_mL_per_h", "distance_cm"]
    (tmp_path / "t.csv").write_text(",".join(names) + "\n" + ",".join(row[n] for n in names) + "\n")
    (tmp_path / "s.csv").write_text(";".join(names) + "\n\n" + ";".join(row[n].replace(".", ",") for n in names) + "\n")
    plain, comma = (predict_table(read_experiments(tmp_path / f)) for f in ("t.csv", "s.csv"))
    assert plain[0]["predicted_nm"] == comma[0]["predicted_nm"] != ""
    (tmp_path / "n.csv").write_text(
        ",".join(names) + "\n" + ",".join("NaN" if n[:4] == "conc" else row[n] for n in names) + "\n"
    )
    assert predict_table(read_experiments(tmp_path / "n.csv"))[0]["predicted_nm"] != ""
    (tmp_path / "e.csv").write_text(",".join(names) + "\n")
    with pytest.raises(InputError, match="no rows"):
        read_experiments(tmp_path / "e.csv")
    (tmp_path / "d.csv").write_text(",".join([*names, "polymer"]) + "\n" + ",".join(["1"] * 7) + "\n")
    with pytest.raises(InputError, match="twice"):
        read_experiments(tmp_path / "d.csv")


def test_one_laboratory_shares_what_it_spins_at():
    rows = [{**read_experiments(DATA)[0], "concentration_wt_percent": c} for c in ("8", "10", "12.5")]
    assert {round(r.usual_fraction, 9) for r in recipes_of(rows)} == {0.1}


def test_a_recipe_from_python():
    sheet = load_recipe("pcl-dcm-dmf", ["jet.voltage=20 kV"])
    assert sheet.recipe().voltage == 20e3
    assert sl.fibre(sheet, shares=False).fibre_diameter > 1e-7


def _notes(tmp_path, **changes):
    """A lab notebook's recipe, with keys of it changed."""
    lines = {
        "solution": {"polymer": "PS", "solvent": "chloroform", "concentration": "12 wt%"},
        "jet": {"voltage": "15 kV", "gap": "15 cm", "flow_rate": "3 mL/h"},
    }
    for place, value in changes.items():
        section, key = place.split("__")
        lines[section][key] = value
    file = tmp_path / "notes.toml"
    body = "".join(f"[{s}]\n" + "".join(f"{k} = {json.dumps(v)}\n" for k, v in v.items()) for s, v in lines.items())
    file.write_text(body.replace('{"chloroform": 3, "DMF": 1}', "{ chloroform = 3, DMF = 1 }"))
    return file


def test_mass_in_a_volume_is_made_a_fraction(tmp_path):
    for text in ("12 % w/v", "120 mg/mL", "12 % (w/v)", "120 g/L"):
        w = load_recipe(_notes(tmp_path, solution__concentration=text)).recipe().mass_fraction
        # volumes add up: 0.12 g of polystyrene (1.05 g/mL) in 1 mL, the rest chloroform at 23 degC
        rest = (1 - 0.12 / 1.05) * mixture_density({"chloroform": 1.0}, 296.15) / 1e3
        assert w == pytest.approx(0.12 / (0.12 + rest), rel=1e-9)
    assert load_recipe(_notes(tmp_path, solution__concentration="12 % w/w")).recipe().mass_fraction == 0.12
    with pytest.raises(InputError, match=r"0 mg/mL': is out of range.*kg/m"):
        load_recipe(_notes(tmp_path, solution__concentration="0 mg/mL"))
    with pytest.raises(InputError, match="more than the polymer's density"):
        load_recipe(_notes(tmp_path, solution__concentration="2 g/mL")).recipe()
    with pytest.raises(InputError, match="is out of range"):
        load_recipe(_notes(tmp_path, solution__concentration=12))


def test_keys_as_people_call_them(tmp_path):
    for key, meant in (("distance", "gap"), ("needle_gauge", "gauge"), ("flow", "flow_rate")):
        with pytest.raises(InputError, match=f"did you mean '{meant}'"):
            load_recipe(_notes(tmp_path, **{f"jet__{key}": "15 cm"}))
    with pytest.raises(InputError, match="did you mean 'molar_mass'"):
        load_recipe(_notes(tmp_path, solution__Mw="280 kg/mol"))
    with pytest.raises(InputError, match="take it out"):  # not: see another kind of scene
        load_recipe(_notes(tmp_path, jet__permittivity=30))
    with pytest.raises(InputError, match=r"by mass: solvent = { DMF = 0.6, acetone = 0.4 }"):
        load_recipe(_notes(tmp_path, solution__solvent="DMF:acetone 3:2")).recipe()
    assert load_recipe(_notes(tmp_path, jet__gauge="21 G")).recipe().needle_radius == 0.26e-3
    with pytest.raises(InputError, match=r"jet\.gauge"):
        load_recipe(_notes(tmp_path, jet__gauge="12G"))
    assert load_recipe(_notes(tmp_path, solution__viscosity="800 mPas")).recipe().viscosity == pytest.approx(0.8)
    low = predict(load_recipe(_notes(tmp_path, jet__voltage="15 V")).recipe(), shares=False)
    assert any("15 V is out of the 100 to 200000" in remark for remark in low.remarks)
    with pytest.raises(InputError, match=r"chloroform = 0.75, DMF = 0.25"):
        load_recipe(_notes(tmp_path, solution__solvent={"chloroform": 3, "DMF": 1})).recipe()
