"""Bending moment of the thread, compiled: what cuts off waves shorter than a few radii; implicit in the velocities.

Every element turns with ``omega = t x dv/l + w t``, w its spin about its own axis. At a node
``M = (pi r^4/4) [G m + 3 mu_s dOmega/ds]``, dOmega the difference of the two omegas beside it; with `VISCOUS`
``M = (3 mu pi r^4/4) dOmega/ds``; with `ELASTIC` m is the moment of a Maxwell thread under tension,
``dm/dt = (2 A_zz + A_rr) dOmega/ds + omega x m + 2 edot m - m/theta``. Twist about the axis is resisted with 2 mu, not 3 mu,
and without inertia, so that every w follows from the velocities. A thread that turns as a whole has no dOmega: it is not
resisted, and forces and torques are those of a dissipation that does not see it, so both sum to zero.

The stage's velocities and spins are one positive system of half width 10, with the solvent's resistance to stretching in it.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AREA,
    ARR,
    AZZ,
    BEND_VISCOSITY,
    BENDING,
    ELASTIC,
    G_HERE,
    LENGTH,
    MX,
    RATE,
    RHO,
    SOLVENT_HERE,
    SPIN,
    THETA_HERE,
    TX,
    VOLUME,
    VX,
    IntArray,
)

__all__ = ["bent_stage", "moment_rates"]

WIDTH = 10  # of the band: node i - 1 to node i + 1, three velocities and a spin each
LOOSE = 1e-9  # resistance to spin as a whole, of that to twist: no thread is twisted by turning as a whole


@njit(cache=True, error_model="numpy")
def _turn(i: int, w: FloatArray, j: FloatArray) -> float:
    """d(dOmega)/d(velocities and spins) at node i to `j` (3, 11), by v_(i-1), w_(i-1), v_i, w_i, v_(i+1); the node's arc."""
    for a in range(3):
        for b in range(11):
            j[a, b] = 0.0
    for side in range(2):
        e, sign, at = i - 1 + side, 1.0 - 2.0 * side, 4 * side
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            # (t x v)_a = t_b v_c - t_c v_b
            for node in range(2):
                way = sign * (1.0 - 2.0 * node) / w[LENGTH, e]
                j[a, at + 4 * node + c] += way * w[TX + b, e]
                j[a, at + 4 * node + b] -= way * w[TX + c, e]
            j[a, at + 3] = sign * w[TX + a, e]
    arc: float = 0.5 * (w[LENGTH, i] + w[LENGTH, i - 1])
    return arc


@njit(cache=True, error_model="numpy")
def _resistance(
    i: int, gh: float, y: FloatArray, p: FloatArray, k: IntArray, w: FloatArray, grip: FloatArray
) -> tuple[float, float]:
    """Moment per dOmega/ds of node i over a stage to `grip` (3, 3), N m2; (pi r^4/4) G, and the stiffness (2 A_zz + A_rr)."""
    area = 0.5 * (w[AREA, i] + w[AREA, i - 1])
    inertia = area * area / (4.0 * math.pi)
    bend, elastic, stretch = 3.0 * p[BEND_VISCOSITY] * inertia, 0.0, 0.0
    if k[BENDING] == ELASTIC:
        elastic = inertia * 0.5 * (w[G_HERE, i] + w[G_HERE, i - 1])
        stretch = 0.5 * (2.0 * (y[i, AZZ] + y[i - 1, AZZ]) + y[i, ARR] + y[i - 1, ARR])
        bend = 1.5 * (w[SOLVENT_HERE, i] + w[SOLVENT_HERE, i - 1]) * inertia + gh * elastic * stretch
    twist = 2.0 * p[BEND_VISCOSITY] * inertia
    size = 0.0
    for a in range(3):
        size += (w[TX + a, i] + w[TX + a, i - 1]) ** 2
    for a in range(3):
        for b in range(3):
            along = 0.0
            if size > 1e-6:
                along = (w[TX + a, i] + w[TX + a, i - 1]) * (w[TX + b, i] + w[TX + b, i - 1]) / size
            grip[a, b] = (twist - bend) * along + (bend if a == b else 0.0)
    return elastic, stretch


@njit(cache=True, error_model="numpy")
def _assemble(
    n: int,
    gh: float,
    y: FloatArray,
    held: IntArray,
    p: FloatArray,
    k: IntArray,
    w: FloatArray,
    band: FloatArray,
    right: FloatArray,
) -> None:
    """The system of a stage: `band[a, d]` is its element (a, a - d)."""
    j, grip, pull = np.zeros((3, 11)), np.zeros((3, 3)), np.zeros((3, 11))
    full, known = np.zeros((11, 11)), np.zeros(11)
    for i in range(n):
        mass = 0.5 * p[RHO] * (y[i, VOLUME] + (y[i - 1, VOLUME] if i > 0 else 0.0))
        for a in range(3):
            band[4 * i + a, 0] += mass
            right[4 * i + a] += mass * y[i, VX + a]
        here = gh * 3.0 * w[SOLVENT_HERE, i] * w[AREA, i] / w[LENGTH, i]
        if held[i] == 1 and w[RATE, i] < 0.0:
            here = 0.0
        full[:, :] = 0.0
        for a in range(3):
            for b in range(3):
                one = here * w[TX + a, i] * w[TX + b, i]
                full[a, b] = full[4 + a, 4 + b] = one
                full[a, 4 + b] = full[4 + a, b] = -one
        area = w[AREA, i]
        full[3, 3] = gh * LOOSE * 2.0 * p[BEND_VISCOSITY] * area * area / (4.0 * math.pi) / w[LENGTH, i]
        _add(i, n, y, held, full, known, band, right)
    for i in range(1, n):
        if held[i] == 1:  # a laid thread has no moment
            continue
        arc = _turn(i, w, j)
        elastic, _ = _resistance(i, gh, y, p, k, w, grip)
        for a in range(3):
            for b in range(11):
                pull[a, b] = 0.0
                for c in range(3):
                    pull[a, b] += gh / arc * grip[a, c] * j[c, b]
        for a in range(11):
            known[a] = 0.0
            for c in range(3):
                known[a] -= gh * elastic * j[c, a] * y[i, MX + c]
            for b in range(11):
                full[a, b] = 0.0
                for c in range(3):
                    full[a, b] += j[c, a] * pull[c, b]
        _add(i - 1, n, y, held, full, known, band, right)
        known[:] = 0.0


