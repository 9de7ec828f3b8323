"""The map by penalised likelihood: its splines and equations against dense ones, its errors, its extremes, what is refused."""

import numpy as np
import pytest

from spinline import xray
from spinline.base.errors import InputError
from spinline.xray.map.band import assembled, factorised
from spinline.xray.map.basis import axial_basis, radial_basis
from spinline.xray.map.rows import expected_rows, row_curvature
from spinline.xray.map.smoothing import Penalty
from spinline.xray.row.forward import row_model
from spinline.xray.row.scoring import poisson_deviance

PIXEL = 0.67e-6
SOLUTION = xray.Absorber(531.9, -137.44, 0.6)  # PEO in water, 10 keV
ROWS, PIXELS = 100, 221
HEIGHTS = np.linspace(0, 1, ROWS)
RADIUS = 60e-6 / np.sqrt(1 + 3 * HEIGHTS)
AXIS = PIXEL * (3 + 2 * np.sin(3 * HEIGHTS))
NODES, SHARES = np.polynomial.legendre.leggauss(40)


def rise(x):
    return 1 / (1 + np.exp(-x))


def profile(r, z):
    """Two rises, first in the core, then at the rim."""
    return 0.05 + 0.03 * rise((z - 0.3) / 0.12) * np.exp(-((r / 0.6) ** 2)) + 0.05 * rise((z - 0.6) / 0.15) * r**2


def shells(edges):
    half = 0.5 * np.diff(edges)[:, None]
    r = edges[:-1, None] + half * (1 + NODES)
    share = half * SHARES * 2 * r / np.diff(edges**2)[:, None]
    return np.array([(share * profile(r, z)).sum(axis=1) for z in HEIGHTS])


TENTHS = np.linspace(0, 1, 11)
TRUE = shells(TENTHS)
MEAN = TRUE @ np.diff(TENTHS**2)


def image_of(phantom, fraction=profile, rows=range(ROWS), **more):
    """Share of the flat field's photons that each pixel gets, drifted, tilted, off centre."""
    return np.array(
        [
            phantom(
                lambda r, z=HEIGHTS[i]: fraction(r, z),
                RADIUS[i],
                flat=np.ones(PIXELS),
                pixel=PIXEL,
                solvent=531.9,
                contrast=-137.44,
                air=0.6,
                axis=AXIS[i],
                amplitude=1.005 + 0.003 * np.cos(4 * HEIGHTS[i]),
                slope=0.005 + 0.002 * HEIGHTS[i],
                along=200,
                parts=8,
                **more,
            )
            for i in rows
        ]
    )


MADE = {}


@pytest.fixture
def image(phantom):
    """The brute-force image, made once."""
    if not MADE:
        MADE["image"] = image_of(phantom)
    return MADE["image"]


def detector(photons, **more):
    return xray.Detector(np.full(PIXELS, float(photons)), PIXEL, **more)


# the parts


@pytest.mark.parametrize(("size", "error"), [(4, 1e-7), (14, 1e-7), (40, 2e-6)])
def test_chords_of_splines(size, error) -> None:
    """Averages over pixels, in radii, against Gauss quadrature between the knots; 1e-7 is 1e-9 of the counts at D R = 0.01."""
    basis = radial_basis(size)
    cells = basis.table.shape[0]
    knots = np.arange(size - 1) / (size - 2)

    def area(s):
        t = np.sqrt(1 - s) * cells
        cell = min(int(t), cells - 1)
        return (t - cell) ** np.arange(4) @ basis.table[cell]

    def chord(s):
        ends = np.unique(np.sqrt(np.maximum(knots**2 - s**2, 0)))
        half = 0.5 * np.diff(ends, prepend=0.0)[:, None]
        rho = np.hypot(s, ends[:, None] - half * (1 - NODES))
        return 2 * np.einsum("ig,igj->j", half * SHARES, basis(np.minimum(rho, 1.0)))

    for low, high in [(0.0, 0.01), (0.3, 0.305), (0.51, 0.52), (0.97, 0.98)]:
        exact = sum(0.5 * w * chord(low + 0.5 * (high - low) * (1 + x)) for x, w in zip(NODES, SHARES, strict=True))
        assert np.abs((area(high) - area(low)) / (high - low) - exact).max() < error


