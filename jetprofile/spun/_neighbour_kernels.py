"""Forces of the charges of other jets on a jet's nodes, Eq. (27), compiled.

The others' lumped charges stand in the tables with their places and velocities at one moment, and are carried on from there
along straight lines: over a short interval the error is of second order in it.
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import AIR_FIRST, AREA, CHARGE, COUPLING, X

__all__ = ["NEIGHBOURS", "neighbour_forces"]

NEIGHBOURS = AIR_FIRST + 3
"""First of the rows: place, velocity, charge of each; entry (0, 3) counts them, (0, 4) is their moment."""


@njit(cache=True, error_model="numpy")
def neighbour_forces(
    t: float, n: int, y: FloatArray, p: FloatArray, tables: FloatArray, w: FloatArray, f: FloatArray
) -> None:
    """Add the forces on nodes 0 to n - 1."""
    count, after = int(tables[0, 3]), t - tables[0, 4]
    for i in range(n):
        charge = 0.5 * (y[i, CHARGE] + (y[i - 1, CHARGE] if i > 0 else 0.0))
        soft = w[AREA, i] / math.pi
        ex, ey, ez = 0.0, 0.0, 0.0
        for j in range(count):
            dx = y[i, X] - tables[NEIGHBOURS, j] - after * tables[NEIGHBOURS + 3, j]
            dy = y[i, X + 1] - tables[NEIGHBOURS + 1, j] - after * tables[NEIGHBOURS + 4, j]
            dz = y[i, X + 2] - tables[NEIGHBOURS + 2, j] - after * tables[NEIGHBOURS + 5, j]
            d2 = dx * dx + dy * dy + dz * dz + soft
            pull = tables[NEIGHBOURS + 6, j] / (d2 * math.sqrt(d2))
            ex += pull * dx
            ey += pull * dy
            ez += pull * dz
        f[i, 0] += p[COUPLING] * charge * ex
        f[i, 1] += p[COUPLING] * charge * ey
        f[i, 2] += p[COUPLING] * charge * ez
