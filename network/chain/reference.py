"""The speed in which a chain counts its ages: that of its own steady network, where it has one.

A time step resolves what moves against the reference. Against the jet that is the slip: it sets in within
``max(eps, h)`` of a kink of V (the onset of a power-law jet), each bead meets it at another time, and a long step gives
neighbours different shares of it. Against the steady network U nothing moves once the chain has settled, and what is
left is smooth.

U need not be exact, only V is physics: a poor U costs steps. Away from kinks it is Eq. (33), ``U = V / (1 - eps V')``,
whose age is ``int ds / U = a(s) - eps ln V``. Around a kink it is the travelling wave of the beads,

    X'(t) = V(X) + (eps / h^2) [X(t + h) - 2 X(t) + X(t - h)],    U(X(t)) = X'(t),

collocated on a grid that holds the shifts by h and solved by Newton's method; downstream Eq. (33) closes it.
Tensions are those of the linear spring with the stiffness at rest; inertia enters as ``eps - I``.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import solve_banded

from spinline.base.checks import FloatArray
from spinline.network.chain.flow import Segment, hermite
from spinline.network.chain.model import Chain

__all__ = ["steady_reference"]

_POINTS = 12  # grid points in max(eps, h)
_UPSTREAM, _DOWNSTREAM, _MARGIN = 14.0, 4.0, 4  # extent of a zone, in eps, in eps and in h
_FRONT = 0.2  # of eps V': no steady network from 1/4 on
_LEAST = 1e-9  # of eps V': no slip to speak of below


def steady_reference(chain: Chain, span: Segment) -> Segment:
    """The same flow with ages counted in the steady network's speed; unchanged where there is none.

    Parameters
    ----------
    chain : Chain
    span : Segment
        A span of the flow; left as it is unless it is steady and ``|eps - I| V'`` between 1e-9 and 0.2, or where it
        has kinks and ``eps < 2 I``.
    """
    if np.isfinite(span.begin) and np.isfinite(span.end):
        return span
    jet = _Jet(span)
    eps = chain.elasticity * chain.rest_stiffness - chain.inertia
    steepest = abs(eps) * float(np.max(np.abs(jet.slopes)))
    if not _LEAST < steepest < _FRONT:
        return span
    nodes, age, slow = span.nodes, jet.age - eps * np.log(jet.speed), (1 - eps * jet.slopes) / jet.speed
    clear = 0.0
    for kink in chain.flow.kinks:
        jump = abs(jet.slope(kink, 1.0) - jet.slope(kink, -1.0)) if 0 < kink < span.nodes[-1] else 0.0
        if abs(eps) * jump < max(_LEAST, 1e-3 * steepest):
            continue
        zone = _wave(jet, kink, eps, chain.step) if eps > chain.inertia else None
        if zone is None or zone[0][0] < clear or zone[0][-1] >= span.nodes[-1]:
            return span
        clear = zone[0][-1]
        nodes, age, slow = _insert(jet, eps, (nodes, age, slow), zone)
    if not (np.all(slow > 0) and np.all(np.diff(age) > 0)):
        return span
    # both tables on all nodes: a cubic cut in two is the same cubic
    near = np.searchsorted(span.nodes, nodes).clip(1, span.nodes.size - 1)
    apart = np.minimum(np.abs(nodes - span.nodes[near]), np.abs(nodes - span.nodes[near - 1]))
    both = np.union1d(span.nodes, nodes[apart > 1e-7 * span.nodes[-1]])
    rows = [hermite(both, span.nodes, span.age[1], span.slowness[1]), hermite(both, nodes, age, slow)]
    return replace(
        span, nodes=both, age=np.stack([r[0] for r in rows]), slowness=np.stack([r[1] for r in rows]), weight=0.0
    )


class _Jet:
    """The jet of a steady span: V, V' and the age, anywhere."""

    def __init__(self, span: Segment) -> None:
        self._table = (span.nodes, span.age[1], span.slowness[1])
        self.age, self.speed = span.age[1], 1 / span.slowness[1]
        width = np.diff(span.nodes)
        self._reach = 0.25 * np.minimum(np.append(width, width[-1]), np.insert(width, 0, width[0]))
        ahead, behind = self.velocity(span.nodes + self._reach), self.velocity(span.nodes - self._reach)
        self.slopes = (ahead - behind) / (2 * self._reach)

    def velocity(self, s: FloatArray) -> FloatArray:
        value: FloatArray = 1 / hermite(s, *self._table)[1]
        return value

    def ages(self, s: FloatArray) -> FloatArray:
        return hermite(s, *self._table)[0]

    def slope(self, s: float, side: float) -> float:
        """V' on one side of a place."""
        step = side * 1e-5 * self._table[0][-1]
        pair = self.velocity(np.array([s + step, s + 2 * step]))
        return float((pair[1] - pair[0]) / step)

    def gradient(self, s: FloatArray) -> FloatArray:
        step = 1e-6 * self._table[0][-1]
        value: FloatArray = (self.velocity(s + step) - self.velocity(s - step)) / (2 * step)
        return value


