"""Bending blown jets: limits that are exact, balances, landing, gusts. One compilation, then fractions of a second each."""

from dataclasses import replace

import numpy as np
import pytest

import spinline.deposit as dep
import spinline.jetprofile.blown as blown
from spinline.base.errors import InputError
from spinline.jetprofile.blown._bead_kernels import _join

LIQUID = blown.BlownSolution(1e-8, 1e-3, 1000.0, 1e-9, 0.0)
POLYMER = blown.BlownSolution(1e-6 / 3600, 100e-6, 970.0, 3.01, 0.036, relaxation_time=5e-3, solvent_viscosity=0.01)
START = blown.BeadStart(1e-3, 10e-6, 120.0)
AIR = blown.AirJet(1e-3, 200.0)


def test_free_fall_is_exact():
    """No air, no stress: the tip falls as a stone does; every bead has v^2 = v0^2 + 2 g (x - where it was set free)."""
    run = blown.blown_beads(
        LIQUID,
        blown.Wind(0.0, density=1e-200),
        blown.BeadStart(1e-3, 1e-3),
        dep.Plate(0.1),
        blown.BlownBeads(element=1e-3, duration=0.04, cfl=0.05, gusts=False, longest=0.02),
    )
    v0 = LIQUID.flow_rate / (np.pi * 1e-6)
    assert run.position[0, 0] == pytest.approx(2.5e-3 + v0 * 0.04 + 9.81 * 0.04**2 / 2, abs=1e-12)
    assert run.velocity[0, 0] == pytest.approx(v0 + 9.81 * 0.04, rel=1e-12)
    assert not run.position[:, 1:].any()
    assert abs(run.imbalance()) < 1e-13


def test_drying_without_force_changes_no_velocity():
    """Vapour leaves with the jet's velocity: v to 1e-12 whatever is lost (Eq. (43b) as printed speeds the jet up)."""
    wet = replace(LIQUID, flow_rate=1e-9, radius=1e-4)
    run = blown.blown_beads(
        wet,
        blown.Wind(50.0, density=1e-290),
        blown.BeadStart(1e-3, 1e-4),
        dep.Plate(1.0),
        blown.BlownBeads(
            element=3e-3, duration=0.5, cfl=0.05, gusts=False, gravity=0.0, polymer_fraction=0.1, drying=1.2e-8
        ),
    )
    v0 = 1e-9 / (np.pi * 1e-8)
    np.testing.assert_allclose(run.velocity[:, 0], v0, rtol=1e-12)
    assert 0.1 < run.evaporated / run.fed < 0.9
    assert abs(run.imbalance()) < 1e-12  # of the polymer


@pytest.fixture(scope="module")
def short():
    return blown.blown_beads(
        POLYMER, AIR, START, dep.Plate(4e-3), blown.BlownBeads(element=2e-4, duration=6e-3, cfl=0.3), frames=5
    )


def test_volume_closes_through_feeding_splitting_and_landing(short):
    assert len(short.landings) > 5
    assert abs(short.imbalance()) < 1e-12
    record = dep.LandingRecord.from_dataset(short.to_dataset())
    assert abs(record.imbalance()["volume"]) < 1e-12
    np.testing.assert_allclose(short.landings[:, 1], 4e-3, rtol=1e-9)  # on the plate
    laid = dep.lay(record, dep.Plate(4e-3))
    assert laid.volume.sum() == pytest.approx(short.landings[:, 7].sum(), rel=1e-12)
    assert (laid.radius > 0).all()


def test_the_same_seed_gives_the_same_jet_and_another_another(short):
    ask = blown.BlownBeads(element=2e-4, duration=6e-3, cfl=0.3)
    again = blown.blown_beads(POLYMER, AIR, START, dep.Plate(4e-3), ask, frames=5)
    np.testing.assert_array_equal(again.landings, short.landings)
    other = blown.blown_beads(POLYMER, AIR, START, dep.Plate(4e-3), replace(ask, seed=9), frames=5)
    assert other.landings.shape != short.landings.shape or not np.array_equal(other.landings, short.landings)


def test_without_gusts_the_jet_stays_on_its_axis():
    ask = blown.BlownBeads(element=2e-4, duration=6e-3, gusts=False)
    run = blown.blown_beads(POLYMER, AIR, START, dep.Plate(4e-3), ask)
    assert not run.position[:, 1:].any()
    assert not run.velocity[:, 1:].any()


def test_a_larger_circle_of_the_start_bends_the_jet_more():
    """Every bead, before loops form; not in proportion: the drag across a slow thread goes as the slip to the power 0.11."""
    ask = blown.BlownBeads(element=2e-4, duration=1e-3, gusts=False, amplitude=1e-15, frequency=2000.0)
    run = blown.blown_beads(POLYMER, AIR, START, dep.Plate(4e-3), ask)
    more = blown.blown_beads(POLYMER, AIR, START, dep.Plate(4e-3), replace(ask, amplitude=2e-15))
    off, farther = np.hypot(*run.position[:, 1:].T), np.hypot(*more.position[:, 1:].T)
    assert off[-1] == pytest.approx(1e-15)
    assert (off[:-1] > 10 * off[-1]).all()
    assert (farther > 1.5 * off).all()


