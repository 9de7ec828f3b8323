"""What a set of images needs before it is reduced: photons, the size of a pixel, attenuation, the jet's track, the detector.

`prepare` refuses what cannot be reduced, with the key that would change it. The attenuation is scaled so that the polymer
fraction at the nozzle is the known one (`calibration`), blur and glare are fitted for all rows together (`detector`), the
jet's lean is taken from its track.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from spinline.base.errors import InputError
from spinline.images.flat_and_dark import Fields, build_fields, open_counts
from spinline.images.geometry import path_factor
from spinline.images.metadata import with_metadata
from spinline.images.odd_frames import with_jet
from spinline.images.photons import dark_words, photons_frame
from spinline.images.stacks import Stack
from spinline.images.sums import FrameSum, one_frame, sample_frames
from spinline.radiography.absorber import build_absorber, given_medium, uncalibrated
from spinline.radiography.calibration import Calibration, scaled_medium
from spinline.radiography.detector import SharedDetector, shared_detector
from spinline.radiography.experiment import Experiment, bent, joint_detector
from spinline.radiography.given_quantities import doubt_words, hardened, ideal_mixture, relative_doubts
from spinline.radiography.looks import (
    FRINGES,
    broken_rows,
    expect_fringes,
    find_track,
    fringes_in,
    measured_pixel,
    odd_facts,
    part_of,
    require_one_jet,
    require_the_flats_beam,
    require_upright,
    without_nozzle,
)
from spinline.radiography.nozzle_rows import calibrated
from spinline.scene.images_file import Images
from spinline.setup.build import build_solution
from spinline.xray.frame.blocks import Frame, require_track
from spinline.xray.frame.lean import axis_lean
from spinline.xray.frame.outliers import residual_outliers
from spinline.xray.frame.still import blocks_of_frame, steady_rows
from spinline.xray.frame.track import Track
from spinline.xray.matter.medium import Medium

__all__ = ["first_look", "judged", "prepare", "sees_jointly"]

_LEAN_MATTERS = 1e-4  # of the paths


_LEANS = 1.0  # degrees from which on a remark says so
_BENDS = 0.01  # of the paths


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
    experiment, frame, track, facts = first_look(images, summing)
    experiment, frame = _with_detector(experiment, frame, track)
    return judged(experiment, frame, track, facts), frame, track, facts


def first_look(
    images: Images, summing: Callable[[Stack], FrameSum]
) -> tuple[Experiment, Frame, Track, dict[str, float]]:
    """A set of images as far as it can be prepared without the detector: photons, pixel, track; as `prepare`."""
    solution = build_solution(images)
    stack = open_counts(images)
    images, remarks = with_metadata(images, stack)
    absorber, medium, words = build_absorber(images, solution)
    fields = build_fields(images, stack)
    notes = {"attenuation": words, **fields.notes}
    remarks += fields.remarks
    summed = summing(stack)
    remarks += summed.remarks(stack)
    if not images.each:
        summed, said = with_jet(stack, summed, fields.dark, fields.flat, fields.gain / fields.excess)
        remarks += said
    remarks += dark_words(fields, summed)
    rough, facts = photons_frame(images, fields, summed, 1.0, 0.0)
    pixel, pixel_std = measured_pixel(images, rough, notes)
    blur = _given_blur(images, medium, pixel, notes)
    frame = without_nozzle(replace(rough, pixel=pixel, blur=blur), images)
    require_upright(frame)
    remarks += require_the_flats_beam(frame)
    broken = broken_rows(frame, images)
    wave = medium if medium is not None else given_medium(images, solution, absorber)
    try:
        track = find_track(images, medium if images.method == "phase" else wave, frame)
        lean = axis_lean(track)
        require_one_jet(lean)
    except InputError as error:
        raise (broken or error) from None
    if broken is not None:
        words = "blocks there are wrong, and fringes, glare or blur that are said may be nothing else"
        remarks.append(f"the counts {broken.problem}; {words}: {broken.remedy}")
    frame, fields, facts = _cleaned(frame, fields, track, facts)
    factor, _ = path_factor(images)
    experiment = Experiment(
        images,
        stack,
        fields,
        solution,
        pixel,
        pixel_std,
        absorber.along(factor),
        scaled_medium(medium, factor),
        Calibration(),
        notes,
        tuple(remarks),
        scaled_medium(wave, factor),
        lean=lean,
        used=summed.used,
        detector=SharedDetector(blur=blur),
    )
    return experiment, frame, track, facts


def judged(
    experiment: Experiment,
    frame: Frame,
    track: Track,
    facts: dict[str, float],
    calibrate: bool = True,
    elsewhere: bool = False,
) -> Experiment:
    """The experiment with its remarks, and its attenuation calibrated or with the errors of what it rests on.

    `elsewhere`: it is calibrated by another position, and only looked at here.
    """
    looked = _looked_at(experiment, frame, track, facts)
    return looked if elsewhere else _scaled(looked, frame, track, calibrate)


def sees_jointly(experiment: Experiment) -> bool:
    """Whether the detector is fitted for all rows together."""
    return joint_detector(experiment.images, experiment.medium)


def _given_blur(images: Images, medium: "Medium | None", pixel: float, notes: dict[str, str]) -> float:
    """The blur that a frame starts with; 0 where it is told later."""
    if images.blur == "fit":
        if not joint_detector(images, medium):
            notes["blur"] = "fitted, row by row"
            return pixel
        return 0.0
    if images.blur is None:
        return 0.0
    notes["blur"] = f"{images.blur.text}, given"
    return images.blur.value


def _cleaned(
    frame: Frame, fields: Fields, track: Track, facts: dict[str, float]
) -> tuple[Frame, Fields, dict[str, float]]:
    """The frame without pixels that are off the jet's own shadow, which is smoother than it looks before it is known."""
    lone = residual_outliers(frame, track)
    if not lone.any():
        return frame, fields, facts
    facts = {
        **facts,
        "outlying_pixels": facts["outlying_pixels"] + float(lone.sum()),
        "bad_pixels": facts["bad_pixels"] + float(lone.sum()),
    }
    return replace(frame, good=frame.good & ~lone), replace(fields, bad=fields.bad | lone), facts