def test_splines_sum_to_one_and_shells_to_the_area() -> None:
    basis = radial_basis(14)
    assert np.abs(basis(np.linspace(0, 1, 50)).sum(axis=1) - 1).max() < 1e-14
    assert xray.shell_weights(TENTHS) @ basis.shells(TENTHS) == pytest.approx(basis.area, abs=1e-14)
    slope = (basis(np.array([1e-6])) - basis(np.array([0.0]))) / 1e-6
    assert np.abs(slope).max() < 1e-3  # even about the axis
    along = axial_basis(np.arange(30.0), 9)
    line = along.along(np.arange(9.0)[:, None])[:, 0]
    assert np.diff(line) == pytest.approx(6 / 29, rel=1e-12)


@pytest.mark.parametrize(("blur", "dark", "veil"), [(0.0, 0.0, 0.0), (1.2e-6, 300.0, 0.02), (0.3e-6, 0.0, 0.0)])
def test_a_row_is_that_of_the_row_model(blur, dark, veil) -> None:
    """Counts, slope and curvature against `RowModel` with 1,000 shells."""
    rng = np.random.default_rng(1)
    size, shell = 8, np.linspace(0, 1, 1001)
    one = xray.Detector(rng.uniform(1e5, 2e5, 200), PIXEL, np.array(dark), np.array(veil), blur)
    model = row_model(SOLUTION, one, shell)
    basis = radial_basis(size)
    local = np.concatenate((rng.uniform(0, 0.1, size), [70.3, 2.4, 1.01, 0.01, blur / PIXEL]))
    turn = np.zeros((1005, size + 5))
    turn[:1000, :size] = basis.shells(shell)
    turn[1000:, size:] = np.diag([PIXEL, PIXEL, 1, 1, PIXEL])
    mean, jacobian = model.evaluate(turn @ local)
    jacobian = jacobian @ turn
    beam = [np.ascontiguousarray(a[None]) for a in (one.flat, one.dark, one.veil)]
    matter = np.array([531.3 * PIXEL]), np.array([-137.44 * PIXEL])
    optics = basis.table, *matter, model._parts, model._reach, (0.0, 1.0)
    found = np.empty((1, 200))
    expected_rows(*beam, local[None], *optics, found)
    assert found[0] == pytest.approx(mean, rel=1e-7)
    counts, good = rng.poisson(mean).astype(float)[None], np.ones((1, 200))
    counts[0, 50] = 0.0
    good[0, 80:85] = 0.0
    fisher, slope, score = np.empty((1, size + 5, size + 5)), np.empty((1, size + 5)), np.empty((1, 4))
    row_curvature(counts, good, *beam, local[None], *optics, fisher, slope, score)
    weight = good[0] / mean
    true = jacobian.T @ (jacobian * weight[:, None])
    scale = np.sqrt(np.maximum(np.diag(true), 1e-300))
    assert np.abs(fisher[0] - true).max() < 2e-4 * scale.max() ** 2
    assert np.abs((fisher[0] - true) / np.outer(scale, scale)).max() < 2e-4
    assert np.abs((slope[0] - jacobian.T @ ((counts[0] - mean) * weight)) / scale).max() < 1e-3
    lit = good[0] > 0
    assert score[0, 0] == pytest.approx(poisson_deviance(counts[0, lit], mean[lit]), rel=1e-6)


def dense(band):
    splines, touched, n = band.shape[:3]
    out = np.zeros((splines, n, splines, n))
    for k in range(splines):
        for d in range(min(touched, splines - k)):
            out[k, :, k + d] = band[k, d]
            out[k + d, :, k] = band[k, d].T
    return out.reshape(splines * n, -1)


