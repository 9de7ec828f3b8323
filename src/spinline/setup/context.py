"""A scene and all that is built from it, each thing once, when it is first asked for.

The stages of a run, its plan, sweeps, fits and overlays take a `Context`; none of them builds anything itself. `taking`
gives the same with another rung or other switches, `of_jet` with another jet of the same solution: what does not depend on
the change is shared, not built again.
"""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.jetprofile.given_jet import complete
from spinline.jetprofile.straight import StraightJet
from spinline.network.mesh import network_at_rest
from spinline.rheology.solution import Solution
from spinline.scene.file import Scene
from spinline.setup.air import Air, build_air
from spinline.setup.build import build_solution
from spinline.setup.coupling import Coupling, Feed, Paced, build_coupling
from spinline.setup.effects import Effects
from spinline.setup.grid import jet_grid, jet_length
from spinline.setup.jet import build_jet
from spinline.setup.material import Material, build_material, diffusion_law, glass_fraction

if TYPE_CHECKING:
    from spinline.jetprofile.lagrangian import LagrangianJet
    from spinline.rheology.diffusion_laws import DiffusionLaw
    from spinline.setup.heat import HeatedAir

__all__ = ["Context", "Rest", "Strands"]

_T = TypeVar("_T")


class Rest(NamedTuple):
    """The network at rest: mesh and strands in Kuhn lengths, and V_S, the stretch at which a strand is its contour."""

    size: float
    segments: float
    full_stretch: float


class Strands(NamedTuple):
    """What `disentanglement` takes of the chains: Z, tau_R where it is given, beta and beta_c."""

    entanglements: float
    rouse: float | None
    release: float
    entanglement_release: float

    def rouse_time(self, disengagement_time: Any) -> Any:
        """tau_R in s for a tau_d."""
        from spinline.network.disentanglement import rouse_time

        if self.rouse is not None:
            return np.full(np.shape(disengagement_time), self.rouse)
        return rouse_time(disengagement_time, max(self.entanglements, 1.0))


