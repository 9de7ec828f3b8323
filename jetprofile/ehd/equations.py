"""Equations of the straight electrified jet (review Eqs. 5-8, steady), written with bounded first-order unknowns.

Lengths by r_0, velocities by v_0, fields by E_s, charges by eps_0 E_s; ``u = ln V``, ``R = e^(-u/2)``. Unknowns along z:

=========  =====================================================================================================
``u``      ``ln(v / v_0)``
``T``      axial viscoelastic force over ``pi r_0 mu v_0``: ``R^2 (tau_zz - tau_rr)``
``Psi``    potential of the jet minus that of all other charges, over ``E_s r_0``
``ln i``   the current over ``pi r_0^2 K E_s``; a constant, carried along as an unknown
``ln B``   ``B = f A_zz``, ``ln C``: ``C = f A_rr``, f the finite-extensibility factor (viscoelastic only)
``q``      share of the current that is conducted (only where charge relaxation is resolved)
=========  =====================================================================================================

``E = i q V``, ``sigma = i (1 - q) R / Pe``, ``F = Psi / l`` is the line charge over ``2 pi eps_0 r_0 E_s``, with the slenderness
``l = ln(L / r_0)`` (constant log) or ``ln(L / r)`` (local log), and::

    u'   = T / 3                                     Newtonian
    u'   = [T V - (1 - rs) / De (B - C)] / (3 rs V)    with a polymer
    Psi' = E_ext - E
    q'   = (2 / beta_e) [(1 - q) / (Pe V) - F / i]       or, charge relaxing at once,  q = 1 - Pe V F / i
    T'   = Re {V u' - R^2 / Fr - R' / We - El [sigma sigma' R^2 + beta_e E E' R^2 + 2 i^2 q (1 - q) / Pe]}

The products f A are the unknowns, since ``f = 1 + (B + 2 C - 3) / L2`` then is positive whatever they are: no trial of an
iteration can leave the extensible range. Eq. (7) as printed has ``sigma_e`` where the surface charge belongs, and Eq. (8) divides
the surface charge by the jet's permittivity in place of the air's.

References
----------
Hohman et al., Phys. Fluids 13, 2201 (2001); Feng, Phys. Fluids 14, 3912 (2002), J. Non-Newtonian Fluid Mech. 116, 55 (2003).
"""

from typing import Any

import numpy as np
from numba import njit

from spinline.checks import FloatArray

__all__ = ["PARAMETERS", "box_residual", "box_system", "place", "slopes"]

# Order of the parameter vector; `share` = rs, `gain` = (1 - rs) / De, `extensibility` = 1 / L2 (0: Oldroyd-B),
# `mobility` = the Giesekus a, `end_slope` = V' / V at the end
PARAMETERS = (
    "reynolds", "weber", "inverse_froude", "peclet", "euler", "beta", "log_chi", "inverse_deborah", "share", "gain",
    "extensibility", "mobility", "end_slope", "last_field",
)  # fmt: skip


def place(polymer: bool, charge: bool) -> tuple[int, int]:
    """Number of unknowns, and the index of q (-1: not an unknown)."""
    size = 4 + 2 * polymer + charge
    return size, size - 1 if charge else -1


