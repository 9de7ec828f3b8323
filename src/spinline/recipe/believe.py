"""What is believed of a recipe: medians and spreads, from what is given and, where nothing is, from the library."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from numbers import Real

import numpy as np

from spinline.base.errors import InputError
from spinline.recipe import library
from spinline.recipe.constants import CONSTANTS, TAKEN, Calibrated
from spinline.recipe.model import Believed
from spinline.rheology.evaporant import Evaporant
from spinline.rheology.intrinsic import mixture_intrinsic_viscosity
from spinline.rheology.materials import POLYMERS, polymer
from spinline.rheology.solvents import (
    SOLVENTS,
    mixture_density,
    mixture_surface_tension,
    mixture_viscosity,
    solvent_density,
    volume_shares,
)
from spinline.rheology.thermal import saturation_pressure
from spinline.rheology.vapour import molar_mass, vapour_diffusivity
from spinline.rheology.wet_bulb import wet_bulb

__all__ = ["DAMPEST", "USUAL_TEMPERATURE", "Recipe", "believe", "evaporation_rate"]

_GAS = 8.31446261815324
# c_e [eta], c_e where the specific viscosity is `TAKEN.viscosity_at_entanglement` and grows with the power of 5: PEO 6.2,
# PVA 7.0, PVP 8.4 by the makers' viscosities of aqueous solutions (`benchmarks/published_viscosity.py`)
_OVERLAPS = 7.0
_ANY_DENSITY = 1250.0  # kg/m3
_USUAL = {"voltage": 15e3, "flow_rate": 1e-6 / 3600, "gap": 0.15}
#: Relative humidity above which water dries as there: at 1 nothing would ever be solid. `outside_remarks` says so.
DAMPEST = 0.97
#: Of a laboratory that says none, K.
USUAL_TEMPERATURE = 296.15
_ENTANGLED_SD = 0.3  # of ln c_e at a known [eta]: 0.15 of those solutions, and which average a molar mass is


@dataclass(frozen=True)
class Recipe:
    """A recipe in SI; NaN (or "") where a lab notebook does not say.

    Attributes
    ----------
    polymer : str
        Name in the library.
    solvent : mapping
        Mass fractions by name.
    mass_fraction : float
        Of polymer in the solution.
    voltage, gap, flow_rate : float
        V, m, m3/s.
    needle_radius : float
        Inner radius, m.
    molar_mass, viscosity, conductivity, surface_tension, current : float
        kg/mol, Pa s, S/m, N/m, A.
    temperature, relative_humidity : float
        K, 0 to 1.
    spread : mapping
        Standard deviation of the logarithm of what was given with ``+/-``.
    usual_fraction : float
        Mass fraction about which this laboratory spins: of several recipes their geometric mean.
    ratio_known : bool
        False where only the names of a mixture's solvents are known.
    """

    polymer: str
    solvent: Mapping[str, float]
    voltage: float
    gap: float
    flow_rate: float
    mass_fraction: float = float("nan")
    needle_radius: float = float("nan")
    molar_mass: float = float("nan")
    viscosity: float = float("nan")
    conductivity: float = float("nan")
    surface_tension: float = float("nan")
    current: float = float("nan")
    temperature: float = float("nan")
    relative_humidity: float = float("nan")
    spread: Mapping[str, float] | None = None
    usual_fraction: float = float("nan")
    ratio_known: bool = True


def believe(recipe: Recipe, constants: Calibrated = CONSTANTS) -> tuple[Believed, dict[str, str]]:
    """Medians and spreads of a recipe, and what was borrowed, in words by the recipe's own names."""
    _possible(recipe)
    borrowed: dict[str, str] = {}
    sd = {
        **constants.sd,
        "extensional_viscosity": 0.6,
        "evaporation": 0.3,
        "flight_time": 0.5,
        "onset_radius": 0.5,
        "surface_tension": 0.1,
        "relaxation_time": 1.2,
    }
    kelvin = recipe.temperature if recipe.temperature == recipe.temperature else USUAL_TEMPERATURE
    wet = recipe.relative_humidity if recipe.relative_humidity == recipe.relative_humidity else 0.45
    if recipe.relative_humidity != recipe.relative_humidity:
        borrowed["ambient.relative_humidity"] = "45 %, usual"
        water = volume_shares(recipe.solvent, kelvin).get("water", 0.0)
        sd["evaporation"] = float(np.sqrt(sd["evaporation"] ** 2 + water * 0.3**2 + (1 - water) * 0.05**2))
    rho, mu = mixture_density(recipe.solvent, kelvin), mixture_viscosity(recipe.solvent, kelvin)
    if not recipe.ratio_known:
        borrowed["solution.solvent"] = "equal parts: the ratio is not known"
        sd["evaporation"] = float(np.hypot(sd["evaporation"], 0.6))
    coil, w = _entangled(recipe, sd, borrowed)
    usual = recipe.usual_fraction if recipe.usual_fraction == recipe.usual_fraction else w
    gamma = recipe.surface_tension
    if gamma != gamma:
        gamma = mixture_surface_tension(recipe.solvent, min(max(kelvin, 288.15), 308.15))  # -0.1 mN/m a kelvin beyond
        borrowed["solution.surface_tension"] = f"{1e3 * gamma:.3g} mN/m, of the solvent"
    conductivity = recipe.conductivity
    if conductivity == conductivity:
        sd["conductivity"] = 0.1
    else:
        prior = library.conductivity(recipe.solvent)
        conductivity, sd["conductivity"] = prior.median, prior.sd
        borrowed["solution.conductivity"] = f"{prior.median:.2g} S/m, within a factor of {np.exp(2 * prior.sd):.2g}"
    sd["current"] = 0.1 if recipe.current == recipe.current else 0.8
    if recipe.current == recipe.current:
        sd["conductivity"] = 0.0
    else:
        borrowed["jet.current"] = "predicted, within a factor of 5"
    sd["viscosity"] = 0.1 if recipe.viscosity == recipe.viscosity else 0.5
    r0 = recipe.needle_radius
    if r0 != r0:
        r0 = 0.2e-3
        borrowed["jet.radius"] = "0.2 mm, usual"
    sd |= {key: value for key, value in (recipe.spread or {}).items() if value > 0}
    solid = polymer(recipe.polymer).density if recipe.polymer in POLYMERS else _ANY_DENSITY
    phi = (w / solid) / (w / solid + (1 - w) / rho)
    shares, rates = _side_by_side(recipe.solvent, kelvin, wet)
    dries = evaporation_rate(recipe.solvent, kelvin, wet)
    return (
        Believed(
            coil=coil,
            solvent_viscosity=mu,
            surface_tension=gamma,
            conductivity=conductivity,
            evaporation=dries,
            shares=shares,
            ratios=tuple(rate / dries for rate in rates),
            flight_time=recipe.gap / TAKEN.flight_speed,
            onset_radius=0.1 * r0,
            voltage=recipe.voltage,
            flow_rate=recipe.flow_rate,
            gap=recipe.gap,
            needle_radius=r0,
            volume_fraction=phi,
            solid_fraction=max(TAKEN.solid_fraction, 0.5 * (1 + phi)),
            density=1 / (w / solid + (1 - w) / rho),
            viscosity=recipe.viscosity,
            current=recipe.current,
            sd=sd,
            away={
                "concentration_response": float(np.log(w / usual)),
                "voltage_response": float(np.log(recipe.voltage / _USUAL["voltage"])),
                "flow_response": float(np.log(recipe.flow_rate / _USUAL["flow_rate"])),
                "gap_response": float(np.log(recipe.gap / _USUAL["gap"])),
            },
        ),
        borrowed,
    )


