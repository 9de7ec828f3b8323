"""Solutions: conversions, built-in materials, refusals."""

import re
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from chemicals.elements import molecular_weight, simple_formula_parser
from chemicals.identifiers import MW
from chemicals.interface import Winterfeld_Scriven_Davis
from hypothesis import given
from hypothesis import strategies as st

from spinline import rheology
from spinline.base.errors import InputError
from spinline.network import network_at_rest
from spinline.rheology import POLYMERS, SOLVENTS, Polymer, Solution, fractions, materials, solvents
from spinline.rheology.entanglement import entanglement_fraction, overlap_fraction


def test_peo_five_percent_is_0_0444_by_volume() -> None:
    solution = Solution.build("PEO", "water", mass_fraction=0.05, molar_mass=600.0)
    assert round(solution.volume_fraction, 4) == 0.0444
    assert solution.mass_fraction == pytest.approx(0.05, rel=1e-14)
    assert solution.volume_fraction * solution.polymer.density / solution.density == pytest.approx(0.05, rel=1e-14)
    # 600 kg/mol: 13620 repeats of 3 bonds of 0.126 nm are 5148 Kuhn segments of 1 nm
    assert solution.segments_per_chain == pytest.approx(600 / 0.04405256 * 3 * 0.126, rel=1e-12)


@given(st.floats(1e-9, 1 - 1e-9), st.floats(500, 2000), st.floats(500, 2000))
def test_fractions_are_inverse_and_bounded(w: float, rho_p: float, rho_s: float) -> None:
    phi = rheology.volume_fraction(w, rho_p, rho_s)
    assert 0 < phi < 1
    assert rheology.mass_fraction(phi, rho_p, rho_s) == pytest.approx(w, rel=1e-9)
    assert rheology.volume_fraction(w, rho_p, rho_p) == pytest.approx(w, rel=1e-14)


STIFF = ("cellulose acetate", "gelatin")


@pytest.mark.parametrize("name", POLYMERS)
def test_molar_mass_of_the_repeat_unit_is_that_of_its_formula(name: str) -> None:
    data = POLYMERS[name]
    expected = molecular_weight(simple_formula_parser(data.repeat_unit)) * 1e-3
    assert data.repeat_unit_molar_mass == pytest.approx(expected, rel=1e-6)
    assert re.search(r"\(\d{4}\)", data.source)


# CRC Handbook of Chemistry and Physics, 97th ed., liquids at 25 degC: g/cm3 and mPa s
@pytest.mark.parametrize(
    ("name", "density", "viscosity"),
    [
        ("water", 0.9970, 0.890),
        ("ethanol", 0.785, 1.074),
        ("acetone", 0.7845, 0.306),
        ("DMF", 0.9445, 0.794),
        ("DCM", 1.3168, 0.413),
        ("chloroform", 1.4788, 0.537),
        ("THF", 0.8833, 0.456),
        ("formic acid", 1.2137, 1.607),
        ("HFIP", 1.596, 1.619),
    ],
)
def test_solvents(name: str, density: float, viscosity: float) -> None:
    assert rheology.solvent_density(name, 298.15) == pytest.approx(1000 * density, rel=6e-3)
    assert rheology.solvent_viscosity(name, 298.15) == pytest.approx(1e-3 * viscosity, rel=0.05)
    assert name in SOLVENTS


def test_mixture_has_additive_volumes() -> None:
    a = Solution.build("PVP", {"ethanol": 0.85, "water": 0.15}, mass_fraction=0.025)
    volume = 0.85 / rheology.solvent_density("ethanol", 293.15) + 0.15 / rheology.solvent_density("water", 293.15)
    assert a.solvent_density == pytest.approx(1 / volume, rel=1e-14)


