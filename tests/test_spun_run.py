"""Runs: landing, record, resume bit by bit, noise on any grid, exports, translated input files."""

from dataclasses import replace

import numpy as np
import pytest
from spun_cases import AREA, FIELD, material, pvp, rotating

from spinline.base.errors import InputError
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.spun import _codes as c
from spinline.jetprofile.spun.chain import parameters
from spinline.jetprofile.spun.dataset import to_dataset
from spinline.jetprofile.spun.dumbbell import earnshaw_rate, two_bead
from spinline.jetprofile.spun.exports import vtk_text, xyz_text
from spinline.jetprofile.spun.jetspin_input import translate
from spinline.jetprofile.spun.laws import JetLaw
from spinline.jetprofile.spun.noise import impulses, normals
from spinline.jetprofile.spun.run import SpunRun, moments
from spinline.jetprofile.spun.settings import Air, Collector, Drying, Grid, Inlet, Loads

PVP_INPUT = """
 system 3
 integrator 2
 timestep 1.d-8
 print time 1.d-3
 final time 0.01d0
 seed 317
 print xyz 5.d-4
 print list t x vn vc yz n
 inserting yes
 removing yes
 gravity yes
 points 1
 initial length 0.02
 nozzle velocity 0.282942121d0
 nozzle stress 0.d0
 yield stress   0.d0
 nozzle cross 0.005d0
 density mass 0.839253525d0
 density charge 44000.0d0
 viscosity    20.d0
 elastic modulus   50000.d0
 collector distance 16.d0
 external potential 30.02076857d0
 surface tension 21.133d0
 perturbation yes
 perturbation frequency  1.d+4
 perturbation amplitude  1.d-3
 Finish
"""


def _short_gap(collector="plate", **more):
    s = rotating(pvp(4e-4, charge=8800.0, repulsion="hybrid"), 2000.0, ramp=1e-3)
    return replace(s, loads=replace(s.loads, gap=0.02), collector=Collector(collector, **more), surface_tension=0.02)


@pytest.fixture(scope="module")
def landed():
    run = SpunRun.start(_short_gap())
    for _ in run.to(moments(16e-3, 4)):
        pass
    return run


def test_everything_that_came_is_flying_or_has_landed(landed):
    chain = landed.chain
    inlet, rows = chain.settings.inlet, chain.deposited
    assert len(rows) > 20
    came = AREA * inlet.length + inlet.flow_rate * chain.time
    there = chain.nodes[: chain.n, c.VOLUME].sum() + rows[:, c.D_VOLUME].sum()
    assert there == pytest.approx(came, rel=1e-12)
    charge = chain.nodes[: chain.n, c.CHARGE].sum() + rows[:, c.D_CHARGE].sum()
    assert charge == pytest.approx(inlet.charge_density * came, rel=1e-12)
    assert (np.diff(rows[:, c.D_LABEL]) > 0).all()
    assert rows[:, c.D_X0] == pytest.approx(0.02, abs=1e-12)
    assert (rows[:, c.D_TIME] >= rows[:, c.D_FRONT]).all()


@pytest.mark.parametrize("law", ["explicit", "implicit"])
def test_a_bead_that_a_split_put_behind_the_plate_is_held(law):
    """Its touch is always before the next step: steps had shrunk to nothing, for ever, and no signal ended that."""
    s = _short_gap()
    if law == "implicit":
        s = replace(s, law=replace(s.law, name="oldroyd-b", solvent_viscosity=1e-3))
    assert s.implicit == (law == "implicit")
    run = SpunRun.start(s)
    run.chain.march(12e-3)
    chain, gap = run.chain, s.loads.gap
    bead = next(i for i in range(chain.n) if chain.held[i] == 0)
    chain.state[bead, c.X] = gap * (1 + 1e-4)
    chain.march(12.2e-3)
    assert chain.time == 12.2e-3
    assert chain.state[: chain.n, c.X].max() <= gap * (1 + 1e-9)


def test_resumed_run_is_the_same_to_the_last_bit(landed):
    times = moments(16e-3, 4)
    run = SpunRun.start(_short_gap())
    steps = run.to(times)
    next(steps)
    next(steps)
    again = SpunRun.unpack(_short_gap(), {k: np.array(v) for k, v in run.pack().items()})
    for _ in again.to(times):
        pass
    assert np.array_equal(again.chain.nodes, landed.chain.nodes)
    assert np.array_equal(again.chain.deposited, landed.chain.deposited)
    assert again.times == landed.times


