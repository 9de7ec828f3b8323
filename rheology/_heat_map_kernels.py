"""Radial drying with heat in compiled loops: the cells of `_drying_kernels`, and one temperature of the whole
cross-section.

The temperature stands behind the outermost cell as one more row of the same tridiagonal system: it knows that cell
(its activity) and that cell knows it (its vapour pressure); what else it depends on is slow and left to the iteration.
State: u of the cells, T, volume lost.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.rheology._drying_kernels import (
    _T,
    _TI,
    MU,
    MU_PAIR,
    _factor,
    _jacobian,
    _solve,
    _turn,
    fluxes,
)
from spinline.rheology._heat_kernels import _ERROR, surface

__all__ = ["attempt_map", "surface_rates"]


@njit(cache=True, error_model="numpy")
def surface_rates(
    outer: float, kelvin: float, left: float, sub: FloatArray, tables: FloatArray, air: FloatArray, place: FloatArray
) -> tuple[float, float]:
    """Volume flux over pi inwards (m2/s, negative in drying) and heating over pi and a length (W/m) of the surface.

    `outer` is u of the outermost cell; `place`: stretch, speed, pace, speed across. NaN where the solvent boils.
    """
    activity, flux, at = np.empty(1), np.empty(1), np.empty(4)
    phi = 1 / (1 + outer)
    activity[0] = outer * phi * np.exp(phi * (1 + sub[0, 5] * phi))
    at[0], at[1], at[2], at[3] = place[0], place[1], place[3], place[2]
    warmed, carried, _ = surface(activity, left, kelvin, sub, tables, air, at, flux)
    return -flux[0] / sub[0, 0], warmed - carried


@njit(cache=True, error_model="numpy")
def _everything(
    y: FloatArray,
    share: FloatArray,
    table: FloatArray,
    still: FloatArray,
    sub: FloatArray,
    tables: FloatArray,
    air: FloatArray,
    place: FloatArray,
    flux: FloatArray,
    inner: FloatArray,
    outer: FloatArray,
    out: FloatArray,
) -> float:
    """dy/dx of cells, temperature and loss; returns the volume left, NaN where it cannot be."""
    m = share.size
    if not 120.0 <= y[m] <= 480.0:
        return np.nan
    left = fluxes(y[:m], share, table, still, place, flux, inner, outer)
    gone, heating = surface_rates(y[m - 1], y[m], left, sub, tables, air, place)
    if not np.isfinite(heating):
        return np.nan
    flux[m - 1] = gone
    pace = place[2]
    out[0] = pace * flux[0] / share[0]
    for i in range(1, m):
        out[i] = pace * (flux[i] - flux[i - 1]) / share[i]
    capacity = air[3] * air[8] + (left - air[3]) * sub[0, 0] * sub[0, 2]
    out[m] = pace * air[3] * heating / capacity
    out[m + 1] = -pace * gone
    return float(left)


@njit(cache=True, error_model="numpy")
def attempt_map(
    y: FloatArray,
    h: float,
    guess: FloatArray,
    scale: FloatArray,
    tolerance: float,
    share: FloatArray,
    table: FloatArray,
    still: FloatArray,
    sub: FloatArray,
    tables: FloatArray,
    air: FloatArray,
    places: FloatArray,
    stages: FloatArray,
    first: FloatArray,
    error: FloatArray,
) -> tuple[int, float, float]:
    """One step, as `_drying_kernels.attempt` makes it, with the temperature."""
    m = share.size
    n = m + 1
    flux, inner, outer, at = np.empty(m), np.empty(m), np.empty(m), np.empty(n + 1)
    left = _everything(y, share, table, still, sub, tables, air, places[0], flux, inner, outer, first)
    if not np.isfinite(left):
        return 0, 0.0, 0.0
    low, mid, high = np.zeros(n), np.zeros(n), np.zeros(n)
    pace = places[0, 2]
    capacity = air[3] * air[8] + (left - air[3]) * sub[0, 0] * sub[0, 2]
    warm = pace * air[3] / capacity
    du, dt = 1e-6 * max(y[m - 1], 1e-8), 1e-4
    gone, heating = surface_rates(y[m - 1], y[m], left, sub, tables, air, places[0])
    wetter, wetter_heat = surface_rates(y[m - 1] + du, y[m], left, sub, tables, air, places[0])
    warmer, warmer_heat = surface_rates(y[m - 1], y[m] + dt, left, sub, tables, air, places[0])
    inner[m - 1], outer[m - 1] = (wetter - gone) / du, 0.0
    _jacobian(inner, outer, share, pace, low[:m], mid[:m], high[:m])
    high[m - 1] = pace * (warmer - gone) / dt / share[m - 1]
    low[m], mid[m] = warm * (wetter_heat - heating) / du, warm * (warmer_heat - heating) / dt
    by_cell, by_heat = -pace * (wetter - gone) / du, -pace * (warmer - gone) / dt  # of the loss
    real, pair = np.empty(n), np.empty(n, np.complex128)
    _factor(low, mid, high, MU / h, real)
    _factor(low, mid, high, MU_PAIR / h, pair)
    w, turned = np.empty((3, n + 1)), np.empty((3, n + 1))
    _turn(_TI, guess, w)
    stages[:] = guess
    rates = np.empty((3, n + 1))
    right, both = np.empty(n + 1), np.empty(n + 1, np.complex128)
    before, contraction, done = -1.0, 0.0, 0
    for iteration in range(1, 11):
        for k in range(3):
            for i in range(n + 1):
                at[i] = y[i] + stages[k, i]
                if i < m and not -0.3 < at[i] < 1e300:
                    return 0, contraction, 0.0
            if not np.isfinite(
                _everything(at, share, table, still, sub, tables, air, places[k + 1], flux, inner, outer, rates[k])
            ):
                return 0, contraction, 0.0
        _turn(_TI, rates, turned)
        for i in range(n + 1):
            right[i] = turned[0, i] - MU / h * w[0, i]
            both[i] = turned[1, i] + 1j * turned[2, i] - MU_PAIR / h * (w[1, i] + 1j * w[2, i])
        _solve(low, high, real, right)
        _solve(low, high, pair, both)
        right[n] = (right[n] + by_cell * right[m - 1] + by_heat * right[m]) * h / MU
        both[n] = (both[n] + by_cell * both[m - 1] + by_heat * both[m]) * h / MU_PAIR
        size = 0.0
        for i in range(n + 1):
            size += (right[i] ** 2 + both[i].real ** 2 + both[i].imag ** 2) / scale[i] ** 2
            w[0, i] += right[i]
            w[1, i] += both[i].real
            w[2, i] += both[i].imag
        size = np.sqrt(size / (3 * (n + 1)))
        _turn(_T, w, stages)
        if not np.isfinite(size):
            return 0, contraction, 0.0
        if before > 0:
            contraction = size / before
            if contraction >= 1 or contraction ** (10 - iteration) / (1 - contraction) * size > tolerance:
                return 0, contraction, 0.0
        if size == 0 or (before > 0 and contraction / (1 - contraction) * size < tolerance):
            done = iteration
            break
        before = size
    if not done:
        return 0, contraction, 0.0
    for i in range(n + 1):
        error[i] = first[i] + (_ERROR[0] * stages[0, i] + _ERROR[1] * stages[1, i] + _ERROR[2] * stages[2, i]) / h
    _solve(low, high, real, error)
    error[n] = (error[n] + by_cell * error[m - 1] + by_heat * error[m]) * h / MU
    size = 0.0
    for i in range(n + 1):
        size += (error[i] / scale[i]) ** 2
    return done, contraction, float(np.sqrt(size / (n + 1)))
