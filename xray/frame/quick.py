"""The published quick look on a whole frame: Eqs. (41)-(42) on every chord, all rows at once.

    phi(x) = (-ln(T) / L(x) - mu_s + mu_air) / D,    T = (counts - dark) / (flat A (1 + s u))

with radius, axis and the beam's level and slope from `track`. A chord mean is no local value; gathered by ``|x|/R`` into
shells it is still the mean along chords at that distance from the axis. The mean over the section is exact in principle,
for the sum of -ln T over the jet is the integral of mu over its area. Its error is counts and geometry together, to first
order; the bias of a logarithm, ``1/(2 N L D)``, is flagged, not taken off. `frame.fit_frame` has no such price, at ten
times the time.
"""

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.xray.frame.blocks import Frame, FrameFit, blocks_of, require_track
from spinline.xray.frame.track import Track
from spinline.xray.phase.fringe_frame import brightened_air
from spinline.xray.row.chords import equal_shells
from spinline.xray.row.forward import Absorber
from spinline.xray.row.limit import require_contrast

__all__ = ["chord_frame"]

_LEAST_CHORDS = 3
_FRINGES = 5.0  # standard deviations


def chord_frame(
    frame: Frame,
    absorber: Absorber,
    *,
    shells: int = 3,
    block_rows: int = 1,
    track: Track | None = None,
    lean: FloatArray | None = None,
) -> FrameFit:
    """Chord means of the polymer fraction of every block of rows, and the mean over the section.

    Parameters
    ----------
    frame, absorber, block_rows, track
        As in `frame.fit_frame`; a track is of the blocks.
    shells : int
        Intervals of ``|x|/R`` that chords are gathered in.
    lean : ndarray, shape (rows,), optional
        As in `blocks.fit_frame`.

    Returns
    -------
    FrameFit
        Of the method "chord": `fraction` holds chord means.

    Raises
    ------
    InputError
        For a contrast near 0, or no jet.

    Notes
    -----
    About 0.1 ms a row of 400 pixels.
    """
    require_contrast(absorber)
    edges = equal_shells(shells)
    fit = FrameFit.empty("chord", edges, blocks_of(frame.counts.shape[0], block_rows))
    small = frame if block_rows == 1 else _binned(frame, fit)
    path = require_track(small) if track is None else track
    slope = np.zeros(frame.counts.shape[0]) if lean is None else lean
    cosine = np.array([1.0 / np.hypot(1.0, float(slope[a:b].mean())) for a, b in fit.rows.tolist()])
    for start in range(0, fit.rows.shape[0], 64):  # rows: what the processor keeps at hand
        part = slice(start, start + 64)
        _chords(fit, part, small, absorber, path, cosine[part])
    if _bright(small, path) > _FRINGES:
        for block in range(fit.rows.shape[0]):
            fit.flag(block, "fringes")
    return fit


def _bright(frame: Frame, path: Track) -> float:
    """Light over the beam beside the jet, in standard deviations."""
    n = frame.counts.shape[1]
    aside = np.abs(np.arange(n) - 0.5 * (n - 1) - path.axis[:, None]) - path.radius[:, None]
    beam = frame.flat * (path.level[:, None] * (1.0 + path.slope[:, None] * np.linspace(-1.0, 1.0, n)))
    return brightened_air(frame.counts, frame.dark, beam, aside, frame.good)


def _binned(frame: Frame, fit: FrameFit) -> Frame:
    stop = fit.rows[-1, 1]
    counts, flat, dark = (
        np.add.reduceat(np.where(frame.good, a, 0.0)[:stop], fit.rows[:, 0], axis=0)
        for a in (frame.counts, frame.flat, frame.dark)
    )
    return Frame(counts, flat, dark, flat > 0, frame.pixel, frame.blur)


