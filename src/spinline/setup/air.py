"""The air of a scene and the solvents on their way into it: what evaporation needs, from the library or given.

Relative humidity is that of the air at its own temperature, and of water alone: other solvents find none of their
vapour in the room. Water is in the balance wherever there is any in the air, a solvent or not. Vapour leaves at the
temperature of the jet, ``solution.temperature``; it spreads in air of ``ambient.temperature``, by default the same. A
jet that cools is `heat`'s.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.rheology.solution import Solution
from spinline.scene.air_and_rheology import AmbientSection, RheologySection
from spinline.scene.file import Scene, SolventData
from spinline.setup.values import given

if TYPE_CHECKING:
    from spinline.rheology._evaporation_balance import Activity
    from spinline.rheology.element_path import ElementPath
    from spinline.rheology.evaporation import Evaporation
    from spinline.rheology.transfer import Transfer
    from spinline.rheology.volatile import Volatile

__all__ = [
    "ATMOSPHERE",
    "Air",
    "assumed_interactions",
    "build_air",
    "humidity_of",
    "interaction_with",
    "known_interaction",
    "library_name",
    "unit_volume",
    "water_with",
]

ATMOSPHERE = 101325.0  # Pa


@dataclass(frozen=True, eq=False)
class Air:
    """What a jet dries into.

    Attributes
    ----------
    volatiles : tuple of Volatile
        One per solvent.
    shares : ndarray, (solvent,)
        Their volume shares in the solvent at the nozzle.
    viscosity, velocity : float
        Kinematic viscosity of air (m2/s), and its speed along the jet (m/s).
    activity : str
        Law of the solvents' activity.
    polymer_molar_volume : float or None
        Of a repeat unit, m3/mol; for Raoult's law.
    floor : float
        Least Sherwood number.
    convention : str
        What stands for C in Eq. (43a).
    transfer : str
        Law of the Sherwood number.
    condensing : str
        Why nothing dries at the jet's own temperature; empty where it does.
    """

    volatiles: "tuple[Volatile, ...]"
    shares: FloatArray
    viscosity: float
    velocity: float
    activity: "Activity"
    polymer_molar_volume: float | None
    floor: float
    convention: str
    transfer: "Transfer" = "kase-matsuo"
    condensing: str = ""

    def evaporate(self, path: "ElementPath", volume_fraction: float) -> "Evaporation":
        """Evaporation along a path, flat across the jet; its warnings are in its notes."""
        import warnings

        from spinline.base.errors import SpinlineWarning
        from spinline.rheology.evaporation import evaporate

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpinlineWarning)
            return evaporate(
                path,
                volume_fraction,
                self.volatiles,
                self.shares,
                air_viscosity=self.viscosity,
                air_velocity=self.velocity,
                activity=self.activity,
                polymer_molar_volume=self.polymer_molar_volume,
                sherwood_floor=self.floor,
                transfer=self.transfer,
            )

    @property
    def equilibrium(self) -> float:
        """Polymer fraction at which drying ends; 1 where a solvent has no vapour in the air."""
        from spinline.rheology.vapour import equilibrium_fraction

        wet = [v for v in self.volatiles if v.ambient > 0]
        if not wet or self.activity == "unit":
            return 1.0
        if self.activity != "flory-huggins" or len(wet) > 1:
            return float("nan")
        return equilibrium_fraction(wet[0].ambient, wet[0].chi)  # the others leave altogether

    def __str__(self) -> str:
        parts = [
            f"{v.name}: C {v.saturation:.4g}, D_a {v.diffusivity:.4g} m2/s, in the air {v.ambient:.4g} of saturation, "
            f"chi {v.chi:g}"
            for v in self.volatiles
        ]
        floor = f", Sherwood floor {self.floor:g}" if self.floor else ""
        return (
            f"{'; '.join(parts)}; air {self.viscosity:.4g} m2/s, {self.velocity:g} m/s; activity {self.activity}, "
            f'convention "{self.convention}", transfer "{self.transfer}"{floor}'
        )


def build_air(scene: Scene, solution: Solution) -> Air:
    """Air and solvents of a scene.

    Raises
    ------
    InputError
        For what is missing or cannot be, by the key of the scene that gives it.
    """
    from spinline.rheology.vapour import air_kinematic_viscosity

    ambient, laws = scene.ambient or AmbientSection(), scene.rheology or RheologySection()
    air_temperature = given(ambient.temperature, solution.temperature)
    pressure = given(ambient.pressure, ATMOSPHERE)
    names = [library_name(name) for name in solution.solvent]
    if len(names) > 1 and (ambient.vapour_diffusivity is not None or ambient.saturation is not None):
        key = "saturation" if ambient.saturation is not None else "vapour_diffusivity"
        raise InputError(f"ambient.{key}", "is one number, and the solvent is a mixture", remedy="drop it")
    masses = np.array(list(solution.solvent.values()))
    humid = ambient.relative_humidity is not None and ambient.relative_humidity.value > 0
    if humid and "water" not in names and laws.activity != "unit":
        names, masses = [*names, "water"], np.append(masses, 0.0)
    volatiles = tuple(_volatile(scene, solution, name, air_temperature, pressure) for name in names)
    densities = np.array([_density(scene, solution, name) for name in names])
    if laws.activity == "unit" and len(names) > 1:
        raise InputError("rheology.activity", "cannot be 1 in a mixture", value="unit", remedy='take "flory-huggins"')
    return Air(
        volatiles=volatiles,
        shares=masses / densities / np.sum(masses / densities),
        viscosity=given(ambient.air_viscosity, None) or air_kinematic_viscosity(air_temperature, pressure),
        velocity=given(ambient.air_velocity, 0.0),
        activity=laws.activity,
        polymer_molar_volume=unit_volume(solution, laws),
        floor=laws.sherwood_floor.value,
        convention=laws.convention,
        transfer=laws.transfer,
    )


def humidity_of(ambient: AmbientSection) -> float:
    """Relative humidity, where water is one of the solvents: without it nobody knows how fast it evaporates."""
    if ambient.relative_humidity is None:
        raise InputError(
            "ambient.relative_humidity",
            "is missing: how fast water evaporates depends on it",
            remedy='give it, for example "40 %"',
        )
    return float(ambient.relative_humidity.value)


def unit_volume(solution: Solution, laws: RheologySection) -> float | None:
    """Molar volume of the polymer's repeat unit, m3/mol, where the activity is Raoult's; None elsewhere."""
    if laws.activity != "raoult":
        return None
    volume = solution.polymer.repeat_unit_molar_mass / solution.polymer.density
    if not volume > 0:
        raise InputError(
            "solution.polymer.repeat_unit_molar_mass", "is missing: Raoult's law needs it", remedy="give it"
        )
    return float(volume)


def library_name(name: str) -> str:
    """Library spelling of a solvent's name, or the name itself."""
    from spinline.rheology.names import known_as
    from spinline.rheology.vapour import VAPOURS

    return known_as(name, VAPOURS) or name


