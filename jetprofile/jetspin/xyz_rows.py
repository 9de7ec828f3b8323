"""Rows of XYZ text to numbers: fixed columns, every byte checked, several times as fast as a general reader.

A row is ``C`` and seven blanks, then three numbers of width 10 with 5 decimals; no blank need separate
them. Each number is read as an integer of 1e-5, so that it equals ``float(text)`` to the last bit. Some thousand
rows at a time are turned on their side, and every column of characters is one array.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["DAMAGED", "OVERFLOW", "UNREADABLE", "parse_rows"]

UNREADABLE, OVERFLOW, DAMAGED = 1, 2, 4

_ROW = 38  # bytes of a row without its end
_BLOCK = 8192  # rows at a time, so that their columns stay in the cache
_HEAD = np.frombuffer(b"C       ", np.uint8)
_HEAD_WORD = _HEAD.view(np.uint64)  # the same in one word
_END_WORDS = {_ROW + len(end): np.frombuffer(end, f"u{len(end)}") for end in (b"\n", b"\r\n")}
_WIDTH, _LEADING = 10, 4
_UNIT = 1e5

Bytes = NDArray[np.uint8]
Flags = NDArray[np.bool_]


def parse_rows(
    buffer: Bytes,
    offsets: NDArray[np.int64],
    rows: NDArray[np.int64],
    strides: NDArray[np.int64],
    out: NDArray[np.float64],
    status: Bytes,
    chains: NDArray[np.int64],
) -> int:
    """Read the rows of frames into `out` (3, n), leaving out the padding; the number of rows kept.

    `strides` is the length of a line with its end, or 0 where the lines of a frame differ. `status` gets the
    flags of every row. `chains` (m, 4) gets, for every frame: first row in `out`, number of rows, whether the
    nozzle row was met, and number of rows behind it that are not padding.
    """
    used = 0
    begin = 0
    count = rows.cumsum()
    while begin < len(rows):
        before = count[begin - 1] if begin else 0
        stop = max(begin + 1, int(count.searchsorted(before + _BLOCK, side="right")))
        frames = offsets[begin:stop], rows[begin:stop], strides[begin:stop]
        values, flags = _even_numbers(buffer, *frames) or _numbers(buffer, *_lines(buffer, *frames))
        used += _keep(values, flags, rows[begin:stop], used, (out, status, chains[begin:stop]))
        begin = stop
    return used


def _even_numbers(
    buffer: Bytes, offsets: NDArray[np.int64], rows: NDArray[np.int64], strides: NDArray[np.int64]
) -> tuple[NDArray[np.float64], Bytes] | None:
    """`_numbers` of whole frames of one shape at even distances, as the program writes them; None of others."""
    count, stride, first = int(rows[0]), int(strides[0]), int(offsets[0])
    steps = offsets[1:] - offsets[:-1]
    even = stride > 0 and int(offsets[-1]) + count * stride <= len(buffer)
    if not even or not _alike(rows) or not _alike(strides) or not _alike(steps):
        return None
    shape, apart = (len(rows), count), (int(steps[0]) if len(steps) else 0, stride)
    bad = np.ndarray(shape, np.uint64, buffer, first, apart) != _HEAD_WORD
    end = _END_WORDS[stride]
    bad |= np.ndarray(shape, end.dtype, buffer, first + _ROW, apart) != end
    fields = np.ndarray((_WIDTH, 3, *shape), np.uint8, buffer, first + len(_HEAD), (1, _WIDTH, *apart))
    return _valued(fields.reshape(_WIDTH, 3, -1), bad.ravel() * np.uint8(DAMAGED))


def _alike(numbers: NDArray[np.int64]) -> bool:
    """Whether all are the same; by their bytes, which of few takes a fifth of the time."""
    return numbers.tobytes() == numbers[:1].tobytes() * len(numbers)


def _lines(
    buffer: Bytes, offsets: NDArray[np.int64], rows: NDArray[np.int64], strides: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Where every row begins, and where the next one does."""
    first = np.cumsum(rows) - rows
    number = np.arange(int(rows.sum())) - np.repeat(first, rows)
    stride = np.repeat(strides, rows)
    start = np.repeat(offsets, rows) + stride * number
    end = np.minimum(start + stride, len(buffer))
    for frame in np.flatnonzero(strides == 0):
        own = slice(int(first[frame]), int(first[frame] + rows[frame]))
        end[own] = _line_ends(buffer, int(offsets[frame]), int(rows[frame]))
        start[own] = np.concatenate([offsets[frame : frame + 1], end[own][:-1]])
    return start, end


def _line_ends(buffer: Bytes, offset: int, count: int) -> NDArray[np.int64]:
    """Ends of so many lines; those beyond the text end with it."""
    width = 64 * count
    while True:
        found = offset + 1 + np.flatnonzero(buffer[offset : offset + width] == ord("\n"))[:count]
        if len(found) == count or offset + width >= len(buffer):
            return np.pad(found, (0, count - len(found)), constant_values=len(buffer))
        width *= 2


