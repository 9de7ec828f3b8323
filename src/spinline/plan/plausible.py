"""Sizes that no spinning line has: said before anything runs, each with what is usual and the slip that makes such a number.

Nothing here is refused: a model may be asked about any jet. A number a thousand times off is nearly always a unit, a nozzle's
diameter for its radius, or beads in the order from the collector to the nozzle.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spinline.base.checks import FloatArray
from spinline.scene.file import PowerLawJet
from spinline.scene.needle import NeedleJet
from spinline.scene.spun import SpunJet
from spinline.setup.context import Context

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["Usual", "implausible", "said"]


class Usual(NamedTuple):
    """What spinning lines have.

    Attributes
    ----------
    low, high : float
        SI; outside it is said.
    unit : str
    scale : float
        Of the unit in SI.
    words : str
        What is usual.
    """

    low: float
    high: float
    unit: str
    scale: float
    words: str


_SOUND = 343.0  # m/s, in air at 293 K
_USUAL = {
    "nozzle radius": Usual(5e-6, 3e-3, "um", 1e-6, "spinnerets have 50 um to 1 mm"),
    "flow rate": Usual(1.4e-12, 1.4e-7, "mL/hour", 1e-6 / 3600, "needles give 0.01 to 100 mL/hour"),
    "k": Usual(1e-3, 100.0, "", 1.0, "measured jets have 0.2 to 3"),
    "electric field": Usual(1e3, 1e7, "kV/cm", 1e5, "0.3 to 3 kV/cm is usual, and air breaks down at 30"),
    "voltage": Usual(200.0, 1e5, "kV", 1e3, "needles are at 5 to 30 kV"),
    "gap": Usual(5e-3, 1.0, "cm", 1e-2, "collectors stand 5 to 30 cm away"),
    "conductivity": Usual(1e-10, 10.0, "mS/m", 1e-3, "solutions that are spun have 1e-5 to 500 mS/m"),
    "length": Usual(0.0, 2.0, "m", 1.0, "collectors stand 5 to 30 cm away"),
    "viscosity": Usual(5e-3, 500.0, "Pa s", 1.0, "solutions that are spun have 0.05 to 50 Pa s"),
    "relaxation time": Usual(1e-5, 100.0, "s", 1.0, "solutions that are spun have 1 ms to 1 s"),
}
_THINNER, _THICKER = 30.0, 1.5  # of the first element against the nozzle
_GROWS = 2.0  # of the radius from the jet's start to its end
_SHORTEST = 2.0  # nozzle radii
_BACK = 0.2  # of the beads; half and more where they stand in no order


def implausible(context: Context) -> list[str]:
    """What of a scene's sizes is unlike any spinning line.

    Parameters
    ----------
    context : Context

    Returns
    -------
    list of str
        Sentences, each with the number, what is usual and what to look at.
    """
    scene, section = context.scene, context.scene.jet
    found: dict[str, float] = {"nozzle radius": float(context.jet.initial_radius)}
    if context.straight:
        found |= {"flow rate": context.line.flow_rate, "length": context.length}
    if isinstance(section, PowerLawJet):
        if section.k is not None:
            found["k"] = section.k.value
        if section.electric_field is not None:
            found["electric field"] = section.electric_field.value
    if isinstance(section, NeedleJet | SpunJet):
        settings = {name: getattr(section, name) for name in ("voltage", "gap", "conductivity")}
        found |= {name: one.value for name, one in settings.items() if one is not None}
    if context.solution.viscosity is not None:
        found["viscosity"] = context.solution.viscosity
    theta = scene.solution.relaxation_time
    if theta is not None and theta != "estimate":
        found["relaxation time"] = theta.value
    odd = [words for name, value in found.items() if (words := said(name, value))]
    if context.straight and context.length < _SHORTEST * context.jet.initial_radius:
        radii = context.length / float(context.jet.initial_radius)
        odd.append(
            f"the jet is followed over {radii:.2g} nozzle radii only, and what is said of its end is said of that; "
            "check the unit of its length"
        )
    return odd + (_fast(context) if context.straight else _beads(context.beads))


def said(name: str, value: float, table: Mapping[str, Usual] | None = None) -> str:
    """What to say of a size that is out of the usual, "" of any other.

    Parameters
    ----------
    name : str
        In the table.
    value : float
        SI.
    table : mapping, optional
        What is usual; by default of a jet.
    """
    usual = (_USUAL if table is None else table)[name]
    if usual.low <= value <= usual.high:
        return ""
    return (
        f"{name} {value / usual.scale:.3g} {usual.unit}".rstrip()
        + f" is out of the usual: {usual.words}; check its unit"
    )


def _fast(context: Context) -> list[str]:
    end = float(context.line.velocity(context.length))
    if end < _SOUND:
        return []
    return [
        f"at its end the jet moves at {end:.3g} m/s, faster than sound in air ({_SOUND:g} m/s): check radius, flow rate, "
        "k and length"
    ]


def _beads(jet: "LagrangianJet") -> list[str]:
    one = jet if jet.time is None else jet.at()
    radius: FloatArray = one.element_radius[one.usable]
    if radius.size < 4:
        return []
    told = []
    some = max(1, radius.size // 10)
    first, last = float(np.median(radius[:some])), float(np.median(radius[-some:]))
    if last > _GROWS * first:
        told.append(
            f"the jet thickens along its arc, from {1e6 * first:.3g} to {1e6 * last:.3g} um: are its beads in the order "
            "from the collector to the nozzle? Turn the table round"
        )
    there = np.isfinite(one.x)
    steps = np.diff(np.column_stack([one.x[there], one.y[there], one.z[there]]), axis=0)
    turns = np.sum(steps[1:] * steps[:-1], axis=1)
    back = float(np.mean(turns < -0.5 * np.linalg.norm(steps[1:], axis=1) * np.linalg.norm(steps[:-1], axis=1)))
    if back > _BACK:
        told.append(
            f"at {100 * back:.0f} % of its beads the jet turns back by more than 120 degrees: are they in the order from the "
            "nozzle on? Sort them"
        )
    ratio = one.initial_radius / float(radius[0])
    if ratio > _THINNER or ratio < 1 / _THICKER:
        told.append(
            f"the nozzle's radius is {1e6 * one.initial_radius:.3g} um, the first element's {1e6 * float(radius[0]):.3g} um, "
            f"{ratio:.3g} times less: is jet.radius (or the run's) that of this nozzle, in this unit?"
            if ratio > 1
            else f"the first element's radius is {1e6 * float(radius[0]):.3g} um, thicker than the nozzle's "
            f"{1e6 * one.initial_radius:.3g} um: a diameter for a radius?"
        )
    return told
