"""Bending blown jets: limits that are exact, balances, landing, gusts. One compilation, then fractions of a second each."""

from dataclasses import replace

import numpy as np
import pytest

import spinline.deposit as dep
import spinline.jetprofile.blown as blown
from spinline.base.errors import InputError

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


def test_a_circle_of_the_start_mirrors():
    """The circle turned the other way gives the mirrored jet, bead by bead."""
    ask = blown.BlownBeads(element=2e-4, duration=3e-3, gusts=False, amplitude=2e-6, frequency=2000.0)
    run = blown.blown_beads(POLYMER, AIR, START, dep.Plate(4e-3), ask)
    assert np.abs(run.position[:, 1:]).max() > 2e-6
    more = blown.blown_beads(POLYMER, AIR, START, dep.Plate(4e-3), replace(ask, amplitude=4e-6))
    assert np.abs(more.position[:, 1:]).max() > 1.3 * np.abs(run.position[:, 1:]).max()


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