@pytest.mark.parametrize(("rows", "splines"), [(1, 1), (2, 2), (7, 3), (30, 4), (30, 5), (50, 11)])
def test_equations_against_dense_ones(rows, splines) -> None:
    rng = np.random.default_rng(splines)
    along, across = axial_basis(np.arange(rows, dtype=float), splines), radial_basis(5)
    penalty = Penalty.of(across, along, ("radius", "axis"))
    design = rng.standard_normal((rows, 20, 7))
    fisher, slope = np.einsum("inp,inq->ipq", design, design), rng.standard_normal((rows, 7))
    matrix, right = assembled(along, fisher, slope)
    weights = rng.uniform(0.5, 2, len(penalty.names))
    band = penalty.added(matrix, weights)
    values = np.array([[along.along(np.eye(splines)[:, [k]])[i, 0] for k in range(splines)] for i in range(rows)])
    assert dense(matrix) == pytest.approx(
        np.einsum("ik,il,ipq->kplq", values, values, fisher).reshape(7 * splines, -1), abs=1e-12
    )
    inverse = np.linalg.inv(dense(band))
    factor = factorised(band)
    assert factor.solve(right).ravel() == pytest.approx(inverse @ right.ravel(), abs=1e-12)
    assert factor.log_determinant == pytest.approx(np.linalg.slogdet(dense(band))[1], rel=1e-12, abs=1e-12)
    covariance = factor.covariance()
    part = dense(covariance)
    assert part[part != 0] == pytest.approx(inverse[part != 0], abs=1e-12)
    roughness = dense(band) - dense(matrix)
    c = rng.standard_normal((splines, 7))
    assert penalty.applied(c, weights).ravel() == pytest.approx(roughness @ c.ravel(), abs=1e-11)
    assert weights @ penalty.roughness(c) == pytest.approx(c.ravel() @ roughness @ c.ravel(), rel=1e-11, abs=1e-12)
    assert weights @ penalty.traces(covariance) == pytest.approx(np.trace(inverse @ roughness), rel=1e-11, abs=1e-12)
    assert penalty.prior(weights).sum() == pytest.approx(np.linalg.matrix_rank(roughness))
    draws = np.array([factor.draw(rng).ravel() for _ in range(3000)])
    assert np.abs(np.cov(draws.T).reshape(inverse.shape) - inverse).max() < 0.12 * np.abs(inverse).max()


def test_the_weights_are_the_likeliest() -> None:
    """At the weights found, the evidence from dense determinants (and the prior of the weights) has no slope."""
    rng = np.random.default_rng(8)
    along, across = axial_basis(np.arange(60.0), 12), radial_basis(6)
    penalty = Penalty.of(across, along, ("radius",))
    design = rng.standard_normal((60, 30, 7))
    z = np.arange(60) / 60
    true = np.stack([0.3 * np.sin(3 * z + j / 3) for j in range(7)], axis=1)
    data = np.einsum("inp,ip->in", design, true) + rng.standard_normal((60, 30))
    fisher, slope = np.einsum("inp,inq->ipq", design, design), np.einsum("inp,in->ip", design, data)
    matrix, right = assembled(along, fisher, slope)
    zero = np.zeros_like(right)
    weights, mode, settled = penalty.improved(matrix, right, zero, np.ones(4), 60)
    assert settled

    def evidence(logs):
        w = np.exp(logs)
        added = dense(penalty.added(matrix, w))
        eigen = np.linalg.eigvalsh(added - dense(matrix))
        best = right.ravel() @ np.linalg.solve(added, right.ravel())
        return 0.5 * (best + np.log(eigen[eigen > 1e-9 * eigen[-1]]).sum() - np.linalg.slogdet(added)[1] - logs.sum())

    logs = np.log(weights)
    assert mode.ravel() == pytest.approx(
        np.linalg.solve(dense(penalty.added(matrix, weights)), right.ravel()), rel=1e-9
    )
    for j in range(4):
        step = np.eye(4)[j]
        up, here, down = (evidence(logs + h * step) for h in (0.5, 0.0, -0.5))
        width = 1 / np.sqrt(4 * (2 * here - up - down))
        assert abs(up - down) * width < 0.25  # a quarter of the weight's own standard deviation
        assert max(evidence(logs + 3 * step), evidence(logs - 3 * step)) < here


