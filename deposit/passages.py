"""Passages of fibres through a window of the mat: polylines in order of landing, sampled evenly.

A window cuts fibres; what belongs to one fibre and hangs together is one passage. A periodic window takes whole fibres and
wraps them (no edges: for generated mats); an open one takes what crosses it and a margin.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray, number, positive
from spinline.base.errors import InputError
from spinline.base.kernels import njit
from spinline.deposit.segments import Segments

__all__ = ["Passages", "Window", "passages", "share_inside"]

_MOST = 400_000_000  # samples: 16 GB would be needed


@dataclass(frozen=True)
class Window:
    """Rectangle of a mat.

    Attributes
    ----------
    width, height : float
        Along the machine and across it, m.
    x, y : float
        Of its lower corner, m.
    periodic : bool
    """

    width: float
    height: float
    x: float = 0.0
    y: float = 0.0
    periodic: bool = False

    def __post_init__(self) -> None:
        positive("mat.window", self.width, "m")
        positive("mat.window", self.height, "m")

    @property
    def area(self) -> float:
        """m2."""
        return self.width * self.height


@dataclass(frozen=True, eq=False)
class Passages:
    """Samples along passages, in order of landing.

    Attributes
    ----------
    x, y, radius : ndarray, (sample,)
        Relative to the window's corner; m.
    offsets : ndarray of int, (passage + 1,)
        Passage k holds samples ``offsets[k]:offsets[k + 1]``.
    spacing : ndarray, (passage,)
        Arc between its samples, m.
    fibre : ndarray of int, (passage,)
    window : Window
    fibre_volume : float
        Polymer volume inside the window, overlaps of fibres counted twice, m3; of the laid chords.
    """

    x: FloatArray
    y: FloatArray
    radius: FloatArray
    offsets: NDArray[np.int64]
    spacing: FloatArray
    fibre: NDArray[np.int64]
    window: Window
    fibre_volume: float


def passages(segments: Segments, window: Window, step: float, *, margin: float = 0.0, dry: bool = True) -> Passages:
    """Cut fibres at a window and sample them evenly.

    Parameters
    ----------
    segments : Segments
        In any order; sorted by touch-down here.
    window : Window
    step : float
        Arc between samples, m; each passage takes a spacing just below.
    margin : float
        Beyond an open window, m, in which fibres are kept as well.
    dry : bool
        Fibres at their dry radius.

    Returns
    -------
    Passages

    Raises
    ------
    InputError
        Where no fibre crosses the window, or more samples are asked for than fit.
    """
    ds = positive("step", step, "m")
    radius = segments.dry_radius if dry else segments.radius
    if not window.periodic:
        inside_volume = float(np.sum(np.pi * radius**2 * segments.chord * share_inside(segments, window)))
        reach = float(radius.max(initial=0.0)) + number("margin", margin, least=0.0, unit="m")
        wide = Window(window.width + 2 * reach, window.height + 2 * reach, window.x - reach, window.y - reach)
        segments, keep = _clipped(segments, wide)
        radius = radius[keep]
        if not inside_volume > 0:
            segments, radius = segments.take(slice(0, 0)), radius[:0]
    chord = segments.chord
    real_ones = chord > 0
    segments, radius, chord = segments.take(real_ones), radius[real_ones], chord[real_ones]
    if not len(segments):
        raise InputError(
            "mat.window",
            "no fibre crosses it",
            value=(window.x, window.y, window.width, window.height),
            remedy="move it to where the fibres are, or lay longer",
        )
    order = np.lexsort((segments.touch_time, segments.fibre, segments.jet))
    s, radius, chord = segments.take(order), radius[order], chord[order]
    tolerance = 1e-3 * radius[1:] + 1e-6 * chord[1:]
    gap = np.hypot(s.x[1:] - (s.x[:-1] + s.dx[:-1]), s.y[1:] - (s.y[:-1] + s.dy[:-1]))
    breaks = (s.jet[1:] != s.jet[:-1]) | (s.fibre[1:] != s.fibre[:-1]) | (gap > tolerance)
    first = np.r_[0, np.flatnonzero(breaks) + 1, len(s)]
    by_time = np.argsort(s.touch_time[first[:-1]], kind="stable")
    arc = np.r_[0.0, np.cumsum(chord)]
    lengths = arc[first[1:]] - arc[first[:-1]]
    counts = np.maximum(np.ceil(lengths / ds).astype(np.int64), 1)
    if counts.sum() > _MOST:
        raise InputError(
            "step",
            f"asks for {counts.sum():.3g} samples",
            value=ds,
            remedy="take a smaller window, a shorter duration or coarser pixels",
        )
    offsets = np.r_[0, np.cumsum(counts[by_time])]
    out = np.empty((3, offsets[-1]))
    _sample(out, s.x - window.x, s.y - window.y, s.dx, s.dy, radius, chord, first, by_time, counts)
    if window.periodic:
        inside_volume = float(np.sum(np.pi * radius**2 * chord))
    return Passages(
        out[0],
        out[1],
        out[2],
        offsets,
        (lengths / counts)[by_time],
        s.fibre[first[:-1]][by_time].astype(np.int64),
        window,
        inside_volume,
    )


@njit(cache=True, error_model="numpy")
def _sample(
    out: FloatArray,
    x: FloatArray,
    y: FloatArray,
    dx: FloatArray,
    dy: FloatArray,
    radius: FloatArray,
    chord: FloatArray,
    first: NDArray[np.int64],
    by_time: NDArray[np.int64],
    counts: NDArray[np.int64],
) -> None:
    """Middle of each of `counts` equal pieces of every passage."""
    n = 0
    for k in by_time:
        start, stop, count = first[k], first[k + 1], counts[k]
        total = 0.0
        for j in range(start, stop):
            total += chord[j]
        j, passed = start, 0.0
        for i in range(count):
            at = (i + 0.5) / count * total
            while j < stop - 1 and passed + chord[j] < at:
                passed += chord[j]
                j += 1
            u = min((at - passed) / chord[j], 1.0)
            out[0, n], out[1, n], out[2, n] = x[j] + u * dx[j], y[j] + u * dy[j], radius[j]
            n += 1


def _clipped(s: Segments, window: Window) -> tuple[Segments, BoolArray]:
    """Segments cut at a window's edges, and which rows are left."""
    enter, leave = _inside(s, window)
    keep = leave > enter
    kept, start, share = s.take(keep), enter[keep], (leave - enter)[keep]
    return replace(
        kept,
        x=kept.x + start * kept.dx,
        y=kept.y + start * kept.dy,
        dx=share * kept.dx,
        dy=share * kept.dy,
        length=share * kept.length,
    ), keep


def share_inside(s: Segments, window: Window) -> FloatArray:
    """Part of each chord that is inside the window."""
    enter, leave = _inside(s, window)
    return np.maximum(leave - enter, 0.0)


def _inside(s: Segments, window: Window) -> tuple[FloatArray, FloatArray]:
    """Shares of the chord between which it is inside; outside, leave <= enter."""
    enter, leave = np.zeros(len(s)), np.ones(len(s))
    for start, step, low, size in ((s.x, s.dx, window.x, window.width), (s.y, s.dy, window.y, window.height)):
        safe = np.where(step != 0, step, 1.0)
        with np.errstate(over="ignore"):
            a, b = (low - start) / safe, (low + size - start) / safe
        inside = (start >= low) & (start <= low + size)
        enter = np.maximum(enter, np.where(step != 0, np.minimum(a, b), np.where(inside, 0.0, 1.0)))
        leave = np.minimum(leave, np.where(step != 0, np.maximum(a, b), np.where(inside, 1.0, 0.0)))
    return enter, leave
