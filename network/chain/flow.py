"""The jet as the bead chain feels it: V(s, t) in initial radii, tabulated once, cheap to look up.

The chain works with the age ``a(s) = int ds / V(s)``, in which an affine bead moves at exactly one: the
whole error of a time step is then that of the slip, not of the flow. In each cell of the table a(s) is the cubic through
the ages and slownesses 1/V at both ends, and V is *defined* as 1 / a'(s) there: age and velocity agree exactly. Cells
are halved until V so defined is within `error` of the jet's own; kinks (the onset of a power-law jet) need no care.

An unsteady jet is a sequence of profiles at given times, linear in time between them, held before the first and after
the last; two equal times make a jump (a voltage step). Linear interpolation in time errs by ``dt^2 / 8 |d2V/dt2|``.

Upstream of s = 0 and beyond `length` the velocity is held.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss

__all__ = ["Flow", "Segment"]

Profile = Callable[[FloatArray], FloatArray]  # V(s), s in initial radii

_MOST_CELLS = 200_000
_LONGEST = 1e12  # initial radii
_PROBES = np.array([0.2113, 0.5, 0.7887])  # where the slope of a Hermite cubic errs most


@dataclass(frozen=True)
class Segment:
    """The flow over a span of time in which it is linear in time.

    Attributes
    ----------
    begin, end : float
        Times, units of r_0 / v_0; either may be infinite.
    nodes : ndarray, shape (nodes,)
        Positions, in initial radii.
    age, slowness : ndarray, shape (2, nodes)
        Tables of both ends; the second is the reference in which ages are counted.
    weight : float, optional
        Share of the second profile in the flow, where it does not change: 0 where it is a reference only.
    """

    begin: float
    end: float
    nodes: FloatArray
    age: FloatArray
    slowness: FloatArray
    weight: float | None = None

    @cached_property
    def packed(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The tables as the compiled loops read them."""
        from spinline.network.chain._flow_kernels import pack

        return pack(self.nodes, self.age, self.slowness)

    def share(self, time: float) -> float:
        """Weight of the second profile at a time, in [0, 1]."""
        if self.weight is not None:
            return self.weight
        if not np.isfinite(self.begin) or not np.isfinite(self.end):
            return 1.0
        return min(max((time - self.begin) / (self.end - self.begin), 0.0), 1.0)


