"""What a jet with given parameters would show: radius, mean fraction, core fraction, ring by ring.

::

    z        = (z_measured - origin) / length_scale              V = V(z; k, beta) or V(z; p), 1 before the nozzle
    r        = r_0 (F / V)^(1/2)                                 F: volume left, Eqs. (43a)-(44), times `evaporation`
    mean     = phi / F                                           the polymer flux is the same everywhere
    w        = V, or sqrt(A_zz) of Maxwell's law where the strands relax with theta_0 (C(z)/C_0)^n
    core     = phi (xi_0 / xi_perp)^2 / F, at most 1             Eq. (40), left, at the force f_0 w
    r_P / r  = (mean / core)^(1/2)                               Eq. (39); no polymer outside

What is measured is `length_scale` times the radius and ``fraction_scale x fraction + fraction_offset``. Strands are
those of the solution at the nozzle; solvent that evaporates is taken from core and sheath alike. C is the mass fraction of
the polymer.

Cost per evaluation of 200 places: 0.3 ms affine, 2 ms with relaxation, 5 ms with evaporation too.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray
from spinline.fit.observations import Observation
from spinline.jetprofile.hyperbolic import Hyperbolic
from spinline.jetprofile.power_law import PowerLaw
from spinline.jetprofile.straight import StraightJet
from spinline.network.concentration import fraction_walk
from spinline.network.crossover import crossover_velocity_ratio
from spinline.network.lattice_walk import random_walk
from spinline.network.mesh import SolventQuality

if TYPE_CHECKING:
    from spinline.setup.air import Air

__all__ = ["PARAMETERS", "ForwardModel", "Parameter", "Prediction"]

_NODES = 96  # along the jet, for relaxation, beside the places asked for


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
    "evaporation": Parameter("number", 1e-6, 1e6, True, 1.0, "evaporation rate over that of Eq. (44)"),
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
    """

    radius: FloatArray
    mean: FloatArray
    core: FloatArray
    core_radius_ratio: FloatArray
    velocity_ratio: FloatArray
    stretch: FloatArray
    remaining: FloatArray


