"""Damage for files, and a judge that survives what it reads: used by the attack tests and by ``benchmarks/attack.py``.

A victim is a file (or a folder of files) that the program writes or reads. It is damaged in one of five ways and read again
in a process of its own; the verdict is one word.

=============  =====================================================================================
``same``       the same numbers, bit for bit
``refused``    an `InputError`
``redone``     seen to be damaged, and made again (checkpoints, stores)
``read``       read, where the file is another program's and carries no checksum
``different``  other numbers without a word: must never be
``traceback``  any other exception: must never be
``crash``      the process died: must never be
``hang``       more than 20 s: must never be
=============  =====================================================================================
"""

import os
import random
import select
import shutil
import signal
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

GOOD = {"same", "refused", "redone", "read"}
LONGEST = 20.0  # s
_BATCH = 25


@dataclass(frozen=True)
class Victim:
    """Something to damage: where it is, how it is read, and whether it carries checksums of ours."""

    name: str
    place: Path
    read: Callable[[Path], Any]
    ours: bool = True


def damage(data: bytes, rng: random.Random) -> bytes:
    """The bytes with one thing wrong: a bit, a byte, a cut, a hole, or a run of zeros."""
    if not data:
        return b"\x00"
    at = rng.randrange(len(data))
    kind = rng.choice(("bit", "bit", "byte", "cut", "hole", "zeros"))
    span = min(len(data) - at, rng.choice((1, 16, 512, 4096)))
    if kind == "bit":
        return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]
    if kind == "byte":
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    if kind == "cut":
        return data[:at]
    if kind == "hole":
        return data[:at] + data[at + span :]
    return data[:at] + bytes(span) + data[at + span :]


def damaged(victim: Victim, folder: Path, seed: int) -> Path:
    """A damaged copy of a victim; of a folder one file is damaged, or gone."""
    rng = random.Random(f"{victim.name} {seed}")
    copy = folder / f"{seed}-{victim.place.name}"
    if victim.place.is_dir():
        shutil.copytree(victim.place, copy)
        files = sorted(file for file in copy.rglob("*") if file.is_file())
        file = rng.choice(files)
        if rng.random() < 0.15:
            file.unlink()
            return copy
    else:
        shutil.copyfile(victim.place, copy)
        file = copy
    file.write_bytes(damage(file.read_bytes(), rng))
    return copy


def attack(victim: Victim, folder: Path, seeds: range) -> tuple[Counter[str], list[str]]:
    """Verdicts on so many damaged copies, and the worst in words."""
    whole = victim.read(victim.place)
    verdicts: Counter[str] = Counter()
    bad: list[str] = []
    todo = list(seeds)
    while todo:
        batch, todo = todo[:_BATCH], todo[_BATCH:]
        done, reason = _batch(victim, whole, folder, batch)
        for seed, verdict in done.items():
            verdicts[verdict.partition(":")[0]] += 1
            if verdict.partition(":")[0] not in GOOD:
                bad.append(f"{victim.name} {seed} {verdict}")
        if len(done) < len(batch):  # the next one ended the process
            verdicts[reason] += 1
            bad.append(f"{victim.name} {batch[len(done)]} {reason}")
            todo = batch[len(done) + 1 :] + todo
    return verdicts, bad


