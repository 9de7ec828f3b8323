"""FENE-P: strands of finite length, ``g = f A - 1``, ``f = (L^2 - 3)/(L^2 - tr A)``; L^2 = N_s where it is not given."""

from collections.abc import Mapping
from typing import Any

from spinline.base.errors import InputError
from spinline.rheology.constitutive.law import ConstitutiveLaw, LawParameter, Surroundings

__all__ = ["LAW"]


def _make(values: Mapping[str, float], surroundings: Surroundings) -> Any:
    from spinline.rheology.conformation import FENEP

    limit = values.get("extensibility", surroundings.full_stretch**2)
    if not limit > 3:
        raise InputError(
            "rheology.extensibility",
            "is that of strands too short for FENE-P",
            value=limit,
            allowed="(3, 1e12]",
            remedy='take constitutive = "UCM" and closure = "force", or give it',
        )
    return FENEP(limit)


LAW = ConstitutiveLaw(
    "FENE-P",
    "strands of finite length",
    _make,
    (LawParameter("extensibility", "number", 0.0, 1e30, False, "L^2; by default that of the strands, N_s"),),
)
