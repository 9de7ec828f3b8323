"""X-ray reduction against what the photons allow: scatter, error bars, bias, few photons, speed, long stacks.

    python benchmarks/bench_xray.py scatter coverage bias low speed      about 2 minutes on one core
    python benchmarks/bench_xray.py stream [FOLDER]                      6 GB of frames at a time in FOLDER (default: temporary)
    python benchmarks/bench_xray.py each [FOLDER]                        200 frames, killed and resumed

Phantoms come from the brute-force forward model of the tests, which shares no code with the package: 10 keV, PEO in water,
0.67 um pixels, three shells of 0.03, 0.05, 0.08, off centre by 3 pixels, beam drifted by 1 % and tilted by 1 %.
"""

import contextlib
import importlib.util
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from spinline import xray
from spinline.xray.frame import Frame, fit_frame
from spinline.xray.frame.quick import chord_frame

PIXEL = 0.67e-6
SOLUTION = xray.Absorber(531.9, -137.44, 0.6)
FITTED = ("radius", "axis", "amplitude", "slope")
PHI = np.array([0.03, 0.05, 0.08])
MEAN = float(xray.shell_weights(xray.equal_shells(3)) @ PHI)

_spec = importlib.util.spec_from_file_location("conftest", Path(__file__).parents[1] / "tests" / "conftest.py")
_conftest = importlib.util.module_from_spec(_spec)
sys.modules["conftest"] = _conftest
_spec.loader.exec_module(_conftest)


def phantom(radius, photons, fraction=PHI, width=3.0, blur=0.0, parts=32):
    """Mean counts of a row, and its flat."""
    fraction = np.asarray(fraction)
    flat = np.full(int(width * radius / PIXEL), float(photons))
    mean = _conftest.round_jet_counts(
        lambda r: fraction[np.minimum((r * fraction.size).astype(int), fraction.size - 1)],
        radius,
        flat=flat,
        pixel=PIXEL,
        solvent=531.9,
        contrast=-137.44,
        air=0.6,
        axis=3 * PIXEL,
        amplitude=1.01,
        slope=0.01,
        blur=blur,
        parts=parts,
    )
    return mean, flat


def replicates(mean, flat, count, seed, blur=0.0):
    """A frame whose rows are replicates of one row."""
    counts = np.random.default_rng(seed).poisson(mean, (count, mean.size)).astype(float)
    flats = np.broadcast_to(flat, counts.shape).copy()
    return Frame(counts, flats, np.zeros_like(flats), flats > 0, PIXEL, blur)


def bound(radius, flat, blur=0.0):
    """Cramer-Rao bound with the same unknowns."""
    jet = xray.RoundJet(PHI, radius, 3 * PIXEL)
    detector = xray.Detector(flat, PIXEL, blur=blur)
    return xray.error_limit(jet, SOLUTION, detector, nuisances=FITTED, amplitude=1.01, slope=0.01)


def scatter():
    """500 replicates at R = 100, 50, 25 um."""
    print(
        "scatter over the bound with the same unknowns, 500 replicates: mean; shells from the axis; bias in sd of the average"
    )
    for um, photons in ((100, 1e5), (50, 1e6), (25, 1e7)):
        mean, flat = phantom(um * 1e-6, photons)
        fit, limit = fit_frame(replicates(mean, flat, 500, um), SOLUTION), bound(um * 1e-6, flat)
        ratio = fit.fraction.std(axis=0, ddof=1) / limit.fraction
        bias = (fit.mean.mean() - MEAN) / (limit.mean / np.sqrt(500))
        print(
            f"  R = {um:3d} um, N = {photons:.0e}: {fit.mean.std(ddof=1) / limit.mean:.3f}; {ratio.round(3)}; {bias:+.2f}"
        )


