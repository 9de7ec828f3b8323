"""What a set of images needs before it is reduced: size of a pixel, attenuation, the track of the jet, and what to expect.

`prepare` refuses what cannot be reduced, with the key that would change it; `expected_errors` says what the photons allow
before anyone waits; `calibrated` scales the attenuation so that the polymer fraction at the nozzle is the known one.
"""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.images.absorber import build_absorber, given_medium, uncalibrated
from spinline.images.blur_check import steady_rows, unsaid_blur
from spinline.images.frames import FrameSum, Stack, sample_frames
from spinline.images.given_quantities import doubt_words, hardened, ideal_mixture, relative_doubts
from spinline.images.photons import Fields, build_fields, open_counts, photons_frame
from spinline.scene.images_file import Images
from spinline.setup.build import build_solution
from spinline.xray.frame.blocks import Frame, FrameFit, fit_frame, require_track
from spinline.xray.frame.track import Track, track_jet
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.fit import phase_law
from spinline.xray.phase.frame import fit_frame_phase, track_fringes
from spinline.xray.phase.fringe_frame import frame_fringes
from spinline.xray.row.fit import fit_row
from spinline.xray.row.forward import Absorber, RoundJet
from spinline.xray.row.limit import error_limit
from spinline.xray.row.outcome import RowFit
from spinline.xray.row.spectral import spectral_law

if TYPE_CHECKING:
    from spinline.rheology.solution import Solution

__all__ = [
    "Calibration",
    "Experiment",
    "calibrated",
    "expected_errors",
    "fit_blocks",
    "fringes_in",
    "nuisances",
    "prepare",
]

_FIRST_BLUR = 1.0  # pixels, where a fit of the blur starts
FRINGES = 5.0  # significance that is an alarm


@dataclass(frozen=True)
class Calibration:
    """Attenuation against that at the nozzle.

    Attributes
    ----------
    scale, std : float
        Measured over assumed attenuation, and its standard deviation. Without a calibration 1, and what the errors given for
        pixel size, energy, mass attenuation and density make of it (`doubt`).
    """

    scale: float = 1.0
    std: float = 0.0

    def shift(self, absorber: Absorber, fraction: FloatArray) -> FloatArray:
        """What one standard deviation of the scale does to a polymer fraction."""
        mu = absorber.solvent - absorber.air + absorber.contrast * fraction
        return mu / absorber.contrast * self.std / self.scale


@dataclass(frozen=True, eq=False)
class Experiment:
    """A set of images, ready to reduce.

    Attributes
    ----------
    images, stack, fields, solution
        The file, its frames, flat and dark, and the solution.
    pixel, pixel_std, blur : float
        m.
    absorber : Absorber
        Calibrated, where rows were given.
    medium : Medium or None
        Attenuation and refraction at every line of the beam; None where attenuation was given.
    calibration : Calibration
    notes : dict of str
        How each of these was come by.
    remarks : tuple of str
        What is odd.
    wave_medium : Medium or None
        What fringes are looked for with: `medium`, or where attenuation was given that of the tables with it.
    fringes : float
        Significance of fringes in the summed frame; NaN where they were not looked for, or are to be reduced.
    """

    images: Images
    stack: Stack
    fields: Fields
    solution: "Solution"
    pixel: float
    pixel_std: float
    blur: float
    absorber: Absorber
    medium: "Medium | None"
    calibration: Calibration
    notes: dict[str, str]
    remarks: tuple[str, ...]
    wave_medium: "Medium | None" = None
    fringes: float = np.nan

    def frame(self, summed: FrameSum, moment: float = 0.5) -> tuple[Frame, dict[str, float]]:
        """Photons of one frame or of a sum."""
        frame, facts = photons_frame(self.images, self.fields, summed, self.pixel, self.blur, moment)
        return _without_nozzle(frame, self.images), facts


def nuisances(images: Images) -> tuple[str, ...]:
    """What is fitted beside the fractions."""
    return ("radius", "axis", "amplitude", "slope", *(("blur",) if images.blur == "fit" else ()))


