"""Fresnel rows: quadrature of the diffraction integral, Cornu's edge, absorption at no distance, flux, derivatives."""

import numpy as np
import pytest
from scipy.special import fresnel as fresnel_integrals

from spinline import xray
from spinline.base.errors import InputError
from spinline.xray.phase.fresnel import WaveRowModel, cells_per_pixel, wave_model

PIXEL = 0.67e-6
WATER = xray.solution_medium("PEO", "water", 10.0)
NUISANCES = ("radius", "axis", "amplitude", "slope")


def medium(delta, mu, energy=10.0):
    one = np.ones(1)
    return xray.Medium(one * energy, one, one * mu, 0 * one, 0 * one, one * delta, 0 * one, 0 * one)


def wave_phantom(rate, radius, wave, distance, pixel, pixels, axis=0.0, nodes=4000, per_pixel=10):
    """Intensity of each pixel by Gauss-Legendre of the diffraction integral, the edge made smooth by x = R sin t."""
    t, w = np.polynomial.legendre.leggauss(50)
    panels = np.linspace(-np.pi / 2, np.pi / 2, nodes // 50 + 1)
    half = 0.5 * np.diff(panels)[:, None]
    angle = (0.5 * (panels[1:] + panels[:-1])[:, None] + half * t).ravel()
    source = axis + radius * np.sin(angle)
    strength = (np.exp(-2 * rate * radius * np.cos(angle)) - 1) * (half * w).ravel() * radius * np.cos(angle)
    g, v = np.polynomial.legendre.leggauss(per_pixel)
    middle = pixel * (np.arange(pixels) - 0.5 * (pixels - 1))
    seen = np.empty(pixels)
    for i, x in enumerate(middle):
        phase = np.pi * (x + 0.5 * pixel * g[:, None] - source) ** 2 / (wave * distance)
        u = 1 + np.exp(-0.25j * np.pi) / np.sqrt(wave * distance) * (np.exp(1j * phase) @ strength)
        seen[i] = 0.5 * v @ np.abs(u) ** 2
    return seen


def water_rate(fraction=0.05):
    mu = WATER.solvent - WATER.air + fraction * WATER.contrast
    delta = WATER.delta_solvent - WATER.delta_air + fraction * WATER.delta_contrast
    return complex(0.5 * mu[0] + 2j * np.pi * delta[0] / WATER.wavelength[0])


@pytest.mark.parametrize("distance", [0.1, 0.3])
def test_against_quadrature_of_the_diffraction_integral(distance) -> None:
    """Worst pixel 5e-4 of the beam, over a row of fringes from 0.3 to 2.3 of it."""
    exact = wave_phantom(water_rate(), 40e-6, WATER.wavelength[0], distance, PIXEL, 160, axis=1.3e-6)
    assert exact.max() > 1.9
    assert exact.min() < 0.4
    jet = xray.RoundJet(np.array([0.05]), 40e-6, 1.3e-6)
    found = xray.fresnel_counts(jet, WATER, xray.Detector(np.ones(160), PIXEL), distance)
    assert np.abs(found - exact).max() < 5e-4


def test_it_converges_with_the_cells_at_second_order() -> None:
    exact = wave_phantom(water_rate(), 25e-6, WATER.wavelength[0], 0.2, PIXEL, 110, nodes=1500)
    detector, at = xray.Detector(np.ones(110), PIXEL), np.array([0.05, 25e-6, 0, 1, 0, 0, 0.2, 1])
    errors = []
    for cells in (8, 16, 32, 64):
        model = WaveRowModel(detector, xray.equal_shells(1), WATER, 25e-6, cells=cells)
        errors.append(np.sqrt(np.mean((model.mean(at) - exact) ** 2)))
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(order > 1.6)
    assert errors[-1] < 1e-5


def test_the_shadow_of_an_opaque_strip_by_cornu() -> None:
    """A black cylinder is a strip: |1 - (C + iS)(1 - i)/2|^2 between its edges, over three fringes out and in."""
    black, radius, z = medium(0.0, 2e6), 60e-6, 0.3
    wave = black.wavelength[0]
    detector = xray.Detector(np.ones(400), 0.5e-6)
    model = WaveRowModel(detector, xray.equal_shells(1), black, radius, cells=64)
    found = model.mean(np.array([0.0, radius, 0, 1, 0, 0, z, 1]))
    x = 0.5e-6 * (np.arange(400 * 40) - 0.5 * (400 * 40 - 1)) / 40
    s1, c1 = fresnel_integrals((x + radius) * np.sqrt(2 / (wave * z)))
    s0, c0 = fresnel_integrals((x - radius) * np.sqrt(2 / (wave * z)))
    strip = 0.5 * (1 - 1j) * ((c1 - c0) + 1j * (s1 - s0))
    exact = (np.abs(1 - strip) ** 2).reshape(400, 40).mean(axis=1)
    assert exact.max() > 1.35
    assert np.abs(found - exact).max() < 5e-3
    edge = int(200 + radius / 0.5e-6)
    assert found[edge - 1] == pytest.approx(0.25, abs=0.06)  # a quarter of the light at the edge of a shadow


@pytest.mark.parametrize("blur", [0.0, 1.2e-6])
def test_no_distance_is_absorption(blur) -> None:
    detector = xray.Detector(np.full(200, 1e5), PIXEL, np.array(30.0), np.array(0.02), blur)
    jet = xray.RoundJet(np.array([0.02, 0.08]), 50e-6, 3e-6)
    plain = xray.expected_counts(jet, WATER.absorber, detector, amplitude=0.98, slope=0.02)
    here = xray.fresnel_counts(jet, WATER, detector, 0.0, amplitude=0.98, slope=0.02)
    assert np.abs(here / plain - 1).max() < (5e-5 if blur else 2e-4)  # the cell at the edge
    near = xray.fresnel_counts(jet, WATER, detector, 1e-7, amplitude=0.98, slope=0.02)
    assert np.abs(near / plain - 1).max() < 2e-3


def test_a_pure_phase_object_moves_light_and_keeps_it() -> None:
    glass = medium(2.3e-6, 1e-9)
    detector = xray.Detector(np.ones(1200), PIXEL)
    seen = xray.fresnel_counts(xray.RoundJet(np.array([0.0]), 40e-6), glass, detector, 0.05)
    assert np.ptp(seen) > 1.0
    assert abs(seen.sum() - 1200) < 0.05


def test_near_field_obeys_the_transport_of_intensity() -> None:
    """I - 1 = -mu L + z delta L'' for a blur much wider than a fringe: change with z of the second moment of the row."""
    thin = medium(2e-8, 1.0)  # a weak phase, no absorption to speak of
    detector = xray.Detector(np.ones(600), PIXEL, blur=3e-6)
    x = PIXEL * (np.arange(600) - 299.5)
    moments = []
    for z in (0.0, 0.02):
        seen = xray.fresnel_counts(xray.RoundJet(np.array([0.0]), 40e-6), thin, detector, z)
        moments.append(((seen - 1) * x**2).sum() * PIXEL)
    # integral x^2 L'' = 2 integral L = 2 pi R^2
    assert moments[1] - moments[0] == pytest.approx(0.02 * 2e-8 * 2 * np.pi * (40e-6) ** 2, rel=0.02)


def test_derivatives_and_the_shorter_way_to_the_counts() -> None:
    lines = xray.solution_medium("PEO", "water", xray.harmonic_spectrum(10.0, {3: 0.1}))
    model = wave_model(lines, xray.Detector(np.full(100, 1e6), PIXEL, blur=1e-6), xray.equal_shells(3), 25e-6)
    at = np.array([0.03, 0.05, 0.08, 25e-6, 2e-6, 1.01, 0.02, 1e-6, 0.05, 1.02])
    counts, jacobian = model.evaluate(at)
    assert model.mean(at) == pytest.approx(counts, rel=1e-12)
    steps = [1e-4, 1e-4, 1e-4, 1e-10, 1e-10, 1e-4, 1e-4, 1e-9, 1e-5, 1e-5]
    for i, step in enumerate(steps):
        move = step * np.eye(at.size)[i]
        slope = (model.mean(at + move) - model.mean(at - move)) / (2 * step)
        assert np.abs(slope - jacobian[:, i]).max() < 2e-6 * np.abs(slope).max(), model.names[i]


def test_the_edge_decides_the_cells_and_what_is_not_resolved_is_refused() -> None:
    assert cells_per_pixel(WATER, 50e-6, PIXEL) > cells_per_pixel(WATER, 25e-6, PIXEL) >= 16
    strong = xray.solution_medium("PEO", "water", 3.0)
    with pytest.raises(InputError, match=r"pixel.*too coarse"):
        xray.fresnel_counts(xray.RoundJet(np.array([0.05]), 1e-4), strong, xray.Detector(np.ones(300), PIXEL), 0.1)
    with pytest.raises(InputError, match=r"jet.*row"):
        xray.fresnel_counts(xray.RoundJet(np.array([0.05]), 60e-6), WATER, xray.Detector(np.ones(100), PIXEL), 0.1)
    with pytest.raises(InputError, match="distance"):
        xray.fresnel_counts(xray.RoundJet(np.array([0.05]), 20e-6), WATER, xray.Detector(np.ones(100), PIXEL), -0.1)


def test_width_of_a_fringe() -> None:
    assert xray.edge_fringe_width(10.0, 0.1) == pytest.approx(np.sqrt(1.239842e-10 * 0.1), rel=1e-6)


@pytest.mark.parametrize("distance", [0.1, 0.2])
def test_the_likelihood_is_unbiased_on_phantoms_by_quadrature(distance) -> None:
    """R = 50 um, nothing known, 1e7 photons: within 0.001, and 1e-9 m in radius and axis."""
    n = 224
    seen = wave_phantom(
        water_rate(), 50e-6, WATER.wavelength[0], distance, PIXEL, n, axis=2e-6, nodes=int(400 / distance), per_pixel=20
    )
    u = np.linspace(-1, 1, n)
    counts = 1e7 * (1.01 * (1 + 0.01 * u) * seen + 0.01) + 100
    detector = xray.Detector(np.full(n, 1e7), PIXEL, np.array(100.0), np.array(0.01))
    fit = xray.fit_row_phase(counts, WATER, detector, distance)
    assert fit.converged
    assert fit.mean_fraction == pytest.approx(0.05, abs=1e-3)
    assert fit.jet.radius == pytest.approx(50e-6, abs=1e-9)
    assert fit.jet.axis == pytest.approx(2e-6, abs=1e-9)
    assert fit.values["amplitude"] == pytest.approx(1.01, rel=1e-4)
    assert fit.values["slope"] == pytest.approx(0.01, abs=1e-4)
    assert fit.warnings == ()


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["shells", pytest.param("smooth", marks=pytest.mark.slow)])
def test_scatter_of_phase_fits_reaches_the_bound(profile) -> None:
    """100 replicates at R = 25 um, 10 cm: 0.8 to 1.2 of the bound with the same unknowns; error bars likewise."""
    detector, jet = xray.Detector(np.full(112, 1e5), PIXEL, blur=0.5e-6), xray.RoundJet(np.array([0.05]), 25e-6, 1e-6)
    mean = xray.fresnel_counts(jet, WATER, detector, 0.1)
    bound = xray.phase_error_limit(jet, WATER, detector, 0.1, nuisances=NUISANCES, profile=profile)
    fits = [
        xray.fit_row_phase(xray.noisy_counts(mean, 7, i), WATER, detector, 0.1, nuisances=NUISANCES, profile=profile)
        for i in range(100)
    ]
    found = np.array([f.mean_fraction for f in fits])
    assert all(f.converged for f in fits)
    assert 0.8 < found.std(ddof=1) / bound.mean < 1.2
    assert abs(found.mean() - 0.05) < 3.3 * bound.mean / 10
    assert fits[0].mean_fraction_std == pytest.approx(bound.mean, rel=0.05)
    assert np.mean([f.misfit for f in fits]) == pytest.approx(0.0, abs=0.4)


