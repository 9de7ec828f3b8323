"""What a constitutive law is to a scene: a name, a table of parameters, and how its model is made.

The model that `make` gives is what `spinline.rheology.conformation` integrates: an object with

* ``follow(history, first, rtol)``: A_zz, A_rr and the stiffening f at every sample of an `ElementHistory`, from ``first`` on;
* ``stiffening(v)``: how much faster than Maxwell's it gives back an affine stretch v, and its largest stretch: for estimates;
* ``solvent_viscosity``: Pa s, of a Newtonian stress beside that of the strands; 0 for none.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

__all__ = ["ConstitutiveLaw", "LawParameter", "Surroundings"]


@dataclass(frozen=True)
class LawParameter:
    """A parameter of a law.

    Attributes
    ----------
    name : str
        Key of ``[rheology]``.
    kind : str
        Of quantity, a key of `spinline.base.units.QUANTITIES`.
    low, high : float
        Range, SI.
    closed : bool
        The ends belong to it.
    words : str
        What it is.
    default : float or None
        None: the law makes its own, or cannot do without (`needed`).
    needed : bool
    """

    name: str
    kind: str
    low: float
    high: float
    closed: bool
    words: str
    default: float | None = None
    needed: bool = False


@dataclass(frozen=True)
class Surroundings:
    """What a law may take from the scene beside its parameters: viscosity of the solvent (Pa s) and V_S of the strands."""

    solvent_viscosity: float
    full_stretch: float


@dataclass(frozen=True)
class ConstitutiveLaw:
    """A law that ``rheology.constitutive`` may name.

    Attributes
    ----------
    name : str
    words : str
        What it is, in a line.
    make : callable
        ``make(values, surroundings)``: the model; `values` holds the parameters that are given or have a default.
    parameters : tuple of LawParameter
    needs_solvent : bool
        It takes the viscosity of the solvent.
    """

    name: str
    words: str
    make: Callable[[Mapping[str, float], Surroundings], Any]
    parameters: tuple[LawParameter, ...] = ()
    needs_solvent: bool = False
