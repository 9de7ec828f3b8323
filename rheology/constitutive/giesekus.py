"""Giesekus: anisotropic drag, ``g = (A - 1) + alpha (A - 1)^2``; where entangled solutions soften."""

from collections.abc import Mapping
from typing import Any

from spinline.rheology.constitutive.law import ConstitutiveLaw, LawParameter, Surroundings

__all__ = ["LAW"]


def _make(values: Mapping[str, float], surroundings: Surroundings) -> Any:
    from spinline.rheology.conformation import Giesekus

    return Giesekus(values["mobility"])


LAW = ConstitutiveLaw(
    "Giesekus",
    "anisotropic drag",
    _make,
    (
        LawParameter(
            "mobility", "fraction", 0.0, 1.0, True, "alpha, at most 1/2 for a monotone flow curve", needed=True
        ),
    ),
)