@pytest.mark.slow
def test_a_wrong_distance_or_blur_is_costly_shows_and_is_cured_by_fitting_it() -> None:
    detector = xray.Detector(np.full(224, 1e6), PIXEL, blur=1.2e-6)
    counts = xray.fresnel_counts(xray.RoundJet(np.array([0.05]), 50e-6, 2e-6), WATER, detector, 0.1)
    wrong = xray.Detector(detector.flat, PIXEL, blur=1.32e-6)
    held = xray.fit_row_phase(counts, WATER, wrong, 0.1, nuisances=NUISANCES, profile="shells")
    assert abs(held.mean_fraction - 0.05) > 0.3
    assert held.misfit > 100
    both = (*NUISANCES, "blur", "distance")
    free = xray.fit_row_phase(counts, WATER, wrong, 0.102, nuisances=both)
    assert free.mean_fraction == pytest.approx(0.05, abs=1e-3)
    assert free.values["blur"] == pytest.approx(1.2e-6, rel=1e-3)
    jet = xray.RoundJet(np.array([0.05]), 50e-6, 2e-6)
    prices = [xray.phase_error_limit(jet, WATER, detector, 0.1, nuisances=n).mean for n in (NUISANCES, both)]
    assert 1.0 < prices[1] / prices[0] < 1.2


