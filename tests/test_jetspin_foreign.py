"""Files that are something else, binary files and tables, damaged by editing real ones."""

import struct
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from jetspin_damage import DATA, L0, copied_run, edit, read

from spinline.base.errors import InputError
from spinline.jetprofile import read_jetspin
from spinline.jetprofile.jetspin import iter_jetspin, read_parameters, read_statistics

BLOCK = 1084


@pytest.fixture
def run(tmp_path):
    """An own copy of the PVP run, to be damaged."""
    return copied_run(tmp_path / "pvp3d")


# --- files that are something else


def test_wrong_kinds(tmp_path, run):
    rubbish = np.random.default_rng(0).integers(0, 256, 5000, dtype=np.uint8).tobytes()
    for name in (
        "some.bin",
        "traj.xyz",
        "save.dat",
        "statout.dat",
        "statdat.dat",
        "bead.dat",
        "input.dat",
        "log.txt",
    ):
        (tmp_path / name).write_bytes(rubbish)
        with pytest.raises(InputError):
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
