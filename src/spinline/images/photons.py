"""From counts on disk to photons: flat and dark, gain, bad pixels, and the noise that each of them adds.

    photons = gain counts,    var(photons) = photons above dark + v_d

The likelihood knows Poisson counts alone, so every noise is put into their form. Read noise: dark counts of variance v_d
(from pairs of dark frames) are shifted to a mean of v_d, which leaves the signal as it is. Flats of finite exposure: counts
N against a flat of F photons scatter by ``(1 + N/F)`` more than Poisson, so all photons are divided by that number, v: they
then carry the information that is really there, and no error bar is too small for want of flats. A flat of one row
serves all rows: summed over B of them its noise adds up, and v = 1 + B N/F.
"""

from typing import TYPE_CHECKING

import numpy as np

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.images.flat_and_dark import Fields, mean_part, slices
from spinline.images.sums import FrameSum
from spinline.scene.images_file import Images
from spinline.xray.frame.hot_pixels import dark_share
from spinline.xray.frame.outliers import lone_outliers
from spinline.xray.frame.response import linear

if TYPE_CHECKING:
    from spinline.xray.frame.blocks import Frame

__all__ = ["dark_words", "photons_frame"]

_MOST_PHOTONS = 1e15  # differences of single photons are lost in a float beyond
_SAME_DARK = 0.2  # of its hot pixels
_SAME_EXPOSURE = 0.1  # of the beam's level: drift, no other exposure
_SURELY, _MOST_DEAD = 50.0, 0.2  # counts, and share of the frame
_MOST_SATURATED = 1e-3  # share of the frame that is masked rather than refused


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
    _require_counts(images, summed, seen)
    saturated = _saturated(images, summed)
    each = np.where(seen, summed.total / np.where(seen, exposures, 1.0), 0.0)  # counts of one exposure
    _require_light(each, fields.dark, seen)
    dead = seen & (summed.total == 0.0) & (exposures * fields.dark > _SURELY)  # 0 where the dark alone is more
    dead &= dead.mean() < _MOST_DEAD
    light = linear(each - fields.dark, fields.nonlinearity, fields.level)
    bad = fields.bad | saturated | ~seen | dead
    flat = _flat_of_frame(fields, light, bad, moment)
    bad |= ~(flat > 0)
    if bad.all():
        raise InputError("flat", "leaves no good pixel", remedy="check flat, dark and bad_pixels")
    signal = fields.gain * exposures * np.where(bad, 1.0, flat)
    lone = lone_outliers(np.where(bad, np.nan, light / np.where(bad, 1.0, flat)), signal)
    bad |= lone
    level = _level(light[~bad] / flat[~bad])
    extra = fields.excess * fields.flat_noise(images, level * float(exposures[~bad].mean()), each.shape[0])
    variance = (
        fields.gain * fields.dark if fields.dark_variance is None else np.full_like(fields.dark, fields.dark_variance)
    )
    counts = exposures * (fields.gain * light + variance)
    if fields.nonlinearity == 0.0:  # whole numbers stay whole
        counts = fields.gain * summed.total - exposures * (fields.gain * fields.dark - variance)
    dark = np.broadcast_to(variance, counts.shape) * exposures
    highest = float(counts[~bad].max())
    if highest > _MOST_PHOTONS:
        raise InputError(
            "gain" if images.gain is not None else "counts",
            "makes more photons in a pixel than can be counted",
            value=f"{highest:.3g} photons",
            allowed=f"up to {_MOST_PHOTONS:g}",
            remedy="give raw counts, and gain in photons per count",
        )
    lowest = float(counts[~bad].min())
    if lowest < 0:  # read noise below its own shift: assume as much more of it
        counts, dark = counts - lowest, dark - lowest
    counts, signal, dark = (np.where(bad, 0.0, a / extra) for a in (counts, signal, dark))
    piled = 0 if images.saturation is not None else summed.piled_up()
    marked = float(((summed.marked if summed.marked.size else False) | dead).sum())
    facts = {
        "bad_pixels": float(bad.sum()),
        "saturated_pixels": float(saturated.sum()),
        "outlying_pixels": float(lone.sum()),
        "invalid_pixels": marked,
        "level": level,
        "flat_noise": extra,
        "photons": float(np.median(fields.gain * exposures[~bad] * flat[~bad])),
        "added_noise": max(-lowest, 0.0),
        "piled_up_pixels": float(piled),
        "highest_count": float(summed.highest[seen].max()),
    }
    return Frame(counts, signal, dark, ~bad, pixel, blur, scatter=fields.scatter), facts


