"""What decides whether the settings give a steady thinning jet, as numbers with a limit and a sentence.

==================  ==================================================================================================
``elastic``         theta times the largest strain rate of the viscous jet: above 1/2 the polymer's elasticity rules
``cone``            V1 = F0 / (pi r_0^2 G), the jump of V at the needle: above 1 / phi full stretch lies in the cone
``held``            pull against capillarity, ``F0 / (pi gamma r_0)``: below 0.1 it drips, though a steady thread exists
``needle_tension``  tension at the needle, N: not positive, the jet swells in place of thinning
``relaxation``      charge relaxation length over the length in which the jet thins: above 1 it is a dielectric
``conducted``       share of the current still conducted at the end: above 0.1 the predicted current depends on L
``inertia``         Re max(V): above 1 inertia, below it viscosity or elasticity, bounds the speed
``beads``           growth of capillary waves ``int w dz / v``: above 5 with ``w theta < 1``, beads or drops
``end``             share of the tension at the needle that the condition at the end makes (`end_pull`): above 1/2, or where
                    the end draws a neck into the thread, widen the end; above 0.9 the scene is refused
``fold``            relaxation time (s) beyond which the branch of steady jets ends
==================  ==================================================================================================
"""

from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.jetprofile.ehd.end_pull import LIMIT, EndPull

__all__ = ["Verdict", "judge"]


@dataclass(frozen=True)
class Verdict:
    """One number that decides.

    Attributes
    ----------
    name : str
        Of the table above.
    value, limit : float
        The number and where it changes what happens.
    good : bool
        Whether a steady thinning jet within the theory is expected as far as this number goes.
    text : str
        What it says, in a sentence.
    """

    name: str
    value: float
    limit: float
    good: bool
    text: str

    def __str__(self) -> str:
        return f"{self.name} = {self.value:.4g} (limit {self.limit:.4g}): {self.text}"


def _pick(value: float, limit: float, above: str, below: str) -> str:
    return above if value > limit else below


def judge(
    *,
    z: FloatArray,
    velocity_ratio: FloatArray,
    tension: FloatArray,
    conducted: FloatArray,
    capillary_growth: FloatArray,
    relaxation_time: float,
    viscous_strain_rate: float,
    modulus: float,
    radius: float,
    initial_velocity: float,
    surface_tension: float,
    reynolds: float,
    relaxation_length: FloatArray,
    full_stretch: float,
    fold: float,
    end: EndPull,
) -> tuple[Verdict, ...]:
    """Verdicts of a computed jet, from its columns along z (m) and the numbers of its settings (SI)."""
    found = []
    elastic = relaxation_time * viscous_strain_rate
    words = _pick(elastic, 0.5, "elastic: V = V1 + s / De", "viscous: the polymer hardly resists")
    found.append(Verdict("elastic", elastic, 0.5, True, words))
    start = float(tension[0])
    if relaxation_time > 0:
        jump = start / (np.pi * radius**2 * modulus)
        words = _pick(
            jump, full_stretch, "full stretch lies in the cone, outside this theory", "stretched along the jet"
        )
        found.append(Verdict("cone", jump, full_stretch, jump <= full_stretch, words))
    held = start / (np.pi * surface_tension * radius)
    words = _pick(held, 0.1, "pulled free of capillarity", "held by capillarity: it drips")
    found.append(Verdict("held", held, 0.1, held > 0.1, words))
    words = _pick(start, 0.0, "under tension", "the jet swells: no thinning jet at these settings")
    found.append(Verdict("needle_tension", start, 0.0, start > 0, words))
    thinning = np.gradient(np.log(velocity_ratio), z)
    lag = float(np.max(relaxation_length * thinning))
    words = _pick(lag, 1.0, "charge relaxes more slowly than the jet thins: a dielectric", "a leaky conductor")
    found.append(Verdict("relaxation", lag, 1.0, True, words))
    share = float(conducted[-1])
    words = _pick(
        share, 0.1, "the current depends on the end: widen it, or give the current", "the charge has left the bulk"
    )
    found.append(Verdict("conducted", share, 0.1, share <= 0.1, words))
    inertia = reynolds * float(velocity_ratio.max())
    words = _pick(inertia, 1.0, "inertia bounds the speed", "viscous or elastic throughout")
    found.append(Verdict("inertia", inertia, 1.0, True, words))
    rate = capillary_growth / (initial_velocity * velocity_ratio)
    grown = float(np.sum(0.5 * (rate[1:] + rate[:-1]) * np.diff(z)))
    slow = float(capillary_growth.max()) * relaxation_time
    drops = grown > 5 and slow < 1
    words = "beads or drops: a spray, not a fibre" if drops else "capillary waves do not break it"
    found.append(Verdict("beads", grown, 5.0, not drops, words))
    words = "field and weight draw it"
    if end.rules:
        most, neck = (
            "most of the tension is made by the condition at the end",
            "the condition at the end draws a neck into it",
        )
        words = _pick(end.share, LIMIT, most, neck) + ": widen the end"
    found.append(Verdict("end", end.share, LIMIT, not end.rules, words))
    if np.isfinite(fold):
        found.append(Verdict("fold", fold, fold, True, f"no steady jet beyond a relaxation time of {fold:.4g} s"))
    return tuple(found)
