"""The methods of reduction, each from one frame of photons to fractions: the place where a new one is added.

A method takes an experiment, a frame, the track of the jet (None: to be found) and a function to call with the number of blocks
done, and returns a `FrameFit`. Its name is a value of the key `method`, its meaning goes into the result.
"""

from collections.abc import Callable
from typing import NamedTuple

from spinline.errors import InputError
from spinline.experiment import Experiment, nuisances
from spinline.phase_method import phase_frame
from spinline.xray.frame import Frame, FrameFit, fit_frame
from spinline.xray.quick import chord_frame
from spinline.xray.track import Track

__all__ = ["METHODS", "Method", "require_method"]

Done = Callable[[int], None] | None


class Method(NamedTuple):
    """A way to reduce a frame.

    Attributes
    ----------
    reduce : callable
        ``reduce(experiment, frame, track, done)``: a `FrameFit`.
    meaning : str
        In a sentence.
    """

    reduce: Callable[[Experiment, Frame, Track | None, Done], FrameFit]
    meaning: str


def _chord(experiment: Experiment, frame: Frame, track: Track | None, _: Done) -> FrameFit:
    images = experiment.images
    same = track if images.block_rows == 1 else None
    return chord_frame(frame, experiment.absorber, shells=images.shells, block_rows=images.block_rows, track=same)


def _row(experiment: Experiment, frame: Frame, track: Track | None, done: Done) -> FrameFit:
    images = experiment.images
    return fit_frame(
        frame, experiment.absorber, shells=images.shells, block_rows=images.block_rows, nuisances=nuisances(images),
        track=track, done=done,
    )  # fmt: skip


def _phase(experiment: Experiment, frame: Frame, track: Track | None, done: Done) -> FrameFit:
    images = experiment.images
    return phase_frame(images, experiment.solution, experiment.absorber, frame, nuisances(images), track, done)


METHODS = {
    "chord": Method(
        _chord,
        "Eqs. (41)-(42) on every chord: the published quick look; shells hold means along chords, not local values",
    ),
    "phase": Method(
        _phase,
        "joint Poisson likelihood with Fresnel fringes: shells, radius, axis, level, slope and distance of every block",
    ),
    "row": Method(_row, "joint Poisson likelihood of shells, radius, axis, level and slope of every block of rows"),
}


def require_method(name: str) -> Method:
    """Method of a name; refused where it is not there."""
    if name not in METHODS:
        known = ", ".join(f'"{method}"' for method in METHODS)
        raise InputError("method", "is not available yet", value=name, allowed=known, remedy='take method = "row"')
    return METHODS[name]
