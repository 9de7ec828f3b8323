"""From the jet to fibres in the collector's frame: collectors, touch-down, records, files, maps, the surrogate."""

import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import spinline.deposit as dep
from spinline.base.errors import InputError
from spinline.deposit.fibres import CHUNK
from spinline.deposit.landing import feed_remark

# -- collectors, Eqs. (46) and (47) --------------------------------------------------------------


def test_drum_returns_the_place_of_touch_down_where_the_printed_eq47_does_not():
    """Printed: z_touch - R_D cos(beta_touch) at t_touch: 0.00426 m. Right: z_D - R_D cos(beta): 0.10213 m."""
    drum = dep.Drum(distance=0.1, rotation=25.0, radius=0.1)
    beta = np.deg2rad(11.842)
    place = np.array([drum.axis - 0.1 * np.cos(beta), 0.1 * np.sin(beta), 0.03])
    laid = drum.laid(place, 7.0)
    back = drum.position(laid, 7.0)
    np.testing.assert_allclose(back, place, atol=1e-13)
    assert round(float(back[0]), 5) == 0.10213
    printed = place[0] - 0.1 * np.cos(beta)
    assert round(float(printed), 5) == 0.00426
    assert float(drum.gap(place)) == pytest.approx(0, abs=1e-15)


def test_layers_of_a_drum_differ_in_psi_where_they_share_a_place():
    drum = dep.Drum(distance=0.1, rotation=2 * np.pi, radius=0.05)  # one turn a second
    laid = drum.laid([[0.1, 0.0, 0.0]] * 2, [0.0, 1.0])
    np.testing.assert_allclose(drum.position(laid[0], 5.0), drum.position(laid[1], 5.0), atol=1e-14)
    psi = drum.circumferential(laid, 1.0)
    assert psi[0] - psi[1] == pytest.approx(2 * np.pi * 0.05)


@pytest.mark.parametrize(
    "surface",
    [dep.Plate(0.2), dep.Belt(0.2, 3.0), dep.Belt(0.2, -3.0), dep.Drum(0.2, 30.0, 0.1), dep.Drum(0.2, -30.0, 0.1)],
)
def test_material_points_move_with_the_surface(surface):
    rng = np.random.default_rng(3)
    if surface.kind == "drum":
        beta = rng.uniform(-1, 1, 8)
        place = np.stack([surface.axis - 0.1 * np.cos(beta), 0.1 * np.sin(beta), rng.uniform(-0.1, 0.1, 8)], -1)
    else:
        place = np.stack([np.full(8, 0.2), *rng.uniform(-0.1, 0.1, (2, 8))], -1)
    velocity = surface.surface_velocity(place)
    if surface.kind == "plate":
        assert not velocity.any()
        return
    laid = surface.laid(place, 2.0)
    later = surface.position(laid, 2.0 + 1e-6)
    np.testing.assert_allclose((later - place) / 1e-6, velocity, atol=3e-4)
    np.testing.assert_allclose(np.linalg.norm(velocity, axis=-1), abs(surface.surface_speed), rtol=1e-12)


@pytest.mark.parametrize(
    ("keys", "field"),
    [
        ({"kind": "plate", "distance": 0.0}, "collector.distance"),
        ({"kind": "plate", "distance": 0.1, "speed": 1.0}, "collector.speed"),
        ({"kind": "belt", "distance": 0.1}, "collector.speed"),
        ({"kind": "belt", "distance": 0.1, "speed": np.nan}, "collector.speed"),
        ({"kind": "drum", "distance": 0.1, "radius": 0.1}, "collector"),
        ({"kind": "drum", "distance": 0.1, "radius": 0.1, "speed": 1.0, "rotation": 2.0}, "collector"),
        ({"kind": "mesh", "distance": 0.1}, "collector.kind"),
    ],
)
def test_collectors_refuse_by_name(keys, field):
    with pytest.raises(InputError) as error:
        dep.collector(**keys)
    assert error.value.field == field


# -- touch-down ----------------------------------------------------------------------------------


