"""The thread of the envelope: its limit without inertia is the race, its bend the fastest of the dispersion, its extremes answered."""

import numpy as np
import pytest

from spinline.base.constants import EPS0
from spinline.base.errors import InputError
from spinline.jetprofile.blown.drag import normal_drag
from spinline.jetprofile.envelope import envelope, fastest_wave, held_radius, onset_radius
from spinline.jetprofile.whipping import thinning

JET = {
    "charge_density": 500.0,
    "surface_tension": 0.035,
    "extensional_viscosity": 50.0,
    "evaporation": 3e-11,
    "volume_fraction": 0.08,
    "flow_rate": 1e-6 / 3600,
    "gap": 0.15,
    "start": 3e-5,
    "field": 1e5,
    "power": 4.8,
    "solid_fraction": 0.7,
}


def of(**changes):
    return envelope(**(JET | changes))


ONE, TWO = ((1.0,), (1.0,)), ((0.6, 0.4), (0.6, 7.0))


@pytest.mark.parametrize("mixture", [ONE, TWO], ids=["one solvent", "two"])
@pytest.mark.parametrize("gap", [0.15, 1e-3])
@pytest.mark.parametrize("tension", [0.0035, 0.035, 0.35])
def test_without_inertia_air_and_field_it_is_the_thinning(gap, tension, mixture):
    speed = JET["flow_rate"] / np.pi / JET["start"] ** 2
    names = (
        "charge_density",
        "extensional_viscosity",
        "evaporation",
        "volume_fraction",
        "start",
        "power",
        "solid_fraction",
    )
    known = {name: JET[name] for name in names}
    race = thinning(**known, surface_tension=tension, flight_time=gap / speed, steps=1000, mixture=mixture)
    light = {"field": 0.0, "density": 1e-6, "air_density": 0.0, "surface_tension": tension, "gap": gap}
    light["mixture"] = mixture
    errors = []
    for fraction in (0.1, 0.025):
        found = of(**light, fraction=fraction)
        errors.append(abs(np.log(found.radius / race.radius)))
        assert found.wet == race.wet
    assert errors[1] < 1e-3


def test_a_mixture_of_one_is_that_one():
    pure = of()
    for mixture in (ONE, ((1.0, 0.0), (1.0, 9.0)), ((0.3, 0.7), (1.0, 1.0))):
        found = of(mixture=mixture)
        for name in ("radius", "time", "envelope_radius", "axial_speed"):
            assert float(getattr(found, name)) == pytest.approx(float(getattr(pure, name)), rel=1e-10)


def test_heavier_jets_keep_what_they_have():
    """Inertia lets loops coast past where the race ends; air slows them."""
    vacuum = of(field=0.0, air_density=0.0)
    still = of(field=0.0, air_density=0.0, density=1e-6)
    air = of(field=0.0)
    assert vacuum.radius < still.radius < air.radius


def test_steps_do_not_decide():
    fine = of(fraction=0.0125)
    for fraction in (0.2, 0.1, 0.05):
        found = of(fraction=fraction)
        assert abs(np.log(found.radius / fine.radius)) < 0.02 * fraction
        assert found.error < 0.03 * fraction
    assert 1 < fine.axial_speed < 20
    assert 5e-3 < fine.envelope_radius < 0.1


def test_the_bend_is_the_fastest_of_the_dispersion():
    a, eta, rho = 2e-5, 20.0, 950.0
    for stress in (1e3, 1e5, 1e7):
        k, growth = fastest_wave(stress, a, eta, rho)
        waves = k * np.geomspace(1 / 3, 3, 2001)
        half = eta * waves**4 * a * a / (8 * rho)
        rates = -half + np.sqrt(half**2 + stress * waves**2 / rho)
        assert growth == pytest.approx(rates.max(), rel=1e-9)
        assert k * a < 1
    assert fastest_wave(-1.0, a, eta, rho)[1] == 0


def test_the_onset_is_where_the_surface_carries_the_current():
    assert onset_radius(1e-7, 1e-12, 1e-3, 15e3, 0.15) == pytest.approx(held_radius(1e-4, 15e3, 0.15), rel=1e-12)
    a = float(held_radius(400.0, 15e3, 0.15))
    charge = 400.0 * np.pi * a * a
    assert charge * np.log(2 * 0.15 / a) / (2 * np.pi * EPS0) == pytest.approx(15e3, rel=1e-6)
    assert onset_radius(1e-9, 1.0, 1e-12, 15e3, 0.15) == pytest.approx(np.sqrt(1e-9 * 0.15 / np.pi / 15e3))


