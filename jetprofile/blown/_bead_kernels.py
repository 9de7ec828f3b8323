"""Loops of the bending jet: rates of a chain of beads, SSP-RK3 steps, landing, feeding. Nothing is checked here.

Beads run from the far end (0) to the start point (n - 1), which moves as it is told; element e joins beads e and e + 1; the
last element grows. `p` holds the constants in the order of `bead_jet._Constants`.

`touch`: when (NaN in flight), where and how fast a bead met the collector. Any bead may, also the belly of a loop before the
beads on its way: it sticks there. `flight`: length of an element when the first of its ends did (NaN in flight): slack when
its ends are nearer, drawn out, as any element in flight, when they are farther apart.
"""

import math

import numpy as np

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit

__all__ = ["advance", "elastic_step", "gap_of"]


@njit(cache=True, error_model="numpy")
def air_at(
    x: float, y: float, z: float, t: float, p: FloatArray, air: FloatArray, gust: FloatArray, out: FloatArray
) -> None:
    """Velocity of the air; `air`: columns x, centre speed, core radius, half width, fluctuation, carried time, length, then the
    weights of the modes, evenly spaced in x.
    """
    rows = air.shape[0]
    u = (x - air[0, 0]) / (air[1, 0] - air[0, 0])
    u = min(max(u, 0.0), rows - 1.000001)
    i = int(u)
    w = u - i
    speed = (1 - w) * air[i, 1] + w * air[i + 1, 1]
    core = (1 - w) * air[i, 2] + w * air[i + 1, 2]
    half = (1 - w) * air[i, 3] + w * air[i + 1, 3]
    shake = (1 - w) * air[i, 4] + w * air[i + 1, 4]
    r = math.sqrt(y * y + z * z) - core
    shape = 1.0
    if r > 0 and math.isfinite(half):
        s = r / half
        shape = math.exp(-0.6931471805599453 * s * s) if p[15] == 0 else 1 / (1 + 0.41421356237309515 * s * s) ** 2
    out[0] = speed * shape
    out[1] = 0.0
    out[2] = 0.0
    shake *= shape
    if shake > 1e-3:
        since = t - ((1 - w) * air[i, 5] + w * air[i + 1, 5])
        length = (1 - w) * air[i, 6] + w * air[i + 1, 6]
        for m in range(gust.shape[0]):
            if air[i, 7 + m] < 1e-3:
                continue
            angle = gust[m, 0] * since + (gust[m, 1] * y + gust[m, 2] * z) / length + gust[m, 6]
            c = shake * air[i, 7 + m] * math.cos(angle)
            out[0] += c * gust[m, 3]
            out[1] += c * gust[m, 4]
            out[2] += c * gust[m, 5]


@njit(cache=True, error_model="numpy")
def _spring(azz: float, arr: float, inverse: float) -> float:
    """Factor of a strand with an end, ``(L^2 - 3)/(L^2 - tr A)``; held at 1e6 of its room."""
    return (1 - 3 * inverse) / max(1 - (azz + 2 * arr) * inverse, 1e-6)


