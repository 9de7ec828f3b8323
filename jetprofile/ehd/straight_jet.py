"""The straight electrified jet of a needle's settings: `StraightEhdJet`, a jet like any other, with what only it knows."""

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.base.quadrature import gauss
from spinline.jetprofile.ehd.bending import BendingOnset, bending_onset
from spinline.jetprofile.ehd.boundary_value import spline
from spinline.jetprofile.ehd.capillary import capillary_growth
from spinline.jetprofile.ehd.end_pull import SLACK, EndPull, end_pull
from spinline.jetprofile.ehd.equations import rates
from spinline.jetprofile.ehd.settings import NeedleSettings
from spinline.jetprofile.ehd.solver import Solved, solve, thins
from spinline.jetprofile.ehd.verdicts import Verdict, judge
from spinline.jetprofile.ehd.whole_line import whole_line
from spinline.jetprofile.straight import StraightJet

__all__ = ["NoSteadyJet", "StraightEhdJet"]

_GAUSS = gauss(16)
_ENDED = {
    "fold": "steady threads end at {:.3g} of the forces",
    "lost": "no steady thread was found beyond {:.3g} of the forces",
    "mesh": "the thread found at {:.3g} of the forces moves with the mesh",
    "": "the thread found at {:.3g} of the forces does not thin",
}


class NoSteadyJet(InputError):
    """The settings give no steady thinning jet; ``reason`` names why, ``pull`` says how far the forces could be raised.

    Reasons: "swells", "held", "fold", "cone", "end", "spray", "unresolved". ``search`` says how the search ended: "fold" (the
    branch ends), "lost" (the path could not be followed further), "mesh" (the mesh moves what was found), or "" (a solution
    was found, and failed a test).
    """

    def __init__(self, reason: str, text: str, pull: float, remedy: str, search: str = "") -> None:
        super().__init__("jet", text, remedy=remedy)
        self.reason, self.text, self.pull, self.remedy, self.search = reason, text, pull, remedy, search

    def __reduce__(self) -> tuple[Any, ...]:
        return NoSteadyJet, (self.reason, self.text, self.pull, self.remedy, self.search)


