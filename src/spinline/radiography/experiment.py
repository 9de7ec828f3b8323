"""What a set of images needs before it is reduced: photons, the size of a pixel, attenuation, the jet's track, the detector.

`prepare` refuses what cannot be reduced, with the key that would change it; `expected_errors` says what the photons allow
before anyone waits. The attenuation is scaled so that the polymer fraction at the nozzle is the known one (`calibration`),
blur and glare are fitted for all rows together (`detector`), the jet's lean is taken from its track.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.images.flat_and_dark import Fields
from spinline.images.photons import photons_frame
from spinline.images.stacks import Stack
from spinline.images.sums import FrameSum
from spinline.radiography.calibration import Calibration
from spinline.radiography.detector import SharedDetector
from spinline.radiography.looks import (
    row_law,
    without_nozzle,
)
from spinline.scene.images_file import Images
from spinline.xray.frame.blocks import Frame, FrameFit, fit_frame, require_track
from spinline.xray.frame.lean import Lean, axis_lean
from spinline.xray.frame.track import Track
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.frame import fit_frame_phase
from spinline.xray.row.forward import Absorber, RoundJet
from spinline.xray.row.limit import error_limit
from spinline.xray.row.model import beam_shape

if TYPE_CHECKING:
    from spinline.rheology.solution import Solution

__all__ = [
    "Experiment",
    "bent",
    "expected_errors",
    "fit_blocks",
    "joint_detector",
    "require_signal",
]


def joint_detector(images: Images, medium: "Medium | None") -> bool:
    """Whether the detector is fitted for all rows together: by absorption of one energy."""
    one_line = medium is None or medium.energy_kev.size == 1
    return images.method in ("row", "map") and one_line


@dataclass(frozen=True, eq=False)
class Experiment:
    """A set of images, ready to reduce.

    Attributes
    ----------
    images, stack, fields, solution
        The file, its frames, flat and dark, and the solution.
    pixel, pixel_std : float
        m.
    absorber : Absorber
        On the paths through the jet (tilt and depth), calibrated where rows were given.
    medium : Medium or None
        Attenuation and refraction at every line of the beam; None where attenuation was given.
    calibration : Calibration
    notes : dict of str
        How each of these was come by.
    remarks : tuple of str
        What is odd.
    wave_medium : Medium or None
        What fringes are looked for with: `medium`, or where attenuation was given that of the tables with it.
    fringes : float
        Significance of fringes in the summed frame; NaN where they were not looked for, or are to be reduced.
    detector : SharedDetector
        Blur, glare and shape of the beam.
    lean : Lean
        Of the jet in the summed frame.
    used : int
        Frames in the sum.
    """

    images: Images
    stack: Stack
    fields: Fields
    solution: "Solution"
    pixel: float
    pixel_std: float
    absorber: Absorber
    medium: "Medium | None"
    calibration: Calibration
    notes: dict[str, str]
    remarks: tuple[str, ...]
    wave_medium: "Medium | None" = None
    fringes: float = np.nan
    detector: SharedDetector = field(default_factory=SharedDetector)
    lean: Lean = field(default_factory=lambda: Lean(np.zeros(0), 0.0, 0))
    used: int = 0

    @property
    def nuisances(self) -> tuple[str, ...]:
        """What every block of rows has of its own beside the fractions."""
        shapes = () if self.detector.shapes else tuple(f"shape{n}" for n in range(2, self.detector.order + 1))
        row_blur = ("blur",) if not joint_detector(self.images, self.medium) and self.images.blur == "fit" else ()
        return ("radius", "axis", "amplitude", "slope", *row_blur, *(shapes if self.images.method == "row" else ()))

    def frame(self, summed: FrameSum, moment: float = 0.5) -> tuple[Frame, dict[str, float]]:
        """Photons of one frame or of a sum."""
        frame, facts = photons_frame(self.images, self.fields, summed, self.pixel, self.detector.blur, moment)
        return bent(without_nozzle(frame, self.images), self.detector), facts


def bent(frame: Frame, detector: SharedDetector) -> Frame:
    """A frame with the detector's blur and tail, and the flat as the beam has become."""
    bend = beam_shape(dict(detector.shapes), frame.counts.shape[1])
    return replace(
        frame,
        flat=frame.flat * bend,
        blur=detector.blur,
        tail_share=detector.tail_share,
        tail_length=detector.tail_length,
    )