def _batch(victim: Victim, whole: Any, folder: Path, batch: list[int]) -> tuple[dict[int, str], str]:
    """Verdicts by a child, up to the damage that kills it or keeps it busy."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        for stream in (1, 2):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
        try:
            for seed in batch:
                os.write(writing, f"{seed} {_judge(victim, whole, folder, seed)}\n".encode())
        finally:
            os._exit(0)
    os.close(writing)
    text, reason, last = b"", "crash", time.monotonic()
    while True:
        ready, _, _ = select.select([reading], [], [], LONGEST)
        more = os.read(reading, 65536) if ready else b""
        if not more:
            reason = "crash" if ready or time.monotonic() - last < LONGEST else "hang"
            break
        text, last = text + more, time.monotonic()
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    os.close(reading)
    lines = [line.split(" ", 1) for line in text.decode().splitlines()]
    return {int(seed): verdict for seed, verdict in lines}, reason


def _judge(victim: Victim, whole: Any, folder: Path, seed: int) -> str:
    from spinline.base.errors import InputError

    copy = damaged(victim, folder, seed)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = victim.read(copy)
    except InputError:
        return "refused"
    except Exception as error:
        return f"traceback: {type(error).__name__} {str(error).splitlines()[:1]}"
    finally:
        shutil.rmtree(copy, ignore_errors=True) if copy.is_dir() else copy.unlink(missing_ok=True)
    if isinstance(found, str) and found == "redone":
        return "redone"
    if same(found, whole):
        return "same"
    return "different" if victim.ours else "read"


def same(a: Any, b: Any) -> bool:
    """Bit for bit."""
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    return type(a) is type(b) and a == b


# --- victims -----------------------------------------------------------------------------------------------------------


def _arrays(dataset: Any) -> dict[str, Any]:
    found: dict[str, Any] = {str(name): np.asarray(v.values) for name, v in dataset.variables.items()}
    found = {
        name: np.array(value.tolist(), dtype=str) if value.dtype.kind in "OT" else value
        for name, value in found.items()
    }
    return found | {f"@{key}": str(value) for key, value in dataset.attrs.items()}


def read_netcdf(path: Path) -> dict[str, Any]:
    """A result."""
    from spinline.base.netcdf import open_dataset

    return _arrays(open_dataset(path))


def read_store(path: Path) -> Any:
    """A sweep."""
    from spinline.study.rows import PENDING
    from spinline.study.store import open_sweep

    found = _arrays(open_sweep(path))
    # a chunk without its status counts as not computed: its rows say so, and the sweep computes them again
    return "redone" if (found["status"] == PENDING).any() else found


def read_piece(path: Path) -> Any:
    """A piece of a checkpoint."""
    from spinline.base.checkpoint import Checkpoint

    found = Checkpoint(path.parent, None).load(path.stem)
    return "redone" if found is None else found


def read_chain(path: Path) -> Any:
    """A checkpoint of a chain."""
    from spinline.network.chain.state import load_states

    (state,) = load_states(path, "print")
    return {name: np.asarray(getattr(state, name)) for name in ("positions", "tensions", "velocities", "time")}


def read_scene(path: Path) -> Any:
    """A scene, solved."""
    from spinline.scene.file import load_scene
    from spinline.solve.spine import solved

    found = solved(load_scene(path, ["accuracy.points=20", "network.model=affine"]))
    return {name: v.values for name, v in found.variables.items()}


def read_table(path: Path) -> Any:
    """Columns."""
    from spinline.jetprofile.columns import read_columns

    return read_columns(path, {"z": "length", "radius": "length", "radius_std": "length"})


def read_beads(path: Path) -> Any:
    """A run of JETSPIN."""
    from spinline.jetprofile.jetspin import read_jetspin

    return _arrays(read_jetspin(path))


def read_statistics_of(path: Path) -> Any:
    """The statistics of a run of JETSPIN."""
    from spinline.jetprofile.jetspin import read_statistics

    return _arrays(read_statistics(path))


def read_fibres(path: Path) -> Any:
    """A file of laid fibres, every row and what it says of itself."""
    from spinline.deposit import FibreFile

    with FibreFile(path) as file:
        rows = file.read()
        return {
            "attributes": dict(file.attributes),
            **{name: getattr(rows, name) for name in ("x", "dx", "radius", "fibre")},
        }


def read_line(path: Path) -> Any:
    """A jet of beads in a format of other programs."""
    from spinline.jetprofile.readers import read_beads as read

    jet = read(path, unit="cm" if path.suffix == ".vtk" else None)
    return {name: np.asarray(value) for name, value in vars(jet).items() if isinstance(value, np.ndarray)}


def read_sizes(path: Path) -> Any:
    """Measured diameters."""
    from spinline.deposit.measured import read_diameters

    return read_diameters(path).diameter


def read_frames(path: Path) -> Any:
    """A stack of frames, all of it."""
    from spinline.images.stacks import open_stack

    inside = ":/counts" if path.suffix == ".h5" else ""
    stack = open_stack(f"{path.name}{inside}", "counts", path.parent)
    found = stack.read(0, stack.frames)
    return np.asarray(found[0] if isinstance(found, tuple) else found)


def make_victims(folder: Path, data: Path) -> list[Victim]:
    """One of every file that the program writes, or reads.

    Parameters
    ----------
    folder : Path
        Where they are made.
    data : Path
        ``tests/data``.
    """
    import h5py
    import tifffile

    from spinline.base.checkpoint import Checkpoint
    from spinline.jetprofile.jetspin import write_jet
    from spinline.network.chain.state import ChainState, save_states
    from spinline.scene.file import bundled_scenes, load_scene
    from spinline.solve import results
    from spinline.solve.spine import solved
    from spinline.study.sweep import run_sweep, sweep_from_dict

    rng = np.random.default_rng(0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        results.save(solved(load_scene("peo5-water", ["accuracy.points=60"])), folder / "run.nc")
        run = data / "jetspin" / "ex2_1d_insert"
        write_jet(run, folder / "jet.nc")
        sweep = sweep_from_dict(
            {
                "scene": "peo5-water",
                "chunk": 40,
                "profiles": ["radius"],
                "points": 5,
                "design": {"kind": "latin-hypercube", "samples": 120},
                "vary": {"jet.k": {"uniform": [0.5, 2.0]}},
            },
            ["network.model=affine"],
        )
        run_sweep(sweep, folder / "sweep.zarr", workers=1)
    (folder / "job").mkdir()
    Checkpoint(folder / "job", None).save("piece", total=rng.random((20, 30)), frames=np.array(3))
    x = np.linspace(5.0, 0.0, 40)
    save_states(folder / "chain.npz", [ChainState(1.0, x, x[1:], x, 3, x, x)], "print")
    shutil.copyfile(bundled_scenes()["peo5-water"], folder / "scene.toml")
    z = np.linspace(0, 5, 60)
    rows = "".join(f"{a:.6g},{100 / (1 + a):.6g},{1 + 0.1 * a:.3g}\n" for a in z)
    (folder / "table.csv").write_text("z [mm],radius [um],radius_std [um]\n" + rows, encoding="utf-8")
    counts = rng.poisson(200.0, (3, 24, 40)).astype(np.uint16)
    np.savez_compressed(folder / "frames.npz", counts=counts)
    np.save(folder / "frames.npy", counts)
    tifffile.imwrite(folder / "frames.tif", counts, photometric="minisblack")
    with h5py.File(folder / "frames.h5", "w") as file:
        file.create_dataset("counts", data=counts, chunks=(1, 24, 40), compression="gzip")
    from spinline.deposit import FibreWriter, Segments

    with FibreWriter(folder / "fibres.h5", {"mat": "a text", "seed": 3}) as laid:
        laid.write(Segments.from_paths([np.cumsum(rng.normal(scale=1e-5, size=(400, 2)), axis=0)], 3e-7))
    line = np.column_stack([np.linspace(0, 5, 30), np.sin(np.arange(30.0)), np.cos(np.arange(30.0))])
    points = "\n".join(f"{a:.6g} {b:.6g} {c:.6g}" for a, b, c in line)
    cells, radii = " ".join(map(str, range(30))), " ".join(f"{0.01 / (1 + i):.6g}" for i in range(30))
    (folder / "line.vtk").write_text(
        f"# vtk DataFile Version 3.0\njet\nASCII\nDATASET POLYDATA\nPOINTS 30 double\n{points}\n"
        f"LINES 1 31\n30 {cells}\nPOINT_DATA 30\nSCALARS radius double 1\nLOOKUP_TABLE default\n{radii}\n"
    )
    table = "\n".join(f"{a:.6g},{b:.6g},{c:.6g},{0.01:.3g}" for a, b, c in line)
    (folder / "line.csv").write_text(f"x [cm],y [cm],z [cm],radius [cm]\n{table}\n")
    (folder / "sizes.csv").write_text("Diameter (nm)\n" + "\n".join(str(d) for d in range(400, 700, 3)) + "\n")
    victims = [
        Victim("fibres", folder / "fibres.h5", read_fibres),
        Victim("line vtk", folder / "line.vtk", read_line, ours=False),
        Victim("line csv", folder / "line.csv", read_line, ours=False),
        Victim("diameters", folder / "sizes.csv", read_sizes, ours=False),
        Victim("result", folder / "run.nc", read_netcdf),
        Victim("jet", folder / "jet.nc", read_netcdf),
        Victim("store", folder / "sweep.zarr", read_store),
        Victim("checkpoint", folder / "job" / "piece.npz", read_piece),
        Victim("chain", folder / "chain.npz", read_chain),
        Victim("scene", folder / "scene.toml", read_scene, ours=False),
        Victim("table", folder / "table.csv", read_table, ours=False),
        Victim("frames npz", folder / "frames.npz", read_frames, ours=False),
        Victim("frames npy", folder / "frames.npy", read_frames, ours=False),
        Victim("frames tif", folder / "frames.tif", read_frames, ours=False),
        Victim("frames h5", folder / "frames.h5", read_frames, ours=False),
    ]
    beads = sorted((data / "jetspin").glob("*/traj.xyz"), key=lambda file: file.stat().st_size)[:1]
    stats = sorted((data / "jetspin").glob("*/statout.dat"), key=lambda file: file.stat().st_size)[:1]
    victims += [Victim("beads", file, read_beads, ours=False) for file in beads]
    return victims + [Victim("statistics", file, read_statistics_of, ours=False) for file in stats]
