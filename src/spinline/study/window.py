"""Operating window: crossover, orientation and dryness against voltage, gap, flow rate and concentration.

The prefactor k of Eq. (31) is estimated from the process (`estimate_k`, with ``E = voltage / gap``), to a factor of order one:
every point is computed at k and at k times the two ends of `k_factor`, and what that moves is shown as a band. The viscosity
follows the concentration by the law of the scene's [rheology], by the scaling law of an entangled solution where there is none,
through the viscosity of the scene.

Dryness is the share of the solvent that the jet has lost at its end, by the drying stage of a run: the scene's air and
activity, flat across the jet, whether or not the run itself would include evaporation. The network is that of the scene's
model; orientation is at the end of the jet.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.base.units import Measured
from spinline.drying.along_jet import dry, element_path
from spinline.jetprofile.k_estimate import estimate_k
from spinline.rheology.solution import Solution, volume_fraction
from spinline.scene.air_and_rheology import AmbientSection, RheologySection
from spinline.scene.file import PowerLawJet, Scene
from spinline.scene.needle import NeedleJet
from spinline.setup.build import build_solution
from spinline.setup.context import Context
from spinline.setup.grid import jet_length
from spinline.setup.jet import build_jet
from spinline.setup.material import build_material
from spinline.setup.needle import NeedleSeries
from spinline.study.design import Axis, Design
from spinline.study.sweep import Progress, run_sweep
from spinline.study.sweep_file import Sweep, scene_tables

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["AXES", "operating_window"]

_NODES = 33  # values of k at which the drying stage is run, of many

# name: (unit, what it is)
AXES = {
    "voltage": ("V", "voltage between nozzle and collector"),
    "gap": ("m", "distance between nozzle and collector"),
    "flow_rate": ("m3 s-1", "flow rate"),
    "mass_fraction": ("1", "polymer mass fraction of the solution"),
}
_OUT = {
    "k": ("1", "prefactor of Eq. (31), estimated"),
    "viscosity": ("Pa s", "zero-shear viscosity of the solution"),
    "crossover_position": ("m", "where the network is fully stretched, Eq. (38); NaN beyond the end of the jet"),
    "crossover_radius": ("m", "jet radius there"),
    "full_stretch": (
        "1",
        "stretch at the end of the jet over that of full stretch, V / V_S; the crossover is where it is 1",
    ),
    "orientation": ("1", "Hermans orientation at the end of the jet"),
    "core_polymer_fraction": ("1", "polymer volume fraction of the core at the end of the jet, no drying"),
    "dryness": ("1", "share of the solvent lost at the end of the jet; 1 is dry"),
    "strands_per_chain": ("1", "strands that a chain makes: no network below about 2"),
}


def operating_window(
    scene: Scene,
    *,
    voltage: ArrayLike,
    gap: ArrayLike,
    flow_rate: ArrayLike | None = None,
    mass_fraction: ArrayLike | None = None,
    conductivity: float | None = None,
    relative_humidity: float | None = None,
    k_factor: tuple[float, float] = (0.5, 2.0),
    workers: int | None = None,
    progress: Progress | None = None,
) -> "xr.Dataset":
    """Map of what a process does to the network.

    Parameters
    ----------
    scene : Scene
        From `load_scene`: a power-law jet; its solution's viscosity is that of its own concentration.
    voltage, gap, flow_rate, mass_fraction : array_like
        V, m, m3/s, -; one number or many; flow rate and mass fraction are the scene's if left out.
    conductivity : float, optional
        S/m; the scene's ``jet.conductivity`` if left out.
    relative_humidity : float, optional
        In [0, 1); the scene's if left out. Air is free of other vapours.
    k_factor : tuple of float
        Ends of the band, (0, 1] and [1, inf).
    workers, progress : optional
        As for `run_sweep`.

    Returns
    -------
    xarray.Dataset
        Along `k_factor` (low, 1, high), `voltage`, `gap`, `flow_rate` and `mass_fraction`.

    Raises
    ------
    InputError
        For another jet, or what the estimates need and was not given.
    """
    jet = scene.jet
    if not isinstance(jet, PowerLawJet | NeedleJet):
        raise InputError(
            "jet.profile", "has no k to estimate", value=jet.profile, allowed='"power-law", "needle"', remedy="take one"
        )
    low, high = (float(real("k_factor", end, above=0.0, most=1e3)) for end in k_factor)
    if not low <= 1 <= high:
        raise InputError(
            "k_factor", "does not hold 1", value=(low, high), allowed="low <= 1 <= high", remedy="for example 0.5, 2"
        )
    solution = build_solution(scene)
    sigma = jet.conductivity.value if conductivity is None and jet.conductivity is not None else conductivity
    if sigma is None:
        raise InputError(
            "conductivity", "is missing: the estimate of k needs it", remedy='give it, for example "0.01 S/m"'
        )
    if solution.viscosity is None:
        raise InputError("solution.viscosity", "is missing: the estimate of k needs it", remedy="give it in the scene")
    axes = _axes(jet, solution, voltage, gap, flow_rate, mass_fraction)
    factors = np.array([low, 1.0, high])
    u, g, q, w = (x[np.newaxis] for x in np.meshgrid(*axes.values(), indexing="ij"))
    mu, law = _viscosity(scene, solution, w)
    columns = {"jet.flow_rate": q, "solution.mass_fraction": w, "solution.viscosity": mu}
    if isinstance(jet, NeedleJet):  # the jet itself is computed: no k, no band
        factors, k = np.ones(1), np.full(mu.shape, np.nan)
        columns |= {"jet.voltage": u, "jet.gap": g, "jet.conductivity": np.full(mu.shape, sigma)}
    else:
        k = factors.reshape(-1, 1, 1, 1, 1) * estimate_k(
            radius=jet.radius.value, flow_rate=q, conductivity=sigma, viscosity=mu, electric_field=u / g
        )
        columns["jet.k"] = k
    columns = {key: np.broadcast_to(x, k.shape) for key, x in columns.items()}
    q, mu = columns["jet.flow_rate"], columns["solution.viscosity"]
    rows = _rows(scene, columns, workers, progress)
    phi = np.reshape(rows["volume_fraction"].values, k.shape)
    context = Context(_in_air(scene, relative_humidity))
    if isinstance(jet, NeedleJet):
        dry, air = _dryness_of_needle(context, columns, phi)
    else:
        dry, air = _dryness(context, k, q, phi)
    found = {"k": k, "viscosity": mu, "dryness": dry, "strands_per_chain": _strands(scene, solution, phi)}
    attributes = {
        "title": scene.title or scene.name,
        "scene": scene.text,
        "spinline_version": rows.attrs["spinline_version"],
        "conductivity": sigma,
        "jet_length": np.nan if jet.length is None else jet.length.value,
        "viscosity_law": law,
        "air": air,
        "k_estimate": "none: the jet is computed from its settings"
        if isinstance(jet, NeedleJet)
        else f"text under Eq. (31), to a factor of order one: band from {low:g} to {high:g}",
    }
    made = _dataset(found, rows, factors, axes, attributes)
    if isinstance(jet, NeedleJet):  # the same at every k
        made = made.isel(k_factor=[0, 0, 0]).assign_coords(k_factor=("k_factor", [low, 1.0, high]))
    return made


def _axes(
    jet: PowerLawJet | NeedleJet,
    solution: Solution,
    voltage: ArrayLike,
    gap: ArrayLike,
    flow_rate: ArrayLike | None,
    mass_fraction: ArrayLike | None,
) -> dict[str, FloatArray]:
    """The four axes, one number where nothing varies."""
    axes = {
        "voltage": _axis("voltage", voltage, 1e-3, 1e7),
        "gap": _axis("gap", gap, 1e-6, 1e3),
        "flow_rate": _axis("flow_rate", jet.flow_rate.value if flow_rate is None else flow_rate, 1e-25, 1.0),
        "mass_fraction": _axis(
            "mass_fraction", solution.mass_fraction if mass_fraction is None else mass_fraction, 1e-6, 1.0
        ),
    }
    if jet.length is not None and jet.length.value > axes["gap"].min():
        raise InputError(
            "gap",
            "is shorter than the jet of the scene",
            value=float(axes["gap"].min()),
            allowed=f">= jet.length = {jet.length.value:g} m",
            remedy="shorten jet.length",
        )
    return axes


def _dataset(
    found: dict[str, FloatArray],
    rows: "xr.Dataset",
    factors: FloatArray,
    axes: dict[str, FloatArray],
    attributes: dict[str, object],
) -> "xr.Dataset":
    """The map: what was found beside the rows, and the rows' own numbers."""
    import xarray as xr

    shape, dims = found["k"].shape, ("k_factor", *axes)
    of_rows = {
        **{name: rows[name].values for name in ("crossover_position", "crossover_radius")},
        "full_stretch": rows["end_velocity_ratio"].values / rows["crossover_velocity_ratio"].values,
        "orientation": rows["end_orientation"].values,
        "core_polymer_fraction": rows["end_core_polymer_fraction"].values,
    }
    every = found | {name: np.reshape(values, shape) for name, values in of_rows.items()}
    variables = {
        name: (dims, np.broadcast_to(every[name], shape).copy(), {"units": unit, "long_name": words})
        for name, (unit, words) in _OUT.items()
    }
    status, why = rows["status"], {"long_name": "why a point has no numbers"}
    variables["status"] = (dims, status.values.reshape(shape), {"long_name": status.attrs["long_name"]})
    variables["reason"] = (dims, rows["reason"].values.astype(str).reshape(shape), why)
    coordinates = {name: (name, x, {"units": AXES[name][0], "long_name": AXES[name][1]}) for name, x in axes.items()}
    return xr.Dataset(
        variables, {"k_factor": ("k_factor", factors, {"long_name": "k over its estimate"}), **coordinates}, attributes
    )


