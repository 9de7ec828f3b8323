"""Is there a network: overlap, entanglement, strands and mesh of a solution of known chains, scaling laws.

With N Kuhn segments to a chain, M its molar mass and M_e that between entanglements in the melt::

                                    theta              good (nu = 0.588; mesh: 3/5, as the network model has it)
    overlap          phi*           N^(-1/2)           N^(-4/5)
    strand           N_s            phi^(-2)           phi^(-5/4)
    mesh             xi_0 / b       phi^(-1)           phi^(-3/4)
    entanglements    Z              (M/M_e) phi^(4/3)  (M/M_e) phi^(1/(3 nu - 1))
    entanglement     phi_e          Z = 2              Z = 2

At phi* a strand is the chain. Prefactors of order one are left out: phi* is right within a factor of about 3, and phi_e, whose
scale is a measured M_e, within about 1.5. Z = 2 is the usual critical molar mass, ``M_c = 2 M_e``; electrospun fibres are
free of beads from about Z = 2.5 (Shenoy et al., who take Z as ``phi M/M_e``).

References
----------
Rubinstein, Colby, Polymer Physics (2003), sections 5.3 and 9.3; Colby, Rheol. Acta 49, 425 (2010); Shenoy, Bates, Frisch, Wnek,
Polymer 46, 3372 (2005); de Gennes, Scaling Concepts in Polymer Physics (1979).
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, real
from spinline.base.errors import InputError

__all__ = ["Entanglement", "Quality", "entanglement", "entanglement_fraction", "overlap_fraction"]

Quality = Literal["theta", "good"]
_FLORY = 0.588
_OVERLAP = {"theta": -0.5, "good": -0.8}
_STRAND = {"theta": -2.0, "good": -1.25}
_MESH = {"theta": -1.0, "good": -0.75}
_DILUTION = {"theta": 4 / 3, "good": 1 / (3 * _FLORY - 1)}
_CRITICAL = 2.0


@dataclass(frozen=True)
class Entanglement:
    """What the chains of a solution make of it.

    Attributes
    ----------
    overlap_fraction, entanglement_fraction : float
        phi* and phi_e; above 1 where even the melt is not entangled.
    segments_per_chain, segments_per_strand : float
        N and N_s, Kuhn segments; a strand is the chain below overlap.
    strands_per_chain : float
        N / N_s.
    mesh_size, contour_length : float
        xi_0 and b N_s, m.
    entanglements : float
        Z, strands between entanglements in a chain.
    regime : {"dilute", "semidilute", "entangled"}
    """

    overlap_fraction: float
    entanglement_fraction: float
    segments_per_chain: float
    segments_per_strand: float
    strands_per_chain: float
    mesh_size: float
    contour_length: float
    entanglements: float
    regime: Literal["dilute", "semidilute", "entangled"]

    @property
    def entangled(self) -> bool:
        """Whether there is a network."""
        return self.regime == "entangled"


def overlap_fraction(segments_per_chain: ArrayLike, solvent_quality: Quality = "theta") -> FloatArray:
    """Volume fraction phi* at which chains of N >= 1 Kuhn segments begin to overlap."""
    n = real("segments_per_chain", segments_per_chain, least=1.0)
    value: FloatArray = n ** _OVERLAP[_quality(solvent_quality)]
    return value


def entanglement_fraction(
    molar_mass: ArrayLike,
    entanglement_molar_mass: ArrayLike,
    solvent_quality: Quality = "theta",
    entanglements: float = _CRITICAL,
) -> FloatArray:
    """Volume fraction phi_e at which a chain has so many entanglement strands; above 1 where the melt has fewer.

    Parameters
    ----------
    molar_mass, entanglement_molar_mass : array_like
        M and M_e of the melt, kg/mol, > 0.
    solvent_quality : {"theta", "good"}
    entanglements : float
        Z > 0; 2 by default.

    Returns
    -------
    ndarray, ``(Z M_e/M)^(1/alpha)`` with alpha 4/3 or 1.31.

    Raises
    ------
    InputError
        For values out of range.
    """
    chain = real("molar_mass", molar_mass, above=0.0, unit="kg/mol")
    strand = real("entanglement_molar_mass", entanglement_molar_mass, above=0.0, unit="kg/mol")
    z = number("entanglements", entanglements, above=0.0)
    power = 1 / _DILUTION[_quality(solvent_quality)]
    with np.errstate(over="ignore"):
        value = np.exp(power * (np.log(z) + np.log(strand) - np.log(chain)))
    return real("entanglement_fraction", value, above=0.0, remedy="check the molar masses")


def entanglement(
    volume_fraction: float,
    segments_per_chain: float,
    kuhn_length: float,
    molar_mass: float,
    entanglement_molar_mass: float,
    solvent_quality: Quality = "theta",
) -> Entanglement:
    """State of a solution; see `Entanglement`.

    Parameters
    ----------
    volume_fraction : float
        In (0, 1].
    segments_per_chain : float
        N >= 1.
    kuhn_length : float
        m, in (0, 1].
    molar_mass, entanglement_molar_mass : float
        M and M_e of the melt, kg/mol, > 0.
    solvent_quality : {"theta", "good"}

    Returns
    -------
    Entanglement

    Raises
    ------
    InputError
        For values out of range.
    """
    phi = number("volume_fraction", volume_fraction, least=1e-100, most=1.0)
    n = number("segments_per_chain", segments_per_chain, least=1.0)
    b = number("kuhn_length", kuhn_length, above=0.0, most=1.0, unit="m")
    chain = number("molar_mass", molar_mass, above=0.0, unit="kg/mol")
    melt = number("entanglement_molar_mass", entanglement_molar_mass, above=0.0, unit="kg/mol")
    quality = _quality(solvent_quality)
    overlap = float(overlap_fraction(n, quality))
    onset = float(entanglement_fraction(chain, melt, quality))
    strand = min(phi ** _STRAND[quality], n)
    mesh = max(phi, overlap) ** _MESH[quality]
    with np.errstate(over="ignore", under="ignore"):
        reach = np.float64(chain) / melt * phi ** _DILUTION[quality]
    regime: Literal["dilute", "semidilute", "entangled"] = (
        "dilute" if phi < overlap else "entangled" if phi >= onset else "semidilute"
    )
    return Entanglement(
        overlap_fraction=overlap,
        entanglement_fraction=onset,
        segments_per_chain=n,
        segments_per_strand=strand,
        strands_per_chain=n / strand,
        mesh_size=b * mesh,
        contour_length=b * strand,
        entanglements=number("entanglements", reach, remedy="check the molar masses"),
        regime=regime,
    )


def _quality(name: str) -> Quality:
    if not isinstance(name, str) or name not in get_args(Quality):
        raise InputError("solvent_quality", "is not known", value=name, allowed='"theta", "good"')
    return "good" if name == "good" else "theta"
