"""Heat in a drying jet: vapour pressures down to the wet bulb, heats of vaporisation, heat capacities, the air's
conductivity.

====================  ==================================================================================================
property              source
====================  ==================================================================================================
vapour pressure       `vapour.vapour_pressure`; beyond its range by Clausius and Clapeyron with the slope at its end:
                      HFIP below 294 K, water below the triple point (supercooled, not ice), acids, DMSO and dioxane
                      below their melting points
heat of vaporisation  DIPPR 106 (Perry's Handbook, 8th ed., Table 2-150), 1 % (isopropanol 3 %); HFIP, DMAc, NMP, TFA
                      and TFE from the slope of their vapour pressure, within 12 %
heat capacity         of the liquid near 298 K, CRC Handbook (97th ed.), 2 %; HFIP, TFA and TFE estimates, within 20 %
... of the vapour     Poling, Prausnitz, O'Connell, 5th ed., 298 K; DMF, DMSO, DMAc, NMP, TFA, TFE and HFIP estimates by
                      group contributions, within 15 %: it enters the small Ackermann correction alone
association           formic acid: Coolidge, J. Am. Chem. Soc. 50, 2166 (1928); acetic acid: MacDougall, J. Am. Chem.
                      Soc. 58, 2585 (1936); `dimer_share`
conductivity of air   U.S. Standard Atmosphere (1976), 1 %
====================  ==================================================================================================
"""

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.rheology import vapour
from spinline.rheology._liquid_rows import has_row, row_of
from spinline.rheology.solvents import SOLVENTS, known_name

__all__ = [
    "AIR_HEAT_CAPACITY",
    "COLDEST",
    "HOTTEST",
    "air_conductivity",
    "air_viscosity",
    "dimer_share",
    "liquid_heat_capacity",
    "saturation_pressure",
    "vaporisation_heat",
    "vapour_heat_capacity",
]

AIR_HEAT_CAPACITY = 1006.0  # J/kg/K
COLDEST, HOTTEST = 120.0, 480.0  # K, of jets and air
# range of the vapour pressure within which it is used as it is, K
_KNOWN = {
    "water": (273.16, 640.0),
    "HFIP": (294.0, 331.0),
    "NMP": (336.0, 477.0),
    "TFA": (264.0, 345.0),
    "DMAc": (273.15, 438.15),
    "TFE": (273.15, 347.0),
}
# J/kg/K near 298 K
_LIQUID = {
    "water": 4180.0,
    "ethanol": 2438.0,
    "acetone": 2175.0,
    "DMF": 2060.0,
    "DCM": 1192.0,
    "chloroform": 957.0,
    "THF": 1720.0,
    "formic acid": 2151.0,
    "HFIP": 1300.0,
    "DMSO": 1958.0,
    "DMAc": 2016.0,
    "acetic acid": 2053.0,
    "TFA": 1250.0,
    "NMP": 1680.0,
    "toluene": 1707.0,
    "methanol": 2531.0,
    "isopropanol": 2587.0,
    "ethyl acetate": 1937.0,
    "DCE": 1287.0,
    "MEK": 2202.0,
    "acetonitrile": 2229.0,
    "dioxane": 1740.0,
    "chlorobenzene": 1336.0,
    "TFE": 1780.0,
}
_VAPOUR = {
    "water": 1864.0,
    "ethanol": 1416.0,
    "acetone": 1283.0,
    "DMF": 1240.0,
    "DCM": 599.0,
    "chloroform": 548.0,
    "THF": 1061.0,
    "formic acid": 1161.0,
    "HFIP": 745.0,
    "DMSO": 1140.0,
    "DMAc": 1260.0,
    "acetic acid": 1056.0,
    "TFA": 690.0,
    "NMP": 1310.0,
    "toluene": 1126.0,
    "methanol": 1375.0,
    "isopropanol": 1486.0,
    "ethyl acetate": 1290.0,
    "DCE": 788.0,
    "MEK": 1421.0,
    "acetonitrile": 1272.0,
    "dioxane": 1046.0,
    "chlorobenzene": 871.0,
    "TFE": 850.0,
}
# log10 of the dissociation constant p_1^2/p_2 in mmHg: a - b/T
_DIMERS = {"formic acid": (10.755, 3083.0), "acetic acid": (10.4205, 3166.0)}
_MMHG = 133.322


