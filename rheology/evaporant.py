"""A liquid that leaves or enters a jet, with all that its loss and its heat need, against temperature.

From the library by name (`Evaporant.build`), any property given instead; or from constants alone (`Evaporant.given`):
a vapour pressure at one temperature, carried on by Clausius and Clapeyron with the heat of vaporisation. Inside, ``ln
p``, the heat of vaporisation and the part of the pressure that dimers have are cubic splines in T, 3 K apart: to 1e-8
of the library's.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Self

import numpy as np

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.rheology import thermal, vapour
from spinline.rheology.names import known_as

__all__ = ["GRID", "Evaporant"]

GRID = np.arange(thermal.COLDEST, thermal.HOTTEST + 1.0, 3.0)  # K
REFERENCE = 298.15  # K of the diffusivity
_TYPICAL = {
    "density": "700 to 1600 kg/m3",
    "molar_mass": "0.02 to 0.2 kg/mol",
    "vapour_pressure": "0.1 to 60 kPa",
    "latent_heat": "0.2 to 2.4 MJ/kg",
    "heat_capacity": "1000 to 2500 J/kg/K",
    "diffusivity": "0.7e-5 to 2.5e-5 m2/s",
}


@dataclass(frozen=True, eq=False)
class Evaporant:
    """A liquid on its way into the air, or the air's water on its way into a jet.

    Attributes
    ----------
    name : str
    molar_mass, density, heat_capacity, vapour_heat_capacity : float
        kg/mol, kg/m3 of the liquid (held constant), J/kg/K of liquid and vapour.
    diffusivity : float
        Of the vapour in air at 298.15 K and the pressure of the air, m2/s; it goes as T^1.75.
    chi : float
        Flory-Huggins interaction with the polymer, in [-5, 5].
    ambient_pressure : float
        Partial pressure far away, Pa.
    laws : ndarray, (3, 4, pieces)
        Splines of ln(p/Pa), heat of vaporisation (J/kg), share of dimers, on `GRID`.
    """

    name: str
    molar_mass: float
    density: float
    heat_capacity: float
    vapour_heat_capacity: float
    diffusivity: float
    chi: float
    ambient_pressure: float
    laws: FloatArray

    def __post_init__(self) -> None:
        for key in ("molar_mass", "density", "heat_capacity", "vapour_heat_capacity", "diffusivity"):
            number(f"{self.name}.{key}", getattr(self, key), least=1e-30, most=1e30)
        number(f"{self.name}.chi", self.chi, least=-5.0, most=5.0)
        number(f"{self.name}.ambient_pressure", self.ambient_pressure, least=0.0, most=1e12, unit="Pa")

    @classmethod
    def build(
        cls,
        name: str,
        temperature: float = 298.15,
        *,
        ambient_pressure: float = 0.0,
        chi: float = 0.0,
        pressure: float = 101325.0,
        density: float | None = None,
        molar_mass: float | None = None,
        vapour_pressure: float | None = None,
        latent_heat: float | None = None,
        heat_capacity: float | None = None,
        vapour_heat_capacity: float | None = None,
        diffusivity: float | None = None,
    ) -> Self:
        """From the library, or from what is given.

        Parameters
        ----------
        name : str
            Of the library, or any other: then density, molar_mass, vapour_pressure, latent_heat, heat_capacity and
            diffusivity are needed.
        temperature : float
            K, at which density, vapour_pressure and diffusivity are given.
        ambient_pressure, chi
            As for the class.
        pressure : float
            Of the air, Pa.
        density, molar_mass, vapour_pressure, latent_heat, heat_capacity, vapour_heat_capacity, diffusivity : float,
        optional
            SI. A vapour pressure of a library solvent scales its curve.

        Raises
        ------
        InputError
            For a property nobody knows, with what is typical.
        """
        if not isinstance(name, str):
            raise InputError("solvent", "is not a name", value=name)
        kelvin = number("temperature", temperature, least=thermal.COLDEST, most=thermal.HOTTEST, unit="K")
        known = known_as(name, vapour.VAPOURS)
        if known is None:
            needed = {
                "density": density,
                "molar_mass": molar_mass,
                "vapour_pressure": vapour_pressure,
                "latent_heat": latent_heat,
                "heat_capacity": heat_capacity,
                "diffusivity": diffusivity,
            }
            for key, value in needed.items():
                if value is None:
                    raise InputError(f"{key} of {name}", "is not built in", remedy=f"give it: {_TYPICAL[key]} is usual")
        mass = _or(molar_mass, lambda: vapour.molar_mass(name), "molar_mass")
        heat = _or(heat_capacity, lambda: thermal.liquid_heat_capacity(name), "heat_capacity")
        spread = _or(diffusivity, lambda: vapour.vapour_diffusivity(name, kelvin, pressure), "diffusivity")
        if density is None:
            from spinline.rheology.solvents import solvent_density

            density = solvent_density(name, kelvin)
        return cls(
            name=known or name,
            molar_mass=mass,
            density=positive("density", density, "kg/m3"),
            heat_capacity=heat,
            vapour_heat_capacity=(
                0.6 * heat
                if vapour_heat_capacity is None and known is None
                else _or(vapour_heat_capacity, lambda: thermal.vapour_heat_capacity(name), "vapour_heat_capacity")
            ),
            diffusivity=spread * (REFERENCE / kelvin) ** 1.75,
            chi=chi,
            ambient_pressure=ambient_pressure,
            laws=_laws(known, kelvin, mass, vapour_pressure, latent_heat),
        )

    def in_air(self, ambient_pressure: float) -> Self:
        """The same in air with another partial pressure of it (Pa)."""
        return replace(self, ambient_pressure=ambient_pressure)

    def pressure(self, temperature: float) -> float:
        """Vapour pressure of the pure liquid, Pa."""
        return float(np.exp(self._at(0, temperature)))

    def pressures(self, temperature: FloatArray) -> FloatArray:
        """`pressure` at temperatures of any shape."""
        kelvin = real("temperature", temperature, least=GRID[0], most=GRID[-1], unit="K")
        i = np.minimum(((kelvin - GRID[0]) / (GRID[1] - GRID[0])).astype(int), GRID.size - 2)
        c, t = self.laws[0][:, i], kelvin - GRID[i]
        value: FloatArray = np.exp(((c[0] * t + c[1]) * t + c[2]) * t + c[3])
        return value

    def latent_heat(self, temperature: float) -> float:
        """Heat of vaporisation, J/kg."""
        return self._at(1, temperature)

    def dew_point(self) -> float:
        """Temperature at which the air's partial pressure is saturation, K; NaN where there is none of it in the
        air.
        """
        if self.ambient_pressure <= 0:
            return float("nan")
        from scipy.optimize import brentq

        goal = float(np.log(self.ambient_pressure))
        low, high = thermal.COLDEST, thermal.HOTTEST
        if not self._at(0, low) < goal < self._at(0, high):
            return float("nan")
        return float(brentq(lambda t: self._at(0, t) - goal, low, high, xtol=1e-10))

    def _at(self, which: int, temperature: float) -> float:
        kelvin = number("temperature", temperature, least=GRID[0], most=GRID[-1], unit="K")
        i = min(int((kelvin - GRID[0]) / (GRID[1] - GRID[0])), GRID.size - 2)
        c, t = self.laws[which, :, i], kelvin - GRID[i]
        return float(((c[0] * t + c[1]) * t + c[2]) * t + c[3])


def _or(given: float | None, otherwise: object, field: str) -> float:
    value = given if given is not None else otherwise()  # type: ignore[operator]
    return positive(field, value)


def _laws(
    name: str | None, kelvin: float, mass: float, vapour_pressure: float | None, latent_heat: float | None
) -> FloatArray:
    if name is not None:
        built = _library(name)
        if vapour_pressure is None and latent_heat is None:
            return built
        laws = built.copy()
        if vapour_pressure is not None:
            library = float(thermal.saturation_pressure(name, kelvin))
            laws[0, 3] += np.log(positive("vapour_pressure", vapour_pressure, "Pa") / library)
        if latent_heat is not None:
            laws[1] = _spline(np.full(GRID.size, positive("latent_heat", latent_heat, "J/kg")))
        return laws
    p, heat = positive("vapour_pressure", vapour_pressure, "Pa"), positive("latent_heat", latent_heat, "J/kg")
    log_p = np.log(p) - heat * mass / vapour.GAS_CONSTANT * (1 / GRID - 1 / kelvin)
    return np.stack([_spline(log_p), _spline(np.full(GRID.size, heat)), _spline(np.zeros(GRID.size))])


@lru_cache(maxsize=64)
def _library(name: str) -> FloatArray:
    p = thermal.saturation_pressure(name, GRID)
    values = (np.log(p), thermal.vaporisation_heat(name, GRID), thermal.dimer_share(name, GRID, p))
    laws = np.stack([_spline(v) for v in values])
    laws.flags.writeable = False
    return laws


def _spline(values: FloatArray) -> FloatArray:
    from scipy.interpolate import CubicSpline

    return np.ascontiguousarray(CubicSpline(GRID, values).c)
