"""Every known trap of the text formats, made by editing real files."""

import re
import shutil

import numpy as np
import pytest
import xarray as xr
from jetspin_damage import DATA, L0, copied_run, edit, read, xyz

from spinline.base.errors import InputError
from spinline.jetprofile import read_jetspin
from spinline.jetprofile.jetspin import read_statistics
from spinline.jetprofile.jetspin.units import to_float


@pytest.fixture
def run(tmp_path):
    """An own copy of the PVP run, to be damaged."""
    return copied_run(tmp_path / "pvp3d")


# --- numbers


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.5520854571-127", 0.5520854571e-127),
        ("  -1.5+101 ", -1.5e101),
        ("1.d-7", 1e-7),
        ("10000.d", 1e4),
        ("0.02d0", 0.02),
        ("Infinity", np.inf),
        ("**********", np.nan),
        ("", np.nan),
        ("1_0", np.nan),
        ("٣", np.nan),
        ("12abc", np.nan),
    ],
)
def test_numbers_of_fortran(text, value):
    np.testing.assert_equal(to_float(text), value)


def test_text_numbers_to_the_last_bit(run):
    data, _ = read(run, source="frame*.xyz", time=0.005)
    lines = (run / "frame000005.xyz").read_text().splitlines()[2:]
    for axis, at in zip("xyz", (8, 18, 28), strict=True):
        expected = np.array([float(line[at : at + 10]) for line in lines])[::-1] * 0.01
        np.testing.assert_array_equal(data[axis].values[0, : len(lines)], expected)


def test_joined_fields_and_asterisks(tmp_path):
    text = xyz([(1.0, [(100.0, 814.79519, -373.91420), (90.0, 1.0, 2.0), (50.0, 0, 0), (0, 0, 0)])])
    assert b"100.00000 814.79519-373.91420" in text
    (tmp_path / "frame000001.xyz").write_bytes(text)
    data, _ = read(tmp_path / "frame000001.xyz", unit="cm")
    assert float(data.z[0, 3]) == pytest.approx(-3.7391420)
    (tmp_path / "frame000001.xyz").write_bytes(text.replace(b"  90.00000   1.00000", b"**********-814.79519"))
    data, messages = read(tmp_path / "frame000001.xyz", unit="cm")
    assert any("1 rows hold asterisks" in text for text in messages)
    np.testing.assert_array_equal(data.valid_element[0], [True, False, False])
    np.testing.assert_array_equal(np.isnan(data.arc_length[0]), [False, False, True, True])


# --- units


def test_no_unit_no_reading(run, tmp_path):
    alone = tmp_path / "alone"
    alone.mkdir()
    for name in ("traj.xyz", "frame000025.xyz"):
        shutil.copy(run / name, alone)
        with pytest.raises(InputError, match=r"length unit is not known.*log\.txt"):
            read_jetspin(alone / name)
    with pytest.raises(InputError, match="internal length unit"):
        read_jetspin(alone / "traj.xyz", unit="internal")
    for wrong in ("inch", 0, -1.0, float("nan"), "1"):
        with pytest.raises(InputError, match="unit"):
            read_jetspin(alone / "traj.xyz", unit=wrong)
    data, messages = read(alone / "traj.xyz", unit=L0)
    assert float(data.x.max()) == pytest.approx(0.16)
    assert any("no radius" in text for text in messages)
    assert any("collector distance" in text for text in messages)
    assert np.isnan(data.radius).all()


def test_unit_from_statistics_beside(run, tmp_path):
    for name in ("traj.xyz", "statout.dat"):
        shutil.copy(run / name, tmp_path)
    data, _ = read(tmp_path / "traj.xyz")
    assert "statout.dat" in data.attrs["length_unit_source"]
    assert float(data.x.max()) == pytest.approx(0.16, rel=1e-5)


@pytest.mark.parametrize("kept", ["log.txt", "input.dat"])
def test_unit_from_either_setup(run, tmp_path, kept):
    for name in ("traj.xyz", kept):
        shutil.copy(run / name, tmp_path)
    data, messages = read(tmp_path / "traj.xyz")
    assert float(data.x.max()) == pytest.approx(0.16, rel=1e-8)
    assert kept in data.attrs["length_unit_source"]
    assert messages == []


def test_foreign_setup_is_contradicted(run):
    shutil.copy(DATA / "airdrag_counterflow" / "log.txt", run)
    (run / "input.dat").unlink()
    _, messages = read(run, source="traj.xyz")
    assert any("lengths are in doubt" in text for text in messages)
    shutil.copy(DATA / "quasi_newtonian_kv" / "input.dat", run)
    _, messages = read(run, source="traj.xyz")
    assert any("disagree" in text for text in messages)


def test_wrong_unit_of_the_caller_is_contradicted(run):
    data, messages = read(run / "traj.xyz", unit="cm")
    assert any("statout.dat says" in text for text in messages)
    assert any("beyond the collector" in text for text in messages)
    assert "given by the caller" in data.attrs["length_unit_source"]


