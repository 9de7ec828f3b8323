"""Equations of the straight electrified jet (review Eqs. 5-8, steady), written with bounded first-order unknowns.

Lengths by r_0, velocities by v_0, fields by E_s, charges by eps_0 E_s; ``u = ln V``, ``R = e^(-u/2)``. Unknowns along z:

=========  =====================================================================================================
``u``      ``ln(v / v_0)``
``W``      ``T + Re El R^2 (sigma^2 + beta_e E^2) / 2``, T the viscoelastic force over ``pi r_0 mu v_0``: with the electric
           stress in it, its slope holds no slope of the charge, which may be steep
``Psi``    potential of the jet minus that of all other charges, over ``E_s r_0``
``ln i``   the current over ``pi r_0^2 K E_s``; a constant, carried along as an unknown
``ln B``   ``B = f A_zz``, ``ln C``: ``C = f A_rr``, f the finite-extensibility factor (viscoelastic only)
``q``      share of the current that is conducted (only where charge relaxation is resolved)
=========  =====================================================================================================

``E = i q V``, ``sigma = i (1 - q) R / Pe``, ``F = Psi / l`` is the line charge over ``2 pi eps_0 r_0 E_s``, with the
slenderness ``l = ln(L / r_0)`` (constant log) or ``ln(L / r)`` (local log), and::

    u'   = T / 3                                     Newtonian
    u'   = [T V - (1 - rs) / De (B - C)] / (3 rs V)    with a polymer
    Psi' = E_ext - E
    q'   = (2 / beta_e) [(1 - q) / (Pe V) - F / i]       or, charge relaxing at once,  q = 1 - Pe V F / i
    T'   = Re {V u' - R^2 / Fr - R' / We - El [sigma sigma' R^2 + beta_e E E' R^2 + 2 i^2 q (1 - q) / Pe]}
    W'   = Re {V u' - R^2 / Fr - R' / We - El [u' R^2 (sigma^2 + beta_e E^2) / 2 + 2 i^2 q (1 - q) / Pe]}

The products f A are the unknowns, since ``f = 1 + (B + 2 C - 3) / L2`` then is positive whatever they are: no trial of an
iteration can leave the extensible range. Eq. (7) as printed has ``sigma_e`` where the surface charge belongs, and Eq. (8)
divides the surface charge by the jet's permittivity in place of the air's.

References
----------
Hohman et al., Phys. Fluids 13, 2201 (2001); Feng, Phys. Fluids 14, 3912 (2002), J. Non-Newtonian Fluid Mech. 116, 55
(2003).
"""

from typing import Any

import numpy as np

from spinline.base.kernels import njit

__all__ = ["PARAMETERS", "jacobian", "rates", "residual", "slopes", "tilts"]

# Order of the parameter vector; `share` = rs, `gain` = (1 - rs) / De, `extensibility` = 1 / L2 (0: Oldroyd-B),
# `mobility` = the Giesekus a, `end_slope` = V' / V at the end
PARAMETERS = (
    "reynolds",
    "weber",
    "inverse_froude",
    "peclet",
    "euler",
    "beta",
    "log_chi",
    "inverse_deborah",
    "share",
    "gain",
    "extensibility",
    "mobility",
    "end_slope",
    "last_field",
)


