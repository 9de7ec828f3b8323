"""Attenuation against that at the nozzle, where the polymer fraction is known."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from spinline.base.checks import FloatArray
from spinline.xray.row.forward import Absorber

if TYPE_CHECKING:
    from spinline.xray.matter.medium import Medium

__all__ = ["Calibration", "scaled_medium"]


@dataclass(frozen=True)
class Calibration:
    """Attenuation against that at the nozzle.

    Attributes
    ----------
    scale, std : float
        Measured over assumed attenuation, and its standard deviation, but for what is told together with the detector
        (`detector.SharedDetector`). Without a calibration 1, and what the errors given for pixel size, energy, mass
        attenuation, density, tilt and depth make of it (`given_quantities`).
    """

    scale: float = 1.0
    std: float = 0.0

    def shift(self, absorber: Absorber, fraction: FloatArray) -> FloatArray:
        """What one standard deviation of the scale does to a polymer fraction."""
        mu = absorber.solvent - absorber.air + absorber.contrast * fraction
        return mu / absorber.contrast * self.std / self.scale


def scaled_medium(medium: "Medium | None", factor: float) -> "Medium | None":
    """A medium whose attenuation is larger by a factor."""
    if medium is None:
        return None
    names = ("solvent", "contrast", "air")
    return replace(medium, **{name: getattr(medium, name) * factor for name in names})
