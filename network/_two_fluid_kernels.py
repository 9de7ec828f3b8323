"""Compiled loop of the two-fluid box scheme: residual and Jacobian, in bands. What it solves stands in `two_fluid`."""

import math

import numpy as np
from numba import njit

from spinline.base.checks import FloatArray
from spinline.network._force_kernels import LINEAR, extension_kernel
from spinline.network.chain._kernels import compliance_kernel

__all__ = ["BELOW", "assemble"]

BELOW = 4
"""Diagonals below and above the main one."""

_AHEAD, _LATE = 2.0 / 3.0, 1.0 / 3.0
_SLACK = 0.05  # of the tension at rest: below, a strand's law is carried on so that its stretch stays positive


@njit(cache=True, error_model="numpy")
def _lay(bands: FloatArray, row: int, column: int, value: float) -> None:
    bands[BELOW + row - column, column] = value


@njit(cache=True, error_model="numpy")
def assemble(
    y: FloatArray,
    h: FloatArray,
    flow: FloatArray,
    eps: FloatArray,
    slow: FloatArray,
    law: tuple[int, float, float, float],
    per_line: bool,
    plain: bool,
    end: float,
    bands: FloatArray,
    load: FloatArray,
) -> None:
    """Set the Jacobian (bands) and the residual (load).

    `y` holds T (ln T for the linear spring) and q at node, middle, node, ...; `flow`, `eps` and `slow` are V, eps and 1/(2
    th) at the four collocation points of each cell: 0 and 2/3 for the momentum, 1/3 and 1 for the relaxation. `plain` is
    the scheme of first order, for guesses.
    """
    code, contour, rest, rest_tension = law
    cells = h.size
    line = 0.0 if per_line else 1.0
    for i in range(load.size):
        load[i] = 0.0
    load[0] = y[1]
    _lay(bands, 0, 1, 1.0)
    last = load.size - 1
    load[last] = y[last - 1] - end
    _lay(bands, last, last - 1, 1.0)
    value = np.empty(3)
    slope = np.empty(3)
    for i in range(cells):
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
            if k < 2:
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
                decay = h[i] * slow[i, k - 2] * share / (lam * lam)
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
