"""Reading a file or a whole run."""

import os
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.errors import InputError
from spinline.base.named_arrays import NamedArrays
from spinline.jetprofile.jetspin.content import content_of
from spinline.jetprofile.jetspin.detect import kind_of
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.reading import Reading, Time, Unit, open_reading
from spinline.jetprofile.jetspin.stats import read_landed, read_setup, read_table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["iter_jetspin", "read_jetspin"]


def iter_jetspin(
    path: str | PathLike[str],
    *,
    source: str | None = None,
    time: Time = None,
    unit: Unit = None,
    chunk_frames: int | None = None,
) -> Iterator["xr.Dataset"]:
    """Read the beads of a JETSPIN run in pieces of bounded size.

    Parameters
    ----------
    path, source, time, unit
        As in `read_jetspin`.
    chunk_frames : int, optional
        Frames of a piece; by default as many as make about 200,000 beads.

    Yields
    ------
    Dataset
        As from `read_jetspin`, padded to the longest chain of the piece. Warnings are given when first met.
    """
    if chunk_frames is not None and chunk_frames < 1:
        raise InputError("chunk_frames", "must be positive", value=chunk_frames, allowed=">= 1")
    reading = open_reading(path, source=source, time=time, unit=unit)
    return _generate(reading, chunk_frames)


def _generate(reading: Reading, chunk_frames: int | None) -> Iterator["xr.Dataset"]:
    reading.notes.emit()
    for frames in reading.pieces(chunk_frames):
        data = reading.arrays(frames).dataset()
        reading.notes.emit()
        yield data


def read_jetspin(
    path: str | PathLike[str], *, source: str | None = None, time: Time = None, unit: Unit = None
) -> "xr.Dataset":
    """Read a JETSPIN run, or one file of it, in SI.

    Parameters
    ----------
    path : path
        A file, or the directory of a run, of which the best source is taken: traj.dat, frame*.xyz, traj.xyz,
        save.dat, in this order. Tables (statout.dat, statdat.dat, bead.dat, log.txt, input.dat) only alone.
    source : str, optional
        Which of them to take instead, e.g. "traj.xyz" or "save.dat".
    time : None, "last", float or slice, optional
        All frames, the last whole one, the one nearest to a time (s), or those between two times.
    unit : "cm", "internal" or float, optional
        Length unit (the float in metres) of an XYZ file that has neither log.txt nor input.dat beside it.

    Returns
    -------
    Dataset
        Dimensions `time`, `bead` (0 at the nozzle) and `element` (i joins bead i and i + 1), NaN at the far
        end of shorter chains. Attributes say which files were read, where the length unit came from, what was
        left out and what was warned about. Files without beads give the tables they hold.

    Raises
    ------
    InputError
        If the file is none of JETSPIN 1.21, holds no whole frame, or its length unit cannot be known.

    Notes
    -----
    The radius is sqrt(V/(pi l)) with the volumes of the file, or with pi r0^2 l_step for every element where
    the file has none and the run was not refined. Values of elements that are not valid (`valid_element`:
    laid down, damaged, beside a damaged bead) are kept where they exist. Numbers wrong by less than a kink
    in the jet cannot be told from right ones.
    """
    content = None
    if os.path.isfile(path):
        given = Path(path)
        content = content_of(given)
        kind = kind_of(given, content)
        if kind not in ("xyz", "beads") and (time is not None or unit is not None or source is not None):
            raise InputError("path", f"{given.name} holds no beads: no source, time or unit applies", value=str(path))
        reader = {
            "statout": read_table,
            "statdat": read_table,
            "landed": read_landed,
            "setup": read_setup,
        }.get(kind)
        if reader is not None:
            notes = Notes(str(path))
            table = reader(given, notes)
            notes.emit()
            return table.dataset()
    reading = open_reading(path, source=source, time=time, unit=unit, content=content)
    data = _join([reading.arrays(frames) for frames in reading.pieces(None)])
    reading.sign(data)
    reading.notes.emit()
    return data


def _join(pieces: list[NamedArrays]) -> "xr.Dataset":
    """One dataset of many, padded to the longest chain."""
    if len(pieces) == 1:
        return pieces[0].dataset()
    width = {dim: max(piece.sizes[dim] for piece in pieces) for dim in ("bead", "element")}
    first = pieces[0]
    total = sum(piece.sizes["time"] for piece in pieces)
    variables = {}
    for name, variable in first.variables.items():
        shape = (total, *(width[str(dim)] for dim in variable.dims[1:]))
        filled = np.full(shape, np.nan) if variable.dtype.kind == "f" else np.zeros(shape, variable.dtype)
        at = 0
        for piece in pieces:
            part = piece.variables[name].values
            where = (slice(at, at + len(part)), *(slice(0, n) for n in part.shape[1:]))
            filled[where] = part
            at += len(part)
        variables[name] = (variable.dims, filled, variable.attrs)
    time = variables.pop("time")
    return NamedArrays(variables, {"time": time}, first.attrs).dataset()