@dataclass(frozen=True, eq=False)
class Flow:
    """Velocity ratio V(s, t) along a jet; made by `from_jet`, `from_profiles` or `switching`.

    Attributes
    ----------
    nodes : ndarray, shape (n,)
        Positions s from 0 to `length`, in initial radii.
    times : ndarray, shape (m,)
        Times of the profiles, units of r_0 / v_0, never decreasing.
    age, slowness : ndarray, shape (m, n)
        ``int ds / V`` from the far end (so <= 0) and 1/V of each profile at the nodes.
    error : float
        Largest relative error of V seen between nodes.
    kinks : tuple of float
        Places where V' may jump, initial radii: the chain resolves the slip there once, not in every step.
    """

    nodes: FloatArray
    times: FloatArray
    age: FloatArray
    slowness: FloatArray
    error: float
    kinks: tuple[float, ...] = ()

    @classmethod
    def from_jet(cls, jet: Any, length: float, *, rtol: float = 1e-8) -> Self:
        """Tabulate a steady jet.

        Parameters
        ----------
        jet : StraightJet, or any object with ``velocity_ratio(z)`` and ``initial_radius``
            z in m from the nozzle.
        length : float
            In initial radii, in (0, 1e12].
        rtol : float, optional
            Relative error of V between nodes, in [1e-11, 1e-2].

        Raises
        ------
        InputError
            For a jet that does not cover the length, or is too rough for a table.
        """
        return cls.from_profiles([profile_of(jet, length)], [0.0], length, rtol=rtol, kinks=_kinks_of(jet))

    @classmethod
    def switching(
        cls, before: Any, after: Any, length: float, *, at: float, over: float = 0.0, rtol: float = 1e-8
    ) -> Self:
        """Tabulate a jet that turns into another: a voltage step.

        Parameters
        ----------
        before, after : jets, as for `from_jet`
        length : float
            In initial radii, > 0.
        at, over : float
            Time of the step and how long it takes (>= 0), units of r_0 / v_0.
        rtol : float, optional
            As for `from_jet`.
        """
        start = number("at", at)
        stop = start + number("over", over, least=0.0)
        profiles = [profile_of(before, length), profile_of(after, length)]
        kinks = (*_kinks_of(before), *_kinks_of(after))
        return cls.from_profiles(profiles, [start, stop], length, rtol=rtol, kinks=kinks)

    @classmethod
    def from_profiles(
        cls,
        profiles: Sequence[Profile],
        times: ArrayLike,
        length: float,
        *,
        rtol: float = 1e-8,
        kinks: Sequence[float] = (),
    ) -> Self:
        """Tabulate functions V(s), s in initial radii, valid at the given times.

        Parameters
        ----------
        profiles : sequence of callables
            Each takes an array of s in [0, length] and returns V > 0 of the same shape.
        times : array_like
            One for each profile, never decreasing.
        length : float
            In initial radii, > 0.
        rtol : float, optional
            As for `from_jet`.
        kinks : sequence of float, optional
            Where V' jumps, initial radii; not naming them costs time steps, not accuracy.
        """
        corners = tuple(sorted(set(real("kinks", kinks).ravel().tolist())))
        far = number("length", length, above=0.0, most=_LONGEST, unit="r_0")
        tolerance = number("rtol", rtol, least=1e-11, most=1e-2)
        when = real("times", times)
        if isinstance(profiles, str) or not isinstance(profiles, Sequence) or not all(map(callable, profiles)):
            raise InputError("profiles", "is not a sequence of functions V(s)", value=type(profiles).__name__)
        if when.ndim != 1 or when.size != len(profiles) or not when.size:
            raise InputError("times", "needs one time for each profile", value=f"{when.shape} for {len(profiles)}")
        if np.any(np.diff(when) < 0):
            raise InputError("times", "must not decrease", value=when.tolist())
        nodes = np.linspace(0.0, far, 65)
        while True:
            tables = [_table(profile, nodes) for profile in profiles]
            error = np.max([_cell_error(p, nodes, *t) for p, t in zip(profiles, tables, strict=True)], axis=0)
            # a kink is not chased into cells so small that rounding of the age spoils its slope
            least = np.finfo(float).eps * np.max([-age[:-1] / slow[:-1] for age, slow in tables], axis=0) / tolerance
            rough = (error > tolerance) & (np.diff(nodes) > least)
            if not rough.any():
                break
            if nodes.size + rough.sum() > _MOST_CELLS:
                worst = float(nodes[int(np.argmax(error))])
                remedy = "smooth the profile or raise rtol"
                raise InputError("jet", f"is too rough to tabulate near s = {worst:g}", value=rtol, remedy=remedy)
            middle = 0.5 * (nodes[:-1] + nodes[1:])[rough]
            nodes = np.sort(np.concatenate((nodes, middle)))
        age = np.stack([t[0] for t in tables])
        slowness = np.stack([t[1] for t in tables])
        return cls(nodes, when, age, slowness, float(error.max()), corners)

    @property
    def length(self) -> float:
        """Length of the jet, in initial radii."""
        return float(self.nodes[-1])

    def segment(self, time: float) -> Segment:
        """Return the span of linear change that begins at or contains a time."""
        after = int(np.searchsorted(self.times, time, side="right"))
        first, last = max(after - 1, 0), min(after, self.times.size - 1)
        begin = float(self.times[first]) if after > 0 else -np.inf
        end = float(self.times[last]) if after < self.times.size else np.inf
        rows = [0, 0] if after == 0 else [first, last]
        return Segment(begin, end, self.nodes, self.age[rows], self.slowness[rows])

    def velocity_ratio(self, position: ArrayLike, time: float = 0.0) -> FloatArray:
        """V at positions s (initial radii) and one time (r_0 / v_0)."""
        s = real("position", position)
        part = self.segment(number("time", time))
        share = part.share(time)
        return (1 - share) * self._velocity(s, part, 0) + share * self._velocity(s, part, 1)

    def residence_time(self, position: ArrayLike, time: float = 0.0) -> FloatArray:
        """Age a(s), units of r_0 / v_0, in the profile that holds at a time (the later one while it changes)."""
        s = real("position", position)
        part = self.segment(number("time", time))
        value: FloatArray = hermite(s, self.nodes, part.age[1], part.slowness[1])[0] - part.age[1, 0]
        return value

    def _velocity(self, s: FloatArray, part: Segment, row: int) -> FloatArray:
        value: FloatArray = 1 / hermite(s, self.nodes, part.age[row], part.slowness[row])[1]
        return value


