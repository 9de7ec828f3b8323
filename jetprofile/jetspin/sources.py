"""The files of a run: which hold the beads, and what stands beside them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.content import Content
from spinline.jetprofile.jetspin.folder import Folder
from spinline.jetprofile.jetspin.frames import Floats
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters
from spinline.jetprofile.jetspin.scale import check_scale, length_scale
from spinline.jetprofile.jetspin.stats import read_columns
from spinline.jetprofile.jetspin.xyz import XyzSource

__all__ = ["Track", "choose_files", "open_xyz", "statistics_track"]

_SAMPLES = 16  # frames
_FEW = 8192  # rows
_TRACK = ("time", "x", "refinements")


@dataclass(frozen=True)
class Track:
    """The first bead in ``statout.dat``: times (s) and x (m); `refined` if it counts refinements."""

    time: Floats
    x: Floats
    refined: bool


def choose_files(folder: Folder, source: str | None, *, refined: bool = False) -> list[list[str]]:
    """Names of files to read, the best ones first; of a refined run those with volumes go before those without."""
    if source is None:
        order = ("traj.dat", "save.dat", "frame*.xyz", "traj.xyz")
        if not refined:
            order = ("traj.dat", "frame*.xyz", "traj.xyz", "save.dat")
        found = (folder.frames() if name == "frame*.xyz" else [name] for name in order)
        return [names for names in found if names and folder.has(names[0])]
    if source in ("frame*.xyz", "frame.xyz", "frames"):
        frames = folder.frames()
        if not frames:
            raise InputError("source", f"no frame*.xyz in {folder.path}", value=source, remedy=_there(folder))
        return [frames]
    if not (folder.path / source).is_file():
        raise InputError("source", f"not in {folder.path}", value=source, remedy=_there(folder))
    return [[source]]


def _there(folder: Folder) -> str:
    names = [names[0] if len(names) == 1 else "frame*.xyz" for names in choose_files(folder, None)]
    return f"there is {', '.join(names)}" if names else "there is no file with beads"


def statistics_track(folder: Folder) -> Track | None:
    """Position of the first bead in time from ``statout.dat``, where it was printed."""
    path = folder.file("statout.dat")
    if path is None:
        return None
    try:
        columns = {column[0]: values for column, values in read_columns(path, Notes(path.name), _TRACK)}
    except InputError:
        return None
    time = columns.get("time")
    if time is None:  # printed without units, or not at all: there is nothing to place a bead by
        return None
    refined = bool((columns["refinements"] > 0).any()) if "refinements" in columns else False
    return Track(time, columns["x"] if "x" in columns else np.full(len(time), np.nan), refined)


def open_xyz(
    files: list[Path],
    content: Content,
    parameters: RunParameters | None,
    track: Track | None,
    unit: str | float | None,
    notes: Notes,
) -> tuple[XyzSource, str]:
    """Source of XYZ frames with its length unit set, and where that unit came from; `content` is that of the first file."""
    source = XyzSource(files, content, notes)
    if len(source.time) == 0:
        raise InputError(
            str(files[0]),
            "holds no whole frame (JETSPIN leaves traj.xyz empty if its interval is longer than the run, or "
            "after the directive `print xyz rescale`)",
            remedy="read another file of the run",
        )
    kept = source.order(Notes(""))
    sample = np.arange(len(kept))
    if len(kept) > 2 * _SAMPLES:
        sample = np.linspace(0, len(kept) - 1, _SAMPLES).astype(np.int64)
    weight = source.weight[kept]
    if weight.sum() > _FEW:  # of few rows all: they are read once for this and for good
        kept, weight, sample = kept[sample], weight[sample], np.arange(len(sample))
    block = source.look(kept)
    time, x = block.time[sample], block.values["x"][block.first[sample]]
    name = files[0].name.lower()
    padded = bool((weight > block.length)[sample].any())
    kind: str | None = None
    if padded or len(source.time) > len(files):
        kind = "traj"
    else:
        kind = next((begin for begin in ("frame", "traj") if name.startswith(begin)), None)
    pair = None if track is None else (track.time, track.x)
    scale = length_scale(files[0].name, kind, parameters, unit, pair, (time, x))
    told = scale.source
    if "column x" not in told:
        told += check_scale(scale.metres, pair, (time, x), notes)
    _check_collector(float(np.fmax.reduce(x, initial=0.0)) * scale.metres, parameters, notes)
    source.scale = scale.metres
    return source, told


def _check_collector(farthest: float, parameters: RunParameters | None, notes: Notes) -> None:
    if parameters is None or parameters.collector_distance is None or parameters.removing is False:
        return
    if farthest > 1.02 * parameters.collector_distance:
        notes.add(
            f"beads reach x = {farthest:.4g} m, beyond the collector at {parameters.collector_distance:.4g} "
            "m: the length unit is in doubt"
        )
