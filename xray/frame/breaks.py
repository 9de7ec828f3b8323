"""Rows between which a shadow jumps: the end of a nozzle, of a jet, a drop; a jet that thins does so over many rows.

What a row's shadow holds, the sum of 1 - T over it in pixels, is for a thin jet its attenuation times its section: from one
row to the next it changes by a small part. It is compared over one row, medians of three on both sides, so that a single row
that is off is none.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["Break", "row_breaks"]

_FACTOR, _SURELY = 2.0, 8.0  # of the shadow; standard deviations
_NEAR = 3  # rows on each side
_LEVEL = 0.9  # quantile of a row that is its air


@dataclass(frozen=True)
class Break:
    """First row below the break, and the shadow above and below it, pixels."""

    row: int
    above: float
    below: float


def row_breaks(counts: FloatArray, flat: FloatArray, dark: FloatArray, good: BoolArray) -> list[Break]:
    """Breaks of the shadow down a frame, the largest of each place.

    Parameters
    ----------
    counts, flat, dark : ndarray, shape (rows, pixels)
        Photons: measured, expected without a jet above dark, dark.
    good : ndarray of bool, shape (rows, pixels)
    """
    use = np.flatnonzero(good.sum(axis=1) >= max(8, good.shape[1] // 2))
    if use.size <= 2 * _NEAR:
        return []
    seen, safe = good[use], np.where(good[use], flat[use], 1.0)
    ratio = np.where(seen, (counts[use] - dark[use]) / safe, np.nan)
    level = np.nanquantile(ratio, _LEVEL, axis=1)
    if not (level > 0.0).all():
        return []
    shadow = good.shape[1] * (1.0 - np.nanmean(ratio, axis=1) / level)
    variance = np.where(seen, counts[use] / safe**2, 0.0).sum(axis=1) / seen.sum(axis=1) ** 2
    noise = good.shape[1] * np.sqrt(variance) / level
    windows = np.lib.stride_tricks.sliding_window_view(shadow, _NEAR)
    middle = np.median(windows, axis=1)
    error = np.sqrt(np.lib.stride_tricks.sliding_window_view(noise**2, _NEAR).mean(axis=1))
    above, below = middle[: -_NEAR - 1], middle[_NEAR + 1 :]
    spread = np.hypot(error[: -_NEAR - 1], error[_NEAR + 1 :])
    small, large = np.minimum(above, below), np.maximum(above, below)
    over = large - _FACTOR * np.maximum(small, 0.0)
    apart = over > _SURELY * _FACTOR * spread
    out: list[Break] = []
    at = np.flatnonzero(apart)
    for group in np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if at.size else ():
        best = int(group[np.argmax(over[group])])
        first = int(use[round(float(group.mean()) + _NEAR + 0.5)])  # a median turns two rows before and after it
        out.append(Break(first, float(above[best]), float(below[best])))
    return out
