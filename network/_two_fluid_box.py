"""Box scheme of the two-fluid network: Newton's method, first guess and mesh. What it solves stands in `two_fluid`.

Unknowns: T (its logarithm for the linear spring), whose stretch lam(T) is explicit and bounded (a strand at its contour is
as well conditioned as a slack one), and ``q = ln(lam/w)``, what a strand has not kept of the network's stretch::

    eps d(e^q T)/ds = 1 - V e^q/lam          dq/ds = -r(lam) e^q/(2 th lam^2)

The first is stable upstream, the second downstream. In each box both are parabolas; the momentum holds at the points 0 and
2/3 of it, the relaxation at 1/3 and 1: Radau's points, each counted the way its equation is stable. Third order at the
nodes, and what a box does not resolve dies out within it. Where strands relax faster than the flow drags them, eps > th V^2,
T is what relaxes and q what is dragged, and the equations change places. Nine diagonals, a Newton step is O(boxes).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spinline.base.checks import FloatArray
from spinline.network._two_fluid_kernels import newton
from spinline.network.force_laws import law_code
from spinline.network.tension import Tension

__all__ = ["Box", "halved", "on_parabolas", "refined", "remeshed", "split", "start_of", "thinned"]

Profile = Callable[[FloatArray], FloatArray]

_GROWTH = 0.5  # of a cell's length with the distance from a shorter one


@dataclass(frozen=True, eq=False)
class Box:
    """The equations.

    Attributes
    ----------
    profile, eps, relaxation : callable
        V(s), eps(s), th(s); th may be inf.
    law : Tension
    per_line : bool
        The tension counts once a chain line, not once a strand, and r = lam - 1: the shortcut, a test law.
    """

    profile: Profile
    eps: Profile
    relaxation: Profile
    law: Tension
    per_line: bool = False

    def solve(self, s: FloatArray, guess: FloatArray, end: float, *, plain: bool = False) -> FloatArray | None:
        """Solution with q = 0 at the first node and T = `end` at the last; None where Newton's method fails.

        `guess` and the solution, (2 nodes - 1, 2), are T and q at node, middle, node, ... `plain` takes the
        scheme of first order, whose Newton iterations go farther.
        """
        h, y = np.diff(s), guess.ravel().copy()
        bounded = self.law.bounded
        if not bounded:
            y[::2] = np.log(y[::2])
        at = [s[:-1] + c * h for c in (0.0, 2 / 3, 1 / 3)] + [s[1:]]
        flow = np.stack([self.profile(x) for x in at], axis=1)
        eps = np.stack([self.eps(x) for x in at], axis=1)
        slow = np.stack([0.5 / self.relaxation(x) for x in at], axis=1)
        fast = eps[:, 1] * slow[:, 1] > 0.5 * flow[:, 1] ** 2
        law = (
            law_code(self.law.law),
            self.law.full_stretch if bounded else 1.0,
            self.law.rest_force if bounded else 3.0,
            self.law.tension_at_rest,
        )
        goal = float(end if bounded else np.log(end))
        solved = newton(y, (h, flow, eps, slow, fast), law, self.per_line, plain, goal)
        return self._physical(y) if solved else None

    def _physical(self, y: FloatArray) -> FloatArray:
        state = y.reshape(-1, 2)
        if not self.law.bounded:
            state[:, 0] = np.exp(state[:, 0])
        return state


def start_of(box: Box, s: FloatArray) -> FloatArray:
    """A guess: strands that relax in a network which moves with the flow (linear strands, held short of a contour)."""
    x = refined(s)
    v = box.profile(x)
    passed = np.diff(x) / (0.5 * (v[1:] + v[:-1]) * box.relaxation(0.5 * (x[1:] + x[:-1])))
    # over a cell of constant rates dA = power A + passed
    power = 2 * np.diff(np.log(v)) - passed
    held = np.clip(power, -600, 600)
    gain = np.exp(held)
    fresh = passed * np.where(np.abs(power) > 1e-8, np.expm1(held) / np.where(power == 0, 1.0, power), 1.0)
    top = min((0.9 * box.law.full_stretch) ** 2, 1e250)
    square, squares = min(float(v[0]) ** 2, top), np.empty(x.size)
    squares[0] = square
    for i, (a, b) in enumerate(zip(gain.tolist(), fresh.tolist(), strict=True)):
        square = min(a * square + b, top)
        squares[i + 1] = square
    lam = np.sqrt(squares)
    return np.stack((box.law.tension(lam), np.log(lam / v) - np.log(lam[0] / v[0])), axis=1)


def refined(s: FloatArray) -> FloatArray:
    """Nodes and the middles between them."""
    fine = np.empty(2 * s.size - 1)
    fine[::2], fine[1::2] = s, 0.5 * (s[1:] + s[:-1])
    return fine


def on_parabolas(nodes: FloatArray, state: FloatArray, x: FloatArray) -> FloatArray:
    """State (..., 2) at places within the nodes: the parabola of each box."""
    i = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
    c = ((x - nodes[i]) / (nodes[i + 1] - nodes[i]))[..., np.newaxis]
    first, middle, last = (state[2 * i + k] for k in range(3))
    value: FloatArray = (1 - c) * (1 - 2 * c) * first + 4 * c * (1 - c) * middle + c * (2 * c - 1) * last
    return value


def halved(s: FloatArray) -> FloatArray:
    """Nodes, and the middles of all cells but those that rounding would not let halve."""
    middle = 0.5 * (s[1:] + s[:-1])
    fresh: FloatArray = np.sort(np.concatenate((s, middle[np.diff(s) > 1e-13 * s[-1]])))
    return fresh


def split(s: FloatArray, times: FloatArray) -> FloatArray:
    """Nodes of cells halved so many times (rounded up, three at most), as far as rounding lets them."""
    h = np.diff(s)
    depth = np.ceil(times.clip(0, 3)).astype(int)
    parts = [s]
    for k in (1, 2, 3):
        cells = (depth >= k) & (h > 2**k * 1e-13 * s[-1])
        shares = np.arange(1, 2**k, 2) / 2**k
        parts.append((s[:-1, np.newaxis] + h[:, np.newaxis] * shares)[cells].ravel())
    fresh: FloatArray = np.sort(np.concatenate(parts))
    return fresh


def remeshed(s: FloatArray, values: list[FloatArray], count: int, keep: FloatArray) -> FloatArray:
    """`count` cells, and at most twice as many, that share the bending of the values evenly; the places `keep` are nodes.

    A long cell beside a short and steep one bends by no more than the values change there: else the cell outside of a layer
    would take all nodes.
    """
    middle, h = 0.5 * (s[1:] + s[:-1]), np.diff(s)
    density = np.zeros(h.size)
    for y in values:
        step = np.diff(y)
        bend = np.abs(np.diff(step / h) / np.diff(middle))
        change = np.abs(np.concatenate((step[:1], step, step[-1:])))
        root = np.minimum(
            np.sqrt(np.concatenate((bend[:1], np.maximum(bend[1:], bend[:-1]), bend[-1:]))),
            np.sqrt(change[:-2] + change[1:-1] + change[2:]) / h,
        )
        total = float(np.sum(root * h))
        if total > 0:
            density += root / total
    density += 0.2 * float(np.sum(density * h)) / float(s[-1] - s[0])
    size = float(np.sum(density * h)) / (count * np.maximum(density, 1e-300))
    grown = _GROWTH * middle  # no cell is longer than a shorter one and its distance allow
    size = np.minimum.accumulate(size - grown) + grown
    size = (np.minimum.accumulate((size + grown)[::-1])[::-1] - grown).clip(1e-14 * s[-1])
    share = np.concatenate(([0.0], np.cumsum(h / size)))
    fresh = np.interp(np.linspace(0.0, share[-1], int(min(share[-1], 2 * count)) + 2), share, s)
    return thinned(fresh, keep)


def thinned(nodes: FloatArray, keep: FloatArray) -> FloatArray:
    """Sorted nodes with the places `keep` among them, and none that nearly meets another."""
    nodes = np.unique(np.concatenate((nodes, keep)))
    close = np.diff(nodes) <= 1e-14 * nodes[-1]
    fixed = np.isin(nodes, keep)
    drop = np.zeros(nodes.size, dtype=bool)
    drop[:-1] |= close & ~fixed[:-1]
    drop[1:] |= close & fixed[:-1] & ~fixed[1:]
    kept: FloatArray = nodes[~drop]
    return kept
