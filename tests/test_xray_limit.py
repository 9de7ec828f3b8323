"""What the photons allow."""

import itertools

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError

PIXEL = 0.67e-6
WATER_10_KEV = xray.Absorber(
    float(xray.material("water").attenuation(10.0)), xray.usable_contrast("PEO", "water", 10.0)
)
ALL = ("radius", "axis", "amplitude", "slope")


def uniform(radius: float, fraction: float = 0.05) -> xray.RoundJet:
    return xray.RoundJet(np.array([fraction]), radius)


@pytest.mark.parametrize(("micrometres", "photons"), [(100, 7.4e4), (50, 5.6e5), (25, 4.4e6), (10, 6.8e7)])
def test_photons_needed(micrometres, photons) -> None:
    """The published table, computed with other attenuation tables (D = -1.369/cm against -1.374 here: 0.8 %)."""
    needed = xray.photons_needed(0.01, uniform(micrometres * 1e-6), WATER_10_KEV, PIXEL)
    assert needed == pytest.approx(photons, rel=0.02)


@pytest.mark.parametrize("nuisances", [(), ALL])
def test_bound_scales_as_the_root_of_the_photons(nuisances) -> None:
    bounds = [
        xray.error_limit(uniform(5e-5), WATER_10_KEV, xray.Detector(np.full(300, n), PIXEL), nuisances=nuisances).mean
        for n in (1.0, 1e4)
    ]
    assert bounds[0] == pytest.approx(100 * bounds[1], rel=1e-9)


def test_thin_limit_is_reached_at_the_first_order_of_attenuation() -> None:
    gaps = []
    for scale in (0.1, 0.05):
        thin = xray.Absorber(534.0 * scale, -137.0 * scale)
        found = xray.error_limit(uniform(5e-5), thin, xray.Detector(np.full(400, 1e6), PIXEL / 2)).mean
        gaps.append(found / float(xray.thin_mean_limit(5e-5, thin.contrast, 1e6, PIXEL / 2)) - 1)
    assert 0 < gaps[1] < gaps[0] < 0.01
    assert gaps[0] / gaps[1] == pytest.approx(2.0, rel=0.02)


def test_centre_chord_alone() -> None:
    """One pixel through the middle tells the chord's mean, ten times worse than the row at R = 50 um."""
    good = np.zeros(201, dtype=bool)
    good[100] = True
    thin = xray.Absorber(5.34, -1.37)
    found = xray.error_limit(uniform(5e-5), thin, xray.Detector(np.full(201, 1e6), PIXEL), good=good).mean
    assert found == pytest.approx(float(xray.thin_centre_limit(5e-5, -1.37, 1e6)), rel=1e-3)
    assert 9 < found / float(xray.thin_mean_limit(5e-5, -1.37, 1e6, PIXEL)) < 11


def test_shells_of_a_thin_jet_are_the_published_matrix() -> None:
    thin = xray.Absorber(5.34e-3, -1.37e-3)
    jet = xray.RoundJet(np.full(4, 0.05), 5e-5)
    detector = xray.Detector(np.full(300, 1e6), PIXEL)
    chords = xray.shell_chords(5e-5 * xray.equal_shells(4), detector.pixel_edges)
    fisher = thin.contrast**2 * chords.T @ np.diag(detector.flat) @ chords
    assert xray.error_limit(jet, thin, detector).covariance == pytest.approx(np.linalg.inv(fisher), rel=1e-5)


def test_every_unknown_and_every_lost_pixel_costs() -> None:
    detector = xray.Detector(np.full(300, 1e6), PIXEL, blur=1e-6)
    jet = xray.RoundJet(np.full(3, 0.05), 5e-5)
    names = (*ALL, "blur")
    bounds = [xray.error_limit(jet, WATER_10_KEV, detector, nuisances=names[:i]).mean for i in range(6)]
    assert all(a <= b * (1 + 1e-12) for a, b in itertools.pairwise(bounds))
    good = np.ones(300, dtype=bool)
    good[140:150] = False
    full = xray.error_limit(jet, WATER_10_KEV, detector, nuisances=names)
    less = xray.error_limit(jet, WATER_10_KEV, detector, nuisances=names, good=good)
    assert less.mean > full.mean
    assert np.all(less.fraction > full.fraction)
    assert list(full.nuisances) == list(names)


ROW = xray.Detector(np.full(300, 1e6), PIXEL)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: xray.error_limit(uniform(5e-5), xray.Absorber(534.0, 5.0), ROW), "under 1 %"),
        (lambda: xray.error_limit(uniform(5e-5), WATER_10_KEV, ROW, nuisances=("energy",)), "nuisances"),
        (lambda: xray.error_limit(uniform(5e-5), WATER_10_KEV, ROW, nuisances="axis"), "nuisances"),
        (lambda: xray.error_limit(uniform(5e-5), WATER_10_KEV, ROW, nuisances=("blur",)), "blur"),
        (lambda: xray.error_limit(uniform(5e-5), WATER_10_KEV, ROW, amplitude=0.0), "amplitude"),
        (lambda: xray.error_limit(uniform(5e-5), WATER_10_KEV, ROW, good=np.ones(3, dtype=bool)), "good"),
        (lambda: xray.error_limit(uniform(5e-5), WATER_10_KEV, ROW, good=np.zeros(300, dtype=bool)), "lit pixels"),
        (lambda: xray.error_limit(xray.RoundJet(np.array([0.1]), 5e-5, 1.0), WATER_10_KEV, ROW), "no trace"),
        (lambda: xray.error_limit(xray.RoundJet(np.full(150, 0.1), 5e-6), WATER_10_KEV, ROW), "tell apart"),
        (lambda: xray.thin_mean_limit(5e-5, 0.0, 1e6, PIXEL), "contrast"),
        (lambda: xray.photons_needed(0.0, uniform(5e-5), WATER_10_KEV, PIXEL), "sigma"),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call()
