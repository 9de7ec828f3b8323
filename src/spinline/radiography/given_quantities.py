"""What the uncertainty of the given quantities is worth in the fraction, where no calibration takes it up.

A relative error e of the attenuation, or of the chord it is divided by, shifts the fraction by

    d phi = e mu / D,    mu = mu_s - mu_air + phi D

which is ten times e for PEO in water at 10 keV and more. The pixel's size scales every chord; energy, mass attenuation and
density scale mu. Quantities written ``"2 +/- 0.02 um"`` carry their error here, and a pixel measured on the nozzle carries its
own. All blocks share the shift. Calibrated on the known fraction at the nozzle, these errors cancel to first order.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from spinline.scene.images_file import KEV, Images
from spinline.xray.matter.medium import Medium, solution_medium
from spinline.xray.row.forward import Absorber

if TYPE_CHECKING:
    from spinline.rheology.solution import Solution

__all__ = ["doubt_words", "hardened", "ideal_mixture", "relative_doubts"]

_WORTH_SAYING = 0.1  # of the fraction


def relative_doubts(
    images: Images, solution: "Solution", absorber: Absorber, pixel: float, pixel_std: float
) -> dict[str, float]:
    """Relative standard deviation of the attenuation by key of the images file; keys without an error are left out.

    Parameters
    ----------
    images : Images
    solution : Solution
    absorber : Absorber
        Of the solution, 1/m.
    pixel, pixel_std : float
        m.

    Returns
    -------
    dict of str to float
        Independent of each other, each >= 0; first order in the errors given.
    """
    phi = solution.volume_fraction
    mu = abs(absorber.solvent - absorber.air + phi * absorber.contrast)
    light, heavy = (1.0 - phi) * absorber.solvent / mu, phi * (absorber.solvent + absorber.contrast) / mu
    parts = {"pixel_size" if images.pixel_size is not None else "nozzle_diameter": pixel_std / pixel}
    for key, given, share in (
        ("polymer_attenuation", images.polymer_attenuation, heavy),
        ("solvent_attenuation", images.solvent_attenuation, light),
        ("solution.polymer_density", images.solution.polymer_density, heavy),
        ("solution.solvent_density", images.solution.solvent_density, light),
    ):
        if given is not None:
            parts[key] = share * given.std / given.value
    energy = images.energy
    if energy is not None and energy.std > 0 and images.polymer_attenuation is None:
        ends = [_attenuation(images, solution, (energy.value + sign * energy.std) / KEV) for sign in (-1.0, 1.0)]
        parts["energy"] = 0.5 * abs(ends[1] - ends[0]) / mu
    return {key: value for key, value in parts.items() if value > 0.0}


def _attenuation(images: Images, solution: "Solution", energy_kev: float) -> float:
    """Attenuation of the solution less that of air at an energy, 1/m."""
    from spinline.xray.matter.attenuation import Material

    p = solution.polymer
    medium = solution_medium(
        Material(p.repeat_unit or p.name, p.density),
        Material(solution.solvent, solution.solvent_density),
        energy_kev,
        coherent=images.coherent,
        temperature=solution.temperature,
    )
    a = medium.absorber
    return a.solvent - a.air + solution.volume_fraction * a.contrast


def doubt_words(parts: dict[str, float], absorber: Absorber, fraction: float) -> tuple[str, bool]:
    """The shift of the fraction by each key, in words, and whether it is worth a warning.

    Parameters
    ----------
    parts : dict
        From `relative_doubts`.
    absorber : Absorber
    fraction : float
        Of the solution, > 0.
    """
    worth = abs((absorber.solvent - absorber.air + fraction * absorber.contrast) / absorber.contrast)
    said = ", ".join(f"{key} {worth * value:.2g}" for key, value in parts.items())
    total = worth * math.hypot(*parts.values())
    return f"standard deviation of the fraction that all blocks share: {said}", total > _WORTH_SAYING * fraction


def hardened(method: str, medium: Medium, fraction: float, radius: float) -> str:
    """What the mean attenuation of a spectrum is worth, which chords and the map take: to first order in a jet's mean chord."""
    chord = 0.5 * np.pi * radius
    mu = medium.solvent - medium.air + fraction * medium.contrast
    through = -np.log(medium.weight @ np.exp(-mu * chord)) / chord
    shift = float((through - medium.weight @ mu) / (medium.weight @ medium.contrast))
    return (
        f"method {method!r} takes the mean attenuation of the spectrum: the fraction is off by about {shift:+.2g}; "
        'method "row" holds every line'
    )


def ideal_mixture(images: Images, solution: "Solution", absorber: Absorber) -> list[str]:
    """What the volume of mixing of a solvent is worth, which its density leaves out."""
    if (
        len(solution.solvent) < 2
        or images.solution.solvent_density is not None
        or images.solvent_attenuation is not None
    ):
        return []
    share = 0.01 * (1.0 - solution.volume_fraction) * absorber.solvent / abs(absorber.contrast)
    return [
        f"the solvent's density, {solution.solvent_density:.4g} kg/m3, is that of an ideal mixture: 1 % of it is {share:.2g} "
        "in the fraction (half ethanol, half water is 3.6 % denser); give solution.solvent_density, or calibration_rows"
    ]
