"""The stories of CONTRIBUTING: a jet, a law and a rung added from outside, through the public registration, and run."""

from typing import Literal

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError
from spinline.jetprofile import Jet, LagrangianJet, PowerLaw
from spinline.network_models import RUNGS, Rung, register
from spinline.network_models.rung import Setting
from spinline.rheology.constitutive import LAWS, ConstitutiveLaw, LawParameter
from spinline.scene import json_schema, load_scene, register_law, scene_from_dict
from spinline.scene.air_and_rheology import RheologySection
from spinline.scene.file import JET_SECTIONS, MODELS, HyperbolicJet, Scene, add_jet_section
from spinline.scene.keys import full_key
from spinline.scene.quantities import FlowRate, Length, Section
from spinline.setup import register_jet
from spinline.solve import evaluate

R0, V0, LENGTH = 1e-4, 0.02, 5e-3
SOLUTION = {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.05, "molar_mass": "600 kg/mol"}


class Cosh:
    """A jet that knows nothing of spinline: V = cosh(z/a), only the members that the protocol asks for."""

    start, end = 0.0, LENGTH

    def __init__(self, a=1.2e-3):
        self.a = a

    def velocity_ratio(self, z):
        return np.cosh(np.asarray(z) / self.a)

    def stretch_ratio(self, z):
        return self.velocity_ratio(z)

    def radius(self, z):
        return R0 / np.sqrt(self.velocity_ratio(z))

    def strain_rate(self, z):
        return V0 / self.a * np.sinh(np.asarray(z) / self.a)

    def residence_time(self, z):
        return 2 * self.a / V0 * np.arctan(np.tanh(np.asarray(z) / (2 * self.a)))

    def at(self, time=None):
        return self


class CoshJet(Section):
    """``[jet]`` of the toy."""

    profile: Literal["cosh"]
    a: Length
    flow_rate: FlowRate | None = None


@pytest.fixture
def cosh_profile():
    register_jet(CoshJet, lambda section, scene, solution: Cosh(section.a.value))
    yield
    del JET_SECTIONS["cosh"]
    add_jet_section(HyperbolicJet)  # the union anew


def test_an_object_with_the_methods_is_a_jet_and_runs(quiet):
    assert isinstance(Cosh(), Jet)
    scene = load_scene("peo5-water")
    solved = evaluate(
        scene.model_copy(update={"jet": scene.jet.model_copy(update={"length": scene.jet.length})}), Cosh()
    )
    z = solved.fields["z"]
    np.testing.assert_allclose(solved.fields["velocity_ratio"], np.cosh(z / 1.2e-3), rtol=1e-14)
    np.testing.assert_allclose(solved.jet.initial_velocity, V0, rtol=1e-9)
    np.testing.assert_allclose(solved.jet.initial_radius, R0, rtol=1e-15)
    target = 1 / solved.scalars["volume_fraction"]
    assert solved.scalars["crossover_position"] == pytest.approx(1.2e-3 * np.arccosh(target), rel=1e-12)
    with pytest.raises(InputError, match="is no jet: it has no"):
        evaluate(scene, object())


@pytest.mark.parametrize("model", ["affine", "manifold", "conformation"])
def test_a_jet_is_added_by_its_law_a_section_and_a_line(cosh_profile, model, quiet):
    data = {
        "solution": {**SOLUTION, "relaxation_time": "10 ms", "viscosity": "2 Pa s"},
        "jet": {"profile": "cosh", "a": "1.2 mm"},
        "network": {"model": model},
    }
    result = sl.run(scene_from_dict(data))
    np.testing.assert_allclose(result["velocity_ratio"], np.cosh(result["z"] / 1.2e-3), rtol=1e-14)
    assert result.attrs["model"] == model
    with pytest.raises(InputError, match=r"jet\.aa"):
        scene_from_dict({**data, "jet": {**data["jet"], "aa": "1 mm"}})
    assert full_key("jet.a", "x") == "jet.a"


def test_a_jet_added_dries(cosh_profile, quiet):
    data = {
        "solution": SOLUTION,
        "jet": {"profile": "cosh", "a": "1.2 mm"},
        "ambient": {"relative_humidity": 0.3},
        "effects": {"evaporation": True},
    }
    result = sl.run(scene_from_dict(data))
    lost = result["evaporated_fraction"].values
    assert 0 < lost[-1] < 0.1
    np.testing.assert_allclose(result["radius"], R0 * np.sqrt((1 - lost) / result["velocity_ratio"]), rtol=1e-12)


class HalfStretched(Rung):
    """A toy rung: strands take half of the logarithm of the flow's stretch."""

    name = "half"
    words = "half of the affine stretch, in its logarithm"
    cost = "nothing"

    def fields(self, context, fields, network):
        return {"axial_stretch": np.sqrt(fields["stretch_ratio"])}

    def settings(self, context, quick):
        return [Setting("closed form")]