def test_result_is_a_jet(landed):
    jet = to_dataset(landed)
    beads = LagrangianJet.from_dataset(jet)
    last = beads.at(None)
    stored = landed.frames[-1]
    n = len(stored) - 1
    length = np.linalg.norm(np.diff(stored[:, :3], axis=0), axis=1)
    stretch = (AREA * length / stored[:n, c.LABEL])[::-1]
    usable = last.usable[:n]
    assert last.stretch[:n][usable] == pytest.approx(stretch[usable], rel=1e-13)
    assert last.element_radius[:n][usable] == pytest.approx(50e-6 * stretch[usable] ** -0.5, rel=1e-13)
    assert float(jet["deposit_volume"].sum()) > 0
    radius = jet["deposit_radius"].values
    assert radius == pytest.approx(50e-6 * jet["deposit_stretch"].values ** -0.5, rel=1e-12)


def test_landings_are_what_a_mat_is_laid_of(landed):
    from spinline.deposit.landing import LandingRecord
    from spinline.jetprofile.spun import landings

    record = LandingRecord.from_dataset(landings(landed))
    rows = landed.chain.deposited
    assert len(record.touch_time) == len(rows) + 1
    assert record.volume.sum() == pytest.approx(rows[:, c.D_VOLUME].sum(), rel=1e-12)


@pytest.mark.parametrize(("kind", "more"), [("belt", {"speed": 2.0}), ("drum", {"speed": 2.0, "radius": 0.05})])
def test_moving_collectors(kind, more):
    """The thread laid on a moving surface is as long as the surface's way, at least; and all is kept."""
    run = SpunRun.start(_short_gap(kind, **more))
    for _ in run.to(moments(14e-3, 2)):
        pass
    jet, chain = to_dataset(run), run.chain
    came = AREA * chain.settings.inlet.length + chain.settings.inlet.flow_rate * chain.time
    assert chain.nodes[: chain.n, c.VOLUME].sum() + chain.deposited[:, c.D_VOLUME].sum() == pytest.approx(
        came, rel=1e-12
    )
    time, y = jet["deposit_time"].values, jet["deposit_y1"].values
    assert y[-1] - y[0] == pytest.approx(-2.0 * (time[-1] - time[0]), rel=0.2)


def test_free_beads_diffuse_as_they_should():
    """Variance of the velocity 2 D_v t with D_v = noise/m, within 2 %; a finer cut of the same material sees the same noise."""
    noise, grain, interval, density = 1e-15, 1e-13, 1e-6, 1000.0
    count, moments_ = (
        4000,
        20,
    )  # an element holds several grains: the velocity of a part of a grain is the whole grain's
    for cells in (4, 16):
        state = np.zeros((count + 2, c.COLUMNS))
        state[:count, c.VOLUME] = state[:count, c.LABEL] = cells * grain
        total = np.zeros((count, 3))
        for moment in range(moments_):
            total += impulses(state, count, 0.0, density, noise, grain, interval, 7, moment)
        mass = density * cells * grain
        expected = 2 * noise / mass * moments_ * interval
        assert (total[1:] ** 2).mean() == pytest.approx(expected, rel=0.02)
    coarse, fine = (np.zeros((n + 2, c.COLUMNS)) for n in (50, 150))
    coarse[:50, c.LABEL] = coarse[:50, c.VOLUME] = 6 * grain
    fine[:150, c.LABEL] = fine[:150, c.VOLUME] = 2 * grain
    one = impulses(coarse, 50, 0.0, density, noise, grain, interval, 7, 3)
    many = impulses(fine, 150, 0.0, density, noise, grain, interval, 7, 3)
    own = np.cumsum(np.concatenate((one[:1] * 0.5, one[1:])) * density * 6 * grain, axis=0)
    same = np.cumsum(np.concatenate((many[:1] * 0.5, many[1:])) * density * 2 * grain, axis=0)
    # momentum up to the end of what node i owns: label (6 i + 3) grains of the coarse cut, (2 k + 1) of the fine one
    assert own == pytest.approx(same[1::3], abs=1e-12 * np.abs(own).max())


