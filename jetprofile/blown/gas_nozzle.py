"""Gas leaving a nozzle: isentropic flow from its reservoir, and what a blown jet sees of it.

::

    M^2 = 2/(g - 1) [(p_0/p)^((g - 1)/g) - 1]     T = T_0/(1 + (g - 1) M^2/2)     U = M (g R T)^(1/2)     rho = p/(R T)

Above p_0/p = 1.892929 (air) a plain nozzle is choked: sonic at its exit, expanding outside it. What is returned then is the
*fully expanded* jet and the diameter that carries the same mass (`expanded_diameter`): right some ten diameters
downstream, not in the shock cells; with a warning.
"""

import warnings
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import number, positive
from spinline.base.errors import InputError, SpinlineWarning

__all__ = ["NozzleExit", "choking_ratio", "nozzle_exit", "sonic_velocity"]

_GAMMA, _GAS = 1.4, 287.05  # air, J/(kg K)


@dataclass(frozen=True)
class NozzleExit:
    """State of the gas at the exit, expanded to the pressure outside.

    Attributes
    ----------
    mach, temperature, velocity, density : float
        1, K, m/s, kg/m3.
    choked : bool
    expanded_diameter : float
        Over the nozzle's: 1 unless choked.
    """

    mach: float
    temperature: float
    velocity: float
    density: float
    choked: bool
    expanded_diameter: float


def nozzle_exit(pressure_ratio: float, reservoir_temperature: float = 293.15, pressure: float = 101325.0) -> NozzleExit:
    """Exit of an air nozzle.

    Parameters
    ----------
    pressure_ratio : float
        Reservoir over ambient pressure, in (1, 20].
    reservoir_temperature : float
        T_0, K, in [200, 1500].
    pressure : float
        Ambient, Pa.

    Returns
    -------
    NozzleExit

    Examples
    --------
    >>> out = nozzle_exit(1.2)
    >>> round(out.mach, 6), round(out.temperature, 4), round(out.velocity, 4), round(out.density, 5)
    (0.517071, 278.2702, 172.9125, 1.26851)
    """
    ratio = number(
        "pressure_ratio", pressure_ratio, above=1.0, most=20.0, remedy="give reservoir over ambient pressure, absolute"
    )
    start = number("reservoir_temperature", reservoir_temperature, least=200.0, most=1500.0, unit="K")
    p = positive("pressure", pressure, "Pa")
    mach = float(np.sqrt(2 / (_GAMMA - 1) * np.expm1((_GAMMA - 1) / _GAMMA * np.log(ratio))))
    temperature = start / (1 + (_GAMMA - 1) / 2 * mach**2)
    velocity = mach * float(np.sqrt(_GAMMA * _GAS * temperature))
    choked = ratio > choking_ratio()
    area = 1.0
    if choked:
        area = (2 / (_GAMMA + 1) * (1 + (_GAMMA - 1) / 2 * mach**2)) ** ((_GAMMA + 1) / (2 * (_GAMMA - 1))) / mach
        warnings.warn(
            f"the gas nozzle is choked (pressure ratio {ratio:.3g} above {choking_ratio():.4g}): the jet is taken as fully "
            "expanded, right some ten diameters downstream",
            SpinlineWarning,
            stacklevel=2,
        )
    return NozzleExit(mach, temperature, velocity, p / (_GAS * temperature), choked, float(np.sqrt(area)))


def choking_ratio() -> float:
    """Pressure ratio at which an air nozzle chokes, 1.892929."""
    return float(((_GAMMA + 1) / 2) ** (_GAMMA / (_GAMMA - 1)))


def sonic_velocity(reservoir_temperature: float = 293.15) -> float:
    """Highest velocity at a plain nozzle's exit, m/s: 313.32 from 293.15 K."""
    start = number("reservoir_temperature", reservoir_temperature, least=200.0, most=1500.0, unit="K")
    return float(np.sqrt(_GAMMA * _GAS * start * 2 / (_GAMMA + 1)))


def subsonic(velocity: float, reservoir_temperature: float = 293.15) -> float:
    """A stated exit velocity, refused above the sonic one."""
    most = sonic_velocity(reservoir_temperature)
    value = number("air_velocity", velocity, least=0.0, unit="m/s")
    if value > most:
        raise InputError(
            "air_velocity",
            "is above what a plain nozzle's exit can have",
            value=value,
            allowed=f"[0, {most:.4g}] m/s",
            remedy="give the pressure ratio of the reservoir instead",
        )
    return value
