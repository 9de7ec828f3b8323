"""What a jet with given parameters would show: radius, mean fraction, core fraction, ring by ring.

A scene as a function of its parameters. Every prediction goes through the stages of a run (`spinline.solve.stages`), by the
rung and the effects of the scene: what a run shows at a place, a fit is held against.

::

    z        = (z_measured - origin) / length_scale
    radius, mean, core, r_P / r                     of the run at z; no polymer outside r_P
    evaporation                                     times the solvents' saturation: the rate over that of Eq. (44)

What is measured is `length_scale` times the radius and ``fraction_scale x fraction + fraction_offset``. Before the nozzle
(z < 0) the jet is as at the nozzle; beyond the scene's length a law goes on, and a network that slips stays as at its end.

Cost per evaluation of 200 places: that of a run without its words, 0.5 ms affine, 3 ms with relaxation, 6 ms with evaporation
too, 1 to 20 ms for a network that slips; 25 ms more for the jet of a needle, which is solved for every trial.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray
from spinline.base.units import Measured
from spinline.fit.observations import Observation
from spinline.network.crossover import crossover_velocity_ratio
from spinline.network.mesh import SolventQuality
from spinline.network_models.registry import cheapest, rung_of, simplest
from spinline.network_models.variables import network_variables
from spinline.rheology.solution import Solution
from spinline.scene.file import JET_SECTIONS, Scene, scene_from_dict
from spinline.scene.needle import NeedleJet
from spinline.setup.context import Context
from spinline.setup.effects import Effects
from spinline.setup.jet import build_jet
from spinline.setup.needle import NeedleSeries
from spinline.solve.stages import solve_stages

if TYPE_CHECKING:
    from spinline.jetprofile.ehd import StraightEhdJet
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.jetprofile.straight import StraightJet
    from spinline.setup.air import Air

__all__ = ["OF_NEEDLE", "PARAMETERS", "ForwardModel", "Parameter", "Prediction"]

_OF_JET = {"k": "k", "beta": "beta", "p": "p", "initial_radius": "radius", "flow_rate": "flow_rate"}  # keys of [jet]
OF_NEEDLE = {  # parameters of a needle's jet alone, and their keys of [jet]
    name: name
    for name in ("voltage", "conductivity", "surface_tension", "current", "solvent_share", "extensibility", "mobility")
}
_OF_LAWS = {  # which of them only some laws have
    "solvent_share": ("fene-p", "oldroyd-b", "giesekus"),
    "extensibility": ("fene-p",),
    "mobility": ("giesekus",),
}
_CALIBRATION = ("fraction_scale", "fraction_offset", "length_scale", "origin")


@dataclass(frozen=True)
class Parameter:
    """A quantity that can be fitted: kind and unit, range in SI, and whether its logarithm is what is fitted.

    Attributes
    ----------
    kind : str
        A key of `spinline.base.units.QUANTITIES`.
    low, high : float
        Range, SI.
    log : bool
        Fitted as a logarithm: positive, uncertain by a factor.
    scale : float
        What counts as a change of order one of the coordinate.
    words : str
        What it is.
    """

    kind: str
    low: float
    high: float
    log: bool
    scale: float
    words: str


PARAMETERS: dict[str, Parameter] = {
    "k": Parameter("number", 1e-4, 1e4, True, 1.0, "prefactor of the power law, Eq. (31)"),
    "beta": Parameter("number", 0.25, 1.0, False, 0.25, "exponent of the power law, Eq. (31)"),
    "p": Parameter("number", 1e-3, 1e6, True, 1.0, "distance of the hyperbola over r_0, Fig. 35"),
    "initial_radius": Parameter("length", 1e-9, 1e-1, True, 1.0, "r_0"),
    "flow_rate": Parameter("flow rate", 1e-24, 1e-2, True, 1.0, "Q"),
    "volume_fraction": Parameter("volume fraction", 1e-6, 0.99, True, 1.0, "phi of the solution at the nozzle"),
    "relaxation_time": Parameter("time", 1e-9, 1e6, True, 1.0, "theta_0 of the strands at the nozzle"),
    "coupling": Parameter("number", 1e-3, 1e20, True, 1.0, "alpha_v of Eq. (33), of a network that slips"),
    "evaporation": Parameter("number", 1e-6, 1e6, True, 1.0, "evaporation rate over that of Eq. (44)"),
    "viscosity": Parameter(
        "viscosity", 1e-6, 1e6, True, 1.0, "zero-shear viscosity, which the jet of a needle follows"
    ),
    "conductivity": Parameter("conductivity", 1e-15, 1e7, True, 1.0, "conductivity of the solution"),
    "surface_tension": Parameter("surface tension", 1e-8, 10.0, True, 1.0, "surface tension of the solution"),
    "voltage": Parameter("potential", 1e-2, 1e6, True, 1.0, "voltage of the needle"),
    "current": Parameter("current", 1e-17, 1e2, True, 1.0, "current of the jet"),
    "solvent_share": Parameter("fraction", 0.005, 0.999, True, 1.0, "share of the viscosity that is the solvent's"),
    "extensibility": Parameter("number", 3.01, 1e9, True, 1.0, "L2 of FENE-P"),
    "mobility": Parameter("number", 1e-9, 1.0, True, 1.0, "a of Giesekus"),
    "fraction_scale": Parameter("number", 1e-2, 1e2, True, 1.0, "measured over true polymer fraction"),
    "fraction_offset": Parameter("number", -10.0, 10.0, False, 0.1, "measured fraction where there is no polymer"),
    "length_scale": Parameter("number", 1e-2, 1e2, True, 1.0, "measured over true length"),
    "origin": Parameter("length", -1.0, 1.0, False, 1e-4, "measured z of the nozzle"),
}


@dataclass(frozen=True)
class Prediction:
    """What is predicted at some places (n,), before calibration.

    Attributes
    ----------
    radius : ndarray
        m.
    mean, core : ndarray
        Polymer volume fractions.
    core_radius_ratio : ndarray
        r_P / r.
    velocity_ratio, stretch, remaining : ndarray
        V; w, what the strands feel; F.
    relative_extension, orientation : ndarray
        Of the strands.
    """

    radius: FloatArray
    mean: FloatArray
    core: FloatArray
    core_radius_ratio: FloatArray
    velocity_ratio: FloatArray
    stretch: FloatArray
    remaining: FloatArray
    relative_extension: FloatArray
    orientation: FloatArray


@dataclass(frozen=True)
class ForwardModel:
    """A scene as a function of its parameters.

    Attributes
    ----------
    profile : str
        Of the jet: one that is made of numbers.
    values : mapping
        Parameter name to value (SI): what is not asked for otherwise.
    length : float
        Of the jet, m.
    solvent_quality : {"theta", "good"}
        Of the strands.
    relaxation : bool
        Let the strands relax; needs ``values["relaxation_time"]``.
    relaxation_exponent : float
        n of ``theta = theta_0 (C / C_0)^n``.
    density_ratio : float
        Of the solvent over the polymer: between volume and mass fractions.
    drying : Air, optional
        Let the jet dry into this air (`spinline.setup.air.build_air`).
    context : Context, optional
        Of a scene, rung and effects chosen: it then says all of this. Otherwise one is made of the above, by the simplest
        rung that holds what they ask for.
    """

    profile: str
    values: Mapping[str, float]
    length: float
    solvent_quality: SolventQuality = "theta"
    relaxation: bool = False
    relaxation_exponent: float = 1.0
    density_ratio: float = 1.0
    drying: "Air | None" = None
    notes: tuple[str, ...] = field(default=(), compare=False)
    context: Context | None = field(default=None, compare=False)

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters that change something in this model."""
        section, slips = self.base.scene.jet, rung_of(self.model).slips
        shape: tuple[str, ...] = tuple(n for n in ("k", "beta", "p") if n in type(section).model_fields)
        extra = ("flow_rate",) if self.relaxation or self.drying or slips else ()
        time = ("relaxation_time",) if self.relaxation else ()
        if isinstance(section, NeedleJet):
            laws = {name: _OF_LAWS.get(name, (section.law,)) for name in ("viscosity", *OF_NEEDLE)}
            shape = tuple(name for name, held in laws.items() if name in self.values and section.law in held)
            extra, time = ("flow_rate",), time if section.law == "newtonian" else ("relaxation_time",)
        drag = ("coupling",) if slips else ()
        loss = ("evaporation",) if self.drying else ()
        return (*shape, "initial_radius", *extra, "volume_fraction", *time, *drag, *loss, *_CALIBRATION)

    @property
    def model(self) -> str:
        """Rung of the ladder."""
        return str(self.base.scene.network.model)

    @cached_property
    def base(self) -> Context:
        """The scene at the model's own values."""
        return self.context if self.context is not None else _context_of(self)

    def at(self, values: Mapping[str, float] | None = None) -> Context:
        """The scene at other parameters; those not given are the model's own."""
        base, p = self.base, {**self.values, **(values or {})}
        section = base.scene.jet
        moved = {
            key: Measured(p[name]) for name, key in _OF_JET.items() if name in p and key in type(section).model_fields
        }
        if isinstance(section, NeedleJet):
            moved |= {key: Measured(p[name]) for name, key in OF_NEEDLE.items() if name in p}
            moved["length"] = Measured(self.length)
        changes: dict[str, Any] = {"jet": section.model_copy(update=moved)}
        if "coupling" in p:
            changes["network"] = base.scene.network.model_copy(update={"coupling": Measured(p["coupling"])})
        scene = base.scene.model_copy(update=changes)
        theta = p.get("relaxation_time", base.solution.relaxation_time)
        solution = replace(
            base.solution,
            volume_fraction=p["volume_fraction"],
            relaxation_time=theta,
            viscosity=p.get("viscosity", base.solution.viscosity),
        )
        kept: dict[str, Any] = {}
        if self.drying is not None:
            rate = p.get("evaporation", 1.0)
            faster = tuple(replace(v, saturation=v.saturation * rate) for v in self.drying.volatiles)
            kept["air"] = self.drying if rate == 1 else replace(self.drying, volatiles=faster)
        return Context(scene, solution, self._jet(scene, solution), effects=base.effects, kept=kept)

    def _jet(self, scene: Scene, solution: Solution) -> "StraightJet | LagrangianJet":
        """The jet; that of a needle over its whole reach, from a near one: a trial may look beyond the scene's length."""
        if not isinstance(scene.jet, NeedleJet):
            return build_jet(scene, solution)
        return self._needle.jet(scene.jet, scene, solution)

    @cached_property
    def _needle(self) -> NeedleSeries:
        """Of a needle: the jets of the trials."""
        return NeedleSeries(cast("StraightEhdJet", self.base.jet), self.reach)

    @property
    def solved_jet(self) -> bool:
        """Whether every trial solves for its jet, and some have none."""
        return isinstance(self.base.scene.jet, NeedleJet)

    @property
    def reach(self) -> float:
        """How far the jet is known, m."""
        if not self.solved_jet:
            return np.inf
        return cast("StraightEhdJet", self.base.jet).settings.end_position

    def predict(self, z: ArrayLike, values: Mapping[str, float] | None = None) -> Prediction:
        """Radius and fractions at true distances from the nozzle.

        Parameters
        ----------
        z : array_like, (n,)
            m, in any order; before the nozzle (z < 0) the jet is as at the nozzle.
        values : mapping, optional
            Parameters other than the model's own, SI.

        Returns
        -------
        Prediction
        """
        context = self.at(values)
        start = context.jet.start
        asked = np.maximum(np.atleast_1d(np.asarray(z, dtype=np.float64)), start)
        places, back = np.unique(np.append(asked, start), return_inverse=True)
        if places.size == 1:  # a history needs two places
            places = np.append(places, start + context.jet.initial_radius)
        answer = solve_stages(context, places, bare=True)
        f, back = answer.fields, back[:-1]
        return Prediction(
            radius=f["radius"][back],
            mean=f["mean_polymer_fraction"][back],
            core=f["core_polymer_fraction"][back],
            core_radius_ratio=np.minimum(f["network_radius"] / f["radius"], 1.0)[back],
            velocity_ratio=f["velocity_ratio"][back],
            stretch=answer.stretch[back],
            remaining=answer.remaining[back],
            relative_extension=f["relative_extension"][back],
            orientation=f["orientation"][back],
        )

    def measured(self, data: Sequence[Observation], values: Mapping[str, float] | None = None) -> list[FloatArray]:
        """What the instruments that made `data` would have shown, calibration included; one array for each."""
        p = {**self.values, **(values or {})}
        z = np.concatenate([part.z for part in data])
        seen = self.predict((z - p["origin"]) / p["length_scale"], p)
        ends = np.cumsum([part.size for part in data])
        return [_shown(part, seen, slice(end - part.size, end), p) for part, end in zip(data, ends, strict=True)]

    def crossover(self, values: Mapping[str, float] | None = None) -> tuple[float, float]:
        """Position (m) and radius (m) where V reaches full stretch, Eq. (38); without relaxation or drying."""
        context = self.at(values)
        target = float(crossover_velocity_ratio(context.solution.volume_fraction, self.solvent_quality))
        return float(context.jet.position_of(target)), context.jet.initial_radius / float(np.sqrt(target))

    def core_at(self, velocity_ratio: ArrayLike) -> FloatArray:
        """Core fraction of a network that moves with the solution, stretched by V: the network stage alone."""
        n, solution, v = self.base.scene.network, self.base.solution, np.asarray(velocity_ratio, dtype=np.float64)
        found = network_variables(
            v,
            v,
            np.ones_like(v),
            self.values["volume_fraction"],
            closure=n.closure_used,
            solvent_quality=n.solvent_quality,
            kuhn_length=solution.kuhn_length,
            temperature=solution.temperature,
        )
        core: FloatArray = found["core_polymer_fraction"]
        return core