def profile_of(jet: Any, length: float) -> Profile:
    """V(s) of a jet object in SI, refused where it does not cover the length."""
    if not callable(getattr(jet, "velocity_ratio", None)) or not hasattr(jet, "initial_radius"):
        remedy = "give a spinline.jetprofile jet, or Flow.from_profiles with functions V(s)"
        raise InputError("jet", "has no velocity_ratio(z) and initial_radius", value=type(jet).__name__, remedy=remedy)
    radius = positive("jet.initial_radius", jet.initial_radius, "m")
    far = positive("length", length, "r_0") * radius
    start, end = float(getattr(jet, "start", 0.0)), float(getattr(jet, "end", np.inf))
    if start > 0:
        raise InputError("jet", "must start at the nozzle", value=start, allowed="start = 0 m", remedy="add z = 0")
    if end < far * (1 - 1e-12):
        raise InputError("length", "is beyond the jet", value=length, allowed=f"(0, {end / radius:g}] r_0")

    def profile(s: FloatArray) -> FloatArray:
        value: FloatArray = np.asarray(jet.velocity_ratio(np.minimum(s * radius, end)))
        return value

    return profile


def _kinks_of(jet: Any) -> tuple[float, ...]:
    """Places named by a jet, initial radii."""
    kinks = getattr(jet, "kinks", None)
    return tuple(kinks()) if callable(kinks) else ()


def _table(profile: Profile, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Age and slowness at the nodes; 5-point Gauss-Legendre in each cell."""
    points, weights = gauss(5)
    width = np.diff(nodes)
    inside = nodes[:-1, np.newaxis] + 0.5 * width[:, np.newaxis] * (1 + points)
    passed = 0.5 * width * np.sum(weights / _checked(profile, inside), axis=1)
    # counted from the far end: where beads are fast and close in age, ages are small and their differences exact
    return np.append(-np.cumsum(passed[::-1])[::-1], 0.0), 1 / _checked(profile, nodes)


def _checked(profile: Profile, s: FloatArray) -> FloatArray:
    return real("jet.velocity_ratio", profile(s), above=0.0, remedy="the jet must move forward everywhere")


def _cell_error(profile: Profile, nodes: FloatArray, age: FloatArray, slowness: FloatArray) -> FloatArray:
    inside = nodes[:-1, np.newaxis] + np.diff(nodes)[:, np.newaxis] * _PROBES
    slope = hermite(inside, nodes, age, slowness)[1]
    value: FloatArray = np.max(np.abs(slope * _checked(profile, inside) - 1), axis=1)
    return value


def hermite(s: FloatArray, nodes: FloatArray, age: FloatArray, slowness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Age and its slope; straight outside the table."""
    i = np.clip(np.searchsorted(nodes, s, side="right") - 1, 0, nodes.size - 2)
    width = nodes[i + 1] - nodes[i]
    inside = np.clip(s, nodes[0], nodes[-1])
    t = (inside - nodes[i]) / width
    p, q, mean = slowness[i], slowness[i + 1], (age[i + 1] - age[i]) / width
    value = age[i] + width * t * (p + t * ((3 * mean - 2 * p - q) + t * (p + q - 2 * mean)))
    slope = p + t * (2 * (3 * mean - 2 * p - q) + 3 * t * (p + q - 2 * mean))
    return value + (s - inside) * slope, slope
