"""Attenuation and contrast against photon energy."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError
from spinline.rheology import materials

# 1/cm, total attenuation: an independent evaluation from other tables (xraydb), 5, 10, 20, 40 keV
MIXED = xray.Material({"ethanol": 0.5, "water": 0.5}, 914.0)
TABLE = [
    (("PEO", "water"), (-10.98, -1.369, -0.142, 0.002)),
    (("PMMA", "acetone"), (11.96, 1.49, 0.24, 0.092)),
    (("PCL", "DCM"), (-406.0, -60.2, -8.0, -1.0)),
    (("PVP", MIXED), (-3.70, -0.47, -0.012, 0.041)),
]
KEV = np.array([5.0, 10.0, 20.0, 40.0])


@pytest.mark.parametrize(("pair", "printed"), TABLE, ids=[pair[0] for pair, _ in TABLE])
def test_contrast_against_the_table(pair, printed) -> None:
    contrast = xray.attenuation_contrast(*pair, KEV) * 1e-2
    printed = np.array(printed)
    half_digit = np.where(np.abs(printed) < 0.1, 5e-4, np.where(np.abs(printed) < 1, 5e-3, 0.0))
    assert np.all(np.abs(contrast - printed) <= 0.02 * np.abs(printed) + half_digit)


def test_contrast_changes_sign() -> None:
    assert xray.zero_contrast_energies("PEO", "water") == pytest.approx([38.5], abs=0.2)
    assert xray.zero_contrast_energies("PVP", MIXED) == pytest.approx([21.4], abs=0.1)
    assert xray.zero_contrast_energies("PCL", "DCM").size == 0


def test_water_with_and_without_coherent_scatter() -> None:
    """8 keV: 1.003 /mm and 1.034 /mm, the values of the spray data set."""
    water = xray.material("water")
    assert float(water.attenuation(8.0)) * 1e-3 == pytest.approx(1.034, rel=0.01)
    assert float(water.attenuation(8.0, coherent=False)) * 1e-3 == pytest.approx(1.003, rel=0.01)


def test_formula_name_and_mixture_agree() -> None:
    assert xray.mass_attenuation("PEO", KEV) == pytest.approx(xray.mass_attenuation("C2H4O", KEV), rel=0)
    whole = xray.mass_attenuation({"h2O".upper(): 0.3, "Water": 0.7}, KEV)
    assert whole == pytest.approx(xray.mass_attenuation("H2O", KEV), rel=1e-14)
    assert xray.material("C2H4O", 1130.0).attenuation(10.0) == xray.material(materials.polymer("PEO")).attenuation(10.0)


def test_solvent_formulas_are_those_of_the_solvents() -> None:
    from chemicals.elements import molecular_weight, nested_formula_parser
    from chemicals.identifiers import MW

    assert set(xray.SOLVENT_FORMULAS) == set(materials.SOLVENTS)
    for name, formula in xray.SOLVENT_FORMULAS.items():
        assert molecular_weight(nested_formula_parser(formula)) == pytest.approx(
            MW(materials.SOLVENTS[name][0]), rel=1e-4
        )


def test_mixture_density_is_of_additive_volumes() -> None:
    mixture = xray.material({"ethanol": 0.5, "water": 0.5})
    water, ethanol = (materials.solvent_density(n, 293.15) for n in ("water", "ethanol"))
    assert mixture.density == pytest.approx(2 / (1 / water + 1 / ethanol), rel=1e-14)


def test_near_zero_contrast_is_refused_with_an_energy_that_works() -> None:
    with pytest.raises(InputError, match="absorb alike") as caught:
        xray.usable_contrast("PEO", "water", 38.5)
    works = float(caught.value.remedy.split()[1])
    contrast = xray.usable_contrast("PEO", "water", works)
    assert abs(contrast) > 0.045 * float(xray.material("water").attenuation(works))
    assert xray.usable_contrast("PEO", "water", 10.0) == pytest.approx(-137.4, abs=1.0)


@pytest.mark.parametrize("radius", [1e-4, 1e-3])
def test_best_energy_is_the_least_error(radius) -> None:
    best = xray.best_energy("PEO", "water", radius, 1e5, pixel=0.67e-6)
    water = xray.material("water")

    def error(kev: float) -> float:
        x = np.linspace(-radius, radius, 20001)
        chord = 2 * np.sqrt(np.maximum(radius**2 - x**2, 0))
        d = float(xray.attenuation_contrast("PEO", "water", kev))
        mu = float(water.attenuation(kev)) + 0.05 * d
        return float(d**2 * 1e5 / 0.67e-6 * (chord**2 * np.exp(-mu * chord)).sum() * (x[1] - x[0])) ** -0.5

    assert best.sigma == pytest.approx(error(best.energy_kev), rel=1e-4)
    assert all(best.sigma <= error(kev) * 1.0001 for kev in (3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 30.0))


def test_a_thicker_jet_wants_a_harder_beam_and_photons_do_not_matter() -> None:
    kev = [xray.best_energy("PEO", "water", r, 1e5, pixel=1e-6).energy_kev for r in (5e-5, 2e-4, 1e-3)]
    assert kev == sorted(kev)
    assert kev[0] < kev[-1]
    few, many = (xray.best_energy("PEO", "water", 2e-4, n, pixel=1e-6) for n in (1e3, 1e5))
    assert few.energy_kev == many.energy_kev
    assert few.sigma == pytest.approx(10 * many.sigma, rel=1e-12)


def test_absorber_of_a_solution_in_air() -> None:
    """Left out, the displaced air is worth +0.0045 in the fraction at 10 keV."""
    found = xray.solution_absorber("PEO", "water", 10.0)
    assert found.solvent == float(xray.material("water").attenuation(10.0))
    assert found.contrast == xray.usable_contrast("PEO", "water", 10.0)
    assert found.air / -found.contrast == pytest.approx(0.0045, abs=1e-4)
    half = xray.solution_absorber("PEO", "water", 10.0, pressure=101325.0 / 2)
    assert half.air == pytest.approx(found.air / 2, rel=1e-14)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: xray.mass_attenuation("Xy3", 10.0), "formula"),
        (lambda: xray.mass_attenuation("", 10.0), "formula"),
        (lambda: xray.mass_attenuation({}, 10.0), "mass fractions"),
        (lambda: xray.mass_attenuation({"H2O": 0.5}, 10.0), "sum to 1"),
        (lambda: xray.mass_attenuation({"H2O": -0.5, "C2H6O": 1.5}, 10.0), "range"),
        (lambda: xray.mass_attenuation("H2O", 0.5), "keV"),
        (lambda: xray.mass_attenuation("H2O", np.nan), "finite"),
        (lambda: xray.material("C3H3N"), "density"),
        (lambda: xray.Material("H2O", 0.0), "density"),
        (lambda: xray.best_energy("PEO", "water", -1.0, 1e5, pixel=1e-6), "radius"),
        (lambda: xray.best_energy("PEO", "water", 1e-4, 1e5, pixel=1e-6, low_kev=38.4, high_kev=38.6), "alike"),
        (lambda: xray.best_energy("PEO", "water", 10.0, 1e5, pixel=1e-6), "photon"),
        (lambda: xray.solution_absorber("PEO", "water", 38.6), "alike"),
        (lambda: xray.solution_absorber("PEO", "water", 10.0, pressure=0.0), "pressure"),
        (lambda: xray.usable_contrast("PEO", "water", [10.0, 20.0]), "single"),
        (lambda: xray.zero_contrast_energies("PEO", "water", 20.0, 10.0), "high_kev"),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call()
