"""Settings of a jet that is spun, and of a laydown, that no line has: said before either runs, which have no network to ask.

As in `spinline.plan.plausible`, nothing is refused: a number a thousand times off is nearly always a unit.
"""

from collections.abc import Mapping

from spinline.base.units import Measured
from spinline.plan.plausible import Usual, said
from spinline.scene.mat_file import MatScene
from spinline.scene.sections import Scene
from spinline.scene.spun import SpunJet

__all__ = ["odd_laydown", "odd_spinning"]

_COARSE = 0.02  # of the gap: an element that is longer leaves out the bending
_LAID: Mapping[str, Usual] = {
    "laydown.diameter": Usual(5e-9, 5e-5, "um", 1e-6, "electrospun fibres have 0.05 to 10 um"),
    "laydown.speed": Usual(0.05, 5e3, "m/s", 1.0, "a needle makes 1 to 500 m of fibre a second"),
    "laydown.spread": Usual(1e-5, 0.5, "mm", 1e-3, "footprints have tenths of a millimetre to 10 cm"),
    "collector.distance": Usual(1e-3, 1.0, "cm", 1e-2, "collectors stand 5 to 30 cm away"),
    "mat.slope": Usual(0.0, 2.0, "", 1.0, "fibres hang between their supports at 0.02 to 1"),
}


def odd_spinning(scene: Scene, jet: SpunJet) -> list[str]:
    """What of a jet's settings is unlike any spinning line, and what its scene says that no spun jet takes.

    Parameters
    ----------
    scene : Scene
    jet : SpunJet
        Of the scene.

    Returns
    -------
    list of str
    """
    given = {
        "nozzle radius": jet.radius,
        "flow rate": jet.flow_rate,
        "voltage": jet.voltage,
        "gap": jet.gap,
        "conductivity": jet.conductivity,
        "viscosity": scene.solution.viscosity,
        "relaxation time": scene.solution.relaxation_time,
    }
    words = [said(name, one.value) for name, one in given.items() if isinstance(one, Measured)]
    if jet.element_length is not None and jet.element_length.value > _COARSE * jet.gap.value:
        words.append(
            f"elements of {1e3 * jet.element_length.value:.3g} mm are long for a gap of {1e2 * jet.gap.value:.3g} cm: a jet "
            "bends within a millimetre, and numbers want elements of 0.2 mm or less (jet.element_length)"
        )
    for name, place in (("collector", "jet.gap, jet.collector"), ("jets", "jet.jets, jet.jet_spacing")):
        if getattr(scene, name) is not None:
            words.append(f"[{name}] is of blown jets and of laydowns, and not used: a spun jet has {place}")
    return [one for one in words if one]


def odd_laydown(scene: MatScene) -> list[str]:
    """What of a laydown is unlike any.

    Parameters
    ----------
    scene : MatScene

    Returns
    -------
    list of str
    """
    laid = scene.laydown
    given = {
        "laydown.diameter": laid.diameter,
        "laydown.speed": laid.speed,
        "laydown.spread": laid.spread,
        "collector.distance": scene.collector.distance,
        "mat.slope": scene.mat.slope,
    }
    words = [said(name, one.value, _LAID) for name, one in given.items()]
    if laid.diameter_deviation is not None and laid.diameter_deviation.value > laid.diameter.value:
        words.append("laydown.diameter_deviation is more than the diameter itself: check their units")
    if laid.step is not None and laid.step.value > laid.turning_length.value:
        words.append(
            "laydown.step is longer than turning_length: its turns are not followed; take a tenth of it or less"
        )
    return [one for one in words if one]