def test_renamed_file_is_known_by_its_padding(run):
    (run / "traj.xyz").rename(run / "mine.xyz")
    data, _ = read(run / "mine.xyz")
    assert float(data.x.max()) == pytest.approx(0.16)
    (run / "frame000025.xyz").rename(run / "other.xyz")
    (run / "statout.dat").unlink()
    with pytest.raises(InputError, match="length unit"):
        read_jetspin(run / "other.xyz")


def test_binary_takes_no_unit(run):
    with pytest.raises(InputError, match="its own units"):
        read_jetspin(run / "traj.dat", unit="cm")


# --- structure of the text


def test_crlf_is_the_same(run):
    plain, _ = read(run, source="traj.xyz")
    single, _ = read(run, source="frame*.xyz")
    table = read_statistics(run / "statout.dat")
    for path in run.iterdir():
        if path.suffix == ".xyz" or path.name in ("log.txt", "input.dat", "statout.dat"):
            path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    again, messages = read(run, source="traj.xyz")
    xr.testing.assert_identical(plain, again)
    xr.testing.assert_identical(single, read(run, source="frame*.xyz")[0])
    xr.testing.assert_identical(table, read_statistics(run / "statout.dat"))
    assert messages == []


def test_killed_and_restarted(run):
    """Cut inside a row of padding, then frames appended from an earlier time; the next header is glued."""
    content = (run / "traj.xyz").read_bytes()
    before, _ = read(run, source="traj.xyz")
    size = len(content) // 50
    again = bytearray(content[38 * size :])
    at = again.index(b"C  ") + 60 * 39 + 8
    again[at : at + 10] = f"{float(again[at : at + 10]) + 0.001:10.5f}".encode()
    cut = 41 * size + 140 * 39 + 31
    (run / "traj.xyz").write_bytes(content[:cut] + again)
    assert re.search(rb"\nC [^\n]* 150\nframe at time", (run / "traj.xyz").read_bytes())
    data, messages = read(run, source="traj.xyz")
    assert data.sizes["time"] == 50
    np.testing.assert_allclose(np.diff(data.time), 5e-4, rtol=1e-6)
    assert any("3 frames superseded by a restart" in text for text in messages)
    assert any("number of rows" in text for text in messages)
    assert "superseded" in data.attrs["dropped"]
    moved = (data.x - before.x).values
    bead = int(before.n_bead[38]) - 1 - 60
    assert moved[38, bead] == pytest.approx(0.001 * L0, rel=1e-4)  # the later record of a time is kept
    assert np.count_nonzero(np.nan_to_num(moved)) == 1


def test_killed_inside_a_number(run):
    content = (run / "traj.xyz").read_bytes()
    whole, _ = read(run, source="traj.xyz")
    (run / "traj.xyz").write_bytes(content[:-1734])
    data, messages = read(run, source="traj.xyz")
    xr.testing.assert_equal(data.x, whole.x[:49, : data.sizes["bead"]])
    assert any("last frame is cut off" in text for text in messages)
    last, _ = read(run, source="traj.xyz", time="last")
    assert float(last.time[0]) == pytest.approx(0.0245)


def test_no_newline_at_the_end_is_no_damage(run):
    content = (run / "traj.xyz").read_bytes()
    (run / "traj.xyz").write_bytes(content[:-1])
    data, messages = read(run, source="traj.xyz")
    assert (data.sizes["time"], messages) == (50, [])


def test_one_damaged_row_costs_two_elements(run):
    whole, _ = read(run, source="frame*.xyz", time=0.025)
    lines = (run / "frame000025.xyz").read_bytes().splitlines(keepends=True)
    for new, valid_lost in (
        (b"C         14.x6780", 2),
        (b"X         14.06780", 0),
        (b"C        14.06780 ", 2),
    ):
        damaged = list(lines)
        damaged[12] = new + damaged[12][18:]
        (run / "frame000025.xyz").write_bytes(b"".join(damaged))
        data, messages = read(run, source="frame*.xyz", time=0.025)
        assert len(messages) >= 1
        lost = int(whole.valid_element.sum() - data.valid_element.sum())
        assert lost == valid_lost


def test_lost_newline_and_odd_lines(run):
    content = (run / "traj.xyz").read_bytes()
    size = len(content) // 50
    at = 10 * size + 58 + 38 + 5 * 39  # end of the sixth row of frame 10
    flipped = bytearray(content)
    assert flipped[at + 0] in b"\n0123456789C. "
    at = content.index(b"\n", 10 * size + 400)
    flipped[at] = 0x4A
    (run / "traj.xyz").write_bytes(bytes(flipped))
    data, messages = read(run, source="traj.xyz")
    assert data.sizes["time"] == 50
    assert any("damaged outside their numbers" in text for text in messages)
    (run / "traj.xyz").write_bytes(content[:at] + content[at + 1 :])
    data, messages = read(run, source="traj.xyz")
    assert data.sizes["time"] == 49
    assert len(messages) == 1


