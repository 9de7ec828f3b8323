"""Scenes for which a plan is certain to take the simplest rung, many at once, by a bound on its estimate of the elastic slip.

With ``d = eps V'`` at its largest the stretch changes by ``1.1 d`` at most, the core's fraction by ``2 f`` times that with f up
to that of compaction, the orientation by 1.3 times, the place of a crossover by ``1/(2 beta)`` times. A crossover near the end
of the jet could come or go: such rows are left to the plan itself.
"""

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.network.concentration import compaction_velocity_ratio
from spinline.network.mesh import rest_force
from spinline.plan.estimates import MARGIN
from spinline.setup.batch import Batch

__all__ = ["surely_simplest"]

_MOST_SLIP = 0.05
_NEAR_REST = 1.5  # V of a crossover, below which its place is too sensitive for the bound


def surely_simplest(batch: Batch, *targets: FloatArray) -> BoolArray:
    """Rows for which `spinline.plan` takes the simplest rung, (rows,); `targets` are V of the criteria."""
    phi, quality, jets, alpha = batch.volume_fraction, batch.scene.network.solvent_quality, batch.jets, batch.coupling
    if alpha is None:
        return np.zeros(phi.shape, dtype=bool)
    slip = batch.of("network.spring") / alpha * jets.steepest(batch.length)
    compact = compaction_velocity_ratio(phi, quality) * rest_force(phi, quality)[0]
    sure = (slip < _MOST_SLIP) & (MARGIN * (3.5 * compact + 5) * slip < batch.of("accuracy.rtol"))
    end = jets.velocity_ratio(np.atleast_1d(batch.length))
    for target in targets:
        v = np.maximum(target, 1e-300)
        sure = sure & (v > _NEAR_REST) & (np.abs(np.log(v / end)) > 3 * slip + 1e-6)
    return np.broadcast_to(sure, phi.shape)
