"""Laid fibres in a file: rows streamed in, chunks streamed out, never all in memory.

An HDF5 file that xarray opens (engine ``h5netcdf``), sealed, every column with a
checksum; dimension `segment`, one row per segment (`Segments`). Positions and
touch-down times are double precision (a mat may be metres long), the rest single: 60 bytes a row, read 262144 rows at a
time. What single precision would blur is kept in the attributes in double: number, length, volume and polymer volume of
all rows.
"""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from spinline.base.checks import number
from spinline.base.errors import InputError
from spinline.base.file_format import FORMAT, FORMAT_NAME, require_format
from spinline.base.files import readable, streaming
from spinline.base.netcdf import examine_hdf5
from spinline.base.netcdf_file import NetcdfFile
from spinline.base.seals import verified
from spinline.base.words import clean
from spinline.deposit.segments import Segments, sound

__all__ = ["CHUNK", "FibreFile", "FibreWriter"]

CHUNK = 262144
_STORED = 16384  # rows that lie together in the file
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
_ROW = tuple(name for name in _COLUMNS if name != "excess")
_SUMS = ("total_length", "total_volume", "total_dry_volume")


class FibreWriter:
    """Writes segments as they come; a context manager.

    Parameters
    ----------
    path : path
        HDF5 file, written anew.
    attributes : mapping, optional
        Where the fibres come from; kept in the file (numbers and text).
    force : bool
        Replace a file that is there.

    Raises
    ------
    InputError
        If it cannot be written; then nothing takes the name, and what was there stays.

    Examples
    --------
    ``with FibreWriter("fibres.h5") as file: file.write(segments)``
    """

    def __init__(self, path: str | Path, attributes: Mapping[str, Any] | None = None, *, force: bool = True) -> None:
        self.rows = 0
        self._path = path
        self._sums = dict.fromkeys(_SUMS, 0.0)
        with ExitStack() as opened:  # left again if anything fails before the file is whole
            self._sink = opened.enter_context(streaming(path, force=force, sealing=True))
            self._file = opened.enter_context(NetcdfFile(self._sink, {"segment": 0}, ["segment"]))
            for name, (kind, unit, text) in _COLUMNS.items():
                self._file.variable(name, ("segment",), kind, {"units": unit, "long_name": text}, chunks=(_STORED,))
            self._file.attributes({} if attributes is None else attributes)
            self._opened = opened.pop_all()

    def write(self, segments: Segments) -> None:
        """Append rows.

        Raises
        ------
        InputError
            For rows that are no fibre, or that single precision does not hold.
        """
        if not len(segments):
            return
        with np.errstate(over="ignore", under="ignore"):
            stored = {name: getattr(segments, name).astype(kind) for name, (kind, _, _) in _COLUMNS.items()}
        sound(Segments(**{name: stored[name] for name in _ROW}), str(self._path), self.rows)
        start, self.rows = self.rows, self.rows + len(segments)
        self._file.resize(segment=self.rows)
        for name, values in stored.items():
            self._file.write(name, values, start)
        self._sink.check()
        self._sums["total_length"] += float(np.sum(segments.length))
        self._sums["total_volume"] += float(np.sum(segments.volume))
        self._sums["total_dry_volume"] += float(np.sum(segments.dry_volume))

    def total(self, name: str) -> float:
        """One of the sums so far: total_length (m), total_volume, total_dry_volume (m3)."""
        return self._sums[name]

    def close(self) -> None:
        """Write the sums; then the file takes its name."""
        with self._opened:
            self._file.attributes({**self._sums, FORMAT_NAME: FORMAT})

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        else:
            self._opened.__exit__(kind, error, trace)


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

        if not Path(path).exists():
            raise InputError(str(path), "does not exist", remedy="write one with `spinline deposit`")
        file = readable(path, remedy="write one with `spinline deposit`")
        verified(file)
        try:
            self._file = h5py.File(file, "r")
        except OSError:
            raise InputError(str(path), "is not a file of fibres", remedy="write one with `spinline deposit`") from None
        try:
            self._examine(str(path))
        except BaseException:
            self._file.close()
            raise
        self.attributes = {
            key: clean(value)
            if isinstance(value, str)
            else value.item()
            if isinstance(value, np.generic | np.ndarray) and value.size == 1
            else value
            for key, value in self._file.attrs.items()
            if not key.startswith("_NC")
        }

    @property
    def rows(self) -> int:
        """Segments in it."""
        return int(self._file["x"].shape[0])

    def _examine(self, path: str) -> None:
        examine_hdf5(self._file, path)
        require_format(path, self._file.attrs.get(FORMAT_NAME))
        lost = [name for name in _ROW if name not in self._file]
        if lost:
            raise InputError(
                path,
                f"is not a file of fibres: it has no {', '.join(lost)}",
                remedy="write one with `spinline deposit`",
            )
        for name in _COLUMNS:
            column = self._file.get(name)
            if column is not None and (column.ndim != 1 or column.dtype.kind not in "fiu" or len(column) != self.rows):
                raise InputError(
                    path,
                    f"is not a file of fibres: {name} is no column of numbers, one a segment",
                    remedy="write one with `spinline deposit`",
                )

    def chunks(self, rows: int = CHUNK) -> Iterator[Segments]:
        """All rows in order, at most `rows` at a time."""
        for start in range(0, self.rows, rows):
            yield self.read(start, min(start + rows, self.rows))

    def read(self, start: int = 0, stop: int | None = None) -> Segments:
        """Rows from `start` up to `stop` (default: all)."""
        part = slice(start, self.rows if stop is None else stop)

        def get(name: str) -> Any:
            kind = np.int32 if _COLUMNS[name][0] == "i4" else np.float64
            try:
                return self._file[name][part].astype(kind)
            except OSError:
                raise InputError(
                    self._file.filename, f"is damaged: {name} cannot be read", remedy="make it again, or take a copy"
                ) from None

        return sound(Segments(**{name: get(name) for name in _ROW}), self._file.filename, start)

    @property
    def circumference(self) -> float:
        """Of the drum that the fibres lie on, m; 0 where it was none.

        Raises
        ------
        InputError
            If the file says something that is no length.
        """
        told = self.attributes.get("circumference", 0.0)
        return number(f"{self._file.filename}: circumference", told, least=0.0, unit="m", remedy="lay the fibres again")

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
