"""Whether a frame holds fringes: groups of its rows tested together, so that what no row shows alone is seen.

Each group of rows is summed where the jet stands still in it and tested as `fringes` does. Groups share the distance, so at
each one their projections add up, ``sum_g p_g . r_g / sqrt(sum_g p_g . p_g)``: the most powerful test of fringes of that
distance in all of them, 0 to 2 without any. Rows in which no jet is found are tested in groups of equal height with the
fringes folded back first.

`brightened_air` is the quick look of it, without a model: light beside the jet over that farther off, which no absorption
makes.
"""

from itertools import pairwise

import numpy as np

from spinline.base.checks import BoolArray, FloatArray, positive
from spinline.base.errors import InputError
from spinline.xray.frame.blocks import Frame
from spinline.xray.frame.track import Track
from spinline.xray.matter.medium import Medium
from spinline.xray.phase.fringes import FringeLook, FringeTest, look_for_fringes

__all__ = ["brightened_air", "frame_fringes"]

_STILL = 1.0  # pixels that radius and axis may change in a group
_MOST_ROWS = 64  # of a group where no track says how the jet changes
_PLAIN = 20.0  # significance that more groups need not confirm
_LEAST_EXCESS = 2e-3  # of the beam, that no curvature of it makes
_ZONES = (1.5, 2.5, 4.5, 8.5, 16.5)  # pixels beside the jet's edge


def frame_fringes(
    frame: Frame, medium: Medium, *, track: Track | None = None, threshold: float = 5.0, places: int = 12
) -> FringeTest:
    """Test a frame for fringes.

    Parameters
    ----------
    frame : Frame
    medium : Medium
        Attenuation and refraction (`solution_medium`), of one line or of many.
    track : Track, optional
        From `track_jet`: says in which rows the jet stands still.
    threshold : float
        As in `detect_fringes`.
    places : int
        Groups of rows, >= 1.

    Returns
    -------
    FringeTest
        Without a distance.

    Raises
    ------
    InputError
        Where no row can be tested: the reason of the first.

    Notes
    -----
    20 to 200 ms a group; it ends as soon as fringes are beyond doubt.
    """
    least = positive("threshold", threshold)
    if isinstance(places, bool) or not isinstance(places, int) or places < 1:
        raise InputError("places", "is not a number of groups", value=places, allowed=">= 1")
    total: FringeLook | None = None
    first: InputError | None = None
    groups = _groups(frame, track, places)
    significance = -np.inf
    for start, stop in groups[
        np.argsort(np.arange(len(groups)) % 3, kind="stable")
    ].tolist():  # from all over the frame
        try:
            counts, detector, good = frame.block(start, stop)
            look = look_for_fringes(counts, medium, detector, good=good)
        except InputError as error:
            first = first or error
            continue
        total = look if total is None else total + look
        significance = total.significance()
        if significance > _PLAIN:
            break
    if total is None:
        assert first is not None
        raise first
    if significance < least:
        return FringeTest(False, significance, np.nan, np.nan, total.overshoot, "")
    message = (
        f"Fresnel fringes, {significance:.3g} standard deviations: refraction, which absorption alone takes for polymer "
        '(-0.2 to -6 in the fraction); take method = "phase" with propagation_distance'
    )
    return FringeTest(True, significance, np.nan, np.nan, total.overshoot, message)


def brightened_air(counts: FloatArray, dark: FloatArray, beam: FloatArray, aside: FloatArray, good: BoolArray) -> float:
    """How far light beside the jet exceeds that farther off, in standard deviations: no model, all rows at once.

    Parameters
    ----------
    counts, dark, beam : ndarray, shape (rows, pixels)
        Measured photons, dark, and those of the beam without a jet, above dark.
    aside : ndarray, shape (rows, pixels)
        Distance from the jet's edge, pixels, > 0 outside.
    good : ndarray of bool, shape (rows, pixels)

    Returns
    -------
    float
        The largest over zones of 1 to 16 pixels beside the edges in which it exceeds 0.2 % of the beam; -inf where there is
        none, or no air.
    """
    far = good & (aside > _ZONES[-1])
    if far.sum() < 8:
        far = good & (aside > _ZONES[2])
    if far.sum() < 8:
        return -np.inf
    level = float((counts - dark)[far].sum() / beam[far].sum())
    found = -np.inf
    for zone in _ZONES:
        near = good & (aside > 0.5) & (aside <= zone)
        if not near.any():
            continue
        lit, noise = level * float(beam[near].sum()), float((level * beam + dark)[near].sum())
        excess = float((counts - dark)[near].sum()) - lit
        noise += lit**2 * float(counts[far].sum()) / (level * float(beam[far].sum())) ** 2
        if noise > 0.0 and excess > _LEAST_EXCESS * lit:
            found = max(found, excess / np.sqrt(noise))
    return found


def _groups(frame: Frame, track: Track | None, places: int) -> "np.ndarray[tuple[int, int], np.dtype[np.int64]]":
    """First rows of groups and the rows after their last: as large as the jet stands still in them."""
    rows = frame.counts.shape[0]
    bounds = np.linspace(0, rows, min(places, rows) + 1).astype(np.int64)
    spans = list(pairwise(bounds.tolist()))
    if track is None:
        cut = [(start, min(stop - start, _MOST_ROWS)) for start, stop in spans]
        return np.array([(start, start + height) for start, height in cut], dtype=np.int64)
    out: list[tuple[int, int]] = []
    first, moved = 0, 0.0
    for start, stop in spans:
        part, height = slice(start, stop), stop - start
        slopes = (_slope(v[part]) for v in (track.radius, track.axis))
        change = height * sum(abs(slope) for slope in slopes)
        if moved > 0.0 and moved + change > _STILL:
            out.append((first, start))
            first, moved = start, 0.0
        if change > _STILL:  # a part of the span, from its middle
            most = int(np.clip(height * _STILL / change, 1, height))
            low = start + (height - most) // 2
            out.append((low, low + most))
            first, moved = stop, 0.0
        else:
            moved += max(change, 1e-9)
    if first < rows and moved > 0.0:
        out.append((first, rows))
    return np.array(out, dtype=np.int64)


def _slope(values: FloatArray) -> float:
    return float(np.polyfit(np.arange(values.size), values, 1)[0]) if values.size > 2 else 0.0
