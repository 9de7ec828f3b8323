"""JETSPIN 1.21's equations of motion restated: an oracle for tests and the yardstick of cost, no part of the product.

Beads of equal mass m and charge q; element i joins bead i to bead i + 1 towards the nozzle, ``pi r_i^2 l_i = pi r0^2 l_step``:

``m dv_i/dt = sum_j q^2 u_ij/(d_ij + r_j)^2 - pi r_i^2 sigma_i t_i + pi r_(i-1)^2 sigma_(i-1) t_(i-1) + k_i pi rm^2 alpha c_i + q V0/h x + m g x``

with j the bead nearer to the nozzle, whose radius counts as r0 for the nozzle, the bead next to it and the place holder, rm the mean
of the two radii beside a bead, k_i and c_i curvature and direction of the circle through three beads; Eq. (14) for the stress.
The nozzle is a charge on a circle; a lateral velocity that starts at nothing enters the rate of the last element. A bead is
released at l_step, with the nozzle's speed and no stress, when the last one is 2 l_step away; from 1.5 l_step on the one to come
repels the others with a charge that grows as ``(1 - cos(pi u))/2``, u from 0 to 1.

Found from the equations of Lauricella et al., Comput. Phys. Commun. 197 (2015) 227 and from recorded runs of JETSPIN 1.21, which it follows
to 2e-9 where neither the nozzle's circle nor surface tension acts. Gaussian units throughout.
"""

import math
from dataclasses import dataclass

import numpy as np

from spinline.base.kernels import njit

# position, stress, velocity of a bead
X, S, V = 0, 3, 4
GAP, R0, STEP, MU, G, V0, ALPHA, OMEGA, CIRCLE, SPEED, GRAVITY, MASS, CHARGE, PHASE = range(14)


def parameters(
    *,
    gap=16.0,
    radius=0.005,
    step=0.02,
    density=0.839253525,
    charge=44000.0,
    viscosity=20.0,
    modulus=5e4,
    potential=30.02076857,
    tension=21.133,
    omega=1e4,
    circle=1e-3,
    speed=0.282942121,
    gravity=980.665,
    phase=2.9562192425,
):
    """Numbers of an input file; as they stand those of the published PVP jet (JETSPIN's third example), recorded phase included."""
    volume = math.pi * radius**2 * step
    own = [gap, radius, step, viscosity, modulus, potential, tension, omega, circle, speed, gravity]
    return np.array([*own, density * volume, charge * volume, phase])


@dataclass
class Beads:
    """A jet of beads: `y` holds n of them and the nozzle, front first; `coming` while one to come repels the others."""

    p: np.ndarray
    y: np.ndarray
    n: int = 1
    coming: bool = False
    time: float = 0.0
    calls: int = 0

    @classmethod
    def start(cls, p, rows=160):
        """One bead at l_step."""
        y = np.zeros((rows, 7))
        y[0, X], y[0, V] = p[STEP], p[SPEED]
        return cls(p, y)

    def fixed(self, end, dt, *, heun=False):
        """Equal steps of fourth-order Runge-Kutta or Heun, the nozzle's events looked at once a step: JETSPIN's way."""
        steps = round((end - self.time) / dt)
        first = round(self.time / dt)
        self.n, self.coming = _fixed(first, steps, dt, self.n, self.coming, heun, self.y, self.p)
        self.time, self.calls = end, self.calls + steps * (2 if heun else 4)

    def adaptive(self, end, tolerance):
        """Dormand-Prince 5(4), the release of a bead located."""
        self.n, calls = _adaptive(self.time, end, tolerance, self.n, self.y, self.p)
        self.time, self.calls = end, self.calls + calls

    @property
    def front(self):
        """x, distance from the axis and stress of the first bead."""
        return self.y[0, X], math.hypot(self.y[0, X + 1], self.y[0, X + 2]), self.y[0, S]


@njit(cache=True, error_model="numpy")
def _nozzle(t, n, y, p):
    turn = p[OMEGA] * t + p[PHASE]
    a, fast = p[CIRCLE], p[CIRCLE] * p[OMEGA]
    y[n, 0], y[n, 1], y[n, 2], y[n, S], y[n, V] = 0.0, a * math.cos(turn), a * math.sin(turn), 0.0, p[SPEED]
    y[n, V + 1] = fast * (math.sin(p[PHASE]) - math.sin(turn))
    y[n, V + 2] = fast * (math.cos(turn) - math.cos(p[PHASE]))


@njit(cache=True, error_model="numpy")
def _away(n, y):
    return math.sqrt((y[n - 1, 0] - y[n, 0]) ** 2 + (y[n - 1, 1] - y[n, 1]) ** 2 + (y[n - 1, 2] - y[n, 2]) ** 2)