@njit(cache=True, error_model="numpy")
def slopes(y: Any, field: float, p: Any, polymer: bool, charge: bool, local: bool, out: Any) -> tuple[float, float]:
    """Derivatives of the unknowns by s at one place, written into `out`; returns E and q."""
    u, tension, psi, current = y[0], y[1], y[2], np.exp(y[3])
    v, radius = np.exp(u), np.exp(-0.5 * u)
    log = p[6] + (0.5 * u if local else 0.0)
    peclet, beta = p[3], p[5]
    if polymer:
        b, c = np.exp(y[4]), np.exp(y[5])
        du = (tension * v - p[9] * (b - c)) / (3.0 * p[8] * v)
    else:
        b, c = 1.0, 1.0
        du = tension / 3.0
    charge_density = psi / log
    if charge:
        q = y[y.size - 1]
        dq = 2.0 / beta * ((1.0 - q) / (peclet * v) - charge_density / current)
        inside = current * q * v
        dpsi = field - inside
        out[y.size - 1] = dq
    else:
        q = 1.0 - peclet * v * charge_density / current
        inside = current * q * v
        dpsi = field - inside
        dlog = 0.5 * du if local else 0.0
        dq = -(peclet / current) * v * (charge_density * (du - dlog / log) + dpsi / log)
    dradius = -0.5 * radius * du
    sigma = current * (1.0 - q) * radius / peclet
    dsigma = current * ((1.0 - q) * dradius - dq * radius) / peclet
    dinside = current * v * (dq + q * du)
    pull = (sigma * dsigma + beta * inside * dinside) * radius**2 + 2.0 * current**2 * q * (1.0 - q) / peclet
    out[0] = du
    out[1] = p[0] * (v * du - radius**2 * p[2] - dradius / p[1] - p[4] * pull)
    out[2] = dpsi
    out[3] = 0.0
    if polymer:
        f = 1.0 + (b + 2.0 * c - 3.0) * p[10]
        zz, rr = b / f, c / f
        # f times dA/ds
        db = f * (2.0 * du * zz - p[7] * (b - 1.0 + p[11] * (zz - 1.0) ** 2) / v)
        dc = f * (-du * rr - p[7] * (c - 1.0 + p[11] * (rr - 1.0) ** 2) / v)
        stiffer = (db + 2.0 * dc) * p[10] / (1.0 - 3.0 * p[10])  # f'/f, from f = 1 + (B + 2 C - 3) / L2
        out[4] = db / b + stiffer
        out[5] = dc / c + stiffer
    return inside, q


@njit(cache=True, error_model="numpy")
def _jacobian(y: Any, field: float, p: Any, flags: Any, scale: Any, base: Any, out: Any, work: Any) -> None:
    """Derivatives of `slopes` by the unknowns, forward differences, into `out`; `base` are the slopes at y."""
    for k in range(y.size):
        old = y[k]
        step = 1e-7 * (abs(old) + scale[k])
        y[k] = old + step
        step = y[k] - old
        slopes(y, field, p, flags[0], flags[1], flags[2], work)
        y[k] = old
        for r in range(y.size):
            out[r, k] = (work[r] - base[r]) / step


@njit(cache=True, error_model="numpy")
def _end_rows(y: Any, p: Any, flags: Any, work: Any) -> tuple[float, float]:
    """Conditions at the end: the field is the applied one, and V' = end_slope V."""
    inside, _ = slopes(y, p[13], p, flags[0], flags[1], flags[2], work)
    return inside / p[13] - 1.0, work[0] - p[12]


@njit(cache=True, error_model="numpy")
def box_residual(s: Any, y: Any, nodes: Any, middles: Any, p: Any, flags: Any, left: Any, order: int, out: Any) -> None:
    """Residual of the difference equations, in the order: start, intervals, end.

    `left` holds (index, value) of the conditions at the start; `nodes` and `middles` the applied field there.
    """
    n, m = y.shape
    f0, f1, fm, mid = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    row = 0
    for k in range(left.shape[0]):
        out[row] = y[0, int(left[k, 0])] - left[k, 1]
        row += 1
    if order == 4:
        slopes(y[0], nodes[0], p, flags[0], flags[1], flags[2], f0)
    for j in range(n - 1):
        h = s[j + 1] - s[j]
        if order == 4:
            slopes(y[j + 1], nodes[j + 1], p, flags[0], flags[1], flags[2], f1)
            for k in range(m):
                mid[k] = 0.5 * (y[j, k] + y[j + 1, k]) + 0.125 * h * (f0[k] - f1[k])
        else:
            for k in range(m):
                mid[k] = 0.5 * (y[j, k] + y[j + 1, k])
        slopes(mid, middles[j], p, flags[0], flags[1], flags[2], fm)
        for k in range(m):
            mean = (f0[k] + 4.0 * fm[k] + f1[k]) / 6.0 if order == 4 else fm[k]
            out[row + k] = y[j + 1, k] - y[j, k] - h * mean
        row += m
        if order == 4:
            for k in range(m):
                f0[k] = f1[k]
    out[row], out[row + 1] = _end_rows(y[n - 1], p, flags, fm)


