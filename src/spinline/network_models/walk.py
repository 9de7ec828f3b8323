"""Rung ``walk``: strands sampled one by one under the affine force, as a check of the closures."""

from typing import TYPE_CHECKING, Any

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.network_models.rung import Network, Rung, Setting

if TYPE_CHECKING:
    from spinline.setup.context import Context

__all__ = ["RUNG", "SampledWalk"]


class SampledWalk(Rung):
    """Monte Carlo of the strands, each place with its own."""

    name = "walk"
    words = "strands sampled one by one, with standard errors"
    sampled = True
    lean = False
    cost = "0.1 ms a place and thousand strands"

    def check(self, context: "Context") -> None:
        """Refuse another closure than the force."""
        if context.scene.network.closure_used != "force":
            raise InputError(
                "network.closure",
                "gives no force at the ends of a strand, and a strand walks under one",
                value=context.scene.network.closure_used,
                allowed='"force"',
                remedy="take one of those",
            )
        super().check(context)

    def fields(
        self, context: "Context", fields: dict[str, FloatArray], network: Network | None
    ) -> dict[str, FloatArray]:
        """Sampled conformation with its standard errors, strand by strand."""
        from spinline.network.walk import sample_strands
        from spinline.network.walk.estimate import sample_moments
        from spinline.network.walk.strand import affine_strand

        accuracy, rest = context.scene.accuracy, context.rest
        phi, quality, count = context.solution.volume_fraction, context.scene.network.solvent_quality, accuracy.strands
        stretch = fields["stretch_ratio"]
        names = ("axial_stretch", "radial_contraction", "orientation")
        sampled = {name: np.full(stretch.shape, np.nan) for base in names for name in (base, f"{base}_std_error")}
        for number, place in enumerate(np.argwhere(np.isfinite(stretch))):
            at = tuple(place)
            strand = affine_strand(float(stretch[at]), phi, solvent_quality=quality)
            # every place has strands of its own: neighbouring places do not share their noise
            moments = sample_moments(sample_strands(strand, count, accuracy.seed, first=number * count))
            size = strand.segments / rest.segments * rest.size  # N_s is a whole number
            sampled["axial_stretch"][at] = moments.mean[2] / size
            sampled["axial_stretch_std_error"][at] = moments.mean_error[2] / size
            sampled["radial_contraction"][at] = 0.5 * (moments.mean[0] + moments.mean[1]) / size
            error = np.hypot(moments.mean_error[0], moments.mean_error[1])
            sampled["radial_contraction_std_error"][at] = error / (2 * size)
            sampled["orientation"][at] = moments.orientation
            sampled["orientation_std_error"][at] = moments.orientation_error
        sampled["relative_extension"] = sampled["axial_stretch"] / rest.full_stretch
        return sampled

    def attributes(self, context: "Context", network: Network | None) -> dict[str, Any]:
        """How many strands, and which."""
        return {"strands": context.scene.accuracy.strands, "seed": context.scene.accuracy.seed}

    def settings(self, context: "Context", quick: bool) -> list[Setting]:
        """Two numbers of strands."""
        return [] if quick else [Setting(f"{n} strands", {"strands": n}) for n in (1000, 10_000)]


RUNG = SampledWalk()
