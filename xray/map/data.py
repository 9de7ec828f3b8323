"""Counts of a map as they come: checked, bad pixels and dead rows left out, and where the jet is in them.

Radius, axis, level and depth to start from are those of `start.find_jet` on sums of neighbouring rows, as many as it takes
to see the jet at ten standard deviations.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, real
from spinline.base.errors import InputError
from spinline.xray.row.block import smoothed_outliers
from spinline.xray.row.forward import Detector
from spinline.xray.row.start import find_jet

__all__ = ["MapData", "Start", "map_data", "started"]

_SEEN = 10.0  # standard deviations
_FEWEST_ROWS = 10  # in a block, once there are many


@dataclass(frozen=True, eq=False)
class MapData:
    """Counts and what they were taken with.

    Attributes
    ----------
    counts, good : ndarray, shape (rows, pixels)
        `good` is 1 or 0.
    flat, dark, veil : ndarray, shape (rows, pixels) or (1, pixels)
    pixel, blur : float
        m.
    dead : ndarray of bool, shape (rows,)
        Rows without a count above dark where many were due.
    path : ndarray, shape (rows,)
        Factor on the paths through the jet: the cosine of its lean.
    tail : (float, float)
        Share, and length in pixels, of the detector's tail.
    scatter : ndarray, shape (rows,) or (1,)
        Variance of a pixel over that of its photons.
    """

    counts: FloatArray
    good: FloatArray
    flat: FloatArray
    dark: FloatArray
    veil: FloatArray
    pixel: float
    blur: float
    dead: BoolArray
    path: FloatArray
    tail: tuple[float, float]
    scatter: FloatArray


@dataclass(frozen=True, eq=False)
class Start:
    """Where a fit starts, row by row: lengths in pixels.

    Attributes
    ----------
    radius, axis, amplitude : ndarray, shape (rows,)
    depth : float
        Attenuation times pixel along the middle chords, without units.
    """

    radius: FloatArray
    axis: FloatArray
    amplitude: FloatArray
    depth: float


def map_data(
    counts: ArrayLike,
    detector: Detector | Sequence[Detector],
    good: ArrayLike | None,
    saturation: float,
    path: ArrayLike = 1.0,
) -> MapData:
    """Check counts against one detector for all rows, or one for each."""
    each = [detector] if isinstance(detector, Detector) else list(detector)
    raw = np.asarray(counts)
    if raw.ndim != 2 or raw.size == 0 or not each or raw.shape[1] != each[0].flat.size:
        raise InputError(
            "counts",
            "is not a map, or of another width than flat",
            value=f"array of shape {raw.shape}",
            allowed=f"(rows, {each[0].flat.size if each else 'pixels'})",
        )
    if len(each) not in (1, raw.shape[0]):
        raise InputError("detector", "is neither one nor one for each row", value=len(each), allowed=f"1 or {len(raw)}")
    if any(_optics(d) != _optics(each[0]) for d in each):
        raise InputError("detector", "differs in pixels, blur or tail from row to row")
    mask = np.ones(raw.shape, dtype=np.bool_) if good is None else np.asarray(good)
    if mask.dtype != np.bool_ or mask.shape not in (raw.shape, raw.shape[1:]):
        raise InputError(
            "good",
            "is not a mask of the counts",
            value=f"{mask.dtype} of shape {mask.shape}",
            allowed=f"bool, {raw.shape}",
        )
    mask = np.broadcast_to(mask, raw.shape)
    try:
        kept = np.where(mask, raw, 0.0)
    except (TypeError, ValueError):
        raise InputError("counts", "are not numbers", value=counts) from None
    data = real("counts", kept, least=0.0, unit="photons", remedy="give raw counts, dark included; mask bad pixels")
    bright = int((data >= saturation).sum())
    if bright:
        raise InputError(
            "counts",
            f"{bright} pixels are saturated",
            value=float(data.max()),
            allowed=f"under {saturation:g}",
            remedy="mask them (good), or expose for less time",
        )
    flat, dark, veil = (np.array([getattr(d, name) for d in each]) for name in ("flat", "dark", "veil"))
    due = np.where(mask, flat, 0.0).sum(axis=1)
    dead = (due > 100.0) & (data.sum(axis=1) <= np.where(mask, dark, 0.0).sum(axis=1))
    if not mask.any():
        raise InputError("good", "leaves no pixel")
    if dead[mask.any(axis=1)].all() or data.sum() <= np.where(mask, dark, 0.0).sum():
        raise InputError(
            "dark",
            "exceeds the counts: no signal is left",
            value=float(np.where(mask, dark, 0.0).sum()),
            allowed=f"under the counts' sum, {data.sum():g}",
            remedy="give raw counts with the dark image of the same exposure",
        )
    longer = real("path", path, above=0.0, most=10.0)
    if longer.shape not in ((), (raw.shape[0],)):
        raise InputError("path", "is neither a number nor one for each row", value=f"array of shape {longer.shape}")
    one = each[0]
    return MapData(
        data,
        (mask & ~dead[:, None]).astype(np.float64),
        flat,
        dark,
        veil,
        one.pixel,
        one.blur,
        dead,
        np.broadcast_to(longer, (raw.shape[0],)).copy(),
        (one.tail_share, one.tail_length / one.pixel),
        np.array([d.scatter for d in each]),
    )


def _optics(detector: Detector) -> tuple[float, ...]:
    """What all rows of a map have in common."""
    d = detector
    return d.pixel, d.blur, d.tail_share, d.tail_length, float(d.flat.size)


def started(data: MapData, radius: FloatArray | None, axis: FloatArray | None) -> Start:
    """Start of a fit; radius and axis in pixels, shape (rows,), where they are known."""
    rows = data.counts.shape[0]
    block = min(_FEWEST_ROWS, rows)
    while True:
        found = [_block(data, slice(i, min(i + block, rows)), radius, axis) for i in range(0, rows, block)]
        table = np.array([f for f in found if f is not None])
        if len(table) and (block >= rows or np.median(table[:, 5]) > _SEEN):
            break
        if block >= rows:
            raise InputError("good", "leaves fewer than 4 pixels in every row")
        block = min(4 * block, rows)
    at = np.arange(rows)
    place, r, a, level, thick = table[:, :5].T

    def known(value: FloatArray | None, seen: FloatArray) -> FloatArray:
        return np.interp(at, place, _despiked(seen)) if value is None else value

    return Start(known(radius, r), known(axis, a), known(None, level), float(np.median(thick)))


def _block(
    data: MapData, rows: slice, radius: FloatArray | None, axis: FloatArray | None
) -> tuple[float, float, float, float, float, float] | None:
    """Place, radius, axis, level, attenuation and standard deviations of the jet in a sum of rows."""
    good = data.good[rows]

    def total(array: FloatArray) -> FloatArray:
        value: FloatArray = (good * (array[rows] if array.shape[0] > 1 else array)).sum(axis=0)
        return value

    flat = total(data.flat)
    lit = flat > 0.0
    if lit.sum() < 4:
        return None
    clean = smoothed_outliers(total(data.counts)[lit])
    at = np.arange(flat.size)
    background = total(data.dark) + total(data.flat * data.veil)
    ratio = np.interp(at, at[lit], (clean - background[lit]) / flat[lit])
    where = slice(rows.start, rows.stop)
    r = None if radius is None else float(radius[where].mean())
    a = None if axis is None else float(axis[where].mean())
    found_r, found_a, depth = find_jet(ratio, r, a)
    x = at - 0.5 * (flat.size - 1)
    outside = np.abs(x - found_a) > 1.1 * found_r + 2.0
    level = float(ratio[outside].mean()) if outside.sum() > 3 else 1.0
    if not level > 0.0:
        level = max(float(ratio.mean()), 1e-6)
    thick = -np.log1p(-min(max(depth, 1e-3), 0.99)) / (2.0 * found_r)
    noise = np.sqrt(max(float(clean.mean()), 1.0)) / float(flat[lit].mean())
    sigmas = depth * np.sqrt(4.0 / 3.0 * found_r) / noise
    return 0.5 * (rows.start + rows.stop - 1), found_r, found_a, level, thick, sigmas


def _despiked(values: FloatArray) -> FloatArray:
    """Medians of five neighbours where a value lies far off them."""
    if values.size < 5:
        return values
    padded = np.pad(values, 2, mode="reflect", reflect_type="odd")
    median = np.median(np.lib.stride_tricks.sliding_window_view(padded, 5), axis=1)
    far = np.abs(values - median) > 3.0 + 0.05 * np.abs(median)
    return np.where(far, median, values)