def test_own_materials_and_overrides() -> None:
    own = Solution.build(Polymer("mine", 1000.0), "limonene", volume_fraction=0.1, solvent_density=840.0)
    assert np.isnan(own.segments_per_chain)
    heavy = Solution.build("PEO", "water", mass_fraction=0.05, polymer_density=1200.0)
    assert heavy.polymer.density == 1200.0
    assert heavy.polymer.repeat_unit == "C2H4O"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"polymer_data": "PE0"}, "did you mean 'PEO'"),
        ({"polymer_data": "kevlar"}, "not built in"),
        ({"solvent": "watr"}, "did you mean 'water'"),
        ({"mass_fraction": 0.0}, "mass_fraction"),
        ({"mass_fraction": 1.0}, "mass_fraction"),
        ({"mass_fraction": np.nan}, "mass_fraction"),
        ({"mass_fraction": None}, "one of"),
        ({"volume_fraction": 0.1}, "one of"),
        ({"molar_fraction": 0.1}, "one of"),
        ({"mass_fraction": None, "molar_fraction": 0.1}, r"molar_mass: is not known; give molar_mass \(kg/mol\)"),
        ({"solvent": 3.0}, "solvent"),
        ({"mass_fraction": [0.1]}, "single number"),
        ({"surface_tension": 0.0}, "surface_tension"),
        ({"conductivity": -1.0}, "conductivity"),
        ({"temperature": -3.0}, "temperature"),
        ({"temperature": 900.0}, "liquid range"),
        ({"solvent": {"ethanol": 0.5, "water": 0.4}}, "sum to 1"),
        ({"solvent": {"water": 1.5}}, "solvent"),
        ({"solvent": {}}, "sum to 1"),
        ({"kuhn_length": 0.0}, "kuhn_length"),
        ({"molar_mass": -1.0}, "molar_mass"),
        ({"solvent_density": np.inf}, "solvent_density"),
    ],
)
def test_refusals(change: dict, words: str) -> None:
    arguments = {"polymer_data": "PEO", "solvent": "water", "mass_fraction": 0.05}
    with pytest.raises(InputError, match=words):
        Solution.build(**(arguments | change))


# plateau moduli (MPa) and melt densities (kg/m3) at 413 K, Fetters et al. (1994)
@pytest.mark.parametrize(("name", "plateau", "density"), [("PEO", 1.80, 1064), ("PS", 0.20, 969), ("PMMA", 0.31, 1130)])
def test_entanglement_molar_mass_follows_from_the_plateau_modulus(name: str, plateau: float, density: float) -> None:
    expected = 0.8 * density * 8.314462618 * 413 / (plateau * 1e6)
    assert rheology.polymer_property(name, "entanglement_molar_mass") == pytest.approx(expected, rel=2e-3)
    assert 0.5e-9 < rheology.polymer_property(name, "kuhn_length") < (15e-9 if name in STIFF else 2.1e-9)


@pytest.mark.parametrize("name", POLYMERS)
def test_every_polymer_makes_solutions_and_says_where_its_numbers_come_from(name: str) -> None:
    solution = Solution.build(name, "DMF", mass_fraction=0.1, molar_mass=100.0)
    assert 0.05 < solution.volume_fraction < 0.1
    assert solution.segments_per_chain > (10 if name in STIFF else 100)
    if name in STIFF:  # no flexible melt: no packing length
        with pytest.raises(InputError, match="entanglement_molar_mass"):
            rheology.polymer_property(name, "entanglement_molar_mass")
    for prop in ("density", "kuhn_length", "entanglement_molar_mass", "glass_transition", "backbone_bonds"):
        if prop == "entanglement_molar_mass" and name in STIFF:
            continue
        assert np.isfinite(rheology.polymer_property(name, prop))
        assert len(rheology.property_source(name, prop)) > 10
    assert rheology.property_source(Polymer("mine", 1000.0), "density") == "given by the user"
    own = Solution.build(name, "DMF", mass_fraction=0.1, polymer_density=999.0).polymer
    assert rheology.property_source(own, "density") == "given by the user"
    assert rheology.property_source(own, "kuhn_length") != "given by the user"


