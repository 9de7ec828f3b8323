"""What a tilt along the beam and an elliptic section do to every path through the jet, and how well that is known.

A jet that leans by t towards the beam is ``1/cos t`` longer on every path; one that is deeper than wide by a factor is longer
by that. Neither shows in one view, so both are known from elsewhere or not at all: ``tilt_out = "0 +/- 3 deg"``, ``depth = "1
+/- 0.005"``. 1/cos is even: about t_0 with a standard deviation s, to second order,

    mean = (1 + (1/2 + tan^2 t_0) s^2)/cos t_0,    variance/mean^2 = tan^2 t_0 s^2 + 2 (1/2 + tan^2 t_0)^2 s^4,

so that a tilt known to be about 0 makes the fraction uncertain to one side, and its mean path is longer. All rows share the
error; rows of known fraction, tilted alike, take it out.
"""

import numpy as np

from spinline.scene.images_file import Images

__all__ = ["out_of_plane", "path_factor"]


def out_of_plane(images: Images) -> float:
    """Cosine of the tilt along the beam."""
    return 1.0 if images.tilt_out is None else float(np.cos(images.tilt_out.value))


def path_factor(images: Images) -> tuple[float, dict[str, float]]:
    """Mean factor on the paths, and its relative standard deviation by key; keys without an error are left out."""
    factor, errors = 1.0, {}
    if images.tilt_out is not None:
        t, s = images.tilt_out.value, images.tilt_out.std
        slope, bend = float(np.tan(t)), 0.5 + float(np.tan(t)) ** 2
        factor *= (1.0 + bend * s**2) / float(np.cos(t))
        errors["tilt_out"] = float(np.sqrt(slope**2 * s**2 + 2.0 * bend**2 * s**4))
    if images.depth is not None:
        factor *= images.depth.value
        errors["depth"] = images.depth.std / images.depth.value
    return factor, {key: value for key, value in errors.items() if value > 0.0}