@dataclass(frozen=True)
class ForwardModel:
    """A scene as a function of its parameters.

    Attributes
    ----------
    profile : {"power-law", "hyperbolic"}
        Jet.
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
    """

    profile: Literal["power-law", "hyperbolic"]
    values: Mapping[str, float]
    length: float
    solvent_quality: SolventQuality = "theta"
    relaxation: bool = False
    relaxation_exponent: float = 1.0
    density_ratio: float = 1.0
    drying: "Air | None" = None
    notes: tuple[str, ...] = field(default=(), compare=False)

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters that change something in this model."""
        shape = ("k", "beta") if self.profile == "power-law" else ("p",)
        extra = ("flow_rate",) if self.relaxation or self.drying else ()
        time = ("relaxation_time",) if self.relaxation else ()
        loss = ("evaporation",) if self.drying else ()
        calibration = ("fraction_scale", "fraction_offset", "length_scale", "origin")
        return (*shape, "initial_radius", *extra, "volume_fraction", *time, *loss, *calibration)

    def jet(self, values: Mapping[str, float]) -> StraightJet:
        """Jet of the given parameters; those not given are the model's own."""
        p = {**self.values, **values}
        if self.profile == "power-law":
            return PowerLaw(radius=p["initial_radius"], flow_rate=p["flow_rate"], k=p["k"], beta=p["beta"])
        return Hyperbolic(radius=p["initial_radius"], flow_rate=p["flow_rate"], p=p["p"])

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
        p = {**self.values, **(values or {})}
        places, back = np.unique(np.maximum(np.atleast_1d(np.asarray(z, dtype=np.float64)), 0.0), return_inverse=True)
        jet = self.jet(p)
        if not (self.relaxation or self.drying):
            v = jet.velocity_ratio(places)
            stretch, left = v, np.ones_like(v)
        else:
            nodes = self._nodes(jet, places)
            v, stretch, left = self._along(jet, nodes, p)
            at = np.searchsorted(nodes, places)
            v, stretch, left = v[at], stretch[at], left[at]
        phi = p["volume_fraction"]
        walk = random_walk(stretch, phi, solvent_quality=self.solvent_quality)
        core = np.minimum(fraction_walk(walk, phi) / left, 1.0)
        mean = np.minimum(phi / left, 1.0)
        kept = self.drying is not None and jet.given == "radius"
        found = Prediction(
            radius=jet.initial_radius * np.sqrt((1.0 if kept else left) / v), mean=mean, core=core,
            core_radius_ratio=np.minimum(np.sqrt(mean / core), 1.0), velocity_ratio=v, stretch=stretch, remaining=left,
        )  # fmt: skip
        return Prediction(**{name: array[back] for name, array in found.__dict__.items()})

    def measured(self, data: Sequence[Observation], values: Mapping[str, float] | None = None) -> list[FloatArray]:
        """What the instruments that made `data` would have shown, calibration included; one array for each."""
        p = {**self.values, **(values or {})}
        z = np.concatenate([part.z for part in data])
        seen = self.predict((z - p["origin"]) / p["length_scale"], p)
        ends = np.cumsum([part.size for part in data])
        return [_shown(part, seen, slice(end - part.size, end), p) for part, end in zip(data, ends, strict=True)]

    def crossover(self, values: Mapping[str, float] | None = None) -> tuple[float, float]:
        """Position (m) and radius (m) where V reaches full stretch, Eq. (38); without relaxation or drying."""
        p = {**self.values, **(values or {})}
        target = float(crossover_velocity_ratio(p["volume_fraction"], self.solvent_quality))
        return float(self.jet(p).position_of(target)), p["initial_radius"] / float(np.sqrt(target))

    def _nodes(self, jet: StraightJet, places: FloatArray) -> FloatArray:
        end = float(places[-1]) if places[-1] > 0 else jet.initial_radius
        kinks = [jet.initial_radius * s for s in jet.kinks() if jet.initial_radius * s < end]
        first = kinks[0] if kinks else 0.0
        scale = max(first, 0.1 * jet.initial_radius)
        grid = first + scale * np.expm1(np.linspace(0.0, np.log1p((end - first) / scale), _NODES))
        grid[-1] = end
        nodes = np.unique(np.concatenate(([0.0], kinks, np.minimum(grid, end), places)))
        # nodes nearer than rounding to one another make no step in time: keep the places asked for
        near = np.append(np.diff(nodes) < 1e-9 * end, False) & ~np.isin(nodes, places)
        near[0] = False
        kept: FloatArray = nodes[~near]
        return kept

    def _along(
        self, jet: StraightJet, z: FloatArray, p: Mapping[str, float]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        v = jet.velocity_ratio(z)
        left = np.ones_like(v)
        if self.drying is not None:
            left = _remaining(self.drying, jet, z, p)
            if jet.given == "radius":  # kept as it dries: the jet is then slower
                return self._kept(jet, z, v, left, p)
        if not self.relaxation:
            return v, v, left
        return v, self._relaxed(jet.residence_time(z), v, left, p, jet.strain_rate(z)), left

    def _kept(
        self, jet: StraightJet, z: FloatArray, v: FloatArray, left: FloatArray, p: Mapping[str, float]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of a jet whose radius is what was measured: its velocity, hence its stretch, is less by what it lost."""
        stretch = v * left
        if self.relaxation:
            slower = 0.5 * (1 / left[1:] + 1 / left[:-1])
            time = np.concatenate(([0.0], np.cumsum(np.diff(jet.residence_time(z)) * slower)))
            stretch = self._relaxed(time, stretch, left, p, None)
        return v, stretch, left

    def _relaxed(
        self, time: FloatArray, stretch: FloatArray, left: FloatArray, p: Mapping[str, float], rate: FloatArray | None
    ) -> FloatArray:
        from spinline.rheology._element_history import ElementHistory, propagate

        phi = p["volume_fraction"]
        richer = (phi + (1 - phi) * self.density_ratio) / (phi + (left - phi) * self.density_ratio)  # C / C_0
        theta = p["relaxation_time"] * richer**self.relaxation_exponent
        history = ElementHistory.build(time, stretch, theta, rate)
        return np.sqrt(propagate(history, 2.0, 1.0))  # A_zz of `conformation`, the only one needed


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


def _remaining(air: "Air", jet: StraightJet, z: FloatArray, p: Mapping[str, float]) -> FloatArray:
    from spinline.rheology.element_path import straight_path

    faster = tuple(replace(v, saturation=v.saturation * p["evaporation"]) for v in air.volatiles)
    left = np.ones_like(z)
    path = straight_path(jet, z[1:])
    left[1:] = replace(air, volatiles=faster).evaporate(path, p["volume_fraction"]).remaining
    return left