def dark_words(fields: Fields, summed: FrameSum) -> list[str]:
    """Words where the hot pixels of the dark are not in counts and flat as they are in raw frames of its exposure."""
    raw = {"counts": summed.total / np.maximum(summed.exposures, 1)}
    if fields.flat is not None and fields.nonlinearity == 0.0:
        flat = fields.flat + fields.dark
        one = (
            np.allclose(flat, part, rtol=1e-9) for part in (flat[:1], flat[:, :1])
        )  # a row or column that serves all
        raw |= {} if any(one) else {"flat": flat}
    said = []
    for key, image in raw.items():
        told = dark_share(image, fields.dark, ~fields.bad & (summed.exposures > 0))
        if told is None or abs(told[0] - 1.0) < max(_SAME_DARK, 5.0 * told[1]):
            continue
        said.append(
            f"the dark's hot pixels stand out of the {key} by {told[0]:.2g} +/- {told[1]:.1g} of what they do in the dark: "
            "it is taken off already (0), or of another exposure. Give raw frames with the dark of their exposure; dark = 0 "
            "where it is taken off counts and flat alike"
        )
    return said


def _level(ratio: FloatArray) -> float:
    """Exposure of a frame over that of a flat, where it is another one: the air's transmission; else 1."""
    level = float(np.quantile(ratio, 0.8))
    return level if level > 0.0 and abs(level - 1.0) > _SAME_EXPOSURE else 1.0


def _require_counts(images: Images, summed: FrameSum, seen: BoolArray) -> None:
    """Refuse what is no count: transmissions, or their logarithm."""
    if not seen.any():
        raise InputError(
            images.source[0], "hold no valid pixel", remedy="check the file: all of it is marked as invalid, or empty"
        )
    if images.counts is None and not images.positions:
        return
    if images.gain == 1 and 0 < summed.highest[seen].max() <= 2 and (summed.total % 1 != 0).any():
        raise InputError(
            "counts",
            "are no counts: at most 2, and not whole",
            value=float(summed.highest[seen].max()),
            allowed="raw counts",
            remedy="give the raw frames; or name them transmission, or absorbance for their logarithm, in place of counts",
        )


def _saturated(images: Images, summed: FrameSum) -> BoolArray:
    """Saturated pixels; refused where they are many."""
    saturated = summed.saturated(images.saturation, whole=images.counts is not None)
    if saturated.mean() > _MOST_SATURATED:
        raise InputError(
            "counts",
            f"{int(saturated.sum())} pixels ({100 * saturated.mean():.3g} %) are saturated",
            value=float(summed.highest.max()),
            allowed="up to 0.1 % of the frame, which are masked",
            remedy="expose for less time, or give saturation if this is no limit of the detector",
        )
    return saturated


def _require_light(each: FloatArray, dark: FloatArray, seen: BoolArray) -> None:
    """Refuse counts that are no more than the dark."""
    if float(np.median((each - dark)[seen])) > 0 or (each - dark)[seen].sum() > 0:
        return
    raise InputError(
        "dark",
        "is at or over the counts: no signal is left",
        value=float(np.median(dark)),
        allowed=f"under the counts, whose median is {float(np.median(each[seen])):.4g}",
        remedy="give raw counts with their dark",
    )


def _flat_of_frame(fields: Fields, each: FloatArray, bad: BoolArray, moment: float) -> FloatArray:
    if fields.region is not None:
        above = np.where(bad, np.nan, each - fields.dark)
        part = np.full(each.shape, np.nan)
        part[slices(fields.region)] = above[slices(fields.region)]
        flat = mean_part(part, fields.region)
        return np.broadcast_to(np.nan_to_num(flat), each.shape)
    assert fields.flat is not None
    if fields.flat_after is None:
        return fields.flat
    return (1.0 - moment) * fields.flat + moment * fields.flat_after
