"""The bead chain in time: reference values, limits, orders, locking, restarts, extremes."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spinline import network as net
from spinline.base.errors import InputError
from spinline.jetprofile import Hyperbolic, PowerLaw, Table
from spinline.network.chain.flow import hermite
from spinline.network.chain.reference import steady_reference

PEO = {"radius": 125e-6, "flow_rate": 3.2e-6 / 3600}
JET = PowerLaw(**PEO, k=1.0, beta=0.47)
LAWS = ("linear", "lattice", "langevin", "fene")


def smooth(s):
    """A jet that is flat at the nozzle, so that nothing but the scheme limits the order."""
    return 1 + 6 * (s / 10) ** 4


def manifold(eps, inertia, flow, s):
    """Steady bead flux w = V + (eps - I) w w', marched backward from the free end."""

    def slope(x, w):
        return (w - flow.velocity_ratio(x)) / ((eps - inertia) * w)

    out = solve_ivp(slope, (flow.length, s), [1.0], method="Radau", rtol=1e-11, atol=1e-12)
    return float(out.y[0, -1])


@pytest.fixture(scope="module")
def flow():
    return net.Flow.from_jet(JET, 16.0)


@pytest.fixture(scope="module")
def smooth_flow():
    return net.Flow.from_profiles([smooth], [0.0], 10.0)


# --- the flow table ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("jet", [JET, PowerLaw(**PEO, k=1.8, beta=0.6), Hyperbolic(**PEO, p=23.1)])
def test_flow_table_holds_its_error(jet):
    flow = net.Flow.from_jet(jet, 40.0, rtol=1e-8)
    s = np.linspace(0, 40, 10_001)
    z = np.minimum(s * jet.initial_radius, 40 * jet.initial_radius)
    assert np.max(np.abs(flow.velocity_ratio(s) / jet.velocity_ratio(z) - 1)) < 1e-7
    time = jet.residence_time(z) * jet.initial_velocity / jet.initial_radius
    np.testing.assert_allclose(flow.residence_time(s), time, rtol=1e-8, atol=1e-9)


def test_flow_changes_linearly_in_time_and_jumps():
    other = PowerLaw(**PEO, k=1.2, beta=0.5)
    ramp = net.Flow.switching(JET, other, 20.0, at=2.0, over=4.0)
    z = 8.0 * JET.initial_radius
    a, b = float(JET.velocity_ratio(z)), float(other.velocity_ratio(z))
    for time, expected in ((0.0, a), (2.0, a), (3.0, 0.75 * a + 0.25 * b), (6.0, b), (9.0, b)):
        assert float(ramp.velocity_ratio(8.0, time)) == pytest.approx(expected, rel=1e-7)
    jump = net.Flow.switching(JET, other, 20.0, at=2.0)
    assert float(jump.velocity_ratio(8.0, 1.999)) == pytest.approx(a, rel=1e-7)
    assert float(jump.velocity_ratio(8.0, 2.0)) == pytest.approx(b, rel=1e-7)


# --- reference values ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("alpha", "w"), [(20, 7.3806996), (200, 7.0911582), (2000, 7.0645560)])
def test_transient_chain_settles_at_the_published_stretch(alpha, w):
    for length in (18.0, 22.0):
        chain = net.Chain(flow=net.Flow.from_jet(JET, length), spacing=0.01, coupling=alpha)
        assert float(net.run_chain(chain, 8.0).stretch_at(8.0)) == pytest.approx(w, rel=1e-6)


def test_spacings_belong_to_midpoints(flow):
    chain = net.Chain(flow=flow, spacing=0.01, coupling=2000)
    profile = net.run_chain(chain, 6.0).profile
    middle = np.interp(8.0, profile.position, profile.stretch)
    bead = np.interp(8.0, profile.beads[1:], profile.stretch)
    assert abs(middle - 7.0645560) < 2e-4
    # h w w' / 2 = 0.01 * 7.06 * 0.83 / 2
    assert abs(bead - 7.0645560) == pytest.approx(0.0293, abs=5e-4)