def coverage():
    """1,000 replicates: z-scores and 95 % intervals."""
    print("error bars, 1,000 replicates: sd of z, share within 1.96; method row with 3 shells, chord with its mean")
    for um, photons in ((100, 1e5), (50, 1e6), (25, 1e7)):
        mean, flat = phantom(um * 1e-6, photons)
        fit = fit_frame(replicates(mean, flat, 1000, 7 + um), SOLUTION)
        z = (fit.mean - MEAN) / fit.mean_std
        shells = (fit.fraction - PHI) / np.sqrt(np.einsum("bii->bi", fit.covariance))
        radius = (fit.values["radius"] - um * 1e-6) / fit.std["radius"]
        print(
            f"  R = {um:3d} um, N = {photons:.0e}: {z.std():.3f}, {100 * np.mean(abs(z) < 1.96):.1f} %; shells "
            f"{shells.std(axis=0).round(3)}; radius {radius.std():.3f}; misfit "
            f"{fit.misfit.mean():+.3f} +/- {fit.misfit.std():.2f}"
        )
        uniform, flat = phantom(um * 1e-6, photons, [MEAN])
        quick = chord_frame(replicates(uniform, flat, 1000, 8 + um), SOLUTION)
        z = (quick.mean - MEAN) / quick.mean_std
        print(f"      chord, uniform jet: {z.std():.3f}, {100 * np.mean(abs(z) < 1.96):.1f} %, bias {z.mean():+.2f} sd")


def bias():
    """Mean counts of 1e7 photons: what the model itself gets wrong."""
    print("bias of the mean fraction at N = 1e7, R = 50 um, nothing known, in its standard deviation:")
    for name, fraction in (
        ("uniform", [0.05]),
        ("shells", PHI),
        ("parabola", 0.03 + 0.06 * ((np.arange(400) + 0.5) / 400) ** 2),
    ):
        for blur in (0.0, 1.2e-6):
            mean, flat = phantom(50e-6, 1e7, fraction, blur=blur)
            true = (
                float(xray.shell_weights(xray.equal_shells(len(fraction))) @ fraction) if len(fraction) < 400 else 0.06
            )
            for shells in (1,) if name == "uniform" else (3, 6):
                fit = fit_frame(
                    Frame(mean[None], flat[None], 0 * flat[None], flat[None] > 0, PIXEL, blur), SOLUTION, shells=shells
                )
                error = fit.mean[0] - true
                print(
                    f"  {name}, {shells} fitted, blur {1e6 * blur:.1f} um: {error:+.2e} = {error / fit.mean_std[0]:+.3f} sd"
                )


def low():
    """2,000 rows of few photons."""
    print(
        "2,000 rows, R = 50 um: all in one block, all unknown; and one by one with the geometry known, averaged (in sd)"
    )
    for photons in (20, 5, 1):
        mean, flat = phantom(50e-6, photons)
        frame = replicates(mean, flat, 2000, photons)
        fit = fit_frame(frame, SOLUTION, block_rows=2000)
        z = (fit.mean[0] - MEAN) / fit.mean_std[0]
        known = {"nuisances": ("amplitude", "slope"), "radius": 50e-6, "axis": 3 * PIXEL, "shells": 1}
        detector = xray.Detector(flat, PIXEL)
        each = np.array([xray.fit_row(row, SOLUTION, detector, **known).mean_fraction for row in frame.counts])
        alone = (each.mean() - MEAN) / (each.std() / np.sqrt(2000))
        print(
            f"  {photons:2d} photons: block {fit.mean[0]:.3f} +/- {fit.mean_std[0]:.3f} ({z:+.2f}); "
            f"one by one {each.mean():.3f} ({alone:+.2f})"
        )


def speed():
    """Milliseconds of processor time per row, best of five."""
    print(
        "ms of processor time a row (wall), R = 50 um: chord, then row by what is fitted; share of rows that converged"
    )
    for photons in (1e3, 1e4, 1e5, 1e6, 1e7):
        for columns, rows in ((402, 400), (300, 400)):
            mean, flat = phantom(50e-6, photons, width=columns * PIXEL / 50e-6 + 1e-9)
            _, used = timed(lambda f: chord_frame(f, SOLUTION), replicates(mean, flat, rows, 1), best=5)
            print(f"  N = {photons:.0e}, {mean.size} pixels: chord {used}", end="", flush=True)
            for shells in (3, 6, 10):
                fit, used = timed(lambda f, k=shells: fit_frame(f, SOLUTION, shells=k), replicates(mean, flat, rows, 1))
                print(f"; {shells} shells {used} {converged(fit):.3f}", end="", flush=True)
            mean, flat = phantom(50e-6, photons, width=columns * PIXEL / 50e-6 + 1e-9, blur=1.2e-6)
            frame = replicates(mean, flat, rows, 1, blur=1e-6)
            fit, used = timed(lambda f: fit_frame(f, SOLUTION, nuisances=(*FITTED, "blur")), frame)
            print(f"; 3 and the blur {used} {converged(fit):.3f}", flush=True)