def test_a_sheath_misleads_the_fringes_and_less_where_refraction_is_fitted() -> None:
    """All polymer within 0.86 R: taken for uniform, its edges' fringes pull the mean down by 0.05."""
    edges = np.array([0.0, 0.86, 1.0])
    jet = xray.RoundJet(np.array([0.06, 0.0]), 46e-6, 0.0, edges)
    detector = xray.Detector(np.full(200, 1e7), PIXEL)
    counts = xray.fresnel_counts(jet, WATER, detector, 0.1)
    rigid = {"profile": "shells"}
    held = xray.fit_row_phase(counts, WATER, detector, 0.1, **rigid)
    free = xray.fit_row_phase(counts, WATER, detector, 0.1, nuisances=(*NUISANCES, "distance", "refraction"), **rigid)
    assert held.mean_fraction - jet.mean_fraction < -0.03
    assert abs(free.mean_fraction - jet.mean_fraction) < 0.025
    assert held.misfit > 10
    smooth = xray.fit_row_phase(counts, WATER, detector, 0.1)
    assert abs(smooth.mean_fraction - jet.mean_fraction) < 5e-4
    right = xray.fit_row_phase(counts, WATER, detector, 0.1, shells=edges, **rigid)
    assert abs(right.mean_fraction - jet.mean_fraction) < 0.25 * right.mean_fraction_std
    assert right.mean_fraction_std < 2e-3