def test_touch_down_of_a_cubic_path_is_exact():
    """A bead under constant acceleration moves on a cubic the scheme represents: root against the quadratic's."""
    t1, g = 0.01, 9.81
    x0, v0 = 0.19, np.array([2.0, 0.3, -0.1])
    x1 = x0 + v0[0] * t1 + g * t1**2 / 2
    start, end = np.array([[x0, 0, 0]]), np.array([[x1, v0[1] * t1, v0[2] * t1]])
    out = dep.touch_down(dep.Plate(0.2), 0.0, t1, start, end, v0[None], (v0 + np.array([g * t1, 0, 0]))[None])
    exact = (-v0[0] + np.sqrt(v0[0] ** 2 + 2 * g * 0.01)) / g
    assert out.time[0] == pytest.approx(exact, rel=1e-13)
    np.testing.assert_allclose(out.position[0], [0.2, v0[1] * exact, v0[2] * exact], rtol=1e-12)
    np.testing.assert_allclose(out.velocity[0], v0 + np.array([g * exact, 0, 0]), rtol=1e-11)


def test_a_bead_turned_round_by_a_gust_lands_within_the_step():
    """Backing up by gap over the present normal speed (1e-9 m/s) would put it a million seconds back."""
    start, end = np.array([[0.199, 0.0, 0.0]]), np.array([[0.2001, 0.0, 0.0]])
    out = dep.touch_down(dep.Plate(0.2), 1.0, 1.001, start, end, np.array([[3.0, 0, 0]]), np.array([[-1e-9, 0, 0]]))
    assert out.landed[0]
    assert 1.0 < out.time[0] < 1.001


def test_a_dip_within_one_step_lands_at_its_first_crossing():
    """Both ends fly; between, the bead is below the plate."""
    start = end = np.array([[0.1999, 0.0, 0.0]])
    out = dep.touch_down(dep.Plate(0.2), 0.0, 1e-3, start, end, np.array([[2.0, 0, 0]]), np.array([[-2.0, 0, 0]]))
    assert out.landed[0]
    exact = (1 - np.sqrt(1 - 4 * 0.05)) / 2  # 4 * 0.0005 u (1 - u) = 1e-4
    assert out.time[0] == pytest.approx(1e-3 * exact, rel=1e-12)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.05, 0.1999),
    st.floats(-0.05, 0.05),
    st.floats(1e-6, 0.1),
    st.floats(-0.05, 0.05),
    st.sampled_from([dep.Plate(0.2), dep.Drum(0.2, 10.0, 0.3)]),
)
def test_touch_down_is_on_the_surface_and_in_the_step(x0, y0, beyond, y1, surface):
    start, end = np.array([[x0, y0, 0.0]]), np.array([[0.25 + beyond, y1, 0.1]])
    out = dep.touch_down(surface, 5.0, 5.1, start, end)
    assert out.landed[0]
    assert 5.0 <= out.time[0] <= 5.1
    assert abs(float(surface.gap(out.position[0]))) < 1e-15 + 1e-14


def test_touch_down_refuses_a_step_of_no_length_and_half_a_velocity():
    p = np.zeros((1, 3))
    with pytest.raises(InputError, match="not after"):
        dep.touch_down(dep.Plate(1.0), 1.0, 1.0, p, p)
    with pytest.raises(InputError, match="together"):
        dep.touch_down(dep.Plate(1.0), 0.0, 1.0, p, p, start_velocity=p)


# -- records, laying, balances -------------------------------------------------------------------


def circle_record(speed=5.0, omega=1e4, count=4001, turns=40):
    """A jet that whips on a circle: laid length, volume and charge known."""
    time = np.linspace(0, turns * 2 * np.pi / omega, count)
    r = speed / omega
    place = np.stack([np.full(count, 0.2), r * np.cos(omega * time), r * np.sin(omega * time)], -1)
    flight = np.full(count, 2 * r * np.sin(omega * time[1] / 2) * 1.2)  # coils of 20 % below the mesh
    volume = np.pi * (3e-7) ** 2 * flight
    charge = np.linspace(1e-15, 3e-15, count)
    fed = float(volume[1:].sum()) * 1.5
    balance = {
        "volume_fed": fed,
        "volume_in_flight": fed - float(volume[1:].sum()),
        "volume_evaporated": 0.0,
        "charge_fed": float(charge[1:].sum()) + 1e-13,
        "charge_in_flight": 1e-13,
        "charge_conducted": 0.0,
    }
    return dep.LandingRecord.from_arrays(time, place, volume, flight, charge=charge, balance=balance)


