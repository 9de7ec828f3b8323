"""Compiled march of the steady network (`manifold`): one panel, a stretch of jet, and whole networks by the row.

The march of one network and that of thousands of rows call the same `panel`, so that a row of a sweep is its single run.
"""

import math
from functools import lru_cache

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.network._force_kernels import LINEAR, extension_kernel, stiffness_kernel

__all__ = [
    "STAGES",
    "begin_of",
    "first_step",
    "march_flow",
    "march_rows",
    "new_step",
    "panel",
    "passage",
    "root_linear",
    "tables",
    "tensions",
]

STAGES = 12
_FAILED = -1.0  # in place of an error: Newton's iteration did not converge
_SERVED = 1e-8  # relative change after which the next one, its square, is rounding
_FORGOTTEN = 14.0  # as `far_end`
_SAMPLES = 33  # of a panel, in which a passage is looked for

Law = tuple[int, float, float]  # code, contour, force at rest
Flow = tuple[float, float, float]  # V = max(offset + s/scale, 1)^exponent
Tables = tuple[FloatArray, FloatArray, FloatArray]


@lru_cache(maxsize=1)
def tables() -> Tables:
    """Nodes (0 and the Radau IIA nodes on (0, 1]), integration matrix, and values-to-Legendre matrix."""
    legendre = np.polynomial.legendre
    difference = np.zeros(STAGES + 1)
    difference[STAGES], difference[STAGES - 1] = 1.0, -1.0
    roots = np.sort(legendre.legroots(difference).real)
    roots[-1] = 1.0
    derivative = legendre.legder(difference)
    for _ in range(3):
        inner = roots[:-1]
        roots[:-1] = inner - legendre.legval(inner, difference) / legendre.legval(inner, derivative)
    vander = legendre.legvander(roots, STAGES - 1)
    integrals = np.stack(
        [legendre.legval(roots, legendre.legint(np.eye(STAGES)[k], lbnd=-1)) for k in range(STAGES)], axis=1
    )
    nodes = np.concatenate(([-1.0], roots))
    to_legendre = np.linalg.inv(legendre.legvander(nodes, STAGES))
    integral = 0.5 * integrals @ np.linalg.inv(vander)
    return (0.5 * (1 + nodes)).astype(np.float64), integral.astype(np.float64), to_legendre.astype(np.float64)


@njit(cache=True, error_model="numpy")
def _stretch(law: Law, tension: float) -> tuple[float, float]:
    """Stretch and compliance dw/dT; the latter 0 where the first rounds to the contour."""
    code, contour, rest = law
    if code == LINEAR:
        return tension, 1.0
    x = extension_kernel(code, tension * rest, rest)
    if not abs(x) < 1:
        return contour * x, 0.0
    return contour * x, 3 / stiffness_kernel(code, x, rest)


@njit(cache=True, error_model="numpy")
def _solve(a: FloatArray, b: FloatArray) -> None:
    """Solve a x = b in place by elimination with row pivots; x in b."""
    n = STAGES
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(k, n):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
            b[k], b[pivot] = b[pivot], b[k]
        inverse = 1 / a[k, k]
        for i in range(k + 1, n):
            factor = a[i, k] * inverse
            if factor != 0.0:
                for j in range(k + 1, n):
                    a[i, j] -= factor * a[k, j]
                b[i] -= factor * b[k]
    for k in range(n - 1, -1, -1):
        total = b[k]
        for j in range(k + 1, n):
            total -= a[k, j] * b[j]
        b[k] = total / a[k, k]


@njit(cache=True, error_model="numpy")
def _newton(
    y: FloatArray,
    v: FloatArray,
    step: float,
    eps: float,
    inertia: float,
    law: Law,
    integral: FloatArray,
    work: FloatArray,
) -> bool:
    """Tensions y[1:] at the nodes of a panel that starts at y[0], from the guess in them."""
    n, start = STAGES, y[0]
    rate, slope, residual, matrix = work[n], work[n + 1], work[n + 2], work[:n]
    moved, size = 0.0, 0.0
    for _ in range(30):
        for j in range(n):
            w, compliance = _stretch(law, y[j + 1])
            if not (w > 0 and w < math.inf):
                return False
            # dT/ds = (w - V)/((eps - I dw/dT) w), and its derivative with respect to T
            pull = eps - inertia * compliance
            share = v[j + 1] / w
            rate[j] = step * (1 - share) / pull
            slope[j] = step * share / w * compliance / pull
        for i in range(n):
            total = y[i + 1] - start
            for j in range(n):
                total -= integral[i, j] * rate[j]
                matrix[i, j] = -integral[i, j] * slope[j]
            matrix[i, i] += 1.0
            residual[i] = total
        _solve(matrix, residual)
        moved, size = 0.0, 0.0
        for j in range(n):
            y[j + 1] -= residual[j]
            if not abs(y[j + 1]) < math.inf:
                return False
            moved, size = max(moved, abs(residual[j])), max(size, abs(y[j + 1]))
        if moved <= 1e-14 * size + 1e-300 or (law[0] == LINEAR and moved <= _SERVED * size):
            break
    for j in range(n):
        if not _stretch(law, y[j + 1])[0] > 0:
            return False
    return moved <= 1e-11 * size or (law[0] == LINEAR and moved <= _SERVED * size)


