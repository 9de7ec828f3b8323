"""Every known trap of the formats, made by editing real files."""

import shutil
import struct
import subprocess
import sys
import warnings
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from spinline.errors import InputError, SpinlineWarning
from spinline.jetprofile import read_jetspin
from spinline.jetprofile.jetspin import iter_jetspin, read_parameters, read_statistics
from spinline.jetprofile.jetspin.units import to_float

DATA = Path(__file__).parent / "data" / "jetspin"
BUNDLED = Path(str(files("spinline"))) / "data" / "jetspin" / "pvp3d"
BLOCK = 1084
L0 = 0.03487728022e-2


@pytest.fixture
def run(tmp_path):
    """An own copy of the PVP run, to be damaged."""
    folder = tmp_path / "pvp3d"
    shutil.copytree(DATA / "pvp3d", folder)
    for path in BUNDLED.iterdir():
        shutil.copy(path, folder)
    return folder


def read(*args, **options):
    """Dataset and warnings of a reading."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        data = read_jetspin(*args, **options)
    assert all(issubclass(item.category, SpinlineWarning) for item in caught)
    messages = [str(item.message) for item in caught]
    for text in data.attrs["warnings"].splitlines():
        assert any(text in message for message in messages)
    return data, messages


def edit(path, old, new, count=1):
    content = path.read_bytes()
    assert old in content
    path.write_bytes(content.replace(old, new, count))


def row(x, y, z):
    return f"C       {x:10.5f}{y:10.5f}{z:10.5f}\n".encode()


def xyz(frames, maxnumber=None):
    """An XYZ text of (time, rows), padded if `maxnumber` is given."""
    out = b""
    for number, (time, rows) in enumerate(frames, 1):
        count = maxnumber or len(rows)
        padding = [(0.0, 0.0, 0.0)] * (count - len(rows))
        out += f"{count:10d}\nframe at time{time:20.10E}{number:10d}\n".encode()
        out += b"".join(row(*beads) for beads in [*rows[:count], *padding])
    return out


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
    """Cut inside a row of padding, then frames appended from an earlier time on, the header glued to the cut."""
    content = (run / "traj.xyz").read_bytes()
    size = len(content) // 50
    again = content[38 * size : 50 * size].replace(b"C       ", b"C       ")
    changed = again.replace(b"453.69", b"453.70")
    cut = 41 * size + 140 * 39 + 31
    (run / "traj.xyz").write_bytes(content[:cut] + changed)
    whole, _ = read(run, source="traj.xyz", time=slice(0, 0.0192))
    data, messages = read(run, source="traj.xyz")
    assert data.sizes["time"] == 50
    np.testing.assert_allclose(np.diff(data.time), 5e-4, rtol=1e-6)
    assert any("3 frames superseded by a restart" in text for text in messages)
    assert any("number of rows" in text for text in messages)
    assert "superseded" in data.attrs["dropped"]
    assert whole.sizes["time"] == 38
    if b"453.70" in changed:
        assert (np.abs(data.x.values / L0 - 453.70) < 0.01).any()


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
    for new, valid_lost in ((b"C         14.x6780", 2), (b"X         14.06780", 0), (b"C        14.06780 ", 2)):
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


def test_absurd_count_asks_for_no_memory(tmp_path):
    text = xyz([(1.0, [(2.0, 0, 0), (0, 0, 0)])]).replace(b"         2", b"9999999999")
    (tmp_path / "traj.xyz").write_bytes(text)
    with pytest.raises(InputError, match="no whole frame"), pytest.warns(SpinlineWarning):
        warnings.warn("nothing was told", SpinlineWarning, stacklevel=1)
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


# --- files that are something else


def test_wrong_kinds(tmp_path, run):
    rubbish = np.random.default_rng(0).integers(0, 256, 5000, dtype=np.uint8).tobytes()
    for name in ("some.bin", "traj.xyz", "save.dat", "statout.dat", "statdat.dat", "bead.dat", "input.dat", "log.txt"):
        (tmp_path / name).write_bytes(rubbish)
        with pytest.raises(InputError), warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)
            read_jetspin(tmp_path / name)
    with pytest.raises(InputError, match=r"PDB.*frame\*\.xyz"):
        read_jetspin(run / "frame000001.pdb")
    (tmp_path / "a.psf").write_bytes(b"PSF\n\n       1 !TITLE\n")
    with pytest.raises(InputError, match="PDB or PSF"):
        read_jetspin(tmp_path / "a.psf")
    with pytest.raises(InputError, match="does not exist"):
        read_jetspin(tmp_path / "nothing")
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(InputError, match=r"no traj\.dat"):
        read_jetspin(empty)
    with pytest.raises(InputError, match=r"there is traj\.dat, frame\*\.xyz"):
        read_jetspin(run, source="other.xyz")
    with pytest.raises(InputError, match="no beads"):
        read_jetspin(run / "statout.dat", time="last")
    with pytest.raises(InputError, match="no beads"):
        iter_jetspin(run / "statout.dat")
    with pytest.raises(InputError, match="only for a directory"):
        read_jetspin(run / "traj.xyz", source="traj.xyz")
    with pytest.raises(InputError, match="chunk_frames"):
        iter_jetspin(run, chunk_frames=0)
    with pytest.raises(InputError, match="set-up"):
        read_parameters(empty)
    with pytest.raises(InputError, match="statout"):
        read_statistics(empty)
    with pytest.raises(InputError, match="statout"):
        read_statistics(run / "traj.xyz")


def test_empty_traj_dat_gives_way_to_the_next(run):
    (run / "traj.dat").write_bytes(b"")
    data, messages = read(run)
    assert data.attrs["source_files"].startswith("frame000001.xyz")
    assert any("traj.dat is not usable" in text for text in messages)


def test_a_small_binary_run_needs_no_numba(run):
    code = (
        "import sys; from spinline.jetprofile import read_jetspin; "
        f"read_jetspin({str(run / 'traj.dat')!r}); sys.exit('numba' in sys.modules)"
    )
    path = {"PYTHONPATH": ":".join(part for part in sys.path if part)}
    subprocess.run([sys.executable, "-c", code], check=True, env=path)


# --- binary


def restyle(path, style, at=BLOCK):
    content = bytearray(path.read_bytes())
    struct.pack_into("<i", content, at + 20, style)
    path.write_bytes(bytes(content))


@pytest.mark.parametrize(("style", "name"), [(11, "save.dat"), (14, "save.dat"), (16, "save.dat"), (8, "traj.dat")])
def test_newer_styles_are_refused_by_name(run, style, name):
    restyle(run / name, style)
    with pytest.raises(InputError, match=rf"style {style}, of JETSPIN 1\.22.*frame\*\.xyz"):
        read_jetspin(run / name)


def test_block_in_internal_units_is_refused(run):
    content = bytearray((run / "save.dat").read_bytes())
    at = 12 + 32 + 24 + 4
    for k in range(7):
        value = struct.unpack_from("<d", content, at + 8 * k)[0]
        struct.pack_into("<d", content, at + 8 * k, value / 0.0348)
    (run / "save.dat").write_bytes(bytes(content))
    with pytest.raises(InputError, match="not in the CGS units"):
        read_jetspin(run / "save.dat")


def test_big_endian_is_refused(run):
    content = np.frombuffer((run / "save.dat").read_bytes(), "<u4").byteswap().tobytes()
    (run / "save.dat").write_bytes(content)
    with pytest.raises(InputError, match="big-endian"):
        read_jetspin(run / "save.dat")


def frames_of(content):
    found, at = [], BLOCK
    while at < len(content):
        stop = at + 64 + 48 * struct.unpack_from("<i", content, at + 16)[0]
        found.append((at, stop))
        at = stop
    return found


def test_binary_restart(run):
    content = (run / "traj.dat").read_bytes()
    places = frames_of(content)
    third, fourth, fifth = (bytearray(content[a:b]) for a, b in places[2:])
    struct.pack_into("<f", fourth, 64 + 4, 458.0)
    (run / "traj.dat").write_bytes(content[: places[3][1]] + bytes(third + fourth + fifth))
    data, messages = read(run)
    np.testing.assert_allclose(data.time, [0.005, 0.01, 0.015, 0.02, 0.025], rtol=1e-9)
    assert any("2 frames superseded" in text for text in messages)
    assert float(data.x[3].max()) == pytest.approx(458 * L0)


def test_binary_damage(run):
    content = (run / "traj.dat").read_bytes()
    whole, _ = read(run)
    places = frames_of(content)
    first = places[2][0]

    def damaged(offset, code, value):
        changed = bytearray(content)
        struct.pack_into(code, changed, first + offset, value)
        (run / "traj.dat").write_bytes(bytes(changed))
        return read(run)

    for offset, code, value in (
        (16, "<i", 2_000_000_000),
        (16, "<i", -5),
        (16, "<i", 100),
        (12, "<i", 25),
        (0, "<i", 5),
        (20, "<i", 3),
        (28, "<d", np.nan),
        (28, "<d", 1e300),
        (28, "<d", 1e-9),
        (52, "<i", 77),
    ):
        data, messages = damaged(offset, code, value)
        assert data.sizes["time"] == 4, (offset, value)
        assert len(messages) == 1
        assert data.attrs["dropped"]
    bead = 64 + 48 * 50
    count = int(whole.n_bead[2])
    elements = slice(count - 50 - 2, count - 50)
    for offset, value, message in (
        (4, np.nan, "not finite"),
        (4, np.inf, "not finite"),
        (4, 1e30, "farther than"),
        (4, -3.0, "behind the nozzle"),
        (16, 1e30, "stresses"),
        (20, -1e30, "speeds"),
        (40, -0.037, "not positive"),
        (40, 0.09, "contradict"),
        (40, 0.02, "contradict"),
        (32, 1.7, "contradicts"),
    ):
        data, messages = damaged(bead + offset, "<f", value)
        assert any(message in text for text in messages), (offset, value, messages)
        if offset != 32:
            assert not data.valid_element[2, elements].all()
        assert int((whole.valid_element != data.valid_element).sum()) <= 2
    data, messages = damaged(bead, "<i", 44)
    assert any("damaged markers" in text for text in messages)
    data, messages = damaged(36, "<i", 0)  # the inserted flag of a frame without place holder
    assert any("no place-holder" in text for text in messages)
    np.testing.assert_array_equal(data.n_bead, whole.n_bead)


def test_masses_after_a_restart(run):
    content = bytearray((run / "traj.dat").read_bytes())
    at = frames_of(content)[4][0] + 64 + 48 * 100
    for offset in (32, 36):
        struct.pack_into("<f", content, at + offset, 23571.0)
    (run / "traj.dat").write_bytes(bytes(content))
    data, messages = read(run)
    assert any("after a restart" in text for text in messages)
    assert bool(data.valid_element.values[4, 5:50].all())


def test_style_one_needs_equal_volumes(run):
    """Style 1 has neither volumes nor indices; cut out of the style-5 file."""
    content = (run / "traj.dat").read_bytes()
    out = content[:BLOCK]
    for begin, stop in frames_of(content):
        head = bytearray(content[begin : begin + 44])
        struct.pack_into("<i", head, 20, 1)
        out += bytes(head)
        for at in range(begin + 64, stop, 48):
            out += struct.pack("<i", 28) + content[at + 4 : at + 32] + struct.pack("<i", 28)
    whole, _ = read(run)
    (run / "traj.dat").write_bytes(out)
    data, messages = read(run / "traj.dat")
    assert messages == []
    xr.testing.assert_equal(data.x, whole.x)
    np.testing.assert_allclose(data.radius, whole.radius, rtol=1e-6)
    (run / "log.txt").unlink()
    (run / "input.dat").unlink()
    (run / "statout.dat").unlink()
    _, messages = read(run / "traj.dat")
    assert any("equal volume are assumed" in text for text in messages)


# --- tables


def test_statistics_damage(run):
    path = run / "statout.dat"
    whole = read_statistics(path)
    edit(path, b"61185.77318    ", b"0.5520854571-127"[:15])
    edit(path, b"38338.27789     ", b"        Infinity")
    data, messages = read(path)
    assert float(data.stress[1]) == pytest.approx(0.055208545712e-12, rel=1e-3) or float(data.stress[1]) < 1e-10
    assert np.isnan(data.stress[2])
    content = path.read_bytes()
    path.write_bytes(content[:-300])
    data, messages = read(path)
    assert data.sizes["time"] == whole.sizes["time"] - 1
    assert any("cut or damaged rows" in text for text in messages)
    header = b"".join(content.splitlines(keepends=True)[:3])
    rows = content.splitlines(keepends=True)[60:]
    path.write_bytes(content[: -sum(map(len, rows[-20:]))] + header + b"".join(rows))
    data, messages = read(path)
    assert data.sizes["time"] == whole.sizes["time"]
    assert any("superseded" in text for text in messages)
    path.write_bytes(content.replace(b"(s)", b"\xff\xfe!"))
    data, messages = read(path)
    assert len(data.data_vars) + len(data.coords) >= len(whole.data_vars)


def test_infinite_radius_of_coincident_beads():
    data = read_jetspin(DATA / "ex2_1d_insert" / "statout.dat")
    assert int(np.isnan(data.collector_radius).sum()) == 38


def test_statdat_damage(run):
    path = run / "statdat.dat"
    content = bytearray(path.read_bytes())
    struct.pack_into("<i", content, 196 * 3, 100)
    struct.pack_into("<f", content, 196 * 5 + 12 + 4, 1.0)
    struct.pack_into("<f", content, 196 * 7 + 12 + 4 * 9, np.nan)
    path.write_bytes(bytes(content[:-10]))
    data, messages = read(path)
    assert data.sizes["time"] == 101 - 2
    for part in ("damaged records", "contradict themselves", "not finite", "cut off"):
        assert any(part in text for text in messages), part


def test_landed_damage(run):
    path = run / "bead.dat"
    content = bytearray(path.read_bytes())
    struct.pack_into("<i", content, 72 * 3, 100)
    struct.pack_into("<f", content, 72 * 5 + 16 + 4, 1.0)
    struct.pack_into("<f", content, 72 * 7 + 16 + 4 * 10, -1.0)
    path.write_bytes(bytes(content[:-10]))
    data, messages = read(path)
    assert data.sizes["landing"] == 107
    for part in ("damaged records", "did not land", "cannot be", "cut off"):
        assert any(part in text for text in messages), part
    for name in ("log.txt", "input.dat"):
        (run / name).unlink()
    with pytest.raises(InputError, match="internal units"):
        read_jetspin(path)


def test_setup_damage(run):
    log = (run / "log.txt").read_bytes()
    cut = log.index(b"collector distance")
    (run / "log.txt").write_bytes(log[:cut])
    data, messages = read(run / "log.txt")
    assert any("end is missing" in text for text in messages)
    assert any("does not say that the run ended" in text for text in messages)
    jet, messages = read(run, source="traj.xyz")
    assert jet.attrs["collector_distance"] == 0.16  # from input.dat
    (run / "log.txt").write_bytes(log.replace(b"0.3487728022E-01", b"0.3587728022E-01"))
    _, messages = read(run, source="traj.xyz")
    assert any("contradicts the set-up" in text for text in messages)
    (run / "log.txt").write_bytes(log.replace(b"0.5000000000E-02 cm", b"-.5000000000E-02 cm"))
    data, messages = read(run / "log.txt")
    assert "nozzle_radius" not in data
    assert any("nozzle radius" in text for text in messages)
    edit(run / "input.dat", b"print xyz 5.d-4", b"print xyz rescale 10.")
    assert read_parameters(run / "input.dat").xyz_rescale is None  # JETSPIN takes it for an interval
