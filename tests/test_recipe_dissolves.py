"""Polymers that their solvent does not dissolve, air's water that sets them, gelatin that is a gel: said, and only then."""

from dataclasses import replace

import pytest
from pan_recipe import PAN

from spinline.recipe.outside import outside_remarks


def said(polymer, solvent, **changes):
    return " ".join(outside_remarks(replace(PAN, polymer=polymer, solvent=solvent, **changes)))


@pytest.mark.parametrize(
    ("polymer", "solvent"),
    [
        ("PAN", {"water": 1.0}),
        ("PCL", {"water": 1.0}),
        ("nylon 6", {"water": 0.6, "formic acid": 0.4}),
        ("PLA", {"ethanol": 0.5, "water": 0.5}),
        ("PVP", {"toluene": 1.0}),
        ("PCL", {"methanol": 0.6, "DMF": 0.4}),
        ("PVP", {"ethyl acetate": 1.0}),
    ],
)
def test_a_polymer_that_does_not_dissolve_is_said(polymer, solvent):
    """They had been smooth fibres without a word."""
    assert f"{polymer} does not dissolve in" in said(polymer, solvent)


@pytest.mark.parametrize(
    ("polymer", "solvent"),
    [
        ("PEO", {"water": 1.0}),
        ("PVA", {"water": 0.9, "ethanol": 0.1}),
        ("nylon 6", {"formic acid": 0.8, "water": 0.2}),
        ("cellulose acetate", {"acetone": 0.85, "water": 0.15}),
        ("PVDF", {"DMF": 0.5, "acetone": 0.5}),
        ("PVB", {"ethanol": 1.0}),
        ("PCL", {"chloroform": 0.75, "methanol": 0.25}),
        ("PVP", {"methanol": 1.0}),
        ("PS", {"MEK": 1.0}),
        ("gelatin", {"TFE": 1.0}),
    ],
)
def test_of_usual_solutions_nothing_is_said(polymer, solvent):
    assert said(polymer, solvent, relative_humidity=0.4, temperature=308.0) == ""


def test_of_a_chain_of_ones_own_it_is_only_said_that_it_is_not_in_the_library():
    words = said("a chain of one's own", {"water": 1.0})
    assert words == "a chain of one's own is not in the library: a usual chain is taken, within wide spreads"


@pytest.mark.parametrize(
    ("polymer", "solvent", "humidity", "wet"),
    [
        ("PAN", {"DMF": 1.0}, 0.95, True),
        ("PVDF", {"DMF": 0.4, "acetone": 0.6}, 0.6, True),
        ("PAN", {"DMF": 1.0}, 0.5, False),
        ("PAN", {"DMF": 1.0}, float("nan"), False),
        ("PVP", {"DMF": 1.0}, 0.95, False),  # water dissolves it
        ("PCL", {"chloroform": 1.0}, 0.95, False),  # takes no water up
    ],
)
def test_damp_air_that_sets_a_polymer_is_said(polymer, solvent, humidity, wet):
    assert ("sets" in said(polymer, solvent, relative_humidity=humidity)) == wet


@pytest.mark.parametrize(("kelvin", "gel"), [(float("nan"), True), (293.0, True), (313.0, False)])
def test_gelatin_in_cold_water_is_a_gel(kelvin, gel):
    assert ("is a gel" in said("gelatin", {"water": 1.0}, temperature=kelvin)) == gel
    assert "is a gel" not in said("gelatin", {"acetic acid": 1.0}, temperature=kelvin)
