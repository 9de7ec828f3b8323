"""Heat, humidity and solids in runs: what a scene file gets, against the physics below it, and what is refused."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import spinline as sl
from spinline.base.errors import InputError, SpinlineWarning
from spinline.rheology import Solution
from spinline.scene.file import scene_from_dict
from spinline.scene.materials_file import read_materials
from spinline.setup.build import build_solution
from spinline.setup.context import Context
from spinline.setup.heat import build_heated_air

PEO = {
    "title": "PEO to dryness",
    "solution": {
        "polymer": "PEO",
        "molar_mass": "600 kDa",
        "solvent": "water",
        "mass_fraction": 0.05,
        "temperature": "25 degC",
        "viscosity": "2 Pa s",
    },
    "jet": {
        "profile": "power-law",
        "radius": "30 um",
        "flow_rate": "0.02 mL/hour",
        "k": 0.6,
        "beta": 0.47,
        "length": "15 cm",
    },
    "ambient": {"relative_humidity": 0.3},
    "network": {"model": "affine"},
    "accuracy": {"points": 201},
}
PCL = {
    "solution": {
        "polymer": "PCL",
        "molar_mass": "80 kDa",
        "solvent": "DCM",
        "mass_fraction": 0.1,
        "temperature": "22 degC",
    },
    "jet": {
        "profile": "power-law",
        "radius": "50 um",
        "flow_rate": "0.3 mL/hour",
        "k": 0.6,
        "beta": 0.47,
        "length": "10 cm",
    },
    "ambient": {"relative_humidity": 0.4},
    "network": {"model": "affine"},
    "accuracy": {"points": 201},
}


def merged(base: dict, **sections: dict) -> dict:
    return {**base, **{name: {**base.get(name, {}), **more} for name, more in sections.items()}}


def run(data: dict):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", SpinlineWarning)
        warnings.filterwarnings("ignore", module="chemicals")
        return sl.run(scene_from_dict(data))


@pytest.fixture(scope="module")
def peo():
    return run(PEO)


def test_a_run_is_the_balance_of_its_own_air(peo) -> None:
    scene = scene_from_dict(PEO)
    solution = build_solution(scene)
    air = build_heated_air(scene, solution)
    z = peo["z"].values[1:]
    from spinline.drying.along_jet import element_path

    jet = air.dry(element_path(Context(scene).jet, z), solution.volume_fraction)
    np.testing.assert_allclose(peo["temperature"].values[1:], jet.temperature, atol=1e-6)
    np.testing.assert_allclose(peo["evaporated_fraction"].values[1:], jet.lost, rtol=1e-7)
    assert peo.attrs["heat_reason"].startswith("on: leaving it out errs")
    assert "kJ/kg" in peo.attrs["evaporation"]
    assert float(np.nanmin(peo["temperature"])) - 273.15 == pytest.approx(air.wet_bulb - 273.15, abs=0.3)


def test_peo_and_pcl_end_solid_with_a_finite_stretch(peo) -> None:
    for result in (peo, run(PCL)):
        place = float(result["arrest_position"])
        assert 0 < place < float(result["z"][-1])
        assert "crystals" in result.attrs["frozen_structure"]
        w = result["strand_stretch"].values[result["z"].values > place]
        assert np.ptp(w) == 0
        assert 1 < w[0] < 1e4
        assert np.isfinite(float(result["fibre_diameter"]))
        assert np.isnan(float(result["crystallinity"]))  # no kinetics given
    # at the air's own temperature PEO waits for 0.768; the jet is cold there, not below the nozzle's
    assert float(peo["arrest_fraction"]) == pytest.approx(0.768, abs=0.02)


def test_a_chill_is_too_short_for_crystals(peo, monkeypatch) -> None:
    """Counted, it would make PCL solid within the first millimetres, and leaves PEO's fibre what it is."""
    from spinline.setup.solid import Solid

    own = Solid.crystal_margin

    def chilled(self, here):
        return own(replace(self, nozzle=0.0), here)

    kept = run(PCL)
    monkeypatch.setattr(Solid, "crystal_margin", chilled)
    counted, soon = run(PEO), run(PCL)
    assert float(counted["arrest_fraction"]) < float(peo["arrest_fraction"]) - 0.03
    assert float(counted["fibre_diameter"]) == pytest.approx(float(peo["fibre_diameter"]), rel=0.01)
    assert float(soon["arrest_position"]) < 0.1 * float(kept["arrest_position"])
    assert float(soon["arrest_fraction"]) < 0.15


def test_what_is_undercooled_from_the_start_is_solid_when_dry() -> None:
    """PVDF in DMF: its dry melt would not be a glass, and its solution stands 126 K under its melting point."""
    slow = merged(
        PCL,
        solution={"polymer": "PVDF", "solvent": "DMF", "molar_mass": "270 kDa", "mass_fraction": 0.15},
        jet={"length": "70 cm"},
        accuracy={"points": 401},
    )
    result = run(slow)
    assert result.attrs["frozen_structure"].count("solid when dry") == 1
    assert "a question of time" in result.attrs["frozen_structure"]
    assert float(result["arrest_fraction"]) == pytest.approx(0.95, abs=2e-3)
    place = float(result["arrest_position"])
    assert np.ptp(result["strand_stretch"].values[result["z"].values > place]) == 0


