"""The air of a scene for a jet that cools: its solvents with their heats, and the water of the air, wherever there is
any.

Everything is a function of temperature here: vapour pressures from the wet bulb to the nozzle, diffusion and
conduction at the film's temperature. What the scene gives in place of the library's (vapour pressure, diffusivity,
saturation, heats) holds at the temperature of the solution and is carried on from there.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray, number
from spinline.base.errors import InputError
from spinline.rheology.solution import Solution
from spinline.rheology.thermal import COLDEST, HOTTEST
from spinline.scene.air_and_rheology import AmbientSection, RheologySection
from spinline.scene.file import Scene, SolventData
from spinline.setup.air import ATMOSPHERE, humidity_of, interaction_with, library_name, unit_volume, water_with
from spinline.setup.values import given

if TYPE_CHECKING:
    from spinline.rheology.diffusion_laws import DiffusionLaw
    from spinline.rheology.drying import RadialDrying
    from spinline.rheology.element_path import ElementPath
    from spinline.rheology.evaporant import Evaporant
    from spinline.rheology.heat import HeatedJet
    from spinline.rheology.transfer import Transfer

__all__ = ["HeatedAir", "build_heated_air", "heat_refusal"]

_GAS = 8.31446261815324


@dataclass(frozen=True, eq=False)
class HeatedAir:
    """What a jet dries into, cools in, and takes water from.

    Attributes
    ----------
    evaporants : tuple of Evaporant
        The solvents, in their order, and the air's water where it is none of them.
    shares : ndarray, (liquid,)
        Their volume shares in the solvent at the nozzle.
    temperature, air_temperature, pressure, velocity : float
        Of the jet at the nozzle and of the air, K; Pa; m/s along the jet.
    floor : float
        Least Sherwood and Nusselt number.
    transfer : str
    polymer_density, polymer_heat_capacity : float
        kg/m3, J/kg/K.
    polymer_molar_volume : float or None
        For Raoult's law, m3/mol.
    pairs : ndarray or None
        Interactions of the liquids with one another.
    """

    evaporants: "tuple[Evaporant, ...]"
    shares: FloatArray
    temperature: float
    air_temperature: float
    pressure: float
    velocity: float
    floor: float
    transfer: "Transfer"
    polymer_density: float
    polymer_heat_capacity: float
    polymer_molar_volume: float | None
    pairs: FloatArray | None

    def dry(self, path: "ElementPath", volume_fraction: float) -> "HeatedJet":
        """The balance along a path, flat across the jet."""
        from spinline.rheology.heat import dry_with_heat

        return dry_with_heat(
            path,
            volume_fraction,
            self.evaporants,
            self.shares,
            temperature=self.temperature,
            air_temperature=self.air_temperature,
            pressure=self.pressure,
            polymer_density=self.polymer_density,
            polymer_heat_capacity=self.polymer_heat_capacity,
            transfer=self.transfer,
            sherwood_floor=self.floor,
            air_velocity=self.velocity,
            polymer_molar_volume=self.polymer_molar_volume,
            pair_interactions=self.pairs,
        )

    def dry_radially(
        self, path: "ElementPath", volume_fraction: float, diffusion: "DiffusionLaw", cells: int, rtol: float
    ) -> "RadialDrying":
        """The map, of the first solvent alone."""
        from spinline.rheology.heat_map import dry_radially_with_heat

        return dry_radially_with_heat(
            path,
            volume_fraction,
            self.evaporants[0],
            diffusion,
            temperature=self.temperature,
            air_temperature=self.air_temperature,
            pressure=self.pressure,
            polymer_density=self.polymer_density,
            polymer_heat_capacity=self.polymer_heat_capacity,
            transfer=self.transfer,
            sherwood_floor=self.floor,
            air_velocity=self.velocity,
            cells=cells,
            rtol=rtol,
        )

    @property
    def wet_bulb(self) -> float:
        """Temperature of a thread of the first solvent in this air, K; NaN where none evaporates."""
        from spinline.rheology.wet_bulb import wet_bulb

        try:
            return wet_bulb(
                self.evaporants[0],
                self.air_temperature,
                pressure=self.pressure,
                transfer=self.transfer,
                floor=self.floor,
            ).temperature
        except InputError:
            return float("nan")

    @property
    def water(self) -> int:
        """Which of the liquids is water; -1 where none is."""
        return next((i for i, e in enumerate(self.evaporants) if e.name == "water"), -1)

    @property
    def dew_point(self) -> float:
        """Of the air's water, K; NaN in dry air."""
        return float("nan") if self.water < 0 else self.evaporants[self.water].dew_point()

    @property
    def equilibrium(self) -> float:
        """Polymer fraction at which drying ends, at the air's temperature; NaN where that is not one number."""
        from spinline.rheology.vapour import equilibrium_fraction

        wet = [e for e in self.evaporants if e.ambient_pressure > 0]
        if not wet:
            return 1.0
        if len(wet) > 1 or self.polymer_molar_volume is not None:
            return float("nan")
        humidity = wet[0].ambient_pressure / wet[0].pressure(self.air_temperature)
        return equilibrium_fraction(humidity, wet[0].chi) if humidity < 1 else float("nan")

    def __str__(self) -> str:
        parts = [
            f"{e.name}: {e.pressure(self.temperature):.4g} Pa at {self.temperature:.5g} K, "
            f"{e.latent_heat(self.temperature) * 1e-3:.4g} kJ/kg, chi {e.chi:g}, {e.ambient_pressure:.4g} Pa in the air"
            for e in self.evaporants
        ]
        floor = f", floor {self.floor:g}" if self.floor else ""
        return (
            f"with heat; {'; '.join(parts)}; air {self.air_temperature:.5g} K, {self.pressure:.6g} Pa, {self.velocity:g} m/s; "
            f'transfer "{self.transfer}"{floor}'
        )


