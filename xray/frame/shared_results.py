"""What a joint fit of the detector takes, a block of rows, and what it gives."""

from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.xray.row.forward import Detector

__all__ = ["Block", "DetectorFit"]


@dataclass(frozen=True, eq=False)
class Block:
    """A block of rows that is taken for one.

    Attributes
    ----------
    counts, good : ndarray, shape (pixels,)
    detector : Detector
        Its blur and tail are where the fit starts.
    radius, axis : float
        About those of the jet, m.
    cosine : float
        Of the jet's lean in the image: chords are longer across by 1/cosine, and so are blur and tail.
    smear : float
        Standard deviation by which radius and axis change within the block, m.
    known : float or None
        The polymer fraction, where it is known.
    """

    counts: FloatArray
    good: BoolArray
    detector: Detector
    radius: float
    axis: float
    cosine: float = 1.0
    smear: float = 0.0
    known: float | None = None

    def seen(self) -> Detector:
        """The detector as the block's rows see it: blur and tail aslant, and blurred by what changes within the block."""
        d = self.detector
        if self.smear == 0.0 and (self.cosine == 1.0 or d.blur == d.tail_length == 0.0):
            return d
        return replace(
            d, blur=float(np.hypot(d.blur, self.smear)) / self.cosine, tail_length=d.tail_length / self.cosine
        )


@dataclass(frozen=True, eq=False)
class DetectorFit:
    """What blocks of rows say of the detector they share.

    Attributes
    ----------
    names : tuple of str
        Of `SHARED`, what was free.
    values, std : dict
        Blur and tail_length in m.
    covariance : ndarray
        Of the names.
    deviance : float
        With what was known beforehand.
    converged : bool
    sharp : bool
        The counts are likeliest without a blur: it is 0.
    vague : tuple of str
        Those that the counts tell next to nothing of: they need a prior.
    """

    names: tuple[str, ...]
    values: dict[str, float]
    std: dict[str, float]
    covariance: FloatArray
    deviance: float
    converged: bool
    sharp: bool = False
    vague: tuple[str, ...] = ()
