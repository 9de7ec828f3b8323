"""The moving air: a round turbulent jet, a wind, or a table from a flow calculation.

Round free jet (x along it from the nozzle's face, r across)::

    U = U_c exp(-ln 2 r^2/b^2)     b = S x     U_c = U_0 min(1, B d/x)          Gaussian (default)
    U = U_c (1 + (2^(1/2) - 1) r^2/b^2)^-2                                      Schlichting

S is measured (0.094); B is *not free*: the momentum flux is that of the exit, so ``B = (ln 2/2)^(1/2)/S`` = 6.2628 (Gaussian)
or ``(3 (2^(1/2) - 1))^(1/2)/(2 S)`` = 5.9295. In the potential core, x < B d, a top hat of radius r_c with the same profile as
its mixing layer; r_c from the momentum flux, exact at every x. Entrained mass over that of the exit: 0.3193 x/d (Gaussian;
Ricou and Spalding measured 0.32), 0.506 (Schlichting: its tails are too fat, hence the default). A jet of another density than
the air outside goes by the diameter ``d (rho_e/rho_air)^(1/2)``, far from the nozzle.

Left out: the stagnation flow before a collector (the free jet is wrong within about two footprints of it), several air jets
merging, air slowed by the polymer.

References
----------
Hussein, Capp, George, J. Fluid Mech. 258, 31 (1994) (S, B); Ricou, Spalding, J. Fluid Mech. 11, 21 (1961); Schlichting,
Boundary-Layer Theory.
"""

from dataclasses import dataclass, field
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError

__all__ = ["Air", "AirJet", "AirTable", "Wind"]

Profile = Literal["gaussian", "schlichting"]
_ALPHA = float(np.sqrt(2.0) - 1)


class Air(Protocol):
    """Mean velocity of the air along the spinning axis."""

    @property
    def density(self) -> float:
        """kg/m3."""

    @property
    def kinematic_viscosity(self) -> float:
        """m2/s."""

    def velocity(self, x: ArrayLike, r: ArrayLike = 0.0) -> FloatArray:
        """Axial velocity at x along and r across, m/s."""

    def fluctuation(self, x: ArrayLike) -> FloatArray:
        """Root mean square of one component's fluctuation on the axis, m/s."""

    def kinks(self) -> tuple[float, ...]:
        """Places along the axis where the velocity has a kink, m."""


@dataclass(frozen=True)
class AirJet:
    """Round turbulent air jet.

    Attributes
    ----------
    diameter : float
        d of the nozzle, m.
    exit_velocity : float
        U_0, m/s, >= 0.
    spread : float
        S, in [0.05, 0.2].
    profile : {"gaussian", "schlichting"}
    intensity : float
        I: root mean square fluctuation over U_c, in [0, 1].
    density, kinematic_viscosity : float
        Of the air around, kg/m3 and m2/s.
    exit_density : float, optional
        kg/m3, where the jet's gas is not that of the air.
    """

    diameter: float
    exit_velocity: float
    spread: float = 0.094
    profile: Profile = "gaussian"
    intensity: float = 0.2
    density: float = 1.205
    kinematic_viscosity: float = 1.51e-5
    exit_density: float | None = None
    core_constant: float = field(init=False)  # B

    def __post_init__(self) -> None:
        positive("nozzle_diameter", self.diameter, "m")
        number("air_velocity", self.exit_velocity, least=0.0, most=1500.0, unit="m/s")
        s = number("spread", self.spread, least=0.05, most=0.2)
        number("turbulence_intensity", self.intensity, least=0.0, most=1.0)
        positive("air density", self.density, "kg/m3")
        positive("air kinematic viscosity", self.kinematic_viscosity, "m2/s")
        if self.profile not in get_args(Profile):
            raise InputError(
                "profile",
                "is not known",
                value=self.profile,
                allowed='"gaussian", "schlichting"',
                remedy="take one of them",
            )
        ratio = 1.0 if self.exit_density is None else positive("exit_density", self.exit_density) / self.density
        b = np.sqrt(np.log(2.0) / 2) / s if self.profile == "gaussian" else np.sqrt(3 * _ALPHA) / (2 * s)
        object.__setattr__(self, "core_constant", float(b * np.sqrt(ratio)))

    @property
    def core_length(self) -> float:
        """B d, m: end of the potential core."""
        return self.core_constant * self.diameter

    def centre(self, x: ArrayLike) -> FloatArray:
        """U_c, m/s; x >= 0."""
        z = real("x", x, least=0.0, unit="m")
        return np.asarray(self.exit_velocity * np.minimum(1.0, self.core_length / np.maximum(z, 1e-300)))

    def core_radius(self, x: ArrayLike) -> FloatArray:
        """r_c, m: radius at full exit velocity; 0 beyond the core."""
        z = np.minimum(real("x", x, least=0.0, unit="m"), self.core_length)
        b = self.spread * z
        if self.profile == "gaussian":
            linear, rest = b * np.sqrt(np.pi / (2 * np.log(2.0))), b**2 / (2 * np.log(2.0))
        else:
            linear, rest = b / np.sqrt(_ALPHA) * 5 * np.pi / 16, b**2 / (3 * _ALPHA)
        end = (self.spread * self.core_length) ** 2
        full = end / (2 * np.log(2.0)) if self.profile == "gaussian" else end / (3 * _ALPHA)
        gap = np.maximum(full - rest, 0.0)  # r_c^2 + linear r_c = gap
        return np.asarray(2 * gap / (linear + np.sqrt(linear**2 + 4 * gap) + 1e-300))

    def velocity(self, x: ArrayLike, r: ArrayLike = 0.0) -> FloatArray:
        """Axial velocity, m/s."""
        z, across = np.broadcast_arrays(real("x", x, least=0.0, unit="m"), np.abs(real("r", r, unit="m")))
        beyond = np.maximum(across - self.core_radius(z), 0.0)
        with np.errstate(over="ignore"):  # far outside
            share = np.minimum(beyond / np.maximum(self.spread * z, 1e-300), 1e150)
            shape = np.exp(-np.log(2.0) * share**2) if self.profile == "gaussian" else (1 + _ALPHA * share**2) ** -2
        return np.asarray(self.centre(z) * shape)

    def fluctuation(self, x: ArrayLike) -> FloatArray:
        """I U_c; in the core it grows in proportion to x."""
        z = real("x", x, least=0.0, unit="m")
        return np.asarray(self.intensity * self.centre(z) * np.minimum(1.0, z / self.core_length))

    def kinks(self) -> tuple[float, ...]:
        """End of the core."""
        return (self.core_length,)


