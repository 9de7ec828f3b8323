"""What a solution does to a beam of one or many energies: attenuation and refraction, against the polymer fraction.

    mu_i = mu_s,i + phi D_i,    delta_i = delta_s,i + phi (delta_p,i - delta_s,i)

for each line i of the spectrum, less those of the air that the jet displaces.
"""

from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import FloatArray, positive, real
from spinline.base.constants import GAS_CONSTANT
from spinline.base.errors import InputError
from spinline.rheology.materials import Polymer
from spinline.xray.matter.attenuation import Composition, Material, mass_attenuation, material
from spinline.xray.matter.refraction import refraction_decrement, wavelength
from spinline.xray.matter.solution import AIR
from spinline.xray.matter.spectrum import Spectrum
from spinline.xray.row.forward import Absorber

__all__ = ["Medium", "solution_medium"]

_AIR_MOLAR_MASS = 0.028965  # kg/mol
_FIELDS = ("weight", "solvent", "contrast", "air", "delta_solvent", "delta_contrast", "delta_air")


@dataclass(frozen=True, eq=False)
class Medium:
    """Attenuation and refraction of a solution at the lines of a beam.

    Attributes
    ----------
    energy_kev : ndarray, shape (lines,)
    weight : ndarray, shape (lines,)
        Share of the signal, sum 1.
    solvent, contrast, air : ndarray, shape (lines,)
        1/m: of the solvent, D, and of the displaced air.
    delta_solvent, delta_contrast, delta_air : ndarray, shape (lines,)
        Decrements of the refractive index: of the solvent, polymer less solvent, and air.
    """

    energy_kev: FloatArray
    weight: FloatArray
    solvent: FloatArray
    contrast: FloatArray
    air: FloatArray
    delta_solvent: FloatArray
    delta_contrast: FloatArray
    delta_air: FloatArray

    def __post_init__(self) -> None:
        energy = np.atleast_1d(real("energy_kev", self.energy_kev, above=0.0, unit="keV"))
        object.__setattr__(self, "energy_kev", energy)
        for name in _FIELDS:
            array = np.atleast_1d(real(name, getattr(self, name)))
            if array.shape != energy.shape:
                raise InputError(name, "does not fit the lines", value=array.shape, allowed=f"({energy.size},)")
            object.__setattr__(self, name, array)
        if (self.weight < 0).any() or abs(self.weight.sum() - 1.0) > 1e-9:
            raise InputError("weight", "are not shares of sum 1", value=float(self.weight.sum()))
        if (self.solvent <= 0).any():
            raise InputError("solvent", "does not attenuate", value=float(self.solvent.min()), allowed="> 0 1/m")

    @property
    def wavelength(self) -> FloatArray:
        """Of each line, m."""
        return wavelength(self.energy_kev)

    @property
    def absorber(self) -> Absorber:
        """The thin limit: attenuation averaged over the signal."""
        w = self.weight
        return Absorber(float(w @ self.solvent), float(w @ self.contrast), float(w @ self.air))

    def delta_over_mu(self, fraction: float = 0.0) -> float:
        """delta/mu of the solution less air at a polymer fraction, averaged over the signal, m."""
        w, phi = self.weight, float(real("fraction", fraction))
        mu = w @ (self.solvent - self.air + phi * self.contrast)
        delta = w @ (self.delta_solvent - self.delta_air + phi * self.delta_contrast)
        if not mu > 0:
            raise InputError("fraction", "leaves no attenuation", value=phi)
        return float(delta / mu)

    def with_absorber(self, absorber: Absorber) -> "Medium":
        """The same refraction with another attenuation (measured, or calibrated), for a beam of one line."""
        if self.energy_kev.size != 1:
            raise InputError("absorber", "is that of one line", value=f"{self.energy_kev.size} lines")
        return replace(
            self,
            solvent=np.array([absorber.solvent]),
            contrast=np.array([absorber.contrast]),
            air=np.array([absorber.air]),
        )


def solution_medium(
    polymer: Composition | Polymer | Material,
    solvent: Composition | Material,
    beam: float | Spectrum,
    *,
    coherent: bool = True,
    temperature: float = 293.15,
    pressure: float = 101325.0,
) -> Medium:
    """Attenuation and refraction of a polymer solution in air.

    Parameters
    ----------
    polymer, solvent : str, mapping, Polymer or Material
        As in `attenuation.attenuation_contrast`.
    beam : float or Spectrum
        Photon energy in keV, or the lines that the detector sees.
    coherent : bool
        True: total attenuation. False: without coherent scatter, the better one for the wave close behind a jet.
    temperature : float
        K, of solvent and air.
    pressure : float
        Pa, of the air, > 0.

    Returns
    -------
    Medium

    Raises
    ------
    InputError
        As `attenuation_contrast`. No contrast of absorption is asked for: where it vanishes, that of refraction does not.
    """
    lines = beam if isinstance(beam, Spectrum) else Spectrum(np.array([beam]), np.ones(1))
    energy = lines.energy_kev
    p, s = material(polymer, temperature=temperature), material(solvent, temperature=temperature)
    density = positive("pressure", pressure, "Pa") * _AIR_MOLAR_MASS / (GAS_CONSTANT * temperature)
    base = s.attenuation(energy, coherent=coherent)
    delta = refraction_decrement(s, energy)
    return Medium(
        energy_kev=energy,
        weight=lines.weight,
        solvent=base,
        contrast=p.attenuation(energy, coherent=coherent) - base,
        air=density * mass_attenuation(AIR, energy, coherent=coherent),
        delta_solvent=delta,
        delta_contrast=refraction_decrement(p, energy) - delta,
        delta_air=refraction_decrement(Material(AIR, density), energy),
    )
