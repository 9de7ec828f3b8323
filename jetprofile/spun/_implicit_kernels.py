"""ARS(2,2,2), compiled: viscosity, bending moment and charge implicit and L-stable, all else explicit.

gamma = 1 - 1/sqrt 2 and delta = 1 - 1/(2 gamma) (Ascher, Ruuth, Spiteri 1997). Steps are a fraction of the time a
longitudinal wave needs for an element, and end where an element enters or a node lands.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._bend_kernels import bent_stage
from spinline.jetprofile.spun._chain_kernels import end_value, explicit_rates, geometry, inlet_radius
from spinline.jetprofile.spun._charge_kernels import balance
from spinline.jetprofile.spun._codes import (
    AREA,
    ARR,
    AZZ,
    BALANCE,
    BENDING,
    BROKEN,
    CHARGE,
    COLUMNS,
    CURRENT,
    DONE,
    DRYING,
    END,
    FLOW,
    FROZEN,
    FULL,
    G_HERE,
    GIVEN_CURRENT,
    IMAGE,
    LAW,
    LENGTH,
    LONGEST,
    MX,
    NO_BENDING,
    OUTFLOW,
    PAUSED,
    RADIUS,
    RATE,
    RHO,
    SETTLE,
    SETTLED,
    SOLVENT,
    SOLVENT_HERE,
    STALLED,
    THETA_HERE,
    TRACTION,
    TURN,
    TX,
    VOLUME,
    VX,
    WORK,
    IntArray,
    X,
)
from spinline.jetprofile.spun._collector_kernels import first_touch
from spinline.jetprofile.spun._dry_kernels import drying_pace
from spinline.jetprofile.spun._land_kernels import leave, remove_landed, touch
from spinline.jetprofile.spun._law_kernels import stiffness
from spinline.jetprofile.spun._nozzle_kernels import nozzle, smooth, split
from spinline.jetprofile.spun._refine_kernels import refine

__all__ = ["march_implicit"]

_G = 1.0 - 1.0 / math.sqrt(2.0)
_D = 1.0 - 1.0 / (2.0 * _G)
SPLINTER = 1e-7  # of the time an element takes to enter, or of the step tried first: no step is smaller
WEARY = 200.0  # refusals in excess of half a step each


@njit(cache=True, error_model="numpy")
def _longest(n: int, y: FloatArray, held: IntArray, p: FloatArray, k: IntArray, w: FloatArray, cfl: float) -> float:
    """Step over which no longitudinal wave crosses more than `cfl` of an element, nor a conformation relaxes more, nor what
    lands falls through the collector (a jet of soft liquid lands faster than its waves run).
    """
    best = math.inf
    for i in range(n):
        if held[i] == 1 and held[i + 1] == 0:
            closing = 0.0
            for c in range(3):
                closing += (y[i + 1, VX + c] - y[i, VX + c]) * w[TX + c, i]
            if closing > 0.0:
                best = min(best, 0.7 / cfl * w[LENGTH, i] / closing)
        speed = math.sqrt(max(w[G_HERE, i] * stiffness(k[LAW], y[i, AZZ], y[i, ARR], p), 0.0) / p[RHO])
        best = min(best, w[THETA_HERE, i])
        best = min(best, w[LENGTH, i] / max(speed, abs(w[RATE, i]) * w[LENGTH, i], 1e-300))
    return cfl * best


@njit(cache=True, error_model="numpy")
def _viscous(n: int, gh: float, y: FloatArray, held: IntArray, p: FloatArray, w: FloatArray, rate: FloatArray) -> None:
    """Velocities under the solvent's viscosity over a stage: block tridiagonal, 3 x 3; writes dv/dt to `rate`."""
    upper, right = np.zeros((n, 3, 3)), np.zeros((n, 3))
    pivot, side = np.zeros((3, 3)), np.zeros(3)
    before = 0.0
    for i in range(n):
        mass = 0.5 * p[RHO] * (y[i, VOLUME] + (y[i - 1, VOLUME] if i > 0 else 0.0))
        here = gh * 3.0 * w[SOLVENT_HERE, i] * w[AREA, i] / w[LENGTH, i]
        if held[i] == 1 and w[RATE, i] < 0.0:
            here = 0.0
        if held[i] == 1:
            for a in range(3):
                right[i, a] = y[i, VX + a]
            before = here
            continue
        for a in range(3):
            side[a] = mass * y[i, VX + a]
            for b in range(3):
                pivot[a, b] = here * w[TX + a, i] * w[TX + b, i]
                if i > 0:
                    pivot[a, b] += before * w[TX + a, i - 1] * w[TX + b, i - 1]
            pivot[a, a] += mass
        if i == n - 1:
            along = 0.0
            for b in range(3):
                along += w[TX + b, i] * y[n, VX + b]
            for a in range(3):
                side[a] += here * w[TX + a, i] * along
        if i > 0:
            for a in range(3):
                low = before * w[TX + a, i - 1]
                for b in range(3):
                    side[a] += low * w[TX + b, i - 1] * right[i - 1, b]
                    for d in range(3):
                        pivot[a, b] -= low * w[TX + d, i - 1] * upper[i - 1, d, b]
        inverse = _inverse(pivot)
        for a in range(3):
            right[i, a] = 0.0
            for b in range(3):
                right[i, a] += inverse[a, b] * side[b]
                upper[i, a, b] = 0.0
                if i < n - 1:
                    for d in range(3):
                        upper[i, a, b] += inverse[a, d] * here * w[TX + d, i] * w[TX + b, i]
        before = here
    for i in range(n - 2, -1, -1):
        if held[i] == 0:
            for a in range(3):
                for b in range(3):
                    right[i, a] += upper[i, a, b] * right[i + 1, b]
    for i in range(n):
        for a in range(3):
            rate[i, a] = (right[i, a] - y[i, VX + a]) / gh
            y[i, VX + a] = right[i, a]


