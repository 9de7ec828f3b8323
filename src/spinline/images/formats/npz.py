"""Arrays of an .npz file by name, each read in order without unpacking the whole."""

import math
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Account, Array, FrameReader, frames_shape

__all__ = ["FORMAT"]

_MOST_PACKED = 1100  # deflate makes no more of a byte


class _Member:
    """One array of an .npz file."""

    threads = False

    def __init__(self, path: Path, inside: str | None, key: str) -> None:
        self.path = path
        with zipfile.ZipFile(path) as archive:
            names = [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]
        wanted = inside.strip("/") if inside else key if key in names else names[0] if len(names) == 1 else key
        if wanted not in names:
            raise InputError(
                key,
                f"is not an array of {path.name}",
                value=wanted,
                allowed=", ".join(names) or "none",
                remedy=f'store it as {key!r}, or write "{path.name}:name"',
            )
        self.member = f"{wanted}.npy"
        self.account = Account(f"{path.name}:{wanted}")
        shape, fortran, self.dtype = self._rewind()
        with zipfile.ZipFile(path) as archive:
            entry = archive.getinfo(self.member)
        size = math.prod(shape) * self.dtype.itemsize
        if size > entry.file_size or entry.file_size > _MOST_PACKED * entry.compress_size + 4096:
            raise InputError(
                key,
                f"declares {size} bytes, more than {path.name} can hold",
                value=wanted,
                remedy="copy the file again",
            )
        self.shape = frames_shape(shape, key, path.name)
        self.whole: Array | None = None
        if fortran and len(shape) > 1:
            with np.load(path, allow_pickle=False) as data:
                self.whole = np.ascontiguousarray(data[wanted]).reshape(self.shape)

    def _rewind(self) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
        self.stream = zipfile.ZipFile(self.path).open(self.member)  # noqa: SIM115 - read on and on
        version = np.lib.format.read_magic(self.stream)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        self.at = 0
        return header(self.stream)

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        if self.whole is not None:
            return self.whole[start:stop]
        size = self.shape[1] * self.shape[2] * self.dtype.itemsize
        if start < self.at:
            self._rewind()
        while self.at < start:  # forward, without holding what is passed
            self._exactly(size)
            self.at += 1
        data = self._exactly(size * (stop - start))
        self.at = stop
        return np.frombuffer(data, self.dtype).reshape(stop - start, *self.shape[1:])

    def _exactly(self, size: int) -> bytes:
        parts, left = [], size
        while left:
            part = self.stream.read(left)
            if not part:
                raise EOFError(f"{self.path.name} ends early")
            parts.append(part)
            left -= len(part)
        return b"".join(parts)


class _Npz:
    name = "npz"
    suffixes = (".npz",)
    inside = True

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as a zip archive does."""
        return head.startswith(b"PK\x03\x04")

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open an array by the name inside, or by the key."""
        return _Member(path, inside, key)


FORMAT = _Npz()
