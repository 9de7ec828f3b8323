"""Recipes as notebooks have them: other names, other notations, one mistake each: the right answer, or what to write."""

import re
import tomllib

import pytest

from spinline.base.errors import InputError
from spinline.base.text import parsed_toml
from spinline.recipe.mixture_text import mixture_remedy
from spinline.recipe.recipe_file import fibre, load_recipe
from spinline.rheology.materials import POLYMERS
from spinline.rheology.names import known_as
from spinline.rheology.solvents import SOLVENTS
from spinline.scene.advice import GAUGES

BASE = """[solution]
polymer = "PAN"
solvent = "DMF"
concentration = "10 wt%"
[jet]
voltage = "15 kV"
gap = "15 cm"
flow_rate = "1 mL/hour"
"""


@pytest.fixture
def sheet(tmp_path):
    def of(text: str):
        path = tmp_path / "recipe.toml"
        path.write_text(text, encoding="utf-8")
        return load_recipe(path)

    return of


@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("H₂O", "water"),
        ("DI water", "water"),
        ("Milli-Q water", "water"),
        ("deionised water", "water"),
        ("CHCl₃", "chloroform"),
        ("CH2Cl2", "DCM"),
        ("N,N′-dimethylformamide", "DMF"),
        ("N,N\u2010dimethylacetamide", "DMAc"),
        ("HCOOH", "formic acid"),
        ("glacial acetic acid", "acetic acid"),
        ("1-methyl-2-pyrrolidinone", "NMP"),
        ("1,1,1,3,3,3-hexafluoroisopropanol", "HFIP"),
        ("absolute ethanol", "ethanol"),
        ("poly(epsilon-caprolactone)", "PCL"),
        ("poly(N-vinyl-2-pyrrolidone)", "PVP"),
        ("poly(L-lactic acid)", "PLA"),
        ("nylon-6", "nylon 6"),
        ("nylon 6,6", None),
        ("PVDF-HFP", None),
        ("xylene", None),
        ("1,4-dioxane", "dioxane"),
    ],
)
def test_other_names(name, known) -> None:
    assert known_as(name, {**POLYMERS, **SOLVENTS}) == known


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "DMF/acetone 4:6",
            "{ DMF = 0.4, acetone = 0.6 }, or, of these parts by volume, { DMF = 0.445, acetone = 0.555 }",
        ),
        ("DMF:acetone = 4:6", "{ DMF = 0.4, acetone = 0.6 }"),
        ("60 % DMF, 40 % acetone", "{ DMF = 0.6, acetone = 0.4 }"),
        ("DMF (60 %) / acetone (40 %)", "{ DMF = 0.6, acetone = 0.4 }"),
        ("DCM/DMF (3/2, v/v)", "these parts by volume are solvent = { DCM = 0.677, DMF = 0.323 }"),
        ("DCM:DMF (7:3 w/w)", "write solvent = { DCM = 0.7, DMF = 0.3 }"),
        ("formic acid/acetic acid 3:1", '{ "formic acid" = 0.75, "acetic acid" = 0.25 }'),
        ("N,N-dimethylformamide and acetone", "for example solvent = { DMF = 0.5, acetone = 0.5 }"),
        ("90 % ethanol", "{ ethanol = 0.9, water = 0.1 }"),
        ("water + 0.1 M NaCl", "`conductivity`"),
        ("benzene", ""),
        ("benzene/DMF 1:1", ""),
    ],
)
def test_a_mixture_is_answered_with_what_to_write(sheet, text, words) -> None:
    remedy = mixture_remedy(text)
    assert words in remedy
    for table in re.findall(r"\{[^}]*\}", remedy):  # what it says to write is read
        found = sheet(BASE.replace('"DMF"', table)).recipe()
        assert sum(found.solvent.values()) == pytest.approx(1)
    with pytest.raises(InputError, match="not in the library"):
        sheet(BASE.replace('"DMF"', f'"{text}"')).recipe()


def test_parts_by_volume_are_weighed_by_density() -> None:
    """By hand at 25 degC: 0.944 g/mL of DMF, 0.785 of acetone."""
    table = tomllib.loads("s = " + re.findall(r"\{[^}]*\}", mixture_remedy("DMF/acetone 1:1 v/v"))[0])["s"]
    assert table["DMF"] == pytest.approx(0.944 / (0.944 + 0.785), abs=0.002)


