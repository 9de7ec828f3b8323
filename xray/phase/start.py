"""Where a jet with fringes is, before anything is fitted: its radius and axis to a fraction of a fringe.

`contact_transmission` folds the fringes back, `start.find_jet` finds the jet to about a pixel, and the fringes of either edge,
shifted until they fit, place it. Where fringes are narrower than a pixel, each edge is tried at 51 places.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import BoolArray, FloatArray, number, positive
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.fresnel import WaveRowModel
from spinline.xray.phase.retrieval import contact_transmission
from spinline.xray.row.block import summed_counts
from spinline.xray.row.chords import equal_shells
from spinline.xray.row.forward import Detector
from spinline.xray.row.scoring import poisson_deviance
from spinline.xray.row.start import find_jet

__all__ = [
    "PLAUSIBLE_FRACTION",
    "PhaseStart",
    "air_level",
    "coarse_place",
    "phase_start",
    "placed",
    "searched",
    "start_ratio",
]

PLAUSIBLE_FRACTION = 0.05  # to start from


class PhaseStart(NamedTuple):
    """A jet placed by its fringes, unfitted, and the deviance of the counts about it."""

    radius: float
    axis: float
    deviance: float


def phase_start(
    counts: ArrayLike,
    medium: Medium,
    detector: Detector,
    distance: float,
    *,
    good: ArrayLike | None = None,
    saturation: float = np.inf,
    cells: int = 8,
) -> PhaseStart:
    """Place the jet by its fringes at a distance, without a fit: to try many distances. Arguments as in `fit_row_phase`."""
    data, rows = summed_counts(counts, detector, good, saturation)
    lit = rows > 0
    ratio = start_ratio(data, rows, lit, detector)
    found_r, found_a = coarse_place(ratio, medium, detector, distance, None, None)
    model = WaveRowModel(detector, equal_shells(1), medium, found_r, cells=cells)
    model.scale_exposure(rows)
    level = air_level(ratio, model, found_r, found_a)
    at = np.array([PLAUSIBLE_FRACTION, found_r, found_a, level, 0.0, detector.blur, distance, 1.0])
    if not model.allows(at):
        return PhaseStart(found_r, found_a, np.inf)
    at = placed(at, model, data, lit, True, True)
    return PhaseStart(float(at[1]), float(at[2]), poisson_deviance(data[lit], model.mean(at)[lit]))


def start_ratio(data: FloatArray, rows: FloatArray, lit: BoolArray, detector: Detector) -> FloatArray:
    """Transmissions for a start: gaps filled, and what no fringe can be (4 times the beam, none of it) left out."""
    at = np.arange(data.size)
    ratio = (data[lit] / rows[lit] - detector.dark[lit]) / detector.flat[lit] - detector.veil[lit]
    level = float(np.median(ratio))
    noise = 8.0 * np.sqrt(np.maximum(data[lit], 1.0)) / (rows[lit] * detector.flat[lit])
    odd = (ratio - noise > 4.0 * level) | (ratio + noise < 0.02 * level)
    kept = ~odd if odd.mean() < 0.1 else np.ones_like(odd)
    return np.interp(at, at[lit][kept], ratio[kept])


def coarse_place(
    ratio: FloatArray, medium: Medium, detector: Detector, z: float, radius: float | None, axis: float | None
) -> tuple[float, float]:
    """Radius and axis to about a pixel, from the row with its fringes folded back."""
    p, half = detector.pixel, 0.5 * detector.pixel * detector.flat.size
    r = None if radius is None else positive("radius", radius, "m") / p
    a = None if axis is None else number("axis", axis, above=-half, below=half, unit="m") / p
    folded = contact_transmission(ratio, p, z, medium.delta_over_mu(PLAUSIBLE_FRACTION))
    found_r, found_a, _ = find_jet(folded, r, a)
    return (found_r if r is None else r) * p, (found_a if a is None else a) * p


def air_level(ratio: FloatArray, model: WaveRowModel, radius: float, axis: float) -> float:
    """Level of the beam outside the jet; fringes even out."""
    x = 0.5 * model.pixel * model.u * (ratio.size - 1)
    outside = np.abs(x - axis) > radius + 0.25 * (0.5 * model.pixel * ratio.size - radius)
    level = float(ratio[outside].mean()) if outside.sum() > 3 else 1.0
    return level if level > 0 else max(float(ratio.mean()), 1e-6)


def placed(
    start: FloatArray, model: WaveRowModel, data: FloatArray, lit: BoolArray, move_radius: bool, move_axis: bool
) -> FloatArray:
    """Radius and axis that put the model's fringes on those of the row, each edge for itself; the likeliest of four looks."""
    k, n = model.shells, data.size
    at, best, least = start, start, np.inf
    reach = max(int(0.06 * start[k] / model.pixel), 4)
    for _ in range(4):
        counts = model.mean(at)
        deviance = poisson_deviance(data[lit], counts[lit])
        if deviance < least:
            best, least = at, deviance
        row = np.where(lit, data, counts)
        shifts = []
        for side in (-1.0, 1.0):
            edge = (at[k + 1] + side * at[k]) / model.pixel + 0.5 * n
            low, high = int(max(edge - 3 * reach, 0)), int(min(edge + 3 * reach, n))
            shifts.append(_shift(row[low:high], counts[low:high], reach) * model.pixel)
        left, right = shifts
        at = at.copy()
        at[k] += 0.5 * (right - left) if move_radius else 0.0
        at[k + 1] += 0.5 * (right + left) if move_axis else 0.0
        if not model.allows(at) or abs(left) + abs(right) < 0.02 * model.pixel:
            break
    return best


def searched(start: FloatArray, model: WaveRowModel, data: FloatArray, lit: BoolArray, move_axis: bool) -> FloatArray:
    """Edges at the likeliest of 51 places, each for itself, within 2.5 pixels: for fringes narrower than a pixel."""
    k = model.shells
    x = 0.5 * model.pixel * model.u * (data.size - 1)
    sides = (lit & (x < start[k + 1]), lit & (x >= start[k + 1]))
    moves = np.linspace(-2.5, 2.5, 51) * model.pixel
    scores = np.full((2, moves.size), np.inf)
    for i, move in enumerate(moves):
        at = start.copy()
        at[k] += move
        if model.allows(at):
            counts = model.mean(at)
            for j, side in enumerate(sides):
                scores[j, i] = poisson_deviance(data[side], counts[side])
    if not move_axis:
        scores[:] = scores.sum(axis=0)
    left, right = (float(moves[int(np.argmin(score))]) for score in scores)
    at = start.copy()
    at[k] += 0.5 * (left + right)
    at[k + 1] += 0.5 * (right - left)
    return at


def _shift(row: FloatArray, template: FloatArray, reach: int) -> float:
    """By how many pixels a template is moved to fit a row best, +-reach, from the peak of their correlation."""
    if row.size < 2 * reach + 4:
        return 0.0
    t = np.diff(template)
    d = np.diff(row)
    score = []
    core = slice(reach, t.size - reach)
    for s in range(-reach, reach + 1):
        part = d[core.start + s : core.stop + s]
        score.append(float(part @ t[core]) / max(float(np.sqrt(part @ part)), 1e-300))
    best = int(np.argmax(score))
    if 0 < best < len(score) - 1:
        a, b, c = score[best - 1 : best + 2]
        bend = a - 2.0 * b + c
        return best - reach + (0.5 * (a - c) / bend if bend < 0 else 0.0)
    return float(best - reach)
