"""Rates of a drying jet with heat in compiled loops, and a step of Radau's method on them.

State: logarithms of the solvents' volumes over their starts (plain volumes for what is only in the air), temperature.
Beside it a ledger: the mass of every liquid that has passed the surface, and the enthalpy. `_settle` takes the state
after a step from the ledger, so that both are conserved to rounding: the stages give volumes and temperature to the
order of the method either way.
"""

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.rheology._drying_kernels import DENSE, ERROR, MU, NODES, STAGES
from spinline.rheology._elimination import eliminate

__all__ = ["GAS", "activities", "advance", "rates", "stride", "surface"]

GAS = 8.31446261815324
_AIR_MASS = 0.0289644
_AIR_CP = 1006.0
_EPS = 2.220446049250313e-16
_LOW, _STEP = 120.0, 3.0  # evaporant.GRID
_MOST_STEPS = 50_000
_AGREE = 0.1  # of the logarithm of a volume: where the ledger's differs by more, the stages' is taken


@njit(cache=True, error_model="numpy")
def _law(table: FloatArray, temperature: float) -> float:
    at = min(max(int((temperature - _LOW) / _STEP), 0), table.shape[1] - 1)
    t = temperature - _LOW - at * _STEP
    return float(((table[0, at] * t + table[1, at]) * t + table[2, at]) * t + table[3, at])


@njit(cache=True, error_model="numpy")
def _number(law: int, along: float, across: float, schmidt: float, floor: float) -> float:
    if law == 1:
        re = np.sqrt(along * along + across * across)
        fall = (1 + (0.4 / schmidt) ** (2 / 3)) ** -0.25
        value = 0.3 + 0.62 * np.sqrt(re) * np.cbrt(schmidt) * fall * (1 + (re / 282000) ** 0.625) ** 0.8
    else:
        speed = along if law == 2 else np.sqrt(along * along + 64 * across * across)
        value = 0.495 * np.cbrt(speed) * np.sqrt(schmidt)
    return float(max(value, floor))


@njit(cache=True, error_model="numpy")
def activities(
    volumes: FloatArray, phi0: float, sub: FloatArray, pairs: FloatArray, unit: float, out: FloatArray
) -> float:
    """Activities of the liquids, Flory-Huggins (or Raoult with the polymer's molar volume `unit`); returns the volume
    left. Not compiled, it takes volumes (liquid, place) at many places as well.
    """
    n = sub.shape[0]
    total = phi0
    for i in range(n):
        total += volumes[i]
    polymer = phi0 / total
    pull = 0.0
    for j in range(n):
        pull += volumes[j] / total * polymer * sub[j, 5] / sub[j, 9]
        for k in range(j):
            pull += volumes[j] / total * volumes[k] / total * pairs[j, k]
    for i in range(n):
        others, crowding, own = polymer, 0.0, polymer * sub[i, 5] / sub[i, 9]
        for j in range(n):
            if j != i:
                share = volumes[j] / total
                others = others + share  # not in place
                crowding += share * sub[i, 9] / sub[j, 9]
                own += share * pairs[i, j]
        if unit > 0:
            log = -np.log1p(crowding + polymer * sub[i, 9] / unit - others)
        else:
            log = others - crowding + sub[i, 9] * (own - pull)
        out[i] = volumes[i] / total * np.exp(log)
    return total


