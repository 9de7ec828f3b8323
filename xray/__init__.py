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

from spinline.lazy import lazily

if TYPE_CHECKING:
    from spinline.xray.absorption import contrast, fraction_change, linear_attenuation
    from spinline.xray.attenuation import SOLVENT_FORMULAS, Material, attenuation_contrast, mass_attenuation, material
    from spinline.xray.chord import ChordFractions, chord_fractions
    from spinline.xray.chords import equal_shells, shell_chords, shell_weights
    from spinline.xray.edges import opaque_edges
    from spinline.xray.energy import BestEnergy, best_energy, usable_contrast, zero_contrast_energies
    from spinline.xray.forward import Absorber, Detector, RoundJet, expected_counts, noisy_counts
    from spinline.xray.frame import FRAME_FLAGS, Frame, FrameFit, fit_frame
    from spinline.xray.fresnel import edge_fringe_width, fresnel_counts
    from spinline.xray.fringe_frame import frame_fringes
    from spinline.xray.fringes import FringeTest, detect_fringes
    from spinline.xray.image import JetField, core_and_sheath, expected_image, transmission_image
    from spinline.xray.limit import Limit, error_limit, photons_needed, thin_centre_limit, thin_mean_limit
    from spinline.xray.map_fit import fit_map
    from spinline.xray.map_result import MapDraws, MapFit
    from spinline.xray.medium import Medium, solution_medium
    from spinline.xray.outcome import RowFit
    from spinline.xray.phase_fit import fit_row_phase, phase_error_limit, phase_law
    from spinline.xray.phase_frame import fit_frame_phase
    from spinline.xray.phase_retrieval import contact_transmission
    from spinline.xray.quick import chord_frame
    from spinline.xray.refraction import delta_over_mu, refraction_decrement, wavelength
    from spinline.xray.row import fit_row
    from spinline.xray.several_jets import Section, SectionsFit, fit_sections, section_chord
    from spinline.xray.solution import solution_absorber
    from spinline.xray.spectral import fit_row_spectrum, spectral_counts, spectral_law
    from spinline.xray.spectrum import Spectrum, gaussian_spectrum, harmonic_spectrum, scintillator_response
    from spinline.xray.track import Track, track_jet

_NAMES = {
    "Absorber": "forward",
    "BestEnergy": "energy",
    "ChordFractions": "chord",
    "Detector": "forward",
    "FRAME_FLAGS": "frame",
    "Frame": "frame",
    "FrameFit": "frame",
    "FringeTest": "fringes",
    "JetField": "image",
    "Limit": "limit",
    "MapDraws": "map_result",
    "MapFit": "map_result",
    "Material": "attenuation",
    "Medium": "medium",
    "RoundJet": "forward",
    "RowFit": "outcome",
    "SOLVENT_FORMULAS": "attenuation",
    "Section": "several_jets",
    "SectionsFit": "several_jets",
    "Spectrum": "spectrum",
    "Track": "track",
    "attenuation_contrast": "attenuation",
    "best_energy": "energy",
    "chord_fractions": "chord",
    "chord_frame": "quick",
    "contact_transmission": "phase_retrieval",
    "contrast": "absorption",
    "core_and_sheath": "image",
    "delta_over_mu": "refraction",
    "detect_fringes": "fringes",
    "edge_fringe_width": "fresnel",
    "equal_shells": "chords",
    "error_limit": "limit",
    "expected_counts": "forward",
    "fit_map": "map_fit",
    "expected_image": "image",
    "fit_frame": "frame",
    "fit_frame_phase": "phase_frame",
    "fit_row": "row",
    "fit_row_phase": "phase_fit",
    "fit_row_spectrum": "spectral",
    "fit_sections": "several_jets",
    "fraction_change": "absorption",
    "frame_fringes": "fringe_frame",
    "fresnel_counts": "fresnel",
    "gaussian_spectrum": "spectrum",
    "harmonic_spectrum": "spectrum",
    "linear_attenuation": "absorption",
    "mass_attenuation": "attenuation",
    "material": "attenuation",
    "noisy_counts": "forward",
    "opaque_edges": "edges",
    "phase_error_limit": "phase_fit",
    "phase_law": "phase_fit",
    "photons_needed": "limit",
    "refraction_decrement": "refraction",
    "scintillator_response": "spectrum",
    "section_chord": "several_jets",
    "shell_chords": "chords",
    "shell_weights": "chords",
    "solution_absorber": "solution",
    "solution_medium": "medium",
    "spectral_counts": "spectral",
    "spectral_law": "spectral",
    "thin_centre_limit": "limit",
    "thin_mean_limit": "limit",
    "track_jet": "track",
    "transmission_image": "image",
    "usable_contrast": "energy",
    "wavelength": "refraction",
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
    "FringeTest",
    "JetField",
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
