"""A whole frame, row by row or in blocks of rows: the track of the jet first, then the likelihood of every block.

The rows of a block are summed and taken for one row of one jet (`row`); the fit starts from the radius and the axis that
`track` found there, so it does not have to find the jet again, and a row with few photons is helped by its neighbours.
Where radius or axis changes within the block, the sum is a little out of focus at the edges: a blur of that standard
deviation is added. A block that cannot be fitted is NaN with a flag and its reason, not an end to the rest.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray, positive
from spinline.base.errors import InputError
from spinline.xray.frame.shared import Block, row_shifts
from spinline.xray.frame.track import Track, track_jet
from spinline.xray.row.chords import checked_edges, equal_shells
from spinline.xray.row.fit import fit_row
from spinline.xray.row.forward import Absorber, Detector
from spinline.xray.row.limit import require_contrast
from spinline.xray.row.outcome import FLAGS, RowFit

__all__ = ["FRAME_FLAGS", "Frame", "FrameFit", "fit_frame", "require_track"]

_SHARP = 0.1  # standard deviation of radius and axis within a block, pixels, that is left out
_SMEARED = 0.6  # and that is flagged

FRAME_FLAGS = FLAGS | {
    "not_fitted": "the block could not be fitted",
    "smeared": "radius or axis changes by more than two pixels within the block: take fewer rows",
    "few_counts": "few counts: the logarithm's bias is over a tenth of the error; use the likelihood",
    "fringes": "Fresnel fringes, reduced as absorption: the fraction is wrong, by -0.2 to -6; take the phase method",
}


@dataclass(frozen=True, eq=False)
class Frame:
    """Photons of a frame, (rows, pixels), the jet running down the rows.

    Attributes
    ----------
    counts : ndarray, shape (rows, pixels)
        Measured photons, dark included, summed over exposures.
    flat : ndarray, shape (rows, pixels)
        Photons expected without a jet, above dark, of the same exposures; > 0 where good.
    dark : ndarray, shape (rows, pixels)
        Dark photons of the same exposures, >= 0.
    good : ndarray of bool, shape (rows, pixels)
        False for pixels left out.
    pixel, blur : float
        Width of a pixel, and the standard deviation of the point spread, m.
    tail_share, tail_length : float
        As in `forward.Detector`.
    scatter : tuple of float
        Covariance of pixels 0, 1, 2, ... rows apart over the variance of their photons: (1,) where pixels share no light.
    """

    counts: FloatArray
    flat: FloatArray
    dark: FloatArray
    good: BoolArray
    pixel: float
    blur: float = 0.0
    tail_share: float = 0.0
    tail_length: float = 0.0
    scatter: tuple[float, ...] = (1.0,)

    def __post_init__(self) -> None:
        shape = np.shape(self.counts)
        if len(shape) != 2 or shape[0] < 1 or shape[1] < 4:
            raise InputError("counts", "is not a frame of at least 4 pixels a row", value=f"array of shape {shape}")
        for name in ("flat", "dark", "good"):
            if np.shape(getattr(self, name)) != shape:
                raise InputError(
                    name,
                    "has another shape than counts",
                    value=f"array of shape {np.shape(getattr(self, name))}",
                    allowed=str(shape),
                )
        positive("pixel", self.pixel, "m")

    def block(self, start: int, stop: int, slope: float = 0.0) -> tuple[FloatArray, Detector, BoolArray]:
        """Sum of the rows from `start` to before `stop`: counts, detector and mask of one row.

        Rows of a jet that leans by `slope` pixels a row are first put under each other, by whole pixels.
        """
        good = self.good[start:stop]
        arrays = [np.where(good, a[start:stop], 0.0) for a in (self.counts, self.flat, self.dark)]
        if slope:
            arrays = [_upright(array, slope) for array in arrays]
        counts, flat, dark = (array.sum(axis=0) for array in arrays)
        lit = flat > 0
        if not lit.any():
            raise InputError("flat", "has no good pixel in these rows", value=f"rows {start} to {stop}")
        filled = flat if lit.all() else np.where(lit, flat, np.median(flat[lit]))
        return counts, self.detector(filled, dark, stop - start), lit

    def detector(self, flat: FloatArray, dark: FloatArray, rows: int = 1) -> Detector:
        """The detector of one row of it, or of some rows summed."""
        scatter = self.scatter[0]
        if len(self.scatter) > 1:
            lags = np.arange(len(self.scatter))
            share = np.where(lags == 0, 1.0, 2.0) * np.maximum(1.0 - lags / rows, 0.0)
            scatter = max(float(share @ np.array(self.scatter)), 1e-3)
        return Detector(
            flat,
            self.pixel,
            dark,
            blur=self.blur,
            tail_share=self.tail_share,
            tail_length=self.tail_length,
            scatter=scatter,
        )


def row_steps(rows: int, slope: float) -> NDArray[np.int64]:
    """Whole pixels by which the rows of a leaning jet lie aside of the middle one."""
    steps: NDArray[np.int64] = np.rint(slope * (np.arange(rows) - 0.5 * (rows - 1))).astype(np.int64)
    return steps


def lean_smear(rows: int, slope: float) -> float:
    """Standard deviation, pixels, by which a leaning jet is blurred in rows that are put under each other: a row is a pixel
    high, and whole pixels leave a part of one.
    """
    left = slope * np.arange(rows) - row_steps(rows, slope)
    return float(np.sqrt(np.var(left) + slope**2 / 12.0))


def _upright(array: FloatArray, slope: float) -> FloatArray:
    """Rows put under each other; what comes in at the ends is 0: no pixel."""
    out = np.zeros_like(array)
    for i, step in enumerate(row_steps(array.shape[0], slope).tolist()):
        if step > 0:
            out[i, :-step] = array[i, step:]
        elif step < 0:
            out[i, -step:] = array[i, :step]
        else:
            out[i] = array[i]
    return out


@dataclass(frozen=True, eq=False)
class FrameFit:
    """What a frame says of the jet, block by block.

    Attributes
    ----------
    method : str
        "chord" or "row".
    shell_edges : ndarray, shape (shells + 1,)
        r/R.
    rows : ndarray of int, shape (blocks, 2)
        First row of each block, and the row after its last.
    fraction : ndarray, shape (blocks, shells)
    covariance : ndarray, shape (blocks, shells, shells)
    mean, mean_std : ndarray, shape (blocks,)
        Mean fraction over the cross-section.
    limit_std : ndarray, shape (blocks,)
        Cramer-Rao bound of the mean if nothing but the shells were unknown.
    values, std : dict of ndarray, shape (blocks,)
        "radius" and "axis" in m (axis from the middle of the row), "amplitude", "slope", "blur".
    misfit : ndarray, shape (blocks,)
        As in `row.RowFit`; NaN for chords.
    flags : ndarray of int, shape (blocks,)
        Bit i for the i-th key of `FRAME_FLAGS`.
    reasons : dict
        First row of a block that could not be fitted, to the reason.
    fringes : float
        Significance of fringes in a frame that is reduced as absorption (`fringe_frame`); NaN where they were not looked for.
    shifts : ndarray, shape (blocks, shells, shared)
        Derivatives of the fractions with what all blocks share (`shared.DetectorFit.names`); not in `covariance`.
    excess : ndarray, shape (blocks,)
        Pearson's chi-square over the degrees of freedom.
    """

    method: str
    shell_edges: FloatArray
    rows: NDArray[np.int64]
    fraction: FloatArray
    covariance: FloatArray
    mean: FloatArray
    mean_std: FloatArray
    limit_std: FloatArray
    values: dict[str, FloatArray]
    std: dict[str, FloatArray]
    misfit: FloatArray
    flags: NDArray[np.int64]
    reasons: dict[int, str] = field(default_factory=dict)
    fringes: float = np.nan
    shifts: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    excess: FloatArray = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def empty(
        cls, method: str, edges: FloatArray, rows: NDArray[np.int64], more: Sequence[str] = (), shared: int = 0
    ) -> "FrameFit":
        """A fit of nothing yet: NaN everywhere. `more` are nuisances beyond the usual ones."""
        blocks, shells = rows.shape[0], edges.size - 1

        def nan(*shape: int) -> FloatArray:
            return np.full((blocks, *shape), np.nan)

        names = ("radius", "axis", "amplitude", "slope", "blur", *more)
        return cls(
            method,
            edges,
            rows,
            nan(shells),
            nan(shells, shells),
            nan(),
            nan(),
            nan(),
            {n: nan() for n in names},
            {n: nan() for n in names},
            nan(),
            np.zeros(blocks, dtype=np.int64),
            shifts=np.zeros((blocks, shells, shared)),
            excess=np.ones(blocks),
        )

    def flag(self, block: int, name: str) -> None:
        """Set a flag of a block."""
        self.flags[block] |= 1 << list(FRAME_FLAGS).index(name)


def blocks_of(rows: int, block_rows: int) -> NDArray[np.int64]:
    """First and last-but-one rows of blocks of equal height; the last block may be lower, if it has half the rows."""
    if isinstance(block_rows, bool) or not isinstance(block_rows, int) or not 1 <= block_rows <= rows:
        raise InputError("block_rows", "is not a number of rows of the frame", value=block_rows, allowed=f"[1, {rows}]")
    starts = np.arange(0, rows, block_rows)
    if rows - starts[-1] < 0.5 * block_rows and starts.size > 1:
        starts = starts[:-1]
    return np.stack((starts, np.append(starts[1:], min(starts[-1] + block_rows, rows))), axis=1)


def require_track(frame: Frame) -> Track:
    """Track of the jet; refused where there is none."""
    track = track_jet(frame.counts, frame.flat, frame.dark, frame.good)
    if track is None:
        raise InputError(
            "counts",
            "show no jet along the rows: its radius is not found to 30 %, even in the sum of all rows",
            remedy="check flat and transpose with `spinline preview`, or expose for longer",
        )
    return track


def fit_frame(
    frame: Frame,
    absorber: Absorber,
    *,
    shells: int | FloatArray = 3,
    block_rows: int = 1,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope"),
    track: Track | None = None,
    one: Callable[..., RowFit] = fit_row,
    done: Callable[[int], None] | None = None,
    begun: FrameFit | None = None,
    keep: Callable[[FrameFit], None] | None = None,
    change: FloatArray | None = None,
    again: tuple[FrameFit, BoolArray] | None = None,
    lean: FloatArray | None = None,
    shared: Sequence[str] = (),
) -> FrameFit:
    """Estimate the polymer fraction in the shells of every block of rows, by likelihood.

    Parameters
    ----------
    frame : Frame
    absorber : Absorber
    shells : int or ndarray
        Number of shells of equal width, or their edges r/R.
    block_rows : int
        Rows that are summed to one.
    nuisances : sequence of str
        As in `row.fit_row`.
    track : Track, optional
        From `track_jet`; found where left out.
    one : callable
        What fits a block: takes counts, absorber and detector, and by name shells, nuisances, good, radius and axis; as
        `fit_row`.
    done : callable, optional
        Called with the number of blocks done so far.
    begun : FrameFit, optional
        What an interrupted fit of the same frame passed to `keep`: the blocks in it are not fitted again.
    keep : callable, optional
        Called after each block with the fit so far, which is changed afterwards.
    change : ndarray, shape (blocks, 2), optional
        Change of radius and axis over each block, m, for a `one` that takes them as taper and lean; else it is left to a blur.
    again : (FrameFit, ndarray of bool), optional
        A fit made before, and which of its blocks are to be fitted again, in place.
    lean : ndarray, shape (rows,), optional
        Pixels by which the jet's axis moves aside from row to row (`lean.axis_lean`). A row cuts a leaning jet wider than it
        is, by 1/cos, while the chord along the beam stays: radius and chord are taken so.
    shared : sequence of str
        What the detector shares among blocks (`shared`), for `shifts`; `one` takes the absorber then.

    Returns
    -------
    FrameFit

    Raises
    ------
    InputError
        For a contrast near 0, no jet at all, or where no block can be fitted: the reason of the first.

    Notes
    -----
    As `fit_row`, a block.
    """
    if one is fit_row:
        require_contrast(absorber)
    edges = equal_shells(shells) if isinstance(shells, int) else checked_edges(shells)
    path = require_track(frame) if track is None else track
    half = 0.5 * frame.counts.shape[1] - 1.0
    more_names = [name for name in nuisances if name.startswith("shape")]
    rows = blocks_of(frame.counts.shape[0], block_rows)
    fresh = FrameFit.empty("row", edges, rows, more_names, len(shared))
    fit = again[0] if again is not None else fresh if begun is None else begun
    first: InputError | None = None
    for b, (start, stop) in enumerate(fit.rows.tolist()):
        if again is not None and not again[1][b]:
            continue
        if begun is not None and (np.isfinite(fit.mean[b]) or start in fit.reasons):
            continue
        more: dict[str, float] = {}
        radius, axis, slope, smear = _within(path, half, start, stop, lean)
        if change is not None:
            more, smear = {"taper": float(change[b, 0]), "lean": float(change[b, 1])}, 0.0
        if smear > _SMEARED:
            fit.flag(b, "smeared")
        cosine = 1.0 / float(np.hypot(1.0, slope))
        try:
            counts, detector, good = frame.block(start, stop, slope)
            place = (radius * frame.pixel, axis * frame.pixel, cosine, smear * frame.pixel if smear > _SHARP else 0.0)
            block = Block(counts, good, detector, *place)
            row = one(
                counts,
                absorber.along(cosine),
                block.seen(),
                shells=edges,
                nuisances=nuisances,
                good=good,
                radius=block.radius,
                axis=block.axis,
                **more,
            )
        except InputError as error:
            if again is not None:
                continue
            first = first or error
            fit.reasons[start] = str(error)
            fit.flag(b, "not_fitted")
        else:
            if again is not None:
                fit.flags[b] = 0
            _fill(fit, b, row, cosine)
            if shared:
                fit.shifts[b] = row_shifts(row, absorber, block, shared, nuisances)
        if done is not None:
            done(b + 1)
        if keep is not None:
            keep(fit)
    if first is not None and len(fit.reasons) == fit.rows.shape[0]:
        raise first
    return fit


def _within(
    path: Track, half: float, start: int, stop: int, lean: FloatArray | None
) -> tuple[float, float, float, float]:
    """Radius and axis of a block, the slope of its axis, and how far both change within it, pixels."""
    inside = slice(start, stop)
    radius, axis = path.radius[inside], np.clip(path.axis[inside], -half, half)
    slope = 0.0 if lean is None else float(lean[inside].mean())
    moved = slope * np.arange(stop - start)
    changes = (
        _trend(radius, path.radius_std[inside], path.found[inside]),
        _trend(axis - moved, path.axis_std[inside], path.found[inside]),
        lean_smear(stop - start, slope),
    )
    return float(radius.mean()), float(axis.mean()), slope, float(np.sqrt(np.square(changes).sum()))


def _trend(values: FloatArray, std: FloatArray, found: BoolArray) -> float:
    """Standard deviation of a straight line through the values; 0 where that may be noise."""
    if values.size < 2:
        return 0.0
    at = np.arange(values.size)
    own = found.sum() > 0.5 * values.size
    if own:
        at, values, std = at[found], values[found], std[found]
    if at.size < 2:
        return 0.0
    line = np.polyval(np.polyfit(at, values, 1), at)
    noise = float(np.median(std)) / np.sqrt(at.size if own else 1.0)
    spread = float(np.std(line))
    return spread if spread > 3.0 * noise else 0.0


def _fill(fit: FrameFit, block: int, row: RowFit, cosine: float = 1.0) -> None:
    shells = fit.fraction.shape[1]
    fit.fraction[block] = row.jet.fraction
    fit.covariance[block] = row.covariance[:shells, :shells]
    fit.mean[block], fit.mean_std[block], fit.limit_std[block] = row.mean_fraction, row.mean_fraction_std, row.limit_std
    for name in fit.values:
        scale = cosine if name in ("radius", "blur") else 1.0
        fit.values[name][block], fit.std[name][block] = scale * row.values[name], scale * row.std[name]
    fit.misfit[block], fit.excess[block] = row.misfit, row.excess
    for name in row.flags or _evident(row):
        fit.flag(block, name)


def _evident(row: RowFit) -> list[str]:
    """Flags of a fit that has none of its own."""
    odd = {
        "not_converged": not row.converged,
        "noisy": row.mean_fraction_std > abs(row.mean_fraction),
        "impossible": not -3 * row.mean_fraction_std <= row.mean_fraction <= 1 + 3 * row.mean_fraction_std,
        "misfit": row.misfit > 4,
    }
    return [name for name, true in odd.items() if true]