@njit(cache=True, error_model="numpy")
def slopes(y: Any, field: float, p: Any, polymer: bool, charge: bool, local: bool, out: Any) -> Any:
    """Derivatives of the unknowns by s at one place, written into `out`; returns E, q and T."""
    u, psi, current = y[0], y[2], np.exp(y[3])
    v, area = np.exp(u), np.exp(-u)
    radius = np.exp(-0.5 * u)
    charge_density = psi / (p[6] + (0.5 * u if local else 0.0))
    q = y[y.size - 1] if charge else 1.0 - p[3] * v * charge_density / current
    inside, sigma = current * q * v, current * (1.0 - q) * radius / p[3]
    stress = 0.5 * p[4] * (sigma**2 + p[5] * inside**2)
    tension = y[1] - p[0] * area * stress
    if polymer:
        b, c = np.exp(y[4]), np.exp(y[5])
        du = (tension * v - p[9] * (b - c)) / (3.0 * p[8] * v)
        f = 1.0 + (b + 2.0 * c - 3.0) * p[10]
        zz, rr = b / f, c / f
        # f times dA/ds
        db = f * (2.0 * du * zz - p[7] * (b - 1.0 + p[11] * (zz - 1.0) ** 2) / v)
        dc = f * (-du * rr - p[7] * (c - 1.0 + p[11] * (rr - 1.0) ** 2) / v)
        stiffer = (db + 2.0 * dc) * p[10] / (1.0 - 3.0 * p[10])  # f'/f, from f = 1 + (B + 2 C - 3) / L2
        out[4] = db / b + stiffer
        out[5] = dc / c + stiffer
    else:
        du = tension / 3.0
    shear = 2.0 * p[4] * current**2 * q * (1.0 - q) / p[3]
    out[0] = du
    out[1] = p[0] * (v * du - area * p[2] + 0.5 * radius * du / p[1] - area * du * stress - shear)
    out[2] = field - inside
    out[3] = 0.0
    if charge:
        out[y.size - 1] = 2.0 / p[5] * ((1.0 - q) / (p[3] * v) - charge_density / current)
    return inside, q, tension


@njit(cache=True, error_model="numpy")
def rates(y: Any, fields: Any, p: Any, flags: Any) -> Any:
    """Derivatives of the unknowns by s at many places, (n, unknowns), and E, q and T there, (n, 3)."""
    out, told = np.empty_like(y), np.empty((y.shape[0], 3))
    for j in range(y.shape[0]):
        told[j, 0], told[j, 1], told[j, 2] = slopes(y[j], fields[j], p, flags[0], flags[1], flags[2], out[j])
    return out, told


@njit(cache=True, error_model="numpy")
def tilts(y: Any, field: float, p: Any, flags: Any, value: Any, out: Any) -> None:
    """Values of `slopes` into `value`, and their derivatives by the unknowns, a column each, into `out`.

    `slopes` differentiated line by line; ``x_k`` is dx / dy_k.
    """
    polymer, charge, local, last = flags[0], flags[1], flags[2], y.size - 1
    inside, q, _ = slopes(y, field, p, polymer, charge, local, value)
    v, area, radius, current = np.exp(y[0]), np.exp(-y[0]), np.exp(-0.5 * y[0]), np.exp(y[3])
    length, du = p[6] + (0.5 * y[0] if local else 0.0), value[0]
    charge_density, sigma = y[2] / length, current * (1.0 - q) * radius / p[3]
    stress, shear = 0.5 * p[4] * (sigma**2 + p[5] * inside**2), 2.0 * p[4] * current**2 / p[3]
    b, c = (np.exp(y[4]), np.exp(y[5])) if polymer else (1.0, 1.0)
    for k in range(y.size):
        u_k, i_k = 1.0 * (k == 0), 1.0 * (k == 3)
        density_k = (1.0 * (k == 2) - (0.5 * u_k * charge_density if local else 0.0)) / length
        q_k = 1.0 * (k == last) if charge else -p[3] * v / current * (density_k + charge_density * (u_k - i_k))
        inside_k = inside * (u_k + i_k) + current * v * q_k
        sigma_k = sigma * (i_k - 0.5 * u_k) - current * radius / p[3] * q_k
        stress_k = p[4] * (sigma * sigma_k + p[5] * inside * inside_k)
        tension_k = 1.0 * (k == 1) - p[0] * area * (stress_k - stress * u_k)
        du_k = _stretch_tilts(k, tension_k, du, area, b, c, p, out) if polymer else tension_k / 3.0
        pull_k = v * (du_k + du * u_k) + area * p[2] * u_k + 0.5 * radius / p[1] * (du_k - 0.5 * du * u_k)
        push_k = area * (du_k * stress + du * (stress_k - stress * u_k))
        shear_k = shear * (2.0 * q * (1.0 - q) * i_k + (1.0 - 2.0 * q) * q_k)
        out[0, k], out[1, k], out[2, k], out[3, k] = du_k, p[0] * (pull_k - push_k - shear_k), -inside_k, 0.0
        if charge:
            free_k = -(q_k + (1.0 - q) * u_k) * area / p[3]
            out[last, k] = 2.0 / p[5] * (free_k - (density_k - charge_density * i_k) / current)