def _numbers(buffer: Bytes, start: NDArray[np.int64], end: NDArray[np.int64]) -> tuple[NDArray[np.float64], Bytes]:
    """Values (3, n) of rows and their flags."""
    width = end - start
    short = width < _ROW
    columns = _columns(buffer, np.where(short, 0, start)) if len(buffer) >= _ROW else np.zeros((_ROW, len(start)), "u1")
    last = buffer[np.maximum(end, 1) - 1] == ord("\n")
    bad = (columns[: len(_HEAD)] != _HEAD[:, None]).any(axis=0)
    returned = buffer[np.minimum(start + _ROW, len(buffer) - 1)] == ord("\r")
    bad |= (width > _ROW + 1) & ~((width == _ROW + 2) & returned)
    unfinished = (end == len(buffer)) & (width == _ROW)  # the last line of the text, whole but for its end
    flags = (bad | ~(last | unfinished)) * np.uint8(DAMAGED)
    fields = columns[len(_HEAD) :].reshape(3, _WIDTH, -1).swapaxes(0, 1)
    values, flags = _valued(np.ascontiguousarray(fields), flags)
    if short.any():
        flags[short] = UNREADABLE | DAMAGED
        values[:, short] = np.nan
    return values, flags


def _columns(buffer: Bytes, start: NDArray[np.int64]) -> Bytes:
    """Characters (38, n) of the rows that begin there."""
    windows = np.lib.stride_tricks.sliding_window_view(buffer, _ROW)
    return np.ascontiguousarray(windows[start].T)


def _valued(fields: Bytes, flags: Bytes) -> tuple[NDArray[np.float64], Bytes]:
    """Values (3, n) of fields by their characters (10, 3, n), NaN where they have none, and flags with those of the fields."""
    digits = fields - np.uint8(ord("0"))  # 10 and more for what is no digit
    sound: Flags = digits <= 9
    sound[_LEADING] = fields[_LEADING] == ord(".")
    leading, minus, blank = sound[:_LEADING], fields[:_LEADING] == ord("-"), fields[:_LEADING] == ord(" ")
    digits[:_LEADING] *= leading.view(np.uint8)
    behind = leading[1:] | blank[:-1]  # a sign or a blank stands behind blanks alone
    leading |= blank
    leading |= minus
    leading[1:] &= behind
    # two digits, then four, of those before the point and behind it, in the narrowest integers that hold them
    fours = digits.reshape(2, _WIDTH // 2, 3, -1)[:, :4]
    pairs = 10 * fours[:, ::2] + fours[:, 1::2]
    four = np.multiply(pairs[:, 0], 100, dtype=np.uint16) + pairs[:, 1]
    value = np.multiply(four[0], 100_000, dtype=np.int32)
    value += np.multiply(four[1], 10, dtype=np.int32)
    value += digits[-1]
    values = np.negative(value, out=value, where=minus.any(axis=0)) / _UNIT
    if not sound.all():
        faults = np.logical_not(sound.all(axis=0)).view(np.uint8)
        faults[(fields == ord("*")).all(axis=0)] = OVERFLOW
        flags |= np.bitwise_or.reduce(faults, axis=0)
        values[:, (flags & (UNREADABLE | OVERFLOW)) != 0] = np.nan
    return values, flags


def _keep(
    values: NDArray[np.float64],
    flags: Bytes,
    rows: NDArray[np.int64],
    used: int,
    results: tuple[NDArray[np.float64], Bytes, NDArray[np.int64]],
) -> int:
    """Put rows up to the nozzle's, which is zero, behind those that are `used`; the number of rows kept."""
    out, status, chains = results
    count, faulty = len(flags), flags.any()
    after = rows.cumsum()
    first = after - rows
    zero = np.ones(count + 1, np.bool_)  # one more behind the last
    np.logical_not(values.any(axis=0), out=zero[:-1])
    nozzles = zero.nonzero()[0]
    nozzle = nozzles[nozzles.searchsorted(first)]  # the first one in the frame or behind it
    stop = np.minimum(nozzle + 1, after)
    length = stop - first
    kept = np.arange(count) < stop.repeat(rows)
    total = int(length.sum())
    values.compress(kept, axis=1, out=out[:, used : used + total])
    status[used : used + total] = flags[kept] if faulty else 0
    chains[:, 0] = used + length.cumsum() - length
    chains[:, 1] = length
    chains[:, 2] = met = nozzle < after
    chains[:, 3] = 0
    if faulty or count - total != len(nozzles) - 1 - np.count_nonzero(met):  # not all that is left out is zero
        padding = zero[:-1] > flags  # zeros without a fault
        before = np.concatenate([[0], np.cumsum(~(kept | padding))])
        chains[:, 3] = before[after] - before[first]
    return total