@njit(cache=True, error_model="numpy")
def surface(
    activity: FloatArray,
    left: float,
    kelvin: float,
    sub: FloatArray,
    tables: FloatArray,
    air: FloatArray,
    place: FloatArray,
    flux: FloatArray,
) -> tuple[float, float, float]:
    """Mass fluxes over pi and a length (kg/m/s) of every liquid, and heat: from the air, with the vapour; Re.

    `sub` rows: density, molar mass, heat capacity, vapour heat capacity, diffusivity at 298.15 K, chi, pressure far
    away, inside (1 or 0), log of the volume at the start, molar volume. `air`: pressure, temperature, floor, phi_0,
    r_0, wind, kept, law, polymer's heat capacity by volume, its molar volume for Raoult's law, Stefan (1 or 0).
    `place`: stretch, speed along the jet, across it, pace. Returns (nan, 0, 0) where the liquid boils.
    """
    n = activity.size
    p, warm = air[0], air[1]
    film = 0.5 * (kelvin + warm)
    density = p * _AIR_MASS / (GAS * film)
    mu = 1.458e-6 * film**1.5 / (film + 110.4)
    nu = mu / density
    conductivity = 2.64638e-3 * film**1.5 / (film + 245.4 * 10 ** (-12 / film))
    prandtl = mu * _AIR_CP / conductivity
    speed = place[1]
    radius = air[4] / np.sqrt(place[0])
    if air[6] > 0:
        along = 2 * radius * abs(left * speed - air[5]) / nu
    else:
        radius = radius * np.sqrt(left)
        along = 2 * radius * abs(speed - air[5]) / nu
    across = 2 * radius * place[2] / nu
    law = int(air[7])
    here, there = 0.0, 0.0
    for i in range(n):
        sat = np.exp(_law(tables[i, 0], kelvin))
        dimer = _law(tables[i, 2], kelvin)
        a = activity[i]
        at = sat * a * (1 - dimer + a * dimer)
        spread = sub[i, 4] * (film / 298.15) ** 1.75
        number = _number(law, along, across, nu / spread, air[2])
        slower = _dimer_diffusion(sub[i, 1])
        heavy = 2 * slower * _number(law, along, across, nu / (spread * slower), air[2]) / number if dimer > 0 else 0.0
        push = sat * a * (1 - dimer) + heavy * sat * a * a * dimer
        flux[i] = spread * number * sub[i, 1] / (GAS * film) * (push - sub[i, 6])
        here += at
        there += sub[i, 6]
    if here >= p:
        return np.nan, 0.0, 0.0
    if air[10] > 0:
        x = (here - there) / (p - here)
        factor = p / (p - here) * (1 - x / 2 + x * x / 3 if abs(x) < 1e-5 else np.log1p(x) / x)
        for i in range(n):
            flux[i] *= factor
    nusselt = _number(law, along, across, prandtl, air[2])
    carried, ackermann = 0.0, 0.0
    for i in range(n):
        carried += flux[i] * _law(tables[i, 1], kelvin)
        ackermann += flux[i] * sub[i, 3]
    b = ackermann / (nusselt * conductivity) if air[10] > 0 else 0.0
    reduced = 1 - b / 2 + b * b / 12 if abs(b) < 1e-4 else b / np.expm1(b)
    return nusselt * conductivity * (warm - kelvin) * reduced, carried, along


@njit(cache=True, error_model="numpy")
def _dimer_diffusion(mass: float) -> float:
    """Diffusivity of a dimer over the monomer's: Fuller, twice the mass and the volume (32.7 of formic, 53.3 of acetic
    acid).
    """
    monomer, dimer = mass * 1e3, 2e3 * mass
    volume = 32.74 if monomer < 53 else 53.26
    reduced = np.sqrt((1 / dimer + 1 / 28.9644) / (1 / monomer + 1 / 28.9644))
    ratio = (volume ** (1 / 3) + 19.7 ** (1 / 3)) / ((2 * volume) ** (1 / 3) + 19.7 ** (1 / 3))
    return float(reduced * ratio * ratio)