def test_normal_numbers():
    from scipy.stats import kstest

    z = normals(5, 11, np.arange(20000))
    assert min(kstest(z[:, i], "norm").pvalue for i in range(3)) > 1e-3
    assert abs(np.corrcoef(z.T) - np.eye(3)).max() < 0.03
    assert np.array_equal(normals(5, 11, np.arange(5, 9)), z[5:9])
    assert not np.array_equal(normals(6, 11, np.arange(4)), z[:4])


def test_exports(landed):
    jet = to_dataset(landed)
    text = vtk_text(jet)
    n = int(jet["n_bead"].values[-1])
    assert f"POINTS {n} double" in text
    rows = text.split("SCALARS radius double 1\nLOOKUP_TABLE default\n")[1].splitlines()
    assert float(rows[0]) == pytest.approx(float(jet["radius"].values[-1, 0]), rel=1e-8)
    frames = xyz_text(jet).splitlines()
    assert int(frames[0]) == int(jet["n_bead"].values[0])
    assert sum(line.startswith("C ") for line in frames) == int(jet["n_bead"].values.sum())


def test_two_beads():
    """Reference lengths, and the largest stress and force, of both laws."""
    found = two_bead([1, 2, 3, 10])
    assert found.length == pytest.approx([3.891966, 7.697783, 12.542810, 95.859419], abs=6e-7)
    close = two_bead(np.linspace(0, 2, 20001))
    assert close.stress.max() == pytest.approx(0.836557, abs=1e-6)
    assert close.time[close.stress.argmax()] == pytest.approx(1.1069, abs=2e-4)
    assert close.force.max() == pytest.approx(3.459636, abs=1e-6)
    assert close.time[close.force.argmax()] == pytest.approx(0.4926, abs=2e-4)
    ucm = two_bead([1, 2, 3, 10], law="ucm")
    assert ucm.length == pytest.approx([3.281601, 3.643270, 3.911128, 42.595647], abs=6e-7)
    assert (ucm.conformation[0][0], ucm.conformation[1][0]) == pytest.approx((5.911607, 0.556359), rel=1e-6)
    free = two_bead([2.0], repulsion=0.0, viscoelastic=0.0)
    assert free.length == pytest.approx(1 + 2.0 * 2**2 / 2, rel=1e-12)
    assert float(earnshaw_rate(1e-12, 1e-9, 1e-3)) == pytest.approx(134.071263, rel=1e-8)
    with pytest.raises(InputError, match="increase"):
        two_bead([2, 1])
    with pytest.raises(InputError, match="together"):
        two_bead([5.0], repulsion=0.0, field=0.0, viscoelastic=0.0, velocity=-1.0)


def test_input_file_translated():
    found = translate(PVP_INPUT)
    s = found.settings
    assert s.inlet.flow_rate == pytest.approx(0.282942121e-2 * AREA, rel=1e-12)
    assert s.loads.field == pytest.approx(FIELD, rel=1e-4)
    assert s.law == JetLaw("ucm", 5e3 / 3, 4e-4)
    assert s.inlet.frequency == 1e4
    assert found.time == pytest.approx(0.01)
    assert any("flow rate" in words for words in found.differs)
    assert any("breakdown" in words for words in found.differs)
    finer = " dynamic refinement yes\n dynamic refinement every 1.d-3\n dynamic refinement threshold 0.4d0\n Finish"
    assert translate(PVP_INPUT.replace(" Finish", finer)).settings.grid.longest == pytest.approx(4e-3)
    linear = translate(PVP_INPUT, law="linear-maxwell", flow_rate=1e-8).settings
    assert linear.law.modulus == pytest.approx(5e3)
    assert linear.inlet.flow_rate == 1e-8


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("kvfluid yes", "no counterpart"),
        ("thermostat yes", "not a key"),
        ("viscosity many", "not a number"),
        ("viscosity -1.d0", "out of range"),
    ],
)
def test_input_file_refused(line, words):
    text = "\n".join(row for row in PVP_INPUT.splitlines() if not row.strip().startswith(line.split()[0]))
    with pytest.raises(InputError, match=words):
        translate(text.replace(" Finish", f" {line}\n Finish"))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Inlet(0.0, 1e-4), "flow_rate"),
        (lambda: Inlet(1e-9, float("nan")), "radius"),
        (lambda: Inlet(1e-9, 1e-4, stress="both"), "stress"),
        (lambda: Inlet(1e-9, 1e-4, compliance=0.1), "tension"),
        (lambda: Loads(0.0), "gap"),
        (lambda: Loads(0.1, kind="cone"), "kind"),
        (lambda: Loads(0.1, kind="table"), "axis"),
        (lambda: Grid(0.0), "element_length"),
        (lambda: Grid(1e-4, repulsion="local"), "log_length"),
        (lambda: Grid(1e-4, repulsion="points"), "repulsion"),
        (lambda: Air(noise=1.0), "grain"),
        (lambda: Collector("wall"), "collector"),
        (lambda: Collector("drum"), "radius"),
        (lambda: Drying(1.5, 1e-5, 1e-5), "fraction"),
        (lambda: JetLaw("fene-p", 1.0, 1.0), "extensibility"),
        (lambda: JetLaw("ucm", 1.0, 1.0, solvent_viscosity=1.0), "place"),
        (lambda: JetLaw("rubber", 1.0, 1.0), "law"),
        (lambda: moments(0.0, 3), "time"),
        (lambda: moments(1.0, 0), "frames"),
    ],
)
def test_refusals_name_the_field(make, words):
    with pytest.raises(InputError, match=words):
        make()


