"""One row reduced by likelihood: against the bound, against brute-force phantoms, at few counts, and what is refused."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError
from spinline.xray.row.forward import row_model
from spinline.xray.row.scoring import poisson_deviance

PIXEL = 0.67e-6
SOLUTION = xray.Absorber(531.9, -137.44, 0.6)  # PEO in water, 10 keV
NUISANCES = ("radius", "axis", "amplitude", "slope")
PHI = np.array([0.03, 0.05, 0.08])
MEAN = float(xray.shell_weights(xray.equal_shells(3)) @ PHI)


def steps(values):
    values = np.asarray(values)
    return lambda r: values[np.minimum((r * len(values)).astype(int), len(values) - 1)]


@pytest.fixture
def image(phantom):
    """Mean counts behind a jet, drifted by 1 %, tilted by 1 % and off centre by 3 pixels unless said."""

    def counts(radius, photons, fraction=PHI, width=3.0, axis=3 * PIXEL, amplitude=1.01, slope=0.01, **more):
        flat = np.full(int(width * radius / PIXEL), float(photons))
        mean = phantom(
            fraction if callable(fraction) else steps(fraction),
            radius,
            flat=flat,
            pixel=PIXEL,
            solvent=531.9,
            contrast=-137.44,
            air=0.6,
            axis=axis,
            amplitude=amplitude,
            slope=slope,
            **more,
        )
        return mean, flat

    return counts


def replicates(mean, detector, count, seed, **more):
    fits = [xray.fit_row(xray.noisy_counts(mean, seed, i), SOLUTION, detector, **more) for i in range(count)]
    assert all(f.converged for f in fits)
    return np.array([f.mean_fraction for f in fits]), np.array([f.mean_fraction_std for f in fits]), fits


@pytest.mark.parametrize(("micrometres", "photons"), [(100, 1e5), (50, 1e6), (25, 1e7)])
def test_scatter_reaches_the_bound(image, micrometres, photons) -> None:
    """500 replicates: no more than 1.15 of the bound with the same unknowns, for the mean and for each shell."""
    mean, flat = image(micrometres * 1e-6, photons)
    detector = xray.Detector(flat, PIXEL)
    jet = xray.RoundJet(PHI, micrometres * 1e-6, 3 * PIXEL)
    bound = xray.error_limit(jet, SOLUTION, detector, nuisances=NUISANCES, amplitude=1.01, slope=0.01)
    found, _, fits = replicates(mean, detector, 500, seed=5)
    assert 0.9 < found.std(ddof=1) / bound.mean < 1.15
    ratio = np.array([f.jet.fraction for f in fits]).std(axis=0, ddof=1) / bound.fraction
    assert np.all((ratio > 0.9) & (ratio < 1.15))
    assert abs(found.mean() - MEAN) < 3 * bound.mean / np.sqrt(500)


@pytest.mark.slow
def test_errors_are_what_they_say(image) -> None:
    """1,000 replicates: z-scores of unit width, 95 % intervals that hold 95 %."""
    mean, flat = image(50e-6, 1e6)
    found, sd, fits = replicates(mean, xray.Detector(flat, PIXEL), 1000, seed=11)
    z = (found - MEAN) / sd
    assert 0.9 < z.std() < 1.15
    assert 0.93 < np.mean(np.abs(z) < 1.96) < 0.97
    assert np.mean([f.misfit for f in fits]) == pytest.approx(0.0, abs=0.15)
    radius = (np.array([f.jet.radius for f in fits]) - 50e-6) / np.array([f.std["radius"] for f in fits])
    assert 0.9 < radius.std() < 1.25


@pytest.mark.parametrize("blur", [0.0, 1.2e-6])
@pytest.mark.parametrize("fraction", [[0.05], [0.03, 0.05, 0.08]], ids=["uniform", "shells"])
def test_no_bias_under_drift_slope_offset_and_blur(image, fraction, blur) -> None:
    """Mean counts for 1e7 photons, nothing known beforehand: 0.04 of the standard deviation at most."""
    mean, flat = image(50e-6, 1e7, fraction=fraction, blur=blur, parts=32)
    fit = xray.fit_row(mean, SOLUTION, xray.Detector(flat, PIXEL, blur=blur), shells=len(fraction))
    true = float(xray.shell_weights(xray.equal_shells(len(fraction))) @ fraction)
    assert abs(fit.mean_fraction - true) < 0.04 * fit.mean_fraction_std
    assert fit.jet.radius == pytest.approx(50e-6, abs=2e-9)
    assert fit.jet.axis == pytest.approx(3 * PIXEL, abs=2e-9)
    assert fit.values["amplitude"] == pytest.approx(1.01, rel=1e-5)
    assert fit.values["slope"] == pytest.approx(0.01, abs=1e-5)
    assert fit.warnings == ()


def test_a_smooth_profile_in_few_shells(image) -> None:
    """What three shells do to a parabola, at 1e7 photons: under half a standard deviation; more shells, less."""
    mean, flat = image(50e-6, 1e7, fraction=lambda r: 0.03 + 0.06 * r**2)
    bias = []
    for shells in (3, 6):
        fit = xray.fit_row(mean, SOLUTION, xray.Detector(flat, PIXEL), shells=shells)
        bias.append(abs(fit.mean_fraction - 0.06) / fit.mean_fraction_std)
    assert bias[1] < bias[0] < 0.5


def test_unknown_blur_is_found_and_an_ignored_one_shows(image) -> None:
    mean, flat = image(50e-6, 1e7, blur=1.2e-6)
    free = xray.fit_row(mean, SOLUTION, xray.Detector(flat, PIXEL, blur=1.6e-6), nuisances=(*NUISANCES, "blur"))
    assert free.values["blur"] == pytest.approx(1.2e-6, rel=0.01)
    assert abs(free.mean_fraction - MEAN) < 0.1 * free.mean_fraction_std
    sharp = xray.fit_row(xray.noisy_counts(mean, 1), SOLUTION, xray.Detector(flat, PIXEL))
    assert sharp.misfit > 4
    assert any("Poisson" in w for w in sharp.warnings)


@pytest.mark.slow
@pytest.mark.parametrize("photons", [20, 5, 1])
def test_few_counts_are_not_biased(image, photons) -> None:
    """2,000 rows of 20, 5 or 1 photons per pixel: summed with all unknown, and one by one with the geometry known."""
    mean, flat = image(50e-6, photons)
    rows = np.array([xray.noisy_counts(mean, 9, i) for i in range(2000)])
    detector = xray.Detector(flat, PIXEL)
    block = xray.fit_row(rows, SOLUTION, detector)
    assert abs(block.mean_fraction - MEAN) < 2 * block.mean_fraction_std
    known = {"nuisances": ("amplitude", "slope"), "radius": 50e-6, "axis": 3 * PIXEL, "shells": 1}
    each = np.array([xray.fit_row(r, SOLUTION, detector, **known).mean_fraction for r in rows])
    assert abs(each.mean() - MEAN) < 2 * each.std() / np.sqrt(2000)


def test_more_photons_than_can_be_counted_are_refused() -> None:
    with pytest.raises(InputError, match="more photons than can be counted"):
        xray.fit_row(COUNTS * 1e290, SOLUTION, ROW)


def test_a_shell_of_air_is_no_part_of_the_jet(image) -> None:
    """Ten shells at 1e5 photons: the likelihood is as large for a jet a ninth wider whose rim is as clear as air."""
    mean, flat = image(50e-6, 1e5)
    found, std, fits = replicates(mean, xray.Detector(flat, PIXEL), 40, seed=3, shells=10)
    assert max(f.jet.fraction[-1] for f in fits) < 2.0  # air is 3.9
    assert max(f.jet.radius for f in fits) < 52e-6
    z = (found - MEAN) / std
    assert abs(z.mean()) < 3 / np.sqrt(40)
    assert 0.7 < np.sqrt((z**2).mean()) < 1.35  # 40 scores: 1 within 0.11


def test_a_block_is_its_sum_and_bad_pixels_are_left_out(image) -> None:
    mean, flat = image(50e-6, 1e5)
    rows = np.array([xray.noisy_counts(mean, 2, i) for i in range(8)])
    block = xray.fit_row(rows, SOLUTION, xray.Detector(flat, PIXEL))
    whole = xray.fit_row(rows.sum(axis=0), SOLUTION, xray.Detector(8 * flat, PIXEL))
    assert block.mean_fraction == pytest.approx(whole.mean_fraction, rel=1e-9)
    good = np.ones(rows.shape, dtype=bool)
    good[3, 60:64] = good[5, 100] = good[:, 17] = False
    spoiled = np.where(good, rows, np.nan)
    masked = xray.fit_row(spoiled, SOLUTION, xray.Detector(flat, PIXEL), good=good)
    assert masked.converged
    assert abs(masked.mean_fraction - block.mean_fraction) < 0.5 * block.mean_fraction_std
    assert masked.degrees_of_freedom == block.degrees_of_freedom - 1


@pytest.mark.parametrize("value", [0.0, 1e9])
def test_a_bad_pixel_that_is_not_masked_is_named(image, value) -> None:
    mean, flat = image(50e-6, 1e6)
    counts = xray.noisy_counts(mean, 4)
    counts[60] = value
    fit = xray.fit_row(counts, SOLUTION, xray.Detector(flat, PIXEL))
    assert any("pixel 60" in w for w in fit.warnings)


def test_a_row_without_a_jet_is_refused_or_said_to_tell_nothing() -> None:
    detector = xray.Detector(np.full(200, 1e6), PIXEL)
    fit = xray.fit_row(xray.noisy_counts(detector.flat, 1), SOLUTION, detector)
    assert any("exceeds the fraction" in w for w in fit.warnings)
    with pytest.raises(InputError, match=r"no trace|tell apart"):
        xray.fit_row(detector.flat, SOLUTION, detector)


def test_dark_and_veil_are_part_of_the_model(image) -> None:
    mean, flat = image(50e-6, 1e6, dark=300.0, veil=0.02)
    fit = xray.fit_row(mean, SOLUTION, xray.Detector(flat, PIXEL, np.array(300.0), np.array(0.02)))
    assert abs(fit.mean_fraction - MEAN) < 0.01 * fit.mean_fraction_std


def test_any_place_and_drift_is_found(phantom) -> None:
    """Random radius, place, width, drift and slope, where the bound is about 0.03."""
    rng = np.random.default_rng(4)
    z = []
    for i in range(60):
        radius = np.exp(rng.uniform(np.log(6e-6), np.log(1.2e-4)))
        n = int(rng.uniform(2.5, 6) * radius / PIXEL) + 8
        axis = rng.uniform(-0.9, 0.9) * (n * PIXEL / 2 - radius - 3 * PIXEL)
        flat = 3e5 * (50e-6 / radius) ** 3 * (1 + 0.2 * np.sin(np.arange(n) / 20))
        phi = rng.uniform(0, 0.3, 2)
        mean = phantom(
            steps(phi),
            radius,
            flat=flat,
            pixel=PIXEL,
            solvent=531.9,
            contrast=-137.44,
            air=0.6,
            axis=axis,
            amplitude=rng.uniform(0.9, 1.1),
            slope=rng.uniform(-0.1, 0.1),
            along=400,
            parts=8,
        )
        fit = xray.fit_row(xray.noisy_counts(mean, 1, i), SOLUTION, xray.Detector(flat, PIXEL), shells=2)
        assert fit.converged
        z.append((fit.mean_fraction - phi @ [0.25, 0.75]) / fit.mean_fraction_std)
    assert np.abs(z).max() < 4
    assert np.std(z) < 1.4


def test_too_few_photons_are_said_to_be() -> None:
    detector = xray.Detector(np.full(224, 1e3), PIXEL)
    counts = xray.expected_counts(xray.RoundJet(np.zeros(3), 50e-6), SOLUTION, detector)
    free = xray.fit_row(counts, SOLUTION, detector)
    held = xray.fit_row(counts, SOLUTION, detector, nuisances=("amplitude",), radius=50e-6, axis=0.0)
    assert any("exceeds the fraction" in w for w in held.warnings)
    assert any("not Gaussian" in w for w in free.warnings)
    assert held.std["radius"] == 0.0
    assert free.mean_fraction_std > held.mean_fraction_std > held.limit_std


def test_a_jet_at_the_end_of_the_row_is_said_to_be() -> None:
    jet = xray.RoundJet(np.array([0.05]), 50e-6, 24e-6)
    detector = xray.Detector(np.full(220, 1e7), PIXEL)
    counts = xray.expected_counts(jet, SOLUTION, detector)
    fit = xray.fit_row(counts, SOLUTION, detector, shells=1, radius=50e-6, axis=24e-6)
    assert any("end of the row" in w for w in fit.warnings)


def test_the_estimate_is_stationary() -> None:
    """The gradient of the likelihood, from its own definition, vanishes in units of a standard deviation."""
    jet = xray.RoundJet(PHI, 50e-6)
    detector = xray.Detector(np.full(224, 1e6), PIXEL, blur=1e-6)
    counts = xray.noisy_counts(xray.expected_counts(jet, SOLUTION, detector), 3)
    fit = xray.fit_row(counts, SOLUTION, detector)
    model = row_model(SOLUTION, detector, xray.equal_shells(3))
    at = np.concatenate((fit.jet.fraction, list(fit.values.values())))
    for i, sd in enumerate([*fit.fraction_std, *(fit.std[n] for n in NUISANCES)]):
        step = 0.05 * sd * np.eye(8)[i]
        up, down = (poisson_deviance(counts, model.evaluate(at + s)[0]) for s in (step, -step))
        assert abs(up - down) / 0.1 < 0.1  # deviance per standard deviation
        assert min(up, down) > fit.deviance


def test_deviance_against_high_precision() -> None:
    import mpmath

    mpmath.mp.dps = 40
    for c, m in [(0.0, 3.0), (5.0, 3.0), (1e9, 1e9 + 1e3), (1.0, 1e6), (7.0, 7.0)]:
        exact = 2 * ((mpmath.mpf(c) * mpmath.log(mpmath.mpf(c) / m) if c else 0) - (mpmath.mpf(c) - m))
        assert poisson_deviance(np.array([c]), np.array([m])) == pytest.approx(float(exact), rel=1e-9, abs=1e-12)


ROW = xray.Detector(np.full(100, 1e4), PIXEL)
COUNTS = xray.expected_counts(xray.RoundJet(np.array([0.05]), 20e-6), SOLUTION, ROW)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: xray.fit_row(COUNTS, xray.Absorber(531.9, 2.0), ROW), "contrast.*1 %"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, xray.Detector(ROW.flat, PIXEL, np.array(2e4))), "dark.*exceeds"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, xray.Detector(None, PIXEL)), "flat.*missing"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, saturation=9900.0), "saturated"),
        (lambda: xray.fit_row(COUNTS - 1e4, SOLUTION, ROW), "counts"),
        (lambda: xray.fit_row(COUNTS * np.nan, SOLUTION, ROW), "counts"),
        (lambda: xray.fit_row(["a"] * 100, SOLUTION, ROW), "counts"),
        (lambda: xray.fit_row(COUNTS[:50], SOLUTION, ROW), "counts"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, good=np.ones(100)), "good"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, good=np.arange(100) < 3), "good"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, nuisances=("axis",)), "radius.*neither"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, nuisances=("radius",)), "axis.*neither"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, nuisances=("blur", "radius", "axis")), "blur"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, nuisances=("tilt",)), "nuisances"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, shells=0), "shells"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, shells=[0.0, 0.5]), "edges"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, radius=-1.0), "radius"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, axis=1.0), "axis"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, slope=2.0), "slope"),
        (lambda: xray.fit_row(COUNTS, SOLUTION, ROW, shells=120), "unknowns"),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call()
