"""What every straight steady jet has in common.

A jet of initial radius r_0 carries the flow rate Q: ``v_0 = Q / (pi r_0^2)``, ``s = z / r_0``, ``V = v / v_0``
and, volume being conserved, ``r = r_0 V^(-1/2)``. In a straight steady jet the material stretch is V itself.
"""

from abc import ABC, abstractmethod
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.jetprofile.jet import Jet

__all__ = ["Jet", "StraightJet"]

_FARTHEST = 1e50  # in initial radii; V stays below 1e300


class StraightJet(ABC):
    """A steady jet along z, given by V(s), its slope, its time and its inverse.

    Parameters
    ----------
    radius : float
        Initial radius r_0 in m, > 0.
    flow_rate : float
        Q in m3/s, > 0.

    Attributes
    ----------
    initial_radius, flow_rate, initial_velocity : float
        r_0 (m), Q (m3/s), v_0 = Q / (pi r_0^2) (m/s).
    start, end : float
        Range of z in m where the profile is defined.
    given : {"velocity", "radius"}
        What the profile was given as: kept when the jet loses volume by evaporation.
    time : None
        It is steady.
    """

    given: Literal["velocity", "radius"] = "velocity"
    time: None = None
    start: float = 0.0
    end: float = np.inf

    def __init__(self, radius: float, flow_rate: float) -> None:
        self.initial_radius = float(real("radius", positive("radius", radius, "m"), least=1e-15, most=1e3, unit="m"))
        self.flow_rate = float(
            real("flow_rate", positive("flow_rate", flow_rate, "m3/s"), least=1e-60, most=1e6, unit="m3/s")
        )
        self.initial_velocity = self.flow_rate / (np.pi * self.initial_radius**2)

    def velocity_ratio(self, z: ArrayLike) -> FloatArray:
        """``V = v / v_0`` at z (m)."""
        return self._ratio(self._reduced(z))

    def velocity(self, z: ArrayLike) -> FloatArray:
        """Axial velocity in m/s at z (m)."""
        return self.initial_velocity * self.velocity_ratio(z)

    def radius(self, z: ArrayLike) -> FloatArray:
        """Jet radius in m at z (m)."""
        value: FloatArray = self.initial_radius / np.sqrt(self.velocity_ratio(z))
        return value

    def strain_rate(self, z: ArrayLike) -> FloatArray:
        """``dv/dz`` in 1/s at z (m)."""
        return self.initial_velocity / self.initial_radius * self._slope(self._reduced(z))

    def stretch_ratio(self, z: ArrayLike) -> FloatArray:
        """Material stretch since the start: V, in a straight steady jet."""
        return self.velocity_ratio(z)

    def residence_time(self, z: ArrayLike) -> FloatArray:
        """Time in s that the solution has taken from the start to z (m)."""
        return self.initial_radius / self.initial_velocity * self._time(self._reduced(z))

    def position_of(self, velocity_ratio: ArrayLike) -> FloatArray:
        """First position in m where V is reached; NaN where the profile never reaches it."""
        v = real("velocity_ratio", velocity_ratio, above=0.0)
        return self.initial_radius * self._inverse(v)

    def at(self, time: float | None = None) -> Self:
        """The jet itself: it is steady."""
        return self

    def fields(self, place: FloatArray) -> dict[str, FloatArray]:
        """Further variables along the jet, by their names in a result; none."""
        return {}

    def numbers(self) -> dict[str, float]:
        """Scalars of a result that only this jet has, by name; none."""
        return {}

    def words(self) -> dict[str, str]:
        """Attributes of a result that only this jet has; none."""
        return {}

    def remarks(self) -> list[str]:
        """What is odd about this jet, in sentences; nothing."""
        return []

    def kinks(self) -> tuple[float, ...]:
        """Places where the profile is not smooth, in initial radii from `start`."""
        return ()

    def formula(self) -> tuple[float, float, float] | None:
        """Offset, scale and exponent where ``V = max(offset + s/scale, 1)^exponent``, s from `start`; None elsewhere."""
        return None

    def _reduced(self, z: ArrayLike) -> FloatArray:
        most = min(self.end, _FARTHEST * self.initial_radius)
        return real("z", z, least=self.start, most=most, unit="m") / self.initial_radius

    def __repr__(self) -> str:
        shown = ", ".join(f"{key}={value!r}" for key, value in self._parameters().items())
        return f"{type(self).__name__}({shown})"

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))

    @abstractmethod
    def _parameters(self) -> dict[str, object]:
        """Constructor arguments."""

    @abstractmethod
    def _ratio(self, s: FloatArray) -> FloatArray:
        """V(s)."""

    @abstractmethod
    def _slope(self, s: FloatArray) -> FloatArray:
        """dV/ds."""

    @abstractmethod
    def _time(self, s: FloatArray) -> FloatArray:
        """Integral of ds / V from the start."""

    @abstractmethod
    def _inverse(self, ratio: FloatArray) -> FloatArray:
        """First s where V is reached, NaN where never."""