def test_a_jet_without_charge_only_dries():
    """So little charge that nothing bends: the radius is that of the start, the time that of drying."""
    found = of(charge_density=1e-9, field=0.0, air_density=0.0, density=1.0, gap=1e3)
    assert found.radius == pytest.approx(JET["start"], rel=1e-6)
    assert found.volume_fraction == pytest.approx(0.7)
    assert found.time == pytest.approx(JET["start"] ** 2 * (1 - 0.08 / 0.7) / JET["evaporation"], rel=1e-3)


def test_its_drag_is_that_of_the_threads_across_the_air():
    from spinline.jetprofile._envelope_kernels import _drag

    for a, w in ((1e-6, 3.0), (1e-4, 5e3), (1e-7, 1e-6)):
        force = float(normal_drag(w, a, 1.2, 1.51e-5))
        assert _drag(a, w, 1000.0, 1.2, 1.51e-5) == pytest.approx(force / w / (1000.0 * np.pi * a * a), rel=1e-12)
    assert _drag(1e-6, 0.0, 1000.0, 1.2, 1.51e-5) == 0


def test_the_extremes_have_answers():
    rng, n = np.random.default_rng(3), 500

    def between(low, high):
        return 10 ** rng.uniform(low, high, n)

    found = envelope(
        between(-1, 5), between(-3, 0), between(-2, 5), between(-13, -8), rng.uniform(0.005, 0.6, n), between(-14, -8),
        between(-2, 0), between(-7, -3), between(2, 7), solid_fraction=0.7,
    )  # fmt: skip
    for name in ("radius", "volume_fraction", "time", "envelope_radius", "axial_speed"):
        assert (getattr(found, name) > 0).all(), name
    assert np.quantile(found.error, 0.9) < 0.05


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"charge_density": 0.0}, "charge_density"),
        ({"gap": np.nan}, "gap"),
        ({"field": -1.0}, "field"),
        ({"volume_fraction": 0.8}, "solid already"),
        ({"fraction": 0.0}, "fraction"),
        ({"air_density": -1.0}, "air_density"),
        ({"start": np.inf}, "start"),
    ],
)
def test_what_cannot_be_is_refused(changes, words):
    with pytest.raises(InputError, match=words):
        of(**changes)


def test_many_at_once_and_none():
    two = of(charge_density=np.array([300.0, 500.0], dtype=np.float32))
    assert two.radius[1] == pytest.approx(of().radius, rel=1e-6)
    assert of(charge_density=np.empty(0)).radius.shape == (0,)


#: Shorter steps decide here whether the loops open before it lands: lengths of 0.2 and 0.1 leave it 0.39 of ln radius apart.
ROUGH = {
    "charge_density": 1461.47,
    "surface_tension": 0.03314565,
    "extensional_viscosity": 2020.856,
    "evaporation": 5.4203979e-11,
    "volume_fraction": 0.0815631,
    "flow_rate": 2.7777778e-10,
    "gap": 0.1066495,
    "start": 1.501576e-5,
    "field": 140647.64,
}


def test_jets_that_the_steps_decide_are_marched_with_shorter_ones():
    once, found, exact = (
        of(**ROUGH, fraction=0.2, accuracy=10.0),
        of(**ROUGH, fraction=0.2),
        of(**ROUGH, fraction=0.005),
    )
    assert once.error > 0.3
    assert found.error <= 0.02
    assert abs(np.log(found.radius / exact.radius)) < 0.05 < abs(np.log(once.radius / exact.radius))
    beside = of(**(ROUGH | {"charge_density": [500.0, ROUGH["charge_density"]]}), fraction=0.2)
    assert beside.radius[1] == found.radius  # by itself or among others


def test_steps_that_are_too_many_leave_what_longer_ones_found():
    found, asked = of(**ROUGH, fraction=0.005, accuracy=1.0), of(**ROUGH, fraction=0.005, accuracy=1e-12)
    assert np.isfinite(asked.radius)
    assert abs(np.log(asked.radius / found.radius)) < 0.01
    with pytest.raises(InputError, match="accuracy"):
        of(accuracy=0.0)