_SIZES = ("voltage", "gap", "flow_rate")  # needed
_OPTIONAL = ("needle_radius", "molar_mass", "viscosity", "conductivity", "surface_tension", "current", "temperature")


def _possible(recipe: Recipe) -> None:
    """Refuse by name what no recipe has; NaN is not known, where that may be."""
    for names, least, most in (
        (_SIZES, 0.0, np.inf),
        (_OPTIONAL, 0.0, np.inf),
        (("mass_fraction", "usual_fraction"), 0.0, 1.0),
        (("relative_humidity",), -1e-300, np.nextafter(1.0, 2.0)),
    ):
        for name in names:
            value = getattr(recipe, name)
            if not isinstance(value, Real):
                raise InputError(name, "is no number", value=value, allowed="a number, in SI units")
            if not (least < float(value) < most or (value != value and name not in _SIZES)):
                allowed = "0 to 1" if name == "relative_humidity" else f"above {least:g}, below {most:g}"
                raise InputError(name, "cannot be in a recipe", value=value, allowed=f"{allowed}, SI units")


def _entangled(recipe: Recipe, sd: dict[str, float], borrowed: dict[str, str]) -> tuple[float, float]:
    """c/c_e and the mass fraction: the chain's own c_e, and what people spin at, weighed by what each is worth."""
    prior = library.molar_mass(recipe.polymer)
    known = recipe.molar_mass == recipe.molar_mass
    chain = recipe.molar_mass if known else prior.median
    log_ce, own = _entanglement(recipe, chain)
    own = float(np.hypot(own, 0.0 if known else 0.7 * prior.sd))
    if not known:
        borrowed["solution.molar_mass"] = f"{prior.median:g} kg/mol, {prior.source}"
    w = recipe.mass_fraction
    usual = recipe.usual_fraction if recipe.usual_fraction == recipe.usual_fraction else w
    if w != w:
        w = usual if usual == usual else float(min(TAKEN.spun_at * np.exp(log_ce), 0.4))
        sd["entanglement_concentration"] = float(np.hypot(TAKEN.spun_at_sd, 0.3))
        borrowed["solution.concentration"] = f"{100 * w:.3g} wt%, where such chains are usually spun"
        return TAKEN.spun_at, w
    # where people spin
    precision = (own**-2, TAKEN.spun_at_sd**-2)
    said = np.log(usual) - np.log(TAKEN.spun_at)
    log_ce = (precision[0] * log_ce + precision[1] * said) / sum(precision)
    sd["entanglement_concentration"] = float(sum(precision) ** -0.5)
    return float(w / np.exp(log_ce)), w


