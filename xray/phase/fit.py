"""Polymer fraction from one row of counts with Fresnel fringes, by their likelihood.

The counts are Poisson about the model of `fresnel`; fractions, radius, axis, level and slope of the beam, and if asked for
the blur and the distance, are those of the largest likelihood.

**What the fringes say of the mean is what is assumed of the profile.** The wave near an edge goes as ``delta(R) sqrt(R -
r)``: the fringes measure the refraction at the rim, to 20 times the precision of absorption, and that is the mean where the
fraction is uniform. Taken for uniform, a parabola that falls to a tenth at the rim comes out 0.03 to 0.07 wrong, far outside
its error; in a staircase of few shells the steps make fringes of their own (`profiles`), and the bias stays. So the profile
is continuous here, `profiles.Ramps` on knots that are denser at the rim, and the mean then is absorption's, at absorption's
precision, with the fringes modelled; the rim's fraction is the fringes', far more precise. A jet that is known to be uniform,
or to have edges at known places, is fitted as such by ``profile = "shells"``: 5 to 20 times the precision of the mean, on
that assumption.

What must be known: an error of the solvent's density by 0.1 % changes delta by as much as 0.01 in the fraction of PEO in
water does; fit a factor on the refraction ("refraction"), which costs nothing here. A blur or a distance that is held wrong
is mistaken for fringes of another size, and shows in the misfit: fit them.

A beam of many energies is the sum of what each line's wave makes, by its share of the signal. A block of rows in which radius
or axis changes (`taper`, `lean`) is the mean of sections a fifth of a pixel apart.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spinline.base.checks import FloatArray, number, positive
from spinline.base.errors import InputError
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.fresnel import PHASE_NUISANCES, WaveRowModel
from spinline.xray.phase.profiles import RADIAL_KNOTS, Profile, Ramps, Shells
from spinline.xray.phase.start import PLAUSIBLE_FRACTION, air_level, coarse_place, placed, searched, start_ratio
from spinline.xray.row.block import summed_counts
from spinline.xray.row.chords import checked_edges, equal_shells, shell_weights
from spinline.xray.row.forward import Absorber, Detector, RoundJet
from spinline.xray.row.limit import Limit, covariance_bound, good_pixels
from spinline.xray.row.outcome import RowFit, row_outcome, turned_covariance
from spinline.xray.row.scoring import largest_likelihood

__all__ = ["fit_row_phase", "phase_error_limit", "phase_law"]

_MISFIT = "the counts scatter more than Poisson about the model: check distance, blur, profile, spectrum, flat and gain"

_BAD = 6.0  # misfit from which on other starts are tried
_APART = 0.2  # pixels between the sections of a block
_MOST_SECTIONS = 64


def fit_row_phase(
    counts: ArrayLike,
    medium: Medium,
    detector: Detector,
    distance: float,
    *,
    shells: int | ArrayLike = 1,
    profile: str | ArrayLike = "smooth",
    nuisances: Sequence[str] = ("radius", "axis", "amplitude", "slope", "distance"),
    radius: float | None = None,
    axis: float | None = None,
    amplitude: float = 1.0,
    slope: float = 0.0,
    taper: float = 0.0,
    lean: float = 0.0,
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
    shells : int or array_like
        As in `fit_row`; of a continuous profile the means over them are returned.
    profile : str or array_like
        "smooth": continuous, linear in (r/R)^2 between the knots `profiles.RADIAL_KNOTS`; or those knots, rising from 0 to 1.
        "shells": a staircase of `shells`, for a jet that is known to be one: of one shell, a uniform jet.
    radius, axis, amplitude, slope, good, saturation
        As in `fit_row`.
    nuisances : sequence of str
        Any of "radius", "axis", "amplitude", "slope", "blur", "distance", "refraction" (a factor on delta). A distance held
        1 % wrong costs up to 0.1 in the fraction, a blur held 10 % wrong 0.5 (R = 50 um, 10 cm).
    taper, lean : float
        Change of radius and of axis over the height of the block, m.

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
    0.1 to 0.3 s for 220 pixels at 10 keV; half of it for a uniform jet. With taper, times the sections.
    """
    z = positive("distance", distance, "m")
    edges = equal_shells(shells) if isinstance(shells, int) else checked_edges(shells)
    shape = _profile(profile, edges)
    free = _free(shape.size, nuisances)
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
    sections = _sections(taper, lean, detector.pixel)

    def model_of(what: Profile, parts: FloatArray) -> WaveRowModel:
        widest = 3.0 * detector.blur if "blur" in nuisances else None
        made = WaveRowModel(detector, edges, medium, 1.2 * found_r, widest, profile=what, sections=parts)
        made.scale_exposure(rows)
        return made

    plain = model_of(Shells(np.array([0.0, 1.0])), sections)
    level = number("amplitude", amplitude, above=0.0)
    if "amplitude" in nuisances:
        level = air_level(ratio, plain, found_r, found_a)
    held = [level, number("slope", slope, above=-1.0, below=1.0), detector.blur, z, 1.0]
    start = np.array([PLAUSIBLE_FRACTION, found_r, found_a, *held])
    if not plain.allows(start):
        raise InputError("jet", "does not lie in the row", value=found_a, remedy="a wider row, or give radius and axis")
    start = placed(start, plain, data, lit, "radius" in nuisances, "axis" in nuisances)
    model = plain if isinstance(shape, Shells) and shape.size == 1 else model_of(shape, sections)
    uniform = _free(1, nuisances)

    def fitted(begin: FloatArray) -> tuple[FloatArray, bool, int, float]:
        best = largest_likelihood(plain, begin, uniform, data, lit)
        if model is plain:
            return best
        fraction = best[0][0] if abs(best[0][0] - 0.5) < 1.0 else PLAUSIBLE_FRACTION
        begin = np.concatenate((np.full(shape.size, fraction), best[0][1:]))
        return largest_likelihood(model, begin, free, data, lit)

    def told(best: tuple[FloatArray, bool, int, float]) -> RowFit:
        return row_outcome(model, best, free, data, lit, misfit=_MISFIT, shells=(edges, shape.means(edges)))

    best = fitted(start)
    fit = told(best)
    if "radius" in nuisances and (fit.misfit > _BAD or not fit.converged):
        for _ in range(2):
            start = searched(start, plain, data, lit, "axis" in nuisances)
            trial = fitted(start)
            if trial[3] < best[3] - 1e-3:
                best = trial
        fit = told(best)
    return fit