@njit(cache=True, error_model="numpy")
def panel(
    v: FloatArray,
    follows: FloatArray,
    start: float,
    step: float,
    eps: float,
    inertia: float,
    law: Law,
    integral: FloatArray,
    to_legendre: FloatArray,
    work: FloatArray,
    coefficients: FloatArray,
) -> float:
    """Legendre coefficients of T over a signed step; the size of the last ones, or -1 where there is no solution.

    `v` is V at the start and the nodes, `follows` the tension of strands that move with it. `work` is (stages + 5,
    stages + 1).
    """
    n = STAGES
    y = work[n + 3]
    near = abs(follows[0] - start) < 0.6 * start
    solved = False
    for trial in range(3):
        y[0] = start
        if (trial == 0) == near:  # beyond the layer at the end the network follows the jet
            share = start / follows[0] if trial == 0 and law[0] == LINEAR else 1.0
            for j in range(n):
                y[j + 1] = follows[j + 1] * share
        elif trial < 2:
            for j in range(n):
                y[j + 1] = start
        else:
            continue
        if _newton(y, v, step, eps, inertia, law, integral, work[:, :n]):
            solved = True
            break
    if not solved:
        return _FAILED
    worst = _tail(y, to_legendre, coefficients, law)
    if step < 0:
        for k in range(1, n + 1, 2):
            coefficients[k] = -coefficients[k]
    return worst


@njit(cache=True, error_model="numpy")
def _tail(y: FloatArray, to_legendre: FloatArray, coefficients: FloatArray, law: Law) -> float:
    """Coefficients of y; the largest of the last two of them, and of those of w, over the largest value."""
    n = STAGES
    size, w_size, w_last, w_before = 0.0, 0.0, 0.0, 0.0
    for k in range(n + 1):
        total = 0.0
        for j in range(n + 1):
            total += to_legendre[k, j] * y[j]
        coefficients[k] = total
        size = max(size, abs(y[k]))
        if law[0] != LINEAR:
            w = _stretch(law, y[k])[0]
            w_size = max(w_size, abs(w))
            w_last += to_legendre[n, k] * w
            w_before += to_legendre[n - 1, k] * w
    tail = max(abs(coefficients[n]), abs(coefficients[n - 1])) / size
    if law[0] != LINEAR:
        tail = max(tail, max(abs(w_last), abs(w_before)) / w_size)
    return float(tail)


@njit(cache=True, error_model="numpy")
def new_step(error: float) -> float:
    """Factor on the step after one of that error over the tolerance (-1: none); below 1 it is to be done again."""
    if error < 0:
        return 0.4
    if error > 1:
        return float(max(0.15, min(0.7, (0.1 / error) ** (1 / 12))))
    # in stages of 19 %: the last coefficients are near rounding, and steps should not follow it
    stages = math.floor(math.log2(0.1 / max(error, 1e-12)) / 3)
    return float(2.0 ** (0.25 * min(max(stages, 0), 8)))


@njit(cache=True, error_model="numpy")
def _flow(flow: Flow, s: float) -> float:
    return float(max(flow[0] + s / flow[1], 1.0) ** flow[2])


@njit(cache=True, error_model="numpy")
def _slope(flow: Flow, s: float, v: float) -> float:
    """dV/ds where V is v; downstream of a kink at the kink itself."""
    base = flow[0] + s / flow[1]
    return flow[2] * v / (flow[1] * base) if base >= 1 else 0.0


@njit(cache=True, error_model="numpy")
def root_linear(flow: Flow, s: float, eps: float, inertia: float) -> float:
    """Slow root of a linear spring, as `far_end.root_of`."""
    v = _flow(flow, s)
    room = 1 - 4 * (eps - inertia) * _slope(flow, s, v)
    return 2 * v if room < 0 else 2 * v / (1 + math.sqrt(room))