def _entanglement(recipe: Recipe, chain: float) -> tuple[float, float]:
    """Ln of the mass fraction of entanglement of chains of a molar mass (kg/mol), and its standard deviation."""
    if recipe.polymer not in POLYMERS:
        return float(np.log(0.06)), 0.8
    eta = mixture_intrinsic_viscosity(recipe.polymer, recipe.solvent, chain, temperature=USUAL_TEMPERATURE)
    density = mixture_density(recipe.solvent, USUAL_TEMPERATURE)
    return float(np.log(_OVERLAPS / density / eta.value)), float(np.hypot(_ENTANGLED_SD, 0.5 * np.log(eta.factor)))


def evaporation_rate(solvent: Mapping[str, float], temperature: float, relative_humidity: float) -> float:
    """k_ev, m2/s, at the wet bulb: cross-section over pi that a second dries, over the time until all solvents are gone."""
    shares, rates = _side_by_side(solvent, temperature, relative_humidity)
    return 1.0 / sum(share / rate for share, rate in zip(shares, rates, strict=True))


def _side_by_side(
    solvent: Mapping[str, float], kelvin: float, humidity: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Volume share and rate of drying, m2/s, of each solvent alone."""
    shares = volume_shares(solvent, kelvin)
    return tuple(shares.values()), tuple(_rate(name, kelvin, humidity if name == "water" else 0.0) for name in shares)


@lru_cache(maxsize=4096)
def _rate(name: str, kelvin: float, humidity: float) -> float:
    ambient = min(humidity, DAMPEST)
    pressure = float(saturation_pressure(name, kelvin))
    content = pressure * molar_mass(name) / (_GAS * kelvin)
    free = vapour_diffusivity(name, kelvin) * TAKEN.sherwood * content * (1 - ambient) / solvent_density(name, kelvin)
    cooled = wet_bulb(Evaporant.build(name, kelvin, ambient_pressure=ambient * pressure), kelvin).rate_factor
    return float(free * cooled)


def known_solvents(names: list[str]) -> dict[str, float]:
    """Equal parts of some solvents."""
    missing = [name for name in names if name not in SOLVENTS]
    if missing:
        raise InputError(
            "solution.solvent", "is not in the library", value=missing[0], allowed=", ".join(sorted(SOLVENTS))
        )
    return dict.fromkeys(names, 1.0 / len(names))