@njit(cache=True, error_model="numpy")
def _stretch_tilts(k: int, tension_k: float, du: float, area: float, b: float, c: float, p: Any, out: Any) -> Any:
    """Derivatives by unknown k: of u', returned, and of the slopes of ln B and ln C, into `out`."""
    u_k, b_k, c_k = 1.0 * (k == 0), b * (k == 4), c * (k == 5)
    f, f_k = 1.0 + (b + 2.0 * c - 3.0) * p[10], (b_k + 2.0 * c_k) * p[10]
    zz, rr = b / f, c / f
    zz_k, rr_k = (b_k - zz * f_k) / f, (c_k - rr * f_k) / f
    du_k = (tension_k + p[9] * area * ((b - c) * u_k - b_k + c_k)) / (3.0 * p[8])
    # db / B = 2 u' - g (B - 1 + a (A_zz - 1)^2) / A_zz, dc / C likewise with -u'
    g, far, near = p[7] * area, b - 1.0 + p[11] * (zz - 1.0) ** 2, c - 1.0 + p[11] * (rr - 1.0) ** 2
    far_k, near_k = b_k + 2.0 * p[11] * (zz - 1.0) * zz_k, c_k + 2.0 * p[11] * (rr - 1.0) * rr_k
    long, thin = 2.0 * du - g * far / zz, -du - g * near / rr
    long_k = 2.0 * du_k - g / zz * (far_k - far * (u_k + zz_k / zz))
    thin_k = -du_k - g / rr * (near_k - near * (u_k + rr_k / rr))
    stiffer_k = (b_k * long + b * long_k + 2.0 * (c_k * thin + c * thin_k)) * p[10] / (1.0 - 3.0 * p[10])
    out[4, k], out[5, k] = long_k + stiffer_k, thin_k + stiffer_k
    return du_k


@njit(cache=True, error_model="numpy")
def _end_rows(y: Any, p: Any, flags: Any, work: Any) -> Any:
    """Conditions at the end: the field is the applied one (or, with none given, Psi = -p[13]), and V' = end_slope V."""
    inside, _, _ = slopes(y, p[13], p, flags[0], flags[1], flags[2], work)
    if p[13] > 0.0:
        return inside / p[13] - 1.0, work[0] - p[12]
    return y[2] + p[13], work[0] - p[12]


@njit(cache=True, error_model="numpy")
def residual(s: Any, y: Any, nodes: Any, middles: Any, p: Any, flags: Any, left: Any, out: Any) -> None:
    """Residual of the difference equations, in the order: start, intervals, end.

    `left` holds (index, value) of the conditions at the start; `nodes` and `middles` the applied field there. Each
    interval is integrated by Simpson's rule with the middle from a cubic (three-stage Lobatto, order 4), or,
    ``flags[3]``, by implicit Euler in the direction in which each equation is stable: W and Psi (1, 2) backward, the
    others forward (order 1, never spurious).
    """
    n, m = y.shape
    f0, f1, fm, mid = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    row = left.shape[0]
    for k in range(row):
        out[k] = y[0, int(left[k, 0])] - left[k, 1]
    slopes(y[0], nodes[0], p, flags[0], flags[1], flags[2], f0)
    for j in range(n - 1):
        h = s[j + 1] - s[j]
        slopes(y[j + 1], nodes[j + 1], p, flags[0], flags[1], flags[2], f1)
        if flags[3]:
            for k in range(m):
                fm[k] = f0[k] if k == 1 or k == 2 else f1[k]
        else:
            for k in range(m):
                mid[k] = 0.5 * (y[j, k] + y[j + 1, k]) + 0.125 * h * (f0[k] - f1[k])
            slopes(mid, middles[j], p, flags[0], flags[1], flags[2], fm)
            for k in range(m):
                fm[k] = (f0[k] + 4.0 * fm[k] + f1[k]) / 6.0
        for k in range(m):
            out[row + k] = y[j + 1, k] - y[j, k] - h * fm[k]
            f0[k] = f1[k]
        row += m
    out[row], out[row + 1] = _end_rows(y[n - 1], p, flags, fm)


