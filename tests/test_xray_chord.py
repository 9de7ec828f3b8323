"""The quick look along chords, and its price."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError

PIXEL = 0.67e-6
SOLUTION = xray.Absorber(531.9, -137.44, 0.6)


def row(fraction, photons, blur=0.0):
    jet = xray.RoundJet(np.array(fraction), 50e-6, 0.2e-6)
    detector = xray.Detector(np.full(224, float(photons)), PIXEL, np.array(0.1 * photons), np.array(0.01), blur)
    return xray.expected_counts(jet, SOLUTION, detector, amplitude=1.02, slope=0.01), detector


KNOWN = {"radius": 50e-6, "axis": 0.2e-6, "amplitude": 1.02, "slope": 0.01}


@pytest.mark.parametrize("reference", [0.0, 0.05, 0.9])
def test_uniform_jet_is_read_exactly_on_every_chord(reference) -> None:
    counts, detector = row([0.05], 1e6)
    found = xray.chord_fractions(counts, SOLUTION, detector, reference=reference, **KNOWN)
    assert found.fraction == pytest.approx(np.full(found.fraction.size, 0.05), abs=1e-10)
    assert found.warnings == ()


def test_it_is_a_mean_along_the_chord_and_not_the_core() -> None:
    phi = np.array([0.2, 0.1, 0.05])
    counts, detector = row(phi, 1e6)
    found = xray.chord_fractions(counts, SOLUTION, detector, **KNOWN)
    assert found.centre == pytest.approx(phi.mean(), abs=1e-4)
    assert found.centre < phi[0] - 0.08


def test_price_and_error_at_50_micrometres() -> None:
    """Ten times the bound of the whole row; the error is the scatter of 500 replicates."""
    counts, detector = row([0.05], 1e5)
    found = xray.chord_fractions(counts, SOLUTION, detector, **KNOWN)
    assert 9 < found.price < 12
    scatter = [
        xray.chord_fractions(xray.noisy_counts(counts, 1, i), SOLUTION, detector, **KNOWN).centre for i in range(500)
    ]
    assert np.std(scatter) == pytest.approx(found.centre_std, rel=0.1)


def test_bias_of_the_logarithm() -> None:
    counts, detector = row([0.05], 100)
    draws = np.array(
        [
            xray.chord_fractions(xray.noisy_counts(counts, 2, i), SOLUTION, detector, **KNOWN).fraction[60:90]
            for i in range(400)
        ]
    )
    expected = xray.chord_fractions(counts, SOLUTION, detector, **KNOWN).log_bias[60:90].mean()
    assert -0.6 < expected < -0.3
    assert draws.mean() - 0.05 == pytest.approx(expected, abs=3 * draws.std() / np.sqrt(draws.size))


def test_no_counts_are_marked() -> None:
    counts, detector = row([0.05], 1e4)
    counts[90] = 0.0
    found = xray.chord_fractions(counts, SOLUTION, detector, **KNOWN)
    assert np.isnan(found.fraction).sum() == np.isnan(found.std).sum() == 1
    assert any("no count" in w for w in found.warnings)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda counts, detector: xray.chord_fractions(counts, xray.Absorber(531.9, 1.0), detector, 50e-6), "1 %"),
        (lambda counts, detector: xray.chord_fractions(counts[:9], SOLUTION, detector, 50e-6), "counts"),
        (lambda counts, detector: xray.chord_fractions(-counts, SOLUTION, detector, 50e-6), "counts"),
        (lambda counts, detector: xray.chord_fractions(0 * counts, SOLUTION, detector, 50e-6), "centre chord"),
        (lambda counts, detector: xray.chord_fractions(counts, SOLUTION, detector, 5e-7), "radius"),
        (lambda counts, detector: xray.chord_fractions(counts, SOLUTION, detector, 50e-6, 1.0), "radius"),
        (lambda counts, detector: xray.chord_fractions(counts, SOLUTION, detector, 50e-6, reference=2.0), "reference"),
        (lambda counts, detector: xray.chord_fractions(counts, SOLUTION, detector, 50e-6, amplitude=0.0), "amplitude"),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call(*row([0.05], 1e4))