@njit(cache=True, error_model="numpy")
def _inverse(m: FloatArray) -> FloatArray:
    """Inverse of a 3 x 3 matrix."""
    out = np.empty((3, 3))
    out[0, 0] = m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]
    out[1, 0] = m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]
    out[2, 0] = m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]
    det = m[0, 0] * out[0, 0] + m[0, 1] * out[1, 0] + m[0, 2] * out[2, 0]
    out[0, 1] = m[0, 2] * m[2, 1] - m[0, 1] * m[2, 2]
    out[1, 1] = m[0, 0] * m[2, 2] - m[0, 2] * m[2, 0]
    out[2, 1] = m[0, 1] * m[2, 0] - m[0, 0] * m[2, 1]
    out[0, 2] = m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]
    out[1, 2] = m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2]
    out[2, 2] = m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
    value: FloatArray = out / det
    return value


@njit(cache=True, error_model="numpy")
def _stage(
    t: float,
    n: int,
    gh: float,
    clock: FloatArray,
    y: FloatArray,
    held: IntArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    push: FloatArray,
    flow: FloatArray,
) -> bool:
    """The implicit part of a stage at time t: solvent and bending, then charge."""
    p[SETTLED], _ = smooth(t, p[SETTLE])
    if not geometry(n, y, p, k, w):
        return False
    radius = inlet_radius(n, y, p, w)
    nozzle(t, n, p[FLOW] / (math.pi * radius * radius), y, p)
    if not geometry(n, y, p, k, w):
        return False
    if k[BENDING] != NO_BENDING:
        if not bent_stage(n, gh, y, held, p, k, w, push):
            return False
    elif p[SOLVENT] > 0.0:
        _viscous(n, gh, y, held, p, w, push)
    if k[BALANCE] != FROZEN:
        front = 0.0
        if k[END] == TRACTION:
            total = p[CURRENT] if k[BALANCE] == GIVEN_CURRENT else clock[7]
            front = end_value(y[0, X], tables, 2) * total
        earthed = held[0] == 1 and k[IMAGE] == 1
        clock[7] = balance(t, n, gh, front, earthed, y, p, k, tables, w, flow)
        if not abs(clock[7]) < 1e30:
            return False
        clock[8] = clock[7]
        for i in range(n):  # what leaves at the front: what came in less what stays
            clock[8] -= flow[i]
    return True


