"""netCDF-4 as written straight on HDF5, and rows of text as read without a compiler: against readers that are not ours."""

import io
import re
import subprocess
import sys

import h5netcdf
import numpy as np
import pytest
import xarray as xr

from spinline.base.named_arrays import NamedArrays
from spinline.base.netcdf import open_dataset, save_dataset, sizes_in
from spinline.base.netcdf_file import NetcdfFile
from spinline.jetprofile.jetspin.xyz_rows import DAMAGED, OVERFLOW, UNREADABLE, parse_rows

KINDS = {
    "float32": np.float32([1.5, np.nan, -2.0]),
    "float64": np.array([1e-300, np.inf, 3.0]),
    "int8": np.int8([1, -2, 3]),
    "int64": np.array([1, -(2**40), 3]),
    "uint16": np.uint16([1, 2, 65535]),
    "flag": np.array([True, False, True]),
    "text": np.array(["a", "zwei", "drei ü"]),
}


def dataset() -> xr.Dataset:
    data = {name: ("q", values, {"units": "m", "long_name": f"of {name}"}) for name, values in KINDS.items()}
    data |= {"square": (("p", "q"), np.arange(6.0).reshape(2, 3)), "none": (("nothing", "q"), np.zeros((0, 3)))}
    data |= {"number": ((), 2.5), "word": ((), "hello"), "big": ("r", np.arange(300_000.0))}
    attrs = {"title": "ä title", "count": 3, "list": np.array([1.0, 2.0]), "words": ["one", "two"], "empty": ""}
    return xr.Dataset(data, {"q": [0.5, 1.5, 2.5], "label": ("q", ["u", "v", "w"])}, attrs)


def test_what_is_written_is_read_by_xarray(tmp_path) -> None:
    made = dataset()
    save_dataset(made, tmp_path / "a.nc")
    for read in (open_dataset(tmp_path / "a.nc"), xr.load_dataset(tmp_path / "a.nc", engine="h5netcdf")):
        assert set(read.variables) == set(made.variables)
        assert set(read.coords) == {"q", "label"}
        for name, variable in made.variables.items():
            found = read[name]
            assert (found.dims, found.attrs.get("units")) == (variable.dims, variable.attrs.get("units"))
            assert found.dtype.kind == variable.dtype.kind
            np.testing.assert_array_equal(found.values, variable.values)
        assert read.attrs["title"] == "ä title"
        assert list(read.attrs["words"]) == ["one", "two"]
    assert sizes_in(tmp_path / "a.nc") == {"q": 3, "p": 2, "nothing": 0, "r": 300_000}


def test_every_number_has_a_checksum_and_every_dimension_its_name(tmp_path) -> None:
    save_dataset(dataset(), tmp_path / "a.nc")
    with h5netcdf.File(tmp_path / "a.nc") as file:
        assert file.dimensions["r"].size == 300_000
        assert file["square"].dimensions == ("p", "q")
        unchecked = [name for name, one in file.variables.items() if one.shape and not one._h5ds.fletcher32]
        assert sorted(unchecked) == [
            "label",
            "none",
            "text",
        ]  # without bytes of their own, or in HDF5's heap, under the seal alone


def test_dimensions_that_grow_keep_what_was_written() -> None:
    stream = io.BytesIO()
    with NetcdfFile(stream, {"time": 4, "bead": 2}, ["bead"]) as file:
        file.variable("x", ("time", "bead"), "f8", {"units": "m"}, fill=np.nan)
        file.variable("time", ("time",), "f8", {})
        file.write("time", np.arange(4.0))
        file.write("x", np.ones((2, 2)))
        file.resize(bead=5)
        file.write("x", np.full((2, 5), 2.0), 2)
    with xr.open_dataset(stream, engine="h5netcdf") as read:
        assert dict(read.sizes) == {"time": 4, "bead": 5}
        np.testing.assert_array_equal(read.x.values[:2], [[1, 1, np.nan, np.nan, np.nan]] * 2)
        np.testing.assert_array_equal(read.x.values[2:], np.full((2, 5), 2.0))


# --- rows of text ------------------------------------------------------------------------------------------------------