@pytest.mark.parametrize("given", ["21", '"21G"', '"21 G"', '"G21"', '"21 gauge"', '"21-gauge"', "21.0", '"21"'])
def test_a_gauge_in_any_form(sheet, given) -> None:
    assert sheet(f"{BASE}gauge = {given}\n").recipe().needle_radius == 0.26e-3


@pytest.mark.parametrize(
    ("gauge", "inches"), [(21, 0.02025), (31, 0.00525), (32, 0.00425), (33, 0.00425), (34, 0.00325)]
)
def test_gauges_are_half_the_nominal_inner_diameter(sheet, gauge, inches) -> None:
    radius = sheet(f"{BASE}gauge = {gauge}\n").recipe().needle_radius
    assert radius == GAUGES[gauge] == pytest.approx(0.5 * inches * 25.4e-3, rel=0.02)


@pytest.mark.parametrize("given", ["12", "35", '"21 mm"', '"22s"', "21.5", "true", '""'])
def test_no_gauge_is_answered_with_radius(sheet, given) -> None:
    with pytest.raises(InputError, match=r'jet\.gauge.*14 to 34.*radius = "0\.26 mm"'):
        sheet(f"{BASE}gauge = {given}\n").recipe()


def test_shares_may_be_per_cent(sheet) -> None:
    assert sheet(BASE.replace('"DMF"', '{ DMF = "40 %", acetone = "60 wt%" }')).recipe().solvent == {
        "DMF": 0.4,
        "acetone": 0.6,
    }
    for table, words in (
        ('{ DMF = "40 vol%", acetone = 0.6 }', "solution.solvent.DMF.*volume fraction"),
        ('["DMF", "acetone"]', "write { DMF = 0.5, acetone = 0.5 }"),
        ("7", "is no solvent"),
    ):
        with pytest.raises(InputError, match=words):
            sheet(BASE.replace('"DMF"', table)).recipe()


def test_a_spread_that_no_interval_has_is_said(sheet) -> None:
    remarks = fibre(
        sheet(BASE.replace('"10 wt%"', '"10 +/- 3 wt%"').replace('"15 kV"', '"15 +/- 1 kV"')), shares=False
    ).remarks
    assert any("+/- of solution.concentration, jet.voltage is not in the interval" in one for one in remarks)
    weighed = (
        BASE.replace("[jet]", 'viscosity = "0.9 Pa s +/- 10 %"\n[jet]')
        + '[measured]\nfibre_diameter = "(320 ± 20) nm"\n'
    )
    assert not any("not in the interval" in one for one in fibre(sheet(weighed), shares=False).remarks)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('voltage = "15 kV"', "voltage = “15 kV”", "plain quotes"),
        ('voltage = "15 kV"', "voltage = 15 kV", 'voltage = "15 kV"'),
        ('voltage = "15 kV"', "voltage = 15,5", "decimal point: voltage = 15.5"),
        ('voltage = "15 kV"', 'voltage: "15 kV"', 'voltage = "15 kV"'),
        ('voltage = "15 kV"', 'applied voltage = "15 kV"', "letters, digits and _"),
        ('voltage = "15 kV"', "voltage 15 kV", "key = value: voltage 15 kV"),
        ('solvent = "DMF"', "solvent = { N,N-dimethylformamide = 1.0 }", "stand in quotes"),
        ("[solution]", '{"solution": {', "JSON or YAML"),
        ("[solution]", "solution:", "JSON or YAML"),
    ],
)
def test_toml_says_what_to_write_in_the_line(sheet, old, new, words) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        sheet(BASE.replace(old, new))


def test_old_line_ends_are_named() -> None:
    with pytest.raises(InputError, match="line ends"):
        parsed_toml(BASE.replace("\n", "\r"), "x.toml", "recipe")


@pytest.mark.parametrize(
    ("section", "key", "meant"),
    [
        ("jet", "Q", "flow_rate"),
        ("jet", "pump_rate", "flow_rate"),
        ("jet", "V", "voltage"),
        ("jet", "tip_to_collector_distance", "gap"),
        ("solution", "mass_fraction", "concentration"),
        ("solution", "conc", "concentration"),
    ],
)
def test_keys_as_people_call_them(sheet, section, key, meant) -> None:
    with pytest.raises(InputError, match=f"{section}.{key}.*did you mean '{meant}'"):
        sheet(BASE.replace(f"{meant} =", f"{key} ="))
