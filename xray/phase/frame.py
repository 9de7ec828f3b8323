"""A frame with fringes, block by block, the jet's taper and lean within each block modelled.

The rows of a block are summed (`frame`); where radius or axis changes along it by a good part of a fringe, the sum is that of
as many sections (`phase_fit`). How much they change is known from the neighbours: first from the track, then from the fitted
radii and axes of the blocks before and after, to nanometres; blocks for which these differ by more than 0.005 pixels are
fitted again. What is left out is the bend of the jet's outline within a block, ``R'' h^2/12`` for a height h.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.xray.frame.blocks import Frame, FrameFit, blocks_of, fit_frame, require_track
from spinline.xray.frame.track import Track
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.fit import phase_law
from spinline.xray.phase.start import phase_start

__all__ = ["fit_frame_phase", "track_fringes"]

_GROUPS = 12
_TOLD_APART, _COARSE = 0.005, 0.1  # pixels over a block, where the fit is poor and where it is good
_POOR = 1.5  # misfit
_SURE = 3.0  # standard deviations


def fit_frame_phase(
    frame: Frame,
    medium: Medium,
    distance: float,
    *,
    shells: int | FloatArray = 3,
    profile: str = "smooth",
    block_rows: int = 1,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope", "distance", "refraction"),
    track: Track | None = None,
    done: Callable[[int], None] | None = None,
    begun: FrameFit | None = None,
    keep: Callable[[FrameFit], None] | None = None,
) -> FrameFit:
    """Estimate the polymer fraction in every block of rows of a frame with fringes.

    Parameters
    ----------
    frame, block_rows, track, done, begun, keep
        As in `fit_frame`; the track is found by the fringes where left out. What is kept is the first fit of every block: those
        that are fitted again are not kept.
    medium, distance, shells, profile, nuisances
        As in `fit_row_phase`.

    Returns
    -------
    FrameFit

    Raises
    ------
    InputError
        As `fit_frame` and `fit_row_phase`.

    Notes
    -----
    0.1 to 0.3 s a block, times the sections: five for a change of a pixel.
    """
    path = track_fringes(frame, medium, distance) if track is None else track
    law = phase_law(medium, distance, fitted=(), profile=profile)
    absorber = medium.absorber
    blocks = blocks_of(frame.counts.shape[0], block_rows)
    height = np.diff(blocks, axis=1)[:, 0]
    middle = blocks.mean(axis=1) - 0.5
    at = np.arange(path.radius.size, dtype=np.float64)
    slopes = [np.interp(middle, at, _gradient(_smoothed(v, height[0]), at)) for v in (path.radius, path.axis)]
    change = frame.pixel * np.stack(slopes, axis=1) * height[:, None]

    def fitted(by: FloatArray, again: tuple[FrameFit, BoolArray] | None = None) -> FrameFit:
        return fit_frame(
            frame,
            absorber,
            shells=shells,
            block_rows=block_rows,
            nuisances=nuisances,
            track=path,
            one=law,
            done=None if again else done,
            change=by,
            again=again,
            begun=None if again else begun,
            keep=None if again else keep,
        )

    fit = fitted(change)
    found, sure = _changes(fit, middle, height)
    apart = np.where(fit.misfit > _POOR, _TOLD_APART, _COARSE) * frame.pixel
    off: BoolArray = np.any(np.abs(found - change) > np.maximum(apart[:, None], _SURE * sure), axis=1)
    if off.any():
        fitted(np.where(off[:, None], found, change), (fit, off))
    return fit


def track_fringes(frame: Frame, medium: Medium, distance: float) -> Track:
    """Track of a jet by its fringes, from a dozen groups of rows; by its absorption where they do not place it.

    Raises
    ------
    InputError
        Where no jet is found.
    """
    rows = frame.counts.shape[0]
    bounds = np.linspace(0, rows, min(_GROUPS, rows) + 1).astype(int)
    places, radii, axes = [], [], []
    for start, stop in pairwise(bounds.tolist()):
        try:
            counts, detector, good = frame.block(start, stop)
            found = phase_start(counts, medium, detector, distance, good=good)
        except InputError:
            continue
        places.append(0.5 * (start + stop - 1))
        radii.append(found.radius / frame.pixel)
        axes.append(found.axis / frame.pixel)
    if not places:
        return require_track(frame)
    at = np.arange(rows)
    radius, axis = np.interp(at, places, radii), np.interp(at, places, axes)
    one = np.ones(rows)
    return Track(
        radius, axis, one, 0 * one, 0 * one, np.full((rows, 5, 5), np.nan), one, one, np.zeros(rows, dtype=np.bool_)
    )


def _changes(fit: FrameFit, middle: FloatArray, height: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Change of radius and axis over each block from those of its neighbours, with its error; NaN where these are not known."""
    found, sure = np.full((middle.size, 2), np.nan), np.full((middle.size, 2), np.nan)
    for column, name in enumerate(("radius", "axis")):
        known = np.flatnonzero(np.isfinite(fit.values[name]) & (fit.misfit < 100.0))
        if known.size < 2:
            continue
        at, values, std = middle[known], fit.values[name][known], fit.std[name][known]
        found[known, column] = _gradient(values, at) * height[known]
        before, after = np.maximum(np.arange(at.size) - 1, 0), np.minimum(np.arange(at.size) + 1, at.size - 1)
        sure[known, column] = np.hypot(std[before], std[after]) / (at[after] - at[before]) * height[known]
    return found, sure


def _gradient(values: FloatArray, at: FloatArray) -> FloatArray:
    return np.gradient(values, at, edge_order=2 if values.size > 2 else 1) if values.size > 1 else np.zeros(values.size)


def _smoothed(values: FloatArray, width: int) -> FloatArray:
    """Running straight line over 2 width + 1 rows: its middle; the ends keep their trend."""
    if values.size < 4 or width < 2:
        return values
    from scipy.signal import savgol_filter

    window = min(2 * int(width) + 1, values.size - (values.size + 1) % 2)
    return np.asarray(savgol_filter(values, window, 1)) if window > 2 else values
