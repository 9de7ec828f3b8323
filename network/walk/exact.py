"""Exact moments of the end-to-end vector of a walk, no walking: sums over the segments.

Steps are independent, so cumulants add. With q_a = P+ + P-, m_a = P+ - P- of one segment (Eq. 34), in units of b:

    mean        sum m_a
    covariance  sum (q_a delta_ab - m_a m_b),   diagonal as q (1 - q) + 4 P+ P-, which does not cancel
    orientation O = (3 <n_z>/N_s - 1)/2, n_z the number of axial steps, a sum of Bernoulli variables

Valid for any N_s and any forces; costs O(N_s) for forces that vary, O(1) otherwise. At rest the standard deviation
per axis is xi_0/sqrt(3) on a mean of about xi_0.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.network._objects import instance
from spinline.network.walk.strand import Strand, step_probabilities

__all__ = ["WalkMoments", "walk_moments"]


@dataclass(frozen=True)
class WalkMoments:
    """Exact moments; axes x, y (lateral), z (axial), lengths in b.

    Attributes
    ----------
    segments : int
        N_s.
    mean : ndarray, shape (3,)
        Mean end-to-end vector: (xi_perp, xi_perp, xi_par)/b.
    covariance : ndarray, shape (3, 3)
        Of the end-to-end vector.
    skewness, excess_kurtosis : ndarray, shape (3,)
        Per axis; NaN where the variance underflows to 0.
    axial_steps, axial_steps_variance : float
        Of the number of steps along z, either sense.
    """

    segments: int
    mean: FloatArray
    covariance: FloatArray
    skewness: FloatArray
    excess_kurtosis: FloatArray
    axial_steps: float
    axial_steps_variance: float

    @property
    def relative_extension(self) -> FloatArray:
        """Mean end-to-end vector over the contour, each in [-1, 1]."""
        return self.mean / self.segments

    @property
    def mean_square(self) -> float:
        """``<R^2>`` in b^2."""
        return float(np.trace(self.covariance) + self.mean @ self.mean)

    @property
    def orientation(self) -> float:
        """Mean Hermans orientation, in [-1/2, 1]."""
        return (3 * self.axial_steps / self.segments - 1) / 2

    @property
    def orientation_std(self) -> float:
        """Standard deviation of the orientation of one strand."""
        return 1.5 * float(np.sqrt(self.axial_steps_variance)) / self.segments


def walk_moments(strand: Strand) -> WalkMoments:
    """Exact moments of a walk.

    Parameters
    ----------
    strand : Strand
        From `uniform_strand`, `affine_strand`, `varying_strand`, `hydrodynamic_strand` or `flow_strand(...).strand`.

    Returns
    -------
    WalkMoments

    Examples
    --------
    >>> from spinline.network.walk.strand import affine_strand
    >>> moments = walk_moments(affine_strand(20.0, 0.05))
    >>> round(float(moments.relative_extension[2]), 8), round(moments.orientation, 8)
    (0.82859435, 0.74906848)
    """
    instance("strand", strand, Strand)
    p = step_probabilities(strand.forces)
    plus, minus = p[:, 0::2], p[:, 1::2]
    moved = plus + minus
    rest = np.stack([moved[:, 1] + moved[:, 2], moved[:, 2] + moved[:, 0], moved[:, 0] + moved[:, 1]], axis=1)
    m = plus - minus
    variance = moved * rest + 4 * plus * minus
    up, down = rest + 2 * minus, rest + 2 * plus  # 1 - m and 1 + m
    third = plus * up**3 - rest * m**3 - minus * down**3
    fourth = plus * up**4 + rest * m**4 + minus * down**4 - 3 * variance**2
    times = strand.repeats
    covariance = 0.0 - times * (m.T @ m)
    np.fill_diagonal(covariance, times * variance.sum(axis=0))
    spread = np.diag(covariance)
    some = spread > 1e-150  # squares of less underflow
    safe = np.where(some, spread, 1.0)
    return WalkMoments(
        segments=strand.segments,
        mean=times * m.sum(axis=0),
        covariance=covariance,
        skewness=np.where(some, times * third.sum(axis=0) / safe**1.5, np.nan),
        excess_kurtosis=np.where(some, times * fourth.sum(axis=0) / safe**2, np.nan),
        axial_steps=float(times * moved[:, 2].sum()),
        axial_steps_variance=float(times * (moved[:, 2] * rest[:, 2]).sum()),
    )
