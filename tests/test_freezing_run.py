"""Freezing jets as runs: the fraction across them, what stays; what may be asked for, and what is refused."""

import numpy as np
import pytest
from isothermal_runs import ACROSS, HUMID, ISOTHERMAL, RELAXING, WET, quiet

import spinline as sl
from spinline.base.errors import InputError
from spinline.plan.governing_numbers import effect_numbers
from spinline.rheology import equilibrium_fraction
from spinline.setup.build import build_jet, build_solution
from spinline.solve.results import VARIABLES
from spinline.study.difference import difference, largest

# --- across the jet, and what stays ----------------------------------------------------------------------------------


GLASS = (
    "solution={polymer='PMMA', solvent='acetone', mass_fraction=0.1, viscosity='0.5 Pa s', relaxation_time='20 ms'}",
    "jet={profile='power-law', radius='100 um', flow_rate='2 mL/hour', k=1.0, beta=0.47, length='60 mm'}",
    "effects.evaporation=true",
    "rheology.vitrification_fraction=0.75",
)


def test_two_rises_of_fig_37() -> None:
    """A dense core by contraction, a skin by drying, and less than the mean between them; each alone has its own."""
    result = quiet("peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-10 m2/s", "jet.length=6 mm")
    last, phi0 = result.sel(z=6e-3), float(result["volume_fraction"])
    phi, mean = last["polymer_fraction"].values, float(last["mean_polymer_fraction"])
    assert phi[0] > 5 * mean
    assert phi[-1] > 1.4 * mean
    assert phi[40:80].min() < 0.1 * mean
    drying = last["drying_polymer_fraction"].values
    assert drying[0] == pytest.approx(phi0, rel=1e-3)
    assert (np.diff(drying) >= -1e-12).all()
    skin = (drying[-1] - drying[0]) / (1 - drying[0])  # left where it was
    assert phi[-1] == pytest.approx(skin, rel=1e-6)
    np.testing.assert_allclose(result["polymer_fraction"].values[0], phi0, rtol=1e-9)
    inner = result["r"].values < 0.9 * float(last["network_radius"] / last["radius"])
    np.testing.assert_allclose(phi[inner], float(last["core_polymer_fraction"]), rtol=0.02)
    assert (result["fourier_number"].diff("z") > 0).all()
    # diffusion alone, nothing lost: pi D z/Q
    slow = quiet(
        "peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-10 m2/s", "ambient.saturation=1e-12"
    )
    assert float(slow["fourier_number"][-1]) == pytest.approx(np.pi * 2e-10 * 60e-3 / (2e-6 / 3600), rel=1e-8)


def test_what_freezes_stays() -> None:
    result = quiet("peo5-water", *GLASS)
    place = float(result["frozen_position"])
    z = result["z"].values
    assert 0 < place < 60e-3
    assert np.interp(place, z, result["mean_polymer_fraction"]) == pytest.approx(0.75, abs=2e-3)
    beyond = z > place
    np.testing.assert_array_equal(result["frozen"], beyond)
    for name in ("orientation", "strand_stretch", "relative_extension", "axial_stretch"):
        assert np.ptp(result[name].values[beyond]) == 0
    assert float(result["orientation"][-1]) == pytest.approx(float(result["frozen_orientation"]), rel=1e-12)
    assert float(result["frozen_stretch"]) == float(result["strand_stretch"][-1])
    affine = np.interp(place, z, result["stretch_ratio"])
    assert float(result["frozen_relaxed"]) == pytest.approx(1 - float(result["frozen_stretch"]) / affine, abs=1e-3)
    assert np.isnan(result["stress"].values[beyond]).all()
    assert np.isfinite(result["stress"].values[~beyond]).all()
    assert float(result["frozen_radius"]) == pytest.approx(np.interp(place, z, result["radius"]), rel=1e-3)
    assert float(result["frozen_time"]) == pytest.approx(np.interp(place, z, result["residence_time"]), rel=1e-3)
    assert "turns to glass" in " ".join(sl.report.words(result))
    assert "reaches phi = 0.75" in result.attrs["frozen_structure"]
    assert "frozen_orientation" in sl.report.html(result)


def test_skin_before_mean_before_core() -> None:
    result = quiet("peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-9 m2/s", "accuracy.shells=60")
    skin, mean, core = (float(result[f"{name}_position"]) for name in ("skin", "frozen", "core"))
    assert skin < mean
    assert not core <= mean
    assert float(result["skin_stretch"]) < float(result["frozen_stretch"])
    at = result["z"].values > skin * 1.02
    assert (result["skin_thickness"].values[at] > 0).all()
    assert (result["skin_thickness"].values[result["z"].values < skin * 0.98] == 0).all()
    flat = quiet("peo5-water", *GLASS)
    assert mean > float(flat["frozen_position"])  # a skin slows drying


