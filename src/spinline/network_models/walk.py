"""Rung ``walk``: strands sampled one by one under the tension of another rung, as a check of the closures.

``network.walk_tension`` names that rung, the affine network by default. It is solved as it is alone, effects and all; what it
says of the network and the concentration stays, and the conformation of the strands is sampled: at every place walks of N_s
steps on the lattice, under the force ``f = F b/(k_B T)`` that a strand bears there. Under a network that slips this is ``f_0
T``, T by ``network.force_law``: with the lattice's law the walks come back to the stretch that was solved for; with another
they say what that law is worth.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network_models.rung import Network, Relaxed, Rung, Setting

if TYPE_CHECKING:
    from spinline.setup.context import Context
    from spinline.setup.history import History

__all__ = ["RUNG", "SampledWalk"]

_STRONGEST = 1e300  # a strand at its contour is walked under this


class SampledWalk(Rung):
    """Monte Carlo of the strands, each place with its own, under the tension of a rung; of none, what all have in common."""

    name = "walk"
    words = "strands sampled one by one, with standard errors, under any rung's tension"
    sampled = True
    lean = False
    cost = "0.1 ms a place and thousand strands"

    def __init__(self, mover: Rung | None = None) -> None:
        self.mover = Rung() if mover is None else mover
        self.slips, self.relaxes = self.mover.slips, self.mover.relaxes
        self.holds, self.needs = self.mover.holds, self.mover.needs

    def under(self, mover: Rung) -> "SampledWalk":
        """The walk under the tension of a rung."""
        return SampledWalk(mover)

    def check(self, context: "Context") -> None:
        """Refuse what the rung below cannot do, and strands that move with the jet at a given stretch: they bear no force."""
        closure = context.scene.network.closure_used
        if closure != "force" and not self.holds:
            raise InputError(
                "network.closure",
                "gives no force at the ends of a strand, and a strand walks under one",
                value=closure,
                allowed='"force"',
                remedy="take that, or another network.walk_tension",
            )
        self.mover.check(context)

    def require(self, context: "Context") -> None:
        """What the rung below needs."""
        self.mover.require(context)

    def remarks(self, context: "Context") -> list[str]:
        """Of the rung below."""
        return self.mover.remarks(context)

    def solve(self, context: "Context") -> Network | None:
        """Network of the rung below."""
        return self.mover.solve(context)

    def relax(self, context: "Context", history: "History") -> Relaxed:
        """By the rung below."""
        return self.mover.relax(context, history)

    def solved_remarks(self, context: "Context", network: Network) -> list[str]:
        """Of the rung below."""
        return self.mover.solved_remarks(context, network)

    def fields(
        self, context: "Context", fields: dict[str, FloatArray], network: Network | None
    ) -> dict[str, FloatArray]:
        """Sampled conformation with its standard errors, strand by strand."""
        from spinline.network.disentanglement import strand_fraction, strands_at_rest
        from spinline.network.mesh import rest_force
        from spinline.network.walk import sample_strands
        from spinline.network.walk.estimate import sample_moments
        from spinline.network.walk.strand import MOST_SEGMENTS, uniform_strand

        accuracy, quality = context.scene.accuracy, context.scene.network.solvent_quality
        force, count = self.mover.strand_tension(context, fields, network), accuracy.strands
        left = np.nan_to_num(fields.get("entanglements_left", np.ones(force.shape)), nan=1.0)
        phi = strand_fraction(context.solution.volume_fraction, left, quality)
        rest = strands_at_rest(context.solution.volume_fraction, left, quality)
        longest = float(rest.segments.max(initial=0.0))
        if longest > MOST_SEGMENTS:
            raise InputError(
                "solution.volume_fraction",
                f"has strands of {longest:.3g} segments",
                value=context.solution.volume_fraction,
                allowed=f"strands of at most {MOST_SEGMENTS:.0e} segments",
                remedy="raise it, or take another network.model",
            )
        names = ("axial_stretch", "radial_contraction", "orientation", "relative_extension")
        sampled = {
            name: np.full(force.shape, np.nan)
            for base in names
            for name in ((base, f"{base}_std_error") if base != "relative_extension" else (base,))
        }
        for number, place in enumerate(np.argwhere(~np.isnan(force))):
            at = tuple(place)
            segments = round(float(rest.segments[at]))
            strand = uniform_strand(segments, min(float(force[at]), _STRONGEST), float(rest_force(phi[at], quality)[0]))
            # every place has strands of its own: neighbouring places do not share their noise
            moments = sample_moments(sample_strands(strand, count, accuracy.seed, first=number * count))
            size = segments / float(rest.segments[at]) * float(rest.size[at])  # N_s is a whole number
            sampled["axial_stretch"][at] = moments.mean[2] / size
            sampled["axial_stretch_std_error"][at] = moments.mean_error[2] / size
            sampled["radial_contraction"][at] = 0.5 * (moments.mean[0] + moments.mean[1]) / size
            error = np.hypot(moments.mean_error[0], moments.mean_error[1])
            sampled["radial_contraction_std_error"][at] = error / (2 * size)
            sampled["orientation"][at] = moments.orientation
            sampled["orientation_std_error"][at] = moments.orientation_error
            sampled["relative_extension"][at] = moments.mean[2] / size / float(rest.full_stretch[at])
        return self.mover.fields(context, fields, network) | sampled

    def scalars(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """Of the rung below."""
        return self.mover.scalars(context, network)

    def attributes(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """How many strands, and which, under whose tension."""
        accuracy = context.scene.accuracy
        own = {"walk_tension": self.mover.name, "strands": accuracy.strands, "seed": accuracy.seed}
        return self.mover.attributes(context, network) | own

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """Two numbers of strands, under the affine force."""
        return [] if quick else [Setting(f"{n} strands", {"strands": n}) for n in (1000, 10_000)]


RUNG = SampledWalk()
