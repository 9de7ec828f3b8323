"""The jet's shadow, frame by frame: how deep it is against that of the others, where, and what differs.

Frames come as strips: a few bands of rows, as light over the beam's. The shadow s = 1 - light/level, the level that of the
light beside the jet, is the same in every frame of a jet that stays; that of one frame against the mean of all,

    depth = sum s_k s / sum s^2    at the shift where it is largest,

is 0 without a jet, and its error is that of the photons. The mean is that of the other frames: a frame's own noise in it would
look like a jet; and the sum of its squares is taken less that of its noise. Of two frames the mean is that of both: against
one another a frame with the jet and one without look alike.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["MeanShadow", "Shadows", "mean_shadow", "shadows_of", "tilts"]

_INSIDE, _OUTSIDE = 0.3, 0.1  # of the darkest part of the shadow
_CLEAR = 10.0  # times the square of its noise: the mean shadow's
_SMOOTH = 9  # bins
_MORE = 1.0  # times the noise: what differs
_BESIDE = 4  # bins
_ROUNDS = 6
_DIM = 0.1  # of the usual light: too little to be compared
_EXPLAINED = 0.8  # of what differs beside the jet, by a line


@dataclass(frozen=True, eq=False)
class Shadows:
    """What the frames show of the jet.

    Attributes
    ----------
    depth, depth_std, shift : ndarray, shape (frames,)
        Over the depth that frames with a jet have, its error by the photons, and bins to the right of the mean. NaN where a
        frame has no light.
    radius : float
        Half the width of the mean shadow, bins.
    changes : float
        Root mean square of what differs from frame to frame, less noise and what a beam that drifts makes (a parabola across
        the frame), over that of the shadow.
    """

    depth: FloatArray
    depth_std: FloatArray
    shift: FloatArray
    radius: float
    changes: float


def shadows_of(light: FloatArray, spread: FloatArray) -> Shadows | None:
    """Depth and place of the jet's shadow in every frame; None where there is too little to see.

    Parameters
    ----------
    light, spread : ndarray, shape (frames, bands, bins)
        Light over the beam's, to any level of each frame, and its variance by photons; NaN where there is no beam.
    """
    lit = np.nanquantile(light, 0.8, axis=(1, 2)) > 0.0 if np.isfinite(light).any() else np.zeros(len(light), np.bool_)
    if lit.sum() < 2:
        return None
    tilt = np.ones(light.shape)
    tilt[lit] = tilts(light[lit], spread[lit])
    light, spread = light / tilt, spread / tilt**2
    if (jet := mean_shadow(light[lit], spread[lit])) is None:
        return None
    level, bent = jet.level(light[lit], spread[lit])
    shadow, noise = 1.0 - light[lit] / level, spread[lit] / level**2
    depth, shift = jet.match(shadow, noise, among=True)
    usual = float(np.quantile(depth, 0.9))
    if not usual > 0.0:
        return None
    of_all = np.full((3, lit.size), np.nan)
    of_all[:, lit] = depth / usual, jet.errors(noise, bent) / usual, shift
    return Shadows(of_all[0], of_all[1], of_all[2], 0.5 * jet.width, _changes(shadow, jet, noise))


def _lines(beside: BoolArray, inside: BoolArray, terms: int = 2) -> FloatArray:
    """What the light beside the jet says of the level everywhere, shape (bands, bins, bins): level = lines @ light.

    A line of each band (or more `terms`), a number where light is on one side alone.
    """
    bands, n = beside.shape
    out = np.zeros((bands, n, n))
    u = np.linspace(-1.0, 1.0, n)
    for band in range(bands):
        seen = beside[band]
        at = np.flatnonzero(inside[band])
        sides = (seen[: at[0]].sum(), seen[at[-1] + 1 :].sum()) if at.size else (0, 0)
        basis = np.vander(u, terms if min(sides) >= _BESIDE else 1)
        if seen.any():
            out[band][:, seen] = basis @ np.linalg.pinv(basis[seen])
    return out


@dataclass(frozen=True, eq=False)
class MeanShadow:
    """The mean shadow of some frames: its shape, the sum of its squares less noise, the bins beside it, its width in bins.

    `lines`: as of `_lines`.
    """

    shape: FloatArray
    square: float
    beside: BoolArray
    width: float
    lines: FloatArray

    def level(self, light: FloatArray, spread: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Light of every frame as it would be without the jet, (frames, bands, bins), and the frames where it is a line."""
        return _level(light, spread, self.lines, self.beside)

    def match(self, shadow: FloatArray, noise: FloatArray, *, among: bool) -> tuple[FloatArray, FloatArray]:
        """Largest agreement of every frame with the mean shadow (`among`: of the others), and the shift there, bins."""
        frames, n = len(shadow), self.shape.shape[-1]
        pair = among and frames == 2
        own_noise = 0.5 * np.nan_to_num(noise)[:, self.shape != 0.0].sum(axis=1) if pair else np.zeros(frames)
        filled = np.nan_to_num(shadow)
        against = np.conj(np.fft.rfft(self.shape, 2 * n))
        depth, shift = np.empty(frames), np.empty(frames)
        for start in range(0, frames, 256):
            part = np.s_[start : start + 256]
            wave = np.fft.rfft(filled[part], 2 * n)
            found = np.fft.irfft((wave * against).sum(axis=1), 2 * n)
            if among and not pair:
                own = np.conj(np.fft.rfft(np.where(self.shape != 0.0, filled[part], 0.0), 2 * n))
                found = (frames * found - np.fft.irfft((wave * own).sum(axis=1), 2 * n)) / (frames - 1)
            best = found.argmax(axis=1)
            at = np.arange(len(best))
            before, here, after = found[at, best - 1], found[at, best], found[at, (best + 1) % (2 * n)]
            curve = np.maximum(2.0 * here - before - after, 1e-300)
            depth[part] = (here - own_noise[part]) / self.square
            shift[part] = np.where(best > n, best - 2 * n, best) + 0.5 * (after - before) / curve
        return depth, shift * (frames - 1) / frames if among else shift  # from the mean of all

    def errors(self, spread: FloatArray, bent: BoolArray) -> FloatArray:
        """Standard deviation of the agreement, by the noise of the frame and of its level, a line where `bent`."""
        filled = np.nan_to_num(spread)
        flat = np.mean(filled[:, self.beside], axis=1) / self.beside.sum() * np.sum(self.shape) ** 2
        lines = np.einsum("bi,bij->bj", self.shape, self.lines) ** 2  # light beside the jet: no bin of its shape
        of_level = np.where(bent, np.sum(lines * filled, axis=(1, 2)), flat)
        return np.asarray(np.sqrt(np.sum(self.shape**2 * filled, axis=(1, 2)) + of_level) / self.square)


