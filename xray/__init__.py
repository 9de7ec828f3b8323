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
`track`         the jet in every row of a frame: edges to a part of a pixel, level of the beam
`frame`         a frame by likelihood, row by row or in blocks
`quick`         a frame by Eqs. (41)-(42), all rows at once
`edges`         edges of an opaque nozzle, for the size of a pixel
`row`           shells, radius, axis and beam from one row of counts, by likelihood
`start`         where the jet is in a noisy row
`scoring`       the largest Poisson likelihood
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
    from spinline.xray.edges import opaque_edges
    from spinline.xray.energy import BestEnergy, best_energy, usable_contrast, zero_contrast_energies
    from spinline.xray.forward import Absorber, Detector, RoundJet, expected_counts, noisy_counts
    from spinline.xray.frame import FRAME_FLAGS, Frame, FrameFit, fit_frame
    from spinline.xray.limit import Limit, error_limit, photons_needed, thin_centre_limit, thin_mean_limit
    from spinline.xray.quick import chord_frame
    from spinline.xray.row import RowFit, fit_row
    from spinline.xray.solution import solution_absorber
    from spinline.xray.track import Track, track_jet

_NAMES = {
    "Absorber": "forward",
    "BestEnergy": "energy",
    "ChordFractions": "chord",
    "Detector": "forward",
    "FRAME_FLAGS": "frame",
    "Frame": "frame",
    "FrameFit": "frame",
    "Limit": "limit",
    "Material": "attenuation",
    "RoundJet": "forward",
    "RowFit": "row",
    "SOLVENT_FORMULAS": "attenuation",
    "Track": "track",
    "attenuation_contrast": "attenuation",
    "best_energy": "energy",
    "chord_fractions": "chord",
    "chord_frame": "quick",
    "contrast": "absorption",
    "equal_shells": "chords",
    "error_limit": "limit",
    "expected_counts": "forward",
    "fit_frame": "frame",
    "fit_row": "row",
    "fraction_change": "absorption",
    "linear_attenuation": "absorption",
    "mass_attenuation": "attenuation",
    "material": "attenuation",
    "noisy_counts": "forward",
    "opaque_edges": "edges",
    "photons_needed": "limit",
    "shell_chords": "chords",
    "shell_weights": "chords",
    "solution_absorber": "solution",
    "thin_centre_limit": "limit",
    "thin_mean_limit": "limit",
    "track_jet": "track",
    "usable_contrast": "energy",
    "zero_contrast_energies": "energy",
}

__all__ = [
    "FRAME_FLAGS",
    "SOLVENT_FORMULAS",
    "Absorber",
    "BestEnergy",
    "ChordFractions",
    "Detector",
    "Frame",
    "FrameFit",
    "Limit",
    "Material",
    "RoundJet",
    "RowFit",
    "Track",
    "attenuation_contrast",
    "best_energy",
    "chord_fractions",
    "chord_frame",
    "contrast",
    "equal_shells",
    "error_limit",
    "expected_counts",
    "fit_frame",
    "fit_row",
    "fraction_change",
    "linear_attenuation",
    "mass_attenuation",
    "material",
    "noisy_counts",
    "opaque_edges",
    "photons_needed",
    "shell_chords",
    "shell_weights",
    "solution_absorber",
    "thin_centre_limit",
    "thin_mean_limit",
    "track_jet",
    "usable_contrast",
    "zero_contrast_energies",
]


def __getattr__(name: str) -> Any:
    if name in _NAMES:
        return getattr(import_module(f"spinline.xray.{_NAMES[name]}"), name)
    raise AttributeError(f"module 'spinline.xray' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