# --- limits and orders ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_chain_meets_the_manifold_at_second_order_in_the_spacing(smooth_flow):
    exact = manifold(0.05, 0.0, smooth_flow, 6.0)
    error = []
    for h in (0.1, 0.05, 0.025):
        chain = net.Chain(flow=smooth_flow, spacing=h, coupling=20)
        error.append(abs(float(net.run_chain(chain, 10.0, rtol=1e-7).stretch_at(6.0)) - exact))
    order = np.log2(np.divide(error[:-1], error[1:]))
    assert error[-1] < 2e-5
    assert np.all(order >= 0.95), (error, order)
    assert order[-1] == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("inertia", [0.0, 0.3])
@pytest.mark.parametrize("law", LAWS)
def test_order_in_time(smooth_flow, law, inertia):
    chain = net.Chain(flow=smooth_flow, spacing=0.02, coupling=20, law=law, contour=12.0, inertia=inertia)

    def run(step):
        state = net.run_chain(chain, 5.12, time_step=step, rtol=1e-9, start=begin).state
        middle = (state.positions > 1) & (state.positions < 5)
        return state.positions[middle][-150:]

    begin = net.run_chain(chain, 1.28, time_step=0.01, rtol=1e-9).state
    exact = run(0.0025)
    error = [np.max(np.abs(run(step) - exact)) for step in (0.08, 0.04, 0.02)]
    order = np.log2(np.divide(error[:-1], error[1:]))
    assert np.all(order >= 1.9), (error, order)


def test_inertia_is_a_regular_perturbation(smooth_flow):
    def stretch(inertia):
        chain = net.Chain(flow=smooth_flow, spacing=0.02, coupling=100, inertia=inertia)
        result = net.run_chain(chain, 8.0, time_step=0.02, rtol=1e-10)
        return result.stretch_at(np.linspace(2, 8, 61))

    first_order = stretch(0.0)
    slopes = [np.max(np.abs(stretch(i) - first_order)) / i for i in 10.0 ** np.arange(-9, -1)]
    assert np.allclose(slopes[:-2], slopes[3], rtol=0.02), slopes
    assert np.allclose(slopes, slopes[3], rtol=0.1), slopes


@pytest.mark.slow
def test_inertia_of_the_steady_flux(smooth_flow):
    chain = net.Chain(flow=smooth_flow, spacing=0.02, coupling=20, inertia=0.02)
    w = float(net.run_chain(chain, 10.0, rtol=1e-6).stretch_at(6.0))
    assert w == pytest.approx(manifold(0.05, 0.02, smooth_flow, 6.0), rel=1e-5)
    assert abs(w - manifold(0.05, 0.0, smooth_flow, 6.0)) > 0.01


def test_affine_limit(flow):
    chain = net.Chain(flow=flow, spacing=0.01, coupling=1e15)
    s = np.linspace(2, 15, 50)
    np.testing.assert_allclose(net.run_chain(chain, 5.0).stretch_at(s), flow.velocity_ratio(s), rtol=1e-7)


@pytest.mark.parametrize(("product", "settles"), [(0.1, True), (0.5, False)])
def test_beyond_a_quarter_the_inlet_stretch_grows(product, settles):
    flow = net.Flow.from_profiles([lambda s: 1 + 0.5 * s], [0.0], 40.0)
    chain = net.Chain(flow=flow, spacing=0.05, coupling=0.5 / product)
    times = [4.0, 8.0, 16.0]
    result = net.run_chain(chain, 16.0, rtol=1e-3, output_times=times)
    inlet = [float(net.ChainResult(chain, state, []).stretch_at(0.5)) for state in result.snapshots]
    if settles:
        assert abs(inlet[2] / inlet[1] - 1) < 1e-3
    else:
        assert inlet[1] > 1.1 * inlet[0]
        assert inlet[2] > 1.1 * inlet[1]


def test_the_far_end_does_not_matter_upstream():
    w = []
    for length in (12.0, 20.0):
        chain = net.Chain(flow=net.Flow.from_jet(JET, length), spacing=0.02, coupling=200)
        w.append(float(net.run_chain(chain, 6.0).stretch_at(8.0)))
    assert w[0] == pytest.approx(w[1], rel=2e-5)