@pytest.mark.parametrize(
    "change",
    [
        {"loads": {"field": 0.0}},
        {"charge": 0.0},
        {"gap": 1.0},
        {"gap": 1e-3},
        {"law": JetLaw("ucm", 5e3 / 3, float("inf"))},
        {"law": JetLaw("ucm", 0.0, 1.0)},
    ],
    ids=["no field", "no charge", "1 m", "1 mm", "rubber", "no stress"],
)
def test_extremes_run(change):
    s = pvp(2e-4, charge=change.get("charge", 8800.0), repulsion="hybrid", start=4e-4)
    s = replace(s, collector=Collector("plate"), law=change.get("law", s.law))
    s = replace(s, loads=replace(s.loads, gap=change.get("gap", 0.16), **change.get("loads", {})))
    run = SpunRun.start(s)
    for _ in run.to(moments(3e-3, 1)):
        pass
    chain = run.chain
    came = AREA * s.inlet.length + s.inlet.flow_rate * chain.time
    assert chain.nodes[: chain.n, c.VOLUME].sum() + chain.deposited[:, c.D_VOLUME].sum() == pytest.approx(
        came, rel=1e-12
    )
    assert np.isfinite(chain.nodes).all()


def test_refined_jet_keeps_everything_and_its_shape():
    """Elements split in flight: volume and charge to rounding, material points as on a finer grid."""
    s = rotating(pvp(4e-4), 2000.0, ramp=1e-3)
    plain, split, fine = (
        s,
        replace(s, grid=replace(s.grid, longest=1e-3)),
        rotating(pvp(1e-4), 2000.0, ramp=1e-3),
    )
    found = []
    for settings in (plain, split, fine):
        run = SpunRun.start(settings)
        run.advance(10e-3)
        found.append(run.chain)
    assert found[1].n > found[0].n
    y, n = found[1].nodes, found[1].n
    assert y[:n, c.VOLUME].sum() == pytest.approx(found[0].nodes[: found[0].n, c.VOLUME].sum(), rel=1e-12)
    length = np.linalg.norm(np.diff(y[:, :3], axis=0), axis=1)
    assert length[:-1].max() < 1.05e-3
    at = np.array([0.4, 0.8, 1.2]) * 1e-2
    truth = material(found[2], at)
    assert np.linalg.norm(material(found[1], at) - truth, axis=1).max() < np.linalg.norm(truth, axis=1).max() * 2e-3


