"""What the beam sees: absorption of a polymer solution, its image, and what can be read back from it.

==============  ==========================================================================
module          law
==============  ==========================================================================
`attenuation`   mass attenuation of a formula or mixture; contrast against photon energy
`energy`        where the contrast vanishes, the best energy for a jet
`absorption`    Eqs. (41)-(42): what a change of attenuation says
==============  ==========================================================================
"""

if __name__ != "spinline.xray":
    raise ImportError("import spinline.xray, not xray")

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from spinline.xray.absorption import contrast, fraction_change, linear_attenuation
    from spinline.xray.attenuation import (
        SOLVENT_FORMULAS,
        Material,
        attenuation_contrast,
        mass_attenuation,
        material,
    )
    from spinline.xray.energy import BestEnergy, best_energy, usable_contrast, zero_contrast_energies

_NAMES = {
    "BestEnergy": "energy",
    "Material": "attenuation",
    "SOLVENT_FORMULAS": "attenuation",
    "attenuation_contrast": "attenuation",
    "best_energy": "energy",
    "contrast": "absorption",
    "fraction_change": "absorption",
    "linear_attenuation": "absorption",
    "mass_attenuation": "attenuation",
    "material": "attenuation",
    "usable_contrast": "energy",
    "zero_contrast_energies": "energy",
}

__all__ = [
    "SOLVENT_FORMULAS",
    "BestEnergy",
    "Material",
    "attenuation_contrast",
    "best_energy",
    "contrast",
    "fraction_change",
    "linear_attenuation",
    "mass_attenuation",
    "material",
    "usable_contrast",
    "zero_contrast_energies",
]


def __getattr__(name: str) -> Any:
    if name in _NAMES:
        return getattr(import_module(f"spinline.xray.{_NAMES[name]}"), name)
    raise AttributeError(f"module 'spinline.xray' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
