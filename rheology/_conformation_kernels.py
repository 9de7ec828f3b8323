"""Giesekus and FENE-P elements in compiled loops: Radau IIA, order 5, from sample to sample with its own steps between.

The unknowns are the two logarithms of `conformation`; a step solves its three stages together (six unknowns) by Newton with the
Jacobian at its start, and is judged by Hairer and Wanner's embedded formula, filtered for stiffness.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.rheology._elimination import eliminate

__all__ = ["FENEP_KIND", "GIESEKUS_KIND", "follow"]

GIESEKUS_KIND, FENEP_KIND = 0, 1
_S6 = 6.0**0.5
_NODES = np.array([(4 - _S6) / 10, (4 + _S6) / 10, 1.0])
_POWERS = np.arange(3)
_STAGES = (_NODES[:, np.newaxis] ** (_POWERS + 1) / (_POWERS + 1)) @ np.linalg.inv(_NODES[:, np.newaxis] ** _POWERS)
_ERROR = np.array([-13 - 7 * _S6, -13 + 7 * _S6, -1.0]) / 3
_VALUES = np.linalg.eigvals(np.linalg.inv(_STAGES))
_MU = float(_VALUES[int(np.argmin(np.abs(_VALUES.imag)))].real)
_DENSE = np.linalg.inv(_NODES[:, np.newaxis] ** (_POWERS + 1))
_MOST_STEPS, _MOST_A_SAMPLE = 200_000, 20  # steps in all: the one and the other times the samples


@njit(cache=True, error_model="numpy")
def _slope(kind, parameter, y, rate, frequency, out):  # type: ignore[no-untyped-def]
    """Rates of ln A (Giesekus) or ln(f A) (FENE-P)."""
    if kind == 0:
        for i in range(2):
            power = 2.0 if i == 0 else -1.0
            out[i] = power * rate + frequency * np.expm1(-y[i]) * (1 + parameter * np.expm1(y[i]))
        return
    b0, b1 = np.exp(y[0]), np.exp(y[1])
    f = (b0 + 2 * b1 + parameter - 3) / parameter
    out[0] = 2 * rate + frequency * f * np.expm1(-y[0])
    out[1] = -rate + frequency * f * np.expm1(-y[1])
    stiffer = (b0 * out[0] + 2 * b1 * out[1]) / (parameter - 3)
    out[0] += stiffer
    out[1] += stiffer


@njit(cache=True, error_model="numpy")
def _jacobian(kind, parameter, y, rate, frequency, out):  # type: ignore[no-untyped-def]
    if kind == 0:
        for i in range(2):
            grown, shrunk = np.exp(y[i]), np.exp(-y[i])
            out[i, i] = frequency * (-shrunk * (1 + parameter * np.expm1(y[i])) + np.expm1(-y[i]) * parameter * grown)
            out[i, 1 - i] = 0.0
        return
    b0, b1 = np.exp(y[0]), np.exp(y[1])
    f = (b0 + 2 * b1 + parameter - 3) / parameter
    c0 = 2 * rate + frequency * f * np.expm1(-y[0])
    c1 = -rate + frequency * f * np.expm1(-y[1])
    for j in range(2):
        df = (b0 if j == 0 else 2 * b1) / parameter
        d0 = frequency * (df * np.expm1(-y[0]) - (f * np.exp(-y[0]) if j == 0 else 0.0))
        d1 = frequency * (df * np.expm1(-y[1]) - (f * np.exp(-y[1]) if j == 1 else 0.0))
        own = b0 * c0 if j == 0 else 2 * b1 * c1
        stiffer = (own + b0 * d0 + 2 * b1 * d1) / (parameter - 3)
        out[0, j] = d0 + stiffer
        out[1, j] = d1 + stiffer


@njit(cache=True, error_model="numpy")
def follow(
    kind: int,
    parameter: float,
    first: FloatArray,
    time: FloatArray,
    rates: FloatArray,
    log_frequency: FloatArray,
    rtol: float,
    atol: float,
) -> tuple[int, FloatArray]:
    """Both logarithms at every sample.

    Parameters
    ----------
    kind, parameter
        0 with the mobility, 1 with L^2.
    first : ndarray, (2,)
    time : ndarray, (n,)
    rates : ndarray, (n - 1, 3)
        Strain rate of each step as a polynomial of the share of the step that is past.
    log_frequency : ndarray, (n,)
        ln(1/theta), a line between samples.
    rtol, atol : float

    Returns
    -------
    reached : int
        Samples that were reached; n if all were.
    values : ndarray, (n, 2)
    """
    n = time.size
    values = np.empty((n, 2))
    y, start, at, error = np.empty(2), np.empty(2), np.empty(2), np.empty(2)
    for j in range(2):
        values[0, j] = y[j] = first[j]
    jac, matrix, right, z = np.empty((2, 2)), np.empty((6, 6)), np.empty(6), np.empty((3, 2))
    small, rate_of = np.empty((2, 2)), np.empty((3, 2))
    tolerance = max(10 * 2.220446049250313e-16 / rtol, min(0.03, rtol**0.5))
    h, steps, old, guess = 0.0, 0, 0.0, False
    stages = np.empty((3, 2))
    for k in range(n - 1):
        span, done = time[k + 1] - time[k], 0.0  # done: past time of this step
        slower = (log_frequency[k + 1] - log_frequency[k]) / span
        if h <= 0 or h > span:
            h = span
        guess = False
        while done < span:
            steps += 1
            if steps > _MOST_STEPS + _MOST_A_SAMPLE * n or h < 1e-14 * span:
                return k + 1, values
            last = done + h >= span * (1 - 1e-12)
            step = span - done if last else h
            u = done / span
            rate = rates[k, 0] + u * (rates[k, 1] + u * rates[k, 2])
            frequency = np.exp(log_frequency[k] + slower * done)
            _slope(kind, parameter, y, rate, frequency, start)
            _jacobian(kind, parameter, y, rate, frequency, jac)
            scale0, scale1 = atol + rtol * max(abs(y[0]), 1.0), atol + rtol * max(abs(y[1]), 1.0)
            if guess:
                for i in range(3):
                    theta = 1 + _NODES[i] * step / old
                    for j in range(2):
                        z[i, j] = -stages[2, j]
                        for a in range(3):
                            q = _DENSE[a, 0] * stages[0, j] + _DENSE[a, 1] * stages[1, j] + _DENSE[a, 2] * stages[2, j]
                            z[i, j] += q * theta ** (a + 1)
            else:
                for i in range(3):
                    for j in range(2):
                        z[i, j] = 0.0
            converged, before, contraction, used = False, -1.0, 0.0, 0
            for iteration in range(1, 9):
                finite = True
                for i in range(3):
                    share = (done + _NODES[i] * step) / span
                    at[0], at[1] = y[0] + z[i, 0], y[1] + z[i, 1]
                    if not (abs(at[0]) < 300 and abs(at[1]) < 300):
                        finite = False
                        break
                    there = rates[k, 0] + share * (rates[k, 1] + share * rates[k, 2])
                    quick = np.exp(log_frequency[k] + slower * share * span)
                    _slope(kind, parameter, at, there, quick, rate_of[i])
                if not finite:
                    break
                for i in range(3):
                    for j in range(2):
                        row = 2 * i + j
                        right[row] = -z[i, j]
                        for a in range(3):
                            right[row] += step * _STAGES[i, a] * rate_of[a, j]
                            for b in range(2):
                                matrix[row, 2 * a + b] = -step * _STAGES[i, a] * jac[j, b]
                        matrix[row, row] += 1
                if not eliminate(matrix, right):
                    break
                size = 0.0
                for i in range(3):
                    size += (right[2 * i] / scale0) ** 2 + (right[2 * i + 1] / scale1) ** 2
                    z[i, 0] += right[2 * i]
                    z[i, 1] += right[2 * i + 1]
                size = np.sqrt(size / 6)
                if not np.isfinite(size):
                    break
                if before > 0:
                    contraction = size / before
                    if contraction >= 1 or contraction ** (8 - iteration) / (1 - contraction) * size > tolerance:
                        break
                if (
                    size == 0
                    or (before > 0 and contraction / (1 - contraction) * size < tolerance)
                    or size < 1e-3 * tolerance
                ):
                    converged, used = True, iteration
                    break
                before = size
            if not converged:
                h = 0.5 * step if guess else 0.2 * step
                guess = False
                continue
            for j in range(2):
                error[j] = start[j] + (_ERROR[0] * z[0, j] + _ERROR[1] * z[1, j] + _ERROR[2] * z[2, j]) / step
                for b in range(2):
                    small[j, b] = (_MU / step if j == b else 0.0) - jac[j, b]
            if not eliminate(small, error):
                h = 0.2 * step
                guess = False
                continue
            size = np.sqrt(0.5 * ((error[0] / scale0) ** 2 + (error[1] / scale1) ** 2))
            safety = 0.9 * 17 / (16 + used)
            if not size <= 1:
                h = step * max(0.1, min(0.9, safety * size**-0.25))
                guess = False
                continue
            for j in range(2):
                y[j] += z[2, j]
                for i in range(3):
                    stages[i, j] = z[i, j]
            old, guess = step, True
            done = span if last else done + step
            factor = 8.0 if size == 0 else min(8.0, max(0.2, safety * size**-0.25))
            h = max(h, step * factor) if last else step * factor
        for j in range(2):
            values[k + 1, j] = y[j]
    return n, values
