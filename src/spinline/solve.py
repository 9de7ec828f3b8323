"""From a scene to a result: solution, jet on a grid, network along it, crossover, one Dataset.

Data goes one way. What a scene needs is built by `build_solution` and `build_jet`; `examine` says what is odd about them
before anything runs; `run` puts the closed forms along the jet and names everything as the design does.
"""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.checks import FloatArray
from spinline.errors import InputError, SpinlineWarning
from spinline.jetprofile.hyperbolic import Hyperbolic
from spinline.jetprofile.k_estimate import estimate_k
from spinline.jetprofile.power_law import PowerLaw
from spinline.jetprofile.straight import StraightJet
from spinline.network.affine import affine_network
from spinline.network.concentration import compaction_velocity_ratio
from spinline.network.coupling import affinity, elastic_coupling, strand_force
from spinline.network.crossover import crossover_velocity_ratio, extension_velocity_ratio
from spinline.network.mesh import network_at_rest
from spinline.rheology.materials import Polymer, polymer, solvent_viscosity
from spinline.rheology.solution import Solution
from spinline.scene import (
    HyperbolicJet,
    JetspinJet,
    LagrangianJetFile,
    PolymerData,
    PowerLawJet,
    Scene,
    SolventData,
    TableJet,
)
from spinline.units import Measured

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.lagrangian import LagrangianJet

__all__ = ["Crossover", "build_jet", "build_solution", "crossover", "examine", "run"]

_BOND_STRENGTH = 5e-9  # N, covalent bond


@dataclass(frozen=True)
class Crossover:
    """Where the network is fully stretched.

    Attributes
    ----------
    velocity_ratio : float
        V of the criterion.
    position, radius : float
        m; NaN where the jet does not reach it. Along a bead jet the position is the arc length.
    radius_ratio : float
        r / r_0; NaN likewise.
    predicted : float
        Position if the profile went on beyond the jet's length; NaN where it cannot be said.
    """

    velocity_ratio: float
    position: float
    radius: float
    radius_ratio: float
    predicted: float


def build_solution(scene: Scene) -> Solution:
    """Solution of a scene, built-in properties filled in."""
    s = scene.solution
    data: Polymer
    if isinstance(s.polymer, PolymerData):
        data = Polymer(
            name=s.polymer.name,
            density=s.polymer.density.value,
            repeat_unit_molar_mass=_value(s.polymer.repeat_unit_molar_mass, float("nan")),
            backbone_bonds=s.polymer.backbone_bonds or 0,
        )
    else:
        data = polymer(s.polymer, "solution.polymer")
    density = _value(s.solvent_density)
    solvent: Any = s.solvent
    if isinstance(s.solvent, SolventData):
        density = s.solvent.density.value if density is None else density
        solvent = s.solvent.name
    return Solution.build(
        data,
        solvent,
        mass_fraction=_value(s.mass_fraction),
        volume_fraction=_value(s.volume_fraction),
        temperature=s.temperature.value,
        polymer_density=_value(s.polymer_density),
        solvent_density=density,
        kuhn_length=s.kuhn_length.value,
        molar_mass=_value(s.molar_mass),
        viscosity=_value(s.viscosity),
        relaxation_time=_value(s.relaxation_time),
        field="solution.",
    )


def build_jet(scene: Scene, solution: Solution) -> "StraightJet | LagrangianJet":
    """Jet of a scene: analytic, tabulated or imported."""
    j = scene.jet
    if isinstance(j, PowerLawJet):
        k = _value(j.k)
        if k is None:
            if solution.viscosity is None:
                raise InputError("solution.viscosity", "is missing: the estimate of k needs it", remedy="give it, or k")
            assert j.conductivity is not None
            assert j.electric_field is not None
            k = float(
                estimate_k(
                    radius=j.radius.value,
                    flow_rate=j.flow_rate.value,
                    conductivity=j.conductivity.value,
                    viscosity=solution.viscosity,
                    electric_field=j.electric_field.value,
                )
            )
        return PowerLaw(radius=j.radius.value, flow_rate=j.flow_rate.value, k=k, beta=j.beta.value)
    if isinstance(j, HyperbolicJet):
        return Hyperbolic(radius=j.radius.value, flow_rate=j.flow_rate.value, p=j.p.value)
    path = scene.folder / j.path
    if not path.exists():
        raise InputError("jet.path", "does not exist", value=j.path, remedy="paths start from the scene's folder")
    if isinstance(j, TableJet):
        from spinline.jetprofile.table import Table

        return Table.from_csv(path, flow_rate=j.flow_rate.value, initial_radius=_value(j.radius))
    from spinline.jetprofile.lagrangian import LagrangianJet

    beads: LagrangianJet
    if isinstance(j, LagrangianJetFile):
        beads = LagrangianJet.from_csv(path, initial_radius=_value(j.radius))
    else:
        beads = LagrangianJet.from_dataset(_jet_dataset(j, path))
    if j.time == "all":
        return beads
    return beads.at(None if isinstance(j.time, str) else j.time.value)