@njit(cache=True, error_model="numpy")
def _push(i, x, y, z, soft, q2, at, f):
    """Repulsion of bead i by a charge at x, y, z; what it does in return."""
    dx, dy, dz = at[i, 0] - x, at[i, 1] - y, at[i, 2] - z
    d = math.sqrt(dx * dx + dy * dy + dz * dz)
    a = q2 / ((d + soft) * (d + soft) * d)
    f[i, 0] += a * dx
    f[i, 1] += a * dy
    f[i, 2] += a * dz
    return a * dx, a * dy, a * dz


@njit(cache=True, error_model="numpy")
def _rates(t, n, coming, y, p, w, f, d):
    """Rates of the n beads; w: rows of tangent, length, radius."""
    _nozzle(t, n, y, p)
    for i in range(n):
        dx, dy, dz = y[i, 0] - y[i + 1, 0], y[i, 1] - y[i + 1, 1], y[i, 2] - y[i + 1, 2]
        long = math.sqrt(dx * dx + dy * dy + dz * dz)
        w[i, 0], w[i, 1], w[i, 2], w[i, 3] = dx / long, dy / long, dz / long, long
        w[i, 4] = p[R0] * math.sqrt(p[STEP] / long)
        f[i, 0], f[i, 1], f[i, 2] = p[CHARGE] * p[V0] / p[GAP] + p[MASS] * p[GRAVITY], 0.0, 0.0
    q2 = p[CHARGE] ** 2
    for j in range(1, n + 1):
        soft = w[j, 4] if j < n - 1 else p[R0]
        x, v, z = 0.0, 0.0, 0.0
        for i in range(j):
            a, b, c = _push(i, y[j, 0], y[j, 1], y[j, 2], soft, q2, y, f)
            x, v, z = x - a, v - b, z - c
        if j < n:
            f[j, 0] += x
            f[j, 1] += v
            f[j, 2] += z
    coming = coming and w[n - 1, 3] > 1.5 * p[STEP]
    if coming:
        share = 0.5 - 0.5 * math.cos(math.pi * (w[n - 1, 3] - 1.5 * p[STEP]) / (0.5 * p[STEP]))
        at, reach = y[n], p[STEP]
        for i in range(n):
            x, v, z = at[0] + reach * w[n - 1, 0], at[1] + reach * w[n - 1, 1], at[2] + reach * w[n - 1, 2]
            _push(i, x, v, z, p[R0], share * q2, y, f)
    for i in range(n):
        pull = math.pi * w[i, 4] ** 2 * y[i, S]
        for c in range(3):
            f[i, c] -= pull * w[i, c]
            if i < n - 1:
                f[i + 1, c] += pull * w[i, c]
        if i > 0 and p[ALPHA] > 0.0:
            after = w[i, 3] - (p[STEP] if coming and i == n - 1 else 0.0)  # the one to come is a neighbour
            _bent(i, after, p, w, f)
    for i in range(n):
        along = 0.0
        for c in range(3):
            along += (y[i, V + c] - y[i + 1, V + c]) * w[i, c]
            d[i, c] = y[i, V + c]
            d[i, V + c] = f[i, c] / p[MASS]
        d[i, S] = p[G] * along / w[i, 3] - p[G] / p[MU] * y[i, S]


@njit(cache=True, error_model="numpy")
def _bent(i, after, p, w, f):
    """Surface tension on bead i, to the centre of the circle through it and its neighbours, the second `after` away."""
    before, flat = w[i - 1, 3], 0.0
    for c in range(3):
        flat += w[i - 1, c] * w[i, c]  # the cosine of what the jet turns by
    chord2 = before * before + after * after + 2.0 * before * after * flat
    pull = math.pi * (0.5 * (w[i, 4] + w[i - 1, 4])) ** 2 * p[ALPHA]
    for c in range(3):
        centre = (before + after * flat) * w[i - 1, c] - (after + before * flat) * w[i, c]
        f[i, c] += 2.0 * pull * centre / chord2


@njit(cache=True, error_model="numpy")
def _release(n, y, p):
    away = _away(n, y)
    y[n + 1] = y[n]
    for c in range(3):
        y[n, c] = y[n + 1, c] + p[STEP] * (y[n - 1, c] - y[n + 1, c]) / away
        y[n, V + c] = 0.0
    y[n, S], y[n, V] = 0.0, p[SPEED]