def test_what_does_not_freeze_says_why() -> None:
    short = quiet("peo5-water", *GLASS, "jet.length=10 mm")
    assert np.isnan(float(short["frozen_position"]))
    assert np.isnan(float(short["frozen_orientation"]))
    long = quiet("peo5-water", *GLASS)
    predicted = float(short.attrs["frozen_structure"].split("about ")[1].split(" m ")[0])
    assert predicted == pytest.approx(float(long["frozen_position"]), rel=2e-4)  # it is written with four digits
    few = quiet("peo5-water", *GLASS, "accuracy.points=11")
    assert float(few["frozen_position"]) == pytest.approx(float(long["frozen_position"]), rel=1e-6)
    never = quiet("peo5-water", *WET, "rheology.vitrification_fraction=0.95")
    assert f"drying ends at phi = {equilibrium_fraction(0.4, 0.5):.4g}" in never.attrs["frozen_structure"]
    rubber = quiet("peo5-water", *WET)
    assert "out of reach: dry PEO is no glass at 293.15 K (T_g = 206 K)" in rubber.attrs["frozen_structure"]
    assert "No structure is frozen in" in " ".join(sl.report.words(rubber))


@pytest.mark.parametrize("kelvin", [341.9, 342.0, 345.0])
def test_at_its_melting_point_it_says_where_it_crystallises(kelvin: float) -> None:
    """Dry PEO is a melt from 342 K on: a vitrification fraction is nothing to ask for."""
    melt = quiet("peo5-water", *WET, f"solution.temperature={kelvin} K", "rheology.crystallisation=equilibrium")
    said = melt.attrs["frozen_structure"]
    assert "give rheology.vitrification_fraction" not in said
    if kelvin < 342:
        assert "does not reach phi = 0.99" in said
    else:
        assert said.endswith(f"dry PEO is no glass at {kelvin:g} K (T_g = 206 K); it crystallises below 342 K")


def test_without_a_network_no_fibre_is_promised() -> None:
    water = quiet("peo5-water", "solution.mass_fraction=1e-6")
    text = " ".join(sl.report.words(water))
    assert "no entangled network" in water.attrs["warnings"]
    assert (
        f"No fibre is to be expected: without an entangled network the jet breaks up. Its polymer alone is a thread of "
        f"{1e9 * float(water['fibre_diameter']):.4g} nm" in text
    )
    assert "The dry fibre" not in text
    assert "The dry fibre is" in " ".join(sl.report.words(quiet("peo5-water")))


def test_to_complete_dryness_across_the_jet() -> None:
    """The integration may undershoot dryness by its error: what is dry is dry, and no more."""
    thin = (
        "solution={polymer='PCL', solvent='DCM', volume_fraction=0.0836, relaxation_time='1 ms'}",
        "jet={profile='hyperbolic', radius='11 um', flow_rate='1e-11 m3/s', length='2 mm', p=300}",
        "effects.evaporation=true",
        "effects.radial=true",
        "rheology.diffusivity=6e-8 m2/s",
        "rheology.convention=yarin2001",
        "accuracy.shells=8",
        "rheology.vitrification_fraction=0.9",
    )
    result = quiet("peo5-water", *thin)
    assert float(result["mean_polymer_fraction"][-1]) == pytest.approx(1, abs=1e-6)
    for name in ("mean_polymer_fraction", "polymer_fraction", "drying_polymer_fraction", "surface_polymer_fraction"):
        assert (result[name] <= 1).all()
    flux = np.pi * result["radius"] ** 2 * result["velocity"] * result["mean_polymer_fraction"]
    np.testing.assert_allclose(flux, 0.0836e-11, rtol=1e-12)


def test_a_jet_may_take_up_vapour() -> None:
    wet = quiet(
        "peo5-water",
        "solution={polymer='PEO', solvent='water', volume_fraction=0.5}",
        "ambient.relative_humidity=0.999",
        "effects.evaporation=true",
        "rheology.convention=yarin2001",
    )
    assert float(wet["evaporated_fraction"][-1]) < -0.01
    assert float(wet["mean_polymer_fraction"][-1]) < 0.5
    assert "takes up" in " ".join(sl.report.words(wet))


# --- what is asked for, and what is refused --------------------------------------------------------------------------


