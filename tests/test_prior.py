"""Estimates of viscosity and relaxation time, intrinsic viscosities, other names."""

import importlib.util
import json
from dataclasses import replace
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spinline.base.errors import InputError
from spinline.recipe.believe import _OVERLAPS
from spinline.rheology import POLYMERS, SOLVENTS, Solution
from spinline.rheology.intrinsic import MARK_HOUWINK, intrinsic_viscosity, mixture_intrinsic_viscosity
from spinline.rheology.names import ALIASES, known_as
from spinline.rheology.prior import VISCOSITY_FACTOR, estimated_relaxation_time, estimated_viscosity, specific_viscosity
from spinline.rheology.solvents import volume_shares

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


def test_published_viscosities_are_within_the_band() -> None:
    spec = importlib.util.spec_from_file_location("published_viscosity", BENCHMARKS / "published_viscosity.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found = module.compare()
    assert found == json.loads((BENCHMARKS / "published_viscosity.json").read_text())
    ratios = np.array([row["viscosity_ratio"] for row in found["rows"]])
    assert len({row["polymer"] for row in found["rows"]}) >= 3
    inside = np.abs(np.log(ratios)) < np.log(VISCOSITY_FACTOR)
    assert inside.mean() >= 0.95  # two standard deviations
    assert np.exp(2 * np.sqrt(np.mean(np.log(ratios) ** 2))) < VISCOSITY_FACTOR


def test_recipes_are_entangled_where_published_solutions_are() -> None:
    found = json.loads((BENCHMARKS / "published_viscosity.json").read_text())["summary"]
    for name in ("PEO", "PVA", "PVP"):
        assert pytest.approx(found[name]["c_e [eta]"], rel=0.22) == _OVERLAPS
    assert pytest.approx(found["all"]["c_e [eta]"], rel=0.03) == _OVERLAPS


@pytest.mark.parametrize("quality", ["good", "theta"])
def test_martin_meets_the_power_law_with_its_slope(quality: str) -> None:
    k, power = {"good": (0.4, 3 / 0.764), "theta": (0.5, 14 / 3)}[quality]
    turn = (power - 1) / k
    x = turn * np.array([1 - 1e-6, 1.0, 1 + 1e-6])
    y = specific_viscosity(x, quality)
    slopes = np.diff(np.log(y)) / np.diff(np.log(x))
    np.testing.assert_allclose(slopes, power, rtol=1e-5)
    small = np.array([1e-8, 1e-4])
    np.testing.assert_allclose(specific_viscosity(small, quality), small + k * small**2, rtol=1e-8)
    assert specific_viscosity(0.0) == 0.0
    assert np.isfinite(specific_viscosity(1e6))


@settings(deadline=None, max_examples=50)
@given(st.floats(1.0, 1e4), st.floats(1e-4, 0.3))
def test_estimates_grow_with_chain_and_concentration(molar_mass: float, w: float) -> None:
    make = lambda m, c: Solution.build("PEO", "water", mass_fraction=c, molar_mass=m)  # noqa: E731
    here, longer, thicker = make(molar_mass, w), make(2 * molar_mass, w), make(molar_mass, 1.5 * w)
    for estimate in (estimated_viscosity, estimated_relaxation_time):
        value = estimate(here).value
        assert value > 0
        assert estimate(longer).value > value
        assert estimate(thicker).value >= value * (1 - 1e-12)
        low, high = estimate(here).band
        assert low < value < high
    assert estimated_viscosity(here).value > here.require("solvent_viscosity")


def test_zimm_time_of_a_dilute_solution() -> None:
    """PEO of 1000 kg/mol in water: [eta] M mu/(zeta(3 nu) R T), zeta by mpmath."""
    dilute = Solution.build("PEO", "water", mass_fraction=1e-5, molar_mass=1000.0, temperature=298.15)
    expected = 12.5e-6 * 1e6**0.78 * 1000.0 * dilute.require("solvent_viscosity") / (8.314462618 * 298.15)
    expected /= float(mpmath.zeta(3 * 0.588))
    assert estimated_relaxation_time(dilute).value == pytest.approx(expected, rel=1e-9)
    assert 1e-4 < expected < 1.2e-4


def test_intrinsic_viscosity_by_the_table_and_by_the_chain() -> None:
    assert intrinsic_viscosity("PAN", "dimethylformamide", 150.0).value == pytest.approx(
        24.3e-6 * 150e3**0.75, rel=1e-12
    )
    # DMF hardly swells PCL
    for name, solvent, mass, quality in (
        ("PS", "toluene", 100.0, "good"),
        ("PMMA", "chloroform", 200.0, "good"),
        ("PCL", "DMF", 80.0, "theta"),
    ):
        table = intrinsic_viscosity(name, solvent, mass)
        chain = intrinsic_viscosity(name, "nothing known", mass, quality)
        assert table.factor < chain.factor
        assert 1 / 2.5 < chain.value / table.value < 2.5
    with pytest.raises(InputError, match="molar_mass"):
        intrinsic_viscosity("PEO", "water", -1.0)
    with pytest.raises(InputError, match="solvent_quality"):
        intrinsic_viscosity("PEO", "water", 1.0, "poor")


def test_intrinsic_viscosities_are_foretold_from_the_other_rows(monkeypatch) -> None:
    """Each row of the table, left out of it: as far off as is said, and in the mean right."""
    off = []
    for (name, solvent), (k, a, _) in MARK_HOUWINK.items():
        rest = {pair: row for pair, row in MARK_HOUWINK.items() if pair != (name, solvent)}
        monkeypatch.setattr("spinline.rheology.intrinsic.MARK_HOUWINK", rest)
        foretold = intrinsic_viscosity(name, solvent, 100.0)
        off.append(np.log(k * 1e5**a * 1e-3 / foretold.value) / (0.5 * np.log(foretold.factor)))
    assert np.all(np.abs(off) < 2.0)
    assert abs(np.mean(off)) < 0.3
    assert np.std(off) == pytest.approx(1.0, abs=0.2)


def test_a_chain_is_swollen_where_it_is_longer_than_a_thermal_blob() -> None:
    unknown = {"solvent": "nothing known", "data": replace(POLYMERS["PEO"], name="another")}
    masses = np.geomspace(1.0, 1e4, 60)
    good = np.array([intrinsic_viscosity(molar_mass=m, **unknown).value for m in masses])
    theta = np.array([intrinsic_viscosity(molar_mass=m, solvent_quality="theta", **unknown).value for m in masses])
    slopes = np.diff(np.log(good)) / np.diff(np.log(masses))
    assert good[0] == theta[0]
    assert np.all(slopes > 0)
    assert slopes[0] == pytest.approx(0.5)
    assert slopes[-1] == pytest.approx(3 * 0.588 - 1)


def test_what_is_missing_is_named() -> None:
    with pytest.raises(InputError, match="molar_mass"):
        estimated_viscosity(Solution.build("PEO", "water", mass_fraction=0.05))
    for bad in (-1.0, np.nan, np.inf, 1e7, "x"):
        with pytest.raises(InputError, match="coil_overlap"):
            specific_viscosity(bad)
    mixed = Solution.build("PVP", {"ethanol": 0.8, "water": 0.2}, mass_fraction=0.05, molar_mass=1300.0)
    assert estimated_viscosity(mixed).factor > VISCOSITY_FACTOR


def test_a_mixture_lies_between_its_solvents_without_a_jump() -> None:
    def in_water(share: float) -> tuple[float, float]:
        shares = {name: part for name, part in (("water", share), ("methanol", 1 - share)) if part > 0}
        found = mixture_intrinsic_viscosity("PVP", shares, 360.0)
        return np.log(found.value), np.log(found.factor)

    (methanol, water), half = (in_water(0.0), in_water(1.0)), in_water(0.5)
    by_volume = volume_shares({"water": 0.5, "methanol": 0.5}, 298.15)
    assert by_volume["methanol"] == pytest.approx(997.0 / (997.0 + 786.6), rel=3e-3)
    assert half[0] == pytest.approx(by_volume["water"] * water[0] + by_volume["methanol"] * methanol[0])
    assert half[1] == pytest.approx(np.log(1.3))  # both tabulated
    for share in (0.0, 0.5, 1.0):
        near = [in_water(float(np.clip(share + step, 0.0, 1.0))) for step in (-1e-6, 1e-6)]
        assert near[0] == pytest.approx(near[1], abs=1e-5)
    alone = mixture_intrinsic_viscosity("PVP", {"water": 1.0}, 360.0)
    assert alone == intrinsic_viscosity("PVP", "water", 360.0)
    own = mixture_intrinsic_viscosity("PVP", {"water": 0.25, "a solvent of my own": 0.75}, 360.0)
    parts = [np.log(intrinsic_viscosity("PVP", name, 360.0).value) for name in ("water", "a solvent of my own")]
    assert np.log(own.value) == pytest.approx(0.25 * parts[0] + 0.75 * parts[1])
    assert "by mass" in own.source


@pytest.mark.parametrize(
    "shares",
    [
        *({}, {"DMF": 0.0}, {"DMF": np.nan, "water": 0.5}, {"DMF": np.inf, "water": 0.5}, {"DMF": -0.5, "water": 1.5}),
        *({"DMF": 5, "water": 5}, {"DMF": 1.0, "water": 0.0}, {"DMF": "x", "water": 1}, "DMF", None, {1: 1.0}),
    ],
)
def test_shares_that_no_mixture_has_are_refused(shares: object) -> None:
    """Nothing of no solvent had been 1 m3/kg, and a share that is no number had been left out."""
    for wrong in (lambda: mixture_intrinsic_viscosity("PAN", shares, 150.0), lambda: volume_shares(shares, 298.15)):  # type: ignore[arg-type]
        with pytest.raises(InputError, match="solvent"):
            wrong()


def test_extreme_mixtures_and_chains_are_right_or_refused() -> None:
    trace = mixture_intrinsic_viscosity("PVP", {"methanol": 1e-12, "water": 1 - 1e-12}, 360.0)
    assert trace.value == pytest.approx(intrinsic_viscosity("PVP", "water", 360.0).value)
    for wrong in (0.0, -1.0, np.nan, 1e4, "x"):
        with pytest.raises(InputError, match="temperature"):
            mixture_intrinsic_viscosity("PVP", {"methanol": 0.5, "water": 0.5}, 360.0, temperature=wrong)  # type: ignore[arg-type]
    for wrong in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="molar_mass"):
            mixture_intrinsic_viscosity("PVP", {"methanol": 0.5, "water": 0.5}, wrong)


def test_other_names() -> None:
    assert known_as("Polyacrylonitrile", POLYMERS) == "PAN"
    assert known_as("poly(ε-caprolactone)", POLYMERS) == "PCL"
    assert known_as("Nylon-6", POLYMERS) == "nylon 6"
    assert known_as("N,N-dimethylformamide", SOLVENTS) == "DMF"
    assert known_as("1,1,1,3,3,3-hexafluoro-2-propanol", SOLVENTS) == "HFIP"
    assert known_as("limonene", SOLVENTS) is None
    every = {**POLYMERS, **SOLVENTS}
    for alias, meant in ALIASES.items():
        assert meant in every
        assert known_as(alias, every) == meant
    a = Solution.build("polyethylene oxide", "H2O", mass_fraction=0.05)
    b = Solution.build("PEO", "water", mass_fraction=0.05)
    assert a == b
