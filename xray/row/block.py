"""Counts as they come, checked and summed: a block of rows of the same jet, bad pixels left out."""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.xray.row.forward import Detector

__all__ = ["smoothed_outliers", "summed_counts"]

_MOST = 1e100  # photons of a pixel; beyond, their squares leave double precision


def smoothed_outliers(counts: FloatArray) -> FloatArray:
    """Counts with lone pixels 8 standard deviations off the median of three put to that median: for a start, not for a fit."""
    before, after = np.concatenate((counts[:1], counts[:-1])), np.concatenate((counts[1:], counts[-1:]))
    median = np.maximum(np.minimum(before, after), np.minimum(np.maximum(before, after), counts))
    far = np.abs(counts - median) > 8.0 * np.sqrt(np.maximum(median, 1.0))
    return np.where(far, median, counts)


def summed_counts(
    counts: ArrayLike, detector: Detector, good: ArrayLike | None, saturation: float
) -> tuple[FloatArray, FloatArray]:
    """Counts summed over the good rows of each pixel, and how many these are."""
    n = detector.flat.size
    raw = np.asarray(counts)
    if raw.ndim not in (1, 2) or raw.size == 0 or raw.shape[-1] != n:
        raise InputError(
            "counts",
            "is not a row, or a block of rows, of flat's width",
            value=f"array of shape {raw.shape}",
            allowed=f"({n},) or (rows, {n})",
        )
    mask = np.ones(raw.shape, dtype=np.bool_) if good is None else np.asarray(good)
    if mask.dtype != np.bool_ or mask.shape not in (raw.shape, (n,)):
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
    if data.max() > _MOST:
        raise InputError(
            "counts",
            "are more photons than can be counted",
            value=float(data.max()),
            allowed=f"[0, {_MOST:g}]",
            remedy="give raw counts times the gain",
        )
    if (data >= saturation).any():
        raise InputError(
            "counts",
            f"{int((data >= saturation).sum())} pixels are saturated",
            value=float(data.max()),
            allowed=f"under {saturation:g}",
            remedy="mask them (good), or expose for less time",
        )
    if data.ndim == 1:
        return data, mask.astype(np.float64)
    return data.sum(axis=0), mask.sum(axis=0, dtype=np.float64)
