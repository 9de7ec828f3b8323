"""Speed, memory and error of the JETSPIN reader on a synthetic trajectory of a given size.

Frames of the bundled PVP run are repeated with perturbed numbers, as text and as binary, and read in pieces.
Plain numpy reads the same numbers on a slice of the text, in the same run, without looking for damage.

    python benchmarks/bench_jetspin.py [MEGABYTES] [--memory] [--keep DIR]
    python benchmarks/bench_jetspin.py --sizes 0.01 0.03 0.1 1 10 100 --runs RUN...   # writes bench_jetspin.json

The second measures, in processor time:

* `read`: `read_jetspin`, which parses the run's log, finds frames and units, looks for damage and makes a Dataset of
  thirteen variables. `megabytes` and `read_mb_s` count the trajectory alone, `megabytes_read` and `all_mb_s` all files
  that are read: the log is larger than a small trajectory, and nobody else reads it here;
* `filtered`: what a user can do instead, ``numpy.loadtxt`` over the file's own lines by a generator that leaves out what is
  no row of three numbers. The rows whose columns touch (450.57551-103.59328) are left out with them;
* `fixed`: ``numpy.genfromtxt`` with fixed widths over the file's own rows, which reads those too;
* `loadtxt`: nothing a user can do, ``numpy.loadtxt`` on rows that somebody has already cut out of the file (and of those not
  the ones whose columns touch, which it cannot read). It and the above take turns, hundreds of them where the file is
  small; `fixed` of 12 MB and more once;
* `floor`: nothing but opening the run's files, reading their bytes and making that Dataset of arrays that are there, in the
  quickest way known (xarray's constructor takes longer). No reader that returns it is faster, whatever it does between: where
  `floor_over_loadtxt` is below 1, none is as fast as loadtxt;
* `write`: `write_jet`, thirteen sealed and checksummed variables, against loadtxt and saving the three columns as netCDF by
  xarray (`saved`), or as .npy (`npy`);
* `process`: ``spinline import-jet`` from start to end, against a Python that does the same.

`--runs` adds real runs under their names: `read_jetspin` of their traj.xyz (with what stands beside it), and of the directory
with traj.xyz as its source, against the same.
"""

import argparse
import io
import itertools
import json
import resource
import struct
import subprocess
import sys
import tempfile
import time
import tracemalloc
from importlib.resources import files
from pathlib import Path

import numpy as np

from spinline.base.named_arrays import NamedArrays
from spinline.jetprofile import iter_jetspin, read_jetspin
from spinline.jetprofile.jetspin import write_jet

L0 = 0.034877280224  # cm, of the PVP run
BLOCK = 1084  # bytes of the parameter block


def real_frames(run):
    """Last-frame positions of the bundled run, one array per stored frame."""
    return [
        np.stack([data[axis].values[0, : int(data.n_bead[0])] for axis in "xyz"], axis=1)[::-1]
        for data in iter_jetspin(run / "traj.dat", chunk_frames=1)
    ]


def make_text(path, frames, size, rng, maxnumber=150):
    """Write a traj.xyz of at least `size` bytes; returns rounded x of the beads of the last frame (m)."""
    number = 0
    with path.open("wb") as file:
        while file.tell() < size:
            for beads in frames:
                number += 1
                moved = beads / (L0 * 0.01) * (1 + 1e-4 * rng.standard_normal(beads.shape))
                moved[-1] = 0
                rows = np.zeros((maxnumber, 3))
                rows[: len(moved)] = moved
                rows[: len(moved), 0] = np.clip(rows[: len(moved), 0], 0, 16 / L0)
                body = "".join([f"C       {x:10.5f}{y:10.5f}{z:10.5f}\n" for x, y, z in rows.tolist()])
                text = f"{maxnumber:10d}\nframe at time{number * 5e-4:20.10E}{number * 5000:10d}\n{body}"
                file.write(text.encode())
                if file.tell() >= size:
                    break
            if file.tell() > 4e6:  # the numbers of the first megabytes are repeated under new times
                break
        begin = path.read_bytes() if file.flush() is None else b""
        whole = begin.split(b"frame at time")
        step = len(whole) - 1
        while file.tell() < size:
            shifted = [whole[0]]
            for k, part in enumerate(whole[1:], 1):
                number += 1
                stop = part.index(b"\n")
                head = f"{number * 5e-4:20.10E}{number * 5000:10d}".encode()
                shifted.append(head + part[stop:])
                assert k <= step
            file.write(b"frame at time".join(shifted))
    return number, np.round(rows[: len(moved), 0], 5) * L0 * 0.01