@njit(cache=True, error_model="numpy")
def box_system(
    s: Any, y: Any, nodes: Any, middles: Any, p: Any, flags: Any, left: Any, scale: Any, order: int, band: Any, out: Any
) -> None:
    """Residual into `out` and its Jacobian into `band` (LAPACK's general band form, with room for the pivots)."""
    n, m = y.shape
    count = left.shape[0]
    low, high = count + m - 1, 2 * m - 1 - count
    box_residual(s, y, nodes, middles, p, flags, left, order, out)
    band[:] = 0.0
    top = low + high  # row of the diagonal
    for k in range(count):
        c = int(left[k, 0])
        band[top + k - c, c] = 1.0
    f0, f1, fm, mid, work = np.empty(m), np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    j0, j1, jm = np.empty((m, m)), np.empty((m, m)), np.empty((m, m))
    a, b = np.empty((m, m)), np.empty((m, m))
    if order == 4:
        slopes(y[0], nodes[0], p, flags[0], flags[1], flags[2], f0)
        _jacobian(y[0].copy(), nodes[0], p, flags, scale, f0, j0, work)
    for j in range(n - 1):
        h = s[j + 1] - s[j]
        if order == 4:
            slopes(y[j + 1], nodes[j + 1], p, flags[0], flags[1], flags[2], f1)
            _jacobian(y[j + 1].copy(), nodes[j + 1], p, flags, scale, f1, j1, work)
            for k in range(m):
                mid[k] = 0.5 * (y[j, k] + y[j + 1, k]) + 0.125 * h * (f0[k] - f1[k])
        else:
            for k in range(m):
                mid[k] = 0.5 * (y[j, k] + y[j + 1, k])
        slopes(mid, middles[j], p, flags[0], flags[1], flags[2], fm)
        _jacobian(mid, middles[j], p, flags, scale, fm, jm, work)
        for r in range(m):
            for c in range(m):
                if order == 4:
                    x0, x1 = 0.5 * jm[r, c], 0.5 * jm[r, c]
                    for k in range(m):
                        x0 += 0.125 * h * jm[r, k] * j0[k, c]
                        x1 -= 0.125 * h * jm[r, k] * j1[k, c]
                    a[r, c] = -h / 6.0 * (j0[r, c] + 4.0 * x0)
                    b[r, c] = -h / 6.0 * (j1[r, c] + 4.0 * x1)
                else:
                    a[r, c] = b[r, c] = -0.5 * h * jm[r, c]
            a[r, r] -= 1.0
            b[r, r] += 1.0
        for r in range(m):
            row = count + j * m + r
            for c in range(m):
                left_column = j * m + c
                band[top + row - left_column, left_column] = a[r, c]
                band[top + row - left_column - m, left_column + m] = b[r, c]
        if order == 4:
            for r in range(m):
                f0[r] = f1[r]
                for c in range(m):
                    j0[r, c] = j1[r, c]
    last = y[n - 1].copy()
    e0, e1 = _end_rows(last, p, flags, work)
    for c in range(m):
        old = last[c]
        step = 1e-7 * (abs(old) + scale[c])
        last[c] = old + step
        step = last[c] - old
        d0, d1 = _end_rows(last, p, flags, work)
        last[c] = old
        column = (n - 1) * m + c
        for r in range(2):
            row = count + (n - 1) * m + r
            band[top + row - column, column] = ((d0 - e0) if r == 0 else (d1 - e1)) / step
