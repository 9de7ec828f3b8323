"""Strips of frames: a few bands of rows of each, kept while frames are added up, so that frames can be compared."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray

__all__ = ["Bands"]

_BANDS, _ROWS, _BINS = 4, 8, 256  # rows that are averaged, bins at most across the jet
_FRAMES = 2048  # of more, one of every so many is kept


@dataclass(frozen=True)
class Bands:
    """Where strips are taken.

    Attributes
    ----------
    starts : tuple of int
        First rows.
    rows, bins, wide : int
        Rows of a band, bins of a strip, columns of a bin.
    every : int
        One frame of so many is kept.
    """

    starts: tuple[int, ...]
    rows: int
    bins: int
    wide: int
    every: int

    @classmethod
    def of(cls, frames: int, rows: int, columns: int) -> "Bands":
        """Bands for so many frames of a shape."""
        high, wide = min(_ROWS, rows), -(-columns // _BINS)
        starts = np.unique(np.linspace(0, rows - high, _BANDS).astype(int))
        return cls(tuple(starts.tolist()), high, columns // wide, wide, -(-frames // _FRAMES))

    @property
    def pixels(self) -> int:
        """Pixels in a number."""
        return self.rows * self.wide

    def kept(self, start: int, stop: int) -> range:
        """Frames of a piece that are kept."""
        return range(start + -start % self.every, stop, self.every)

    def strips(self, frames: NDArray[Any], at: list[int], good: BoolArray | None = None) -> NDArray[np.float32]:
        """Means of the frames at some places of a piece, shape (places, bands, bins); NaN where nothing is good."""
        shape = (len(at), self.rows, self.bins, self.wide)
        out = np.empty((len(at), len(self.starts), self.bins), dtype=np.float32)
        for band, start in enumerate(self.starts):
            part = np.s_[:, start : start + self.rows, : self.bins * self.wide]
            seen = frames[part][at].reshape(shape)
            held = np.ones_like(seen, dtype=np.bool_) if good is None else good[part][at].reshape(shape)
            count = held.sum(axis=(1, 3))
            with np.errstate(over="ignore"):  # infinite: no light that can be compared
                total = np.sum(seen, axis=(1, 3), dtype=np.float64, where=held)
                out[:, band] = np.where(count > 0, total / np.maximum(count, 1), np.nan)
        return out
