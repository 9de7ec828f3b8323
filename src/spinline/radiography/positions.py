"""A jet imaged at several places along it: one detector, one geometry, one map.

Every position has its frames, its flats and its beam; the stage says where along the jet it is (``offset``, with an error).
The detector (blur, glare, attenuation where the fraction is known at some position) is fitted to blocks of all positions
together. Then

* `row`: every block of every position by itself; where two positions see the same place both are in the result, and what they
  say of it apart is tested (the seams);
* `map`: the rows of all positions in the order of their places, one fraction phi(r, z) and one radius R(z) for all. Level and
  slope of the beam, and where the axis lies across the image, are a position's own: taken out beforehand, to the precision of
  all its rows together, and what is left of them is smooth along z as in a single image.
"""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.images.stacks import Stack
from spinline.images.sums import FrameSum
from spinline.radiography.detector import shared_detector
from spinline.radiography.experiment import Experiment, bent, fit_blocks
from spinline.radiography.looks import part_of
from spinline.radiography.methods import map_frame_fit, map_shifts
from spinline.radiography.prepare import first_look, judged, sees_jointly
from spinline.radiography.stage import Seam, stage_shifts
from spinline.scene.images_file import Images
from spinline.xray.frame.blocks import Frame, FrameFit
from spinline.xray.frame.lean import axis_lean
from spinline.xray.frame.shared import fit_detector
from spinline.xray.frame.still import blocks_of_frame
from spinline.xray.frame.track import Track
from spinline.xray.map.fit import fit_map
from spinline.xray.map.result import MapFit, MapState
from spinline.xray.row.chords import shell_weights
from spinline.xray.row.model import beam_shape

__all__ = ["Place", "prepare_positions", "reduce_positions", "seams"]


@dataclass(frozen=True, eq=False)
class Place:
    """One position, ready to reduce.

    Attributes
    ----------
    experiment, frame, track
        As of a single set of images.
    facts : dict
    offset, offset_std : float
        Of its first row along the jet, m.
    moved : float
        By how much it was moved from where the stage said, for the radii of its neighbours.
    stage_covariance : ndarray or None
        Of the offsets of all positions, then.
    """

    experiment: Experiment
    frame: Frame
    track: Track
    facts: dict[str, float]
    offset: float
    offset_std: float
    moved: float = 0.0
    stage_covariance: FloatArray | None = None

    @property
    def z(self) -> FloatArray:
        """Places of the rows along the jet, m."""
        step = np.hypot(1.0, self.experiment.lean.slope) * self.frame.pixel
        return np.asarray(self.offset + np.cumsum(step) - 0.5 * step)


def prepare_positions(images: Images, summing: Callable[[Stack], FrameSum]) -> tuple[list[Place], list[str]]:
    """Open and check all positions, and fit the detector that they share.

    Returns
    -------
    places : list of Place
        In the order of their offsets.
    remarks : list of str
        What is odd of all of them.
    """
    looks = []
    for i, place in enumerate(images.positions):
        try:
            look = first_look(images.at(i), summing)
        except InputError as error:
            raise InputError(
                f"positions.{i}.{error.field}",
                error.problem,
                value=error.value,
                allowed=error.allowed,
                remedy=error.remedy,
            ) from None
        looks.append((place.offset, *look))
    order = sorted(range(len(looks)), key=lambda i: looks[i][0].value)
    looks = [looks[i] for i in order]
    first: Experiment = looks[0][1]
    if not sees_jointly(first):
        raise InputError(
            "positions",
            "are reduced by absorption at one energy",
            value=images.method,
            remedy='take method "map" or "row"',
        )
    pixels = {look[1].pixel for look in looks}
    if max(pixels) - min(pixels) > 1e-9 * max(pixels):
        raise InputError("positions", "have pixels of different sizes", value=sorted(pixels), remedy="give pixel_size")
    blocks = []
    for _, experiment, frame, track, _ in looks:
        rows = experiment.images.calibration_rows
        known = None if rows is None else (rows, experiment.solution.volume_fraction)
        clear = replace(frame, blur=0.0)
        blocks += blocks_of_frame(clear, track, experiment.lean, known=known)
    calibrate = any(block.known is not None for block in blocks)
    common = (
        images if images.method == "row" else images.model_copy(update={"flat_shape": 1})
    )  # a map's shapes: `_own_shape`
    found = shared_detector(common, first.absorber, blocks, first.pixel, calibrate=calibrate, joint_shapes=False)
    calibration = next((k for k, look in enumerate(looks) if look[1].images.calibration_rows is not None), None)
    places = []
    for k, (offset, experiment, frame, track, facts) in enumerate(looks):
        mine = replace(experiment, detector=found, notes={**experiment.notes, **dict(found.notes)})
        seen = _own_shape(mine, bent(frame, found), track)
        elsewhere = calibration is not None and k != calibration
        mine = judged(mine, seen, track, facts, elsewhere=elsewhere)
        places.append(Place(mine, seen, track, facts, offset.value, offset.std))
    if calibration is not None:
        places = _calibrated_alike(places, calibration)
    return places, [*found.remarks, *_apart(places)]


