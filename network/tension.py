"""Tension of the network's strands against their stretch, for the bead balance of Eq. (32a).

``T(w)`` is the strand force in units of the Gaussian strand's at rest: ``T = w`` for the linear spring, and
``T(w) = f(w / V_S; f_0) / f_0``, ``f_0 = 3 / V_S``, for a force-extension law f. All agree for w << V_S; every law but the
linear keeps w below the contour V_S.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError
from spinline.network.force_laws import ForceLaw, extension, force, law_code, stiffness

__all__ = ["Tension"]


@dataclass(frozen=True)
class Tension:
    """A tension law.

    Parameters
    ----------
    law : {"linear", "lattice", "langevin", "fene"}
        Force-extension law.
    full_stretch : float
        Contour ``V_S = xi_max / xi_0``, > 1; inf for the linear spring.
    """

    law: ForceLaw
    full_stretch: float

    def __post_init__(self) -> None:
        if law_code(self.law):
            number("full_stretch", self.full_stretch, above=1.0)
        elif not (isinstance(self.full_stretch, float) and self.full_stretch == np.inf):
            raise InputError(
                "full_stretch", "is no property of the linear spring", value=self.full_stretch, allowed="inf"
            )

    @classmethod
    def linear(cls) -> "Tension":
        """The spring of Eq. (32a): ``T = w``, no contour."""
        return cls("linear", np.inf)

    @classmethod
    def of(cls, law: ForceLaw, full_stretch: float) -> "Tension":
        """Law by name, with the contour of the network at rest (ignored by the linear spring)."""
        if isinstance(law, str) and law == "linear":
            return cls.linear()
        return cls(law, number("full_stretch", full_stretch, above=1.0))

    @property
    def bounded(self) -> bool:
        """Whether the law has a contour."""
        return bool(np.isfinite(self.full_stretch))

    @property
    def rest_force(self) -> float:
        """``f_0 = 3 / V_S``."""
        return 3 / self.full_stretch

    @property
    def tension_at_rest(self) -> float:
        """T(1): what a free end carries."""
        return float(self.tension(1.0))

    def tension(self, stretch: ArrayLike) -> FloatArray:
        """T(w), w > 0 and below the contour."""
        w = real("stretch", stretch, above=0.0)
        if not self.bounded:
            return w
        return force(w / self.full_stretch, self.law, self.rest_force) / self.rest_force

    def stretch(self, tension: ArrayLike) -> FloatArray:
        """Stretch w(T): the inverse of `tension`."""
        t = real("tension", tension)
        if not self.bounded:
            return t
        return self.full_stretch * extension(t * self.rest_force, self.law, self.rest_force)

    def state(self, tension: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Stretch w and compliance ``dw/dT`` at a tension; the compliance is 0 where w rounds to the contour."""
        if not self.bounded:
            return tension, np.ones_like(tension)
        x = extension(tension * self.rest_force, self.law, self.rest_force)
        short = np.abs(x) < 1
        # dw/dT = V_S f_0 dx/df = 3 / (df/dx)
        compliance = np.where(short, 3 / stiffness(np.where(short, x, 0.0), self.law, self.rest_force), 0.0)
        return self.full_stretch * x, compliance
