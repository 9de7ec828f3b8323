"""Frames added up, streamed: what is a measurement in them, and what is not.

A frame, or a row of it, that holds one number throughout is none: software that loses frames writes zeros in their place. In
frames bright enough that chance does not do that, they are left out and counted. A pixel that is negative in whole numbers,
or not a number, is invalid in that frame; one at the highest number of its type in every frame, with dark neighbours, is marked
by the detector, not bright, and so is one at the highest or second highest number of whole numbers of 31 or 32 bits, in
whatever type the frames are stored. A zero where most frames are lit is a part of a frame that was lost. Two frames that are
the same to the last bit are one, copied.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.errors import InputError
from spinline.images.formats.base import Array
from spinline.images.stacks import Stack
from spinline.xray.frame.strips import Bands

__all__ = ["FrameSum", "listed", "one_frame", "sample_frames", "sum_frames", "without"]

_PILE_FROM = 100.0  # counts; below, a few values are all there are
_BRIGHT = 5.0  # counts over the lowest, a median over the frame: from here on no row is of one number by chance
_WIDE = 16  # pixels of a row that is judged
_LOOKED_AT = 5  # frames that say how bright a stack is
_CHECKED = ("counts", "flat", "flat_after", "dark", "transmission", "absorbance")
_LIT = 50.0  # counts: no pixel that has so many is at 0 by chance
_MARKS = (
    2.0**31 - 2,
    2.0**31 - 1,
    2.0**31,
    2.0**32 - 2,
    2.0**32 - 1,
    2.0**32,
)  # the last of each as 32-bit floats keep it
_NO_COUNT = 1e15  # fill values: more than can be counted
_FEW = 4  # values below 0: marks; more are noise about a dark that was taken off
_MOST_MARKED = 0.2  # of a frame


@dataclass(frozen=True, eq=False)
class FrameSum:
    """A stack, summed.

    Attributes
    ----------
    total : ndarray, shape (rows, columns)
        Sum over frames; what is no measurement left out.
    exposures : ndarray of int, shape (rows, columns)
        Frames in each sum.
    highest : ndarray, shape (rows, columns)
        The largest number in any frame.
    frames : int
        Frames read so far.
    lost, copies, torn : tuple of int
        Frames that hold one number throughout, and copies of the frame before: both left out; and those of which rows are
        left out.
    marked : ndarray of bool, shape (rows, columns)
        Pixels that the detector marks as invalid.
    odd : tuple of int
        Frames taken out again, see `without`.
    strips : ndarray, shape (frames, bands, bins)
        Of frames in the sum, whose numbers are `kept`; see `Bands`.
    kept : tuple of int
    """

    total: FloatArray
    exposures: NDArray[np.int64]
    highest: FloatArray
    frames: int
    lost: tuple[int, ...] = ()
    copies: tuple[int, ...] = ()
    torn: tuple[int, ...] = ()
    marked: BoolArray = field(default_factory=lambda: np.zeros((0, 0), dtype=np.bool_))
    odd: tuple[int, ...] = ()
    strips: Array = field(default_factory=lambda: np.zeros((0, 0, 0)))
    kept: tuple[int, ...] = ()

    @property
    def used(self) -> int:
        """Frames in the sum."""
        return self.frames - len(self.lost) - len(self.copies) - len(self.odd)

    def saturated(self, level: float | None, whole: bool) -> BoolArray:
        """Pixels at or over the level in any frame; if not given, those that pile up at a power of two less one."""
        marked = self.marked if self.marked.size else np.zeros(self.highest.shape, dtype=np.bool_)
        if level is not None:
            return np.asarray((self.highest >= level) & ~marked)
        highest = np.where(marked, -np.inf, self.highest)
        top = float(highest.max())
        if not whole or top < 255 or np.log2(top + 1.0) % 1.0 != 0.0:
            return np.zeros(self.highest.shape, dtype=np.bool_)
        clipped = highest == top
        beside = int((highest == top - 1.0).sum())
        return clipped if clipped.sum() > 3 * beside + 4 else np.zeros(clipped.shape, dtype=np.bool_)

    def piled_up(self) -> int:
        """Pixels that hold exactly the highest number, where more of them do than under it: a detector that clips, anywhere."""
        top = float(self.highest.max())
        if not top >= _PILE_FROM:
            return 0
        equal = int((self.highest == top).sum())
        under = int(((self.highest < top) & (self.highest >= top - max(np.sqrt(top), 1.0))).sum())
        return equal if equal > max(0.01 * self.highest.size, 8.0) and equal > 3 * under else 0

    def remarks(self, stack: Stack) -> list[str]:
        """What was left out, in words."""
        said = list(stack.account.remarks)
        gone = len([i for i in stack.account.missing if i >= 0])
        if gone:
            said.append(f"{stack.key}: {gone} of {stack.reader.shape[0]} frames were never written and are left out")
        for which, words in (
            (self.lost, "hold one number throughout (dropped frames) and are left out"),
            (self.copies, "are copies of the frame before and are left out"),
            (self.torn, "have rows of one number throughout (torn frames), or patches of zeros, which are left out"),
        ):
            if which:
                said.append(f"{stack.key}: {len(which)} of {self.frames} frames {words}: {listed(which)}")
        return said


def listed(which: tuple[int, ...]) -> str:
    """Numbers of frames in words, the first dozen of them."""
    return ", ".join(map(str, which[:12])) + (", ..." if len(which) > 12 else "")


@dataclass(frozen=True, eq=False)
class _Piece:
    """Sum, number, maximum, lost frames and strips of one piece."""

    stop: int
    total: Array
    seen: Array
    high: Array
    lost: tuple[int, ...]
    copies: tuple[int, ...]
    torn: tuple[int, ...]
    kept: tuple[int, ...]
    strips: Array


def sum_frames(
    stack: Stack,
    *,
    begun: FrameSum | None = None,
    pause: Callable[[FrameSum], None] | None = None,
    threads: int = 2,
) -> FrameSum:
    """Sum of all frames, streamed; exact for whole numbers up to 2^53.

    Parameters
    ----------
    stack : Stack
    begun : FrameSum, optional
        Where an interrupted sum stopped: at a multiple of ``stack.at_once``.
    pause : callable, optional
        Called after each piece with the sum so far (whose arrays change afterwards: copy what is kept).
    threads : int
        Pieces that are read and added up at one time.

    Returns
    -------
    FrameSum
        The same to the last bit whether it was interrupted or not.

    Raises
    ------
    InputError
        For a stack without a single frame that holds a measurement, or one that cannot be read.
    """
    shape = (stack.rows, stack.columns)
    if begun is None:
        begun = FrameSum(np.zeros(shape), np.zeros(shape, dtype=np.int64), np.full(shape, -np.inf), 0)
    total, exposures, highest = begun.total.copy(), begun.exposures.copy(), begun.highest.copy()
    lost, copies, torn, kept = begun.lost, begun.copies, begun.torn, begun.kept
    bands = stack.bands
    strips = np.empty((len(bands.kept(0, stack.frames)), len(bands.starts), bands.bins), dtype=np.float32)
    strips[: len(kept)] = begun.strips[: len(kept)].reshape(len(kept), *strips.shape[1:])
    bright = _bright(stack)
    lasts: dict[int, Array] = {}

    def one(start: int) -> _Piece:
        before = lasts.pop(start, None) if start else None
        if start and before is None and bright.noisy:
            before = stack.read(start - 1, start)[0]
        stop = min(start + stack.at_once, stack.frames)
        block = stack.read(start, stop)
        if not stack.reader.threads:
            lasts[stop] = block[-1].copy()
        return _piece(stack, block, start, bright, before, bands)

    starts = range(begun.frames, stack.frames, stack.at_once)
    so_far = begun
    with ThreadPoolExecutor(threads if stack.reader.threads else 1) as pool:
        for piece in _in_order(pool, one, starts, threads + 1):
            np.add(total, piece.total, out=total)
            np.add(exposures, piece.seen, out=exposures)
            np.maximum(highest, piece.high, out=highest)
            lost, copies, torn = lost + piece.lost, copies + piece.copies, torn + piece.torn
            strips[len(kept) : len(kept) + len(piece.kept)] = piece.strips
            kept += piece.kept
            so_far = FrameSum(
                total, exposures, highest, piece.stop, lost, copies, torn, strips=strips[: len(kept)], kept=kept
            )
            if pause is not None:
                pause(so_far)
    return _finished(stack, so_far)


def _finished(stack: Stack, so_far: FrameSum) -> FrameSum:
    """The sum with the pixels that the detector marks taken out."""
    if so_far.used < 1:
        raise InputError(
            stack.key,
            "holds no frame that is a measurement: every one holds one number throughout",
            value=stack.name,
            remedy="was the shutter open, was anything written?",
        )
    marked = _marked(stack.dtype, so_far)
    exposures = np.where(marked, 0, so_far.exposures)
    total = np.where(marked, 0.0, so_far.total)
    return replace(so_far, total=total, exposures=exposures, marked=marked)


def _marked(dtype: np.dtype[Any], so_far: FrameSum) -> BoolArray:
    """Pixels that are no measurement in any frame: below 0, or at the highest number of the type amid dark neighbours."""
    seen = so_far.exposures > 0
    negative = seen & (so_far.highest < 0)
    never = ~seen | (negative if _are_marks(so_far.highest[negative]) else False)
    limit = float(np.iinfo(dtype).max) if dtype.kind in "ui" else np.inf
    stuck = seen & (so_far.total >= so_far.highest * np.maximum(so_far.exposures, 1) * (1.0 - 1e-12))
    for _ in range(_FEW):  # a detector may have more than one mark
        rest = stuck & ~never
        top = float(so_far.highest[seen & ~never].max(initial=-np.inf))
        at_top = rest & (so_far.highest == top)
        if not at_top.any() or not (top >= limit or _may_mark(top, so_far.frames)):
            break
        sure = top >= limit and dtype.itemsize >= 4
        if not sure and (not _stands_alone(at_top, so_far.highest, seen & ~never) or at_top.mean() > _MOST_MARKED):
            break
        never = never | at_top
    return np.asarray(never)


def _are_marks(below: FloatArray) -> bool:
    """Whether numbers below 0 are marks: few values, and whole."""
    values = np.unique(below)
    return values.size <= _FEW


def _may_mark(top: float, frames: int) -> bool:
    """Whether a number is a type's highest or second highest, as other types keep it."""
    least = 254.0 if frames > 1 else 4094.0  # one frame may hold such a number by chance
    return top >= least and any(float(np.log2(top + more)).is_integer() for more in (0.0, 1.0, 2.0))


