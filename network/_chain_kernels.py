"""Compiled loops of the bead chain; every loop is O(beads). What they solve stands in `chain`.

Bead 0 is farthest from the nozzle; strand i joins bead i to bead i + 1 behind it. The tension of a strand is an
unknown of its own: its stretch w(T) is an explicit, bounded function, so that a locked strand (w'(T) -> 0) is as well
conditioned as a slack one, and eliminating the positions leaves one tridiagonal system for the tensions.
"""

import math

from numba import njit

from spinline.checks import FloatArray
from spinline.network._force_kernels import FENE, LATTICE, LINEAR, extension_kernel

__all__ = ["ages_of", "error_norm", "positions_of", "rates", "slowness_of", "solve_stage"]

_KNEE = 3.0  # normalised force where the laws bend


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
def _cell(nodes: FloatArray, x: float, j: int) -> int:
    """Cell of the table that holds x, walking from cell j: beads come in order."""
    last = nodes.size - 2
    while j < last and x >= nodes[j + 1]:
        j += 1
    while j > 0 and x < nodes[j]:
        j -= 1
    return j


@njit(cache=True, error_model="numpy")
def _lookup(
    nodes: FloatArray, age: FloatArray, slow: FloatArray, x: float, j: int
) -> tuple[float, float, float]:
    """Age a(x), V = 1/a' and V'; straight outside the table."""
    last = nodes.size - 1
    if x <= nodes[0]:
        return age[0] + (x - nodes[0]) * slow[0], 1 / slow[0], 0.0
    if x >= nodes[last]:
        return age[last] + (x - nodes[last]) * slow[last], 1 / slow[last], 0.0
    width = nodes[j + 1] - nodes[j]
    t = (x - nodes[j]) / width
    p = slow[j]
    q = slow[j + 1]
    mean = (age[j + 1] - age[j]) / width
    b = 3 * mean - 2 * p - q
    c = p + q - 2 * mean
    slope = p + t * (2 * b + 3 * t * c)
    curve = (2 * b + 6 * t * c) / width
    return age[j] + width * t * (p + t * (b + t * c)), 1 / slope, -curve / (slope * slope)


@njit(cache=True, error_model="numpy")
def _two(
    nodes: FloatArray, age: FloatArray, slow: FloatArray, share: float, x: float, j: int
) -> tuple[float, float, float, float, float]:
    """Age, reference V and V', and V and V' now; tables of shape (2, nodes), the second is the reference."""
    a, v, dv = _lookup(nodes, age[1], slow[1], x, j)
    if share >= 1.0:
        return a, v, dv, v, dv
    _, u, du = _lookup(nodes, age[0], slow[0], x, j)
    return a, v, dv, share * v + (1 - share) * u, share * dv + (1 - share) * du