@pytest.mark.parametrize("heat", [False, True])
def test_frozen_section_fibre_and_stretch_agree(heat: bool) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        result = sl.run(
            sl.load_scene(
                "pmma10-drying", ("jet.length=50 mm", "effects.radial=false") if heat else ("effects.heat=false",)
            )
        )
    fibre, phi0 = float(result["fibre_radius"]), float(result["volume_fraction"])
    frozen = float(result["frozen_radius"]) * np.sqrt(float(result["arrest_fraction"]))
    assert frozen == pytest.approx(fibre, rel=1e-9)
    jet = Context(sl.load_scene("pmma10-drying")).jet
    stretch = float(jet.stretch_ratio(float(result["arrest_position"])))
    assert fibre == pytest.approx(50e-6 * np.sqrt(phi0 / stretch), rel=1e-9)
    assert float(result["fibre_diameter"]) == 2 * fibre
    if not heat:
        assert fibre == pytest.approx(1.705e-6, rel=1e-3)
        assert "temperature" not in result
    else:
        assert 1e3 * float(result["arrest_position"]) == pytest.approx(36, abs=3)
        assert float(result["arrest_temperature"]) < 298.15
        theta = result["relaxation_time"].values
        assert theta[-1] / theta[0] > 1e6  # by decades into the glass


def test_air_that_condenses_is_air_with_heat() -> None:
    """Warm wet air on a cold jet: refused at one temperature, a growing jet with heat."""
    warm = merged(PEO, ambient={"relative_humidity": 0.9, "temperature": "45 degC"})
    grown = run(warm)
    assert grown["evaporated_fraction"].values[1:40].min() < 0
    assert float(np.nanmax(grown["temperature"])) > 298.15
    with pytest.raises(InputError, match="condense"):
        run(merged(warm, effects={"heat": False, "evaporation": True}))


def test_composition_paths() -> None:
    film = merged(
        PCL,
        solution={"polymer": "PMMA", "solvent": "acetone", "temperature": "25 degC"},
        ambient={"relative_humidity": 0.6},
        jet={"radius": "100 um", "flow_rate": "1 mL/hour", "k": 1.0},
    )
    porous = run(film)
    assert porous.attrs["composition_path"].startswith("porous: crosses the spinodal at")
    dry = run(merged(film, ambient={"relative_humidity": 0.0, "temperature": "25 degC"}))
    assert dry.attrs["composition_path"] == "no water in the jet or in its air: one phase (chi 0.48)"
    alone = run(merged(PEO, rheology={"chi": 0.7}))
    assert alone.attrs["composition_path"].startswith("water is the only liquid: porous: inside the spinodal from 0 m")
    unknown = run(merged(film, solution={"polymer": "PVP", "solvent": "ethanol"}, ambient={"relative_humidity": 0.0}))
    assert unknown.attrs["composition_path"].endswith(
        "not judged, for want of rheology.chi (PVP with ethanol): give what is known of it"
    )
    other = run(merged(film, solution={"polymer": "PVP", "solvent": "ethanol"}))
    assert "not judged" in other.attrs["composition_path"]
    assert "rheology.chi_water_solvent" in other.attrs["composition_path"]
    said = (
        "chi of PVP is not known, and taken to be 0.5 with ethanol (rheology.chi), 0.5 with water (rheology.chi_water)"
    )
    assert said in other.attrs["warnings"]
    assert "is not known, and taken" not in dry.attrs["warnings"]
    mixes = merged(
        film,
        solution={"polymer": "PVP", "solvent": "ethanol"},
        rheology={"chi": 0.4, "chi_water": 0.4, "chi_water_solvent": 0.5},
    )
    assert run(mixes).attrs["composition_path"].startswith("one phase")


def test_kinetics_give_a_degree_of_crystallinity() -> None:
    slow = run(
        merged(
            PEO,
            rheology={"crystallisation": "nakamura", "crystallisation_half_time": "1 s", "maximum_crystallinity": 0.7},
        )
    )
    fast = run(
        merged(
            PEO,
            rheology={"crystallisation": "nakamura", "crystallisation_half_time": "1 ms", "maximum_crystallinity": 0.7},
        )
    )
    assert 0 < float(slow["crystallinity"]) < float(fast["crystallinity"])
    assert float(fast["crystallinity"]) == pytest.approx(0.7, abs=1e-3)
    assert float(fast["arrest_position"]) < 0.15
    with pytest.raises(InputError, match="melting_temperature"):
        run(
            merged(
                PCL,
                solution={"polymer": "PVP", "solvent": "ethanol"},
                rheology={"crystallisation": "nakamura", "crystallisation_half_time": "1 s"},
            )
        )


