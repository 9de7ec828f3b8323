"""What the beam sees: absorption of a polymer solution, its image, and what can be read back from it.

=================  ==========================================================================
module             law
=================  ==========================================================================
`attenuation`      mass attenuation of a formula or mixture; contrast against photon energy
`energy`           where the contrast vanishes, the best energy for a jet
`solution`         names and an energy to the attenuation of solution and air
`chords`           paths through the shells of a round jet, averaged over pixels
`forward`          what a detector row counts behind a round jet
`model`            the same with its derivatives
`limit`            what the photons allow: Cramer-Rao bound, photons needed
`track`            the jet in every row of a frame: edges to a part of a pixel, level of the beam
`lean`             how far a jet leans in the image: chord and radius by its cosine
`tail`             glare: the far tail of a detector's point spread
`shared`           what all rows share: blur, glare and attenuation, from many blocks together
`frame`            a frame by likelihood, row by row or in blocks
`quick`            a frame by Eqs. (41)-(42), all rows at once
`edges`            edges of an opaque nozzle, for the size of a pixel
`outcome`          what a fit says of a row: errors, bound, goodness, warnings
`row`              shells, radius, axis and beam from one row of counts, by likelihood
`map_fit`          phi(r, z), radius, axis and beam of all rows at once; its parts are `map_*`
`start`            where the jet is in a noisy row
`scoring`          the largest Poisson likelihood
`absorption`       Eqs. (41)-(42): what a change of attenuation says
`chord`            the same on every chord of a row: the quick look, and its price
`refraction`       decrement of the refractive index
`spectrum`         lines, harmonics, broad spectra, what the detector makes of them
`medium`           attenuation and refraction of a solution at every line
`spectral`         a row's fit for a beam of many energies
`fresnel`          what a row counts at a distance: fringes
`profiles`         what a wave model takes the jet to be made of: shells, or a continuous profile
`fringes`          whether there are any
`fringe_frame`     the same of a frame
`phase_start`      where the jet is, by its fringes
`phase_fit`        a row's fit with fringes, and its bound
`phase_frame`      a frame's, the taper within blocks modelled
`phase_retrieval`  fringes folded back (Paganin)
`image`            a whole jet, tilted, blurred, moving
`several_jets`     several jets in one scan, from many sides
=================  ==========================================================================
"""

if __name__ != "spinline.xray":
    raise ImportError("import spinline.xray, not xray")

from typing import TYPE_CHECKING

from spinline.base.lazy import lazily

if TYPE_CHECKING:
    from spinline.xray.frame.blocks import FRAME_FLAGS, Frame, FrameFit, fit_frame
    from spinline.xray.frame.image import JetField, core_and_sheath, expected_image, transmission_image
    from spinline.xray.frame.lean import Lean, axis_lean
    from spinline.xray.frame.quick import chord_frame
    from spinline.xray.frame.several_jets import Section, SectionsFit, fit_sections, section_chord
    from spinline.xray.frame.shared import Block, DetectorFit, fit_detector, hidden_traces
    from spinline.xray.frame.track import Track, track_jet
    from spinline.xray.map.fit import fit_map
    from spinline.xray.map.result import MapDraws, MapFit
    from spinline.xray.matter.absorption import contrast, fraction_change, linear_attenuation
    from spinline.xray.matter.attenuation import (
        SOLVENT_FORMULAS,
        Material,
        attenuation_contrast,
        mass_attenuation,
        material,
    )
    from spinline.xray.matter.energy import BestEnergy, best_energy, usable_contrast, zero_contrast_energies
    from spinline.xray.matter.medium import Medium, solution_medium
    from spinline.xray.matter.refraction import delta_over_mu, refraction_decrement, wavelength
    from spinline.xray.matter.solution import solution_absorber
    from spinline.xray.matter.spectrum import Spectrum, gaussian_spectrum, harmonic_spectrum, scintillator_response
    from spinline.xray.phase.fit import fit_row_phase, phase_error_limit, phase_law
    from spinline.xray.phase.frame import fit_frame_phase
    from spinline.xray.phase.fresnel import edge_fringe_width, fresnel_counts
    from spinline.xray.phase.fringe_frame import frame_fringes
    from spinline.xray.phase.fringes import FringeTest, detect_fringes
    from spinline.xray.phase.retrieval import contact_transmission
    from spinline.xray.row.chord import ChordFractions, chord_fractions
    from spinline.xray.row.chords import equal_shells, shell_chords, shell_weights
    from spinline.xray.row.edges import opaque_edges
    from spinline.xray.row.fit import fit_row
    from spinline.xray.row.forward import Absorber, Detector, RoundJet, expected_counts, noisy_counts
    from spinline.xray.row.limit import Limit, error_limit, photons_needed, thin_centre_limit, thin_mean_limit
    from spinline.xray.row.outcome import RowFit
    from spinline.xray.row.spectral import fit_row_spectrum, spectral_counts, spectral_law

