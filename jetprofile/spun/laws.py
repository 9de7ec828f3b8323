"""Constitutive laws of a spun jet behind one interface: which liquid an element is made of.

==================  ==================================================================================
`ucm`               upper-convected Maxwell; the default where nothing limits the chains
`linear_maxwell`    Eq. (14) as published: ill-posed where the stress passes G (warned), only to reproduce papers
`oldroyd_b`         Maxwell with a solvent's viscosity beside it
`giesekus`          Oldroyd-B with a mobility a: shear thinning, bounded extensional viscosity
`fene_p`            chains of finite extent L^2
`herschel_bulkley`  Eq. (14) with yield stress and power law, sign corrected, regularised
==================  ==================================================================================

The polymer's modulus is ``G = mu (1 - rs)/theta``. A viscosity measured in extension (as in the published PVP case) belongs
to the linear law; its conformation law has ``G/3`` at the same relaxation time (`from_extensional`).
"""

import math
from dataclasses import dataclass, replace
from typing import Self

from spinline.base.checks import number, positive
from spinline.base.errors import InputError
from spinline.jetprofile.spun import _codes as c

__all__ = ["LAWS", "JetLaw"]

LAWS = ("ucm", "linear-maxwell", "oldroyd-b", "giesekus", "fene-p", "herschel-bulkley")


@dataclass(frozen=True)
class JetLaw:
    """A constitutive law with its numbers.

    Parameters
    ----------
    name : str
        One of `LAWS`.
    modulus : float
        G of the polymer, Pa, >= 0.
    relaxation_time : float
        theta, s, > 0; infinite for a rubber.
    solvent_viscosity : float
        mu_s, Pa s, >= 0; 0 for "ucm" and "linear-maxwell".
    extensibility : float
        L^2 of "fene-p", > 3.
    mobility : float
        a of "giesekus", in (0, 1].
    yield_stress, consistency, index : float
        sigma_Y in Pa, K in Pa s^n and n of "herschel-bulkley".
    """

    name: str
    modulus: float
    relaxation_time: float
    solvent_viscosity: float = 0.0
    extensibility: float = math.inf
    mobility: float = 0.0
    yield_stress: float = 0.0
    consistency: float = 0.0
    index: float = 1.0

    def __post_init__(self) -> None:
        if self.name not in LAWS:
            raise InputError("law", "is not a known constitutive law", value=self.name, allowed=", ".join(LAWS))
        number("modulus", self.modulus, least=0.0, unit="Pa")
        if self.relaxation_time != math.inf:
            positive("relaxation_time", self.relaxation_time, "s")
        number("solvent_viscosity", self.solvent_viscosity, least=0.0, unit="Pa s")
        if self.name in ("ucm", "linear-maxwell") and self.solvent_viscosity > 0.0:
            raise InputError(
                "solvent_viscosity",
                f"has no place in the law {self.name}",
                value=self.solvent_viscosity,
                remedy='take "oldroyd-b", "giesekus" or "fene-p"',
            )
        if self.name == "fene-p":
            number("extensibility", self.extensibility, above=3.0)
        elif self.extensibility != math.inf:
            raise InputError("extensibility", f"has no place in the law {self.name}", value=self.extensibility)
        if self.name == "giesekus":
            number("mobility", self.mobility, above=0.0, most=1.0)
        elif self.mobility != 0.0:
            raise InputError("mobility", f"has no place in the law {self.name}", value=self.mobility)
        if self.name == "herschel-bulkley":
            number("yield_stress", self.yield_stress, least=0.0, unit="Pa")
            number("consistency", self.consistency, least=0.0, unit="Pa s^n")
            positive("index", self.index)
            positive("modulus", self.modulus, "Pa")

    @classmethod
    def from_viscosity(
        cls, name: str, viscosity: float, relaxation_time: float, *, solvent_ratio: float = 0.0, **numbers: float
    ) -> Self:
        """Law from a zero-shear viscosity mu, theta and rs = mu_s/mu."""
        mu = positive("viscosity", viscosity, "Pa s")
        theta = positive("relaxation_time", relaxation_time, "s")
        share = number("solvent_ratio", solvent_ratio, least=0.0, below=1.0)
        return cls(name, mu * (1.0 - share) / theta, theta, solvent_viscosity=share * mu, **numbers)

    @classmethod
    def from_extensional(cls, viscosity: float, modulus: float, name: str = "ucm") -> Self:
        """Law from an extensional viscosity and the linear law's G: ``G/3`` at the same ``theta = mu_e/G`` for "ucm"."""
        mu, g = positive("viscosity", viscosity, "Pa s"), positive("modulus", modulus, "Pa")
        return cls(name, g if name in ("linear-maxwell", "herschel-bulkley") else g / 3.0, mu / g)

    def with_solvent(self, viscosity: float) -> Self:
        """The same polymer in a solvent of another viscosity, Pa s."""
        return replace(self, solvent_viscosity=viscosity)

    @property
    def code(self) -> int:
        """The kernels' number of the law."""
        if self.name == "linear-maxwell":
            return c.LINEAR_MAXWELL
        return c.HERSCHEL_BULKLEY if self.name == "herschel-bulkley" else c.CONFORMATION