def test_a_split_keeps_volume_charge_and_polymer_to_rounding():
    """In whole, not in halves: the charge per volume is linear between neighbours that rise one way, else constant."""
    from spinline.jetprofile.spun._refine_kernels import refine

    s = replace(pvp(1e-4), grid=replace(pvp(1e-4).grid, turn=0.3))
    n, rng = 24, np.random.default_rng(4)
    y = np.zeros((80, c.COLUMNS))
    angle = np.linspace(0.0, 9.0, n + 1)  # 0.39 rad a node
    y[: n + 1, c.X], y[: n + 1, c.Y] = 1e-3 * np.cos(angle), 1e-3 * np.sin(angle)
    y[:n, c.VOLUME] = y[:n, c.LABEL] = rng.uniform(0.8e-12, 1.2e-12, n)
    label = np.cumsum(y[:n, c.LABEL]) - 0.5 * y[:n, c.LABEL]
    y[:n, c.CHARGE] = y[:n, c.LABEL] * (0.1 + 2e9 * label)
    y[:n, c.AZZ], y[:n, c.ARR] = rng.uniform(1, 90, n), rng.uniform(0.2, 1, n)
    sums = [y[:n, c.VOLUME].sum(), y[:n, c.CHARGE].sum(), *(y[:n, c.LABEL] @ y[:n, col] for col in (c.AZZ, c.ARR))]
    p, _ = parameters(s)
    more = refine(n, float(np.pi * s.inlet.radius**2 * 1e-4), y, np.zeros(80, dtype=np.int64), np.zeros((80, 9)), p)
    assert more > n + 10
    after = [y[:more, c.VOLUME].sum(), y[:more, c.CHARGE].sum()]
    after += [y[:more, c.LABEL] @ y[:more, col] for col in (c.AZZ, c.ARR)]
    assert after == pytest.approx(sums, rel=1e-13)
    label = np.cumsum(y[:more, c.LABEL]) - 0.5 * y[:more, c.LABEL]
    density = y[:more, c.CHARGE] / y[:more, c.LABEL]
    inside = slice(2, more - 3)
    assert density[inside] == pytest.approx((0.1 + 2e9 * label)[inside], rel=1e-12)


def test_drying_jet_loses_solvent_alone():
    s = pvp(4e-4, charge=0.0, start=8e-4)
    s = replace(s, drying=Drying(0.05, 1e-4, 1e-2, viscosity_factor=0.5), air=Air())
    run = SpunRun.start(s)
    for _ in run.to(moments(10e-3, 1)):
        pass
    y, n = run.chain.nodes, run.chain.n
    left = y[:n, c.VOLUME] / y[:n, c.LABEL]
    assert left[0] < left[n - 1] <= 1.0
    assert (left > 0.05).all()
    assert y[:n, c.LABEL].sum() == pytest.approx(AREA * 8e-4 + s.inlet.flow_rate * 10e-3, rel=1e-12)


def test_stretch_of_a_drying_jet_is_that_of_its_lengths_alone():
    """What a network is given: l over l at entry of the same material, whatever solvent has left; r^2 l would count that twice."""
    s = pvp(4e-4, charge=0.0, start=8e-4)
    s = replace(s, drying=Drying(0.05, 1e-4, 1e-2, viscosity_factor=0.5), air=Air())
    run = SpunRun.start(s)
    for _ in run.to(moments(10e-3, 2)):
        pass
    early, late = (LagrangianJet.from_dataset(to_dataset(run)).at(t) for t in run.times)
    front, back = run.frames
    count = len(front) - 2  # closed elements, the same ones from the front in both
    longer = np.linalg.norm(np.diff(back[:, :3], axis=0), axis=1)[:count]
    shorter = np.linalg.norm(np.diff(front[:, :3], axis=0), axis=1)[:count]
    found = late.stretch[late.usable][::-1][:count] / early.stretch[early.usable][::-1][:count]
    assert found == pytest.approx(longer / shorter, rel=1e-12)
    assert late.stretch[late.usable][::-1][:count] == pytest.approx(AREA * longer / front[:count, c.LABEL], rel=1e-12)
    lost = back[:count, c.VOLUME] / back[:count, c.LABEL]
    assert lost.min() < 0.95
    thinned = (50e-6 / late.element_radius[late.usable][::-1][:count]) ** 2
    assert thinned == pytest.approx(late.stretch[late.usable][::-1][:count] / lost, rel=1e-12)


def test_moving_charge_without_a_known_end_is_refused():
    s = pvp(2e-4, repulsion="hybrid")
    with pytest.raises(InputError, match="free charged front"):
        replace(s, conductivity=0.01)
