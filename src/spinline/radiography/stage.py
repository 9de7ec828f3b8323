"""Where a stage really was: offsets of positions along a jet, told by the radii that two positions see at the same place.

A jet whose radius changes by R' along z, seen by positions a and b whose rows lie d_a and d_b farther along it than the stage
says, has

    R_a(z) - R_b(z) = R' (d_a - d_b),

which the overlap shows to a fraction of what a stage is good for. With d_k beforehand normal about 0, as `offset` says, and the
gaps' own noise, d is normal again, its mean and covariance in closed form. What no overlap tells is a shift of all positions
together, and everything where the jet does not thin.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray

__all__ = ["Seam", "stage_shifts"]


@dataclass(frozen=True)
class Seam:
    """What two neighbouring positions say of the rows that both see.

    Attributes
    ----------
    first, second : int
        Positions.
    chi_squared, blocks : float, int
        Of the differences of their mean fractions, their own errors taken; and how many.
    probability : float
        Of a larger one by chance; under 0.01 they do not agree.
    radius : float
        Mean difference of their radii over its standard deviation, the stage's taken in.
    radius_gap, radius_gap_std : float
        That difference, m, and its standard deviation from the counts alone.
    taper : float
        dR/dz there.
    """

    first: int
    second: int
    chi_squared: float
    blocks: int
    probability: float
    radius: float
    radius_gap: float
    radius_gap_std: float
    taper: float


def stage_shifts(std: FloatArray, seams: Sequence[Seam]) -> tuple[FloatArray, FloatArray]:
    """By how much positions lie farther along the jet than their offsets say, m, and the covariance of that.

    Parameters
    ----------
    std : ndarray, shape (positions,)
        Standard deviations of the offsets, m, >= 0; a position of 0 stays where it is.
    seams : sequence of Seam

    Returns
    -------
    mean, covariance : ndarray, shapes (positions,) and (positions, positions)
    """
    prior = np.diag(np.square(std))
    tied = [s for s in seams if s.taper != 0.0 and s.radius_gap_std > 0.0 and std[[s.first, s.second]].any()]
    if not tied:
        return np.zeros(std.size), prior
    turn = np.zeros((len(tied), std.size))
    for i, seam in enumerate(tied):
        turn[i, [seam.first, seam.second]] = seam.taper, -seam.taper
    noise = np.diag([s.radius_gap_std**2 for s in tied])
    gain = np.linalg.solve(turn @ prior @ turn.T + noise, turn @ prior).T
    gap = np.array([s.radius_gap for s in tied])
    return gain @ gap, prior - gain @ turn @ prior
