"""A JETSPIN run streamed into one netCDF file, in bounded memory."""

from collections.abc import Callable
from contextlib import ExitStack
from os import PathLike
from pathlib import Path

import numpy as np

from spinline.base.file_format import FORMAT, FORMAT_NAME
from spinline.base.files import Sink, streaming
from spinline.base.named_arrays import NamedArrays
from spinline.base.netcdf import save_dataset
from spinline.base.netcdf_file import NetcdfFile
from spinline.jetprofile.jetspin.detect import file_kind
from spinline.jetprofile.jetspin.reading import Time, Unit, open_reading
from spinline.jetprofile.jetspin.run import read_jetspin
from spinline.jetprofile.jetspin.zipped import run_folder

__all__ = ["write_jet"]


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
        As in `read_jetspin`; a zipped run too.
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
    if given.is_file() and given.suffix.lower() == ".zip":
        with run_folder(given) as folder:
            return write_jet(folder, out, source=source, time=time, unit=unit, progress=progress, force=force)
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
    file: NetcdfFile | None = None
    with ExitStack() as opened:
        for frames in reading.pieces(None):
            data = reading.arrays(frames)
            if file is None:
                file = opened.enter_context(_defined(sink, data, total))
            file.resize(**{dim: size for dim, size in data.sizes.items() if dim != "time"})
            for name, variable in data.variables.items():
                values = variable.values
                file.write(name, values.astype("i1") if values.dtype.kind == "b" else values, done)
            sink.check()
            done += len(frames)
            if progress is not None:
                progress(done, total)
        if file is not None:
            reading.sign(data)
            file.attributes({**data.attrs, FORMAT_NAME: FORMAT})
    reading.notes.emit(stacklevel=3)


def _defined(sink: Sink, data: NamedArrays, total: int) -> NetcdfFile:
    """A file with the variables of `data` for all frames; beads and elements may become more."""
    file = NetcdfFile(sink, {**data.sizes, "time": total}, [dim for dim in data.sizes if dim != "time"])
    for name, variable in data.variables.items():
        flag = variable.dtype.kind == "b"
        more = {"dtype": "bool"} if flag else {}
        fill = np.nan if variable.dtype.kind == "f" and name != "time" else None
        file.variable(name, variable.dims, "i1" if flag else variable.dtype, {**variable.attrs, **more}, fill=fill)
    return file
