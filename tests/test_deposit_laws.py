"""Laws of mats: permeability, random networks, orientation, diameters, and measured tables."""

import mpmath as mp
import numpy as np
import pytest
from scipy import stats

import spinline.deposit as dep
from spinline.base.errors import InputError, SpinlineWarning
from spinline.deposit.diameters import diameter_density, moments
from spinline.deposit.orientation import isotropic_order, orientation_density, tensor
from spinline.deposit.permeability import LAWS, quality_factor
from spinline.deposit.poisson_lines import (
    CELL_VARIATION,
    SAMPSON_VARIATION,
    plane_distance_survival,
    sampson_survival,
)

# k/a^2 at solidity 0.05, 0.1, 0.2
TABLE = {
    "davies": (5.551, 1.872, 0.4826),
    "jackson-james": (6.194, 2.057, 0.5088),
    "drummond-tahir-square": (4.040, 1.266, 0.3094),
    "drummond-tahir-along": (8.092, 2.554, 0.6417),
    "drummond-tahir-hexagon": (3.994, 1.251, 0.3074),
    "kuwabara": (3.986, 1.247, 0.3059),
    "happel": (5.002, 1.653, 0.4290),
    "kozeny-carman": (17.15, 3.645, 0.6400),
    "tomadakis-through": (12.10, 2.572, 0.4507),
    "tomadakis-in-plane": (17.34, 3.751, 0.6836),
    "tomadakis-3d": (15.30, 3.303, 0.6007),
    "spielman-goren": (5.542, 1.683, 0.3506),
    "spielman-goren-3d": (7.536, 2.498, 0.6583),
}


@pytest.mark.parametrize("law", LAWS)
def test_permeability_laws_to_four_digits(law):
    found = LAWS[law].ratio(np.array([0.05, 0.1, 0.2]))
    for value, expected in zip(found, TABLE[law], strict=True):
        assert float(f"{value:.4g}") == expected
    inside = [phi for phi in (0.05, 0.1, 0.2) if LAWS[law].least <= phi <= LAWS[law].most]
    a = 3e-7
    for phi in inside:
        k = float(dep.permeability_of(law, phi, a))
        assert k == pytest.approx(float(LAWS[law].ratio(np.array(phi))) * a * a, rel=1e-14)


@pytest.mark.parametrize("law", LAWS)
def test_laws_fall_with_solidity_and_give_nan_outside(law):
    rule = LAWS[law]
    phi = np.linspace(rule.least, rule.most, 60)[1:]
    assert (np.diff(dep.permeability_of(law, phi, 1.0)) < 0).all()
    assert (dep.permeability_of(law, phi, 1.0) > 0).all()
    with pytest.warns(SpinlineWarning, match="outside the range"):
        out = dep.permeability_of(law, [rule.most * 1.01, 0.5 * (rule.least + rule.most)], 1.0)
    assert np.isnan(out[0])
    assert np.isfinite(out[1])


def test_spielman_goren_against_mpmath():
    for phi in (1e-3, 0.01, 0.3):
        s = mp.findroot(
            lambda s, phi=phi: mp.mpf(1) / 2 + s * mp.besselk(1, 1 / s) / mp.besselk(0, 1 / s) - 1 / (4 * mp.mpf(phi)),
            float(np.sqrt(dep.permeability_of("spielman-goren", phi, 1.0))),
        )
        assert float(dep.permeability_of("spielman-goren", phi, 1.0)) == pytest.approx(float(s**2), rel=1e-11)


def test_slip_of_a_nanofibre_in_air():
    with pytest.warns(SpinlineWarning, match="extrapolated"):
        gain = dep.slip_permeability([0.05, 0.1, 0.2], 0.44) / dep.slip_permeability([0.05, 0.1, 0.2], 0.0)
    np.testing.assert_allclose(gain, [1.265, 1.380, 1.611], atol=5e-4)
    np.testing.assert_allclose(dep.slip_permeability(0.1, 0.0), LAWS["kuwabara"].ratio(np.array(0.1)), rtol=1e-14)


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: dep.permeability_of("darcy", 0.1, 1.0), "mat.permeability"),
        (lambda: dep.permeability_of("davies", 0.0, 1.0), "solidity"),
        (lambda: dep.permeability_of("davies", 1.0, 1.0), "solidity"),
        (lambda: dep.permeability_of("davies", np.nan, 1.0), "solidity"),
        (lambda: dep.permeability_of("davies", 0.1, -1.0), "radius"),
        (lambda: dep.slip_permeability(0.1, -0.1), "knudsen"),
        (lambda: dep.pressure_drop(1e-5, 0.0, 0.05), "permeability"),
        (lambda: quality_factor(1.0, 10.0), "efficiency"),
    ],
)
def test_laws_refuse_by_name(call, field):
    with pytest.raises(InputError) as error:
        call()
    assert error.value.field == field


