"""Compiled loops of the two-fluid box scheme: residual and Jacobian, Newton's method. What it solves stands in `two_fluid`."""

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from spinline.base.checks import BoolArray, FloatArray
from spinline.base.kernels import njit
from spinline.network._force_kernels import LINEAR, extension_kernel
from spinline.network.chain._kernels import compliance_kernel

__all__ = ["Cells", "Law", "newton"]

Cells: TypeAlias = tuple[FloatArray, FloatArray, FloatArray, FloatArray, BoolArray]
"""Of every cell its length; V, eps and 1/(2 th) at its four collocation points; and whether its strands relax fast."""
Law: TypeAlias = tuple[int, float, float, float]
"""Code, contour, force and tension at rest."""

_BELOW = 4  # diagonals below and above the main one
_WIDE = 3 * _BELOW + 1  # of a row, with what pivoting fills in
_MOST_NEWTON = 60
_LARGEST_STEP = 2.0  # of ln T and of q
_MOST_TRIES = 180
_SHORTEST = 1e-4
_TOLERANCE = 1e-10
_ROUNDING = 1e-6  # of a change that does not shrink any more
_HUGE = 1e100

_AHEAD, _LATE = 2.0 / 3.0, 1.0 / 3.0
_SLACK = 0.05  # of the tension at rest: below, a strand's law is carried on so that its stretch stays positive


@njit(cache=True, error_model="numpy")
def _lay(bands: FloatArray, row: int, column: int, value: float) -> None:
    bands[row, _BELOW + column - row] = value


@njit(cache=True, error_model="numpy")
def _assemble(
    y: FloatArray,
    cells: Cells,
    law: Law,
    per_line: bool,
    plain: bool,
    end: float,
    bands: FloatArray,
    load: FloatArray,
) -> None:
    """Set the Jacobian (a row of `bands` holds the columns from four before its diagonal on) and the residual (load).

    `y` holds T (ln T for the linear spring) and q at node, middle, node, ... The collocation points are 0 and 2/3 of a cell
    for the momentum, 1/3 and 1 for the relaxation, the other way round where strands relax fast. `plain` is the scheme of
    first order, for guesses.
    """
    h, flow, eps, slow, fast = cells
    code, contour, rest, rest_tension = law
    line = 0.0 if per_line else 1.0
    bands[:] = 0.0
    load[0] = y[1]
    _lay(bands, 0, 1, 1.0)
    last = load.size - 1
    load[last] = y[last - 1] - end
    _lay(bands, last, last - 1, 1.0)
    value = np.empty(3)
    slope = np.empty(3)
    for i in range(h.size):
        at = 4 * i
        for k in range(4):
            c = 0.0 if k == 0 else _AHEAD if k == 1 else _LATE if k == 2 else 1.0
            row = at + 1 + k
            if plain:  # straight lines: the momentum at the upstream node, the relaxation at the downstream one
                value[0], value[1], value[2] = 1 - c, 0.0, c
                slope[0], slope[1], slope[2] = -1.0, 0.0, 1.0
                if k == 1 or k == 2:
                    first = at + k - 1
                    load[row] = y[first + 2] - 0.5 * (y[first] + y[first + 4])
                    _lay(bands, row, first, -0.5)
                    _lay(bands, row, first + 2, 1.0)
                    _lay(bands, row, first + 4, -0.5)
                    continue
            else:
                value[0], value[1], value[2] = (2 * c - 3) * c + 1, 4 * c * (1 - c), (2 * c - 1) * c
                slope[0], slope[1], slope[2] = 4 * c - 3, 4 - 8 * c, 4 * c - 1
            height = value[0] * y[at] + value[1] * y[at + 2] + value[2] * y[at + 4]
            climb = slope[0] * y[at] + slope[1] * y[at + 2] + slope[2] * y[at + 4]
            q = value[0] * y[at + 1] + value[1] * y[at + 3] + value[2] * y[at + 5]
            fall = slope[0] * y[at + 1] + slope[1] * y[at + 3] + slope[2] * y[at + 5]
            if code == LINEAR:
                t = math.exp(min(height, 690.0))
                lam = t
                soft = 1.0
                step = t  # dT/dy
                climb *= t  # dT/dx
            else:
                t = height
                floor = max(t, _SLACK * rest_tension)
                lam = contour * extension_kernel(code, floor * rest, rest)
                soft = 3 * compliance_kernel(code, floor * rest, rest)
                if t < floor:  # within a box that a front crosses the parabola may dip: lam goes on, positive
                    fade = math.exp((t - floor) * soft / lam)
                    lam *= fade
                    soft *= fade
                step = 1.0
            soft *= step
            share = math.exp(q)
            if (k < 2) != fast[i]:
                weight = eps[i, k] / h[i] * math.exp(line * q)
                rise = weight * (climb + line * t * fall)
                ratio = flow[i, k] * share / lam
                load[row] = rise - (1 - ratio)
                by_t = weight * line * fall * step - ratio * soft / lam
                if code == LINEAR:
                    by_t += weight * climb
                by_q = line * rise + ratio
                for j in range(3):
                    _lay(bands, row, at + 2 * j, weight * step * slope[j] + by_t * value[j])
                    _lay(bands, row, at + 2 * j + 1, weight * line * t * slope[j] + by_q * value[j])
            else:
                decay = h[i] * slow[i, k] * share / (lam * lam)
                if per_line:
                    slack = lam - 1
                    stiff = soft
                else:
                    slack = t - rest_tension / lam
                    stiff = step + rest_tension / (lam * lam) * soft
                load[row] = fall + decay * slack
                by_t = decay * (stiff - 2 * slack * soft / lam)
                by_q = decay * slack
                for j in range(3):
                    _lay(bands, row, at + 2 * j, by_t * value[j])
                    _lay(bands, row, at + 2 * j + 1, slope[j] + by_q * value[j])


