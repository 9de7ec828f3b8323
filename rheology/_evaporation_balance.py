"""The volume balance of a drying jet as an initial-value problem: right-hand side and solution.

The unknowns are logarithms of the solvent volumes over their starts (plain volumes for solvents that are only in the air), so
that nothing becomes negative and drying can go on for ever. In still air, or with the velocity kept, Re is a function of
position times a power of F: then ``J = int Re(F = 1)^(1/3) Lambda dt / r_0^2`` takes the place of the position, one
equation without it remains, and profiles with kinks cost nothing.
"""

import math
from collections.abc import Callable, Sequence
from typing import Literal, get_args

import numpy as np
from scipy.integrate import solve_ivp

from spinline.checks import FloatArray, number, positive
from spinline.errors import InputError
from spinline.rheology import vapour
from spinline.rheology.element_path import ElementPath
from spinline.rheology.volatile import Volatile

__all__ = ["Activity", "Balance"]

Activity = Literal["flory-huggins", "raoult", "unit"]
_RTOL, _DRY = 1e-12, 34.0  # of the log volumes; e-foldings after which nothing is left


class Balance:
    """Balance along one path; `set_air` completes it."""

    floor = 0.0

    def __init__(
        self, path: ElementPath, phi0: float, volatiles: Sequence[Volatile], start: FloatArray, activity: str,
        polymer_volume: float | None,
    ) -> None:  # fmt: skip
        if not isinstance(activity, str) or activity not in get_args(Activity):
            raise InputError("activity", "is not known", value=activity, allowed=", ".join(get_args(Activity)))
        if activity == "raoult" and polymer_volume is None:
            raise InputError("polymer_molar_volume", "is needed for Raoult's law", remedy="give M/rho of a repeat unit")
        if activity == "unit" and len(volatiles) > 1:
            raise InputError("activity", "cannot be 1 in a mixture", value="unit", remedy='use "flory-huggins"')
        self.path, self.phi0, self.start, self.activity = path, phi0, start, activity
        self.polymer_volume = 1.0 if polymer_volume is None else positive("polymer_molar_volume", polymer_volume)
        columns = [(v.saturation, v.diffusivity, v.ambient, v.chi, v.molar_volume) for v in volatiles]
        self.saturation, self.spread, self.ambient, self.chi, self.volume = np.array(columns, dtype=np.float64).T
        self.inside = start > 0
        self.origin = np.where(self.inside, np.log(np.where(self.inside, start, 1.0)), 0.0)
        self.kept = path.given == "radius"

    def set_air(self, viscosity: float, velocity: float, floor: float) -> None:
        """Kinematic viscosity, velocity and least Sherwood number; wider than any air, within what a double can square."""
        self.nu = number("air_viscosity", viscosity, least=1e-20, most=1e20, unit="m2/s")
        self.wind = number("air_velocity", velocity, least=-1e20, most=1e20, unit="m/s")
        self.floor = number("sherwood_floor", floor, least=0.0, most=1e12)
        self.schmidt = self.nu / self.spread

    @property
    def separable(self) -> bool:
        return self.floor == 0 and not (self.kept and self.wind != 0)

    def volumes(self, y: FloatArray) -> FloatArray:
        origin, inside = (a.reshape((-1,) + (1,) * (y.ndim - 1)) for a in (self.origin, self.inside))
        return np.where(inside, np.exp(np.where(inside, origin + y, 0.0)), y)

    def fall(self, y: FloatArray) -> FloatArray:
        """Driving dC of each solvent over its volume (over 1 for solvents only in the air)."""
        u = self.volumes(y)
        total = self.phi0 + float(u.sum())
        if self.activity == "raoult":
            coefficient = vapour.raoult_coefficient(u / total, self.volume, self.polymer_volume)
        elif self.activity == "unit":
            constant: FloatArray = self.saturation * (1 - self.ambient) / u
            return constant
        else:
            coefficient = vapour.flory_huggins_coefficient(u / total, self.volume, self.chi)
        least = np.where(self.ambient > 0, u, 1.0)
        inside = coefficient / total - np.divide(self.ambient, least, out=np.zeros_like(u), where=self.inside)
        value: FloatArray = self.saturation * np.where(self.inside, inside, coefficient * u / total - self.ambient)
        return value

    def remaining(self, y: FloatArray) -> FloatArray:
        value: FloatArray = self.phi0 + self.volumes(y).sum(axis=0)
        return value

    def reynolds(self, x: FloatArray, left: FloatArray | float) -> FloatArray:
        stretch, speed = self.path.stretch(x), self.path.speed(x)
        if self.kept:
            return 2 * self.path.initial_radius / np.sqrt(stretch) * np.abs(left * speed - self.wind) / self.nu
        return 2 * self.path.initial_radius * np.sqrt(left / stretch) * np.abs(speed - self.wind) / self.nu

    def autonomous(self) -> FloatArray:
        """Along ``J = int Re(F = 1)^(1/3) Lambda dt / r_0^2``, in which the air drops out."""
        path = self.path
        j = path.integral(lambda x: path.exposure(x) * np.cbrt(self.reynolds(x, 1.0))) / path.initial_radius**2
        factor = 0.495 * np.sqrt(self.schmidt) * self.spread
        power = 1 / 3 if self.kept else 1 / 6

        def slope(_: float, y: FloatArray) -> FloatArray:
            value: FloatArray = -factor * self.remaining(y) ** power * self.fall(y)
            return value

        alone = self.start.size == 1 and bool(self.inside[0]) and self.activity == "flory-huggins"
        return self._solve(self._alone(float(factor[0]), power) if alone else slope, 0.0, j, np.inf)

    def _alone(self, factor: float, power: float) -> Callable[[float, FloatArray], FloatArray]:
        """The slope of one solvent: the same, a fiftieth of the time."""
        origin, ambient, chi = float(self.origin[0]), float(self.ambient[0]), float(self.chi[0])
        strength, phi0 = factor * float(self.saturation[0]), self.phi0

        def slope(_: float, y: FloatArray) -> FloatArray:
            u = math.exp(origin + float(y[0]))
            total = phi0 + u
            polymer = phi0 / total
            inside = math.exp(polymer * (1 + chi * polymer)) / total - (ambient / u if ambient > 0 else 0.0)
            return np.array([-strength * total**power * inside])

        return slope

    def along(self) -> FloatArray:
        path = self.path

        def slope(x: float, y: FloatArray) -> FloatArray:
            at = np.asarray([x])
            number = np.cbrt(self.reynolds(at, float(self.remaining(y)))) * 0.495 * np.sqrt(self.schmidt)
            rate = self.spread * np.maximum(number, self.floor) * path.exposure(at) / path.initial_radius**2
            value: FloatArray = -rate * self.fall(y)
            return value

        gaps = np.diff(np.concatenate(([path.start], path.breaks, path.position)))
        return self._solve(slope, path.start, path.position, float(np.ptp(path.position)) / 20 + float(gaps.max()) / 4)

    def _solve(
        self, slope: Callable[[float, FloatArray], FloatArray], begin: float, at: FloatArray, longest: float
    ) -> FloatArray:
        y = np.zeros((self.start.size, at.size))
        if at[-1] <= begin:
            return y
        marks, where = np.unique(at, return_inverse=True)
        after = marks > begin

        def dry(_: float, state: FloatArray) -> float:
            return float(state[0]) + _DRY

        dry.terminal = True  # type: ignore[attr-defined]
        span = float(marks[-1] - begin)  # the solver's own variable runs from 0 to 1: steps of 1e-300 are no trouble

        def scaled(x: float, state: FloatArray) -> FloatArray:
            value: FloatArray = span * slope(begin + span * x, state)
            return value

        size = float(np.abs(scaled(0.0, np.zeros(self.start.size))).max())
        found = solve_ivp(
            scaled, (0.0, 1.0), np.zeros(self.start.size), method="LSODA", t_eval=(marks[after] - begin) / span,
            rtol=_RTOL, atol=1e-13 * min(1.0, max(size, 1e-200)), max_step=longest / span,
            events=dry if self.activity == "unit" else None,
        )  # fmt: skip
        if not found.success:
            raise InputError("jet", f"cannot be dried: {found.message}", remedy="check the properties of the solvents")
        reached = np.zeros((self.start.size, marks.size))
        values = np.full((self.start.size, int(after.sum())), -np.inf)
        values[:, : found.y.shape[1]] = found.y
        reached[:, after] = values
        y[:] = reached[:, where.ravel()]
        return y
