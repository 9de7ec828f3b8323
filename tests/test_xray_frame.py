"""Frames: the track of the jet, blocks by likelihood, chords all at once, and the edges of a nozzle."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError

PIXEL = 0.67e-6
SOLUTION = xray.Absorber(531.9, -137.44, 0.6)
PHI = np.array([0.03, 0.05, 0.08])
MEAN = float(xray.shell_weights(xray.equal_shells(3)) @ PHI)


def steps(values):
    values = np.asarray(values)
    return lambda r: values[np.minimum((r * len(values)).astype(int), len(values) - 1)]


@pytest.fixture(scope="module")
def row(request):
    """Mean counts of one photon per pixel: 50 um, off centre by 3 pixels, drifted and tilted by 1 %."""
    counts = request.getfixturevalue("brute_force")
    made = {}

    def make(fraction=PHI, radius=50e-6, width=3.0, blur=0.0):
        key = (tuple(fraction), radius, width, blur)
        if key not in made:
            made[key] = counts(
                steps(fraction),
                radius,
                flat=np.ones(int(width * radius / PIXEL)),
                pixel=PIXEL,
                solvent=531.9,
                contrast=-137.44,
                air=0.6,
                axis=3 * PIXEL,
                amplitude=1.01,
                slope=0.01,
                blur=blur,
                parts=32,
                along=800,
            )
        return made[key]

    return make


def frame(mean, photons, rows=None, seed=1, blur=0.0):
    """Replicates of a row, or the noise-free rows given."""
    if rows is not None:
        counts = np.random.default_rng(seed).poisson(photons * mean, (rows, mean.size)).astype(float)
    else:
        counts = photons * np.atleast_2d(mean)
    flat = np.full(counts.shape, float(photons))
    return xray.Frame(counts, flat, np.zeros_like(flat), flat > 0, PIXEL, blur)


def cone(first, last, rows, pixels, photons, axis=(0.0, 0.0)):
    """Noise-free rows of a jet whose radius and axis change."""
    detector = xray.Detector(np.full(pixels, float(photons)), PIXEL)
    jets = zip(np.linspace(first, last, rows), np.linspace(*axis, rows), strict=True)
    return np.array([xray.expected_counts(xray.RoundJet(np.array([0.05]), r, a), SOLUTION, detector) for r, a in jets])


def test_edges_to_a_part_of_a_pixel_under_drift() -> None:
    """A tapering, leaning jet in a beam that is 1 % off: radius to 0.1 pixel at 1e7 photons, to its error at 1e5."""
    mean = cone(60e-6, 25e-6, 120, 240, 1.0, (2e-6, 8e-6)) * 1.01
    radius = np.linspace(60e-6, 25e-6, 120) / PIXEL
    for photons, most in ((1e7, 0.12), (1e5, None)):
        f = frame(mean, photons)
        counts = np.random.default_rng(3).poisson(f.counts).astype(float)
        track = xray.track_jet(counts, f.flat, f.dark, f.good)
        error = track.radius - radius
        assert track.found.mean() > 0.9
        if most is not None:
            assert np.abs(error).max() < most
            assert np.abs(track.axis - np.linspace(2e-6, 8e-6, 120) / PIXEL).max() < most
            assert track.level == pytest.approx(np.full(120, 1.01), abs=3e-4)
        else:
            z = error[track.found] / np.sqrt(track.covariance[track.found, 1, 1])
            assert 0.8 < z.std() < 1.3


def test_few_photons_are_helped_by_the_rows_around() -> None:
    """50 photons per pixel: a single row says nothing, the frame gives radius and axis to a few pixels."""
    f = frame(cone(60e-6, 40e-6, 800, 240, 1.0), 50)
    track = xray.track_jet(np.random.default_rng(5).poisson(f.counts).astype(float), f.flat, f.dark, f.good)
    assert np.median(np.abs(track.radius - np.linspace(60e-6, 40e-6, 800) / PIXEL)) < 8
    assert track.found.mean() < 0.5


def test_noise_alone_is_no_jet() -> None:
    counts = np.random.default_rng(0).poisson(1e4, (40, 100)).astype(float)
    flat = np.full(counts.shape, 1e4)
    assert xray.track_jet(counts, flat, 0 * flat, flat > 0) is None
    with pytest.raises(InputError, match="show no jet"):
        xray.fit_frame(xray.Frame(counts, flat, 0 * flat, flat > 0, PIXEL), SOLUTION)


def test_scatter_and_error_bars_of_a_frame(row) -> None:
    """250 rows: within 1.15 of the bound with the same unknowns, z-scores of unit width, shells too."""
    fit = xray.fit_frame(frame(row(), 1e6, 250), SOLUTION)
    nuisances = ("radius", "axis", "amplitude", "slope")
    jet = xray.RoundJet(PHI, 50e-6, 3 * PIXEL)
    bound = xray.error_limit(jet, SOLUTION, xray.Detector(np.full(row().size, 1e6), PIXEL), nuisances=nuisances)
    assert 0.85 < fit.mean.std(ddof=1) / bound.mean < 1.15
    assert 0.88 < ((fit.mean - MEAN) / fit.mean_std).std() < 1.15
    shells = (fit.fraction - PHI) / np.sqrt(np.einsum("bii->bi", fit.covariance))
    assert np.all(np.abs(shells.std(axis=0) - 1) < 0.16)
    assert abs(fit.misfit.mean()) < 0.25
    assert (fit.flags == 0).all()


def test_rows_of_a_frame_are_those_of_fit_row(row) -> None:
    f = frame(row(), 1e7, 4)
    fit = xray.fit_frame(f, SOLUTION)
    for i in range(4):
        alone = xray.fit_row(f.counts[i], SOLUTION, xray.Detector(f.flat[i], PIXEL))
        assert fit.mean[i] == pytest.approx(alone.mean_fraction, abs=0.02 * alone.mean_fraction_std)
        assert fit.mean_std[i] == pytest.approx(alone.mean_fraction_std, rel=1e-3)
        assert fit.values["radius"][i] == pytest.approx(alone.jet.radius, abs=0.02 * alone.std["radius"])


def test_a_block_that_tapers_is_blurred_not_biased() -> None:
    """Radius and axis change by 1.6 pixels within the block: left out, a bias and a misfit; with the blur, neither."""
    f = frame(cone(50e-6, 49e-6, 8, 224, 1e7, (0.0, 1e-6)), 1.0)
    f = xray.Frame(f.counts, f.flat * 1e7, f.dark, f.good, PIXEL)
    fit = xray.fit_frame(f, SOLUTION, shells=1, block_rows=8)
    counts, detector, _ = f.block(0, 8)
    sharp = xray.fit_row(counts, SOLUTION, detector, shells=1)
    assert abs(sharp.mean_fraction - 0.05) > sharp.mean_fraction_std
    assert sharp.misfit > 10
    assert abs(fit.mean[0] - 0.05) < 0.5 * fit.mean_std[0]
    assert fit.misfit[0] < 4
    steep = xray.fit_frame(frame(cone(60e-6, 50e-6, 6, 240, 1e6), 1.0), SOLUTION, shells=1, block_rows=6)
    assert steep.flags[0] & (1 << list(xray.FRAME_FLAGS).index("smeared"))


def test_rows_that_cannot_be_fitted_are_nan_with_a_reason(row) -> None:
    f = frame(row(), 1e7, 6)
    f.good[2] = False
    fit = xray.fit_frame(f, SOLUTION)
    bit = 1 << list(xray.FRAME_FLAGS).index("not_fitted")
    assert (fit.flags & bit != 0).tolist() == [False, False, True, False, False, False]
    assert np.isnan(fit.mean).tolist() == [False, False, True, False, False, False]
    assert "no good pixel" in fit.reasons[2]
    f.good[:] = False
    with pytest.raises(InputError):
        xray.fit_frame(f, SOLUTION)


def test_chords_of_a_frame(row) -> None:
    """A uniform jet: unbiased, errors that hold, and its chords those of `chord_fractions` where the geometry is the same."""
    uniform = row((0.06,))
    f = frame(uniform, 1e7, 200)
    fit = xray.chord_frame(f, SOLUTION)
    z = (fit.mean - 0.06) / fit.mean_std
    assert abs(z.mean()) < 0.25
    assert 0.8 < z.std() < 1.15
    fine = xray.chord_frame(f, SOLUTION, shells=40)
    for i in (0, 7):
        values = {name: float(fine.values[name][i]) for name in ("radius", "axis", "amplitude", "slope")}
        one = xray.chord_fractions(
            f.counts[i],
            SOLUTION,
            xray.Detector(f.flat[i], PIXEL),
            values["radius"],
            values["axis"],
            amplitude=values["amplitude"],
            slope=values["slope"],
        )
        centre = np.abs(one.position) < values["radius"] / 40
        chord = 2 * np.sqrt(values["radius"] ** 2 - one.position[centre] ** 2)
        assert fine.fraction[i, 0] == pytest.approx(np.average(one.fraction[centre], weights=chord**2), abs=1e-3)
    hollow = xray.chord_frame(frame(row(), 1e7), SOLUTION)
    assert np.all(np.diff(hollow.fraction[0]) > 0)
    assert hollow.fraction[0, 0] > PHI[0] + 0.01  # a chord mean, not the core


def test_chords_without_a_count_are_nan_and_flagged(row) -> None:
    f = frame(row((0.06,)), 1e6, 3)
    f.counts[1, 100:110] = 0.0
    fit = xray.chord_frame(f, SOLUTION)
    assert np.isnan(fit.mean).tolist() == [False, True, False]
    assert "without a count" in fit.reasons[1]


@pytest.mark.parametrize("left", [30.0, 30.25, 30.5, 30.9])
@pytest.mark.parametrize("blur", [0.0, 1.2])
def test_edges_of_a_nozzle(left, blur) -> None:
    """Exact for pixels that average, wherever the edge lies in one, and under a symmetric blur."""
    fine = (np.arange(120 * 64) + 0.5) / 64
    body = np.where((fine > left) & (fine < left + 47.3), 0.01, 1.02)
    if blur:
        from scipy.ndimage import gaussian_filter1d

        body = gaussian_filter1d(body, blur * 64, mode="nearest")
    a, b, std = xray.opaque_edges(body.reshape(120, 64).mean(axis=1), 0.01)
    assert a == pytest.approx(left, abs=0.01)
    assert b == pytest.approx(left + 47.3, abs=0.01)
    assert 0 < std < 0.1


@pytest.mark.parametrize(
    ("ratio", "words"),
    [
        (np.ones(100), "no nozzle"),
        (np.where(np.arange(100) < 50, 0.0, 1.0), "no nozzle"),
        (np.where(abs(np.arange(100) - 50) < 20, 0.4, 1.0), "40 % through"),
        (np.full(100, np.nan), "few good"),
    ],
)
def test_what_is_no_nozzle(ratio, words) -> None:
    with pytest.raises(InputError, match=words):
        xray.opaque_edges(ratio)


def test_frames_are_checked() -> None:
    good = np.ones((3, 10))
    for name, wrong in (("counts", good[0]), ("flat", good[:2]), ("pixel", -1.0)):
        parts = {"counts": good, "flat": good, "dark": 0 * good, "good": good > 0, "pixel": 1e-6} | {name: wrong}
        with pytest.raises(InputError, match=name):
            xray.Frame(**parts)
    f = xray.Frame(good, good, 0 * good, good > 0, 1e-6)
    for rows in (0, 4, 1.5):
        with pytest.raises(InputError, match=r"block_rows|jet"):
            xray.fit_frame(f, SOLUTION, block_rows=rows)
