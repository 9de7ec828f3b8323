"""From names and a photon energy to the attenuation that the image model asks for.

    mu = s_s rho_s + phi D,    mu_air = s_air p M/(R_g T)

The jet displaces air that the flat field was taken through: in PEO/water at 10 keV, left out, +0.0045 in the polymer fraction.
"""

from spinline.base.checks import positive
from spinline.base.constants import GAS_CONSTANT
from spinline.rheology.materials import Polymer
from spinline.xray.matter.attenuation import Composition, Material, mass_attenuation, material
from spinline.xray.matter.energy import usable_contrast
from spinline.xray.row.forward import Absorber

__all__ = ["AIR", "solution_absorber"]

AIR = {"N2": 0.7553, "O2": 0.2318, "Ar": 0.0129}  # dry, mass fractions
_AIR_MOLAR_MASS = 0.028965  # kg/mol


def solution_absorber(
    polymer: Composition | Polymer | Material,
    solvent: Composition | Material,
    energy_kev: float,
    *,
    coherent: bool = True,
    temperature: float = 293.15,
    pressure: float = 101325.0,
) -> Absorber:
    """Attenuation of a polymer solution in air, at one photon energy.

    Parameters
    ----------
    polymer, solvent : str, mapping, Polymer or Material
        As in `attenuation_contrast`.
    energy_kev : float
        keV, [1, 200].
    coherent : bool
        True: total attenuation. False: without coherent scatter. They differ by 0.17 in the fraction of PEO in water at 10 keV.
    temperature : float
        K, of solvent and air.
    pressure : float
        Pa, of the air; > 0.

    Returns
    -------
    Absorber

    Raises
    ------
    InputError
        As `usable_contrast`: near zero contrast, with an energy that works.
    """
    contrast = usable_contrast(polymer, solvent, energy_kev, coherent=coherent, temperature=temperature)
    base = float(material(solvent, temperature=temperature).attenuation(energy_kev, coherent=coherent))
    density = positive("pressure", pressure, "Pa") * _AIR_MOLAR_MASS / (GAS_CONSTANT * temperature)
    return Absorber(base, contrast, density * float(mass_attenuation(AIR, energy_kev, coherent=coherent)))
