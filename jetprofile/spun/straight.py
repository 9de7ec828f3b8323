"""The steady straight jet that a chain starts as, in samples along its axis."""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError

__all__ = ["StraightStart"]


@dataclass(frozen=True)
class StraightStart:
    """A steady straight jet along z >= 0 from the nozzle, as samples on an increasing axis (SI).

    Attributes
    ----------
    axis, radius, velocity, axial, radial, line_charge : ndarray
        z in m from where the chain starts, r in m, v in m/s, A_zz, A_rr, charge per length in C/m.
    """

    axis: FloatArray
    radius: FloatArray
    velocity: FloatArray
    axial: FloatArray
    radial: FloatArray
    line_charge: FloatArray

    def __post_init__(self) -> None:
        sizes = {np.shape(v) for v in vars(self).values()}
        if len(sizes) != 1 or self.axis.ndim != 1 or self.axis.size < 4:
            raise InputError("start", "needs the same number of samples, four or more, of every quantity")
        if self.axis[0] != 0.0 or not (np.diff(self.axis) > 0).all():
            raise InputError("start", "needs an axis that rises from 0")
        if not all(np.isfinite(v).all() for v in vars(self).values()) or not (self.radius > 0).all():
            raise InputError("start", "has values that are no numbers, or no radius")