def test_voltage_step_forgets_the_first_jet():
    weak, strong = PowerLaw(**PEO, k=0.9, beta=0.47), PowerLaw(**PEO, k=1.2, beta=0.47)
    s = np.linspace(2, 12, 30)

    def steady(jet):
        chain = net.Chain(flow=net.Flow.from_jet(jet, 16.0), spacing=0.02, coupling=100)
        return net.run_chain(chain, 8.0).stretch_at(s)

    for over in (0.0, 1.0):
        flow = net.Flow.switching(weak, strong, 16.0, at=8.0, over=over)
        chain = net.Chain(flow=flow, spacing=0.02, coupling=100)
        result = net.run_chain(chain, 17.0, output_times=[8.0, 8.5])
        before, during = (net.ChainResult(chain, state, []).stretch_at(s) for state in result.snapshots)
        np.testing.assert_allclose(before, steady(weak), rtol=2e-4)
        np.testing.assert_allclose(result.stretch_at(s), steady(strong), rtol=2e-4)
        assert np.all(during[:20] != before[:20])


def test_a_measured_jet():
    z = np.linspace(0, 2e-3, 40)
    table = Table(z=z, radius=125e-6 / (1 + z / 125e-6 / 8), flow_rate=PEO["flow_rate"])
    flow = net.Flow.from_jet(table, 14.0)
    w = net.run_chain(net.Chain(flow=flow, spacing=0.02, coupling=1e4), 8.0).stretch_at(8.0)
    assert float(w) == pytest.approx(float(flow.velocity_ratio(8.0)), rel=2e-3)


# --- coarse-graining ------------------------------------------------------------------------------------------------


def test_estimate_of_coarse_graining(smooth_flow):
    chain = net.Chain(flow=smooth_flow, spacing=0.0125, coupling=20, coarse_grain=8)
    w, error = net.coarse_graining_error(chain, 9.0, 6.0, rtol=1e-6)
    physical = net.Chain(flow=smooth_flow, spacing=0.0125, coupling=20)
    true = abs(float(w) - float(net.run_chain(physical, 9.0, rtol=1e-6).stretch_at(6.0)))
    assert float(error) == pytest.approx(true, rel=0.25)


# --- locking --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS[1:])
@pytest.mark.parametrize("alpha", [20.0, 1e3, 1e6])
def test_bounded_laws_lock(law, alpha):
    flow = net.Flow.from_jet(JET, 16.0)
    result = net.run_chain(
        net.Chain(flow=flow, spacing=0.02, coupling=alpha, law=law, contour=5.0), 6.0, rtol=1e-3, output_times=[3.0]
    )
    for state in (*result.snapshots, result.state):
        profile = net.ChainResult(result.chain, state, []).profile
        assert profile.stretch.max() < 5.0 * (1 + 1e-9)
        assert profile.stretch.min() > 0.5
        # the lattice walk is full to double precision beyond f = 37
        assert profile.relative_extension.max() <= 1.0
        if law != "lattice":
            assert profile.relative_extension.max() < 1.0


def test_the_stretch_between_beads_never_passes_the_contour():
    """At a front of locking the polynomial through six beads overshoots."""
    flow = net.Flow.from_jet(JET, 40.0)
    chain = net.Chain(flow=flow, spacing=0.02, coupling=1e4, spring=3.0, law="lattice", contour=22.5)
    profile = net.run_chain(chain, 12.0, rtol=1e-2).profile
    s = np.linspace(profile.beads[0], profile.beads[-1], 20_000)
    w = profile.stretch_at(s)
    assert w.max() <= 22.5
    assert w.min() > 0
    assert replace(profile, contour=np.inf).stretch_at(s).max() > 22.5 * (1 + 1e-6)


def test_locking_is_nonlocal():
    # from s1 on, where the drag on the locked part balances: int_{s1}^{L} (V_S - V) ds = 0
    flow = net.Flow.from_jet(JET, 16.0)
    full = 10.0
    s = np.linspace(1, 16, 20_001)
    drag = np.cumsum((full - flow.velocity_ratio(s))[::-1]) * (s[1] - s[0])
    onset = s[::-1][np.flatnonzero((drag[1:] > 0) & (drag[:-1] <= 0))[0]]
    crossover = float(np.interp(full, flow.velocity_ratio(s), s))
    chain = net.Chain(flow=flow, spacing=0.01, coupling=1e6, law="fene", contour=full)
    profile = net.run_chain(chain, 9.0, rtol=1e-3).profile
    locked = profile.position[profile.relative_extension > 0.99][0]
    assert onset < locked < onset + 0.3
    assert locked < crossover - 1.0


