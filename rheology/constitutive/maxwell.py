"""Upper-convected Maxwell: ``dA/dt = ... - (A - 1)/theta``; below a third of the contour, or for closed forms."""

from collections.abc import Mapping
from typing import Any

from spinline.rheology.constitutive.law import ConstitutiveLaw, Surroundings

__all__ = ["LAW"]


def _make(values: Mapping[str, float], surroundings: Surroundings) -> Any:
    from spinline.rheology.conformation import Maxwell

    return Maxwell()


LAW = ConstitutiveLaw("UCM", "upper-convected Maxwell", _make)