def timed(run, frame, best=3):
    """Result of a reduction, and its processor time (wall) per row in ms."""
    run(frame)
    least = (np.inf, np.inf)
    for _ in range(best):
        cpu, wall = time.process_time(), time.perf_counter()
        fit = run(frame)
        least = min(least, (time.process_time() - cpu, time.perf_counter() - wall))
    rows = frame.counts.shape[0]
    return fit, f"{1e3 * least[0] / rows:.3f} ({1e3 * least[1] / rows:.3f})"


def converged(fit):
    """Share of the blocks that were fitted and converged."""
    odd = sum(1 << list(xray.FRAME_FLAGS).index(name) for name in ("not_converged", "not_fitted"))
    return float(np.mean((fit.flags & odd) == 0))


TOML = """
counts = "{counts}"
flat = "flat.npy"
dark = 20
gain = 1
pixel_size = "0.67 um"
energy = "10 keV"
frames = "{frames}"
block_rows = {block_rows}
shells = 1
[solution]
polymer = "PEO"
solvent = "water"
volume_fraction = 0.06
"""

RUN = """
import json, resource, time
from pathlib import Path
from spinline.images import load_images
from spinline.radiography.reduce import reduce_images
marks = []
def said(what, done, total): marks.append((what, done, time.perf_counter()))
def used(who): return sum(resource.getrusage(who)[:2])
if __name__ == "__main__":
    begun = time.perf_counter()
    result = reduce_images(load_images("images.toml"), checkpoint="job", workers={workers}, progress=said)
    all_of_it = time.perf_counter() - begun
    pieces = [(done, t) for what, done, t in marks if what == "frames"]
    (first, early), (last, late) = (pieces[0], pieces[-1]) if pieces else ((0, 0.0), (0, 0.0))
    summed = (late - early) * last / (last - first) if last > first else 0.0  # without start-up and flats
    status = open("/proc/self/status").read()  # of this program alone: what getrusage says is handed down
    times = dict(sum=summed, all=all_of_it, here=used(resource.RUSAGE_SELF), workers=used(resource.RUSAGE_CHILDREN),
                 peak=int(status.split("VmHWM:")[1].split()[0]) / 1024,
                 peak_worker=resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024)
    Path("times.json").write_text(json.dumps(times))
    result.to_netcdf("result.nc", engine="h5netcdf")
"""


def run(folder, workers):
    """Reduce in a process of its own; what it took.

    ``ready`` is the time that its threads and processes ran or waited for a processor: over the wall time, how many processors
    it can use. Unlike the wall time it does not depend on what else the machine has to do: where the kernel shares processors
    out by sessions (sched_autogroup), two busy processes of one session get no more of a loaded machine than one.
    """
    script = folder / "run.py"
    script.write_text(RUN.format(workers=workers), encoding="utf-8")
    job = subprocess.Popen([sys.executable, "-W", "ignore", script], cwd=folder)
    seen = {}
    while job.poll() is None:
        for task in _tasks(job.pid):
            with contextlib.suppress(OSError, ValueError):
                ran, waited, _ = (task / "schedstat").read_text().split()
                seen[task.name] = 1e-9 * (int(ran) + int(waited))
        time.sleep(0.05)
    assert job.returncode == 0, job.returncode
    return json.loads((folder / "times.json").read_text()) | {"ready": sum(seen.values())}


def _tasks(pid):
    """Threads of a process and of those it started."""
    found = []
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            found.append(task)
            with contextlib.suppress(OSError):
                for child in (task / "children").read_text().split():
                    found += _tasks(int(child))
    return found


def frames(folder, count, rows, columns, photons, each, block_rows, kind="npy"):
    """Frames of a jet on disk; of many, 16 different ones over and over."""
    rng = np.random.default_rng(2)
    mean, _ = phantom(50e-6, photons, [0.06], width=columns * PIXEL / 50e-6 + 1e-9)
    some = rng.poisson(mean + 20, (16, rows, columns)).astype(np.uint16)
    made = (
        some[i % 16] if count > 500 else rng.poisson(mean + 20, (rows, columns)).astype(np.uint16) for i in range(count)
    )
    path, shape = folder / f"counts.{kind}", (count, rows, columns)
    if kind == "h5":
        import h5py

        with h5py.File(path, "w") as file:
            data = file.create_dataset("entry/data", shape, np.uint16, chunks=(1, rows, columns))
            for i, frame in enumerate(made):
                data[i] = frame
    elif kind == "tif":
        import tifffile

        tifffile.imwrite(path, made, shape=shape, dtype=np.uint16, photometric="minisblack", bigtiff=True)
    else:
        with path.open("wb") as file:
            np.lib.format.write_array_header_1_0(file, {"descr": "<u2", "fortran_order": False, "shape": shape})
            for frame in made:
                file.write(frame.tobytes())
    np.save(folder / "flat.npy", rng.poisson(photons + 20, (64, rows, columns)).astype(np.uint16))
    name = path.name + (":/entry/data" if kind == "h5" else "")
    text = TOML.format(counts=name, frames="each" if each else "sum", block_rows=block_rows)
    (folder / "images.toml").write_text(text, encoding="utf-8")
    return path


