"""Flat, dark, bad pixels and gain of a set of images: what turns its counts into photons.

The gain, photons per count, is that given, or what the noise of the flats says (`noise`). A given one is held against that
noise: flats that scatter much less are means of several exposures, flats that scatter more hold noise that is not the
photons', and errors are widened by it.
"""

from dataclasses import dataclass, replace

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.images.noise import PairNoise, pair_noise
from spinline.images.odd_frames import without_light, without_shadow
from spinline.images.sources import opened, part_of, slices, spoken, stack_of
from spinline.images.stacks import Stack
from spinline.images.sums import FrameSum, sample_frames, sum_frames
from spinline.images.transmission import as_transmission
from spinline.scene.images_file import Images, Source
from spinline.xray.frame.response import linear

__all__ = ["Fields", "build_fields", "mean_part", "open_counts", "slices"]

_MOST_SATURATED = 1e-3  # share of the frame that is masked rather than refused
_AVERAGED = 2.5  # times less noise in the flats than their gain says: they are means
_ROUNDED, _MOST_GAIN = 1e-3, 1e9  # of the noise; photons per count
_EXCESS = 1.05  # more noise than the gain says, and by over 5 of its errors, is taken into the errors
_FEW_FRAMES = 16  # with the jet, that say how it looks
_COPY = 1e30  # exposures of a flat without noise


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
    remarks : tuple of str
    scatter : tuple of float
        Covariance of pixels 0, 1, 2, ... rows apart over the variance of their photons: (1,) where pixels share no light.
    excess : float
        Noise over that of photons, >= 1, where the gain is given and the flats say so.
    nonlinearity, level : float
        Share by which the detector falls short at the flat's level, and that level, counts above dark.
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
    scatter: tuple[float, ...] = (1.0,)
    excess: float = 1.0
    nonlinearity: float = 0.0
    level: float = 1.0

    def flat_noise(self, images: Images, exposures: float, rows: int) -> float:
        """How much more than Poisson a block of rows scatters for the noise of the flats: v."""
        together = (rows if images.method == "map" else images.block_rows) if self.shared else 1
        return 1.0 + together * (1.0 if self.region is not None else exposures) / self.flat_exposures


def open_counts(images: Images) -> Stack:
    """Stack of the frames with the jet."""
    key, source = images.source
    stack = stack_of(images, source, key, images.part)
    if key in ("transmission", "absorbance"):
        stack = as_transmission(stack)
    shape = stack.reader.shape
    if shape[-1] in (3, 4) and shape[0] > 4:
        raise InputError(
            key,
            "is a colour image, no counts",
            value=f"array of shape {shape}",
            remedy="give the detector's raw frames, (frame, z, x) or (z, x)",
        )
    if stack.columns < 8:
        raise InputError(
            key,
            "has fewer than 8 pixels across the jet",
            value=f"{stack.rows} x {stack.columns}",
            remedy="check transpose: a row runs across the jet",
        )
    for name in ("calibration_rows", "nozzle_rows"):
        rows = getattr(images, name)
        if rows is not None and rows[1] > stack.rows:
            raise InputError(name, "goes beyond the frame", value=list(rows), allowed=f"rows 0 to {stack.rows}")
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
    if images.flat is None:
        return _of_transmission(images, counts)
    notes: dict[str, str] = {}
    remarks: list[str] = []
    dark, dark_stack = _dark(images, counts, notes, remarks)
    shape = (counts.rows, counts.columns)
    bad = np.zeros(shape, dtype=np.bool_)
    source, own = images.flat, None
    flat = flat_after = None
    if source.file is None:
        part_of(source, counts, "flat")
        stack, part, exposures, own = counts, slices(source), float(_pixels_in_mean(source, counts)), source
        notes["flat"] = f"from the frames themselves, {spoken(source)}"
        if images.flat_after is not None:
            raise InputError("flat_after", "goes with a flat from a file", remedy="take it out")
    else:
        stack, part = opened(source, "flat", images, counts), slices(source)
        flat, exposures, stack = _mean_flat(source, stack, counts, dark, images, bad, remarks)
        notes["flat"] = f"{source.file}, {stack.frames} frames" + (
            f", {spoken(source)}" if source.rows or source.columns else ""
        )
        if images.flat_after is not None:
            flat_after, more, notes["flat_after"] = _after(images, counts, dark, bad, remarks)
            exposures += more
    dark_noise = None if dark_stack is None else pair_noise(dark_stack)
    gain, scatter, excess = _gain(images, stack, part, dark, dark_noise, notes, remarks)
    variance = None if dark_noise is None else gain**2 * dark_noise.variance
    notes["dark_noise"] = (
        "Poisson"
        if variance is None
        else f"variance of {variance:.4g} photons^2 per exposure, from pairs of dark frames"
    )
    if flat is not None:
        bad |= _unlit(flat, flat_after, dark)
    bad |= _bad_pixels(images, shape)
    shared = source.rows is not None and source.columns is None if source.rows is not None or own else stack.rows == 1
    fields = Fields(
        dark,
        variance,
        flat,
        flat_after,
        own,
        exposures,
        gain,
        bad,
        notes,
        tuple(remarks),
        shared and counts.rows > 1,
        scatter,
        excess,
    )
    return _linearised(images, fields)