def test_phase_lowers_the_limit_of_thin_jets() -> None:
    """R = 10 um, 20 cm, 0.67 um pixels: over 15 times below the bound of absorption."""
    jet, detector = xray.RoundJet(np.array([0.05]), 10e-6), xray.Detector(np.full(60, 1e6), PIXEL)
    phase = xray.phase_error_limit(jet, WATER, detector, 0.2, nuisances=NUISANCES)
    absorption = xray.error_limit(jet, WATER.absorber, detector, nuisances=NUISANCES)
    assert absorption.mean / phase.mean > 15
    blind = xray.solution_medium("PEO", "water", 38.5)  # absorption tells nothing here, refraction does
    assert xray.phase_error_limit(jet, blind, detector, 0.2, nuisances=NUISANCES).mean < 0.1


def test_unknown_distance_and_blur_are_found() -> None:
    detector = xray.Detector(np.full(224, 1e6), PIXEL, blur=1e-6)
    jet = xray.RoundJet(np.array([0.05]), 50e-6)
    counts = xray.noisy_counts(xray.fresnel_counts(jet, WATER, detector, 0.1), 3)
    guess = xray.Detector(np.full(224, 1e6), PIXEL, blur=1.4e-6)
    fit = xray.fit_row_phase(counts, WATER, guess, 0.09, nuisances=(*NUISANCES, "blur", "distance"))
    assert fit.values["blur"] == pytest.approx(1e-6, abs=4 * fit.std["blur"])
    assert fit.values["distance"] == pytest.approx(0.1, abs=4 * fit.std["distance"])
    assert fit.std["distance"] < 2e-3
    assert abs(fit.mean_fraction - 0.05) < 4 * fit.mean_fraction_std
    held = xray.fit_row_phase(counts, WATER, detector, 0.1, nuisances=NUISANCES)
    assert held.mean_fraction_std < fit.mean_fraction_std


