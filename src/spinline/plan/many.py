"""The choice of `spinline.plan.choice` for many scenes at once, where elastic slip alone decides it.

The same estimate on the same places as `spinline.plan.estimates.elastic_coupling_effect`, by formulas without the carried
rounding of single runs. A row whose estimate is so near the tolerance that the rounding could decide is left to its own plan.
About 30 us a row.
"""

from collections.abc import Iterator

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.network.mesh import rest_force
from spinline.plan.estimates import MARGIN, UNSTEADY
from spinline.setup.batch import Batch

__all__ = ["slipping_rows"]

_POINTS = 201  # as in `estimates`
_NEAR = 1e-8  # of what decides: closer, the row plans for itself
_TOGETHER = 64  # rows, so that their arrays stay in the cache


def slipping_rows(batch: Batch, *targets: FloatArray) -> tuple[BoolArray, BoolArray]:
    """Rows that a plan gives to a network that slips, and those for which that is certain either way.

    Parameters
    ----------
    batch : Batch
        Usable rows, effects switched off or idle, "force" closure.
    *targets : ndarray, (rows,)
        V of the criteria.

    Returns
    -------
    slips, certain : ndarray of bool, (rows,)
    """
    slips, known = np.zeros(batch.rows, dtype=bool), np.zeros(batch.rows, dtype=bool)
    if batch.coupling is None:
        return slips, known
    for rows, part in _pieces(batch):
        error, doubtful = _error(part, [target[rows] for target in targets])
        wanted = part.all("accuracy.rtol") / MARGIN
        slips[rows] = error > wanted
        known[rows] = part.usable & ~doubtful & (np.abs(error - wanted) > _NEAR * wanted)
    return slips, known


def _pieces(batch: Batch) -> Iterator[tuple[slice, Batch]]:
    for start in range(0, batch.rows, _TOGETHER):
        rows = slice(start, min(start + _TOGETHER, batch.rows))
        yield rows, batch.taking(rows)


def _error(batch: Batch, targets: list[FloatArray]) -> tuple[FloatArray, BoolArray]:
    """What slip changes in every row, and whether its rounding could."""
    z = _places(batch)
    jets = batch.jets
    v = jets.velocity_ratio(z)
    pace = np.reshape(jets.initial_radius / jets.initial_velocity, (-1, 1))
    eps = np.broadcast_to(batch.of("network.spring") / np.asarray(batch.coupling), (batch.rows,))
    first = eps[:, None] * jets.strain_rate(z) * pace
    number = first.max(axis=1)
    steady = number <= UNSTEADY
    first = np.where(steady[:, None], first, 0.0)
    w = v * (1 + first + 2 * first**2)
    error = _change(batch, v, w)
    doubtful = np.abs(number - UNSTEADY) < _NEAR
    for target in (batch.full_stretch, *targets):
        here, there = _passage(z, w, target), _passage(z, v, target)
        for stretch in (w, v):
            doubtful |= (np.abs(stretch - target[:, None]) < _NEAR * target[:, None]).any(axis=1)
        odd = np.isnan(here) != np.isnan(there)
        with np.errstate(divide="ignore", invalid="ignore"):
            moved = np.where(there > 0, np.abs(here / there - 1), 0.0)
        error = np.fmax(error, np.where(odd, np.maximum(error, 1.0), moved))
    return np.where(steady, error, np.maximum(1.0, number)), doubtful


def _places(batch: Batch) -> FloatArray:
    """Places as `estimates` takes them, (rows, points + 1), m: those of `spinline.setup.grid.jet_grid` with its kink."""
    jets = batch.jets
    r0 = np.broadcast_to(jets.initial_radius, (batch.rows,))
    end = np.broadcast_to(batch.length, (batch.rows,))
    kink = np.broadcast_to(jets.onset, (batch.rows,)) * r0
    scale = np.where(kink > 0, np.minimum(kink, r0), r0)
    share = np.linspace(0.0, 1.0, _POINTS)
    grid = scale[:, None] * np.expm1(share * np.log1p(end / scale)[:, None])
    grid[:, -1] = end
    inside = (kink > 0) & (kink < end)
    places = np.concatenate((np.minimum(grid, end[:, None]), np.where(inside, kink, end)[:, None]), axis=1)
    places.sort(axis=1)
    return places


def _change(batch: Batch, v: FloatArray, w: FloatArray) -> FloatArray:
    """Largest change of stretch, core fraction and orientation, as `estimates.change`, of the affine force."""
    phi = batch.volume_fraction[:, None]
    rest, full = rest_force(phi, batch.scene.network.solvent_quality)[0], batch.full_stretch[:, None]
    moved, affine = _walk(rest * w, rest, full, phi), _walk(rest * v, rest, full, phi)
    stretch, core = np.abs(moved[0] / affine[0] - 1), np.abs(moved[2] / affine[2] - 1)
    largest: FloatArray = np.maximum(np.maximum(stretch, core), np.abs(moved[1] - affine[1])).max(axis=1)
    return largest


def _walk(
    force: FloatArray, rest: FloatArray, full: FloatArray, phi: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Extension, orientation and core fraction of strands under a force, Eqs. (36) and (40)."""
    fade = np.exp(-force)
    square = fade * fade
    partition = 0.5 * (1 + square) + 2 * np.cosh(rest) * fade
    lateral = (full * np.sinh(rest) * fade / partition) ** 2
    return (
        0.5 * (1 - square) / partition,
        (0.5 * (1 + square) - np.cosh(rest) * fade) / partition,
        phi / np.maximum(lateral, phi),
    )


def _passage(z: FloatArray, stretch: FloatArray, target: FloatArray) -> FloatArray:
    """First place in every row where a stretch passes its value, NaN where never; between places in the logarithm."""
    above = stretch >= target[:, None]
    k = np.maximum(above.argmax(axis=1), 1)
    rows = np.arange(len(z))
    low, high = np.log(stretch[rows, k - 1]), np.log(stretch[rows, k])
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(high > low, (np.log(target) - low) / (high - low), 1.0)
    place = z[rows, k - 1] + np.clip(share, 0.0, 1.0) * (z[rows, k] - z[rows, k - 1])
    return np.where(above.any(axis=1), place, np.nan)
