"""The methods of reduction, each from one frame of photons to fractions: the place where a new one is added.

A method takes an experiment, a frame, the track of the jet (None: to be found), a function to call with the number of blocks
done, and what is done already, and returns a `FrameFit`. Its name is a value of the key `method`, its meaning goes into the
result.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.images.experiment import Experiment, fit_blocks, nuisances
from spinline.xray.frame.blocks import Frame, FrameFit, blocks_of, require_track
from spinline.xray.frame.quick import chord_frame
from spinline.xray.frame.track import Track
from spinline.xray.map.fit import fit_map
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
    """

    begun: FrameFit | None
    keep: Callable[[FrameFit], None]


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
    return chord_frame(frame, experiment.absorber, shells=images.shells, block_rows=images.block_rows, track=same)


def _map(experiment: Experiment, frame: Frame, track: Track | None, _: Done, __: Kept | None) -> FrameFit:
    images = experiment.images
    path = require_track(frame) if track is None else track
    rows = blocks_of(frame.counts.shape[0], images.block_rows)
    blocks = [_block(frame, start, stop) for start, stop in rows.tolist()]
    middle = [slice(start, stop) for start, stop in rows.tolist()]
    found = fit_map(
        np.array([counts for counts, _, _ in blocks]), experiment.absorber, [detector for _, detector, _ in blocks],
        z=frame.pixel * rows.mean(axis=1), nuisances=nuisances(images), shells=images.shells,
        radius=frame.pixel * np.array([path.radius[part].mean() for part in middle]),
        axis=frame.pixel * np.array([path.axis[part].mean() for part in middle]),
        good=np.array([good for _, _, good in blocks]),
    )  # fmt: skip
    covariance = np.array([found.fraction_covariance(i) for i in range(rows.shape[0])])
    fit = FrameFit(
        "map", found.edges, rows, found.fraction, covariance, found.mean_fraction, found.mean_fraction_std, found.limit_std,
        {name: np.asarray(found.values[name]) for name in NUISANCES}, {name: np.asarray(found.std[name]) for name in NUISANCES},
        np.full(rows.shape[0], found.misfit), np.zeros(rows.shape[0], dtype=np.int64),
    )  # fmt: skip
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
    return fit


def _block(frame: Frame, start: int, stop: int) -> tuple[FloatArray, Detector, BoolArray]:
    """A block, or one without a good pixel."""
    if frame.good[start:stop].any():
        return frame.block(start, stop)
    n = frame.counts.shape[1]
    return np.zeros(n), Detector(np.ones(n), frame.pixel, blur=frame.blur), np.zeros(n, dtype=np.bool_)


def _row(experiment: Experiment, frame: Frame, track: Track | None, done: Done, kept: Kept | None) -> FrameFit:
    images = experiment.images
    fit = fit_blocks(
        experiment, frame, track, shells=images.shells, block_rows=images.block_rows, done=done,
        begun=None if kept is None else kept.begun, keep=None if kept is None else kept.keep,
    )  # fmt: skip
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