def test_blocks_bad_pixels_and_zero_counts() -> None:
    detector = xray.Detector(np.full(112, 30.0), PIXEL)
    mean = xray.fresnel_counts(xray.RoundJet(np.array([0.05]), 25e-6), WATER, detector, 0.1)
    rows = np.array([xray.noisy_counts(mean, 5, i) for i in range(400)])
    rows[7, 3] = 0.0
    good = np.ones(rows.shape, dtype=bool)
    good[:, 56] = good[5, 60:70] = False
    fit = xray.fit_row_phase(np.where(good, rows, np.nan), WATER, detector, 0.1, good=good)
    assert fit.converged
    assert abs(fit.mean_fraction - 0.05) < 4 * fit.mean_fraction_std
    hot = rows.sum(axis=0)
    hot[100] = 1e9
    named = xray.fit_row_phase(hot, WATER, xray.Detector(np.full(112, 12e3), PIXEL), 0.1)
    assert any("pixel 100" in w for w in named.warnings)


def test_retrieval_passes_the_mean_and_inverts_its_own_equation() -> None:
    x = np.arange(200)
    contact = 1 - 0.05 * np.exp(-0.5 * ((x - 90) / 15.0) ** 2)
    strength = 0.1 * 4.4e-9 / PIXEL**2
    second = np.convolve(np.pad(contact, 1, mode="edge"), [1.0, -2.0, 1.0], mode="valid")
    there = contact - strength * second
    assert xray.contact_transmission(there, PIXEL, 0.1, 4.4e-9) == pytest.approx(contact, abs=1e-12)
    noise = np.random.default_rng(1).normal(1, 0.1, (5, 64))
    assert xray.contact_transmission(noise, PIXEL, 0.1, 4.4e-9, across=False).mean() == pytest.approx(noise.mean())
    assert xray.contact_transmission(noise, PIXEL, 0.0, 4.4e-9) == pytest.approx(noise)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"distance": np.inf}, "distance"),
        ({"distance": np.nan}, "distance"),
        ({"distance": -0.1}, "distance"),
        ({"pixel": 0.0}, "pixel"),
        ({"pixel": 1e-200}, "pixel.*too small"),
        ({"delta_over_mu": -1.0}, "delta_over_mu"),
        ({"delta_over_mu": np.inf}, "delta_over_mu"),
        ({"delta_over_mu": "water"}, "delta_over_mu"),
        ({"delta_over_mu": WATER, "fraction": np.nan}, "fraction"),
        ({"ratio": np.ones(3)}, "ratio"),
        ({"ratio": np.ones((3, 8)), "across": False}, "ratio.*rows"),
        ({"ratio": np.array([1.0, np.nan, 1.0, 1.0])}, "ratio"),
        ({"ratio": np.ones((0, 8)), "across": False}, "ratio"),
    ],
)
def test_retrieval_refuses(change, words) -> None:
    with pytest.raises(InputError, match=words):
        xray.contact_transmission(
            **{"ratio": np.ones(8), "pixel": PIXEL, "distance": 0.1, "delta_over_mu": 4e-9, **change}
        )


def test_retrieval_at_its_ends() -> None:
    """No distance or no refraction: the image; any distance: its mean; the ratio of a medium at its fraction."""
    noise = np.random.default_rng(2).normal(1, 0.1, (4, 16))
    for nothing in ({"distance": 0.0, "delta_over_mu": 4e-9}, {"distance": 1.0, "delta_over_mu": 0.0}):
        assert (xray.contact_transmission(noise, PIXEL, **nothing) == noise).all()
    far = xray.contact_transmission(noise, PIXEL, 1e30, 1e30)
    assert far == pytest.approx(np.broadcast_to(noise.mean(axis=1, keepdims=True), noise.shape), rel=1e-12)
    given = xray.contact_transmission(noise, PIXEL, 0.1, WATER.delta_over_mu(0.05))
    assert (xray.contact_transmission(noise, PIXEL, 0.1, WATER, fraction=0.05) == given).all()