def fit_blocks(
    experiment: Experiment,
    frame: Frame,
    track: Track | None,
    *,
    shells: int,
    block_rows: int,
    done: Callable[[int], None] | None = None,
    begun: FrameFit | None = None,
    keep: Callable[[FrameFit], None] | None = None,
    lean: FloatArray | None = None,
) -> FrameFit:
    """The likelihood of every block of rows, by absorption or with fringes, as the images file says."""
    images = experiment.images
    law = row_law(images, experiment.medium)
    if images.method == "phase":
        assert experiment.medium is not None
        assert images.propagation_distance is not None
        return fit_frame_phase(
            frame,
            experiment.medium,
            images.propagation_distance.value,
            shells=shells,
            block_rows=block_rows,
            nuisances=(*experiment.nuisances, "distance", "refraction"),
            track=track,
            done=done,
            begun=begun,
            keep=keep,
        )
    path = require_track(frame) if track is None else track
    return fit_frame(
        frame,
        experiment.absorber,
        shells=shells,
        block_rows=block_rows,
        nuisances=experiment.nuisances,
        track=path,
        one=law,
        done=done,
        begun=begun,
        keep=keep,
        lean=axis_lean(path).slope if lean is None else lean,
        shared=experiment.detector.names,
    )


def expected_errors(
    experiment: Experiment, frame: Frame, track: Track, block_rows: int | None = None, samples: int = 7
) -> tuple[FloatArray, FloatArray]:
    """Standard deviation of the mean fraction that the photons allow, all nuisances unknown, before anything is fitted.

    Returns
    -------
    row, std : ndarray
        Some rows along the frame, and the bound for a block of `block_rows` there (one uniform shell: the mean alone; with the
        shells of the file where they are to be fitted).
    """
    height = min(block_rows or experiment.images.block_rows, frame.counts.shape[0])
    starts = np.unique(np.linspace(0, frame.counts.shape[0] - height, samples).astype(int))
    shells = experiment.images.shells if experiment.images.method == "row" else 1
    phi = np.full(shells, experiment.solution.volume_fraction)
    std = np.full(starts.size, np.nan)
    for i, start in enumerate(starts.tolist()):
        inside = slice(start, start + height)
        radius, axis = float(np.median(track.radius[inside])), float(np.median(track.axis[inside]))
        try:
            _, detector, good = frame.block(start, start + height)
            jet = RoundJet(phi, radius * frame.pixel, axis * frame.pixel)
            names = experiment.nuisances
            std[i] = error_limit(jet, experiment.absorber, detector, nuisances=names, good=good).mean
        except InputError:
            continue  # this block cannot be fitted: the reduction says so in its place
    return starts + 0.5 * (height - 1), std


def require_signal(experiment: Experiment, frame: Frame, track: Track) -> FloatArray:
    """Refuse a reduction whose errors are expected to exceed the fraction everywhere; the errors otherwise."""
    _, std = expected_errors(experiment, frame, track)
    phi = experiment.solution.volume_fraction
    if not np.isfinite(std).any() or np.nanmin(std) <= phi:
        return std
    best = float(np.nanmin(std))
    rows = int(np.ceil(experiment.images.block_rows * (3.0 * best / phi) ** 2))
    enough = rows <= frame.counts.shape[0]
    remedy = (
        f"block_rows = {rows} gives a third of the fraction"
        if enough
        else (
            f"{(3.0 * best / phi) ** 2:.2g} times the photons give a third of the fraction; `spinline exposure` plans them"
        )
    )
    raise InputError(
        "block_rows",
        f"the error expected, {best:.2g}, exceeds the polymer fraction, {phi:.3g}, in every block",
        value=experiment.images.block_rows,
        remedy=f"{remedy}; or --noisy",
    )
