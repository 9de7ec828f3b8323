"""Frames that do not belong among the others: without the jet among counts, with one among flats, with light among darks.

Frames are compared by their strips (`spinline.xray.frame.strips`), as `spinline.xray.frame.shadows` says.
"""

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.images.stacks import Stack
from spinline.images.sums import FrameSum, listed, without
from spinline.xray.frame.shadows import Shadows, mean_shadow, shadows_of, tilts
from spinline.xray.frame.strips import Bands

__all__ = ["light_of", "with_jet", "without_light", "without_shadow"]

_GONE, _SURELY, _TOLD = 0.25, 8.0, 0.1  # of the usual depth; standard deviations; its standard deviation
_MOVES, _CHANGES = 0.1, 0.1  # of the radius, and of the shadow
# of a dark's counts, by Poisson: no median of a frame's pixels leaves the others' by that
_NOISE, _LEAST = 8.0, 20.0  # standard deviations, counts


def with_jet(
    stack: Stack, summed: FrameSum, dark: FloatArray, flat: FloatArray | None, gain: float
) -> tuple[FrameSum, list[str]]:
    """The sum of the frames that show the jet, and what is said of the others, and of a jet that moves or changes.

    Parameters
    ----------
    stack, summed
        Counts.
    dark, flat : ndarray, shape (rows, columns)
        Counts of one exposure, and above dark; None: the beam is taken as even.
    gain : float
        Photons per count, less where there is more noise.

    Raises
    ------
    InputError
        Where frames without the jet are too many to be looked for one by one.
    """
    beam = stack.bands.strips((np.ones_like(dark) if flat is None else flat)[None], [0])[0].astype(np.float64)
    seen = shadows_of(*light_of(stack.bands, summed, dark, beam, gain))
    if seen is None:
        return summed, []
    scatter = _scatter(seen.depth[seen.depth > 0.5])  # more than the photons', maybe
    told = seen.depth_std < _TOLD
    gone = told & (seen.depth < _GONE) & (1.0 - seen.depth > _SURELY * np.hypot(seen.depth_std, scatter))
    if not gone.any():
        return summed, _unsteady(seen, told, stack.bands.wide)
    words = "show no jet where the others do (flats among them, or a jet that comes and goes)"
    rest, said = _left_out(stack, summed, gone, words, ', or take frames = "each"')
    same, more = with_jet(stack, rest, dark, flat, gain)  # now their own mean is that of a jet
    return same, [*said, *more]


def _left_out(
    stack: Stack, summed: FrameSum, odd: BoolArray, words: str, remedy: str = ""
) -> tuple[FrameSum, list[str]]:
    """The sum without some of the frames whose strips are kept; refused where there are others, that were not looked at."""
    which = tuple(summed.kept[i] for i in np.flatnonzero(odd))
    told = f"{len(which)} of {summed.frames} frames {words}"
    if len(summed.kept) < summed.used:
        told += f", of {len(summed.kept)} that were looked at"
        raise InputError(stack.key, told, value=f"frames {listed(which)}", remedy=f"leave them out of its file{remedy}")
    return without(stack, summed, which), [f"{stack.key}: {told} and are left out: {listed(which)}"]


def light_of(
    bands: Bands, summed: FrameSum, dark: FloatArray, beam: FloatArray, gain: float
) -> tuple[FloatArray, FloatArray]:
    """Light of the strips over the beam's, and its variance by photons; NaN where there is no beam."""
    counts = np.asarray(summed.strips, dtype=np.float64)
    usable = np.isfinite(counts).all(axis=0) & (beam > 0.0)
    over = np.where(usable, beam, np.nan)
    return (counts - bands.strips(dark[None], [0])[0]) / over, counts / (gain * bands.pixels * over**2)


def _scatter(depth: FloatArray) -> float:
    return float(np.std(depth)) if depth.size else 0.0


def _unsteady(seen: Shadows, used: BoolArray, wide: int) -> list[str]:
    """What is said of a jet that moves or changes from frame to frame."""
    if used.sum() < 3:
        return []
    moved = _scatter(seen.shift[used & (seen.depth > 0.5)])
    if moved > max(_MOVES, 3.0 * float(np.median(seen.depth_std[used]))) * seen.radius:
        told = f"moves by {moved * wide:.2g} pixels (standard deviation) from frame to frame, and is "
        told += f"{2.0 * seen.radius * wide:.3g} wide: their sum is blurred by it"
    elif seen.changes > _CHANGES:
        told = f"casts shadows that differ by {100 * seen.changes:.2g} % from frame to frame: their sum is not that of one jet"
    else:
        return []
    return [f'the jet {told}; take frames = "each"']


def without_shadow(
    stack: Stack, summed: FrameSum, dark: FloatArray, jet: FrameSum, gain: float | None
) -> tuple[FrameSum, list[str]]:
    """The sum of the flats that do not show the jet, and what is said of those that do.

    Parameters
    ----------
    stack, summed
        Flats.
    dark : ndarray, shape (rows, columns)
    jet : FrameSum
        Some of the frames with the jet.
    gain : float or None
        Photons per count, where it is known.
    """
    bands = stack.bands
    kept = summed.strips.astype(np.float64) - bands.strips(dark[None], [0])[0]
    if len(kept) < 2 or kept.shape[1:] != jet.strips.shape[1:]:
        return summed, []
    level = np.nanquantile(kept, 0.8, axis=(1, 2))
    if not (level > 0.0).all():
        return summed, []
    beam = np.nanquantile(kept / level[:, None, None], 0.75, axis=0)  # as if a jet is in fewer than three of four
    known = 1.0 if gain is None else gain
    seen = mean_shadow(*light_of(bands, jet, dark, beam, known))
    if seen is None:
        return summed, []
    light, spread = light_of(bands, summed, dark, beam, known)
    tilt = tilts(light, spread)
    light, spread = light / tilt, spread / tilt**2
    beside, bent = seen.level(light, spread)
    depth, _ = seen.match(1.0 - light / beside, spread, among=False)
    error = np.hypot(seen.errors(spread / beside**2, bent), _scatter(depth[depth < 0.5]))
    odd = (depth > 0.5) & (depth > _SURELY * error)
    if not odd.any() or odd.all():
        return summed, []
    return _left_out(stack, summed, odd, "show the jet")


def without_light(stack: Stack, total: FrameSum) -> tuple[FrameSum, list[str]]:
    """The sum of the darks that are not far brighter than the rest, and what is said of those that are."""
    if total.used < 3:
        return total, []
    mean = total.total / np.maximum(total.exposures, 1)
    seen = (total.exposures > 0) & np.isfinite(total.highest)
    if not seen.any() or not _far(float(np.median((total.highest - mean)[seen])), float(np.median(mean[seen]))):
        return total, []
    levels = np.nanmedian(total.strips, axis=(1, 2))
    usual = float(np.median(levels))
    lit = np.array([_far(level - usual, usual) for level in levels.tolist()])
    if not lit.any():
        return total, []
    words = f"are far brighter than the others (by up to {levels.max() - usual:.4g} counts)"
    rest, said = _left_out(stack, total, lit, words)
    return rest, [f"{said[0]}. Was the shutter open?"]


def _far(excess: float, level: float) -> bool:
    return bool(excess > max(_NOISE * np.sqrt(max(level, 0.0) + 1.0), _LEAST))
