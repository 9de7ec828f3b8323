"""Radial drying in compiled loops: fluxes between cells, their Jacobian, tridiagonal systems; the step is `_map_kernels`'.

The Jacobian holds what is stiff, diffusion between neighbours and the loss of the outermost cell; that a flux also depends on
all the volume inside it (X) and the Sherwood number on all that is left is slow, and left to the Newton iteration. Its columns
are differences of fluxes, so that both masses are conserved to rounding however far an iteration has come.

Radau IIA, three stages, order 5 (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.8): one real and one complex
tridiagonal system a step.
"""

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = [
    "DENSE",
    "ERROR",
    "MU",
    "MU_PAIR",
    "NODES",
    "STAGES",
    "TI",
    "T",
    "bands",
    "factor",
    "fluxes",
    "interpolate",
    "solve",
    "turn",
]

_S6 = 6.0**0.5
NODES = np.array([(4 - _S6) / 10, (4 + _S6) / 10, 1.0])
ERROR = np.array([-13 - 7 * _S6, -13 + 7 * _S6, -1.0]) / 3
_POWERS = np.arange(3)
STAGES = (NODES[:, np.newaxis] ** (_POWERS + 1) / (_POWERS + 1)) @ np.linalg.inv(NODES[:, np.newaxis] ** _POWERS)


def _transformed() -> tuple[float, complex, FloatArray, FloatArray]:
    """Eigenvalues of the inverse of Radau's matrix, one real and one of the pair, with the real basis that splits them."""
    values, vectors = np.linalg.eig(np.linalg.inv(STAGES))
    real = int(np.argmin(np.abs(values.imag)))
    pair = int(np.argmax(values.imag))
    basis = np.column_stack((vectors[:, real].real, vectors[:, pair].real, vectors[:, pair].imag))
    return float(values[real].real), complex(values[pair].conjugate()), basis, np.linalg.inv(basis)


MU, MU_PAIR, T, TI = _transformed()
# u(x_0 + theta h) - u(x_0) = sum_k Q_k theta^k, from the stages
DENSE = np.linalg.inv(NODES[:, np.newaxis] ** (_POWERS + 1))


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
def bands(
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
def factor(low, mid, high, shift, pivots):  # type: ignore[no-untyped-def]
    """Pivots of shift - J, tridiagonal."""
    pivots[0] = shift - mid[0]
    for i in range(1, mid.size):
        pivots[i] = shift - mid[i] - low[i] * high[i - 1] / pivots[i - 1]


@njit(cache=True, error_model="numpy")
def solve(low, high, pivots, right):  # type: ignore[no-untyped-def]
    """Solve (shift - J) x = right in place; the last of `right` is the loss, and stays."""
    m = pivots.size
    for i in range(1, m):
        right[i] += low[i] / pivots[i - 1] * right[i - 1]
    right[m - 1] /= pivots[m - 1]
    for i in range(m - 2, -1, -1):
        right[i] = (right[i] + high[i] * right[i + 1]) / pivots[i]


@njit(cache=True, error_model="numpy")
def turn(matrix: FloatArray, values: FloatArray, out: FloatArray) -> None:
    """`matrix` (3, 3) times the three rows of `values`."""
    for i in range(values.shape[1]):
        a, b, c = values[0, i], values[1, i], values[2, i]
        for k in range(3):
            out[k, i] = matrix[k, 0] * a + matrix[k, 1] * b + matrix[k, 2] * c


def interpolate(stages: FloatArray, theta: FloatArray) -> FloatArray:
    """Change of y at fractions of a step: the collocation polynomial, (theta, m + 1)."""
    powers = np.asarray(theta, dtype=np.float64)[:, np.newaxis] ** (_POWERS + 1)
    value: FloatArray = powers @ (DENSE @ stages)
    return value