def _with_detector(experiment: Experiment, frame: Frame, track: Track) -> tuple[Experiment, Frame]:
    """The experiment with blur, glare and shapes of the beam, and the frame as such a detector shows it."""
    images = experiment.images
    if not joint_detector(images, experiment.medium):
        if images.tail_share is not None and images.tail_share != "fit" and images.tail_length not in (None, "fit"):
            length, _ = images.tail_length.metres(experiment.pixel)  # type: ignore[union-attr]
            held = replace(experiment.detector, tail_share=images.tail_share.value, tail_length=length)
            return replace(experiment, detector=held), bent(frame, held)
        if images.tail_share is not None:
            raise InputError(
                "tail_share",
                "is fitted by absorption at one energy",
                value=images.method,
                remedy='give tail_share and tail_length, or take method "row" or "map"',
            )
        return experiment, frame
    known = None
    if images.calibration_rows is not None:
        known = images.calibration_rows, experiment.solution.volume_fraction
    most = images.block_rows if experiment.fields.shared else None
    blocks = []
    for one, path in _single_frames(experiment) if images.each else [(frame, track)]:
        clear = replace(one, blur=0.0)
        blocks += blocks_of_frame(clear, path, axis_lean(path), known=known, most_rows=most)
    calibrate = any(block.known is not None for block in blocks)
    found = shared_detector(
        images, experiment.absorber, blocks, experiment.pixel, calibrate=calibrate, joint_shapes=images.method == "map"
    )
    if found.order > 1 and images.method == "map" and not found.shapes:
        again = images.model_copy(update={"flat_shape": found.order})
        more = shared_detector(
            again, experiment.absorber, blocks, experiment.pixel, calibrate=calibrate, joint_shapes=True
        )
        found = replace(more, remarks=(*found.remarks, *(r for r in more.remarks if r not in found.remarks)))
    experiment = replace(
        experiment,
        detector=found,
        notes={**experiment.notes, **dict(found.notes)},
        remarks=(*experiment.remarks, *found.remarks),
    )
    return experiment, bent(frame, found)


def _single_frames(experiment: Experiment, most: int = 4) -> list[tuple[Frame, Track]]:
    """Some frames of a stack whose jet moves from one to the next, with the jet in each."""
    stack = experiment.stack
    out = []
    for i in np.unique(np.linspace(0, stack.frames - 1, most).astype(int)).tolist():
        try:
            frame, _ = experiment.frame(one_frame(stack, i), (i + 0.5) / stack.frames)
            out.append((frame, require_track(frame)))
        except InputError:
            continue
    return out


