"""What a rung of the ladder is: an object with its traits as data and one method that solves.

A rung is one file that ends in ``RUNG = MyRung()`` and one line in `spinline.network_models.registry`; the plan, the trade, the
report, the command line and the docs read its traits. How to add one: CONTRIBUTING.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError

if TYPE_CHECKING:
    from spinline.setup.batch import Batch
    from spinline.setup.context import Context
    from spinline.setup.history import History

__all__ = ["RUNGS", "Network", "Relaxed", "Rung", "Setting", "cheapest", "rung_of", "simplest"]


class Network(Protocol):
    """A network that moves by itself, solved along a straight jet; s in initial radii from the jet's start.

    What has a method ``velocity_ratio(s)`` besides moves otherwise than its strands are stretched.
    """

    @property
    def length(self) -> float:
        """Far end, initial radii."""

    @property
    def inertia(self) -> float:
        """I."""

    @property
    def locked_from(self) -> float:
        """First place beyond 0.95 of the contour, initial radii; NaN if none."""

    def stretch(self, s: FloatArray, /) -> FloatArray:
        """Stretch of the strands, xi_par/xi_0 > 0."""

    def tension(self, s: FloatArray, /) -> FloatArray:
        """Tension T over that at rest."""

    def first_passage(self, stretch: float, /) -> float:
        """First s where the stretch passes a value; NaN where it never does."""


@dataclass(frozen=True, eq=False)
class Relaxed:
    """Strands that have given stretch back, at the samples of a `History`.

    Attributes
    ----------
    stretch : ndarray, (n,)
        w, over the size at rest.
    fields : dict
        Further variables along the jet, by their names in a result.
    words : str
        The constitutive model.
    remarks : tuple of str
        What is odd about them.
    """

    stretch: FloatArray
    fields: dict[str, FloatArray]
    words: str
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Setting:
    """A rung as `spinline trade` runs it: a label, and changes of ``[network]`` and ``[accuracy]``."""

    label: str
    changes: dict[str, Any] = field(default_factory=dict)


class Rung:
    """A rung of the ladder; a new one overrides what it does otherwise.

    Attributes
    ----------
    name : str
        Value of ``network.model``.
    words : str
        What it is, in a line.
    holds : tuple of str
        Names of the effects that it holds.
    needs : tuple of str
        What it cannot do without: "straight jet", "alpha_v", "relaxation time".
    slips : bool
        Its network does not move with the solution: `solve` gives it.
    relaxes : bool
        Its strands give stretch back: `relax` does it.
    sampled : bool
        Too slow, or too noisy, to be repeated for every uncertain input.
    lean : bool
        Its numbers do not depend on how many places are written.
    many : bool
        `rows` may serve it.
    automatic : bool
        `network.model = "auto"` may take it.
    branch : str
        "elastic" or "relaxation": which effect it is the reference of in a trade; empty for none.
    cost : str
        Of a run, in words.
    """

    name: str = ""
    words: str = ""
    holds: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    slips: bool = False
    relaxes: bool = False
    sampled: bool = False
    lean: bool = True
    many: bool = False
    automatic: bool = False
    branch: str = ""
    cost: str = ""

    def check(self, context: "Context") -> None:
        """Refuse a scene that this rung cannot do.

        Raises
        ------
        InputError
        """
        n = context.scene.network
        if "straight jet" in self.needs and not context.straight:
            raise InputError(
                "network.model",
                "needs a straight jet",
                value=self.name,
                remedy=f'take "{simplest().name}" for a bead jet',
            )
        if not self.slips and n.force_law != "lattice":
            others = " or ".join(f'"{rung.name}"' for rung in RUNGS.values() if rung.slips)
            raise InputError(
                "network.force_law",
                "is not used by the affine network",
                value=n.force_law,
                allowed='"lattice"',
                remedy=f"take model = {others} for other laws",
            )

    def require(self, context: "Context") -> None:
        """Refuse where data are missing that not even a plan can do without.

        Raises
        ------
        InputError
        """
        if "alpha_v" in self.needs and context.straight:
            context.coupling.required()

    def remarks(self, context: "Context") -> list[str]:
        """What is odd about a scene that it takes."""
        return []

    def under(self, mover: "Rung") -> "Rung":
        """Itself, unless it needs another rung to say what its strands bear."""
        return self

    def strand_tension(self, context: "Context", fields: dict[str, FloatArray], network: Network | None) -> FloatArray:
        """Axial force ``f = F b/(k_B T)`` on a strand, in the shape of the stretch; of a network that moves with the jet.

        inf where strands are at their contour.
        """
        from spinline.network.state import network_state

        n, lam = context.scene.network, fields["strand_stretch"]
        known = np.isfinite(lam)
        force = np.full(lam.shape, np.nan)
        left = fields.get("entanglements_left")
        force[known] = network_state(
            lam[known],
            lam[known],
            context.solution.volume_fraction,
            entanglements_left=None if left is None else left[known],
            closure=n.closure_used,
            solvent_quality=n.solvent_quality,
        ).conformation.force
        return force

    def solve(self, context: "Context") -> Network | None:
        """The network along a straight jet; None where it moves with the solution.

        Raises
        ------
        InputError
            Where there is none.
        """
        return None

    def rows(self, batch: "Batch", places: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Networks along many straight jets at once; None where a rung has no such way.

        Parameters
        ----------
        batch : Batch
            Usable rows, this rung named in its scene.
        places : ndarray, (rows, m)
            Where the stretch is wanted, m; NaN for nowhere.
        target : ndarray, (rows, k)
            Stretches.

        Returns
        -------
        stretch : ndarray, (rows, m)
            NaN throughout a row that has to be run by itself.
        passages : ndarray, (rows, k)
            Where the stretch first passes the target, initial radii; NaN where never.
        """
        return None

    def relax(self, context: "Context", history: "History") -> Relaxed:
        """Strands along a material element; of a rung that relaxes."""
        raise TypeError(f"{self.name} is no rung that relaxes")

    def solved_remarks(self, context: "Context", network: Network) -> list[str]:
        """What is odd about the network that was found."""
        return []

    def fields(
        self, context: "Context", fields: dict[str, FloatArray], network: Network | None
    ) -> dict[str, FloatArray]:
        """Variables that only this rung has, or has better, from those of every rung."""
        return {}

    def scalars(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """Numbers that only this rung has, by their names in a result."""
        return {}

    def attributes(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """What a result says of it."""
        return {}

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """How a trade runs it; none where it cannot be run on the scene."""
        return [Setting("")]

    def finest(self, context: "Context") -> Setting | None:
        """How it serves as the reference of its branch; None where it does not."""
        return None


RUNGS: dict[str, Rung] = {}  # cheapest first; `spinline.network_models.registry` fills it


def rung_of(name: str) -> Rung:
    """The rung of a name that the scene file allows."""
    return RUNGS[name]


def simplest() -> Rung:
    """The rung that holds nothing: what every other is measured against."""
    return next(rung for rung in RUNGS.values() if rung.automatic and not rung.holds)


def cheapest(effects: Iterable[str]) -> Rung | None:
    """The first rung, of those that "auto" may take, that holds all of these effects; None where none does."""
    asked = set(effects)
    return next((rung for rung in RUNGS.values() if rung.automatic and asked <= set(rung.holds)), None)