@pytest.mark.parametrize(("distance", "most"), [(0.01, 0.01), (0.1, 0.05), (0.2, 0.08)])
def test_retrieved_rows_are_nearly_unbiased_where_fringes_ignored_are_not(distance, most) -> None:
    detector = xray.Detector(np.full(300, 1e7), PIXEL, blur=1e-6)
    jet = xray.RoundJet(np.array([0.05]), 50e-6, 2e-6)
    counts = xray.fresnel_counts(jet, WATER, detector, distance)
    folded = xray.contact_transmission(counts / 1e7, PIXEL, distance, WATER.delta_over_mu(0.05))
    known = {"shells": 1, "nuisances": ("amplitude", "slope"), "radius": 50e-6, "axis": 2e-6}
    found = xray.fit_row(1e7 * folded, WATER.absorber, xray.Detector(np.full(300, 1e7), PIXEL), **known)
    assert abs(found.mean_fraction - 0.05) < most


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"distance": 0.0}, "distance"),
        ({"nuisances": ("tilt",)}, "nuisances"),
        ({"nuisances": ("axis",)}, "radius.*neither"),
        ({"nuisances": ("radius", "axis", "blur")}, "blur.*0"),
        ({"good": np.arange(100) < 3}, "good.*4 pixels"),
        ({"saturation": 100.0}, "saturated"),
        ({"radius": -1.0}, "radius"),
        ({"shells": 90, "profile": "shells"}, "unknowns|tell apart"),
        ({"profile": "spline"}, "profile"),
        ({"profile": (0.0, 0.5, 0.4, 1.0)}, "knots"),
        ({"profile": (0.1, 1.0)}, "knots"),
        ({"taper": np.inf}, "taper"),
        ({"taper": 20 * PIXEL}, "taper.*fewer rows"),
    ],
)
def test_refusals(change, words) -> None:
    detector = xray.Detector(np.full(100, 1e4), PIXEL)
    counts = xray.fresnel_counts(xray.RoundJet(np.array([0.05]), 20e-6), WATER, detector, 0.1)
    arguments = {"distance": 0.1, **change}
    with pytest.raises(InputError, match=words):
        xray.fit_row_phase(counts, WATER, detector, **arguments)


def test_laws_in_the_form_of_the_row_fit() -> None:
    detector = xray.Detector(np.full(100, 1e6), PIXEL)
    jet = xray.RoundJet(np.array([0.05]), 20e-6)
    counts = xray.fresnel_counts(jet, WATER, detector, 0.1)
    law = xray.phase_law(WATER, 0.1, fitted=(), profile="shells")
    fit = law(counts, WATER.absorber, detector, shells=np.array([0.0, 1.0]), radius=20.2e-6, axis=0.0)
    assert fit.mean_fraction == pytest.approx(0.05, abs=1e-6)
    scaled = xray.Absorber(1.05 * WATER.absorber.solvent, 1.05 * WATER.absorber.contrast, WATER.absorber.air)
    assert law(counts, scaled, detector, shells=1).mean_fraction != pytest.approx(0.05, abs=1e-4)
    free = xray.phase_law(WATER, 0.101)(counts, WATER.absorber, detector, shells=1, nuisances=NUISANCES)
    assert free.values["distance"] == pytest.approx(0.1, rel=1e-4)
    assert free.values["refraction"] == pytest.approx(1.0, abs=1e-4)
    assert free.mean_fraction_std > fit.mean_fraction_std
    plain = xray.spectral_law(WATER)(xray.spectral_counts(jet, WATER, detector), WATER.absorber, detector, shells=1)
    assert plain.mean_fraction == pytest.approx(0.05, abs=1e-6)
