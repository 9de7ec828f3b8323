"""Bending of an electrified jet: Earnshaw's three charges, Eq. (10), the growth of a wave, Eq. (11), and where it sets in.

Eq. (11) of the review lacks the tension P of its own Eq. (12b), and its e_0 is Gaussian. In SI, x = k r the wavenumber::

    g^2 + (3/4) (mu x^4 / rho r^2) g - C x^2 = 0,   C = [lambda^2 ln(Lc / r) / (4 pi eps_0) - pi gamma r - P] / (pi rho r^4)

C > 0 is unstable at every x: there is no cut-off. The logarithm's length is that of a line charge, ``Lc = 1.851 / k``, 0.295
wavelengths (`logarithm`). Along a jet material waves are stretched, ``x ~ V^(-3/2)``; `bending_onset` follows
each, counting its growth where it is shorter than its distance from the needle and ``x < 0.5``, and says where the first
has grown a hundredfold (ten- and thousandfold: the spread). mu is the zero-shear viscosity: elastic stiffness against
bending is not modelled.

References
----------
Reneker, Yarin, Fong and Koombhongse, J. Appl. Phys. 87, 4531 (2000); Yarin, Koombhongse and Reneker, J. Appl. Phys. 89,
3018 (2001).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, computable, number, positive, real
from spinline.base.constants import EPS0
from spinline.base.errors import InputError

__all__ = [
    "LARGEST_WAVENUMBER",
    "LINE_CHARGE_LENGTH",
    "BendingOnset",
    "bending_drive",
    "bending_growth",
    "bending_onset",
    "critical_line_charge",
    "earnshaw_growth",
    "fastest_bending",
    "logarithm",
]

LINE_CHARGE_LENGTH = 1.851  # Lc k: 2 exp(1/2 - Euler's gamma)
LARGEST_WAVENUMBER = 0.5  # x = k r beyond which a slender jet is no longer one
_GROWN = (10.0, 100.0, 1000.0)


@computable
def earnshaw_growth(charge: ArrayLike, mass: ArrayLike, distance: ArrayLike) -> FloatArray:
    """Growth rate in 1/s of the middle one of three equal charges on a line, Eq. (10).

    ``sqrt(2 q^2 / (4 pi eps_0 m l^3))``.

    Parameters
    ----------
    charge, mass, distance : array_like
        q (C), m (kg), l (m): all SI, mass and distance > 0. (The review's form is Gaussian: fed SI, it is 9.5e4 times off.)

    Examples
    --------
    >>> round(float(earnshaw_growth(1e-12, 1e-9, 1e-3)), 6)
    134.071263
    """
    q = np.abs(real("charge", charge, unit="C"))
    m, length = real("mass", mass, above=0.0, unit="kg"), real("distance", distance, above=0.0, unit="m")
    value: FloatArray = q / np.sqrt(2 * np.pi * EPS0 * m) / length**1.5
    return value


@computable
def logarithm(x: ArrayLike) -> FloatArray:
    """``ln(Lc / r)`` of a wave of dimensionless wavenumber x = k r; Lc = 1.851 / k."""
    value: FloatArray = np.log(LINE_CHARGE_LENGTH / real("x", x, above=0.0))
    return value


@computable
def bending_drive(
    radius: ArrayLike,
    line_charge: ArrayLike,
    tension: ArrayLike,
    *,
    density: float,
    surface_tension: float,
    logarithm: ArrayLike,
) -> FloatArray:
    """C of the module in 1/s2: what bends the jet where positive.

    Parameters
    ----------
    radius, line_charge, tension : array_like
        r (m), lambda (C/m), P (N).
    density, surface_tension : float
        rho (kg/m3), gamma (N/m).
    logarithm : array_like
        ``ln(Lc / r)``.
    """
    r = real("radius", radius, above=0.0, unit="m")
    gamma = real("surface_tension", surface_tension, least=0.0, unit="N/m")
    pull = real("line_charge", line_charge, unit="C/m") ** 2 * real("logarithm", logarithm) / (4 * np.pi * EPS0)
    mass = np.pi * positive("density", density, "kg/m3") * r**4
    value: FloatArray = (pull - np.pi * gamma * r - real("tension", tension, unit="N")) / mass
    return value


@computable
def bending_growth(
    x: ArrayLike, drive: ArrayLike, *, radius: ArrayLike, viscosity: float, density: float
) -> FloatArray:
    """Growth rate in 1/s of a bending wave of dimensionless wavenumber x, the larger root of Eq. (11) with tension.

    Zero where the drive is negative (the wave then oscillates or decays).
    """
    wave, c = real("x", x, least=0.0), np.maximum(real("drive", drive, unit="1/s2"), 0.0)
    r, mu = real("radius", radius, above=0.0, unit="m"), number("viscosity", viscosity, least=0.0, unit="Pa s")
    b = 0.75 * mu * wave**4 / (positive("density", density, "kg/m3") * r**2)
    root = b + np.sqrt(b**2 + 4 * c * wave**2)
    value: FloatArray = np.where(root > 0, 2 * c * wave**2 / np.where(root > 0, root, 1.0), 0.0)
    return value


@computable
def fastest_bending(drive: float, *, radius: float, viscosity: float, density: float) -> tuple[float, float]:
    """Dimensionless wavenumber and growth rate (1/s) of the fastest bending wave, the logarithm held constant.

    ``x* = (C / 2 a^2)^(1/6)``, ``g* = C / (2 a x*^2)``, ``a = 3 mu / (4 rho r^2)``. Without
    viscosity growth rises with x without bound and there is no fastest wave.

    Raises
    ------
    InputError
        Where the drive or the viscosity is not > 0.
    """
    c = positive("drive", drive, "1/s2", remedy="a jet with C <= 0 does not bend")
    a = (
        0.75
        * positive("viscosity", viscosity, "Pa s")
        / (positive("density", density, "kg/m3") * positive("radius", radius, "m") ** 2)
    )
    x = float((c / (2 * a**2)) ** (1 / 6))
    return x, float(c / (2 * a * x**2))


@computable
def critical_line_charge(
    radius: ArrayLike, tension: ArrayLike, *, surface_tension: float, logarithm: ArrayLike
) -> FloatArray:
    """Line charge in C/m above which a jet bends: C = 0."""
    r = real("radius", radius, above=0.0, unit="m")
    gamma = real("surface_tension", surface_tension, least=0.0, unit="N/m")
    held = np.pi * gamma * r + real("tension", tension, least=0.0, unit="N")
    value: FloatArray = np.sqrt(4 * np.pi * EPS0 * held / real("logarithm", logarithm, above=0.0))
    return value


@dataclass(frozen=True)
class BendingOnset:
    """Where bending sets in along a straight jet.

    Attributes
    ----------
    position : float
        z in m where the first wave has grown a hundredfold; NaN where none does within the jet.
    earliest, latest : float
        The same for ten- and thousandfold: the spread of what seeds the waves.
    wavelength : float
        Wavelength in m there.
    """

    position: float
    earliest: float
    latest: float
    wavelength: float


@computable
def bending_onset(
    z: FloatArray,
    *,
    radius: FloatArray,
    velocity: FloatArray,
    line_charge: FloatArray,
    tension: FloatArray,
    density: float,
    surface_tension: float,
    viscosity: float,
    length: float | None = None,
    waves: int = 200,
) -> BendingOnset:
    """First place where a material wave has grown a hundredfold (ten- to thousandfold) along a straight jet.

    Parameters
    ----------
    z, radius, velocity, line_charge, tension : ndarray of shape (N,)
        Along the jet, SI; z increases.
    density, surface_tension, viscosity : float
        rho (kg/m3), gamma (N/m), zero-shear mu (Pa s).
    length : float, optional
        Lc of the logarithm in m, the same for every wave; by default 0.295 wavelengths.
    waves : int
        Number of material waves followed.
    """
    z = real("z", z, unit="m")
    if z.ndim != 1 or z.size < 3 or not (np.diff(z) > 0).all():
        raise InputError("z", "must be at least three increasing places")
    radius, velocity = real("radius", radius, above=0.0, unit="m"), real("velocity", velocity, above=0.0, unit="m/s")
    line_charge, tension = real("line_charge", line_charge, unit="C/m"), real("tension", tension, unit="N")
    for name, values in (
        ("radius", radius),
        ("velocity", velocity),
        ("line_charge", line_charge),
        ("tension", tension),
    ):
        if values.shape != z.shape:
            raise InputError(name, "is not given at every z", value=f"shape {values.shape}", allowed=f"shape {z.shape}")
    if length is not None:
        length = positive("length", length, "m")
    waves = int(number("waves", waves, least=1, most=1e5))
    ratio = velocity / velocity[0]
    stretch = ratio**-1.5
    # x at the start of the waves that pass x = 0.5 somewhere within the jet, and of some longer ones
    first = np.geomspace(LARGEST_WAVENUMBER * 1e-3, LARGEST_WAVENUMBER / stretch.min(), waves)
    x = first[:, np.newaxis] * stretch
    log = logarithm(x) if length is None else np.log(length / radius)
    drive = bending_drive(radius, line_charge, tension, density=density, surface_tension=surface_tension, logarithm=log)
    rate = bending_growth(x, drive, radius=radius, viscosity=viscosity, density=density)
    wavelength = 2 * np.pi * radius / x
    rate = np.where((wavelength < z) & (x < LARGEST_WAVENUMBER), rate, 0.0) / velocity
    grown = np.zeros_like(rate)
    np.cumsum(0.5 * (rate[:, 1:] + rate[:, :-1]) * np.diff(z), axis=1, out=grown[:, 1:])
    most = grown.max(axis=0)
    places, wave = [], np.nan
    for factor in _GROWN:
        beyond = np.flatnonzero(most >= np.log(factor))
        if not beyond.size:
            places.append(np.nan)
            continue
        i = int(beyond[0])
        share = (np.log(factor) - most[i - 1]) / (most[i] - most[i - 1])
        places.append(float(z[i - 1] + share * (z[i] - z[i - 1])))
        if factor == _GROWN[1]:
            wave = float(wavelength[np.argmax(grown[:, i]), i])
    return BendingOnset(places[1], places[0], places[2], wave)
