"""The volume balance of a drying jet as an initial-value problem: right-hand side and solution.

The unknowns are logarithms of the solvent volumes over their starts (plain volumes for solvents that are only in the
air), so that nothing becomes negative and drying can go on for ever. In still air, or with the velocity kept, Re is a
function of position times a power of F: then ``J = int Re(F = 1)^(1/3) Lambda dt / r_0^2`` takes the place of the
position, one equation without it remains, and profiles with kinks cost nothing.
"""

import math
from collections.abc import Callable, Sequence
from typing import Literal, get_args

import numpy as np

from spinline.base.checks import FloatArray, number, positive
from spinline.base.errors import InputError
from spinline.rheology.element_path import ElementPath
from spinline.rheology.transfer import Transfer, law_index, transfer_number
from spinline.rheology.volatile import Volatile

__all__ = ["Activity", "Balance"]

Activity = Literal["flory-huggins", "raoult", "unit"]
_RTOL = 1e-12  # of the log volumes
_MOST_CALLS = 200_000  # of the right-hand side


class Balance:
    """Balance along one path; `set_air` completes it."""

    floor, law = 0.0, "kase-matsuo"

    def __init__(
        self,
        path: ElementPath,
        phi0: float,
        volatiles: Sequence[Volatile],
        start: FloatArray,
        activity: str,
        polymer_volume: float | None,
    ) -> None:
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

    def set_air(self, viscosity: float, velocity: float, floor: float, law: Transfer = "kase-matsuo") -> None:
        """Kinematic viscosity, velocity, least Sherwood number and transfer; wider than any air, within what a double
        squares.
        """
        law_index(law)
        self.law = law
        self.nu = number("air_viscosity", viscosity, least=1e-20, most=1e20, unit="m2/s")
        self.wind = number("air_velocity", velocity, least=-1e20, most=1e20, unit="m/s")
        self.floor = number("sherwood_floor", floor, least=0.0, most=1e12)
        self.schmidt = self.nu / self.spread

    @property
    def separable(self) -> bool:
        return self.floor == 0 and not (self.kept and self.wind != 0) and self.law != "churchill-bernstein"

    def volumes(self, y: FloatArray) -> FloatArray:
        origin, inside = (a.reshape((-1,) + (1,) * (y.ndim - 1)) for a in (self.origin, self.inside))
        return np.where(inside, np.exp(np.where(inside, origin + y, 0.0)), y)

    def fall(self, y: FloatArray) -> tuple[float, FloatArray]:
        """Volume left, and the driving dC of each solvent over its volume (over 1 for solvents only in the air)."""
        from spinline.rheology._activity_kernels import fall  # loads the compiler, which one solvent alone does without

        unit = self.polymer_volume if self.activity == "raoult" else 0.0
        return fall(y, self.phi0, self.inside, self.origin, self.volume, self.chi, unit, self.saturation, self.ambient)

    def effective(self, x: FloatArray, left: FloatArray | float) -> FloatArray:
        """Re with what the cross-flow adds to it in the transfer law: 8 times itself in Kase and Matsuo's."""
        weight = {"kase-matsuo": 8.0, "churchill-bernstein": 1.0, "yarin": 0.0}[self.law]
        along = self.reynolds(x, left)
        if not weight or self.path.cross_flow is None:
            return along
        value: FloatArray = np.hypot(along, weight * self.across(x, left))
        return value

    def across(self, x: FloatArray, left: FloatArray | float) -> FloatArray:
        """Re of the speed across the jet."""
        radius = self.path.initial_radius * np.sqrt((1.0 if self.kept else left) / self.path.stretch(x))
        value: FloatArray = 2 * radius * self.path.across(x) / self.nu
        return value

    def reynolds(self, x: FloatArray, left: FloatArray | float) -> FloatArray:
        stretch = self.path.stretch(x)
        speed = self.path.against(x, self.law == "yarin")
        if self.kept:
            return 2 * self.path.initial_radius / np.sqrt(stretch) * np.abs(left * speed - self.wind) / self.nu
        return 2 * self.path.initial_radius * np.sqrt(left / stretch) * np.abs(speed - self.wind) / self.nu

    def sherwood(self, x: FloatArray, left: FloatArray | float) -> FloatArray:
        """(solvent, n)."""
        along, sc = self.reynolds(x, left), self.schmidt[:, np.newaxis]
        if self.law == "churchill-bernstein":
            return transfer_number(along, sc, self.across(x, left), "churchill-bernstein", self.floor)
        value: FloatArray = np.maximum(0.495 * np.cbrt(self.effective(x, left)) * np.sqrt(sc), self.floor)
        return value

    def autonomous(self) -> FloatArray:
        """Along ``J = int Re(F = 1)^(1/3) Lambda dt / r_0^2``, in which the air drops out."""
        path = self.path
        j = path.integral(lambda x: path.exposure(x) * np.cbrt(self.effective(x, 1.0))) / path.initial_radius**2
        factor = 0.495 * np.sqrt(self.schmidt) * self.spread
        power = 1 / 3 if self.kept else 1 / 6
        if self.activity == "unit":  # dF/dJ = -c F^power, in closed form until no solvent is left
            fall = (1 - power) * float(factor[0] * self.saturation[0]) * float(1 - self.ambient[0]) * j
            return self._logarithm(-np.expm1(np.log1p(-np.minimum(fall, 1 - 1e-16)) / (1 - power)))

        def slope(_: float, y: FloatArray) -> FloatArray:
            left, falls = self.fall(y)
            value: FloatArray = -factor * left**power * falls
            return value

        alone = self.start.size == 1 and bool(self.inside[0]) and self.activity == "flory-huggins"
        return self._solve(self._alone(float(factor[0]), power) if alone else slope, 0.0, j, np.inf)

    def _logarithm(self, lost: FloatArray) -> FloatArray:
        """State of one solvent from the volume lost, which may have come to more than there was."""
        share = lost / self.start[0]
        value = np.full((1, lost.size), -np.inf)
        np.log1p(-share, out=value[0], where=share < 1)
        return value

    def _alone(self, factor: float, power: float) -> Callable[[float, FloatArray], FloatArray]:
        """The slope of one solvent: the same, a fiftieth of the time."""
        origin, ambient, chi = float(self.origin[0]), float(self.ambient[0]), float(self.chi[0])
        strength, phi0 = factor * float(self.saturation[0]), self.phi0

        def slope(_: float, y: FloatArray) -> FloatArray:
            u = math.exp(origin + float(y[0]))
            total = phi0 + u
            polymer = phi0 / total
            mixing = polymer * (1 + chi * polymer)
            if polymer < 0.02:  # as in `fall`, and ln(1 - phi) + phi + phi^2/2 as a series: chi = 1/2 leaves phi^3
                series = 0.0
                for n in range(10, 2, -1):
                    series = polymer * series + 1 / n
                inside = (1 - ambient + math.expm1(polymer**2 * (chi - 0.5 - polymer * series))) / u
            elif polymer < 0.5:
                inside = (1 - ambient + math.expm1(math.log1p(-polymer) + mixing)) / u
            else:
                inside = math.exp(mixing) / total - (ambient / u if ambient > 0 else 0.0)
            return np.array([-strength * total**power * inside])

        return slope

    def along(self) -> FloatArray:
        path = self.path

        def pace(x: float, left: float) -> FloatArray:
            at = np.asarray([x])
            number = self.sherwood(at, left)[:, 0]
            value: FloatArray = self.spread * number * path.exposure(at) / path.initial_radius**2
            return value

        def slope(x: float, y: FloatArray) -> FloatArray:
            left, falls = self.fall(y)
            value: FloatArray = -pace(x, left) * falls
            return value

        def loss(x: float, lost: FloatArray) -> FloatArray:  # at activity 1; past dryness as at dryness, and not used
            left = max(1 - float(lost[0]), self.phi0)
            value: FloatArray = pace(x, left) * self.saturation * (1 - self.ambient)
            return value

        gaps = np.diff(np.concatenate(([path.start], path.breaks, path.position)))
        longest = float(np.ptp(path.position)) / 20 + float(gaps.max()) / 4
        if self.activity == "unit":
            return self._logarithm(self._solve(loss, path.start, path.position, longest)[0])
        return self._solve(slope, path.start, path.position, longest)

    def _solve(
        self, slope: Callable[[float, FloatArray], FloatArray], begin: float, at: FloatArray, longest: float
    ) -> FloatArray:
        from scipy.integrate import solve_ivp  # slow to import, and of no use to a jet with heat

        y = np.zeros((self.start.size, at.size))
        if at[-1] <= begin:
            return y
        marks, where = np.unique(at, return_inverse=True)
        after = marks > begin
        span = float(marks[-1] - begin)  # the solver's own variable runs from 0 to 1: steps of 1e-300 are no trouble
        calls = 0

        def scaled(x: float, state: FloatArray) -> FloatArray:
            nonlocal calls
            calls += 1
            if calls > _MOST_CALLS:
                raise _cannot(f"more than {_MOST_CALLS} steps")
            value: FloatArray = span * slope(begin + span * x, state)
            return value

        size = float(np.abs(scaled(0.0, np.zeros(self.start.size))).max())
        found = solve_ivp(
            scaled,
            (0.0, 1.0),
            np.zeros(self.start.size),
            method="LSODA",
            t_eval=(marks[after] - begin) / span,
            rtol=_RTOL,
            atol=1e-13 * min(1.0, max(size, 1e-200)),
            max_step=longest / span,
        )
        if not found.success:
            raise _cannot(found.message)
        reached = np.zeros((self.start.size, marks.size))
        reached[:, after] = found.y
        y[:] = reached[:, where.ravel()]
        return y


def _cannot(why: str) -> InputError:
    return InputError("jet", f"cannot be dried: {why}", remedy="check the properties of the solvents")
