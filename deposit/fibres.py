"""Laid fibres in a file: rows streamed in, chunks streamed out, never all in memory.

An HDF5 file that xarray opens (engine ``h5netcdf``), dimension `segment`, one row per segment (`Segments`). Positions and
touch-down times are double precision (a mat may be metres long), the rest single: 60 bytes a row, 262144 rows a chunk. What
single precision would blur is kept in the attributes in double: number, length, volume and polymer volume of all rows.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from spinline.base.errors import InputError
from spinline.base.file_format import FORMAT, FORMAT_NAME, require_format
from spinline.deposit.segments import Segments

__all__ = ["CHUNK", "FibreFile", "FibreWriter"]

CHUNK = 262144
_COLUMNS: Mapping[str, tuple[str, str, str]] = {
    "x": ("f8", "m", "start of the segment, along the machine"),
    "y": ("f8", "m", "start of the segment, across the machine"),
    "dx": ("f4", "m", "end less start, along the machine"),
    "dy": ("f4", "m", "end less start, across the machine"),
    "touch_time": ("f8", "s", "touch-down of the segment's end"),
    "radius": ("f4", "m", "radius in flight at touch-down"),
    "polymer_fraction": ("f4", "1", "volume fraction of polymer at touch-down"),
    "length": ("f4", "m", "length in flight at touch-down"),
    "excess": ("f4", "1", "flight length over laid chord"),
    "jet": ("i4", "1", "number of the jet"),
    "fibre": ("i4", "1", "number of the fibre; rows of one fibre follow one another"),
}
_SUMS = ("total_length", "total_volume", "total_dry_volume")


class FibreWriter:
    """Writes segments as they come; a context manager.

    Parameters
    ----------
    path : path
        HDF5 file, written anew.
    attributes : mapping, optional
        Where the fibres come from; kept in the file (numbers and text).

    Examples
    --------
    ``with FibreWriter("fibres.h5") as file: file.write(segments)``
    """

    def __init__(self, path: str | Path, attributes: Mapping[str, Any] | None = None) -> None:
        import h5netcdf  # type: ignore[import-untyped]

        self.rows = 0
        self._sums = dict.fromkeys(_SUMS, 0.0)
        self._file = h5netcdf.File(str(path), "w")
        self._file.dimensions["segment"] = None
        for name, (kind, unit, text) in _COLUMNS.items():
            variable = self._file.create_variable(name, ("segment",), dtype=kind, chunks=(CHUNK,))
            variable.attrs["units"], variable.attrs["long_name"] = unit, text
        for key, value in (attributes or {}).items():
            self._file.attrs[key] = value

    def write(self, segments: Segments) -> None:
        """Append rows."""
        if not len(segments):
            return
        start, self.rows = self.rows, self.rows + len(segments)
        self._file.resize_dimension("segment", self.rows)
        for name, (kind, _, _) in _COLUMNS.items():
            with np.errstate(over="ignore", under="ignore"):
                self._file.variables[name][start : self.rows] = getattr(segments, name).astype(kind)
        self._sums["total_length"] += float(np.sum(segments.length))
        self._sums["total_volume"] += float(np.sum(segments.volume))
        self._sums["total_dry_volume"] += float(np.sum(segments.dry_volume))

    def total(self, name: str) -> float:
        """One of the sums so far: total_length (m), total_volume, total_dry_volume (m3)."""
        return self._sums[name]

    def close(self) -> None:
        """Write the sums and close."""
        for key, value in self._sums.items():
            self._file.attrs[key] = value
        self._file.attrs[FORMAT_NAME] = FORMAT
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class FibreFile:
    """Reads a file of fibres chunk by chunk; a context manager.

    Attributes
    ----------
    rows : int
    attributes : dict
        Of the file, sums in double precision among them.
    """

    def __init__(self, path: str | Path) -> None:
        import h5py

        try:
            self._file = h5py.File(path, "r")
        except OSError:
            missing = not Path(path).exists()
            raise InputError(
                str(path),
                "does not exist" if missing else "is not a file of fibres",
                remedy="write one with `spinline deposit`",
            ) from None
        lost = [name for name in _COLUMNS if name not in self._file and name != "excess"]
        if lost:
            self._file.close()
            raise InputError(
                str(path),
                f"is not a file of fibres: it has no {', '.join(lost)}",
                remedy="write one with `spinline deposit`",
            )
        try:
            require_format(str(path), self._file.attrs.get(FORMAT_NAME))
        except InputError:
            self._file.close()
            raise
        self.rows = int(self._file["x"].shape[0])
        self.attributes = {
            key: value.item() if isinstance(value, np.generic) else value
            for key, value in self._file.attrs.items()
            if not key.startswith("_NC")
        }

    def chunks(self, rows: int = CHUNK) -> Iterator[Segments]:
        """All rows in order, at most `rows` at a time."""
        for start in range(0, self.rows, rows):
            yield self.read(start, min(start + rows, self.rows))

    def read(self, start: int = 0, stop: int | None = None) -> Segments:
        """Rows from `start` up to `stop` (default: all)."""
        part = slice(start, self.rows if stop is None else stop)

        def get(name: str) -> Any:
            kind = np.int32 if _COLUMNS[name][0] == "i4" else np.float64
            return self._file[name][part].astype(kind)

        names = ("x", "y", "dx", "dy", "touch_time", "radius", "polymer_fraction", "length", "jet", "fibre")
        return Segments(*(get(name) for name in names))

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