def test_auto_takes_what_matters_and_says_so() -> None:
    plain = quiet("peo5-water")
    assert plain.attrs["evaporation_reason"] == "off: there is no [ambient]"
    assert "evaporated_fraction" not in plain
    small = quiet("peo5-water", HUMID)
    assert small.attrs["evaporation_reason"].startswith("off: leaving it out errs by about 0.0018, rtol = 0.01")
    fine = quiet("peo5-water", HUMID, "accuracy.rtol=1e-3")
    assert fine.attrs["evaporation_reason"].startswith("on: leaving it out errs by about 0.0018")
    slow = quiet("peo5-water", "solution.relaxation_time=10 s")
    assert (slow.attrs["model"], slow.attrs["relaxation_reason"][:4]) == ("affine", "off:")
    fast = quiet("peo5-water", "solution.relaxation_time=10 ms")
    assert (fast.attrs["model"], fast.attrs["relaxation_reason"][:3]) == ("conformation", "on:")
    assert "relaxation" not in fast.attrs["effects_left_out"]
    kept = quiet("peo5-water", "solution.relaxation_time=10 ms", "network.model=affine")
    assert "it would matter" in kept.attrs["relaxation_reason"]
    assert "relaxation is left out" in kept.attrs["warnings"]
    flat = quiet("peo5-water", *WET, "rheology.diffusivity=1e-8 m2/s")
    assert flat.attrs["radial_reason"].startswith("off: leaving it out errs")
    drier = quiet("peo5-water", "solution.relaxation_time=10 s", HUMID, "rheology.convention=yarin2001")
    assert (drier.attrs["model"], drier.attrs["relaxation_reason"][:3]) == ("conformation", "on:")
    both = quiet("peo5-water", "solution.relaxation_time=10 ms", "network.coupling=100")
    assert both.attrs["model"] == "two-fluid"
    assert "relaxation" not in both.attrs["effects_left_out"]


