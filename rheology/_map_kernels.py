"""A step of Radau's method on the map of a drying jet in compiled loops, at one temperature or with one more row for it.

With heat, the temperature of the whole cross-section stands behind the outermost cell as one more row of the same
tridiagonal system: it knows that cell (its activity) and that cell knows it (its vapour pressure); what else it depends
on is slow and left to the iteration. State: u of the cells, T where there is heat, volume lost. Volumes are linear in
the fluxes, so that the method conserves them to rounding; enthalpy is a product, and is kept beside the state: `_book`
says what passes the surface at the stages, and the temperature after a step is the one that this leaves.
"""

from typing import TypeAlias

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.rheology._drying_kernels import ERROR, MU, MU_PAIR, TI, T, bands, factor, fluxes, solve, turn
from spinline.rheology._heat_kernels import surface

__all__ = ["NO_HEAT", "Heat", "attempt", "surface_rates"]

Heat: TypeAlias = tuple[FloatArray, FloatArray, FloatArray]  # `heat.Inputs` but for its pairs; empty without heat
NO_HEAT: Heat = (np.empty((0, 0)), np.empty((0, 3, 4, 1)), np.empty(0))


@njit(cache=True, error_model="numpy")
def surface_rates(outer: float, kelvin: float, left: float, heat: Heat, place: FloatArray) -> tuple[float, float]:
    """Volume flux over pi inwards (m2/s, negative in drying) and heating over pi and a length (W/m) of the surface.

    `outer` is u of the outermost cell; `place`: stretch, speed, pace, speed across. NaN where the solvent boils.
    """
    sub, tables, air = heat
    activity, flux, at = np.empty(1), np.empty(1), np.empty(4)
    phi = 1 / (1 + outer)
    activity[0] = outer * phi * np.exp(phi * (1 + sub[0, 5] * phi))
    at[0], at[1], at[2], at[3] = place[0], place[1], place[3], place[2]
    warmed, carried, _ = surface(activity, left, kelvin, sub, tables, air, at, flux)
    return -flux[0] / sub[0, 0], warmed - carried


@njit(cache=True, error_model="numpy")
def _warming(left: float, heat: Heat, place: FloatArray) -> float:
    """dT/dx of a heating of 1 W/m over pi."""
    sub, _, air = heat
    return float(place[2] * air[3] / (air[3] * air[8] + (left - air[3]) * sub[0, 0] * sub[0, 2]))


@njit(cache=True, error_model="numpy")
def _book(
    y: FloatArray, stages: FloatArray, share: FloatArray, heat: Heat, places: FloatArray, out: FloatArray
) -> None:
    """Enthalpy through the surface at the three stages, d/dx in J/m3 of solution at the start, counted from the liquid and
    the polymer at the air's temperature.
    """
    m = share.size
    sub, _, air = heat
    for k in range(3):
        left = 0.0
        for i in range(m):
            left += share[i] * (1 + y[i] + stages[k, i])
        left *= air[3]
        kelvin = y[m] + stages[k, m]
        gone, heating = surface_rates(y[m - 1] + stages[k, m - 1], kelvin, left, heat, places[k + 1])
        out[k] = places[k + 1, 2] * air[3] * (heating + gone * sub[0, 0] * sub[0, 2] * (kelvin - air[1]))


@njit(cache=True, error_model="numpy")
def _everything(
    y: FloatArray,
    share: FloatArray,
    table: FloatArray,
    air: FloatArray,
    heat: Heat,
    place: FloatArray,
    flux: FloatArray,
    inner: FloatArray,
    outer: FloatArray,
    out: FloatArray,
) -> float:
    """dy/dx of cells, temperature and loss; returns the volume left, NaN where it cannot be."""
    m = share.size
    left = fluxes(y[:m], share, table, air, place, flux, inner, outer)
    pace = place[2]
    if heat[0].shape[0] > 0:
        if not 120.0 <= y[m] <= 480.0:
            return np.nan
        gone, heating = surface_rates(y[m - 1], y[m], left, heat, place)
        if not np.isfinite(heating):
            return np.nan
        flux[m - 1] = gone
        out[m] = _warming(left, heat, place) * heating
    out[0] = pace * flux[0] / share[0]
    for i in range(1, m):
        out[i] = pace * (flux[i] - flux[i - 1]) / share[i]
    out[y.size - 1] = -pace * flux[m - 1]
    return float(left)


