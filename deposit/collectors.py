"""Where the jet lands: a plate, a belt or a drum, and the frame the fibres keep.

Laboratory frame of the bead jets: x the spinning axis from the nozzle on, y along the machine, z across it. Gap
``g > 0`` in flight. A fibre is stored once, at touch-down, where its material point stays for ever: *machine* and *cross*
coordinates X, Y of the moving collector::

    plate  g = d - x                       X = y
    belt   g = d - x                       X = y - V_b t          (the belt runs towards +y at V_b)
    drum   g = |(x, y) - (x_D, y_D)| - R_D X = R_D (beta - omega t),  x = x_D - R_D cos beta,  y = y_D + R_D sin beta

Y = z in all. Where a material point is later is a function of its X (`Drum.position`), Eqs. (46)-(47); psi_C is not wrapped:
layers that share a place keep different psi_C. **Eq. (47) as printed** returns ``z_touch - R_D cos beta_touch`` at the moment
of touch-down, not z_touch: its z_touch must be the position of the drum's axis, which is how it is written here.

References
----------
Review Eqs. (46), (47); Ghosal, Sinha-Ray, Yarin, Pourdeyhimi, Polymer 105, 255 (2016).
"""

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError

__all__ = ["Belt", "Collector", "Drum", "Plate", "collector"]

_FASTEST = 1e4  # m/s


@runtime_checkable
class Collector(Protocol):
    """A surface that takes the jet: the gap to it, its own speed, and its frame."""

    @property
    def kind(self) -> str:
        """Word for it: plate, belt, drum."""

    @property
    def surface_speed(self) -> float:
        """Speed of the surface along the machine, m/s."""

    def gap(self, position: ArrayLike) -> FloatArray:
        """Signed distance to the surface, m: positive in flight; position (..., 3)."""

    def laid(self, position: ArrayLike, time: ArrayLike) -> FloatArray:
        """Machine and cross coordinates (..., 2) of what touches at `position` (..., 3) and `time`."""

    def surface_velocity(self, position: ArrayLike) -> FloatArray:
        """Velocity of the surface at `position`, (..., 3): the boundary condition of the jet's landed end."""


@dataclass(frozen=True)
class Plate:
    """Resting plate across the spinning axis at `distance` (m, > 0) from the nozzle."""

    distance: float
    kind: str = field(default="plate", init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "distance", positive("collector.distance", self.distance, "m"))

    @property
    def surface_speed(self) -> float:
        """0."""
        return 0.0

    def gap(self, position: ArrayLike) -> FloatArray:
        """``d - x``, m."""
        return self.distance - _points(position)[..., 0]

    def laid(self, position: ArrayLike, time: ArrayLike) -> FloatArray:
        """(y, z)."""
        return _points(position)[..., 1:].copy()

    def surface_velocity(self, position: ArrayLike) -> FloatArray:
        """0."""
        return np.zeros_like(_points(position))


@dataclass(frozen=True)
class Belt:
    """Flat belt at `distance` (m) that runs towards +y at `speed` (m/s, either sign)."""

    distance: float
    speed: float
    kind: str = field(default="belt", init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "distance", positive("collector.distance", self.distance, "m"))
        object.__setattr__(
            self, "speed", number("collector.speed", self.speed, least=-_FASTEST, most=_FASTEST, unit="m/s")
        )

    @property
    def surface_speed(self) -> float:
        """V_b, m/s."""
        return self.speed

    def gap(self, position: ArrayLike) -> FloatArray:
        """``d - x``, m."""
        return self.distance - _points(position)[..., 0]

    def laid(self, position: ArrayLike, time: ArrayLike) -> FloatArray:
        """(y - V_b t, z): the place on the belt."""
        out = _points(position)[..., 1:].copy()
        out[..., 0] -= self.speed * real("time", time)
        return out

    def position(self, laid: ArrayLike, time: ArrayLike) -> FloatArray:
        """Laboratory position (..., 3) at `time` of what was laid at (..., 2)."""
        place = real("laid", laid)
        moved = place[..., 0] + self.speed * real("time", time)
        across = np.broadcast_to(place[..., 1], moved.shape)
        return np.stack([np.full_like(moved, self.distance), moved, across], axis=-1)

    def surface_velocity(self, position: ArrayLike) -> FloatArray:
        """(0, V_b, 0)."""
        out = np.zeros_like(_points(position))
        out[..., 1] = self.speed
        return out


