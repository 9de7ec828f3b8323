"""The whole mat, chunk by chunk: totals, directions, diameters, areal density; memory does not grow with the mat."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from spinline.base.checks import FloatArray, number
from spinline.base.errors import InputError
from spinline.deposit.areal_density import DensityMap, add_segments
from spinline.deposit.segments import Segments, sound

__all__ = ["Rolled", "Source", "WholeMat", "chunks_of", "map_of", "survey"]

_LOG_BINS = 4000  # of diameters from 1 nm to 10 mm: 0.4 % each
_LOG_EDGES = np.logspace(-9, -2, _LOG_BINS + 1)
_ANGLES = 180


class Source(Protocol):
    """What a mat is read from: a file of fibres."""

    def chunks(self) -> Iterator[Segments]:
        """Segments, a bounded number at a time."""


@dataclass(frozen=True)
class Rolled:
    """Fibres of a drum rolled up again: layers that differ by whole turns share their place, first laid below.

    Attributes
    ----------
    source : Source or Segments
    circumference : float
        m.
    """

    source: "Source | Segments"
    circumference: float

    def chunks(self) -> Iterator[Segments]:
        """Chunks with x within one turn."""
        for s in chunks_of(self.source):
            yield replace(s, x=np.mod(s.x, self.circumference))


@dataclass
class WholeMat:
    """Sums over all segments of a mat.

    Attributes
    ----------
    segments : int
    length, chord, volume, dry_volume : float
        m and m3; `length` in flight, `chord` as laid.
    bounds : ndarray, (4,)
        Lowest and highest x, lowest and highest y, m.
    time : ndarray, (2,)
        First and last touch-down, s.
    angles : ndarray, (180,)
        Laid length per degree of direction, [-90, 90).
    diameters : ndarray, (4000,)
        Laid length per logarithmic bin of dry diameter, `diameter_edges` (m).
    coiled, drawn : float
        Share of the length with excess above 1.1 and below 0.9.
    """

    segments: int = 0
    length: float = 0.0
    chord: float = 0.0
    volume: float = 0.0
    dry_volume: float = 0.0
    bounds: FloatArray = field(default_factory=lambda: np.array([np.inf, -np.inf, np.inf, -np.inf]))
    time: FloatArray = field(default_factory=lambda: np.array([np.inf, -np.inf]))
    angles: FloatArray = field(default_factory=lambda: np.zeros(_ANGLES))
    diameters: FloatArray = field(default_factory=lambda: np.zeros(_LOG_BINS))
    coiled: float = 0.0
    drawn: float = 0.0
    jets: set[int] = field(default_factory=set)
    _double: complex = 0j
    _sums: FloatArray = field(default_factory=lambda: np.zeros(4))  # of length times d^1..d^4, less the d^2 scale

    @property
    def diameter_edges(self) -> FloatArray:
        """M."""
        return _LOG_EDGES

    @property
    def order_parameter(self) -> float:
        """S2, weighted by laid length."""
        return float(min(abs(self._double) / self.chord, 1.0)) if self.chord else float("nan")

    @property
    def director(self) -> float:
        """Main direction against the machine, rad."""
        return float(np.angle(self._double) / 2)

    def mean_diameter(self, weight: str = "length") -> float:
        """Mean dry diameter under a weight (`diameters`), m."""
        low = {"length": 0, "surface": 1, "volume": 2}[weight]
        below = self.length if low == 0 else self._sums[low - 1]
        return float(self._sums[low] / below)

    @property
    def diameter_deviation(self) -> float:
        """Standard deviation of the dry diameter, length-weighted, m."""
        mean = self.mean_diameter()
        return float(np.sqrt(max(self._sums[1] / self.length - mean**2, 0.0)))

    def add(self, s: Segments) -> None:
        """Count one chunk."""
        if not len(s):
            return
        chord, d, angle = s.chord, 2 * s.dry_radius, s.angle
        self.segments += len(s)
        self.length += float(s.length.sum())
        self.chord += float(chord.sum())
        self.volume += float(s.volume.sum())
        self.dry_volume += float(s.dry_volume.sum())
        x1, y1 = s.x + s.dx, s.y + s.dy
        for k, (low, high) in enumerate(((s.x, x1), (s.y, y1))):
            self.bounds[2 * k] = min(self.bounds[2 * k], low.min(), high.min())
            self.bounds[2 * k + 1] = max(self.bounds[2 * k + 1], low.max(), high.max())
        self.time[:] = min(self.time[0], s.touch_time.min()), max(self.time[1], s.touch_time.max())
        self._double += complex(np.sum(chord * np.exp(2j * angle)))
        folded = np.mod(angle + np.pi / 2, np.pi)
        self.angles += np.bincount(
            np.minimum((folded * (_ANGLES / np.pi)).astype(int), _ANGLES - 1), chord, minlength=_ANGLES
        )
        bins = np.clip(np.searchsorted(_LOG_EDGES, d, side="right") - 1, 0, _LOG_BINS - 1)
        self.diameters += np.bincount(bins, s.length, minlength=_LOG_BINS)
        self._sums += [float(np.sum(s.length * d**k)) for k in (1, 2, 3, 4)]
        with np.errstate(over="ignore"):
            excess = s.excess
        self.coiled += float(s.length[excess > 1.1].sum())
        self.drawn += float(s.length[excess < 0.9].sum())
        self.jets.update(np.unique(s.jet).tolist())


def chunks_of(fibres: "Segments | Source") -> Iterable[Segments]:
    """Chunks of a file, or of segments in memory."""
    if isinstance(fibres, Segments):
        return (sound(fibres.take(slice(k, k + 262144)), "fibres", k) for k in range(0, len(fibres), 262144))
    return fibres.chunks()


def survey(fibres: "Segments | Source") -> WholeMat:
    """One pass over all segments.

    Raises
    ------
    InputError
        If there is none, or none of any length.
    """
    mat = WholeMat()
    for chunk in chunks_of(fibres):
        mat.add(chunk)
    if not mat.segments:
        raise InputError("fibres", "is empty: nothing has landed", remedy="run the jet until it reaches the collector")
    if not mat.length > 0:
        raise InputError("fibres", "have no length: all lie on one point", remedy="lay a longer fibre")
    return mat


def map_of(fibres: "Segments | Source", whole: WholeMat, cells: int = 100, *, density: float = 1.0) -> DensityMap:
    """Polymer per cell over the whole mat, the longer side in `cells`; per volume (m3) or, with a density (kg/m3), per mass."""
    n = int(number("cells", cells, least=1, most=20000))
    x0, x1, y0, y1 = whole.bounds.tolist()
    span = max(x1 - x0, y1 - y0)
    if not span > 0:
        raise InputError("fibres", "all lie on one point", remedy="lay a longer fibre")
    cell = span / n * (1 + 1e-9)
    edges = []
    for low, high in ((x0, x1), (y0, y1)):
        count = max(int(np.ceil((high - low) / cell)), 1)
        middle = 0.5 * (low + high)
        edges.append(middle + cell * (np.arange(count + 1) - count / 2))
    content = np.zeros((edges[0].size - 1, edges[1].size - 1))
    outside = 0.0
    for chunk in chunks_of(fibres):
        outside += add_segments(content, chunk, density * chunk.dry_volume, edges[0], edges[1])
    return DensityMap(edges[0], edges[1], content, outside)
