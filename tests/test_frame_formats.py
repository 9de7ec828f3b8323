"""Files of frames: every format by one contract, and a new one through public registration."""

from pathlib import Path

import numpy as np
import pytest
from frame_readers import FRAMES, FrameReaderContract

from spinline.base.errors import InputError
from spinline.images.file_names import natural
from spinline.images.formats import Account, formats, register
from spinline.images.formats import base as formats_base
from spinline.images.stacks import open_stack


class TestNpy(FrameReaderContract):
    suffix = ".npy"

    def write(self, path, frames) -> None:
        np.save(path, frames)


class TestNpyInFortranOrder(TestNpy):
    def write(self, path, frames) -> None:
        np.save(path, np.asfortranarray(frames))


class TestNpz(FrameReaderContract):
    suffix = ".npz"

    def write(self, path, frames) -> None:
        np.savez_compressed(path, counts=frames, other=frames[:1])


class TestTiff(FrameReaderContract):
    suffix = ".tif"

    def write(self, path, frames) -> None:
        import tifffile

        tifffile.imwrite(path, frames, photometric="minisblack")


class TestTiffPageByPage(FrameReaderContract):
    suffix = ".tiff"

    def write(self, path, frames) -> None:
        import tifffile

        path.unlink(missing_ok=True)
        for frame in frames:
            tifffile.imwrite(path, frame, append=True, photometric="minisblack")


class TestTiffCompressed(FrameReaderContract):
    suffix = ".tif"

    def write(self, path, frames) -> None:
        import tifffile

        tifffile.imwrite(path, frames, compression="zlib", photometric="minisblack")


class TestBigEndianTiff(FrameReaderContract):
    suffix = ".tif"

    def write(self, path, frames) -> None:
        import tifffile

        tifffile.imwrite(path, frames, byteorder=">", photometric="minisblack")


class TestImageJ(FrameReaderContract):
    suffix = ".tif"

    def write(self, path, frames) -> None:
        import tifffile

        tifffile.imwrite(path, frames, imagej=True)


class TestHdf5(FrameReaderContract):
    suffix = ".h5"

    def write(self, path, frames) -> None:
        import h5py

        with h5py.File(path, "w") as file:
            file.create_dataset("entry/data/counts", data=frames, chunks=(1, *frames.shape[1:]), compression="gzip")


class TestNetcdf3(FrameReaderContract):
    suffix = ".nc"

    def write(self, path, frames) -> None:
        from scipy.io import netcdf_file

        with netcdf_file(path, "w") as file:
            for name, size in zip(("t", "z", "x"), frames.shape, strict=True):
                file.createDimension(name, size)
            file.createVariable("counts", "i4", ("t", "z", "x"))[:] = frames


class TestEdf(FrameReaderContract):
    suffix = ".edf"

    def write(self, path, frames) -> None:
        fabio = pytest.importorskip("fabio")
        image = fabio.edfimage.EdfImage(data=frames[0])
        for frame in frames[1:]:
            image.append_frame(data=frame)
        image.write(str(path))


class TestCbf(FrameReaderContract):
    suffix, single = ".cbf", True

    def write(self, path, frames) -> None:
        fabio = pytest.importorskip("fabio")
        fabio.cbfimage.CbfImage(data=frames[0].astype(np.int32)).write(str(path))


class TestPng(FrameReaderContract):
    suffix, single = ".png", True

    def write(self, path, frames) -> None:
        imageio = pytest.importorskip("imageio.v3")
        imageio.imwrite(path, frames[0])


class _Toy:
    """A format of one's own: a line of the shape, then numbers."""

    name, suffixes, inside = "toy", (".toy",), False

    def owns(self, head: bytes) -> bool:
        return head.startswith(b"TOY ")

    def open(self, path: Path, inside: str | None, key: str):
        return _ToyFrames(path)


class _ToyFrames:
    threads = True

    def __init__(self, path: Path) -> None:
        head, _, body = path.read_bytes().partition(b"\n")
        self.shape = tuple(int(n) for n in head.split()[1:])
        self.dtype = np.dtype("<u2")
        if len(self.shape) != 3 or len(body) != 2 * np.prod(self.shape):
            raise ValueError("cut short")
        self.array = np.frombuffer(body, self.dtype).reshape(self.shape)
        self.account = Account(path.name)

    def read(self, start: int, stop: int):
        return self.array[start:stop]


class TestARegisteredFormat(FrameReaderContract):
    suffix = ".toy"

    @pytest.fixture(autouse=True)
    def registered(self, monkeypatch):
        monkeypatch.setattr(formats_base, "_REGISTERED", {})
        register(_Toy())

    def write(self, path, frames) -> None:
        path.write_bytes(b"TOY %d %d %d\n" % frames.shape + frames.astype("<u2").tobytes())

    def test_an_images_file_is_reduced_from_it(self, frames_of, tmp_path, quiet) -> None:
        from spinline.radiography.reduce import reduce_images

        images, arrays = frames_of(photons=4e4, block_rows=24)
        expected = reduce_images(images)["mean_polymer_fraction"].values
        self.write(tmp_path / "a.toy", arrays["counts"])
        other = images.model_copy(update={"counts": "a.toy"})
        other._folder, other._text = tmp_path, images.text
        assert reduce_images(other)["mean_polymer_fraction"].values == pytest.approx(expected, rel=1e-12)