def _axis(name: str, values: ArrayLike, low: float, high: float) -> FloatArray:
    array = np.atleast_1d(real(name, values, above=low, below=high, unit=AXES[name][0]))
    if array.ndim != 1 or not array.size or np.any(np.diff(array) <= 0):
        raise InputError(name, "is not a rising list", value=array.tolist(), remedy="sort it")
    return array


def _viscosity(scene: Scene, solution: Solution, mass: FloatArray) -> tuple[FloatArray, str]:
    """Zero-shear viscosity at other concentrations, and the law in words."""
    assert solution.viscosity is not None
    if np.all(mass == solution.mass_fraction):
        return np.full(mass.shape, solution.viscosity), "that of the scene"
    if scene.rheology is None:
        scene = scene.model_copy(update={"rheology": RheologySection(law="scaling")})
    material = build_material(scene, solution)
    phi = volume_fraction(mass, solution.polymer.density, solution.solvent_density)
    return material.viscosity(phi), material.words


def _rows(
    scene: Scene, columns: Mapping[str, FloatArray], workers: int | None, progress: Progress | None
) -> "xr.Dataset":
    """The points as a sweep of a table."""
    design = Design("table", [Axis(key, np.ascontiguousarray(values).ravel()) for key, values in columns.items()])
    sweep = Sweep(title="", text="", base=scene_tables(scene.text), folder=scene.folder, design=design)
    return run_sweep(sweep, workers=workers, progress=progress)


