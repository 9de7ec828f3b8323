"""The jet of a scene: one builder a profile. A new jet is its law's file, a section of the scene and one line here.

A builder takes the section ``[jet]``, the scene and the solution, and returns anything that is a `spinline.jetprofile.Jet`.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spinline.base.errors import InputError
from spinline.jetprofile.given_jet import complete
from spinline.rheology.solution import Solution
from spinline.scene.blown import BlownJetSection
from spinline.scene.file import (
    HyperbolicJet,
    JetspinJet,
    LagrangianJetFile,
    PowerLawJet,
    Scene,
    TableJet,
    add_jet_section,
)
from spinline.scene.needle import NeedleJet
from spinline.scene.quantities import Section
from spinline.scene.spun import SpunJet
from spinline.setup.values import given

if TYPE_CHECKING:
    import xarray as xr

    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.jetprofile.straight import StraightJet

__all__ = ["build_jet", "built_from_numbers", "register_jet"]

Builder = Callable[[Any, Scene, Solution], Any]


def build_jet(scene: Scene, solution: Solution) -> "StraightJet | LagrangianJet":
    """Jet of a scene: analytic, tabulated, computed or imported.

    Raises
    ------
    InputError
        For what the jet needs and was not given, or files that cannot be read.
    """
    return complete(_BUILDERS[type(scene.jet)](scene.jet, scene, solution))


def built_from_numbers(scene: Scene) -> bool:
    """Whether the scene's jet is made of its section alone: quick, and different for every scene of a sweep."""
    return not hasattr(scene.jet, "path")


def register_jet(section: type[Section], build: Builder) -> None:
    """Add a profile.

    Parameters
    ----------
    section : class
        ``[jet]`` of the scene file, ``profile: Literal["name"]`` among its keys.
    build : callable
        ``build(section, scene, solution)``: the jet.
    """
    add_jet_section(section)
    _BUILDERS[section] = build


def _power_law(section: PowerLawJet, scene: Scene, solution: Solution) -> "StraightJet":
    from spinline.jetprofile.power_law import PowerLaw

    k = given(section.k)
    if k is None:
        from spinline.jetprofile.k_estimate import estimate_k

        if solution.viscosity is None:
            raise InputError("solution.viscosity", "is missing: the estimate of k needs it", remedy="give it, or k")
        assert section.conductivity is not None
        assert section.electric_field is not None
        k = float(
            estimate_k(
                radius=section.radius.value,
                flow_rate=section.flow_rate.value,
                conductivity=section.conductivity.value,
                viscosity=solution.viscosity,
                electric_field=section.electric_field.value,
            )
        )
    return PowerLaw(radius=section.radius.value, flow_rate=section.flow_rate.value, k=k, beta=section.beta.value)


def _hyperbolic(section: HyperbolicJet, scene: Scene, solution: Solution) -> "StraightJet":
    from spinline.jetprofile.hyperbolic import Hyperbolic

    return Hyperbolic(radius=section.radius.value, flow_rate=section.flow_rate.value, p=section.p.value)


def _needle(section: NeedleJet, scene: Scene, solution: Solution) -> "StraightJet":
    from spinline.setup.needle import needle_jet

    return needle_jet(section, scene, solution)


def _table(section: TableJet, scene: Scene, solution: Solution) -> "StraightJet":
    from spinline.jetprofile.table import Table

    path = _path(section, scene)
    return Table.from_csv(path, flow_rate=section.flow_rate.value, initial_radius=given(section.radius))


def _lagrangian(section: LagrangianJetFile, scene: Scene, solution: Solution) -> "LagrangianJet":
    from spinline.jetprofile.readers import read_beads

    beads = read_beads(_path(section, scene), unit=section.unit, initial_radius=given(section.radius))
    return _moment(section, beads)


def _jetspin(section: JetspinJet, scene: Scene, solution: Solution) -> "LagrangianJet":
    from spinline.jetprofile.lagrangian import LagrangianJet

    return _moment(section, LagrangianJet.from_dataset(_jet_dataset(section, _path(section, scene))))


def _spun(section: SpunJet, scene: Scene, solution: Solution) -> "LagrangianJet":
    from spinline.setup.spun import build_spun

    return build_spun(section, scene, solution)


def _blown(section: BlownJetSection, scene: Scene, solution: Solution) -> "StraightJet | LagrangianJet":
    from spinline.setup.blown import build_blown

    return build_blown(section, scene, solution)


def _moment(section: LagrangianJetFile | JetspinJet, beads: "LagrangianJet") -> "LagrangianJet":
    """All moments of a bead jet, or the one that is asked for."""
    if section.time == "all":
        return beads
    return beads.at(None if isinstance(section.time, str) else section.time.value)


def _path(section: TableJet | LagrangianJetFile | JetspinJet, scene: Scene) -> Path:
    path = scene.folder / section.path
    if not path.exists():
        raise InputError("jet.path", "does not exist", value=section.path, remedy="paths start from the scene's folder")
    return path


def _jet_dataset(section: JetspinJet, path: Path) -> "xr.Dataset":
    """Beads of a JETSPIN run, or of the file that import-jet made of one."""
    if path.suffix == ".nc":
        from spinline.base.netcdf import open_dataset

        return open_dataset(path)
    from spinline.jetprofile.jetspin import read_jetspin
    from spinline.jetprofile.jetspin.zipped import run_folder

    with run_folder(path) as run:
        return read_jetspin(run, source=section.source, unit=section.unit)


_BUILDERS: dict[type[Section], Builder] = {
    PowerLawJet: _power_law,
    HyperbolicJet: _hyperbolic,
    NeedleJet: _needle,
    TableJet: _table,
    JetspinJet: _jetspin,
    LagrangianJetFile: _lagrangian,
    SpunJet: _spun,
    BlownJetSection: _blown,
}
