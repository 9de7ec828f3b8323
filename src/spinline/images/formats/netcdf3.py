"""Classic netCDF (netCDF-4 is HDF5), unpacked by scale_factor, add_offset and _FillValue."""

from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Account, Array, FrameReader, frames_shape
from spinline.images.packing import packing_of

__all__ = ["FORMAT"]


class _Variable:
    """A variable of a classic netCDF file."""

    threads = False

    def __init__(self, path: Path, inside: str | None, key: str) -> None:
        from scipy.io import netcdf_file

        self.path = path
        with netcdf_file(path, "r", mmap=True, maskandscale=False) as file:
            attributes, kind = self._look(file, inside, key)  # nothing of the file is held on to
        source = f"{path.name}:/{self.name}"
        self.packing = packing_of(attributes.get, key, source)
        self.dtype: np.dtype[Any] = kind if self.packing is None else np.dtype(np.float64)
        self.account = Account(source, "" if self.packing is None else "unpacked by its attributes")

    def _look(self, file: Any, inside: str | None, key: str) -> tuple[dict[str, Any], np.dtype[Any]]:
        """Find the variable: its attributes, and its type."""
        path = self.path
        names = [name for name, v in file.variables.items() if len(v.shape) >= 2]
        wanted = inside.strip("/") if inside else key if key in names else names[0] if len(names) == 1 else ""
        if wanted not in file.variables:
            raise InputError(
                key,
                f"does not say which variable of {path.name}",
                value=inside,
                allowed=", ".join(names) or "none",
                remedy=f'write "{path.name}:/variable"',
            )
        self.name = wanted
        variable = file.variables[wanted]
        self.shape = frames_shape(tuple(variable.shape), key, path.name)
        kind = np.dtype(variable.data.dtype).newbyteorder("=")
        return {**variable._attributes}, kind

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        from scipy.io import netcdf_file

        with netcdf_file(
            self.path, "r", mmap=True, maskandscale=False
        ) as file:  # closed: what was mapped is given back
            raw = self._part(file.variables[self.name].data, start, stop)
        return raw if self.packing is None else self.packing.unpacked(raw)

    def _part(self, array: Array, start: int, stop: int) -> Array:
        """A copy of frames, in this machine's order of bytes."""
        part = array[start:stop] if array.ndim == 3 else array.reshape(self.shape)[start:stop]
        return np.array(part, dtype=np.dtype(array.dtype).newbyteorder("="))


class _Netcdf3:
    name = "netcdf3"
    suffixes = (".nc", ".cdf", ".nc3")
    inside = True

    def owns(self, head: bytes) -> bool:
        """Whether a file begins as classic netCDF does."""
        return head[:3] == b"CDF" and head[3:4] in (b"\x01", b"\x02", b"\x05")

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open a variable."""
        with path.open("rb") as file:
            if file.read(4) == b"CDF\x05":
                raise InputError(
                    key,
                    "is netCDF of the 64-bit data kind (CDF-5)",
                    value=path.name,
                    remedy="nccopy -k nc4 makes netCDF-4 of it",
                )
        return _Variable(path, inside, key)


FORMAT = _Netcdf3()