def _in_air(scene: Scene, humidity: float | None) -> Scene:
    """The scene at another humidity."""
    if humidity is None:
        return scene
    wet = Measured(float(real("relative_humidity", humidity, least=0.0, below=1.0)))
    ambient = (scene.ambient or AmbientSection()).model_copy(update={"relative_humidity": wet})
    return scene.model_copy(update={"ambient": ambient})


def _dryness_of_needle(context: Context, columns: Mapping[str, FloatArray], phi: FloatArray) -> tuple[FloatArray, str]:
    """`_dryness` of jets that are computed from their settings, one by one; NaN where there is none."""
    share = np.full(phi.shape, np.nan)
    try:
        air = context.air
    except InputError as error:
        return share, f"dryness is not estimated: {error}"
    section, series = context.scene.jet, NeedleSeries()
    assert isinstance(section, NeedleJet)
    for at in np.ndindex(phi.shape):
        if not np.isfinite(phi[at]):
            continue
        own = {key: float(values[at]) for key, values in columns.items()}
        moved = {name: Measured(own[f"jet.{name}"]) for name in ("voltage", "gap", "flow_rate", "conductivity")}
        here = section.model_copy(update=moved)
        solution = replace(context.solution, volume_fraction=float(phi[at]), viscosity=own["solution.viscosity"])
        scene = context.scene.model_copy(update={"jet": here})
        try:
            jet = series.jet(here, scene, solution)
            lost = dry(element_path(jet, np.array([jet_length(scene, jet)])), solution, air).lost[-1]
        except InputError:
            continue
        share[at] = float(lost) / (1 - phi[at])
    return share, str(air)