# --- running --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("law", "inertia"), [("linear", 0.0), ("langevin", 1e-3)])
def test_a_stopped_run_goes_on_bit_for_bit(tmp_path, law, inertia):
    flow = net.Flow.switching(JET, PowerLaw(**PEO, k=1.1, beta=0.47), 12.0, at=2.1, over=0.3)
    chain = net.Chain(flow=flow, spacing=0.02, coupling=50, law=law, contour=20.0, inertia=inertia)
    arguments = {"until": 4.0, "output_times": [1.0, 3.0]}
    whole = net.run_chain(chain, **arguments)

    class Stop(Exception):
        pass

    seen = []

    def stop(state):
        seen.append(state)
        if len(seen) == 25:
            raise Stop

    file = tmp_path / "chain.npz"
    for _ in range(3):  # stopped again and again
        seen.clear()
        with pytest.raises(Stop):
            net.run_chain(chain, **arguments, checkpoint=file, checkpoint_seconds=0.0, progress=stop)
    resumed = net.run_chain(chain, **arguments, checkpoint=file, checkpoint_seconds=0.0)
    for a, b in zip((*whole.snapshots, whole.state), (*resumed.snapshots, resumed.state), strict=True):
        for name in ("positions", "tensions", "velocities", "rates"):
            assert np.array_equal(getattr(a, name), getattr(b, name)), name
        assert (a.time, a.steps, a.iterations, a.next_step) == (b.time, b.steps, b.iterations, b.next_step)
    with pytest.raises(InputError, match="another run"):
        net.run_chain(chain, 5.0, checkpoint=file)
    file.write_bytes(b"PK")
    with pytest.raises(InputError, match="cannot be read"):
        net.run_chain(chain, **arguments, checkpoint=file)


def test_runs_are_reproducible_and_report(flow, capsys):
    chain = net.Chain(flow=flow, spacing=0.05, coupling=100)
    a, b = net.run_chain(chain, 3.0), net.run_chain(chain, 3.0, progress=True)
    assert np.array_equal(a.state.positions, b.state.positions)
    times = []
    net.run_chain(chain, 3.0, progress=lambda state: times.append(state.time))
    assert times[0] == 0.0
    assert times[-1] == 3.0
    assert np.all(np.diff(times) > 0)


def test_beads_enter_one_every_spacing_and_leave(flow):
    chain = net.Chain(flow=flow, spacing=0.05, coupling=100)
    state = net.run_chain(chain, 6.0).state
    assert np.all(np.diff(state.positions) < 0)
    assert state.positions[1] < flow.length
    assert state.newest == 121
    assert state.positions[-1] == pytest.approx(-0.05, abs=1e-12)
    # the network carries V = 1 over its own velocity: w = u
    profile = net.run_chain(chain, 6.0).profile
    np.testing.assert_allclose(profile.network_velocity_ratio[:-2], profile.stretch[:-2], rtol=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("start", ["empty", "affine"])
def test_starts_are_forgotten(flow, start):
    chain = net.Chain(flow=flow, spacing=0.02, coupling=100)
    w = float(net.run_chain(chain, 7.0, start=start).stretch_at(8.0))
    assert w == pytest.approx(manifold(0.01, 0.0, flow, 8.0), rel=2e-5)


def test_fixed_beads_relax_to_rest():
    flow = net.Flow.from_profiles([lambda s: 1 + 0 * s], [0.0], 50.0)
    chain = net.Chain(flow=flow, spacing=0.1, coupling=1.0, entry=False)
    begin = net.start_from(chain, np.linspace(8, 1, 36))  # stretched twofold
    result = net.run_chain(chain, 30.0, start=begin)
    np.testing.assert_allclose(result.profile.stretch, 1.0, rtol=1e-5)
    assert result.state.positions.mean() == pytest.approx(4.5 + 30, rel=1e-5)  # no net force


@pytest.mark.slow
def test_random_draws_stay_finite_and_bounded():
    rng = np.random.default_rng(20261122)
    failed = 0
    for i in range(160):
        length = float(rng.uniform(3, 30))
        jet = PowerLaw(**PEO, k=float(rng.uniform(0.6, 1.5)), beta=float(rng.uniform(0.3, 0.7)))
        law = LAWS[i % 4]
        chain = net.Chain(
            flow=net.Flow.from_jet(jet, length, rtol=1e-5),
            spacing=float(10 ** rng.uniform(-1.7, -0.5)),
            coupling=float(10 ** rng.uniform(-3, 15)),
            inertia=float(rng.choice([0.0, 10 ** rng.uniform(-12, 3)])),
            law=law,
            contour=float(10 ** rng.uniform(0.3, 2)),
        )
        try:
            result = net.run_chain(chain, float(rng.uniform(1, 6)), rtol=1e-2, most_steps=20_000)
        except net.ChainError:
            failed += 1
            continue
        state, profile = result.state, result.profile
        for array in (state.positions, state.tensions, state.velocities):
            assert np.all(np.isfinite(array))
        fastest = float(chain.flow.velocity_ratio(length))
        assert np.all(profile.network_velocity_ratio <= fastest * (1 + 1e-2) + 1)
        if law != "linear":
            assert np.all(profile.stretch <= chain.contour * (1 + 1e-9))
            assert np.all(profile.relative_extension <= 1)
    assert failed <= 2


# --- refusals -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("spacing", 0.0),
        ("spacing", 2.0),
        ("coupling", -1.0),
        ("coupling", np.inf),
        ("spring", 0.0),
        ("inertia", -1e-9),
        ("inertia", [0.0, 1.0]),
        ("coarse_grain", 0.5),
        ("coarse_grain", 1e6),
        ("contour", 1.0),
        ("law", "rubber"),
        ("flow", JET),
    ],
)
def test_chain_refuses(flow, field, value):
    good = {"flow": flow, "spacing": 0.01, "coupling": 100.0}
    with pytest.raises(InputError, match=field):
        net.Chain(**(good | {field: value}))