def test_digit_that_folds_the_jet(run):
    """A digit flipped in the positions makes a kink no other frame has."""
    content = (run / "traj.xyz").read_bytes()
    size = len(content) // 50
    at = 30 * size + content[30 * size :].index(b"C") + 60 * 39
    x = content[at + 8 : at + 18]
    wrong = f"{float(x) + 100:10.5f}".encode()
    (run / "traj.xyz").write_bytes(content[: at + 8] + wrong + content[at + 18 :])
    data, messages = read(run, source="traj.xyz")
    assert any("1 beads far off the line" in text for text in messages)
    inside = np.isfinite(data.radius.values[30])
    assert (~data.valid_element.values[30] & inside & ~data.deposited.values[30, 1:]).sum() == 2
    alone, messages = read(run, source="traj.xyz", time=float(data.time[30]))
    assert any("1 beads far off the line" in text for text in messages)
    np.testing.assert_array_equal(alone.valid_element[0], data.valid_element[30, : alone.sizes["element"]])


def test_header_damage(run):
    content = (run / "traj.xyz").read_bytes()
    size = len(content) // 50
    for old, new in (
        (b"       150", b"       950"),
        (b"       150", b"       015"),
        (b"       150", b"      1x50"),
        (b"frame at time", b"frame at t\x00me"),
        (b"frame at time    0.1", b"frame at time    0.x"),
        (b"frame at time    0.1", b"frame at time    0*1"),
        (b"frame at time    0.1000000000E-01", b"frame at time    0.1000000000E+01"),
        (b"frame at time    0.1000000000E-01", b"frame at time    0.1000000000E-03"),
        (b"frame at time    0.1000000000E-01", b"frame at time   -0.1000000000E-01"),
        (b"frame at time    0.1000000000E-01", b"frame at time             NaN    "),
    ):
        frame = content[19 * size : 20 * size]
        assert old in frame
        (run / "traj.xyz").write_bytes(content[: 19 * size] + frame.replace(old, new, 1) + content[20 * size :])
        data, messages = read(run, source="traj.xyz")
        assert data.sizes["time"] == 49, new
        assert len(messages) == 1, (new, messages)
        assert data.attrs["dropped"]


def test_last_time_is_doubted(run):
    edit(run / "traj.xyz", b"0.2500000000E-01", b"0.2500000000E+01")
    data, messages = read(run, source="traj.xyz")
    assert data.sizes["time"] == 50
    assert any("its time may be damaged" in text for text in messages)


def test_absurd_count_asks_for_no_memory(tmp_path):
    text = xyz([(1.0, [(2.0, 0, 0), (0, 0, 0)])]).replace(b"         2", b"9999999999")
    (tmp_path / "traj.xyz").write_bytes(text)
    with pytest.raises(InputError, match="no whole frame"):
        read_jetspin(tmp_path / "traj.xyz", unit="cm")


def test_nozzle_missing():
    data, messages = read(DATA / "ex2_1d_insert", source="traj.xyz")
    missing = data.nozzle_missing.values
    assert 0 < missing.sum() < len(missing)
    assert any("maxnumber" in text for text in messages)
    assert np.isnan(data.arc_length.values[missing]).all()
    assert np.isfinite(data.radius.values[missing][:, :90]).all()
    assert (data.x.values[missing, 0] > 0).all()
    assert (data.n_bead.values[missing] == 100).all()


def test_coincident_beads_at_the_collector(tmp_path):
    shutil.copy(DATA / "ex2_1d_insert" / "input.dat", tmp_path)
    text = xyz([(1.0, [(200.0, 0, 0), (200.0, 0, 0), (150.0, 0, 0), (0, 0, 0)])])
    (tmp_path / "frame000001.xyz").write_bytes(text)
    data, messages = read(tmp_path / "frame000001.xyz")
    np.testing.assert_array_equal(data.deposited[0], [False, False, True, True])
    np.testing.assert_array_equal(data.valid_element[0], [True, False, False])
    assert np.isnan(data.radius.values[0, 2])
    assert "no length" in data.attrs["dropped"]
    assert messages == []


def test_coordinates_out_of_bounds(run):
    lines = (run / "frame000025.xyz").read_bytes().splitlines(keepends=True)
    lines[50] = lines[50][:8] + b"9999.99999" + lines[50][18:]
    lines[90] = lines[90][:8] + b"  -0.50000" + lines[90][18:]
    (run / "frame000025.xyz").write_bytes(b"".join(lines))
    data, messages = read(run / "frame000025.xyz")
    assert any("farther than 20 collector distances" in text for text in messages)
    assert any("behind the nozzle" in text for text in messages)
    assert np.isnan(data.x.values[0]).sum() == 1


def test_smallest_files(tmp_path):
    path = tmp_path / "traj.xyz"
    path.write_bytes(b"")
    with pytest.raises(InputError, match="empty"):
        read_jetspin(path)
    path.write_bytes(xyz([(1.0, [(0, 0, 0)])]))
    data, _ = read(path, unit="cm")
    assert dict(data.sizes) == {"time": 1, "bead": 1, "element": 0}
    path.write_bytes(xyz([(1.0, [(1, 0, 0), (0, 0, 0)])], maxnumber=7))
    assert read(path, unit="cm")[0].sizes["bead"] == 2