@njit(cache=True, error_model="numpy")
def _add(
    first: int,
    n: int,
    y: FloatArray,
    held: IntArray,
    full: FloatArray,
    known: FloatArray,
    band: FloatArray,
    right: FloatArray,
) -> None:
    """Add a local matrix and right side that begin at node `first`; velocities that are given go to the right."""
    for a in range(11):
        row, node = 4 * first + a, first + a // 4
        if node >= n or (a % 4 < 3 and held[node] == 1):
            continue
        right[row] += known[a]
        for b in range(11):
            if full[a, b] == 0.0:
                continue
            other = first + b // 4
            if b % 4 < 3 and (other >= n or held[other] == 1):
                right[row] -= full[a, b] * y[other, VX + b % 4]
            elif b <= a:
                band[row, a - b] += full[a, b]


@njit(cache=True, error_model="numpy")
def _divide(size: int, band: FloatArray, u: FloatArray) -> bool:
    """Solve by Cholesky's factor, in place; False where the system is not positive."""
    for a in range(size):  # Cholesky, in place
        for d in range(min(a, WIDTH), -1, -1):
            b = a - d
            total = band[a, d]
            for c in range(max(0, a - WIDTH), b):
                total -= band[a, a - c] * band[b, b - c]
            if d > 0:
                band[a, d] = total / band[b, 0]
            elif total > 0.0:
                band[a, 0] = math.sqrt(total)
            else:
                return False
    for a in range(size):
        for d in range(1, min(a, WIDTH) + 1):
            u[a] -= band[a, d] * u[a - d]
        u[a] /= band[a, 0]
    for a in range(size - 1, -1, -1):
        for d in range(1, min(size - 1 - a, WIDTH) + 1):
            u[a] -= band[a + d, d] * u[a + d]
        u[a] /= band[a, 0]
    return True


@njit(cache=True, error_model="numpy")
def bent_stage(
    n: int,
    gh: float,
    y: FloatArray,
    held: IntArray,
    p: FloatArray,
    k: IntArray,
    w: FloatArray,
    push: FloatArray,
) -> bool:
    """Velocities, spins and elastic moments under the thread's viscosity over a stage; dv/dt and dm/dt to `push` (6)."""
    size = 4 * n
    band, u = np.zeros((size, WIDTH + 1)), np.zeros(size)
    _assemble(n, gh, y, held, p, k, w, band, u)
    for i in range(n):
        if held[i] == 1:
            for a in range(3):
                row = 4 * i + a
                for d in range(WIDTH + 1):
                    band[row, d] = 0.0
                    if row + d < size:
                        band[row + d, d] = 0.0
                band[row, 0], u[row] = 1.0, y[i, VX + a]
    if not _divide(size, band, u):
        return False
    for i in range(n):
        for a in range(3):
            push[i, a] = (u[4 * i + a] - y[i, VX + a]) / gh
            y[i, VX + a] = u[4 * i + a]
        y[i, SPIN] = u[4 * i + 3]
    j, grip = np.zeros((3, 11)), np.zeros((3, 3))
    for i in range(n):
        for a in range(3):
            push[i, 3 + a] = 0.0
        if k[BENDING] != ELASTIC or i == 0 or held[i] == 1:
            continue
        arc = _turn(i, w, j)
        _, stretch = _resistance(i, gh, y, p, k, w, grip)
        for a in range(3):
            for b in range(11):
                at = i - 1 + b // 4
                value = y[at, SPIN] if b % 4 == 3 else y[at, VX + b % 4]
                push[i, 3 + a] += stretch * j[a, b] * value / arc
            y[i, MX + a] += gh * push[i, 3 + a]
    return True


@njit(cache=True, error_model="numpy")
def moment_rates(n: int, y: FloatArray, k: IntArray, w: FloatArray, dy: FloatArray) -> None:
    """Rates of the elastic moments but for what bends them: they turn with the thread, stretch with it and relax."""
    turn = np.zeros(3)
    for i in range(n):
        for a in range(3):
            dy[i, MX + a] = 0.0
        if k[BENDING] != ELASTIC or i == 0:
            continue
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            turn[a] = 0.0
            for e in range(i - 1, i + 1):
                ub, uc = y[e, VX + b] - y[e + 1, VX + b], y[e, VX + c] - y[e + 1, VX + c]
                turn[a] += 0.5 * ((w[TX + b, e] * uc - w[TX + c, e] * ub) / w[LENGTH, e] + y[e, SPIN] * w[TX + a, e])
        rate = 0.5 * (w[RATE, i] + w[RATE, i - 1])
        theta = 0.5 * (w[THETA_HERE, i] + w[THETA_HERE, i - 1])
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            dy[i, MX + a] = (
                turn[b] * y[i, MX + c] - turn[c] * y[i, MX + b] + 2.0 * rate * y[i, MX + a] - y[i, MX + a] / theta
            )
