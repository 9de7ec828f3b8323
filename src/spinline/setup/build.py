"""The solution of a scene; its jet is built by `spinline.setup.jet`, everything at once by `spinline.setup.context`."""

from typing import TYPE_CHECKING, Any

from spinline.rheology.materials import Polymer, polymer
from spinline.rheology.solution import Solution
from spinline.scene.file import PolymerData, Scene, SolventData
from spinline.setup.jet import build_jet
from spinline.setup.values import given

if TYPE_CHECKING:
    from spinline.scene.images_file import Images

__all__ = ["build_jet", "build_solution", "given"]


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
