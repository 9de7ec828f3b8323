"""What a jet with given parameters would show, against independent integrations and closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from spinline.base.errors import InputError
from spinline.fit.model import PARAMETERS, ForwardModel
from spinline.fit.observations import Observation
from spinline.fit.scene_model import forward_model, typical_relaxation_time
from spinline.rheology.vapour import air_kinematic_viscosity
from spinline.rheology.volatile import Volatile
from spinline.scene import load_scene
from spinline.setup.air import Air

VALUES = {
    "k": 0.9,
    "beta": 0.47,
    "initial_radius": 125e-6,
    "flow_rate": 8.9e-10,
    "volume_fraction": 0.05,
    "relaxation_time": 0.008,
    "evaporation": 1.0,
    "fraction_scale": 1.0,
    "fraction_offset": 0.0,
    "length_scale": 1.0,
    "origin": 0.0,
}
R0, K, BETA, PHI, THETA, Q = (
    VALUES[n] for n in ("initial_radius", "k", "beta", "volume_fraction", "relaxation_time", "flow_rate")
)
V0 = Q / (np.pi * R0**2)
Z = np.array([2e-5, 1.4e-4, 5e-4, 1.3e-3, 2.9e-3, 4.9e-3])
ACETONE = Air(
    (Volatile.build("acetone", 293.15, chi=0.3),),
    np.ones(1),
    air_kinematic_viscosity(293.15),
    0.0,
    "flory-huggins",
    None,
    0.0,
    "mass",
)


def model(**options):
    return ForwardModel("power-law", VALUES, 5e-3, **options)


def velocity(z):
    return np.maximum(K**2 * (z / R0) ** (2 * BETA), 1.0)


def slope(z):
    return 2 * BETA * K**2 * (z / R0) ** (2 * BETA - 1) / R0


def walk(stretch, phi=PHI):
    """xi_perp / xi_0, Eq. (36), as printed."""
    return np.sinh(3 * phi) / phi / (np.cosh(3 * phi * stretch) + 2 * np.cosh(3 * phi))


def from_nozzle(right, first):
    """Integral from the nozzle to every place in two pieces, before and beyond the onset; right(z, y, whether beyond)."""
    onset = R0 * K ** (-1 / BETA)
    before = solve_ivp(
        lambda z, y: right(z, y, False),
        (0, onset),
        [first],
        t_eval=np.append(Z[onset > Z], onset),
        rtol=1e-12,
        atol=1e-14,
        method="DOP853",
    )
    after = solve_ivp(
        lambda z, y: right(z, y, True),
        (onset, Z[-1]),
        before.y[:, -1],
        t_eval=Z[onset <= Z],
        rtol=1e-12,
        atol=1e-14,
        method="DOP853",
    )
    return np.concatenate((before.y[0, :-1], after.y[0]))


def test_affine_jet_is_the_closed_forms():
    seen = model().predict(Z)
    v = velocity(Z)
    np.testing.assert_allclose(seen.radius, R0 / np.sqrt(v), rtol=1e-13)
    np.testing.assert_allclose(seen.core, np.minimum(PHI / walk(v) ** 2, 1), rtol=1e-12)
    np.testing.assert_allclose(seen.mean, PHI, rtol=2.3e-16)
    assert seen.core[0] == pytest.approx(0.050752, abs=5e-7)  # the walk at rest, Eq. (40) left


def test_published_contraction():
    """xi_perp/xi_0 at phi = 0.05 and V = 20 is 0.24906632."""
    seen = model().predict(R0 * (20 / K**2) ** (1 / (2 * BETA)))
    assert seen.core[0] == pytest.approx(0.05 / 0.24906632**2, rel=1e-7)


def test_relaxing_strands_are_an_independent_integration():
    seen = model(relaxation=True).predict(Z)

    def right(z, a, beyond):
        v = V0 * velocity(z)
        return 2 * V0 * (slope(z) if beyond else 0.0) * a / v - (a - 1) / (THETA * v)

    np.testing.assert_allclose(seen.stretch, np.sqrt(from_nozzle(right, 1.0)), rtol=2e-6)
    np.testing.assert_allclose(seen.core, np.minimum(PHI / walk(seen.stretch) ** 2, 1), rtol=1e-12)


def test_drying_is_an_independent_integration():
    seen = model(drying=ACETONE).predict(Z, {"evaporation": 2.5})
    (solvent,) = ACETONE.volatiles
    nu = ACETONE.viscosity

    def right(z, left, beyond):
        phi = PHI / left[0]
        r = R0 * np.sqrt(left[0] / velocity(z))
        sh = 0.495 * np.cbrt(2 * r * V0 * velocity(z) / nu) * np.sqrt(nu / solvent.diffusivity)
        activity = (1 - phi) * np.exp(phi + 0.3 * phi**2)
        return [-2.5 * np.pi * solvent.diffusivity * sh * solvent.saturation * activity / Q]

    left = from_nozzle(right, 1.0)
    assert left[-1] < 0.9
    np.testing.assert_allclose(seen.remaining, left, rtol=1e-9)
    np.testing.assert_allclose(seen.radius, R0 * np.sqrt(left / velocity(Z)), rtol=1e-9)
    np.testing.assert_allclose(seen.mean, PHI / left, rtol=1e-9)


def test_drying_slows_relaxation_by_the_mass_fraction():
    q = 0.7
    seen = model(relaxation=True, drying=ACETONE, density_ratio=q, relaxation_exponent=2.0).predict(Z)
    along = model(drying=ACETONE)

    def mass(phi):
        return phi / (phi + (1 - phi) * q)

    def right(z, a):
        v = V0 * velocity(z)
        phi = float(along.predict(z).mean[0])
        theta = THETA * (mass(phi) / mass(PHI)) ** 2
        return 2 * V0 * slope(z) * a / v - (a - 1) / (theta * v)

    onset = R0 * K ** (-1 / BETA)  # at rest up to there
    end = solve_ivp(right, (onset, Z[-1]), [1.0], rtol=1e-7, atol=1e-9).y[0, -1]
    assert seen.stretch[-1] == pytest.approx(np.sqrt(end), rel=3e-5)  # theta is interpolated: second order in the step


def test_limits_of_the_relaxation_time():
    affine = model().predict(Z)
    slow, fast = (model(relaxation=True).predict(Z, {"relaxation_time": t}) for t in (1e6, 1e-9))
    np.testing.assert_allclose(slow.stretch, affine.stretch, rtol=1e-5)
    np.testing.assert_allclose(fast.stretch, 1.0, atol=1e-5)
    for close in (1e1, 1e2):  # first order in 1/theta
        near = model(relaxation=True).predict(Z[-1:], {"relaxation_time": close}).stretch
        error = 1 - near / affine.stretch[-1]
        part, _ = quad(
            lambda z: (1 - velocity(z) ** -2.0) / (V0 * velocity(z)), 0, Z[-1], points=[R0 * K ** (-1 / BETA)]
        )
        assert error[0] == pytest.approx(part / (2 * close), rel=2e-3)


@pytest.mark.parametrize("effects", [{}, {"relaxation": True}, {"drying": ACETONE}])
def test_polymer_is_conserved_across_the_section(effects):
    one = model(**effects)
    seen = one.predict(np.linspace(0, 4.9e-3, 60))
    np.testing.assert_allclose(seen.core * seen.core_radius_ratio**2, seen.mean, rtol=1e-12)
    edges = np.linspace(0, 1, 8)
    z = np.repeat(np.linspace(1e-4, 4.9e-3, 9), 7)
    blank = np.full(z.size, 0.1)
    rings = Observation("shell", z, blank, blank, np.tile(edges[:-1], 9), np.tile(edges[1:], 9))
    (shown,) = one.measured([rings])
    area = np.diff(edges**2)
    np.testing.assert_allclose(shown.reshape(9, 7) @ area, one.predict(z[::7]).mean, rtol=1e-12)


def test_calibration_is_that_of_the_instrument():
    z = np.linspace(1e-4, 4e-3, 7)
    calibrated = {"length_scale": 1.1, "origin": 3e-5, "fraction_scale": 0.9, "fraction_offset": 0.02}
    parts = [Observation(kind, z, np.full(7, 0.1), np.full(7, 0.1)) for kind in ("radius", "mean", "core", "chord")]
    radius, mean, core, chord = model().measured(parts, calibrated)
    true = model().predict((z - 3e-5) / 1.1)
    np.testing.assert_allclose(radius, 1.1 * true.radius)
    np.testing.assert_allclose(mean, 0.9 * true.mean + 0.02)
    np.testing.assert_allclose(core, 0.9 * true.core + 0.02)
    np.testing.assert_allclose(chord, 0.9 * np.sqrt(true.core * true.mean) + 0.02)


def test_places_in_any_order_and_before_the_nozzle():
    one = model(relaxation=True)
    z = np.array([3e-3, -1e-4, 1e-3, 0.0, 3e-3])
    seen = one.predict(z)
    assert seen.stretch[0] == seen.stretch[4]
    assert seen.radius[1] == seen.radius[3] == R0
    np.testing.assert_allclose(seen.stretch[2], one.predict(1e-3).stretch[0], rtol=1e-6)


def test_every_corner_of_the_parameters_gives_numbers():
    rng = np.random.default_rng(5)
    one = model(relaxation=True)
    names = [n for n in one.names if n not in ("flow_rate", "origin", "length_scale", "initial_radius")]
    for _ in range(60):
        values = {}
        for name in names:
            kind = PARAMETERS[name]
            share = rng.choice([0.0, 1.0, rng.random()])
            values[name] = (
                kind.low * (kind.high / kind.low) ** share if kind.log else kind.low + share * (kind.high - kind.low)
            )
        seen = one.predict(Z, values)
        for name, array in seen.__dict__.items():
            assert np.isfinite(array).all(), (name, values)
        assert (seen.core <= 1).all()
        assert (seen.core_radius_ratio <= 1).all()


def test_models_of_scenes():
    one = forward_model(load_scene("peo5-water"), relaxation=True, values={"relaxation_time": 0.01})
    assert one.values["volume_fraction"] == pytest.approx(0.0444256, abs=1e-7)
    assert "relaxation_time" in one.names
    assert "evaporation" not in one.names
    assert typical_relaxation_time(load_scene("peo5-water")) == pytest.approx(1 / 113.77, rel=1e-3)
    wet = load_scene("peo5-water", ["ambient.relative_humidity=0.4"])
    lost = 1 - forward_model(wet, evaporation=True).predict(5e-3).remaining[0]
    assert 0.001 < lost < 0.004


@pytest.mark.parametrize(
    ("scene", "effects", "field"),
    [
        ("peo5-water", {"relaxation": True}, "solution.relaxation_time"),
        ("peo5-water", {"evaporation": True}, "ambient.relative_humidity"),
        ("pvp-jetspin", {}, "jet.profile"),
    ],
)
def test_what_a_scene_lacks_is_named(scene, effects, field):
    with pytest.raises(InputError) as caught:
        forward_model(load_scene(scene), **effects)
    assert caught.value.field == field
    assert caught.value.remedy