def test_pressure_drop_and_quality():
    assert float(dep.pressure_drop(2e-5, 2e-13, 0.05, 1.8e-5)) == pytest.approx(90.0)
    assert quality_factor(0.999, 100.0) == pytest.approx(-np.log(0.001) / 100)


# -- random networks -----------------------------------------------------------------------------


def test_numbers_of_random_networks():
    np.testing.assert_allclose(
        dep.ball_probability(0.012, 2, [0, 1, 2, 4]), [0.860023, 0.712274, 0.547066, 0.257389], atol=5e-7
    )
    np.testing.assert_allclose(dep.sampson_mean_radius([0.8, 0.9, 0.95]), [2.676139, 6.163166, 13.126711], atol=5e-7)
    assert round(CELL_VARIATION, 5) == 1.98363
    assert round(SAMPSON_VARIATION, 6) == 0.788124
    r = np.linspace(0, 60, 60001)
    law = sampson_survival(r, 2.676139)
    assert np.trapezoid(law, r) == pytest.approx(2.676139, rel=1e-6)  # its mean
    assert np.isnan(dep.sampson_mean_radius(1e-9))


def plane_lines(tau, side, rng):
    """Directed lines (p, angle) of a Poisson process that can meet a square about the origin."""
    reach = side / np.sqrt(2)
    n = rng.poisson(2 * tau * reach)
    return rng.uniform(-reach, reach, n), rng.uniform(0, np.pi, n)


def within_three_errors(sample, expected):
    sample = np.asarray(sample)
    error = sample.std(axis=0, ddof=1) / np.sqrt(len(sample))
    assert (np.abs(sample.mean(axis=0) - expected) < 3 * error).all(), (sample.mean(axis=0), expected, error)


def test_poisson_lines_in_the_plane_20_seeds():
    """Crossings, lines, coverage, distances: exact geometry against theory within 3 standard errors."""
    tau, a, side, seeds = 0.04, 1.5, 500.0, 20
    vertices, chord_lengths, covered, far = [], [], [], []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        p, theta = plane_lines(tau, side, rng)
        c, s = np.cos(theta), np.sin(theta)
        det = c[:, None] * s[None] - s[:, None] * c[None]
        with np.errstate(divide="ignore", invalid="ignore"):
            x = (p[:, None] * s[None] - p[None] * s[:, None]) / det
            y = (c[:, None] * p[None] - c[None] * p[:, None]) / det
        inside = (np.abs(x) < side / 2) & (np.abs(y) < side / 2)
        crossings = np.triu(inside, 1).sum()
        edge = side / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        value = edge @ np.stack([c, s]) - p
        chords = int(((value > 0).any(axis=0) & (value < 0).any(axis=0)).sum())
        vertices.append(crossings / side**2)
        chord_lengths.append(chords)
        at = rng.uniform(-side / 2, side / 2, (4000, 2))
        near = np.abs(at @ np.stack([c, s]) - p).min(axis=1)
        covered.append((near < a).mean())
        far.append([(near[near > a] > a + r).mean() for r in (2.0, 5.0, 10.0)])
    within_three_errors(vertices, dep.vertex_density(tau))
    within_three_errors(chord_lengths, 4 * side * tau / np.pi)  # Cauchy: lines that meet the square
    within_three_errors(covered, 1 - dep.open_share(tau, a))
    within_three_errors(far, plane_distance_survival(tau, [2.0, 5.0, 10.0]))


def test_package_measures_poisson_lines_as_theory_has_them_20_seeds():
    """The same law through the package: stamped fibres, its distances and openings, within 3 standard errors."""
    tau, a, n, seeds = 0.03, 2.0, 700, 20
    share, fits, areas = [], [], []
    radii = np.array([2.0, 5.0, 10.0])
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        p, theta = plane_lines(tau, n, rng)
        along = np.stack([-np.sin(theta), np.cos(theta)], -1)
        middle = np.stack([p * np.cos(theta), p * np.sin(theta)], -1) + n / 2
        ends = [np.column_stack([middle + sign * n * along, np.full(p.size, 0.5)]) for sign in (-1, 1)]
        image = dep.stamp(ends[0], ends[1], a, (n, n, 1))[..., 0]
        share.append(1 - image.mean())
        fits.append(dep.ball_fits(image, radii))
        areas.append(dep.open_areas(image).mean)
    # a cell between lines keeps its law when they are given width, if it is not closed (Miles): the mean stays pi/tau^2
    within_three_errors(share, dep.open_share(tau, a))
    within_three_errors(fits, dep.open_share(tau, a + radii))
    within_three_errors(areas, dep.mean_cell_area(tau))


