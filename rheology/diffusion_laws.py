"""Diffusion of solvent in a polymer as it dries: constant, exponential, free volume.

::

    constant      D
    exponential   D = D_0 exp(-k phi)                     phi the polymer volume fraction
    free volume   D = D_dry exp(phi_s / (A + B phi_s))    phi_s = 1 - phi, Fujita

D is the mutual diffusion coefficient in m2/s, with volumes additive.

References
----------
Fujita, Fortschr. Hochpolym. Forsch. 3, 1 (1961); Crank, The Mathematics of Diffusion (1975), chapter 9.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from spinline.base.checks import FloatArray, number, positive

__all__ = ["ConstantDiffusion", "DiffusionLaw", "ExponentialDiffusion", "FreeVolumeDiffusion"]


class DiffusionLaw(Protocol):
    """D in m2/s against the polymer volume fraction."""

    def __call__(self, volume_fraction: FloatArray, /) -> FloatArray:
        """D at phi in [0, 1], the same shape."""


@dataclass(frozen=True)
class ConstantDiffusion:
    """The same `value` (m2/s, > 0) at every fraction."""

    value: float

    def __post_init__(self) -> None:
        positive("value", self.value, "m2/s")

    def __call__(self, volume_fraction: FloatArray, /) -> FloatArray:
        """D in m2/s."""
        return np.full_like(volume_fraction, self.value)


@dataclass(frozen=True)
class ExponentialDiffusion:
    """`dilute` D_0 (m2/s, > 0) at phi = 0, falling by exp(`decay`) to phi = 1; decay in [0, 100]."""

    dilute: float
    decay: float

    def __post_init__(self) -> None:
        positive("dilute", self.dilute, "m2/s")
        number("decay", self.decay, least=0.0, most=100.0)

    def __call__(self, volume_fraction: FloatArray, /) -> FloatArray:
        """D in m2/s."""
        value: FloatArray = self.dilute * np.exp(-self.decay * volume_fraction)
        return value


@dataclass(frozen=True)
class FreeVolumeDiffusion:
    """`dry` D (m2/s, > 0) in the dry polymer, with Fujita's A (`gap` > 0, >= 0.01) and B (`growth` >= 0)."""

    dry: float
    gap: float
    growth: float

    def __post_init__(self) -> None:
        positive("dry", self.dry, "m2/s")
        number("gap", self.gap, least=0.01, remedy="a smaller gap changes D by more than 40 decades")
        number("growth", self.growth, least=0.0)

    def __call__(self, volume_fraction: FloatArray, /) -> FloatArray:
        """D in m2/s."""
        solvent = 1 - volume_fraction
        value: FloatArray = self.dry * np.exp(solvent / (self.gap + self.growth * solvent))
        return value
