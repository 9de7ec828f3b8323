"""How thin a bending jet becomes: charge against surface tension, stretching against drying, until it is solid or lands.

A bending jet is a thread with the line charge ``lambda = q pi A`` (q = I/Q, A its cross-section over pi as if nothing had
dried, so that ``A l`` is constant), which its own repulsion lengthens against surface tension and viscosity::

    eta_E d(ln l)/dt = lambda^2 Lg/(4 pi eps0 pi W) - gamma/W^(1/2)        W: cross-section over pi as it is
                     = q^2 A^2 Lg/(4 eps0 W) - gamma/W^(1/2)               Lg = ln chi - 3/2
    dW/dt|drying     = -k_ev                                               W = A (s + phi_0), s the solvent left

With s as the clock, ``ds/dt = -k_ev/A``, one equation is left, `thinning`. Its limits:

* no drying: **terminal**, ``A^(3/2) = a^3 = 4 eps0 gamma/(q^2 Lg)`` (`terminal_radius`; Fridrikh et al. 2003, where it is
  called a diameter; this derivation gives a radius);
* no surface tension, one solvent, ``eta_E ~ phi^p``: **race**, ``1/A^2 = 1/A_0^2 + q^2 Lg/(2 eps0 k_ev eta_E0) (1 -
  phi_0^p)/p``, exactly (`race_radius`); ``a^4 = 2 p eps0 eta_E0 k_ev/(q^2 Lg)`` for a thick start;
* neither in time: **flight**, the jet lands wet with what it has.

Solvents leave side by side, each by its share of what is left of them, ``ds_i/dt = -k_i x_i/A`` (an ideal mixture in volumes,
each at its own wet bulb; straight jets have Flory and Huggins' activities and one temperature): the volatile ones first, and a
race is decided early. Without surface tension the constant rate that gives the same radius is exactly ::

    (1 - (phi_0/phi)^p)/k = p int (phi_0/phi)^p dln phi / k(phi)                   k(phi) = sum k_i x_i

Whatever ends the thinning first decides; the fibre's dry radius is ``(phi_0 A)^(1/2)``. The logarithm, chi = 100 by default,
is that of the bending's wavelength over the radius. Valid for slender jets past the onset of bending; the straight part
before it only sets A_0, which a race forgets.

References
----------
Fridrikh, Yu, Brenner, Rutledge, Phys. Rev. Lett. 90, 144502 (2003) (the terminal law, in Gaussian units). The race is
derived here.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, positive, real
from spinline.base.constants import EPS0
from spinline.base.errors import InputError
from spinline.jetprofile._whipping_kernels import march

__all__ = [
    "Thinning",
    "bending_liquid",
    "leaving",
    "log_term",
    "race_radius",
    "solvents_of",
    "terminal_radius",
    "thinning",
]

Mixture: TypeAlias = tuple[ArrayLike, ArrayLike]


def log_term(chi: float = 100.0) -> float:
    """``Lg = ln chi - 3/2``: chi is the wavelength of the bending over the jet's radius, > e^1.5."""
    return float(np.log(real("chi", chi, above=4.4817, below=1e12))) - 1.5


def terminal_radius(charge_density: ArrayLike, surface_tension: ArrayLike, chi: float = 100.0) -> FloatArray:
    """Radius at which a jet's own charge no longer lengthens it.

    Parameters
    ----------
    charge_density : array_like
        q = I/Q, C/m3, > 0.
    surface_tension : array_like
        N/m, > 0.
    chi : float
        Wavelength over radius.

    Returns
    -------
    ndarray
        a of the undried jet, m; a fibre's dry radius is ``a phi_0^(1/2)``.

    Examples
    --------
    >>> round(float(terminal_radius(100.0, 0.03)) * 1e9, 1)
    3246.5
    """
    q = real("charge_density", charge_density, above=0.0, unit="C/m3")
    gamma = real("surface_tension", surface_tension, above=0.0, unit="N/m")
    value: FloatArray = np.cbrt(4 * EPS0 * gamma / log_term(chi)) * np.cbrt(1 / q) ** 2
    return value


