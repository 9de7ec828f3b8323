"""First looks at a summed frame: the jet and which way it runs, the size of a pixel at the nozzle, fringes, what is odd."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.errors import InputError
from spinline.scene.images_file import Images
from spinline.xray.frame.blocks import Frame, require_track
from spinline.xray.frame.breaks import row_breaks
from spinline.xray.frame.lean import Lean
from spinline.xray.frame.moved_beam import moved_beam
from spinline.xray.frame.track import Track, track_jet
from spinline.xray.phase.fit import phase_law
from spinline.xray.phase.frame import track_fringes
from spinline.xray.phase.fringe_frame import frame_fringes
from spinline.xray.row.fit import fit_row
from spinline.xray.row.outcome import RowFit
from spinline.xray.row.spectral import spectral_law

if TYPE_CHECKING:
    from spinline.xray.matter.medium import Medium

__all__ = [
    "FRINGES",
    "broken_rows",
    "expect_fringes",
    "find_track",
    "fringes_in",
    "measured_pixel",
    "odd_facts",
    "part_of",
    "require_one_jet",
    "require_the_flats_beam",
    "require_upright",
    "row_law",
    "without_nozzle",
]

#: Significance of fringes that is an alarm.
FRINGES = 5.0
_MOVED = 0.1  # of the shadow
_AWAY = 2  # rows from a break
_OTHER = 1.4  # times the flat's exposure
_UNTOLD, _STEEPEST = 0.1, 60.0  # of the paths; degrees


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


def part_of(frame: Frame, start: int, stop: int) -> Frame:
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
            "flat",
            "seems to have changed places with counts: the jet is in the flat, not in the frames",
            remedy="counts are the frames with the jet, flat those without",
        )


def row_law(images: Images, medium: "Medium | None") -> Callable[..., RowFit]:
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


def measured_pixel(images: Images, frame: Frame, notes: dict[str, str]) -> tuple[float, float]:
    """Width of a pixel at the jet and its standard deviation, m: given, or from the nozzle in view."""
    if images.pixel_size is not None:
        m = images.magnification
        notes["pixel_size"] = f"{images.pixel_size.text}, given" + (
            f", over a magnification of {m:g}" if m != 1.0 else ""
        )
        return images.pixel_size.value / m, images.pixel_size.std / m
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


def without_nozzle(frame: Frame, images: Images) -> Frame:
    """The frame with the nozzle's rows left out."""
    if images.nozzle_rows is None:
        return frame
    good = frame.good.copy()
    good[slice(*images.nozzle_rows)] = False
    return replace(frame, good=good)


def require_upright(frame: Frame) -> None:
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
            "transpose",
            "seems wrong: the jet runs along the rows, it has to run down the columns",
            remedy="set transpose = true, or take it out",
        )


def require_the_flats_beam(frame: Frame) -> list[str]:
    """Words where the beam's structure moved since the flat; refused where that is more than a tenth of the jet's shadow."""
    ratio = np.where(frame.good, (frame.counts - frame.dark) / np.where(frame.good, frame.flat, 1.0), np.nan)
    moved = moved_beam(np.nan_to_num(ratio), frame.flat, frame.good)
    if moved is None:
        return []
    middle = _smooth(np.nanmedian(ratio, axis=0))
    depth = 1.0 - float(np.quantile(middle, 0.1)) / float(np.quantile(middle, 0.9))
    problem = (
        f"the beam's structure (stripes, the edge of a slit) moved by {moved.across:+.2g} pixels across and "
        f"{moved.down:+.2g} down since the flat: that alone makes {100 * moved.size:.2g} % of the counts (root mean square), "
        f"the jet {100 * depth:.2g} %"
    )
    remedy = "take flats before and after the jet (flat_after), and by roi the columns where the beam is even"
    if moved.size > _MOVED * depth:
        raise InputError("flat", f"does not show the beam that the counts had: {problem}", remedy=remedy)
    return [f"{problem}; {remedy}"]


def broken_rows(frame: Frame, images: Images) -> InputError | None:
    """What is wrong with a frame whose shadow jumps from one row to the next, its own flat and dark left aside."""
    good = frame.good.copy()
    for source in (images.flat, images.dark):
        if source is not None and source.file is None and source.rows is not None:
            good[slice(*source.rows)] = False
    if not (breaks := row_breaks(frame.counts, frame.flat, frame.dark, good)):
        return None
    ends = [-_AWAY, *(b.row for b in breaks), frame.good.shape[0] + _AWAY]
    start, stop = max(((a + _AWAY, b - _AWAY) for a, b in pairwise(ends)), key=lambda part: part[1] - part[0])
    most = max(breaks, key=lambda b: abs(b.below - b.above))
    return InputError(
        "counts",
        f"show more than one jet down the rows: its shadow (the sum of 1 - T over a row) jumps from {most.above:.3g} to "
        f"{most.below:.3g} pixels at row {most.row}: the nozzle's end, a drop, the end of the jet",
        value=f"{len(breaks)} such rows: {', '.join(str(b.row) for b in breaks[:6])}",
        allowed="a shadow that changes by less than a factor of 2 from row to row",
        remedy=f"take the rows of the jet alone, perhaps roi = {{ rows = [{start}, {stop}] }}; or, of an opaque nozzle, name "
        "nozzle_diameter and nozzle_rows",
    )


def require_one_jet(lean: Lean) -> None:
    """Refuse frames in which the jet's axis is not told: rows that show several jets, or hardly one."""
    steepest = max(map(abs, lean.degrees))
    if lean.path_std > _UNTOLD or steepest > _STEEPEST:
        raise InputError(
            "counts",
            "show no single jet that can be followed: the axis found wanders from row to row",
            value=f"{steepest:.0f} degrees at its steepest, paths known to {100 * min(lean.path_std, 9.99):.0f} %",
            allowed=f"up to {_STEEPEST:g} degrees, {100 * _UNTOLD:g} %",
            remedy="cut out the rows and columns of one jet with roi; sum more frames; check flat and dark",
        )


def _smooth(values: FloatArray) -> FloatArray:
    return np.convolve(values, np.full(5, 0.2), mode="valid")


def expect_fringes(
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


def odd_facts(facts: dict[str, float], darkness: bool) -> list[str]:
    """Words on what is odd about a frame's numbers; `darkness`: a dark is taken off."""
    said = []
    if facts["invalid_pixels"]:
        said.append(f"{facts['invalid_pixels']:.0f} pixels are marked as invalid by the detector, and are left out")
    if facts["saturated_pixels"]:
        said.append(f"{facts['saturated_pixels']:.0f} saturated pixels are masked")
    if facts["outlying_pixels"]:
        said.append(f"{facts['outlying_pixels']:.0f} pixels far off their neighbours are masked")
    if facts["piled_up_pixels"]:
        said.append(
            f"{facts['piled_up_pixels']:.0f} pixels hold exactly the highest count, {facts['highest_count']:g}: if the "
            f"detector clips there, the fraction is wrong; give saturation = {facts['highest_count']:g}"
        )
    if darkness and not 1.0 / _OTHER < facts["level"] < _OTHER:
        said.append(
            f"beside the jet the counts are {facts['level']:.3g} of the flat: another exposure or another scale; the dark that "
            "is taken off has to be that of the counts too (0.1 % of the beam in it shifts the fraction by 0.004)"
        )
    if facts["flat_noise"] > 1.05:
        said.append(
            f"the flats are few: their noise makes errors {np.sqrt(facts['flat_noise']):.3g} times larger (accounted for)"
        )
    if facts["added_noise"]:
        said.append("counts under the dark level by more than the read noise: more read noise is assumed")
    return said