def test_other_refusals(flow, tmp_path):
    chain = net.Chain(flow=flow, spacing=0.05, coupling=100)
    bounded = net.Chain(flow=flow, spacing=0.05, coupling=100, law="fene", contour=5.0)
    with pytest.raises(InputError, match="contour"):
        net.Chain(flow=flow, spacing=0.05, coupling=100, law="fene")
    for arguments, field in [
        ({"until": 0.0}, "until"),
        ({"until": 1.0, "rtol": 1.0}, "rtol"),
        ({"until": 1.0, "time_step": -1}, "time_step"),
        ({"until": 1.0, "start": "full"}, "start"),
        ({"until": 1.0, "output_times": [0.5, 0.5]}, "output_times"),
        ({"until": 1.0, "output_times": [2.0]}, "output_times"),
        ({"until": 1.0, "accurate_to": 0.0}, "accurate_to"),
    ]:
        with pytest.raises(InputError, match=field):
            net.run_chain(chain, **arguments)
    with pytest.raises(InputError, match="contour"):
        net.affine_start(bounded)
    with pytest.raises(InputError, match="positions"):
        net.start_from(chain, [0.0, 1.0])
    with pytest.raises(InputError, match="length"):
        net.Flow.from_jet(Table(z=[0, 1e-3], radius=[1e-4, 5e-5], flow_rate=1e-9), 40.0)
    with pytest.raises(InputError, match="start at the nozzle"):
        net.Flow.from_jet(Table(z=[1e-4, 1e-3], radius=[1e-4, 5e-5], flow_rate=1e-9), 4.0)
    with pytest.raises(InputError, match="velocity_ratio"):
        net.Flow.from_jet(3.0, 4.0)
    with pytest.raises(InputError, match="times"):
        net.Flow.from_profiles([smooth, smooth], [1.0, 0.0], 4.0)
    with pytest.raises(InputError, match="velocity_ratio"):
        net.Flow.from_profiles([lambda s: 1 - s], [0.0], 4.0)
    with pytest.raises(InputError, match="rough"):
        net.Flow.from_profiles([lambda s: 2 + np.sin(1e7 * s)], [0.0], 4.0)
    with pytest.raises(net.ChainError, match="most_steps"):
        net.run_chain(chain, 5.0, most_steps=3)


def test_importing_the_package_compiles_nothing():
    code = "import sys, spinline.network; assert 'numba' not in sys.modules; import spinline.network as n; n.Chain"
    subprocess.run([sys.executable, "-c", code], check=True)


