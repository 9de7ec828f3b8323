"""Density and viscosity of liquid water at saturation, 273.16 to 400 K, as Chebyshev series of degree 24.

They reproduce, to 1e-14 and 1e-13, what `chemicals` computes from the IAPWS formulations; a test holds them against it. Water
is the solvent of most scenes, and importing that library takes as long as everything else that a scene in water needs.

References
----------
Wagner, Pruss, J. Phys. Chem. Ref. Data 31, 387 (2002) (IAPWS-95); Huber et al., ibid. 38, 101 (2009) (viscosity).
"""

import math

__all__ = ["HIGHEST", "LOWEST", "water_density", "water_viscosity"]

LOWEST, HIGHEST = 273.16, 400.0  # K

_DENSITY = (  # kg/m3
    975.1761764746375,
    -31.909045588792374,
    -6.350899703728328,
    0.712474811926255,
    -0.17439623638539206,
    0.04017510077097915,
    -0.010713499009412354,
    0.0028992340275818314,
    -0.0008117522846825484,
    0.00023356318240875864,
    -6.882257283680189e-05,
    2.0552712687667744e-05,
    -6.1587787256492576e-06,
    1.8363727053207738e-06,
    -5.414462649736911e-07,
    1.5710792955203748e-07,
    -4.466718136192868e-08,
    1.2385575108730749e-08,
    -3.331896783895743e-09,
    8.603894418070707e-10,
    -2.061149977500863e-10,
    4.274997090202832e-11,
    -8.459105857138187e-12,
    8.96664424830396e-13,
    -1.7152554647034233e-12,
)
_LOG_VISCOSITY = (  # of Pa s
    -7.557239739252744,
    -1.0163936680832562,
    0.17236244520372562,
    -0.03307291723418979,
    0.007835059994567177,
    -0.002077534501787491,
    0.0005402476876713694,
    -0.00013419652355362661,
    3.2155587824140776e-05,
    -7.639739269739437e-06,
    1.8563704294205797e-06,
    -4.7195074126691356e-07,
    1.2639910128958946e-07,
    -3.540388331047026e-08,
    1.0228105408733004e-08,
    -3.0051836273212475e-09,
    8.877184630637744e-10,
    -2.613484422759446e-10,
    7.616185817860308e-11,
    -2.185731280946426e-11,
    6.146228925286864e-12,
    -1.678866197996387e-12,
    4.51788092065847e-13,
    -1.0801304528633018e-13,
    3.661995361576484e-14,
)


def water_density(temperature: float) -> float:
    """kg/m3 at a temperature in K, in [`LOWEST`, `HIGHEST`]."""
    return _series(_DENSITY, temperature)


def water_viscosity(temperature: float) -> float:
    """Pa s at a temperature in K, in [`LOWEST`, `HIGHEST`]."""
    return math.exp(_series(_LOG_VISCOSITY, temperature))


def _series(coefficients: tuple[float, ...], temperature: float) -> float:
    """Chebyshev series by Clenshaw's recurrence."""
    x = (2 * temperature - LOWEST - HIGHEST) / (HIGHEST - LOWEST)
    later, last = 0.0, 0.0
    for coefficient in coefficients[:0:-1]:
        later, last = coefficient + 2 * x * later - last, later
    return coefficients[0] + x * later - last
