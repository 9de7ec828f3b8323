"""An opened run: which file is read, in which unit, and in pieces of bounded size."""

import math
import os
from collections.abc import Iterator
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from spinline.base.errors import InputError
from spinline.base.named_arrays import NamedArrays
from spinline.jetprofile.jetspin.binary import BinarySource
from spinline.jetprofile.jetspin.checks import peak_kink
from spinline.jetprofile.jetspin.content import Content, content_of
from spinline.jetprofile.jetspin.dataset import Meaning, build_dataset
from spinline.jetprofile.jetspin.detect import kind_of
from spinline.jetprofile.jetspin.folder import Folder
from spinline.jetprofile.jetspin.frames import FrameSource, Integers, order_frames, select_frames
from spinline.jetprofile.jetspin.header import find_parameters
from spinline.jetprofile.jetspin.notes import Notes
from spinline.jetprofile.jetspin.parameters import RunParameters, merge_parameters
from spinline.jetprofile.jetspin.sources import Track, choose_files, open_xyz, statistics_track
from spinline.jetprofile.jetspin.xyz import XyzSource

__all__ = ["Reading", "Time", "Unit", "open_reading"]

_ROWS = 200_000  # beads of a piece, padding included: some 40 MB of variables
Time = float | str | slice | None
Unit = str | float | None


class Reading:
    """An opened source of frames: what is read, and what has been noticed so far."""

    def __init__(self, source: FrameSource, kept: Integers, chosen: Integers, meaning: Meaning, notes: Notes) -> None:
        self.source, self.meaning, self.notes = source, meaning, notes
        self._kept, self.frames = kept, kept[chosen]

    def _around(self, frames: Integers) -> tuple[float, float]:
        """Sharpest kink of the frame before these and of the one after, NaN where there is none."""
        peaks = [np.nan, np.nan]
        if len(frames) == len(self._kept):
            return peaks[0], peaks[1]
        at = [int(np.flatnonzero(self._kept == number)[0]) for number in (frames[0], frames[-1])]
        for side, beside in enumerate((at[0] - 1, at[1] + 1)):
            if 0 <= beside < len(self._kept):
                peaks[side] = peak_kink(self.source.load(self._kept[beside : beside + 1], Notes("")))
        return peaks[0], peaks[1]

    def pieces(self, chunk_frames: int | None) -> Iterator[Integers]:
        """Numbers of the frames of every piece."""
        if chunk_frames is not None:
            for begin in range(0, len(self.frames), chunk_frames):
                yield self.frames[begin : begin + chunk_frames]
            return
        begin, widest = 0, 0
        weight = self.source.weight[self.frames]
        if int(weight.max(initial=0)) * len(weight) <= _ROWS:
            yield self.frames
            return
        for position, rows in enumerate(weight.tolist()):
            if begin < position and max(widest, rows) * (position + 1 - begin) > _ROWS:
                yield self.frames[begin:position]
                begin, widest = position, 0
            widest = max(widest, rows)
        yield self.frames[begin:]

    def arrays(self, frames: Integers) -> NamedArrays:
        """Variables of some frames, with the warnings met so far in its attributes."""
        block = self.source.load(frames, self.notes)
        missing = len(frames) - np.count_nonzero(block.reaches_nozzle)
        self.notes.add(
            "{n} frames end before the nozzle (chain longer than maxnumber); their beads are numbered from "
            "the nearest one stored and have no arc length",
            missing,
        )
        data = build_dataset(block, self.meaning, self._around(frames), self.notes)
        self.sign(data)
        return data

    def sign(self, data: Any) -> None:
        """Write what was dropped and warned about into the attributes (of `NamedArrays`, or of a Dataset)."""
        data.attrs["dropped"] = self.notes.dropped
        data.attrs["warnings"] = self.notes.warnings


def open_reading(
    path: str | PathLike[str],
    *,
    source: str | None = None,
    time: Time = None,
    unit: Unit = None,
    content: Content | None = None,
) -> Reading:
    """Find the frames of a file or run and what is needed to understand them; `content` is the file's, if that was read."""
    path = Path(path)
    notes = Notes(str(path))
    if content is not None or not os.path.isdir(path):
        if content is None and not os.path.exists(path):
            raise InputError(str(path), "does not exist", remedy="give a file or directory of a JETSPIN run")
        if source is not None:
            raise InputError("source", "only for a directory", value=source, remedy="give the file itself as path")
        beside = _beside(Folder(path.parent, listed=False), notes)
        return _open([path], path, time, unit, notes, beside, content)
    folder = Folder(path, listed=True)
    beside = _beside(folder, notes)
    choices = choose_files(folder, source, refined=_refined(*beside))
    if source is None and choices and choices[0] == ["save.dat"] and len(choices) > 1:
        notes.add(
            "the run used dynamic refinement, so save.dat is read: it holds the volumes, of its last moment only "
            f"({choices[1][0]} has more times, but no radius: source asks for it)"
        )
    for number, names in enumerate(choices):
        try:
            return _open([path / name for name in names], path, time, unit, notes, beside)
        except InputError as error:
            if number + 1 == len(choices) or error.field in ("time", "unit"):
                raise
            notes.add(f"{names[0]} is not usable and another file is read ({error})")
    raise InputError(
        str(path),
        "no traj.dat, frame*.xyz, traj.xyz or save.dat in it",
        remedy="give the directory JETSPIN ran in, or a file",
    )


