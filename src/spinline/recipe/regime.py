"""What comes out of the needle: fibres, beads, a spray, drops, a wet mat; and the number that says so."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from spinline.jetprofile.ehd.thresholds import threshold_voltage
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
    "clogs": "too viscous for the pump and the needle",
}
# c/c_e (Shenoy et al., Polymer 46, 3372 (2005): with two entanglements a chain at c_e, fibres among beads from some 1.4,
# none but fibres from 2.5). McKee et al., Macromolecules 37, 1760 (2004) see the last beads go at 2 to 2.5 c_e: beads that
# few are no failure here.
_SPRAY, _BEADS = 0.7, 1.25
_PUMP = 2e6  # Pa that a syringe pump can push (some 200 N on 1 cm2)
_NEEDLE = 0.025  # m, length
_LEAST_SPREAD = 0.3  # sd of ln V of the threshold


@dataclass(frozen=True)
class Regime:
    """The likeliest regime, the share of the draws in each, and what to say."""

    name: str
    shares: Mapping[str, float]
    remarks: tuple[str, ...]


def onset_voltage(surface_tension: float, radius: float, gap: float) -> tuple[float, float]:
    """Voltage at which a needle begins to spin, V, and the sd of its logarithm: the middle and the spread of the theories'."""
    theories = threshold_voltage(
        surface_tension=surface_tension, radius=radius, gap=gap, needle_length=_NEEDLE, closed=True
    )
    values = np.log(list(theories.values()))
    return float(np.exp(values.mean())), max(float(values.std()), _LEAST_SPREAD)


def regime_of(believed: Believed, recipe: Recipe, found: Fibres) -> Regime:
    """Regime of the draws.

    Drips: the chance that the voltage is below its threshold, on which the theories differ threefold. Else each draw is
    judged in this order: sprays and beads (c/c_e), wet deposit (lands before it is solid), clogs (the pump cannot push it
    through the needle), jets.
    """
    onset, spread = onset_voltage(believed.surface_tension, believed.needle_radius, recipe.gap)
    low = float(ndtr(np.log(onset / recipe.voltage) / spread))  # chance that the voltage is too low
    pressure = 8 * found.viscosity * _NEEDLE * recipe.flow_rate / (np.pi * believed.needle_radius**4)
    label = np.full(found.coil.size, "jets", dtype=object)
    label[pressure > _PUMP] = "clogs"
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
