"""What a material element of a steady jet goes through, as evaporation and drying need it.

An element whose stretch is Lambda loses volume in proportion to its length: with W the part of its volume left,
``dW/dt = -(D_a Sh dC / r_0^2) Lambda``. In a steady jet ``Lambda dt = dx / v_0`` exactly, straight or bent, x being the
distance along the jet: what passes is what was fed. So one path serves both.

A jet is *given* by its velocity (power laws, velocity tables, bead jets) or by its radius (measured profiles). When it
dries, what was given is kept and the other follows: a measured radius already shows the loss, and then ``v = F Q/(pi
r^2)``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, positive, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss

__all__ = ["BeadJet", "ElementPath", "Given", "SteadyJet", "bead_path", "straight_path"]

Given = Literal["velocity", "radius"]
Along = Callable[[FloatArray], FloatArray]


class SteadyJet(Protocol):
    """A straight steady jet, as `spinline.jetprofile` makes them."""

    initial_radius: float
    initial_velocity: float
    start: float
    end: float

    def velocity_ratio(self, z: ArrayLike, /) -> FloatArray:
        """``V = v / v_0`` at z (m)."""

    def kinks(self) -> tuple[float, ...]:
        """Places where the profile is not smooth, in initial radii from `start`."""


class BeadJet(Protocol):
    """One moment of a bead jet, elements along its arc."""

    @property
    def initial_radius(self) -> float:
        """r_0, m."""

    @property
    def arc_length(self) -> FloatArray:
        """Arc from the nozzle to the middle of each element, m."""

    @property
    def bead_velocity(self) -> FloatArray:
        """Speed of each bead, m/s."""

    @property
    def usable(self) -> BoolArray:
        """Elements that count."""

    @property
    def cross_velocity(self) -> FloatArray | None:
        """Speed of each element across its own axis, m/s; None where it is not known."""

    def stretch_ratio(self, arc: ArrayLike, /) -> FloatArray:
        """Material stretch at an arc length (m)."""


@dataclass(frozen=True, eq=False)
class ElementPath:
    """The way of a material element, and what is known along it.

    Attributes
    ----------
    position : ndarray, (n,)
        Where results are wanted, m along the jet, strictly increasing.
    start : float
        Where the element sets out, m.
    initial_radius : float
        r_0, m.
    stretch, speed, exposure : callable
        Lambda, velocity (m/s) without loss, and ``Lambda dt/dx`` (s/m) at positions.
    breaks : ndarray
        Positions where these are not smooth, m.
    given : {"velocity", "radius"}
        What stays as it is when the jet loses volume.
    cross_flow : callable, optional
        Speed of the jet across its own axis at positions (m/s), against the air where `slip` is given: a bending jet's; None
        where it has none.
    slip : callable, optional
        Speed along the axis against air that moves by a field of its own (m/s): a blown jet's, which takes no wind beside it.
    """

    position: FloatArray
    start: float
    initial_radius: float
    stretch: Along
    speed: Along
    exposure: Along
    breaks: FloatArray
    given: Given
    cross_flow: Along | None = None
    slip: Along | None = None

    def across(self, position: FloatArray) -> FloatArray:
        """Speed across the axis at positions, m/s; 0 where there is none."""
        return np.zeros_like(position) if self.cross_flow is None else self.cross_flow(position)

    def axial(self, position: FloatArray) -> FloatArray:
        """Speed along the axis at positions, m/s, against moving air where there is some: what `across` leaves of `speed`."""
        if self.slip is not None:
            return self.slip(position)
        if self.cross_flow is None:
            return self.speed(position)
        value: FloatArray = np.sqrt(np.maximum(self.speed(position) ** 2 - self.across(position) ** 2, 0.0))
        return value

    def against(self, position: FloatArray, whole: bool) -> FloatArray:
        """Speed against the air before any wind: along the axis, or (`whole`) all of it where the air is still."""
        return self.speed(position) if whole and self.slip is None else self.axial(position)

    def integral(self, integrand: Along, rtol: float = 1e-13) -> FloatArray:
        """Integral of a function of position from `start` to every position, adaptive Gauss-Legendre.

        Ten points a panel, panels halved until the halves agree with the whole to `rtol` of the total; 45 halvings at
        most.
        """
        inside = self.breaks[(self.breaks > self.start) & (self.breaks < self.position[-1])]
        edges = np.unique(np.concatenate(([self.start], self.position, inside)))
        sums = np.zeros(edges.size - 1)
        low, high, owner = edges[:-1], edges[1:], np.arange(edges.size - 1)
        whole = _gauss(integrand, low, high)
        scale = float(np.abs(whole).sum())
        for _ in range(45):
            middle = 0.5 * (low + high)
            left, right = _gauss(integrand, low, middle), _gauss(integrand, middle, high)
            fine = left + right
            done = np.abs(fine - whole) <= rtol * np.maximum(np.abs(fine), 0.01 * scale)
            np.add.at(sums, owner[done], fine[done])
            if done.all():
                break
            low, high, owner, whole = (
                np.concatenate((low[~done], middle[~done])),
                np.concatenate((middle[~done], high[~done])),
                np.concatenate((owner[~done], owner[~done])),
                np.concatenate((left[~done], right[~done])),
            )
        else:
            np.add.at(sums, owner, whole)
        total = np.concatenate(([0.0], np.cumsum(sums)))
        value: FloatArray = total[np.searchsorted(edges, self.position)]
        return value


def straight_path(jet: SteadyJet, z: ArrayLike, given: Given | None = None) -> ElementPath:
    """Path along a straight steady jet.

    Parameters
    ----------
    jet : SteadyJet
        Profile with ``V(z)``.
    z : array_like, (n,)
        Where results are wanted, m, strictly increasing, from `jet.start` to `jet.end`.
    given : {"velocity", "radius"}, optional
        What the profile was measured as; default: what the jet says (`jet.given`), or velocity.

    Returns
    -------
    ElementPath

    Raises
    ------
    InputError
        For positions out of order or outside the jet.
    """
    position = _positions("z", z, jet.start, jet.end)
    velocity, radius = jet.initial_velocity, jet.initial_radius
    chosen: Given = given if given is not None else getattr(jet, "given", "velocity")
    if not isinstance(chosen, str) or chosen not in get_args(Given):
        raise InputError("given", "is not known", value=chosen, allowed='"velocity", "radius"')
    return ElementPath(
        position=position,
        start=jet.start,
        initial_radius=radius,
        stretch=jet.velocity_ratio,
        speed=lambda x: velocity * jet.velocity_ratio(x),
        exposure=lambda x: np.full_like(x, 1 / velocity),
        breaks=jet.start + radius * np.asarray(jet.kinks(), dtype=np.float64),
        given=chosen,
        slip=getattr(jet, "slip", None),
    )


def bead_path(jet: BeadJet, *, flow_rate: float | None = None, residence_time: ArrayLike | None = None) -> ElementPath:
    """Path along one moment of a bead jet, element by element from the nozzle on.

    Parameters
    ----------
    jet : BeadJet
        One moment: a `LagrangianJet`, `.at(time)`.
    flow_rate : float, optional
        Q in m3/s: elements are then as old as the volume between them and the nozzle, over Q.
    residence_time : array_like, (element,), optional
        Age of the usable elements in s, strictly increasing, > 0; in place of `flow_rate`. With neither, the time it
        takes at the speed of the beads.

    Returns
    -------
    ElementPath
        Positions are the middles of the usable elements, by arc length.

    Notes
    -----
    A simulator that lets its beads dry must give their stretch itself: volumes would count the loss as stretch. The
    elements of one moment stand for the history of one element: exact in a steady jet, the usual reading otherwise.
    """
    usable: BoolArray = np.asarray(jet.usable, dtype=bool)
    if usable.ndim != 1:
        raise InputError("jet", "has many times", remedy="pick one with .at(time)")
    if flow_rate is not None and residence_time is not None:
        raise InputError("jet", "needs flow_rate or residence_time, not both", remedy="give one")
    arc = np.asarray(jet.arc_length, dtype=np.float64)[usable]
    position = _positions("arc_length", arc, 0.0, np.inf)
    radius, nodes = jet.initial_radius, np.concatenate(([0.0], position))
    beads = np.asarray(jet.bead_velocity, dtype=np.float64)
    speeds = 0.5 * (beads[1:] + beads[:-1])[usable]
    known = bool(np.isfinite(speeds).all() and np.isfinite(beads[0]))
    if flow_rate is not None:
        first = positive("flow_rate", flow_rate, "m3/s") / (np.pi * radius**2)
        ages = None
    elif residence_time is not None:
        ages = real("residence_time", residence_time, above=0.0, unit="s")
        if ages.shape != position.shape or (np.diff(ages) <= 0).any():
            raise InputError("residence_time", "must strictly increase, one value per usable element", value=ages.shape)
        first = float(position[0] / ages[0])
    elif known:
        along = np.concatenate((beads[:1], speeds))
        if (along <= 0).any():
            raise InputError("jet", "has beads at rest", remedy="give flow_rate or residence_time")
        ages = np.cumsum(np.diff(nodes) * 0.5 * (1 / along[1:] + 1 / along[:-1]))
        first = float(beads[0])
    else:
        raise InputError("jet", "has no velocities", remedy="give flow_rate or residence_time")
    pace = None if ages is None else np.diff(np.concatenate(([0.0], ages))) / np.diff(nodes)

    def exposure(x: FloatArray) -> FloatArray:
        if pace is None:
            return np.full_like(x, 1 / first)
        panel = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, pace.size - 1)
        return pace[panel] * jet.stretch_ratio(x)

    def speed(x: FloatArray) -> FloatArray:
        if known:
            return np.interp(x, nodes, np.concatenate((beads[:1], speeds)))
        return first * jet.stretch_ratio(x)

    cross = getattr(jet, "cross_velocity", None)
    blown: Along | None = None
    if known and cross is not None and np.isfinite(cross[usable]).all():
        most = np.inf if getattr(jet, "air_slip", None) is not None else speeds
        sideways = np.concatenate(([0.0], np.minimum(cross[usable], most)))  # none at the nozzle

        def blown(x: FloatArray) -> FloatArray:
            return np.interp(x, nodes, sideways)

    own = getattr(jet, "air_slip", None)
    past: Along | None = None
    if own is not None and np.isfinite(own[usable]).all():

        def past(x: FloatArray) -> FloatArray:
            return np.asarray(np.interp(x, position, own[usable]))

    return ElementPath(position, 0.0, radius, jet.stretch_ratio, speed, exposure, position, "velocity", blown, past)


def _positions(field: str, values: ArrayLike, start: float, end: float) -> FloatArray:
    position = np.atleast_1d(real(field, values, least=start, most=end, unit="m"))
    if position.ndim != 1 or not position.size or (np.diff(position) <= 0).any():
        raise InputError(field, "must strictly increase along the jet", value=f"shape {position.shape}")
    return position


def _gauss(integrand: Along, low: FloatArray, high: FloatArray) -> FloatArray:
    nodes, weights = gauss(10)
    half = 0.5 * (high - low)[:, np.newaxis]
    points = low[:, np.newaxis] + half * (1 + nodes)
    values = integrand(points.ravel()).reshape(points.shape)
    result: FloatArray = np.sum(half * weights * values, axis=1)
    return result