_TABLE = np.array(
    [
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],  # Dormand-Prince 5(4)
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],  # Heun
        [0.5, 0.5, 0.0, 0.0, 0.0, 0.0],
        [0.5, 0.0, 0.0, 0.0, 0.0, 0.0],  # Runge-Kutta
        [0.0, 0.5, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [1 / 6, 1 / 3, 1 / 3, 1 / 6, 0.0, 0.0],
    ]
)
_C = np.array([1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_E = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@njit(cache=True, error_model="numpy")
def _add(n, y, h, row, count, k, out):
    """`y` and h times a row of the table over the first `count` rates, into `out`."""
    for i in range(n):
        for c in range(7):
            s = 0.0
            for m in range(count):
                s += _TABLE[row, m] * k[m, i, c]
            out[i, c] = y[i, c] + h * s


@njit(cache=True, error_model="numpy")
def _fixed(first, steps, dt, n, coming, heun, y, p):
    rows = y.shape[0]
    k, mid, w, f = np.zeros((4, rows, 7)), np.zeros((rows, 7)), np.zeros((rows, 5)), np.zeros((rows, 3))
    for s in range(first, first + steps):
        t = s * dt
        _rates(t, n, coming, y, p, w, f, k[0])
        if heun:
            _add(n, y, dt, 6, 1, k, mid)
            _rates(t + dt, n, coming, mid, p, w, f, k[1])
            _add(n, y, dt, 7, 2, k, y)
        else:
            for stage in range(3):
                _add(n, y, dt, 8 + stage, stage + 1, k, mid)
                _rates(t + (1.0 if stage == 2 else 0.5) * dt, n, coming, mid, p, w, f, k[stage + 1])
            _add(n, y, dt, 11, 4, k, y)
        _nozzle((s + 1) * dt, n, y, p)
        away = _away(n, y)
        if coming and away >= 2.0 * p[STEP]:
            _release(n, y, p)
            n, coming = n + 1, False
        elif not coming and away >= 1.5 * p[STEP]:
            coming = True
    return n, coming


@njit(cache=True, error_model="numpy")
def _worst(n, h, k, scale):
    """Largest error of a step over its scale."""
    worst = 0.0
    for i in range(n):
        for c in range(7):
            e = 0.0
            for s in range(7):
                e += _E[s] * k[s, i, c]
            worst = max(worst, abs(h * e) / scale[c])
    return worst


@njit(cache=True, error_model="numpy")
def _crossing(n, h, mark, y, new, p):
    """Where in a step the last bead passes the mark: the root of a cubic through both ends' distances and speeds."""
    ends, slopes = np.empty(2), np.empty(2)
    for m, at in enumerate((y, new)):
        ends[m] = _away(n, at)
        slopes[m] = 0.0
        for c in range(3):
            slopes[m] += h * (at[n - 1, c] - at[n, c]) * (at[n - 1, V + c] - (at[n, V + c] if c > 0 else 0.0)) / ends[m]
    low, high = 0.0, 1.0
    for _ in range(60):
        x = 0.5 * (low + high)
        z = 1.0 - x
        value = z * z * ((1.0 + 2.0 * x) * ends[0] + x * slopes[0]) + x * x * (
            (1.0 + 2.0 * z) * ends[1] - z * slopes[1]
        )
        low, high = (x, high) if value < mark else (low, x)
    return high


@njit(cache=True, error_model="numpy")
def _adaptive(t, end, tolerance, n, y, p):
    """Dormand-Prince; the charge to come is looked at in every rate, the release ends a step."""
    rows = y.shape[0]
    k, new, w, f = np.zeros((7, rows, 7)), np.zeros((rows, 7)), np.zeros((rows, 5)), np.zeros((rows, 3))
    scale = np.array([1.0, 1.0, 1.0, p[G], 1e3, 1e3, 1e3])
    h, calls, natural, tries = 1e-7, 1, 0.0, 0
    mark = 2.0 * p[STEP]
    _rates(t, n, True, y, p, w, f, k[0])
    while t < end:
        h = min(h, end - t)
        for s in range(6):
            _add(n, y, h, s, s + 1, k, new)
            _rates(t + _C[s] * h, n, True, new, p, w, f, k[s + 1])
        calls += 6
        ratio = _worst(n, h, k, scale) / tolerance
        if not ratio <= 1.0:
            h *= max(0.2, 0.9 * ratio**-0.2)
            continue
        off = _away(n, new) - mark
        if off > 1e-7 * mark and tries < 3:
            natural, tries = max(natural, h), tries + 1
            _nozzle(t, n, y, p)
            h *= _crossing(n, h, mark, y, new, p)
            continue
        t, tries = t + h, 0
        for i in range(n):
            for c in range(7):
                y[i, c] = new[i, c]
                k[0, i, c] = k[6, i, c]
        _nozzle(t, n, y, p)
        h = max(natural, h * min(5.0, 0.9 * max(ratio, 1e-10) ** -0.2))
        natural = 0.0
        if off >= -1e-7 * mark:
            _release(n, y, p)
            n += 1
            _rates(t, n, True, y, p, w, f, k[0])
            calls += 1
    return n, calls
