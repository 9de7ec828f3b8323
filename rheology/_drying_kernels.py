"""Radial drying in compiled loops: fluxes between cells, their Jacobian, and a step of Radau's method on it.

The Jacobian holds what is stiff, diffusion between neighbours and the loss of the outermost cell; that a flux also depends on
all the volume inside it (X) and the Sherwood number on all that is left is slow, and left to the Newton iteration. Its columns
are differences of fluxes, so that both masses are conserved to rounding however far an iteration has come.

Radau IIA, three stages, order 5 (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.8): one real and one complex
tridiagonal system a step.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["NODES", "STAGES", "attempt", "fluxes", "interpolate"]

_S6 = 6.0**0.5
NODES = np.array([(4 - _S6) / 10, (4 + _S6) / 10, 1.0])
_ERROR = np.array([-13 - 7 * _S6, -13 + 7 * _S6, -1.0]) / 3
_POWERS = np.arange(3)
STAGES = (NODES[:, np.newaxis] ** (_POWERS + 1) / (_POWERS + 1)) @ np.linalg.inv(NODES[:, np.newaxis] ** _POWERS)


def _transformed() -> tuple[float, complex, FloatArray, FloatArray]:
    """Eigenvalues of the inverse of Radau's matrix, one real and one of the pair, with the real basis that splits them."""
    values, vectors = np.linalg.eig(np.linalg.inv(STAGES))
    real = int(np.argmin(np.abs(values.imag)))
    pair = int(np.argmax(values.imag))
    basis = np.column_stack((vectors[:, real].real, vectors[:, pair].real, vectors[:, pair].imag))
    return float(values[real].real), complex(values[pair].conjugate()), basis, np.linalg.inv(basis)


MU, MU_PAIR, _T, _TI = _transformed()
# u(x_0 + theta h) - u(x_0) = sum_k Q_k theta^k, from the stages
_DENSE = np.linalg.inv(NODES[:, np.newaxis] ** (_POWERS + 1))


@njit(cache=True, error_model="numpy")
def _law(phi: float, table: FloatArray) -> tuple[float, float]:
    """D and dD/dphi from cubic pieces of ln D on an even grid of [0, 1]."""
    pieces = table.shape[1]
    at = min(max(int(phi * pieces), 0), pieces - 1)
    t = phi - at / pieces
    c3, c2, c1, c0 = table[0, at], table[1, at], table[2, at], table[3, at]
    value = np.exp(((c3 * t + c2) * t + c1) * t + c0)
    return value, value * ((3 * c3 * t + 2 * c2) * t + c1)


@njit(cache=True, error_model="numpy")
def fluxes(
    u: FloatArray,
    share: FloatArray,
    table: FloatArray,
    air: FloatArray,
    place: FloatArray,
    flux: FloatArray,
    inner: FloatArray,
    outer: FloatArray,
) -> float:
    """Flux inwards through the upper edge of every cell, and its derivatives with u inside and outside of that edge.

    `air` is D_a, C_sat, ambient activity, chi, 0.495 Sc^(1/2), Sherwood floor, phi_0, r_0, wind, nu, whether the radius is
    kept; `place` stretch, speed. Returns the volume left, in units of that at the start.
    """
    m = u.size
    volume = 0.0
    for i in range(m - 1):
        volume += share[i] * (1 + u[i])
        here, there = 1 / (1 + u[i]), 1 / (1 + u[i + 1])
        d0, s0 = _law(here, table)
        d1, s1 = _law(there, table)
        dm, sm = _law(0.5 * (here + there), table)
        mean = (d0 + 4 * dm + d1) / 6
        factor = 4 * volume / (0.5 * (share[i] + share[i + 1]))
        fall = here * there * (u[i + 1] - u[i])
        flux[i] = factor * mean * fall
        inner[i] = factor * (fall * (s0 + 2 * sm) / 6 + mean) * -(here * here)
        outer[i] = factor * (fall * (s1 + 2 * sm) / 6 - mean) * -(there * there)
    volume += share[m - 1] * (1 + u[m - 1])
    left = air[6] * volume
    phi = 1 / (1 + u[m - 1])
    solvent = u[m - 1] * phi
    coefficient = np.exp(phi + air[3] * phi * phi)
    speed, radius = place[1], air[7] / np.sqrt(place[0])
    if air[10] > 0:
        reynolds = 2 * radius * abs(left * speed - air[8]) / air[9]
    else:
        reynolds = 2 * radius * np.sqrt(left) * abs(speed - air[8]) / air[9]
    transfer = air[0] * max(reynolds ** (1.0 / 3.0) * air[4], air[5]) * air[1]
    flux[m - 1] = -transfer * (coefficient * solvent - air[2])
    inner[m - 1] = -transfer * coefficient * (1 - solvent * (1 + 2 * air[3] * phi)) * phi * phi
    outer[m - 1] = 0.0
    return float(left)