def forget(path):
    """Drop a file from the page cache, so that the disk is read."""
    with path.open("rb") as file:
        os.fsync(file.fileno())
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def stream(folder):
    """10,000 frames of 1000 x 300 in HDF5, TIFF and npy, summed and reduced, against reading the file alone."""
    for kind in ("h5", "tif", "npy"):
        path = frames(folder, 10_000, 1000, 300, 2000, each=False, block_rows=4, kind=kind)
        size = path.stat().st_size
        for when in ("from disk", "from the page cache"):
            if when == "from disk":
                forget(path)
            begun = time.perf_counter()
            with path.open("rb", buffering=0) as file:
                while file.read(1 << 24):
                    pass
            plain = time.perf_counter() - begun
            if when == "from disk":
                forget(path)
            took = run(folder, 1)
            print(
                f"stream, {kind}, {when}: {size / 1e9:.1f} GB; reading alone {plain:.1f} s; sum {took['sum']:.1f} s = "
                f"{took['sum'] / plain:.2f} times that, {size / 1e9 / took['sum']:.2f} GB/s; with the reduction "
                f"{took['all']:.1f} s, processor {took['here']:.1f} s, peak {took['peak']:.0f} MB; load "
                f"{os.getloadavg()[0]:.1f}",
                flush=True,
            )
        path.unlink()


def each(folder, count=200, rows=1000):
    """200 frames of 1000 x 300, each on its own: one process, two, and two killed half way and run again."""
    frames(folder, count, rows, 300, 60000, each=True, block_rows=10)
    print(
        f"each: {count} frames of {rows} x 300, blocks of 10 rows, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"
    )
    took = {}
    for workers in (1, 2):
        took[workers] = t = run(folder, workers)
        busy = t["here"] + t["workers"]
        print(
            f"  {workers} process{'es' if workers > 1 else ''}: wall {t['all']:.1f} s, processor {busy:.1f} s, ready to use "
            f"{t['ready'] / t['all']:.2f} processors; peak {t['peak']:.0f} MB, worker {t['peak_worker']:.0f} MB; "
            f"load {os.getloadavg()[0]:.1f}",
            flush=True,
        )
        (folder / "result.nc").replace(folder / f"result-{workers}.nc")
    one, two = took[1], took[2]
    print(
        f"  wall, one over two: {one['all'] / two['all']:.2f}; processors ready to be used, two over one: "
        f"{two['ready'] / two['all'] / (one['ready'] / one['all']):.2f}"
    )
    job = subprocess.Popen([sys.executable, "-W", "ignore", folder / "run.py"], cwd=folder, start_new_session=True)
    while len(list((folder / "job").glob("frame-*.npz"))) < 0.4 * count and job.poll() is None:
        time.sleep(0.05)
    os.killpg(job.pid, signal.SIGKILL)
    job.wait()
    done = len(list((folder / "job").glob("frame-*.npz")))
    again = run(folder, 2)
    from spinline.solve.results import open_dataset

    one, two, resumed = (open_dataset(folder / name) for name in ("result-1.nc", "result-2.nc", "result.nc"))
    print(
        f"  killed after {done} frames, run again in {again['all']:.1f} s; identical: one and two processes {one.equals(two)}, "
        f"whole and resumed {two.equals(resumed)}"
    )


if __name__ == "__main__":
    asked = sys.argv[1:] or ["scatter", "coverage", "bias", "low", "speed"]
    for name in (a for a in asked if a in ("scatter", "coverage", "bias", "low", "speed")):
        globals()[name]()
    where = [Path(a) for a in asked if Path(a).is_dir()]
    for name in (a for a in asked if a in ("stream", "each")):
        with tempfile.TemporaryDirectory(dir=where[0] if where else None) as scratch:
            globals()[name](Path(scratch))
    print(f"peak memory of this process {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")
