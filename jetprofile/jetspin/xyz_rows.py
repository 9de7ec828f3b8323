"""Rows of XYZ text to numbers: fixed columns, several hundred MB/s, every byte checked.

A row is ``C`` and seven blanks, then three numbers of width 10 with 5 decimals; no blank need separate
them. Each number is read as an integer of 1e-5, so that it equals ``float(text)`` to the last bit.
"""

from typing import Any

import numpy as np

from spinline.base.kernels import njit

__all__ = ["DAMAGED", "OVERFLOW", "UNREADABLE", "parse_rows"]

UNREADABLE, OVERFLOW, DAMAGED = 1, 2, 4


@njit(cache=True, nogil=True)
def _number(buf: Any, at: int) -> Any:
    """Value times 1e5 of the field at `at`, and whether it was read (0), unreadable (1), overflowed (2)."""
    value = 0
    negative = False
    begun = False
    for k in range(4):
        c = buf[at + k]
        if c >= 48 and c <= 57:
            value = value * 10 + (c - 48)
            begun = True
        elif c == 45 and not begun:
            negative = True
            begun = True
        elif c == 32 and not begun:
            pass
        else:
            if c == 42:
                stars = True
                for m in range(10):
                    stars = stars and buf[at + m] == 42
                if stars:
                    return 0, 2
            return 0, 1
    if buf[at + 4] != 46:
        return 0, 1
    for k in range(5, 10):
        c = buf[at + k]
        if c < 48 or c > 57:
            return 0, 1
        value = value * 10 + (c - 48)
    return (-value if negative else value), 0


@njit(cache=True, nogil=True)
def parse_rows(buf: Any, offsets: Any, rows: Any, strides: Any, out: Any, status: Any, chains: Any) -> int:
    """Read the rows of frames into `out` (3, n), leaving out the padding.

    `strides` is the length of a line with its end, or 0 where the lines of a frame differ. `status` gets the
    flags of every row. `chains` (m, 4) gets, for every frame: first row in `out`, number of rows, whether the
    nozzle row was met, and number of rows behind it that are not padding.
    """
    end = len(buf)
    w = 0
    for f in range(len(offsets)):
        first = w
        met = False
        tail = 0
        at = offsets[f]
        for _ in range(rows[f]):
            stop = at
            if strides[f] > 0:
                stop = at + strides[f]
                if stop > end:
                    stop = end
            else:
                while stop < end and buf[stop] != 10:
                    stop += 1
                if stop < end:
                    stop += 1
            width = stop - at
            flag = 0
            x = 0
            y = 0
            z = 0
            if width < 38:
                flag = 5
            else:
                if buf[at] != 67 or buf[stop - 1] != 10:
                    flag = 4
                for k in range(1, 8):
                    if buf[at + k] != 32:
                        flag = 4
                if width > 39 and not (width == 40 and buf[at + 38] == 13):
                    flag = 4
                x, fx = _number(buf, at + 8)
                y, fy = _number(buf, at + 18)
                z, fz = _number(buf, at + 28)
                flag = flag | fx | fy | fz
                if stop == end and width == 38 and flag == 4 and buf[at] == 67:
                    flag = 0
            at = stop
            zero = (flag & 3) == 0 and x == 0 and y == 0 and z == 0
            if met:
                if not zero or flag != 0:
                    tail += 1
                continue
            status[w] = flag
            if flag & 3:
                out[0, w] = np.nan
                out[1, w] = np.nan
                out[2, w] = np.nan
            else:
                out[0, w] = x / 1e5
                out[1, w] = y / 1e5
                out[2, w] = z / 1e5
            w += 1
            if zero:
                met = True
        chains[f, 0] = first
        chains[f, 1] = w - first
        chains[f, 2] = 1 if met else 0
        chains[f, 3] = tail
    return w