def test_missing_properties_are_named() -> None:
    with pytest.raises(InputError, match=r"kuhn_length of mine: is not built in; give it \(m\)"):
        rheology.polymer_property(Polymer("mine", 1000.0), "kuhn_length")
    with pytest.raises(InputError, match="backbone_bonds of mine"):
        rheology.polymer_property(Polymer("mine", 1000.0), "backbone_bonds")
    with pytest.raises(InputError, match="is not one of a polymer"):
        rheology.polymer_property("PEO", "colour")
    heavy = Solution.build("PEO", "water", mass_fraction=0.05, polymer_density=1200.0)
    assert heavy.polymer.kuhn_length == 1.1e-9


def test_vitrification_by_fox() -> None:
    phi = rheology.vitrification_fraction("PVA", 136.0, 298.15, 997.0)
    w = rheology.mass_fraction(phi, 1269.0, 997.0)
    assert w / 358.0 + (1 - w) / 136.0 == pytest.approx(1 / 298.15, rel=1e-12)
    assert 0.7 < phi < 1
    near = rheology.vitrification_fraction("PS", 129.0, 372.999, 944.0)
    assert near == pytest.approx(1.0, abs=1e-4)
    with pytest.raises(InputError, match="makes dry PEO a melt"):
        rheology.vitrification_fraction("PEO", 136.0, 298.15, 997.0)
    with pytest.raises(InputError, match="glass_transition of mine"):
        rheology.vitrification_fraction(Polymer("mine", 1000.0), 136.0, 298.15, 997.0)


PAIRS = [
    ("PEO", "water"),
    ("PS", "DMF"),
    ("PMMA", "HFIP"),
    ("PCL", {"chloroform": 0.6, "DMF": 0.4}),
    ("PLA", "DCM"),
    ("PVA", "formic acid"),
]


@pytest.mark.parametrize(("polymer", "solvent"), PAIRS)
@pytest.mark.parametrize("w", [1e-300, 1e-9, 0.05, 0.3, 0.7, 0.999])
def test_fractions_go_there_and_back(polymer: str, solvent, w: float) -> None:
    by_mass = Solution.build(polymer, solvent, mass_fraction=w, molar_mass=200.0, temperature=298.15)
    assert by_mass.mass_fraction == pytest.approx(w, rel=1e-14)
    phi = by_mass.volume_fraction
    by_volume = Solution.build(polymer, solvent, volume_fraction=phi, molar_mass=200.0, temperature=298.15)
    assert by_volume.mass_fraction == pytest.approx(w, rel=1e-14)
    assert 0 < by_volume.molar_fraction < by_volume.repeat_unit_fraction < 1
    if w < 1e-100:
        return
    by_number = Solution.build(
        polymer, solvent, molar_fraction=by_mass.molar_fraction, molar_mass=200.0, temperature=298.15
    )
    # from number to mass an error grows with the chain over the solvent, (1 - x)/(1 - w) in all
    assert by_number.mass_fraction == pytest.approx(w, rel=1e-14)
    assert by_number.volume_fraction == pytest.approx(phi, rel=1e-14)


@given(st.floats(0, 1), st.floats(0.01, 1e4), st.floats(0.01, 0.2))
def test_molar_fractions_of_any_chain(w: float, chain: float, small: float) -> None:
    x = float(fractions.molar_fraction(w, chain, small))
    moles, rest = w / chain, (1 - w) / small
    assert x == pytest.approx(moles / (moles + rest), rel=1e-14)
    assert fractions.mass_fraction_from_molar(x, chain, small) == pytest.approx(w, rel=1e-14, abs=1e-300)


@pytest.mark.parametrize(
    "law",
    [rheology.volume_fraction, rheology.mass_fraction, fractions.molar_fraction, fractions.mass_fraction_from_molar],
)
def test_pure_ends_are_exact(law) -> None:
    for a, b in ((1130.0, 998.0), (1e-300, 1e300), (1e300, 1e-300), (600.0, 0.018)):
        assert law(0.0, a, b) == 0.0
        assert law(1.0, a, b) == 1.0


