"""Air and drying of a spun jet from a scene: ``[ambient]``, ``[rheology]`` and the keys of ``[jet]`` that ask for them.

Along beads the solvent is one, its activity Flory and Huggins's, the liquid's laws those of Eq. (45), and water of the air
stays in the air; what a scene asks beyond that is refused by name. Vapour pressure and heat of vaporisation go through their
values at the jet's temperature and at the wet bulb, diffusion and conduction are those of the film between.
"""

import math
from typing import TYPE_CHECKING

from spinline.base.errors import InputError
from spinline.jetprofile.spun.settings import Air, Drying
from spinline.scene.air_and_rheology import AmbientSection, RheologySection
from spinline.setup.values import given

if TYPE_CHECKING:
    from spinline.rheology.solution import Solution
    from spinline.scene.file import Scene
    from spinline.scene.spun import SpunJet

__all__ = ["spun_air", "spun_drying"]

_GAS, _AIR_MASS = 8.31446261815324, 0.0289644
_CROSS = {"kase-matsuo": 64.0, "yarin": 0.0}


def spun_air(section: "SpunJet", scene: "Scene", solution: "Solution") -> Air | None:
    """Drag, lift, noise and motion of the air; None where a scene asks for none of it.

    Raises
    ------
    InputError
        For a table of the air's motion that cannot be read.
    """
    noisy = section.noise is not None
    if not (section.air_drag or section.air_lift or noisy or section.drying or section.air_field is not None):
        return None
    from spinline.rheology.vapour import air_kinematic_viscosity
    from spinline.setup.air import ATMOSPHERE

    ambient = scene.ambient or AmbientSection()
    warm, pressure = given(ambient.temperature, solution.temperature), given(ambient.pressure, ATMOSPHERE)
    axis, speeds, widths = _field(section, scene)
    length = given(section.noise_length) or section.radius.value
    grain = math.pi * section.radius.value**2 * length
    return Air(
        density=pressure * _AIR_MASS / (_GAS * warm),
        viscosity=given(ambient.air_viscosity) or air_kinematic_viscosity(warm, pressure),
        velocity=(given(ambient.air_velocity, 0.0), 0.0, 0.0),
        xi=0.65 if section.air_drag else 0.0,
        lift=section.air_lift,
        noise=section.noise.value * solution.density * grain if section.noise is not None else 0.0,
        interval=section.noise_time.value,
        grain=grain if noisy else 0.0,
        axis=axis,
        speeds=speeds,
        widths=widths,
    )


def _field(section: "SpunJet", scene: "Scene") -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Positions, speeds and half widths of ``air_field``."""
    if section.air_field is None:
        return (), (), ()
    from spinline.jetprofile.columns import read_columns

    path = scene.folder / section.air_field
    if not path.exists():
        raise InputError("jet.air_field", "does not exist", value=section.air_field, remedy="from the scene's folder")
    kinds = {"x": "length", "velocity": "velocity", "half_width": "length"}
    found = read_columns(path, kinds, required=("x", "velocity"))
    width = found.get("half_width")
    return (
        tuple(found["x"].tolist()),
        tuple(found["velocity"].tolist()),
        () if width is None else tuple(width.tolist()),
    )


def spun_drying(section: "SpunJet", scene: "Scene", solution: "Solution") -> Drying | None:
    """Evaporation along the beads, with heat unless ``effects.heat = false``; None where the scene does not ask for it.

    Raises
    ------
    InputError
        For what drying needs and the scene does not give, and for laws that beads do not have.
    """
    if not section.drying:
        return None
    laws = scene.rheology or RheologySection()
    _check(scene, solution, laws)
    from spinline.rheology import thermal
    from spinline.setup.heat import build_heated_air

    air = build_heated_air(scene, solution)
    liquid = air.evaporants[0]
    start, cold = air.temperature, air.wet_bulb
    if not math.isfinite(cold):
        raise InputError("ambient", "lets nothing evaporate: the air is saturated or the solvent boils")
    low = cold if abs(cold - start) > 1.0 else start - 5.0

    def vapour(kelvin: float, pressure: float) -> float:
        return pressure * liquid.molar_mass / (_GAS * kelvin * liquid.density)

    here, there = vapour(start, liquid.pressure(start)), vapour(low, liquid.pressure(low))
    film = 0.5 * (air.air_temperature + cold)
    constant = laws.law == "constant"
    heat = scene.effects.heat is not False
    share = sum(solution.solvent.values())
    polymer = 1.0 - share
    capacity = polymer * air.polymer_heat_capacity + share * liquid.heat_capacity
    conductivity = float(thermal.air_conductivity(film))
    return Drying(
        fraction=solution.volume_fraction,
        vapour_diffusion=liquid.diffusivity * (film / 298.15) ** 1.75,
        equilibrium=here,
        far=vapour(air.air_temperature, liquid.ambient_pressure),
        interaction=liquid.chi,
        least_sherwood=air.floor,
        viscosity_factor=0.0 if constant else laws.B.value,
        viscosity_power=laws.m.value,
        time_power=(0.0 if constant else 1.0) if laws.n is None else laws.n,
        heat_capacity=capacity if heat else 0.0,
        latent=liquid.latent_heat(0.5 * (start + low)) * liquid.density / solution.density,
        latent_slope=math.log(here / there) / (1.0 / low - 1.0 / start),
        air_conductivity=conductivity,
        prandtl=float(thermal.air_viscosity(film)) * thermal.AIR_HEAT_CAPACITY / conductivity,
        air_temperature=air.air_temperature,
        temperature=start,
        cross_flow=_CROSS[laws.transfer],
    )


def _check(scene: "Scene", solution: "Solution", laws: RheologySection) -> None:
    """What beads cannot do."""
    ambient = scene.ambient or AmbientSection()
    off = scene.effects.evaporation is False
    wet = ambient.relative_humidity is not None and ambient.relative_humidity.value > 0
    beyond = (
        (off, "effects.evaporation", "is false, and jet.drying true", "drop one of them"),
        (len(solution.solvent) > 1, "solution.solvent", "is a mixture: along beads one solvent dries", "name one"),
        (
            wet and "water" not in solution.solvent,
            "ambient.relative_humidity",
            "brings water, which beads do not take up",
            "drop it, or take jet.drying = false",
        ),
        (
            laws.law not in ("yarin", "constant"),
            "rheology.law",
            f"is {laws.law}: not along beads",
            '"yarin", "constant"',
        ),
        (laws.transfer not in _CROSS, "rheology.transfer", f"is {laws.transfer}: not along beads", '"kase-matsuo"'),
        (laws.activity != "flory-huggins", "rheology.activity", "is not Flory and Huggins's", '"flory-huggins"'),
        (laws.convention != "mass", "rheology.convention", "is not that of mass", '"mass"'),
    )
    for wrong, key, problem, remedy in beyond:
        if wrong:
            raise InputError(key, problem, remedy=remedy)
