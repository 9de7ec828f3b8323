"""Any object that is a `Jet`, with what it does not say of itself found out from what it does say.

    r_0 = r(start)      v_0 = int dz/V / t(end)      the first place of V by bisection on a fine grid

Errors: v_0 to 1e-9 for a profile that is smooth on the scale of its length; a place to 1e-13 of the arc, where V rises.
"""

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss
from spinline.jetprofile.jet import METHODS
from spinline.jetprofile.lagrangian import LagrangianJet
from spinline.jetprofile.straight import StraightJet

__all__ = ["GivenJet", "complete"]

_SEARCHED = 4001  # places of the grid on which V is looked for
_FARTHEST = 1e6  # initial radii, of a jet without an end


class GivenJet(StraightJet):
    """A jet by an object's own methods.

    Parameters
    ----------
    jet : Jet
        See `spinline.jetprofile.jet`.

    Raises
    ------
    InputError
        For an initial radius or velocity that cannot be.
    """

    def __init__(self, jet: Any) -> None:
        self.jet = jet
        self.start, self.end = float(jet.start), float(jet.end)
        if not self.start < self.end:
            raise InputError("jet.end", "is not beyond its start", value=self.end, allowed=f"> {self.start:g} m")
        self.given: Literal["velocity", "radius"] = getattr(jet, "given", "velocity")
        radius = positive("jet.radius", float(getattr(jet, "initial_radius", jet.radius(self.start))), "m")
        self._far = min(self.end, self.start + _FARTHEST * radius)
        velocity = getattr(jet, "initial_velocity", None)
        rate = getattr(jet, "flow_rate", None)
        if rate is None:
            pace = self._pace() if velocity is None else float(velocity)
            rate = np.pi * radius**2 * positive("jet.initial_velocity", pace, "m/s")
        super().__init__(radius, float(rate))

    def radius(self, z: ArrayLike) -> FloatArray:
        """Jet radius in m at z (m), as the object says it."""
        return np.asarray(self.jet.radius(self._reduced(z) * self.initial_radius), dtype=np.float64)

    def stretch_ratio(self, z: ArrayLike) -> FloatArray:
        """Material stretch since the start, as the object says it."""
        return np.asarray(self.jet.stretch_ratio(self._reduced(z) * self.initial_radius), dtype=np.float64)

    def kinks(self) -> tuple[float, ...]:
        """Places where the profile is not smooth, if the object names any."""
        named = getattr(self.jet, "kinks", None)
        return tuple(named()) if callable(named) else ()

    def at(self, time: float | None = None) -> "GivenJet":
        """One moment of it."""
        return GivenJet(self.jet.at(time))

    def fields(self, place: FloatArray) -> dict[str, FloatArray]:
        """Further variables along the jet, if the object has any."""
        named = getattr(self.jet, "fields", None)
        return dict(named(place)) if callable(named) else {}

    def _parameters(self) -> dict[str, object]:
        return {"jet": self.jet}

    def _ratio(self, s: FloatArray) -> FloatArray:
        return real("jet.velocity_ratio", self.jet.velocity_ratio(s * self.initial_radius), above=0.0)

    def _slope(self, s: FloatArray) -> FloatArray:
        rate = np.asarray(self.jet.strain_rate(s * self.initial_radius), dtype=np.float64)
        value: FloatArray = rate * self.initial_radius / self.initial_velocity
        return value

    def _time(self, s: FloatArray) -> FloatArray:
        age = np.asarray(self.jet.residence_time(s * self.initial_radius), dtype=np.float64)
        value: FloatArray = age * self.initial_velocity / self.initial_radius
        return value

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        own = getattr(self.jet, "position_of", None)
        if callable(own):
            value: FloatArray = np.asarray(own(ratio), dtype=np.float64) / self.initial_radius
            return value
        z = self.start + (self._far - self.start) * np.linspace(0.0, 1.0, _SEARCHED) ** 2
        v = np.maximum.accumulate(np.asarray(self.jet.velocity_ratio(z), dtype=np.float64))
        target = np.atleast_1d(ratio)
        above = np.searchsorted(v, target)
        low, high = z[np.clip(above - 1, 0, z.size - 1)], z[np.clip(above, 0, z.size - 1)]
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = np.asarray(self.jet.velocity_ratio(middle)) < target
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        found: FloatArray = np.where(above < z.size, high, np.nan).reshape(np.shape(ratio)) / self.initial_radius
        return found

    def _pace(self) -> float:
        """v_0 from the time that the jet takes and its V: Gauss-Legendre on panels that widen downstream."""
        edges = self.start + (self._far - self.start) * np.linspace(0.0, 1.0, 401) ** 2
        nodes, weights = gauss(8)
        half = 0.5 * np.diff(edges)
        z = edges[:-1, np.newaxis] + half[:, np.newaxis] * (1 + nodes)
        slowness = 1 / np.asarray(self.jet.velocity_ratio(z.ravel()), dtype=np.float64).reshape(z.shape)
        taken = float(np.asarray(self.jet.residence_time(self._far)))
        return float(np.sum(half[:, np.newaxis] * weights * slowness)) / positive("jet.residence_time", taken, "s")


def complete(jet: Any) -> StraightJet | LagrangianJet:
    """The jet with all that a run asks of one, whatever it says of itself.

    Raises
    ------
    InputError
        For an object that is no `Jet`.
    """
    if isinstance(jet, StraightJet | LagrangianJet):
        return jet
    lacking = [name for name in METHODS if not callable(getattr(jet, name, None))]
    lacking += [
        name for name in ("start", "end") if not np.isreal(getattr(jet, name, None) or 0.0) or not hasattr(jet, name)
    ]
    if lacking:
        raise InputError(
            "jet",
            f"is no jet: it has no {', '.join(lacking)}",
            value=type(jet).__name__,
            allowed=", ".join((*METHODS, "start", "end")),
            remedy="see spinline.jetprofile.Jet",
        )
    return GivenJet(jet)