def known_interaction(scene: Scene, solution: Solution, name: str) -> float | None:
    """Chi of the polymer with a liquid: the scene's (chi_water of water, chi of the solvents), or the library's; None where
    neither has it.
    """
    from spinline.rheology.interactions import interaction

    laws = scene.rheology or RheologySection()
    library = interaction(solution.polymer.name, name)
    own = laws.chi if name in map(library_name, solution.solvent) else None
    given_one = laws.chi_water if name == "water" and laws.chi_water is not None else own
    return given_one if given_one is not None else None if library is None else min(library[0], 5.0)


def interaction_with(scene: Scene, solution: Solution, name: str) -> float:
    """`known_interaction`, or what is taken where it is not known: of water from the air that of the solvents, and of these
    what the solvent's quality says.
    """
    laws = scene.rheology or RheologySection()
    for value in (known_interaction(scene, solution, name), laws.chi):
        if value is not None:
            return value
    return 0.5 if scene.network.solvent_quality == "theta" else 0.0


def water_with(scene: Scene, solvent: str) -> float | None:
    """Chi of water with another solvent, by water's volume: the scene's, or the library's; None where neither has it."""
    from spinline.rheology.interactions import water_interaction

    laws = scene.rheology or RheologySection()
    known = water_interaction(solvent)
    return laws.chi_water_solvent if laws.chi_water_solvent is not None else None if known is None else known[0]