@njit(cache=True, error_model="numpy")
def rates(
    y: FloatArray,
    sub: FloatArray,
    tables: FloatArray,
    pairs: FloatArray,
    air: FloatArray,
    place: FloatArray,
    out: FloatArray,
    ledger: FloatArray,
) -> bool:
    """dy/dx, and the ledger's; False where the liquid boils or the temperature leaves the tables."""
    n = sub.shape[0]
    kelvin = float(y[n])
    if not (_LOW <= kelvin <= 480.0):
        return False
    volumes, activity, flux = np.empty(n), np.empty(n), np.empty(n)
    heat = air[3] * air[8]
    for i in range(n):
        volumes[i] = np.exp(sub[i, 8] + y[i]) if sub[i, 7] > 0 else y[i]
        heat += volumes[i] * sub[i, 0] * sub[i, 2]
    left = activities(volumes, air[3], sub, pairs, air[9], activity)
    if not left > 0:
        return False
    warmed, carried, _ = surface(activity, left, kelvin, sub, tables, air, place, flux)
    if not np.isfinite(warmed):
        return False
    pace = place[3]
    ledger[n] = pace * (warmed - carried)
    for i in range(n):
        out[i] = -pace * flux[i] / sub[i, 0]
        if sub[i, 7] > 0:  # a logarithm; past 1e-260 of the jet it comes to rest
            log = sub[i, 8] + y[i]
            out[i] /= max(volumes[i], 1e-300) * (1 + np.exp(min(-0.1 * (log + 600.0), 300.0)))
        ledger[i] = pace * flux[i]
        ledger[n] -= pace * flux[i] * sub[i, 2] * (kelvin - air[1])
    out[n] = pace * (warmed - carried) / heat
    return True


@njit(cache=True, error_model="numpy")
def _jacobian(
    y: FloatArray,
    first: FloatArray,
    sub: FloatArray,
    tables: FloatArray,
    pairs: FloatArray,
    air: FloatArray,
    place: FloatArray,
) -> FloatArray:
    n = y.size
    matrix, moved, ledger, at = np.empty((n, n)), np.empty(n), np.empty(n), np.empty(n)
    for j in range(n):
        at[j] = y[j]
    for j in range(n):
        step = 1e-6 * max(abs(y[j]), 1e-3)
        at[j] = y[j] + step
        known = rates(at, sub, tables, pairs, air, place, moved, ledger)
        for i in range(n):
            matrix[i, j] = (moved[i] - first[i]) / step if known else 0.0
        at[j] = y[j]
    return matrix


@njit(cache=True, error_model="numpy")
def _capacity(y: FloatArray, sub: FloatArray, air: FloatArray) -> float:
    """Heat capacity by volume at the start, J/m3/K."""
    total = air[3] * air[8]
    for i in range(sub.shape[0]):
        total += (np.exp(sub[i, 8] + y[i]) if sub[i, 7] > 0 else y[i]) * sub[i, 0] * sub[i, 2]
    return float(total)


@njit(cache=True, error_model="numpy")
def _along_step(stages: FloatArray, i: int, t: float) -> float:
    """Change of the i-th unknown at a fraction t of a step: the collocation polynomial."""
    change = 0.0
    for p in range(2, -1, -1):
        change = t * (change + DENSE[p, 0] * stages[0, i] + DENSE[p, 1] * stages[1, i] + DENSE[p, 2] * stages[2, i])
    return float(change)


@njit(cache=True, error_model="numpy")
def _settle(
    y: FloatArray,
    ledger: FloatArray,
    stages: FloatArray,
    ticks: FloatArray,
    theta: FloatArray,
    sub: FloatArray,
    air: FloatArray,
    out: FloatArray,
    book: FloatArray,
) -> float:
    """States `out` and ledgers `book`, (theta, n + 1), at fractions of a step from `y` and `ledger`.

    Both by the collocation polynomial; volumes and temperature are then those that the ledger leaves. Where a volume falls
    so far within a step that the ledger's difference is all error, its logarithm goes as the stages say, and so does what a
    liquid that only the air may bring (no logarithm) has left of nothing, its ledger with it; returns the largest volume
    that is so lost from the books at the end of the step, over the jet's at the start.
    """
    lost = 0.0
    n = sub.shape[0]
    enthalpy = _capacity(y, sub, air) * (y[n] - air[1])
    for k in range(theta.size):
        t = theta[k]
        for i in range(n + 1):
            change, passed = _along_step(stages, i, t), _along_step(ticks, i, t)
            book[k, i] = ledger[i] + passed
            if i == n:
                out[k, n] = air[1] + (enthalpy + passed) / _capacity(out[k], sub, air)
            elif sub[i, 7] > 0:
                before = np.exp(sub[i, 8] + y[i])
                kept = 1 - passed / (sub[i, 0] * before)
                own = np.log(kept) if kept > 0 else -np.inf
                if abs(own - change) < _AGREE:
                    out[k, i] = y[i] + own
                else:
                    out[k, i] = y[i] + change
                    if t == 1:
                        lost = max(lost, abs(kept - np.exp(change)) * before)
            else:
                out[k, i] = y[i] - passed / sub[i, 0]
                if abs(out[k, i] - y[i] - change) > _AGREE * abs(y[i] + change):  # in balance with air that has none
                    out[k, i] = y[i] + change
                    book[k, i] = ledger[i] - sub[i, 0] * change
    return float(lost)