def test_a_free_end_is_drawn_back_by_capillarity_alone():
    """Momentum lost against a jet that nothing holds back: pi a sigma t, whatever the drop at the end takes in."""
    liquid = blown.BlownSolution(np.pi * 1e-8 * 5.0, 1e-4, 1000.0, 1.0, 0.036)
    ask = blown.BlownBeads(element=5e-4, duration=4e-3, gusts=False, gravity=0.0)
    air = blown.Wind(0.0, density=1e-200)
    run = blown.blown_beads(liquid, air, blown.BeadStart(1e-3, 1e-4), dep.Plate(0.1), ask)
    mass = 500.0 * (np.concatenate(([0.0], run.volume)) + np.concatenate((run.volume, [0.0])))
    lost = float(mass @ (5.0 - run.velocity[:, 0]))
    assert lost == pytest.approx(np.pi * 1e-4 * 0.036 * 4e-3, rel=0.02)
    assert np.linalg.norm(np.diff(run.position, axis=0), axis=1).min() > 0.2 * 5e-4


def test_joining_keeps_volume_and_momentum():
    rng = np.random.default_rng(3)
    q, e = rng.standard_normal((8, 6)), rng.uniform(0.5, 2.0, (8, 4))
    q[1, :3] = q[0, :3] + 1e-3
    n, flight, touch = 7, np.full(8, np.nan), np.full((8, 7), np.nan)

    def kept(n):
        mass = np.concatenate(([0.0], e[: n - 1, 0])) + np.concatenate((e[: n - 1, 0], [0.0]))
        return np.array([*(mass @ q[:n, 3:]), e[: n - 1, 0].sum(), e[: n - 1, 3].sum(), e[: n - 1, 0] @ e[: n - 1, 1]])

    before, tip = kept(n), q[0, :3].copy()
    after = _join(n, q, e, flight, touch, 0.01)
    assert after == n - 1
    np.testing.assert_allclose(kept(after), before, rtol=1e-13)
    np.testing.assert_array_equal(q[0, :3], tip)


@pytest.mark.parametrize("collector", [dep.Plate(15e-3), dep.Belt(15e-3, 1.0), dep.Drum(15e-3, 10.0, 0.02)])
def test_loops_land_on_the_collector_not_beyond_it(collector):
    """The belly of a loop sticks before the beads ahead of it: every row lies on the surface, in order of time."""
    run = blown.blown_beads(POLYMER, AIR, START, collector, blown.BlownBeads(element=4e-4, duration=12e-3, seed=2))
    x, y = run.landings[:, 1], run.landings[:, 2]
    assert len(x) > 30
    gap = collector.distance - x
    if collector.kind == "drum":
        gap = np.hypot(x - collector.distance - collector.radius, y - collector.offset) - collector.radius
    assert np.abs(gap).max() < 1e-9
    assert (np.diff(run.landings[:, 0]) >= 0).all()
    waited = np.diff(run.landings[:, 0]) == 0  # bellies that had touched before their predecessor
    assert waited.sum() > 3
    chord = np.linalg.norm(np.diff(run.landings[:, 1:4], axis=0), axis=1)
    if collector.kind == "plate":
        assert (run.landings[1:, 8] >= chord * (1 - 1e-12)).all()  # no piece is laid longer than it is
    assert abs(run.imbalance()) < 1e-12


def test_a_belt_carries_the_laid_end():
    """What has landed moves with the belt; in its frame the fibre is drawn out along the machine."""
    ask = blown.BlownBeads(element=2e-4, duration=6e-3, cfl=0.3)
    run = blown.blown_beads(POLYMER, AIR, START, dep.Belt(4e-3, 20.0), ask)
    laid = dep.lay(dep.LandingRecord.from_dataset(run.to_dataset()), dep.Belt(4e-3, 20.0))
    assert dep.order_of(laid.angle, laid.chord).order_parameter > 0.5
    assert abs(run.imbalance()) < 1e-12


def test_gusts_have_the_intensity_asked_for_and_no_memory_of_the_mesh():
    x = np.linspace(1e-3, 30e-3, 500)
    values = []
    for index in range(60):
        field = blown.gust_field(AIR, x, modes=32, seed=1, index=index)
        at = np.column_stack([np.full(200, 0.02), np.zeros((200, 2))])
        values.append(np.concatenate([field.shape(at[:1], t) for t in np.linspace(0, 0.02, 40)]))
    values = np.array(values)
    assert values.std() == pytest.approx(1, abs=0.06)
    assert abs(values.mean()) < 0.1


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: blown.BlownBeads(element=0.0, duration=1.0), "mesh"),
        (lambda: blown.BlownBeads(element=1e-4, duration=np.nan), "duration"),
        (lambda: blown.BlownBeads(element=1e-4, duration=1.0, cfl=2.0), "cfl"),
        (lambda: blown.BlownBeads(element=1e-4, duration=1.0, longest=1e-4), "longest"),
        (
            lambda: blown.blown_beads(
                POLYMER,
                AIR,
                blown.BeadStart(5e-3, 1e-5),
                dep.Plate(4e-3),
                blown.BlownBeads(element=1e-4, duration=1e-3),
            ),
            "start",
        ),
    ],
)
def test_bead_refusals_by_name(call, field):
    with pytest.raises(InputError) as error:
        call()
    assert error.value.field == field