def race_radius(
    charge_density: ArrayLike,
    extensional_viscosity: ArrayLike,
    evaporation: ArrayLike,
    volume_fraction: ArrayLike,
    power: float = 4.67,
    start: ArrayLike = np.inf,
    chi: float = 100.0,
) -> FloatArray:
    """Radius at which a jet without surface tension has dried while it was stretched, exactly.

    Parameters
    ----------
    charge_density : array_like
        q = I/Q, C/m3, > 0.
    extensional_viscosity : array_like
        eta_E at the solution's own fraction, Pa s, > 0; it grows as ``phi^power``.
    evaporation : array_like
        k_ev, m2/s, > 0: cross-section over pi that the air takes in a second.
    volume_fraction : array_like
        phi_0, in (0, 1).
    power : float
        In (0, 20].
    start : array_like
        Radius at which bending sets in, m; infinite by default.
    chi : float
        Wavelength over radius.

    Returns
    -------
    ndarray
        a of the undried jet, m.
    """
    q = real("charge_density", charge_density, above=0.0, unit="C/m3")
    eta = real("extensional_viscosity", extensional_viscosity, above=0.0, unit="Pa s")
    k = real("evaporation", evaporation, above=0.0, unit="m2/s")
    phi = real("volume_fraction", volume_fraction, above=0.0, below=1.0)
    p = positive("power", power, "1")
    begin = np.asarray(start, dtype=np.float64)
    drive = q * q * log_term(chi) / (2 * EPS0 * k * eta) * (-np.expm1(p * np.log(phi)) / p)
    value: FloatArray = (begin**-4.0 + drive) ** -0.25
    return value


@dataclass(frozen=True, eq=False)
class Thinning:
    """How jets ended: arrays of the inputs' broadcast shape.

    Attributes
    ----------
    radius : ndarray
        a of the undried jet, m.
    volume_fraction : ndarray
        Polymer where it ended: the solid fraction, or less where it landed wet.
    time : ndarray
        From the onset of bending, s.
    strain_rate : ndarray
        Rate of stretching where most of the stretch was made (its mean over the logarithm of the length), 1/s.
    wet : ndarray of bool
        Landed before it was solid.
    """

    radius: FloatArray
    volume_fraction: FloatArray
    time: FloatArray
    strain_rate: FloatArray
    wet: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]


def thinning(
    charge_density: ArrayLike,
    surface_tension: ArrayLike,
    extensional_viscosity: ArrayLike,
    evaporation: ArrayLike,
    volume_fraction: ArrayLike,
    flight_time: ArrayLike,
    start: ArrayLike,
    *,
    power: ArrayLike = 4.67,
    solid_fraction: ArrayLike = 1.0,
    chi: float = 100.0,
    steps: int = 96,
    mixture: Mixture | None = None,
) -> Thinning:
    """Stretching, drying and surface tension together, until the jet is solid or lands.

    Parameters
    ----------
    charge_density, surface_tension, extensional_viscosity, evaporation, volume_fraction : array_like
        As for `race_radius` and `terminal_radius`.
    flight_time : array_like
        Time from the onset of bending to the collector, s, > 0.
    start : array_like
        Radius at the onset, m, > 0.
    power : array_like
        eta_E grows as ``phi^power``.
    solid_fraction : array_like
        Fraction at which the jet is solid, in (phi_0, 1].
    chi : float
        Wavelength over radius.
    steps : int
        Of the march in the solvent left.
    mixture : tuple of two array_like, optional
        Volume shares of the solvents, sum 1, and their rates over `evaporation`, > 0, each on a last axis more than the
        others have.

    Returns
    -------
    Thinning

    Notes
    -----
    March of ``x = 1/A^2`` over even steps of ``ln phi``: exact without surface tension, whatever the steps, for one solvent;
    first order in it (0.1 % of the radius with 96 steps where both matter) and second in a mixture's rate, a few
    microseconds a jet.
    """
    if steps < 4:
        raise InputError("steps", "is too few", value=steps, allowed=">= 4")
    flight = real("flight_time", flight_time, above=0.0, unit="s")
    q, gamma, eta, k, phi0, begin, p, solid, flight, *solvents = bending_liquid(
        charge_density,
        surface_tension,
        extensional_viscosity,
        evaporation,
        volume_fraction,
        start,
        power,
        solid_fraction,
        flight,
        *solvents_of(mixture),
    )
    electric, span = q * q * log_term(chi) / (4 * EPS0), np.log(solid / phi0)
    jets = np.stack([electric, gamma, eta, flight, begin, p, span], axis=-1).reshape(-1, 7)
    out = np.empty((len(jets), 5))
    march(np.ascontiguousarray(jets), *leaving(solvents, k, phi0), _stations(steps), out)
    x, left, time, rate, landed = (column.reshape(q.shape) for column in out.T)
    return Thinning(x**-0.25, phi0 / left, time, rate, landed > 0)


