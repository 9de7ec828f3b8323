"""From counts on disk to photons: flat and dark, gain, bad pixels, and the noise that each of them adds.

    photons = gain counts,    var(photons) = photons above dark + v_d

The likelihood knows Poisson counts alone, so every noise is put into their form. Read noise: dark counts of variance v_d
(from pairs of dark frames) are shifted to a mean of v_d, which leaves the signal as it is. Flats of finite exposure: counts
N against a flat of F photons scatter by ``(1 + N/F)`` more than Poisson, so all photons are divided by that number, v: they
then carry the information that is really there, and no error bar is too small for want of flats. A flat of one row
serves all rows: summed over B of them its noise adds up, and v = 1 + B N/F.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.images.frames import FrameSum, Stack, open_stack, pair_noise, sample_frames, sum_frames
from spinline.scene.images_file import Images, Source

if TYPE_CHECKING:
    from spinline.xray.frame.blocks import Frame

__all__ = ["Fields", "build_fields", "lone_outliers", "open_counts", "photons_frame"]

_MOST_PHOTONS = 1e15  # differences of single photons are lost in a float beyond
_MOST_SATURATED = 1e-3  # share of the frame that is masked rather than refused


@dataclass(frozen=True, eq=False)
class Fields:
    """What turns counts into photons; arrays (rows, columns), or broadcast to that.

    Attributes
    ----------
    dark : ndarray
        Counts of one exposure without a beam.
    dark_variance : float or None
        Of one exposure, photons squared; None: dark counts are taken as Poisson.
    flat, flat_after : ndarray or None
        Counts of one exposure without a jet, above dark, before (and after); None: from the frame itself, see `region`.
    region : Source or None
        The part of the frame itself that shows no jet.
    flat_exposures : float
        Exposures that each number of `flat` is a mean of.
    gain : float
        Photons per count.
    shared : bool
        Every row has the same flat, and the same noise of it.
    bad : ndarray of bool
        Pixels left out.
    notes : dict of str
        How gain, dark, flat and bad pixels were come by, for the result.
    """

    dark: FloatArray
    dark_variance: float | None
    flat: FloatArray | None
    flat_after: FloatArray | None
    region: Source | None
    flat_exposures: float
    gain: float
    bad: BoolArray
    notes: dict[str, str]
    remarks: tuple[str, ...] = ()
    shared: bool = False

    def flat_noise(self, images: Images, exposures: float, rows: int) -> float:
        """How much more than Poisson a block of rows scatters for the noise of the flats: v."""
        together = (rows if images.method == "map" else images.block_rows) if self.shared else 1
        return 1.0 + together * (1.0 if self.region is not None else exposures) / self.flat_exposures


def open_counts(images: Images) -> Stack:
    """Stack of the frames with the jet."""
    stack = open_stack(images.counts, "counts", images.folder, transpose=images.transpose)
    shape = stack.reader.shape
    if len(shape) == 3 and shape[-1] in (3, 4) and shape[0] > 4:
        raise InputError("counts", "is a colour image, no counts", value=f"array of shape {shape}",
                         remedy="give the detector's raw frames, (frame, z, x) or (z, x)")  # fmt: skip
    if stack.columns < 8:
        raise InputError("counts", "has fewer than 8 pixels across the jet", value=f"{stack.rows} x {stack.columns}",
                         remedy="check transpose: a row runs across the jet")  # fmt: skip
    for key in ("calibration_rows", "nozzle_rows"):
        rows = getattr(images, key)
        if rows is not None and rows[1] > stack.rows:
            raise InputError(key, "goes beyond the frame", value=list(rows), allowed=f"rows 0 to {stack.rows}")
    if images.block_rows > stack.rows:
        raise InputError(
            "block_rows", "is more than the frame has", value=images.block_rows, allowed=f"[1, {stack.rows}]"
        )
    return stack


def build_fields(images: Images, counts: Stack) -> Fields:
    """Read flat, dark and bad pixels, and find the gain.

    Raises
    ------
    InputError
        For files or parts of frames that do not fit the frames, dark at or over the flat, or a gain that is neither given nor
        to be found from the flats.
    """
    notes: dict[str, str] = {}
    remarks: list[str] = []
    dark, dark_stack = _dark(images, counts, notes, remarks)
    shape = (counts.rows, counts.columns)
    bad = np.zeros(shape, dtype=np.bool_)
    source = images.flat
    flat = flat_after = None
    if source.file is None:
        _part(source, counts, "flat")
        stack, part, exposures, own = counts, _slices(source), float(_pixels_in_mean(source, counts)), source
        notes["flat"] = f"from the frames themselves, {_spoken(source)}"
    else:
        stack, part, own = _opened(source, "flat", images, counts), _slices(source), None
        flat, exposures, clipped = _mean_flat(source, stack, counts, dark, images.saturation)
        bad |= clipped
        notes["flat"] = f"{source.file}, {stack.frames} frames" + (
            f", {_spoken(source)}" if source.rows or source.columns else ""
        )
        if images.flat_after is not None:
            after = images.flat_after
            if after.file is None:
                raise InputError("flat_after", "is a part of the frames", remedy="name a file, as for flat")
            later = _opened(after, "flat_after", images, counts)
            flat_after, more, clipped = _mean_flat(after, later, counts, dark, images.saturation)
            bad |= clipped
            exposures += more
            notes["flat_after"] = f"{after.file}, {later.frames} frames"
    if own is not None and images.flat_after is not None:
        raise InputError("flat_after", "goes with a flat from a file", remedy="take it out")
    dark_noise = None if dark_stack is None else pair_noise(dark_stack)
    gain = _gain(images, stack, part, dark, dark_noise, notes, remarks)
    variance = None if dark_noise is None else gain**2 * dark_noise[0]
    notes["dark_noise"] = (
        "Poisson"
        if variance is None
        else f"variance of {variance:.4g} photons^2 per exposure, from pairs of dark frames"
    )
    if flat is not None:
        if not float(np.median(flat + dark)) > 0:
            raise InputError(
                "flat", "holds no light in more than half of its pixels", value=float(np.median(flat + dark)),
                allowed="> 0 counts", remedy="give frames of the beam without a jet",
            )  # fmt: skip
        dead = ~(flat > 0) | (~(flat_after > 0) if flat_after is not None else False)
        if dead.mean() > 0.5:
            raise InputError(
                "dark", "is at or over the flat in more than half of the pixels", value=float(np.median(dark)),
                allowed=f"under the flat, whose median is {np.median(flat + dark):.4g}",
                remedy="give raw flat and dark of the same exposure",
            )  # fmt: skip
        bad |= dead
    if images.bad_pixels is not None:
        mask = open_stack(images.bad_pixels, "bad_pixels", images.folder, transpose=images.transpose)
        if (mask.rows, mask.columns) != shape:
            raise InputError(
                "bad_pixels", "has another shape than the frames", value=(mask.rows, mask.columns), allowed=str(shape)
            )
        bad |= mask.read(0, 1)[0] != 0
    shared = (
        source.rows is not None and source.columns is None
        if source.rows is not None or own is not None
        else stack.rows == 1
    )
    return Fields(
        dark, variance, flat, flat_after, own, exposures, gain, bad, notes, tuple(remarks), shared and counts.rows > 1
    )


def photons_frame(
    images: Images, fields: Fields, summed: FrameSum, pixel: float, blur: float, moment: float = 0.5
) -> "tuple[Frame, dict[str, float]]":
    """Photons of one frame (or of a sum of frames), ready to fit.

    Parameters
    ----------
    images, fields
    summed : FrameSum
        Of one frame or many.
    pixel, blur : float
        m.
    moment : float
        Between flat (0) and flat_after (1).

    Returns
    -------
    frame : Frame
    facts : dict
        Numbers of masked and saturated pixels, extra noise of the flats (v), photons per pixel.

    Raises
    ------
    InputError
        For saturated pixels over a thousandth of the frame, or dark counts over the counts.
    """
    from spinline.xray.frame.blocks import Frame

    exposures = summed.exposures.astype(np.float64)
    seen = exposures > 0
    if (
        images.gain == 1
        and summed.frames == 1
        and 0 < summed.highest[seen].max() <= 2
        and (summed.total % 1 != 0).any()
    ):
        raise InputError(
            "counts", "are no counts: at most 2, and not whole", value=float(summed.highest[seen].max()), allowed="raw counts",
            remedy="give the raw frames, not transmissions, nor their logarithm; or gain in photons per count",
        )  # fmt: skip
    saturated = summed.saturated(images.saturation, whole=True)
    if saturated.mean() > _MOST_SATURATED:
        raise InputError(
            "counts", f"{int(saturated.sum())} pixels ({100 * saturated.mean():.3g} %) are saturated",
            value=float(summed.highest.max()), allowed="up to 0.1 % of the frame, which are masked",
            remedy="expose for less time, or give saturation if this is no limit of the detector",
        )  # fmt: skip
    each = np.where(seen, summed.total / np.where(seen, exposures, 1.0), 0.0)  # counts of one exposure
    if float(np.median((each - fields.dark)[seen])) <= 0:
        dim = float(np.median(each[seen]))
        if not (each - fields.dark)[seen].sum() > 0:
            raise InputError(
                "dark", "is at or over the counts: no signal is left", value=float(np.median(fields.dark)),
                allowed=f"under the counts, whose median is {dim:.4g}", remedy="give raw counts with their dark",
            )  # fmt: skip
    piled = 0 if images.saturation is not None else summed.piled_up()
    bad = fields.bad | saturated | ~seen
    flat = _flat_of_frame(fields, each, bad, moment)
    bad |= ~(flat > 0)
    if bad.all():
        raise InputError("flat", "leaves no good pixel", remedy="check flat, dark and bad_pixels")
    ratio = (each - fields.dark) / np.where(bad, 1.0, flat)
    signal = fields.gain * exposures * np.where(bad, 1.0, flat)
    lone = lone_outliers(np.where(bad, np.nan, ratio), signal)
    bad |= lone
    mean_exposures = float(exposures[~bad].mean())
    extra = fields.flat_noise(images, mean_exposures, each.shape[0])
    variance = (
        fields.gain * fields.dark if fields.dark_variance is None else np.full_like(fields.dark, fields.dark_variance)
    )
    counts = fields.gain * summed.total - exposures * (fields.gain * fields.dark - variance)
    dark = np.broadcast_to(variance, counts.shape) * exposures
    highest = float(counts[~bad].max())
    if highest > _MOST_PHOTONS:
        raise InputError(
            "gain" if images.gain is not None else "counts", "makes more photons in a pixel than can be counted",
            value=f"{highest:.3g} photons", allowed=f"up to {_MOST_PHOTONS:g}",
            remedy="give raw counts, and gain in photons per count",
        )  # fmt: skip
    lowest = float(counts[~bad].min())
    if lowest < 0:  # read noise below its own shift: assume as much more of it
        counts, dark = counts - lowest, dark - lowest
    counts, signal, dark = (np.where(bad, 0.0, a / extra) for a in (counts, signal, dark))
    facts = {
        "bad_pixels": float(bad.sum()), "saturated_pixels": float(saturated.sum()), "outlying_pixels": float(lone.sum()),
        "flat_noise": extra, "photons": float(np.median(fields.gain * exposures[~bad] * flat[~bad])),
        "added_noise": max(-lowest, 0.0), "piled_up_pixels": float(piled), "highest_count": float(summed.highest[seen].max()),
    }  # fmt: skip
    return Frame(counts, signal, dark, ~bad, pixel, blur), facts


def lone_outliers(ratio: FloatArray, photons: FloatArray) -> BoolArray:
    """Pixels 8 standard deviations off the median of their neighbours along the row and along the column; NaN is no neighbour.

    Parameters
    ----------
    ratio : ndarray, shape (rows, columns)
        Transmission.
    photons : ndarray, shape (rows, columns)
        Photons that a transmission of 1 stands for.
    """
    from scipy.ndimage import median_filter

    level = np.nanmedian(ratio)
    filled = np.where(np.isfinite(ratio), ratio, level)
    lone = np.isfinite(ratio)
    for size in ((1, 5), (5, 1)):
        if ratio.shape[0] < 5 and size[0] > 1:
            continue
        middle = median_filter(filled, size=size, mode="nearest")
        noise = np.sqrt(np.maximum(middle, 0.02) * photons + 4.0)
        lone &= np.abs(filled - middle) * photons > 8.0 * noise + 0.02 * photons
    return np.asarray(lone)


def _flat_of_frame(fields: Fields, each: FloatArray, bad: BoolArray, moment: float) -> FloatArray:
    if fields.region is not None:
        above = np.where(bad, np.nan, each - fields.dark)
        part = np.full(each.shape, np.nan)
        part[_slices(fields.region)] = above[_slices(fields.region)]
        flat = _mean_part(part, fields.region)
        return np.broadcast_to(np.nan_to_num(flat), each.shape)
    assert fields.flat is not None
    if fields.flat_after is None:
        return fields.flat
    return (1.0 - moment) * fields.flat + moment * fields.flat_after


def _mean_part(part: FloatArray, region: Source) -> FloatArray:
    """Mean over what a region spans: columns alone give one level a row, rows alone one a column, both one for all."""
    seen = np.isfinite(part)
    filled = np.where(seen, part, 0.0)
    axis = (0, 1) if region.rows and region.columns else (1 if region.columns else 0)
    count = seen.sum(axis=axis, keepdims=True)
    mean: FloatArray = filled.sum(axis=axis, keepdims=True) / np.maximum(count, 1)
    return mean


def _dark(images: Images, counts: Stack, notes: dict[str, str], remarks: list[str]) -> tuple[FloatArray, Stack | None]:
    shape = (counts.rows, counts.columns)
    source = images.dark
    if source is None:
        remarks.append("no dark is given: 0 is taken; 0.1 % of the flat in dark counts shifts the fraction by 0.004")
        notes["dark"] = "none given, taken as 0"
        return np.zeros(shape), None
    if source.level is not None:
        notes["dark"] = f"{source.level:g} counts, given"
        return np.full(shape, source.level), None
    if source.file is None:
        _part(source, counts, "dark")
        total = sample_frames(counts)
        part = np.full(shape, np.nan)
        part[_slices(source)] = (total.total / np.maximum(total.exposures, 1))[_slices(source)]
        notes["dark"] = f"from the frames themselves, {_spoken(source)}"
        return np.broadcast_to(_mean_part(part, source), shape).copy(), None
    stack = _opened(source, "dark", images, counts)
    mean = _mean_of(source, stack, sum_frames(stack))
    notes["dark"] = f"{source.file}, {stack.frames} frames"
    level = np.broadcast_to(mean, shape).copy()
    if not np.isfinite(level).all():
        level[~np.isfinite(level)] = float(np.nanmedian(level))
    if (level < 0).any() and float(np.median(level)) < 0:
        raise InputError("dark", "is negative", value=float(np.median(level)), remedy="give raw frames")
    return np.maximum(level, 0.0), stack if stack.frames > 1 else None


def _mean_flat(
    source: Source, stack: Stack, counts: Stack, dark: FloatArray, saturation: float | None
) -> tuple[FloatArray, float, BoolArray]:
    """Flat above dark, exposures that each of its numbers is a mean of, and saturated pixels."""
    shape = (counts.rows, counts.columns)
    total = sum_frames(stack)
    mean = _mean_of(source, stack, total)
    clipped = np.zeros(shape, dtype=np.bool_)
    if total.total.shape == shape:
        clipped = total.saturated(saturation, whole=True)
        if clipped.mean() > _MOST_SATURATED:
            raise InputError(
                stack.key, f"{int(clipped.sum())} pixels are saturated", value=float(total.highest.max()),
                allowed="up to 0.1 % of the frame, which are masked", remedy="expose for less time",
            )  # fmt: skip
    flat = np.broadcast_to(mean, shape) - dark
    averaged = _pixels_in_mean(source, stack)
    return np.where(np.isfinite(flat), flat, 0.0), float(stack.frames * averaged), clipped


def _mean_of(source: Source, stack: Stack, total: FrameSum) -> FloatArray:
    seen = total.exposures > 0
    mean = np.where(seen, total.total / np.maximum(total.exposures, 1), np.nan)
    if source.rows is None and source.columns is None:
        return mean
    part = np.full(mean.shape, np.nan)
    part[_slices(source)] = mean[_slices(source)]
    return _mean_part(part, source)


def _pixels_in_mean(source: Source, stack: Stack) -> int:
    rows = 1 if source.rows is None else min(source.rows[1], stack.rows) - source.rows[0]
    columns = 1 if source.columns is None else min(source.columns[1], stack.columns) - source.columns[0]
    return rows * columns


def _opened(source: Source, key: str, images: Images, counts: Stack) -> Stack:
    assert source.file is not None
    whole = source.rows is None and source.columns is None
    one = source.file.lower().endswith((".tif", ".tiff", ".npy")) or ":" in source.file  # not a file of many arrays
    if whole and one and source.file == images.counts:
        raise InputError(
            key, "is the file of the frames with the jet", value=source.file,
            remedy=f"name the {key}'s own file, or a part of the frames, {{ columns = [first, last] }}",
        )  # fmt: skip
    stack = open_stack(source.file, key, images.folder, transpose=images.transpose)
    _part(source, stack, key)
    rows_fit = stack.rows in (1, counts.rows) or source.rows is not None
    columns_fit = stack.columns == counts.columns or source.columns is not None
    if not (rows_fit and columns_fit):
        turned = (stack.columns, stack.rows) == (counts.rows, counts.columns)
        raise InputError(
            key, "has another shape than the frames", value=(stack.rows, stack.columns),
            allowed=f"({counts.rows}, {counts.columns}), or one row of {counts.columns}",
            remedy=f"counts or {key} lies on its side: store both alike" if turned else "",
        )  # fmt: skip
    return stack


def _part(source: Source, stack: Stack, key: str) -> None:
    for name, span, size in (("rows", source.rows, stack.rows), ("columns", source.columns, stack.columns)):
        if span is not None and span[1] > size:
            raise InputError(f"{key}.{name}", "goes beyond the frame", value=list(span), allowed=f"0 to {size}")


def _slices(source: Source) -> tuple[slice, slice]:
    return slice(*source.rows) if source.rows else slice(None), slice(*source.columns) if source.columns else slice(
        None
    )


def _spoken(source: Source) -> str:
    parts = [
        f"{name} {span[0]} to {span[1]}" for name, span in (("rows", source.rows), ("columns", source.columns)) if span
    ]
    return ", ".join(parts)


def _gain(
    images: Images,
    stack: Stack,
    part: tuple[slice, slice],
    dark: FloatArray,
    dark_noise: tuple[float, float, int] | None,
    notes: dict[str, str],
    remarks: list[str],
) -> float:
    if images.gain is not None:
        notes["gain"] = f"{images.gain:g} photons per count, given"
        return images.gain
    fitting = dark if dark.shape == (stack.rows, stack.columns) else float(np.median(dark))
    noise = pair_noise(stack, part, fitting)
    if noise is None:
        raise InputError(
            "gain", "is missing, and one flat frame does not tell it",
            remedy="give gain in photons per count (1 for a photon counter), or a stack of flat frames",
        )  # fmt: skip
    if not noise[1] > 0:
        raise InputError(
            "dark",
            "is at or over the flat",
            value=float(np.median(dark)),
            remedy="give raw flat and dark of the same exposure",
        )
    read = 0.0 if dark_noise is None else dark_noise[0]
    signal = noise[0] - read
    if not signal > 0:
        raise InputError(
            "gain", "is missing, and the flats scatter no more than the dark",
            remedy="give gain in photons per count",
        )  # fmt: skip
    gain = noise[1] / signal
    std = gain * np.sqrt(2.0 / noise[2])
    notes["gain"] = f"{gain:.4g} +/- {std:.2g} photons per count, from differences of flat frames"
    remarks.append(f"gain = {notes['gain']}: give it if it is known")
    return float(gain)
