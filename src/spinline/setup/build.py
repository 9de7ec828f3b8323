"""The solution of a scene; its jet is built by `spinline.setup.jet`, everything at once by `spinline.setup.context`."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from spinline.base.errors import InputError
from spinline.rheology.materials import Polymer, polymer
from spinline.rheology.solution import Solution
from spinline.scene.file import PolymerData, Scene, SolventData
from spinline.setup.jet import build_jet
from spinline.setup.values import given

if TYPE_CHECKING:
    from spinline.rheology.prior import Estimate
    from spinline.scene.images_file import Images

__all__ = ["build_jet", "build_solution", "estimate_of", "given"]

_FLEXIBLE = 1e-9  # m, of a polymer whose Kuhn length nobody has given


def build_solution(scene: "Scene | Images") -> Solution:
    """Solution of a scene or an images file, built-in properties filled in."""
    s = scene.solution
    data: Polymer
    if isinstance(s.polymer, PolymerData):
        nan = float("nan")
        data = Polymer(
            name=s.polymer.name,
            density=s.polymer.density.value,
            repeat_unit_molar_mass=given(s.polymer.repeat_unit_molar_mass, nan),
            backbone_bonds=s.polymer.backbone_bonds or 0,
            kuhn_length=given(s.polymer.kuhn_length, nan),
            entanglement_molar_mass=given(s.polymer.entanglement_molar_mass, nan),
            glass_transition=given(s.polymer.glass_transition, nan),
            melting_temperature=given(s.polymer.melting_temperature, nan),
            melting_enthalpy=given(s.polymer.melting_enthalpy, nan),
            heat_capacity=given(s.polymer.heat_capacity, nan),
        )
    else:
        data = polymer(s.polymer, "solution.polymer")
    density = given(s.solvent_density)
    solvent: Any = s.solvent
    if isinstance(s.solvent, SolventData):
        density = s.solvent.density.value if density is None else density
        solvent = s.solvent.name
    fraction = given(s.volume_fraction)
    if s.concentration is not None:  # mass of polymer per volume of solution
        own = given(s.polymer_density, data.density)
        fraction = s.concentration.value / own
        if not fraction < 1:
            raise InputError(
                "solution.concentration",
                "is more than the polymer's density",
                value=s.concentration.value,
                allowed=f"(0, {own:g}) kg/m3",
                remedy="lower it",
            )
    solution = Solution.build(
        data,
        solvent,
        mass_fraction=given(s.mass_fraction),
        volume_fraction=fraction,
        temperature=s.temperature.value,
        polymer_density=given(s.polymer_density),
        solvent_density=density,
        kuhn_length=_kuhn_length(s.kuhn_length, data),
        molar_mass=given(s.molar_mass),
        solvent_viscosity=given(s.solvent_viscosity),
        viscosity=None if s.viscosity == "estimate" else given(s.viscosity),
        relaxation_time=None if s.relaxation_time == "estimate" else given(s.relaxation_time),
        field="solution.",
    )
    if s.viscosity == "estimate":
        solution = replace(solution, viscosity=estimate_of(solution, "viscosity").value)
    if s.relaxation_time == "estimate":
        solution = replace(solution, relaxation_time=estimate_of(solution, "relaxation_time").value)
    return solution


def estimate_of(solution: Solution, key: str) -> "Estimate":
    """Viscosity or relaxation time from the chains and the concentration, as in a good solvent.

    Raises
    ------
    InputError
        For what it needs, by the key of the scene.
    """
    from spinline.rheology.prior import estimated_relaxation_time, estimated_viscosity

    try:
        return (estimated_viscosity if key == "viscosity" else estimated_relaxation_time)(solution)
    except InputError as error:
        raise InputError(
            f"solution.{error.field}",
            f"{error.problem}: the estimate of {key} needs it",
            value=error.value,
            allowed=error.allowed,
            remedy=error.remedy,
        ) from None


def _kuhn_length(measured: Any, data: Polymer) -> float:
    """The scene's, the library's, or 1 nm."""
    if measured is not None:
        return float(measured.value)
    return data.kuhn_length if data.kuhn_length > 0 else _FLEXIBLE