# --- the reference in which ages are counted --------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [100.0, 500.0, 2e3, 2e4])
def test_the_reference_is_the_speed_of_a_settled_chain(flow, alpha):
    """From layers longer than a spacing (eps = 0.01) to much shorter (5e-5), bead by bead through the kink."""
    chain = net.Chain(flow=flow, spacing=2e-3, coupling=alpha)
    state = net.run_chain(chain, 3.0, start="affine", rtol=1e-6).state
    span = steady_reference(chain, flow.segment(0.0))
    assert span.weight == 0.0
    inside = (state.positions > 0.02) & (state.positions < 2)
    x = state.positions[inside]
    moving = state.velocities[inside] * hermite(x, span.nodes, span.age[1], span.slowness[1])[1] - 1
    slip = state.velocities[inside] / flow.velocity_ratio(x) - 1
    assert np.abs(slip).max() > 0.5 / alpha  # of the jet: eps V'
    assert np.abs(moving).max() < 0.03 * np.abs(slip).max()
    # and the physics is that of the jet still
    np.testing.assert_allclose(
        1 / hermite(x, span.nodes, span.age[0], span.slowness[0])[1], flow.velocity_ratio(x), rtol=1e-12
    )


def test_naming_the_kink_saves_steps_and_changes_nothing_else(flow):
    unnamed = replace(flow, kinks=())
    runs = []
    for jet, rtol in ((flow, 1e-4), (unnamed, 1e-6)):
        runs.append(net.run_chain(net.Chain(flow=jet, spacing=0.005, coupling=200), 3.0, rtol=rtol))
    s = np.linspace(0.9, 4, 300)
    np.testing.assert_allclose(runs[0].stretch_at(s), runs[1].stretch_at(s), rtol=2e-5)
    assert runs[0].state.steps < 0.2 * runs[1].state.steps


def test_no_reference_where_there_is_no_steady_network():
    steep = net.Flow.from_profiles([lambda s: 1 + 0.5 * s], [0.0], 10.0)
    changing = net.Flow.switching(JET, JET, 10.0, at=1.0, over=1.0)
    for flow, coupling, time in ((steep, 1.0, 0.0), (changing, 100.0, 1.5), (steep, 1e12, 0.0)):
        chain = net.Chain(flow=flow, spacing=0.05, coupling=coupling)
        assert steady_reference(chain, flow.segment(time)).weight is None


def test_a_jet_that_stretches_by_twelve_decades_fits_a_table():
    flow = net.Flow.from_profiles([lambda s: np.exp(np.log(1e12) * s / 9)], [0.0], 9.0)
    s = np.linspace(0, 9, 1001)
    np.testing.assert_allclose(flow.velocity_ratio(s), 1e12 ** (s / 9), rtol=1e-7)
    exact = -np.expm1(-np.log(1e12) * s / 9) * 9 / np.log(1e12)
    np.testing.assert_allclose(flow.residence_time(s), exact, rtol=1e-9, atol=1e-15)


# --- stick and slip


def test_a_period_between_entries():
    """Linear springs: the average is the snapshot; a front of locking: the range is reported, and no snapshot is outside it."""
    flow = net.Flow.from_jet(JET, 16.0)
    s = np.linspace(2.0, 14.0, 80)
    loose = net.Chain(flow=flow, spacing=0.02, coupling=100)
    settled = net.run_chain(loose, 8.0, rtol=1e-5)
    cycle = net.chain.chain_cycle(loose, settled.state, s, rtol=1e-5)
    assert cycle.swing < 1e-4
    np.testing.assert_allclose(cycle.mean, settled.stretch_at(s), rtol=1e-4)
    stiff = net.Chain(flow=flow, spacing=0.2, coupling=1e5, law="langevin", contour=6.0)
    state = net.run_chain(stiff, 12.0, rtol=1e-3).state
    cycle = net.chain.chain_cycle(stiff, state, s, moments=8, rtol=1e-3)
    assert len(cycle.profiles) == 8
    assert (cycle.low <= cycle.mean * (1 + 1e-12)).all()
    assert (cycle.mean <= cycle.high * (1 + 1e-12)).all()
    assert cycle.swing >= 0
    with pytest.raises(InputError, match="moments"):
        net.chain.chain_cycle(loose, settled.state, s, moments=1)
    fixed = net.Chain(flow=flow, spacing=0.1, coupling=10.0, entry=False)
    with pytest.raises(InputError, match="no entries"):
        net.chain.chain_cycle(fixed, net.start_from(fixed, np.linspace(8, 1, 36)), s)
