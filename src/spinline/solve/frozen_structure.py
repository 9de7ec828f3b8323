"""Structure that stays: where the jet turns to glass, what the strands are there, and what relaxed on the way.

The structure is that of the network where the section's mean fraction reaches the vitrification fraction; from there
on it changes no more. With radial drying the skin freezes before and the core after: both are given too. Not a word is
said of what cannot be known: NaN, and a sentence.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from spinline.base.checks import FloatArray

__all__ = ["FROZEN", "Along", "Frozen", "freeze"]

# what is reported where something freezes
FROZEN = ("position", "time", "radius", "stretch", "extension", "orientation", "relaxed")


@dataclass(frozen=True, eq=False)
class Along:
    """The jet at samples (n,): place (m), age (s), radius (m), stretch of strands w, material stretch."""

    position: FloatArray
    time: FloatArray
    radius: FloatArray
    stretch: FloatArray
    stretch_ratio: FloatArray

    def at(self, place: float) -> dict[str, float]:
        """Age, radius, w and material stretch at a place: logarithms linear between samples, age too."""
        x = self.position
        return {
            "time": float(np.interp(place, x, self.time)),
            **{
                name: float(np.exp(np.interp(place, x, np.log(getattr(self, name)))))
                for name in ("radius", "stretch", "stretch_ratio")
            },
        }


@dataclass(frozen=True)
class Frozen:
    """What freezes along a jet.

    Attributes
    ----------
    position : float
        Where the mean turns to glass, m; NaN where it does not.
    scalars : dict
        ``frozen_position`` and the others of `FROZEN`; with radial drying ``skin_`` and ``core_`` as well.
    words : dict
        A sentence each.
    """

    position: float
    scalars: dict[str, float] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)


Conformation = Callable[[float], tuple[float, float]]


def freeze(
    along: Along,
    places: dict[str, tuple[float, float]],
    fraction: float,
    why: str,
    conformation: Conformation,
    never: str,
    exact: dict[str, float] | None = None,
) -> Frozen:
    """Structure at the places where things freeze.

    Parameters
    ----------
    along : Along
        The jet.
    places : dict
        "frozen" (the mean), and "skin" and "core" where known: position in m and the predicted one, NaN where not
        reached.
    fraction : float
        Vitrification fraction; NaN where not known.
    why : str
        Where it comes from, or why it is not known.
    conformation : callable
        Extension and orientation of strands stretched by w.
    never : str
        What to say where it is not reached and no prediction can be made.
    exact : dict, optional
        Radius and material stretch where "frozen" is, in place of those between the samples: there r^2 Lambda phi is
        r_0^2 phi_0.

    Returns
    -------
    Frozen
    """
    scalars: dict[str, float] = {"vitrification_fraction": fraction}
    words: dict[str, str] = {}
    for name, (place, predicted) in places.items():
        values = dict.fromkeys(FROZEN, float("nan"))
        if not np.isnan(place):
            here = along.at(place)
            if name == "frozen" and exact is not None:
                if abs(here["stretch"] / here["stretch_ratio"] - 1) < 1e-9:  # strands that go with the jet
                    here["stretch"] = exact["stretch_ratio"]
                here |= exact
            w, affine = here["stretch"], here["stretch_ratio"]
            extension, orientation = conformation(w)
            values |= {
                "position": place,
                "time": here["time"],
                "radius": here["radius"],
                "stretch": w,
                "extension": extension,
                "orientation": orientation,
                "relaxed": 1 - w / affine,
            }
        scalars |= {f"{name}_{key}": value for key, value in values.items()}
        words[name] = _sentence(name, values, predicted, fraction, why, never)
    return Frozen(places["frozen"][0], scalars, words)


_WHAT = {"frozen": "the section's mean", "skin": "the surface", "core": "the axis"}


def _sentence(name: str, values: dict[str, Any], predicted: float, fraction: float, why: str, never: str) -> str:
    what = _WHAT[name]
    if np.isnan(fraction) and np.isnan(values["position"]):
        return f"the vitrification fraction is {why}"
    level = f"phi = {fraction:.4g} ({why})"
    if np.isnan(values["position"]):
        if not np.isnan(predicted):
            return f"{what} does not reach {level} within the jet; at about {predicted:.4g} m if the profile went on"
        return f"{what} does not reach {level} within the jet; {never}"
    return (
        f"{what} reaches {level} at {values['position']:.6g} m after {values['time']:.4g} s, radius "
        f"{values['radius']:.4g} m, with O = {values['orientation']:.4g}, stretch {values['stretch']:.4g} and "
        f"{100 * values['relaxed']:.3g} % of the affine stretch relaxed"
    )
