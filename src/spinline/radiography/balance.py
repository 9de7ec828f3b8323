"""What the jet absorbs against what its solution would: a jet that dries holds no less polymer than the solution.

Whatever scales an attenuation (energy and its harmonics, the pixel, a dark, a response that is not straight, an elliptic
section) leaves no trace in a fit: it shifts the fraction. Where that falls under the solution's, or over 1, it shows.
"""

from typing import Any

import numpy as np

from spinline.radiography.experiment import Experiment

__all__ = ["unbalanced"]

_SURELY, _NEAR = 5.0, 0.04
_MISTAKES = {
    1.0 / np.log(10.0): "of an absorbance to base 10: give ln(I0/I), 2.303 times that",
    0.5: "if pixel_size were twice the true one",
    2.0: "if pixel_size were half of the true one (frames binned 2 x 2?)",
    0.25: "if pixel_size were four times the true one",
    4.0: "if pixel_size were a quarter of the true one (frames binned 4 x 4?)",
}


def unbalanced(experiment: Experiment, fraction: Any, std: Any, common: Any) -> tuple[str, ...]:
    """Words where the mean of all blocks is surely under the solution's fraction, or over 1.

    Parameters
    ----------
    experiment : Experiment
    fraction, std, common : ndarray
        Mean fractions of blocks, their standard deviations, and the part of these that all share.
    """
    own = np.sqrt(np.maximum(std**2 - common**2, 0.0))
    known = np.isfinite(fraction) & (own > 0.0)
    if not known.any():
        return ()
    weight = own[known] ** -2.0
    mean = float((weight * fraction[known]).sum() / weight.sum())
    error = float(np.hypot(weight.sum() ** -0.5, np.median(common[known])))
    a, solution = experiment.absorber, experiment.solution.volume_fraction
    lacks, over = solution - mean, mean - 1.0
    if max(lacks, over) < _SURELY * error:
        return ()
    share = (a.solvent - a.air + mean * a.contrast) / (a.solvent - a.air + solution * a.contrast)
    known_as = next((words for k, words in _MISTAKES.items() if abs(share / k - 1.0) < _NEAR), "")
    words = (
        f"less polymer than its solution ({mean:.3g} +/- {error:.1g} for {solution:.3g})"
        if lacks > 0.0
        else "no solvent"
    )
    return (
        f"the jet absorbs {share:.3g} times what its solution would"
        + (f", as {known_as}" if known_as else "")
        + f": it would hold {words}. A jet dries, so something scales the attenuation: energy or its harmonics, pixel_size, "
        "temperature, dark, linearity, an elliptic section; calibration_rows takes it out",
    )
