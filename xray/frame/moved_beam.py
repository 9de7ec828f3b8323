"""Has the beam's structure moved since the flat? Stripes of a monochromator and edges of slits then stand beside themselves.

Counts over a flat that lies s pixels beside its beam are T F(x - s)/F(x): what is not smooth in them is what is not smooth in
the flat's own ratio to itself, moved. Among shifts along both axes the one that explains most is taken, with a free size: of
small shifts the pattern is the same.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["MovedBeam", "moved_beam"]

_SHIFTS = (0.5, 1.0, 2.0, 4.0)  # pixels, both ways
_SMOOTH = 7  # terms across a row: beam and jet
_LIT = 0.2  # of the usual light
_MOST = 2.0  # times a shift that was tried
_ROWS = 128  # that are looked at
_SHARE = 0.5  # of what is not smooth


@dataclass(frozen=True)
class MovedBeam:
    """Pixels that the beam moved across (and down) since the flat, and root mean square of what that makes of the counts."""

    across: float
    down: float
    size: float


def moved_beam(transmission: FloatArray, flat: FloatArray, good: BoolArray) -> MovedBeam | None:
    """The shift that explains most of what is not smooth in a transmission; None where that is less than half of it.

    Parameters
    ----------
    transmission, flat : ndarray, shape (rows, columns)
        Counts over the flat, to any level, and the flat.
    good : ndarray of bool, shape (rows, columns)
    """
    usual = float(np.median(flat[good])) if good.any() else 0.0
    use = good & (flat > _LIT * usual)
    if not usual > 0.0 or use.sum() < 4 * _SMOOTH or flat.shape[1] < 4 * _SMOOTH:
        return None
    basis, _ = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, flat.shape[1]), _SMOOTH - 1))
    filled = np.where(good & (flat > 0.0), flat, usual)
    level = float(np.median(transmission[use]))
    rows = np.unique(np.linspace(0, flat.shape[0] - 1, _ROWS).astype(int))
    use, still = use[rows], filled[rows]
    weight = np.where(use, still, 0.0)
    seen = _rough(transmission[rows] / level - 1.0, use, basis)
    whole = float(np.sum(weight * seen**2))
    best, found = _SHARE, None
    for axis in (1, 0) if flat.shape[0] >= 4 * _SMOOTH else (1,):
        for shift in (sign * s for s in _SHIFTS for sign in (-1.0, 1.0)):
            pattern = _rough(_shifted(filled, rows, shift, axis) / still - 1.0, use, basis)
            square = float(np.sum(weight * pattern**2))
            if not square > 0.0:
                continue
            size = float(np.sum(weight * pattern * seen)) / square
            share = size**2 * square / whole if whole > 0.0 else 0.0
            if share > best and 0.0 < size < _MOST:
                best = share
                rms = size * float(np.sqrt(square / np.sum(weight)))
                found = MovedBeam(size * shift * axis, size * shift * (1 - axis), rms)
    return found


def _rough(values: FloatArray, use: BoolArray, basis: FloatArray) -> FloatArray:
    """What is not smooth across the rows, 0 where nothing is used."""
    kept = np.where(use, values, 0.0)
    return np.where(use, kept - (kept @ basis) @ basis.T, 0.0)


def _shifted(flat: FloatArray, rows: NDArray[np.int64], shift: float, axis: int) -> FloatArray:
    """Some rows of the flat as it is `shift` pixels farther along an axis, straight between pixels."""
    at = np.clip((rows if axis == 0 else np.arange(flat.shape[1])) - shift, 0.0, flat.shape[axis] - 1.0)
    low = np.minimum(at.astype(int), flat.shape[axis] - 2)
    part = np.expand_dims(at - low, 1 - axis)
    of = flat if axis == 0 else flat[rows]
    return np.asarray(np.take(of, low, axis) * (1.0 - part) + np.take(of, low + 1, axis) * part)
