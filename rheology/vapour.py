"""Vapour over a polymer solution: vapour pressures, what air does with vapour, activities, where drying ends.

Vapour pressures come from the `chemicals` library: IAPWS-95 for water, DIPPR 101 (Perry's Handbook, 8th ed., Table
2-8) for the others, the Antoine fits of Landolt-Boernstein IV/20A for HFIP, NMP and TFA, lines of ln p against 1/T
for DMAc and TFE. Diffusion in air is Fuller's method, 5 % on average (Poling, Prausnitz, O'Connell, 5th ed., Eq. 11-4.4 and
Table 11-1); the viscosity of air is the U.S. Standard Atmosphere's.

Activities, of solvent i with volume fraction phi_i and molar volume v_i, the polymer (phi_p) being long::

    Flory-Huggins  ln a_i = ln phi_i + 1 - sum_j phi_j v_i/v_j + chi_i phi_p - v_i phi_p sum_j phi_j chi_j/v_j
    Raoult         a_i = (phi_i/v_i) / (sum_j phi_j/v_j + phi_p/v_p)

(sums over solvents; solvents mix without heat). One solvent: ``ln a = ln(1 - phi) + phi + chi phi^2``. Raoult's law
needs the molar volume v_p of what counts as one polymer molecule, the repeat unit if drying is to end smoothly.
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.errors import InputError
from spinline.rheology._finite import finite_result
from spinline.rheology._liquid_rows import row_of
from spinline.rheology.atoms import VAPOURS
from spinline.rheology.solvents import SOLVENTS, known_name, solvent_molar_mass

__all__ = [
    "GAS_CONSTANT",
    "VAPOURS",
    "air_kinematic_viscosity",
    "equilibrium_fraction",
    "flory_huggins_coefficient",
    "log_flory_huggins",
    "log_raoult",
    "molar_mass",
    "raoult_coefficient",
    "solvent_activity",
    "vapour_concentration",
    "vapour_diffusivity",
    "vapour_pressure",
]

GAS_CONSTANT = 8.31446261815324  # J/(mol K), exact

_DIFFUSION_VOLUMES = np.array([15.9, 2.31, 6.11, 4.54, 21.0, 14.7, 22.9, -18.3])
# boiling point in K (CRC Handbook), and the mean of the heats of vaporisation at 298 K and there, J/mol: 15 %
_LINES = {"DMAc": (438.15, 46.5e3), "TFE": (347.0, 42.0e3)}
_COLD = 273.15  # K, where the lines begin
_WATER_VOLUME, _AIR_VOLUME, _AIR_MOLAR_MASS = 13.1, 19.7, 0.0289644


def vapour_pressure(name: str, temperature: float) -> float:
    """Vapour pressure of a pure solvent in Pa.

    Parameters
    ----------
    name : str
        A key of `VAPOURS`.
    temperature : float
        K, within the range of the correlation (HFIP: 294 to 331 K; NMP from 336 K on). `thermal.saturation_pressure`
        goes on beyond it.

    Returns
    -------
    float
        Within 2 % of measured values near room temperature.

    Raises
    ------
    InputError
        For an unknown solvent, or a temperature outside the range; give the vapour pressure itself then.
    """
    name = _name(name, "vapour_pressure (Pa)")
    cas = SOLVENTS[name][0]
    kelvin = positive("temperature", temperature, "K")
    if name == "water":
        from chemicals.iapws import iapws95_Psat

        _within(name, kelvin, 273.16, 640.0)
        return float(iapws95_Psat(kelvin))
    if name in _LINES:
        boils, heat = _LINES[name]
        _within(name, kelvin, _COLD, boils)
        return 101325.0 * float(np.exp(heat / GAS_CONSTANT * (1 / boils - 1 / kelvin)))
    if name in ("HFIP", "NMP", "TFA"):
        from chemicals.vapor_pressure import Antoine, Psat_data_Landolt_Antoine

        row = Psat_data_Landolt_Antoine.loc[cas]
        _within(name, kelvin, float(row["Tmin"]), float(row["Tmax"]))
        return float(Antoine(kelvin, row["A"], row["B"], row["C"], base=np.e))
    from chemicals.dippr import EQ101

    row = row_of("Psat_data_Perrys2_8", cas)
    _within(name, kelvin, float(row["Tmin"]), float(row["Tmax"]))
    return float(EQ101(kelvin, row["C1"], row["C2"], row["C3"], row["C4"], row["C5"]))


def molar_mass(name: str) -> float:
    """Molar mass of a solvent in `VAPOURS`, kg/mol."""
    return solvent_molar_mass(name)


@computable
def vapour_diffusivity(name: str, temperature: float, pressure: float = 101325.0) -> float:
    """Diffusion coefficient of a vapour in air, D_a in m2/s, by Fuller's method; 5 % on average.

    Parameters
    ----------
    name : str
        A key of `VAPOURS`.
    temperature : float
        K, > 0.
    pressure : float
        Of the air, Pa, > 0.

    Returns
    -------
    float
        2.50e-5 for water at 298 K.
    """
    name = _name(name, "diffusivity (m2/s)")
    mass = molar_mass(name)
    kelvin, p = positive("temperature", temperature, "K"), positive("pressure", pressure, "Pa")
    volume = _WATER_VOLUME if name == "water" else float(np.dot(_DIFFUSION_VOLUMES, VAPOURS[name]))
    reduced = 2e3 / (1 / mass + 1 / _AIR_MOLAR_MASS)  # g/mol
    spread = (np.cbrt(volume) + np.cbrt(_AIR_VOLUME)) ** 2
    with np.errstate(over="ignore"):
        value = 0.00143e-4 / (np.sqrt(reduced) * spread) * np.float64(kelvin) ** 1.75 / (p * 1e-5)
    return positive("vapour diffusivity", value, "m2/s")


def air_kinematic_viscosity(temperature: float, pressure: float = 101325.0) -> float:
    """Kinematic viscosity of dry air, nu_air in m2/s: Sutherland's law over the ideal-gas density, within 1 %.

    Parameters
    ----------
    temperature : float
        K, in [150, 1000].
    pressure : float
        Pa, > 0.
    """
    kelvin = number("temperature", temperature, least=150.0, most=1000.0, unit="K")
    p = positive("pressure", pressure, "Pa")
    viscosity = 1.458e-6 * kelvin**1.5 / (kelvin + 110.4)
    return positive("air_viscosity", viscosity * GAS_CONSTANT * kelvin / _AIR_MOLAR_MASS / p, "m2/s")


@finite_result("vapour concentration")
def vapour_concentration(
    vapour_pressure: ArrayLike, molar_mass: ArrayLike, liquid_density: ArrayLike, temperature: ArrayLike
) -> FloatArray:
    """Vapour mass concentration over the liquid's density, ``p M / (R T rho_l)``: what Eq. (43a) needs as C.

    Parameters
    ----------
    vapour_pressure : array_like
        Pa, >= 0.
    molar_mass, liquid_density, temperature : array_like
        kg/mol, kg/m3, K, > 0.

    Returns
    -------
    ndarray, dimensionless; 1.73e-5 for water at 293 K.
    """
    p = real("vapour_pressure", vapour_pressure, least=0.0, unit="Pa")
    mass = real("molar_mass", molar_mass, above=0.0, unit="kg/mol")
    rho = real("liquid_density", liquid_density, above=0.0, unit="kg/m3")
    kelvin = real("temperature", temperature, above=0.0, unit="K")
    value: FloatArray = (p / rho) * (mass / (GAS_CONSTANT * kelvin))
    return value


def solvent_activity(volume_fraction: ArrayLike, chi: ArrayLike = 0.0) -> FloatArray:
    """Flory-Huggins activity of one solvent, ``(1 - phi) exp(phi + chi phi^2)``.

    Parameters
    ----------
    volume_fraction : array_like
        Of the polymer, in [0, 1].
    chi : array_like
        Interaction parameter, in [-5, 5]; 1/2 is a theta solvent.

    Returns
    -------
    ndarray. Above 1 (unstable: the solution separates) is possible for chi > 1/2.
    """
    phi = real("volume_fraction", volume_fraction, least=0.0, most=1.0)
    x = real("chi", chi, least=-5.0, most=5.0)
    value: FloatArray = (1 - phi) * np.exp(phi * (1 + x * phi))
    return value


def equilibrium_fraction(relative_humidity: float, chi: float = 0.0) -> float:
    """Polymer fraction at which drying in vapour ends: activity = relative humidity (Flory-Huggins).

    Parameters
    ----------
    relative_humidity : float
        Partial pressure over vapour pressure, in [0, 1); 0 gives 1.
    chi : float
        In [-5, 5].

    Returns
    -------
    float
        The one root in (0, 1], to 1e-14.

    Examples
    --------
    >>> round(equilibrium_fraction(0.4), 9), round(equilibrium_fraction(0.4, 0.45), 9)
    (0.824643499, 0.883674284)
    """
    rh = number("relative_humidity", relative_humidity, least=0.0, below=1.0)
    x = number("chi", chi, least=-5.0, most=5.0)
    if rh == 0:
        return 1.0
    from scipy.optimize import brentq

    def excess(log_solvent: float) -> float:
        phi = -float(np.expm1(log_solvent))
        if phi > 0.3:
            mixing = log_solvent + phi * (1 + x * phi)
        else:  # ln(1 - phi) + phi + phi^2/2 as a series: nothing cancels in dilute or theta solutions
            mixing = phi**2 * ((x - 0.5) - phi * sum(phi**n / (n + 3) for n in range(32, -1, -1)))
        return mixing - float(np.log(rh))

    root = brentq(excess, float(np.log(rh)) - 7.0, 0.0, xtol=1e-300, rtol=1e-15)
    return -float(np.expm1(float(root)))


def flory_huggins_coefficient(solvent_fractions: FloatArray, molar_volumes: FloatArray, chi: FloatArray) -> FloatArray:
    """Activity coefficients ``a_i / phi_i`` of solvents in a long polymer, Flory-Huggins.

    Parameters
    ----------
    solvent_fractions : ndarray, (solvent, ...)
        Volume fractions; the rest is polymer.
    molar_volumes, chi : ndarray, (solvent,)
        m3/mol, and interaction with the polymer.

    Returns
    -------
    ndarray, (solvent, ...)
    """
    polymer = 1 - solvent_fractions.sum(axis=0)
    value: FloatArray = np.exp(log_flory_huggins(solvent_fractions, polymer, molar_volumes, chi)[0])
    return value


def raoult_coefficient(
    solvent_fractions: FloatArray, molar_volumes: FloatArray, polymer_molar_volume: float
) -> FloatArray:
    """Activity coefficients ``a_i / phi_i`` of solvents by Raoult's law; shapes as for `flory_huggins_coefficient`.

    `polymer_molar_volume` in m3/mol is that of what counts as one molecule: M/rho of the repeat unit.
    """
    polymer = 1 - solvent_fractions.sum(axis=0)
    value: FloatArray = np.exp(log_raoult(solvent_fractions, polymer, molar_volumes, polymer_molar_volume)[0])
    return value


def log_flory_huggins(
    solvent_fractions: FloatArray, polymer: FloatArray | float, molar_volumes: FloatArray, chi: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """``ln(a_i/phi_i)`` and ``1 - phi_i``, Flory-Huggins, each to rounding of itself: in a nearly pure solvent nothing
    cancels.

    Parameters
    ----------
    solvent_fractions : ndarray, (solvent, ...)
        Volume fractions.
    polymer : ndarray, (...)
        The rest, which a sum to 1 would not know well enough.
    molar_volumes, chi : ndarray, (solvent,)
        m3/mol, and interaction with the polymer.

    Returns
    -------
    log_coefficient, others : ndarray, (solvent, ...)
    """
    from spinline.base.kernels import plain  # loads the compiler
    from spinline.rheology._activity_kernels import flory_huggins

    log, others = np.empty_like(solvent_fractions), np.empty_like(solvent_fractions)
    plain(flory_huggins)(solvent_fractions, polymer, molar_volumes, chi, log, others)
    return log, others


def log_raoult(
    solvent_fractions: FloatArray, polymer: FloatArray | float, molar_volumes: FloatArray, polymer_molar_volume: float
) -> tuple[FloatArray, FloatArray]:
    """``ln(a_i/phi_i)`` and ``1 - phi_i`` by Raoult's law; as `log_flory_huggins`."""
    from spinline.base.kernels import plain
    from spinline.rheology._activity_kernels import raoult

    log, others = np.empty_like(solvent_fractions), np.empty_like(solvent_fractions)
    plain(raoult)(solvent_fractions, polymer, molar_volumes, polymer_molar_volume, log, others)
    return log, others


def _name(name: str, what: str) -> str:
    return known_name(name, VAPOURS, "solvent", f"give {what}")


def _within(name: str, temperature: float, low: float, high: float) -> None:
    if not low <= temperature <= high:
        raise InputError(
            "temperature",
            f"is outside the range of the vapour pressure of {name}",
            value=temperature,
            allowed=f"[{low:g}, {high:g}] K",
            remedy="give vapour_pressure (Pa)",
        )
