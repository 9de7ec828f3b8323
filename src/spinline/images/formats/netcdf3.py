"""Classic netCDF (netCDF-4 is HDF5), unpacked by scale_factor, add_offset and _FillValue."""

from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.images.formats.base import Account, Array, FrameReader, frames_shape

__all__ = ["FORMAT"]


class _Variable:
    """A variable of a classic netCDF file."""

    threads = False

    def __init__(self, path: Path, inside: str | None, key: str) -> None:
        from scipy.io import netcdf_file

        self.path = path
        with netcdf_file(path, "r", mmap=True, maskandscale=False) as file:
            self._look(file, inside, key)

    def _look(self, file: Any, inside: str | None, key: str) -> None:
        """Find the variable and what it is packed by."""
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
        found = {
            name: getattr(variable, name, None)
            for name in ("scale_factor", "add_offset", "_FillValue", "missing_value")
        }
        self.scale = None if found["scale_factor"] is None else float(found["scale_factor"])
        self.offset = None if found["add_offset"] is None else float(found["add_offset"])
        self.fill = [float(np.ravel(v)[0]) for v in (found["_FillValue"], found["missing_value"]) if v is not None]
        packed = self.scale is not None or self.offset is not None or bool(self.fill)
        self.dtype: np.dtype[Any] = np.dtype(np.float64) if packed else np.dtype(variable.data.dtype).newbyteorder("=")
        self.packed = packed
        self.account = Account(f"{path.name}:/{wanted}", "unpacked by its attributes" if packed else "")

    def read(self, start: int, stop: int) -> Array:
        """Frames from `start` to before `stop`."""
        from scipy.io import netcdf_file

        with netcdf_file(
            self.path, "r", mmap=True, maskandscale=False
        ) as file:  # closed: what was mapped is given back
            raw = self._part(file.variables[self.name].data, start, stop)
        if not self.packed:
            return raw
        out = raw.astype(np.float64)
        empty = np.isin(out, self.fill)
        out = out * (1.0 if self.scale is None else self.scale) + (0.0 if self.offset is None else self.offset)
        out[empty] = np.nan
        return out

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
        return head[:3] == b"CDF" and head[3:4] in (b"\x01", b"\x02")

    def open(self, path: Path, inside: str | None, key: str) -> FrameReader:
        """Open a variable."""
        return _Variable(path, inside, key)


FORMAT = _Netcdf3()
