"""Images with Fresnel fringes: found where nobody expects them, and reduced with them where asked for.

Before any reduction by absorption, sums of rows from five places along the jet are tested for fringes (`xray.detect_fringes`),
and what is found is said. ``method = "phase"`` fits each block with the wave's likelihood (`xray.fit_row_phase`), the distance
included; the jet is tracked in the frame with its fringes folded back.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from spinline.errors import InputError
from spinline.images import KEV, Images
from spinline.units import parse
from spinline.xray.attenuation import Material
from spinline.xray.forward import Absorber
from spinline.xray.frame import Frame, FrameFit, fit_frame, require_track
from spinline.xray.fringes import detect_fringes
from spinline.xray.medium import Medium, solution_medium
from spinline.xray.phase_fit import phase_law
from spinline.xray.phase_retrieval import contact_transmission
from spinline.xray.spectrum import Spectrum
from spinline.xray.track import Track

if TYPE_CHECKING:
    from spinline.rheology.solution import Solution

__all__ = ["build_medium", "folded", "fringe_remarks", "phase_frame"]

_PLACES = 5
_ROWS = 20  # of a sum that is tested


def build_medium(images: Images, solution: "Solution") -> Medium:
    """Attenuation and refraction of the solution at the beam's energy or lines.

    Raises
    ------
    InputError
        Where neither is given, or a component has no chemical formula.
    """
    if images.energy is not None:
        beam: float | Spectrum = images.energy.value / KEV
    elif isinstance(images.spectrum, dict):
        shares = {parse(line, "energy", "spectrum").value / KEV: share for line, share in images.spectrum.items()}
        energies = sorted(shares)
        beam = Spectrum(np.array(energies), np.array([shares[energy] for energy in energies]))
    else:
        raise InputError("energy", "is missing: refraction needs it", remedy='write energy = "10 keV"')
    polymer = solution.polymer
    heavy = Material(polymer.repeat_unit or polymer.name, polymer.density)
    light = Material(solution.solvent, solution.solvent_density)
    return solution_medium(heavy, light, beam, coherent=images.coherent, temperature=solution.temperature)


def folded(images: Images, solution: "Solution", frame: Frame) -> Frame:
    """The frame as absorption alone would show it: for finding the jet, not for its fraction."""
    distance = _distance(images)
    ratio = np.ones(frame.counts.shape)
    lit = frame.good & (frame.flat > 0)
    ratio[lit] = (frame.counts[lit] - frame.dark[lit]) / frame.flat[lit]
    columns = np.arange(ratio.shape[1])
    for row, good in zip(ratio, lit, strict=True):
        if good.any() and not good.all():
            row[~good] = np.interp(columns[~good], columns[good], row[good])
    ratio_of = build_medium(images, solution).delta_over_mu(solution.volume_fraction)
    seen = contact_transmission(ratio, frame.pixel, distance, ratio_of)
    return replace(frame, counts=np.maximum(seen, 0.0) * frame.flat + frame.dark)


def fringe_remarks(images: Images, solution: "Solution", frame: Frame, track: Track | None) -> list[str]:
    """What is to be said of fringes in a frame that is to be reduced as absorption."""
    if images.energy is None:
        return []
    try:
        medium = build_medium(images, solution)
    except InputError:
        return []  # no formula, so nothing is known of refraction
    rows = frame.counts.shape[0]
    high = min(_ROWS, rows)
    found = []
    for start in np.unique(np.linspace(0, rows - high, _PLACES).astype(int)).tolist():
        stop = start + high
        if track is not None:  # a sum within which the edges stay put
            smear = np.ptp(track.radius[start:stop]) + np.ptp(track.axis[start:stop])
            stop = start + max(1, min(high, int(high / max(smear, 1.0))))
        counts, detector, good = frame.block(start, stop)
        try:
            found.append(detect_fringes(counts, medium, detector, good=good))
        except InputError:
            continue
    hits = [test for test in found if test.detected]
    if not hits:
        return []
    strongest = max(hits, key=lambda test: test.significance)
    return [f"{strongest.message} (seen in {len(hits)} of {len(found)} places along the jet)"]


def phase_frame(
    images: Images,
    solution: "Solution",
    absorber: Absorber,
    frame: Frame,
    nuisances: Sequence[str],
    track: Track | None,
    done: Callable[[int], None] | None,
) -> FrameFit:
    """A frame with fringes by the wave's likelihood, block by block; the distance is fitted with the rest."""
    medium = build_medium(images, solution)
    path = require_track(folded(images, solution, frame)) if track is None else track
    fit = fit_frame(
        frame, absorber, shells=images.shells, block_rows=images.block_rows, nuisances=nuisances, track=path,
        one=phase_law(medium, _distance(images)), done=done,
    )  # fmt: skip
    return replace(fit, method="phase")


def _distance(images: Images) -> float:
    if images.propagation_distance is None or images.propagation_distance.value == 0.0:
        raise InputError(
            "propagation_distance", "is missing: method = \"phase\" needs it",
            remedy='write propagation_distance = "10 cm"; it is fitted from there',
        )  # fmt: skip
    return images.propagation_distance.value