def bending_liquid(
    charge_density: ArrayLike,
    surface_tension: ArrayLike,
    extensional_viscosity: ArrayLike,
    evaporation: ArrayLike,
    volume_fraction: ArrayLike,
    start: ArrayLike,
    power: ArrayLike,
    solid_fraction: ArrayLike,
    *others: FloatArray,
) -> tuple[FloatArray, ...]:
    """What every law of a bending jet is given, checked, in this order, and `others` (checked), broadcast together."""
    given = {
        "charge_density": (charge_density, "C/m3"),
        "surface_tension": (surface_tension, "N/m"),
        "extensional_viscosity": (extensional_viscosity, "Pa s"),
        "evaporation": (evaporation, "m2/s"),
        "volume_fraction": (volume_fraction, "1"),
        "start": (start, "m"),
    }
    arrays = [real(name, value, above=0.0, unit=unit) for name, (value, unit) in given.items()]
    p = real("power", power, above=0.0, most=20.0)
    solid = real("solid_fraction", solid_fraction, above=0.0, most=1.0)
    together = np.broadcast_arrays(*arrays, p, solid, *others)
    phi0, solid = together[4], together[7]
    if (phi0 >= solid).any():
        allowed = f"below the solid fraction, {float(solid.min()):g}"
        raise InputError("volume_fraction", "is that of a solid already", value=float(phi0.max()), allowed=allowed)
    return tuple(together)


def solvents_of(mixture: Mixture | None) -> list[FloatArray]:
    """Volume shares of a mixture's solvents, then the ratios of their rates, checked; none for one solvent."""
    if mixture is None:
        return []
    shares, ratios = real("shares", mixture[0], least=0.0), real("ratios", mixture[1], above=0.0)
    off = np.abs(shares.sum(axis=-1) - 1)
    if (off > 1e-9).any():
        raise InputError(
            "shares", "do not sum to 1", value=float(shares.sum(axis=-1).flat[np.argmax(off)]), allowed="1"
        )
    both = np.broadcast_arrays(shares, ratios)
    return [array[..., i] for array in both for i in range(both[0].shape[-1])]


def leaving(solvents: list[FloatArray], rate: FloatArray, volume_fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Volume of each solvent in that of the solution, which a march uses up, and its rate: (jet, solvent)."""
    n = len(solvents) // 2
    shares, ratios = (solvents[:n], solvents[n:]) if n else ([np.ones_like(rate)], [np.ones_like(rate)])
    volumes = np.stack([(1 - volume_fraction) * share for share in shares], axis=-1)
    rates = np.stack([rate * ratio for ratio in ratios], axis=-1)
    return volumes.reshape(-1, max(n, 1)), rates.reshape(-1, max(n, 1))


def _stations(steps: int) -> FloatArray:
    """Where the march stops, 0 to 1: even, and before the first of them by decades, for jets that land at once."""
    even = np.arange(1, steps + 1) / steps
    return np.concatenate(([0.0], np.geomspace(1e-18, even[0], steps)[:-1], even))