def make_binary(path, source, size):
    """Write a traj.dat of at least `size` bytes from the frames of a real one, under new times."""
    content = source.read_bytes()
    frames, at = [], BLOCK
    while at < len(content):
        rows = struct.unpack_from("<i", content, at + 16)[0]
        stop = at + 64 + rows * 48
        frames.append(bytearray(content[at:stop]))
        at = stop
    number = 0
    with path.open("wb") as file:
        file.write(content[:BLOCK])
        while file.tell() < size:
            for frame in frames:
                number += 1
                struct.pack_into("<d", frame, 28, number * 5e-3)
                file.write(frame)
    return number


def measure(label, path, **options):
    """Read a file in pieces: MB/s and the largest resident size so far."""
    next(iter_jetspin(path, time="last", **options))  # compiled
    megabytes = (sum(f.stat().st_size for f in path.glob("frame*")) if path.is_dir() else path.stat().st_size) / 1e6
    begin, count = time.perf_counter(), 0
    for data in iter_jetspin(path, **options):
        count += data.sizes["time"]
    seconds = time.perf_counter() - begin
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    speed = f"{seconds:7.2f} s {megabytes / seconds:7.1f} MB/s, peak resident {peak:.0f} MB"
    print(f"{label:28s} {megabytes:8.1f} MB {count:8d} frames {speed}")
    return megabytes / seconds, data


def plain(path, limit=4_000_000):
    """numpy.genfromtxt and numpy.loadtxt on the rows of the first megabytes, MB/s."""
    lines = [
        line for line in path.read_bytes()[:limit].splitlines() if len(line.split()) == 4 and line.startswith(b"C")
    ]
    text = b"\n".join(lines)
    speeds = {}
    for name, reader, options in (
        ("numpy.loadtxt", np.loadtxt, {"usecols": (1, 2, 3)}),
        ("numpy.genfromtxt", np.genfromtxt, {"delimiter": (8, 10, 10, 10), "usecols": (1, 2, 3)}),
    ):
        begin = time.perf_counter()
        reader(io.BytesIO(text), **options)
        speeds[name] = len(text) / 1e6 / (time.perf_counter() - begin)
        print(f"{name:28s} {len(text) / 1e6:8.1f} MB, numbers only {'':17s} {speeds[name]:7.1f} MB/s")
    return speeds


def least(repeats, *functions):
    """Shortest processor time of several calls of each, which take turns by the ten, s."""
    shortest = [float("inf")] * len(functions)
    for done in range(0, repeats, 10):
        for number, function in enumerate(functions):
            for _ in range(min(10, repeats - done)):
                begin = time.process_time()
                function()
                shortest[number] = min(shortest[number], time.process_time() - begin)
    return shortest