def _context_of(model: ForwardModel) -> Context:
    """Context of a model that is given by its values alone."""
    p = model.values
    relaxing = cheapest(["relaxation"])
    rung = relaxing if model.relaxation and relaxing is not None else simplest()
    keys = JET_SECTIONS[model.profile].model_fields
    jet = {key: Measured(p[name]) for name, key in _OF_JET.items() if name in p and key in keys}
    solution: dict[str, Any] = {
        "polymer": {"density": Measured(1000.0)},
        "solvent": {"density": Measured(1000.0 * model.density_ratio)},
        "volume_fraction": Measured(p["volume_fraction"]),
    }
    if model.relaxation:
        solution["relaxation_time"] = Measured(p["relaxation_time"])
    scene: Scene = scene_from_dict(
        {
            "solution": solution,
            "jet": {**jet, "profile": model.profile, "length": Measured(model.length)},
            "network": {"model": rung.name, "solvent_quality": model.solvent_quality},
            "rheology": {"n": float(model.relaxation_exponent)},
        }
    )
    effects = Effects({"relaxation": model.relaxation, "evaporation": model.drying is not None})
    kept = {} if model.drying is None else {"air": model.drying}
    return Context(scene, effects=effects, kept=kept)


def _shown(data: Observation, seen: Prediction, part: slice, p: Mapping[str, float]) -> FloatArray:
    if data.kind == "radius":
        return p["length_scale"] * seen.radius[part]
    return p["fraction_scale"] * _fraction(data, seen, part) + p["fraction_offset"]


def _fraction(data: Observation, seen: Prediction, part: slice) -> FloatArray:
    if data.kind == "mean":
        return seen.mean[part]
    core = seen.core[part]
    if data.kind == "chord":
        through: FloatArray = core * seen.core_radius_ratio[part]
        return through
    if data.inner is None or data.outer is None:
        return core
    edge = np.clip(seen.core_radius_ratio[part], data.inner, data.outer)  # where the core ends within the ring
    value: FloatArray = core * (edge**2 - data.inner**2) / (data.outer**2 - data.inner**2)
    return value
