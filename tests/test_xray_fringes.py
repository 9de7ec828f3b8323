"""Fringes are seen where there are some, and not where there are none."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError

PIXEL = 0.67e-6
WATER = xray.solution_medium("PEO", "water", 10.0)
JET = xray.RoundJet(np.array([0.05]), 50e-6, 2e-6)


def row(distance, photons, blur=0.0, jet=JET, pixels=224):
    detector = xray.Detector(np.full(pixels, float(photons)), PIXEL, blur=blur)
    return xray.fresnel_counts(jet, WATER, detector, distance, amplitude=1.01, slope=0.005), detector


@pytest.mark.parametrize("distance", [0.01, 0.1, 0.2])
@pytest.mark.parametrize(("photons", "blur"), [(1e3, 0.0), (1e4, 1.2e-6), (1e6, 1.2e-6)])
def test_fringes_are_detected(distance, photons, blur) -> None:
    mean, detector = row(distance, photons, blur)
    found = xray.detect_fringes(xray.noisy_counts(mean, 1), WATER, detector, estimate=False)
    assert found.detected
    assert found.significance > 10
    assert "phase" in found.message
    assert np.isnan(found.distance)


@pytest.mark.parametrize("distance", [0.01, 0.1, 0.2])
def test_their_distance_is_estimated(distance) -> None:
    mean, detector = row(distance, 1e5, 0.5e-6)
    found = xray.detect_fringes(xray.noisy_counts(mean, 2), WATER, detector)
    assert abs(found.distance - distance) < max(4 * found.distance_std, 0.02 * distance)
    assert f"{100 * found.distance:.2g} cm" in found.message


@pytest.mark.slow
@pytest.mark.parametrize("blur", [0.0, 1.2e-6])
def test_rows_without_fringes_give_no_alarm(blur) -> None:
    """60 rows; the benchmark has 2,000. The significance scatters about the largest of a few normal numbers."""
    mean, detector = row(0.0, 1e5, blur)
    found = [xray.detect_fringes(xray.noisy_counts(mean, 4, i), WATER, detector) for i in range(60)]
    assert not any(f.detected for f in found)
    assert max(f.significance for f in found) < 4.5
    assert -0.5 < np.mean([f.significance for f in found]) < 1.5
    assert found[0].message == ""


def test_a_blur_left_out_is_not_taken_for_fringes() -> None:
    mean, _ = row(0.0, 1e6, 1.2e-6)
    sharp = xray.Detector(np.full(224, 1e6), PIXEL)
    assert not xray.detect_fringes(xray.noisy_counts(mean, 1), WATER, sharp).detected


def test_blocks_and_a_fit_made_before() -> None:
    mean, detector = row(0.01, 300.0, 1.2e-6)
    rows = np.array([xray.noisy_counts(mean, 3, i) for i in range(100)])
    assert xray.detect_fringes(rows, WATER, detector, estimate=False).detected
    plain, sharp = row(0.0, 1e5)
    counts = xray.noisy_counts(plain, 3)
    fit = xray.fit_row(counts, WATER.absorber, sharp, shells=3)
    assert not xray.detect_fringes(counts, WATER, sharp, fit=fit).detected


def test_refusals() -> None:
    mean, detector = row(0.0, 1e4)
    with pytest.raises(InputError, match="threshold"):
        xray.detect_fringes(mean, WATER, detector, threshold=0.0)
    with pytest.raises(InputError, match="counts"):
        xray.detect_fringes(mean[:50], WATER, detector)


EDGES = np.linspace(0, 1, 61)
MIDDLE = 0.5 * (EDGES[1:] + EDGES[:-1])


@pytest.mark.parametrize(
    "fraction", [0.09 - 0.08 * MIDDLE**2, 0.03 + 0.14 * MIDDLE**12, 0.01 + 0.3 * np.exp(-6 * MIDDLE**2)]
)
@pytest.mark.parametrize("said", [0.0, 0.8e-6, 1.6e-6])
def test_neither_a_profile_nor_a_wrong_blur_is_taken_for_fringes(fraction, said) -> None:
    """One shell is fitted to a parabola, a skin and a core, at 1e9 photons, of a blur of 0.8 um left out, known and doubled."""
    jet = xray.RoundJet(fraction, 50e-6, 2e-6, EDGES)
    mean = xray.expected_counts(jet, WATER.absorber, xray.Detector(np.full(224, 1e9), PIXEL, blur=0.8e-6), slope=0.005)
    detector = xray.Detector(np.full(224, 1e9), PIXEL, blur=said)
    assert xray.detect_fringes(xray.noisy_counts(mean, 1), WATER, detector, estimate=False).significance < 5


def frame_of(mean, rows, photons, seed=1, blur=0.0):
    counts = np.random.default_rng(seed).poisson(mean, (rows, mean.size)).astype(float)
    flat = np.full(counts.shape, float(photons))
    return xray.Frame(counts, flat, 0 * flat, np.ones(flat.shape, bool), PIXEL, blur)


def test_a_frame_shows_what_its_rows_do_not() -> None:
    """100 photons a pixel, blur 1.2 um, 1 cm: 2 standard deviations a row, over 8 in 48 of them; the air tells without a model."""
    mean, detector = row(0.01, 100.0, 1.2e-6)
    frame = frame_of(mean, 48, 100.0, blur=1.2e-6)
    alone = [xray.detect_fringes(c, WATER, detector, estimate=False).significance for c in frame.counts[:6]]
    assert np.median(alone) < 4
    together = xray.frame_fringes(frame, WATER)
    assert together.detected
    assert together.significance > 2 * np.median(alone)
    assert "method" in together.message
    plain, _ = row(0.0, 100.0, 1.2e-6)
    assert xray.frame_fringes(frame_of(plain, 48, 100.0, blur=1.2e-6), WATER).significance < 5


@pytest.mark.parametrize("distance", [0.0, 0.01, 0.1, 0.2])
@pytest.mark.parametrize("blur", [0.0, 1.2e-6])
def test_chords_alone_flag_fringes(distance, blur) -> None:
    """Without medium or distance: `chord_frame` is told no more than the attenuation, and sees light over the beam."""
    mean, _ = row(distance, 1e5, blur)
    frame = frame_of(mean, 8, 1e5)
    bit = 1 << list(xray.FRAME_FLAGS).index("fringes")
    if distance > 0.0 and (distance == 0.01 or blur > 0.0):
        with pytest.raises(InputError, match="no jet"):  # of a uniform absorber
            xray.chord_frame(frame, WATER.absorber)
    else:
        flags = xray.chord_frame(frame, WATER.absorber).flags
        assert ((flags & bit) > 0).all() == (distance > 0.0)


def test_fringes_of_a_beam_of_many_energies_are_seen() -> None:
    beam = xray.solution_medium("PEO", "water", xray.Spectrum(np.array([11.0, 12.0, 13.0]), np.array([0.3, 0.4, 0.3])))
    detector = xray.Detector(np.full(224, 1e4), PIXEL, blur=1.2e-6)
    mean = xray.fresnel_counts(JET, beam, detector, 0.1)
    assert xray.detect_fringes(xray.noisy_counts(mean, 1), beam, detector, estimate=False).significance > 20
    plain = xray.fresnel_counts(JET, beam, detector, 0.0)
    assert xray.detect_fringes(xray.noisy_counts(plain, 1), beam, detector, estimate=False).significance < 5