def saturation_pressure(name: str, temperature: ArrayLike) -> FloatArray:
    """Vapour pressure of a pure liquid in Pa at any temperature from 120 to 480 K.

    Parameters
    ----------
    name : str
        A solvent of the library.
    temperature : array_like
        K.

    Returns
    -------
    ndarray
        Beyond the range of the correlation ``ln p`` goes on as a line in 1/T with the slope it has at the end of it.
    """
    known = _name(name)
    kelvin = _kelvin(temperature)
    low, high = _range(known)
    inside = np.clip(kelvin, low, high)
    value = np.array([vapour.vapour_pressure(known, float(t)) for t in inside.ravel()]).reshape(kelvin.shape)
    for end, beyond in ((low, kelvin < low), (high, kelvin > high)):
        if beyond.any():
            step = 0.05 if end == low else -0.05
            near, at = (np.log(vapour.vapour_pressure(known, t)) for t in (end + step, end))
            slope = (near - at) / (1 / (end + step) - 1 / end)
            value = np.where(beyond, np.exp(at + slope * (1 / np.where(beyond, kelvin, end) - 1 / end)), value)
    return value


def vaporisation_heat(name: str, temperature: ArrayLike) -> FloatArray:
    """Heat of vaporisation in J/kg of liquid, into vapour at saturation (dimers where there are any); as
    `saturation_pressure`.
    """
    known = _name(name)
    kelvin = _kelvin(temperature)
    cas = SOLVENTS[known][0]
    mass = vapour.molar_mass(known)
    if has_row("phase_change_data_Perrys2_150", cas):
        from chemicals.dippr import EQ106

        row = row_of("phase_change_data_Perrys2_150", cas)
        low = max(float(row["Tmin"]), 0.5 * COLDEST)
        top = min(float(row["Tmax"]), HOTTEST)
        terms = [float(row[key]) for key in ("Tc", "C1", "C2", "C3", "C4")]
        # the fits of the acids turn below their ranges
        clipped = np.clip(kelvin, low if known in _DIMERS else COLDEST, top)
        molar = np.array([EQ106(float(t), *terms) for t in clipped.ravel()]).reshape(kelvin.shape)  # J/mol
        return np.asarray(molar / mass, dtype=np.float64)
    t = np.clip(kelvin, *_range(known))
    step = 0.05
    up, down = (np.log(saturation_pressure(known, t + d)) for d in (step, -step))
    slope = (up - down) / (1 / (t + step) - 1 / (t - step))
    return np.asarray(-slope * vapour.GAS_CONSTANT / mass, dtype=np.float64)


def liquid_heat_capacity(name: str) -> float:
    """Heat capacity of the liquid near room temperature, J/kg/K."""
    return _LIQUID[_name(name)]


def vapour_heat_capacity(name: str) -> float:
    """Heat capacity of the vapour near room temperature, J/kg/K."""
    return _VAPOUR[_name(name)]


def dimer_share(name: str, temperature: ArrayLike, pressure: ArrayLike) -> FloatArray:
    """Part of a vapour's pressure that dimers have: 0 but for formic and acetic acid.

    Parameters
    ----------
    name : str
        A solvent of the library.
    temperature, pressure : array_like
        K, and the vapour's total pressure in Pa, >= 0.

    Returns
    -------
    ndarray, in [0, 1), from ``p = p_1 + p_1^2/K``.

    Examples
    --------
    >>> round(float(dimer_share("formic acid", 298.15, 5700.0)), 2)
    0.78
    """
    known = _name(name)
    t, p = _kelvin(temperature), real("pressure", pressure, least=0.0, unit="Pa")
    if known not in _DIMERS:
        return np.zeros(np.broadcast_shapes(t.shape, p.shape))
    a, b = _DIMERS[known]
    ratio = p / (10 ** (a - b / t) * _MMHG)  # p/K
    value: FloatArray = 4 * ratio / (1 + np.sqrt(1 + 4 * ratio)) ** 2  # p_2/p, nothing cancels
    return value


def air_conductivity(temperature: ArrayLike) -> FloatArray:
    """Thermal conductivity of dry air, W/m/K; temperature in K, [120, 480]."""
    t = _kelvin(temperature)
    value: FloatArray = 2.64638e-3 * t**1.5 / (t + 245.4 * 10 ** (-12 / t))
    return value


def air_viscosity(temperature: ArrayLike) -> FloatArray:
    """Dynamic viscosity of dry air, Pa s, Sutherland's law; temperature in K, [120, 480]."""
    t = _kelvin(temperature)
    value: FloatArray = 1.458e-6 * t**1.5 / (t + 110.4)
    return value


def _range(name: str) -> tuple[float, float]:
    if name in _KNOWN:
        return _KNOWN[name]
    row = row_of("Psat_data_Perrys2_8", SOLVENTS[name][0])
    return row["Tmin"], row["Tmax"]


def _name(name: str) -> str:
    return known_name(name, vapour.VAPOURS, "solvent", "give its heat of vaporisation and heat capacity")


def _kelvin(temperature: ArrayLike) -> FloatArray:
    return real("temperature", temperature, least=COLDEST, most=HOTTEST, unit="K")