def examine(scene: Scene, solution: Solution, jet: "StraightJet | LagrangianJet") -> list[str]:
    """What is odd about a scene: every remark is a sentence with its number.

    Raises
    ------
    InputError
        For what this version cannot do.
    """
    n = scene.network
    if n.model not in ("auto", "affine"):
        raise InputError("network.model", "is not available", value=n.model, allowed='"auto", "affine"', remedy=_TAKE)
    if n.force_law != "lattice":
        raise InputError("network.force_law", "is not available", value=n.force_law, allowed='"lattice"', remedy=_TAKE)
    for name, switch in scene.effects:
        if switch is True:
            raise InputError(f"effects.{name}", "is not available", value=True, allowed='"auto", false', remedy=_TAKE)
    phi = solution.volume_fraction
    rest = network_at_rest(phi, n.solvent_quality)
    remarks = []
    strands = solution.strands_per_chain(float(rest.segments))
    if strands < 2:
        remarks.append(
            f"no network: a chain of {solution.molar_mass:g} kg/mol makes {strands:.2g} strands of {rest.segments:.3g} "
            "Kuhn segments; two or more are needed. Raise the concentration or the molar mass"
        )
    if isinstance(scene.jet, PowerLawJet) and scene.jet.k is None and isinstance(jet, PowerLaw):
        remarks.append(f"k = {jet.k:.4g} is estimated from the process, to a factor of order one")
    compact, full = float(compaction_velocity_ratio(phi, n.solvent_quality)), float(rest.full_stretch)
    if compact < full:
        remarks.append(
            f"the core is compact (V = {compact:.4g}) before the network is fully stretched (V = {full:.4g})"
        )
    if isinstance(jet, StraightJet):
        eps = _coupling_error(scene, solution, jet)
        if eps > scene.accuracy.rtol:
            remarks.append(
                f"the affine network errs by about {eps:.2g} in its velocity (largest c V'/alpha_v), more than rtol = "
                f"{scene.accuracy.rtol:g}"
            )
        if solution.relaxation_time is not None:
            place = float(np.fmin(jet.position_of(full), _length(scene, jet)))
            deborah = solution.relaxation_time * float(jet.strain_rate(place))
            if deborah < 1 / scene.accuracy.rtol:
                remarks.append(
                    f"relaxation is left out: De = {deborah:.3g} at the crossover (or the end of the jet), so the affine "
                    f"stretch errs by about {min(1.0, 1 / deborah) if deborah else 1.0:.2g}"
                )
    for name in ("ambient", "rheology"):
        if getattr(scene, name) is not None:
            remarks.append(f"[{name}] is checked but not used: evaporation and relaxation are not modelled")
    return remarks


def crossover(scene: Scene, jet: "StraightJet | LagrangianJet", velocity_ratio: float) -> Crossover:
    """First place along the jet where V passes a value."""
    if not isinstance(jet, StraightJet) and jet.time is not None:
        raise InputError("jet.time", "holds many times", remedy="take one")
    predicted = float(jet.position_of(velocity_ratio)) if velocity_ratio > 0 else float("nan")
    end = _length(scene, jet) if isinstance(jet, StraightJet) else float("inf")
    if not predicted <= end * (1 + 1e-12):
        nan = float("nan")
        return Crossover(velocity_ratio, nan, nan, nan, predicted)
    place = min(predicted, jet.end) if isinstance(jet, StraightJet) else predicted
    radius = float(jet.radius(place))
    return Crossover(velocity_ratio, predicted, radius, radius / jet.initial_radius, predicted)