@dataclass(frozen=True)
class Drum:
    """Drum of `radius` R_D (m), its axis across the machine (along z, parallel to a nosepiece).

    Attributes
    ----------
    distance : float
        Of the drum's nearest line from the nozzle, m: the axis is at ``x_D = distance + radius``.
    rotation : float
        omega, rad/s; positive: the surface facing the nozzle runs towards +y.
    radius : float
        R_D, m.
    offset : float
        y of the axis, m.
    """

    distance: float
    rotation: float
    radius: float
    offset: float = 0.0
    kind: str = field(default="drum", init=False)

    def __post_init__(self) -> None:
        for name, unit in (("distance", "m"), ("radius", "m")):
            object.__setattr__(self, name, positive(f"collector.{name}", getattr(self, name), unit))
        object.__setattr__(self, "rotation", number("collector.rotation", self.rotation, unit="rad/s"))
        number("collector.surface_speed", self.surface_speed, least=-_FASTEST, most=_FASTEST, unit="m/s")
        object.__setattr__(self, "offset", number("collector.offset", self.offset, unit="m"))

    @property
    def surface_speed(self) -> float:
        """Omega R_D, m/s."""
        return self.rotation * self.radius

    @property
    def axis(self) -> float:
        """x_D, m: the z_D of the corrected Eq. (47)."""
        return self.distance + self.radius

    def gap(self, position: ArrayLike) -> FloatArray:
        """Distance to the axis less R_D, m."""
        p = _points(position)
        return np.hypot(p[..., 0] - self.axis, p[..., 1] - self.offset) - self.radius

    def angle(self, position: ArrayLike) -> FloatArray:
        """Beta of a laboratory position, rad: 0 towards the nozzle."""
        p = _points(position)
        return np.arctan2(p[..., 1] - self.offset, self.axis - p[..., 0])

    def laid(self, position: ArrayLike, time: ArrayLike) -> FloatArray:
        """``(R_D (beta_touch - omega t_touch), z)``, unwrapped."""
        along = self.radius * (self.angle(position) - self.rotation * real("time", time))
        return np.stack([along, np.broadcast_to(_points(position)[..., 2], along.shape)], axis=-1)

    def circumferential(self, laid: ArrayLike, time: ArrayLike) -> FloatArray:
        """psi_C of Eq. (46) at `time`, m, not wrapped."""
        return np.asarray(real("laid", laid)[..., 0] + self.surface_speed * real("time", time))

    def position(self, laid: ArrayLike, time: ArrayLike) -> FloatArray:
        """Laboratory position (..., 3) at `time`: Eq. (47), with the axis in place of z_touch."""
        beta = self.circumferential(laid, time) / self.radius
        across = np.broadcast_to(real("laid", laid)[..., 1], beta.shape)
        x, y = self.axis - self.radius * np.cos(beta), self.offset + self.radius * np.sin(beta)
        return np.stack([x, y, across], axis=-1)

    def surface_velocity(self, position: ArrayLike) -> FloatArray:
        """``omega R_D`` along the circumference."""
        beta = self.angle(position)
        zero = np.zeros_like(beta)
        return self.surface_speed * np.stack([np.sin(beta), np.cos(beta), zero], axis=-1)


def collector(
    kind: str,
    distance: float,
    *,
    speed: float | None = None,
    rotation: float | None = None,
    radius: float | None = None,
) -> Plate | Belt | Drum:
    """Collector by its word.

    Parameters
    ----------
    kind : {"plate", "belt", "drum"}
    distance : float
        From the nozzle, m.
    speed : float, optional
        Of a belt, or of a drum's surface in place of its rotation, m/s.
    rotation : float, optional
        Of a drum, rad/s.
    radius : float, optional
        Of a drum, m.

    Raises
    ------
    InputError
        For an unknown kind, something missing, or something that this kind does not have.
    """
    if kind not in ("plate", "belt", "drum"):
        raise InputError("collector.kind", "is not known", value=kind, allowed='"plate", "belt", "drum"')
    given = {"speed": speed, "rotation": rotation, "radius": radius}
    takes = {"plate": (), "belt": ("speed",), "drum": ("speed", "rotation", "radius")}[kind]
    for name, value in given.items():
        if value is not None and name not in takes:
            raise InputError(f"collector.{name}", f"does not belong to a {kind}", value=value, remedy="take it out")
    if kind == "plate":
        return Plate(distance)
    if kind == "belt":
        if speed is None:
            raise InputError("collector.speed", "is missing", remedy="give the speed of the belt")
        return Belt(distance, speed)
    if radius is None or (speed is None) == (rotation is None):
        raise InputError("collector", "of kind drum needs its radius, and one of rotation and speed", value=given)
    r = positive("collector.radius", radius, "m")
    return Drum(distance, rotation if rotation is not None else number("collector.speed", speed) / r, r)


def _points(position: ArrayLike) -> FloatArray:
    p = real("position", position)
    if not p.ndim or p.shape[-1] != 3:
        raise InputError("position", "needs three coordinates in its last axis", value=f"shape {p.shape}")
    return p