@pytest.mark.parametrize("model", ["manifold", "walk"])
def test_other_rungs_dry_too(model: str) -> None:
    few = (
        "accuracy.points=11",
        "accuracy.strands=10",
        "network.closure=" + ("stretch" if model == "manifold" else "force"),
    )
    drying = ("rheology.convention=yarin2001", "jet.length=2 mm", *WET)
    result = quiet("peo5-water", f"network.model={model}", *few, *drying)
    flux = np.pi * result["radius"] ** 2 * result["velocity"] * result["mean_polymer_fraction"]
    moved = flux * result["strand_stretch"] / result["velocity_ratio"]
    free = result["mean_polymer_fraction"].values < 1
    np.testing.assert_allclose(moved.values[free], moved.values[0], rtol=1e-10)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["effects.relaxation=true"], "solution.relaxation_time: is missing.*relaxation_time = "),
        (["effects.evaporation=true"], "ambient.relative_humidity: is missing.*40 %"),
        ([*WET, "effects.radial=true"], "rheology.diffusivity: is missing.*m2/s"),
        (["effects.radial=true", "effects.evaporation=false", HUMID], "effects.radial.*needs evaporation"),
        ([*RELAXING, "effects.relaxation=false"], "effects.relaxation"),
        (["solution.relaxation_time=1 s", "effects.relaxation=true", "network.model=manifold"], "effects.relaxation"),
        ([*ACROSS, "rheology.activity=raoult"], "effects.radial.*Flory"),
        (
            [*WET, "ambient.relative_humidity=0.99", "ambient.temperature=40 degC"],
            "ambient.relative_humidity.*condense",
        ),
        ([*WET, "solution.temperature=100.5 degC"], "solution.temperature.*boiling"),
        ([*WET, "rheology.vitrification_fraction=0.01"], "rheology.vitrification_fraction"),
        (["rheology.law=martin"], "rheology.intrinsic_viscosity: is missing"),
        (["rheology.mobility=0.3"], "rheology.mobility.*Giesekus"),
        (["rheology.constitutive=giesekus"], "rheology.constitutive"),
        (["rheology.D_law=free-volume"], "rheology.D_gap"),
        (["rheology.diffusivty=1e-9 m2/s"], "diffusivity"),
        (["ambient.humidity=0.4"], "relative_humidity"),
        ([*RELAXING, "solution.solvent_viscosity=3 Pa s", "rheology.constitutive=Oldroyd-B"], "Oldroyd-B"),
    ],
)
def test_what_cannot_be_done_is_refused(overrides: list[str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        quiet("peo5-water", *overrides)


def test_own_solvent_needs_its_properties_one_by_one() -> None:
    own = [
        "solution={polymer='PS', solvent={name='mine', density='0.9 g/cm3'}, mass_fraction=0.1}",
        "effects.evaporation=true",
    ]
    for missing, fix in (
        ("ambient.vapour_diffusivity", "ambient.vapour_diffusivity=1e-5 m2/s"),
        ("solution.solvent.molar_mass", "solution.solvent.molar_mass=80 g/mol"),
        ("solution.solvent.vapour_pressure", "solution.solvent.vapour_pressure=20 kPa"),
    ):
        with pytest.raises(InputError, match=missing):
            quiet("peo5-water", *own)
        own.append(fix)
    assert float(quiet("peo5-water", *own)["evaporated_fraction"][-1]) > 0.01
    mixture = "solution={polymer='PVP', solvent={ethanol=0.8, water=0.2}, mass_fraction=0.1}"
    with pytest.raises(InputError, match="one number, and the solvent is a mixture"):
        quiet("peo5-water", mixture, *WET, "ambient.saturation=1e-5")
    assert "ethanol" in quiet("peo5-water", mixture, *WET).attrs["evaporation"]


def test_check_finds_what_is_missing_before_it_runs(spinline) -> None:
    for overrides, words in (
        (["effects.evaporation=true"], "ambient.relative_humidity"),
        ([HUMID, "effects.radial=true"], "rheology.diffusivity"),
        (["effects.relaxation=true"], "solution.relaxation_time"),
    ):
        ran = spinline("check", "peo5-water", *(part for key in overrides for part in ("--set", key)))
        assert (ran.code, words in ran.err) == (2, True)
    assert spinline("check", "pmma10-drying").code == 0


def test_numbers_that_decide() -> None:
    scene = sl.load_scene(
        "peo5-water", [*ISOTHERMAL, "solution.relaxation_time=10 ms", HUMID, "rheology.diffusivity=1e-9 m2/s"]
    )
    solution = build_solution(scene)
    numbers = effect_numbers(scene, solution, build_jet(scene, solution))
    assert numbers.missing == {"heat": "set so"}
    result = quiet("peo5-water", *ACROSS, "rheology.diffusivity=1e-9 m2/s", "solution.relaxation_time=10 ms")
    assert numbers.evaporated_fraction == pytest.approx(float(result["evaporated_fraction"][-1]), rel=0.01)
    assert numbers.drying_peclet == pytest.approx(float(result["drying_peclet"].max()), rel=0.01)
    assert numbers.fourier == pytest.approx(float(result["fourier_number"][-1]), rel=0.01)
    uneven = float((result["surface_polymer_fraction"] / result["mean_polymer_fraction"]).max() - 1)
    assert numbers.errors["radial"] == pytest.approx(uneven, rel=0.7)  # an estimate
    assert numbers.errors["relaxation"] == numbers.relaxation.error
    assert numbers.deborah == numbers.relaxation.number
    slow = sl.load_scene("peo5-water", ["solution.relaxation_time=5 s"])
    estimate = effect_numbers(slow, solution := build_solution(slow), build_jet(slow, solution)).errors["relaxation"]
    relaxed, affine = (
        quiet("peo5-water", "solution.relaxation_time=5 s", f"network.model={m}") for m in ("conformation", "affine")
    )
    assert estimate == pytest.approx(largest(difference(affine, relaxed)), rel=0.15)
    assert 1e-12 < numbers.inertia < 1e-7
    bare = sl.load_scene("peo5-water")
    less = effect_numbers(bare, build_solution(bare), build_jet(bare, build_solution(bare)))
    assert set(less.missing) == {"relaxation", "evaporation", "radial", "heat"}
    assert np.isnan(less.deborah)
    assert less.errors["slip"] == pytest.approx(quiet("peo5-water").attrs["coupling_error"])


@pytest.mark.slow
def test_everything_is_written_and_drawn(tmp_path) -> None:
    result = quiet("peo5-water", *GLASS, "effects.radial=true", "rheology.diffusivity=2e-9 m2/s", "accuracy.points=50")
    assert set(map(str, result.variables)) <= set(VARIABLES)
    assert result["polymer_fraction"].dims == ("z", "r")
    assert result["r"].attrs["units"] == "1"
    sl.results.save(result, tmp_path / "a.nc")
    assert sl.open_result(tmp_path / "a.nc").identical(result)
    table = sl.results.to_csv(result, tmp_path / "a.csv").read_text().splitlines()
    assert len(table) == result.sizes["z"] + 1
    assert len(sl.figures.png(result)) > 10_000
    text = " ".join(sl.report.words(result))
    assert "The jet loses" in text
    assert "at the surface against" in text
    assert len(sl.figures.png(quiet("pvp-jetspin", *RELAXING))) > 10_000
