"""Where a straight jet is looked at: how far it goes, and places along it."""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.sorting import ascending
from spinline.jetprofile.straight import StraightJet
from spinline.scene.file import Scene

__all__ = ["jet_grid", "jet_length"]


def jet_length(scene: Scene, jet: StraightJet) -> float:
    """Length of the jet in m: the scene's, within what the profile covers."""
    length = getattr(scene.jet, "length", None)
    if length is None:
        return jet.end
    if length.value > jet.end * (1 + 1e-12):
        raise InputError(
            "jet.length",
            "reaches beyond the last sample of the table",
            value=length.text,
            allowed=f"up to {jet.end:g} m",
        )
    if length.value <= jet.start:
        raise InputError("jet.length", "ends before the first sample", value=length.text, allowed=f"> {jet.start:g} m")
    return float(min(length.value, jet.end))


def jet_grid(jet: StraightJet, end: float, points: int) -> FloatArray:
    """Places from the jet's start to `end`, even in the logarithm beyond where it begins to thin; its kinks among them.

    The scale is r_0, or the first kink where that is nearer: a strong field (k >> 1) thins a jet long before z = r_0.
    """
    kinks = [kink * jet.initial_radius for kink in jet.kinks()]
    inside = [jet.start + kink for kink in kinks if jet.start + kink < end]
    scale = min([jet.initial_radius, *(kink for kink in kinks if kink > 0)])
    grid = jet.start + scale * np.expm1(np.linspace(0.0, np.log1p((end - jet.start) / scale), points))
    grid[-1] = end
    return ascending(np.concatenate((np.clip(grid, jet.start, end), inside)))