def run(scene: Scene) -> "xr.Dataset":
    """Jet, network, concentration and crossover of a scene.

    Parameters
    ----------
    scene : Scene
        From `load_scene`.

    Returns
    -------
    xarray.Dataset
        Along `z`, or along `element` (and `time`) for bead jets; names, units and attributes as documented.

    Raises
    ------
    InputError
        For a scene that cannot be computed.

    Warns
    -----
    SpinlineWarning
        One for each remark of `examine`; they are in the attribute ``warnings`` too.

    Notes
    -----
    Closed forms: about 1 ms for 401 points. Errors against Eqs. (36)-(40) are of rounding; those of the affine model
    itself are estimated in the attribute ``model_reason``.
    """
    from spinline import results

    solution = build_solution(scene)
    jet = build_jet(scene, solution)
    remarks = examine(scene, solution, jet)
    phi, quality = solution.volume_fraction, scene.network.solvent_quality
    targets = {
        "crossover": float(crossover_velocity_ratio(phi, quality)),
        "crossover_extension": float(
            extension_velocity_ratio(
                scene.network.crossover_extension.value,
                phi,
                closure=scene.network.closure,
                solvent_quality=quality,
            )
        ),
    }
    frames = _frames(jet)
    found = {name: [crossover(scene, frame, target) for frame in frames] for name, target in targets.items()}
    if isinstance(jet, StraightJet):
        profile = _straight_profile(scene, jet, [c[0].position for c in found.values()])
    else:
        profile = _bead_profile(jet)
    fields = profile | _network_fields(profile, scene, solution)
    forces = fields["strand_force"]
    if np.nanmax(forces, initial=0.0) > _BOND_STRENGTH:
        remarks.append(
            f"the strand force reaches {np.nanmax(forces):.2g} N, more than a covalent bond holds ({_BOND_STRENGTH:g} N): "
            "chains break or slip before"
        )
    for name, places in found.items():
        if len(places) == 1 and np.isnan(places[0].position):
            remarks.append(f"{name.replace('_', ' by ')} is not reached: {_elsewhere(places[0])}")
    for remark in remarks:
        warnings.warn(remark, SpinlineWarning, stacklevel=2)
    scalars = {"volume_fraction": phi, **_crossover_scalars(found, single=not _has_times(jet))}
    attributes = _attributes(scene, solution, jet, found, remarks)
    return results.assemble(fields, scalars, attributes, jet)


_TAKE = "take one of those"


def _value(measured: Measured | None, default: Any = None) -> Any:
    return default if measured is None else measured.value


def _length(scene: Scene, jet: StraightJet) -> float:
    length = scene.jet.length if isinstance(scene.jet, PowerLawJet | HyperbolicJet | TableJet) else None
    if length is None:
        return jet.end
    if length.value > jet.end * (1 + 1e-12):
        raise InputError(
            "jet.length", "reaches beyond the last sample of the table", value=length.text,
            allowed=f"up to {jet.end:g} m",
        )  # fmt: skip
    if length.value <= jet.start:
        raise InputError("jet.length", "ends before the first sample", value=length.text, allowed=f"> {jet.start:g} m")
    return min(length.value, jet.end)


def _jet_dataset(section: JetspinJet, path: Path) -> "xr.Dataset":
    """Beads of a JETSPIN run, or of the file that import-jet made of one."""
    if path.suffix == ".nc":
        from spinline.results import open_dataset

        return open_dataset(path)
    from spinline.jetprofile.jetspin import read_jetspin

    return read_jetspin(path, source=section.source, unit=section.unit)


def _has_times(jet: "StraightJet | LagrangianJet") -> bool:
    return not isinstance(jet, StraightJet) and jet.time is not None


def _frames(jet: "StraightJet | LagrangianJet") -> "list[StraightJet | LagrangianJet]":
    if isinstance(jet, StraightJet) or jet.time is None:
        return [jet]
    return [jet.at(float(t)) for t in jet.time]


def _straight_profile(scene: Scene, jet: StraightJet, special: list[float]) -> dict[str, FloatArray]:
    """Jet variables on a grid that is fine at the nozzle and holds the special places exactly."""
    length, r0 = _length(scene, jet), jet.initial_radius
    span = length - jet.start
    grid = jet.start + r0 * np.expm1(np.linspace(0.0, np.log1p(span / r0), scene.accuracy.points))
    grid[-1] = length
    onset = getattr(jet, "onset", 0.0) * r0
    extra = [place for place in (*special, onset) if jet.start <= place <= length]
    z = np.unique(np.concatenate((np.clip(grid, jet.start, length), extra)))
    return {
        "z": z,
        "radius": jet.radius(z),
        "velocity": jet.velocity(z),
        "velocity_ratio": jet.velocity_ratio(z),
        "strain_rate": jet.strain_rate(z),
        "residence_time": jet.residence_time(z),
        "stretch_ratio": jet.stretch_ratio(z),
    }