_Table = tuple[FloatArray, FloatArray, FloatArray]


def _wave(jet: _Jet, kink: float, eps: float, h: float) -> _Table | None:
    """Places, ages from the first of them and slownesses of the travelling wave about a kink; None without one."""
    speed = float(jet.velocity(np.array([kink]))[0])
    m = max(1, int(np.ceil(_POINTS * h / max(h, eps))))
    step = h if m > 1 else max(h, eps / _POINTS)  # a wave much longer than h is that of the continuum
    d, strength = step / m, eps / step**2
    before = int(np.ceil(_UPSTREAM * eps / d)) + _MARGIN * m
    n = before + 1 + int(np.ceil(_DOWNSTREAM * eps / d)) + _MARGIN * m
    x: FloatArray = kink + speed * d * np.arange(-before, n - before, dtype=np.float64)
    lag = d * np.arange(1, m + 1)
    for _ in range(12):
        first, last = jet.velocity(x[[0, -1]])
        rise, closing = jet.gradient(x), float(jet.gradient(x[-1:])[0])
        ending = last / (1 - eps * closing)
        full = np.concatenate(
            (x[0] - first * lag[::-1], x, x[-1] + ending * lag * (1 + 0.5 * closing * lag)),
        )
        rate = jet.velocity(x) + strength * (full[2 * m :] - 2 * x + full[: -2 * m])
        residual = np.diff(x) - 0.5 * d * (rate[1:] + rate[:-1])
        # F_j by X_j, and by the neighbours m apart; beyond the ends by the end itself
        own, back, ahead = rise - 2 * strength, np.full(n, strength), np.full(n, strength)
        move = np.zeros(n)
        bands = np.zeros((2 * m + 2, n))  # equation i, unknown k in row m + 1 + i - k
        top = m + 1
        half = 0.5 * d
        for shift in (0, 1):  # equation i holds F_i and F_(i+1)
            j = np.arange(n - 1) + shift
            for values, column in (
                (own[j], j),
                (back[j], np.maximum(j - m, 0)),
                (ahead[j], np.minimum(j + m, n - 1)),
            ):
                np.add.at(bands, (top + np.arange(n - 1) - column, column), -half * values)
        bands[top - 1, 1:] += 1.0
        bands[top, :-1] -= 1.0
        # the bead at the kink stays there: its column goes, and later columns move up by one
        kept = np.delete(np.arange(n), before)
        square = np.zeros((2 * m + 3, n - 1))
        for offset in range(2 * m + 2):
            row = np.arange(n) + offset - top
            valid = (row >= 0) & (row < n - 1) & (np.arange(n) != before)
            column = np.arange(n)[valid]
            target = column - (column > before)
            square[top + row[valid] - target, target] = bands[offset, column]
        move[kept] = solve_banded((top, top), square, -residual)
        x = x + move
        if not np.all(np.isfinite(x)) or np.any(np.diff(x) <= 0):
            return None
        if np.max(np.abs(move)) < 1e-10 * step:
            inside = (x > 0) | (np.arange(n) >= before)
            ages: FloatArray = d * np.arange(n, dtype=np.float64)
            return (x[inside], ages[inside], 1 / rate[inside]) if np.all(rate > 0) else None
    return None


def _insert(jet: _Jet, eps: float, table: _Table, zone: _Table) -> _Table:
    """Put a zone into the table of Eq. (33), ages going on across its ends."""
    nodes, age, slow = table
    low, high = zone[0][0], zone[0][-1]
    left, right = nodes < low - 1e-7 * nodes[-1], nodes > high + 1e-7 * nodes[-1]
    ends = np.array([low, high])
    outer = jet.ages(ends) - eps * np.log(jet.velocity(ends))  # by Eq. (33)
    at = np.array([np.interp(low, nodes, age)]) if low < 0 else outer[:1]
    start = float(at[0])
    shift = start + float(zone[1][-1] - zone[1][0]) - float(outer[1])
    return (
        np.concatenate((nodes[left], zone[0], nodes[right])),
        np.concatenate((age[left], start + zone[1] - zone[1][0], age[right] + shift)),
        np.concatenate((slow[left], zone[2], slow[right])),
    )
