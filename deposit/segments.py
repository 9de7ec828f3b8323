"""Fibres as straight segments in the collector's frame, in order of touch-down.

A row stands alone (both its ends), so that rows can be cut, sorted, streamed and split over tiles. The volume of a row is
``pi radius^2 length`` with the *flight* length; ``excess = length / chord``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spinline.base.checks import BoolArray, FloatArray, positive, real
from spinline.base.errors import InputError

__all__ = ["Segments", "sound"]


@dataclass(frozen=True, eq=False)
class Segments:
    """Segments of laid fibres; arrays (segment,), SI.

    Attributes
    ----------
    x, y : ndarray
        Start of each, m: along the machine and across it, collector's frame.
    dx, dy : ndarray
        End less start, m.
    touch_time : ndarray
        When its end touched down, s.
    radius : ndarray
        Of the fibre when it landed, m.
    polymer_fraction : ndarray
        By volume, 1 when dry.
    length : ndarray
        Of the piece in flight, m.
    jet, fibre : ndarray of int32
    """

    x: FloatArray
    y: FloatArray
    dx: FloatArray
    dy: FloatArray
    touch_time: FloatArray
    radius: FloatArray
    polymer_fraction: FloatArray
    length: FloatArray
    jet: NDArray[np.int32]
    fibre: NDArray[np.int32]

    @classmethod
    def from_paths(
        cls,
        paths: Sequence[ArrayLike],
        radius: ArrayLike,
        *,
        touch_time: Sequence[ArrayLike] | None = None,
        polymer_fraction: float = 1.0,
    ) -> Self:
        """Fibres given as polylines, each laid after the one before.

        Parameters
        ----------
        paths : sequence of array_like, (n, 2)
            Corners in m; at least two each.
        radius : array_like
            One, or one per fibre, m.
        touch_time : sequence of array_like, (n,), optional
            s per corner. Default: the number of the corner in the order given.
        polymer_fraction : float

        Raises
        ------
        InputError
            For a path of fewer than two corners, or shapes that do not fit.
        """
        if not len(paths):
            raise InputError("paths", "is empty", remedy="give one fibre or more")
        corners = [real("paths", path, unit="m") for path in paths]
        for path in corners:
            if path.ndim != 2 or path.shape[1] != 2 or len(path) < 2:
                raise InputError("paths", "needs corners (n, 2), two or more", value=f"shape {path.shape}")
        radii = np.broadcast_to(real("radius", radius, above=0.0, unit="m"), (len(corners),))
        share = positive("polymer_fraction", polymer_fraction)
        counts = np.array([len(path) - 1 for path in corners])
        start = np.concatenate([path[:-1] for path in corners])
        step = np.concatenate([np.diff(path, axis=0) for path in corners])
        if touch_time is None:
            time = np.arange(1.0, len(start) + 1)
        else:
            time = np.concatenate([real("touch_time", moments, unit="s")[1:] for moments in touch_time])
            if time.shape != (len(start),):
                raise InputError("touch_time", "needs one time per corner", value=f"{time.size + len(corners)} times")
        which = np.repeat(np.arange(len(corners), dtype=np.int32), counts)
        return cls(
            start[:, 0],
            start[:, 1],
            step[:, 0],
            step[:, 1],
            time,
            radii[which],
            np.full(len(start), share),
            np.hypot(step[:, 0], step[:, 1]),
            np.zeros_like(which),
            which,
        )

    def __len__(self) -> int:
        return self.x.size

    @property
    def chord(self) -> FloatArray:
        """Laid length of each, m."""
        return np.hypot(self.dx, self.dy)

    @property
    def excess(self) -> FloatArray:
        """Flight length over chord: above 1 coils below the mesh, below 1 drawn; inf where the chord is nothing."""
        chord = self.chord
        with np.errstate(divide="ignore"):
            value: FloatArray = np.where(chord > 0, self.length / np.where(chord > 0, chord, 1.0), np.inf)
        return value

    @property
    def volume(self) -> FloatArray:
        """Of each as it landed, m3."""
        return np.pi * self.radius**2 * self.length

    @property
    def dry_volume(self) -> FloatArray:
        """Polymer in each, m3."""
        return self.volume * self.polymer_fraction

    @property
    def dry_radius(self) -> FloatArray:
        """``radius polymer_fraction^(1/2)``: once the solvent has left across the fibre, m."""
        return self.radius * np.sqrt(self.polymer_fraction)

    @property
    def angle(self) -> FloatArray:
        """Direction against the machine, rad in (-pi, pi]."""
        return np.arctan2(self.dy, self.dx)

    def take(self, rows: "BoolArray | NDArray[np.int64] | slice") -> Self:
        """The rows named, in that order."""
        return type(self)(*(getattr(self, column.name)[rows] for column in fields(self)))

    def sorted_by_time(self) -> Self:
        """In order of touch-down."""
        return self.take(np.argsort(self.touch_time, kind="stable"))

    @classmethod
    def join(cls, parts: "Sequence[Segments]") -> Self:
        """All rows of several, one after another; nothing for no parts."""
        if not parts:
            e, none = np.empty(0), np.empty(0, dtype=np.int32)
            return cls(e, e, e, e, e, e, e, e, none, none)
        return cls(*(np.concatenate([getattr(part, column.name) for part in parts]) for column in fields(cls)))


def sound(segments: Segments, name: str, first: int = 0) -> Segments:
    """The segments, if there can be such fibres: finite, of some radius, polymer in them.

    Parameters
    ----------
    segments : Segments
    name : str
        Of the file they stand in, or go to.
    first : int
        Number of the first row, for the message.

    Raises
    ------
    InputError
        With the row and its value.
    """
    s = segments
    with np.errstate(invalid="ignore"):
        rules = (
            *((column, np.isfinite(getattr(s, column)), "finite") for column in ("x", "y", "dx", "dy", "touch_time")),
            ("radius", np.isfinite(s.radius) & (s.radius > 0), "(0, inf) m"),
            ("polymer_fraction", (s.polymer_fraction > 0) & (s.polymer_fraction <= 1), "(0, 1]"),
            ("length", np.isfinite(s.length) & (s.length >= 0), "[0, inf) m"),
        )
    for column, good, allowed in rules:
        if not good.all():
            row = int(np.argmin(good))
            raise InputError(
                f"{name}: {column}",
                f"cannot be, in row {first + row}",
                value=float(getattr(s, column)[row]),
                allowed=allowed,
                remedy="lay the fibres again; fibres of your own: in metres, each with its radius",
            )
    return s