def prepare(
    images: Images, summing: Callable[[Stack], FrameSum] = sample_frames
) -> tuple[Experiment, Frame, Track, dict[str, float]]:
    """Open, check and calibrate a set of images.

    Parameters
    ----------
    images : Images
    summing : callable
        How the frames are added up: a sample of them for a preview, all of them for a reduction.

    Returns
    -------
    experiment : Experiment
    frame, track, facts
        The summed frame, the jet in it, and its numbers.

    Raises
    ------
    InputError
        For whatever cannot be reduced.
    """
    solution = build_solution(images)
    absorber, medium, words = build_absorber(images, solution)
    stack = open_counts(images)
    fields = build_fields(images, stack)
    notes = {"attenuation": words, **fields.notes}
    remarks = list(fields.remarks)
    summed = summing(stack)
    rough, facts = photons_frame(images, fields, summed, 1.0, 0.0)
    pixel, pixel_std = _pixel(images, rough, notes)
    blur = 0.0
    if images.blur == "fit":
        blur = _FIRST_BLUR * pixel
        notes["blur"] = "fitted, row by row"
    elif images.blur is not None:
        blur = images.blur.value
        notes["blur"] = f"{images.blur.text}, given"
    frame = _without_nozzle(replace(rough, pixel=pixel, blur=blur), images)
    _require_upright(frame)
    wave = medium if medium is not None else given_medium(images, solution, absorber)
    track = find_track(images, medium if images.method == "phase" else wave, frame)
    fringes = np.nan
    if images.method != "phase":
        if fields.shared:  # more rows than a block would see the noise of their common flat
            start = steady_rows(track)[0]
            fringes, said = fringes_in(_part(frame, start, start + images.block_rows), wave, None, 1)
        else:
            fringes, said = fringes_in(frame, wave, track)
        notes["fringes"] = said
        if fringes >= FRINGES:
            remarks.append(said)
        _expect_fringes(images, wave, pixel, blur, fringes, remarks)
    remarks += unsaid_blur(images, absorber, frame, track)
    remarks += _odd(facts)
    if images.method in ("chord", "map") and medium is not None and medium.energy_kev.size > 1:
        remarks.append(
            hardened(images.method, medium, solution.volume_fraction, float(np.median(track.radius)) * pixel)
        )
    if images.method == "chord" and blur > 0.5 * pixel:
        remarks.append(
            "chords take no account of the blur: the radius comes out too large, the fraction off; use the likelihood"
        )
    experiment = Experiment(
        images, stack, fields, solution, pixel, pixel_std, blur, absorber, medium, Calibration(), notes, tuple(remarks),
        wave, fringes,
    )  # fmt: skip
    if images.calibration_rows is not None:
        return calibrated(experiment, frame, track), frame, track, facts
    if images.polymer_attenuation is None and images.energy is not None:
        remarks.append(uncalibrated(images, solution, absorber))
    remarks += ideal_mixture(images, solution, absorber)
    doubts = relative_doubts(images, solution, absorber, pixel, pixel_std)
    if doubts:
        notes["shared_error"], much = doubt_words(doubts, absorber, solution.volume_fraction)
        if much:
            remarks.append(f"{notes['shared_error']}; calibration_rows would take it out")
    given = Calibration(1.0, float(np.sqrt(sum(value**2 for value in doubts.values()))))
    return replace(experiment, calibration=given, remarks=tuple(remarks)), frame, track, facts


def find_track(images: Images, medium: "Medium | None", frame: Frame) -> Track:
    """Track of the jet by its absorption, or by its fringes where they are to be reduced."""
    if images.method != "phase":
        try:
            return require_track(frame)
        except InputError:
            _require_order(frame, medium)
            significance, said = fringes_in(frame, medium, None)
            if significance >= FRINGES:
                raise InputError("method", said, value=images.method) from None
            raise
    row_law(images, medium)
    assert medium is not None
    assert images.propagation_distance is not None
    return track_fringes(frame, medium, images.propagation_distance.value)


def fit_blocks(
    experiment: Experiment,
    frame: Frame,
    track: Track | None,
    *,
    shells: int,
    block_rows: int,
    done: Callable[[int], None] | None = None,
    begun: FrameFit | None = None,
    keep: Callable[[FrameFit], None] | None = None,
) -> FrameFit:
    """The likelihood of every block of rows, by absorption or with fringes, as the images file says."""
    images = experiment.images
    law = row_law(images, experiment.medium)
    if images.method == "phase":
        assert experiment.medium is not None
        assert images.propagation_distance is not None
        return fit_frame_phase(
            frame, experiment.medium, images.propagation_distance.value, shells=shells, block_rows=block_rows,
            nuisances=(*nuisances(images), "distance", "refraction"), track=track, done=done,
            begun=begun, keep=keep,
        )  # fmt: skip
    return fit_frame(
        frame, experiment.absorber, shells=shells, block_rows=block_rows, nuisances=nuisances(images), track=track,
        one=law, done=done, begun=begun, keep=keep,
    )  # fmt: skip


