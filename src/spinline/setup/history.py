"""What a material element goes through on its way along a jet: what drying leaves, and what relaxation acts on."""

from dataclasses import dataclass

from spinline.base.checks import FloatArray

__all__ = ["History"]


@dataclass(frozen=True, eq=False)
class History:
    """One moment of a jet at samples (n,), with what evaporation made of it.

    Attributes
    ----------
    position : ndarray
        m along the jet, increasing.
    time : ndarray
        Age, s.
    stretch : ndarray
        Material stretch since the start.
    radius, velocity : ndarray
        m, m/s.
    strain_rate : ndarray or None
        1/s; None along beads.
    remaining, fraction : ndarray
        Volume left over that at the nozzle, and the mean polymer fraction.
    temperature, stiffening : ndarray or None
        Of a jet that cools: K, and the factor on viscosity and relaxation time that its temperature and the glass to come make.
    """

    position: FloatArray
    time: FloatArray
    stretch: FloatArray
    radius: FloatArray
    velocity: FloatArray
    strain_rate: FloatArray | None
    remaining: FloatArray
    fraction: FloatArray
    temperature: FloatArray | None = None
    stiffening: FloatArray | None = None
