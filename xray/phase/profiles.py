"""Radial profiles of the fraction and their chords, averaged over cells: what a wave model takes the jet to be made of.

`Shells`: uniform shells, a staircase. `Ramps`: continuous, linear in the area ``q = (r/R)^2`` between knots q_k,

    phi(q) = phi(1) + sum_k kappa_k (q_k - q)_+,   kappa_k = m_k - m_(k-1),   m_k = (c_(k+1) - c_k)/(q_(k+1) - q_k)

with m after the last knot 0, so that a parabola is exact, the mean over the section the trapezium rule over the knots' values
c, and the chord of each term that of a cap, ``(4/3) (r_k^2 - x^2)^(3/2)/R^2``. Its average over a cell has the closed form

    int (r^2 - x^2)^(3/2) dx = (x (5 r^2 - 2 x^2) sqrt(r^2 - x^2) + 3 r^4 asin(x/r))/8.

Why it matters for fringes: an edge at r_j across which the refraction jumps by d turns the wave by ``(4 pi d/lambda) sqrt(2
r_j (r_j - x))`` a little inside of it. The jet's own edge makes the fringes so, and a staircase has such an edge at every
step: of a step of 0.05 of PEO in water with 0.005 of the strength of the jet's edge, as much as a uniform change of the
fraction by 0.05 makes there. A staircase fitted to a smooth jet fits these, not the mean. A change of slope leaves ``(r_k -
x)^(3/2)``, which makes none to speak of.
"""

from typing import Protocol

import numpy as np

from spinline.base.checks import FloatArray, real
from spinline.base.errors import InputError
from spinline.xray.row.chords import disc_chords, shell_weights

__all__ = ["RADIAL_KNOTS", "Profile", "Ramps", "Shells"]

RADIAL_KNOTS = (0.0, 0.36, 0.64, 0.81, 0.92, 1.0)  # (r/R)^2; denser at the rim, of which the fringes tell most


class Profile(Protocol):
    """What a wave model asks of a profile: unknowns whose base functions sum to 1, the last one the value at the rim.

    Attributes
    ----------
    size : int
        Number of unknowns.
    """

    @property
    def size(self) -> int:
        """Number of unknowns."""
        ...

    def depths(self, radius: float, x: FloatArray, axis: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Chords of each base function averaged over cells of edges x, with their derivatives with radius and axis.

        Shapes (cells, size); m, and pure numbers.
        """
        ...

    def means(self, edges: FloatArray) -> FloatArray:
        """Means over shells of edges r/R, shape (shells, size)."""
        ...


class Shells:
    """Uniform shells; `edges` r/R from 0 to 1."""

    def __init__(self, edges: FloatArray) -> None:
        self.edges = edges
        self.size = edges.size - 1

    def depths(self, radius: float, x: FloatArray, axis: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """As `Profile.depths`."""
        discs, by_radius, by_axis = disc_chords(radius * self.edges[1:], x, axis)
        by_radius *= self.edges[1:]
        for array in (discs, by_radius, by_axis):
            array[:, 1:] -= array[:, :-1].copy()
        return discs, by_radius, by_axis

    def means(self, edges: FloatArray) -> FloatArray:
        """As `Profile.means`."""
        low = np.maximum(edges[:-1, None], self.edges[:-1])
        high = np.minimum(edges[1:, None], self.edges[1:])
        value: FloatArray = np.maximum(high**2 - low**2, 0.0) / shell_weights(edges)[:, None]
        return value


class Ramps:
    """Linear in (r/R)^2 between knots, which rise from 0 to 1; the unknowns are the values there.

    Parameters
    ----------
    knots : ndarray, shape (size,)
    """

    def __init__(self, knots: FloatArray) -> None:
        q = real("knots", knots, least=0.0, most=1.0)
        if q.ndim != 1 or q.size < 2 or q[0] != 0.0 or q[-1] != 1.0 or (np.diff(q) <= 0).any():
            raise InputError("knots", "do not rise from 0 to 1", value=knots, remedy="give (r/R)^2 of the knots")
        self.knots = q
        self.size = q.size
        slopes = np.zeros((q.size, q.size))  # m_k from the values; after the last knot none
        at = np.arange(q.size - 1)
        slopes[at, at + 1] = 1.0 / np.diff(q)
        slopes[at, at] = -slopes[at, at + 1]
        self._kappa = slopes[1:] - slopes[:-1]  # (caps, values): the fraction rises inward by kappa (q_k - q)

    def depths(self, radius: float, x: FloatArray, axis: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """As `Profile.depths`."""
        disc, disc_by_radius, disc_by_axis = disc_chords(np.array([radius]), x, axis)
        r = radius * np.sqrt(self.knots[1:])
        s = np.clip((x[:, None] - axis) / r, -1.0, 1.0)
        square = (1.0 - s) * (1.0 + s)
        root, angle = np.sqrt(square), np.arcsin(s)
        over = (4.0 / 3.0) / radius**2 / np.diff(x)[:, None]
        cap = np.diff(s * (5.0 - 2.0 * s**2) * root + 3.0 * angle, axis=0) * (over * 0.125 * r**4)
        # r dF/dr = 3 r^2 int sqrt: each cap grows with its own radius, and its height stays q_k
        growth = np.diff(s * root + angle, axis=0) * (over * 1.5 * r**4)
        by_radius = (growth - 2.0 * cap) / radius
        by_axis = -np.diff(square * root, axis=0) * (over * r**3)
        out = []
        for caps, whole in ((cap, disc), (by_radius, disc_by_radius), (by_axis, disc_by_axis)):
            columns = caps @ self._kappa
            columns[:, -1] += whole[:, 0]
            out.append(columns)
        return out[0], out[1], out[2]

    def means(self, edges: FloatArray) -> FloatArray:
        """As `Profile.means`."""
        at = np.union1d(edges**2, self.knots)
        values = np.array([np.interp(at, self.knots, unit) for unit in np.eye(self.size)]).T
        parts = 0.5 * np.diff(at)[:, None] * (values[1:] + values[:-1])
        total = np.add.reduceat(parts, np.searchsorted(at, edges[:-1] ** 2), axis=0)
        mean: FloatArray = total / np.diff(edges**2)[:, None]
        return mean