def assumed_interactions(scene: Scene, solution: Solution) -> list[tuple[str, str, float]]:
    """Liquids in the balance whose chi with the polymer neither the scene nor the library has: name, the key that
    gives it, and what is taken.
    """
    laws, ambient = scene.rheology or RheologySection(), scene.ambient or AmbientSection()
    if laws.activity != "flory-huggins":
        return []
    names = [library_name(name) for name in solution.solvent]
    keys = dict.fromkeys(names, "rheology.chi")
    if ambient.relative_humidity is not None and ambient.relative_humidity.value > 0 and "water" not in names:
        keys["water"] = "rheology.chi_water"
    return [
        (name, key, interaction_with(scene, solution, name))
        for name, key in keys.items()
        if known_interaction(scene, solution, name) is None
    ]


def _density(scene: Scene, solution: Solution, name: str) -> float:
    from spinline.rheology.materials import solvent_density

    if len(solution.solvent) == 1 and name == library_name(next(iter(solution.solvent))):
        return solution.solvent_density
    return solvent_density(name, solution.temperature, "solution.solvent")


def _volatile(scene: Scene, solution: Solution, name: str, air_temperature: float, pressure: float) -> "Volatile":
    from spinline.rheology import vapour
    from spinline.rheology.volatile import Volatile

    ambient, laws = scene.ambient or AmbientSection(), scene.rheology or RheologySection()
    own = scene.solution.solvent if isinstance(scene.solution.solvent, SolventData) else None
    known = name in vapour.VAPOURS
    chi = interaction_with(scene, solution, name)
    humidity = 0.0
    if name == "water":
        humidity = humidity_of(ambient)
        if air_temperature != solution.temperature:
            humidity *= vapour.vapour_pressure(name, air_temperature) / vapour.vapour_pressure(
                name, solution.temperature
            )
        if humidity >= 1:
            raise InputError(
                "ambient.relative_humidity",
                "lets water condense on the jet: nothing evaporates",
                value=humidity_of(ambient),
                allowed="below saturation at the jet's temperature",
                remedy="lower it, or set effects.evaporation = false",
            )
    if name not in map(library_name, solution.solvent):  # the air's water: what the scene gives is the solvent's
        return Volatile.build(
            name,
            solution.temperature,
            ambient=humidity,
            chi=chi,
            convention=laws.convention,
            pressure=pressure,
            diffusivity=vapour.vapour_diffusivity(name, air_temperature, pressure),
        )
    spread = given(ambient.vapour_diffusivity, None)
    mass = given(own.molar_mass, None) if own is not None else None
    if spread is None:
        if not known:
            raise InputError(
                "ambient.vapour_diffusivity", f"is missing: {name} is not built in", remedy="give it, in m2/s"
            )
        spread = vapour.vapour_diffusivity(name, air_temperature, pressure)
    if mass is None and not known:
        mass = _needed("solution.solvent.molar_mass", name, None if ambient.saturation is None else 0.1)
    pull = given(own.vapour_pressure, None) if own is not None else None
    if pull is None and not known and ambient.saturation is None:
        pull = _needed("solution.solvent.vapour_pressure", name, None)
    density = _density(scene, solution, name)
    try:
        if ambient.saturation is not None:
            molar = mass if mass is not None else vapour.molar_mass(name)
            return Volatile(name, ambient.saturation.value, spread, humidity, chi, molar / density)
        return Volatile.build(
            name,
            solution.temperature,
            ambient=humidity,
            chi=chi,
            convention=laws.convention,
            pressure=pressure,
            density=density,
            vapour_pressure=pull,
            molar_mass=mass,
            diffusivity=spread,
        )
    except InputError as error:
        keys = {"temperature": "solution.temperature", f"{name}.ambient": "ambient.relative_humidity"}
        raise InputError(
            keys.get(error.field, error.field),
            error.problem,
            value=error.value,
            allowed=error.allowed,
            remedy=error.remedy,
        ) from None


def _needed(field: str, name: str, otherwise: float | None) -> float:
    if otherwise is None:
        raise InputError(field, f"is missing: {name} is not built in", remedy="give it, or ambient.saturation")
    return otherwise
