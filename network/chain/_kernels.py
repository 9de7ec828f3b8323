"""Compiled loops of the bead chain; every loop is O(beads). What they solve stands in `chain`, the scheme in `chain_step`.

Bead 0 is farthest from the nozzle; strand i joins bead i to bead i + 1 behind it. The tension of a strand is an
unknown of its own: its stretch w(T) is an explicit, bounded function, so that a locked strand (w'(T) -> 0) is as well
conditioned as a slack one, and eliminating the positions leaves one tridiagonal system for the tensions. A Newton
iteration is two passes: forward it looks up the flow and eliminates, backward it substitutes and corrects.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.network._force_kernels import FENE, LATTICE, LINEAR, extension_kernel
from spinline.network.chain._flow_kernels import place, reference, search, speed_now

__all__ = ["ROWS", "compliance_kernel", "rates", "step"]

_GAMMA = 2 - math.sqrt(2)
_D = _GAMMA / 2
_W = math.sqrt(2) / 4
_E1, _E2, _E3 = (4 * _W - 1) / 3, -1 / 3, 2 * _D / 3  # second-order weights less third-order ones

_KNEE = 3.0  # normalised force where the laws bend
_LEAST_SLOPE = 0.05  # of a bead's equation; below, the step is too long for the flow
_LEAST_SHARE = 1e-9  # of drag, below which a bead is gone
ROWS = 9
"""Arrays of length n that `step` works in."""


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
    edges: FloatArray,
    cells: FloatArray,
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
    """Set the rate of age v / U of every bead and ``I x''``, from the equation itself; sets v too where I = 0."""
    n = x.size
    j = cells.shape[0] - 1
    lead, part = _far_end(x, cut, 0)
    for i in range(n):
        j = search(edges, x[i], j)
        _, slow, _ = reference(cells, x[i], j)
        now, _ = speed_now(cells, share, x[i], j, 1 / slow, 0.0)
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
        rate[i] = velocity[i] * slow


@njit(cache=True, error_model="numpy")
def _solve(
    edges: FloatArray,
    cells: FloatArray,
    share: float,
    x: FloatArray,
    tension: FloatArray,
    known: FloatArray,
    push: FloatArray,
    free: int,
    lead: int,
    part: float,
    g: float,
    pull: float,
    inertia: float,
    spacing: float,
    law: tuple[int, float, float, float],
    tolerance: float,
    most: int,
    work: FloatArray,
) -> int:
    """Solve one implicit stage by Newton's method; x and tension hold the guess, then the solution.

    ``b(x) = known + g v / U(x)``, ``I v = push + g (V + pull dT - v)``; beads from `free` on are held, beads before
    `lead` have left. Returns the number of iterations, or -1; `work` keeps the last elimination for `_filtered`.
    """
    n = x.size
    code, contour, rest, rest_tension = law
    gain = g * (g / (inertia + g))
    lag = g / (inertia + g)
    kappa = gain * pull
    ease, load, soft, upper, change = work[0], work[1], work[2], work[3], work[4]
    knee = _KNEE / rest
    previous = math.inf
    if code == LINEAR:
        for i in range(lead, n - 1):
            tension[i] = (x[i] - x[i + 1]) / spacing
    for iteration in range(1, most + 1):
        bend = 0.0
        j = cells.shape[0] - 1
        ahead = rest_tension
        for i in range(n):
            behind = tension[i] if i < n - 1 else rest_tension
            if i >= free:
                eased = 0.0
                loaded = 0.0
            else:
                j = search(edges, x[i], j)
                a, slow, rise = reference(cells, x[i], j)
                u = 1 / slow
                du = -rise * u * u
                now, dnow = speed_now(cells, share, x[i], j, u, du)
                passed = a - known[i]
                slope = 1 + du * passed - gain * dnow
                if not slope > _LEAST_SLOPE:
                    return -1
                strength = 0.0
                if i >= lead:
                    strength = kappa / part if i == lead else kappa
                inverse = 1 / slope
                loaded = (u * passed - lag * push[i] - gain * now - strength * (ahead - behind)) * inverse
                eased = strength * inverse
                bend = max(bend, abs(du) * slow * inverse)
            ease[i] = eased
            load[i] = loaded
            if i > lead:
                k = i - 1
                if code == LINEAR:
                    w = tension[k]
                    dw = 1.0
                else:
                    w = contour * extension_kernel(code, tension[k] * rest, rest)
                    dw = 3 * compliance_kernel(code, tension[k] * rest, rest)
                soft[k] = spacing * dw
                diagonal = ease[k] + eased + soft[k]
                value = x[k] - x[i] - spacing * w - load[k] + loaded
                if k > lead:
                    diagonal -= ease[k] * upper[k - 1]
                    value += ease[k] * change[k - 1]
                inverse = 1 / diagonal
                upper[k] = eased * inverse
                change[k] = value * inverse
            if i >= lead:
                ahead = behind
        moved = 0.0
        largest = 0.0
        total = 0.0
        later = 0.0  # correction of the tension behind the bead
        for i in range(n - 1, lead - 1, -1):
            now = 0.0
            if i > lead:
                k = i - 1
                now = change[k] + (upper[k] * later if i < n - 1 else 0.0)
                new = tension[k] + now
                if code != LINEAR:
                    if abs(tension[k]) > knee and new * math.copysign(1.0, tension[k]) < knee:
                        new = math.copysign(knee, tension[k])
                    # by what it moves and stretches, where the tension itself is beyond rounding
                    jump = abs(new - tension[k])
                    effect = jump * max(ease[k], ease[i], soft[k]) / spacing
                    largest = max(largest, min(effect, jump / (1 + abs(tension[k]))))
                tension[k] = new
            move = -load[i] + ease[i] * (now - later)
            x[i] += move
            total += move
            moved = max(moved, abs(move))
            later = now
        for i in range(lead):
            x[i] -= load[i]
            moved = max(moved, abs(load[i]))
        moved /= spacing
        largest = max(largest, moved)
        if not abs(total) < 1e300 or not largest < 1e300:
            return -1
        if code == LINEAR and moved * moved * spacing * bend <= 0.1 * tolerance:
            return iteration  # only the flow is nonlinear: what remains is of second order
        shrink = largest / previous
        if largest <= tolerance or (iteration > 1 and shrink < 0.3 and largest * shrink <= tolerance):
            return iteration
        previous = largest
    return -1


@njit(cache=True, error_model="numpy")
def _filtered(defect: FloatArray, lead: int, work: FloatArray) -> None:
    """Pass an error of position through the last Newton matrix: stiff modes, which the scheme damps, do not count."""
    n = defect.size
    ease, soft, upper, change = work[0], work[2], work[3], work[4]
    for k in range(lead, n - 1):
        # the inverse diagonal, from what was kept: upper = ease behind / diagonal
        diagonal = ease[k] + ease[k + 1] + soft[k]
        value = defect[k] - defect[k + 1]
        if k > lead:
            diagonal -= ease[k] * upper[k - 1]
            value += ease[k] * change[k - 1]
        change[k] = value / diagonal
    later = 0.0
    for i in range(n - 1, lead - 1, -1):
        now = 0.0
        if i > lead:
            now = change[i - 1] + (upper[i - 1] * later if i < n - 1 else 0.0)
        defect[i] += ease[i] * (now - later)
        later = now


@njit(cache=True, error_model="numpy")
def step(
    x_edges: FloatArray,
    age_edges: FloatArray,
    cells: FloatArray,
    shares: tuple[float, float],
    times: tuple[float, float, float],
    newest: int,
    free: tuple[int, int],
    start: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    pull: float,
    inertia: float,
    spacing: float,
    cut: float,
    law: tuple[int, float, float, float],
    tolerance: float,
    most: int,
    watch: float,
    x: FloatArray,
    tension: FloatArray,
    velocity: FloatArray,
    rate: FloatArray,
    surplus: FloatArray,
    work: FloatArray,
) -> tuple[int, int, float]:
    """One step of TR-BDF2; x, tension, velocity, rate and surplus become the new state.

    `start` holds positions, velocities, rates and surplus; `tension` starts as the tensions. `times` are those of the
    start and of both stages, `shares` and `free` belong to the stages. Returns the iterations (-1: Newton's method
    failed), the beads that have left, and the local error: root mean square over the released beads up to `watch`, as a time
    by which they are early or late, per unit of time (and of velocity, where inertia counts).
    """
    x0, v0, r0, s0 = start
    n = x.size
    dt = times[2] - times[0]
    g = _D * dt
    known, push, r2, s2 = work[5], work[6], work[7], work[8]
    massive = inertia > 0.0
    last = cells.shape[0] - 1
    j = last
    m = last
    for i in range(n):
        j = search(x_edges, x0[i], j)
        a, _, _ = reference(cells, x0[i], j)
        known[i] = a + g * r0[i]
        push[i] = inertia * v0[i] + g * s0[i] if massive else 0.0
        if i < free[0]:
            guess = a + 2 * g * r0[i]
            m = search(age_edges, guess, m)
            x[i] = place(cells, guess, m)
        else:
            x[i] = times[1] - spacing * (newest - n + 1 + i)
    lead, part = _far_end(x, cut, 0)
    for i in range(lead):
        tension[i] = law[3]
    first = _solve(
        x_edges,
        cells,
        shares[0],
        x,
        tension,
        known,
        push,
        free[0],
        lead,
        part,
        g,
        pull,
        inertia,
        spacing,
        law,
        tolerance,
        most,
        work,
    )
    if first < 0:
        return -1, lead, math.inf

    rest = 1 - _GAMMA
    bow = rest / (2 * _GAMMA)
    j = last
    m = last
    for i in range(n):
        j = search(x_edges, x[i], j)
        a, slow, _ = reference(cells, x[i], j)
        if i < free[0]:
            now = (a - known[i]) / g
            stiff = (inertia * now / slow - push[i]) / g if massive else 0.0
        else:
            now = slow
            stiff = 0.0
        known[i] += dt * _W * (r0[i] + now) - g * r0[i]
        if massive:
            push[i] = inertia * v0[i] + dt * _W * (s0[i] + stiff)
        r2[i] = now
        s2[i] = stiff
        if i < free[1]:
            guess = a + dt * rest * (now + (now - r0[i]) * bow)
            m = search(age_edges, guess, m)
            x[i] = place(cells, guess, m)
        else:
            x[i] = times[2] - spacing * (newest - n + 1 + i)
    lead, part = _far_end(x, cut, lead)
    for i in range(lead):
        tension[i] = law[3]
    second = _solve(
        x_edges,
        cells,
        shares[1],
        x,
        tension,
        known,
        push,
        free[1],
        lead,
        part,
        g,
        pull,
        inertia,
        spacing,
        law,
        tolerance,
        most,
        work,
    )
    if second < 0:
        return -1, lead, math.inf

    defect = known  # taken over entry by entry
    wrong = 0.0
    j = last
    for i in range(n):
        j = search(x_edges, x[i], j)
        a, slow, _ = reference(cells, x[i], j)
        if i < free[1]:
            now = (a - known[i]) / g
            v = now / slow
            stiff = (inertia * v - push[i]) / g if massive else 0.0
            defect[i] = dt * (_E1 * r0[i] + _E2 * r2[i] + _E3 * now) / slow
        else:
            now = slow
            v = 1.0
            stiff = 0.0
            defect[i] = 0.0
        if massive and i < free[1] and x[i] <= watch:
            bad = dt * (_E1 * s0[i] + _E2 * s2[i] + _E3 * stiff) / (inertia + g) * slow
            wrong += bad * bad
        rate[i] = now
        velocity[i] = v
        surplus[i] = stiff
        push[i] = slow
    _filtered(defect, lead, work)
    late = 0.0
    count = 0
    flung = True  # all watched beads beyond the watched part in one step: they count where they began
    for i in range(free[1]):
        if x[i] <= watch:
            flung = False
            break
    for i in range(free[1]):
        if (x0[i] if flung else x[i]) <= watch:
            bad = defect[i] * push[i] / dt
            late += bad * bad
            count += 1
    return first + second, lead, math.sqrt(max(late, wrong) / max(count, 1))