def _stands_alone(at_top: BoolArray, highest: FloatArray, seen: BoolArray) -> bool:
    """Whether the pixels around those at the top are dark."""
    from scipy.ndimage import binary_dilation

    around = binary_dilation(at_top, np.ones((3, 3), dtype=np.bool_)) & ~at_top & seen
    return bool(around.any()) and float(np.median(highest[around])) < 0.5 * float(highest[at_top].max())


def _in_order(pool: ThreadPoolExecutor, work: Callable[[int], _Piece], items: range, ahead: int) -> Iterator[_Piece]:
    """Results in order, with at most `ahead` of them under way."""
    todo = iter(items)
    waiting: list[Future[_Piece]] = [pool.submit(work, item) for item in islice(todo, ahead)]
    while waiting:
        yield waiting.pop(0).result()
        waiting.extend(pool.submit(work, item) for item in islice(todo, 1))


@dataclass(frozen=True)
class _Look:
    """Whether frames are so bright that no row is of one number by chance; and so noisy that no two are alike by chance.

    `below`: what is under 0 is a mark, no noise; `lit`: pixels that are not at 0 by chance; `most`: from here on a
    float is a fill value.
    """

    bright: bool
    noisy: bool
    below: bool = True
    lit: BoolArray | None = None
    most: float = _NO_COUNT


