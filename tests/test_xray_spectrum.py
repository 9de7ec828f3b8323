"""Refraction, spectra and media: known numbers, limits, and rows of a beam of many lines."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError
from spinline.xray.row.forward import row_model
from spinline.xray.row.spectral import SpectralRowModel

PIXEL = 0.67e-6
RADIUS = 50e-6


@pytest.fixture(scope="module")
def water() -> xray.Medium:
    return xray.solution_medium("PEO", "water", 10.0)


@pytest.mark.parametrize("energy", [8.0, 10.0, 20.0, 40.0])
def test_delta_of_water_is_that_of_free_electrons(energy) -> None:
    """10 electrons in 18.015 g/mol; bound ones add under 0.6 % over 8 keV."""
    wave = float(xray.wavelength(energy))
    electrons = 998.2 * 10 / 18.015e-3 * 6.02214076e23
    free = 2.8179403262e-15 * wave**2 * electrons / (2 * np.pi)
    assert float(xray.refraction_decrement("water", energy)) == pytest.approx(free, rel=6e-3)


def test_wavelength_is_hc_over_the_energy() -> None:
    assert float(xray.wavelength(10.0)) == pytest.approx(
        6.62607015e-34 * 299792458 / (1e4 * 1.602176634e-19), rel=1e-12
    )


def test_refraction_of_a_mixture_is_additive_and_its_contrast_that_of_electrons(water) -> None:
    half = {"ethanol": 0.5, "water": 0.5}
    parts = [xray.refraction_decrement(xray.Material(n, 500.0), 12.0) for n in ("ethanol", "water")]
    assert xray.refraction_decrement(xray.Material(half, 1000.0), 12.0) == pytest.approx(sum(parts), rel=1e-9)
    # electrons per volume: PEO 24 in 44.053 g/mol at 1.13, water 10 in 18.015 at 0.9982
    assert float(water.delta_contrast[0] / water.delta_solvent[0]) == pytest.approx(
        1.13 * 24 / 44.053 / (0.9982 * 10 / 18.015) - 1, rel=0.01
    )
    assert water.delta_air[0] == pytest.approx(1.1e-3 * water.delta_solvent[0], rel=0.05)


def test_a_medium_of_one_line_is_the_absorber(water) -> None:
    absorber = xray.solution_absorber("PEO", "water", 10.0)
    assert water.absorber.solvent == pytest.approx(absorber.solvent, rel=1e-12)
    assert water.absorber.contrast == pytest.approx(absorber.contrast, rel=1e-12)
    assert water.absorber.air == pytest.approx(absorber.air, rel=1e-12)
    other = water.with_absorber(xray.Absorber(500.0, -100.0))
    assert other.absorber == xray.Absorber(500.0, -100.0)
    assert other.delta_solvent == water.delta_solvent
    assert water.delta_over_mu() == pytest.approx(
        float(xray.delta_over_mu(water.delta_solvent - water.delta_air, water.solvent - water.air)[0])
    )


def test_spectra_are_shares_of_the_signal() -> None:
    lines = xray.harmonic_spectrum(10.0, {3: 0.05})
    assert lines.energy_kev == pytest.approx([10.0, 30.0])
    assert lines.weight == pytest.approx([0.95, 0.05])
    broad = xray.gaussian_spectrum(20.0, 2.0)
    assert broad.mean_kev == pytest.approx(20.0)
    assert np.sqrt(broad.weight @ (broad.energy_kev - 20.0) ** 2) == pytest.approx(2.0, rel=0.06)
    assert xray.Spectrum(np.array([10.0]), np.array([3.0])).excess_variance == 1.0
    two = xray.Spectrum(np.array([10.0, 30.0]), np.array([1.0, 1.0]))  # photons 3 : 1, of energy 1 and 3
    assert two.excess_variance == pytest.approx((0.75 * 1 + 0.25 * 9) / (0.75 + 0.75) ** 2)


def test_detector_and_filter_weigh_the_lines() -> None:
    two = xray.Spectrum(np.array([10.0, 30.0]), np.array([0.5, 0.5]))
    crystal = xray.Material("Lu3Al5O12", 6730.0)
    thick = two.seen_by(xray.scintillator_response(crystal, 1.0))  # stops everything: light in proportion to E
    assert thick.weight == pytest.approx([0.25, 0.75])
    counter = two.seen_by(xray.scintillator_response(crystal, 1.0, integrating=False))
    assert counter.weight == pytest.approx([0.5, 0.5])
    thin = two.seen_by(xray.scintillator_response(crystal, 20e-6))
    assert thin.weight[1] < 0.75
    hard = two.behind("water", 5e-3)
    mu = xray.Material("H2O", 998.2).attenuation(two.energy_kev)
    assert hard.weight[1] / hard.weight[0] == pytest.approx(np.exp(-5e-3 * (mu[1] - mu[0])), rel=1e-3)


@pytest.mark.parametrize("blur", [0.0, 1e-6])
def test_one_line_gives_the_counts_of_the_absorber(water, blur) -> None:
    detector = xray.Detector(np.full(200, 1e5), PIXEL, np.array(10.0), np.array(0.01), blur)
    jet = xray.RoundJet(np.array([0.02, 0.05, 0.1]), RADIUS, 2e-6)
    mono = xray.expected_counts(jet, water.absorber, detector, amplitude=1.02, slope=0.01)
    assert xray.spectral_counts(jet, water, detector, amplitude=1.02, slope=0.01) == pytest.approx(mono, rel=1e-12)


def test_derivatives_of_the_spectral_row() -> None:
    medium = xray.solution_medium("PEO", "water", xray.gaussian_spectrum(13.0, 1.7, lines=9))
    model = SpectralRowModel(xray.Detector(np.full(180, 1e6), PIXEL, blur=1e-6), xray.equal_shells(2), medium)
    at = np.array([0.03, 0.08, RADIUS, 2e-6, 1.01, 0.02, 1e-6])
    _, jacobian = model.evaluate(at)
    for i, step in enumerate([1e-4, 1e-4, 1e-10, 1e-10, 1e-4, 1e-4, 1e-9]):
        move = step * np.eye(at.size)[i]
        slope = (model.evaluate(at + move)[0] - model.evaluate(at - move)[0]) / (2 * step)
        assert np.abs(slope - jacobian[:, i]).max() < 2e-6 * np.abs(slope).max()


@pytest.mark.parametrize("share", [0.01, 0.05])
def test_a_harmonic_biases_as_the_thin_limit_says_and_not_where_modelled(water, share) -> None:
    """Left out: h (mu_1 - mu_3)/abs(D), in the thin limit. Modelled: nothing, at 1e7 photons."""
    medium = xray.solution_medium("PEO", "water", xray.harmonic_spectrum(10.0, {3: share}))
    detector = xray.Detector(np.full(224, 1e7), PIXEL)
    counts = xray.spectral_counts(xray.RoundJet(np.array([0.05]), RADIUS, 2e-6), medium, detector)
    ignored = xray.fit_row(counts, water.absorber, detector, shells=1).mean_fraction - 0.05
    mu = medium.solvent + 0.05 * medium.contrast
    assert ignored == pytest.approx(share * (mu[0] - mu[1]) / abs(medium.contrast[0]), rel=0.05)
    fit = xray.fit_row_spectrum(counts, medium, detector, shells=1)
    assert abs(fit.mean_fraction - 0.05) < 0.01 * fit.mean_fraction_std
    assert fit.warnings == ()
    noisy = xray.fit_row_spectrum(xray.noisy_counts(counts, 1), medium, detector)
    assert abs(noisy.mean_fraction - 0.05) < 4 * noisy.mean_fraction_std


def test_a_white_beam_needs_its_spectrum() -> None:
    """13 keV, 4 keV wide at half height: its mean attenuation hardens by 0.008, the attenuation at 13 keV is -0.4 off."""
    medium = xray.solution_medium("PEO", "water", xray.gaussian_spectrum(13.0, 4.0 / 2.3548))
    detector = xray.Detector(np.full(224, 1e7), PIXEL)
    counts = xray.spectral_counts(xray.RoundJet(np.array([0.05]), RADIUS), medium, detector)
    hardened = xray.fit_row(counts, medium.absorber, detector, shells=1).mean_fraction - 0.05
    assert 0.005 < hardened < 0.012
    line = xray.fit_row(counts, xray.solution_absorber("PEO", "water", 13.0), detector, shells=1).mean_fraction - 0.05
    assert -0.5 < line < -0.3
    assert xray.fit_row_spectrum(counts, medium, detector, shells=1).mean_fraction == pytest.approx(0.05, abs=1e-5)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: xray.Spectrum(np.array([10.0, 9.0]), np.ones(2)), "energy_kev.*rise"),
        (lambda: xray.Spectrum(np.array([10.0]), np.zeros(1)), "weight"),
        (lambda: xray.Spectrum(np.array([10.0]), np.ones(2)), "weight"),
        (lambda: xray.harmonic_spectrum(10.0, {1: 0.1}), "shares.*harmonic"),
        (lambda: xray.harmonic_spectrum(10.0, {2: 0.6, 3: 0.5}), "fundamental"),
        (lambda: xray.gaussian_spectrum(5.0, 4.0), "energy_kev"),
        (lambda: xray.gaussian_spectrum(15.0, 4.0, lines=2), "lines"),
        (lambda: xray.refraction_decrement("plastic", 10.0), "composition"),
        (lambda: xray.refraction_decrement("water", 0.1), "energy_kev"),
        (lambda: xray.delta_over_mu(1e-6, 0.0), "attenuation"),
        (
            lambda: xray.solution_medium("PEO", "water", xray.harmonic_spectrum(10.0, {3: 0.1})).with_absorber(
                xray.Absorber(1.0, 1.0)
            ),
            "lines",
        ),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call()


def test_row_model_of_the_absorber_is_untouched(water) -> None:
    detector = xray.Detector(np.full(100, 1e4), PIXEL)
    assert row_model(water.absorber, detector, xray.equal_shells(1)).names[-1] == "blur"