_NAMES = {
    "Absorber": "row.forward",
    "BestEnergy": "matter.energy",
    "ChordFractions": "row.chord",
    "Detector": "row.forward",
    "FRAME_FLAGS": "frame.blocks",
    "Frame": "frame.blocks",
    "FrameFit": "frame.blocks",
    "FringeTest": "phase.fringes",
    "JetField": "frame.image",
    "Limit": "row.limit",
    "MapDraws": "map.result",
    "MapFit": "map.result",
    "Material": "matter.attenuation",
    "Medium": "matter.medium",
    "RoundJet": "row.forward",
    "RowFit": "row.outcome",
    "SOLVENT_FORMULAS": "matter.attenuation",
    "Section": "frame.several_jets",
    "SectionsFit": "frame.several_jets",
    "Spectrum": "matter.spectrum",
    "Track": "frame.track",
    "attenuation_contrast": "matter.attenuation",
    "best_energy": "matter.energy",
    "chord_fractions": "row.chord",
    "chord_frame": "frame.quick",
    "contact_transmission": "phase.retrieval",
    "contrast": "matter.absorption",
    "core_and_sheath": "frame.image",
    "delta_over_mu": "matter.refraction",
    "detect_fringes": "phase.fringes",
    "edge_fringe_width": "phase.fresnel",
    "equal_shells": "row.chords",
    "error_limit": "row.limit",
    "expected_counts": "row.forward",
    "fit_map": "map.fit",
    "expected_image": "frame.image",
    "fit_frame": "frame.blocks",
    "fit_frame_phase": "phase.frame",
    "fit_row": "row.fit",
    "fit_row_phase": "phase.fit",
    "fit_row_spectrum": "row.spectral",
    "fit_sections": "frame.several_jets",
    "fraction_change": "matter.absorption",
    "frame_fringes": "phase.fringe_frame",
    "fresnel_counts": "phase.fresnel",
    "gaussian_spectrum": "matter.spectrum",
    "harmonic_spectrum": "matter.spectrum",
    "linear_attenuation": "matter.absorption",
    "mass_attenuation": "matter.attenuation",
    "material": "matter.attenuation",
    "noisy_counts": "row.forward",
    "opaque_edges": "row.edges",
    "phase_error_limit": "phase.fit",
    "phase_law": "phase.fit",
    "photons_needed": "row.limit",
    "refraction_decrement": "matter.refraction",
    "scintillator_response": "matter.spectrum",
    "section_chord": "frame.several_jets",
    "shell_chords": "row.chords",
    "shell_weights": "row.chords",
    "solution_absorber": "matter.solution",
    "solution_medium": "matter.medium",
    "spectral_counts": "row.spectral",
    "spectral_law": "row.spectral",
    "thin_centre_limit": "row.limit",
    "thin_mean_limit": "row.limit",
    "track_jet": "frame.track",
    "transmission_image": "frame.image",
    "usable_contrast": "matter.energy",
    "wavelength": "matter.refraction",
    "zero_contrast_energies": "matter.energy",
    "Block": "frame.shared",
    "DetectorFit": "frame.shared",
    "fit_detector": "frame.shared",
    "hidden_traces": "frame.shared",
    "Lean": "frame.lean",
    "axis_lean": "frame.lean",
}

__all__ = [
    "FRAME_FLAGS",
    "SOLVENT_FORMULAS",
    "Absorber",
    "BestEnergy",
    "Block",
    "ChordFractions",
    "Detector",
    "DetectorFit",
    "Frame",
    "FrameFit",
    "FringeTest",
    "JetField",
    "Lean",
    "Limit",
    "MapDraws",
    "MapFit",
    "Material",
    "Medium",
    "RoundJet",
    "RowFit",
    "Section",
    "SectionsFit",
    "Spectrum",
    "Track",
    "attenuation_contrast",
    "axis_lean",
    "best_energy",
    "chord_fractions",
    "chord_frame",
    "contact_transmission",
    "contrast",
    "core_and_sheath",
    "delta_over_mu",
    "detect_fringes",
    "edge_fringe_width",
    "equal_shells",
    "error_limit",
    "expected_counts",
    "expected_image",
    "fit_detector",
    "fit_frame",
    "fit_frame_phase",
    "fit_map",
    "fit_row",
    "fit_row_phase",
    "fit_row_spectrum",
    "fit_sections",
    "fraction_change",
    "frame_fringes",
    "fresnel_counts",
    "gaussian_spectrum",
    "harmonic_spectrum",
    "hidden_traces",
    "linear_attenuation",
    "mass_attenuation",
    "material",
    "noisy_counts",
    "opaque_edges",
    "phase_error_limit",
    "phase_law",
    "photons_needed",
    "refraction_decrement",
    "scintillator_response",
    "section_chord",
    "shell_chords",
    "shell_weights",
    "solution_absorber",
    "solution_medium",
    "spectral_counts",
    "spectral_law",
    "thin_centre_limit",
    "thin_mean_limit",
    "track_jet",
    "transmission_image",
    "usable_contrast",
    "wavelength",
    "zero_contrast_energies",
]

__getattr__, __dir__ = lazily(__name__, _NAMES)