@pytest.mark.parametrize("q", [0.0, 0.25, 0.5, 1.0, 2.0, 4.0])
def test_a_whipping_jet_on_a_belt_is_the_trochoid(q):
    """Laid length, order parameter, and volume against closed forms; mesh of 100 points a turn: 1e-3."""
    record = circle_record()
    segments = dep.lay(record, dep.Belt(0.2, 5.0 * q))
    time = record.touch_time[-1]
    rate = segments.chord.sum() / time / 5.0
    assert rate == pytest.approx(float(dep.trochoid_length_rate(q)), rel=1e-3)
    order = dep.order_of(segments.angle, segments.chord)
    assert order.order_parameter == pytest.approx(float(dep.trochoid_order(q)), abs=1.5e-3)
    assert segments.volume.sum() == pytest.approx(record.volume.sum(), rel=1e-12)
    np.testing.assert_allclose(segments.radius, 3e-7, rtol=1e-12)  # the flight's, whatever the belt does
    if q == 0:
        np.testing.assert_allclose(segments.excess, 1.2, rtol=1e-9)


def test_closed_forms_of_the_trochoid():
    table = {
        0: (1, 0, 0),
        0.25: (1.01568701, 0.023198, 0),
        0.5: (1.06354441, 0.090130, 0),
        1: (1.27323954, 1 / 3, 0),
        2: (2.12708882, 0.772532, 0.75),
        4: (4.06274805, 0.938950, 0.9375),
    }
    for q, (rate, by_length, by_time) in table.items():
        assert float(dep.trochoid_length_rate(q)) == pytest.approx(rate, rel=5e-9)
        assert float(dep.trochoid_order(q)) == pytest.approx(by_length, abs=5e-7)
        assert float(dep.trochoid_order(q, "time")) == pytest.approx(by_time, abs=1e-15)
    for q in (1e-6, 0.0999, 0.1, 0.3, 1.7, 50.0):  # both branches against quadrature
        speed = lambda a, q=q: np.sqrt(1 + q * q + 2 * q * np.cos(a))  # noqa: E731
        length = quad(speed, 0, np.pi, epsabs=1e-14, epsrel=1e-13)[0]
        across = quad(lambda a: np.sin(a) ** 2 / speed(a), 0, np.pi, epsabs=1e-14, epsrel=1e-13)[0]  # noqa: B023
        assert float(dep.trochoid_order(q)) == pytest.approx(1 - 2 * across / length, rel=1e-9, abs=1e-13)


def test_balance_of_volume_and_charge_closes_to_rounding():
    record = circle_record()
    assert all(abs(left) < 1e-12 for left in record.imbalance().values())
    assert set(record.imbalance()) == {"volume", "charge"}
    again = dep.LandingRecord.from_dataset(record.to_dataset())
    assert again.imbalance() == record.imbalance()
    np.testing.assert_array_equal(again.charge, record.charge)
    short = dep.LandingRecord.from_dataset(
        record.to_dataset().assign_attrs(volume_fed=record.balance["volume_fed"] * 1.01)
    )
    assert abs(short.imbalance()["volume"]) > 1e-3