def _bright(stack: Stack) -> _Look:
    """What a few frames say of all."""
    if stack.key not in _CHECKED or stack.columns < _WIDE:
        return _Look(False, False)
    picked = np.unique(np.linspace(0, stack.frames - 1, _LOOKED_AT).astype(int)).tolist()
    levels, first, alike = [], None, True
    below: list[FloatArray] = []
    lit = np.zeros((stack.rows, stack.columns), dtype=np.int8)
    for i in picked:
        frame = np.asarray(stack.read(i, i + 1)[0], dtype=np.float64)
        valid = frame[np.isfinite(frame) & (frame >= 0)]
        levels.append(float(np.median(valid) - valid.min()) if valid.size and np.ptp(valid) > 0 else 0.0)
        below.append(np.unique(frame[frame < 0])[: 2 * _FEW])
        lit += frame > _LIT
        alike &= first is None or bool(np.array_equal(first, frame, equal_nan=True))
        first = frame if first is None else first
    bright = max(levels) > (0.0 if stack.key in ("transmission", "absorbance") else _BRIGHT)
    most = lit > len(picked) // 2 if len(picked) > 2 else np.zeros(lit.shape, dtype=np.bool_)
    return _Look(
        bright,
        bright and not alike,
        _are_marks(np.concatenate(below)),
        most if most.any() else None,
        max(_NO_COUNT, 1e3 * max(levels)),
    )


