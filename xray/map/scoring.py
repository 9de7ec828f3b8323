"""The largest penalised Poisson likelihood of a map, with the weights of the roughness that its counts ask for.

Each turn evaluates all rows, updates the weights on the quadratic likelihood of that turn (`map_smoothing`; only once the start
is forgotten, lest a wrong radius is taken for detail), and takes a step of Fisher scoring with them, cut until deviance and
roughness together fall. It ends where a step is under 7 % of a standard deviation, all unknowns together, and the weights have
settled.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.xray.map.band import Factor, assembled, factorised
from spinline.xray.map.basis import AxialBasis, RadialBasis
from spinline.xray.map.data import MapData, Start
from spinline.xray.map.result import MapState
from spinline.xray.map.rows import row_curvature
from spinline.xray.map.smoothing import Penalty
from spinline.xray.row.forward import Absorber
from spinline.xray.row.model import NUISANCES

__all__ = ["BestMap", "MapModel", "best_map"]

_TURNS = 40
_TOLERANCE = 5e-3
_SWEEPS = 8
_WEIGHT_TURNS = 12  # then the weights stay
_NEAR = 1.0  # squared step, in standard deviations, per unknown: what is left is noise rather than a wrong start
_HALVINGS = 8
_STIFFEST = 1e6  # of a first weight against the counts, for what they tell is not to be lost in rounding
_FIRST_CHANGES = {  # what a difference of coefficients may be, before the counts are asked
    "fraction across, core": 0.01,
    "fraction across, rim": 0.01,
    "fraction along": 0.003,
    "radius": 0.5,
    "axis": 0.3,
    "amplitude": 0.003,
    "slope": 0.003,
    "blur": 0.02,
}


@dataclass(frozen=True, eq=False)
class Look:
    """All rows at one point; Pearson's chi-square over the scatter of each row's pixels."""

    local: FloatArray
    fisher: FloatArray
    gradient: FloatArray
    deviance: float
    pearson: float
    inverse_means: float


class MapModel:
    """Counts of a map for coefficients of shape (splines along z, splines across + fitted nuisances)."""

    def __init__(
        self,
        data: MapData,
        radial: RadialBasis,
        axial: AxialBasis,
        absorber: Absorber,
        names: Sequence[str],
        parts: int,
        reach: int,
        offsets: FloatArray | None = None,
    ) -> None:
        self.data, self.radial, self.axial, self.names = data, radial, axial, tuple(names)
        self.base = (absorber.solvent - absorber.air) * data.pixel * data.path
        self.contrast = absorber.contrast * data.pixel * data.path
        self.offsets = offsets
        self.parts, self.reach = parts, reach
        n = radial.size
        self.free = np.array([*range(n), *(n + NUISANCES.index(name) for name in names)])
        self.penalty = Penalty.of(radial, axial, self.names)

    def local(self, held: FloatArray, coefficients: FloatArray) -> FloatArray:
        """Parameters of each row, in the order of `map_rows`."""
        out = np.empty((held.shape[0], self.radial.size + len(NUISANCES)))
        out[:, self.radial.size :] = held
        out[:, self.free] = self.axial.along(coefficients)
        if self.offsets is not None:
            out[:, self.radial.size + 1] += self.offsets
        return out

    def look(self, held: FloatArray, coefficients: FloatArray) -> Look | None:
        """Likelihood of the counts and its derivatives; None where the model has no meaning."""
        local = self.local(held, coefficients)
        if not self._allows(local):
            return None
        rows, width = local.shape
        fisher, gradient = np.empty((rows, width, width)), np.empty((rows, width))
        score = np.empty((rows, 4))
        d = self.data
        row_curvature(
            d.counts,
            d.good,
            d.flat,
            d.dark,
            d.veil,
            local,
            self.radial.table,
            self.base,
            self.contrast,
            self.parts,
            self.reach,
            d.tail,
            fisher,
            gradient,
            score,
        )
        deviance, _, inverse_means, dark = score.sum(axis=0)
        pearson = (score[:, 1] / d.scatter).sum()
        if dark > 0.0 or not np.isfinite(deviance):
            return None
        part = np.ix_(np.arange(rows), self.free, self.free)
        return Look(local, fisher[part], gradient[:, self.free], float(deviance), float(pearson), float(inverse_means))

    def _allows(self, local: FloatArray) -> bool:
        if not np.isfinite(local).all():
            return False
        n, pixels = self.radial.size, self.data.counts.shape[1]
        radius, axis, amplitude, slope, blur = local[:, n:].T
        lengths = (radius > 0.2) & (radius < 2.0 * pixels) & (np.abs(axis) < 0.5 * pixels)
        beam = (amplitude > 0.0) & (np.abs(slope) < 1.0)
        depth = (self.base[:, None] + self.contrast[:, None] * local[:, :n]).min(axis=1) * 2.0 * radius
        sharp = np.ones_like(lengths)
        if self.reach:
            sharp = (blur * self.parts > 0.1) & (blur * self.parts * 5.5 < self.reach * 1.001)
        return bool((lengths & beam & sharp & (depth > -20.0)).all())


@dataclass(frozen=True, eq=False)
class BestMap:
    """Where the fit ended."""

    coefficients: FloatArray
    look: Look
    weights: FloatArray
    factor: Factor
    converged: bool
    settled: bool
    turns: int


def best_map(
    model: MapModel,
    held: FloatArray,
    start: Start,
    begun: MapState | None = None,
    keep: Callable[[MapState], None] | None = None,
) -> BestMap:
    """Maximise the likelihood from a start; `held` has the nuisances that are not fitted, shape (rows, 5).

    `begun` is the last state that an interrupted search passed to `keep`.
    """
    penalty = model.penalty
    first = np.array([_FIRST_CHANGES[name] ** -2.0 for name in penalty.names])
    weights = first
    c = _first(model, held, start)
    settled = converged = near = False
    turns = changes = 0
    if begun is not None and begun.coefficients.shape == c.shape and begun.weights.shape == first.shape:
        c, weights, near, settled = begun.coefficients, begun.weights, begun.near, begun.settled
        turns, changes = begun.turns, begun.changes
    here = model.look(held, c)
    if here is None:
        raise InputError("radius", "the fit cannot start from here", remedy="give radius and axis near the jet's")
    try:
        while turns < _TURNS:
            if keep is not None:
                keep(MapState(c, weights, near, settled, turns, changes))
            turns += 1
            matrix, right = assembled(model.axial, here.fisher, here.gradient)
            if not changes:
                weights = np.minimum(first, _STIFFEST * penalty.balance(matrix))
            sweeps = _SWEEPS if near and changes < _WEIGHT_TURNS else 0
            weights, proposed, now = penalty.improved(matrix, right, c, weights, sweeps)
            settled = now if sweeps else settled
            changes += sweeps > 0
            step = proposed - c
            gain = float((step * (right - penalty.applied(c, weights))).sum())
            near = near or gain < _NEAR * c.size
            if gain < _TOLERANCE and near and (settled or changes >= _WEIGHT_TURNS):
                converged = True
                break
            found = _fallen(model, held, c, here, step, gain, weights)
            if found is None:
                if near and not changes:
                    continue
                converged = gain < 1.0  # a kink: edges that cross pixels of few counts
                break
            c, here = found
        matrix, _ = assembled(model.axial, here.fisher, here.gradient)
        factor = factorised(penalty.added(matrix, weights))
    except np.linalg.LinAlgError:
        raise InputError(
            "nuisances",
            "the counts cannot tell the unknowns apart",
            remedy="fit fewer nuisances, give radius and axis, or keep air in view on both sides",
        ) from None
    return BestMap(c, here, weights, factor, converged, settled, turns)


def _fallen(
    model: MapModel, held: FloatArray, c: FloatArray, here: Look, step: FloatArray, gain: float, weights: FloatArray
) -> tuple[FloatArray, Look] | None:
    """Coefficients along a step where deviance and roughness together are lower, with the look at them."""
    penalty = model.penalty
    value = here.deviance + float(weights @ penalty.roughness(c))
    share = 1.0
    best: tuple[float, FloatArray, Look] | None = None
    for look in range(_HALVINGS):
        at = c + share * step
        there = model.look(held, at)
        if there is None:
            share *= 0.4
            continue
        total = there.deviance + float(weights @ penalty.roughness(at))
        if best is None or total < best[0]:
            best = total, at, there
        _, right = assembled(model.axial, there.fisher[:, :0, :0], there.gradient)
        slope = float((step * (right - penalty.applied(at, weights))).sum())
        if best[0] < value and (look or slope > -0.3 * gain):
            break
        # overshot: the noise of few counts bends the likelihood more than its expectation does
        share *= min(max(gain / (gain - slope), 0.1), 0.8) if slope < 0.0 else 0.4
    return None if best is None or best[0] >= value else best[1:]


def _first(model: MapModel, held: FloatArray, start: Start) -> FloatArray:
    """Coefficients near a start: one fraction for all, curves smoothed."""
    rows = held.shape[0]
    fraction = (start.depth - float(model.base.mean())) / float(model.contrast.mean())
    axis = start.axis if model.offsets is None else start.axis - model.offsets
    wanted = {"radius": start.radius, "axis": axis, "amplitude": start.amplitude}
    curves = [wanted.get(name, held[:, NUISANCES.index(name)]) for name in model.names]
    out = np.empty((model.axial.size, model.free.size))
    out[:, : model.radial.size] = min(max(fraction, 0.0), 1.0)
    if curves:
        y = np.stack(curves, axis=1)
        count = y.shape[1]
        matrix, right = assembled(model.axial, np.broadcast_to(np.eye(count), (rows, count, count)).copy(), y)
        one = np.arange(count)
        matrix[:, :, one, one] += model.axial.penalty[:, :, None]
        matrix[:, 0, one, one] += 1e-9
        out[:, model.radial.size :] = factorised(matrix).solve(right)
    return out
