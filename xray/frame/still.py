"""Blocks of rows in which the jet stands still, for what all rows share."""

from itertools import pairwise

import numpy as np

from spinline.base.errors import InputError
from spinline.xray.frame.blocks import Frame, lean_smear
from spinline.xray.frame.lean import Lean
from spinline.xray.frame.shared import Block
from spinline.xray.frame.track import Track

__all__ = ["blocks_of_frame", "steady_rows"]

_FEWEST, _MOST = 8, 30  # blocks
_STEADY = 0.5  # pixels
_STILL = 1.5  # pixels that radius and axis may change in a block


def blocks_of_frame(
    frame: Frame,
    track: Track,
    lean: Lean,
    *,
    known: tuple[tuple[int, int], float] | None = None,
    most_rows: int | None = None,
) -> list[Block]:
    """Blocks of rows in which the jet stands still, from all over a frame.

    Parameters
    ----------
    frame, track, lean
    known : ((int, int), float), optional
        Rows of known fraction, and that fraction.
    most_rows : int, optional
        Of a block.
    """
    rows = frame.counts.shape[0]
    change = float(np.abs(np.diff(track.radius)).sum()) if rows > 1 else 0.0
    count = int(np.clip(np.ceil(change / _STILL), min(_FEWEST, rows), _MOST))
    bounds = np.unique(np.linspace(0, rows, count + 1).astype(int)).tolist()
    if known is not None:
        bounds = sorted({*bounds, *known[0]})
    out = []
    for start, stop in pairwise(bounds):
        spans = _still(track, lean, start, stop, most_rows)
        inside = known is not None and known[0][0] <= start and stop <= known[0][1]
        block = _block(frame, track, lean, *spans, known[1] if known is not None and inside else None)
        if block is not None:
            out.append(block)
    return out


def _still(track: Track, lean: Lean, start: int, stop: int, most_rows: int | None) -> tuple[int, int]:
    """The middle part of a span in which the radius changes by little."""
    height = stop - start
    if height > 2:
        slope = abs(float(np.polyfit(np.arange(height), track.radius[start:stop], 1)[0]))
        height = int(np.clip(_STILL / max(slope, 1e-9), 1, height))
    if most_rows is not None:
        height = min(height, most_rows)
    low = start + (stop - start - height) // 2
    return low, low + height


def _block(frame: Frame, track: Track, lean: Lean, start: int, stop: int, known: float | None) -> Block | None:
    inside = slice(start, stop)
    if not track.found[inside].any():
        return None
    slope = float(lean.slope[inside].mean())
    try:
        counts, detector, good = frame.block(start, stop, slope)
    except InputError:
        return None
    at = np.arange(stop - start)
    radius, axis = track.radius[inside], track.axis[inside] - slope * (at - 0.5 * (at.size - 1))
    spread = [float(np.std(np.polyval(np.polyfit(at, v, 1), at))) if at.size > 2 else 0.0 for v in (radius, axis)]
    smear = float(np.sqrt(spread[0] ** 2 + spread[1] ** 2 + lean_smear(at.size, slope) ** 2)) * frame.pixel
    half = 0.5 * frame.counts.shape[1] - 1.0
    middle = float(np.clip(axis.mean(), -half, half))
    return Block(
        counts,
        good,
        detector,
        float(radius.mean()) * frame.pixel,
        middle * frame.pixel,
        1.0 / float(np.hypot(1.0, slope)),
        smear,
        known,
    )


def steady_rows(track: Track) -> tuple[int, int]:
    """Rows from the widest one on, over which radius and axis stay within half a pixel: first, and the one after the last."""
    start = int(np.argmax(np.where(track.found, track.radius, 0.0)))
    steady = np.hypot(track.radius - track.radius[start], track.axis - track.axis[start]) < _STEADY
    changed = np.flatnonzero(~steady[start:])
    return start, start + int(changed[0]) if changed.size else int(steady.size)