def test_formats_do_not_know_one_another() -> None:
    folder = Path(formats_base.__file__).parent
    for file in folder.glob("*.py"):
        text = file.read_text(encoding="utf-8")
        others = {f.stem for f in folder.glob("*.py")} - {"__init__", "base", file.stem}
        assert not [name for name in others if f"formats.{name}" in text or f"formats import {name}" in text], file.name
    assert set(formats()) >= {"hdf5", "netcdf3", "npz", "npy", "tiff", "fabio", "picture"}


@pytest.mark.parametrize(
    ("suffix", "module", "package"),
    [(".edf", "fabio", "fabio"), (".png", "imageio.v3", "imageio"), (".cbf", "fabio", "fabio")],
)
def test_a_package_that_is_not_there_is_named(tmp_path, monkeypatch, suffix, module, package) -> None:
    import sys

    (tmp_path / f"a{suffix}").write_bytes(
        b"\x89PNG\r\n\x1a\n" if suffix == ".png" else b"###CBF: VERSION 1.5\n" + 99 * b" "
    )
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(InputError, match=rf"needs the package {package}.*spinline\[formats\]"):
        open_stack(f"a{suffix}", "counts", tmp_path)


def test_a_file_by_its_first_bytes(tmp_path) -> None:
    """A suffix that says nothing, or something else, is no hindrance."""
    np.save(tmp_path / "a.npy", FRAMES)
    (tmp_path / "a.npy").rename(tmp_path / "frames.dat")
    assert open_stack("frames.dat", "counts", tmp_path).frames == 7
    (tmp_path / "b.dat").write_bytes(b"nothing that is known")
    with pytest.raises(InputError, match="no known kind"):
        open_stack("b.dat", "counts", tmp_path)


@pytest.mark.parametrize(
    "names",
    [["f_1", "f_2", "f_10", "f_100"], ["1.tif", "02.tif", "3.tif", "11.tif"], ["a2b9", "a2b10", "a10b1"], ["x", "x1"]],
)
def test_natural_order(names) -> None:
    mixed = names[::-1]
    assert sorted(mixed, key=natural) == names


@pytest.mark.parametrize("part", [slice(100, 200), slice(7, None)])
def test_frames_beyond_the_stack_are_refused(tmp_path, part) -> None:
    np.save(tmp_path / "a.npy", FRAMES)
    with pytest.raises(InputError, match=r"frames.*leave no frame.*0:7"):
        open_stack("a.npy", "counts", tmp_path, frames=part)
    with pytest.raises(InputError, match=r"roi.*goes beyond.*20 x 33"):
        open_stack("a.npy", "counts", tmp_path, roi=(slice(0, 21), slice(None)))


class TestHamamatsuHis(FrameReaderContract):
    suffix = ".his"

    def write(self, path, frames) -> None:
        out = b""
        for i, frame in enumerate(frames):
            comment = b"taken at %d" % i
            head = b"IM" + np.array([len(comment), frame.shape[1], frame.shape[0], 0, 0, 2], "<u2").tobytes()
            out += head.ljust(64, b"\0") + comment + frame.astype("<u2").tobytes()
        path.write_bytes(out)


class TestPerkinElmerHis(FrameReaderContract):
    suffix = ".his"

    def write(self, path, frames) -> None:
        count, rows, columns = frames.shape
        head = np.array([0x7000, 68, 100], "<u2").tobytes() + np.array([100 + 2 * frames.size], "<u4").tobytes()
        head += np.array([32, 1, 1, columns, rows, count, 0], "<u2").tobytes() + np.zeros(1).tobytes()
        head += np.array([4], "<u2").tobytes()
        path.write_bytes(head.ljust(100, b"\0") + frames.astype("<u2").tobytes())


class TestMrc(FrameReaderContract):
    suffix = ".mrc"

    def write(self, path, frames) -> None:
        """By the format's own definition: 1024 bytes; columns, rows, sections, mode 6 (16 bits, unsigned)."""
        count, rows, columns = frames.shape
        head = np.array([columns, rows, count, 6], "<i4").tobytes()
        path.write_bytes(
            head.ljust(208, b"\0") + b"MAP \x44\x44\0\0".ljust(816, b"\0") + frames.astype("<u2").tobytes()
        )


class TestSpe(FrameReaderContract):
    suffix = ".spe"

    def write(self, path, frames) -> None:
        """By the format's own definition, version 2: 4100 bytes; columns at 42, type at 108 (3: 16 bits), rows at 656, frames at 1446."""
        head = bytearray(4100)
        count, rows, columns = frames.shape
        for at, kind, value in (
            (42, "<u2", columns),
            (108, "<i2", 3),
            (656, "<u2", rows),
            (1446, "<i4", count),
            (1992, "<f4", 2.5),
        ):
            part = np.array([value], kind).tobytes()
            head[at : at + len(part)] = part
        path.write_bytes(bytes(head) + frames.astype("<u2").tobytes())


class TestAdscImg(FrameReaderContract):
    suffix, single = ".img", True

    def write(self, path, frames) -> None:
        pytest.importorskip("fabio")
        rows, columns = frames.shape[1:]
        head = f"{{\nHEADER_BYTES=  512;\nDIM=2;\nBYTE_ORDER=little_endian;\nTYPE=unsigned_short;\nSIZE1={columns};\nSIZE2={rows};\n}}\f"
        path.write_bytes(head.encode().ljust(512) + frames[0].astype("<u2").tobytes())
