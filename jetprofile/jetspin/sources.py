"""The files of a run: which hold the beads, and what stands beside them."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spinline.base.errors import InputError
from spinline.jetprofile.jetspin.content import Content
from spinline.jetprofile.jetspin.detect import frame_files
from spinline.jetprofile.jetspin.frames import Floats, order_frames
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters
from spinline.jetprofile.jetspin.scale import check_scale, length_scale
from spinline.jetprofile.jetspin.stats import read_table
from spinline.jetprofile.jetspin.xyz import XyzSource

__all__ = ["Track", "choose_files", "open_xyz", "statistics_track"]

_SAMPLES = 16  # frames
_FEW = 8192  # rows


@dataclass(frozen=True)
class Track:
    """The first bead in ``statout.dat``: times (s) and x (m); `refined` if it counts refinements."""

    time: Floats
    x: Floats
    refined: bool


def choose_files(folder: Path, source: str | None, *, refined: bool = False) -> list[list[Path]]:
    """Files to read, the best ones first; of a refined run those with volumes go before those without."""
    if source is None:
        order = ("traj.dat", "save.dat", "frame*.xyz", "traj.xyz")
        if not refined:
            order = ("traj.dat", "frame*.xyz", "traj.xyz", "save.dat")
        found = (frame_files(folder) if name == "frame*.xyz" else [folder / name] for name in order)
        return [files for files in found if files and os.path.isfile(files[0])]
    if source in ("frame*.xyz", "frame.xyz", "frames"):
        frames = frame_files(folder)
        if not frames:
            raise InputError("source", f"no frame*.xyz in {folder}", value=source, remedy=_there(folder))
        return [frames]
    path = folder / source
    if not path.is_file():
        raise InputError("source", f"not in {folder}", value=source, remedy=_there(folder))
    return [[path]]


def _there(folder: Path) -> str:
    names = [files[0].name if len(files) == 1 else "frame*.xyz" for files in choose_files(folder, None)]
    return f"there is {', '.join(names)}" if names else "there is no file with beads"


def statistics_track(folder: Path) -> Track | None:
    """Position of the first bead in time from ``statout.dat``, where it was printed."""
    path = folder / "statout.dat"
    if not os.path.isfile(path) or path.stat().st_size == 0:
        return None
    try:
        table = read_table(path, Notes(path.name), ("time", "x", "refinements"))
    except InputError:
        return None
    if "time" not in table:  # printed without units, or not at all: there is nothing to place a bead by
        return None
    time = np.asarray(table["time"].values, dtype=np.float64)
    refined = bool((table["refinements"] > 0).any()) if "refinements" in table else False
    x = np.asarray(table["x"].values, dtype=np.float64) if "x" in table else np.full(len(time), np.nan)
    return Track(time, x, refined)


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
    kept = order_frames(source.time, Notes(""))
    sample = np.arange(len(kept))
    if len(kept) > 2 * _SAMPLES:
        sample = np.unique(np.linspace(0, len(kept) - 1, _SAMPLES).astype(np.int64))
    if source.weight[kept].sum() > _FEW:  # of few rows all: they are read once for this and for good
        kept, sample = kept[sample], np.arange(len(sample))
    block = source.look(kept)
    time, x = block.time[sample], block.values["x"][block.first[sample]]
    name = files[0].name.lower()
    padded = bool((source.weight[kept] > block.length)[sample].any())
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
