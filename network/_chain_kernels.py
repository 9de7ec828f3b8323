"""Compiled loops of the bead chain; every loop is O(beads). What they solve stands in `chain`.

Bead 0 is farthest from the nozzle; strand i joins bead i to bead i + 1 behind it. The tension of a strand is an
unknown of its own: its stretch w(T) is an explicit, bounded function, so that a locked strand (w'(T) -> 0) is as well
conditioned as a slack one, and eliminating the positions leaves one tridiagonal system for the tensions.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from spinline.checks import FloatArray
from spinline.network._flow_kernels import cell, lookup_now
from spinline.network._force_kernels import FENE, LATTICE, LINEAR, extension_kernel

__all__ = ["compliance_kernel", "error_norm", "rates", "solve_stage"]

_KNEE = 3.0  # normalised force where the laws bend
_LEAST_SLOPE = 0.05  # of a bead's equation; below, the step is too long for the flow
_LEAST_SHARE = 1e-9  # of drag, below which a bead is gone


@njit(cache=True, error_model="numpy")
def compliance_kernel(code: int, f: float, rest: float) -> float:
    """dx/df of a force law at the force f."""
    size = abs(f)
    if code == LINEAR:
        return 1 / 3
    if code == LATTICE:
        if size > 700.0:
            return 0.0
        fade = math.exp(-size)
        c = math.cosh(rest)
        z = 0.5 * (1 + fade * fade) + 2 * fade * c
        return fade * (fade + (1 + fade * fade) * c) / (z * z)
    if code == FENE:
        root = math.hypot(3.0, 2 * size)
        x = 2 * size / (3 + root)
        room = 6 / (3 + root)  # 1 - x^2 = 3 x / f
        return room * room / (3 * (1 + x * x))
    if size < 0.05:
        return 1 / 3 - size * size / 15 + 2 * size**4 / 189
    if size > 300.0:
        return (1 / size) ** 2
    return (1 / size) ** 2 - (1 / math.sinh(size)) ** 2


@njit(cache=True, error_model="numpy")
def _far_end(x: FloatArray, cut: float, lead: int) -> tuple[int, float]:
    """First bead that still belongs to the chain, from `lead` on, and the share of its drag that acts.

    The bead just outside keeps the share of drag of its strand still inside: at zero it carries no force and is gone,
    so that leaving is continuous; beads beyond it drift with the flow.
    """
    while lead + 1 < x.size and x[lead + 1] >= cut:
        lead += 1
    if lead + 1 == x.size or x[lead] <= cut:
        return lead, 1.0
    share = (cut - x[lead + 1]) / (x[lead] - x[lead + 1])
    if share < _LEAST_SHARE:
        return lead + 1, 1.0
    return lead, share


@njit(cache=True, error_model="numpy")
def rates(
    nodes: FloatArray,
    age: FloatArray,
    slow: FloatArray,
    share: float,
    x: FloatArray,
    tension: FloatArray,
    velocity: FloatArray,
    free: int,
    pull: float,
    inertia: float,
    cut: float,
    rest_tension: float,
    rate: FloatArray,
    surplus: FloatArray,
) -> None:
    """Set the rate of age v / V of every bead and ``I x''``, from the equation itself; sets v too where I = 0."""
    n = x.size
    j = nodes.size - 2
    lead, part = _far_end(x, cut, 0)
    for i in range(n):
        j = cell(nodes, x[i], j)
        _, v, _, now, _ = lookup_now(nodes, age, slow, share, x[i], j)
        if i >= lead:
            before = tension[i - 1] if i > lead else rest_tension
            behind = tension[i] if i < n - 1 else rest_tension
            now += pull * (before - behind) / (part if i == lead else 1.0)
        surplus[i] = 0.0
        if i >= free:
            velocity[i] = 1.0
        elif inertia == 0.0:
            velocity[i] = now
        else:
            surplus[i] = now - velocity[i]
        rate[i] = velocity[i] / v


@njit(cache=True, error_model="numpy")
def _eliminate(
    lead: int,
    ease: FloatArray,
    load: FloatArray,
    soft: FloatArray,
    gap: FloatArray,
    upper: FloatArray,
    change: FloatArray,
    move: FloatArray,
) -> None:
    """Newton correction of tensions and positions, from bead and strand `lead` on; Thomas' algorithm.

    Beads ``dx = -load + ease (dT_ahead - dT_behind)``, strands ``dx_ahead - dx_behind - soft dT = -gap``:
    diagonally dominant.
    """
    n = load.size
    for i in range(lead):
        move[i] = -load[i]
    for i in range(lead, n - 1):
        diagonal = ease[i] + ease[i + 1] + soft[i]
        value = gap[i] - load[i] + load[i + 1]
        if i > lead:
            diagonal -= ease[i] * upper[i - 1]
            value += ease[i] * change[i - 1]
        upper[i] = ease[i + 1] / diagonal
        change[i] = value / diagonal
    for i in range(n - 3, lead - 1, -1):
        change[i] += upper[i] * change[i + 1]
    ahead = 0.0
    for i in range(lead, n):
        behind = change[i] if i < n - 1 else 0.0
        move[i] = -load[i] + ease[i] * (ahead - behind)
        ahead = behind


@njit(cache=True, error_model="numpy")
def solve_stage(
    nodes: FloatArray,
    age: FloatArray,
    slow: FloatArray,
    share: float,
    x: FloatArray,
    tension: FloatArray,
    known_age: FloatArray,
    push: FloatArray,
    free: int,
    g: float,
    pull: float,
    inertia: float,
    spacing: float,
    cut: float,
    code: int,
    contour: float,
    rest: float,
    rest_tension: float,
    tolerance: float,
    most: int,
    left: NDArray[np.int64],
    work: FloatArray,
) -> int:
    """Solve one implicit stage by Newton's method; x and tension hold the guess, then the solution.

    ``a(x) = known_age + g v / V(x)``, ``I v = push + g (V + pull dT - v)``; beads from `free` on are held. Where the
    chain ends is taken from the guess; ``left[0]`` beads have left it before, and after. Returns the number of
    iterations, or -1; `work` keeps the last linearisation for `error_norm`.
    """
    n = x.size
    gain = g * (g / (inertia + g))
    lag = g / (inertia + g)
    kappa = gain * pull
    ease, load, soft, gap, upper, change, move = work[0], work[1], work[2], work[3], work[4], work[5], work[6]
    lead, part = _far_end(x, cut, left[0])
    left[0] = lead
    for i in range(lead):
        tension[i] = rest_tension
    knee = _KNEE / rest
    previous = math.inf
    for iteration in range(1, most + 1):
        for i in range(lead, n - 1):
            if code == LINEAR:
                w = tension[i]
                dw = 1.0
            else:
                w = contour * extension_kernel(code, tension[i] * rest, rest)
                dw = 3 * compliance_kernel(code, tension[i] * rest, rest)
            soft[i] = spacing * dw
            gap[i] = x[i] - x[i + 1] - spacing * w
        bend = 0.0 if code == LINEAR else math.inf
        j = nodes.size - 2
        for i in range(n):
            if i >= free:
                ease[i] = 0.0
                load[i] = 0.0
                continue
            j = cell(nodes, x[i], j)
            a, v, dv, now, dnow = lookup_now(nodes, age, slow, share, x[i], j)
            residual = v * (a - known_age[i]) - lag * push[i] - gain * now
            slope = 1 + dv * (a - known_age[i]) - gain * dnow
            if not slope > _LEAST_SLOPE:
                return -1
            bend = max(bend, abs(dv) / (v * slope))
            ease[i] = 0.0
            if i >= lead:
                strength = kappa / part if i == lead else kappa
                before = tension[i - 1] if i > lead else rest_tension
                behind = tension[i] if i < n - 1 else rest_tension
                residual -= strength * (before - behind)
                ease[i] = strength / slope
            load[i] = residual / slope
        _eliminate(lead, ease, load, soft, gap, upper, change, move)
        largest = 0.0
        for i in range(n):
            x[i] += move[i]
            largest = max(largest, abs(move[i]) / spacing)
        for i in range(lead, n - 1):
            new = tension[i] + change[i]
            if code != LINEAR and abs(tension[i]) > knee and new * math.copysign(1.0, tension[i]) < knee:
                new = math.copysign(knee, tension[i])
            # by what it moves and stretches, where the tension itself is beyond rounding
            step = abs(new - tension[i])
            effect = step * max(ease[i], ease[i + 1], soft[i]) / spacing
            largest = max(largest, min(effect, step / (1 + abs(tension[i]))))
            tension[i] = new
        if not largest < 1e300:
            return -1
        if largest * largest * spacing * bend <= 0.1 * tolerance:
            return iteration  # only the flow is nonlinear: what remains is of second order
        shrink = largest / previous
        if largest <= tolerance or (iteration > 1 and shrink < 0.3 and largest * shrink <= tolerance):
            return iteration
        previous = largest
    return -1


@njit(cache=True, error_model="numpy")
def error_norm(
    x: FloatArray, defect: FloatArray, speed: FloatArray, lead: int, watch: float, work: FloatArray
) -> float:
    """Largest filtered local error of a watched bead, as a time it is early or late.

    `defect` is the raw error as a position (zero where held), passed through the last Newton matrix so that stiff
    modes, which the scheme damps, do not count; `speed` is the local velocity ratio it is compared with.
    """
    n = x.size
    load, gap, ease = work[1], work[3], work[0]
    for i in range(n):
        load[i] = -defect[i]
        gap[i] = 0.0
    _eliminate(lead, ease, load, work[2], gap, work[4], work[5], work[6])
    largest = 0.0
    for i in range(n):
        if 0 < x[i] <= watch:
            largest = max(largest, abs(work[6][i] / speed[i]))
    return largest
