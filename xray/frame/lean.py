"""How far a jet leans in the plane of the image: the slope of its axis, row by row, from the track of all rows.

A row cuts a cylinder that leans by t wider than it is, by ``1/cos t``, while the chord along the beam at its axis is still
2 R: the section is an ellipse, that of a round jet of radius ``R/cos t`` with every path shorter by cos t. Taken for round, it
seems too thin for its width: the fraction is off by ``mu/D (1 - cos t)``, +0.036 at 15 degrees (PEO in water, 10 keV), and the
radius by as much of itself.

A row of a jet that also thins meets it farther along on the one side than on the other: ``R(s)^2 - d^2`` is still quadratic
in x, its paths are those of a round section, but the middle of that section lies aside of the axis by

    w w' sin t cos t,

with w(y) half the section's width, and the section is a little wider for its height:

    height/width = cos t (1 - sin^2 t cos^2 t (w^2)''/2)^(1/2).

The first is taken off before the slope is, the second goes into it: `Lean.cosine` is height over width. At 12 degrees and R' =
-0.08 they are 0.003 and 0.002 in the fraction.

A jet that bends, to a circle of radius R/k, is cut in no ellipse: by fits to exact sections its paths seem shorter by
``k^2 tan^2 t (1 + tan^2 t)/2``, and the middle lies ``0.4 k R tan^2 t/cos t`` aside. Neither is taken off, for the second
derivative of an axis is too uncertain; `Lean.bend` says how much there is. The axis is followed by a polynomial, of order 6 at
most unless that leaves it.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.xray.frame.track import Track

__all__ = ["Lean", "axis_lean"]

_HIGHEST = 6  # order of the curve through the axis
_HIGHEST_BENT = 24  # where that leaves the axis by
_OFF = 3.0  # its errors, squared, in the mean
_END = 0.1  # of the rows: towards the ends the curve hardly tells how it bends
_FEWEST = 4  # rows
_LEAST_STD = 0.02  # pixels: of an axis, for what no row's noise says
_SEEN = 3.0  # standard deviations; less is no lean, and matters little
_TURNS = 2  # of the axis, the section's middle and the lean
_MOST_BENT = 0.1  # beyond, a section is no ellipse
_FAR = 5.0  # robust standard deviations of a row that is left out


@dataclass(frozen=True, eq=False)
class Lean:
    """Slope of a jet's axis.

    Attributes
    ----------
    slope : ndarray, shape (rows,)
        Pixels aside from row to row: the tangent of the angle at which a jet that does not thin has the same sections. 0 where
        it is not over its noise.
    std : float
        Standard deviation of the slope, a mean over rows.
    order : int
        Of the curve that the axis is taken for; 0 where it is not told.
    bend : float
        Largest radius of the jet over the radius of the circle that it bends to; 0 where a polynomial of order 6 follows it.
    bend_error : float
        Relative error that this may leave on the paths, where it is largest.
    """

    slope: FloatArray
    std: float
    order: int
    bend: float = 0.0
    bend_error: float = 0.0

    @property
    def cosine(self) -> FloatArray:
        """Cosine of the angle in every row."""
        return np.asarray(1.0 / np.hypot(1.0, self.slope))

    @property
    def degrees(self) -> tuple[float, float]:
        """The smallest and largest angle."""
        angle = np.degrees(np.arctan(self.slope))
        return float(angle.min()), float(angle.max())

    @property
    def path_std(self) -> float:
        """Relative standard deviation of the paths through the jet: of cos t."""
        return float(np.sqrt(np.mean((self.slope / (1.0 + self.slope**2) * self.std) ** 2)))

    def words(self) -> str:
        """What was found."""
        if not self.order:
            return "not told: too few rows show the jet"
        low, high = self.degrees
        bends = f", bending to {1.0 / self.bend:.2g} of its radii" if self.bend > 0 else ""
        seen = f"{low:+.2f} to {high:+.2f} degrees +/- {np.degrees(self.std):.2g}{bends}"
        return seen if self.slope.any() else "none seen"


def axis_lean(track: Track) -> Lean:
    """Slope of the axis along a track: of the polynomial, of order 1 to 6, that the rows ask for (Schwarz's criterion)."""
    rows = track.axis.size
    use = track.found & np.isfinite(track.axis)
    if use.sum() < _FEWEST:
        return Lean(np.zeros(rows), 0.0, 0)
    sd = np.maximum(np.where(np.isfinite(track.axis_std), track.axis_std, np.inf), _LEAST_STD)
    wide = np.maximum(np.where(np.isfinite(track.radius_std), track.radius_std, np.inf), _LEAST_STD)
    squared = _curve(track.radius**2, 2.0 * track.radius * wide, use)
    thinning = 0.5 * squared.slope(rows)
    axis, found = track.axis, _curve(track.axis, sd, use, _HIGHEST_BENT)
    if found.seen(rows).any():
        for _ in range(_TURNS):
            lean = found.slope(rows)
            axis = track.axis - thinning * lean / (1.0 + lean**2)
            found = _curve(axis, sd, use, _HIGHEST_BENT)
    slope = found.seen(rows)
    cosine = 1.0 / (1.0 + slope**2)  # squared
    bent = 0.5 * (1.0 - cosine) * cosine * squared.slope(rows, 2)
    cosine = cosine * (1.0 - np.where(np.abs(bent) < _MOST_BENT, bent, 0.0))
    slope = np.sign(slope) * np.sqrt(np.maximum(1.0 / cosine - 1.0, 0.0))
    return Lean(slope, float(np.sqrt(found.variance(rows).mean())), found.order, *_bend(found, track.radius))


def _bend(axis: "_Curve", wide: FloatArray) -> tuple[float, float]:
    """`Lean.bend` and what it does to the paths; `wide` is half of the jet's section, ``1/cos t`` of its radius."""
    if axis.order <= _HIGHEST:
        return 0.0, 0.0
    tangent = axis.slope(wide.size) ** 2
    bend = wide * np.abs(axis.slope(wide.size, 2)) / (1.0 + tangent) ** 2
    end = int(_END * wide.size)
    inside = slice(end, wide.size - end)
    shorter = 0.5 * bend**2 * tangent * (1.0 + tangent)
    return float(np.nanmax(bend[inside])), float(np.nanmax(shorter[inside]))


@dataclass(frozen=True, eq=False)
class _Curve:
    """A polynomial along the rows: Legendre coefficients on [-1, 1], and their covariance."""

    coefficients: FloatArray
    covariance: FloatArray

    @property
    def order(self) -> int:
        return self.coefficients.size - 1

    def _columns(self, rows: int, times: int = 1) -> FloatArray:
        """Derivatives of the Legendre polynomials from row to row."""
        x, basis = np.linspace(-1.0, 1.0, rows), np.eye(self.order + 1)
        columns = [np.polynomial.legendre.legval(x, np.polynomial.legendre.legder(row, times)) for row in basis]
        return np.asarray(np.stack(columns, axis=1) * (2.0 / max(rows - 1, 1)) ** times, dtype=np.float64)

    def slope(self, rows: int, times: int = 1) -> FloatArray:
        """Change from row to row; or of that, for `times` = 2."""
        return np.asarray(self._columns(rows, times) @ self.coefficients)

    def variance(self, rows: int) -> FloatArray:
        """Of the slope."""
        columns = self._columns(rows)
        return np.asarray(np.einsum("ri,ij,rj->r", columns, self.covariance, columns))

    def seen(self, rows: int) -> FloatArray:
        """The slope where it is over its noise, which makes the square of it too large; 0 elsewhere."""
        slope, variance = self.slope(rows), self.variance(rows)
        seen = np.where(slope**2 > _SEEN**2 * variance, slope**2 - variance, 0.0)
        return np.asarray(np.sign(slope) * np.sqrt(seen))


def _curve(values: FloatArray, sd: FloatArray, use: BoolArray, bent: int = _HIGHEST) -> _Curve:
    """The polynomial, of order 1 to 6, that values with these errors ask for, or of up to `bent` where that leaves them;
    values far off it are left out.
    """
    x = np.linspace(-1.0, 1.0, values.size)
    best: tuple[float, _Curve] | None = None
    left = np.inf  # mean square of what the best one leaves
    for order in range(1, min(bent, int(use.sum()) // 8 + 1) + 1):
        if order > _HIGHEST and left < _OFF:  # more would follow noise, and what a bend does to the sections
            break
        kept = use.copy()
        columns = np.polynomial.legendre.legvander(x, order)
        for _ in range(3):
            weighted = columns[kept] / sd[kept, None]
            c, *_ = np.linalg.lstsq(weighted, values[kept] / sd[kept], rcond=None)
            off = np.abs(values - columns @ c) / sd
            spread = max(1.4826 * float(np.median(off[kept])), 1.0)
            new = use & (off < _FAR * spread)
            if (new == kept).all() or new.sum() <= order + 2:
                break
            kept = new
        chi = float((off[kept] ** 2).sum())
        freedom = max(int(kept.sum()) - order - 1, 1)
        covariance = np.linalg.pinv(weighted.T @ weighted) * max(chi / freedom, 1.0)
        score = chi + (order + 1) * np.log(kept.sum())
        if best is None or score < best[0] - 6.0:
            left = chi / freedom
            best = float(score), _Curve(np.asarray(c, dtype=np.float64), np.asarray(covariance, dtype=np.float64))
    assert best is not None
    return best[1]
