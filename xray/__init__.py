"""What the beam sees: absorption of a polymer solution, its image, and what can be read back from it.

==============  ==========================================================================
module          law
==============  ==========================================================================
`attenuation`   mass attenuation of a formula or mixture; contrast against photon energy
`energy`        where the contrast vanishes, the best energy for a jet
`solution`      names and an energy to the attenuation of solution and air
`chords`        paths through the shells of a round jet, averaged over pixels
`forward`       what a detector row counts behind a round jet
`model`         the same with its derivatives
`limit`         what the photons allow: Cramer-Rao bound, photons needed
`row`           shells, radius, axis and beam from one row of counts, by likelihood
`start`         where the jet is in a noisy row
`scoring`       the largest Poisson likelihood
`map_fit`       phi(r, z), radius, axis and beam of all rows at once; its parts are `map_*`
`absorption`    Eqs. (41)-(42): what a change of attenuation says
`chord`         the same on every chord of a row: the quick look, and its price
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
    from spinline.xray.chord import ChordFractions, chord_fractions
    from spinline.xray.chords import equal_shells, shell_chords, shell_weights
    from spinline.xray.energy import BestEnergy, best_energy, usable_contrast, zero_contrast_energies
    from spinline.xray.forward import Absorber, Detector, RoundJet, expected_counts, noisy_counts
    from spinline.xray.limit import Limit, error_limit, photons_needed, thin_centre_limit, thin_mean_limit
    from spinline.xray.map_fit import fit_map
    from spinline.xray.map_result import MapDraws, MapFit
    from spinline.xray.row import RowFit, fit_row
    from spinline.xray.solution import solution_absorber

_NAMES = {
    "Absorber": "forward",
    "BestEnergy": "energy",
    "ChordFractions": "chord",
    "Detector": "forward",
    "Limit": "limit",
    "MapDraws": "map_result",
    "MapFit": "map_result",
    "Material": "attenuation",
    "RoundJet": "forward",
    "RowFit": "row",
    "SOLVENT_FORMULAS": "attenuation",
    "attenuation_contrast": "attenuation",
    "best_energy": "energy",
    "chord_fractions": "chord",
    "contrast": "absorption",
    "equal_shells": "chords",
    "error_limit": "limit",
    "expected_counts": "forward",
    "fit_map": "map_fit",
    "fit_row": "row",
    "fraction_change": "absorption",
    "linear_attenuation": "absorption",
    "mass_attenuation": "attenuation",
    "material": "attenuation",
    "noisy_counts": "forward",
    "photons_needed": "limit",
    "shell_chords": "chords",
    "shell_weights": "chords",
    "solution_absorber": "solution",
    "thin_centre_limit": "limit",
    "thin_mean_limit": "limit",
    "usable_contrast": "energy",
    "zero_contrast_energies": "energy",
}

__all__ = [
    "SOLVENT_FORMULAS",
    "Absorber",
    "BestEnergy",
    "ChordFractions",
    "Detector",
    "Limit",
    "MapDraws",
    "MapFit",
    "Material",
    "RoundJet",
    "RowFit",
    "attenuation_contrast",
    "best_energy",
    "chord_fractions",
    "contrast",
    "equal_shells",
    "error_limit",
    "expected_counts",
    "fit_map",
    "fit_row",
    "fraction_change",
    "linear_attenuation",
    "mass_attenuation",
    "material",
    "noisy_counts",
    "photons_needed",
    "shell_chords",
    "shell_weights",
    "solution_absorber",
    "thin_centre_limit",
    "thin_mean_limit",
    "usable_contrast",
    "zero_contrast_energies",
]


def __getattr__(name: str) -> Any:
    if name in _NAMES:
        return getattr(import_module(f"spinline.xray.{_NAMES[name]}"), name)
    raise AttributeError(f"module 'spinline.xray' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
