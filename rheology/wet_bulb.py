"""Where a wet jet's temperature settles, and what that does to its drying: wet bulb, adiabatic saturation, dew point.

The wet bulb balances heat from the air against what evaporates, ``Nu k_a (T_a - T) A = m L(T)``, a = 1. With a
transfer law that has one power of Re for heat and vapour it does not depend on Re. The adiabatic saturation
temperature is that of air brought to saturation by the liquid, ``c_p (T_a - T) = (Y_sat(T) - Y_inf) L(T)``, Y the
vapour's mass per mass of dry air: for water in air the two nearly agree (Lewis number near 1), for organic vapours the
wet bulb is the higher.

References
----------
Bird, Stewart, Lightfoot, Transport Phenomena, 2nd ed. (2007), section 22.8.
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import number
from spinline.base.errors import InputError
from spinline.base.kernels import plain
from spinline.rheology import thermal
from spinline.rheology._heat_kernels import surface
from spinline.rheology.evaporant import GRID, Evaporant
from spinline.rheology.transfer import Transfer, law_index

__all__ = ["WetBulb", "adiabatic_saturation", "wet_bulb"]

_AIR_MASS = 0.0289644


@dataclass(frozen=True)
class WetBulb:
    """A wet thread at rest with its air.

    Attributes
    ----------
    temperature : float
        K.
    rate_factor : float
        Its rate of evaporation over that at the air's temperature.
    isothermal_stefan : float
        What Stefan flow alone multiplies the rate at the air's temperature by.
    """

    temperature: float
    rate_factor: float
    isothermal_stefan: float


def wet_bulb(
    evaporant: Evaporant,
    air_temperature: float,
    *,
    pressure: float = 101325.0,
    transfer: Transfer = "kase-matsuo",
    reynolds: float = 1.0,
    floor: float = 0.0,
    stefan: bool = True,
) -> WetBulb:
    """Wet-bulb temperature of a pure liquid.

    Parameters
    ----------
    evaporant : Evaporant
        With its partial pressure in the air, below saturation.
    air_temperature, pressure : float
        K, Pa.
    transfer : str
        As for `heat.dry_with_heat`; `reynolds`, at the air's temperature, matters to Churchill and Bernstein's alone,
        and `floor`.
    stefan : bool
        With Stefan flow and Ackermann's correction.

    Returns
    -------
    WetBulb
        The rate factor compares with the isothermal rate without Stefan flow, as an isothermal model has it.

    Raises
    ------
    InputError
        Where the liquid boils, or would condense.
    """
    warm = number("air_temperature", air_temperature, least=GRID[0] + 5, most=GRID[-1], unit="K")
    if evaporant.pressure(warm) >= pressure:
        raise InputError(
            "air_temperature", f"is above the boiling point of {evaporant.name}", value=warm, remedy="lower it"
        )
    if evaporant.ambient_pressure >= evaporant.pressure(warm):
        raise InputError(
            "ambient_pressure", "is above saturation: nothing evaporates", value=evaporant.ambient_pressure
        )
    e = evaporant
    sub = np.array(
        [
            [
                e.density,
                e.molar_mass,
                e.heat_capacity,
                e.vapour_heat_capacity,
                e.diffusivity,
                e.chi,
                e.ambient_pressure,
                1.0,
                0.0,
                e.molar_mass / e.density,
            ]
        ]
    )
    tables, one, flux = e.laws[np.newaxis].copy(), np.ones(1), np.empty(1)
    nu = float(thermal.air_viscosity(warm)) * 8.31446261815324 * warm / (_AIR_MASS * pressure)
    place = np.array([1.0, reynolds * nu / 2, 0.0, 1.0])

    def balance(kelvin: float, drift: bool) -> tuple[float, float]:
        air = np.array([pressure, warm, floor, 0.0, 1.0, 0.0, 1.0, law_index(transfer), 1.0, 0.0, float(drift)])
        warmed, carried, _ = plain(surface)(one, 1.0, kelvin, sub, tables, air, place, flux)
        return warmed - carried, float(flux[0])

    from scipy.optimize import brentq

    low = GRID[0]
    found = float(brentq(lambda t: balance(t, stefan)[0], low, warm, xtol=1e-11))
    isothermal = balance(warm, False)[1]
    return WetBulb(found, balance(found, stefan)[1] / isothermal, balance(warm, True)[1] / isothermal)


def adiabatic_saturation(evaporant: Evaporant, air_temperature: float, pressure: float = 101325.0) -> float:
    """Temperature of air saturated by a liquid without heat from outside, K; parameters as for `wet_bulb`."""
    warm = number("air_temperature", air_temperature, least=GRID[0] + 5, most=GRID[-1], unit="K")
    if evaporant.pressure(warm) >= pressure:
        raise InputError(
            "air_temperature", f"is above the boiling point of {evaporant.name}", value=warm, remedy="lower it"
        )
    p_inf = evaporant.ambient_pressure
    ratio = evaporant.molar_mass / _AIR_MASS
    there = ratio * p_inf / (pressure - p_inf)
    humid = thermal.AIR_HEAT_CAPACITY + there * evaporant.vapour_heat_capacity

    def excess(kelvin: float) -> float:
        p = evaporant.pressure(kelvin)
        return humid * (warm - kelvin) - (ratio * p / (pressure - p) - there) * evaporant.latent_heat(kelvin)

    from scipy.optimize import brentq

    if excess(warm) >= 0:
        return warm
    return float(brentq(excess, GRID[0], warm, xtol=1e-10))
