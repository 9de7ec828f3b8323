"""One array in a numpy file, read piece by piece."""

from pathlib import Path
from typing import Any

import numpy as np

from spinline.images.formats.base import Account, Array, FrameReader, frames_shape

__all__ = ["FORMAT"]


class _Plain:
    """Numbers one after another in a file. Read, not mapped: mapped pages would count as memory in use."""

    threads = True

    def __init__(self, path: Path, offset: int, shape: tuple[int, int, int], dtype: np.dtype[Any]) -> None:
        self.path, self.offset, self.dtype, self.shape = path, offset, dtype, shape
        self.account = Account(path.name)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        each = self.shape[1] * self.shape[2]
        count = each * (stop - start)
        data = np.fromfile(self.path, self.dtype, count, offset=self.offset + start * each * self.dtype.itemsize)
        if data.size < count:
            raise EOFError(f"{self.path.name} ends early")
        return data.reshape(stop - start, *self.shape[1:])


class _Whole:
    """An array in memory."""

    threads = True

    def __init__(self, array: Array, name: str) -> None:
        self.array, self.dtype = array, array.dtype
        self.shape: tuple[int, int, int] = (array.shape[0], array.shape[1], array.shape[2])
        self.account = Account(name)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        return self.array[start:stop]


class _Npy:
    name = "npy"
    suffixes = (".npy",)
    inside = False

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as numpy's do."""
        return head.startswith(b"\x93NUMPY")

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open an array."""
        array = np.load(path, mmap_mode="r", allow_pickle=False)
        shape = frames_shape(array.shape, key, path.name)
        if isinstance(array, np.memmap) and array.flags.c_contiguous:
            return _Plain(path, int(array.offset), shape, array.dtype)
        return _Whole(np.array(array).reshape(shape), path.name)


FORMAT = _Npy()
