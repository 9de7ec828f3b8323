"""Dormand-Prince 5(4) with error control, compiled; a step ends where an element enters or a node lands."""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._chain_kernels import explicit_rates
from spinline.jetprofile.spun._codes import (
    ARR,
    AZZ,
    BROKEN,
    COLUMNS,
    DONE,
    FLOW,
    FULL,
    LONGEST,
    MX,
    OUTFLOW,
    PAUSED,
    RADIUS,
    STALLED,
    TURN,
    VX,
    WORK,
    IntArray,
    X,
)
from spinline.jetprofile.spun._collector_kernels import first_touch
from spinline.jetprofile.spun._land_kernels import leave, remove_landed, touch
from spinline.jetprofile.spun._nozzle_kernels import split
from spinline.jetprofile.spun._refine_kernels import refine

__all__ = ["march_explicit"]

_A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_E = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@njit(cache=True, error_model="numpy")
def _error(n: int, h: float, y: FloatArray, new: FloatArray, d: FloatArray, tol: float, reach: float) -> float:
    """Largest error of a step over what is allowed: position per reach of the jet, velocity per its greatest, conformation
    relative.
    """
    fast = 1e-300
    for i in range(n + 1):
        for c in range(3):
            fast = max(fast, abs(y[i, VX + c]))
    worst = 0.0
    for i in range(n):
        for c in range(COLUMNS):
            e = 0.0
            for s in range(7):
                e += _E[s] * d[s, i, c]
            e = abs(h * e)
            if c < VX:
                e /= reach
            elif c < AZZ:
                e /= fast
            elif c <= ARR or MX <= c < MX + 3:
                e /= max(abs(y[i, c]), abs(new[i, c]), 1.0 if c > ARR else 1e-3)
            elif abs(y[i, c]) > 0.0:
                e /= abs(y[i, c])
            if not e < 1e300:
                return math.inf
            worst = max(worst, e)
    return worst / tol


@njit(cache=True, error_model="numpy")
def march_explicit(
    t: float,
    end: float,
    n: int,
    h: float,
    fixed: float,
    tol: float,
    reach: float,
    most: int,
    clock: FloatArray,
    y: FloatArray,
    held: IntArray,
    marks: FloatArray,
    landed: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
) -> tuple[int, float, int, float]:
    """March to `end`, `most` steps at most; status, time, number of elements, next step.

    `clock`: volume of an element, number of elements that have entered, time of the first entry, label of the front,
    rows in `landed`, steps taken, steps refused. `fixed` > 0 takes equal steps (for orders); `tol` then does nothing.
    """
    cap = y.shape[0]
    d = np.zeros((7, cap, COLUMNS))
    w, f = np.zeros((WORK, cap)), np.zeros((cap, 3))
    trial, new = np.zeros((cap, COLUMNS)), np.zeros((cap, COLUMNS))
    fresh = True
    begun = clock[5] + clock[6]
    while t < end:
        if clock[5] + clock[6] - begun >= most:
            return PAUSED, t, n, h
        if n + 2 >= cap or int(clock[4]) + n >= landed.shape[0]:
            return FULL, t, n, h
        entry = clock[2] + clock[1] * clock[0] / p[FLOW]
        stop = min(end, entry)
        if fresh and not explicit_rates(t, n, held, y, p, k, tables, w, f, d[0]):
            return BROKEN, t, n, h
        fresh = False
        step = min(h if fixed <= 0.0 else fixed, stop - t)
        if fixed <= 0.0 and step < stop - t < 2.0 * step:
            step = 0.5 * (stop - t)
        if fixed > 0.0 and step > 0.999 * (stop - t):
            step = stop - t
        cut = False
        soonest = 1e-9 * step  # who touches before lies there already, and is held
        while True:
            good = _try(t, step, n, held, y, p, k, tables, w, f, d, trial, new)
            ratio = _error(n, step, y, new, d, tol, reach) if good else math.inf
            if fixed > 0.0 and good:
                ratio = 0.5
            if ratio <= 1.0:
                who, when = first_touch(n, step, y, new, held, p, k)
                if who < 0 or when > step * (1.0 - 1e-9) or step <= soonest:
                    break
                step, cut = max(when, soonest), True
                continue
            clock[6] += 1
            step *= max(0.2, 0.9 * ratio**-0.2) if ratio < 1e300 else 0.2
            if not step > 1e-8 * min(clock[0] / p[FLOW], end):
                return STALLED, t, n, h
        clock[5] += 1
        reached = t + step >= stop * (1.0 - 1e-15)
        t = stop if reached else t + step
        for i in range(n + 1):
            for c in range(COLUMNS):
                y[i, c], d[0, i, c] = new[i, c], d[6, i, c]
        if fixed <= 0.0:
            grow = step * min(5.0, 0.9 * max(ratio, 1e-10) ** -0.2)
            h = max(h, grow) if reached or who >= 0 or cut else grow
        if who >= 0:
            touch(t, who, n, y, held, marks, p, k)
            n, clock[3], rows = remove_landed(n, clock[3], y, held, marks, landed, int(clock[4]), False)
            clock[4] = rows
            fresh = True
        if p[OUTFLOW] > 0.0 and y[1, X] > p[OUTFLOW]:
            leave(t, n, y, held, marks, p)
            n, clock[3], rows = remove_landed(n, clock[3], y, held, marks, landed, int(clock[4]), True)
            clock[4] = rows
            fresh = True
        if p[LONGEST] > 0.0 or p[TURN] > 0.0:
            parts = refine(n, clock[0], y, held, marks, p)
            fresh = fresh or parts > n
            n = parts
        if t >= entry:
            split(n, clock[0], p[FLOW] / (math.pi * p[RADIUS] ** 2), y, p, k)
            held[n + 1] = held[n] = 0
            n += 1
            clock[1] += 1
            fresh = True
    return DONE, t, n, h


@njit(cache=True, error_model="numpy")
def _try(
    t: float,
    h: float,
    n: int,
    held: IntArray,
    y: FloatArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    f: FloatArray,
    d: FloatArray,
    trial: FloatArray,
    new: FloatArray,
) -> bool:
    """One step of the scheme into `new`; False where a stage has no state."""
    for s in range(1, 7):
        for i in range(n + 1):
            for c in range(COLUMNS):
                total = 0.0
                for q in range(s):
                    total += _A[s, q] * d[q, i, c]
                trial[i, c] = y[i, c] + h * total
        if not explicit_rates(t + _C[s] * h, n, held, trial, p, k, tables, w, f, d[s]):
            return False
    for i in range(n + 1):
        for c in range(COLUMNS):
            new[i, c] = trial[i, c]
    return True
