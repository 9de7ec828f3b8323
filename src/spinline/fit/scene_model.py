"""A scene as a function of its parameters: the forward model of a fit, and where to start."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from spinline.base.errors import InputError
from spinline.base.units import Measured
from spinline.fit.model import OF_NEEDLE, ForwardModel
from spinline.network_models.registry import RUNGS, cheapest, rung_in
from spinline.scene.file import HyperbolicJet, PowerLawJet, Scene
from spinline.scene.needle import NeedleJet
from spinline.setup.context import Context
from spinline.solve.spine import chosen

if TYPE_CHECKING:
    from spinline.jetprofile.ehd import StraightEhdJet

__all__ = ["forward_model", "start_of", "typical_relaxation_time"]


def forward_model(
    scene: Scene,
    *,
    relaxation: bool | None = None,
    evaporation: bool | None = None,
    values: Mapping[str, float] | None = None,
) -> ForwardModel:
    """Forward model of a scene: its rung, its effects, as `spinline.run` takes them.

    Parameters
    ----------
    scene : Scene
        With a power-law or hyperbolic jet, or that of a needle.
    relaxation, evaporation : bool, optional
        Model them, or do not, whatever a run would do.
    values : mapping, optional
        Parameters in place of the scene's, SI.

    Returns
    -------
    ForwardModel

    Raises
    ------
    InputError
        For a jet without parameters, or what an effect needs and the scene does not say.
    """
    asked, notes = _asked(scene, relaxation, evaporation, dict(values or {}))
    context, _ = chosen(Context(asked))
    solution, jet = context.solution, context.jet
    own = {
        "initial_radius": jet.initial_radius,
        "flow_rate": context.line.flow_rate,
        "volume_fraction": solution.volume_fraction,
        "evaporation": 1.0,
        "fraction_scale": 1.0,
        "fraction_offset": 0.0,
        "length_scale": 1.0,
        "origin": 0.0,
    }
    own |= {name: getattr(jet, name) for name in ("k", "beta", "p") if hasattr(jet, name)}
    if isinstance(asked.jet, NeedleJet):
        given = {name: getattr(asked.jet, key) for name, key in OF_NEEDLE.items()}
        own |= {name: measured.value for name, measured in given.items() if measured is not None}
        if solution.viscosity is not None:
            own["viscosity"] = solution.viscosity
    if solution.relaxation_time is not None:
        own["relaxation_time"] = solution.relaxation_time
    if asked.network.coupling is not None:
        own["coupling"] = asked.network.coupling.value
    rung = rung_in(context.scene.network)
    if rung.sampled:
        notes += (f"the fit runs network.model = {rung.name!r} ({rung.cost}) for every trial",)
    return ForwardModel(
        profile=asked.jet.profile,
        values=own | dict(values or {}),
        length=context.length,
        solvent_quality=asked.network.solvent_quality,
        relaxation=context.effects.relaxation,
        drying=context.air if context.effects.evaporation else None,
        notes=notes,
        context=context,
    )


def _asked(
    scene: Scene, relaxation: bool | None, evaporation: bool | None, values: dict[str, float]
) -> tuple[Scene, tuple[str, ...]]:
    """The scene with what the fit asks of it: switches, a rung that can hold them, values that are not its own."""
    if not isinstance(scene.jet, PowerLawJet | HyperbolicJet | NeedleJet):
        raise InputError(
            "jet.profile",
            "has no parameters to fit",
            value=scene.jet.profile,
            allowed='"power-law", "hyperbolic", "needle"',
            remedy="fit-jet finds k and beta of a table",
        )
    changes: dict[str, Any] = {}
    notes: tuple[str, ...] = ()
    if relaxation and "relaxation_time" in values:
        theta = Measured(values["relaxation_time"])
        changes["solution"] = scene.solution.model_copy(update={"relaxation_time": theta})
    elif relaxation and scene.solution.relaxation_time is None:
        raise InputError(
            "solution.relaxation_time",
            "is missing: relaxation needs it",
            remedy='give it, or relaxation_time = "free" in the fit',
        )
    switches = {"relaxation": relaxation, "evaporation": evaporation}
    update = {key: value for key, value in switches.items() if value is not None}
    if evaporation is False:
        update["radial"] = False
    network, model, able = scene.network, scene.network.model, cheapest(["relaxation"])
    if relaxation and model in RUNGS and not rung_in(network).relaxes and able is not None:
        notes = (f"network.model = {model!r} has no relaxation: the fit takes {able.name!r}",)
        network = network.model_copy(update={"model": able.name})
    if relaxation is False and model in RUNGS and rung_in(network).relaxes:
        update.pop("relaxation")  # the rung is relaxation
    if "coupling" in values:
        network = network.model_copy(update={"coupling": Measured(values["coupling"])})
    if isinstance(scene.jet, NeedleJet):  # the fit starts from the jet of its own values
        if "viscosity" in values:
            section = changes.get("solution", scene.solution)
            changes["solution"] = section.model_copy(update={"viscosity": Measured(values["viscosity"])})
        moved = {key: Measured(values[name]) for name, key in OF_NEEDLE.items() if name in values}
        changes["jet"] = scene.jet.model_copy(update=moved)
    changes |= {"effects": scene.effects.model_copy(update=update), "network": network}
    return scene.model_copy(update=changes), notes


def typical_relaxation_time(scene: Scene) -> float:
    """Time in s over which the middle of a scene's jet is stretched by e: where a fit starts when nothing is known.

    The jet of a needle needs a time to be known at all: that in which the solution moves on by a radius (De = 1).
    """
    if isinstance(scene.jet, NeedleJet):
        return float(np.pi * scene.jet.radius.value**3 / scene.jet.flow_rate.value)
    if not isinstance(scene.jet, PowerLawJet | HyperbolicJet):
        raise InputError("jet.profile", "has no parameters to fit", value=scene.jet.profile)
    jet = Context(scene).line
    middle = 0.5 * scene.jet.length.value
    rate = float(jet.strain_rate(middle))
    return 1 / rate if rate > 0 else scene.jet.length.value / jet.initial_velocity


def start_of(scene: Scene, name: str) -> float | None:
    """Where the fit of a parameter starts that the scene does not give; None where it gives it, or none is needed.

    Raises
    ------
    InputError
        Where the scene lacks what the start is computed from.
    """
    if name == "coupling" and scene.network.coupling is None:
        return float(Context(scene).coupling.required())
    if name == "relaxation_time" and scene.solution.relaxation_time is None:
        return typical_relaxation_time(scene)
    if isinstance(scene.jet, NeedleJet) and name in ("current", "extensibility") and getattr(scene.jet, name) is None:
        jet = cast("StraightEhdJet", Context(scene).jet)
        return jet.current if name == "current" else jet.settings.extensibility
    return None
