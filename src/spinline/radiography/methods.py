"""The methods of reduction, each from one frame of photons to fractions: the place where a new one is added.

A method takes an experiment, a frame, the track of the jet (None: to be found), a function to call with the number of blocks
done, and what is done already, and returns a `FrameFit`. Its name is a value of the key `method`, its meaning goes into the
result.
"""

from collections.abc import Callable
from dataclasses import fields, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.radiography.experiment import Experiment, fit_blocks
from spinline.radiography.looks import part_of
from spinline.xray.frame.blocks import Frame, FrameFit, blocks_of, fit_frame, require_track
from spinline.xray.frame.lean import Lean, axis_lean
from spinline.xray.frame.quick import chord_frame
from spinline.xray.frame.track import Track
from spinline.xray.map.fit import fit_map
from spinline.xray.map.result import MapFit, MapState
from spinline.xray.row.forward import Detector
from spinline.xray.row.model import NUISANCES

__all__ = ["METHODS", "Kept", "Method", "require_method"]

Done = Callable[[int], None] | None


class Kept(NamedTuple):
    """Work that may be interrupted.

    Attributes
    ----------
    begun : FrameFit or None
        What was done before.
    keep : callable
        Called with what is done so far.
    map_begun, map_keep : MapState or None, callable or None
        The same for a map, which is done as a whole.
    """

    begun: FrameFit | None
    keep: Callable[[FrameFit], None]
    map_begun: MapState | None = None
    map_keep: Callable[[MapState], None] | None = None


class Method(NamedTuple):
    """A way to reduce a frame.

    Attributes
    ----------
    reduce : callable
        ``reduce(experiment, frame, track, done, kept)``: a `FrameFit`.
    meaning : str
        In a sentence.
    """

    reduce: Callable[[Experiment, Frame, Track | None, Done, Kept | None], FrameFit]
    meaning: str


def _chord(experiment: Experiment, frame: Frame, track: Track | None, _: Done, __: Kept | None) -> FrameFit:
    images = experiment.images
    same = track if images.block_rows == 1 else None
    slope = axis_lean(require_track(frame) if track is None else track).slope
    return chord_frame(
        frame, experiment.absorber, shells=images.shells, block_rows=images.block_rows, track=same, lean=slope
    )


def _map(experiment: Experiment, frame: Frame, track: Track | None, _: Done, kept: Kept | None) -> FrameFit:
    path = require_track(frame) if track is None else track
    lean = axis_lean(path)
    rows = blocks_of(frame.counts.shape[0], 1)
    one = [_block(frame, i, i + 1) for i in range(rows.shape[0])]
    seen = replace(frame, flat=np.ones_like(frame.flat)).detector(np.ones(frame.counts.shape[1]), np.zeros(1))
    across = seen.across(float(lean.cosine.mean()))
    optics = {name: getattr(across, name) for name in ("blur", "tail_share", "tail_length", "scatter")}
    found = fit_map(
        np.array([counts for counts, _, _ in one]),
        experiment.absorber,
        [replace(detector, **optics) for _, detector, _ in one],
        z=frame.pixel * rows.mean(axis=1),
        nuisances=experiment.nuisances,
        shells=experiment.images.shells,
        radius=frame.pixel * path.radius,
        axis=frame.pixel * path.axis,
        good=np.array([good for _, _, good in one]),
        path=lean.cosine,
        begun=None if kept is None else kept.map_begun,
        keep=None if kept is None else kept.map_keep,
    )
    shifts = map_shifts(experiment, frame, path, lean, found.edges, found.z)
    return map_frame_fit(found, rows, lean.cosine, shifts)