def _no_measurement(block: Array, look: _Look) -> BoolArray | None:
    """Numbers of a piece of bright frames that are marks, or zeros where light was lost."""
    invalid = None
    kind = block.dtype.kind
    low = block.min()  # NaN where there is one: then all is looked at
    if kind in "if" and look.below and not low >= 0:
        under = block < 0
        if kind == "f":
            under &= block == np.floor(block)
        invalid = under if under.any() else None
    if block.dtype.itemsize >= 4 and not block.max() < _MARKS[0]:
        high = np.isin(block, np.asarray(_MARKS))
        high |= block >= look.most if kind == "f" else block >= np.iinfo(block.dtype).max
        invalid = high if invalid is None else invalid | high
    if look.lit is not None and not low > 0:
        gone = (block == 0) & look.lit
        if gone.any():
            invalid = gone if invalid is None else invalid | gone
    return invalid


def _piece(
    stack: Stack, block: Array, start: int, look: _Look, before: Array | None, bands: Bands | None = None
) -> _Piece:
    """One piece of a stack, looked through and added up."""
    stop = start + block.shape[0]
    lost: tuple[int, ...] = ()
    copies: tuple[int, ...] = ()
    torn: tuple[int, ...] = ()
    rows = None
    if look.bright:
        lost, copies, torn, rows = _looked_through(block, start, before, look.noisy)
    invalid = None
    if block.dtype.kind == "f":
        finite = np.isfinite(block)
        if not finite.all():
            empty = ~finite.any(axis=(1, 2))
            if empty.any() and not look.bright:
                raise InputError(
                    stack.key,
                    "holds a frame without a finite number",
                    value=f"frame {start + int(np.argmax(empty))}",
                    remedy="leave that frame out",
                )
            invalid = ~finite
    marks = _no_measurement(block, look) if look.bright else None
    if marks is not None:
        if look.lit is not None:
            patches = ((block == 0) & look.lit).sum(axis=(1, 2)) >= _WIDE
            more = start + np.flatnonzero(patches)
            torn = tuple(sorted({*torn, *more.tolist()} - {*lost, *copies}))
        invalid = marks if invalid is None else invalid | marks
    if rows is not None and rows.any():
        out = np.broadcast_to(rows[:, :, None], block.shape)
        invalid = out if invalid is None else invalid | out
    kept = () if bands is None else tuple(i for i in bands.kept(start, stop) if i not in {*lost, *copies})
    at = [i - start for i in kept]
    strips: Array = np.zeros(0) if bands is None else bands.strips(block, at, None if invalid is None else ~invalid)
    told = lost, copies, torn, kept, strips
    if invalid is None:
        return _Piece(stop, _summed(block), np.asarray(stop - start), block.max(axis=0), *told)
    good = ~invalid
    seen = good.sum(axis=0)
    lowest = -np.inf if block.dtype.kind == "f" else np.iinfo(block.dtype).min
    high = np.max(block, axis=0, where=good, initial=lowest).astype(np.float64)
    high[seen == 0] = -np.inf
    return _Piece(stop, _summed(block, good), seen, high, *told)


def _summed(block: Array, good: BoolArray | None = None) -> Array:
    """Sum over frames in the narrowest type that holds it."""
    where: Any = True if good is None else good
    if block.dtype.kind == "f":
        return np.asarray(block.sum(axis=0, dtype=np.float64, where=where))
    most = int(np.iinfo(block.dtype).max) * block.shape[0]
    if block.dtype.kind == "u" and most < 2**32:
        return np.asarray(block.sum(axis=0, dtype=np.uint32, where=where))
    if most < 2**63:
        return np.asarray(block.sum(axis=0, dtype=np.int64, where=where))
    top = max(int(block.max()), -int(block.min())) * block.shape[0]
    return np.asarray(block.sum(axis=0, dtype=np.int64 if top < 2**63 else np.float64, where=where))