@njit(cache=True, error_model="numpy")
def attempt(
    y: FloatArray,
    h: float,
    guess: FloatArray,
    scale: FloatArray,
    tolerance: float,
    share: FloatArray,
    table: FloatArray,
    air: FloatArray,
    heat: Heat,
    places: FloatArray,
    stages: FloatArray,
    first: FloatArray,
    error: FloatArray,
    through: FloatArray,
) -> tuple[int, float, float]:
    """One step: stages (3, n + 1) as changes of y, rates at the start, and the error; n rows are m cells, and with heat
    the temperature, and what `_book` says goes to `through`.

    `places` are stretch, speed, pace (exposure over the polymer) and, with heat, speed across at the start and at the
    three stages, (4, 3 or 4).

    Returns
    -------
    iterations : int
        0 if they do not converge.
    contraction : float
        Of the last iteration.
    size : float
        Norm of the error.
    """
    m, n = share.size, y.size - 1
    warm = n > m
    flux, inner, outer, at = np.empty(m), np.empty(m), np.empty(m), np.empty(n + 1)
    left = _everything(y, share, table, air, heat, places[0], flux, inner, outer, first)
    if not np.isfinite(left):
        return 0, 0.0, 0.0
    low, mid, high = np.empty(n), np.empty(n), np.empty(n)
    pace, by_heat = places[0, 2], 0.0
    if warm:
        du, dt = 1e-6 * max(y[m - 1], 1e-8), 1e-4
        gone, heating = surface_rates(y[m - 1], y[m], left, heat, places[0])
        wetter, wetter_heat = surface_rates(y[m - 1] + du, y[m], left, heat, places[0])
        warmer, warmer_heat = surface_rates(y[m - 1], y[m] + dt, left, heat, places[0])
        inner[m - 1], outer[m - 1] = (wetter - gone) / du, 0.0
        warming = _warming(left, heat, places[0])
        low[m], mid[m] = warming * (wetter_heat - heating) / du, warming * (warmer_heat - heating) / dt
        by_heat = -pace * (warmer - gone) / dt  # of the loss
    bands(inner, outer, share, pace, low[:m], mid[:m], high[:m])
    if warm:
        high[m - 1], high[m] = -by_heat / share[m - 1], 0.0
    by_cell = -pace * inner[m - 1]
    real, pair = np.empty(n), np.empty(n, np.complex128)
    factor(low, mid, high, MU / h, real)
    factor(low, mid, high, MU_PAIR / h, pair)
    w, turned, rates = np.empty((3, n + 1)), np.empty((3, n + 1)), np.empty((3, n + 1))
    turn(TI, guess, w)
    for k in range(3):
        for i in range(n + 1):
            stages[k, i] = guess[k, i]
    right, both = np.empty(n + 1), np.empty(n + 1, np.complex128)
    before, contraction, done = -1.0, 0.0, 0
    most = 10 if warm else 8
    for iteration in range(1, most + 1):
        for k in range(3):
            for i in range(n + 1):
                at[i] = y[i] + stages[k, i]
                if i < m and not -0.3 < at[i] < 1e300:
                    return 0, contraction, 0.0
            if not np.isfinite(_everything(at, share, table, air, heat, places[k + 1], flux, inner, outer, rates[k])):
                return 0, contraction, 0.0
        turn(TI, rates, turned)
        for i in range(n + 1):
            right[i] = turned[0, i] - MU / h * w[0, i]
            both[i] = turned[1, i] + 1j * turned[2, i] - MU_PAIR / h * (w[1, i] + 1j * w[2, i])
        solve(low, high, real, right)
        solve(low, high, pair, both)
        right[n] += by_cell * right[m - 1]
        both[n] += by_cell * both[m - 1]
        if warm:
            right[n] += by_heat * right[m]
            both[n] += by_heat * both[m]
        right[n] *= h / MU
        both[n] *= h / MU_PAIR
        size = 0.0
        for i in range(n + 1):
            size += (right[i] ** 2 + both[i].real ** 2 + both[i].imag ** 2) / scale[i] ** 2
            w[0, i] += right[i]
            w[1, i] += both[i].real
            w[2, i] += both[i].imag
        size = np.sqrt(size / (3 * (n + 1)))
        turn(T, w, stages)
        if not np.isfinite(size):
            return 0, contraction, 0.0
        if before > 0:
            contraction = size / before
            if contraction >= 1 or contraction ** (most - iteration) / (1 - contraction) * size > tolerance:
                return 0, contraction, 0.0
        if size == 0 or (before > 0 and contraction / (1 - contraction) * size < tolerance):
            done = iteration
            break
        before = size
    if not done:
        return 0, contraction, 0.0
    for i in range(n + 1):
        error[i] = first[i] + (ERROR[0] * stages[0, i] + ERROR[1] * stages[1, i] + ERROR[2] * stages[2, i]) / h
    solve(low, high, real, error)
    error[n] = (error[n] + by_cell * error[m - 1] + (by_heat * error[m] if warm else 0.0)) * h / MU
    if warm:
        _book(y, stages, share, heat, places, through)
    size = 0.0
    for i in range(n + 1):
        size += (error[i] / scale[i]) ** 2
    return done, contraction, float(np.sqrt(size / (n + 1)))
