"""Many straight jets of one law at once: the methods of a jet with a leading axis, one row a jet.

Places are arrays (rows,) or (rows, points), m. Ranges are checked by the callers; `usable` says which rows are within the
formulas' own.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray

__all__ = ["StraightJets"]


class StraightJets:
    """Jets of one law.

    Parameters
    ----------
    law : module or object
        With ``ratio``, ``slope``, ``time`` and ``inverse`` of s (initial radii) and the parameters, which broadcast.
    parameters : tuple of array_like, each (rows,) or a number
        After s, in the law's own order.
    radius, flow_rate : array_like
        r_0 (m) and Q (m3/s).
    onset : array_like
        Where the profile begins to thin, initial radii: its one kink; 0 for a smooth law.
    usable : array_like of bool
        Rows within the range of the law.
    """

    start = 0.0
    end = np.inf

    def __init__(
        self,
        law: Any,
        parameters: tuple[ArrayLike, ...],
        radius: ArrayLike,
        flow_rate: ArrayLike,
        onset: ArrayLike,
        usable: ArrayLike,
    ) -> None:
        self._law, self._parameters = law, tuple(np.asarray(p, dtype=np.float64) for p in parameters)
        self.initial_radius: FloatArray = np.asarray(radius, dtype=np.float64)
        self.flow_rate: FloatArray = np.asarray(flow_rate, dtype=np.float64)
        self.initial_velocity: FloatArray = self.flow_rate / (np.pi * self.initial_radius**2)
        self.onset: FloatArray = np.asarray(onset, dtype=np.float64)
        self.usable: BoolArray = np.asarray(usable, dtype=np.bool_)

    @property
    def scale(self) -> FloatArray:
        """Scale of a grid at the nozzle, initial radii, as `spinline.setup.grid.jet_grid` takes it."""
        return np.where(self.onset > 0, np.minimum(self.onset, 1.0), 1.0)

    def formula(self) -> tuple[ArrayLike, ArrayLike, ArrayLike]:
        """Offset, scale and exponent where ``V = max(offset + s/scale, 1)^exponent``, each (rows,) or a number."""
        found: tuple[ArrayLike, ArrayLike, ArrayLike] = self._law.formula(*self._parameters)
        return found

    def velocity_ratio(self, z: FloatArray) -> FloatArray:
        """``V = v / v_0``."""
        return self._call(self._law.ratio, z / self._tall(self.initial_radius, z))

    def stretch_ratio(self, z: FloatArray) -> FloatArray:
        """Material stretch: V."""
        return self.velocity_ratio(z)

    def velocity(self, z: FloatArray) -> FloatArray:
        """m/s."""
        value: FloatArray = self._tall(self.initial_velocity, z) * self.velocity_ratio(z)
        return value

    def radius(self, z: FloatArray) -> FloatArray:
        """M."""
        value: FloatArray = self._tall(self.initial_radius, z) / np.sqrt(self.velocity_ratio(z))
        return value

    def strain_rate(self, z: FloatArray) -> FloatArray:
        """1/s."""
        r0 = self._tall(self.initial_radius, z)
        value: FloatArray = self._tall(self.initial_velocity, z) / r0 * self._call(self._law.slope, z / r0)
        return value

    def residence_time(self, z: FloatArray) -> FloatArray:
        """S."""
        r0 = self._tall(self.initial_radius, z)
        value: FloatArray = r0 / self._tall(self.initial_velocity, z) * self._call(self._law.time, z / r0)
        return value

    def position_of(self, velocity_ratio: FloatArray) -> FloatArray:
        """First place where V is reached, m; NaN where never."""
        value: FloatArray = self.initial_radius * self._call(self._law.inverse, velocity_ratio)
        return value

    def steepest(self, length: FloatArray) -> FloatArray:
        """Largest dV/ds over a length (m): that of the laws here lies at an end of where they thin."""
        reduced = np.atleast_1d(length / self.initial_radius)
        at_end = self._call(self._law.slope, reduced)
        if not self.onset.any():
            return at_end
        onset = np.atleast_1d(self.onset)
        return np.where(onset <= reduced, np.maximum(at_end, self._call(self._law.slope, onset)), 0.0)

    def _call(self, function: Callable[..., FloatArray], x: FloatArray) -> FloatArray:
        return function(x, *(self._tall(p, x) for p in self._parameters))

    def _tall(self, values: FloatArray, like: FloatArray) -> FloatArray:
        """Values of the rows as a column where places have a second axis."""
        return np.reshape(values, (-1, 1)) if np.ndim(like) == 2 else values