def children(command, repeats):
    """Shortest processor time of a process and its children, s."""
    shortest = float("inf")
    for _ in range(repeats):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        shortest = min(shortest, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return shortest


def load(path):
    """Three columns by loadtxt."""
    return np.loadtxt(path, usecols=(1, 2, 3))


def filtered(path):
    """Three columns of a traj.xyz as it is, by loadtxt; what is no row of three separate numbers is left out."""
    with open(path, encoding="ascii") as file:
        rows = (line for line in file if line.startswith("C ") and len(line.split()) == 4)
        return np.loadtxt(rows, usecols=(1, 2, 3))


def fixed(path):
    """Three columns of a traj.xyz as it is, by genfromtxt and the widths of its fields."""
    with open(path, encoding="ascii") as file:
        rows = (line for line in file if line.startswith("C "))
        return np.genfromtxt(rows, delimiter=(8, 10, 10, 10), usecols=(1, 2, 3))


def turns(repeats, path, rows, *ours):
    """Shortest times of our functions, and of theirs by name, s."""
    many = path.stat().st_size < 12e6
    theirs = [lambda: load(rows), lambda: filtered(path), *([lambda: fixed(path)] if many else [])]
    seconds = least(repeats, *ours, *theirs)
    if not many:
        seconds += least(1, lambda: fixed(path))
    return seconds[: len(ours)], dict(zip(("loadtxt", "filtered", "fixed"), seconds[len(ours) :], strict=True))


def all_read(folder):
    """Megabytes of the files that are read for the beads of a traj.xyz."""
    there = [folder / name for name in ("traj.xyz", "log.txt", "input.dat", "statout.dat")]
    return sum(path.stat().st_size for path in there if path.exists()) / 1e6


def named(data):
    """The arrays of a Dataset."""
    tuples = {str(name): (one.dims, one.values, one.attrs) for name, one in data.variables.items()}
    return NamedArrays(tuples, {"time": tuples.pop("time")}, data.attrs)


def nothing_but(paths, arrays):
    """The bytes of files and a Dataset of arrays that are there."""
    for path in paths:
        with open(path, "rb") as file:
            file.read()
    return arrays.dataset()


def save(columns, path):
    """Three columns as netCDF."""
    import xarray as xr

    data = {axis: ("bead", columns[:, number]) for number, axis in enumerate("xyz")}
    xr.Dataset(data).to_netcdf(path, engine="h5netcdf")


PLAIN = """
import sys
import numpy as np
columns = np.loadtxt(sys.argv[1], usecols=(1, 2, 3))
if sys.argv[2].endswith(".npy"):
    np.save(sys.argv[2], columns)
else:
    import xarray as xr
    data = {axis: ("bead", columns[:, number]) for number, axis in enumerate("xyz")}
    xr.Dataset(data).to_netcdf(sys.argv[2], engine="h5netcdf")
"""


def imports(sizes, runs):
    """`import-jet` from a text trajectory to a file, against loadtxt, at several sizes, and real runs."""
    run = Path(str(files("spinline"))) / "data" / "scenes" / "pvp3d"
    frames, rows = real_frames(run), []
    for size in sizes:
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            (folder / "log.txt").write_bytes((run / "log.txt").read_bytes())
            make_text(folder / "traj.xyz", frames, 1e6 * size, np.random.default_rng(1))
            rows.append(measured(folder, max(3, min(300, int(20 / size)))))
        print(json.dumps(rows[-1], indent=1), flush=True)
    for folder in runs:
        rows.append(real(folder))
        print(json.dumps(rows[-1], indent=1), flush=True)
    Path(__file__).with_suffix(".json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


def plain_rows(path):
    """The rows of a traj.xyz that loadtxt can read."""
    lines = (line for line in path.read_bytes().splitlines() if line.startswith(b"C "))
    return b"\n".join(line for line in lines if [word.count(b".") for word in line.split()] == [0, 1, 1, 1])


def real(folder, repeats=300):
    """Reading a real run, by its traj.xyz and by its directory."""
    path = folder / "traj.xyz"
    with tempfile.TemporaryDirectory() as temporary:
        text, rows = plain_rows(path), str(Path(temporary) / "rows.txt")
        Path(rows).write_bytes(text)
        (file, directory), theirs = turns(
            repeats, path, rows, lambda: read_jetspin(path), lambda: read_jetspin(folder, source="traj.xyz")
        )
    megabytes = path.stat().st_size / 1e6
    rate = {name: (len(text) / 1e6 if name == "loadtxt" else megabytes) / s for name, s in theirs.items()}
    seconds = {"file": file, "directory": directory, **theirs}
    over = {
        f"{what}_over_{name}": megabytes / seconds[what] / rate[name] for what in ("file", "directory") for name in rate
    }
    return {
        "run": folder.name,
        "megabytes": round(megabytes, 3),
        "megabytes_read": round(all_read(folder), 3),
        "seconds": {name: round(s, 5) for name, s in seconds.items()},
        "file_mb_s": round(megabytes / file, 1),
        "all_mb_s": round(all_read(folder) / file, 1),
        **{name: round(ratio, 2) for name, ratio in over.items()},
    }


def measured(folder, repeats):
    """Seconds of reading, of writing and of whole processes, ours over theirs, for one run."""
    text = plain_rows(folder / "traj.xyz")
    (folder / "rows.txt").write_bytes(text)
    megabytes, theirs = (folder / "traj.xyz").stat().st_size / 1e6, len(text) / 1e6
    jet, plain, other, saved = (str(folder / name) for name in ("jet.nc", "rows.txt", "rows.nc", "rows.npy"))
    columns = load(plain)
    save(columns, other)
    sources, arrays = [folder / "log.txt", folder / "traj.xyz"], named(read_jetspin(folder))
    (read, floor), others = turns(
        repeats, folder / "traj.xyz", plain, lambda: read_jetspin(folder), lambda: nothing_but(sources, arrays)
    )
    write, to_netcdf, npy = least(
        min(repeats, 20),
        lambda: write_jet(folder, jet, force=True),
        lambda: save(load(plain), other),
        lambda: np.save(saved, load(plain)),
    )
    seconds = {
        "read": read,
        **others,
        "floor": floor,
        "write": write,
        "saved": to_netcdf,
        "npy": npy,
        "process": children(["-m", "spinline", "import-jet", str(folder), "-o", jet, "--force"], min(repeats, 5)),
        "process_saved": children(["-c", PLAIN, plain, other], min(repeats, 5)),
        "process_npy": children(["-c", PLAIN, plain, saved], min(repeats, 5)),
    }
    rate = {
        name: (megabytes if name in ("read", "filtered", "fixed", "floor", "write", "process") else theirs) / s
        for name, s in seconds.items()
    }
    return {
        "megabytes": round(megabytes, 3),
        "megabytes_read": round(all_read(folder), 3),
        "seconds": {name: round(s, 5) for name, s in seconds.items()},
        "read_mb_s": round(rate["read"], 1),
        "all_mb_s": round(all_read(folder) / read, 1),
        "loadtxt_mb_s": round(rate["loadtxt"], 1),
        "read_over_filtered": round(rate["read"] / rate["filtered"], 2),
        "read_over_fixed": round(rate["read"] / rate["fixed"], 2),
        "read_over_loadtxt": round(rate["read"] / rate["loadtxt"], 2),
        "floor_over_loadtxt": round(rate["floor"] / rate["loadtxt"], 2),
        "write_over_saved": round(rate["write"] / rate["saved"], 2),
        "write_over_npy": round(rate["write"] / rate["npy"], 2),
        "process_over_saved": round(rate["process"] / rate["process_saved"], 2),
        "process_over_npy": round(rate["process"] / rate["process_npy"], 2),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("megabytes", type=float, nargs="?", default=100.0)
    parser.add_argument("--memory", action="store_true", help="also trace allocations (slow)")
    parser.add_argument("--keep", type=Path, help="directory for the synthetic files")
    parser.add_argument("--sizes", type=float, nargs="*", help="import-jet at these sizes, MB")
    parser.add_argument("--runs", type=Path, nargs="*", default=[], help="with --sizes: real runs beside them")
    options = parser.parse_args()
    if options.sizes:
        imports(options.sizes, options.runs)
        return
    run = Path(str(files("spinline"))) / "data" / "scenes" / "pvp3d"
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "log.txt").write_bytes((run / "log.txt").read_bytes())
        size = options.megabytes * 1e6
        frames = real_frames(run)
        count, truth = make_text(folder / "traj.xyz", frames, size, np.random.default_rng(1))
        make_binary(folder / "traj.dat", run / "traj.dat", size)
        singles = folder / "singles"
        singles.mkdir(exist_ok=True)
        (singles / "log.txt").write_bytes((run / "log.txt").read_bytes())
        make_singles(folder / "traj.xyz", singles, min(size, 20e6))
        text, data = measure("traj.xyz", folder / "traj.xyz")
        binary, _ = measure("traj.dat, style 5", folder / "traj.dat")
        measure("frame*.xyz", singles)
        speeds = plain(folder / "traj.xyz")
        ratios = {name.split(".")[1]: text / speed for name, speed in speeds.items()}
        shown = ", ".join(f"{ratio:.1f} times {name}" for name, ratio in ratios.items())
        print(f"reading text: {shown}; binary: {binary / text:.1f} times text")
        last = data.x.values[-1, : len(truth)][::-1]
        print(f"last frame of {count}: x against what was written, {np.abs(last - truth).max():.1e} m")
        if options.memory:
            tracemalloc.start()
            for _ in iter_jetspin(folder / "traj.xyz"):
                pass
            print(f"largest traced allocation {tracemalloc.get_traced_memory()[1] / 1e6:.0f} MB")


def make_singles(source, folder, size):
    """Cut the first frames of a traj.xyz into frame*.xyz."""
    with source.open("rb") as file:
        content = file.read(int(size))
    starts = [m - 11 for m in _find(content, b"frame at time")]
    for number, (begin, stop) in enumerate(itertools.pairwise(starts), 1):
        (folder / f"frame{number:06d}.xyz").write_bytes(content[begin:stop])


def _find(content, what):
    at = content.find(what)
    while at >= 0:
        yield at
        at = content.find(what, at + 1)


if __name__ == "__main__":
    main()