class Context:
    """A scene, its solution and its jet, and what follows from them.

    Parameters
    ----------
    scene : Scene
    solution : Solution, optional
        Built from the scene otherwise.
    jet : Jet, optional
        Anything that is one; built from the scene otherwise.
    effects : Effects, optional
        As decided; none until then.
    kept : mapping, optional
        What is known already: "air", "material" ...

    Raises
    ------
    InputError
        For a solution or a jet that cannot be built.
    """

    def __init__(
        self,
        scene: Scene,
        solution: Solution | None = None,
        jet: Any = None,
        *,
        effects: Effects | None = None,
        kept: Mapping[str, Any] | None = None,
    ) -> None:
        self.scene = scene
        self.solution = build_solution(scene) if solution is None else solution
        self.jet: StraightJet | LagrangianJet = build_jet(scene, self.solution) if jet is None else complete(jet)
        self.effects = Effects() if effects is None else effects
        self._shared: dict[str, Any] = dict(kept or {})  # of scene and solution
        self._own: dict[str, Any] = {}  # of the jet too

    def taking(self, scene: Scene | None = None, effects: Effects | None = None) -> "Context":
        """The same solution and jet with another rung, other switches or tolerances."""
        other = Context(scene or self.scene, self.solution, self.jet, effects=effects or self.effects)
        other._shared, other._own = self._shared, self._own
        return other

    def of_jet(self, jet: Any) -> "Context":
        """Another jet (a moment of this one) of the same solution in the same air."""
        other = Context(self.scene, self.solution, jet, effects=self.effects)
        other._shared = self._shared
        return other

    @property
    def frames(self) -> "list[Context]":
        """One for each moment of the jet; itself, where there is one."""
        if self.jet.time is None:
            return [self]
        times = self.jet.time
        moments: list[tuple[Any, dict[str, Any]]] = self._once(
            self._own, "moments", lambda: [(self.jet.at(float(t)), {}) for t in times]
        )
        found = []
        for jet, own in moments:
            other = self.of_jet(jet)
            other._own = own
            found.append(other)
        return found

    @property
    def straight(self) -> bool:
        """The jet is steady and known everywhere along its axis."""
        return isinstance(self.jet, StraightJet)

    @property
    def line(self) -> StraightJet:
        """The jet, for what only a straight one has.

        Raises
        ------
        InputError
            For a bead jet.
        """
        if not isinstance(self.jet, StraightJet):
            raise InputError("jet", "is a bead jet", allowed="a straight jet", remedy='take model = "auto"')
        return self.jet

    @property
    def beads(self) -> "LagrangianJet":
        """The jet, for what only one of beads has.

        Raises
        ------
        InputError
            For another.
        """
        if isinstance(self.jet, StraightJet):
            raise InputError("jet", "has no beads", allowed="a bead jet", remedy="see jet.profile")
        return self.jet

    @property
    def length(self) -> float:
        """Where a straight jet ends, m: the scene's length, within what the profile covers."""
        return self._once(self._own, "length", lambda: jet_length(self.scene, self.line))

    @property
    def rest(self) -> Rest:
        """The network at rest."""
        return self._once(self._shared, "rest", self._rest)

    @property
    def coupling(self) -> Coupling:
        """alpha_v and A of one moment of a jet."""
        return self._once(
            self._own, "coupling", lambda: build_coupling(self.scene, self.solution, self.feed, self.rest.size)
        )

    @property
    def feed(self) -> Paced:
        """r_0 and v_0 of one moment of a jet.

        Raises
        ------
        InputError
            For a bead jet whose velocity at the nozzle is not known.
        """
        if isinstance(self.jet, StraightJet):
            return self.jet
        r0, rate = self.jet.initial_radius, self.bead_flow_rate
        velocity = rate / (np.pi * r0**2) if np.isfinite(rate) else float(self.jet.bead_velocity[0])
        if not velocity > 0:
            raise InputError(
                "jet",
                "has no velocity at the nozzle: alpha_v and theta v_0/r_0 are not known",
                value=velocity,
                remedy="give the velocities of the beads",
            )
        return Feed(r0, velocity)

    @property
    def strands(self) -> Strands:
        """Entanglements of the chains.

        Raises
        ------
        InputError
            Where the molar mass, or that between entanglements, is not known.
        """
        laws = self.scene.rheology
        chains = self.solution.entanglement(self.scene.network.solvent_quality)
        rouse, release, loss = (
            (None, 1.0, 0.3) if laws is None else (laws.rouse_time, laws.constraint_release, laws.entanglement_release)
        )
        return Strands(chains.entanglements, None if rouse is None else rouse.value, release, loss)

    @property
    def air(self) -> Air:
        """Air and solvents.

        Raises
        ------
        InputError
            For what evaporation needs and the scene does not give.
        """
        return self._once(self._shared, "air", lambda: build_air(self.scene, self.solution))

    @property
    def heated_air(self) -> "HeatedAir":
        """Air and solvents with their heats.

        Raises
        ------
        InputError
            For what a jet that cools needs and the scene does not give.
        """
        return self._once(self._shared, "heated air", self._heated_air)

    def _heated_air(self) -> "HeatedAir":
        from spinline.setup.heat import build_heated_air

        return build_heated_air(self.scene, self.solution)

    @property
    def material(self) -> Material:
        """Laws of the solution as it dries."""
        return self._once(self._shared, "material", lambda: build_material(self.scene, self.solution))

    @property
    def diffusion(self) -> "DiffusionLaw":
        """Diffusion of solvent in the jet."""
        return self._once(self._shared, "diffusion", lambda: diffusion_law(self.scene))

    @property
    def glass(self) -> tuple[float, str]:
        """Fraction that turns to glass and where it comes from."""
        return self._once(self._shared, "glass", lambda: glass_fraction(self.scene, self.solution))

    @property
    def ages(self) -> FloatArray:
        """Age of the elements of a bead jet, (..., element), s."""
        return self._bead_ages[0]

    @property
    def bead_flow_rate(self) -> float:
        """Flow rate that the motion of a bead jet implies, m3/s; NaN where there is none."""
        return self._bead_ages[1]

    @property
    def lateral_place(self) -> float:
        """Where the time to contract is taken along a straight jet, m: the crossover, or the end."""
        at = float(self.line.position_of(self.rest.full_stretch))
        return min(at, self.length) if at == at else self.length

    @property
    def lateral_time(self) -> float:
        """F there; NaN where alpha_v is not known."""
        from spinline.network.lateral import lateral_time

        alpha, jet = self.coupling.alpha, self.line
        if np.isnan(alpha):
            return float("nan")
        pace = jet.initial_velocity / jet.initial_radius
        return float(lateral_time(jet.residence_time(self.lateral_place), alpha, pace, self.scene.network.spring.value))

    def grid(self, points: int, share: float = 1.0) -> FloatArray:
        """Places along a straight jet, fine at its start, its kinks among them, over a share of its length."""
        jet = self.line
        end = self.length if share == 1.0 else jet.start + share * (self.length - jet.start)
        return np.asarray(self._once(self._own, f"grid {points} {share}", lambda: jet_grid(jet, end, points)))

    @property
    def _bead_ages(self) -> tuple[FloatArray, float]:
        from spinline.jetprofile.bead_age import bead_ages

        return self._once(self._own, "ages", lambda: bead_ages(self.beads))

    def _rest(self) -> Rest:
        mesh = network_at_rest(self.solution.volume_fraction, self.scene.network.solvent_quality)
        return Rest(float(mesh.size), float(mesh.segments), float(mesh.full_stretch))

    def _once(self, kept: dict[str, Any], name: str, make: Callable[[], _T]) -> _T:
        if name not in kept:
            kept[name] = make()
        value: _T = kept[name]
        return value