def _part(frame: Frame, start: int, stop: int) -> Frame:
    """The rows of a frame from `start` to before `stop`."""
    part = slice(start, stop)
    return replace(
        frame, counts=frame.counts[part], flat=frame.flat[part], dark=frame.dark[part], good=frame.good[part]
    )


def _require_order(frame: Frame, medium: "Medium | None") -> None:
    """Refuse frames that are brighter in a jet's shadow than the flat: counts and flat changed places."""
    shadow = np.where(frame.good, np.maximum(frame.counts - frame.dark, 1e-9), 1.0)
    try:
        track = require_track(Frame(frame.flat + frame.dark, shadow, frame.dark, frame.good, frame.pixel))
    except InputError:
        return
    seen = float(np.median(track.attenuation)) / frame.pixel
    due = (
        seen if medium is None else medium.absorber.solvent - medium.absorber.air
    )  # fringes brighten a jet by other amounts
    if 0.5 * due < seen < 2.0 * due and track.found.mean() > 0.5:
        raise InputError(
            "flat", "seems to have changed places with counts: the jet is in the flat, not in the frames",
            remedy="counts are the frames with the jet, flat those without",
        )  # fmt: skip


def row_law(images: Images, medium: Medium | None) -> Callable[..., RowFit]:
    """What fits a block of rows: absorption at one energy, of a spectrum, or with fringes."""
    if images.method == "phase":
        if medium is None:
            raise InputError(
                "energy", "is missing: fringes need it", remedy="give energy or spectrum, not attenuations"
            )
        if images.propagation_distance is None or not images.propagation_distance.value > 0:
            raise InputError(
                "propagation_distance", "is missing: fringes need it", remedy="give it, to 10 %: it is fitted"
            )
        return phase_law(medium, images.propagation_distance.value)
    if medium is not None and medium.energy_kev.size > 1:
        return spectral_law(medium)
    return fit_row


def fringes_in(frame: Frame, medium: "Medium | None", track: Track | None, places: int = 12) -> tuple[float, str]:
    """Significance of fringes in a frame that is to be reduced as absorption, NaN where it cannot be told, and in words."""
    if medium is None:
        return np.nan, "not looked for: without the solution's formula their pattern is not known"
    try:
        test = frame_fringes(frame, medium, track=track, threshold=FRINGES, places=places)
    except InputError as error:
        return np.nan, f"not looked for: no group of rows can be tested ({error.field} {error.problem})"
    if test.detected:
        return test.significance, f"meets {test.message}"
    return test.significance, f"none seen: {test.significance:.2g} standard deviations, {FRINGES:g} would be an alarm"


def calibrated(experiment: Experiment, frame: Frame, track: Track) -> Experiment:
    """The experiment with its attenuation scaled to the known fraction in the calibration rows.

    Notes
    -----
    ``scale = (mu_s - mu_air + phi D)/(mu_s - mu_air + phi_0 D)`` with phi the fraction that a uniform jet has there; it
    multiplies solvent, contrast and air alike, as an error of energy or of coefficient nearly does.
    """
    first, last = experiment.images.calibration_rows or (0, 0)
    rows = slice(first, last)
    part = Frame(frame.counts[rows], frame.flat[rows], frame.dark[rows], frame.good[rows], frame.pixel, frame.blur)
    here = Track(*(getattr(track, item.name)[rows] for item in dataclasses.fields(Track)))
    height = min(experiment.images.block_rows, last - first)
    fit = fit_blocks(experiment, part, here, shells=1, block_rows=height)
    known = np.isfinite(fit.mean)
    weight = fit.mean_std[known] ** -2.0
    found, std = float((weight * fit.mean[known]).sum() / weight.sum()), float(weight.sum() ** -0.5)
    a, phi = experiment.absorber, experiment.solution.volume_fraction
    base = a.solvent - a.air
    nominal = base + phi * a.contrast
    scale = (base + found * a.contrast) / nominal
    given = _fraction_std(experiment)
    scale_std = abs(a.contrast) * float(np.hypot(std, given)) / nominal
    if not scale > 0 or scale_std > 0.1:
        raise InputError(
            "calibration_rows", f"do not tell the attenuation: {scale:.3g} +/- {scale_std:.2g} of the tables'",
            value=[first, last], allowed="known to 10 %", remedy="take more rows",
        )  # fmt: skip
    remarks = list(experiment.remarks)
    if abs(scale - 1.0) > 0.2:
        remarks.append(f"the calibration scales the attenuation by {scale:.3g}: check energy, pixel_size and solution")
    scatter = (
        float(np.sqrt(np.mean(((fit.mean[known] - found) / fit.mean_std[known]) ** 2))) if known.sum() > 2 else 1.0
    )
    if scatter > 1.5:
        remarks.append(
            f"the calibration rows scatter {scatter:.2g} times more than their errors: are they all at the nozzle's fraction?"
        )
    m = experiment.medium
    words = f"{scale:.4f} +/- {scale_std:.4f} of that assumed, from rows {first} to {last} at a fraction of {phi:.4f}"
    return replace(
        experiment,
        absorber=Absorber(a.solvent * scale, a.contrast * scale, a.air * scale),
        medium=None
        if m is None
        else replace(m, solvent=m.solvent * scale, contrast=m.contrast * scale, air=m.air * scale),
        calibration=Calibration(scale, scale_std),
        notes={**experiment.notes, "calibration": words},
        remarks=tuple(remarks),
    )