def spelt_out(text: bytes, count: int) -> "tuple[list[list[float]], list[int], tuple[int, int, bool, int]]":
    """The rows of one frame, one at a time, by a regular expression and Python's own float."""
    values, flags, tail, met = [], [], 0, False
    lines = text.split(b"\n")
    for number in range(count):
        last = number >= len(lines) - 1
        line = lines[number] if number < len(lines) else b""
        body, end = (line[:-1], 2) if len(line) == 39 and line.endswith(b"\r") else (line, 1)
        flag, row = 0, []
        if len(line) + (not last) < 38:
            flag, row = UNREADABLE | DAMAGED, [np.nan] * 3
        else:
            odd = not body.startswith(b"C       ") or len(body) > 38 or (last and (len(line) != 38 or end == 2))
            flag = DAMAGED if odd else 0
            for at in (8, 18, 28):
                field = line[at : at + 10]
                good = re.fullmatch(rb" *-?\d*\.\d{5}", field)
                flag |= 0 if good else OVERFLOW if field == b"*" * 10 else UNREADABLE
                row.append(float(field) if good and field.strip() != b"-" else np.nan)
            if flag & (UNREADABLE | OVERFLOW):
                row = [np.nan] * 3
        zero = row == [0.0, 0.0, 0.0]
        if met:
            tail += not zero or flag != 0
            continue
        values.append(row)
        flags.append(flag)
        met = zero
    return values, flags, (0, len(values), met, tail)


def test_named_arrays_are_the_dataset_that_xarray_makes() -> None:
    rng = np.random.default_rng(0)
    data = {
        "x": (("time", "bead"), rng.normal(size=(3, 4)), {"units": "m"}),
        "n": ("time", np.arange(3, dtype=np.int32)),
    }
    data |= {"flag": (("time",), np.array([True, False, True]), {}), "number": ((), 2.5, {"units": "1"})}
    coordinates = {
        "time": ("time", np.array([0.0, 0.5, 0.7]), {"units": "s"}),
        "age": ("time", np.zeros(3, np.float32)),
    }
    for more in ({}, {"word": ("time", ["a", "zwei", "drei"])}):
        ours = NamedArrays({**data, **more}, coordinates, {"title": "t"}).dataset()
        theirs = xr.Dataset({**data, **more}, coordinates, {"title": "t"})
        xr.testing.assert_identical(ours, theirs)
        assert list(ours.data_vars) == list(theirs.data_vars)
        assert ours.indexes["time"].equals(theirs.indexes["time"])
        assert list(ours.xindexes) == list(theirs.xindexes)
        assert {name: one.dtype for name, one in ours.variables.items()} == {
            k: v.dtype for k, v in theirs.variables.items()
        }
        xr.testing.assert_identical(ours.sel(time=0.5), theirs.sel(time=0.5))
    with pytest.raises(ValueError, match="conflicting sizes"):
        NamedArrays({"x": ("p", np.zeros(3)), "y": ("p", np.zeros(4))}).dataset()


