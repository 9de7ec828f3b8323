"""How far a jet leans in the plane of the image: the slope of its axis, row by row, from the track of all rows.

A row cuts a cylinder that leans by t wider than it is, by ``1/cos t``, while the chord along the beam at its axis is still
2 R: the section is an ellipse, that of a round jet of radius ``R/cos t`` with every path shorter by cos t. Taken for round, it
seems too thin for its width: the fraction is off by ``mu/D (1 - cos t)``, +0.036 at 15 degrees (PEO in water, 10 keV), and the
radius by as much of itself.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.xray.frame.track import Track

__all__ = ["Lean", "axis_lean"]

_HIGHEST = 6  # order of the curve through the axis
_FEWEST = 4  # rows
_LEAST_STD = 0.02  # pixels: of an axis, for what no row's noise says
_SEEN = 3.0  # standard deviations; less is no lean, and matters little
_FAR = 5.0  # robust standard deviations of a row that is left out


@dataclass(frozen=True, eq=False)
class Lean:
    """Slope of a jet's axis.

    Attributes
    ----------
    slope : ndarray, shape (rows,)
        Pixels aside from row to row: the tangent of the angle. 0 where it is not over its noise.
    std : float
        Standard deviation of the slope, a mean over rows.
    order : int
        Of the curve that the axis is taken for; 0 where it is not told.
    """

    slope: FloatArray
    std: float
    order: int

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
        return f"{low:+.2f} to {high:+.2f} degrees +/- {np.degrees(self.std):.2g}" if self.slope.any() else "none seen"


def axis_lean(track: Track) -> Lean:
    """Slope of the axis along a track: of the polynomial, of order 1 to 6, that the rows ask for (Schwarz's criterion)."""
    rows = track.axis.size
    use = track.found & np.isfinite(track.axis)
    if use.sum() < _FEWEST:
        return Lean(np.zeros(rows), 0.0, 0)
    x = np.linspace(-1.0, 1.0, rows)
    sd = np.maximum(np.where(np.isfinite(track.axis_std), track.axis_std, np.inf), _LEAST_STD)
    best: tuple[float, FloatArray, FloatArray, int] | None = None
    for order in range(1, min(_HIGHEST, int(use.sum()) // 8 + 1) + 1):
        kept = use.copy()
        for _ in range(3):
            columns = np.polynomial.legendre.legvander(x, order)
            weighted = columns[kept] / sd[kept, None]
            c, *_ = np.linalg.lstsq(weighted, track.axis[kept] / sd[kept], rcond=None)
            off = np.abs(track.axis - columns @ c) / sd
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
            best = float(score), np.asarray(c, dtype=np.float64), np.asarray(covariance, dtype=np.float64), order
    assert best is not None
    _, c, covariance, order = best
    basis = np.eye(order + 1)
    columns = np.stack([np.polynomial.legendre.legval(x, np.polynomial.legendre.legder(row)) for row in basis], axis=1)
    step = 2.0 / max(rows - 1, 1)
    slope, variance = columns @ c * step, np.einsum("ri,ij,rj->r", columns, covariance, columns) * step**2
    std = float(np.sqrt(variance.mean()))
    seen = np.where(
        slope**2 > _SEEN**2 * variance, slope**2 - variance, 0.0
    )  # noise makes the square of a slope too large
    return Lean(np.sign(slope) * np.sqrt(seen), std, order)
