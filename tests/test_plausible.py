"""Sizes that no spinning line has are said, with what is usual; ordinary scenes hear nothing."""

import numpy as np
import pytest

from spinline.plan.plausible import implausible
from spinline.scene import load_scene
from spinline.scene.file import bundled_scenes
from spinline.setup.context import Context

BEADS = """
[solution]
polymer = "PEO"
molar_mass = "600 kg/mol"
solvent = "water"
mass_fraction = 0.05
[jet]
profile = "lagrangian"
path = "beads.csv"
"""


@pytest.mark.parametrize("name", sorted(set(bundled_scenes()) - {"extreme-stretch", "pvp-spun", "peo5-spun"}))
def test_bundled_scenes_are_plausible(name):
    assert implausible(Context(load_scene(name))) == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("jet.radius=2.5 m", "nozzle radius 2.5e+06 um is out of the usual: spinnerets have 50 um to 1 mm"),
        ("jet.radius=1 nm", "nozzle radius 0.001 um"),
        ("jet.k=1e9", "k 1e+09 is out of the usual: measured jets have 0.2 to 3"),
        ("jet.k=1e-9", "k 1e-09"),
        ("jet.length=100 m", "length 100 m"),
        ("jet.flow_rate=3 m3/hour", "flow rate 3e+06 mL/hour"),
        ("solution.viscosity=1e9 Pa s", "viscosity 1e+09 Pa s"),
        ("solution.relaxation_time=1 year", "relaxation time 3.16e+07 s"),
    ],
)
def test_a_slip_of_units_is_said(change, words):
    assert any(words in remark for remark in implausible(Context(load_scene("peo5-water", [change]))))


def test_faster_than_sound(spinline):
    told = spinline("check", "peo5-water", "--set", "jet.k=1e4")
    assert told.code == 0
    assert "remark: at its end the jet moves at" in told.out
    assert "faster than sound" in told.out


@pytest.fixture
def beads(tmp_path):
    """A scene of beads that thin as (1 + x/2 mm)^(-1/2) from 125 um."""

    def scene(turned=False, factor=1.0, radius=""):
        x = np.linspace(0, 0.1, 60)
        r = factor * 125e-6 * (1 + x / 2e-3) ** -0.5
        rows = np.column_stack([x, 0 * x, 0 * x, r[::-1] if turned else r])
        np.savetxt(tmp_path / "beads.csv", rows, delimiter=",", header="x_m,y_m,z_m,radius_m", comments="")
        (tmp_path / "b.toml").write_text(BEADS + radius, "utf-8")
        return Context(load_scene(tmp_path / "b.toml"))

    return scene


def test_beads_in_order_are_plausible(beads):
    assert implausible(beads()) == []
    assert implausible(beads(radius='radius = "125 um"')) == []


def test_beads_from_the_collector_to_the_nozzle(beads):
    (remark,) = implausible(beads(turned=True))
    assert "thickens along its arc, from 17.8 to 66.4 um" in remark
    assert "from the collector to the nozzle" in remark


def test_another_nozzles_radius(beads):
    (remark,) = implausible(beads(factor=1 / 200, radius='radius = "125 um"'))
    assert "125 um, the first element's 0.625 um, 200 times less" in remark
    (remark,) = implausible(beads(radius='radius = "62.5 um"'))
    assert "a diameter for a radius?" in remark


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("jet.voltage=0.9 MV", "air breaks down"),
        ("jet.flow_rate=1e-15 m3/s", "check its unit"),
        ("jet.gap=1 mm", "check its unit"),
        ("solution.concentration=90 wt%", "no solution"),
        ("jet.voltage=20 kV", ""),
    ],
)
def test_a_recipe_that_nobody_spins_is_said(change, words):
    from spinline.recipe import fibre, load_recipe
    from spinline.recipe.outside import outside_remarks

    sheet = load_recipe("pan-dmf", [change])
    said = outside_remarks(sheet.recipe())
    assert any(words in one for one in said) if words else said == ()
    assert set(said) <= set(fibre(sheet, shares=False).remarks)


def test_what_a_spun_jet_does_not_take_is_said_by_the_check(spinline, tmp_path):
    """Its collector and its row of jets are keys of [jet]: sections of that name had been dropped without a word."""
    text = load_scene("pvp-spun").text
    (tmp_path / "mine.toml").write_text(text + '\n[collector]\nkind = "plate"\ndistance = "15 cm"\n[jets]\ncount = 3\n')
    told = spinline("check", "mine.toml", "--set", "jet.voltage=9 V").out
    assert "[collector] is of blown jets" in told
    assert "[jets] is of blown jets" in told
    assert "voltage 0.009 kV is out of the usual" in told
    (tmp_path / "plain.toml").write_text(text)
    plain = spinline("check", "plain.toml").out
    assert "blown jets" not in plain
    assert "out of the usual" not in plain