Beside = tuple[RunParameters | None, Track | None]


def _beside(folder: Folder, notes: Notes) -> Beside:
    """What stands beside the frames: the parameters of the run, and the way of its first bead."""
    return find_parameters(folder, notes), statistics_track(folder)


def _refined(parameters: RunParameters | None, track: Track | None) -> bool:
    """Whether the run says it used dynamic refinement."""
    return bool(parameters and parameters.refinement) or bool(track and track.refined)


def _open(
    files: list[Path],
    given: Path,
    time: Time,
    unit: Unit,
    notes: Notes,
    known: Beside,
    content: Content | None = None,
) -> Reading:
    beside, track = known
    if content is None:
        content = content_of(files[0])
    kind = kind_of(files[0], content)
    frames: BinarySource | XyzSource
    if kind == "beads":
        if unit is not None:
            raise InputError("unit", f"{files[0].name} says its own units", value=unit, remedy="leave it out")
        frames = BinarySource(files[0], content, notes)
        unit_source = f"parameter block of {files[0].name}"
        text = False
        error = 0.0
    elif kind == "xyz":
        frames, unit_source = open_xyz(files, content, beside, track, unit, notes)
        error, text = frames.position_error, True
    else:
        raise InputError(str(files[0]), "holds no beads", remedy="read_jetspin reads it, iter_jetspin does not")
    sets = [params for params in (frames.parameters, beside) if params is not None]
    parameters = merge_parameters(sets, notes) or RunParameters()
    if parameters.refinement is None and track is not None and track.refined:
        parameters = replace(parameters, refinement=True)
    kept = frames.order(notes) if isinstance(frames, XyzSource) else order_frames(frames.time, notes)
    if len(kept) == 0:
        raise InputError(str(files[0]), "holds no whole frame", remedy="read another file of the run")
    chosen = select_frames(frames.time[kept], time, files[0].name)
    volumes = "volume" in getattr(frames, "columns", ())
    _warn_radius(parameters, volumes, notes)
    attrs = _attrs(frames, given, parameters, unit_source, volumes)
    return Reading(frames, kept, chosen, Meaning(parameters, error, text, attrs), notes)


def _warn_radius(parameters: RunParameters, volumes: bool, notes: Notes) -> None:
    if parameters.element_volume is None:
        notes.add("nozzle radius and resolution are not known: no radius, no stretch ratio (put log.txt beside it)")
    elif volumes:
        return
    elif parameters.refinement:
        notes.add(
            "the run used dynamic refinement, so positions alone do not give radius and stretch ratio (NaN): "
            "read save.dat or a traj.dat of style 5 to 7"
        )
    elif parameters.refinement is None:
        notes.add("not known whether the run used dynamic refinement; elements of equal volume are assumed")
    if parameters.collector_distance is None:
        notes.add("the collector distance is not known: deposited beads are not recognised")


def _attrs(
    frames: BinarySource | XyzSource, given: Path, parameters: RunParameters, unit_source: str, volumes: bool
) -> dict[str, Any]:
    p = parameters
    refinement = {True: "yes", False: "no", None: "unknown"}[p.refinement]
    radius = "volumes in the file" if volumes else "equal volumes of elements, pi nozzle_radius^2 resolution"
    if p.element_volume is None or (p.refinement and not volumes):
        radius = "not known"
    numbers = {
        "nozzle_radius": p.nozzle_radius,
        "resolution": p.resolution,
        "collector_distance": p.collector_distance,
        "nozzle_velocity": p.nozzle_velocity,
        "density": p.density,
        "charge_density": p.charge_density,
        "viscosity": p.viscosity,
        "elastic_modulus": p.elastic_modulus,
        "surface_tension": p.surface_tension,
        "potential": p.potential,
        "air_velocity": p.air_velocity,
        "internal_length_unit": p.length_unit,
        "internal_time_unit": p.time_unit,
    }
    return {
        "title": f"JETSPIN jet from {given.name}",
        "source_files": frames.files,
        "parameter_source": p.source or "none",
        "jetspin_version": p.version or ("1.21 (by its format)" if frames.parameters is not None else "unknown"),
        "length_unit_source": unit_source,
        "radius_source": radius,
        "refinement": refinement,
        "dimension": p.dimension or 0,
        **{name: math.nan if value is None else float(value) for name, value in numbers.items()},
    }