def test_fractions_against_mpmath_at_extreme_weights() -> None:
    for w in (1e-300, 1e-8, 0.5, 1 - 1e-12):
        for a, b in ((1e150, 1e-150), (1e-150, 1e150), (3.0, 7.0)):
            with mpmath.workdps(40):
                p = mpmath.mpf(w) / mpmath.mpf(a)
                exact = p / (p + (1 - mpmath.mpf(w)) / mpmath.mpf(b))
            assert float(rheology.volume_fraction(w, a, b)) == pytest.approx(float(exact), rel=1e-15, abs=1e-300)


def test_solvent_mixtures_by_every_fraction() -> None:
    mixed = Solution.build("PVP", {"ethanol": 0.85, "water": 0.15}, mass_fraction=0.025)
    assert sum(mixed.solvent_volume_fractions.values()) == pytest.approx(1.0, rel=1e-15)
    assert mixed.solvent_molar_fractions["water"] == pytest.approx(
        (0.15 / 18.01528) / (0.15 / 18.01528 + 0.85 / 46.06844), rel=1e-12
    )
    mean = 1 / (0.85 / 46.06844e-3 + 0.15 / 18.01528e-3)
    assert mixed.require("solvent_molar_mass") == pytest.approx(mean, rel=1e-12)
    assert mixed.concentration == pytest.approx(mixed.mass_fraction * mixed.density, rel=1e-14)
    assert Solution.build("PEO", "water", mass_fraction=0.1).solvent_volume_fractions == {"water": 1.0}


def test_a_missing_property_says_how_to_give_it() -> None:
    known = Solution.build(
        "PEO", "water", mass_fraction=0.05, viscosity=2.0, surface_tension=0.06, conductivity=0.01, molar_mass=600.0
    )
    assert [known.require(name) for name in ("viscosity", "surface_tension", "conductivity")] == [2.0, 0.06, 0.01]
    assert known.require("solvent_viscosity") == rheology.solvent_viscosity("water", 293.15)
    for name, unit in (("relaxation_time", "s"),):
        with pytest.raises(InputError, match=rf"{name}: is not known; give {name} \({unit}\)"):
            known.require(name)
    bare = Solution.build(Polymer("mine", 1000.0), "limonene", volume_fraction=0.1, solvent_density=840.0)
    with pytest.raises(
        InputError, match=r"solvent_viscosity: of limonene is not built in; give solvent_viscosity \(Pa s\)"
    ):
        bare.require("solvent_viscosity")
    with pytest.raises(InputError, match="is not one of a solution"):
        bare.require("colour")
    with pytest.raises(InputError, match="repeat_unit_molar_mass of mine"):
        replace(bare, molar_mass=100.0).entanglement()


# surface tensions at 298 K: Minnesota solvent descriptors, cal/(mol A2)
@pytest.mark.parametrize(
    ("name", "descriptor"),
    [
        ("ethanol", 31.62),
        ("acetone", 33.77),
        ("DCM", 39.15),
        ("chloroform", 38.39),
        ("formic acid", 53.44),
        ("DMF", 49.56),
        ("THF", 39.44),
    ],
)
def test_surface_tensions_of_two_sources_agree(name: str, descriptor: float) -> None:
    expected = descriptor * 4.184 / 6.02214076e23 / 1e-20
    assert solvents.solvent_surface_tension(name, 298.15) == pytest.approx(expected, rel=0.035)


