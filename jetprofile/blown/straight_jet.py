"""The straight part of a blown jet as a jet like any other: `BlownJet`, with what only it knows."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from spinline.base.checks import FloatArray, positive
from spinline.base.errors import InputError
from spinline.jetprofile.blown.air import Air
from spinline.jetprofile.blown.drag import TangentialLaw
from spinline.jetprofile.blown.straight import straight_blown_jet
from spinline.jetprofile.blown.straight_results import BlownSolution, Law, StraightBlownJet
from spinline.jetprofile.straight import StraightJet

__all__ = ["BlownJet", "BlownSettings", "NoBlownJet"]


@dataclass(frozen=True)
class BlownSettings:
    """Solution, air and how the straight part is solved: the arguments of `straight_blown_jet`."""

    solution: BlownSolution
    air: Air
    length: float
    law: Law | None = None
    drag: TangentialLaw = "ziabicki-kawai"
    end_tension: float = 0.0
    gravity: float = 9.81


class NoBlownJet(InputError):
    """The settings give no straight jet; `verdict` names why."""

    def __init__(self, verdict: str, text: str) -> None:
        remedy = 'a solvent\'s viscosity (law = "oldroyd-b" or "fene-p"), another length, or slower air'
        super().__init__("jet", f"{verdict}: {text}", remedy=remedy)
        self.verdict, self.text = verdict, text

    def __reduce__(self) -> tuple[type["NoBlownJet"], tuple[str, str]]:
        return NoBlownJet, (self.verdict, self.text)


class BlownJet(StraightJet):
    """Straight jet drawn by air, from the nozzle to `length`.

    Parameters
    ----------
    settings : BlownSettings

    Attributes
    ----------
    solved : StraightBlownJet
        Profile, verdict and force balance.

    Raises
    ------
    NoBlownJet
        Where there is no profile.

    Notes
    -----
    Between the points ln v is a cubic spline in z: 1e-8 of v or better.
    """

    def __init__(self, settings: BlownSettings) -> None:
        import warnings

        from spinline.base.errors import SpinlineWarning

        super().__init__(settings.solution.radius, settings.solution.flow_rate)
        self.settings = settings
        with warnings.catch_warnings():  # what it has to say is in its remarks
            warnings.simplefilter("ignore", SpinlineWarning)
            found = straight_blown_jet(
                settings.solution,
                settings.air,
                positive("length", settings.length, "m"),
                law=settings.law,
                drag=settings.drag,
                end_tension=settings.end_tension,
                gravity=settings.gravity,
            )
        if not found.z.size:
            raise NoBlownJet(found.verdict, found.message)
        self.solved: StraightBlownJet = found
        self.end = float(found.z[-1])
        s = found.z / self.initial_radius
        log = np.log(found.velocity / self.initial_velocity)
        self._curve = CubicSpline(s, log - log[0])
        self._taken = CubicSpline(s, np.exp(-(log - log[0]))).antiderivative()

    def slip(self, z: ArrayLike) -> FloatArray:
        """Speed of the jet against the air around it, m/s: below 0 where the air is faster."""
        at = np.asarray(z, dtype=np.float64)
        return self.velocity(at) - self.settings.air.velocity(np.clip(at, 0.0, self.end))

    def tension(self, z: ArrayLike) -> FloatArray:
        """F in N, capillarity included."""
        return self._field("tension", z)

    def axial_stress(self, z: ArrayLike) -> FloatArray:
        """sigma_zz in Pa."""
        return self._field("axial_stress", z)

    def wave_speed_squared(self, z: ArrayLike) -> FloatArray:
        """c_b^2 of bending waves, m2/s2; below 0 bending has no limit on any mesh."""
        return self._field("wave_speed_squared", z)

    def fields(self, z: FloatArray) -> dict[str, FloatArray]:
        """Further variables along it, by their names in a result."""
        at = np.asarray(z, dtype=np.float64)
        return {
            "air_velocity": self.settings.air.velocity(np.clip(at, 0.0, self.end)),
            "tension": self.tension(at),
            "axial_stress": self.axial_stress(at),
            "wave_speed_squared": self.wave_speed_squared(at),
        }

    def numbers(self) -> dict[str, float]:
        """Where bending may begin (m), and the force balance."""
        return {"bending_start": self.solved.bending_start, "force_balance": self.solved.force_balance}

    def words(self) -> dict[str, str]:
        """Model and verdict in words."""
        said = f"{self.solved.verdict}: {self.solved.message}" if self.solved.message else self.solved.verdict
        return {"jet_model": self.model, "verdicts": said}

    @property
    def model(self) -> str:
        """What was solved, in words."""
        x = self.settings
        law = x.law or ("newton" if not x.solution.relaxation_time else "viscoelastic")
        return f"blown jet, {law}, drag {x.drag}, {type(x.air).__name__}"

    def remarks(self) -> list[str]:
        """What goes against a straight jet."""
        found = []
        if self.solved.verdict != "converged":
            found.append(f"jet: {self.solved.message}")
        below = self.solved.wave_speed_squared < 0
        if below.any():
            share = float(np.sum(np.diff(self.solved.z)[below[:-1]]) / self.end)
            found.append(
                f"jet: bending waves have c_b^2 < 0 on {share:.0%} of the straight part: there bends grow as fast as they are "
                f"short; beads begin at {1e3 * self.solved.bending_start:.4g} mm"
            )
        return found

    @cached_property
    def _curves(self) -> dict[str, CubicSpline]:
        from spinline.jetprofile.blown.straight_results import StraightBlownJet as Results

        names = [n for n in Results.__dataclass_fields__ if np.ndim(getattr(self.solved, n)) == 1 and n != "z"]
        return {name: CubicSpline(self.solved.z, getattr(self.solved, name)) for name in names}

    def _field(self, name: str, z: ArrayLike) -> FloatArray:
        at = self._reduced(z) * self.initial_radius
        return np.asarray(self._curves[name](np.minimum(at, self.end)))

    def _parameters(self) -> dict[str, object]:
        return {"settings": self.settings}

    def _ratio(self, s: FloatArray) -> FloatArray:
        return np.asarray(np.exp(self._curve(s)))

    def _slope(self, s: FloatArray) -> FloatArray:
        return np.asarray(self._curve(s, 1) * np.exp(self._curve(s)))

    def _time(self, s: FloatArray) -> FloatArray:
        return np.asarray(self._taken(s))

    def _inverse(self, ratio: FloatArray) -> FloatArray:
        s = self.solved.z / self.initial_radius
        highest = np.maximum.accumulate(self._curve(s))
        target = np.log(ratio)
        above = np.searchsorted(highest, target)
        low, high = s[np.clip(above - 1, 0, s.size - 1)], s[np.clip(above, 0, s.size - 1)]
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self._curve(middle) < target
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where((above < s.size) & (target >= 0), high, np.nan)