def phase_law(
    medium: Medium, distance: float, *, fitted: Sequence[str] = ("distance", "refraction"), profile: str = "smooth"
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
    profile : str
        As in `fit_row_phase`.

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
        return fit_row_phase(counts, seen, detector, z, nuisances=free, **{"profile": profile, **options})

    return law


def phase_error_limit(
    jet: RoundJet,
    medium: Medium,
    detector: Detector,
    distance: float,
    *,
    profile: str | ArrayLike = "shells",
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
    profile : str or array_like
        What is known of the profile, as in `fit_row_phase`. "shells": that it is the staircase of `jet`. "smooth": that it is
        continuous; the bound is then taken at a uniform jet of the same mean.
    nuisances : sequence of str
        Any of "radius", "axis", "amplitude", "slope", "blur", "distance", "refraction".

    Returns
    -------
    Limit

    Raises
    ------
    InputError
        For an unknown nuisance, or unknowns that the row cannot tell apart.
    """
    edges = jet.shell_edges
    shape = _profile(profile, edges)
    free = _free(shape.size, nuisances)
    if "blur" in nuisances and detector.blur == 0.0:
        raise InputError("blur", "cannot be unknown about 0", value=0.0, remedy="give Detector a blur > 0")
    model = WaveRowModel(detector, edges, medium, jet.radius, profile=shape)
    beam = [number("amplitude", amplitude, above=0.0), number("slope", slope, above=-1.0, below=1.0), detector.blur]
    fraction = jet.fraction if isinstance(shape, Shells) else np.full(shape.size, jet.mean_fraction)
    at = np.concatenate((fraction, [jet.radius, jet.axis, *beam, positive("distance", distance, "m"), 1.0]))
    if not model.allows(at):
        raise InputError("jet", "does not lie in the row", value=jet.axis, remedy="a wider row, or another axis")
    counts, jacobian = model.evaluate(at)
    mask = good_pixels(good, counts.size)
    names = tuple(model.names[i] for i in free)
    covariance = covariance_bound(counts[mask], jacobian[mask][:, free], names)
    shells = edges.size - 1
    covariance = turned_covariance(covariance, shape.means(edges))
    names = (*(f"fraction[{j}]" for j in range(shells)), *names[shape.size :])
    sd, weights = np.sqrt(np.diag(covariance)), shell_weights(edges)
    mean = float(np.sqrt(weights @ covariance[:shells, :shells] @ weights))
    return Limit(sd[:shells], mean, dict(zip(names[shells:], sd[shells:].tolist(), strict=True)), names, covariance)


def _profile(profile: str | ArrayLike, edges: FloatArray) -> Profile:
    if isinstance(profile, str):
        if profile == "shells":
            return Shells(edges)
        if profile == "smooth":
            return Ramps(np.array(RADIAL_KNOTS))
        raise InputError("profile", "is not known", value=profile, allowed='"smooth", "shells", or knots (r/R)^2')
    return Ramps(np.asarray(profile))


def _sections(taper: float, lean: float, pixel: float) -> FloatArray:
    """Radius and axis of the sections of a block, less their means."""
    change = np.array([number("taper", taper, unit="m"), number("lean", lean, unit="m")])
    count = max(int(np.ceil(float(np.abs(change).sum()) / (_APART * pixel))), 1)
    if count > _MOST_SECTIONS:
        raise InputError(
            "taper",
            "changes the jet too much within the block",
            value=float(np.abs(change).sum()),
            allowed=f"{_APART * _MOST_SECTIONS:g} pixels",
            remedy="a block of fewer rows",
        )
    at = (np.arange(count) + 0.5) / count - 0.5
    if count > 1:
        at /= np.sqrt(1.0 - count**-2.0)  # the variance of the continuous block
    return np.asarray(at[:, None] * change)


def _free(shells: int, nuisances: Sequence[str]) -> list[int]:
    unknown = [name for name in nuisances if name not in PHASE_NUISANCES]
    if isinstance(nuisances, str) or unknown:
        raise InputError("nuisances", "are not known", value=unknown or nuisances, allowed=", ".join(PHASE_NUISANCES))
    return [*range(shells), *(shells + i for i, name in enumerate(PHASE_NUISANCES) if name in nuisances)]