def _bead_profile(jet: "LagrangianJet") -> dict[str, FloatArray]:
    between = 0.5 * (jet.bead_velocity[..., 1:] + jet.bead_velocity[..., :-1])
    step = np.diff(jet.arc_length, axis=-1, prepend=0.0)
    return {
        "arc_length": jet.arc_length,
        "radius": jet.element_radius,
        "velocity": between,
        "velocity_ratio": jet.stretch,
        "strain_rate": jet.element_strain_rate,
        "residence_time": np.cumsum(step / np.where(between > 0, between, np.nan), axis=-1),
        "stretch_ratio": jet.stretch,
        "x": jet.x,
        "y": jet.y,
        "z": jet.z,
    }


def _network_fields(profile: dict[str, FloatArray], scene: Scene, solution: Solution) -> dict[str, FloatArray]:
    """Network variables wherever the stretch is known, NaN (or False) elsewhere."""
    stretch = profile["stretch_ratio"]
    known = np.isfinite(stretch)
    net = affine_network(
        stretch[known],
        solution.volume_fraction,
        closure=scene.network.closure,
        solvent_quality=scene.network.solvent_quality,
    )
    radius = profile["radius"][known]
    walk = net.conformation
    flat = {
        "mean_polymer_fraction": np.full(radius.shape, solution.volume_fraction),
        "network_velocity_ratio": net.network_velocity_ratio,
        "axial_stretch": walk.axial_stretch,
        "relative_extension": walk.relative_extension,
        "radial_contraction": walk.radial_contraction,
        "orientation": walk.orientation,
        "network_radius": radius * net.network_radius_ratio,
        "network_radius_conservative": radius * net.network_radius_ratio_conservative,
        "core_polymer_fraction": net.core_polymer_fraction,
        "core_polymer_fraction_eq40": net.core_polymer_fraction_eq40,
        "core_polymer_fraction_conservative": net.core_polymer_fraction_conservative,
        "strand_force": strand_force(walk.force, solution.kuhn_length, solution.temperature),
        "compacted": net.compacted,
        "compacted_eq40": net.compacted_eq40,
        "compacted_conservative": net.compacted_conservative,
        "flux_exceeded": net.flux_exceeded,
        "contour_reached": net.contour_reached,
    }
    return {name: _spread(values, known) for name, values in flat.items()}


def _spread(values: FloatArray, known: Any) -> FloatArray:
    if known.all():
        return values.reshape(known.shape)
    full = np.full(known.shape, False if values.dtype == bool else np.nan, dtype=values.dtype)
    full[known] = values
    return full


def _crossover_scalars(found: dict[str, list[Crossover]], *, single: bool) -> dict[str, Any]:
    scalars: dict[str, Any] = {}
    for name, places in found.items():
        for quantity in ("position", "radius", "radius_ratio", "velocity_ratio"):
            values = [getattr(place, quantity) for place in places]
            scalars[f"{name}_{quantity}"] = values[0] if single else np.array(values)
    return scalars


def _coupling(scene: Scene, solution: Solution, jet: StraightJet) -> tuple[float, float, str]:
    """alpha_v, A and the viscosity they were made with, in words."""
    if scene.network.coupling is not None:
        alpha = scene.network.coupling.value
        return alpha, alpha * solution.kuhn_length / (3 * jet.initial_radius), "given as network.coupling"
    viscosity, words = _drag_viscosity(scene, solution)
    xi = float(network_at_rest(solution.volume_fraction, scene.network.solvent_quality).size) * solution.kuhn_length
    alpha = float(elastic_coupling(xi, jet.initial_velocity, viscosity, jet.initial_radius, solution.temperature))
    a = float(affinity(xi, jet.initial_velocity, viscosity, solution.kuhn_length, solution.temperature))
    return alpha, a, f"{words}, {viscosity:.4g} Pa s"


def _drag_viscosity(scene: Scene, solution: Solution) -> tuple[float, str]:
    choice = scene.network.drag_viscosity
    if isinstance(choice, Measured):
        return choice.value, "given viscosity"
    if choice == "solution":
        if solution.viscosity is None:
            raise InputError(
                "solution.viscosity", 'is missing: network.drag_viscosity = "solution" needs it', remedy="give it"
            )
        return solution.viscosity, "viscosity of the solution"
    given = scene.solution.solvent_viscosity
    if given is not None:
        return given.value, "viscosity of the solvent"
    if isinstance(scene.solution.solvent, SolventData):
        raise InputError(
            "solution.solvent_viscosity", "is missing: alpha_v needs it for a solvent that is not built in",
            remedy="give it, or network.coupling",
        )  # fmt: skip
    logs = [
        share * np.log(solvent_viscosity(name, solution.temperature, "solution.solvent"))
        for name, share in solution.solvent.items()
    ]
    words = "viscosity of the solvent" if len(logs) == 1 else "viscosity of the solvents (mean of logarithms)"
    return float(np.exp(np.sum(logs))), words


