"""The attenuation from the rows at the nozzle, where the polymer fraction is known."""

import dataclasses
from dataclasses import replace

import numpy as np

from spinline.base.errors import InputError
from spinline.radiography.calibration import Calibration, scaled_medium
from spinline.radiography.experiment import Experiment, fit_blocks
from spinline.radiography.looks import part_of
from spinline.xray.frame.blocks import Frame
from spinline.xray.frame.track import Track

__all__ = ["calibrated"]

_SCATTER = 1.5  # of the calibration rows, over their errors, that is said


_FAR_OFF = 0.2  # from the tables, that is said


def calibrated(experiment: Experiment, frame: Frame, track: Track) -> Experiment:
    """The experiment with its attenuation scaled to the known fraction in the calibration rows.

    Notes
    -----
    ``scale = (mu_s - mu_air + phi D)/(mu_s - mu_air + phi_0 D)`` with phi the fraction that a uniform jet has there; it
    multiplies solvent, contrast and air alike, as an error of energy or of coefficient nearly does, or a tilt. Where the
    detector was fitted with it (`detector`), the scale is the one found there, its error among those that are shared.
    """
    first, last = experiment.images.calibration_rows or (0, 0)
    given = _fraction_std(experiment)
    a, phi = experiment.absorber, experiment.solution.volume_fraction
    nominal = a.solvent - a.air + phi * a.contrast
    remarks = list(experiment.remarks)
    detector = experiment.detector
    own = abs(a.contrast) * given / nominal
    if np.isfinite(detector.attenuation):
        scale, std, rest = detector.attenuation, detector.attenuation_std, own
    else:
        found, error, scatter = _in_rows(experiment, frame, track, first, last)
        scale = (a.solvent - a.air + found * a.contrast) / nominal
        std, rest = abs(a.contrast) * error / nominal, float(np.hypot(abs(a.contrast) * error / nominal, own))
        if scatter > _SCATTER:
            remarks.append(
                f"the calibration rows scatter {scatter:.2g} times more than their errors: are they all at the nozzle's "
                "fraction?"
            )
    whole = float(np.hypot(std, own))
    if not scale > 0 or whole > 0.1:
        raise InputError(
            "calibration_rows",
            f"do not tell the attenuation: {scale:.3g} +/- {whole:.2g} of the tables'",
            value=[first, last],
            allowed="known to 10 %",
            remedy="take more rows",
        )
    if abs(scale - 1.0) > _FAR_OFF:
        remarks.append(f"the calibration scales the attenuation by {scale:.3g}: check energy, pixel_size and solution")
    words = f"{scale:.4f} +/- {whole:.4f} of that assumed, from rows {first} to {last} at a fraction of {phi:.4f}"
    return replace(
        experiment,
        absorber=a.along(scale),
        medium=scaled_medium(experiment.medium, scale),
        calibration=Calibration(scale, rest),
        notes={**experiment.notes, "calibration": words},
        remarks=tuple(remarks),
    )


def _in_rows(experiment: Experiment, frame: Frame, track: Track, first: int, last: int) -> tuple[float, float, float]:
    """Fraction of a uniform jet in the calibration rows, its error, and their scatter over their errors."""
    rows = slice(first, last)
    part = part_of(frame, first, last)
    here = Track(*(getattr(track, item.name)[rows] for item in dataclasses.fields(Track)))
    height = min(experiment.images.block_rows, last - first)
    fit = fit_blocks(experiment, part, here, shells=1, block_rows=height, lean=experiment.lean.slope[rows])
    known = np.isfinite(fit.mean)
    weight = fit.mean_std[known] ** -2.0
    found, std = float((weight * fit.mean[known]).sum() / weight.sum()), float(weight.sum() ** -0.5)
    scatter = (
        float(np.sqrt(np.mean(((fit.mean[known] - found) / fit.mean_std[known]) ** 2))) if known.sum() > 2 else 1.0
    )
    return found, std, scatter


def _fraction_std(experiment: Experiment) -> float:
    """Standard deviation of the solution's volume fraction, where its mass or volume fraction has one."""
    s = experiment.images.solution
    if s.volume_fraction is not None:
        return s.volume_fraction.std
    if s.mass_fraction is None or s.mass_fraction.std == 0:
        return 0.0
    rho_p, rho_s, w = experiment.solution.polymer.density, experiment.solution.solvent_density, s.mass_fraction.value
    return s.mass_fraction.std * rho_p * rho_s / (w * rho_s + (1 - w) * rho_p) ** 2