def _of_transmission(images: Images, counts: Stack) -> Fields:
    """Fields of frames that are over their flat already: a flat of one, and i0 photons for a gain."""
    key, _ = images.source
    shape = (counts.rows, counts.columns)
    notes = {"flat": f"none: {key} is over it", "dark": "none, taken off already", "dark_noise": "Poisson"}
    remarks: list[str] = []
    scatter: tuple[float, ...] = (1.0,)
    if images.i0 is not None:
        gain = images.i0
        notes["gain"] = f"{gain:g} photons where the transmission is 1, given (i0)"
    else:
        found = pair_noise(counts) or _along_noise(counts)
        if found is None or not found.power > 0.0:
            raise InputError(
                "i0",
                f"is missing, and the {key} does not tell it: it has no noise",
                remedy="give i0, in photons per pixel",
            )
        gain, scatter = found.level / found.power, found.along
        notes["gain"] = f"{gain:.4g} photons where the transmission is 1, from the noise of the {key}"
        remarks.append(f"i0 = {notes['gain']}: give it if it is known")
    return Fields(
        np.zeros(shape),
        None,
        np.ones(shape),
        None,
        None,
        _COPY,
        gain,
        _bad_pixels(images, shape),
        notes,
        tuple(remarks),
        scatter=scatter,
    )


def _along_noise(counts: Stack) -> PairNoise | None:
    """Noise of one frame, from differences of neighbouring rows, in which a jet is nearly the same."""
    frame = np.asarray(counts.read(0, 1)[0], dtype=np.float64)
    if frame.shape[0] < 3:
        return None
    second = frame[2:] - 2.0 * frame[1:-1] + frame[:-2]
    good = np.isfinite(second)
    if good.sum() < 64:
        return None
    spread = 1.4826 * float(np.median(np.abs(second[good])))
    near = good & (np.abs(second) <= 6.0 * spread)
    variance = float((second[near] ** 2).mean()) / 6.0
    return PairNoise(variance, float(np.nanmean(frame)), int(near.sum()), variance, float(np.sqrt(2.0 / near.sum())))


def _after(
    images: Images, counts: Stack, dark: FloatArray, bad: BoolArray, remarks: list[str]
) -> tuple[FloatArray, float, str]:
    """The flat after the jet, its exposures, and what it is."""
    after = images.flat_after
    assert after is not None
    if after.file is None:
        raise InputError("flat_after", "is a part of the frames", remedy="name a file, as for flat")
    later = opened(after, "flat_after", images, counts)
    flat, exposures, later = _mean_flat(after, later, counts, dark, images, bad, remarks)
    return flat, exposures, f"{after.file}, {later.frames} frames"


def _unlit(flat: FloatArray, flat_after: FloatArray | None, dark: FloatArray) -> BoolArray:
    """Pixels without light; refused where these are most."""
    if not float(np.median(flat + dark)) > 0:
        raise InputError(
            "flat",
            "holds no light in more than half of its pixels",
            value=float(np.median(flat + dark)),
            allowed="> 0 counts",
            remedy="give frames of the beam without a jet",
        )
    dead = ~(flat > 0) | (~(flat_after > 0) if flat_after is not None else False)
    if dead.mean() > 0.5:
        raise InputError(
            "dark",
            "is at or over the flat in more than half of the pixels",
            value=float(np.median(dark)),
            allowed=f"under the flat, whose median is {np.median(flat + dark):.4g}",
            remedy="give raw flat and dark of the same exposure",
        )
    return np.asarray(dead)


def _bad_pixels(images: Images, shape: tuple[int, int]) -> BoolArray:
    """The mask that is given; none where there is none."""
    if images.bad_pixels is None:
        return np.zeros(shape, dtype=np.bool_)
    mask = stack_of(images, images.bad_pixels, "bad_pixels")
    if (mask.rows, mask.columns) != shape:
        raise InputError(
            "bad_pixels", "has another shape than the frames", value=(mask.rows, mask.columns), allowed=str(shape)
        )
    return np.asarray(mask.read(0, 1)[0] != 0)