def _coupling_error(scene: Scene, solution: Solution, jet: StraightJet) -> float:
    """Largest relative error of w = V along the jet, ``c V' / alpha_v`` (first term of the series of Eq. 33)."""
    alpha, _, _ = _coupling(scene, solution, jet)
    length = _length(scene, jet)
    z = jet.start + jet.initial_radius * np.expm1(
        np.linspace(0, np.log1p((length - jet.start) / jet.initial_radius), 257)
    )
    onset = getattr(jet, "onset", 0.0) * jet.initial_radius
    z = np.clip(np.append(z, onset), jet.start, length)
    slope = jet.strain_rate(z) * jet.initial_radius / jet.initial_velocity
    return float(scene.network.spring.value * slope.max() / alpha)


def _elsewhere(place: Crossover) -> str:
    if np.isnan(place.predicted):
        return f"the jet never stretches to V = {place.velocity_ratio:.6g}"
    return (
        f"the profile predicts it at z = {place.predicted:.9g} m (V = {place.velocity_ratio:.6g}), beyond the jet's end"
    )


def _sentence(name: str, places: list[Crossover]) -> str:
    if len(places) > 1:
        reached = sum(not np.isnan(place.position) for place in places)
        return f"reached at {reached} of {len(places)} times"
    place = places[0]
    if np.isnan(place.position):
        return f"not reached: {_elsewhere(place)}"
    return f"reached at {place.position:.9g} m, radius {place.radius:.9g} m, r/r0 = {place.radius_ratio:.9g}"


def _attributes(
    scene: Scene,
    solution: Solution,
    jet: "StraightJet | LagrangianJet",
    found: dict[str, list[Crossover]],
    remarks: list[str],
) -> dict[str, Any]:
    from spinline import __version__

    attributes: dict[str, Any] = {
        "title": scene.title or scene.name,
        "Conventions": "CF-1.11",
        "source": f"spinline {__version__}",
        "spinline_version": __version__,
        "scene": scene.text,
        "model": "affine",
        "model_requested": scene.network.model,
        "closure": scene.network.closure,
        "force_law": scene.network.force_law,
        "solvent_quality": scene.network.solvent_quality,
        "rtol": scene.accuracy.rtol,
        "crossover": _sentence("crossover", found["crossover"]),
        "crossover_extension": _sentence("crossover_extension", found["crossover_extension"]),
        "crossover_extension_criterion": scene.network.crossover_extension.value,
        "effects_left_out": "elastic slip, inertia, relaxation, evaporation, radial gradients",
        "polymer": solution.polymer.name,
        "polymer_density": solution.polymer.density,
        "solvent": ", ".join(f"{name} {share:g}" for name, share in solution.solvent.items()),
        "solvent_density": solution.solvent_density,
        "solution_density": solution.density,
        "mass_fraction": solution.mass_fraction,
        "temperature": solution.temperature,
        "kuhn_length": solution.kuhn_length,
        "strands_per_chain": solution.strands_per_chain(
            float(network_at_rest(solution.volume_fraction, scene.network.solvent_quality).segments)
        ),
        "initial_radius": jet.initial_radius,
        "warnings": "\n".join(remarks),
        "references": (
            "Greenfeld et al., Phys. Rev. E 84, 041806 (2011); Eqs. (31)-(40) of the review in the docs"
            f"; polymer data: {solution.polymer.source}"
        ),
    }
    if isinstance(jet, StraightJet):
        alpha, a, viscosity = _coupling(scene, solution, jet)
        eps = _coupling_error(scene, solution, jet)
        attributes |= {
            "jet": repr(jet) if len(repr(jet)) < 400 else type(jet).__name__,
            "initial_velocity": jet.initial_velocity,
            "flow_rate": jet.flow_rate,
            "coupling": alpha,
            "affinity_of_solvent_drag": a,
            "drag_viscosity": viscosity,
            "spring": scene.network.spring.value,
            "coupling_error": eps,
            "model_reason": (
                f"affine: elastic slip changes the network velocity by about {eps:.2g} (largest c V'/alpha_v, alpha_v = "
                f"{alpha:.4g}; {viscosity}), rtol = {scene.accuracy.rtol:g}"
            ),
        }
    else:
        attributes |= {
            "jet": str(jet.attributes.get("source", "bead jet")),
            "model_reason": "affine: the material stretch of each element drives the network; elastic slip not estimated",
            "jet_attributes": "\n".join(f"{key} = {value}" for key, value in jet.attributes.items()),
        }
    return attributes