def expected_errors(
    experiment: Experiment, frame: Frame, track: Track, block_rows: int | None = None, samples: int = 7
) -> tuple[FloatArray, FloatArray]:
    """Standard deviation of the mean fraction that the photons allow, all nuisances unknown, before anything is fitted.

    Returns
    -------
    row, std : ndarray
        Some rows along the frame, and the bound for a block of `block_rows` there (one uniform shell: the mean alone; with the
        shells of the file where they are to be fitted).
    """
    height = min(block_rows or experiment.images.block_rows, frame.counts.shape[0])
    starts = np.unique(np.linspace(0, frame.counts.shape[0] - height, samples).astype(int))
    shells = experiment.images.shells if experiment.images.method == "row" else 1
    phi = np.full(shells, experiment.solution.volume_fraction)
    std = np.full(starts.size, np.nan)
    for i, start in enumerate(starts.tolist()):
        inside = slice(start, start + height)
        radius, axis = float(np.median(track.radius[inside])), float(np.median(track.axis[inside]))
        try:
            _, detector, good = frame.block(start, start + height)
            jet = RoundJet(phi, radius * frame.pixel, axis * frame.pixel)
            names = nuisances(experiment.images)
            std[i] = error_limit(jet, experiment.absorber, detector, nuisances=names, good=good).mean
        except InputError:
            continue  # this block cannot be fitted: the reduction says so in its place
    return starts + 0.5 * (height - 1), std


def _fraction_std(experiment: Experiment) -> float:
    """Standard deviation of the solution's volume fraction, where its mass or volume fraction has one."""
    s = experiment.images.solution
    if s.volume_fraction is not None:
        return s.volume_fraction.std
    if s.mass_fraction is None or s.mass_fraction.std == 0:
        return 0.0
    rho_p, rho_s, w = experiment.solution.polymer.density, experiment.solution.solvent_density, s.mass_fraction.value
    return s.mass_fraction.std * rho_p * rho_s / (w * rho_s + (1 - w) * rho_p) ** 2


def _pixel(images: Images, frame: Frame, notes: dict[str, str]) -> tuple[float, float]:
    if images.pixel_size is not None:
        notes["pixel_size"] = f"{images.pixel_size.text}, given"
        return images.pixel_size.value, images.pixel_size.std
    assert images.nozzle_diameter is not None
    assert images.nozzle_rows is not None
    from spinline.xray.row.edges import opaque_edges

    rows = slice(*images.nozzle_rows)
    good = frame.good[rows]
    signal = np.where(good, frame.counts[rows] - frame.dark[rows], 0.0).sum(axis=0)
    flat = np.where(good, frame.flat[rows], 0.0).sum(axis=0)
    lit = flat > 0
    ratio = np.where(lit, signal / np.where(lit, flat, 1.0), np.nan)
    left, right, std = opaque_edges(ratio, float(np.median(flat[lit])) ** -0.5 if lit.any() else 0.0)
    width, nozzle = right - left, images.nozzle_diameter
    pixel = nozzle.value / width
    spread = pixel * float(np.hypot(nozzle.std / nozzle.value, std / width))
    notes["pixel_size"] = f"{pixel:.6g} +/- {spread:.2g} m: {nozzle.text} over {width:.2f} pixels"
    return pixel, spread