def _looked_through(
    block: Array, start: int, before: Array | None, noisy: bool
) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...], BoolArray]:
    """Frames that are lost, copied and torn, and the rows that are left out for it, shape (frames, rows)."""
    still = np.asarray(block[:, :, 0] == block[:, :, -1])  # most rows are told by two pixels
    rows = np.zeros(block.shape[:2], dtype=np.bool_)
    at = np.nonzero(still)
    if at[0].size:
        some = block[at]
        rows[at] = (some == some[:, :1]).all(axis=1)
    if block.dtype.kind == "f":
        rows |= ~np.isfinite(block).any(axis=2)
    lost = np.asarray(rows.all(axis=1))
    copies = np.zeros(block.shape[0], dtype=np.bool_)
    if noisy:
        middle = block.shape[1] // 2
        same = np.asarray(block[1:, middle] == block[:-1, middle]).all(axis=1)
        for i in (np.flatnonzero(same) + 1).tolist():
            copies[i] = not lost[i] and bool((block[i] == block[i - 1]).all())
        if before is not None and not lost[0]:
            copies[0] = bool((block[0] == before).all())
    always = np.asarray(rows[~lost].all(axis=0)) if (~lost).any() else np.zeros(block.shape[1], dtype=np.bool_)
    torn = (rows & ~always).any(axis=1) & ~copies & ~lost  # a row that is dead in every frame tears none
    rows[copies] = True
    first, second, third = (tuple((start + np.flatnonzero(which)).tolist()) for which in (lost, copies, torn))
    return first, second, third, rows


def one_frame(stack: Stack, index: int) -> FrameSum:
    """One frame, as a sum of one.

    Raises
    ------
    InputError
        For a frame that was lost: it holds one number throughout.
    """
    look = _Look(stack.key in _CHECKED and stack.columns >= _WIDE and stack.frames > 1, False)
    block = stack.read(index, index + 1)
    if look.bright and np.ptp(np.nan_to_num(np.asarray(block, dtype=np.float64), nan=0.0)) > 0.0:
        look = _Look(False, False)  # rows may be of one number where counts are few
    piece = _piece(stack, block, index, look, None)
    if piece.lost:
        raise InputError(stack.key, "holds a frame of one number throughout: it was lost", value=stack.source(index))
    exposures = np.broadcast_to(piece.seen, (stack.rows, stack.columns)).astype(np.int64)
    so_far = FrameSum(piece.total.astype(np.float64), exposures, np.asarray(piece.high, dtype=np.float64), 1)
    return _finished(stack, so_far)


def sample_frames(stack: Stack, most: int = 64) -> FrameSum:
    """Sum of up to `most` frames, spread over the stack."""
    if stack.frames <= most:
        return sum_frames(stack)
    look = _Look(_bright(stack).bright, False)
    picked = np.unique(np.linspace(0, stack.frames - 1, most).astype(int)).tolist()
    return _finished(stack, _of_some(stack, picked, look, replace(stack.bands, every=1)))


def without(stack: Stack, summed: FrameSum, odd: tuple[int, ...]) -> FrameSum:
    """A sum with some of its frames taken out again."""
    out = _of_some(stack, list(odd), replace(_bright(stack), noisy=False), None)
    good = ~summed.marked if summed.marked.size else True
    stay = [i not in odd for i in summed.kept]
    return replace(
        summed,
        total=summed.total - np.where(good, out.total, 0.0),
        exposures=summed.exposures - np.where(good, out.exposures, 0),
        odd=(*summed.odd, *odd),
        strips=summed.strips[stay],
        kept=tuple(i for i in summed.kept if i not in odd),
    )


def _of_some(stack: Stack, picked: list[int], look: _Look, bands: Bands | None) -> FrameSum:
    """Some frames, added up one by one."""
    shape = (stack.rows, stack.columns)
    total, exposures = np.zeros(shape), np.zeros(shape, dtype=np.int64)
    highest, parts = np.full(shape, -np.inf), []
    for i in picked:
        part = _piece(stack, stack.read(i, i + 1), i, look, None, bands)
        total += part.total
        exposures += part.seen
        np.maximum(highest, part.high, out=highest)
        parts.append(part)
    lost, copies, torn, kept = (tuple(j for p in parts for j in getattr(p, name)) for name in _NUMBERS)
    strips = np.concatenate([p.strips for p in parts]) if bands is not None else np.zeros((0, 0, 0))
    return FrameSum(total, exposures, highest, len(picked), lost, copies, torn, strips=strips, kept=kept)


_NUMBERS = ("lost", "copies", "torn", "kept")