def test_fibres_are_laid_in_order_of_touch_down_and_not_joined():
    time = [0.0, 0.2, 0.4, 0.1, 0.3]
    place = np.zeros((5, 3))
    place[:, 1] = [0, 1, 2, 10, 11]
    record = dep.LandingRecord.from_arrays(time, place, 1e-12, 1.0, fibre=[0, 0, 0, 1, 1])
    s = dep.lay(record, dep.Plate(0.2))
    assert len(s) == 3
    np.testing.assert_array_equal(s.touch_time, [0.2, 0.3, 0.4])
    np.testing.assert_array_equal(s.x, [0, 10, 1])
    np.testing.assert_array_equal(s.fibre, [0, 1, 0])


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"touch_time": [0.0, np.nan, 1.0]}, "touch_time"),
        ({"touch_time": [0.0, 2.0, 1.0]}, "touch_time"),
        ({"volume": [0.0, 1e-12, -1e-12]}, "volume"),
        ({"flight_length": [np.nan, 0.0, 1.0]}, "flight_length"),
        ({"position": np.zeros((3, 2))}, "position"),
        ({"polymer_fraction": [1.0, 1.0, 1.5]}, "polymer_fraction"),
        ({"jet": [0, 1]}, "jet"),
        ({"fibre": [0, 0.5, 1]}, "fibre"),
    ],
)
def test_records_refuse_by_name(change, field):
    good = {"touch_time": [0.0, 1.0, 2.0], "position": np.zeros((3, 3)), "volume": 1e-12, "flight_length": 1.0}
    with pytest.raises(InputError) as error:
        dep.LandingRecord.from_arrays(**{**good, **change})
    assert error.value.field == field


def test_frames_with_labels_give_the_landings_of_straight_flight():
    """Beads fall at 10 m/s, one every 0.1 ms; frames every 0.7 ms: times to rounding, flight length 1 mm."""
    frames = []
    for k in range(30):
        t = 7e-4 * k
        left = 1e-4 * np.arange(200)
        there = left <= t
        x = np.minimum(10 * (t - left[there]), 0.105)  # beads rest 5 mm below: the surface must be found
        position = np.stack([x, 0.1 * left[there], np.zeros(there.sum())], -1)
        velocity = np.tile([10.0, 0, 0], (there.sum(), 1)) * (x < 0.105)[:, None]
        frames.append(dep.BeadFrame(t, np.flatnonzero(there), position, 1e-12, velocity))
    record = dep.landings_from_frames(frames, dep.Plate(0.1))
    np.testing.assert_allclose(np.diff(record.touch_time), 1e-4, rtol=0.6)  # a clamped end bends the cubic of one frame
    unbent = dep.landings_from_frames(
        [
            f._replace(
                position=np.column_stack([10 * (f.time - 1e-4 * f.label), 0.1e-4 * f.label, 0 * f.label]),
                velocity=np.tile([10.0, 0, 0], (len(f.label), 1)),
            )
            for f in frames
        ],
        dep.Plate(0.1),
    )
    np.testing.assert_allclose(unbent.touch_time, 0.01 + 1e-4 * np.arange(unbent.touch_time.size), rtol=1e-12)
    np.testing.assert_allclose(unbent.flight_length[1:], np.hypot(1e-3, 1e-5), rtol=1e-9)
    assert (unbent.fibre == 0).all()


def test_frames_refuse_what_cannot_be_followed():
    one = dep.BeadFrame(0.0, [0, 1], np.zeros((2, 3)), 1e-12)
    with pytest.raises(InputError, match="order of time"):
        dep.landings_from_frames([one, one], dep.Plate(0.1))
    with pytest.raises(InputError, match="twice"):
        dep.landings_from_frames([one._replace(label=[1, 1])], dep.Plate(0.1))
    with pytest.raises(InputError, match="0 landings"):
        dep.landings_from_frames([one, one._replace(time=1.0)], dep.Plate(0.1))


def test_a_real_jetspin_run_lays_its_fibre(jetspin_landed):
    """bead.dat of the PVP run: lands on its circle; the laid volume is what the table holds."""
    record = dep.landings_from_table(jetspin_landed)
    segments = dep.lay(record, dep.Plate(0.16))
    assert len(segments) > 20
    np.testing.assert_allclose(segments.excess, 1, atol=1e-6)  # its element lengths are the distances between landings
    settled = record.touch_time[1:] > 0.02
    reach = np.hypot(segments.x, segments.y)
    assert np.median(reach[settled]) == pytest.approx(3.914e-2, rel=5e-3)  # the run's landing circle and radius
    assert np.median(segments.radius[settled]) == pytest.approx(3.447e-6, rel=5e-3)
    assert segments.volume.sum() == pytest.approx(record.volume.sum(), rel=1e-12)