@pytest.mark.parametrize("damage", ["none", "flip", "letter", "gone", "more", "stars", "cut"])
def test_rows_are_read_as_if_spelt_out(damage) -> None:
    rng = np.random.default_rng(list(damage.encode()))
    letters = np.frombuffer(b"*-. 0C9\r", np.uint8)
    for _ in range(30):
        beads = rng.normal(0, 10 ** rng.uniform(-4, 3), (rng.integers(1, 30), 3)).clip(-999, 9999)
        beads[-1] = 0
        rows = [f"C       {x:10.5f}{y:10.5f}{z:10.5f}\n" for x, y, z in beads] + ["C   " + "   0.00000" * 3 + "\n"] * 2
        text = bytearray("".join(rows).encode())
        for _ in range(rng.integers(1, 5) if damage != "none" else 0):
            at = int(rng.integers(0, len(text) - 12))
            if damage == "flip":
                text[at] ^= 1 << int(rng.integers(0, 7))
            elif damage == "letter":
                text[at] = rng.choice(letters)
            elif damage == "gone":
                del text[at : at + 3]
            elif damage == "more":
                text[at:at] = b"12"
            elif damage == "stars":
                start = at - at % 39 + 8 + 10 * int(rng.integers(0, 3))
                text[start : start + 10] = b"*" * len(text[start : start + 10])
            else:
                del text[-int(rng.integers(1, 50)) :]
        text = text.replace(b"\n\n", b"\n") if text.endswith(b"\n\n") else text
        count = len(rows)
        out, status = np.empty((3, count)), np.empty(count, np.uint8)
        chains = np.empty((1, 4), np.int64)
        used = parse_rows(
            np.frombuffer(bytes(text), np.uint8), np.array([0]), np.array([count]), np.array([0]), out, status, chains
        )
        values, flags, chain = spelt_out(bytes(text), count)
        np.testing.assert_array_equal(out[:, :used].T, np.array(values).reshape(-1, 3))
        assert (status[:used].tolist(), tuple(chains[0])) == (flags, chain)
        if text[38::39] == b"\n" * count:  # as lines of one length: two frames, read as one block of characters
            both = np.frombuffer(bytes(text + b"between" + text + b"."), np.uint8)
            where, two = np.array([0, len(text) + 7]), np.array([count, count])
            out, status, chains = np.empty((3, 2 * count)), np.empty(2 * count, np.uint8), np.empty((2, 4), np.int64)
            used = parse_rows(both, where, two, np.array([39, 39]), out, status, chains)
            np.testing.assert_array_equal(out[:, :used].T, np.array(2 * values).reshape(-1, 3))
            assert status[:used].tolist() == 2 * flags
            assert [tuple(one[1:]) for one in chains] == 2 * [tuple(chain[1:])]


@pytest.mark.parametrize("times", [np.array([0.5, 1.5]), np.int32([3, 4]), np.array([True, False]), np.zeros(0)])
def test_times_of_every_kind_are_the_index_that_xarray_makes(times) -> None:
    data = {"x": (("t", "q"), np.ones((len(times), 3)), {"units": "m"}), "n": ((), 2.0)}
    coordinates = {"t": ("t", times, {"units": "s"})}
    made, whole = NamedArrays(data, coordinates, {"a": 1}).dataset(), xr.Dataset(data, coordinates, {"a": 1})
    xr.testing.assert_identical(made, whole)
    assert made.sizes == whole.sizes
    assert made.indexes["t"].identical(whole.indexes["t"])
    assert made.indexes["t"].dtype == whole.indexes["t"].dtype


_STOPPED = """
import gc, os, signal
import numpy as np
from spinline.base.files import streaming
from spinline.base.netcdf_file import NetcdfFile

signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background has none

class Asked:
    def __init__(self, sink, moment):
        self.sink, self.moment, self.calls = sink, moment, 0
    def __getattr__(self, name):
        self.calls += 1
        if self.calls == self.moment:
            os.kill(os.getpid(), signal.SIGINT)
        return lambda *given: getattr(self.sink, name)(*given)

def write(moment):
    with streaming("a.nc", force=True, sealing=True) as sink:
        asked = Asked(sink, moment)
        with NetcdfFile(asked, {"x": 4, "t": 0}, ["t"]) as file:
            file.variable("x", ("x",), "f8", {"units": "m"})
            file.variable("y", ("t", "x"), "f4", {"units": "m"}, fill=np.nan)
            file.attributes({"title": "a"})
            file.write("x", np.arange(4.0))
            for row in range(3):
                file.resize(t=row + 1)
                file.write("y", np.full((1, 4), row, "f4"), row)
    return asked.calls

calls, stopped = write(0), 0
for moment in range(1, calls + 1):
    try:
        write(moment)
    except KeyboardInterrupt:
        stopped += 1
    gc.collect()
print(calls, stopped)
"""


def test_a_signal_in_the_middle_of_hdf5_waits_for_it(tmp_path) -> None:
    """Ctrl-C at every call that HDF5 makes of its file; where such a call raises while it closes, HDF5 ends the process."""
    ran = subprocess.run(
        [sys.executable, "-c", _STOPPED], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    calls, stopped = map(int, ran.stdout.split())
    assert calls == stopped > 20
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]
    np.testing.assert_array_equal(open_dataset(tmp_path / "a.nc")["y"].values[:, 0], [0.0, 1.0, 2.0])