def _chords(fit: FrameFit, part: slice, frame: Frame, absorber: Absorber, path: Track, cosine: FloatArray) -> None:
    counts, flat, dark, good = frame.counts[part], frame.flat[part], frame.dark[part], frame.good[part]
    r, a, level, slope = (v[part, None] for v in (path.radius, path.axis, path.level, path.slope))
    rows, n = counts.shape
    base, d, p = absorber.solvent - absorber.air, absorber.contrast, frame.pixel
    u = np.linspace(-1.0, 1.0, n)
    s = (np.arange(n + 1) - 0.5 * n - a) / r
    inside = (np.maximum(np.abs(s[:, 1:]), np.abs(s[:, :-1])) <= 1.0) & good
    c = np.clip(s, -1.0, 1.0)
    chord = np.diff(c * np.sqrt((1.0 - c) * (1.0 + c)) + np.arcsin(c), axis=1) * r**2 * p * cosine[:, None]
    through = counts - dark
    lit = inside & (through > 0)
    safe = np.where(lit, through, 1.0)
    depth = np.where(lit, -np.log(safe / np.where(good, flat, 1.0) / (level * (1.0 + slope * u))), 0.0)
    noise = np.where(lit, counts / safe**2, 0.0)  # variance of the depth
    covariance = np.where(np.isfinite(path.covariance[part]), path.covariance[part], 0.0)[:, 1:, 1:]

    area = np.where(lit, chord, 0.0).sum(axis=1)
    enough = (lit.sum(axis=1) >= _LEAST_CHORDS) & (lit.sum(axis=1) == inside.sum(axis=1))
    area = np.where(enough, area, np.nan)
    total = depth.sum(axis=1) / area
    fit.mean[part] = (total - base) / d
    slopes = np.stack(
        [
            -2.0 * total / r[:, 0],
            0.0 * total,
            lit.sum(axis=1) / area / level[:, 0],
            np.where(lit, u, 0.0).sum(axis=1) / area,
        ],
        axis=1,
    )  # with radius, axis, level, slope
    geometry = np.einsum("ri,rij,rj->r", slopes, covariance, slopes)
    fit.mean_std[part] = np.sqrt(noise.sum(axis=1) / area**2 + geometry) / abs(d)
    mu = base + d * 0.5 * np.clip(np.nan_to_num(2.0 * fit.mean[part]), 0.0, 2.0)
    _bounds(fit, part, np.where(good, flat, 0.0), np.where(good, chord, 0.0), mu[:, None], d)
    _gather(
        fit, part, np.abs(0.5 * (s[:, 1:] + s[:, :-1])), chord, lit, depth, noise, (base, d), (covariance, level, u)
    )
    few = np.nansum(np.where(lit, noise, 0.0), axis=1) * 0.5 > 0.1 * np.sqrt(noise.sum(axis=1))
    for name, values, index in (("radius", r * p, 0), ("axis", a * p, 1), ("amplitude", level, 2), ("slope", slope, 3)):
        scale = (p * cosine if index == 0 else p) if index < 2 else 1.0
        fit.values[name][part] = values[:, 0] * (cosine if index == 0 else 1.0)
        fit.std[name][part] = scale * np.sqrt(np.maximum(path.covariance[part][:, index + 1, index + 1], 0.0))
    fit.values["blur"][part], fit.std["blur"][part] = frame.blur, 0.0
    for i in range(rows):
        block = (part.start or 0) + i
        if few[i]:
            fit.flag(block, "few_counts")
        if not enough[i]:
            fit.flag(block, "not_fitted")
            fit.reasons[int(fit.rows[block, 0])] = "chords without a count above dark, or fewer than 3 within the jet"
        if abs(a[i, 0]) + r[i, 0] > 0.5 * n - 3.0:
            fit.flag(block, "no_air")
        if fit.mean_std[block] > abs(fit.mean[block]):
            fit.flag(block, "noisy")


def _bounds(fit: FrameFit, part: slice, flat: FloatArray, chord: FloatArray, mu: FloatArray, contrast: float) -> None:
    """Smallest error of the mean if nothing but it were unknown."""
    information = contrast**2 * (flat * np.exp(-mu * chord) * chord**2).sum(axis=1)
    fit.limit_std[part] = np.where(information > 0, np.maximum(information, 1e-300) ** -0.5, np.nan)


def _gather(
    fit: FrameFit,
    part: slice,
    distance: FloatArray,
    chord: FloatArray,
    lit: BoolArray,
    depth: FloatArray,
    noise: FloatArray,
    material: tuple[float, float],
    beam: tuple[FloatArray, FloatArray, FloatArray],
) -> None:
    """Chords by their distance from the axis, weighted by the square of their length."""
    base, d = material
    covariance, level, u = beam
    shells = fit.fraction.shape[1]
    which = np.minimum((distance * shells).astype(np.int64), shells - 1)
    for j in range(shells):
        here = lit & (which == j)
        squares = np.where(here, chord**2, 0.0).sum(axis=1)
        squares = np.where(squares > 0, squares, np.nan)
        sums = np.where(here, depth * chord, 0.0).sum(axis=1)
        fit.fraction[part, j] = (sums / squares - base) / d
        counts = np.where(here, noise * chord**2, 0.0).sum(axis=1) / squares**2
        by_level = np.where(here, chord, 0.0).sum(axis=1) / squares / level[:, 0]
        by_slope = np.where(here, chord * u, 0.0).sum(axis=1) / squares
        slopes = np.stack([by_level, by_slope], axis=1)
        beam_part = np.einsum("ri,rij,rj->r", slopes, covariance[:, 2:, 2:], slopes)
        fit.covariance[part, j, :] = np.where(np.arange(shells) == j, 0.0, np.nan)
        fit.covariance[part, j, j] = (counts + beam_part) / d**2
