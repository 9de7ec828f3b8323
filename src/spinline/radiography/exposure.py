"""How many photons, which energy, how many frames: an experiment planned before the beam is on.

For each jet radius: the energy of the smallest error, the photons per pixel that give the standard deviation asked for
(Fisher information, `spinline.xray.row.limit`), with the jet and the beam known and with radius, axis, level and slope fitted,
and what that is in frames. Photons are counted per pixel in all: rows that are summed, frames and exposure multiply.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spinline.base.checks import positive, real
from spinline.base.errors import InputError
from spinline.rheology.solution import Solution
from spinline.xray.matter.attenuation import Material
from spinline.xray.matter.energy import best_energy
from spinline.xray.matter.solution import solution_absorber
from spinline.xray.row.forward import RoundJet
from spinline.xray.row.limit import photons_needed

__all__ = ["Exposure", "plan_exposure", "table"]

_FITTED = ("radius", "axis", "amplitude", "slope")


@dataclass(frozen=True)
class Exposure:
    """What one jet radius asks for.

    Attributes
    ----------
    radius : float
        m.
    sigma : float
        Standard deviation asked for, of the mean polymer fraction of the section.
    energy_kev, contrast, transmission : float
        Photon energy, D in 1/m, and what the centre chord lets through.
    photons_known, photons : float
        Per pixel in all, jet and beam known; and with radius, axis, level and slope fitted too.
    exposures : float
        Rows times frames of the photons per frame that were given; NaN if none were.
    """

    radius: float
    sigma: float
    energy_kev: float
    contrast: float
    transmission: float
    photons_known: float
    photons: float
    exposures: float


def plan_exposure(
    solution: Solution,
    radii: Sequence[float],
    *,
    sigma: float = 0.01,
    pixel: float,
    energy_kev: float | None = None,
    lowest_kev: float = 3.0,
    highest_kev: float = 60.0,
    photons_per_frame: float | None = None,
    shells: int = 1,
    coherent: bool = True,
    blur: float = 0.0,
    tail: tuple[float, float] = (0.0, 0.0),
) -> list[Exposure]:
    """Photons, energy and frames for a standard deviation of the mean polymer fraction.

    Parameters
    ----------
    solution : Solution
        Polymer and solvent, with the fraction that is expected.
    radii : sequence of float
        Jet radii, m, > 0.
    sigma : float
        Standard deviation wanted, > 0.
    pixel : float
        Width of a pixel, m, > 0.
    energy_kev : float, optional
        keV; left out, the best one between `lowest_kev` and `highest_kev` for each radius.
    photons_per_frame : float, optional
        Per pixel, without a jet.
    shells : int
        Shells that are fitted; 1 for the mean alone.
    coherent : bool
        Total attenuation, or without coherent scatter.
    blur, tail : float, (float, float)
        Of the detector: standard deviation, and share and length of its far tail, m; taken as known.

    Returns
    -------
    list of Exposure

    Raises
    ------
    InputError
        For values out of range, or energies at which polymer and solvent absorb alike.
    """
    wanted, p = positive("sigma", sigma), positive("pixel", pixel, "m")
    if wanted >= 1:
        remedy = f"a share: {wanted / 100:g} for {wanted:g} %"
        raise InputError("sigma", "is out of range", value=sigma, allowed="(0, 1)", remedy=remedy)
    if isinstance(shells, bool) or not isinstance(shells, int) or shells < 1:
        raise InputError("shells", "is not a whole number", value=shells, allowed="at least 1")
    each = None if photons_per_frame is None else positive("photons", photons_per_frame)
    heavy = Material(solution.polymer.repeat_unit or solution.polymer.name, solution.polymer.density)
    light = Material(solution.solvent, solution.solvent_density)
    phi = solution.volume_fraction
    plans = []
    for radius in real("radius", np.atleast_1d(np.asarray(radii, dtype=np.float64)), above=0.0, unit="m").tolist():
        if radius < 3.0 * p:
            raise InputError("radius", "is under 3 pixels", value=radius, remedy="take a smaller pixel")
        energy = energy_kev
        if energy is None:
            energy = best_energy(
                heavy,
                light,
                radius,
                1.0,
                pixel=p,
                polymer_fraction=phi,
                low_kev=lowest_kev,
                high_kev=highest_kev,
                coherent=coherent,
            ).energy_kev
        absorber = solution_absorber(heavy, light, energy, coherent=coherent, temperature=solution.temperature)
        jet = RoundJet(np.full(shells, phi), radius)
        known = photons_needed(wanted, jet, absorber, p, blur=blur, tail=tail)
        fitted = photons_needed(wanted, jet, absorber, p, nuisances=_FITTED, blur=blur, tail=tail)
        mu = absorber.solvent - absorber.air + phi * absorber.contrast
        plans.append(
            Exposure(
                radius,
                wanted,
                float(energy),
                absorber.contrast,
                float(np.exp(-2.0 * radius * mu)),
                known,
                fitted,
                float("nan") if each is None else float(np.ceil(fitted / each)),
            )
        )
    return plans


def table(plans: Sequence[Exposure]) -> list[str]:
    """The plans as lines of text."""
    framed = any(plan.exposures == plan.exposures for plan in plans)
    heads = f"{'radius':>9} {'energy':>9} {'D':>11} {'through':>8} {'photons, known':>15} {'photons, fitted':>16}"
    out = [heads + (f" {'rows x frames':>14}" if framed else "")]
    for plan in plans:
        line = (
            f"{1e6 * plan.radius:6.4g} um {plan.energy_kev:5.4g} keV {plan.contrast:7.4g} /m {plan.transmission:8.3f} "
            f"{plan.photons_known:15.3g} {plan.photons:16.3g}"
        )
        out.append(line + (f" {plan.exposures:14.4g}" if framed else ""))
    return out


def as_rows(plans: Sequence[Exposure]) -> list[dict[str, Any]]:
    """The plans as dictionaries, NaN as None."""
    return [{k: None if v != v else v for k, v in asdict(plan).items()} for plan in plans]
