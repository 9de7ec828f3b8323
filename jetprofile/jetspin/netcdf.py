"""A JETSPIN run streamed into one netCDF file, in bounded memory."""

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

import h5netcdf  # type: ignore[import-untyped]
import numpy as np
import xarray as xr

from spinline.base.files import Sink, streaming
from spinline.base.netcdf import OLD_READERS, save_dataset
from spinline.jetprofile.jetspin.detect import file_kind
from spinline.jetprofile.jetspin.reading import Time, Unit, open_reading
from spinline.jetprofile.jetspin.run import read_jetspin

__all__ = ["write_jet"]

_CHUNK = (32, 256)


def write_jet(
    path_or_run: str | PathLike[str],
    out: str | PathLike[str],
    *,
    source: str | None = None,
    time: Time = None,
    unit: Unit = None,
    progress: Callable[[int, int], object] | None = None,
    force: bool = True,
) -> Path:
    """Read a JETSPIN run piece by piece and write it as netCDF.

    Parameters
    ----------
    path_or_run, source, time, unit
        As in `read_jetspin`.
    out : path
        File to write; what is there is replaced once the new file is whole.
    progress : callable, optional
        Called with the number of frames written and their total.
    force : bool
        False refuses a file that is there.

    Returns
    -------
    Path
        The file written. `xarray.open_dataset` gives what `read_jetspin` returns.

    Raises
    ------
    InputError
        As `read_jetspin`, and if `out` cannot be written.
    """
    out, given = Path(out), Path(path_or_run)
    if given.is_file() and file_kind(given) not in ("xyz", "beads"):
        table = read_jetspin(given, source=source, time=time, unit=unit)
        save_dataset(table, out, force=force)
        if progress is not None:
            progress(1, 1)
    else:
        with streaming(out, force=force, sealing=True) as sink:
            _stream(given, sink, source, time, unit, progress)
    return out


def _stream(
    given: Path,
    sink: Sink,
    source: str | None,
    time: Time,
    unit: Unit,
    progress: Callable[[int, int], object] | None,
) -> None:
    reading = open_reading(given, source=source, time=time, unit=unit)
    total, done = len(reading.frames), 0
    with h5netcdf.File(sink, "w", libver=OLD_READERS) as file:
        attrs: dict[str, Any] = {}
        for frames in reading.pieces(None):
            data = reading.dataset(frames)
            if done == 0:
                _define(file, data)
            _append(file, data, done)
            sink.check()
            done += len(frames)
            attrs = data.attrs
            if progress is not None:
                progress(done, total)
        for name, value in attrs.items():
            file.attrs[name] = value
    reading.notes.emit(stacklevel=3)


def _define(file: Any, data: xr.Dataset) -> None:
    """Dimensions that can grow, and variables along them (flags as bytes, which xarray reads as bool)."""
    file.dimensions = {"time": None, "bead": None, "element": None}
    for name, variable in data.variables.items():
        flag = variable.dtype.kind == "b"
        chunks = (1024,) if variable.ndim == 1 else _CHUNK
        dtype = np.dtype("i1") if flag else variable.dtype
        fill = np.nan if dtype.kind == "f" and name != "time" else None
        made = file.create_variable(str(name), variable.dims, dtype, chunks=chunks, fillvalue=fill, fletcher32=True)
        for key, value in variable.attrs.items():
            made.attrs[key] = value
        if flag:
            made.attrs["dtype"] = "bool"


def _append(file: Any, data: xr.Dataset, at: int) -> None:
    stop = at + data.sizes["time"]
    file.resize_dimension("time", stop)
    for dim in ("bead", "element"):
        if data.sizes[dim] > file.dimensions[dim].size:
            file.resize_dimension(dim, data.sizes[dim])
    for name, variable in data.variables.items():
        where = (slice(at, stop), *(slice(0, size) for size in variable.shape[1:]))
        values = variable.values
        file.variables[str(name)][where] = values.astype("i1") if values.dtype.kind == "b" else values