@pytest.fixture(scope="module")
def jetspin_landed(tmp_path_factory):
    import spinline as sl

    run = tmp_path_factory.mktemp("pvp3d")
    bundled = Path(sl.__file__).parent / "data" / "scenes" / "pvp3d"
    for name in ("log.txt", "input.dat"):
        shutil.copy(bundled / name, run)
    shutil.copy(Path(__file__).parent / "data" / "jetspin" / "pvp3d" / "bead.dat", run)
    return sl.jetprofile.read_jetspin(run / "bead.dat")


# -- the file ------------------------------------------------------------------------------------


def some_segments(n=1000, seed=1):
    rng = np.random.default_rng(seed)
    path = np.cumsum(rng.normal(scale=1e-4, size=(n + 1, 2)), axis=0)
    return dep.Segments.from_paths([path], 3e-7)


def test_file_of_fibres_round_trip_and_sums(tmp_path):
    s = some_segments()
    with dep.FibreWriter(tmp_path / "f.h5", {"scene": "test", "seed": 3}) as file:
        for k in range(0, 1000, 130):
            file.write(s.take(slice(k, k + 130)))
    with dep.FibreFile(tmp_path / "f.h5") as file:
        assert file.rows == 1000
        back = file.read()
        assert sum(map(len, file.chunks(77))) == 1000
        assert file.attributes["total_volume"] == pytest.approx(s.volume.sum(), rel=1e-14)
        assert file.attributes["seed"] == 3
    np.testing.assert_array_equal(back.x, s.x)
    np.testing.assert_array_equal(back.touch_time, s.touch_time)
    np.testing.assert_allclose(back.dx, s.dx, rtol=1e-7)
    with xr.open_dataset(tmp_path / "f.h5", engine="h5netcdf") as ds:
        assert ds.sizes == {"segment": 1000}
        assert ds["radius"].attrs["units"] == "m"
        assert set(ds.data_vars) >= {"x", "y", "touch_time", "radius", "excess", "jet", "fibre"}


def test_file_of_no_fibres_and_what_is_no_file(tmp_path):
    with dep.FibreWriter(tmp_path / "none.h5"):
        pass
    with dep.FibreFile(tmp_path / "none.h5") as file:
        assert file.rows == 0
        assert len(file.read()) == 0
    (tmp_path / "text.h5").write_text("hello")
    for name, words in (("absent.h5", "does not exist"), ("text.h5", "not a file of fibres")):
        with pytest.raises(InputError, match=words):
            dep.FibreFile(tmp_path / name)
    xr.Dataset({"a": ("z", [1.0])}).to_netcdf(tmp_path / "other.h5", engine="h5netcdf")
    with pytest.raises(InputError, match="not a file of fibres"):
        dep.FibreFile(tmp_path / "other.h5")
    assert CHUNK == 262144


# -- areal density -------------------------------------------------------------------------------


def test_areal_density_sums_to_what_was_laid():
    s = some_segments(5000, 2)
    edges = np.linspace(-2e-3, 3e-3, 38), np.linspace(-4e-3, 1e-3, 11)
    found = dep.density_map(s, *edges, density=1200.0)
    assert found.content.sum() + found.outside == pytest.approx(1200 * s.dry_volume.sum(), rel=1e-12)
    assert found.outside > 0
    wide = dep.density_map(s, np.linspace(-1, 1, 41), np.linspace(-1, 1, 41))
    assert wide.outside == 0
    assert wide.content.sum() == pytest.approx(s.dry_volume.sum(), rel=1e-12)


def test_areal_density_cuts_exactly_at_cell_edges():
    s = dep.Segments.from_paths([[[0.5, 0.5], [3.5, 2.0]], [[1.0, 0.0], [1.0, 2.0]], [[3.0, 1.0], [0.0, 1.0]]], 1.0)
    edges = np.arange(5.0)
    found = dep.density_map(s, edges, edges)
    fine = np.zeros((4, 4))
    for k in range(len(s)):  # the same by sampling
        u = (np.arange(60000) + 0.5) / 60000
        i, j = np.floor(s.x[k] + u * s.dx[k]).astype(int), np.floor(s.y[k] + u * s.dy[k]).astype(int)
        np.add.at(fine, (i, j), s.volume[k] / 60000)
    np.testing.assert_allclose(found.content, fine, atol=3e-4)
    point = dep.Segments.from_paths([[[0.5, 0.5], [0.5, 0.5]]], 1.0)
    flight = point.take(slice(None))
    assert len(flight) == 1
    with pytest.raises(InputError, match="evenly"):
        dep.density_map(s, [0.0, 1.0, 3.0], edges)