@njit(cache=True, error_model="numpy")
def _factor(bands: FloatArray, lower: FloatArray, pivots: NDArray[np.int64]) -> bool:
    """LU factors with partial pivoting, in place; False where a pivot is nothing or no number."""
    n = bands.shape[0]
    for i in range(n):
        best, at = abs(bands[i, _BELOW]), i
        last = min(i + _BELOW, n - 1)
        for row in range(i + 1, last + 1):
            size = abs(bands[row, _BELOW + i - row])
            if size > best:
                best, at = size, row
        pivots[i] = at
        if not (best > 0 and best < math.inf):
            return False
        if at != i:
            shift = _BELOW + i - at
            for k in range(2 * _BELOW + 1):
                bands[i, _BELOW + k], bands[at, shift + k] = bands[at, shift + k], bands[i, _BELOW + k]
        inverse = 1 / bands[i, _BELOW]
        for row in range(i + 1, last + 1):
            shift = _BELOW + i - row
            part = bands[row, shift] * inverse
            lower[i, row - i - 1] = part
            if part != 0:
                for k in range(1, 2 * _BELOW + 1):
                    bands[row, shift + k] -= part * bands[i, _BELOW + k]
    return True


@njit(cache=True, error_model="numpy")
def _substitute(bands: FloatArray, lower: FloatArray, pivots: NDArray[np.int64], load: FloatArray) -> None:
    """Solve with the factors, in place."""
    n = load.size
    for i in range(n):
        at = pivots[i]
        load[i], load[at] = load[at], load[i]
        for row in range(i + 1, min(i + _BELOW, n - 1) + 1):
            load[row] -= lower[i, row - i - 1] * load[i]
    for i in range(n - 1, -1, -1):
        total = load[i]
        for k in range(1, min(2 * _BELOW, n - 1 - i) + 1):
            total -= bands[i, _BELOW + k] * load[i + k]
        load[i] = total / bands[i, _BELOW]


@njit(cache=True, error_model="numpy")
def _size(change: FloatArray, scale: FloatArray, linear: bool) -> tuple[float, float, float]:
    """Sum of squares of a scaled change, its largest, and its largest in q (in ln T, too, for the linear spring)."""
    total, largest, steep = 0.0, 0.0, 0.0
    for i in range(change.size):
        value = abs(change[i] * scale[i])
        largest = max(largest, value)
        if linear or i % 2:
            steep = max(steep, value)
        if value > _HUGE:
            value = _HUGE
        total += value * value
    if math.isnan(total):
        return math.nan, math.nan, math.nan
    return total, largest, steep


# Written out: of ``a[:] = b`` and ``a -= b`` numba compiles the message for shapes that do not fit, too, for seconds.


@njit(cache=True, error_model="numpy")
def _set(out: FloatArray, values: FloatArray) -> None:
    for i in range(out.size):
        out[i] = values[i]


@njit(cache=True, error_model="numpy")
def _subtract(out: FloatArray, values: FloatArray) -> None:
    for i in range(out.size):
        out[i] -= values[i]


@njit(cache=True, error_model="numpy")
def newton(
    y: FloatArray,
    cells: Cells,
    law: Law,
    per_line: bool,
    plain: bool,
    end: float,
) -> bool:
    """Damped Newton iteration on `y`, in place; False where it fails. Arguments as those of `_assemble`."""
    n = y.size
    bands, trial = np.empty((n, _WIDE)), np.empty((n, _WIDE))
    lower, pivots = np.zeros((n, _BELOW)), np.empty(n, np.int64)
    change, following, load, ahead = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    scale, linear = np.ones(n), law[0] == LINEAR  # whose unknown is ln T: needs no scale
    _assemble(y, cells, law, per_line, plain, end, bands, load)
    damping, previous, tries = 1.0, math.inf, 0
    for _ in range(_MOST_NEWTON):
        if not _factor(bands, lower, pivots):
            return False
        _set(change, load)
        _substitute(bands, lower, pivots, change)
        if not linear:
            for i in range(0, n, 2):
                scale[i] = 1 / max(abs(y[i]), 1.0)
        size, largest, steep = _size(change, scale, linear)
        if not largest < 1e200:
            return False
        if largest < _TOLERANCE or (largest < _ROUNDING and largest > 0.2 * previous):
            _subtract(y, change)
            return True
        previous = largest
        damping = min(1.0, 4 * damping, _LARGEST_STEP / max(steep, 1e-300))
        while True:  # the next change, by the same matrix, must be smaller: affine invariant
            for i in range(n):
                ahead[i] = y[i] - damping * change[i]
            _assemble(ahead, cells, law, per_line, plain, end, trial, load)
            tries += 1
            _set(following, load)
            _substitute(bands, lower, pivots, following)
            total, rest, _ = _size(following, scale, linear)
            if total <= (1 - 0.25 * damping) ** 2 * size:
                break
            damping *= 0.5
            if damping < _SHORTEST or tries > _MOST_TRIES:
                return False
        _set(y, ahead)
        if damping == 1 and rest < 0.1 * largest and rest * rest < _TOLERANCE * largest:
            _subtract(y, following)  # what the same matrix leaves after it is below the tolerance: rest/largest of it
            return True
        bands, trial = trial, bands
    return False
