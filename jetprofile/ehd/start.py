"""A first guess of the whole jet, from nothing: sweeps between the pull, the shape and the charge.

Given the tension T(s) the shape follows by marching from the needle; given the shape, the charge problem is linear
(``Psi' = E_ext - i V + Pe V^2 Psi / l``, marched back from the end); given both, the momentum balance, marched back, gives a
new T. A dozen damped sweeps come near enough for Newton's method.
"""

from typing import Any

import numpy as np
from numba import njit

from spinline.checks import FloatArray
from spinline.jetprofile.ehd.boundary_value import Problem
from spinline.jetprofile.ehd.equations import slopes

__all__ = ["sweep_guess"]


@njit(cache=True, error_model="numpy")
def _shape(s: Any, tension: Any, p: Any, polymer: bool, y: Any) -> bool:
    """March u, ln B, ln C from the needle by implicit Euler, T given; False where it fails."""
    n, m = y.shape
    flags = (polymer, False, False)
    state, base, work = y[0].copy(), np.empty(m), np.empty(m)
    index = np.array([0, 4, 5]) if polymer else np.array([0])
    size = index.size
    residual, jacobian = np.empty(size), np.empty((size, size))
    for j in range(1, n):
        h = s[j] - s[j - 1]
        state[1] = tension[j]
        done = False
        for _ in range(60):
            slopes(state, 1.0, p, flags[0], flags[1], flags[2], base)
            for a in range(size):
                k = index[a]
                residual[a] = state[k] - y[j - 1, k] - h * base[k]
                old = state[k]
                state[k] = old + 1e-7
                slopes(state, 1.0, p, flags[0], flags[1], flags[2], work)
                state[k] = old
                for b in range(size):
                    jacobian[b, a] = (1.0 if a == b else 0.0) - h * (work[index[b]] - base[index[b]]) / 1e-7
            change = np.linalg.solve(jacobian, residual)
            largest = np.abs(change).max()
            if not np.isfinite(largest):
                return False
            limit = min(1.0, 0.7 / max(largest, 1e-300))
            for a in range(size):
                state[index[a]] -= limit * change[a]
            if largest < 1e-8:
                done = True
                break
        if not done or abs(state[0]) > 60:
            return False
        for a in range(size):
            y[j, index[a]] = state[index[a]]
    return True


@njit(cache=True, error_model="numpy")
def _back(s: Any, rate: Any, source: Any, last: float) -> Any:
    """``x' = source + rate x`` from the end back, trapezoidal in the source, exact in the rate."""
    n = s.size
    x = np.empty(n)
    x[n - 1] = last
    for j in range(n - 2, -1, -1):
        h = s[j + 1] - s[j]
        g = 0.5 * h * (rate[j] + rate[j + 1])
        decay = np.exp(-g)
        mean = -np.expm1(-g) / g if abs(g) > 1e-12 else 1.0
        x[j] = x[j + 1] * decay - 0.5 * h * (source[j] + source[j + 1]) * mean
    return x


def _charge(problem: Problem, s: FloatArray, u: FloatArray, given: float | None) -> tuple[FloatArray, float]:
    """Psi(s) and ln i of a given shape."""
    p, field = problem.parameters, np.asarray(problem.field(s), dtype=float)
    v = np.exp(u)
    log = p[6] + (0.5 * u if problem.local else 0.0)
    rate = p[3] * v**2 / log
    inverse = 1.0 / rate[-1]
    free = _back(s, rate, field, -p[13] * inverse)
    carried = _back(s, rate, -v, v[-1] * inverse)
    current = -free[0] / carried[0] if given is None else float(np.exp(given))
    return free + current * carried, float(np.log(current)) if current > 0 else np.nan


def sweep_guess(problem: Problem, s: FloatArray, tension: FloatArray, sweeps: int = 12) -> FloatArray | None:
    """Guess of all unknowns on the mesh `s`, from a first tension; None where the sweeps fail."""
    m = problem.size
    p = problem.parameters.copy()
    y = np.zeros((s.size, m))
    starts = {int(index): float(value) for index, value in problem.left}
    field = np.asarray(problem.field(s), dtype=float)
    t = tension.copy()
    work = np.empty(m)
    reduced = Problem(p, problem.field, problem.end, problem.left, problem.polymer, False, problem.local)
    for _ in range(sweeps):
        z = np.zeros((s.size, reduced.size))
        z[:, 1] = t
        if not _shape(s, t, p, problem.polymer, z):
            return None
        psi, log_current = _charge(problem, s, z[:, 0], starts.get(3))
        if not np.isfinite(log_current) or not np.isfinite(psi).all():
            return None
        z[:, 2], z[:, 3] = psi, log_current
        rate = np.empty(s.size)
        q = np.empty(s.size)
        for j in range(s.size):
            out = work[: reduced.size]
            _, q[j] = slopes(z[j], field[j], p, problem.polymer, False, problem.local, out)
            rate[j] = out[1]
        v = np.exp(z[-1, 0])
        last = 3 * p[8] * p[12] + (p[9] * (np.exp(z[-1, 4]) - np.exp(z[-1, 5])) / v if problem.polymer else 0.0)
        new = _back(s, np.zeros_like(s), rate, last)
        y[:, : reduced.size] = z
        if problem.charge:
            y[:, -1] = q
        floor = 1e-3 * np.abs(new).max()
        t = np.exp(0.5 * np.log(np.maximum(t, floor)) + 0.5 * np.log(np.maximum(new, floor)))
    return y
