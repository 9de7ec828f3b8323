"""Drag and lift of the air on the elements, Eqs. (20)-(22) and (24), compiled.

Drag per length ``-xi pi r rho_a (2 r/nu_a)^(-zeta) w |w|^eta`` along the tangent, w the tangential speed relative to the
air (the printed ``w^(1+eta)`` is not a number where the air is the faster). Lift lowers the tension by ``rho_a w^2 A`` in
the normal direction only. The air moves alike everywhere, or along the axis as a table says: then with the velocity there times
``2^-(rho/b)^2``, b the half width (0: as wide as one likes).
"""

import math

from spinline.base.checks import FloatArray
from spinline.base.kernels import njit
from spinline.jetprofile.spun._codes import (
    AIR_DENSITY,
    AIR_FIRST,
    AIR_VISCOSITY,
    AIR_X,
    AREA,
    DRAG_ETA,
    DRAG_XI,
    DRAG_ZETA,
    LENGTH,
    LIFT,
    TX,
    VX,
    IntArray,
    X,
)

__all__ = ["air_at", "air_forces"]


@njit(cache=True, error_model="numpy")
def air_at(x: float, y: float, z: float, p: FloatArray, tables: FloatArray) -> tuple[float, float, float]:
    """Velocity of the air at a point, m/s."""
    count = int(tables[0, 5])
    if count == 0:
        return p[AIR_X], p[AIR_X + 1], p[AIR_X + 2]
    axis = tables[AIR_FIRST]
    high = 1
    while high < count - 1 and axis[high] < x:
        high += 1
    part = min(max((x - axis[high - 1]) / (axis[high] - axis[high - 1]), 0.0), 1.0)
    speed = tables[AIR_FIRST + 1, high - 1] * (1.0 - part) + tables[AIR_FIRST + 1, high] * part
    wide = tables[AIR_FIRST + 2, high - 1] * (1.0 - part) + tables[AIR_FIRST + 2, high] * part
    if wide > 0.0:
        speed *= 2.0 ** (-(y * y + z * z) / (wide * wide))
    return p[AIR_X] + speed, p[AIR_X + 1], p[AIR_X + 2]


@njit(cache=True, error_model="numpy")
def _slip(i: int, y: FloatArray, p: FloatArray, tables: FloatArray, w: FloatArray) -> float:
    """Tangential speed of element i relative to the air, m/s."""
    ax, ay, az = air_at(
        0.5 * (y[i, X] + y[i + 1, X]),
        0.5 * (y[i, X + 1] + y[i + 1, X + 1]),
        0.5 * (y[i, X + 2] + y[i + 1, X + 2]),
        p,
        tables,
    )
    total: float = (0.5 * (y[i, VX] + y[i + 1, VX]) - ax) * w[TX, i]
    total += (0.5 * (y[i, VX + 1] + y[i + 1, VX + 1]) - ay) * w[TX + 1, i]
    total += (0.5 * (y[i, VX + 2] + y[i + 1, VX + 2]) - az) * w[TX + 2, i]
    return total


@njit(cache=True, error_model="numpy")
def air_forces(
    n: int, y: FloatArray, p: FloatArray, k: IntArray, tables: FloatArray, w: FloatArray, f: FloatArray
) -> None:
    """Add drag, and lift where it is wanted."""
    for i in range(n):
        speed = _slip(i, y, p, tables, w)
        radius = math.sqrt(w[AREA, i] / math.pi)
        drag = p[DRAG_XI] * math.pi * radius * w[LENGTH, i] * p[AIR_DENSITY]
        drag *= (2.0 * radius / p[AIR_VISCOSITY]) ** (-p[DRAG_ZETA]) * speed * abs(speed) ** p[DRAG_ETA]
        lift = p[AIR_DENSITY] * speed * speed * w[AREA, i] if k[LIFT] == 1 else 0.0
        for c in range(3):
            half = 0.5 * drag * w[TX + c, i]
            f[i, c] -= half
            f[i + 1, c] -= half
            # as a negative tension in the bends; on straight parts the two ends of equal elements cancel
            if lift != 0.0:
                before = w[TX + c, i - 1] if i > 0 else w[TX + c, i]
                after = w[TX + c, i + 1] if i < n - 1 else w[TX + c, i]
                f[i, c] -= 0.5 * lift * (before - w[TX + c, i])
                f[i + 1, c] -= 0.5 * lift * (w[TX + c, i] - after)