@njit(cache=True, error_model="numpy")
def _jacobian(
    inner: FloatArray,
    outer: FloatArray,
    share: FloatArray,
    pace: float,
    low: FloatArray,
    mid: FloatArray,
    high: FloatArray,
) -> None:
    """Bands of d(du/dx)/du from the derivatives of the fluxes."""
    m = share.size
    for i in range(m):
        mid[i] = pace * inner[i] / share[i]
        high[i] = pace * outer[i] / share[i] if i < m - 1 else 0.0
        low[i] = 0.0
        if i > 0:
            mid[i] -= pace * outer[i - 1] / share[i]
            low[i] = -pace * inner[i - 1] / share[i]


@njit(cache=True, error_model="numpy")
def _factor(low, mid, high, shift, pivots):  # type: ignore[no-untyped-def]
    """Pivots of shift - J, tridiagonal."""
    pivots[0] = shift - mid[0]
    for i in range(1, mid.size):
        pivots[i] = shift - mid[i] - low[i] * high[i - 1] / pivots[i - 1]


@njit(cache=True, error_model="numpy")
def _solve(low, high, pivots, right):  # type: ignore[no-untyped-def]
    """Solve (shift - J) x = right in place; the last of `right` is the loss, and stays."""
    m = pivots.size
    for i in range(1, m):
        right[i] += low[i] / pivots[i - 1] * right[i - 1]
    right[m - 1] /= pivots[m - 1]
    for i in range(m - 2, -1, -1):
        right[i] = (right[i] + high[i] * right[i + 1]) / pivots[i]


@njit(cache=True, error_model="numpy")
def _turn(matrix: FloatArray, values: FloatArray, out: FloatArray) -> None:
    """`matrix` (3, 3) times the three rows of `values`."""
    for i in range(values.shape[1]):
        a, b, c = values[0, i], values[1, i], values[2, i]
        for k in range(3):
            out[k, i] = matrix[k, 0] * a + matrix[k, 1] * b + matrix[k, 2] * c


