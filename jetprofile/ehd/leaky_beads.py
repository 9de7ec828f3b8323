"""Leaky-dielectric bead of Carroll and Joo: the part of its charge that the field acts on, and its path.

Of the current I the surface carries ``c_eff = 1 - pi r^2 K E / I``; the rest is conducted and pulls nothing. A bead of that
charge on an Oldroyd-B dumbbell, its upper end held at the nozzle (the two-body model of the review, Eqs. 13-15 with c_eff q
for q and a solvent stress), draws the radius profile as it moves::

    m z'' = -pi r^2 (s_p + mu_s z'/z) + c_eff q E + (c_eff q)^2 / (4 pi eps_0 z^2) + m g,   r^2 z = r_0^2 z_0
    s_p' = G z'/z - s_p / theta

Fig. 21 (4000 ppm polyisobutylene Boger fluid) gives r_0, alpha, G, K, mu_0, mu_s/mu and I, not Q, E, h, rho, eps or the
speed: it cannot be reproduced from the review. Its G = 328 dyn/cm2 is mu_0/theta; the polymer's share is 173.5. Its c_eff is
negative at r_0 = 0.05 cm for any E above 2.546 statV/cm (0.763 kV/cm): more current would be conducted than flows.

References
----------
Carroll and Joo, J. Appl. Phys. 109, 094315 (2011); review Eq. (17) and Fig. 21.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.constants import EPS0
from spinline.base.errors import InputError

__all__ = ["FIG21", "LeakyBeads", "effective_charge"]

# What the caption of Fig. 21 gives, SI
FIG21 = {
    "radius": 5e-4,  # m
    "surface_tension": 14.6e-3,  # N/m
    "viscosity": 0.102,  # Pa s
    "solvent_share": 0.471,
    "conductivity": 270 * 4 * np.pi * EPS0,  # S/m: 270 1/s
    "current": 5.4 / 2.99792458e9,  # A
    "relaxation_time": 3.11e-3,  # s
}


@computable
def effective_charge(
    radius: ArrayLike, electric_field: ArrayLike, *, conductivity: float, current: float
) -> FloatArray:
    """``c_eff = 1 - pi r^2 K E / I``, the share of the charge on the surface; negative where that cannot be.

    Examples
    --------
    >>> field = 2.546 * 29979.2458  # V/m
    >>> abs(float(effective_charge(5e-4, field, conductivity=FIG21["conductivity"], current=FIG21["current"]))) < 1e-3
    True
    """
    area, field = (
        np.pi * real("radius", radius, least=0.0, unit="m") ** 2,
        real("electric_field", electric_field, unit="V/m"),
    )
    sigma = number("conductivity", conductivity, least=0.0, unit="S/m")
    value: FloatArray = 1 - area * sigma * field / positive("current", current, "A")
    return value


@dataclass(frozen=True)
class LeakyBeads:
    """Two beads, the upper one at the nozzle, with effective charge.

    Parameters
    ----------
    radius, flow_rate, current : float
        r_0 (m), Q (m3/s), I (A): the bead's charge is I / Q times its volume.
    electric_field, conductivity : float
        E (V/m), K (S/m).
    viscosity, solvent_share, relaxation_time, density : float
        mu (Pa s), mu_s / mu, theta (s), rho (kg/m3).
    length : float
        First length z_0 of the dumbbell, m.
    gravity : float
        m/s2.
    """

    radius: float
    flow_rate: float
    current: float
    electric_field: float
    conductivity: float
    viscosity: float
    solvent_share: float
    relaxation_time: float
    density: float
    length: float
    gravity: float = 9.81

    def __post_init__(self) -> None:
        names = (
            "radius",
            "flow_rate",
            "current",
            "electric_field",
            "viscosity",
            "relaxation_time",
            "density",
            "length",
        )
        for name in names:
            positive(name, getattr(self, name))
        number("conductivity", self.conductivity, least=0.0, unit="S/m")
        number("solvent_share", self.solvent_share, least=0.0, below=1.0)
        share = float(
            effective_charge(self.radius, self.electric_field, conductivity=self.conductivity, current=self.current)
        )
        if share < 0:
            most = self.current / (np.pi * self.radius**2 * self.conductivity)
            raise InputError(
                "electric_field",
                "conducts more than the whole current through the jet at the nozzle",
                value=self.electric_field,
                allowed=f"(0, {most:.6g}] V/m",
                remedy="a thinner start, or the measured current",
            )

    def path(self, end: float, points: int = 200) -> dict[str, FloatArray]:
        """Follow the lower bead to `end` (m).

        Returns
        -------
        dict
            time (s), position (m), radius (m), velocity (m/s), stress (Pa, the polymer's), charge_share.
        """
        positive("end", end, "m")
        if end <= self.length:
            raise InputError("end", "must lie beyond the first length of the dumbbell", value=end)
        volume = np.pi * self.radius**2 * self.length
        mass, charge = self.density * volume, self.current / self.flow_rate * volume
        modulus = self.viscosity * (1 - self.solvent_share) / self.relaxation_time
        solvent = self.viscosity * self.solvent_share

        def rate(_: float, y: FloatArray) -> list[float]:
            z, v, stress = y
            area = volume / z
            share = 1 - area * self.conductivity * self.electric_field / self.current
            q = share * charge
            force = -area * (stress + solvent * v / z) + q * self.electric_field + q**2 / (4 * np.pi * EPS0 * z**2)
            return [v, force / mass + self.gravity, modulus * v / z - stress / self.relaxation_time]

        def there(_: float, y: FloatArray) -> float:
            return float(y[0] - end)

        there.terminal = True  # type: ignore[attr-defined]
        speed = self.flow_rate / (np.pi * self.radius**2)
        longest = 1e3 * end / speed
        done: Any = solve_ivp(
            rate,
            (0, longest),
            [self.length, speed, 0.0],
            method="LSODA",
            events=there,
            rtol=1e-9,
            atol=1e-12,
            dense_output=True,
        )
        if not done.t_events[0].size:
            raise InputError("end", "is not reached by the bead: the pull is too weak", value=end)
        time = np.linspace(0, done.t_events[0][0], points)
        z, v, stress = done.sol(time)
        r = np.sqrt(volume / (np.pi * z))
        share = effective_charge(r, self.electric_field, conductivity=self.conductivity, current=self.current)
        return {"time": time, "position": z, "radius": r, "velocity": v, "stress": stress, "charge_share": share}
