"""A frame with fringes, block by block, the jet's taper and lean within each block modelled.

The rows of a block are summed (`frame`); where radius or axis changes along it by a good part of a fringe, the sum is that of as
many sections (`phase_fit`). How much they change is known from the neighbours: first from the track, then from the fitted radii
and axes of the blocks before and after, to nanometres; blocks for which these differ by more than 0.005 pixels are fitted again.
What is left out is the bend of the jet's outline within a block, ``R'' h^2/12`` for a height h.
"""

from collections.abc import Callable, Sequence

import numpy as np

from spinline.checks import FloatArray
from spinline.xray.forward import Absorber
from spinline.xray.frame import Frame, FrameFit, blocks_of, fit_frame, require_track
from spinline.xray.outcome import RowFit
from spinline.xray.track import Track

__all__ = ["fit_frame_phase"]

_TOLD_APART = 0.005  # pixels over a block
_SURE = 3.0  # standard deviations


def fit_frame_phase(
    frame: Frame,
    absorber: Absorber,
    law: Callable[..., RowFit],
    *,
    shells: int | FloatArray = 3,
    block_rows: int = 1,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope"),
    track: Track | None = None,
    done: Callable[[int], None] | None = None,
) -> FrameFit:
    """Estimate the polymer fraction in every block of rows of a frame with fringes.

    Parameters
    ----------
    frame, absorber, shells, block_rows, nuisances, track, done
        As in `fit_frame`.
    law : callable
        `phase_fit.phase_law`.

    Returns
    -------
    FrameFit

    Raises
    ------
    InputError
        As `fit_frame`.

    Notes
    -----
    0.1 to 0.3 s a block, times the sections: five for a change of a pixel.
    """
    path = require_track(frame) if track is None else track
    blocks = blocks_of(frame.counts.shape[0], block_rows)
    height = np.diff(blocks, axis=1)[:, 0]
    middle = blocks.mean(axis=1) - 0.5
    at = np.arange(path.radius.size)
    slopes = [np.interp(middle, at, _gradient(_smoothed(v, height[0]), at)) for v in (path.radius, path.axis)]
    change = frame.pixel * np.stack(slopes, axis=1) * height[:, None]
    options = {"shells": shells, "nuisances": nuisances, "track": path, "one": law}
    fit = fit_frame(frame, absorber, block_rows=block_rows, change=change, done=done, **options)
    found, sure = _changes(fit, middle, height)
    off = (np.abs(found - change) > np.maximum(_TOLD_APART * frame.pixel, _SURE * sure)).any(axis=1)
    if off.any():
        new = np.where(off[:, None], found, change)
        fit_frame(frame, absorber, block_rows=block_rows, change=new, again=(fit, off), **options)
    return fit


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