@dataclass(frozen=True)
class Wind:
    """Air of one velocity along the jet, m/s; 0 is still air."""

    speed: float
    intensity: float = 0.0
    density: float = 1.205
    kinematic_viscosity: float = 1.51e-5

    def __post_init__(self) -> None:
        number("air_velocity", self.speed, least=-1500.0, most=1500.0, unit="m/s")
        number("turbulence_intensity", self.intensity, least=0.0, most=1.0)
        positive("air density", self.density, "kg/m3")
        positive("air kinematic viscosity", self.kinematic_viscosity, "m2/s")

    def velocity(self, x: ArrayLike, r: ArrayLike = 0.0) -> FloatArray:
        """The same everywhere."""
        z, across = np.broadcast_arrays(real("x", x), real("r", r))
        return np.full(np.broadcast(z, across).shape, float(self.speed))

    def fluctuation(self, x: ArrayLike) -> FloatArray:
        """I U."""
        return np.full(real("x", x).shape, self.intensity * abs(self.speed))

    def kinks(self) -> tuple[float, ...]:
        """None."""
        return ()


@dataclass(frozen=True, eq=False)
class AirTable:
    """Air from a calculation: velocity, and optionally turbulence energy k, along the axis.

    Attributes
    ----------
    x, speed : array_like
        m rising from 0 or below, m/s; linear between.
    energy : array_like, optional
        k, m2/s2; one component fluctuates by ``(2 k/3)^(1/2)``.
    half_width : float, optional
        Radius at half velocity as a share of x (a Gaussian across); default: none, the same across.
    """

    x: ArrayLike
    speed: ArrayLike
    energy: ArrayLike = 0.0
    half_width: float | None = None
    density: float = 1.205
    kinematic_viscosity: float = 1.51e-5

    def __post_init__(self) -> None:
        z, u = real("air table x", self.x, unit="m"), real("air table speed", self.speed, unit="m/s")
        if z.ndim != 1 or z.size < 2 or u.shape != z.shape or not (np.diff(z) > 0).all():
            raise InputError("air table", "needs two rows or more, x rising", value=f"shapes {z.shape}, {u.shape}")
        k = np.broadcast_to(real("air table energy", self.energy, least=0.0, unit="m2/s2"), z.shape)
        for name, value in (("x", z), ("speed", u), ("energy", k)):
            object.__setattr__(self, name, value)

    def velocity(self, x: ArrayLike, r: ArrayLike = 0.0) -> FloatArray:
        """Linear between the rows; outside them an error."""
        z, across = np.broadcast_arrays(self._inside(x), real("r", r, unit="m"))
        out = np.interp(z, np.asarray(self.x), np.asarray(self.speed))
        if self.half_width is not None:
            out = out * np.exp(
                -np.log(2.0) * np.minimum(np.abs(across) / np.maximum(self.half_width * z, 1e-300), 1e3) ** 2
            )
        return np.asarray(out)

    def fluctuation(self, x: ArrayLike) -> FloatArray:
        """``(2 k/3)^(1/2)``."""
        return np.asarray(np.sqrt(2 / 3 * np.interp(self._inside(x), np.asarray(self.x), np.asarray(self.energy))))

    def kinks(self) -> tuple[float, ...]:
        """The rows, up to 200 of them."""
        rows = np.asarray(self.x).tolist()
        return tuple(rows) if len(rows) <= 200 else ()

    def _inside(self, x: ArrayLike) -> FloatArray:
        z = np.asarray(self.x)
        return real("x", x, least=float(z[0]), most=float(z[-1]), unit="m", remedy="extend the table of the air")