# -- surrogate -----------------------------------------------------------------------------------


@pytest.mark.parametrize("noise", [0.5, 1.0, 3.0])
def test_surrogate_keeps_its_footprint_whatever_the_noise(noise):
    """Stationary density exp(-B), exact: standard deviation 1 within 4 bootstrap errors (2e6 segments)."""
    law = dep.Laydown(speed=1.0, covariance=1.0, noise=noise, radius=1e-6)
    s = dep.Segments.join(list(dep.surrogate_fibre(law, 1e5, step=0.05, seed=4)))
    found = dep.footprint_of(s, blocks=40, seed=1)
    error = np.sqrt(np.diag(found.covariance_std**2))
    assert (np.abs(np.diag(found.covariance) - 1) < 4 * np.diag(found.covariance_std)).all()
    assert (error < 0.05).all()
    assert (np.abs(found.centre) < 4 * found.centre_std).all()


def test_surrogate_on_a_belt_is_the_trochoid():
    law = dep.Laydown(speed=2.0, covariance=1.0, noise=1.0, radius=1e-6)
    s = dep.Segments.join(list(dep.surrogate_fibre(law, 5e4, step=0.05, machine_speed=2.0, seed=5)))
    assert s.chord.sum() / s.length.sum() == pytest.approx(1.27323954, abs=3e-3)
    assert dep.order_of(s.angle, s.chord).order_parameter == pytest.approx(1 / 3, abs=5e-3)


def test_surrogate_follows_from_seed_and_jet_whatever_the_blocks():
    law = dep.Laydown(speed=2.0, covariance=[[2.0, 0.5], [0.5, 1.0]], noise=1.0, radius=1e-6, radius_spread=0.2)
    one = dep.Segments.join(list(dep.surrogate_fibre(law, 50.0, step=0.05, seed=5, jet=2)))
    other = dep.Segments.join(list(dep.surrogate_fibre(law, 50.0, step=0.05, seed=5, jet=3)))
    again = dep.Segments.join(list(dep.surrogate_fibre(law, 50.0, step=0.05, seed=5, jet=2)))
    np.testing.assert_array_equal(one.x, again.x)
    assert not np.array_equal(one.x, other.x)
    with pytest.raises(InputError, match="too long"):
        list(dep.surrogate_fibre(law, 50.0, step=5.0))
    with pytest.raises(InputError, match="covariance"):
        dep.Laydown(speed=1.0, covariance=[[1.0, 2.0], [2.0, 1.0]], noise=1.0, radius=1e-6)


def test_footprint_of_a_tilted_ellipse_and_of_too_little():
    c = np.array([[2.0, 0.8], [0.8, 1.0]])
    law = dep.Laydown(speed=1.0, covariance=c, noise=1.0, radius=1e-6)
    s = dep.Segments.join(list(dep.surrogate_fibre(law, 1e5, step=0.05, seed=6)))
    found = dep.footprint_of(s)
    assert (np.abs(found.covariance - c) < 5 * found.covariance_std).all()
    assert found.tilt == pytest.approx(0.5 * np.arctan2(1.6, 1.0), abs=0.05)
    assert np.isnan(dep.footprint_of(s.take(slice(0, 5))).centre_std).all()
    with pytest.raises(InputError, match="nothing has landed"):
        dep.footprint_of(s.take(slice(0, 0)))


def test_a_surface_faster_than_the_feed_is_said():
    """Two jets laid at 2 and 4 m/s: 3 m/s on the mean."""
    time = np.tile(np.linspace(0, 1, 11), 2)
    laid = SimpleNamespace(jet=np.repeat([0, 1], 11), touch_time=time, length=np.repeat([2 / 11, 4 / 11], 11))
    assert feed_remark(laid, 2.9) == feed_remark(laid, 0.0) == ""
    told = feed_remark(laid, -3.1)
    assert "3.1 m/s" in told
    assert "fed (3 m/s)" in told
