"""Polymer fraction from one row of counts with Fresnel fringes, by their likelihood.

The counts are Poisson about the model of `fresnel`; fractions, radius, axis, level and slope of the beam, and if asked for the
blur and the distance, are those of the largest likelihood. The fringes are signal here: refraction says of the fraction what
absorption says, several times over, so that at a known distance the bound falls below that of absorption (20 times at
R = 10 um and 20 cm).

With it comes what must be known: an error of the solvent's density by 0.1 % changes delta by as much as 0.01 in the fraction
of PEO in water does. A blur or a distance that is held wrong is mistaken for fringes of another size, and shows in the misfit:
fit them.

The fringes come from the edges: taken for uniform, a jet whose core holds all the polymer shows the fraction of its sheath (the
result of a run at r_n/R = 0.86 comes out 0.05 too low). Where the profile is not known, fit the refraction too: then absorption
says the fraction again, at absorption's precision (0.015 too low, there), and look at the misfit.

The start: `contact_transmission` folds the fringes back, `start.find_jet` finds the jet to about a pixel, and the fringes of
either edge, shifted until they fit, place it to a fraction of one.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spinline.checks import BoolArray, FloatArray, number, positive
from spinline.errors import InputError
from spinline.xray.block import summed_counts
from spinline.xray.chords import checked_edges, equal_shells, shell_weights
from spinline.xray.forward import Absorber, Detector, RoundJet
from spinline.xray.fresnel import PHASE_NUISANCES, WaveRowModel, wave_model
from spinline.xray.limit import Limit, covariance_bound, good_pixels
from spinline.xray.medium import Medium
from spinline.xray.outcome import RowFit, row_outcome
from spinline.xray.phase_retrieval import contact_transmission
from spinline.xray.scoring import largest_likelihood, poisson_deviance
from spinline.xray.start import find_jet

__all__ = [
    "PhaseStart",
    "coarse_place",
    "fit_row_phase",
    "phase_error_limit",
    "phase_law",
    "phase_start",
    "start_ratio",
]

_MISFIT = "the counts scatter more than Poisson about the model: check distance, blur, spectrum, flat and gain"

_BAD = 6.0  # misfit from which on other starts are tried
_PLAUSIBLE = 0.05  # fraction to start from


def fit_row_phase(
    counts: ArrayLike,
    medium: Medium,
    detector: Detector,
    distance: float,
    *,
    shells: int | ArrayLike = 1,
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope", "distance"),
    radius: float | None = None,
    axis: float | None = None,
    amplitude: float = 1.0,
    slope: float = 0.0,
    good: ArrayLike | None = None,
    saturation: float = np.inf,
) -> RowFit:
    """Estimate the polymer fraction from one row of counts at a distance behind the jet, or from a block of rows.

    Parameters
    ----------
    counts : array_like, shape (pixels,) or (rows, pixels)
        As in `fit_row`.
    medium : Medium
        Attenuation and refraction (`solution_medium`), of one line or of many.
    detector : Detector
        Its `blur` holds that of the source.
    distance : float
        From jet to detector, m, > 0; the start where it is fitted.
    shells, radius, axis, amplitude, slope, good, saturation
        As in `fit_row`.
    nuisances : sequence of str
        Any of "radius", "axis", "amplitude", "slope", "blur", "distance", "refraction" (a factor on delta). A distance held
        1 % wrong costs up to 0.1 in the fraction, a blur held 10 % wrong 0.5 (R = 50 um, 10 cm); to fit them costs a tenth
        of the precision, there.

    Returns
    -------
    RowFit
        `values` and `std` hold the distance too.

    Raises
    ------
    InputError
        As `fit_row`, but for a contrast near 0, which refraction need not have; and as `fresnel_counts`.

    Notes
    -----
    40 to 100 ms for 220 pixels at 10 keV and one shell. At short distances (1 cm) distance and refraction say nearly the same:
    with three shells and both free it takes 2 s; hold one of them there.
    """
    z = positive("distance", distance, "m")
    edges = equal_shells(shells) if isinstance(shells, int) else checked_edges(shells)
    free = _free(edges.size - 1, nuisances)
    for name, value in (("radius", radius), ("axis", axis)):
        if value is None and name not in nuisances:
            raise InputError(name, "is neither fitted nor given", remedy=f"give {name}, or add it to nuisances")
    if "blur" in nuisances and detector.blur == 0.0:
        raise InputError("blur", "cannot be fitted from 0", value=0.0, remedy="give Detector a first guess of the blur")
    data, rows = summed_counts(counts, detector, good, saturation)
    lit = rows > 0
    if lit.sum() < 4:
        raise InputError("good", "leaves fewer than 4 pixels", value=int(lit.sum()))
    if data.sum() <= float((detector.dark * rows).sum()):
        raise InputError("dark", "exceeds the counts: no signal is left", value=float((detector.dark * rows).sum()))
    ratio = start_ratio(data, rows, lit, detector)
    found_r, found_a = coarse_place(ratio, medium, detector, z, radius, axis)
    model = wave_model(medium, detector, edges, 1.2 * found_r, 3.0 * detector.blur if "blur" in nuisances else None)
    model.scale_exposure(rows)
    level = number("amplitude", amplitude, above=0.0)
    if "amplitude" in nuisances:
        level = _air_level(ratio, model, found_r, found_a)
    phi = np.full(edges.size - 1, _PLAUSIBLE)
    held = [level, number("slope", slope, above=-1.0, below=1.0), detector.blur, z, 1.0]
    start = np.array([*phi, found_r, found_a, *held])
    if not model.allows(start):
        raise InputError("jet", "does not lie in the row", value=found_a, remedy="a wider row, or give radius and axis")
    start = _placed(start, model, data, lit, "radius" in nuisances, "axis" in nuisances)
    best = largest_likelihood(model, start, free, data, lit)
    fit = row_outcome(model, best, free, data, lit, misfit=_MISFIT)
    if "radius" in nuisances and (fit.misfit > _BAD or not fit.converged):
        for _ in range(2):
            start = _searched(start, model, data, lit, "axis" in nuisances)
            trial = largest_likelihood(model, start, free, data, lit)
            if trial[3] < best[3] - 1e-3:
                best = trial
        fit = row_outcome(model, best, free, data, lit, misfit=_MISFIT)
    return fit


def phase_law(
    medium: Medium, distance: float, *, fitted: Sequence[str] = ("distance", "refraction")
) -> Callable[..., RowFit]:
    """`fit_row_phase` in the form of `fit_row`, for what fits many rows with a law of counts, absorber and detector.

    Parameters
    ----------
    medium : Medium
        Of one line, it takes the absorber's attenuation (calibrated, say) and keeps its own refraction; of many, its own.
    distance : float
        m, > 0.
    fitted : sequence of str
        Nuisances that are free besides those that are asked for. With "refraction" the fraction is absorption's, the fringes
        being fitted: safe for any density and profile. Without it refraction tells of the fraction too.

    Returns
    -------
    callable
        ``law(counts, absorber, detector, **options of fit_row_phase)``.
    """
    z = positive("distance", distance, "m")

    def law(counts: ArrayLike, absorber: Absorber, detector: Detector, **options: Any) -> RowFit:
        seen = medium.with_absorber(absorber) if medium.energy_kev.size == 1 else medium
        free = options.pop("nuisances", ("radius", "axis", "amplitude", "slope"))
        free = (*free, *(name for name in fitted if name not in free))
        return fit_row_phase(counts, seen, detector, z, nuisances=free, **options)

    return law


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
    level = _air_level(ratio, model, found_r, found_a)
    at = np.array([_PLAUSIBLE, found_r, found_a, level, 0.0, detector.blur, distance, 1.0])
    if not model.allows(at):
        return PhaseStart(found_r, found_a, np.inf)
    at = _placed(at, model, data, lit, True, True)
    return PhaseStart(float(at[1]), float(at[2]), poisson_deviance(data[lit], model.mean(at)[lit]))


def phase_error_limit(
    jet: RoundJet,
    medium: Medium,
    detector: Detector,
    distance: float,
    *,
    nuisances: Sequence[str] = (),
    amplitude: float = 1.0,
    slope: float = 0.0,
    good: ArrayLike | None = None,
) -> Limit:
    """Cramer-Rao bound of the fractions from counts at a distance behind the jet; as `limit.error_limit`.

    Parameters
    ----------
    jet, detector, amplitude, slope, good
        As in `error_limit`.
    medium, distance
        As in `fresnel_counts`; distance > 0.
    nuisances : sequence of str
        Any of "radius", "axis", "amplitude", "slope", "blur", "distance".

    Returns
    -------
    Limit

    Raises
    ------
    InputError
        For an unknown nuisance, or unknowns that the row cannot tell apart.
    """
    free = _free(jet.fraction.size, nuisances)
    if "blur" in nuisances and detector.blur == 0.0:
        raise InputError("blur", "cannot be unknown about 0", value=0.0, remedy="give Detector a blur > 0")
    model = wave_model(medium, detector, jet.shell_edges, jet.radius)
    beam = [number("amplitude", amplitude, above=0.0), number("slope", slope, above=-1.0, below=1.0), detector.blur]
    at = np.concatenate((jet.fraction, [jet.radius, jet.axis, *beam, positive("distance", distance, "m"), 1.0]))
    if not model.allows(at):
        raise InputError("jet", "does not lie in the row", value=jet.axis, remedy="a wider row, or another axis")
    counts, jacobian = model.evaluate(at)
    mask = good_pixels(good, counts.size)
    names = tuple(model.names[i] for i in free)
    covariance = covariance_bound(counts[mask], jacobian[mask][:, free], names)
    sd, shells = np.sqrt(np.diag(covariance)), jet.fraction.size
    weights = shell_weights(jet.shell_edges)
    mean = float(np.sqrt(weights @ covariance[:shells, :shells] @ weights))
    return Limit(sd[:shells], mean, dict(zip(names[shells:], sd[shells:].tolist(), strict=True)), names, covariance)


def _free(shells: int, nuisances: Sequence[str]) -> list[int]:
    unknown = [name for name in nuisances if name not in PHASE_NUISANCES]
    if isinstance(nuisances, str) or unknown:
        raise InputError("nuisances", "are not known", value=unknown or nuisances, allowed=", ".join(PHASE_NUISANCES))
    return [*range(shells), *(shells + i for i, name in enumerate(PHASE_NUISANCES) if name in nuisances)]


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
    folded = contact_transmission(ratio, p, z, medium.delta_over_mu(_PLAUSIBLE))
    found_r, found_a, _ = find_jet(folded, r, a)
    return (found_r if r is None else r) * p, (found_a if a is None else a) * p


def _air_level(ratio: FloatArray, model: WaveRowModel, radius: float, axis: float) -> float:
    """Level of the beam outside the jet; fringes even out."""
    x = 0.5 * model.pixel * model.u * (ratio.size - 1)
    outside = np.abs(x - axis) > radius + 0.25 * (0.5 * model.pixel * ratio.size - radius)
    level = float(ratio[outside].mean()) if outside.sum() > 3 else 1.0
    return level if level > 0 else max(float(ratio.mean()), 1e-6)


def _placed(
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


def _searched(start: FloatArray, model: WaveRowModel, data: FloatArray, lit: BoolArray, move_axis: bool) -> FloatArray:
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