def _looked_at(experiment: Experiment, frame: Frame, track: Track, facts: dict[str, float]) -> Experiment:
    """The experiment with what is odd about its frame: fringes, a lean, what the method leaves out."""
    images, medium, wave = experiment.images, experiment.medium, experiment.wave_medium
    remarks, notes, fringes = list(experiment.remarks), dict(experiment.notes), np.nan
    if images.method != "phase":
        if experiment.fields.shared:  # more rows than a block would see the noise of their common flat
            start = steady_rows(track)[0]
            fringes, said = fringes_in(part_of(frame, start, start + images.block_rows), wave, None, 1)
        else:
            fringes, said = fringes_in(frame, wave, track)
        notes["fringes"] = said
        if fringes >= FRINGES:
            remarks.append(said)
        expect_fringes(images, wave, experiment.pixel, experiment.detector.blur, fringes, remarks)
    remarks += odd_facts(facts, bool(experiment.fields.dark.any()))
    low, high = experiment.lean.degrees if experiment.lean.slope.size else (0.0, 0.0)
    notes["lean"] = experiment.lean.words()
    if max(abs(low), abs(high)) > _LEANS:
        angle = max(low, high, key=abs)
        a = experiment.absorber
        worth = (a.solvent - a.air) / a.contrast * (1.0 / np.cos(np.radians(angle)) - 1.0)
        remarks.append(
            f"the jet leans by {angle:.2g} degrees in the image: chord and radius are corrected by the cosine; left out, "
            f"the fraction would shift by {-worth:+.2g}"
        )
    if experiment.lean.bend_error > _BENDS:
        a = experiment.absorber
        worth = abs((a.solvent - a.air) / a.contrast) * experiment.lean.bend_error
        remarks.append(
            f"the jet bends to a circle of {1.0 / experiment.lean.bend:.2g} of its radii: rows cut no ellipse there, and the "
            f"fraction may be off by {worth:.1g}; take the rows where it is straight"
        )
    if images.method in ("chord", "map") and medium is not None and medium.energy_kev.size > 1:
        radius = float(np.median(track.radius)) * experiment.pixel
        remarks.append(hardened(images.method, medium, experiment.solution.volume_fraction, radius))
    if images.method == "chord" and experiment.detector.blur > 0.5 * experiment.pixel:
        remarks.append(
            "chords take no account of the blur: the radius comes out too large, the fraction off; use the likelihood"
        )
    return replace(experiment, remarks=tuple(remarks), notes=notes, fringes=fringes)


def _scaled(experiment: Experiment, frame: Frame, track: Track, calibrate: bool) -> Experiment:
    """The experiment with its attenuation calibrated, or with the errors of what it rests on."""
    images, solution, absorber = experiment.images, experiment.solution, experiment.absorber
    _, errors = path_factor(images)
    if images.calibration_rows is not None and calibrate:
        return calibrated(experiment, frame, track)
    remarks, notes = list(experiment.remarks), dict(experiment.notes)
    if images.polymer_attenuation is None and images.energy is not None:
        remarks.append(uncalibrated(images, solution, absorber))
    remarks += ideal_mixture(images, solution, absorber)
    doubts = relative_doubts(images, solution, absorber, experiment.pixel, experiment.pixel_std) | errors
    lean = experiment.lean.path_std
    if lean > _LEAN_MATTERS:
        doubts["lean"] = lean
    if images.linearity is not None and images.linearity.std > 0.0:  # e changes ln T by e (1 - T), of the middle chord
        depth = 2.0 * float(np.median(track.radius * track.attenuation))
        doubts["linearity"] = images.linearity.std * float(-np.expm1(-depth) / depth) if depth > 0.0 else 0.0
    if doubts:
        notes["shared_error"], much = doubt_words(doubts, absorber, solution.volume_fraction)
        if much:
            remarks.append(f"{notes['shared_error']}; calibration_rows would take it out")
    given = Calibration(1.0, float(np.sqrt(sum(value**2 for value in doubts.values()))))
    return replace(experiment, calibration=given, remarks=tuple(remarks), notes=notes)