@njit(cache=True, error_model="numpy")
def ages_of(nodes: FloatArray, age: FloatArray, slow: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Reference age of each bead."""
    j = nodes.size - 2
    for i in range(x.size):
        j = _cell(nodes, x[i], j)
        out[i] = _lookup(nodes, age[1], slow[1], x[i], j)[0]


@njit(cache=True, error_model="numpy")
def slowness_of(nodes: FloatArray, age: FloatArray, slow: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Reference 1/V at each bead."""
    j = nodes.size - 2
    for i in range(x.size):
        j = _cell(nodes, x[i], j)
        out[i] = 1 / _lookup(nodes, age[1], slow[1], x[i], j)[1]


@njit(cache=True, error_model="numpy")
def positions_of(nodes: FloatArray, age: FloatArray, slow: FloatArray, a: FloatArray, out: FloatArray) -> None:
    """Position of each reference age, to rounding of a first guess: the inverse of `ages_of`."""
    table = age[1]
    last = nodes.size - 1
    j = last - 1
    for i in range(a.size):
        if a[i] <= table[0]:
            out[i] = nodes[0] + (a[i] - table[0]) / slow[1, 0]
        elif a[i] >= table[last]:
            out[i] = nodes[last] + (a[i] - table[last]) / slow[1, last]
        else:
            j = _cell(table, a[i], j)
            x = nodes[j] + (nodes[j + 1] - nodes[j]) * (a[i] - table[j]) / (table[j + 1] - table[j])
            width = nodes[j + 1] - nodes[j]
            for _ in range(4):
                now, v, _ = _lookup(nodes, table, slow[1], x, j)
                step = (a[i] - now) * v
                x = min(max(x + step, nodes[j]), nodes[j + 1])
                if abs(step) < 1e-6 * width:
                    break
            out[i] = x


@njit(cache=True, error_model="numpy")
def _felt(ahead: float, behind: float, cut: float, tension: float, rest_tension: float) -> tuple[float, float, float, float]:
    """Tension that a strand passes on, and its derivatives by T and by the positions ahead and behind.

    A strand that straddles the end of the domain passes on the share of it that is still inside.
    """
    if ahead <= cut:
        return tension, 1.0, 0.0, 0.0
    if behind >= cut:
        return rest_tension, 0.0, 0.0, 0.0
    d = ahead - behind
    share = (cut - behind) / d
    excess = tension - rest_tension
    return rest_tension + share * excess, share, -share * excess / d, -(1 - share) * excess / d


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
    before = rest_tension
    for i in range(n):
        behind = rest_tension
        if i < n - 1:
            behind = _felt(x[i], x[i + 1], cut, tension[i], rest_tension)[0]
        j = _cell(nodes, x[i], j)
        _, v, _, now, _ = _two(nodes, age, slow, share, x[i], j)
        surplus[i] = 0.0
        if i >= free:
            velocity[i] = 1.0
        elif inertia == 0.0:
            velocity[i] = now + pull * (before - behind)
        else:
            surplus[i] = now + pull * (before - behind) - velocity[i]
        rate[i] = velocity[i] / v
        before = behind


@njit(cache=True, error_model="numpy")
def _eliminate(
    size: int,
    weight: FloatArray,
    load: FloatArray,
    near: FloatArray,
    far: FloatArray,
    soft: FloatArray,
    gap: FloatArray,
    kappa: float,
    upper: FloatArray,
    change: FloatArray,
    move: FloatArray,
) -> None:
    """Newton correction of felt tensions and positions, for strands 0..size-1 and beads 0..size.

    Beads ``dx = -load + kappa weight (dT_ahead - dT_behind)``, strands
    ``far dx_ahead - near dx_behind - soft dT = -gap``: Thomas' algorithm, diagonally dominant.
    """
    for i in range(size):
        lower = far[i] * kappa * weight[i]
        right = near[i] * kappa * weight[i + 1]
        diagonal = lower + right + soft[i]
        value = gap[i] - far[i] * load[i] + near[i] * load[i + 1]
        if i > 0:
            diagonal -= lower * upper[i - 1]
            value += lower * change[i - 1]
        upper[i] = right / diagonal
        change[i] = value / diagonal
    for i in range(size - 2, -1, -1):
        change[i] += upper[i] * change[i + 1]
    ahead = 0.0
    for i in range(size + 1):
        behind = change[i] if i < size else 0.0
        move[i] = -load[i] + kappa * weight[i] * (ahead - behind)
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
    work: FloatArray,
) -> int:
    """Solve one implicit stage by Newton's method; x and tension hold the guess, then the solution.

    ``a(x) = known_age + g v / V(x)``, ``I v = push + g (V + pull dT - v)``; beads from `free` on are held.
    Returns the number of iterations, or -1. `work` keeps the last linearisation for `error_norm`.
    """
    n = x.size
    size = n - 1
    gain = g * (g / (inertia + g))
    lag = g / (inertia + g)
    kappa = gain * pull
    weight, load, near, far = work[0], work[1], work[2], work[3]
    soft, gap, upper, change, move, felt = work[4], work[5], work[6], work[7], work[8], work[9]
    previous = math.inf
    for iteration in range(1, most + 1):
        for i in range(size):
            if code == LINEAR:
                w = tension[i]
                dw = 1.0
            else:
                w = contour * extension_kernel(code, tension[i] * rest, rest)
                dw = 3 * compliance_kernel(code, tension[i] * rest, rest)
            felt[i], part, by_ahead, by_behind = _felt(x[i], x[i + 1], cut, tension[i], rest_tension)
            soft[i] = spacing * dw if part > 0 else 1.0
            far[i] = part + spacing * dw * by_ahead
            near[i] = part - spacing * dw * by_behind
            gap[i] = part * (x[i] - x[i + 1] - spacing * w)
        j = nodes.size - 2
        for i in range(n):
            if i >= free:
                weight[i] = 0.0
                load[i] = 0.0
                continue
            j = _cell(nodes, x[i], j)
            a, v, dv, now, dnow = _two(nodes, age, slow, share, x[i], j)
            ahead = felt[i - 1] if i > 0 else rest_tension
            behind = felt[i] if i < size else rest_tension
            residual = v * (a - known_age[i]) - lag * push[i] - gain * now - kappa * (ahead - behind)
            slope = 1 + dv * (a - known_age[i]) - gain * dnow
            if not slope > 0.05:
                return -1
            weight[i] = 1 / slope
            load[i] = residual / slope
        _eliminate(size, weight, load, near, far, soft, gap, kappa, upper, change, move)
        largest = 0.0
        for i in range(n):
            largest = max(largest, abs(move[i]) / spacing)
        for i in range(n):
            x[i] += move[i]
        for i in range(size):
            new = tension[i] + change[i]
            if x[i] > cut:  # the unknown is what the strand passes on; T follows from the share inside
                if x[i + 1] >= cut:
                    tension[i] = rest_tension
                    continue
                part = (cut - x[i + 1]) / (x[i] - x[i + 1])
                new = rest_tension + (felt[i] + change[i] - rest_tension) / part if part > 1e-9 else rest_tension
            elif x[i] - move[i] > cut:
                new = felt[i] + change[i]
            knee = _KNEE / rest
            if code != LINEAR and abs(tension[i]) > knee and new * math.copysign(1.0, tension[i]) < knee:
                new = math.copysign(knee, tension[i])
            if x[i] <= cut:
                largest = max(largest, abs(new - tension[i]) / (1 + abs(tension[i])))
            tension[i] = new
        if not largest < 1e300:
            return -1
        shrink = largest / previous
        if largest <= tolerance or (shrink < 0.3 and largest * shrink <= tolerance):
            return iteration
        previous = largest
    return -1


@njit(cache=True, error_model="numpy")
def error_norm(
    x: FloatArray,
    defect: FloatArray,
    speed: FloatArray,
    g: float,
    pull: float,
    inertia: float,
    watch: float,
    work: FloatArray,
) -> float:
    """Root mean square over the watched beads of the filtered local error, as a change of position.

    `defect` is the raw error as a position (zero where held), passed through the last Newton matrix so that stiff
    modes, which the scheme damps, do not count; `speed` is the local velocity ratio it is compared with.
    """
    n = x.size
    kappa = g * (g / (inertia + g)) * pull
    load, gap = work[1], work[5]
    for i in range(n):
        load[i] = -defect[i]
        gap[i] = 0.0
    _eliminate(n - 1, work[0], load, work[2], work[3], work[4], gap, kappa, work[6], work[7], work[8])
    total = 0.0
    count = 0
    for i in range(n):
        if 0 < x[i] <= watch:
            size = work[8][i] / speed[i]
            total += size * size
            count += 1
    return math.sqrt(total / count) if count else 0.0