@njit(cache=True, error_model="numpy")
def _attempt(
    y: FloatArray,
    ledger: FloatArray,
    h: float,
    guess: FloatArray,
    scale: FloatArray,
    tolerance: float,
    sub: FloatArray,
    tables: FloatArray,
    pairs: FloatArray,
    air: FloatArray,
    places: FloatArray,
    stages: FloatArray,
    theta: FloatArray,
    out: FloatArray,
    book: FloatArray,
) -> tuple[int, float, float]:
    """One step of size h: stages (3, n + 1) as changes of y; iterations (0: none), size of the error, and where that is no
    more than 1 what `_settle` says.

    `places` at the start and at the three stages, (4, 4).
    """
    n = y.size
    first, counts = np.empty(n), np.empty((3, n))
    if not rates(y, sub, tables, pairs, air, places[0], first, counts[0]):
        return 0, 0.0, 0.0
    jacobian = _jacobian(y, first, sub, tables, pairs, air, places[0])
    for k in range(3):
        for i in range(n):
            stages[k, i] = guess[k, i]
    matrix, right = np.empty((3 * n, 3 * n)), np.empty(3 * n)
    slopes, ticks, at = np.empty((3, n)), np.empty((3, n)), np.empty(n)
    before, done = -1.0, 0
    for iteration in range(1, 11):
        for k in range(3):
            for i in range(n):
                at[i] = y[i] + stages[k, i]
            if not rates(at, sub, tables, pairs, air, places[k + 1], slopes[k], counts[k]):
                return 0, 0.0, 0.0
        for k in range(3):
            for i in range(n):
                row, total = k * n + i, 0.0
                for m in range(3):
                    total += STAGES[k, m] * slopes[m, i]
                    for j in range(n):
                        matrix[row, m * n + j] = -h * STAGES[k, m] * jacobian[i, j]
                matrix[row, row] += 1.0
                right[row] = h * total - stages[k, i]
        if not eliminate(matrix, right):
            return 0, 0.0, 0.0
        size = 0.0
        for k in range(3):
            for i in range(n):
                stages[k, i] += right[k * n + i]
                size += (right[k * n + i] / scale[i]) ** 2
        size = np.sqrt(size / (3 * n))
        if not np.isfinite(size):
            return 0, 0.0, 0.0
        if before > 0 and size >= before and size > tolerance:
            return 0, 0.0, 0.0
        contraction = size / before if before > 0 else 1.0
        settled = before > 0 and contraction < 1 and contraction / (1 - contraction) * size < tolerance
        if settled or size < 1e-3 * tolerance:
            done = iteration
            break
        before = size
    if not done:
        return 0, 0.0, 0.0
    for k in range(3):
        for i in range(n):
            at[i] = y[i] + stages[k, i]
        rates(at, sub, tables, pairs, air, places[k + 1], slopes[k], counts[k])
    for k in range(3):
        for c in range(n):
            ticks[k, c] = h * (STAGES[k, 0] * counts[0, c] + STAGES[k, 1] * counts[1, c] + STAGES[k, 2] * counts[2, c])
    error, real = np.empty(n), np.empty((n, n))
    for i in range(n):
        error[i] = first[i] + (ERROR[0] * stages[0, i] + ERROR[1] * stages[1, i] + ERROR[2] * stages[2, i]) / h
        for j in range(n):
            real[i, j] = -jacobian[i, j]
        real[i, i] += MU / h
    if not eliminate(real, error):
        return 0, 0.0, 0.0
    size = 0.0
    for i in range(n):
        size += (error[i] / scale[i]) ** 2
    size = float(np.sqrt(size / n))
    return done, size, _settle(y, ledger, stages, ticks, theta, sub, air, out, book) if size <= 1 else 0.0