def _own_shape(experiment: Experiment, frame: Frame, track: Track) -> Frame:
    """For a map: the frame with the bend that this position's own beam has in its flat, the detector held."""
    images = experiment.images
    if images.method != "map" or (images.flat_shape or 1) < 2:
        return frame
    blocks = blocks_of_frame(frame, track, experiment.lean)
    names = [f"shape{n}" for n in range(2, (images.flat_shape or 1) + 1)]
    found = fit_detector(blocks, experiment.absorber, names, shells=3)
    bend = beam_shape({name: found.values[name] for name in names}, frame.counts.shape[1])
    return replace(frame, flat=frame.flat * bend)


def _calibrated_alike(places: list[Place], which: int) -> list[Place]:
    """All positions with the attenuation of the one whose fraction is known in part."""
    source = places[which].experiment
    return [
        replace(
            place,
            experiment=replace(
                place.experiment,
                absorber=source.absorber,
                medium=source.medium,
                calibration=source.calibration,
                notes={**place.experiment.notes, "calibration": source.notes["calibration"]},
            ),
        )
        for place in places
    ]


def _apart(places: list[Place]) -> list[str]:
    """Words where two neighbouring positions share no row."""
    return [
        f"positions {a} and {a + 1} do not overlap: nothing ties them but the smoothness of the jet"
        for a, (one, two) in enumerate(pairwise(places))
        if one.z[-1] < two.z[0]
    ]


def seams(places: list[Place], fits: list[FrameFit]) -> list[Seam]:
    """Test what neighbouring positions say of the rows that both see, cut into the same blocks.

    Parameters
    ----------
    places : list of Place
    fits : list of FrameFit
        One of each, block by block and without a smoothness along z: for the jet's taper.
    """
    from scipy.stats import chi2

    out = []
    for a in range(len(places) - 1):
        one, two = places[a], places[a + 1]
        rows = min(int((one.z > two.z[0] - 0.5 * two.frame.pixel).sum()), one.z.size, two.z.size)
        if rows < 1:
            continue
        height = min(one.experiment.images.block_rows, rows)
        ends = [(one, one.z.size - rows), (two, 0)]
        try:
            ours, theirs = (_seen_blocks(place, start, start + rows, height) for place, start in ends)
        except InputError:  # no block of one of them can be fitted
            continue
        both = np.isfinite(ours.mean) & np.isfinite(theirs.mean)
        slopes = [_taper(place, fit) for place, fit in ((one, fits[a]), (two, fits[a + 1]))]
        if not both.any() or not np.isfinite(slopes).any():
            continue
        taper = float(np.nanmean(slopes))
        apart = [one.z[s + one.z.size - rows : e + one.z.size - rows].mean() - two.z[s:e].mean() for s, e in ours.rows]
        gaps = ours.values["radius"] - theirs.values["radius"] - taper * np.array(apart)
        variance = (ours.std["radius"] ** 2 + theirs.std["radius"] ** 2)[both]
        own = float(variance.sum() ** 0.5) / int(both.sum())
        gap = float(gaps[both].mean())
        spread = (ours.mean_std**2 + theirs.mean_std**2)[both]
        chi = float(((ours.mean - theirs.mean)[both] ** 2 / spread).sum())
        stage = abs(taper) * float(np.hypot(one.offset_std, two.offset_std))
        count = int(both.sum())
        pull = gap / float(np.hypot(own, stage))
        out.append(Seam(a, a + 1, chi, count, float(chi2.sf(chi, count)), pull, gap, own, taper))
    return out