@njit(cache=True, error_model="numpy")
def _blocks(h: float, upwind: bool, j0: Any, jm: Any, j1: Any, a: Any, b: Any) -> None:
    """Derivatives of one interval's residual by its two ends, from the Jacobians at its ends and its middle."""
    m = j0.shape[0]
    for r in range(m):
        for c in range(m):
            if upwind:
                back = r == 1 or r == 2
                a[r, c] = -h * j0[r, c] if back else 0.0
                b[r, c] = 0.0 if back else -h * j1[r, c]
            else:
                x0 = x1 = 0.5 * jm[r, c]
                for k in range(m):
                    x0 += 0.125 * h * jm[r, k] * j0[k, c]
                    x1 -= 0.125 * h * jm[r, k] * j1[k, c]
                a[r, c] = -h / 6.0 * (j0[r, c] + 4.0 * x0)
                b[r, c] = -h / 6.0 * (j1[r, c] + 4.0 * x1)
        a[r, r] -= 1.0
        b[r, r] += 1.0


@njit(cache=True, error_model="numpy")
def jacobian(s: Any, y: Any, nodes: Any, middles: Any, p: Any, flags: Any, left: Any, band: Any) -> None:
    """Jacobian of `residual` into `band`, LAPACK's general band form with room for the pivots."""
    n, m = y.shape
    count = left.shape[0]
    low, high = count + m - 1, 2 * m - 1 - count
    band[:] = 0.0
    top = low + high  # row of the diagonal
    for k in range(count):
        c = int(left[k, 0])
        band[top + k - c, c] = 1.0
    f0, f1, fm, mid = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    j0, j1, jm, a, b = np.empty((m, m)), np.empty((m, m)), np.empty((m, m)), np.empty((m, m)), np.empty((m, m))
    tilts(y[0], nodes[0], p, flags, f0, j0)
    for j in range(n - 1):
        h = s[j + 1] - s[j]
        tilts(y[j + 1], nodes[j + 1], p, flags, f1, j1)
        if not flags[3]:
            for k in range(m):
                mid[k] = 0.5 * (y[j, k] + y[j + 1, k]) + 0.125 * h * (f0[k] - f1[k])
                f0[k] = f1[k]
            tilts(mid, middles[j], p, flags, fm, jm)
        _blocks(h, flags[3], j0, jm, j1, a, b)
        for r in range(m):
            row = count + j * m + r
            for c in range(m):
                band[top + row - j * m - c, j * m + c] = a[r, c]
                band[top + row - (j + 1) * m - c, (j + 1) * m + c] = b[r, c]
                j0[r, c] = j1[r, c]
    # the conditions at the end: of the field at p[13], which u' does not hold, or of Psi, and of u'
    tilts(y[n - 1], p[13], p, flags, f1, j1)
    row = count + (n - 1) * m
    for c in range(m):
        column = (n - 1) * m + c
        band[top + row - column, column] = -j1[2, c] / p[13] if p[13] > 0.0 else 1.0 * (c == 2)
        band[top + row + 1 - column, column] = j1[0, c]