@njit(cache=True, error_model="numpy")
def stride(x: float, h: float, stop: float) -> tuple[float, bool]:
    """The step that `advance` tries next from x, and whether it ends at `stop`: h, or all the way where little is left."""
    last = x + h >= stop or stop - x - h < 0.05 * h
    return (stop - x if last else h), last


@njit(cache=True, error_model="numpy")
def _guess(stages: FloatArray, ratio: float, out: FloatArray) -> None:
    """Stages of a step `ratio` times as long as the last one, by the last one's collocation polynomial."""
    for i in range(stages.shape[1]):
        for k in range(3):
            out[k, i] = _along_step(stages, i, 1 + NODES[k] * ratio) - stages[2, i]


@njit(cache=True, error_model="numpy")
def _shares(x: float, step: float, reach: float, marks: FloatArray) -> FloatArray:
    """Fractions of a step at which the next of the marks are passed, and its end."""
    passed = 0
    while passed < marks.size and marks[passed] <= reach:
        passed += 1
    value = np.ones(passed + 1)
    for k in range(passed):
        value[k] = min((marks[k] - x) / step, 1.0)
    return value


@njit(cache=True, error_model="numpy")
def advance(
    x: float,
    h: float,
    stop: float,
    once: bool,
    shortest: float,
    rtol: float,
    unbooked: float,
    count: NDArray[np.int64],
    old: float,
    stages: FloatArray,
    y: FloatArray,
    ledger: FloatArray,
    sub: FloatArray,
    tables: FloatArray,
    pairs: FloatArray,
    air: FloatArray,
    places: FloatArray,
    marks: FloatArray,
    values: FloatArray,
    ledgers: FloatArray,
) -> tuple[float, float, float]:
    """Steps with error control from x until `stop`, or one trial where the places change with x (`once`).

    In place: y, its `ledger`, the last step's `stages`, and `values` and `ledgers`, (mark, n + 1), at the marks that were
    passed; `count`: trials, marks passed. Returns x, the next step and the last one (0: `stages` lead nowhere); a next step
    of 0 where no step is short enough.
    """
    n = y.size
    scale, guess, trial = np.empty(n), np.empty((3, n)), np.empty((3, n))
    tolerance = max(10 * _EPS / rtol, min(0.03, rtol**0.5))
    while x < stop:
        count[0] += 1
        if count[0] > _MOST_STEPS or h < max(16 * _EPS * abs(x), shortest):
            return x, 0.0, old
        step, last = stride(x, h, stop)
        for i in range(n - 1):
            scale[i] = 1e-4 * rtol + rtol * abs(y[i])
        scale[n - 1] = 10 * rtol
        if old > 0:
            _guess(stages, step / old, guess)
        else:
            guess[:] = 0.0
        share = _shares(x, step, stop if last else x + step, marks[count[1] :])
        begin, beyond = count[1], count[1] + share.size - 1
        states, booked = np.empty((share.size, n)), np.empty((share.size, n))
        iterations, size, lost = _attempt(
            y, ledger, step, guess, scale, tolerance, sub, tables, pairs, air, places, trial, share, states, booked
        )
        if not iterations or not size <= 1:
            shrink = 0.25 if not iterations else max(0.2, 0.9 * size**-0.25)
            h, old = (0.5 if old > 0 and not iterations else shrink) * step, 0.0
        elif lost > unbooked:
            h, old = 0.5 * step, 0.0
        else:
            for i in range(n):  # not as slices: numba would compile the message of shapes that do not fit
                for k in range(begin, beyond):
                    values[k, i], ledgers[k, i] = states[k - begin, i], booked[k - begin, i]
                y[i], ledger[i] = states[beyond - begin, i], booked[beyond - begin, i]
                for k in range(3):
                    stages[k, i] = trial[k, i]
            x, old, count[1] = (stop if last else x + step), step, beyond
            h = step * min(6.0, max(0.2, 0.9 * size**-0.25 if size > 0 else 6.0))
        if once:
            break
    return x, h, old