def map_frame_fit(found: MapFit, rows: NDArray[np.int64], cosine: FloatArray, shifts: FloatArray) -> FrameFit:
    """A map as blocks of one row; no number where it did not converge."""
    covariance = np.array([found.fraction_covariance(i) for i in range(rows.shape[0])])
    values = {name: np.array(found.values[name]) for name in NUISANCES}
    std = {name: np.array(found.std[name]) for name in NUISANCES}
    for curves in (values, std):
        for name in ("radius", "blur"):
            curves[name] = curves[name] * cosine
    fit = FrameFit(
        "map",
        found.edges,
        rows,
        found.fraction,
        covariance,
        found.mean_fraction,
        found.mean_fraction_std,
        found.limit_std,
        values,
        std,
        np.full(rows.shape[0], found.misfit),
        np.zeros(rows.shape[0], dtype=np.int64),
        shifts=shifts,
        excess=np.full(rows.shape[0], found.excess),
    )
    for block in range(rows.shape[0]):
        if not found.converged:
            fit.flag(block, "not_converged")
        if found.misfit > 4:
            fit.flag(block, "misfit")
        if not found.used[block]:
            fit.flag(block, "not_fitted")
            fit.reasons[int(rows[block, 0])] = "no usable count: bridged by the rows around"
        if found.mean_fraction_std[block] > abs(found.mean_fraction[block]):
            fit.flag(block, "noisy")
    if not found.converged:
        for array in (fit.fraction, fit.covariance, fit.mean, fit.mean_std):
            array[:] = np.nan
    return fit


def map_shifts(
    experiment: Experiment, frame: Frame, track: Track, lean: Lean, edges: FloatArray, z: FloatArray
) -> FloatArray:
    """Derivatives of a map's fractions with what the detector shares, by fits of blocks here and there, and lines between."""
    names = experiment.detector.names
    out = np.zeros((z.size, edges.size - 1, len(names)))
    if not names:
        return out
    at, found = [], []
    count = min(12, z.size)
    for start in np.unique(np.linspace(0, z.size - 1, count).astype(int)).tolist():
        try:
            fit = fit_frame(
                part_of(frame, start, start + 1),
                experiment.absorber,
                shells=edges,
                nuisances=experiment.nuisances,
                track=Track(*(getattr(track, item.name)[start : start + 1] for item in fields(Track))),
                lean=lean.slope[start : start + 1],
                shared=names,
            )
        except InputError:
            continue
        at.append(z[start])
        found.append(fit.shifts[0])
    if at:
        table = np.array(found)
        for i in range(out.shape[1]):
            for j in range(out.shape[2]):
                out[:, i, j] = np.interp(z, at, table[:, i, j])
    return out


def _block(frame: Frame, start: int, stop: int) -> tuple[FloatArray, Detector, BoolArray]:
    """A block, or one without a good pixel."""
    if frame.good[start:stop].any():
        return frame.block(start, stop)
    n = frame.counts.shape[1]
    return np.zeros(n), frame.detector(np.ones(n), np.zeros(n)), np.zeros(n, dtype=np.bool_)


def _row(experiment: Experiment, frame: Frame, track: Track | None, done: Done, kept: Kept | None) -> FrameFit:
    images = experiment.images
    fit = fit_blocks(
        experiment,
        frame,
        track,
        shells=images.shells,
        block_rows=images.block_rows,
        done=done,
        begun=None if kept is None else kept.begun,
        keep=None if kept is None else kept.keep,
    )
    return replace(fit, method=images.method)


METHODS = {
    "chord": Method(
        _chord,
        "Eqs. (41)-(42) on every chord: the published quick look; shells hold means along chords, not local values",
    ),
    "row": Method(_row, "joint Poisson likelihood of shells, radius, axis, level and slope of every block of rows"),
    "map": Method(_map, "penalised Poisson likelihood of a fraction that is smooth in r and z, all rows at once"),
    "phase": Method(
        _row,
        "as row, of the wave with its fringes and a continuous profile; distance, refraction and taper are fitted",
    ),
}


def require_method(name: str) -> Method:
    """Method of a name; refused where it is not there."""
    if name not in METHODS:
        known = ", ".join(f'"{method}"' for method in METHODS)
        raise InputError("method", "is not available yet", value=name, allowed=known, remedy='take method = "row"')
    return METHODS[name]