def _dryness(context: Context, k: FloatArray, q: FloatArray, phi: FloatArray) -> tuple[FloatArray, str]:
    """Share of the solvent lost at the end of the jet, and the air in words; NaN where it is not known.

    By the drying stage of a run. It is smooth in k: of more than `_NODES` values of it, all else equal, the others lie on a
    monotone cubic through that many.
    """
    share = np.full(k.shape, np.nan)
    try:
        air = context.air
    except InputError as error:
        return share, f"dryness is not estimated: {error}"
    for rate, fraction in np.unique(np.stack((q[np.isfinite(phi)], phi[np.isfinite(phi)])), axis=1).T:
        here = (q == rate) & (phi == fraction)
        values, back = np.unique(k[here], return_inverse=True)
        few = values.size <= _NODES
        nodes = values if few else np.geomspace(values[0], values[-1], _NODES)
        lost = np.array([_lost(context, one, rate, fraction) for one in nodes]) / (1 - fraction)
        known = lost if few else _between(nodes, lost, values)
        share[here] = known[back]
    return share, str(air)


def _lost(context: Context, k: float, flow_rate: float, fraction: float) -> float:
    """Volume that a jet has lost at its end, by the flat balance; NaN where it cannot be said."""
    section = context.scene.jet
    moved = {"k": Measured(k), "flow_rate": Measured(flow_rate), "electric_field": None, "conductivity": None}
    solution = replace(context.solution, volume_fraction=float(fraction))
    scene = context.scene.model_copy(update={"jet": section.model_copy(update=moved)})
    jet = build_jet(scene, solution)
    try:
        return float(dry(element_path(jet, np.array([context.length])), solution, context.air).lost[-1])
    except InputError:
        return float("nan")


def _between(nodes: FloatArray, lost: FloatArray, k: FloatArray) -> FloatArray:
    from scipy.interpolate import PchipInterpolator

    known = np.isfinite(lost)
    if known.sum() < 2:
        return np.full(k.shape, np.nan)
    value: FloatArray = PchipInterpolator(np.log(nodes[known]), lost[known], extrapolate=False)(np.log(k))
    return value


def _strands(scene: Scene, solution: Solution, phi: FloatArray) -> FloatArray:
    from spinline.network.mesh import network_at_rest

    usable = np.isfinite(phi)
    segments = network_at_rest(np.where(usable, phi, 0.5), scene.network.solvent_quality).segments
    return np.where(usable, solution.segments_per_chain / segments, np.nan)