def test_ogston_in_space_layered_and_isotropic():
    """Exact distances to random lines: 10 boxes of 64^3, 3 standard errors (and both orientation laws)."""
    nu, a, size, radii = 0.012, 2.0, 64.0, np.array([0.0, 1.0, 2.0, 4.0])
    for layered in (True, False):
        found = []
        for seed in range(10):
            rng = np.random.default_rng([seed, layered])
            reach = size  # ball of lines that can come near
            n = rng.poisson(nu * np.pi * reach**2)
            if layered:
                phi = rng.uniform(0, 2 * np.pi, n)
                t = np.stack([np.cos(phi), np.sin(phi), np.zeros(n)], -1)
            else:
                t = rng.standard_normal((n, 3))
                t /= np.linalg.norm(t, axis=1)[:, None]
            u = np.cross(t, np.where(np.abs(t[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]]))
            u /= np.linalg.norm(u, axis=1)[:, None]
            v = np.cross(t, u)
            r, psi = reach * np.sqrt(rng.uniform(size=n)), rng.uniform(0, 2 * np.pi, n)
            foot = (r * np.cos(psi))[:, None] * u + (r * np.sin(psi))[:, None] * v
            at = rng.uniform(-size / 2, size / 2, (3000, 3))
            gap = np.full(3000, np.inf)
            for k in range(n):
                w = at - foot[k]
                gap = np.minimum(gap, np.sqrt(np.maximum((w**2).sum(1) - (w @ t[k]) ** 2, 0)))
            found.append([(gap > a + ball).mean() for ball in radii])
        found = np.asarray(found)
        error = found.std(axis=0, ddof=1) / np.sqrt(10)
        assert (np.abs(found.mean(axis=0) - dep.ball_probability(nu, a, radii)) < 3 * error).all()


def test_half_a_voxel_is_taken_off():
    """A wall: the distance of the centre of the n-th voxel to its face is n - 1/2."""
    box = np.zeros((3, 3, 12), dtype=bool)
    box[..., 0] = True
    from spinline.deposit.pores import distance_to_solid

    np.testing.assert_array_equal(distance_to_solid(box)[1, 1], np.r_[0, np.arange(1, 12) - 0.5])


# -- orientation ---------------------------------------------------------------------------------


def test_order_of_known_directions():
    assert dep.order_of([0.3, 0.3 - np.pi]) == pytest.approx((1.0, 0.3))
    assert dep.order_of([0.0, np.pi / 2]).order_parameter == pytest.approx(0, abs=1e-15)
    assert dep.order_of([0.0, np.pi / 2], [3.0, 1.0]) == pytest.approx((0.5, 0.0))
    even = np.linspace(0, np.pi, 1000, endpoint=False)
    assert dep.order_of(even).order_parameter < 1e-14


def test_isotropic_sample_is_not_of_order_zero():
    rng = np.random.default_rng(2)
    found = [dep.order_of(rng.uniform(0, np.pi, 50)).order_parameter for _ in range(4000)]
    assert np.mean(found) == pytest.approx(float(isotropic_order(50)), abs=4 * np.std(found) / np.sqrt(4000))


def test_hermans_of_mats_and_bundles():
    phi = np.linspace(0, 2 * np.pi, 3600, endpoint=False)
    flat = tensor(np.stack([np.cos(phi), np.sin(phi), 0 * phi], -1))
    assert dep.hermans(flat, [1, 0, 0]) == pytest.approx(0.25, abs=1e-12)
    assert dep.hermans(flat, [0, 0, 5]) == pytest.approx(-0.5, abs=1e-12)
    assert dep.hermans(tensor([[0, 3.0, 0], [0, -1.0, 0]]), [0, 1, 0]) == pytest.approx(1.0, abs=1e-12)


def test_density_of_orientation_integrates_to_one():
    centre, density = orientation_density(np.random.default_rng(1).uniform(-9, 9, 5000), bins=24)
    assert density.sum() * np.pi / 24 == pytest.approx(1)
    assert centre[0] == pytest.approx(-np.pi / 2 + np.pi / 48)