@njit(cache=True, error_model="numpy")
def begin_of(flow: Flow, length: float, eps: float, beyond: FloatArray) -> float:
    """Where a march of linear springs begins, as `far_end.elastic_reach`; `beyond` are its places for a length of 1."""
    passed, before, s = 0.0, 0.0, length
    for k in range(beyond.size):
        last, s = s, length * beyond[k]
        v = _flow(flow, s)
        w = 2 * v / (1 + math.sqrt(min(max(1 - 4 * eps * _slope(flow, s, v), 0.0), 1.0)))
        rate = v / (eps * w * w)
        if k:
            passed += 0.5 * (rate + before) * (s - last)
        if passed >= _FORGOTTEN:
            break
        before = rate
    return max(s, length)


@njit(cache=True, error_model="numpy")
def march_flow(
    flow: Flow,
    low: float,
    high: float,
    tension: float,
    direction: float,
    first: float,
    trials: int,
    eps: float,
    inertia: float,
    law: Law,
    rtol: float,
    nodes: FloatArray,
    integral: FloatArray,
    to_legendre: FloatArray,
    count: int,
    edges: FloatArray,
    panels: FloatArray,
) -> tuple[float, int, int, float]:
    """March from one break to the next: the tension there, panels so far, trials left, and where it failed (-1: nowhere).

    `edges` (m, 2) and `panels` (m, stages + 1) are filled from `count` on. Only for springs that need no stretch of the
    flow's tension other than V (`linear`).
    """
    work = np.empty((STAGES + 5, STAGES + 1))
    v = work[STAGES + 4]
    start, stop = (high, low) if direction < 0 else (low, high)
    distance, done, step = high - low, 0.0, first
    while done < distance:
        step, trials = min(step, distance - done), trials - 1
        last = distance - done <= step * (1 + 1e-12)
        a = start + direction * done
        b = stop if last else start + direction * (done + step)
        for j in range(STAGES + 1):
            v[j] = _flow(flow, max(a + direction * step * nodes[j], 0.0))
        error = (
            panel(v, v, tension, direction * step, eps, inertia, law, integral, to_legendre, work, panels[count]) / rtol
        )
        factor = new_step(error)
        if factor < 1 or trials < 0:
            if step < 1e-15 * done + 1e-30 * distance or trials < 0:
                return tension, count, trials, a
            step *= factor
            continue
        tension = 0.0
        for k in range(STAGES + 1):
            tension += panels[count, k] if direction > 0 or k % 2 == 0 else -panels[count, k]
        if a != b:  # a layer thinner than the rounding of s is marched through, but has no place to be stored
            edges[count, 0], edges[count, 1] = min(a, b), max(a, b)
            count += 1
        done = distance if last else done + step
        step *= factor
    return tension, count, trials, -1.0


@njit(cache=True, error_model="numpy")
def _series(coefficients: FloatArray, x: float) -> float:
    """Legendre series by Clenshaw's recurrence."""
    n = coefficients.size - 1
    later, last = 0.0, 0.0
    for k in range(n, 0, -1):
        later, last = coefficients[k] + (2 * k + 1) / (k + 1) * x * later - (k + 1) / (k + 2) * last, later
    return float(coefficients[0] + x * later - last / 2)


@njit(cache=True, error_model="numpy")
def tensions(edges: FloatArray, panels: FloatArray, places: FloatArray, out: FloatArray) -> None:
    """T at places within panels between increasing edges."""
    for i in range(places.size):
        k = min(max(np.searchsorted(edges, places[i], side="right") - 1, 0), edges.size - 2)
        low, high = edges[k], edges[k + 1]
        out[i] = _series(panels[k], 2 * (places[i] - low) / (high - low) - 1)


@njit(cache=True, error_model="numpy")
def _value(low: float, high: float, coefficients: FloatArray, law: Law, s: float) -> float:
    return _stretch(law, _series(coefficients, 2 * (s - low) / (high - low) - 1))[0]


@njit(cache=True, error_model="numpy")
def passage(
    edges: FloatArray, panels: FloatArray, count: int, backward: bool, law: Law, length: float, stretch: float
) -> float:
    """First s within the length where w passes a value; NaN where it never does. Panels from the nozzle on, or backward."""
    for i in range(count):
        k = count - 1 - i if backward else i
        low, high = edges[k, 0], edges[k, 1]
        if low >= length:
            break
        end = min(high, length)
        before = low
        for m in range(_SAMPLES):
            s = low + (end - low) * (m / (_SAMPLES - 1.0))
            value = _value(low, high, panels[k], law, s)
            if value >= stretch:
                if m == 0:
                    return float(low)
                return _crossing(low, high, panels[k], law, stretch, before, s)
            before = s
    return math.nan