@njit(cache=True, error_model="numpy")
def _step(
    t: float,
    h: float,
    n: int,
    clock: FloatArray,
    y: FloatArray,
    held: IntArray,
    p: FloatArray,
    k: IntArray,
    tables: FloatArray,
    w: FloatArray,
    f: FloatArray,
    d: FloatArray,
    mid: FloatArray,
    new: FloatArray,
    push: FloatArray,
    flow: FloatArray,
) -> bool:
    """One step from `y` into `new`; d[0] holds the explicit rates at the start."""
    for i in range(n + 1):
        for c in range(COLUMNS):
            mid[i, c] = y[i, c] + h * _G * d[0, i, c]
    if not _stage(t + _G * h, n, _G * h, clock, mid, held, p, k, tables, w, push, flow):
        return False
    clock[11], clock[12] = clock[7], clock[8]
    if not explicit_rates(t + _G * h, n, held, mid, p, k, tables, w, f, d[1]):
        return False
    for i in range(n + 1):
        for c in range(COLUMNS):
            new[i, c] = y[i, c] + h * (_D * d[0, i, c] + (1.0 - _D) * d[1, i, c])
        if i < n:
            for c in range(3):
                new[i, VX + c] += h * (1.0 - _G) * push[i, c]
                new[i, MX + c] += h * (1.0 - _G) * push[i, 3 + c]
            new[i, CHARGE] += h * (1.0 - _G) * flow[i]
    return _stage(t + h, n, _G * h, clock, new, held, p, k, tables, w, push, flow)


@njit(cache=True, error_model="numpy")
def march_implicit(
    t: float,
    end: float,
    n: int,
    h: float,
    fixed: float,
    cfl: float,
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
    """March to `end` (see `march_explicit`), `most` steps at most; status, time, number of elements, step.

    `clock` further: current in and out by conduction (7, 8), the charge that came and went so far (9, 10), and how often
    steps were refused of late (13): a march that only creeps is given up.
    """
    cap = y.shape[0]
    d = np.zeros((2, cap, COLUMNS))
    w, f = np.zeros((WORK, cap)), np.zeros((cap, 3))
    mid, new = np.zeros((cap, COLUMNS)), np.zeros((cap, COLUMNS))
    push, flow = np.zeros((cap, 6)), np.zeros(cap)
    begun = clock[5] + clock[6]
    while t < end:
        if clock[5] + clock[6] - begun >= most:
            return PAUSED, t, n, h
        if n + 2 >= cap or int(clock[4]) + n >= landed.shape[0]:
            return FULL, t, n, h
        entry = clock[2] + clock[1] * clock[0] / p[FLOW]
        stop = min(end, entry)
        if not explicit_rates(t, n, held, y, p, k, tables, w, f, d[0]):
            return BROKEN, t, n, h
        step = _longest(n, y, held, p, k, w, cfl)
        if k[DRYING] == 1:
            step = min(step, cfl * drying_pace(n, y, p, tables, w))
        if fixed > 0.0:
            step = min(step, fixed)
        if not step > SPLINTER * min(clock[0] / p[FLOW], end):
            return STALLED, t, n, h
        step = (stop - t) / max(math.ceil((stop - t) / step), 1)  # equal steps to the stop, so that none is a splinter
        who, least = -1, SPLINTER * step
        soonest = 1e-9 * step  # who touches before lies there already, and is held
        while True:
            if not _step(t, step, n, clock, y, held, p, k, tables, w, f, d, mid, new, push, flow):
                step *= 0.25
                clock[6] += 1
                clock[13] += 1.0
                if step < least or clock[13] > WEARY:
                    return STALLED, t, n, h
                continue
            who, when = first_touch(n, step, y, new, held, p, k)
            if who < 0 or when > step * (1.0 - 1e-9) or step <= soonest:
                break
            step = max(when, soonest)
        clock[5] += 1
        clock[13] = max(clock[13] - 0.5, 0.0)
        if k[BALANCE] != FROZEN:
            clock[9] += step * ((1.0 - _G) * clock[11] + _G * clock[7])
            clock[10] += step * ((1.0 - _G) * clock[12] + _G * clock[8])
        reached = t + step >= stop * (1.0 - 1e-15)
        t = stop if reached else t + step
        for i in range(n + 1):
            for c in range(COLUMNS):
                y[i, c] = new[i, c]
        h = step
        if who >= 0:
            touch(t, who, n, y, held, marks, p, k)
            n, clock[3], rows = remove_landed(n, clock[3], y, held, marks, landed, int(clock[4]), False)
            clock[4] = rows
        if p[OUTFLOW] > 0.0 and y[1, X] > p[OUTFLOW]:
            leave(t, n, y, held, marks, p)
            n, clock[3], rows = remove_landed(n, clock[3], y, held, marks, landed, int(clock[4]), True)
            clock[4] = rows
        if p[LONGEST] > 0.0 or p[TURN] > 0.0:
            n = refine(n, clock[0], y, held, marks, p)
        if t >= entry:
            split(n, clock[0], p[FLOW] / (math.pi * p[RADIUS] ** 2), y, p, k)
            held[n + 1] = held[n] = 0
            n += 1
            clock[1] += 1
    return DONE, t, n, h
