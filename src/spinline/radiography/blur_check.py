"""Whether the edges of the jet are blurred though no blur is given.

Every detector blurs, and a blur that is left out goes into radius and fraction: 1.8 pixels are 0.02 in the mean fraction at
R = 50 um and 10 keV, four standard deviations of a row at 1e7 photons. The rows over which the jet is steady are summed and
fitted twice, without a blur and with one that is free.
"""

import numpy as np

from spinline.base.errors import InputError
from spinline.scene.images_file import Images
from spinline.xray.frame.blocks import Frame
from spinline.xray.frame.track import Track
from spinline.xray.row.fit import fit_row
from spinline.xray.row.forward import Absorber

__all__ = ["steady_rows", "unsaid_blur"]

_BETTER = 25.0  # gain in deviance from which on there is a blur: 5 standard deviations
_LEAST = 0.3  # pixels; less may be the taper within the rows, and matters little
_STEADY = 0.5  # pixels
_SHELLS = 3


def steady_rows(track: Track) -> tuple[int, int]:
    """Rows from the widest one on, over which radius and axis stay within half a pixel: first, and the one after the last."""
    start = int(np.argmax(np.where(track.found, track.radius, 0.0)))
    steady = np.hypot(track.radius - track.radius[start], track.axis - track.axis[start]) < _STEADY
    changed = np.flatnonzero(~steady[start:])
    return start, start + int(changed[0]) if changed.size else int(steady.size)


def unsaid_blur(images: Images, absorber: Absorber, frame: Frame, track: Track) -> list[str]:
    """Words where a blur is seen that the images file does not give; empty elsewhere.

    Parameters
    ----------
    images : Images
    absorber : Absorber
    frame : Frame
        Summed photons.
    track : Track
        Of the jet in it.
    """
    if images.blur is not None or images.method not in ("row", "map") or images.spectrum is not None:
        return []
    start, stop = steady_rows(track)
    place = {"radius": float(track.radius[start]) * frame.pixel, "axis": float(track.axis[start]) * frame.pixel}
    nuisances = ("radius", "axis", "amplitude", "slope")
    try:
        counts, detector, good = frame.block(start, stop)
        sharp = fit_row(counts, absorber, detector, shells=_SHELLS, nuisances=nuisances, good=good, **place)
        counts, detector, good = Frame(
            frame.counts, frame.flat, frame.dark, frame.good, frame.pixel, frame.pixel
        ).block(start, stop)
        soft = fit_row(counts, absorber, detector, shells=_SHELLS, nuisances=(*nuisances, "blur"), good=good, **place)
    except InputError:
        return []
    blur = soft.values["blur"]
    if not (soft.converged and sharp.deviance - soft.deviance > _BETTER and blur > _LEAST * frame.pixel):
        return []
    shift = sharp.mean_fraction - soft.mean_fraction
    return [
        f"the jet's edges are blurred by {1e6 * blur:.2g} um ({blur / frame.pixel:.2g} pixels), and none is given: left out, "
        f'it shifts the mean fraction by {shift:+.2g}; give blur, or blur = "fit"'
    ]
