"""The image of a round jet against brute force, and its derivatives against differences."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError
from spinline.xray.row.forward import row_model

WATER = xray.Absorber(solvent=534.0, contrast=-137.0, air=0.6)
PIXEL = 0.67e-6


def steps(values):
    values = np.asarray(values)
    return lambda r: values[np.minimum((r * len(values)).astype(int), len(values) - 1)]


@pytest.mark.parametrize("blur", [0.0, 0.3e-6, 0.67e-6, 1.2e-6])
def test_against_brute_force(phantom, blur) -> None:
    """The difference is far under the noise of 1e7 photons per pixel, 3e-4."""
    rng = np.random.default_rng(1)
    flat = 1e4 * (1 + 0.2 * rng.random(240))
    dark, veil, phi = 30 * rng.random(240), 0.01 * rng.random(240), [0.02, 0.05, 0.2]
    jet = xray.RoundJet(np.array(phi), 50e-6, axis=2.3 * PIXEL)
    detector = xray.Detector(flat, PIXEL, dark, veil, blur)
    counts = xray.expected_counts(jet, WATER, detector, amplitude=1.01, slope=-0.02)
    exact = phantom(
        steps(phi),
        50e-6,
        flat=flat,
        pixel=PIXEL,
        solvent=534.0,
        contrast=-137.0,
        air=0.6,
        axis=2.3 * PIXEL,
        dark=dark,
        veil=veil,
        blur=blur,
        amplitude=1.01,
        slope=-0.02,
    )
    assert np.abs(counts / exact - 1).max() < 2e-5


@pytest.mark.parametrize("blur", [0.0, 1.2e-6])
def test_strong_absorber_against_brute_force(phantom, blur) -> None:
    """PCL in dichloromethane at 10 keV: a third of the beam is left, and the edge is steep."""
    detector = xray.Detector(np.full(450, 1e6), PIXEL, blur=blur)
    counts = xray.expected_counts(xray.RoundJet(np.array([0.1]), 1e-4, 2e-6), xray.Absorber(6400.0, -6030.0), detector)
    exact = phantom(
        steps([0.1]),
        1e-4,
        flat=detector.flat,
        pixel=PIXEL,
        solvent=6400.0,
        contrast=-6030.0,
        axis=2e-6,
        blur=blur,
        parts=64,
    )
    assert counts.min() < 0.4e6
    assert np.abs(counts / exact - 1).max() < 5e-5


def test_no_jet_no_absorption() -> None:
    jet = xray.RoundJet(np.array([0.05]), 10e-6, axis=1.0)
    detector = xray.Detector(np.full(50, 7.0), PIXEL, np.array(2.0), blur=1e-6)
    assert xray.expected_counts(jet, WATER, detector) == pytest.approx(np.full(50, 9.0), rel=1e-14)


def test_thin_jet_is_linear_in_the_area() -> None:
    """What is missing from the flat is mu times the area, at the first order of mu."""
    jet = xray.RoundJet(np.array([0.1, 0.3]), 30e-6, axis=0.2e-6)
    lost = []
    for scale in (1e-2, 5e-3):
        absorber = xray.Absorber(534.0 * scale, -137.0 * scale)
        counts = xray.expected_counts(jet, absorber, xray.Detector(np.ones(200), PIXEL, blur=1e-6))
        exact = np.pi * 30e-6**2 * (534.0 - 137.0 * jet.mean_fraction) * scale
        lost.append((exact - (1 - counts).sum() * PIXEL) / exact)
    assert lost[0] / lost[1] == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("blur", [0.0, 0.4e-6, 1.5e-6])
def test_derivatives(blur) -> None:
    model = row_model(
        WATER, xray.Detector(np.full(150, 100.0), PIXEL, np.array(3.0), np.array(0.1), blur), xray.equal_shells(3), 3e-6
    )
    at = np.array([0.05, 0.1, 0.3, 30.1e-6, 1.3e-6, 1.02, 0.01, blur])
    steps = np.array([1e-3, 1e-3, 1e-3, 1e-10, 1e-10, 1e-5, 1e-5, 1e-10 if blur else 0.0])
    _, jacobian = model.evaluate(at)
    for i, step in enumerate(steps):
        if step:
            e = step * np.eye(8)[i]
            slope = (model.evaluate(at + e)[0] - model.evaluate(at - e)[0]) / (2 * step)
            assert np.abs(jacobian[:, i] - slope).max() < 1e-5 * np.abs(slope).max(), model.names[i]


def test_noise_follows_from_seed_and_index() -> None:
    mean = np.full(20000, 5.0)
    a, b, c = xray.noisy_counts(mean, 3, 1), xray.noisy_counts(mean, 3, 1), xray.noisy_counts(mean, 3, 2)
    assert np.array_equal(a, b)
    assert not np.array_equal(a, c)
    assert a.mean() == pytest.approx(5.0, abs=4 * np.sqrt(5 / 20000))
    assert a.var() == pytest.approx(5.0, rel=0.05)


ROW = np.ones(10)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: xray.Absorber(0.0, 1.0), "solvent"),
        (lambda: xray.Absorber(1.0, np.inf), "contrast"),
        (lambda: xray.Absorber(1.0, 1.0, -1.0), "air"),
        (lambda: xray.Detector(None, PIXEL), "flat.*missing"),
        (lambda: xray.Detector(0 * ROW, PIXEL), "flat"),
        (lambda: xray.Detector(ROW[:2], PIXEL), "flat"),
        (lambda: xray.Detector(ROW, 0.0), "pixel"),
        (lambda: xray.Detector(ROW, PIXEL, ROW[:3]), "dark"),
        (lambda: xray.Detector(ROW, PIXEL, -ROW), "dark"),
        (lambda: xray.Detector(ROW, PIXEL, ROW, -ROW), "veil"),
        (lambda: xray.Detector(ROW, PIXEL, blur=1.0), "blur"),
        (lambda: xray.RoundJet(np.array([np.nan]), 1e-5), "fraction"),
        (lambda: xray.RoundJet(np.array([0.1]), -1e-5), "radius"),
        (lambda: xray.RoundJet(np.array([0.1]), 1e-5, np.array([0.0, 1.0])), "axis"),
        (lambda: xray.RoundJet(np.array([0.1]), 1e-5, 0.0, np.array([0.0, 0.5, 1.0])), "edges"),
        (lambda: xray.expected_counts(xray.RoundJet(ROW, 1e-5), WATER, xray.Detector(ROW, PIXEL), slope=1.0), "slope"),
        (lambda: xray.noisy_counts(-ROW, 1), "expected"),
        (lambda: xray.noisy_counts(ROW, -1), "seed"),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call()
