"""Fringes are seen where there are some, and not where there are none."""

import numpy as np
import pytest

from spinline import xray
from spinline.errors import InputError

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
