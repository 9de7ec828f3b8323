"""What comes out of the needle: fibres, beads, a spray, drops, a wet mat; and the number that says so."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from spinline.base.constants import EPS0
from spinline.recipe.believe import Recipe
from spinline.recipe.model import Believed, Fibres

__all__ = ["REGIMES", "Regime", "regime_of"]

#: What a recipe can give, in words.
REGIMES = {
    "jets": "smooth fibres",
    "beads": "fibres with beads: too few entanglements",
    "sprays": "drops: no network holds the jet together",
    "drips": "no steady jet: too little voltage, or too much flow",
    "wet deposit": "lands wet: fibres fuse or flatten",
    "clogs": "the needle is likely to clog: very volatile, or very viscous",
}
_SPRAY, _BEADS = (
    0.7,
    1.25,
)  # c/c_e (Shenoy et al., Polymer 46, 3372 (2005): fibres from about 1 entanglement a chain, smooth from 2.5)
_CLOG_VISCOSITY = 300.0  # Pa s
_THRESHOLD_SPREAD = 0.5  # sd of ln V; the theories differ by a factor of 3


@dataclass(frozen=True)
class Regime:
    """The likeliest regime, the share of the draws in each, and what to say."""

    name: str
    shares: Mapping[str, float]
    remarks: tuple[str, ...]


def threshold_voltage(surface_tension: float, radius: float, gap: float) -> float:
    """Voltage at which a drop on a needle becomes a cone, V: Taylor's balance at a hyperboloid's tip.

    ``ln(4 H/r) (gamma r/(2 eps0))^(1/2)``; within a factor of 2 of the other theories.
    """
    return float(np.log(4 * gap / radius) * np.sqrt(surface_tension * radius / (2 * EPS0)))


def regime_of(believed: Believed, recipe: Recipe, found: Fibres) -> Regime:
    """Regime of the draws.

    Drips: the chance that the voltage is below its threshold, which is known to a factor of 2. Else each draw is judged in this
    order: sprays and beads (c/c_e), wet deposit (lands before it is solid), clogs (viscosity), jets.
    """
    radius = 10 * believed.onset_radius
    ratio = np.log(recipe.voltage / threshold_voltage(believed.surface_tension, radius, recipe.gap))
    low = float(ndtr((np.log(0.6) - ratio) / _THRESHOLD_SPREAD))  # chance that the voltage is too low
    label = np.full(found.coil.size, "jets", dtype=object)
    label[found.viscosity > _CLOG_VISCOSITY] = "clogs"
    label[found.thinning.wet & (found.thinning.volume_fraction < 0.4)] = "wet deposit"
    label[found.coil < _BEADS] = "beads"
    label[found.coil < _SPRAY] = "sprays"
    shares = {name: (1 - low) * float(np.mean(label == name)) for name in REGIMES}
    shares["drips"] = low
    name = max(shares, key=lambda key: shares[key])
    remarks = [
        f"{100 * share:.0f} % chance: {REGIMES[key]}" for key, share in shares.items() if key != "jets" and share > 0.15
    ]
    return Regime(name, {key: share for key, share in shares.items() if share > 0}, tuple(remarks))
