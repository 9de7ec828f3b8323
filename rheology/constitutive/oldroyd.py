"""Oldroyd-B: Maxwell's strands in a Newtonian solvent, whose stress is ``2 mu_s edot`` along the jet."""

from collections.abc import Mapping
from typing import Any

from spinline.rheology.constitutive.law import ConstitutiveLaw, Surroundings

__all__ = ["LAW"]


def _make(values: Mapping[str, float], surroundings: Surroundings) -> Any:
    from spinline.rheology.conformation import OldroydB

    return OldroydB(surroundings.solvent_viscosity)


LAW = ConstitutiveLaw("Oldroyd-B", "Maxwell in a Newtonian solvent", _make, needs_solvent=True)
