"""What a scene needs before anything runs: its solution, its jet, and the numbers that couple network and flow."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.base.units import Measured
from spinline.jetprofile.hyperbolic import Hyperbolic
from spinline.jetprofile.k_estimate import estimate_k
from spinline.jetprofile.power_law import PowerLaw
from spinline.jetprofile.straight import StraightJet
from spinline.network.coupling import affinity, elastic_coupling
from spinline.network.mesh import network_at_rest
from spinline.rheology.materials import Polymer, polymer, solvent_viscosity
from spinline.rheology.solution import Solution
from spinline.scene.file import (
    HyperbolicJet,
    JetspinJet,
    LagrangianJetFile,
    PolymerData,
    PowerLawJet,
    Scene,
    SolventData,
    TableJet,
)

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.scene.images_file import Images

__all__ = [
    "bead_ages",
    "build_jet",
    "build_solution",
    "coupling",
    "coupling_error",
    "drag_of_solvent",
    "given",
    "jet_grid",
    "jet_length",
]


def build_solution(scene: "Scene | Images") -> Solution:
    """Solution of a scene or an images file, built-in properties filled in."""
    s = scene.solution
    data: Polymer
    if isinstance(s.polymer, PolymerData):
        data = Polymer(
            name=s.polymer.name,
            density=s.polymer.density.value,
            repeat_unit_molar_mass=given(s.polymer.repeat_unit_molar_mass, float("nan")),
            backbone_bonds=s.polymer.backbone_bonds or 0,
        )
    else:
        data = polymer(s.polymer, "solution.polymer")
    density = given(s.solvent_density)
    solvent: Any = s.solvent
    if isinstance(s.solvent, SolventData):
        density = s.solvent.density.value if density is None else density
        solvent = s.solvent.name
    return Solution.build(
        data,
        solvent,
        mass_fraction=given(s.mass_fraction),
        volume_fraction=given(s.volume_fraction),
        temperature=s.temperature.value,
        polymer_density=given(s.polymer_density),
        solvent_density=density,
        kuhn_length=s.kuhn_length.value,
        molar_mass=given(s.molar_mass),
        viscosity=given(s.viscosity),
        relaxation_time=given(s.relaxation_time),
        field="solution.",
    )


def build_jet(scene: Scene, solution: Solution) -> "StraightJet | LagrangianJet":
    """Jet of a scene: analytic, tabulated or imported."""
    j = scene.jet
    if isinstance(j, PowerLawJet):
        k = given(j.k)
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

        return Table.from_csv(path, flow_rate=j.flow_rate.value, initial_radius=given(j.radius))
    from spinline.jetprofile.lagrangian import LagrangianJet

    beads: LagrangianJet
    if isinstance(j, LagrangianJetFile):
        beads = LagrangianJet.from_csv(path, initial_radius=given(j.radius))
    else:
        beads = LagrangianJet.from_dataset(_jet_dataset(j, path))
    if j.time == "all":
        return beads
    return beads.at(None if isinstance(j.time, str) else j.time.value)


def bead_ages(jet: "LagrangianJet") -> tuple[FloatArray, float]:
    """Age of the elements of a bead jet in s, and the flow rate (m3/s) behind it.

    By what was fed since, at the flow rate that the motion implies; where there is none (NaN), by the time it takes along
    the arc at the speed of the beads; NaN without velocities.
    """
    from spinline.jetprofile.bead_age import bead_flow_rate, element_age

    rate = bead_flow_rate(jet)
    if np.isfinite(rate):
        return element_age(jet, rate), rate
    between = 0.5 * (jet.bead_velocity[..., 1:] + jet.bead_velocity[..., :-1])
    step = np.diff(jet.arc_length, axis=-1, prepend=0.0)
    ages: FloatArray = np.cumsum(step / np.where(between > 0, between, np.nan), axis=-1)
    return ages, rate


def jet_length(scene: Scene, jet: StraightJet) -> float:
    """Length of the jet in m: the scene's, within what the profile covers."""
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


def jet_grid(jet: StraightJet, end: float, points: int) -> FloatArray:
    """Places from the jet's start to `end`, even in the logarithm beyond where it begins to thin; its kinks among them.

    The scale is r_0, or the first kink where that is nearer: a strong field (k >> 1) thins a jet long before z = r_0.
    """
    kinks = [kink * jet.initial_radius for kink in jet.kinks()]
    inside = [jet.start + kink for kink in kinks if jet.start + kink < end]
    scale = min([jet.initial_radius, *(kink for kink in kinks if kink > 0)])
    grid = jet.start + scale * np.expm1(np.linspace(0.0, np.log1p((end - jet.start) / scale), points))
    grid[-1] = end
    return np.unique(np.concatenate((np.clip(grid, jet.start, end), inside)))


def coupling(scene: Scene, solution: Solution, jet: StraightJet) -> tuple[float, float, str]:
    """alpha_v, A and the viscosity they were made with, in words; NaN where it is not known and not needed."""
    if scene.network.coupling is not None:
        alpha = scene.network.coupling.value
        return alpha, alpha * solution.kuhn_length / (3 * jet.initial_radius), "given as network.coupling"
    try:
        viscosity, words = _drag_viscosity(scene, solution)
    except InputError as error:
        if scene.network.model in ("manifold", "chain"):
            raise
        return float("nan"), float("nan"), f"not known ({error})"
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
    return drag_of_solvent(scene, solution, "alpha_v")


def drag_of_solvent(scene: Scene, solution: Solution, what: str) -> tuple[float, str]:
    """Viscosity of the solvent in Pa s, and where it comes from; `what` needs it, in an error."""
    own = scene.solution.solvent_viscosity
    if own is not None:
        return own.value, "viscosity of the solvent"
    if isinstance(scene.solution.solvent, SolventData):
        remedy = "give it, or network.coupling" if what == "alpha_v" else "give it"
        raise InputError(
            "solution.solvent_viscosity", f"is missing: {what} needs it for a solvent that is not built in",
            remedy=remedy,
        )  # fmt: skip
    logs = [
        share * np.log(solvent_viscosity(name, solution.temperature, "solution.solvent"))
        for name, share in solution.solvent.items()
    ]
    words = "viscosity of the solvent" if len(logs) == 1 else "viscosity of the solvents (mean of logarithms)"
    return float(np.exp(np.sum(logs))), words


def coupling_error(scene: Scene, solution: Solution, jet: StraightJet) -> float:
    """Largest relative error of w = V along the jet, ``c V' / alpha_v`` (first term of the series of Eq. 33)."""
    alpha, _, _ = coupling(scene, solution, jet)
    length = jet_length(scene, jet)
    z = jet_grid(jet, length, 257)
    slope = jet.strain_rate(z) * jet.initial_radius / jet.initial_velocity
    return float(scene.network.spring.value * slope.max() / alpha)


def _jet_dataset(section: JetspinJet, path: Path) -> "xr.Dataset":
    """Beads of a JETSPIN run, or of the file that import-jet made of one."""
    if path.suffix == ".nc":
        from spinline.base.netcdf import open_dataset

        return open_dataset(path)
    from spinline.jetprofile.jetspin import read_jetspin

    return read_jetspin(path, source=section.source, unit=section.unit)


def given(measured: Measured | None, default: Any = None) -> Any:
    """Value in SI of an optional quantity of a scene, or the default."""
    return default if measured is None else measured.value