def heat_refusal(scene: Scene) -> str:
    """Why a scene cannot have heat, by what it asks for; empty where it may."""
    laws = scene.rheology or RheologySection()
    if laws.convention != "mass":
        return f'rheology.convention = "{laws.convention}" is a rate, not vapour that carries heat'
    if laws.activity == "unit":
        return 'rheology.activity = "unit" stops at once where the solvent is gone'
    return ""


def build_heated_air(scene: Scene, solution: Solution) -> HeatedAir:
    """Air and solvents of a scene, with heat.

    Raises
    ------
    InputError
        For what is missing or cannot be, by the key of the scene that gives it.
    """
    why = heat_refusal(scene)
    if why:
        raise InputError("effects.heat", f"cannot be: {why}", value=True, remedy="set effects.heat = false")
    ambient, laws = scene.ambient or AmbientSection(), scene.rheology or RheologySection()
    key = "ambient.temperature" if ambient.temperature is not None else "solution.temperature"
    warm = number(key, given(ambient.temperature, solution.temperature), least=COLDEST, most=HOTTEST, unit="K")
    pressure = given(ambient.pressure, ATMOSPHERE)
    names = [library_name(name) for name in solution.solvent]
    far = _vapour_in_air(scene, names, warm)
    liquids = [_evaporant(scene, solution, name, warm, pressure, far) for name in names]
    masses = np.array(list(solution.solvent.values()))
    volumes = masses / np.array([e.density for e in liquids])
    shares = volumes / volumes.sum()
    if far > 0 and "water" not in names:
        liquids.append(_water(scene, solution, warm, pressure, far))
        shares = np.append(shares, 0.0)
    from spinline.rheology.heat import POLYMER_HEAT_CAPACITY

    heat = solution.polymer.heat_capacity
    return HeatedAir(
        evaporants=tuple(liquids),
        shares=shares,
        temperature=solution.temperature,
        air_temperature=warm,
        pressure=pressure,
        velocity=given(ambient.air_velocity, 0.0),
        floor=laws.sherwood_floor.value,
        transfer=laws.transfer,
        polymer_density=solution.polymer.density,
        polymer_heat_capacity=heat if heat > 0 else POLYMER_HEAT_CAPACITY,
        polymer_molar_volume=unit_volume(solution, laws),
        pairs=_pairs(scene, liquids),
    )


def _vapour_in_air(scene: Scene, names: list[str], warm: float) -> float:
    """Partial pressure of water in the air, Pa."""
    ambient = scene.ambient or AmbientSection()
    if ambient.relative_humidity is None and "water" not in names:
        return 0.0
    from spinline.rheology.thermal import saturation_pressure

    return humidity_of(ambient) * float(saturation_pressure("water", warm))


def _evaporant(scene: Scene, solution: Solution, name: str, warm: float, pressure: float, far: float) -> "Evaporant":
    from spinline.rheology.evaporant import Evaporant

    ambient = scene.ambient or AmbientSection()
    own = scene.solution.solvent if isinstance(scene.solution.solvent, SolventData) else SolventData.model_construct()
    spread = given(ambient.vapour_diffusivity)
    if spread is not None:  # of the air, at its temperature
        spread *= (solution.temperature / warm) ** 1.75
    alone = len(solution.solvent) == 1
    pull, mass = given(own.vapour_pressure), given(own.molar_mass)
    if ambient.saturation is not None:
        from spinline.rheology.vapour import molar_mass

        mass = molar_mass(name) if mass is None else mass
        pull = ambient.saturation.value * solution.solvent_density * _GAS * solution.temperature / mass
    try:
        return Evaporant.build(
            name,
            solution.temperature,
            ambient_pressure=far if name == "water" else 0.0,
            chi=interaction_with(scene, solution, name),
            pressure=pressure,
            density=solution.solvent_density if alone else None,
            molar_mass=mass,
            vapour_pressure=pull,
            latent_heat=given(own.latent_heat),
            heat_capacity=given(own.heat_capacity),
            diffusivity=spread,
        )
    except InputError as error:
        key = error.field.split(" of ")[0]
        field = "ambient.vapour_diffusivity" if key == "diffusivity" else f"solution.solvent.{key}"
        if key == "temperature":
            field = "solution.temperature"
        raise InputError(
            field if " of " in error.field or key == "temperature" else error.field,
            error.problem,
            value=error.value,
            allowed=error.allowed,
            remedy=error.remedy,
        ) from None


def _water(scene: Scene, solution: Solution, warm: float, pressure: float, far: float) -> "Evaporant":
    from spinline.rheology.evaporant import Evaporant
    from spinline.rheology.vapour import vapour_diffusivity

    cold = max(solution.temperature, 273.16)  # liquid water's density is known from there on
    spread = vapour_diffusivity("water", warm, pressure)
    from spinline.rheology.solvents import solvent_density

    return Evaporant.build(
        "water",
        warm,
        ambient_pressure=far,
        chi=interaction_with(scene, solution, "water"),
        pressure=pressure,
        density=solvent_density("water", min(cold, 600.0)),
        diffusivity=spread,
    )


def _pairs(scene: Scene, liquids: "list[Evaporant]") -> FloatArray | None:
    """Interaction of water with the other solvents, the scene's or the library's: where neither has it, and among
    themselves, they mix without heat.
    """
    names = [e.name for e in liquids]
    if "water" not in names:
        return None
    w = names.index("water")
    found = np.zeros((len(names), len(names)))
    for i, name in enumerate(names):
        if i != w:
            found[w, i] = found[i, w] = (water_with(scene, name) or 0.0) * liquids[w].density / liquids[w].molar_mass
    return found if found.any() else None
