"""Frames with light among those that should be dark: a shutter that was not shut yet."""

import math

import numpy as np

from spinline.images.stacks import Stack
from spinline.images.sums import FrameSum

__all__ = ["lit_darks"]

# standard deviations of a dark's counts, by Poisson: no median of a frame's pixels leaves the others' by that
_NOISE = 8.0
_LEAST = 20.0  # counts


def lit_darks(stack: Stack, total: FrameSum) -> list[str]:
    """What is said of a stack of darks in which a few frames are far brighter than the rest."""
    if total.used < 3:
        return []
    mean = total.total / np.maximum(total.exposures, 1)
    seen = (total.exposures > 0) & np.isfinite(total.highest)
    if not seen.any() or not _far(float(np.median((total.highest - mean)[seen])), float(np.median(mean[seen]))):
        return []
    used = [i for i in range(stack.frames) if i not in {*total.lost, *total.copies}]
    levels = np.array([float(np.median(stack.read(i, i + 1)[0][seen])) for i in used])
    usual = float(np.median(levels))
    lit = [i for i, level in zip(used, levels.tolist(), strict=True) if _far(level - usual, usual)]
    if not lit:
        return []
    shown = ", ".join(map(str, lit[:12])) + (", ..." if len(lit) > 12 else "")
    over = float(levels.max() - usual)
    shift = float(levels.mean() - usual)
    told = f"{len(lit)} of {stack.frames} frames are far brighter than the others (by up to {over:.4g} counts): {shown}"
    return [
        f"dark: {told}. Was the shutter open? They raise the dark by {shift:.3g} counts: leave them out of its file"
    ]


def _far(excess: float, level: float) -> bool:
    return excess > max(_NOISE * math.sqrt(max(level, 0.0) + 1.0), _LEAST)