def tilts(light: FloatArray, spread: FloatArray) -> FloatArray:
    """Slope across every frame over that of their mean, 1 where a line is not nearly all that differs: of a beam that moves."""
    mean = light.mean(axis=0)
    seen = mean > _DIM * np.nanmedian(mean) if np.isfinite(mean).any() else np.zeros(mean.shape, np.bool_)
    if not (seen.sum(axis=1) >= 2 * _BESIDE).all():
        return np.ones(light.shape)
    over = np.where(seen, mean, 1.0)
    whole = np.zeros_like(seen)
    whole[:, light.shape[2] // 2] = True  # light on both sides
    level, bent = _level(np.where(seen, light / over, 0.0), spread / over**2, _lines(seen, whole), seen)
    even = level.mean(axis=(1, 2), keepdims=True)
    return np.where(bent[:, None, None], level / even, 1.0)


def _level(light: FloatArray, spread: FloatArray, lines: FloatArray, beside: BoolArray) -> tuple[FloatArray, BoolArray]:
    """Light as it would be without a jet: one number, or lines where these explain what differs beside it."""
    even = np.nanmean(light[:, beside], axis=1)[:, None, None]
    line = np.einsum("bij,fbj->fbi", lines, np.nan_to_num(light))
    left, rest = (np.sum((light - level)[:, beside] ** 2, axis=1) for level in (even, line))
    noise = np.sum(spread[:, beside], axis=1)
    bent = (left - rest > _EXPLAINED * (left - noise)) & (left - rest > noise) & (line > 0.1 * even).all(axis=(1, 2))
    return np.asarray(np.where(bent[:, None, None], line, even)), np.asarray(bent)


def mean_shadow(light: FloatArray, spread: FloatArray) -> MeanShadow | None:
    """The mean shadow of frames; None where it is mostly noise, or nothing is beside it."""
    level = np.nanquantile(light, 0.8, axis=(1, 2))[:, None, None]
    if not (level > 0.0).all():
        return None
    seen = np.isfinite(light).all(axis=0)
    for _ in range(_ROUNDS):
        mean = np.where(seen, 1.0 - np.mean(light / level, axis=0), 0.0)
        smooth = uniform_filter1d(mean, _SMOOTH, axis=1)
        beside = seen & (smooth < _OUTSIDE * smooth.max())
        if beside.sum() < _BESIDE:
            return None
        lines = _lines(beside, smooth > _INSIDE * smooth.max())
        level, _ = _level(light, spread, lines, beside)
    shape = np.where(smooth > _OUTSIDE * smooth.max(), mean, 0.0)
    noise = float(np.sum(np.nan_to_num(spread / level**2).mean(axis=0)[shape != 0.0])) / len(light)
    square = float(np.sum(shape**2))
    if not square > _CLEAR * noise or not smooth.max() > 0.0:
        return None
    inside = smooth > _INSIDE * smooth.max()
    return MeanShadow(shape, square - noise, beside, float(inside.sum(axis=1)[inside.any(axis=1)].mean()), lines)


def _changes(shadow: FloatArray, jet: MeanShadow, spread: FloatArray) -> float:
    """What differs from frame to frame, over the shadow; 0 where it is no more than noise, that of the levels included."""
    rest = np.nan_to_num(shadow - shadow.mean(axis=0))
    bends = _lines(jet.beside, jet.shape > _INSIDE * jet.shape.max(), 3)
    rest -= np.einsum("bij,fbj->fbi", bends, rest)
    share = np.sum((np.eye(rest.shape[2]) - bends) ** 2, axis=1)  # of a bin's noise in all of its band
    rough = 0.5 * float(np.sum(np.diff(rest, axis=2) ** 2))  # of neighbours: noise, whatever the gain
    told = float(np.nansum(spread))
    noise = max(1.0, rough / told if told > 0.0 else 0.0) * float(np.nansum(spread * share)) if told > 0.0 else rough
    excess = float(np.sum(rest**2)) - noise
    return float(np.sqrt(excess / len(rest) / jet.square)) if excess > _MORE * noise else 0.0
