"""How strongly the solution drags the network along: alpha_v of Eq. (33), and the viscosity it was made with."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from spinline.base.errors import InputError
from spinline.base.units import Measured
from spinline.network.coupling import affinity, elastic_coupling
from spinline.rheology.materials import solvent_viscosity
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene, SolventData

__all__ = ["Coupling", "Feed", "Paced", "build_coupling", "drag_of_solvent"]


class Paced(Protocol):
    """What the coupling takes from a jet: r_0 in m and v_0 in m/s."""

    @property
    def initial_radius(self) -> float:
        """r_0, m."""

    @property
    def initial_velocity(self) -> float:
        """v_0, m/s."""


@dataclass(frozen=True)
class Feed:
    """What is known of the nozzle of a bead jet."""

    initial_radius: float
    initial_velocity: float


@dataclass(frozen=True)
class Coupling:
    """What couples network and flow.

    Attributes
    ----------
    alpha, affinity : float
        alpha_v and A; NaN where the viscosity is not known.
    words : str
        The viscosity they were made with, or why there is none.
    problem : InputError or None
        What `required` raises.
    """

    alpha: float
    affinity: float
    words: str
    problem: InputError | None = None

    def required(self) -> float:
        """alpha_v for a model that cannot do without.

        Raises
        ------
        InputError
            Where it is not known.
        """
        if self.problem is not None:
            raise self.problem
        return self.alpha


def build_coupling(scene: Scene, solution: Solution, jet: Paced, mesh_size: float) -> Coupling:
    """Coupling along a jet; `mesh_size` is that of the network at rest, in Kuhn lengths."""
    if scene.network.coupling is not None:
        alpha = scene.network.coupling.value
        return Coupling(alpha, alpha * solution.kuhn_length / (3 * jet.initial_radius), "given as network.coupling")
    try:
        viscosity, words = _drag_viscosity(scene, solution)
    except InputError as error:
        return Coupling(float("nan"), float("nan"), f"not known ({error})", error)
    xi, v0, temperature = mesh_size * solution.kuhn_length, jet.initial_velocity, solution.temperature
    alpha = float(elastic_coupling(xi, v0, viscosity, jet.initial_radius, temperature))
    a = float(affinity(xi, v0, viscosity, solution.kuhn_length, temperature))
    return Coupling(alpha, a, f"{words}, {viscosity:.4g} Pa s")


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
            "solution.solvent_viscosity",
            f"is missing: {what} needs it for a solvent that is not built in",
            remedy=remedy,
        )
    logs = [
        share * np.log(solvent_viscosity(name, solution.temperature, "solution.solvent"))
        for name, share in solution.solvent.items()
    ]
    words = "viscosity of the solvent" if len(logs) == 1 else "viscosity of the solvents (mean of logarithms)"
    return float(np.exp(np.sum(logs))), words
