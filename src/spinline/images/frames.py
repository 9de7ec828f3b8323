"""Frames on disk, read a few at a time: TIFF, HDF5, npy, npz, or many files of one frame each.

A stack is (frame, z, x) or (z, x), the jet running along z; `transpose` swaps z and x. Nothing is loaded before it is asked
for, and `sum_frames` holds two handfuls of frames at a time, whatever the length of the stack.
"""

import re
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError

__all__ = ["FrameSum", "Stack", "open_stack", "pair_noise", "sample_frames", "sum_frames"]

_AT_ONCE = 24_000_000  # bytes of frames in one read
_HDF5 = re.compile(r"(?P<file>.+\.(?:h5|hdf5|hdf|he5|nxs|nx|nc|mat))(?::(?P<inside>/?[^:]+))?", re.IGNORECASE)
_TIFF = {".tif", ".tiff", ".btf", ".tf8", ".lsm"}
_PAIRS = 16
_PILE_FROM = 100.0  # counts; below, a few values are all there are

Array = NDArray[Any]


class _Reader(Protocol):
    """Reads frames from..to of an array whose last two dimensions are a frame's."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    threads: bool

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""


@dataclass(frozen=True, eq=False)
class Stack:
    """A stack of frames that is read in pieces.

    Attributes
    ----------
    key, name : str
        The key of the images file that names it, and the file.
    frames, rows, columns : int
        After the transposition.
    dtype : numpy.dtype
    """

    key: str
    name: str
    reader: _Reader
    transpose: bool = False

    @property
    def frames(self) -> int:
        """Number of frames; 1 for a single image."""
        return self.reader.shape[0] if len(self.reader.shape) == 3 else 1

    @property
    def rows(self) -> int:
        """Rows of a frame, along the jet."""
        return self.reader.shape[-1 if self.transpose else -2]

    @property
    def columns(self) -> int:
        """Pixels of a row, across the jet."""
        return self.reader.shape[-2 if self.transpose else -1]

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the numbers on disk."""
        return self.reader.dtype

    @property
    def at_once(self) -> int:
        """Frames to read in one piece."""
        return max(1, _AT_ONCE // max(1, self.rows * self.columns * self.dtype.itemsize))

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`: (frames, rows, columns)."""
        try:
            block = self.reader.read(start, stop)
        except InputError:
            raise
        except (OSError, ValueError, zipfile.BadZipFile, EOFError, RuntimeError) as error:
            reason = _first_line(error)
            raise InputError(self.key, f"frames {start} to {stop} cannot be read ({reason})", value=self.name) from None
        block = block.reshape(stop - start, *self.reader.shape[-2:])
        return np.swapaxes(block, 1, 2) if self.transpose else block


def open_stack(source: str, key: str, folder: Path = Path(), *, transpose: bool = False) -> Stack:
    """Open a stack; nothing but its shape and type is read.

    Parameters
    ----------
    source : str
        A file: TIFF, npy, npz (the array named `key`), HDF5 (``file.h5:/path/inside``; without a path the dataset named
        `key`, or the only one); or a pattern such as ``frames/*.tif``.
    key : str
        Key of the images file, for errors.
    folder : path
        That relative paths start from.
    transpose : bool
        Swap the last two dimensions.

    Returns
    -------
    Stack

    Raises
    ------
    InputError
        For a file that is missing or of an unknown kind, no such array inside, or an array that is no stack of frames.
    """
    try:
        reader = _open(source, key, folder)
    except InputError:
        raise
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError, RuntimeError, TypeError, IndexError) as error:
        reason = "damaged" if isinstance(error, IndexError) else _first_line(error)
        raise InputError(key, f"cannot be read ({reason})", value=source) from None
    shape = reader.shape
    if len(shape) not in (2, 3) or min(shape) < 1:
        raise InputError(
            key, "is not a stack of frames", value=f"array of shape {shape}", allowed="(frame, z, x) or (z, x)"
        )
    if reader.dtype.kind not in "uif":
        raise InputError(key, "holds no real numbers", value=str(reader.dtype), allowed="integers or floats")
    return Stack(key, source, reader, transpose)


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _open(source: str, key: str, folder: Path) -> _Reader:
    if any(c in source for c in "*?["):
        files = sorted(folder.glob(source)) if not Path(source).is_absolute() else sorted(Path("/").glob(source[1:]))
        if not files:
            raise InputError(key, "matches no file", value=source, remedy="paths start from the images file's folder")
        return _Files(files, key)
    hdf5 = _HDF5.fullmatch(source)
    path = folder / (hdf5["file"] if hdf5 else source)
    if not path.is_file():
        raise InputError(key, "is not a file", value=source, remedy="paths start from the images file's folder")
    if hdf5:
        return _Hdf5(path, hdf5["inside"], key)
    kind = path.suffix.lower()
    if kind in _TIFF:
        return _tiff(path)
    if kind == ".npy":
        return _mapped(np.load(path, mmap_mode="r", allow_pickle=False))
    if kind == ".npz":
        return _Npz(path, key)
    raise InputError(
        key, "is of no known kind", value=source, allowed=".tif, .npy, .npz, .h5:/path/inside, or a pattern"
    )


def _mapped(array: Array) -> _Reader:
    """A mapped array as a reader: its file read piece by piece where it is stored in C order."""
    if isinstance(array, np.memmap) and array.flags.c_contiguous and array.filename is not None:
        return _Plain(Path(array.filename), int(array.offset), array.shape, array.dtype)
    return _Whole(np.array(array))


class _Plain:
    """Numbers one after another in a file. Read, not mapped: mapped pages would count as memory in use."""

    threads = True

    def __init__(self, path: Path, offset: int, shape: tuple[int, ...], dtype: np.dtype[Any]) -> None:
        self.path, self.offset, self.dtype = path, offset, dtype
        self.shape = shape if len(shape) != 1 else (1, *shape)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        if len(self.shape) == 2:
            start, stop = 0, 1
        each = int(np.prod(self.shape[-2:]))
        count = each * (stop - start)
        data = np.fromfile(self.path, self.dtype, count, offset=self.offset + start * each * self.dtype.itemsize)
        if data.size < count:
            raise EOFError(f"{self.path.name} ends early")
        return data


class _Whole:
    """An array in memory."""

    threads = True

    def __init__(self, array: Array) -> None:
        self.array, self.dtype = array, array.dtype
        self.shape = array.shape if array.ndim != 1 else (1, array.size)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        return self.array[start:stop] if self.array.ndim == 3 else self.array


class _Npz:
    """One array of an npz file, read in order without unpacking the whole."""

    threads = False

    def __init__(self, path: Path, key: str) -> None:
        self.path = path
        with zipfile.ZipFile(path) as archive:
            names = [name.removesuffix(".npy") for name in archive.namelist()]
            if key not in names:
                raise InputError(
                    key,
                    f"is not an array of {path.name}",
                    allowed=", ".join(names) or "none",
                    remedy=f"store it as {key!r}",
                )
            self.member = f"{key}.npy"
        self.shape, self.fortran, self.dtype = self._rewind()
        if self.fortran and len(self.shape) > 1:
            with np.load(path, allow_pickle=False) as data:
                self.whole: Array | None = np.ascontiguousarray(data[key])
        else:
            self.whole = None
        self.shape = self.shape if len(self.shape) != 1 else (1, *self.shape)

    def _rewind(self) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
        self.stream = zipfile.ZipFile(self.path).open(self.member)  # noqa: SIM115 - read on and on
        version = np.lib.format.read_magic(self.stream)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        self.at = 0
        return header(self.stream)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        if self.whole is not None:
            return self.whole[start:stop] if self.whole.ndim == 3 else self.whole
        if len(self.shape) == 2:
            start, stop = 0, 1
        size = int(np.prod(self.shape[-2:])) * self.dtype.itemsize
        if start < self.at:
            self._rewind()
        while self.at < start:  # forward, without holding what is passed
            self._exactly(size)
            self.at += 1
        data = self._exactly(size * (stop - start))
        self.at = stop
        return np.frombuffer(data, self.dtype).reshape(stop - start, *self.shape[-2:])

    def _exactly(self, size: int) -> bytes:
        parts, left = [], size
        while left:
            part = self.stream.read(left)
            if not part:
                raise EOFError(f"{self.path.name} ends early")
            parts.append(part)
            left -= len(part)
        return b"".join(parts)


class _Hdf5:
    """A dataset of an HDF5 file."""

    threads = False  # the library takes one caller at a time

    def __init__(self, path: Path, inside: str | None, key: str) -> None:
        import h5py

        file = h5py.File(path, "r")
        found: list[str] = []
        file.visititems(
            lambda name, thing: found.append(name) if isinstance(thing, h5py.Dataset) and thing.ndim >= 1 else None
        )
        if inside is None:
            named = [name for name in found if name.rpartition("/")[2] == key]
            many = named or found
            if len(many) != 1:
                raise InputError(
                    key, f"does not say which dataset of {path.name}", allowed=", ".join(found) or "none",
                    remedy=f'write "{path.name}:/path/inside"',
                )  # fmt: skip
            inside = many[0]
        if inside.strip("/") not in found:
            raise InputError(key, f"is not a dataset of {path.name}", value=inside, allowed=", ".join(found) or "none")
        self.data = file[inside]
        self.dtype = self.data.dtype
        self.shape = self.data.shape if self.data.ndim != 1 else (1, *self.data.shape)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        return np.asarray(self.data[start:stop] if self.data.ndim == 3 else self.data[...])


def _tiff(path: Path) -> _Reader:
    import logging

    import tifffile

    logging.getLogger("tifffile").setLevel(logging.CRITICAL)  # what is wrong with a file is raised, and said once
    with suppress(ValueError):  # compressed: not to be mapped
        return _mapped(tifffile.memmap(path, mode="r"))
    return _Tiff(path)


class _Tiff:
    """A compressed TIFF, page by page."""

    threads = False

    def __init__(self, path: Path) -> None:
        import tifffile

        self.file = tifffile.TiffFile(path)
        series = self.file.series[0]
        self.shape, self.dtype = series.shape, series.dtype

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        if len(self.shape) == 2:
            return np.asarray(self.file.asarray(key=0))
        try:
            return np.stack([self.file.asarray(key=i) for i in range(start, stop)])
        except IndexError:
            raise EOFError(f"{self.file.filename} ends early") from None


class _Files:
    """Many files of one frame each, in the order of their names."""

    threads = True

    def __init__(self, files: list[Path], key: str) -> None:
        self.files, self.key = files, key
        first = self._one(0)
        if first.ndim != 2:
            raise InputError(key, "matches files of more than one frame", value=files[0].name, remedy="name one file")
        self.shape, self.dtype = (len(files), *first.shape), first.dtype

    def _one(self, i: int) -> Array:
        file = self.files[i]
        if file.suffix.lower() in _TIFF:
            import tifffile

            return np.asarray(tifffile.imread(file))
        if file.suffix.lower() == ".npy":
            return np.asarray(np.load(file, allow_pickle=False))
        raise InputError(self.key, "is of no known kind", value=file.name, allowed=".tif, .npy")

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        frames = [self._one(i) for i in range(start, stop)]
        for i, frame in enumerate(frames):
            if frame.shape != self.shape[1:]:
                raise InputError(
                    self.key, f"{self.files[start + i].name} has another shape than the first frame", value=frame.shape,
                    allowed=str(self.shape[1:]),
                )  # fmt: skip
        return np.stack(frames)


@dataclass(frozen=True, eq=False)
class FrameSum:
    """A stack, summed.

    Attributes
    ----------
    total : ndarray, shape (rows, columns)
        Sum over frames; numbers that are not finite left out.
    exposures : ndarray of int, shape (rows, columns)
        Frames in each sum.
    highest : ndarray, shape (rows, columns)
        The largest number in any frame.
    frames : int
        Frames read so far.
    """

    total: FloatArray
    exposures: NDArray[np.int64]
    highest: FloatArray
    frames: int

    def saturated(self, level: float | None, whole: bool) -> BoolArray:
        """Pixels at or over the level in any frame; if not given, those that pile up at a power of two less one."""
        if level is not None:
            return np.asarray(self.highest >= level)
        top = float(self.highest.max())
        if not whole or top < 255 or np.log2(top + 1.0) % 1.0 != 0.0:
            return np.zeros(self.highest.shape, dtype=np.bool_)
        clipped = self.highest == top
        beside = int((self.highest == top - 1.0).sum())
        return clipped if clipped.sum() > 3 * beside + 4 else np.zeros(clipped.shape, dtype=np.bool_)

    def piled_up(self) -> int:
        """Pixels that hold exactly the highest number, where more of them do than under it: a detector that clips, anywhere."""
        top = float(self.highest.max())
        if not top >= _PILE_FROM:
            return 0
        equal = int((self.highest == top).sum())
        under = int(((self.highest < top) & (self.highest >= top - max(np.sqrt(top), 1.0))).sum())
        return equal if equal > max(0.01 * self.highest.size, 8.0) and equal > 3 * under else 0


def sum_frames(
    stack: Stack,
    *,
    begun: FrameSum | None = None,
    pause: Callable[[FrameSum], None] | None = None,
    threads: int = 2,
) -> FrameSum:
    """Sum of all frames, streamed.

    Parameters
    ----------
    stack : Stack
    begun : FrameSum, optional
        Where an interrupted sum stopped: at a multiple of ``stack.at_once``.
    pause : callable, optional
        Called after each piece with the sum so far (whose arrays change afterwards: copy what is kept).
    threads : int
        Pieces that are read and added up at one time.

    Returns
    -------
    FrameSum
        The same to the last bit whether it was interrupted or not.

    Raises
    ------
    InputError
        For a frame without a single finite number, or one that cannot be read.
    """
    shape = (stack.rows, stack.columns)
    if begun is None:
        total, exposures = np.zeros(shape), np.zeros(shape, dtype=np.int64)
        highest, at = np.full(shape, -np.inf), 0
    else:
        total, exposures, highest, at = begun.total.copy(), begun.exposures.copy(), begun.highest.copy(), begun.frames
    starts = range(at, stack.frames, stack.at_once)
    so_far = FrameSum(total, exposures, highest, at)
    with ThreadPoolExecutor(threads if stack.reader.threads else 1) as pool:
        for stop, part, seen, high in _in_order(
            pool, lambda start: _piece(stack, start, min(start + stack.at_once, stack.frames)), starts, threads + 1
        ):
            np.add(total, part, out=total)
            np.add(exposures, seen, out=exposures)
            np.maximum(highest, high, out=highest)
            so_far = FrameSum(total, exposures, highest, stop)
            if pause is not None:
                pause(so_far)
    return so_far


def _in_order(
    pool: ThreadPoolExecutor, work: Callable[[int], Any], items: range, ahead: int
) -> Iterator[tuple[int, Array, Array, Array]]:
    """Results in order, with at most `ahead` of them under way."""
    todo = iter(items)
    waiting: list[Future[Any]] = [pool.submit(work, item) for item in islice(todo, ahead)]
    while waiting:
        yield waiting.pop(0).result()
        waiting.extend(pool.submit(work, item) for item in islice(todo, 1))


def _piece(stack: Stack, start: int, stop: int) -> tuple[int, Array, Array, Array]:
    """Sum, number and maximum of one piece."""
    block = stack.read(start, stop)
    if block.dtype.kind in "ui":
        small = block.dtype.itemsize <= 2
        wide = np.uint32 if small and block.dtype.kind == "u" else np.int64
        return stop, block.sum(axis=0, dtype=wide), np.asarray(stop - start), block.max(axis=0)
    finite = np.isfinite(block)
    empty = ~finite.any(axis=(1, 2))
    if empty.any():
        raise InputError(
            stack.key, "holds a frame without a finite number", value=f"frame {start + int(np.argmax(empty))}",
            remedy="leave that frame out",
        )  # fmt: skip
    if finite.all():
        return stop, block.sum(axis=0, dtype=np.float64), np.asarray(stop - start), block.max(axis=0)
    kept = np.where(finite, block, 0.0)
    return stop, kept.sum(axis=0, dtype=np.float64), finite.sum(axis=0), np.where(finite, block, -np.inf).max(axis=0)


def sample_frames(stack: Stack, most: int = 64) -> FrameSum:
    """Sum of up to `most` frames, spread over the stack."""
    if stack.frames <= most:
        return sum_frames(stack)
    picked = np.unique(np.linspace(0, stack.frames - 1, most).astype(int)).tolist()
    parts = [_piece(stack, i, i + 1) for i in picked]
    return FrameSum(
        np.sum([p[1] for p in parts], axis=0, dtype=np.float64),
        np.sum([np.broadcast_to(p[2], (stack.rows, stack.columns)) for p in parts], axis=0),
        np.max([p[3] for p in parts], axis=0).astype(np.float64),
        len(picked),
    )


def pair_noise(
    stack: Stack, part: tuple[slice, slice] = (slice(None), slice(None)), dark: FloatArray | float = 0.0
) -> tuple[float, float, int] | None:
    """Noise of single frames, from differences of neighbours.

    Parameters
    ----------
    stack : Stack
    part : (slice, slice)
        Rows and columns to look at.
    dark : ndarray or float
        Level without a beam, taken off before frames are brought to one brightness.

    Returns
    -------
    variance, level, samples : float, float, int
        Mean variance of a pixel of one frame, mean level above dark, and pixel pairs used; None for fewer than two frames.

    Notes
    -----
    Pairs are scaled to the same mean (a beam that flickers is no noise), and pixels 6 robust standard deviations off left out.
    Up to 16 pairs, spread over the stack.
    """
    if stack.frames < 2:
        return None
    pairs = np.unique(np.linspace(0, stack.frames - 2, _PAIRS).astype(int))
    variance = level = 0.0
    samples = 0
    for i in pairs.tolist():
        first, second = np.asarray(stack.read(i, i + 2), dtype=np.float64)
        off = np.broadcast_to(np.asarray(dark, dtype=np.float64), first.shape)[part]
        a, b = first[part] - off, second[part] - off
        good = np.isfinite(a) & np.isfinite(b)
        a, b = a[good], b[good]
        if a.size < 16:
            continue
        mean_a, mean_b = float(a.mean()), float(b.mean())
        ratio = mean_a / mean_b if mean_a > 0 and mean_b > 0 and abs(mean_a / mean_b - 1) < 0.5 else 1.0
        d = a - ratio * b
        spread = 1.4826 * float(np.median(np.abs(d)))
        near = np.abs(d) <= 6.0 * spread if spread > 0 else np.ones(d.shape, dtype=np.bool_)
        count = int(near.sum())
        variance += float((d[near] ** 2).sum()) / (1.0 + ratio)  # var a + ratio^2 var b, with var b = var a / ratio
        level += float(a[near].sum())
        samples += count
    return (variance / samples, level / samples, samples) if samples else None
