"""Continuous profiles behind fringes: chords by quadrature, the mean of jets that are no staircase, taper, spectra."""

import itertools

import numpy as np
import pytest
from scipy.integrate import quad

from spinline import xray
from spinline.xray.frame import Frame
from spinline.xray.phase.frame import fit_frame_phase
from spinline.xray.phase.fresnel import WaveRowModel
from spinline.xray.phase.profiles import RADIAL_KNOTS, Ramps, Shells

PIXEL = 0.67e-6
WATER = xray.solution_medium("PEO", "water", 10.0)
NUISANCES = ("radius", "axis", "amplitude", "slope")
KNOTS = np.array(RADIAL_KNOTS)
ROOTS = np.sqrt((np.arange(20000) + 0.5) / 20000)
SHAPES = {
    "parabola": lambda r: 1 - 0.9 * r**2,
    "linear": lambda r: 1 - 0.9 * r,
    "skin": lambda r: 0.5 + 2 * r**12,
}


def row_behind(shape, radius, distance, pixels, axis, medium=WATER, per_pixel=20, nodes=4000):
    """Intensity of each pixel by Gauss-Legendre of the diffraction integral, summed over the lines; a mean fraction of 0.05."""
    seen = np.zeros(pixels)
    t, w = np.polynomial.legendre.leggauss(50)
    g, v = np.polynomial.legendre.leggauss(40)
    panels = np.linspace(-np.pi / 2, np.pi / 2, nodes // 50 + 1)
    half = 0.5 * np.diff(panels)[:, None]
    angle = (0.5 * (panels[1:] + panels[:-1])[:, None] + half * t).ravel()
    y = np.concatenate([(k + 0.5 * (1 + g)) / 4 for k in range(4)])
    fraction = shape(np.hypot(np.sin(angle)[:, None], np.cos(angle)[:, None] * y)) @ np.tile(v / 8, 4)
    fraction *= 0.05 / shape(ROOTS).mean()
    p, share = np.polynomial.legendre.leggauss(per_pixel)
    for i, wave in enumerate(medium.wavelength):
        turn = 2j * np.pi / wave
        base = 0.5 * (medium.solvent - medium.air)[i] + turn * (medium.delta_solvent - medium.delta_air)[i]
        rate = base + (0.5 * medium.contrast[i] + turn * medium.delta_contrast[i]) * fraction
        height = radius * np.cos(angle)
        strength = (np.exp(-2 * rate * height) - 1) * (half * w).ravel() * height
        for j, x in enumerate(PIXEL * (np.arange(pixels) - 0.5 * (pixels - 1))):
            phase = np.pi * (x + 0.5 * PIXEL * p[:, None] - axis - radius * np.sin(angle)) ** 2 / (wave * distance)
            u = 1 + np.exp(-0.25j * np.pi) / np.sqrt(wave * distance) * (np.exp(1j * phase) @ strength)
            seen[j] += medium.weight[i] * 0.5 * share @ np.abs(u) ** 2
    return seen


def test_chords_of_ramps_by_quadrature() -> None:
    ramps, radius, axis = Ramps(KNOTS), 30e-6, 1e-6
    x = np.array([-32e-6, -28.5e-6, -10e-6, 0.0, 7e-6, 20e-6, 30.9e-6, 33e-6])
    depth, _, _ = ramps.depths(radius, x, axis)
    values = np.array([0.1, 0.4, -0.2, 0.3, 0.9, 0.6])

    def chord(at):
        half = np.sqrt(max(radius**2 - (at - axis) ** 2, 0.0))
        corners = [np.sqrt(max(q * radius**2 - (at - axis) ** 2, 0.0)) / max(half, 1e-30) for q in KNOTS[1:-1]]
        inside = sorted({c for c in corners if 0 < c < 1})
        path = lambda y: np.interp(((at - axis) ** 2 + (y * half) ** 2) / radius**2, KNOTS, values)  # noqa: E731
        return 2 * half * quad(path, 0, 1, points=inside or None, epsabs=1e-13)[0]

    g, w = np.polynomial.legendre.leggauss(60)
    for i in range(x.size - 1):
        low, high = np.clip((x[i], x[i + 1]), axis - radius, axis + radius)
        ends = sorted(
            {low, high, *(a for q in KNOTS for s in (-1, 1) if low < (a := axis + s * radius * np.sqrt(q)) < high)}
        )
        total = 0.0
        for a, b in itertools.pairwise(ends):  # ends of roots: x by its sine
            t = 0.25 * np.pi * (1 + g)
            total += sum(
                0.25 * np.pi * wk * np.sin(2 * tk) * (b - a) * chord(a + (b - a) * np.sin(tk) ** 2)
                for tk, wk in zip(t, w, strict=True)
            )
        assert depth[i] @ values == pytest.approx(total / (x[i + 1] - x[i]), rel=2e-7, abs=1e-13)


def test_ramps_sum_to_the_disc_and_their_means_are_those_of_the_profile() -> None:
    x = np.linspace(-40e-6, 40e-6, 77)
    for knots in (KNOTS, np.array([0.0, 1.0])):
        ramps = Ramps(knots)
        disc, _, _ = Shells(np.array([0.0, 1.0])).depths(30e-6, x, 2e-6)
        assert ramps.depths(30e-6, x, 2e-6)[0].sum(axis=1) == pytest.approx(disc[:, 0], abs=1e-18)
        assert ramps.means(np.array([0.0, 1.0]))[0] @ (1 - knots) == pytest.approx(0.5)  # of 1 - (r/R)^2
        assert ramps.means(np.array([0.0, 0.5, 1.0])) @ (1 - knots) == pytest.approx([0.875, 0.375])
    staircase = Shells(np.array([0.0, 0.5, 1.0]))
    assert staircase.means(np.array([0.0, 0.25, 1.0])) == pytest.approx(np.array([[1, 0], [0.2, 0.8]]))


def test_derivatives_of_profiles_and_sections() -> None:
    lines = xray.solution_medium("PEO", "water", xray.harmonic_spectrum(10.0, {3: 0.1}))
    detector = xray.Detector(np.full(100, 1e6), PIXEL, blur=1e-6)
    sections = np.array([[-2.87e-7, 1.1e-7], [2.87e-7, -1.1e-7]])
    model = WaveRowModel(detector, xray.equal_shells(1), lines, 25e-6, profile=Ramps(KNOTS), sections=sections)
    at = np.array([0.03, 0.05, 0.08, 0.02, 0.1, 0.06, 25e-6, 2e-6, 1.01, 0.02, 1e-6, 0.05, 1.02])
    counts, jacobian = model.evaluate(at)
    assert model.mean(at) == pytest.approx(counts, rel=1e-12)
    steps = [*[1e-4] * 6, 1e-11, 1e-11, 1e-4, 1e-4, 1e-9, 1e-5, 1e-5]
    for i, step in enumerate(steps):
        move = step * np.eye(at.size)[i]
        slope = (model.mean(at + move) - model.mean(at - move)) / (2 * step)
        assert np.abs(slope - jacobian[:, i]).max() < 2e-6 * np.abs(slope).max(), model.names[i]


@pytest.mark.parametrize("shape", SHAPES)
def test_the_mean_of_smooth_profiles_is_unbiased_and_that_of_shells_is_not(shape) -> None:
    """R = 50 um, 10 cm, 1e7 photons, phantoms by quadrature: within 0.002; uniform and in three shells over 0.02 wrong."""
    n = 224
    counts = 1e7 * row_behind(SHAPES[shape], 50e-6, 0.1, n, 2e-6)
    detector = xray.Detector(np.full(n, 1e7), PIXEL)
    free = (*NUISANCES, "distance", "refraction")
    fit = xray.fit_row_phase(counts, WATER, detector, 0.1, nuisances=free)
    assert fit.converged
    assert abs(fit.mean_fraction - 0.05) < 2e-3
    assert 0.003 < fit.mean_fraction_std < 0.005  # of absorption alone 0.004
    assert fit.warnings == ()
    for shells in (1, 3):
        rigid = xray.fit_row_phase(counts, WATER, detector, 0.1, shells=shells, profile="shells")
        assert abs(rigid.mean_fraction - 0.05) > 0.02
        assert abs(rigid.mean_fraction - 0.05) > 15 * rigid.mean_fraction_std


def test_what_a_smooth_profile_costs_is_what_the_fringes_told_by_assumption() -> None:
    detector, jet = xray.Detector(np.full(224, 1e6), PIXEL), xray.RoundJet(np.array([0.05]), 50e-6, 2e-6)
    plain = xray.error_limit(jet, WATER.absorber, detector, nuisances=NUISANCES).mean
    free = (*NUISANCES, "distance", "refraction")
    known, smooth = (
        xray.phase_error_limit(jet, WATER, detector, 0.1, nuisances=NUISANCES, profile=p).mean
        for p in ("shells", "smooth")
    )
    bent = [
        xray.phase_error_limit(jet, WATER, detector, 0.1, nuisances=free, profile=p).mean for p in ("shells", "smooth")
    ]
    assert 4 < smooth / known < 7
    assert 0.9 < smooth / plain < 1.5
    assert 1.0 < bent[1] / bent[0] < 1.05  # where the refraction is fitted, nothing


def test_blocks_of_a_jet_that_tapers_and_leans() -> None:
    """0.05 pixels a row, leaning by 0.03, 1e5 photons a row: rows of six sections each; left out, the same is 10 sd off."""
    rows, height = 20, 6
    at = np.arange(rows * height) / height + 0.5 / height - 0.5 * rows
    radius, axis = 25e-6 - 0.05 * PIXEL * at, 1e-6 + 0.03 * PIXEL * at
    one = xray.Detector(np.ones(112), PIXEL)
    image = np.array(
        [
            xray.fresnel_counts(xray.RoundJet(np.array([0.05]), r, a), WATER, one, 0.1)
            for r, a in zip(radius, axis, strict=True)
        ]
    )
    counts = 1e6 * image.reshape(rows, height, -1).mean(axis=1)
    flat = np.full(counts.shape, 1e6)
    frame = Frame(counts, flat, 0 * flat, np.ones(flat.shape, bool), PIXEL)
    free = (*NUISANCES, "distance")
    fit = fit_frame_phase(frame, WATER, 0.1, shells=1, block_rows=10, profile="shells", nuisances=free)
    assert fit.values["radius"] == pytest.approx(radius.reshape(2, -1).mean(axis=1), abs=2e-9)
    assert np.abs(fit.mean - 0.05).max() < 3 * fit.mean_std.max()
    total, detector, _ = frame.block(0, 10)
    flat_fit = xray.fit_row_phase(total, WATER, detector, 0.1, profile="shells")
    assert abs(flat_fit.mean_fraction - 0.05) > 10 * flat_fit.mean_fraction_std
    assert flat_fit.misfit > 100


def test_fringes_of_a_beam_of_many_energies() -> None:
    """10 keV with 5 % of the signal at 30 and a line at 12: the sum of three waves by quadrature; as one line it is refused by misfit."""
    beam = xray.Spectrum(np.array([10.0, 12.0, 30.0]), np.array([0.75, 0.2, 0.05]))
    medium = xray.solution_medium("PEO", "water", beam)
    n = 112
    seen = row_behind(SHAPES["parabola"], 25e-6, 0.1, n, 1e-6, medium, nodes=3000)
    found = xray.fresnel_counts(
        xray.RoundJet(np.array([0.05]), 25e-6, 1e-6), medium, xray.Detector(np.ones(n), PIXEL), 0.1
    )
    assert np.abs(seen - found).max() < 0.02  # but for the profile
    counts, detector = 1e6 * seen, xray.Detector(np.full(n, 1e6), PIXEL)
    fit = xray.fit_row_phase(counts, medium, detector, 0.1)
    assert abs(fit.mean_fraction - 0.05) < 0.2 * fit.mean_fraction_std
    assert fit.misfit < 1
    one = xray.fit_row_phase(counts, WATER, detector, 0.1)
    assert one.misfit > 50
