"""Peak memory and rate of reading a stack of frames, format by format: ten thousand frames of 150 x 220 pixels, 16 bits.

    PYTHONPATH=src python benchmarks/frame_formats.py [--frames N] [FORMAT ...]

Every format is read in a process of its own (`sum_frames`); the peak is the whole process', Python and numpy with it (a process
that only imports the package is the first line). Results go into `frame_formats.json`.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

OUT = Path(__file__).with_suffix(".json")
ROWS, COLUMNS = 150, 220


def _spe(frames: int) -> bytes:
    head = bytearray(4100)
    for at, kind, value in ((42, "<u2", COLUMNS), (108, "<i2", 3), (656, "<u2", ROWS), (1446, "<i4", frames)):
        part = np.array([value], kind).tobytes()
        head[at : at + len(part)] = part
    return bytes(head)


def _mrc(frames: int) -> bytes:
    head = np.array([COLUMNS, ROWS, frames, 6], "<i4").tobytes().ljust(208, b"\0")
    return (head + b"MAP DD\0\0").ljust(1024, b"\0")


def _panel(frames: int) -> bytes:
    head = (
        np.array([0x7000, 68, 100, 0, 0, 32, 1, 1, COLUMNS, ROWS, frames, 0], "<u2").tobytes() + np.zeros(1).tobytes()
    )
    return (head + np.array([4], "<u2").tobytes()).ljust(100, b"\0")


_HAMAMATSU = (b"IM" + np.array([0, COLUMNS, ROWS, 0, 0, 2], "<u2").tobytes()).ljust(64, b"\0")
PLAIN = {
    "spe": (".spe", _spe, b""),
    "mrc": (".mrc", _mrc, b""),
    "his, PerkinElmer": (".his", _panel, b""),
    "his, Hamamatsu": (".his", lambda frames: b"", _HAMAMATSU),
}


def write(kind: str, folder: Path, frames: int) -> str:
    """A stack in a format; what names it."""
    rng = np.random.default_rng(0)
    some = rng.poisson(1000, (64, ROWS, COLUMNS)).astype(np.uint16)

    def all_frames():
        for i in range(frames):
            yield some[(i * 7) % 64] + np.uint16(i % 5)

    if kind == "npy":
        file = np.lib.format.open_memmap(folder / "a.npy", "w+", np.uint16, (frames, ROWS, COLUMNS))
        for i, frame in enumerate(all_frames()):
            file[i] = frame
        file.flush()
        return "a.npy"
    if kind.startswith("tiff"):
        import tifffile

        compression = {"tiff": None, "tiff, zlib": "zlib", "tiff, zstd": "zstd"}[kind]
        with tifffile.TiffWriter(folder / "a.tif", bigtiff=True) as out:
            for frame in all_frames():
                out.write(frame, compression=compression, photometric="minisblack", contiguous=compression is None)
        return "a.tif"
    if kind.startswith("hdf5"):
        import h5py
        import hdf5plugin

        options = {
            "hdf5": {},
            "hdf5, gzip": {"compression": "gzip"},
            "hdf5, bitshuffle": dict(hdf5plugin.Bitshuffle()),
        }[kind]
        with h5py.File(folder / "a.h5", "w") as out:
            data = out.create_dataset(
                "counts", (frames, ROWS, COLUMNS), np.uint16, chunks=(1, ROWS, COLUMNS), **options
            )
            for i, frame in enumerate(all_frames()):
                data[i] = frame
        return "a.h5"
    if kind == "edf":
        import fabio

        image = fabio.edfimage.EdfImage(data=some[0])
        for frame in list(all_frames())[1:]:
            image.append_frame(data=frame)
        image.write(str(folder / "a.edf"))
        return "a.edf"
    if kind in PLAIN:
        suffix, head, before = PLAIN[kind]
        with (folder / f"a{suffix}").open("wb") as out:
            out.write(head(frames))
            for frame in all_frames():
                out.write(before + frame.astype("<u2").tobytes())
        return f"a{suffix}"
    if kind == "many cbf files":
        import fabio

        for i, frame in enumerate(all_frames()):
            fabio.cbfimage.CbfImage(data=frame.astype(np.int32)).write(str(folder / f"a_{i}.cbf"))
        return "a_*.cbf"
    if kind == "many png files":
        import imageio.v3

        for i, frame in enumerate(all_frames()):
            imageio.v3.imwrite(folder / f"a_{i}.png", frame)
        return "a_*.png"
    if kind == "many img files":
        text = "{\nHEADER_BYTES=512;\nDIM=2;\nBYTE_ORDER=little_endian;\nTYPE=unsigned_short;\n"
        text += f"SIZE1={COLUMNS};\nSIZE2={ROWS};\n}}"
        for i, frame in enumerate(all_frames()):
            (folder / f"a_{i}.img").write_bytes(text.encode().ljust(512) + frame.astype("<u2").tobytes())
        return "a_*.img"
    if kind == "npz":
        np.savez_compressed(folder / "a.npz", counts=np.stack(list(all_frames())))
        return "a.npz"
    if kind == "netcdf3":
        from scipy.io import netcdf_file

        with netcdf_file(folder / "a.nc", "w") as file:
            for name, size in zip(("t", "z", "x"), (frames, ROWS, COLUMNS), strict=True):
                file.createDimension(name, size)
            file.createVariable("counts", "i4", ("t", "z", "x"))[:] = np.stack(list(all_frames()))
        return "a.nc"
    if kind == "many tiff files":
        import tifffile

        for i, frame in enumerate(all_frames()):
            tifffile.imwrite(folder / f"a_{i}.tif", frame, photometric="minisblack")
        return "a_*.tif"
    raise ValueError(kind)


def read(folder: str, source: str) -> None:
    """Sum a stack; print seconds, peak in MB and frames."""
    from spinline.images.stacks import open_stack
    from spinline.images.sums import sum_frames

    start = time.perf_counter()
    total = sum_frames(open_stack(source, "counts", Path(folder))) if source else None
    took = time.perf_counter() - start
    status = Path("/proc/self/status").read_text(encoding="ascii")
    peak = (
        float(re.search(r"VmHWM:\s+(\d+)", status)[1]) / 1024.0
    )  # of this process alone: getrusage inherits its parent's
    print(json.dumps([took, peak, total.used if total else 0]))


FRAMES = {
    "npy": 10_000,
    "tiff": 10_000,
    "hdf5": 10_000,
    "tiff, zlib": 1000,
    "hdf5, gzip": 1000,
    "hdf5, bitshuffle": 1000,
    "edf": 500,
    "many tiff files": 500,
    "tiff, zstd": 1000,
    "spe": 10_000,
    "mrc": 10_000,
    "his, PerkinElmer": 10_000,
    "his, Hamamatsu": 10_000,
    "npz": 1000,
    "netcdf3": 1000,
    "many cbf files": 200,
    "many img files": 500,
    "many png files": 200,
}


def main() -> None:
    """Write, read and keep."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", default=list(FRAMES))
    parser.add_argument("--frames", type=int)
    parser.add_argument("--read", nargs=2, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.read:
        read(*asked.read)
        return

    def apart(folder: str, source: str) -> list[float]:
        ran = subprocess.run(
            [sys.executable, __file__, "--read", folder, source], capture_output=True, text=True, check=True
        )
        found: list[float] = json.loads(ran.stdout)
        return found

    kept = json.loads(OUT.read_text(encoding="utf-8")) if OUT.exists() else {}
    kept["nothing"] = {"peak_mb": round(apart("", "")[1], 1)}
    for kind in asked.kinds:
        frames = asked.frames or FRAMES[kind]
        with tempfile.TemporaryDirectory() as folder:
            source = write(kind, Path(folder), frames)
            took, peak, used = apart(folder, source)
        size = frames * ROWS * COLUMNS * 2 / 1e6
        kept[kind] = {
            "frames": int(used),
            "mb": round(size, 1),
            "peak_mb": round(peak, 1),
            "mb_per_s": round(size / took, 1),
        }
        print(kind, kept[kind], flush=True)
        OUT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
