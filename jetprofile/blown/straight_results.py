"""What a straight blown jet is made of, and what its solution holds."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from spinline.base.checks import FloatArray, number, positive

__all__ = ["BlownSolution", "Law", "StraightBlownJet", "Verdict"]

Law = Literal["newton", "ucm", "oldroyd-b", "fene-p"]
Verdict = Literal["converged", "compressed", "critical", "slack"]


@dataclass(frozen=True)
class BlownSolution:
    """Solution that is blown.

    Attributes
    ----------
    flow_rate : float
        Q, m3/s.
    radius : float
        At the nozzle, m.
    density, viscosity, surface_tension : float
        kg/m3, Pa s (zero shear, solvent included), N/m.
    relaxation_time : float
        theta, s; 0 for a Newtonian solution.
    solvent_viscosity : float
        mu_s, Pa s, below the viscosity.
    extensibility : float
        L^2 of FENE-P, above 3; 0: the strands have no end (the other laws).
    """

    flow_rate: float
    radius: float
    density: float
    viscosity: float
    surface_tension: float
    relaxation_time: float = 0.0
    solvent_viscosity: float = 0.0
    extensibility: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("flow_rate", "m3/s"), ("radius", "m"), ("density", "kg/m3"), ("viscosity", "Pa s")):
            positive(name, getattr(self, name), unit)
        number("surface_tension", self.surface_tension, least=0.0, unit="N/m")
        number("relaxation_time", self.relaxation_time, least=0.0, unit="s")
        number("solvent_viscosity", self.solvent_viscosity, least=0.0, below=self.viscosity, unit="Pa s")
        if number("extensibility", self.extensibility, least=0.0) != 0:
            number("extensibility", self.extensibility, above=3.0)

    @property
    def velocity(self) -> float:
        """At the nozzle, m/s."""
        return self.flow_rate / (np.pi * self.radius**2)

    @property
    def modulus(self) -> float:
        """``(mu - mu_s)/theta``, Pa; inf without relaxation."""
        return (self.viscosity - self.solvent_viscosity) / self.relaxation_time if self.relaxation_time else np.inf


@dataclass(frozen=True, eq=False)
class StraightBlownJet:
    """Profile along z; arrays (n,), SI. Without a profile (verdict critical, slack) they are empty.

    Attributes
    ----------
    z, velocity, radius, air_velocity : ndarray
    tension : ndarray
        F, N, capillarity included.
    axial_stress : ndarray
        ``(F - pi a sigma)/f``, Pa.
    axial_conformation, radial_conformation : ndarray
        A_zz, A_rr; 1 for newton.
    wave_speed_squared : ndarray
        c_b^2 of bending waves, m2/s2: below 0 bending grows on any mesh (`bending_onset`).
    verdict, message : str
    force_balance : float
        What the integrated momentum leaves over, relative to the largest force.
    bending_start : float
        z* in m: first place with c_b^2 > 0; NaN if there is none.
    """

    z: FloatArray
    velocity: FloatArray
    radius: FloatArray
    air_velocity: FloatArray
    tension: FloatArray
    axial_stress: FloatArray
    axial_conformation: FloatArray
    radial_conformation: FloatArray
    wave_speed_squared: FloatArray
    verdict: Verdict
    message: str
    force_balance: float
    bending_start: float

    def at(self, z: float) -> dict[str, float]:
        """Every field at one place, by cubic interpolation between the points."""
        from scipy.interpolate import CubicSpline

        place = number("z", z, least=float(self.z[0]), most=float(self.z[-1]), unit="m")
        names = (
            "radius",
            "velocity",
            "air_velocity",
            "tension",
            "axial_stress",
            "axial_conformation",
            "radial_conformation",
        )
        return {name: float(CubicSpline(self.z, getattr(self, name))(place)) for name in names}