def _linearised(images: Images, fields: Fields) -> Fields:
    """Fields of a detector whose response is not straight: flats as light."""
    e = 0.0 if images.linearity is None else images.linearity.value
    if images.linearity is None or fields.flat is None:
        return fields
    lit = fields.flat[~fields.bad & (fields.flat > 0)]
    level = float(np.median(lit)) if lit.size else 1.0
    words = f"{images.linearity.text}: response short by this at the flat's level, {level:.4g} counts above dark"
    after = fields.flat_after
    return replace(
        fields,
        flat=linear(fields.flat, e, level),
        flat_after=None if after is None else linear(after, e, level),
        nonlinearity=e,
        level=level,
        notes={**fields.notes, "linearity": words},
    )


def mean_part(part: FloatArray, region: Source) -> FloatArray:
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
        part_of(source, counts, "dark")
        total = sample_frames(counts)
        part = np.full(shape, np.nan)
        part[slices(source)] = (total.total / np.maximum(total.exposures, 1))[slices(source)]
        notes["dark"] = f"from the frames themselves, {spoken(source)}"
        return np.broadcast_to(mean_part(part, source), shape).copy(), None
    stack = opened(source, "dark", images, counts)
    total = sum_frames(stack)
    remarks += total.remarks(stack)
    total, said = without_light(stack, total)
    stack = stack.without(total.odd)
    remarks += said
    mean = _mean_of(source, stack, total)
    notes["dark"] = f"{source.file}, {stack.frames} frames"
    level = np.broadcast_to(mean, shape).copy()
    if not np.isfinite(level).all():
        level[~np.isfinite(level)] = float(np.nanmedian(level))
    if (level < 0).any() and float(np.median(level)) < 0:
        raise InputError("dark", "is negative", value=float(np.median(level)), remedy="give raw frames")
    return np.maximum(level, 0.0), stack if stack.frames > 1 else None


def _mean_flat(
    source: Source, stack: Stack, counts: Stack, dark: FloatArray, images: Images, bad: BoolArray, remarks: list[str]
) -> tuple[FloatArray, float, Stack]:
    """Flat above dark, exposures that each of its numbers is a mean of, and the stack without frames that show the jet.

    Saturated and marked pixels go into `bad`.
    """
    shape = (counts.rows, counts.columns)
    total = sum_frames(stack)
    remarks += total.remarks(stack)
    if total.used > 1 and stack.rows == counts.rows and counts.frames > 1:
        total, said = without_shadow(stack, total, dark, sample_frames(counts, _FEW_FRAMES), images.gain)
        remarks += said
    mean = _mean_of(source, stack, total)
    if total.total.shape == shape:
        clipped = total.saturated(images.saturation, whole=True)
        if clipped.mean() > _MOST_SATURATED:
            raise InputError(
                stack.key,
                f"{int(clipped.sum())} pixels are saturated",
                value=float(total.highest.max()),
                allowed="up to 0.1 % of the frame, which are masked",
                remedy="expose for less time",
            )
        bad |= clipped | total.marked
    flat = np.broadcast_to(mean, shape) - dark
    averaged = _pixels_in_mean(source, stack) * images.flat_frames
    return np.where(np.isfinite(flat), flat, 0.0), float(total.used * averaged), stack.without(total.odd)


def _mean_of(source: Source, stack: Stack, total: FrameSum) -> FloatArray:
    seen = total.exposures > 0
    mean = np.where(seen, total.total / np.maximum(total.exposures, 1), np.nan)
    if source.rows is None and source.columns is None:
        return mean
    part = np.full(mean.shape, np.nan)
    part[slices(source)] = mean[slices(source)]
    return mean_part(part, source)


def _pixels_in_mean(source: Source, stack: Stack) -> int:
    rows = 1 if source.rows is None else min(source.rows[1], stack.rows) - source.rows[0]
    columns = 1 if source.columns is None else min(source.columns[1], stack.columns) - source.columns[0]
    return rows * columns