def test_surface_tension_of_water_and_mixtures() -> None:
    assert solvents.solvent_surface_tension("water", 298.15) == pytest.approx(0.07197, rel=1e-3)  # IAPWS R1-76
    shares = {"ethanol": 0.3, "water": 0.7}
    sigma = [solvents.solvent_surface_tension(name, 298.15) for name in shares]
    molar = [solvents.solvent_density(name, 298.15) / solvents.solvent_molar_mass(name) for name in shares]
    moles = [w / solvents.solvent_molar_mass(name) for name, w in shares.items()]
    library = Winterfeld_Scriven_Davis([n / sum(moles) for n in moles], sigma, molar)
    assert solvents.mixture_surface_tension(shares, 298.15) == pytest.approx(library, rel=1e-12)
    alone = {"water": 1.0}
    assert solvents.mixture_viscosity(alone, 298.15) == pytest.approx(
        solvents.solvent_viscosity("water", 298.15), rel=1e-14
    )
    with pytest.raises(InputError, match=r"range of the surface tension of HFIP.*give surface_tension"):
        solvents.solvent_surface_tension("HFIP", 350.0)


@pytest.mark.parametrize("name", SOLVENTS)
def test_every_solvent_has_every_property(name: str) -> None:
    assert solvents.solvent_molar_mass(name) == pytest.approx(MW(SOLVENTS[name][0]) * 1e-3, rel=1e-7)
    assert 0.01 < solvents.solvent_surface_tension(name, 298.15) < 0.08
    assert 90 < solvents.solvent_glass_transition(name) < 200


def test_hfip_density_follows_its_neighbours() -> None:
    """Fluorine for hydrogen adds as much volume to isopropanol as to ethanol: 1611 kg/m3, not the 1460 of a handbook."""
    ethanol, trifluoroethanol, isopropanol = 58.37e-6, 72.27e-6, 76.51e-6  # m3/mol
    volume = isopropanol + 6 * (trifluoroethanol - ethanol) / 3
    assert solvents.solvent_density("HFIP", 298.15) == pytest.approx(0.168037799 / volume, rel=0.015)


@pytest.mark.parametrize("quality", ["theta", "good"])
def test_entanglement_state_is_that_of_the_network(quality) -> None:
    for w in (0.002, 0.02, 0.05, 0.3):
        solution = Solution.build("PEO", "water", mass_fraction=w, molar_mass=600.0)
        state, rest = solution.entanglement(quality), network_at_rest(solution.volume_fraction, quality)
        if state.regime != "dilute":
            assert state.segments_per_strand == pytest.approx(float(rest.segments), rel=1e-12)
            assert state.mesh_size == pytest.approx(1e-9 * float(rest.size), rel=1e-12)
        assert state.contour_length == pytest.approx(1e-9 * state.segments_per_strand, rel=1e-15)
        assert state.strands_per_chain >= 1
        assert state.entangled == (state.entanglements >= 2 and solution.volume_fraction >= state.overlap_fraction)


def test_overlap_and_entanglement() -> None:
    n = 5000.0
    for quality, strand in (("theta", -2.0), ("good", -1.25)):
        assert float(overlap_fraction(n, quality)) ** strand == pytest.approx(n, rel=1e-12)  # the strand is the chain
    # Z = 2 in the melt of 2 M_e; dilution by (4/3) in theta
    assert float(entanglement_fraction(20.0, 10.0)) == pytest.approx(1.0, rel=1e-14)
    assert float(entanglement_fraction(320.0, 10.0)) == pytest.approx(16.0**-0.75, rel=1e-14)
    assert float(entanglement_fraction(320.0, 10.0, "good")) == pytest.approx(16 ** -(3 * 0.588 - 1), rel=1e-14)
    short, long = (Solution.build("PS", "THF", mass_fraction=0.1, molar_mass=m) for m in (20.0, 2000.0))
    assert not short.entanglement("good").entangled
    assert long.entanglement("good").entangled
    at = Solution.build("PEO", "water", volume_fraction=float(entanglement_fraction(600.0, 1.624)), molar_mass=600.0)
    assert at.entanglement().entanglements == pytest.approx(2.0, rel=1e-12)