@njit(cache=True, error_model="numpy")
def rates(
    n: int,
    t: float,
    q: FloatArray,
    e: FloatArray,
    dq: FloatArray,
    de: FloatArray,
    flight: FloatArray,
    touch: FloatArray,
    p: FloatArray,
    air: FloatArray,
    gust: FloatArray,
    inlet: FloatArray,
    counts: FloatArray,
) -> None:
    """Rates of beads q (n, 6) and elements e (n - 1, 4): polymer + solvent volume, A_zz, A_rr, polymer volume."""
    rho, g_mod, theta, mu_s, sigma = p[0], p[1], p[2], p[3], p[4]
    rho_g, nu, factor, power, gravity = p[5], p[6], p[7], p[8], p[9]
    lift, flow, drying, phi0 = p[10], p[11], p[12], p[13]
    wind = np.empty(3)
    for i in range(n):
        for k in range(3):
            dq[i, k] = q[i, 3 + k]
            dq[i, 3 + k] = 0.0
    kx = ky = kz = 0.0  # direction of the element before
    reach_before = 0.0
    for j in range(n - 1):
        dx, dy, dz = q[j + 1, 0] - q[j, 0], q[j + 1, 1] - q[j, 1], q[j + 1, 2] - q[j, 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        tx, ty, tz = dx / length, dy / length, dz / length
        rate = ((q[j + 1, 3] - q[j, 3]) * tx + (q[j + 1, 4] - q[j, 4]) * ty + (q[j + 1, 5] - q[j, 5]) * tz) / length
        volume = e[j, 0]
        slack = length < flight[j]  # half on the collector: it neither pulls nor pushes, nor grows shorter
        if slack:
            rate = 0.0
        area = volume / (flight[j] if slack else length)
        a = math.sqrt(area / math.pi)
        g, th = g_mod, theta
        if drying > 0:
            c_ratio = e[j, 3] / volume / phi0
            th = theta * c_ratio
            c0, c1 = phi0, min(phi0 * c_ratio, 1.0)
            mu = 10.0 ** (p[16] * (c1 ** p[17] - c0 ** p[17]))
            g = g_mod * mu / c_ratio
        azz, arr = e[j, 1], e[j, 2]
        h = _spring(azz, arr, p[14])
        pull = 0.0
        if not slack:
            pull = area * (g * h * (azz - arr) + 3 * mu_s * rate) + math.pi * a * sigma
        x, y, z = 0.5 * (q[j, 0] + q[j + 1, 0]), 0.5 * (q[j, 1] + q[j + 1, 1]), 0.5 * (q[j, 2] + q[j + 1, 2])
        air_at(x, y, z, t, p, air, gust, wind)
        wx = wind[0] - 0.5 * (q[j, 3] + q[j + 1, 3])
        wy = wind[1] - 0.5 * (q[j, 4] + q[j + 1, 4])
        wz = wind[2] - 0.5 * (q[j, 5] + q[j + 1, 5])
        along = wx * tx + wy * ty + wz * tz
        nx, ny, nz = wx - along * tx, wy - along * ty, wz - along * tz
        across = math.sqrt(nx * nx + ny * ny + nz * nz)
        push_t = factor * math.pi * a * rho_g * (2 * a / nu) ** -power * abs(along) ** (2 - power)
        push_t = math.copysign(push_t, along) * length
        push_n = 0.0
        if across > 0:
            re = 2 * a * across / nu
            c_n = 1.18 + 6.8 * re**-0.89 + 1.96 * re**-0.5 - 0.0004 * re / (1 + 3.64e-7 * re * re)
            push_n = c_n * a * rho_g * across * length
        fx = 0.5 * (push_t * tx + push_n * nx)
        fy = 0.5 * (push_t * ty + push_n * ny)
        fz = 0.5 * (push_t * tz + push_n * nz)
        dq[j, 3] += pull * tx + fx
        dq[j, 4] += pull * ty + fy
        dq[j, 5] += pull * tz + fz
        dq[j + 1, 3] += fx - pull * tx
        dq[j + 1, 4] += fy - pull * ty
        dq[j + 1, 5] += fz - pull * tz
        reach = rho_g * area * along * along
        if lift > 0 and j > 0:
            weight = 0.5 * (reach + reach_before)
            dq[j, 3] -= (tx - kx) * weight
            dq[j, 4] -= (ty - ky) * weight
            dq[j, 5] -= (tz - kz) * weight
        counts[0] += 1.0
        if pull < reach and not slack:
            counts[1] += 1.0
        kx, ky, kz, reach_before = tx, ty, tz, reach
        de[j, 0] = de[j, 3] = 0.0
        de[j, 1] = 2 * rate * azz
        de[j, 2] = -rate * arr
        if th > 0 and math.isfinite(th):
            de[j, 1] -= (h * azz - 1) / th
            de[j, 2] -= (h * arr - 1) / th
        if drying > 0:
            wet = volume - e[j, 3]
            if wet > 0:
                speed = math.sqrt(wx * wx + wy * wy + wz * wz)
                # Eq. (43a), falling with the solvent left in the last tenth so that it cannot pass zero
                de[j, 0] = -drying * (2 * a * speed / nu) ** (1 / 3) * length * min(1.0, 10 * wet / volume)
    m = n - 2
    de[m, 0] += flow
    de[m, 3] += flow * phi0
    de[m, 1] += flow / e[m, 0] * (inlet[0] - e[m, 1])
    de[m, 2] += flow / e[m, 0] * (inlet[1] - e[m, 2])
    for i in range(n):
        mass = 0.5 * rho * ((e[i - 1, 0] if i > 0 else 0.0) + (e[i, 0] if i < n - 1 else 0.0))
        for k in range(3):
            dq[i, 3 + k] /= mass
        dq[i, 3] += gravity
    for i in range(n):  # the start moves as told; what has landed rests in the moving surface
        if i == n - 1 or not math.isnan(touch[i, 0]):
            for k in range(3):
                dq[i, 3 + k] = 0.0


@njit(cache=True, error_model="numpy")
def elastic_step(n: int, q: FloatArray, e: FloatArray, flight: FloatArray, p: FloatArray) -> float:
    """Least time that a wave or the stretching takes over an element in flight, s."""
    least = 1e30
    for j in range(n - 1):
        dx, dy, dz = q[j + 1, 0] - q[j, 0], q[j + 1, 1] - q[j, 1], q[j + 1, 2] - q[j, 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        rate = 0.0
        if length < flight[j]:
            length = flight[j]
        else:
            rate = (q[j + 1, 3] - q[j, 3]) * dx + (q[j + 1, 4] - q[j, 4]) * dy + (q[j + 1, 5] - q[j, 5]) * dz
            rate /= length**2
        g = p[1]
        if p[12] > 0:
            c = e[j, 3] / e[j, 0] / p[13]
            g *= 10.0 ** (p[16] * (min(p[13] * c, 1.0) ** p[17] - p[13] ** p[17])) / c
        h = _spring(e[j, 1], e[j, 2], p[14])
        stiff = 2 * h * h * p[14] / (1 - 3 * p[14])  # of the spring: 2 dh/d(tr A)
        wave = math.sqrt(g * (h * (e[j, 1] + 2 * e[j, 2]) + stiff * e[j, 1] ** 2) / p[0])
        slack = 0.3 * (h + stiff * e[j, 1]) / p[2] if p[14] > 0 else 0.0
        a = math.sqrt(e[j, 0] / (math.pi * length))
        drag = 3 * p[5] * 200.0 / (p[0] * math.pi * a)  # of the air across, at a slip of 200 m/s
        dry = 30 * p[12] * (400 * a / p[6]) ** (1 / 3) * length / e[j, 0]
        rates_ = (wave + 1e-12) / length + abs(rate) + 6 * p[3] / (p[0] * length**2) + 0.3 * drag + dry + slack
        least = min(least, 1 / (rates_ + 1e-30))
    return least


@njit(cache=True, error_model="numpy")
def gap_of(x: float, y: float, surface: FloatArray) -> float:
    """Distance to the collector; surface: kind (0 plate or belt, 1 drum), distance, speed, radius, y of the axis."""
    if surface[0] == 0:
        return float(surface[1] - x)
    return float(math.hypot(x - surface[1] - surface[3], y - surface[4]) - surface[3])


@njit(cache=True, error_model="numpy")
def _distance(a: FloatArray, b: FloatArray) -> float:
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@njit(cache=True, error_model="numpy")
def _carry(touch: FloatArray, time: float, surface: FloatArray, out: FloatArray) -> None:
    """Place and velocity, in `out` (6), of a bead that has touched, as the collector's surface carries it on."""
    since = time - touch[0]
    out[0], out[1], out[2] = touch[1], touch[2] + surface[2] * since, touch[3]
    out[3], out[4], out[5] = 0.0, surface[2], 0.0
    if surface[0] == 1:
        beta = math.atan2(touch[2] - surface[4], surface[1] + surface[3] - touch[1]) + surface[2] / surface[3] * since
        across = math.hypot(touch[2] - surface[4], surface[1] + surface[3] - touch[1])
        out[0], out[1] = surface[1] + surface[3] - across * math.cos(beta), surface[4] + across * math.sin(beta)
        out[3], out[4] = surface[2] * math.sin(beta), surface[2] * math.cos(beta)


@njit(cache=True, error_model="numpy")
def advance(
    n: int,
    t: float,
    end: float,
    q: FloatArray,
    e: FloatArray,
    flight: FloatArray,
    touch: FloatArray,
    landed: int,
    p: FloatArray,
    air: FloatArray,
    gust: FloatArray,
    start: FloatArray,
    inlet: FloatArray,
    surface: FloatArray,
    rows: FloatArray,
    filled: int,
    counts: FloatArray,
) -> tuple[int, float, int, int, int]:
    """Steps up to `end` or until the landing rows are full; returns n, t, landed, rows filled, and 0, or 1 where room ran out,
    2 where work did (`counts`: elements looked at, those with c_b^2 < 0, and how many may be looked at).

    `start`: place (3), velocity (3), volume of an element, longest element, CFL, amplitude, angular frequency of its circle,
    length of an element. `landed`: bead 0 lies on the collector and its row is written.
    """
    size = q.shape[0]
    q1, e1, q2, e2 = np.empty_like(q), np.empty_like(e), np.empty_like(q), np.empty_like(e)
    dq, de = np.empty_like(q), np.empty_like(e)
    while t < end:
        if filled >= rows.shape[0] - 2:
            return n, t, landed, filled, 0
        if counts[0] > counts[2]:
            return n, t, landed, filled, 2
        dt = min(start[8] * elastic_step(n, q, e, flight, p), end - t)
        dt = min(dt, 0.25 * start[6] / p[11])  # the start feeds no more than a quarter of an element
        if dt < 1e-15 * max(end, 1e-3):
            dt = end - t
        rates(n, t, q, e, dq, de, flight, touch, p, air, gust, inlet, counts)
        for i in range(n):
            for k in range(6):
                q1[i, k] = q[i, k] + dt * dq[i, k]
        for i in range(n - 1):
            for k in range(4):
                e1[i, k] = e[i, k] + dt * de[i, k]
        rates(n, t + dt, q1, e1, dq, de, flight, touch, p, air, gust, inlet, counts)
        for i in range(n):
            for k in range(6):
                q2[i, k] = 0.75 * q[i, k] + 0.25 * (q1[i, k] + dt * dq[i, k])
        for i in range(n - 1):
            for k in range(4):
                e2[i, k] = 0.75 * e[i, k] + 0.25 * (e1[i, k] + dt * de[i, k])
        rates(n, t + 0.5 * dt, q2, e2, dq, de, flight, touch, p, air, gust, inlet, counts)
        for i in range(n):
            for k in range(6):
                q1[i, k] = (q[i, k] + 2 * (q2[i, k] + dt * dq[i, k])) / 3
        for i in range(n - 1):
            for k in range(4):
                e[i, k] = (e[i, k] + 2 * (e2[i, k] + dt * de[i, k])) / 3
        # the start on its circle
        for k in range(3):
            q1[n - 1, k], q1[n - 1, 3 + k] = start[k], start[3 + k]
        if start[9] > 0:
            c, s = math.cos(start[10] * (t + dt)), math.sin(start[10] * (t + dt))
            q1[n - 1, 1] += start[9] * c
            q1[n - 1, 2] += start[9] * s
            q1[n - 1, 4] -= start[9] * start[10] * s
            q1[n - 1, 5] += start[9] * start[10] * c
        _touch(n, t, dt, q, q1, flight, touch, surface)
        n, landed, filled = _land(n, q1, e, flight, touch, landed, surface, rows, filled)
        t += dt
        for i in range(n):
            for k in range(6):
                q[i, k] = q1[i, k]
        if n < 2:
            return n, t, landed, filled, 1
        n = _feed(n, q, e, flight, touch, start)
        n = _split(n, q, e, flight, touch, start[7], size)
        n = _join(n, q, e, flight, touch, 0.25 * start[11])
        if n >= size - 2:
            return n, t, landed, filled, 1
    return n, t, landed, filled, 0


@njit(cache=True, error_model="numpy")
def _touch(
    n: int,
    t: float,
    dt: float,
    q: FloatArray,
    q1: FloatArray,
    flight: FloatArray,
    touch: FloatArray,
    surface: FloatArray,
) -> None:
    """Beads that met the collector within the step stick where they did; all that have are carried with its surface."""
    for i in range(n - 2):  # the growing element's end when the next is closed
        if not math.isnan(touch[i, 0]) or gap_of(q1[i, 0], q1[i, 1], surface) > 0:
            continue
        low, high = 0.0, 1.0
        for _ in range(50):
            u = 0.5 * (low + high)
            x = _cubic(u, dt, q[i, 0], q1[i, 0], q[i, 3], q1[i, 3])
            y = _cubic(u, dt, q[i, 1], q1[i, 1], q[i, 4], q1[i, 4])
            if gap_of(x, y, surface) <= 0:
                high = u
            else:
                low = u
        touch[i, 0] = t + high * dt
        for k in range(3):
            touch[i, 1 + k] = _cubic(high, dt, q[i, k], q1[i, k], q[i, 3 + k], q1[i, 3 + k])
            touch[i, 4 + k] = (1 - high) * q[i, 3 + k] + high * q1[i, 3 + k]
        for j in range(max(i - 1, 0), i + 1):  # both ends at that moment
            if math.isnan(flight[j]):
                square = 0.0
                for k in range(3):
                    square += ((1 - high) * (q[j + 1, k] - q[j, k]) + high * (q1[j + 1, k] - q1[j, k])) ** 2
                flight[j] = math.sqrt(square)
    for i in range(n - 2):
        if not math.isnan(touch[i, 0]):
            _carry(touch[i], t + dt, surface, q1[i])


@njit(cache=True, error_model="numpy")
def _without_first(n: int, q: FloatArray, e: FloatArray, flight: FloatArray, touch: FloatArray) -> int:
    """The chain without its bead 0 and element 0; returns how many beads are left."""
    for j in range(n - 1):
        for k in range(6):
            q[j, k] = q[j + 1, k]
        for k in range(7):
            touch[j, k] = touch[j + 1, k]
    for j in range(n - 2):
        flight[j] = flight[j + 1]
        for k in range(4):
            e[j, k] = e[j + 1, k]
    return n - 1


@njit(cache=True, error_model="numpy")
def _land(
    n: int,
    q: FloatArray,
    e: FloatArray,
    flight: FloatArray,
    touch: FloatArray,
    landed: int,
    surface: FloatArray,
    rows: FloatArray,
    filled: int,
) -> tuple[int, int, int]:
    """Rows, in the fibre's order, of what lies on the collector from the far end on; elements with both ends there leave.

    A row's time does not run back along the fibre: a bead that touched before its predecessor has been carried on till then.
    """
    at = np.empty(6)
    while n > 3 and filled < rows.shape[0] - 1 and not math.isnan(touch[landed, 0]):
        when = max(touch[landed, 0], touch[0, 0])
        _carry(touch[landed], when, surface, at)
        rows[filled, 0] = touch[landed, 0] = when
        for k in range(3):
            rows[filled, 1 + k] = touch[landed, 1 + k] = at[k]
            rows[filled, 4 + k] = touch[landed, 4 + k]
        rows[filled, 7], rows[filled, 8], rows[filled, 9] = 0.0, math.nan, math.nan
        if landed:
            rows[filled, 7], rows[filled, 8], rows[filled, 9] = e[0, 0], max(flight[0], _distance(q[0], q[1])), e[0, 3]
            n = _without_first(n, q, e, flight, touch)
        landed = 1
        filled += 1
    return n, landed, filled


@njit(cache=True, error_model="numpy")
def _cubic(u: float, dt: float, a: float, b: float, va: float, vb: float) -> float:
    w = 1 - u
    return w * w * ((1 + 2 * u) * a + u * dt * va) + u * u * ((1 + 2 * w) * b - w * dt * vb)


@njit(cache=True, error_model="numpy")
def _feed(n: int, q: FloatArray, e: FloatArray, flight: FloatArray, touch: FloatArray, start: FloatArray) -> int:
    """Close the growing element at 1.5 of its volume, or longer than any may be: one closed, up to half goes on growing."""
    m = n - 2
    if e[m, 0] < 1.5 * start[6] and _distance(q[n - 2], q[n - 1]) < start[7]:
        return n
    share = min(start[6] / e[m, 0], 2 / 3)
    for k in range(6):
        q[n, k] = q[n - 1, k]
        q[n - 1, k] = q[n - 2, k] + share * (q[n, k] - q[n - 2, k])
    for k in range(4):
        e[m + 1, k] = e[m, k]
    e[m + 1, 0], e[m, 0] = e[m, 0] * (1 - share), e[m, 0] * share
    e[m + 1, 3], e[m, 3] = e[m, 3] * (1 - share), e[m, 3] * share
    flight[m + 1] = touch[n, 0] = math.nan
    return n + 1


@njit(cache=True, error_model="numpy")
def _split(
    n: int, q: FloatArray, e: FloatArray, flight: FloatArray, touch: FloatArray, longest: float, size: int
) -> int:
    """Halve elements that have grown too long, but for the growing one; of those half on the collector, half still is."""
    j = 0
    while j < n - 2 and n < size - 2:
        low, high = not math.isnan(touch[j, 0]), not math.isnan(touch[j + 1, 0])
        if _distance(q[j], q[j + 1]) > longest and not (low and high):
            for i in range(n, j + 1, -1):
                for k in range(6):
                    q[i, k] = q[i - 1, k]
                for k in range(7):
                    touch[i, k] = touch[i - 1, k]
            for i in range(n - 1, j, -1):
                flight[i] = flight[i - 1]
                for k in range(4):
                    e[i, k] = e[i - 1, k]
            for k in range(6):
                q[j + 1, k] = 0.5 * (q[j, k] + q[j + 2, k])
            touch[j + 1, 0] = math.nan
            whole = flight[j]
            flight[j] = 0.5 * whole if low else math.nan
            flight[j + 1] = 0.5 * whole if high else math.nan
            for k in (0, 3):
                e[j, k] *= 0.5
                e[j + 1, k] *= 0.5
            n += 1
            j += 1
        j += 1
    return n


@njit(cache=True, error_model="numpy")
def _join(n: int, q: FloatArray, e: FloatArray, flight: FloatArray, touch: FloatArray, shortest: float) -> int:
    """A free end draws back under capillarity into a drop, shorter than wide: it takes in the next element.

    Volume and momentum are kept; the two outer beads keep the speed at which they part, after the two inner ones have joined.
    """
    while n > 4 and math.isnan(flight[0]) and math.isnan(flight[1]):
        dx, dy, dz = q[1, 0] - q[0, 0], q[1, 1] - q[0, 1], q[1, 2] - q[0, 2]
        if dx * dx + dy * dy + dz * dz >= shortest * shortest:
            break
        a, b, c = e[0, 0], e[1, 0], e[2, 0]
        for k in range(3, 6):
            joined = (a * q[0, k] + (a + b) * q[1, k]) / (2 * a + b)
            shift = a * (joined - q[2, k]) / (2 * a + 2 * b + c)
            q[1, k] = joined + shift
            q[2, k] += shift
        for k in range(3):
            q[1, k] = q[0, k]
        for k in (1, 2):
            e[1, k] = (a * e[0, k] + b * e[1, k]) / (a + b)
        e[1, 0] += a
        e[1, 3] += e[0, 3]
        n = _without_first(n, q, e, flight, touch)
    return n