@njit(cache=True, error_model="numpy")
def _rates(flux: FloatArray, share: FloatArray, pace: float, out: FloatArray) -> None:
    m = share.size
    out[0] = pace * flux[0] / share[0]
    for i in range(1, m):
        out[i] = pace * (flux[i] - flux[i - 1]) / share[i]
    out[m] = -pace * flux[m - 1]


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
    places: FloatArray,
    stages: FloatArray,
    first: FloatArray,
    error: FloatArray,
) -> tuple[int, float, float]:
    """One step: stages (3, m + 1) as changes of y, rates at the start, and the error.

    `places` are stretch, speed and pace (exposure over the polymer) at the start and at the three stages, (4, 3).

    Returns
    -------
    iterations : int
        0 if they do not converge.
    contraction : float
        Of the last iteration.
    size : float
        Norm of the error.
    """
    m = share.size
    flux, inner, outer = np.empty(m), np.empty(m), np.empty(m)
    low, mid, high = np.empty(m), np.empty(m), np.empty(m)
    fluxes(y[:m], share, table, air, places[0], flux, inner, outer)
    _rates(flux, share, places[0, 2], first)
    _jacobian(inner, outer, share, places[0, 2], low, mid, high)
    loss = -places[0, 2] * inner[m - 1]  # d(loss rate)/du of the outermost cell
    real, pair = np.empty(m), np.empty(m, np.complex128)
    _factor(low, mid, high, MU / h, real)
    _factor(low, mid, high, MU_PAIR / h, pair)
    w, turned, at = np.empty((3, m + 1)), np.empty((3, m + 1)), np.empty(m)
    _turn(_TI, guess, w)
    stages[:] = guess
    rates = np.empty((3, m + 1))
    right, both = np.empty(m + 1), np.empty(m + 1, np.complex128)
    before, contraction = -1.0, 0.0
    done = 0
    for iteration in range(1, 9):
        for k in range(3):
            for i in range(m):
                at[i] = y[i] + stages[k, i]
                if not -0.3 < at[i] < 1e300:
                    return 0, contraction, 0.0
            fluxes(at, share, table, air, places[k + 1], flux, inner, outer)
            _rates(flux, share, places[k + 1, 2], rates[k])
        _turn(_TI, rates, turned)
        size = 0.0
        for i in range(m + 1):
            right[i] = turned[0, i] - MU / h * w[0, i]
            both[i] = turned[1, i] + 1j * turned[2, i] - MU_PAIR / h * (w[1, i] + 1j * w[2, i])
        _solve(low, high, real, right)
        _solve(low, high, pair, both)
        right[m] = (right[m] + loss * right[m - 1]) * h / MU
        both[m] = (both[m] + loss * both[m - 1]) * h / MU_PAIR
        for i in range(m + 1):
            size += (right[i] ** 2 + both[i].real ** 2 + both[i].imag ** 2) / scale[i] ** 2
            w[0, i] += right[i]
            w[1, i] += both[i].real
            w[2, i] += both[i].imag
        size = np.sqrt(size / (3 * (m + 1)))
        _turn(_T, w, stages)
        if not np.isfinite(size):
            return 0, contraction, 0.0
        if before > 0:
            contraction = size / before
            if contraction >= 1 or contraction ** (8 - iteration) / (1 - contraction) * size > tolerance:
                return 0, contraction, 0.0
        if size == 0 or (before > 0 and contraction / (1 - contraction) * size < tolerance):
            done = iteration
            break
        before = size
    if not done:
        return 0, contraction, 0.0
    for i in range(m + 1):
        error[i] = first[i] + (_ERROR[0] * stages[0, i] + _ERROR[1] * stages[1, i] + _ERROR[2] * stages[2, i]) / h
    return done, contraction, _error_of(error, low, high, real, loss, h, scale)


@njit(cache=True, error_model="numpy")
def _error_of(
    error: FloatArray, low: FloatArray, high: FloatArray, pivots: FloatArray, loss: float, h: float, scale: FloatArray
) -> float:
    """Filter the error through the real system, in place, and take its norm."""
    m = pivots.size
    _solve(low, high, pivots, error)
    error[m] = (error[m] + loss * error[m - 1]) * h / MU
    size = 0.0
    for i in range(m + 1):
        size += (error[i] / scale[i]) ** 2
    return float(np.sqrt(size / (m + 1)))


def interpolate(stages: FloatArray, theta: FloatArray) -> FloatArray:
    """Change of y at fractions of a step: the collocation polynomial, (theta, m + 1)."""
    powers = np.asarray(theta, dtype=np.float64)[:, np.newaxis] ** (_POWERS + 1)
    value: FloatArray = powers @ (_DENSE @ stages)
    return value
