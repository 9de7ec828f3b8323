"""What energies the detector's signal is made of: lines, harmonics, broad spectra.

A line E with the share w of the signal without a jet adds ``w exp(-mu(E) L)`` to the transmission, so that

    T = sum_i w_i exp(-mu_i L),    sum w_i = 1.

The shares are those of the *signal*: the beam's photons times what the detector makes of each. A scintillator behind optics
gives light in proportion to the energy it takes up, ``E (1 - exp(-mu_c t))`` for a crystal of thickness t (`seen_by`). A jet
hardens the beam: taken for one line, the mean attenuation is too small on long chords and too large at the rim.

Counts here are those of the photons; a detector that integrates energy has a larger variance at equal mean, by
``<E^2>/<E>^2`` of the photons it absorbs (`excess_variance`), which a gain estimated from the flats' own scatter holds already.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive, real
from spinline.base.errors import InputError
from spinline.rheology.materials import Polymer
from spinline.xray.matter.attenuation import HIGHEST_KEV, LOWEST_KEV, Composition, Material, material

__all__ = ["Spectrum", "gaussian_spectrum", "harmonic_spectrum", "scintillator_response"]

Response = Callable[[FloatArray], ArrayLike]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Lines of a beam, as the detector weighs them.

    Attributes
    ----------
    energy_kev : ndarray, shape (lines,)
        keV, [1, 200], rising.
    weight : ndarray, shape (lines,)
        Share of the signal without a jet, >= 0; divided by the sum.
    """

    energy_kev: FloatArray
    weight: FloatArray

    def __post_init__(self) -> None:
        energy = np.atleast_1d(real("energy_kev", self.energy_kev, least=LOWEST_KEV, most=HIGHEST_KEV, unit="keV"))
        weight = np.atleast_1d(real("weight", self.weight, least=0.0))
        if energy.ndim != 1 or energy.size == 0 or (np.diff(energy) <= 0).any():
            raise InputError("energy_kev", "does not rise", value=self.energy_kev, remedy="sort the lines")
        if weight.shape != energy.shape or not weight.sum() > 0:
            raise InputError(
                "weight",
                "does not give each energy its share",
                value=self.weight,
                allowed=f"{energy.size} numbers >= 0",
                remedy="one share for each energy, not all 0",
            )
        object.__setattr__(self, "energy_kev", energy)
        object.__setattr__(self, "weight", weight / weight.sum())

    @property
    def mean_kev(self) -> float:
        """Mean energy of the signal."""
        return float(self.weight @ self.energy_kev)

    @property
    def excess_variance(self) -> float:
        """Variance of an energy-integrating detector's signal over that of equal photons, ``<E^2>/<E>^2 >= 1``.

        Means over the absorbed photons, of which each line has ``w/E`` (signal in proportion to energy).
        """
        photons = self.weight / self.energy_kev
        photons = photons / photons.sum()
        return float((photons @ self.energy_kev**2) / (photons @ self.energy_kev) ** 2)

    def seen_by(self, response: Response) -> "Spectrum":
        """The spectrum weighed by what a detector makes of a photon.

        Parameters
        ----------
        response : callable
            Of energies in keV: signal per photon, >= 0, any unit. `scintillator_response` makes one.
        """
        factor = real("response", response(self.energy_kev), least=0.0)
        return Spectrum(self.energy_kev, self.weight * factor)

    def behind(self, what: Composition | Polymer | Material, thickness: float) -> "Spectrum":
        """The spectrum behind a filter: a material (as in `attenuation.material`) of a thickness in m, >= 0."""
        t = number("thickness", thickness, least=0.0, unit="m")
        depth = material(what).attenuation(self.energy_kev) * t
        return Spectrum(self.energy_kev, self.weight * np.exp(-(depth - depth.min())))


def harmonic_spectrum(energy_kev: float, shares: Mapping[int, float]) -> Spectrum:
    """Monochromator's line with its harmonics.

    Parameters
    ----------
    energy_kev : float
        Of the fundamental.
    shares : mapping
        Order (>= 2) to share of the signal, [0, 1) in all: ``{3: 0.01}`` is 1 % at three times the energy.

    Returns
    -------
    Spectrum
    """
    energy = positive("energy_kev", energy_kev, "keV")
    lines, rest = {1: 0.0}, 1.0
    for order, share in shares.items():
        if isinstance(order, bool) or not isinstance(order, int) or order < 2:
            raise InputError("shares", "is not the order of a harmonic", value=order, allowed="an integer >= 2")
        lines[order] = number(f"shares[{order}]", share, least=0.0, below=1.0)
        rest -= lines[order]
    if rest <= 0.0:
        raise InputError("shares", "leave nothing to the fundamental", value=1.0 - rest, allowed="a sum under 1")
    lines[1] = rest
    orders = sorted(lines)
    return Spectrum(energy * np.array(orders, dtype=np.float64), np.array([lines[o] for o in orders]))


def gaussian_spectrum(mean_kev: float, width_kev: float, *, lines: int = 25) -> Spectrum:
    """A broad beam: a normal distribution of the signal, cut at 2.5 standard deviations.

    Parameters
    ----------
    mean_kev, width_kev : float
        Mean and standard deviation before the cut, keV; ``mean - 2.5 width`` at least 1 keV.
    lines : int
        Evenly spaced, >= 3; 25 are exact to 1e-6 of the transmission of 100 um of water at 13 +- 4 keV.

    Returns
    -------
    Spectrum
    """
    mean, width = positive("mean_kev", mean_kev, "keV"), positive("width_kev", width_kev, "keV")
    if isinstance(lines, bool) or not isinstance(lines, int) or not 3 <= lines <= 100_000:
        raise InputError("lines", "are too few, or too many", value=lines, allowed="an integer, 3 to 100000")
    t = np.linspace(-2.5, 2.5, lines)
    return Spectrum(mean + width * t, np.exp(-0.5 * t**2))


def scintillator_response(
    what: Composition | Material, thickness: float, *, integrating: bool = True
) -> Callable[[FloatArray], FloatArray]:
    """Signal per photon of a scintillator, ``E (1 - exp(-mu t))``, or ``1 - exp(-mu t)`` where it counts photons.

    Parameters
    ----------
    what : str, mapping or Material
        Of the crystal, with its density: ``Material("Lu3Al5O12", 6730.0)``.
    thickness : float
        m, > 0.
    integrating : bool
        True: light in proportion to the energy. False: a counter.

    Returns
    -------
    callable
        For `Spectrum.seen_by`.
    """
    crystal, t = material(what), positive("thickness", thickness, "m")

    def response(energy_kev: FloatArray) -> FloatArray:
        taken = -np.expm1(-crystal.attenuation(energy_kev, coherent=False) * t)
        return np.asarray(energy_kev * taken if integrating else taken)

    return response