@pytest.mark.parametrize(("splines", "order", "weight"), [(60, 3, 3e4), (100, 2, 3e3)])
def test_scatter_about_a_smooth_truth(splines, order, weight) -> None:
    """Errors from noise alone are (1 - 1/(2m))^(1/2) of the posterior's, away from the ends: the docstring of `map_smoothing`."""
    basis = axial_basis(np.arange(8.0 * splines), splines)
    assert basis.order == order
    band = np.zeros((splines, 4, 1, 1))
    band[:, :, 0, 0] = basis.penalty
    design = basis.along(np.eye(splines))
    counts = design.T @ design
    posterior = np.linalg.inv(counts + weight * dense(band))
    noise, all_of_it = (((design @ v) * design).sum(axis=1) for v in (posterior @ counts @ posterior, posterior))
    inner = slice(3 * splines, 5 * splines)
    assert noise[inner].mean() / all_of_it[inner].mean() == pytest.approx(1 - 0.5 / order, abs=0.01)


# the whole


def test_no_bias_under_drift_slope_and_offset(phantom) -> None:
    """Mean counts for 1e7 photons, nothing known beforehand, a fraction that the roughness lets pass: 0.2 of an error at most."""
    line = 0.04 + 0.03 * HEIGHTS
    counts = 1e7 * image_of(phantom, lambda r, z: 0.04 + 0.03 * z + 0 * r)
    fit = xray.fit_map(counts, SOLUTION, detector(1e7))
    assert fit.converged
    assert fit.warnings == ()
    assert np.abs((fit.mean_fraction - line) / fit.mean_fraction_std).max() < 0.2
    assert np.abs((fit.fraction - line[:, None]) / fit.fraction_std).max() < 0.2
    assert np.abs(fit.radius - RADIUS)[5:-5].max() < 0.01 * PIXEL
    assert np.abs(fit.axis - AXIS)[5:-5].max() < 0.005 * PIXEL
    for value, true, std in ((fit.radius, RADIUS, fit.radius_std), (fit.axis, AXIS, fit.axis_std)):
        off = (value - true) / std  # noiseless: what the smoothing takes from ends that bend
        assert np.abs(off).max() < 1
        assert np.sqrt((off**2).mean()) < 0.3
    assert fit.values["amplitude"] == pytest.approx(1.005 + 0.003 * np.cos(4 * HEIGHTS), abs=1e-5)
    assert xray.shell_weights(TENTHS) @ fit.fraction.T == pytest.approx(fit.mean_fraction, abs=1e-12)


@pytest.mark.parametrize("photons", [1e5, 1e7])
def test_errors_are_what_they_say(image, photons) -> None:
    """25 replicates of 100 rows against z 0.9 to 1.15 and 93 to 97 %, to 3 standard errors that the replicates themselves show.

    The whole campaign, 1,000 of 300 rows, is in benchmarks/bench_xray_map.py.
    """
    z = {"fraction": [], "mean": [], "radius": [], "axis": [], "misfit": []}
    for i in range(25):
        fit = xray.fit_map(xray.noisy_counts(photons * image, 5, i), SOLUTION, detector(photons))
        assert fit.converged
        z["fraction"].append((fit.fraction - TRUE) / fit.fraction_std)
        z["mean"].append((fit.mean_fraction - MEAN) / fit.mean_fraction_std)
        z["radius"].append((fit.radius - RADIUS) / fit.radius_std)
        z["axis"].append((fit.axis - AXIS) / fit.axis_std)
        z["misfit"].append(fit.misfit)
    z = {name: np.array(value) for name, value in z.items()}
    assert z.pop("misfit").mean() == pytest.approx(0, abs=0.8)
    for name, value in z.items():
        for one, low, high in ((value**2, 0.9**2, 1.15**2), (np.abs(value) < 1.96, 0.93, 0.97)):
            each = one.reshape(25, -1).mean(axis=1)
            spread = 3 * each.std(ddof=1) / 5
            assert each.mean() + spread > low, (name, each.mean(), spread)
            assert each.mean() - spread < high, (name, each.mean(), spread)
    assert abs(z["mean"].mean(axis=1).mean()) < 3 * z["mean"].mean(axis=1).std() / 5 + 0.05