@pytest.fixture
def half():
    register(HalfStretched())
    yield
    del RUNGS["half"], MODELS["half"]


def test_a_rung_is_one_file(half, spinline):
    scene = load_scene("peo5-water", ["network.model=half"])
    result = sl.run(scene)
    np.testing.assert_allclose(result["axial_stretch"], np.sqrt(result["stretch_ratio"]), rtol=1e-15)
    assert result.attrs["model"] == "half"
    ran = spinline("plan", "peo5-water", "--model", "half", "--json")
    assert ran.code == 0
    assert ran.json["model"] == "half"
    assert "nothing" in ran.json["reason"]
    from spinline.study.trade import trade

    assert "half" in {rung.model for rung in trade(scene, quick=True).rungs}


class Share:
    """A toy model: strands take a share of the flow's stretch, in its logarithm."""

    solvent_viscosity = 0.0

    def __init__(self, share):
        self.share = share

    def follow(self, history, first, rtol):
        axial, radial = np.exp(2 * self.share * history.log_stretch), np.exp(-self.share * history.log_stretch)
        return first[0] * axial, first[1] * radial, np.ones(axial.size)

    def stiffening(self, v):
        return np.ones_like(v), np.inf


@pytest.fixture
def share_law():
    table = (LawParameter("affine_share", "fraction", 0.0, 1.0, True, "share of the stretch", default=0.5),)
    register_law(
        ConstitutiveLaw("share", "a share of the stretch", lambda values, _: Share(values["affine_share"]), table)
    )
    yield
    del LAWS["share"], RheologySection.__pydantic_fields__["affine_share"]
    register_law(LAWS["UCM"])  # the section anew


@pytest.mark.parametrize(("given", "share"), [([], 0.5), (["rheology.affine_share=0.25"], 0.25)])
def test_a_law_is_one_file_with_its_table(share_law, given, share):
    asked = ["solution.relaxation_time=10 ms", "network.model=conformation", "rheology.constitutive=share", *given]
    result = sl.run(load_scene("peo5-water", asked))
    np.testing.assert_allclose(result["strand_stretch"], result["stretch_ratio"] ** share, rtol=1e-12)
    assert result["stress"].values[-1] > 0
    assert full_key("rheology.affine_share", "x") == "rheology.affine_share"
    assert "share of the stretch" in str(json_schema())
    with pytest.raises(InputError, match=r"allowed: \[0, 1\]"):
        load_scene("peo5-water", [*asked, "rheology.affine_share=1.5"])
    with pytest.raises(InputError, match='is given, but constitutive = "UCM" does not use it'):
        load_scene("peo5-water", ["rheology.constitutive=UCM", "rheology.affine_share=0.5"])


def test_keys_and_checks_of_the_laws_are_those_of_their_tables():
    fields = RheologySection.model_fields
    for law in LAWS.values():
        for parameter in law.parameters:
            assert parameter.words in (fields[parameter.name].description or "")
            if parameter.needed:
                with pytest.raises(InputError, match=f"{parameter.name}: is missing"):
                    load_scene("peo5-water", [f"rheology.constitutive={law.name}"])


@pytest.mark.parametrize("name", list(RUNGS))
def test_every_rung_says_what_it_is(name):
    rung = RUNGS[name]
    assert rung.name == name
    assert name in MODELS
    assert MODELS[name] == rung.slips
    assert rung.words
    assert rung.cost
    from spinline.plan.effects import EFFECTS

    assert set(rung.holds) <= {effect.name for effect in EFFECTS}
    assert Scene.model_fields["network"].annotation.model_fields["model"].annotation.__args__[0] == "auto"


def test_straight_and_bead_jets_meet_the_protocol():
    line = PowerLaw(radius=R0, flow_rate=1e-9, k=1.0, beta=0.5)
    z = np.linspace(0.0, 4e-3, 801)
    middle = 0.5 * (z[1:] + z[:-1])
    beads = LagrangianJet.from_arrays(z, initial_radius=R0, radius=line.radius(middle), velocity=line.velocity(z))
    for jet in (line, beads):
        assert isinstance(jet, Jet)
        place = np.array([1e-3, 2e-3])
        for name in ("radius", "velocity_ratio", "strain_rate", "residence_time", "stretch_ratio"):
            assert getattr(jet, name)(place).shape == (2,)
        assert jet.at() is jet
        assert jet.start == 0.0
    np.testing.assert_allclose(beads.residence_time(middle), line.residence_time(middle), rtol=0.02, atol=1e-5)
    assert beads.end == pytest.approx(middle[-1])