def test_image_orientation_of_stripes():
    x, y = np.mgrid[:128, :128]
    for angle in (0.0, 0.4, 1.2, -0.9):
        image = np.sin(0.4 * (-np.sin(angle) * x + np.cos(angle) * y))
        found = dep.image_orientation(image, 1.5)
        assert found.order_parameter > 0.97
        assert np.mod(found.director - angle + np.pi / 2, np.pi) - np.pi / 2 == pytest.approx(0, abs=0.02)
    with pytest.raises(InputError, match="one grey"):
        dep.image_orientation(np.ones((20, 20)))


# -- diameters -----------------------------------------------------------------------------------


def test_lognormal_numbers_and_a_sample():
    law = dep.lognormal(300.0, 90.0)
    assert (round(law.mu, 6), round(law.s, 6)) == (5.660694, 0.293560)
    assert (round(law.median, 3), round(law.rms, 3), round(law.d32, 3)) == (287.348, 313.209, 356.430)
    d = stats.lognorm(law.s, scale=law.median).rvs(400000, random_state=1)
    assert moments(d)[0] == pytest.approx(300, rel=2e-3)
    assert moments(d)[1] == pytest.approx(90, rel=6e-3)
    assert moments(d, weight="volume")[0] == pytest.approx(law.d32, rel=3e-3)
    edges, density = diameter_density(d, edges=np.linspace(1, 2000, 300))
    assert np.sum(density * np.diff(edges)) == pytest.approx(1, abs=1e-4)


def test_one_diameter_is_a_distribution_too():
    edges, density = diameter_density([3e-7])
    assert np.sum(density * np.diff(edges)) == pytest.approx(1)
    assert moments([3e-7]) == (3e-7, 0.0)


def test_comparison_covers_and_detects():
    """Intervals of the ratio of means hold 1 in about 95 % of same-law pairs, and leave it out where means differ by a fifth."""
    rng = np.random.default_rng(3)
    hits = 0
    for k in range(40):
        one, two = rng.lognormal(0, 0.3, 150), rng.lognormal(0, 0.3, 200)
        hits += not dep.compare_diameters(one, two, resamples=100, seed=k).mean_differs
    assert 33 <= hits <= 40
    shifted = dep.compare_diameters(one, 1.2 * two, seed=1)
    assert shifted.mean_differs
    assert shifted.mean_ratio[1] < 1.2 < shifted.mean_ratio[2]
    assert shifted.distance[0] > 0.15
    with pytest.raises(InputError, match="two or more"):
        dep.compare_diameters([1.0], two)


@pytest.mark.parametrize(
    ("text", "options", "expected"),
    [
        ("Diameter (nm)\n300\n420\n", {}, [3e-7, 4.2e-7]),
        ("n,Fiber Radius [um],note\n1,0.15,a\n2,0.21,b\n", {}, [3e-7, 4.2e-7]),
        ("Diameter (px)\tCount\n30\t5\n42\t7\n", {"pixel_size": 1e-8}, [3e-7, 4.2e-7]),
        ("Diameter (um);Length (um)\n0,30;5\n0,42;7\n", {}, [3e-7, 4.2e-7]),
        ("300\n420\n", {"unit": "nm"}, [3e-7, 4.2e-7]),
        ("Diameter (nm)\n300\n\n0\nNaN\n420\n", {}, [3e-7, 4.2e-7]),
        ("diameter\n300\n420\n", {"unit": "nm"}, [3e-7, 4.2e-7]),
    ],
)
def test_measured_diameters_of_many_tables(tmp_path, text, options, expected):
    path = tmp_path / "d.csv"
    path.write_text(text, encoding="utf-8")
    found = dep.read_diameters(path, **options)
    np.testing.assert_allclose(found.diameter, expected, rtol=1e-12)
    if "Count" in text or "Length" in text:
        np.testing.assert_array_equal(found.weight, [5, 7])


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("", {}, "empty"),
        ("Diameter\n300\n", {}, "unit"),
        ("Diameter (px)\n300\n", {}, "pixel"),
        ("Diameter (inch)\n300\n", {}, "unit that is not known"),
        ("Diameter (nm)\n300\n", {"unit": "um"}, "contradicts"),
        ("Diameter (nm),Radius (nm)\n300,150\n", {}, "2 columns"),
        ("a,b\n1,2\n", {}, "no column"),
        ("Diameter (nm)\n-3\n0\n", {}, "no diameter above 0"),
        ("Diameter (nm)\n300\n", {"column": "width"}, "no such column"),
        ("Diameter (nm)\n300\n", {"unit": "furlong"}, "not known"),
    ],
)
def test_measured_diameters_refuse_by_name(tmp_path, text, options, words):
    path = tmp_path / "d.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        dep.read_diameters(path, **options)
    with pytest.raises(InputError, match="is not a file"):
        dep.read_diameters(tmp_path / "absent.csv")
