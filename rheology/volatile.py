"""A solvent on its way into the air: what its loss needs, from the library or given.

For both sides of Eq. (43a) to agree, C is the vapour's *mass concentration over the liquid's density*, ``p_v M/(R T rho_l)``
(1.73e-5 for water at 293 K). ``convention="yarin2001"`` takes the mole ratio ``p_v / p`` instead (0.023), as the 2001 paper and
the simulators that follow it: ``rho_l R T/(p M)`` times as fast, 1300 for water.
"""

from dataclasses import dataclass
from typing import Literal, Self, get_args

from spinline.base.checks import number, positive
from spinline.base.errors import InputError
from spinline.rheology import vapour

__all__ = ["Convention", "Volatile"]

Convention = Literal["mass", "yarin2001"]


@dataclass(frozen=True)
class Volatile:
    """A solvent on its way into the air.

    Attributes
    ----------
    name : str
        For results and errors.
    saturation : float
        C_eq over the pure liquid, dimensionless: `vapour.vapour_concentration`, or the mole ratio in the 2001 convention.
    diffusivity : float
        D_a of the vapour in air, m2/s.
    ambient : float
        Its partial pressure far away over its vapour pressure (relative humidity), 0 or in [1e-12, 1).
    chi : float
        Flory-Huggins interaction with the polymer, in [-5, 5].
    molar_volume : float
        m3/mol; matters in mixtures and for Raoult's law.
    """

    name: str
    saturation: float
    diffusivity: float
    ambient: float = 0.0
    chi: float = 0.0
    molar_volume: float = 1e-4

    def __post_init__(self) -> None:
        number(f"{self.name}.saturation", self.saturation, above=0.0, most=1e12)
        number(f"{self.name}.diffusivity", self.diffusivity, least=1e-30, most=1e12, unit="m2/s")
        number(f"{self.name}.molar_volume", self.molar_volume, least=1e-30, most=1e12, unit="m3/mol")
        ambient = number(
            f"{self.name}.ambient", self.ambient, least=0.0, below=1.0, remedy="give the relative humidity"
        )
        if 0 < ambient < 1e-12:
            raise InputError(f"{self.name}.ambient", "is too small to matter", value=ambient, remedy="give 0")
        number(f"{self.name}.chi", self.chi, least=-5.0, most=5.0)

    @classmethod
    def build(
        cls,
        name: str,
        temperature: float = 293.15,
        *,
        ambient: float = 0.0,
        chi: float = 0.0,
        convention: Convention = "mass",
        pressure: float = 101325.0,
        density: float | None = None,
        vapour_pressure: float | None = None,
        molar_mass: float | None = None,
        diffusivity: float | None = None,
    ) -> Self:
        """Volatile from library properties at a temperature (K); any of them can be given (SI) instead.

        Raises
        ------
        InputError
            For a property that is neither built in nor given, and how to give it; an unknown convention.
        """
        from spinline.rheology.materials import SOLVENTS, solvent_density

        if not isinstance(convention, str) or convention not in get_args(Convention):
            raise InputError("convention", "is not known", value=convention, allowed='"mass", "yarin2001"')
        kelvin, p = positive("temperature", temperature, "K"), positive("pressure", pressure, "Pa")
        if not isinstance(name, str):
            raise InputError("solvent", "is not a name", value=name)
        name = {key.lower(): key for key in SOLVENTS}.get(name.strip().lower(), name)
        if density is None and name not in SOLVENTS:
            raise InputError(f"density of {name}", "is not built in", remedy="give density (kg/m3)")
        rho = solvent_density(name, kelvin) if density is None else positive("density", density, "kg/m3")
        mass = vapour.molar_mass(name) if molar_mass is None else positive("molar_mass", molar_mass, "kg/mol")
        p_v = vapour.vapour_pressure(name, kelvin) if vapour_pressure is None else vapour_pressure
        p_v = positive("vapour_pressure", p_v, "Pa")
        if p_v >= p:
            raise InputError("temperature", f"is above the boiling point of {name}", value=kelvin, remedy="lower it")
        mass_ratio = float(vapour.vapour_concentration(p_v, mass, rho, kelvin))
        spread = vapour.vapour_diffusivity(name, kelvin, p) if diffusivity is None else diffusivity
        return cls(name, mass_ratio if convention == "mass" else p_v / p, spread, ambient, chi, mass / rho)
