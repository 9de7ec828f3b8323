"""Files cut and bytes flipped anywhere: what is intact is read, or one InputError says why not."""

import shutil
import time
import warnings
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from spinline.base.errors import InputError, SpinlineWarning
from spinline.jetprofile import read_jetspin

DATA = Path(__file__).parent / "data" / "jetspin"
BUNDLED = Path(str(files("spinline"))) / "data" / "scenes" / "pvp3d"
FILES = sorted(
    [path for path in DATA.glob("*/*") if path.suffix in (".xyz", ".dat", ".txt")]
    + [path for path in BUNDLED.iterdir() if path.suffix in (".dat", ".txt")]
)
FORMATS = {
    "traj.xyz": DATA / "pvp3d" / "traj.xyz",
    "frame.xyz": DATA / "pvp3d" / "frame000005.xyz",
    "traj.dat 5": BUNDLED / "traj.dat",
    "traj.dat 3": DATA / "ex2_1d_insert" / "traj.dat",
    "save.dat 6": DATA / "dynamic_refinement" / "save.dat",
    "statout.dat": BUNDLED / "statout.dat",
    "statdat.dat": DATA / "pvp3d" / "statdat.dat",
    "bead.dat": DATA / "pvp3d" / "bead.dat",
    "log.txt": BUNDLED / "log.txt",
    "input.dat": BUNDLED / "input.dat",
}
ENOUGH = {"traj.xyz": 15 * 5905, "traj.dat 3": 30_000}  # bytes
SLOWEST = 10.0  # s of processor time; a reading takes some 2 ms


@pytest.fixture
def place(tmp_path):
    """Copy a file into an own directory with the set-up of its run; gives its new path."""

    def copy(path):
        folder = tmp_path / path.parent.name
        folder.mkdir(exist_ok=True)
        origin = BUNDLED if path.parent.name == "pvp3d" else path.parent
        shutil.copy(origin / "input.dat", folder)
        return Path(shutil.copy(path, folder))

    return copy


def outcome(path):
    """Dataset or None, and the warnings; anything but InputError and SpinlineWarning escapes."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("error")
        warnings.simplefilter("always", SpinlineWarning)
        begin = time.process_time()
        try:
            data = read_jetspin(path)
        except InputError:
            data = None
        assert time.process_time() - begin < SLOWEST
    return data, caught


def check(data):
    """What must hold of anything read, damaged or not."""
    if "valid_element" not in data:
        return
    valid = data.valid_element.values
    assert (np.diff(data.time.values) > 0).all()
    assert np.isfinite(data.element_length.values[valid]).all()
    radius = data.radius.values[valid]
    assert (radius[np.isfinite(radius)] > 0).all()
    limit = 20 * data.attrs["collector_distance"]
    for axis in "xyz":
        assert np.nanmax(np.abs(data[axis].values), initial=0) <= (limit if limit == limit else np.inf)


@pytest.mark.slow
@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.name}")
def test_cut_anywhere(path, place):
    rng = np.random.default_rng(len(path.name) + path.stat().st_size)
    target = place(path)
    content = path.read_bytes()
    told = 0
    for at in rng.integers(0, len(content), 200).tolist():
        target.write_bytes(content[:at])
        data, caught = outcome(target)
        told += data is None or bool(caught)
        if data is not None:
            check(data)
    assert told >= 170 or path.name in ("input.dat", "traj.xyz")


@pytest.mark.slow
@pytest.mark.parametrize("kind", FORMATS)
def test_bytes_flipped_anywhere(kind, place):
    path = FORMATS[kind]
    rng = np.random.default_rng(len(kind))
    target = place(path)
    content = path.read_bytes()[: ENOUGH.get(kind)]
    refused = 0
    for at, value in zip(rng.integers(0, len(content), 600), rng.integers(0, 256, 600), strict=True):
        damaged = bytearray(content)
        damaged[at] = value
        target.write_bytes(bytes(damaged))
        data, _ = outcome(target)
        refused += data is None
        if data is not None:
            check(data)
    assert refused < 60 or kind.startswith("frame")


@pytest.mark.parametrize("kind", ["traj.xyz", "traj.dat 5", "save.dat 6", "statout.dat", "log.txt"])
def test_many_bytes_flipped_and_lost(kind, place):
    path = FORMATS[kind]
    rng = np.random.default_rng(7)
    target = place(path)
    content = np.frombuffer(path.read_bytes(), np.uint8)
    for _ in range(60):
        damaged = content.copy()
        where = rng.integers(0, len(content), rng.integers(2, 200))
        damaged[where] = rng.integers(0, 256, len(where))
        if rng.random() < 0.5:
            damaged = np.delete(damaged, rng.integers(0, len(damaged), rng.integers(1, 30)))
        target.write_bytes(damaged.tobytes())
        data, caught = outcome(target)
        assert data is None or caught or kind == "log.txt"
        if data is not None:
            check(data)


@pytest.mark.slow
def test_digits_exchanged(place):
    """A digit for a digit in the rows: a bead moved farther than three elements is found."""
    path = FORMATS["traj.xyz"]
    target = place(path)
    content = path.read_bytes()
    whole, _ = outcome(target)
    rng = np.random.default_rng(3)
    size = len(content) // 50
    tried = found = 0
    for _ in range(600):
        frame = int(rng.integers(20, 50))
        bead = int(rng.integers(3, 80))
        at = content.index(b"C  ", frame * size) + 39 * bead + int(rng.choice([8, 18, 28]) + rng.integers(1, 6))
        if not 48 <= content[at] <= 57:
            continue
        damaged = bytearray(content)
        damaged[at] = int(rng.integers(48, 58))
        target.write_bytes(bytes(damaged))
        data, caught = outcome(target)
        size_both = min(data.sizes["bead"], whole.sizes["bead"])
        moved = np.sqrt(sum((data[a] - whole[a]).values[frame, :size_both] ** 2 for a in "xyz"))
        worst = int(np.nanargmax(moved))
        spacing = whole.element_length.values[frame, max(worst - 1, 0) : worst + 1].max()
        if moved[worst] > 3 * spacing:
            tried += 1
            found += bool(caught) and not data.valid_element.values[frame, worst]
    assert tried > 10
    assert found == tried
