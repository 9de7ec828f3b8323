"""Scenes: every bundled one, every key, and what mistakes get."""

import tomllib

import pytest

from spinline.base.errors import InputError
from spinline.scene import bundled_scenes, json_schema, load_scene, scene_from_dict


@pytest.mark.parametrize("name", bundled_scenes())
def test_bundled_scenes_are_valid(name: str) -> None:
    scene = load_scene(name)
    assert scene.title
    assert scene.name == name
    assert scene.text == bundled_scenes()[name].read_text(encoding="utf-8")


def test_six_bundled_scenes_or_more() -> None:
    names = set(bundled_scenes())
    assert {"peo3-water", "peo5-water", "pmma10-acetone", "pcl9-dcm", "pvp-jetspin", "extreme-stretch"} <= names


DESIGNED = """
title = "PEO 5 wt% in water, 0.6 kV/cm"
[solution]
polymer = "PEO"
molar_mass = "600 kg/mol"
solvent = "water"
mass_fraction = 0.05
kuhn_length = "1 nm"
temperature = "293.15 K"
polymer_density = "1.13 g/cm^3"
viscosity = "2 Pa s"
[jet]
profile = "power-law"
radius = "125 um"
flow_rate = "3.2 mL/hour"
k = 1.0
beta = 0.47
length = "5 mm"
[ambient]
relative_humidity = 0.4
temperature = "25 degC"
pressure = "1 atm"
air_velocity = "0 m/s"
[rheology]
law = "yarin"
B = 7
m = 0.1
n = 1
convention = "mass"
D_law = "constant"
[effects]
evaporation = "auto"
relaxation = false
radial = "auto"
[network]
model = "auto"
closure = "force"
spring = 3
drag_viscosity = "solvent"
coupling = 2e4
inertia = 0.0
force_law = "lattice"
solvent_quality = "theta"
[accuracy]
rtol = 0.01
"""