@pytest.mark.parametrize("photons", [1e5, 1e7])
def test_far_closer_than_row_by_row_inversion(image, photons) -> None:
    """Against onion peeling of -ln T with axis, radius and beam known, averaged over ten shells; by 4 at least."""
    beam = (1.005 + 0.003 * np.cos(4 * HEIGHTS))[:, None] * (
        1 + (0.005 + 0.002 * HEIGHTS)[:, None] * np.linspace(-1, 1, PIXELS)
    )
    counts = xray.noisy_counts(photons * image, 6)
    fit = xray.fit_map(counts, SOLUTION, detector(photons))
    edges = PIXEL * (np.arange(PIXELS + 1) - 0.5 * PIXELS)
    peeled = np.empty_like(TRUE)
    for i in range(ROWS):
        chords = xray.shell_chords(RADIUS[i] * TENTHS, edges, AXIS[i])
        inside = chords.sum(axis=1) > 0
        line = -np.log(counts[i] / photons / beam[i])
        mu = np.linalg.lstsq(chords[inside], line[inside])[0]
        peeled[i] = (mu - 531.3) / -137.44
    ratio = np.sqrt(((peeled - TRUE) ** 2).mean() / ((fit.fraction - TRUE) ** 2).mean())
    assert ratio > 4


def test_blur_is_part_of_the_model_and_can_be_fitted(phantom) -> None:
    rows = range(40, 60)
    counts = xray.noisy_counts(1e7 * image_of(phantom, rows=rows, blur=1.2e-6), 2)
    for more in ({}, {"nuisances": ("radius", "axis", "amplitude", "slope", "blur")}):
        guess = 1.5e-6 if more else 1.2e-6
        fit = xray.fit_map(counts, SOLUTION, detector(1e7, blur=guess), **more)
        assert fit.converged
        assert abs(fit.misfit) < 4
        assert np.all(np.abs(fit.mean_fraction - MEAN[40:60]) < 4 * fit.mean_fraction_std)
        assert np.all(np.abs(fit.values["blur"] - 1.2e-6) <= 4 * fit.std["blur"] + 1e-15)


def test_one_row_is_like_a_row(image) -> None:
    counts = xray.noisy_counts(1e7 * image[50:51], 3)
    wide = xray.fit_map(counts, SOLUTION, detector(1e7))
    alone = xray.fit_row(counts, SOLUTION, detector(1e7), shells=14)  # as many as splines
    assert wide.converged
    assert abs(wide.mean_fraction[0] - alone.mean_fraction) < alone.mean_fraction_std
    assert wide.mean_fraction_std[0] == pytest.approx(alone.mean_fraction_std, rel=0.3)
    assert wide.radius_std[0] == pytest.approx(alone.std["radius"], rel=0.3)
    assert wide.limit_std[0] == pytest.approx(alone.limit_std, rel=0.05)


@pytest.mark.parametrize("rows", [2, 3, 5, 9])
def test_few_rows(image, rows) -> None:
    fit = xray.fit_map(xray.noisy_counts(1e7 * image[50 : 50 + rows], 3), SOLUTION, detector(1e7))
    assert fit.converged
    assert np.all(np.abs(fit.mean_fraction - MEAN[50 : 50 + rows]) < 4 * fit.mean_fraction_std)