def _without_nozzle(frame: Frame, images: Images) -> Frame:
    """The frame with the nozzle's rows left out."""
    if images.nozzle_rows is None:
        return frame
    good = frame.good.copy()
    good[slice(*images.nozzle_rows)] = False
    return replace(frame, good=good)


def _require_upright(frame: Frame) -> None:
    """Refuse frames in which the jet runs along the rows."""
    ratio = np.where(frame.good, (frame.counts - frame.dark) / np.where(frame.good, frame.flat, 1.0), np.nan)
    rows, columns = frame.good.any(axis=1), frame.good.any(axis=0)
    if rows.sum() < 16 or columns.sum() < 16:
        return
    seen = ratio[rows][:, columns]
    across, along = _smooth(np.nanmedian(seen, axis=0)), _smooth(np.nanmedian(seen, axis=1))
    if along.std() < 2.0 * across.std():
        return
    sideways = track_jet(frame.counts.T, frame.flat.T, frame.dark.T, frame.good.T)
    if sideways is not None and float(np.median(sideways.radius)) < 0.45 * frame.counts.shape[0]:
        raise InputError(
            "transpose", "seems wrong: the jet runs along the rows, it has to run down the columns",
            remedy="set transpose = true, or take it out",
        )  # fmt: skip


def _smooth(values: FloatArray) -> FloatArray:
    return np.convolve(values, np.full(5, 0.2), mode="valid")


def _expect_fringes(
    images: Images, medium: "Medium | None", pixel: float, blur: float, fringes: float, remarks: list[str]
) -> None:
    """Words on fringes that are seen, that must be there, or that are not looked for."""
    if fringes >= FRINGES:
        return
    if np.isnan(fringes):
        remarks.append("fringes are not looked for: the counts may hold some, which absorption takes for polymer")
    if images.propagation_distance is None or medium is None:
        return
    width = float(np.sqrt(medium.weight @ medium.wavelength * images.propagation_distance.value))
    if width > 0.5 * max(pixel, blur):
        remarks.append(
            f"fringes: at {images.propagation_distance.text} they are {1e6 * width:.2g} um wide, pixels {1e6 * pixel:.2g} um; "
            "left out, they shift the fraction by -0.25 (1 cm) to -1.9 (10 cm) at 10 keV and R = 50 um"
        )


def _odd(facts: dict[str, float]) -> list[str]:
    said = []
    if facts["saturated_pixels"]:
        said.append(f"{facts['saturated_pixels']:.0f} saturated pixels are masked")
    if facts["outlying_pixels"]:
        said.append(f"{facts['outlying_pixels']:.0f} pixels far off their neighbours are masked")
    if facts["piled_up_pixels"]:
        said.append(
            f"{facts['piled_up_pixels']:.0f} pixels hold exactly the highest count, {facts['highest_count']:g}: if the "
            f"detector clips there, the fraction is wrong; give saturation = {facts['highest_count']:g}"
        )
    if facts["flat_noise"] > 1.05:
        said.append(
            f"the flats are few: their noise makes errors {np.sqrt(facts['flat_noise']):.3g} times larger (accounted for)"
        )
    if facts["added_noise"]:
        said.append("counts under the dark level by more than the read noise: more read noise is assumed")
    return said


def require_signal(experiment: Experiment, frame: Frame, track: Track) -> FloatArray:
    """Refuse a reduction whose errors are expected to exceed the fraction everywhere; the errors otherwise."""
    _, std = expected_errors(experiment, frame, track)
    phi = experiment.solution.volume_fraction
    if not np.isfinite(std).any() or np.nanmin(std) <= phi:
        return std
    best = float(np.nanmin(std))
    rows = int(np.ceil(experiment.images.block_rows * (3.0 * best / phi) ** 2))
    enough = rows <= frame.counts.shape[0]
    remedy = (
        f"block_rows = {rows} gives a third of the fraction"
        if enough
        else (
            f"{(3.0 * best / phi) ** 2:.2g} times the photons give a third of the fraction; `spinline exposure` plans them"
        )
    )
    raise InputError(
        "block_rows", f"the error expected, {best:.2g}, exceeds the polymer fraction, {phi:.3g}, in every block",
        value=experiment.images.block_rows, remedy=f"{remedy}; or --noisy",
    )  # fmt: skip