@njit(cache=True, error_model="numpy")
def _crossing(low: float, high: float, coefficients: FloatArray, law: Law, stretch: float, a: float, b: float) -> float:
    """Where w passes a value between a (below) and b (above): false position that keeps its bracket, to rounding."""
    below = _value(low, high, coefficients, law, a) - stretch
    above = _value(low, high, coefficients, law, b) - stretch
    side = 0
    for i in range(200):
        if b - a <= 2e-16 * (abs(a) + abs(b)) or above == 0.0:
            break
        s = a - below * (b - a) / (above - below)
        if i % 4 == 3 or not (a < s < b):
            s = 0.5 * (a + b)
        value = _value(low, high, coefficients, law, s) - stretch
        if value >= 0:
            b, above = s, value
            if side > 0:
                below *= 0.5
            side = 1
        else:
            a, below = s, value
            if side < 0:
                above *= 0.5
            side = -1
    return b


@njit(cache=True, error_model="numpy")
def march_rows(
    flows: FloatArray,
    lengths: FloatArray,
    kinks: FloatArray,
    eps: FloatArray,
    rtols: FloatArray,
    targets: FloatArray,
    places: FloatArray,
    held: int,
    beyond: FloatArray,
    nodes: FloatArray,
    integral: FloatArray,
    to_legendre: FloatArray,
    most: int,
    stretch: FloatArray,
    passes: FloatArray,
) -> None:
    """Steady networks of linear springs without inertia along many jets: w at places, and where it passes a value.

    Parameters
    ----------
    flows : ndarray, (rows, 3)
        Offset, scale and exponent of V.
    lengths, kinks, eps, rtols : ndarray, (rows,)
        Initial radii; kinks of 0 are none.
    targets : ndarray, (rows, k)
        Stretches whose passages are wanted.
    places : ndarray, (rows, m)
        Initial radii; NaN for none.
    held : int
        0 "take-up", 1 "free", 2 "extended".
    beyond : ndarray
        `far_end.beyond` of 1.
    nodes, integral, to_legendre
        `tables`.
    most : int
        Trials of panels.
    stretch : ndarray, (rows, m)
        Filled; NaN throughout for a row that cannot be resolved.
    passes : ndarray, (rows, k)
        Filled.
    """
    law = (LINEAR, math.inf, 0.0)
    edges = np.empty((most, 2))
    panels = np.empty((most, STAGES + 1))
    for i in range(lengths.size):
        flow = (flows[i, 0], flows[i, 1], flows[i, 2])
        begin = lengths[i] if held == 1 else begin_of(flow, lengths[i], eps[i], beyond)
        tension = root_linear(flow, begin, eps[i], 0.0) if held == 0 else 1.0
        count, trials, failed = 0, most - 201, -1.0
        inside = kinks[i] > 0 and kinks[i] < begin
        for part in range(2 if inside else 1):
            high = kinks[i] if part == 1 else begin
            low = kinks[i] if inside and part == 0 else 0.0
            tension, count, trials, failed = march_flow(
                flow,
                low,
                high,
                tension,
                -1.0,
                first_step(high - low, eps[i], part == 0 and held == 0),
                trials + 100,
                eps[i],
                0.0,
                law,
                rtols[i],
                nodes,
                integral,
                to_legendre,
                count,
                edges,
                panels,
            )
            if failed >= 0:
                break
        for m in range(places.shape[1]):
            stretch[i, m] = math.nan
        passes[i, :] = math.nan
        if failed >= 0:
            continue
        for m in range(targets.shape[1]):
            passes[i, m] = passage(edges, panels, count, True, law, lengths[i], targets[i, m])
        for m in range(places.shape[1]):
            stretch[i, m] = _at(edges, panels, count, places[i, m])


@njit(cache=True, error_model="numpy")
def first_step(distance: float, pull: float, slow: bool) -> float:
    """First step of a march: of the layer at its start, or of the jet where it starts on the slow root."""
    layer = 0.1 * max(pull, 1e-15 * distance)
    return min(distance, max(layer, 0.25 * distance if slow else 0.0))


@njit(cache=True, error_model="numpy")
def _at(edges: FloatArray, panels: FloatArray, count: int, s: float) -> float:
    """Stretch at a place, of panels from the far end to the nozzle."""
    if not s >= 0:
        return math.nan
    for k in range(count - 1, -1, -1):
        if s < edges[k, 1] or k == 0:
            low, high = edges[k, 0], edges[k, 1]
            return _series(panels[k], 2 * (s - low) / (high - low) - 1)
    return math.nan
