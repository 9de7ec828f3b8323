"""What the steady rungs see of a jet, straight or of beads: V along it, its pace, and how far it is known."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.jetprofile.straight import StraightJet
from spinline.network_models.rung import Network

if TYPE_CHECKING:
    from spinline.setup.context import Context

__all__ = ["Course", "Networks", "course_of", "solved_on"]


@dataclass(frozen=True, eq=False)
class Course:
    """One moment of a jet in initial radii and velocities.

    Attributes
    ----------
    profile : callable
        V(s), s from the jet's start.
    length, known_to : float
        Last station, and how far V is known (inf for a law).
    stations : ndarray
        Where results are wanted.
    breaks : tuple of float
        Places where V is not smooth.
    coupling : float
        alpha_v.
    pace : float
        ``v_0/r_0``, 1/s.
    """

    profile: Callable[[FloatArray], FloatArray]
    length: float
    known_to: float
    stations: FloatArray
    breaks: tuple[float, ...]
    coupling: float
    pace: float


@dataclass(frozen=True, eq=False)
class Networks:
    """Steady networks of a bead jet, one a moment; what is asked of one is the last one's or the largest.

    Attributes
    ----------
    moments : list of Network
    """

    moments: "list[Network]"

    @property
    def length(self) -> float:
        """Last station of the last."""
        return self.moments[-1].length

    @property
    def inertia(self) -> float:
        """I."""
        return self.moments[-1].inertia

    @property
    def locked_from(self) -> float:
        """Of the last."""
        return self.moments[-1].locked_from

    @property
    def far_end_effect(self) -> float:
        """The largest."""
        return max(float(getattr(one, "far_end_effect", 0.0)) for one in self.moments)

    def stretch(self, s: FloatArray) -> FloatArray:
        """Of the last."""
        return self.moments[-1].stretch(s)

    def velocity_ratio(self, s: FloatArray) -> FloatArray:
        """Of the last."""
        return velocity_of(self.moments[-1], s)

    def tension(self, s: FloatArray) -> FloatArray:
        """Of the last."""
        return self.moments[-1].tension(s)

    def first_passage(self, stretch: float) -> float:
        """Of the last."""
        return self.moments[-1].first_passage(stretch)


def course_of(context: "Context") -> Course:
    """One moment of a jet as the steady rungs see it.

    Raises
    ------
    InputError
        Where alpha_v or the jet's velocity is not known.
    """
    if context.straight:
        jet = context.line
        r0, length = jet.initial_radius, context.length - jet.start
        places = context.grid(min(context.scene.accuracy.points, 401))
        return Course(
            _profile_of(jet),
            length / r0,
            (jet.end - jet.start) / r0,
            np.clip((places - jet.start) / r0, 0.0, length / r0),
            jet.kinks(),
            context.coupling.required(),
            jet.initial_velocity / r0,
        )
    beads = context.beads
    r0 = beads.initial_radius
    arc = np.asarray(beads.arc_length[beads.usable], dtype=np.float64) / r0
    level = np.log(np.asarray(beads.stretch[beads.usable], dtype=np.float64))
    nodes, levels = np.concatenate(([0.0], arc)), np.concatenate(([0.0], level))
    length = float(arc[-1])
    return Course(
        lambda s: np.exp(np.interp(s, nodes, levels)),
        length,
        length,
        arc,
        tuple(arc.tolist()),
        context.coupling.required(),
        context.feed.initial_velocity / r0,
    )


def _profile_of(jet: StraightJet) -> Callable[[FloatArray], FloatArray]:
    """V(s) of a straight jet, in initial radii from its start."""
    formula, r0 = jet.formula(), jet.initial_radius
    if formula is None:
        return lambda s: jet.velocity_ratio(np.minimum(jet.start + s * r0, jet.end))
    from spinline.network.manifold import AlgebraicFlow

    return AlgebraicFlow(*formula)


def velocity_of(network: Network, s: FloatArray) -> FloatArray:
    """Velocity of a network over v_0; the stretch of its strands where it says no other."""
    other = getattr(network, "velocity_ratio", None)
    value: FloatArray = network.stretch(s) if other is None else other(s)
    return value


def solved_on(context: "Context", network: Network, of: Callable[[Network, FloatArray], FloatArray]) -> FloatArray:
    """A quantity of a network on the elements of a bead jet, in the shape of its stretch; NaN where there is none."""
    beads = context.beads
    full = np.full(beads.stretch.shape, np.nan)
    moments = network.moments if isinstance(network, Networks) else [network]
    rows = full if beads.time is not None else full[np.newaxis]
    for row, frame, one in zip(rows, context.frames, moments, strict=True):
        usable = frame.beads.usable
        row[usable] = of(one, frame.beads.arc_length[usable] / beads.initial_radius)
    return full