def test_a_photon_a_pixel(image) -> None:
    """Geometry known: not biased. Nothing known: said to be useless."""
    known = {"nuisances": ("amplitude",), "radius": RADIUS, "axis": AXIS, "slope": 0.005 + 0.002 * HEIGHTS}
    z = []
    for i in range(12):
        counts = xray.noisy_counts(image, 7, i)
        assert (counts == 0).sum() > 5000
        fit = xray.fit_map(counts, SOLUTION, detector(1), **known)
        area = fit.radius**2 / (fit.radius**2).sum()
        draws = fit.draws(100, 1).mean_fraction @ area
        z.append(area @ (fit.mean_fraction - MEAN) / draws.std())
    assert abs(np.mean(z)) < 3 / np.sqrt(12)
    assert 0.5 < np.std(z) < 1.6
    free = xray.fit_map(counts, SOLUTION, detector(1))
    assert any("exceeds the fraction" in w for w in free.warnings)


def test_bad_pixels_rows_and_types(image) -> None:
    counts = xray.noisy_counts(1e6 * image, 4)
    whole = xray.fit_map(counts, SOLUTION, detector(1e6))
    single = xray.fit_map(counts.astype(np.float32), SOLUTION, [detector(1e6)] * ROWS)
    assert single.fraction == pytest.approx(whole.fraction, abs=1e-12)
    good = np.ones(counts.shape, dtype=bool)
    good[20, 60:64] = good[5] = good[70:80] = good[:, 17] = False
    spoiled = np.where(good, counts, np.nan)
    spoiled[33] = 0.0
    fit = xray.fit_map(spoiled, SOLUTION, detector(1e6), good=good)
    assert fit.converged
    assert not fit.used[[5, 33, 75]].any()
    assert fit.used.sum() == ROWS - 12
    assert np.isnan(fit.limit_std[[5, 33]]).all()
    assert np.isfinite(fit.fraction_std).all()
    assert np.all(fit.mean_fraction_std[70:80] > whole.mean_fraction_std[70:80])
    assert np.all(np.abs(fit.mean_fraction - MEAN) < 4.5 * fit.mean_fraction_std)
    assert any("row 33 without a count" in w for w in fit.warnings)
    assert any("11 rows (5, 70, 71, ...) masked" in w for w in fit.warnings)
    some = np.r_[0:40, 40:100:3]
    uneven = xray.fit_map(counts[some], SOLUTION, detector(1e6), z=some * PIXEL)
    assert np.all(np.abs(uneven.mean_fraction - MEAN[some]) < 4 * uneven.mean_fraction_std)


def test_what_is_wrong_is_said(image) -> None:
    counts = xray.noisy_counts(1e6 * image, 4)
    hot = counts.copy()
    hot[20, 110] = 0
    assert any("pixel 110 of row 20" in w for w in xray.fit_map(hot, SOLUTION, detector(1e6)).warnings)
    jump = counts * np.where(np.arange(ROWS) < 50, 1.0, 1.02)[:, None]
    assert any("jump" in w for w in xray.fit_map(jump, SOLUTION, detector(1e6)).warnings)
    cut = xray.Detector(np.full(150, 1e6), PIXEL)
    ends = xray.fit_map(counts[:, 35:185], SOLUTION, cut, radius=RADIUS, axis=AXIS)
    assert any("end of" in w for w in ends.warnings)
    dense = xray.Absorber(531.9 - 0.4 * 137.44, -137.44, 0.6)  # the same counts, another solvent: fractions 0.4 lower
    below = xray.fit_map(xray.noisy_counts(1e7 * image, 4), dense, detector(1e7))
    assert any("outside [0, 1]" in w for w in below.warnings)
    assert below.mean_fraction == pytest.approx(MEAN - 0.4, abs=0.02)