def test_every_designed_key_is_known() -> None:
    scene = scene_from_dict(tomllib.loads(DESIGNED))
    assert scene.network.coupling.value == 2e4
    assert scene.effects.relaxation is False
    assert scene.ambient.temperature.value == pytest.approx(298.15)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("jet.beta=2", ["jet.beta = 2", "[0.25, 1]", "0.4 to 0.6"]),
        ("jet.beta=0.2", ["jet.beta", "[0.25, 1]"]),
        ("jet.beta=nan", ["jet.beta", "finite", "[0.25, 1]"]),
        ("jet.k=inf", ["jet.k", "finite"]),
        ("jet.k=0", ["jet.k = 0", "(0, "]),
        ("jet.k=true", ["jet.k", "not a number"]),
        ("jet.radius=-5 um", ["jet.radius = '-5 um'", "(1e-12, 1000) m"]),
        ("jet.radius=0 um", ["jet.radius"]),
        ("jet.radius=5", ["jet.radius = 5", "needs a unit", '"125 um"']),
        ("jet.radius=5 s", ["jet.radius", "not a length"]),
        ("jet.bta=1", ["jet.bta", "not a known key", "did you mean 'beta'"]),
        ("jet.profile=wobbly", ["jet.profile = 'wobbly'", "hyperbolic"]),
        ("jett.k=1", ["jett", "not a known key", "did you mean 'jet'"]),
        ("solution.mass_fraction=1", ["solution.mass_fraction = 1", "(0, 1)"]),
        ("solution.mass_fraction=120 wt%", ["solution.mass_fraction", "(0, 1)"]),
        ("solution.volume_fraction=0.1", ["mass_fraction", "not both"]),
        ("solution.temperature=-300 degC", ["solution.temperature", "(50, 1000) K"]),
        ("solution.solvent={water=-1}", ["solution.solvent.water", "greater than"]),
        ("solution.polymer={name='x'}", ["solution.polymer.density", "missing"]),
        ("solution.polymer=3", ["solution.polymer = 3", "string"]),
        ("network.model=magic", ["network.model = 'magic'", "'affine'"]),
        ("network.drag_viscosity=thick", ["network.drag_viscosity = 'thick'"]),
        ("effects.evaporation=maybe", ["effects.evaporation", "'auto', true or false"]),
        ("ambient.relative_humidity=1.4", ["ambient.relative_humidity", "[0, 1]"]),
        ("accuracy.rtol=0", ["accuracy.rtol = 0", "> 0"]),
        ("accuracy.points=1", ["accuracy.points = 1", ">= 2"]),
        ("jet.electric_field=1 kV/cm", ["jet.k", "beside"]),
        ("jet=3", ["jet"]),
        ("title=3", ["title = 3"]),
        ("nonsense", ["--set", "KEY=VALUE"]),
        ("title.x=3", ["--set", "value, not a section"]),
    ],
)
def test_mistakes_name_key_value_range_and_remedy(override: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        load_scene("peo5-water", [override])
    for word in words:
        assert word in str(caught.value)


def test_all_problems_are_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        load_scene("peo5-water", ["jet.k=-1", "jet.length=3 s", "jet.rad=4"])
    assert all(key in str(caught.value) for key in ("jet.k", "jet.length", "jet.rad"))


@pytest.mark.parametrize("section", ["solution", "jet"])
def test_a_missing_section_is_named(section: str) -> None:
    data = tomllib.loads(DESIGNED)
    del data[section]
    with pytest.raises(InputError, match=f"{section}: is missing"):
        scene_from_dict(data)


@pytest.mark.parametrize("key", ["polymer", "solvent"])
def test_a_missing_key_is_named(key: str) -> None:
    data = tomllib.loads(DESIGNED)
    del data["solution"][key]
    with pytest.raises(InputError, match=rf"solution.{key}: is missing; add it to \[solution\]"):
        scene_from_dict(data)


def test_unreadable_files(tmp_path) -> None:
    rubbish = tmp_path / "rubbish.toml"
    rubbish.write_bytes(b"\xff\xfe\x00\x01")
    broken = tmp_path / "broken.toml"
    broken.write_text("[jet\nk = ")
    (tmp_path / "long.toml").write_text("# " + "x" * 2_000_000)
    for path, words in (
        (tmp_path / "long.toml", "too long"),
        (rubbish, "not text"),
        (broken, "not a TOML scene"),
        (tmp_path, "cannot be read"),
        (tmp_path / "none.toml", "No such file"),
        ("peo5-watr", "did you mean the bundled 'peo5-water'"),
        ("", "cannot be read"),
        ("\0", "cannot be read"),
    ):
        with pytest.raises(InputError, match=words):
            load_scene(path)


def test_overrides_are_kept_in_the_text() -> None:
    scene = load_scene("peo5-water", ["jet.k=0.8", "jet.radius=100 um", "jet.radius='90 um'"])
    assert scene.jet.k.value == 0.8
    assert scene.jet.radius.value == pytest.approx(90e-6)
    assert "# --set jet.k=0.8" in scene.text


def test_schema_describes_every_section() -> None:
    schema = json_schema()
    assert set(schema["properties"]) == {
        "title",
        "solution",
        "jet",
        "ambient",
        "rheology",
        "effects",
        "network",
        "accuracy",
        "collector",
        "jets",
        "mat",
    }
    assert schema["additionalProperties"] is False
    jet = schema["$defs"]["PowerLawJet"]["properties"]
    assert jet["radius"]["type"] == "string"
    assert "125 um" in jet["radius"]["examples"]
    assert jet["beta"]["type"] == ["string", "number"]


def test_a_voltage_is_told_where_it_belongs(spinline):
    ran = spinline("check", "peo5-water", "--set", "jet.voltage=9 kV")
    assert ran.code == 2
    assert 'profile = "needle"' in ran.err
    assert spinline("check", "peo5-needle").code == 0


def test_a_missing_beta_is_told_what_is_usual():
    data = {
        "solution": {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.05, "molar_mass": "600 kg/mol"},
        "jet": {"profile": "power-law", "radius": "125 um", "flow_rate": "3.2 mL/hour", "length": "5 mm", "k": 1.0},
    }
    with pytest.raises(InputError, match=r"jet\.beta: is missing.*0\.4 to 0\.6.*fit-jet"):
        scene_from_dict(data)