def test_concentrations_names_and_library_chains() -> None:
    def solution(**changes: object) -> Solution:
        s = {k: v for k, v in PEO["solution"].items() if k != "mass_fraction"} | changes
        return build_solution(scene_from_dict({**PEO, "solution": s}))

    grams = solution(concentration="50 g/L")
    assert grams.volume_fraction == pytest.approx(50 / 1130, rel=1e-12)
    for text in ("5 % w/v", "5 w/v%", "5 % (w/v)", "0.05 g/mL"):
        assert solution(concentration=text).volume_fraction == pytest.approx(grams.volume_fraction, rel=1e-12)
    assert grams.kuhn_length == 1.1e-9
    assert solution(polymer="poly(ethylene oxide)", concentration="50 g/L") == grams
    with pytest.raises(InputError, match="more than the polymer's density"):
        solution(concentration="2 kg/L")
    with pytest.raises(InputError, match="not both and not none"):
        solution(concentration="50 g/L", mass_fraction=0.05)
    guess = solution(concentration="50 g/L", viscosity="estimate", relaxation_time="estimate")
    assert 1 < guess.viscosity < 50
    assert guess.relaxation_time > 0
    with pytest.raises(InputError, match=r"solution.molar_mass.*the estimate of viscosity needs it"):
        build_solution(
            scene_from_dict(
                {
                    **PEO,
                    "solution": {"polymer": "PEO", "solvent": "water", "mass_fraction": 0.05, "viscosity": "estimate"},
                }
            )
        )


def test_materials_of_ones_own(tmp_path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(
        '[polymers.PEOX]\ndensity = "1.14 g/cm3"\nrepeat_unit_molar_mass = "99.13 g/mol"\nbackbone_bonds = 3\n'
        'kuhn_length = "1.2 nm"\nglass_transition = "60 degC"\nsource = "a paper"\n'
        '[solvents.limonene]\ndensity = "0.84 g/cm3"\nmolar_mass = "136 g/mol"\nvapour_pressure = "200 Pa"\n'
        'latent_heat = "0.36 MJ/kg"\nheat_capacity = "1.8 kJ/kg/K"\nglass_transition = "130 K"\n'
    )
    scene_file = tmp_path / "scene.toml"
    scene_file.write_text(
        '[solution]\npolymer = "PEOX"\nsolvent = "limonene"\nmass_fraction = 0.2\nmaterials = "mine.toml"\n'
        '[jet]\nprofile = "power-law"\nradius = "50 um"\nflow_rate = "0.3 mL/hour"\nk = 0.5\nbeta = 0.47\nlength = "20 mm"\n'
        '[ambient]\nvapour_diffusivity = "6e-6 m2/s"\n[effects]\nevaporation = true\nheat = true\n[network]\nmodel = "affine"\n'
    )
    scene = sl.load_scene(scene_file)
    solution = build_solution(scene)
    assert (solution.polymer.name, solution.kuhn_length, solution.polymer.glass_transition) == ("PEOX", 1.2e-9, 333.15)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpinlineWarning)
        result = sl.run(scene)
    assert float(result["temperature"][-1]) < 293.15
    meant = scene_file.read_text().replace('"PEOX"', '"PEOXX"')
    scene_file.write_text(meant)
    with pytest.raises(InputError, match=r"neither in the file of materials nor built in.*did you mean 'PEOX'\?"):
        sl.load_scene(scene_file)
    file.write_text('[polymers.PEOX]\ndensty = "1 g/cm3"\n')
    with pytest.raises(InputError, match="densty"):
        read_materials(file)
    with pytest.raises(InputError, match="cannot be read as a file of materials"):
        read_materials(tmp_path / "none.toml")


def test_refusals() -> None:
    with pytest.raises(InputError, match=r"effects.heat.*yarin2001"):
        run(merged(PEO, effects={"heat": True}, rheology={"convention": "yarin2001"}))
    with pytest.raises(InputError, match=r"effects.heat.*needs evaporation"):
        run(merged(PEO, effects={"heat": True, "evaporation": False}))
    unknown = merged(
        PCL,
        solution={
            "solvent": {
                "name": "limonene",
                "density": "840 kg/m3",
                "molar_mass": "136 g/mol",
                "vapour_pressure": "200 Pa",
            }
        },
        ambient={"vapour_diffusivity": "6e-6 m2/s"},
        effects={"heat": True},
    )
    with pytest.raises(InputError, match=r"solution.solvent.latent_heat: is not built in; give it: 0.2 to 2.4 MJ/kg"):
        run(unknown)
    assert (
        run(merged(unknown, effects={"heat": "auto"}))
        .attrs["heat_reason"]
        .startswith("off: solution.solvent.latent_heat")
    )
    with pytest.raises(InputError, match=r"rheology\.transfer"):
        run(merged(PEO, rheology={"transfer": "magic"}))
    with pytest.raises(InputError, match="crystallisation_half_time"):
        run(merged(PEO, rheology={"crystallisation_half_time": "1 s"}))