def test_a_fit_answers_anywhere(image) -> None:
    fit = xray.fit_map(xray.noisy_counts(1e7 * image, 4), SOLUTION, detector(1e7), shells=[0, 0.5, 1])
    r = np.linspace(0, 1, 21)
    every = fit.polymer_fraction(np.arange(ROWS)[:, None], r)
    std = fit.polymer_fraction_std(np.arange(ROWS)[:, None], r)
    assert every.shape == std.shape == (ROWS, 21)
    z = (every - profile(r, HEIGHTS[:, None])) / std
    assert np.sqrt((z**2).mean()) < 1.5
    assert fit.fraction.shape == (ROWS, 2)
    assert np.sqrt(np.diag(fit.fraction_covariance(7))) == pytest.approx(fit.fraction_std[7])
    draws = fit.draws(400, 5)
    assert draws.fraction.shape == (400, ROWS, 2)
    for name, std in [("mean_fraction", fit.mean_fraction_std), ("radius", fit.radius_std), ("axis", fit.axis_std)]:
        assert getattr(draws, name).std(axis=0) / std == pytest.approx(1, abs=0.2)
    assert (fit.draws(2, 5).fraction == draws.fraction[:2]).all()
    with pytest.raises(InputError, match="row"):
        fit.polymer_fraction(ROWS, 0.5)
    with pytest.raises(InputError, match="radius_ratio"):
        fit.polymer_fraction(0, 1.5)
    with pytest.raises(InputError, match="count"):
        fit.draws(-1)


@pytest.mark.slow
def test_ten_thousand_rows() -> None:
    """A slowly beading jet, 60 pixels wide."""
    rows, one = 10_000, xray.Detector(np.full(61, 1e6), PIXEL)
    radius = 12e-6 * (1 + 0.1 * np.sin(np.arange(rows) / 300))
    mean = np.array([xray.expected_counts(xray.RoundJet(np.array([0.05]), r), SOLUTION, one) for r in radius])
    fit = xray.fit_map(xray.noisy_counts(mean, 1), SOLUTION, one)
    assert fit.converged
    assert np.sqrt((((fit.mean_fraction - 0.05) / fit.mean_fraction_std) ** 2).mean()) < 1.3
    assert np.sqrt((((fit.radius - radius) / fit.radius_std) ** 2).mean()) < 1.2


COUNTS = 1e4 * np.array(
    [xray.expected_counts(xray.RoundJet(np.array([0.05]), 20e-6), SOLUTION, xray.Detector(np.ones(100), PIXEL))] * 4
)
ROW = xray.Detector(np.full(100, 1e4), PIXEL)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: xray.fit_map(COUNTS, xray.Absorber(531.9, 2.0), ROW), "contrast.*1 %"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, xray.Detector(ROW.flat, PIXEL, np.array(2e4))), "dark.*exceeds"),
        (lambda: xray.fit_map(0 * COUNTS, SOLUTION, ROW), "dark.*exceeds"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, saturation=9900.0), "saturated"),
        (lambda: xray.fit_map(COUNTS - 1e4, SOLUTION, ROW), "counts"),
        (lambda: xray.fit_map(COUNTS * np.nan, SOLUTION, ROW), "counts"),
        (lambda: xray.fit_map(COUNTS[0], SOLUTION, ROW), "counts.*not a map"),
        (lambda: xray.fit_map(COUNTS[:, :50], SOLUTION, ROW), "counts.*not a map"),
        (lambda: xray.fit_map([["a"] * 100], SOLUTION, ROW), "counts"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, [ROW, ROW]), "detector"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, [ROW] * 3 + [xray.Detector(ROW.flat, 1e-6)]), "detector"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, good=np.ones(100)), "good"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, good=np.zeros(100, dtype=bool)), "good"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, good=np.arange(100) < 3), "good"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, z=[0, 1, 1, 2]), "z"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, z=[0, 1]), "z"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, nuisances=("axis",)), "radius.*neither"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, nuisances=("radius",)), "axis.*neither"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, nuisances=("blur", "radius", "axis")), "blur"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, nuisances=("tilt",)), "nuisances"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, shells=0), "shells"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, radial_splines=3), "radial_splines"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, axial_splines=5), "axial_splines"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, radius=-1.0), "radius"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, axis=1.0), "axis"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, radius=[1e-5, 2e-5]), "radius"),
        (lambda: xray.fit_map(COUNTS, SOLUTION, ROW, slope=2.0), "slope"),
    ],
)
def test_refusals(call, words) -> None:
    with pytest.raises(InputError, match=words):
        call()
