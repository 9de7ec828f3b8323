"""Solutions: conversions, built-in materials, refusals."""

import numpy as np
import pytest
from chemicals.elements import molecular_weight, simple_formula_parser
from hypothesis import given
from hypothesis import strategies as st

from spinline import rheology
from spinline.errors import InputError
from spinline.rheology import POLYMERS, SOLVENTS, Polymer, Solution


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


@pytest.mark.parametrize("name", POLYMERS)
def test_molar_mass_of_the_repeat_unit_is_that_of_its_formula(name: str) -> None:
    data = POLYMERS[name]
    expected = molecular_weight(simple_formula_parser(data.repeat_unit)) * 1e-3
    assert data.repeat_unit_molar_mass == pytest.approx(expected, rel=1e-6)
    assert "(1999)" in data.source


# CRC Handbook of Chemistry and Physics, 97th ed., liquids at 25 degC: g/cm3 and mPa s
@pytest.mark.parametrize(
    ("name", "density", "viscosity"),
    [
        ("water", 0.9970, 0.890), ("ethanol", 0.785, 1.074), ("acetone", 0.7845, 0.306), ("DMF", 0.9445, 0.794), ("DCM", 1.3168, 0.413),
        ("chloroform", 1.4788, 0.537), ("THF", 0.8833, 0.456), ("formic acid", 1.2137, 1.607),
    ],
)  # fmt: skip
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
        ({"polymer_data": "PE0"}, "did you mean 'PEO'"), ({"polymer_data": "kevlar"}, "not built in"), ({"solvent": "watr"}, "did you mean 'water'"),
        ({"mass_fraction": 0.0}, "mass_fraction"), ({"mass_fraction": 1.0}, "mass_fraction"), ({"mass_fraction": np.nan}, "mass_fraction"),
        ({"mass_fraction": None}, "one of"), ({"volume_fraction": 0.1}, "one of"), ({"temperature": -3.0}, "temperature"),
        ({"temperature": 900.0}, "liquid range"), ({"solvent": {"ethanol": 0.5, "water": 0.4}}, "sum to 1"), ({"solvent": {"water": 1.5}}, "solvent"),
        ({"solvent": {}}, "sum to 1"), ({"kuhn_length": 0.0}, "kuhn_length"), ({"molar_mass": -1.0}, "molar_mass"), ({"solvent_density": np.inf}, "solvent_density"),
    ],
)  # fmt: skip
def test_refusals(change: dict, words: str) -> None:
    arguments = {"polymer_data": "PEO", "solvent": "water", "mass_fraction": 0.05}
    with pytest.raises(InputError, match=words):
        Solution.build(**(arguments | change))


# plateau moduli (MPa) and melt densities (kg/m3) at 413 K, Fetters et al. (1994)
@pytest.mark.parametrize(("name", "plateau", "density"), [("PEO", 1.80, 1064), ("PS", 0.20, 969), ("PMMA", 0.31, 1130)])
def test_entanglement_molar_mass_follows_from_the_plateau_modulus(name: str, plateau: float, density: float) -> None:
    expected = 0.8 * density * 8.314462618 * 413 / (plateau * 1e6)
    assert rheology.polymer_property(name, "entanglement_molar_mass") == pytest.approx(expected, rel=2e-3)
    assert 0.5e-9 < rheology.polymer_property(name, "kuhn_length") < 2e-9


@pytest.mark.parametrize("name", ["PAN", "PS", "PVA", "PLA"])
def test_added_polymers_make_solutions(name: str) -> None:
    solution = Solution.build(name, "DMF", mass_fraction=0.1, molar_mass=100.0)
    assert 0.05 < solution.volume_fraction < 0.1
    assert solution.segments_per_chain > 100
    assert np.isfinite(rheology.polymer_property(name, "glass_transition"))


def test_missing_properties_are_named() -> None:
    with pytest.raises(InputError, match=r"kuhn_length of PVP: is not built in; give it \(m\)"):
        rheology.polymer_property("PVP", "kuhn_length")
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
    with pytest.raises(InputError, match="leaves dry PEO no glass"):
        rheology.vitrification_fraction("PEO", 136.0, 298.15, 997.0)
    with pytest.raises(InputError, match="glass_transition of PVP"):
        rheology.vitrification_fraction("PVP", 136.0, 298.15, 997.0)