class StraightEhdJet(StraightJet):
    """Steady straight jet of a needle at a voltage, by the boundary-value problem of `equations`.

    Parameters
    ----------
    settings : NeedleSettings
        Bench and solution.
    length : float, optional
        What is reported, m; default: up to where bending sets in, or a quarter of L.
    tolerance : float
        Relative error of radius and current to which the mesh is refined.
    near : StraightEhdJet, optional
        A neighbouring jet to start from (sweeps): ten times faster.

    Attributes
    ----------
    settings : NeedleSettings
    current : float
        I in A.
    needle_potential : float
        Potential in V that the jet has at the needle beyond the needle's own: 0 with a predicted current; with a given
        one, what the setup lacks (or has too much).
    end_pull : EndPull
        What the condition at the end makes of the jet.
    error : dict
        Estimated relative errors of radius, current, tension.
    residual : float
        The largest of them.

    Raises
    ------
    NoSteadyJet
        Where there is no steady thinning jet, with the reason.

    Notes
    -----
    Cost: 0.05 to 0.5 s, a hard search up to 5 s. Between the nodes every unknown is a cubic with its computed slope.
    """

    given = "velocity"

    def __init__(
        self,
        settings: NeedleSettings,
        *,
        length: float | None = None,
        tolerance: float = 1e-6,
        near: "StraightEhdJet | None" = None,
    ) -> None:
        super().__init__(settings.radius, settings.flow_rate)
        self.settings = settings
        found = solve(settings, tolerance=tolerance, near=None if near is None else near.solved)
        if settings.log == "slender" and not found.why:
            found = whole_line(settings, found)
            if found.why:
                raise NoSteadyJet(
                    "unresolved",
                    "the charge of the whole line does not settle on this jet",
                    1.0,
                    'log = "local"',
                    found.why,
                )
        self._adopt(found)
        reach = settings.end_position
        if length is not None:
            self.end = float(real("length", length, above=0.0, most=reach, unit="m", remedy="within jet.end"))
        else:
            onset = self.bending.position
            self.end = min(reach / 4, onset) if np.isfinite(onset) else reach / 4

    def _adopt(self, found: Solved) -> None:
        """Take over a solution, or refuse it by name."""
        settings = self.settings
        if found.why:
            raise _refusal(settings, found)
        self.solved = found
        self._curve, self._rate = spline(found.problem, found.discrete)
        s, y = found.discrete.s, found.discrete.y
        self._s = s
        if not thins(found.problem, found.discrete):
            raise _refusal(settings, found)
        self.end_pull = end_pull(found.problem, found.discrete)
        if self.end_pull.share > SLACK:
            raise _wound_up(self.end_pull.share)
        self.error, self.residual = found.error, max(found.error.values())
        self.current = float(settings.current_scale * np.exp(y[0, 3]))
        self.needle_potential = 0.0
        if settings.current is not None:
            self.needle_potential = float(y[0, 2] * settings.field_scale * settings.radius)
        nodes, weights = _GAUSS
        half = 0.5 * np.diff(s)[:, np.newaxis]
        at = s[:-1, np.newaxis] + half * (1 + nodes)
        self._t = np.concatenate(([0.0], np.cumsum(np.sum(half * weights * np.exp(-self._curve(at)[..., 0]), axis=1))))

    def _parameters(self) -> dict[str, object]:
        return {"settings": self.settings}

    # the jet, in reduced terms

    def _reduced(self, z: ArrayLike) -> FloatArray:
        at = real("z", z, least=0.0, most=self.end * (1 + 1e-12), unit="m", remedy="the straight part ends there")
        value: FloatArray = np.minimum(at / self.initial_radius, self._s[-1])
        return value

    def _ratio(self, s: FloatArray) -> FloatArray:
        value: FloatArray = np.exp(self._curve(s)[..., 0])
        return value

    def _slope(self, s: FloatArray) -> FloatArray:
        value: FloatArray = np.maximum(self._curve(s, 1)[..., 0], 0.0) * self._ratio(s)
        return value

    def _time(self, s: FloatArray) -> FloatArray:
        i = np.clip(np.searchsorted(self._s, s, side="right") - 1, 0, self._s.size - 2)
        nodes, weights = _GAUSS
        half = 0.5 * (np.asarray(s) - self._s[i])[..., np.newaxis]
        at = self._s[i][..., np.newaxis] + half * (1 + nodes)
        value: FloatArray = self._t[i] + np.sum(half * weights / self._ratio(at), axis=-1)
        return value

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        u, target = self._curve(self._s)[:, 0], np.log(ratio)
        last = self._reduced(self.end)
        reached = (target >= u[0]) & (target <= np.log(self._ratio(last)))
        wanted = np.where(reached, target, u[0])
        i = np.clip(np.searchsorted(u, wanted, side="left") - 1, 0, u.size - 2)
        low, high = self._s[i], self._s[i + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self._curve(middle)[..., 0] < wanted
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(reached, high, np.nan)

    # what only this jet knows

    def _state(self, z: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Unknowns, E, q and T at z."""
        s = self._reduced(z)
        y = self._curve(s.ravel())
        field, share, pull = _evaluate(self.solved, s.ravel(), y)
        return y, field.reshape(s.shape), share.reshape(s.shape), pull.reshape(s.shape)

    def tension(self, z: ArrayLike) -> FloatArray:
        """Viscoelastic force P along the jet in N."""
        return self.settings.force_scale * self._state(z)[3]

    def tensile_stress(self, z: ArrayLike) -> FloatArray:
        """First normal stress difference N1 in Pa."""
        scale = self.settings.viscosity * self.initial_velocity / self.initial_radius
        return scale * self._state(z)[3] * self.velocity_ratio(z)

    def conduction_share(self, z: ArrayLike) -> FloatArray:
        """Share q of the current that is conducted."""
        return self._state(z)[2]

    def field_inside(self, z: ArrayLike) -> FloatArray:
        """Axial field in the jet in V/m."""
        return self.settings.field_scale * self._state(z)[1]

    def line_charge(self, z: ArrayLike) -> FloatArray:
        """Free charge per length in C/m: ``(1 - q) I / v``."""
        return self.current * (1 - self._state(z)[2]) / self.velocity(z)

    def surface_charge(self, z: ArrayLike) -> FloatArray:
        """Free charge per surface in C/m2."""
        return self.line_charge(z) / (2 * np.pi * self.radius(z))

    def conformation(self, z: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """A_zz and A_rr (1 at rest); ones for a Newtonian jet."""
        shape = np.shape(z)
        if not self.solved.problem.polymer:
            return np.ones(shape), np.ones(shape)
        y = self._state(z)[0]
        b, c = np.exp(y[:, 4]), np.exp(y[:, 5])
        f = 1 + (b + 2 * c - 3) * self.solved.problem.parameters[10]
        return (b / f).reshape(shape), (c / f).reshape(shape)

    def fields(self, z: ArrayLike) -> dict[str, FloatArray]:
        """Further variables along it, by their names in a result."""
        return {
            "tension": self.tension(z),
            "tensile_stress": self.tensile_stress(z),
            "line_charge": self.line_charge(z),
            "conduction_share": self.conduction_share(z),
        }

    def numbers(self) -> dict[str, float]:
        """Current (A) and onset of bending with its spread (m)."""
        onset = self.bending
        return {
            "current": self.current,
            "bending_onset": onset.position,
            "bending_onset_early": onset.earliest,
            "bending_onset_late": onset.latest,
        }

    def words(self) -> dict[str, str]:
        """Model, verdicts and errors in words."""
        error = ", ".join(f"{name} {value:.2g}" for name, value in self.error.items())
        return {"jet_model": self.model, "verdicts": "\n".join(map(str, self.verdicts)), "jet_error": error}

    def remarks(self) -> list[str]:
        """The verdicts that go against a steady straight jet, and an end beyond the onset of bending."""
        found = [f"jet: {one}" for one in self.verdicts if not one.good]
        if self.bending.position < self.end * (1 - 1e-9):
            found.append(
                f"jet: bending sets in at {self.bending.position:.4g} m ({self.bending.earliest:.3g} to "
                f"{self.bending.latest:.3g} m): beyond, the jet is not straight"
            )
        if abs(self.needle_potential) > 0.1 * self.settings.voltage:
            found.append(
                f"jet: with this current the jet starts {self.needle_potential:.4g} V from the needle's potential: a measured "
                "current that the settings do not give"
            )
        return found

    @cached_property
    def bending(self) -> BendingOnset:
        """Where bending sets in, with its spread; NaN where not before L."""
        s = np.unique(np.concatenate((self._s, np.geomspace(self._s[1], self._s[-1], 600))))
        s = s[s <= self._s[-1]]
        z = s * self.initial_radius
        end, self.end = self.end, self.settings.end_position
        try:
            columns: Any = {
                "radius": self.radius(z),
                "velocity": self.velocity(z),
                "line_charge": self.line_charge(z),
                "tension": self.tension(z),
            }
        finally:
            self.end = end
        x = self.settings
        return bending_onset(z, density=x.density, surface_tension=x.surface_tension, viscosity=x.viscosity, **columns)

    @cached_property
    def verdicts(self) -> tuple[Verdict, ...]:
        """The numbers that decide, each with its sentence."""
        return _verdicts(self.settings, self.solved, self.end_pull)

    @property
    def model(self) -> str:
        """What was solved, in words."""
        x, p = self.settings, self.solved.problem
        law = x.law if p.polymer else "newtonian"
        current = "current predicted" if x.current is None else "current given"
        charge = "charge relaxation resolved" if p.charge else "charge relaxed"
        field = x.field if isinstance(x.field, str) else type(x.field).__name__
        return f"{law}, {current}, {charge}, {x.log} log, {field} field"

    def changed(self, **new: Any) -> "StraightEhdJet":
        """The jet of changed settings, started from this one.

        Examples
        --------
        ``jet.changed(voltage=7e3)``
        """
        return StraightEhdJet(replace(self.settings, **new), near=self)


def _evaluate(found: Solved, s: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """E, q and T of unknowns at places s."""
    p = found.problem
    _, values = rates(np.ascontiguousarray(y), p.field(s), p.parameters, p.flags)
    return values[:, 0], values[:, 1], values[:, 2]


def _along(found: Solved) -> tuple[FloatArray, FloatArray, FloatArray]:
    return _evaluate(found, found.discrete.s, found.discrete.y)


def _verdicts(x: NeedleSettings, found: Solved, pulled: EndPull) -> tuple[Verdict, ...]:
    s, u = found.discrete.s, found.discrete.y[:, 0]
    _, share, pull = _along(found)
    z, ratio = s * x.radius, np.exp(u)
    p = found.problem.parameters
    growth = capillary_growth(
        x.radius / np.sqrt(ratio), viscosity=x.viscosity, density=x.density, surface_tension=x.surface_tension
    )
    n = x.numbers
    viscous = x.initial_velocity / x.radius * (n["pull"] * (x.gap / x.radius) ** 2 / np.pi) ** (1 / 3)
    fold = found.time_share * x.relaxation_time
    stretch = np.sqrt(x.extensibility) if x.extensibility else np.inf
    return judge(
        z=z,
        velocity_ratio=ratio,
        tension=x.force_scale * pull,
        conducted=share,
        capillary_growth=growth,
        relaxation_time=x.relaxation_time if found.problem.polymer else 0.0,
        viscous_strain_rate=float(viscous),
        modulus=x.modulus,
        radius=x.radius,
        initial_velocity=x.initial_velocity,
        surface_tension=x.surface_tension,
        reynolds=n["reynolds"],
        relaxation_length=0.5 * p[5] * p[3] * ratio * x.radius,
        full_stretch=float(stretch),
        fold=fold,
        end=pulled,
    )


def _wound_up(share: float) -> NoSteadyJet:
    text = (
        f"{100 * min(share, 1.0):.0f} % of the tension at the needle is made by the condition at the end, not by field or "
        "weight: the only thread found would have to be wound up"
    )
    return NoSteadyJet("end", text, 1.0, "a higher voltage, a longer jet.end, or a shorter relaxation time")


def _refusal(x: NeedleSettings, found: Solved) -> NoSteadyJet:
    """Why there is no jet, in the order in which the reasons exclude one another."""
    share = f" (with {found.pull:.3g} of the forces)" if found.pull < 1 else ""
    softer = "a shorter relaxation time" if x.law == "fene-p" else 'law = "fene-p"'
    if found.discrete.y.size:
        pull = _along(found)[2]
        if pull[0] <= 0:
            text = (
                f"the tension at the needle is {x.force_scale * pull[0]:.3g} N: the jet swells, it does not thin{share}"
            )
            return NoSteadyJet("swells", text, found.pull, "more conductivity, or a higher voltage", found.why)
        if not found.why:
            text = "the only steady thread found thins and thickens again: no thinning jet at these settings"
            return NoSteadyJet("swells", text, found.pull, "a shorter jet.end, or a higher voltage")
    if found.why == "fold" and np.isfinite(found.time_share):
        time = found.time_share * x.relaxation_time
        text = f"no steady jet is found beyond a relaxation time of {time:.4g} s at these settings"
        return NoSteadyJet("fold", text, found.pull, f"{softer}, or another voltage", "fold")
    n = x.numbers
    if x.pull_against_capillarity < 0.5:
        text = (
            f"pull against capillarity is {x.pull_against_capillarity:.3g} (4 A^(1/3) Ca): the drop is held, it drips; "
            f"{_ENDED[found.why].format(found.pull)}"
        )
        return NoSteadyJet("held", text, found.pull, "a higher voltage, or a higher flow rate", found.why)
    if found.why == "fold":
        text = f"the branch of steady jets ends at {found.pull:.3g} of the pull"
        return NoSteadyJet("fold", text, found.pull, f"a lower voltage, or {softer}", "fold")
    if found.discrete.y.size and x.polymer and x.extensibility:
        jump = float(_along(found)[2][0]) * x.force_scale / (np.pi * x.radius**2 * x.modulus)
        if jump > np.sqrt(x.extensibility):
            text = f"the pull stretches the network fully within the cone (V1 = {jump:.3g}){share}: outside this theory"
            return NoSteadyJet("cone", text, found.pull, "a lower voltage, or a higher flow rate", found.why)
    if n["reynolds"] > 0.1:
        text = f"inertia rules from the needle on (Re = {n['reynolds']:.3g}){share}: a spray, not a fibre"
        return NoSteadyJet("spray", text, found.pull, "a more viscous solution", found.why)
    text = f"a steady jet was followed to {found.pull:.3g} of the forces and not further"
    return NoSteadyJet("unresolved", text, found.pull, "a shorter jet.end, or a measured current", found.why)