def _gain(
    images: Images,
    stack: Stack,
    part: tuple[slice, slice],
    dark: FloatArray,
    dark_noise: PairNoise | None,
    notes: dict[str, str],
    remarks: list[str],
) -> tuple[float, tuple[float, ...], float]:
    """Photons per count, scatter of pixels, and noise over that of photons."""
    fitting = dark if dark.shape == (stack.rows, stack.columns) else float(np.median(dark))
    noise = pair_noise(stack, part, fitting)
    read = (0.0, 0.0) if dark_noise is None else (dark_noise.power, dark_noise.variance)
    if images.gain is not None:
        notes["gain"] = f"{images.gain:g} photons per count, given"
        if noise is None or not noise.level > 0.0 or not noise.power > read[0]:
            return images.gain, (1.0,), 1.0
        return (images.gain, *_against_gain(images, noise, read, notes, remarks))
    if noise is None:
        raise InputError(
            "gain",
            "is missing, and one flat frame does not tell it",
            remedy="give gain in photons per count (1 for a photon counter), or a stack of flat frames",
        )
    if not noise.level > 0:
        raise InputError(
            "dark",
            "is at or over the flat",
            value=float(np.median(dark)),
            remedy="give raw flat and dark of the same exposure",
        )
    signal = noise.power - read[0]
    if not signal > 0:
        raise InputError(
            "gain",
            "is missing, and the flats scatter no more than the dark",
            remedy="give gain in photons per count",
        )
    own = images.flat_frames if images.flat is not None and images.flat.file is not None else 1
    gain = noise.level / signal / own
    if gain > _MOST_GAIN:
        raise InputError(
            "gain",
            "is missing, and the flats do not tell it: most of their pixels do not scatter at all",
            value=f"{gain:.3g} photons per count",
            remedy="they are rounded (to 8 bits?), or copies: give the frames as the detector wrote them, or gain",
        )
    std = gain * float(np.hypot(np.sqrt(2.0 / noise.samples), np.nan_to_num(noise.power_std)))
    scatter = _of_signal(noise, read, signal)
    notes["gain"] = f"{gain:.4g} +/- {std:.2g} photons per count, from differences of flat frames"
    remarks.append(f"gain = {notes['gain']}: give it if it is known")
    return float(gain), _shared_light(scatter, notes, remarks), 1.0


def _against_gain(
    images: Images, noise: PairNoise, read: tuple[float, float], notes: dict[str, str], remarks: list[str]
) -> tuple[tuple[float, ...], float]:
    """Scatter and excess of the flats' noise against the gain that is given."""
    assert images.gain is not None
    own = images.flat_frames if images.flat is not None and images.flat.file is not None else 1
    signal = noise.power - read[0]
    ratio = signal * images.gain * own / noise.level
    std = ratio * float(np.hypot(np.sqrt(2.0 / noise.samples), np.nan_to_num(noise.power_std)))
    scatter = _of_signal(noise, read, signal)
    notes["flat_scatter"] = f"{ratio:.4g} +/- {std:.2g} of that of photons"
    if ratio < _ROUNDED:
        remarks.append(
            f"the flats hardly scatter ({ratio:.2g} of what gain = {images.gain:g} says): rounded, to 8 bits maybe, or copies; "
            "then the noise of the fit is that of rounding: give frames as the detector wrote them"
        )
        return (1.0,), 1.0
    if ratio < 1.0 / _AVERAGED and own == 1:
        remarks.append(
            f"the flats scatter {1.0 / ratio:.3g} times less than gain = {images.gain:g} says: if each is a mean of several "
            f"exposures, give flat_frames = {round(1.0 / ratio)}; otherwise the gain is too small"
        )
        return _shared_light(scatter, notes, remarks), 1.0
    if ratio > _EXCESS and ratio - 1.0 > 5.0 * std:
        remarks.append(
            f"the flats scatter {ratio:.3g} times more than photons at gain = {images.gain:g}: the errors are widened by "
            f"{np.sqrt(ratio):.3g}; a gain of {images.gain / ratio:.3g} would explain it"
        )
        return _shared_light(scatter, notes, remarks), ratio
    return _shared_light(scatter, notes, remarks), 1.0


def _of_signal(noise: PairNoise, read: tuple[float, float], signal: float) -> tuple[float, ...]:
    """Covariance along rows of what is not read noise, over the photons' variance."""
    if len(noise.along) < 2:
        return (1.0,)
    first, *rest = (value * noise.power for value in noise.along)
    return (first - read[1]) / signal, *(value / signal for value in rest)


def _shared_light(scatter: tuple[float, ...], notes: dict[str, str], remarks: list[str]) -> tuple[float, ...]:
    """The scatter, with words where pixels share light; (1,) where they do not."""
    if scatter[0] > 0.97:
        return (1.0,)
    notes["shared_light"] = f"a pixel scatters {scatter[0]:.3g} times as much as its photons: neighbours share light"
    return (max(scatter[0], 1e-3), *scatter[1:])