def test_packing_length_estimates() -> None:
    """Against the M_e from plateau moduli (Fetters et al.)."""
    for name, off in (("PMMA", 0.05), ("PS", 0.06), ("PEO", 0.4)):
        p = POLYMERS[name]
        melt = {"PMMA": 1130.0, "PS": 969.0, "PEO": 1064.0}[name]
        found = materials.packing_entanglement_molar_mass(
            melt, p.repeat_unit_molar_mass, p.backbone_bonds, p.kuhn_length
        )
        assert found == pytest.approx(p.entanglement_molar_mass, rel=off)


def test_vitrification_of_a_solution() -> None:
    solution = Solution.build("PS", "DMF", mass_fraction=0.2, temperature=298.15)
    low = solvents.solvent_glass_transition("DMF")
    expected = rheology.vitrification_fraction("PS", low, 298.15, solution.solvent_density)
    assert solution.vitrification_fraction() == pytest.approx(expected, rel=1e-15)
    assert solution.vitrification_fraction(129.0) == pytest.approx(expected, abs=0.03)  # measured T_g of DMF
    two = Solution.build("PS", {"DMF": 0.5, "THF": 0.5}, mass_fraction=0.2, temperature=298.15).vitrification_fraction()
    one = Solution.build("PS", "THF", mass_fraction=0.2, temperature=298.15).vitrification_fraction()
    assert min(one, expected) < two < max(one, expected)
    with pytest.raises(InputError, match="makes dry PEO a melt"):
        Solution.build("PEO", "water", mass_fraction=0.05).vitrification_fraction()


def test_hfip_evaporates_with_library_properties() -> None:
    hfip = rheology.Volatile.build("HFIP", 298.15)
    assert hfip.molar_volume == pytest.approx(0.1680378 / 1596, rel=1e-6)
    assert hfip.saturation == pytest.approx(
        rheology.vapour_pressure("HFIP", 298.15) * 0.1680378 / (8.314463 * 298.15 * 1596), rel=1e-6
    )
    solution = Solution.build("PLA", "HFIP", mass_fraction=0.1, temperature=298.15, molar_mass=200.0)
    assert solution.require("solvent_viscosity") == pytest.approx(1.619e-3, rel=1e-14)
    assert solution.entanglement("good").entangled  # 3.5 strands of a melt's 3.8 kg/mol to a chain at phi = 0.124
    thin = Solution.build("PLA", "HFIP", mass_fraction=0.05, temperature=298.15, molar_mass=200.0)
    assert thin.entanglement("good").regime == "semidilute"  # 1.4


@pytest.mark.parametrize(
    "solvent",
    [{"water": 0.5, "DMF": 0.4}, {"water": 0.5, "DMF": np.nan}, {}, "water", {"water": 0.5, "Water": 0.5}, {1: 1.0}],
)
def test_a_solution_of_a_given_density_has_a_solvent_too(solvent) -> None:
    with pytest.raises(InputError, match=r"^solvent"):
        Solution(POLYMERS["PS"], solvent, 0.1, 293.15, 900.0)


def test_a_solution_needs_a_polymer_and_a_polymer_numbers() -> None:
    with pytest.raises(InputError, match=r"Solution\.build takes names"):
        Solution("PS", {"water": 1.0}, 0.1, 293.15, 900.0)
    for wrong in (
        {"density": -5.0},
        {"density": np.nan},
        {"glass_transition": 0.0},
        {"kuhn_length": -1e-9},
        {"backbone_bonds": -2},
        {"repeat_unit_molar_mass": "1"},
        {"name": 3},
    ):
        with pytest.raises(InputError, match=next(iter(wrong))):
            Polymer(**{"name": "X", "density": 1000.0, **wrong})


@pytest.mark.parametrize("text", ["1", ["1", "2"], np.array(["0.5"]), b"1", np.datetime64("2020-01-01")])
def test_text_is_not_a_number(text) -> None:
    with pytest.raises(InputError, match="not a real number"):
        rheology.modulus(text, 1.0)
