"""What is set on the bench and known of the solution, and the dimensionless numbers of the jet that follow.

With the radius r_0 and velocity v_0 of the needle and the mean field ``E_s = V / H``::

    Re = rho v_0 r_0 / mu     We = rho v_0^2 r_0 / gamma     Fr = v_0^2 / (g r_0)     De = theta v_0 / r_0
    Pe = 2 eps_0 v_0 / (K r_0)     El = eps_0 E_s^2 / (rho v_0^2)     Ca = mu v_0 / gamma
    A = Re El = eps_0 E_s^2 r_0 / (mu v_0)     B = 2 / Pe = K r_0 / (eps_0 v_0)     chi = L / r_0
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property, partial
from typing import Any, Literal

import numpy as np

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.constants import EPS0
from spinline.base.errors import InputError
from spinline.jetprofile.ehd.boundary_value import Problem, Work
from spinline.jetprofile.ehd.fields import AppliedField, HyperboloidField, NeedleField, UniformField

__all__ = ["FIELDS", "LAWS", "NeedleSettings"]

LAWS = ("fene-p", "oldroyd-b", "giesekus", "newtonian")
FIELDS = {"hyperboloid": HyperboloidField, "needle": NeedleField, "uniform": UniformField}

# name: (least, most, unit)
_RANGES = {
    "radius": (1e-7, 1e-1, "m"),
    "flow_rate": (1e-18, 1e-2, "m3/s"),
    "voltage": (1e-3, 1e7, "V"),
    "gap": (1e-6, 1e2, "m"),
    "conductivity": (1e-16, 1e8, "S/m"),
    "surface_tension": (1e-9, 1e2, "N/m"),
    "viscosity": (1e-7, 1e7, "Pa s"),
    "density": (1e-1, 1e5, "kg/m3"),
    "permittivity": (1.0, 1e6, ""),
}


@dataclass(frozen=True)
class NeedleSettings:
    """A needle at a voltage over a plate, a solution, and the model of its straight jet. All SI.

    Parameters
    ----------
    radius : float
        Radius r_0 in m of the needle, or of the line where the drop is held.
    flow_rate, voltage, gap : float
        Q (m3/s), V (V), H (m): needle's tip to plate.
    conductivity, surface_tension, viscosity, density : float
        K (S/m), gamma (N/m), zero-shear mu (Pa s), rho (kg/m3) of the solution.
    permittivity : float
        Relative permittivity, >= 1.
    relaxation_time : float
        theta in s, >= 0; with 0 the jet is Newtonian.
    law : {"fene-p", "oldroyd-b", "giesekus", "newtonian"}
        Constitutive law. Oldroyd-B has no steady jet beyond a Deborah number of the setup; FENE-P always locks.
    solvent_share : float
        rs, share of the viscosity that is the solvent's, in [0.005, 1); the smaller, the stiffer.
    extensibility : float, optional
        L2 of FENE-P, > 3; ``phi^-2`` for a network of Kuhn segments. Needed by "fene-p".
    mobility : float
        Giesekus's a, in [0, 1].
    field : {"hyperboloid", "needle", "uniform"} or AppliedField
        Field of the electrodes. "uniform" is V / H, never the field at a needle.
    log : {"local", "constant", "slender"}
        Slenderness ``ln(L / r)``, whose force is that of an energy, or Feng's ``ln(L / r_0)``; or "slender", the potential of
        the whole charged line with its answers in needle and plate (`whole_line`): what a hand-over to a moving jet needs.
    end : float, optional
        L in m: where the end condition and the logarithm's length lie. Default the gap.
    current : float, optional
        I in A where it was measured; otherwise it is predicted, to a factor of five.
    gravity : float
        g in m/s2 along the jet; negative for a jet that climbs.
    end_factor : float
        Strain rate at the end over Feng's ``v / (2 L)``; 0.5 to 2 tells what the end condition is worth.
    """

    radius: float
    flow_rate: float
    voltage: float
    gap: float
    conductivity: float
    surface_tension: float
    viscosity: float
    density: float
    permittivity: float
    relaxation_time: float = 0.0
    law: Literal["fene-p", "oldroyd-b", "giesekus", "newtonian"] = "fene-p"
    solvent_share: float = 0.1
    extensibility: float | None = None
    mobility: float = 0.0
    field: str | AppliedField = "hyperboloid"
    log: Literal["local", "constant", "slender"] = "local"
    end: float | None = None
    current: float | None = None
    gravity: float = 9.81
    end_factor: float = 1.0

    def __post_init__(self) -> None:
        for name, (least, most, unit) in _RANGES.items():
            number(name, getattr(self, name), least=least, most=most, unit=unit)
        number("relaxation_time", self.relaxation_time, least=0.0, most=1e6, unit="s")
        number("gravity", self.gravity, least=-1e4, most=1e4, unit="m/s2")
        number("end_factor", self.end_factor, least=0.01, most=100.0)
        number("mobility", self.mobility, least=0.0, most=1.0)
        if self.law not in LAWS:
            raise InputError("law", "is not known", value=self.law, allowed=", ".join(LAWS))
        if self.log not in ("local", "constant", "slender"):
            raise InputError("log", "is not known", value=self.log, allowed="local, constant, slender")
        if isinstance(self.field, str) and self.field not in FIELDS:
            raise InputError("field", "is not known", value=self.field, allowed=", ".join(FIELDS))
        if self.polymer:
            number(
                "solvent_share",
                self.solvent_share,
                least=0.005,
                below=1.0,
                remedy="a jet without any solvent viscosity has no bounded strain rate at the needle",
            )
            if self.law == "fene-p":
                if self.extensibility is None:
                    raise InputError("extensibility", "is missing: FENE-P needs it", remedy="phi^-2 for a network")
                number(
                    "extensibility", self.extensibility, above=3.0, most=1e12, remedy="more than the coil at rest, 3"
                )
        if self.current is not None:
            number("current", self.current, least=1e-18, most=1e3, unit="A")
        if self.end is not None:
            positive("end", self.end, "m")
        length = self.end_position
        if length > self.applied_field.gap * (1 + 1e-9):
            raise InputError(
                "end",
                "lies beyond the plate",
                value=length,
                allowed=f"up to {self.applied_field.gap:g} m",
                remedy="the default is the gap",
            )
        if self.log == "slender" and length < 0.99 * self.applied_field.gap:
            raise InputError(
                "end",
                "cuts the line whose potential is asked",
                value=length,
                allowed=f"the gap, {self.applied_field.gap:g} m",
                remedy='leave it out; or log = "local"',
            )
        real("end", length / self.radius, least=3.0, most=1e6, remedy="end over radius: the jet must be slender")

    @property
    def polymer(self) -> bool:
        """Whether a conformation is carried: a law with a relaxation time that matters at all."""
        return self.law != "newtonian" and self.deborah > 1e-7

    @cached_property
    def applied_field(self) -> AppliedField:
        """The field of the electrodes."""
        if not isinstance(self.field, str):
            return self.field
        if self.field == "uniform":
            return UniformField(self.voltage, self.gap)
        shape = HyperboloidField if self.field == "hyperboloid" else NeedleField
        return shape(self.voltage, self.gap, self.radius)

    @property
    def initial_velocity(self) -> float:
        """v_0 in m/s."""
        return self.flow_rate / (np.pi * self.radius**2)

    @property
    def end_position(self) -> float:
        """L in m."""
        return self.gap if self.end is None else self.end

    @property
    def field_scale(self) -> float:
        """E_s = V / H in V/m."""
        return self.voltage / self.gap

    @property
    def deborah(self) -> float:
        """De = theta v_0 / r_0."""
        return self.relaxation_time * self.initial_velocity / self.radius

    @property
    def modulus(self) -> float:
        """G = mu (1 - rs) / theta in Pa; infinite without relaxation time."""
        return self.viscosity * (1 - self.solvent_share) / self.relaxation_time if self.relaxation_time else np.inf

    @property
    def current_scale(self) -> float:
        """Unit of current, pi r_0^2 K E_s, in A."""
        return float(np.pi * self.radius**2 * self.conductivity * self.field_scale)

    @property
    def force_scale(self) -> float:
        """Unit of force, pi r_0 mu v_0, in N."""
        return float(np.pi * self.radius * self.viscosity * self.initial_velocity)

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The dimensionless numbers of the module, by name."""
        v, r = self.initial_velocity, self.radius
        reynolds = self.density * v * r / self.viscosity
        euler = EPS0 * self.field_scale**2 / (self.density * v**2)
        peclet = 2 * EPS0 * v / (self.conductivity * r)
        return {
            "reynolds": reynolds,
            "weber": self.density * v**2 * r / self.surface_tension,
            "capillary": self.viscosity * v / self.surface_tension,
            "inverse_froude": self.gravity * r / v**2,
            "peclet": peclet,
            "euler": euler,
            "deborah": self.deborah,
            "pull": reynolds * euler,
            "conduction": 2 / peclet,
            "slenderness": self.end_position / r,
        }

    @property
    def pull_against_capillarity(self) -> float:
        """``4 A^(1/3) Ca`` with the field a radius from the tip: below 1/2 capillarity holds the drop."""
        n, near = self.numbers, float(self.applied_field.axial(self.radius)) / self.field_scale
        return float(4 * n["pull"] ** (1 / 3) * near ** (2 / 3) * n["capillary"])

    @cached_property
    def _applied(self) -> Callable[[FloatArray], FloatArray]:
        """Applied field over its scale by place over the radius: one function, so that one mesh asks it once."""
        return partial(_over_scale, self.applied_field, self.field_scale, self.radius, self.end_position)

    @cached_property
    def _last_field(self) -> float:
        return float(self.applied_field.axial(self.end_position)) / self.field_scale

    def problem(
        self, *, charge: bool, predicted: bool, pull: float = 1.0, slack: float = 1.0, work: Work | None = None
    ) -> Problem:
        """The boundary-value problem; `pull` scales every force on the thread alike, `slack` the relaxation time."""
        n, polymer = self.numbers, self.polymer
        chi = n["slenderness"]
        de = self.deborah * slack
        share = self.solvent_share if polymer else 1.0
        limit = 1 / self.extensibility if polymer and self.law == "fene-p" and self.extensibility else 0.0
        parameters = np.array(
            [
                n["reynolds"],
                n["weber"] / pull,
                n["inverse_froude"] * pull,
                n["peclet"],
                n["euler"] * pull,
                self.permittivity - 1,
                np.log(chi),
                1 / de if polymer else 0.0,
                share,
                (1 - share) / de if polymer else 0.0,
                limit,
                self.mobility if self.law == "giesekus" else 0.0,
                self.end_factor / (2 * chi),
                self._last_field,
            ]
        )

        left = [[0, 0.0]]
        if charge:
            left.append([4 + 2 * polymer, 1.0])
        if predicted or self.current is None:
            left.append([2, 0.0])
        else:
            left.append([3, float(np.log(self.current / self.current_scale))])
        if polymer:
            left += [[4, 0.0], [5, 0.0]]
        return Problem(
            parameters, self._applied, chi, np.array(left), polymer, charge, self.log != "constant", work=work
        )

    def as_dict(self) -> dict[str, Any]:
        """Every parameter by name."""
        return {item.name: getattr(self, item.name) for item in fields(self)}


def _over_scale(field: AppliedField, scale: float, radius: float, end: float, s: FloatArray) -> FloatArray:
    return field.axial(np.minimum(s * radius, end)) / scale
