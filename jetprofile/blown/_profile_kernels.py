"""Slopes of a straight blown jet whose solution has a solvent viscosity, and the difference equations made of them.

Unknowns: u = ln v/v_0, F in units of `scale`, ln B_zz, ln B_rr, with B = f(A) A the conformation times the spring's factor
``f = 1 + (tr B - 3)/L^2`` (1 for a linear spring). `p` holds the constants in the order of `CONSTANTS`. Nothing is checked.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["CONSTANTS", "entry", "jacobian", "residual", "slopes"]

CONSTANTS = (
    "flow_rate", "initial_velocity", "density", "gravity", "surface_tension", "modulus", "relaxation_time",
    "solvent_viscosity", "inverse_extensibility", "drag_factor", "drag_power", "air_density", "air_viscosity", "share",
    "scale", "drawn",
)  # fmt: skip


@njit(cache=True, error_model="numpy")
def _push(v: float, air: float, p: FloatArray) -> float:
    f = p[0] / v
    a = math.sqrt(f / math.pi)
    w = air - v
    drag = p[9] * math.pi * a * p[11] * (2 * a / p[12]) ** -p[10] * abs(w) ** (2 - p[10])
    return float(p[2] * p[3] * f + p[13] * math.copysign(drag, w))


@njit(cache=True, error_model="numpy")
def _relaxing(bz: float, br: float, p: FloatArray) -> tuple[float, float]:
    """Rates of ln A_zz and ln A_rr without flow, 1/s."""
    f = 1 + (bz + 2 * br - 3) * p[8]
    return -(bz - 1) * f / (bz * p[6]), -(br - 1) * f / (br * p[6])


@njit(cache=True, error_model="numpy")
def slopes(y: FloatArray, air: float, p: FloatArray, out: FloatArray) -> None:
    """Rates of the unknowns along z."""
    v = p[1] * math.exp(min(max(y[0], -60.0), 60.0))
    bz, br = math.exp(min(max(y[2], -60.0), 60.0)), math.exp(min(max(y[3], -60.0), 60.0))
    f = p[0] / v
    a = math.sqrt(f / math.pi)
    rate = (y[1] * p[14] - math.pi * a * p[4] - f * p[5] * (bz - br)) / (3 * p[7] * f)
    rz, rr = _relaxing(bz, br, p)
    rz, rr = 2 * rate + rz, -rate + rr
    common = (bz * rz + 2 * br * rr) * p[8] / (1 - 3 * p[8])
    out[0] = rate / v
    out[1] = (p[2] * p[0] * rate - _push(v, air, p)) / p[14]
    out[2] = (rz + common) / v
    out[3] = (rr + common) / v


@njit(cache=True, error_model="numpy")
def entry(y: FloatArray, air: float, p: FloatArray) -> float:
    """Rate of strain less that of the same jet without solvent, over it and 1/theta: 0 where no layer begins at the nozzle."""
    v = p[1] * math.exp(min(max(y[0], -60.0), 60.0))
    bz, br = math.exp(min(max(y[2], -60.0), 60.0)), math.exp(min(max(y[3], -60.0), 60.0))
    f = p[0] / v
    a = math.sqrt(f / math.pi)
    stiff = p[8] / (1 - 3 * p[8])
    rz, rr = _relaxing(bz, br, p)
    c1 = (2 * bz - 2 * br) * stiff
    c0 = (bz * rz + 2 * br * rr) * stiff
    bracket = p[5] * (bz * (2 + c1) - br * (-1 + c1) - (bz - br)) - p[4] / (2 * a) - p[2] * v * v
    bracket += 3 * p[7] / p[6]
    wanted = (-p[5] * (bz * (rz + c0) - br * (rr + c0)) - v * _push(v, air, p) / f) / bracket
    rate = (y[1] * p[14] - math.pi * a * p[4] - f * p[5] * (bz - br)) / (3 * p[7] * f)
    return float((rate - wanted) * 3 * p[7] * f / p[14])


@njit(cache=True, error_model="numpy")
def _panel(
    h: float,
    one: FloatArray,
    two: FloatArray,
    air0: float,
    air1: float,
    air2: float,
    p: FloatArray,
    upwind: bool,
    work: FloatArray,
    out: FloatArray,
) -> None:
    """One interval: Lobatto of order 4, or implicit Euler (the force against the flow of what is told)."""
    k0, k1, k2, y1 = work[0], work[1], work[2], work[3]
    slopes(two, air2, p, k2)
    if upwind:
        slopes(one, air0, p, k0)
        for i in range(4):
            out[i] = two[i] - one[i] - h * (k0[i] if i == 1 else k2[i])
        return
    slopes(one, air0, p, k0)
    for i in range(4):
        y1[i] = 0.5 * (one[i] + two[i]) + h / 8 * (k0[i] - k2[i])
    slopes(y1, air1, p, k1)
    for i in range(4):
        out[i] = two[i] - one[i] - h / 6 * (k0[i] + 4 * k1[i] + k2[i])


@njit(cache=True, error_model="numpy")
def _left(y: FloatArray, air: float, p: FloatArray, out: FloatArray) -> None:
    out[0] = y[0]
    if p[15] > 0:  # drawn: an elastic jump, and no layer of the solvent's
        f = math.log1p((math.exp(min(y[2], 60.0)) + 2 * math.exp(min(y[3], 60.0)) - 3) * p[8])
        out[1] = (y[3] - f) + 0.5 * (y[2] - f)
        out[2] = entry(y, air, p)
    else:
        out[1], out[2] = y[2], y[3]


@njit(cache=True, error_model="numpy")
def residual(
    z: FloatArray,
    y: FloatArray,
    node: FloatArray,
    middle: FloatArray,
    p: FloatArray,
    pull: float,
    upwind: bool,
    out: FloatArray,
) -> None:
    """All equations: three at the nozzle, four an interval, the pull at the end (less capillarity)."""
    n = z.size
    work = np.empty((4, 4))
    _left(y[0], node[0], p, out[:3])
    for j in range(n - 1):
        _panel(
            z[j + 1] - z[j], y[j], y[j + 1], node[j], middle[j], node[j + 1], p, upwind, work,
            out[3 + 4 * j : 7 + 4 * j],
        )  # fmt: skip
    out[4 * n - 1] = _end(y[n - 1], p, pull)


@njit(cache=True, error_model="numpy")
def _end(y: FloatArray, p: FloatArray, pull: float) -> float:
    a = math.sqrt(p[0] / (math.pi * p[1] * math.exp(min(max(y[0], -60.0), 60.0))))
    return float(y[1] - (math.pi * a * p[4] + pull) / p[14])


@njit(cache=True, error_model="numpy")
def jacobian(
    z: FloatArray,
    y: FloatArray,
    node: FloatArray,
    middle: FloatArray,
    p: FloatArray,
    pull: float,
    upwind: bool,
    band: FloatArray,
) -> None:
    """Derivatives by differences, in the banded form of LAPACK with 6 below and 4 above, row 10 the diagonal."""
    n = z.size
    work, base, moved, at = np.empty((4, 4)), np.empty(4), np.empty(4), np.empty(4)
    band[:] = 0.0
    step = 1e-7
    _left(y[0], node[0], p, base)
    for k in range(4):
        for i in range(4):
            at[i] = y[0, i]
        e = step * max(1.0, abs(at[k]))
        at[k] += e
        _left(at, node[0], p, moved)
        for i in range(3):
            band[10 + i - k, k] = (moved[i] - base[i]) / e
    for j in range(n - 1):
        h = z[j + 1] - z[j]
        _panel(h, y[j], y[j + 1], node[j], middle[j], node[j + 1], p, upwind, work, base)
        for k in range(8):
            side = j + k // 4
            for i in range(4):
                at[i] = y[side, i]
            e = step * max(1.0, abs(at[k % 4]))
            at[k % 4] += e
            if k < 4:
                _panel(h, at, y[j + 1], node[j], middle[j], node[j + 1], p, upwind, work, moved)
            else:
                _panel(h, y[j], at, node[j], middle[j], node[j + 1], p, upwind, work, moved)
            column = 4 * j + k
            for i in range(4):
                row = 3 + 4 * j + i
                band[10 + row - column, column] = (moved[i] - base[i]) / e
    last = _end(y[n - 1], p, pull)
    for k in range(4):
        for i in range(4):
            at[i] = y[n - 1, i]
        e = step * max(1.0, abs(at[k]))
        at[k] += e
        column = 4 * (n - 1) + k
        band[10 + 4 * n - 1 - column, column] = (_end(at, p, pull) - last) / e