def _seen_blocks(place: Place, start: int, stop: int, height: int) -> FrameFit:
    """Rows of a position from `start` to before `stop`, fitted block by block as one shell."""
    part = Track(*(getattr(place.track, item.name)[start:stop] for item in dataclasses.fields(Track)))
    lean = axis_lean(place.track).slope[start:stop]
    frame = part_of(place.frame, start, stop)
    return fit_blocks(place.experiment, frame, part, shells=1, block_rows=height, lean=lean)


def _taper(place: Place, fit: FrameFit) -> float:
    """dR/dz of a position, a line through its blocks; NaN where there is one block alone."""
    good = np.isfinite(fit.mean)
    if good.sum() < 2:
        return float("nan")
    z = np.array([place.z[start:stop].mean() for start, stop in fit.rows[good].tolist()])
    return float(np.polyfit(z, fit.values["radius"][good], 1)[0])


def reduce_positions(
    places: list[Place],
    *,
    done: Callable[[int, int], None] | None = None,
    begun: MapState | None = None,
    keep: Callable[[MapState], None] | None = None,
) -> tuple[list[Place], list[FrameFit], FrameFit | None, FloatArray, list[Seam]]:
    """Reduce all positions.

    Returns
    -------
    places : list of Place
        Where their radii say that they are (`stage`).
    fits : list of FrameFit
        Of each position, block by block.
    joint : FrameFit or None
        The map of all of them; None for the method "row".
    z : ndarray
        Places of the map's rows, m.
    seams : list of Seam
    """
    images = places[0].experiment.images
    fits = []
    height = images.block_rows
    for i, place in enumerate(places):
        fits.append(
            fit_blocks(
                place.experiment,
                place.frame,
                place.track,
                shells=images.shells if images.method == "row" else 1,
                block_rows=height,
            )
        )
        if done is not None:
            done(i + 1, len(places))
    found = seams(places, fits)
    places = _placed(places, found)
    if images.method == "row":
        return places, fits, None, np.zeros(0), found
    joint, z = _joint_map(places, fits, begun, keep)
    return places, fits, joint, z, found


def _placed(places: list[Place], found: list[Seam]) -> list[Place]:
    """The positions where their radii say that they are, with the errors that are left."""
    shift, covariance = stage_shifts(np.array([place.offset_std for place in places]), found)
    std = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    return [
        replace(place, offset=place.offset + d, offset_std=s, moved=d, stage_covariance=covariance)
        for place, d, s in zip(places, shift.tolist(), std.tolist(), strict=True)
    ]


def _joint_map(
    places: list[Place],
    fits: list[FrameFit],
    begun: MapState | None,
    keep: Callable[[MapState], None] | None,
) -> tuple[FrameFit, FloatArray]:
    """One map of the rows of all positions."""
    width = min(place.frame.counts.shape[1] for place in places)
    if any(place.frame.counts.shape[1] != width for place in places):
        raise InputError("positions", "have frames of different widths", remedy="cut them alike with roi")
    first = places[0].experiment
    counts, good, detectors, z, radius, axis, aside, path = [], [], [], [], [], [], [], []
    for place, fit in zip(places, fits, strict=True):
        frame, track, lean = place.frame, place.track, axis_lean(place.track)
        level, slope, middle = _own_beam(frame, fit)
        u = np.linspace(-1.0, 1.0, width)
        flat = frame.flat * (level * (1.0 + slope * u))
        seen = replace(frame, flat=flat)
        for i in range(frame.counts.shape[0]):
            lit = frame.good[i]
            if lit.any():
                row, detector, mask = seen.block(i, i + 1)
            else:
                row, mask = np.zeros(width), np.zeros(width, dtype=np.bool_)
                detector = seen.detector(np.ones(width), np.zeros(width))
            counts.append(row)
            good.append(mask)
            detectors.append(detector)
        z.append(place.z)
        radius.append(frame.pixel * track.radius)
        axis.append(frame.pixel * track.axis)
        aside.append(np.full(track.axis.size, middle) + _straight(track, frame.pixel, middle))
        path.append(lean.cosine)
    at = np.concatenate(z)
    order = np.argsort(at, kind="stable")
    places_z = _rising(at[order], places[0].frame.pixel)
    lean_mean = float(np.concatenate(path).mean())
    across = [
        replace(detectors[i], blur=detectors[i].blur / lean_mean, tail_length=detectors[i].tail_length / lean_mean)
        for i in order
    ]
    found = fit_map(
        np.array(counts)[order],
        first.absorber,
        across,
        z=places_z,
        nuisances=first.nuisances,
        shells=first.images.shells,
        radius=np.concatenate(radius)[order],
        axis=np.concatenate(axis)[order],
        good=np.array(good)[order],
        path=np.concatenate(path)[order],
        axis_offset=np.concatenate(aside)[order],
        begun=begun,
        keep=keep,
    )
    shifts = np.zeros((at.size, found.edges.size - 1, len(first.detector.names)))
    if first.detector.names:
        parts = [map_shifts(p.experiment, p.frame, p.track, axis_lean(p.track), found.edges, p.z) for p in places]
        shifts = np.concatenate(parts)[order]
    rows: NDArray[np.int64] = np.stack((np.arange(at.size), np.arange(1, at.size + 1)), axis=1)
    cosine = np.concatenate(path)[order]
    which = np.repeat(np.arange(len(places)), [p.z.size for p in places])[order]
    joint = map_frame_fit(found, rows, cosine, shifts)
    if found.converged:
        _take_stage(joint, found, places, which, cosine)
    return joint, places_z


def _take_stage(
    joint: FrameFit, found: MapFit, places: list[Place], which: NDArray[np.int64], cosine: FloatArray
) -> None:
    """Add to a map's errors what those of the stage make of them: rows of a jet that thins, shifted position by position."""
    std = np.array([place.offset_std for place in places])
    if not std.any():
        return
    taper = np.gradient(found.radius, found.z)
    parts = [found.response("radius", np.where(which == k, taper, 0.0)) for k in range(len(places))]
    stage = places[0].stage_covariance if places[0].stage_covariance is not None else np.diag(std**2)
    radius = np.stack([part[1] for part in parts], axis=1) * cosine[:, None]
    more = np.einsum("ri,ij,rj->r", radius, stage, radius)
    joint.std["radius"][:] = np.sqrt(joint.std["radius"] ** 2 + np.maximum(more, 0.0))
    fraction = np.stack([part[0] for part in parts], axis=2)
    joint.covariance[:] += np.einsum("rsi,ij,rtj->rst", fraction, stage, fraction)
    mean = np.einsum("rsi,s->ri", fraction, shell_weights(found.edges))
    joint.mean_std[:] = np.sqrt(joint.mean_std**2 + np.maximum(np.einsum("ri,ij,rj->r", mean, stage, mean), 0.0))


def _own_beam(frame: Frame, fit: FrameFit) -> tuple[float, float, float]:
    """Level and slope of a position's beam over its flat, and the middle of its axis, m: means over its blocks."""
    known = np.isfinite(fit.mean)
    if not known.any():
        raise InputError("positions", "one of them shows no jet in any block", remedy="take it out")
    out = []
    for name in ("amplitude", "slope", "axis"):
        weight = 1.0 / np.maximum(fit.std[name][known], 1e-12) ** 2
        out.append(float((weight * fit.values[name][known]).sum() / weight.sum()))
    return out[0], out[1], out[2]


def _straight(track: Track, pixel: float, middle: float) -> FloatArray:
    """The straight line through a position's axis, less its middle, m: a stage that is not along the jet."""
    at = np.arange(track.axis.size)
    if at.size < 3:
        return np.zeros(at.size)
    line = np.polyfit(at, track.axis * pixel, 1, w=1.0 / np.maximum(track.axis_std, 1e-3))
    return np.asarray(np.polyval(line, at) - middle)


def _rising(z: FloatArray, pixel: float) -> FloatArray:
    """Places that rise from row to row: rows of two positions at one place are put a hair apart."""
    out = z.copy()
    for i in range(1, out.size):
        if out[i] <= out[i - 1]:
            out[i] = out[i - 1] + 1e-6 * pixel
    return out
